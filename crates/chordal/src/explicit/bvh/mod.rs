//! `Bvh`: a bounding volume hierarchy over the triangles of a mesh, for closest points and rays.
//!
//! Each ray is traversed separately. Packets of sixteen neighbouring rays, with boxes and edge functions side
//! by side in AVX-512, gave the same answers, but on a million triangles in full view (1024² rays) they took
//! 0.28 µs per ray, while a single ray takes 0.25. Testing the triangle of the previous ray first, and
//! compiling the traversal for AVX2 or AVX-512, made no measurable difference.
mod build;
mod closest;
mod frame;
mod inside;
mod lids;
mod packed_boxes;
mod ray;
mod sah_split;
mod triangle;
mod visit;
mod winding;

use crate::budget::{Job, JobError, Refusal, RefusalCode, par_map_owned};
use crate::explicit::Mesh;
use crate::math::Box3;
use frame::BvhFrame;

pub use closest::MeshClosestPoint;
pub(crate) use inside::WindingMoments;
pub(crate) use inside::is_closed;
pub use inside::{Containment, Enclosure, PointLocation};
pub(crate) use lids::{OpenEdge, open_edges};
pub(crate) use packed_boxes::PackedBoxes;
pub use ray::{Hit, HitSides, Ray};
pub use winding::WindingNumber;

/// The barycentric coordinates of the closest point of a triangle to `q`: ≥ 0, with sum 1 up to rounding.
#[inline]
pub(crate) fn closest_on_triangle(q: [f64; 3], corners: [[f64; 3]; 3]) -> [f64; 3] {
    triangle::closest_point(q, corners).barycentric
}

/// The closest point of a triangle to `q`.
#[inline]
pub(crate) fn nearest_on_triangle(q: [f64; 3], corners: [[f64; 3]; 3]) -> [f64; 3] {
    let [u, v, w] = closest_on_triangle(q, corners);
    std::array::from_fn(|k| u * corners[0][k] + v * corners[1][k] + w * corners[2][k])
}

/// The squared distance from a point to a triangle, up to rounding.
#[inline]
pub(crate) fn distance_sq_to_triangle(q: [f64; 3], corners: [[f64; 3]; 3]) -> f64 {
    triangle::closest_point(q, corners).distance_sq
}

/// A proved lower bound for the distance from a point to a triangle, rounding included, for coordinates whose
/// squares neither overflow nor vanish. If the distance is surely at least `enough`, the bound may be any
/// number of at least `enough`.
#[inline]
pub(crate) fn distance_to_triangle_down(q: [f64; 3], corners: [[f64; 3]; 3], enough: f64) -> f64 {
    // The error of underflow is less than the smallest normal number.
    let down = crate::math::sub_down(triangle::distance_down(q, corners, enough), f64::MIN_POSITIVE);
    crate::math::greater(down, 0.0)
}

/// Children of a node. Four f32 fill one SSE, NEON or WASM register.
const WIDTH: usize = 4;
/// Marks a child that is a leaf, a run of triangles.
const LEAF: u32 = 1 << 31;
/// Marks the last triangle of such a run.
const LAST: u32 = 1 << 31;
/// No child; its box is inverted, so that no query meets it.
const NONE: u32 = u32::MAX;
/// The size of a traversal's stack. Derived: the build stops splitting by cost at [`build::DEEPEST_BY_COST`]
/// and then splits into equal quarters, so no path is longer than 24 + 16 nodes, each of which leaves at most
/// 3 pending.
const STACK: usize = 128;

/// A node of two cache lines: four boxes in local f32 coordinates, rounded outward, and their children.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct BvhNode {
    /// By axis and end (low, high): one number per child.
    bounds: [[[f32; WIDTH]; 2]; 3],
    /// A node, or with [`LEAF`] the first of a run of triangles, or [`NONE`].
    child: [u32; WIDTH],
}

/// One triangle: rows of [`Bvh::corners`], and the face of the mesh, with [`LAST`] at the end of a run.
#[derive(Clone, Copy, Debug)]
struct BvhTriangle {
    corners: [u32; 3],
    face: u32,
}

