//! Volumes through the command: which surface, where it stands, what is refused, and real ones.
use crate::common;
use chordal_testkit::{corpus, is_long};

use common::{CLOSED_OBJ, Folder, Run, run};
use serde_json::Value;

/// An array `a[i, j, k]` of f4 in C's order.
fn npy(shape: [usize; 3], value: impl Fn([usize; 3]) -> f32) -> Vec<u8> {
    let [n, m, l] = shape;
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({n}, {m}, {l}), }}\n");
    let mut bytes =
        [b"\x93NUMPY\x01\0", &(header.len() as u16).to_le_bytes()[..], header.as_bytes()].concat();
    for i in 0..n {
        for j in 0..m {
            for k in 0..l {
                bytes.extend(value([i, j, k]).to_le_bytes());
            }
        }
    }
    bytes
}

/// A volume of bytes with directions.
fn nrrd(directions: &str, size: [usize; 3], value: impl Fn([usize; 3]) -> u8) -> Vec<u8> {
    let [x, y, z] = size;
    let header = format!(
        "NRRD0004\ntype: uchar\ndimension: 3\nsizes: {x} {y} {z}\nencoding: raw\nspace: LPS\n\
         space directions: {directions}\nspace origin: (10,20,30)\n\n"
    );
    let all = (0..x * y * z).map(|n| value([n % x, n / x % y, n / (x * y)]));
    header.into_bytes().into_iter().chain(all).collect()
}

/// The distance to a ball of radius 4 about (6, 7, 8), in 13 x 15 x 17 samples.
fn ball([i, j, k]: [usize; 3]) -> f32 {
    let square = |x: usize, c: f64| (x as f64 - c) * (x as f64 - c);
    ((square(i, 6.0) + square(j, 7.0) + square(k, 8.0)).sqrt() - 4.0) as f32
}

#[track_caller]
fn report(run: &Run) -> Value {
    assert_eq!(run.code, 0, "{run:?}");
    let report = run.report();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/schema/report.schema.json");
    let schema: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let schema = jsonschema::validator_for(&schema).unwrap();
    let errors: Vec<String> = schema.iter_errors(&report).map(|error| error.to_string()).collect();
    assert_eq!(errors, [""; 0], "{report:#}");
    report
}

fn number(report: &Value, pointer: &str) -> f64 {
    report.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer} in {report:#}"))
}

/// The box of a file, and what holds of it in full.
#[track_caller]
fn inspected(file: &str) -> ([[f64; 3]; 2], Value) {
    let report = report(&run(&["inspect", file, "--json"]));
    let ends = [0, 1].map(|end| [0, 1, 2].map(|k| number(&report, &format!("/inspection/box/{end}/{k}"))));
    (ends, report)
}

#[test]
fn a_distance_becomes_a_closed_ball_where_its_indices_say() {
    let folder = Folder::new("volume-ball");
    let input = folder.file("ball.npy", npy([13, 15, 17], ball));
    let output = folder.text("ball.ply");
    let report = report(&run(&["mesh", &input, "-o", &output, "--json"]));
    let valid = &report["certificate"]["valid"];
    assert!(valid["closed"] == true && valid["manifold"] == true && valid["oriented"] == true, "{valid:#}");
    let certificate = &report["certificate"];
    assert_eq!(certificate["input"]["kind"], "volume");
    assert_eq!(certificate["budget"], Value::Null, "none was asked for");
    assert_eq!(certificate["bound"]["evidence"], "proved");
    assert_eq!(certificate["bound"]["reference"], "trilinear interpolant");
    // A cell where the interpolant does not run steadily counts with its diagonal.
    assert!(number(&report, "/certificate/bound/at_most") < 1.75);
    let notes = certificate["notes"].to_string();
    assert!(notes.contains("with samples below that inside (taken for a signed distance)"), "{notes}");
    let (ends, report) = inspected(&output);
    for k in 0..3 {
        let centre = [6.0, 7.0, 8.0][k];
        assert!(
            (ends[0][k] - centre + 4.0).abs() < 1e-5 && (ends[1][k] - centre - 4.0).abs() < 1e-5,
            "{ends:?}"
        );
    }
    assert_eq!(report["certificate"]["valid"]["outward"], true, "an array in C's order mirrors its lattice");
    // The ball has 268; inscribed triangles of this size lose a few percent.
    let volume = number(&report, "/certificate/valid/volume");
    assert!(volume > 250.0 && volume < 268.1, "{volume}");
    // The other side is the box without the ball, closed at the border.
    run(&["mesh", &input, "-o", &output, "--force", "--inside", "high", "-q"]).succeeds();
    let volume = number(&inspected(&output).1, "/certificate/valid/volume");
    assert!((volume - (12.0 * 14.0 * 16.0 - 268.0)).abs() < 20.0, "{volume}");
}

