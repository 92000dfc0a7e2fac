//! The two displaced copies of a mesh: one free of the source, one near it.
//!
//! Displacements are guesses: along the mean of the normals around a vertex, and as long as samples of the faces around it
//! require, plus a margin. Where the proof fails they grow, up to the limit.
use super::clearance::{is_clear, is_near};
use super::{OffsetSource, area, centroid};
use crate::budget::{Job, OpenPlace, par_map};
use crate::explicit::Mesh;
use crate::math::{add_up, difference, distance, dot, greater, length_up, lesser, unit};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// A side of the offset surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CopySide {
    Free,
    Near,
}

/// The first margin as a share of the limit.
const MARGIN: f64 = 1.0 / 16.0;
/// The factor by which a displacement grows where the proof fails.
const GROWTH: f64 = 1.75;
/// The most rounds. Derived: the margin grows to the limit in five.
const ROUNDS: usize = 6;
/// Where the gradient beside a corner is taken, as a share of the way to the middle. Chosen: on its own side of a crease.
const BESIDE: f64 = 0.15;
/// The distance may grow as little as this along a displacement, by cosine. Chosen: beyond it the vertex would move too far.
const LEAST_COSINE: f64 = 0.1;
/// Displacements are at most this share of the limit, so that their lengths rounded up are within it.
const REACH: f64 = 1.0 - 1.0 / (1 << 20) as f64;
/// Faces of a task.
const TASK: usize = 16;

pub(super) struct Copies {
    meshes: [Mesh; 2],
    /// The largest displacement, rounded up.
    pub reach: f64,
    /// The largest difference between the distance and the radius that was seen: a lower bound of the deviation, up to
    /// rounding.
    pub measured: f64,
    places: Vec<OpenPlace>,
}

/// The most times that faces are split. Chosen: the fourth time sides are a sixteenth as long.
const MOST_SPLITS: usize = 4;
/// With a larger share of open faces, splitting is of no use.
const HOPELESS: usize = 4;

impl Copies {
    /// Copies of a mesh. Where a face is open although its vertices have moved as far as they may, it is split: a vertex on
    /// a corner of the surface moves less far along each side than one in the middle of a side.
    pub fn build(mesh: &Mesh, source: &OffsetSource, limit: f64, job: &Job) -> Self {
        let mut split = Cow::Borrowed(mesh);
        let mut attempt = Attempt::new(mesh, source, None, limit, job);
        let mut measured = attempt.measured();
        for _ in 0..MOST_SPLITS {
            let open = attempt.open();
            let is_hopeless = HOPELESS * open.len() > split.faces().len();
            if open.is_empty() || is_hopeless || job.is_cancelled() {
                break;
            }
            let (faces, origins) = split_faces(&split, &open);
            attempt = Attempt::new(&faces, source, Some((&attempt, &origins)), limit, job);
            split = Cow::Owned(faces);
            measured = greater(measured, attempt.measured());
        }
        let mut reach = attempt.copies.iter().map(|copy| copy.reach(&split)).fold(0.0, greater);
        if let Cow::Owned(split) = &split {
            // Middles of edges are off by a rounding of each coordinate, for each time.
            let largest = split.positions().as_flattened().iter().fold(0.0, |most, x| greater(x.abs(), most));
            reach = add_up(reach, 2.0 * MOST_SPLITS as f64 * f64::EPSILON * largest);
        }
        let places = attempt.open().iter().map(|face| place(split.corners(*face as usize))).collect();
        let meshes = attempt
            .copies
            .map(|copy| split.with_positions(copy.positions).expect("displacements are finite"));
        Self { meshes, places, reach, measured }
    }

    pub fn mesh(&self, side: CopySide) -> &Mesh {
        &self.meshes[usize::from(side == CopySide::Near)]
    }

    /// The open faces.
    pub fn open_places(&self) -> Vec<OpenPlace> {
        self.places.clone()
    }

    /// The points at which distances were measured.
    pub fn n_samples(&self) -> u64 {
        7 * self.meshes[0].faces().len() as u64
    }
}

fn place(corners: [[f64; 3]; 3]) -> OpenPlace {
    let size = (0..3).map(|k| distance(corners[k], corners[(k + 1) % 3])).fold(0.0, greater);
    OpenPlace { at: centroid(corners), size, area: area(corners), contact: None }
}

