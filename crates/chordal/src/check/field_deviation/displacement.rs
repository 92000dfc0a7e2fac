//! Heuristic displacements that move the vertices of a mesh to one side of a field's surface, from samples.
//! On each face, every primitive that decides its sign is replaced at sample points by its distance,
//! value / |gradient|. To put an intersection outside, one operand suffices (the nearest to it); for a union,
//! all are needed. A primitive to be raised gets, at each corner, its deficit there plus how far the plane
//! through the corners rises above its samples. Displacements are linear over a face, so then it is above 0
//! at all samples.
//!
//! Nothing is proved here, and nothing need be: the signs on the displaced faces are proved for any
//! displacements.
use super::local_trees::{LocalTree, LocalTrees, MOST_CASES};
use super::regions::SignRegions;
use crate::explicit::Mesh;
use crate::implicit::{CsgNode, Dual, LeafError, PrimitiveEvaluator};
use crate::math::{Box3, cross, difference, dot, greater, length, lesser};
use std::ops::Range;

/// The largest displacement that a face's corners are assumed to need.
#[derive(Clone, Copy, Debug)]
pub(super) struct MaxDisplacement {
    /// As far as samples require. The face lies on a primitive if that is at most this far from it
    /// throughout.
    pub at_first: f64,
    /// In the current attempt.
    pub now: f64,
}

/// A constraint of a face on its corners: `direction · displacement ≥ deficit + share · margin` at each.
#[derive(Clone, Copy, Debug)]
pub(super) struct FaceConstraint {
    pub directions: [[f64; 3]; 3],
    pub deficits: [f64; 3],
    /// 1 if the primitive is near, 0 if it is as far as the largest displacement.
    pub shares: [f64; 3],
    /// Whether the face lies on the primitive; otherwise it is only near it.
    pub is_on: bool,
}

impl FaceConstraint {
    /// The constraint on one corner.
    pub fn of_corner(&self, corner: usize) -> HalfSpace {
        HalfSpace {
            direction: self.directions[corner],
            least: self.deficits[corner],
            share: self.shares[corner],
        }
    }
}

/// The constraints of all faces for one side.
#[derive(Clone, Debug, Default)]
pub(super) struct FaceConstraints {
    constraints: Vec<FaceConstraint>,
    /// The start of each face's constraints; one more entry than faces.
    starts: Vec<u32>,
}

impl FaceConstraints {
    pub fn of_face(&self, face: u32) -> &[FaceConstraint] {
        &self.constraints[self.starts[face as usize] as usize..self.starts[face as usize + 1] as usize]
    }
}

/// Barycentric coordinates of the samples: the corners; points beside them, for gradients, since primitives
/// may have a kink at a vertex; points beside the midpoints of the sides; and the centroid.
const BESIDE: f64 = 1.0 / 16.0;
const SAMPLES: [[f64; 3]; 10] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0 - 2.0 * BESIDE, BESIDE, BESIDE],
    [BESIDE, 1.0 - 2.0 * BESIDE, BESIDE],
    [BESIDE, BESIDE, 1.0 - 2.0 * BESIDE],
    [0.5 - BESIDE, 0.5 - BESIDE, 2.0 * BESIDE],
    [2.0 * BESIDE, 0.5 - BESIDE, 0.5 - BESIDE],
    [0.5 - BESIDE, 2.0 * BESIDE, 0.5 - BESIDE],
    [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
];

/// Faces sampled at once: some megabytes for each deciding primitive.
const FACES_AT_ONCE: usize = 1 << 12;

/// The faces of a mesh in batches, in order.
fn parts(mesh: &Mesh) -> impl Iterator<Item = Range<usize>> {
    let n = mesh.faces().len();
    (0..n).step_by(FACES_AT_ONCE).map(move |first| first..(first + FACES_AT_ONCE).min(n))
}

/// The primitives at the samples of some faces.
struct FaceSamples {
    first: usize,
    /// By face: the index of its tree; `None` for faces whose side is already decided.
    trees: Vec<Option<u32>>,
    slopes: Vec<Dual<f64>>,
    /// The start of each face's slopes.
    starts: Vec<usize>,
}

