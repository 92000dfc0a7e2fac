//! `chordal mesh font.ttf --text` and its neighbours, from end to end.
use crate::common;

use chordal_testkit::{tiny_font, tiny_glyph_area};
use common::{Folder, run};

const UNIT: f64 = 1e-3;

#[test]
fn a_word_becomes_a_closed_proved_solid_in_one_command() {
    let folder = Folder::new("letters-solid");
    let font = folder.file("tiny.ttf", tiny_font());
    let out = folder.text("word.stl");
    let made =
        run(&["mesh", &font, "--text", "AOX", "--extrude", "0.2", "--tol", "1e-4", "-o", &out, "--json"]);
    made.succeeds();
    let report = made.report();
    let certificate = &report["certificate"];
    assert_eq!(certificate["bound"]["evidence"], "proved", "{}", certificate["bound"]);
    assert!(certificate["bound"]["at_most"].as_f64().unwrap() <= 1e-4);
    assert!(
        certificate["valid"]["closed"] == true && certificate["valid"]["manifold"] == true,
        "{certificate}"
    );
    let letters = &certificate["input"]["letters"];
    assert_eq!((&letters["text"], &letters["em"]), (&"AOX".into(), &1.0.into()));
    // What was written, measured: the letters stand apart.
    let truth = "AOX".chars().map(tiny_glyph_area).sum::<f64>() * UNIT * UNIT * 0.2;
    let found = volume_of_stl(&std::fs::read(&out).unwrap());
    assert!((found / truth - 1.0).abs() < 1e-3, "{found}, not {truth}");
}

#[test]
fn a_word_with_bevels_is_closed_and_says_what_its_proof_rests_on() {
    let folder = Folder::new("letters-bevel");
    let font = folder.file("tiny.ttf", tiny_font());
    let out = folder.text("word.stl");
    let bevelled = ["--extrude", "0.2", "--bevel", "0.02", "--tol", "1e-3", "-o", &out, "--json"];
    let made = run(&[&["mesh", &font, "--text", "AOX"], &bevelled[..]].concat());
    made.succeeds();
    let certificate = &made.report()["certificate"];
    let bound = &certificate["bound"];
    assert_eq!(bound["evidence"], "proved-if", "{bound}");
    assert!(bound["at_most"].as_f64().unwrap() <= 1e-3);
    let valid = &certificate["valid"];
    assert!(valid["closed"] == true && valid["manifold"] == true, "{certificate}");
    let plain = "AOX".chars().map(tiny_glyph_area).sum::<f64>() * UNIT * UNIT * 0.2;
    let found = volume_of_stl(&std::fs::read(&out).unwrap());
    assert!(found < 0.99 * plain && found > 0.7 * plain, "{found} of {plain}");
}

/// The volume within the triangles of a binary STL.
fn volume_of_stl(bytes: &[u8]) -> f64 {
    let number = |at: usize| f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()));
    let n = u32::from_le_bytes(bytes[80..84].try_into().unwrap()) as usize;
    let sum = (0..n).fold(0.0, |sum, i| {
        let corner = |k: usize| [0, 1, 2].map(|axis| number(84 + 50 * i + 12 * (k + 1) + 4 * axis));
        let [a, b, c] = [0, 1, 2].map(corner);
        sum + a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    });
    sum / 6.0
}

#[test]
fn sizes_axes_and_lines_are_options() {
    let folder = Folder::new("letters-options");
    let font = folder.file("tiny.ttf", tiny_font());
    let seen = run(&["inspect", &font, "--text", "A\nA", "--em", "10", "--axis", "wght=900", "--json"]);
    seen.succeeds();
    let report = seen.report();
    assert_eq!(report["certificate"]["input"]["letters"]["axes"]["wght"], 900.0);
    let bounds = &report["inspection"]["box"];
    assert_eq!(
        (&bounds[0][1], &bounds[1][0], &bounds[1][1]),
        (&(-11.0).into(), &6.0.into(), &7.0.into()),
        "{bounds}"
    );
    // Outlines, and what they fill.
    let json = folder.text("a.json");
    run(&["mesh", &font, "--text", "O", "--tol", "0.01", "-o", &json]).succeeds();
    let written: serde_json::Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    assert_eq!(written["polylines"].as_array().unwrap().len(), 2);
    run(&["mesh", &font, "--text", "O", "--tol", "0.01", "-o", &folder.text("o.glb")]).succeeds();
}