/// A mesh with the sides of some faces halved, and the faces beside them cut to fit; with the number that each face had
/// before, if it was not cut. Vertices keep their numbers.
fn split_faces(mesh: &Mesh, faces: &[u32]) -> (Mesh, Vec<Option<u32>>) {
    let key = |a: u32, b: u32| [a.min(b), a.max(b)];
    let mut positions = mesh.positions().to_vec();
    let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for face in faces {
        let face = mesh.faces()[*face as usize];
        for k in 0..3 {
            let [a, b] = key(face[k], face[(k + 1) % 3]);
            middles.entry([a, b]).or_insert_with(|| {
                let [p, q] = [a, b].map(|v| mesh.positions()[v as usize]);
                positions.push(std::array::from_fn(|k| 0.5 * p[k] + 0.5 * q[k]));
                positions.len() as u32 - 1
            });
        }
    }
    let mut cut = Vec::with_capacity(mesh.faces().len() + 3 * faces.len());
    let mut origins = Vec::with_capacity(cut.capacity());
    for (number, face) in mesh.faces().iter().enumerate() {
        let middle = [0, 1, 2].map(|k| middles.get(&key(face[k], face[(k + 1) % 3])).copied());
        // The corner after which the first halved side comes, such that the sides before it are whole as far as possible.
        let first = (0..3).find(|k| middle[*k].is_some() && middle[(k + 2) % 3].is_none()).unwrap_or(0);
        let [a, b, c] = [0, 1, 2].map(|k| face[(first + k) % 3]);
        match [0, 1, 2].map(|k| middle[(first + k) % 3]) {
            [Some(ab), Some(bc), Some(ca)] => {
                cut.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
            }
            [Some(ab), Some(bc), None] => cut.extend([[ab, b, bc], [a, ab, bc], [a, bc, c]]),
            [Some(ab), None, None] => cut.extend([[a, ab, c], [ab, b, c]]),
            _ => {
                cut.push([a, b, c]);
                origins.push(Some(number as u32));
            }
        }
        origins.resize(cut.len(), None);
    }
    (Mesh::new(positions, cut).expect("middles are finite"), origins)
}

/// By corner of a face: the way along which the distance grows beside it.
type CornerGradients = [[f64; 3]; 3];

/// By vertex: the way towards free points along which the distance to the source grows by at least 1 on all sides.
///
/// Gradients of the distance tell it better than normals of the mesh, whose small triangles may be folded.
fn ways(mesh: &Mesh, gradients: &[CornerGradients]) -> Vec<[f64; 3]> {
    let n = mesh.positions().len();
    let mut sums = vec![[0.0; 3]; n];
    let corners = || {
        mesh.faces().iter().enumerate().flat_map(|(f, face)| (0..3).map(move |c| (f, c, face[c] as usize)))
    };
    for (f, c, v) in corners() {
        let at = mesh.corners(f);
        let [to_next, to_last] = [1, 2].map(|k| unit(difference(at[(c + k) % 3], at[c])).unwrap_or([0.0; 3]));
        let angle = libm::acos(lesser(greater(dot(to_next, to_last), -1.0), 1.0));
        (0..3).for_each(|k| sums[v][k] += angle * gradients[f][c][k]);
    }
    let mut ways: Vec<[f64; 3]> = sums.into_iter().map(|sum| unit(sum).unwrap_or([0.0; 3])).collect();
    // Turned towards the side that grows least, as long as that helps: at corners of few sides the best way is equally
    // steep to all of them.
    for _ in 0..TURNS {
        let mut least = vec![(f64::INFINITY, [0.0; 3]); n];
        for (f, c, v) in corners() {
            let cosine = dot(ways[v], gradients[f][c]);
            if cosine < least[v].0 {
                least[v] = (cosine, gradients[f][c]);
            }
        }
        for (way, (cosine, gradient)) in ways.iter_mut().zip(least) {
            if cosine < TURNED {
                let step = TURN * (1.0 - cosine);
                let turned = std::array::from_fn(|k| way[k] + step * gradient[k]);
                *way = unit(turned).unwrap_or(*way);
            }
        }
    }
    let mut least = vec![1.0; n];
    for (f, c, v) in corners() {
        least[v] = lesser(least[v], dot(ways[v], gradients[f][c]));
    }
    ways.iter().zip(least).map(|(way, cosine)| way.map(|x| x / greater(cosine, LEAST_COSINE))).collect()
}

