//! Shapes as fields: their constructors, and the quality of their values as distances.
//!
//! | shape | value |
//! |---|---|
//! | [`sphere`], [`cuboid`], [`rounded_cuboid`], [`cylinder`] | exact |
//! | [`capped_cone`], [`capsule`], [`plane`], [`triangle`] | exact |
//! | [`torus`] | exact; a bound inside where it meets itself |
//! | [`tetrahedron`], [`octahedron`] | exact inside, a bound outside |
//! | [`ellipsoid`] | a bound |
//! | [`gyroid`], [`schwarz_p`], [`diamond`] | a bound |
//! | [`circle`], [`rectangle`], [`rounded_rectangle`], [`segment`] | exact, unbounded along z |
//! | [`regular_polygon`], [`polygon`] | exact, unbounded along z |
//! | [`prism`], [`hull`], [`hull_of`] | exact |
//! | [`planar_hull`] | exact, unbounded along z |
//! | [`thread`] | a sign |
//!
//! Shapes are centred on the origin unless they are given by points. The numbers that a constructor derives
//! from its arguments (half sizes, unit normals, sines) are rounded to f64, and the rounded numbers define
//! the shape. A value is *exact* for that shape up to rounding.
//!
//! A *bound* here is always 1-Lipschitz (it changes by no more than the distance moved), so offsets and
//! blends of it are bounds again.
//!
//! Source: I. Quilez, *Distance functions* and *2D distance functions*, iquilezles.org; the formulas are
//! derived anew.
mod axis_distance;
mod contours;
mod contours_build;
mod contours_leaf;
mod half_planes;
mod hull;
mod hull_of;
mod leaf_expr;
mod periodic;
mod planar;
mod round;
mod solid;
mod thread;
mod triangle;

use super::expr::Expr;
use super::field::Field;
use crate::math::Box3;
use std::fmt;

pub(super) use axis_distance::{axis_distance, is_axis_distance};
pub use contours::{ContourFill, Contours};
pub use hull::{hull, planar_hull};
pub use hull_of::hull_of;
pub(crate) use leaf_expr::leaf_as_expr;
pub use periodic::{diamond, gyroid, schwarz_p};
pub use planar::{circle, polygon, prism, rectangle, regular_polygon, rounded_rectangle, segment};
pub use round::{capsule, ellipsoid, sphere, torus};
pub(super) use solid::unit;
pub use solid::{capped_cone, cuboid, cylinder, octahedron, plane, rounded_cuboid, tetrahedron};
pub use thread::{ThreadForm, thread};
pub use triangle::triangle;

/// The reason why a shape is invalid, in one sentence.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum InvalidShape {
    /// A number is out of its range.
    Number(String),
    /// The operation needs a distance, and the field's value is only a sign on that side.
    NeedsDistance {
        /// The operation that was called.
        operation: &'static str,
        /// The side on which the value is only a sign: `outside` or `inside`.
        side: &'static str,
    },
}

impl fmt::Display for InvalidShape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(sentence) => f.write_str(sentence),
            Self::NeedsDistance { operation, side } => {
                write!(
                    f,
                    "{operation} needs a distance, and {side} of this shape the value is only a sign: \
                     redistance(shape, within) makes it a distance"
                )
            }
        }
    }
}

impl std::error::Error for InvalidShape {}

/// The number, if it is finite.
pub(super) fn finite(name: &str, value: f64) -> Result<f64, InvalidShape> {
    if value.is_finite() { Ok(value) } else { Err(refused(name, value, "a finite number")) }
}

/// The number, if it is finite and above 0.
pub(super) fn positive(name: &str, value: f64) -> Result<f64, InvalidShape> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(refused(name, value, "a finite number above 0"))
    }
}

/// The number, if it is finite and not below 0.
pub(super) fn not_negative(name: &str, value: f64) -> Result<f64, InvalidShape> {
    if value >= 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(refused(name, value, "a finite number, 0 or above"))
    }
}

/// The point, if it is finite.
pub(super) fn finite_point<const D: usize>(name: &str, point: [f64; D]) -> Result<[f64; D], InvalidShape> {
    point.iter().try_for_each(|x| finite(name, *x).map(|_| ()))?;
    Ok(point)
}

fn refused(name: &str, value: f64, expected: &str) -> InvalidShape {
    InvalidShape::Number(format!("{name} is {value}, and must be {expected}"))
}

/// `√(Σ e²)`.
pub(super) fn length_of(parts: &[&Expr]) -> Expr {
    sum(parts.iter().map(|e| e.square())).sqrt()
}

/// The sum, from left to right.
pub(super) fn sum(parts: impl IntoIterator<Item = Expr>) -> Expr {
    parts.into_iter().reduce(|a, b| a + b).unwrap_or_else(|| Expr::constant(0.0))
}

/// The largest.
pub(super) fn largest(parts: &[Expr]) -> Expr {
    parts.iter().cloned().reduce(|a, b| a.max(&b)).unwrap_or_else(|| Expr::constant(f64::NEG_INFINITY))
}

/// The distance to the region where all of `parts` are below 0, if each is the distance to one of several
/// perpendicular slabs. Outside, the parts above 0 add up as squares; inside, the largest is nearest.
pub(super) fn slabs(parts: &[Expr]) -> Expr {
    outside_of_slabs(parts) + largest(parts).min(&Expr::constant(0.0))
}

/// All points nearer than a radius to that region. The sign expression uses the distance to the region, which
/// is 0 inside: a convex function.
pub(super) fn rounded_slabs(parts: &[Expr], radius: f64) -> Field {
    Field::new(slabs(parts) - radius).known_sign(outside_of_slabs(parts) - radius)
}

/// The same, with 0 for all points inside.
fn outside_of_slabs(parts: &[Expr]) -> Expr {
    let zero = Expr::constant(0.0);
    let above: Vec<Expr> = parts.iter().map(|q| q.max(&zero)).collect();
    length_of(&above.iter().collect::<Vec<_>>())
}

/// The box with these half sizes around the origin.
pub(super) fn centred(half: [f64; 3]) -> Box3 {
    Box3 { min: half.map(|h| -h), max: half }
}
