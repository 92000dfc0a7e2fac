//! `SurfaceMaterial`: the look of a surface of a part of a field. Operations carry it and never compute with
//! it.
//!
//! An expression carries a material as a leaf that returns its operand. Graphs and tapes leave it out, so
//! that a field with materials has the same values, to the last bit, as one without. Only a CSG tree keeps it
//! ([`Csg::materials`](super::csg::Csg::materials)), and so knows the material of each primitive.
use super::expr::{Expr, ExprKind};
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
