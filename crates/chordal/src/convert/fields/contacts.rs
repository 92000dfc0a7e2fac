//! Contacts: places where two primitives of a solid touch without crossing, which no displaced copy of a mesh goes around.
use super::field_sampler::FieldSampler;
use crate::budget::{Job, OpenPlace, SurfaceContact};
use crate::implicit::{Csg, Dual, Tape};
use crate::math::{difference, dot, length};

/// The primitives of a place that are looked at in pairs: those nearest to its middle. Chosen: at a corner meet three, and
/// two corners that touch are six.
const NEAREST: usize = 8;
/// Steps from one primitive to the other. Chosen: where they cross each one halves what is left, or more.
const STEPS: usize = 24;
/// Primitives touch where both are nearer than this fraction of the place's size to one point,
const NEAR: f64 = 1e-3;
/// and the cosine between their normals there is as far from 0 as this: 3 degrees.
const PARALLEL: f64 = 0.9986;

/// Adds to each place where two primitives touch there.
pub(super) fn find_contacts(places: &mut [OpenPlace], csg: &Csg, job: &Job) {
    let tapes: Vec<&Tape> = csg.primitives().iter().map(|primitive| primitive.tape()).collect();
    for place in places {
        place.contact = contact(place, &tapes, job);
    }
}

/// Where two primitives touch near the middle of a place: of several pairs the first, by distance.
fn contact(place: &OpenPlace, tapes: &[&Tape], job: &Job) -> Option<SurfaceContact> {
    let reach = |tape: &Tape| foot(tape, place.at, job).map(|(_, _, distance)| distance);
    let near = |(number, tape): (usize, &&Tape)| Some((reach(tape)?, number));
    let mut nearest: Vec<(f64, usize)> =
        tapes.iter().enumerate().filter_map(near).filter(|(distance, _)| *distance <= place.size).collect();
    nearest.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    nearest.truncate(NEAREST);
    let pairs = nearest
        .iter()
        .enumerate()
        .flat_map(|(k, (_, p))| nearest[k + 1..].iter().map(move |(_, q)| (tapes[*p], tapes[*q])));
    pairs.filter_map(|pair| contact_of(place, pair, job)).next()
}

/// Whether two primitives touch where steps from one to the other lead.
fn contact_of(place: &OpenPlace, (p, q): (&Tape, &Tape), job: &Job) -> Option<SurfaceContact> {
    let mut at = place.at;
    for _ in 0..STEPS {
        at = foot(p, at, job)?.0;
        at = foot(q, at, job)?.0;
    }
    let ((_, a, of_p), (_, b, of_q)) = (foot(p, at, job)?, foot(q, at, job)?);
    let most = NEAR * place.size;
    let cosine = dot(a, b);
    let is_near = of_p <= most && of_q <= most && length(difference(at, place.at)) <= place.size;
    (is_near && cosine.abs() >= PARALLEL).then_some(SurfaceContact {
        at,
        is_flush: cosine > 0.0,
        lines: None,
    })
}

/// Where a step of Newton's method leads, the normal there, and how far it is.
fn foot(tape: &Tape, at: [f64; 3], job: &Job) -> Option<([f64; 3], [f64; 3], f64)> {
    let Dual { value, gradient } = *FieldSampler { tape, job }.duals(&[at]).ok()?.first()?;
    let steep = length(gradient);
    let distance = (value / steep).abs();
    let to = std::array::from_fn(|k| at[k] - value / steep * (gradient[k] / steep));
    distance.is_finite().then(|| (to, gradient.map(|x| x / steep), distance))
}
