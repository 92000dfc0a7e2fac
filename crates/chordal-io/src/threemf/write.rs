//! Writes 3MF.
use super::package::{CONTENT_TYPES, MODEL, MODEL_RELATIONSHIP, ROOT_RELATIONSHIPS};
use super::write_model::ModelWriter;
use crate::zip::writer::ZipWriter;
use crate::{Scene, WriteError};
use serde_json::Value;
use std::io::Write;

/// The content types of the two kinds of parts.
const TYPES: &str = concat!(
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n",
    "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">",
    "<Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>",
    "<Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>",
    "</Types>\n"
);

/// Writes a scene as 3MF. The same scene gives the same bytes.
///
/// Each part with triangles becomes an object; vertices with one `position_id` are one row, and positions are
/// the shortest decimals that read back to the same f64. A node with children, or with its own name, becomes
/// an object of components, and a root becomes an item of the build, so that instances share their triangles.
/// The unit is the scene's, or millimetres if it has none. 3MF is z-up: items of a y-up scene are rotated by
/// the exact map (x, y, z) → (x, −z, y). Colours become bytes, one colour for each corner. Face groups
/// `material` become base materials if each has one colour; if a part has other colours, these are written
/// instead of the materials. Triangles that use a vertex twice are left out. The certificate is a metadata
/// entry. [`crate::losses`] lists the losses.
///
/// Objects are written as models, which printers take for solids; whether they are closed is not checked.
///
/// # Errors
/// [`WriteError::Io`] if the sink fails. [`WriteError::Unsupported`] if 3MF lacks the unit, a part has
/// vertices but no triangle, the nodes are not a forest, a matrix is not affine, or the file would exceed 4
/// GiB.
pub fn write(scene: &Scene, certificate: Option<&Value>, out: &mut dyn Write) -> Result<(), WriteError> {
    let model = ModelWriter::new(scene)?;
    let mut zip = ZipWriter::new(out);
    zip.entry(CONTENT_TYPES, |out| Ok(out.write_all(TYPES.as_bytes())?))?;
    zip.entry(ROOT_RELATIONSHIPS, |out| {
        writeln!(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
        write!(out, "<Relationships xmlns=\"{}\">", super::namespace::RELATIONSHIPS)?;
        write!(out, "<Relationship Id=\"model\" Type=\"{MODEL_RELATIONSHIP}\" Target=\"/{MODEL}\"/>")?;
        Ok(writeln!(out, "</Relationships>")?)
    })?;
    zip.entry(MODEL, |out| model.write(certificate, out))?;
    zip.finish()
}
