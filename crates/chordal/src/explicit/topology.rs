//! `Topology`: the rule that decides which rows of a mesh are the same position.
use super::Mesh;
use crate::budget::{Job, par_map, par_map_owned};
use crate::math::simd::{self, Kernel};

/// The rule that decides whether two rows of a mesh are the same position, and so whether two triangles are
/// neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topology {
    /// The ids of the mesh: equal [`Mesh::position_id`], or equal indices if it has none.
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
    if positions.len() >= 2 * CHUNK
        && let Some(ids) = hashed_by_chunks(positions)
    {
        return ids;
    }
    hashed(positions).unwrap_or_else(|| sorted(positions))
}

/// A row as bits that are equal for equal coordinates: adding zero turns `−0.0` into `0.0` and changes no
/// other number.
#[inline(always)]
fn key([x, y, z]: [f64; 3]) -> [u64; 3] {
    [(x + 0.0).to_bits(), (y + 0.0).to_bits(), (z + 0.0).to_bits()]
}

/// Whether two rows have the same key, without a branch for each coordinate.
#[inline]
fn are_equal(a: [f64; 3], b: [f64; 3]) -> bool {
    let ([ax, ay, az], [bx, by, bz]) = (key(a), key(b));
    (ax ^ bx) | (ay ^ by) | (az ^ bz) == 0
}

/// Rows whose hashes are computed together: measured, flat from 16 on.
const BLOCK: usize = 32;

/// Uses a hash table with open addressing. `None` when the rows collide so often that sorting is safer.
fn hashed(positions: &[[f64; 3]]) -> Option<Vec<u32>> {
    let mut table = PositionTable::new(positions.len());
    let mut steps_left = steps_for(positions.len());
    let mut ids = Vec::with_capacity(positions.len());
    for (row, position) in (0..).zip(positions) {
        table.make_room(1, &mut steps_left)?;
        ids.push(table.find_or_add(row, hash(key(*position)), positions, &mut steps_left)?);
    }
    Some(ids)
}

/// Rows in a chunk, whose table then fits the second-level cache. Measured: with 8,192, too many rows are the
/// first of their position in the chunk, which takes a third more time.
const CHUNK: usize = 1 << 15;
/// The first rows of a chunk, which show whether equal rows are near each other.
const TRIAL: usize = 1 << 12;
/// The most rows of a part, by hash, whose table again fits the second-level cache.
const PART: usize = 1 << 14;

/// Like [`hashed`], for many rows: first within each chunk, then, by parts of equal hashes, for the rows that
/// are the first of their position in a chunk. Triangles that share a corner are usually close in memory,
/// even in a triangle soup, so few rows remain for the second step; if the start of a chunk shows that this
/// is not so, all its rows remain.
fn hashed_by_chunks(positions: &[[f64; 3]]) -> Option<Vec<u32>> {
    let job = Job::default();
    let mut ids = vec![0; positions.len()];
    // 1. For each row, find the first row of the chunk at its position.
    let chunks = ids.chunks_mut(CHUNK).enumerate().collect();
    let firsts = par_map_owned(&job, chunks, |(number, ids): (usize, &mut [u32])| {
        first_in_chunk(positions, number * CHUNK, ids)
    });
    let firsts: Vec<Vec<u64>> = firsts.into_iter().collect::<Option<_>>()?;
    // 2. Distribute these rows by the leading bits of their hashes, in ascending order in each part.
    let n_firsts: usize = firsts.iter().map(Vec::len).sum();
    let bits = n_firsts.div_ceil(PART).next_power_of_two().trailing_zeros();
    let part_of = |entry: u64| (entry >> 32 << bits >> 32) as usize;
    let mut ends = vec![0; 1 << bits];
    firsts.iter().flatten().for_each(|entry| ends[part_of(*entry)] += 1);
    let mut sum = 0;
    for end in &mut ends {
        sum += std::mem::replace(end, sum);
    }
    let mut sorted = vec![0; n_firsts];
    for entry in firsts.into_iter().flatten() {
        let end = &mut ends[part_of(entry)];
        sorted[*end] = entry;
        *end += 1;
    }
    // 3. For each of them, find the first row of all at its position.
    let starts = std::iter::once(0).chain(ends.iter().copied());
    let parts: Vec<&[u64]> = starts.zip(&ends).map(|(start, end)| &sorted[start..*end]).collect();
    let moved = par_map(&job, &parts, |_, part| first_in_part(positions, part));
    let mut is_moved = vec![false; ids.len().div_ceil(CHUNK)];
    for part in moved {
        for (row, first) in part? {
            ids[row as usize] = first;
            is_moved[row as usize / CHUNK] = true;
        }
    }
    // 4. All rows take the result of the first row in their chunk.
    let chunks = ids.chunks_mut(CHUNK).enumerate().filter(|(number, _)| is_moved[*number]).collect();
    par_map_owned(&job, chunks, |(number, ids): (usize, &mut [u32])| {
        let start = (number * CHUNK) as u32;
        for row in 0..ids.len() {
            // A first row comes before the others of its position, so its result is already final.
            let first = ids[row];
            ids[row] = if first < start { first } else { ids[(first - start) as usize] };
        }
    });
    Some(ids)
}

