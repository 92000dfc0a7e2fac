//! Searches for a mesh of a field within a budget: a length or a number of triangles, proved or measured.
use super::face_materials::FaceMaterials;
use super::grid::FieldGridStatus;
use super::improve::SurfaceImprover;
use super::mesher::{FieldMeshGoal, FieldMesher, ImprovedSurface, leaf_failure, longest};
use super::open_places::open_places;
use super::paint::with_labels;
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

/// Rounds in which unproved faces are split. Measured: 0 to 5 on the models of the tests; faces that are
/// open after more rounds stay open.
const MOST_ROUNDS: usize = 10;
/// A finer mesh is tried if fewer than one face in this many is open. Chosen: if more are, the mesh is not near enough.
const FEW: usize = 8;
/// The finer mesh is built for this fraction of the length. Chosen: then the proof has the other half of it.
const NEARER: f64 = 0.5;
/// A finer mesh is tried only if the first mesh took fewer collapses than this. Chosen: the finer one takes several times
/// as long.
const MOST_COLLAPSES: usize = 1 << 17;
/// A proof is given up after this many consecutive rounds with more open faces than before. If it is hopeless,
/// one round is enough, and boxes around the mesh would take too long.
const HOPELESS: usize = 2;
/// The same if all vertices are on their primitives, and [`SETTLED_FEW`] and [`SETTLED_GROWTH`] hold. Measured: long faces
/// of nine capsules from one point are halved several times before they are proved, so that two rounds are worse.
const SETTLED_WORSE: usize = 4;
/// Fewer than one face in this many is open. Measured: a quarter on those capsules.
const SETTLED_FEW: usize = 3;
/// There are fewer than this many times the faces of the start. Measured: 1.5 times on those capsules.
const SETTLED_GROWTH: usize = 2;
/// The first margin of a proof with a limit, relative to the distance that samples suggest. Chosen: half of the margin for
/// a finished mesh, where a looser proof is quicker; here the rest of the length saves splits.
const MARGIN: f64 = 0.5;
/// The target, as a fraction of the length, if a proof has no slopes. Chosen: the rest is used to prove signs.
const SAMPLED: f64 = 0.5;
/// If a measurement is also accepted, a proof may take as many evaluations as its mesh did, and at least this many points.
/// Measured: two to three seconds of one core.
const LEAST_PROOF: u64 = 1 << 25;
/// It may also take this many points a triangle. Measured: the proofs of thin walls of gyroids, 36,000 and 68,000
/// triangles, take 1,600 and 2,250 in all.
const PROOF_OF_FACE: u64 = 1 << 12;
/// If a measurement is also accepted, a finer mesh is tried only if the remaining work is this many times that of the first
/// mesh. Chosen: cells are the same, and triangles half as long.
const FINER_WORK: u64 = 2;
/// If a mesh is only measured, triangles are split if they are farther than this share of the length. Chosen: a tenth is
/// left for the surface between samples, which may be a little farther.
const STRICTER: f64 = 0.9;
/// A mesh whose measured distance is too large is built again for half of the length, as long as that reduces the distance
/// by this factor. Chosen: a distance falls with the length, unless the missed parts are noise, or thinner than the samples.
const NEARER_BY: f64 = 0.75;
/// If splits have multiplied the triangles by more than this, a mesh for half of the length is tried, which may have fewer.
/// Chosen: it has twice as many triangles on smooth surfaces, and no more on flat ones.
const GROWN: f64 = 1.5;
/// The most meshes that are built for a number of triangles. Chosen: each takes as long as a result.
const MOST_TRIALS: usize = 10;
/// A mesh with this fraction of the allowed triangles ends the search. Chosen: more trials gain little.
const GOOD_COUNT: f64 = 0.97;
/// The first tolerance for a number of triangles, relative to the longest side of the bounds. Chosen: later ones correct it.
const FIRST: f64 = 1.0 / 64.0;
/// The size of the boxes in which ranges of slopes are tested, relative to the longest side. Chosen: slopes hardly vary
/// in so small a box.
const SPOT: f64 = 1.0 / 4096.0;
/// The positions of these boxes in the bounds. Chosen: off the axes and planes of symmetry, where some primitives have
/// no slope.
const SPOTS: [[f64; 3]; 3] = [[0.43, 0.61, 0.37], [0.71, 0.29, 0.67], [0.19, 0.83, 0.53]];
/// The margin of the box that clips the field, relative to the size of the bounds. Chosen: the box is within the cube of
/// the grid.
const CLIP_MARGIN: f64 = 1.0 / 64.0;

pub(super) type FieldMeshResult = Result<Bounded<Mesh>, Failure<Mesh>>;

