//! NURBS curves and surfaces in JSON: what is read, and one sentence for what is wrong.
use chordal_io::{Content, Limits, shape_json};

const BILINEAR: &str = r#"{"degree": [1, 1], "knots": [[0, 0, 1, 1], [0, 0, 1, 1]],
    "control": [[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 1]]]}"#;

fn error(text: &str) -> String {
    shape_json::read(text.as_bytes(), &Limits::default()).map(|_| ()).unwrap_err().to_string()
}

#[test]
fn a_surface_is_read_with_its_weights() {
    let text = format!(r#"{{"up": "z", "surfaces": [{BILINEAR}]}}"#);
    let Content::Surfaces(surfaces, frame) =
        shape_json::read(text.as_bytes(), &Limits::default()).unwrap().content
    else {
        panic!("surfaces")
    };
    assert_eq!((surfaces.len(), frame.up), (1, Some(chordal_io::Axis::Z)));
    assert_eq!(surfaces[0].surface().at(1.0, 0.5), [1.0, 0.5, 0.5]);
    assert_eq!(surfaces[0].surface().weights(), [1.0; 4]);
    let weighted = text.replace("[1, 1, 1]]]}", "[1, 1, 1]]], \"weights\": [[1, 1], [1, 3]]}");
    let Content::Surfaces(surfaces, _) =
        shape_json::read(weighted.as_bytes(), &Limits::default()).unwrap().content
    else {
        panic!("surfaces")
    };
    assert_eq!(surfaces[0].surface().at(1.0, 0.5), [1.0, 0.75, 0.75]);
}

#[test]
fn what_is_wrong_with_a_surface_is_one_sentence_with_its_place() {
    let with =
        |from: &str, to: &str| error(&format!(r#"{{"surfaces": [{}]}}"#, BILINEAR.replacen(from, to, 1)));
    for (from, to, says) in [
        ("[0, 0, 1, 1]", "[0, 1, 0, 1]", "/surfaces/0: along u: knot 2 is less than the one before"),
        (
            "[0, 0, 1, 1]",
            "[0, 0, 0, 0]",
            "/surfaces/0: along u: the knots have no length: the first and the last parameter are equal",
        ),
        (
            "[0, 0, 1, 1]",
            "[0, 1, 1]",
            "/surfaces/0: along u: degree 1 needs 4 knots at least, and there are 3",
        ),
        (
            "[0, 0, 1, 1]",
            "[0, 0, 0.5, 1, 1]",
            "/surfaces/0: row 0 has 2 control points where the knots along u need 3",
        ),
        ("[1, 1],", "[0, 1],", "/surfaces/0: along u: the degree is 0, and must be from 1 to 30"),
        ("[1, 1],", "[1.5, 1],", "/surfaces/0: along u: the degree 1.5 is no whole number from 1 to 30"),
        (
            "\"degree\": [1, 1],",
            "",
            "/surfaces/0: there is no member \"degree\", and none that constructs a surface (\"loft\", \"coons\", \"sweep\", \"extrude\", \"revolve\", \"ruled\")",
        ),
        (
            "[1, 1, 1]]]",
            "[1, 1, 1]]], \"weights\": [[1, 1], [1, -1]]",
            "/surfaces/0: weight 3 is not above 0",
        ),
        (
            "[1, 1, 1]]]",
            "[1, 1, 1]]], \"weights\": [[1, 1]]",
            "/surfaces/0: 2 weights where the knots need 4",
        ),
        (
            "[1, 1, 1]]]",
            "[1, 1, 1]]], \"weights\": [[1, 1, 1], [1]]",
            "/surfaces/0: row 0 has 3 weights where the knots along u need 2",
        ),
    ] {
        assert_eq!(with(from, to), says, "{to}");
    }
    assert_eq!(
        error(&format!(r#"{{"surfaces": [{BILINEAR}], "curves": []}}"#)),
        "a file holds surfaces or curves, not both"
    );
}

#[test]
fn ruled_surfaces_count_what_fitting_their_curves_costs() {
    let slack = |from: f64| {
        let text = format!(
            r#"{{"surfaces": [{{"ruled": [
                {{"degree": 1, "knots": [{from}, {from}, {to}, {to}], "control": [[0, 0, 0], [1, 0, 0]]}},
                {{"degree": 1, "knots": [0, 0, 0.33, 1, 1], "control": [[0, 1, 0], [0.33, 1, 1], [1, 1, 0]]}}]}}]}}"#,
            to = from + 1.0
        );
        let content = shape_json::read(text.as_bytes(), &Limits::default()).unwrap().content;
        let Content::Surfaces(surfaces, _) = content else { panic!("surfaces") };
        surfaces[0].surface().slack()
    };
    // Of a third of a domain at 1e13 two units in the last place are 0.004.
    assert!(slack(0.0) < 1e-12, "{}", slack(0.0));
    assert!(slack(1e13) > 1e-3, "{}", slack(1e13));
}

