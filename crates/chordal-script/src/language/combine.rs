//! Unions, intersections, differences, and their smooth kin.
use super::bind::{Function, Given, needed, rest};
use super::{Arg, Fault, Solid};
use chordal::implicit::Field;
use chordal::implicit::shapes::InvalidShape;

/// Shapes made of several shapes.
pub(super) const COMBINE: &[Function] = &[
    Function {
        name: "union",
        parameters: &[rest("shapes")],
        about: "All points of any of the shapes, as `a | b` has them; a list of shapes does as well.",
        distance: "outside as good as all of them, inside a lower bound",
        make: |given| of_all(given, Field::union_of),
    },
    Function {
        name: "intersection",
        parameters: &[rest("shapes")],
        about: "The points that all of the shapes have, as `a & b` has them.",
        distance: "inside as good as all of them, outside a lower bound",
        make: |given| of_all(given, Field::intersection_of),
    },
    Function {
        name: "difference",
        parameters: &[needed("shape"), rest("others")],
        about: "The points of the first shape that none of the others has, as `a - b` has them.",
        distance: "a lower bound",
        make: |given| {
            let all = given.shapes()?;
            let Some((first, others)) = all.split_first() else {
                return Err(Fault("difference() needs 'shape'".to_owned()));
            };
            let taken: Vec<Field> = others.iter().map(|solid| solid.field.clone()).collect();
            let field = match taken.as_slice() {
                [] => first.field.clone(),
                _ => first.field.difference(&Field::union_of(&taken)),
            };
            given.made(Ok(field), &all)
        },
    },
    Function {
        name: "complement",
        parameters: &[needed("shape")],
        about: "All other points.",
        distance: "as it was, inside and outside exchanged",
        make: |given| {
            let solid = given.shape(0)?;
            given.made(Ok(solid.field.complement()), &[solid])
        },
    },
    Function {
        name: "smooth_union",
        parameters: &[needed("a"), needed("b"), needed("radius")],
        about: "The union with its seam filled, where both are nearer to each other than a radius.",
        distance: "a lower bound",
        make: |given| smooth(given, Field::smooth_union),
    },
    Function {
        name: "smooth_intersection",
        parameters: &[needed("a"), needed("b"), needed("radius")],
        about: "The intersection with its edge rounded off.",
        distance: "a lower bound",
        make: |given| smooth(given, Field::smooth_intersection),
    },
    Function {
        name: "smooth_difference",
        parameters: &[needed("a"), needed("b"), needed("radius")],
        about: "The difference with its edge rounded off.",
        distance: "a lower bound",
        make: |given| smooth(given, Field::smooth_difference),
    },
];

fn of_all(given: &Given, all_of: fn(&[Field]) -> Field) -> Result<Arg, Fault> {
    let solids = given.shapes()?;
    if solids.is_empty() {
        return Err(given.fault("needs a shape at least"));
    }
    let fields: Vec<Field> = solids.iter().map(|solid| solid.field.clone()).collect();
    given.made(Ok(all_of(&fields)), &solids)
}

/// An operation on two shapes with a radius.
type Blend = fn(&Field, &Field, f64) -> Result<Field, InvalidShape>;

fn smooth(given: &Given, blend: Blend) -> Result<Arg, Fault> {
    let (a, b): (&Solid, &Solid) = (given.shape(0)?, given.shape(1)?);
    given.made(blend(&a.field, &b.field, given.number(2)?), &[a, b])
}
