//! `DisjointSets`: union–find over numbers.

/// A partition of numbers into disjoint sets.
pub(crate) struct DisjointSets {
    /// Each member points to an earlier one of its set; the earliest points to itself.
    parent: Vec<u32>,
    /// The number of unions of two different sets.
    joined: u64,
}

impl DisjointSets {
    /// Each number of `0..n` in its own set.
    pub fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect(), joined: 0 }
    }

    /// The earliest member of the set, for any order of the unions.
    #[inline]
    pub fn find(&mut self, mut member: u32) -> u32 {
        while self.parent[member as usize] != member {
            let up = self.parent[self.parent[member as usize] as usize];
            self.parent[member as usize] = up;
            member = up;
        }
        member
    }

    /// Merges the sets of two members.
    #[inline]
    pub fn union(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        if a != b {
            let (first, later) = if a < b { (a, b) } else { (b, a) };
            self.parent[later as usize] = first;
            self.joined += 1;
        }
    }

    /// The number of each member's set, in the order of the earliest members, and the number of sets.
    pub fn labels(mut self) -> (Vec<u32>, usize) {
        let mut number = vec![u32::MAX; self.parent.len()];
        let mut next = 0;
        for member in 0..self.parent.len() {
            let root = self.find(member as u32) as usize;
            if number[root] == u32::MAX {
                number[root] = next;
                next += 1;
            }
            number[member] = number[root];
        }
        (number, next as usize)
    }

    /// The number of unions: members minus sets.
    pub fn n_unions(&self) -> u64 {
        self.joined
    }
}
