//! What a file shows beside its triangles, and what its certificate says of that, edited: `verify` refutes it, or says that it
//! was not checked. Honest files of the same kinds are re-proved.
use super::verify_edits::{CUBE, at_level, certificate_of, levels_within, loaded};
use chordal::Job;
use chordal::explicit::subdivision::Scheme;
use chordal::explicit::{Attribute, Semantic};
use chordal_io::{Format, Limits};
use chordal_testkit::is_long;
use chordal_verbs::{
    BudgetSpec, ClaimVerdict, FormatHint, Input, Normals, PolygonSurface, Shape, VerifyReport, convert, load,
    lod, mesh, n_coarser_levels, seal_of, verify, verify_levels,
};
use serde_json::{Value, json};

const TEXCOORD: Semantic = Semantic::TexCoord(0);
const COLOR: Semantic = Semantic::Color(0);

/// A dome over a square, with texture coordinates, and colours and normals where they are asked for.
fn dome(colors: bool, normals: bool) -> Input {
    let n = 24;
    let mut text = String::new();
    let (mut vt, mut vn, mut faces) = (String::new(), String::new(), String::new());
    for (i, j) in (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
        let [u, v] = [i, j].map(|k| f64::from(k) / f64::from(n));
        let [x, y] = [u - 0.5, v - 0.5];
        let height = 0.3 - 0.6 * (x * x + y * y);
        let wave = 0.5 + 0.5 * (9.0 * u).sin();
        let color = if colors { format!(" {wave} {v} 0.25") } else { String::new() };
        text += &format!("v {x} {y} {height}{color}\n");
        vt += &format!("vt {} {v}\n", u * u);
        let long = (1.44 * (x * x + y * y) + 1.0).sqrt();
        vn += &format!("vn {} {} {}\n", 1.2 * x / long, 1.2 * y / long, 1.0 / long);
        if i < n && j < n {
            let at = |i: i32, j: i32| {
                let row = i * (n + 1) + j + 1;
                if normals { format!("{row}/{row}/{row}") } else { format!("{row}/{row}") }
            };
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            faces += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
        }
    }
    text += &vt;
    text += if normals { &vn } else { "" };
    text += &faces;
    loaded(text.as_bytes(), "dome.obj")
}

fn spec(length: &str) -> BudgetSpec {
    BudgetSpec { length: Some(length.parse().unwrap()), ..BudgetSpec::default() }
}

fn meshed(source: &Input, spec: &BudgetSpec, to: Format) -> Input {
    let mut bytes = Vec::new();
    mesh(source.clone(), spec, to, &Job::default()).expect("reachable").write(&mut bytes).unwrap();
    loaded(&bytes, &format!("out.{to}"))
}

fn converted(source: &Input, to: Format) -> Input {
    let mut bytes = Vec::new();
    convert(source.clone(), to).expect("convertible").write(&mut bytes).unwrap();
    loaded(&bytes, &format!("out.{to}"))
}

fn verified(out: &Input, source: &Input) -> VerifyReport {
    verify(out, None, std::slice::from_ref(source), &Job::default()).expect("verified")
}

/// The same file with other values of an attribute, one row at a time; no digest covers these.
fn with_values(file: &Input, semantic: &Semantic, edit: &dyn Fn(usize, &mut [f64])) -> Input {
    let mut out = file.clone();
    let Shape::Scene(scene) = &mut out.shape else { panic!("triangles") };
    let mut n_edited = 0;
    for part in &mut scene.parts {
        let edited = part.mesh.attributes().iter().map(|own| {
            let mut own: Attribute = own.clone();
            if own.semantic == *semantic {
                own.values.chunks_mut(own.width).enumerate().for_each(|(k, row)| edit(k, row));
                n_edited += 1;
            }
            own
        });
        let edited: Vec<Attribute> = edited.collect();
        part.mesh = part.mesh.with_only(edited).expect("as many values");
    }
    assert!(n_edited > 0, "the file has no {semantic:?}");
    out
}

/// The same file with another certificate, sealed again.
fn with_certificate(file: &Input, edit: impl FnOnce(&mut Value)) -> Input {
    let mut out = file.clone();
    let certificate = certificate_of(&mut out).as_mut().expect("a certificate");
    edit(certificate);
    certificate["seal"] = seal_of(certificate).into();
    out
}

fn assert_honest(out: &Input, source: &Input, what: &str) -> VerifyReport {
    let found = verified(out, source);
    assert_eq!(found.verdict, ClaimVerdict::Proved, "{what}: {:?}", found.worst());
    found
}

