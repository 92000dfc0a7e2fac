//! Texts that lie, each with its one error.
use super::{TRIANGLE, codes, error, file, scene, triangle};
use chordal_io::{Limits, usd};

#[test]
fn a_text_that_is_cut_off_says_where_it_ends() {
    assert_eq!(
        error("#usda 1.0\ndef Mesh \"m\" {\n point3f[] points = [(0, 0, 0),\n"),
        "truncated at line 3"
    );
    assert_eq!(error("#usda 1.0\ndef Mesh \"m"), "truncated at line 2");
    assert_eq!(error("#usda 1.0\n/* def"), "truncated at line 2");
    assert_eq!(error("#usda 1.0\ndef \"m\" (references = @a"), "truncated at line 2");
    assert_eq!(error("#usda 1.0\ndef \"m\" (references = <a"), "truncated at line 2");
    assert_eq!(error("#usda 1.0\ndef \"m\" { custom int[] a = [1, 2"), "truncated at line 2");
    assert_eq!(error("#usda 1.0\ndef \"m\" { custom string a = \"x\ny\" }"), "syntax at line 2");
}

#[test]
fn a_text_that_is_no_usd_says_what_stands_there() {
    assert_eq!(error("#usda 1.0\nfoo"), "syntax at line 2");
    assert_eq!(error("#usda 1.0\ndef Mesh m {}"), "syntax at line 2");
    assert_eq!(
        error("#usda 1.0\ndef Mesh \"m\" {\n point3f[] points = [(0, 0)]\n}"),
        "wrong-count at line 3"
    );
    assert_eq!(
        error("#usda 1.0\ndef Mesh \"m\" {\n point3f[] points = [(0, 0, x)]\n}"),
        "not-a-number at line 3"
    );
    assert_eq!(error("#usda 1.0\ndef Mesh \"m\" {\n point3f[] points = [0, 0, 0]\n}"), "syntax at line 3");
    assert_eq!(error("#usda 1.0\ndef Mesh \"m\" {\n rel material:binding = 7\n}"), "syntax at line 3");
    assert_eq!(error("#usda 1.0\n( metersPerUnit = nan )"), "not-finite at line 2");
    let text = b"#usda 1.0\ndef Mesh \"\xff\" {}";
    assert_eq!(usd::read(text, &Limits::default()).unwrap_err().code, "not-utf8");
    assert_eq!(usd::read(b"#usda 1.0\n\0", &Limits::default()).unwrap_err().code, "not-text");
    assert_eq!(usd::read(b"solid", &Limits::default()).unwrap_err().code, "not-usd");
}

#[test]
fn nesting_ends_at_the_limit() {
    let deep =
        |open: &str, close: &str, n: usize| format!("#usda 1.0\n{}{}", open.repeat(n), close.repeat(n));
    assert!(error(&deep("def \"a\" {", "}", 100_000)).starts_with("too-deep at"));
    let value = format!(
        "#usda 1.0\ndef \"a\" {{ custom opaque x = {}{} }}",
        "[".repeat(100_000),
        "]".repeat(100_000)
    );
    assert!(error(&value).starts_with("too-deep at"));
    let set = "variantSet \"v\" = { \"a\" {";
    let sets = format!("#usda 1.0\ndef \"a\" {{ {}{} }}", set.repeat(50_000), "}}".repeat(50_000));
    assert!(error(&sets).starts_with("too-deep at"));
    assert_eq!(codes(&deep("def \"a\" {", "}", 120)), ["no-unit", "no-faces"]);
    let mesh = format!("#usda 1.0\n{}{}{}", "def Xform \"a\" {".repeat(120), triangle("m"), "}".repeat(120));
    assert_eq!(codes(&mesh), ["no-unit"]);
}

