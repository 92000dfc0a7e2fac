//! DICOM: the slices of a series, each in its own file, as one volume. Uncompressed samples.
//!
//! The crate `dicom-object` 0.10 is not used: it brings 45 others and took 29 seconds of a processor to build
//! in release, without a decoder of pixels, whereas a volume needs sixteen attributes.
//!
//! Source: NEMA, *PS3.5, PS3.3 and PS3.10: Digital Imaging and Communications in Medicine*, 2024.
mod elements;
mod read;
mod run_lengths;
mod series;
mod slice;
mod slice_list;

pub use read::{read, read_with};
pub(crate) use slice_list::looks_like;
pub use slice_list::slice_list;
