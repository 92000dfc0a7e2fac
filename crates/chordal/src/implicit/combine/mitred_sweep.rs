//! A planar shape swept along straight pieces that are mitred where they meet.
//!
//! Along each piece the shape is a prism, cut off by the planes that halve the angles at both of its ends.
//! From piece to piece its frame is reflected in such a plane, and the piece's direction is reversed: that is
//! the smallest rotation from one direction to the next, and both prisms have the same section with the
//! plane. So they fit.
//!
//! With `f` and `g` the prisms of two neighbours and `h` the half-space on the first one's side, their union
//! is `(f ∧ h) ∨ (g ∧ ¬h)`, which equals `(f ∧ h) ∨ (g ∧ ¬h) ∨ (f ∧ g)`. The last term makes the plane, where
//! both others are 0, part of the inside.
use crate::implicit::shapes::{InvalidShape, finite_point, plane};
use crate::implicit::{Distance, DistanceQuality, Field};
use crate::math::{Box3, add_down, add_up, cross, difference, distance, dot, greater, length, lesser};

/// The most straight pieces of a path. Chosen: each holds another copy of the shape.
const MOST_PIECES: usize = 1024;
/// The largest turn of a shape between the end and the start of a closed path, in radians. Chosen: above the
/// rounding of a thousand reflections.
const TURNED: f64 = 1e-9;
/// Directions that are closer to opposite have no mitre plane. Chosen: mitres would reach a million times the
/// shape's size.
const BACK: f64 = 1e-6;
/// Margin of a box for the roundings of its corners, as a share of their coordinates. Chosen: far more than
/// their few dozen roundings.
const ROUNDED: f64 = 1.0 / (1_u64 << 40) as f64;

/// The directions of a shape's x and y axes, and of the piece.
#[derive(Clone, Copy, Debug)]
struct SweepFrame {
    x: [f64; 3],
    y: [f64; 3],
    along: [f64; 3],
}

/// A straight piece: its frame, its ends, and the normals of the planes that end it, which point forwards.
#[derive(Clone, Copy, Debug)]
struct MitredPiece {
    frame: SweepFrame,
    ends: [[f64; 3]; 2],
    normals: [[f64; 3]; 2],
}

impl Field {
    /// A planar shape swept along the straight lines through `points`, with mitres where they meet. The
    /// origin of the shape runs along the lines. At the start its y axis points up along z as far as
    /// possible; on a vertical line it is the y axis. From line to line the shape turns as little as
    /// possible.
    ///
    /// The value is a bound if the shape's value is one.
    ///
    /// # Errors
    /// When there are fewer than two different points (three for closed lines), more than 1,025, or a number
    /// is not finite; when the shape has no finite box; when the lines turn back at a point, or so sharply
    /// that the mitres at both ends of a line meet within the shape's box; when the end of closed lines,
    /// which then lie in no plane, meets their start with the shape turned.
    ///
    /// ```
    /// use chordal::implicit::shapes::rectangle;
    /// let beam = rectangle([1.0, 2.0])?;
    /// let bent = beam.swept_along(&[[0.0; 3], [10.0, 0.0, 0.0], [10.0, 10.0, 0.0]], false)?;
    /// assert_eq!(bent.expr().at([5.0, 0.0, 0.75]).unwrap(), -0.25);
    /// assert!(bent.expr().at([10.4, -0.4, 0.0]).unwrap() < 0.0); // the outer corner of the mitre
    /// # Ok::<(), chordal::implicit::shapes::InvalidShape>(())
    /// ```
    pub fn swept_along(&self, points: &[[f64; 3]], is_closed: bool) -> Result<Self, InvalidShape> {
        let pieces = self.pieces(points, is_closed)?;
        let prisms: Vec<Self> = pieces.iter().map(|piece| self.prism(piece)).collect();
        let mut parts = Vec::with_capacity(2 * pieces.len());
        for (k, piece) in pieces.iter().enumerate() {
            let bounds = self.corners(piece);
            parts.push(cut(&[&prisms[k]], piece.start()?, piece.end()?, bounds));
            let next = (k + 1) % pieces.len();
            if next != 0 || is_closed {
                // The last term of the union, without which the mitre plane would be a surface.
                let bounds = bounds.union(self.corners(&pieces[next]));
                parts.push(cut(&[&prisms[k], &prisms[next]], piece.start()?, pieces[next].end()?, bounds));
            }
        }
        let weak = |quality: DistanceQuality| lesser(quality, DistanceQuality::Bound);
        let Distance { outside, inside } = prisms[0].distance();
        Ok(Self::union_of(&parts).known_distance(Distance { outside: weak(outside), inside: weak(inside) }))
    }

