//! `inspect`: the content of a file, and its validity.
use crate::mend::recommend::recommend_repairs;
use crate::mesh::isosurface::surface_of;
use crate::report::{
    BoundFacts, Certificate, CheckDepth, CountError, CountedTriangles, ExaminationFacts, Inspection, Output,
    PolygonFacts, PolylineFacts, Report, RunFacts,
};
use crate::{Input, MeshFailure, Shape};
use chordal::budget::JobError;
use chordal::{Budget, Job};
use chordal_io::Format;

/// Describes the input, with its full validity check and the certificate embedded in it, if any.
///
/// Linear in the size of the input: about 0.2 s per million triangles. If repairs are needed, they are tried on a copy, so
/// that only repairs that help are recommended. Each trial takes as long as the check itself, and all take up to three
/// copies of the input.
///
/// ```
/// use chordal_verbs::{FormatHint, inspect, load};
/// let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
/// let input = load(obj, FormatHint { name: Some("triangle.obj"), ..FormatHint::default() }, &Default::default())?;
/// let report = inspect(&input);
/// let valid = report.certificate.valid.unwrap();
/// assert!(!valid.counts.closed && valid.counts.manifold);
/// assert_eq!(valid.counts.boundary_edges, 3);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
#[must_use]
pub fn inspect(input: &Input) -> Report {
    // Only the search for self-intersections can be stopped.
    inspect_to_depth(input, CheckDepth::Full).unwrap_or_else(|_| report(input, None))
}

/// As [`inspect`], with self-intersections, which take about 1 µs a triangle if there are few.
///
/// # Errors
/// If the job is cancelled, or its memory is not enough.
pub fn inspect_deeply(input: &Input, job: &Job) -> Result<Report, JobError> {
    inspect_to_depth(input, CheckDepth::Deep(job))
}

/// As [`inspect`] of a volume, with the validity of the surface that its [`crate::SurfaceSpec`] chooses, at the resolution
/// of the lattice, and its bound. Self-intersections are searched for if `depth` is [`SurfaceDepth::Deep`].
///
/// # Errors
/// As for [`crate::mesh`] of a volume, and as for [`inspect_deeply`].
///
/// ```
/// use chordal_verbs::{FormatHint, Shape, SurfaceDepth, inspect_surface, load};
/// let file = b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 3 3 3\nencoding: text\n\n\
///     0 0 0 0 0 0 0 0 0  0 0 0 0 9 0 0 0 0  0 0 0 0 0 0 0 0 0\n";
/// let mut input = load(file, FormatHint::default(), &Default::default())?;
/// let Shape::Volume(sampled) = &mut input.shape else { unreachable!() };
/// sampled.surface.level = Some(4.5);
/// let report = inspect_surface(&input, SurfaceDepth::Counts, &Default::default())?;
/// assert!(report.certificate.valid.unwrap().counts.closed);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn inspect_surface(input: &Input, depth: SurfaceDepth, job: &Job) -> Result<Report, MeshFailure> {
    let Shape::Volume(sampled) = &input.shape else {
        return Ok(inspect_deeply(input, job)?);
    };
    let mut notes = Vec::new();
    let (scene, bound) = surface_of(sampled, Budget::default(), &mut notes, job)?;
    let check_depth = if depth == SurfaceDepth::Deep { CheckDepth::Deep(job) } else { CheckDepth::Full };
    // The format does not matter: the surface is in no file.
    let counted = match CountedTriangles::thorough(&scene, Format::Ply, check_depth) {
        Ok(counted) => Some(counted),
        Err(CountError::Unwritten) => None,
        Err(CountError::Stopped(stopped)) => return Err(stopped.into()),
    };
    let mut report = report(input, counted);
    report.certificate.bound = Some(BoundFacts::new(&bound));
    report.certificate.notes.extend(notes);
    Ok(report)
}

/// The depth of the check of a volume's surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceDepth {
    /// Everything except self-intersections.
    Counts,
    /// Self-intersections, too.
    Deep,
}

fn inspect_to_depth(input: &Input, depth: CheckDepth) -> Result<Report, JobError> {
    let Shape::Scene(scene) = &input.shape else { return Ok(report(input, None)) };
    match CountedTriangles::thorough(scene, input.format, depth) {
        Ok(mut counted) => {
            let default_job = Job::default();
            let job = if let CheckDepth::Deep(job) = depth { job } else { &default_job };
            counted.valid.prescribe(|| recommend_repairs(scene, input.format, job));
            Ok(report(input, Some(counted)))
        }
        // Merging the rows of a mesh only reduces their number, so that it cannot fail.
        Err(CountError::Unwritten) => Ok(report(input, None)),
        Err(CountError::Stopped(stopped)) => Err(stopped),
    }
}

fn report(input: &Input, counted: Option<CountedTriangles>) -> Report {
    let mut certificate = Certificate::from_input(input);
    if let Some(counted) = counted {
        certificate.output = Some(Output::Triangles(counted.output));
        certificate.valid = Some(counted.valid);
    }
    if let Some(lines) = polylines_of(&input.shape) {
        certificate.output = Some(Output::Polylines(lines));
    }
    if let Shape::Cage(polygons) = &input.shape {
        certificate.output = Some(Output::Polygons(PolygonFacts::from_cage(&polygons.cage)));
    }
    let inspection = Inspection::from_input(input, &certificate);
    if inspection.found.as_ref().is_some_and(|embedded| !embedded.differs.is_empty()) {
        certificate.notes.push(DIFFERS.into());
    }
    let run = RunFacts { verb: "inspect", ..RunFacts::default() };
    let examined = Some(ExaminationFacts::Inspection(Box::new(inspection)));
    Report { examined, ..Report::new(certificate, run) }
}

const DIFFERS: &str =
    "the certificate in the file is for other triangles or polylines than those in the file";

/// The polyline counts of a shape that consists only of polylines.
fn polylines_of(shape: &Shape) -> Option<PolylineFacts> {
    match shape {
        Shape::Drawing(drawing) => PolylineFacts::from_straight_curves(&drawing.lines),
        Shape::Curves(curves) => PolylineFacts::from_straight_curves(&curves.lines),
        Shape::Patches { .. }
        | Shape::Surfaces { .. }
        | Shape::Scene(_)
        | Shape::Cage(_)
        | Shape::Field(_)
        | Shape::Volume(_) => None,
    }
}
