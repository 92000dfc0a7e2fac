//! The arrow from closed contours of straight lines to a field of the plane, whatever they cross.
//!
//! Where contours cross, touch or overlap, edges run inside of what is filled, and no function of the edges has its zeros at
//! the border alone. So what they fill is found first, on the grid that [`outlines_to_mesh`](super::outlines_to_mesh)
//! uses, and its border are contours that meet nowhere.
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

/// What closed contours enclose, as a field of the plane, endless along z.
///
/// **Bound.** 0 where contours meet nowhere but at corners that follow each other. Others are cut at their crossings,
/// which are rounded to a grid of 2⁻³⁶ of their extent: the bound is how far that moves a point, at most, and the field
/// says so as a promise (see [`Field::evidence`]).
///
/// **Value.** The exact distance; where what is filled touches itself in a point, outside. **Cost.** O((n + k) log n) for n
/// edges that cross k times.
///
/// # Errors
/// [`Failure::Refused`]: a coordinate that is not finite or too large; contours that enclose nothing; so many edges on each
/// other that their crossings cannot be counted. [`Failure::Cancelled`].
///
/// ```
/// use chordal::explicit::FillRule;
/// use chordal::{Job, convert::contours_to_field};
/// // A bow-tie: its sides cross in (1, 1).
/// let bow_tie = vec![[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]];
/// let made = contours_to_field(&[bow_tie], FillRule::EvenOdd, &Job::default()).expect("it encloses something");
/// assert!(made.bound.at_most().unwrap() < 1e-9);
/// assert!(made.shape.expr().at([0.25, 1.0, 0.0]).unwrap() < 0.0);
/// assert_eq!(made.shape.expr().at([1.0, 2.0, 0.0]).unwrap(), libm::sqrt(0.5));
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
    let plain = exact_contours(contours, by_rule)?;
    if plain.distance() == Distance::EXACT {
        return Ok(Bounded { shape: plain.into_field(), bound: Bound::exact(Reference::Curves) });
    }
    let grid = grid_of(contours);
    let snapped = |points: &Vec<[f64; 2]>| GridContour {
        points: points.iter().map(|p| grid.snap(*p)).collect(),
        kind: 0,
    };
    let on_grid: Vec<GridContour> = contours.iter().map(snapped).collect();
    let edges = arrange(&on_grid, job).map_err(|stop| match stop {
        ArrangeError::Cancelled => Failure::Cancelled,
        ArrangeError::TooManyPairs => Failure::refused(
            RefusalCode::TooManyTriangles,
            "so many edges of the outline lie on each other that their crossings are not counted",
        ),
    })?;
    let nothing = || Failure::refused(RefusalCode::Empty, "the contours enclose nothing");
    let filled = fill(&edges, InsideRule::Fill(rule)).filter(|filled| !filled.triangles.is_empty());
    let regions = FilledBorder::new(&filled.ok_or_else(nothing)?).regions(&grid);
    let shape = field_of(&regions)?;
    let moved = grid.moved_at_most();
    let shape = shape.standing_for(format!(
        "an outline that crosses itself is taken as cut at its crossings, which moved it by {moved:.1e} at most"
    ));
    Ok(Bounded { shape, bound: Bound::proved(0.0, moved, Reference::Curves) })
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

/// Contours that bound an area in one piece: the outer one, and those of its holes.
struct BorderRegion {
    /// Those that share no corner, the outer one among them.
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

/// The border of triangles in the plane that meet along whole edges.
struct FilledBorder<'a> {
    filled: &'a FillTriangles,
    /// The triangle of each directed edge. Only looked up.
    triangle_of: HashMap<[u32; 2], u32>, // No order depends on it.
}

/// A closed path along a border, what is filled to its left.
struct BorderLoop {
    /// The area in one piece that it bounds.
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

    /// The corner of a triangle after this one.
    fn after(&self, triangle: u32, corner: u32) -> u32 {
        let corners = self.filled.triangles[triangle as usize];
        let at = corners.iter().position(|own| *own == corner).unwrap_or(0);
        corners[(at + 1) % 3]
    }

    /// The edge of the border that follows one, around what is filled at its end.
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

    /// For each triangle the first of those that are joined to it along edges.
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

    /// All loops, each without a corner twice.
    fn loops(&self) -> Vec<BorderLoop> {
        let areas = self.areas();
        let mut seen: HashSet<[u32; 2]> = HashSet::new(); // No order depends on it.
        let mut found = Vec::new();
        for (row, [a, b, c]) in self.filled.triangles.iter().enumerate() {
            for edge in [[*a, *b], [*b, *c], [*c, *a]] {
                if self.triangle_of.contains_key(&[edge[1], edge[0]]) || seen.contains(&edge) {
                    continue;
                }
                let mut path = Vec::new();
                let mut at = edge;
                while seen.insert(at) {
                    path.push(at[0]);
                    at = self.next(at);
                }
                found.extend(
                    simple_loops(&path).into_iter().map(|corners| BorderLoop { area: areas[row], corners }),
                );
            }
        }
        found
    }

    /// The contours of all areas. Where no loop touches another, they are those of one region.
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

    /// Its points, without corners that lie on a straight line and that no other loop has.
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

/// A closed path cut where it comes back to a corner.
fn simple_loops(path: &[u32]) -> Vec<Vec<u32>> {
    let mut place: HashMap<u32, usize> = HashMap::new(); // No order depends on it.
    let (mut way, mut loops): (Vec<u32>, Vec<Vec<u32>>) = (Vec::new(), Vec::new());
    for corner in path {
        if let Some(at) = place.get(corner).copied() {
            let cut: Vec<u32> = way.drain(at..).collect();
            cut.iter().for_each(|gone| {
                place.remove(gone);
            });
            loops.push(cut);
        }
        place.insert(*corner, way.len());
        way.push(*corner);
    }
    loops.push(way);
    loops.retain(|corners| corners.len() > 2);
    loops
}
