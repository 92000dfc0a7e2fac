//! `BezNet`: the control points of a Bézier patch in homogeneous coordinates, and the surface that they
//! define.
use chordal::explicit::nurbs::{InvalidNurbs, KnotVector, NurbsSurface};

/// The control points `x y z w` of a patch, row by row, u along a row.
#[derive(Clone, Debug)]
pub(super) struct BezNet {
    /// The degrees along u and along v.
    pub degrees: [usize; 2],
    pub points: Vec<[f64; 4]>,
    /// Whether the patch was halved in both directions.
    is_halved: bool,
}

impl BezNet {
    pub(super) fn new(degrees: [usize; 2], points: Vec<[f64; 4]>) -> Self {
        Self { degrees, points, is_halved: false }
    }

    /// The surface. If all weights are below 0, all signs are changed. If only some are not above 0, as in
    /// half a circle of degree 2, the patch is halved once in both directions, after which they may be.
    ///
    /// # Errors
    /// [`InvalidNurbs::Weight`] if some weights are still not above 0; a quotient that is not finite.
    pub(super) fn surface(mut self) -> Result<NurbsSurface, InvalidNurbs> {
        if self.points[0][3] < 0.0 {
            self.points.iter_mut().for_each(|point| *point = point.map(|x| -x));
        }
        if self.points.iter().any(|point| point[3] <= 0.0) {
            self = self.halved();
        }
        let weights: Vec<f64> = self.points.iter().map(|point| point[3]).collect();
        if let Some(index) = weights.iter().position(|w| *w <= 0.0) {
            return Err(InvalidNurbs::Weight(index));
        }
        let control = self.points.iter().map(|[x, y, z, w]| [x / w, y / w, z / w]).collect();
        let [u, v] = self.degrees.map(|degree| {
            let mut knots = vec![0.0; degree + 1];
            if self.is_halved {
                knots.resize(2 * degree + 1, 0.5); // in the middle, as often as the degree
            }
            knots.resize(knots.len() + degree + 1, 1.0);
            KnotVector::new(degree, knots)
        });
        NurbsSurface::new([u?, v?], control, weights)
    }

    /// The same patch as two pieces along u and along v.
    fn halved(self) -> Self {
        let [p, q] = self.degrees;
        let rows: Vec<Vec<[f64; 4]>> = self.points.chunks(p + 1).map(halved_row).collect();
        let columns: Vec<Vec<[f64; 4]>> = (0..=2 * p)
            .map(|column| halved_row(&rows.iter().map(|row| row[column]).collect::<Vec<_>>()))
            .collect();
        let points = (0..=2 * q).flat_map(|row| columns.iter().map(move |column| column[row])).collect();
        Self { degrees: self.degrees, points, is_halved: true }
    }
}

/// The control points of both halves of a curve, by de Casteljau's algorithm; they share the middle one.
fn halved_row(row: &[[f64; 4]]) -> Vec<[f64; 4]> {
    let mut row = row.to_vec();
    let (mut first, mut second) = (vec![row[0]], vec![row[row.len() - 1]]);
    while row.len() > 1 {
        // Halving before the sum cannot overflow.
        let middle = |pair: &[[f64; 4]]| std::array::from_fn(|k| 0.5 * pair[0][k] + 0.5 * pair[1][k]);
        row = row.windows(2).map(middle).collect();
        first.push(row[0]);
        second.push(row[row.len() - 1]);
    }
    // The middle point is in both halves.
    second.pop();
    first.extend(second.into_iter().rev());
    first
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_circle_of_degree_2_gets_weights_above_0() {
        // A half cylinder: the middle control point of the half circle is at infinity.
        let row = |z: f64| [[1.0, 0.0, z, 1.0], [0.0, 1.0, 0.0, 0.0], [-1.0, 0.0, z, 1.0]];
        for sign in [1.0, -1.0] {
            let points = [row(0.0), row(2.0)].concat().into_iter().map(|p| p.map(|x| sign * x)).collect();
            let surface = BezNet::new([2, 1], points).surface().unwrap();
            assert_eq!(surface.knots()[0].knots(), [0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0]);
            assert_eq!(surface.at(0.5, 1.0), [0.0, 1.0, 2.0]);
            for i in 0..=10 {
                let [x, y, z] = surface.at(f64::from(i) / 10.0, 0.25);
                assert!((x.hypot(y) - 1.0).abs() < 1e-15 && y >= 0.0 && (z - 0.5).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn weights_that_stay_below_0_are_refused() {
        let points =
            vec![[0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, -3.0], [0.0, 1.0, 0.0, 1.0], [1.0, 1.0, 0.0, 1.0]];
        assert!(matches!(BezNet::new([1, 1], points).surface(), Err(InvalidNurbs::Weight(_))));
    }
}