#[test]
fn mirrored_and_sheared_lattices_stand_where_they_say_with_the_front_outside() {
    let folder = Folder::new("volume-mirror");
    let output = folder.text("a.ply");
    // One sample of a mask: an octahedron of 1/6 of a cell about its place.
    for (directions, centre, cell) in [
        ("(2,0,0) (0,3,0) (0,0,4)", [14.0, 23.0, 38.0], 24.0),
        ("(-2,0,0) (0,3,0) (0,0,4)", [6.0, 23.0, 38.0], 24.0),
        ("(0,3,0) (2,0,0) (0,0,4)", [12.0, 26.0, 38.0], 24.0),
        ("(2,0,0) (1,3,0) (0,-0.5,4)", [15.0, 22.0, 38.0], 24.0),
        ("(-2,0,0) (1,-3,0) (0,-0.5,-4)", [7.0, 16.0, 22.0], 24.0),
    ] {
        let input = folder.file("a.nrrd", nrrd(directions, [5, 4, 5], |at| u8::from(at == [2, 1, 2])));
        run(&["mesh", &input, "-o", &output, "--force", "-q"]).succeeds();
        let (ends, report) = inspected(&output);
        for (k, centre) in centre.into_iter().enumerate() {
            assert!((0.5 * (ends[0][k] + ends[1][k]) - centre).abs() < 1e-9, "{directions}: {ends:?}");
        }
        assert!((number(&report, "/certificate/valid/volume") - cell / 6.0).abs() < 1e-9, "{directions}");
        assert_eq!(report["certificate"]["valid"]["outward"], true, "{directions}");
    }
    let letter = run(&["inspect", &folder.text("a.nrrd")]);
    for words in
        ["5 x 4 x 5 of u8", "left-handed", "sheared", "LPS", "0.5, with high inside (taken for a mask)"]
    {
        assert!(letter.stdout.contains(words), "{words}: {}", letter.stdout);
    }
    let (_, report) = inspected(&folder.text("a.nrrd"));
    assert_eq!(report["inspection"]["volume"]["axes"], "RAI");
}

#[test]
fn a_level_that_nobody_says_is_asked_for_with_the_range_and_a_guess() {
    let folder = Folder::new("volume-level");
    let input = folder.file("a.npy", npy([4, 4, 4], |[i, ..]| if i < 2 { 9.5 } else { 90.5 }));
    let output = folder.text("a.ply");
    run(&["mesh", &input, "-o", &output]).fails_with(2, &["between 9.5 and 90.5", "--iso LEVEL"]);
    run(&["mesh", &input, "-o", &output, "--iso", "nan"]).fails_with(2, &["--iso"]);
    run(&["mesh", &input, "-o", &output, "--iso", "5", "--labels", "all"]).fails_with(2, &["--labels"]);
    run(&["mesh", &input, "-o", &output, "--labels", "all"]).fails_with(2, &["whole numbers"]);
    assert_eq!(folder.names(), ["a.npy"]);
    let report = report(&run(&["mesh", &input, "-o", &output, "--iso", "50", "--open", "--json"]));
    assert_eq!(report["certificate"]["valid"]["boundary_loops"], 1);
    assert!(report["certificate"]["notes"].to_string().contains("reaches the border"));
    run(&["mesh", &input, "-o", &output, "--force", "--iso", "50", "--cap", "-q"]).succeeds();
    let (ends, report) = inspected(&output);
    assert_eq!(report["certificate"]["valid"]["closed"], true);
    assert!(
        (number(&report, "/certificate/valid/volume") - 13.5).abs() < 1e-4,
        "half of a cell and one more"
    );
    assert!(ends[1].iter().all(|x| (x - 3.0).abs() < 1e-5), "{ends:?}");
}

