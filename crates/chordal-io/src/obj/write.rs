//! Writes Wavefront OBJ.
use super::CERTIFICATE;
use super::names::{ObjNames, one_line};
use crate::certificate::write_comments;
use crate::instances::{PartInstance, part_instances};
use crate::number::{put_count, put_double, put_single};
use crate::{Frame, MATERIAL, Scene, TextureOrigin, WriteError};
use chordal::explicit::{Attribute, Domain, Semantic};
use serde_json::Value;
use std::io::{BufWriter, Write};

/// Writes a scene as OBJ.
///
/// Each position is written once: vertices with the same [`chordal::Mesh::position_id`] share their `v` line
/// and differ in their `vn` and `vt`. The origin of texture coordinates is the lower left corner: v is
/// written as (1 - v) if the frame says that it runs down. Positions and texture coordinates are the shortest
/// decimals that read back to the same f64, normals to the same f32. Transforms of nodes are applied; each
/// node becomes an `o`. Group attributes become `usemtl`, `g`, `o` and `s`; each material gets a unique name.
/// The certificate is in comments. [`crate::losses`] lists the data that OBJ cannot hold.
///
/// # Errors
/// [`WriteError`] if the sink fails, a node is invalid, or the certificate is too long.
///
/// ```
/// use chordal::Mesh;
/// use chordal_io::{Frame, Scene, obj};
/// let mesh = Mesh::new(vec![[0.0; 3], [0.1, 0.0, 0.0], [0.0, 1e300, 0.0]], vec![[0, 1, 2]])?;
/// let mut file = Vec::new();
/// obj::write(&Scene::from_mesh("", mesh, Frame::default()), None, &mut file)?;
/// assert_eq!(file, b"v 0 0 0\nv 0.1 0 0\nv 0 1e300 0\nf 1 2 3\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write(scene: &Scene, certificate: Option<&Value>, out: &mut dyn Write) -> Result<(), WriteError> {
    write_with_library(scene, certificate, None, out)
}

/// As [`write`], and refers to a material library, which [`super::side_files`] creates.
///
/// # Errors
/// As for [`write`].
pub fn write_with_library(
    scene: &Scene,
    certificate: Option<&Value>,
    library: Option<&str>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let parts = part_instances(scene)?;
    let mut writer = ObjWriter { out: BufWriter::new(out), line: Vec::new(), written: [0; 3] };
    write_comments(CERTIFICATE, certificate, &mut writer.out)?;
    if let Some(library) = library {
        writer.statement("mtllib", library)?;
    }
    let names = ObjNames::new(&scene.groups, &scene.assets);
    for part in &parts {
        if parts.len() > 1 || !part.name.is_empty() {
            writer.statement("o", part.name)?;
        }
        writer.part(part, &names, &scene.frame)?;
    }
    writer.out.flush()?;
    Ok(())
}

/// The kinds of groups that have a statement, and their statements.
pub(super) const GROUPS: [(&str, &str); 6] =
    [(MATERIAL, "usemtl"), ("usemtl", "usemtl"), ("g", "g"), ("solid", "g"), ("o", "o"), ("s", "s")];

pub(super) struct ObjWriter<'a> {
    pub(super) out: BufWriter<&'a mut dyn Write>,
    /// The current line.
    pub(super) line: Vec<u8>,
    /// The numbers of `v`, `vt` and `vn` lines so far.
    pub(super) written: [u64; 3],
}

/// A stream of `vt` or `vn` lines, one for each row; it finds the line for a corner.
struct ObjStream {
    first: u64,
    domain: Domain,
}

impl ObjStream {
    fn line(&self, face: usize, corner: usize, vertex: u32) -> u64 {
        self.first
            + match self.domain {
                Domain::Vertex => u64::from(vertex),
                Domain::Corner => 3 * face as u64 + corner as u64,
                Domain::Face => face as u64,
            }
    }
}

