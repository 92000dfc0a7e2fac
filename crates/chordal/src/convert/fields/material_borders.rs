//! Cuts faces that several materials share along the materials' borders.
//!
//! If two parts meet at a crease, each face has one material already. If they share a surface, such as the tops of
//! a plate and of an inlay, the border is the zero set of other primitives; in a blend, the points at which two parts
//! are equally near. Faces there are bisected until at most four such functions cross each face and run nearly
//! straight, and are then cut along them. New vertices lie on old edges, so the surface stays the same, up to rounding.
use super::border_functions::BorderFunctions;
use super::face_materials::FaceMaterials;
use super::improve::FaceLabel;
use crate::explicit::Mesh;
use crate::implicit::csg::MaterialChoice;
use crate::implicit::{Dual, LeafError, Membership};
use crate::math::{Box3, greater, lesser};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// The most rounds of bisections. Derived: two rounds halve the edges of a face, and 24 halvings reduce ten million lengths
/// to one.
const MOST_ROUNDS: usize = 48;
/// A face is cut by at most this many functions; if more meet in it, it is bisected. Chosen: corners of borders have two
/// or three, and four give at most sixteen parts.
const MOST_CUTS: usize = 4;
/// Vertices nearer to a border than this share of the length count as on it. Chosen: it avoids slivers far below the length.
const SNAP: f64 = 1.0 / 64.0;
/// Every point of a face is nearer to a sample than this share of the longest edge. Derived: a sixth for equilateral
/// faces, a quarter for flat ones.
const REACH: f64 = 0.25;
/// Steps to the zero of a primitive on an edge. Chosen: enough, since it is nearly linear there.
const STEPS: usize = 8;
/// Corners, middles of edges, and the centroid.
const SAMPLES: [[f64; 3]; 7] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.5],
    [0.5, 0.0, 0.5],
    [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
];
/// The largest distance of a new vertex from its edge, relative to the largest coordinate. Derived: three roundings of
/// numbers up to twice as large, along three axes.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The state of a face.
#[derive(Clone)]
enum FaceState {
    Settled(u32),
    /// By function: the side on which the whole face lies.
    Open(Rc<Vec<Membership>>),
    /// To be cut along these functions.
    Cut(Vec<u32>),
}

/// A mesh whose faces have materials.
pub(super) struct BorderedMesh {
    pub positions: Vec<[f64; 3]>,
    pub faces: Vec<[u32; 3]>,
    pub labels: Vec<FaceLabel>,
    /// By face: its material, or `None` if its middle decides.
    pub materials: Vec<Option<u32>>,
    /// The largest distance by which the surface was moved.
    pub moved: f64,
}

/// Cuts the faces of a mesh, so that borders are within a tolerance of the true ones.
pub(super) fn cut_at_borders(
    mesh: &Mesh,
    labels: Vec<FaceLabel>,
    face_materials: &FaceMaterials,
    tol: f64,
) -> Result<BorderedMesh, LeafError> {
    let unknown = Rc::new(vec![Membership::Unknown; face_materials.pairs.n_functions()]);
    let state = |label: &FaceLabel| match face_materials.everywhere(*label) {
        MaterialChoice::One(number) => FaceState::Settled(number),
        _ => FaceState::Open(Rc::clone(&unknown)),
    };
    let states = labels.iter().map(state).collect();
    let functions =
        BorderFunctions::new(face_materials.csg, &face_materials.pairs, (&mesh.bounds(), face_materials.job));
    let mut cutter = BorderCutter {
        face_materials,
        functions,
        tol,
        positions: mesh.positions().to_vec(),
        faces: mesh.faces().to_vec(),
        labels,
        states,
        n_moves: 0,
    };
    for _ in 0..MOST_ROUNDS {
        let long_edges = cutter.decide_open()?;
        let is_full = (cutter.faces.len() + long_edges.len()) as u64 * 2 > face_materials.job.triangle_limit;
        if long_edges.is_empty() || is_full || face_materials.job.is_cancelled() {
            break;
        }
        cutter.split(&long_edges);
    }
    cutter.cut()?;
    let bounds = mesh.bounds();
    let largest = bounds.min.iter().chain(&bounds.max).fold(0.0, |most, x| greater(x.abs(), most));
    let material =
        |state: &FaceState| if let FaceState::Settled(number) = state { Some(*number) } else { None };
    Ok(BorderedMesh {
        materials: cutter.states.iter().map(material).collect(),
        // New vertices are on edges between vertices of earlier rounds, so their roundings add up.
        moved: ROUNDING * largest * f64::from(cutter.n_moves),
        positions: cutter.positions,
        faces: cutter.faces,
        labels: cutter.labels,
    })
}

