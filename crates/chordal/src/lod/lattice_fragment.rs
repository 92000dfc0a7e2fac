//! `LatticeFragment`: a part of a surface with whole-number coordinates in a box of its lattice, as
//! multiscale viewers expect it.
//!
//! Three steps move points, and each has a bound for the distance. If a map is linear on each triangle, no
//! point moves farther than the farthest vertex, so each bound holds for the surface, in both directions.
//! 1. Vertices are put into the box and rounded to its steps: the distance of each is enclosed by intervals.
//! 2. Triangles are cut by the planes through the middle. A cut is exact, then its two other coordinates are rounded: by
//!    at most half a step each. Its pieces are triangles again, so the next plane can cut them.
//! 3. A triangle with coincident corners is a segment or a point, and dropped if other triangles contain
//!    that. If none does, two triangles of opposite winding replace it, which are nowhere farther from it
//!    than one step.
//!
//! The surface stays closed where it was: in (2) an edge is cut by its ends alone, so all its triangles have the same
//! point there; in (1) and (3), as many triangles run along an edge in one direction as in the other. Parts that
//! share an edge cut it alike, since it lies in a plane between two boxes, and there these have the same planes.
use super::surface_part::{LatticeBox, SurfacePart};
use crate::budget::{JobError, Refusal, RefusalCode};
use crate::convert::lattices::VertexKey;
use crate::implicit::Affine3;
use crate::math::{Interval, add_up, greater, length_up, mul_up};
use std::collections::{BTreeMap, BTreeSet};

/// The box of a fragment: `sides` cells from the sample `low` on. It may go beyond the lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FragmentBox {
    /// The index of its first sample.
    pub low: [i64; 3],
    /// Its cells along each axis, at least 1.
    pub sides: [i64; 3],
    /// The map from the lattice to the world.
    pub affine: Affine3,
    /// Whether triangles are cut by the planes through the middle.
    pub is_halved: bool,
}

/// Triangles whose vertices are whole numbers in a box.
#[derive(Clone, Debug, PartialEq)]
pub struct LatticeFragment {
    /// Coordinates along i, j and k: 0 is the low side of the box, 65,535 the high side. No two vertices are
    /// the same.
    pub positions: Vec<[u16; 3]>,
    /// Indices of three different vertices each, wound as those of the part.
    pub faces: Vec<[u32; 3]>,
    /// A bit for each eighth of the box, set if it has triangles: the lowest bit is the eighth at the low
    /// sides, then the next one along i. All bits are 0 if triangles are not cut.
    pub octants: u8,
    /// A bound on the distance of the triangles from those of the part, in both directions.
    pub moved_at_most: f64,
}

/// Steps along the side of a box. Defined by Neuroglancer's format, as the largest number of 16 bits.
const STEPS: i64 = 65_535;
/// The step at which the halves of a box meet. Defined by Neuroglancer, which compares with it: the upper of
/// the two middle ones.
const MIDDLE: i64 = 32_768;
/// The largest index of a lattice here: 2⁵², derived from the digits of f64, which represents all integers up
/// to it.
const FARTHEST: i64 = 1 << 52;

