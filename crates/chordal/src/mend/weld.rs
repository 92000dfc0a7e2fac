//! `weld`: makes vertices at equal or close coordinates one position.
use super::mend_builder::check_limits;
use super::mended_mesh::{MendedMesh, refusal};
use crate::Mesh;
use crate::budget::{Job, JobError, RefusalCode, Tolerance, par_map_owned};
use crate::check::{Finding, PointTree, Witness};
use crate::explicit::{Attribute, Domain, position_id_by_bits};
use crate::math::Box3;

/// Which vertices are welded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weld {
    /// Vertices with the same coordinates, where `−0.0` equals `0.0`.
    Exact,
    /// Vertices no farther than this from the vertex to which they are moved.
    Within(Tolerance),
}

/// Makes vertices at equal or close coordinates one position: one row if their vertex attributes agree bit
/// for bit as well, and otherwise rows tied by [`Mesh::position_id`], so that a seam in the attributes is
/// kept.
///
/// **Within a tolerance**, some positions are *centres* and stay; every other one is moved to its nearest
/// centre. Positions are processed in the order of their coordinates (x, then y, then z), and one becomes a
/// centre if no centre lies within the tolerance. So the result does not depend on the order of the rows,
/// nothing moves farther than the tolerance, and afterwards no two positions are within it.
///
/// Faces are kept, even if they collapse to a segment or a point;
/// [`drop_degenerate`](super::drop_degenerate) drops them.
///
/// **Bound.** 0 when exact; otherwise the longest move, rounded up: points between corners move in proportion
/// to the corners. The changes are `welded_vertices`, rows that share the position of an earlier one and did
/// not before; `merged_rows`, rows that became one with an earlier one; and `collapsed_faces`.
///
/// Linear when exact: 3,000,000 rows of 1,000,000 triangles in about 0.1 s on one core. O(n log n) within a
/// tolerance.
///
/// # Errors
/// [`JobError`] if the job is cancelled or its memory limit is too low.
///
/// ```
/// use chordal::{Job, Mesh, Tolerance, mend::{Weld, weld}};
/// let rows = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.01]];
/// let soup = Mesh::new(rows, vec![[0, 1, 2], [3, 4, 5]])?;
/// let exact = weld(&soup, Weld::Exact, &Job::default())?;
/// assert_eq!((exact.mesh.faces(), exact.bound.at_most()), (&[[0, 1, 2], [1, 3, 4]][..], Some(0.0)));
/// let close = weld(&soup, Weld::Within(Tolerance::new(0.02)?), &Job::default())?;
/// assert_eq!(close.mesh.faces(), [[0, 1, 2], [1, 3, 2]]);
/// assert!(close.bound.at_most().is_some_and(|moved| (0.01..0.0101).contains(&moved)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn weld(mesh: &Mesh, how: Weld, job: &Job) -> Result<MendedMesh, JobError> {
    check_limits(mesh, job)?;
    let exact = job.run(|| position_id_by_bits(mesh.positions()));
    if how == Weld::Exact && mesh.attributes().is_empty() && mesh.position_id().is_none() {
        return job.run(|| weld_positions(mesh, exact));
    }
    weld_rows(mesh, exact, how, job)
}

/// [`Weld::Exact`] for a mesh of positions and faces alone: the first row at each position stays, and all
/// others are dropped. The same as [`weld_rows`] in a third of its passes.
fn weld_positions(mesh: &Mesh, mut ids: Vec<u32>) -> Result<MendedMesh, JobError> {
    // 1. New numbers for the kept rows, in place: the first row of a position gets its number before others
    //    ask for it.
    let n_positions = ids.iter().enumerate().filter(|(row, first)| *row == **first as usize).count();
    let mut positions = Vec::with_capacity(n_positions);
    let mut welded = Finding::default();
    for row in 0..ids.len() {
        let first = ids[row] as usize;
        ids[row] = if first < row {
            welded.add(|| Witness::vertex(mesh, row as u32));
            ids[first]
        } else {
            positions.push(mesh.positions()[row]);
            positions.len() as u32 - 1
        };
    }
    if welded.is_none() {
        return Ok(MendedMesh::unchanged(mesh));
    }
    // 2. The faces, and which of them collapse: equal numbers are equal positions.
    let mut faces = vec![[0; 3]; mesh.faces().len()];
    let chunks = faces.chunks_mut(FACES).enumerate().collect();
    let parts = par_map_owned(&Job::default(), chunks, |(number, chunk): (usize, &mut [[u32; 3]])| {
        let mut collapsed_here = Finding::default();
        for (face, named) in (number * FACES..).zip(chunk) {
            let rows = mesh.faces()[face];
            *named = rows.map(|row| ids[row as usize]);
            if !is_proper(*named) && is_proper(rows) {
                collapsed_here.add(|| Witness::face(mesh, face as u32));
            }
        }
        collapsed_here
    });
    let mut collapsed = Finding::default();
    parts.into_iter().for_each(|part| collapsed.append(part));
    let renamed = Mesh::by_construction(positions, faces);
    let merged = welded.clone();
    let changes = [("welded_vertices", welded), ("merged_rows", merged), ("collapsed_faces", collapsed)];
    MendedMesh::moved(renamed, changes, 0.0)
}