#[test]
fn h70_no_surface_is_refused_with_the_reason() {
    let folder = Folder::new("h70");
    let output = folder.text("a.ply");
    let mask = folder.file("mask.npy", npy([3, 3, 3], |[i, ..]| i as f32));
    run(&["mesh", &mask, "-o", &output, "--iso", "7"]).fails_with(3, &["level 7", "between 0 and 2"]);
    run(&["mesh", &mask, "-o", &output, "--iso", "2"]).fails_with(3, &["no surface"]);
    let flat = folder.file("flat.npy", npy([3, 3, 3], |_| 0.0));
    run(&["mesh", &flat, "-o", &output]).fails_with(3, &["all samples are 0"]);
    let nan = folder.file("nan.npy", npy([3, 3, 3], |_| f32::NAN));
    let failed = run(&["mesh", &nan, "-o", &output, "--iso", "1", "--json"]);
    assert_eq!(failed.report()["error"]["code"], "empty", "{failed:?}");
    assert_eq!(folder.names(), ["flat.npy", "mask.npy", "nan.npy"]);
}

#[test]
fn h63_samples_that_are_no_numbers_are_outside_and_said() {
    let folder = Folder::new("h63");
    let value = |[i, j, k]: [usize; 3]| match [i, j, k] {
        [3, 3, 3] => f32::NAN,
        at if at.iter().all(|x| (1..6).contains(x)) => 1.0,
        _ => 0.0,
    };
    let input = folder.file("a.npy", npy([7, 7, 7], value));
    let made = run(&["mesh", &input, "-o", &folder.text("a.ply"), "--json"]);
    assert!(made.stderr.contains("NaN"), "{made:?}");
    let report = report(&made);
    assert_eq!(report["certificate"]["valid"]["closed"], true);
    assert_eq!(report["certificate"]["valid"]["components"], 2, "a hole where the number is missing");
    assert_eq!(report["certificate"]["input"]["warnings"][0]["code"], "nan-samples");
}

#[test]
fn labels_become_parts_of_their_own() {
    let folder = Folder::new("volume-labels");
    let value = |[x, y, z]: [usize; 3]| match (x, (1..5).contains(&y) && (1..5).contains(&z)) {
        (1..3, true) => 3,
        (3..5, true) => 200,
        _ => 0,
    };
    let input = folder.file("a.nrrd", nrrd("(1,0,0) (0,1,0) (0,0,1)", [6, 6, 6], value));
    let output = folder.text("a.obj");
    run(&["mesh", &input, "-o", &output, "--labels", "all", "-q"]).succeeds();
    let (ends, report) = inspected(&output);
    let valid = &report["certificate"]["valid"];
    assert!(valid["closed"] == true && valid["manifold"] == true && valid["outward"] == true, "{valid:#}");
    assert_eq!(ends, [[10.5, 20.5, 30.5], [14.5, 24.5, 34.5]]);
    let text = std::fs::read_to_string(&output).unwrap();
    assert!(text.contains("label_3") || text.contains("label 3"), "{}", &text[..200]);
    run(&["mesh", &input, "-o", &output, "--force", "--labels", "200", "-q"]).succeeds();
    assert_eq!(inspected(&output).0[0][0], 12.5, "the border that both share is at x = 2.5 of the lattice");
    run(&["mesh", &input, "-o", &output, "--force", "--labels", "7"])
        .fails_with(3, &["no sample has label 7"]);
}

