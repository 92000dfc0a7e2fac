//! Shapes repeated along the axes.
use super::common;
use crate::implicit::construction::{Construction, ConstructionNode};
use crate::implicit::field::{MOST_LISTED, PeriodicPattern};
use crate::implicit::op::Unary;
use crate::implicit::shapes::InvalidShape;
use crate::implicit::{Csg, Distance, DistanceQuality, Expr, Field, Repeat};
use crate::math::{add_up, lesser, mul_up};

/// The most copies in one cell's neighbourhood: each is a separate expression.
const MOST: u64 = 4096;

impl Field {
    /// The union of copies of the shape, repeated along x, y and z.
    ///
    /// In each cell all copies are evaluated that can be nearest there, however far the shape extends beyond
    /// its cell. An exact distance stays exact outside and becomes a bound inside. A bound becomes only a
    /// sign outside, because it may jump from cell to cell.
    ///
    /// # Errors
    /// When a period is not a finite number above 0, a count is 0, the shape's box is not finite along a
    /// repeated axis, or the shape extends over so many periods that more than 4,096 copies may be nearest to
    /// a point.
    pub fn repeated(&self, along: [Repeat; 3]) -> Result<Self, InvalidShape> {
        if self.bounds().is_empty() {
            return Ok(self.clone());
        }
        let mut windows = Vec::new();
        for (k, repeat) in along.into_iter().enumerate() {
            windows.push(RepeatWindow::new(repeat, self.bounds().min[k], self.bounds().max[k])?);
        }
        let n: u64 = windows.iter().map(RepeatWindow::len).fold(1, u64::saturating_mul);
        if n > MOST {
            let reach = format!(
                "the shape is so much longer than its period that {n} copies may be the nearest to a point"
            );
            return Err(InvalidShape::Number(format!("{reach}, and must be at most {MOST}")));
        }
        let axes = Expr::axes();
        let coordinates_of = |per_axis: &dyn Fn(&RepeatWindow, &Expr) -> Vec<Expr>| -> Vec<[Expr; 3]> {
            let [xs, ys, zs]: [Vec<Expr>; 3] = std::array::from_fn(|k| per_axis(&windows[k], &axes[k]));
            let along_x = |y: &Expr, z: &Expr| xs.iter().map(|x| [x.clone(), y.clone(), z.clone()]).collect();
            let plane = |z: &Expr| ys.iter().flat_map(|y| -> Vec<[Expr; 3]> { along_x(y, z) }).collect();
            zs.iter().flat_map(|z| -> Vec<[Expr; 3]> { plane(z) }).collect()
        };
        let copies: Vec<Self> = coordinates_of(&RepeatWindow::nearby).iter().map(|at| self.at(at)).collect();
        let distance = self.distance().union(self.distance());
        // Which copies are taken changes from cell to cell; only exact distances to the nearest one agree
        // there.
        let jumps = self.distance().outside != DistanceQuality::Exact && windows.iter().any(|w| w.len() > 1);
        let outside = if jumps { DistanceQuality::Sign } else { distance.outside };
        let mut bounds = Field::EVERYWHERE;
        for (k, window) in windows.iter().enumerate() {
            (bounds.min[k], bounds.max[k]) = window.bounds(self.bounds().min[k], self.bounds().max[k]);
        }
        let union = Self::union_of(&copies).known_distance(Distance { outside, ..distance });
        let n_copies =
            windows.iter().map(|w| w.count.map_or(u64::MAX, u64::from)).fold(1, u64::saturating_mul);
        let n_primitives = Csg::from_expr(self.sign()).primitives().len() as u64;
        // With as many copies nearby as there are, the sign lists all of them already.
        let union = if n < n_copies && n_copies.saturating_mul(n_primitives) <= MOST_LISTED {
            let listed: Vec<Self> =
                coordinates_of(&RepeatWindow::all_copies).iter().map(|at| self.at(at)).collect();
            union.known_sign(Self::union_of(&listed).sign().clone())
        } else {
            union
        };
        let union = union.known_bounds(common(bounds, Field::EVERYWHERE));
        let union =
            union.known_construction(self.repeated_construction(along, n_copies)).known_slack(self.slack());
        let is_endless = along.iter().any(|repeat| matches!(repeat, Repeat::Every(_)));
        Ok(if is_endless { union.with_pattern(PeriodicPattern::new(self.clone(), along)) } else { union })
    }
}

