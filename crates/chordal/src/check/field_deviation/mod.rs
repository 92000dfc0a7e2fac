//! `field_deviation`: how far a mesh is from the surface of a field, certified from both sides.
mod from_field;
mod from_mesh;
mod measured;
mod slope;

use super::deviation::{Goal, OneSided};
use crate::budget::{Bound, Code, Evidence, Job, Reference, Refusal, Stopped, par_map};
use crate::explicit::{Bvh, Enclosure, Mesh};
use crate::implicit::{Field, LeafError, Tape};
use crate::math::{Box3, Interval, flushes_subnormals};
use from_field::{Found, Target, crossed};
use from_mesh::{Known, MOST_CUTS, Piece};
use std::sync::Arc;

/// How far a mesh and the surface of a field are apart.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldDeviation {
    /// The Hausdorff distance between the two.
    pub bound: Bound,
    /// From the points of the mesh to the surface of the field.
    pub forward: OneSided,
    /// From the points of the field's surface to the mesh.
    pub backward: OneSided,
    /// Whether the goal was reached. Where it was not, the bound holds all the same.
    pub reached: bool,
    /// Pieces of triangles near which no surface was proved to be: with any, there is no bound from above.
    pub unresolved: u64,
}

/// Pieces in one task.
const CHUNK: usize = 256;
/// With leaves, which are asked for everything at once.
const LEAF_CHUNK: usize = 1 << 16;
/// Pieces looked at in all, as a multiple of the faces and at least so many: beyond, what is known has to do.
const PIECES_A_FACE: usize = 64;
const FEW_PIECES: usize = 1 << 18;
/// So often a piece is cut for a bound that is closer than what was asked for.
const EAGER: u32 = 5;
/// Boxes looked at in all, likewise.
const BOXES_A_FACE: usize = 64;
const FEW_BOXES: usize = 1 << 21;
/// What rounding leaves of a distance that is 0, as a share of the largest coordinate: derived from the slack of pieces
/// (32 ε), taken twice.
const FLOOR: f64 = 64.0 * f64::EPSILON;

/// The Hausdorff distance between a mesh and the surface of a field, the boundary of where it is negative, enclosed.
///
/// *What it covers.* All points of both surfaces, rounding included, whatever made the mesh. The field is taken by its
/// [`Field::sign`], and its [`Field::bounds`] are taken at their word: outside of them there is no surface. Where a leaf of
/// the field knows no ranges there is nothing to prove with, and the result is measured: the distance of points of the
/// field's surface, found beside the middles of the triangles, from below alone.
///
/// *Cost.* Each triangle takes a range of the field's gradient, once where it lies well, some times where the surface bends;
/// edges and corners of the field some dozen more. The result does not depend on the threads.
///
/// # Errors
/// [`Stopped::Refused`] with [`Code::Unsupported`] for a field without finite bounds, [`Code::Empty`] for a mesh without faces,
/// [`Code::LeafFailed`] when a leaf does, and as for [`crate::check::deviation`]; [`Stopped::Cancelled`].
///
/// ```
/// use chordal::check::{Goal, field_deviation};
/// use chordal::implicit::{Expr, Field};
/// use chordal::math::Box3;
/// use chordal::{Job, Mesh};
/// let [x, y, z] = Expr::axes();
/// let ball = Field::new(x.square() + y.square() + z.square() - 1.0)
///     .with_bounds(Box3 { min: [-1.0; 3], max: [1.0; 3] });
/// // An octahedron in the ball: its faces are 1 - 1/√3 from the sphere.
/// let axes = [[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
/// let faces = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
/// let mesh = Mesh::new(axes.to_vec(), faces)?;
/// let found = field_deviation(&mesh, &ball, &Goal::default(), &Job::default())?;
/// let truth = 1.0 - 1.0 / 3.0_f64.sqrt();
/// assert!(found.bound.at_least() <= truth && truth <= found.bound.at_most().unwrap());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Source: shells and sweeps as in the notes beside the two directions, `check/field_deviation/from_mesh.rs` and
/// `from_field.rs`; the mean value theorem for generalized gradients is G. Lebourg's, 1975.
pub fn field_deviation(
    mesh: &Mesh,
    field: &Field,
    goal: &Goal,
    job: &Job,
) -> Result<FieldDeviation, Stopped> {
    job.run(|| {
        if flushes_subnormals() {
            let message =
                "the floating-point environment flushes subnormal numbers, so that nothing can be proved";
            return refused(Code::FlushesSubnormals, message);
        }
        if mesh.faces().is_empty() {
            return refused(Code::Empty, "the mesh has no triangle, so nothing is near it");
        }
        let bounds = field.bounds();
        if bounds.is_empty() || !bounds.diagonal().is_finite() {
            let message = "the field has no finite bounds to look for its surface in";
            return refused(Code::Unsupported, message);
        }
        let tape = Tape::of(field.sign());
        if !tape.evidence().bounds_above() {
            return measured::measured(mesh, field, &tape, job);
        }
        let bvh = Bvh::build(mesh, job)?;
        let mut search = Search { mesh, tape, goal, job, least: 0.0, floor: FLOOR * reach(mesh, &bounds) };
        let forward = search.forward()?;
        let enclosure = Enclosure::new(mesh, &bvh);
        let enough = larger(search.enough(), if goal.max.is_some() { 0.0 } else { forward.most });
        let target = Target { bvh: &bvh, enclosure: &enclosure, strays: &forward.strays, enough };
        // Without a bound from above for the mesh there is none for both.
        let backward = if forward.unresolved > 0 {
            Backward { least: 0.0, most: f64::INFINITY, at: forward.at }
        } else {
            search.backward(&bounds, &target)?
        };
        Ok(search.conclusion(&forward, &backward, &bvh))
    })
}

