//! One piece of a path cut into chords: how many at most, where, and with what loss.
use super::chord::{CubicChords, Loss, ROUNDING, arc_loss, reach};
use super::greedy;
use crate::explicit::Piece;

/// A piece with what its certificates share.
pub(crate) enum Chords<'a, const D: usize> {
    Line,
    Cubic(CubicChords<'a, D>),
    Arc(&'a crate::explicit::Arc<D>),
}

impl<'a, const D: usize> Chords<'a, D> {
    pub(crate) fn new(piece: &'a Piece<D>) -> Self {
        match piece {
            Piece::Line(_) => Self::Line,
            Piece::Cubic(cubic) => Self::Cubic(CubicChords::new(cubic)),
            Piece::Arc(arc) => Self::Arc(arc),
        }
    }

    /// The loss of the chord from `a` to `b`, in exact arithmetic.
    pub(crate) fn loss(&self, a: f64, b: f64) -> Loss {
        match self {
            Self::Line => Loss { at_most: 0.0, fraction: 0.5 },
            Self::Cubic(chords) => chords.loss(a, b),
            Self::Arc(arc) => arc_loss(arc, a, b),
        }
    }

    /// Into how many equal steps the piece is cut at most (Wang's formula), as a float: it may be huge.
    pub(crate) fn even_steps(&self, tolerance: f64) -> f64 {
        let steps = match self {
            Self::Line => 1.0,
            Self::Cubic(chords) => (0.75 * chords.largest_bend() / tolerance).sqrt().ceil(),
            // sup |P''|/(8 N²), and no chord over more than half a turn.
            Self::Arc(arc) => {
                let [u, v] = arc.axes().map(|axis| axis.iter().fold(0.0, |sum, x| sum + x * x));
                let by_size = arc.sweep_rad().abs() * ((u + v).sqrt() / (8.0 * tolerance)).sqrt();
                let by_turn = arc.sweep_rad().abs() / 3.0;
                (if by_size > by_turn { by_size } else { by_turn }).ceil()
            }
        };
        // A NaN comes from a bend that is not finite, and means no end of steps.
        if steps <= 1.0 {
            1.0
        } else if steps.is_nan() {
            f64::INFINITY
        } else {
            steps
        }
    }

    /// Parameters from 0 to 1, both included, with chords of at most `tolerance`, and nearly as few as can be.
    pub(crate) fn fewest(&self, tolerance: f64) -> Vec<f64> {
        // A little less than what the formula allows, for its own rounding.
        let sure = 0.999 / self.even_steps(tolerance);
        greedy::places(|a, b| self.loss(a, b).at_most, sure, tolerance)
    }

    /// The fewest segments that have a finite bound.
    pub(crate) fn coarsest(&self) -> Vec<f64> {
        match self {
            Self::Line | Self::Cubic(_) => vec![0.0, 1.0],
            // No chord over more than half a turn; a full turn in two would be flat.
            Self::Arc(arc) => self.even(if arc.sweep_rad().abs() > 3.0 { 3 } else { 1 }),
        }
    }

    /// The same with equal steps.
    pub(crate) fn even(&self, n: u64) -> Vec<f64> {
        (0..=n).map(|i| i as f64 / n as f64).collect()
    }
}

/// What rounding may add to the loss of any chord of the piece.
pub(crate) fn rounding<const D: usize>(piece: &Piece<D>) -> f64 {
    let size = match piece {
        Piece::Line(points) => reach(points),
        Piece::Cubic(cubic) => reach(&cubic.control),
        Piece::Arc(arc) => {
            let [u, v] = arc.axes();
            reach(&[arc.centre()]) + reach(&[u]) + reach(&[v])
        }
    };
    ROUNDING * f64::EPSILON * size
}
