//! Numbers of twice the digits, for the last step of a measurement: T. J. Dekker, 1971.

/// The unevaluated sum of two numbers, about 31 digits.
#[derive(Clone, Copy, Debug)]
pub struct Double {
    high: f64,
    low: f64,
}

/// `a + b` and what the rounding lost (D. E. Knuth).
fn two_sum(a: f64, b: f64) -> Double {
    let high = a + b;
    let part = high - a;
    Double { high, low: (a - (high - part)) + (b - part) }
}

/// The halves of a number's digits (G. W. Veltkamp).
fn halves(a: f64) -> (f64, f64) {
    // Scaled so that the product stays in the range of numbers.
    if a.abs() > 1e290 {
        let (high, low) = halves(a * 2_f64.powi(-60));
        return (high * 2_f64.powi(60), low * 2_f64.powi(60));
    }
    let wide = 134_217_729.0 * a;
    let high = wide - (wide - a);
    (high, a - high)
}

fn two_product(a: f64, b: f64) -> Double {
    let high = a * b;
    let ((ah, al), (bh, bl)) = (halves(a), halves(b));
    Double { high, low: ((ah * bh - high) + ah * bl + al * bh) + al * bl }
}

impl From<f64> for Double {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Double {
    pub fn value(self) -> f64 {
        self.high + self.low
    }

    pub fn plus(self, other: Self) -> Self {
        let (high, low) = (two_sum(self.high, other.high), two_sum(self.low, other.low));
        let once = two_sum(high.high, high.low + low.high);
        two_sum(once.high, once.low + low.low)
    }

    pub fn minus(self, other: Self) -> Self {
        self.plus(Self { high: -other.high, low: -other.low })
    }

    pub fn times(self, other: Self) -> Self {
        let high = two_product(self.high, other.high);
        two_sum(high.high, high.low + (self.high * other.low + self.low * other.high))
    }

    pub fn over(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self.minus(other.times(first.into()));
        let second = rest.high / other.high;
        let rest = rest.minus(other.times(second.into()));
        two_sum(first, second).plus((rest.high / other.high).into())
    }

    pub fn root(self) -> Self {
        if self.high <= 0.0 {
            return 0.0.into();
        }
        let first = self.high.sqrt();
        let rest = self.minus(two_product(first, first));
        two_sum(first, rest.high / (2.0 * first))
    }
}

#[test]
fn has_thirty_digits() {
    let third = Double::from(1.0).over(3.0.into());
    let one = third.plus(third).plus(third).minus(1.0.into());
    assert!(one.value().abs() < 1e-31, "{one:?}");
    let two = Double::from(2.0).root();
    assert!(two.times(two).minus(2.0.into()).value().abs() < 1e-30);
    // 1 + 1e-20 squared, less 1.
    let square = Double::from(1.0).plus(1e-20.into());
    assert!((square.times(square).minus(1.0.into()).value() / 2e-20 - 1.0).abs() < 1e-10);
}
