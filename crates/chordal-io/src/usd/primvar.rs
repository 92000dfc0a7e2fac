//! `Primvar`: values over a mesh, each with the element that it belongs to.
//!
//! Source: Pixar Animation Studios, *UsdGeomPrimvar*, openusd.org, 2024.
use super::stage::{StageAttribute, StagePrim, UsdStage};
use super::value::{UsdNumbers, UsdValue};
use super::vertex_table::first_equal_rows;
use crate::text::grouped;
use crate::{FileLocation, ReadError};
use std::borrow::Cow;

/// The elements that rows of values belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Interpolation {
    /// The whole mesh.
    Constant,
    /// A face.
    Uniform,
    /// A point.
    Vertex,
    /// A corner of a face.
    FaceVarying,
}

impl Interpolation {
    pub(super) fn from_word(word: &str) -> Option<Self> {
        Some(match word {
            "constant" => Self::Constant,
            "uniform" => Self::Uniform,
            "vertex" | "varying" => Self::Vertex,
            "faceVarying" => Self::FaceVarying,
            _ => return None,
        })
    }
}

/// The numbers of faces, points and corners of a mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct UsdMeshSize {
    pub n_points: usize,
    pub n_faces: usize,
    pub n_corners: usize,
}

/// Values, with the row of each element.
pub(super) struct Primvar<'s> {
    pub numbers: Cow<'s, UsdNumbers>,
    pub interpolation: Interpolation,
    /// `None` if each element has its own row, in order.
    pub indices: Option<Vec<u32>>,
}

impl Primvar<'_> {
    /// The row of an element.
    pub(super) fn row(&self, element: usize) -> u32 {
        self.indices.as_ref().map_or(element as u32, |indices| indices[element])
    }

    /// Lets corners with equal values share a row, if the file has a row for each corner.
    pub(super) fn share_rows(&mut self) -> Result<(), ReadError> {
        if self.indices.is_none() {
            self.indices = Some(first_equal_rows(&self.numbers.values, self.numbers.width)?);
        }
        Ok(())
    }
}

impl UsdStage<'_, '_> {
    /// The values of a primvar of `width` numbers. `None`, with a note, if their count does not fit the mesh.
    ///
    /// # Errors
    /// If they are damaged, or an index is out of range.
    pub(super) fn primvar<'s>(
        &'s self,
        prim: &'s StagePrim,
        name: &'s str,
        width: usize,
        size: UsdMeshSize,
    ) -> Result<Option<Primvar<'s>>, ReadError> {
        let Some(attribute) = self.attribute(prim, name)? else { return Ok(None) };
        let StageAttribute { value, interpolation, place, element_size, .. } = attribute;
        let numbers = match value {
            Some(Cow::Borrowed(UsdValue::Numbers(numbers))) => Cow::Borrowed(numbers),
            Some(Cow::Owned(UsdValue::Numbers(numbers))) => Cow::Owned(numbers),
            Some(Cow::Borrowed(UsdValue::Blocked) | Cow::Owned(UsdValue::Blocked)) | None => return Ok(None),
            Some(_) => {
                self.misfit(prim, name, "of another type");
                return Ok(None);
            }
        };
        // By default normals belong to points, and other primvars to the whole mesh.
        let usual = if name == "normals" { "vertex" } else { "constant" };
        let Some(interpolation) = Interpolation::from_word(interpolation.unwrap_or(usual)) else {
            self.misfit(prim, name, "of an interpolation that is not known");
            return Ok(None);
        };
        if numbers.width != width || element_size.is_some_and(|size| size != 1.0) {
            self.misfit(prim, name, "of another size");
            return Ok(None);
        }
        let needed = match interpolation {
            Interpolation::Constant => 1,
            Interpolation::Uniform => size.n_faces,
            Interpolation::Vertex => size.n_points,
            Interpolation::FaceVarying => size.n_corners,
        };
        let listed = format!("{name}:indices");
        let indices = match self.numbers(prim, &listed)?.filter(|_| name.starts_with("primvars:")) {
            None => None,
            Some(indices) => Some(row_numbers(&indices.values, numbers.n_rows(), |row| {
                let message = format!(
                    "{}.{listed}: row {row} is {}, and there are {} values",
                    prim.path,
                    indices.values[row],
                    grouped(numbers.n_rows() as u64)
                );
                ReadError::new("index-out-of-range", place.clone(), message)
            })?),
        };
        let n_rows = indices.as_ref().map_or(numbers.n_rows(), Vec::len);
        if n_rows != needed {
            let what =
                format!("of {} rows where {} are needed", grouped(n_rows as u64), grouped(needed as u64));
            self.misfit(prim, name, &what);
            return Ok(None);
        }
        Ok(Some(Primvar { numbers, interpolation, indices }))
    }

    fn misfit(&self, prim: &StagePrim, name: &str, why: &str) {
        let what = "values that do not fit their mesh were left out";
        self.note("primvars-skipped", what, &format!("{}.{name} ({why})", prim.path));
    }
}

/// Numbers as indices below a limit.
///
/// # Errors
/// At the first row that is not such an index.
pub(super) fn row_numbers(
    values: &[f64],
    limit: usize,
    error: impl Fn(usize) -> ReadError,
) -> Result<Vec<u32>, ReadError> {
    let mut rows = crate::grow::with_room(values.len())?;
    for (at, value) in values.iter().enumerate() {
        if !(*value >= 0.0 && *value < limit as f64 && *value == value.trunc()) {
            return Err(error(at));
        }
        rows.push(*value as u32);
    }
    Ok(rows)
}

/// A row of a list, as the location of an error.
pub(super) fn row_place(list: &'static str, row: usize) -> FileLocation {
    FileLocation::Row { list, row: row as u64 }
}