impl FaceSamples {
    /// Samples some faces, each with the primitives that decide within a distance of it.
    fn from_faces(
        regions: &mut SignRegions,
        evaluator: &mut PrimitiveEvaluator,
        mesh: &Mesh,
        faces: Range<usize>,
        band: impl Fn(usize) -> f64,
    ) -> Result<Self, LeafError> {
        let first = faces.start;
        let boxes: Vec<Box3> = faces.map(|face| inflated(&mesh.corners(face), band(face))).collect();
        let trees: Vec<Option<u32>> =
            regions.trees_of(evaluator, &boxes)?.into_iter().map(Result::ok).collect();
        let mut queries = Vec::new();
        let mut starts = Vec::with_capacity(trees.len());
        for (index, tree) in trees.iter().enumerate() {
            starts.push(queries.len());
            let Some(tree) = tree else { continue };
            let corners = mesh.corners(first + index);
            for p in &regions.trees.get(*tree).primitives {
                queries.extend(SAMPLES.map(|weights| (*p, weighted_mean(&corners, &weights))));
            }
        }
        let slopes = evaluator.duals(&queries)?;
        Ok(Self { first, trees, slopes, starts })
    }

    /// The faces with their samples.
    fn faces<'s>(&'s self, trees: &'s LocalTrees) -> impl Iterator<Item = (usize, Option<SampledFace<'s>>)> {
        self.trees.iter().zip(&self.starts).enumerate().map(move |(index, (tree, start))| {
            let sampled = |tree: &u32| {
                let local = trees.get(*tree);
                let slopes = &self.slopes[*start..][..local.primitives.len() * SAMPLES.len()];
                SampledFace { local, slopes }
            };
            (self.first + index, tree.as_ref().map(sampled))
        })
    }
}

/// The primitives that decide about a face, at its samples.
struct SampledFace<'s> {
    local: &'s LocalTree,
    slopes: &'s [Dual<f64>],
}

/// By face: its approximate distance from the surface.
pub(super) fn deviations(
    regions: &mut SignRegions,
    evaluator: &mut PrimitiveEvaluator,
    mesh: &Mesh,
) -> Result<Vec<f64>, LeafError> {
    let mut deviations = Vec::with_capacity(mesh.faces().len());
    for part in parts(mesh) {
        let samples = FaceSamples::from_faces(regions, evaluator, mesh, part, |_| 0.0)?;
        for (face, sampled) in samples.faces(&regions.trees) {
            let Some(SampledFace { local, slopes }) = sampled else {
                deviations.push(longest(&mesh.corners(face)));
                continue;
            };
            let value = |p: u32, sample: usize| distance(&slopes[local.index_of(p) * SAMPLES.len() + sample]);
            let distances = (0..SAMPLES.len()).map(|sample| local.tree.value(|p| value(p, sample)).abs());
            deviations.push(distances.fold(0.0, |most: f64, distance| greater(distance, most)));
        }
    }
    Ok(deviations)
}

/// The assumed displacement directions of a mesh: raising a primitive across all of them is avoided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DisplacementNormals {
    /// The vertex normals of a face's corners.
    Vertex,
    /// Also the normal of the face itself, which differs if the vertex normals turn back about a narrow
    /// notch.
    VertexAndFace,
}

