//! Triangles that are too thin: without area, exactly, and slivers, by their shape.
use super::degenerate::has_zero_area;
use super::finding::{Finding, Witness};
use super::parallel::over_chunks;
use crate::explicit::Mesh;
use crate::math::greater;
use glam::DVec3;

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

/// Whether a triangle is a sliver or has no area. It misses no triangle without area: rounding moves the
/// doubled area by a few units in the last place of the longest side squared, far less than a hundredth of
/// that.
#[inline]
fn is_thin(corners: [[f64; 3]; 3]) -> bool {
    /// Within this range the fourth power of a side is a normal number, and underflow of smaller terms does
    /// not matter.
    const SAFE: std::ops::Range<f64> = 1e-70..1e70;
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
    let mut found = sides(corners);
    if !found.iter().all(|side| side.is_finite()) {
        // Corners this large lose no significant digits when halved.
        found = sides(corners.map(|corner| corner * 0.5));
    }
    let largest = found.iter().fold(0.0, |most, side| {
        let size = side.abs().max_element();
        greater(size, most)
    });
    let exponent = (largest.to_bits() >> 52 & 0x7ff) as i64 - 1023;
    // In two steps: the inverse of a subnormal number is beyond the range of f64.
    let power = |e: i64| f64::from_bits(((e.clamp(-1022, 1023) + 1023) as u64) << 52);
    let (half, rest) = (-exponent / 2, -exponent + exponent / 2);
    found.map(|side| side * power(half) * power(rest))
}

/// The faces without area and the slivers of a mesh.
pub(super) fn thin_faces(mesh: &Mesh) -> (Finding, Finding) {
    // The chunk size is free: only the order of the parts matters.
    let parts = over_chunks(mesh.faces(), 4096, |first, faces| {
        let (mut flat, mut slivers) = (Finding::default(), Finding::default());
        for face in first..first + faces.len() {
            let corners = mesh.corners(face);
            if is_thin(corners) {
                let finding = if has_zero_area(corners) { &mut flat } else { &mut slivers };
                finding.add(|| Witness::face(mesh, face as u32));
            }
        }
        (flat, slivers)
    });
    parts.into_iter().fold((Finding::default(), Finding::default()), |mut all, part| {
        all.0.append(part.0);
        all.1.append(part.1);
        all
    })
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
