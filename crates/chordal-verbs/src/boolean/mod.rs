//! `mesh_boolean`: the union, difference and intersection of shapes as triangles.
mod carried;
mod operand;

use crate::finish::finish_triangles;
use crate::format_rounding::RoundingTarget;
use crate::report::{BooleanFacts, BooleanOperandFacts, BoundFacts, BudgetFacts, Certificate, InputFacts};
use crate::request::MeshRequest;
use crate::{BudgetSpec, Input, MeshFailure, MeshOutcome, OutputForm, formats};
use chordal::boolean::provenance::BooleanError;
use chordal::boolean::{BooleanMesh, BooleanOp, BooleanStep, boolean_snapped};
use chordal::budget::advice::{Cure, Message, Setting};
use chordal::budget::{Bound, Evidence, JobError, Metric, Refusal, RefusalCode};
use chordal::math::{Box3, add_up, greater};
use chordal::{Job, Mesh};
use chordal_io::CoordinateOverflow;
use operand::SolidOperand;
use std::sync::Mutex;

/// One more shape, and what is done with it.
#[derive(Clone, Debug)]
pub struct BooleanOperand {
    /// How it is combined with what there is so far.
    pub op: BooleanOp,
    /// What messages call it.
    pub name: String,
    /// The shape.
    pub input: Input,
}

/// Combines shapes from left to right as triangles that read back from a file of the format `to`: see
/// [`chordal::boolean::boolean`].
///
/// Triangles are cut as they are, with the colours, materials, texture coordinates and normals that they carry.
/// Other shapes become triangles first, within the length of the budget less what rounding takes. The bound adds
/// the largest of their bounds to that of the cut, with the metric "solid": points farther than it from the
/// shapes' surfaces are on the side where they should be.
///
/// # Errors
/// When a shape bounds no solid, or needs a length and the budget has none; when nothing is left; when the
/// result fails its own check or misses the budget, with the outcome; when the work is refused, or cancelled.
///
/// ```
/// use chordal::boolean::BooleanOp;
/// use chordal_io::Format;
/// use chordal_verbs::{BooleanOperand, BudgetSpec, FormatHint, load, mesh_boolean};
/// let tetrahedron = |x: f64| {
///     let obj = format!("v {x} 0 0\nv {} 0 0\nv {x} 1 0\nv {x} 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n", x + 1.0);
///     load(obj.as_bytes(), FormatHint { name: Some("a.obj"), ..FormatHint::default() }, &Default::default())
/// };
/// let other = BooleanOperand { op: BooleanOp::Difference, name: "b.obj".into(), input: tetrahedron(0.5)? };
/// let spec = BudgetSpec::default();
/// let made = mesh_boolean(tetrahedron(0.0)?, vec![other], &spec, Format::Ply, &Default::default())?;
/// assert!(made.certificate.valid.unwrap().counts.closed);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn mesh_boolean(
    first: Input,
    others: Vec<BooleanOperand>,
    spec: &BudgetSpec,
    to: impl Into<OutputForm>,
    job: &Job,
) -> Result<MeshOutcome, MeshFailure> {
    let form: OutputForm = to.into();
    check_request(spec, form, &first)?;
    // 1. What each shape is, before it becomes triangles.
    let mut certificate = Certificate::from_input(&first);
    let (budget, note) = spec.resolve(&first.shape)?;
    certificate.budget = spec.has_limit().then(|| BudgetFacts::new(&budget));
    certificate.notes.extend(note);
    let mut bounds = first.shape.bounds()?;
    for other in &others {
        bounds = bounds.union(other.input.shape.bounds()?);
        check_frames(&first, other, &mut certificate.notes)?;
    }
    let request = MeshRequest::new(budget, form, bounds);
    let inputs: Vec<InputFacts> = std::iter::once(&first)
        .chain(others.iter().map(|other| &other.input))
        .map(InputFacts::from_input)
        .collect();
    let (format, frame) = (first.format, *first.shape.frame());
    let ops: Vec<BooleanOp> = others.iter().map(|other| other.op).collect();
    let names: Vec<String> = std::iter::once("the input".to_owned())
        .chain(others.iter().map(|other| other.name.clone()))
        .collect();
    // 2. Triangles for each.
    let within = if spec.has_limit() {
        let rounding = add_up(request.rounding(), cutting_slack(&bounds));
        request.reserve_rounding(rounding)?.length_in(&bounds)
    } else {
        None
    };
    let within = within.and_then(|length| chordal::Tolerance::new(length).ok());
    let inputs_of = std::iter::once(first).chain(others.into_iter().map(|other| other.input));
    let mut operands = Vec::new();
    for (input, name) in inputs_of.zip(&names) {
        operands.push(SolidOperand::new(input, within, (name, &mut certificate.notes), job)?);
    }
    // 3. The cut, rounded before it is checked.
    let target = RoundingTarget::new(form.format, request.lattice);
    let made = loop {
        match cut(&operands, &ops, target, job) {
            Err(CutFailure::NotClosed { operand, boundary_edges }) => {
                let name = &names[operand];
                let within = within.ok_or_else(|| not_closed(name, boundary_edges))?;
                let open = operands.remove(operand);
                operands.insert(operand, open.closed(within, (name, &mut certificate.notes), job)?);
            }
            Err(CutFailure::Other(failure)) => return Err(failure),
            Ok(made) => break made,
        }
    };
    if made.mesh.faces().is_empty() {
        let message = "nothing would be left: no point is inside the result";
        return Err(MeshFailure::refused(RefusalCode::Empty, message));
    }
    let bound = whole_bound(&made, &operands);
    certificate.boolean = Some(facts(&made, (&operands, &ops), inputs));
    // 4. What its faces carry.
    let mut scene = carried::scene_of(&made, operands, frame, &mut certificate.notes)?;
    spec.normals.apply(&mut scene, [format, form.format], &mut certificate.notes)?;
    let outcome = finish_triangles(scene, bound, &request, certificate)?;
    // Without a limit there is nothing to miss, but what fails its check is no result.
    if outcome.bound.evidence().bounds_above() {
        Ok(outcome)
    } else {
        Err(MeshFailure::Unmet(Box::new(outcome)))
    }
}

