//! Faces whose limit surface consists of bicubic patches: four quads around each corner, or fewer if a sharp
//! line cuts them off.
//!
//! Along a sharp line the surface is the same tensor product of cubic splines as elsewhere, with other
//! points. If the line is infinitely sharp, the points beyond it are the reflections of those before it. If
//! it is sharp for some rounds, that holds in each of these rounds, and beyond the last of them the remaining
//! part is a smooth spline of that scale.
//!
//! Source for finite sharpness: M. Nießner, C. Loop, G. Greiner, *Efficient evaluation of semi-smooth creases
//! in Catmull-Clark subdivision surfaces*, 2012; here as a product of one-dimensional pieces, so that it also
//! holds beside borders.
use super::super::vertex_rule::CagePoint;
use super::super::{CreasingMethod, INFINITELY_SHARP, Scheme};
use super::face_one_ring::{CageTopology, FaceOneRing};
use crate::explicit::Patch;
use crate::math::lesser;

/// A part of a face that is one bicubic patch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LimitPatch {
    /// Its parameter rectangle in the face.
    pub u: [f64; 2],
    pub v: [f64; 2],
    pub patch: Patch,
}

impl LimitPatch {
    /// Maps parameters of the face to the patch's unit square.
    pub(super) fn local(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let local = |x: f64, [from, to]: [f64; 2]| (x - from) / (to - from);
        [local(u, self.u), local(v, self.v)]
    }
}

/// The control points of a tensor product of cubic splines, and the finite sharpness of its side lines.
struct CreasedBSpline {
    /// Rows along u.
    points: [[CagePoint; 4]; 4],
    /// The sharpness of the sides where u is 0 and 1.
    u: [f64; 2],
    v: [f64; 2],
}

