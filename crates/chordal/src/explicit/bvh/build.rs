//! Building the tree: top down, each node cut where the surface area heuristic is least over bins.
use super::frame::{Frame, down, up};
use super::{Bvh, LAST, LEAF, NONE, Node, Triangle, WIDTH};
use crate::budget::{Job, par_map, par_map_owned};
use crate::explicit::Mesh;
use crate::math::{Box3, sub_down, sub_up};

/// Triangles in a leaf, at most. Measured on 1 M triangles: from 2 to 8 queries differ by less than the machine's noise,
/// and 4 needs a quarter less memory than 2.
const LEAF_SIZE: usize = 4;
/// Up to here triangles are sorted along one axis and every cut is tried; above, they are binned.
const SORTED: usize = 8;
/// Up to here fewer bins are filled: their sweep would cost more than the triangles.
const FEW: usize = 64;
/// Bins an axis. Measured: 32 gain 1 % in queries.
const BINS: usize = 16;
/// Bins an axis for few triangles.
const FEW_BINS: usize = 8;
/// Depth in nodes to which the heuristic decides; below, nodes are cut in equal quarters, 16 levels of which are
/// enough for 2³² triangles.
pub(super) const DEEPEST_BY_COST: u32 = 24;
/// Subtrees above this size are worth a task of their own.
const TASK: usize = 1 << 14;

/// A box in local f32 coordinates. The fourth lane carries nothing; it makes a row one register.
#[derive(Clone, Copy, Debug)]
struct Box32 {
    low: [f32; 4],
    high: [f32; 4],
}

impl Box32 {
    const EMPTY: Self = Self { low: [f32::INFINITY; 4], high: [f32::NEG_INFINITY; 4] };

    #[inline(always)]
    fn add(&mut self, other: &Self) {
        for k in 0..4 {
            self.low[k] = if other.low[k] < self.low[k] { other.low[k] } else { self.low[k] };
            self.high[k] = if other.high[k] > self.high[k] { other.high[k] } else { self.high[k] };
        }
    }

    #[inline(always)]
    fn sides(&self) -> [f32; 3] {
        [self.high[0] - self.low[0], self.high[1] - self.low[1], self.high[2] - self.low[2]]
    }

    /// Half the surface; 0 when empty.
    #[inline]
    fn area(&self) -> f32 {
        let [x, y, z] = self.sides();
        if x < 0.0 { 0.0 } else { x * y + y * z + z * x }
    }

    fn longest_axis(&self) -> usize {
        let [x, y, z] = self.sides();
        if x >= y && x >= z {
            0
        } else if y >= z {
            1
        } else {
            2
        }
    }
}

/// The box of one triangle. Its fourth lanes hold the two halves of the face's number, as numbers.
#[derive(Clone, Copy, Debug)]
struct Prim {
    bounds: Box32,
}

impl Prim {
    fn new(low: [f32; 3], high: [f32; 3], face: u32) -> Self {
        let halves = [face & 0xffff, face >> 16].map(|half| half as f32);
        let row = |v: [f32; 3], half: f32| [v[0], v[1], v[2], half];
        Self { bounds: Box32 { low: row(low, halves[0]), high: row(high, halves[1]) } }
    }

    fn face(&self) -> u32 {
        self.bounds.low[3] as u32 | (self.bounds.high[3] as u32) << 16
    }

    /// Twice the middle of the box; the fourth lane carries nothing.
    #[inline(always)]
    fn middles(&self) -> [f32; 4] {
        let Box32 { low, high } = &self.bounds;
        [low[0] + high[0], low[1] + high[1], low[2] + high[2], low[3] + high[3]]
    }
}

/// What is known of a run of triangles: the box around them, and the box around their doubled middles.
#[derive(Clone, Copy, Debug)]
struct Extent {
    bounds: Box32,
    middles: Box32,
}

impl Extent {
    const EMPTY: Self = Self { bounds: Box32::EMPTY, middles: Box32::EMPTY };

    #[inline(always)]
    fn add(&mut self, prim: &Prim) {
        self.bounds.add(&prim.bounds);
        let middles = prim.middles();
        self.middles.add(&Box32 { low: middles, high: middles });
    }

    fn of(prims: &[Prim]) -> Self {
        let mut extent = Self::EMPTY;
        prims.iter().for_each(|p| extent.add(p));
        extent
    }
}

