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

/// A point of a face that is farther from the other surface than allowed, or may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToleranceViolation {
    /// The face of its own mesh.
    pub face: u32,
    /// The point, rounded.
    pub at: [f64; 3],
    /// Its distance, rounded up.
    pub distance: f64,
}

/// Faces in one task.
const CHUNK: usize = 512;
/// Bisections of one face before it counts as too far while undecided.
const MOST_CUTS: u32 = 64;
/// The same while no point was found too far: large faces along edges of the other surface need more than a
/// hundred.
const MOST_CUTS_UNSEEN: u32 = 1 << 12; // chosen
/// The most faces of the other surface under one piece.
const MOST_FACES: usize = 1 << 14;

/// The result of checking every face of two surfaces.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ViolationReport {
    /// Faces of the first surface, and of the second, with a point that is too far, in the order of the
    /// faces.
    pub violations: [Vec<ToleranceViolation>; 2],
    /// Where there are none: no point of either surface is farther than this from the other, proved.
    pub at_most: f64,
    /// Where there are none and a camera is given: the same in pixels on the screen, proved; infinite where
    /// there is no such number.
    pub pixels: f64,
}

impl ViolationReport {
    /// No violation.
    const NONE: Self = Self { violations: [Vec::new(), Vec::new()], at_most: 0.0, pixels: 0.0 };

    /// Whether no face is too far.
    pub fn is_empty(&self) -> bool {
        self.violations.iter().all(Vec::is_empty)
    }

    /// How many faces of both surfaces are too far.
    pub fn count(&self) -> usize {
        self.violations.iter().map(Vec::len).sum()
    }
}

/// A tolerance that depends on the position.
pub(crate) trait ToleranceField {
    /// The tolerance for all points at most `off` from a triangle.
    fn over_triangle(&self, triangle: [[f64; 3]; 3], off: f64) -> RegionTolerance;

    /// The tolerance for one point.
    fn at(&self, point: [f64; 3]) -> f64 {
        self.over_triangle([point; 3], 0.0).tolerance
    }

    /// The size of a distance there in pixels on the screen, if there is one; rounded up.
    fn pixels_of(&self, _here: &RegionTolerance, _distance: f64) -> f64 {
        0.0
    }
}

/// The tolerance in one region.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RegionTolerance {
    /// The largest distance allowed.
    pub tolerance: f64,
    /// The pixel scale of the region, where there is a camera.
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
    /// World-space points are where the frame has them, up to its rounding. Where the eye is too close for
    /// any length, only points that have not moved at all are within tolerance.
    fn over_triangle(&self, triangle: [[f64; 3]; 3], off: f64) -> RegionTolerance {
        let CommonFrame { frame, moved, .. } = &self.pair.shared;
        let off = if off == 0.0 || *moved == 0.0 { off + *moved } else { add_up(off, *moved) };
        let (length, sight) = self.allowed.at_with_scale(&frame.world_box(&triangle, off));
        RegionTolerance { tolerance: self.pair.shared.limit(length.unwrap_or(0.0)).within(), sight }
    }

    fn pixels_of(&self, here: &RegionTolerance, distance: f64) -> f64 {
        let CommonFrame { frame, moved, .. } = &self.pair.shared;
        let distance = if *moved == 0.0 { distance } else { add_up(distance, *moved) };
        let seen = here.sight.and_then(|sight| sight.pixels_of(frame.length_up(distance)));
        seen.unwrap_or(f64::INFINITY)
    }
}

/// Finds, for each face of `a` that has a point farther from `b` than allowed, the farthest such point found,
/// and the same from `b` to `a`, each in the order of the faces. Where both lists are empty every point is
/// within the tolerance at its own position, proved as by [`super::deviation`]; a face that could not be
/// decided is in its list.
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
        let places = match allowed.constant() {
            Some(length) => find_violations(&pair, &vertices, &pair.shared.limit(length).within(), job),
            None => find_violations(&pair, &vertices, &WorldTolerance { allowed, pair: &pair }, job),
        };
        if job.is_cancelled() { Err(JobError::Cancelled) } else { Ok(places) }
    })
}

