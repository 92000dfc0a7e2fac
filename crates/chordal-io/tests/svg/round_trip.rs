//! What is written reads back to the last bit.
use super::{inside, load};
use chordal::explicit::{CurveSegment, FillRule, Polyline};
use chordal_io::{Content, DrawingElement, Format, Frame, Limits, PathSet, Polylines, read, shape_json, svg};
use chordal_testkit::Random;
use chordal_testkit::corpus;
use serde_json::{Value, json};

/// Polylines of all kinds with numbers of all sizes.
fn polylines() -> PathSet<Polyline<2>> {
    let seed = 2026;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    let mut number = || (random.unit() - 0.5) * [1.0, 1e-9, 1e7, 1e-3][random.below(4)];
    let mut line = |n: usize, closed: bool| {
        let points = (0..n).map(|_| [number(), number()]).collect();
        Polyline { points, places: Vec::new(), closed }
    };
    let lines = vec![line(5, true), line(4, true), line(3, false), line(1, false), line(100, true)];
    let element = |name: &str, source, rule, filled| DrawingElement {
        kind: "path",
        name: name.into(),
        source,
        rule,
        filled,
    };
    PathSet {
        lines,
        owners: vec![0, 0, 1, 2, 3],
        elements: vec![
            element("a<&\">'\n", 0, FillRule::EvenOdd, true),
            element("", 1, FillRule::NonZero, false),
            element("b", 2, FillRule::NonZero, true),
            element("b", 3, FillRule::NonZero, true),
        ],
        view_box: Some([-1.0, -2.5, 3.0, 4.0]),
        frame: Frame { up: None, metres_per_unit: Some(0.001), ..Frame::default() },
        ..PathSet::default()
    }
}

fn certificate() -> Value {
    json!({ "bound": { "at_most": 0.1 }, "notes": ["<&>\"'", "]]>"] })
}

/// The corners of straight curves; a closed one's first is not repeated.
fn corners(content: &Content) -> Vec<(Vec<[f64; 2]>, bool)> {
    let Content::Drawing(drawing) = content else { panic!("no drawing") };
    let one = |curve: &chordal::explicit::Curve<2>| {
        assert!(curve.segments().iter().all(|piece| matches!(piece, CurveSegment::Line(_))));
        let mut points = vec![curve.start()];
        points.extend(curve.segments().iter().map(CurveSegment::end));
        if curve.is_closed() {
            points.pop();
        }
        (points, curve.is_closed())
    };
    drawing.lines.iter().map(one).collect()
}

#[test]
fn polylines_read_back_from_svg_and_json_to_the_last_bit() {
    let drawn = polylines();
    let expected: Vec<_> = drawn.lines.iter().map(|line| (line.points.clone(), line.closed)).collect();
    let (mut as_svg, mut as_json) = (Vec::new(), Vec::new());
    let all = Polylines::Plane(drawn);
    svg::write(&all, Some(&certificate()), &mut as_svg).unwrap();
    shape_json::write(&all, Some(&certificate()), &mut as_json).unwrap();
    for (bytes, format) in [(&as_svg, Format::Svg), (&as_json, Format::Json)] {
        assert_eq!(Format::sniff(bytes), Some(format));
        let loaded = read(bytes, format, &Limits::default()).unwrap();
        assert_eq!(corners(&loaded.content), expected, "{format}");
        let Content::Drawing(drawing) = loaded.content else { unreachable!() };
        assert_eq!(drawing.certificate, Some(certificate()), "{format}");
        assert_eq!(drawing.owners, [0, 0, 1, 2, 3], "{format}");
    }
    let (drawing, _) = load(std::str::from_utf8(&as_svg).unwrap());
    assert_eq!(drawing.view_box, Some([-1.0, -2.5, 3.0, 4.0]));
    assert!((drawing.frame.metres_per_unit.unwrap() - 0.001).abs() < 1e-15);
    let all: Vec<_> = drawing.elements.iter().map(|e| (&*e.name, e.rule, e.filled)).collect();
    // The second element of a name has none: an id is one element's.
    let (even, non) = (FillRule::EvenOdd, FillRule::NonZero);
    assert_eq!(all, [("a<&\">'\n", even, true), ("", non, false), ("b", non, true), ("", non, true)]);
}

#[test]
fn the_json_has_exactly_the_promised_form() {
    let mut bytes = Vec::new();
    let line = Polyline { points: vec![[0.1, -2.0], [1e-7, 3.0]], places: vec![0.0, 1.0], closed: false };
    let drawn = PathSet {
        lines: vec![line],
        owners: vec![0],
        elements: vec![DrawingElement::default()],
        ..PathSet::default()
    };
    shape_json::write(&Polylines::Plane(drawn), Some(&certificate()), &mut bytes).unwrap();
    let value: Value = serde_json::from_slice(&bytes).unwrap();
    let report = json!({ "schema": "chordal.report/1", "certificate": certificate() });
    let line = json!({ "points": [[0.1, -2], [1e-7, 3]], "closed": false, "source": 0 });
    assert_eq!(value["report"], report);
    assert_eq!(value["polylines"].to_string(), json!([line]).to_string());
    assert_eq!(value.as_object().unwrap().len(), 2);
    let mut empty = Vec::new();
    shape_json::write(&Polylines::Space(PathSet::default()), None, &mut empty).unwrap();
    assert_eq!(String::from_utf8(empty).unwrap(), "{\"polylines\": []}\n");
}

#[test]
fn polylines_in_space_go_to_json_and_not_to_svg() {
    let line = Polyline { points: vec![[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]], places: Vec::new(), closed: false };
    let drawn = PathSet {
        lines: vec![line],
        owners: vec![0],
        elements: vec![DrawingElement::default()],
        ..PathSet::default()
    };
    let all = Polylines::Space(drawn);
    assert!(svg::write(&all, None, &mut Vec::new()).unwrap_err().to_string().contains("plane"));
    let mut bytes = Vec::new();
    shape_json::write(&all, None, &mut bytes).unwrap();
    let loaded = read(&bytes, Format::Json, &Limits::default()).unwrap();
    let Content::Curves(curves) = loaded.content else { panic!("no curves") };
    assert_eq!(curves.lines[0].end(), [3.0, 4.0, 5.0]);
}

#[test]
fn files_of_the_collection_read_and_say_what_they_skip() {
    let Some(data) = corpus::find("") else { return };
    let files = corpus::files(&data);
    let drawings: Vec<_> = files.iter().filter(|path| path.extension().is_some_and(|e| e == "svg")).collect();
    if drawings.is_empty() {
        eprintln!("SKIPPED: there is no .svg in the test data");
    }
    for path in drawings {
        let bytes = std::fs::read(path).unwrap();
        let loaded = read(&bytes, Format::Svg, &Limits::default());
        assert!(loaded.is_ok(), "{}: {}", path.display(), loaded.unwrap_err());
    }
}

#[test]
fn the_example_draws_what_it_says() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/drawing.svg");
    let (drawing, warnings) = load(&std::fs::read_to_string(path).unwrap());
    assert_eq!((drawing.elements.len(), drawing.lines.len()), (11, 15));
    assert_eq!(warnings.iter().map(|w| (w.code, w.count)).collect::<Vec<_>>(), [("unsupported-stroke", 2)]);
    assert_eq!(drawing.frame.metres_per_unit, Some(0.001));
    assert_eq!(inside("<path d='M0 0h1'/>").view_box, None);
}
