//! Triangles that are too thin: without area, exactly, and slivers, by their shape.
use super::degenerate::has_zero_area;
use super::finding::{Finding, Witness};
use crate::budget::over_chunks;
use crate::explicit::{BLOCK, CornerBlock, Mesh};
use crate::math::simd::{self, Kernel};
use crate::math::{greater, lesser};
use glam::DVec3;
use std::ops::Range;

/// A sliver's longest side is more than this many times its height on that side. Defined: at 1:100 the
/// smallest angle is below 1.15°, and a normal computed in single precision has lost two of its seven digits.
pub const SLIVER_ASPECT: f64 = 100.0;

/// Whether a triangle is a sliver: it has an area, and its longest side is more than [`SLIVER_ASPECT`] times
/// the height on that side. Only the shape matters: the answer does not depend on size or position.
///
/// Lengths are rounded, so a triangle at the limit to the last bits may fall to either side.
///
/// ```
/// use chordal::check::is_sliver;
/// let triangle = |height: f64| [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, height, 0.0]];
/// assert!(is_sliver(triangle(0.0099)) && !is_sliver(triangle(0.0101)));
/// assert!(!is_sliver(triangle(0.0)), "no area at all is another finding");
/// ```
#[must_use]
pub fn is_sliver(corners: [[f64; 3]; 3]) -> bool {
    is_thin(corners) && !has_zero_area(corners)
}

/// The same as [`has_zero_area`], faster if the triangle is far from that.
pub(super) fn has_no_area(corners: [[f64; 3]; 3]) -> bool {
    is_thin(corners) && has_zero_area(corners)
}

/// The range of squared longest sides in which the fourth power of a side is a normal number, and underflow
/// of smaller terms does not matter.
const SAFE: Range<f64> = 1e-70..1e70;

/// Whether a triangle is a sliver or has no area. It misses no triangle without area: rounding moves the
/// doubled area by a few units in the last place of the longest side squared, far less than a hundredth of
/// that.
#[inline]
fn is_thin(corners: [[f64; 3]; 3]) -> bool {
    let [a, b, c] = corners.map(DVec3::from);
    let sides = [b - a, c - a, c - b];
    let longest_sq = longest_sq(sides);
    if SAFE.contains(&longest_sq) {
        return thinner_than_limit(sides, longest_sq);
    }
    let sides = scaled_to_unit(corners);
    thinner_than_limit(sides, self::longest_sq(sides))
}

/// Whether the height `h` on the longest side `l` is below `l / SLIVER_ASPECT`. The doubled area is `h · l`.
#[inline]
fn thinner_than_limit(sides: [DVec3; 3], longest_sq: f64) -> bool {
    let doubled_area_sq = sides[0].cross(sides[1]).length_squared();
    doubled_area_sq * (SLIVER_ASPECT * SLIVER_ASPECT) < longest_sq * longest_sq || longest_sq == 0.0
}

#[inline]
fn longest_sq(sides: [DVec3; 3]) -> f64 {
    let [x, y, z] = [sides[0].length_squared(), sides[1].length_squared(), sides[2].length_squared()];
    let xy = greater(x, y);
    greater(xy, z)
}

/// The sides of a triangle of any size, scaled by the power of two that brings them to about 1.
fn scaled_to_unit(corners: [[f64; 3]; 3]) -> [DVec3; 3] {
    let sides = |[a, b, c]: [DVec3; 3]| [b - a, c - a, c - b];
    let corners = corners.map(DVec3::from);
    let mut scaled_sides = sides(corners);
    if !scaled_sides.iter().all(|side| side.is_finite()) {
        // Corners this large lose no significant digits when halved.
        scaled_sides = sides(corners.map(|corner| corner * 0.5));
    }
    let largest = scaled_sides.iter().fold(0.0, |most, side| {
        let size = side.abs().max_element();
        greater(size, most)
    });
    let exponent = (largest.to_bits() >> 52 & 0x7ff) as i64 - 1023;
    // In two steps: the inverse of a subnormal number is beyond the range of f64.
    let power = |e: i64| f64::from_bits(((e.clamp(-1022, 1023) + 1023) as u64) << 52);
    let (half, other_half) = (-exponent / 2, -exponent + exponent / 2);
    scaled_sides.map(|side| side * power(half) * power(other_half))
}

/// The faces without area and the slivers of a mesh.
pub(super) fn thin_faces(mesh: &Mesh) -> (Finding, Finding) {
    let isa = simd::isa();
    // Any chunk size would do, since only the order of the parts matters.
    let parts = over_chunks(mesh.faces(), 4096, |first, faces| {
        simd::dispatch(isa, ThinKernel { mesh, faces: first..first + faces.len() })
    });
    parts.into_iter().fold((Finding::default(), Finding::default()), |mut findings, part| {
        findings.0.append(part.0);
        findings.1.append(part.1);
        findings
    })
}

/// Finds the faces without area and the slivers among some faces.
struct ThinKernel<'a> {
    mesh: &'a Mesh,
    faces: Range<usize>,
}

