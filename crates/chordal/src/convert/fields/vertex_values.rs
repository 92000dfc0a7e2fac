//! `VertexValues`: values of primitives at vertices, each evaluated once.

use crate::implicit::Dual;

/// No segment.
const NONE: u32 = u32::MAX;

/// Some primitives' values at one vertex.
#[derive(Clone, Copy, Debug)]
struct ValueRun {
    start: u32,
    len: u32,
    next: u32,
}

/// Values by vertex and primitive; only evaluated ones take space.
#[derive(Debug, Default)]
pub(super) struct VertexValues {
    /// By vertex: its newest segment.
    first: Vec<u32>,
    segments: Vec<ValueRun>,
    /// Ascending in each segment.
    primitives: Vec<u32>,
    values: Vec<f64>,
    /// Parallel to `values`: the largest rounding error of each.
    noise: Vec<f64>,
    /// Parallel to `values`, if gradients are evaluated at all.
    gradients: Vec<[f64; 3]>,
}

impl VertexValues {
    pub fn push_vertex(&mut self) {
        self.first.push(NONE);
    }

    /// The index of a value in the order of [`VertexValues::all`].
    pub fn index(&self, vertex: u32, primitive: u32) -> Option<usize> {
        let mut segment = self.first[vertex as usize];
        while segment != NONE {
            let ValueRun { start, len, next } = self.segments[segment as usize];
            let part = start as usize..(start + len) as usize;
            let position = match &self.primitives[part.clone()] {
                [only] => (*only == primitive).then_some(0),
                several => several.binary_search(&primitive).ok(),
            };
            if let Some(k) = position {
                return Some(part.start + k);
            }
            segment = next;
        }
        None
    }

    pub fn get(&self, vertex: u32, primitive: u32) -> Option<f64> {
        self.index(vertex, primitive).map(|k| self.values[k])
    }

    /// The value, and its largest rounding error.
    pub fn with_noise(&self, vertex: u32, primitive: u32) -> Option<[f64; 2]> {
        self.index(vertex, primitive).map(|k| [self.values[k], self.noise[k]])
    }

    /// The gradient of a primitive at a vertex, if gradients are evaluated.
    pub fn gradient(&self, vertex: u32, primitive: u32) -> Option<[f64; 3]> {
        self.index(vertex, primitive).and_then(|k| self.gradients.get(k).copied())
    }

    /// All values, each with its primitive.
    pub fn all(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.primitives.iter().copied().zip(self.values.iter().copied())
    }

    /// Like [`VertexValues::extend`], with gradients; a table has gradients for all of its values or for none.
    pub fn extend_slopes(&mut self, keys: &[(u32, u32)], slopes: &[Dual<f64>], noise: &[f64]) {
        let values: Vec<f64> = slopes.iter().map(|slope| slope.value).collect();
        self.extend(keys, &values, noise);
        self.gradients.extend(slopes.iter().map(|slope| slope.gradient));
    }

    /// Adds new values; the keys, a vertex and a primitive, ascend.
    pub fn extend(&mut self, keys: &[(u32, u32)], values: &[f64], noise: &[f64]) {
        for same in keys.chunk_by(|a, b| a.0 == b.0) {
            let start = self.primitives.len() as u32;
            self.primitives.extend(same.iter().map(|(_, primitive)| *primitive));
            let first = &mut self.first[same[0].0 as usize];
            self.segments.push(ValueRun { start, len: same.len() as u32, next: *first });
            *first = self.segments.len() as u32 - 1;
        }
        self.values.extend_from_slice(values);
        self.noise.extend_from_slice(noise);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_found_where_they_were_put() {
        let mut table = VertexValues::default();
        (0..3).for_each(|_| table.push_vertex());
        table.extend(&[(0, 4), (2, 1), (2, 7)], &[0.5, 1.5, 2.5], &[0.0; 3]);
        table.extend(&[(0, 2), (0, 9)], &[3.5, 4.5], &[0.25; 2]);
        assert_eq!(
            [(0, 4), (2, 1), (2, 7), (0, 2), (0, 9)].map(|(v, p)| table.get(v, p)),
            [0.5, 1.5, 2.5, 3.5, 4.5].map(Some)
        );
        assert_eq!(table.with_noise(0, 9), Some([4.5, 0.25]));
        assert_eq!([(1, 4), (2, 2), (0, 3)].map(|(v, p)| table.get(v, p)), [None; 3]);
    }
}
