//! VTK ImageData, `.vti`: one of the XML formats of [`crate::vtk`], which decodes its arrays.
pub use crate::vtk::image_read::read;
pub(crate) use crate::vtk::looks_any_xml as looks_like;
