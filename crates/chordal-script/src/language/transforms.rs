//! Transforms: placing shapes, and operations on a single shape.
use super::bind::{BoundArgs, Function, counted_result, optional, required};
use super::{Arg, CallError, Solid};
use chordal::Tolerance;
use chordal::budget::Failure;
use chordal::convert::redistance;
use chordal::implicit::shapes::InvalidShape;
use chordal::implicit::{DistanceQuality, Field, Repeat};
use chordal::math::greater;

const KEPT: &str = "as it was";
const BOUND: &str = "a lower bound";

/// Translations, rotations and the like.
pub(super) const PLACE: &[Function] = &[
    Function {
        name: "move",
        parameters: &[required("shape"), required("x"), required("y"), optional("z", 0.0)],
        about: "The shape moved by these lengths.",
        distance: KEPT,
        make: |args| apply_step(args, |args, field| Ok(field.moved(args.numbers(1)?))),
    },
    Function {
        name: "rotate_x",
        parameters: &[required("shape"), required("degrees")],
        about: "The shape turned around the x axis, counter-clockwise as seen from its tip.",
        distance: KEPT,
        make: |args| apply_step(args, |args, field| Ok(field.rotated_deg([1.0, 0.0, 0.0], args.number(1)?))),
    },
    Function {
        name: "rotate_y",
        parameters: &[required("shape"), required("degrees")],
        about: "The shape turned around the y axis.",
        distance: KEPT,
        make: |args| apply_step(args, |args, field| Ok(field.rotated_deg([0.0, 1.0, 0.0], args.number(1)?))),
    },
    Function {
        name: "rotate_z",
        parameters: &[required("shape"), required("degrees")],
        about: "The shape turned around the z axis; so are shapes of the plane.",
        distance: KEPT,
        make: |args| apply_step(args, |args, field| Ok(field.rotated_deg([0.0, 0.0, 1.0], args.number(1)?))),
    },
    Function {
        name: "rotate",
        parameters: &[required("shape"), required("axis"), required("degrees")],
        about: "The shape turned around an axis of three numbers through the origin.",
        distance: KEPT,
        make: |args| apply_step(args, |args, field| Ok(field.rotated_deg(args.point(1)?, args.number(2)?))),
    },
    Function {
        name: "scale",
        parameters: &[required("shape"), required("factor")],
        about: "The shape made larger or smaller, about the origin.",
        distance: KEPT,
        make: |args| apply_step(args, |args, field| Ok(field.scaled([args.number(1)?; 3]))),
    },
    Function {
        name: "stretch",
        parameters: &[required("shape"), required("x"), required("y"), optional("z", 1.0)],
        about: "The shape with its own factor along each axis.",
        distance: BOUND,
        make: |args| apply_step(args, |args, field| Ok(field.scaled(args.numbers(1)?))),
    },
    Function {
        name: "mirror",
        parameters: &[required("shape"), required("x"), required("y"), optional("z", 0.0)],
        about: "The mirror image in the plane through the origin with this normal.",
        distance: KEPT,
        make: |args| apply_step(args, |args, field| Ok(field.mirrored(args.numbers(1)?))),
    },
    Function {
        name: "repeat",
        parameters: &[
            required("shape"),
            optional("x", 0.0),
            optional("y", 0.0),
            optional("z", 0.0),
            optional("nx", 0.0),
            optional("ny", 0.0),
            optional("nz", 0.0),
        ],
        about: "Copies of the shape, so far apart along each axis (0: no copies) and so many (0: without end).",
        distance: "outside exact if it was, else a sign; inside a lower bound",
        make: repeat,
    },
    Function {
        name: "linear",
        parameters: &[
            required("shape"),
            required("count"),
            required("x"),
            optional("y", 0.0),
            optional("z", 0.0),
        ],
        about: "So many copies of the shape in a row, each moved by these lengths from the one before.",
        distance: COPIES,
        make: |args| {
            let (solid, step) = (args.shape(0)?, args.numbers::<3>(2)?);
            let copy = |k: u32| solid.field.moved(step.map(|x| x * f64::from(k)));
            copies(args, solid, copy)
        },
    },
    Function {
        name: "polar",
        parameters: &[required("shape"), required("count"), optional("degrees", 360.0)],
        about: "So many copies of the shape around the z axis, evenly over an angle: a full turn, or from the \
            first to the last.",
        distance: COPIES,
        make: |args| {
            let (solid, count, angle) = (args.shape(0)?, args.count(1)?, args.number(2)?);
            // Over a full turn, a copy at the end angle would coincide with the first.
            let n_steps = if angle.abs() == 360.0 { count } else { count.saturating_sub(1) };
            let copy = |k: u32| {
                let turn = if k == 0 { 0.0 } else { angle * (f64::from(k) / f64::from(n_steps)) };
                solid.field.rotated_deg([0.0, 0.0, 1.0], turn)
            };
            copies(args, solid, copy)
        },
    },
    Function {
        name: "symmetric",
        parameters: &[required("shape"), required("x"), required("y"), optional("z", 0.0)],
        about: "The shape and its mirror image in the plane through the origin with this normal.",
        distance: COPIES,
        make: |args| {
            let solid = args.shape(0)?;
            let union = solid.field.mirrored(args.numbers(1)?).map(|image| solid.field.union(&image));
            args.weighted_shape_result(union, &[solid], 2)
        },
    },
];

