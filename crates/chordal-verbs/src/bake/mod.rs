//! `bake`: a signed distance grid of any shape that bounds a solid.
mod samples;
mod source;
mod spec;

use crate::formats::{in_words, names_where};
use crate::mesh::isosurface::zero_set::zero_set_distance;
use crate::provenance::geometry_digest::samples_digest;
use crate::report::{
    BoundFacts, BudgetFacts, Certificate, DistanceGridFacts, InterpolantFacts, SolidFacts, VerbFacts,
};
use crate::{BudgetSpec, Input, MeshFailure};
use chordal::Job;
use chordal::budget::advice::{Message, Setting};
use chordal::budget::{Bound, Evidence, RefusalCode, Tolerance};
use chordal::check::zero_set_deviation;
use chordal::implicit::SparseGrid;
use chordal::implicit::evaluation::SampleGrid;
use chordal::math::{add_up, greater, sub_down};
use chordal_io::{Format, Frame, Volume, WriteError, write_sparse_volume, write_volume};
use samples::BakedSamples;
pub(crate) use samples::{interpolant_error, off_at_most};
use source::{DistanceSource, SampledDistances};
pub use spec::{BakeResolution, BakeSpec};
use std::io::Write;
use std::sync::Arc;

/// The note if there is no bound for the surface of the samples.
const UNBOUNDED: &str = "nothing was proved of how far the surface of the samples is from the shape: take smaller \
                         cells, and mend holes";

/// A distance grid with its certificate.
#[derive(Clone, Debug)]
pub struct BakeOutcome {
    /// The samples and their lattice.
    pub volume: BakedVolume,
    /// The output format.
    pub format: Format,
    /// The facts about the grid.
    pub certificate: Certificate,
    /// Why the budget was not met, if it was not: then this is the best result that was reached.
    pub unmet: Option<Message>,
}

/// Samples with their frame.
#[derive(Clone, Debug, PartialEq)]
pub enum BakedVolume {
    /// All samples.
    Dense(Volume),
    /// The samples of the bricks that a band reaches.
    Sparse(SparseGrid, Frame),
}

impl BakedVolume {
    /// All samples.
    #[must_use]
    pub fn into_dense(self) -> Volume {
        match self {
            Self::Dense(volume) => volume,
            Self::Sparse(grid, frame) => Volume { frame, ..Volume::from_grid(grid.to_dense()) },
        }
    }
}

impl BakeOutcome {
    /// Writes the grid, with the certificate if the format can carry it.
    ///
    /// # Errors
    /// If the sink fails.
    pub fn write(&self, out: &mut dyn Write) -> Result<(), WriteError> {
        let certificate = Some(self.certificate.to_value());
        match &self.volume {
            BakedVolume::Dense(volume) => write_volume(volume, certificate.as_ref(), self.format, out),
            BakedVolume::Sparse(grid, frame) => {
                write_sparse_volume(grid, frame, certificate.as_ref(), (self.format, out))
            }
        }
    }
}

