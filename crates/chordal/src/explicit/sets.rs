//! `Sets`: disjoint sets of numbers that are joined one after the other.

/// Each member points to an earlier one of its set or, the earliest, to itself.
pub(crate) struct Sets(Vec<u32>);

impl Sets {
    /// Each of `0..n` alone.
    pub fn new(n: usize) -> Self {
        Self((0..n as u32).collect())
    }

    /// The earliest member of its set, whatever the order of the joins was.
    #[inline]
    pub fn root(&mut self, mut member: u32) -> u32 {
        while self.0[member as usize] != member {
            let up = self.0[self.0[member as usize] as usize];
            self.0[member as usize] = up;
            member = up;
        }
        member
    }

    /// Makes the sets of both one.
    #[inline]
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        let (first, later) = if a < b { (a, b) } else { (b, a) };
        self.0[later as usize] = first;
    }
}