fn refused<T>(code: Code, message: impl Into<String>) -> Result<T, Stopped> {
    Err(Stopped::Refused(Refusal { code, message: message.into() }))
}

fn failed(error: LeafError) -> Stopped {
    Stopped::Refused(Refusal { code: Code::LeafFailed, message: error.message })
}

/// Looks once more at some of the pieces.
fn on_some(
    which: &[usize],
    pieces: &[Piece],
    known: &mut [Known],
    look: impl FnOnce(&[&Piece], &mut [Known]) -> Result<(), LeafError>,
) -> Result<(), LeafError> {
    if which.is_empty() {
        return Ok(());
    }
    let of: Vec<&Piece> = which.iter().map(|k| &pieces[*k]).collect();
    let mut theirs: Vec<Known> = which.iter().map(|k| known[*k]).collect();
    look(&of, &mut theirs)?;
    which.iter().zip(theirs).for_each(|(k, theirs)| known[*k] = theirs);
    Ok(())
}

fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The largest coordinate.
fn reach(mesh: &Mesh, bounds: &Box3) -> f64 {
    let all = mesh.bounds().union(*bounds);
    all.min.iter().chain(&all.max).fold(0.0, |most: f64, x| larger(most, x.abs()))
}

struct Search<'a> {
    mesh: &'a Mesh,
    tape: Tape,
    goal: &'a Goal,
    job: &'a Job,
    /// The distance is at least this.
    least: f64,
    floor: f64,
}

/// What is known of all points of the mesh.
struct Forward {
    strays: Vec<f64>,
    most: f64,
    at: [f64; 3],
    unresolved: u64,
}

/// What is known of all points of the field's surface.
struct Backward {
    /// Some point is this far.
    least: f64,
    most: f64,
    at: [f64; 3],
}