#[test]
fn numbers_of_a_mesh_that_do_not_fit_are_named() {
    let with = |from: &str, to: &str| error(&file(&triangle("m")).replace(from, to));
    assert_eq!(with("[0, 1, 2]", "[0, 1, 3]"), "index-out-of-range at faceVertexIndices 2");
    assert_eq!(with("[0, 1, 2]", "[0, 1, -1]"), "index-out-of-range at faceVertexIndices 2");
    assert_eq!(with("[0, 1, 2]", "[0, 1, 0.5]"), "index-out-of-range at faceVertexIndices 2");
    assert_eq!(with("[0, 1, 2]", "[0, 1]"), "count-mismatch at line 6");
    assert_eq!(with("[3]", "[4294967295]"), "bad-count at faceVertexCounts 0");
    assert_eq!(with("[3]", "[-3]"), "bad-count at faceVertexCounts 0");
    assert_eq!(with("(1, 0, 0)", "(1, inf, 0)"), "not-finite at points 1");
    assert_eq!(with("(1, 0, 0)", "(1e308, 0, 0), (-1e308, 0, 0)"), "extent-overflow at file");
    let drop = Limits { drop_nonfinite: true, ..Limits::default() };
    let text = file(&triangle("m")).replace("(1, 0, 0)", "(1, nan, 0)");
    let found: Vec<_> = usd::read(text.as_bytes(), &drop).unwrap().warnings.iter().map(|w| w.code).collect();
    assert_eq!(found[..2], ["vertices-dropped", "faces-dropped"]);
    assert_eq!(codes(&file("def Mesh \"m\" {}")), ["no-vertices", "no-faces", "empty-meshes"]);
}

#[test]
fn tags_of_a_cage_that_do_not_fit_are_named() {
    let with = |tags: &str| {
        error(&file(
            &triangle("m")
                .replace("\"none\"", "\"catmullClark\"")
                .replace("point3f", &format!("{tags}\n    point3f")),
        ))
    };
    assert_eq!(
        with("int[] creaseIndices = [0, 9] int[] creaseLengths = [2] float[] creaseSharpnesses = [1]"),
        "index-out-of-range at creaseIndices 1"
    );
    assert!(
        with("int[] creaseIndices = [0, 1] int[] creaseLengths = [3] float[] creaseSharpnesses = [1]")
            .starts_with("count-mismatch")
    );
    assert!(
        with("int[] creaseIndices = [0, 1] int[] creaseLengths = [2] float[] creaseSharpnesses = []")
            .starts_with("count-mismatch")
    );
    assert!(
        with("int[] creaseIndices = [0, 1] int[] creaseLengths = [2] float[] creaseSharpnesses = [nan]")
            .starts_with("invalid-cage")
    );
    assert!(with("int[] cornerIndices = [0] float[] cornerSharpnesses = []").starts_with("count-mismatch"));
    assert_eq!(with("int[] holeIndices = [1]"), "index-out-of-range at holeIndices 0");
    let twice = file(&triangle("m")).replace("\"none\"", "\"loop\"").replace("[0, 1, 2]", "[0, 1, 1]");
    assert_eq!(error(&twice), "vertex-twice at faceVertexCounts 0");
}

#[test]
fn arcs_in_circles_and_copies_without_end_are_refused() {
    let cycle = file("def \"a\" { def \"b\" (references = </a>) {} }");
    assert!(error(&cycle).starts_with("reference-cycle at line 6"));
    let pair =
        file("def \"a\" { def \"x\" (references = </b>) {} } def \"b\" { def \"y\" (references = </a>) {} }");
    assert!(["too-deep", "too-many-copies"].iter().any(|code| error(&pair).starts_with(code)));
    // Thirty doublings.
    let mut doubled = String::from("def Xform \"p0\" { def Xform \"l\" {} }\n");
    for i in 0..30 {
        doubled += &format!(
            "def Xform \"p{}\" {{ def \"a\" (references = </p{i}>) {{}} def \"b\" (references = </p{i}>) {{}} }}\n",
            i + 1
        );
    }
    assert!(error(&file(&doubled)).starts_with("too-many-copies"));
    let itself = file(
        "def PointInstancer \"p\" { rel prototypes = </p> int[] protoIndices = [0] point3f[] positions = [(0,0,0)] }",
    );
    assert!(error(&itself).starts_with("too-deep"));
    let many = format!(
        "def PointInstancer \"p\" {{ rel prototypes = </m> int[] protoIndices = [{}0] point3f[] positions = [{}(0,0,0)] }} {}",
        "0,".repeat(200_000),
        "(0,0,0),".repeat(200_000),
        triangle("m")
    );
    assert!(error(&file(&many)).starts_with("too-many-copies"));
    assert_eq!(
        error(&file("def PointInstancer \"p\" { int[] protoIndices = [0] }")),
        "index-out-of-range at protoIndices 0"
    );
}

