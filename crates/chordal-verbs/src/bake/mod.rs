//! `bake`: a signed distance grid of any shape that bounds a solid.
mod samples;
mod source;
mod spec;

use crate::formats::{in_words, names_where};
use crate::geometry_digest::samples_digest;
use crate::report::{BoundFacts, BudgetFacts, Certificate, DistanceGridFacts, InterpolantFacts, SolidFacts};
use crate::zero_set::zero_set_distance;
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
pub(crate) use samples::{interpolant_off, off_at_most};
use source::{DistanceSource, SampledDistances};
pub use spec::{BakeResolution, BakeSpec};
use std::io::Write;
use std::sync::Arc;

const UNBOUNDED: &str = "nothing was proved of how far the surface of the samples is from the shape: take smaller \
                         cells, and mend holes";

/// A distance grid with its certificate.
#[derive(Clone, Debug)]
pub struct BakeOutcome {
    /// The samples and their lattice.
    pub volume: BakedVolume,
    /// The output format.
    pub format: Format,
    /// What is known of the grid.
    pub certificate: Certificate,
    /// Why the budget was not met, where it was not: this is the best that was reached.
    pub unmet: Option<Message>,
}

/// Samples with their frame.
#[derive(Clone, Debug, PartialEq)]
pub enum BakedVolume {
    /// All of them.
    Dense(Volume),
    /// Those of the bricks that a band reaches.
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
    /// Writes the grid, and the certificate where the format carries one.
    ///
    /// # Errors
    /// When the sink fails.
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

/// Samples the signed distance to a shape on a cubic lattice, negative inside. Every distance is then bounded from
/// both sides, so that the error in the certificate is proved; and so is that of the interpolant.
///
/// Triangles are taken as they are, and a field whose value is a distance on both sides is sampled itself. Other
/// shapes are meshed first, within a 16th of a cell or a quarter of the length, which the bounds contain.
///
/// # Errors
/// When the shape bounds nothing or the format holds no lattice; as for [`mesh_to_grid`](chordal::convert::mesh_to_grid).
///
/// ```
/// use chordal_io::Format;
/// use chordal_verbs::{BakeSpec, FormatHint, bake, load};
/// let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
/// let input = load(obj, FormatHint { name: Some("corner.obj"), ..FormatHint::default() }, &Default::default())?;
/// let outcome = bake(input, &BakeSpec::cells(8), Format::Nrrd, &Default::default())?;
/// let facts = outcome.certificate.baked.unwrap();
/// assert!(facts.solid.unwrap().is_solid && facts.size == [15; 3] && facts.off_at_most.unwrap() < 1e-12);
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
    let mut certificate = Certificate::from_input(&input).by("bake");
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
        (None, BakeResolution::Within(_)) => f64::NAN,
    };
    let within = Tolerance::new(within).map_err(|_| {
        MeshFailure::refused(RefusalCode::Empty, "the shape has no size that cells could divide")
    })?;
    let longest = longest_side(&input)?;
    let needs_triangles = spec.is_bounded || limit.is_some();
    let source = DistanceSource::new(input.shape, (within, needs_triangles), &mut certificate.notes, job)?;
    let (made, surface, unmet) = match (spec.resolution, limit) {
        (BakeResolution::Cells(cells), _) => {
            let made = source.sample(cells, spec, job)?;
            let surface = if spec.is_bounded { surface_of(&source, &made, job)? } else { None };
            if spec.is_bounded && surface.is_none() {
                certificate.notes.push(UNBOUNDED.into());
            }
            (made, surface, None)
        }
        (_, limit) => bake_within(&source, (limit.unwrap_or(within), longest), spec, job)?,
    };
    certificate.bound = surface.as_ref().map(BoundFacts::new);
    certificate.baked = Some(facts(&source, &made, job)?);
    if let Some(solid) = made.solid.as_ref().filter(|solid| !solid.is_solid()) {
        certificate.notes.push(solid.to_string().into());
    }
    if to == Format::Npy {
        certificate.notes.push("npy holds no place and no step: this report has both".into());
    }
    // An array has no place and no step of its own.
    certificate.conclude(("volume", to), (to != Format::Npy).then(|| samples_digest(&made.samples)));
    let volume = match made.samples {
        BakedSamples::Dense(grid) => {
            BakedVolume::Dense(Volume { frame, ..Volume::from_grid(Arc::unwrap_or_clone(grid)) })
        }
        BakedSamples::Sparse(grid) => BakedVolume::Sparse(Arc::unwrap_or_clone(grid), frame),
    };
    Ok(BakeOutcome { volume, format: to, certificate, unmet })
}

/// The share of a length within which a shape is meshed. Chosen: what is left is for the lattice.
const LENGTH_SHARE: f64 = 0.25;
/// The share of a cell within which a shape is meshed where cells are given. Chosen: an interpolant of smooth distances
/// is off by about as much.
const CELL_SHARE: f64 = 1.0 / 16.0;

fn longest_side(input: &Input) -> Result<f64, MeshFailure> {
    let bounds = input.shape.bounds()?;
    Ok((0..3).fold(0.0, |most, k| greater(bounds.max[k] - bounds.min[k], most)))
}

/// How far the surface of samples is from the shape; `None` where nothing is proved.
fn surface_of(
    source: &DistanceSource,
    made: &SampledDistances,
    job: &Job,
) -> Result<Option<Bound>, MeshFailure> {
    let Some(triangles) = &source.triangles else { return Ok(None) };
    let found = zero_set_distance(&made.samples, &triangles.mesh, job)?;
    Ok(found.map(|found| triangles.then(&found)))
}

