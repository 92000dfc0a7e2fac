//! `mesh_by_construction`: a field that is a combination of solids, as their triangles cut along each other.
use crate::boolean::solid_cut::cut;
use crate::output::format_rounding::RoundingTarget;
use chordal::boolean::{BooleanOp, BooleanStep, boolean_unchecked};
use chordal::budget::{Bound, Bounded, Failure, Reference, Tolerance};
use chordal::convert::solids::SolidMesher;
use chordal::implicit::Affine3;
use chordal::implicit::construction::{Construction, ConstructionNode, SolidForm};
use chordal::math::{Box3, greater};
use chordal::{Job, Mesh};
use chordal_io::Format;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The triangles of a combination of solids, each within a length. `None` if a part has no mesh of its own or a cut fails,
/// or if the job is cancelled; a mesh without faces if nothing is left.
///
/// Cut solids get no bound against their field: if two surfaces cross at a small angle, the cut may be farther off than
/// either surface. Solids are rotated after they are combined, so that planes that are equal in the numbers of a script are
/// still equal when they are cut. Cost: the cuts, each n log n in its triangles; solids with disjoint boxes are put together
/// without a cut.
pub(crate) fn mesh_by_construction(
    construction: &Construction,
    room: &Box3,
    length: Tolerance,
    job: &Job,
) -> Option<AssembledMesh> {
    let mut assembler = SolidAssembler { job, solids: BTreeMap::new() };
    let combined = assembler.solid(construction, &PartPlace { map: Affine3::IDENTITY, room: *room }, length);
    match combined {
        // The complement of a solid fills space and has no bounded mesh.
        Ok(SidedSolid { mesh, is_complement: false, off }) => {
            Some(AssembledMesh { mesh: Arc::unwrap_or_clone(mesh), off })
        }
        Ok(_) | Err(NoTriangles) => None,
    }
}

/// The triangles of a combination of solids.
pub(crate) struct AssembledMesh {
    pub mesh: Mesh,
    /// A proved bound for the distance of the surface from the solids, if no solid is cut by another.
    pub off: Option<f64>,
}

/// A part has no triangles of its own, a cut failed, or the job was cancelled.
struct NoTriangles;

/// A solid, or its complement.
#[derive(Clone)]
struct SidedSolid {
    mesh: Arc<Mesh>,
    is_complement: bool,
    /// As in [`AssembledMesh`].
    off: Option<f64>,
}

/// The place of a part before it is combined with others.
#[derive(Clone, Copy)]
struct PartPlace {
    map: Affine3,
    /// The room of the combination, in the coordinates after the map.
    room: Box3,
}

/// A part of a union or an intersection.
struct PlacedPart<'a> {
    construction: &'a Construction,
    place: PartPlace,
    is_complement: bool,
}

struct SolidAssembler<'a> {
    job: &'a Job,
    /// The solids that are placed several times, in their own coordinates, by their address and the bits of their room and
    /// length.
    solids: BTreeMap<(usize, [u64; 7]), SidedSolid>,
}

type Assembled = Result<SidedSolid, NoTriangles>;

