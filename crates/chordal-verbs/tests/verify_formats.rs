//! Honest files of every kind of shape in every format that is written: `verify` re-proves them, and refutes each whose
//! surface was moved, whatever its certificate says.
use super::verify_edits::{CUBE, at_level, bumpy, certificate_of, levels_within, loaded, volume};
use chordal::Job;
use chordal::explicit::subdivision::Scheme;
use chordal_io::{FileSet, Format, Limits};
use chordal_testkit::{is_long, some};
use chordal_verbs::{
    BakeSpec, BudgetSpec, ClaimFacts, ClaimVerdict, FormatHint, Input, PolygonSurface, Shape, VerifyReport,
    bake, convert, geometry_digest, load, load_with, lod, mesh, n_coarser_levels, seal_of, transform_input,
    verify, verify_levels,
};
use serde_json::{Value, json};

/// A shape with a length that a few hundred triangles fit.
struct Source {
    name: &'static str,
    input: Input,
    length: &'static str,
}

fn example(name: &str) -> Vec<u8> {
    std::fs::read(format!("{}/../../examples/{name}", env!("CARGO_MANIFEST_DIR"))).expect("an example")
}

fn sources() -> Vec<Source> {
    let limits = Limits { surface: Some(PolygonSurface::Limit(Scheme::CatmullClark)), ..Limits::default() };
    let hint = FormatHint { name: Some("a.obj"), ..FormatHint::default() };
    let cage = load(&example("cube.obj"), hint, &limits).expect("readable");
    let script = b"sphere(1) & box(1.6, 1.6, 1.6)";
    let shapes = b"{'ball': sphere(1) & box(1.6, 1.6, 1.6), 'block': move(box(1, 1, 1), 5, 0, 0)}";
    let of = |name, input, length| Source { name, input, length };
    vec![
        of("triangles", loaded(&bumpy(1), "a.obj"), "0.05"),
        of("patches", loaded(&example("teapot.bpt"), "a.bpt"), "2%"),
        of("cage", cage, "1%"),
        of("script", loaded(script, "a.star"), "0.05"),
        of("shapes", loaded(shapes, "a.star"), "0.05"),
        of("volume", loaded(&volume(), "a.nrrd"), if is_long() { "0.1" } else { "0.3" }),
    ]
}

fn triangle_formats() -> impl Iterator<Item = Format> {
    Format::all().filter(|format| format.holds_triangles())
}

/// A file with those beside it, read again.
fn read(set: &FileSet<'_>, format: Format) -> Input {
    let hint = FormatHint { format: Some(format), ..FormatHint::default() };
    let mut open = |name: &str| -> Result<Vec<u8>, String> {
        let found = set.beside.iter().find(|file| file.name == name);
        found.map(|file| file.bytes.to_vec()).ok_or_else(|| format!("there is no '{name}'"))
    };
    load_with(&set.document, hint, &mut open, &Limits::default()).expect("readable")
}

fn alone(document: Vec<u8>) -> FileSet<'static> {
    FileSet { document, beside: Vec::new() }
}

/// The same file where the vertex that is farthest along an axis is farther by so much; the certificate's digest and seal are
/// those of a liar.
fn moved(file: &Input, by: f64) -> (Input, Value) {
    let mut out = file.clone();
    let Shape::Scene(scene) = &mut out.shape else { panic!("triangles") };
    let part = &mut scene.parts[0];
    let mut positions = part.mesh.positions().to_vec();
    let far = positions.iter().copied().reduce(|a, b| if b[0] > a[0] { b } else { a }).expect("a vertex");
    positions.iter_mut().filter(|p| **p == far).for_each(|p| p[0] += by);
    part.mesh = part.mesh.with_positions(positions).expect("finite");
    let geometry = geometry_digest(&out.shape).expect("a tree").expect("triangles have one");
    let mut certificate = certificate_of(&mut out).clone().expect("a certificate");
    let last = certificate["history"]["steps"].as_array().map_or(0, Vec::len) - 1;
    certificate["history"]["steps"][last]["output"]["geometry"] = json!(geometry);
    certificate["seal"] = seal_of(&certificate).into();
    *certificate_of(&mut out) = Some(certificate.clone());
    (out, certificate)
}

fn assert_proved(report: &VerifyReport, what: &str) {
    assert_eq!(report.verdict, ClaimVerdict::Proved, "{what}: {:?}", report.worst());
    assert!(report.claims.iter().any(|own| own.claim.ends_with("/bound")), "{what}: no bound was looked at");
}

