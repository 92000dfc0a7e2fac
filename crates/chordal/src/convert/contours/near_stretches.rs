//! The stretches of a line or a circle near another line or circle.
use super::plane_function::PlaneCurve;
use crate::math::elementary::{atan2, cos, sin};
use crate::math::{dot, greater, length, lesser};
use std::f64::consts::{PI, TAU};

impl PlaneCurve {
    /// The point at a parameter: along a line the length from the point nearest to the origin, around a circle the
    /// angle. Both grow with the negative side on the left.
    pub fn at(&self, t: f64) -> [f64; 2] {
        match self {
            Self::Line { normal: [a, b], offset } => [a * offset - b * t, b * offset + a * t],
            Self::Circle { centre, radius } => [centre[0] + radius * cos(t), centre[1] + radius * sin(t)],
            Self::Nowhere => [f64::INFINITY; 2],
        }
    }

    /// The direction in which the parameter grows.
    pub fn direction(&self, t: f64) -> [f64; 2] {
        match self {
            Self::Line { normal: [a, b], .. } => [-b, *a],
            Self::Circle { .. } => [-sin(t), cos(t)],
            Self::Nowhere => [0.0; 2],
        }
    }

    /// The length for one unit of the parameter.
    pub fn speed(&self) -> f64 {
        if let Self::Circle { radius, .. } = self { *radius } else { 1.0 }
    }

    /// The parameters of a line within a disc.
    pub fn within_disc(&self, centre: [f64; 2], radius: f64) -> Option<[f64; 2]> {
        let Self::Line { normal: [a, b], .. } = self else { return None };
        let far = self.distance(centre).abs();
        let middle = dot([-b, *a], centre);
        // As a product, since a difference of squares would lose digits.
        let half = ((radius - far) * (radius + far)).sqrt();
        (half > 0.0).then_some([middle - half, middle + half])
    }

    /// Intervals of the parameter: outside of them `other` is farther than half of `slack`. `None` if they would be the
    /// whole curve. The lengths of both are at most 2⁴⁴ times the slack, so that roundings are far below it.
    pub fn near(&self, other: &Self, slack: f64) -> Option<Vec<[f64; 2]>> {
        match (self, other) {
            (Self::Nowhere, _) | (_, Self::Nowhere) => Some(Vec::new()),
            (Self::Line { .. }, Self::Line { normal, .. }) => {
                let away = other.distance(self.at(0.0));
                let slope = dot(*normal, self.direction(0.0));
                let (middle, half) = (0.0 - away / slope, slack / slope.abs());
                if half.is_finite() && middle.is_finite() {
                    return Some(vec![[middle - half, middle + half]]);
                }
                // Parallel lines are near everywhere or nowhere.
                (away.abs() > slack).then(Vec::new)
            }
            (Self::Line { normal: [a, b], .. }, Self::Circle { centre, radius }) => {
                let far = self.distance(*centre).abs();
                let middle = dot([-b, *a], *centre);
                // The square of the distance along the line from the point that is nearest to the centre.
                let square = |reach: f64| (reach - far) * (reach + far);
                let (outer, inner) = (square(radius + slack), square(radius - slack));
                Some(if outer < 0.0 {
                    Vec::new()
                } else if inner <= 0.0 {
                    vec![[middle - outer.sqrt(), middle + outer.sqrt()]]
                } else {
                    let (near, far) = (inner.sqrt(), outer.sqrt());
                    vec![[middle - far, middle - near], [middle + near, middle + far]]
                })
            }
            (Self::Circle { centre, radius }, Self::Line { normal, .. }) => {
                // `radius · cos u` from the direction of the normal is minus the distance of the centre.
                let away = 0.0 - other.distance(*centre);
                if away.abs() > radius + slack {
                    return Some(Vec::new());
                }
                // By half the angle, whose tangent keeps its digits near 0 and π, unlike an arc cosine.
                let angle = |along: f64| half_angle_twice(radius - along, radius + along);
                let ends = [angle(away + slack), angle(away - slack)];
                around(atan2(normal[1], normal[0]), ends)
            }
            (Self::Circle { centre, radius }, Self::Circle { centre: middle, radius: reach }) => {
                let apart = [centre[0] - middle[0], centre[1] - middle[1]];
                let far = length(apart);
                let (least, most) = ((far - radius).abs(), far + radius);
                if reach + slack < least || reach - slack > most {
                    return Some(Vec::new());
                }
                // By the law of cosines for the half angle.
                let angle = |reach: f64| {
                    half_angle_twice((most - reach) * (most + reach), (reach - least) * (reach + least))
                };
                around(atan2(apart[1], apart[0]), [angle(reach + slack), angle(reach - slack)])
            }
        }
    }
}

/// The angle whose half has a sine and a cosine with these squares, up to a factor; 0 or π if a square is negative.
fn half_angle_twice(sine_sq: f64, cosine_sq: f64) -> f64 {
    let (sine_sq, cosine_sq) = (greater(sine_sq, 0.0), greater(cosine_sq, 0.0));
    2.0 * atan2(sine_sq.sqrt(), cosine_sq.sqrt())
}

/// The angles whose difference from a direction is between two limits, on both sides of it.
fn around(direction: f64, [least, most]: [f64; 2]) -> Option<Vec<[f64; 2]>> {
    let (least, most) = (greater(least, 0.0), lesser(most, PI));
    match (least <= 0.0, most >= PI) {
        (true, true) => None,
        (true, false) => Some(vec![[direction - most, direction + most]]),
        (false, true) => Some(vec![[direction + least, direction + TAU - least]]),
        (false, false) => {
            Some(vec![[direction - most, direction - least], [direction + least, direction + most]])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_that_is_near_is_in_the_intervals_and_little_else() {
        let line = |angle: f64, offset: f64| PlaneCurve::Line { normal: [cos(angle), sin(angle)], offset };
        let circle = |x: f64, y: f64, radius: f64| PlaneCurve::Circle { centre: [x, y], radius };
        let curves = [
            line(0.0, 1.0),
            line(1.1, 0.5),
            line(2.0, -0.75),
            circle(0.0, 0.0, 1.0),
            circle(0.5, 0.25, 1.5),
            circle(2.0, 0.0, 1.0),
            circle(0.1, 0.0, 0.3),
        ];
        let slack = 0.01;
        for (i, curve) in curves.iter().enumerate() {
            for (j, other) in curves.iter().enumerate().filter(|(j, _)| *j != i) {
                let stretches = curve.near(other, slack).unwrap();
                for k in 0..4000 {
                    let t = TAU * f64::from(k) / 4000.0;
                    let holds = |[from, to]: &[f64; 2]| {
                        [-TAU, 0.0, TAU].iter().any(|turn| {
                            let turn = if matches!(curve, PlaneCurve::Circle { .. }) { *turn } else { 0.0 };
                            *from <= t + turn && t + turn <= *to
                        })
                    };
                    let is_in = stretches.iter().any(holds);
                    let far = other.distance(curve.at(t)).abs();
                    assert!(is_in || far > 0.5 * slack, "{i} {j} {t} {far}");
                    assert!(!is_in || far < 1.5 * slack, "{i} {j} {t} {far}");
                }
            }
        }
        assert!(circle(0.0, 0.0, 1.0).near(&circle(0.0, 0.0, 1.0), slack).is_none());
        assert!(line(0.0, 1.0).near(&line(0.0, 1.0), slack).is_none());
        assert_eq!(line(0.0, 1.0).near(&line(0.0, 2.0), slack), Some(Vec::new()));
    }
}
