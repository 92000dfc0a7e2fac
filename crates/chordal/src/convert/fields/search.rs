//! Searches for a mesh of a field within a budget: a length or a number of triangles, proved or measured.
use super::face_materials::{FaceMaterials, with_labels};
use super::grid::FieldGridStatus;
use super::improve::SurfaceImprover;
use super::mesher::{FieldMeshGoal, FieldMesher, ImprovedSurface, leaf_failure, longest};
use super::open_places::open_places;
use crate::budget::{
    Bounded, Failure, Job, OpenPlaces, Progress, ProofEffort, RefusalCode, RequiredEvidence, Tolerance,
};
use crate::check::{
    Goal, MeasuredDeviation, SandwichGoal, SandwichProver, SandwichVerdict, field_deviation, is_hopeless,
    measured_field_deviation, sandwich_bound,
};
use crate::explicit::Mesh;
use crate::implicit::{Csg, Expr, Field, PrimitiveEvaluator, Tape};
use crate::math::{Box3, greater};

/// Rounds in which unproved faces are split. Measured: 0 to 5 on the models of the tests; faces still open
/// then stay open.
const MOST_ROUNDS: usize = 10;
/// If fewer than one face in so many is open, a mesh is tried once more,
const FEW: usize = 8;
/// for this fraction of the length. Chosen: the rest, which the proof uses, is then twice as much.
const NEARER: f64 = 0.5;
/// if the first one took fewer collapses than this. Chosen: a second that has to be finer takes several times
/// as long.
const MOST_COLLAPSES: usize = 1 << 17;
/// A proof is given up after so many rounds in a row with more open faces than before. Where it is hopeless,
/// one round is enough, and boxes about the mesh would take too long.
const HOPELESS: usize = 2;
/// The same where all vertices are on their primitives. Measured: on long faces of nine capsules from one point, which
/// are halved several times before they are proved, two rounds are worse,
const SETTLED_WORSE: usize = 4;
/// with fewer than one face in so many open, a quarter there,
const SETTLED_FEW: usize = 3;
/// and with fewer than so many times the faces of the start, 1.5 there.
const SETTLED_GROWTH: usize = 2;
/// The first margin of a proof with a limit, relative to what samples suggest. Chosen: half of that of a mesh
/// that is checked alone, where a looser proof is quicker; here the rest of the length saves splits.
const MARGIN: f64 = 0.5;
/// The target, as a fraction of the length, where a proof has only values. Chosen: the rest is used to prove
/// signs.
const SAMPLED: f64 = 0.5;
/// A proof beside which a measurement would do has as many evaluations as its mesh took, and at least so many points.
/// Measured: two to three seconds of one core.
const LEAST_PROOF: u64 = 1 << 25;
/// So many points a triangle are allowed as well. Measured: the proofs of thin walls of gyroids, 36,000 and 68,000
/// triangles, take 1,600 and 2,250 in all.
const PROOF_OF_FACE: u64 = 1 << 12;
/// What a finer mesh takes, in that of the first, where a proof beside which a measurement would do may still afford it.
/// Chosen: cells are the same, and triangles half as long.
const FINER_WORK: u64 = 2;
/// Where samples alone judge a mesh, triangles are split beyond this share of the length: between samples the surface is a
/// little farther. Chosen: a tenth for what lies between them.
const STRICTER: f64 = 0.9;
/// A mesh that is too far by its samples is made again for half of the length as long as that brings it nearer by this factor.
/// Chosen: a distance goes down with the length, unless what is missed is noise, or thinner than what is sampled.
const NEARER_BY: f64 = 0.75;
/// Where splits have made this many times as many triangles, one for half of the length may have fewer. Chosen: on smooth
/// surfaces that has twice as many, on flat ones no more.
const GROWN: f64 = 1.5;
/// The most meshes made for a number of triangles.
const MOST_TRIALS: usize = 10;
/// A mesh with this fraction of the allowed triangles is good enough.
const GOOD_COUNT: f64 = 0.97;
/// The first tolerance for a number of triangles, relative to the longest side of the bounds.
const FIRST: f64 = 1.0 / 64.0;
/// Boxes of this fraction of the longest side test whether slopes are known,
const SPOT: f64 = 1.0 / 4096.0;
/// at these fractions of the bounds. Chosen: off the axes and planes of symmetry, where some primitives have
/// no slope.
const SPOTS: [[f64; 3]; 3] = [[0.43, 0.61, 0.37], [0.71, 0.29, 0.67], [0.19, 0.83, 0.53]];
/// The box that cuts off the field is larger than the bounds by this fraction of their size. Chosen: within
/// the cube of the grid.
const AROUND: f64 = 1.0 / 64.0;

