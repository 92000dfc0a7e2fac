//! Curves and polylines in JSON, in the plane or in space.
use super::spline_numbers::{numbers, whole_degree};
use super::{check_rows, set, width};
use crate::drawing::{DrawingElement, PathSet};
use crate::grow::{push, with_room};
use crate::json::{JsonKind, JsonReader};
use crate::text::{grouped, show};
use crate::warnings::Warnings;
use crate::{Content, FileLocation, Frame, Limits, ReadError};
use chordal::explicit::nurbs::{KnotVector, NurbsCurve};
use chordal::explicit::{Bezier, Curve, CurveSegment, FillRule};

/// The list that a line belongs to, and the interpretation of its points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CurveForm {
    /// 3n + 1 control points of n cubics.
    Curves,
    /// Points joined by straight segments.
    Polylines,
}

impl CurveForm {
    pub fn list(self) -> &'static str {
        match self {
            Self::Curves => "curves",
            Self::Polylines => "polylines",
        }
    }

    fn points(self) -> &'static str {
        match self {
            Self::Curves => "control",
            Self::Polylines => "points",
        }
    }

    fn kind(self) -> &'static str {
        match self {
            Self::Curves => "curve",
            Self::Polylines => "polyline",
        }
    }
}

/// One line of the file.
#[derive(Debug, Default)]
struct CurveEntry {
    /// The index of its first point in the list of all points.
    first: usize,
    n: usize,
    closed: bool,
    source: Option<u64>,
    rule: FillRule,
    name: String,
    spline: SplineEntry,
}

/// The degree, the knots and the weights of a curve, if they are given.
#[derive(Debug, Default)]
struct SplineEntry {
    degree: Option<f64>,
    knots: Option<Vec<f64>>,
    weights: Option<Vec<f64>>,
}

impl SplineEntry {
    fn is_given(&self) -> bool {
        self.degree.is_some() || self.knots.is_some() || self.weights.is_some()
    }

    /// The path of a spline with these control points.
    fn path<const D: usize>(&self, control: Vec<[f64; D]>) -> Result<Curve<D>, InvalidCurveEntry> {
        let degree = whole_degree(self.degree.unwrap_or(CUBIC)).map_err(InvalidCurveEntry)?;
        let knots = match &self.knots {
            Some(knots) => KnotVector::new(degree, knots.clone()),
            None => KnotVector::clamped(degree, control.len()),
        };
        let weights = self.weights.clone().unwrap_or_else(|| vec![1.0; control.len()]);
        let spline = knots.and_then(|knots| NurbsCurve::new(knots, control, weights));
        Ok(spline.map_err(|error| InvalidCurveEntry(error.to_string()))?.to_curve()?)
    }
}

/// The default degree of a spline. Chosen: what most programs draw.
const CUBIC: f64 = 3.0;

/// All lines of a file. Their points are in one list, with `dimension` numbers each.
#[derive(Debug, Default)]
pub(super) struct CurveList {
    pub form: Option<CurveForm>,
    numbers: Vec<f64>,
    lines: Vec<CurveEntry>,
    dimension: usize,
}

impl CurveList {
    /// Reads the list of lines.
    pub fn read(
        &mut self,
        json: &mut JsonReader,
        form: CurveForm,
        limits: &Limits,
        warnings: &mut Warnings,
    ) -> Result<(), ReadError> {
        self.form = Some(form);
        json.array(|json, row| {
            check_rows(json, form.list(), row, limits)?;
            self.line(json, form, limits, warnings)
        })?;
        Ok(())
    }

    fn line(
        &mut self,
        json: &mut JsonReader,
        form: CurveForm,
        limits: &Limits,
        warnings: &mut Warnings,
    ) -> Result<(), ReadError> {
        let mut line = CurveEntry { first: self.numbers.len(), ..CurveEntry::default() };
        let mut has_points = false;
        json.object(|json, key| {
            match key {
                _ if key == form.points() => {
                    has_points = true;
                    line.n = self.points(json, limits)?;
                }
                "degree" if form == CurveForm::Curves => line.spline.degree = Some(json.number()?),
                "knots" if form == CurveForm::Curves => line.spline.knots = Some(numbers(json, limits)?),
                "weights" if form == CurveForm::Curves => line.spline.weights = Some(numbers(json, limits)?),
                "closed" => line.closed = json.flag()?,
                "source" => line.source = Some(integer(json)?),
                "name" => line.name = json.string()?,
                "rule" => {
                    let word = json.string()?;
                    line.rule = match word.as_str() {
                        "nonzero" => FillRule::NonZero,
                        "evenodd" => FillRule::EvenOdd,
                        _ => return Err(json.error("wrong-value", "rule is \"nonzero\" or \"evenodd\"")),
                    };
                }
                _ => {
                    super::unknown(json, key, warnings);
                    json.skip()?;
                }
            }
            Ok(())
        })?;
        if !has_points {
            return Err(json.error("no-points", format!("there is no member \"{}\"", form.points())));
        }
        let n = line.n;
        let is_chain = form == CurveForm::Curves && !line.spline.is_given();
        if is_chain && n % 3 != 1 {
            let message = format!(
                "{} control points, which is not 3n + 1: each cubic takes three more",
                grouped(n as u64)
            );
            return Err(json.error("wrong-width", message));
        }
        if n == 0 {
            return Err(json.error("no-points", "a polyline needs a point"));
        }
        if is_chain && line.closed && self.at(&line, 0) != self.at(&line, n - 1) {
            return Err(json.error("not-closed", "a closed curve ends with the point that it starts with"));
        }
        push(&mut self.lines, line)
    }

