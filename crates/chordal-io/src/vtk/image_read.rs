//! Reads VTK ImageData, `.vti`.
use super::data_array::{ArrayDecoder, ArraySource};
use super::image_extent::{ImageExtent, affine};
use super::image_pieces::ArrayChoice;
use super::xml_document::{DataSetKind, PieceSection, VtkDocument};
use crate::volume::count::{along, size_of};
use crate::volume::element::Endian;
use crate::volume::samples::{self, SampleLayout};
use crate::volume::stream::SampleStream;
use crate::warnings::Warnings;
use crate::xml_text::place;
use crate::{Content, Frame, Limits, ReadError, ReadOutcome, Volume};
use chordal::implicit::Grid;

/// Reads the volume of VTK ImageData: the scalars of its points, else the only array with one number per
/// point; [`Limits::index`] selects another. Extent, origin, spacing and direction place the samples. If
/// there are no arrays at points, those at cells are read, at the centres of the cells, with a warning.
///
/// Samples are text, base64 or appended, plain or packed by zlib or LZ4, in one piece or several.
///
/// # Errors
/// [`ReadError`] at the line and column of the element, or at the byte of the samples; also for data sets
/// other than images, other compressors, and arrays of colours or vectors.
///
/// Source: Kitware, *VTK File Formats*, "XML File Formats", docs.vtk.org (2003 to 2024).
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
    let document = VtkDocument::read(bytes, &[DataSetKind::ImageData], limits)?;
    let mut decoder = ArrayDecoder::new(document.text, document.encoding, document.appended, limits);
    let choice = ArrayChoice::new(&document, limits, &mut warnings)?;
    let is_of_cells = choice.section == PieceSection::CellData;
    let image = &document.image;
    let points = ImageExtent::read(&document, image.at, "WholeExtent", image.extent.as_deref())?;
    let full = if is_of_cells { points.cells() } else { points };
    let place = place(document.text, image.at);
    for (axis, n) in full.size.into_iter().enumerate() {
        along(axis, n, &place)?;
    }
    let size = size_of(full.size, choice.kind, &place, limits)?;
    // A cell's centre is half a step after its lowest point.
    let half = if is_of_cells { 0.5 } else { 0.0 };
    let affine = affine(&document, full.low.map(|low| low as f64 + half))?;
    let body = choice.bytes(&document, &mut decoder, full)?;
    let is_text = matches!(choice.array.source, ArraySource::Text(..));
    let endian = if is_text { Endian::Little } else { document.encoding.endian };
    let layout = SampleLayout::volumes(choice.kind, endian, size);
    let samples = samples::read(&mut SampleStream::plain(&body, 0), &layout, limits, &mut warnings)?;
    drop(body);
    samples::count_not_finite(&samples, &mut warnings);
    let grid = Grid::new(size, samples, affine)
        .map_err(|error| ReadError::new("bad-size", place, error.to_string()))?;
    let name = crate::volume::name_of(choice.array.name.as_bytes());
    let volume = Volume { frame: Frame::default(), name, ..Volume::from_grid(grid) };
    Ok(ReadOutcome { content: Content::Volume(volume), warnings: warnings.into_list() })
}
