//! Proves that whole triangles are on one side of a field's surface.
//!
//! **Signs on a piece.** Let f be a primitive that is Lipschitz in a box E with generalized gradients in the
//! box G, let T be a triangle in E with corners vᵢ, and L the linear function with f's values there. For x =
//! Σλᵢvᵢ in T `f(x) − L(x) = Σλᵢ(f(x) − f(vᵢ)) = Σλᵢ γᵢ·(x − vᵢ)` with γᵢ in G (Lebourg's mean value
//! theorem), and since Σλᵢ(x − vᵢ) = 0 the middle of G may be subtracted from each γᵢ. With r the half widths
//! of G,
//! |f − L| is so at most `Σλᵢ Σₖ rₖ|x − vᵢ|ₖ`, and that is
//! - at most ‖r‖·R, where R is the radius of any ball that holds T:
//!   `Σλᵢ|x − vᵢ|² = Σλᵢ|vᵢ − o|² − |x − o|² ≤ R²` for its centre o,
//! - at most ½Σ rₖwₖ, where wₖ are the sides of the box around T: a mean absolute deviation is at most half
//!   of the range.
//!
//! A function that is convex on all of space ([`Curvature`]) is nowhere above L, and nowhere below its tangent planes;
//! one that is concave the other way round.
//!
//! The values at the corners are ranges over points. Every piece is split at rounded midpoints, so a point of
//! the original triangle may be off the nearest point of its piece, along each axis, by [`SLACK`] of the
//! largest coordinate of the triangle. E has that margin, and the bound on f is widened by `Σₖ |G|ₖ·slack`.
//! So a proved sign holds in a neighbourhood of the triangle: by the range over E, which holds the piece in
//! its interior, or strictly, for a function that is continuous there.
//!
//! The sides of the primitives determine the side of the whole
//! ([`LocalTree::membership`](super::local_trees::LocalTree::membership)); halves of a piece inherit decided
//! sides.
//!
//! Source: G. Lebourg, *Valeur moyenne pour gradient généralisé*, 1975.
use super::face_side_cache::{FaceSide, FaceSideCache};
use super::local_trees::{LiteralSides, LocalTree};
use super::regions::SignRegions;
use super::slope::{dot as product, step};
use crate::implicit::csg::Curvature;
use crate::implicit::{DualRange, LeafError, Membership, PrimitiveEvaluator};
use crate::math::{
    Box3, Interval, add_down, add_up, difference, dot, greater, length, length_up, lesser, mul_up, sub_down,
    sub_up,
};

/// A bound on the distance of a point of a triangle from its piece along each axis, relative to its largest
/// coordinate: derived, each of up to [`MOST_CUTS`] midpoints is rounded by at most half of ε; taken three
/// times, so that E holds the piece in its interior.
const SLACK: f64 = 32.0 * f64::EPSILON;
/// The most bisections of a triangle: [`SLACK`] relies on it.
pub(super) const MOST_CUTS: u32 = 18;

/// Triangles that have to be on a given side.
pub(super) struct SideQuery<'a> {
    pub positions: &'a [[f64; 3]],
    pub faces: &'a [[u32; 3]],
    pub side: Membership,
    /// The most bisections.
    pub cuts: u32,
}

/// The most pieces at a time: so many for each face, and so many in addition. With more of them, the faces
/// with the most pieces stay open. Measured on a twisted bolt, whose ranges are wide: with 16 a face the
/// proof fails, with 128 it succeeds.
const PIECES_A_FACE: usize = 128;
const MOST_PIECES: usize = 1 << 14;

struct SignTriangle {
    corners: [[f64; 3]; 3],
    /// A bound on the distance of points of the original triangle from the piece, along each axis.
    slack: f64,
    face: u32,
    tree: u32,
    /// The start of its values at the corners, by primitive of the tree.
    values: usize,
}

/// A piece to be split.
struct TriangleSplit {
    piece: usize,
    /// The tree that is still undecided on it.
    tree: u32,
    /// The side whose midpoint becomes a corner.
    side: usize,
}

type CornerValues = [[f64; 2]; 3];

