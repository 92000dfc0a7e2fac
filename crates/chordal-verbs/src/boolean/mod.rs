//! `mesh_boolean`: the union, difference and intersection of shapes as triangles.
mod carried;
mod operand;
pub(crate) mod solid_cut;

use crate::mesh::request::MeshRequest;
use crate::output::file_rows::order_new_triangles;
use crate::output::finish::finish_triangles;
use crate::output::format_rounding::RoundingTarget;
use crate::report::{
    BooleanFacts, BooleanOperandFacts, BoundFacts, BudgetFacts, Certificate, InputFacts, VerbFacts,
};
use crate::{BudgetSpec, Input, MeshFailure, MeshOutcome, OutputForm, formats};
use chordal::boolean::{BooleanMesh, BooleanOp};
use chordal::budget::advice::{Cure, Message, Setting};
use chordal::budget::{Bound, RefusalCode};
use chordal::math::add_up;
use chordal::{Job, Mesh};
use operand::SolidOperand;
use solid_cut::{CutFailure, cut, cutting_slack, total_bound};

/// One more shape, and the operation that combines it.
#[derive(Clone, Debug)]
pub struct BooleanOperand {
    /// How it is combined with the result so far.
    pub op: BooleanOp,
    /// The name of the shape in messages.
    pub name: String,
    /// The shape.
    pub input: Input,
}

/// Combines shapes from left to right as triangles that read back from a file of the format `to`: see
/// [`chordal::boolean::boolean`].
///
/// Triangles are cut as they are, with the colours, materials, texture coordinates and normals that they carry. Other shapes
/// become triangles first, within the length of the budget less the rounding. The bound adds the largest of their bounds
/// to that of the cut, with the metric "solid": points farther than it from the shapes' surfaces are on the correct side.
///
/// # Errors
/// If a shape bounds no solid, or needs a length and the budget has none; if nothing is left; if the result fails its own
/// check or misses the budget, with the outcome; if the work is refused, or cancelled.
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
/// let outcome = mesh_boolean(tetrahedron(0.0)?, vec![other], &spec, Format::Ply, &Default::default())?;
/// assert!(outcome.certificate.valid.unwrap().counts.closed);
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
    // 1. The facts about each shape, before it becomes triangles.
    let mut certificate = Certificate::from_input(&first);
    let (budget, note) = spec.resolve(&first.shape)?;
    certificate.budget = spec.has_limit().then(|| BudgetFacts::new(&budget));
    certificate.notes.extend(note);
    let mut bounds = first.shape.bounds()?;
    for other in &others {
        bounds = bounds.union(other.input.shape.bounds()?);
        certificate.add_sources_of(&other.input);
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
    let length = if spec.has_limit() {
        let rounding = add_up(request.rounding(), cutting_slack(&bounds));
        request.reserve_rounding(rounding)?.length_in(&bounds)
    } else {
        None
    };
    let tolerance = length.and_then(|length| chordal::Tolerance::new(length).ok());
    let inputs_of = std::iter::once(first).chain(others.into_iter().map(|other| other.input));
    let mut operands = Vec::new();
    for (input, name) in inputs_of.zip(&names) {
        operands.push(SolidOperand::new(input, tolerance, (name, &mut certificate.notes), job)?);
    }
    // 3. The cut, rounded before it is checked.
    let target = RoundingTarget::new(form.format, request.lattice);
    let mut is_repaired = vec![false; operands.len()];
    let solid = loop {
        let meshes: Vec<&Mesh> = operands.iter().map(|operand| &operand.mesh).collect();
        match cut(&meshes, &ops, target, job) {
            Err(CutFailure::NotClosed { operand, boundary_edges }) => {
                let name = &names[operand];
                // A repair that left it open would leave it open again, without end.
                let tolerance = tolerance
                    .filter(|_| !std::mem::replace(&mut is_repaired[operand], true))
                    .ok_or_else(|| not_closed(name, boundary_edges))?;
                let open = operands.remove(operand);
                operands.insert(operand, open.closed(tolerance, (name, &mut certificate.notes), job)?);
            }
            Err(CutFailure::Other(failure)) => return Err(failure),
            Ok(solid) => break solid,
        }
    };
    if solid.mesh.faces().is_empty() {
        let message = "nothing would be left: no point is inside the result";
        return Err(MeshFailure::refused(RefusalCode::Empty, message));
    }
    let operand_bounds: Vec<&Bound> = operands.iter().filter_map(|operand| operand.bound.as_ref()).collect();
    let bound = total_bound(&solid, &operand_bounds);
    certificate.verb = VerbFacts::Boolean { boolean: facts(&solid, (&operands, &ops), inputs) };
    // 4. The attributes of its faces.
    let mut scene = carried::scene_of(&solid, operands, frame, &mut certificate.notes)?;
    spec.normals.apply(&mut scene, [format, form.format], &mut certificate.notes)?;
    order_new_triangles(&mut scene)?;
    let outcome = finish_triangles(scene, bound, &request, certificate)?;
    // Without a limit no budget is missed, but a solid that fails its check has no bound and is no result.
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
            .words(", and simplify the output");
        return Err(MeshFailure::Usage(message));
    }
    if spec.offset.is_some() {
        let message = "an offset is of one solid: write it to a file first, and combine that";
        return Err(MeshFailure::Usage(message.into()));
    }
    if spec.attributes.is_set() {
        let message = "attributes are carried exactly along a cut: limits on them are for simplification";
        return Err(MeshFailure::refused(RefusalCode::Budget, message));
    }
    Ok(())
}

/// Refuses different units, and notes different axes.
fn check_frames(first: &Input, other: &BooleanOperand, notes: &mut Vec<Message>) -> Result<(), MeshFailure> {
    let (a, b) = (first.shape.frame(), other.input.shape.frame());
    if let (Some(input_unit), Some(other_unit)) = (a.metres_per_unit, b.metres_per_unit)
        && input_unit != other_unit
    {
        let message = format!(
            "{}: a unit is {other_unit} m there and {input_unit} m in the input: convert one of them first, or set ",
            other.name
        );
        return Err(MeshFailure::Usage(Message::from(message).setting(Setting::Unit)));
    }
    if let (Some(input_axis), Some(other_axis)) = (a.up, b.up)
        && input_axis != other_axis
    {
        let message = format!(
            "{}: its axis {} is up, and that of the input is {}: nothing was rotated",
            other.name,
            other_axis.letter(),
            input_axis.letter()
        );
        notes.push(message.into());
    }
    Ok(())
}

fn not_closed(name: &str, boundary_edges: u64) -> MeshFailure {
    let (reason, cure) = if boundary_edges == 0 {
        ("neighbours are wound against each other".to_owned(), Cure::Orient)
    } else {
        (format!("{boundary_edges} edges have one triangle only"), Cure::FillHoles)
    };
    let message = Message::from(format!("{name}: it bounds no solid, since {reason}: mend it ("))
        .setting(Setting::Cure(cure))
        .words("), or give a length, within which its surface is rebuilt by winding numbers");
    MeshFailure::refused(RefusalCode::Unsupported, message)
}

fn facts(
    solid: &BooleanMesh,
    (operands, ops): (&[SolidOperand], &[BooleanOp]),
    inputs: Vec<InputFacts>,
) -> BooleanFacts {
    let mut kept = vec![0; operands.len()];
    solid.sources.iter().for_each(|source| kept[source.operand as usize] += 1);
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
    BooleanFacts { method: solid.method.as_str(), operands }
}
