//! The faces of an OFF file: polygons, each with an optional colour.
use super::colors::OffColors;
use super::rows::OffRowReader;
use crate::assemble::too_many_rows;
use crate::faces::{Faces, SHORT_FACES};
use crate::grow::push;
use crate::text::grouped;
use crate::warnings::Warnings;
use crate::{Limits, ReadError};

/// Reads faces; their indices must be below the number of vertices.
pub(super) struct OffFaceReader<'a> {
    pub(super) faces: Faces,
    /// One row for each triangle.
    pub(super) colors: OffColors,
    n_vertices: u64,
    limits: &'a Limits,
    corners: Vec<u32>,
}

impl<'a> OffFaceReader<'a> {
    pub(super) fn new(n_vertices: u64, limits: &'a Limits) -> Self {
        let (faces, colors) = (Faces::default(), OffColors::default());
        Self { faces, colors, n_vertices, limits, corners: Vec::new() }
    }

    /// Reads all rows.
    pub(super) fn read(
        &mut self,
        rows: &mut OffRowReader,
        n_faces: u64,
        is_binary: bool,
        warnings: &mut Warnings,
    ) -> Result<(), ReadError> {
        // The number of corners, and in a binary file also the number of channels.
        rows.start_list("face", n_faces, 1 + usize::from(is_binary))?;
        for row in 0..n_faces {
            rows.start_row(row)?;
            self.face(rows, warnings)?;
            rows.end_row()?;
            let n = self.faces.n_triangles() as u64;
            if n > self.limits.rows {
                return Err(too_many_rows(rows.place(), "triangles", n, self.limits.rows));
            }
        }
        Ok(())
    }

    #[inline]
    fn face(&mut self, rows: &mut OffRowReader, warnings: &mut Warnings) -> Result<(), ReadError> {
        self.corners.clear();
        for _ in 0..rows.length()? {
            let index = rows.corner()?;
            if index < 0 || index as u64 >= self.n_vertices {
                let n = grouped(self.n_vertices);
                let message = format!("index {index} is out of range: there are {n} vertices, from 0");
                return Err(rows.error("index-out-of-range", &message));
            }
            push(&mut self.corners, index as u32)?;
        }
        if rows.goes_on()? {
            let message = "faces whose corners stand on several lines were put together";
            warnings.count("faces-over-lines", || (rows.place(), message.to_owned()));
        }
        // Read for faces that are dropped below as well: the next face begins after it.
        let color = match rows.n_face_channels()? {
            0 => None,
            1 => {
                rows.number()?;
                let message =
                    "colours of faces by their number in a colour map were skipped: there is no map";
                warnings.count("color-map-skipped", || (rows.place(), message.to_owned()));
                None
            }
            width => Some(rows.color(width)?),
        };
        if self.corners.len() < 3 {
            warnings.count("short-faces", || (rows.place(), SHORT_FACES.to_owned()));
            return Ok(());
        }
        let before = self.faces.n_triangles();
        self.faces.push(&self.corners, rows.line_or_row())?;
        let n_new = self.faces.n_triangles() - before;
        match color {
            Some(color) => self.colors.push(color, n_new),
            None => self.colors.push_missing(n_new),
        }
    }
}