fn assert_seen(out: &Input, source: &Input, what: &str) {
    let found = verified(out, source);
    assert_ne!(found.verdict, ClaimVerdict::Proved, "{what}: {:?}", found.unchecked);
    let worst = found.worst().expect("a claim");
    assert!(worst.claim.starts_with("attributes/"), "{what}: {worst:?}");
}

type ValueEdit<'a> = (&'a str, Semantic, &'a dyn Fn(usize, &mut [f64]));

fn flipped(_: usize, row: &mut [f64]) {
    row.iter_mut().for_each(|x| *x = -*x);
}

fn constant(_: usize, row: &mut [f64]) {
    row.fill(0.5);
}

fn darker(_: usize, row: &mut [f64]) {
    row[..3].iter_mut().for_each(|x| *x *= 0.5);
}

fn proved(found: &VerifyReport, claim: &str) -> bool {
    found.claims.iter().any(|own| own.claim == claim && own.verdict == ClaimVerdict::Proved)
}

#[test]
fn what_a_conversion_carries_is_what_was_read() {
    let source = dome(true, true);
    for to in [Format::Ply, Format::Glb, Format::Gltf, Format::Obj] {
        let out = converted(&source, to);
        let found = assert_honest(&out, &source, &to.to_string());
        for claim in ["attributes/normal", "attributes/texcoord 0", "attributes/color 0"] {
            assert!(proved(&found, claim), "{to}: {claim} in {:?}", found.claims);
        }
        let one = |k: usize, row: &mut [f64]| row[0] += if k == 7 { 0.25 } else { 0.0 };
        let edits: [ValueEdit; 6] = [
            ("flipped", Semantic::Normal, &flipped),
            ("turned", Semantic::Normal, &|_, row| (row[0], row[1], row[2]) = (row[2], row[0], row[1])),
            ("constant", TEXCOORD, &constant),
            ("one vertex", TEXCOORD, &one),
            ("turned over", TEXCOORD, &|_, row| row[1] = 1.0 - row[1]),
            ("darker", COLOR, &darker),
        ];
        for (name, semantic, edit) in edits {
            assert_seen(&with_values(&out, &semantic, edit), &source, &format!("{to}: {semantic:?} {name}"));
        }
    }
}

#[test]
fn attributes_that_nothing_read_had_are_not_re_proved() {
    let source = dome(false, false);
    let out = converted(&source, Format::Ply);
    let mut added = out.clone();
    let Shape::Scene(scene) = &mut added.shape else { panic!("triangles") };
    let n = scene.parts[0].mesh.positions().len();
    let colors = Attribute {
        semantic: COLOR,
        domain: chordal::explicit::Domain::Vertex,
        width: 3,
        values: vec![0.5; 3 * n],
    };
    scene.parts[0].mesh = scene.parts[0].mesh.clone().with_attribute(colors).unwrap();
    assert_seen(&added, &source, "colours were added");
}

#[test]
fn attributes_of_simplified_triangles_are_as_far_off_as_is_said() {
    let source = dome(true, true);
    for to in [Format::Ply, Format::Glb] {
        let out = meshed(&source, &spec("0.01"), to);
        let facts = certificate_of(&mut out.clone()).clone().unwrap()["attributes"].clone();
        let names: Vec<&str> =
            facts.as_array().unwrap().iter().filter_map(|of| of["name"].as_str()).collect();
        assert_eq!(names.len(), 3, "{facts}");
        let found = assert_honest(&out, &source, &to.to_string());
        for name in &names {
            assert!(proved(&found, &format!("attributes/{name}")), "{name}: {:?}", found.claims);
        }
        let edits: [ValueEdit; 3] = [
            ("flipped", Semantic::Normal, &flipped),
            ("constant", TEXCOORD, &constant),
            ("darker", COLOR, &darker),
        ];
        for (name, semantic, edit) in edits {
            assert_seen(&with_values(&out, &semantic, edit), &source, &format!("{to}: {semantic:?} {name}"));
        }
        for (k, name) in names.iter().enumerate() {
            // Both figures, as if nothing were off.
            let zeroed = with_certificate(&out, |certificate| {
                ["largest", "rms"].iter().for_each(|key| certificate["attributes"][k][*key] = json!(0.0));
            });
            assert_seen(&zeroed, &source, &format!("{to}: {name} zeroed"));
            for key in ["largest", "rms", "samples", "name", "semantic", "unit", "evidence"] {
                let was = &facts[k][key];
                let lie = match was.as_f64() {
                    Some(x) if key == "samples" => json!(x as u64 + 1),
                    Some(x) => json!(x + 50.0),
                    None => json!("lie"),
                };
                let edited = with_certificate(&out, |certificate| certificate["attributes"][k][key] = lie);
                let found = verified(&edited, &source);
                let path = format!("attributes/{k}/{key}");
                let is_listed = found.unchecked.iter().any(|own| *own == path || path.starts_with(own));
                assert!(found.verdict != ClaimVerdict::Proved || is_listed, "{to}: {path} from {was}");
            }
            let more = with_certificate(&out, |certificate| certificate["attributes"][k]["more"] = json!(1));
            assert_seen(&more, &source, "a fact that no version has");
        }
        // Without the facts the values are at least roughly those of the input.
        let silent = with_certificate(&out, |certificate| {
            certificate.as_object_mut().unwrap().remove("attributes");
        });
        let constant = with_values(&silent, &TEXCOORD, &constant);
        assert_seen(&constant, &source, "constant, and nothing is said");
    }
}

