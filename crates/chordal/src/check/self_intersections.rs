//! Self-intersections: pairs of faces that meet where they should not.
use super::finding::{Finding, MAX_WITNESSES, Place, Witness, centre};
use super::flat::has_zero_area;
use super::meeting::{common_point, meet};
use super::parallel::over_chunks;
use crate::budget::{Job, Stopped};
use crate::explicit::{Bvh, Mesh, position_id_by_bits};

/// The pairs of faces that share a point which is not on a corner or an edge of both. So counted are faces that cross,
/// faces that overlap in one plane, neighbours that are folded onto each other, and faces that only touch: a corner of
/// one on the other, or edges that cross. Not counted are faces with the same three corners, which
/// [`super::Validity::duplicate_faces`] has, and faces without area, which are
/// [`super::Validity::zero_area_faces`]. Corners are the same where their coordinates are, whatever the indices say
/// (`−0.0` and `0.0` taken as equal).
///
/// Exact for all finite coordinates, and the same on any number of threads. The witnesses are the first pairs in the
/// order of the faces, each with a rounded point that both have.
///
/// About 1 µs a triangle on one core for surfaces that are what they should be, the tree of boxes included, which also
/// says what memory it takes; beside it 28 bytes a position and 36 a face. In the worst case, where all boxes meet, the
/// square of the number of faces.
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
/// [`Stopped::Refused`] where the tree of boxes would be too large for the job ([`Bvh::build`]), and
/// [`Stopped::Cancelled`] when the job was.
pub fn self_intersections(mesh: &Mesh, job: &Job) -> Result<Finding, Stopped> {
    search(mesh, job, |soup, slots| soup.meet(slots))
}

/// The pairs of faces of different groups that share a point which is not on a corner or an edge of both: solids that
/// cross or touch each other, where each is a group. As [`self_intersections`], but for pairs of one group, which are
/// not looked at, and for pairs with the same three corners, which count: nothing else tells of them where each group
/// is looked at alone.
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
) -> Result<Finding, Stopped> {
    search(mesh, job, |soup, slots| {
        let [a, b] = slots.map(|slot| group_of(soup.slots[slot as usize].face));
        a != b && (soup.same(slots) || soup.meet(slots))
    })
}

/// The pairs whose boxes meet and of which `counts` holds.
fn search(
    mesh: &Mesh,
    job: &Job,
    counts: impl Fn(&Soup, [u32; 2]) -> bool + Sync,
) -> Result<Finding, Stopped> {
    let tree = Bvh::build(mesh, job)?;
    let soup = job.run(|| Soup::new(mesh, &tree));
    let parts = tree.pairs(job, |found: &mut Found, slots| {
        if counts(&soup, slots) {
            found.add(slots.map(|slot| soup.slots[slot as usize].face));
        }
    });
    let found = parts.ok_or(Stopped::Cancelled)?.into_iter().fold(Found::default(), Found::merged);
    let witnesses = found.first.iter().map(|faces| soup.witness(*faces)).collect();
    Ok(Finding { count: found.count, witnesses })
}

/// The triangles in the order of the tree's leaves, with their true coordinates.
struct Soup<'a> {
    mesh: &'a Mesh,
    slots: Vec<Slot>,
    points: Vec<[f64; 3]>,
}

struct Slot {
    /// Rows of `points`, equal for equal coordinates.
    rows: [u32; 3],
    face: u32,
    has_area: bool,
}

impl<'a> Soup<'a> {
    fn new(mesh: &'a Mesh, tree: &Bvh) -> Self {
        let mut points = vec![[0.0; 3]; tree.n_corners()];
        for (rows, face) in tree.slots() {
            for (row, corner) in rows.iter().zip(mesh.corners(face as usize)) {
                points[*row as usize] = corner;
            }
        }
        let ids = position_id_by_bits(&points);
        let triangles: Vec<([u32; 3], u32)> = tree.slots().collect();
        let slots = over_chunks(&triangles, 4096, |_, triangles| {
            let slot = |(rows, face): &([u32; 3], u32)| Slot {
                rows: rows.map(|row| ids[row as usize]),
                face: *face,
                has_area: !has_zero_area(mesh.corners(*face as usize)),
            };
            triangles.iter().map(slot).collect::<Vec<_>>()
        });
        Self { mesh, slots: slots.into_iter().flatten().collect(), points }
    }

    #[inline]
    fn meet(&self, [a, b]: [u32; 2]) -> bool {
        let (a, b) = (&self.slots[a as usize], &self.slots[b as usize]);
        let corners =
            |[p, q, r]: [u32; 3]| [self.points[p as usize], self.points[q as usize], self.points[r as usize]];
        a.has_area && b.has_area && meet([a.rows, b.rows], [corners(a.rows), corners(b.rows)])
    }

    /// Whether both have area and the same three corners.
    fn same(&self, [a, b]: [u32; 2]) -> bool {
        let (a, b) = (&self.slots[a as usize], &self.slots[b as usize]);
        a.has_area && b.has_area && a.rows.iter().all(|row| b.rows.contains(row))
    }

    fn witness(&self, faces: [u32; 2]) -> Witness {
        let corners = faces.map(|face| self.mesh.corners(face as usize));
        let ids = position_id_by_bits(corners.as_flattened());
        let ids = [[ids[0], ids[1], ids[2]], [ids[3], ids[4], ids[5]]];
        let at = common_point(ids, corners).unwrap_or_else(|| centre(self.mesh, faces[0]));
        Witness { place: Place::Faces(faces), at }
    }
}

/// How many pairs, and the first in the order of the faces.
#[derive(Default)]
struct Found {
    count: u64,
    /// Ascending.
    first: Vec<[u32; 2]>,
}

impl Found {
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