/// Faces that are renumbered in one task; the result does not depend on it.
const FACES: usize = 1 << 14;

/// Both ways of welding, for any mesh, given the ids of rows that are equal bit for bit.
fn weld_rows(mesh: &Mesh, exact: Vec<u32>, how: Weld, job: &Job) -> Result<MendedMesh, JobError> {
    let (ids, moved) = match how {
        Weld::Exact => (exact, LongestMove { most: 0.0, at: None }),
        Weld::Within(tolerance) => nearest_centres(mesh.positions(), exact, tolerance, job)?,
    };
    // A centre may come after the rows that are moved to it; from here on, the first row represents a
    // position.
    let firsts = match how {
        Weld::Exact => None,
        Weld::Within(_) => Some(first_rows(&ids)),
    };
    let first_of = firsts.as_deref().unwrap_or(&ids);
    let mut welded = Finding::default();
    for (row, &first) in (0..).zip(first_of) {
        if first != row && mesh.position_of(row) != mesh.position_of(first) {
            welded.add(|| Witness::vertex(mesh, row));
        }
    }
    let collapsed = collapsed_faces(mesh, &ids);
    let first_equal = first_with_attributes(mesh, first_of);
    let first_of_look = first_equal.as_deref().unwrap_or(first_of);
    let mut merged = Finding::default();
    for (row, _) in (0..).zip(first_of_look).filter(|(row, first)| row != *first) {
        merged.add(|| Witness::vertex(mesh, row));
    }
    if welded.is_none() && merged.is_none() {
        return Ok(MendedMesh::unchanged(mesh));
    }
    let rebuilt = rebuild(mesh, &ids, [first_of, first_of_look])?;
    let changes = [("welded_vertices", welded), ("merged_rows", merged), ("collapsed_faces", collapsed)];
    let mut mended = MendedMesh::moved(rebuilt, changes, moved.most)?;
    mended.bound.at = moved.at;
    Ok(mended)
}

/// The longest move, rounded up, and its start.
struct LongestMove {
    most: f64,
    at: Option<[f64; 3]>,
}

/// For every row the row of its nearest centre.
fn nearest_centres(
    positions: &[[f64; 3]],
    exact: Vec<u32>,
    tolerance: Tolerance,
    job: &Job,
) -> Result<(Vec<u32>, LongestMove), JobError> {
    let firsts: Vec<u32> = (0..).zip(&exact).filter(|(row, id)| row == *id).map(|(row, _)| row).collect();
    let points: Vec<[f64; 3]> = firsts.iter().map(|&row| positions[row as usize].map(|x| x + 0.0)).collect();
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    // All keys are different, and −0 has become 0, so the order is unique.
    order.sort_unstable_by(|&a, &b| {
        let [a, b] = [a, b].map(|i| points[i as usize]);
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]))
    });
    let tree = PointTree::new(&points);
    let mut centre: Vec<Option<(f64, u32)>> = vec![None; points.len()];
    for (n, &i) in order.iter().enumerate() {
        if n % 4096 == 0 && job.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        // A row near an earlier centre becomes no centre itself. If it did, chains of close rows
        // would move farther than the tolerance, link by link.
        if centre[i as usize].is_some() {
            continue;
        }
        let p = points[i as usize];
        tree.near_segment([p; 2], tolerance.get(), |j| {
            let distance = distance_up(p, points[j as usize]);
            let nearest = &mut centre[j as usize];
            // Of two equally near centres the first in the order of coordinates stays.
            if distance <= tolerance.get() && nearest.is_none_or(|(best, _)| distance < best) {
                *nearest = Some((distance, i));
            }
        });
        centre[i as usize] = Some((0.0, i));
    }
    let mut moved = LongestMove { most: 0.0, at: None };
    let mut id_of = vec![0; positions.len()];
    for (i, nearest) in centre.iter().enumerate() {
        let (distance, centre) = nearest.unwrap_or((0.0, i as u32));
        if distance > moved.most {
            moved = LongestMove { most: distance, at: Some(points[i]) };
        }
        id_of[firsts[i] as usize] = firsts[centre as usize];
    }
    Ok((exact.iter().map(|&first| id_of[first as usize]).collect(), moved))
}

/// The distance of two points, bounded from above; 0 for equal points.
pub(super) fn distance_up(a: [f64; 3], b: [f64; 3]) -> f64 {
    if a == b {
        return 0.0;
    }
    Box3::from_points([&a, &b]).diagonal()
}