#[test]
fn labels_within_a_budget_share_their_triangles_and_masks_are_smoothed() {
    let folder = Folder::new("volume-budgets");
    let square = |a: usize, b: usize| (a as i64 - b as i64).pow(2);
    let (middle, most) = if is_long() { (8, 40) } else { (6, 20) };
    let size = [2 * middle + 1; 3];
    let in_ball = |at: [usize; 3]| at.map(|x| square(x, middle)).iter().sum::<i64>() < most;
    let halves = |at: [usize; 3]| if in_ball(at) { 1 + u8::from(at[0] > middle) } else { 0 };
    let labels = folder.file("labels.nrrd", nrrd("(1,0,0) (0,1,0) (0,0,1)", size, halves));
    let output = folder.text("labels.obj");
    let made = |limit: &[&str]| {
        let arguments = ["mesh", &labels, "--labels", "all", "-o", &output, "--force", "--json"];
        report(&run(&[&arguments[..], limit].concat()))
    };
    let (all, few) = (made(&[]), made(&["--tol", "1.2"]));
    let triangles = |report: &Value| number(report, "/certificate/output/triangles");
    assert!(triangles(&few) < 0.6 * triangles(&all), "{} of {}", triangles(&few), triangles(&all));
    assert!(number(&few, "/certificate/bound/at_most") <= 1.2);
    assert!(few["certificate"]["valid"]["closed"] == true && few["certificate"]["valid"]["manifold"] == true);
    assert!(few["certificate"]["notes"].to_string().contains("both sides"), "{few:#}");
    let half = made(&["--triangles", (0.6 * triangles(&all)).to_string().split('.').next().unwrap()]);
    assert!(triangles(&half) <= 0.6 * triangles(&all));

    let mask = folder.file("mask.nrrd", nrrd("(1,0,0) (0,1,0) (0,0,1)", size, |at| u8::from(in_ball(at))));
    let output = folder.text("mask.obj");
    let smoothed = ["mesh", &mask, "--smooth", "0.8vox", "-o", &output, "--force"];
    let found = report(&run(&[&smoothed[..], &["--tol", "1.5", "--json"]].concat()));
    let facts = &found["certificate"]["smoothed"];
    assert!(
        facts["sigma"] == serde_json::json!([0.8, 0.8, 0.8]) && facts["evidence"] == "proved",
        "{facts:#}"
    );
    assert!(number(facts, "/at_most") <= number(&found, "/certificate/bound/at_most"));
    assert!(number(&found, "/certificate/bound/at_most") <= 1.5);
    let said = run(&smoothed);
    assert!(
        said.code == 0 && said.stderr.contains("smoothed") | said.stdout.contains("smoothed"),
        "{said:?}"
    );
    run(&[&smoothed[..], &["--tol", "0.05"]].concat()).fails_with(5, &["not met"]);
    run(&["mesh", &labels, "--labels", "all", "--smooth", "1", "-o", &output]).fails_with(2, &["--smooth"]);
}

#[test]
fn what_is_for_volumes_is_for_nothing_else() {
    let folder = Folder::new("volume-only");
    let (input, output) = (folder.file("a.obj", CLOSED_OBJ), folder.text("a.ply"));
    run(&["mesh", &input, "-o", &output, "--tol", "1", "--iso", "1"]).fails_with(2, &["--iso", "triangles"]);
    run(&["mesh", &input, "-o", &output, "--tol", "1", "--open"]).fails_with(2, &["--open"]);
    run(&["mesh", &input, "-o", &output]).fails_with(2, &["a budget is needed", "--tol"]);
    assert_eq!(folder.names(), ["a.obj"]);
}

fn real(name: &str) -> Option<String> {
    corpus::find(&format!("volume/{name}"))?.to_str().map(str::to_owned)
}

/// Meshes a real volume to GLB and to PLY. The first has to be closed and manifold, the box is that of the
/// second. Of large volumes the PLY stands for both.
#[track_caller]
fn real_surface(folder: &Folder, input: &str, more: &[&str]) -> ([[f64; 3]; 2], Value) {
    let ply = folder.text("a.ply");
    // Chosen: a mask of one organ has some thousands of bytes when it is packed, a scan has more than 100,000.
    let is_small = std::fs::metadata(input).unwrap().len() < 20_000;
    let glb = if is_long() || is_small { folder.text("a.glb") } else { ply.clone() };
    let outputs = [&glb, &ply];
    for output in &outputs[usize::from(glb == ply)..] {
        let made = run(&[&["mesh", input, "-o", output, "--force", "-q"], more].concat());
        assert_eq!(made.code, 0, "{made:?}");
    }
    let checked = run(&["inspect", &glb, "--require", "closed,manifold,oriented", "--json"]);
    assert_eq!(checked.code, 0, "{}", checked.stderr);
    inspected(&ply)
}

