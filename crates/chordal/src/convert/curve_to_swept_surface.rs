//! The arrow from a profile to the surface that it sweeps along a path.
use super::sweep::frame_error::{FrameError, frame_error, start_turn, turn_between};
use super::sweep::frame_spline::{FrameSpline, FramedPath};
use super::sweep::moving_frame::{path_jet, pieces, unit_across};
use crate::budget::{Bound, Bounded, Failure, Job, Reference, RefusalCode, Tolerance, par_map};
use crate::explicit::nurbs::{EnclosedPiece, HEAVIEST, InvalidNurbs, NurbsCurve, NurbsSurface};
use crate::math::{
    add_up, cross, difference, distance, dot, flushes_subnormals, greater, length, mul_up, sub_down,
};

/// A path, and how a profile is placed on it.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepPath {
    /// The path.
    pub path: NurbsCurve<3>,
    /// The up direction at the start of the path; its component across the path is used. By default the z axis, or the
    /// y axis if the path starts within 30° of the z axis.
    pub up: Option<[f64; 3]>,
    /// How the coordinates of the profile are meant.
    pub place: ProfilePlace,
}

/// How the coordinates of a profile are meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProfilePlace {
    /// Relative to the path: how far a point is to the right, up, and ahead, for a viewer who looks back along the path.
    OnPath,
    /// In space: the profile stays where it is at the start of the path.
    InSpace,
}

/// Coordinates beyond this, and paths shorter than its inverse, are refused. Chosen: cubes of lengths stay in range.
const LARGEST: f64 = 1e50;
/// The largest error of frames that count as exact, relative to the largest coordinate. Chosen: far above the roundings of
/// a frame; if it were smaller, exact frames would be refined for nothing.
const ROUNDING: f64 = 1e-11;
/// The parts of a piece of a path at first, and at most. Chosen: since errors fall with the fifth power of the number of
/// parts, 4096 are enough for any length above rounding.
const PARTS: [usize; 2] = [2, 4096];
/// The share of the length that a jump of direction may cost: a larger jump is a kink. Chosen: larger leaves less for
/// the frames, smaller refuses paths whose joins are smooth up to rounding.
const KINK: f64 = 1.0 / 16.0;
/// Bytes of a piece with its proof.
const BYTES_PER_PIECE: u64 = 4096;

/// The surface that a profile sweeps along a path, with a frame that does not rotate about it.
///
/// **Surface.** With the path `P`, its unit tangent `T`, and the up vector `R` that starts as `up` says and does not rotate
/// about the path, `R′ ∥ T` (a rotation-minimizing frame), it is `P + x·(R×T) + y·R + z·T` for each point `(x, y, z)` of the
/// profile. `u` runs along the profile, `v` along the path, with the parameters of both. Along a plane path, the frame does
/// not turn about the plane's normal. A profile that runs counter-clockwise, seen against the path, has its front outside.
/// On a closed path, the angle by which the frame misses its start is spread over the length. Where the path's radius of
/// curvature is less than the profile's width, the surface folds over.
///
/// **Exact.** Along a straight path, and along arcs of one circle with the knots and weights of the path: extrusions and
/// surfaces of revolution are exact up to rounding.
///
/// **Bound.** Two-sided Hausdorff distance to that surface, *proved*, rounding included; of points with the same parameters
/// (up to those of a fifth degree within the pieces of the path). It is also the [`NurbsSurface::slack`] of the surface. The
/// rotation of the frame is bounded by the integral of its defect (`convert/sweep/frame_error.rs`); on a closed path this
/// counts twice, since the angle that is spread has the same error.
///
/// **Cost.** About 0.2 ms for each part of the path; the number of parts grows like the fifth root of 1/length.
///
/// # Errors
/// [`Failure::Refused`]: a path with a kink, or whose derivative vanishes inside; an up vector along the path; coordinates beyond
/// 1e50, weights beyond 1e30 or its inverse, a length below rounding, an environment that flushes subnormals.
/// [`Failure::Unmet`] with the nearest surface; [`Failure::Cancelled`].
///
/// ```
/// use chordal::convert::{self, sweeps::{ProfilePlace, SweepPath}};
/// use chordal::{Job, Tolerance, explicit::nurbs::NurbsCurve};
/// let ring = NurbsCurve::circle([0.0; 3], [[0.5, 0.0, 0.0], [0.0, 0.5, 0.0]])?;
/// let path = NurbsCurve::circle([0.0; 3], [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]])?;
/// let sweep = SweepPath { path, up: None, place: ProfilePlace::OnPath };
/// let length = Tolerance::new(1e-6).unwrap();
/// let torus = convert::curve_to_swept_surface(&ring, &sweep, length, &Job::default()).unwrap();
/// assert!(torus.bound.at_most().unwrap() < 1e-10);
/// let [x, y, z] = torus.shape.at(0.3, 0.8);
/// assert!(((x.hypot(y) - 2.0).hypot(z) - 0.5).abs() < 1e-14);
/// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
/// ```
///
/// Sources: W. Wang, B. Jüttler, D. Zheng, Y. Liu, *Computation of Rotation Minimizing Frames*, 2008; R. L. Bishop, *There is
/// more than one way to frame a curve*, 1975. The bound is Chordal's own.
pub fn curve_to_swept_surface(
    profile: &NurbsCurve<3>,
    sweep: &SweepPath,
    length: Tolerance,
    job: &Job,
) -> Result<Bounded<NurbsSurface>, Failure<NurbsSurface>> {
    refuse_extremes(&[profile, &sweep.path])?;
    let framed = framed(sweep)?;
    let profile = SweptProfile::new(profile, sweep.place, &framed);
    refuse_kinks(&framed, KINK * length.get() / (profile.far[2] + profile.far[3]))?;
    job.run(|| swept(sweep, &framed, &profile, length, job))
}

