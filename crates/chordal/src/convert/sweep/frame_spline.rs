//! Splines of frames along a path: curves of twelve coordinates, the point and the vectors to the side, up and ahead.
//!
//! Along a line and along an arc of a circle they are exact, with the knots and weights of the path itself: the vectors are
//! constant, or affine images of the path. On other paths they are quintic, with the positions and two derivatives of the
//! frames at the ends of pieces.
use super::moving_frame::{
    PathJet, VectorJet, angle_about, frame_jet, part_length, path_jet, transported, turned, unit, unit_across,
};
use crate::explicit::nurbs::{BernsteinRow, InvalidNurbs, KnotVector, NurbsCurve};
use crate::math::{cross, distance, dot, length};

/// The degree of fitted splines.
const QUINTIC: usize = 5;

/// A path, its pieces, and the up vector at its start.
pub(in crate::convert) struct FramedPath<'a> {
    pub path: &'a NurbsCurve<3>,
    pub pieces: Vec<NurbsCurve<3>>,
    /// Across the path.
    pub up: [f64; 3],
    /// Whether the path returns to its start, in the same direction.
    pub is_closed: bool,
}

/// Frames along a path.
pub(in crate::convert) struct FrameSpline {
    pub curve: NurbsCurve<12>,
    /// For each piece of the spline, the piece of the path, and the start and end of the part in it.
    pub places: Vec<(usize, [f64; 2])>,
    /// The twist for each unit of length that closes the frame of a closed path.
    pub spread: f64,
}

fn coordinates(vectors: [[f64; 3]; 4]) -> [f64; 12] {
    std::array::from_fn(|k| vectors[k / 3][k % 3])
}

