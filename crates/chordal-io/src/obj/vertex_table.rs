//! `ObjVertexTable`: vertex rows, one for each combination of position, texture coordinate and normal that a
//! face uses.
use crate::ReadError;
use crate::grow::{push, push_many};
use std::collections::HashMap;

/// A position that no face has used so far.
const UNUSED: u32 = u32::MAX;

/// One corner of a face: the row of the position from 0, and the rows of the others from 1, where 0 means
/// none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct ObjCorner {
    pub(super) position: u32,
    pub(super) texcoord: u32,
    pub(super) normal: u32,
}

/// Numbers the combinations. The first one at a position gets that position's own row, so the rows start with
/// all positions of the file in its order. Further combinations follow in the order in which faces use them.
#[derive(Debug, Default)]
pub(super) struct ObjVertexTable {
    first: Vec<[u32; 2]>,
    more: Vec<ObjCorner>,
    /// Only for lookups: rows are numbered in the order of the file.
    index: HashMap<ObjCorner, u32>,
}

impl ObjVertexTable {
    /// A table for a file with that many positions.
    pub(super) fn new(n_positions: usize) -> Result<Self, ReadError> {
        let mut first = Vec::new();
        push_many(&mut first, [UNUSED, UNUSED], n_positions)?;
        Ok(Self { first, ..Self::default() })
    }

    /// The row of a corner.
    #[inline]
    pub(super) fn row(&mut self, corner: ObjCorner) -> Result<u32, ReadError> {
        let first_pair = &mut self.first[corner.position as usize];
        let pair = [corner.texcoord, corner.normal];
        if *first_pair == pair {
            return Ok(corner.position);
        }
        if *first_pair == [UNUSED, UNUSED] {
            *first_pair = pair;
            return Ok(corner.position);
        }
        // Only positions at seams get further, and need the map.
        let next = self.first.len() + self.more.len();
        match self.index.entry(corner) {
            std::collections::hash_map::Entry::Occupied(known) => Ok(*known.get()),
            std::collections::hash_map::Entry::Vacant(slot) => {
                let row = u32::try_from(next).ok().filter(|row| *row < UNUSED);
                let row = row.ok_or_else(|| crate::grow::out_of_memory(next))?;
                push(&mut self.more, corner)?;
                Ok(*slot.insert(row))
            }
        }
    }

    /// Every row as a corner; positions that no face uses have no texture coordinate and no normal.
    pub(super) fn corners(&self) -> impl Iterator<Item = ObjCorner> + Clone {
        let first_corners = self.first.iter().enumerate().map(|(i, &[texcoord, normal])| {
            let [texcoord, normal] = if texcoord == UNUSED { [0, 0] } else { [texcoord, normal] };
            ObjCorner { position: i as u32, texcoord, normal }
        });
        first_corners.chain(self.more.iter().copied())
    }

    /// Whether row `row` is used by a face.
    pub(super) fn is_used(&self, row: usize) -> bool {
        self.first.get(row).is_none_or(|own| *own != [UNUSED, UNUSED])
    }

    /// Whether some position has more than one row.
    pub(super) fn has_splits(&self) -> bool {
        !self.more.is_empty()
    }

    /// The number of rows.
    pub(super) fn len(&self) -> usize {
        self.first.len() + self.more.len()
    }
}