/// The first spline of frames that is near enough, and its surface.
fn swept(
    sweep: &SweepPath,
    framed: &FramedPath<'_>,
    profile: &SweptProfile,
    length: Tolerance,
    job: &Job,
) -> Result<Bounded<NurbsSurface>, Failure<NurbsSurface>> {
    let tolerance = length.get();
    let proof = SweepProof::new(framed, profile, up_of(sweep, framed), job);
    // 1. Splines that may be exact; their error is computed like that of all others.
    let exact = [Some(framed.straight()), framed.circular()];
    for spline in exact.into_iter().flatten() {
        let spline = spline.map_err(refused)?;
        if let Ok(error) = proof.error_of(&spline)
            && error.at_most <= ROUNDING * profile.reach
        {
            return finished(&proof, &spline, &error, length);
        }
    }
    // 2. Fitted splines, of more and more parts.
    let mut parts = vec![PARTS[0]; framed.pieces.len()];
    let mut best: Option<(FrameSpline, SweepError)> = None;
    let most = (job.memory_limit / BYTES_PER_PIECE) as usize;
    loop {
        if job.is_cancelled() {
            return Err(Failure::Cancelled);
        }
        let fitted =
            framed.fitted(&parts).and_then(|spline| proof.error_of(&spline).map(|error| (spline, error)));
        let mut more = parts.clone();
        match fitted {
            Ok((spline, error)) => {
                let is_better = best.as_ref().is_none_or(|(_, before)| error.at_most < before.at_most);
                let is_met = error.at_most <= tolerance;
                proof.refine(&spline, &error, tolerance, &mut more);
                if is_better {
                    best = Some((spline, error));
                }
                if is_met || !is_better {
                    break;
                }
            }
            Err(piece) => {
                if parts[piece] >= PARTS[1] {
                    let t = framed.path.knots().piece(piece)[0];
                    let message = format!(
                        "the path stops, or turns at once, in the piece that starts at its parameter {t}"
                    );
                    return Err(Failure::refused(RefusalCode::Unsupported, message));
                }
                more[piece] *= 4;
            }
        }
        if more == parts || more.iter().sum::<usize>() > most {
            break;
        }
        parts = more;
    }
    match best {
        Some((spline, error)) => finished(&proof, &spline, &error, length),
        None => {
            Err(Failure::refused(RefusalCode::TooMuchMemory, "the path needs more parts than the job allows"))
        }
    }
}

fn refused(error: InvalidNurbs) -> Failure<NurbsSurface> {
    Failure::refused(RefusalCode::NotFinite, error.to_string())
}

