//! Reads legacy VTK files: surfaces here, volumes in `legacy_image`.
use super::attributes::{ArrayRows, FREE_VALUES, VtkAttributes};
use super::cell_list::{CellEnds, CellList};
use super::legacy_arrays::LegacyArrays;
use super::legacy_image;
use super::legacy_reader::{LegacyReader, LegacyType, lower};
use super::number_array::NumberArray;
use super::scene::{PieceMesh, Positions, scene_of};
use super::surface::{CellCounts, CellScope, VtkSurface};
use super::xml_document::DataSetKind;
use crate::assemble::too_many_rows;
use crate::text::{grouped, show};
use crate::warnings::Warnings;
use crate::{Content, FileLocation, Limits, ReadError, ReadOutcome};

/// Reads the surface of a legacy VTK file: PolyData, or the surface cells of an UnstructuredGrid, as text or
/// big-endian binary, in versions 1.0 to 5.1; the volume of STRUCTURED_POINTS.
///
/// Cells become faces, and arrays attributes, as in [`super::read_xml`]; `COLOR_SCALARS` are colours. Lookup
/// tables and fields that belong to neither points nor cells are skipped with a warning.
///
/// # Errors
/// [`ReadError`] at the line, the byte of a binary file, or the cell; also for other data sets, and for a
/// file without surface cells.
///
/// ```
/// use chordal_io::{Content, Limits, vtk};
/// let file = b"# vtk DataFile Version 3.0\nA square\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n\
///              0 0 0 1 0 0 1 1 0 0 1 0\nPOLYGONS 1 5\n4 0 1 2 3\n";
/// let Content::Scene(scene) = vtk::read(file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(scene.parts[0].mesh.faces(), [[0, 1, 2], [0, 2, 3]]);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
///
/// Source: Kitware, *VTK File Formats*, "Simple Legacy Formats", 2005–2024, and what VTK 9 writes as version 5.1.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let mut reader = LegacyReader::new(bytes, limits)?;
    let dataset = reader.word("DATASET")?;
    if lower(dataset) != "dataset" {
        return Err(reader.error("not-vtk", format!("{} stands where DATASET should", show(dataset))));
    }
    let name = reader.word("a data set")?;
    let kind = match &*lower(name) {
        "polydata" => DataSetKind::PolyData,
        "unstructured_grid" => DataSetKind::UnstructuredGrid,
        "structured_points" => return legacy_image::read(reader, limits),
        _ => {
            let message = format!(
                "the data set is {}: POLYDATA, UNSTRUCTURED_GRID and STRUCTURED_POINTS are read here",
                show(name)
            );
            return Err(reader.error("unsupported-data-set", message));
        }
    };
    let mut warnings = Warnings::default();
    let geometry = LegacyGeometry { kind, ..LegacyGeometry::read(&mut reader, limits, &mut warnings)? };
    let positions = geometry.positions(limits, &mut warnings)?;
    let mut counts = CellCounts::default();
    let mut surface = VtkSurface::default();
    let mut scope = CellScope {
        n_points: positions.len(),
        cell: 0,
        counts: &mut counts,
        warnings: &mut warnings,
        limits,
    };
    geometry.cells(&mut surface, &mut scope)?;
    let n_cells = scope.cell;
    surface.count_strips(&mut warnings);
    let mut attributes = VtkAttributes::default();
    let mut arrays = LegacyArrays::new(&mut reader, &mut warnings);
    while let Some(word) = arrays.reader.next() {
        let rows = match &*lower(word) {
            "point_data" => ArrayRows::Points(positions.len()),
            "cell_data" => ArrayRows::Cells(n_cells as usize, &surface.cells),
            "metadata" => {
                arrays.skip_metadata()?;
                continue;
            }
            _ => {
                let message = format!("{} is no keyword of VTK here", show(word));
                return Err(arrays.reader.error("unknown-keyword", message));
            }
        };
        let n = arrays.reader.count("the number of rows")?;
        let (ArrayRows::Points(expected) | ArrayRows::Cells(expected, _)) = rows;
        if n != expected as u64 {
            let message = format!(
                "data for {} points or cells, and there are {}",
                grouped(n),
                grouped(expected as u64)
            );
            return Err(arrays.reader.error("count-mismatch", message));
        }
        arrays.read(rows, FREE_VALUES + bytes.len() as u64, &mut |array, most, warnings| {
            let is_id = matches!(rows, ArrayRows::Points(_))
                && attributes.take_position_id(array, &positions, warnings)?;
            if is_id { Ok(()) } else { attributes.push(array, rows, most, warnings) }
        })?;
    }
    counts.finish(&mut warnings)?;
    let part = PieceMesh { positions, surface, attributes }.part(limits, &mut warnings)?;
    let scene = scene_of(vec![part], None)?;
    Ok(ReadOutcome { content: Content::Scene(scene), warnings: warnings.into_list() })
}

/// A list of cells as stored in the file.
#[derive(Debug)]
struct LegacyCells<'a> {
    /// The type of all cells, or `None` if the types are in a separate list.
    kind: Option<u8>,
    n: u64,
    list: CellList<'a>,
}

/// The points and cells of a file.
#[derive(Debug)]
struct LegacyGeometry<'a> {
    kind: DataSetKind,
    points: NumberArray<'a>,
    n_points: u64,
    cells: Vec<LegacyCells<'a>>,
    types: NumberArray<'a>,
}

