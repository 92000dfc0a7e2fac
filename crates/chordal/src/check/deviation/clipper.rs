//! `ConvexClipper`: clips a piece to a face, conservatively in rounded arithmetic.
use super::distance::distance_up;
use super::projection::SubtriangleProjection;
use super::subtriangle::MeshSubtriangle;
use crate::math::{greater, lesser};

/// Clips a piece to the image of a face, rounded outwards.
///
/// Corners of the polygon are kept with their images. Let `E` be the largest difference along an axis between
/// images of corners of piece and face, and `R` the largest coordinate of the piece in space. The polygon of
/// rounded corners is accompanied by an exact one: it starts as the piece itself, and where a side from `p`
/// to `q` is cut at the computed number `0 ≤ t ≤ 1`, its corner is exactly `p + t(q − p)`, in space and in
/// the plane. Rounding adds, along each axis and for each cut, three times `ε/2` of numbers up to `E`: 1.5 εE
/// in the plane, where a corner of the piece is zero; in space, with `L` the piece's largest difference along
/// an axis, `εL + ½εR`.
///
/// One cut keeps the part left of a line along `e = b − a`, where `s(p) = e × (p − a) ≥ 0`. The computed `s`
/// of a rounded corner differs from that of the exact one by less than `4ε|e|E` (`|e|` the longer component;
/// two products of three roundings each and a difference) and, after two cuts, by `2|e| · 3εE` for the
/// position, together `10 ε|e|E`. Below `−m` with `m = 16 ε|e|E` a corner of the exact polygon is therefore
/// right of the line. Where a side runs from a corner above `−m` to one below, `t` is where the computed `s`
/// would be `−m`; its own three roundings move `s` by less than `1.5ε · 2.1|e|E`, so that the new corner of
/// the exact polygon is not left of the line. Hence the exact polygon, whose corners stay on the sides of the
/// previous convex one, keeps everything left of the line; and each of its points is as close to the span of
/// the computed corners as those are to its own: `√3(εL + ½εR)` a cut.
pub(super) struct ConvexClipper<'a> {
    view: &'a SubtriangleProjection,
    /// `√3(εL + ½εR)`, rounded up.
    displacement: f64,
}

/// The most corners after three cuts, even where rounding makes a line meet the polygon more than twice: a
/// triangle gets 4 at most, those 6, and those 9.
const MOST: usize = 9;

impl<'a> ConvexClipper<'a> {
    /// A clipper for a piece and its projection.
    pub fn new(view: &'a SubtriangleProjection, piece: &MeshSubtriangle) -> Self {
        let corners = piece.corners.map(|corner| corner.at);
        let reach = corners.as_flattened().iter().fold(0.0, |most, x| greater(most, x.abs()));
        let width = |k: usize| {
            let [ab, bc, ca] = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (corners[i][k] - corners[j][k]).abs());
            greater(greater(ab, bc), ca)
        };
        let width = greater(greater(width(0), width(1)), width(2));
        Self { view, displacement: f64::EPSILON * (1.8 * width + 0.9 * reach) } // √3 and √3/2, rounded up
    }

    /// An upper bound on the distance from the part of the piece over the face to the face, and the farthest
    /// corner of that part. `face_image` is counter-clockwise.
    pub fn farthest(
        &self,
        piece: &MeshSubtriangle,
        face_image: [[f64; 2]; 3],
        corners: &[[f64; 3]; 3],
    ) -> (f64, [f64; 3]) {
        let mut polygon = ClippedPolygon { at: [[0.0; 3]; MOST], image: [[0.0; 2]; MOST], n: 0 };
        for corner in &piece.corners {
            polygon.push(corner.at, self.view.project(corner.at));
        }
        let margin = 16.0 * f64::EPSILON * self.extent(&face_image); // derived above
        let mut cuts = 0;
        for k in 0..3 {
            cuts += u32::from(cut(&mut polygon, [face_image[k], face_image[(k + 1) % 3]], margin));
        }
        let mut worst = (0.0, piece.corners[0].at);
        for &at in &polygon.at[..polygon.n] {
            let up = distance_up(at, corners);
            if up > worst.0 {
                worst = (up, at);
            }
        }
        // A cut that removed nothing moved no corner.
        if cuts > 0 {
            worst.0 = (worst.0 + f64::from(cuts) * self.displacement).next_up();
        }
        worst
    }

    /// The largest difference of two coordinates along one axis.
    fn extent(&self, image: &[[f64; 2]; 3]) -> f64 {
        let all = || image.iter().chain(&self.view.piece);
        (0..2).fold(0.0, |most, k| {
            let low = all().fold(f64::INFINITY, |low, p| lesser(p[k], low));
            let high = all().fold(f64::NEG_INFINITY, |high, p| greater(p[k], high));
            greater(most, high - low)
        })
    }
}

/// Removes the part right of a line; returns whether new corners arose.
fn cut(polygon: &mut ClippedPolygon, [a, b]: [[f64; 2]; 2], margin: f64) -> bool {
    let e = [b[0] - a[0], b[1] - a[1]];
    // Products that underflow lose less than the smallest normal number.
    // Slightly right of the line still counts as left: the remaining polygon may be too large,
    // which costs sharpness, but never too small, which would leave points uncovered.
    let least = -(margin * greater(e[0].abs(), e[1].abs()) + f64::MIN_POSITIVE);
    let old = *polygon;
    let mut sides = [0.0; MOST];
    for (side, p) in sides.iter_mut().zip(&old.image[..old.n]) {
        *side = e[0] * (p[1] - a[1]) - e[1] * (p[0] - a[0]);
    }
    if sides[..old.n].iter().all(|s| *s >= least) {
        return false;
    }
    polygon.n = 0;
    for i in 0..old.n {
        let j = if i + 1 == old.n { 0 } else { i + 1 };
        let (inside, next_inside) = (sides[i] >= least, sides[j] >= least);
        if inside {
            polygon.push(old.at[i], old.image[i]);
        }
        if inside != next_inside {
            // From the kept end, in whichever direction the border runs: the same edge gives the
            // same point.
            let (from, to) = if inside { (i, j) } else { (j, i) };
            let t = (sides[from] - least) / (sides[from] - sides[to]);
            let t = lesser(t, 1.0);
            polygon.push(between(old.at[from], old.at[to], t), between(old.image[from], old.image[to], t));
        }
    }
    true
}

fn between<const D: usize>(p: [f64; D], q: [f64; D], t: f64) -> [f64; D] {
    std::array::from_fn(|k| p[k] + t * (q[k] - p[k]))
}

/// A convex polygon in space with its image.
#[derive(Clone, Copy)]
struct ClippedPolygon {
    at: [[f64; 3]; MOST],
    image: [[f64; 2]; MOST],
    n: usize,
}

impl ClippedPolygon {
    fn push(&mut self, at: [f64; 3], image: [f64; 2]) {
        self.at[self.n] = at;
        self.image[self.n] = image;
        self.n += 1;
    }
}