impl FaceOneRing {
    /// The patches of the face's limit surface, if it consists of patches.
    pub(crate) fn patches(&self) -> Option<Vec<LimitPatch>> {
        if self.n_corners() != 4 {
            return None;
        }
        if self.cage().scheme == Scheme::Bilinear {
            return Some(vec![self.bilinear_patch()]);
        }
        let spline = self.spline(&self.topology())?;
        let (along_u, along_v) = (spans(spline.u), spans(spline.v));
        let mut pieces = Vec::with_capacity(along_u.len() * along_v.len());
        for v in &along_v {
            for u in &along_u {
                let rows = spline.points.map(|row| u.bezier_points(row));
                let columns: [[CagePoint; 4]; 4] = std::array::from_fn(|j| {
                    v.bezier_points([rows[0][j], rows[1][j], rows[2][j], rows[3][j]])
                });
                let control = std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]));
                pieces.push(LimitPatch { u: u.span, v: v.span, patch: Patch { control } });
            }
        }
        Some(pieces)
    }

    fn bilinear_patch(&self) -> LimitPatch {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.cage().positions[self.cage().corners[k] as usize]);
        let mix = |p: CagePoint, q: CagePoint, t: f64| [0, 1, 2].map(|k| p[k] * (1.0 - t) + q[k] * t);
        let third = |k: usize| k as f64 / 3.0;
        let row = |i: usize| (mix(a, d, third(i)), mix(b, c, third(i)));
        let control = std::array::from_fn(|i| std::array::from_fn(|j| mix(row(i).0, row(i).1, third(j))));
        LimitPatch { u: [0.0, 1.0], v: [0.0, 1.0], patch: Patch { control } }
    }

    fn spline(&self, parts: &CageTopology) -> Option<CreasedBSpline> {
        let cage = self.cage();
        let vertex: [u32; 4] = std::array::from_fn(|k| cage.corners[k]);
        let edge: [u32; 4] = std::array::from_fn(|k| parts.edges.of_corner[k]);
        let line = edge.map(|edge| parts.sharp.edges[edge as usize]);
        let is_cut = line.map(|sharpness| sharpness >= INFINITELY_SHARP);
        // For the faces across the sides, the vertices next to the side's start and end.
        let mut beside = [[u32::MAX; 2]; 4];
        for side in (0..4).filter(|side| !is_cut[*side]) {
            let across = *parts.edges.faces(edge[side] as usize).iter().find(|face| **face != 0)?;
            let face = cage.face(across as usize);
            let (from, to) = (vertex[side], vertex[(side + 1) % 4]);
            beside[side] = [neighbour(face, from, to)?, neighbour(face, to, from)?];
        }
        let mut corners = [[0.0; 3]; 4];
        for k in 0..4 {
            let before = (k + 3) % 4;
            let vertex_sharpness = parts.sharp.vertices[vertex[k] as usize];
            let around = parts.incidence.edges(vertex[k] as usize);
            let sharpness = |edge: u32| parts.sharp.edges[edge as usize];
            // The edges that continue the two lines through the corner.
            let continuation = |side: usize, end: usize| {
                (!is_cut[side]).then(|| parts.edges.between(vertex[k], beside[side][end])).flatten()
            };
            let (back, forth) = (continuation(before, 1), continuation(k, 0));
            match (is_cut[k], is_cut[before]) {
                // Two cut sides: the points beyond are reflected in both lines, which is right at a
                // fixed corner alone.
                (true, true) => {
                    let n_infinite = around.iter().filter(|e| sharpness(**e) >= INFINITELY_SHARP).count();
                    if vertex_sharpness < INFINITELY_SHARP && n_infinite < 3 {
                        return None;
                    }
                }
                // A regular vertex, where finite lines go straight on.
                (false, false) => {
                    let (back, forth) = (back?, forth?);
                    let faces = parts.incidence.faces(vertex[k] as usize);
                    let are_both_sharp = line[k] > 0.0 && line[before] > 0.0;
                    let is_regular =
                        vertex_sharpness == 0.0 && around.len() == 4 && faces.len() == 4 && !are_both_sharp;
                    if !is_regular || sharpness(back) != line[k] || sharpness(forth) != line[before] {
                        return None;
                    }
                    let has = |face: &&u32| {
                        parts.edges.faces(back as usize).contains(face)
                            && parts.edges.faces(forth as usize).contains(face)
                    };
                    let face = cage.face(*faces.iter().find(has)? as usize);
                    let corner = opposite(face, vertex[k])?;
                    corners[k] = cage.positions[corner as usize];
                }
                // One line passes the corner, from one side of the face on.
                (is_cut_here, _) => {
                    let (onward, other) = if is_cut_here { (back?, line[before]) } else { (forth?, line[k]) };
                    let sharp = if is_cut_here { edge[k] } else { edge[before] };
                    let others = around.iter().filter(|e| **e != onward && **e != sharp);
                    let fits = |edge: &u32| sharpness(*edge) == 0.0 || sharpness(*edge) == other;
                    // Between two faces with two common sides the line ends.
                    let goes_on = onward != sharp && sharpness(onward) >= INFINITELY_SHARP;
                    let is_one_line = goes_on && others.clone().all(fits);
                    let is_mixed = other > 0.0 && self.cage().creasing == CreasingMethod::Chaikin;
                    if vertex_sharpness > 0.0 || !is_one_line || is_mixed {
                        return None;
                    }
                }
            }
        }
        //    p[3][0]   p[3][1]    p[3][2]   p[3][3]
        //    p[2][0]    v3 ──[2]── v2       p[2][3]     v0 … v3: the corners of the face
        //                [3]       [1]                  [0] … [3]: its sides
        //    p[1][0]    v0 ──[0]── v1       p[1][3]
        //    p[0][0]   p[0][1]    p[0][2]   p[0][3]
        let at = |vertex: u32| cage.positions.get(vertex as usize).copied().unwrap_or_default();
        let mut p = [[[0.0; 3]; 4]; 4];
        ([p[1][1], p[1][2], p[2][2], p[2][1]], [p[0][0], p[0][3], p[3][3], p[3][0]]) =
            (vertex.map(at), corners);
        [p[0][1], p[0][2]] = beside[0].map(at);
        [p[1][3], p[2][3]] = beside[1].map(at);
        [p[3][2], p[3][1]] = beside[2].map(at);
        [p[2][0], p[1][0]] = beside[3].map(at);
        let mirror = |a: CagePoint, b: CagePoint| [0, 1, 2].map(|k| 2.0 * a[k] - b[k]);
        for row in &mut p {
            if is_cut[3] {
                row[0] = mirror(row[1], row[2]);
            }
            if is_cut[1] {
                row[3] = mirror(row[2], row[1]);
            }
        }
        if is_cut[0] {
            p[0] = std::array::from_fn(|j| mirror(p[1][j], p[2][j]));
        }
        if is_cut[2] {
            p[3] = std::array::from_fn(|j| mirror(p[2][j], p[1][j]));
        }
        let finite = |side: usize| if is_cut[side] { 0.0 } else { line[side] };
        Some(CreasedBSpline { points: p, u: [finite(3), finite(1)], v: [finite(0), finite(2)] })
    }
}