#[test]
fn normals_that_were_computed_are_computed_again() {
    let source = dome(false, false);
    let usual = meshed(&source, &spec("0.01"), Format::Glb);
    let asked = BudgetSpec { normals: Normals::Flat, ..spec("0.01") };
    let flat = meshed(&dome(false, true), &asked, Format::Glb);
    for (name, out, source) in [("usual", usual, source), ("flat", flat, dome(false, true))] {
        let found = assert_honest(&out, &source, name);
        assert!(proved(&found, "attributes/normal"), "{name}: {:?}", found.claims);
        assert_seen(&with_values(&out, &Semantic::Normal, &flipped), &source, name);
    }
}

#[test]
fn normals_of_other_shapes_look_to_the_front() {
    let patch = "1\n3 3\n0 0 0\n1 0 0\n2 0 0\n3 0 0\n0 1 0\n1 1 2\n2 1 2\n3 1 0\n\
        0 2 0\n1 2 2\n2 2 2\n3 2 0\n0 3 0\n1 3 0\n2 3 0\n3 3 0\n";
    for (source, length) in [
        (loaded(patch.as_bytes(), "a.bpt"), "0.05"),
        (loaded(b"sphere(1) & box(1.6, 1.6, 1.6)", "a.star"), "0.05"),
    ] {
        let out = meshed(&source, &spec(length), Format::Glb);
        let found = assert_honest(&out, &source, source.shape.kind());
        let is_known =
            proved(&found, "attributes/normal") || found.unchecked.contains(&"attributes/normal".to_owned());
        assert!(is_known, "{found:?}");
        assert_seen(&with_values(&out, &Semantic::Normal, &flipped), &source, source.shape.kind());
    }
}

#[test]
fn texture_coordinates_of_a_cage_are_in_its_range() {
    let mut text = String::from("vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n");
    for line in CUBE.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        match words[0] {
            "f" => {
                let corners = words[1..].iter().zip(1..).map(|(v, k)| format!(" {v}/{k}"));
                text += &format!("f{}\n", corners.collect::<String>());
            }
            _ => text += &format!("{line}\n"),
        }
    }
    let limits = Limits { surface: Some(PolygonSurface::Limit(Scheme::CatmullClark)), ..Limits::default() };
    let hint = FormatHint { name: Some("a.obj"), ..FormatHint::default() };
    let source = load(text.as_bytes(), hint, &limits).expect("readable");
    let out = meshed(&source, &spec("0.05"), Format::Glb);
    let found = assert_honest(&out, &source, "a cage");
    assert!(found.unchecked.contains(&"attributes/texcoord 0".to_owned()), "{found:?}");
    assert_seen(&with_values(&out, &TEXCOORD, &constant), &source, "constant");
    let wider = |_: usize, row: &mut [f64]| row[0] *= 3.0;
    assert_seen(&with_values(&out, &TEXCOORD, &wider), &source, "beside its range");
}

