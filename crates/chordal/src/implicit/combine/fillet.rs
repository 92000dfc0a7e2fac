//! Unions, intersections and differences whose seam is a fillet or a chamfer.
//!
//! The blend works face by face: both shapes are taken apart into the primitives of their values, and each
//! pair of faces gets its own arc or flat. So faces that both shapes share stay unchanged, while a blend of
//! the two values would swell them.
use super::face_pairs::{FaceBlend, PARALLEL, PlaneForm, distribute_faces};
use super::{common, grown};
use crate::implicit::outside::is_empty_outside;
use crate::implicit::shapes::{InvalidShape, positive};
use crate::implicit::{Distance, DistanceQuality, Expr, Field, Tape};
use crate::math::{Box3, add_up, sqrt_up};

/// The seam that replaces the edge in which two shapes meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Seam {
    /// An arc. If faces meet at a right angle, it is a quarter of a circle of this radius; at other angles a
    /// part of an ellipse. It touches each face at this distance from the other.
    Fillet(f64),
    /// A flat that cuts each face at this distance from the other: at a right angle, 45° with legs of this
    /// length.
    Chamfer(f64),
}

impl Seam {
    fn size(self) -> f64 {
        match self {
            Self::Fillet(size) | Self::Chamfer(size) => size,
        }
    }
}

/// The reach of a seam beyond a shape's box, in sizes of the seam. Chosen: at an edge of 60° the seams of
/// both sides meet at that distance; at sharper edges the tip is cut off.
const REACH: f64 = 2.0;

impl Field {
    /// The union with its inner edges filled. Outer edges and faces stay unchanged; edges of one shape
    /// continue through the fillet.
    ///
    /// The value is a bound: the smallest of both values and the blend of each pair of faces, which is
    /// 1-Lipschitz. Both values must be distances or bounds outside.
    ///
    /// # Errors
    /// When the size is not a finite number above 0, or a field has only a sign outside.
    ///
    /// ```
    /// use chordal::implicit::{Seam, shapes::cuboid};
    /// let plate = cuboid([4.0, 4.0, 2.0])?;
    /// let wall = cuboid([2.0, 4.0, 6.0])?.moved([-1.0, 0.0, 2.0])?;
    /// let both = plate.union_with(&wall, Seam::Fillet(0.5))?;
    /// // On the arc around (0.5, 1.5), and off it; the side that both share is where it was.
    /// let [below, above] = [0.14, 0.15].map(|d| both.expr().at([d, 0.0, 1.0 + d]).unwrap());
    /// assert!(below < 0.0 && above > 0.0);
    /// assert!(both.expr().at([0.0, 2.001, 1.0]).unwrap() > 0.0);
    /// # Ok::<(), chordal::implicit::shapes::InvalidShape>(())
    /// ```
    pub fn union_with(&self, other: &Self, seam: Seam) -> Result<Self, InvalidShape> {
        let size = seam_size(seam)?;
        let joined = self.bounds().union(other.bounds());
        let near = common(grown(self.bounds(), REACH * size), grown(other.bounds(), REACH * size));
        // A seam is within the hull of both, except for the third of its size by which touching faces swell.
        let region = common(near, grown(joined, size / 3.0));
        let union = self.with_seam(other, seam, region)?;
        let tight =
            is_finite(&joined) && is_empty_outside(&Tape::new(union.sign()), &grown(joined, size * MARGIN));
        Ok(union.known_bounds(if tight { grown(joined, size * MARGIN) } else { joined.union(region) }))
    }

    /// The intersection with the edges rounded or cut off in which both shapes meet. Needs distances or
    /// bounds inside.
    ///
    /// # Errors
    /// As for [`Field::union_with`], with the inside.
    pub fn intersection_with(&self, other: &Self, seam: Seam) -> Result<Self, InvalidShape> {
        let overlap = common(self.bounds(), other.bounds());
        let region = grown(overlap, seam_size(seam)?);
        let cut = self.complement().with_seam(&other.complement(), seam, region).map_err(inside)?;
        // It only removes points.
        Ok(cut.complement().known_bounds(overlap))
    }

    /// The difference with the edges rounded or cut off in which both shapes meet, as the rim of a hole.
    ///
    /// # Errors
    /// As for [`Field::union_with`]: this field's inside and the other's outside are needed.
    pub fn difference_with(&self, other: &Self, seam: Seam) -> Result<Self, InvalidShape> {
        let size = seam_size(seam)?;
        let region = common(grown(self.bounds(), size), grown(other.bounds(), REACH * size));
        let cut = self.complement().with_seam(other, seam, region).map_err(inside)?;
        Ok(cut.complement().known_bounds(self.bounds()))
    }

