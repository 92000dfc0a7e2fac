//! `SurfaceMaterial`: the look of a surface of a part of a field. Operations carry it and never compute with
//! it.
//!
//! An expression carries a material as a leaf that returns its operand. Graphs and tapes leave it out, so
//! that a field with materials has the same values, to the last bit, as one without. Only a CSG tree keeps it
//! ([`Csg::materials`](super::csg::Csg::materials)), and so knows the material of each primitive.
use super::expr::{Expr, ExprKind};
use super::field::Field;
use super::leaf::{Leaf, LeafAnswer, LeafError};
use crate::budget::Evidence;
use crate::math::{Box3, Interval};
use std::sync::Arc;

/// The look of a surface, in the terms of glTF's metallic-roughness model.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceMaterial {
    /// Its name; may be empty.
    pub name: String,
    /// Red, green, blue and opacity from 0 to 1; the first three as encoded for a screen (sRGB).
    pub color: [f64; 4],
    /// From 0 for a non-metal to 1 for a metal.
    pub metallic: f64,
    /// From 0 for a mirror to 1.
    pub roughness: f64,
}

/// A leaf that returns its first coordinate: the operand with the material.
#[derive(Debug)]
pub(super) struct MaterialMark(pub SurfaceMaterial);

impl MaterialMark {
    /// The mark, if a leaf is one.
    pub fn from_leaf(leaf: &Arc<dyn Leaf>) -> Option<&Self> {
        leaf.as_any()?.downcast_ref()
    }
}

impl Leaf for MaterialMark {
    fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        out.iter_mut().zip(points).for_each(|(out, [value, ..])| *out = *value);
        Ok(())
    }

    fn gradient_at(&self, _: &[[f64; 3]], out: &mut [[f64; 3]]) -> Result<LeafAnswer, LeafError> {
        out.fill([1.0, 0.0, 0.0]);
        Ok(LeafAnswer::Given)
    }

    fn over(&self, boxes: &[Box3], out: &mut [Interval]) -> Result<LeafAnswer, LeafError> {
        for (out, bounds) in out.iter_mut().zip(boxes) {
            *out = Interval::new(bounds.min[0], bounds.max[0]).unwrap_or(Interval::UNKNOWN);
        }
        Ok(LeafAnswer::Given)
    }

    fn gradient_over(&self, _: &[Box3], out: &mut [[Interval; 3]]) -> Result<LeafAnswer, LeafError> {
        out.fill([1.0, 0.0, 0.0].map(Interval::point));
        Ok(LeafAnswer::Given)
    }

    fn evidence(&self) -> Evidence {
        Evidence::Proved
    }

    fn as_any(&self) -> Option<&dyn std::any::Any> {
        Some(self)
    }
}

impl Expr {
    /// The same expression with this material.
    pub(super) fn marked(&self, mark: &Arc<dyn Leaf>) -> Self {
        Self::leaf(Arc::clone(mark), [self.clone(), self.clone(), self.clone()])
    }

    /// The mark at the root, and the expression below it.
    pub(super) fn mark(&self) -> Option<(&Arc<dyn Leaf>, &Self)> {
        let ExprKind::Leaf(leaf, [below, ..]) = self.kind() else { return None };
        MaterialMark::from_leaf(leaf).map(|_| (leaf, below))
    }
}

impl Field {
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
    /// let made = convert::field_to_mesh(&both, &Budget::length(Tolerance::new(0.05)?), &Job::default())?;
    /// let numbers = made.shape.attribute(&Semantic::Group("material".into())).expect("one for each face");
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
        super::Csg::from_expr(self.sign())
            .materials()
            .map_or_else(Vec::new, |materials| materials.list().to_vec())
    }
}
