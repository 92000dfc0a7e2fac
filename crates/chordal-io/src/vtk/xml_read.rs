//! Reads VTK's XML files of surfaces.
use super::array_place::ArrayPlace;
use super::attributes::{ArrayRole, ArrayRows, FREE_VALUES, NamedArray, VtkAttributes, skip_array};
use super::cell_list::{CellEnds, CellList};
use super::data_array::{ArrayDecoder, ArraySource, DataArray};
use super::names::CERTIFICATE;
use super::number_array::NumberArray;
use super::scene::{PieceMesh, Positions, scene_of};
use super::surface::{CellCounts, CellScope, VtkSurface};
use super::xml_document::{ActiveArray, DataSetKind, PieceSection, VtkDocument, VtkPiece};
use crate::assemble::too_many_rows;
use crate::text::{LineTokens, integer};
use crate::volume::element::SampleType;
use crate::warnings::Warnings;
use crate::xml_text::place;
use crate::{Content, FileLocation, Limits, Part, ReadError, ReadOutcome};
use serde_json::Value;

/// The data sets that define surfaces.
const SURFACES: &[DataSetKind] = &[DataSetKind::PolyData, DataSetKind::UnstructuredGrid];

/// Reads the surface of a VTK XML file: PolyData (`.vtp`), or the surface cells of an UnstructuredGrid (`.vtu`).
///
/// Each piece is a part. Triangles, quads, polygons, pixels and strips are faces; polygons are cut into
/// triangles. Other cells (volumes, lines, points) are skipped with a warning that counts them by name, and
/// curved cells are read as flat ones over their corners. Normals, texture coordinates and colours (three or
/// four bytes) of points become attributes of vertices, and all other arrays of numbers
/// [`chordal::explicit::Semantic::Custom`]; arrays of cells are copied to each triangle of the cell. Arrays
/// are text, base64 or appended bytes, plain or packed by zlib or LZ4, in either byte order. Numbers in text
/// are not rounded to the declared type of the array.
///
/// # Errors
/// [`ReadError`] at the line and column, the byte of the appended data, or the cell; also for other data
/// sets, other compressors, and a file without surface cells.
///
/// ```
/// use chordal_io::{Content, Limits, vtk};
/// let file = br#"<VTKFile type="PolyData"><PolyData><Piece NumberOfPoints="4" NumberOfPolys="1">
///   <Points><DataArray type="Float32" NumberOfComponents="3">0 0 0 1 0 0 1 1 0 0 1 0</DataArray></Points>
///   <Polys><DataArray type="Int32" Name="connectivity">0 1 2 3</DataArray>
///     <DataArray type="Int32" Name="offsets">4</DataArray></Polys></Piece></PolyData></VTKFile>"#;
/// let Content::Scene(scene) = vtk::read_xml(file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(scene.parts[0].mesh.faces(), [[0, 1, 2], [0, 2, 3]]);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
///
/// Source: Kitware, *VTK File Formats*, 2005–2024.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let document = VtkDocument::read(bytes, SURFACES, limits)?;
    let decoder = ArrayDecoder::new(document.text, document.encoding, document.appended, limits);
    let mut reader =
        XmlPieceReader { document: &document, decoder, limits, warnings: Warnings::default(), n_spread: 0 };
    let certificate = reader.certificate()?;
    let mut counts = CellCounts::default();
    let mut parts: Vec<Part> = Vec::new();
    let mut n_empty = 0;
    for piece in &document.pieces {
        // Empty pieces remain where a data set was divided among many processes.
        if piece.n_points == 0 && document.pieces.len() > 1 {
            n_empty += 1;
            continue;
        }
        parts.push(reader.piece(piece, &mut counts)?);
    }
    let XmlPieceReader { mut warnings, .. } = reader;
    warnings.count_all("empty-pieces", n_empty, "pieces without points were left out");
    let message =
        "arrays of a name that the piece has already were skipped: of several times the first is read";
    warnings.count_all("arrays-repeated", document.n_other_times, message);
    counts.finish(&mut warnings)?;
    let scene = scene_of(parts, certificate)?;
    Ok(ReadOutcome { content: Content::Scene(scene), warnings: warnings.into_list() })
}

/// Reads pieces.
struct XmlPieceReader<'d, 'a> {
    document: &'d VtkDocument<'a>,
    decoder: ArrayDecoder<'a>,
    limits: &'d Limits,
    warnings: Warnings,
    /// The number of values that were copied to triangles.
    n_spread: u64,
}