fn refuse_extremes(curves: &[&NurbsCurve<3>; 2]) -> Result<(), Failure<NurbsSurface>> {
    if flushes_subnormals() {
        let message = "nothing can be proved here: the floating-point environment flushes subnormals";
        return Err(Failure::refused(RefusalCode::FlushesSubnormals, message));
    }
    for (curve, name) in curves.iter().zip(["profile", "path"]) {
        if let Some(index) = curve.control().iter().position(|p| p.iter().any(|x| x.abs() > LARGEST)) {
            let message = format!("control point {index} of the {name} is beyond {LARGEST:e}");
            return Err(Failure::refused(RefusalCode::NotFinite, message));
        }
        if let Some(index) = curve.weights().iter().position(|w| !(1.0 / HEAVIEST..=HEAVIEST).contains(w)) {
            let message = format!("weight {index} of the {name} is beyond {HEAVIEST:e} or its inverse");
            return Err(Failure::refused(RefusalCode::NotFinite, message));
        }
    }
    let extent = extent(curves[1]);
    if extent < 1.0 / LARGEST {
        let message = format!("the path has no length: its control points are within {extent:e}");
        return Err(Failure::refused(RefusalCode::Empty, message));
    }
    Ok(())
}

fn extent(curve: &NurbsCurve<3>) -> f64 {
    let first = curve.control()[0];
    curve.control().iter().fold(0.0, |far: f64, p| greater(distance(*p, first), far))
}

/// The path with its pieces and the up vector across it.
fn framed(sweep: &SweepPath) -> Result<FramedPath<'_>, Failure<NurbsSurface>> {
    let pieces = pieces(&sweep.path).map_err(refused)?;
    let start = path_jet(&pieces[0], sweep.path.knots().domain()[0]).tangent[0];
    if !start.iter().all(|x| x.is_finite()) {
        let message = "the path has no direction where it starts: its first control points are equal";
        return Err(Failure::refused(RefusalCode::Unsupported, message));
    }
    let up = sweep.up.unwrap_or_else(|| default_up(start));
    let across: [f64; 3] = std::array::from_fn(|k| up[k] - dot(up, start) * start[k]);
    // Chosen: for an up vector nearer to the path, rounding would turn its part across the path.
    let is_across = length(across) > 1e-6 * length(up);
    if up == [0.0; 3] {
        let message = "the up vector is zero, and must lie across the path";
        return Err(Failure::refused(RefusalCode::Unsupported, message));
    }
    if !is_across {
        let message =
            format!("the up vector {up:?} is along the path where it starts, and must lie across it");
        return Err(Failure::refused(RefusalCode::Unsupported, message));
    }
    let is_closed = FramedPath::closes(&pieces);
    Ok(FramedPath { path: &sweep.path, pieces, up: unit_across(across, start), is_closed })
}

/// Refuses a path whose direction jumps by more than an angle.
fn refuse_kinks(framed: &FramedPath<'_>, most_rad: f64) -> Result<(), Failure<NurbsSurface>> {
    for pair in framed.pieces.windows(2) {
        let t = pair[1].knots().domain()[0];
        let [before, after] = [0, 1].map(|k| path_jet(&pair[k], t).tangent[0]);
        let angle = libm::atan2(length(cross(before, after)), dot(before, after));
        // NaN if the path stops, which is refused later. Chosen: rounding turns a direction by less than a billionth.
        if angle > greater(most_rad, 1e-9) {
            let degrees = angle.to_degrees();
            let message = format!(
                "the path has a kink of {degrees:.3}° at its parameter {t}: split it there, or round it"
            );
            return Err(Failure::refused(RefusalCode::Unsupported, message));
        }
    }
    Ok(())
}

fn default_up(start: [f64; 3]) -> [f64; 3] {
    // The cosine of 30°, as the docs of `SweepPath` have it.
    if start[2].abs() > 0.866 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] }
}

fn up_of(sweep: &SweepPath, framed: &FramedPath<'_>) -> [f64; 3] {
    let start = path_jet(&framed.pieces[0], sweep.path.knots().domain()[0]).tangent[0];
    sweep.up.unwrap_or_else(|| default_up(start))
}

/// A profile in the coordinates of the frame.
struct SweptProfile {
    curve: NurbsCurve<3>,
    /// The largest coordinates of control points: to the side, up, ahead, and those of the first two together.
    far: [f64; 4],
    /// The largest coordinate of the surface, or nearly.
    reach: f64,
    /// Whether the coordinates were given in space, and turned into those of the frame at the start of the path.
    is_in_space: bool,
}

