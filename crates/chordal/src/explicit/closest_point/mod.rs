//! `SurfaceTree`: closest points on smooth surfaces, patches and limit surfaces, with proved distances.
pub(in crate::explicit) mod box_tree;
mod curve;
mod offset_patch;
mod search;

use super::cage::limit::{LimitSheet, QuadPatchTree};
use super::{LimitSurface, Patch, Scheme};
use crate::budget::{Job, JobError, Message, Refusal, RefusalCode, Tolerance, par_map};
use crate::math::{
    Box3, add_down, add_up, div_down, div_up, exponent, flushes_subnormals, greater, length_up, mul_down,
    mul_up, power_of_two, sqrt_down, sub_down, sub_up,
};
use box_tree::{BoxTree, gaps_down};
pub use curve::CurveClosestPoint;
use glam::DVec3;
use offset_patch::SheetRectangle;
use search::SurfaceSearch;

/// The closest point of a smooth surface to a query: the foot of a perpendicular, or a point on a boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceClosestPoint {
    /// The closest point found, rounded.
    pub point: [f64; 3],
    /// The patch, or the sheet of a limit surface, that contains it.
    pub sheet: u32,
    /// The first parameter on the sheet.
    pub u: f64,
    /// The second parameter on the sheet.
    pub v: f64,
    /// Lower bound for the distance of the entire surface; proved, rounding included.
    pub at_least: f64,
    /// Upper bound for the distance of the surface; proved, rounding included.
    pub at_most: f64,
}

/// A tree of boxes over smooth surfaces, Bézier patches or the sheets of a limit surface, for closest points.
///
/// Queries cache the refinement near extraordinary vertices for later ones; answers do not depend on it.
///
/// ```
/// use chordal::{Job, Patch};
/// use chordal::explicit::query::SurfaceTree;
/// let mut bump = Patch::flat([0.0; 3], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0]);
/// for (i, j) in [(1, 1), (1, 2), (2, 1), (2, 2)] {
///     bump.control[i][j][2] = 1.0;
/// }
/// let tree = SurfaceTree::from_patches(&[bump], &Job::default())?;
/// // Above the middle, where the height is (3/4)².
/// let closest = tree.closest_point([1.5, 1.5, 2.0], None).unwrap();
/// assert!(closest.at_least <= 2.0 - 0.5625 && 2.0 - 0.5625 <= closest.at_most);
/// assert!(closest.at_most - closest.at_least < 1e-12 && (closest.u - 0.5).abs() < 1e-6);
/// # Ok::<(), chordal::budget::JobError>(())
/// ```
///
/// Source: best first by bounds, and Newton's method, as in X.-D. Chen et al., *Computing the minimum
/// distance between a point and a clamped B-spline surface*, 2009; the bounds are derived in
/// `explicit/closest_point/offset_patch.rs`.
#[derive(Clone, Debug)]
pub struct SurfaceTree {
    /// The scale from world to local coordinates, a power of two.
    scale: f64,
    /// The largest local coordinate.
    size: f64,
    /// The box of the entire surface, in world coordinates.
    bounds: Box3,
    boxes: BoxTree,
    items: Vec<SurfaceItem>,
    /// The sheets of a limit surface, in world coordinates.
    sheets: Vec<LimitSheet>,
}

/// The content of a leaf of the tree.
#[derive(Clone, Debug)]
enum SurfaceItem {
    /// A patch in local coordinates.
    Patch { control: Box<[[[f64; 3]; 4]; 4]>, error: f64, place: SheetRectangle },
    /// A sheet that does not consist only of patches.
    Sheet(u32),
}

/// A square of a sheet in world coordinates: its item, its control points and their error.
struct SurfaceLeaf {
    item: SurfaceItem,
    hull: Vec<[f64; 3]>,
    error: f64,
}

