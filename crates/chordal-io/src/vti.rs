//! VTK's image data, `.vti`: one of the XML files of [`crate::vtk`], with whose arrays it is decoded.
pub use crate::vtk::image_read::read;
pub(crate) use crate::vtk::looks_any_xml as looks_like;
