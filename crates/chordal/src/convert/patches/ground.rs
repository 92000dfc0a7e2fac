//! `Ground`: what a surface is over a rectangle of one of its sheets.
use super::bend::rounding;
use super::plan::{Allowance, Obstacle, Tile};
use super::quilt::Quilt;
use super::rough::Rough;
use crate::budget::Reference;
use crate::explicit::{Patch, Sheet};
use crate::math::Box3;

/// A surface as sheets over unit squares that meet along their sides.
pub(crate) trait Sheets: Sync {
    /// How many there are.
    fn count(&self) -> usize;

    /// The grounds that a sheet is cut into: no larger than an allowance has use for, by `strain` times where they are no patches.
    fn grounds(&self, sheet: usize, need: (&Allowance, f64)) -> Result<Vec<Ground<'_>>, Obstacle>;

    /// Which sides are the same curve.
    fn quilt(&self) -> Quilt;

    /// The longest diagonal of a box around a sheet, and no less than what rounding may lose.
    fn longest_diagonal(&self) -> f64;

    /// What a bound is against.
    fn reference(&self) -> Reference;

    /// Whether some sheets have texture coordinates.
    fn has_texcoords(&self) -> bool {
        false
    }

    /// The texture coordinates of a sheet, as x and y over the same square.
    fn texcoords(&self, _sheet: usize) -> Option<Sheet> {
        None
    }
}

/// A rectangle of a sheet and the surface over it.
pub(crate) struct Ground<'a> {
    pub(crate) sheet: u32,
    pub(crate) u: [f64; 2],
    pub(crate) v: [f64; 2],
    pub(crate) shape: Shape<'a>,
    /// By how much the shape may be off the surface, a length.
    pub(crate) off: f64,
}

pub(crate) enum Shape<'a> {
    Bezier(Box<Patch>),
    Rough(&'a Rough),
}

impl Ground<'_> {
    /// Where a place of the sheet is in the shape's unit square. Exact at the corners of tiles: those are where halving gets.
    fn local(&self, u: f64, v: f64) -> (f64, f64) {
        let within = |x: f64, [from, to]: [f64; 2]| (x - from) / (to - from);
        (within(u, self.u), within(v, self.v))
    }

    pub(crate) fn at(&self, u: f64, v: f64) -> [f64; 3] {
        let (u, v) = self.local(u, v);
        match &self.shape {
            Shape::Bezier(patch) => patch.at(u, v),
            Shape::Rough(rough) => rough.point(u, v),
        }
    }

    pub(crate) fn normal(&self, u: f64, v: f64) -> Option<[f64; 3]> {
        let (u, v) = self.local(u, v);
        match &self.shape {
            Shape::Bezier(patch) => patch.normal(u, v),
            Shape::Rough(rough) => rough.normal(u, v),
        }
    }

    /// The patch over a tile.
    pub(crate) fn part(&self, patch: &Patch, tile: &Tile) -> Patch {
        let ((u0, v0), (u1, v1)) = (self.local(tile.u[0], tile.v[0]), self.local(tile.u[1], tile.v[1]));
        patch.part([u0, u1], [v0, v1])
    }

    /// A box around a tile.
    pub(crate) fn hull(&self, tile: &Tile) -> Box3 {
        match &self.shape {
            Shape::Bezier(patch) => self.part(patch, tile).hull(),
            Shape::Rough(rough) => Box3::around(rough.ring().hull()),
        }
    }

    /// What rounding may add to a bound.
    pub(crate) fn lost(&self) -> f64 {
        match &self.shape {
            Shape::Bezier(patch) => rounding(patch) + self.off,
            Shape::Rough(rough) => rough.lost(),
        }
    }
}

/// Bézier patches, a sheet each.
pub(crate) struct Patches<'a>(pub(crate) &'a [Patch]);

impl Sheets for Patches<'_> {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn grounds(&self, sheet: usize, _: (&Allowance, f64)) -> Result<Vec<Ground<'_>>, Obstacle> {
        let (u, v) = ([0.0, 1.0], [0.0, 1.0]);
        Ok(vec![Ground {
            sheet: sheet as u32,
            u,
            v,
            shape: Shape::Bezier(Box::new(self.0[sheet])),
            off: 0.0,
        }])
    }

    fn quilt(&self) -> Quilt {
        Quilt::new(self.0)
    }

    fn longest_diagonal(&self) -> f64 {
        // No shorter than what rounding may lose, so that patches that are all but points meet the first rung.
        let own = |patch: &Patch| {
            let (diagonal, lost) = (patch.hull().diagonal(), rounding(patch));
            if diagonal > lost { diagonal } else { lost }
        };
        self.0.iter().map(own).fold(0.0, |longest, d| if d > longest { d } else { longest })
    }

    fn reference(&self) -> Reference {
        Reference::BezierPatches
    }
}
