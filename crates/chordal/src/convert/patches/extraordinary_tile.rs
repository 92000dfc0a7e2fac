//! A tile on an extraordinary subpatch: two triangles, or a fan around a vertex in its middle, and the proof
//! of their distance.
//!
//! **The proof.** Let `S` be the surface over the tile, a disc, and `M` its triangles, a disc as well; `π`
//! the projection along a direction `N` onto a plane. `N` sees the front of every triangle, and `π` is one to
//! one on `M` (two triangles on either side of their diagonal, or a fan that goes around its middle once);
//! let `P = π(M)`.
//!
//! ```text
//!           .·· S ··.            π projects along N onto the plane. V bounds the heights of S over
//!     .· '      |     ' ·.       the triangles of M; ε and δ bound the distance between the border
//!   ·´_____M____|________`·      curves of S and their chords, the sides of M, in space and in the
//!               |  N             plane.
//!    |<---------x-------->|  P = π(M)
//! ```
//!
//! *Surface to mesh.* The surface is divided into pieces, each in the convex hull of its control points. For
//! a piece whose image lies in `P`, each point is above or below some triangle that the image touches, by no
//! more than the largest height of a control point over that triangle's plane, since a height over a plane is
//! a convex function: `V`. For other pieces the distance to any one triangle is convex as well, so that the
//! largest distance of the piece's control points from the best triangle is a bound.
//!
//! *Mesh to surface.* Let each side of `M` be the chord of a curve on the border of `S`, within `ε` of it in
//! space and within `δ` in the plane, both by pairing a point of the curve with the nearest point of the chord,
//! which is continuous and covers the chord. Moving `π(∂S)` to `∂P` along these pairs moves no point by more
//! than `δ`. So around a point `x` of `P` that the moving curve does not pass, `π(∂S)` winds as often as `∂P`
//! does, once, and `x` is the image of a point of `S`; that point is above or below the point of `M` over `x` by
//! at most `V`. If the moving curve passes `x`, the point `m` of `M` over `x` is within `δ·sec` of the border of
//! `M`, measured along `M`, whose triangles have a slope of at most `sec` against the plane, and the border is
//! within `ε` of `S`: within `ε + δ·sec`. If `P` is convex, there is a second bound. With the pairs in space `x`
//! lies on the image of a segment from a point `q` of a chord to its partner `c` on the curve, and the segment
//! from `π(q)` to `x` lies in `P`. So the distance of `m` from the segment's point over `x` is at most the slopes
//! of both, and its distance from `c` at most `|q − c|·(1 + tan)`: within `ε·(1 + tan)`, `tan² = sec² − 1`. Hence
//! the distance is at most the larger of `V` and the smaller of these two.
//!
//! If this does not apply, both `S` and the vertices of `M` lie in the hull of the one-ring, whose diagonal is
//! a bound.
//!
//! **Rounding.** Everything is computed relative to a corner of the tile. The errors of that, of the vertices
//! and of the control points are in [`ExtraordinaryQuad::rounding_error`] and in the rounding bound of each
//! piece. The error of a triangle's unit normal is some roundings times the square of its longest edge over
//! its doubled area; it tilts the plane, and is added as such.
use super::patch_tile::{PatchTile, PatchTileMesh};
use super::seams::TileSeams;
use super::tile_border::{BorderVertex, walk_side};
use crate::check::distance_up;
use crate::explicit::cage::limit::{ExtraordinaryQuad, LimitPatches, QuadPatchTree};
use crate::explicit::{Bezier, InvalidCage, Patch, PatchSide};
use crate::math::{Box3, PriorityItem, branch_and_bound, greater, lesser};
use glam::{DVec2, DVec3};
use std::collections::BinaryHeap;

/// A vertex with its parameters in the unit square and its position.
#[derive(Clone, Copy)]
struct FanTileVertex {
    place: [f64; 2],
    at: [f64; 3],
}