impl SweptProfile {
    fn new(profile: &NurbsCurve<3>, place: ProfilePlace, framed: &FramedPath<'_>) -> Self {
        let start = path_jet(&framed.pieces[0], framed.path.knots().domain()[0]);
        let frame = [cross(framed.up, start.tangent[0]), framed.up, start.tangent[0]];
        let in_frame = |p: &[f64; 3]| match place {
            ProfilePlace::OnPath => *p,
            ProfilePlace::InSpace => frame.map(|axis| dot(axis, difference(*p, start.point))),
        };
        let control: Vec<[f64; 3]> = profile.control().iter().map(in_frame).collect();
        let most = |coordinate: &dyn Fn(&[f64; 3]) -> f64| control.iter().map(coordinate).fold(0.0, greater);
        let far = [
            most(&|p| p[0].abs()),
            most(&|p| p[1].abs()),
            most(&|p| p[2].abs()),
            // Larger by the rounding of a length.
            most(&|p| length([p[0], p[1]])) * (1.0 + 4.0 * f64::EPSILON),
        ];
        let path =
            framed.path.control().as_flattened().iter().fold(0.0, |most: f64, x| greater(x.abs(), most));
        let given = profile.control().as_flattened().iter().fold(0.0, |most: f64, x| greater(x.abs(), most));
        let reach = path + given + far[0] + far[1] + far[2];
        let curve = NurbsCurve::new(profile.knots().clone(), control, profile.weights().to_vec());
        // Valid: the numbers are finite, below 1e50, and only rotated.
        Self {
            curve: curve.unwrap_or_else(|_| profile.clone()),
            far,
            reach,
            is_in_space: place == ProfilePlace::InSpace,
        }
    }
}

/// The error of a spline of frames.
struct SweepError {
    pieces: Vec<FrameError>,
    /// By piece: the bound of its error without twist.
    without_twist: Vec<f64>,
    at_most: f64,
}

struct SweepProof<'a> {
    framed: &'a FramedPath<'a>,
    profile: &'a SweptProfile,
    up: [f64; 3],
    /// The pieces of the path, seen from its first control point.
    path: Vec<EnclosedPiece<3>>,
    job: &'a Job,
}

impl<'a> SweepProof<'a> {
    fn new(framed: &'a FramedPath<'a>, profile: &'a SweptProfile, up: [f64; 3], job: &'a Job) -> Self {
        let origin = framed.path.control()[0];
        let piece = |k: usize| EnclosedPiece::of_nurbs(framed.path, k, origin);
        Self { framed, profile, up, path: (0..framed.pieces.len()).map(piece).collect(), job }
    }

    /// The errors of one piece of a spline of frames.
    fn piece_error(&self, spline: &FrameSpline, index: usize) -> Option<FrameError> {
        let (piece, [a, b]) = spline.places[index];
        let path = &self.path[piece];
        let frames = self.frames(spline, index);
        // The whole piece, without the rounding of a part.
        if [a, b] == [0.0, 1.0] {
            frame_error(path, &frames, spline.spread)
        } else {
            frame_error(&path.part(a, b), &frames, spline.spread)
        }
    }

    fn frames(&self, spline: &FrameSpline, index: usize) -> EnclosedPiece<12> {
        let origin = self.framed.path.control()[0];
        let origin = std::array::from_fn(|k| if k < 3 { origin[k] } else { 0.0 });
        EnclosedPiece::of_nurbs(&spline.curve, index, origin)
    }