pub(super) type FieldMeshResult = Result<Bounded<Mesh>, Failure<Mesh>>;

/// Finds a mesh within the limits, or the best.
pub(in crate::convert) fn search(field: &Field, wanted: &FieldMeshGoal, job: &Job) -> FieldMeshResult {
    let sign = clip_to_bounds(field);
    let (solid, tape) = (Csg::from_expr(&sign), Tape::new(&sign));
    let mut evaluator = PrimitiveEvaluator::new(&solid, &field.bounds(), job);
    let is_sampled = !has_gradient_ranges(&mut evaluator, &field.bounds())?;
    let mesher = FieldMesher { bounds: field.bounds(), is_sampled, tape: &tape, job };
    let asks_no_proof = wanted.require == RequiredEvidence::Measured;
    let is_measured = asks_no_proof || !field.evidence().bounds_above();
    let search = FieldMeshSearch { field, mesher: &mesher, wanted, is_measured, job };
    let made = match (wanted.length, wanted.triangles) {
        (None, Some(most)) => search.by_count(evaluator, most),
        (Some(length), most) => {
            search.by_length(evaluator, length).and_then(|made| search.check_triangles(made, most))
        }
        (None, None) => Err(Failure::refused(RefusalCode::Budget, "the budget has no length and no count")),
    };
    match FaceMaterials::new(&solid, job) {
        // Cuts along borders add triangles.
        Some(materials) => materials
            .paint(made, wanted.length)
            .and_then(|made| search.check_triangles(made, wanted.triangles)),
        None => made,
    }
}

enum MeshAttempt<'s> {
    Proved(Bounded<Mesh>),
    Open { left: Box<UnprovedMesh>, strategy: ProofStrategy, evaluator: PrimitiveEvaluator<'s> },
}

/// A mesh, and how far its proof came.
struct UnprovedMesh {
    mesh: Mesh,
    /// Of this mesh, if a proof was begun.
    verdict: Option<SandwichVerdict>,
    /// A point where it is not proved, if known.
    place: Option<[f64; 3]>,
    /// The conditions for what is still tried, with the work that is left.
    proof: Job,
    /// What was evaluated for the mesh, in points.
    work: u64,
}

impl UnprovedMesh {
    /// The number of copies of faces that are not proved.
    fn n_open(&self) -> usize {
        self.verdict.as_ref().map_or(usize::MAX, |verdict| verdict.open.iter().map(Vec::len).sum())
    }
}

/// A mesh that was split where samples are too far.
struct SampledAttempt<'s> {
    made: Bounded<Mesh>,
    /// Its faces before splits.
    n_first: usize,
    evaluator: PrimitiveEvaluator<'s>,
}

/// What may still prove an open mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ProofStrategy {
    /// A finer mesh: few faces are open, and another mesh does not take long.
    FinerMesh,
    /// Boxes about the mesh.
    Boxes,
    Nothing,
}

struct FieldMeshSearch<'s> {
    field: &'s Field,
    mesher: &'s FieldMesher<'s>,
    wanted: &'s FieldMeshGoal,
    /// Whether a proof is impossible or not required.
    is_measured: bool,
    job: &'s Job,
}

