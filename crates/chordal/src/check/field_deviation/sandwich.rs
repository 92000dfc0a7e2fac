//! `Sandwich`: two displaced copies of a mesh, one outside of a field's surface, one inside.
//!
//! **Lemma (sandwich).** Let A = {F < 0}, A* the interior of its closure, B* the interior of its complement,
//! and S the rest of space, the boundary of A*: the field's surface with cracks closed. Let M be a closed
//! oriented triangle mesh, M⁺ and M⁻ copies of it whose vertices are displaced by t at most. If
//! 1. M⁺ lies in B* and M⁻ in A*,
//! 2. each component of A* holds a point around which M⁺ winds once, and each of B* one around which M⁻ does
//!    not wind,
//!
//! then every point of a face of M has a point of S within the largest displacement of the face's corners,
//! and every point of S has one of M within t.
//!
//! *Proof.* Displacements are linear over a face, so no point's is longer than the longest of its corners'.
//! From a point of M⁻ in A* to that of M in between to that of M⁺ in B* run two segments; together they are
//! connected, A* and B* are open and have no point in common, so they meet S, on one of the two, within its
//! length of M. For the other direction let p in S have no point of M within t. The straight motion M⁻ → M →
//! M⁺ misses p, by compactness it misses a ball around p, and so all three have the same winding number w
//! around each point of the ball. The ball meets A* and B*, as p is in the boundary of A*. M⁺ misses A*, so
//! its winding number is constant on components of A*, and w = 1; likewise M⁻ misses B*, and w = 0. ∎
//!
//! *Faces without area.* Nothing of this asks for faces with an area, nor that both copies come from the same
//! triangles: each may be of a mesh of its own, which is M with vertices in several places, joined by faces without
//! area ([`super::copy_mesh`]). As chains these meshes are M, and the motion to either copy is within t of it. So a
//! vertex whose faces have no common displacement is an edge or a polygon of the copy.
//!
//! M need not be embedded, and neither need its copies. [`super::face_sides`] proves on which faces the first
//! condition holds. Vertices of the copies are f64 numbers, taken exactly; lengths of displacements are
//! rounded up. The displacements are a guess ([`super::displacement`]): as short as the samples allow plus a
//! margin, which grows if the proof needs it.
use super::copy_mesh::CopyMesh;
use super::displacement::{
    DisplacementNormals, FaceConstraint, FaceConstraints, HalfSpace, MaxDisplacement, deviations,
    face_constraints, shortest_displacement,
};
use super::face_side_cache::FaceSide;
use super::face_sides::{MOST_CUTS, SideQuery, classify_sides};
use super::regions::SignRegions;
use super::vertex_places::{FaceCorner, VertexPlaces, convexity, places, ring};
use crate::explicit::{Mesh, Topology};
use crate::implicit::{LeafError, Membership, PrimitiveEvaluator};
use crate::math::{Box3, greater, length, length_up, lesser};
use std::collections::BTreeMap;
use std::rc::Rc;

/// The required sides of the copies.
pub(super) const SIDES: [Membership; 2] = [Membership::Outside, Membership::Inside];

/// Two displaced copies of a mesh.
#[derive(Clone, Debug)]
pub(super) struct Sandwich {
    /// The copies, by side.
    pub copies: [Mesh; 2],
    /// Faces that are not proved to be on the required side, ascending.
    pub open: [Vec<u32>; 2],
    /// By face: the largest displacement of its corners to either side.
    pub bounds: Vec<f64>,
}

/// The goal of a sandwich.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SandwichGoal {
    /// The largest displacement allowed.
    pub limit: Option<f64>,
    /// The first margin as a share of the displacement that samples require.
    pub margin: f64,
    /// The first margin's minimum as a share of the limit.
    pub least_share: f64,
    /// Whether open faces suffice as a result, for a caller that splits them: cells between the copies are
    /// examined only if both copies are proved.
    pub faces_first: bool,
}

impl SandwichGoal {
    /// A small margin. Chosen: pieces of flat faces are settled at once, and bounds of flat parts are small.
    const CLOSE: f64 = 1.0 / 64.0;
    /// A large margin. Chosen: it leaves space between the copies for cells that nothing else settles.
    const WIDE: f64 = 0.25;

    pub fn new(limit: Option<f64>, margin: f64) -> Self {
        Self { limit, margin, least_share: Self::CLOSE, faces_first: false }
    }

