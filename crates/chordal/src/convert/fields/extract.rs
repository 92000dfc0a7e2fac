//! Extracts a solid's boundary from a grid: in each cell the boundary of linear functions, joined between cells without
//! using coordinates.
//!
//! Values at vertices become integers, so that signs are exact. Each primitive is moved outward by a small odd
//! number, so that none is 0 at a vertex and sheets with equal values stay apart. The result is closed,
//! oriented and manifold whatever the values are, and embedded up to the rounding of coordinates.
use super::arrangement::{ArrangementVertex, BoundaryPatches, LinearCell, LivePrimitive, NONE};
use super::cells::ZeroSide;
use super::grid::{FieldGrid, GridCell};
use super::polygon_triangulation::triangulate;
use super::sizing::SizingPoint;
use crate::budget::{Job, par_map};
use crate::math::IntegerMap;
use crate::math::determinants::{common_zero3, common_zero4};
use crate::math::{greater, lesser};

/// A closed oriented manifold near the boundary of a solid: exact for functions that are linear in each cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::convert) struct ExtractedSurface {
    pub positions: Vec<[f64; 3]>,
    /// Counter-clockwise as seen from outside.
    pub faces: Vec<[u32; 3]>,
    /// By face: twice the number of its primitive, plus one where the solid is on the positive side of it.
    pub labels: Vec<u32>,
    /// By vertex: the primitives that it is on, ascending, then the largest number: one on a face, two on a
    /// crease, three in a corner.
    pub vertex_primitives: Vec<[u32; 3]>,
    /// By vertex: the longest edge of the largest cell that contains it.
    pub cell_sizes: Vec<f64>,
    /// Cells that would have to be smaller: the surface in them may differ from the shape.
    pub unresolved: Vec<SizingPoint>,
}

/// Bits of a value. Chosen: its rounding is far below any tolerance, and together with [`SHIFT_BITS`] it fits the 53
/// bits of determinants' entries.
const VALUE_BITS: i32 = 36;
/// Bits of the shift of a primitive.
const SHIFT_BITS: u32 = 16;
/// Cells in one task.
const CHUNK: usize = 256;
/// Vertices or patches in one task.
const LARGE_CHUNK: usize = 2048;

/// The most sets of shifts that are tried. Measured: of 3,000 random solids whose planes coincide, one or two have
/// coinciding vertices with the first set.
const TRIALS: u64 = 4;

/// Extracts the boundary from all cells of a grid.
pub(in crate::convert) fn extract(grid: &FieldGrid, job: &Job) -> ExtractedSurface {
    let cells: Vec<&GridCell> = grid.cells().collect();
    let first = extract_shifted(grid, &cells, 0, job);
    if !has_collapsed(&first) {
        return first;
    }
    (1..TRIALS)
        .map(|trial| extract_shifted(grid, &cells, trial, job))
        .find(|surface| !has_collapsed(surface))
        .unwrap_or(first)
}

/// Whether some face has two corners at one position: sheets are nearer to each other there than the precision of
/// coordinates.
fn has_collapsed(surface: &ExtractedSurface) -> bool {
    surface.faces.iter().any(|face| {
        let [a, b, c] = face.map(|v| surface.positions[v as usize]);
        a == b || b == c || a == c
    })
}

/// Extracts with the shifts of one trial.
fn extract_shifted(grid: &FieldGrid, cells: &[&GridCell], trial: u64, job: &Job) -> ExtractedSurface {
    let integers = IntegerValues::new(grid, cells, trial);
    let chunks: Vec<&[&GridCell]> = cells.chunks(CHUNK).collect();
    let parts: Vec<(BoundaryPatches, Vec<f64>)> =
        par_map(job, &chunks, |_, cells| boundary(grid, &integers, cells));
    let mut merger = PatchMerger::default();
    parts.iter().for_each(|(patches, sizes)| merger.push(patches, sizes));
    let positions = positions(&integers, &merger.keys, job);
    let (faces, labels) = faces(&merger, &positions, job);
    let vertex_primitives = merger.keys.iter().map(ArrangementVertex::lies_on).collect();
    ExtractedSurface {
        positions,
        faces,
        labels,
        vertex_primitives,
        cell_sizes: merger.sizes,
        unresolved: grid.unresolved(),
    }
}