/// Finds a mesh within the limits; otherwise the failure has the best mesh.
pub(in crate::convert) fn search(field: &Field, goal: &FieldMeshGoal, job: &Job) -> FieldMeshResult {
    let sign = clip_to_bounds(field);
    let (solid, tape) = (Csg::from_expr(&sign), Tape::new(&sign));
    let mut evaluator = PrimitiveEvaluator::new(&solid, &field.bounds(), job);
    let is_sampled = !has_gradient_ranges(&mut evaluator, &field.bounds())?;
    let mesher = FieldMesher { bounds: field.bounds(), is_sampled, tape: &tape, job };
    let asks_no_proof = goal.require == RequiredEvidence::Measured;
    let is_measured = asks_no_proof || !field.evidence().bounds_above();
    let search = FieldMeshSearch { field, mesher: &mesher, goal, is_measured, job };
    let mesh = match (goal.length, goal.triangles) {
        (None, Some(most)) => search.by_count(evaluator, most),
        (Some(length), most) => {
            search.by_length(evaluator, length).and_then(|mesh| search.check_triangles(mesh, most))
        }
        (None, None) => Err(Failure::refused(RefusalCode::Budget, "the budget has no length and no count")),
    };
    match FaceMaterials::new(&solid, job) {
        // Checked again, since cuts along borders add triangles.
        Some(materials) => {
            materials.paint(mesh, goal.length).and_then(|mesh| search.check_triangles(mesh, goal.triangles))
        }
        None => mesh,
    }
}

enum MeshAttempt<'s> {
    Proved(Bounded<Mesh>),
    Open { unproved: Box<UnprovedMesh>, strategy: ProofStrategy, evaluator: PrimitiveEvaluator<'s> },
}

/// A mesh, and the state of its proof.
struct UnprovedMesh {
    mesh: Mesh,
    /// The verdict on this mesh, if a proof was begun.
    verdict: Option<SandwichVerdict>,
    /// A point without a proof, if known.
    open_at: Option<[f64; 3]>,
    /// The job for further proofs, with the remaining work.
    proof: Job,
    /// The evaluations that the mesh took, in points.
    work: u64,
}

impl UnprovedMesh {
    /// The number of copies of faces that are not proved.
    fn n_open(&self) -> usize {
        self.verdict.as_ref().map_or(usize::MAX, |verdict| verdict.open.iter().map(Vec::len).sum())
    }
}

/// A measured mesh, whose faces were split where samples are too far.
struct SampledAttempt<'s> {
    mesh: Bounded<Mesh>,
    /// The number of faces before splits.
    n_first: usize,
    evaluator: PrimitiveEvaluator<'s>,
}

/// The next way to prove an open mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ProofStrategy {
    /// A finer mesh: few faces are open, and another mesh does not take long.
    FinerMesh,
    /// Boxes around the mesh.
    Boxes,
    Nothing,
}

struct FieldMeshSearch<'s> {
    field: &'s Field,
    mesher: &'s FieldMesher<'s>,
    goal: &'s FieldMeshGoal,
    /// Whether a proof is impossible or not required.
    is_measured: bool,
    job: &'s Job,
}

impl<'s> FieldMeshSearch<'s> {
    fn by_length(&self, evaluator: PrimitiveEvaluator<'s>, length: Tolerance) -> FieldMeshResult {
        self.mesher.check_precision(length.get())?;
        if self.is_measured {
            let mesh = self.by_samples(evaluator, length.get())?;
            return mesh.met_if(!self.is_strict());
        }
        // Without slopes, signs are proved by values alone, on pieces as small as the rest of the length.
        let share = if self.mesher.is_sampled { SAMPLED } else { 1.0 };
        let (unproved, strategy) = match self.attempt(evaluator, length, share)? {
            MeshAttempt::Proved(mesh) => return Ok(mesh),
            MeshAttempt::Open { unproved, strategy: ProofStrategy::FinerMesh, evaluator }
                if unproved.proof.work_left() > FINER_WORK.saturating_mul(unproved.work) =>
            {
                match self.attempt(evaluator, length, NEARER * share)? {
                    MeshAttempt::Proved(mesh) => return Ok(mesh),
                    // Its cells ran out before a proof could begin: the first mesh is better known.
                    MeshAttempt::Open { unproved: finer, .. } if finer.verdict.is_none() => {
                        (unproved, ProofStrategy::Nothing)
                    }
                    // As many open faces with more triangles is no gain.
                    MeshAttempt::Open { unproved: finer, .. } if finer.n_open() >= unproved.n_open() => {
                        (unproved, ProofStrategy::Boxes)
                    }
                    MeshAttempt::Open { unproved, strategy, .. } => (unproved, strategy),
                }
            }
            MeshAttempt::Open { unproved, strategy, .. } => (unproved, strategy),
        };
        let mut box_bound = None;
        if strategy != ProofStrategy::Nothing && !unproved.proof.is_over() {
            // Boxes around the mesh may prove cases that its two displaced copies cannot: solids that touch, and bounds
            // beyond the length.
            let goal = Goal { max: Some(length), ..Goal::default() };
            let bound = field_deviation(&unproved.mesh, self.field, &goal, &unproved.proof)?.bound;
            if bound.at_most().is_some_and(|most| most <= length.get()) {
                return Ok(Bounded { shape: unproved.mesh, bound });
            }
            box_bound = Some(bound);
        }
        match box_bound {
            // Only a proof is accepted, or the mesh is certainly too far.
            Some(mut bound) if self.is_strict() || bound.at_least() > length.get() => {
                bound.open = self.places_of(&unproved);
                Err(Failure::Unmet(Box::new(Bounded { shape: unproved.mesh, bound })))
            }
            _ => self.measured_instead(*unproved, length.get()),
        }
    }