impl<'d, 'a> XmlPieceReader<'d, 'a> {
    fn piece(&mut self, piece: &'d VtkPiece<'a>, counts: &mut CellCounts) -> Result<Part, ReadError> {
        let positions = self.positions(piece)?;
        let mut surface = VtkSurface::default();
        // Out of `self` meanwhile: the scope borrows them while `self` decodes arrays.
        let mut warnings = std::mem::take(&mut self.warnings);
        let mut scope = CellScope {
            n_points: positions.len(),
            cell: 0,
            counts,
            warnings: &mut warnings,
            limits: self.limits,
        };
        match self.document.kind {
            DataSetKind::PolyData => self.poly_data(piece, &mut surface, &mut scope)?,
            DataSetKind::UnstructuredGrid => self.cells(piece, &mut surface, &mut scope)?,
            // Volumes were refused before.
            DataSetKind::ImageData => {}
        }
        let n_cells = scope.cell as usize;
        self.warnings = warnings;
        surface.count_strips(&mut self.warnings);
        // The count goes on over all pieces, so that many small ones cannot exceed the limit.
        let mut attributes = VtkAttributes { n_spread: self.n_spread, ..VtkAttributes::default() };
        for (section, array) in &piece.arrays {
            let rows = match section {
                PieceSection::PointData => ArrayRows::Points(positions.len()),
                PieceSection::CellData => ArrayRows::Cells(n_cells, &surface.cells),
                _ => continue,
            };
            if array.kind.is_none() {
                let at = ArrayPlace::Text(self.document.text, array.at);
                skip_array(&array.name, "it holds no numbers of whole bytes", at, &mut self.warnings);
                continue;
            }
            let named = self.named(piece, *section, array)?;
            let is_id = *section == PieceSection::PointData
                && attributes.take_position_id(&named, &positions, &mut self.warnings)?;
            if !is_id {
                let most = FREE_VALUES + self.decoder.n_decoded();
                attributes.push(&named, rows, most, &mut self.warnings)?;
            }
        }
        self.n_spread = attributes.n_spread;
        PieceMesh { positions, surface, attributes }.part(self.limits, &mut self.warnings)
    }

    fn positions(&mut self, piece: &'d VtkPiece<'a>) -> Result<Vec<[f64; 3]>, ReadError> {
        let array = piece.array(PieceSection::Points, None);
        let Some(array) = array else {
            if piece.n_points == 0 {
                return Ok(Vec::new());
            }
            let message = "the piece has points, but no array of them";
            return Err(ReadError::new("no-points", place(self.document.text, piece.at), message));
        };
        if array.n_components != 3 {
            let message = format!("points have {} coordinates, not 3", array.n_components);
            return Err(self.decoder.error(array, "wrong-width", &message));
        }
        let numbers = self.decoder.decode(array)?;
        let at = || place(self.document.text, array.at);
        Positions { numbers: &numbers, n_points: piece.n_points, limits: self.limits }
            .read(at, &mut self.warnings)
    }

