//! `mesh_by_booleans`: a field that combines closed meshes with other solids, as triangles cut along each other.
use crate::MeshFailure;
use crate::boolean::solid_cut::{CutFailure, cut, cutting_slack, total_bound};
use crate::mesh::request::MeshRequest;
use crate::output::format_rounding::RoundingTarget;
use chordal::boolean::BooleanOp;
use chordal::budget::{Bound, Bounded, Budget, Failure, Reference, RefusalCode, RequiredEvidence, Tolerance};
use chordal::convert::field_to_mesh;
use chordal::convert::solids::{SolidNode, SolidTree};
use chordal::implicit::Field;
use chordal::math::add_up;
use chordal::{Job, Mesh};
use chordal_io::Format;

/// The triangles of a field with meshes at the precision of a format, by booleans. `None` if the field is not a tree of
/// solids, if the budget has no length, or if a part or a cut fails within it: then the field is meshed as a whole.
///
/// Meshes are cut as they are, and parts without meshes become triangles within the length. The bound is that of
/// [`mesh_boolean`](crate::mesh_boolean): of each cut, one after the other, and the largest of the parts' own bounds. A
/// point farther than both together from all surfaces of the parts is farther than the cuts' bounds from all their
/// triangles; so every cut leaves it on its side, like the triangles of each part.
///
/// # Errors
/// If the job is cancelled, or rounding alone exceeds the budget.
pub(crate) fn mesh_by_booleans(
    field: &Field,
    request: &MeshRequest,
    job: &Job,
) -> Result<Option<Bounded<Mesh>>, MeshFailure> {
    if request.budget.require == RequiredEvidence::Estimated {
        return Ok(None);
    }
    // Cuts move vertices by their own rounding, which a part has to leave room for beside that of the format.
    let rounding = add_up(request.rounding(), cutting_slack(&request.bounds));
    let length = request.reserve_rounding(rounding)?.length_in(&request.bounds);
    let Some(within) = length.and_then(|length| Tolerance::new(length).ok()) else { return Ok(None) };
    let tree = match SolidTree::from_field(field) {
        Ok(Some(tree)) => tree,
        // Meshing the field as a whole reports the reason.
        Ok(None) | Err(_) => return Ok(None),
    };
    let target = RoundingTarget::new(request.to, request.lattice);
    let Some(mesh) = SolidCutter { within, require: request.budget.require, target, job }.whole(tree)? else {
        return Ok(None);
    };
    let bound = with_promises(&mesh.bound, field);
    let fits =
        |limit: Option<f64>| limit.is_none_or(|limit| bound.at_most().is_some_and(|most| most <= limit));
    // If nothing is left, meshing the field as a whole reports it.
    if mesh.shape.faces().is_empty() {
        return Ok(None);
    }
    let few = request.budget.triangles.is_none_or(|most| mesh.shape.faces().len() as u64 <= most);
    let is_met = bound.evidence().bounds_above() && fits(request.budget.length_in(&request.bounds)) && few;
    Ok(is_met.then_some(Bounded { shape: mesh.shape, bound }))
}

/// The bound against the field, with the evidence of the field's declared distances.
fn with_promises(bound: &Bound, field: &Field) -> Bound {
    let evidence = bound.evidence().weaker(&field.evidence());
    let mut weakened = Bound::with_evidence(bound.at_least(), bound.at_most(), evidence, Reference::Field);
    (weakened.metric, weakened.at) = (bound.metric, bound.at);
    weakened
}

/// A solid that is not finished: its triangles, or cuts that are made when it is used.
enum PendingSolid {
    Ready(Bounded<Mesh>),
    Chain(Vec<Bounded<Mesh>>, Vec<BooleanOp>),
    /// The solid has become an operand.
    Used,
}

struct SolidCutter<'a> {
    within: Tolerance,
    require: RequiredEvidence,
    target: RoundingTarget,
    job: &'a Job,
}