/// For each row of the chunk from `start` on, the first row of the chunk at its position; returns those first
/// rows, each with the upper half of its hash. `None` as for [`hashed`].
fn first_in_chunk(positions: &[[f64; 3]], start: usize, ids: &mut [u32]) -> Option<Vec<u64>> {
    let isa = simd::isa();
    let mut table = PositionTable::new(ids.len());
    let mut steps_left = steps_for(ids.len());
    let mut firsts = Vec::with_capacity(CHUNK / 4);
    let mut hashes = [0_u64; BLOCK];
    for (block, ids) in ids.chunks_mut(BLOCK).enumerate() {
        let from = start + BLOCK * block;
        simd::dispatch(isa, HashKernel { rows: &positions[from..from + ids.len()], hashes: &mut hashes });
        // If most rows so far were new, looking up the others gains little here: all count as
        // first, and the pass over parts finds equal ones among them.
        let all_new = BLOCK * block >= TRIAL && 2 * table.n_rows > TRIAL && 2 * firsts.len() > BLOCK * block;
        if !all_new {
            table.make_room(BLOCK, &mut steps_left)?;
        }
        for (row, (id, hash)) in (from..).zip(ids.iter_mut().zip(hashes)) {
            *id = if all_new {
                row as u32
            } else {
                table.find_or_add(row as u32, hash, positions, &mut steps_left)?
            };
            if *id == row as u32 {
                firsts.push(hash >> 32 << 32 | row as u64);
            }
        }
    }
    Some(firsts)
}

/// The rows of a part, in ascending order, that have an earlier row at their position, each with that row.
fn first_in_part(positions: &[[f64; 3]], part: &[u64]) -> Option<Vec<(u32, u32)>> {
    let mut table = PositionTable::new(part.len());
    let mut steps_left = steps_for(part.len());
    let mut moved = Vec::new();
    for &entry in part {
        let row = entry as u32;
        table.make_room(1, &mut steps_left)?;
        let first = table.find_or_add(row, entry, positions, &mut steps_left)?;
        if first != row {
            moved.push((row, first));
        }
    }
    Some(moved)
}

/// The hashes of a block of rows.
struct HashKernel<'a> {
    rows: &'a [[f64; 3]],
    hashes: &'a mut [u64; BLOCK],
}

impl Kernel for HashKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for (row, result) in self.rows.iter().zip(self.hashes) {
            *result = hash(key(*row));
        }
    }
}

