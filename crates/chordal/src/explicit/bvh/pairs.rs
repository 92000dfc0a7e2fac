//! All pairs of triangles whose boxes meet: the tree against itself.
use super::{Bvh, BvhNode, LAST, LEAF, NONE, WIDTH};
use crate::budget::{Job, par_map};
use crate::math::{greater, lesser};

/// A child, and its box, by node and lane.
type BvhChild = (u32, u8);

/// The number of pairs of children to which the work is split into tasks. Enough for an even load on many
/// threads; a constant, so that the split is the same on any number of them.
const TASKS: usize = 256;
/// Pairs of nodes between two checks for cancellation: some hundred microseconds.
const PATIENCE: u32 = 1 << 12;

/// The box of a triangle in scaled coordinates: low, high.
type TriangleBox = [[f64; 3]; 2];

impl Bvh {
    /// All triangles in the order of the leaves: rows of corners, below [`Bvh::n_corners`], and the face.
    /// Each row corresponds to one row of the mesh's positions.
    pub(crate) fn leaf_triangles(&self) -> impl ExactSizeIterator<Item = ([u32; 3], u32)> {
        self.triangles.iter().map(|triangle| (triangle.corners, triangle.face & !LAST))
    }

    /// The number of rows that faces use.
    pub(crate) fn n_corners(&self) -> usize {
        self.corners.len()
    }

    /// Calls `meet` with the slots of every two triangles whose boxes share a point, each pair once. The
    /// order of the tasks' results does not depend on threads; `None` when the job is cancelled.
    pub(crate) fn pairs<R: Default + Send>(
        &self,
        job: &Job,
        meet: impl Fn(&mut R, [u32; 2]) + Sync,
    ) -> Option<Vec<R>> {
        let work = |_, pair: &[BvhChild; 2]| {
            let mut result = R::default();
            let mut waiting = vec![*pair];
            let mut patience = 0;
            while let Some(pair) = waiting.pop() {
                patience += 1;
                if patience == PATIENCE {
                    if job.is_cancelled() {
                        break;
                    }
                    patience = 0;
                }
                self.open(pair, &mut waiting, |slots| meet(&mut result, slots));
            }
            result
        };
        let results = par_map(job, &self.tasks(), work);
        (!job.is_cancelled()).then_some(results)
    }

    /// Pairs of children that together cover all pairs of triangles.
    fn tasks(&self) -> Vec<[BvhChild; 2]> {
        let mut tasks = Vec::new();
        if !self.nodes.is_empty() {
            self.within(0, &mut tasks);
        }
        // A pair of leaves cannot be opened further and stays a task.
        while tasks.len() < TASKS && tasks.iter().any(|pair| !self.is_leaf(pair[0]) || !self.is_leaf(pair[1]))
        {
            let mut next = Vec::new();
            for pair in tasks {
                if self.is_leaf(pair[0]) && self.is_leaf(pair[1]) {
                    next.push(pair);
                } else {
                    self.open(pair, &mut next, |_| {});
                }
            }
            tasks = next;
        }
        tasks
    }

    fn child(&self, (node, lane): BvhChild) -> u32 {
        self.nodes[node as usize].child[lane as usize]
    }

    fn is_leaf(&self, child: BvhChild) -> bool {
        self.child(child) & LEAF != 0
    }

    /// Descends one level: appends the pairs of children to `below`, or calls `meet` for the triangles of
    /// leaves.
    #[inline]
    fn open(&self, [a, b]: [BvhChild; 2], below: &mut Vec<[BvhChild; 2]>, mut meet: impl FnMut([u32; 2])) {
        let (first, second) = (self.child(a), self.child(b));
        match (first & LEAF != 0, second & LEAF != 0) {
            (true, true) if a == b => self.within_leaf(first & !LEAF, &mut meet),
            (true, true) => self.between_leaves([first & !LEAF, second & !LEAF], &mut meet),
            (false, _) if a == b => self.within(first, below),
            (false, false) => {
                let node = &self.nodes[first as usize];
                for lane in (0..WIDTH as u8).filter(|lane| node.child[*lane as usize] != NONE) {
                    self.across((first, lane), second, below);
                }
            }
            (true, false) => self.across(a, second, below),
            (false, true) => self.across(b, first, below),
        }
    }

    /// Appends the pairs among the children of one node.
    fn within(&self, node: u32, below: &mut Vec<[BvhChild; 2]>) {
        let children = &self.nodes[node as usize];
        for lane in (0..WIDTH as u8).filter(|lane| children.child[*lane as usize] != NONE) {
            below.push([(node, lane); 2]);
            let meets = overlapping_lanes(children, lane as usize, children);
            let after = (lane + 1..WIDTH as u8).filter(|other| meets[*other as usize]);
            below.extend(after.map(|other| [(node, lane), (node, other)]));
        }
    }

    /// Appends the pairs of one child with those of a node.
    #[inline]
    fn across(&self, child: BvhChild, node: u32, below: &mut Vec<[BvhChild; 2]>) {
        let meets =
            overlapping_lanes(&self.nodes[child.0 as usize], child.1 as usize, &self.nodes[node as usize]);
        for lane in 0..WIDTH as u8 {
            if meets[lane as usize] {
                below.push([child, (node, lane)]);
            }
        }
    }