/// The number of triangles of a tile with these numbers of segments on its sides.
pub(crate) fn count_triangles(counts: [u32; 4]) -> u64 {
    let border: u64 = counts.iter().map(|count| u64::from(*count)).sum();
    if border == 4 { 2 } else { border }
}

/// Triangulates and proves the tile with the given index.
pub(crate) fn build(
    index: usize,
    tile: &PatchTile,
    extraordinary: &ExtraordinaryQuad,
    seams: &TileSeams,
) -> PatchTileMesh {
    let (mut knots, mut shared): (Vec<FanTileVertex>, Vec<BorderVertex>) = (Vec::new(), Vec::new());
    let mut sides = Vec::new();
    for side in PatchSide::ALL {
        walk_side(index, tile, side, seams, |u, v, vertex| {
            knots.push(FanTileVertex { place: [u, v], at: seams.positions[vertex.id as usize] });
            shared.push(vertex);
            sides.push(side);
        });
    }
    let proof = ExtraordinaryProof {
        region: extraordinary,
        sides: &sides,
        tolerance: tile.tolerance,
        pieces: PIECES_FOR_TIGHTNESS,
    };
    let n = knots.len();
    // A tile with its four corners alone takes two triangles instead of a fan around a middle.
    let (triangles, bound) = if n == 4 && tile.n == 1 && tile.m == 1 {
        proof.two_triangles(&knots)
    } else {
        let at = extraordinary.point(0.5, 0.5);
        knots.push(FanTileVertex { place: [0.5, 0.5], at });
        let triangles: Vec<[u32; 3]> = (0..n).map(|k| [k as u32, ((k + 1) % n) as u32, n as u32]).collect();
        let bound = proof.bound(&knots, &triangles);
        (triangles, bound)
    };
    let within = |[u, v]: [f64; 2]| {
        let at = |x: f64, [from, to]: [f64; 2]| from + (to - from) * x;
        [at(u, tile.u), at(v, tile.v)]
    };
    let id = |k: u32| shared.get(k as usize).map_or(u32::MAX, |vertex| vertex.id);
    let has_twice = |t: &[u32; 3]| id(t[0]) == id(t[1]) || id(t[1]) == id(t[2]) || id(t[2]) == id(t[0]);
    let inner: Vec<[f64; 3]> = knots[n..].iter().map(|knot| knot.at).collect();
    let inner_normals =
        knots[n..].iter().map(|k| extraordinary.normal(k.place[0], k.place[1]).unwrap_or_default());
    PatchTileMesh {
        worst: triangles[0].map(|k| within(knots[k as usize].place)),
        inner_normals: inner_normals.collect(),
        inner,
        too_few: triangles.iter().any(has_twice),
        bound: (bound + extraordinary.rounding_error()).next_up(),
        normal_deviation: None,
        border_normals: Vec::new(),
        place: Box3::from_points(extraordinary.ring().hull()),
        is_kept: false,
        triangles,
    }
}

/// Whether the two triangles between the corners of a quad are within the tolerance.
pub(crate) fn is_flat(extraordinary: &ExtraordinaryQuad, tolerance: f64) -> bool {
    let knots = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
        .map(|place| FanTileVertex { place, at: extraordinary.point(place[0], place[1]) });
    let proof = ExtraordinaryProof { region: extraordinary, sides: &PatchSide::ALL, tolerance, pieces: 0 };
    let [a, b, c, d] = knots.map(|knot| knot.at);
    // Four sample points on the sides and one in the middle, which may quickly show that it is not flat.
    let pairs = [([0.5, 0.0], [a, b]), ([1.0, 0.5], [b, c]), ([0.5, 1.0], [c, d]), ([0.0, 0.5], [d, a])];
    let is_far = |place: [f64; 2], near: &dyn Fn([f64; 3]) -> f64| {
        near(extraordinary.point(place[0], place[1])) > tolerance
    };
    let sides_are_far =
        pairs.iter().any(|(place, [p, q])| is_far(*place, &|at| distance_up(at, &[*p, *q, *q])));
    let middle_is_far = is_far([0.5, 0.5], &|at| {
        let least = |x: f64, y: f64| lesser(x, y);
        least(
            least(distance_up(at, &[a, b, c]), distance_up(at, &[a, c, d])),
            least(distance_up(at, &[a, b, d]), distance_up(at, &[b, c, d])),
        )
    });
    !sides_are_far && !middle_is_far && proof.two_triangles(&knots).1 <= tolerance
}

