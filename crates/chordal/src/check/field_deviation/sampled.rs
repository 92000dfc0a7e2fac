//! The sampled deviation, for fields without ranges: surface points found near the triangles, and their
//! distances.
use super::{FieldDeviation, leaf_failure};
use crate::budget::{Bound, Evidence, Job, JobError, Reference, par_map};
use crate::check::deviation::OneSidedDistance;
use crate::explicit::{Bvh, Mesh, face_normal};
use crate::implicit::{Field, Tape};
use crate::math::{greater, sub_down};

/// Samples on each side along a normal, between which a change of sign is searched.
const STEPS: usize = 6;
/// Bisections of a bracket: they shrink it to less than a hundred-thousandth of an edge.
const HALVINGS: usize = 16;
/// Faces that are sampled at once: about 25 MB.
const FACES_AT_ONCE: usize = 1 << 15;
/// The most faces that are sampled if the job is about to end, for a field of at most [`TERMS_AT_THE_END`]
/// terms: they take about a second.
const FACES_AT_THE_END: usize = 1 << 14;
const TERMS_AT_THE_END: usize = 64;
/// Samples spread over each face, in addition to its centroid and the midpoints of its edges.
const SCATTERED: u64 = 3;
/// The steps of the two coordinates of a sequence that fills a square evenly: 1/g and 1/g², g³ = g + 1 (M.
/// Roberts, *The unreasonable effectiveness of quasirandom sequences*, 2018).
const EVENLY: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

/// A point inside and a point outside, on the normal through a point of a face.
struct SurfaceBracket {
    face: u32,
    ends: [[f64; 3]; 2],
}

/// A measured deviation, and the faces near which it is large.
pub(crate) struct MeasuredDeviation {
    pub whole: FieldDeviation,
    /// The faces near which a point of the surface is farther than the given length.
    pub far: Vec<u32>,
}

/// The farthest point found on the field's surface, bounded from below: each point is bracketed between two
/// signs, and its distance to the mesh is certified. Some of the samples change from round to round, so that
/// a mesh is never judged only by the samples for which it was built.
pub(super) fn measured(
    mesh: &Mesh,
    (field, tape): (&Field, &Tape),
    (length, round): (f64, u64),
    job: &Job,
) -> Result<MeasuredDeviation, JobError> {
    let bvh = Bvh::build(mesh, job)?;
    let faces = sampled_faces(mesh, tape, round, job);
    let mut brackets = first_brackets(mesh, &faces, tape, round)?;
    for _ in 0..HALVINGS {
        if job.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        let middles: Vec<[f64; 3]> = brackets.iter().map(|bracket| middle(bracket.ends)).collect();
        let mut values = vec![0.0; middles.len()];
        tape.at_many(&middles, &mut values).map_err(leaf_failure)?;
        for ((bracket, middle), value) in brackets.iter_mut().zip(&middles).zip(&values) {
            // The first end is inside, the second outside.
            let inside = *value < 0.0;
            bracket.ends[usize::from(!inside)] = *middle;
        }
    }
    drop_cracks(&mut brackets, tape)?;
    let mut worst = OneSidedDistance {
        at_least: 0.0,
        at_most: f64::INFINITY,
        from: field.bounds().centre(),
        to: [0.0; 3],
    };
    let distances = par_map(job, &brackets, |_, bracket| bvh.closest_distance_down(middle(bracket.ends)));
    let mut far = Vec::new();
    for (SurfaceBracket { face, ends }, distance) in brackets.iter().zip(distances) {
        let Some(distance) = distance else { continue };
        // The surface is somewhere in the bracket, so its whole width is taken off.
        let width = crate::math::length(crate::math::difference(ends[0], ends[1]));
        let distance = sub_down(distance, width.next_up());
        if distance > length {
            far.push(*face);
        }
        if distance > worst.at_least {
            let from = middle(*ends);
            let to = bvh.closest_point(from).map_or(from, |closest| closest.point);
            worst = OneSidedDistance { at_least: distance, from, to, ..worst };
        }
    }
    far.sort_unstable();
    far.dedup();
    let mut bracketed: Vec<u32> = brackets.iter().map(|bracket| bracket.face).collect();
    // Brackets are in the order of the faces.
    bracketed.dedup();
    let samples = brackets.len() as u64;
    let least = greater(worst.at_least, 0.0);
    let mut bound = Bound::with_evidence(least, None, Evidence::Measured { samples }, Reference::Field);
    bound.at = Some(worst.from);
    let whole = FieldDeviation {
        bound,
        forward: OneSidedDistance { at_least: 0.0, ..worst },
        backward: worst,
        reached: false,
        unresolved: (faces.len() - bracketed.len()) as u64,
    };
    Ok(MeasuredDeviation { whole, far })
}

/// Drops brackets whose outer end is in a crack: where two solids share a face, the value is 0, or nearly so
/// by rounding, and a point a little farther on is inside again. There is no surface.
fn drop_cracks(brackets: &mut Vec<SurfaceBracket>, tape: &Tape) -> Result<(), JobError> {
    let beyond = |SurfaceBracket { ends: [inside, outside], .. }: &SurfaceBracket| {
        std::array::from_fn(|k| outside[k] + (outside[k] - inside[k]))
    };
    let points: Vec<[f64; 3]> = brackets.iter().map(beyond).collect();
    let mut values = vec![0.0; points.len()];
    tape.at_many(&points, &mut values).map_err(leaf_failure)?;
    let mut is_inside = values.into_iter().map(|value| value < 0.0);
    brackets.retain(|_| !is_inside.next().expect("a value for each"));
    Ok(())
}