/// Bytes per patch. Derived: 384 for its points and two boxes with their containers; and per sheet with some
/// subdivisions, chosen.
const BYTES_A_PATCH: u64 = 700;
const BYTES_A_SHEET: u64 = 8000;
/// Beyond this, means of coordinates of cages may overflow. Chosen, as for their meshes.
const LARGEST: f64 = 1e150;
/// Local coordinates up to which a query is used unchanged; from farther away the entire surface is within a
/// rounding.
const FAR: f64 = (1_u64 << 60) as f64;
/// The surface's local coordinates are at most 1. For a query beyond this value, the point is evaluated
/// again, since a sum with the query loses digits. Chosen: a larger value saves evaluations and loses more
/// digits.
const OUTSIDE: f64 = 2.0;
/// The error of a length by squares that underflow, in local units, where 1 is the size of the surface: the
/// root of the smallest normal number is 1.5e-154.
const TINY: f64 = 1e-150;

impl SurfaceTree {
    /// The tree over Bézier patches, one sheet for each.
    ///
    /// *Cost.* Some microseconds and 700 bytes per patch.
    ///
    /// # Errors
    /// [`JobError::Refused`] with [`RefusalCode::NotFinite`], [`RefusalCode::TooMuchMemory`], and if
    /// subnormals are flushed.
    pub fn from_patches(patches: &[Patch], job: &Job) -> Result<Self, JobError> {
        check_memory(patches.len(), BYTES_A_PATCH, job)?;
        if let Some(sheet) = patches.iter().position(|patch| !patch.is_finite()) {
            return refused(
                RefusalCode::NotFinite,
                format!("patch {sheet} has a coordinate that is not finite"),
            );
        }
        let part = |(sheet, patch): (usize, &Patch)| SurfaceLeaf {
            hull: patch.control.as_flattened().to_vec(),
            item: SurfaceItem::Patch {
                control: Box::new(patch.control),
                error: 0.0,
                place: SheetRectangle { sheet: sheet as u32, u: [0.0, 1.0], v: [0.0, 1.0] },
            },
            error: 0.0,
        };
        Self::over(patches.iter().enumerate().map(part).collect(), Vec::new())
    }

    /// The tree over the sheets of a limit surface.
    ///
    /// *Cost.* Some ten microseconds and some thousand bytes per sheet. For each extraordinary vertex up to
    /// some milliseconds and 100 kB when the first query comes near it.
    ///
    /// # Errors
    /// [`JobError::Refused`] with [`RefusalCode::NotFinite`] if a coordinate is beyond 1e150,
    /// [`RefusalCode::Unsupported`] for Loop's scheme, [`RefusalCode::TooMuchMemory`], and if subnormals are
    /// flushed; [`JobError::Cancelled`].
    pub fn from_limit(limit: &LimitSurface<'_>, job: &Job) -> Result<Self, JobError> {
        check_memory(limit.n_sheets(), BYTES_A_SHEET, job)?;
        if limit.cage().scheme() == Scheme::Loop {
            return refused(
                RefusalCode::Unsupported,
                "nearest points of Loop's limit surface are not known yet",
            );
        }
        let positions = limit.cage().positions();
        if let Some(row) = positions.iter().position(|p| p.iter().any(|x| x.abs() > LARGEST)) {
            return refused(
                RefusalCode::NotFinite,
                format!("vertex {row} has a coordinate beyond {LARGEST:e}"),
            );
        }
        let numbers: Vec<usize> = (0..limit.n_sheets()).collect();
        let sheet_results =
            par_map(
                job,
                &numbers,
                |_, sheet| {
                    if job.is_cancelled() { None } else { Some(limit.sheet(*sheet)) }
                },
            );
        let mut sheets = Vec::with_capacity(sheet_results.len());
        for sheet in sheet_results {
            match sheet {
                None => return Err(JobError::Cancelled),
                Some(Err(error)) => return refused(RefusalCode::NotFinite, error.to_string()),
                Some(Ok(sheet)) => sheets.push(sheet),
            }
        }
        let mut parts = Vec::with_capacity(sheets.len());
        for (number, sheet) in sheets.iter().enumerate() {
            match sheet.square() {
                Some(QuadPatchTree::Regular(patches)) => {
                    parts.extend(patches.patches.iter().map(|piece| SurfaceLeaf {
                        hull: piece.patch.control.as_flattened().to_vec(),
                        item: SurfaceItem::Patch {
                            control: Box::new(piece.patch.control),
                            error: patches.off,
                            place: SheetRectangle { sheet: number as u32, u: piece.u, v: piece.v },
                        },
                        error: patches.off,
                    }))
                }
                Some(QuadPatchTree::Extraordinary(extraordinary)) => parts.push(SurfaceLeaf {
                    hull: extraordinary.ring().hull().to_vec(),
                    item: SurfaceItem::Sheet(number as u32),
                    error: 2.0 * extraordinary.ring().rounding(),
                }),
                None => {}
            }
        }
        Self::over(parts, sheets)
    }