    /// The union with the seams within a region.
    fn with_seam(&self, other: &Self, seam: Seam, region: Box3) -> Result<Self, InvalidShape> {
        for field in [self, other] {
            if field.distance().outside == DistanceQuality::Sign {
                let operation = if matches!(seam, Seam::Fillet(_)) { "a fillet" } else { "a chamfer" };
                return Err(InvalidShape::NeedsDistance { operation, side: "outside" });
            }
        }
        let (first, second) = (self.as_distance(), other.as_distance());
        let plain = first.union(&second);
        let inside = self.distance().union(other.distance()).inside;
        let plain = plain.known_distance(Distance { outside: DistanceQuality::Bound, inside });
        if region.is_empty() {
            return Ok(plain);
        }
        let blend = |a: &Expr, b: &Expr| blend_faces(a, b, seam);
        let Some(seams) = distribute_faces(self.expr(), other.expr(), &blend, seam.size(), &region) else {
            return Ok(plain);
        };
        // With the walls, the seams are above 0 beyond the region.
        let seams = walls(&region).iter().fold(seams, |seams, wall| seams.max(wall));
        let value = plain.expr().min(&seams);
        let sign = plain.sign().min(&seams);
        let seamed = Self::from_parts(value, &[&first, &second]).known_sign(sign);
        Ok(seamed.known_distance(plain.distance()).known_bounds(plain.bounds()))
    }
}

/// Margin for the rounding of intervals at the sides of a box, as a share of a seam's size. Chosen: far above
/// rounding, and too small to be seen; a smaller margin would leave some tight boxes unproved.
const MARGIN: f64 = 1.0 / (1_u64 << 30) as f64;

fn seam_size(seam: Seam) -> Result<f64, InvalidShape> {
    let name = if matches!(seam, Seam::Fillet(_)) { "a fillet's radius" } else { "a chamfer's length" };
    positive(name, seam.size())
}

fn is_finite(bounds: &Box3) -> bool {
    !bounds.is_empty() && bounds.min.iter().chain(&bounds.max).all(|x| x.is_finite())
}

fn inside(error: InvalidShape) -> InvalidShape {
    match error {
        InvalidShape::NeedsDistance { operation, .. } => {
            InvalidShape::NeedsDistance { operation, side: "inside" }
        }
        number => number,
    }
}

/// The finite sides of a box.
fn walls(region: &Box3) -> Vec<Expr> {
    let mut walls = Vec::new();
    for (k, axis) in Expr::axes().iter().enumerate() {
        if region.max[k].is_finite() {
            walls.push(axis - region.max[k]);
        }
        if region.min[k].is_finite() {
            walls.push(Expr::constant(region.min[k]) - axis);
        }
    }
    walls
}

/// The smaller one with an arc of this radius in place of its kink; as for a smooth union, it is moved away
/// from the places where it would equal an operand.
pub(super) fn round_blend(a: &Expr, b: &Expr, radius: f64) -> Expr {
    let start = 0.25 * radius;
    let beyond = (a - b).abs() - (radius + start);
    a.round_min(b, radius) - (-beyond).smooth_min(&0.0.into(), start) * 0.5
}

/// The blend of two faces. It grows with both, is 1-Lipschitz if they are, and has the sign of their union
/// except on the seam.
fn blend_faces(a: &Expr, b: &Expr, seam: Seam) -> FaceBlend {
    let planes = (PlaneForm::from_expr(a), PlaneForm::from_expr(b));
    if let (Some(p), Some(q)) = &planes
        && p.cosine(q).abs() > PARALLEL
    {
        return FaceBlend::Sharp(a.min(b));
    }
    match seam {
        Seam::Fillet(radius) => FaceBlend::Round(round_blend(a, b, radius)),
        Seam::Chamfer(length) => {
            // The slope of the sum: known for planes, at most 2 otherwise.
            let slope = match planes {
                (Some(p), Some(q)) => {
                    let sum: [f64; 3] = std::array::from_fn(|k| p.slope[k] + q.slope[k]);
                    let square = sum.iter().fold(0.0, |total, x| add_up(total, add_up(x * x, 0.0)));
                    // Each slope is off by some roundings.
                    sqrt_up(add_up(square, 64.0 * f64::EPSILON))
                }
                _ => 2.0,
            };
            FaceBlend::Round((a + b - length) / slope)
        }
    }
}
