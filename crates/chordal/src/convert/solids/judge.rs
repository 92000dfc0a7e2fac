//! `judged_against_field`: proves or measures given meshes against a field.
use crate::budget::{Bounded, Failure, Job, ProofEffort, RequiredEvidence, Tolerance};
use crate::check::{SandwichGoal, SandwichProver, SandwichVerdict, measured_field_deviation, sandwich_bound};
use crate::convert::fields::{leaf_failure, open_places};
use crate::explicit::{InvalidMesh, Mesh};
use crate::implicit::{Csg, Field};
use crate::math::{difference, dot};
use std::collections::BTreeMap;

/// The first margin of the proof, relative to the distance that samples suggest. Chosen: as for meshes by `field_to_mesh`.
const MARGIN: f64 = 0.5;
/// If a measurement is also accepted, the most evaluations of a proof, in points for each triangle of the first mesh. Chosen:
/// about twice as many as successful proofs take, by their time.
const WORK_OF_TRIANGLE: u64 = 1 << 12;
/// The evaluations that are allowed in any case, in points. Chosen: so many cost little time.
const LEAST_WORK: u64 = 1 << 22;
/// The most rounds in which open faces are split. Chosen: a side is halved twice, or once more.
const MOST_ROUNDS: usize = 4;
/// The last mesh is split as long as less than one face in this many is open. Chosen: if more are, the mesh is too coarse.
const FEW: usize = 3;
/// Any mesh is split before the next one is tried as long as less than one face in this many is open. Chosen: such faces
/// are at single corners and thin triangles, like 3 of 1,752 on five cones around a ball; a finer mesh has others.
const VERY_FEW: usize = 64;

/// The first of several meshes that is proved to be within a length of the surface of a field. If none is, one of them is
/// measured, and returned with the places that its proof left open, in the same form as from
/// [`field_to_mesh`](crate::convert::field_to_mesh()): the last one tried if few of its faces are open; otherwise the first
/// one, or, if samples show that it is too far, the next ones that were not tried yet.
///
/// The next mesh is taken from the iterator only if those before it are not proved; if few faces of a mesh are open, they
/// are split until it is proved. The number of evaluations is limited, unless only a proof is accepted
/// ([`RequiredEvidence::Proved`]) or with [`ProofEffort::Full`]. The bound does not depend on the origin of the meshes.
///
/// # Errors
/// [`Failure::Unmet`] with the mesh if it is measured to be farther than the length, or if a proof is required and there
/// is none; [`Failure::Refused`] as for [`field_deviation`](crate::check::field_deviation()), and for an empty list of
/// meshes; [`Failure::Cancelled`].
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
/// let judged = judged_against_field(&mut std::iter::once(mesh), &cuboid([2.0; 3])?, goal, &Job::default());
/// assert!(judged.is_ok());
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
        let mut unproved = (first, None);
        // Without a proof there is no list of open places.
        let may_prove = require != RequiredEvidence::Measured && !job.is_finishing();
        if may_prove && field.evidence().bounds_above() {
            let csg = Csg::from_expr(field.sign());
            let most = WORK_OF_TRIANGLE.saturating_mul(unproved.0.faces().len() as u64).max(LEAST_WORK);
            let is_unlimited = is_strict || job.proof_effort == ProofEffort::Full;
            let proof = if is_unlimited { job.clone() } else { job.with_work_limit(most) };
            let mut judge = SandwichProver::new(&csg, &field.bounds(), &proof).map_err(leaf_failure)?;
            let goal = SandwichGoal::new(Some(length.get()), MARGIN).faces_first();
            let mut search = ProofSearch { field, judge: &mut judge, goal, proof: &proof, job };
            match search.proved(unproved.0, meshes)? {
                Ok(proved) => return Ok(proved),
                Err((mesh, verdict)) => {
                    let places = open_places(&mesh, &verdict, field.sign(), job);
                    unproved = (mesh, Some(Box::new(places)));
                }
            }
        }
        let (mut mesh, mut places) = unproved;
        let measured = |mesh: &Mesh| measured_field_deviation(mesh, field, (f64::INFINITY, 0), job);
        let mut bound = measured(&mesh)?.whole.bound;
        // If surfaces cross at a small angle, their edge may be farther away than both of them.
        while bound.at_least() > length.get()
            && let Some(next) = meshes.next()
        {
            // There was no proof of this one.
            (mesh, places) = (next, None);
            bound = measured(&mesh)?.whole.bound;
        }
        bound.open = places;
        let is_met = !is_strict && bound.at_least() <= length.get();
        let bounded = Bounded { shape: mesh, bound };
        bounded.met_if(is_met)
    })
}

