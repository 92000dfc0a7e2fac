//! `judged_against_field`: meshes that something else made, proved or measured against a field.
use super::split::with_faces_split;
use crate::budget::{Bounded, Failure, Job, ProofEffort, RequiredEvidence, Tolerance};
use crate::check::{SandwichGoal, SandwichProver, SandwichVerdict, measured_field_deviation, sandwich_bound};
use crate::convert::fields::{leaf_failure, open_places};
use crate::explicit::Mesh;
use crate::implicit::{Csg, Field};

/// The first margin of the proof, relative to what samples suggest: that of meshes that are made for a field.
const MARGIN: f64 = 0.5;
/// The evaluations of a proof beside which a measurement would do, for each triangle of the first mesh, in points. Chosen: about
/// twice what proofs that end take, by their time.
const WORK_OF_TRIANGLE: u64 = 1 << 12;
/// And at least so many.
const LEAST_WORK: u64 = 1 << 22;
/// The most rounds in which open faces are split. Chosen: a side is halved twice, or once more.
const MOST_ROUNDS: usize = 4;
/// The last mesh is split as long as less than one face in so many is open. Chosen: of a mesh that is too coarse more are.
const FEW: usize = 3;
/// Any mesh is split before the next is asked for as long as less than one face in so many is open. Chosen: such faces are at
/// single corners and thin triangles, as 3 of 1,752 were of five cones about a ball; a finer mesh has others of them.
const VERY_FEW: usize = 64;

/// The first of several meshes that is proved to be within a length of the surface of a field; else one of them, measured, with
/// the places that its proof leaves open, in the same form as from [`field_to_mesh`](crate::convert::field_to_mesh()): the
/// last one if few of its faces are open, else the first, or if that is too far by its samples the next that was not asked for.
///
/// Each mesh is asked for when those before it are not proved; a mesh's few open faces are split until it is. The proofs
/// take so many evaluations for each triangle at most, unless nothing but a proof will do ([`RequiredEvidence::Proved`]) or
/// [`ProofEffort::Full`] asks for their end. Whatever made the meshes, the bound is that of the judge.
///
/// # Errors
/// [`Failure::Unmet`] with the mesh where it is measured to be farther than the length, and where a proof is required and there
/// is none; what [`field_deviation`](crate::check::field_deviation()) refuses, and an empty list of meshes;
/// [`Failure::Cancelled`].
///
/// ```
/// use chordal::budget::RequiredEvidence;
/// use chordal::convert::solids::judged_against_field;
/// use chordal::implicit::shapes::cuboid;
/// use chordal::{Job, Mesh, Tolerance};
/// let corners = |k: usize| [0, 1, 2].map(|axis| if k >> axis & 1 == 1 { 1.0 } else { -1.0 });
/// let faces = vec![[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 6, 3], [3, 6, 7], [0, 4, 2],
///     [2, 4, 6], [1, 3, 5], [3, 7, 5]];
/// let mesh = Mesh::new((0..8).map(corners).collect(), faces)?;
/// let goal = (Tolerance::new(0.01)?, RequiredEvidence::Proved);
/// let made = judged_against_field(&mut std::iter::once(mesh), &cuboid([2.0; 3])?, goal, &Job::default());
/// assert!(made.is_ok());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn judged_against_field(
    meshes: &mut (dyn Iterator<Item = Mesh> + Send),
    field: &Field,
    (length, require): (Tolerance, RequiredEvidence),
    job: &Job,
) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    job.run(|| {
        let Some(first) = meshes.next() else {
            let message = "there is no mesh to be judged";
            return Err(Failure::refused(crate::budget::RefusalCode::Empty, message));
        };
        let is_strict = require == RequiredEvidence::Proved;
        let mut left = (first, None);
        // A proof that cannot begin has no places that it leaves open.
        let is_asked = require != RequiredEvidence::Measured && !job.is_finishing();
        if is_asked && field.evidence().bounds_above() {
            let csg = Csg::from_expr(field.sign());
            let most = WORK_OF_TRIANGLE.saturating_mul(left.0.faces().len() as u64).max(LEAST_WORK);
            let is_unlimited = is_strict || job.proof_effort == ProofEffort::Full;
            let proof = if is_unlimited { job.clone() } else { job.with_work_limit(most) };
            let mut judge = SandwichProver::new(&csg, &field.bounds(), &proof).map_err(leaf_failure)?;
            let goal = SandwichGoal::new(Some(length.get()), MARGIN).faces_first();
            let mut search = ProofSearch { field, judge: &mut judge, goal, proof: &proof, job };
            match search.proved(left.0, meshes)? {
                Ok(made) => return Ok(made),
                Err((mesh, verdict)) => {
                    let places = open_places(&mesh, &verdict, field.sign(), job);
                    left = (mesh, Some(Box::new(places)));
                }
            }
        }
        let (mut mesh, mut places) = left;
        let measured = |mesh: &Mesh| measured_field_deviation(mesh, field, (f64::INFINITY, 0), job);
        let mut bound = measured(&mesh)?.whole.bound;
        // Where surfaces cross at a small angle, an edge is farther off than both.
        while bound.at_least() > length.get()
            && let Some(next) = meshes.next()
        {
            // Nothing was proved of this one.
            (mesh, places) = (next, None);
            bound = measured(&mesh)?.whole.bound;
        }
        bound.open = places;
        let is_met = !is_strict && bound.at_least() <= length.get();
        let made = Bounded { shape: mesh, bound };
        if is_met { Ok(made) } else { Err(Failure::Unmet(Box::new(made))) }
    })
}