fn middle([a, b]: [[f64; 3]; 2]) -> [f64; 3] {
    std::array::from_fn(|k| 0.5 * a[k] + 0.5 * b[k])
}

/// The faces to be sampled: all of them, or evenly selected ones if there are many and the job is about to
/// end.
fn sampled_faces(mesh: &Mesh, tape: &Tape, round: u64, job: &Job) -> Vec<u32> {
    let n = mesh.faces().len();
    let most = FACES_AT_THE_END / tape.len().div_ceil(TERMS_AT_THE_END);
    let step = if job.is_finishing() { n.div_ceil(most.max(1)).max(1) } else { 1 };
    (round as usize % step..n).step_by(step).map(|face| face as u32).collect()
}

/// Brackets on the normals through the centroids of faces, the midpoints of their edges and points spread
/// over them, in the order of the faces, if there are any. An edge is sampled from one of its two faces.
fn first_brackets(
    mesh: &Mesh,
    faces: &[u32],
    tape: &Tape,
    round: u64,
) -> Result<Vec<SurfaceBracket>, JobError> {
    let parts = faces.chunks(FACES_AT_ONCE).map(|part| brackets_of(mesh, part, tape, round));
    Ok(parts.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

/// A point of a triangle; over all `number`s the points are evenly spread.
fn scattered(corners: &[[f64; 3]; 3], number: u64) -> [f64; 3] {
    let [u, v] = EVENLY.map(|step| (step * number as f64).fract());
    let root = u.sqrt();
    let shares = [1.0 - root, root * (1.0 - v), root * v];
    std::array::from_fn(|k| (0..3).map(|i| shares[i] * corners[i][k]).sum())
}

/// The distance of a sample along the normal from the point of the face, on both sides: each is twice the
/// previous one, from 1/32 of an edge to one edge.
fn place_on_normal(step: i32, size: f64) -> f64 {
    if step == 0 { 0.0 } else { libm::ldexp(size, step.abs() - STEPS as i32) * f64::from(step.signum()) }
}

/// A point of a face from which a bracket is searched along the normal.
struct NormalSearch {
    face: u32,
    from: [f64; 3],
    normal: [f64; 3],
    size: f64,
    /// The values at the outermost samples so far, below and above.
    below: f64,
    above: f64,
}

impl NormalSearch {
    fn at(&self, step: i32) -> [f64; 3] {
        let far = place_on_normal(step, self.size);
        std::array::from_fn(|k| self.from[k] + far * self.normal[k])
    }

    /// The bracket between two samples if their values differ in sign.
    fn between(&self, (a, value): (i32, f64), (b, other): (i32, f64)) -> Option<SurfaceBracket> {
        let (is_inside, is_other_inside) = (value < 0.0, other < 0.0);
        let ends = if is_inside { [self.at(a), self.at(b)] } else { [self.at(b), self.at(a)] };
        (is_inside != is_other_inside).then_some(SurfaceBracket { face: self.face, ends })
    }
}

/// The changes of sign nearest to the faces; the one below is taken if both sides have one.
fn brackets_of(mesh: &Mesh, part: &[u32], tape: &Tape, round: u64) -> Result<Vec<SurfaceBracket>, JobError> {
    let mut open = Vec::new();
    for face in part {
        let (numbers, corners) = (mesh.faces()[*face as usize], mesh.corners(*face as usize));
        let normal = face_normal(corners).unwrap_or([0.0, 0.0, 1.0]);
        let size = crate::math::length(crate::math::difference(corners[0], corners[1]));
        let centroid = std::array::from_fn(|k| (corners[0][k] + corners[1][k] + corners[2][k]) / 3.0);
        // Two faces run along their edge in opposite directions, so it is upwards in one of them
        // alone.
        let own_edges = (0..3).filter(|i| numbers[*i] < numbers[(i + 1) % 3]);
        let middles = own_edges.map(|i| middle([corners[i], corners[(i + 1) % 3]]));
        // Every face and every round has its own stretch of the sequence.
        let number = |k: u64| SCATTERED * (u64::from(*face) + round * mesh.faces().len() as u64) + k + 1;
        let all_over = (0..SCATTERED).map(|k| scattered(&corners, number(k)));
        for from in std::iter::once(centroid).chain(middles).chain(all_over) {
            let face = *face;
            open.push(NormalSearch { face, from, normal, size, below: 0.0, above: 0.0 });
        }
    }
    let values_at = |open: &[NormalSearch], steps: &[i32]| -> Result<Vec<f64>, JobError> {
        let points: Vec<[f64; 3]> =
            open.iter().flat_map(|search| steps.iter().map(|step| search.at(*step))).collect();
        let mut values = vec![0.0; points.len()];
        tape.at_many(&points, &mut values).map_err(leaf_failure)?;
        Ok(values)
    };
    let values = values_at(&open, &[0])?;
    for (search, value) in open.iter_mut().zip(values) {
        (search.below, search.above) = (value, value);
    }
    let mut brackets = Vec::new();
    for step in 1..=STEPS as i32 {
        let values = values_at(&open, &[-step, step])?;
        let mut unbracketed = Vec::new();
        for (search, values) in open.into_iter().zip(values.chunks_exact(2)) {
            let below = search.between((-step, values[0]), (1 - step, search.below));
            // Only the new step on each side is looked at: the ones nearer have the sign of the
            // start.
            match below.or_else(|| search.between((step - 1, search.above), (step, values[1]))) {
                Some(bracket) => brackets.push(bracket),
                None => unbracketed.push(NormalSearch { below: values[0], above: values[1], ..search }),
            }
        }
        open = unbracketed;
    }
    brackets.sort_by_key(|bracket| bracket.face);
    Ok(brackets)
}
