//! Marching cubes on the bricks of a field: signs, crossings of edges found to the last places, triangles by number.
use super::bricks::{Group, crossed};
use super::lattice::{BRICK, Lattice, POINTS};
use crate::budget::{Job, par_map};
use crate::convert::cubes::table::{EDGES, RINGS, TABLE};
use crate::explicit::Mesh;
use crate::implicit::{LeafError, Slope, Tape};
use crate::math::{dot, length};

/// Points of a brick.
const SIGNS: usize = POINTS * POINTS * POINTS;
/// Cells of a brick, each of which owns an edge along x, y and z.
const CELLS: usize = BRICK * BRICK * BRICK;

/// A brick with vertices.
struct Brick {
    place: [u32; 3],
    /// One bit a point: inside.
    inside: [u64; SIGNS.div_ceil(64)],
    /// One bit an edge that the brick owns: crossed. By axis, then by the cell at whose low corner it starts.
    crossings: [[u64; CELLS / 64]; 3],
    /// The number of its first vertex.
    first: u32,
    vertices: Vec<[f64; 3]>,
    /// Unit normals at them; 0 where there is no gradient.
    normals: Vec<[f64; 3]>,
}

/// The triangles of a lattice, and where they seem to bevel a crease.
pub(super) struct Polygonized {
    pub mesh: Mesh,
    /// Unit normals at the vertices; 0 where there is no gradient.
    pub normals: Vec<[f64; 3]>,
    pub bevels: Vec<Bevel>,
}

/// A loop of a cell whose vertices look in different ways.
pub(super) struct Bevel {
    /// The low corner of the cell.
    pub cell: [f64; 3],
    /// The first of its triangles, of which there are two less than corners.
    pub first: u32,
    /// Its vertices, counter-clockwise.
    pub ring: Vec<u32>,
}

/// A loop is looked at where two of its normals turn more than this, about 25°; exactly a cosine of 0.9.
pub(super) const TURN: f64 = 0.9;

/// Why there is no mesh.
pub(super) enum Halt {
    Leaf(LeafError),
    Cancelled,
    /// More vertices than numbers.
    TooMany,
}

impl From<LeafError> for Halt {
    fn from(error: LeafError) -> Self {
        Self::Leaf(error)
    }
}

/// The surface of the field as triangles on the lattice: closed and manifold, since the table of cells is and the border of
/// the lattice is outside; empty where no point of the lattice is inside.
///
/// Bricks that ranges show to be of one sign are left out; their points have the same signs as those of their neighbours
/// on common faces, because the value that is computed for a point lies in the range of any box around it.
pub(super) fn polygonize(tape: &Tape, lattice: &Lattice, job: &Job) -> Result<Polygonized, Halt> {
    let groups = crossed(tape, lattice, job)?.ok_or(Halt::Cancelled)?;
    let made =
        par_map(
            job,
            &groups,
            |_, group| {
                if job.is_cancelled() { Ok(Vec::new()) } else { sampled(group, lattice) }
            },
        );
    drop(groups);
    let mut bricks: Vec<Brick> =
        made.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
    if job.is_cancelled() {
        return Err(Halt::Cancelled);
    }
    bricks.sort_unstable_by_key(|brick| order(brick.place));
    let mut n_vertices = 0_usize;
    for brick in &mut bricks {
        brick.first = u32::try_from(n_vertices).map_err(|_| Halt::TooMany)?;
        n_vertices += brick.vertices.len();
    }
    if u32::try_from(n_vertices).is_err() {
        return Err(Halt::TooMany);
    }
    let runs: Vec<std::ops::Range<usize>> =
        (0..bricks.len()).step_by(16).map(|start| start..(start + 16).min(bricks.len())).collect();
    let parts = par_map(job, &runs, |_, run| {
        let mut part = Part { bricks: &bricks, lattice, faces: Vec::new(), bevels: Vec::new() };
        run.clone().try_for_each(|k| part.triangles(k))?;
        Some((part.faces, part.bevels))
    });
    let (mut faces, mut bevels) = (Vec::new(), Vec::new());
    for part in parts {
        let (more, mut rings) = part.ok_or_else(contradiction)?;
        rings.iter_mut().for_each(|ring| ring.first += faces.len() as u32);
        faces.extend(more);
        bevels.extend(rings);
    }
    let (mut positions, mut normals) = (Vec::with_capacity(n_vertices), Vec::with_capacity(n_vertices));
    for brick in &bricks {
        positions.extend_from_slice(&brick.vertices);
        normals.extend_from_slice(&brick.normals);
    }
    let mesh = Mesh::new(positions, faces)
        .expect("vertices lie between finite points, and every crossed edge has one");
    Ok(Polygonized { mesh, normals, bevels })
}