struct ProofSearch<'a, 'b> {
    field: &'a Field,
    judge: &'a mut SandwichProver<'b>,
    goal: SandwichGoal,
    proof: &'a Job,
    job: &'a Job,
}

/// A mesh that is proved, or the last one with what its proof left open.
type Searched = Result<Result<Bounded<Mesh>, (Mesh, SandwichVerdict)>, Failure<Mesh>>;

impl ProofSearch<'_, '_> {
    fn proved(&mut self, first: Mesh, mut others: &mut (dyn Iterator<Item = Mesh> + Send)) -> Searched {
        let mut first_open = None;
        let mut next = first;
        loop {
            let n_faces = next.faces().len();
            let open = match self.prove(next)? {
                Ok(made) => return Ok(Ok(made)),
                Err(open) => open,
            };
            let first = first_open.get_or_insert_with(|| open.clone());
            let open = match self.with_splits(open, VERY_FEW)? {
                Ok(made) => return Ok(Ok(made)),
                Err(open) => open,
            };
            // What is no finer is not proved either.
            let finer = if self.proof.is_over() {
                None
            } else {
                Iterator::find(&mut others, |mesh| mesh.faces().len() != n_faces)
            };
            match finer {
                Some(finer) => next = finer,
                // The first has the fewest triangles, and is as far from a proof.
                None if !is_few(&open.0, &open_faces(&open.1), FEW) => return Ok(Err(first.clone())),
                None => return self.with_splits(open, FEW),
            }
        }
    }

    /// Splits open faces until all are proved, or that helps no more; as long as less than one in so many is open.
    fn with_splits(&mut self, (mut mesh, mut verdict): (Mesh, SandwichVerdict), few: usize) -> Searched {
        let mut n_open = usize::MAX;
        for _ in 0..MOST_ROUNDS {
            let open = open_faces(&verdict);
            let is_worse = open.len() / 2 > n_open;
            if open.is_empty() || is_worse || !is_few(&mesh, &open, few) || self.proof.is_over() {
                break;
            }
            n_open = open.len();
            let Ok(split) = with_faces_split(&mesh, &open) else { break };
            match self.prove(split)? {
                Ok(made) => return Ok(Ok(made)),
                Err(open) => (mesh, verdict) = open,
            }
        }
        Ok(Err((mesh, verdict)))
    }

    fn prove(&mut self, mesh: Mesh) -> Searched {
        if self.job.is_cancelled() {
            return Err(Failure::Cancelled);
        }
        let verdict = self.judge.prove(&mesh, &self.goal)?;
        if verdict.is_proved()
            && let Some(bound) = sandwich_bound(&mesh, self.field, &verdict, self.job)?
        {
            return Ok(Ok(Bounded { shape: mesh, bound }));
        }
        Ok(Err((mesh, verdict)))
    }
}

fn open_faces(verdict: &SandwichVerdict) -> Vec<u32> {
    let mut open = verdict.open.concat();
    open.sort_unstable();
    open.dedup();
    open
}

/// Whether one in so many faces is open at most.
fn is_few(mesh: &Mesh, open: &[u32], few: usize) -> bool {
    few * open.len() <= mesh.faces().len()
}
