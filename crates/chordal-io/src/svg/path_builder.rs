//! `PathBuilder`: draws subpaths segment by segment, and bounds their rounding.
use super::cursor::SvgSyntaxError;
use crate::ReadError;
use crate::grow::{push, push_large};
use chordal::explicit::parametric::{InvalidArc, SvgArcShape};
use chordal::explicit::{Arc, Bezier, Curve, CurveSegment};
use chordal::math::{add_up, greater};
use std::f64::consts::PI;

/// Why drawing stops.
#[derive(Debug)]
pub(super) enum PathError {
    /// An error in the text; the element ends there.
    Text(SvgSyntaxError),
    /// A read error; the file is refused.
    Read(ReadError),
}

impl From<SvgSyntaxError> for PathError {
    fn from(trouble: SvgSyntaxError) -> Self {
        Self::Text(trouble)
    }
}

impl From<ReadError> for PathError {
    fn from(error: ReadError) -> Self {
        Self::Read(error)
    }
}

/// An elliptical arc in path data: radii, rotation in degrees, and the large-arc and sweep flags.
#[derive(Clone, Copy, Debug)]
pub(super) struct ArcParameters {
    pub radii: [f64; 2],
    pub deg: f64,
    pub flags: [bool; 2],
}

/// Draws an element: one curve for each subpath.
#[derive(Debug, Default)]
pub(super) struct PathBuilder {
    /// The finished subpaths.
    pub curves: Vec<Curve<2>>,
    /// The number of subpaths of a single point, which draw nothing.
    pub lone_points: u64,
    pieces: Vec<CurveSegment<2>>,
    start: [f64; 2],
    current: [f64; 2],
    /// Whether a subpath was started, by an explicit or implied move.
    is_down: bool,
    /// The accumulated rounding of relative coordinates in this subpath, and the most that one segment adds
    /// to it.
    drift: f64,
    worst: f64,
    /// A bound on the error of the last mirrored control point.
    mirror: f64,
}

/// The sum of two numbers and the absolute value of its rounding error, both exact.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    // D. Knuth, The Art of Computer Programming 2, 4.2.2.
    let sum = a + b;
    let from_b = sum - a;
    let lost = (a - (sum - from_b)) + (b - from_b);
    (sum, lost.abs())
}

impl PathBuilder {
    /// The current point.
    pub fn at(&self) -> [f64; 2] {
        self.current
    }

    /// A point relative to the current one. Counts the rounding of the sum.
    pub fn relative(&mut self, by: [f64; 2]) -> [f64; 2] {
        let (x, lost_x) = two_sum(self.current[0], by[0]);
        let (y, lost_y) = two_sum(self.current[1], by[1]);
        self.add_error(lost_x);
        self.add_error(lost_y);
        [x, y]
    }

    /// The point mirrored at the current one. Its error is twice that of the current point, plus that of the
    /// point.
    pub fn mirrored(&mut self, point: [f64; 2]) -> [f64; 2] {
        if self.drift > 0.0 {
            let point_off = greater(self.mirror, self.drift);
            self.mirror = add_up(add_up(self.drift, self.drift), point_off);
            self.at_worst(self.mirror);
        }
        let (x, lost_x) = two_sum(2.0 * self.current[0], -point[0]);
        let (y, lost_y) = two_sum(2.0 * self.current[1], -point[1]);
        self.add_error(lost_x);
        self.add_error(lost_y);
        [x, y]
    }

    /// A sum. Counts its rounding.
    pub fn sum(&mut self, a: f64, b: f64) -> f64 {
        let (sum, lost) = two_sum(a, b);
        self.add_error(lost);
        sum
    }

    /// Counts an error of this size.
    pub fn add_error(&mut self, lost: f64) {
        if lost > 0.0 {
            self.drift = add_up(self.drift, lost);
        }
    }

    /// Counts an error of this size for all finished subpaths.
    pub fn add_error_everywhere(&mut self, lost: f64) {
        if lost > 0.0 {
            let curves = std::mem::take(&mut self.curves).into_iter();
            self.curves = curves
                .map(|curve| {
                    let slack = add_up(curve.slack(), lost);
                    curve.with_slack(slack)
                })
                .collect();
        }
    }

    /// Starts a subpath.
    pub fn move_to(&mut self, to: [f64; 2]) -> Result<(), ReadError> {
        self.lone_points += u64::from(self.is_down && self.pieces.is_empty());
        self.finish(false)?;
        (self.start, self.current, self.is_down) = (to, to, true);
        Ok(())
    }

    /// Appends a straight line.
    pub fn line_to(&mut self, to: [f64; 2]) -> Result<(), ReadError> {
        self.piece(CurveSegment::Line([self.current, to]))
    }

    /// Appends a cubic Bézier curve.
    pub fn cubic_to(&mut self, [b, c, d]: [[f64; 2]; 3]) -> Result<(), ReadError> {
        self.piece(CurveSegment::Cubic(Bezier { control: [self.current, b, c, d] }))
    }