/// What is wrong when two bricks disagree about a face that they share: only what a leaf says can make them.
fn contradiction() -> Halt {
    let message = "a leaf contradicts itself: a value lies outside of the range that it gave for a box around the point, \
                   or two calls gave different values for one point";
    Halt::Leaf(LeafError::new(message))
}

/// Along z, then y, then x.
fn order(place: [u32; 3]) -> [u32; 3] {
    [place[2], place[1], place[0]]
}

fn point(index: [usize; 3]) -> usize {
    index[0] + POINTS * (index[1] + POINTS * index[2])
}

fn cell(index: [usize; 3]) -> usize {
    index[0] + BRICK * (index[1] + BRICK * index[2])
}

/// A crossed edge while its crossing is looked for.
struct Edge {
    axis: usize,
    /// The end that is inside, and the other.
    inside: [f64; 3],
    outside: [f64; 3],
    values: [f64; 2],
}

/// Evaluates the bricks of a group; those with crossings.
fn sampled(group: &Group, lattice: &Lattice) -> Result<Vec<Brick>, LeafError> {
    let mut points = Vec::with_capacity(group.bricks.len() * SIGNS);
    for place in &group.bricks {
        let at = |k: usize, i: usize| lattice.at(k, place[k] * BRICK as u32 + i as u32);
        for z in 0..POINTS {
            for y in 0..POINTS {
                points.extend((0..POINTS).map(|x| [at(0, x), at(1, y), at(2, z)]));
            }
        }
    }
    let mut values = vec![0.0; points.len()];
    group.tape.at(&points, &mut values)?;
    let mut bricks = Vec::new();
    let mut edges = Vec::new();
    for (k, place) in group.bricks.iter().enumerate() {
        let range = k * SIGNS..(k + 1) * SIGNS;
        close_border(*place, lattice, &mut values[range.clone()]);
        let (brick, found) = signs(*place, &points[range.clone()], &values[range]);
        if found.is_empty() && brick.inside.iter().all(|word| *word == 0) {
            continue;
        }
        bricks.push((brick, found.len()));
        edges.extend(found);
    }
    let crossings = cross(&group.tape, edges, lattice.step)?;
    let mut slopes = vec![Slope { value: 0.0, gradient: [0.0; 3] }; crossings.len()];
    group.tape.gradient_at(&crossings, &mut slopes)?;
    let mut rest = crossings.into_iter().zip(slopes);
    for (brick, n) in &mut bricks {
        (brick.vertices, brick.normals) =
            rest.by_ref().take(*n).map(|(p, slope)| (p, normal(slope.gradient))).unzip();
    }
    Ok(bricks.into_iter().map(|(brick, _)| brick).collect())
}

/// Points in the border of the lattice are outside, so that the mesh is closed whatever the field's bounds are worth.
fn close_border(place: [u32; 3], lattice: &Lattice, values: &mut [f64]) {
    for axis in 0..3 {
        let ends = [(place[axis] == 0, 0), (place[axis] + 1 == lattice.bricks[axis], BRICK)];
        for (_, end) in ends.into_iter().filter(|(at_border, _)| *at_border) {
            for n in 0..POINTS * POINTS {
                let mut index = [n % POINTS, n / POINTS, 0];
                index.swap(2, axis);
                index[axis] = end;
                let value = &mut values[point(index)];
                if *value < 0.0 {
                    *value = 0.0;
                }
            }
        }
    }
}

fn signs(place: [u32; 3], points: &[[f64; 3]], values: &[f64]) -> (Brick, Vec<Edge>) {
    let mut brick = Brick {
        place,
        inside: [0; SIGNS.div_ceil(64)],
        crossings: [[0; CELLS / 64]; 3],
        first: 0,
        vertices: Vec::new(),
        normals: Vec::new(),
    };
    for (k, value) in values.iter().enumerate() {
        brick.inside[k / 64] |= u64::from(*value < 0.0) << (k % 64);
    }
    let mut edges = Vec::new();
    for axis in 0..3 {
        let stride = [1, POINTS, POINTS * POINTS][axis];
        for n in 0..CELLS {
            let low = point([n % BRICK, n / BRICK % BRICK, n / (BRICK * BRICK)]);
            let (a, b) = (values[low] < 0.0, values[low + stride] < 0.0);
            if a != b {
                brick.crossings[axis][n / 64] |= 1 << (n % 64);
                let (i, o) = if a { (low, low + stride) } else { (low + stride, low) };
                let values = [values[i], values[o]];
                edges.push(Edge { axis, inside: points[i], outside: points[o], values });
            }
        }
    }
    (brick, edges)
}