#[test]
fn a_drawing_is_raised_too() {
    let folder = Folder::new("letters-drawing");
    let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='10mm' viewBox='0 0 10 10'><rect width='4' height='2'/></svg>";
    let file = folder.file("plate.svg", svg);
    let out = folder.text("plate.stl");
    let made = run(&["mesh", &file, "--extrude", "0.5cm", "--tol", "0.1mm", "-o", &out, "--json"]);
    made.succeeds();
    let report = made.report();
    assert!(report["certificate"]["valid"]["closed"] == true, "{report}");
    assert!((volume_of_stl(&std::fs::read(&out).unwrap()) - 40.0).abs() < 1e-5);
}

#[test]
fn scripts_have_letters_as_shapes_of_the_plane() {
    let folder = Folder::new("letters-script");
    folder.file("tiny.ttf", tiny_font());
    let script = "extrude(text('AO', 'tiny.ttf', 0.001, em=10, wght=900), 2)\n";
    let file = folder.file("word.star", script);
    let out = folder.text("word.stl");
    let made = run(&["mesh", &file, "--tol", "0.02", "-o", &out, "--json"]);
    // A as a polygon is exact; O has curves.
    made.succeeds_saying("its curves are polygons within");
    let truth = (600.0 * 700.0 + tiny_glyph_area('O')) * 1e-4 * 2.0;
    let found = volume_of_stl(&std::fs::read(&out).unwrap());
    assert!((found / truth - 1.0).abs() < 1e-2, "{found}, not {truth}");
    // The advance of a letter is 6, and it is 5 wide.
    for (align, left) in [("left", 0), ("center", -6), ("right", -12)] {
        let script = format!(
            "b = box_of(text('AA', 'tiny.ttf', 0.001, em=10, align='{align}'))\n\
             check(abs(b['min'][0] - {left}) + abs(b['max'][0] - {left} - 11) < 1e-9, str(b['min']))\nsphere(1)\n"
        );
        run(&["inspect", &folder.file("aligned.star", script)]).succeeds_saying("its curves are polygons");
    }
    for (text, said) in [
        ("text('文', 'tiny.ttf', 0.01)", "no glyph for '文'"),
        ("text('A', 'none.ttf', 0.01)", "'none.ttf' cannot be used: no such file"),
        ("text('A', 'tiny.ttf', 0)", "the tolerance must be a number above 0"),
        ("text('A', 'tiny.ttf', 0.01, em=-1)", "em must be a number above 0"),
        ("text('A', 'tiny.ttf', 0.01, wght='bold')", "the axis wght needs a number"),
        ("text('A', 'tiny.ttf', 0.01, wdth=3)", "no axis 'wdth'"),
        ("text('A', 'tiny.ttf', 0.01, align='middle')", "align must be \"left\", \"center\" or \"right\""),
        ("text('A', 'tiny.ttf', 0.01, align=1)", "align must be \"left\""),
        ("text('A', 'tiny.ttf', 0.01, halign='center')", "use align="),
        ("text('A', '../tiny.ttf', 0.01)", "without '..'"),
        ("text('A', 'wrong.star', 0.01)", "cannot be used"),
    ] {
        let file = folder.file("wrong.star", format!("extrude({text}, 1)\n"));
        let wrong = run(&["inspect", &file]);
        assert!(wrong.code == 3 && wrong.stderr.contains(said), "{text}: {wrong:?}");
    }
}

#[test]
fn a_text_too_long_is_refused_in_a_sentence() {
    let folder = Folder::new("letters-long");
    let font = folder.file("tiny.ttf", tiny_font());
    // As long as an argument can be; a script has a tenth of a million of them.
    let text = "A".repeat(100_000);
    run(&["mesh", &font, "--text", &text, "--tol", "1", "-o", &folder.text("a.stl")])
        .fails_with(3, &["more than 10,000 characters"]);
    let script = folder.file("long.star", format!("text('{text}', 'tiny.ttf', 0.01)"));
    // With the line that it is about below.
    let refused = run(&["inspect", &script]);
    let first = refused.stderr.lines().next().unwrap_or_default();
    assert_eq!(refused.code, 3, "{refused:?}");
    assert!(first.ends_with("more than 10,000 characters, which is the limit"), "{first}");
}

