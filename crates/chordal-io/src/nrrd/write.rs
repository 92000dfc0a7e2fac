//! Writes `.nrrd`.
use super::CERTIFICATE;
use crate::certificate::most_in_a_line;
use crate::npy::{write_bricks, write_samples};
use crate::number::ShortestDecimal;
use crate::volume::label_table::LabelLook;
use crate::{Frame, Volume, WriteError};
use chordal::implicit::{Affine3, Samples, SparseGrid};
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::Write;

/// Writes a volume with its directions, origin, unit, labels and certificate: raw, little-endian. Every
/// number reads back to the same bits.
///
/// # Errors
/// If the sink fails.
///
/// ```
/// use chordal::implicit::{Affine3, Grid, Samples};
/// use chordal_io::{Content, Limits, Volume, nrrd};
/// let affine = Affine3::new([[0.1, 0.5, 0.0, 7.0], [0.0, -0.3, 0.0, 8.0], [0.0, 0.0, 2.0, 9.0]])?;
/// let grid = Grid::new([2, 2, 2], Samples::F32((0_u8..8).map(f32::from).collect()), affine)?;
/// let (volume, mut file) = (Volume::from_grid(grid), Vec::new());
/// nrrd::write(&volume, None, &mut file)?;
/// let Content::Volume(back) = nrrd::read(&file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(back.grid, volume.grid);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write(volume: &Volume, certificate: Option<&Value>, out: &mut dyn Write) -> Result<(), WriteError> {
    let types = match volume.grid.samples() {
        Samples::U8(_) => "uint8",
        Samples::I8(_) => "int8",
        Samples::U16(_) => "uint16",
        Samples::I16(_) => "int16",
        Samples::U32(_) => "uint32",
        Samples::I32(_) => "int32",
        Samples::F32(_) => "float",
        Samples::F64(_) => "double",
        _ => return Err(WriteError::Unsupported("nrrd holds no samples of that type".to_owned())),
    };
    let header = HeaderText {
        types,
        encoding: "raw",
        size: volume.grid.size(),
        affine: volume.grid.affine(),
        frame: &volume.frame,
        name: &volume.name,
        space: volume.space.as_deref(),
        certificate,
        labels: &volume.labels,
    };
    header.write(out)?;
    write_samples(volume.grid.samples(), out)
}

/// Writes samples in bricks, row by row and packed by gzip, so that memory holds no more of them than the
/// grid does, and empty bricks take next to nothing in the file. The file reads back as the dense samples,
/// bit for bit.
///
/// # Errors
/// If the sink fails.
///
/// ```
/// use chordal::implicit::{Affine3, Grid, Samples, SparseGrid};
/// use chordal_io::{Content, Frame, Limits, nrrd};
/// let values = (0..32 * 32 * 64).map(|n| ((n / 1024) as f64 - 20.5).clamp(-1.0, 1.0)).collect();
/// let dense = Grid::new([32, 32, 64], Samples::F64(values), Affine3::IDENTITY)?;
/// let mut file = Vec::new();
/// nrrd::write_sparse(&SparseGrid::from_grid(&dense, 1.0), &Frame::default(), None, &mut file)?;
/// let Content::Volume(back) = nrrd::read(&file, &Limits::default())?.content else { unreachable!() };
/// assert!(back.grid == dense && file.len() < 32 * 32 * 64);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_sparse(
    grid: &SparseGrid,
    frame: &Frame,
    certificate: Option<&Value>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let header = HeaderText {
        types: "double",
        encoding: "gzip",
        size: grid.size(),
        affine: grid.affine(),
        frame,
        name: "",
        space: None,
        certificate,
        labels: &BTreeMap::new(),
    };
    header.write(out)?;
    // Chosen: the fastest level; empty bricks compress well at any level, and digits of distances at none.
    let mut packed = GzEncoder::new(out, Compression::fast());
    write_bricks(grid, &mut packed)?;
    packed.finish()?;
    Ok(())
}

/// The text before the samples.
struct HeaderText<'a> {
    types: &'a str,
    encoding: &'a str,
    size: [usize; 3],
    affine: &'a Affine3,
    frame: &'a Frame,
    name: &'a str,
    space: Option<&'a str>,
    certificate: Option<&'a Value>,
    labels: &'a BTreeMap<i64, LabelLook>,
}

impl HeaderText<'_> {
    fn write(&self, out: &mut dyn Write) -> Result<(), WriteError> {
        let [x, y, z] = self.size;
        let vector = |v: [f64; 3]| {
            format!("({},{},{})", ShortestDecimal(v[0]), ShortestDecimal(v[1]), ShortestDecimal(v[2]))
        };
        let [a, b, c] = self.affine.steps().map(vector);
        let rows = self.affine.rows();
        writeln!(out, "NRRD0004")?;
        if !self.name.is_empty() {
            writeln!(out, "content: {}", crate::volume::name_of(self.name.as_bytes()))?;
        }
        writeln!(out, "type: {}\ndimension: 3", self.types)?;
        match self.space {
            Some(space) => writeln!(out, "space: {}", full_name(space))?,
            None => writeln!(out, "space dimension: 3")?,
        }
        writeln!(out, "sizes: {x} {y} {z}\nspace directions: {a} {b} {c}\nkinds: domain domain domain")?;
        writeln!(out, "endian: little\nencoding: {}", self.encoding)?;
        writeln!(out, "space origin: {}", vector(rows.map(|row| row[3])))?;
        if let Some(unit) = self.frame.metres_per_unit.and_then(unit) {
            writeln!(out, "space units: \"{unit}\" \"{unit}\" \"{unit}\"")?;
        }
        if let Some(certificate) = self.certificate {
            writeln!(out, "{CERTIFICATE}:={}", certificate_value(certificate)?)?;
        }
        for (at, (label, look)) in self.labels.iter().enumerate() {
            writeln!(out, "Segment{at}_LabelValue:={label}")?;
            if !look.name.is_empty() {
                writeln!(out, "Segment{at}_Name:={}", escaped(&look.name))?;
            }
            if let Some([r, g, b]) = look.color.map(|color| color.map(ShortestDecimal)) {
                writeln!(out, "Segment{at}_Color:={r} {g} {b}")?;
            }
        }
        writeln!(out)?;
        Ok(())
    }
}

/// The value of the certificate's key.
///
/// # Errors
/// [`WriteError::Unsupported`] if the line is longer than readers accept.
fn certificate_value(certificate: &Value) -> Result<String, WriteError> {
    let value = escaped(&certificate.to_string());
    if value.len() > most_in_a_line() {
        let message = format!(
            "a certificate of {} bytes does not fit into a line of {}",
            value.len(),
            most_in_a_line()
        );
        return Err(WriteError::Unsupported(message));
    }
    Ok(value)
}

/// The escaped value of a key: a line feed would end it.
fn escaped(value: &str) -> String {
    value.replace('\\', "\\\\").replace('\n', "\\n")
}

fn full_name(space: &str) -> &str {
    match space {
        "RAS" => "right-anterior-superior",
        "LAS" => "left-anterior-superior",
        "LPS" => "left-posterior-superior",
        other => other,
    }
}

/// Whether there is a name for the unit of so many metres.
pub(crate) fn names_unit(metres: f64) -> bool {
    unit(metres).is_some()
}

fn unit(metres: f64) -> Option<&'static str> {
    [(1.0, "m"), (0.01, "cm"), (0.001, "mm"), (1e-6, "um")] // A micrometre, exact to the last place.
        .into_iter()
        .find(|(known, _)| *known == metres)
        .map(|(_, name)| name)
}
