//! `UsdTopology`: the points and faces of a mesh, checked.
use super::primvar::{UsdMeshSize, row_numbers, row_place};
use super::stage::{StagePrim, UsdStage};
use crate::ReadError;
use crate::grow::with_room;
use crate::text::{grouped, not_finite};
use chordal::budget::advice::{Message, Setting};

/// Points, and the corners of all faces in one list.
pub(super) struct UsdTopology {
    pub points: Vec<[f64; 3]>,
    /// The number of corners of each face.
    pub counts: Vec<u32>,
    /// The point of each corner.
    pub corners: Vec<u32>,
    /// Whether faces are clockwise seen from their front.
    pub is_left_handed: bool,
}

impl UsdTopology {
    /// Reads a mesh. `None`, with a note, if it has no points or faces.
    ///
    /// # Errors
    /// If counts and indices are inconsistent, an index is out of range, or a coordinate is not finite.
    pub(super) fn read(stage: &UsdStage<'_, '_>, prim: &StagePrim) -> Result<Option<Self>, ReadError> {
        let needed = [(3, "points"), (1, "faceVertexCounts"), (1, "faceVertexIndices")];
        let mut arrays = Vec::new();
        for (width, name) in needed {
            match stage.numbers(prim, name)? {
                Some(numbers) if numbers.width == width => arrays.push(numbers),
                _ => {
                    let what = "meshes without points or faces were left out";
                    stage.note("empty-meshes", what, &prim.path);
                    return Ok(None);
                }
            }
        }
        let [points, counts, corners] = &arrays[..] else { return Ok(None) };
        let limit = stage.limits.rows;
        for (numbers, name) in [(points, "points"), (counts, "faces"), (corners, "corners")] {
            if numbers.n_rows() as u64 > limit {
                let place = stage.place(prim);
                return Err(crate::assemble::too_many_rows(place, name, numbers.n_rows() as u64, limit));
            }
        }
        if !stage.limits.drop_nonfinite
            && let Some(at) = points.values.iter().position(|x| !x.is_finite())
        {
            let shown = points.values[at].to_string();
            let error = not_finite(shown.as_bytes(), row_place("points", at / 3));
            let message = error.message.words(format_args!(" ({}.points)", prim.path));
            return Err(ReadError { message, ..error });
        }
        let counts = row_numbers(&counts.values, u32::MAX as usize, |row| {
            let message = format!("{}: a face has {} corners", prim.path, counts.values[row]);
            ReadError::new("bad-count", row_place("faceVertexCounts", row), message)
        })?;
        let n_points = points.n_rows();
        let corners = row_numbers(&corners.values, n_points, |row| {
            let message = format!(
                "{}: index {} is not below the number of points, {}",
                prim.path,
                corners.values[row],
                grouped(n_points as u64)
            );
            ReadError::new("index-out-of-range", row_place("faceVertexIndices", row), message)
        })?;
        let n_corners: u64 = counts.iter().map(|n| u64::from(*n)).sum();
        if n_corners != corners.len() as u64 {
            let message = format!(
                "{}: faces have {} corners in all, and {} are there",
                prim.path,
                grouped(n_corners),
                grouped(corners.len() as u64)
            );
            return Err(ReadError::new("count-mismatch", stage.place(prim), message));
        }
        let mut rows = with_room(n_points)?;
        rows.extend(points.values.chunks_exact(3).map(|p| [p[0], p[1], p[2]]));
        let is_left_handed = stage.word(prim, "orientation")?.is_some_and(|word| word == "leftHanded");
        Ok(Some(Self { points: rows, counts, corners, is_left_handed }))
    }

    pub(super) fn size(&self) -> UsdMeshSize {
        UsdMeshSize { n_points: self.points.len(), n_faces: self.counts.len(), n_corners: self.corners.len() }
    }

    /// For each face its first corner and the number of its corners.
    pub(super) fn faces(&self) -> impl Iterator<Item = FaceCorners> {
        let is_left_handed = self.is_left_handed;
        self.counts.iter().scan(0, move |first, n| {
            let face = FaceCorners { first: *first, n: *n as usize, is_left_handed };
            *first += face.n;
            Some(face)
        })
    }

    /// The error for coordinates of a cage that are not finite.
    pub(super) fn check_finite(&self, prim: &StagePrim) -> Result<(), ReadError> {
        let Some(row) = self.points.iter().position(|p| p.iter().any(|x| !x.is_finite())) else {
            return Ok(());
        };
        let error = not_finite(b"of a cage", row_place("points", row));
        let message = Message::from(format!("{}: {}", prim.path, &*error.message));
        let message = message.words(": only triangles are taken apart, with ");
        Err(ReadError { message: message.value(Setting::Surface, "faceted"), ..error })
    }
}

/// The corners of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct FaceCorners {
    pub first: usize,
    pub n: usize,
    is_left_handed: bool,
}

impl FaceCorners {
    /// Its corners in counter-clockwise order, from the same first corner on.
    pub(super) fn corners(self) -> impl Iterator<Item = usize> {
        let at = move |i: usize| if self.is_left_handed { (self.n - i) % self.n } else { i };
        (0..self.n).map(move |i| self.first + at(i))
    }
}