impl ObjWriter<'_> {
    pub(super) fn statement(&mut self, keyword: &str, name: &str) -> Result<(), WriteError> {
        let name = one_line(name);
        Ok(if name.is_empty() {
            writeln!(self.out, "{keyword}")
        } else {
            writeln!(self.out, "{keyword} {name}")
        }?)
    }

    /// Writes a line of a keyword and numbers.
    pub(super) fn numbers(
        &mut self,
        keyword: &str,
        numbers: impl IntoIterator<Item = f64>,
    ) -> Result<(), WriteError> {
        self.line.clear();
        self.line.extend_from_slice(keyword.as_bytes());
        for number in numbers {
            self.line.push(b' ');
            put_double(&mut self.line, number);
        }
        self.end_line()
    }

    /// Writes a texture coordinate; v runs up.
    pub(super) fn texcoord(&mut self, [u, v]: [f64; 2], frame: &Frame) -> Result<(), WriteError> {
        let v = if frame.turns_v(TextureOrigin::LowerLeft) { 1.0 - v } else { v };
        self.numbers("vt", [u, v])
    }

    /// Ends and writes the line.
    pub(super) fn end_line(&mut self) -> Result<(), WriteError> {
        self.line.push(b'\n');
        Ok(self.out.write_all(&self.line)?)
    }

    fn part(&mut self, part: &PartInstance, names: &ObjNames, frame: &Frame) -> Result<(), WriteError> {
        let positions = self.positions(part)?;
        let texcoords = self.stream(part, &Semantic::TexCoord(0), frame)?;
        let normals = self.stream(part, &Semantic::Normal, frame)?;
        let mut groups: Vec<(&Attribute, &str, &str, f64)> = Vec::new();
        for (kind, keyword) in GROUPS {
            let attribute = part.part.mesh.attribute(&Semantic::Group(kind.to_owned()));
            let Some(attribute) = attribute.filter(|a| a.domain == Domain::Face && a.width == 1) else {
                continue;
            };
            // Several kinds may share a statement; the first one has it.
            if !groups.iter().any(|(_, _, other, _)| *other == keyword) {
                groups.push((attribute, kind, keyword, 0.0));
            }
        }
        let order = part.order();
        for (face_idx, face) in part.part.mesh.faces().iter().enumerate() {
            for (attribute, kind, keyword, current) in &mut groups {
                let value = attribute.row(face_idx)[0];
                if value != *current {
                    *current = value;
                    self.statement(keyword, &names.name(kind, value))?;
                }
            }
            self.line.clear();
            self.line.push(b'f');
            for corner in order {
                let vertex = face[corner];
                self.line.push(b' ');
                put_count(&mut self.line, positions[vertex as usize]);
                let streams = [&texcoords, &normals].map(Option::as_ref);
                let [texcoord, normal] = streams.map(|s| s.map(|s| s.line(face_idx, corner, vertex)));
                if texcoord.is_some() || normal.is_some() {
                    self.line.push(b'/');
                }
                texcoord.into_iter().for_each(|row| put_count(&mut self.line, row));
                if let Some(row) = normal {
                    self.line.push(b'/');
                    put_count(&mut self.line, row);
                }
            }
            self.end_line()?;
        }
        Ok(())
    }

    /// Writes every position once, with its colour, and returns the line for each vertex.
    fn positions(&mut self, part: &PartInstance) -> Result<Vec<u64>, WriteError> {
        let first_rows = part.first_rows();
        let color = part.vertex_attribute(&Semantic::Color(0), 3).filter(|c| colors_agree(c, &first_rows));
        let width = color.map_or(0, |c| if c.width > 3 && has_alpha(c) { 4 } else { 3 });
        let mut lines = vec![0; first_rows.len()];
        for (vertex, &first) in first_rows.iter().enumerate() {
            if first as usize != vertex {
                lines[vertex] = lines[first as usize];
                continue;
            }
            let color = color.map_or(&[][..], |c| &c.row(vertex)[..width]);
            self.numbers("v", part.position(vertex)?.into_iter().chain(color.iter().copied()))?;
            self.written[0] += 1;
            lines[vertex] = self.written[0];
        }
        Ok(lines)
    }

    fn stream(
        &mut self,
        part: &PartInstance,
        semantic: &Semantic,
        frame: &Frame,
    ) -> Result<Option<ObjStream>, WriteError> {
        let is_normal = *semantic == Semantic::Normal;
        let (width, count) = if is_normal { (3, 2) } else { (2, 1) };
        let Some(attribute) = part.part.mesh.attribute(semantic).filter(|a| a.width == width) else {
            return Ok(None);
        };
        let first = self.written[count] + 1;
        for row in attribute.values.chunks_exact(width) {
            if is_normal {
                self.normal(part.normal(row))?;
            } else {
                self.texcoord([row[0], row[1]], frame)?;
            }
            self.written[count] += 1;
        }
        Ok(Some(ObjStream { first, domain: attribute.domain }))
    }

    /// Writes a normal, in single precision.
    fn normal(&mut self, normal: [f64; 3]) -> Result<(), WriteError> {
        self.line.clear();
        self.line.extend_from_slice(b"vn");
        for x in normal {
            self.line.push(b' ');
            put_single(&mut self.line, x as f32);
        }
        self.end_line()
    }
}

/// Whether the writer keeps an attribute; `first_rows` has for each row the first row of the same vertex.
pub(crate) fn keeps(attribute: &Attribute, first_rows: &[u32]) -> bool {
    let Attribute { semantic, domain, width, .. } = attribute;
    match (semantic, domain) {
        (Semantic::Normal, _) => *width == 3,
        (Semantic::TexCoord(0), _) => *width == 2,
        (Semantic::Color(0), Domain::Vertex) => *width >= 3 && colors_agree(attribute, first_rows),
        (Semantic::Group(kind), Domain::Face) => *width == 1 && GROUPS.iter().any(|(known, _)| known == kind),
        _ => false,
    }
}

/// Whether vertices at one position have one colour, so that their common line can hold it.
fn colors_agree(color: &Attribute, first_rows: &[u32]) -> bool {
    first_rows.iter().enumerate().all(|(vertex, first)| color.row(vertex) == color.row(*first as usize))
}

fn has_alpha(color: &Attribute) -> bool {
    color.values.chunks_exact(color.width).any(|row| row[3] != 1.0)
}
