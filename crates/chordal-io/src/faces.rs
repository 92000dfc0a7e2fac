//! `Faces`: polygons in the order of the file, and their triangulation.
use crate::grow::{push, push_many};
use crate::warnings::Warnings;
use crate::{FileLocation, ReadError};
use chordal::explicit::triangulate::{Triangulator, other_cut_within};
use chordal::math::greater;

/// The message for faces with fewer than 3 corners.
pub(crate) const SHORT_FACES: &str = "faces of fewer than 3 corners were skipped";

/// A polygon with more corners than this, and far fewer vertices than corners, is not triangulated. It visits
/// the same vertices again and again, and to triangulate it would take memory out of all proportion to its
/// bytes.
const LONG: usize = 1 << 16;

/// How far rounding to single precision may move corners out of their plane, relative to their coordinates:
/// polygons are flat within it. Derived: 2⁻²⁴ of a coordinate for each of three, and the same at each of the
/// corners that span the plane.
const SINGLE_PRECISION: f64 = 8.0 / (1 << 24) as f64;

/// The code of the warning that says how far two triangulations of a non-planar polygon may be apart.
pub const BENT_POLYGONS: &str = "polygons-bent";

/// Polygons that are not flat: their number, the first of them, and the largest distance between two
/// triangulations of one of them.
#[derive(Debug, Default)]
struct BentPolygons {
    n: u64,
    first: u64,
    at_most: f64,
}

impl BentPolygons {
    fn add(&mut self, points: &[[f64; 3]], at: u64) {
        let apart = other_cut_within(points);
        let size = points.iter().flatten().fold(0.0, |most, x| greater(most, x.abs()));
        self.at_most = greater(self.at_most, apart);
        if apart > SINGLE_PRECISION * size {
            self.first = if self.n == 0 { at } else { self.first };
            self.n += 1;
        }
    }
}

/// A face with more than three corners. Its triangles are reserved, and filled in once all positions are
/// known.
#[derive(Debug)]
struct DeferredPolygon {
    first_triangle: usize,
    first_corner: usize,
    corners: u32,
    at: u64,
}

/// Faces of three or more corners, as indices of vertex rows.
#[derive(Debug, Default)]
pub(crate) struct Faces {
    triangles: Vec<[u32; 3]>,
    polygons: Vec<DeferredPolygon>,
    corners: Vec<u32>,
}

impl Faces {
    /// Reserves memory for as many faces as were counted in the bytes of the file.
    pub(crate) fn with_room(rows: usize) -> Result<Self, ReadError> {
        Ok(Self { triangles: crate::grow::with_room(rows)?, ..Self::default() })
    }

    /// Reserves memory for `more` triangles; the bytes of the file can hold that many.
    pub(crate) fn reserve(&mut self, more: usize) -> Result<(), ReadError> {
        let n = self.triangles.len();
        self.triangles.try_reserve_exact(more).map_err(|_| crate::grow::out_of_memory(n))
    }

    /// The number of triangles so far.
    pub(crate) fn n_triangles(&self) -> usize {
        self.triangles.len()
    }

    /// Appends a face of at least three corners that starts at line or row `at`.
    #[inline]
    pub(crate) fn push(&mut self, corners: &[u32], at: u64) -> Result<(), ReadError> {
        if let &[a, b, c] = corners {
            return push(&mut self.triangles, [a, b, c]);
        }
        let polygon = DeferredPolygon {
            first_triangle: self.triangles.len(),
            first_corner: self.corners.len(),
            corners: u32::try_from(corners.len()).map_err(|_| crate::grow::out_of_memory(corners.len()))?,
            at,
        };
        push_many(&mut self.triangles, [0; 3], corners.len().saturating_sub(2))?;
        push_many(&mut self.corners, 0, corners.len())?;
        self.corners[polygon.first_corner..].copy_from_slice(corners);
        push(&mut self.polygons, polygon)
    }

    /// Triangulates all faces in order. Counts the faces that were cut and those that overlap themselves.
    pub(crate) fn cut(
        mut self,
        positions: &[[f64; 3]],
        place: fn(u64) -> FileLocation,
        warnings: &mut Warnings,
    ) -> Vec<[u32; 3]> {
        let mut triangulator = Triangulator::default();
        let (mut points, mut cut) = (Vec::new(), Vec::new());
        let mut bent = BentPolygons::default();
        for polygon in &self.polygons {
            let corners = &self.corners[polygon.first_corner..][..polygon.corners as usize];
            if corners.len() > LONG && corners.len() > positions.len() + positions.len() / 2 {
                warnings.count("polygon-overlaps", || {
                    let message = format!(
                        "a polygon of {} corners over {} vertices was cut as a fan from its first corner",
                        corners.len(),
                        positions.len()
                    );
                    (place(polygon.at), message)
                });
                // As many triangles as any other way would give, so that the places reserved for
                // them are filled.
                for (triangle, pair) in
                    self.triangles[polygon.first_triangle..].iter_mut().zip(corners[1..].windows(2))
                {
                    *triangle = [corners[0], pair[0], pair[1]];
                }
                continue;
            }
            points.clear();
            points.extend(corners.iter().map(|i| positions[*i as usize]));
            // Faces with a corner that is not finite are dropped later, so their shape is irrelevant.
            points.iter_mut().flatten().for_each(|x| *x = if x.is_finite() { *x } else { 0.0 });
            bent.add(&points, polygon.at);
            cut.clear();
            let folded = triangulator.polygon(&points, &mut cut);
            for (triangle, local) in self.triangles[polygon.first_triangle..].iter_mut().zip(&cut) {
                *triangle = local.map(|i| corners[i as usize]);
            }
            if folded > 0 {
                warnings.count("polygon-overlaps", || {
                    let message = format!(
                        "a polygon of {} corners crosses or overlaps itself: its {} triangles cover more than its area",
                        polygon.corners,
                        cut.len()
                    );
                    (place(polygon.at), message)
                });
            }
        }
        warnings.count_many("polygons-cut", self.polygons.len() as u64, || {
            let first = self.polygons.first().map_or(0, |p| p.at);
            (place(first), "faces of more than 3 corners were cut into triangles".to_owned())
        });
        warnings.count_many(BENT_POLYGONS, bent.n, || {
            let message = format!(
                "polygons are not flat: another program may cut them otherwise, up to {:.3e} (proved) from the triangles that \
                 are read here, and what is bounded is the distance from these",
                // The message shows four digits, rounded by less than a two-thousandth; the margin keeps the
                // shown number above the bound.
                bent.at_most * 1.001
            );
            (place(bent.first), message)
        });
        self.triangles
    }
}