#[test]
fn a_transform_that_is_none_is_refused() {
    let with = |ops: &str| error(&file(&format!("def Mesh \"m\" {{ {TRIANGLE} {ops} }}")));
    let order = "uniform token[] xformOpOrder";
    assert!(
        with(&format!("double3 xformOp:translate = (nan, 0, 0) {order} = [\"xformOp:translate\"]"))
            .starts_with("bad-transform")
    );
    assert!(
        with(&format!("float3 xformOp:scale = (0, 1, 1) {order} = [\"!invert!xformOp:scale\"]"))
            .starts_with("bad-transform")
    );
    assert!(with(&format!("matrix4d xformOp:transform = ((1,0,0,1),(0,1,0,0),(0,0,1,0),(0,0,0,1)) {order} = [\"xformOp:transform\"]")).starts_with("bad-transform"));
    let unknown = file(&format!("def Mesh \"m\" {{ {TRIANGLE} {order} = [\"xformOp:spin\", \"other\"] }}"));
    assert_eq!(codes(&unknown), ["transform-skipped"]);
}

#[test]
fn every_cut_and_change_of_a_text_ends_in_a_shape_or_an_error() {
    let text = file(&format!(
        "def Xform \"A\" (inherits = </C> variants = {{ string v = \"x\" }}) {{ {} variantSet \"v\" = {{ \"x\" {{ double3 xformOp:translate = (1, 2, 3) }} }} }} class \"C\" {{}}",
        triangle("m")
    ));
    for at in 0..text.len() {
        let _ = usd::read(&text.as_bytes()[..at], &Limits::default());
        for byte in [b'"', b'{', b')', b'<', b'@', b'0', b'\n', 0x80] {
            let mut bytes = text.clone().into_bytes();
            bytes[at] = byte;
            if let Err(error) = usd::read(&bytes, &Limits::default()) {
                assert!(!error.code.is_empty() && !error.message.is_empty());
            }
        }
    }
}

#[test]
fn files_outside_the_folder_are_not_asked_for() {
    let prims = ["../a.usda", "/etc/passwd", "https://a/b.usd", "a.usdz[b.usda]"]
        .iter()
        .enumerate()
        .map(|(i, asset)| format!("def \"p{i}\" (references = @{asset}@) {{}}\n"));
    let text = file(&(prims.collect::<String>() + &triangle("m")));
    let mut asked = Vec::new();
    let mut open = |path: &str| {
        asked.push(path.to_owned());
        Err("not here".to_owned())
    };
    let outcome =
        chordal_io::read_with(text.as_bytes(), chordal_io::Format::Usda, &mut open, &Limits::default());
    assert_eq!(asked, [""; 0]);
    let warnings = outcome.unwrap().warnings;
    assert_eq!((warnings[0].code, warnings[0].count), ("layer-missing", 4));
}

/// The places of warnings are lines: found by counting from the start, this file took 22 s.
#[test]
fn many_meshes_are_read_in_time_that_grows_with_the_text() {
    let text = file(&(0..8_000).map(|i| triangle(&format!("m{i}"))).collect::<String>());
    let start = std::time::Instant::now();
    assert_eq!(scene(&text).parts.len(), 8_000);
    assert!(start.elapsed().as_secs() < 5, "{:?}", start.elapsed());
}
