//! Writes OFF.
use super::CERTIFICATE;
use super::colors::OffColorSpelling;
use crate::certificate::write_comments;
use crate::instances::{PartInstance, part_instances};
use crate::number::{put_count, put_shortest};
use crate::text::grouped;
use crate::{Scene, WriteError};
use chordal::explicit::{Attribute, Domain, Semantic};
use serde_json::Value;
use std::io::{BufWriter, Write};

/// Writes a scene as OFF text, with all numbers as the shortest decimals that read back to the same f64.
///
/// OFF has one row for each position, so vertices with the same [`chordal::Mesh::position_id`] become one
/// row. An attribute of vertices is kept if such vertices agree in it: normals, colours and texture
/// coordinates of set 0. Colours of faces are kept too. Colours are whole numbers up to 255 if that is exact,
/// else fractions. Transforms of nodes are applied, and all parts become one; if only some have an attribute,
/// the others get normals and texture coordinates of 0, white vertices and faces without a colour. The
/// certificate is in comments. [`crate::losses`] lists the data that OFF cannot hold.
///
/// # Errors
/// [`WriteError`] if the sink fails, a node is invalid, there are more than 2³² − 2 vertices, or the
/// certificate is too long.
///
/// ```
/// use chordal::Mesh;
/// use chordal_io::{Frame, Scene, off};
/// let mesh = Mesh::new(vec![[0.0; 3], [0.1, 0.0, 0.0], [0.0, 1e300, 0.0]], vec![[0, 1, 2]])?;
/// let mut file = Vec::new();
/// off::write(&Scene::from_mesh("", mesh, Frame::default()), None, &mut file)?;
/// assert_eq!(file, b"OFF\n3 1 0\n0 0 0\n0.1 0 0\n0 1e300 0\n3 0 1 2\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write(scene: &Scene, certificate: Option<&Value>, out: &mut dyn Write) -> Result<(), WriteError> {
    let instances = part_instances(scene)?;
    let parts: Vec<_> = instances.iter().map(OffPartLayout::from_instance).collect();
    let layout = OffFileLayout::from_parts(&parts)?;
    let mut out = BufWriter::new(out);
    layout.header(certificate, &mut out)?;
    parts.iter().try_for_each(|part| layout.vertices(part, &mut out))?;
    let mut first = 0;
    for part in &parts {
        layout.faces(part, first, &mut out)?;
        first += part.n_rows;
    }
    out.flush()?;
    Ok(())
}

/// Whether the writer keeps an attribute; `first_rows` has for each row the first row of the same vertex.
pub(crate) fn keeps(attribute: &Attribute, first_rows: &[u32]) -> bool {
    let Attribute { semantic, domain, width, .. } = attribute;
    let is_color = *semantic == Semantic::Color(0) && matches!(width, 3 | 4);
    match (semantic, domain) {
        (Semantic::Normal, Domain::Vertex) if *width == 3 => rows_agree(attribute, first_rows),
        (Semantic::TexCoord(0), Domain::Vertex) if *width == 2 => rows_agree(attribute, first_rows),
        (_, Domain::Vertex) if is_color => rows_agree(attribute, first_rows),
        (_, Domain::Face) => is_color,
        _ => false,
    }
}

/// Whether vertices at one position have one value, so that their common row can hold it.
fn rows_agree(attribute: &Attribute, first_rows: &[u32]) -> bool {
    let mut rows = first_rows.iter().enumerate();
    rows.all(|(vertex, first)| attribute.row(vertex) == attribute.row(*first as usize))
}

/// A part with the data of it that is written.
struct OffPartLayout<'a> {
    instance: &'a PartInstance<'a>,
    /// For each vertex the first one at its position.
    first_rows: Vec<u32>,
    n_rows: u64,
    normals: Option<&'a Attribute>,
    texcoords: Option<&'a Attribute>,
    colors: Option<&'a Attribute>,
    face_colors: Option<&'a Attribute>,
}

impl<'a> OffPartLayout<'a> {
    fn from_instance(instance: &'a PartInstance<'a>) -> Self {
        let first_rows = instance.first_rows();
        let attributes = instance.part.mesh.attributes();
        let kept = |semantic: Semantic, domain: Domain| {
            let is_same = |a: &&Attribute| a.semantic == semantic && a.domain == domain;
            attributes.iter().filter(is_same).find(|a| keeps(a, &first_rows))
        };
        Self {
            normals: kept(Semantic::Normal, Domain::Vertex),
            texcoords: kept(Semantic::TexCoord(0), Domain::Vertex),
            colors: kept(Semantic::Color(0), Domain::Vertex),
            face_colors: kept(Semantic::Color(0), Domain::Face),
            n_rows: first_rows.iter().enumerate().filter(|(i, first)| *i == **first as usize).count() as u64,
            instance,
            first_rows,
        }
    }

    fn n_faces(&self) -> u64 {
        self.instance.part.mesh.faces().len() as u64
    }
}

/// The spelling of the colours of a list: the number of channels, and bytes or fractions.
#[derive(Clone, Copy, Debug)]
struct OffColorLayout {
    width: usize,
    spelling: OffColorSpelling,
}

