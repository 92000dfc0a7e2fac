//! Area and volume, rounded. Sums run in the order of the faces in fixed chunks: the same on any number of
//! threads.
use crate::budget::over_chunks;
use crate::explicit::{BLOCK, CornerBlock, Mesh};
use crate::math::lesser;
use crate::math::simd::{self, Kernel};
use glam::DVec3;
use std::ops::Range;

/// The area and volume of a surface, each rounded (not enclosed), infinite where it exceeds the range of f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measure {
    /// The sum of the areas of the triangles, in squared units of the mesh.
    pub area: f64,
    /// The sum of the signed volumes of the tetrahedra over the triangles with their apex in the centre of
    /// the mesh's bounding box, in cubed units. For a closed, oriented surface that is the enclosed volume,
    /// positive when the front is outside; otherwise it has little meaning.
    pub signed_volume: f64,
}

/// Triangles a chunk: sums of so few lose at most 12 bits.
const CHUNK: usize = 4096;

/// Computes area and signed volume of `mesh` in one pass.
///
/// ```
/// use chordal::Mesh;
/// use chordal::check::findings::measure;
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let tetrahedron = Mesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])?;
/// assert!((measure(&tetrahedron).signed_volume - 1.0 / 6.0).abs() < 1e-15);
/// # Ok::<(), chordal::explicit::InvalidMesh>(())
/// ```
#[must_use]
pub fn measure(mesh: &Mesh) -> Measure {
    let bounds = mesh.bounds();
    if bounds.is_empty() {
        return Measure { area: 0.0, signed_volume: 0.0 };
    }
    let centre = DVec3::from(bounds.centre());
    // Scaling by powers of two is exact, and keeps the products of two and three coordinates in the
    // range of f64.
    let (down, up) =
        power_of_two_near(DVec3::from(bounds.max).max(DVec3::from(bounds.min).abs()).max_element());
    let frame = MeasureFrame { down, centre: (centre * down).to_array() };
    let isa = simd::isa();
    let sums = over_chunks(mesh.faces(), CHUNK, |first, faces| {
        let faces = first..first + faces.len();
        simd::dispatch(isa, MeasureKernel { mesh, faces, frame })
    });
    let (area, volume) = sums.iter().fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
    Measure { area: area / 2.0 * up * up, signed_volume: volume / 6.0 * up * up * up }
}

/// The coordinates for measuring: scaled by `down`, about the scaled centre.
#[derive(Clone, Copy)]
struct MeasureFrame {
    down: f64,
    centre: [f64; 3],
}

/// Sums twice the areas, and six times the volumes, of some faces in their order.
struct MeasureKernel<'a> {
    mesh: &'a Mesh,
    faces: Range<usize>,
    frame: MeasureFrame,
}

impl Kernel for MeasureKernel<'_> {
    type Output = (f64, f64);

    #[inline(always)]
    fn run(self) -> (f64, f64) {
        let MeasureFrame { down, centre } = self.frame;
        let mut block = CornerBlock::new();
        let (mut areas, mut volumes) = ([0.0; BLOCK], [0.0; BLOCK]);
        let mut sum = (0.0, 0.0);
        for first in self.faces.clone().step_by(BLOCK) {
            let n = lesser(block.load(self.mesh, first), self.faces.end - first);
            let [a, b, c] = &block.corners;
            // Straight code without closures, which is vectorised as a whole.
            for i in 0..BLOCK {
                let (ax, bx, cx) =
                    (a[0][i] * down - centre[0], b[0][i] * down - centre[0], c[0][i] * down - centre[0]);
                let (ay, by, cy) =
                    (a[1][i] * down - centre[1], b[1][i] * down - centre[1], c[1][i] * down - centre[1]);
                let (az, bz, cz) =
                    (a[2][i] * down - centre[2], b[2][i] * down - centre[2], c[2][i] * down - centre[2]);
                let (ux, uy, uz) = (bx - ax, by - ay, bz - az);
                let (vx, vy, vz) = (cx - ax, cy - ay, cz - az);
                let (nx, ny, nz) = (uy * vz - vy * uz, uz * vx - vz * ux, ux * vy - vx * uy);
                areas[i] = ((nx * nx + ny * ny) + nz * nz).sqrt();
                volumes[i] = (ax * nx + ay * ny) + az * nz;
            }
            // One by one: sums of lanes would depend on how many lanes the processor has. Rows
            // after the last face are not read.
            for i in 0..n {
                sum = (sum.0 + areas[i], sum.1 + volumes[i]);
            }
        }
        sum
    }
}

/// Two powers of two, inverse to each other: the first scales `size` to about 1, so that no intermediate
/// product leaves the range of f64. Both are normal numbers.
pub(super) fn power_of_two_near(size: f64) -> (f64, f64) {
    let exponent = ((size.to_bits() >> 52 & 0x7ff) as i64 - 1023).clamp(-1000, 1000);
    let power = |exponent: i64| f64::from_bits(((exponent + 1023) as u64) << 52);
    (power(-exponent), power(exponent))
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    /// The definition, one face after the other.
    fn plain(mesh: &Mesh) -> Measure {
        let bounds = mesh.bounds();
        let centre = DVec3::from(bounds.centre());
        let (down, up) =
            power_of_two_near(DVec3::from(bounds.max).max(DVec3::from(bounds.min).abs()).max_element());
        let at = |row: u32| DVec3::from(mesh.positions()[row as usize]) * down - centre * down;
        let (mut area, mut volume) = (0.0, 0.0);
        for faces in mesh.faces().chunks(CHUNK) {
            let mut sum = (0.0, 0.0);
            for &[a, b, c] in faces {
                let (a, b, c) = (at(a), at(b), at(c));
                let twice_area = (b - a).cross(c - a);
                sum = (sum.0 + twice_area.length(), sum.1 + a.dot(twice_area));
            }
            (area, volume) = (area + sum.0, volume + sum.1);
        }
        Measure { area: area / 2.0 * up * up, signed_volume: volume / 6.0 * up * up * up }
    }

    #[test]
    fn many_faces_at_once_have_the_sums_of_one_after_the_other() {
        let mut random = Random::new(3);
        for n_faces in [1, 2, 63, 64, 65, 200, 4095, 4096, 4097, 9000] {
            let mut unit = || random.below(1 << 24) as f64 / 3e5;
            let positions: Vec<[f64; 3]> = (0..500).map(|_| [unit(), unit(), unit()]).collect();
            let faces = (0..n_faces).map(|_| std::array::from_fn(|_| random.below(500) as u32)).collect();
            let mesh = Mesh::new(positions, faces).expect("finite");
            assert_eq!(measure(&mesh), plain(&mesh), "{n_faces}");
        }
    }
}
