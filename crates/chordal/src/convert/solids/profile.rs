//! Plane shapes as polygons, with corners on both sides of curved parts.
use super::arcs::UnitCircle;
use crate::implicit::Affine3;
use crate::implicit::construction::PlanarForm;
use crate::math::{mul_up, unit};

/// Closed polygons, with the inside to the left of their sides.
pub(super) struct ProfileLoops {
    pub loops: Vec<Vec<[f64; 2]>>,
    /// Their distance from the shape, without rounding.
    pub error: f64,
}

impl ProfileLoops {
    /// The polygons of a plane shape within a length; `None` for contours that cross or touch themselves, and for too many
    /// sides.
    pub fn new(form: &PlanarForm, length: f64) -> Option<Self> {
        match form {
            PlanarForm::Disc { radius } => {
                let circle = UnitCircle::new(*radius, length)?;
                let loops = vec![circle.turn().iter().map(|p| p.map(|x| radius * x)).collect()];
                Some(Self { loops, error: mul_up(circle.distance, *radius) })
            }
            PlanarForm::Rectangle { half: [x, y], radius } => {
                let corners = [[*x, *y], [-x, *y], [-x, -y], [*x, -y]];
                if *radius == 0.0 {
                    return Some(Self { loops: vec![corners.to_vec()], error: 0.0 });
                }
                let circle = UnitCircle::new(*radius, length)?;
                let (around, n) = (circle.turn(), circle.quarter.len() - 1);
                let arc = |k: usize| {
                    let points = around.iter().cycle().skip(k * n).take(n + 1);
                    points.map(move |p| [0, 1].map(|axis| corners[k][axis] + radius * p[axis]))
                };
                let mut points: Vec<[f64; 2]> = (0..4).flat_map(arc).collect();
                // The two corners of a side without length are one.
                points.dedup();
                if points.first() == points.last() {
                    points.pop();
                }
                Some(Self { loops: vec![points], error: mul_up(circle.distance, *radius) })
            }
            PlanarForm::Segment { ends: [a, b], radius } => {
                let circle = UnitCircle::new(*radius, length)?;
                let error = mul_up(circle.distance, *radius);
                let along = [b[0] - a[0], b[1] - a[1], 0.0];
                let Some([c, s, _]) = unit(along) else {
                    let loops =
                        vec![circle.turn().iter().map(|p| [0, 1].map(|k| a[k] + radius * p[k])).collect()];
                    return Some(Self { loops, error });
                };
                // Half a turn around each end, from right to left of the direction.
                let quarter = &circle.quarter;
                let right = quarter.iter().rev().map(|[x, y]| [*x, -y]);
                let half: Vec<[f64; 2]> = right.chain(quarter.iter().copied().skip(1)).collect();
                let at = |end: &[f64; 2], [x, y]: [f64; 2]| {
                    [end[0] + radius * (c * x - s * y), end[1] + radius * (s * x + c * y)]
                };
                let front = half.iter().map(|p| at(b, *p));
                let back = half.iter().map(|[x, y]| at(a, [-x, -y]));
                Some(Self { loops: vec![front.chain(back).collect()], error })
            }
            PlanarForm::Contours(contours) => Some(Self { loops: contours.loops()?, error: 0.0 }),
        }
    }
}

impl ProfileLoops {
    /// The polygons under a similarity of the plane.
    pub fn placed(mut self, place: Option<&Affine3>) -> Self {
        let Some(map) = place else { return self };
        // The scale is rounded.
        self.error = self.error * scale_of(place) * (1.0 + 8.0 * f64::EPSILON);
        let is_mirrored = map.orientation() < 0;
        for ring in &mut self.loops {
            for p in ring.iter_mut() {
                let [x, y, _] = map.at([p[0], p[1], 0.0]);
                *p = [x, y];
            }
            if is_mirrored {
                ring.reverse();
            }
        }
        self
    }
}

/// The factor by which a similarity of the plane scales lengths.
pub(super) fn scale_of(place: Option<&Affine3>) -> f64 {
    place.map_or(1.0, |map| {
        let [x, y, _] = map.rows();
        (x[0] * x[0] + y[0] * y[0]).sqrt()
    })
}

/// Twice the area that a loop encloses, rounded: positive if it runs counter-clockwise.
pub(super) fn doubled_area(points: &[[f64; 2]]) -> f64 {
    let Some([x, y]) = points.first() else { return 0.0 };
    points.windows(2).fold(0.0, |sum, pair| {
        let [a, b] = [pair[0], pair[1]].map(|p| [p[0] - x, p[1] - y]);
        sum + (a[0] * b[1] - a[1] * b[0])
    })
}