/// Classifies every triangle.
pub(super) fn classify_sides(
    regions: &mut SignRegions,
    evaluator: &mut PrimitiveEvaluator,
    question: &SideQuery,
) -> Result<Vec<FaceSide>, LeafError> {
    let corners = |face: &[u32; 3]| face.map(|v| question.positions[v as usize]);
    let key = |face: &[u32; 3]| FaceSideCache::key(&corners(face), question.side);
    let keys: Vec<[u64; 10]> = question.faces.iter().map(key).collect();
    let cached: Vec<Option<FaceSide>> =
        keys.iter().map(|key| regions.face_sides.get(key, question.cuts)).collect();
    let unknown: Vec<usize> = (0..cached.len()).filter(|k| cached[*k].is_none()).collect();
    let faces: Vec<[u32; 3]> = unknown.iter().map(|k| question.faces[*k]).collect();
    let mut computed =
        classify_uncached(regions, evaluator, &SideQuery { faces: &faces, ..*question })?.into_iter();
    // Forgets all old verdicts if there are too many, since it is not known which will be asked for again.
    regions.face_sides.reserve(unknown.len());
    let mut results = Vec::with_capacity(cached.len());
    for (key, cached) in keys.into_iter().zip(cached) {
        results.push(cached.or_else(|| computed.next()).expect("what is not known was looked at"));
        if cached.is_none() {
            regions.face_sides.insert(key, results[results.len() - 1], question.cuts);
        }
    }
    Ok(results)
}

fn classify_uncached(
    regions: &mut SignRegions,
    evaluator: &mut PrimitiveEvaluator,
    question: &SideQuery,
) -> Result<Vec<FaceSide>, LeafError> {
    debug_assert!(question.cuts <= MOST_CUTS);
    let mut verdicts = vec![FaceSide::Proved; question.faces.len()];
    let (mut pieces, mut values) = initial_triangles(regions, evaluator, question, &mut verdicts)?;
    // Trees of pieces are for this call; regions refer to the trees before them.
    let n_kept = regions.trees.len();
    for cuts in 0..=question.cuts {
        if pieces.is_empty() {
            break;
        }
        let boxes: Vec<Box3> = pieces.iter().map(|piece| piece.bounds()).collect();
        let questions: Vec<(u32, Box3)> = pieces
            .iter()
            .zip(&boxes)
            .flat_map(|(piece, bounds)| {
                regions.trees.get(piece.tree).primitives.iter().map(|p| (*p, *bounds))
            })
            .collect();
        let slopes = evaluator.dual_ranges(&questions)?;
        // Once the work is used up, pieces that need more cuts stay open.
        let most_cuts = if evaluator.is_over() { cuts } else { question.cuts };
        let sides_of_pieces = pieces_sides(regions, evaluator, (&pieces, &values), &slopes)?;
        let mut remaining = slopes.as_slice();
        let mut split: Vec<TriangleSplit> = Vec::new();
        for (k, (piece, PieceSides { sides, side })) in pieces.iter().zip(sides_of_pieces).enumerate() {
            let (piece_slopes, after) = remaining.split_at(sides.len());
            remaining = after;
            let face = &mut verdicts[piece.face as usize];
            // Another piece has decided about the face.
            if *face != FaceSide::Proved {
                continue;
            }
            if side == question.side {
                continue;
            }
            if side != Membership::Unknown {
                *face = FaceSide::Wrong;
            } else if cuts == most_cuts {
                *face = FaceSide::Open;
            } else {
                match regions.trees.restricted(piece.tree, &sides) {
                    Ok(tree) => {
                        let side = side_to_cut(&piece.corners, &sides, piece_slopes);
                        split.push(TriangleSplit { piece: k, tree, side });
                    }
                    Err(_) => *face = FaceSide::Wrong,
                }
            }
        }
        // Pieces may have been listed before one of their face failed.
        split.retain(|part| verdicts[pieces[part.piece].face as usize] == FaceSide::Proved);
        if split.len() > PIECES_A_FACE * question.faces.len() + MOST_PIECES {
            abandon_most_split(&pieces, &mut split, &mut verdicts);
        }
        let is_wrong = |face: u32| verdicts[face as usize] = FaceSide::Wrong;
        (pieces, values) = halves((regions, question.side), evaluator, (&pieces, &values), &split, is_wrong)?;
    }
    regions.trees.truncate(n_kept);
    Ok(verdicts)
}

