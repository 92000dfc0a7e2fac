//! The arrow from closed contours of straight lines, which may cross, to a field of the plane.
//!
//! Where contours cross, touch or overlap, edges run inside of the filled area, and no function of the edges is zero at
//! its border alone. So the area is filled first, on the grid that [`outlines_to_mesh`](super::outlines_to_mesh) uses;
//! its border consists of contours that do not cross.
use crate::budget::{Bound, Bounded, Failure, Job, Reference, RefusalCode};
use crate::explicit::FillRule;
use crate::explicit::fill::arrange::{ArrangeError, GridContour, arrange};
use crate::explicit::fill::snap_grid::{SnapGrid, turn};
use crate::explicit::fill::sweep::InsideRule;
use crate::explicit::fill::{FillTriangles, fill};
use crate::implicit::shapes::{ContourFill, Contours};
use crate::implicit::{Distance, Field};
use crate::math::{greater, lesser};
use std::collections::{BTreeMap, HashMap, HashSet};

/// The area that closed contours enclose, as a field of the plane, endless along z.
///
/// **Bound.** 0 if edges meet only at the corners between neighbours. Other contours are cut at their crossings, which
/// are rounded to a grid of 2⁻³⁶ of their extent: the bound is the largest distance by which that moves a point, and
/// the field states it as a condition (see [`Field::evidence`]).
///
/// **Value.** The exact distance; if the filled area touches itself in a point, the exact distance outside of it.
/// **Cost.** O((n + k) log n) for n edges that cross k times.
///
/// # Errors
/// [`Failure::Refused`]: a coordinate that is not finite or too large; contours that enclose nothing; so many overlapping
/// edges that their crossings are not counted. [`Failure::Cancelled`].
///
/// ```
/// use chordal::explicit::FillRule;
/// use chordal::{Job, convert::contours_to_field};
/// // A bow-tie: its sides cross in (1, 1).
/// let bow_tie = vec![[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]];
/// let bounded = contours_to_field(&[bow_tie], FillRule::EvenOdd, &Job::default()).expect("it encloses something");
/// assert!(bounded.bound.at_most().unwrap() < 1e-9);
/// assert!(bounded.shape.expr().at([0.25, 1.0, 0.0]).unwrap() < 0.0);
/// assert_eq!(bounded.shape.expr().at([1.0, 2.0, 0.0]).unwrap(), libm::sqrt(0.5));
/// ```
pub fn contours_to_field(
    contours: &[Vec<[f64; 2]>],
    rule: FillRule,
    job: &Job,
) -> Result<Bounded<Field>, Failure<Field>> {
    let by_rule = match rule {
        FillRule::EvenOdd => ContourFill::EvenOdd,
        FillRule::NonZero => ContourFill::NonZero,
    };
    let exact = exact_contours(contours, by_rule)?;
    if exact.distance() == Distance::EXACT {
        return Ok(Bounded { shape: exact.into_field(), bound: Bound::exact(Reference::Curves) });
    }
    let grid = grid_of(contours);
    let snapped = |points: &Vec<[f64; 2]>| GridContour {
        points: points.iter().map(|p| grid.snap(*p)).collect(),
        kind: 0,
    };
    let on_grid: Vec<GridContour> = contours.iter().map(snapped).collect();
    let edges = arrange(&on_grid, job).map_err(|error| match error {
        ArrangeError::Cancelled => Failure::Cancelled,
        ArrangeError::TooManyPairs => Failure::refused(
            RefusalCode::TooManyTriangles,
            "so many edges of the outline overlap that their crossings are not computed",
        ),
    })?;
    let nothing = || Failure::refused(RefusalCode::Empty, "the contours enclose nothing");
    let filled = fill(&edges, InsideRule::Fill(rule)).filter(|filled| !filled.triangles.is_empty());
    let regions = FilledBorder::new(&filled.ok_or_else(nothing)?).regions(&grid);
    let shape = field_of(&regions)?;
    let snap_distance = grid.moved_at_most();
    let shape = shape.standing_for(format!(
        "an outline that crosses itself is cut at its crossings, which moves it by at most \
         {snap_distance:.1e}"
    ));
    Ok(Bounded { shape, bound: Bound::proved(0.0, snap_distance, Reference::Curves) })
}

