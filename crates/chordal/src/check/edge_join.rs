//! The continuity (Cⁿ, Gⁿ) of two patches along an edge.
use super::joins::{FIRST, SECOND, angle};
use crate::explicit::{Bezier, Patch, PatchSide};
use crate::math::{cross, distance, dot, exponent, greater, length, lesser, power_of_two};

/// A side of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PatchSideId {
    /// The index of the patch.
    pub patch: usize,
    /// Its side.
    pub side: PatchSide,
}

/// The continuity of two patches along an edge.
///
/// *Geometric* continuity compares what is visible: G1 the tangent plane, G2 the curvature as well.
/// *Parametric* continuity compares derivatives by the parameters of the two patches, each over the unit
/// square: C1 and C2 depend on how fast each is run through.
///
/// The largest angle and curvature gap are *measured*: at 33 points of the edge, then by a search around the
/// largest. A difference within the rounding of the control points counts as 0. The classes need no search:
/// up to that rounding, C1 and C2 are equations between control points, and the conditions of G1 and G2 along
/// an edge are polynomials of degrees 8 and 31, which vanish where they do so at 33 points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeJoin {
    /// The two sides that meet.
    pub sides: [PatchSideId; 2],
    /// Whether the fronts of the patches are on the same side of the surface. All other results are measured
    /// as if they were.
    pub fronts_agree: bool,
    /// The largest distance between points of the two sides at the same parameter; 0 for a shared edge.
    pub position_gap: EdgeMaximum,
    /// The largest angle between the normals, 0 to π, which means that the surface is folded back on itself;
    /// `None` if a patch has no tangent plane anywhere on the edge.
    pub angle_rad: Option<EdgeMaximum>,
    /// The largest difference of the normal curvatures across the edge: 1/radius of the sections by planes
    /// that are perpendicular to the edge and contain the normal of the patch. `None` if a patch has no
    /// first derivative across the edge.
    pub curvature_gap: Option<EdgeMaximum>,
    /// Cn: derivatives across the edge up to the nth are equal all along it, up to the rounding of the
    /// control points; `None` for a gap, at most 2.
    pub parametric: Option<u8>,
    /// Gn: the same for position (0), tangent plane (1) and curvature (2).
    pub geometric: Option<u8>,
}

/// The largest value along an edge, and its location.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeMaximum {
    /// The value.
    pub value: f64,
    /// The parameter along the first of the two sides, which runs counter-clockwise; see [`PatchSide::uv`].
    pub t: f64,
    /// The point of that side.
    pub at: [f64; 3],
}

/// Angles are measured only if rounding turns a tangent plane by at most this, in radians (defined here:
/// 0.06°), and curvatures only if it does so by at most 2⁻²⁴ (defined here).
const KNOWN_DIRECTION: f64 = 1.0 / 1024.0;
const KNOWN_CURVATURE: f64 = 1.0 / 16_777_216.0;
/// Equal steps along an edge: their 33 ends are one more than the degree 31 of the condition of G2 needs. With
/// E = e×a the normal of one patch by its derivatives along and across the edge (degree 5), its normal curvature
/// is P/(|E|³·|e|²) with P of degree 16; where E and F, the normal of the other, are parallel, curvatures are
/// equal where P·F³ − Q·E³ is 0, and 16 + 3·5 = 31.
pub(super) const STEPS: usize = 32;
/// If an end has no tangent plane, as at a pole, it is approached: parameters `2^-k` from it. The
/// first is the limit to six digits, the last is within the first of the equal steps.
const APPROACH: [i32; 4] = [20, 16, 12, 8];
/// Steps of a golden-section search: 0.618^36 of two equal steps is 2e-9.
const SEARCH: usize = 36;