impl SolidAssembler<'_> {
    /// The triangles of a part at its place.
    fn solid(&mut self, part: &Construction, place: &PartPlace, length: Tolerance) -> Assembled {
        match part.node() {
            ConstructionNode::Solid(form) => {
                let scale = scale_of(&place.map);
                let own_length = Tolerance::new(length.get() / scale).map_err(|_| NoTriangles)?;
                let mesher = SolidMesher { length: own_length, room: preimage(&place.map, &place.room) };
                let mesh = mesher.mesh(form).ok_or(NoTriangles)?;
                let off = mesh.bound.at_most();
                self.at(SidedSolid { mesh: mesh.shape.into(), is_complement: false, off }, &place.map)
            }
            ConstructionNode::Placed(map, below) if is_exact(map) && is_form(below) => {
                let map = place.map.after(map).map_err(|_| NoTriangles)?;
                self.solid(below, &PartPlace { map, ..*place }, length)
            }
            ConstructionNode::Placed(map, below) => {
                let map = place.map.after(map).map_err(|_| NoTriangles)?;
                let solid = self.in_own_coordinates(below, &PartPlace { map, ..*place }, length)?;
                self.at(solid, &map)
            }
            ConstructionNode::Complement(below) => {
                let solid = self.solid(below, place, length)?;
                Ok(SidedSolid { is_complement: !solid.is_complement, ..solid })
            }
            ConstructionNode::Union(_) => self.combined(part, place, length, BooleanOp::Union),
            ConstructionNode::Intersection(_) => self.combined(part, place, length, BooleanOp::Intersection),
            ConstructionNode::Planar(_) | ConstructionNode::Other(_) => Err(NoTriangles),
        }
    }

    /// A part in its own coordinates, meshed once for all its places.
    fn in_own_coordinates(&mut self, part: &Construction, place: &PartPlace, length: Tolerance) -> Assembled {
        let room = preimage(&place.map, &place.room);
        let length = Tolerance::new(length.get() / scale_of(&place.map)).map_err(|_| NoTriangles)?;
        // Only half-spaces depend on the room.
        let ends = if has_half_space(part) { [room.min, room.max] } else { [[0.0; 3]; 2] };
        let mut key = [length.get().to_bits(); 7];
        key.iter_mut().zip(ends.as_flattened()).for_each(|(bits, x)| *bits = x.to_bits());
        // An address is as good as a name while the construction is borrowed: no other part can get it.
        let key = (part.address(), key);
        if let Some(solid) = self.solids.get(&key) {
            return Ok(solid.clone());
        }
        let solid = self.solid(part, &PartPlace { map: Affine3::IDENTITY, room }, length)?;
        self.solids.insert(key, solid.clone());
        Ok(solid)
    }

    fn at(&self, solid: SidedSolid, map: &Affine3) -> Assembled {
        if *map == Affine3::IDENTITY {
            return Ok(solid);
        }
        // The map needs some bound: 0 takes the place of an unknown one, which stays unknown below.
        let bound = Bound::proved(0.0, solid.off.unwrap_or(0.0), Reference::Field);
        let mesh = Bounded { shape: Arc::unwrap_or_clone(solid.mesh), bound };
        let placed = SolidMesher::placed(&mesh, map).ok_or(NoTriangles)?;
        let off = solid.off.and(placed.bound.at_most());
        Ok(SidedSolid { mesh: placed.shape.into(), off, ..solid })
    }

    /// A union or an intersection, with all parts of unions in unions and of intersections in intersections.
    fn combined(
        &mut self,
        construction: &Construction,
        place: &PartPlace,
        length: Tolerance,
        op: BooleanOp,
    ) -> Assembled {
        let first = PlacedPart { construction, place: *place, is_complement: false };
        let (mut todo, mut parts) = (vec![first], Vec::new());
        let repeated = repeated_parts(construction);
        // The part that was pushed last is taken first: parts are pushed in reverse, and so stay in the order of the
        // script.
        while let Some(part) = todo.pop() {
            let PlacedPart { construction, place, is_complement } = part;
            match construction.node() {
                // By De Morgan's laws, a complement turns one operation into the other: its parts belong here if that
                // is this one.
                ConstructionNode::Union(below) if is_complement == (op != BooleanOp::Union) => {
                    todo.extend(below.iter().rev().map(|construction| PlacedPart { construction, ..part }));
                }
                ConstructionNode::Intersection(below) if is_complement == (op == BooleanOp::Union) => {
                    todo.extend(below.iter().rev().map(|construction| PlacedPart { construction, ..part }));
                }
                ConstructionNode::Complement(below) => {
                    todo.push(PlacedPart { construction: below, is_complement: !is_complement, place });
                }
                // Moved unions are merged into this union, except the repeated ones: those are meshed once.
                ConstructionNode::Placed(map, below)
                    if is_exact(map)
                        && !is_form(below)
                        && !is_cut(below)
                        && !repeated.contains(&below.address()) =>
                {
                    let map = place.map.after(map).map_err(|_| NoTriangles)?;
                    todo.push(PlacedPart {
                        construction: below,
                        place: PartPlace { map, ..place },
                        is_complement,
                    });
                }
                _ => parts.push(part),
            }
        }
        let mut solids: Vec<SidedSolid> = Vec::with_capacity(parts.len());
        let mut remaining = parts.as_slice();
        while let Some(first) = remaining.first() {
            if self.is_over() {
                return Err(NoTriangles);
            }
            // Successive parts with the same rotation are combined before they are rotated.
            let n_alike = remaining.iter().take_while(|part| first.is_turned_like(part)).count();
            let combined = match first.construction.node() {
                ConstructionNode::Placed(map, _) if n_alike > 1 => {
                    let map = first.place.map.after(map).map_err(|_| NoTriangles)?;
                    let scale = scale_of(&map);
                    let own_place =
                        PartPlace { map: Affine3::IDENTITY, room: preimage(&map, &first.place.room) };
                    let own_length = Tolerance::new(length.get() / scale).map_err(|_| NoTriangles)?;
                    let alike = remaining[..n_alike].iter().map(|part| {
                        let ConstructionNode::Placed(_, below) = part.construction.node() else {
                            return Err(NoTriangles);
                        };
                        let solid = self.solid(below, &own_place, own_length)?;
                        Ok(SidedSolid { is_complement: solid.is_complement != part.is_complement, ..solid })
                    });
                    let alike: Vec<SidedSolid> = alike.collect::<Result<_, _>>()?;
                    let joined = self.join(alike, op, own_length)?;
                    vec![self.at(joined, &map)?]
                }
                _ => {
                    let solid = self.solid(first.construction, &first.place, length)?;
                    vec![SidedSolid { is_complement: solid.is_complement != first.is_complement, ..solid }]
                }
            };
            let is_turned = matches!(first.construction.node(), ConstructionNode::Placed(..)) && n_alike > 1;
            remaining = &remaining[if is_turned { n_alike } else { 1 }..];
            solids.extend(combined);
        }
        self.join(solids, op, length)
    }

    /// Cuts solids along each other. Each is within a length of its true solid.
    fn join(&self, solids: Vec<SidedSolid>, op: BooleanOp, length: Tolerance) -> Assembled {
        if op == BooleanOp::Union
            && let Some(apart) = all_apart(&solids, length)
        {
            return Ok(apart);
        }
        let (outer, inner): (Vec<_>, Vec<_>) = solids.into_iter().partition(|solid| solid.is_complement);
        // Coordinates are tied over all meshes, solids and complements: a plane may be a face of both.
        let mut meshes: Vec<Mesh> =
            [&inner, &outer].into_iter().flatten().map(|solid| solid.mesh.as_ref().clone()).collect();
        tie_coordinates(&mut meshes);
        let outer = meshes.split_off(inner.len());
        let inner = meshes;
        // By De Morgan's laws, a union with complements is the complement of: the intersection of what these leave out,
        // minus the solids.
        let (common, taken, is_complement) = match op {
            BooleanOp::Union if outer.is_empty() => {
                return self.cut(apart(inner), BooleanOp::Union, Vec::new(), false);
            }
            BooleanOp::Union => (outer, inner, true),
            _ if inner.is_empty() => return self.cut(apart(outer), BooleanOp::Union, Vec::new(), true),
            _ => (inner, outer, false),
        };
        self.cut(common, BooleanOp::Intersection, apart(taken), is_complement)
    }

    /// Unites meshes to a few: by halves, so that a triangle goes through as many cuts as there are halvings and not through
    /// one for each mesh.
    fn united(&self, mut meshes: Vec<Mesh>) -> Result<Vec<Mesh>, NoTriangles> {
        if meshes.len() <= MOST_IN_A_ROW {
            return Ok(meshes);
        }
        let second = meshes.split_off(meshes.len() / 2);
        let mut halves = self.united(meshes)?;
        halves.extend(self.united(second)?);
        let united = self.cut_in_a_row(halves, BooleanOp::Union, Vec::new(), false)?;
        Ok(vec![Arc::unwrap_or_clone(united.mesh)])
    }

    /// Combines meshes by one operation, and subtracts others.
    fn cut(&self, first: Vec<Mesh>, op: BooleanOp, taken: Vec<Mesh>, is_complement: bool) -> Assembled {
        let first = if op == BooleanOp::Union { self.united(first)? } else { first };
        let taken = self.united(taken)?;
        self.cut_in_a_row(first, op, taken, is_complement)
    }

    /// Whether the job is cancelled, or its time has ended.
    fn is_over(&self) -> bool {
        self.job.is_cancelled() || self.job.is_finishing()
    }

    fn cut_in_a_row(
        &self,
        first: Vec<Mesh>,
        op: BooleanOp,
        taken: Vec<Mesh>,
        is_complement: bool,
    ) -> Assembled {
        if self.is_over() {
            return Err(NoTriangles);
        }
        let n_first = first.len();
        let meshes: Vec<Mesh> = first.into_iter().chain(taken).collect();
        if meshes.iter().all(|mesh| mesh.faces().is_empty()) {
            return Ok(SidedSolid { mesh: Mesh::default().into(), is_complement, off: None });
        }
        // Nothing was cut, and still there is no bound: these may be several solids whose boxes do not meet, but
        // whose true surfaces do, being within the length of their triangles.
        if let [one] = meshes.as_slice() {
            return Ok(SidedSolid { mesh: one.clone().into(), is_complement, off: None });
        }
        let ops: Vec<BooleanOp> =
            (1..meshes.len()).map(|k| if k < n_first { op } else { BooleanOp::Difference }).collect();
        let steps: Vec<BooleanStep> =
            ops.iter().zip(&meshes[1..]).map(|(op, mesh)| BooleanStep { op: *op, mesh }).collect();
        // Steps are not checked, since the whole is compared with its field later.
        match boolean_unchecked(&meshes[0], &steps, None, self.job) {
            Ok(mesh) => return Ok(SidedSolid { mesh: mesh.into(), is_complement, off: None }),
            Err(Failure::Cancelled) => return Err(NoTriangles),
            Err(_) => {}
        }
        let meshes: Vec<&Mesh> = meshes.iter().collect();
        // Not rounded to a format: this is an intermediate mesh.
        // Where the fast engine fails, this cut has exact arithmetic to fall back on.
        match cut(&meshes, &ops, RoundingTarget::format(Format::Ply), self.job) {
            Ok(solid) if solid.bound.evidence().bounds_above() => {
                Ok(SidedSolid { mesh: solid.mesh.into(), is_complement, off: None })
            }
            Ok(_) | Err(_) => Err(NoTriangles),
        }
    }
}

