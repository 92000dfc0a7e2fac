//! Reads GIFTI surfaces.
use super::data_array::{GiftiArray, GiftiFile};
use crate::assemble::{RawMesh, mesh, too_many_rows};
use crate::files::FileOpener;
use crate::grow::with_room;
use crate::text::grouped;
use crate::vtk::number_array::NumberArray;
use crate::warnings::Warnings;
use crate::xml_elements::{AnyNamespace, XmlElements, XmlStep};
use crate::xml_text::text_of;
use crate::{Axis, Content, FileLocation, Frame, Limits, Part, ReadError, ReadOutcome, Scene};
use std::borrow::Cow;

/// As [`read_with`], for a file that holds all its arrays.
///
/// # Errors
/// As for [`read_with`].
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    read_with(bytes, None, limits)
}

/// Reads the surface of a GIFTI file: its points and its triangles, as text, base64, compressed base64 or in
/// a separate file. Coordinates are millimetres of the file's own space, with z towards the head. Its
/// matrices into other spaces are skipped, as are arrays of values at the points (shapes, labels, time
/// series), with warnings.
///
/// # Errors
/// [`ReadError`] at the element of the array, or the row of the point or triangle; also for a file without
/// points or triangles, such as one of labels or measurements.
///
/// Source: J. Harwell and others, *GIFTI Surface Data Format*, version 1.0, 2011 (nitrc.org).
///
/// ```
/// use chordal_io::{Content, Limits, gii};
/// let file = br#"<GIFTI Version="1.0" NumberOfDataArrays="2">
///   <DataArray Intent="NIFTI_INTENT_POINTSET" DataType="NIFTI_TYPE_FLOAT32" Dimensionality="2" Dim0="3" Dim1="3"
///     Encoding="ASCII"><Data>0 0 0 1 0 0 0 1 0</Data></DataArray>
///   <DataArray Intent="NIFTI_INTENT_TRIANGLE" DataType="NIFTI_TYPE_INT32" Dimensionality="2" Dim0="1" Dim1="3"
///     Encoding="ASCII"><Data>0 1 2</Data></DataArray></GIFTI>"#;
/// let Content::Scene(scene) = gii::read(file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(scene.parts[0].mesh.faces(), [[0, 1, 2]]);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
pub fn read_with(
    bytes: &[u8],
    open: Option<&mut FileOpener<'_>>,
    limits: &Limits,
) -> Result<ReadOutcome, ReadError> {
    let text = without_document_type(text_of(bytes)?);
    let mut warnings = Warnings::default();
    let [points, triangles] = arrays(&text, limits, &mut warnings)?;
    let missing = |what: &str| {
        let message = format!(
            "the file has no {what}, and so no surface: numbers at the points of another file are no shape"
        );
        ReadError::new("no-surface", FileLocation::File, message)
    };
    let points = points.ok_or_else(|| missing("points"))?;
    let triangles = triangles.ok_or_else(|| missing("triangles"))?;
    let mut file = GiftiFile { text: &text, open, limits };
    let positions = positions(&points, &mut file)?;
    let faces = faces(&triangles, positions.len() as u64, &mut file)?;
    let raw = RawMesh { positions, faces, ..RawMesh::default() };
    let mesh = mesh(raw, limits, &mut warnings)?;
    // The standard's unit is the millimetre.
    let frame = Frame { up: Some(Axis::Z), metres_per_unit: Some(0.001), ..Frame::default() };
    let scene = Scene::from_part(Part { mesh, indexed: true, ..Part::default() }, frame);
    Ok(ReadOutcome { content: Content::Scene(scene), warnings: warnings.into_list() })
}

/// The text with a document type without declarations replaced by spaces, as most of these files have one.
/// Nothing is fetched, and a document type with declarations is refused as in all XML here.
fn without_document_type(text: &str) -> Cow<'_, str> {
    let start = "<!DOCTYPE";
    let Some(at) = text.find(start).filter(|at| text[..*at].find("<GIFTI").is_none()) else {
        return Cow::Borrowed(text);
    };
    match text[at..].find(['>', '[']) {
        Some(end) if text.as_bytes()[at + end] == b'>' => {
            // Line breaks stay, so that locations stay the same.
            let blank = |c: char| if c == '\n' { "\n".to_owned() } else { " ".repeat(c.len_utf8()) };
            let blanks: String = text[at..=at + end].chars().map(blank).collect();
            Cow::Owned([&text[..at], &blanks, &text[at + end + 1..]].concat())
        }
        _ => Cow::Borrowed(text),
    }
}