#[test]
fn a_brain_in_the_patients_coordinates_is_closed_and_manifold() {
    let Some(input) = real("nilearn/nilearn/datasets/data/mni_icbm152_t1_tal_nlin_sym_09a_converted.nii.gz")
    else {
        return;
    };
    let folder = Folder::new("volume-mni");
    let (ends, report) = real_surface(&folder, &input, &["--iso", "60"]);
    // The template lies in the box of its affine, and its head is about 150 mm wide, left and right alike.
    let (low, high) = ([-98.0, -134.0, -72.0], [98.0, 98.0, 116.0]);
    assert!((0..3).all(|k| ends[0][k] >= low[k] && ends[1][k] <= high[k]), "{ends:?}");
    assert!((ends[0][0] + ends[1][0]).abs() < 4.0 && ends[1][0] - ends[0][0] > 130.0, "{ends:?}");
    assert!(number(&report, "/certificate/valid/volume") > 1e6, "more than a litre");
}

#[test]
fn organs_stand_on_their_sides_of_the_patient() {
    let folder = Folder::new("volume-organs");
    let organ = |name: &str| {
        let input = real(&format!("totalsegmentator/tests/reference_files/example_seg_fast/{name}.nii.gz"))?;
        let (ends, report) = real_surface(&folder, &input, &[]);
        assert!(number(&report, "/certificate/valid/volume") > 0.0);
        Some((ends[0][0] + ends[1][0]) / 2.0)
    };
    let (Some(liver), Some(aorta)) = (organ("liver"), organ("aorta")) else { return };
    // x grows to the patient's right, where the liver is.
    assert!(liver > aorta + 20.0, "liver at {liver}, aorta at {aorta}");
    let Some(ct) = real("totalsegmentator/tests/reference_files/example_ct_sm.nii.gz") else { return };
    let (ends, _) = real_surface(&folder, &ct, &["--iso", "200"]);
    assert!(ends[0][0] >= -178.0 && ends[1][0] <= 185.1 && ends[1][2] <= 181.4, "{ends:?}");
    run(&["mesh", &ct, "-q", "-o", &folder.text("x.glb")])
        .fails_with(2, &["between -1100 and 1207", "--iso"]);
    let Some(labels) = real("totalsegmentator/tests/reference_files/example_seg.nii.gz") else { return };
    let (_, report) = real_surface(&folder, &labels, &["--labels", "all"]);
    assert!(number(&report, "/certificate/output/triangles") > 10_000.0);
}

/// Five balls with the labels 1 to 5 in 12 x 12 x 30 samples, and what 3D Slicer says of two of them.
fn segments(keys: &str) -> Vec<u8> {
    let file = nrrd("(1,0,0) (0,1,0) (0,0,2)", [12, 12, 30], |[x, y, z]| {
        let square = |a: usize, b: usize| (a as i64 - b as i64).pow(2);
        let ball = (1..=5).find(|k| square(x, 5) + square(y, 6) + square(z, 6 * k - 3) < 7);
        ball.unwrap_or(0) as u8
    });
    let end = file.windows(2).position(|two| two == b"\n\n").unwrap();
    [&file[..=end], keys.as_bytes(), &file[end + 1..]].concat()
}

const KEYS: &str = "Segment0_Name:=Left kidney\nSegment0_LabelValue:=2\nSegment0_Color:=1 0 0.5\n\
    Segment0_Layer:=0\nSegment1_Name:=Spleen\nSegment1_LabelValue:=4\nSegment1_Layer:=0\n";

