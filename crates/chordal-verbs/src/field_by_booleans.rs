//! `mesh_by_booleans`: a field that combines closed meshes with other solids, as triangles cut along each other.
use crate::MeshFailure;
use crate::format_rounding::RoundingTarget;
use crate::request::MeshRequest;
use crate::solid_cut::{CutFailure, cut, cutting_slack, whole_bound};
use chordal::boolean::BooleanOp;
use chordal::budget::{Bound, Bounded, Budget, Failure, Reference, RefusalCode, RequiredEvidence, Tolerance};
use chordal::convert::field_to_mesh;
use chordal::convert::solids::{SolidNode, SolidTree};
use chordal::implicit::Field;
use chordal::math::add_up;
use chordal::{Job, Mesh};
use chordal_io::Format;

/// The triangles of a field with meshes at the precision of a format, by booleans. None where it is no tree of solids,
/// where the budget has no length, and where a part or a cut does not succeed within it: then the field is
/// meshed as a whole.
///
/// Meshes are cut as they are, and what has no mesh in it becomes triangles within the length. The bound is that of
/// [`mesh_boolean`](crate::mesh_boolean): of each cut, one after the other, and the largest of the parts' own. A point
/// farther than both together from all surfaces of the parts is farther than the cuts' from all their triangles; so every
/// cut leaves it on its side, as far as each part's triangles do.
///
/// # Errors
/// When the job is cancelled, or rounding alone exceeds the budget.
pub(crate) fn mesh_by_booleans(
    field: &Field,
    request: &MeshRequest,
    job: &Job,
) -> Result<Option<Bounded<Mesh>>, MeshFailure> {
    if request.budget.require == RequiredEvidence::Estimated {
        return Ok(None);
    }
    let rounding = add_up(request.rounding(), cutting_slack(&request.bounds));
    let within = request.reserve_rounding(rounding)?.length_in(&request.bounds);
    let Some(within) = within.and_then(|length| Tolerance::new(length).ok()) else { return Ok(None) };
    let tree = match SolidTree::from_field(field) {
        Ok(Some(tree)) => tree,
        // The field's own way says what is wrong with it.
        Ok(None) | Err(_) => return Ok(None),
    };
    let target = RoundingTarget::new(request.to, request.lattice);
    let Some(whole) = SolidCutter { within, require: request.budget.require, target, job }.whole(tree)?
    else {
        return Ok(None);
    };
    let bound = with_promises(&whole.bound, field);
    let fits =
        |limit: Option<f64>| limit.is_none_or(|limit| bound.at_most().is_some_and(|most| most <= limit));
    // Where nothing is left, the field's own way says so.
    if whole.shape.faces().is_empty() {
        return Ok(None);
    }
    let few = request.budget.triangles.is_none_or(|most| whole.shape.faces().len() as u64 <= most);
    let is_met = bound.evidence().bounds_above() && fits(request.budget.length_in(&request.bounds)) && few;
    Ok(is_met.then_some(Bounded { shape: whole.shape, bound }))
}

/// The bound against the field, by what its promises are worth.
fn with_promises(bound: &Bound, field: &Field) -> Bound {
    let evidence = bound.evidence().weaker(&field.evidence());
    let mut all = Bound::with_evidence(bound.at_least(), bound.at_most(), evidence, Reference::Field);
    (all.metric, all.at) = (bound.metric, bound.at);
    all
}

/// A solid on the way: itself, or cuts that are made when it is used.
enum PendingSolid {
    Ready(Bounded<Mesh>),
    Chain(Vec<Bounded<Mesh>>, Vec<BooleanOp>),
    /// It has become an operand.
    Used,
}

struct SolidCutter<'a> {
    within: Tolerance,
    require: RequiredEvidence,
    target: RoundingTarget,
    job: &'a Job,
}

impl SolidCutter<'_> {
    /// The last solid, rounded to the format. None where a part or a cut fails.
    fn whole(&self, tree: SolidTree) -> Result<Option<Bounded<Mesh>>, MeshFailure> {
        let uses = uses_of(&tree.nodes);
        let mut solids: Vec<PendingSolid> = Vec::with_capacity(tree.nodes.len());
        for (number, node) in tree.nodes.into_iter().enumerate() {
            let next = match node {
                SolidNode::Triangles(made) => PendingSolid::Ready(made),
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
            Some(PendingSolid::Ready(whole)) => Ok(Some(whole)),
            None | Some(PendingSolid::Used) => Ok(None),
        }
    }

    /// Two solids with what combines them. Cuts of the first go on where nothing else uses it. `Used` where a cut of one
    /// of them fails.
    fn chain(
        &self,
        solids: &mut [PendingSolid],
        (op, [first, second]): (BooleanOp, [usize; 2]),
        uses: &[usize],
    ) -> Result<PendingSolid, MeshFailure> {
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
        let Some(one) = self.taken(solids, first, uses[first])? else { return Ok(PendingSolid::Used) };
        Ok(PendingSolid::Chain(vec![one, other], vec![op]))
    }

    /// A solid as one mesh; a copy of it, where others use it, too.
    fn taken(
        &self,
        solids: &mut [PendingSolid],
        number: usize,
        uses: usize,
    ) -> Result<Option<Bounded<Mesh>>, MeshFailure> {
        // Rounded to no format: only the last cut is written.
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
            // What samples say of a part says nothing of what is cut from it.
            Ok(made) => Ok(made.bound.evidence().bounds_above().then_some(made)),
            Err(Failure::Cancelled) => Err(MeshFailure::Cancelled),
            // Nothing of it is near the whole.
            Err(Failure::Refused(why)) if why.code == RefusalCode::Empty => {
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
            Ok(made) if made.bound.evidence().bounds_above() => {
                let own: Vec<&Bound> = operands
                    .iter()
                    .map(|operand| &operand.bound)
                    .filter(|own| own.at_most() != Some(0.0))
                    .collect();
                let bound = whole_bound(&made, &own);
                Ok(Some(Bounded { shape: made.mesh, bound }))
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

/// What is said of triangles that were cut.
pub(crate) fn cut_note() -> &'static str {
    "the triangles of meshes were cut as they are: simplify what was written for fewer"
}
