//! `NurbsSurface`: a rational tensor-product B-spline surface of any degrees.
use super::knots::{InvalidNurbs, KnotVector};
use super::{BernsteinRow, NurbsCurve};
use crate::math::Box3;

/// A tensor-product surface, `Σ Nᵢ(u) Nⱼ(v) wᵢⱼ Pᵢⱼ / Σ Nᵢ(u) Nⱼ(v) wᵢⱼ`.
///
/// Control points are stored row by row: `u` runs along a row and `v` from row to row. The front is the side
/// on which the directions of `u` and `v` and the normal are right-handed. With weights of 1 it is a
/// polynomial surface; spheres, cylinders, cones and tori are exact ([`NurbsSurface::sphere`] and its
/// neighbours).
///
/// ```
/// use chordal::explicit::nurbs::NurbsSurface;
/// let torus = NurbsSurface::torus(2.0, 0.5)?;
/// let [x, y, z] = torus.at(0.3, 0.8);
/// let from_ring = (x * x + y * y).sqrt() - 2.0;
/// assert!(((from_ring * from_ring + z * z).sqrt() - 0.5).abs() < 1e-15);
/// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsSurface {
    knots: [KnotVector; 2],
    control: Vec<[f64; 3]>,
    weights: Vec<f64>,
    slack: f64,
}

/// Position and derivatives of a surface by its two parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurfaceJet {
    pub position: [f64; 3],
    pub u: [f64; 3],
    pub v: [f64; 3],
    pub uv: [f64; 3],
}

/// The surface as rational Bézier pieces: weighted points and their weights; neighbours share their common
/// side.
pub(crate) struct BezierNet<'a> {
    knots: &'a [KnotVector; 2],
    /// Row by row.
    net: Vec<[f64; 4]>,
}

impl NurbsSurface {
    /// A surface from knots, control points row by row, and their weights.
    ///
    /// # Errors
    /// When the number of control points or weights does not match the knots, a number is not finite, or a
    /// weight is not above 0.
    pub fn new(
        knots: [KnotVector; 2],
        control: Vec<[f64; 3]>,
        weights: Vec<f64>,
    ) -> Result<Self, InvalidNurbs> {
        super::curve::check(&control, &weights, knots[0].n_control() * knots[1].n_control())?;
        Ok(Self { knots, control, weights, slack: 0.0 })
    }

    /// The same surface with a known uncertainty: at corresponding parameters, the exact surface and this one
    /// are at most `slack` (≥ 0) apart, because its numbers were rounded or fitted before. Every bound
    /// against the surface includes it.
    #[must_use]
    pub fn with_slack(mut self, slack: f64) -> Self {
        self.slack = slack;
        self
    }

    /// The largest distance between the exact surface and this one, caused by rounding or fitting.
    #[must_use]
    pub fn slack(&self) -> f64 {
        self.slack
    }

    /// The knots along `u` and along `v`.
    #[must_use]
    pub fn knots(&self) -> &[KnotVector; 2] {
        &self.knots
    }

    /// The control points, row by row.
    #[must_use]
    pub fn control(&self) -> &[[f64; 3]] {
        &self.control
    }

    /// The weights of the control points.
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The point at two parameters; outside the domain, the point of the nearer end.
    #[must_use]
    pub fn at(&self, u: f64, v: f64) -> [f64; 3] {
        self.bezier_net().at(u, v)
    }

    /// Points at this many equal steps along `u` and `v` of each piece, ends included.
    #[must_use]
    pub fn lattice(&self, steps: usize) -> Vec<[f64; 3]> {
        let net = self.bezier_net();
        let [n, m] = net.n_pieces();
        let parameter = |k: usize| k as f64 / steps as f64;
        let pieces = (0..m).flat_map(|b| (0..n).map(move |a| [a, b]));
        let steps_of = |piece: [usize; 2]| {
            let at = move |j: usize| (0..=steps).map(move |i| (piece, [i, j]));
            (0..=steps).flat_map(at)
        };
        pieces
            .flat_map(steps_of)
            .map(|(piece, [i, j])| net.jet(piece, [parameter(i), parameter(j)]).position)
            .collect()
    }

    /// A box that contains the surface: its control points are in it.
    #[must_use]
    pub fn bounds(&self) -> Box3 {
        Box3::from_points(&self.control)
    }