/// The violations of the faces of both sides that are to be compared.
pub(super) fn find_violations(
    pair: &SurfacePair<'_>,
    vertices: &[VertexDistances; 2],
    near: &(impl ToleranceField + Sync),
    job: &Job,
) -> ViolationReport {
    let CommonFrame { frame, moved, .. } = &pair.shared;
    let [a, b] = &pair.sides;
    let (mut at_most, mut pixels) = (0.0, 0.0);
    let beyond = [(a, b, 0), (b, a, 1)].map(|(own, other, which)| {
        let vertices = &vertices[which];
        let chunks: Vec<&[u32]> = vertices.faces.chunks(CHUNK).collect();
        let found = par_map(job, &chunks, |_, faces| {
            let asked = FaceComparison { pair, own, other, vertices };
            if job.is_cancelled() { ViolationReport::NONE } else { asked.find_in_faces(faces, which, near) }
        });
        let most = found.iter().fold(0.0, |most, found| greater(most, found.at_most));
        pixels = found.iter().fold(pixels, |most, found| greater(most, found.pixels));
        // Faces that both surfaces share were not queried, and nothing of them was rounded.
        let rounded = !vertices.faces.is_empty() && *moved > 0.0;
        at_most = greater(at_most, if rounded { add_up(most, *moved) } else { most });
        found.into_iter().flat_map(|found| found.violations).flatten().collect()
    });
    ViolationReport { violations: beyond, at_most: frame.length_up(at_most), pixels }
}

/// Compares faces of one surface with the other.
struct FaceComparison<'a> {
    pair: &'a SurfacePair<'a>,
    own: &'a DistanceSurface<'a>,
    other: &'a DistanceSurface<'a>,
    vertices: &'a VertexDistances,
}

impl FaceComparison<'_> {
    /// The violations of side `which`; upper bounds are in the frame.
    fn find_in_faces(&self, faces: &[u32], which: usize, near: &impl ToleranceField) -> ViolationReport {
        let CommonFrame { frame, reach, .. } = &self.pair.shared;
        let terms = CoverLimits { tolerance: 0.0, most_faces: MOST_FACES, reach: *reach };
        let mut scratch = CoverScratch::default();
        let mut found = ViolationReport::NONE;
        for face in faces {
            let corners = self.own.mesh().faces()[*face as usize].map(|row| self.vertices.corner(row));
            let piece = MeshSubtriangle { corners, off: 0.0, known: f64::INFINITY };
            match classify(piece, self.other, terms, ViolationSearch::Farthest, near, &mut scratch) {
                SubtriangleVerdict::Within { up, pixels } => {
                    found.at_most = greater(found.at_most, up);
                    found.pixels = greater(found.pixels, pixels);
                }
                SubtriangleVerdict::TooFar(at, up) => {
                    let (at, distance) = (frame.world(at), frame.length_up(up));
                    found.violations[which].push(ToleranceViolation { face: *face, at, distance });
                }
            }
        }
        found
    }
}

/// The most faces of the other surface under one piece, and bisections of it, where a quick answer is preferred. Chosen:
/// four times as many bisections settle a few faces in a thousand, and cost needles twice the time.
const FEW_FACES: usize = 512;
const FEW_CUTS: u32 = 16;

/// Which violation is wanted.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ViolationSearch {
    /// The first.
    Any,
    Farthest,
}

/// What is known of a piece.
enum SubtriangleVerdict {
    /// No point is farther than this, which is within tolerance, nor so many pixels away.
    Within { up: f64, pixels: f64 },
    /// A point that is too far, or may be, and an upper bound on its distance.
    TooFar([f64; 3], f64),
}

/// The farthest point that violates the tolerance.
#[derive(Default)]
struct WorstViolation(Option<([f64; 3], f64)>);

impl WorstViolation {
    /// Records a point of the region `here` if it violates the tolerance.
    fn consider(&mut self, at: [f64; 3], up: f64, here: &RegionTolerance, near: &impl ToleranceField) {
        if up > here.tolerance && up > near.at(at) {
            self.take(at, up);
        }
    }

    fn take(&mut self, at: [f64; 3], up: f64) {
        if self.0.is_none_or(|worst| up > worst.1) {
            self.0 = Some((at, up));
        }
    }
}

