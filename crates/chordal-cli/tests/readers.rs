//! What the command says of files that are something else than they seem, or several things at once.
use crate::common;

use chordal_io::Format;
use common::{CLOSED_OBJ, Folder, run};

/// A volume of two by three by two numbers for each of some frames, as NIfTI.
fn nifti(frames: u8) -> Vec<u8> {
    let mut header = vec![0; 352];
    let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
    let one = 1.0_f32.to_le_bytes();
    put(0, &348_i32.to_le_bytes());
    put(40, &[4, 0, 2, 0, 3, 0, 2, 0, frames, 0]);
    put(70, &[2, 0, 8, 0]);
    put(76, &[one, one, one, one].concat());
    put(108, &352.0_f32.to_le_bytes());
    put(123, &[2]);
    put(252, &[1, 0]);
    put(344, b"n+1\0");
    let numbers = (0..12 * u32::from(frames)).map(|i| (40 + 7 * i % 100) as u8);
    header.into_iter().chain(numbers).collect()
}

#[test]
fn a_volume_that_says_no_level_ends_with_one_code_and_one_sentence_in_every_verb() {
    let folder = Folder::new("no-level");
    std::fs::write(folder.path("v.nii"), nifti(1)).unwrap();
    let input = folder.text("v.nii");
    let text = |name: &str| folder.text(name);
    let cases: [&[&str]; 6] = [
        &["mesh", &input, "--tol", "0.1", "-o", &text("a.obj")],
        &["mesh", &input, "--union", &input, "--tol", "0.1", "-o", &text("b.obj")],
        &["lod", &input, "--px", "1", "-o", &text("a.glb")],
        &["bake", &input, "--cells", "8", "-o", &text("a.nrrd")],
        &["render", &input, "-o", &text("a.png")],
        &["inspect", &input, "--require", "closed"],
    ];
    let mut sentences = Vec::new();
    for words in cases {
        let done = run(words);
        done.fails_with(2, &["the level of the surface is not known", "--iso LEVEL"]);
        sentences.push(done.stderr.clone());
    }
    sentences.dedup();
    assert_eq!(sentences.len(), 1, "{sentences:?}");
    run(&["deviation", &input, &input]).fails_with(2, &["--iso LEVEL"]);
}

#[test]
fn a_script_of_openscad_leads_to_its_page() {
    let folder = Folder::new("scad");
    let texts = [
        "cube([1, 2, 3]);\n",
        "use <lib.scad>\ns = 5;\n",
        "f = 3; // \ng = 4;\n",
        "group() {\n}\n",
        "1\n2 3\n",
    ];
    for (i, text) in texts.into_iter().enumerate() {
        for extension in ["scad", "csg"] {
            let input = folder.file(&format!("a{i}.{extension}"), text);
            run(&["inspect", &input]).fails_with(3, &["OpenSCAD", "docs/shape-scripts-openscad.md", ".star"]);
        }
    }
}

#[test]
fn a_text_in_which_there_is_nothing_of_an_obj_is_none() {
    let folder = Folder::new("no-obj");
    for (i, text) in
        ["s 5\nhello world\n", "g part\nf1 = 3\n", "o x\nmodule y() {}\n"].into_iter().enumerate()
    {
        let input = folder.file(&format!("a{i}.obj"), text);
        run(&["inspect", &input]).fails_with(3, &["not Wavefront OBJ"]);
    }
    // An odd line among vertices is counted as ever.
    let input = folder.file("odd.obj", format!("hello world\n{CLOSED_OBJ}"));
    assert_eq!(run(&["inspect", &input]).code, 0);
}

#[test]
fn a_file_without_anything_is_said_to_be_empty() {
    let folder = Folder::new("empty");
    let input = folder.file("a.stl", "solid x\nendsolid x\n");
    let shown = run(&["inspect", &input]);
    assert_eq!(shown.code, 0);
    assert!(
        shown.stdout.contains("0 triangles") && !shown.stdout.contains("points only"),
        "{}",
        shown.stdout
    );
}