/// The sides of a piece's primitives, and the side of the piece.
struct PieceSides {
    sides: Vec<LiteralSides>,
    side: Membership,
}

/// The sides of pieces. Primitives that ranges do not decide are also compared with tangent planes.
fn pieces_sides(
    regions: &SignRegions,
    evaluator: &mut PrimitiveEvaluator,
    (pieces, values): (&[SignTriangle], &[CornerValues]),
    slopes: &[DualRange],
) -> Result<Vec<PieceSides>, LeafError> {
    let primitives = evaluator.csg().primitives();
    let curvature = |p: u32| primitives[p as usize].curvature();
    let extents: Vec<SignTriangleExtent> = pieces.iter().map(SignTriangleExtent::from_triangle).collect();
    let mut results: Vec<PieceSides> = Vec::with_capacity(pieces.len());
    // The primitives with a tangent plane to be evaluated: piece, primitive, and row of the primitive's
    // slope.
    let mut unsure: Vec<(usize, usize, usize)> = Vec::new();
    let mut questions: Vec<(u32, Box3)> = Vec::new();
    let mut first = 0;
    for (number, (piece, extent)) in pieces.iter().zip(&extents).enumerate() {
        let local = regions.trees.get(piece.tree);
        let piece_slopes = &slopes[first..first + local.primitives.len()];
        let at_corners = &values[piece.values..];
        let slopes_and_values = piece_slopes.iter().zip(at_corners);
        let sides: Vec<LiteralSides> = local
            .primitives
            .iter()
            .zip(slopes_and_values)
            .map(|(p, (slope, at_corners))| extent.sides(curvature(*p), slope, at_corners))
            .collect();
        let side = local.membership(&sides, piece_slopes);
        if side == Membership::Unknown {
            let bends = |p: u32| matches!(curvature(p), Curvature::Convex | Curvature::Concave);
            let open = local.primitives.iter().enumerate();
            for (k, p) in open.filter(|(k, p)| sides[*k].is_open() && bends(**p)) {
                unsure.push((number, k, first + k));
                questions.push((*p, point(extent.centre)));
            }
        }
        first += sides.len();
        results.push(PieceSides { sides, side });
    }
    let tangents = evaluator.dual_ranges(&questions)?;
    for (((number, k, row), tangent), (p, _)) in unsure.into_iter().zip(&tangents).zip(&questions) {
        let (piece, result) = (&pieces[number], &mut results[number]);
        if let Some(side) = extents[number].side_of_tangent(curvature(*p), (tangent, &slopes[row]), piece) {
            result.sides[k] = side;
            let local = regions.trees.get(piece.tree);
            // Slopes of the piece begin where that of its first primitive is.
            let first = row - k;
            result.side = local.membership(&result.sides, &slopes[first..first + result.sides.len()]);
        }
    }
    Ok(results)
}

fn point(at: [f64; 3]) -> Box3 {
    Box3 { min: at, max: at }
}

/// Gives up the faces with at least the average number of pieces; they stay open.
fn abandon_most_split(pieces: &[SignTriangle], split: &mut Vec<TriangleSplit>, verdicts: &mut [FaceSide]) {
    let faces = split.chunk_by(|a, b| pieces[a.piece].face == pieces[b.piece].face);
    let share = split.len() / faces.clone().count();
    for of_face in faces.filter(|of_face| of_face.len() >= share) {
        verdicts[pieces[of_face[0].piece].face as usize] = FaceSide::Open;
    }
    split.retain(|part| verdicts[pieces[part.piece].face as usize] == FaceSide::Proved);
}

