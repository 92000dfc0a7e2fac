//! `LoopCell`: a triangle of a sheet, with a surface that is one polynomial, or is not yet subdivided into
//! polynomials.
use crate::convert::patches::derivative_bound::UNDERFLOW;
use crate::explicit::cage::limit::{ExtraordinaryTriangle, LimitQuartic, TrianglePatchTree};
use crate::math::{Box3, greater};

#[derive(Clone, Copy)]
pub(crate) struct LoopCell<'a> {
    pub(crate) sheet: u32,
    pub(crate) shape: LoopCellShape<'a>,
    /// Its origin on the sheet.
    pub(crate) begin: [f64; 2],
    /// Its width as a fraction of the sheet's; negative if it is rotated by half a turn.
    pub(crate) scale: f64,
}

#[derive(Clone, Copy)]
pub(crate) enum LoopCellShape<'a> {
    Polynomial(&'a LimitQuartic),
    Extraordinary(&'a ExtraordinaryTriangle),
}

/// Rounding of values computed from a polynomial, as a fraction of its largest coordinate; derived in
/// [`super::derivative_bound`].
const ROUNDING: f64 = 4096.0 * f64::EPSILON;
/// The additional rounding per point of a one-ring for a limit that is reached after ninety rounds, of two roundings
/// per point each.
const ROUNDING_BY_POINT: f64 = 256.0 * f64::EPSILON;

impl<'a> LoopCellShape<'a> {
    pub(crate) fn from_triangle(triangle: &'a TrianglePatchTree) -> Self {
        match triangle {
            TrianglePatchTree::Regular(polynomial) => Self::Polynomial(polynomial),
            TrianglePatchTree::Extraordinary(extraordinary) => Self::Extraordinary(extraordinary),
        }
    }

    /// Points whose convex hull contains the surface.
    pub(crate) fn hull(&self) -> &'a [[f64; 3]] {
        match self {
            Self::Polynomial(polynomial) => &polynomial.quartic.control,
            Self::Extraordinary(extraordinary) => extraordinary.ring().hull(),
        }
    }

    /// The length that rounding may add to a bound, and the error of a vertex.
    pub(crate) fn rounding_error(&self) -> f64 {
        let points = self.hull();
        let larger = |most: f64, x: &f64| greater(x.abs(), most);
        let size = points.as_flattened().iter().fold(0.0, larger);
        match self {
            Self::Polynomial(polynomial) => ROUNDING * size + UNDERFLOW + polynomial.off,
            Self::Extraordinary(extraordinary) => {
                let share = ROUNDING + ROUNDING_BY_POINT * points.len() as f64;
                share * size + UNDERFLOW + 36.0 * extraordinary.ring().rounding()
            }
        }
    }

    /// Coordinates are checked beforehand to be so small that nothing overflows.
    pub(crate) fn point(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        match self {
            Self::Polynomial(polynomial) => polynomial.quartic.point([u, v]),
            Self::Extraordinary(extraordinary) => {
                extraordinary.at(u, v).map(|jet| jet.point).unwrap_or_default()
            }
        }
    }

    pub(crate) fn normal(&self, [u, v]: [f64; 2]) -> Option<[f64; 3]> {
        match self {
            Self::Polynomial(polynomial) => polynomial.at([u, v], 1.0).normal,
            Self::Extraordinary(extraordinary) => extraordinary.at(u, v).ok()?.normal,
        }
    }
}

impl<'a> LoopCell<'a> {
    pub(crate) fn bounding_box(&self) -> Box3 {
        Box3::from_points(self.shape.hull())
    }

    /// The quarters of an extraordinary cell; empty if coordinates overflow.
    pub(crate) fn quarters(&self) -> Vec<Self> {
        let LoopCellShape::Extraordinary(extraordinary) = self.shape else { return Vec::new() };
        let Ok(quarters) = extraordinary.quarters() else { return Vec::new() };
        let half = 0.5 * self.scale;
        let begins = [([0.0, 0.0], half), ([half, 0.0], half), ([0.0, half], half), ([half, half], -half)];
        let part = |(quarter, (begin, scale)): (&'a TrianglePatchTree, ([f64; 2], f64))| {
            let begin = [self.begin[0] + begin[0], self.begin[1] + begin[1]];
            Self { shape: LoopCellShape::from_triangle(quarter), begin, scale, ..*self }
        };
        quarters.iter().zip(begins).map(part).collect()
    }

    /// The sheet parameters of a point of the cell.
    pub(crate) fn on_sheet(&self, place: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| self.begin[k] + self.scale * place[k])
    }
}