impl Field {
    /// The construction of all copies, if their number is finite.
    fn repeated_construction(&self, along: [Repeat; 3], n_copies: u64) -> Option<Construction> {
        let solids = self.construction().filter(|_| n_copies <= MOST)?;
        let steps = along.map(|repeat| match repeat {
            Repeat::Times(count, period) => (count, period),
            Repeat::Once | Repeat::Every(_) => (1, 0.0),
        });
        let shift = |axis: usize, k: u64| if k == 0 { 0.0 } else { k as f64 * steps[axis].1 };
        let [nx, ny] = [0, 1].map(|axis| u64::from(steps[axis].0));
        let copy = |k: u64| {
            let [x, y, z] = [(0, k % nx), (1, k / nx % ny), (2, k / nx / ny)].map(|(axis, k)| shift(axis, k));
            solids.placed([[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]])
        };
        let copies: Option<Vec<Construction>> = (0..n_copies).map(copy).collect();
        Construction::new(ConstructionNode::Union(copies?.into()))
    }
}

/// The copies along one axis that can be nearest to points of a cell, counted from the cell's own copy.
struct RepeatWindow {
    period: f64,
    /// The number of copies, if finite.
    count: Option<u32>,
    first: i64,
    last: i64,
}

impl RepeatWindow {
    /// The nearest copy's nearest point is at most half a period away along the axis: otherwise the next copy
    /// would be nearer. Points are within half a period of their cell's middle, so only copies that reach
    /// into one period on each side matter.
    fn new(repeat: Repeat, low: f64, high: f64) -> Result<Self, InvalidShape> {
        let refused = |sentence: String| Err(InvalidShape::Number(sentence));
        let (period, count) = match repeat {
            Repeat::Once | Repeat::Times(1, _) => {
                return Ok(Self { period: 0.0, count: Some(1), first: 0, last: 0 });
            }
            Repeat::Every(period) => (period, None),
            Repeat::Times(count, period) => (period, Some(count)),
        };
        if !(period > 0.0 && period.is_finite()) {
            return refused(format!("a period is {period}, and must be a finite number above 0"));
        }
        if count == Some(0) {
            return refused("a shape is repeated 0 times, and must be repeated once at least".into());
        }
        if !(low.is_finite() && high.is_finite()) {
            return refused("a shape cannot be repeated along an axis on which it has no bounds".into());
        }
        // One more copy on each side would cover any rounding of the quotients; a thousandth of a period is
        // already far more than that.
        let (first, last) = ((-1.001 - high / period).ceil(), (1.001 - low / period).floor());
        if last - first >= MOST as f64 {
            return refused(format!(
                "a period is {period}, which is too short for a shape from {low} to {high}"
            ));
        }
        Ok(Self { period, count, first: first as i64, last: last as i64 })
    }

    fn len(&self) -> u64 {
        let window = (self.last - self.first + 1) as u64;
        self.count.map_or(window, |n| lesser(u64::from(n), window))
    }

    /// The coordinate in the frame of each nearby copy.
    fn nearby(&self, axis: &Expr) -> Vec<Expr> {
        let copy = |number: Expr| axis - number * self.period;
        if self.count.is_some_and(|n| u64::from(n) <= self.len()) {
            return self.all_copies(axis);
        }
        let cell = Expr::unary(Unary::Round, &(axis / self.period));
        let number = |k: i64| {
            let number = if k == 0 { cell.clone() } else { &cell + k as f64 };
            match self.count {
                None => number,
                // Numbers beyond an end become that of the last copy there, which may then occur more than
                // once.
                Some(n) => number.max(&0.0.into()).min(&f64::from(n - 1).into()),
            }
        };
        (self.first..=self.last).map(|k| copy(number(k))).collect()
    }

    /// The coordinate in the frame of each copy, if their number is finite.
    fn all_copies(&self, axis: &Expr) -> Vec<Expr> {
        let moved = |k: u32| if k == 0 { axis.clone() } else { axis - f64::from(k) * self.period };
        (0..self.count.unwrap_or(0)).map(moved).collect()
    }

    fn bounds(&self, low: f64, high: f64) -> (f64, f64) {
        match self.count {
            None => (f64::NEG_INFINITY, f64::INFINITY),
            Some(1) => (low, high),
            Some(n) => (low, add_up(high, mul_up(f64::from(n - 1), self.period))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_hold_the_neighbours_that_a_shape_reaches() {
        let small = RepeatWindow::new(Repeat::Every(1.0), -0.25, 0.25).expect("fine");
        assert_eq!((small.first, small.last), (-1, 1));
        let long = RepeatWindow::new(Repeat::Every(1.0), -0.25, 2.5).expect("fine");
        assert_eq!((long.first, long.last), (-3, 1));
        let distant = RepeatWindow::new(Repeat::Every(1.0), 10.0, 10.5).expect("fine");
        assert_eq!((distant.first, distant.last), (-11, -9));
        assert!(RepeatWindow::new(Repeat::Every(0.0), 0.0, 1.0).is_err());
    }
}
