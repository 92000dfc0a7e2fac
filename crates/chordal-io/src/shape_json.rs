//! Shapes in JSON: patches, curves and polylines, as defined by `docs/schema/patches.schema.json`,
//! `curves.schema.json`, `polylines.schema.json` and `surfaces.schema.json`.
mod constructions;
mod lines;
mod spline_curve;
mod spline_numbers;
mod surfaces;
mod trim;
mod write;

use crate::assemble::{check_patches, check_surfaces, too_many_rows};
use crate::grow::{push, with_room};
use crate::json::{JsonKind, JsonReader};
use crate::text::{grouped, show, text_of};
use crate::warnings::Warnings;
use crate::{Axis, Content, FileLocation, Frame, Limits, ReadError, ReadOutcome};
use chordal::Patch;
use chordal::explicit::nurbs::TrimmedSurface;
use lines::{CurveForm, CurveList};
use serde_json::Value;
pub use write::write;

/// Reads a shape from JSON. The file is one of
///
/// - patches: `{"patches": [[[[x, y, z], …4], …4], …]}`, or
///   `{"points": [[x, y, z], …], "patches": [[i, …16], …]}` with indices from 0;
/// - NURBS surfaces: `{"surfaces": [{"degree": [p, q], "knots": [[…], […]], "control": [[[x, y, z], …], …],
///   "weights": [[…], …]}, …]}`, row by row, `u` along a row; weights are 1 where they are left out; or constructed from
///   curves: `{"surfaces": [{"loft": {"sections": […]}}, {"coons": {"u": […], "v": […]}}, {"sweep": {"profile": …,
///   "path": …}}, {"extrude": …}, {"revolve": …}, {"ruled": […]}]}`;
/// - curves: `{"curves": [{"control": [[x, y], …], "closed": false}, …]}` with 3n + 1 control points of n
///   cubics, or splines with `"degree"` (3), `"knots"` (clamped and uniform) and `"weights"` (1) beside their
///   control points;
/// - polylines: `{"polylines": [{"points": [[x, y], …], "closed": false, "source": 0}, …]}`, as Chordal
///   writes them.
///
/// All points of curves and polylines have two numbers, or all have three. Consecutive lines with the same
/// `"source"` are one element, which matters for filling; `"rule"` is the fill rule. `"up": "y" | "z"` and
/// `"metres_per_unit"` are optional and default to unknown.
///
/// # Errors
/// [`ReadError`] with the JSON pointer of the error, or the byte if the text is not JSON.
///
/// ```
/// use chordal_io::{Content, Limits, shape_json};
/// let file = br#"{"up": "z", "points": [[0,0,0], [1,0,0]], "patches": [[0,0,0,0, 0,0,0,0, 1,1,1,1, 1,1,1,1]]}"#;
/// let Content::Patches(patches, frame) = shape_json::read(file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(patches[0].control[2][0], [1.0, 0.0, 0.0]);
/// assert_eq!(frame.up, Some(chordal_io::Axis::Z));
///
/// let error = shape_json::read(br#"{"patches": [[[[0, 0]]]]}"#, &Limits::default()).unwrap_err();
/// assert_eq!(error.to_string(), "/patches/0/0/0: 2 numbers where 3 are needed");
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let mut json = JsonReader::new(text_of(bytes)?, limits)?;
    let mut members = ShapeJsonMembers::default();
    json.object(|json, key| members.member(json, key, limits))?;
    json.end()?;
    if let Some(form) = members.lines.form {
        return members.lines(form);
    }
    if let Some(surfaces) = members.surfaces.take() {
        if members.has_patches {
            return Err(surfaces::mixed("patches"));
        }
        if let Some(points) = members.points {
            members.warnings.count_all("isolated-points", points.len() as u64, UNUSED);
        }
        check_surfaces(&surfaces, &mut members.warnings)?;
        let content = Content::Surfaces(surfaces, members.frame);
        return Ok(ReadOutcome { content, warnings: members.warnings.into_list() });
    }
    let patches = members.patches()?;
    check_patches(&patches, &mut members.warnings)?;
    Ok(ReadOutcome {
        content: Content::Patches(patches, members.frame),
        warnings: members.warnings.into_list(),
    })
}

/// Whether the text is a JSON object with shapes.
pub(crate) fn looks_like(text: &[u8]) -> bool {
    if text.first() != Some(&b'{') {
        return false;
    }
    let Ok(mut json) = JsonReader::new(text, &Limits::default()) else { return false };
    let mut has_shapes = false;
    // Stops with an error at the key that decides, so the shapes themselves are not read.
    let _ = json.object(|json, key| {
        has_shapes |= matches!(key, "patches" | "surfaces" | "curves" | "polylines");
        if has_shapes { Err(json.error("found", "")) } else { json.skip() }
    });
    has_shapes
}