fn exact_contours(contours: &[Vec<[f64; 2]>], rule: ContourFill) -> Result<Contours, Failure<Field>> {
    Contours::new(contours, rule).map_err(|error| Failure::refused(RefusalCode::Empty, error.to_string()))
}

fn grid_of(contours: &[Vec<[f64; 2]>]) -> SnapGrid {
    let points = || contours.iter().flatten();
    let end = |k: usize, better: fn(f64, f64) -> f64, start: f64| {
        points().fold(start, |best, p| better(p[k], best))
    };
    SnapGrid::new([
        [0, 1].map(|k| end(k, lesser, f64::INFINITY)),
        [0, 1].map(|k| end(k, greater, f64::NEG_INFINITY)),
    ])
}

/// The contours of one connected area: its outer contour, and those of its holes.
struct BorderRegion {
    /// The outer contour, and the holes that share no corner with others.
    apart: Vec<Vec<[f64; 2]>>,
    /// Holes that share a corner with others.
    touching: Vec<Vec<[f64; 2]>>,
}

/// One field for all regions.
fn field_of(regions: &[BorderRegion]) -> Result<Field, Failure<Field>> {
    let mut fields = Vec::new();
    for region in regions {
        let mut field = exact_contours(&region.apart, ContourFill::EvenOdd)?.into_field();
        for hole in &region.touching {
            let hole = exact_contours(std::slice::from_ref(hole), ContourFill::EvenOdd)?.into_field();
            field = field.difference(&hole);
        }
        fields.push(field);
    }
    Ok(Field::union_of(&fields))
}

/// The border of an area of triangles in the plane that meet along whole edges.
struct FilledBorder<'a> {
    filled: &'a FillTriangles,
    /// The triangle of each directed edge. Only looked up.
    triangle_of: HashMap<[u32; 2], u32>, // No order depends on it.
}

/// A closed path along a border, with the filled area on its left.
struct BorderLoop {
    /// The connected area that it bounds, by the area's first triangle.
    area: u32,
    corners: Vec<u32>,
}

impl<'a> FilledBorder<'a> {
    fn new(filled: &'a FillTriangles) -> Self {
        let edges = (0..).zip(&filled.triangles);
        let triangle_of =
            edges.flat_map(|(row, [a, b, c])| [([*a, *b], row), ([*b, *c], row), ([*c, *a], row)]).collect();
        Self { filled, triangle_of }
    }

    /// The corner that follows a corner of a triangle.
    fn after(&self, triangle: u32, corner: u32) -> u32 {
        let corners = self.filled.triangles[triangle as usize];
        let at = corners.iter().position(|c| *c == corner).unwrap_or(0);
        corners[(at + 1) % 3]
    }

    /// The edge of the border after a given one: turns around its end through the filled triangles.
    fn next(&self, [from, to]: [u32; 2]) -> [u32; 2] {
        let mut triangle = self.triangle_of[&[from, to]];
        loop {
            let onward = self.after(triangle, to);
            match self.triangle_of.get(&[onward, to]) {
                Some(other) => triangle = *other,
                None => return [to, onward],
            }
        }
    }

    /// For each triangle, the first triangle of its connected area; areas are connected along edges.
    fn areas(&self) -> Vec<u32> {
        let n = self.filled.triangles.len();
        let mut area = vec![u32::MAX; n];
        for first in 0..n as u32 {
            if area[first as usize] != u32::MAX {
                continue;
            }
            area[first as usize] = first;
            let mut open = vec![first];
            while let Some(triangle) = open.pop() {
                let [a, b, c] = self.filled.triangles[triangle as usize];
                // A neighbour has the edge in the opposite direction.
                for edge in [[b, a], [c, b], [a, c]] {
                    if let Some(other) = self.triangle_of.get(&edge)
                        && area[*other as usize] == u32::MAX
                    {
                        area[*other as usize] = first;
                        open.push(*other);
                    }
                }
            }
        }
        area
    }

