//! Unions, intersections and differences, sharp and smooth.
use super::bind::{
    BoundArgs, Function, ParameterKind as Kind, SHAPE, counted_result, optional, required, variadic,
};
use super::{Arg, CallError, Solid};
use chordal::implicit::shapes::InvalidShape;
use chordal::implicit::{Field, Seam};

/// Functions that combine several shapes.
pub(super) const COMBINE: &[Function] = &[
    Function {
        name: "union",
        parameters: &[variadic("shapes").of(Kind::Shape), optional("fillet", 0.0), optional("chamfer", 0.0)],
        about: "All points in any of the shapes, like `a | b`; also takes a list of shapes. A fillet or \
            chamfer fills the inner edges where the shapes meet.",
        distance: "outside as for the weakest of the shapes, inside a lower bound; with a fillet or chamfer a lower bound",
        make: |args| combine_all(args, Field::union_of, Field::union_with),
    },
    Function {
        name: "intersection",
        parameters: &[variadic("shapes").of(Kind::Shape), optional("fillet", 0.0), optional("chamfer", 0.0)],
        about: "The points common to all of the shapes, like `a & b`. A fillet or chamfer rounds or cuts \
            off the edges where the shapes meet.",
        distance: "inside as for the weakest of the shapes, outside a lower bound; with a fillet or chamfer a lower bound",
        make: |args| combine_all(args, Field::intersection_of, Field::intersection_with),
    },
    Function {
        name: "difference",
        parameters: &[
            SHAPE,
            variadic("others").of(Kind::Shape),
            optional("fillet", 0.0),
            optional("chamfer", 0.0),
        ],
        about: "The points of the first shape that are in none of the others, like `a - b`. A fillet or \
            chamfer rounds or cuts off the edges of the cuts.",
        distance: "lower bound",
        make: |args| {
            let solids = args.shapes()?;
            let Some((first, others)) = solids.split_first() else {
                return Err(CallError("difference() needs 'shape'".to_owned()));
            };
            let cutters: Vec<Field> = others.iter().map(|solid| solid.field.clone()).collect();
            match seam_of(args, 1)? {
                _ if cutters.is_empty() => args.shape_result(Ok(first.field.clone()), &solids),
                None => args.shape_result(Ok(first.field.difference(&Field::union_of(&cutters))), &solids),
                Some(seam) => {
                    let cut = |field: Field, cutter: &Field| field.difference_with(cutter, seam);
                    counted_result(args, cutters.iter().try_fold(first.field.clone(), cut), &solids)
                }
            }
        },
    },
    Function {
        name: "complement",
        parameters: &[SHAPE],
        about: "All points that are not in the shape.",
        distance: "as for the given shape, with inside and outside exchanged",
        make: |args| {
            let solid = args.shape(0)?;
            args.shape_result(Ok(solid.field.complement()), &[solid])
        },
    },
    Function {
        name: "smooth_union",
        parameters: &[required("a").of(Kind::Shape), required("b").of(Kind::Shape), required("radius")],
        about: "The union, blended where the shapes are closer to each other than the radius. Faces and \
            outer edges that both shapes share bulge; union(fillet=) leaves them unchanged.",
        distance: "lower bound",
        make: |args| smooth(args, Field::smooth_union),
    },
    Function {
        name: "smooth_intersection",
        parameters: &[required("a").of(Kind::Shape), required("b").of(Kind::Shape), required("radius")],
        about: "The intersection with its edges rounded.",
        distance: "lower bound",
        make: |args| smooth(args, Field::smooth_intersection),
    },
    Function {
        name: "smooth_difference",
        parameters: &[required("a").of(Kind::Shape), required("b").of(Kind::Shape), required("radius")],
        about: "The difference with its edges rounded.",
        distance: "lower bound",
        make: |args| smooth(args, Field::smooth_difference),
    },
];

fn combine_all(
    args: &BoundArgs,
    all_of: fn(&[Field]) -> Field,
    two_with: fn(&Field, &Field, Seam) -> Result<Field, InvalidShape>,
) -> Result<Arg, CallError> {
    let solids = args.shapes()?;
    let fields: Vec<Field> = solids.iter().map(|solid| solid.field.clone()).collect();
    let Some((first, others)) = fields.split_first() else {
        return Err(args.fault("needs at least one shape"));
    };
    // Sharp unions are associative and are built as a balanced tree at once; a seam depends on the
    // order and is applied from left to right.
    match seam_of(args, 0)? {
        None => args.shape_result(Ok(all_of(&fields)), &solids),
        Some(seam) => {
            let field = others.iter().try_fold(first.clone(), |field, other| two_with(&field, other, seam));
            counted_result(args, field, &solids)
        }
    }
}

/// The fillet or chamfer at the indices `first` and `first + 1`, if either is not 0.
fn seam_of(args: &BoundArgs, first: usize) -> Result<Option<Seam>, CallError> {
    match args.numbers(first)? {
        [0.0, 0.0] => Ok(None),
        [radius, 0.0] => Ok(Some(Seam::Fillet(radius))),
        [0.0, length] => Ok(Some(Seam::Chamfer(length))),
        _ => Err(args.fault("takes a fillet or a chamfer, not both")),
    }
}

/// A blend of two shapes with a radius.
type BlendFn = fn(&Field, &Field, f64) -> Result<Field, InvalidShape>;

fn smooth(args: &BoundArgs, blend: BlendFn) -> Result<Arg, CallError> {
    let (a, b): (&Solid, &Solid) = (args.shape(0)?, args.shape(1)?);
    args.shape_result(blend(&a.field, &b.field, args.number(2)?), &[a, b])
}