#[test]
fn what_is_meshed_is_re_proved_in_every_format() {
    let all = sources();
    let n_kinds = all.len();
    for (number, Source { name, input, length }) in all.into_iter().enumerate() {
        for (k, format) in triangle_formats().enumerate() {
            // Each kind in formats of its own, and each format once; all in all in the long sweep.
            let is_own = k % n_kinds == number;
            if !is_own && !is_long() {
                continue;
            }
            let what = format!("{name} as {format}");
            let spec = BudgetSpec { length: Some(length.parse().unwrap()), ..BudgetSpec::default() };
            let made = mesh(input.clone(), &spec, format, &Job::default()).expect("reachable");
            let report = json!({ "certificate": made.certificate.to_value() });
            let mut out = read(&made.write_files("out").expect("written"), format);
            let is_in_file = certificate_of(&mut out).is_some();
            assert_eq!(is_in_file, format != Format::Stl, "{what}");
            let given = (!is_in_file).then_some(&report);
            let against = [input.clone()];
            let found = verify(&out, given, &against, &Job::default()).expect("verified");
            assert_proved(&found, &what);
            let most = made.bound.at_most().expect("bounded");
            if !is_in_file || !is_own {
                continue;
            }
            let (lying, _) = moved(&out, 10.0 * most);
            let found = verify(&lying, None, &against, &Job::default()).expect("verified");
            let is_refuted = |own: &str| {
                found.claims.iter().any(|of| of.claim.ends_with(own) && of.verdict == ClaimVerdict::Refuted)
            };
            assert!(is_refuted("steps/0/bound"), "{what}, moved: {:?}", found.claims);
        }
    }
}

#[test]
fn what_was_moved_is_re_proved_in_every_format() {
    let source = loaded(b"sphere(1)", "a.star");
    let spec = BudgetSpec { length: Some("0.05".parse().unwrap()), ..BudgetSpec::default() };
    let made = mesh(source.clone(), &spec, Format::Ply, &Job::default()).expect("reachable");
    let part = read(&made.write_files("part").expect("written"), Format::Ply);
    let mut map = [0.0; 16];
    (map[1], map[4], map[10], map[12], map[15]) = (2.0, -2.0, 1.5, 5.0, 1.0);
    // By default in every second format: all are in the test above.
    let all: Vec<Format> = triangle_formats().collect();
    let n = all.len().div_ceil(2);
    for format in some(all, n) {
        let (moved, _) = transform_input(&part, &map).expect("affine");
        let made = convert(moved, format).expect("convertible");
        let report = json!({ "certificate": made.certificate.to_value() });
        let mut out = read(&made.write_files("out").expect("written"), format);
        let given = certificate_of(&mut out).is_none().then_some(&report);
        let against = [part.clone(), source.clone()];
        let found = verify(&out, given, &against, &Job::default()).expect("verified");
        assert_proved(&found, &format!("a moved ball as {format}"));
    }
}

#[test]
fn levels_are_re_proved_in_both_forms_of_gltf() {
    let source = loaded(&bumpy(1), "a.obj");
    let spec = levels_within("0.02");
    let made = lod(source.clone(), &spec, &Job::default()).expect("levels");
    for format in Format::all().filter(|format| format.is_gltf()) {
        let mut bytes = Vec::new();
        made.write(format, &mut bytes).expect("written");
        let name = format!("out.{format}");
        let out = loaded(&bytes, &name);
        let coarser: Vec<Input> =
            (1..=n_coarser_levels(&out)).map(|level| at_level(&bytes, &name, level)).collect();
        assert!(!coarser.is_empty());
        let against = [source.clone()];
        let found = verify_levels((&out, &coarser), None, &against, &Job::default()).expect("verified");
        assert_proved(&found, &name);
    }
}

#[test]
fn what_is_baked_is_re_proved_in_every_format() {
    let source = loaded(CUBE.as_bytes(), "a.obj");
    for format in Format::all().filter(|format| format.holds_volumes()) {
        let made = bake(source.clone(), &BakeSpec::cells(8), format, &Job::default()).expect("baked");
        let report = json!({ "certificate": made.certificate.to_value() });
        let mut bytes = Vec::new();
        made.write(&mut bytes).expect("written");
        let mut out = read(&alone(bytes), format);
        let given = certificate_of(&mut out).is_none().then_some(&report);
        let found = verify(&out, given, std::slice::from_ref(&source), &Job::default()).expect("verified");
        // An array holds samples without a place, so no digest of both is in its certificate.
        let is_expected = |own: &ClaimFacts| {
            own.verdict == ClaimVerdict::Proved || format == Format::Npy && own.claim == "geometry"
        };
        let missed: Vec<_> = found.claims.iter().filter(|own| !is_expected(own)).collect();
        assert!(missed.is_empty(), "{format}: {missed:?}");
        assert!(found.claims.iter().any(|own| own.claim == "baked/off_at_most"), "{format}");
    }
}
