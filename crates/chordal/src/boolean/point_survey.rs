//! `PointSurvey`: the winding numbers of meshes around some points, and whether the points are near their
//! triangles, by one pass over the triangles. For a thousand points that costs a tenth of building a tree.
use crate::budget::{Job, par_map};
use crate::check::{RayCrossing, crossing};
use crate::explicit::distance_to_triangle_down;
use crate::math::{add_up, greater, lesser, sub_down};

/// Points in columns along z, so that a triangle meets only those below and above it.
pub(super) struct PointSurvey<'a> {
    points: &'a [[f64; 3]],
    low: [f64; 2],
    /// Columns for a unit of x and y.
    scale: [f64; 2],
    side: usize,
    /// The points of column c are `sorted[starts[c]..starts[c + 1]]`.
    starts: Vec<u32>,
    sorted: Vec<u32>,
}

/// The relation of a mesh to one point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct PointWinding {
    /// The winding number of the mesh around the point, if the mesh is closed.
    pub number: i32,
    /// Whether some triangle is not certainly farther than the given length.
    pub is_near: bool,
}

/// Triangles in one task.
const CHUNK: usize = 1 << 14;

impl<'a> PointSurvey<'a> {
    pub fn new(points: &'a [[f64; 3]]) -> Self {
        // Columns for about one point each.
        let side = (points.len() as f64).sqrt().ceil() as usize;
        let side = side.max(1);
        let end = |k: usize, better: fn(f64, f64) -> f64, start: f64| {
            points.iter().fold(start, |best, p| better(p[k], best))
        };
        let low = [0, 1].map(|k| end(k, lesser, f64::INFINITY));
        let high = [0, 1].map(|k| end(k, greater, f64::NEG_INFINITY));
        // If all points have the same coordinate, all are in the first column.
        let scale = [0, 1].map(|k| {
            let scale = side as f64 / (high[k] - low[k]);
            if scale.is_finite() { scale } else { 0.0 }
        });
        let mut survey =
            Self { points, low, scale, side, starts: vec![0; side * side + 1], sorted: Vec::new() };
        // Sorted by counting: afterwards `starts[c]..starts[c + 1]` are the points of column c in
        // `sorted`.
        let columns: Vec<usize> =
            points.iter().map(|p| survey.column(0, p[0]) + side * survey.column(1, p[1])).collect();
        columns.iter().for_each(|column| survey.starts[column + 1] += 1);
        for column in 0..side * side {
            survey.starts[column + 1] += survey.starts[column];
        }
        let mut next = survey.starts.clone();
        survey.sorted = vec![0; points.len()];
        for (point, column) in columns.into_iter().enumerate() {
            survey.sorted[next[column] as usize] = point as u32;
            next[column] += 1;
        }
        survey
    }

    /// The column of a coordinate, which never decreases with it: so all points between two coordinates are
    /// in the columns between theirs, in spite of rounding.
    fn column(&self, k: usize, x: f64) -> usize {
        let at = (x - self.low[k]) * self.scale[k];
        if at > 0.0 { (at as usize).min(self.side - 1) } else { 0 }
    }

    /// For each point, its relation to the triangles `corners(0)`, …, `corners(n_faces − 1)`.
    pub fn windings(
        &self,
        n_faces: usize,
        corners: impl Fn(usize) -> [[f64; 3]; 3] + Sync,
        length: f64,
        job: &Job,
    ) -> Vec<PointWinding> {
        let chunks: Vec<usize> = (0..n_faces.div_ceil(CHUNK)).map(|chunk| chunk * CHUNK).collect();
        let parts = par_map(job, &chunks, |_, first| {
            let mut windings = vec![PointWinding::default(); self.points.len()];
            if !job.is_cancelled() {
                (*first..n_faces.min(first + CHUNK))
                    .for_each(|face| self.add(corners(face), length, &mut windings));
            }
            windings
        });
        // Sums of integers, so the parts may come from any number of threads.
        let mut sum = vec![PointWinding::default(); self.points.len()];
        for part in parts {
            for (total, part_winding) in sum.iter_mut().zip(part) {
                total.number += part_winding.number;
                total.is_near |= part_winding.is_near;
            }
        }
        sum
    }

    fn add(&self, corners: [[f64; 3]; 3], length: f64, windings: &mut [PointWinding]) {
        let [a, b, c] = corners;
        let ends = [0, 1, 2].map(|k| {
            let (low, high) = (lesser(a[k], b[k]), greater(a[k], b[k]));
            [sub_down(lesser(low, c[k]), length), add_up(greater(high, c[k]), length)]
        });
        let [columns, rows] = [0, 1].map(|k| ends[k].map(|x| self.column(k, x)));
        for row in rows[0]..=rows[1] {
            // Columns of a row follow each other, and so do their points.
            let line = &self.starts[row * self.side..][..self.side + 1];
            let (first, last) = (line[columns[0]] as usize, line[columns[1] + 1] as usize);
            for &point in &self.sorted[first..last] {
                let p = self.points[point as usize];
                let is_within = |k: usize| ends[k][0] <= p[k] && p[k] <= ends[k][1];
                // The ray goes up: a triangle entirely below the point is neither crossed nor, by
                // `length`, near.
                if !is_within(0) || !is_within(1) || p[2] > ends[2][1] {
                    continue;
                }
                let winding = &mut windings[point as usize];
                match crossing(p, corners) {
                    RayCrossing::None => {}
                    RayCrossing::FromBehind => winding.number += 1,
                    RayCrossing::FromFront => winding.number -= 1,
                    RayCrossing::On => winding.is_near = true,
                }
                // Just above, so that a lower bound of exactly that length does not count as farther.
                let enough = length.next_up();
                if is_within(2) && distance_to_triangle_down(p, corners, enough) <= length {
                    winding.is_near = true;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    #[test]
    fn one_pass_finds_what_all_pairs_give() {
        let mut random = Random::new(3);
        let mut number = || random.below(9) as f64 / 4.0;
        let triangles: Vec<[[f64; 3]; 3]> =
            (0..300).map(|_| [0, 1, 2].map(|_| [number(), number(), number()])).collect();
        let points: Vec<[f64; 3]> = (0..200).map(|_| [number(), number() + 0.125, number()]).collect();
        for length in [0.0, 0.01, 0.25] {
            let windings =
                PointSurvey::new(&points).windings(300, |face| triangles[face], length, &Job::default());
            for (p, winding) in points.iter().zip(windings) {
                let mut expected = PointWinding::default();
                for corners in &triangles {
                    match crossing(*p, *corners) {
                        RayCrossing::None => {}
                        RayCrossing::FromBehind => expected.number += 1,
                        RayCrossing::FromFront => expected.number -= 1,
                        RayCrossing::On => expected.is_near = true,
                    }
                    expected.is_near |= distance_to_triangle_down(*p, *corners, f64::INFINITY) <= length;
                }
                assert_eq!(winding.number, expected.number, "{p:?}");
                // The search may stop at a rougher bound only above the length, where the sharp one is as well.
                assert_eq!(winding.is_near, expected.is_near, "{p:?} {length}");
            }
        }
        assert!(PointSurvey::new(&[]).windings(300, |face| triangles[face], 0.1, &Job::default()).is_empty());
    }
}
