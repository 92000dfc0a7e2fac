//! Polygon triangulation that keeps every corner, decides exactly and bounds the work.
//!
//! A polygon of n corners always gives n − 2 triangles that form a disc whose boundary is exactly the
//! polygon. So neighbours that share an edge still share it afterwards, even if corners lie on a straight
//! line or coincide. That is why the crate `earcut` is only the oracle of the tests: it omits such corners
//! (which opens T-junctions), decides in rounded arithmetic, and takes cubic time on self-intersecting
//! polygons.
mod blockers;
mod ears;
mod holes;
mod other_cut;

use crate::explicit::{Diagonal, Quad};
use crate::math::{cross, greater, lesser, unit_scale};
use ears::EarClipper;
use robust::{Coord, orient2d};

pub use holes::{ContourCorner, ContourRepair, InvalidPolygon, PolygonTriangles, polygon_with_holes};
pub use other_cut::other_cut_within;

/// The triangles of one polygon.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Triangulation {
    /// Indices of the polygon's corners; n − 2 rows, none for fewer than 3 corners.
    pub triangles: Vec<[u32; 3]>,
    /// The number of triangles that face backwards. 0 proves that the areas add up to the polygon's area; a
    /// self-intersecting polygon has no triangulation without such folds.
    pub folded: usize,
}

impl Triangulation {
    /// Whether the areas of the triangles add up to the area of the polygon.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.folded == 0
    }
}

/// Triangulates one polygon in space.
///
/// The polygon is projected along the largest axis of its Newell normal. This changes no coordinate, so all
/// decisions are exact for polygons within 1e-75 … 1e75 (beyond, coordinates are scaled by a power of two).
/// All triangles together have the polygon's signed area, because they form a disc with its boundary; so they
/// have its area if none faces backwards. For a polygon that is not flat this holds in that projection. If a
/// triangle folds in it, the projection along the normal itself (rounded) is used if it has fewer folds. A
/// quadrilateral that is not flat is split along the diagonal with the smaller bend ([`Quad::flattest`]), if
/// both are valid.
///
/// `points`: finite corners in order, the last one joined to the first, fewer than 2³¹. Time O(n log n) as
/// long as corners block few ears, and never more than 1,024 steps per corner; memory O(n).
///
/// ```
/// use chordal::explicit::triangulate::polygon;
///
/// // An arrowhead: the corner at the origin is concave, so the cut must start there.
/// let arrow = [[0.0, 0.0, 0.0], [-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [-1.0, 1.0, 0.0]];
/// let cut = polygon(&arrow);
/// assert_eq!(cut.triangles, [[0, 1, 2], [0, 2, 3]]);
/// assert!(cut.is_exact());
/// ```
///
/// Source: G. H. Meisters, *Polygons have ears*, 1975; M. Held, *FIST: fast industrial-strength triangulation
/// of polygons*, 2001, for polygons without ears.
#[must_use]
pub fn polygon(points: &[[f64; 3]]) -> Triangulation {
    let mut triangles = Vec::new();
    let folded = Triangulator::default().polygon(points, &mut triangles);
    Triangulation { triangles, folded }
}

/// [`polygon`] with reusable buffers, for meshes of many polygons.
#[derive(Clone, Debug, Default)]
pub struct Triangulator {
    flat: Vec<[f64; 2]>,
    second: Vec<[u32; 3]>,
    ears: EarClipper,
}

impl Triangulator {
    /// Appends the triangles of one polygon to `out` and returns the number that face backwards.
    pub fn polygon(&mut self, points: &[[f64; 3]], out: &mut Vec<[u32; 3]>) -> usize {
        match points.len() {
            0..=2 => return 0,
            3 => {
                out.push([0, 1, 2]);
                return 0;
            }
            _ => {}
        }
        let scale = scale_of(points);
        let normal = newell(points, scale);
        let start = out.len();
        along_axis(points, scale, normal, &mut self.flat);
        if let [a, b, c, d] = *points
            && let Some(cut) = bent_quad([a, b, c, d], &self.flat)
        {
            out.extend(cut.triangles());
            return 0;
        }
        let folded = cut(&self.flat, &mut self.ears, out);
        if folded == 0 || !along_normal(points, scale, normal, &mut self.flat) {
            return folded;
        }
        // A non-planar polygon may intersect itself in one projection but not in the other.
        self.second.clear();
        let folded_second = cut(&self.flat, &mut self.ears, &mut self.second);
        if folded_second >= folded {
            return folded;
        }
        out.truncate(start);
        out.extend_from_slice(&self.second);
        folded_second
    }
}

fn cut(flat: &[[f64; 2]], ears: &mut EarClipper, out: &mut Vec<[u32; 3]>) -> usize {
    match *flat {
        [a, b, c, d] => quad([a, b, c, d], out),
        _ => ears.cut(flat, out),
    }
}

/// Positive for a left turn `a`, `b`, `c`; the sign is exact.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let coord = |[x, y]: [f64; 2]| Coord { x, y };
    orient2d(coord(a), coord(b), coord(c))
}