/// Samples the signed distance to a shape on a cubic lattice, negative inside. Every distance is then bounded from both
/// sides, so that the errors of the samples and of their interpolant in the certificate are proved.
///
/// Triangles are taken as they are, and a field whose value is a distance on both sides is sampled itself. Other shapes
/// are meshed first, within a 16th of a cell or a quarter of the length; the bounds include that error.
///
/// # Errors
/// If the shape bounds nothing or the format holds no lattice; as for [`mesh_to_grid`](chordal::convert::mesh_to_grid).
///
/// ```
/// use chordal_io::Format;
/// use chordal_verbs::{BakeSpec, FormatHint, bake, load};
/// let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
/// let input = load(obj, FormatHint { name: Some("corner.obj"), ..FormatHint::default() }, &Default::default())?;
/// let outcome = bake(input, &BakeSpec::cells(8), Format::Nrrd, &Default::default())?;
/// let facts = outcome.certificate.verb.grid().unwrap();
/// assert!(facts.solid.as_ref().unwrap().is_solid && facts.size == [15; 3] && facts.off_at_most.unwrap() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn bake(input: Input, spec: &BakeSpec, to: Format, job: &Job) -> Result<BakeOutcome, MeshFailure> {
    if !to.holds_volumes() {
        let names = in_words(&names_where(Format::holds_volumes), "and");
        return Err(MeshFailure::Usage(format!("{to} holds no lattice; {names} do").into()));
    }
    if spec.is_sparse && spec.band.is_none() {
        return Err(MeshFailure::Usage("samples are sparse beyond a band, and none was given".into()));
    }
    let mut certificate = Certificate::from_input(&input);
    let frame = *input.shape.frame();
    let limit = match spec.resolution {
        BakeResolution::Cells(_) => None,
        BakeResolution::Within(length) => {
            let budget = BudgetSpec { length: Some(length), ..BudgetSpec::default() };
            let (budget, note) = budget.resolve(&input.shape)?;
            certificate.notes.extend(note);
            certificate.budget = Some(BudgetFacts::new(&budget));
            budget.length
        }
    };
    let within = match (limit, spec.resolution) {
        (Some(limit), _) => LENGTH_SHARE * limit.get(),
        (None, BakeResolution::Cells(cells)) => CELL_SHARE * longest_side(&input)? / cells as f64,
        // A length always has a limit by now; if not, NaN is refused below.
        (None, BakeResolution::Within(_)) => f64::NAN,
    };
    let within = Tolerance::new(within).map_err(|_| {
        MeshFailure::refused(RefusalCode::Empty, "the shape has no size that cells could divide")
    })?;
    let longest = longest_side(&input)?;
    let needs_triangles = spec.is_bounded || limit.is_some();
    let source = DistanceSource::new(input.shape, (within, needs_triangles), &mut certificate.notes, job)?;
    let (sampled, surface, unmet) = match (spec.resolution, limit) {
        (BakeResolution::Cells(cells), _) => {
            let sampled = source.sample(cells, spec, job)?;
            let surface = if spec.is_bounded { surface_of(&source, &sampled, job)? } else { None };
            if spec.is_bounded && surface.is_none() {
                certificate.notes.push(UNBOUNDED.into());
            }
            (sampled, surface, None)
        }
        (_, limit) => bake_within(&source, (limit.unwrap_or(within), longest), spec, job)?,
    };
    certificate.bound = surface.as_ref().map(BoundFacts::new);
    certificate.verb = VerbFacts::Baked { baked: Box::new(facts(&source, &sampled, job)?) };
    if let Some(solid) = sampled.solid.as_ref().filter(|solid| !solid.is_solid()) {
        certificate.notes.push(solid.to_string().into());
    }
    if to.is_array() {
        certificate.notes.push(format!("{to} holds no origin and no step: this report has both").into());
    }
    // An array does not hold the origin and the step of the lattice.
    certificate.conclude(("volume", to), (!to.is_array()).then(|| samples_digest(&sampled.samples)));
    let volume = match sampled.samples {
        BakedSamples::Dense(grid) => {
            BakedVolume::Dense(Volume { frame, ..Volume::from_grid(Arc::unwrap_or_clone(grid)) })
        }
        BakedSamples::Sparse(grid) => BakedVolume::Sparse(Arc::unwrap_or_clone(grid), frame),
    };
    Ok(BakeOutcome { volume, format: to, certificate, unmet })
}

/// The share of a length within which a shape is meshed. Chosen: most of the length stays for the lattice.
const LENGTH_SHARE: f64 = 0.25;
/// The share of a cell within which a shape is meshed if cells are given. Chosen: the error of an interpolant of smooth
/// distances is about as large.
const CELL_SHARE: f64 = 1.0 / 16.0;

fn longest_side(input: &Input) -> Result<f64, MeshFailure> {
    let bounds = input.shape.bounds()?;
    Ok((0..3).fold(0.0, |most, k| greater(bounds.max[k] - bounds.min[k], most)))
}

/// A bound for the distance of the surface of samples from the shape; `None` if nothing is proved.
fn surface_of(
    source: &DistanceSource,
    sampled: &SampledDistances,
    job: &Job,
) -> Result<Option<Bound>, MeshFailure> {
    let Some(triangles) = &source.triangles else { return Ok(None) };
    let bound = zero_set_distance(&sampled.samples, &triangles.mesh, job)?;
    Ok(bound.map(|bound| triangles.then(&bound)))
}

