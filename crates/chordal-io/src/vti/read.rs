//! Reads `.vti`.
use super::blocks::ArrayDecoder;
use super::document::VtiDocument;
use super::orientation::{VtiExtent, affine};
use super::pieces::{ArrayChoice, SampleSite, name_of};
use crate::text::show;
use crate::volume::count::{along, size_of};
use crate::volume::element::Endian;
use crate::volume::samples::{self, SampleLayout};
use crate::volume::stream::SampleStream;
use crate::warnings::Warnings;
use crate::{Content, Frame, Limits, ReadError, ReadOutcome, Volume};
use chordal::implicit::Grid;

/// Reads the volume of image data of VTK: the scalars of its points, else the only array of one number a point;
/// [`Limits::index`] chooses another. Extent, origin, spacing and direction place the samples. Without arrays
/// at points those of cells are read, at the centres of the cells, with a warning.
///
/// Samples are text, base64 or appended, plain or packed by zlib, in one piece or several.
///
/// # Errors
/// [`ReadError`] at the line and column of the element, or at the byte of the samples; also for other types of
/// data than images, other packing than zlib, and arrays of colours or vectors.
///
/// ```
/// use chordal_io::{Content, Limits, vti};
/// let file = br#"<VTKFile type="ImageData" byte_order="LittleEndian">
///   <ImageData WholeExtent="0 1 0 1 0 1" Origin="5 0 0" Spacing="2 1 1"><Piece Extent="0 1 0 1 0 1">
///   <PointData><DataArray type="UInt8" Name="a" format="ascii">0 1 2 3 4 5 6 7</DataArray></PointData>
///   </Piece></ImageData></VTKFile>"#;
/// let Content::Volume(volume) = vti::read(file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(volume.grid.sample([1, 0, 1]), 5.0);
/// assert_eq!(volume.grid.affine().at([1.0, 0.0, 1.0]), [7.0, 0.0, 1.0]);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let mut warnings = Warnings::default();
    let document = VtiDocument::read(bytes, limits)?;
    let decoder = decoder(bytes, &document)?;
    let choice = ArrayChoice::new(&document, limits, &mut warnings)?;
    let points = VtiExtent::read(&document, &document.image, "WholeExtent")?;
    let whole = if choice.site == SampleSite::Cells { points.cells() } else { points };
    let place = document.place(&document.image);
    for (axis, n) in whole.size.into_iter().enumerate() {
        along(axis, n, &place)?;
    }
    let size = size_of(whole.size, choice.element, &place, limits)?;
    // A cell's centre is half a step after its lowest point.
    let half = if choice.site == SampleSite::Cells { 0.5 } else { 0.0 };
    let affine = affine(&document, whole.low.map(|low| low as f64 + half))?;
    let body = choice.bytes(&decoder, whole)?;
    let is_text = choice.array.element.get("format").unwrap_or("ascii") == "ascii";
    let endian = if is_text { Endian::Little } else { decoder.endian };
    let layout = SampleLayout::volumes(choice.element, endian, size);
    let samples = samples::read(&mut SampleStream::plain(&body, 0), &layout, limits, &mut warnings)?;
    drop(body);
    samples::count_not_finite(&samples, &mut warnings);
    let grid = Grid::new(size, samples, affine)
        .map_err(|error| ReadError::new("bad-size", place, error.to_string()))?;
    let name = crate::volume::name_of(name_of(choice.array).as_bytes());
    let volume = Volume { frame: Frame::default(), name, ..Volume::from_grid(grid) };
    Ok(ReadOutcome { content: Content::Volume(volume), warnings: warnings.into_list() })
}

/// How the arrays of the file are stored, by the attributes of its root.
fn decoder<'d, 'a>(
    bytes: &'a [u8],
    document: &'d VtiDocument<'a>,
) -> Result<ArrayDecoder<'d, 'a>, ReadError> {
    let file = &document.file;
    let unsupported = |what: &str, found: &str, known: &str| {
        let message = format!("{what} {} is not read: {known}", show(found.as_bytes()));
        Err(document.error("unsupported", file, message))
    };
    let endian = match file.get("byte_order") {
        None | Some("LittleEndian") => Endian::Little,
        Some("BigEndian") => Endian::Big,
        Some(other) => return unsupported("byte order", other, "LittleEndian and BigEndian are"),
    };
    let header = match file.get("header_type") {
        None | Some("UInt32") => 4,
        Some("UInt64") => 8,
        Some(other) => return unsupported("a header of", other, "UInt32 and UInt64 are"),
    };
    let is_packed = match file.get("compressor") {
        None | Some("") => false,
        Some("vtkZLibDataCompressor") => true,
        Some(other) => return unsupported("compressor", other, "vtkZLibDataCompressor is"),
    };
    Ok(ArrayDecoder { bytes, document, endian, header, is_packed })
}
