//! Triangulation of polygons with holes: exact decisions, a check, and a report of every repair.
use super::{along_axis, along_normal, newell, scale_of, seen_axes};
use crate::budget::Job;
use crate::explicit::fill::arrange::{ArrangeError, GridContour, arrange};
use crate::explicit::fill::snap_grid::SnapGrid;
use crate::explicit::fill::sweep::{InsideRule, SweepEdge, SweepPoint, sweep};
use crate::explicit::fill::{FillTriangles, fill};
use crate::math::{Orientation, difference, dot, greater, length, lesser, orient2d, unit_scale};
use std::borrow::Cow;
use std::cmp::Ordering;
use std::fmt;

/// The triangles of a polygon with holes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PolygonTriangles<P> {
    /// Counter-clockwise about the normal of the outer contour. Indices of corners: first those of the outer
    /// contour, then those of the holes one after the other, then `added`.
    pub triangles: Vec<[u32; 3]>,
    /// New points at crossings of sides.
    pub added: Vec<P>,
    /// The repairs of the contours; none for simple, disjoint contours.
    pub repairs: Vec<ContourRepair>,
    /// The largest distance of a corner from the plane fitted to the outer contour, rounded; 0 in the plane.
    pub warp: f64,
}

impl<P> PolygonTriangles<P> {
    /// Whether the contours were simple and disjoint, and the holes inside. Then n + 2h − 2 triangles, all
    /// with area, cover the enclosed region once.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.repairs.is_empty()
    }
}

/// A defect of the contours and its repair. All except the last keep every corner in its position. All except
/// the last three keep the area: that of the outer contour minus those of the holes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContourRepair {
    /// This many contours have fewer than three distinct corners. They enclose nothing and are ignored.
    Empty(usize),
    /// This many corners coincide with an earlier one, which replaces them. Corners that only close their
    /// contour are not counted.
    Repeated(usize),
    /// Contours touch themselves or each other at this many points. Sides are split there.
    Touching(usize),
    /// This many sides, or parts, lie on others: spikes, and contours that share sides. They count as one, or
    /// as none if they run in opposite directions. A region that a contour winds around twice counts once.
    Overlapping(usize),
    /// This many sides, or parts, do not separate inside from outside: those of holes outside or in another
    /// hole, and those that a hole shares with its surroundings. They are ignored.
    Outside(usize),
    /// This many sides, or parts, run backwards around the region they enclose: a contour crosses itself at a
    /// corner. The region they enclose counts as inside too.
    Backwards(usize),
    /// Sides cross. They are rerouted through the crossings, rounded to a grid of 2⁻³⁶ of the polygon's size.
    /// The filled region is the one that the outer contour winds around and the holes do not.
    Crossing {
        /// The largest distance by which a side may have moved.
        moved_at_most: f64,
        /// The number of triangles that face backwards because corners lie closer than that.
        folded: usize,
    },
}

/// The reason why a polygon cannot be triangulated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InvalidPolygon {
    /// A coordinate is NaN or infinite.
    NotFinite {
        /// The contour: 0 is the outer one.
        contour: usize,
        /// The corner.
        corner: usize,
    },
    /// There are more than 2³⁰ corners.
    TooManyCorners(usize),
    /// There are too many crossings of sides to compute.
    TooManyCrossings,
    /// The triangles do not cover the enclosed region: a bug in this library, found by its check.
    Fault,
}

impl fmt::Display for InvalidPolygon {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { contour, corner } => {
                write!(f, "corner {corner} of contour {contour} is not finite")
            }
            Self::TooManyCorners(n) => write!(f, "{n} corners are more than the {MOST} that are cut at once"),
            Self::TooManyCrossings => {
                write!(f, "so many sides cross each other that their crossings are not computed")
            }
            Self::Fault => {
                write!(f, "the triangles do not cover what the contours enclose: a fault in the program")
            }
        }
    }
}

impl std::error::Error for InvalidPolygon {}

/// The most corners of one polygon: sides may be split in two, and are counted in 32 bits.
const MOST: usize = 1 << 30;

/// A corner in the plane (`[f64; 2]`) or in space (`[f64; 3]`).
pub trait ContourCorner: Copy + sealed::Flatten {}

impl ContourCorner for [f64; 2] {}
impl ContourCorner for [f64; 3] {}

mod sealed {
    use std::borrow::Cow;

