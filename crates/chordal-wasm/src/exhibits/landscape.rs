//! Hills as bicubic patches: a uniform B-spline of heights.
use chordal::Patch;

/// A rectangle of hills.
pub(super) struct Landscape {
    /// The first corner in the plane.
    pub from: [f64; 2],
    /// Patches along both axes.
    pub n: [usize; 2],
    /// The side of a patch.
    pub side: f64,
}

impl Landscape {
    /// The patches, row by row, with heights near those of a function. Neighbours have the same numbers along their
    /// common side, so that it is one curve.
    pub fn patches(&self, height: &dyn Fn([f64; 2]) -> f64) -> Vec<Patch> {
        let [nx, ny] = self.n;
        let place = |i: f64, j: f64| [self.from[0] + self.side * i, self.from[1] + self.side * j];
        // The coefficients, with one more around the rectangle.
        let coefficient = |i: usize, j: usize| height(place(i as f64 - 1.0, j as f64 - 1.0));
        let table: Vec<Vec<f64>> =
            (0..ny + 3).map(|j| (0..nx + 3).map(|i| coefficient(i, j)).collect()).collect();
        // Along rows, then along columns: the Bézier points of a uniform cubic B-spline.
        let rows: Vec<Vec<f64>> = table.iter().map(|row| bezier_points(row)).collect();
        let columns: Vec<Vec<f64>> =
            (0..=3 * nx).map(|i| bezier_points(&rows.iter().map(|row| row[i]).collect::<Vec<_>>())).collect();
        let point = |i: usize, j: usize| {
            let [x, y] = place(i as f64 / 3.0, j as f64 / 3.0);
            [x, y, columns[i][j]]
        };
        let patch = |i: usize, j: usize| Patch {
            control: std::array::from_fn(|v| std::array::from_fn(|u| point(3 * i + u, 3 * j + v))),
        };
        (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j))).map(|(i, j)| patch(i, j)).collect()
    }
}

/// The Bézier points of the pieces between the second coefficient and the last but one.
fn bezier_points(row: &[f64]) -> Vec<f64> {
    let knot = |k: usize| (row[k - 1] + 4.0 * row[k] + row[k + 1]) / 6.0;
    let mut points = vec![knot(1)];
    for k in 1..row.len() - 2 {
        points.push((2.0 * row[k] + row[k + 1]) / 3.0);
        points.push((row[k] + 2.0 * row[k + 1]) / 3.0);
        points.push(knot(k + 1));
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal::check::validity;
    use chordal::convert::patches_to_mesh;
    use chordal::explicit::Topology;
    use chordal::{Budget, Job, Tolerance};

    #[test]
    fn a_plane_stays_a_plane_and_hills_have_no_crack() {
        let land = Landscape { from: [-2.0, -1.0], n: [4, 3], side: 1.0 };
        for patch in land.patches(&|[x, y]| 2.0 * x - y) {
            let [x, y, z] = patch.at(0.3, 0.7);
            assert!((z - (2.0 * x - y)).abs() < 1e-12); // rounding: a few ulps of 6
        }
        let hills = land.patches(&|[x, y]| 0.4 * x * y);
        let budget = Budget::length(Tolerance::new(0.01).unwrap());
        let mesh = patches_to_mesh(&hills, &budget, &Job::default()).unwrap().shape;
        assert_eq!(validity(&mesh, Topology::Indices).boundary_loops, 1);
    }
}