/// The constraints of the faces of a mesh to be outside, and to be inside, for the largest displacement of
/// each face. Primitives farther than twice that are assumed to stay on their side.
pub(super) fn face_constraints(
    regions: &mut SignRegions,
    evaluator: &mut PrimitiveEvaluator,
    mesh: &Mesh,
    max_displacements: &[MaxDisplacement],
    directions: DisplacementNormals,
) -> Result<[FaceConstraints; 2], LeafError> {
    let band = |face: usize| 2.0 * max_displacements[face].now;
    let normals = normals(mesh);
    let mut constraints_by_side = [FaceConstraints::default(), FaceConstraints::default()];
    for part in parts(mesh) {
        let samples = FaceSamples::from_faces(regions, evaluator, mesh, part, band)?;
        for (face, sampled) in samples.faces(&regions.trees) {
            // For every face, also those without samples: the constraints of face k are between
            // entries k and k + 1.
            constraints_by_side.iter_mut().for_each(|face_constraints| {
                face_constraints.starts.push(face_constraints.constraints.len() as u32)
            });
            let Some(SampledFace { local, slopes }) = sampled else { continue };
            let distances: Vec<f64> = slopes.iter().map(distance).collect();
            let vertex_normal = sum(mesh.faces()[face].map(|v| normals[v as usize]));
            let directions = match directions {
                DisplacementNormals::Vertex => [vertex_normal; 2],
                DisplacementNormals::VertexAndFace => [vertex_normal, normal(&mesh.corners(face))],
            };
            for (side, face_constraints) in constraints_by_side.iter_mut().enumerate() {
                // To be inside is to be outside the complement.
                let outward = directions.map(|d| if side == 1 { d.map(|x| -x) } else { d });
                let of_face =
                    FaceDistances { local, slopes, distances: &distances, outward, band: band(face) };
                let raised = of_face.raised_literals(side == 1);
                let constraint =
                    |literal| face_constraint(slopes, &distances, literal, &max_displacements[face]);
                face_constraints.constraints.extend(raised.iter().filter_map(constraint));
            }
        }
    }
    constraints_by_side
        .iter_mut()
        .for_each(|face_constraints| face_constraints.starts.push(face_constraints.constraints.len() as u32));
    Ok(constraints_by_side)
}

/// The approximate distance of a sample from a primitive, with the sign of its value.
fn distance(slope: &Dual<f64>) -> f64 {
    let distance = slope.value / length(slope.gradient);
    if distance.is_finite() { distance } else { f64::INFINITY.copysign(slope.value) }
}

/// A primitive that has to be raised, or lowered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct RaisedLiteral {
    /// The index of the primitive in the local tree.
    index: u32,
    is_complement: bool,
    /// A bit mask of the samples.
    samples: u16,
}

/// A node's values at the samples, and the literals that have to be raised for it.
struct NodeSamples {
    values: [f64; SAMPLES.len()],
    literals: Vec<RaisedLiteral>,
    /// Whether some of them are raised across the direction of displacement.
    is_across: bool,
}

/// A primitive is raised across the normal of the mesh if its gradient has a smaller cosine with it.
const ACROSS: f64 = 0.3;
/// A primitive that is raised across is penalised by this share of a band. Chosen: without it the constraint
/// of one face may be opposite to that of the next, as on both sides of a face that two solids share.
const DETOUR: f64 = 0.25;

impl NodeSamples {
    /// The least value except at the corners: there several primitives may be equal, most of which have nothing
    /// to do with the face.
    fn least(&self) -> f64 {
        self.values[3..].iter().fold(f64::INFINITY, |a, b| lesser(*b, a))
    }

    /// A node that is on the required side everywhere, or nowhere.
    fn constant(is_there: bool) -> Self {
        let value = if is_there { f64::INFINITY } else { f64::NEG_INFINITY };
        Self { values: [value; SAMPLES.len()], literals: Vec::new(), is_across: false }
    }

    /// Both operands are required.
    fn and(mut self, other: Self) -> Self {
        self.values.iter_mut().zip(other.values).for_each(|(a, b)| *a = lesser(b, *a));
        self.literals.extend(other.literals);
        self.is_across |= other.is_across;
        self
    }

