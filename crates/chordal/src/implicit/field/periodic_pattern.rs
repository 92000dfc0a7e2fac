//! `PeriodicPattern`: endless copies of a field.
use super::Field;
use crate::implicit::{Csg, Expr, Tape};
use crate::math::{Box3, Interval};

/// How a shape is repeated along one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Repeat {
    /// No repetition.
    Once,
    /// At every integer multiple of a period, without end.
    Every(f64),
    /// This many times, a period apart; the first copy is the shape itself.
    Times(u32, f64),
}

/// The most primitives of a sign that lists all copies, if their number is finite. It has no steps, and
/// planes that copies share are one. Chosen: beyond, the steps from cell to cell cost less than the copies.
pub(in crate::implicit) const MOST_LISTED: u64 = 8192;

/// A pattern of endless copies, from which boxes are cut out.
#[derive(Clone, Debug)]
pub(in crate::implicit) struct PeriodicPattern {
    copy: Field,
    along: [Repeat; 3],
    /// Whether it is the complement of the copies.
    is_complement: bool,
    /// The maps from points of space to points of the pattern, the last of which is applied first.
    at: Vec<[Expr; 3]>,
}

impl PeriodicPattern {
    pub fn new(copy: Field, along: [Repeat; 3]) -> Self {
        Self { copy, along, is_complement: false, at: Vec::new() }
    }

    pub fn complement(&self) -> Self {
        Self { is_complement: !self.is_complement, ..self.clone() }
    }

    /// The pattern of a copy whose expressions are replaced by others of the same values.
    pub fn map_expressions(&self, map: impl Fn(&Expr) -> Expr + Copy) -> Self {
        Self { copy: self.copy.map_expressions(map), ..self.clone() }
    }

    /// The pattern under a further map from points of space to its points.
    pub fn placed(&self, at: &[Expr; 3]) -> Self {
        let at = self.at.iter().chain([at]).cloned().collect();
        Self { at, ..self.clone() }
    }

    /// An expression with the same sign in a box, as a list of the copies that reach into it, and so without
    /// steps. None if there are too many.
    pub fn sign_within(&self, bounds: &Box3) -> Option<Expr> {
        let mapped = self.at.iter().rev().try_fold(*bounds, |bounds, at| image(at, &bounds))?;
        let sign = self.own_sign_within(&mapped)?;
        Some(self.at.iter().fold(sign, |sign, at| sign.with_axes(at.clone())))
    }

    /// The same for the pattern in its own coordinates.
    fn own_sign_within(&self, bounds: &Box3) -> Option<Expr> {
        let (axes, copy_bounds) = (Expr::axes(), self.copy.bounds());
        let mut coordinates: Vec<[Expr; 3]> = vec![axes.clone()];
        let n_primitives = Csg::from_expr(self.copy.sign()).primitives().len() as u64;
        for (k, repeat) in self.along.into_iter().enumerate() {
            let (first, last, period) = match repeat {
                Repeat::Once => continue,
                Repeat::Times(count, period) => (0.0, f64::from(count) - 1.0, period),
                // One more copy on each side covers any rounding.
                Repeat::Every(period) => {
                    let reach = [bounds.min[k] - copy_bounds.max[k], bounds.max[k] - copy_bounds.min[k]];
                    ((reach[0] / period).floor(), (reach[1] / period).ceil(), period)
                }
            };
            let n = last - first + 1.0;
            if !(n >= 1.0 && n * coordinates.len() as f64 * n_primitives as f64 <= MOST_LISTED as f64) {
                return None;
            }
            let moved = |at: &[Expr; 3], number: f64| {
                let mut at = at.clone();
                at[k] = if number == 0.0 { axes[k].clone() } else { &axes[k] - number * period };
                at
            };
            let numbers: Vec<f64> = (0..n as u64).map(|number| first + number as f64).collect();
            coordinates = coordinates
                .iter()
                .flat_map(|at| numbers.iter().map(|n| moved(at, *n)).collect::<Vec<_>>())
                .collect();
        }
        let copies: Vec<Field> = coordinates.iter().map(|at| self.copy.at(at)).collect();
        let sign = Field::union_of(&copies).sign().clone();
        Some(if self.is_complement { -sign } else { sign })
    }
}

/// A box that contains the image of a box, if it is finite.
fn image(map: &[Expr; 3], bounds: &Box3) -> Option<Box3> {
    let range = |expr: &Expr| {
        let mut range = [Interval::point(0.0)];
        Tape::new(expr).over(&[*bounds], &mut range).ok()?;
        let [range] = range;
        (range.lo().is_finite() && range.hi().is_finite()).then_some(range)
    };
    let [x, y, z] = [range(&map[0])?, range(&map[1])?, range(&map[2])?];
    Some(Box3 { min: [x.lo(), y.lo(), z.lo()], max: [x.hi(), y.hi(), z.hi()] })
}