/// The tree over all faces; `None` when the job is cancelled.
pub(super) fn build(mesh: &Mesh, job: &Job) -> Option<Bvh> {
    let bounds = used_bounds(mesh);
    if bounds.is_empty() {
        let frame = Frame { scale: 1.0, middle: [0.0; 3] };
        return Some(Bvh { frame, bounds, nodes: Vec::new(), triangles: Vec::new(), corners: Vec::new() });
    }
    let frame = Frame::of(&bounds);
    let chunks: Vec<usize> = (0..mesh.faces().len()).step_by(TASK).collect();
    let mut prims = par_map(job, &chunks, |_, from| prims(mesh, &frame, *from)).concat();
    let extent = Extent::of(&prims);
    let mut nodes = job.run(|| subtree(&mut prims, Place { extent, first: 0, depth: 0 }, job));
    nodes.shrink_to_fit();
    if job.is_cancelled() {
        return None;
    }
    let (triangles, corners) = in_leaf_order(mesh, &frame, &prims, &nodes);
    Some(Bvh { frame, bounds, nodes, triangles, corners })
}

fn used_bounds(mesh: &Mesh) -> Box3 {
    let mut bounds = Box3::EMPTY;
    for face in mesh.faces() {
        for i in face {
            bounds = bounds.with(mesh.positions()[*i as usize]);
        }
    }
    bounds
}

/// The boxes of the chunk of faces that begins with `from`.
fn prims(mesh: &Mesh, frame: &Frame, from: usize) -> Vec<Prim> {
    let to = mesh.faces().len().min(from + TASK);
    (from..to).map(|face| prim(mesh, frame, face)).collect()
}

/// The box of one face in local coordinates, rounded outward twice: by the shift to the middle and to f32.
fn prim(mesh: &Mesh, frame: &Frame, face: usize) -> Prim {
    let [a, b, c] = mesh.corners(face).map(|p| frame.scaled(p));
    let least = |k: usize| {
        let ab = if a[k] < b[k] { a[k] } else { b[k] };
        if ab < c[k] { ab } else { c[k] }
    };
    let most = |k: usize| {
        let ab = if a[k] > b[k] { a[k] } else { b[k] };
        if ab > c[k] { ab } else { c[k] }
    };
    Prim::new(
        std::array::from_fn(|k| down(sub_down(least(k), frame.middle[k]))),
        std::array::from_fn(|k| up(sub_up(most(k), frame.middle[k]))),
        face as u32,
    )
}

/// A run of triangles in the tree: what it holds, where it starts in the order of the leaves, how deep it is.
#[derive(Clone, Copy)]
struct Place {
    extent: Extent,
    first: u32,
    depth: u32,
}

/// A part of a node's triangles.
struct Part<'a> {
    prims: &'a mut [Prim],
    place: Place,
}

/// The nodes over `prims`, the root first; large parts are built as tasks and appended in order.
fn subtree(prims: &mut [Prim], place: Place, job: &Job) -> Vec<Node> {
    if prims.len() <= TASK {
        let mut nodes = Vec::with_capacity(prims.len() / 5 + 1);
        emit(prims, place, &mut nodes);
        return nodes;
    }
    if job.is_cancelled() {
        return Vec::new();
    }
    let parts = quarter(prims, place);
    let root = node(&parts);
    let below = par_map_owned(job, parts, |part| {
        if part.prims.len() <= LEAF_SIZE { Vec::new() } else { subtree(part.prims, part.place, job) }
    });
    let mut nodes = Vec::with_capacity(1 + below.iter().map(Vec::len).sum::<usize>());
    nodes.push(root);
    for (lane, mut part) in below.into_iter().enumerate() {
        if part.is_empty() {
            continue;
        }
        let offset = nodes.len() as u32;
        for child in part.iter_mut().flat_map(|n| n.child.iter_mut()).filter(|c| **c & LEAF == 0) {
            *child += offset;
        }
        nodes[0].child[lane] = offset;
        nodes.append(&mut part);
    }
    nodes
}

/// Appends the nodes over `prims`, the root first; its index.
fn emit(prims: &mut [Prim], place: Place, nodes: &mut Vec<Node>) -> u32 {
    let index = nodes.len();
    let parts = quarter(prims, place);
    nodes.push(node(&parts));
    for (lane, part) in parts.into_iter().enumerate() {
        if part.prims.len() > LEAF_SIZE {
            nodes[index].child[lane] = emit(part.prims, part.place, nodes);
        }
    }
    index as u32
}