/// The continuity of two sides of patches; their direction relative to each other is determined from their
/// ends.
///
/// # Panics
/// If there is no such patch.
///
/// ```
/// use chordal::check::surfaces::{PatchSideId, edge_join};
/// use chordal::{Patch, explicit::parametric::PatchSide};
/// let floor = Patch::flat([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
/// let wall = Patch::flat([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]);
/// let sides = [PatchSideId { patch: 0, side: PatchSide::Right }, PatchSideId { patch: 1, side: PatchSide::Left }];
/// let join = edge_join(&[floor, wall], sides);
/// assert_eq!((join.parametric, join.geometric, join.fronts_agree), (Some(0), Some(0), true));
/// assert_eq!(join.angle_rad.unwrap().value, std::f64::consts::FRAC_PI_2);
/// ```
#[must_use]
pub fn edge_join(patches: &[Patch], sides: [PatchSideId; 2]) -> EdgeJoin {
    // 1. Both patches with the edge as the bottom, scaled by a power of two, so that no square overflows or
    //    vanishes.
    let turned = sides.map(|id| patches[id.patch].turned(id.side));
    let scale = power_of_two(-exponent(greater(turned[0].size(), turned[1].size())));
    let scaled = |patch: &Patch| patch.control.map(|row| row.map(|p| p.map(|x| x * scale)));
    let [first, mut second] = turned.each_ref().map(|patch| Patch { control: scaled(patch) });
    // 2. Both in the direction of the first side.
    let back = |patch: &Patch| Patch { control: patch.control.map(|[a, b, c, d]| [d, c, b, a]) };
    let [same, against] = [second, back(&second)].map(|other| apart(&first.control[0], &other.control[0]));
    // Two surfaces with a common front run along their common edge in opposite directions, as the
    // triangles of a mesh do.
    let fronts_agree = against <= same;
    if fronts_agree {
        second = back(&second);
    }
    let size = first.size() + second.size();
    let edge = EdgePair {
        sides: [PatchBoundary::new(&first), PatchBoundary::new(&second)],
        // See FIRST.
        roundings: [FIRST, SECOND].map(|steps| steps * f64::EPSILON * size),
    };
    // 3. Positions, derivatives and normals.
    // Bit for bit: only then do the two have an edge in common, and a class of continuity.
    let is_shared = lesser(same, against) == 0.0;
    let at = |maximum: (f64, f64), unit: f64| EdgeMaximum {
        value: maximum.1 * unit,
        t: maximum.0,
        at: turned[0].side(PatchSide::Bottom).at(maximum.0),
    };
    let steps: Vec<f64> = (0..=STEPS).map(|i| i as f64 / STEPS as f64).collect();
    let gap = if is_shared { None } else { largest(&steps, |t| Some(edge.gap(t))) };
    let angles = largest(&edge.approached(&steps), |t| edge.angle(t));
    let bends = largest(&steps, |t| edge.curvature_gap(t));
    // Both are exactly 0 if they are within their rounding.
    let class = match (angles, bends) {
        (Some((_, 0.0)), Some((_, 0.0))) => 2,
        (Some((_, 0.0)), _) => 1,
        _ => 0,
    };
    EdgeJoin {
        sides,
        fronts_agree,
        position_gap: at(gap.unwrap_or_default(), 1.0 / scale),
        angle_rad: angles.map(|angle| at(angle, 1.0)),
        curvature_gap: bends.map(|bend| at(bend, scale)),
        parametric: is_shared.then(|| edge.parametric()),
        geometric: is_shared.then_some(class),
    }
}

/// The largest distance of corresponding control points.
pub(super) fn apart(a: &[[f64; 3]; 4], b: &[[f64; 3]; 4]) -> f64 {
    a.iter().zip(b).fold(0.0, |most, (a, b)| greater(distance(*a, *b), most))
}

/// The derivatives of a surface at a point of an edge: along the edge, and across it into the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct CrossJet {
    pub point: [f64; 3],
    pub along: [f64; 3],
    /// The second derivative along the edge.
    pub along_second: [f64; 3],
    /// The derivative across; if that is zero everywhere, a direction across.
    pub across: [f64; 3],
    /// The derivative of `across` along the edge.
    pub mixed: [f64; 3],
    /// The second derivative across.
    pub bend: [f64; 3],
}

/// A surface along one of its edges.
pub(super) trait CrossBoundary {
    fn jet(&self, t: f64) -> CrossJet;

    /// Whether the derivative across is zero everywhere, so that there is no curvature.
    fn is_doubled(&self) -> bool;
}

/// A patch along its bottom: the edge, and the first and second derivative across it, each as a cubic curve.
struct PatchBoundary {
    edge: Bezier<3>,
    across: Bezier<3>,
    bend: Bezier<3>,
    /// Whether `across` is zero everywhere; then it is replaced by the direction to the next row that
    /// differs.
    is_doubled: bool,
}

