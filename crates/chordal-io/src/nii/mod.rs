//! NIfTI volumes, `.nii` and `.nii.gz`: versions 1 and 2, either byte order.
//!
//! Own code instead of the crate `nifti`: that one opens paths, allocates what a header declares before it is
//! there, and gives its errors without a place. A header is some twenty fields at fixed offsets.
mod header;
mod orientation;
mod read;

pub use read::read;
pub(crate) use read::{looks_like, which};
