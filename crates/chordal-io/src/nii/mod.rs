//! NIfTI volumes, `.nii` and `.nii.gz`: versions 1 and 2, either byte order.
//!
//! The crate `nifti` is not used: it opens paths, allocates what a header declares before the data are there,
//! and gives no location with its errors. A header is some twenty fields at fixed offsets.
mod header;
mod label_table;
mod orientation;
mod read;

pub use read::read;
pub(crate) use read::{chosen_volume, looks_like, read_with};
