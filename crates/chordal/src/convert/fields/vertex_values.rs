//! Values of primitives at vertices, each asked for once.

/// No segment.
const NONE: u32 = u32::MAX;

/// Some primitives' values at one vertex.
#[derive(Clone, Copy, Debug)]
struct Segment {
    start: u32,
    len: u32,
    next: u32,
}

/// Values by vertex and primitive; only those that were asked for take space.
#[derive(Debug, Default)]
pub(super) struct VertexValues {
    /// By vertex: its newest segment.
    first: Vec<u32>,
    segments: Vec<Segment>,
    /// Ascending in each segment.
    primitives: Vec<u32>,
    values: Vec<f64>,
}

impl VertexValues {
    pub fn push_vertex(&mut self) {
        self.first.push(NONE);
    }

    /// Where the value is among all.
    pub fn index(&self, vertex: u32, primitive: u32) -> Option<usize> {
        let mut segment = self.first[vertex as usize];
        while segment != NONE {
            let Segment { start, len, next } = self.segments[segment as usize];
            let part = start as usize..(start + len) as usize;
            let found = match &self.primitives[part.clone()] {
                [one] => (*one == primitive).then_some(0),
                several => several.binary_search(&primitive).ok(),
            };
            if let Some(k) = found {
                return Some(part.start + k);
            }
            segment = next;
        }
        None
    }

    pub fn get(&self, vertex: u32, primitive: u32) -> Option<f64> {
        self.index(vertex, primitive).map(|k| self.values[k])
    }

    /// All values, each with its primitive.
    pub fn all(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.primitives.iter().copied().zip(self.values.iter().copied())
    }

    /// Adds values that are not there yet; questions ascend by vertex and primitive.
    pub fn extend(&mut self, questions: &[(u32, u32)], values: &[f64]) {
        for same in questions.chunk_by(|a, b| a.0 == b.0) {
            let start = self.primitives.len() as u32;
            self.primitives.extend(same.iter().map(|(_, primitive)| *primitive));
            let first = &mut self.first[same[0].0 as usize];
            self.segments.push(Segment { start, len: same.len() as u32, next: *first });
            *first = self.segments.len() as u32 - 1;
        }
        self.values.extend_from_slice(values);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_found_where_they_were_put() {
        let mut table = VertexValues::default();
        (0..3).for_each(|_| table.push_vertex());
        table.extend(&[(0, 4), (2, 1), (2, 7)], &[0.5, 1.5, 2.5]);
        table.extend(&[(0, 2), (0, 9)], &[3.5, 4.5]);
        assert_eq!(
            [(0, 4), (2, 1), (2, 7), (0, 2), (0, 9)].map(|(v, p)| table.get(v, p)),
            [0.5, 1.5, 2.5, 3.5, 4.5].map(Some)
        );
        assert_eq!([(1, 4), (2, 2), (0, 3)].map(|(v, p)| table.get(v, p)), [None; 3]);
    }
}
