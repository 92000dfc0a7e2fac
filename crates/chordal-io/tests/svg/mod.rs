//! SVG files: what they draw, what they may not do, and what is written of them.
mod hostile;
mod paths;
mod round_trip;
mod shapes;
mod structure;

use chordal::explicit::{Arc, Bezier, Curve, CurveSegment};
use chordal_io::{Content, Drawing, Format, Limits, ReadOutcome, Warning, read};

/// What a file draws, with its warnings.
#[track_caller]
fn load(text: &str) -> (Drawing, Vec<Warning>) {
    match read(text.as_bytes(), Format::Svg, &Limits::default()) {
        Ok(ReadOutcome { content: Content::Drawing(drawing), warnings }) => (drawing, warnings),
        Ok(other) => panic!("no drawing: {other:?}"),
        Err(error) => panic!("{error}"),
    }
}

/// What stands inside a root, without a word of warning.
#[track_caller]
fn inside(body: &str) -> Drawing {
    let (drawing, warnings) = load(&svg(body));
    assert!(warnings.is_empty(), "{warnings:?}");
    drawing
}

fn svg(body: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\">{body}</svg>"
    )
}

/// The curves of one path.
#[track_caller]
fn path(d: &str) -> Vec<Curve<2>> {
    inside(&format!("<path d=\"{d}\"/>")).lines
}

/// The pieces of the only subpath of one path.
#[track_caller]
fn pieces(d: &str) -> Vec<CurveSegment<2>> {
    let mut all = path(d);
    assert_eq!(all.len(), 1, "{all:?}");
    all.remove(0).segments().to_vec()
}

fn line(a: [f64; 2], b: [f64; 2]) -> CurveSegment<2> {
    CurveSegment::Line([a, b])
}

fn cubic(control: [[f64; 2]; 4]) -> CurveSegment<2> {
    CurveSegment::Cubic(Bezier { control })
}

#[track_caller]
fn arc(piece: &CurveSegment<2>) -> &Arc<2> {
    match piece {
        CurveSegment::Arc(arc) => arc,
        other => panic!("no arc: {other:?}"),
    }
}

#[track_caller]
fn near(a: [f64; 2], b: [f64; 2]) {
    let off = (0..2).map(|k| (a[k] - b[k]).abs()).fold(0.0, f64::max);
    assert!(off <= 1e-12, "{a:?} {b:?}");
}

/// How often a warning was counted.
fn count(warnings: &[Warning], code: &str) -> u64 {
    warnings.iter().filter(|w| w.code == code).map(|w| w.count).sum()
}