#[test]
fn splines_are_read_beside_chains_of_cubics() {
    let text = r#"{"curves": [
        {"degree": 2, "knots": [0, 0, 0, 1, 1, 1], "control": [[1, 0], [1, 1], [0, 1]], "weights": [1, 0.5, 1]},
        {"degree": 5, "control": [[0, 0], [1, 0], [2, 0], [3, 0], [4, 0], [5, 0], [6, 1]]},
        {"control": [[0, 0], [1, 0], [2, 0], [3, 0]]}]}"#;
    let Content::Drawing(drawing) = shape_json::read(text.as_bytes(), &Limits::default()).unwrap().content
    else {
        panic!("a drawing")
    };
    let pieces: Vec<usize> = drawing.lines.iter().map(|line| line.segments().len()).collect();
    assert_eq!(pieces, [1, 2, 1]);
    assert_eq!(drawing.lines[0].at(0.5), [2.0 / 3.0, 2.0 / 3.0]);
    let repeated = r#"{"curves": [{"degree": 1, "knots": [0, 0, 1, 1, 2, 2], "control": [[0, 0], [1, 0], [2, 0], [3, 0]]}]}"#;
    assert_eq!(
        error(repeated),
        "/curves/0: knot 2 occurs more often than the degree 1, so that the curve would jump there: split it in two"
    );
}

#[test]
fn loops_that_trim_are_read_with_their_gaps() {
    // A triangle of two curves that miss each other by rounding, and a round hole.
    let loops = r#""trim": [[{"control": [[0.1, 0.1], [0.9, 0.1], [0.9, 0.9]]}, {"control": [[0.9, 0.9000001], [0.1, 0.1]]}],
        [{"degree": 2, "control": [[0.7, 0.3], [0.75, 0.35], [0.7, 0.4]]}, {"control": [[0.7, 0.4], [0.7, 0.3]]}]],
        "flip": true"#;
    let with = |loops: &str| {
        let surface = BILINEAR.replace("[1, 1, 1]]]}", &format!("[1, 1, 1]]], {loops}}}"));
        format!(r#"{{"surfaces": [{surface}]}}"#)
    };
    let read = shape_json::read(with(loops).as_bytes(), &Limits::default()).unwrap();
    let Content::Surfaces(faces, _) = read.content else { panic!("surfaces") };
    assert!(read.warnings.is_empty() && faces[0].is_flipped());
    let pieces: Vec<usize> = faces[0].loops().iter().map(|path| path.segments().len()).collect();
    assert_eq!(pieces, [4, 2]);
    for (loops, says) in [
        (r#""trim": [[]]"#, "/surfaces/0/trim/0: a trim loop needs a curve"),
        (
            r#""trim": [[{"control": [[0, 0], [1, 0], [1, 1]]}]]"#,
            "/surfaces/0/trim/0: curve 0 of a trim loop does not start where the one before it ends: there are 1e0 between",
        ),
        (
            r#""trim": [[{"control": [[0, 0]]}]]"#,
            "/surfaces/0/trim/0/0: degree 1 needs 2 control points at least, and there are 1",
        ),
        (
            r#""trim": [[{"control": [[0, 0], [1, 0, 0]]}]]"#,
            "/surfaces/0/trim/0/0/control/1: 3 numbers where 2 are needed",
        ),
        (
            r#""trim": [[{"degree": 1, "knots": [0, 1, 0, 1], "control": [[0, 0], [1, 0]]}]]"#,
            "/surfaces/0/trim/0/0: knot 2 is less than the one before",
        ),
        (
            r#""trim": [[{"control": [[5, 5], [6, 5], [6, 6], [5, 5]]}]]"#,
            "/surfaces/0: trim loop 0 leaves the range of the surface's parameters by more than half of it",
        ),
    ] {
        assert_eq!(error(&with(loops)), says);
    }
}