#[test]
fn a_font_with_a_broken_table_is_refused_in_a_sentence_or_set() {
    let folder = Folder::new("letters-broken");
    let whole = tiny_font();
    let n_tables = usize::from(u16::from_be_bytes([whole[4], whole[5]]));
    let mut refused = 0;
    for table in 0..n_tables {
        let entry = 12 + 16 * table;
        let number = |at: usize| u32::from_be_bytes(whole[at..at + 4].try_into().unwrap()) as usize;
        let (from, len) = (number(entry + 8), number(entry + 12));
        let name = String::from_utf8_lossy(&whole[entry..entry + 4]).into_owned();
        let filled = |byte: u8| {
            let mut font = whole.clone();
            font[from..from + len].fill(byte);
            font
        };
        let with_entry = |at: usize, value: u32| {
            let mut font = whole.clone();
            font[entry + at..entry + at + 4].copy_from_slice(&value.to_be_bytes());
            font
        };
        // Zeros, ones, a table that starts or ends beyond the file, one that is half there, and one that is not.
        let mut cases = vec![filled(0), filled(255), with_entry(8, u32::MAX), with_entry(12, u32::MAX)];
        cases.push(with_entry(12, len as u32 / 2));
        cases.push(with_entry(0, 0x7878_7878));
        for (case, font) in cases.into_iter().enumerate() {
            let font = folder.file("broken.ttf", font);
            let made = run(&[
                "mesh",
                &font,
                "--text",
                "AOX",
                "--tol",
                "1e-3",
                "-o",
                &folder.text("a.stl"),
                "--force",
            ]);
            let lines = made.stderr.lines().count();
            assert!(matches!(made.code, 0 | 3 | 5), "{name} {case}: {made:?}");
            if made.code != 0 {
                refused += 1;
                assert_eq!(lines, 1, "{name} {case}: {}", made.stderr);
                assert!(!made.stderr.contains("panicked"), "{name} {case}: {}", made.stderr);
            }
        }
    }
    assert!(refused > n_tables, "{refused} of {n_tables} tables");
}

#[test]
fn a_font_that_lacks_the_letters_of_its_name_is_listed_and_shown_by_others() {
    let folder = Folder::new("letters-listed");
    let font = folder.file("tiny.ttf", tiny_font());
    let seen = run(&["inspect", &font]);
    assert_eq!(seen.code, 0, "{seen:?}");
    assert!(seen.stdout.contains("drawing, ttf"), "{seen:?}");
    let listed = [
        "font 0: a font without a name, 6 glyphs",
        "the font lacks letters of its name, so the text is AOVX",
    ];
    assert!(listed.iter().all(|part| seen.stderr.contains(part)), "{seen:?}");
    let report = run(&["inspect", &font, "--json"]).report();
    let notes = report["certificate"]["notes"].to_string();
    assert!(listed.iter().all(|part| notes.contains(part)), "{report}");
}

#[test]
fn what_does_not_go_together_is_refused_in_a_sentence() {
    let folder = Folder::new("letters-refused");
    let font = folder.file("tiny.ttf", tiny_font());
    let cut = folder.file("cut.ttf", &tiny_font()[..100]);
    let svg =
        folder.file("d.svg", "<svg xmlns='http://www.w3.org/2000/svg'><rect width='4' height='2'/></svg>");
    let obj = folder.file("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let woff = folder.file("f.woff2", b"wOF2\0\x01\0\0");
    let (stl, json) = (folder.text("out.stl"), folder.text("out.json"));
    for (code, words, said) in [
        (3, vec![&*font, "--tol", "1"], "--text says which"),
        (3, vec![&font, "--tol", "1", "--text", " "], "blank"),
        (3, vec![&font, "--tol", "1", "--text", "A文"], "no glyph for '文' (U+6587)"),
        (3, vec![&font, "--tol", "1", "--text", "A", "--axis", "wght=1000"], "from 400 to 900"),
        (3, vec![&font, "--tol", "1", "--text", "A", "--em", "0"], "not 0"),
        (3, vec![&cut, "--tol", "1", "--text", "A"], "font"),
        (3, vec![&svg, "--tol", "1", "--text", "A"], "--text does not apply to svg"),
        (3, vec![&woff, "--tol", "1", "--text", "A"], "fonttools unpacks it"),
        (2, vec![&font, "--tol", "1", "--em", "3"], "--text"),
        (2, vec![&font, "--tol", "1", "--axis", "wght=500"], "--text"),
        (2, vec![&obj, "--tol", "1", "--extrude", "1"], "only drawings and letters"),
        (2, vec![&svg, "--tol", "1", "--extrude", "0"], "--extrude"),
        (2, vec![&svg, "--tol", "1", "--bevel", "1"], "--extrude"),
        (
            5,
            vec![&svg, "--tol", "1", "--extrude", "1", "--bevel", "0.5"],
            "narrower than half of the height 1",
        ),
        (5, vec![&svg, "--triangles", "99", "--extrude", "3", "--bevel", "1"], "not a number of triangles"),
    ] {
        let all: Vec<&str> = ["mesh"].into_iter().chain(words).chain(["-o", &stl]).collect();
        run(&all).fails_with(code, &[said]);
    }
    run(&["mesh", &svg, "--tol", "1", "--extrude", "1", "-o", &json])
        .fails_with(2, &["polylines have no height"]);
}