#[test]
fn the_first_of_several_volumes_is_inspected_and_the_others_are_named() {
    let folder = Folder::new("frames");
    std::fs::write(folder.path("v.nii"), nifti(5)).unwrap();
    let input = folder.text("v.nii");
    let shown = run(&["inspect", &input]);
    assert!(shown.code == 0 && shown.stdout.contains("2 x 3 x 2"), "{shown:?}");
    assert!(shown.stderr.contains("5 volumes") && shown.stderr.contains("--index"), "{shown:?}");
    let report = run(&["inspect", &input, "--json"]).report();
    let notes = report["certificate"]["notes"].to_string();
    assert!(notes.contains("from 0 to 4"), "{notes}");
    run(&["inspect", &input, "--index", "3"]).succeeds();
    run(&["inspect", &input, "--index", "5"]).fails_with(3, &["there is no volume 5"]);
    // What is made is made of one that was named.
    run(&["mesh", &input, "--iso", "60", "-o", &folder.text("a.obj")])
        .fails_with(3, &["5 volumes", "--index"]);
}

#[test]
fn the_header_of_a_pair_is_read_with_the_samples_beside_it() {
    let folder = Folder::new("pair");
    let whole = nifti(1);
    let mut header = whole[..348].to_vec();
    header[108..112].fill(0);
    header[344..348].copy_from_slice(b"ni1\0");
    std::fs::write(folder.path("brain.hdr"), header).unwrap();
    let input = folder.text("brain.hdr");
    run(&["inspect", &input]).fails_with(3, &[".img"]);
    std::fs::write(folder.path("brain.img"), &whole[352..]).unwrap();
    run(&["inspect", &input]).succeeds();
    let report = run(&["inspect", &input, "--json"]).report();
    assert_eq!(report["certificate"]["input"]["files"][0]["path"], "brain.img", "{report}");
    run(&["inspect", &folder.text("brain.img")]).fails_with(3, &["the header beside it (.hdr)"]);
}

#[test]
fn a_tileset_is_compared_with_what_it_was_made_of() {
    let folder = Folder::new("tileset");
    let star = folder.file("a.star", "sphere(1) | box(1.5, 1.5, 1.5)\n");
    let mesh = folder.text("a.ply");
    assert_eq!(run(&["mesh", &star, "--tol", "1e-3", "-o", &mesh]).code, 0);
    let tiles = folder.text("tiles");
    let made = run(&["lod", &mesh, "--tol", "1e-2", "--px", "1", "-o", &format!("{tiles}/")]);
    assert_eq!(made.code, 0, "{made:?}");
    for input in [format!("{tiles}/"), tiles.clone(), format!("{tiles}/tileset.json")] {
        let shown = run(&["inspect", &input, "--json"]);
        assert_eq!(
            (shown.code, shown.report()["certificate"]["input"]["format"].as_str()),
            (0, Some("tileset"))
        );
    }
    let glb = folder.text("a.glb");
    assert_eq!(run(&["convert", &mesh, "-o", &glb]).code, 0);
    let compared = run(&["deviation", &glb, &tiles, "--json"]);
    assert_eq!(compared.code, 0, "{compared:?}");
    let most = compared.report()["certificate"]["bound"]["at_most"].as_f64().unwrap();
    // The leaves are the mesh to within the length that was asked for.
    assert!(most > 0.0 && most <= 1.1e-2, "{most}");
}

#[test]
fn help_names_the_formats_of_the_table() {
    let help = run(&["mesh", "--help"]).stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    let normals = help.split("--normals").nth(1).unwrap().split("(auto)").next().unwrap();
    let listed = normals.split("crease=").next().unwrap();
    let segments = help.split("For curves to polylines").nth(1).unwrap().split(')').next().unwrap();
    for format in Format::all() {
        let is_in = |text: &str| text.split([' ', ',', '(']).any(|word| word == format!(".{format}"));
        assert_eq!(is_in(listed), format.wants_normals(), "{format}: {listed}");
        assert_eq!(is_in(segments), format.holds_polylines(), "{format}: {segments}");
    }
}