/// The values as integers.
struct IntegerValues<'a> {
    grid: &'a FieldGrid<'a>,
    /// In the order of the grid's values.
    integers: Vec<i64>,
}

impl<'a> IntegerValues<'a> {
    fn new(grid: &'a FieldGrid<'a>, cells: &[&GridCell], trial: u64) -> Self {
        let mut largest_values = vec![0.0_f64; grid.csg().primitives().len()];
        for cell in cells {
            for p in &cell.pruned.primitives {
                let values =
                    cell.tetrahedron.corners.map(|v| grid.values.get(v, *p).expect("it was asked for"));
                // Only cells in which the primitive changes its sign are relevant.
                if values.iter().all(|x| *x < 0.0) || values.iter().all(|x| *x > 0.0) {
                    continue;
                }
                let most = &mut largest_values[*p as usize];
                for size in values.map(f64::abs) {
                    if size > *most && size.is_finite() {
                        *most = size;
                    }
                }
            }
        }
        let scales: Vec<f64> = largest_values.into_iter().map(scale).collect();
        let to_shifted = |(p, value): (u32, f64)| {
            let shift = shift(p, trial);
            // `to_integer` makes 0 positive. Where 0 is inside, it is negated before and after.
            match grid.zero[p as usize] {
                ZeroSide::Outside => to_integer(value, scales[p as usize], shift),
                ZeroSide::Inside => -to_integer(-value, scales[p as usize], shift),
            }
        };
        Self { grid, integers: grid.values.all().map(to_shifted).collect() }
    }

    fn at(&self, vertex: u32, primitive: u32) -> i64 {
        self.integers[self.grid.values.index(vertex, primitive).expect("it was asked for")]
    }

    /// The sign of the infinitesimal that moves a primitive outward.
    fn sense(&self, primitive: u32) -> i64 {
        match self.grid.zero[primitive as usize] {
            ZeroSide::Outside => 1,
            ZeroSide::Inside => -1,
        }
    }
}

/// The value as an integer with its sign (0 and NaN count as positive), moved away from 0 by the shift.
fn to_integer(value: f64, scale: f64, shift: i64) -> i64 {
    /// 2 to the power of [`VALUE_BITS`].
    const MOST: f64 = (1_u64 << VALUE_BITS) as f64;
    // Rounded down, so that negative values stay negative, even if the product is 0.
    let floor = (value * scale).floor();
    let floor = if value < 0.0 && floor > -1.0 { -1.0 } else { floor };
    let floor = lesser(floor, MOST);
    let floor = greater(floor, -MOST);
    // The shift is positive and below the quantum, so it changes no sign, and being odd it makes no value 0.
    ((floor as i64) << SHIFT_BITS) + shift
}

/// The factor, a power of 2, that turns values up to `largest` into integers of [`VALUE_BITS`] bits.
fn scale(largest: f64) -> f64 {
    /// The largest power that has a reciprocal, with room for [`VALUE_BITS`].
    const FARTHEST: i32 = 900;
    let mut exponent = 0;
    let mut size = largest;
    // Halving and doubling are exact.
    while size >= 1.0 && exponent < FARTHEST {
        size *= 0.5;
        exponent += 1;
    }
    while size < 0.5 && size > 0.0 && exponent > -FARTHEST {
        size *= 2.0;
        exponent -= 1;
    }
    let power = VALUE_BITS - exponent;
    // The bits of a power of 2 as a double: its exponent is stored with 1023 added.
    f64::from_bits(((1023 + power) as u64) << 52)
}

