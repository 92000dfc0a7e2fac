//! The triangle fans around a position, in which each triangle shares an edge with the next, and the boundary
//! loops of a mesh.
use crate::explicit::{Twin, Twins, next_in_face, previous_in_face};

/// A circulator around a position: the half-edge to cross, and whether the position is its origin or its end.
#[derive(Clone, Copy)]
enum FanCirculator {
    /// Around the origin of the half-edge.
    Out(u32),
    /// Around the end of the half-edge.
    In(u32),
}

impl FanCirculator {
    fn edge(self) -> u32 {
        match self {
            Self::Out(edge) | Self::In(edge) => edge,
        }
    }

    /// The corner that the circulator leaves, given by its outgoing half-edge.
    #[inline]
    fn corner(self) -> u32 {
        match self {
            Self::Out(edge) => edge,
            Self::In(edge) => next_in_face(edge),
        }
    }

    /// Crosses into the next triangle of the fan, to the edge on its far side; returns the kind of the edge
    /// if there is no next triangle. Crossing an edge is symmetric, so a walk never re-enters its own middle.
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

    /// Circulates around the position to the edge at which its fan ends.
    fn to_end_of_fan(mut self, twins: &Twins) -> Self {
        while let Ok(next) = self.across(twins) {
            self = next;
        }
        self
    }

    /// From a boundary edge, reached at one end, moves to its other end and into the triangle there.
    fn along(self) -> Self {
        match self {
            Self::Out(edge) => Self::Out(next_in_face(edge)),
            Self::In(edge) => Self::In(previous_in_face(edge)),
        }
    }
}

/// Enumerates the fans at each position: none if there is no triangle, one if the surface is manifold.
///
/// Calls `each` with the first half-edge of every fan and its number at the position (0, 1, or 2 for all
/// later ones), in the order of the half-edges.
pub(super) fn count_fans(
    twins: &Twins,
    origin: impl Fn(u32) -> u32,
    n_rows: usize,
    mut each: impl FnMut(u32, u8),
) {
    let mut fans = vec![0_u8; n_rows];
    let mut visited = vec![false; twins.len()];
    for corner in 0..twins.len() as u32 {
        if visited[corner as usize] || twins.get(corner) == Twin::Collapsed {
            continue;
        }
        // An open fan was entered somewhere in the middle: the corners on the other side are still
        // unmarked.
        if !mark_fan(FanCirculator::Out(corner), twins, &mut visited) {
            mark_fan(FanCirculator::In(previous_in_face(corner)), twins, &mut visited);
        }
        let count = &mut fans[origin(corner) as usize];
        each(corner, *count);
        *count = if *count == 0 { 1 } else { 2 };
    }
}

/// Marks the corners of a fan in one direction. Returns whether the walk leads back to the first corner.
fn mark_fan(start: FanCirculator, twins: &Twins, visited: &mut [bool]) -> bool {
    let first = start.corner();
    let mut circulator = start;
    loop {
        visited[circulator.corner() as usize] = true;
        match circulator.across(twins) {
            Ok(next) if next.corner() == first => return true,
            Ok(next) => circulator = next,
            Err(_) => return false,
        }
    }
}

/// The end of a path of boundary edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BoundaryKind {
    /// The path ends where it started.
    Loop,
    /// The path ends at edges with three or more faces.
    Chain,
}

/// Connects the boundary edges into paths through the fan at each end, so two loops that touch at a position,
/// with one fan each, remain two. Calls `each` with the first half-edge of every path.
pub(super) fn walk_boundary(twins: &Twins, mut each: impl FnMut(u32, BoundaryKind)) {
    let mut visited = vec![false; twins.len()];
    for start in 0..twins.len() as u32 {
        if visited[start as usize] || twins.get(start) != Twin::Boundary {
            continue;
        }
        let mut visit = |h: u32| visited[h as usize] = true;
        // A chain, too, was entered in the middle; both halves are marked, and it's reported once.
        if follow_boundary(start, FanCirculator::Out(start), twins, &mut visit) {
            each(start, BoundaryKind::Loop);
        } else {
            follow_boundary(start, FanCirculator::In(start), twins, &mut visit);
            each(start, BoundaryKind::Chain);
        }
    }
}

/// All boundary half-edges of the path that contains `start`, as [`walk_boundary`] counts them.
pub(crate) fn boundary_path(twins: &Twins, start: u32) -> Vec<u32> {
    let mut path = Vec::new();
    if !follow_boundary(start, FanCirculator::Out(start), twins, &mut |h| path.push(h)) {
        follow_boundary(start, FanCirculator::In(start), twins, &mut |h| path.push(h));
    }
    path
}

/// Follows the boundary from `start`, entered by `circulator`. Returns whether the walk comes back to
/// `start`.
fn follow_boundary(
    start: u32,
    circulator: FanCirculator,
    twins: &Twins,
    visit: &mut impl FnMut(u32),
) -> bool {
    let mut circulator = circulator;
    loop {
        visit(circulator.edge());
        circulator = circulator.along().to_end_of_fan(twins);
        if twins.get(circulator.edge()) != Twin::Boundary {
            return false;
        }
        if circulator.edge() == start {
            return true;
        }
    }
}