impl FramedPath<'_> {
    /// With the path's own knots, weights and points.
    fn own(&self, vectors: impl Fn([f64; 3]) -> [[f64; 3]; 3]) -> Result<FrameSpline, InvalidNurbs> {
        let of = |p: &[f64; 3]| {
            let [side, up, ahead] = vectors(*p);
            coordinates([*p, side, up, ahead])
        };
        let control = self.path.control().iter().map(of).collect();
        let knots = self.path.knots().clone();
        let places = (0..knots.n_pieces()).map(|k| (k, [0.0, 1.0])).collect();
        let curve = NurbsCurve::new(knots, control, self.path.weights().to_vec())?;
        Ok(FrameSpline { curve, places, spread: 0.0 })
    }

    /// The constant frames of a line.
    pub fn straight(&self) -> Result<FrameSpline, InvalidNurbs> {
        let tangent = self.start().tangent[0];
        let vectors = [cross(self.up, tangent), self.up, tangent];
        self.own(|_| vectors)
    }

    /// Frames of the circle that the path follows at its start; `None` if the path is straight there.
    pub fn circular(&self) -> Option<Result<FrameSpline, InvalidNurbs>> {
        let PathJet { point, velocity, acceleration, .. } = self.start();
        let binormal = cross(velocity, acceleration);
        let (speed, bent) = (length(velocity), length(binormal));
        let radius = speed * speed * speed / bent;
        // NaN is not finite.
        if !radius.is_finite() {
            return None;
        }
        let axis = binormal.map(|x| x / bent);
        let inward = unit(cross(axis, velocity));
        let centre: [f64; 3] = std::array::from_fn(|k| point[k] + radius * inward[k]);
        // The up vector in terms of the vector outward and the axis; to the side is up × ahead.
        let (out, along) = (-dot(self.up, inward), dot(self.up, axis));
        Some(self.own(|p| {
            let outward: [f64; 3] = std::array::from_fn(|k| (p[k] - centre[k]) / radius);
            let side = std::array::from_fn(|k| out * axis[k] - along * outward[k]);
            let up = std::array::from_fn(|k| out * outward[k] + along * axis[k]);
            [side, up, cross(axis, outward)]
        }))
    }

    fn start(&self) -> PathJet {
        path_jet(&self.pieces[0], self.path.knots().piece(0)[0])
    }

    /// Quintic frames, each piece of the path in so many equal parts; the error is the index of a piece without a frame.
    pub fn fitted(&self, parts: &[usize]) -> Result<FrameSpline, usize> {
        // 1. The places of frames, and their up vectors, without rotation.
        let mut places = Vec::new();
        for (piece, n) in parts.iter().enumerate() {
            places.extend((0..*n).map(|k| (piece, [k, k + 1].map(|k| k as f64 / *n as f64))));
        }
        let span = |(piece, part): &(usize, [f64; 2])| {
            let [a, b] = self.path.knots().piece(*piece);
            // Exactly at the knot, without the rounding of a sum.
            part.map(|s| if s == 1.0 { b } else { a + s * (b - a) })
        };
        let (mut ups, mut lengths) = (vec![self.up], vec![0.0]);
        for (k, place) in places.iter().enumerate() {
            let piece = &self.pieces[place.0];
            // Across the direction of this piece, since the directions of two pieces differ by rounding.
            let from = unit_across(ups[k], path_jet(piece, span(place)[0]).tangent[0]);
            ups.push(transported(piece, span(place), from));
            lengths.push(lengths[k] + part_length(piece, span(place)));
        }
        // 2. The angle that is missing from a full turn is spread over the length of a closed path.
        let mut spread = 0.0;
        if self.is_closed {
            let tangent = self.start().tangent[0];
            let end = unit_across(ups[places.len()], tangent);
            spread = angle_about(tangent, end, self.up) / lengths[places.len()];
        }
        // 3. Quintics.
        let mut control: Vec<[f64; 12]> = Vec::with_capacity(QUINTIC * places.len() + 1);
        let mut knots = Vec::new();
        for (k, place) in places.iter().enumerate() {
            let (piece, ends) = (&self.pieces[place.0], span(place));
            let jets = [0, 1].map(|end| {
                let jet = path_jet(piece, ends[end]);
                let up = unit_across(ups[k + end], jet.tangent[0]);
                let up = turned(up, jet.tangent[0], spread * lengths[k + end]);
                let [side, up, ahead] = frame_jet(&jet, up, spread);
                [[jet.point, jet.velocity, jet.acceleration], side, up, ahead]
            });
            // NaN if the path stops.
            if !jets.as_flattened().as_flattened().as_flattened().iter().all(|x| x.is_finite()) {
                return Err(place.0);
            }
            let mut rows: [Vec<[f64; 3]>; 4] =
                std::array::from_fn(|which| quintic([jets[0][which], jets[1][which]], ends[1] - ends[0]));
            // Such a path is represented exactly.
            if piece.is_polynomial() && piece.knots().degree() <= QUINTIC {
                let elevated = piece.elevated(QUINTIC - piece.knots().degree()).map_err(|_| place.0)?;
                rows[0] = BernsteinRow(elevated.control().to_vec()).part(place.1[0], place.1[1]).0;
            }
            let row = (0..=QUINTIC).map(|i| coordinates(rows.each_ref().map(|row| row[i])));
            // Pieces share the control points between them.
            control.extend(row.skip(usize::from(k > 0)));
            knots.extend(vec![ends[0]; QUINTIC]);
        }
        let last = control.len() - 1;
        if self.is_closed {
            control[last] = control[0];
        }
        let [from, to] = self.path.knots().domain();
        knots.insert(0, from);
        knots.extend(vec![to; QUINTIC + 1]);
        // Some parts are too short for distinct knots.
        let crowded = |_| places[0].0;
        let knots = KnotVector::new(QUINTIC, knots).map_err(crowded)?;
        let curve = NurbsCurve::new(knots, control, vec![1.0; last + 1]).map_err(crowded)?;
        Ok(FrameSpline { curve, places, spread })
    }

    /// Whether the path ends where it starts, in the same direction, up to rounding.
    pub fn closes(pieces: &[NurbsCurve<3>]) -> bool {
        let [Some(first), Some(last)] = [pieces.first(), pieces.last()] else { return false };
        let from = path_jet(first, first.knots().domain()[0]);
        let to = path_jet(last, last.knots().domain()[1]);
        let all = pieces.iter().flat_map(|piece| piece.control().as_flattened());
        let reach = all.fold(0.0, |most: f64, x| crate::math::greater(x.abs(), most));
        // Chosen: some roundings, and the error of a direction with ten digits in a file.
        distance(to.point, from.point) <= 1e-12 * reach && distance(to.tangent[0], from.tangent[0]) <= 1e-9
    }
}

/// The quintic with these values and derivatives at its ends, over an interval of this length.
fn quintic([from, to]: [VectorJet; 2], width: f64) -> Vec<[f64; 3]> {
    let at = |jet: &VectorJet, first: f64, second: f64| -> [f64; 3] {
        std::array::from_fn(|k| jet[0][k] + first * width * jet[1][k] + second * width * width * jet[2][k])
    };
    // Hermite's conditions for coefficients in Bernstein form: steps of a fifth, and a twentieth of the second derivative.
    let (one, two, bend) = (1.0 / 5.0, 2.0 / 5.0, 1.0 / 20.0);
    vec![from[0], at(&from, one, 0.0), at(&from, two, bend), at(&to, -two, bend), at(&to, -one, 0.0), to[0]]
}
