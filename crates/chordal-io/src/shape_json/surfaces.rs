//! NURBS surfaces in JSON.
use super::constructions::{CONSTRUCTIONS, construction};
use super::spline_numbers::{numbers, whole_degree};
use super::trim::trim_loops;
use super::{check_rows, point, width};
use crate::ReadError;
use crate::grow::push;
use crate::json::{JsonKind, JsonReader};
use crate::warnings::Warnings;
use crate::{FileLocation, Limits};
use chordal::explicit::nurbs::{KnotVector, NurbsSurface, TrimmedSurface};

/// Reads one surface: its degrees, knots, rows of control points and weights, or its construction from
/// curves; and its trimming loops.
pub(super) fn surface(
    json: &mut JsonReader,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<TrimmedSurface, ReadError> {
    let (mut degrees, mut knots) = (None, None);
    let (mut control, mut row_lengths) = (Vec::new(), Vec::new());
    let mut weights: Option<Vec<Vec<f64>>> = None;
    let (mut loops, mut is_flipped) = (Vec::new(), false);
    let mut constructed: Option<(String, NurbsSurface)> = None;
    let place = json.place();
    json.object(|json, key| {
        match key {
            _ if CONSTRUCTIONS.contains(&key) => {
                if let Some((other, _)) = &constructed {
                    let message = format!("a surface has \"{other}\" or \"{key}\", not both");
                    return Err(json.error("mixed-forms", message));
                }
                constructed = Some((key.to_owned(), construction(json, key, limits, warnings)?));
            }
            "trim" => loops = trim_loops(json, limits, warnings)?,
            "flip" => is_flipped = json.flag()?,
            "degree" => degrees = Some(u_v_pair(json, |json| json.number())?),
            "knots" => knots = Some(u_v_pair(json, |json| numbers(json, limits))?),
            "control" => {
                json.array(|json, row| {
                    check_rows(json, "rows", row, limits)?;
                    let n = json.array(|json, i| {
                        check_rows(json, "points", i, limits)?;
                        push(&mut control, point(json)?)
                    })?;
                    push(&mut row_lengths, n)
                })?;
            }
            "weights" => {
                let mut rows = Vec::new();
                json.array(|json, row| {
                    check_rows(json, "rows", row, limits)?;
                    push(&mut rows, numbers(json, limits)?)
                })?;
                weights = Some(rows);
            }
            _ => {
                super::unknown(json, key, warnings);
                json.skip()?;
            }
        }
        Ok(())
    })?;
    let wrong = |message: String| ReadError::new("invalid-surface", place.clone(), message);
    let surface = match constructed {
        Some((name, surface)) => {
            if degrees.is_some() || knots.is_some() || weights.is_some() || !row_lengths.is_empty() {
                return Err(wrong(format!("a surface has \"{name}\" or control points, not both")));
            }
            surface
        }
        None => {
            let members = SurfaceMembers { degrees, knots, control, row_lengths, weights };
            members.surface(&wrong)?
        }
    };
    let trimmed = TrimmedSurface::new(surface, loops).map_err(|error| wrong(error.to_string()))?;
    Ok(if is_flipped { trimmed.flipped() } else { trimmed })
}

/// The members of a surface given by control points.
struct SurfaceMembers {
    degrees: Option<[f64; 2]>,
    knots: Option<[Vec<f64>; 2]>,
    control: Vec<[f64; 3]>,
    row_lengths: Vec<u64>,
    weights: Option<Vec<Vec<f64>>>,
}

impl SurfaceMembers {
    fn surface(self, wrong: &dyn Fn(String) -> ReadError) -> Result<NurbsSurface, ReadError> {
        let Self { degrees, knots, control, row_lengths, weights } = self;
        let missing = |name: &str| wrong(format!("there is no member \"{name}\""));
        let degrees = degrees.ok_or_else(|| {
            let names = CONSTRUCTIONS.map(|name| format!("\"{name}\"")).join(", ");
            wrong(format!("there is no member \"degree\", and none that constructs a surface ({names})"))
        })?;
        let knots = knots.ok_or_else(|| missing("knots"))?;
        if row_lengths.is_empty() {
            return Err(wrong("there is no member \"control\", or it is empty".to_owned()));
        }
        let mut vectors = Vec::new();
        for ((degree, knots), name) in degrees.into_iter().zip(knots).zip(["u", "v"]) {
            let along = |error: String| wrong(format!("along {name}: {error}"));
            let vector = KnotVector::new(whole_degree(degree).map_err(along)?, knots);
            vectors.push(vector.map_err(|error| along(error.to_string()))?);
        }
        let Ok(vectors) = <[KnotVector; 2]>::try_from(vectors) else { return Err(missing("knots")) };
        let needed = vectors[0].n_control() as u64;
        if let Some((row, n)) = row_lengths.iter().enumerate().find(|(_, n)| **n != needed) {
            return Err(wrong(format!(
                "row {row} has {n} control points where the knots along u need {needed}"
            )));
        }
        let weights = match weights {
            Some(rows) => {
                if let Some((row, n)) =
                    rows.iter().map(Vec::len).enumerate().find(|(_, n)| *n as u64 != needed)
                {
                    return Err(wrong(format!(
                        "row {row} has {n} weights where the knots along u need {needed}"
                    )));
                }
                rows.concat()
            }
            None => vec![1.0; control.len()],
        };
        NurbsSurface::new(vectors, control, weights).map_err(|error| wrong(error.to_string()))
    }
}

/// Two values, for `u` and for `v`.
fn u_v_pair<T>(
    json: &mut JsonReader,
    mut read: impl FnMut(&mut JsonReader) -> Result<T, ReadError>,
) -> Result<[T; 2], ReadError> {
    let mut values = Vec::new();
    if json.peek()? != JsonKind::Array {
        return Err(json.error("wrong-type", "two stand here, for u and for v"));
    }
    let n = json.array(|json, i| {
        let value = read(json)?;
        // More than two are only counted.
        if i < 2 { push(&mut values, value) } else { Ok(()) }
    })?;
    <[T; 2]>::try_from(values).ok().filter(|_| n == 2).ok_or_else(|| width(json, n, "values", 2))
}

/// The error for a file with surfaces and something else.
pub(super) fn mixed(other: &str) -> ReadError {
    ReadError::new("mixed-shapes", FileLocation::File, format!("a file holds surfaces or {other}, not both"))
}