/// The first lattice whose surface is proved to be within a length of the shape; or else the best one, and why it is not.
fn bake_within(
    source: &DistanceSource,
    (limit, longest): (Tolerance, f64),
    spec: &BakeSpec,
    job: &Job,
) -> Result<(SampledDistances, Option<Bound>, Option<Message>), MeshFailure> {
    let lost = source.triangles.as_ref().and_then(|triangles| triangles.bound.at_most());
    // The sum of both parts is rounded up once; the rounding is less than the last term here.
    let remaining =
        lost.map_or(0.0, |lost| sub_down(sub_down(limit.get(), lost), f64::EPSILON * limit.get()));
    let Ok(remaining) = Tolerance::new(remaining) else {
        let message =
            format!("the shape is not proved to be meshed within {limit}, as a length for its lattice asks");
        return Err(MeshFailure::refused(RefusalCode::Budget, message));
    };
    let cells_for = |share: f64| {
        let cells = (longest / remaining.get() * share).ceil();
        // More cells than any lattice may have, so that the lattice refuses them.
        if cells < FEWEST { FEWEST as usize } else { cells as usize }
    };
    let mut best: Option<SampledDistances> = None;
    let mut reason = None;
    let mut tried = 0;
    for share in SHARES {
        let cells = cells_for(share);
        // Several small shares give the same fewest cells.
        if cells == tried {
            continue;
        }
        tried = cells;
        if share > MANY && cells as f64 > MOST_CELLS {
            reason = Some(
                format!("{cells} cells along the longest side would be next, which are not tried unasked")
                    .into(),
            );
            break;
        }
        let sampled = match source.sample(cells, spec, job) {
            Ok(sampled) => sampled,
            Err(MeshFailure::Refused(refusal)) if best.is_some() => {
                let message =
                    Message::from(format!("{cells} cells along the longest side would be next, and "));
                reason = Some(
                    message
                        .message(&refusal.message)
                        .words(": ")
                        .setting(Setting::MaxMemory)
                        .words(" allows more"),
                );
                break;
            }
            Err(failure) => return Err(failure),
        };
        if let Some(bound) = zero_set_deviation(triangles_of(source)?, &sampled.samples, remaining, job)? {
            let bound = source.triangles.as_ref().map(|triangles| triangles.then(&bound));
            if bound.as_ref().and_then(Bound::at_most).is_some_and(|most| most <= limit.get()) {
                return Ok((sampled, bound, None));
            }
        }
        let is_closed = sampled.solid.as_ref().is_none_or(|solid| solid.closed);
        best = Some(sampled);
        if !is_closed {
            reason = Some(
                "the mesh has holes, which the surface of samples closes somehow: mend them first".into(),
            );
            break;
        }
    }
    // The last one that was sampled, which is the finest: none has a bound yet to choose by.
    let Some(sampled) = best else {
        return Err(MeshFailure::refused(RefusalCode::Budget, "no lattice was tried"));
    };
    let bound = surface_of(source, &sampled, job)?;
    // The bound may be proved with lengths in shares of a cell although it was not with the whole limit.
    if bound.as_ref().and_then(Bound::at_most).is_some_and(|most| most <= limit.get()) {
        return Ok((sampled, bound, None));
    }
    let reached = bound.as_ref().map_or_else(|| "no bound".to_owned(), Bound::to_string);
    let [x, y, z] = sampled.samples.size();
    let mut message = Message::from(format!(
        "the budget was not met; the best reached is {reached} with {x} x {y} x {z} samples"
    ));
    let reason = reason.unwrap_or_else(|| {
        "cells of a 64th of the length prove no more: parts may be thinner than it, or corners too sharp"
            .into()
    });
    message = message.words("; ").message(&reason);
    Ok((sampled, bound, Some(message)))
}

fn triangles_of(source: &DistanceSource) -> Result<&chordal::Mesh, MeshFailure> {
    let triangles = source.triangles.as_ref().map(|triangles| &triangles.mesh);
    triangles.ok_or_else(|| {
        MeshFailure::refused(RefusalCode::Empty, "there are no triangles to measure distances to")
    })
}

/// The numbers of cells to try, as shares of the number for cells as large as the length: the interpolant of a smooth shape
/// is off by far less than a cell, and sharp corners are cut off by several. Chosen: finer lattices rarely help, since
/// mostly thin parts miss the bound then.
const SHARES: [f64; 12] = [0.125, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0];
/// From more than this share on, lattices are tried only up to a size. Chosen: a sharp corner is rarely worth a gigabyte of
/// samples.
const MANY: f64 = 2.0;
/// That size, in cells along the longest side.
const MOST_CELLS: f64 = 512.0;
/// The fewest cells along the longest side. Chosen: fewer do not tell a shape from a ball.
const FEWEST: f64 = 8.0;

/// The facts about samples for the certificate.
fn facts(
    source: &DistanceSource,
    sampled: &SampledDistances,
    job: &Job,
) -> Result<DistanceGridFacts, MeshFailure> {
    let error = source.off_at_most(sampled, job)?;
    let (lost, evidence) = match &source.triangles {
        Some(triangles) if source.route() != "field" => {
            (triangles.bound.at_most(), triangles.bound.evidence().clone())
        }
        _ => (Some(0.0), Evidence::Proved),
    };
    let off_at_most = lost
        .map(|lost| if lost == 0.0 { error } else { add_up(error, lost) })
        .filter(|error| error.is_finite());
    let is_closed = sampled.solid.as_ref().is_none_or(|solid| solid.closed);
    let interpolant = off_at_most.filter(|_| is_closed).map(|error| InterpolantFacts {
        at_most: interpolant_error(&sampled.samples, error),
        evidence: evidence.as_str(),
        of: if source.route() == "tessellation" { "distance" } else { "signed distance" },
    });
    let affine = sampled.samples.affine();
    Ok(DistanceGridFacts {
        route: source.route(),
        size: sampled.samples.size().map(|n| n as u64),
        origin: affine.at([0.0; 3]),
        spacing: affine.rows()[0][0],
        band: sampled.band.is_finite().then_some(sampled.band),
        distances: sampled.n_within,
        off_at_most,
        evidence: evidence.as_str(),
        interpolant,
        bricks: match &sampled.samples {
            BakedSamples::Dense(_) => None,
            BakedSamples::Sparse(grid) => Some(grid.n_bricks().map(|n| n as u64)),
        },
        solid: sampled.solid.as_ref().map(SolidFacts::new),
    })
}
