//! `Subpatch`: the surface over a rectangle of one of its sheets.
use super::adjacency::PatchAdjacency;
use super::allowance::{Allowance, InfeasibleTolerance};
use super::derivative_bound::{ROUNDING, UNDERFLOW, rounding};
use super::patch_tile::PatchTile;
use crate::budget::Reference;
use crate::explicit::cage::limit::ExtraordinaryQuad;
use crate::explicit::{LimitSheet, Patch};
use crate::math::{Box3, greater};

/// A surface made of sheets over unit squares that meet along their sides.
pub(crate) trait PatchSurface<'a>: Sync {
    /// The number of sheets.
    fn count(&self) -> usize;

    /// The subpatches of a sheet, as large as the allowance permits; for extraordinary ones it is divided by
    /// `safety_factor`.
    fn subpatches(
        &self,
        sheet: usize,
        allowance: &Allowance,
        safety_factor: f64,
    ) -> Result<Vec<Subpatch<'a>>, InfeasibleTolerance>;

    /// Which sides are the same curve.
    fn adjacency(&self) -> PatchAdjacency;

    /// The longest diagonal of a box around a sheet; at least the rounding error.
    fn longest_diagonal(&self) -> f64;

    /// The true shape that bounds refer to.
    fn reference(&self) -> Reference;

    /// Whether some sheets have texture coordinates.
    fn has_texcoords(&self) -> bool {
        false
    }

    /// The texture coordinates of a sheet, as x and y over the same square.
    fn texcoords(&self, _sheet: usize) -> Option<LimitSheet> {
        None
    }
}

/// A rectangle of a sheet and the surface over it.
pub(crate) struct Subpatch<'a> {
    pub(crate) sheet: u32,
    pub(crate) u: [f64; 2],
    pub(crate) v: [f64; 2],
    pub(crate) shape: SubpatchShape<'a>,
    /// The largest distance of the shape from the surface.
    pub(crate) slack: f64,
}

pub(crate) enum SubpatchShape<'a> {
    Bezier(Box<Patch>),
    Extraordinary(&'a ExtraordinaryQuad),
}

/// The kind of surface of a subpatch.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum SubpatchKind {
    Bezier,
    Extraordinary,
}

impl Subpatch<'_> {
    pub(crate) fn kind(&self) -> SubpatchKind {
        match self.shape {
            SubpatchShape::Bezier(_) => SubpatchKind::Bezier,
            SubpatchShape::Extraordinary(_) => SubpatchKind::Extraordinary,
        }
    }

    /// The parameters of a point of the sheet in the shape's unit square. Exact at the corners of tiles,
    /// which result from halving.
    fn local(&self, u: f64, v: f64) -> (f64, f64) {
        let within = |x: f64, [from, to]: [f64; 2]| (x - from) / (to - from);
        (within(u, self.u), within(v, self.v))
    }

    pub(crate) fn at(&self, u: f64, v: f64) -> [f64; 3] {
        let (u, v) = self.local(u, v);
        match &self.shape {
            SubpatchShape::Bezier(patch) => patch.at(u, v),
            SubpatchShape::Extraordinary(extraordinary) => extraordinary.point(u, v),
        }
    }

    pub(crate) fn normal(&self, u: f64, v: f64) -> Option<[f64; 3]> {
        let (u, v) = self.local(u, v);
        match &self.shape {
            SubpatchShape::Bezier(patch) => patch.normal(u, v),
            SubpatchShape::Extraordinary(extraordinary) => extraordinary.normal(u, v),
        }
    }

    /// The patch over a tile.
    pub(crate) fn tile_patch(&self, patch: &Patch, tile: &PatchTile) -> Patch {
        let ((u0, v0), (u1, v1)) = (self.local(tile.u[0], tile.v[0]), self.local(tile.u[1], tile.v[1]));
        patch.part([u0, u1], [v0, v1])
    }

    /// A box around a tile.
    pub(crate) fn hull(&self, tile: &PatchTile) -> Box3 {
        match &self.shape {
            SubpatchShape::Bezier(patch) => self.tile_patch(patch, tile).bounds(),
            SubpatchShape::Extraordinary(extraordinary) => Box3::from_points(extraordinary.ring().hull()),
        }
    }

    /// The length that rounding may add to a bound.
    pub(crate) fn rounding_error(&self) -> f64 {
        match &self.shape {
            SubpatchShape::Bezier(patch) => rounding(patch) + self.slack,
            SubpatchShape::Extraordinary(extraordinary) => extraordinary.rounding_error(),
        }
    }
}

impl ExtraordinaryQuad {
    /// The point at a parameter of the unit square. Coordinates are small enough by an earlier check that nothing
    /// overflows.
    pub(crate) fn point(&self, u: f64, v: f64) -> [f64; 3] {
        self.at(u, v).map(|jet| jet.point).unwrap_or_default()
    }

    pub(crate) fn normal(&self, u: f64, v: f64) -> Option<[f64; 3]> {
        self.at(u, v).ok()?.normal
    }

    /// The length that rounding may add to a bound: as for a patch, plus the error of its own subdivision.
    pub(crate) fn rounding_error(&self) -> f64 {
        let ring = self.ring();
        2.0 * ROUNDING * ring.size() + UNDERFLOW + 36.0 * ring.rounding()
    }
}

/// Bézier patches, one sheet each.
pub(crate) struct BezierPatches(pub(crate) Vec<Patch>);

impl<'a> PatchSurface<'a> for BezierPatches {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn subpatches(
        &self,
        sheet: usize,
        _allowance: &Allowance,
        _safety_factor: f64,
    ) -> Result<Vec<Subpatch<'a>>, InfeasibleTolerance> {
        let (u, v) = ([0.0, 1.0], [0.0, 1.0]);
        Ok(vec![Subpatch {
            sheet: sheet as u32,
            u,
            v,
            shape: SubpatchShape::Bezier(Box::new(self.0[sheet])),
            slack: 0.0,
        }])
    }

    fn adjacency(&self) -> PatchAdjacency {
        PatchAdjacency::new(&self.0)
    }

    fn longest_diagonal(&self) -> f64 {
        // At least the rounding error, so that patches that are nearly points meet the first length of the series.
        let size_of = |patch: &Patch| {
            let (diagonal, lost) = (patch.bounds().diagonal(), rounding(patch));
            greater(diagonal, lost)
        };
        self.0.iter().map(size_of).fold(0.0, |longest, d| greater(d, longest))
    }

    fn reference(&self) -> Reference {
        Reference::BezierPatches
    }
}