/// Turns of a way, the share of the angle in each, and the cosine above which a way is good enough. Chosen.
const TURNS: usize = 8;
const TURN: f64 = 0.35;
const TURNED: f64 = 0.9;

/// The distance around a face.
#[derive(Clone, Copy)]
struct FaceSample {
    /// The lowest and the highest value at its corners, the middles of its sides and its centroid.
    values: [f64; 2],
    gradients: CornerGradients,
}

fn sample(corners: [[f64; 3]; 3], source: &OffsetSource, row: &mut u32) -> FaceSample {
    let between =
        |p: [f64; 3], q: [f64; 3], share: f64| std::array::from_fn(|k| p[k] + share * (q[k] - p[k]));
    let [a, b, c] = corners;
    let middle = centroid(corners);
    let mut values = [f64::INFINITY, f64::NEG_INFINITY];
    for p in [a, b, c, between(a, b, 0.5), between(b, c, 0.5), between(c, a, 0.5), middle] {
        let value = source.value(p, row);
        values = [lesser(values[0], value), greater(values[1], value)];
    }
    let gradients = corners.map(|corner| source.gradient(between(corner, middle, BESIDE), row));
    FaceSample { values, gradients }
}

/// Both copies of one mesh.
struct Attempt {
    samples: Vec<FaceSample>,
    copies: [DisplacedCopy; 2],
}

/// An attempt with fewer faces, and by face its number there, if it is the same.
type Before<'a> = Option<(&'a Attempt, &'a [Option<u32>])>;

impl Attempt {
    fn new(mesh: &Mesh, source: &OffsetSource, before: Before<'_>, limit: f64, job: &Job) -> Self {
        let starts: Vec<usize> = (0..mesh.faces().len()).step_by(TASK).collect();
        let known = |face: usize| before.and_then(|(before, at)| Some(before.samples[at[face]? as usize]));
        let found = par_map(job, &starts, |_, start| {
            let mut row = 0;
            let end = (start + TASK).min(mesh.faces().len());
            let mut sample_of =
                |face| known(face).unwrap_or_else(|| sample(mesh.corners(face), source, &mut row));
            (*start..end).map(&mut sample_of).collect::<Vec<FaceSample>>()
        });
        let samples: Vec<FaceSample> = found.into_iter().flatten().collect();
        let gradients: Vec<CornerGradients> = samples.iter().map(|sample| sample.gradients).collect();
        let ways = ways(mesh, &gradients);
        let copies = [CopySide::Free, CopySide::Near].map(|side| {
            let mut copy = DisplacedCopy::new(mesh, side, &ways, &samples, before, limit);
            copy.prove(mesh, source, &ways, limit, job);
            copy
        });
        Self { samples, copies }
    }

    fn measured(&self) -> f64 {
        let farthest = |sample: &FaceSample| greater(-sample.values[0], sample.values[1]);
        self.samples.iter().map(farthest).fold(0.0, greater)
    }

    /// The faces whose copies are not proved to be free and near, ascending.
    fn open(&self) -> Vec<u32> {
        let [free, near] = &self.copies;
        let holds = free.holds.iter().zip(&near.holds).map(|(free, near)| *free && *near);
        (0..).zip(holds).filter(|(_, holds)| !holds).map(|(face, _)| face).collect()
    }
}

/// One of the copies.
struct DisplacedCopy {
    side: CopySide,
    /// By vertex: how far the distance to the source is to change.
    moves: Vec<f64>,
    positions: Vec<[f64; 3]>,
    /// By face: whether its copy is proved to be on its side.
    holds: Vec<bool>,
}

