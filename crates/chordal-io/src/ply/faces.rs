//! The faces of a PLY file: polygons and triangle strips.
use super::body::PlyBody;
use super::header::{PlyElement, PlyPropertyType};
use crate::assemble::too_many_rows;
use crate::faces::{Faces, SHORT_FACES};
use crate::grow::push;
use crate::text::grouped;
use crate::warnings::Warnings;
use crate::{FileLocation, Limits, ReadError};
use chordal::Job;

/// The property names of the corners of a face.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Reads faces and strips; their indices must be below the number of vertices.
pub(super) struct PlyFaceReader<'a> {
    pub(super) faces: Faces,
    n_vertices: u64,
    limits: &'a Limits,
    corners: Vec<u32>,
}

impl<'a> PlyFaceReader<'a> {
    pub(super) fn new(n_vertices: u64, limits: &'a Limits) -> Self {
        Self { faces: Faces::default(), n_vertices, limits, corners: Vec::new() }
    }
}

impl PlyFaceReader<'_> {
    /// Reads all rows of an element of faces.
    pub(super) fn polygons(
        &mut self,
        body: &mut PlyBody,
        element: &PlyElement,
        warnings: &mut Warnings,
    ) -> Result<(), ReadError> {
        let list = corner_list(element, warnings)?;
        let mut corners = Vec::new();
        let n_plain = if element.properties.len() == 1 { self.plain_polygons(body, element)? } else { 0 };
        // The rows after the plain ones, one by one: only this loop reports errors.
        for row in n_plain..element.rows {
            self.row(body, element, row, list, &mut corners)?;
            if let Some(index) = corners.iter().find(|i| **i < 0) {
                return Err(self.out_of_range(body, element, *index));
            }
            if corners.len() < 3 {
                warnings.count("short-faces", || {
                    (FileLocation::Row { list: "face", row }, SHORT_FACES.to_owned())
                });
                continue;
            }
            self.corners.clear();
            for index in &corners {
                push(&mut self.corners, *index as u32)?;
            }
            self.faces.push(&self.corners, row)?;
            self.check_rows(body)?;
        }
        Ok(())
    }

    /// Reads the plain rows of a text up to the first one that needs a warning or an error.
    fn plain_polygons(&mut self, body: &mut PlyBody, element: &PlyElement) -> Result<u64, ReadError> {
        let job = Job::default().with_threads(self.limits.threads);
        let mut row = 0;
        body.plain_rows(element, &job, |rows| {
            let mut start = 0;
            for (i, end) in rows.ends.iter().enumerate() {
                let indices = &rows.values[start..*end as usize];
                start = *end as usize;
                let n_triangles = (self.faces.n_triangles() + indices.len()).saturating_sub(2) as u64;
                let are_in_range = indices.iter().all(|index| (0.0..self.n_vertices as f64).contains(index));
                if indices.len() < 3 || !are_in_range || n_triangles > self.limits.rows {
                    return Ok(i as u64);
                }
                self.corners.clear();
                for index in indices {
                    push(&mut self.corners, *index as u32)?;
                }
                self.faces.push(&self.corners, row)?;
                row += 1;
            }
            Ok(rows.ends.len() as u64)
        })
    }

    /// Reads all rows of an element of strips: -1 starts a new strip.
    pub(super) fn strips(
        &mut self,
        body: &mut PlyBody,
        element: &PlyElement,
        warnings: &mut Warnings,
    ) -> Result<(), ReadError> {
        let list = corner_list(element, warnings)?;
        let before = self.faces.n_triangles() as u64;
        let (mut indices, mut n_stitches) = (Vec::new(), 0);
        for row in 0..element.rows {
            self.row(body, element, row, list, &mut indices)?;
            for strip in indices.split(|i| *i == -1) {
                if let Some(index) = strip.iter().find(|i| **i < 0) {
                    return Err(self.out_of_range(body, element, *index));
                }
                for (i, triple) in strip.windows(3).enumerate() {
                    let [a, b, c] = [triple[0] as u32, triple[1] as u32, triple[2] as u32];
                    if a == b || b == c || c == a {
                        n_stitches += 1;
                        continue;
                    }
                    // Every second triangle of a strip has the opposite orientation.
                    self.faces.push(&if i % 2 == 0 { [a, b, c] } else { [b, a, c] }, row)?;
                }
                self.check_rows(body)?;
            }
        }
        let n = self.faces.n_triangles() as u64 - before;
        warnings.count_many("strips-cut", n, || {
            (FileLocation::Line(element.line), "triangles were read from strips".to_owned())
        });
        let message = "triangles of strips that only lead to the next place were dropped";
        warnings.count_all("strip-stitches", n_stitches, message);
        Ok(())
    }

    /// Reads one row, and appends the indices of the list to `into` after checking their range.
    fn row(
        &self,
        body: &mut PlyBody,
        element: &PlyElement,
        row: u64,
        list: usize,
        into: &mut Vec<i64>,
    ) -> Result<(), ReadError> {
        body.start_row(element, row)?;
        for (i, property) in element.properties.iter().enumerate() {
            let PlyPropertyType::List { length, item } = property.shape else {
                body.skip(element, property.shape)?;
                continue;
            };
            if i != list {
                body.skip(element, property.shape)?;
                continue;
            }
            into.clear();
            for _ in 0..body.length(element, length, item)? {
                let index = body.integer(element, item)?;
                if index >= 0 && index as u64 >= self.n_vertices {
                    return Err(self.out_of_range(body, element, index));
                }
                push(into, index)?;
            }
        }
        body.end_row(element)
    }

    fn out_of_range(&self, body: &PlyBody, element: &PlyElement, index: i64) -> ReadError {
        let n = grouped(self.n_vertices);
        let message = format!("index {index} is out of range: there are {n} vertices, from 0");
        body.error(element, "index-out-of-range", &message)
    }

    fn check_rows(&self, body: &PlyBody) -> Result<(), ReadError> {
        let n = self.faces.n_triangles() as u64;
        if n > self.limits.rows {
            return Err(too_many_rows(body.place(), "triangles", n, self.limits.rows));
        }
        Ok(())
    }
}

/// The property with the corners; the others are counted.
fn corner_list(element: &PlyElement, warnings: &mut Warnings) -> Result<usize, ReadError> {
    let is_list = |p: &super::header::PlyProperty| match p.shape {
        PlyPropertyType::List { item, .. } => item.range().is_some() && CORNERS.contains(&p.name.as_str()),
        PlyPropertyType::One(_) => false,
    };
    let place = || FileLocation::Line(element.line);
    let Some(list) = element.properties.iter().position(is_list) else {
        let message = format!(
            "element '{}' has no list of integers '{}' or '{}'",
            element.name, CORNERS[0], CORNERS[1]
        );
        return Err(ReadError::new("no-corners", place(), message));
    };
    for (i, property) in element.properties.iter().enumerate() {
        if i != list {
            warnings.count_many("face-property-skipped", element.rows.min(1), || {
                let message =
                    format!("properties of faces were skipped, '{}' first", property.name.escape_default());
                (place(), message)
            });
        }
    }
    Ok(list)
}
