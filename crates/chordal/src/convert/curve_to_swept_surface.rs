//! The arrow from a profile to the surface that it sweeps along a path.
use super::sweep::frame_error::{FrameError, frame_error, start_turn, turn_between};
use super::sweep::frame_spline::{FrameSpline, FramedPath};
use super::sweep::moving_frame::{path_jet, pieces, unit_across};
use crate::budget::{Bound, Bounded, Failure, Job, Reference, RefusalCode, Tolerance, par_map};
use crate::explicit::nurbs::{EnclosedPiece, HEAVIEST, InvalidNurbs, NurbsCurve, NurbsSurface};
use crate::math::{add_up, cross, difference, dot, flushes_subnormals, greater, length, mul_up, sub_down};

/// A path, and how a profile stands on it.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepPath {
    /// The path.
    pub path: NurbsCurve<3>,
    /// The direction up where the path starts, of which the part across the path counts; without one the z axis, or the y
    /// axis where the path starts nearer to the z axis than 30°.
    pub up: Option<[f64; 3]>,
    /// What the coordinates of the profile are.
    pub place: ProfilePlace,
}

/// What the coordinates of a profile are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProfilePlace {
    /// How far a point is to the right, up, and ahead, seen from ahead of the path: against it.
    OnPath,
    /// Those of space: the profile stands where it is when the path starts.
    InSpace,
}

/// Coordinates beyond this, or a path that is shorter than its inverse, are refused: cubes of lengths stay in range. Chosen.
const LARGEST: f64 = 1e50;
/// Frames that are meant to be exact are off by less than this, relative to the largest coordinate. Chosen: some hundred
/// roundings.
const ROUNDING: f64 = 1e-11;
/// The parts of a piece of a path at first, and at most. Chosen: errors go down with the fifth power of their number.
const PARTS: [usize; 2] = [2, 4096];
/// The part of the length that a jump of direction may cost: more is a kink. Chosen.
const KINK: f64 = 1.0 / 16.0;
/// Bytes of a piece with its proof.
const BYTES_PER_PIECE: u64 = 4096;