    /// A list of cells, empty if there are none.
    fn list(
        &mut self,
        piece: &'d VtkPiece<'a>,
        section: PieceSection,
        n: u64,
        first: u64,
    ) -> Result<CellList<'d>, ReadError> {
        if n == 0 {
            return Ok(CellList::new(NumberArray::empty(), CellEnds::Counted, first));
        }
        if n > self.limits.rows {
            return Err(too_many_rows(place(self.document.text, piece.at), "cells", n, self.limits.rows));
        }
        let points = self.needed(piece, section, "connectivity")?;
        let ends = self.needed(piece, section, "offsets")?;
        Ok(CellList::new(points, CellEnds::Ends(ends), first))
    }

    /// An array that a list of cells needs.
    fn needed(
        &mut self,
        piece: &'d VtkPiece<'a>,
        section: PieceSection,
        name: &str,
    ) -> Result<NumberArray<'d>, ReadError> {
        match piece.array(section, Some(name)) {
            Some(array) => self.decoder.decode(array),
            None => {
                let message = format!("the cells of {section:?} have no array '{name}'");
                Err(ReadError::new("no-cells", place(self.document.text, piece.at), message))
            }
        }
    }

    /// VTK numbers cells in this order: points, lines, polygons, strips.
    fn poly_data(
        &mut self,
        piece: &'d VtkPiece<'a>,
        surface: &mut VtkSurface,
        scope: &mut CellScope<'_>,
    ) -> Result<(), ReadError> {
        /// The types of cells: poly-vertex, polyline, polygon, strip.
        const SECTIONS: [(PieceSection, u8); 4] = [
            (PieceSection::Verts, 2),
            (PieceSection::Lines, 4),
            (PieceSection::Polys, 7),
            (PieceSection::Strips, 6),
        ];
        let counts = [piece.n_verts, piece.n_lines, piece.n_polys, piece.n_strips];
        for ((section, kind), n) in SECTIONS.into_iter().zip(counts) {
            let mut list = self.list(piece, section, n, scope.cell)?;
            surface.read(&mut list, (0..n).map(|_| kind), scope)?;
            count_left(&list, scope);
        }
        Ok(())
    }

    fn cells(
        &mut self,
        piece: &'d VtkPiece<'a>,
        surface: &mut VtkSurface,
        scope: &mut CellScope<'_>,
    ) -> Result<(), ReadError> {
        let n = piece.n_cells;
        let mut list = self.list(piece, PieceSection::Cells, n, 0)?;
        if n == 0 {
            return Ok(());
        }
        let types = self.needed(piece, PieceSection::Cells, "types")?;
        if (types.len() as u64) < n {
            let message = format!("{} types for {n} cells", types.len());
            return Err(ReadError::new("truncated", place(self.document.text, piece.at), message));
        }
        // A number that does not fit a byte is an unknown type.
        let kinds = (0..n as usize).map(|i| types.integer(i).and_then(|kind| u8::try_from(kind).ok()));
        surface.read(&mut list, kinds.map(|kind| kind.unwrap_or(u8::MAX)), scope)?;
        count_left(&list, scope);
        Ok(())
    }

    fn named(
        &mut self,
        piece: &'d VtkPiece<'a>,
        section: PieceSection,
        array: &'d DataArray<'a>,
    ) -> Result<NamedArray<'d>, ReadError> {
        let numbers = self.decoder.decode(array)?;
        let is_bytes = array.kind == Some(SampleType::U8);
        let is = |of: ActiveArray| {
            section == PieceSection::PointData && piece.active(of) == Some(array.name.as_str())
        };
        let role = if is(ActiveArray::PointNormals) {
            ArrayRole::Normals
        } else if is(ActiveArray::PointTexCoords) {
            ArrayRole::TexCoords
        } else if is_bytes && matches!(array.n_components, 3 | 4) {
            // Viewers show three or four bytes as a colour, whatever the name of the array.
            ArrayRole::Colors
        } else {
            ArrayRole::Unknown
        };
        let at = ArrayPlace::Text(self.document.text, array.at);
        // Byte colours are fractions of 255.
        let divisor = if is_bytes { 255.0 } else { 1.0 };
        let (name, width) = (&*array.name, array.n_components);
        Ok(NamedArray {
            name,
            role,
            width,
            kind: array.kind.unwrap_or(SampleType::F64),
            divisor,
            numbers,
            place: at,
        })
    }

    /// The certificate among the arrays of the data set; others are counted.
    fn certificate(&mut self) -> Result<Option<Value>, ReadError> {
        let mut certificate = None;
        for array in &self.document.fields {
            let at = ArrayPlace::Text(self.document.text, array.at);
            if array.name != CERTIFICATE {
                skip_array(&array.name, "it belongs to no point and no cell", at, &mut self.warnings);
                continue;
            }
            let bytes = match &array.source {
                ArraySource::Text(text, _) => characters(text),
                _ => self.decoder.bytes(array)?.into_owned(),
            };
            let end = memchr::memchr(0, &bytes).unwrap_or(bytes.len());
            certificate = crate::certificate::read(&bytes[..end], at.location(), &mut self.warnings);
        }
        Ok(certificate)
    }
}

/// The text of an array of characters by their codes; an invalid code ends it.
fn characters(text: &str) -> Vec<u8> {
    let byte = |token: &[u8]| integer(token).ok().and_then(|value| u8::try_from(value).ok());
    LineTokens::new(text.as_bytes()).map_while(byte).collect()
}

/// Warns about points after the last cell.
fn count_left(list: &CellList<'_>, scope: &mut CellScope<'_>) {
    scope.warnings.count_many("connectivity-left-over", list.n_left(), || {
        (FileLocation::File, "indices after the last cell were not used".to_owned())
    });
}