/// An odd number of [`SHIFT_BITS`] bits.
fn shift(primitive: u32, trial: u64) -> i64 {
    // Defined: the finalizer of SplitMix64 (Steele, Lea and Flood, 2014), which maps equal differences of
    // numbers to different ones.
    let seed = (u64::from(primitive) + 1 + (trial << 32)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = (seed ^ seed >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    (mixed >> (64 - SHIFT_BITS)) as i64 | 1
}

/// The boundary in some cells, and for each of its corners the longest edge of the cell.
fn boundary(grid: &FieldGrid, integers: &IntegerValues, cells: &[&GridCell]) -> (BoundaryPatches, Vec<f64>) {
    let (mut patches, mut sizes) = (BoundaryPatches::default(), Vec::new());
    let mut live = Vec::new();
    for cell in cells {
        let mut corners = cell.tetrahedron.corners;
        if !grid.tetrahedra.is_positive(corners) {
            corners.swap(2, 3);
        }
        live.clear();
        for p in &cell.pruned.primitives {
            let values = corners.map(|v| integers.at(v, *p));
            if values.iter().any(|x| (*x < 0) != (values[0] < 0)) {
                live.push(LivePrimitive { primitive: *p, values, sense: integers.sense(*p) });
            }
        }
        if live.is_empty() {
            continue;
        }
        // Primitives that are not live have the same sign at all corners.
        let is_negative = |p: u32| integers.at(corners[0], p) < 0;
        LinearCell { corners, live: &live, tree: &cell.pruned.tree }.boundary(is_negative, &mut patches);
        sizes.resize(patches.corners.len(), grid.tetrahedra.longest(corners));
    }
    (patches, sizes)
}

impl ArrangementVertex {
    /// The primitives that the vertex is on.
    fn lies_on(&self) -> [u32; 3] {
        if self.other == NONE { self.primitives } else { [self.primitives[0], self.primitives[1], NONE] }
    }

    fn n_corners(&self) -> usize {
        self.simplex.iter().filter(|v| **v != NONE).count()
    }
}

/// The patches of all cells, with merged vertices.
#[derive(Default)]
struct PatchMerger {
    ids: IntegerMap<ArrangementVertex, u32>, // No order depends on it.
    keys: Vec<ArrangementVertex>,
    sizes: Vec<f64>,
    /// The vertex of each corner.
    vertices: Vec<u32>,
    loop_ends: Vec<u32>,
    patches: Vec<(u32, u32)>,
}

impl PatchMerger {
    fn push(&mut self, patches: &BoundaryPatches, sizes: &[f64]) {
        let (n_corners, n_loops) = (self.vertices.len() as u32, self.loop_ends.len() as u32);
        // In the order of the cells, so that numbers do not depend on threads.
        for (key, size) in patches.corners.iter().zip(sizes) {
            let new = self.keys.len() as u32;
            let id = *self.ids.entry(*key).or_insert(new);
            if id == new {
                self.keys.push(*key);
                self.sizes.push(*size);
            }
            let largest = &mut self.sizes[id as usize];
            *largest = greater(*size, *largest);
            self.vertices.push(id);
        }
        self.loop_ends.extend(patches.loop_ends.iter().map(|end| n_corners + end));
        self.patches.extend(patches.patches.iter().map(|(label, end)| (*label, n_loops + end)));
    }
}

/// The positions of the linear functions' zeros.
fn positions(integers: &IntegerValues, keys: &[ArrangementVertex], job: &Job) -> Vec<[f64; 3]> {
    let chunks: Vec<&[ArrangementVertex]> = keys.chunks(LARGE_CHUNK).collect();
    par_map(job, &chunks, |_, keys| keys.iter().map(|key| position(integers, key)).collect::<Vec<_>>())
        .concat()
}

fn position(integers: &IntegerValues, key: &ArrangementVertex) -> [f64; 3] {
    if key.other != NONE {
        let [p, q, a] = key.primitives;
        let end = |third: u32| {
            let mut primitives = [p, q, third];
            primitives.sort_unstable();
            position(integers, &ArrangementVertex { primitives, other: NONE, ..*key })
        };
        let (a, b) = (end(a), end(key.other));
        return std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
    }
    let at = |v: u32| integers.grid.tetrahedra.position(v);
    let value = |v: u32, p: u32| integers.at(v, p);
    let [a, b, c, d] = key.simplex;
    let [p, q, r] = key.primitives;
    match key.n_corners() {
        2 => {
            let (x, y) = (value(a, p), value(b, p));
            // Both are below 2⁵³ in size; their difference may be rounded once.
            let part = x as f64 / (x - y) as f64;
            weighted([at(a), at(b)], [1.0 - part, part])
        }
        3 => {
            // Functions that are equal on the facet have no single zero. Any point of the facet will do then,
            // since the connectivity does not depend on positions.
            let corners = [a, b, c];
            let weights =
                common_zero3([p, q].map(|p| corners.map(|v| value(v, p)))).unwrap_or([1.0 / 3.0; 3]);
            weighted(corners.map(at), weights)
        }
        _ => {
            let corners = [a, b, c, d];
            let weights = common_zero4([p, q, r].map(|p| corners.map(|v| value(v, p)))).unwrap_or([0.25; 4]);
            weighted(corners.map(at), weights)
        }
    }
}

/// The point with these barycentric coordinates.
fn weighted<const N: usize>(corners: [[f64; 3]; N], weights: [f64; N]) -> [f64; 3] {
    // Relative to the first corner, so that common parts are not rounded.
    let first = corners[0];
    std::array::from_fn(|k| first[k] + (1..N).map(|i| weights[i] * (corners[i][k] - first[k])).sum::<f64>())
}

/// The triangles and their labels.
fn faces(merger: &PatchMerger, positions: &[[f64; 3]], job: &Job) -> (Vec<[u32; 3]>, Vec<u32>) {
    let numbers: Vec<usize> = (0..merger.patches.len()).collect();
    let chunks: Vec<&[usize]> = numbers.chunks(LARGE_CHUNK).collect();
    let parts = par_map(job, &chunks, |_, part| {
        let (mut faces, mut labels) = (Vec::new(), Vec::new());
        part.iter().for_each(|n| patch_faces(merger, positions, *n, &mut faces, &mut labels));
        (faces, labels)
    });
    let (mut faces, mut labels) = (Vec::new(), Vec::new());
    for (some_faces, some_labels) in parts {
        faces.extend(some_faces);
        labels.extend(some_labels);
    }
    (faces, labels)
}

fn patch_faces(
    merger: &PatchMerger,
    positions: &[[f64; 3]],
    number: usize,
    faces: &mut Vec<[u32; 3]>,
    labels: &mut Vec<u32>,
) {
    let before = |ends: &dyn Fn(usize) -> u32, k: usize| if k == 0 { 0 } else { ends(k - 1) } as usize;
    let (label, loops_end) = merger.patches[number];
    let loops = before(&|k| merger.patches[k].1, number)..loops_end as usize;
    let corners = |ring: usize| before(&|k| merger.loop_ends[k], ring)..merger.loop_ends[ring] as usize;
    let vertices = &merger.vertices[corners(loops.start).start..corners(loops.end - 1).end];
    if let [a, b, c] = *vertices {
        faces.push([a, b, c]);
        labels.push(label);
        return;
    }
    let rings: Vec<Vec<[f64; 3]>> = loops
        .map(|ring| merger.vertices[corners(ring)].iter().map(|v| positions[*v as usize]).collect())
        .collect();
    let rings: Vec<&[[f64; 3]]> = rings.iter().map(Vec::as_slice).collect();
    let mut triangles = Vec::with_capacity(vertices.len());
    let is_straight: Vec<bool> = vertices.iter().map(|v| merger.keys[*v as usize].other != NONE).collect();
    triangulate(&rings, &is_straight, &mut triangles);
    labels.resize(labels.len() + triangles.len(), label);
    faces.extend(triangles.into_iter().map(|t| t.map(|k| vertices[k as usize])));
}
