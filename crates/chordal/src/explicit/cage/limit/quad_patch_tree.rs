//! `QuadPatchTree`: a square of a sheet as patches, or subdivided lazily around extraordinary vertices.
use super::creased_spline::LimitPatch;
use super::{FaceOneRing, Jet, OneRing, middle, one_ring};
use crate::explicit::cage::InvalidCage;
use crate::explicit::cage::vertex_rule::CagePoint;
use crate::explicit::patch::{front, largest};
use std::sync::OnceLock;

/// A square; the quarters of a subdivided one start at the lower left and run counter-clockwise.
#[derive(Clone, Debug)]
pub(crate) enum QuadPatchTree {
    Regular(LimitPatches),
    Extraordinary(Box<ExtraordinaryQuad>),
}

/// The patches of a square.
#[derive(Clone, Debug)]
pub(crate) struct LimitPatches {
    pub(crate) patches: Vec<LimitPatch>,
    /// The largest rounding error of their points, as a length.
    pub(crate) off: f64,
}

/// A square that does not consist of patches.
#[derive(Clone, Debug)]
pub(crate) struct ExtraordinaryQuad {
    ring: FaceOneRing,
    quarters: OnceLock<Result<Box<[QuadPatchTree; 4]>, InvalidCage>>,
    corners: [OnceLock<Result<Jet, InvalidCage>>; 4],
}

/// After this many rounds, parameters that are still next to an irregular vertex count as the vertex.
/// Derived: 0.66⁹⁰ < 2⁻⁵³ of the face's size.
pub(super) const MOST_ROUNDS: usize = 90;

impl QuadPatchTree {
    pub(super) fn from_ring(ring: FaceOneRing) -> Self {
        match ring.patches() {
            // A point reflected in both directions has nine times the error; weights are exact up to some
            // hundred roundings.
            Some(pieces) => {
                let off = 18.0 * ring.rounding() + 1024.0 * f64::EPSILON * ring.size();
                Self::Regular(LimitPatches { patches: pieces, off })
            }
            None => Self::Extraordinary(Box::new(ExtraordinaryQuad {
                ring,
                quarters: OnceLock::new(),
                corners: Default::default(),
            })),
        }
    }

    pub(crate) fn at(&self, u: f64, v: f64) -> Result<Jet, InvalidCage> {
        match self {
            Self::Regular(patches) => Ok(patches.at([u, v], 1.0)),
            Self::Extraordinary(extraordinary) => extraordinary.at(u, v),
        }
    }

    /// The point alone.
    pub(super) fn point(&self, u: f64, v: f64) -> Result<CagePoint, InvalidCage> {
        let extraordinary = match self {
            Self::Regular(patches) => return Ok(patches.point([u, v])),
            Self::Extraordinary(extraordinary) => extraordinary,
        };
        match extraordinary.leaf_at([u, v])? {
            PatchTreeLeaf::Patches(patches, place, _) => Ok(patches.point(place)),
            PatchTreeLeaf::Vertex(extraordinary, corner) => {
                with_one_ring(&extraordinary.ring, corner, OneRing::limit)
                    .map(|jet_or_point| jet_or_point.unwrap_or_else(|point| point))
            }
        }
    }
}

