//! `LimitSurface`: the limit surface of a cage, evaluated exactly at any parameters.
mod box_spline;
mod creased_spline;
mod face_one_ring;
mod loop_one_ring;
mod one_ring;
mod quad_patch_tree;
mod quartic;
mod triangle_patch_tree;

use super::vertex_rule::CagePoint;
use super::{Cage, InvalidCage, Scheme};
use crate::math::lesser;
pub(super) use face_one_ring::CageTopology;
pub(crate) use face_one_ring::FaceOneRing;
use one_ring::OneRing;
pub(crate) use quad_patch_tree::{ExtraordinaryQuad, LimitPatches, QuadPatchTree};
pub(crate) use quartic::{QUARTERS, Quartic};
pub(crate) use triangle_patch_tree::{ExtraordinaryTriangle, LimitQuartic, TrianglePatchTree};

/// The smooth surface to which refining a cage converges, as sheets over unit squares, or over triangles for
/// Loop's scheme.
///
/// A quad is one sheet: u runs from its first vertex to its second, v from its first to its last. Another
/// polygon has one sheet for each vertex, with the origin at that vertex and the polygon's centre diagonally
/// opposite. For Loop's scheme a triangle is one sheet, over u ≥ 0, v ≥ 0, u + v ≤ 1: u runs from its first
/// vertex to its second, v to its third. Sheets follow the order of faces. Holes have no sheets, nor have
/// faces on the border under [`Boundary::None`](super::Boundary::None).
///
/// ```
/// use chordal::explicit::Cage;
/// let corner = |i: u32| [0, 1, 2].map(|k| if i >> k & 1 == 0 { -1.0 } else { 1.0 });
/// let sides: [&[u32]; 6] = [&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]];
/// let cube = Cage::new((0..8).map(corner).collect(), sides)?;
/// let limit = cube.limit()?;
/// assert_eq!(limit.n_sheets(), 6);
/// // n² of a vertex, 4 of each neighbour and 1 of each vertex across, n = 3: a corner goes to (9 + 4·1 − 1)/24 of itself.
/// let jet = limit.sheet(0)?.at(0.0, 0.0)?;
/// assert!(jet.point.iter().all(|x| (x + 0.5).abs() < 1e-15));
/// // In the middle of a side the surface looks straight out.
/// let normal = limit.sheet(0)?.at(0.5, 0.5)?.normal.unwrap();
/// assert!(normal[0].abs() < 1e-15 && normal[1].abs() < 1e-15 && normal[2] == -1.0);
/// # Ok::<(), chordal::explicit::InvalidCage>(())
/// ```
#[derive(Clone)]
pub struct LimitSurface<'a> {
    cage: &'a Cage,
    topology: std::sync::Arc<CageTopology>,
    /// The face, and the part of the face.
    sheets: Vec<(u32, u32)>,
}

impl Cage {
    /// The limit surface. For Loop's scheme, edges of a round with the same ends stay separate, as for
    /// [`Cage::refined_times`].
    ///
    /// *Cost.* A table of edges: some hundred bytes per corner.
    ///
    /// # Errors
    /// None yet: every scheme has one.
    pub fn limit(&self) -> Result<LimitSurface<'_>, InvalidCage> {
        let parts = CageTopology::new(self);
        let with_surface = (0..self.n_faces()).filter(|face| !parts.is_hole(self, *face));
        let sheets = with_surface.flat_map(|face| {
            let n = self.face(face).len();
            let is_one = n == 4 || self.scheme == Scheme::Loop;
            (0..if is_one { 1 } else { n }).map(move |part| (face as u32, part as u32))
        });
        Ok(LimitSurface { cage: self, sheets: sheets.collect(), topology: std::sync::Arc::new(parts) })
    }
}

