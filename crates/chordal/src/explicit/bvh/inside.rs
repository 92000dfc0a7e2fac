//! `Enclosure`: point location in a mesh, closed, open or broken, with its certainty.
use super::lids::Lids;
use super::winding::{ClusterMoments, WindingNumber, leaf_rows, moments};
use super::{Bvh, LEAF, NONE, STACK, WIDTH, each};
use crate::budget::Job;
use crate::explicit::{Mesh, Topology, Twin, Twins};
use crate::math::{Orientation, PointInTriangle, orient2d, orient3d, triangle_contains};
use std::borrow::Cow;

/// The location of a point relative to a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PointLocation {
    /// The mesh winds around the point, with outward faces counter-clockwise.
    Inside,
    /// The mesh does not wind around the point.
    Outside,
    /// On a triangle, exactly.
    On,
    /// The mesh is open, and covers between a quarter and three quarters of the directions from the point.
    Ambiguous,
}

/// A location, and the winding number that decides it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Containment {
    /// The location.
    pub side: PointLocation,
    /// An exact integer for closed meshes; NaN on the surface, where it is undefined.
    pub winding: WindingNumber,
}

/// A mesh prepared for point location.
///
/// *Closed* means that at every edge, by position, there are equally many half-edges in both directions. Then
/// the winding number is an integer, constant in each cell of space, whatever other defects the mesh has
/// (self-intersections, doubled walls, more than two triangles at an edge). It is counted along a vertical
/// ray by exact predicates, with a symbolic perturbation if the ray meets an edge or a corner. So for closed
/// meshes every answer is exact (except for coordinates so much smaller than the mesh that scaling by a power
/// of two makes them subnormal). For all other meshes the generalized winding number decides.
///
/// The winding number depends on the orientation of triangles. A closed mesh that is inside out winds −1
/// times around the points it encloses, which is [`PointLocation::Outside`]. Two walls around a point, both
/// outward, give 2, which is [`PointLocation::Inside`].
///
/// Cost: 120 bytes for each of four children of each node, about 80 bytes per triangle; O(n) time.
///
/// ```
/// use chordal::{Job, Mesh};
/// use chordal::explicit::query::{Bvh, Enclosure, PointLocation};
/// let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let mesh = Mesh::new(corners.clone(), faces.clone()).unwrap();
/// let bvh = Bvh::build(&mesh, &Job::default())?;
/// let enclosure = Enclosure::new(&mesh, &bvh);
/// assert_eq!(enclosure.inside([0.1, 0.1, 0.1]).side, PointLocation::Inside);
/// assert_eq!(enclosure.inside([0.0, 0.25, 0.25]).side, PointLocation::On);
///
/// // Without its floor it hides less than all.
/// let open = Mesh::new(corners, faces[1..].to_vec()).unwrap();
/// let bvh = Bvh::build(&open, &Job::default())?;
/// let found = Enclosure::new(&open, &bvh).inside([0.2, 0.2, 0.5]);
/// assert_eq!(found.side, PointLocation::Inside);
/// assert!(found.winding.value > 0.8 && found.winding.value < 1.0);
/// # Ok::<(), chordal::budget::JobError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Enclosure<'a> {
    bvh: &'a Bvh,
    moments: Cow<'a, WindingMoments>,
}

/// The data of an [`Enclosure`] besides the tree, for callers that keep both.
#[derive(Clone, Debug)]
pub(crate) struct WindingMoments {
    moments: Vec<[ClusterMoments; WIDTH]>,
    is_closed: bool,
    /// Triangles that close the mesh, if few are needed.
    lids: Option<Lids>,
}

impl WindingMoments {
    /// The moments of the tree over `mesh`, as in [`Enclosure::new`].
    pub(crate) fn new(mesh: &Mesh, bvh: &Bvh) -> Self {
        let is_closed = is_closed(mesh);
        let lids = if is_closed { None } else { Lids::new(mesh) };
        Self { moments: moments(bvh), is_closed, lids }
    }

    /// The enclosure; `bvh` is the tree from which the moments were built.
    pub(crate) fn enclosure<'a>(&'a self, bvh: &'a Bvh) -> Enclosure<'a> {
        Enclosure { bvh, moments: Cow::Borrowed(self) }
    }
}