/// The direction across an edge at one point.
struct CrossDirection {
    /// Perpendicular to the edge, into the patch.
    inward: [f64; 3],
    /// The derivative across the edge is `inward` plus this multiple of the derivative along it.
    lean: f64,
    /// A bound on the turn of the tangent plane by rounding, in radians.
    rounding: f64,
}

impl PatchBoundary {
    fn new(patch: &Patch) -> Self {
        let rows = &patch.control;
        let curve = |f: &dyn Fn(usize, usize) -> f64| Bezier {
            control: std::array::from_fn(|i| std::array::from_fn(|k| f(i, k))),
        };
        let towards = |row: usize| curve(&|i, k| 3.0 * (rows[row][i][k] - rows[0][i][k]));
        let is_doubled = rows[1] == rows[0];
        // Where rows coincide with the edge, the derivative is zero all along; the direction is
        // then that towards the first other row.
        let next = (1..3).find(|row| rows[*row] != rows[0]).unwrap_or(3);
        Self {
            edge: Bezier { control: rows[0] },
            across: towards(next),
            bend: curve(&|i, k| 6.0 * ((rows[0][i][k] - rows[1][i][k]) - (rows[1][i][k] - rows[2][i][k]))),
            is_doubled,
        }
    }
}

impl CrossBoundary for PatchBoundary {
    fn jet(&self, t: f64) -> CrossJet {
        CrossJet {
            point: self.edge.at(t),
            along: self.edge.tangent(t),
            along_second: self.edge.second_derivative(t),
            across: self.across.at(t),
            mixed: self.across.tangent(t),
            bend: self.bend.at(t),
        }
    }

    fn is_doubled(&self) -> bool {
        self.is_doubled
    }
}

impl CrossJet {
    /// `None` if the tangent plane is unknown; rounding may move first derivatives by `rounding`.
    fn direction(&self, rounding: f64) -> Option<CrossDirection> {
        let (along, across) = (self.along, self.across);
        let speed = length(along);
        let lean = dot(across, along) / (speed * speed);
        let inward: [f64; 3] = std::array::from_fn(|k| across[k] - lean * along[k]);
        // Rounding moves `across`, and turns `along`, and with it the subtracted part.
        let rounding = rounding * (1.0 + 2.0 * length(across) / speed) / length(inward);
        (rounding <= KNOWN_DIRECTION).then_some(CrossDirection { inward, lean, rounding })
    }

    /// The normal curvature across the edge, positive if the patch bends towards its front, and a bound on
    /// its rounding; `roundings` are those of first and second derivatives.
    fn curvature(&self, roundings: [f64; 2]) -> Option<[f64; 2]> {
        let CrossDirection { inward, lean, rounding: turn_rounding } = self.direction(roundings[0])?;
        if turn_rounding > KNOWN_CURVATURE {
            return None;
        }
        let along = self.along;
        let normal = cross(along, inward);
        // The derivative across is `inward` + λ·along. Curvature depends only on directions in the
        // surface, so the lean is taken out of the second derivative as well, and what is left is
        // divided by the squared length of `inward`.
        let (size, square) = (length(normal), dot(inward, inward));
        let normal = normal.map(|x| x / size);
        // The second fundamental form in the direction that is perpendicular to the edge: N − 2λM + λ²L.
        let (bent, mixed, along_second) = (self.bend, self.mixed, self.along_second);
        let form: [f64; 3] =
            std::array::from_fn(|k| (bent[k] - 2.0 * lean * mixed[k]) + lean * lean * along_second[k]);
        let curvature = dot(form, normal) / square;
        // Rounding of the form, of the normal, of λ and of the square, each to first order and doubled.
        let spread = 1.0 + lean.abs();
        let turned = length(bent) + 2.0 * lean.abs() * length(mixed) + lean * lean * length(along_second);
        let leaned =
            roundings[0] * spread / length(along) * (length(mixed) + lean.abs() * length(along_second));
        let turn_rounding = 2.0 * (roundings[1] * spread * spread + turn_rounding * turned + 2.0 * leaned)
            / square
            + 4.0 * curvature.abs() * turn_rounding;
        Some([curvature, turn_rounding])
    }
}

/// Two surfaces along an edge, both with the same direction.
pub(super) struct EdgePair<S> {
    pub sides: [S; 2],
    /// Bounds on the movement of first and second derivatives by rounding.
    pub roundings: [f64; 2],
}