/// A larger report is dropped. Chosen: the reports that Chordal writes have a few thousand bytes.
const LARGEST_REPORT: usize = 256 << 10;

/// Counts an unknown member.
fn unknown(json: &JsonReader, key: &str, warnings: &mut Warnings) {
    let message = format!("members that are not known were skipped, {} first", show(key.as_bytes()));
    warnings.count("unknown-member", || (json.place(), message));
}

const UNUSED: &str = "points that no patch names were dropped";

/// The members read so far; indices may precede the points that they refer to.
#[derive(Default)]
struct ShapeJsonMembers {
    points: Option<Vec<[f64; 3]>>,
    by_index: Vec<[u32; 16]>,
    by_value: Vec<Patch>,
    has_patches: bool,
    surfaces: Option<Vec<TrimmedSurface>>,
    lines: CurveList,
    /// The report in the file.
    report: Option<Value>,
    frame: Frame,
    warnings: Warnings,
}

impl ShapeJsonMembers {
    fn member(&mut self, json: &mut JsonReader, key: &str, limits: &Limits) -> Result<(), ReadError> {
        match key {
            "patches" => {
                self.has_patches = true;
                json.array(|json, row| {
                    check_rows(json, "patches", row, limits)?;
                    self.patch(json)
                })?;
            }
            "surfaces" => {
                let mut surfaces = Vec::new();
                json.array(|json, row| {
                    check_rows(json, "surfaces", row, limits)?;
                    push(&mut surfaces, surfaces::surface(json, limits, &mut self.warnings)?)
                })?;
                self.surfaces = Some(surfaces);
            }
            "curves" => self.read_lines(json, CurveForm::Curves, limits)?,
            "polylines" => self.read_lines(json, CurveForm::Polylines, limits)?,
            "report" => {
                let text = json.raw()?;
                // A truncated or invalid report is dropped.
                self.report =
                    if text.len() <= LARGEST_REPORT { serde_json::from_slice(text).ok() } else { None };
            }
            "points" => {
                let mut points = Vec::new();
                json.array(|json, row| {
                    check_rows(json, "points", row, limits)?;
                    push(&mut points, point(json)?)
                })?;
                self.points = Some(points);
            }
            "up" => {
                let name = if json.peek()? == JsonKind::String { json.string()? } else { String::new() };
                self.frame.up = Some(match name.as_str() {
                    "y" => Axis::Y,
                    "z" => Axis::Z,
                    _ => return Err(json.error("wrong-value", "up is \"y\" or \"z\"")),
                });
            }
            "metres_per_unit" => {
                let value = json.number()?;
                if value <= 0.0 {
                    return Err(json.error("wrong-value", format!("{value} is not greater than 0")));
                }
                self.frame.metres_per_unit = Some(value);
            }
            _ => {
                unknown(json, key, &mut self.warnings);
                json.skip()?;
            }
        }
        Ok(())
    }

    fn read_lines(
        &mut self,
        json: &mut JsonReader,
        form: CurveForm,
        limits: &Limits,
    ) -> Result<(), ReadError> {
        if self.lines.form.is_some() {
            return Err(json.error("mixed-shapes", "a file holds curves or polylines, not both"));
        }
        self.lines.read(json, form, limits, &mut self.warnings)
    }

    /// Builds the curves, once everything is read.
    fn lines(mut self, form: CurveForm) -> Result<ReadOutcome, ReadError> {
        if self.surfaces.is_some() {
            return Err(surfaces::mixed(form.list()));
        }
        if self.has_patches {
            let message = format!("a file holds patches or {}, not both", form.list());
            return Err(ReadError::new("mixed-shapes", FileLocation::File, message));
        }
        if let Some(points) = self.points {
            self.warnings.count_all("isolated-points", points.len() as u64, UNUSED);
        }
        let mut content = self.lines.content(form, self.frame)?;
        let certificate = self.report.as_ref().and_then(|report| report.get("certificate")).cloned();
        match &mut content {
            Content::Drawing(drawing) => drawing.certificate = certificate,
            Content::Curves(curves) => curves.certificate = certificate,
            Content::Patches(..)
            | Content::Surfaces(..)
            | Content::Scene(_)
            | Content::Polygons(_)
            | Content::Field { .. }
            | Content::Volume(_) => {}
        }
        Ok(ReadOutcome { content, warnings: self.warnings.into_list() })
    }

