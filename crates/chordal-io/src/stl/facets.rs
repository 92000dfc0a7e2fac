//! `StlFacets`: triangles with three separate vertices each, and the checks of their normals.
use crate::assemble::{self, RawMesh};
use crate::grow::{extend, with_room};
use crate::text::not_finite;
use crate::warnings::Warnings;
use crate::{FileLocation, Limits, ReadError};
use chordal::Mesh;
use chordal::explicit::{Attribute, face_normal, position_id_by_bits};

/// The facets so far.
#[derive(Default)]
pub(super) struct StlFacets {
    positions: Vec<[f64; 3]>,
    pub(super) warnings: Warnings,
}

/// Whether the corners are clearly counter-clockwise about the given normal, beyond all rounding. Nearly all
/// facets are, and this test needs no square root.
#[inline]
fn clearly_agrees([a, b, c]: [[f64; 3]; 3], normal: [f64; 3]) -> bool {
    // Thousands of times the rounding of these sums, which is at most eight times 2⁻⁵³, and far above the
    // loss of a product that underflows.
    const CLEAR: f64 = 1.0 / (1_u64 << 40) as f64;
    const LEAST: f64 = f64::from_bits((1023 - 900) << 52);
    let (mut along, mut most) = (0.0, 0.0);
    for (k, n) in normal.iter().enumerate() {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let (left, right) = ((b[i] - a[i]) * (c[j] - a[j]), (b[j] - a[j]) * (c[i] - a[i]));
        along += (left - right) * n;
        most += (left.abs() + right.abs()) * n.abs();
    }
    along > CLEAR * most && along > LEAST && most < f64::INFINITY
}

impl StlFacets {
    /// An empty list, with room for as many facets as were counted in the bytes of the file.
    pub(super) fn with_room(n_facets: usize) -> Result<Self, ReadError> {
        Ok(Self { positions: with_room(3 * n_facets)?, ..Self::default() })
    }

    /// The number of facets.
    pub(super) fn len(&self) -> usize {
        self.positions.len() / 3
    }

    /// Appends one facet. Its normal adds no information to the corners, so it is only compared.
    ///
    /// # Errors
    /// `not-finite` for a corner, unless the limits drop such corners; `too-many-rows`.
    pub(super) fn push(
        &mut self,
        corners: [[f64; 3]; 3],
        normal: [f64; 3],
        place: impl Fn() -> FileLocation,
        limits: &Limits,
    ) -> Result<(), ReadError> {
        let n = self.len() as u64;
        if n >= limits.rows.min(u64::from(u32::MAX / 3)) {
            return Err(assemble::too_many_rows(place(), "facets", n + 1, n));
        }
        if let Some(bad) = corners.as_flattened().iter().find(|x| !x.is_finite())
            && !limits.drop_nonfinite
        {
            return Err(not_finite(bad.to_string().as_bytes(), place()));
        }
        self.compare(corners, normal, &place);
        let numbers = corners.as_flattened().iter();
        let n_negative = numbers.filter(|x| x.to_bits() == (-0.0_f64).to_bits()).count();
        self.warnings.count_many("negative-zeros", n_negative as u64, || {
            (place(), "coordinates -0 were read as 0, so that equal vertices are tied".to_owned())
        });
        // −0 + 0 is 0, and any other number + 0 is itself.
        let plain = |[x, y, z]: [f64; 3]| [x + 0.0, y + 0.0, z + 0.0];
        let [a, b, c] = corners;
        extend(&mut self.positions, &[plain(a), plain(b), plain(c)])
    }

    fn compare(&mut self, corners: [[f64; 3]; 3], normal: [f64; 3], place: &impl Fn() -> FileLocation) {
        if clearly_agrees(corners, normal) {
            return;
        }
        let (code, message) = if normal.iter().any(|x| !x.is_finite()) {
            ("normals-not-finite", "normals of facets are not finite")
        } else if normal == [0.0; 3] {
            ("normals-zero", "normals of facets are 0")
        } else {
            let against =
                |true_normal: [f64; 3]| (0..3).map(|k| true_normal[k] * normal[k]).sum::<f64>() <= 0.0;
            if !face_normal(corners).is_some_and(against) {
                return;
            }
            ("normals-wrong", "normals of facets contradict the order of their corners")
        };
        self.warnings.count(code, || (place(), format!("{message}; normals are taken from the corners")));
    }

    /// Builds the mesh: vertices at bit-identical positions share a `position_id`.
    pub(super) fn into_mesh(
        mut self,
        attribute: Option<Attribute>,
        limits: &Limits,
    ) -> Result<(Mesh, Warnings), ReadError> {
        let n = self.positions.len() as u32;
        let mut faces = with_room(self.len())?;
        faces.extend((0..n / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]));
        // There is no −0, so equal positions have equal bits.
        let id = position_id_by_bits(&self.positions);
        let raw = RawMesh {
            positions: self.positions,
            position_id: Some(id),
            faces,
            attributes: attribute.into_iter().collect(),
        };
        let mesh = assemble::mesh(raw, limits, &mut self.warnings)?;
        Ok((mesh, self.warnings))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    #[test]
    fn what_clearly_agrees_agrees() {
        let mut random = Random::new(11);
        let mut n_clear = 0;
        for i in 0..200_000_u32 {
            let size = [1e-300, 1e-150, 1e-30, 1.0, 1e30, 1e150, 1e300][i as usize % 7];
            let mut point = || [0; 3].map(|_| size * random.signed());
            let [a, mut b, mut c] = [(); 3].map(|()| point());
            // Slivers, and collinear corners.
            match i % 4 {
                1 => c = [0, 1, 2].map(|k| 0.5 * (a[k] + b[k])),
                2 => b = a.map(f64::next_up),
                _ => {}
            }
            let normal = if i % 3 == 0 { face_normal([a, b, c]).unwrap_or_default() } else { point() };
            if clearly_agrees([a, b, c], normal) {
                n_clear += 1;
                let true_normal = face_normal([a, b, c]).expect("an area");
                let unit = normal.map(|x| x / size);
                assert!(
                    (0..3).map(|k| true_normal[k] * unit[k]).sum::<f64>() > 0.0,
                    "{:?} {normal:?}",
                    [a, b, c]
                );
            }
        }
        assert!(n_clear > 20_000, "{n_clear}");
    }
}
