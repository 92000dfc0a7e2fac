//! `NurbsLine`: a line of constant parameter of a NURBS surface, and the surface on one side of it.
use super::edge_join::{CrossBoundary, CrossJet};
use super::joins::{FIRST, SECOND};
use crate::explicit::nurbs::{BernsteinRow, BezierNet, KnotVector, NurbsSurface};
use crate::math::{difference, dot, greater, length, lesser};

/// A line of a surface along which one of its parameters is constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NurbsLine {
    /// The index of the surface.
    pub surface: usize,
    /// The constant parameter: 0 for `u`, 1 for `v`.
    pub constant: usize,
    /// Its value.
    pub at: f64,
}

impl NurbsLine {
    /// The parameters `u` and `v` of the point of the line at which the other parameter is `t`.
    #[must_use]
    pub fn uv(&self, t: f64) -> [f64; 2] {
        if self.constant == 0 { [self.at, t] } else { [t, self.at] }
    }
}

/// A surface beside one of its lines; the parameter runs from 0 to 1, counter-clockwise around it unless it is reversed.
#[derive(Clone)]
pub(super) struct NurbsBoundary<'a> {
    net: &'a BezierNet<'a>,
    knots: &'a [KnotVector; 2],
    /// The constant parameter, the piece beside the line, and the end of it on which the line is: 0 or 1.
    constant: usize,
    piece: usize,
    end: f64,
    /// The other parameter from start to end.
    from: f64,
    to: f64,
    /// The line whose nearest points are used, with pairs of corresponding parameters; `None` to use equal
    /// parameters.
    beside: Option<Box<(NurbsBoundary<'a>, Vec<[f64; 2]>)>>,
}

/// Positions along a side at which another one is searched.
pub(super) const SAMPLES: usize = 64;
/// Positions at which the nearest point is searched; between them it is interpolated from these. Chosen:
/// fewer would not follow uneven parameters.
const PLACES: usize = 16;
/// Steps of Newton's method from there. Chosen: distances are small, so digits double with each step.
const STEPS_TO_FOOT: usize = 6;

impl<'a> NurbsBoundary<'a> {
    /// The surface beyond a line (`end` 0: the piece starts there) or before it (1).
    pub fn new(
        surface: &'a NurbsSurface,
        net: &'a BezierNet<'a>,
        constant: usize,
        (piece, end): (usize, usize),
    ) -> Self {
        let [from, to] = surface.knots()[1 - constant].domain();
        // Counter-clockwise: u rises where v starts and falls where it ends, v rises where u ends.
        let rises = (constant == 1) == (end == 0);
        let (from, to) = if rises { (from, to) } else { (to, from) };
        Self { net, knots: surface.knots(), constant, piece, end: end as f64, from, to, beside: None }
    }

    pub fn reversed(&self) -> Self {
        Self { from: self.to, to: self.from, ..self.clone() }
    }

    /// The same line, evaluated at the point nearest to each point of another one.
    pub fn beside(&self, other: &Self) -> Self {
        let nearest = |k: usize| {
            let t = k as f64 / PLACES as f64;
            [t, self.foot(other.jet(t).point, t)]
        };
        let places = (0..=PLACES).map(nearest).collect();
        Self { beside: Some(Box::new((other.clone(), places))), ..self.clone() }
    }

    /// The line, as one of a numbered surface.
    pub fn line(&self, surface: usize) -> NurbsLine {
        let at = self.knots[self.constant].piece(self.piece)[self.end as usize];
        NurbsLine { surface, constant: self.constant, at }
    }

    /// The parameter of the surface along the line.
    pub fn parameter(&self, t: f64) -> f64 {
        (1.0 - t) * self.from + t * self.to
    }

    /// The parameter of the point nearest to a given one, starting at another parameter.
    fn foot(&self, point: [f64; 3], near: f64) -> f64 {
        let distance_at = |t: f64| {
            let away = difference(self.jet(t).point, point);
            length(away)
        };
        let step = |k: usize| k as f64 / SAMPLES as f64;
        let first = (near, distance_at(near));
        let (mut t, mut best) = (0..=SAMPLES)
            // The given parameter comes first, so that it stays unless another one is really
            // nearer.
            .map(|k| (step(k), distance_at(step(k))))
            .fold(first, |best, next| if next.1 < best.1 { next } else { best });
        let mut width = 1.0 / SAMPLES as f64;
        // Chosen: the last steps are below 1e-12, by thirds.
        // Without derivatives, which may vanish at a cusp or a pole; Newton's steps afterwards give
        // the last digits.
        for _ in 0..24 {
            for next in [greater(t - width, 0.0), lesser(t + width, 1.0)] {
                let distance = distance_at(next);
                if distance < best {
                    (t, best) = (next, distance);
                }
            }
            width /= 3.0;
        }
        self.nearer(point, t)
    }

    /// Newton's method on the derivative of the square, without its second derivative, which vanishes with the distance.
    fn nearer(&self, point: [f64; 3], near: f64) -> f64 {
        let mut t = near;
        for _ in 0..STEPS_TO_FOOT {
            let jet = self.jet(t);
            let away = difference(jet.point, point);
            let step = dot(away, jet.along) / dot(jet.along, jet.along);
            // NaN if the line stops; a step farther than to the next sample leads to another place.
            if step.is_nan() || step.abs() >= 1.0 / PLACES as f64 {
                return t;
            }
            t = greater(0.0, lesser(t - step, 1.0));
        }
        t
    }