/// A bounding volume hierarchy over the triangles of a mesh, shared by all queries.
///
/// Nodes have four children with boxes in f32, rounded outward, relative to the mesh's middle and extent, so
/// that neither a far offset nor an unusual scale costs precision. Coordinates stay f64 and queries compute
/// in f64: the answer is the minimum over all triangles of the same arithmetic on each, as in a plain loop.
/// Triangles without area count as segments or points for distances, and are never hit by rays.
///
/// The tree is the same on any number of threads. Cost: O(n log n) time; in memory about 18 bytes per
/// triangle for nodes, 16 for the triangles and 24 for each position; while building, about 90 more per
/// triangle.
///
/// ```
/// use chordal::{Job, Mesh};
/// use chordal::explicit::query::{Bvh, Ray};
/// let mesh = Mesh::new(vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]], vec![[0, 1, 2]]).unwrap();
/// let bvh = Bvh::build(&mesh, &Job::default())?;
/// let closest = bvh.closest_point([0.25, 0.25, 2.0]).unwrap();
/// assert_eq!((closest.point, closest.distance_sq), ([0.25, 0.25, 0.0], 4.0));
/// let hit = bvh.first_hit(&Ray::new([0.25, 0.25, 2.0], [0.0, 0.0, -1.0])).unwrap();
/// assert_eq!((hit.face, hit.t), (0, 2.0));
/// # Ok::<(), chordal::budget::JobError>(())
/// ```
///
/// Sources: I. Wald, *On fast construction of SAH-based bounding volume hierarchies*, 2007; H. Dammertz, J.
/// Hanika, A. Keller, *Shallow bounding volume hierarchies for fast SIMD ray tracing of incoherent
/// rays*, 2008.
#[derive(Clone, Debug)]
pub struct Bvh {
    frame: BvhFrame,
    bounds: Box3,
    /// `bounds` in local coordinates, rounded outward.
    local: Box3,
    /// The nodes, the root first; empty for a mesh without faces.
    nodes: Vec<BvhNode>,
    /// The triangles in the order of the leaves.
    triangles: Vec<BvhTriangle>,
    /// Scaled positions, in the order in which the leaves first use them.
    corners: Vec<[f64; 3]>,
}

impl Bvh {
    /// Builds the tree over all faces of `mesh`.
    ///
    /// # Errors
    /// [`JobError::Refused`] for 2³¹ faces and more, or if about 130 bytes per face and 28 per position
    /// exceed the job's memory limit; [`JobError::Cancelled`] when the job was cancelled.
    pub fn build(mesh: &Mesh, job: &Job) -> Result<Self, JobError> {
        let n = mesh.faces().len();
        let refused = |code, message: String| Err(JobError::Refused(Refusal::new(code, message)));
        if n >= LAST as usize {
            let message = format!("{n} faces are more than the {} that a tree of boxes can name", LAST - 1);
            return refused(RefusalCode::TooManyTriangles, message);
        }
        let bytes = 130 * n as u64 + 28 * mesh.positions().len() as u64;
        if bytes > job.memory_limit {
            let message = format!(
                "the tree over {n} faces needs about {bytes} bytes; the limit is {}",
                job.memory_limit
            );
            return refused(RefusalCode::TooMuchMemory, message);
        }
        build::build(mesh, job).ok_or(JobError::Cancelled)
    }

    /// The box of the triangles (of all positions that faces use); empty without faces.
    #[must_use]
    pub fn bounds(&self) -> Box3 {
        self.bounds
    }

    /// The number of triangles.
    #[must_use]
    pub fn n_triangles(&self) -> usize {
        self.triangles.len()
    }

    /// The bytes of memory that the tree holds.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<BvhNode>()
            + self.triangles.capacity() * size_of::<BvhTriangle>()
            + self.corners.capacity() * size_of::<[f64; 3]>()
    }

    /// The scaled corners of a triangle.
    #[inline]
    fn corners_of(&self, triangle: &BvhTriangle) -> [[f64; 3]; 3] {
        // Written out: `map` is not always inlined, and this is the innermost loop of every query.
        let [a, b, c] = triangle.corners;
        [self.corners[a as usize], self.corners[b as usize], self.corners[c as usize]]
    }
}

/// Queries per task. Chosen: at about a microsecond each, they outweigh the start of a task.
const TASK: usize = 1024;