struct ExtraordinaryProof<'a> {
    region: &'a ExtraordinaryQuad,
    /// The side that contains the edge from each border vertex to the next.
    sides: &'a [PatchSide],
    tolerance: f64,
    /// The number of pieces that are visited even if the tolerance is met.
    pieces: usize,
}

impl ExtraordinaryProof<'_> {
    /// Two triangles between four vertices, by the diagonal that is nearer to the surface.
    fn two_triangles(&self, knots: &[FanTileVertex]) -> (Vec<[u32; 3]>, f64) {
        let rising = vec![[0, 1, 2], [0, 2, 3]];
        let falling = vec![[0, 1, 3], [1, 2, 3]];
        let middle = DVec3::from(self.region.point(0.5, 0.5));
        let at = |k: usize| DVec3::from(knots[k].at);
        let distance_sq = |a: usize, b: usize| (0.5 * (at(a) + at(b)) - middle).length_squared();
        let (first, second) =
            if distance_sq(0, 2) <= distance_sq(1, 3) { (rising, falling) } else { (falling, rising) };
        let bound = self.bound(knots, &first);
        if bound <= self.tolerance {
            return (first, bound);
        }
        let other = self.bound(knots, &second);
        if other < bound { (second, other) } else { (first, bound) }
    }

    fn bound(&self, knots: &[FanTileVertex], triangles: &[[u32; 3]]) -> f64 {
        let hull =
            Box3::from_points(self.region.ring().hull().iter().chain(knots.iter().map(|knot| &knot.at)));
        let diagonal = hull.diagonal();
        if diagonal <= self.tolerance {
            return diagonal;
        }
        let sheets = RegionHeightField::new(self.region, knots, triangles);
        let bound = sheets.and_then(|graph| graph.bound(self, knots, hull.diagonal()));
        bound.filter(|bound| *bound < diagonal).unwrap_or(diagonal)
    }
}

/// A triangle with its projection, as used by the proof.
struct ProjectedTriangle {
    corners: [[f64; 3]; 3],
    projected: [DVec2; 3],
    normal: DVec3,
    /// The cosine of its slope against the plane.
    cosine: f64,
    /// The error of its unit normal.
    tilt: f64,
}

/// Triangles whose fronts a direction sees, so that they project one to one.
struct RegionHeightField<'a> {
    region: &'a ExtraordinaryQuad,
    origin: DVec3,
    frame: [DVec3; 2],
    faces: Vec<ProjectedTriangle>,
    /// The border vertices in the plane.
    border: Vec<DVec2>,
}

/// The least cosine of a triangle's slope against the plane. Chosen: a steeper triangle (78°) gives no useful proof.
const LEAST_COSINE: f64 = 0.2;
/// A triangle whose doubled area is below this fraction of its longest edge squared counts as degenerate. Chosen: far
/// above rounding, and below any useful shape.
const LEAST_SHAPE: f64 = 1e-6;
/// Roundings in a unit normal, with a margin: six products and differences of lengths up to an edge, and the
/// quotient.
const TILT: f64 = 32.0 * f64::EPSILON;