    /// The surface as rational Bézier pieces.
    pub(crate) fn bezier_net(&self) -> BezierNet<'_> {
        let n = self.knots[0].n_control();
        let weights = super::curve::scaled_weights(&self.weights);
        let weighted: Vec<[f64; 4]> =
            self.control.iter().zip(weights).map(|(p, w)| [p[0] * w, p[1] * w, p[2] * w, w]).collect();
        let rows: Vec<Vec<[f64; 4]>> = weighted.chunks(n).map(|row| self.knots[0].to_bezier(row)).collect();
        let width = rows[0].len();
        let columns: Vec<Vec<[f64; 4]>> = (0..width)
            .map(|i| self.knots[1].to_bezier(&rows.iter().map(|row| row[i]).collect::<Vec<_>>()))
            .collect();
        let net = (0..columns[0].len()).flat_map(|j| columns.iter().map(move |column| column[j])).collect();
        BezierNet { knots: &self.knots, net }
    }

    /// The surface that a straight line sweeps between the points of two curves with the same parameter; `v`
    /// runs from the first to the second.
    ///
    /// # Errors
    /// When the curves have different degrees or knots.
    pub fn ruled(from: &NurbsCurve<3>, to: &NurbsCurve<3>) -> Result<Self, InvalidNurbs> {
        if from.knots() != to.knots() {
            return Err(InvalidNurbs::Knots);
        }
        let control = [from.control(), to.control()].concat();
        let weights = [from.weights(), to.weights()].concat();
        Self::new([from.knots().clone(), KnotVector::clamped(1, 2)?], control, weights)
    }

    /// The surface that a curve sweeps along a vector; `v` runs along it.
    ///
    /// # Errors
    /// When a number is not finite.
    pub fn extruded(curve: &NurbsCurve<3>, along: [f64; 3]) -> Result<Self, InvalidNurbs> {
        let moved = curve.control().iter().map(|p| std::array::from_fn(|k| p[k] + along[k])).collect();
        let to = NurbsCurve::new(curve.knots().clone(), moved, curve.weights().to_vec())?;
        Self::ruled(curve, &to)
    }
}

impl BezierNet<'_> {
    /// The numbers of pieces along `u` and `v`.
    pub fn n_pieces(&self) -> [usize; 2] {
        [0, 1].map(|k| self.knots[k].n_pieces())
    }

    pub fn degrees(&self) -> [usize; 2] {
        [0, 1].map(|k| self.knots[k].degree())
    }

    /// The rows of coefficients of a piece.
    pub fn rows(&self, [a, b]: [usize; 2]) -> Vec<BernsteinRow<4>> {
        let [p, q] = self.degrees();
        let width = self.n_pieces()[0] * p + 1;
        (b * q..=(b + 1) * q)
            .map(|j| BernsteinRow(self.net[j * width + a * p..=j * width + (a + 1) * p].to_vec()))
            .collect()
    }

    /// The point at two parameters; outside the domain, the point of the nearer end.
    pub fn at(&self, u: f64, v: f64) -> [f64; 3] {
        let [(a, s), (b, t)] = [self.knots[0].locate(u), self.knots[1].locate(v)];
        self.jet([a, b], [s, t]).position
    }

    /// Position and derivatives of a piece at parameters from 0 to 1. At 0 and 1 the derivatives along a side
    /// depend only on that side's coefficients, so that neighbours agree bit for bit.
    pub fn jet(&self, piece: [usize; 2], [s, t]: [f64; 2]) -> SurfaceJet {
        let jets: Vec<[[f64; 4]; 3]> = self.rows(piece).iter().map(|row| row.jet(s)).collect();
        let column = |k: usize| BernsteinRow(jets.iter().map(|jet| jet[k]).collect()).jet(t);
        let [[x, xv, _], [xu, xuv, _]] = [column(0), column(1)];
        let w = x[3];
        let point = |x: [f64; 4]| -> [f64; 3] { [x[0] / w, x[1] / w, x[2] / w] };
        let position = point(x);
        // The quotient rule, solved for the derivative: with X = w·x, x′ = (X′ − x·w′) / w.
        let first = |d: [f64; 4]| -> [f64; 3] { std::array::from_fn(|k| (d[k] - position[k] * d[3]) / w) };
        let (u, v) = (first(xu), first(xv));
        let uv = std::array::from_fn(|k| (xuv[k] - u[k] * xv[3] - v[k] * xu[3] - position[k] * xuv[3]) / w);
        SurfaceJet { position, u, v, uv }
    }

    /// By direction: the coefficients of the sides at its start and at its end.
    pub fn sides(&self) -> [[Vec<[f64; 4]>; 2]; 2] {
        let ([n, m], [p, q]) = (self.n_pieces(), self.degrees());
        let (width, height) = (n * p + 1, m * q + 1);
        let column = |i: usize| (0..height).map(|j| self.net[j * width + i]).collect();
        let row = |j: usize| self.net[j * width..(j + 1) * width].to_vec();
        [[column(0), column(width - 1)], [row(0), row(height - 1)]]
    }
}
