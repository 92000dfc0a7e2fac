//! `tolerance_violations`: where two surfaces are farther apart than a tolerance, face by face.
use super::cover::{Cover, CoverLimits, CoverScratch, cover};
use super::distance_surface::DistanceSurface;
use super::shared::VertexDistances;
use super::subtriangle::MeshSubtriangle;
use super::{CommonFrame, SurfacePair};
use crate::budget::{ErrorLimit, Job, JobError, PixelScale, par_map};
use crate::explicit::Mesh;
use crate::math::{add_up, greater};
use std::borrow::Cow;
use std::sync::{Arc, Mutex, PoisonError};

/// A point of a face that is farther from the other surface than allowed, or possibly so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToleranceViolation {
    /// The face, in its mesh.
    pub face: u32,
    /// The point, rounded.
    pub at: [f64; 3],
    /// Its distance, rounded up.
    pub distance: f64,
}

/// Faces in one task.
const CHUNK: usize = 512;
/// Bisections of one face after which it counts as too far if it is still undecided.
const MOST_CUTS: u32 = 64;
/// The same as long as none of its points was found too far: large faces along edges of the other surface need
/// more than a hundred. Chosen: a larger value proves more of them, and costs time on hopeless ones.
const MOST_CUTS_UNSEEN: u32 = 1 << 12;
/// The most faces of the other surface that are visited under one piece.
const MOST_FACES: usize = 1 << 14;

/// The result of checking every face of two surfaces.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ViolationReport {
    /// The violations on the first and on the second surface, in the order of the faces.
    pub violations: [Vec<ToleranceViolation>; 2],
    /// If there are no violations: no point of either surface is farther than this from the other, proved.
    pub at_most: f64,
    /// If there are no violations and a camera is given: the same in pixels on the screen, proved; infinite
    /// if there is no such number.
    pub pixels: f64,
}

impl ViolationReport {
    /// No violation.
    const NONE: Self = Self { violations: [Vec::new(), Vec::new()], at_most: 0.0, pixels: 0.0 };

    /// Whether no face is too far.
    pub fn is_empty(&self) -> bool {
        self.violations.iter().all(Vec::is_empty)
    }

    /// The number of faces of both surfaces that are too far.
    pub fn count(&self) -> usize {
        self.violations.iter().map(Vec::len).sum()
    }
}

/// A tolerance that depends on the position.
pub(crate) trait ToleranceField {
    /// The tolerance for all points at most `radius` from a triangle.
    fn over_triangle(&self, triangle: [[f64; 3]; 3], radius: f64) -> RegionTolerance;

    /// The tolerance for one point.
    fn at(&self, point: [f64; 3]) -> f64 {
        self.over_triangle([point; 3], 0.0).tolerance
    }

    /// The size of a distance in that region in pixels on the screen, rounded up; 0 without a camera.
    fn pixels_of(&self, _region: &RegionTolerance, _distance: f64) -> f64 {
        0.0
    }
}

/// The tolerance in one region.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RegionTolerance {
    /// The largest distance allowed.
    pub tolerance: f64,
    /// The pixel scale of the region, if there is a camera.
    pub sight: Option<PixelScale>,
}

/// A constant tolerance.
impl ToleranceField for f64 {
    fn over_triangle(&self, _: [[f64; 3]; 3], _: f64) -> RegionTolerance {
        RegionTolerance { tolerance: *self, sight: None }
    }

    fn at(&self, _: [f64; 3]) -> f64 {
        *self
    }
}

/// A world-space tolerance, for two surfaces in their common frame.
struct WorldTolerance<'a> {
    allowed: &'a ErrorLimit,
    pair: &'a SurfacePair<'a>,
}

