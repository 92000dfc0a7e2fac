//! Random numbers that are the same on every machine.

/// A generator of random numbers: equal seeds give equal numbers. A test prints its seed.
///
/// The numbers are uniform and independent enough for shapes and points; streams of neighbouring seeds are
/// unrelated.
///
/// Source: SplitMix64 of G. Steele, D. Lea and C. Flood, *Fast splittable pseudorandom number generators*,
/// 2014.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The generator of a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 64 random bits of equal quality.
    pub fn bits(&mut self) -> u64 {
        // Defined by the source: the golden ratio as a step, and the mixing of its variant 13.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number of `0..n`.
    ///
    /// # Panics
    /// If `n` is 0.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// A multiple of 2⁻⁵³ in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number in [−1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// A number between two others, uniformly.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A power of ten with a uniform exponent between two numbers.
    pub fn power(&mut self, low: f64, high: f64) -> f64 {
        10_f64.powf(self.between(low, high))
    }

    /// A point of the cube from −1 to 1.
    pub fn point<const D: usize>(&mut self) -> [f64; D] {
        self.point_within(1.0)
    }

    /// A point of the cube from `−reach` to `reach`.
    pub fn point_within<const D: usize>(&mut self, reach: f64) -> [f64; D] {
        std::array::from_fn(|_| reach * self.signed())
    }

    /// A unit vector, uniform over the sphere.
    pub fn direction<const D: usize>(&mut self) -> [f64; D] {
        loop {
            let p: [f64; D] = self.point();
            let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
            if length > 0.1 && length <= 1.0 {
                return p.map(|x| x / length);
            }
        }
    }

    /// Three weights ≥ 0 with sum 1: a point of a triangle, uniform over its area.
    pub fn weights(&mut self) -> [f64; 3] {
        let (a, b) = (self.unit(), self.unit());
        let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
        [a, b, 1.0 - (a + b)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_published_generator() {
        // The numbers by which implementations of SplitMix64 are compared.
        let mut random = Random::new(1_234_567);
        let expected = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
            4_593_380_528_125_082_431,
            16_408_922_859_458_223_821,
        ];
        assert_eq!([0; 5].map(|_: u64| random.bits()), expected);
    }

    #[test]
    fn numbers_fill_their_ranges() {
        let mut random = Random::new(0);
        let (mut counts, mut sum) = ([0_u32; 10], [0.0; 3]);
        for _ in 0..10_000 {
            counts[random.below(10)] += 1;
            let (unit, signed) = (random.unit(), random.signed());
            assert!((0.0..1.0).contains(&unit) && (-1.0..1.0).contains(&signed));
            assert!((0.1..1000.0).contains(&random.power(-1.0, 3.0)));
            assert!((3.0..5.0).contains(&random.between(3.0, 5.0)));
            let [w, direction] = [random.weights(), random.direction()];
            assert!(w.iter().all(|x| *x >= 0.0) && (w.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            assert!((direction.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-15);
            (0..3).for_each(|k| sum[k] += w[k] - 1.0 / 3.0 + direction[k]);
        }
        // 1000 each, with a standard deviation of 30; and sums with one of at most 10⁴ᐟ²·√(1/3 + 1/18).
        assert!(counts.iter().all(|n| (850..1150).contains(n)), "{counts:?}");
        assert!(sum.iter().all(|x| x.abs() < 5.0 * 63.0), "{sum:?}");
    }
}