    /// The same goal, for a caller that splits open faces.
    pub fn faces_first(self) -> Self {
        Self { faces_first: true, ..self }
    }

    /// The same goal with copies farther apart, if that is allowed.
    pub(super) fn wider(&self) -> Option<Self> {
        let may_be = self.limit.is_some() && self.least_share < Self::WIDE;
        may_be.then_some(Self { least_share: Self::WIDE, ..*self })
    }
}

/// The most rounds: margins grow to 4⁶ times their first size.
const ROUNDS: usize = 4;
/// The most attempts: if faces are still open after the rounds, displacements are chosen again with a larger
/// maximum.
const ATTEMPTS: usize = 3;
/// With more open faces than this, and more than one in [`FEW`], success is unlikely. Measured: 4,400 of
/// 21,000 where letters are cut into parts that abut; one of ten on shells that are proved in the end.
const MANY: usize = 1024;
const FEW: usize = 8;
/// The factor of that larger maximum. Chosen: as much as margins grow in the rounds.
const FARTHER: f64 = 16.0;
/// The factor by which a margin grows if the proof fails. Chosen: two bisections reduce |f − L| on pieces
/// to a quarter.
const GROWTH: f64 = 4.0;
/// The least margin relative to the largest coordinate, 2⁻⁴⁴: some hundred roundings.
const LEAST_SHARE: f64 = 256.0 * f64::EPSILON;
/// After a first failure a margin is at least this share of the face. Derived from the number of rounds
/// alone: it can grow to the face's size.
const FACE_SHARE: f64 = 1.0 / 4096.0;
/// Displacements are at most this share of a limit, so that their lengths rounded up are within it.
const REACH: f64 = 1.0 - 1.0 / (1 << 20) as f64;
/// A displacement may exceed the required one by this multiple of the allowance. Chosen: more than 1,
/// since it may be at an angle to the gradient that has to be followed.
const ALLOWED: f64 = 1.25;
/// Bisections in the search for the largest margin within a limit.
const HALVINGS: usize = 12;
/// Bisections of a face in the first round, and in later ones. Measured: where strokes of letters meet at 10
/// degrees, pieces of a 64th of a face, which take 12, are still too large.
const CUTS: [u32; 2] = [9, MOST_CUTS];

/// Whether so large a part of the faces is open that a proof is unlikely.
pub(crate) fn is_hopeless(n_open: usize, n_all: usize) -> bool {
    n_open > MANY && FEW * n_open > n_all
}

/// The margin of a vertex on one side.
#[derive(Clone, Copy, Debug)]
struct VertexMargin {
    /// The length by which its displacement may exceed the one that samples require.
    allowance: f64,
    /// Whether no longer displacement is allowed.
    is_at_limit: bool,
}

struct VertexDisplacement {
    by: [f64; 3],
    /// Whether no longer displacement is allowed.
    is_at_limit: bool,
    /// Whether it is longer than the one that samples require.
    has_margin: bool,
}

/// A closed mesh, and the vertices in it that move together.
#[derive(Clone, Debug)]
pub(super) struct ClosedMesh<'a> {
    mesh: &'a Mesh,
    /// By vertex: the first vertex to which it is tied.
    ids: Vec<u32>,
}

impl<'a> ClosedMesh<'a> {
    /// Ties vertices by index if the mesh is closed that way, since vertices of two parts that touch need not
    /// move together; otherwise by position. `None` if it is closed in neither way.
    pub fn from_mesh(mesh: &'a Mesh) -> Option<Self> {
        let n = mesh.positions().len() as u32;
        let by_index = || Some((0..n).collect::<Vec<u32>>());
        let by_position = || Topology::Positions.ids(mesh).map(|ids| ids.to_vec());
        let tied = |ids: Vec<u32>| Self { mesh, ids };
        by_index().map(tied).filter(Self::is_cycle).or_else(|| by_position().map(tied).filter(Self::is_cycle))
    }

    fn is_cycle(&self) -> bool {
        is_cycle(self.mesh.faces(), &self.ids)
    }
}

/// Whether the boundaries of all triangles cancel out.
fn is_cycle(faces: &[[u32; 3]], ids: &[u32]) -> bool {
    let mut sides: Vec<([u32; 2], i32)> = Vec::with_capacity(3 * faces.len());
    for face in faces {
        for k in 0..3 {
            let (a, b) = (ids[face[k] as usize], ids[face[(k + 1) % 3] as usize]);
            // A side between two rows of one vertex is no side, and a triangle with such a side
            // runs along the remaining one in both directions.
            if a != b {
                sides.push(if a < b { ([a, b], 1) } else { ([b, a], -1) });
            }
        }
    }
    sides.sort_unstable();
    sides.chunk_by(|a, b| a.0 == b.0).all(|edge| edge.iter().map(|(_, way)| way).sum::<i32>() == 0)
}

