//! Binary glTF 2.0.
use crate::{Limits, Loaded, Place, ReadError};

/// The scene of a GLB file.
///
/// # Errors
/// Always, for now: the format is not supported.
pub fn read(_bytes: &[u8], _limits: &Limits) -> Result<Loaded, ReadError> {
    Err(ReadError::new("unsupported", Place::File, "GLB is not supported"))
}