impl<'s> FieldMeshSearch<'s> {
    fn by_length(&self, evaluator: PrimitiveEvaluator<'s>, length: Tolerance) -> FieldMeshResult {
        self.mesher.check_precision(length.get())?;
        if self.is_measured {
            let made = self.by_samples(evaluator, length.get())?;
            return if self.is_strict() { Err(Failure::Unmet(Box::new(made))) } else { Ok(made) };
        }
        // Without slopes signs are proved by values alone, on pieces as small as the rest of the length.
        let share = if self.mesher.is_sampled { SAMPLED } else { 1.0 };
        let (left, strategy) = match self.attempt(evaluator, length, share)? {
            MeshAttempt::Proved(made) => return Ok(made),
            MeshAttempt::Open { left, strategy: ProofStrategy::FinerMesh, evaluator }
                if left.proof.work_left() > FINER_WORK.saturating_mul(left.work) =>
            {
                match self.attempt(evaluator, length, NEARER * share)? {
                    MeshAttempt::Proved(made) => return Ok(made),
                    // Where cells ended first, less is known of it.
                    MeshAttempt::Open { left: finer, .. } if finer.verdict.is_none() => {
                        (left, ProofStrategy::Nothing)
                    }
                    // What is as open with more triangles is no better.
                    MeshAttempt::Open { left: finer, .. } if finer.n_open() >= left.n_open() => {
                        (left, ProofStrategy::Boxes)
                    }
                    MeshAttempt::Open { left, strategy, .. } => (left, strategy),
                }
            }
            MeshAttempt::Open { left, strategy, .. } => (left, strategy),
        };
        let mut beyond = None;
        if strategy != ProofStrategy::Nothing && !left.proof.is_over() {
            // Boxes about the mesh may prove what its two copies do not: solids that touch, and bounds beyond the
            // wanted length.
            let goal = Goal { max: Some(length), ..Goal::default() };
            let bound = field_deviation(&left.mesh, self.field, &goal, &left.proof)?.bound;
            if bound.at_most().is_some_and(|most| most <= length.get()) {
                return Ok(Bounded { shape: left.mesh, bound });
            }
            beyond = Some(bound);
        }
        match beyond {
            // Nothing less would do, or it is certainly too far.
            Some(mut bound) if self.is_strict() || bound.at_least() > length.get() => {
                bound.open = self.places_of(&left);
                Err(Failure::Unmet(Box::new(Bounded { shape: left.mesh, bound })))
            }
            _ => self.measured_instead(*left, length.get()),
        }
    }

    /// Whether a measurement is not enough.
    fn is_strict(&self) -> bool {
        self.wanted.require == RequiredEvidence::Proved
    }

    /// A mesh whose proof did not end, measured as a whole, with the places that the proof left open.
    fn measured_instead(&self, left: UnprovedMesh, length: f64) -> FieldMeshResult {
        let places = self.places_of(&left);
        let mut made = self.measure(left.mesh)?;
        made.bound.open = places;
        if self.is_strict() {
            made.bound.at = left.place.or(made.bound.at);
            return Err(Failure::Unmet(Box::new(made)));
        }
        if made.bound.at_least() <= length { Ok(made) } else { Err(Failure::Unmet(Box::new(made))) }
    }

    /// The places that a proof left open, if one was begun.
    fn places_of(&self, left: &UnprovedMesh) -> Option<Box<OpenPlaces>> {
        let verdict = left.verdict.as_ref()?;
        Some(Box::new(open_places(&left.mesh, verdict, self.field.sign(), self.job)))
    }

    /// The conditions of a proof that begins now.
    fn proof_job(&self, work: u64, n_faces: usize) -> Job {
        let of_faces = PROOF_OF_FACE.saturating_mul(n_faces as u64);
        let work = greater(work, greater(of_faces, LEAST_PROOF));
        let is_unlimited = self.is_strict() || self.job.proof_effort == ProofEffort::Full;
        if is_unlimited { self.job.clone() } else { self.job.with_work_limit(work) }
    }