/// The triangles as pieces, and the values at their corners; without triangles that are decided as a whole.
fn initial_triangles(
    regions: &mut SignRegions,
    evaluator: &mut PrimitiveEvaluator,
    question: &SideQuery,
    verdicts: &mut [FaceSide],
) -> Result<(Vec<SignTriangle>, Vec<CornerValues>), LeafError> {
    let corners_of = |face: &[u32; 3]| face.map(|v| question.positions[v as usize]);
    let boxes: Vec<Box3> = question
        .faces
        .iter()
        .map(corners_of)
        .map(|corners| padded_bounds(&corners, rounding_slack(&corners)))
        .collect();
    let trees = regions.trees_of(evaluator, &boxes)?;
    let mut pairs: Vec<(u32, u32)> = Vec::new();
    let mut pieces = Vec::new();
    let mut n_values = 0;
    for (number, (face, tree)) in question.faces.iter().zip(trees).enumerate() {
        let tree = match tree {
            Ok(tree) => tree,
            Err(side) => {
                if side != question.side {
                    verdicts[number] = FaceSide::Wrong;
                }
                continue;
            }
        };
        let primitives = &regions.trees.get(tree).primitives;
        pairs.extend(primitives.iter().flat_map(|p| face.map(|v| (*p, v))));
        let corners = corners_of(face);
        let slack = rounding_slack(&corners);
        pieces.push(SignTriangle { corners, slack, face: number as u32, tree, values: n_values });
        n_values += primitives.len();
    }
    // Faces share vertices, so each primitive is evaluated at each vertex once.
    pairs.sort_unstable();
    pairs.dedup();
    let questions: Vec<(u32, Box3)> =
        pairs.iter().map(|(p, v)| (*p, point(question.positions[*v as usize]))).collect();
    let answers = evaluator.ranges(&questions)?;
    let value = |p: u32, v: u32| answers[pairs.binary_search(&(p, v)).expect("all were asked for")];
    let mut values = Vec::with_capacity(n_values);
    for piece in &pieces {
        let face = question.faces[piece.face as usize];
        let local = regions.trees.get(piece.tree);
        let corner_values: Vec<CornerValues> =
            local.primitives.iter().map(|p| face.map(|v| value(*p, v))).collect();
        let corner = |k: usize| corner_values.iter().map(|at_corners| at_corners[k]).collect::<Vec<_>>();
        // A corner on the wrong side cannot be helped by pieces.
        if (0..3).any(|k| is_opposite(side_at_point(local, &corner(k)), question.side)) {
            verdicts[piece.face as usize] = FaceSide::Wrong;
        }
        values.extend(corner_values);
    }
    pieces.retain(|piece| verdicts[piece.face as usize] == FaceSide::Proved);
    Ok((pieces, values))
}

/// Both halves of some pieces, each with a tree, and the values at their corners. Calls `is_wrong` for faces
/// whose midpoint is certainly on the other side.
fn halves(
    (regions, side): (&SignRegions, Membership),
    evaluator: &mut PrimitiveEvaluator,
    (pieces, values): (&[SignTriangle], &[CornerValues]),
    split: &[TriangleSplit],
    mut is_wrong: impl FnMut(u32),
) -> Result<(Vec<SignTriangle>, Vec<CornerValues>), LeafError> {
    let mut questions = Vec::new();
    let mut middles = Vec::with_capacity(split.len());
    for TriangleSplit { piece, tree, side } in split {
        let [a, b] = [0, 1].map(|i| pieces[*piece].corners[(side + i) % 3]);
        let middle: [f64; 3] = std::array::from_fn(|i| 0.5 * a[i] + 0.5 * b[i]);
        questions.extend(regions.trees.get(*tree).primitives.iter().map(|p| (*p, point(middle))));
        middles.push(middle);
    }
    let answers = evaluator.ranges(&questions)?;
    let (mut parts, mut part_values) = (Vec::with_capacity(2 * split.len()), Vec::new());
    let mut remaining = answers.as_slice();
    for (TriangleSplit { piece, tree, side: cut }, middle) in split.iter().zip(middles) {
        let piece = &pieces[*piece];
        let (old, new) = (regions.trees.get(piece.tree), regions.trees.get(*tree));
        let (at_middle, after) = remaining.split_at(new.primitives.len());
        remaining = after;
        if is_opposite(side_at_point(new, at_middle), side) {
            is_wrong(piece.face);
            continue;
        }
        // The first half replaces the side's second end by the midpoint, the other half the first end.
        for replaced in [(cut + 1) % 3, *cut] {
            let mut corners = piece.corners;
            corners[replaced] = middle;
            parts.push(SignTriangle { corners, tree: *tree, values: part_values.len(), ..*piece });
            for (p, at_middle) in new.primitives.iter().zip(at_middle) {
                // The corners that stay keep their values; only that of the midpoint is new. The
                // restricted tree may lack primitives of the old one.
                let mut at_corners = values[piece.values + old.index_of(*p)];
                at_corners[replaced] = *at_middle;
                part_values.push(at_corners);
            }
        }
    }
    Ok((parts, part_values))
}