    /// Of several operands the one with the least deficit; if that is more than can be raised, the largest
    /// one at each sample.
    fn any_of(mut operands: Vec<Self>, band: f64) -> Self {
        let rank = |operand: &Self| {
            if operand.is_across { operand.least() - DETOUR * band } else { operand.least() }
        };
        let best = (0..operands.len())
            .reduce(|a, b| if rank(&operands[b]) > rank(&operands[a]) { b } else { a })
            .expect("an operator has operands");
        if operands[best].least() >= -band {
            return operands.swap_remove(best);
        }
        let largest: [usize; SAMPLES.len()] = std::array::from_fn(|k| {
            let value = |i: usize| operands[i].values[k];
            (0..operands.len()).fold(0, |a, b| if value(b) > value(a) { b } else { a })
        });
        let values = std::array::from_fn(|k| operands[largest[k]].values[k]);
        let is_across = operands.iter().any(|operand| operand.is_across);
        let mut literals = Vec::new();
        for (number, operand) in operands.into_iter().enumerate() {
            // A literal counts at the samples where its operand is the largest.
            let own_samples =
                (0..SAMPLES.len()).filter(|k| largest[*k] == number).fold(0, |all, k| all | 1 << k);
            let kept_literals = operand
                .literals
                .into_iter()
                .map(|literal| RaisedLiteral { samples: literal.samples & own_samples, ..literal });
            literals.extend(kept_literals.filter(|literal| literal.samples != 0));
        }
        Self { values, literals, is_across }
    }
}

/// The primitives about a face at its samples.
struct FaceDistances<'a> {
    local: &'a LocalTree,
    slopes: &'a [Dual<f64>],
    distances: &'a [f64],
    /// The directions in which the mesh may be displaced here; of any length.
    outward: [[f64; 3]; 2],
    band: f64,
}

impl FaceDistances<'_> {
    /// The literals that have to be on a side for the whole face. Being inside means that the complement is
    /// outside, so `inward` flips all signs, and swaps unions and intersections. To put an intersection
    /// outside, the operand with the least deficit is raised.
    ///
    /// Where two solids share a face, each of them alone would keep the face on one side of the shared
    /// primitive. If the face is on the required side in all cases of that primitive, the primitive puts no
    /// constraint on it ([`LocalTree`]).
    fn raised_literals(&self, inward: bool) -> Vec<RaisedLiteral> {
        let mixed: Vec<u32> = self.local.mixed().filter(|p| self.is_near(*p)).collect();
        let plain = self.of_tree(|p, is_complement| self.literal(p, is_complement), inward);
        let required = if mixed.is_empty() || mixed.len() > MOST_CASES {
            plain
        } else {
            let of_case = |case: u32| {
                let literal = |p: u32, is_complement: bool| match mixed.iter().position(|q| *q == p) {
                    Some(bit) => NodeSamples::constant((case >> bit & 1 == 1) != is_complement),
                    None => self.literal(p, is_complement),
                };
                self.of_tree(literal, inward)
            };
            let in_all =
                (0..1 << mixed.len()).map(of_case).reduce(NodeSamples::and).expect("there is a case");
            let least = in_all.least();
            if least >= -self.band && least + DETOUR * self.band >= plain.least() {
                in_all
            } else {
                NodeSamples::any_of(vec![in_all, plain], self.band)
            }
        };
        let mut literals = required.literals;
        literals.sort_unstable();
        literals.dedup_by(|next, kept| {
            let is_same = next.index == kept.index && next.is_complement == kept.is_complement;
            kept.samples |= if is_same { next.samples } else { 0 };
            is_same
        });
        literals
    }

    fn of_tree(&self, literal: impl Fn(u32, bool) -> NodeSamples, inward: bool) -> NodeSamples {
        let mut stack: Vec<NodeSamples> = Vec::new();
        for node in self.local.tree.nodes() {
            let result = match *node {
                CsgNode::Primitive(p) | CsgNode::Complement(p) => {
                    literal(p, matches!(node, CsgNode::Complement(_)) != inward)
                }
                CsgNode::Union(n) | CsgNode::Intersection(n) => {
                    // Nodes are in postfix order: the operands are the last results.
                    let operands = stack.split_off(stack.len() - n as usize);
                    let needs_all = matches!(node, CsgNode::Union(_)) != inward;
                    if needs_all {
                        operands.into_iter().reduce(NodeSamples::and).expect("an operator has operands")
                    } else {
                        NodeSamples::any_of(operands, self.band)
                    }
                }
            };
            stack.push(result);
        }
        stack.pop().expect("a tree has one result")
    }

    /// Whether a primitive may change its sign within the band.
    fn is_near(&self, primitive: u32) -> bool {
        let first = self.local.index_of(primitive) * SAMPLES.len();
        self.distances[first..first + SAMPLES.len()].iter().any(|distance| distance.abs() < self.band)
    }

    fn literal(&self, primitive: u32, is_complement: bool) -> NodeSamples {
        let index = self.local.index_of(primitive);
        let first = index * SAMPLES.len();
        let values: [f64; SAMPLES.len()] = std::array::from_fn(|sample| {
            let value = self.distances[first + sample];
            if is_complement { -value } else { value }
        });
        let near = (3..SAMPLES.len()).filter(|k| values[*k] < self.band);
        let samples = near.fold(0, |all, k| all | 1 << k);
        if samples == 0 {
            return NodeSamples { values, literals: Vec::new(), is_across: false };
        }
        // The last sample is the centroid, which is farthest from kinks along edges.
        let gradient = self.slopes[first + SAMPLES.len() - 1].gradient;
        let is_across = self.outward.iter().all(|outward| {
            let along = dot(gradient, *outward) * if is_complement { -1.0 } else { 1.0 };
            let cosine = along / (length(gradient) * length(*outward));
            cosine.is_nan() || cosine < ACROSS
        });
        let literals = vec![RaisedLiteral { index: index as u32, is_complement, samples }];
        NodeSamples { values, literals, is_across }
    }
}