    fn within_leaf(&self, start: u32, meet: &mut impl FnMut([u32; 2])) {
        let boxes = self.boxes(start);
        for i in 0..boxes.n {
            for j in i + 1..boxes.n {
                if overlap(&boxes.bounds[i], &boxes.bounds[j]) {
                    meet([start + i as u32, start + j as u32]);
                }
            }
        }
    }

    fn between_leaves(&self, [left, right]: [u32; 2], meet: &mut impl FnMut([u32; 2])) {
        let (a, b) = (self.boxes(left), self.boxes(right));
        for (i, one) in a.bounds[..a.n].iter().enumerate() {
            for (j, other) in b.bounds[..b.n].iter().enumerate() {
                if overlap(one, other) {
                    meet([left + i as u32, right + j as u32]);
                }
            }
        }
    }

    /// The boxes of the run of triangles that starts at `start`.
    #[inline]
    fn boxes(&self, start: u32) -> LeafBoxes {
        let mut boxes = LeafBoxes { n: 0, bounds: [[[0.0; 3]; 2]; super::build::LEAF_SIZE] };
        for triangle in &self.triangles[start as usize..] {
            let [a, b, c] = self.corners_of(triangle);
            for k in 0..3 {
                let (low, high) = if a[k] < b[k] { (a[k], b[k]) } else { (b[k], a[k]) };
                boxes.bounds[boxes.n][0][k] = lesser(c[k], low);
                boxes.bounds[boxes.n][1][k] = greater(c[k], high);
            }
            boxes.n += 1;
            if triangle.face & LAST != 0 {
                break;
            }
        }
        boxes
    }
}

/// The boxes of a leaf.
struct LeafBoxes {
    n: usize,
    bounds: [TriangleBox; super::build::LEAF_SIZE],
}

#[inline(always)]
fn overlap(a: &TriangleBox, b: &TriangleBox) -> bool {
    let along = |k: usize| (a[0][k] <= b[1][k]) & (b[0][k] <= a[1][k]);
    along(0) & along(1) & along(2)
}

/// The boxes of `other` that meet that of one lane of `node`. The box of a missing child meets none.
#[inline(always)]
fn overlapping_lanes(node: &BvhNode, lane: usize, other: &BvhNode) -> [bool; WIDTH] {
    let mut meets = [true; WIDTH];
    for k in 0..3 {
        let (low, high) = (node.bounds[k][0][lane], node.bounds[k][1][lane]);
        for (l, meets) in meets.iter_mut().enumerate() {
            *meets &= (low <= other.bounds[k][1][l]) & (other.bounds[k][0][l] <= high);
        }
    }
    meets
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explicit::Mesh;
    use chordal_testkit::Random;

    /// The pairs of faces whose boxes meet, found by testing all.
    fn all_pairs(mesh: &Mesh) -> Vec<[u32; 2]> {
        let bounds = |face: usize| crate::math::Box3::from_points(&mesh.corners(face));
        let n = mesh.faces().len();
        let meets = |f: usize, g: usize| {
            let (a, b) = (bounds(f), bounds(g));
            (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k])
        };
        (0..n)
            .flat_map(|f| (f + 1..n).filter(move |g| meets(f, *g)).map(move |g| [f as u32, g as u32]))
            .collect()
    }

    fn tree_pairs(mesh: &Mesh, job: &Job) -> Option<Vec<[u32; 2]>> {
        let bvh = Bvh::build(mesh, &Job::default()).expect("small");
        let faces: Vec<u32> = bvh.leaf_triangles().map(|(_, face)| face).collect();
        let found = bvh.pairs(job, |found: &mut Vec<[u32; 2]>, slots| found.push(slots));
        let mut found = found?.concat();
        for pair in &mut found {
            *pair = pair.map(|slot| faces[slot as usize]);
            pair.sort_unstable();
        }
        found.sort_unstable();
        Some(found)
    }

    #[test]
    fn every_pair_whose_boxes_meet_is_found_once_and_no_other() {
        let mut random = Random::new(9);
        for round in 0..60 {
            let n_faces = [0, 1, 2, 5, 30, 700][round % 6];
            let scale = [1.0, 1e-300, 1e300, 0.1][round % 4];
            let side = [3, 60, 1000][round % 3];
            let mut positions = Vec::new();
            for _ in 0..n_faces {
                let at: [f64; 3] = std::array::from_fn(|_| random.below(side) as f64);
                for _ in 0..3 {
                    positions.push(at.map(|x| (x + random.below(9) as f64) * scale));
                }
            }
            let faces = (0..n_faces as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
            let mesh = Mesh::new(positions, faces).expect("finite");
            let expected = all_pairs(&mesh);
            for threads in [1, 3] {
                let found = tree_pairs(&mesh, &Job::default().with_threads(threads));
                assert_eq!(found.as_ref(), Some(&expected), "round {round}");
            }
        }
    }

    #[test]
    fn stops_when_it_is_cancelled() {
        let job = Job::default();
        job.cancel();
        let mesh = Mesh::new(vec![[0.0; 3]; 3], vec![[0, 1, 2]; 3000]).expect("finite");
        assert_eq!(tree_pairs(&mesh, &job), None);
    }
}