struct ProofSearch<'a, 'b> {
    field: &'a Field,
    judge: &'a mut SandwichProver<'b>,
    goal: SandwichGoal,
    proof: &'a Job,
    job: &'a Job,
}

/// A proved mesh, or the last mesh with the verdict of its proof.
type Searched = Result<Result<Bounded<Mesh>, (Mesh, SandwichVerdict)>, Failure<Mesh>>;

impl ProofSearch<'_, '_> {
    fn proved(&mut self, first: Mesh, mut others: &mut (dyn Iterator<Item = Mesh> + Send)) -> Searched {
        let mut first_open = None;
        let mut next = first;
        loop {
            let n_faces = next.faces().len();
            let unproved = match self.prove(next)? {
                Ok(proved) => return Ok(Ok(proved)),
                Err(unproved) => unproved,
            };
            let first = first_open.get_or_insert_with(|| unproved.clone());
            let unproved = match self.with_splits(unproved, VERY_FEW)? {
                Ok(proved) => return Ok(Ok(proved)),
                Err(unproved) => unproved,
            };
            // A mesh with as many faces is no finer, and would not be proved either.
            let finer = if self.proof.is_over() {
                None
            } else {
                Iterator::find(&mut others, |mesh| mesh.faces().len() != n_faces)
            };
            match finer {
                Some(finer) => next = finer,
                // The first mesh has the fewest triangles, and is no farther from a proof.
                None if !is_few(&unproved.0, &open_faces(&unproved.1), FEW) => return Ok(Err(first.clone())),
                None => return self.with_splits(unproved, FEW),
            }
        }
    }

    /// Splits open faces until all are proved, or splits stop helping, or more than one face in `few` is open.
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
                Ok(proved) => return Ok(Ok(proved)),
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

/// Whether at most one face in `few` is open.
fn is_few(mesh: &Mesh, open: &[u32], few: usize) -> bool {
    few * open.len() <= mesh.faces().len()
}

/// The mesh with a vertex in the middle of the longest side of each of these faces. All faces at such a side are split at
/// the vertex, so that there are no T-junctions. The result has positions and faces only.
fn with_faces_split(mesh: &Mesh, faces: &[u32]) -> Result<Mesh, InvalidMesh> {
    let mut positions = mesh.positions().to_vec();
    let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    let sides = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]);
    for face in faces {
        let length_sq = |[a, b]: [u32; 2]| {
            let vector = difference(mesh.positions()[b as usize], mesh.positions()[a as usize]);
            dot(vector, vector)
        };
        let face_sides = sides(mesh.faces()[*face as usize]);
        let longest = face_sides
            .into_iter()
            .reduce(|best, side| if length_sq(side) > length_sq(best) { side } else { best });
        let Some([a, b]) = longest else { continue };
        middles.entry([a, b]).or_insert_with(|| {
            let (p, q) = (positions[a as usize], positions[b as usize]);
            positions.push(std::array::from_fn(|k| 0.5 * p[k] + 0.5 * q[k]));
            positions.len() as u32 - 1
        });
    }
    let mut cut = Vec::with_capacity(mesh.faces().len() + 2 * middles.len());
    for face in mesh.faces() {
        let [a, b, c] = *face;
        match sides(*face).map(|side| middles.get(&side).copied()) {
            [None, None, None] => cut.push(*face),
            [Some(m), None, None] => cut.extend([[a, m, c], [m, b, c]]),
            [None, Some(m), None] => cut.extend([[b, m, a], [m, c, a]]),
            [None, None, Some(m)] => cut.extend([[c, m, b], [m, a, b]]),
            // Of two middles, the corner between them is cut off, and the rest is halved.
            [Some(m), Some(n), None] => cut.extend([[m, b, n], [a, m, n], [a, n, c]]),
            [None, Some(m), Some(n)] => cut.extend([[m, c, n], [b, m, n], [b, n, a]]),
            [Some(n), None, Some(m)] => cut.extend([[m, a, n], [c, m, n], [c, n, b]]),
            [Some(m), Some(n), Some(o)] => cut.extend([[a, m, o], [m, b, n], [n, c, o], [m, n, o]]),
        }
    }
    Mesh::new(positions, cut)
}