/// Whether all of a piece is proved to be within tolerance.
fn classify(
    piece: MeshSubtriangle,
    other: &DistanceSurface,
    terms: CoverLimits,
    find: ViolationSearch,
    near: &impl ToleranceField,
    scratch: &mut CoverScratch,
) -> SubtriangleVerdict {
    let mut worst = WorstViolation::default();
    let place =
        |piece: &MeshSubtriangle| near.over_triangle(piece.corners.map(|corner| corner.at), piece.off);
    let here = place(&piece);
    piece.corners.iter().for_each(|corner| worst.consider(corner.at, corner.up, &here, near));
    let mut open = vec![(piece, here)];
    let (mut cuts, mut most, mut pixels) = (0, 0.0, 0.0);
    while let Some((mut piece, here)) = open.pop() {
        if find == ViolationSearch::Any && worst.0.is_some() {
            break;
        }
        let terms = CoverLimits { tolerance: here.tolerance, ..terms };
        piece.known = piece.bound_by_corners(other, terms.tolerance);
        if piece.known <= terms.tolerance {
            most = greater(most, piece.known);
            pixels = greater(pixels, near.pixels_of(&here, piece.known));
            continue;
        }
        match cover(&piece, other, terms, scratch) {
            Cover::Within(up) if up <= terms.tolerance => {
                most = greater(most, up);
                pixels = greater(pixels, near.pixels_of(&here, up));
                continue;
            }
            // A border of the other surface that leaves a gap adds to the bound: halves are closer.
            Cover::Within(_) => {}
            Cover::TooFar(at) => {
                let corner = other.sample(at);
                worst.consider(at, corner.up, &here, near);
            }
            Cover::None => {}
        }
        // As long as no point was found too far, the piece may well be within tolerance.
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
                worst.consider(middle.at, middle.up, &here, near);
                open.extend(halves.map(|half| {
                    let here = place(&half);
                    (half, here)
                }));
            }
            // Too small, or too many bisections: undecided, so it counts as a violation.
            None => {
                let far = piece
                    .corners
                    .iter()
                    .fold(piece.corners[0], |far, c| if c.up > far.up { *c } else { far });
                worst.take(far.at, piece.known);
            }
        }
    }
    worst.0.map_or(SubtriangleVerdict::Within { up: most, pixels }, |(at, up)| {
        SubtriangleVerdict::TooFar(at, up)
    })
}

/// A surface against which pieces of others are checked, one after the other.
pub(crate) struct ProximityChecker<'a> {
    side: Arc<DistanceSurface<'a>>,
    scratch: Mutex<CoverScratch>,
    reach: f64,
}

impl Clone for ProximityChecker<'_> {
    /// The same surface, with memory of its own to work in.
    fn clone(&self) -> Self {
        Self { side: Arc::clone(&self.side), scratch: Mutex::default(), reach: self.reach }
    }
}

impl<'a> ProximityChecker<'a> {
    /// A checker for a surface.
    ///
    /// # Errors
    /// As for [`crate::explicit::Bvh::build`].
    pub fn new(mesh: Cow<'a, Mesh>, job: &Job) -> Result<Self, JobError> {
        let reach = mesh.positions().as_flattened().iter().fold(0.0, |most, x| greater(most, x.abs()));
        Ok(Self { side: Arc::new(DistanceSurface::new(mesh, job)?), scratch: Mutex::default(), reach })
    }

    /// A checker for a surface of a few faces, which cannot be cancelled.
    pub fn from_small_mesh(mesh: Mesh) -> Option<Self> {
        let job = Job::default().with_threads(1);
        Self::new(Cow::Owned(mesh), &job).ok()
    }

    /// The squared distance of a point to the surface, up to rounding.
    pub fn distance_sq(&self, at: [f64; 3]) -> f64 {
        self.side.distance_sq(at)
    }

    /// Whether all points of a triangle are within tolerance of the surface, proved; `false` where that is
    /// not known.
    pub fn is_within(&self, triangle: [[f64; 3]; 3], near: &impl ToleranceField) -> bool {
        self.distance_within(triangle, near).is_some()
    }

    /// A bound on the distance of all points of a triangle that is within tolerance, proved; `None` where
    /// there is no such bound.
    pub fn distance_within(&self, triangle: [[f64; 3]; 3], near: &impl ToleranceField) -> Option<f64> {
        let corners = triangle.map(|at| self.side.sample(at));
        let reach = triangle.as_flattened().iter().fold(self.reach, |most, x| greater(most, x.abs()));
        let terms = CoverLimits { tolerance: 0.0, most_faces: FEW_FACES, reach };
        let piece = MeshSubtriangle { corners, off: 0.0, known: f64::INFINITY };
        let mut scratch = self.scratch.lock().unwrap_or_else(PoisonError::into_inner);
        let look = classify(piece, &self.side, terms, ViolationSearch::Any, near, &mut scratch);
        match look {
            SubtriangleVerdict::Within { up, .. } => Some(up),
            SubtriangleVerdict::TooFar(..) => None,
        }
    }
}