    /// The bound of a spline of frames, or the piece of the path without one.
    fn error_of(&self, spline: &FrameSpline) -> Result<SweepError, usize> {
        let errors = par_map(self.job, &spline.places, |index, _| self.piece_error(spline, index));
        let [side, up, ahead, both] = self.profile.far;
        let (mut pieces, mut without_twist) = (Vec::new(), Vec::new());
        let (mut twist, mut worst, mut start) = (0.0, 0.0, 0.0);
        let mut before: Option<(usize, FrameError)> = None;
        for ((piece, _), error) in spline.places.iter().zip(errors) {
            let error = error.ok_or(*piece)?;
            match before {
                None => {
                    start = start_turn(&self.frames(spline, 0), &error.directions[0], self.up);
                    twist = start;
                }
                // Within a piece of the path the direction does not jump.
                Some((of, before)) if of != *piece => {
                    // The factor 8 is derived in `frame_error.rs`, under *Joins*.
                    let jump = turn_between(&before.directions[1], &error.directions[0]);
                    twist = add_up(twist, mul_up(8.0, jump));
                }
                Some(_) => {}
            }
            twist = add_up(twist, error.twist);
            let vectors = error.vectors;
            let terms = [(1.0, error.position), (side, vectors[0]), (up, vectors[1]), (ahead, vectors[2])];
            let without = terms.iter().fold(0.0, |sum, (factor, x)| add_up(sum, mul_up(*factor, *x)));
            // Twists of pieces after this one do not matter here, unless the path is closed.
            if !self.framed.is_closed {
                worst = greater(add_up(without, mul_up(both, twist)), worst);
            }
            without_twist.push(without);
            before = Some((*piece, error));
            pieces.push(error);
        }
        if self.framed.is_closed
            && let (Some(first), Some(last)) = (pieces.first(), pieces.last())
        {
            let jump = turn_between(&last.directions[1], &first.directions[0]);
            // Twice: the angle that is spread over the path has the same error as the frame.
            let all = mul_up(2.0, add_up(twist, mul_up(8.0, jump)));
            let most = without_twist.iter().fold(0.0, |most: f64, x| greater(*x, most));
            worst = add_up(most, mul_up(both, all));
        }
        if self.profile.is_in_space
            && let Some(first) = pieces.first()
        {
            // The coordinates were taken in the first frame of the spline, and have its error.
            let [of_side, of_up, of_ahead] = first.vectors;
            let turned = [of_side, of_up, of_ahead, start, start].iter().fold(0.0, |sum, x| add_up(sum, *x));
            worst = add_up(worst, mul_up(turned, add_up(both, ahead)));
        }
        // Derived: a control point is a sum of four terms with two roundings each, its weight a product; a profile in space
        // takes three more products and sums, and its frame has an error of some roundings.
        let rounding = 64.0 * f64::EPSILON * self.profile.reach;
        let at_most = add_up(worst, rounding);
        if at_most.is_nan() {
            Err(spline.places[0].0)
        } else {
            Ok(SweepError { pieces, without_twist, at_most })
        }
    }

    /// Gives more parts to the pieces of the path whose errors exceed their share.
    fn refine(&self, spline: &FrameSpline, error: &SweepError, tolerance: f64, parts: &mut [usize]) {
        // Without the rounding that `error_of` adds.
        let remaining = greater(sub_down(tolerance, 64.0 * f64::EPSILON * self.profile.reach), 0.0);
        let closed = if self.framed.is_closed { 2.0 } else { 1.0 };
        // Half for twists, which add up over all pieces, and half for the other errors, of which the largest
        // counts.
        let share = 0.5 * remaining / parts.len() as f64;
        let mut twists = vec![0.0; parts.len()];
        let mut errors = vec![0.0; parts.len()];
        for (k, (piece, _)) in spline.places.iter().enumerate() {
            twists[*piece] += closed * self.profile.far[3] * error.pieces[k].twist;
            errors[*piece] = greater(error.without_twist[k], errors[*piece]);
        }
        let mut is_more = false;
        for (piece, n) in parts.iter_mut().enumerate() {
            if twists[piece] > share || errors[piece] > 0.5 * remaining {
                *n = (2 * *n).min(PARTS[1]);
                is_more = true;
            }
        }
        // The sum is too much, though no piece exceeds its share.
        if !is_more {
            parts.iter_mut().for_each(|n| *n = (2 * *n).min(PARTS[1]));
        }
    }

    /// The surface of a spline of frames: each of its control points is a frame, in which the profile's control points are
    /// placed.
    fn surface(&self, spline: &FrameSpline) -> Result<NurbsSurface, InvalidNurbs> {
        let profile = &self.profile.curve;
        let (mut control, mut weights) = (Vec::new(), Vec::new());
        for (frame, v) in spline.curve.control().iter().zip(spline.curve.weights()) {
            for ([x, y, z], w) in profile.control().iter().zip(profile.weights()) {
                control.push(std::array::from_fn(|k| {
                    frame[k] + (x * frame[3 + k] + y * frame[6 + k] + z * frame[9 + k])
                }));
                weights.push(v * w);
            }
        }
        NurbsSurface::new([profile.knots().clone(), spline.curve.knots().clone()], control, weights)
    }
}

fn finished(
    proof: &SweepProof<'_>,
    spline: &FrameSpline,
    error: &SweepError,
    tolerance: Tolerance,
) -> Result<Bounded<NurbsSurface>, Failure<NurbsSurface>> {
    let surface = proof.surface(spline).map_err(refused)?.with_slack(error.at_most);
    if !error.at_most.is_finite() {
        return Err(Failure::refused(RefusalCode::NotFinite, "the surface leaves the range of numbers"));
    }
    let bounded = Bounded { shape: surface, bound: Bound::proved(0.0, error.at_most, Reference::Curves) };
    bounded.met_if(error.at_most <= tolerance.get())
}
