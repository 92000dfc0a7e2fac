//! `LoopLeaf`: a triangle of the mesh, the part of a cell that it approximates, and the proof of the distance
//! between the two.
use super::cell::{LoopCell, LoopCellShape};
use super::derivative_bound::SecondDerivativeBound;
use super::hull_distance::{FlatTriangle, LoopPiece};
use crate::convert::patches::allowance::{Allowance, InfeasibleTolerance};
use crate::convert::patches::plan::tolerance;
use crate::math::Box3;

/// A vertex of the mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LoopVertex {
    pub(crate) at: [f64; 3],
    /// The largest distance from its point of the surface.
    pub(crate) off: f64,
}

#[derive(Clone, Copy)]
pub(crate) struct LoopLeaf {
    /// The index of its cell.
    pub(crate) cell: u32,
    /// Its corners in the cell.
    pub(crate) places: [[f64; 2]; 3],
    pub(crate) vertices: [u32; 3],
    /// The line of each side, the first from the first corner to the second: an edge of the cage, or the
    /// inside of a sheet. Two lines may have parts between the same vertices.
    pub(crate) lines: [u32; 3],
}

/// The result of certifying a leaf.
#[derive(Clone, Copy)]
pub(crate) struct LeafBound {
    /// An upper bound of the distance between surface and triangle; if the tolerance is not met, possibly only a
    /// value that shows that.
    pub(crate) bound: f64,
    pub(crate) is_met: bool,
    /// The bending of each side.
    pub(crate) sides: [f64; 3],
    /// The bounding box of the part.
    pub(crate) place: Box3,
}

/// If a bound by second derivatives misses the tolerance by more than this factor, heights are not tried. Chosen: they
/// would hardly meet it either.
const WORTH_A_LOOK: f64 = 4.0;

impl LoopLeaf {
    /// A leaf that covers a whole cell.
    pub(crate) fn whole_cell(cell: u32, vertices: [u32; 3], lines: [u32; 3]) -> Self {
        Self { cell, places: [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], vertices, lines }
    }

    /// The middle of a side.
    pub(crate) fn middle(&self, side: usize) -> [f64; 2] {
        let ([a, b], [c, d]) = (self.places[side], self.places[(side + 1) % 3]);
        [0.5 * (a + c), 0.5 * (b + d)]
    }

    /// The key of a side: its line and its vertices, the lower first.
    pub(crate) fn side(&self, side: usize) -> [u32; 3] {
        let (a, b) = (self.vertices[side], self.vertices[(side + 1) % 3]);
        if a < b { [self.lines[side], a, b] } else { [self.lines[side], b, a] }
    }

    /// Its width in its sheet, by its longer extent.
    pub(crate) fn width(&self, cell: &LoopCell<'_>) -> f64 {
        let extent = |k: usize| {
            let all = self.places.map(|place| place[k]);
            all.iter().fold(0.0_f64, |most, x| most.max((x - all[0]).abs()))
        };
        extent(0).max(extent(1)) * cell.scale.abs()
    }

    /// The distance from its part of a polynomial by second derivatives, without rounding.
    pub(crate) fn second_derivative_bound(&self, cell: &LoopCell<'_>, vertices: &[LoopVertex]) -> f64 {
        let LoopCellShape::Polynomial(polynomial) = cell.shape else { return 0.0 };
        let corners = self.vertices.map(|vertex| vertices[vertex as usize].at);
        SecondDerivativeBound::from_quartic(&polynomial.quartic.part(self.places), &corners).bound
    }

    /// The distance from its part of the surface, and whether that is within an allowance. The error, if no mesh can meet
    /// the allowance, includes the bound so far.
    pub(crate) fn certify(
        &self,
        cell: &LoopCell<'_>,
        vertices: &[LoopVertex],
        allowance: &Allowance,
    ) -> Result<LeafBound, Box<(InfeasibleTolerance, LeafBound)>> {
        let corner_vertices = self.vertices.map(|vertex| vertices[vertex as usize]);
        let vertex_error = corner_vertices.iter().fold(0.0_f64, |most, vertex| most.max(vertex.off));
        // The proofs derive each of these terms.
        let rounding_error = 2.0 * cell.shape.rounding_error() + 4.0 * vertex_error;
        let corners = corner_vertices.map(|vertex| vertex.at);
        match cell.shape {
            LoopCellShape::Polynomial(polynomial) => {
                let part = polynomial.quartic.part(self.places);
                let place = Box3::from_points(part.control.iter().chain(&corners));
                let bend = SecondDerivativeBound::from_quartic(&part, &corners);
                let mut leaf_bound =
                    LeafBound { bound: bend.bound + rounding_error, is_met: false, sides: bend.sides, place };
                let tolerance = tolerance(place, allowance, rounding_error)
                    .map_err(|obstacle| Box::new((obstacle, leaf_bound)))?;
                leaf_bound.is_met = bend.bound <= tolerance;
                if !leaf_bound.is_met && bend.bound <= WORTH_A_LOOK * tolerance {
                    let flat = FlatTriangle::new(corners, tolerance);
                    let bound = flat.bound(LoopPiece::Quartic(Box::new(part), polynomial.off));
                    leaf_bound.is_met = bound <= tolerance;
                    leaf_bound.bound =
                        if bound < bend.bound { bound + rounding_error } else { leaf_bound.bound };
                }
                Ok(leaf_bound)
            }
            LoopCellShape::Extraordinary(_) => {
                let place = cell.bounding_box();
                let reach = place.diagonal();
                let mut leaf_bound =
                    LeafBound { bound: reach + rounding_error, is_met: false, sides: [1.0; 3], place };
                let tolerance = tolerance(place, allowance, rounding_error)
                    .map_err(|obstacle| Box::new((obstacle, leaf_bound)))?;
                // The hull contains the surface and its vertices.
                leaf_bound.is_met = reach <= tolerance;
                if !leaf_bound.is_met {
                    let bound =
                        FlatTriangle::new(corners, tolerance).bound(LoopPiece::Extraordinary(cell.shape));
                    // Compared before rounding is added: a bound above the tolerance need not hold for all points.
                    leaf_bound.is_met = bound <= tolerance;
                    leaf_bound.bound = if bound < reach { bound + rounding_error } else { leaf_bound.bound };
                }
                Ok(leaf_bound)
            }
        }
    }
}