struct BorderCutter<'a> {
    face_materials: &'a FaceMaterials<'a>,
    functions: BorderFunctions<'a>,
    tol: f64,
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    labels: Vec<FaceLabel>,
    states: Vec<FaceState>,
    /// The number of rounds in which vertices were added to edges.
    n_moves: u32,
}

/// An edge by its vertices, the smaller one first.
type EdgeKey = (u32, u32);

fn key(a: u32, b: u32) -> EdgeKey {
    (lesser(a, b), greater(a, b))
}

/// The course of a function on a face, by samples.
struct PrimitiveOnFace {
    /// Whether its zero set is straight within the tolerance.
    is_straight: bool,
    /// Whether its zero set passes through the face, and not only along the rim.
    crosses: bool,
    /// Its side at the middle.
    side: Membership,
}

impl BorderCutter<'_> {
    /// Settles open faces, or lists their cuts. Returns the edges to bisect for the others.
    fn decide_open(&mut self) -> Result<BTreeMap<EdgeKey, f64>, LeafError> {
        let mut open: Vec<(usize, Vec<Membership>)> = Vec::new();
        let mut queries: Vec<(u32, Box3)> = Vec::new();
        for (face, state) in self.states.iter().enumerate() {
            let FaceState::Open(sides) = state else { continue };
            let bounds = Box3::from_points(&self.corners(face));
            queries.extend(unknown(sides).map(|p| (p, bounds)));
            open.push((face, sides.to_vec()));
        }
        let mut ranges = self.functions.ranges(&queries)?.into_iter();
        for (_, sides) in &mut open {
            for p in unknown(sides).collect::<Vec<_>>() {
                let [low, high] = ranges.next().expect("one for each query");
                sides[p as usize] = match (high < 0.0, low > 0.0) {
                    (true, _) => Membership::Inside,
                    (_, true) => Membership::Outside,
                    _ => Membership::Unknown,
                };
            }
        }
        let mut undecided = Vec::new();
        for (face, sides) in open {
            match self.face_materials.choice(self.labels[face], |p| sides[p as usize], None) {
                MaterialChoice::One(number) => self.states[face] = FaceState::Settled(number),
                _ => undecided.push((face, sides)),
            }
        }
        let samples = self.sample(&undecided)?;
        let mut long_edges = BTreeMap::new();
        for ((face, sides), samples) in undecided.into_iter().zip(samples) {
            let mut by_samples = sides.clone();
            let (mut cuts, mut n_bent) = (Vec::new(), 0);
            for (p, on_face) in unknown(&sides).zip(samples) {
                match on_face {
                    PrimitiveOnFace { is_straight: false, .. } => n_bent += 1,
                    PrimitiveOnFace { crosses: true, .. } => cuts.push(p),
                    PrimitiveOnFace { side, .. } => by_samples[p as usize] = side,
                }
            }
            let edge = self.longest_edge(face);
            self.states[face] =
                match self.face_materials.choice(self.labels[face], |p| by_samples[p as usize], None) {
                    MaterialChoice::One(number) => FaceState::Settled(number),
                    _ if n_bent == 0 && cuts.len() <= MOST_CUTS => FaceState::Cut(cuts),
                    _ if edge.1 > self.tol => {
                        long_edges.insert(edge.0, 0.5);
                        // What the samples said holds only for this face as a whole; its halves start from
                        // what intervals proved.
                        FaceState::Open(Rc::new(sides))
                    }
                    // Too short to be bisected: without cuts, the middle of the face decides.
                    _ => FaceState::Cut(Vec::new()),
                };
        }
        Ok(long_edges)
    }

    fn corners(&self, face: usize) -> [[f64; 3]; 3] {
        self.faces[face].map(|v| self.positions[v as usize])
    }

    fn longest_edge(&self, face: usize) -> (EdgeKey, f64) {
        let [a, b, c] = self.faces[face];
        let length = |(a, b): EdgeKey| {
            DVec3::from(self.positions[a as usize]).distance(DVec3::from(self.positions[b as usize]))
        };
        let mut best = (key(a, b), length(key(a, b)));
        for edge in [key(b, c), key(c, a)] {
            let this_length = length(edge);
            best = if this_length > best.1 { (edge, this_length) } else { best };
        }
        best
    }

    /// The course of the undecided functions on each face.
    fn sample(&mut self, faces: &[(usize, Vec<Membership>)]) -> Result<Vec<Vec<PrimitiveOnFace>>, LeafError> {
        let (mut queries, mut middles) = (Vec::new(), Vec::new());
        for (face, sides) in faces {
            let corners = self.corners(*face).map(DVec3::from);
            let at = |[a, b, c]: [f64; 3]| (a * corners[0] + b * corners[1] + c * corners[2]).to_array();
            for p in unknown(sides) {
                queries.extend(SAMPLES.map(|shares| (p, at(shares))));
                middles.push((p, at(SAMPLES[6])));
            }
        }
        let values = self.functions.values(&queries)?;
        let slopes = self.functions.duals(&middles)?;
        let mut rows = values.chunks_exact(SAMPLES.len()).zip(slopes);
        let mut courses = Vec::new();
        for (face, sides) in faces {
            let [a, b, c] = self.corners(*face).map(DVec3::from);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let longest = self.longest_edge(*face).1;
            let course = |(values, slope): (&[f64], Dual<f64>)| {
                let slope = DVec3::from(slope.gradient);
                let along = (slope - slope.dot(normal) * normal).length();
                // The deviation of the samples from the linear function with the same values at the corners.
                let linear = |[a, b, c]: [f64; 3]| a * values[0] + b * values[1] + c * values[2];
                let deviation =
                    SAMPLES.iter().zip(values).map(|(shares, value)| (value - linear(*shares)).abs());
                let deviation = deviation.fold(0.0, |most, x| greater(x, most));
                let margin = SNAP * self.tol * along;
                // Clear of 0 by more than the deviation, and than the change from any point to its nearest sample.
                let near = greater(deviation, REACH * longest * slope.length());
                let is_clear = values.iter().all(|x| *x > near) || values.iter().all(|x| *x < -near);
                PrimitiveOnFace {
                    is_straight: is_clear || deviation <= self.tol * along,
                    crosses: values[..3].iter().any(|x| *x > margin)
                        && values[..3].iter().any(|x| *x < -margin),
                    side: Membership::from_value(values[6]),
                }
            };
            courses.push(unknown(sides).map(|_| course(rows.next().expect("one for each query"))).collect());
        }
        Ok(courses)
    }

    /// Cuts faces along their functions, one after the other.
    fn cut(&mut self) -> Result<(), LeafError> {
        let pending =
            |state: &FaceState| if let FaceState::Cut(list) = state { list.clone() } else { Vec::new() };
        // In ascending order. Faces inherit the list of the face that they were cut from, so each function
        // also cuts the parts that the functions before it have made.
        let functions: BTreeSet<u32> = self.states.iter().flat_map(pending).collect();
        for p in functions {
            let mut edges: BTreeMap<EdgeKey, f64> = BTreeMap::new();
            for (face, state) in self.states.iter().enumerate() {
                if matches!(state, FaceState::Cut(list) if list.contains(&p)) {
                    let [a, b, c] = self.faces[face];
                    // Only the edges are used, not the shares.
                    edges.extend([key(a, b), key(b, c), key(c, a)].map(|edge| (edge, 0.5)));
                }
            }
            let zeros = self.zeros(p, edges.into_keys().collect())?;
            self.split(&zeros);
        }
        Ok(())
    }

    /// The zeros of a function on edges, as a share of the edge from its first vertex; edges with a zero at or near a vertex
    /// are left out.
    fn zeros(&mut self, p: u32, edges: Vec<EdgeKey>) -> Result<BTreeMap<EdgeKey, f64>, LeafError> {
        let point = |positions: &[[f64; 3]], (a, b): EdgeKey, share: f64| {
            let [a, b] = [a, b].map(|v| DVec3::from(positions[v as usize]));
            (a + share * (b - a)).to_array()
        };
        let ends: Vec<(u32, [f64; 3])> = edges
            .iter()
            .flat_map(|edge| [0.0, 1.0].map(|end| (p, point(&self.positions, *edge, end))))
            .collect();
        let values = self.functions.values(&ends)?;
        let mut brackets: Vec<(EdgeKey, [f64; 2], [f64; 2])> = edges
            .iter()
            .zip(values.chunks_exact(2))
            .filter(|(_, ends)| (ends[0] < 0.0) != (ends[1] < 0.0))
            .map(|(edge, ends)| (*edge, [0.0, 1.0], [ends[0], ends[1]]))
            .collect();
        let share = |[low, high]: [f64; 2], [at_low, at_high]: [f64; 2]| {
            let share = low + (high - low) * (at_low / (at_low - at_high));
            if share >= low && share <= high { share } else { 0.5 * (low + high) }
        };
        // The Illinois method: the value at an end that stays is halved.
        let mut last = vec![2_usize; brackets.len()];
        for _ in 0..STEPS {
            let queries: Vec<(u32, [f64; 3])> = brackets
                .iter()
                .map(|(edge, x, f)| (p, point(&self.positions, *edge, share(*x, *f))))
                .collect();
            let values = self.functions.values(&queries)?;
            for (((_, x, f), value), last) in brackets.iter_mut().zip(values).zip(&mut last) {
                let zero = share(*x, *f);
                let end = usize::from((value < 0.0) != (f[0] < 0.0));
                (x[end], f[end]) = (zero, value);
                if *last == end {
                    f[1 - end] *= 0.5;
                }
                *last = end;
            }
        }
        // A vertex near the border on one of its edges counts as on it for all of them. Otherwise the cut
        // would pass beside the vertex, through a sliver.
        let mut near_vertices: BTreeSet<u32> = BTreeSet::new();
        let mut zeros = BTreeMap::new();
        for ((a, b), x, f) in brackets {
            let zero = share(x, f);
            let length =
                DVec3::from(self.positions[a as usize]).distance(DVec3::from(self.positions[b as usize]));
            let snap = SNAP * self.tol;
            near_vertices.extend((zero * length <= snap).then_some(a));
            near_vertices.extend(((1.0 - zero) * length <= snap).then_some(b));
            zeros.insert((a, b), zero);
        }
        zeros.retain(|(a, b), _| !near_vertices.contains(a) && !near_vertices.contains(b));
        Ok(zeros)
    }

    /// Adds vertices on edges, and splits all faces with these edges.
    fn split(&mut self, edges: &BTreeMap<EdgeKey, f64>) {
        self.n_moves += u32::from(!edges.is_empty());
        let mut added: BTreeMap<EdgeKey, u32> = BTreeMap::new();
        for ((a, b), share) in edges {
            let [from, to] = [*a, *b].map(|v| DVec3::from(self.positions[v as usize]));
            added.insert((*a, *b), self.positions.len() as u32);
            self.positions.push((from + *share * (to - from)).to_array());
        }
        for face in 0..self.faces.len() {
            let corners = self.faces[face];
            let on_edges = [0, 1, 2].map(|k| added.get(&key(corners[k], corners[(k + 1) % 3])).copied());
            let parts = self.parts(corners, on_edges);
            self.faces[face] = parts[0];
            for part in &parts[1..] {
                self.faces.push(*part);
                self.labels.push(self.labels[face]);
                self.states.push(self.states[face].clone());
            }
        }
    }

    /// The triangles of a face with vertices on some of its edges; edge `k` starts at corner `k`. Of the two diagonals of the
    /// remaining quad, the shorter one is taken.
    fn parts(&self, corners: [u32; 3], on_edges: [Option<u32>; 3]) -> Vec<[u32; 3]> {
        let turned = |k: usize| [0, 1, 2].map(|i| corners[(i + k) % 3]);
        match on_edges {
            [None, None, None] => vec![corners],
            [Some(p), Some(q), Some(r)] => {
                let [a, b, c] = corners;
                vec![[a, p, r], [p, b, q], [q, c, r], [p, q, r]]
            }
            _ => {
                // Starts at an edge with a vertex that follows an edge without one.
                let first =
                    (0..3).find(|k| on_edges[*k].is_some() && on_edges[(*k + 2) % 3].is_none()).unwrap_or(0);
                let [a, b, c] = turned(first);
                let p = on_edges[first].unwrap_or(a);
                let Some(q) = on_edges[(first + 1) % 3] else { return vec![[a, p, c], [p, b, c]] };
                let distance = |u: u32, v: u32| {
                    DVec3::from(self.positions[u as usize]).distance(DVec3::from(self.positions[v as usize]))
                };
                let quad = if distance(p, c) < distance(a, q) {
                    [[a, p, c], [p, q, c]]
                } else {
                    [[a, p, q], [a, q, c]]
                };
                vec![[p, b, q], quad[0], quad[1]]
            }
        }
    }
}

fn unknown(sides: &[Membership]) -> impl Iterator<Item = u32> {
    let open = |(_, side): &(usize, &Membership)| **side == Membership::Unknown;
    sides.iter().enumerate().filter(open).map(|(p, _)| p as u32)
}