impl ToleranceField for WorldTolerance<'_> {
    /// World-space points are at their positions in the frame, up to its rounding. If the eye is too close
    /// for any length, only points that have not moved at all are within tolerance.
    fn over_triangle(&self, triangle: [[f64; 3]; 3], radius: f64) -> RegionTolerance {
        let CommonFrame { frame, displacement, .. } = &self.pair.common_frame;
        let radius = if radius == 0.0 || *displacement == 0.0 {
            radius + *displacement
        } else {
            add_up(radius, *displacement)
        };
        let (length, sight) = self.allowed.at_with_scale(&frame.world_box(&triangle, radius));
        RegionTolerance { tolerance: self.pair.common_frame.limit(length.unwrap_or(0.0)).within(), sight }
    }

    fn pixels_of(&self, region: &RegionTolerance, distance: f64) -> f64 {
        let CommonFrame { frame, displacement, .. } = &self.pair.common_frame;
        let distance = if *displacement == 0.0 { distance } else { add_up(distance, *displacement) };
        let seen = region.sight.and_then(|sight| sight.pixels_of(frame.length_up(distance)));
        seen.unwrap_or(f64::INFINITY)
    }
}

/// Finds, for each face of `a` that has a point farther from `b` than allowed, the farthest such point, and
/// likewise from `b` to `a`, in the order of the faces. If both lists are empty, every point is within the
/// tolerance at its position, proved as by [`super::deviation`]; a face that could not be decided is in its
/// list.
///
/// A local tolerance is evaluated around every piece of a face: a face that is near the eye and reaches far
/// away is split until its pieces are either within their tolerance or found too far.
///
/// Cost: less than [`super::deviation`], since smaller distances are not resolved.
///
/// # Errors
/// As for [`super::deviation`].
pub(crate) fn tolerance_violations(
    a: &Mesh,
    b: &Mesh,
    allowed: &ErrorLimit,
    job: &Job,
) -> Result<ViolationReport, JobError> {
    job.run(|| {
        let pair = SurfacePair::from_meshes([a, b], job)?;
        let vertices = [0, 1].map(|which| pair.vertex_distances(which, job));
        let report = match allowed.constant() {
            Some(length) => find_violations(&pair, &vertices, &pair.common_frame.limit(length).within(), job),
            None => find_violations(&pair, &vertices, &WorldTolerance { allowed, pair: &pair }, job),
        };
        if job.is_cancelled() { Err(JobError::Cancelled) } else { Ok(report) }
    })
}

/// The violations among the faces that are to be compared, on both sides.
pub(super) fn find_violations(
    pair: &SurfacePair<'_>,
    vertices: &[VertexDistances; 2],
    tolerance: &(impl ToleranceField + Sync),
    job: &Job,
) -> ViolationReport {
    let CommonFrame { frame, displacement, .. } = &pair.common_frame;
    let [a, b] = &pair.sides;
    let (mut at_most, mut pixels) = (0.0, 0.0);
    let violations = [(a, b, 0), (b, a, 1)].map(|(surface, other, side_idx)| {
        let vertices = &vertices[side_idx];
        let chunks: Vec<&[u32]> = vertices.faces.chunks(CHUNK).collect();
        let reports = par_map(job, &chunks, |_, faces| {
            let comparison = FaceComparison { pair, surface, other, vertices };
            if job.is_cancelled() {
                ViolationReport::NONE
            } else {
                comparison.find_in_faces(faces, side_idx, tolerance)
            }
        });
        let most = reports.iter().fold(0.0, |most, report| greater(most, report.at_most));
        pixels = reports.iter().fold(pixels, |most, report| greater(most, report.pixels));
        // Faces that both surfaces share were not queried, and their vertices were displaced alike.
        let rounded = !vertices.faces.is_empty() && *displacement > 0.0;
        at_most = greater(at_most, if rounded { add_up(most, *displacement) } else { most });
        reports.into_iter().flat_map(|report| report.violations).flatten().collect()
    });
    ViolationReport { violations, at_most: frame.length_up(at_most), pixels }
}

/// Compares faces of one surface with the other.
struct FaceComparison<'a> {
    pair: &'a SurfacePair<'a>,
    surface: &'a DistanceSurface<'a>,
    other: &'a DistanceSurface<'a>,
    vertices: &'a VertexDistances,
}

