//! `Polyline`: a sequence of points joined by straight segments.

/// Points joined by straight segments, with the parameters of the curve that they approximate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polyline<const D: usize> {
    /// The points, in order. A closed polyline does not repeat its first point; the segment back to it is
    /// implicit.
    pub points: Vec<[f64; D]>,
    /// For each point its parameter on the curve (see [`Curve::at`](super::Curve::at)); empty when unknown.
    pub places: Vec<f64>,
    /// Whether the last point is joined to the first.
    pub closed: bool,
}

impl<const D: usize> Polyline<D> {
    /// The number of segments.
    #[must_use]
    pub fn n_segments(&self) -> usize {
        if self.closed && self.points.len() > 1 {
            self.points.len()
        } else {
            self.points.len().saturating_sub(1)
        }
    }

    /// The ends of each segment, in order.
    pub fn segments(&self) -> impl Iterator<Item = [[f64; D]; 2]> + '_ {
        (0..self.n_segments()).map(|i| [self.points[i], self.points[(i + 1) % self.points.len()]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closed_polyline_has_a_segment_for_each_point() {
        let mut square = Polyline {
            points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            places: Vec::new(),
            closed: true,
        };
        assert_eq!(square.segments().last(), Some([[0.0, 1.0], [0.0, 0.0]]));
        assert_eq!(square.n_segments(), 4);
        square.closed = false;
        assert_eq!(square.segments().count(), 3);
        let point = Polyline { points: vec![[0.0, 0.0]], places: Vec::new(), closed: true };
        assert_eq!(point.segments().count(), 0);
    }
}