#[test]
fn labels_are_parts_with_the_names_and_colours_of_the_file_or_of_their_own() {
    let folder = Folder::new("volume-looks");
    let input = folder.file("a.nrrd", segments(KEYS));
    let names = ["label 1", "Left kidney", "label 3", "Spleen", "label 5"];
    let found = report_of(&["inspect", &input, "--json"]);
    assert_eq!(found["inspection"]["volume"]["label_list"][2]["name"], "Left kidney");
    assert_eq!(found["inspection"]["volume"]["label_list"][1].get("name"), None);
    let glb = folder.text("a.glb");
    run(&["mesh", &input, "--labels", "all", "-o", &glb, "-q"]).succeeds();
    let bytes = std::fs::read(&glb).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let document: Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    let materials = document["materials"].as_array().unwrap();
    let named: Vec<&str> = materials.iter().map(|material| material["name"].as_str().unwrap()).collect();
    assert_eq!(named, names);
    let color = |at: usize| materials[at]["pbrMetallicRoughness"]["baseColorFactor"].to_string();
    // Half of the encoded scale is 0.214 of the light.
    assert!(color(1).starts_with("[1.0,0.0,0.2140411"), "{}", color(1));
    for (at, mesh) in document["meshes"].as_array().unwrap().iter().enumerate() {
        assert_eq!(mesh["name"], names[at]);
        assert_eq!(mesh["primitives"][0]["material"], at);
        assert!((0..at).all(|other| color(at) != color(other)));
    }
    for (name, words) in [("a.obj", "usemtl Left kidney"), ("a.usda", "Left kidney")] {
        let output = folder.text(name);
        run(&["mesh", &input, "--labels", "all", "-o", &output, "-q"]).succeeds();
        assert!(std::fs::read_to_string(&output).unwrap().contains(words), "{name}");
    }
    let threemf = folder.text("a.3mf");
    run(&["mesh", &input, "--labels", "all", "--unit", "mm", "-o", &threemf, "-q"]).succeeds();
    let parts = report_of(&["inspect", &threemf, "--json"]);
    let parts = parts["inspection"]["parts"].as_array().unwrap();
    assert_eq!(parts.iter().map(|part| part["name"].as_str().unwrap()).collect::<Vec<_>>(), names);
    // What a label looks like does not hang on the others.
    let alone = folder.text("b.glb");
    run(&["mesh", &input, "--labels", "5", "-o", &alone, "-q"]).succeeds();
    assert!(String::from_utf8_lossy(&std::fs::read(&alone).unwrap()).contains(&color(4)));
}

fn report_of(args: &[&str]) -> Value {
    report(&run(args))
}

#[test]
fn a_volume_is_inspected_pictured_and_measured_at_a_level() {
    let folder = Folder::new("volume-table");
    let input = folder.file("ball.npy", npy([13, 15, 17], ball));
    let mesh = folder.text("ball.ply");
    let picture = folder.text("ball.png");
    let of = |args: &[&str]| report_of(&[args, &["--json"]].concat());
    // Half a step further out.
    let level = ["--iso", "0.5", "--inside", "low"];
    run(&[&["mesh", &input, "-o", &mesh, "-q"][..], &level].concat()).succeeds();
    let seen = of(&[&["inspect", &input][..], &level].concat());
    let made = of(&["inspect", &mesh]);
    for pointer in ["/certificate/valid/volume", "/certificate/valid/genus", "/certificate/output/triangles"]
    {
        assert_eq!(seen.pointer(pointer), made.pointer(pointer), "{pointer}");
    }
    assert_eq!(seen["certificate"]["bound"]["reference"], "trilinear interpolant");
    run(&[&["inspect", &input, "--require", "solid"][..], &level].concat()).succeeds();
    run(&[&["inspect", &input, "--require", "closed", "--open", "-q"][..], &["--iso", "6"]].concat())
        .fails_with(1, &["closed"]);
    let drawn = of(&[&["render", &input, "--size", "40x30", "-o", &picture][..], &level].concat());
    let again = ["render", &mesh, "--size", "40x30", "-o", &picture, "--force"];
    assert_eq!(drawn["certificate"]["output"]["triangles"], of(&again)["certificate"]["output"]["triangles"]);
    // A ball of 4 about itself, and of 4.5: half a step all around.
    let measured = of(&[&["deviation", &mesh, &input][..], &["--iso", "0"]].concat());
    let ends = ["at_least", "at_most"].map(|end| number(&measured, &format!("/certificate/bound/{end}")));
    assert!(ends[0] > 0.4 && ends[0] < 0.56 && ends[1] >= ends[0] && ends[1] < 0.7, "{ends:?}");
    // A ball of 2, whose own mesh is so near that it takes longer to tell.
    let small = |at: [usize; 3]| {
        (at.map(|x| (x as f64 - 4.0) * (x as f64 - 4.0)).iter().sum::<f64>().sqrt() - 2.0) as f32
    };
    let input = if is_long() { input } else { folder.file("small.npy", npy([9; 3], small)) };
    let made = of(&[&["mesh", &input, "-o", &mesh, "--force"][..], &level].concat());
    let own = of(&[&["deviation", &mesh, &input][..], &level].concat());
    // What the mesh was proved to keep holds for what is measured, from the other side.
    assert!(number(&own, "/certificate/bound/at_least") <= number(&made, "/certificate/bound/at_most"));
    assert!(number(&own, "/certificate/bound/at_most") >= number(&made, "/certificate/bound/at_least"));
}

