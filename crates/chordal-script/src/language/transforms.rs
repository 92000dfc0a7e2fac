//! Transforms: placing shapes, and operations on a single shape.
use super::bind::{BoundArgs, Function, optional, required};
use super::{Arg, CallError, Solid};
use chordal::Tolerance;
use chordal::budget::Failure;
use chordal::convert::redistance;
use chordal::implicit::shapes::InvalidShape;
use chordal::implicit::{Field, Repeat};
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
        make: |given| apply_step(given, |given, field| Ok(field.moved(given.numbers(1)?))),
    },
    Function {
        name: "rotate_x",
        parameters: &[required("shape"), required("degrees")],
        about: "The shape turned around the x axis, counter-clockwise as seen from its tip.",
        distance: KEPT,
        make: |given| {
            apply_step(given, |given, field| Ok(field.rotated_deg([1.0, 0.0, 0.0], given.number(1)?)))
        },
    },
    Function {
        name: "rotate_y",
        parameters: &[required("shape"), required("degrees")],
        about: "The shape turned around the y axis.",
        distance: KEPT,
        make: |given| {
            apply_step(given, |given, field| Ok(field.rotated_deg([0.0, 1.0, 0.0], given.number(1)?)))
        },
    },
    Function {
        name: "rotate_z",
        parameters: &[required("shape"), required("degrees")],
        about: "The shape turned around the z axis; so are shapes of the plane.",
        distance: KEPT,
        make: |given| {
            apply_step(given, |given, field| Ok(field.rotated_deg([0.0, 0.0, 1.0], given.number(1)?)))
        },
    },
    Function {
        name: "rotate",
        parameters: &[required("shape"), required("axis"), required("degrees")],
        about: "The shape turned around an axis of three numbers through the origin.",
        distance: KEPT,
        make: |given| {
            apply_step(given, |given, field| Ok(field.rotated_deg(given.point(1)?, given.number(2)?)))
        },
    },
    Function {
        name: "scale",
        parameters: &[required("shape"), required("factor")],
        about: "The shape made larger or smaller, about the origin.",
        distance: KEPT,
        make: |given| apply_step(given, |given, field| Ok(field.scaled([given.number(1)?; 3]))),
    },
    Function {
        name: "stretch",
        parameters: &[required("shape"), required("x"), required("y"), optional("z", 1.0)],
        about: "The shape with its own factor along each axis.",
        distance: BOUND,
        make: |given| apply_step(given, |given, field| Ok(field.scaled(given.numbers(1)?))),
    },
    Function {
        name: "mirror",
        parameters: &[required("shape"), required("x"), required("y"), optional("z", 0.0)],
        about: "The mirror image in the plane through the origin with this normal.",
        distance: KEPT,
        make: |given| apply_step(given, |given, field| Ok(field.mirrored(given.numbers(1)?))),
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
];

/// Operations that change the shape itself.
pub(super) const CHANGE: &[Function] = &[
    Function {
        name: "offset",
        parameters: &[required("shape"), required("by")],
        about: "The shape grown by a distance, or shrunk by a negative one; needs a distance on that side.",
        distance: "exact on the side that the surface moved to, if it was exact there; else a lower bound",
        make: |given| apply_step(given, |given, field| Ok(field.offset(given.number(1)?))),
    },
    Function {
        name: "shell",
        parameters: &[required("shape"), required("thickness")],
        about: "A wall along the surface, half of its thickness to each side; needs a distance on both.",
        distance: "outside exact if it was, inside a lower bound",
        make: |given| apply_step(given, |given, field| Ok(field.shell(given.number(1)?))),
    },
    Function {
        name: "redistance",
        parameters: &[required("shape"), required("within")],
        about: "The shape with a value that is a distance again, to triangles within a length of its surface.",
        distance: "exact, of the triangles",
        make: |given| {
            let (solid, within) = (given.shape(0)?, given.number(1)?);
            let fault = |why: &str| CallError(format!("redistance(): {why}"));
            let within = Tolerance::new(within).map_err(|why| fault(&why.to_string()))?;
            let made = redistance(&solid.field, within, given.job()).map_err(|failure| match failure {
                Failure::Unmet(best) => fault(&match best.bound.at_most() {
                    Some(most) => format!("the best triangles that were found are {most:e} away"),
                    None => "no triangles were proved to be within the length".to_owned(),
                }),
                Failure::Refused(why) => fault(&why.message.to_string()),
                Failure::Cancelled => fault("cancelled"),
            })?;
            Ok(Arg::shape(made.shape))
        },
    },
    Function {
        name: "extrude",
        parameters: &[required("shape"), required("height")],
        about: "A shape of the plane made a solid of that height, half above and half below.",
        distance: KEPT,
        make: |given| apply_step(given, |given, field| Ok(field.extruded(given.number(1)?))),
    },
    Function {
        name: "revolve",
        parameters: &[required("shape")],
        about: "A shape of the plane turned about its y axis, which then stands along z.",
        distance: "as it was, where the shape keeps off the axis",
        make: |given| apply_step(given, |_, field| Ok(Ok(field.revolved()))),
    },
    Function {
        name: "twist",
        parameters: &[required("shape"), required("degrees")],
        about: "The shape turned about z by so much more with each unit of height.",
        distance: "a lower bound, if it is bounded around the axis; else a sign",
        make: |given| apply_step(given, |given, field| Ok(field.twisted(given.number(1)? * RADIANS))),
    },
    Function {
        name: "bend",
        parameters: &[required("shape"), required("degrees")],
        about: "The shape turned about z by so much more with each unit along x.",
        distance: "a lower bound, if it is bounded around the axis; else a sign",
        make: |given| apply_step(given, |given, field| Ok(field.bent(given.number(1)? * RADIANS))),
    },
    Function {
        name: "displace",
        parameters: &[required("shape"), required("by"), required("amplitude")],
        about: "The shape whose value has a formula added, which nowhere exceeds the amplitude in size.",
        distance: "a sign",
        make: |given| {
            let (solid, by) = (given.shape(0)?, given.formula(1)?);
            let field = solid.field.displaced(&by.expr, given.number(2)?);
            given.formula_result(field, solid, &by)
        },
    },
];

/// Radians per degree; derived: π/180, rounded.
pub(super) const RADIANS: f64 = std::f64::consts::PI / 180.0;

/// An operation on a field; the outer error is about arguments.
type FieldStep = fn(&BoundArgs, &Field) -> Result<Result<Field, InvalidShape>, CallError>;

fn apply_step(given: &BoundArgs, step: FieldStep) -> Result<Arg, CallError> {
    let solid = given.shape(0)?;
    given.shape_result(step(given, &solid.field)?, &[solid])
}

fn repeat(given: &BoundArgs) -> Result<Arg, CallError> {
    let solid: &Solid = given.shape(0)?;
    let (periods, bounds) = (given.numbers::<3>(1)?, solid.field.bounds());
    let mut along = [Repeat::Once; 3];
    let mut copies = 1.0_f64;
    for k in 0..3 {
        let count = given.count(4 + k)?;
        if periods[k] == 0.0 {
            continue;
        }
        along[k] = if count == 0 { Repeat::Every(periods[k]) } else { Repeat::Times(count, periods[k]) };
        // As many periods as the box spans on either side, and the next ones.
        let (low, high) = (bounds.min[k].abs(), bounds.max[k].abs());
        let reach = greater(low, high);
        copies *= 3.0 + 2.0 * reach / periods[k].abs();
    }
    // Saturates; the shape itself refuses NaN and infinity.
    given.weighted_shape_result(solid.field.repeated(along), &[solid], (copies as u64).saturating_add(1))
}
