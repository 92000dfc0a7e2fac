//! Cuts faces that several materials share along the borders of these.
//!
//! Where two parts meet at a crease, each face has one material already. Where they share a surface, such as the
//! tops of a plate and of an inlay, the border is where other primitives vanish; in a blend, where two
//! parts are as near. Faces there are bisected until
//! at most four of these cross each and run nearly straight, and are cut along them. New vertices lie on old
//! edges, so the surface stays where it is, but for rounding.
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

/// The most rounds of bisections. Derived: twice as many halve every edge of a face of a million lengths to one.
const MOST_ROUNDS: usize = 48;
/// A face is cut by at most so many functions; where more meet, it is bisected. Chosen: corners of borders have two or
/// three, and so few make at most sixteen parts.
const MOST_CUTS: usize = 4;
/// Vertices nearer to a border than this share of the length count as on it. Chosen: no slivers far below the length.
const SNAP: f64 = 1.0 / 64.0;
/// Every point of a face is nearer to a sample than this share of the longest edge. Derived: of an equilateral one a
/// sixth, of a flat one a quarter.
const REACH: f64 = 0.25;
/// Steps to the zero of a primitive on an edge. Chosen: it is nearly linear there.
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
/// The most that a vertex on an edge is off it, relative to the largest coordinate. Derived: three roundings of
/// numbers up to twice as large, along three axes.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// What is known about a face.
#[derive(Clone)]
enum FaceState {
    Settled(u32),
    /// By primitive: its membership all over the face.
    Open(Rc<Vec<Membership>>),
    /// To be cut by these primitives.
    Cut(Vec<u32>),
}

/// A mesh whose faces have materials.
pub(super) struct BorderedMesh {
    pub positions: Vec<[f64; 3]>,
    pub faces: Vec<[u32; 3]>,
    pub labels: Vec<FaceLabel>,
    /// By face: its material, or `None` where its middle decides.
    pub materials: Vec<Option<u32>>,
    /// How far the surface was moved at most.
    pub moved: f64,
}

/// Cuts the faces of a mesh with these labels, so that borders are within a length of the true ones.
pub(super) fn cut_at_borders(
    mesh: &Mesh,
    labels: Vec<FaceLabel>,
    own: &FaceMaterials,
    tol: f64,
) -> Result<BorderedMesh, LeafError> {
    let unknown = Rc::new(vec![Membership::Unknown; own.pairs.n_functions()]);
    let state = |label: &FaceLabel| match own.everywhere(*label) {
        MaterialChoice::One(number) => FaceState::Settled(number),
        _ => FaceState::Open(Rc::clone(&unknown)),
    };
    let states = labels.iter().map(state).collect();
    let functions = BorderFunctions::new(own.csg, &own.pairs, (&mesh.bounds(), own.job));
    let mut cutter = BorderCutter {
        own,
        functions,
        tol,
        positions: mesh.positions().to_vec(),
        faces: mesh.faces().to_vec(),
        labels,
        states,
        n_moves: 0,
    };
    for _ in 0..MOST_ROUNDS {
        let long = cutter.decide_open()?;
        let is_full = (cutter.faces.len() + long.len()) as u64 * 2 > own.job.triangle_limit;
        if long.is_empty() || is_full || own.job.is_cancelled() {
            break;
        }
        cutter.split(&long);
    }
    cutter.cut()?;
    let bounds = mesh.bounds();
    let largest = bounds.min.iter().chain(&bounds.max).fold(0.0, |most, x| greater(x.abs(), most));
    let material =
        |state: &FaceState| if let FaceState::Settled(number) = state { Some(*number) } else { None };
    Ok(BorderedMesh {
        materials: cutter.states.iter().map(material).collect(),
        moved: ROUNDING * largest * f64::from(cutter.n_moves),
        positions: cutter.positions,
        faces: cutter.faces,
        labels: cutter.labels,
    })
}

struct BorderCutter<'a> {
    own: &'a FaceMaterials<'a>,
    functions: BorderFunctions<'a>,
    tol: f64,
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    labels: Vec<FaceLabel>,
    states: Vec<FaceState>,
    /// How often vertices were added to edges.
    n_moves: u32,
}

/// An edge by its vertices, the smaller one first.
type EdgeKey = (u32, u32);

fn key(a: u32, b: u32) -> EdgeKey {
    (lesser(a, b), greater(a, b))
}

/// How a primitive runs over a face, by samples.
struct PrimitiveOnFace {
    /// Whether its zero set is straight within the length.
    is_straight: bool,
    /// Whether it passes through, and not only along the rim.
    crosses: bool,
    /// Its side in the middle.
    side: Membership,
}

