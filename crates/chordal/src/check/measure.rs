//! Area and volume, rounded. Sums run in the order of the faces in fixed chunks: the same on any number of
//! threads.
use super::parallel::over_chunks;
use crate::explicit::Mesh;
use glam::DVec3;

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
    let (down, up) =
        power_of_two_near(DVec3::from(bounds.max).max(DVec3::from(bounds.min).abs()).max_element());
    let at = |row: u32| DVec3::from(mesh.positions()[row as usize]) * down - centre * down;
    let sums = over_chunks(mesh.faces(), CHUNK, |_, faces| {
        let mut sum = (0.0, 0.0);
        for &[a, b, c] in faces {
            let (a, b, c) = (at(a), at(b), at(c));
            let twice_area = (b - a).cross(c - a);
            sum.0 += twice_area.length();
            sum.1 += a.dot(twice_area);
        }
        sum
    });
    let (area, volume) = sums.iter().fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
    Measure { area: area / 2.0 * up * up, signed_volume: volume / 6.0 * up * up * up }
}

/// Two powers of two, inverse to each other: the first scales `size` to about 1, so that no intermediate
/// product leaves the range of f64. Both are normal numbers.
pub(super) fn power_of_two_near(size: f64) -> (f64, f64) {
    let exponent = ((size.to_bits() >> 52 & 0x7ff) as i64 - 1023).clamp(-1000, 1000);
    let power = |exponent: i64| f64::from_bits(((exponent + 1023) as u64) << 52);
    (power(-exponent), power(exponent))
}