const COPIES: &str = "outside as good as it was, inside a lower bound";

/// The most copies of a pattern. Defined: the limit on terms would refuse more anyway.
const MOST_COPIES: u32 = 10_000;

/// The union of the copies with numbers from 0 on; the second argument is their count.
fn copies(
    args: &BoundArgs,
    solid: &Solid,
    copy: impl Fn(u32) -> Result<Field, InvalidShape>,
) -> Result<Arg, CallError> {
    let count = args.count(1)?;
    if !(1..=MOST_COPIES).contains(&count) {
        return Err(args.fault(&format!("makes 1 to {MOST_COPIES} copies, not {count}")));
    }
    let fields: Result<Vec<Field>, InvalidShape> = (0..count).map(copy).collect();
    let union = fields.map(|fields| Field::union_of(&fields));
    args.weighted_shape_result(union, &[solid], u64::from(count) + 1)
}

/// Operations that change the shape itself.
pub(super) const CHANGE: &[Function] = &[
    Function {
        name: "offset",
        parameters: &[required("shape"), required("by")],
        about: "The shape grown by a distance, or shrunk by a negative one; needs a distance on that side.",
        distance: "exact on the side that the surface moved to, if it was exact there; else a lower bound",
        make: |args| apply_step(args, |args, field| Ok(field.offset(args.number(1)?))),
    },
    Function {
        name: "minkowski",
        parameters: &[required("shape"), required("radius")],
        about: "The Minkowski sum with a ball: all points nearer than a radius to the shape, whose value must be \
            an exact distance outside.",
        distance: "outside exact, inside a lower bound",
        make: |args| {
            let solid = args.shape(0)?;
            if solid.field.distance().outside != DistanceQuality::Exact {
                return Err(args.fault(
                    "needs an exact distance outside, and this shape has none: \
                         minkowski(redistance(shape, within), radius) makes one first",
                ));
            }
            let by = args.number(1)?;
            if by < 0.0 || by.is_nan() {
                return Err(args.fault("needs a radius of 0 or above"));
            }
            args.shape_result(solid.field.offset(args.number(1)?), &[solid])
        },
    },
    Function {
        name: "shell",
        parameters: &[required("shape"), required("thickness")],
        about: "A wall along the surface, half of its thickness to each side; needs a distance on both.",
        distance: "outside exact if it was, inside a lower bound",
        make: |args| apply_step(args, |args, field| Ok(field.shell(args.number(1)?))),
    },
    Function {
        name: "redistance",
        parameters: &[required("shape"), required("within")],
        about: "The shape with a value that is a distance again, to triangles within a length of its surface.",
        distance: "exact, of the triangles",
        make: |args| {
            let (solid, within) = (args.shape(0)?, args.number(1)?);
            let fault = |why: &str| CallError(format!("redistance(): {why}"));
            let within = Tolerance::new(within).map_err(|why| fault(&why.to_string()))?;
            let redistanced =
                redistance(&solid.field, within, args.job()).map_err(|failure| match failure {
                    Failure::Unmet(best) => fault(&match best.bound.at_most() {
                        Some(most) => format!("the best triangles that were found are {most:e} away"),
                        None => "no triangles were proved to be within the length".to_owned(),
                    }),
                    Failure::Refused(why) => fault(&why.message.to_string()),
                    Failure::Cancelled => fault("cancelled"),
                })?;
            Ok(Arg::shape(redistanced.shape))
        },
    },
    Function {
        name: "extrude",
        parameters: &[
            required("shape"),
            required("height"),
            optional("bevel", 0.0),
            optional("rounded", 0.0),
        ],
        about: "A shape of the plane made a solid of that height, half above and half below. A bevel cuts the edges of \
            both ends off at 45 degrees, so wide and high; rounded, they are a quarter of a circle of that radius. Both go \
            by the depths that the shape's value says.",
        distance: "as it was; with a bevel or rounded edges a lower bound",
        make: |args| {
            apply_step(args, |args, field| {
                let [height, bevel, rounded] = args.numbers(1)?;
                match (bevel == 0.0, rounded == 0.0) {
                    (true, true) => Ok(field.extruded(height)),
                    (false, true) => Ok(field.extruded_with_bevel(height, bevel)),
                    (true, false) => Ok(field.extruded_with_round_edges(height, rounded)),
                    (false, false) => Err(args.fault("takes a bevel or rounded edges, and both are given")),
                }
            })
        },
    },
    Function {
        name: "section",
        parameters: &[required("shape"), optional("z", 0.0)],
        about: "The section of a solid with the plane at a height, as a shape of the plane.",
        distance: "a lower bound",
        make: |args| apply_step(args, |args, field| Ok(field.section(args.number(1)?))),
    },
    Function {
        name: "taper",
        parameters: &[required("shape"), required("factor"), required("height")],
        about: "A solid of that height, half above and half below, whose cross-section is the shape, scaled from \
            1 at the bottom to the factor at the top.",
        distance: "a lower bound; a sign if the shape has only a sign or no end",
        make: |args| apply_step(args, |args, field| Ok(field.tapered(args.number(1)?, args.number(2)?))),
    },
    Function {
        name: "loft",
        parameters: &[required("shapes"), required("height")],
        about: "A solid of that height, half above and half below, from the first of some shapes of the plane to \
            the last. Those between draw it towards themselves, as control points draw a Bézier curve.",
        distance: "a lower bound",
        make: |args| {
            let solids = args.shapes()?;
            let profiles: Vec<Field> = solids.iter().map(|solid| solid.field.clone()).collect();
            counted_result(args, Field::lofted(&profiles, args.number(1)?), &solids)
        },
    },
    Function {
        name: "revolve",
        parameters: &[required("shape")],
        about: "A shape of the plane turned about its y axis, which then stands along z.",
        distance: "as it was, where the shape keeps off the axis",
        make: |args| apply_step(args, |_, field| Ok(Ok(field.revolved()))),
    },
    Function {
        name: "twist",
        parameters: &[required("shape"), required("degrees")],
        about: "The shape turned about z by so much more with each unit of height.",
        distance: "a lower bound, if it is bounded around the axis; else a sign",
        make: |args| apply_step(args, |args, field| Ok(field.twisted(args.number(1)? * RADIANS))),
    },
    Function {
        name: "bend",
        parameters: &[required("shape"), required("degrees")],
        about: "The shape turned about z by so much more with each unit along x.",
        distance: "a lower bound, if it is bounded around the axis; else a sign",
        make: |args| apply_step(args, |args, field| Ok(field.bent(args.number(1)? * RADIANS))),
    },
    Function {
        name: "displace",
        parameters: &[required("shape"), required("by"), required("amplitude")],
        about: "The shape whose value has a formula added, which nowhere exceeds the amplitude in size.",
        distance: "a sign",
        make: |args| {
            let (solid, by) = (args.shape(0)?, args.formula(1)?);
            let field = solid.field.displaced(&by.expr, args.number(2)?);
            args.formula_result(field, solid, &by)
        },
    },
];

