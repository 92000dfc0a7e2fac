//! Plane shapes as polygons, with corners on both sides of what is curved.
use super::arcs::UnitCircle;
use crate::implicit::Affine3;
use crate::implicit::construction::PlanarForm;
use crate::math::{mul_up, unit};

/// Closed polygons, with the inside to the left of their sides.
pub(super) struct ProfileLoops {
    pub loops: Vec<Vec<[f64; 2]>>,
    /// What they are off by but for rounding.
    pub off: f64,
}

impl ProfileLoops {
    /// The polygons of a plane shape within a length. None for contours that cross or touch themselves, and for too many
    /// sides.
    pub fn new(form: &PlanarForm, length: f64) -> Option<Self> {
        match form {
            PlanarForm::Disc { radius } => {
                let circle = UnitCircle::new(*radius, length)?;
                let loops = vec![circle.turn().iter().map(|p| p.map(|x| radius * x)).collect()];
                Some(Self { loops, off: mul_up(circle.off, *radius) })
            }
            PlanarForm::Rectangle { half: [x, y], radius } => {
                let corners = [[*x, *y], [-x, *y], [-x, -y], [*x, -y]];
                if *radius == 0.0 {
                    return Some(Self { loops: vec![corners.to_vec()], off: 0.0 });
                }
                let circle = UnitCircle::new(*radius, length)?;
                let (around, n) = (circle.turn(), circle.quarter.len() - 1);
                let arc = |k: usize| {
                    let points = around.iter().cycle().skip(k * n).take(n + 1);
                    points.map(move |p| [0, 1].map(|axis| corners[k][axis] + radius * p[axis]))
                };
                let mut points: Vec<[f64; 2]> = (0..4).flat_map(arc).collect();
                // A side without a length has one corner.
                points.dedup();
                if points.first() == points.last() {
                    points.pop();
                }
                Some(Self { loops: vec![points], off: mul_up(circle.off, *radius) })
            }
            PlanarForm::Segment { ends: [a, b], radius } => {
                let circle = UnitCircle::new(*radius, length)?;
                let off = mul_up(circle.off, *radius);
                let along = [b[0] - a[0], b[1] - a[1], 0.0];
                let Some([c, s, _]) = unit(along) else {
                    let loops =
                        vec![circle.turn().iter().map(|p| [0, 1].map(|k| a[k] + radius * p[k])).collect()];
                    return Some(Self { loops, off });
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
                Some(Self { loops: vec![front.chain(back).collect()], off })
            }
            PlanarForm::Contours(contours) => Some(Self { loops: contours.loops()?, off: 0.0 }),
        }
    }
}

impl ProfileLoops {
    /// The same under a map of the plane that keeps shapes.
    pub fn placed(mut self, place: Option<&Affine3>) -> Self {
        let Some(map) = place else { return self };
        // The scale is rounded.
        self.off = self.off * scale_of(place) * (1.0 + 8.0 * f64::EPSILON);
        let is_mirrored = map.orientation() < 0;
        for own in &mut self.loops {
            for p in own.iter_mut() {
                let [x, y, _] = map.at([p[0], p[1], 0.0]);
                *p = [x, y];
            }
            if is_mirrored {
                own.reverse();
            }
        }
        self
    }
}

/// How much longer a map of the plane that keeps shapes makes lengths.
pub(super) fn scale_of(place: Option<&Affine3>) -> f64 {
    place.map_or(1.0, |map| {
        let [x, y, _] = map.rows();
        (x[0] * x[0] + y[0] * y[0]).sqrt()
    })
}

/// Twice the area that a loop encloses, rounded: positive where it runs counter-clockwise.
pub(super) fn doubled_area(points: &[[f64; 2]]) -> f64 {
    let Some([x, y]) = points.first() else { return 0.0 };
    points.windows(2).fold(0.0, |sum, pair| {
        let [a, b] = [pair[0], pair[1]].map(|p| [p[0] - x, p[1] - y]);
        sum + (a[0] * b[1] - a[1] * b[0])
    })
}