    fn patch(&mut self, json: &mut JsonReader) -> Result<(), ReadError> {
        let mut indices = [0; 16];
        let mut control = [[[0.0; 3]; 4]; 4];
        let mut is_indices = false;
        let n = json.array(|json, i| {
            if json.peek()? == JsonKind::Number {
                is_indices = true;
                let index = index(json)?;
                set(&mut indices, i, index);
                return Ok(());
            }
            if is_indices {
                return Err(json.error("wrong-type", "an index should stand here"));
            }
            let row = row(json)?;
            set(&mut control, i, row);
            Ok(())
        })?;
        match (is_indices, n) {
            (true, 16) => push(&mut self.by_index, indices)?,
            (false, 4) => push(&mut self.by_value, Patch { control })?,
            (true, n) => return Err(width(json, n, "indices", 16)),
            (false, n) => return Err(width(json, n, "rows", 4)),
        }
        if !self.by_index.is_empty() && !self.by_value.is_empty() {
            return Err(json.error("mixed-forms", "patches are all given by points or all by indices"));
        }
        Ok(())
    }

    fn patches(&mut self) -> Result<Vec<Patch>, ReadError> {
        if !self.has_patches {
            return Err(ReadError::new(
                "no-shapes",
                FileLocation::File,
                "the object has no member \"patches\", \"surfaces\", \"curves\" or \"polylines\"",
            ));
        }
        let points = self.points.take();
        if self.by_index.is_empty() {
            if let Some(points) = points {
                self.warnings.count_all("isolated-points", points.len() as u64, UNUSED);
            }
            return Ok(std::mem::take(&mut self.by_value));
        }
        let Some(points) = points else {
            let message = "patches are given by indices, but the object has no member \"points\"";
            return Err(ReadError::new("no-points", FileLocation::File, message));
        };
        let mut used = vec![false; points.len()];
        let mut patches = with_room(self.by_index.len())?;
        for (row, indices) in self.by_index.iter().enumerate() {
            let mut control = [[[0.0; 3]; 4]; 4];
            for (i, slot) in control.as_flattened_mut().iter_mut().enumerate() {
                *slot = *points.get(indices[i] as usize).ok_or_else(|| {
                    let n = grouped(points.len() as u64);
                    let message =
                        format!("index {} is out of range: there are {n} points, from 0", indices[i]);
                    ReadError::new(
                        "index-out-of-range",
                        FileLocation::Pointer(format!("/patches/{row}/{i}")),
                        message,
                    )
                })?;
                used[indices[i] as usize] = true;
            }
            patches.push(Patch { control });
        }
        let unused = used.iter().filter(|u| !**u).count() as u64;
        self.warnings.count_all("isolated-points", unused, UNUSED);
        Ok(patches)
    }
}

/// Sets an item if the list is long enough. A list that is too long is reported after all of it was counted.
fn set<T>(list: &mut [T], i: u64, item: T) {
    if let Some(slot) = list.get_mut(i as usize) {
        *slot = item;
    }
}

fn check_rows(json: &JsonReader, what: &str, row: u64, limits: &Limits) -> Result<(), ReadError> {
    if row >= limits.rows { Err(too_many_rows(json.place(), what, row + 1, limits.rows)) } else { Ok(()) }
}

fn width(json: &JsonReader, actual: u64, what: &str, needed: u64) -> ReadError {
    json.error("wrong-width", format!("{actual} {what} where {needed} are needed"))
}

fn index(json: &mut JsonReader) -> Result<u32, ReadError> {
    let value = json.number()?;
    if value < 0.0 || value.fract() != 0.0 || value > f64::from(u32::MAX) {
        let message = format!("{value} is not an index: a whole number from 0 to {}", u32::MAX);
        return Err(json.error("not-an-index", message));
    }
    Ok(value as u32)
}

fn point(json: &mut JsonReader) -> Result<[f64; 3], ReadError> {
    let mut point = [0.0; 3];
    let n = json.array(|json, i| {
        let value = json.number()?;
        set(&mut point, i, value);
        Ok(())
    })?;
    if n == 3 { Ok(point) } else { Err(width(json, n, "numbers", 3)) }
}

fn row(json: &mut JsonReader) -> Result<[[f64; 3]; 4], ReadError> {
    let mut row = [[0.0; 3]; 4];
    let n = json.array(|json, i| {
        let point = point(json)?;
        set(&mut row, i, point);
        Ok(())
    })?;
    if n == 4 { Ok(row) } else { Err(width(json, n, "points", 4)) }
}
