//! Random numbers that are the same everywhere: splitmix64.
use super::sampler::{Point, cross, dot, length, scale, sub};

/// A generator; equal seeds give equal numbers.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Between `low` and `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.next() >> 11) as f64 / (1u64 << 53) as f64)
    }

    /// One of `0..n`.
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    /// A direction, even over the sphere.
    pub fn direction(&mut self) -> Point {
        loop {
            let p = std::array::from_fn(|_| self.between(-1.0, 1.0));
            if (0.1..1.0).contains(&length(p)) {
                return scale(p, 1.0 / length(p));
            }
        }
    }

    /// Three perpendicular unit vectors, the first as given.
    pub fn frame(&mut self, first: Point) -> [Point; 3] {
        let first = scale(first, 1.0 / length(first));
        loop {
            let other = self.direction();
            let across = sub(other, scale(first, dot(first, other)));
            if length(across) > 0.1 {
                let second = scale(across, 1.0 / length(across));
                return [first, second, cross(first, second)];
            }
        }
    }
}