/// The neighbour of a vertex in a quad that is not `other`.
fn neighbour(quad: &[u32], vertex: u32, other: u32) -> Option<u32> {
    let k = quad.iter().position(|v| *v == vertex).filter(|_| quad.len() == 4)?;
    let (next, last) = (quad[(k + 1) % 4], quad[(k + 3) % 4]);
    match (next == other, last == other) {
        (true, false) => Some(last),
        (false, true) => Some(next),
        _ => None,
    }
}

/// The vertex of a quad diagonally opposite to another.
fn opposite(quad: &[u32], vertex: u32) -> Option<u32> {
    let k = quad.iter().position(|v| *v == vertex).filter(|_| quad.len() == 4)?;
    Some(quad[(k + 2) % 4])
}

type SpanWeights = [f64; 4];

/// A span in one direction: the weights of the four points in each control point of its Bézier form.
struct SplineSpan {
    span: [f64; 2],
    weights: [SpanWeights; 4],
}

impl SplineSpan {
    fn bezier_points(&self, points: [CagePoint; 4]) -> [CagePoint; 4] {
        self.weights.map(|w| {
            [0, 1, 2].map(|k| {
                (w[0] * points[0][k] + w[1] * points[1][k]) + (w[2] * points[2][k] + w[3] * points[3][k])
            })
        })
    }
}

