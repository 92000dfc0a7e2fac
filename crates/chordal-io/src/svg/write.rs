//! Writes polylines as an SVG file: one path for each element, with a subpath for each polyline.
use super::CERTIFICATE;
use crate::WriteError;
use crate::drawing::{DrawingElement, Polylines};
use crate::number::ShortestDecimal;
use crate::xml_text::{CERTIFICATE_NAMESPACE, escaped};
use chordal::explicit::{FillRule, Polyline};
use chordal::math::{greater, lesser};
use serde_json::Value;
use std::collections::BTreeSet;
use std::io::Write;

/// Writes polylines with all digits that they need to read back to the same bits. Filled elements are filled,
/// all others are thin lines. The certificate is in `metadata`.
///
/// # Errors
/// When the sink fails, or the polylines are in space.
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
    let [x, y, w, h] = drawn.view_box.unwrap_or_else(|| bounds(&drawn.lines)).map(ShortestDecimal);
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
    // An id must be unique; copies that `use` made have the same.
    let mut named = BTreeSet::new();
    for (element, lines) in drawn.groups() {
        let id = named.insert(&element.name).then_some(&*element.name).filter(|id| !id.is_empty());
        path(element, id, lines, out)?;
    }
    out.write_all(b"</svg>\n")?;
    Ok(())
}

fn path(
    element: &DrawingElement,
    id: Option<&str>,
    lines: &[Polyline<2>],
    out: &mut dyn Write,
) -> Result<(), WriteError> {
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
    for line in lines {
        for (i, [x, y]) in line.points.iter().enumerate() {
            let command = match i {
                0 => "M",
                1 => "L",
                _ => " ",
            };
            write!(out, "{command}{} {}", ShortestDecimal(*x), ShortestDecimal(*y))?;
        }
        // A single point is drawn by closing it.
        if line.closed || line.points.len() == 1 {
            out.write_all(b"Z")?;
        }
    }
    out.write_all(b"\"/>\n")?;
    Ok(())
}

/// A box around all points, of positive size even where they have none.
fn bounds(lines: &[Polyline<2>]) -> [f64; 4] {
    let mut points = lines.iter().flat_map(|line| &line.points);
    let Some(first) = points.next() else { return [0.0, 0.0, 1.0, 1.0] };
    let (mut low, mut high) = (*first, *first);
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
