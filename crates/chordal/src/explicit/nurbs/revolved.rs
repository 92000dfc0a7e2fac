//! Arcs, and surfaces of revolution, which are exact with weights.
use super::knots::{InvalidNurbs, KnotVector};
use super::{NurbsCurve, NurbsSurface};

/// The knots of a full turn in four quarters.
fn quarters() -> Result<KnotVector, InvalidNurbs> {
    KnotVector::new(2, vec![0.0, 0.0, 0.0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1.0, 1.0, 1.0])
}

/// For each quarter and the middle between quarters, in units of two axes: points and corners of a square
/// around the circle.
const AROUND: [[f64; 2]; 9] = [
    [1.0, 0.0],
    [1.0, 1.0],
    [0.0, 1.0],
    [-1.0, 1.0],
    [-1.0, 0.0],
    [-1.0, -1.0],
    [0.0, -1.0],
    [1.0, -1.0],
    [1.0, 0.0],
];

/// The weight at a corner of that square: the cosine of half a quarter.
const CORNER: f64 = std::f64::consts::FRAC_1_SQRT_2;

fn turn_weight(k: usize) -> f64 {
    if k.is_multiple_of(2) { 1.0 } else { CORNER }
}

impl<const D: usize> NurbsCurve<D> {
    /// The ellipse around a centre with two conjugate half-axes, from the first one towards the second: a
    /// circle if these are perpendicular and equally long. Its parameter runs from 0 to 1.
    ///
    /// # Errors
    /// When a number is not finite.
    pub fn circle(centre: [f64; D], axes: [[f64; D]; 2]) -> Result<Self, InvalidNurbs> {
        let point = |[a, b]: [f64; 2]| std::array::from_fn(|k| centre[k] + a * axes[0][k] + b * axes[1][k]);
        let weights = (0..AROUND.len()).map(turn_weight).collect();
        Self::new(quarters()?, AROUND.iter().map(|at| point(*at)).collect(), weights)
    }

    /// The straight line from one point to another.
    ///
    /// # Errors
    /// When a number is not finite.
    pub fn line(from: [f64; D], to: [f64; D]) -> Result<Self, InvalidNurbs> {
        Self::new(KnotVector::clamped(1, 2)?, vec![from, to], vec![1.0; 2])
    }
}

impl NurbsSurface {
    /// The surface that a curve in the half-plane of radius and height sweeps around the z axis in a full
    /// turn. `u` runs around the axis, `v` along the curve; the front is to the right of the curve, in a view
    /// with the radius to the right and the height up, so that a profile drawn upwards encloses the axis.
    ///
    /// # Errors
    /// When a radius is negative or a number not finite.
    pub fn revolved(profile: &NurbsCurve<2>) -> Result<Self, InvalidNurbs> {
        if let Some(index) = profile.control().iter().position(|p| p[0] < 0.0) {
            return Err(InvalidNurbs::Radius(index));
        }
        let rows = profile.control().iter().zip(profile.weights());
        let control = rows
            .clone()
            .flat_map(|([r, z], _)| AROUND.iter().map(move |[x, y]| [r * x, r * y, *z]))
            .collect();
        let weights = rows.flat_map(|(_, w)| (0..AROUND.len()).map(move |k| w * turn_weight(k))).collect();
        Self::new([quarters()?, profile.knots().clone()], control, weights)
    }

    /// The torus around the z axis with these radii of its ring and its tube.
    ///
    /// # Errors
    /// When the tube is wider than the ring or a number not finite.
    pub fn torus(ring: f64, tube: f64) -> Result<Self, InvalidNurbs> {
        Self::revolved(&NurbsCurve::circle([ring, 0.0], [[tube, 0.0], [0.0, tube]])?)
    }

    /// The sphere around the origin; its poles are on the z axis.
    ///
    /// # Errors
    /// When the radius is negative or not finite.
    pub fn sphere(radius: f64) -> Result<Self, InvalidNurbs> {
        let r = radius;
        let knots = KnotVector::new(2, vec![0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0])?;
        let half = vec![[0.0, -r], [r, -r], [r, 0.0], [r, r], [0.0, r]];
        Self::revolved(&NurbsCurve::new(knots, half, (0..5).map(turn_weight).collect())?)
    }

    /// The side of a cone around the z axis from one radius and height to another; a cylinder if both radii
    /// are equal.
    ///
    /// # Errors
    /// When a radius is negative or a number not finite.
    pub fn cone(from: [f64; 2], to: [f64; 2]) -> Result<Self, InvalidNurbs> {
        Self::revolved(&NurbsCurve::new(KnotVector::clamped(1, 2)?, vec![from, to], vec![1.0; 2])?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::length;
    use chordal_testkit::Random;

    #[test]
    fn exact_surfaces_lie_on_their_equations_at_any_scale() {
        let mut random = Random::new(91);
        for scale in [1e-6, 1.0, 1e6] {
            let [torus, ball] = [
                NurbsSurface::torus(2.0 * scale, 0.5 * scale).unwrap(),
                NurbsSurface::sphere(scale).unwrap(),
            ];
            let cone = NurbsSurface::cone([scale, 0.0], [0.0, 2.0 * scale]).unwrap();
            for _ in 0..500 {
                let [u, v] = [random.unit(), random.unit()];
                let [x, y, z] = torus.at(u, v);
                let ring = (x * x + y * y).sqrt() - 2.0 * scale;
                assert!(((ring * ring + z * z).sqrt() / scale - 0.5).abs() < 4e-15);
                assert!((length(ball.at(u, v)) / scale - 1.0).abs() < 2e-15);
                let [x, y, z] = cone.at(u, v);
                assert!(((x * x + y * y).sqrt() / scale - (1.0 - 0.5 * z / scale)).abs() < 2e-15);
            }
        }
    }

    #[test]
    fn derivatives_of_a_circle_are_those_of_its_equation() {
        let circle = NurbsCurve::circle([0.0; 2], [[1.0, 0.0], [0.0, 1.0]]).unwrap();
        for k in 0..40 {
            let [p, d, dd, ddd] = circle.derivatives(f64::from(k) / 40.0 + 0.001, 3)[..] else {
                unreachable!()
            };
            let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
            // |p|² = 1, differentiated.
            assert!((dot(p, p) - 1.0).abs() < 1e-15 && dot(p, d).abs() < 1e-14);
            assert!((dot(d, d) + dot(p, dd)).abs() < 1e-12);
            assert!((3.0 * dot(d, dd) + dot(p, ddd)).abs() < 1e-10);
        }
    }
}
