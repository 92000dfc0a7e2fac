//! `convert_certified`: the same triangles in another format, with the certificate that they had.
use super::{ConvertOutcome, convert_within};
use crate::provenance::origin::{embedded_certificate, stated_frame};
use crate::provenance::seal::{SEAL, seal_of};
use crate::report::to_value;
use crate::{Input, MeshFailure, OutputForm, history_of};
use chordal::Job;
use chordal_io::{Frame, TextureOrigin};
use serde_json::Value;

/// As [`convert`](crate::convert()), if every coordinate stays as it is: then the certificate of the file still holds, and the
/// new file gets it instead of one more step. So a mesh that was proved once can be written in several formats, each of which
/// is verified from the first shape alone.
///
/// The frame is that of the certificate: a glTF of a shape without a unit and an up axis is written without them, too.
///
/// # Errors
/// [`MeshFailure::Usage`] if the file has no certificate that holds for it, or the format changes a coordinate; as for
/// [`convert`](crate::convert()).
///
/// ```
/// use chordal_io::Format;
/// use chordal_verbs::{BudgetSpec, FormatHint, convert_certified, history_of, load, mesh};
/// let read = |bytes: &[u8], name| load(bytes, FormatHint { name: Some(name), ..FormatHint::default() }, &Default::default());
/// let spec = BudgetSpec { length: Some("1%".parse()?), ..BudgetSpec::default() };
/// let (mut glb, mut again) = (Vec::new(), Vec::new());
/// let meshed = mesh(read(b"sphere(1)\n", "ball.star")?, &spec, Format::Glb, &Default::default())?;
/// meshed.write(&mut glb)?;
/// convert_certified(read(&glb, "ball.glb")?, Format::ThreeMf, &Default::default())?.write(&mut again)?;
/// assert_eq!(history_of(&read(&again, "ball.3mf")?).steps.len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn convert_certified(
    mut input: Input,
    to: impl Into<OutputForm>,
    job: &Job,
) -> Result<ConvertOutcome, MeshFailure> {
    let history = history_of(&input);
    let certificate = embedded_certificate(&input.shape).cloned();
    let (Some(mut certificate), Some(last)) = (certificate, history.steps.last()) else {
        let reason = format!("there is no certificate to keep: {}", history.begins.reason);
        return Err(MeshFailure::Usage(reason.into()));
    };
    let stated = stated_frame(&certificate);
    let texture_origin: Option<TextureOrigin> = input.shape.frame().texture_origin;
    *input.shape.frame_mut() = Frame { texture_origin, ..stated };
    let mut outcome = convert_within(input, to, None, job)?;
    let new_history = outcome.certificate.history.as_ref();
    let written = new_history.and_then(|history| history.steps.last()).map(|step| &step.output);
    let is_same = written.is_some_and(|written| written.geometry == last.output.geometry);
    if !is_same || outcome.bound.at_most() != Some(0.0) {
        let message = format!(
            "{} does not hold the coordinates as they are, so that the certificate of the file is not one of it",
            outcome.format
        );
        return Err(MeshFailure::Usage(message.into()));
    }
    // Rows are those of the format, so that counts of vertices may differ.
    certificate["output"] = to_value(&outcome.certificate.output);
    certificate["valid"] = to_value(&outcome.certificate.valid);
    if let Some(format) = certificate
        .pointer_mut("/history/steps")
        .and_then(Value::as_array_mut)
        .and_then(|steps| steps.last_mut())
        .and_then(|step| step.pointer_mut("/output/format"))
    {
        *format = outcome.format.to_string().into();
    }
    if !outcome.format.carries_sources()
        && let Some(facts) = certificate.as_object_mut()
    {
        facts.remove("sources");
    }
    certificate[SEAL] = seal_of(&certificate).into();
    outcome.certificate.kept = Some(certificate);
    Ok(outcome)
}
