//! Polylines as JSON, after `docs/schema/polylines.schema.json`.
use crate::WriteError;
use crate::drawing::{PathSet, Polylines};
use crate::number::ShortestDecimal;
use chordal::explicit::Polyline;
use serde_json::{Value, json};
use std::io::Write;

/// The schema of the report in the file.
const SCHEMA: &str = "chordal.report/1";

/// Writes `{"polylines": [{"points": [[x, y], …], "closed": false, "source": 0}, …], "report": {…}}`, one
/// polyline on each line, with the fewest digits that read back to the same bits.
///
/// # Errors
/// If the sink fails, or a number is not finite.
pub fn write(
    polylines: &Polylines,
    certificate: Option<&Value>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    out.write_all(b"{\"polylines\": [")?;
    match polylines {
        Polylines::Plane(drawn) => write_lines(drawn, out)?,
        Polylines::Space(drawn) => write_lines(drawn, out)?,
    }
    out.write_all(b"]")?;
    if let Some(certificate) = certificate {
        let report = json!({ "schema": SCHEMA, "certificate": certificate });
        write!(out, ", \"report\":\n{report}")?;
    }
    out.write_all(b"}\n")?;
    Ok(())
}

fn write_lines<const D: usize>(drawn: &PathSet<Polyline<D>>, out: &mut dyn Write) -> Result<(), WriteError> {
    for (i, line) in drawn.lines.iter().enumerate() {
        if line.points.as_flattened().iter().any(|x| !x.is_finite()) {
            return Err(WriteError::Unsupported(format!("polyline {i} has a number that is not finite")));
        }
        out.write_all(if i == 0 { b"\n{\"points\": [" } else { b",\n{\"points\": [" })?;
        for (j, point) in line.points.iter().enumerate() {
            out.write_all(if j == 0 { b"[" } else { b", [" })?;
            for (k, x) in point.iter().enumerate() {
                write!(out, "{}{}", if k == 0 { "" } else { ", " }, ShortestDecimal(*x))?;
            }
            out.write_all(b"]")?;
        }
        let source = drawn.element_of(i).map_or(i as u64, |element| element.source);
        write!(out, "], \"closed\": {}, \"source\": {source}}}", line.closed)?;
    }
    Ok(())
}