    /// The pieces along lines, each with its frame.
    fn pieces(&self, points: &[[f64; 3]], is_closed: bool) -> Result<Vec<MitredPiece>, InvalidShape> {
        let wrong = |what: String| Err(InvalidShape::Number(what));
        let Box3 { min, max } = self.bounds();
        if !(0..2).all(|k| min[k].is_finite() && max[k].is_finite()) {
            return wrong("a shape that is swept along a path must be bounded on all sides".into());
        }
        let mut at: Vec<[f64; 3]> = Vec::with_capacity(points.len());
        for point in points {
            let point = finite_point("a point of a path", *point)?;
            if at.last() != Some(&point) {
                at.push(point);
            }
        }
        // The end of a closed path may repeat its first point.
        if is_closed && at.len() > 1 && at.first() == at.last() {
            at.pop();
        }
        let min_points = if is_closed { 3 } else { 2 };
        if at.len() < min_points {
            return wrong(format!(
                "a path has {} different points, and must have at least {min_points}",
                at.len()
            ));
        }
        let n_pieces = if is_closed { at.len() } else { at.len() - 1 };
        if n_pieces > MOST_PIECES {
            return wrong(format!(
                "a path has {n_pieces} straight pieces, and must have at most {MOST_PIECES}"
            ));
        }
        let n = at.len();
        let ends = |k: usize| [at[k], at[(k + 1) % n]];
        let directions: Vec<[f64; 3]> = (0..n_pieces).map(|k| direction(ends(k))).collect();
        let joint = |before: usize, after: usize| -> Result<[f64; 3], InvalidShape> {
            // The sum of two unit vectors halves the angle between them: the normal of the mitre plane.
            let sum: [f64; 3] = std::array::from_fn(|k| directions[before][k] + directions[after][k]);
            if length(sum) < BACK {
                let point = at[after];
                return Err(InvalidShape::Number(format!(
                    "the path turns back at its point {after}, {point:?}"
                )));
            }
            Ok(scaled(sum, 1.0 / length(sum)))
        };
        let mut frame = SweepFrame::first(directions[0]);
        let mut pieces = Vec::with_capacity(n_pieces);
        for (k, along) in directions.iter().copied().enumerate() {
            if k > 0 {
                frame = frame.next(joint(k - 1, k)?, along);
            }
            let start = if k > 0 || is_closed { joint((k + n_pieces - 1) % n_pieces, k)? } else { along };
            let end = if k + 1 < n_pieces || is_closed { joint(k, (k + 1) % n_pieces)? } else { along };
            let piece = MitredPiece { frame, ends: ends(k), normals: [start, end] };
            if self.corner_rows(&piece).iter().any(|[a, b]| dot(difference(*b, *a), frame.along) <= 0.0) {
                return wrong(format!(
                    "the path bends too sharply at its piece {k}, from {:?}: the shape reaches beyond the middle of the bend",
                    piece.ends[0]
                ));
            }
            pieces.push(piece);
        }
        if is_closed {
            let back = frame.next(joint(n_pieces - 1, 0)?, directions[0]);
            let first = pieces[0].frame;
            // A unit vector that is turned by φ moves by 2 sin(φ / 2).
            let turned = greater(distance(back.x, first.x), distance(back.y, first.y));
            if turned > TURNED {
                return wrong(format!(
                    "the closed path lies in no plane, and the shape comes back turned by {:.3} degrees",
                    2.0 * libm::asin(lesser(0.5 * turned, 1.0)).to_degrees()
                ));
            }
        }
        Ok(pieces)
    }