/// Rounds in which a crossing is looked for at most; false position with the Illinois rule needs a handful.
const ROUNDS: usize = 48;
/// A bracket of this share of the step is a crossing: exactly 2⁻³⁰, a billionth of a cell.
const CLOSE: f64 = 1.0 / 1_073_741_824.0;
/// Crossings keep this share of an edge, exactly 2⁻²⁰, away from its ends, so that no triangle is flat.
const MARGIN: f64 = 1.0 / 1_048_576.0;

/// The points where the sign changes, each within its last bracket.
fn cross(tape: &Tape, mut edges: Vec<Edge>, step: f64) -> Result<Vec<[f64; 3]>, LeafError> {
    let ends: Vec<[f64; 2]> =
        edges.iter().map(|edge| [edge.inside[edge.axis], edge.outside[edge.axis]]).collect();
    let mut open: Vec<usize> = (0..edges.len()).collect();
    // Which end stayed last time, for the Illinois rule.
    let mut stayed = vec![2_u8; edges.len()];
    let (mut points, mut values) = (Vec::new(), Vec::new());
    for round in 0..ROUNDS {
        open.retain(|k| {
            let edge = &edges[*k];
            (edge.inside[edge.axis] - edge.outside[edge.axis]).abs() > CLOSE * step
        });
        if open.is_empty() {
            break;
        }
        points.clear();
        points.extend(open.iter().map(|k| guess(&edges[*k], round)));
        values.clear();
        values.resize(points.len(), 0.0);
        tape.at(&points, &mut values)?;
        for ((k, point), value) in open.iter().zip(&points).zip(&values) {
            narrow(&mut edges[*k], &mut stayed[*k], *point, *value);
        }
    }
    let place = |(edge, ends): (&Edge, &[f64; 2])| {
        let mut at = edge.inside;
        let x = 0.5 * edge.inside[edge.axis] + 0.5 * edge.outside[edge.axis];
        let (low, high) = if ends[0] < ends[1] { (ends[0], ends[1]) } else { (ends[1], ends[0]) };
        let (low, high) = (low + MARGIN * step, high - MARGIN * step);
        at[edge.axis] = if x < low {
            low
        } else if x > high {
            high
        } else {
            x
        };
        at
    };
    Ok(edges.iter().zip(&ends).map(place).collect())
}

/// Between the two ends: where the line through both values is 0, or the middle where that says nothing. Kept away from the
/// ends by a share of the bracket, so that it shrinks on both sides.
fn guess(edge: &Edge, round: usize) -> [f64; 3] {
    let [inside, outside] = edge.values;
    let share = inside / (inside - outside);
    // Steep or flat ends make false position creep: every fourth step halves.
    let share = if share > 0.0 && share < 1.0 && round % 4 != 3 { share } else { 0.5 };
    let (a, b) = (edge.inside[edge.axis], edge.outside[edge.axis]);
    // A point this close to the end that is near brackets from the other side next time. 2⁻³² of the bracket, exactly.
    const ASIDE: f64 = 1.0 / 4_294_967_296.0;
    let share = if share < 0.5 { share + ASIDE } else { share - ASIDE };
    let mut at = edge.inside;
    at[edge.axis] = a + share * (b - a);
    at
}

fn narrow(edge: &mut Edge, stayed: &mut u8, point: [f64; 3], value: f64) {
    let inside = value < 0.0;
    let this = u8::from(!inside);
    // What stays for the second time in a row loses half its weight.
    let other = usize::from(inside);
    if *stayed == other as u8 {
        edge.values[other] *= 0.5;
    }
    *stayed = other as u8;
    edge.values[usize::from(this)] = value;
    if inside {
        edge.inside = point;
    } else {
        edge.outside = point;
    }
}

/// The unit normal of a gradient, or 0.
fn normal(gradient: [f64; 3]) -> [f64; 3] {
    let unit = gradient.map(|g| g / length(gradient));
    if unit.iter().all(|x| x.is_finite()) { unit } else { [0.0; 3] }
}

