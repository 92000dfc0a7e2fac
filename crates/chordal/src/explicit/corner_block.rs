//! `CornerBlock`: the corners of a few faces by coordinate, so that a kernel computes with all of them at
//! once.
use super::Mesh;

/// Faces in a block: enough to fill the widest registers, few enough to stay in the first-level cache.
pub(crate) const BLOCK: usize = 64;

/// One number for each face of a block.
pub(crate) type Lanes = [f64; BLOCK];

/// The corners of up to [`BLOCK`] faces: one number per face, for each corner and axis.
pub(crate) struct CornerBlock {
    pub corners: [[Lanes; 3]; 3],
}

impl CornerBlock {
    pub fn new() -> Self {
        Self { corners: [[[0.0; BLOCK]; 3]; 3] }
    }

    /// Loads the corners of the faces from `first` on, and returns the number of faces. The other lanes of a
    /// partly filled block keep their old values.
    #[inline(always)]
    pub fn load(&mut self, mesh: &Mesh, first: usize) -> usize {
        let faces = &mesh.faces()[first..];
        let n = if faces.len() < BLOCK { faces.len() } else { BLOCK };
        for (lane, face) in faces[..n].iter().enumerate() {
            for (corner, row) in self.corners.iter_mut().zip(face) {
                let [x, y, z] = mesh.positions()[*row as usize];
                corner[0][lane] = x;
                corner[1][lane] = y;
                corner[2][lane] = z;
            }
        }
        n
    }
}