impl BorderCutter<'_> {
    /// Settles open faces, or gives them their cuts. Returns the edges to bisect for the others.
    fn decide_open(&mut self) -> Result<BTreeMap<EdgeKey, f64>, LeafError> {
        let mut open: Vec<(usize, Vec<Membership>)> = Vec::new();
        let mut asks: Vec<(u32, Box3)> = Vec::new();
        for (face, state) in self.states.iter().enumerate() {
            let FaceState::Open(sides) = state else { continue };
            let bounds = Box3::from_points(&self.corners(face));
            asks.extend(unknown(sides).map(|p| (p, bounds)));
            open.push((face, sides.to_vec()));
        }
        let mut ranges = self.functions.ranges(&asks)?.into_iter();
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
        let mut left = Vec::new();
        for (face, sides) in open {
            match self.own.choice(self.labels[face], |p| sides[p as usize], None) {
                MaterialChoice::One(number) => self.states[face] = FaceState::Settled(number),
                _ => left.push((face, sides)),
            }
        }
        let samples = self.sample(&left)?;
        let mut long = BTreeMap::new();
        for ((face, sides), samples) in left.into_iter().zip(samples) {
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
            self.states[face] = match self.own.choice(self.labels[face], |p| by_samples[p as usize], None) {
                MaterialChoice::One(number) => FaceState::Settled(number),
                _ if n_bent == 0 && cuts.len() <= MOST_CUTS => FaceState::Cut(cuts),
                _ if edge.1 > self.tol => {
                    long.insert(edge.0, 0.5);
                    FaceState::Open(Rc::new(sides))
                }
                _ => FaceState::Cut(Vec::new()),
            };
        }
        Ok(long)
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
            let own = length(edge);
            best = if own > best.1 { (edge, own) } else { best };
        }
        best
    }

    /// For each face how its unknown primitives run over it.
    fn sample(&mut self, faces: &[(usize, Vec<Membership>)]) -> Result<Vec<Vec<PrimitiveOnFace>>, LeafError> {
        let (mut asks, mut middles) = (Vec::new(), Vec::new());
        for (face, sides) in faces {
            let corners = self.corners(*face).map(DVec3::from);
            let at = |[a, b, c]: [f64; 3]| (a * corners[0] + b * corners[1] + c * corners[2]).to_array();
            for p in unknown(sides) {
                asks.extend(SAMPLES.map(|shares| (p, at(shares))));
                middles.push((p, at(SAMPLES[6])));
            }
        }
        let values = self.functions.values(&asks)?;
        let slopes = self.functions.duals(&middles)?;
        let mut rows = values.chunks_exact(SAMPLES.len()).zip(slopes);
        let mut all = Vec::new();
        for (face, sides) in faces {
            let [a, b, c] = self.corners(*face).map(DVec3::from);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let longest = self.longest_edge(*face).1;
            let of = |(values, slope): (&[f64], Dual<f64>)| {
                let slope = DVec3::from(slope.gradient);
                let along = (slope - slope.dot(normal) * normal).length();
                // How far zeros are from where they would be if it were linear between the corners.
                let linear = |[a, b, c]: [f64; 3]| a * values[0] + b * values[1] + c * values[2];
                let bent = SAMPLES.iter().zip(values).map(|(shares, value)| (value - linear(*shares)).abs());
                let bent = bent.fold(0.0, |most, x| greater(x, most));
                let clear = SNAP * self.tol * along;
                // Farther from 0 than it bends, and than it changes on the way to the nearest sample.
                let near = greater(bent, REACH * longest * slope.length());
                let is_clear = values.iter().all(|x| *x > near) || values.iter().all(|x| *x < -near);
                PrimitiveOnFace {
                    is_straight: is_clear || bent <= self.tol * along,
                    crosses: values[..3].iter().any(|x| *x > clear)
                        && values[..3].iter().any(|x| *x < -clear),
                    side: Membership::from_value(values[6]),
                }
            };
            all.push(unknown(sides).map(|_| of(rows.next().expect("one for each query"))).collect());
        }
        Ok(all)
    }

    /// Cuts faces along their primitives, one after the other.
    fn cut(&mut self) -> Result<(), LeafError> {
        let pending =
            |state: &FaceState| if let FaceState::Cut(list) = state { list.clone() } else { Vec::new() };
        let all: BTreeSet<u32> = self.states.iter().flat_map(pending).collect();
        for p in all {
            let mut edges: BTreeMap<EdgeKey, f64> = BTreeMap::new();
            for (face, state) in self.states.iter().enumerate() {
                if matches!(state, FaceState::Cut(list) if list.contains(&p)) {
                    let [a, b, c] = self.faces[face];
                    edges.extend([key(a, b), key(b, c), key(c, a)].map(|edge| (edge, 0.5)));
                }
            }
            let zeros = self.zeros(p, edges.into_keys().collect())?;
            self.split(&zeros);
        }
        Ok(())
    }

    /// Where a primitive vanishes on edges, as shares of them from their first vertex; none at or near a vertex.
    fn zeros(&mut self, p: u32, edges: Vec<EdgeKey>) -> Result<BTreeMap<EdgeKey, f64>, LeafError> {
        let place = |positions: &[[f64; 3]], (a, b): EdgeKey, share: f64| {
            let [a, b] = [a, b].map(|v| DVec3::from(positions[v as usize]));
            (a + share * (b - a)).to_array()
        };
        let ends: Vec<(u32, [f64; 3])> = edges
            .iter()
            .flat_map(|edge| [0.0, 1.0].map(|end| (p, place(&self.positions, *edge, end))))
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
        // The Illinois method: of an end that stays, half of the value counts.
        let mut last = vec![2_usize; brackets.len()];
        for _ in 0..STEPS {
            let asks: Vec<(u32, [f64; 3])> = brackets
                .iter()
                .map(|(edge, x, f)| (p, place(&self.positions, *edge, share(*x, *f))))
                .collect();
            let values = self.functions.values(&asks)?;
            for (((_, x, f), value), last) in brackets.iter_mut().zip(values).zip(&mut last) {
                let at = share(*x, *f);
                let end = usize::from((value < 0.0) != (f[0] < 0.0));
                (x[end], f[end]) = (at, value);
                if *last == end {
                    f[1 - end] *= 0.5;
                }
                *last = end;
            }
        }
        let mut on: BTreeSet<u32> = BTreeSet::new();
        let mut zeros = BTreeMap::new();
        for ((a, b), x, f) in brackets {
            let at = share(x, f);
            let length =
                DVec3::from(self.positions[a as usize]).distance(DVec3::from(self.positions[b as usize]));
            let near = SNAP * self.tol;
            on.extend((at * length <= near).then_some(a));
            on.extend(((1.0 - at) * length <= near).then_some(b));
            zeros.insert((a, b), at);
        }
        zeros.retain(|(a, b), _| !on.contains(a) && !on.contains(b));
        Ok(zeros)
    }

    /// Adds vertices on edges, and splits all faces there.
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
            let on = [0, 1, 2].map(|k| added.get(&key(corners[k], corners[(k + 1) % 3])).copied());
            let parts = self.parts(corners, on);
            self.faces[face] = parts[0];
            for part in &parts[1..] {
                self.faces.push(*part);
                self.labels.push(self.labels[face]);
                self.states.push(self.states[face].clone());
            }
        }
    }

    /// The triangles of a face with vertices on some of its edges, of which each starts at the corner of its index.
    fn parts(&self, corners: [u32; 3], on: [Option<u32>; 3]) -> Vec<[u32; 3]> {
        let turned = |k: usize| [0, 1, 2].map(|i| corners[(i + k) % 3]);
        match on {
            [None, None, None] => vec![corners],
            [Some(p), Some(q), Some(r)] => {
                let [a, b, c] = corners;
                vec![[a, p, r], [p, b, q], [q, c, r], [p, q, r]]
            }
            _ => {
                // From the edge after one without a vertex on.
                let first = (0..3).find(|k| on[*k].is_some() && on[(*k + 2) % 3].is_none()).unwrap_or(0);
                let [a, b, c] = turned(first);
                let p = on[first].unwrap_or(a);
                let Some(q) = on[(first + 1) % 3] else { return vec![[a, p, c], [p, b, c]] };
                let apart = |u: u32, v: u32| {
                    DVec3::from(self.positions[u as usize]).distance(DVec3::from(self.positions[v as usize]))
                };
                let rest =
                    if apart(p, c) < apart(a, q) { [[a, p, c], [p, q, c]] } else { [[a, p, q], [a, q, c]] };
                vec![[p, b, q], rest[0], rest[1]]
            }
        }
    }
}

fn unknown(sides: &[Membership]) -> impl Iterator<Item = u32> {
    let open = |(_, side): &(usize, &Membership)| **side == Membership::Unknown;
    sides.iter().enumerate().filter(open).map(|(p, _)| p as u32)
}