/// The node over `parts`, each as if it were a leaf.
fn node(parts: &[Part]) -> Node {
    let mut node =
        Node { bounds: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3], child: [NONE; WIDTH] };
    for (lane, part) in parts.iter().enumerate() {
        let bounds = &part.place.extent.bounds;
        for k in 0..3 {
            node.bounds[k][0][lane] = bounds.low[k];
            node.bounds[k][1][lane] = bounds.high[k];
        }
        node.child[lane] = LEAF | part.place.first;
    }
    node
}

/// Cuts `prims` into up to four parts, always the part with the largest surface next: a box more in a node costs
/// nothing, so even leaves are cut while there is room.
fn quarter(prims: &mut [Prim], place: Place) -> Vec<Part<'_>> {
    let mut parts = Vec::with_capacity(WIDTH);
    parts.push(Part { prims, place: Place { depth: place.depth + 1, ..place } });
    while parts.len() < WIDTH {
        let Some(which) = largest(&parts, place.depth) else { break };
        let Part { prims, place } = parts.swap_remove(which);
        let (middle, [left, right]) = cut(prims, &place);
        let (a, b) = prims.split_at_mut(middle);
        parts.push(Part { prims: a, place: Place { extent: left, ..place } });
        parts.push(Part {
            prims: b,
            place: Place { extent: right, first: place.first + middle as u32, ..place },
        });
    }
    parts.sort_by_key(|part| part.place.first);
    parts
}

fn largest(parts: &[Part], depth: u32) -> Option<usize> {
    let size = |part: &Part| {
        let n = part.prims.len();
        if depth >= DEEPEST_BY_COST { n as f32 } else { part.place.extent.bounds.area() }
    };
    let splittable = parts.iter().enumerate().filter(|(_, part)| part.prims.len() > 1);
    splittable
        .map(|(i, part)| (i, part.prims.len() > LEAF_SIZE, size(part)))
        // What must be cut before what may be, then the largest; the first of equals.
        .reduce(|a, b| if (b.1, b.2) > (a.1, a.2) { b } else { a })
        .map(|(i, ..)| i)
}

/// Reorders two or more triangles and cuts them in two: the length of the first part, and both extents.
fn cut(prims: &mut [Prim], place: &Place) -> (usize, [Extent; 2]) {
    let middles = &place.extent.middles;
    if place.depth <= DEEPEST_BY_COST {
        if prims.len() <= SORTED {
            return sorted(prims, middles.longest_axis());
        }
        let plane = if prims.len() <= FEW {
            best_plane::<FEW_BINS>(prims, middles)
        } else {
            best_plane::<BINS>(prims, middles)
        };
        if let Some(plane) = plane {
            return part_at(prims, plane);
        }
    }
    let half = prims.len() / 2;
    (half, [Extent::of(&prims[..half]), Extent::of(&prims[half..])])
}

/// Sorts few triangles along an axis and takes the cheapest of all cuts.
fn sorted(prims: &mut [Prim], axis: usize) -> (usize, [Extent; 2]) {
    // By insertion: stable, and quick for so few.
    for i in 1..prims.len() {
        let mut j = i;
        while j > 0 && prims[j].middles()[axis] < prims[j - 1].middles()[axis] {
            prims.swap(j, j - 1);
            j -= 1;
        }
    }
    let mut right = [Extent::EMPTY; SORTED];
    let mut sum = Extent::EMPTY;
    for i in (1..prims.len()).rev() {
        sum.add(&prims[i]);
        right[i] = sum;
    }
    let mut left = Extent::EMPTY;
    let (mut best, mut least) = ((1, [Extent::EMPTY; 2]), f32::INFINITY);
    for i in 1..prims.len() {
        left.add(&prims[i - 1]);
        let cost = left.bounds.area() * i as f32 + right[i].bounds.area() * (prims.len() - i) as f32;
        if cost < least || i == 1 {
            (best, least) = ((i, [left, right[i]]), cost);
        }
    }
    best
}

/// Cuts below bin `below` of `axis`.
#[derive(Clone, Copy)]
struct Plane {
    axis: usize,
    bins: Bins,
    below: u32,
}

/// Equal intervals along each axis; the first and the last are half as long.
#[derive(Clone, Copy)]
struct Bins {
    from: [f32; 4],
    factor: [f32; 4],
}

impl Bins {
    fn new(middles: &Box32, n: usize) -> Self {
        let factor = |k: usize| {
            let factor = (n - 1) as f32 / (middles.high[k] - middles.low[k]);
            // Where all middles coincide, or nearly, one bin takes them all.
            if factor < f32::MAX { factor } else { 0.0 }
        };
        Self { from: middles.low, factor: [factor(0), factor(1), factor(2), 0.0] }
    }

