//! `StlFacets`: triangles with three vertices of their own each, and the checks of their normals.
use crate::assemble::{self, RawMesh};
use crate::grow::{push, with_room};
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

impl StlFacets {
    /// The number of facets.
    pub(super) fn len(&self) -> usize {
        self.positions.len() / 3
    }

    /// Appends one facet. Its normal adds nothing to the corners, so it is only compared.
    ///
    /// # Errors
    /// `not-finite` for a corner, unless the limits drop those; `too-many-rows`.
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
        for corner in corners {
            let n_negative = corner.iter().filter(|x| **x == 0.0 && x.is_sign_negative()).count();
            self.warnings.count_many("negative-zeros", n_negative as u64, || {
                (place(), "coordinates -0 were read as 0, so that equal vertices are tied".to_owned())
            });
            // −0 + 0 is 0, and anything else + 0 is itself.
            push(&mut self.positions, corner.map(|x| x + 0.0))?;
        }
        Ok(())
    }

    fn compare(&mut self, corners: [[f64; 3]; 3], normal: [f64; 3], place: &impl Fn() -> FileLocation) {
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

    /// Builds the mesh: `position_id` ties bit-identical positions.
    pub(super) fn into_mesh(mut self, attribute: Option<Attribute>) -> Result<(Mesh, Warnings), ReadError> {
        let n = self.positions.len() as u32;
        let mut faces = with_room(self.len())?;
        faces.extend((0..n / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]));
        // There is no −0, so these are the rows of the same bits.
        let id = position_id_by_bits(&self.positions);
        let raw = RawMesh {
            positions: self.positions,
            position_id: Some(id),
            faces,
            attributes: attribute.into_iter().collect(),
        };
        let mesh = assemble::mesh(raw, &mut self.warnings)?;
        Ok((mesh, self.warnings))
    }
}