    /// Projections of a polygon to a plane.
    pub trait Flatten: Sized {
        /// The data of a projection.
        type Frame;

        fn is_finite(&self) -> bool;
        /// The frame of all corners, the first `outer` of which belong to the outer contour.
        fn frame(corners: &[Self], outer: usize) -> Self::Frame;
        /// The projection of all corners along an axis, with coordinates unchanged up to a power of two.
        fn along_axis<'a>(corners: &'a [Self], frame: &Self::Frame) -> Cow<'a, [[f64; 2]]>;
        /// The projection along the normal, if it differs.
        fn along_normal(corners: &[Self], frame: &Self::Frame) -> Option<Vec<[f64; 2]>>;
        /// The point of the polygon's plane that projects exactly to `p`.
        fn lift(p: [f64; 2], frame: &Self::Frame) -> Self;
        /// The power of two, and the largest distance of a corner from the plane.
        fn scale_and_warp(frame: &Self::Frame) -> [f64; 2];
    }
}

impl sealed::Flatten for [f64; 2] {
    type Frame = ();

    fn is_finite(&self) -> bool {
        self.iter().all(|x| x.is_finite())
    }

    fn frame(_: &[Self], _: usize) {}

    fn along_axis<'a>(corners: &'a [Self], (): &()) -> Cow<'a, [[f64; 2]]> {
        Cow::Borrowed(corners)
    }

    fn along_normal(_: &[Self], (): &()) -> Option<Vec<[f64; 2]>> {
        None
    }

    fn lift(p: [f64; 2], (): &()) -> Self {
        p
    }

    fn scale_and_warp((): &()) -> [f64; 2] {
        [1.0, 0.0]
    }
}

impl sealed::Flatten for [f64; 3] {
    type Frame = FittedPlane;

    fn is_finite(&self) -> bool {
        self.iter().all(|x| x.is_finite())
    }

    fn frame(corners: &[Self], outer: usize) -> FittedPlane {
        let scale = scale_of(corners);
        let newell = newell(&corners[..outer], scale);
        let mut plane = FittedPlane::fit(&corners[..outer], scale, newell);
        plane.axes = seen_axes(corners, newell);
        let warp = corners.iter().map(|p| plane.height(p.map(|x| x * scale)).abs());
        plane.warp = warp.fold(0.0, |largest, h| greater(h, largest)) / scale;
        plane
    }

    fn along_axis<'a>(corners: &'a [Self], plane: &FittedPlane) -> Cow<'a, [[f64; 2]]> {
        let mut flat = Vec::with_capacity(corners.len());
        along_axis(corners, plane.scale, plane.newell, &mut flat);
        Cow::Owned(flat)
    }

    fn along_normal(corners: &[Self], plane: &FittedPlane) -> Option<Vec<[f64; 2]>> {
        let mut flat = Vec::with_capacity(corners.len());
        along_normal(corners, plane.scale, plane.newell, &mut flat).then_some(flat)
    }

    fn lift(p: [f64; 2], plane: &FittedPlane) -> Self {
        plane.lift(p).map(|x| x / plane.scale)
    }

    fn scale_and_warp(plane: &FittedPlane) -> [f64; 2] {
        [plane.scale, plane.warp]
    }
}

/// The plane through the centroid of an outer contour's corners, in scaled coordinates.
#[derive(Clone, Copy)]
pub struct FittedPlane {
    scale: f64,
    /// Twice the vector area of the outer contour.
    newell: [f64; 3],
    /// The axes that become x and y.
    axes: [usize; 2],
    middle: [f64; 3],
    /// Of length 1, or 0 for a contour without area.
    normal: [f64; 3],
    /// In unscaled coordinates.
    warp: f64,
}

impl FittedPlane {
    fn fit(points: &[[f64; 3]], scale: f64, newell: [f64; 3]) -> Self {
        let n = points.len() as f64;
        let mut middle = [0.0; 3];
        points.iter().for_each(|p| (0..3).for_each(|k| middle[k] += p[k] * scale / n));
        let size = newell.iter().fold(0.0, |m: f64, x| greater(x.abs(), m));
        let unit = newell.map(|x| if size > 0.0 { x / size } else { 0.0 });
        let long = length(unit);
        let normal = unit.map(|x| if long > 0.0 { x / long } else { 0.0 });
        Self { scale, newell, axes: [0, 1], middle, normal, warp: 0.0 }
    }

