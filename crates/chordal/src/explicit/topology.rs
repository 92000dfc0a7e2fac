//! `Topology`: the rule by which rows of a mesh count as one position.
use super::Mesh;

/// The rule by which two rows of a mesh are the same position, and so two triangles neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topology {
    /// The ids of the mesh: equal [`Mesh::position_id`], or equal indices where it has none.
    Indices,
    /// Bit-identical coordinates, with `−0.0` and `0.0` equal ([`position_id_by_bits`]): for formats without
    /// position indices, such as STL and glTF.
    Positions,
}

impl Topology {
    /// The name in a report.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Indices => "indices",
            Self::Positions => "positions",
        }
    }

    /// The position id of every row, n ids below n; `None` when each row is its own position.
    #[must_use]
    pub fn ids(self, mesh: &Mesh) -> Option<std::borrow::Cow<'_, [u32]>> {
        match self {
            Self::Indices => mesh.position_id().map(Into::into),
            Self::Positions => Some(position_id_by_bits(mesh.positions()).into()),
        }
    }
}

/// For every row the first row with the same coordinates: n × 1 for n × 3 `positions`. `−0.0` equals `0.0`
/// here. So the ids may link rows that [`Mesh::with_position_id`], which requires equal bits, keeps apart.
///
/// About 15 ns per row on one core. Memory: 4 bytes per row and 16 to 64 per distinct one. O(n log n) even
/// for rows chosen to collide.
///
/// ```
/// use chordal::explicit::position_id_by_bits;
/// let rows = [[0.0, 1.0, 2.0], [5.0; 3], [-0.0, 1.0, 2.0]];
/// assert_eq!(position_id_by_bits(&rows), [0, 1, 0]);
/// ```
#[must_use]
pub fn position_id_by_bits(positions: &[[f64; 3]]) -> Vec<u32> {
    hashed(positions).unwrap_or_else(|| sorted(positions))
}

/// A row as bits that are equal for equal coordinates: adding zero turns `−0.0` into `0.0` and changes
/// nothing else.
#[inline]
fn key([x, y, z]: [f64; 3]) -> [u64; 3] {
    [(x + 0.0).to_bits(), (y + 0.0).to_bits(), (z + 0.0).to_bits()]
}

/// Rows whose table slots are looked up together, so that their cache misses overlap: measured, flat from 16
/// on.
const BLOCK: usize = 32;

/// Uses a hash table with open addressing. `None` when the rows collide so often that sorting is safer.
fn hashed(positions: &[[f64; 3]]) -> Option<Vec<u32>> {
    let mut table = PositionTable::new(positions.len());
    // At a load of one half a search takes 1.5 to 2.5 steps on average, and growing takes as many again.
    // Eight times that does not happen by chance.
    let mut steps_left = 16 * positions.len() + 1024;
    let mut ids = Vec::with_capacity(positions.len());
    let mut hashes = [0_u64; BLOCK];
    let mut warm = 0;
    for (block, rows) in positions.chunks(BLOCK).enumerate() {
        table.make_room(rows.len(), &mut steps_left)?;
        for (hash_of_row, row) in hashes.iter_mut().zip(rows) {
            *hash_of_row = hash(key(*row));
            warm ^= table.entries[table.slot(*hash_of_row)];
        }
        for (i, (row, &hash)) in rows.iter().zip(&hashes).enumerate() {
            let row_idx = (BLOCK * block + i) as u32;
            ids.push(table.find_or_add(*row, row_idx, hash, positions, &mut steps_left)?);
        }
    }
    std::hint::black_box(warm);
    Some(ids)
}

/// A table with open addressing that grows with the number of *distinct* rows: in a triangle soup these are a
/// sixth of all rows, and their table stays in the cache.
struct PositionTable {
    /// The upper half of a hash, and a row index plus one; 0 in an empty slot.
    entries: Vec<u64>,
    n_rows: usize,
}

impl PositionTable {
    /// For rows of which so many may be distinct. A scene may have a hundred thousand parts of three rows.
    fn new(n_rows: usize) -> Self {
        // A load below one half from the start; more slots come when they are needed.
        let n_slots = (2 * n_rows + BLOCK).next_power_of_two();
        Self { entries: vec![0; n_slots.min(1024)], n_rows: 0 }
    }

    /// The slot follows from the upper half of the hash, so that an entry is enough to find it again.
    #[inline]
    fn slot(&self, hash: u64) -> usize {
        (hash >> 32) as usize & (self.entries.len() - 1)
    }