    fn points(&mut self, json: &mut JsonReader, limits: &Limits) -> Result<usize, ReadError> {
        let n = json.array(|json, row| {
            check_rows(json, "points", row, limits)?;
            let mut point = [0.0; 3];
            let n_numbers = json.array(|json, i| {
                let value = json.number()?;
                set(&mut point, i, value);
                Ok(())
            })?;
            if self.dimension == 0 && matches!(n_numbers, 2 | 3) {
                self.dimension = n_numbers as usize;
            }
            if n_numbers != self.dimension as u64 {
                return Err(match self.dimension {
                    0 => json.error("wrong-width", format!("{n_numbers} numbers where 2 or 3 are needed")),
                    needed => width(json, n_numbers, "numbers", needed as u64),
                });
            }
            point[..self.dimension].iter().try_for_each(|x| push(&mut self.numbers, *x))
        })?;
        Ok(n as usize)
    }

    fn at(&self, line: &CurveEntry, point: usize) -> &[f64] {
        let start = line.first + point * self.dimension;
        &self.numbers[start..start + self.dimension]
    }

    /// Builds the drawing, or the curves in space.
    pub fn content(self, form: CurveForm, frame: Frame) -> Result<Content, ReadError> {
        if self.dimension == 3 {
            return Ok(Content::Curves(self.path_set(form, frame)?));
        }
        Ok(Content::Drawing(self.path_set(form, frame)?))
    }

    fn path_set<const D: usize>(self, form: CurveForm, frame: Frame) -> Result<PathSet<Curve<D>>, ReadError> {
        let mut drawn = PathSet { frame, ..PathSet::default() };
        let mut before = None;
        for (index, line) in self.lines.iter().enumerate() {
            let curve = self.curve(line, form).map_err(|error| {
                ReadError::new(
                    if line.spline.is_given() { "invalid-spline" } else { "not-finite" },
                    FileLocation::Pointer(format!("/{}/{index}", form.list())),
                    error.to_string(),
                )
            })?;
            // Consecutive lines with the same source are one element, so that its holes are known.
            if line.source.is_none() || line.source != before {
                let element = DrawingElement {
                    kind: form.kind(),
                    name: line.name.as_str().into(),
                    source: line.source.unwrap_or(drawn.elements.len() as u64),
                    rule: line.rule,
                    filled: true,
                };
                push(&mut drawn.elements, element)?;
            }
            before = line.source;
            push(&mut drawn.owners, drawn.elements.len() as u32 - 1)?;
            push(&mut drawn.lines, curve)?;
        }
        Ok(drawn)
    }

    fn curve<const D: usize>(
        &self,
        line: &CurveEntry,
        form: CurveForm,
    ) -> Result<Curve<D>, InvalidCurveEntry> {
        let point = |i: usize| -> [f64; D] {
            let coordinates = self.at(line, i);
            std::array::from_fn(|k| coordinates.get(k).copied().unwrap_or(0.0))
        };
        if line.spline.is_given() {
            let path = line.spline.path((0..line.n).map(point).collect())?;
            if line.closed && !path.is_closed() {
                return Err(InvalidCurveEntry(
                    "the spline does not end where it starts, and closed is true".into(),
                ));
            }
            return Ok(path);
        }
        if line.n == 1 {
            return Ok(Curve::point(point(0))?);
        }
        let mut pieces = with_room(line.n)?;
        match form {
            CurveForm::Curves => {
                let cubic = |i| {
                    CurveSegment::Cubic(Bezier {
                        control: [point(i), point(i + 1), point(i + 2), point(i + 3)],
                    })
                };
                pieces.extend((0..line.n - 1).step_by(3).map(cubic));
            }
            CurveForm::Polylines => {
                pieces.extend((1..line.n).map(|i| CurveSegment::Line([point(i - 1), point(i)])));
                if line.closed && point(line.n - 1) != point(0) {
                    pieces.push(CurveSegment::Line([point(line.n - 1), point(0)]));
                }
            }
        }
        Ok(Curve::new(pieces, line.closed.into())?)
    }
}

/// Why the numbers are not a curve. It cannot occur for a chain of cubics, whose points were checked to be
/// finite.
#[derive(Debug)]
struct InvalidCurveEntry(String);

impl std::fmt::Display for InvalidCurveEntry {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl From<chordal::explicit::InvalidCurve> for InvalidCurveEntry {
    fn from(error: chordal::explicit::InvalidCurve) -> Self {
        Self(error.to_string())
    }
}

impl From<ReadError> for InvalidCurveEntry {
    fn from(error: ReadError) -> Self {
        Self(error.to_string())
    }
}

fn integer(json: &mut JsonReader) -> Result<u64, ReadError> {
    if json.peek()? != JsonKind::Number {
        return Err(json.error("wrong-type", "a whole number should stand here"));
    }
    let value = json.number()?;
    // 2^53: beyond it, neighbouring integers have the same value.
    if value < 0.0 || value.fract() != 0.0 || value > 9_007_199_254_740_992.0 {
        let message = format!("{} is not a whole number from 0 on", show(value.to_string().as_bytes()));
        return Err(json.error("wrong-value", message));
    }
    Ok(value as u64)
}