/// By vertex: the sum of the normals of the faces around it, weighted by twice their area.
fn normals(mesh: &Mesh) -> Vec<[f64; 3]> {
    let mut normals = vec![[0.0; 3]; mesh.positions().len()];
    for (face, corners) in mesh.faces().iter().enumerate() {
        let normal = normal(&mesh.corners(face));
        for v in corners {
            let vertex_normal = &mut normals[*v as usize];
            *vertex_normal = sum([*vertex_normal, normal, [0.0; 3]]);
        }
    }
    normals
}

/// The normal of a triangle with twice its area as length.
fn normal([a, b, c]: &[[f64; 3]; 3]) -> [f64; 3] {
    cross(difference(*b, *a), difference(*c, *a))
}

fn sum(vectors: [[f64; 3]; 3]) -> [f64; 3] {
    std::array::from_fn(|k| vectors[0][k] + vectors[1][k] + vectors[2][k])
}

/// The constraint of a literal on the corners of a face; `None` if its gradient is unusable.
fn face_constraint(
    slopes: &[Dual<f64>],
    distances: &[f64],
    literal: &RaisedLiteral,
    max_displacement: &MaxDisplacement,
) -> Option<FaceConstraint> {
    let first = literal.index as usize * SAMPLES.len();
    let sign = if literal.is_complement { -1.0 } else { 1.0 };
    let heights: [f64; SAMPLES.len()] = std::array::from_fn(|k| sign * distances[first + k]);
    // Values at the corners, but gradients beside them.
    let beside: [[f64; 3]; 3] = std::array::from_fn(|k| slopes[first + 3 + k].gradient);
    // A corner farther away than its largest possible displacement counts as that far.
    let at_corners: [f64; 3] = std::array::from_fn(|k| {
        let height = sign * slopes[first + k].value / length(beside[k]);
        lesser(max_displacement.now, height)
    });
    // The plane through the values at the corners may be above those at the samples. All of it has
    // to be raised by as much, since displacements are linear.
    let mut bulge = 0.0;
    for (k, weights) in SAMPLES.iter().enumerate().filter(|(k, _)| literal.samples >> k & 1 == 1) {
        let below = dot(at_corners, *weights) - heights[k];
        bulge = greater(below, bulge);
    }
    let deficits = at_corners.map(|height| bulge - height);
    let directions: [[f64; 3]; 3] = std::array::from_fn(|k| beside[k].map(|x| sign * x / length(beside[k])));
    let is_finite = deficits.iter().chain(directions.as_flattened()).all(|x| x.is_finite());
    let shares =
        at_corners.map(|height| if height > 0.0 { 1.0 - height / max_displacement.now } else { 1.0 });
    let is_on = heights.iter().all(|height| height.abs() <= max_displacement.at_first);
    is_finite.then_some(FaceConstraint { directions, deficits, shares, is_on })
}