    fn height(&self, p: [f64; 3]) -> f64 {
        dot(difference(p, self.middle), self.normal)
    }

    /// The point of the plane that projects to `p` along the largest axis of the normal.
    fn lift(&self, p: [f64; 2]) -> [f64; 3] {
        let [u, v] = self.axes;
        let w = 3 - u - v;
        let mut lifted = self.middle;
        (lifted[u], lifted[v]) = (p[0], p[1]);
        let height = self.height(lifted) / self.normal[w];
        // Without a normal there is no plane to lift to.
        if height.is_finite() {
            lifted[w] -= height;
        }
        lifted
    }
}

impl SweepPoint for [f64; 2] {
    #[inline]
    fn turn(a: Self, b: Self, c: Self) -> Ordering {
        // Shewchuk's first filter, with 4·2⁻⁵³ instead of his (3 + 16·2⁻⁵³)·2⁻⁵³. Above 2⁻⁹⁰⁰ the error of
        // underflow is less.
        const SHARE: f64 = 2.0 * f64::EPSILON;
        const LEAST: f64 = f64::from_bits((1023 - 900) << 52);
        let (left, right) = ((a[0] - c[0]) * (b[1] - c[1]), (a[1] - c[1]) * (b[0] - c[0]));
        let (turn, size) = (left - right, left.abs() + right.abs());
        if turn.abs() > SHARE * size && size > LEAST && size < f64::INFINITY {
            return if turn > 0.0 { Ordering::Greater } else { Ordering::Less };
        }
        match orient2d(a, b, c) {
            Orientation::Front => Ordering::Greater,
            Orientation::Flat => Ordering::Equal,
            Orientation::Back => Ordering::Less,
        }
    }
}

/// Triangulates a polygon with holes, in the plane or in space, with contours of any direction and with any
/// defects.
///
/// Every decision is exact. Contours that are simple, disjoint and properly nested give n + 2h − 2 triangles
/// on their n corners, which cover the region inside `outer` and outside all `holes` once. The sweep proves
/// that no two sides cross and that every triangle has area and is counter-clockwise; the number of triangles
/// and the sum of their areas are checked. All other contours still give triangles that cover the enclosed
/// region once, and [`PolygonTriangles::repairs`] reports their defects.
///
/// A polygon in space is projected along the largest axis of its normal, which changes no coordinate. If its
/// sides cross in that projection, the one along its normal (rounded) is tried too.
/// [`PolygonTriangles::warp`] is its deviation from a plane.
///
/// `outer` and `holes`: corners in order, in either direction, the last one joined to the first. A contour
/// may also repeat its first corner at the end, as in some files; n does not count that one, and no triangle
/// uses it. Time O(n log n) and about 0.5 µs per corner without crossings, O((n + k) log n) with k crossings;
/// memory about 150 bytes per corner.
///
/// # Errors
/// [`InvalidPolygon`]: a coordinate that is not finite, more than 2³⁰ corners, too many crossings.
///
/// ```
/// use chordal::explicit::triangulate::{ContourRepair, polygon_with_holes};
///
/// let outer = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
/// let hole = [[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]];
/// let cut = polygon_with_holes(&outer, &[hole])?;
/// assert_eq!((cut.triangles.len(), cut.is_clean()), (8 + 2 - 2, true));
///
/// let bow_tie = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]];
/// let cut = polygon_with_holes(&bow_tie, &[[[0.0; 2]; 0]; 0])?;
/// assert_eq!((cut.triangles.len(), &cut.added[..]), (2, &[[1.0, 1.0]][..]));
/// assert!(matches!(cut.repairs[..], [ContourRepair::Crossing { folded: 0, .. }]));
/// # Ok::<(), chordal::explicit::triangulate::InvalidPolygon>(())
/// ```
///
/// Sources: S. Hertel, K. Mehlhorn, *Fast triangulation of simple polygons*, 1983; M. Shamos, D. Hoey,
/// *Geometric intersection problems*, 1976; J. D. Hobby, *Practical segment intersection with finite
/// precision output*, 1999.
pub fn polygon_with_holes<P: ContourCorner, H: AsRef<[P]>>(
    outer: &[P],
    holes: &[H],
) -> Result<PolygonTriangles<P>, InvalidPolygon> {
    let mut corners = outer.to_vec();
    let mut ends = vec![outer.len()];
    for hole in holes {
        corners.extend_from_slice(hole.as_ref());
        ends.push(corners.len());
    }
    if corners.len() > MOST {
        return Err(InvalidPolygon::TooManyCorners(corners.len()));
    }
    if let Some(not_finite) = corners.iter().position(|p| !p.is_finite()) {
        let contour = ends.partition_point(|end| *end <= not_finite);
        let first = if contour == 0 { 0 } else { ends[contour - 1] };
        return Err(InvalidPolygon::NotFinite { contour, corner: not_finite - first });
    }
    let frame = P::frame(&corners, outer.len());
    let [scale, warp] = P::scale_and_warp(&frame);
    let in_polygon = |flat: PlaneTriangles| PolygonTriangles {
        triangles: flat.triangles,
        added: flat.added.into_iter().map(|p| P::lift(p, &frame)).collect(),
        repairs: flat.repairs,
        warp,
    };
    let projected = P::along_axis(&corners, &frame);
    if let Some(flat) = triangulate_exactly(&projected, &ends)? {
        return Ok(in_polygon(flat));
    }
    // A non-planar polygon may intersect itself in one projection but not in the other.
    if let Some(above) = P::along_normal(&corners, &frame)
        && let Some(flat) = triangulate_exactly(&above, &ends)?
    {
        return Ok(in_polygon(flat));
    }
    // Contours that cross in both projections need new corners at their crossings.
    triangulate_snapped(&projected, &ends, scale).map(in_polygon)
}