impl Search<'_> {
    /// The distance that is good enough for every point.
    fn enough(&self) -> f64 {
        let wanted = match self.goal.max {
            Some(max) => max.get(),
            None => {
                let relative = self.least * (1.0 + larger(self.goal.relative, 0.0));
                larger(relative, self.goal.absolute.map_or(0.0, |length| self.least + length.get()))
            }
        };
        larger(wanted, self.floor)
    }

    fn cancelled(&self) -> Result<(), Stopped> {
        if self.job.is_cancelled() { Err(Stopped::Cancelled) } else { Ok(()) }
    }

    fn forward(&mut self) -> Result<Forward, Stopped> {
        let faces = self.mesh.faces();
        let mut out = Forward { strays: vec![0.0; faces.len()], most: 0.0, at: [0.0; 3], unresolved: 0 };
        let mut open: Vec<Piece> =
            (0..faces.len()).map(|face| Piece::whole(self.mesh.corners(face), face as u32)).collect();
        let mut left = PIECES_A_FACE * faces.len() + FEW_PIECES;
        let mut best = 0.0;
        while !open.is_empty() {
            self.cancelled()?;
            let known = self.look(&open)?;
            left = left.saturating_sub(open.len());
            for known in &known {
                if known.at_least > best {
                    (best, out.at) = (known.at_least, known.at);
                }
            }
            self.least = best;
            // Some point is farther than is asked for: nothing else matters, and what is known so far has to do.
            if self.goal.max.is_some_and(|max| best > max.get()) {
                left = 0;
            }
            let enough = self.enough();
            // What is only just near enough leaves the other direction no room, and a bound that says little.
            let tight = if self.goal.max.is_some() { larger(1.15 * best, 0.3 * enough) } else { enough };
            let mut next = Vec::new();
            for (piece, known) in open.into_iter().zip(&known) {
                let wanted = if piece.cuts() < EAGER { tight } else { enough };
                if known.at_most > wanted && piece.cuts() < MOST_CUTS && left > 0 {
                    piece.parts(known, &mut next);
                    continue;
                }
                let strays = &mut out.strays[piece.face as usize];
                *strays = larger(*strays, if known.strays.is_nan() { f64::INFINITY } else { known.strays });
                out.most = larger(out.most, known.at_most);
                out.unresolved += u64::from(known.at_most == f64::INFINITY);
            }
            open = next;
        }
        Ok(out)
    }

    fn look(&self, pieces: &[Piece]) -> Result<Vec<Known>, Stopped> {
        let chunk = if self.tape.has_leaves() { LEAF_CHUNK } else { CHUNK };
        let chunks: Vec<&[Piece]> = pieces.chunks(chunk).collect();
        let enough = self.enough();
        let look = |_: usize, pieces: &&[Piece]| -> Result<Vec<Known>, LeafError> {
            let tape = self.local(pieces.iter().fold(Box3::EMPTY, |all, piece| all.union(piece.about())))?;
            let mut known = from_mesh::look(&tape, pieces)?;
            // Not with the short tape: what these two look at lies outside of its box.
            let lost: Vec<usize> = (0..pieces.len()).filter(|k| known[*k].at_most > enough).collect();
            on_some(&lost, pieces, &mut known, |of, known| {
                from_mesh::look_across(&self.tape, of, known, enough)
            })?;
            let near = |k: &usize| known[*k].at_most > enough && pieces[*k].is_within(enough);
            let lost: Vec<usize> = lost.into_iter().filter(|k| near(k) && pieces[*k].cuts() > 3).collect();
            on_some(&lost, pieces, &mut known, |of, known| {
                from_mesh::look_around(&self.tape, of, known, enough)
            })?;
            Ok(known)
        };
        let parts = par_map(self.job, &chunks, look);
        let parts: Result<Vec<Vec<Known>>, LeafError> = parts.into_iter().collect();
        Ok(parts.map_err(failed)?.concat())
    }

    /// The tape for a box: shorter where that pays.
    fn local(&self, bounds: Box3) -> Result<Tape, LeafError> {
        if self.tape.has_leaves() || self.tape.len() < 16 {
            return Ok(self.tape.clone());
        }
        Ok(self.tape.shortened(&bounds)?.1.unwrap_or_else(|| self.tape.clone()))
    }

    fn backward(&self, bounds: &Box3, target: &Target) -> Result<Backward, Stopped> {
        let mut out = Backward { least: 0.0, most: 0.0, at: bounds.centre() };
        let mut left = BOXES_A_FACE * self.mesh.faces().len() + FEW_BOXES;
        let mut tasks = vec![Task { tape: Arc::new(self.tape.clone()), boxes: vec![cube(bounds)] }];
        let mut cuts = 0;
        while !tasks.is_empty() {
            self.cancelled()?;
            let results = par_map(self.job, &tasks, |_, task| task.run(target));
            let mut open: Vec<(Arc<Tape>, Box3)> = Vec::new();
            for (task, result) in tasks.iter().zip(results) {
                let result = result.map_err(failed)?;
                left = left.saturating_sub(result.looked_at);
                if result.most > out.most {
                    (out.most, out.at) = (result.most, result.at);
                }
                open.extend(result.open.into_iter().map(|bounds| (Arc::clone(&task.tape), bounds)));
            }
            cuts += 1;
            out.least = larger(out.least, self.farthest(&open, target)?);
            let beyond = self.goal.max.is_some_and(|max| out.least > max.get());
            // Boxes far smaller than what is near enough, or too many of them: their own distance is a bound as well.
            let tiny = |b: &Box3| b.diagonal() < 0.02 * target.enough;
            let last = beyond || cuts > 24 || open.len() * 64 > left;
            let (done, cut): (Vec<_>, Vec<_>) = open.into_iter().partition(|(_, b)| last || tiny(b));
            for (_, bounds) in &done {
                let far = from_field::distance_of(bounds, target);
                if far > out.most {
                    (out.most, out.at) = (far, bounds.centre());
                }
            }
            tasks = self.tasks(cut)?;
        }
        Ok(out)
    }

    /// How far some point of the field's surface is from the mesh, from below: among the small boxes that seem to be the
    /// farthest, the distance of one where the field surely changes its sign.
    fn farthest(&self, open: &[(Arc<Tape>, Box3)], target: &Target) -> Result<f64, Stopped> {
        const TRIED: usize = 64;
        let mut far: Vec<(f64, Box3)> = open
            .iter()
            .map(|(_, b)| *b)
            .filter(|b| b.diagonal() < 0.5 * target.enough)
            .map(|b| (from_field::at_least(&b, target), b))
            .filter(|(least, _)| *least > self.least)
            .collect();
        far.sort_by(|a, b| b.0.total_cmp(&a.0));
        far.truncate(TRIED);
        let points: Vec<Box3> =
            far.iter().flat_map(|(_, b)| corners_of(b)).map(|p| Box3 { min: p, max: p }).collect();
        let mut values = vec![Interval::UNKNOWN; points.len()];
        self.tape.over(&points, &mut values).map_err(failed)?;
        let changes = |values: &[Interval]| {
            values.iter().all(|v| v.is_defined())
                && values.iter().any(|v| v.hi() < 0.0)
                && values.iter().any(|v| v.lo() >= 0.0)
        };
        let sure = far.iter().zip(values.chunks_exact(8)).find(|(_, values)| changes(values));
        Ok(sure.map_or(0.0, |((least, _), _)| *least))
    }

    /// The boxes of the next round, with shorter tapes where that pays.
    fn tasks(&self, open: Vec<(Arc<Tape>, Box3)>) -> Result<Vec<Task>, Stopped> {
        if self.tape.has_leaves() {
            let tape = Arc::new(self.tape.clone());
            let boxes: Vec<Box3> = open.into_iter().map(|(_, bounds)| bounds).collect();
            return Ok(boxes
                .chunks(LEAF_CHUNK / 64)
                .map(|boxes| Task { tape: Arc::clone(&tape), boxes: boxes.to_vec() })
                .collect());
        }
        // Neighbours in the list are neighbours in space: a tape for a few of them is nearly as short as one for each.
        let groups: Vec<&[(Arc<Tape>, Box3)]> =
            open.chunk_by(|a, b| Arc::ptr_eq(&a.0, &b.0)).flat_map(|run| run.chunks(8)).collect();
        let tasks = par_map(self.job, &groups, |_, group| -> Result<Task, LeafError> {
            let boxes: Vec<Box3> = group.iter().map(|(_, bounds)| *bounds).collect();
            let about = boxes.iter().fold(Box3::EMPTY, |all, b| all.union(from_field::roomy(b)));
            let tape = &group[0].0;
            let short = if tape.len() < 16 { None } else { tape.shortened(&about)?.1 };
            Ok(Task { tape: short.map_or_else(|| Arc::clone(tape), Arc::new), boxes })
        });
        tasks.into_iter().collect::<Result<_, _>>().map_err(failed)
    }

    fn conclusion(&self, forward: &Forward, backward: &Backward, bvh: &Bvh) -> FieldDeviation {
        let nearest = |p: [f64; 3]| bvh.closest_point(p).map_or(p, |closest| closest.point);
        let one_sided = |at_least: f64, most: f64, from: [f64; 3], to: [f64; 3]| OneSided {
            at_least,
            at_most: larger(most, at_least),
            from,
            to,
        };
        let ahead = one_sided(self.least, forward.most, forward.at, forward.at);
        let back = one_sided(backward.least, backward.most, backward.at, nearest(backward.at));
        let most = larger(ahead.at_most, back.at_most);
        let known = forward.unresolved == 0 && most.is_finite();
        let evidence = if known {
            self.tape.evidence()
        } else {
            Evidence::Measured { samples: self.mesh.faces().len() as u64 }
        };
        let mut bound = Bound::with_evidence(
            larger(self.least, backward.least),
            known.then_some(most),
            evidence,
            Reference::Field,
        );
        bound.at = Some(if backward.most > forward.most { backward.at } else { forward.at });
        let reached = known && most <= larger(self.enough(), self.floor);
        FieldDeviation { bound, forward: ahead, backward: back, reached, unresolved: forward.unresolved }
    }
}