impl<'a> RegionHeightField<'a> {
    fn new(
        extraordinary: &'a ExtraordinaryQuad,
        knots: &[FanTileVertex],
        triangles: &[[u32; 3]],
    ) -> Option<Self> {
        let origin = DVec3::from(knots[0].at);
        let at: Vec<DVec3> = knots.iter().map(|knot| DVec3::from(knot.at) - origin).collect();
        let areas: Vec<DVec3> = triangles
            .iter()
            .map(|t| t.map(|k| at[k as usize]))
            .map(|[a, b, c]| (b - a).cross(c - a))
            .collect();
        let axis = areas.iter().fold(DVec3::ZERO, |sum, area| sum + *area).try_normalize()?;
        // An axis that is not nearly parallel: the sine of the angle between is at least 0.6.
        let along = if axis.x.abs() < 0.6 { DVec3::X } else { DVec3::Y };
        let first = axis.cross(along).try_normalize()?;
        let frame = [first, axis.cross(first)];
        let flat = |p: DVec3| DVec2::new(p.dot(frame[0]), p.dot(frame[1]));
        let mut faces = Vec::with_capacity(triangles.len());
        for (t, area) in triangles.iter().zip(areas) {
            let corners = t.map(|k| at[k as usize]);
            let [a, b, c] = corners;
            let longest =
                (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
            let size = area.length();
            let cosine = area.dot(axis) / size;
            let is_sound = size > LEAST_SHAPE * longest && cosine > LEAST_COSINE;
            if !is_sound {
                return None;
            }
            faces.push(ProjectedTriangle {
                corners: corners.map(Into::into),
                projected: corners.map(flat),
                normal: area / size,
                cosine,
                tilt: TILT * longest / size,
            });
        }
        // A fan has one vertex in its middle, behind those of the border.
        let n_border = knots.len() - usize::from(triangles.len() > 2);
        let graph = Self {
            region: extraordinary,
            origin,
            frame,
            faces,
            border: at[..n_border].iter().map(|p| flat(*p)).collect(),
        };
        (triangles.len() == 2 || graph.winds_once(flat(at[n_border]))).then_some(graph)
    }

    /// Whether the border winds around `middle` once, given that it turns left everywhere as seen from there.
    fn winds_once(&self, middle: DVec2) -> bool {
        // As it turns left everywhere, it comes up through the horizontal line once in each turn.
        let is_below = |k: usize| (self.border[k % self.border.len()] - middle).y < 0.0;
        (0..self.border.len()).filter(|k| is_below(*k) && !is_below(k + 1)).count() == 1
    }

    /// Whether the border never turns right.
    fn is_convex(&self) -> bool {
        let n = self.border.len();
        (0..n).all(|k| {
            let [a, b, c] = [k, k + 1, k + 2].map(|k| self.border[k % n]);
            (b - a).perp_dot(c - b) >= 0.0
        })
    }

    fn local(&self, point: &[f64; 3]) -> DVec3 {
        DVec3::from(*point) - self.origin
    }

    fn project(&self, point: DVec3) -> DVec2 {
        DVec2::new(point.dot(self.frame[0]), point.dot(self.frame[1]))
    }

    fn bound(&self, proof: &ExtraordinaryProof<'_>, knots: &[FanTileVertex], wide: f64) -> Option<f64> {
        let tilt = self.faces.iter().fold(0.0, |most: f64, face| most.max(face.tilt / face.cosine)) * wide;
        let secant = self.faces.iter().fold(1.0, |most: f64, face| most.max(1.0 / face.cosine));
        let (mut beside, mut aside) = (0.0_f64, 0.0_f64);
        let n = self.border.len();
        for k in 0..n {
            let next = (k + 1) % n;
            let ends = [k, next].map(|k| self.local(&knots[k].at));
            let (in_space, in_plane) =
                self.side_deviation(proof, [knots[k].place, knots[next].place], proof.sides[k], ends)?;
            (beside, aside) = (beside.max(in_space), aside.max(in_plane));
        }
        let by_plane = beside + aside * secant;
        let by_slope = beside * (1.0 + (secant * secant - 1.0).sqrt());
        let border = if by_slope < by_plane && self.is_convex() { by_slope } else { by_plane };
        // The interior can only make it larger.
        if border > proof.tolerance {
            return Some(border + tilt);
        }
        let area = self.interior_deviation(proof)?;
        Some(greater(area, border) + tilt)
    }

    /// The largest distance of the border's curve from its chord: in space and in the plane.
    fn side_deviation(
        &self,
        proof: &ExtraordinaryProof<'_>,
        places: [[f64; 2]; 2],
        side: PatchSide,
        ends: [DVec3; 2],
    ) -> Option<(f64, f64)> {
        // In the order of the parameter along the side.
        let axis = usize::from(matches!(side, PatchSide::Left | PatchSide::Right));
        let (a, b) = (places[0][axis], places[1][axis]);
        let span = if a < b { [a, b] } else { [b, a] };
        let flat = ends.map(|end| self.project(end));
        let far = |points: &[[f64; 3]]| {
            points.iter().fold((0.0_f64, 0.0_f64), |(space, plane), point| {
                let point = self.local(point);
                (
                    space.max(distance_to_segment(point, ends)),
                    plane.max(planar_distance_to_segment(self.project(point), flat)),
                )
            })
        };
        let mut most = (0.0_f64, 0.0_f64);
        let mut open = vec![(RegionBoundary::Extraordinary(self.region), span, 0)];
        while let Some((curve, span, depth)) = open.pop() {
            let (points, off) = match curve {
                RegionBoundary::Extraordinary(extraordinary) => {
                    let off = 2.0 * extraordinary.ring().rounding();
                    let (space, plane) = far(extraordinary.ring().hull());
                    let (space, plane) = (space + off, plane + off);
                    if space + plane <= FINE * proof.tolerance || depth > DEEPEST {
                        most = (most.0.max(space), most.1.max(plane));
                        continue;
                    }
                    let quarters = extraordinary.quarters().ok()?;
                    for (half, quarter) in quarters_on(side).into_iter().enumerate() {
                        let begin = 0.5 * half as f64;
                        let inner = [span[0].max(begin), span[1].min(begin + 0.5)];
                        if inner[0] < inner[1] {
                            let inner = inner.map(|x| 2.0 * (x - begin));
                            open.push((RegionBoundary::from_square(&quarters[quarter]), inner, depth + 1));
                        }
                    }
                    continue;
                }
                RegionBoundary::Patches(patches) => (side_curves(patches, side, span), patches.off),
            };
            for curve in points {
                // Quarters, since these are close to their control points.
                for quarter in 0..4 {
                    let begin = 0.25 * f64::from(quarter);
                    let (space, plane) = far(&curve.part(begin, begin + 0.25).control);
                    most = (most.0.max(space + off), most.1.max(plane + off));
                }
            }
        }
        Some(most)
    }

    /// The largest height of the surface over the triangles, or its largest distance from them.
    fn interior_deviation(&self, proof: &ExtraordinaryProof<'_>) -> Option<f64> {
        let tolerance = proof.tolerance;
        let open = BinaryHeap::from([self.queue_entry(RegionPiece::Extraordinary(self.region), 0)]);
        let is_settled = |worst: &PriorityItem<RegionQueueEntry<'_>>, n_divided| {
            // Within the tolerance, pieces are divided further only for a tighter bound.
            let fits = worst.bound <= tolerance;
            fits && (n_divided >= proof.pieces || worst.bound <= 0.5 * tolerance)
                || worst.item.depth > DEEPEST
        };
        let bound = branch_and_bound(open, MOST_PIECES, is_settled, |worst, open| {
            let depth = worst.depth + 1;
            match worst.piece {
                RegionPiece::Patch(patch, off) => {
                    for half in patch.halves_u() {
                        for quarter in half.halves_v() {
                            open.push(self.queue_entry(RegionPiece::Patch(Box::new(quarter), off), depth));
                        }
                    }
                }
                RegionPiece::Extraordinary(extraordinary) => {
                    for quarter in extraordinary.quarters()? {
                        match quarter {
                            QuadPatchTree::Extraordinary(extraordinary) => {
                                open.push(self.queue_entry(RegionPiece::Extraordinary(extraordinary), depth))
                            }
                            QuadPatchTree::Regular(patches) => {
                                for piece in &patches.patches {
                                    let patch = Box::new(piece.patch);
                                    open.push(
                                        self.queue_entry(RegionPiece::Patch(patch, patches.off), depth),
                                    );
                                }
                            }
                        }
                    }
                }
            }
            Ok::<_, InvalidCage>(())
        });
        bound.ok()
    }

