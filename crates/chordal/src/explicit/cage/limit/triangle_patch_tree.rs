//! `TrianglePatchTree`: a triangle of a sheet as one polynomial, or subdivided lazily around extraordinary
//! vertices.
use super::quad_patch_tree::{MOST_ROUNDS, vertex_jet};
use super::quartic::Quartic;
use super::{FaceOneRing, Jet, one_ring};
use crate::explicit::cage::InvalidCage;
use crate::explicit::patch::{front, largest};
use std::sync::OnceLock;

/// A triangle. The parts of a subdivided one are in the order of [`QUARTERS`](super::QUARTERS).
#[derive(Clone, Debug)]
pub(crate) enum TrianglePatchTree {
    Regular(Box<LimitQuartic>),
    Extraordinary(Box<ExtraordinaryTriangle>),
}

/// A triangle that is one polynomial.
#[derive(Clone, Debug)]
pub(crate) struct LimitQuartic {
    pub(crate) quartic: Quartic,
    /// The largest rounding error of its points, as a length.
    pub(crate) off: f64,
}

/// A triangle that is not one polynomial.
#[derive(Clone, Debug)]
pub(crate) struct ExtraordinaryTriangle {
    ring: FaceOneRing,
    quarters: OnceLock<Result<Box<[TrianglePatchTree; 4]>, InvalidCage>>,
}

impl TrianglePatchTree {
    pub(super) fn from_ring(ring: FaceOneRing) -> Self {
        match ring.quartic() {
            // A point beyond a border has three times the error of a point, per coordinate; weights are exact
            // up to some dozen roundings.
            Some(quartic) => {
                let off = 18.0 * ring.rounding() + 1024.0 * f64::EPSILON * ring.size();
                Self::Regular(Box::new(LimitQuartic { quartic, off }))
            }
            None => Self::Extraordinary(Box::new(ExtraordinaryTriangle { ring, quarters: OnceLock::new() })),
        }
    }

    pub(crate) fn at(&self, u: f64, v: f64) -> Result<Jet, InvalidCage> {
        match self {
            Self::Regular(polynomial) => Ok(polynomial.at([u, v], 1.0)),
            Self::Extraordinary(extraordinary) => extraordinary.at(u, v),
        }
    }
}

impl LimitQuartic {
    /// Derivatives are multiplied by `scale`, which is negative if the triangle is rotated by half a turn.
    pub(crate) fn at(&self, [u, v]: [f64; 2], scale: f64) -> Jet {
        let (point, [by_u, by_v], second) = self.quartic.at(u, v);
        let (unit, length) = front(by_u, by_v);
        let least = one_ring::LEAST_AREA * largest(by_u) * largest(by_v);
        Jet {
            point,
            first: Some([by_u, by_v].map(|d| d.map(|x| scale * x))),
            second: Some(second.map(|d| d.map(|x| scale * scale * x))),
            normal: (length > least && length.is_finite()).then_some(unit),
        }
    }
}

impl ExtraordinaryTriangle {
    pub(crate) fn ring(&self) -> &FaceOneRing {
        &self.ring
    }

    /// Its quarters, computed on first use and cached.
    pub(crate) fn quarters(&self) -> Result<&[TrianglePatchTree; 4], InvalidCage> {
        let divide = || {
            let mut rings = self.ring.subdivided()?.into_iter();
            let mut next =
                || rings.next().map(TrianglePatchTree::from_ring).ok_or(InvalidCage::ShortFace { face: 0 });
            Ok(Box::new([next()?, next()?, next()?, next()?]))
        };
        self.quarters.get_or_init(divide).as_deref().map_err(Clone::clone)
    }

    /// The jet at the given parameters.
    pub(crate) fn at(&self, mut u: f64, mut v: f64) -> Result<Jet, InvalidCage> {
        let (mut extraordinary, mut scale) = (self, 1.0);
        for _ in 0..MOST_ROUNDS {
            // Only exactly at a corner: anywhere else a finite number of quarters leads to a
            // polynomial, or to rounding.
            if let Some(corner) = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].iter().position(|at| *at == (u, v)) {
                return vertex_jet(&extraordinary.ring, corner);
            }
            let quarter = quarter_at(u, v);
            match quarter {
                0 => (u, v) = (2.0 * u, 2.0 * v),
                1 => (u, v) = (2.0 * u - 1.0, 2.0 * v),
                2 => (u, v) = (2.0 * u, 2.0 * v - 1.0),
                _ => (u, v) = (1.0 - 2.0 * u, 1.0 - 2.0 * v),
            }
            // The central quarter is turned by half a turn, which reverses both parameters.
            scale *= if quarter == 3 { -2.0 } else { 2.0 };
            match &extraordinary.quarters()?[quarter] {
                TrianglePatchTree::Regular(polynomial) => return Ok(polynomial.at([u, v], scale)),
                TrianglePatchTree::Extraordinary(quarter) => extraordinary = quarter,
            }
        }
        // By now the part that contains the point is as small as rounding.
        vertex_jet(&extraordinary.ring, quarter_at(u, v) % 3)
    }
}

fn quarter_at(u: f64, v: f64) -> usize {
    if u >= 0.5 {
        1
    } else if v >= 0.5 {
        2
    } else if u + v <= 0.5 {
        0
    } else {
        3
    }
}