/// The largest error with which a winding number decides a location. Derived: it separates a half from a
/// quarter.
const DECIDES: f64 = 1.0 / 16.0;

impl<'a> Enclosure<'a> {
    /// The moments of the tree over `mesh`, and whether it is closed. Time O(n).
    #[must_use]
    pub fn new(mesh: &Mesh, bvh: &'a Bvh) -> Self {
        Self { bvh, moments: Cow::Owned(WindingMoments::new(mesh, bvh)) }
    }

    /// Whether there are equally many half-edges in both directions at every edge, so that every answer is
    /// exact.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.moments.is_closed
    }

    /// The winding number of the mesh around `p`, with an error of at most `within`; more only if rounding
    /// alone exceeds it, for example within some roundings of an edge. `None` without faces, and when `p` is
    /// not finite.
    ///
    /// Far clusters are summed by two moments each, with a bound for the remainder; clusters are opened until
    /// the bound is below `within`. Time: about 30 µs for 1/16 on a million triangles, 250 for 1/100; in the
    /// limit it is that of [`Bvh::winding_number_plain`]. If a mesh has at least four triangles for each open
    /// edge, lids close it virtually, and their winding number is subtracted from that of the closed mesh, an
    /// integer: then the time is that of a closed mesh plus that for the lids.
    #[must_use]
    pub fn winding_number(&self, p: [f64; 3], within: f64) -> Option<WindingNumber> {
        let q = self.bvh.scaled_query(p)?;
        let with_lids = self.moments.lids.as_ref().and_then(|lids| {
            let above = self.bvh.winding_above(q)?;
            lids.winding_of_mesh(p, above, within)
        });
        Some(with_lids.unwrap_or_else(|| self.bvh.winding_by(&self.moments.moments, q, within)))
    }

    /// The location of `p`; outside without faces, and when `p` is not finite.
    ///
    /// Exact for closed meshes, usually in O(√n) time: one vertical ray, 1 to 3 µs on a million triangles.
    /// For open meshes a winding number above 3/4 is inside, one below 1/4 outside, and the range between is
    /// ambiguous.
    #[must_use]
    pub fn inside(&self, p: [f64; 3]) -> Containment {
        let nowhere = Containment {
            side: PointLocation::Outside,
            winding: WindingNumber { value: 0.0, off_at_most: 0.0 },
        };
        let Some(q) = self.bvh.scaled_query(p) else { return nowhere };
        let Some(number) = self.bvh.winding_above(q) else {
            let winding = WindingNumber { value: f64::NAN, off_at_most: f64::NAN };
            return Containment { side: PointLocation::On, winding };
        };
        if self.moments.is_closed {
            let side = if number > 0 { PointLocation::Inside } else { PointLocation::Outside };
            return Containment {
                side,
                winding: WindingNumber { value: f64::from(number), off_at_most: 0.0 },
            };
        }
        let with_lids = self.moments.lids.as_ref().and_then(|lids| lids.winding_of_mesh(p, number, DECIDES));
        let winding = with_lids.unwrap_or_else(|| self.bvh.winding_by(&self.moments.moments, q, DECIDES));
        let WindingNumber { value, off_at_most: error } = winding;
        let side = if value - error > 0.75 {
            PointLocation::Inside
        } else if value + error < 0.25 {
            PointLocation::Outside
        } else {
            PointLocation::Ambiguous
        };
        Containment { side, winding }
    }

    /// [`Enclosure::inside`] for many points, in order, on the threads of `job`. The answers are the same.
    #[must_use]
    pub fn inside_all(&self, points: &[[f64; 3]], job: &Job) -> Vec<Containment> {
        each(points, job, |p| Some(self.inside(*p))).into_iter().flatten().collect()
    }
}

/// Whether there are equally many half-edges in both directions at every edge, by position.
pub(crate) fn is_closed(mesh: &Mesh) -> bool {
    let Some(ids) = Topology::Positions.ids(mesh) else { return false };
    let twins = Twins::with_ids(mesh, Some(&ids));
    let start = |half_edge: u32| ids[mesh.faces()[half_edge as usize / 3][half_edge as usize % 3] as usize];
    let is_balanced = |edge: &[u32]| {
        let forwards = edge.iter().filter(|half_edge| start(**half_edge) == start(edge[0])).count();
        2 * forwards == edge.len()
    };
    let pairs = (0..twins.len() as u32)
        .all(|half_edge| !matches!(twins.get(half_edge), Twin::Boundary | Twin::Flipped(_)));
    pairs && twins.non_manifold_edges().all(is_balanced)
}

