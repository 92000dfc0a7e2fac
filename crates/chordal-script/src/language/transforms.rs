//! Transforms: placing shapes, and operations on a single shape.
use super::bind::{BoundArgs, Function, ParameterKind as Kind, SHAPE, counted_result, optional, required};
use super::{Arg, CallError, Solid};
use chordal::Tolerance;
use chordal::budget::Failure;
use chordal::convert::redistance;
use chordal::implicit::shapes::InvalidShape;
use chordal::implicit::{DistanceQuality, Field, Repeat};
use chordal::math::greater;

const KEPT: &str = "as for the given shape";
const BOUND: &str = "lower bound";

/// Translations, rotations and the like.
pub(super) const PLACE: &[Function] = &[
    Function {
        name: "move",
        parameters: &[SHAPE, required("x"), required("y"), optional("z", 0.0)],
        about: "The shape moved by the vector (x, y, z).",
        distance: KEPT,
        make: |args| apply_step(args, |args, field| Ok(field.moved(args.numbers(1)?))),
    },
    Function {
        name: "rotate_x",
        parameters: &[SHAPE, required("degrees")],
        about: "The shape rotated around the x axis, counter-clockwise as seen from its positive end.",
        distance: KEPT,
        make: |args| apply_step(args, |args, field| Ok(field.rotated_deg([1.0, 0.0, 0.0], args.number(1)?))),
    },
    Function {
        name: "rotate_y",
        parameters: &[SHAPE, required("degrees")],
        about: "The shape rotated around the y axis.",
        distance: KEPT,
        make: |args| apply_step(args, |args, field| Ok(field.rotated_deg([0.0, 1.0, 0.0], args.number(1)?))),
    },
    Function {
        name: "rotate_z",
        parameters: &[SHAPE, required("degrees")],
        about: "The shape rotated around the z axis; also for 2D shapes.",
        distance: KEPT,
        make: |args| apply_step(args, |args, field| Ok(field.rotated_deg([0.0, 0.0, 1.0], args.number(1)?))),
    },
    Function {
        name: "rotate",
        parameters: &[SHAPE, required("axis").of(Kind::Vector), required("degrees")],
        about: "The shape rotated around an axis through the origin, given as a vector of three numbers.",
        distance: KEPT,
        make: |args| apply_step(args, |args, field| Ok(field.rotated_deg(args.point(1)?, args.number(2)?))),
    },
    Function {
        name: "scale",
        parameters: &[SHAPE, required("factor")],
        about: "The shape scaled about the origin.",
        distance: KEPT,
        make: |args| apply_step(args, |args, field| Ok(field.scaled([args.number(1)?; 3]))),
    },
    Function {
        name: "stretch",
        parameters: &[SHAPE, required("x"), required("y"), optional("z", 1.0)],
        about: "The shape scaled by a separate factor along each axis.",
        distance: BOUND,
        make: |args| apply_step(args, |args, field| Ok(field.scaled(args.numbers(1)?))),
    },
    Function {
        name: "mirror",
        parameters: &[SHAPE, required("x"), required("y"), optional("z", 0.0)],
        about: "The mirror image of the shape in the plane through the origin with the normal (x, y, z).",
        distance: KEPT,
        make: |args| apply_step(args, |args, field| Ok(field.mirrored(args.numbers(1)?))),
    },
    Function {
        name: "repeat",
        parameters: &[
            SHAPE,
            optional("x", 0.0),
            optional("y", 0.0),
            optional("z", 0.0),
            optional("nx", 0.0),
            optional("ny", 0.0),
            optional("nz", 0.0),
        ],
        about: "Copies of the shape: nx, ny and nz of them along the axes (0: infinitely many), at the \
            spacings x, y and z (0: no copies along this axis).",
        distance: "outside the exact distance if it was exact, else sign only; inside a lower bound",
        make: repeat,
    },
    Function {
        name: "linear",
        parameters: &[SHAPE, required("count"), required("x"), optional("y", 0.0), optional("z", 0.0)],
        about: "The given number of copies of the shape in a row, each moved by the vector (x, y, z) from \
            the one before.",
        distance: COPIES,
        make: |args| {
            let (solid, step) = (args.shape(0)?, args.numbers::<3>(2)?);
            let copy = |k: u32| solid.field.moved(step.map(|x| x * f64::from(k)));
            copies(args, solid, copy)
        },
    },
    Function {
        name: "polar",
        parameters: &[SHAPE, required("count"), optional("degrees", 360.0)],
        about: "The given number of copies of the shape around the z axis, spaced evenly over a full turn, \
            or from the first to the last over another angle.",
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
        parameters: &[SHAPE, required("x"), required("y"), optional("z", 0.0)],
        about: "The shape and its mirror image in the plane through the origin with the normal (x, y, z).",
        distance: COPIES,
        make: |args| {
            let solid = args.shape(0)?;
            let union = solid.field.mirrored(args.numbers(1)?).map(|image| solid.field.union(&image));
            args.weighted_shape_result(union, &[solid], 2)
        },
    },
];

