//! Splines in double-double arithmetic, 106 bits, by the recursion of Cox and de Boor: nothing shared with the library.
use chordal::explicit::nurbs::NurbsCurve;

/// An unevaluated sum of two numbers.
#[derive(Clone, Copy, Debug)]
pub struct Dd(pub f64, pub f64);

fn two_sum(a: f64, b: f64) -> Dd {
    let sum = a + b;
    let of_b = sum - a;
    Dd(sum, (a - (sum - of_b)) + (b - of_b))
}

fn two_product(a: f64, b: f64) -> Dd {
    // A fused product is exact here, and tests may use it.
    let product = a * b;
    Dd(product, a.mul_add(b, -product))
}

impl Dd {
    pub fn new(x: f64) -> Self {
        Self(x, 0.0)
    }

    pub fn plus(self, other: Self) -> Self {
        let sum = two_sum(self.0, other.0);
        two_sum(sum.0, sum.1 + (self.1 + other.1))
    }

    pub fn minus(self, other: Self) -> Self {
        self.plus(Self(-other.0, -other.1))
    }

    pub fn times(self, other: Self) -> Self {
        let product = two_product(self.0, other.0);
        two_sum(product.0, product.1 + (self.0 * other.1 + self.1 * other.0))
    }

    pub fn over(self, other: Self) -> Self {
        let first = self.0 / other.0;
        let rest = self.minus(other.times(Self::new(first)));
        let second = rest.0 / other.0;
        let left = rest.minus(other.times(Self::new(second)));
        two_sum(first, second).plus(Self::new(left.0 / other.0))
    }
}

/// The basis functions at `t`, which is no knot.
fn basis(knots: &[f64], degree: usize, t: Dd) -> Vec<Dd> {
    let last = knots.len() - 1;
    let is_in = |k: usize| knots[k] <= t.0 && t.0 < knots[k + 1];
    let mut row: Vec<Dd> = (0..last).map(|k| Dd::new(f64::from(u8::from(is_in(k))))).collect();
    for p in 1..=degree {
        let share = |from: Dd, to: Dd, low: f64, high: f64| {
            let whole = Dd::new(high).minus(Dd::new(low));
            if whole.0 > 0.0 { to.minus(from).over(whole) } else { Dd::new(0.0) }
        };
        row = (0..last - p)
            .map(|k| {
                let rising = share(Dd::new(knots[k]), t, knots[k], knots[k + p]);
                let falling = share(t, Dd::new(knots[k + p + 1]), knots[k + 1], knots[k + p + 1]);
                rising.times(row[k]).plus(falling.times(row[k + 1]))
            })
            .collect();
    }
    row
}

/// The point of a curve at a parameter inside of its domain that is no knot.
pub fn point<const D: usize>(curve: &NurbsCurve<D>, t: Dd) -> [Dd; D] {
    let basis = basis(curve.knots().knots(), curve.knots().degree(), t);
    let (mut sum, mut total) = ([Dd::new(0.0); D], Dd::new(0.0));
    for ((b, w), p) in basis.iter().zip(curve.weights()).zip(curve.control()) {
        let factor = b.times(Dd::new(*w));
        total = total.plus(factor);
        (0..D).for_each(|k| sum[k] = sum[k].plus(factor.times(Dd::new(p[k]))));
    }
    sum.map(|x| x.over(total))
}

/// How far two curves are apart at a parameter, in units of ε times the largest coordinate of the first.
pub fn apart<const D: usize>(a: &NurbsCurve<D>, b: &NurbsCurve<D>, t: f64) -> f64 {
    apart_at([a, b], [Dd::new(t); 2])
}

/// How far the point of one curve at a parameter is from that of another at another one.
pub fn apart_at<const D: usize>([a, b]: [&NurbsCurve<D>; 2], [s, t]: [Dd; 2]) -> f64 {
    let (p, q) = (point(a, s), point(b, t));
    let off = (0..D).map(|k| p[k].minus(q[k]).0).fold(0.0, |most: f64, x| most.max(x.abs()));
    let reach = a.control().as_flattened().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    off / (f64::EPSILON * reach)
}