/// The most meshes that are united one after the other. Chosen: there is one check at the end for all of them.
const MOST_IN_A_ROW: usize = 4;

/// The addresses of unions that occur at several places below unions.
fn repeated_parts(construction: &Construction) -> BTreeSet<usize> {
    let (mut seen, mut repeated) = (BTreeSet::new(), BTreeSet::new());
    let mut todo = vec![construction];
    while let Some(part) = todo.pop() {
        match part.node() {
            ConstructionNode::Placed(_, below) if !is_form(below) => {
                if seen.insert(below.address()) {
                    todo.push(below);
                } else {
                    repeated.insert(below.address());
                }
            }
            ConstructionNode::Complement(below) => todo.push(below),
            ConstructionNode::Union(parts) | ConstructionNode::Intersection(parts) => {
                todo.extend(parts.iter())
            }
            _ => {}
        }
    }
    repeated
}

impl PlacedPart<'_> {
    /// Whether both have the same rotation, that is, a map that is not exact.
    fn is_turned_like(&self, other: &Self) -> bool {
        match (self.construction.node(), other.construction.node()) {
            (ConstructionNode::Placed(map, _), ConstructionNode::Placed(other_map, _)) => {
                !is_exact(map) && map == other_map && self.place.map == other.place.map
            }
            _ => false,
        }
    }
}