/// The result in the plane.
#[derive(Default)]
struct PlaneTriangles {
    triangles: Vec<[u32; 3]>,
    added: Vec<[f64; 2]>,
    repairs: Vec<ContourRepair>,
}

/// The corners of contour `k`, from the list of ends.
fn contour(ends: &[usize], k: usize) -> std::ops::Range<usize> {
    (if k == 0 { 0 } else { ends[k - 1] })..ends[k]
}

/// Distinct corners in the order of the sweep.
struct SortedCorners {
    points: Vec<[f64; 2]>,
    /// For each of them the first corner at this point.
    corner: Vec<u32>,
    /// For each corner the rank of its point.
    rank: Vec<u32>,
}

impl SortedCorners {
    fn new(corners: &[[f64; 2]]) -> Self {
        // Bits that sort like the numbers; 0 and −0 are one number.
        let key = |x: f64| {
            let bits = (x + 0.0).to_bits();
            if bits >> 63 == 0 { bits | 1 << 63 } else { !bits }
        };
        let row = |(i, p): (usize, &[f64; 2])| (key(p[0]), key(p[1]), i as u32);
        let mut rows: Vec<_> = corners.iter().enumerate().map(row).collect();
        rows.sort_unstable();
        let mut sites = Self {
            points: Vec::with_capacity(rows.len()),
            corner: Vec::with_capacity(rows.len()),
            rank: vec![0; rows.len()],
        };
        let mut last = None;
        for (x, y, i) in rows {
            if last != Some((x, y)) {
                last = Some((x, y));
                sites.points.push(corners[i as usize]);
                sites.corner.push(i);
            }
            sites.rank[i as usize] = (sites.points.len() - 1) as u32;
        }
        sites
    }

    /// The sides of all contours, without those of length zero.
    fn edges(&self, ends: &[usize], turned: &[bool]) -> Vec<SweepEdge> {
        let mut edges = Vec::with_capacity(self.rank.len());
        for (k, &turned) in turned.iter().enumerate() {
            let ranks = &self.rank[contour(ends, k)];
            let mut before = ranks.last().copied().unwrap_or(0);
            for &rank in ranks {
                if rank != before {
                    let forwards = (before < rank) != turned;
                    let mut winding = [0; 2];
                    winding[usize::from(k > 0)] = if forwards { 1 } else { -1 };
                    let (from, to) = if before < rank { (before, rank) } else { (rank, before) };
                    edges.push(SweepEdge { from, to, winding });
                }
                before = rank;
            }
        }
        edges
    }

    /// The number of contours that repeat their first corner at the end.
    fn n_closing(&self, ends: &[usize]) -> usize {
        let is_closed = |k: &usize| {
            let ranks = &self.rank[contour(ends, *k)];
            ranks.len() > 1 && ranks.first() == ranks.last()
        };
        (0..ends.len()).filter(is_closed).count()
    }

