//! Random numbers, points, boxes and expressions for the tests of fields.
use chordal::implicit::{Binary, Expr, Unary};
use chordal::math::Box3;

/// Splitmix64, from a seed that the test prints.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / 9_007_199_254_740_992.0
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// An everyday number, a whole one, or one of any size.
    pub fn number(&mut self) -> f64 {
        match self.below(8) {
            0 => self.below(7) as f64 - 3.0,
            1 => (self.unit() - 0.5) * 2.0_f64.powi(self.below(80) as i32 - 40),
            2 => [0.0, -0.0, 1.0, -1.0, 1e300, -1e-300, 5e-324, 102_943.5][self.below(8)],
            _ => 8.0 * self.unit() - 4.0,
        }
    }

    /// A point within 4 of the origin.
    pub fn point(&mut self) -> [f64; 3] {
        [0, 1, 2].map(|_| 8.0 * self.unit() - 4.0)
    }

    /// A box near the origin: of any size down to a point, some with ends that are whole numbers.
    pub fn bounds(&mut self) -> Box3 {
        let size = [2.0, 0.5, 0.01, 1e-9, 0.0][self.below(5)];
        let whole = self.below(4) == 0;
        let mut bounds = Box3 { min: self.point(), max: [0.0; 3] };
        for k in 0..3 {
            if whole {
                bounds.min[k] = bounds.min[k].round();
            }
            bounds.max[k] = bounds.min[k] + size * self.unit();
        }
        bounds
    }

    /// A point of a box, often on its border.
    pub fn within(&mut self, bounds: &Box3) -> [f64; 3] {
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

    /// An expression of about `size` operations of every kind, on each other and on numbers.
    pub fn expression(&mut self, size: usize) -> Expr {
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

    /// Any operation, the common ones more often.
    fn binary(&mut self) -> Binary {
        let common = [Binary::Add, Binary::Sub, Binary::Mul, Binary::Min, Binary::Max];
        if self.below(2) == 0 { common[self.below(5)] } else { Binary::ALL[self.below(Binary::ALL.len())].0 }
    }

    /// Spheres and boxes joined and cut, with a branch that wins in most regions.
    pub fn solids(&mut self, count: usize) -> Expr {
        let axes = Expr::axes();
        let mut whole = Expr::constant(2.0);
        for k in 0..count {
            let centre = self.point();
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