/// The triangles of some bricks.
struct Part<'a> {
    bricks: &'a [Brick],
    lattice: &'a Lattice,
    faces: Vec<[u32; 3]>,
    bevels: Vec<Bevel>,
}

impl Part<'_> {
    /// The triangles of the cells of one brick; `None` where a neighbour knows nothing of a crossing.
    fn triangles(&mut self, number: usize) -> Option<()> {
        let bricks = self.bricks;
        let brick = &bricks[number];
        let neighbours: [Option<&Brick>; 8] = std::array::from_fn(|n| {
            let offset = [n & 1, n >> 1 & 1, n >> 2];
            if n == 0 {
                return Some(brick);
            }
            let place: [u32; 3] = std::array::from_fn(|k| brick.place[k] + offset[k] as u32);
            bricks.binary_search_by_key(&order(place), |b| order(b.place)).ok().map(|k| &bricks[k])
        });
        for n in 0..CELLS {
            let corner = [n % BRICK, n / BRICK % BRICK, n / (BRICK * BRICK)];
            let mut signs = 0_u8;
            for c in 0..8 {
                let p = point([corner[0] + (c & 1), corner[1] + (c >> 1 & 1), corner[2] + (c >> 2)]);
                signs |= ((brick.inside[p / 64] >> (p % 64) & 1) as u8) << c;
            }
            if signs == 0 || signs == u8::MAX {
                continue;
            }
            let first = self.faces.len() as u32;
            let case = &TABLE.upright[usize::from(signs)];
            let at = |edge: u8| vertex(&neighbours, corner, usize::from(edge));
            for triangle in &case.corners[..usize::from(case.triangles)] {
                let [a, b, c] = triangle.map(at);
                self.faces.push([a?.0, b?.0, c?.0]);
            }
            let cell =
                [0, 1, 2].map(|k| self.lattice.at(k, brick.place[k] * BRICK as u32 + corner[k] as u32));
            self.bevels(RINGS[usize::from(signs)].as_slice(), &at, (cell, first));
        }
        Some(())
    }

    /// Loops of a cell whose normals turn.
    fn bevels(
        &mut self,
        rings: &[Vec<u8>],
        at: &dyn Fn(u8) -> Option<(u32, [f64; 3])>,
        (cell, mut first): ([f64; 3], u32),
    ) {
        for ring in rings {
            // A cell has twelve edges.
            let mut normals = [[0.0; 3]; 12];
            for (normal, edge) in normals.iter_mut().zip(ring) {
                *normal = at(*edge).map_or([0.0; 3], |(_, normal)| normal);
            }
            let normals = &normals[..ring.len()];
            if normals.iter().enumerate().any(|(k, a)| normals[..k].iter().any(|b| dot(*a, *b) < TURN)) {
                let ring = ring.iter().filter_map(|edge| at(*edge)).map(|(v, _)| v).collect();
                self.bevels.push(Bevel { cell, first, ring });
            }
            first += ring.len() as u32 - 2;
        }
    }
}

/// The number and the normal of the vertex on an edge of a cell. A brick with a change of sign on its face is there, with the crossing,
/// unless a leaf contradicts itself.
fn vertex(neighbours: &[Option<&Brick>; 8], corner: [usize; 3], edge: usize) -> Option<(u32, [f64; 3])> {
    let low = usize::from(EDGES[edge][0]);
    let axis = edge / 4;
    let start: [usize; 3] = std::array::from_fn(|k| corner[k] + (low >> k & 1));
    let beyond = (0..3).fold(0, |all, k| all | usize::from(start[k] == BRICK) << k);
    let brick = neighbours[beyond]?;
    let n = cell(start.map(|i| i % BRICK));
    let before = |axis: usize| brick.crossings[axis].iter().map(|word| word.count_ones()).sum::<u32>();
    let crossings = &brick.crossings[axis];
    if crossings[n / 64] >> (n % 64) & 1 == 0 {
        return None;
    }
    let rank: u32 = crossings[..n / 64].iter().map(|word| word.count_ones()).sum::<u32>()
        + (crossings[n / 64] & ((1 << (n % 64)) - 1)).count_ones();
    let rank = (0..axis).map(before).sum::<u32>() + rank;
    Some((brick.first + rank, brick.normals[rank as usize]))
}