impl Kernel for ThinKernel<'_> {
    type Output = (Finding, Finding);

    #[inline(always)]
    fn run(self) -> (Finding, Finding) {
        const LIMIT: f64 = SLIVER_ASPECT * SLIVER_ASPECT;
        let (mut flat, mut slivers) = (Finding::default(), Finding::default());
        let mut block = CornerBlock::new();
        let mut is_clear = [false; BLOCK];
        for first in self.faces.clone().step_by(BLOCK) {
            let n = lesser(block.load(self.mesh, first), self.faces.end - first);
            let [a, b, c] = &block.corners;
            // `is_thin` within its safe range, as straight code, which is vectorised as a whole.
            for i in 0..BLOCK {
                let (ux, uy, uz) = (b[0][i] - a[0][i], b[1][i] - a[1][i], b[2][i] - a[2][i]);
                let (vx, vy, vz) = (c[0][i] - a[0][i], c[1][i] - a[1][i], c[2][i] - a[2][i]);
                let (wx, wy, wz) = (c[0][i] - b[0][i], c[1][i] - b[1][i], c[2][i] - b[2][i]);
                let u = (ux * ux + uy * uy) + uz * uz;
                let v = (vx * vx + vy * vy) + vz * vz;
                let w = (wx * wx + wy * wy) + wz * wz;
                let uv = greater(u, v);
                let longest_sq = greater(uv, w);
                let (nx, ny, nz) = (uy * vz - vy * uz, uz * vx - vz * ux, ux * vy - vx * uy);
                let doubled_area_sq = (nx * nx + ny * ny) + nz * nz;
                // All that is not clear, NaN included, is decided one by one below, without
                // rounding where it matters. `&` and not `&&`, which would branch.
                is_clear[i] =
                    (doubled_area_sq * LIMIT >= longest_sq * longest_sq) & SAFE.contains(&longest_sq);
            }
            for face in (0..n).filter(|i| !is_clear[*i]).map(|i| first + i) {
                let corners = self.mesh.corners(face);
                if is_thin(corners) {
                    let finding = if has_zero_area(corners) { &mut flat } else { &mut slivers };
                    finding.add(|| Witness::face(self.mesh, face as u32));
                }
            }
        }
        (flat, slivers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    #[test]
    fn thin_is_a_matter_of_shape_at_every_scale_and_place() {
        let mut random = Random::new(5);
        let mut unit = || random.below(1 << 24) as f64 / (1_u64 << 24) as f64;
        for _ in 0..2000 {
            let height = unit() * 0.02;
            let triangle = [[0.0; 3], [1.0, 0.0, 0.0], [unit(), height, 0.0]];
            let is = is_sliver(triangle);
            assert_eq!(is, height > 0.0 && height < 0.01, "{height}");
            for exponent in [-900, -300, -20, 20, 300, 900] {
                let scale = libm::ldexp(1.0, exponent);
                assert_eq!(is_sliver(triangle.map(|p| p.map(|x| x * scale))), is, "2^{exponent}");
            }
            // Numbers of 24 bits below 1 are represented exactly beside 2²⁰.
            let far = triangle.map(|p| p.map(|x| (x * 16_777_216.0).floor() / 16_777_216.0 + 1_048_576.0));
            let near = far.map(|p| p.map(|x| x - 1_048_576.0));
            assert_eq!(is_sliver(far), is_sliver(near));
        }
    }

    #[test]
    fn many_faces_at_once_are_as_thin_as_one_by_one() {
        let mut random = Random::new(8);
        for n_faces in [1, 63, 64, 65, 4096, 4097, 9001] {
            // Few rows on a lattice that is flattened more and more: flat faces, slivers, and others, also far out.
            let positions: Vec<[f64; 3]> = (0..300)
                .map(|_| {
                    let scale = libm::ldexp(1.0, 8 * random.below(100) as i32 - 400);
                    let scale = if random.below(4) == 0 { scale } else { 1.0 };
                    [random.below(9) as f64, random.below(3) as f64 * 0.01, random.below(2) as f64]
                        .map(|x| x * scale)
                })
                .collect();
            let faces: Vec<[u32; 3]> =
                (0..n_faces).map(|_| std::array::from_fn(|_| random.below(300) as u32)).collect();
            let mesh = Mesh::new(positions, faces).expect("finite");
            let all = || (0..n_faces).filter(|face| is_thin(mesh.corners(*face)));
            let flat: Vec<usize> = all().filter(|face| has_zero_area(mesh.corners(*face))).collect();
            let found = thin_faces(&mesh);
            assert_eq!(
                (found.0.count, found.1.count),
                (flat.len() as u64, (all().count() - flat.len()) as u64)
            );
            let first: Vec<Witness> =
                flat.iter().take(10).map(|face| Witness::face(&mesh, *face as u32)).collect();
            assert_eq!(found.0.witnesses, first);
        }
    }

    #[test]
    fn no_flat_triangle_is_missed_whatever_its_size() {
        for size in [5e-324, 1e-310, 1e-160, 1e-80, 1.0, 1e80, 1e160, f64::MAX / 4.0] {
            let at = |k: f64| [k * size, 0.0, k * size];
            assert!(is_thin([at(1.0), at(2.0), at(4.0)]), "{size}");
            assert!(is_thin([at(1.0); 3]));
            assert!(!is_thin([at(0.0), [size, 0.0, 0.0], [0.0, size, 0.0]]), "{size}");
        }
        let far = [[f64::MAX, 0.0, 0.0], [-f64::MAX, 0.0, 0.0], [0.0, f64::MAX, 0.0]];
        assert!(!is_thin(far) && is_thin([far[0], far[1], [0.0, 1.0, 0.0]]));
    }
}
