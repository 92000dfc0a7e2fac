//! `FaceSideCache`: the verdicts of earlier queries for the sides of triangles.
use crate::implicit::Membership;
use std::collections::HashMap;

/// The verdict on a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FaceSide {
    /// All of it is on the required side.
    Proved,
    /// Not proved.
    Open,
    /// A part of it is certainly on the other side.
    Wrong,
}

/// Verdicts of earlier queries: most triangles do not change from one mesh to the next.
#[derive(Clone, Debug)]
pub(super) struct FaceSideCache {
    verdicts: HashMap<[u64; 10], (FaceSide, u32)>, // No order depends on it: it is never iterated.
    /// The most triangles kept.
    most: usize,
}

/// The most triangles kept, for any amount of memory: some hundred megabytes.
const MOST_VERDICTS: usize = 1 << 20;
/// Bytes per entry, about: twice its size, as tables grow by doubling.
const BYTES_PER_VERDICT: u64 = 200;
/// The share of the job's memory for the entries.
const VERDICTS_SHARE: u64 = 16;

impl FaceSideCache {
    pub fn new(memory_limit: u64) -> Self {
        let most = memory_limit / VERDICTS_SHARE / BYTES_PER_VERDICT;
        let most = usize::try_from(most).unwrap_or(MOST_VERDICTS).min(MOST_VERDICTS);
        Self { verdicts: HashMap::new(), most } // No order depends on it.
    }

    /// The key of a triangle: the bits of its corners and the required side.
    pub fn key(corners: &[[f64; 3]; 3], side: Membership) -> [u64; 10] {
        let mut key = [0; 10];
        for (bits, x) in key.iter_mut().zip(corners.as_flattened()) {
            *bits = x.to_bits();
        }
        key[9] = u64::from(side == Membership::Inside);
        key
    }

    /// The cached verdict, if it was found with at least as many bisections.
    pub fn get(&self, key: &[u64; 10], cuts: u32) -> Option<FaceSide> {
        let (side, with) = self.verdicts.get(key)?;
        (*side != FaceSide::Open || *with >= cuts).then_some(*side)
    }

    /// Makes room for so many verdicts more: forgets all of them if there would be too many.
    pub fn reserve(&mut self, n_more: usize) {
        if self.verdicts.len() + n_more > self.most {
            self.verdicts.clear();
        }
    }

    pub fn insert(&mut self, key: [u64; 10], side: FaceSide, cuts: u32) {
        self.verdicts.insert(key, (side, cuts));
    }
}
