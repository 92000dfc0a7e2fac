//! Writes triangles as PolyData.
use super::names::{COLOR, NORMALS, POSITION_ID, TANGENTS, TEXCOORDS, of_set};
use super::vtp_layout::{VtpArray, VtpLayout, VtpSection, index_type, put_index};
use crate::instances::first_rows;
use crate::text::grouped;
use crate::xml_text::escaped;
use crate::{Scene, TextureOrigin, WriteError};
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic};
use serde_json::Value;
use std::borrow::Cow;
use std::io::{BufWriter, Write};

/// Writes all parts of a scene as one VTK PolyData file (`.vtp`), in scene coordinates. Its arrays are
/// appended raw, little-endian, with lengths of 64 bits. Positions, normals, texture coordinates and other
/// values are `Float64` and keep every bit; colours are bytes if that is exact, else `Float64`. The
/// certificate is a string of the field data, which VTK's own programs preserve.
///
/// Attributes of vertices and faces become arrays of points and cells under their names; parts without an
/// attribute get 0, or white. Attributes of corners are left out, see [`crate::losses`].
///
/// # Errors
/// [`WriteError`] if the sink fails, the nodes of the scene are not a tree, or there are too many vertices.
///
/// ```
/// use chordal::Mesh;
/// use chordal_io::{Content, Frame, Limits, Scene, vtk};
/// let mesh = Mesh::new(vec![[0.1, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let mut file = Vec::new();
/// vtk::write(&Scene::from_mesh("part", mesh.clone(), Frame::default()), None, &mut file)?;
/// let Content::Scene(scene) = vtk::read_xml(&file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(scene.parts[0].mesh, mesh);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write(scene: &Scene, certificate: Option<&Value>, out: &mut dyn Write) -> Result<(), WriteError> {
    let certificate = certificate.map(crate::certificate::text).transpose()?;
    let meshes: Vec<Cow<'_, Mesh>> = scene.world_meshes()?.into_iter().map(|(_, mesh)| mesh).collect();
    let count = |n: fn(&Mesh) -> usize| meshes.iter().map(|mesh| n(mesh) as u64).sum::<u64>();
    let n_points = count(|mesh| mesh.positions().len());
    let n_polys = count(|mesh| mesh.faces().len());
    if n_points >= u64::from(u32::MAX) {
        let message = format!("{} vertices are more than 32-bit indices can name", grouped(n_points));
        return Err(WriteError::Unsupported(message));
    }
    let turns_v = scene.frame.turns_v(TextureOrigin::LowerLeft);
    let streams = VtpStream::of(&meshes, turns_v);
    let has_ids = meshes.iter().any(|mesh| mesh.position_id().is_some());
    // Offsets count corners.
    let index = index_type(greatest(n_points, 3 * n_polys));
    let index_bytes = if index == "Int32" { 4 } else { 8 };
    let mut arrays: Vec<VtpArray> = streams.iter().map(|stream| stream.array(n_points, n_polys)).collect();
    let array = |section, name: &str, kind, width, n_bytes| VtpArray {
        section,
        name: name.to_owned(),
        kind,
        width,
        n_bytes,
    };
    // The arrays of points and cells precede them, and so do their bytes.
    if has_ids {
        arrays.push(array(VtpSection::PointData, POSITION_ID, index, 1, n_points * index_bytes));
    }
    arrays.sort_by_key(|array| array.section == VtpSection::CellData);
    arrays.push(array(VtpSection::Points, "Points", "Float64", 3, n_points * 24));
    arrays.push(array(VtpSection::Polys, "connectivity", index, 1, 3 * n_polys * index_bytes));
    arrays.push(array(VtpSection::Polys, "offsets", index, 1, n_polys * index_bytes));
    let layout = VtpLayout { n_points, n_polys, active: active(&streams), arrays, certificate };
    let mut out = BufWriter::new(out);
    layout.write_head(&mut out)?;
    for array in &layout.arrays {
        out.write_all(&array.n_bytes.to_le_bytes())?;
        let stream =
            streams.iter().find(|stream| (stream.section(), &stream.name) == (array.section, &array.name));
        match (stream, array.section, &*array.name) {
            (Some(stream), ..) => stream.write(&meshes, &mut out)?,
            (None, VtpSection::PointData, _) => write_ids(&meshes, index, &mut out)?,
            (None, VtpSection::Points, _) => {
                for x in meshes.iter().flat_map(|mesh| mesh.positions().as_flattened()) {
                    out.write_all(&x.to_le_bytes())?;
                }
            }
            (None, _, "connectivity") => write_corners(&meshes, index, &mut out)?,
            (None, ..) => {
                let mut row = Vec::new();
                for face in 1..=n_polys {
                    row.clear();
                    put_index(&mut row, index, 3 * face);
                    out.write_all(&row)?;
                }
            }
        }
    }
    VtpLayout::write_end(&mut out)
}

fn greatest(a: u64, b: u64) -> u64 {
    if a > b { a } else { b }
}