/// Boxes to be cut into 64 and looked at with one tape.
struct Task {
    tape: Arc<Tape>,
    boxes: Vec<Box3>,
}

#[derive(Default)]
struct Looked {
    most: f64,
    at: [f64; 3],
    open: Vec<Box3>,
    looked_at: usize,
}

impl Task {
    fn run(&self, target: &Target) -> Result<Looked, LeafError> {
        let parts: Vec<Box3> = self.boxes.iter().flat_map(parts_of).collect();
        let crossed = crossed(&self.tape, &parts)?;
        let left: Vec<Box3> =
            parts.iter().zip(crossed).filter(|(_, crossed)| *crossed).map(|(part, _)| *part).collect();
        let found = from_field::look(&self.tape, &left, target)?;
        let mut out = Looked { looked_at: parts.len(), ..Looked::default() };
        for (bounds, found) in left.iter().zip(found) {
            match found {
                Found::Nothing => {}
                Found::Near(far) => {
                    if far > out.most {
                        (out.most, out.at) = (far, bounds.centre());
                    }
                }
                Found::Open => out.open.push(*bounds),
            }
        }
        Ok(out)
    }
}

fn corners_of(bounds: &Box3) -> [[f64; 3]; 8] {
    std::array::from_fn(|n| {
        std::array::from_fn(|k| if n >> k & 1 == 0 { bounds.min[k] } else { bounds.max[k] })
    })
}

