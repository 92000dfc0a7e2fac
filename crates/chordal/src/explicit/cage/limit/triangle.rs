//! `Triangle`: a triangle of a sheet as one polynomial, or divided, as deep as anybody has asked.
use super::quartic::Quartic;
use super::square::{MOST_ROUNDS, vertex};
use super::{Jet, Ring, fan};
use crate::explicit::cage::InvalidCage;
use crate::explicit::patch::{front, largest};
use std::sync::OnceLock;

/// A triangle. Where it is divided its parts are in the order of [`QUARTERS`](super::QUARTERS).
#[derive(Clone, Debug)]
pub(crate) enum Triangle {
    Polynomial(Box<Polynomial>),
    Rough(Box<RoughTriangle>),
}

/// One that is a polynomial.
#[derive(Clone, Debug)]
pub(crate) struct Polynomial {
    pub(crate) quartic: Quartic,
    /// By how much a point of it may be off by rounding, a length.
    pub(crate) off: f64,
}

/// One that is none.
#[derive(Clone, Debug)]
pub(crate) struct RoughTriangle {
    ring: Ring,
    quarters: OnceLock<Result<Box<[Triangle; 4]>, InvalidCage>>,
}

impl Triangle {
    pub(super) fn of(ring: Ring) -> Self {
        match ring.quartic() {
            // A point beyond a border is off by three times as much as a point, a coordinate; shares are exact but for some dozen roundings.
            Some(quartic) => {
                let off = 18.0 * ring.off() + 1024.0 * f64::EPSILON * ring.size();
                Self::Polynomial(Box::new(Polynomial { quartic, off }))
            }
            None => Self::Rough(Box::new(RoughTriangle { ring, quarters: OnceLock::new() })),
        }
    }

    pub(crate) fn at(&self, u: f64, v: f64) -> Result<Jet, InvalidCage> {
        match self {
            Self::Polynomial(polynomial) => Ok(polynomial.at([u, v], 1.0)),
            Self::Rough(rough) => rough.at(u, v),
        }
    }
}

impl Polynomial {
    /// Derivatives are multiplied by a scale, which is negative where the triangle is turned by half.
    pub(crate) fn at(&self, [u, v]: [f64; 2], scale: f64) -> Jet {
        let (point, [by_u, by_v], second) = self.quartic.at(u, v);
        let (unit, length) = front(by_u, by_v);
        let least = fan::LEAST_AREA * largest(by_u) * largest(by_v);
        Jet {
            point,
            first: Some([by_u, by_v].map(|d| d.map(|x| scale * x))),
            second: Some(second.map(|d| d.map(|x| scale * scale * x))),
            normal: (length > least && length.is_finite()).then_some(unit),
        }
    }
}

impl RoughTriangle {
    pub(crate) fn ring(&self) -> &Ring {
        &self.ring
    }

    /// Its quarters: made when they are first asked for, and kept.
    pub(crate) fn quarters(&self) -> Result<&[Triangle; 4], InvalidCage> {
        let divide = || {
            let mut rings = self.ring.divided()?.into_iter();
            let mut next = || rings.next().map(Triangle::of).ok_or(InvalidCage::ShortFace { face: 0 });
            Ok(Box::new([next()?, next()?, next()?, next()?]))
        };
        self.quarters.get_or_init(divide).as_deref().map_err(Clone::clone)
    }

    /// At a place of it.
    pub(crate) fn at(&self, mut u: f64, mut v: f64) -> Result<Jet, InvalidCage> {
        let (mut rough, mut scale) = (self, 1.0);
        for _ in 0..MOST_ROUNDS {
            if let Some(corner) = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].iter().position(|at| *at == (u, v)) {
                return vertex(&rough.ring, corner);
            }
            let quarter = quarter_at(u, v);
            match quarter {
                0 => (u, v) = (2.0 * u, 2.0 * v),
                1 => (u, v) = (2.0 * u - 1.0, 2.0 * v),
                2 => (u, v) = (2.0 * u, 2.0 * v - 1.0),
                _ => (u, v) = (1.0 - 2.0 * u, 1.0 - 2.0 * v),
            }
            scale *= if quarter == 3 { -2.0 } else { 2.0 };
            match &rough.quarters()?[quarter] {
                Triangle::Polynomial(polynomial) => return Ok(polynomial.at([u, v], scale)),
                Triangle::Rough(quarter) => rough = quarter,
            }
        }
        // The one that it is in, or between, by now is no larger than rounding.
        vertex(&rough.ring, quarter_at(u, v) % 3)
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