impl<'a> LegacyGeometry<'a> {
    /// Reads up to the data of points and cells.
    fn read(
        reader: &mut LegacyReader<'a>,
        limits: &Limits,
        warnings: &mut Warnings,
    ) -> Result<Self, ReadError> {
        let (points, types) = (NumberArray::empty(), NumberArray::empty());
        let mut geometry =
            Self { kind: DataSetKind::PolyData, points, n_points: 0, cells: Vec::new(), types };
        while let Some(word) = reader.peek() {
            let keyword = lower(word);
            if matches!(&*keyword, "point_data" | "cell_data") {
                break;
            }
            reader.next();
            // VTK's numbers of the types of cells; those of a grid are in a list of their own.
            let kind = match &*keyword {
                "vertices" => Some(2),
                "lines" => Some(4),
                "polygons" => Some(7),
                "triangle_strips" => Some(6),
                "cells" => None,
                "points" => {
                    geometry.n_points = reader.count("the number of points")?;
                    geometry.points = match reader.kind()? {
                        LegacyType::Number(kind) => reader.numbers(geometry.n_points, 3, kind)?,
                        _ => {
                            return Err(reader.error("type-unknown", "points are no numbers".to_owned()));
                        }
                    };
                    continue;
                }
                "cell_types" => {
                    let n = reader.count("the number of types")?;
                    geometry.types = reader.numbers(n, 1, crate::volume::element::SampleType::I32)?;
                    continue;
                }
                "field" => {
                    LegacyArrays::new(reader, warnings).skip_field()?;
                    continue;
                }
                "metadata" => {
                    LegacyArrays::new(reader, warnings).skip_metadata()?;
                    continue;
                }
                _ => {
                    let message = format!("{} is no keyword of VTK here", show(word));
                    return Err(reader.error("unknown-keyword", message));
                }
            };
            let cells = cells(reader, kind, limits)?;
            if geometry.cells.iter().any(|known| known.kind == kind) {
                let message = format!("a second list of {}", show(word));
                return Err(reader.error("repeated-keyword", message));
            }
            geometry.cells.push(cells);
        }
        Ok(geometry)
    }

    fn positions(&self, limits: &Limits, warnings: &mut Warnings) -> Result<Vec<[f64; 3]>, ReadError> {
        Positions { numbers: &self.points, n_points: self.n_points, limits }
            .read(|| FileLocation::File, warnings)
    }

    /// Reads the cells in VTK's numbering, whatever their order in the file: points, lines, polygons, strips.
    fn cells(self, surface: &mut VtkSurface, scope: &mut CellScope<'_>) -> Result<(), ReadError> {
        const ORDER: [Option<u8>; 4] = [Some(2), Some(4), Some(7), Some(6)];
        let Self { kind, mut cells, types, .. } = self;
        let order = match kind {
            DataSetKind::PolyData => &ORDER[..],
            DataSetKind::UnstructuredGrid => &[None],
            // Volumes were refused before.
            DataSetKind::ImageData => &[],
        };
        if let Some(other) = cells.iter().find(|cells| !order.contains(&cells.kind)) {
            return Err(other.list.error("wrong-cells", "the data set has no such list of cells".to_owned()));
        }
        for of in order {
            let Some(group) = cells.iter_mut().find(|cells| cells.kind == *of) else { continue };
            if of.is_none() && (types.len() as u64) < group.n {
                let message = format!("{} types for {} cells", grouped(types.len() as u64), grouped(group.n));
                return Err(group.list.error("truncated", message));
            }
            let kinds = (0..group.n as usize).map(|i| match of {
                Some(kind) => *kind,
                // A number that does not fit a byte is an unknown type.
                None => types.integer(i).and_then(|kind| u8::try_from(kind).ok()).unwrap_or(u8::MAX),
            });
            group.list.start_at(scope.cell);
            surface.read(&mut group.list, kinds, scope)?;
            let left = group.list.n_left();
            scope.warnings.count_many("connectivity-left-over", left, || {
                (FileLocation::File, "indices after the last cell were not used".to_owned())
            });
        }
        Ok(())
    }
}

/// Reads a list of cells: each as its number of points and the points, or since version 5 all starts and then
/// all points.
fn cells<'a>(
    reader: &mut LegacyReader<'a>,
    kind: Option<u8>,
    limits: &Limits,
) -> Result<LegacyCells<'a>, ReadError> {
    let n = reader.count("the number of cells")?;
    let size = reader.count("the size of the list of cells")?;
    if n > limits.rows {
        return Err(too_many_rows(reader.place().location(), "cells", n, limits.rows));
    }
    if !reader.peek().is_some_and(|word| word.eq_ignore_ascii_case(b"offsets")) {
        let points = reader.numbers(size, 1, crate::volume::element::SampleType::I32)?;
        return Ok(LegacyCells { kind, n, list: CellList::new(points, CellEnds::Counted, 0) });
    }
    reader.next();
    let starts = integers(reader, n)?;
    let word = reader.word("CONNECTIVITY")?;
    if !word.eq_ignore_ascii_case(b"connectivity") {
        let message = format!("{} stands where CONNECTIVITY should", show(word));
        return Err(reader.error("unknown-keyword", message));
    }
    let points = integers(reader, size)?;
    let list = CellList::new(points, CellEnds::Starts(starts), 0);
    // There is one start more than cells.
    Ok(LegacyCells { kind, n: n.saturating_sub(1), list })
}

fn integers<'a>(reader: &mut LegacyReader<'a>, n: u64) -> Result<NumberArray<'a>, ReadError> {
    match reader.kind()? {
        LegacyType::Number(kind) => reader.numbers(n, 1, kind),
        _ => Err(reader.error("type-unknown", "a list of cells is no numbers".to_owned())),
    }
}