    /// Whether only a proof is accepted.
    fn is_strict(&self) -> bool {
        self.goal.require == RequiredEvidence::Proved
    }

    /// An unproved mesh, measured as a whole, with the places that the proof left open.
    fn measured_instead(&self, unproved: UnprovedMesh, length: f64) -> FieldMeshResult {
        let places = self.places_of(&unproved);
        let mut measured = self.measure(unproved.mesh)?;
        measured.bound.open = places;
        if self.is_strict() {
            measured.bound.at = unproved.open_at.or(measured.bound.at);
            return Err(Failure::Unmet(Box::new(measured)));
        }
        if measured.bound.at_least() <= length {
            Ok(measured)
        } else {
            Err(Failure::Unmet(Box::new(measured)))
        }
    }

    /// The places that a proof left open, if one was begun.
    fn places_of(&self, unproved: &UnprovedMesh) -> Option<Box<OpenPlaces>> {
        let verdict = unproved.verdict.as_ref()?;
        Some(Box::new(open_places(&unproved.mesh, verdict, self.field.sign(), self.job)))
    }

    /// The job of a proof, with its limit of work.
    fn proof_job(&self, work: u64, n_faces: usize) -> Job {
        let of_faces = PROOF_OF_FACE.saturating_mul(n_faces as u64);
        let work = greater(work, greater(of_faces, LEAST_PROOF));
        let is_unlimited = self.is_strict() || self.job.proof_effort == ProofEffort::Full;
        if is_unlimited { self.job.clone() } else { self.job.with_work_limit(work) }
    }

    /// A mesh that is near enough by its samples. Splits may not reach the parts that samples missed at first: if the mesh for a
    /// length is too far, the mesh for half of the length is built, and so on. Each is built exactly as for a budget of its own
    /// length, so that a result for a length is also one for twice the length.
    fn by_samples(&self, evaluator: PrimitiveEvaluator<'s>, length: f64) -> FieldMeshResult {
        let SampledAttempt { mesh: mut best, n_first, mut evaluator } =
            self.sampled_attempt(evaluator, length)?;
        let is_met = |mesh: &Bounded<Mesh>| mesh.bound.at_least() <= length;
        let n_grown = (GROWN * n_first as f64) as usize;
        let mut last = best.bound.at_least();
        let mut shorter = length;
        while !self.job.is_finishing() && (!is_met(&best) || best.shape.faces().len() > n_grown) {
            // A mesh may be good enough but have many more faces than before the splits. Then one finer mesh
            // is tried, which may need fewer.
            let was_met = is_met(&best);
            shorter *= 0.5;
            if self.mesher.check_precision(shorter).is_err() {
                break;
            }
            let next = match self.sampled_attempt(evaluator, shorter) {
                Ok(next) => next,
                // The job does not allow a finer mesh: the best so far is returned.
                Err(Failure::Refused(refusal))
                    if matches!(refusal.code, RefusalCode::TooManyTriangles | RefusalCode::TooMuchMemory) =>
                {
                    break;
                }
                Err(failure) => return Err(failure),
            };
            let distance = next.mesh.bound.at_least();
            let is_better = if was_met {
                is_met(&next.mesh) && next.mesh.shape.faces().len() < best.shape.faces().len()
            } else {
                distance < best.bound.at_least()
            };
            if is_better {
                best = next.mesh;
            }
            if was_met || distance > NEARER_BY * last || is_met(&best) {
                break;
            }
            (last, evaluator) = (distance, next.evaluator);
        }
        Ok(best)
    }

