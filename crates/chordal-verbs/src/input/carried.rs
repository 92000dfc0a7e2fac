//! The scripts that a file carries in its certificate: read, and run again.
use crate::report::{SourceFacts, SourceFileFacts, sources_in};
use crate::{FormatHint, Input, Shape, load_within};
use chordal::Job;
use chordal_io::{FileOpener, Format, Limits, ReadError};

/// The scripts that a file carries: those that it was made from, the first operand's first; none for a file without a
/// certificate, and for inputs that were no scripts.
///
/// ```
/// use chordal_io::Format;
/// use chordal_verbs::{BudgetSpec, FormatHint, carried_sources, load, mesh};
/// let hint = FormatHint { name: Some("ball.star"), ..FormatHint::default() };
/// let spec = BudgetSpec { length: Some("1%".parse()?), ..BudgetSpec::default() };
/// let mut glb = Vec::new();
/// mesh(load(b"sphere(1)\n", hint, &Default::default())?, &spec, Format::Glb, &Default::default())?.write(&mut glb)?;
/// let sources = carried_sources(&load(&glb, FormatHint::default(), &Default::default())?);
/// assert_eq!((&*sources[0].name, &*sources[0].text), ("ball.star", "sphere(1)\n"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn carried_sources(input: &Input) -> Vec<SourceFacts> {
    let Shape::Scene(scene) = &input.shape else { return Vec::new() };
    scene.certificate.as_ref().map_or_else(Vec::new, sources_in)
}

/// Runs a carried script again, with the parameters that were set. `open` returns the files that are not carried.
///
/// # Errors
/// As for [`load_within`].
pub fn load_carried(
    source: &SourceFacts,
    open: &mut FileOpener<'_>,
    limits: &Limits,
    job: &Job,
) -> Result<Input, ReadError> {
    let set: Vec<(String, f64)> = source.parameters.iter().map(|(name, x)| (name.clone(), *x)).collect();
    let (name, format) = (Some(&*source.name), Some(Format::Star));
    let hint = FormatHint { name, format, set: &set, ..FormatHint::default() };
    let mut open = |path: &str| match source.files.iter().find(|file| file.path == path) {
        Some(SourceFileFacts { text: Some(text), .. }) => Ok(text.clone().into_bytes()),
        _ => open(path),
    };
    load_within(source.text.as_bytes(), hint, &mut open, limits, job)
}
