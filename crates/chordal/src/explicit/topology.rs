//! `Topology`: which rows of a mesh count as one position.
use super::Mesh;

/// What makes two rows of a mesh the same position, and so two triangles neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topology {
    /// The mesh's own word: equal [`Mesh::position_id`], or equal indices where it has none.
    Indices,
    /// Bit-identical coordinates, `−0.0` and `0.0` taken as equal ([`position_id_by_bits`]): for formats that carry
    /// no indices of positions, as STL and glTF.
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

    /// The position of every row, n ids below n; `None` when each row is its own.
    #[must_use]
    pub fn ids(self, mesh: &Mesh) -> Option<std::borrow::Cow<'_, [u32]>> {
        match self {
            Self::Indices => mesh.position_id().map(Into::into),
            Self::Positions => Some(position_id_by_bits(mesh.positions()).into()),
        }
    }
}

/// For every row the first row with the same coordinates: n × 1 for n × 3 `positions`. `−0.0` equals `0.0` here, so
/// the ids may tie rows that [`Mesh::with_position_id`], which wants equal bits, keeps apart.
///
/// About 25 ns a row on one core and 8 to 16 bytes a row; O(n log n) also against rows chosen to collide.
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

/// A row as bits in which equal coordinates are equal: adding zero turns `−0.0` into `0.0` and nothing else.
#[inline]
fn key(row: [f64; 3]) -> [u64; 3] {
    row.map(|x| (x + 0.0).to_bits())
}

/// By an open table of rows. `None` when the rows collide so often that sorting is the safer way.
fn hashed(positions: &[[f64; 3]]) -> Option<Vec<u32>> {
    const EMPTY: u32 = u32::MAX;
    let size = (2 * positions.len()).next_power_of_two();
    let mut table = vec![EMPTY; size];
    // At a load of one half a search takes 1.5 to 2.5 steps on average; eight times that is no accident.
    let mut steps_left = 16 * positions.len() + 1024;
    let mut ids = Vec::with_capacity(positions.len());
    for (row, position) in positions.iter().enumerate() {
        let bits = key(*position);
        let mut slot = hash(bits) as usize & (size - 1);
        let id = loop {
            steps_left = steps_left.checked_sub(1)?;
            let found = table[slot];
            if found == EMPTY {
                table[slot] = row as u32;
                break row as u32;
            }
            if key(positions[found as usize]) == bits {
                break found;
            }
            slot = (slot + 1) & (size - 1);
        };
        ids.push(id);
    }
    Some(ids)
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

/// By sorting the rows: the way that no input can slow down.
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

    #[test]
    fn both_ways_find_the_first_equal_row() {
        let mut state = 7_u64;
        let mut coordinate = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            [-1.0, -0.0, 0.0, 1.0, 1e-300, 3.5][(state >> 33) as usize % 6]
        };
        let rows: Vec<[f64; 3]> = (0..2000).map(|_| [coordinate(), coordinate(), coordinate()]).collect();
        let naive: Vec<u32> =
            rows.iter().map(|row| rows.iter().position(|other| other == row).unwrap() as u32).collect();
        assert_eq!(hashed(&rows).unwrap(), naive);
        assert_eq!(sorted(&rows), naive);
        assert_eq!(position_id_by_bits(&[]), [0_u32; 0]);
    }

    #[test]
    fn rows_chosen_to_collide_fall_back_to_sorting() {
        // Rows whose hashes agree in the bits that pick the slot: found by trying, as an attacker would.
        let n = 3000;
        let mask = (2 * n as u64).next_power_of_two() - 1;
        let rows: Vec<[f64; 3]> = (0_u32..)
            .map(|i| [f64::from(i), 0.0, 0.0])
            .filter(|row| hash(key(*row)) & mask < 2)
            .take(n)
            .collect();
        assert!(hashed(&rows).is_none());
        assert_eq!(position_id_by_bits(&rows), (0..n as u32).collect::<Vec<_>>());
    }
}
