//! Writes PLY.
use super::CERTIFICATE;
use super::vertices::POSITION_ID;
use crate::certificate::write_comments;
use crate::instances::{PartInstance, part_instances};
use crate::text::grouped;
use crate::{Scene, WriteError};
use chordal::explicit::{Attribute, Domain, Semantic};
use serde_json::Value;
use std::io::{BufWriter, Write};

/// Writes a scene as binary little-endian PLY: positions and texture coordinates as doubles, normals as
/// floats, indices as 32-bit.
///
/// PLY has one row for each vertex, so vertices that differ only in their attributes stay separate rows. If
/// the mesh links them, a property `position_id` holds the first row at the same position. This reader
/// understands it, others skip it. Transforms of nodes are applied, and all parts become one. Colours are
/// bytes if that is exact, else floats. The certificate is in comments. [`crate::losses`] lists the data that
/// PLY cannot hold.
///
/// # Errors
/// [`WriteError`] if the sink fails, a node is invalid, there are more than 2³² − 2 vertices, or the
/// certificate is too long.
///
/// ```
/// use chordal::Mesh;
/// use chordal_io::{Content, Frame, Limits, Scene, ply};
/// let mesh = Mesh::new(vec![[0.1, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let mut file = Vec::new();
/// ply::write(&Scene::from_mesh("", mesh.clone(), Frame::default()), None, &mut file)?;
/// let Content::Scene(scene) = ply::read(&file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(scene.parts[0].mesh, mesh);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write(scene: &Scene, certificate: Option<&Value>, out: &mut dyn Write) -> Result<(), WriteError> {
    let parts = part_instances(scene)?;
    let plan = PlyFileLayout::from_parts(&parts)?;
    let mut out = BufWriter::new(out);
    plan.header(certificate, &mut out)?;
    let mut first_vertex = 0;
    for part in &parts {
        plan.vertices(part, first_vertex, &mut out)?;
        first_vertex += part.part.mesh.positions().len() as u32;
    }
    let mut first_vertex = 0;
    for part in &parts {
        faces(part, first_vertex, &mut out)?;
        first_vertex += part.part.mesh.positions().len() as u32;
    }
    out.flush()?;
    Ok(())
}

/// How colours are written.
#[derive(Clone, Copy, PartialEq, Eq)]
enum PlyColors {
    None,
    Bytes(usize),
    Floats(usize),
}

/// The properties of every row of the file: all that any part has.
struct PlyFileLayout {
    n_vertices: u64,
    n_faces: u64,
    has_normals: bool,
    has_texcoords: bool,
    colors: PlyColors,
    has_ids: bool,
}

impl PlyFileLayout {
    fn from_parts(parts: &[PartInstance]) -> Result<Self, WriteError> {
        let count = |n: fn(&PartInstance) -> usize| parts.iter().map(|p| n(p) as u64).sum::<u64>();
        let n_vertices = count(|p| p.part.mesh.positions().len());
        let n_faces = count(|p| p.part.mesh.faces().len());
        if n_vertices >= u64::from(u32::MAX) {
            let message = format!("{} vertices are more than 32-bit indices can name", grouped(n_vertices));
            return Err(WriteError::Unsupported(message));
        }
        let has = |semantic: Semantic, width: usize| {
            parts.iter().any(|p| p.vertex_attribute(&semantic, width).is_some())
        };
        Ok(Self {
            n_vertices,
            n_faces,
            has_normals: has(Semantic::Normal, 3),
            has_texcoords: has(Semantic::TexCoord(0), 2),
            colors: PlyColors::from_parts(parts),
            has_ids: parts.iter().any(|p| p.part.mesh.position_id().is_some()),
        })
    }

