//! Opens the buffers and pictures of a glTF that are in other files.
use super::lint::GltfLint;
use super::model::GltfModel;
use super::report::GlbWarnings;
use crate::files::{self, FileOpener};
use crate::{FileLocation, Limits, ReadError};
use std::borrow::Cow;

/// Fills in the bytes of buffers and pictures that are in other files.
///
/// # Errors
/// If a buffer is not available, or the files together exceed the limit. A missing picture is a warning.
pub(super) fn open_files(
    model: &mut GltfModel<'_>,
    lint: &mut GltfLint<'_>,
    open: &mut FileOpener<'_>,
    limits: &Limits,
    report: &mut GlbWarnings,
) -> Result<(), ReadError> {
    // One allowance for all files: many small ones may not exceed it together.
    let mut left = limits.bytes;
    let mut fetch = |uri: &str, pointer: &str| -> Result<Vec<u8>, ReadError> {
        let refused = |code, what: String| {
            ReadError::new(
                code,
                FileLocation::Pointer(pointer.to_owned()),
                format!("{:?} {what}", escaped(uri)),
            )
        };
        let path =
            files::resolve("", uri).map_err(|error| refused(error.code(), error.reason().to_owned()))?;
        let bytes = open(&path).map_err(|why| refused("missing-file", format!("cannot be read: {why}")))?;
        left = left.checked_sub(bytes.len() as u64).ok_or_else(|| {
            refused("too-large", format!("makes the files larger than the limit of {} bytes", limits.bytes))
        })?;
        // The linter's own allowance followed from the size of the glTF, before these bytes were
        // known.
        lint.allow(bytes.len() as u64);
        Ok(bytes)
    };
    for (i, buffer) in model.buffers.iter_mut().enumerate() {
        let Some(buffer) = buffer else { continue };
        // Compressed views fill a fallback buffer.
        if let Some(uri) = external(buffer.uri).filter(|_| buffer.data.is_none() && !buffer.is_fallback) {
            buffer.data = Some(Cow::Owned(fetch(uri, &format!("/buffers/{i}/uri"))?));
        }
    }
    for (i, image) in model.images.iter_mut().enumerate() {
        let Some(image) = image else { continue };
        let Some(uri) = external(image.uri).filter(|_| image.data.is_none()) else { continue };
        match fetch(uri, &format!("/images/{i}/uri")) {
            Ok(bytes) => image.data = Some(bytes),
            Err(error) if error.code == "too-large" => return Err(error),
            Err(ReadError { place, message, .. }) => report.add("picture-missing", place, message),
        }
    }
    Ok(())
}

/// A URI that refers to another file.
fn external(uri: Option<&str>) -> Option<&str> {
    uri.filter(|uri| {
        !uri.is_empty() && !uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:"))
    })
}

fn escaped(uri: &str) -> String {
    // Chosen: enough to identify the file; a URI can be as long as the file.
    const SHOWN: usize = 200;
    uri.chars().take(SHOWN).collect()
}