/// Radians per degree; derived: π/180, rounded.
pub(super) const RADIANS: f64 = std::f64::consts::PI / 180.0;

/// An operation on a field. The outer error is one of the arguments, the inner one of the shape.
type FieldStep = fn(&BoundArgs, &Field) -> Result<Result<Field, InvalidShape>, CallError>;

fn apply_step(args: &BoundArgs, step: FieldStep) -> Result<Arg, CallError> {
    let solid = args.shape(0)?;
    args.shape_result(step(args, &solid.field)?, &[solid])
}

fn repeat(args: &BoundArgs) -> Result<Arg, CallError> {
    let solid: &Solid = args.shape(0)?;
    let (periods, bounds) = (args.numbers::<3>(1)?, solid.field.bounds());
    let mut along = [Repeat::Once; 3];
    let mut copies = 1.0_f64;
    for k in 0..3 {
        let count = args.count(4 + k)?;
        if periods[k] == 0.0 {
            continue;
        }
        along[k] = if count == 0 { Repeat::Every(periods[k]) } else { Repeat::Times(count, periods[k]) };
        // The periods that the box spans on either side of the origin, plus the neighbouring copies.
        let (low, high) = (bounds.min[k].abs(), bounds.max[k].abs());
        let reach = greater(low, high);
        copies *= 3.0 + 2.0 * reach / periods[k].abs();
    }
    // The cast saturates; `repeated` refuses NaN and infinity.
    args.weighted_shape_result(solid.field.repeated(along), &[solid], (copies as u64).saturating_add(1))
}