/// The side of a point, from the ranges of the primitives there, unless it may be on one of their zero sets.
fn side_at_point(local: &LocalTree, ranges: &[[f64; 2]]) -> Membership {
    let sides: Vec<LiteralSides> = ranges.iter().map(LiteralSides::off_zero).collect();
    local.membership_without_cracks(&sides)
}

fn is_opposite(side: Membership, wanted: Membership) -> bool {
    side != Membership::Unknown && side != wanted
}

/// The side along which the undecided primitives of a piece change the most, each relative to its steepest
/// change: along the axis of an extrusion they do not change.
fn side_to_cut(corners: &[[f64; 3]; 3], sides: &[LiteralSides], slopes: &[DualRange]) -> usize {
    let along = |k: usize| {
        let d = difference(corners[(k + 1) % 3], corners[k]);
        let is_open = |(sides, _): &(&LiteralSides, &DualRange)| sides.is_open();
        let of_one = |(_, slope): (&LiteralSides, &DualRange)| {
            let Some(gradient) = slope.gradient else { return length(d) };
            let [low, high] = gradient.iter().zip(d).fold([0.0; 2], |[low, high], (g, x)| {
                let (a, b) = (g.lo() * x, g.hi() * x);
                if a < b { [low + a, high + b] } else { [low + b, high + a] }
            });
            let most = greater(-low, high);
            most / length(gradient.map(|g| g.magnitude()))
        };
        let open = sides.iter().zip(slopes).filter(is_open).map(of_one);
        open.fold(0.0, |most: f64, one| greater(one, most))
    };
    let changes = [0, 1, 2].map(along);
    let best = (0..3).fold(0, |best, k| if changes[k] > changes[best] { k } else { best });
    if changes[best] > 0.0 { best } else { longest_side(corners) }
}

fn longest_side(corners: &[[f64; 3]; 3]) -> usize {
    let side = |k: usize| {
        let d = difference(corners[k], corners[(k + 1) % 3]);
        dot(d, d)
    };
    (0..3).fold(0, |best, k| if side(k) > side(best) { k } else { best })
}

/// A bound on the distance of points of a triangle with these corners from its pieces.
fn rounding_slack(corners: &[[f64; 3]; 3]) -> f64 {
    let most = corners.as_flattened().iter().fold(0.0, |most: f64, x| greater(x.abs(), most));
    mul_up(SLACK, most)
}

/// The box E.
fn padded_bounds(corners: &[[f64; 3]; 3], slack: f64) -> Box3 {
    let bare = Box3::from_points(corners);
    Box3 { min: bare.min.map(|x| sub_down(x, slack)), max: bare.max.map(|x| add_up(x, slack)) }
}

impl SignTriangle {
    fn bounds(&self) -> Box3 {
        padded_bounds(&self.corners, self.slack)
    }
}

/// The extents of a piece for the bounds on f − L.
struct SignTriangleExtent {
    /// A point near the triangle.
    centre: [f64; 3],
    /// R.
    radius: f64,
    /// wₖ.
    widths: [f64; 3],
    slack: f64,
}

impl SignTriangleExtent {
    fn from_triangle(piece: &SignTriangle) -> Self {
        let corners = &piece.corners;
        let centre = centre(corners);
        let radius = corners.iter().fold(0.0, |most, corner| {
            let far =
                length_up(std::array::from_fn::<_, 3, _>(|k| sub_up(corner[k], centre[k]).abs().next_up()));
            greater(far, most)
        });
        let bare = Box3::from_points(corners);
        let widths = std::array::from_fn(|k| sub_up(bare.max[k], bare.min[k]));
        Self { centre, radius, widths, slack: piece.slack }
    }