/// Whether equal coordinates stay equal under a map: each new coordinate depends on only one old one.
fn is_exact(map: &Affine3) -> bool {
    map.rows().iter().all(|row| row[..3].iter().filter(|x| **x != 0.0).count() == 1)
}

fn is_form(part: &Construction) -> bool {
    match part.node() {
        ConstructionNode::Solid(_) => true,
        ConstructionNode::Placed(map, below) => is_exact(map) && is_form(below),
        _ => false,
    }
}

/// Whether a part is neither a union nor a moved union.
fn is_cut(part: &Construction) -> bool {
    match part.node() {
        ConstructionNode::Union(_) => false,
        ConstructionNode::Placed(map, below) => !is_exact(map) || is_cut(below),
        _ => true,
    }
}

fn has_half_space(part: &Construction) -> bool {
    part.has(&|node| matches!(node, ConstructionNode::Solid(SolidForm::HalfSpace { .. })))
}

/// The factor by which a similarity lengthens.
fn scale_of(map: &Affine3) -> f64 {
    let [x, y, z] = map.steps()[0];
    (x * x + y * y + z * z).sqrt()
}

/// A box around the preimage of a box under a similarity, up to rounding.
fn preimage(map: &Affine3, room: &Box3) -> Box3 {
    let [x, y, z] = map.rows();
    let scale = scale_of(map);
    // The inverse of a similarity is its transpose, divided by the square of its scale.
    let back = |p: [f64; 3]| {
        let q = [p[0] - x[3], p[1] - y[3], p[2] - z[3]];
        std::array::from_fn(|k| (x[k] * q[0] + y[k] * q[1] + z[k] * q[2]) / (scale * scale))
    };
    let corner = |k: usize| {
        std::array::from_fn(|axis| if k >> axis & 1 == 1 { room.max[axis] } else { room.min[axis] })
    };
    Box3::from_points(&(0..8).map(|k| back(corner(k))).collect::<Vec<_>>())
}