    fn queue_entry<'b>(&self, piece: RegionPiece<'b>, depth: usize) -> PriorityItem<RegionQueueEntry<'b>> {
        let bound = match &piece {
            RegionPiece::Patch(patch, off) => self.distance(patch.control.as_flattened()) + off,
            RegionPiece::Extraordinary(extraordinary) => {
                self.distance(extraordinary.ring().hull()) + 2.0 * extraordinary.ring().rounding()
            }
        };
        PriorityItem { bound, item: RegionQueueEntry { depth, piece } }
    }

    /// A distance bound for a piece in the convex hull of these points.
    fn distance(&self, hull: &[[f64; 3]]) -> f64 {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for point in hull {
            let flat = self.project(self.local(point));
            (low, high) = (low.min(flat), high.max(flat));
        }
        // The slack covers rounding: a dot product of three terms has five roundings of at most the largest term.
        // The first term is chosen, far above the rounding of the operations on the box; a larger box only makes the
        // bound worse.
        let reach = low.abs().max(high.abs()).max_element();
        let slack = DVec2::splat(1e-9 * (high - low).length() + 64.0 * f64::EPSILON * reach);
        let (low, high) = (low - slack, high + slack);
        let heights = |face: &ProjectedTriangle| {
            hull.iter().fold(0.0_f64, |most, point| {
                let from = self.local(point) - DVec3::from(face.corners[0]);
                most.max(from.dot(face.normal).abs())
            }) / face.cosine
        };
        let touched: Vec<&ProjectedTriangle> =
            self.faces.iter().filter(|face| may_overlap(face.projected, low, high)).collect();
        let over = touched.iter().fold(0.0_f64, |most, face| most.max(heights(face)));
        if self.is_inside(low, high) {
            return over;
        }
        let local: Vec<[f64; 3]> = hull.iter().map(|point| self.local(point).into()).collect();
        let farthest = |least: f64, face: &ProjectedTriangle| {
            let mut most = 0.0_f64;
            for point in &local {
                most = most.max(distance_up(*point, &face.corners));
                // No better than the best triangle so far.
                if most >= least {
                    return least;
                }
            }
            most
        };
        // The nearest triangle is usually one that the box touches, so the others are tried only if there is none.
        let beside = match touched.is_empty() {
            true => self.faces.iter().fold(f64::INFINITY, farthest),
            false => touched.into_iter().fold(f64::INFINITY, farthest),
        };
        over.max(beside)
    }

    /// Whether a box of the plane is covered by the triangles.
    fn is_inside(&self, low: DVec2, high: DVec2) -> bool {
        let n = self.border.len();
        let meets = |k: usize| {
            let (a, b) = (self.border[k], self.border[(k + 1) % n]);
            may_overlap([a, b, b], low, high)
        };
        // A box that meets no edge of the border is covered as a whole or not at all: its middle decides.
        let middle = 0.5 * (low + high);
        !(0..n).any(meets) && self.faces.iter().any(|face| may_overlap(face.projected, middle, middle))
    }
}

