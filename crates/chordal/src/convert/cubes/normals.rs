//! Vertex normals along the gradient of the samples.
use super::marching_cubes::MarchingPlan;
use super::rule::{Inside, Polygonize};
use super::source::SampleSource;
use crate::budget::Job;
use crate::implicit::Affine3;
use crate::math::{cross, unit};

/// The gradient of the samples: central differences, one-sided at the border.
pub(super) struct SampleGradient<'a> {
    source: &'a dyn SampleSource,
    rule: &'a Polygonize,
    size: [usize; 3],
    /// The columns of the inverse transpose, up to a positive factor, turned outwards.
    columns: [[f64; 3]; 3],
}

impl<'a> SampleGradient<'a> {
    pub fn new(source: &'a dyn SampleSource, affine: &Affine3, rule: &'a Polygonize) -> Self {
        let [a, b, c] = affine.steps();
        // Rows of the inverse transpose, up to a factor with the sign of the determinant.
        let turn = f64::from(affine.orientation()) * if rule.inside == Inside::High { -1.0 } else { 1.0 };
        let columns = [cross(b, c), cross(c, a), cross(a, b)].map(|column| column.map(|x| turn * x));
        Self { source, rule, size: source.size(), columns }
    }

    /// A gradient by indices in space, outwards.
    fn to_space(&self, g: [f64; 3]) -> [f64; 3] {
        let columns = &self.columns;
        std::array::from_fn(|k| (columns[0][k] * g[0] + columns[1][k] * g[1]) + columns[2][k] * g[2])
    }

    fn sample(&self, at: [usize; 3]) -> f64 {
        self.rule.finite_sample(self.source.at(at))
    }

    /// By indices, at a sample.
    fn at_sample(&self, at: [usize; 3]) -> [f64; 3] {
        std::array::from_fn(|k| {
            let (mut low, mut high) = (at, at);
            low[k] = at[k].saturating_sub(1);
            high[k] = if at[k] + 1 < self.size[k] { at[k] + 1 } else { at[k] };
            (self.sample(high) - self.sample(low)) / (high[k] - low[k]) as f64
        })
    }

    /// The outward unit normal at a point between samples, by its indices: the gradients of the samples around it are
    /// interpolated. If they vanish, the gradient of the interpolant is taken.
    pub fn normal_at(&self, index: [f64; 3]) -> [f64; 3] {
        let cell: [usize; 3] = std::array::from_fn(|k| (index[k] as usize).min(self.size[k] - 2));
        let part: [f64; 3] = std::array::from_fn(|k| index[k] - cell[k] as f64);
        let corner = |c: usize| [cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2)];
        let weight = |c: usize, k: usize| if c >> k & 1 == 1 { part[k] } else { 1.0 - part[k] };
        let (mut mean, mut slope) = ([0.0; 3], [0.0; 3]);
        for c in 0..8 {
            let value = self.sample(corner(c));
            let here = weight(c, 0) * weight(c, 1) * weight(c, 2);
            let gradient = if here == 0.0 { [0.0; 3] } else { self.at_sample(corner(c)) };
            for k in 0..3 {
                mean[k] += here * gradient[k];
                let across = weight(c, (k + 1) % 3) * weight(c, (k + 2) % 3);
                slope[k] += if c >> k & 1 == 1 { across * value } else { -across * value };
            }
        }
        let outward = unit(self.to_space(mean)).or_else(|| unit(self.to_space(slope)));
        outward.unwrap_or([0.0, 0.0, 1.0])
    }
}

/// Outward unit normals. Central differences of the samples (one-sided at the border) are interpolated along
/// the vertex's edge and mapped to space. If they vanish, the normal is along the edge.
pub(crate) fn gradient_normals<S: SampleSource>(
    source: &S,
    affine: &Affine3,
    rule: &Polygonize,
    plan: &MarchingPlan,
    job: &Job,
) -> Vec<[f64; 3]> {
    let gradient = SampleGradient::new(source, affine, rule);
    plan.for_each_vertex(job, |kind, at| {
        let here = gradient.at_sample(at);
        let mut along = [0.0; 3];
        let mean = if kind < 3 {
            let mut next = at;
            next[kind] += 1;
            let part = rule.crossing(source.at(at), source.at(next));
            let there = gradient.at_sample(next);
            along[kind] = gradient.sample(next) - gradient.sample(at);
            std::array::from_fn(|k| here[k] + part * (there[k] - here[k]))
        } else {
            here
        };
        let to_space = |g: [f64; 3]| gradient.to_space(g);
        // Where the mean vanishes, the ends of the crossed edge still differ.
        unit(to_space(mean)).or_else(|| unit(to_space(along))).unwrap_or([0.0, 0.0, 1.0])
    })
}