/// The surface that a profile sweeps along a path, with a frame that does not rotate about it.
///
/// **Surface.** With the path `P`, its unit tangent `T`, and the up vector `R` that starts as `up` says and does not rotate
/// about the path, `R′ ∥ T` (a rotation-minimizing frame), it is `P + x·(R×T) + y·R + z·T` for each point `(x, y, z)` of the
/// profile. `u` runs along the profile, `v` along the path, with the parameters of both. Of a path in a plane the frame
/// stands still in the plane's normal. A profile that runs counter-clockwise, seen against the path, has its front outside.
/// On a closed path, what the frame misses after a turn is spread over the length. Where the path bends more than the
/// profile is wide, the surface folds over.
///
/// **Exact.** Along a straight path, and along arcs of one circle with the knots and weights of the path: extrusions and
/// surfaces of revolution, up to rounding.
///
/// **Bound.** Two-sided Hausdorff distance to that surface, *proved*, rounding included; of points with the same parameters
/// (up to those of a fifth degree within the pieces of the path). It is also the [`NurbsSurface::slack`] of the surface. The
/// rotation of the frame is bounded by the integral of its defect (`convert/sweep/frame_error.rs`); the twist of a closed
/// path is known as well as that, and counts twice.
///
/// **Cost.** About 0.2 ms for each part of the path; their number goes like the fifth root of 1 over the length.
///
/// # Errors
/// [`Failure::Refused`]: a path with a kink, or one that stops on its way; an up vector along the path; coordinates beyond
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
    let wanted = length.get();
    let proof = SweepProof::new(framed, profile, up_of(sweep, framed), job);
    // 1. What may be exact: judged as all others.
    let exact = [Some(framed.straight()), framed.circular()];
    for spline in exact.into_iter().flatten() {
        let spline = spline.map_err(refused)?;
        if let Ok(found) = proof.of(&spline)
            && found.at_most <= ROUNDING * profile.reach
        {
            return finished(&proof, &spline, &found, length);
        }
    }
    // 2. Splines of more and more parts.
    let mut parts = vec![PARTS[0]; framed.pieces.len()];
    let mut best: Option<(FrameSpline, SweepError)> = None;
    let most = (job.memory_limit / BYTES_PER_PIECE) as usize;
    loop {
        if job.is_cancelled() {
            return Err(Failure::Cancelled);
        }
        let made = framed.fitted(&parts).and_then(|spline| proof.of(&spline).map(|found| (spline, found)));
        let mut more = parts.clone();
        match made {
            Ok((spline, found)) => {
                let is_better = best.as_ref().is_none_or(|(_, before)| found.at_most < before.at_most);
                let is_met = found.at_most <= wanted;
                proof.refine(&spline, &found, wanted, &mut more);
                if is_better {
                    best = Some((spline, found));
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
        Some((spline, found)) => finished(&proof, &spline, &found, length),
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
    curve.control().iter().fold(0.0, |far: f64, p| greater(length(difference(*p, first)), far))
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
    // Chosen: nearer to the path rounding would turn it.
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
        // No number where the path stops, which is found later. Chosen: rounding turns a direction by less than a billionth.
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
    /// Whether its coordinates were taken in the frame where the path starts, as computed.
    is_in_space: bool,
}

impl SweptProfile {
    fn new(profile: &NurbsCurve<3>, place: ProfilePlace, framed: &FramedPath<'_>) -> Self {
        let start = path_jet(&framed.pieces[0], framed.path.knots().domain()[0]);
        let frame = [cross(framed.up, start.tangent[0]), framed.up, start.tangent[0]];
        let own = |p: &[f64; 3]| match place {
            ProfilePlace::OnPath => *p,
            ProfilePlace::InSpace => frame.map(|axis| dot(axis, difference(*p, start.point))),
        };
        let control: Vec<[f64; 3]> = profile.control().iter().map(own).collect();
        let most = |of: &dyn Fn(&[f64; 3]) -> f64| control.iter().map(of).fold(0.0, greater);
        let far = [
            most(&|p| p[0].abs()),
            most(&|p| p[1].abs()),
            most(&|p| p[2].abs()),
            // Up to the rounding of a length, which is added.
            most(&|p| length([p[0], p[1]])) * (1.0 + 4.0 * f64::EPSILON),
        ];
        let path =
            framed.path.control().as_flattened().iter().fold(0.0, |most: f64, x| greater(x.abs(), most));
        let given = profile.control().as_flattened().iter().fold(0.0, |most: f64, x| greater(x.abs(), most));
        let reach = path + given + far[0] + far[1] + far[2];
        let curve = NurbsCurve::new(profile.knots().clone(), control, profile.weights().to_vec());
        // Finite numbers below 1e50, rotated.
        Self {
            curve: curve.unwrap_or_else(|_| profile.clone()),
            far,
            reach,
            is_in_space: place == ProfilePlace::InSpace,
        }
    }
}

/// What is known of a spline of frames.
struct SweepError {
    pieces: Vec<FrameError>,
    /// By piece: the bound of all but its twist.
    off: Vec<f64>,
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
        let whole = &self.path[piece];
        let frames = self.frames(spline, index);
        if [a, b] == [0.0, 1.0] {
            frame_error(whole, &frames, spline.spread)
        } else {
            frame_error(&whole.part(a, b), &frames, spline.spread)
        }
    }

    fn frames(&self, spline: &FrameSpline, index: usize) -> EnclosedPiece<12> {
        let origin = self.framed.path.control()[0];
        let origin = std::array::from_fn(|k| if k < 3 { origin[k] } else { 0.0 });
        EnclosedPiece::of_nurbs(&spline.curve, index, origin)
    }

    /// The bound of a spline of frames, or the piece of the path where it is none.
    fn of(&self, spline: &FrameSpline) -> Result<SweepError, usize> {
        let found = par_map(self.job, &spline.places, |index, _| self.piece_error(spline, index));
        let [side, up, ahead, both] = self.profile.far;
        let (mut pieces, mut off) = (Vec::new(), Vec::new());
        let (mut twist, mut worst, mut start) = (0.0, 0.0, 0.0);
        let mut before: Option<(usize, FrameError)> = None;
        for ((piece, _), found) in spline.places.iter().zip(found) {
            let found = found.ok_or(*piece)?;
            match before {
                None => {
                    start = start_turn(&self.frames(spline, 0), &found.directions[0], self.up);
                    twist = start;
                }
                // Within a piece of the path the direction does not jump.
                Some((of, before)) if of != *piece => {
                    let jump = turn_between(&before.directions[1], &found.directions[0]);
                    twist = add_up(twist, mul_up(8.0, jump));
                }
                Some(_) => {}
            }
            twist = add_up(twist, found.twist);
            let vectors = found.vectors;
            let own = [(1.0, found.position), (side, vectors[0]), (up, vectors[1]), (ahead, vectors[2])];
            let own = own.iter().fold(0.0, |sum, (by, x)| add_up(sum, mul_up(*by, *x)));
            // Twists of pieces after this one do not matter here, unless the path is closed.
            if !self.framed.is_closed {
                worst = greater(add_up(own, mul_up(both, twist)), worst);
            }
            off.push(own);
            before = Some((*piece, found));
            pieces.push(found);
        }
        if self.framed.is_closed
            && let (Some(first), Some(last)) = (pieces.first(), pieces.last())
        {
            let jump = turn_between(&last.directions[1], &first.directions[0]);
            // What is spread is known as well as the frame itself.
            let all = mul_up(2.0, add_up(twist, mul_up(8.0, jump)));
            let most = off.iter().fold(0.0, |most: f64, x| greater(*x, most));
            worst = add_up(most, mul_up(both, all));
        }
        if self.profile.is_in_space
            && let Some(first) = pieces.first()
        {
            // The frame that the coordinates were taken in starts the spline, and is off as that is.
            let [of_side, of_up, of_ahead] = first.vectors;
            let turned = [of_side, of_up, of_ahead, start, start].iter().fold(0.0, |sum, x| add_up(sum, *x));
            worst = add_up(worst, mul_up(turned, add_up(both, ahead)));
        }
        // Derived: a control point is a sum of four terms with two roundings each, its weight a product; a profile in space
        // has taken three products and sums more, and the frame that it was taken in is off by some roundings.
        let rounding = 64.0 * f64::EPSILON * self.profile.reach;
        let at_most = add_up(worst, rounding);
        if at_most.is_nan() { Err(spline.places[0].0) } else { Ok(SweepError { pieces, off, at_most }) }
    }

    /// More parts for those pieces of the path whose errors are more than their share.
    fn refine(&self, spline: &FrameSpline, found: &SweepError, wanted: f64, parts: &mut [usize]) {
        // Without the rounding that `of` adds.
        let left = greater(sub_down(wanted, 64.0 * f64::EPSILON * self.profile.reach), 0.0);
        let closed = if self.framed.is_closed { 2.0 } else { 1.0 };
        let share = 0.5 * left / parts.len() as f64;
        let mut twists = vec![0.0; parts.len()];
        let mut offs = vec![0.0; parts.len()];
        for (k, (piece, _)) in spline.places.iter().enumerate() {
            twists[*piece] += closed * self.profile.far[3] * found.pieces[k].twist;
            offs[*piece] = greater(found.off[k], offs[*piece]);
        }
        let mut is_more = false;
        for (piece, n) in parts.iter_mut().enumerate() {
            if twists[piece] > share || offs[piece] > 0.5 * left {
                *n = (2 * *n).min(PARTS[1]);
                is_more = true;
            }
        }
        // All together are too much, though none is more than its share.
        if !is_more {
            parts.iter_mut().for_each(|n| *n = (2 * *n).min(PARTS[1]));
        }
    }

    /// The surface of a spline of frames: control points of the profile in the frames that its control points are.
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
    found: &SweepError,
    wanted: Tolerance,
) -> Result<Bounded<NurbsSurface>, Failure<NurbsSurface>> {
    let surface = proof.surface(spline).map_err(refused)?.with_slack(found.at_most);
    if !found.at_most.is_finite() {
        return Err(Failure::refused(RefusalCode::NotFinite, "the surface leaves the range of numbers"));
    }
    let made = Bounded { shape: surface, bound: Bound::proved(0.0, found.at_most, Reference::Curves) };
    if found.at_most <= wanted.get() { Ok(made) } else { Err(Failure::Unmet(Box::new(made))) }
}