    /// Grows the table so that its load stays below one half with `more` rows. The upper half of a hash
    /// distinguishes 2³² slots; there are too few rows for more.
    fn make_room(&mut self, more: usize, steps_left: &mut usize) -> Option<()> {
        if 2 * (self.n_rows + more) <= self.entries.len() {
            return Some(());
        }
        let grown = vec![0; 4 * self.entries.len()];
        for entry in std::mem::replace(&mut self.entries, grown).into_iter().filter(|entry| *entry != 0) {
            let mut slot = self.slot(entry);
            while self.entries[slot] != 0 {
                *steps_left = steps_left.checked_sub(1)?;
                slot = (slot + 1) & (self.entries.len() - 1);
            }
            self.entries[slot] = entry;
        }
        Some(())
    }

    /// The first row that equals this one; adds it if there is none.
    #[inline]
    fn find_or_add(
        &mut self,
        position: [f64; 3],
        row: u32,
        hash: u64,
        positions: &[[f64; 3]],
        steps_left: &mut usize,
    ) -> Option<u32> {
        let entry = hash >> 32 << 32 | (u64::from(row) + 1);
        let mut slot = self.slot(hash);
        loop {
            *steps_left = steps_left.checked_sub(1)?;
            let found = self.entries[slot];
            if found == 0 {
                self.entries[slot] = entry;
                self.n_rows += 1;
                return Some(row);
            }
            let earlier = (found as u32).wrapping_sub(1);
            if found >> 32 == hash >> 32 && key(positions[earlier as usize]) == key(position) {
                return Some(earlier);
            }
            slot = (slot + 1) & (self.entries.len() - 1);
        }
    }
}

/// Mixes 192 bits into 64: multiply, then fold the high half down, since coordinates often end in zero bits.
/// The odd constants are the fractional bits of the golden ratio, of √2 and of √3.
#[inline]
fn hash([x, y, z]: [u64; 3]) -> u64 {
    let fold = |h: u64| (h ^ (h >> 32)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let h = fold(x)
        .wrapping_add(fold(y ^ 0x6a09_e667_f3bc_c908).rotate_left(21))
        .wrapping_add(fold(z ^ 0xbb67_ae85_84ca_a73b).rotate_left(42));
    let h = fold(h);
    h ^ (h >> 29)
}

/// Sorts the rows: its running time does not depend on collisions.
fn sorted(positions: &[[f64; 3]]) -> Vec<u32> {
    let mut rows: Vec<u32> = (0..positions.len() as u32).collect();
    rows.sort_unstable_by_key(|&row| (key(positions[row as usize]), row));
    let mut ids = vec![0; rows.len()];
    let mut first = 0;
    for (i, &row) in rows.iter().enumerate() {
        let starts = i == 0 || key(positions[rows[i - 1] as usize]) != key(positions[row as usize]);
        first = if starts { row } else { first };
        ids[row as usize] = first;
    }
    ids
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    #[test]
    fn both_ways_find_the_first_equal_row() {
        let mut random = Random::new(7);
        let mut coordinate = || [-1.0, -0.0, 0.0, 1.0, 1e-300, 3.5][random.below(6)];
        let rows: Vec<[f64; 3]> = (0..2000).map(|_| [coordinate(), coordinate(), coordinate()]).collect();
        let naive: Vec<u32> =
            rows.iter().map(|row| rows.iter().position(|other| other == row).unwrap() as u32).collect();
        assert_eq!(hashed(&rows).unwrap(), naive);
        assert_eq!(sorted(&rows), naive);
        assert_eq!(position_id_by_bits(&[]), [0_u32; 0]);
    }

    #[test]
    fn rows_chosen_to_collide_fall_back_to_sorting() {
        // Rows whose hashes agree in the bits that select the slot: found by search, as an attacker would.
        let n = 3000;
        let mask = (4 * n as u64).next_power_of_two() - 1;
        let rows: Vec<[f64; 3]> = (0_u32..)
            .map(|i| [f64::from(i), 0.0, 0.0])
            .filter(|row| hash(key(*row)) >> 32 & mask < 2)
            .take(n)
            .collect();
        assert!(hashed(&rows).is_none());
        assert_eq!(position_id_by_bits(&rows), (0..n as u32).collect::<Vec<_>>());
    }
}
