//! `PreparedFace`: a trimmed surface as patches, cut into cells, and its loops.
use super::face_lattice::FaceLattice;
use super::fit::{FittedSurface, fit_parts};
use super::trim_loops::TrimPieces;
use crate::budget::Job;
use crate::explicit::nurbs::TrimmedSurface;

/// A face before it is cut into cells.
pub(super) struct PreparedFace {
    pub pieces: TrimPieces,
    pub lattice: FaceLattice,
    /// A bound for the distance of the patches from the surface.
    pub patch_error: f64,
    /// By direction and piece: its number of patches, and the least number.
    cuts: [Vec<usize>; 2],
    least: [Vec<usize>; 2],
}

impl PreparedFace {
    pub fn new(face: &TrimmedSurface, pieces: TrimPieces, fitted: FittedSurface) -> Self {
        let (cuts, patch_error) = (fitted.cuts, fitted.at_most);
        let lattice = FaceLattice::new(face.surface(), fitted.patches, &cuts, pieces.degree, pieces.reach);
        Self { pieces, lattice, patch_error, least: cuts.clone(), cuts }
    }

    /// Cuts a face into cells whose triangles are expected within a length.
    pub fn cut(&mut self, face: &TrimmedSurface, expected: f64, job: &Job) {
        let mut needs = self.lattice.needs(expected);
        let pieces = self.lattice.cuts_of_pieces(&needs, &self.least);
        let cuts = pieces.each_ref().map(|piece_cuts| piece_cuts.iter().map(|piece| piece.patches).collect());
        if cuts != self.cuts {
            let fitted = fit_parts(face.surface(), cuts, &job.clone().with_threads(1));
            let (reach, degree) = (self.pieces.reach, self.pieces.degree);
            self.lattice = FaceLattice::new(face.surface(), fitted.patches, &fitted.cuts, degree, reach);
            (self.patch_error, self.cuts) = (fitted.at_most, fitted.cuts);
            needs = self.lattice.needs(expected);
        }
        self.lattice.cut(&needs, &pieces);
    }
}