impl Sandwich {
    pub fn build(
        regions: &mut SignRegions,
        evaluator: &mut PrimitiveEvaluator,
        tied: &ClosedMesh,
        goal: &SandwichGoal,
    ) -> Result<Self, LeafError> {
        let ClosedMesh { mesh, ids } = tied;
        let triangles = Rc::new(CopyMesh::new(mesh, ids));
        let mut max_displacements =
            max_displacements(mesh, &triangles, &deviations(regions, evaluator, mesh)?);
        let copies = [0, 1].map(|_| CopyBuilder::new(Rc::clone(&triangles)));
        let mut builder = SandwichBuilder { mesh, ids, constraints: Default::default(), goal, copies };
        let mut open: [Vec<u32>; 2] = [0, 1].map(|_| (0..mesh.faces().len() as u32).collect());
        for attempt in 0..ATTEMPTS {
            let is_limited = |distance: f64| goal.limit.is_some_and(|limit| distance >= limit);
            let most = goal.limit.unwrap_or(f64::MAX);
            max_displacements
                .iter_mut()
                .for_each(|displacement| displacement.now = lesser(displacement.now, most));
            let ways =
                if attempt == 0 { DisplacementNormals::Vertex } else { DisplacementNormals::VertexAndFace };
            builder.constraints = face_constraints(regions, evaluator, mesh, &max_displacements, ways)?;
            builder.start(&open);
            for (side, open) in open.iter_mut().enumerate() {
                *open = builder.close(side, open, regions, evaluator)?;
            }
            let still: Vec<u32> = builder.own_faces(&open).concat();
            // A caller that splits faces can make more progress by splitting them now.
            let is_enough = goal.faces_first && is_hopeless(still.len(), mesh.faces().len());
            if is_enough
                || evaluator.is_over()
                || still.iter().all(|face| is_limited(max_displacements[*face as usize].now))
            {
                break;
            }
            max_displacements.iter_mut().for_each(|displacement| displacement.now *= FARTHER);
        }
        let (bounds, open) = (builder.bounds(), builder.own_faces(&open));
        Ok(Self { copies: builder.copies.map(CopyBuilder::into_mesh), open, bounds })
    }
}

/// One of the copies, in progress.
struct CopyBuilder {
    triangles: Rc<CopyMesh>,
    displaced: Vec<[f64; 3]>,
    margins: Vec<VertexMargin>,
    /// The places of the vertices that have several, by id.
    places: BTreeMap<u32, VertexPlaces>,
    is_open: Vec<bool>,
}

impl CopyBuilder {
    fn new(triangles: Rc<CopyMesh>) -> Self {
        let (n_vertices, n_faces) = (triangles.positions.len(), triangles.faces.len());
        let none = VertexMargin { allowance: 0.0, is_at_limit: false };
        Self {
            displaced: triangles.positions.clone(),
            triangles,
            margins: vec![none; n_vertices],
            places: BTreeMap::new(),
            is_open: vec![false; n_faces],
        }
    }

    /// Copies the displacement of a position to all its rows.
    fn spread(&mut self) {
        for (row, id) in self.triangles.ids.iter().enumerate() {
            self.displaced[row] = self.displaced[*id as usize];
        }
    }

    fn open(&self) -> Vec<u32> {
        (0..self.is_open.len() as u32).filter(|face| self.is_open[*face as usize]).collect()
    }

    /// The copy, without faces that have two corners at one point, whose boundary is 0.
    fn into_mesh(self) -> Mesh {
        let at = |v: u32| self.displaced[v as usize];
        let is_face = |[a, b, c]: &[u32; 3]| at(*a) != at(*b) && at(*b) != at(*c) && at(*c) != at(*a);
        let n_mesh_faces = self.triangles.n_mesh_faces();
        let (mesh_faces, added) = self.triangles.faces.split_at(n_mesh_faces);
        let faces = mesh_faces.iter().chain(added.iter().filter(|face| is_face(face))).copied().collect();
        Mesh::new(self.displaced, faces).expect("displacements are finite")
    }
}