    /// A mesh that is near enough by its samples. What samples miss at first, splits may not reach: where the mesh of a length
    /// is too far, that of half of the length counts, and so on, so that what is met within a length is met within twice as
    /// much. For that each is made as if its own length had been asked for.
    fn by_samples(&self, evaluator: PrimitiveEvaluator<'s>, length: f64) -> FieldMeshResult {
        let SampledAttempt { made: mut best, n_first, mut evaluator } =
            self.sampled_attempt(evaluator, length)?;
        let is_met = |made: &Bounded<Mesh>| made.bound.at_least() <= length;
        let n_grown = (GROWN * n_first as f64) as usize;
        let mut last = best.bound.at_least();
        let mut shorter = length;
        while !self.job.is_finishing() && (!is_met(&best) || best.shape.faces().len() > n_grown) {
            let was_met = is_met(&best);
            shorter *= 0.5;
            if self.mesher.check_precision(shorter).is_err() {
                break;
            }
            let next = match self.sampled_attempt(evaluator, shorter) {
                Ok(next) => next,
                // What takes more than the job has is no reason to give nothing.
                Err(Failure::Refused(refusal))
                    if matches!(refusal.code, RefusalCode::TooManyTriangles | RefusalCode::TooMuchMemory) =>
                {
                    break;
                }
                Err(failure) => return Err(failure),
            };
            let found = next.made.bound.at_least();
            let is_better = if was_met {
                is_met(&next.made) && next.made.shape.faces().len() < best.shape.faces().len()
            } else {
                found < best.bound.at_least()
            };
            if is_better {
                best = next.made;
            }
            if was_met || found > NEARER_BY * last || is_met(&best) {
                break;
            }
            (last, evaluator) = (found, next.evaluator);
        }
        Ok(best)
    }

