//! MetaImage volumes: `.mha`, header and samples in one file, and `.mhd`, with the samples in separate files.
//!
//! Source: Kitware, "MetaIO Documentation", docs.itk.org (2001 to 2024); what the text leaves open follows
//! the library MetaIO of ITK.
mod fields;
mod header;
mod orientation;
mod read;
mod sample_files;

pub(crate) use fields::looks_like;
pub use read::{read, read_with};
