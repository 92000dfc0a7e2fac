//! Rules for buffers and their views.
use super::extensions::ExtensionHost;
use super::{GltfLint, IntegerRule, uri};
use crate::glb::container::GltfContainer;
use crate::glb::json::JsonValue;
use crate::glb::model::{GltfBuffer, GltfBufferView, GltfModel, item};
use std::borrow::Cow;

/// The use of a view; a view has only one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BufferViewUse {
    Vertices,
    Indices,
    Image,
    InverseBindMatrices,
    Other,
}

/// The use of an accessor; an accessor has only one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AccessorUse {
    Attribute,
    Indices,
    Input,
    Output,
    InverseBindMatrices,
}

/// A constraint on the values of an accessor, imposed by a use.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum AccessorConstraint {
    UnitVectors,
    UnitVectorsWithSign,
    Clamped,
    /// Below the number of vertices.
    IndicesBelow(u64),
    Times,
    /// Unit quaternions; in cubic splines only every third row.
    Quaternions {
        cubic: bool,
    },
    BindMatrices,
}

/// The uses of views and accessors so far.
pub(super) struct UseTable {
    views: Vec<Option<BufferViewUse>>,
    accessors: Vec<Option<AccessorUse>>,
    /// For a view without stride, the vertex attribute that reads it.
    sole_reader: Vec<Option<usize>>,
    /// Constraints on accessors, each with its pointer.
    pub constraints: Vec<(usize, AccessorConstraint, String)>,
}

impl UseTable {
    pub fn from_model(model: &GltfModel<'_>) -> Self {
        let by_target = |view: &Option<GltfBufferView>| match view.as_ref()?.target? {
            // ARRAY_BUFFER; of the values that pass the rules only ELEMENT_ARRAY_BUFFER is left.
            34962 => Some(BufferViewUse::Vertices),
            _ => Some(BufferViewUse::Indices),
        };
        Self {
            views: model.views.iter().map(by_target).collect(),
            accessors: vec![None; model.accessors.len()],
            sole_reader: vec![None; model.views.len()],
            constraints: Vec::new(),
        }
    }

    /// Adds a constraint on an accessor.
    pub fn constrain(&mut self, accessor: usize, constraint: AccessorConstraint, pointer: String) {
        self.constraints.push((accessor, constraint, pointer));
    }
}

