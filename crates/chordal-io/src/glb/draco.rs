//! Unpacks the primitives that are compressed by `KHR_draco_mesh_compression`.
//!
//! This module implements glTF's side: which attribute of a stream belongs to which accessor.
//!
//! Source: F. Emelianenko and others, *KHR_draco_mesh_compression*, Khronos Group, 2018.
use super::format::ComponentType;
use super::lint::GltfLint;
use super::model::{GltfAccessor, GltfModel, GltfPrimitive, item};
use crate::draco_stream::{self, BROKEN_STREAM, Refusal};
use crate::{FileLocation, Limits, ReadError};
use chordal::math::{greater, lesser};
use draco_core::draco_types::DataType;
use std::collections::BTreeMap;

/// The name of the extension.
pub(super) const DRACO: &str = "KHR_draco_mesh_compression";

/// The accessors filled from streams, each with the stream's view and the attribute in it.
type FilledAccessors = BTreeMap<usize, (usize, Option<u32>)>;

/// Whether the file also holds the primitive's data uncompressed.
pub(super) fn has_plain_copy(model: &GltfModel<'_>, primitive: &GltfPrimitive<'_>) -> bool {
    let is_plain = |accessor| {
        let object = item(&model.accessors, Some(accessor));
        object.is_none_or(|rows| rows.view.is_some() || rows.sparse.is_some())
    };
    primitive.stream_accessors().iter().all(|(accessor, _)| is_plain(*accessor))
}

/// Fills in the rows of accessors that exist only in compressed streams. At most `left` bytes are unpacked;
/// returns how many may still be decoded. A broken stream is an issue, and its accessors stay without rows.
///
/// # Errors
/// At the extension of a primitive, if the limits are exceeded.
pub(super) fn unpack(
    model: &mut GltfModel<'_>,
    lint: &mut GltfLint<'_>,
    limits: &Limits,
    mut left: u64,
) -> Result<u64, ReadError> {
    let mut filled = FilledAccessors::new();
    for m in 0..model.meshes.len() {
        for p in 0..item(&model.meshes, Some(m)).map_or(0, |mesh| mesh.primitives.len()) {
            let Some(mesh) = item(&model.meshes, Some(m)) else { continue };
            let primitive = &mesh.primitives[p];
            let Some(stream) = &primitive.draco else { continue };
            let Some(view) = stream.view.filter(|_| !has_plain_copy(model, primitive)) else { continue };
            let accessors = primitive.stream_accessors();
            // Primitives may share a stream: the second one needs nothing if all its rows are known
            // from the same stream.
            let is_filled = |(accessor, id): &(usize, _)| filled.get(accessor) == Some(&(view, *id));
            if accessors.iter().all(is_filled) {
                continue;
            }
            let pointer = || format!("/meshes/{m}/primitives/{p}/extensions/{DRACO}");
            match decode(model, primitive, view, &accessors, &filled, limits, left) {
                Ok(rows) => {
                    left -= lesser_of(left, rows.iter().map(|rows| rows.bytes.len() as u64).sum());
                    for rows in rows {
                        filled.insert(rows.accessor, (view, rows.id));
                        if let Some(Some(accessor)) = model.accessors.get_mut(rows.accessor) {
                            rows.fill(accessor);
                        }
                    }
                }
                // A limit ends the reading; a broken stream concerns only the primitives that need
                // it, and the linter's issues are judged later, all together.
                Err((code @ ("too-large" | "unsupported-extension"), what)) => {
                    return Err(ReadError::new(code, FileLocation::Pointer(pointer()), what));
                }
                Err((code, what)) => lint.issue_at(code, &pointer(), || what),
            }
        }
    }
    Ok(left)
}

fn lesser_of(a: u64, b: u64) -> u64 {
    if a < b { a } else { b }
}

/// The rows of an accessor from a stream, tightly packed.
struct DracoRows {
    accessor: usize,
    id: Option<u32>,
    component: ComponentType,
    count: u64,
    bytes: Vec<u8>,
}

impl DracoRows {
    /// Gives an accessor its rows, and bounds computed from these rows: the compression rounds values after
    /// the file's bounds were taken.
    fn fill(self, accessor: &mut GltfAccessor) {
        accessor.component = Some(self.component);
        accessor.count = Some(self.count);
        accessor.offset = Some(0);
        let n = accessor.kind.map_or(1, super::format::AccessorType::n_components);
        if accessor.min.is_some() && accessor.max.is_some() {
            let mut bounds = vec![(f64::INFINITY, f64::NEG_INFINITY); n];
            for (i, bytes) in self.bytes.chunks_exact(self.component.size() as usize).enumerate() {
                let (x, bound) = (self.component.read(bytes), &mut bounds[i % n]);
                *bound = (lesser(bound.0, x), greater(bound.1, x));
            }
            accessor.min = Some(bounds.iter().map(|bound| bound.0).collect());
            accessor.max = Some(bounds.iter().map(|bound| bound.1).collect());
        }
        accessor.unpacked = Some(self.bytes);
    }
}