/// Whether a triangle may overlap a box; only `false` is certain.
fn may_overlap(corners: [DVec2; 3], low: DVec2, high: DVec2) -> bool {
    let [a, b, c] = corners;
    let (least, most) = (a.min(b).min(c), a.max(b).max(c));
    if least.x > high.x || least.y > high.y || most.x < low.x || most.y < low.y {
        return false;
    }
    let box_corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    let corners_of_triangle = [a, b, c];
    (0..3).all(|k| {
        let (p, along) = (corners_of_triangle[k], corners_of_triangle[(k + 1) % 3] - corners_of_triangle[k]);
        let across = DVec2::new(-along.y, along.x);
        let side = |q: DVec2| across.dot(q - p);
        // The box is on one side of the line, with a margin for rounding, and the triangle on the other side. The
        // margin is chosen far above rounding.
        let margin = 1e-12 * along.length() * ((high - low).length() + (most - least).length());
        let apex = side(corners_of_triangle[(k + 2) % 3]);
        let before = box_corners.iter().all(|corner| side(*corner) < -margin) && apex >= 0.0;
        let beyond = box_corners.iter().all(|corner| side(*corner) > margin) && apex <= 0.0;
        !before && !beyond
    })
}

/// A hull of the border's curve is subdivided if it is farther from its chord than this fraction of the tolerance. Chosen:
/// smaller takes more subdivisions for a slightly smaller bound.
const FINE: f64 = 0.1;
/// The largest depth of subdivision: 2⁻⁴⁵ of a face is below rounding.
const DEEPEST: usize = 45;
/// Pieces that are visited even after the tolerance is met, so that the bound becomes tight. Chosen: so few cost little
/// time.
const PIECES_FOR_TIGHTNESS: usize = 24;
/// The most pieces that are visited. Chosen: with more, a tile is refined instead.
const MOST_PIECES: usize = 400;

