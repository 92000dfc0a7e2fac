//! `FieldSampler`: evaluates a field at many points at once.
use crate::budget::{Job, par_map};
use crate::implicit::{Dual, LeafError, Tape};

/// Points in one call of a field without leaves.
const CHUNK: usize = 2048;

/// The tape of a field, and the job that evaluates it.
pub(in crate::convert) struct FieldSampler<'a> {
    pub tape: &'a Tape,
    pub job: &'a Job,
}

impl FieldSampler<'_> {
    /// Values and gradients, in chunks that depend on the number of points alone.
    pub fn duals(&self, points: &[[f64; 3]]) -> Result<Vec<Dual<f64>>, LeafError> {
        let none = Dual { value: 0.0, gradient: [0.0; 3] };
        let chunk = if self.tape.has_leaves() { points.len().max(1) } else { CHUNK };
        let parts: Vec<&[[f64; 3]]> = points.chunks(chunk).collect();
        let slopes = par_map(self.job, &parts, |_, part| {
            let mut out = vec![none; part.len()];
            self.tape.gradient_at(part, &mut out).map(|()| out)
        });
        Ok(slopes.into_iter().collect::<Result<Vec<_>, _>>()?.concat())
    }
}
