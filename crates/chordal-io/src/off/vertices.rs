//! `OffVertices`: the vertices of an OFF file: positions, normals, colours and texture coordinates.
use super::colors::OffColors;
use super::header::OffHeader;
use super::rows::OffRowReader;
use crate::grow::{push, with_room};
use crate::warnings::Warnings;
use crate::{Limits, ReadError};
use chordal::explicit::{Attribute, Domain, Semantic};

/// The rows of the vertices, one list for each kind of data.
#[derive(Debug)]
pub(super) struct OffVertices {
    pub(super) positions: Vec<[f64; 3]>,
    normals: Vec<f64>,
    texcoords: Vec<f64>,
    colors: OffColors,
}

/// The names of the coordinates in messages.
const AXES: [&str; 3] = ["x", "y", "z"];
/// The channels of vertex colours in binary files. Defined by Geomview: they have an alpha, and no other
/// count is possible.
const BINARY_CHANNELS: usize = 4;

impl OffVertices {
    /// Reads all rows.
    pub(super) fn read(
        rows: &mut OffRowReader,
        header: &OffHeader,
        limits: &Limits,
    ) -> Result<Self, ReadError> {
        let keyword = header.keyword;
        let n_after = 2 * usize::from(keyword.has_texcoords);
        let n_normals = 3 * usize::from(keyword.has_normals);
        let n_least = header.n_coordinates() + n_normals + 3 * usize::from(keyword.has_colors) + n_after;
        rows.start_list("vertex", header.n_vertices, n_least)?;
        // The file was checked to have the bytes of all rows, so the memory is in proportion.
        let n_rows = header.n_vertices as usize;
        let mut vertices = Self {
            positions: with_room(n_rows)?,
            normals: with_room(n_rows * n_normals)?,
            texcoords: with_room(n_rows * n_after)?,
            colors: OffColors::default(),
        };
        // A row has its parts in the reverse order of the keyword's letters, [ST][C][N].
        for row in 0..header.n_vertices {
            rows.start_row(row)?;
            let position = position(rows, header, limits)?;
            push(&mut vertices.positions, position)?;
            for _ in 0..n_normals {
                push(&mut vertices.normals, rows.number()?)?;
            }
            if keyword.has_colors {
                let color = rows.color(n_channels(rows, header, n_after)?)?;
                vertices.colors.push(color, 1)?;
            }
            for _ in 0..n_after {
                push(&mut vertices.texcoords, rows.number()?)?;
            }
            rows.end_row()?;
        }
        Ok(vertices)
    }

    /// The positions, and the other data as attributes.
    pub(super) fn into_attributes(self, warnings: &mut Warnings) -> (Vec<[f64; 3]>, Vec<Attribute>) {
        let mut attributes = Vec::new();
        let vertex = |semantic, width, values| Attribute { semantic, domain: Domain::Vertex, width, values };
        if !self.normals.is_empty() {
            attributes.push(vertex(Semantic::Normal, 3, self.normals));
        }
        if !self.texcoords.is_empty() {
            attributes.push(vertex(Semantic::TexCoord(0), 2, self.texcoords));
        }
        attributes.extend(self.colors.finish(Domain::Vertex, warnings));
        (self.positions, attributes)
    }
}

/// The number of channels of the colour that follows on the line.
fn n_channels(rows: &OffRowReader, header: &OffHeader, n_after: usize) -> Result<usize, ReadError> {
    if header.keyword.is_binary {
        return Ok(BINARY_CHANNELS);
    }
    match rows.n_words_left().checked_sub(n_after) {
        Some(n @ (3 | 4)) => Ok(n),
        _ => {
            let n = rows.n_words_left();
            let message = format!("{n} numbers for a colour of 3 or 4 and {n_after} texture coordinates");
            Err(rows.error("wrong-width", &message))
        }
    }
}

/// Reads a position. A homogeneous one is divided by its last coordinate.
#[inline]
fn position(rows: &mut OffRowReader, header: &OffHeader, limits: &Limits) -> Result<[f64; 3], ReadError> {
    let mut position = [0.0; 3];
    for x in &mut position[..header.dimension] {
        *x = rows.number()?;
    }
    if !limits.drop_nonfinite
        && let Some(k) = position.iter().position(|x| !x.is_finite())
    {
        return Err(rows.error("not-finite", &format!("{} = {} is not finite", AXES[k], position[k])));
    }
    if !header.keyword.is_homogeneous {
        return Ok(position);
    }
    let w = rows.number()?;
    // A quotient by infinity would be a finite number.
    let divided = if w.is_finite() { position.map(|x| x / w) } else { [f64::NAN; 3] };
    if limits.drop_nonfinite || divided.iter().all(|x| x.is_finite()) {
        return Ok(divided);
    }
    let message = format!("a position divided by its homogeneous coordinate {w} is not finite");
    Err(rows.error("not-finite", &message))
}
