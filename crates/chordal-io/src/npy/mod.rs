//! NumPy's array files, `.npy`: versions 1 to 3, numbers in either byte order and either order of indices.
mod header;
mod read;
mod write;

pub use read::read;
pub use write::write;
pub(crate) use write::write_samples;

/// The first bytes of a file.
pub(crate) const MAGIC: &[u8] = b"\x93NUMPY";