    /// Makes a mesh and measures it; faces from which the surface is seen to be too far are split. The best one counts.
    fn sampled_attempt(
        &self,
        evaluator: PrimitiveEvaluator<'s>,
        length: f64,
    ) -> Result<SampledAttempt<'s>, Failure<Mesh>> {
        let mut improved = self.mesher.improved_surface(evaluator, length)?.surface;
        let n_first = improved.n_faces();
        let mut best: Option<Bounded<Mesh>> = None;
        for round in 0..MOST_ROUNDS {
            self.job.report(Progress { stage: "measure", done: round as u64, total: MOST_ROUNDS as u64 });
            let (mesh, numbers) = mesh_of(&improved);
            let MeasuredDeviation { whole, far } =
                measured_field_deviation(&mesh, self.field, (STRICTER * length, round as u64), self.job)?;
            if best.as_ref().is_none_or(|best| whole.bound.at_least() < best.bound.at_least()) {
                best = Some(Bounded { shape: mesh, bound: whole.bound });
            }
            if self.job.is_finishing() {
                break;
            }
            let far: Vec<u32> = far.iter().map(|f| numbers[*f as usize]).collect();
            let is_hopeless =
                is_hopeless(far.len(), improved.n_faces()) || improved.n_faces() > SETTLED_GROWTH * n_first;
            if far.is_empty() || is_hopeless || improved.split_faces(&far)? == 0 {
                break;
            }
            self.mesher.check_size(improved.n_faces() as f64)?;
        }
        let made = best.expect("there is a first round");
        Ok(SampledAttempt { made, n_first, evaluator: improved.into_evaluator() })
    }

    /// Makes a mesh for a fraction of a length and proves it for all of it; unproved faces are split.
    fn attempt(
        &self,
        evaluator: PrimitiveEvaluator<'s>,
        length: Tolerance,
        share: f64,
    ) -> Result<MeshAttempt<'s>, Failure<Mesh>> {
        let ImprovedSurface { surface: mut improved, extent } =
            self.mesher.improved_surface(evaluator, share * length.get())?;
        let work = improved.work();
        let proof = self.proof_job(work, improved.n_faces());
        if extent == FieldGridStatus::Exhausted
            || is_hopeless(improved.n_unsettled(), improved.n_faces() / 2)
            || proof.is_over()
        {
            let (mesh, _) = mesh_of(&improved);
            let left = UnprovedMesh { mesh, verdict: None, place: improved.first_unsettled(), proof, work };
            let evaluator = improved.into_evaluator();
            let left = Box::new(left);
            return Ok(MeshAttempt::Open { left, strategy: ProofStrategy::Nothing, evaluator });
        }
        let csg = Csg::from_expr(self.field.sign());
        let mut judge = SandwichProver::new(&csg, &self.field.bounds(), &proof).map_err(leaf_failure)?;
        let goal = SandwichGoal::new(Some(length.get()), MARGIN).faces_first();
        let (is_settled, n_first) = (improved.n_unsettled() == 0, improved.n_faces());
        let (mut n_open, mut n_worse, mut is_contradicted) = (usize::MAX, 0, false);
        let mut judged = None;
        for round in 0..MOST_ROUNDS {
            self.job.report(Progress { stage: "prove", done: round as u64, total: MOST_ROUNDS as u64 });
            let (mesh, numbers) = mesh_of(&improved);
            let verdict = judge.prove(&mesh, &goal)?;
            if verdict.is_proved() {
                if let Some(bound) = sandwich_bound(&mesh, self.field, &verdict, self.job)? {
                    return Ok(MeshAttempt::Proved(Bounded { shape: mesh, bound }));
                }
                // A lower bound exceeds the upper one, as where a promise does not hold.
                is_contradicted = true;
                judged = Some((mesh, verdict));
                break;
            }
            let mut open: Vec<u32> = verdict.open.iter().flatten().map(|f| numbers[*f as usize]).collect();
            judged = Some((mesh, verdict));
            open.sort_unstable();
            open.dedup();
            // If a mesh is not near the surface at all, all of it stays open however small its faces are.
            n_worse = if open.len() > n_open { n_worse + 1 } else { 0 };
            n_open = open.len();
            let is_near = is_settled
                && n_open * SETTLED_FEW < improved.n_faces()
                && improved.n_faces() < SETTLED_GROWTH * n_first;
            let most_worse = match is_hopeless(n_open, improved.n_faces()) {
                _ if is_near => SETTLED_WORSE,
                true => 1,
                false => HOPELESS,
            };
            if n_worse >= most_worse || proof.is_over() || improved.split_faces(&open)? == 0 {
                break;
            }
            self.mesher.check_size(improved.n_faces() as f64)?;
        }
        let (mesh, verdict) = judged.expect("there is a first round");
        let is_cheap = improved.counts.collapses < MOST_COLLAPSES;
        let strategy = if is_contradicted {
            ProofStrategy::Boxes
        } else if is_cheap && n_open > 0 && FEW * n_open < improved.n_faces() {
            ProofStrategy::FinerMesh
        } else if is_hopeless(n_open, improved.n_faces()) {
            ProofStrategy::Nothing
        } else {
            ProofStrategy::Boxes
        };
        let place = verdict.first_unproved_point(&mesh);
        drop(judge);
        let left = UnprovedMesh { mesh, verdict: Some(verdict), place, proof, work };
        let left = Box::new(left);
        Ok(MeshAttempt::Open { left, strategy, evaluator: improved.into_evaluator() })
    }

    fn measure(&self, mesh: Mesh) -> FieldMeshResult {
        let found = measured_field_deviation(&mesh, self.field, (f64::INFINITY, 0), self.job)?.whole;
        Ok(Bounded { shape: mesh, bound: found.bound })
    }

    fn check_triangles(&self, made: Bounded<Mesh>, most: Option<u64>) -> FieldMeshResult {
        if most.is_none_or(|most| made.shape.faces().len() as u64 <= most) {
            Ok(made)
        } else {
            Err(Failure::Unmet(Box::new(made)))
        }
    }

    /// The finest mesh found with at most `most` triangles; their number goes like 1 over the tolerance.
    fn by_count(&self, mut evaluator: PrimitiveEvaluator<'s>, most: u64) -> FieldMeshResult {
        let most = most.min(self.mesher.most_faces());
        let mut best: Option<(f64, Mesh)> = None;
        // A tolerance with too many triangles, and one with few enough.
        let (mut fine, mut coarse) = (0.0_f64, f64::INFINITY);
        let mut tol = FIRST * self.mesher.longest();
        let mut fewest = u64::MAX;
        for _ in 0..MOST_TRIALS {
            let improved = self.mesher.improved_surface(evaluator, tol)?.surface;
            let (mesh, _) = mesh_of(&improved);
            evaluator = improved.into_evaluator();
            let count = mesh.faces().len() as f64;
            fewest = fewest.min(mesh.faces().len() as u64);
            let ratio = count / most as f64;
            if ratio <= 1.0 {
                coarse = tol;
                if best.as_ref().is_none_or(|(best, _)| tol < *best) {
                    best = Some((tol, mesh));
                }
                if ratio > GOOD_COUNT {
                    break;
                }
            } else {
                fine = tol;
            }
            // From far away a prediction is unreliable.
            let guess = tol * greater(0.125, ratio);
            let middle = (fine * coarse).sqrt();
            let is_between = guess > 1.001 * fine && guess < 0.999 * coarse;
            tol = if is_between || !(middle > 0.0 && middle.is_finite()) { guess } else { middle };
            let is_over = self.job.is_finishing() && best.is_some();
            if fine > 0.0 && coarse < 1.01 * fine || tol > self.mesher.longest() || is_over {
                break;
            }
        }
        let Some((_, mesh)) = best else {
            let message =
                format!("{most} triangles are too few: the coarsest mesh that was found has {fewest}");
            return Err(Failure::refused(RefusalCode::Budget, message));
        };
        if self.is_measured {
            let made = self.measure(mesh)?;
            return if self.is_strict() { Err(Failure::Unmet(Box::new(made))) } else { Ok(made) };
        }
        let work = evaluator.work();
        let proof = self.proof_job(work, mesh.faces().len());
        let csg = Csg::from_expr(self.field.sign());
        let mut judge = SandwichProver::new(&csg, &self.field.bounds(), &proof).map_err(leaf_failure)?;
        let verdict = judge.prove(&mesh, &SandwichGoal::new(None, MARGIN))?;
        if verdict.is_proved()
            && let Some(bound) = sandwich_bound(&mesh, self.field, &verdict, self.job)?
        {
            return Ok(Bounded { shape: mesh, bound });
        }
        drop(judge);
        let left = UnprovedMesh { mesh, verdict: Some(verdict), place: None, proof, work };
        self.measured_instead(left, f64::INFINITY)
    }
}