    /// Builds a mesh and measures it; faces that are too far from the surface are split. Returns the best of all rounds.
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
        let mesh = best.expect("there is a first round");
        Ok(SampledAttempt { mesh, n_first, evaluator: improved.into_evaluator() })
    }

    /// Builds a mesh for a fraction of a length and proves it for the length; unproved faces are split.
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
        // A closed mesh has about half as many vertices as faces.
        if extent == FieldGridStatus::Exhausted
            || is_hopeless(improved.n_unsettled(), improved.n_faces() / 2)
            || proof.is_over()
        {
            let (mesh, _) = mesh_of(&improved);
            let open_at = improved.first_unsettled();
            let unproved = Box::new(UnprovedMesh { mesh, verdict: None, open_at, proof, work });
            let evaluator = improved.into_evaluator();
            return Ok(MeshAttempt::Open { unproved, strategy: ProofStrategy::Nothing, evaluator });
        }
        // The judge takes the field apart itself, so that an error of the mesher cannot hide in the
        // primitives that it passes on.
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
                // A lower bound exceeds the upper one, as if a condition of the field does not hold.
                is_contradicted = true;
                judged = Some((mesh, verdict));
                break;
            }
            let mut open: Vec<u32> = verdict.open.iter().flatten().map(|f| numbers[*f as usize]).collect();
            judged = Some((mesh, verdict));
            open.sort_unstable();
            open.dedup();
            // A mesh that is not near the surface stays open however small its faces are.
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
        let open_at = verdict.first_unproved_point(&mesh);
        drop(judge);
        let unproved = Box::new(UnprovedMesh { mesh, verdict: Some(verdict), open_at, proof, work });
        Ok(MeshAttempt::Open { unproved, strategy, evaluator: improved.into_evaluator() })
    }

    fn measure(&self, mesh: Mesh) -> FieldMeshResult {
        let deviation = measured_field_deviation(&mesh, self.field, (f64::INFINITY, 0), self.job)?.whole;
        Ok(Bounded { shape: mesh, bound: deviation.bound })
    }

    fn check_triangles(&self, mesh: Bounded<Mesh>, most: Option<u64>) -> FieldMeshResult {
        if most.is_none_or(|most| mesh.shape.faces().len() as u64 <= most) {
            Ok(mesh)
        } else {
            Err(Failure::Unmet(Box::new(mesh)))
        }
    }

    /// The finest mesh found with at most `most` triangles. The search assumes that their number grows like 1/tolerance.
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
            // If counts grow like 1/tolerance, the middle of two tolerances is the geometric one.
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
            let measured = self.measure(mesh)?;
            return measured.met_if(!self.is_strict());
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
        let unproved = UnprovedMesh { mesh, verdict: Some(verdict), open_at: None, proof, work };
        self.measured_instead(unproved, f64::INFINITY)
    }
}

/// The surface as a mesh, and by face the number of its half-edge face. If the field has materials, faces have labels.
fn mesh_of(improved: &SurfaceImprover) -> (Mesh, Vec<u32>) {
    let (surface, numbers) = improved.mesh();
    let mesh = Mesh::new(surface.positions, surface.faces).expect("its positions are finite");
    let is_plain = improved.csg().materials().is_none();
    (if is_plain { mesh } else { with_labels(mesh, &surface.labels) }, numbers)
}

/// The sign of a field, clipped to a box somewhat larger than its bounds.
pub(super) fn clip_to_bounds(field: &Field) -> Expr {
    let Box3 { min, max } = field.bounds();
    let mut sign = field.sign().clone();
    for (k, axis) in Expr::axes().iter().enumerate() {
        let margin = CLIP_MARGIN * (max[k] - min[k]);
        sign = (Expr::constant(min[k] - margin) - axis).max(&sign);
        sign = (axis - (max[k] + margin)).max(&sign);
    }
    sign
}

/// Whether every primitive with leaves has a range of slopes in some test box; expressions always have.
fn has_gradient_ranges(evaluator: &mut PrimitiveEvaluator, bounds: &Box3) -> Result<bool, Failure<Mesh>> {
    let primitives = evaluator.csg().primitives();
    let mut without_range: Vec<u32> =
        (0..primitives.len() as u32).filter(|p| primitives[*p as usize].tape().has_leaves()).collect();
    let Box3 { min, max } = *bounds;
    let size = SPOT * longest(bounds);
    for shares in SPOTS {
        let corner: [f64; 3] = std::array::from_fn(|k| min[k] + shares[k] * (max[k] - min[k]));
        let spot = Box3 { min: corner, max: corner.map(|x| x + size) };
        let queries: Vec<(u32, Box3)> = without_range.iter().map(|p| (*p, spot)).collect();
        let mut ranges = evaluator.dual_ranges(&queries).map_err(leaf_failure)?.into_iter();
        without_range.retain(|_| ranges.next().is_some_and(|range| range.gradient.is_none()));
    }
    Ok(without_range.is_empty())
}