impl OffColorLayout {
    /// The layout for the colours of all parts, with at least `least` channels; `None` if there are no
    /// colours.
    fn from_attributes<'a>(
        attributes: impl Iterator<Item = &'a Attribute> + Clone,
        least: usize,
    ) -> Option<Self> {
        let width = attributes.clone().map(|a| a.width).max()?.max(least);
        // The alpha of narrower rows, and of vertices without a colour, is 1, which is also a byte.
        let is_narrower = |a: &Attribute| a.width < width && !a.values.is_empty();
        let alpha = attributes.clone().any(is_narrower).then_some(&1.0);
        let spelling = OffColorSpelling::from_channels(attributes.flat_map(|a| &a.values).chain(alpha));
        Some(Self { width, spelling })
    }

    /// Appends a colour, white if there is none.
    fn put(self, line: &mut Vec<u8>, color: &[f64]) {
        (0..self.width).for_each(|k| self.spelling.put(line, color.get(k).copied().unwrap_or(1.0)));
    }
}

/// The data of every row of the file: all that any part has.
struct OffFileLayout {
    n_vertices: u64,
    n_faces: u64,
    has_normals: bool,
    has_texcoords: bool,
    colors: Option<OffColorLayout>,
    face_colors: Option<OffColorLayout>,
}

impl OffFileLayout {
    fn from_parts(parts: &[OffPartLayout]) -> Result<Self, WriteError> {
        let n_vertices = parts.iter().map(|part| part.n_rows).sum();
        if n_vertices >= u64::from(u32::MAX) {
            let message = format!("{} vertices are more than 32-bit indices can name", grouped(n_vertices));
            return Err(WriteError::Unsupported(message));
        }
        Ok(Self {
            n_vertices,
            n_faces: parts.iter().map(OffPartLayout::n_faces).sum(),
            has_normals: parts.iter().any(|part| part.normals.is_some()),
            has_texcoords: parts.iter().any(|part| part.texcoords.is_some()),
            // Geomview's vertex colours have an alpha, and Assimp refuses a file without it; face colours may
            // leave it out.
            colors: OffColorLayout::from_attributes(parts.iter().filter_map(|part| part.colors), 4),
            face_colors: OffColorLayout::from_attributes(parts.iter().filter_map(|part| part.face_colors), 3),
        })
    }

    fn header(&self, certificate: Option<&Value>, out: &mut impl Write) -> Result<(), WriteError> {
        let letter = |has: bool, letter: &'static str| if has { letter } else { "" };
        let texcoords = letter(self.has_texcoords, "ST");
        let colors = letter(self.colors.is_some(), "C");
        writeln!(out, "{texcoords}{colors}{}OFF", letter(self.has_normals, "N"))?;
        end_header(certificate, [self.n_vertices, self.n_faces], out)
    }

    fn vertices(&self, part: &OffPartLayout, out: &mut impl Write) -> Result<(), WriteError> {
        let mut line = Vec::new();
        for (vertex, &first) in part.first_rows.iter().enumerate() {
            if first as usize != vertex {
                continue;
            }
            line.clear();
            put_numbers(&mut line, &part.instance.position(vertex)?);
            if self.has_normals {
                let normal = part.normals.map_or([0.0; 3], |a| part.instance.normal(a.row(vertex)));
                put_numbers(&mut line, &normal);
            }
            if let Some(layout) = self.colors {
                layout.put(&mut line, part.colors.map_or(&[], |a| a.row(vertex)));
            }
            if self.has_texcoords {
                put_numbers(&mut line, part.texcoords.map_or(&[0.0; 2], |a| a.row(vertex)));
            }
            line.push(b'\n');
            // Every number is preceded by a space.
            out.write_all(line.trim_ascii_start())?;
        }
        Ok(())
    }

    fn faces(&self, part: &OffPartLayout, first: u64, out: &mut impl Write) -> Result<(), WriteError> {
        let rows = file_rows(part, first);
        let order = part.instance.order();
        let mut line = Vec::new();
        for (face_idx, face) in part.instance.part.mesh.faces().iter().enumerate() {
            line.clear();
            line.push(b'3');
            for corner in order {
                line.push(b' ');
                put_count(&mut line, rows[face[corner] as usize]);
            }
            if let (Some(layout), Some(colors)) = (self.face_colors, part.face_colors) {
                layout.put(&mut line, colors.row(face_idx));
            }
            line.push(b'\n');
            out.write_all(&line)?;
        }
        Ok(())
    }
}

/// For each vertex of a part its row in the file.
fn file_rows(part: &OffPartLayout, first: u64) -> Vec<u64> {
    let (mut rows, mut next) = (vec![0; part.first_rows.len()], first);
    for (vertex, &same) in part.first_rows.iter().enumerate() {
        if same as usize == vertex {
            rows[vertex] = next;
            next += 1;
        } else {
            rows[vertex] = rows[same as usize];
        }
    }
    rows
}

/// Writes the certificate and the counts. The number of edges, which readers do not use, is 0.
pub(super) fn end_header(
    certificate: Option<&Value>,
    counts: [u64; 2],
    out: &mut impl Write,
) -> Result<(), WriteError> {
    write_comments(CERTIFICATE, certificate, out)?;
    Ok(writeln!(out, "{} {} 0", counts[0], counts[1])?)
}

/// Appends numbers, each after a space.
pub(super) fn put_numbers(line: &mut Vec<u8>, numbers: &[f64]) {
    for number in numbers {
        line.push(b' ');
        put_shortest(line, *number);
    }
}
