//! Random numbers, points, boxes and expressions for the tests of fields.
use chordal::implicit::Expr;
use chordal::implicit::evaluation::{Binary, Unary};
use chordal::math::Box3;
use chordal_testkit::Random;

/// What the tests of fields draw at random.
pub trait RandomFields {
    /// An everyday number, a whole one, or one of any size.
    fn number(&mut self) -> f64;

    /// A box near the origin: of any size down to a point, some with ends that are whole numbers.
    fn bounds(&mut self) -> Box3;

    /// A point of a box, often on its border.
    fn within(&mut self, bounds: &Box3) -> [f64; 3];

    /// An expression of about `size` operations of every kind, on each other and on numbers.
    fn expression(&mut self, size: usize) -> Expr;

    /// Any operation, the common ones more often.
    fn binary(&mut self) -> Binary;

    /// Spheres and boxes joined and cut, with a branch that wins in most regions.
    fn solids(&mut self, count: usize) -> Expr;
}

impl RandomFields for Random {
    fn number(&mut self) -> f64 {
        match self.below(8) {
            0 => self.below(7) as f64 - 3.0,
            1 => (self.unit() - 0.5) * 2.0_f64.powi(self.below(80) as i32 - 40),
            2 => [0.0, -0.0, 1.0, -1.0, 1e300, -1e-300, 5e-324, 102_943.5][self.below(8)],
            _ => 8.0 * self.unit() - 4.0,
        }
    }

    fn bounds(&mut self) -> Box3 {
        let size = [2.0, 0.5, 0.01, 1e-9, 0.0][self.below(5)];
        let whole = self.below(4) == 0;
        let mut bounds = Box3 { min: self.point_within(4.0), max: [0.0; 3] };
        for k in 0..3 {
            if whole {
                bounds.min[k] = bounds.min[k].round();
            }
            bounds.max[k] = bounds.min[k] + size * self.unit();
        }
        bounds
    }

    fn within(&mut self, bounds: &Box3) -> [f64; 3] {
        [0, 1, 2].map(|k| {
            let (low, high) = (bounds.min[k], bounds.max[k]);
            let inner = low + (high - low) * self.unit();
            match self.below(6) {
                0 => low,
                1 => high,
                _ if inner > high => high,
                _ => inner,
            }
        })
    }

    fn expression(&mut self, size: usize) -> Expr {
        let mut terms: Vec<Expr> = Expr::axes().to_vec();
        for _ in 0..size {
            let recent = |random: &mut Self, terms: &[Expr]| {
                let n = terms.len();
                let from = if random.below(3) == 0 { 0 } else { n.saturating_sub(6) };
                terms[from + random.below(n - from)].clone()
            };
            let a = recent(self, &terms);
            let next = match self.below(10) {
                0..4 => Expr::unary(Unary::ALL[self.below(Unary::ALL.len())].0, &a),
                4 => Expr::binary(self.binary(), &a, &Expr::constant(self.number())),
                5 => Expr::binary(self.binary(), &Expr::constant(self.number()), &a),
                _ => {
                    let b = recent(self, &terms);
                    Expr::binary(self.binary(), &a, &b)
                }
            };
            terms.push(next);
        }
        terms.pop().expect("the axes are there")
    }

    fn binary(&mut self) -> Binary {
        let common = [Binary::Add, Binary::Sub, Binary::Mul, Binary::Min, Binary::Max];
        if self.below(2) == 0 { common[self.below(5)] } else { Binary::ALL[self.below(Binary::ALL.len())].0 }
    }

    fn solids(&mut self, count: usize) -> Expr {
        let axes = Expr::axes();
        let mut whole = Expr::constant(2.0);
        for k in 0..count {
            let centre = self.point_within::<3>(4.0);
            let d: Vec<Expr> = (0..3).map(|k| &axes[k] - centre[k]).collect();
            let part = if k % 2 == 0 {
                (d[0].square() + d[1].square() + d[2].square()).sqrt() - (0.3 + self.unit())
            } else {
                d[0].abs().max(&d[1].abs()).max(&d[2].abs()) - (0.3 + self.unit())
            };
            whole = if k % 3 == 2 { whole.max(&-part) } else { whole.min(&part) };
        }
        whole
    }
}