/// The limit of steps. Derived: at a load of one half a search takes 1.5 to 2.5 steps on average, and growing
/// takes as many again. Eight times that does not happen by chance.
fn steps_for(n_rows: usize) -> usize {
    16 * n_rows + 1024
}

/// A table with open addressing that grows with the number of *distinct* rows: in a triangle soup these are a
/// sixth of all rows, and their table stays in the cache.
struct PositionTable {
    /// The upper half of a hash, and a row index plus one; 0 in an empty slot.
    entries: Vec<u64>,
    n_rows: usize,
}

impl PositionTable {
    /// A table for up to `n_rows` distinct rows. It starts small: a scene may have a hundred thousand parts
    /// of three rows.
    fn new(n_rows: usize) -> Self {
        // A load below one half from the start; more slots are added when needed.
        let n_slots = (2 * n_rows + BLOCK).next_power_of_two();
        Self { entries: vec![0; n_slots.min(1024)], n_rows: 0 }
    }

    /// The slot follows from the upper half of the hash, so that an entry is enough to find it again.
    #[inline]
    fn slot(&self, hash: u64) -> usize {
        (hash >> 32) as usize & (self.entries.len() - 1)
    }

    /// Grows the table so that its load stays below one half with `more` rows. The upper half of a hash
    /// distinguishes 2³² slots, more than there can be rows.
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

    /// The first row that equals this one; adds it if there is none. Coordinates are compared only if hashes
    /// agree.
    #[inline]
    fn find_or_add(
        &mut self,
        row: u32,
        hash: u64,
        positions: &[[f64; 3]],
        steps_left: &mut usize,
    ) -> Option<u32> {
        let entry = hash >> 32 << 32 | (u64::from(row) + 1);
        let mut slot = self.slot(hash);
        loop {
            *steps_left = steps_left.checked_sub(1)?;
            let stored = self.entries[slot];
            if stored == 0 {
                self.entries[slot] = entry;
                self.n_rows += 1;
                return Some(row);
            }
            let earlier = (stored as u32).wrapping_sub(1);
            if stored >> 32 == hash >> 32 && are_equal(positions[earlier as usize], positions[row as usize]) {
                return Some(earlier);
            }
            slot = (slot + 1) & (self.entries.len() - 1);
        }
    }
}

/// Mixes 192 bits into 64: multiply, then fold the high half down, since coordinates often end in zero bits.
/// The odd constants are the fractional bits of the golden ratio, of √2 and of √3.
#[inline(always)]
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
    fn chunks_find_the_first_equal_row_of_all() {
        let mut random = Random::new(9);
        // Corners that occur again close by, at the other end, and at the borders of chunks.
        for (n, n_distinct) in [(2 * CHUNK, 9), (3 * CHUNK + 1, 4000), (5 * CHUNK - 1, 40_000)] {
            let mut row_at = |row: usize| -> [f64; 3] {
                let is_far = random.below(50) == 0;
                let offset = random.below(if is_far { n_distinct } else { 7 });
                let at = (row * n_distinct / n + offset) % n_distinct;
                [at as f64, [0.0, -0.0][random.below(2)], 1.0 / (at + 1) as f64]
            };
            let rows: Vec<[f64; 3]> = (0..n).map(&mut row_at).collect();
            let ids = hashed_by_chunks(&rows).expect("few rows are distinct");
            assert!(ids == sorted(&rows), "{n}");
            assert!(ids == position_id_by_bits(&rows) && ids == hashed(&rows).expect("no collisions"));
        }
        // Mostly distinct, with a few that occur again far away.
        let mut rows_far_apart: Vec<[f64; 3]> = (0..3 * CHUNK).map(|i| [i as f64, 1.0, 2.0]).collect();
        (0..CHUNK).step_by(7).for_each(|row| rows_far_apart[2 * CHUNK + row] = rows_far_apart[row]);
        assert!(hashed_by_chunks(&rows_far_apart).expect("no collisions") == sorted(&rows_far_apart));
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