impl FaceComparison<'_> {
    /// The violations among some faces of a side; upper bounds are in the frame.
    fn find_in_faces(
        &self,
        faces: &[u32],
        side_idx: usize,
        tolerance: &impl ToleranceField,
    ) -> ViolationReport {
        let CommonFrame { frame, reach, .. } = &self.pair.common_frame;
        let limits = CoverLimits { tolerance: 0.0, most_faces: MOST_FACES, reach: *reach };
        let mut scratch = CoverScratch::default();
        let mut report = ViolationReport::NONE;
        for face in faces {
            let corners = self.surface.mesh().faces()[*face as usize].map(|row| self.vertices.corner(row));
            let piece = MeshSubtriangle { corners, slack: 0.0, at_most: f64::INFINITY };
            match classify(piece, self.other, limits, ViolationSearch::Farthest, tolerance, &mut scratch) {
                SubtriangleVerdict::Within { up, pixels } => {
                    report.at_most = greater(report.at_most, up);
                    report.pixels = greater(report.pixels, pixels);
                }
                SubtriangleVerdict::TooFar(at, up) => {
                    let (at, distance) = (frame.world(at), frame.length_up(up));
                    report.violations[side_idx].push(ToleranceViolation { face: *face, at, distance });
                }
            }
        }
        report
    }
}

/// The most faces of the other surface under one piece, and the most bisections of it, for a quick answer.
/// Chosen: four times as many bisections settle a few faces in a thousand, and cost needles twice the time.
const FEW_FACES: usize = 512;
const FEW_CUTS: u32 = 16;

/// Which violation is wanted.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ViolationSearch {
    /// The first.
    Any,
    Farthest,
}

/// The result for one piece.
enum SubtriangleVerdict {
    /// No point is farther than `up`, which is within tolerance, nor farther than that many pixels.
    Within { up: f64, pixels: f64 },
    /// A point that is too far, or possibly so, and an upper bound on its distance.
    TooFar([f64; 3], f64),
}

/// The farthest point that violates the tolerance.
#[derive(Default)]
struct WorstViolation(Option<([f64; 3], f64)>);

impl WorstViolation {
    /// Records a point of a region if it violates the tolerance.
    fn consider(&mut self, at: [f64; 3], up: f64, region: &RegionTolerance, tolerance: &impl ToleranceField) {
        if up > region.tolerance && up > tolerance.at(at) {
            self.take(at, up);
        }
    }

    fn take(&mut self, at: [f64; 3], up: f64) {
        if self.0.is_none_or(|worst| up > worst.1) {
            self.0 = Some((at, up));
        }
    }
}

/// Decides whether all of a piece is within tolerance, proved.
fn classify(
    piece: MeshSubtriangle,
    other: &DistanceSurface,
    limits: CoverLimits,
    find: ViolationSearch,
    tolerance: &impl ToleranceField,
    scratch: &mut CoverScratch,
) -> SubtriangleVerdict {
    let mut worst = WorstViolation::default();
    let tolerance_of =
        |piece: &MeshSubtriangle| tolerance.over_triangle(piece.corners.map(|corner| corner.at), piece.slack);
    let region = tolerance_of(&piece);
    piece.corners.iter().for_each(|corner| worst.consider(corner.at, corner.up, &region, tolerance));
    let mut open = vec![(piece, region)];
    let (mut cuts, mut most, mut pixels) = (0, 0.0, 0.0);
    // Depth first: a quick answer needs only one violation, and the list stays short.
    while let Some((mut piece, region)) = open.pop() {
        if find == ViolationSearch::Any && worst.0.is_some() {
            break;
        }
        // The tolerance of the smallest region known to contain the piece: for halves it may be
        // larger.
        let limits = CoverLimits { tolerance: region.tolerance, ..limits };
        piece.at_most = piece.bound_by_corners(other, limits.tolerance);
        if piece.at_most <= limits.tolerance {
            most = greater(most, piece.at_most);
            pixels = greater(pixels, tolerance.pixels_of(&region, piece.at_most));
            continue;
        }
        match cover(&piece, other, limits, scratch) {
            Cover::Within(up) if up <= limits.tolerance => {
                most = greater(most, up);
                pixels = greater(pixels, tolerance.pixels_of(&region, up));
                continue;
            }
            // Here a border of the other surface adds to the bound; for halves it adds less.
            Cover::Within(_) => {}
            Cover::TooFar(at) => {
                let corner = other.sample(at);
                worst.consider(at, corner.up, &region, tolerance);
            }
            Cover::None => {}
        }
        // As long as no point was found too far, more bisections may prove the piece to be within tolerance.
        let most_cuts = match find {
            ViolationSearch::Any => FEW_CUTS,
            ViolationSearch::Farthest if worst.0.is_none() => MOST_CUTS_UNSEEN,
            ViolationSearch::Farthest => MOST_CUTS,
        };
        let halves = if cuts < most_cuts { piece.halves(|at| other.sample(at)) } else { None };
        match halves {
            Some(halves) => {
                cuts += 1;
                let middle = halves[0].corners[1];
                worst.consider(middle.at, middle.up, &region, tolerance);
                open.extend(halves.map(|half| {
                    let region = tolerance_of(&half);
                    (half, region)
                }));
            }
            // Too small, or too many bisections: undecided, so it counts as a violation.
            None => {
                let far = piece
                    .corners
                    .iter()
                    .fold(piece.corners[0], |far, c| if c.up > far.up { *c } else { far });
                worst.take(far.at, piece.at_most);
            }
        }
    }
    worst.0.map_or(SubtriangleVerdict::Within { up: most, pixels }, |(at, up)| {
        SubtriangleVerdict::TooFar(at, up)
    })
}

