//! Self-intersections: pairs of faces that intersect outside their common corners and edges.
use super::degenerate::has_zero_area;
use super::finding::{Finding, MAX_WITNESSES, MeshLocation, Witness, centre};
use super::parallel::over_chunks;
use super::triangle_intersection::{common_point, triangles_intersect};
use crate::budget::{Job, JobError};
use crate::explicit::{Bvh, Mesh, position_id_by_bits};

/// Finds the pairs of faces that share a point which is not on a common corner or edge. These are faces that
/// cross, faces that overlap in one plane, neighbours folded onto each other, and faces that only touch: a
/// corner of one on the other, or edges that cross. Faces with the same three corners do not count, see
/// [`super::Validity::duplicate_faces`], nor do faces without area, see [`super::Validity::zero_area_faces`].
/// Corners are the same where their coordinates are equal (`−0.0` equals `0.0`), whatever the indices are.
///
/// Exact for all finite coordinates, and the same on any number of threads. The witnesses are the first pairs
/// in the order of the faces, each with a rounded common point.
///
/// About 1 µs a triangle on one core for valid surfaces, including the bounding volume hierarchy, whose
/// documentation gives its memory; beyond it 28 bytes a position and 36 a face. In the worst case, where all
/// boxes overlap, quadratic in the number of faces.
///
/// ```
/// use chordal::{Job, Mesh, check::self_intersections};
/// let points = vec![
///     [0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0],
///     [1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [9.0, 9.0, 0.0],
/// ];
/// let mesh = Mesh::new(points, vec![[0, 1, 2], [3, 4, 5]])?;
/// let found = self_intersections(&mesh, &Job::default())?;
/// assert_eq!(found.count, 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`JobError::Refused`] where the hierarchy would be too large for the job ([`Bvh::build`]), and
/// [`JobError::Cancelled`] when the job was.
pub fn self_intersections(mesh: &Mesh, job: &Job) -> Result<Finding, JobError> {
    search(mesh, job, |soup, slots| soup.intersect(slots))
}

/// Finds the pairs of faces of different groups that share a point which is not on a common corner or edge:
/// solids that cross or touch each other, where each is a group. Differs from [`self_intersections`] in two
/// ways: it ignores pairs within one group, and it counts pairs with the same three corners, since checking
/// each group alone would miss them.
///
/// ```
/// use chordal::{Job, Mesh, check::intersections_between};
/// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(points, vec![[0, 1, 2], [0, 1, 2]])?;
/// assert_eq!(intersections_between(&mesh, |face| face, &Job::default())?.count, 1);
/// assert_eq!(intersections_between(&mesh, |_| 0, &Job::default())?.count, 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Those of [`self_intersections`].
pub fn intersections_between(
    mesh: &Mesh,
    group_of: impl Fn(u32) -> u32 + Sync,
    job: &Job,
) -> Result<Finding, JobError> {
    search(mesh, job, |soup, slots| {
        let [a, b] = slots.map(|slot| group_of(soup.slots[slot as usize].face));
        a != b && (soup.are_duplicates(slots) || soup.intersect(slots))
    })
}

/// The pairs whose boxes overlap and that `counts` accepts.
fn search(
    mesh: &Mesh,
    job: &Job,
    counts: impl Fn(&LeafTriangles, [u32; 2]) -> bool + Sync,
) -> Result<Finding, JobError> {
    let tree = Bvh::build(mesh, job)?;
    let soup = job.run(|| LeafTriangles::new(mesh, &tree));
    let parts = tree.pairs(job, |found: &mut IntersectingPairs, slots| {
        if counts(&soup, slots) {
            found.add(slots.map(|slot| soup.slots[slot as usize].face));
        }
    });
    let found = parts
        .ok_or(JobError::Cancelled)?
        .into_iter()
        .fold(IntersectingPairs::default(), IntersectingPairs::merged);
    let witnesses = found.first.iter().map(|faces| soup.witness(*faces)).collect();
    Ok(Finding { count: found.count, witnesses })
}

/// The triangles in the order of the hierarchy's leaves, with their exact coordinates.
struct LeafTriangles<'a> {
    mesh: &'a Mesh,
    slots: Vec<LeafTriangle>,
    points: Vec<[f64; 3]>,
}

struct LeafTriangle {
    /// Rows of `points`, equal for equal coordinates.
    rows: [u32; 3],
    face: u32,
    has_area: bool,
}

impl<'a> LeafTriangles<'a> {
    fn new(mesh: &'a Mesh, tree: &Bvh) -> Self {
        let mut points = vec![[0.0; 3]; tree.n_corners()];
        for (rows, face) in tree.leaf_triangles() {
            for (row, corner) in rows.iter().zip(mesh.corners(face as usize)) {
                points[*row as usize] = corner;
            }
        }
        let ids = position_id_by_bits(&points);
        let triangles: Vec<([u32; 3], u32)> = tree.leaf_triangles().collect();
        let slots = over_chunks(&triangles, 4096, |_, triangles| {
            let slot = |(rows, face): &([u32; 3], u32)| LeafTriangle {
                rows: rows.map(|row| ids[row as usize]),
                face: *face,
                has_area: !has_zero_area(mesh.corners(*face as usize)),
            };
            triangles.iter().map(slot).collect::<Vec<_>>()
        });
        Self { mesh, slots: slots.into_iter().flatten().collect(), points }
    }

    #[inline]
    fn intersect(&self, [a, b]: [u32; 2]) -> bool {
        let (a, b) = (&self.slots[a as usize], &self.slots[b as usize]);
        let corners =
            |[p, q, r]: [u32; 3]| [self.points[p as usize], self.points[q as usize], self.points[r as usize]];
        a.has_area && b.has_area && triangles_intersect([a.rows, b.rows], [corners(a.rows), corners(b.rows)])
    }

    /// Whether both have area and the same three corners.
    fn are_duplicates(&self, [a, b]: [u32; 2]) -> bool {
        let (a, b) = (&self.slots[a as usize], &self.slots[b as usize]);
        a.has_area && b.has_area && a.rows.iter().all(|row| b.rows.contains(row))
    }

    fn witness(&self, faces: [u32; 2]) -> Witness {
        let corners = faces.map(|face| self.mesh.corners(face as usize));
        let ids = position_id_by_bits(corners.as_flattened());
        let ids = [[ids[0], ids[1], ids[2]], [ids[3], ids[4], ids[5]]];
        let at = common_point(ids, corners).unwrap_or_else(|| centre(self.mesh, faces[0]));
        Witness { place: MeshLocation::Faces(faces), at }
    }
}

/// The number of pairs, and the first in the order of the faces.
#[derive(Default)]
struct IntersectingPairs {
    count: u64,
    /// Ascending.
    first: Vec<[u32; 2]>,
}

impl IntersectingPairs {
    fn add(&mut self, [f, g]: [u32; 2]) {
        self.count += 1;
        self.keep(if f < g { [f, g] } else { [g, f] });
    }

    fn keep(&mut self, pair: [u32; 2]) {
        let full = self.first.len() == MAX_WITNESSES;
        if full && self.first.last().is_some_and(|last| *last < pair) {
            return;
        }
        let place = self.first.partition_point(|known| *known < pair);
        self.first.insert(place, pair);
        self.first.truncate(MAX_WITNESSES);
    }

    fn merged(mut self, other: Self) -> Self {
        self.count += other.count;
        other.first.into_iter().for_each(|pair| self.keep(pair));
        self
    }
}
