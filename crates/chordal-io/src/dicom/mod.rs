//! DICOM: the slices of a series, each in its own file or all in one, and the masks of a segmentation, as one
//! volume.
//!
//! Elements and frames are read here, with the limits of all readers; packed pixels are unpacked by other
//! libraries. `docs/formats.md` says why.
//!
//! Source: NEMA, *PS3.5, PS3.3 and PS3.10: Digital Imaging and Communications in Medicine*, 2024.
mod attributes;
mod codestream_headers;
mod elements;
mod file;
mod frame_facts;
mod masks;
mod packed_pixels;
mod pixel_pieces;
mod read;
mod run_lengths;
mod segment_table;
mod series;
mod slice;
mod slice_list;
mod transfer_syntax;

pub use read::{read, read_with};
pub(crate) use slice_list::looks_like;
pub use slice_list::slice_list;