impl SolidCutter<'_> {
    /// The last solid, rounded to the format. `None` if a part or a cut fails.
    fn whole(&self, tree: SolidTree) -> Result<Option<Bounded<Mesh>>, MeshFailure> {
        let uses = uses_of(&tree.nodes);
        let mut solids: Vec<PendingSolid> = Vec::with_capacity(tree.nodes.len());
        for (number, node) in tree.nodes.into_iter().enumerate() {
            let next = match node {
                SolidNode::Triangles(mesh) => PendingSolid::Ready(mesh),
                SolidNode::Field(part) => match self.part(&part)? {
                    Some(part) => PendingSolid::Ready(part),
                    None => return Ok(None),
                },
                SolidNode::Union(a, b) => self.chain(&mut solids, (BooleanOp::Union, [a, b]), &uses)?,
                SolidNode::Intersection(a, b) => {
                    self.chain(&mut solids, (BooleanOp::Intersection, [a, b]), &uses)?
                }
                SolidNode::Difference(a, b) => {
                    self.chain(&mut solids, (BooleanOp::Difference, [a, b]), &uses)?
                }
            };
            if matches!(next, PendingSolid::Used) {
                return Ok(None);
            }
            debug_assert_eq!(solids.len(), number);
            solids.push(next);
        }
        match solids.pop() {
            Some(PendingSolid::Chain(operands, ops)) => self.cut(&operands, &ops, self.target),
            Some(PendingSolid::Ready(mesh)) => Ok(Some(mesh)),
            None | Some(PendingSolid::Used) => Ok(None),
        }
    }

    /// Two solids with the operation that combines them. The cuts of the first are continued if nothing else uses it.
    /// `Used` if a cut of one of them fails.
    fn chain(
        &self,
        solids: &mut [PendingSolid],
        (op, [first, second]): (BooleanOp, [usize; 2]),
        uses: &[usize],
    ) -> Result<PendingSolid, MeshFailure> {
        // Cuts of a chain are made from left to right, so that only the first solid's can go on: the second becomes
        // one mesh.
        let Some(other) = self.taken(solids, second, uses[second])? else { return Ok(PendingSolid::Used) };
        if uses[first] == 1
            && let PendingSolid::Chain(..) = &solids[first]
            && let PendingSolid::Chain(mut operands, mut ops) =
                std::mem::replace(&mut solids[first], PendingSolid::Used)
        {
            operands.push(other);
            ops.push(op);
            return Ok(PendingSolid::Chain(operands, ops));
        }
        let Some(base) = self.taken(solids, first, uses[first])? else { return Ok(PendingSolid::Used) };
        Ok(PendingSolid::Chain(vec![base, other], vec![op]))
    }

    /// A solid as one mesh, which is copied if other solids use it, too.
    fn taken(
        &self,
        solids: &mut [PendingSolid],
        number: usize,
        uses: usize,
    ) -> Result<Option<Bounded<Mesh>>, MeshFailure> {
        // Not rounded to a format: only the last cut is written.
        let exact = RoundingTarget::format(Format::Ply);
        let ready = match std::mem::replace(&mut solids[number], PendingSolid::Used) {
            PendingSolid::Ready(solid) => solid,
            PendingSolid::Chain(operands, ops) => match self.cut(&operands, &ops, exact)? {
                Some(solid) => solid,
                None => return Ok(None),
            },
            PendingSolid::Used => return Ok(None),
        };
        if uses > 1 {
            solids[number] = PendingSolid::Ready(ready.clone());
        }
        Ok(Some(ready))
    }

    /// The triangles of a part without meshes, proved.
    fn part(&self, part: &Field) -> Result<Option<Bounded<Mesh>>, MeshFailure> {
        let budget = Budget { require: self.require, ..Budget::length(self.within) };
        match field_to_mesh(part, &budget, self.job) {
            // A measured error of a part is no bound for the cuts.
            Ok(mesh) => Ok(mesh.bound.evidence().bounds_above().then_some(mesh)),
            Err(Failure::Cancelled) => Err(MeshFailure::Cancelled),
            // The part has no surface within the bounds of the field.
            Err(Failure::Refused(refusal)) if refusal.code == RefusalCode::Empty => {
                Ok(Some(Bounded { shape: Mesh::default(), bound: Bound::exact(Reference::Field) }))
            }
            Err(_) => Ok(None),
        }
    }

    fn cut(
        &self,
        operands: &[Bounded<Mesh>],
        ops: &[BooleanOp],
        target: RoundingTarget,
    ) -> Result<Option<Bounded<Mesh>>, MeshFailure> {
        let meshes: Vec<&Mesh> = operands.iter().map(|operand| &operand.shape).collect();
        match cut(&meshes, ops, target, self.job) {
            Ok(solid) if solid.bound.evidence().bounds_above() => {
                let operand_bounds: Vec<&Bound> = operands
                    .iter()
                    .map(|operand| &operand.bound)
                    // A mesh as it is adds no length. It also leaves the evidence as strong as that of the cut alone:
                    // the bound of an approximated operand makes it conditional.
                    .filter(|bound| bound.at_most() != Some(0.0))
                    .collect();
                let bound = total_bound(&solid, &operand_bounds);
                Ok(Some(Bounded { shape: solid.mesh, bound }))
            }
            Err(CutFailure::Other(MeshFailure::Cancelled)) => Err(MeshFailure::Cancelled),
            Ok(_) | Err(_) => Ok(None),
        }
    }
}

/// How often each node is an operand.
fn uses_of(nodes: &[SolidNode]) -> Vec<usize> {
    let mut uses = vec![0; nodes.len()];
    for node in nodes {
        let operands = match node {
            SolidNode::Union(a, b) | SolidNode::Intersection(a, b) | SolidNode::Difference(a, b) => [*a, *b],
            SolidNode::Triangles(_) | SolidNode::Field(_) => continue,
        };
        operands.into_iter().for_each(|operand| uses[operand] += 1);
    }
    uses
}

/// The note on triangles that were cut.
pub(crate) fn cut_note() -> &'static str {
    "the triangles of meshes were cut as they are: simplify the output for fewer"
}
