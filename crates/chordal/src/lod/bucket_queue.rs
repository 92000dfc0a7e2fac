//! `BucketQueue`: a priority queue by least cost, exact to a sixteenth of an octave.

/// Entries in buckets by cost. A bucket spans a sixteenth of an octave and is first in, first out, so that
/// edges of equal cost are collapsed all over the surface and not next to the last one.
///
/// Costs are f32 ≥ 0; all costs below the smallest normal number are equal. An entry whose cost is below the
/// bucket that is being emptied is added to the end of that bucket. Push and pop are O(1).
#[derive(Clone)]
pub(super) struct BucketQueue {
    buckets: Vec<Vec<u32>>,
    /// The bucket that is being emptied, and the number of entries already taken from it.
    current: usize,
    taken: usize,
}

/// Bits of the mantissa that choose the bucket.
const FINE: u32 = 4;
/// Buckets for all positive f32.
const BUCKETS: usize = 256 << FINE;

impl BucketQueue {
    pub fn new() -> Self {
        Self { buckets: vec![Vec::new(); BUCKETS], current: 0, taken: 0 }
    }

    #[inline]
    fn bucket_of(cost: f32) -> usize {
        // The exponent and the first bits of the mantissa: numbers ≥ 0 are in the order of their bits. The
        // mask drops the sign of −0.
        (cost.to_bits() >> (23 - FINE)) as usize & (BUCKETS - 1)
    }

    /// Whether an entry of this cost would have to wait until the current bucket is empty.
    #[inline]
    pub fn is_later(&self, cost: f32) -> bool {
        Self::bucket_of(cost) > self.current
    }

    #[inline]
    pub fn push(&mut self, cost: f32, entry: u32) {
        let bucket = Self::bucket_of(cost);
        let bucket = if bucket < self.current { self.current } else { bucket };
        self.buckets[bucket].push(entry);
    }

    /// Adds an entry to the current bucket.
    #[inline]
    pub fn push_now(&mut self, entry: u32) {
        self.buckets[self.current].push(entry);
    }

    /// An entry of the least cost.
    #[inline]
    pub fn pop(&mut self) -> Option<u32> {
        loop {
            let bucket = &mut self.buckets[self.current];
            if let Some(&entry) = bucket.get(self.taken) {
                self.taken += 1;
                return Some(entry);
            }
            // Frees its memory.
            *bucket = Vec::new();
            self.taken = 0;
            if self.current + 1 == BUCKETS {
                return None;
            }
            self.current += 1;
        }
    }

    /// The entry that is popped after `n` others of its bucket, if nothing is pushed.
    #[inline]
    pub fn ahead(&self, n: usize) -> Option<u32> {
        self.buckets[self.current].get(self.taken + n).copied()
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
        let costs: Vec<f32> = (0..5000)
            .map(|i| if i % 50 == 0 { 0.0 } else { f32::from_bits(random.below(1 << 30) as u32) })
            .collect();
        costs.iter().enumerate().for_each(|(i, cost)| queue.push(*cost, i as u32));
        let (mut last, mut n) = (0.0_f32, 0);
        while let Some(i) = queue.pop() {
            let cost = costs[i as usize];
            assert!(cost.max(f32::MIN_POSITIVE) >= last / 1.07, "{cost} after {last}");
            (last, n) = (cost, n + 1);
        }
        assert_eq!(n, 5000);
    }

    #[test]
    fn what_is_cheaper_than_the_current_bucket_comes_at_its_end() {
        let mut queue = BucketQueue::new();
        queue.push(3.0, 1);
        queue.push(3.0, 2);
        queue.push(9.0, 3);
        assert_eq!((queue.ahead(0), queue.ahead(1)), (None, None));
        assert_eq!(queue.pop(), Some(1));
        assert_eq!((queue.ahead(0), queue.ahead(1)), (Some(2), None));
        assert!(queue.is_later(9.0) && !queue.is_later(3.0) && !queue.is_later(1.0));
        queue.push(1.0, 4);
        queue.push_now(5);
        let out = [queue.pop(), queue.pop(), queue.pop(), queue.pop(), queue.pop()];
        assert_eq!(out, [Some(2), Some(4), Some(5), Some(3), None]);
    }
}
