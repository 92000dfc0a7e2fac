//! Geomview's Bézier surfaces, `.bez` and `.bbp`: patches of any degree, polynomial or rational.
mod keyword;
mod net;
mod numbers;
mod read;

pub(crate) use keyword::looks_like;
pub use read::read;