impl Bvh {
    /// [`Bvh::first_hit`] for many rays, in order, on the threads of `job`. The answers are the same to the
    /// last bit.
    #[must_use]
    pub fn first_hits(&self, rays: &[Ray], job: &Job) -> Vec<Option<Hit>> {
        each(rays, job, |ray| self.first_hit(ray))
    }

    /// [`Bvh::closest_point`] for many points, in order, on the threads of `job`. The answers are the same to
    /// the last bit.
    #[must_use]
    pub fn closest_points(&self, points: &[[f64; 3]], job: &Job) -> Vec<Option<MeshClosestPoint>> {
        each(points, job, |p| self.closest_point(*p))
    }
}

/// The answers to all queries, in order.
fn each<Q: Sync, A: Clone + Default + Send>(
    queries: &[Q],
    job: &Job,
    answer: impl Fn(&Q) -> A + Sync,
) -> Vec<A> {
    let mut answers = vec![A::default(); queries.len()];
    let tasks = queries.chunks(TASK).zip(answers.chunks_mut(TASK)).collect();
    par_map_owned(job, tasks, |(queries, answers): (&[Q], &mut [A])| {
        queries.iter().zip(answers).for_each(|(query, to)| *to = answer(query));
    });
    answers
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{sub_down, sub_up};

    /// Checks the subtree of a child, collects the faces of its leaves and returns its depth.
    fn check(bvh: &Bvh, node: &BvhNode, lane: usize, faces: &mut Vec<u32>) -> usize {
        let child = node.child[lane];
        let mut first = child & !LEAF;
        if child & LEAF == 0 {
            let inner = &bvh.nodes[child as usize];
            let lanes = (0..WIDTH).filter(|k| inner.child[*k] != NONE);
            for k in 0..3 {
                let within = |k: usize, l: usize| {
                    node.bounds[k][0][lane] <= inner.bounds[k][0][l]
                        && node.bounds[k][1][lane] >= inner.bounds[k][1][l]
                };
                assert!(lanes.clone().all(|l| within(k, l)), "a child sticks out of its parent");
            }
            return 1 + lanes.map(|l| check(bvh, inner, l, faces)).max().expect("no node is empty");
        }
        loop {
            let triangle = &bvh.triangles[first as usize];
            for (k, corner) in (0..3).flat_map(|k| bvh.corners_of(triangle).map(|p| (k, p[k]))) {
                let [low, high] = [0, 1].map(|end| f64::from(node.bounds[k][end][lane]));
                let middle = bvh.frame.middle[k];
                assert!(low <= sub_down(corner, middle) && high >= sub_up(corner, middle));
            }
            faces.push(triangle.face & !LAST);
            if triangle.face & LAST != 0 {
                return 1;
            }
            first += 1;
        }
    }

    #[test]
    fn boxes_enclose_what_is_below_them_and_leaves_hold_each_face_once() {
        let heights = |i: u32| libm::sin(f64::from(i * i)) * 1e-3;
        let smooth = (0..40_000).map(|i| [f64::from(i % 200), f64::from(i / 200), heights(i)]);
        // Each vertex is half as far as the previous one, so that the cheapest tree is not balanced.
        let shrinking = (0..900).map(|i| [libm::ldexp(1.0, -i), libm::ldexp(1.5, -i), 0.1]);
        let equal = (0..30_000).map(|i| [7.0, f64::from(i % 3), f64::from(i % 2)]);
        let cases: [Vec<[f64; 3]>; 3] = [smooth.collect(), shrinking.collect(), equal.collect()];
        for positions in cases {
            let n = positions.len() as u32;
            let faces = (0..n - 2).map(|i| [i, i + 1, i + 2]).collect();
            let mesh = Mesh::new(positions, faces).expect("finite");
            let bvh = Bvh::build(&mesh, &Job::default()).expect("small");
            let root = BvhNode { bounds: [[[-2.0; WIDTH], [2.0; WIDTH]]; 3], child: [0; WIDTH] };
            let mut leaf_faces = Vec::new();
            let depth = check(&bvh, &root, 0, &mut leaf_faces);
            leaf_faces.sort_unstable();
            assert!(leaf_faces.into_iter().eq(0..n - 2), "not each face once");
            assert!(depth <= 40 && 3 * depth < STACK, "{depth} nodes deep");
            assert!(bvh.bytes() <= 90 * bvh.n_triangles() + 1000, "{} bytes", bvh.bytes());
        }
    }
}