/// Decodes the stream of a primitive into the rows of the requested accessors.
fn decode(
    model: &GltfModel<'_>,
    primitive: &GltfPrimitive<'_>,
    view: usize,
    wanted: &[(usize, Option<u32>)],
    filled: &FilledAccessors,
    limits: &Limits,
    left: u64,
) -> Result<Vec<DracoRows>, Refusal> {
    let broken = |what: String| (BROKEN_STREAM, what);
    if primitive.mode != Some(4) {
        let what = "only primitives of triangles are read from a stream of Draco, not strips or fans";
        return Err(("unsupported-extension", what.to_owned()));
    }
    let Some(stream) = model.view_bytes(Some(view)) else {
        return Err(broken(format!("bufferView {view} has no bytes")));
    };
    let other =
        wanted.iter().find(|(accessor, id)| filled.get(accessor).is_some_and(|known| *known != (view, *id)));
    if let Some((accessor, _)) = other {
        return Err(broken(format!("accessor {accessor} has its rows from another stream")));
    }
    let mesh = draco_stream::decode(stream, limits, left)?;
    let n_points = mesh.num_points();
    // Counted from the header of the decoded mesh, before the rows are copied out of it.
    let row_bytes = |accessor: &GltfAccessor| accessor.format().map_or(0, |format| format.row_length());
    let objects = wanted.iter().filter_map(|(accessor, _)| item(&model.accessors, Some(*accessor)));
    let n_bytes = objects.map(row_bytes).fold(0, u64::saturating_add).saturating_mul(n_points as u64);
    if n_bytes.saturating_add(12 * mesh.num_faces() as u64) > left {
        return Err(("too-large", format!("{n_bytes} bytes of vertices exceed the limits, {left} are left")));
    }
    let mut rows = Vec::with_capacity(wanted.len());
    for (accessor, id) in wanted.iter().filter(|(accessor, _)| !filled.contains_key(accessor)) {
        let Some(object) = item(&model.accessors, Some(*accessor)) else { continue };
        let (component, count, bytes) = match id {
            None => (ComponentType::U32, 3 * mesh.num_faces() as u64, index_bytes(&mesh)?),
            Some(unique) => {
                let attribute = mesh.attribute_by_unique_id(*unique);
                let attribute =
                    attribute.ok_or_else(|| broken(format!("the stream has no attribute {unique}")))?;
                let n = object.kind.map_or(0, super::format::AccessorType::n_components);
                if usize::from(attribute.num_components()) != n || object.kind.is_some_and(|k| k.is_matrix())
                {
                    let has = attribute.num_components();
                    return Err(broken(format!("attribute {unique} has {has} numbers, its accessor {n}")));
                }
                let component = component_of(attribute.data_type());
                let component = component.filter(|own| object.component == Some(*own)).ok_or_else(|| {
                    let kind = attribute.data_type();
                    broken(format!("attribute {unique} is of {kind:?}, which its accessor is not"))
                })?;
                (component, n_points as u64, draco_stream::value_bytes(attribute, n_points)?)
            }
        };
        rows.push(DracoRows { accessor: *accessor, id: *id, component, count, bytes });
    }
    Ok(rows)
}

/// The corners of the triangles, four bytes each.
fn index_bytes(mesh: &draco_core::Mesh) -> Result<Vec<u8>, Refusal> {
    let mut bytes = Vec::with_capacity(12 * mesh.num_faces());
    for face in draco_stream::faces(mesh) {
        face?.iter().for_each(|corner| bytes.extend_from_slice(&corner.to_le_bytes()));
    }
    Ok(bytes)
}

fn component_of(kind: DataType) -> Option<ComponentType> {
    Some(match kind {
        DataType::Int8 => ComponentType::I8,
        DataType::Uint8 => ComponentType::U8,
        DataType::Int16 => ComponentType::I16,
        DataType::Uint16 => ComponentType::U16,
        DataType::Uint32 => ComponentType::U32,
        DataType::Float32 => ComponentType::F32,
        _ => return None,
    })
}