struct SandwichBuilder<'a> {
    mesh: &'a Mesh,
    ids: &'a [u32],
    constraints: [FaceConstraints; 2],
    goal: &'a SandwichGoal,
    copies: [CopyBuilder; 2],
}

impl SandwichBuilder<'_> {
    /// Sets the first margins of the vertices of open faces.
    fn start(&mut self, open: &[Vec<u32>; 2]) {
        for (side, open) in open.iter().enumerate() {
            for v in self.copies[side].triangles.vertices_of(open) {
                let allowance = self.first_allowance(v, side);
                self.copies[side].margins[v as usize] = VertexMargin { allowance, is_at_limit: false };
            }
        }
    }

    /// The faces of the mesh to which some faces of the copies belong, or beside which they are.
    fn own_faces(&self, open: &[Vec<u32>; 2]) -> [Vec<u32>; 2] {
        [0, 1].map(|side| {
            let mesh_face_of = |face: &u32| self.copies[side].triangles.mesh_face(*face);
            let mut mesh_faces: Vec<u32> = open[side].iter().map(mesh_face_of).collect();
            mesh_faces.sort_unstable();
            mesh_faces.dedup();
            mesh_faces
        })
    }

    fn first_allowance(&self, vertex: u32, side: usize) -> f64 {
        let triangles = &self.copies[side].triangles;
        let corners = triangles.corners_obeyed(vertex);
        let constraints = (0..2).flat_map(|side| self.constraints_of(corners, side));
        let lacks = constraints.map(|(constraint, corner)| constraint.deficits[corner]);
        let lack = lacks.fold(0.0, |most: f64, lack| greater(lack, most));
        let p = triangles.positions[vertex as usize];
        let largest = p.iter().fold(0.0, |most: f64, x| greater(x.abs(), most));
        let least = LEAST_SHARE * largest;
        let of_limit = self.goal.limit.map_or(0.0, |limit| self.goal.least_share * limit);
        self.goal.margin * lack + greater(of_limit, least)
    }

    /// The constraints of the faces at some corners, each with the number of the corner.
    fn constraints_of<'c>(
        &'c self,
        corners: &'c [FaceCorner],
        side: usize,
    ) -> impl Iterator<Item = (&'c FaceConstraint, usize)> {
        let constraints = &self.constraints[side];
        corners.iter().flat_map(move |(face, corner)| {
            constraints.of_face(*face).iter().map(move |constraint| (constraint, usize::from(*corner)))
        })
    }

    /// Displaces a vertex by its margin, or by as much of it as the limit allows.
    fn displace(&mut self, vertex: u32, side: usize) {
        let copy = &self.copies[side];
        let allowance = copy.margins[vertex as usize].allowance;
        let chosen = self.best_displacement(copy.triangles.corners_obeyed(vertex), side, allowance);
        let copy = &mut self.copies[side];
        copy.margins[vertex as usize].is_at_limit = chosen.is_at_limit;
        let p = copy.triangles.positions[vertex as usize];
        let q: [f64; 3] = std::array::from_fn(|k| p[k] + chosen.by[k]);
        copy.displaced[vertex as usize] = if q.iter().all(|x| x.is_finite()) { q } else { p };
    }

    /// The displacement for the constraints of some corners. If these contradict each other, only the
    /// constraints of primitives on which a face lies are kept: beyond those, other primitives decide.
    fn best_displacement(&self, corners: &[FaceCorner], side: usize, allowance: f64) -> VertexDisplacement {
        let constraints = self.constraints_of(corners, side);
        let half_spaces: Vec<HalfSpace> =
            constraints.map(|(constraint, corner)| constraint.of_corner(corner)).collect();
        let chosen = self.displacement(&half_spaces, allowance);
        if chosen.has_margin {
            return chosen;
        }
        let constraints = self.constraints_of(corners, side).filter(|(constraint, _)| constraint.is_on);
        let on_primitives: Vec<HalfSpace> =
            constraints.map(|(constraint, corner)| constraint.of_corner(corner)).collect();
        let by_primitives = self.displacement(&on_primitives, allowance);
        if by_primitives.has_margin { by_primitives } else { chosen }
    }

    fn displacement(&self, base: &[HalfSpace], allowance: f64) -> VertexDisplacement {
        // First the displacement that samples require, or the largest possible share of it; then the same
        // with a margin.
        let with = |lack: f64, margin: f64| {
            let raised = |c: &HalfSpace| if c.least > 0.0 { lack * c.least } else { c.least };
            let least = |c: &HalfSpace| raised(c) + c.share * margin;
            shortest_displacement(
                &base.iter().map(|c| HalfSpace { least: least(c), ..*c }).collect::<Vec<_>>(),
            )
        };
        let limit = self.goal.limit.map_or(f64::INFINITY, |limit| REACH * limit);
        let required = with(1.0, 0.0).filter(|d| length(*d) <= limit);
        let max_length = required.map_or(limit, |d| length(d) + ALLOWED * allowance);
        let is_at_limit = max_length >= limit;
        let max_length = if is_at_limit { limit } else { max_length };
        let largest = |at_share: &dyn Fn(f64) -> Option<[f64; 3]>| {
            let fits = |share: f64| at_share(share).filter(|d| length(*d) <= max_length);
            let (mut low, mut high, mut largest_fit) = (0.0, 1.0, fits(1.0));
            if largest_fit.is_none() {
                // Lengths need not grow evenly with the share, so the bisection may miss the
                // largest one that fits; any that fits will do, since the proof comes after it.
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (low + high);
                    match fits(middle) {
                        Some(d) => (low, largest_fit) = (middle, Some(d)),
                        None => high = middle,
                    }
                }
            }
            largest_fit
        };
        let with_margin = required.and_then(|_| largest(&|share| with(1.0, share * allowance)));
        let displacement = with_margin.or(required).or_else(|| largest(&|share| with(share, 0.0)));
        VertexDisplacement {
            by: displacement.unwrap_or([0.0; 3]),
            is_at_limit,
            has_margin: with_margin.is_some(),
        }
    }

    /// Displaces vertices until all faces are on the required side, or nothing helps; returns the open faces.
    fn close(
        &mut self,
        side: usize,
        open: &[u32],
        regions: &mut SignRegions,
        evaluator: &mut PrimitiveEvaluator,
    ) -> Result<Vec<u32>, LeafError> {
        let mut triangles = Rc::clone(&self.copies[side].triangles);
        let mut todo = triangles.vertices_of(open);
        for round in 0..ROUNDS {
            // Only faces around vertices that moved have to be proved again.
            todo.iter().for_each(|v| self.displace(*v, side));
            self.copies[side].spread();
            let mut faces_to_prove: Vec<u32> = todo.iter().flat_map(|v| triangles.faces_around(*v)).collect();
            faces_to_prove.sort_unstable();
            faces_to_prove.dedup();
            let faces: Vec<[u32; 3]> =
                faces_to_prove.iter().map(|face| triangles.faces[*face as usize]).collect();
            let cuts = CUTS[usize::from(round > 0)];
            let copy = &mut self.copies[side];
            let question = SideQuery { positions: &copy.displaced, faces: &faces, side: SIDES[side], cuts };
            let verdicts = classify_sides(regions, evaluator, &question)?;
            faces_to_prove
                .iter()
                .zip(verdicts)
                .for_each(|(face, verdict)| copy.is_open[*face as usize] = verdict != FaceSide::Proved);
            let open = copy.open();
            if open.is_empty() || round + 1 == ROUNDS || evaluator.is_over() {
                return Ok(open);
            }
            // Before margins grow: a vertex with several places needs only a little.
            let cut = if round == 0 { self.cut(side, &open) } else { None };
            todo = match cut {
                Some(faces_around) => {
                    triangles = Rc::clone(&self.copies[side].triangles);
                    triangles.vertices_of(&faces_around)
                }
                None => self.grow(&open, side),
            };
            if todo.is_empty() {
                return Ok(open);
            }
        }
        Ok(Vec::new())
    }

    /// Gives several places to the vertices of open faces that have no displacement. Returns the faces that
    /// have to be proved then, which are all of them; `None` if there are no such vertices.
    fn cut(&mut self, side: usize, open: &[u32]) -> Option<Vec<u32>> {
        if is_hopeless(open.len(), self.mesh.faces().len()) {
            return None;
        }
        let copy = &self.copies[side];
        let n_vertices = self.mesh.positions().len() as u32;
        let vertices = copy.triangles.vertices_of(open);
        let new_places: Vec<(u32, VertexPlaces)> = vertices
            .into_iter()
            .filter(|v| *v < n_vertices)
            .filter_map(|v| Some((v, self.places_of(v, side)?)))
            .collect();
        if new_places.is_empty() {
            return None;
        }
        let copy = &self.copies[side];
        let mut places = copy.places.clone();
        places.extend(new_places);
        let triangles = Rc::new(CopyMesh::with_places(self.mesh, self.ids, &places));
        // The added faces have to close the copy, since the lemma is about closed copies.
        if !is_cycle(&triangles.faces, &triangles.ids) {
            return None;
        }
        let (n_before, n) = (n_vertices as usize, triangles.positions.len());
        let mut next = CopyBuilder::new(Rc::clone(&triangles));
        next.displaced[..n_before].copy_from_slice(&copy.displaced[..n_before]);
        next.margins[..n_before].copy_from_slice(&copy.margins[..n_before]);
        next.places = places;
        self.copies[side] = next;
        for v in n_before..n {
            let allowance = self.first_allowance(v as u32, side);
            self.copies[side].margins[v].allowance = allowance;
        }
        // All vertices start anew, also those with places from an earlier cut, so that nothing counts as
        // proved before.
        Some((0..triangles.faces.len() as u32).collect())
    }

    /// The places of a vertex, if it has no single displacement.
    fn places_of(&self, vertex: u32, side: usize) -> Option<VertexPlaces> {
        let copy = &self.copies[side];
        // Vertices that were split once stay split.
        if copy.places.contains_key(&vertex) {
            return None;
        }
        let allowance = self.first_allowance(vertex, side);
        let fits = |corners: &[FaceCorner]| self.best_displacement(corners, side, allowance).has_margin;
        let corners = copy.triangles.corners_obeyed(vertex);
        if fits(corners) {
            return None;
        }
        let sign = if SIDES[side] == Membership::Outside { 1.0 } else { -1.0 };
        let rank = |before: FaceCorner, after: FaceCorner| sign * convexity(self.mesh, before, after);
        places(ring(self.mesh, self.ids, corners)?, fits, rank)
    }

    /// Enlarges the margins around open faces; returns the vertices that can still be moved.
    fn grow(&mut self, open: &[u32], side: usize) -> Vec<u32> {
        let mut todo: Vec<u32> = Vec::new();
        let copy = &mut self.copies[side];
        for face in open {
            let size = Box3::from_points(&copy.triangles.corners(*face)).diagonal();
            for v in copy.triangles.faces[*face as usize] {
                let v = copy.triangles.ids[v as usize];
                let margin = &mut copy.margins[v as usize];
                if margin.is_at_limit {
                    continue;
                }
                todo.push(v);
                margin.allowance = greater(FACE_SHARE * size, margin.allowance);
            }
        }
        todo.sort_unstable();
        todo.dedup();
        // Without duplicates, so that a vertex of several open faces grows only once.
        todo.iter().for_each(|v| copy.margins[*v as usize].allowance *= GROWTH);
        todo
    }

    fn bounds(&self) -> Vec<f64> {
        let displacement_of = |copy: &CopyBuilder, v: u32| {
            let (p, q) = (copy.triangles.positions[v as usize], copy.displaced[v as usize]);
            if p == q {
                0.0
            } else {
                length_up(std::array::from_fn::<_, 3, _>(|k| (q[k] - p[k]).abs().next_up()))
            }
        };
        let of_face = |face: usize| {
            let displacements = self
                .copies
                .each_ref()
                .map(|copy| copy.triangles.faces[face].map(|v| displacement_of(copy, v)));
            displacements.as_flattened().iter().fold(0.0, |most: f64, x| greater(*x, most))
        };
        (0..self.mesh.faces().len()).map(of_face).collect()
    }
}

/// By face: an estimate of the displacement that its corners need, twice the distance of any adjacent face
/// from the surface.
fn max_displacements(mesh: &Mesh, triangles: &CopyMesh, deviations: &[f64]) -> Vec<MaxDisplacement> {
    let n = mesh.positions().len() as u32;
    let of_vertex: Vec<f64> = (0..n)
        .map(|v| triangles.faces_around(v).fold(0.0, |most, face| greater(deviations[face as usize], most)))
        .collect();
    let of_face = |(number, face): (usize, &[u32; 3])| {
        let least = FACE_SHARE * Box3::from_points(&mesh.corners(number)).diagonal();
        let of_corner = |v: &u32| 2.0 * of_vertex[triangles.ids[*v as usize] as usize];
        let far = face.iter().fold(least, |most, v| greater(of_corner(v), most));
        MaxDisplacement { at_first: far, now: far }
    };
    mesh.faces().iter().enumerate().map(of_face).collect()
}
