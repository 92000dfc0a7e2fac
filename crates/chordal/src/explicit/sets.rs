//! `Sets`: disjoint sets of numbers that are joined one after the other.

/// Sets of numbers.
pub(crate) struct Sets {
    /// Each member points to an earlier one of its set or, the earliest, to itself.
    parent: Vec<u32>,
    /// How often two sets became one.
    joined: u64,
}

impl Sets {
    /// Each of `0..n` alone.
    pub fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect(), joined: 0 }
    }

    /// The earliest member of its set, whatever the order of the joins was.
    #[inline]
    pub fn root(&mut self, mut member: u32) -> u32 {
        while self.parent[member as usize] != member {
            let up = self.parent[self.parent[member as usize] as usize];
            self.parent[member as usize] = up;
            member = up;
        }
        member
    }

    /// Makes the sets of both one.
    #[inline]
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        if a != b {
            let (first, later) = if a < b { (a, b) } else { (b, a) };
            self.parent[later as usize] = first;
            self.joined += 1;
        }
    }

    /// A number for every member's set, in the order of their earliest members, and how many sets there are.
    pub fn numbered(mut self) -> (Vec<u32>, usize) {
        let mut number = vec![u32::MAX; self.parent.len()];
        let mut next = 0;
        for member in 0..self.parent.len() {
            let root = self.root(member as u32) as usize;
            if number[root] == u32::MAX {
                number[root] = next;
                next += 1;
            }
            number[member] = number[root];
        }
        (number, next as usize)
    }

    /// How many sets there are fewer than members.
    pub fn joined(&self) -> u64 {
        self.joined
    }
}