/// Solids whose boxes are farther from each other than twice a length, as one solid. `None` for others.
///
/// Each mesh is within the length of its solid, so that no surface reaches another solid; the bound is the largest of all.
fn all_apart(solids: &[SidedSolid], length: Tolerance) -> Option<SidedSolid> {
    // A part that became empty by a cut may only have been too small for its triangles.
    if solids.len() > MOST_APART || solids.iter().any(|part| part.is_complement || part.off.is_none()) {
        return None;
    }
    let parts: Vec<&SidedSolid> = solids.iter().filter(|part| !part.mesh.faces().is_empty()).collect();
    let boxes: Vec<Box3> = parts.iter().map(|part| part.mesh.bounds()).collect();
    let far = 2.0 * length.get().next_up();
    let is_far = |a: &Box3, b: &Box3| (0..3).any(|k| b.min[k] - a.max[k] > far || a.min[k] - b.max[k] > far);
    let is_apart = |(k, bounds): (usize, &Box3)| boxes[..k].iter().all(|other| is_far(bounds, other));
    let off = parts.iter().try_fold(0.0, |most, part| Some(greater(part.off?, most)))?;
    let is_within = off <= length.get() && boxes.iter().enumerate().all(is_apart);
    let joined = || together(parts.iter().map(|part| part.mesh.as_ref().clone()).collect());
    is_within.then(|| SidedSolid { mesh: joined().into(), is_complement: false, off: Some(off) })
}

/// The most solids whose boxes are compared pairwise. Chosen: half a million pairs.
const MOST_APART: usize = 1024;

/// Puts meshes whose boxes do not meet together: into as few meshes as a simple search finds, in the order of their first
/// parts.
fn apart(meshes: Vec<Mesh>) -> Vec<Mesh> {
    let mut groups: Vec<(Vec<Box3>, Vec<Mesh>)> = Vec::new();
    let meets = |a: &Box3, b: &Box3| (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k]);
    for mesh in meshes.into_iter().filter(|mesh| !mesh.faces().is_empty()) {
        let bounds = mesh.bounds();
        match groups.iter_mut().find(|(boxes, _)| !boxes.iter().any(|other| meets(&bounds, other))) {
            Some((boxes, members)) => {
                boxes.push(bounds);
                members.push(mesh);
            }
            None => groups.push((vec![bounds], vec![mesh])),
        }
    }
    groups.into_iter().map(|(_, members)| together(members)).collect()
}

fn together(mut meshes: Vec<Mesh>) -> Mesh {
    if meshes.len() == 1 {
        return meshes.remove(0);
    }
    let (mut positions, mut faces): (Vec<[f64; 3]>, Vec<[u32; 3]>) = Default::default();
    for mesh in &meshes {
        let first = positions.len() as u32;
        positions.extend_from_slice(mesh.positions());
        faces.extend(mesh.faces().iter().map(|face| face.map(|row| row + first)));
    }
    Mesh::new(positions, faces).unwrap_or_default()
}

/// Coordinates that differ by less than this, relative to the largest one, are the same in the meaning of a script. Derived:
/// some dozen roundings of placements; the planes of fields are compared with the same tolerance.
const TIED: f64 = 1.0 / (1_u64 << 48) as f64;

/// Makes coordinates equal that differ only by rounding, so that planes across the axes that are meant to be equal are
/// equal.
fn tie_coordinates(meshes: &mut [Mesh]) {
    let positions = || meshes.iter().flat_map(|mesh| mesh.positions());
    let largest = positions().flatten().fold(0.0, |most: f64, x| greater(x.abs(), most));
    let near = TIED * largest;
    let ties: [Vec<(f64, f64)>; 3] = std::array::from_fn(|axis| {
        let mut values: Vec<f64> = positions().map(|p| p[axis]).collect();
        values.sort_unstable_by(f64::total_cmp);
        values.dedup();
        let mut first = f64::NEG_INFINITY;
        let mut tied = Vec::new();
        for value in values {
            // Compared with the first of its group and not with the one before: a row of near values would drift.
            if value - first <= near {
                tied.push((value, first));
            } else {
                first = value;
            }
        }
        tied
    });
    if ties.iter().all(Vec::is_empty) {
        return;
    }
    for mesh in meshes {
        let moved = |axis: usize, x: f64| {
            ties[axis].binary_search_by(|(from, _)| from.total_cmp(&x)).map_or(x, |row| ties[axis][row].1)
        };
        let positions = mesh.positions().iter().map(|p| [0, 1, 2].map(|axis| moved(axis, p[axis]))).collect();
        if let Ok(tied) = Mesh::new(positions, mesh.faces().to_vec()) {
            *mesh = tied;
        }
    }
}
