//! Draco streams, as files of their own and as glTF primitives: decoded within limits.
//!
//! They are decoded by `draco-core`, a port of Google's library to safe Rust. A few bytes of a stream can
//! declare a very large mesh, so the decoder gets limits.
use crate::Limits;
use draco_core::geometry_attribute::PointAttribute;
use draco_core::geometry_indices::{FaceIndex, PointIndex};
use draco_core::{DecodeLimits, DecoderBuffer, ErrorKind, Mesh, MeshDecoder};

/// The error code of a stream that cannot be decoded, or that contradicts its file.
pub(crate) const BROKEN_STREAM: &str = "draco-stream";

/// Room for the decoder's tables. Derived: up to a dozen arrays of four bytes over the three corners of a
/// triangle and the seams of its attributes.
const BYTES_PER_FACE: u64 = 200;

/// Why a stream is refused: a code, and a sentence.
pub(crate) type Refusal = (&'static str, String);

/// The mesh of a stream. It may take at most `left` bytes.
///
/// # Errors
/// `too-large`, `unsupported-extension` for features that the decoder does not support, else
/// [`BROKEN_STREAM`].
pub(crate) fn decode(stream: &[u8], limits: &Limits, left: u64) -> Result<Mesh, Refusal> {
    let most_faces = left / BYTES_PER_FACE;
    let ceilings = DecodeLimits::default()
        .with_max_points(limits.rows)
        .with_max_faces(if limits.rows < most_faces { limits.rows } else { most_faces })
        .with_max_decoded_bytes(left);
    let mut mesh = Mesh::new();
    let mut buffer = DecoderBuffer::new(stream).with_limits(ceilings);
    MeshDecoder::new().decode(&mut buffer, &mut mesh).map_err(|error| {
        let code = match error.kind() {
            ErrorKind::LimitExceeded => "too-large",
            ErrorKind::UnsupportedFeature
            | ErrorKind::UnsupportedVersion
            | ErrorKind::BitstreamVersionUnsupported => "unsupported-extension",
            _ => BROKEN_STREAM,
        };
        (code, format!("the stream of Draco cannot be decoded: {}", error.message()))
    })?;
    if mesh.num_points() == 0 || mesh.num_faces() == 0 {
        return Err((BROKEN_STREAM, "the stream holds no triangles".to_owned()));
    }
    Ok(mesh)
}

/// The corners of each triangle, as indices of points of the mesh.
///
/// # Errors
/// If a corner is not a point of the mesh.
pub(crate) fn faces(mesh: &Mesh) -> impl Iterator<Item = Result<[u32; 3], Refusal>> {
    (0..mesh.num_faces()).map(|i| {
        let corners = mesh.face(FaceIndex(i as u32)).map(|corner| corner.0);
        if corners.iter().any(|corner| *corner as usize >= mesh.num_points()) {
            return Err((BROKEN_STREAM, format!("triangle {i} has a corner that is no point")));
        }
        Ok(corners)
    })
}

/// The values of an attribute by point, tightly packed.
///
/// # Errors
/// If a point has no value.
pub(crate) fn value_bytes(attribute: &PointAttribute, n_points: usize) -> Result<Vec<u8>, Refusal> {
    let n_row = attribute.data_type().byte_length() * usize::from(attribute.num_components());
    let stride = usize::try_from(attribute.byte_stride()).unwrap_or(0);
    let data = attribute.buffer().data();
    let mut bytes = Vec::with_capacity(n_row * n_points);
    for i in 0..n_points {
        let value = attribute.mapped_index(PointIndex(i as u32)).0 as usize;
        let start = value.checked_mul(stride).filter(|_| value < attribute.size());
        let row = start.and_then(|start| data.get(start..start.checked_add(n_row)?));
        let row = row.ok_or_else(|| {
            (BROKEN_STREAM, format!("attribute {} has no value for point {i}", attribute.unique_id()))
        })?;
        bytes.extend_from_slice(row);
    }
    Ok(bytes)
}