impl LatticeFragment {
    /// A part as a fragment. `part_box` is the box of the part, which is inside the fragment's: vertices
    /// shared with other parts are put exactly on the sides.
    ///
    /// The bound covers all movements: into the box, to whole numbers, and at cuts.
    ///
    /// Cost: O(n log n).
    ///
    /// # Errors
    /// [`JobError::Refused`]: a box without cells or beyond 2⁵² ([`RefusalCode::Unsupported`]), more vertices than a mesh may
    /// have ([`RefusalCode::TooManyTriangles`]), distances beyond f64 ([`RefusalCode::NotFinite`]).
    pub fn new(part: &SurfacePart, part_box: &LatticeBox, within: &FragmentBox) -> Result<Self, JobError> {
        let refused = |code, message: &str| JobError::Refused(Refusal::new(code, message.to_owned()));
        let ends = within.low.iter().zip(&within.sides);
        if !ends
            .into_iter()
            .all(|(low, side)| low.unsigned_abs() < FARTHEST.unsigned_abs() && (1..FARTHEST).contains(side))
        {
            return Err(refused(
                RefusalCode::Unsupported,
                "the box of a fragment has no cells, or is beyond 2^52",
            ));
        }
        let (placed, mut moved) = placed(part, part_box, within);
        let mut cutter = Cutter { positions: placed, faces: part.mesh.faces().to_vec() };
        for axis in 0..3 {
            if within.is_halved && cutter.cut(axis) {
                for other in (0..3).filter(|other| *other != axis) {
                    // Half a step.
                    moved = add_up(moved, 0.5 * within.step_up(other));
                }
            }
        }
        if u32::try_from(cutter.positions.len()).is_err() {
            return Err(refused(
                RefusalCode::TooManyTriangles,
                "a fragment has more vertices than a mesh may have",
            ));
        }
        let mut triangles = cutter.finished();
        if triangles.drop_flat() {
            // A triangle that replaces a segment reaches one step beside it.
            let steps = [0, 1, 2].map(|axis| within.step_up(axis));
            moved = add_up(moved, steps.into_iter().fold(0.0, greater));
        }
        if !moved.is_finite() {
            return Err(refused(RefusalCode::NotFinite, "a distance in a fragment is beyond f64"));
        }
        let octants = if within.is_halved { triangles.octants() } else { 0 };
        let (positions, faces) = triangles.indexed();
        Ok(Self { positions, faces, octants, moved_at_most: moved })
    }
}

impl FragmentBox {
    /// An upper bound on the length of a step along an axis.
    fn step_up(&self, axis: usize) -> f64 {
        let step = length_up(self.affine.steps()[axis]);
        mul_up(step, (Interval::point(self.sides[axis] as f64) / Interval::point(STEPS as f64)).hi())
    }

    /// An upper bound on the distance of a point from a point with whole coordinates in the box.
    fn distance_up(&self, at: [i64; 3], point: [f64; 3]) -> f64 {
        let number = |n: i64| Interval::point(n as f64);
        let index: [Interval; 3] = std::array::from_fn(|axis| {
            number(self.low[axis]) + number(self.sides[axis]) * number(at[axis]) / number(STEPS)
        });
        let rows = self.affine.rows();
        let apart: [f64; 3] = std::array::from_fn(|row| {
            let [a, b, c, d] = rows[row].map(Interval::point);
            let image = a * index[0] + b * index[1] + c * index[2] + d;
            (image - Interval::point(point[row])).magnitude()
        });
        length_up(apart)
    }
}

/// The vertices of a part in whole numbers, and an upper bound on their movement.
fn placed(part: &SurfacePart, part_box: &LatticeBox, within: &FragmentBox) -> (Vec<[i64; 3]>, f64) {
    let to_index = Inverse::new(&within.affine);
    let mut keys = part.shared.iter().peekable();
    let mut most: f64 = 0.0;
    let mut placed = Vec::with_capacity(part.mesh.positions().len());
    for (row, point) in (0_u32..).zip(part.mesh.positions()) {
        let key = keys.next_if(|(shared, _)| *shared == row).map(|(_, key)| key);
        let index = to_index.at(*point);
        let at: [i64; 3] = std::array::from_fn(|axis| {
            // A vertex on a side that another box shares is put exactly there, whatever the rounding was.
            let is_at = |k: usize, side: i64| {
                let is_on = |key: &VertexKey| usize::from(key.kind) != axis && key.lattice[axis] == side;
                part_box.goes_on[axis][k] && key.is_some_and(is_on)
            };
            if is_at(0, within.low[axis]) {
                return 0;
            }
            if is_at(1, within.low[axis] + within.sides[axis]) {
                return STEPS;
            }
            // A guess, whose distance is measured below: a worse one would only be farther away.
            let share = (index[axis] - within.low[axis] as f64) / within.sides[axis] as f64;
            ((share * STEPS as f64).round() as i64).clamp(0, STEPS)
        });
        let distance = within.distance_up(at, *point);
        most = greater(most, distance);
        placed.push(at);
    }
    (placed, most)
}