    /// Appends a quadratic Bézier curve.
    pub fn quadratic_to(&mut self, [b, c]: [[f64; 2]; 2]) -> Result<(), ReadError> {
        let points = [self.current, b, c];
        let reach = points.iter().flatten().fold(0.0, |most: f64, x| greater(x.abs(), most));
        // Two units in the last place, as the constructor says.
        self.at_worst(2.0 * f64::EPSILON * reach);
        self.piece(CurveSegment::quadratic(points))
    }

    /// Appends an elliptical arc to a point. Returns false if its parameters are too extreme for an arc.
    pub fn arc_to(&mut self, shape: &ArcParameters, to: [f64; 2]) -> Result<bool, ReadError> {
        if to == self.current {
            return Ok(true);
        }
        // The current point may differ from the one in the file, but the end does not, so the arc may span
        // another chord than it should.
        let off_by = self.drift;
        self.span(shape, off_by, to, |from, shape| Arc::through(from, to, shape))
    }

    /// Appends an elliptical arc by a step from the current point; its shape depends only on the step.
    pub fn arc_by(&mut self, shape: &ArcParameters, step: [f64; 2]) -> Result<bool, ReadError> {
        if step == [0.0; 2] {
            return Ok(true);
        }
        let to = self.relative(step);
        self.span(shape, 0.0, to, |from, shape| Arc::through_step(from, step, shape))
    }

    fn span(
        &mut self,
        shape: &ArcParameters,
        off_by: f64,
        to: [f64; 2],
        new_arc: impl FnOnce([f64; 2], &SvgArcShape) -> Result<Arc<2>, InvalidArc>,
    ) -> Result<bool, ReadError> {
        let radii = shape.radii.map(f64::abs);
        if radii.contains(&0.0) {
            return self.line_to(to).map(|()| true);
        }
        // An ellipse is invariant under half a turn, and under a quarter turn with its axes swapped: both
        // exactly.
        let half_turned = shape.deg % 180.0;
        let (radii, deg) =
            if half_turned.abs() == 90.0 { ([radii[1], radii[0]], 0.0) } else { (radii, half_turned) };
        let [large, positive] = shape.flags;
        let rotation_rad = deg * (PI / 180.0);
        let (from, shape) = (self.current, SvgArcShape { radii, rotation_rad, large, positive });
        let Ok(arc) = new_arc(from, &shape) else {
            return Ok(false);
        };
        // The rotation was converted from degrees: the rounding of a factor and a product, for at most half a
        // turn.
        let turned_off = if rotation_rad == 0.0 { 0.0 } else { 8.0 * f64::EPSILON };
        if (turned_off > 0.0 && radii[0] != radii[1]) || off_by > 0.0 {
            self.at_worst(shape.moved_by([0, 1].map(|k| to[k] - from[k]), off_by, turned_off));
        }
        self.arc(arc)?;
        Ok(true)
    }

    /// Appends an arc that starts at the current point.
    pub fn arc(&mut self, arc: Arc<2>) -> Result<(), ReadError> {
        self.piece(CurveSegment::Arc(arc))
    }

    /// Resets the error: the current point is at absolute coordinates of the file.
    pub fn reset_drift(&mut self) {
        self.drift = 0.0;
    }

    fn at_worst(&mut self, lost: f64) {
        self.worst = greater(lost, self.worst);
    }

    fn piece(&mut self, piece: CurveSegment<2>) -> Result<(), ReadError> {
        self.current = piece.end();
        self.is_down = true;
        push_large(&mut self.pieces, piece)
    }

    /// Closes the subpath, with a straight line if it needs one. The next segment starts at the start of this
    /// subpath.
    pub fn close(&mut self) -> Result<(), ReadError> {
        if self.current != self.start {
            self.line_to(self.start)?;
        }
        if self.pieces.is_empty() && self.is_down {
            if let Ok(point) = Curve::point(self.start) {
                push(&mut self.curves, point.with_slack(self.drift))?;
            }
            self.is_down = false;
        }
        let start = self.start;
        self.finish(true)?;
        self.current = start;
        Ok(())
    }

    /// Ends the last subpath.
    pub fn end(&mut self) -> Result<(), ReadError> {
        self.lone_points += u64::from(self.is_down && self.pieces.is_empty());
        self.finish(false)
    }

    fn finish(&mut self, closed: bool) -> Result<(), ReadError> {
        let mut pieces = std::mem::take(&mut self.pieces);
        pieces.shrink_to_fit();
        self.is_down = false;
        let slack = add_up(self.drift, self.worst);
        let slack = if self.drift == 0.0 && self.worst == 0.0 { 0.0 } else { slack };
        (self.worst, self.mirror) = (0.0, 0.0);
        // Segments join by construction; numbers that are not finite were refused before.
        if let Ok(curve) = Curve::new(pieces, closed.into()) {
            push(&mut self.curves, curve.with_slack(slack))?;
        }
        Ok(())
    }
}