fn check_request(spec: &BudgetSpec, form: OutputForm, first: &Input) -> Result<(), MeshFailure> {
    formats::check_output(&first.shape, form.format).map_err(MeshFailure::Usage)?;
    let lines = form.format.holds_polylines();
    if lines {
        let message = format!("{} holds no triangles, and a combined solid is made of them", form.format);
        return Err(MeshFailure::Usage(message.into()));
    }
    spec.check_counts(lines).map_err(MeshFailure::Usage)?;
    if let Some(n) = spec.triangles {
        let message = Message::from("a cut has as many triangles as it takes: leave out ")
            .value(Setting::Triangles, n)
            .words(", and simplify what was written");
        return Err(MeshFailure::Usage(message));
    }
    if spec.attributes.is_set() {
        let message = "attributes are carried exactly along a cut: limits on them are for simplification";
        return Err(MeshFailure::refused(RefusalCode::Budget, message));
    }
    Ok(())
}

/// Refuses units that differ, and says where axes do.
fn check_frames(first: &Input, other: &BooleanOperand, notes: &mut Vec<Message>) -> Result<(), MeshFailure> {
    let (a, b) = (first.shape.frame(), other.input.shape.frame());
    if let (Some(own), Some(its)) = (a.metres_per_unit, b.metres_per_unit)
        && own != its
    {
        let message = format!(
            "{}: a unit is {its} m there and {own} m in the input: convert one of them first, or say ",
            other.name
        );
        return Err(MeshFailure::Usage(Message::from(message).setting(Setting::Unit)));
    }
    if let (Some(own), Some(its)) = (a.up, b.up)
        && own != its
    {
        let message = format!(
            "{}: its axis {} is up, and that of the input is {}: nothing was turned",
            other.name,
            its.letter(),
            own.letter()
        );
        notes.push(message.into());
    }
    Ok(())
}

/// What the vertices of a cut are off by, generously: some hundred steps of rounding.
fn cutting_slack(bounds: &Box3) -> f64 {
    let reach = bounds.min.iter().chain(&bounds.max).fold(0.0, |most, x| greater(x.abs(), most));
    // Measured on random solids: below 20 steps where faces meet at more than a degree.
    1024.0 * f64::EPSILON * reach
}

