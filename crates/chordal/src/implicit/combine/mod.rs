//! Combinations of shapes: union, intersection, difference, blends, transforms, offsets, repetition.
//!
//! Every operation computes five things: the value, the sign's expression, the distance quality, the bounding
//! box, and the promises about its operands. Operations that need a distance refuse a field whose value is
//! only a sign ([`InvalidShape::NeedsDistance`](super::shapes::InvalidShape)).
mod bend;
mod blend;
mod clip;
mod distribute_blend;
mod face_pairs;
mod fillet;
mod loft;
mod mitred_sweep;
mod offset;
mod profile;
mod repeat;
mod sweep;
mod transform;

pub use fillet::Seam;

use super::construction::Construction;
use super::csg::Csg;
use super::expr::Expr;
use super::field::Field;
use super::leaf::Leaf;
use super::material::{MaterialMark, SurfaceMaterial};
use crate::math::{Box3, add_up, greater, lesser, sub_down};
use std::sync::Arc;

impl Field {
    /// The union: `min(a, b)`. Outside, the value is as good a distance as those of both operands; inside, a
    /// bound.
    ///
    /// ```
    /// use chordal::implicit::shapes::{cuboid, cylinder};
    /// let drilled = cuboid([2.0, 2.0, 1.0])?.difference(&cylinder(0.4, 2.0)?);
    /// assert!(drilled.expr().at([0.0; 3]).unwrap() > 0.0);
    /// assert!(drilled.expr().at([0.9, 0.0, 0.0]).unwrap() < 0.0);
    /// # Ok::<(), chordal::implicit::shapes::InvalidShape>(())
    /// ```
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        let union = Self::from_parts(self.expr().min(other.expr()), &[self, other])
            .known_distance(self.distance().union(other.distance()))
            .known_bounds(self.bounds().union(other.bounds()))
            .known_construction(Construction::union(self, other))
            .known_slack(greater(self.slack(), other.slack()));
        if self.has_sign() || other.has_sign() {
            // Where one of the two is inside, the smaller value is its own depth.
            let has_depth = self.depth().is_some() && other.depth().is_some();
            union.replace_sign(self.sign().min(other.sign())).with_depth(has_depth)
        } else {
            union
        }
    }

    /// The intersection: `max(a, b)`. Inside, the value is as good a distance as those of both operands;
    /// outside, a bound.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        let intersection = Self::from_parts(self.expr().max(other.expr()), &[self, other])
            .known_distance(self.distance().intersection(other.distance()))
            .known_bounds(common(self.bounds(), other.bounds()))
            .known_construction(Construction::intersection(self, other))
            .known_slack(greater(self.slack(), other.slack()));
        // Outside the bounds one of the two is not inside, whatever the sign of the other.
        let sign = |field: &Self| field.sign_within(&intersection.bounds());
        if [self, other].iter().any(|field| field.has_sign() || field.pattern().is_some()) {
            // The sign of a pattern lists the copies that its value reaches by steps.
            let has_depth =
                [self, other].iter().all(|field| field.depth().is_some() && field.pattern().is_none());
            let sign = sign(self).max(&sign(other));
            intersection.replace_sign(sign).with_depth(has_depth)
        } else {
            intersection
        }
    }

    /// The points of this shape that are not in the other: `max(a, −b)`.
    #[must_use]
    pub fn difference(&self, other: &Self) -> Self {
        self.intersection(&other.complement())
    }

    /// The complement: `−a`. (A point of the surface itself belongs to neither.)
    #[must_use]
    pub fn complement(&self) -> Self {
        let complement = Self::from_parts(-self.expr(), &[self]).known_distance(self.distance().complement());
        let construction = self.construction().and_then(Construction::complement);
        let complement = complement.map_sign(self, |sign| -sign).known_construction(construction);
        let complement = complement.known_slack(self.slack());
        match self.pattern() {
            Some(pattern) => complement.with_pattern(pattern.complement()),
            None => complement,
        }
    }

    /// The points of exactly one of the two: `max(min(a, b), −max(a, b))`.
    #[must_use]
    pub fn xor(&self, other: &Self) -> Self {
        self.union(other).difference(&self.intersection(other))
    }

    /// The union of many fields as a balanced tree: time and memory are linear, and the depth is logarithmic.
    /// Empty if there are none.
    #[must_use]
    pub fn union_of(fields: &[Self]) -> Self {
        balanced(fields, Self::union).unwrap_or_else(Self::nothing)
    }

    /// The intersection of many fields, as [`Field::union_of`]. All of space if there are none.
    #[must_use]
    pub fn intersection_of(fields: &[Self]) -> Self {
        balanced(fields, Self::intersection).unwrap_or_else(|| Self::nothing().complement())
    }

    /// The empty shape.
    #[must_use]
    pub fn nothing() -> Self {
        // Any number is a bound on an infinite distance; the largest serves as well as infinity.
        Self::new(Expr::constant(f64::MAX)).known_distance(super::Distance::BOUND).known_bounds(Box3::EMPTY)
    }

    /// The same shape with this material throughout; materials of its parts are overridden.
    ///
    /// Unions, differences, transforms and all other operations keep the materials of their parts. Where
    /// parts meet, so do their materials: [`field_to_mesh`](crate::convert::field_to_mesh()) gives each face
    /// the number of its material. A face of an intersection or difference whose own part has no material
    /// gets the material of the solid behind it. If two parts share a surface, the first one's material wins.
    /// In a blend each place has the material of the nearer part.
    ///
    /// ```
    /// use chordal::explicit::Semantic;
    /// use chordal::implicit::{materials::SurfaceMaterial, shapes::sphere};
    /// use chordal::{Budget, Job, Tolerance, convert};
    /// let red = SurfaceMaterial { name: "red".into(), color: [1.0, 0.0, 0.0, 1.0], metallic: 0.0, roughness: 0.5 };
    /// let both = sphere(1.0)?.with_material(red.clone()).union(&sphere(1.0)?.moved([1.0, 0.0, 0.0])?);
    /// assert_eq!(both.materials(), [red]);
    /// let bounded = convert::field_to_mesh(&both, &Budget::length(Tolerance::new(0.05)?), &Job::default())?;
    /// let numbers = bounded.shape.attribute(&Semantic::Group("material".into())).expect("one for each face");
    /// assert!(numbers.values.contains(&1.0) && numbers.values.contains(&0.0)); // 0 is none
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn with_material(&self, material: SurfaceMaterial) -> Self {
        let mark: Arc<dyn Leaf> = Arc::new(MaterialMark(material));
        self.map_expressions(|expr| expr.marked(&mark))
    }

    /// The materials of its surface, in the order of their numbers from 1. Cost: as for a CSG tree.
    #[must_use]
    pub fn materials(&self) -> Vec<SurfaceMaterial> {
        Csg::from_expr(self.sign()).materials().map_or_else(Vec::new, |materials| materials.list().to_vec())
    }

    /// Gives the field the mapped sign of `from`, if `from` has its own.
    fn map_sign(self, from: &Self, map: impl FnOnce(&Expr) -> Expr) -> Self {
        if from.has_sign() { self.replace_sign(map(from.sign())) } else { self }
    }
}

fn balanced(fields: &[Field], join: fn(&Field, &Field) -> Field) -> Option<Field> {
    let mut level = fields.to_vec();
    while level.len() > 1 {
        level =
            level.chunks(2).map(|two| if let [a, b] = two { join(a, b) } else { two[0].clone() }).collect();
    }
    level.pop()
}

/// The intersection of two boxes; the empty box if they are apart.
fn common(a: Box3, b: Box3) -> Box3 {
    let common = Box3 {
        min: std::array::from_fn(|k| greater(a.min[k], b.min[k])),
        max: std::array::from_fn(|k| lesser(a.max[k], b.max[k])),
    };
    if common.is_empty() { Box3::EMPTY } else { common }
}

/// The box grown by `by` on every side, rounded outward; an empty box stays empty.
fn grown(bounds: Box3, by: f64) -> Box3 {
    if bounds.is_empty() {
        return bounds;
    }
    Box3 { min: bounds.min.map(|x| sub_down(x, by)), max: bounds.max.map(|x| add_up(x, by)) }
}