    /// The number of contours with fewer than three distinct corners.
    fn n_empty(&self, ends: &[usize]) -> usize {
        let is_empty = |k: &usize| {
            let ranks = &self.rank[contour(ends, *k)];
            let Some(&first) = ranks.first() else { return true };
            let Some(&other) = ranks.iter().find(|rank| **rank != first) else { return true };
            ranks.iter().all(|rank| *rank == first || *rank == other)
        };
        (0..ends.len()).filter(is_empty).count()
    }
}

/// Whether each contour runs clockwise: by its area, or, if that may be only rounding, by its turn at the
/// leftmost corner, which is right for simple contours.
fn clockwise(corners: &[[f64; 2]], ends: &[usize]) -> Vec<bool> {
    let scale = unit_scale(corners);
    let is_clockwise = |k: usize| {
        let points = &corners[contour(ends, k)];
        let Some(&origin) = points.first() else { return false };
        let from_origin = |p: [f64; 2]| difference(p.map(|x| x * scale), origin.map(|x| x * scale));
        let (mut sum, mut size) = (0.0, 0.0);
        for pair in points.windows(2) {
            let (p, q) = (from_origin(pair[0]), from_origin(pair[1]));
            let (s, t) = (p[0] * q[1], p[1] * q[0]);
            sum += s - t;
            size += s.abs() + t.abs();
        }
        // Five roundings per term, and one per sum, each of at most 2⁻⁵³ of the sum of the sizes.
        if sum.abs() > (points.len() + 8) as f64 * f64::EPSILON * size {
            sum < 0.0
        } else {
            turns_right(points)
        }
    };
    (0..ends.len()).map(is_clockwise).collect()
}

/// Whether a contour turns right at its leftmost corner, and among several leftmost ones the lowest.
fn turns_right(points: &[[f64; 2]]) -> bool {
    let n = points.len();
    let is_before = |a: [f64; 2], b: [f64; 2]| a[0] < b[0] || a[0] == b[0] && a[1] < b[1];
    let at = (1..n).fold(0, |lowest, i| if is_before(points[i], points[lowest]) { i } else { lowest });
    let other = |step: usize| (1..n).map(|k| points[(at + k * step) % n]).find(|p| *p != points[at]);
    // No point is farther left, so a contour that does not cross itself is convex at this corner, and
    // its turn there is that of the whole contour: one exact predicate instead of a rounded area.
    match (other(n - 1), other(1)) {
        (Some(before), Some(after)) => orient2d(before, points[at], after) == Orientation::Back,
        _ => false,
    }
}

/// The triangulation on the corners themselves; `None` when sides cross.
fn triangulate_exactly(
    corners: &[[f64; 2]],
    ends: &[usize],
) -> Result<Option<PlaneTriangles>, InvalidPolygon> {
    let sites = SortedCorners::new(corners);
    let edges = sites.edges(ends, &clockwise(corners, ends));
    let Ok(swept) = sweep(&sites.points, edges, InsideRule::LessHoles) else { return Ok(None) };
    let n_corners = corners.len() - sites.n_closing(ends);
    let n = |count: usize, repair: fn(usize) -> ContourRepair| (count > 0).then(|| repair(count));
    let repairs: Vec<ContourRepair> = [
        n(sites.n_empty(ends), ContourRepair::Empty),
        n(n_corners - sites.points.len(), ContourRepair::Repeated),
        n(swept.touching, ContourRepair::Touching),
        n(swept.overlapping, ContourRepair::Overlapping),
        n(swept.useless, ContourRepair::Outside),
        n(swept.backwards, ContourRepair::Backwards),
    ]
    .into_iter()
    .flatten()
    .collect();
    let is_clean = repairs.is_empty();
    // n + 2h − 2, where `ends` counts the outer contour too.
    if is_clean && swept.triangles.len() + 4 != n_corners + 2 * ends.len()
        || !areas_agree(&sites.points, &swept.triangles, &swept.border)
    {
        return Err(InvalidPolygon::Fault);
    }
    let named = |t: [u32; 3]| t.map(|site| sites.corner[site as usize]);
    let triangles = swept.triangles.into_iter().map(named).collect();
    Ok(Some(PlaneTriangles { triangles, added: Vec::new(), repairs }))
}

