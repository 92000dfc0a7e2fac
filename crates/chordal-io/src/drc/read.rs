//! Reads `.drc`.
use super::MAGIC;
use crate::assemble::{RawMesh, mesh};
use crate::draco_stream::{self, Refusal};
use crate::grow::with_room;
use crate::warnings::Warnings;
use crate::{Content, FileLocation, Frame, Limits, Part, ReadError, ReadOutcome, Scene, TextureOrigin};
use chordal::explicit::{Attribute, Domain, Semantic};
use draco_core::draco_types::DataType;
use draco_core::geometry_attribute::{GeometryAttributeType, PointAttribute};

/// The offset of the kind of a stream, after the signature and the version: 0 for points and 1 for triangles.
const KIND_AT: usize = 7;

/// Reads the triangles of a Draco file, with the normals, colours and texture coordinates of its points.
/// Positions are exactly those that the stream decodes to; what its encoder rounded away is not in the file.
/// Numbers of unknown meaning become attributes named by their index in the file.
///
/// At most [`Limits::bytes`] are decoded.
///
/// # Errors
/// [`ReadError`] for a stream that is damaged, over the limits, has only points, or has no positions.
///
/// Source: Google, *Draco Bitstream Specification*, 2.2, 2018.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    if !bytes.starts_with(MAGIC) {
        let message = "the file does not begin with DRACO";
        return Err(ReadError::new("bad-magic", FileLocation::Byte(0), message));
    }
    if bytes.get(KIND_AT) == Some(&0) {
        let message = "the stream holds points alone, which have no surface";
        return Err(ReadError::new("no-triangles", FileLocation::Byte(KIND_AT as u64), message));
    }
    let refused = |(code, message): Refusal| ReadError::new(code, FileLocation::File, message);
    let stream = draco_stream::decode(bytes, limits, limits.bytes).map_err(refused)?;
    let n_points = stream.num_points();
    let mut warnings = Warnings::default();
    let mut names = AttributeNames::default();
    let (mut positions, mut attributes): (Option<Vec<[f64; 3]>>, Vec<Attribute>) = (None, Vec::new());
    for id in 0..stream.num_attributes() {
        let attribute = stream.attribute(id);
        let width = usize::from(attribute.num_components());
        let kind = attribute.attribute_type();
        // A second set of positions is kept as numbers of unknown meaning.
        if kind == GeometryAttributeType::Position && width == 3 && positions.is_none() {
            let numbers = numbers(attribute, n_points).map_err(refused)?;
            positions = Some(numbers.as_chunks::<3>().0.to_vec());
            continue;
        }
        // The largest width of an attribute, as in `Attribute::width`.
        if !(1..=16).contains(&width) {
            warnings.count("attributes-skipped", || {
                (FileLocation::File, "attributes of no or more than 16 numbers a point were skipped")
            });
            continue;
        }
        let values = numbers(attribute, n_points).map_err(refused)?;
        attributes.push(Attribute {
            semantic: names.semantic(kind, width),
            domain: Domain::Vertex,
            width,
            values,
        });
    }
    let positions = positions.ok_or_else(|| {
        let message = "the stream has no positions of three numbers";
        ReadError::new("no-positions", FileLocation::File, message)
    })?;
    let bad = positions.iter().position(|point| point.iter().any(|x| !x.is_finite()));
    if let Some(row) = bad.filter(|_| !limits.drop_nonfinite) {
        let message = format!("{:?} is not finite", positions[row]);
        return Err(ReadError::new(
            "not-finite",
            FileLocation::Row { list: "point", row: row as u64 },
            message,
        ));
    }
    let mut faces = with_room(stream.num_faces())?;
    for face in draco_stream::faces(&stream) {
        faces.push(face.map_err(refused)?);
    }
    // Before the mesh is built, so that both are not in memory at once.
    drop(stream);
    let raw = RawMesh { positions, faces, attributes, ..RawMesh::default() };
    let mesh = mesh(raw, limits, &mut warnings)?;
    let frame = Frame { texture_origin: Some(TextureOrigin::LowerLeft), ..Frame::default() };
    let scene = Scene::from_part(Part { mesh, ..Part::default() }, frame);
    Ok(ReadOutcome { content: Content::Scene(scene), warnings: warnings.into_list() })
}

/// The number of attributes of each meaning so far.
#[derive(Default)]
struct AttributeNames {
    n_texcoords: u32,
    n_colors: u32,
    n_others: u32,
    has_normals: bool,
}

impl AttributeNames {
    fn semantic(&mut self, kind: GeometryAttributeType, width: usize) -> Semantic {
        let next = |n: &mut u32| {
            *n += 1;
            *n - 1
        };
        match (kind, width) {
            (GeometryAttributeType::Normal, 3) if !self.has_normals => {
                self.has_normals = true;
                Semantic::Normal
            }
            (GeometryAttributeType::TexCoord, 2) => Semantic::TexCoord(next(&mut self.n_texcoords)),
            (GeometryAttributeType::Color, 3 | 4) => Semantic::Color(next(&mut self.n_colors)),
            _ => Semantic::Custom(format!("attribute_{}", next(&mut self.n_others))),
        }
    }
}

/// The numbers of an attribute by point; normalized integers and colours as fractions of the largest integer.
fn numbers(attribute: &PointAttribute, n_points: usize) -> Result<Vec<f64>, Refusal> {
    let bytes = draco_stream::value_bytes(attribute, n_points)?;
    let is_share = attribute.normalized() || attribute.attribute_type() == GeometryAttributeType::Color;
    let convert = |width: usize, largest: f64, number: &dyn Fn(&[u8]) -> f64| {
        let divisor = if is_share { largest } else { 1.0 };
        bytes.chunks_exact(width).map(|b| number(b) / divisor).collect::<Vec<f64>>()
    };
    Ok(match attribute.data_type() {
        DataType::Int8 => convert(1, f64::from(i8::MAX), &|b| f64::from(b[0] as i8)),
        DataType::Uint8 => convert(1, f64::from(u8::MAX), &|b| f64::from(b[0])),
        DataType::Int16 => convert(2, f64::from(i16::MAX), &|b| f64::from(i16::from_le_bytes([b[0], b[1]]))),
        DataType::Uint16 => convert(2, f64::from(u16::MAX), &|b| f64::from(u16::from_le_bytes([b[0], b[1]]))),
        DataType::Int32 => {
            convert(4, f64::from(i32::MAX), &|b| f64::from(i32::from_le_bytes([b[0], b[1], b[2], b[3]])))
        }
        DataType::Uint32 => {
            convert(4, f64::from(u32::MAX), &|b| f64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])))
        }
        DataType::Float32 => convert(4, 1.0, &|b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))),
        DataType::Float64 => {
            convert(8, 1.0, &|b| f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]]))
        }
        other => return Err(("unsupported", format!("numbers of the type {other:?} are not read"))),
    })
}