impl DisplacedCopy {
    fn new(
        mesh: &Mesh,
        side: CopySide,
        ways: &[[f64; 3]],
        samples: &[FaceSample],
        before: Before<'_>,
        limit: f64,
    ) -> Self {
        let before =
            before.map(|(before, origins)| (&before.copies[usize::from(side == CopySide::Near)], origins));
        // Where all faces around a vertex held, it stays; elsewhere the search begins anew, with smaller faces.
        let mut moves = before.map_or_else(Vec::new, |(before, _)| before.moves.clone());
        moves.resize(ways.len(), 0.0);
        if let Some((before, origins)) = before {
            let held = |origin: &Option<u32>| origin.is_some_and(|face| before.holds[face as usize]);
            for (face, origin) in mesh.faces().iter().zip(origins) {
                if !held(origin) {
                    face.iter().for_each(|v| moves[*v as usize] = 0.0);
                }
            }
        }
        // How far the faces around a vertex have to move.
        for (face, sample) in mesh.faces().iter().zip(samples) {
            let [low, high] = sample.values;
            let lack = if side == CopySide::Free { -low } else { high };
            for v in face {
                moves[*v as usize] = greater(moves[*v as usize], greater(lack, 0.0) + MARGIN * limit);
            }
        }
        let mut copy = Self { side, moves, positions: Vec::new(), holds: Vec::new() };
        copy.positions = (0..ways.len()).map(|v| copy.displaced(mesh, v, ways, limit)).collect();
        copy.holds = match before {
            None => vec![false; mesh.faces().len()],
            Some((before, origins)) => {
                let is_same =
                    |v: &u32| before.positions.get(*v as usize) == Some(&copy.positions[*v as usize]);
                let is_known = |origin: &Option<u32>| origin.is_some_and(|face| before.holds[face as usize]);
                let faces = mesh.faces().iter().zip(origins);
                faces.map(|(face, origin)| is_known(origin) && face.iter().all(is_same)).collect()
            }
        };
        copy
    }

    fn displaced(&self, mesh: &Mesh, v: usize, ways: &[[f64; 3]], limit: f64) -> [f64; 3] {
        let sign = if self.side == CopySide::Free { 1.0 } else { -1.0 };
        let (way, by) = (ways[v], self.moves[v]);
        let length = by * dot(way, way).sqrt();
        let by = if length > REACH * limit { by * (REACH * limit / length) } else { by };
        std::array::from_fn(|k| mesh.positions()[v][k] + sign * by * way[k])
    }

    /// Proves faces, and moves vertices farther where that fails.
    fn prove(&mut self, mesh: &Mesh, source: &OffsetSource, ways: &[[f64; 3]], limit: f64, job: &Job) {
        let mut around: Vec<Vec<u32>> = vec![Vec::new(); ways.len()];
        for (f, face) in mesh.faces().iter().enumerate() {
            face.iter().for_each(|v| around[*v as usize].push(f as u32));
        }
        let mut open: Vec<u32> =
            (0..mesh.faces().len() as u32).filter(|face| !self.holds[*face as usize]).collect();
        for round in 0..ROUNDS {
            let holds = par_map(job, &open, |_, face| {
                let corners = mesh.faces()[*face as usize].map(|v| self.positions[v as usize]);
                job.is_cancelled() || is_on_side(corners, source, self.side)
            });
            for (face, holds) in open.iter().zip(holds) {
                self.holds[*face as usize] = holds;
            }
            open.retain(|face| !self.holds[*face as usize]);
            if open.is_empty() || round + 1 == ROUNDS {
                break;
            }
            let mut vertices: Vec<u32> = open.iter().flat_map(|face| mesh.faces()[*face as usize]).collect();
            vertices.sort_unstable();
            vertices.dedup();
            let mut moved = Vec::new();
            for v in vertices {
                self.moves[v as usize] *= GROWTH;
                let displaced = self.displaced(mesh, v as usize, ways, limit);
                if displaced != self.positions[v as usize] {
                    self.positions[v as usize] = displaced;
                    moved.push(v);
                }
            }
            // What moved has to be proved again, and nothing else can be.
            open = moved.iter().flat_map(|v| around[*v as usize].iter().copied()).collect();
            open.sort_unstable();
            open.dedup();
            open.iter().for_each(|face| self.holds[*face as usize] = false);
        }
    }

    /// The largest displacement, rounded up.
    fn reach(&self, mesh: &Mesh) -> f64 {
        let lengths = self.positions.iter().zip(mesh.positions()).map(|(p, q)| displacement_up(*p, *q));
        lengths.fold(0.0, greater)
    }
}

fn displacement_up(p: [f64; 3], q: [f64; 3]) -> f64 {
    // A difference is rounded by half a unit in its last place; the next number up is beyond it.
    length_up([0, 1, 2].map(|k| (p[k] - q[k]).abs().next_up()))
}

fn is_on_side(corners: [[f64; 3]; 3], source: &OffsetSource, side: CopySide) -> bool {
    match side {
        CopySide::Free => is_clear(corners, source) && source.is_on_free_side(corners[0]),
        CopySide::Near => is_near(corners, source),
    }
}