    /// The parameters at which the pieces along the line meet, with the given number of equal steps in each.
    pub fn steps(&self, steps: usize) -> Vec<f64> {
        let knots = &self.knots[1 - self.constant];
        let local = |t: f64| (t - self.from) / (self.to - self.from);
        let mut parameters = vec![0.0];
        for k in 0..knots.n_pieces() {
            let [a, b] = knots.piece(k);
            parameters.extend((1..=steps).map(|i| local(a + (b - a) * (i as f64 / steps as f64))));
        }
        parameters.iter_mut().for_each(|t| *t = greater(0.0, lesser(*t, 1.0)));
        parameters.push(1.0);
        parameters.sort_by(f64::total_cmp);
        parameters.dedup();
        parameters
    }

    /// Bounds on the movement of first and second derivatives, across and along, by rounding: as for bicubic
    /// patches, with the degree and the narrowest piece of each direction instead.
    pub fn roundings(&self, size: f64) -> [f64; 2] {
        let rate = |k: usize| {
            let knots = &self.knots[k];
            let pieces = if k == self.constant { self.piece..self.piece + 1 } else { 0..knots.n_pieces() };
            let width =
                pieces.map(|piece| knots.piece(piece)).map(|[a, b]| b - a).fold(f64::INFINITY, lesser);
            greater(knots.degree() as f64 / 3.0, 1.0) / width
        };
        let along = (self.to - self.from).abs();
        let rate = greater(rate(self.constant), rate(1 - self.constant) * greater(along, 1.0));
        // Chosen: coefficients of pieces are weighted means, so four times as many roundings as of a given
        // patch.
        let unit = 4.0 * f64::EPSILON * size;
        [FIRST * unit * rate, SECOND * unit * rate * rate]
    }
}

impl CrossBoundary for NurbsBoundary<'_> {
    fn jet(&self, t: f64) -> CrossJet {
        if let Some(beside) = &self.beside {
            let (other, correspondence) = &**beside;
            // The same line without the correspondence, by its own parameters.
            let by_parameter = Self { beside: None, ..self.clone() };
            return by_parameter.jet(by_parameter.nearer(other.jet(t).point, between(correspondence, t)));
        }
        let (other, sign) = (1 - self.constant, if self.end == 0.0 { 1.0 } else { -1.0 });
        // Which Bézier piece lies along the line is looked up; which one lies beside it is given,
        // since at a knot there are two.
        let (along_piece, local) = self.knots[other].locate(self.parameter(t));
        let (mut piece, mut at) = ([0; 2], [0.0; 2]);
        (piece[self.constant], piece[other]) = (self.piece, along_piece);
        (at[self.constant], at[other]) = (self.end, local);
        let jet = second_jet(self.net, piece, at);
        // Derivatives across are by the parameters of the surface, those along by the position on the line.
        let width = |k: usize, piece: usize| {
            let [a, b] = self.knots[k].piece(piece);
            b - a
        };
        let across = sign / width(self.constant, self.piece);
        let along = (self.to - self.from) / width(other, along_piece);
        let scaled = |v: [f64; 3], by: f64| v.map(|x| by * x);
        let first = |k: usize| jet.first[k];
        CrossJet {
            point: jet.point,
            along: scaled(first(other), along),
            along_second: scaled(jet.second[other], along * along),
            across: scaled(first(self.constant), across),
            mixed: scaled(jet.mixed, along * across),
            bend: scaled(jet.second[self.constant], across * across),
        }
    }

    fn is_doubled(&self) -> bool {
        false
    }
}

/// Interpolates linearly between pairs of parameters.
fn between(correspondence: &[[f64; 2]], t: f64) -> f64 {
    let after = correspondence.partition_point(|[at, _]| *at <= t).clamp(1, correspondence.len() - 1);
    let ([a, x], [b, y]) = (correspondence[after - 1], correspondence[after]);
    x + (y - x) * ((t - a) / (b - a))
}

/// A point and all derivatives up to the second, by the parameters of a piece from 0 to 1.
struct SecondJet {
    point: [f64; 3],
    first: [[f64; 3]; 2],
    second: [[f64; 3]; 2],
    mixed: [f64; 3],
}

fn second_jet(net: &BezierNet<'_>, piece: [usize; 2], [s, t]: [f64; 2]) -> SecondJet {
    let rows: Vec<[[f64; 4]; 3]> = net.rows(piece).iter().map(|row| row.jet(s)).collect();
    let column = |k: usize| BernsteinRow(rows.iter().map(|jet| jet[k]).collect()).jet(t);
    let [[x, xv, xvv], [xu, xuv, _], [xuu, ..]] = [column(0), column(1), column(2)];
    let w = x[3];
    // With homogeneous X = w·p, the product rule gives p′ = (X′ − p·w′) / w and p″ = (X″ − 2·p′·w′
    // − p·w″) / w: each order needs only those below it.
    let point: [f64; 3] = std::array::from_fn(|k| x[k] / w);
    let first = [xu, xv].map(|d| -> [f64; 3] { std::array::from_fn(|k| (d[k] - point[k] * d[3]) / w) });
    let second = [(xuu, xu, first[0]), (xvv, xv, first[1])].map(|(dd, d, first_order)| -> [f64; 3] {
        std::array::from_fn(|k| (dd[k] - 2.0 * first_order[k] * d[3] - point[k] * dd[3]) / w)
    });
    let [u, v] = first;
    let mixed = std::array::from_fn(|k| (xuv[k] - u[k] * xv[3] - v[k] * xu[3] - point[k] * xuv[3]) / w);
    SecondJet { point, first, second, mixed }
}