impl<S: CrossBoundary> EdgePair<S> {
    pub fn gap(&self, t: f64) -> f64 {
        let [first, second] = self.sides.each_ref().map(|side| side.jet(t).point);
        distance(first, second)
    }

    /// 0 within rounding.
    pub fn angle(&self, t: f64) -> Option<f64> {
        let [first, second] = self.sides.each_ref().map(|side| side.jet(t).direction(self.roundings[0]));
        let (first, second) = (first?, second?);
        let turned = angle(first.inward, second.inward.map(|x| -x));
        Some(if turned <= first.rounding + second.rounding { 0.0 } else { turned })
    }

    /// 0 within rounding.
    pub fn curvature_gap(&self, t: f64) -> Option<f64> {
        if self.sides.iter().any(CrossBoundary::is_doubled) {
            return None;
        }
        let [first, second] = self.sides.each_ref().map(|side| side.jet(t).curvature(self.roundings));
        let (first, second) = (first?, second?);
        // Both run along the edge in the same direction, so the front of one is the back of the other.
        let gap = (first[0] + second[0]).abs();
        Some(if gap <= first[1] + second[1] { 0.0 } else { gap })
    }

    /// The parameters; ends that have no tangent plane are replaced by some parameters beside them.
    pub fn approached(&self, steps: &[f64]) -> Vec<f64> {
        let is_plain = |t: f64| self.angle(t).is_some();
        let near = APPROACH.map(|k| power_of_two(-k));
        let mut parameters: Vec<f64> = Vec::new();
        if !is_plain(0.0) {
            parameters.extend(near);
        }
        parameters.extend(steps.iter().filter(|t| (0.0 < **t && **t < 1.0) || is_plain(**t)));
        if !is_plain(1.0) {
            parameters.extend(near.iter().rev().map(|t| 1.0 - t));
        }
        parameters
    }
}

impl EdgePair<PatchBoundary> {
    fn parametric(&self) -> u8 {
        let [first, second] = &self.sides;
        let roundings = self.roundings;
        let control = |a: &Bezier<3>, b: &Bezier<3>, sign: f64| {
            let pairs = a.control.into_iter().zip(b.control);
            pairs.fold(0.0, |most, (a, b)| greater(distance(a, b.map(|x| sign * x)), most))
        };
        // A doubled row has a derivative of zero, which equals only another one.
        let zero = Bezier { control: [[0.0; 3]; 4] };
        let [a, b] = [first, second].map(|side| if side.is_doubled { &zero } else { &side.across });
        if control(a, b, -1.0) > roundings[0] {
            0
        } else if control(&first.bend, &second.bend, 1.0) > roundings[1] {
            1
        } else {
            2
        }
    }
}

/// The parameter at which `f` is largest, and its value: first among the ascending parameters, then by a
/// search between the neighbours of the best of them.
pub(super) fn largest(parameters: &[f64], f: impl Fn(f64) -> Option<f64>) -> Option<(f64, f64)> {
    let samples: Vec<(f64, f64)> = parameters.iter().filter_map(|t| f(*t).map(|value| (*t, value))).collect();
    let best = (1..samples.len()).fold(0, |best, i| if samples[i].1 > samples[best].1 { i } else { best });
    let mut best_sample = *samples.get(best)?;
    // Values are not negative, so all of them are 0.
    if best_sample.1 == 0.0 {
        return Some(best_sample);
    }
    // Golden section: the better one of two inner points stays.
    // Where the value is unknown, it cannot be the largest.
    let value = |t: f64| f(t).unwrap_or(0.0);
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    // The best sample stays the answer unless the search beats it, since between the samples `f`
    // need not have a single peak.
    let (mut low, mut high) =
        (samples[best.saturating_sub(1)].0, samples[(best + 1).min(samples.len() - 1)].0);
    let inner = |low: f64, high: f64| [high - ratio * (high - low), low + ratio * (high - low)];
    for _ in 0..SEARCH {
        let [a, b] = inner(low, high).map(|t| (t, value(t)));
        for candidate in [a, b] {
            if candidate.1 > best_sample.1 {
                best_sample = candidate;
            }
        }
        if a.1 > b.1 { high = b.0 } else { low = a.0 }
    }
    Some(best_sample)
}
