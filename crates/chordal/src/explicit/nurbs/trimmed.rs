//! `TrimmedSurface`: the part of a NURBS surface that loops in its parameter plane enclose.
use super::{BernsteinRow, NurbsSurface};
use crate::explicit::{Curve, CurveSegment};
use crate::math::{Box3, add_up, greater, lesser, sub_down};
use std::fmt;

/// A part of a NURBS surface, a *face* of a solid in CAD.
///
/// The loops are closed paths in the plane of the parameters `u` and `v`, which need not touch. The region to
/// their left belongs to the surface, so outer loops run counter-clockwise and holes clockwise. Regions
/// outside the range of the parameters are no part of it. Without a loop it is the entire surface.
///
/// ```
/// use chordal::explicit::nurbs::{NurbsCurve, NurbsSurface, TrimmedSurface};
/// let square = NurbsSurface::extruded(&NurbsCurve::line([0.0; 3], [1.0, 0.0, 0.0])?, [0.0, 1.0, 0.0])?;
/// let circle = NurbsCurve::circle([0.5, 0.5], [[0.25, 0.0], [0.0, 0.25]])?.to_curve()?;
/// let disc = TrimmedSurface::new(square.clone(), vec![circle])?;
/// assert_eq!(disc.loops().len(), 1);
/// assert!(TrimmedSurface::from(square).loops().is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TrimmedSurface {
    surface: NurbsSurface,
    loops: Vec<Curve<2>>,
    is_flipped: bool,
}

/// The largest distance, relative to the range of a parameter, by which a loop may leave the range: the
/// region outside is cut off. Chosen: near the pole of a sphere, where parameters mean little, CAD programs
/// leave it by a third; a loop that belongs to a different surface usually leaves it by more than half.
const OUTSIDE: f64 = 0.5;
/// Points on each piece of a loop at which that is checked. Chosen: an excursion between two of them is cut
/// off.
const SAMPLES: usize = 16;

impl TrimmedSurface {
    /// The part of a surface within loops in its parameter plane.
    ///
    /// # Errors
    /// When a loop is not closed, or leaves the range of the surface's parameters by more than half of it.
    pub fn new(surface: NurbsSurface, loops: Vec<Curve<2>>) -> Result<Self, InvalidTrim> {
        for (index, path) in loops.iter().enumerate() {
            if !path.is_closed() {
                return Err(InvalidTrim::Open(index));
            }
            // Points of the path are checked, since control points may be farther out.
            let is_inside = |at: [f64; 2]| {
                (0..2).all(|k| {
                    let [from, to] = surface.knots()[k].domain();
                    let margin = OUTSIDE * (to - from);
                    at[k] >= from - margin && at[k] <= to + margin
                })
            };
            let parameters = (0..path.segments().len() * SAMPLES).map(|k| k as f64 / SAMPLES as f64);
            if !parameters.map(|s| path.at(s)).all(is_inside) {
                return Err(InvalidTrim::Outside(index));
            }
        }
        Ok(Self { surface, loops, is_flipped: false })
    }

    /// The same part with its front where the back was.
    #[must_use]
    pub fn flipped(mut self) -> Self {
        self.is_flipped = !self.is_flipped;
        self
    }

    /// The same part with another [`NurbsSurface::slack`].
    #[must_use]
    pub fn with_slack(mut self, slack: f64) -> Self {
        self.surface = self.surface.with_slack(slack);
        self
    }

    /// The surface.
    #[must_use]
    pub fn surface(&self) -> &NurbsSurface {
        &self.surface
    }

    /// The loops around the part; none if it is the entire surface.
    #[must_use]
    pub fn loops(&self) -> &[Curve<2>] {
        &self.loops
    }

    /// Whether the front is the surface's back.
    #[must_use]
    pub fn is_flipped(&self) -> bool {
        self.is_flipped
    }

    /// A box that contains the part.
    #[must_use]
    pub fn bounds(&self) -> Box3 {
        if self.loops.is_empty() {
            return self.surface.bounds();
        }
        let [mut low, mut high] = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for [from, to] in self.loops.iter().map(Curve::bounds) {
            low = std::array::from_fn(|k| lesser(low[k], from[k]));
            high = std::array::from_fn(|k| greater(high[k], to[k]));
        }
        let net = self.surface.bezier_net();
        // By direction: the pieces that the loops reach, and the covered part of each.
        let parts = [0, 1].map(|k| {
            let knots = &self.surface.knots()[k];
            let part = |piece: usize| {
                let [a, b] = knots.piece(piece);
                let (from, to) = ((low[k] - a) / (b - a), (high[k] - a) / (b - a));
                (to >= 0.0 && from <= 1.0).then(|| (piece, greater(from, 0.0), lesser(to, 1.0)))
            };
            (0..knots.n_pieces()).filter_map(part).collect::<Vec<_>>()
        });
        let mut bounds = Box3::EMPTY;
        for (b, c, d) in &parts[1] {
            for (a, from, to) in &parts[0] {
                let rows: Vec<BernsteinRow<4>> =
                    net.rows([*a, *b]).iter().map(|row| row.part(*from, *to)).collect();
                for i in 0..rows[0].0.len() {
                    let column = BernsteinRow(rows.iter().map(|row| row.0[i]).collect()).part(*c, *d);
                    let points: Vec<[f64; 3]> =
                        column.0.iter().map(|x| [x[0] / x[3], x[1] / x[3], x[2] / x[3]]).collect();
                    bounds = bounds.union(Box3::from_points(&points));
                }
            }
        }
        let surface_bounds = self.surface.bounds();
        let reach = surface_bounds
            .min
            .iter()
            .chain(&surface_bounds.max)
            .fold(0.0, |largest: f64, x| greater(x.abs(), largest));
        // Derived: weighted means in 60 + 60 steps of three roundings at most, and a quotient.
        let margin = 1024.0 * f64::EPSILON * reach;
        Box3 { min: bounds.min.map(|x| sub_down(x, margin)), max: bounds.max.map(|x| add_up(x, margin)) }
    }

    /// Points of the part: on the loops, at this many equal steps of each of their pieces; without loops, at
    /// as many along both parameters of each piece of the surface.
    #[must_use]
    pub fn samples(&self, steps: usize) -> Vec<[f64; 3]> {
        if self.loops.is_empty() {
            return self.surface.lattice(steps);
        }
        let net = self.surface.bezier_net();
        let points_on = |segment: &CurveSegment<2>| {
            let at = |k: usize| segment.at(k as f64 / steps as f64);
            (0..=steps).map(at).map(|[u, v]| net.at(u, v)).collect::<Vec<_>>()
        };
        self.loops.iter().flat_map(Curve::segments).flat_map(points_on).collect()
    }

    /// Whether this is an entire surface, not flipped.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.loops.is_empty() && !self.is_flipped
    }
}

impl From<NurbsSurface> for TrimmedSurface {
    fn from(surface: NurbsSurface) -> Self {
        Self { surface, loops: Vec::new(), is_flipped: false }
    }
}

/// The reason why loops do not trim a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InvalidTrim {
    /// The loop with this index does not end where it starts.
    Open(usize),
    /// The loop with this index leaves the range of the surface's parameters by more than half of it.
    Outside(usize),
}

impl fmt::Display for InvalidTrim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Open(index) => write!(f, "trim loop {index} does not end where it starts"),
            Self::Outside(index) => {
                write!(
                    f,
                    "trim loop {index} leaves the range of the surface's parameters by more than half of it"
                )
            }
        }
    }
}

impl std::error::Error for InvalidTrim {}
