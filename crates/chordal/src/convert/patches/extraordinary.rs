//! Extraordinary subpatches: quads of limit surfaces that are no Bézier patches.
use super::derivative_bound::{ROUNDING, UNDERFLOW};
pub(crate) use crate::explicit::cage::limit::ExtraordinaryQuad;

impl ExtraordinaryQuad {
    /// The point at a parameter of the unit square. Coordinates are small enough by an earlier check that nothing
    /// overflows.
    pub(crate) fn point(&self, u: f64, v: f64) -> [f64; 3] {
        self.at(u, v).map(|jet| jet.point).unwrap_or_default()
    }

    pub(crate) fn normal(&self, u: f64, v: f64) -> Option<[f64; 3]> {
        self.at(u, v).ok()?.normal
    }

    /// The length that rounding may add to a bound: as for a patch, plus the error of its own subdivision.
    pub(crate) fn rounding_error(&self) -> f64 {
        let ring = self.ring();
        2.0 * ROUNDING * ring.size() + UNDERFLOW + 36.0 * ring.rounding()
    }
}