/// The inverse of an affine map, rounded.
struct Inverse {
    rows: [[f64; 3]; 3],
    origin: [f64; 3],
}

impl Inverse {
    fn new(affine: &Affine3) -> Self {
        let [a, b, c] = affine.steps();
        let cross = |u: [f64; 3], v: [f64; 3]| {
            [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
        };
        // Cramer's rule: the rows of the inverse are the cross products of the columns over the determinant.
        let across = cross(b, c);
        let determinant = a[0] * across[0] + a[1] * across[1] + a[2] * across[2];
        let rows = [across, cross(c, a), cross(a, b)].map(|row| row.map(|x| x / determinant));
        Self { rows, origin: affine.rows().map(|row| row[3]) }
    }

    /// The index of a point: the same bits for the same point in all parts.
    fn at(&self, point: [f64; 3]) -> [f64; 3] {
        let from: [f64; 3] = std::array::from_fn(|k| point[k] - self.origin[k]);
        self.rows.map(|row| row[0] * from[0] + row[1] * from[1] + row[2] * from[2])
    }
}

/// Triangles that are cut by the planes through the middle.
struct Cutter {
    positions: Vec<[i64; 3]>,
    faces: Vec<[u32; 3]>,
}

impl Cutter {
    /// Cuts by the plane across an axis; returns whether any triangle was cut.
    fn cut(&mut self, axis: usize) -> bool {
        let mut cuts: BTreeMap<(u32, u32), u32> = BTreeMap::new();
        let mut faces = Vec::with_capacity(self.faces.len());
        for face in std::mem::take(&mut self.faces) {
            let beyond = face.map(|row| self.positions[row as usize][axis] - MIDDLE);
            if !(beyond.iter().any(|x| *x < 0) && beyond.iter().any(|x| *x > 0)) {
                faces.push(face);
                continue;
            }
            let mut halves: [Vec<u32>; 2] = [Vec::with_capacity(4), Vec::with_capacity(4)];
            for k in 0..3 {
                let next = (k + 1) % 3;
                // Corners on the plane belong to both halves.
                if beyond[k] <= 0 {
                    halves[0].push(face[k]);
                }
                if beyond[k] >= 0 {
                    halves[1].push(face[k]);
                }
                if beyond[k].signum() * beyond[next].signum() < 0 {
                    // By the ends in ascending order, so that both triangles of an edge get the same vertex.
                    let [a, b] = [face[k], face[next]];
                    let edge = if a < b { (a, b) } else { (b, a) };
                    let positions = &mut self.positions;
                    let row = *cuts.entry(edge).or_insert_with(|| {
                        positions.push(crossing(positions[a as usize], positions[b as usize], axis));
                        (positions.len() - 1) as u32
                    });
                    halves.iter_mut().for_each(|half| half.push(row));
                }
            }
            for half in halves {
                // A half is convex, so that a fan around any corner covers it.
                for k in 2..half.len() {
                    faces.push([half[0], half[k - 1], half[k]]);
                }
            }
        }
        self.faces = faces;
        !cuts.is_empty()
    }

