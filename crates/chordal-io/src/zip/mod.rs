//! Zip containers, which 3MF packages and `.npz` files are: read within limits, written deterministically.
pub(crate) mod directory;
mod stored;
pub(crate) mod unpack;
pub(crate) mod writer;

pub(crate) use stored::write_stored;
