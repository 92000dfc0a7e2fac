//! The forms of a USD file, recognised by content.
use super::crate_layer::read_crate;
use super::crate_tables::USDC_MAGIC;
use super::files::is_package;
use super::layer::UsdLayer;
use super::parse::{USDA_MAGIC, parse};
use crate::{FileLocation, Limits, ReadError};
use std::borrow::Cow;

/// Reads one file in either form.
///
/// # Errors
/// If it is damaged, or in neither form.
pub(super) fn layer<'a>(
    bytes: Cow<'a, [u8]>,
    path: &str,
    limits: &Limits,
) -> Result<UsdLayer<'a>, ReadError> {
    if bytes.starts_with(USDC_MAGIC) {
        return read_crate(bytes, path, limits);
    }
    if looks_like_text(&bytes) {
        return parse(bytes, path, limits);
    }
    let message = "the content is no USD: it begins neither with '#usda 1.0' nor with PXR-USDC";
    Err(ReadError::new("not-usd", FileLocation::File, message))
}

/// Whether the content is USD's text form.
pub(crate) fn looks_like_text(bytes: &[u8]) -> bool {
    bytes.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(bytes).starts_with(USDA_MAGIC)
}

/// Whether the content is USD's binary form.
pub(crate) fn looks_like_crate(bytes: &[u8]) -> bool {
    bytes.starts_with(USDC_MAGIC)
}

/// Whether the content is a package.
pub(crate) fn looks_like_package(bytes: &[u8]) -> bool {
    is_package(bytes)
}