    fn over(parts: Vec<SurfaceLeaf>, sheets: Vec<LimitSheet>) -> Result<Self, JobError> {
        if flushes_subnormals() {
            let message = "this process flushes subnormal numbers to zero, so nothing can be proved in it";
            return refused(RefusalCode::FlushesSubnormals, message);
        }
        let in_world = |part: &SurfaceLeaf| {
            let hull = Box3::from_points(&part.hull);
            let error = part.error;
            Box3 { min: hull.min.map(|x| sub_down(x, error)), max: hull.max.map(|x| add_up(x, error)) }
        };
        let worlds: Vec<Box3> = parts.iter().map(in_world).collect();
        let bounds = worlds.iter().fold(Box3::EMPTY, |bounds, world| bounds.union(*world));
        let reach = bounds.min.iter().chain(&bounds.max).fold(0.0, |largest, x| greater(largest, x.abs()));
        let scale = if parts.is_empty() { 1.0 } else { power_of_two(-exponent(reach)) };
        let mut tree =
            Self { scale, size: reach * scale, bounds, boxes: BoxTree::over(&[]), items: Vec::new(), sheets };
        // An underflow is less than the smallest normal number.
        let local = |world: &Box3| Box3 {
            min: world.min.map(|x| sub_down(x * scale, f64::MIN_POSITIVE)),
            max: world.max.map(|x| add_up(x * scale, f64::MIN_POSITIVE)),
        };
        tree.boxes = BoxTree::over(&worlds.iter().map(local).collect::<Vec<_>>());
        let local = |item: SurfaceItem| match item {
            SurfaceItem::Patch { mut control, error, place } => {
                control.as_flattened_mut().iter_mut().for_each(|p| *p = tree.local(*p));
                SurfaceItem::Patch { control, error: tree.local_error(error), place }
            }
            sheet @ SurfaceItem::Sheet(_) => sheet,
        };
        tree.items = parts.into_iter().map(|part| local(part.item)).collect();
        Ok(tree)
    }

    /// The closest point to `p`; `None` without a sheet or if `p` is not finite.
    ///
    /// Two bounds enclose the distance. They are within `tolerance` of each other, or, without one, as close
    /// as rounding permits: some dozen units in the last place of the largest coordinate for patches, some
    /// thousand for limit surfaces. If too many points are nearly equally close, as from the centre of a
    /// ball, the bounds stay farther apart but still hold. Among equally close points any may be returned,
    /// but always the same one.
    ///
    /// *Cost.* Measured on one core: 2 µs for points on the teapot's 32 patches, 18 µs for points around it;
    /// for limit surfaces 2 to 15 µs on them and 5 to 40 µs around them, up to 1600 sheets. The first query
    /// near an extraordinary vertex takes some hundred microseconds, and at a vertex of hundreds of faces
    /// some hundred milliseconds. Where very many points are equally close, a query takes some milliseconds.
    #[must_use]
    pub fn closest_point(&self, p: [f64; 3], tolerance: Option<Tolerance>) -> Option<SurfaceClosestPoint> {
        if !p.iter().all(|x| x.is_finite()) {
            return None;
        }
        let largest = p.iter().fold(0.0, |most, x| greater(most, x.abs()));
        let (mut about, mut close_enough) =
            (p.map(|x| x * self.scale), tolerance.map_or(0.0, |t| t.get() * self.scale));
        let is_far = about.iter().any(|x| x.abs() > FAR);
        if is_far {
            // A point in the same direction at a representable distance.
            let (first, second) = (power_of_two(-exponent(largest)), FAR);
            (about, close_enough) = (p.map(|x| x * first * second), 0.0);
        }
        let (best, down) = SurfaceSearch::new(self, DVec3::from(about), close_enough).run()?;
        let [u, v] = best.at;
        // From far away, the sum with the query keeps few digits of the surface point.
        let is_outside = about.iter().any(|x| x.abs() > OUTSIDE);
        let evaluated =
            if is_outside || best.is_extraordinary { self.evaluated(best.sheet, best.at) } else { None };
        let sum = |k: usize| (best.point.to_array()[k] + about[k]) / self.scale;
        let point = evaluated.unwrap_or_else(|| std::array::from_fn(sum));
        let [at_least, at_most] = if is_far {
            [box_down(p, &self.bounds), box_up(p, &self.bounds)]
        } else {
            [div_down(sub_down(down, TINY), self.scale), div_up(add_up(best.up, TINY), self.scale)]
        };
        let at_least = greater(at_least, 0.0);
        Some(SurfaceClosestPoint { point, sheet: best.sheet, u, v, at_least, at_most })
    }