/// The surface as a mesh, with the half-edge face of each of its faces; of a field with materials with its labels.
fn mesh_of(improved: &SurfaceImprover) -> (Mesh, Vec<u32>) {
    let (surface, numbers) = improved.mesh();
    let mesh = Mesh::new(surface.positions, surface.faces).expect("its positions are finite");
    let is_plain = improved.csg().materials().is_none();
    (if is_plain { mesh } else { with_labels(mesh, &surface.labels) }, numbers)
}

/// The solid of a field within a box somewhat larger than its bounds, which cuts off what exceeds them.
pub(super) fn clip_to_bounds(field: &Field) -> Expr {
    let Box3 { min, max } = field.bounds();
    let mut sign = field.sign().clone();
    for (k, axis) in Expr::axes().iter().enumerate() {
        let room = AROUND * (max[k] - min[k]);
        sign = (Expr::constant(min[k] - room) - axis).max(&sign);
        sign = (axis - (max[k] + room)).max(&sign);
    }
    sign
}

/// Whether functions of the user have ranges of slopes at some test box; expressions have.
fn has_gradient_ranges(evaluator: &mut PrimitiveEvaluator, bounds: &Box3) -> Result<bool, Failure<Mesh>> {
    let primitives = evaluator.csg().primitives();
    let mut left: Vec<u32> =
        (0..primitives.len() as u32).filter(|p| primitives[*p as usize].tape().has_leaves()).collect();
    let Box3 { min, max } = *bounds;
    let size = SPOT * longest(bounds);
    for shares in SPOTS {
        let corner: [f64; 3] = std::array::from_fn(|k| min[k] + shares[k] * (max[k] - min[k]));
        let spot = Box3 { min: corner, max: corner.map(|x| x + size) };
        let questions: Vec<(u32, Box3)> = left.iter().map(|p| (*p, spot)).collect();
        let mut ranges = evaluator.dual_ranges(&questions).map_err(leaf_failure)?.into_iter();
        left.retain(|_| ranges.next().is_some_and(|range| range.gradient.is_none()));
    }
    Ok(left.is_empty())
}
