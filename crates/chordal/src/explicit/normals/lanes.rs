//! The normals and angles of a block of faces at once, bit-identical to
//! [`corner_terms`].
use super::angle::angle_in_lane;
use super::corner_terms::{NormalWeight, corner_terms};
use crate::explicit::{BLOCK, CornerBlock, Lanes, Mesh};
use crate::math::greater;
use crate::math::simd::Kernel;
use std::f64::consts::PI;
use std::ops::Range;

/// Adds the normals of some faces, in their order, to the sums of their positions, each times its angle
/// there.
pub(super) struct AngleSumKernel<'a> {
    pub mesh: &'a Mesh,
    pub faces: Range<usize>,
    /// The scale of the mesh, `scale_of`.
    pub scale: f64,
    pub sums: &'a mut [[f64; 3]],
}

impl Kernel for AngleSumKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let mut block = CornerBlock::new();
        let mut terms = AngleTerms::new();
        for first in self.faces.step_by(BLOCK) {
            let n = block.load(self.mesh, first);
            terms.fill(&block);
            // Lane after lane, in the order of the faces: the sums are those of the plain version,
            // to the bit.
            for lane in 0..n {
                let face = first + lane;
                let products = if terms.is_clear[lane] && self.scale == 1.0 {
                    let normal = [terms.normal[0][lane], terms.normal[1][lane], terms.normal[2][lane]];
                    [terms.angle[0][lane], terms.angle[1][lane], terms.angle[2][lane]]
                        .map(|angle| normal.map(|x| x * angle))
                } else {
                    match corner_terms(self.mesh.corners(face), self.scale, NormalWeight::Angle) {
                        Some(products) => products,
                        None => continue,
                    }
                };
                for (row, term) in self.mesh.faces()[face].into_iter().zip(products) {
                    let sum = &mut self.sums[self.mesh.position_of(row) as usize];
                    *sum = [sum[0] + term[0], sum[1] + term[1], sum[2] + term[2]];
                }
            }
        }
    }
}

/// The unit normals of the faces of a block and their angles at the three corners.
struct AngleTerms {
    normal: [Lanes; 3],
    angle: [Lanes; 3],
    /// Whether rounding and the range of f64 permit the two values above; otherwise another method decides.
    is_clear: [bool; BLOCK],
}

impl AngleTerms {
    fn new() -> Self {
        Self { normal: [[0.0; BLOCK]; 3], angle: [[0.0; BLOCK]; 3], is_clear: [false; BLOCK] }
    }

    /// The steps of `corner_terms`, as straight code without closures, which is vectorized completely.
    #[inline(always)]
    fn fill(&mut self, block: &CornerBlock) {
        let [a, b, c] = &block.corners;
        for i in 0..BLOCK {
            let (ux, uy, uz) = (b[0][i] - a[0][i], b[1][i] - a[1][i], b[2][i] - a[2][i]);
            let (vx, vy, vz) = (a[0][i] - c[0][i], a[1][i] - c[1][i], a[2][i] - c[2][i]);
            let (nx, ny, nz) = (vy * uz - vz * uy, vz * ux - vx * uz, vx * uy - vy * ux);
            let square = ((0.0 + nx * nx) + ny * ny) + nz * nz;
            let u_square = ((0.0 + ux * ux) + uy * uy) + uz * uz;
            let v_square = ((0.0 + vx * vx) + vy * vy) + vz * vz;
            // The limits are those of `corner_terms`.
            self.is_clear[i] =
                (square > 1e-200) & (square < 1e200) & (square > 1e-24 * (u_square * v_square));
            let area = square.sqrt();
            let factor = 1.0 / area;
            self.normal[0][i] = nx * factor;
            self.normal[1][i] = ny * factor;
            self.normal[2][i] = nz * factor;
            let cosine_term = ((0.0 + vx * ux) + vy * uy) + vz * uz;
            let at_a = angle_in_lane(-cosine_term, area);
            let at_b = angle_in_lane(u_square + cosine_term, area);
            let at_c = PI - (at_a + at_b);
            self.angle[0][i] = at_a;
            self.angle[1][i] = at_b;
            self.angle[2][i] = greater(at_c, 0.0);
        }
    }
}
