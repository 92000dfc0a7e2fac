//! Where a shape comes from: digests of bytes and geometry, seals, and the histories of inputs.
pub(crate) mod compose;
pub(crate) mod composed;
pub(crate) mod digest;
pub(crate) mod field_digest;
pub(crate) mod geometry_digest;
pub(crate) mod origin;
pub(crate) mod seal;
