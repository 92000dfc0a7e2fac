//! `BucketQueue`: a priority queue by least cost, up to a sixteenth of an octave.

/// Entries in buckets by cost. A bucket spans a sixteenth of an octave and is first in, first out, so that
/// edges of equal cost are collapsed all over the surface and not next to the last one.
///
/// Costs are f32 ≥ 0; all costs below the smallest normal number are equal. Push and pop are O(1).
#[derive(Clone)]
pub(super) struct BucketQueue {
    buckets: Vec<CostBucket>,
    /// All buckets before this one are empty.
    first: usize,
}

#[derive(Clone, Default)]
struct CostBucket {
    entries: Vec<(f32, u32)>,
    /// The number of entries that are already taken.
    taken: usize,
}

/// Bits of the mantissa that choose the bucket.
const FINE: u32 = 4;
/// Buckets for all positive f32.
const BUCKETS: usize = 256 << FINE;

impl BucketQueue {
    pub fn new() -> Self {
        Self { buckets: vec![CostBucket::default(); BUCKETS], first: BUCKETS }
    }

    #[inline]
    fn bucket_of(cost: f32) -> usize {
        (cost.to_bits() >> (23 - FINE)) as usize & (BUCKETS - 1)
    }

    #[inline]
    pub fn push(&mut self, cost: f32, what: u32) {
        let bucket = Self::bucket_of(cost);
        self.buckets[bucket].entries.push((cost, what));
        if bucket < self.first {
            self.first = bucket;
        }
    }

    /// The entry of least cost, with its cost.
    #[inline]
    pub fn pop(&mut self) -> Option<(f32, u32)> {
        while let Some(bucket) = self.buckets.get_mut(self.first) {
            if let Some(&entry) = bucket.entries.get(bucket.taken) {
                bucket.taken += 1;
                return Some(entry);
            }
            *bucket = CostBucket::default();
            self.first += 1;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    #[test]
    fn comes_out_by_cost_up_to_the_width_of_a_bucket() {
        let mut queue = BucketQueue::new();
        let mut random = Random::new(1);
        for i in 0..5000 {
            let cost = f32::from_bits(random.below(1 << 30) as u32);
            queue.push(if i % 50 == 0 { 0.0 } else { cost }, i);
        }
        let (mut last, mut n) = (0.0_f32, 0);
        while let Some((cost, _)) = queue.pop() {
            assert!(cost.max(f32::MIN_POSITIVE) >= last / 1.07, "{cost} after {last}");
            (last, n) = (cost, n + 1);
        }
        assert_eq!(n, 5000);
        queue.push(3.0, 1);
        queue.push(3.0, 2);
        queue.push(1.0, 3);
        assert_eq!(
            [queue.pop(), queue.pop(), queue.pop()].map(|e| e.map(|e| e.1)),
            [Some(3), Some(1), Some(2)]
        );
    }
}