/// The first array of points and the first array of triangles.
fn arrays<'a>(
    text: &'a str,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<[Option<GiftiArray<'a>>; 2], ReadError> {
    let mut elements: XmlElements<'_, AnyNamespace> = XmlElements::new(text, "", limits);
    let mut arrays = [None, None];
    let mut open: Vec<&str> = Vec::new();
    // The array whose content comes next.
    let mut current: Option<usize> = None;
    while let Some(step) = elements.next()? {
        match step {
            XmlStep::Start(element) => {
                if open.is_empty() && element.local != "GIFTI" {
                    return Err(elements.error("not-gifti", "the root element is not GIFTI"));
                }
                open.push(element.local);
                if open == ["GIFTI", "DataArray"] {
                    let intent = elements.need("Intent")?;
                    let which = match intent {
                        "NIFTI_INTENT_POINTSET" => Some(0),
                        "NIFTI_INTENT_TRIANGLE" => Some(1),
                        _ => None,
                    };
                    current = which.filter(|which| arrays[*which].is_none());
                    match current {
                        Some(which) => arrays[which] = Some(GiftiArray::new(&elements)?),
                        None => warnings.count("arrays-skipped", || {
                            let message =
                                "arrays that are not the points and triangles of one surface were skipped";
                            (elements.place(), message)
                        }),
                    }
                }
            }
            XmlStep::Text(content) => {
                if let (Some(which), ["GIFTI", "DataArray", "Data"]) = (current, open.as_slice())
                    && let Some(array) = &mut arrays[which]
                {
                    // Usually one piece, which is borrowed; CDATA and entities cut it into several.
                    if array.data.is_empty() {
                        array.data = content;
                    } else {
                        array.data.to_mut().push_str(&content);
                    }
                }
            }
            XmlStep::End => {
                open.pop();
            }
        }
    }
    Ok(arrays)
}

/// The position of a number in an array, by its row and its column.
fn at(array: &GiftiArray<'_>, row: u64, column: u64) -> usize {
    let [rows, width] = array.size;
    (if array.is_by_columns { column * rows + row } else { row * width + column }) as usize
}

fn check_width(array: &GiftiArray<'_>, what: &str, text: &str) -> Result<(), ReadError> {
    if array.size[1] == 3 {
        return Ok(());
    }
    let message = format!("{what} have {} numbers each, and should have 3", grouped(array.size[1]));
    Err(ReadError::new("wrong-width", array.place(text), message))
}

fn positions(array: &GiftiArray<'_>, file: &mut GiftiFile<'_, '_, '_>) -> Result<Vec<[f64; 3]>, ReadError> {
    check_width(array, "points", file.text)?;
    let n = array.size[0];
    // The highest index is reserved for "no vertex".
    let most = file.limits.rows.min(u64::from(u32::MAX) - 1);
    if n > most {
        return Err(too_many_rows(array.place(file.text), "points", n, most));
    }
    let numbers = array.numbers(file)?;
    let mut positions: Vec<[f64; 3]> = with_room(n as usize)?;
    positions.extend((0..n).map(|row| [0, 1, 2].map(|k| numbers.real(at(array, row, k)))));
    let bad = positions.iter().position(|point| point.iter().any(|x| !x.is_finite()));
    if let Some(row) = bad.filter(|_| !file.limits.drop_nonfinite) {
        let message = format!("{:?} is not finite", positions[row]);
        return Err(ReadError::new(
            "not-finite",
            FileLocation::Row { list: "point", row: row as u64 },
            message,
        ));
    }
    Ok(positions)
}

fn faces(
    array: &GiftiArray<'_>,
    n_points: u64,
    file: &mut GiftiFile<'_, '_, '_>,
) -> Result<Vec<[u32; 3]>, ReadError> {
    check_width(array, "triangles", file.text)?;
    let n = array.size[0];
    if n > file.limits.rows {
        return Err(too_many_rows(array.place(file.text), "triangles", n, file.limits.rows));
    }
    let numbers = array.numbers(file)?;
    let mut triangles: Vec<[u32; 3]> = with_room(n as usize)?;
    for row in 0..n {
        let mut face = [0; 3];
        for (k, corner) in (0..).zip(&mut face) {
            *corner = corner_of(&numbers, at(array, row, k), n_points).map_err(|message| {
                ReadError::new("index-out-of-range", FileLocation::Row { list: "triangle", row }, message)
            })?;
        }
        triangles.push(face);
    }
    Ok(triangles)
}

/// The index of a point; some programs write it as a floating-point number.
fn corner_of(numbers: &NumberArray<'_>, i: usize, n_points: u64) -> Result<u32, String> {
    let real = numbers.real(i);
    let index = numbers.integer(i).unwrap_or(if real.fract() == 0.0 { real as i64 } else { -1 });
    match u32::try_from(index) {
        Ok(corner) if u64::from(corner) < n_points => Ok(corner),
        _ => Err(format!("a corner is point {real}, and there are {}, counted from 0", grouped(n_points))),
    }
}