    /// The shape along an entire line.
    fn prism(&self, piece: &MitredPiece) -> Self {
        let SweepFrame { x, y, along } = piece.frame;
        let rows = [x, y, along];
        self.map_linear(rows, rows.map(|row| -dot(row, piece.ends[0])))
    }

    /// The corners of the shape's rectangle on the planes of both ends.
    fn corner_rows(&self, piece: &MitredPiece) -> [[[f64; 3]; 2]; 4] {
        let Box3 { min, max } = self.bounds();
        let SweepFrame { x, y, along } = piece.frame;
        [[min[0], min[1]], [max[0], min[1]], [min[0], max[1]], [max[0], max[1]]].map(|[a, b]| {
            let across: [f64; 3] = std::array::from_fn(|k| a * x[k] + b * y[k]);
            [0, 1].map(|end| {
                // The point of the plane over the corner.
                let normal = piece.normals[end];
                let forwards = -dot(across, normal) / dot(along, normal);
                std::array::from_fn(|k| piece.ends[end][k] + across[k] + forwards * along[k])
            })
        })
    }

    /// A box around the piece.
    fn corners(&self, piece: &MitredPiece) -> Box3 {
        let corners = self.corner_rows(piece);
        let Box3 { min, max } = Box3::from_points(corners.as_flattened());
        let largest = min.iter().chain(&max).fold(0.0, |most, x| greater(x.abs(), most));
        let margin = largest * ROUNDED;
        Box3 { min: min.map(|x| add_down(x, -margin)), max: max.map(|x| add_up(x, margin)) }
    }
}

/// The intersection of prisms between two half-spaces.
fn cut(prisms: &[&Field], start: Field, end: Field, bounds: Box3) -> Field {
    let ends = start.intersection(&end);
    prisms.iter().fold(ends, |common, prism| common.intersection(prism)).known_bounds(bounds)
}

impl MitredPiece {
    /// The half-space beyond its start.
    fn start(&self) -> Result<Field, InvalidShape> {
        let normal = self.normals[0];
        plane(normal.map(|x| -x), -dot(normal, self.ends[0]))
    }

    /// The half-space before its end.
    fn end(&self) -> Result<Field, InvalidShape> {
        plane(self.normals[1], dot(self.normals[1], self.ends[1]))
    }
}

impl SweepFrame {
    /// The frame at the start of a path.
    fn first(along: [f64; 3]) -> Self {
        let up = [0.0, 0.0, 1.0];
        let across: [f64; 3] = std::array::from_fn(|k| up[k] - along[2] * along[k]);
        // Vertical up to rounding. Chosen: a turn by that angle moves the shape by far less than any
        // tolerance.
        let y = if length(across) > 1e-9 { scaled(across, 1.0 / length(across)) } else { [0.0, 1.0, 0.0] };
        Self { x: cross(y, along), y, along }
    }

    /// The frame on the other side of a plane with this unit normal.
    fn next(self, normal: [f64; 3], along: [f64; 3]) -> Self {
        let reflected = |v: [f64; 3]| -> [f64; 3] {
            let twice = 2.0 * dot(v, normal);
            std::array::from_fn(|k| v[k] - twice * normal[k])
        };
        // Make it perpendicular again, so that roundings of a thousand pieces do not add up.
        let y = reflected(self.y);
        let y: [f64; 3] = std::array::from_fn(|k| y[k] - dot(y, along) * along[k]);
        let y = scaled(y, 1.0 / length(y));
        Self { x: cross(y, along), y, along }
    }
}

/// The direction from one end to the other.
fn direction([a, b]: [[f64; 3]; 2]) -> [f64; 3] {
    let step = difference(b, a);
    scaled(step, 1.0 / length(step))
}

fn scaled(v: [f64; 3], by: f64) -> [f64; 3] {
    v.map(|x| x * by)
}