const COPIES: &str = "outside as for the given shape, inside a lower bound";

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
        parameters: &[SHAPE, required("by")],
        about: "The shape grown by a distance, or shrunk by a negative one. Its value must be an exact \
            distance or a lower bound on the side that the surface moves to.",
        distance: "exact distance on the side that the surface moves to, if it was exact there; else a lower bound",
        make: |args| apply_step(args, |args, field| Ok(field.offset(args.number(1)?))),
    },
    Function {
        name: "minkowski",
        parameters: &[SHAPE, required("radius")],
        about: "The Minkowski sum with a ball: all points closer than the radius to the shape. Outside, \
            the shape's value must be the exact distance.",
        distance: "exact distance outside, lower bound inside",
        make: |args| {
            let solid = args.shape(0)?;
            if solid.field.distance().outside != DistanceQuality::Exact {
                return Err(args.fault(
                    "needs a shape whose value outside is the exact distance: \
                         write minkowski(redistance(shape, within), radius)",
                ));
            }
            let by = args.number(1)?;
            if by < 0.0 || by.is_nan() {
                return Err(args.fault("needs a radius of at least 0"));
            }
            args.shape_result(solid.field.offset(args.number(1)?), &[solid])
        },
    },
    Function {
        name: "shell",
        parameters: &[SHAPE, required("thickness")],
        about: "A wall along the surface, with half of its thickness on each side. The shape's value must \
            be an exact distance or a lower bound on both sides.",
        distance: "exact distance outside if it was exact on both sides; otherwise a lower bound",
        make: |args| apply_step(args, |args, field| Ok(field.shell(args.number(1)?))),
    },
    Function {
        name: "redistance",
        parameters: &[SHAPE, required("within")],
        about: "The shape with its value replaced by the exact distance to triangles, which approximate \
            its surface within this length.",
        distance: "exact distance to the triangles",
        make: |args| {
            let (solid, within) = (args.shape(0)?, args.number(1)?);
            let fault = |why: &str| CallError(format!("redistance(): {why}"));
            let within = Tolerance::new(within).map_err(|why| fault(&why.to_string()))?;
            let redistanced =
                redistance(&solid.field, within, args.job()).map_err(|failure| match failure {
                    Failure::Unmet(best) => fault(&match best.bound.at_most() {
                        Some(most) => {
                            format!("the best triangles found are up to {most:e} away from the surface")
                        }
                        None => "no triangles were proved to be within this length of the surface".to_owned(),
                    }),
                    Failure::Refused(why) => fault(&why.message.to_string()),
                    Failure::Cancelled => fault("cancelled"),
                })?;
            Ok(Arg::shape(redistanced.shape))
        },
    },
    Function {
        name: "extrude",
        parameters: &[SHAPE, required("height"), optional("bevel", 0.0), optional("rounded", 0.0)],
        about: "A 2D shape extruded to a solid of this height, half above and half below z = 0. A bevel \
            cuts off the edges of both ends at 45 degrees, to this width and height; rounded replaces them \
            by quarter circles of this radius. Both take the depth below the outline from the shape's \
            value.",
        distance: "as for the given shape; with a bevel or rounded edges a lower bound",
        make: |args| {
            apply_step(args, |args, field| {
                let [height, bevel, rounded] = args.numbers(1)?;
                match (bevel == 0.0, rounded == 0.0) {
                    (true, true) => Ok(field.extruded(height)),
                    (false, true) => Ok(field.extruded_with_bevel(height, bevel)),
                    (true, false) => Ok(field.extruded_with_round_edges(height, rounded)),
                    (false, false) => Err(args.fault("takes a bevel or rounded edges, not both")),
                }
            })
        },
    },
    Function {
        name: "section",
        parameters: &[SHAPE, optional("z", 0.0)],
        about: "The cross-section of a solid at the height z, as a 2D shape.",
        distance: BOUND,
        make: |args| apply_step(args, |args, field| Ok(field.section(args.number(1)?))),
    },
    Function {
        name: "taper",
        parameters: &[SHAPE, required("factor"), required("height")],
        about: "A solid of this height, half above and half below z = 0, whose cross-section is the shape \
            scaled from 1 at the bottom to the factor at the top.",
        distance: "lower bound; sign only if the shape is unbounded or its value is only a sign",
        make: |args| apply_step(args, |args, field| Ok(field.tapered(args.number(1)?, args.number(2)?))),
    },
    Function {
        name: "loft",
        parameters: &[required("shapes").of(Kind::Shapes), required("height")],
        about: "A solid of this height, half above and half below z = 0, which blends from the first of a \
            list of 2D shapes to the last. The shapes in between attract it, as control points attract a \
            Bézier curve.",
        distance: BOUND,
        make: |args| {
            let solids = args.shapes()?;
            let profiles: Vec<Field> = solids.iter().map(|solid| solid.field.clone()).collect();
            counted_result(args, Field::lofted(&profiles, args.number(1)?), &solids)
        },
    },
    Function {
        name: "revolve",
        parameters: &[SHAPE],
        about: "A 2D shape revolved around its y axis, which becomes the z axis.",
        distance: "as for the given shape, if it does not touch the axis",
        make: |args| apply_step(args, |_, field| Ok(Ok(field.revolved()))),
    },
    Function {
        name: "twist",
        parameters: &[SHAPE, required("degrees")],
        about: "The shape rotated around the z axis by this angle per unit of height.",
        distance: "lower bound if the shape is bounded around the z axis, else sign only",
        make: |args| apply_step(args, |args, field| Ok(field.twisted(args.number(1)? * RADIANS))),
    },
    Function {
        name: "bend",
        parameters: &[SHAPE, required("degrees")],
        about: "The shape rotated around the z axis by this angle per unit along x.",
        distance: "lower bound if the shape is bounded around the z axis, else sign only",
        make: |args| apply_step(args, |args, field| Ok(field.bent(args.number(1)? * RADIANS))),
    },
    Function {
        name: "displace",
        parameters: &[SHAPE, required("by").of(Kind::Formula), required("amplitude")],
        about: "The shape with a formula added to its value; the amplitude is an upper bound of the \
            formula's absolute value.",
        distance: "sign only",
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
