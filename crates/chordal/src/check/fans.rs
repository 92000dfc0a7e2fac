//! Fans: the triangles around a position, each sharing an edge with the next, and the boundary loops that they close.
use crate::explicit::{Twin, Twins, next_in_face, previous_in_face};

/// A way across an edge around one of its ends: the half-edge, and whether the position is its origin or its end.
#[derive(Clone, Copy)]
enum Way {
    /// Around the origin of the half-edge.
    Out(u32),
    /// Around the end of the half-edge.
    In(u32),
}

impl Way {
    fn edge(self) -> u32 {
        match self {
            Self::Out(edge) | Self::In(edge) => edge,
        }
    }

    /// The corner, named by its outgoing half-edge, that is left by this way.
    #[inline]
    fn corner(self) -> u32 {
        match self {
            Self::Out(edge) => edge,
            Self::In(edge) => next_in_face(edge),
        }
    }

    /// Into the next triangle of the fan and to the edge on its far side; what stands there instead if there is none.
    /// A pair of ways over an edge belongs together both ways round, so a walk never runs into its own middle.
    #[inline]
    fn across(self, twins: &Twins) -> Result<Self, Twin> {
        match (self, twins.get(self.edge())) {
            (Self::Out(_), Twin::Pair(t)) | (Self::In(_), Twin::Flipped(t)) => Ok(Self::Out(next_in_face(t))),
            (Self::In(_), Twin::Pair(t)) | (Self::Out(_), Twin::Flipped(t)) => {
                Ok(Self::In(previous_in_face(t)))
            }
            (_, nothing) => Err(nothing),
        }
    }

    /// Around the same position up to the edge where its fan ends.
    fn to_end_of_fan(mut self, twins: &Twins) -> Self {
        while let Ok(next) = self.across(twins) {
            self = next;
        }
        self
    }

    /// Having come to a boundary edge at one end: along it to its other end, and on into the triangle there.
    fn along(self) -> Self {
        match self {
            Self::Out(edge) => Self::Out(next_in_face(edge)),
            Self::In(edge) => Self::In(previous_in_face(edge)),
        }
    }
}

/// The fans at each position: none where no triangle is, one where the surface is manifold.
///
/// Calls `each` with the first half-edge of every fan and its number at the position (0, 1, or 2 for all after), in the
/// order of the half-edges.
pub(super) fn count_fans(
    twins: &Twins,
    origin: impl Fn(u32) -> u32,
    n_rows: usize,
    mut each: impl FnMut(u32, u8),
) {
    let mut fans = vec![0_u8; n_rows];
    let mut seen = vec![false; twins.len()];
    for corner in 0..twins.len() as u32 {
        if seen[corner as usize] || twins.get(corner) == Twin::Collapsed {
            continue;
        }
        if !mark(Way::Out(corner), twins, &mut seen) {
            mark(Way::In(previous_in_face(corner)), twins, &mut seen);
        }
        let count = &mut fans[origin(corner) as usize];
        each(corner, *count);
        *count = if *count == 0 { 1 } else { 2 };
    }
}

/// Marks the corners of a fan in one direction. True when that leads back to the first.
fn mark(start: Way, twins: &Twins, seen: &mut [bool]) -> bool {
    let first = start.corner();
    let mut way = start;
    loop {
        seen[way.corner() as usize] = true;
        match way.across(twins) {
            Ok(next) if next.corner() == first => return true,
            Ok(next) => way = next,
            Err(_) => return false,
        }
    }
}

/// How a string of boundary edges ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ending {
    /// Where it began.
    Loop,
    /// At edges with three or more faces.
    Chain,
}

/// Strings the boundary edges together through the fan at each end, so that two loops that touch at a position, one
/// fan each, stay two. Calls `each` with the first half-edge of every string.
pub(super) fn walk_boundary(twins: &Twins, mut each: impl FnMut(u32, Ending)) {
    let mut seen = vec![false; twins.len()];
    for start in 0..twins.len() as u32 {
        if seen[start as usize] || twins.get(start) != Twin::Boundary {
            continue;
        }
        let mut see = |h: u32| seen[h as usize] = true;
        if string(start, Way::Out(start), twins, &mut see) {
            each(start, Ending::Loop);
        } else {
            string(start, Way::In(start), twins, &mut see);
            each(start, Ending::Chain);
        }
    }
}

/// All boundary half-edges of the string that `start` is on, as [`walk_boundary`] counts them.
pub(crate) fn boundary_string(twins: &Twins, start: u32) -> Vec<u32> {
    let mut all = Vec::new();
    if !string(start, Way::Out(start), twins, &mut |h| all.push(h)) {
        string(start, Way::In(start), twins, &mut |h| all.push(h));
    }
    all
}

/// Follows the boundary from `start`, entering that edge by `way`. True when it comes back.
fn string(start: u32, way: Way, twins: &Twins, see: &mut impl FnMut(u32)) -> bool {
    let mut way = way;
    loop {
        see(way.edge());
        way = way.along().to_end_of_fan(twins);
        if twins.get(way.edge()) != Twin::Boundary {
            return false;
        }
        if way.edge() == start {
            return true;
        }
    }
}