/// Cuts the operands along each other.
fn cut(
    operands: &[SolidOperand],
    ops: &[BooleanOp],
    target: RoundingTarget,
    job: &Job,
) -> Result<BooleanMesh, CutFailure> {
    let steps: Vec<BooleanStep> = ops
        .iter()
        .zip(&operands[1..])
        .map(|(op, operand)| BooleanStep { op: *op, mesh: &operand.mesh })
        .collect();
    let overflow: Mutex<Option<CoordinateOverflow>> = Mutex::default();
    let snap = |positions: &mut [[f64; 3]]| {
        let points = Mesh::new(positions.to_vec(), Vec::new()).map_err(|invalid| {
            JobError::Refused(Refusal::new(RefusalCode::NotFinite, invalid.to_string()))
        })?;
        match target.snap(&points) {
            Ok(snapped) => {
                positions.copy_from_slice(snapped.mesh.positions());
                Ok(())
            }
            Err(why) => {
                *overflow.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Some(why);
                Err(JobError::Refused(Refusal::new(RefusalCode::NotFinite, why.to_string())))
            }
        }
    };
    let made = boolean_snapped(&operands[0].mesh, &steps, &snap, job);
    if let Some(why) = overflow.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner) {
        return Err(CutFailure::Other(MeshFailure::TooWide(why)));
    }
    made.map_err(|error| match error {
        BooleanError::Stopped(stopped) => CutFailure::Other(stopped.into()),
        BooleanError::NotClosed { operand, boundary_edges } => {
            CutFailure::NotClosed { operand, boundary_edges }
        }
    })
}

/// Why there is no cut yet.
enum CutFailure {
    /// An operand has to be closed first.
    NotClosed {
        operand: usize,
        boundary_edges: u64,
    },
    Other(MeshFailure),
}

fn not_closed(name: &str, boundary_edges: u64) -> MeshFailure {
    let (why, cure) = if boundary_edges == 0 {
        ("neighbours are wound against each other".to_owned(), Cure::Orient)
    } else {
        (format!("{boundary_edges} edges have one triangle only"), Cure::FillHoles)
    };
    let message = Message::from(format!("{name}: it bounds no solid, since {why}: mend it ("))
        .setting(Setting::Cure(cure))
        .words("), or give a length, within which its surface is made anew by winding numbers");
    MeshFailure::refused(RefusalCode::Unsupported, message)
}

/// The bound of the cut, and the largest of the operands' own: farther than both together from all surfaces
/// the triangles of an operand, and those cut from them, leave every point on its side.
fn whole_bound(made: &BooleanMesh, operands: &[SolidOperand]) -> Bound {
    let own: Vec<&Bound> = operands.iter().filter_map(|operand| operand.bound.as_ref()).collect();
    if own.is_empty() {
        return made.bound.clone();
    }
    // A distance between surfaces says nothing of their sides.
    let sides = "what is farther from a shape than the bound of its triangles is on the same side of both";
    let sides = Evidence::ProvedIf(vec![sides.to_owned()]);
    let all = made.bound.evidence().weaker(&sides);
    let evidence = own.iter().fold(all, |all, bound| all.weaker(bound.evidence()));
    let largest =
        own.iter().map(|bound| bound.at_most()).try_fold(0.0, |most, own| Some(greater(own?, most)));
    let at_most = made.bound.at_most().zip(largest).map(|(cut, own)| add_up(cut, own));
    let (at_most, evidence) = match at_most {
        Some(most) if most.is_finite() && evidence.bounds_above() => (Some(most), evidence),
        _ => (None, Evidence::Estimated),
    };
    let mut bound = Bound::with_evidence(0.0, at_most, evidence, made.bound.reference.clone());
    (bound.metric, bound.at) = (Metric::Solid, made.bound.at);
    bound
}

fn facts(
    made: &BooleanMesh,
    (operands, ops): (&[SolidOperand], &[BooleanOp]),
    inputs: Vec<InputFacts>,
) -> BooleanFacts {
    let mut kept = vec![0; operands.len()];
    made.sources.iter().for_each(|source| kept[source.operand as usize] += 1);
    let all_ops = std::iter::once(None).chain(ops.iter().map(|op| Some(op.as_str())));
    let rows = all_ops.zip(inputs).zip(operands.iter().zip(kept));
    let operands = rows
        .map(|((op, input), (operand, kept))| BooleanOperandFacts {
            op,
            input,
            triangles: operand.mesh.faces().len() as u64,
            kept,
            bound: operand.bound.as_ref().map(BoundFacts::new),
        })
        .collect();
    BooleanFacts { method: made.method.as_str(), operands }
}