impl Bvh {
    /// The winding number around `q` by the triangles above it: those met from behind count 1, from the front
    /// −1. `None` if `q` is on one. Scaled coordinates.
    pub(super) fn winding_above(&self, q: [f64; 3]) -> Option<i32> {
        let [low, high] = self.frame.local(q);
        let mut stack = [0_u32; STACK];
        let mut height = 1;
        let mut winding = 0;
        while height > 0 {
            height -= 1;
            let node = &self.nodes[stack[height] as usize];
            for lane in 0..WIDTH {
                let child = node.child[lane];
                // Boxes are f32, rounded outward, so a box may be opened for nothing but is never
                // missed. The ray goes up: what ends below the point is not on it.
                let end = |k: usize, end: usize| f64::from(node.bounds[k][end][lane]);
                let is_over = (0..2).all(|k| end(k, 0) <= high[k] && end(k, 1) >= low[k]);
                if child == NONE || !is_over || end(2, 1) < low[2] {
                    continue;
                }
                if child & LEAF == 0 {
                    stack[height] = child;
                    height += 1;
                    continue;
                }
                for row in leaf_rows(self, child) {
                    let corners = self.corners_of(&self.triangles[row as usize]);
                    winding += ray_crossing(corners, q)?;
                }
            }
        }
        Some(winding)
    }
}

/// 1 if the vertical ray from `q` leaves through the triangle's front, −1 if it enters, 0 if it misses;
/// `None` if `q` is on it.
fn ray_crossing(corners: [[f64; 3]; 3], q: [f64; 3]) -> Option<i32> {
    let [a, b, c] = corners;
    let spans = |k: usize| {
        let (low, high) =
            (a[k] <= q[k] || b[k] <= q[k] || c[k] <= q[k], a[k] >= q[k] || b[k] >= q[k] || c[k] >= q[k]);
        [low, high]
    };
    if spans(0) != [true; 2] || spans(1) != [true; 2] || !spans(2)[1] {
        return Some(0);
    }
    // Tested before the projection: a point on a vertical triangle is on it as well.
    if spans(2)[0] && is_on(corners, q) {
        return None;
    }
    let flat = |p: [f64; 3]| [p[0], p[1]];
    // A vertical triangle is met by no perturbed ray.
    let facing = orient2d(flat(a), flat(b), flat(c));
    if facing == Orientation::Flat {
        return Some(0);
    }
    // The ray is perturbed by ε along x and ε² along y, so that it meets no edge.
    let side = |from: [f64; 3], to: [f64; 3]| match orient2d(flat(from), flat(to), flat(q)) {
        Orientation::Flat if from[1] != to[1] => {
            if to[1] < from[1] {
                Orientation::Front
            } else {
                Orientation::Back
            }
        }
        Orientation::Flat if to[0] > from[0] => Orientation::Front,
        Orientation::Flat => Orientation::Back,
        side => side,
    };
    if side(a, b) != facing || side(b, c) != facing || side(c, a) != facing {
        return Some(0);
    }
    // If the triangle faces up, `q` is behind it when the triangle is above.
    let is_above = orient3d(a, b, c, q) == facing.flipped();
    Some(match (is_above, facing) {
        (false, _) => 0,
        (true, Orientation::Front) => 1,
        (true, _) => -1,
    })
}

/// Whether `q` is on the triangle, exactly: in its plane, and within its projections onto all three
/// coordinate planes.
fn is_on(corners: [[f64; 3]; 3], q: [f64; 3]) -> bool {
    let [a, b, c] = corners;
    orient3d(a, b, c, q) == Orientation::Flat
        && (0..3).all(|k| {
            let flat = |p: [f64; 3]| [p[(k + 1) % 3], p[(k + 2) % 3]];
            triangle_contains(corners.map(flat), flat(q)) != PointInTriangle::Outside
        })
}
