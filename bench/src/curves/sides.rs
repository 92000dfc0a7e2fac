//! The sides: how each of them makes polylines, one curve after the other and all at once.
use super::Cubic;
use chordal::convert::{Spacing, curve_to_polyline};
use chordal::convert::batch::{BezierCutter, beziers_to_polylines};
use chordal::{Bezier, Budget, Job, Tolerance};
use kurbo::PathEl;
use std::ops::Range;

/// A polyline.
pub type Points = Vec<[f64; 2]>;

/// Curves at once: with more, a list outgrows what an allocator hands out again, and the system's fresh pages
/// cost more than the points.
const TOGETHER: usize = 250;

/// Who flattens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// As few segments as can be, proved.
    Fewest,
    /// Equal steps, proved.
    Even,
    /// The same points as the first, through the function for paths: with the parameter of each point and a
    /// distance from below.
    Path,
    Kurbo,
    Lyon,
}

pub const SIDES: [Side; 5] = [Side::Fewest, Side::Path, Side::Even, Side::Kurbo, Side::Lyon];

impl Side {
    pub fn name(self) -> &'static str {
        match self {
            Self::Fewest => "chordal",
            Self::Path => "chordal-path",
            Self::Even => "chordal-even",
            Self::Kurbo => "kurbo",
            Self::Lyon => "lyon",
        }
    }
}

/// Curves in the types of all sides, made before the clock runs.
pub struct Prepared {
    pub cubics: Vec<Cubic>,
    beziers: Vec<Bezier<2>>,
    paths: Vec<chordal::explicit::Curve<2>>,
    elements: Vec<[PathEl; 2]>,
    segments: Vec<lyon_geom::CubicBezierSegment<f64>>,
}

impl Prepared {
    pub fn new(cubics: Vec<Cubic>) -> Self {
        let kurbo = |p: [f64; 2]| kurbo::Point::new(p[0], p[1]);
        let lyon = |p: [f64; 2]| lyon_geom::point(p[0], p[1]);
        Self {
            beziers: cubics.iter().map(|&control| Bezier { control }).collect(),
            paths: cubics.iter().map(|&control| Bezier { control }.into()).collect(),
            elements: cubics
                .iter()
                .map(|c| {
                    [PathEl::MoveTo(kurbo(c[0])), PathEl::CurveTo(kurbo(c[1]), kurbo(c[2]), kurbo(c[3]))]
                })
                .collect(),
            segments: cubics
                .iter()
                .map(|c| lyon_geom::CubicBezierSegment {
                    from: lyon(c[0]),
                    ctrl1: lyon(c[1]),
                    ctrl2: lyon(c[2]),
                    to: lyon(c[3]),
                })
                .collect(),
            cubics,
        }
    }

    /// Calls `with` for every curve, in order, with a list of its own that holds its points.
    pub fn one_by_one(&self, side: Side, tolerance: f64, mut with: impl FnMut(Points)) {
        let length = Tolerance::new(tolerance).expect("a length");
        match side {
            Side::Fewest | Side::Even => {
                let spacing = if side == Side::Even { Spacing::Even } else { Spacing::Fewest };
                let mut cutter = BezierCutter::new(length, spacing).expect("a sane machine");
                for curve in &self.beziers {
                    let mut points = vec![curve.control[0]];
                    cutter.append(curve, &mut points).expect("within reach");
                    with(points);
                }
            }
            Side::Path => {
                let (budget, job) = (Budget::length(length), Job::default().with_threads(1));
                for curve in &self.paths {
                    with(curve_to_polyline(curve, &budget, &job).expect("within reach").shape.points);
                }
            }
            Side::Kurbo => {
                for elements in &self.elements {
                    let mut points = Points::new();
                    kurbo::flatten(*elements, tolerance, |element| {
                        if let PathEl::MoveTo(p) | PathEl::LineTo(p) = element {
                            points.push([p.x, p.y]);
                        }
                    });
                    with(points);
                }
            }
            Side::Lyon => {
                for curve in &self.segments {
                    let mut points = vec![[curve.from.x, curve.from.y]];
                    curve.for_each_flattened(tolerance, &mut |line| points.push([line.to.x, line.to.y]));
                    with(points);
                }
            }
        }
    }

    /// Points of [`TOGETHER`] curves in one list, list after list, as fast as the side can; returns how many.
    pub fn at_once(&self, side: Side, tolerance: f64) -> usize {
        let starts = (0..self.cubics.len()).step_by(TOGETHER);
        starts
            .map(|from| self.some_at_once(side, tolerance, from..(from + TOGETHER).min(self.cubics.len())))
            .sum()
    }

    fn some_at_once(&self, side: Side, tolerance: f64, range: Range<usize>) -> usize {
        let length = Tolerance::new(tolerance).expect("a length");
        let job = Job::default().with_threads(1);
        let mut points = Points::new();
        match side {
            Side::Fewest | Side::Even => {
                let spacing = if side == Side::Even { Spacing::Even } else { Spacing::Fewest };
                let made = beziers_to_polylines(&self.beziers[range], length, &job, spacing);
                return made.expect("within reach").shape.points.len();
            }
            Side::Path => {
                let budget = Budget::length(length);
                let made =
                    chordal::convert::curves_to_polylines(&self.paths[range], &budget, &job, Spacing::Fewest);
                return made.expect("within reach").shape.iter().map(|polyline| polyline.points.len()).sum();
            }
            Side::Kurbo => {
                kurbo::flatten(self.elements[range].iter().flatten().copied(), tolerance, |element| {
                    if let PathEl::MoveTo(p) | PathEl::LineTo(p) = element {
                        points.push([p.x, p.y]);
                    }
                })
            }
            Side::Lyon => {
                for curve in &self.segments[range] {
                    points.push([curve.from.x, curve.from.y]);
                    curve.for_each_flattened(tolerance, &mut |line| points.push([line.to.x, line.to.y]));
                }
            }
        }
        points.len()
    }
}