/// The weights of the four points in themselves.
const POINTS: [SpanWeights; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

fn mean(share: f64, a: SpanWeights, b: SpanWeights) -> SpanWeights {
    std::array::from_fn(|k| share * a[k] + (1.0 - share) * b[k])
}

/// The mean of three with the weights `1/8, 6/8, 1/8`.
fn vertex_mask([a, b, c]: [SpanWeights; 3]) -> SpanWeights {
    std::array::from_fn(|k| 0.125 * (a[k] + c[k]) + 0.75 * b[k])
}

/// The Bézier form of a smooth spline's span.
fn bezier_span(p: [SpanWeights; 4], span: [f64; 2]) -> SplineSpan {
    let mix = |share: [f64; 4]| {
        std::array::from_fn(|k| {
            ((share[0] * p[0][k] + share[1] * p[1][k]) + (share[2] * p[2][k] + share[3] * p[3][k])) / 6.0
        })
    };
    let weights = [
        mix([1.0, 4.0, 1.0, 0.0]),
        mix([0.0, 4.0, 2.0, 0.0]),
        mix([0.0, 2.0, 4.0, 0.0]),
        mix([0.0, 1.0, 4.0, 1.0]),
    ];
    SplineSpan { span, weights }
}

/// The spans of one direction between two lines of finite sharpness.
fn spans(sharp: [f64; 2]) -> Vec<SplineSpan> {
    match sharp {
        [0.0, 0.0] => vec![bezier_span(POINTS, [0.0, 1.0])],
        [sharp, 0.0] => spans_from_crease(POINTS, sharp),
        [0.0, sharp] => reversed(spans_from_crease(reversed_points(POINTS), sharp)),
        // One round, with half the span next to each line.
        [first, second] => {
            let [low, high] = refine_between_creases(POINTS, [first, second]);
            let less = |sharp: f64| if sharp > 1.0 { sharp - 1.0 } else { 0.0 };
            let mut spans = Vec::new();
            let halves = [
                (spans_from_crease(low, less(first)), 0.0),
                (reversed(spans_from_crease(reversed_points(high), less(second))), 0.5),
            ];
            for (parts, begin) in halves {
                let shifted = parts.into_iter().map(|part| SplineSpan {
                    span: part.span.map(|x| begin + 0.5 * x),
                    weights: part.weights,
                });
                spans.extend(shifted);
            }
            spans
        }
    }
}

fn reversed_points(p: [SpanWeights; 4]) -> [SpanWeights; 4] {
    [p[3], p[2], p[1], p[0]]
}

fn reversed(parts: Vec<SplineSpan>) -> Vec<SplineSpan> {
    let turn = |part: SplineSpan| SplineSpan {
        span: [1.0 - part.span[1], 1.0 - part.span[0]],
        weights: reversed_points(part.weights),
    };
    parts.into_iter().rev().map(turn).collect()
}

/// A round between two lines with this sharpness: the points of the lower half and of the upper one.
fn refine_between_creases(p: [SpanWeights; 4], sharp: [f64; 2]) -> [[SpanWeights; 4]; 2] {
    let share = sharp.map(|s| lesser(s, 1.0));
    let (low, high) = (
        mean(share[0], p[1], vertex_mask([p[0], p[1], p[2]])),
        mean(share[1], p[2], vertex_mask([p[1], p[2], p[3]])),
    );
    let between = [0, 1, 2].map(|k| mean(0.5, p[k], p[k + 1]));
    [[between[0], low, between[1], high], [low, between[1], high, between[2]]]
}

/// The spans from a line with this sharpness, at the start, to a smooth end.
fn spans_from_crease(mut p: [SpanWeights; 4], mut sharp: f64) -> Vec<SplineSpan> {
    let mut parts = Vec::new();
    let mut width = 1.0;
    if sharp >= 1.0 {
        // As if the line stayed sharp; valid except next to the line in the end.
        let mirrored = std::array::from_fn(|k| 2.0 * p[1][k] - p[2][k]);
        let away = bezier_span([mirrored, p[1], p[2], p[3]], [0.0, 1.0]);
        while sharp >= 1.0 {
            [p, _] = refine_between_creases(p, [sharp, 0.0]);
            sharp -= 1.0;
            width *= 0.5;
        }
        parts.push(SplineSpan { span: [width, 1.0], weights: restrict_from(away.weights, width) });
    }
    if sharp > 0.0 {
        let [low, high] = refine_between_creases(p, [sharp, 0.0]);
        parts.push(bezier_span(high, [0.5 * width, width]));
        parts.push(bezier_span(low, [0.0, 0.5 * width]));
    } else {
        parts.push(bezier_span(p, [0.0, width]));
    }
    parts.reverse();
    parts
}

/// The Bézier form restricted to the part from a parameter on.
fn restrict_from([a, b, c, d]: [SpanWeights; 4], from: f64) -> [SpanWeights; 4] {
    let at = |p: SpanWeights, q: SpanWeights| mean(1.0 - from, p, q);
    let (ab, bc, cd) = (at(a, b), at(b, c), at(c, d));
    let (abc, bcd) = (at(ab, bc), at(bc, cd));
    [at(abc, bcd), bcd, cd, d]
}
