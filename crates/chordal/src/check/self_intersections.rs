//! Self-intersections: pairs of faces that intersect outside their common corners and edges.
use super::finding::{Finding, MAX_WITNESSES, MeshLocation, Witness, centre};
use super::thin::has_no_area;
use super::triangle_intersection::{common_point, intersect_by_corner};
use crate::budget::{Job, JobError, over_chunks};
use crate::explicit::{Mesh, PackedBoxes, position_id_by_bits};

/// Finds the pairs of faces that share a point which is not on a common corner or edge. These are faces that
/// cross, faces that overlap in one plane, neighbours folded onto each other, and faces that only touch: a
/// corner of one on the other, or edges that cross. Faces with the same three corners do not count, see
/// [`super::Validity::duplicate_faces`], nor do faces without area, see [`super::Validity::zero_area_faces`].
/// Corners are the same if their coordinates are equal (`−0.0` equals `0.0`), for any indices.
///
/// Exact for all finite coordinates, and the same on any number of threads. The witnesses are the first pairs
/// in the order of the faces, each with a rounded common point.
///
/// About 0.5 µs a triangle on one core for valid surfaces; 88 bytes a triangle and 32 a position. In the worst case, where
/// all boxes overlap, quadratic in the number of faces.
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
/// [`JobError::Refused`] if the boxes of the triangles would be too large for the job, and
/// [`JobError::Cancelled`] if the job was cancelled.
pub fn self_intersections(mesh: &Mesh, job: &Job) -> Result<Finding, JobError> {
    search(mesh, job, |soup, slots| soup.intersect(slots))
}

/// Finds the pairs of faces of different groups that share a point which is not on a common corner or edge:
/// solids that cross or touch each other, if each is a group. Differs from [`self_intersections`] in two
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
/// As for [`self_intersections`].
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

/// The intersecting pairs among those whose boxes overlap and that `counts` accepts.
fn search(
    mesh: &Mesh,
    job: &Job,
    counts: impl Fn(&PackedTriangles, [u32; 2]) -> bool + Sync,
) -> Result<Finding, JobError> {
    let boxes = PackedBoxes::new(mesh, job)?;
    let soup = job.run(|| PackedTriangles::new(mesh, &boxes));
    let parts = boxes.pairs(job, |pairs: &mut IntersectingPairs, slots| {
        if counts(&soup, slots) {
            pairs.add(slots.map(|slot| soup.slots[slot as usize].face));
        }
    });
    let pairs = parts
        .ok_or(JobError::Cancelled)?
        .into_iter()
        .fold(IntersectingPairs::default(), IntersectingPairs::merged);
    let witnesses = pairs.first.iter().map(|faces| soup.witness(*faces)).collect();
    Ok(Finding { count: pairs.count, witnesses })
}

/// The triangles in the order of their boxes, with their exact coordinates.
struct PackedTriangles<'a> {
    mesh: &'a Mesh,
    slots: Vec<PackedTriangle>,
    /// The points of the corners, in the order in which slots first use them.
    points: Vec<[f64; 3]>,
}

struct PackedTriangle {
    /// Rows of `points`, equal for equal coordinates.
    rows: [u32; 3],
    face: u32,
    has_area: bool,
}

impl<'a> PackedTriangles<'a> {
    fn new(mesh: &'a Mesh, boxes: &PackedBoxes) -> Self {
        let ids = position_id_by_bits(mesh.positions());
        let mut slots = over_chunks(boxes.faces(), 4096, |_, faces| {
            let slot = |&face: &u32| PackedTriangle {
                rows: mesh.faces()[face as usize].map(|row| ids[row as usize]),
                face,
                has_area: !has_no_area(mesh.corners(face as usize)),
            };
            faces.iter().map(slot).collect::<Vec<_>>()
        })
        .into_iter()
        .flatten()
        .collect::<Vec<_>>();
        // Points are renumbered in the order of the tree's triangles: neighbours in space become
        // neighbours in memory.
        let mut row_of = vec![u32::MAX; ids.len()];
        let mut points = Vec::with_capacity(ids.len());
        for row in slots.iter_mut().flat_map(|slot| &mut slot.rows) {
            let point_row = &mut row_of[*row as usize];
            if *point_row == u32::MAX {
                *point_row = points.len() as u32;
                points.push(mesh.positions()[*row as usize]);
            }
            *row = *point_row;
        }
        Self { mesh, slots, points }
    }

    #[inline]
    fn intersect(&self, [a, b]: [u32; 2]) -> bool {
        let (a, b) = (&self.slots[a as usize], &self.slots[b as usize]);
        let at = |triangle: usize, corner: usize| self.points[[a, b][triangle].rows[corner] as usize];
        a.has_area && b.has_area && intersect_by_corner([a.rows, b.rows], at)
    }

    /// Whether both triangles have area and the same three corners.
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

/// The number of pairs, and the first ones in the order of the faces.
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
        let position = self.first.partition_point(|known| *known < pair);
        self.first.insert(position, pair);
        self.first.truncate(MAX_WITNESSES);
    }

    fn merged(mut self, other: Self) -> Self {
        self.count += other.count;
        other.first.into_iter().for_each(|pair| self.keep(pair));
        self
    }
}
