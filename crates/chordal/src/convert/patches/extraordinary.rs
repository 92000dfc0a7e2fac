//! Rough grounds: squares of limit surfaces that are no patches.
use super::derivative_bound::{ROUNDING, UNDERFLOW};
pub(crate) use crate::explicit::cage::limit::ExtraordinaryQuad;

impl ExtraordinaryQuad {
    /// The point at a place of its unit square. Coordinates are checked before to be so small that nothing overflows.
    pub(crate) fn point(&self, u: f64, v: f64) -> [f64; 3] {
        self.at(u, v).map(|jet| jet.point).unwrap_or_default()
    }

    pub(crate) fn normal(&self, u: f64, v: f64) -> Option<[f64; 3]> {
        self.at(u, v).ok()?.normal
    }

    /// What rounding may add to a bound: as for a patch, and what its own divisions may be off by already.
    pub(crate) fn rounding_error(&self) -> f64 {
        let ring = self.ring();
        2.0 * ROUNDING * ring.size() + UNDERFLOW + 36.0 * ring.rounding()
    }
}
