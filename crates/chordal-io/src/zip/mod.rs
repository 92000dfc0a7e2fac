//! Zip containers of 3MF packages and `.npz` files: read within limits, written deterministically.
pub(crate) mod directory;
mod stored;
pub(crate) mod unpack;
pub(crate) mod writer;

pub(crate) use stored::write_stored;
