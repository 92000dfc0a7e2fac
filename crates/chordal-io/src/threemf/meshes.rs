//! `ModelMesh`: the vertices and triangles of an object while they are read.
use super::namespace::ModelElements;
use crate::assemble::too_many_rows;
use crate::grow::{push, push_many};
use crate::text::{IntegerError, grouped, integer, not_finite, number, number_error, show, trim};
use crate::{Limits, ReadError};

/// The number for a missing group or property.
pub(super) const NOTHING: u32 = u32::MAX;

/// The group and the properties of a triangle's corners, `NOTHING` if the file gives none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TriangleProperties {
    pub group: u32,
    pub corners: [u32; 3],
}

impl TriangleProperties {
    pub(super) const NONE: Self = Self { group: NOTHING, corners: [NOTHING; 3] };
}

/// A mesh with the properties of its triangles.
#[derive(Clone, Debug)]
pub(super) struct ModelMesh {
    /// The id of its object.
    pub id: u32,
    /// The default group and property of triangles; `NOTHING` if there is none.
    pub group: u32,
    pub property: u32,
    pub positions: Vec<[f64; 3]>,
    pub faces: Vec<[u32; 3]>,
    /// The properties of the first triangles; later ones have none of their own.
    pub properties: Vec<TriangleProperties>,
}

/// A number that refers to a resource or an element of a list.
pub(super) fn index(elements: &ModelElements, name: &str) -> Result<Option<u32>, ReadError> {
    let Some(text) = elements.get(name) else { return Ok(None) };
    let token = trim(text.as_bytes());
    let parsed = match integer(token) {
        Ok(value) => u32::try_from(value).ok().filter(|value| *value != NOTHING),
        Err(IntegerError::TooLarge) => None,
        Err(IntegerError::Spelling) => {
            let message = format!("{name} = {} is not a whole number", show(token));
            return Err(elements.error("not-a-number", message));
        }
    };
    parsed.map(Some).ok_or_else(|| {
        let message = format!("{name} = {} is outside 0 to {}", show(token), grouped(u64::from(NOTHING) - 1));
        elements.error("index-out-of-range", message)
    })
}

/// The same for a required number.
pub(super) fn needed_index(elements: &ModelElements, name: &str) -> Result<u32, ReadError> {
    elements.need(name)?;
    index(elements, name).map(|found| found.unwrap_or(NOTHING))
}

impl ModelMesh {
    /// Appends the vertex of the current element.
    pub(super) fn push_vertex(&mut self, elements: &ModelElements, limits: &Limits) -> Result<(), ReadError> {
        // The highest number is reserved for `NOTHING`.
        let most = limits.rows.min(u64::from(u32::MAX - 1));
        if self.positions.len() as u64 >= most {
            let rows = self.positions.len() as u64 + 1;
            return Err(too_many_rows(elements.place(), "vertices of an object", rows, most));
        }
        let mut position = [0.0; 3];
        for (value, axis) in position.iter_mut().zip(["x", "y", "z"]) {
            let token = trim(elements.need(axis)?.as_bytes());
            *value = match number(token) {
                Some(value) if value.is_finite() || limits.drop_nonfinite => value,
                Some(_) => {
                    let error = not_finite(token, elements.place());
                    return Err(elements.error(error.code, &*error.message));
                }
                None => return Err(elements.error("not-a-number", number_error(token))),
            };
        }
        push(&mut self.positions, position)
    }

    /// Appends the triangle of the current element.
    pub(super) fn push_triangle(
        &mut self,
        elements: &ModelElements,
        limits: &Limits,
    ) -> Result<(), ReadError> {
        let most = limits.rows.min(u64::from(u32::MAX / 3));
        if self.faces.len() as u64 >= most {
            let rows = self.faces.len() as u64 + 1;
            return Err(too_many_rows(elements.place(), "triangles of an object", rows, most));
        }
        let mut face = [0; 3];
        for (corner, name) in face.iter_mut().zip(["v1", "v2", "v3"]) {
            *corner = needed_index(elements, name)?;
            if *corner as usize >= self.positions.len() {
                let message = format!(
                    "{name} = {corner} names no vertex: there are {}",
                    grouped(self.positions.len() as u64)
                );
                return Err(elements.error("index-out-of-range", message));
            }
        }
        if let Some(first) = index(elements, "p1")? {
            let (second, third) = (index(elements, "p2")?, index(elements, "p3")?);
            let group = index(elements, "pid")?.unwrap_or(NOTHING);
            let without = self.faces.len() - self.properties.len();
            push_many(&mut self.properties, TriangleProperties::NONE, without)?;
            // In 3MF `p1` alone stands for all three corners.
            let corners = [first, second.unwrap_or(first), third.unwrap_or(first)];
            push(&mut self.properties, TriangleProperties { group, corners })?;
        }
        push(&mut self.faces, face)
    }
}
