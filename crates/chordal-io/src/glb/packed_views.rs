//! Unpacks the views compressed by `EXT_meshopt_compression` or its successor.
use super::lint::GltfLint;
use super::meshopt::{self, BROKEN_STREAM};
use super::model::{GltfModel, GltfPackedView, item};
use crate::{FileLocation, ReadError};

/// Fills in the bytes of compressed views whose streams are available. At most `left` bytes are unpacked;
/// returns how many may still be decoded. A broken stream is an issue, and its view stays without bytes.
///
/// # Errors
/// At the extension of a view, if the limit or the memory is exceeded.
pub(super) fn unpack(
    model: &mut GltfModel<'_>,
    lint: &mut GltfLint<'_>,
    mut left: u64,
) -> Result<u64, ReadError> {
    for i in 0..model.views.len() {
        let packed = model.views[i].as_ref().and_then(|view| view.packed.as_deref());
        let Some(GltfPackedView { extension, layout: Some(layout), .. }) = packed else { continue };
        let pointer = format!("/bufferViews/{i}/extensions/{extension}");
        // A range that exceeds its buffer is a separate issue.
        let n_buffer = item(&model.buffers, Some(layout.buffer)).and_then(|buffer| buffer.byte_length);
        let is_inside = n_buffer.is_some_and(|n| layout.offset.saturating_add(layout.length) <= n);
        let stream = model.buffer_bytes(layout.buffer, layout.offset, layout.length);
        let Some(stream) = stream.filter(|_| is_inside) else { continue };
        let refused = |code, what| ReadError::new(code, FileLocation::Pointer(pointer.clone()), what);
        let n_bytes = layout.n_bytes();
        // Charged by what the view claims, before memory is reserved: a few bytes may claim
        // gigabytes.
        left = left.checked_sub(n_bytes).ok_or_else(|| {
            let what = format!("the unpacked data exceeds the limits: {n_bytes} bytes more, {left} are left");
            refused("too-large", what)
        })?;
        let mut bytes = Vec::new();
        let reserved = usize::try_from(n_bytes).ok().filter(|n| bytes.try_reserve_exact(*n).is_ok());
        let Some(reserved) = reserved else {
            let what = format!("{n_bytes} bytes take more memory than there is");
            return Err(refused("out-of-memory", what));
        };
        bytes.resize(reserved, 0);
        match meshopt::decode(layout, stream, &mut bytes) {
            Ok(()) => {
                if let Some(packed) = model.views[i].as_mut().and_then(|view| view.packed.as_mut()) {
                    packed.bytes = Some(bytes);
                }
            }
            Err(what) => lint.issue_at(BROKEN_STREAM, &pointer, || what),
        }
    }
    Ok(left)
}