/// The first lattice whose surface is proved to be within a length of the shape, or the best that there is, and why.
fn bake_within(
    source: &DistanceSource,
    (limit, longest): (Tolerance, f64),
    spec: &BakeSpec,
    job: &Job,
) -> Result<(SampledDistances, Option<Bound>, Option<Message>), MeshFailure> {
    let lost = source.triangles.as_ref().and_then(|triangles| triangles.bound.at_most());
    // The sum of both is rounded up once, by less than is taken away here.
    let left = lost.map_or(0.0, |lost| sub_down(sub_down(limit.get(), lost), f64::EPSILON * limit.get()));
    let Ok(left) = Tolerance::new(left) else {
        let message =
            format!("the shape is not proved to be meshed within {limit}, as a length for its lattice asks");
        return Err(MeshFailure::refused(RefusalCode::Budget, message));
    };
    let cells_for = |share: f64| {
        let cells = (longest / left.get() * share).ceil();
        // Beyond any lattice, so that it is refused there.
        if cells < FEWEST { FEWEST as usize } else { cells as usize }
    };
    let mut best: Option<SampledDistances> = None;
    let mut why = None;
    let mut tried = 0;
    for share in SHARES {
        let cells = cells_for(share);
        if cells == tried {
            continue;
        }
        tried = cells;
        if share > MANY && cells as f64 > MOST_CELLS {
            why = Some(
                format!("{cells} cells along the longest side would be next, which are not tried unasked")
                    .into(),
            );
            break;
        }
        let made = match source.sample(cells, spec, job) {
            Ok(made) => made,
            Err(MeshFailure::Refused(refusal)) if best.is_some() => {
                let message =
                    Message::from(format!("{cells} cells along the longest side would be next, and "));
                why = Some(
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
        if let Some(found) = zero_set_deviation(triangles_of(source)?, &made.samples, left, job)? {
            let bound = source.triangles.as_ref().map(|triangles| triangles.then(&found));
            if bound.as_ref().and_then(Bound::at_most).is_some_and(|most| most <= limit.get()) {
                return Ok((made, bound, None));
            }
        }
        let is_closed = made.solid.as_ref().is_none_or(|solid| solid.closed);
        best = Some(made);
        if !is_closed {
            why = Some(
                "the mesh has holes, which the surface of samples closes somehow: mend them first".into(),
            );
            break;
        }
    }
    let Some(made) = best else {
        return Err(MeshFailure::refused(RefusalCode::Budget, "no lattice was tried"));
    };
    let bound = surface_of(source, &made, job)?;
    // Lengths that are a share of a cell may be proved where the whole limit was not.
    if bound.as_ref().and_then(Bound::at_most).is_some_and(|most| most <= limit.get()) {
        return Ok((made, bound, None));
    }
    let reached = bound.as_ref().map_or_else(|| "no bound".to_owned(), Bound::to_string);
    let [x, y, z] = made.samples.size();
    let mut message = Message::from(format!(
        "the budget was not met; the best reached is {reached} with {x} x {y} x {z} samples"
    ));
    let why = why.unwrap_or_else(|| {
        "cells of a 64th of the length prove no more: parts may be thinner than it, or corners too sharp"
            .into()
    });
    message = message.words("; ").message(&why);
    Ok((made, bound, Some(message)))
}

fn triangles_of(source: &DistanceSource) -> Result<&chordal::Mesh, MeshFailure> {
    let triangles = source.triangles.as_ref().map(|triangles| &triangles.mesh);
    triangles
        .ok_or_else(|| MeshFailure::refused(RefusalCode::Empty, "there are no triangles to be away from"))
}

/// The cells of a lattice that are tried, as shares of as many as there would be of the size of the length: the
/// interpolant of a smooth shape is off by far less than a cell, and sharp corners are cut off by several. Chosen, up to
/// where thin parts are mostly what keeps the bound.
const SHARES: [f64; 12] = [0.125, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0];
/// From more than this share on, lattices are tried up to a size only. Chosen: a gigabyte of samples is more than a sharp
/// corner is mostly worth.
const MANY: f64 = 2.0;
/// That size, in cells along the longest side.
const MOST_CELLS: f64 = 512.0;
/// The fewest cells along the longest side; chosen, so that a shape is told from a ball.
const FEWEST: f64 = 8.0;

/// What is known of samples.
fn facts(
    source: &DistanceSource,
    made: &SampledDistances,
    job: &Job,
) -> Result<DistanceGridFacts, MeshFailure> {
    let off = source.off_at_most(made, job)?;
    let (lost, evidence) = match &source.triangles {
        Some(triangles) if source.route() != "field" => {
            (triangles.bound.at_most(), triangles.bound.evidence().clone())
        }
        _ => (Some(0.0), Evidence::Proved),
    };
    let off_at_most =
        lost.map(|lost| if lost == 0.0 { off } else { add_up(off, lost) }).filter(|off| off.is_finite());
    let is_closed = made.solid.as_ref().is_none_or(|solid| solid.closed);
    let interpolant = off_at_most.filter(|_| is_closed).map(|off| InterpolantFacts {
        at_most: interpolant_off(&made.samples, off),
        evidence: evidence.as_str(),
        of: if source.route() == "tessellation" { "distance" } else { "signed distance" },
    });
    let affine = made.samples.affine();
    Ok(DistanceGridFacts {
        route: source.route(),
        size: made.samples.size().map(|n| n as u64),
        origin: affine.at([0.0; 3]),
        spacing: affine.rows()[0][0],
        band: made.band.is_finite().then_some(made.band),
        distances: made.n_within,
        off_at_most,
        evidence: evidence.as_str(),
        interpolant,
        bricks: match &made.samples {
            BakedSamples::Dense(_) => None,
            BakedSamples::Sparse(grid) => Some(grid.n_bricks().map(|n| n as u64)),
        },
        solid: made.solid.as_ref().map(SolidFacts::new),
    })
}
