//! `HalvedCells`: the cells of a lattice that are halved along each index, the parts among their eight that are halved
//! again, and so on: an octree in each cell.
use std::collections::BTreeMap;

/// The most halvings of a cell: 4,096 parts along each edge.
pub(in crate::convert) const MOST_HALVINGS: usize = 12;

/// The bits of an index of a cell: three indices fit in one key.
const INDEX_BITS: u32 = 21;

/// A cell of a level: a cell of the lattice has 2^level of them along each index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct OctreeCell {
    pub level: u8,
    /// Counted in cells of its level.
    pub at: [u32; 3],
}

impl OctreeCell {
    /// Its eight parts, in the order of corners.
    pub fn parts(self) -> [Self; 8] {
        std::array::from_fn(|c| {
            let at = std::array::from_fn(|k| 2 * self.at[k] + (c >> k & 1) as u32);
            Self { level: self.level + 1, at }
        })
    }

    /// The cell of the lattice that contains it.
    pub fn root(self) -> [usize; 3] {
        self.at.map(|i| (i >> self.level) as usize)
    }

    /// The indices of its first corner in the lattice of its level.
    pub fn index(self) -> [usize; 3] {
        self.at.map(|i| i as usize)
    }

    fn key(self) -> u64 {
        let [x, y, z] = self.at.map(u64::from);
        x | y << INDEX_BITS | z << (2 * INDEX_BITS)
    }
}

/// Whether the cells of a level with so many samples along each index can be numbered.
pub(in crate::convert) fn has_keys(samples: [usize; 3]) -> bool {
    samples.iter().all(|n| *n <= 1 << INDEX_BITS)
}

/// The cells that are halved.
#[derive(Clone)]
pub(super) struct HalvedCells {
    /// Cells of the lattice along each index.
    size: [usize; 3],
    /// One bit for each cell of the lattice.
    roots: Vec<u64>,
    /// For each further level the sorted keys of its halved cells.
    deeper: Vec<Vec<u64>>,
}

impl HalvedCells {
    /// No halved cells, for a lattice with so many samples.
    pub fn none(samples: [usize; 3]) -> Self {
        let size = samples.map(|n| n - 1);
        let words = (size[0] * size[1] * size[2]).div_ceil(64);
        Self { size, roots: vec![0; words], deeper: Vec::new() }
    }

    fn root(&self, [i, j, k]: [usize; 3]) -> usize {
        i + self.size[0] * (j + self.size[1] * k)
    }

    /// Halves cells that are not halved yet.
    pub fn halve(&mut self, cells: &[OctreeCell]) {
        let mut more: BTreeMap<u8, Vec<u64>> = BTreeMap::new();
        for cell in cells {
            if cell.level == 0 {
                let at = self.root(cell.root());
                self.roots[at / 64] |= 1 << (at % 64);
            } else {
                more.entry(cell.level).or_default().push(cell.key());
            }
        }
        for (level, keys) in more {
            let level = usize::from(level) - 1;
            self.deeper.resize(self.deeper.len().max(level + 1), Vec::new());
            self.deeper[level].extend(keys);
            self.deeper[level].sort_unstable();
        }
    }

    /// Whether the cell of a level at these indices is halved; a cell outside of the lattice is not.
    pub fn is_halved(&self, level: u8, at: [i64; 3]) -> bool {
        if (0..3).any(|k| at[k] < 0 || at[k] >= (self.size[k] as i64) << level) {
            return false;
        }
        self.is_cell_halved(OctreeCell { level, at: at.map(|i| i as u32) })
    }

    /// Whether a cell is halved.
    pub fn is_cell_halved(&self, cell: OctreeCell) -> bool {
        if cell.level == 0 {
            let at = self.root(cell.root());
            return self.roots[at / 64] >> (at % 64) & 1 == 1;
        }
        let keys = self.deeper.get(usize::from(cell.level) - 1);
        keys.is_some_and(|keys| keys.binary_search(&cell.key()).is_ok())
    }

    /// The leaf that contains this cell; this cell itself if it is halved or a leaf.
    pub fn leaf_around(&self, cell: OctreeCell) -> OctreeCell {
        for level in 0..cell.level {
            let around = OctreeCell { level, at: cell.at.map(|i| i >> (cell.level - level)) };
            if !self.is_cell_halved(around) {
                return around;
            }
        }
        cell
    }

    /// Whether any of the four cells of a level around an edge is halved: then the edge is halved, too.
    pub fn is_edge_halved(&self, level: u8, axis: usize, low: [u32; 3]) -> bool {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        (0..4).any(|c| {
            let mut at = low.map(i64::from);
            at[u] -= c & 1;
            at[v] -= c >> 1;
            self.is_halved(level, at)
        })
    }

    /// The bytes of the set.
    pub fn bytes(&self) -> u64 {
        8 * (self.roots.len() + self.deeper.iter().map(Vec::len).sum::<usize>()) as u64
    }
}