/// Whether all three rows differ.
fn is_proper([a, b, c]: [u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// Faces with two corners at one position that had three positions before.
fn collapsed_faces(mesh: &Mesh, ids: &[u32]) -> Finding {
    let mut collapsed = Finding::default();
    for (face, rows) in (0..).zip(mesh.faces()) {
        if !is_proper(rows.map(|row| ids[row as usize])) && is_proper(rows.map(|row| mesh.position_of(row))) {
            collapsed.add(|| Witness::face(mesh, face));
        }
    }
    collapsed
}

/// For every row: the first row with the same id.
fn first_rows(ids: &[u32]) -> Vec<u32> {
    let mut first = vec![u32::MAX; ids.len()];
    let mut first_of = |(row, &id): (u32, &u32)| {
        let first_row = &mut first[id as usize];
        *first_row = if *first_row == u32::MAX { row } else { *first_row };
        *first_row
    };
    (0..).zip(ids).map(&mut first_of).collect()
}

/// For every row: the first row at its position with the same vertex attributes; `None` if there are none.
fn first_with_attributes(mesh: &Mesh, first_of: &[u32]) -> Option<Vec<u32>> {
    let streams: Vec<&Attribute> =
        mesh.attributes().iter().filter(|attribute| attribute.domain == Domain::Vertex).collect();
    (!streams.is_empty()).then(|| same_rows(first_of, &streams))
}

/// The mesh with one row for each distinct pair of position and attributes, in the order of first occurrence.
/// A row's coordinates are those of its row in `ids`.
fn rebuild(mesh: &Mesh, ids: &[u32], [first_of, first_of_look]: [&[u32]; 2]) -> Result<Mesh, JobError> {
    // 1. New numbers for the kept rows.
    let mut number = Vec::with_capacity(ids.len());
    let mut kept_rows: Vec<u32> = Vec::new();
    let has_looks = mesh.attributes().iter().any(|attribute| attribute.domain == Domain::Vertex);
    let mut position_id = Vec::new();
    for row in 0..ids.len() {
        let first = first_of_look[row] as usize;
        if first < row {
            number.push(number[first]);
            continue;
        }
        number.push(kept_rows.len() as u32);
        if has_looks {
            // The first row of a position is also the first with its attributes, so it has its number
            // already.
            position_id.push(number[first_of[row] as usize]);
        }
        kept_rows.push(row as u32);
    }
    // 2. The arrays.
    let positions = kept_rows.iter().map(|&row| mesh.positions()[ids[row as usize] as usize]).collect();
    let faces = mesh.faces().iter().map(|face| face.map(|row| number[row as usize])).collect();
    let mut result = Mesh::new(positions, faces);
    if (0..).zip(&position_id).any(|(row, &id)| row != id) {
        result = result.and_then(|mesh| mesh.with_position_id(position_id));
    }
    for attribute in mesh.attributes() {
        let values = match attribute.domain {
            Domain::Vertex => {
                kept_rows.iter().flat_map(|&row| attribute.row(row as usize)).copied().collect()
            }
            Domain::Corner | Domain::Face => attribute.values.clone(),
        };
        result = result.and_then(|mesh| mesh.with_attribute(Attribute { values, ..attribute.clone() }));
    }
    // There are fewer rows than before, and all of them are valid, so only memory can fail.
    result.map_err(|error| refusal(RefusalCode::TooMuchMemory, error.to_string()))
}

/// For every row: the first row with the same id and, bit for bit, the same attributes.
fn same_rows(ids: &[u32], streams: &[&Attribute]) -> Vec<u32> {
    // Bits and not values: NaN equals itself, and −0 stays apart from 0.
    let bits = |row: u32| streams.iter().flat_map(move |s| s.row(row as usize)).map(|x| x.to_bits());
    let mut rows: Vec<u32> = (0..ids.len() as u32).collect();
    rows.sort_unstable_by(|&a, &b| {
        ids[a as usize].cmp(&ids[b as usize]).then_with(|| bits(a).cmp(bits(b))).then(a.cmp(&b))
    });
    let mut same = vec![0; rows.len()];
    for group in rows.chunk_by(|&a, &b| ids[a as usize] == ids[b as usize] && bits(a).eq(bits(b))) {
        group.iter().for_each(|&row| same[row as usize] = group[0]);
    }
    same
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    #[test]
    fn positions_alone_are_welded_as_rows_are() {
        let mut random = Random::new(21);
        for round in 0..300 {
            let n_rows = 1 + random.below([3, 12, 40_000][round % 3]);
            let side = [1, 2, 30][random.below(3)];
            let mut coordinate = || [0.0, -0.0, 1.0, 2.5][random.below(4)] * (1 + random.below(side)) as f64;
            let positions = (0..n_rows).map(|_| [coordinate(), coordinate(), coordinate()]).collect();
            let n_faces = random.below(if round % 50 == 2 { 40_000 } else { 30 });
            let faces = (0..n_faces).map(|_| std::array::from_fn(|_| random.below(n_rows) as u32)).collect();
            let mesh = Mesh::new(positions, faces).expect("finite");
            let exact = position_id_by_bits(mesh.positions());
            let plain = weld_rows(&mesh, exact.clone(), Weld::Exact, &Job::default()).expect("small");
            assert_eq!(weld_positions(&mesh, exact).expect("small"), plain, "round {round}");
        }
    }
}