#[test]
fn attributes_of_levels_are_roughly_those_of_the_input() {
    let source = dome(false, true);
    let mut bytes = Vec::new();
    let made = lod(source.clone(), &levels_within("0.0005"), &Job::default()).expect("levels");
    made.write(Format::Glb, &mut bytes).unwrap();
    let out = loaded(&bytes, "b.glb");
    let coarser: Vec<Input> =
        (1..=n_coarser_levels(&out)).map(|level| at_level(&bytes, "b.glb", level)).collect();
    assert!(!coarser.is_empty());
    let look = |out: &Input, coarser: &[Input]| {
        let against = std::slice::from_ref(&source);
        verify_levels((out, coarser), None, against, &Job::default()).expect("verified")
    };
    let honest = look(&out, &coarser);
    assert_eq!(honest.verdict, ClaimVerdict::Proved, "{:?}", honest.worst());
    let edits: [ValueEdit; 2] = [("flipped", Semantic::Normal, &flipped), ("constant", TEXCOORD, &constant)];
    for (name, semantic, edit) in edits {
        let finest = look(&with_values(&out, &semantic, edit), &coarser);
        assert_ne!(finest.verdict, ClaimVerdict::Proved, "the finest: {name}");
        let mut lying = coarser.clone();
        lying[0] = with_values(&coarser[0], &semantic, edit);
        let found = look(&out, &lying);
        assert_ne!(found.verdict, ClaimVerdict::Proved, "a coarser one: {name}");
    }
}

#[test]
fn counts_by_the_other_topology_are_counted_again_in_every_format() {
    let teapot = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/teapot.bpt")).unwrap();
    let source = loaded(&teapot, "teapot.bpt");
    for (number, to) in [Format::Glb, Format::Gltf, Format::Stl, Format::Ply].into_iter().enumerate() {
        let made = mesh(source.clone(), &spec("5%"), to, &Job::default()).expect("reachable");
        let honest = made.certificate.to_value();
        let mut bytes = Vec::new();
        made.write(&mut bytes).unwrap();
        let out = loaded(&bytes, &format!("out.{to}"));
        let found = |certificate: &Value| {
            let mut out = out.clone();
            let is_inside = certificate_of(&mut out).is_some();
            if is_inside {
                *certificate_of(&mut out) = Some(certificate.clone());
            }
            let given = (!is_inside).then_some(certificate);
            verify(&out, given, std::slice::from_ref(&source), &Job::default()).expect("verified")
        };
        let all = found(&honest);
        assert_eq!(all.verdict, ClaimVerdict::Proved, "{to}: {:?}", all.worst());
        assert!(!all.unchecked.iter().any(|own| own.starts_with("valid")), "{to}: {:?}", all.unchecked);
        // By default each count in some of the formats.
        let step = if is_long() { 1 } else { 3 };
        let counts = honest["valid"]["other"].as_object().unwrap();
        for (key, value) in counts.iter().skip(number % step).step_by(step) {
            let mut edited = honest.clone();
            edited["valid"]["other"][key] = match value {
                Value::Bool(is) => json!(!is),
                Value::String(_) => json!("lie"),
                _ => json!(value.as_i64().unwrap_or(0) + 1),
            };
            edited["seal"] = seal_of(&edited).into();
            let found = found(&edited);
            assert_eq!(found.verdict, ClaimVerdict::Refuted, "{to}: valid/other/{key}");
        }
    }
}

#[test]
fn a_frame_is_one_and_that_of_the_file() {
    let source = dome(false, false);
    for to in [Format::Glb, Format::Ply] {
        let out = converted(&source, to);
        for (key, lie) in [
            ("up", json!("x")),
            ("up", json!(0.5)),
            ("up", json!(true)),
            ("metres_per_unit", json!("x")),
            ("metres_per_unit", json!(0.0)),
            ("metres_per_unit", json!(-1.0)),
        ] {
            let edited = with_certificate(&out, |certificate| certificate["frame"][key] = lie.clone());
            let found = verified(&edited, &source);
            assert_eq!(found.verdict, ClaimVerdict::Refuted, "{to}: {key} is {lie}");
            let claim = format!("frame/{key}");
            assert!(found.claims.iter().any(|own| own.claim == claim), "{to}: {:?}", found.claims);
        }
        let none = with_certificate(&out, |certificate| certificate["frame"] = Value::Null);
        assert_eq!(verified(&none, &source).verdict, ClaimVerdict::Refuted, "{to}");
    }
    // A glTF is in metres, and its y is up; of a PLY nobody knows.
    let glb = converted(&source, Format::Glb);
    let ply = converted(&source, Format::Ply);
    for (key, other) in [("up", json!("z")), ("metres_per_unit", json!(0.001))] {
        let edited =
            |out: &Input| with_certificate(out, |certificate| certificate["frame"][key] = other.clone());
        assert_eq!(verified(&edited(&glb), &source).verdict, ClaimVerdict::Refuted, "{key} is {other}");
        let found = verified(&edited(&ply), &source);
        let is_listed = found.unchecked.contains(&format!("frame/{key}"));
        assert!(is_listed || found.verdict != ClaimVerdict::Proved, "{key} is {other}: {found:?}");
    }
}
