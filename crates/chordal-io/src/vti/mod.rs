//! VTK's image data in XML, `.vti`: samples as text, as base64 or appended raw, packed by zlib or not.
//!
//! Source: Kitware, *VTK File Formats*, "XML File Formats", docs.vtk.org (2003 to 2024).
mod blocks;
mod document;
mod orientation;
mod pieces;
mod read;

pub(crate) use document::looks_like;
pub use read::read;