    /// [`SurfaceTree::closest_point`] for many points, in order, on the threads of `job`. The answers are the
    /// same to the last bit.
    #[must_use]
    pub fn closest_points(
        &self,
        points: &[[f64; 3]],
        tolerance: Option<Tolerance>,
        job: &Job,
    ) -> Vec<Option<SurfaceClosestPoint>> {
        let chunks: Vec<&[[f64; 3]]> = points.chunks(TASK).collect();
        par_map(job, &chunks, |_, points| {
            points.iter().map(|p| self.closest_point(*p, tolerance)).collect::<Vec<_>>()
        })
        .concat()
    }

    /// A bounding box of the surface.
    #[must_use]
    pub fn bounds(&self) -> Box3 {
        self.bounds
    }

    /// The point at the given parameters of a sheet, in world coordinates.
    fn evaluated(&self, sheet: u32, [u, v]: [f64; 2]) -> Option<[f64; 3]> {
        if let Some(sheet) = self.sheets.get(sheet as usize) {
            return sheet.at(u, v).ok().map(|jet| jet.point);
        }
        match self.items.get(sheet as usize)? {
            SurfaceItem::Patch { control, .. } => {
                Some(Patch { control: **control }.at(u, v).map(|x| x / self.scale))
            }
            SurfaceItem::Sheet(_) => None,
        }
    }

    fn local(&self, p: [f64; 3]) -> [f64; 3] {
        p.map(|x| x * self.scale)
    }

    /// An error of points, in local units and rounded up.
    fn local_error(&self, error: f64) -> f64 {
        if error == 0.0 { 0.0 } else { add_up(mul_up(error, self.scale), f64::MIN_POSITIVE) }
    }
}

/// Queries per task: at some microseconds each, they outweigh its start.
const TASK: usize = 128;

/// A lower bound for the distance of a point to a box, even if squares overflow.
fn box_down(p: [f64; 3], bounds: &Box3) -> f64 {
    let gaps = gaps_down(p, bounds);
    let largest = gaps.iter().fold(0.0, |most, x| greater(most, *x));
    if largest == 0.0 {
        return 0.0;
    }
    let square = gaps.iter().fold(0.0, |sum, x| {
        let share = greater(div_down(*x, largest), 0.0);
        add_down(sum, mul_down(share, share))
    });
    mul_down(sqrt_down(greater(square, 0.0)), largest)
}

/// An upper bound for the distance of a point to the farthest point of a box.
fn box_up(p: [f64; 3], bounds: &Box3) -> f64 {
    length_up(std::array::from_fn::<f64, 3, _>(|k| {
        greater(sub_up(p[k], bounds.min[k]), sub_up(bounds.max[k], p[k]))
    }))
}

fn check_memory(count: usize, bytes: u64, job: &Job) -> Result<(), JobError> {
    let needed = count as u64 * bytes;
    if count >= 1 << 31 || needed > job.memory_limit {
        let message = format!(
            "the tree over {count} sheets needs about {needed} bytes; the limit is {}",
            job.memory_limit
        );
        return refused(RefusalCode::TooMuchMemory, message);
    }
    Ok(())
}

fn refused<T>(code: RefusalCode, message: impl Into<Message>) -> Result<T, JobError> {
    Err(JobError::Refused(Refusal::new(code, message)))
}