    /// The sides of a primitive and of its complement on which the piece lies.
    fn sides(&self, curvature: Curvature, slope: &DualRange, at_corners: &CornerValues) -> LiteralSides {
        let by_range = LiteralSides::from_range(&slope.value);
        let Some(gradient) = slope.gradient.filter(|_| by_range.is_open()) else { return by_range };
        let half_widths = gradient.map(|d| mul_up(0.5, sub_up(d.hi(), d.lo())));
        let by_radius = mul_up(length_up(half_widths), self.radius);
        let sum = (0..3).fold(0.0, |sum, k| add_up(sum, mul_up(half_widths[k], self.widths[k])));
        let by_widths = mul_up(0.5, sum);
        let stray = lesser(by_widths, by_radius);
        let rounding = self.rounding(&gradient);
        // A concave function is nowhere below L, a convex one nowhere above it: on that side only
        // rounding counts.
        let [below, above] = [curvature.is_concave(), curvature.is_convex()]
            .map(|is_within| if is_within { rounding } else { add_up(stray, rounding) });
        let low = at_corners.iter().fold(f64::INFINITY, |low, [a, _]| lesser(*a, low));
        let high = at_corners.iter().fold(f64::NEG_INFINITY, |high, [_, b]| greater(*b, high));
        if add_down(low, -below) > 0.0 {
            LiteralSides::OUTSIDE
        } else if add_up(high, above) < 0.0 {
            LiteralSides::INSIDE
        } else {
            by_range
        }
    }
}

impl SignTriangleExtent {
    /// A bound on the change of a function with these gradients from the piece to points of the original
    /// triangle.
    fn rounding(&self, gradient: &[Interval; 3]) -> f64 {
        mul_up(gradient.iter().fold(0.0, |sum, d| add_up(sum, d.magnitude())), self.slack)
    }

    /// The side of a convex or concave primitive, from a tangent plane.
    ///
    /// A convex function is nowhere below f(o) + g·(x − o) for its gradient g at any point o; over the piece
    /// this is least at a corner. The tangent plane at the middle of a chord is as far from the chord as the
    /// arc is, a quarter of the distance that the range of gradients over the chord allows.
    fn side_of_tangent(
        &self,
        curvature: Curvature,
        (tangent, slope): (&DualRange, &DualRange),
        piece: &SignTriangle,
    ) -> Option<LiteralSides> {
        let (gradient, gradient_range) = (tangent.gradient?, slope.gradient?);
        let rounding = self.rounding(&gradient_range);
        let rises = piece.corners.map(|corner| product(gradient, step(corner, self.centre)));
        match curvature {
            Curvature::Convex => {
                let least = rises.iter().fold(f64::INFINITY, |least, rise| lesser(rise.lo(), least));
                (sub_down(add_down(tangent.value[0], least), rounding) > 0.0).then_some(LiteralSides::OUTSIDE)
            }
            Curvature::Concave => {
                let most = rises.iter().fold(f64::NEG_INFINITY, |most, rise| greater(rise.hi(), most));
                (add_up(add_up(tangent.value[1], most), rounding) < 0.0).then_some(LiteralSides::INSIDE)
            }
            Curvature::Linear | Curvature::Unknown => None,
        }
    }
}

/// The approximate centre of the smallest ball around a triangle.
fn centre(corners: &[[f64; 3]; 3]) -> [f64; 3] {
    let squares: [f64; 3] = std::array::from_fn(|k| {
        let d = difference(corners[(k + 1) % 3], corners[(k + 2) % 3]);
        dot(d, d)
    });
    // Barycentric coordinates of the circumcentre; one is negative if the angle is obtuse.
    let weights: [f64; 3] =
        std::array::from_fn(|k| squares[k] * (squares[(k + 1) % 3] + squares[(k + 2) % 3] - squares[k]));
    let sum = weights[0] + weights[1] + weights[2];
    if weights.iter().all(|w| *w > 0.0) && sum.is_normal() {
        let weights = weights.map(|w| w / sum);
        return std::array::from_fn(|k| (0..3).fold(0.0, |x, i| x + weights[i] * corners[i][k]));
    }
    let cut = longest_side(corners);
    std::array::from_fn(|k| 0.5 * corners[cut][k] + 0.5 * corners[(cut + 1) % 3][k])
}
