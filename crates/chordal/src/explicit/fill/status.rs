//! `SweepStatus`: the edges that a sweep line crosses, from the lowest to the highest.
use std::cmp::Ordering;

/// The most edges of one block. Measured: values from 64 to 512 make no difference; a block of this size
/// moves as one memory page.
const MOST: usize = 256;

/// An ordered list in non-empty blocks. A search takes O(log n) steps. A change moves one block, and the list
/// of blocks if one is split or removed, which is n / 256² moves per change on average.
#[derive(Clone, Debug, Default)]
pub(super) struct SweepStatus {
    blocks: Vec<Vec<u32>>,
    spare: Vec<Vec<u32>>,
}

/// A position between two edges, or at an end: before edge `row` of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct StatusPosition {
    block: usize,
    row: usize,
}

impl SweepStatus {
    /// Removes the edges on which the point lies, in order, and returns their position. `side` is the side of
    /// an edge on which the point lies; greater is above.
    pub fn take(&mut self, side: impl Fn(u32) -> Ordering, taken: &mut Vec<u32>) -> StatusPosition {
        taken.clear();
        let is_below = |edge: &u32| side(*edge) == Ordering::Greater;
        // The last block that starts below the point.
        let block = self.blocks.partition_point(|block| is_below(&block[0])).saturating_sub(1);
        let row = self.blocks.get(block).map_or(0, |rows| rows.partition_point(is_below));
        let mut position = StatusPosition { block, row };
        // The edges on the point follow each other, but may go on in the next block.
        loop {
            position = self.settled(position);
            let Some(rows) = self.blocks.get_mut(position.block) else { break };
            let n = rows[position.row..].iter().take_while(|edge| side(**edge) == Ordering::Equal).count();
            if n == 0 {
                break;
            }
            taken.extend(rows.drain(position.row..position.row + n));
            if rows.is_empty() {
                self.spare.push(self.blocks.remove(position.block));
            }
        }
        position
    }

    /// The same position, given by the following edge if there is one.
    fn settled(&self, position: StatusPosition) -> StatusPosition {
        match self.blocks.get(position.block) {
            Some(rows) if position.row == rows.len() => StatusPosition { block: position.block + 1, row: 0 },
            _ => position,
        }
    }

    /// The edge below a position.
    pub fn before(&self, position: StatusPosition) -> Option<u32> {
        if position.row > 0 {
            return Some(self.blocks[position.block][position.row - 1]);
        }
        self.blocks[..position.block].last().and_then(|rows| rows.last()).copied()
    }

    /// The edge above a position.
    pub fn at(&self, position: StatusPosition) -> Option<u32> {
        self.blocks.get(position.block).map(|rows| rows[position.row])
    }

    /// Inserts edges at a position, in order.
    pub fn insert(&mut self, position: StatusPosition, edges: &[u32]) {
        let StatusPosition { mut block, mut row } = position;
        if row == 0 && block > 0 {
            // At the end of the previous block: the position after the last edge is in no block.
            block -= 1;
            row = self.blocks[block].len();
        }
        if self.blocks.is_empty() {
            self.blocks.push(self.spare.pop().unwrap_or_default());
        }
        let rows = &mut self.blocks[block];
        rows.splice(row..row, edges.iter().copied());
        while self.blocks[block].len() > MOST {
            let mut upper = self.spare.pop().unwrap_or_default();
            let from = self.blocks[block].len() - MOST / 2;
            upper.extend(self.blocks[block].drain(from..));
            self.blocks.insert(block + 1, upper);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    #[test]
    fn is_a_sorted_list_through_any_changes() {
        let mut status = SweepStatus::default();
        let mut plain: Vec<u32> = Vec::new();
        let mut random = Random::new(9);
        let mut taken = Vec::new();
        for round in 0..40_000 {
            let value = random.below(50_000) as u32;
            let side = |edge: u32| value.cmp(&edge);
            let position = status.take(side, &mut taken);
            let low = plain.partition_point(|v| *v < value);
            let n = plain[low..].iter().take_while(|v| **v == value).count();
            let expected: Vec<u32> = plain.splice(low..low + n, []).collect();
            assert_eq!(taken, expected);
            assert_eq!(status.before(position), low.checked_sub(1).map(|k| plain[k]));
            assert_eq!(status.at(position), plain.get(low).copied());
            // The list first grows, then shrinks.
            let copies =
                if round < 20_000 { [1, 2, 700][round % 100 / 98 + usize::from(round == 77)] } else { 0 };
            let edges = vec![value; copies];
            status.insert(position, &edges);
            plain.splice(low..low, edges);
            assert!(
                round % 100 > 0 || status.blocks.iter().all(|rows| !rows.is_empty() && rows.len() <= MOST)
            );
        }
        assert!(plain.iter().eq(status.blocks.iter().flatten()));
    }
}