    /// The triangles, given by the coordinates of their corners.
    fn finished(&self) -> Placed {
        let triangles = self.faces.iter().map(|face| face.map(|row| self.positions[row as usize]));
        Placed { triangles: triangles.collect() }
    }
}

/// The point at which an edge meets the plane through the middle, rounded. The order of the ends does not
/// matter, since the exact point is rounded.
fn crossing(a: [i64; 3], b: [i64; 3], axis: usize) -> [i64; 3] {
    let (weight_a, weight_b) = ((b[axis] - MIDDLE).abs(), (MIDDLE - a[axis]).abs());
    let total = weight_a + weight_b;
    std::array::from_fn(|other| {
        if other == axis {
            MIDDLE
        } else {
            // Half up; numbers of 16 bits do not overflow here.
            (2 * (a[other] * weight_a + b[other] * weight_b) + total).div_euclid(2 * total)
        }
    })
}

/// Triangles, given by the coordinates of their corners.
struct Placed {
    triangles: Vec<[[i64; 3]; 3]>,
}

impl Placed {
    /// Drops the triangles that are segments or points. A segment or point that no other triangle contains is
    /// replaced by two triangles of opposite winding; returns whether there was one.
    fn drop_flat(&mut self) -> bool {
        let mut lost = Vec::new();
        self.triangles.retain(|[a, b, c]| {
            let is_flat = a == b || b == c || c == a;
            if is_flat {
                lost.push(if a == b { [*a, *c] } else { [*a, *b] });
            }
            !is_flat
        });
        if lost.is_empty() {
            return false;
        }
        let mut known_segments: BTreeSet<[[i64; 3]; 2]> = self.triangles.iter().flat_map(segments).collect();
        let before = self.triangles.len();
        for [a, b] in lost {
            if known_segments.contains(&ordered(a, b)) {
                continue;
            }
            let b = if a == b { beside(a, b, 0) } else { b };
            // At most one of two steps along axes leads to the other end.
            let to = beside(a, b, 1);
            let c = if to == b { beside(a, b, 2) } else { to };
            known_segments.extend(segments(&[a, b, c]));
            self.triangles.extend([[a, b, c], [a, c, b]]);
        }
        self.triangles.len() > before
    }

    /// The eighths that have triangles. A triangle in a plane between eighths belongs to the lower one.
    fn octants(&self) -> u8 {
        let mut octants = 0;
        for triangle in &self.triangles {
            let is_high = |axis: usize| triangle.iter().any(|corner| corner[axis] > MIDDLE);
            let eighth = (0..3).map(|axis| u32::from(is_high(axis)) << axis).sum::<u32>();
            octants |= 1 << eighth;
        }
        octants
    }

    /// One vertex for each point, and the triangles by their vertices.
    fn indexed(&self) -> (Vec<[u16; 3]>, Vec<[u32; 3]>) {
        let mut rows: BTreeMap<[i64; 3], u32> = BTreeMap::new();
        let mut positions = Vec::new();
        let mut row = |at: [i64; 3]| {
            *rows.entry(at).or_insert_with(|| {
                positions.push(at.map(|x| x as u16));
                (positions.len() - 1) as u32
            })
        };
        let faces = self.triangles.iter().map(|triangle| triangle.map(&mut row)).collect();
        (positions, faces)
    }
}

/// A segment, independent of the order of its ends.
fn ordered(a: [i64; 3], b: [i64; 3]) -> [[i64; 3]; 2] {
    if a < b { [a, b] } else { [b, a] }
}

/// The edges of a triangle, and its corners as segments without a length.
fn segments([a, b, c]: &[[i64; 3]; 3]) -> [[[i64; 3]; 2]; 6] {
    [ordered(*a, *b), ordered(*b, *c), ordered(*c, *a), [*a; 2], [*b; 2], [*c; 2]]
}

/// One step from `a` along an axis, in the box and in an eighth that contains `b`, too.
fn beside(a: [i64; 3], b: [i64; 3], axis: usize) -> [i64; 3] {
    let mut at = a;
    let goes_down = a[axis] > MIDDLE || (a[axis] == MIDDLE && b[axis] < MIDDLE);
    at[axis] += if goes_down { -1 } else { 1 };
    at
}