/// Corners of all meshes; each mesh's indices start after the vertices of the previous ones.
fn write_corners(meshes: &[Cow<'_, Mesh>], index: &str, out: &mut impl Write) -> Result<(), WriteError> {
    let (mut first, mut row) = (0, Vec::new());
    for mesh in meshes {
        for face in mesh.faces() {
            row.clear();
            face.iter().for_each(|corner| put_index(&mut row, index, first + u64::from(*corner)));
            out.write_all(&row)?;
        }
        first += mesh.positions().len() as u64;
    }
    Ok(())
}

/// For each vertex the first at the same position.
fn write_ids(meshes: &[Cow<'_, Mesh>], index: &str, out: &mut impl Write) -> Result<(), WriteError> {
    let (mut first, mut row) = (0, Vec::new());
    for mesh in meshes {
        for id in first_rows(mesh) {
            row.clear();
            put_index(&mut row, index, first + u64::from(id));
            out.write_all(&row)?;
        }
        first += mesh.positions().len() as u64;
    }
    Ok(())
}

/// The roles of arrays (normals, texture coordinates, colours), which viewers use.
fn active(streams: &[VtpStream]) -> String {
    let named = |is_meant: fn(&Semantic) -> bool, attribute: &str| {
        let stream = streams.iter().find(|s| s.domain == Domain::Vertex && is_meant(&s.semantic));
        stream.map_or(String::new(), |stream| format!(" {attribute}=\"{}\"", escaped(&stream.name)))
    };
    named(|s| matches!(s, Semantic::Color(_)), "Scalars")
        + &named(|s| *s == Semantic::Normal, "Normals")
        + &named(|s| matches!(s, Semantic::TexCoord(_)), "TCoords")
}

/// An attribute that some mesh has.
#[derive(Debug)]
struct VtpStream {
    semantic: Semantic,
    domain: Domain,
    width: usize,
    /// Its name in the file, unique in its section.
    name: String,
    is_bytes: bool,
    turns_v: bool,
}

impl VtpStream {
    /// All attributes that some mesh has, in order of first occurrence.
    fn of(meshes: &[Cow<'_, Mesh>], turns_v: bool) -> Vec<Self> {
        let mut streams: Vec<Self> = Vec::new();
        for attribute in meshes.iter().flat_map(|mesh| mesh.attributes()).filter(|a| keeps(a)) {
            let Attribute { semantic, domain, width, values } = attribute;
            let is_color = matches!(semantic, Semantic::Color(_));
            let is_bytes = is_color && values.iter().all(|x| byte(*x).is_some());
            let is_same = |s: &&mut Self| (&s.semantic, s.domain, s.width) == (semantic, *domain, *width);
            if let Some(known) = streams.iter_mut().find(is_same) {
                known.is_bytes &= is_bytes;
                continue;
            }
            let plain = match semantic {
                Semantic::Normal => NORMALS.to_owned(),
                Semantic::Tangent => TANGENTS.to_owned(),
                Semantic::TexCoord(set) => of_set(TEXCOORDS, *set),
                Semantic::Color(set) => of_set(COLOR, *set),
                Semantic::Custom(name) | Semantic::Group(name) | Semantic::Blended(name) => name.clone(),
            };
            let is_taken = |name: &str| {
                let has_name = |s: &Self| s.domain == *domain && s.name == name;
                name == POSITION_ID || streams.iter().any(has_name)
            };
            let mut name = plain.clone();
            let mut again = 1;
            while is_taken(&name) {
                again += 1;
                name = format!("{plain} ({again})");
            }
            let turns_v = turns_v && matches!(semantic, Semantic::TexCoord(_));
            let semantic = semantic.clone();
            streams.push(Self { semantic, domain: *domain, width: *width, name, is_bytes, turns_v });
        }
        streams
    }

    fn section(&self) -> VtpSection {
        if self.domain == Domain::Vertex { VtpSection::PointData } else { VtpSection::CellData }
    }

    fn array(&self, n_points: u64, n_polys: u64) -> VtpArray {
        let n_rows = if self.domain == Domain::Vertex { n_points } else { n_polys };
        let (kind, value_bytes) = if self.is_bytes { ("UInt8", 1) } else { ("Float64", 8) };
        let n_bytes = n_rows * self.width as u64 * value_bytes;
        VtpArray { section: self.section(), name: self.name.clone(), kind, width: self.width, n_bytes }
    }

    fn write(&self, meshes: &[Cow<'_, Mesh>], out: &mut impl Write) -> Result<(), WriteError> {
        let missing = if matches!(self.semantic, Semantic::Color(_)) { 1.0 } else { 0.0 };
        let mut row = Vec::new();
        for mesh in meshes {
            let is_same = |a: &&Attribute| {
                (&a.semantic, a.domain, a.width) == (&self.semantic, self.domain, self.width)
            };
            let attribute = mesh.attributes().iter().find(is_same);
            let n_rows =
                if self.domain == Domain::Vertex { mesh.positions().len() } else { mesh.faces().len() };
            for i in 0..n_rows {
                row.clear();
                for k in 0..self.width {
                    let value = attribute.map_or(missing, |attribute| attribute.row(i)[k]);
                    let value = if self.turns_v && k == 1 { 1.0 - value } else { value };
                    match self.is_bytes.then(|| byte(value)).flatten() {
                        Some(byte) => row.push(byte),
                        None => row.extend_from_slice(&value.to_le_bytes()),
                    }
                }
                out.write_all(&row)?;
            }
        }
        Ok(())
    }
}

/// The byte that reads back as exactly this channel.
fn byte(channel: f64) -> Option<u8> {
    let nearest = (channel * 255.0).round();
    let fits = (0.0..=255.0).contains(&nearest) && nearest / 255.0 == channel;
    // -0 is not a byte.
    (fits && channel.is_sign_positive()).then_some(nearest as u8)
}

/// Whether the writer keeps an attribute.
pub(crate) fn keeps(attribute: &Attribute) -> bool {
    let Attribute { semantic, domain, width, .. } = attribute;
    let on_vertices = *domain == Domain::Vertex;
    match semantic {
        _ if *domain == Domain::Corner => false,
        Semantic::Normal => on_vertices && *width == 3,
        Semantic::Tangent => on_vertices && *width == 4,
        Semantic::TexCoord(_) => on_vertices && *width == 2,
        Semantic::Color(_) => matches!(*width, 3 | 4),
        Semantic::Custom(_) => true,
        Semantic::Group(_) | Semantic::Blended(_) => false,
    }
}