    /// The bin by axis. Added to 2²³, a number below 2²³ is rounded to a whole one that stands in the low bits.
    #[inline(always)]
    fn of(&self, middles: [f32; 4]) -> [u32; 4] {
        const WHOLE: f32 = (1 << 23) as f32;
        let mut bins = [0; 4];
        for k in 0..4 {
            bins[k] = ((middles[k] - self.from[k]) * self.factor[k] + WHOLE).to_bits() & 0xff;
        }
        bins
    }
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Box32,
    n: u32,
}

/// The plane between bins with the least `area · count` on both sides; `None` when all middles coincide.
fn best_plane<const N: usize>(prims: &[Prim], middles: &Box32) -> Option<Plane> {
    let bins = Bins::new(middles, N);
    let mut filled = [[Bin { bounds: Box32::EMPTY, n: 0 }; N]; 3];
    for prim in prims {
        let at = bins.of(prim.middles());
        for axis in 0..3 {
            let bin = &mut filled[axis][at[axis] as usize & (N - 1)];
            bin.bounds.add(&prim.bounds);
            bin.n += 1;
        }
    }
    let mut best: Option<(f32, Plane)> = None;
    for axis in 0..3 {
        if let Some((cost, below)) = sweep(&filled[axis])
            && best.is_none_or(|(least, _)| cost < least)
        {
            best = Some((cost, Plane { axis, bins, below: below as u32 }));
        }
    }
    best.map(|(_, plane)| plane)
}

/// The cheapest place between bins, where there is one with triangles on both sides.
fn sweep<const N: usize>(bins: &[Bin; N]) -> Option<(f32, usize)> {
    let mut right = [0.0_f32; N];
    let (mut bounds, mut n) = (Box32::EMPTY, 0);
    for i in (1..N).rev() {
        bounds.add(&bins[i].bounds);
        n += bins[i].n;
        right[i] = if n == 0 { f32::NAN } else { bounds.area() * n as f32 };
    }
    let (mut bounds, mut n) = (Box32::EMPTY, 0);
    let mut best: Option<(f32, usize)> = None;
    for i in 1..N {
        bounds.add(&bins[i - 1].bounds);
        n += bins[i - 1].n;
        let cost = bounds.area() * n as f32 + right[i];
        if n > 0 && !right[i].is_nan() && best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, i));
        }
    }
    best
}

/// Moves what lies below the plane to the front.
fn part_at(prims: &mut [Prim], plane: Plane) -> (usize, [Extent; 2]) {
    let is_left = |prim: &Prim| plane.bins.of(prim.middles())[plane.axis] < plane.below;
    let (mut left, mut right) = (Extent::EMPTY, Extent::EMPTY);
    let (mut i, mut j) = (0, prims.len());
    while i < j {
        if is_left(&prims[i]) {
            left.add(&prims[i]);
            i += 1;
        } else {
            j -= 1;
            right.add(&prims[i]);
            prims.swap(i, j);
        }
    }
    (i, [left, right])
}

/// Triangles and scaled positions in the order of the leaves.
fn in_leaf_order(
    mesh: &Mesh,
    frame: &Frame,
    prims: &[Prim],
    nodes: &[Node],
) -> (Vec<Triangle>, Vec<[f64; 3]>) {
    const UNSEEN: u32 = u32::MAX;
    let mut row = vec![UNSEEN; mesh.positions().len()];
    let mut corners = Vec::new();
    let mut triangles: Vec<Triangle> = Vec::with_capacity(prims.len());
    for prim in prims {
        let indices = mesh.faces()[prim.face() as usize].map(|i| {
            let known = &mut row[i as usize];
            if *known == UNSEEN {
                *known = corners.len() as u32;
                corners.push(frame.scaled(mesh.positions()[i as usize]));
            }
            *known
        });
        triangles.push(Triangle { corners: indices, face: prim.face() });
    }
    // A run ends where the next begins.
    for child in nodes.iter().flat_map(|n| n.child).filter(|c| c & LEAF != 0 && *c != NONE) {
        if let Some(before) = (child & !LEAF).checked_sub(1) {
            triangles[before as usize].face |= LAST;
        }
    }
    if let Some(last) = triangles.last_mut() {
        last.face |= LAST;
    }
    corners.shrink_to_fit();
    (triangles, corners)
}