    fn header(&self, certificate: Option<&Value>, out: &mut impl Write) -> Result<(), WriteError> {
        writeln!(out, "ply\nformat binary_little_endian 1.0")?;
        write_comments(CERTIFICATE, certificate, out)?;
        writeln!(out, "element vertex {}", self.n_vertices)?;
        let mut property = |kind: &str, names: &[&str]| -> Result<(), WriteError> {
            Ok(names.iter().try_for_each(|name| writeln!(out, "property {kind} {name}"))?)
        };
        property("double", &["x", "y", "z"])?;
        if self.has_normals {
            property("float", &["nx", "ny", "nz"])?;
        }
        if self.has_texcoords {
            property("double", &["s", "t"])?;
        }
        let names = ["red", "green", "blue", "alpha"];
        match self.colors {
            PlyColors::None => {}
            PlyColors::Bytes(width) => property("uchar", &names[..width])?,
            PlyColors::Floats(width) => property("float", &names[..width])?,
        }
        if self.has_ids {
            property("uint", &[POSITION_ID])?;
        }
        writeln!(out, "element face {}\nproperty list uchar uint vertex_indices\nend_header", self.n_faces)?;
        Ok(())
    }

    fn vertices(
        &self,
        part: &PartInstance,
        first_vertex: u32,
        out: &mut impl Write,
    ) -> Result<(), WriteError> {
        let normals = part.vertex_attribute(&Semantic::Normal, 3);
        let texcoords = part.vertex_attribute(&Semantic::TexCoord(0), 2);
        let colors = part.vertex_attribute(&Semantic::Color(0), 3);
        let first_rows = part.first_rows();
        let mut row = Vec::new();
        for (vertex, first_row) in first_rows.iter().enumerate() {
            row.clear();
            put_doubles(&mut row, &part.position(vertex)?);
            if self.has_normals {
                put_floats(&mut row, &normals.map_or([0.0; 3], |a| part.normal(a.row(vertex))));
            }
            if self.has_texcoords {
                put_doubles(&mut row, texcoords.map_or(&[0.0; 2], |a| &a.row(vertex)[..2]));
            }
            let channel = |k: usize| colors.map_or(1.0, |a| a.row(vertex).get(k).copied().unwrap_or(1.0));
            match self.colors {
                PlyColors::None => {}
                PlyColors::Bytes(width) => row.extend((0..width).map(|k| byte(channel(k)).unwrap_or(255))),
                PlyColors::Floats(width) => (0..width).for_each(|k| put_floats(&mut row, &[channel(k)])),
            }
            if self.has_ids {
                row.extend_from_slice(&(first_vertex + first_row).to_le_bytes());
            }
            out.write_all(&row)?;
        }
        Ok(())
    }
}

fn put_doubles(row: &mut Vec<u8>, numbers: &[f64]) {
    numbers.iter().for_each(|x| row.extend_from_slice(&x.to_le_bytes()));
}

fn put_floats(row: &mut Vec<u8>, numbers: &[f64]) {
    numbers.iter().for_each(|x| row.extend_from_slice(&(*x as f32).to_le_bytes()));
}

fn faces(part: &PartInstance, first_vertex: u32, out: &mut impl Write) -> Result<(), WriteError> {
    let order = part.order();
    for face in part.part.mesh.faces() {
        let mut row = [0; 13];
        row[0] = 3;
        for (slot, corner) in row[1..].chunks_exact_mut(4).zip(order) {
            slot.copy_from_slice(&(first_vertex + face[corner]).to_le_bytes());
        }
        out.write_all(&row)?;
    }
    Ok(())
}

impl PlyColors {
    fn from_parts(parts: &[PartInstance]) -> Self {
        let colors: Vec<&Attribute> =
            parts.iter().filter_map(|p| p.vertex_attribute(&Semantic::Color(0), 3)).collect();
        let Some(width) = colors.iter().map(|a| a.width.min(4)).max() else { return Self::None };
        let exact = colors.iter().all(|a| a.values.iter().all(|x| byte(*x).is_some()));
        if exact { Self::Bytes(width) } else { Self::Floats(width) }
    }
}

/// The byte that reads back as exactly this channel.
fn byte(channel: f64) -> Option<u8> {
    let nearest = (channel * 255.0).round();
    let fits = (0.0..=255.0).contains(&nearest) && nearest / 255.0 == channel;
    fits.then_some(nearest as u8)
}

/// Whether the writer keeps an attribute.
pub(crate) fn keeps(attribute: &Attribute) -> bool {
    let Attribute { semantic, domain, width, .. } = attribute;
    match (semantic, domain) {
        (Semantic::Normal, Domain::Vertex) => *width == 3,
        (Semantic::TexCoord(0), Domain::Vertex) => *width == 2,
        (Semantic::Color(0), Domain::Vertex) => *width >= 3,
        _ => false,
    }
}
