//! Unions, intersections and differences, sharp and smooth.
use super::bind::{BoundArgs, Function, required, variadic};
use super::{Arg, CallError, Solid};
use chordal::implicit::Field;
use chordal::implicit::shapes::InvalidShape;

/// Functions that combine several shapes.
pub(super) const COMBINE: &[Function] = &[
    Function {
        name: "union",
        parameters: &[variadic("shapes")],
        about: "All points of any of the shapes, as `a | b` has them; a list of shapes does as well.",
        distance: "outside as good as all of them, inside a lower bound",
        make: |given| combine_all(given, Field::union_of),
    },
    Function {
        name: "intersection",
        parameters: &[variadic("shapes")],
        about: "The points that all of the shapes have, as `a & b` has them.",
        distance: "inside as good as all of them, outside a lower bound",
        make: |given| combine_all(given, Field::intersection_of),
    },
    Function {
        name: "difference",
        parameters: &[required("shape"), variadic("others")],
        about: "The points of the first shape that none of the others has, as `a - b` has them.",
        distance: "a lower bound",
        make: |given| {
            let all = given.shapes()?;
            let Some((first, others)) = all.split_first() else {
                return Err(CallError("difference() needs 'shape'".to_owned()));
            };
            let taken: Vec<Field> = others.iter().map(|solid| solid.field.clone()).collect();
            let field = match taken.as_slice() {
                [] => first.field.clone(),
                _ => first.field.difference(&Field::union_of(&taken)),
            };
            given.shape_result(Ok(field), &all)
        },
    },
    Function {
        name: "complement",
        parameters: &[required("shape")],
        about: "All other points.",
        distance: "as it was, inside and outside exchanged",
        make: |given| {
            let solid = given.shape(0)?;
            given.shape_result(Ok(solid.field.complement()), &[solid])
        },
    },
    Function {
        name: "smooth_union",
        parameters: &[required("a"), required("b"), required("radius")],
        about: "The union with its seam filled, where both are nearer to each other than a radius.",
        distance: "a lower bound",
        make: |given| smooth(given, Field::smooth_union),
    },
    Function {
        name: "smooth_intersection",
        parameters: &[required("a"), required("b"), required("radius")],
        about: "The intersection with its edge rounded off.",
        distance: "a lower bound",
        make: |given| smooth(given, Field::smooth_intersection),
    },
    Function {
        name: "smooth_difference",
        parameters: &[required("a"), required("b"), required("radius")],
        about: "The difference with its edge rounded off.",
        distance: "a lower bound",
        make: |given| smooth(given, Field::smooth_difference),
    },
];

fn combine_all(given: &BoundArgs, all_of: fn(&[Field]) -> Field) -> Result<Arg, CallError> {
    let solids = given.shapes()?;
    if solids.is_empty() {
        return Err(given.fault("needs a shape at least"));
    }
    let fields: Vec<Field> = solids.iter().map(|solid| solid.field.clone()).collect();
    given.shape_result(Ok(all_of(&fields)), &solids)
}

/// A blend of two shapes with a radius.
type BlendFn = fn(&Field, &Field, f64) -> Result<Field, InvalidShape>;

fn smooth(given: &BoundArgs, blend: BlendFn) -> Result<Arg, CallError> {
    let (a, b): (&Solid, &Solid) = (given.shape(0)?, given.shape(1)?);
    given.shape_result(blend(&a.field, &b.field, given.number(2)?), &[a, b])
}