impl LimitSurface<'_> {
    /// The number of sheets.
    #[must_use]
    pub fn n_sheets(&self) -> usize {
        self.sheets.len()
    }

    /// The face of a sheet, and the corner at which the sheet starts.
    ///
    /// # Panics
    /// When there is no such sheet.
    #[must_use]
    pub fn face_of(&self, sheet: usize) -> (usize, usize) {
        let (face, corner) = self.sheets[sheet];
        (face as usize, corner as usize)
    }

    /// One sheet, prepared for evaluation.
    ///
    /// # Errors
    /// [`InvalidCage::NotFinite`] if coordinates overflow.
    ///
    /// # Panics
    /// When there is no such sheet.
    pub fn sheet(&self, sheet: usize) -> Result<LimitSheet, InvalidCage> {
        let (face, corner) = self.face_of(sheet);
        let ring = FaceOneRing::new(self.cage, &self.topology, face);
        if self.cage.scheme == Scheme::Loop {
            return Ok(LimitSheet { domain: SheetDomain::Triangle(TrianglePatchTree::from_ring(ring)) });
        }
        if ring.n_corners() == 4 {
            return Ok(LimitSheet { domain: SheetDomain::Square(QuadPatchTree::from_ring(ring)) });
        }
        let mut rings = ring.subdivided()?;
        Ok(LimitSheet { domain: SheetDomain::Square(QuadPatchTree::from_ring(rings.swap_remove(corner))) })
    }

    pub(crate) fn cage(&self) -> &Cage {
        self.cage
    }

    pub(crate) fn edges(&self) -> &super::edges::CageEdges {
        &self.topology.edges
    }
}

/// One sheet of a limit surface.
#[derive(Clone, Debug)]
pub struct LimitSheet {
    domain: SheetDomain,
}

#[derive(Clone, Debug)]
enum SheetDomain {
    Square(QuadPatchTree),
    Triangle(TrianglePatchTree),
}

/// The position, derivatives and normal of a surface at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// The position.
    pub point: [f64; 3],
    /// The derivatives by u and by v; `None` at vertices where the parametrization has none, or where both
    /// are 0.
    pub first: Option<[[f64; 3]; 2]>,
    /// The second derivatives: by u twice, by u and v, by v twice.
    pub second: Option<[[f64; 3]; 3]>,
    /// The unit normal of the front; `None` if the surface has none at the point.
    pub normal: Option<[f64; 3]>,
}

impl LimitSheet {
    /// The limit surface at a point of the unit square, or of the triangle u + v ≤ 1 for Loop's scheme, with
    /// its derivatives and its normal. Parameters outside are clamped to the border.
    ///
    /// On an infinitely sharp edge, whose two sides differ, all values are those of this sheet. Where the
    /// surface consists of pieces, they are those of the piece after u and v, or of the last piece.
    ///
    /// *Cost.* Under a microsecond if the surrounding faces are regular. Otherwise, the first time, some ten
    /// microseconds for every halving of the distance to the extraordinary vertex; the halvings are cached.
    /// *Error.* Rounding: a few ulps of the largest coordinate around, a few more for each halving. At the
    /// end of a crease, and at corners of several quads, the normal has about six digits.
    ///
    /// # Errors
    /// [`InvalidCage::NotFinite`] if coordinates overflow.
    pub fn at(&self, u: f64, v: f64) -> Result<Jet, InvalidCage> {
        let clamp = |x: f64| if x > 0.0 { lesser(x, 1.0) } else { 0.0 };
        let (u, v) = (clamp(u), clamp(v));
        match &self.domain {
            SheetDomain::Square(square) => square.at(u, v),
            SheetDomain::Triangle(triangle) => triangle.at(u, if u + v > 1.0 { 1.0 - u } else { v }),
        }
    }

    /// Only the point, at a lower cost.
    pub(crate) fn point(&self, u: f64, v: f64) -> Result<[f64; 3], InvalidCage> {
        match &self.domain {
            SheetDomain::Square(square) => square.point(u, v),
            SheetDomain::Triangle(_) => self.at(u, v).map(|jet| jet.point),
        }
    }

    /// Its square; `None` for Loop's scheme.
    pub(crate) fn square(&self) -> Option<&QuadPatchTree> {
        match &self.domain {
            SheetDomain::Square(square) => Some(square),
            SheetDomain::Triangle(_) => None,
        }
    }

    /// Its triangle, for Loop's scheme.
    pub(crate) fn triangle(&self) -> Option<&TrianglePatchTree> {
        match &self.domain {
            SheetDomain::Square(_) => None,
            SheetDomain::Triangle(triangle) => Some(triangle),
        }
    }
}

fn middle(points: &[CagePoint]) -> CagePoint {
    let share = 1.0 / points.len() as f64;
    points.iter().fold([0.0; 3], |sum, p| super::vertex_rule::plus(sum, share, *p))
}
