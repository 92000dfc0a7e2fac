//! `MonotoneChains`: sequences of points from low to high that can be joined and split anywhere without
//! copying.

/// Marks a missing link.
const NONE: u32 = u32::MAX;

/// A chain of one or more points: the ends of a linked list, and its rightmost point.
#[derive(Clone, Copy, Debug)]
pub(super) struct MonotoneChain {
    lowest: u32,
    highest: u32,
    rightmost: u32,
}

#[derive(Clone, Copy, Debug)]
struct ChainNode {
    point: u32,
    below: u32,
    above: u32,
}

/// The links of all chains. Removed links are reused.
#[derive(Clone, Debug, Default)]
pub(super) struct MonotoneChains {
    links: Vec<ChainNode>,
    free: Vec<u32>,
}

impl MonotoneChains {
    fn link(&mut self, link: ChainNode) -> u32 {
        if let Some(index) = self.free.pop() {
            self.links[index as usize] = link;
            return index;
        }
        self.links.push(link);
        (self.links.len() - 1) as u32
    }

    /// A chain of one point.
    pub fn one(&mut self, point: u32) -> MonotoneChain {
        let link = self.link(ChainNode { point, below: NONE, above: NONE });
        MonotoneChain { lowest: link, highest: link, rightmost: link }
    }

    /// The lowest point and the one above it.
    pub fn lowest(&self, chain: &MonotoneChain) -> Option<[u32; 2]> {
        let ChainNode { point, above, .. } = self.links[chain.lowest as usize];
        (above != NONE).then(|| [point, self.links[above as usize].point])
    }

    /// The highest point and the one below it.
    pub fn highest(&self, chain: &MonotoneChain) -> Option<[u32; 2]> {
        let ChainNode { point, below, .. } = self.links[chain.highest as usize];
        (below != NONE).then(|| [point, self.links[below as usize].point])
    }

    /// Removes the lowest of several points.
    pub fn drop_lowest(&mut self, chain: &mut MonotoneChain) {
        self.free.push(chain.lowest);
        chain.lowest = self.links[chain.lowest as usize].above;
        self.links[chain.lowest as usize].below = NONE;
    }

    /// Removes the highest of several points.
    pub fn drop_highest(&mut self, chain: &mut MonotoneChain) {
        self.free.push(chain.highest);
        chain.highest = self.links[chain.highest as usize].below;
        self.links[chain.highest as usize].above = NONE;
    }

    /// Appends the new rightmost point at the lower end.
    pub fn add_lowest(&mut self, chain: &mut MonotoneChain, point: u32) {
        let link = self.link(ChainNode { point, below: NONE, above: chain.lowest });
        self.links[chain.lowest as usize].below = link;
        (chain.lowest, chain.rightmost) = (link, link);
    }

    /// Appends the new rightmost point at the upper end.
    pub fn add_highest(&mut self, chain: &mut MonotoneChain, point: u32) {
        let link = self.link(ChainNode { point, below: chain.highest, above: NONE });
        self.links[chain.highest as usize].above = link;
        (chain.highest, chain.rightmost) = (link, link);
    }

    /// Splits a chain into the parts below and above the rightmost point, which both parts contain.
    pub fn split(&mut self, chain: MonotoneChain) -> (MonotoneChain, MonotoneChain) {
        let MonotoneChain { lowest, highest, rightmost } = chain;
        let ChainNode { point, above, .. } = self.links[rightmost as usize];
        let twin = self.link(ChainNode { point, below: NONE, above });
        if above != NONE {
            self.links[above as usize].below = twin;
        }
        self.links[rightmost as usize].above = NONE;
        let upper = MonotoneChain {
            lowest: twin,
            highest: if above == NONE { twin } else { highest },
            rightmost: twin,
        };
        (MonotoneChain { lowest, highest: rightmost, rightmost }, upper)
    }

    /// Joins two chains at their common point, which is the rightmost of both.
    pub fn merge(&mut self, lower: MonotoneChain, upper: MonotoneChain) -> MonotoneChain {
        let above = self.links[upper.lowest as usize].above;
        // Each of the two has a link for the common point.
        self.free.push(upper.lowest);
        let rightmost = lower.highest;
        if above == NONE {
            return MonotoneChain { rightmost, ..lower };
        }
        self.links[rightmost as usize].above = above;
        self.links[above as usize].below = rightmost;
        MonotoneChain { lowest: lower.lowest, highest: upper.highest, rightmost }
    }
}
