//! `VtpLayout`: the elements of a PolyData file to be written, and its appended bytes.
use super::names::CERTIFICATE;
use crate::WriteError;
use crate::xml_text::escaped;
use std::io::Write;

/// The bytes of the length before each array: `UInt64`.
const LENGTH_BYTES: u64 = 8;

/// The section of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum VtpSection {
    PointData,
    CellData,
    Points,
    Polys,
}

/// An array to be written.
#[derive(Clone, Debug)]
pub(super) struct VtpArray {
    pub section: VtpSection,
    pub name: String,
    /// The name of its type, as in "Float64".
    pub kind: &'static str,
    pub width: usize,
    pub n_bytes: u64,
}

/// The head of a file.
#[derive(Clone, Debug)]
pub(super) struct VtpLayout {
    pub n_points: u64,
    pub n_polys: u64,
    pub arrays: Vec<VtpArray>,
    /// The arrays of points that are normals, texture coordinates and colours, as attributes of an element.
    pub active: String,
    pub certificate: Option<String>,
}

/// The type for a list of indices below `limit` and of offsets up to it.
pub(super) fn index_type(limit: u64) -> &'static str {
    if limit <= i32::MAX as u64 { "Int32" } else { "Int64" }
}

/// Appends an index in the type with this name.
pub(super) fn put_index(row: &mut Vec<u8>, kind: &str, index: u64) {
    if kind == "Int32" {
        row.extend((index as i32).to_le_bytes());
    } else {
        row.extend(index.to_le_bytes());
    }
}

impl VtpLayout {
    /// Writes everything up to the appended bytes, and the certificate as the first of them.
    pub(super) fn write_head(&self, out: &mut impl Write) -> Result<(), WriteError> {
        writeln!(out, "<?xml version=\"1.0\"?>")?;
        // Lengths of 64 bits need version 1.0.
        writeln!(
            out,
            "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">"
        )?;
        writeln!(out, "<PolyData>")?;
        let mut offset = 0;
        if let Some(certificate) = &self.certificate {
            writeln!(
                out,
                "<FieldData><Array type=\"String\" Name=\"{CERTIFICATE}\" NumberOfTuples=\"1\" format=\"appended\" \
                 offset=\"0\"/></FieldData>"
            )?;
            // A byte of 0 ends the string.
            offset = LENGTH_BYTES + certificate.len() as u64 + 1;
        }
        writeln!(
            out,
            "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" \
             NumberOfPolys=\"{}\">",
            self.n_points, self.n_polys
        )?;
        let sections = [
            (VtpSection::PointData, "PointData", &*self.active),
            (VtpSection::CellData, "CellData", ""),
            (VtpSection::Points, "Points", ""),
            (VtpSection::Polys, "Polys", ""),
        ];
        for (section, element, active) in sections {
            writeln!(out, "<{element}{active}>")?;
            for array in self.arrays.iter().filter(|array| array.section == section) {
                writeln!(
                    out,
                    "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" \
                     offset=\"{offset}\"/>",
                    array.kind,
                    escaped(&array.name),
                    array.width
                )?;
                offset += LENGTH_BYTES + array.n_bytes;
            }
            writeln!(out, "</{element}>")?;
        }
        // Offsets count from the byte after the underscore.
        write!(out, "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_")?;
        if let Some(certificate) = &self.certificate {
            out.write_all(&(certificate.len() as u64 + 1).to_le_bytes())?;
            out.write_all(certificate.as_bytes())?;
            out.write_all(&[0])?;
        }
        Ok(())
    }

    /// Writes the end of a file.
    pub(super) fn write_end(out: &mut impl Write) -> Result<(), WriteError> {
        write!(out, "\n</AppendedData>\n</VTKFile>\n")?;
        out.flush()?;
        Ok(())
    }
}
