//! The sampled deviation, for fields without ranges: surface points found beside the triangles, and their
//! distances.
use super::{FieldDeviation, leaf_failure};
use crate::budget::{Bound, Evidence, Job, JobError, Reference};
use crate::check::deviation::OneSidedDistance;
use crate::explicit::{Bvh, Mesh, face_normal};
use crate::implicit::{Field, Tape};
use crate::math::{greater, sub_down};

/// Samples along a normal at which a change of sign is searched, to each side.
const STEPS: usize = 6;
/// Bisections of a bracket: they shrink it to a millionth of its start.
const HALVINGS: usize = 20;

/// The farthest point found on the field's surface, bounded from below: each is bracketed between two signs,
/// and its distance to the mesh is certified.
pub(super) fn measured(
    mesh: &Mesh,
    field: &Field,
    tape: &Tape,
    job: &Job,
) -> Result<FieldDeviation, JobError> {
    let bvh = Bvh::build(mesh, job)?;
    let mut brackets = first_brackets(mesh, tape)?;
    for _ in 0..HALVINGS {
        if job.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        let middles: Vec<[f64; 3]> = brackets.iter().map(|[a, b]| middle(*a, *b)).collect();
        let mut values = vec![0.0; middles.len()];
        tape.at(&middles, &mut values).map_err(leaf_failure)?;
        for ((bracket, middle), value) in brackets.iter_mut().zip(&middles).zip(&values) {
            let inside = *value < 0.0;
            bracket[usize::from(!inside)] = *middle;
        }
    }
    let mut worst = OneSidedDistance {
        at_least: 0.0,
        at_most: f64::INFINITY,
        from: field.bounds().centre(),
        to: [0.0; 3],
    };
    for [a, b] in &brackets {
        let p = middle(*a, *b);
        let width = crate::math::length(crate::math::difference(*a, *b));
        let Some(far) = bvh.closest_distance_down(p) else { continue };
        let far = sub_down(far, width.next_up());
        if far > worst.at_least {
            let to = bvh.closest_point(p).map_or(p, |closest| closest.point);
            worst = OneSidedDistance { at_least: far, from: p, to, ..worst };
        }
    }
    let samples = brackets.len() as u64;
    let least = greater(worst.at_least, 0.0);
    let mut bound = Bound::with_evidence(least, None, Evidence::Measured { samples }, Reference::Field);
    bound.at = Some(worst.from);
    let forward = OneSidedDistance { at_least: 0.0, ..worst };
    Ok(FieldDeviation {
        bound,
        forward,
        backward: worst,
        reached: false,
        unresolved: mesh.faces().len() as u64 - samples,
    })
}

fn middle(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| 0.5 * a[k] + 0.5 * b[k])
}

/// For each face where there is one: a point inside and a point outside, on the normal through its centroid.
fn first_brackets(mesh: &Mesh, tape: &Tape) -> Result<Vec<[[f64; 3]; 2]>, JobError> {
    let n = 2 * STEPS + 1;
    let mut points = Vec::with_capacity(mesh.faces().len() * n);
    for face in 0..mesh.faces().len() {
        let corners = mesh.corners(face);
        let c: [f64; 3] = std::array::from_fn(|k| (corners[0][k] + corners[1][k] + corners[2][k]) / 3.0);
        let normal = face_normal(corners).unwrap_or([0.0, 0.0, 1.0]);
        let size = crate::math::length(crate::math::difference(corners[0], corners[1]));
        for step in 0..n {
            // Each step is twice the previous one, from 1/32 of an edge to one whole edge.
            let i = step as i32 - STEPS as i32;
            let far =
                if i == 0 { 0.0 } else { libm::ldexp(size, i.abs() - STEPS as i32) * f64::from(i.signum()) };
            points.push(std::array::from_fn(|k| c[k] + far * normal[k]));
        }
    }
    let mut values = vec![0.0; points.len()];
    tape.at(&points, &mut values).map_err(leaf_failure)?;
    let mut brackets = Vec::new();
    for (points, values) in points.chunks_exact(n).zip(values.chunks_exact(n)) {
        // The sign change nearest to the centroid.
        let inside = |k: usize| values[k] < 0.0;
        let change =
            (0..n - 1).filter(|k| inside(*k) != inside(k + 1)).min_by_key(|k| (2 * k + 1).abs_diff(n - 1));
        if let Some(k) = change {
            brackets.push(if inside(k) { [points[k], points[k + 1]] } else { [points[k + 1], points[k]] });
        }
    }
    Ok(brackets)
}