    /// All loops; none visits a corner twice.
    fn loops(&self) -> Vec<BorderLoop> {
        let areas = self.areas();
        let mut visited: HashSet<[u32; 2]> = HashSet::new(); // No order depends on it.
        let mut loops = Vec::new();
        for (row, [a, b, c]) in self.filled.triangles.iter().enumerate() {
            for edge in [[*a, *b], [*b, *c], [*c, *a]] {
                // An edge inside of the area, or of a loop that is known already.
                if self.triangle_of.contains_key(&[edge[1], edge[0]]) || visited.contains(&edge) {
                    continue;
                }
                let mut path = Vec::new();
                let mut current = edge;
                while visited.insert(current) {
                    path.push(current[0]);
                    current = self.next(current);
                }
                loops.extend(
                    simple_loops(&path).into_iter().map(|corners| BorderLoop { area: areas[row], corners }),
                );
            }
        }
        loops
    }

    /// The contours of all areas. If no loop touches another, one region has them all.
    fn regions(&self, grid: &SnapGrid) -> Vec<BorderRegion> {
        let loops = self.loops();
        let mut uses: HashMap<u32, u32> = HashMap::new(); // No order depends on it.
        loops.iter().flat_map(|path| &path.corners).for_each(|corner| *uses.entry(*corner).or_default() += 1);
        let is_shared = |corner: &u32| uses[corner] > 1;
        let touches = |path: &BorderLoop| path.corners.iter().any(is_shared);
        let points = |path: &BorderLoop| self.straightened(path, is_shared, grid);
        if !loops.iter().any(touches) {
            return vec![BorderRegion { apart: loops.iter().map(points).collect(), touching: Vec::new() }];
        }
        let mut areas: BTreeMap<u32, BorderRegion> = BTreeMap::new();
        for path in &loops {
            let region = areas
                .entry(path.area)
                .or_insert_with(|| BorderRegion { apart: Vec::new(), touching: Vec::new() });
            let is_outer = self.runs_counter_clockwise(&path.corners);
            let list = if is_outer || !touches(path) { &mut region.apart } else { &mut region.touching };
            list.push(points(path));
        }
        areas.into_values().collect()
    }

    fn runs_counter_clockwise(&self, corners: &[u32]) -> bool {
        let point = |k: usize| self.filled.points[corners[k] as usize];
        let first = point(0);
        (1..corners.len() - 1).fold(0, |sum: i128, k| sum + turn(first, point(k), point(k + 1))) > 0
    }

    /// The points of a loop, without the corners that lie on a straight line and are not shared with other loops.
    fn straightened(
        &self,
        path: &BorderLoop,
        is_shared: impl Fn(&u32) -> bool,
        grid: &SnapGrid,
    ) -> Vec<[f64; 2]> {
        let n = path.corners.len();
        let point = |k: usize| self.filled.points[path.corners[k % n] as usize];
        let kept = (0..n)
            .filter(|k| is_shared(&path.corners[*k]) || turn(point(k + n - 1), point(*k), point(k + 1)) != 0);
        kept.map(|k| grid.restore(point(k))).collect()
    }
}

/// Cuts a closed path into loops wherever it comes back to a corner.
fn simple_loops(path: &[u32]) -> Vec<Vec<u32>> {
    let mut row_of: HashMap<u32, usize> = HashMap::new(); // No order depends on it.
    let (mut open_path, mut loops): (Vec<u32>, Vec<Vec<u32>>) = (Vec::new(), Vec::new());
    for corner in path {
        if let Some(first) = row_of.get(corner).copied() {
            let cut: Vec<u32> = open_path.drain(first..).collect();
            // Other loops may come through its corners again.
            cut.iter().for_each(|visited| {
                row_of.remove(visited);
            });
            loops.push(cut);
        }
        row_of.insert(*corner, open_path.len());
        open_path.push(*corner);
    }
    loops.push(open_path);
    loops.retain(|corners| corners.len() > 2);
    loops
}
