//! NumPy's array files, `.npy` and, packed together, `.npz`: versions 1 to 3, numbers in either byte order,
//! indices in either order.
mod header;
mod npz;
mod read;
mod write;

pub(crate) use npz::looks_like_npz;
pub use npz::read_npz;
pub use read::read;
pub use write::{write, write_sparse};
pub(crate) use write::{write_bricks, write_samples};

/// The first bytes of a file.
pub(crate) const MAGIC: &[u8] = b"\x93NUMPY";