enum RegionBoundary<'a> {
    Patches(&'a LimitPatches),
    Extraordinary(&'a ExtraordinaryQuad),
}

impl<'a> RegionBoundary<'a> {
    fn from_square(square: &'a QuadPatchTree) -> Self {
        match square {
            QuadPatchTree::Regular(patches) => Self::Patches(patches),
            QuadPatchTree::Extraordinary(extraordinary) => Self::Extraordinary(extraordinary),
        }
    }
}

/// The quarters on a side, in the order of its parameter.
fn quarters_on(side: PatchSide) -> [usize; 2] {
    match side {
        PatchSide::Bottom => [0, 1],
        PatchSide::Right => [1, 2],
        PatchSide::Top => [3, 2],
        PatchSide::Left => [0, 3],
    }
}

/// The boundary curves of patches along a span of a side.
fn side_curves(patches: &LimitPatches, side: PatchSide, [from, to]: [f64; 2]) -> Vec<Bezier<3>> {
    let mut curves = Vec::new();
    for piece in &patches.patches {
        let (is_on, span) = match side {
            PatchSide::Bottom => (piece.v[0] == 0.0, piece.u),
            PatchSide::Right => (piece.u[1] == 1.0, piece.v),
            PatchSide::Top => (piece.v[1] == 1.0, piece.u),
            PatchSide::Left => (piece.u[0] == 0.0, piece.v),
        };
        let (low, high) = (from.max(span[0]), to.min(span[1]));
        if is_on && low < high {
            let curve = piece.patch.side(side);
            // In the order of the parameter.
            let curve =
                if matches!(side, PatchSide::Top | PatchSide::Left) { curve.reversed() } else { curve };
            let local = |x: f64| (x - span[0]) / (span[1] - span[0]);
            curves.push(curve.part(local(low), local(high)));
        }
    }
    curves
}

fn distance_to_segment(p: DVec3, [a, b]: [DVec3; 2]) -> f64 {
    let along = b - a;
    let length_sq = along.length_squared();
    let t = if length_sq > 0.0 { ((p - a).dot(along) / length_sq).clamp(0.0, 1.0) } else { 0.0 };
    (p - (a + along * t)).length()
}

fn planar_distance_to_segment(p: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    distance_to_segment(p.extend(0.0), [a.extend(0.0), b.extend(0.0)])
}

enum RegionPiece<'a> {
    Patch(Box<Patch>, f64),
    Extraordinary(&'a ExtraordinaryQuad),
}

/// A piece of the surface and its depth of subdivision.
struct RegionQueueEntry<'a> {
    depth: usize,
    piece: RegionPiece<'a>,
}