/// A cube around a box, with a little room.
fn cube(bounds: &Box3) -> Box3 {
    let c = bounds.centre();
    let half = (0..3).map(|k| larger(bounds.max[k] - c[k], c[k] - bounds.min[k])).fold(0.0, larger);
    let half = (half * (1.0 + 1.0 / 1024.0)).next_up();
    let half = if half > 0.0 { half } else { f64::MIN_POSITIVE };
    let cube = Box3 { min: c.map(|x| (x - half).next_down()), max: c.map(|x| (x + half).next_up()) };
    cube.union(*bounds)
}

/// The box in 4 × 4 × 4 parts that share their faces bit for bit.
fn parts_of(bounds: &Box3) -> impl Iterator<Item = Box3> + use<> {
    let bounds = *bounds;
    let at = move |k: usize, i: usize| match i {
        0 => bounds.min[k],
        4 => bounds.max[k],
        _ => {
            let share = i as f64 / 4.0;
            (1.0 - share) * bounds.min[k] + share * bounds.max[k]
        }
    };
    (0..64_usize).map(move |n| {
        let index = [n % 4, n / 4 % 4, n / 16];
        Box3 {
            min: std::array::from_fn(|k| at(k, index[k])),
            max: std::array::from_fn(|k| at(k, index[k] + 1)),
        }
    })
}