/// A surface against which pieces of other surfaces are checked, one after the other.
pub(crate) struct ProximityChecker<'a> {
    surface: Arc<DistanceSurface<'a>>,
    scratch: Mutex<CoverScratch>,
    reach: f64,
}

impl Clone for ProximityChecker<'_> {
    /// The same surface, with scratch memory of its own.
    fn clone(&self) -> Self {
        Self { surface: Arc::clone(&self.surface), scratch: Mutex::default(), reach: self.reach }
    }
}

impl<'a> ProximityChecker<'a> {
    /// A checker for a surface.
    ///
    /// # Errors
    /// As for [`crate::explicit::Bvh::build`].
    pub fn new(mesh: Cow<'a, Mesh>, job: &Job) -> Result<Self, JobError> {
        let reach = mesh.positions().as_flattened().iter().fold(0.0, |most, x| greater(most, x.abs()));
        Ok(Self { surface: Arc::new(DistanceSurface::new(mesh, job)?), scratch: Mutex::default(), reach })
    }

    /// A checker for a surface of a few faces, which cannot be cancelled.
    pub fn from_small_mesh(mesh: Mesh) -> Option<Self> {
        let job = Job::default().with_threads(1);
        Self::new(Cow::Owned(mesh), &job).ok()
    }

    /// The squared distance of a point to the surface, up to rounding.
    pub fn distance_sq(&self, at: [f64; 3]) -> f64 {
        self.surface.distance_sq(at)
    }

    /// Whether all points of a triangle are within tolerance of the surface, proved; `false` if that could
    /// not be decided.
    pub fn is_within(&self, triangle: [[f64; 3]; 3], tolerance: &impl ToleranceField) -> bool {
        self.distance_within(triangle, tolerance).is_some()
    }

    /// An upper bound on the distance of all points of a triangle, proved, if they are within tolerance;
    /// `None` otherwise.
    pub fn distance_within(&self, triangle: [[f64; 3]; 3], tolerance: &impl ToleranceField) -> Option<f64> {
        let corners = triangle.map(|at| self.surface.sample(at));
        let reach = triangle.as_flattened().iter().fold(self.reach, |most, x| greater(most, x.abs()));
        let limits = CoverLimits { tolerance: 0.0, most_faces: FEW_FACES, reach };
        let piece = MeshSubtriangle { corners, slack: 0.0, at_most: f64::INFINITY };
        let mut scratch = self.scratch.lock().unwrap_or_else(PoisonError::into_inner);
        let verdict = classify(piece, &self.surface, limits, ViolationSearch::Any, tolerance, &mut scratch);
        match verdict {
            SubtriangleVerdict::Within { up, .. } => Some(up),
            SubtriangleVerdict::TooFar(..) => None,
        }
    }
}
