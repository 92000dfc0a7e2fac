//! Vertex normals along the gradient of the samples.
use super::marching_cubes::MarchingPlan;
use super::rule::{Inside, Polygonize};
use super::source::SampleSource;
use crate::budget::Job;
use crate::implicit::Affine3;
use crate::math::{cross, unit};

/// Outward unit normals. Central differences of the samples (one-sided at the border) are interpolated along
/// the vertex's edge and mapped to space. Where they vanish, the normal is along the edge.
pub(crate) fn gradient_normals<S: SampleSource>(
    source: &S,
    affine: &Affine3,
    rule: &Polygonize,
    plan: &MarchingPlan,
    job: &Job,
) -> Vec<[f64; 3]> {
    let size = source.size();
    let [a, b, c] = affine.steps();
    // Rows of the inverse transpose, up to a factor whose sign is that of the determinant.
    let turn = f64::from(affine.orientation()) * if rule.inside == Inside::High { -1.0 } else { 1.0 };
    let columns = [cross(b, c), cross(c, a), cross(a, b)];
    let to_space = |g: [f64; 3]| -> [f64; 3] {
        std::array::from_fn(|k| turn * ((columns[0][k] * g[0] + columns[1][k] * g[1]) + columns[2][k] * g[2]))
    };
    let gradient = |at: [usize; 3]| -> [f64; 3] {
        std::array::from_fn(|k| {
            let (mut low, mut high) = (at, at);
            low[k] = at[k].saturating_sub(1);
            high[k] = if at[k] + 1 < size[k] { at[k] + 1 } else { at[k] };
            let rise = rule.finite_sample(source.at(high)) - rule.finite_sample(source.at(low));
            rise / (high[k] - low[k]) as f64
        })
    };
    plan.for_each_vertex(job, |kind, at| {
        let here = gradient(at);
        let mut along = [0.0; 3];
        let mean = if kind < 3 {
            let mut next = at;
            next[kind] += 1;
            let part = rule.crossing(source.at(at), source.at(next));
            let there = gradient(next);
            along[kind] = rule.finite_sample(source.at(next)) - rule.finite_sample(source.at(at));
            std::array::from_fn(|k| here[k] + part * (there[k] - here[k]))
        } else {
            here
        };
        unit(to_space(mean)).or_else(|| unit(to_space(along))).unwrap_or([0.0, 0.0, 1.0])
    })
}
