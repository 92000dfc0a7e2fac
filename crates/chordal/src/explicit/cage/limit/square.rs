//! `Square`: a square of a sheet as patches, or divided, as deep as anybody has asked.
use super::spline::Piece;
use super::{Fan, Jet, Ring, fan, middle};
use crate::explicit::cage::InvalidCage;
use crate::explicit::cage::rules::Point;
use crate::explicit::patch::{front, largest};
use std::sync::OnceLock;

/// A square, lower left quarter first and then counter-clockwise where it is divided.
#[derive(Clone, Debug)]
pub(crate) enum Square {
    Patches(Patches),
    Rough(Box<Rough>),
}

/// The patches that a square is made of.
#[derive(Clone, Debug)]
pub(crate) struct Patches {
    pub(crate) pieces: Vec<Piece>,
    /// By how much a point of theirs may be off by rounding, a length.
    pub(crate) off: f64,
}

/// A square that is not made of patches.
#[derive(Clone, Debug)]
pub(crate) struct Rough {
    ring: Ring,
    quarters: OnceLock<Result<Box<[Square; 4]>, InvalidCage>>,
    corners: [OnceLock<Result<Jet, InvalidCage>>; 4],
}

/// Rounds after which a place that is still beside an irregular vertex counts as the vertex: 0.66⁹⁰ < 2⁻⁵³ of the face's size.
pub(super) const MOST_ROUNDS: usize = 90;

impl Square {
    pub(super) fn of(ring: Ring) -> Self {
        match ring.pieces() {
            // Reflected in both directions a point is off by nine times as much; weights are exact but for some hundred roundings.
            Some(pieces) => {
                let off = 18.0 * ring.off() + 1024.0 * f64::EPSILON * ring.size();
                Self::Patches(Patches { pieces, off })
            }
            None => {
                Self::Rough(Box::new(Rough { ring, quarters: OnceLock::new(), corners: Default::default() }))
            }
        }
    }

    pub(crate) fn at(&self, u: f64, v: f64) -> Result<Jet, InvalidCage> {
        match self {
            Self::Patches(patches) => Ok(patches.at([u, v], 1.0)),
            Self::Rough(rough) => rough.at(u, v),
        }
    }

    /// The point alone.
    pub(super) fn point(&self, u: f64, v: f64) -> Result<Point, InvalidCage> {
        let rough = match self {
            Self::Patches(patches) => return Ok(patches.point([u, v])),
            Self::Rough(rough) => rough,
        };
        match rough.part_at([u, v])? {
            Part::Patches(patches, place, _) => Ok(patches.point(place)),
            Part::Vertex(rough, corner) => {
                with_fan(&rough.ring, corner, Fan::limit).map(|found| found.unwrap_or_else(|point| point))
            }
        }
    }
}

/// What a rough square is at a place.
enum Part<'a> {
    /// These patches, there in them, by how much smaller they are.
    Patches(&'a Patches, [f64; 2], f64),
    /// A corner of a square.
    Vertex(&'a Rough, usize),
}

impl Patches {
    /// Derivatives are multiplied by a scale.
    fn at(&self, place: [f64; 2], scale: f64) -> Jet {
        jet(self.piece(place), place, scale)
    }

    fn point(&self, place: [f64; 2]) -> Point {
        let piece = self.piece(place);
        let [s, t] = piece.local(place);
        piece.patch.at(s, t)
    }

    fn piece(&self, [u, v]: [f64; 2]) -> &Piece {
        let holds = |piece: &&Piece| {
            let is_in = |x: f64, [from, to]: [f64; 2]| x >= from && (x < to || x <= to && to == 1.0);
            is_in(u, piece.u) && is_in(v, piece.v)
        };
        self.pieces.iter().find(holds).unwrap_or(&self.pieces[0])
    }
}

impl Rough {
    pub(crate) fn ring(&self) -> &Ring {
        &self.ring
    }

    /// Its quarters: made when they are first asked for, and kept.
    pub(crate) fn quarters(&self) -> Result<&[Square; 4], InvalidCage> {
        let divide = || {
            let mut rings = self.ring.divided()?.into_iter();
            let mut next = || rings.next().map(Square::of).ok_or(InvalidCage::ShortFace { face: 0 });
            Ok(Box::new([next()?, next()?, next()?, next()?]))
        };
        self.quarters.get_or_init(divide).as_deref().map_err(Clone::clone)
    }

    pub(crate) fn at(&self, u: f64, v: f64) -> Result<Jet, InvalidCage> {
        match self.part_at([u, v])? {
            Part::Patches(patches, place, scale) => Ok(patches.at(place, scale)),
            Part::Vertex(rough, corner) => rough.corner(corner),
        }
    }

    /// What is at a corner: found out when it is first asked for, and kept.
    fn corner(&self, corner: usize) -> Result<Jet, InvalidCage> {
        self.corners[corner].get_or_init(|| vertex(&self.ring, corner)).clone()
    }

    fn part_at(&self, [mut u, mut v]: [f64; 2]) -> Result<Part<'_>, InvalidCage> {
        let (mut rough, mut scale) = (self, 1.0);
        for _ in 0..MOST_ROUNDS {
            if let Some(corner) = corner_at(u, v) {
                return Ok(Part::Vertex(rough, corner));
            }
            let quarter = nearest_corner(u, v);
            let shift = |x: f64| if x >= 0.5 { 2.0 * x - 1.0 } else { 2.0 * x };
            (u, v, scale) = (shift(u), shift(v), 2.0 * scale);
            match &rough.quarters()?[quarter] {
                Square::Patches(patches) => return Ok(Part::Patches(patches, [u, v], scale)),
                Square::Rough(quarter) => rough = quarter,
            }
        }
        Ok(Part::Vertex(rough, nearest_corner(u, v)))
    }
}

/// The corner of the unit square at a place.
fn corner_at(u: f64, v: f64) -> Option<usize> {
    let places = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    places.iter().position(|place| *place == (u, v))
}

fn nearest_corner(u: f64, v: f64) -> usize {
    match (u >= 0.5, v >= 0.5) {
        (false, false) => 0,
        (true, false) => 1,
        (true, true) => 2,
        (false, true) => 3,
    }
}

fn jet(piece: &Piece, [u, v]: [f64; 2], scale: f64) -> Jet {
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

/// At a corner of a ring's face that may be irregular.
pub(super) fn vertex(ring: &Ring, corner: usize) -> Result<Jet, InvalidCage> {
    let found = with_fan(ring, corner, |fan| {
        let [a, b] = fan.tangents();
        let (unit, length) = front(a, b);
        let least = fan::LEAST_AREA * largest(a) * largest(b);
        let normal = (length > least && length.is_finite()).then_some(unit);
        Jet { point: fan.limit(), first: None, second: None, normal }
    })?;
    Ok(found.unwrap_or_else(|point| Jet { point, first: None, second: None, normal: None }))
}

/// What follows from the fan around a corner of a ring's face, once its surroundings do not change any more; where they always do, a
/// point near it.
fn with_fan<T>(
    ring: &Ring,
    corner: usize,
    of: impl FnOnce(&Fan) -> T,
) -> Result<Result<T, Point>, InvalidCage> {
    let mut held;
    let mut ring = ring;
    // Sharpness that ends does so within ten rounds.
    for _ in 0..MOST_ROUNDS {
        if let Some(fan) = Fan::of(ring, &ring.parts(), corner) {
            return Ok(Ok(of(&fan)));
        }
        held = ring.divided()?.swap_remove(corner);
        ring = &held;
    }
    Ok(Err(middle(ring.hull())))
}