#[test]
fn a_level_is_for_volumes_and_the_other_shape_may_be_anything() {
    let folder = Folder::new("volume-only");
    let obj = folder.file("a.obj", CLOSED_OBJ);
    let input = folder.file("ball.npy", npy([13, 15, 17], ball));
    let picture = folder.text("a.png");
    run(&["deviation", &obj, &obj, "--iso", "1"]).fails_with(2, &["--iso is for volumes, and neither"]);
    run(&["render", &obj, "--open", "-o", &picture]).fails_with(2, &["--open is for volumes"]);
    run(&["inspect", &obj, "--labels", "all"]).fails_with(2, &["--labels is for volumes"]);
    run(&["deviation", &input, &obj, "--iso", "0.5", "-q"]).succeeds();
    let seen = run(&["inspect", &input]);
    assert!(seen.code == 0 && !seen.stdout.contains("triangles"), "{seen:?}");
}

#[test]
fn files_of_others_are_refused_by_name_with_a_way_around() {
    let folder = Folder::new("foreign");
    let png = [&b"\x89PNG\r\n\x1a\n"[..], &[0; 20]].concat();
    for (name, bytes, words) in [
        ("a.step", &b"ISO-10303-21;\nHEADER;\n"[..], "this is STEP"),
        // By its content, whatever it is called.
        ("b.obj", b"ISO-10303-21;\nHEADER;\n", "this is STEP"),
        (
            "f.stp",
            b"ISO-10303-21;\n",
            "examples/step_to_surfaces.py writes its faces as NURBS surfaces in JSON",
        ),
        ("g.igs", b"no column\n", "this is IGES"),
        ("h.brep", b"\nCASCADE Topology V3\n", "this is a BREP of Open CASCADE"),
        ("i.sat", b"700 0 1 0\n", "this is ACIS"),
        ("j.3dm", b"3D Geometry File Format  7", "examples/rhino_to_surfaces.py writes its surfaces as JSON"),
        ("c", &png, "this is a PNG picture"),
        ("d.blend", b"\x28\xb5\x2f\xfd....", "this is a scene of Blender"),
        ("e.max", b"\xd0\xcf\x11\xe0", "this is a scene of 3ds Max"),
    ] {
        let file = folder.file(name, bytes);
        run(&["inspect", &file]).fails_with(3, &[words, "which is not read: "]);
    }
    let unknown = folder.file("x", b"\x01\x02\x03");
    run(&["inspect", &unknown]).fails_with(3, &["formats that can be read are bpt, ", "slc, star"]);
    let obj = folder.file("t.obj", CLOSED_OBJ);
    for (name, words) in [("o.jpg", "a JPEG picture"), ("o.fbx", "FBX"), ("o.step", "STEP")] {
        let output = folder.text(name);
        for verb in [&["mesh", &obj, "--tol", "1%", "-o", &output][..], &["convert", &obj, &output]] {
            run(verb).fails_with(2, &[&format!("{words} cannot be written")]);
            run(&[verb, &["--to", "ply"]].concat()).fails_with(2, &["but --to says ply"]);
        }
        assert!(!std::path::Path::new(&output).exists());
    }
}