/// The diagonal with the smaller bend, for a quadrilateral that is not flat and can be split along either.
fn bent_quad(corners: [[f64; 3]; 4], flat: &[[f64; 2]]) -> Option<Diagonal> {
    let [a, b, c, d] = *flat else { return None };
    let is_convex = turn(a, b, c) > 0.0 && turn(b, c, d) > 0.0 && turn(c, d, a) > 0.0 && turn(d, a, b) > 0.0;
    let quad = Quad { corners };
    (is_convex && !quad.is_flat()).then(|| quad.flattest())
}

/// The two triangles of a quadrilateral: split at its first corner if that is valid, otherwise at its second.
fn quad(p: [[f64; 2]; 4], out: &mut Vec<[u32; 3]>) -> usize {
    const CUTS: [[[u32; 3]; 2]; 2] = [[[0, 1, 2], [0, 2, 3]], [[1, 2, 3], [1, 3, 0]]];
    let turns = CUTS.map(|cut| cut.map(|t| turn(p[t[0] as usize], p[t[1] as usize], p[t[2] as usize])));
    let split_with = |test: fn(f64) -> bool| (0..2).find(|k| turns[*k].iter().all(|t| test(*t)));
    // Two triangles with area if possible, else two that do not face backwards, else the first split.
    let pick = split_with(|t| t > 0.0).or_else(|| split_with(|t| t >= 0.0)).unwrap_or(0);
    out.extend(CUTS[pick]);
    turns[pick].iter().filter(|t| **t < 0.0).count()
}

/// The projection of the polygon along the largest axis of its normal, counter-clockwise. Exact up to the
/// power of two.
fn along_axis(points: &[[f64; 3]], scale: f64, normal: [f64; 3], flat: &mut Vec<[f64; 2]>) {
    let [u, v] = seen_axes(points, normal);
    flat.clear();
    flat.extend(points.iter().map(|p| [p[u] * scale, p[v] * scale]));
}

/// The axes that become x and y in the view against a normal, along its largest axis. Without a normal, along
/// the axis of the points' smallest extent.
fn seen_axes(points: &[[f64; 3]], normal: [f64; 3]) -> [usize; 2] {
    let mut drop = largest_axis(normal);
    if normal[drop].is_nan() || normal[drop] == 0.0 {
        drop = thinnest(points);
    }
    let (u, v) = ((drop + 1) % 3, (drop + 2) % 3);
    if normal[drop] < 0.0 { [v, u] } else { [u, v] }
}

/// The projection of the polygon along its normal, counter-clockwise, rounded; false if it has no normal.
fn along_normal(points: &[[f64; 3]], scale: f64, normal: [f64; 3], flat: &mut Vec<[f64; 2]>) -> bool {
    let largest = normal[largest_axis(normal)].abs();
    if !(largest > 0.0 && largest.is_finite()) {
        return false;
    }
    let n = normal.map(|x| x / largest);
    // The axis farthest from the normal, made perpendicular to it, and a third axis perpendicular to both.
    let mut k = 0;
    for axis in 1..3 {
        if n[axis].abs() < n[k].abs() {
            k = axis;
        }
    }
    let mut axis = [0.0; 3];
    axis[k] = 1.0;
    let u = cross(axis, n);
    let v = cross(n, u);
    let dot = |a: [f64; 3], b: [f64; 3]| (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
    flat.clear();
    flat.extend(points.iter().map(|p| from_first(points, p, scale)).map(|p| [dot(p, u), dot(p, v)]));
    true
}

fn largest_axis(normal: [f64; 3]) -> usize {
    let size = normal.map(f64::abs);
    let largest = usize::from(size[1] > size[0]);
    if size[2] > size[largest] { 2 } else { largest }
}

fn from_first(points: &[[f64; 3]], p: &[f64; 3], scale: f64) -> [f64; 3] {
    std::array::from_fn(|k| p[k] * scale - points[0][k] * scale)
}

/// [`unit_scale`] for extreme polygons, 1 for all others.
fn scale_of(points: &[[f64; 3]]) -> f64 {
    let scale = unit_scale(points);
    // 2^±250 ≈ 1e±75: squares of sums, and their rounding errors, stay inside the range of f64 (2^±1022).
    let (low, high) = (f64::from_bits((1023 - 250) << 52), f64::from_bits((1023 + 250) << 52));
    if scale >= low && scale <= high { 1.0 } else { scale }
}

/// Twice the polygon's vector area (Newell's normal), after scaling.
fn newell(points: &[[f64; 3]], scale: f64) -> [f64; 3] {
    points.windows(2).skip(1).fold([0.0; 3], |sum, pair| {
        let term = cross(from_first(points, &pair[0], scale), from_first(points, &pair[1], scale));
        std::array::from_fn(|k| sum[k] + term[k])
    })
}

/// The axis along which the points have the smallest extent.
fn thinnest(points: &[[f64; 3]]) -> usize {
    let extent = |k: usize| {
        let low = points.iter().fold(f64::INFINITY, |m, p| lesser(p[k], m));
        let high = points.iter().fold(f64::NEG_INFINITY, |m, p| greater(p[k], m));
        0.5 * high - 0.5 * low
    };
    let extents = [extent(0), extent(1), extent(2)];
    let mut thinnest = 0;
    for k in 1..3 {
        if extents[k] < extents[thinnest] {
            thinnest = k;
        }
    }
    thinnest
}
