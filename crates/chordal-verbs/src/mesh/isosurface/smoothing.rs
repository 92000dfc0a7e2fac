//! The surface of a mask after a Gaussian, with the error of smoothing.
use crate::input::volume::{SuggestedLevel, VolumeShape};
use crate::report::SmoothingFacts;
use crate::{MeshFailure, SmoothingWidth};
use chordal::budget::advice::{Message, Setting};
use chordal::budget::{Failure, digits};
use chordal::convert::Polygonize;
use chordal::convert::lattices::{SmoothedMask, mask_to_smooth_mesh};
use chordal::{Bounded, Job, Mesh};

/// The standard deviation along each index, in samples.
fn in_samples(width: SmoothingWidth, sampled: &VolumeShape) -> Result<[f64; 3], MeshFailure> {
    let length = match width {
        SmoothingWidth::Samples(samples) => return Ok([samples; 3]),
        SmoothingWidth::Length(length) => {
            let unit = sampled.volume.frame.metres_per_unit;
            length.resolve(sampled.bounds().diagonal(), unit).map_err(MeshFailure::Length)?.get()
        }
    };
    let steps = sampled.volume.grid.affine().steps();
    Ok(steps.map(|[x, y, z]| length / (x * x + y * y + z * z).sqrt()))
}

/// How often half of a width that is too large is tried instead. Chosen: a sixteenth of a width hardly changes a mask.
const HALVINGS: u32 = 4;

/// The surface of a mask after a Gaussian, with its bound against the unsmoothed mask, and the facts of smoothing. `length`
/// is the length that the budget allows.
///
/// # Errors
/// If the samples are not a mask; as for [`mask_to_smooth_mesh`].
pub(crate) fn smoothed_surface(
    sampled: &VolumeShape,
    (rule, suggested): (&Polygonize, Option<&SuggestedLevel>),
    (width, length): (SmoothingWidth, f64),
    job: &Job,
) -> Result<(Bounded<Mesh>, SmoothingFacts), MeshFailure> {
    if suggested.is_none_or(|suggestion| suggestion.kind != "mask" || suggestion.level != rule.level) {
        let message = Message::from(
            "only masks can be smoothed, samples with two whole numbers as values, at the level between them: without ",
        );
        return Err(MeshFailure::Usage(
            message.setting(Setting::Smooth).words(" the surface is that of the samples"),
        ));
    }
    let grid = &sampled.volume.grid;
    let sigma = in_samples(width, sampled)?;
    let smoothed = |factor: f64| mask_to_smooth_mesh(grid, rule, sigma.map(|sigma| factor * sigma), job);
    let Bounded { shape, bound } = smoothed(1.0).map_err(|failure| MeshFailure::from_missed(failure, ""))?;
    let SmoothedMask { mesh, inside, changed } = shape;
    let mut facts = SmoothingFacts::new(sigma, (inside, changed), &bound);
    if bound.at_most().is_none_or(|most| most > length) {
        facts.fits = narrower_within(length, smoothed)?.map(|factor| width.times(factor).to_string());
    }
    Ok((Bounded { shape: mesh, bound }, facts))
}

/// The factor of a width within a length, after a few halvings.
fn narrower_within(
    length: f64,
    smoothed: impl Fn(f64) -> Result<Bounded<SmoothedMask>, Failure<Mesh>>,
) -> Result<Option<f64>, MeshFailure> {
    let mut factor = 1.0;
    for _ in 0..HALVINGS {
        factor *= 0.5;
        match smoothed(factor) {
            Ok(mesh) if mesh.bound.at_most().is_some_and(|most| most <= length) => return Ok(Some(factor)),
            // A narrower Gaussian may leave a surface even if this one left none.
            Ok(_) | Err(Failure::Refused(_) | Failure::Unmet(_)) => {}
            Err(Failure::Cancelled) => return Err(MeshFailure::Cancelled),
        }
    }
    Ok(None)
}

/// The note on smoothing.
pub(crate) fn smoothing_note(width: SmoothingWidth, facts: &SmoothingFacts) -> Message {
    let moved = facts.at_most.map_or_else(|| "no known length".to_owned(), digits);
    let sentence = format!(
        "smoothed by a Gaussian of {width}: {} samples changed sides, where {} were inside, and the surface moved by at most \
         {moved}",
        facts.changed, facts.inside
    );
    match &facts.fits {
        Some(fits) => Message::from(format!("{sentence}, more than the budget; "))
            .value(Setting::Smooth, fits)
            .words(" is within it"),
        None => sentence.into(),
    }
}
