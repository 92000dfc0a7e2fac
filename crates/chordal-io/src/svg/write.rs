//! Writes polylines, and paths of lines and cubics, as an SVG file: one path for each element, with a subpath
//! for each of its lines.
use super::CERTIFICATE;
use crate::WriteError;
use crate::drawing::{Drawing, DrawingElement, PathSet, Polylines};
use crate::number::ShortestDecimal;
use crate::xml_text::{CERTIFICATE_NAMESPACE, escaped};
use chordal::explicit::{Curve, CurveSegment, FillRule, Polyline};
use chordal::math::{greater, lesser};
use serde_json::Value;
use std::collections::BTreeSet;
use std::io::Write;

/// Writes polylines with enough digits to read back to the same bits. Filled elements are filled, all others
/// are thin lines. The certificate is in `metadata`.
///
/// # Errors
/// If the sink fails, or the polylines are in space.
pub fn write(
    polylines: &Polylines,
    certificate: Option<&Value>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let Polylines::Plane(drawn) = polylines else {
        return Err(WriteError::Unsupported(
            "svg holds the plane only; json holds polylines in space".to_owned(),
        ));
    };
    document(
        drawn,
        bounds(drawn.lines.iter().flat_map(|line| &line.points).copied()),
        certificate,
        out,
        polyline,
    )
}

/// Writes paths of lines and cubics as [`write`] does polylines, with all digits.
///
/// # Errors
/// If the sink fails, or a path has a piece that SVG cannot hold exactly: an arc or a rational one.
pub fn write_paths(
    drawing: &Drawing,
    certificate: Option<&Value>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let corners = drawing.lines.iter().flat_map(|line| line.bounds());
    document(drawing, bounds(corners), certificate, out, path_data)
}

/// A function that writes the `d` of one line.
type LineWriter<T> = fn(&T, &mut dyn Write) -> Result<(), WriteError>;

fn document<T>(
    drawn: &PathSet<T>,
    bounds: [f64; 4],
    certificate: Option<&Value>,
    out: &mut dyn Write,
    line: LineWriter<T>,
) -> Result<(), WriteError> {
    let [x, y, w, h] = drawn.view_box.unwrap_or(bounds).map(ShortestDecimal);
    write!(out, "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{x} {y} {w} {h}\"")?;
    if let Some(metres) = drawn.frame.metres_per_unit {
        let mm = |size: ShortestDecimal| ShortestDecimal(size.0 * metres * 1000.0);
        write!(out, " width=\"{}mm\" height=\"{}mm\"", mm(w), mm(h))?;
    }
    out.write_all(b">\n")?;
    if let Some(certificate) = certificate {
        let text = escaped(&certificate.to_string());
        writeln!(
            out,
            "<metadata><{CERTIFICATE} xmlns:chordal=\"{CERTIFICATE_NAMESPACE}\">{text}</{CERTIFICATE}></metadata>"
        )?;
    }
    // An id must be unique, but copies by `use` share theirs.
    let mut named = BTreeSet::new();
    for (element, lines) in drawn.groups() {
        let id = named.insert(&element.name).then_some(&*element.name).filter(|id| !id.is_empty());
        path(element, id, out)?;
        for one in lines {
            line(one, out)?;
        }
        out.write_all(b"\"/>\n")?;
    }
    out.write_all(b"</svg>\n")?;
    Ok(())
}

/// The start of a path, up to its data.
fn path(element: &DrawingElement, id: Option<&str>, out: &mut dyn Write) -> Result<(), WriteError> {
    out.write_all(b"<path")?;
    if let Some(id) = id {
        write!(out, " id=\"{}\"", escaped(id))?;
    }
    if !element.filled {
        out.write_all(b" fill=\"none\" stroke=\"black\" vector-effect=\"non-scaling-stroke\"")?;
    } else if element.rule == FillRule::EvenOdd {
        out.write_all(b" fill-rule=\"evenodd\"")?;
    }
    out.write_all(b" d=\"")?;
    Ok(())
}

fn polyline(line: &Polyline<2>, out: &mut dyn Write) -> Result<(), WriteError> {
    for (i, point) in line.points.iter().enumerate() {
        let command = match i {
            0 => "M",
            1 => "L",
            _ => " ",
        };
        write_points(command, &[*point], out)?;
    }
    // A closed path draws a dot for a single point.
    if line.closed || line.points.len() == 1 {
        out.write_all(b"Z")?;
    }
    Ok(())
}

fn path_data(curve: &Curve<2>, out: &mut dyn Write) -> Result<(), WriteError> {
    write_points("M", &[curve.start()], out)?;
    let last = curve.segments().len().saturating_sub(1);
    for (index, piece) in curve.segments().iter().enumerate() {
        match piece {
            // Closing the path draws its last line.
            CurveSegment::Line(_) if curve.is_closed() && index == last => {}
            CurveSegment::Line([_, end]) => write_points("L", &[*end], out)?,
            CurveSegment::Cubic(cubic) => write_points("C", &cubic.control[1..], out)?,
            CurveSegment::Arc(_) | CurveSegment::Rational(_) => {
                let what = "svg holds lines and cubics to the last digit, and no arcs and rational curves";
                return Err(WriteError::Unsupported(what.to_owned()));
            }
        }
    }
    if curve.is_closed() || curve.segments().is_empty() {
        out.write_all(b"Z")?;
    }
    Ok(())
}

fn write_points(command: &str, points: &[[f64; 2]], out: &mut dyn Write) -> Result<(), WriteError> {
    for (index, [x, y]) in points.iter().enumerate() {
        let before = if index == 0 { command } else { " " };
        write!(out, "{before}{} {}", ShortestDecimal(*x), ShortestDecimal(*y))?;
    }
    Ok(())
}

/// A box around all points, of positive size even if the points have none.
fn bounds(mut points: impl Iterator<Item = [f64; 2]>) -> [f64; 4] {
    let Some(first) = points.next() else { return [0.0, 0.0, 1.0, 1.0] };
    let (mut low, mut high) = (first, first);
    for p in points {
        for k in 0..2 {
            low[k] = lesser(p[k], low[k]);
            high[k] = greater(p[k], high[k]);
        }
    }
    let [w, h] = [0, 1].map(|k| {
        let size = high[k] - low[k];
        if size > 0.0 && size.is_finite() { size } else { 1.0 }
    });
    [low[0], low[1], w, h]
}