impl<'a> GltfLint<'a> {
    pub(super) fn buffer(&mut self, map: &'a JsonValue) -> GltfBuffer<'a> {
        let byte_length = self
            .integer(map, "byteLength", IntegerRule { min: 1, required: true, ..IntegerRule::default() })
            .value();
        let uri = self.text(map, "uri", false);
        let mut data = None;
        match uri.and_then(uri::data_uri) {
            Some(Ok(parsed))
                if matches!(parsed.mime.as_str(), "application/gltf-buffer" | "application/octet-stream") =>
            {
                data = Some(Cow::Owned(parsed.bytes));
            }
            Some(Ok(parsed)) => {
                self.issue("BUFFER_DATA_URI_MIME_TYPE_INVALID", Some("uri".into()), || {
                    format!("data of type {} make no buffer", parsed.mime)
                });
            }
            Some(Err(what)) => self.issue_below("INVALID_URI", "uri", what),
            None if uri.is_some_and(uri::is_invalid) => {
                self.issue_below("INVALID_URI", "uri", "the URI is invalid")
            }
            None => {}
        }
        self.name(map);
        self.extensions(map, ExtensionHost::Other);
        let is_fallback = self.is_fallback(map);
        // A uri that is not a string still means that the buffer is not the BIN chunk.
        let uri = uri.or_else(|| map.get("uri").map(|_| ""));
        GltfBuffer { byte_length, uri, data, is_fallback }
    }

    /// The first buffer of a GLB file is its BIN chunk, unless it has a URI. In a JSON file such a buffer has
    /// no bytes, which is an error if some are needed.
    pub(super) fn glb_buffer(&mut self, buffer: &mut GltfBuffer<'a>, container: GltfContainer<'a>) {
        if buffer.uri.is_some() || buffer.byte_length.is_none() {
            return;
        }
        match container {
            GltfContainer::Binary(Some(bin)) => buffer.data = Some(Cow::Borrowed(bin)),
            GltfContainer::Binary(None) if !buffer.is_fallback => self.issue_here(
                "BUFFER_MISSING_GLB_DATA",
                "the buffer refers to the BIN chunk, and there is none",
            ),
            GltfContainer::Binary(None) | GltfContainer::Json => {}
        }
    }

    /// Checks that buffers have as many bytes as they declare.
    pub(super) fn check_buffers(&mut self, model: &GltfModel<'_>) {
        for (i, buffer) in model.buffers.iter().enumerate() {
            let Some(GltfBuffer { byte_length: Some(length), data: Some(data), .. }) = buffer else {
                continue;
            };
            // More bytes are no error: a BIN chunk is padded to a multiple of four.
            if (data.len() as u64) < *length {
                self.within("buffers", |lint| {
                    lint.within(i, |lint| {
                        lint.issue("BUFFER_BYTE_LENGTH_MISMATCH", None, || {
                            format!("byteLength is {length}, the data have {} bytes", data.len())
                        });
                    });
                });
            }
        }
    }

    pub(super) fn view(&mut self, map: &'a JsonValue) -> GltfBufferView {
        let length = self
            .integer(map, "byteLength", IntegerRule { min: 1, required: true, ..IntegerRule::default() })
            .value();
        let stride = self
            .integer(map, "byteStride", IntegerRule { min: 4, max: Some(252), ..IntegerRule::default() })
            .value();
        let target = self
            .integer(map, "target", IntegerRule { list: &[34962, 34963], ..IntegerRule::default() })
            .value();
        if let Some(stride) = stride {
            if length.is_some_and(|length| stride > length) {
                self.issue_below(
                    "BUFFER_VIEW_TOO_BIG_BYTE_STRIDE",
                    "byteStride",
                    "byteStride exceeds byteLength",
                );
            }
            if stride % 4 != 0 {
                self.issue_below("VALUE_MULTIPLE_OF", "byteStride", "byteStride is no multiple of 4");
            }
            if target == Some(34963) {
                self.issue_below(
                    "BUFFER_VIEW_INVALID_BYTE_STRIDE",
                    "byteStride",
                    "indices have no byteStride",
                );
            }
        }
        let buffer = self.index(map, "buffer", true);
        let offset = self.integer(map, "byteOffset", IntegerRule::default()).or(0);
        self.name(map);
        self.extensions(map, ExtensionHost::Other);
        let mut view = GltfBufferView { buffer, offset, length, stride, target, packed: None };
        view.packed = self.packed_view(map, &view);
        view
    }

    pub(super) fn link_views(&mut self, model: &GltfModel<'_>) {
        for (i, view) in model.views.iter().enumerate() {
            let Some(GltfBufferView { buffer: Some(index), offset, length, .. }) = view else { continue };
            self.within("bufferViews", |lint| {
                lint.within(i, |lint| {
                    if !lint.resolved("buffers", *index, "buffer".into()) {
                        return;
                    }
                    let Some(total) = item(&model.buffers, Some(*index)).and_then(|b| b.byte_length) else {
                        return;
                    };
                    let Some(offset) = *offset else { return };
                    let key = if offset >= total { "byteOffset" } else { "byteLength" };
                    let end = offset.saturating_add(length.unwrap_or(0));
                    if offset >= total || end > total {
                        lint.issue("BUFFER_VIEW_TOO_LONG", Some(key.into()), || {
                            format!("the view ends at byte {end} of buffer {index}, which has {total}")
                        });
                    }
                });
            });
        }
        self.link_packed_views(model);
    }

    /// Records the use of a view, and reports a view that already has another use.
    pub(super) fn use_view(
        &mut self,
        uses: &mut UseTable,
        view: Option<usize>,
        kind: BufferViewUse,
        below: &'a str,
    ) {
        let Some(slot) = view.and_then(|v| uses.views.get_mut(v)) else { return };
        let first_use = *slot.get_or_insert(kind);
        if first_use != kind {
            self.issue("BUFFER_VIEW_TARGET_OVERRIDE", Some(below.into()), || {
                format!(
                    "bufferView {} is for {first_use:?} and cannot be for {kind:?}",
                    view.unwrap_or_default()
                )
            });
        }
    }

    /// Records the use of an accessor, and reports an accessor that already has another use.
    pub(super) fn use_accessor(
        &mut self,
        uses: &mut UseTable,
        accessor: usize,
        role: AccessorUse,
        below: &'a str,
    ) {
        let Some(slot) = uses.accessors.get_mut(accessor) else { return };
        let first_use = *slot.get_or_insert(role);
        if first_use != role {
            self.issue("ACCESSOR_USAGE_OVERRIDE", Some(below.into()), || {
                format!("accessor {accessor} is for {first_use:?} and cannot be for {role:?}")
            });
        }
    }

    /// Checks that two vertex attributes share a view only if it has a stride.
    pub(super) fn read_vertices(
        &mut self,
        uses: &mut UseTable,
        view: usize,
        accessor: usize,
        below: &'a str,
    ) {
        let Some(slot) = uses.sole_reader.get_mut(view) else { return };
        if *slot.get_or_insert(accessor) != accessor {
            self.issue_below(
                "MESH_PRIMITIVE_ACCESSOR_WITHOUT_BYTESTRIDE",
                below,
                "the view is read twice without byteStride",
            );
        }
    }
}