/// The content of an extraordinary square at given parameters.
enum PatchTreeLeaf<'a> {
    /// Patches, the parameters in them, and the factor by which they are smaller.
    Patches(&'a LimitPatches, [f64; 2], f64),
    /// A corner of a square.
    Vertex(&'a ExtraordinaryQuad, usize),
}

impl LimitPatches {
    /// Derivatives are multiplied by `scale`.
    fn at(&self, uv: [f64; 2], scale: f64) -> Jet {
        jet(self.patch_at(uv), uv, scale)
    }

    fn point(&self, uv: [f64; 2]) -> CagePoint {
        let piece = self.patch_at(uv);
        let [s, t] = piece.local(uv);
        piece.patch.at(s, t)
    }

    fn patch_at(&self, [u, v]: [f64; 2]) -> &LimitPatch {
        let holds = |piece: &&LimitPatch| {
            let is_in = |x: f64, [from, to]: [f64; 2]| x >= from && (x < to || x <= to && to == 1.0);
            is_in(u, piece.u) && is_in(v, piece.v)
        };
        self.patches.iter().find(holds).unwrap_or(&self.patches[0])
    }
}

impl ExtraordinaryQuad {
    pub(crate) fn ring(&self) -> &FaceOneRing {
        &self.ring
    }

    /// Its quarters, computed on first use and cached.
    pub(crate) fn quarters(&self) -> Result<&[QuadPatchTree; 4], InvalidCage> {
        let divide = || {
            let mut rings = self.ring.subdivided()?.into_iter();
            let mut next =
                || rings.next().map(QuadPatchTree::from_ring).ok_or(InvalidCage::ShortFace { face: 0 });
            Ok(Box::new([next()?, next()?, next()?, next()?]))
        };
        self.quarters.get_or_init(divide).as_deref().map_err(Clone::clone)
    }

    pub(crate) fn at(&self, u: f64, v: f64) -> Result<Jet, InvalidCage> {
        match self.leaf_at([u, v])? {
            PatchTreeLeaf::Patches(patches, uv, scale) => Ok(patches.at(uv, scale)),
            PatchTreeLeaf::Vertex(extraordinary, corner) => extraordinary.corner_jet(corner),
        }
    }

    /// The jet at a corner, computed on first use and cached.
    fn corner_jet(&self, corner: usize) -> Result<Jet, InvalidCage> {
        self.corners[corner].get_or_init(|| vertex_jet(&self.ring, corner)).clone()
    }

    fn leaf_at(&self, [mut u, mut v]: [f64; 2]) -> Result<PatchTreeLeaf<'_>, InvalidCage> {
        let (mut extraordinary, mut scale) = (self, 1.0);
        for _ in 0..MOST_ROUNDS {
            if let Some(corner) = corner_at(u, v) {
                return Ok(PatchTreeLeaf::Vertex(extraordinary, corner));
            }
            let quarter = nearest_corner(u, v);
            let shift = |x: f64| if x >= 0.5 { 2.0 * x - 1.0 } else { 2.0 * x };
            (u, v, scale) = (shift(u), shift(v), 2.0 * scale);
            match &extraordinary.quarters()?[quarter] {
                QuadPatchTree::Regular(patches) => return Ok(PatchTreeLeaf::Patches(patches, [u, v], scale)),
                QuadPatchTree::Extraordinary(quarter) => extraordinary = quarter,
            }
        }
        Ok(PatchTreeLeaf::Vertex(extraordinary, nearest_corner(u, v)))
    }
}

/// The corner of the unit square at these parameters.
fn corner_at(u: f64, v: f64) -> Option<usize> {
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    corners.iter().position(|corner| *corner == (u, v))
}

fn nearest_corner(u: f64, v: f64) -> usize {
    match (u >= 0.5, v >= 0.5) {
        (false, false) => 0,
        (true, false) => 1,
        (true, true) => 2,
        (false, true) => 3,
    }
}

fn jet(piece: &LimitPatch, [u, v]: [f64; 2], scale: f64) -> Jet {
    let wide = [piece.u, piece.v].map(|[from, to]| to - from);
    let [s, t] = piece.local([u, v]);
    let scale = wide.map(|wide| scale / wide);
    let [by_u, by_v] = piece.patch.tangents(s, t);
    let [uu, uv, vv] = piece.patch.second_derivatives(s, t);
    Jet {
        point: piece.patch.at(s, t),
        first: Some([by_u.map(|x| x * scale[0]), by_v.map(|x| x * scale[1])]),
        second: Some([
            uu.map(|x| x * scale[0] * scale[0]),
            uv.map(|x| x * scale[0] * scale[1]),
            vv.map(|x| x * scale[1] * scale[1]),
        ]),
        normal: piece.patch.normal(s, t),
    }
}

/// The jet at a corner of a ring's face that may be irregular.
pub(super) fn vertex_jet(ring: &FaceOneRing, corner: usize) -> Result<Jet, InvalidCage> {
    let jet_or_point = with_one_ring(ring, corner, |fan| {
        let [a, b] = fan.tangents();
        let (unit, length) = front(a, b);
        let least = one_ring::LEAST_AREA * largest(a) * largest(b);
        let normal = (length > least && length.is_finite()).then_some(unit);
        Jet { point: fan.limit(), first: None, second: None, normal }
    })?;
    Ok(jet_or_point.unwrap_or_else(|point| Jet { point, first: None, second: None, normal: None }))
}

/// Applies `of` to the one-ring of a corner of a ring's face, once its neighbourhood no longer changes. If it
/// always changes, returns a point near it.
fn with_one_ring<T>(
    ring: &FaceOneRing,
    corner: usize,
    of: impl FnOnce(&OneRing) -> T,
) -> Result<Result<T, CagePoint>, InvalidCage> {
    let mut held;
    let mut ring = ring;
    // Finite sharpness ends within ten rounds.
    for _ in 0..MOST_ROUNDS {
        if let Some(fan) = OneRing::around_corner(ring, &ring.topology(), corner) {
            return Ok(Ok(of(&fan)));
        }
        held = ring.subdivided()?.swap_remove(corner);
        ring = &held;
    }
    Ok(Err(middle(ring.hull())))
}
