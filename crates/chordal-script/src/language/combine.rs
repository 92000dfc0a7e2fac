//! Unions, intersections and differences, sharp and smooth.
use super::bind::{BoundArgs, Function, counted_result, optional, required, variadic};
use super::{Arg, CallError, Solid};
use chordal::implicit::shapes::InvalidShape;
use chordal::implicit::{Field, Seam};

/// Functions that combine several shapes.
pub(super) const COMBINE: &[Function] = &[
    Function {
        name: "union",
        parameters: &[variadic("shapes"), optional("fillet", 0.0), optional("chamfer", 0.0)],
        about: "All points of any of the shapes, as `a | b` has them; a list of shapes does as well. With a \
            fillet or chamfer the edges are filled in which they meet.",
        distance: "outside as good as all of them, inside a lower bound; with a fillet or chamfer a lower bound",
        make: |args| combine_all(args, Field::union_of, Field::union_with),
    },
    Function {
        name: "intersection",
        parameters: &[variadic("shapes"), optional("fillet", 0.0), optional("chamfer", 0.0)],
        about: "The points that all of the shapes have, as `a & b` has them. With a fillet or chamfer the \
            edges are rounded or cut off in which they meet.",
        distance: "inside as good as all of them, outside a lower bound; with a fillet or chamfer a lower bound",
        make: |args| combine_all(args, Field::intersection_of, Field::intersection_with),
    },
    Function {
        name: "difference",
        parameters: &[
            required("shape"),
            variadic("others"),
            optional("fillet", 0.0),
            optional("chamfer", 0.0),
        ],
        about: "The points of the first shape that none of the others has, as `a - b` has them. With a fillet \
            or chamfer the edges of the cuts are rounded or cut off.",
        distance: "a lower bound",
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
        parameters: &[required("shape")],
        about: "All other points.",
        distance: "as it was, inside and outside exchanged",
        make: |args| {
            let solid = args.shape(0)?;
            args.shape_result(Ok(solid.field.complement()), &[solid])
        },
    },
    Function {
        name: "smooth_union",
        parameters: &[required("a"), required("b"), required("radius")],
        about: "The union with its seam filled, where both are nearer to each other than a radius. Faces and \
            outer edges that both share swell; union(fillet=) leaves them.",
        distance: "a lower bound",
        make: |args| smooth(args, Field::smooth_union),
    },
    Function {
        name: "smooth_intersection",
        parameters: &[required("a"), required("b"), required("radius")],
        about: "The intersection with its edge rounded off.",
        distance: "a lower bound",
        make: |args| smooth(args, Field::smooth_intersection),
    },
    Function {
        name: "smooth_difference",
        parameters: &[required("a"), required("b"), required("radius")],
        about: "The difference with its edge rounded off.",
        distance: "a lower bound",
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
        return Err(args.fault("needs a shape at least"));
    };
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
