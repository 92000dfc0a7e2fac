//! `TrimmedSurface`: the part of a NURBS surface that loops in its parameter plane enclose.
use super::NurbsSurface;
use crate::explicit::Curve;
use std::fmt;

/// A part of a NURBS surface, a *face* of a solid in CAD.
///
/// The loops are closed paths in the plane of the parameters `u` and `v`, which need not touch: what is to their left
/// belongs to the surface, so that outer loops run counter-clockwise and holes clockwise. Without a loop it is all of the
/// surface.
///
/// ```
/// use chordal::explicit::nurbs::{NurbsCurve, NurbsSurface, TrimmedSurface};
/// let square = NurbsSurface::extruded(&NurbsCurve::line([0.0; 3], [1.0, 0.0, 0.0])?, [0.0, 1.0, 0.0])?;
/// let circle = NurbsCurve::circle([0.5, 0.5], [[0.25, 0.0], [0.0, 0.25]])?.to_curve()?;
/// let disc = TrimmedSurface::new(square.clone(), vec![circle])?;
/// assert_eq!(disc.loops().len(), 1);
/// assert!(TrimmedSurface::from(square).loops().is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TrimmedSurface {
    surface: NurbsSurface,
    loops: Vec<Curve<2>>,
    is_flipped: bool,
}

/// So far, relative to the range of a parameter, may a loop leave it: what is outside is cut off. Chosen: CAD programs
/// write parameters with some digits less than they compute with.
const OUTSIDE: f64 = 1e-6;

impl TrimmedSurface {
    /// # Errors
    /// When a loop is not closed, or leaves the range of the surface's parameters.
    pub fn new(surface: NurbsSurface, loops: Vec<Curve<2>>) -> Result<Self, InvalidTrim> {
        for (index, path) in loops.iter().enumerate() {
            if !path.is_closed() {
                return Err(InvalidTrim::Open(index));
            }
            let [low, high] = path.bounds();
            let is_inside = |k: usize| {
                let [from, to] = surface.knots()[k].domain();
                let room = OUTSIDE * (to - from);
                low[k] >= from - room && high[k] <= to + room
            };
            if !(is_inside(0) && is_inside(1)) {
                return Err(InvalidTrim::Outside(index));
            }
        }
        Ok(Self { surface, loops, is_flipped: false })
    }

    /// The same part with its front where the back was.
    #[must_use]
    pub fn flipped(mut self) -> Self {
        self.is_flipped = !self.is_flipped;
        self
    }

    /// The surface.
    #[must_use]
    pub fn surface(&self) -> &NurbsSurface {
        &self.surface
    }

    /// The loops around the part; none where it is all of the surface.
    #[must_use]
    pub fn loops(&self) -> &[Curve<2>] {
        &self.loops
    }

    /// Whether the front is the surface's back.
    #[must_use]
    pub fn is_flipped(&self) -> bool {
        self.is_flipped
    }

    /// Whether this is all of a surface, as it stands.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.loops.is_empty() && !self.is_flipped
    }
}

impl From<NurbsSurface> for TrimmedSurface {
    fn from(surface: NurbsSurface) -> Self {
        Self { surface, loops: Vec::new(), is_flipped: false }
    }
}

/// Why loops trim no surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InvalidTrim {
    /// The loop with this index does not end where it starts.
    Open(usize),
    /// The loop with this index leaves the range of the surface's parameters.
    Outside(usize),
}

impl fmt::Display for InvalidTrim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Open(index) => write!(f, "trim loop {index} does not end where it starts"),
            Self::Outside(index) => {
                write!(f, "trim loop {index} leaves the range of the surface's parameters")
            }
        }
    }
}

impl std::error::Error for InvalidTrim {}