fn longest(corners: &[[f64; 3]; 3]) -> f64 {
    let box_of = Box3::from_points(corners);
    box_of.diagonal()
}

fn inflated(corners: &[[f64; 3]; 3], margin: f64) -> Box3 {
    let bare = Box3::from_points(corners);
    Box3 { min: bare.min.map(|x| x - margin), max: bare.max.map(|x| x + margin) }
}

fn weighted_mean(corners: &[[f64; 3]; 3], weights: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| (0..3).fold(0.0, |sum, i| sum + weights[i] * corners[i][k]))
}

/// A constraint on a displacement: `direction · displacement ≥ least`.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfSpace {
    pub direction: [f64; 3],
    pub least: f64,
    /// The factor of the margin that is added to `least`.
    pub share: f64,
}

/// The rounding of a satisfied constraint, relative to the displacement. Chosen: it only affects which
/// guesses are tried.
const ROUNDING: f64 = 1e-11;

impl HalfSpace {
    fn holds(&self, d: [f64; 3]) -> bool {
        dot(self.direction, d) >= self.least - ROUNDING * (self.least.abs() + length(d))
    }
}

/// The shortest displacement that satisfies all constraints, if there is one.
///
/// Source: R. Seidel, *Small-dimensional linear programming and convex hulls made easy*, 1991, here for the
/// norm.
pub(super) fn shortest_displacement(constraints: &[HalfSpace]) -> Option<[f64; 3]> {
    let mut d = [0.0; 3];
    for (i, first) in constraints.iter().enumerate() {
        if first.holds(d) {
            continue;
        }
        // If the best displacement so far violates a constraint, the new best lies on that
        // constraint's plane: the search continues there, with one dimension less, and only the
        // constraints seen so far can matter.
        d = first.direction.map(|x| x * first.least);
        for (j, second) in constraints[..i].iter().enumerate() {
            if !second.holds(d) {
                d = on_line([first, second], &constraints[..j])?;
            }
        }
    }
    Some(d)
}

/// The shortest displacement on the line where two constraints hold with equality, that satisfies some
/// others.
fn on_line([a, b]: [&HalfSpace; 2], others: &[HalfSpace]) -> Option<[f64; 3]> {
    let cosine = dot(a.direction, b.direction);
    let det = 1.0 - cosine * cosine;
    let along = crate::math::cross(a.direction, b.direction);
    // Parallel up to rounding: there is no solution, or one of them is redundant.
    if det < ROUNDING {
        return None;
    }
    // The point of the line nearest to the origin, which is perpendicular to the line; so the
    // shortest solution on it has the parameter nearest to 0.
    let (x, y) = ((a.least - cosine * b.least) / det, (b.least - cosine * a.least) / det);
    let closest: [f64; 3] = std::array::from_fn(|k| x * a.direction[k] + y * b.direction[k]);
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for other in others {
        let (rate, lack) = (dot(other.direction, along), other.least - dot(other.direction, closest));
        if rate.abs() < ROUNDING {
            if other.holds(closest) {
                continue;
            }
            return None;
        }
        let end = lack / rate;
        if rate > 0.0 {
            low = greater(end, low);
        } else {
            high = lesser(end, high);
        }
    }
    let is_empty = low > high + ROUNDING * (low.abs() + high.abs());
    if is_empty {
        return None;
    }
    let t = if low > 0.0 {
        low
    } else if high < 0.0 {
        high
    } else {
        0.0
    };
    Some(std::array::from_fn(|k| closest[k] + t * along[k]))
}