/// Whether the areas of the triangles add up to the area within the border, up to rounding.
fn areas_agree(points: &[[f64; 2]], triangles: &[[u32; 3]], border: &[SweepEdge]) -> bool {
    let Some(origin) = border.first().map(|edge| points[edge.from as usize]) else {
        return triangles.is_empty();
    };
    let at = |i: u32| difference(points[i as usize], origin);
    let cross = |p: [f64; 2], q: [f64; 2]| [p[0] * q[1], p[1] * q[0]];
    let (mut inside, mut size) = (0.0, 0.0);
    for edge in border {
        let [a, b] = cross(at(edge.from), at(edge.to));
        inside += f64::from(edge.winding[0]) * (a - b);
        size += a.abs() + b.abs();
    }
    let mut covered = 0.0;
    for &[a, b, c] in triangles {
        let (p, q) = (
            difference(points[b as usize], points[a as usize]),
            difference(points[c as usize], points[a as usize]),
        );
        let [s, t] = cross(p, q);
        covered += s - t;
        size += s.abs() + t.abs();
    }
    // Five roundings per term, and one per sum; sums of n terms lose at most n units of 2⁻⁵³ of the sum of
    // their sizes.
    let n = (border.len() + triangles.len() + 8) as f64;
    // Areas beyond the range of f64 are not compared.
    !size.is_finite() || (inside - covered).abs() <= n * f64::EPSILON * size + f64::MIN_POSITIVE
}

/// The triangulation on a snap-rounding grid, through all crossings.
fn triangulate_snapped(
    corners: &[[f64; 2]],
    ends: &[usize],
    scale: f64,
) -> Result<PlaneTriangles, InvalidPolygon> {
    // The grid accepts numbers up to 1e150.
    let shrink = unit_scale(corners);
    let small: Vec<[f64; 2]> = corners.iter().map(|p| p.map(|x| x * shrink)).collect();
    let low = small.iter().fold([f64::INFINITY; 2], |m, p| [lesser(m[0], p[0]), lesser(m[1], p[1])]);
    let high = small.iter().fold([f64::NEG_INFINITY; 2], |m, p| [greater(m[0], p[0]), greater(m[1], p[1])]);
    let grid = SnapGrid::new([low, high]);
    let snapped: Vec<_> = small.iter().map(|p| grid.snap(*p)).collect();
    let turned = clockwise(&small, ends);
    let contours: Vec<GridContour> = (0..ends.len())
        .map(|k| {
            let mut points = snapped[contour(ends, k)].to_vec();
            if turned[k] {
                points.reverse();
            }
            GridContour { points, kind: usize::from(k > 0) }
        })
        .collect();
    let edges = arrange(&contours, &Job::default()).map_err(|stop| match stop {
        ArrangeError::TooManyPairs | ArrangeError::Cancelled => InvalidPolygon::TooManyCrossings,
    })?;
    let FillTriangles { points, triangles } =
        fill(&edges, InsideRule::LessHoles).ok_or(InvalidPolygon::Fault)?;
    // Grid points at corners get the number of the first corner there; all others are new.
    let mut corner_points: Vec<_> = snapped.iter().copied().zip(0_u32..).collect();
    corner_points.sort_unstable();
    corner_points.dedup_by_key(|(p, _)| *p);
    let mut added = Vec::new();
    let names: Vec<u32> = points
        .iter()
        .map(|p| match corner_points.binary_search_by_key(p, |(q, _)| *q) {
            Ok(at) => corner_points[at].1,
            Err(_) => {
                added.push(grid.restore(*p).map(|x| x / shrink));
                (corners.len() + added.len() - 1) as u32
            }
        })
        .collect();
    let triangles: Vec<[u32; 3]> = triangles.into_iter().map(|t| t.map(|i| names[i as usize])).collect();
    let corner_of =
        |i: u32| corners.get(i as usize).copied().unwrap_or_else(|| added[i as usize - corners.len()]);
    let is_folded = |t: &&[u32; 3]| {
        let [a, b, c] = t.map(corner_of);
        orient2d(a, b, c) == Orientation::Back
    };
    let folded = triangles.iter().filter(is_folded).count();
    let moved_at_most = grid.moved_at_most() / shrink / scale;
    Ok(PlaneTriangles { triangles, added, repairs: vec![ContourRepair::Crossing { moved_at_most, folded }] })
}
