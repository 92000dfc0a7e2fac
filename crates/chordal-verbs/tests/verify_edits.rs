//! Every figure of every kind of certificate, edited and sealed again: `verify` refutes it, or says that it was not checked.
use chordal::Job;
use chordal::check::{Goal, deviation};
use chordal::explicit::subdivision::Scheme;
use chordal::implicit::{Grid, Samples};
use chordal_io::{Format, Limits};
use chordal_testkit::{is_long, some};
use chordal_verbs::{
    BakeSpec, BudgetSpec, ClaimVerdict, FormatHint, Input, LodParts, LodSpec, Normals, Shape, TileErrors,
    VerifyReport, bake, convert, geometry_digest, load, lod, mesh, n_coarser_levels, seal_of,
    transform_input, verify, verify_levels,
};
use serde_json::{Value, json};
use std::sync::LazyLock;

/// A file with its levels, and what it was made of.
struct Made {
    name: &'static str,
    out: Input,
    coarser: Vec<Input>,
    against: Vec<Input>,
}

pub(super) fn loaded(bytes: &[u8], name: &str) -> Input {
    at_level(bytes, name, 0)
}

pub(super) fn at_level(bytes: &[u8], name: &str, level: usize) -> Input {
    let hint = FormatHint { name: Some(name), ..FormatHint::default() };
    load(bytes, hint, &Limits { level, ..Limits::default() }).expect("readable")
}

/// A bumpy sphere of many triangles, `n` of which stand apart.
pub(super) fn bumpy(n: usize) -> Vec<u8> {
    let (around, up) = (32, 16);
    let mut text = String::new();
    for body in 0..n {
        let first = body * around * (up - 1) + 2 * body;
        let at = |i: usize, j: usize| {
            let (a, b) = (i as f64 / around as f64, j as f64 / up as f64);
            let (a, b) = (a * std::f64::consts::TAU, b * std::f64::consts::PI);
            let r = 1.0 + 0.05 * (5.0 * a).cos() * b.sin().powi(3);
            let x = r * b.sin() * a.cos() + 3.0 * body as f64;
            format!("v {x} {} {}\n", r * b.sin() * a.sin(), r * b.cos())
        };
        for j in 1..up {
            (0..around).for_each(|i| text += &at(i, j));
        }
        text += &at(0, 0);
        text += &at(0, up);
        let row = |i: usize, j: usize| first + (j - 1) * around + i % around + 1;
        let (top, bottom) = (first + around * (up - 1) + 1, first + around * (up - 1) + 2);
        for i in 0..around {
            text += &format!("f {top} {} {}\n", row(i, 1), row(i + 1, 1));
            text += &format!("f {bottom} {} {}\n", row(i + 1, up - 1), row(i, up - 1));
            for j in 1..up - 1 {
                let (a, b, c, d) = (row(i, j), row(i, j + 1), row(i + 1, j + 1), row(i + 1, j));
                text += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
            }
        }
    }
    text.into_bytes()
}

fn meshed(input: &Input, length: &str) -> Vec<u8> {
    let spec = BudgetSpec { length: Some(length.parse().unwrap()), ..BudgetSpec::default() };
    let mut bytes = Vec::new();
    let made = mesh(input.clone(), &spec, Format::Ply, &Job::default()).expect("reachable");
    made.write(&mut bytes).unwrap();
    bytes
}

const PATCH: &str = "1\n3 3\n0 0 0\n1 0 0\n2 0 0\n3 0 0\n0 1 0\n1 1 2\n2 1 2\n3 1 0\n\
    0 2 0\n1 2 2\n2 2 2\n3 2 0\n0 3 0\n1 3 0\n2 3 0\n3 3 0\n";

pub(super) const CUBE: &str = "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n\
    f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";

const BALL: &str = "0 var-x\n1 var-y\n2 var-z\n3 square 0\n4 square 1\n5 square 2\n6 add 3 4\n7 add 6 5\n8 sqrt 7\n\
    9 const 0.75\na sub 8 9\n";

/// An octahedron as samples of a sum of distances, four voxels across.
pub(super) fn volume() -> Vec<u8> {
    let n = 4;
    let mut text = format!(
        "NRRD0004\ntype: double\ndimension: 3\nsizes: {n} {n} {n}\nspacings: 1 1 1\nencoding: text\n\n"
    );
    for k in 0..n {
        for j in 0..n {
            for i in 0..n {
                let sum = [i, j, k].map(|x| (f64::from(x) - 1.5).abs()).iter().sum::<f64>();
                text += &format!("{} ", sum - 1.7);
            }
        }
    }
    text.into_bytes()
}

fn simplified() -> Made {
    let source = loaded(&bumpy(1), "a.obj");
    let out = loaded(&meshed(&source, "0.03"), "b.ply");
    Made { name: "simplified", out, coarser: Vec::new(), against: vec![source] }
}

/// Levels of a shape, the first within this length.
pub(super) fn levels_within(length: &str) -> LodSpec {
    let chordal::View::MinDistance(lens) = "1920x1080 fov=60 dist=1".parse().unwrap() else { unreachable!() };
    LodSpec {
        pixels: "1px".parse().unwrap(),
        lens,
        nearest: None,
        length: Some(length.parse().unwrap()),
        distances: Vec::new(),
        normals: Normals::Auto,
        attributes: Default::default(),
        errors: TileErrors::Plain,
        tile_triangles: None,
        parts: LodParts::Separate,
        place: None,
        packing: Default::default(),
    }
}

fn levels() -> Made {
    let source = loaded(&bumpy(1), "a.obj");
    let spec = levels_within("0.01");
    let mut bytes = Vec::new();
    lod(source.clone(), &spec, &Job::default()).unwrap().write(Format::Glb, &mut bytes).unwrap();
    let out = loaded(&bytes, "b.glb");
    let coarser = (1..=n_coarser_levels(&out)).map(|level| at_level(&bytes, "b.glb", level)).collect();
    Made { name: "levels", out, coarser, against: vec![source] }
}

fn baked() -> Made {
    let source = loaded(&bumpy(1), "a.obj");
    let spec = BakeSpec { band: Some(3.0), ..BakeSpec::cells(16) };
    let mut bytes = Vec::new();
    bake(source.clone(), &spec, Format::Nrrd, &Job::default()).unwrap().write(&mut bytes).unwrap();
    Made { name: "baked", out: loaded(&bytes, "b.nrrd"), coarser: Vec::new(), against: vec![source] }
}

fn composed() -> Made {
    let ball = loaded(BALL.as_bytes(), "a.vm");
    let file = loaded(&meshed(&ball, "0.02"), "b.ply");
    let mut map = [0.0; 16];
    (map[0], map[5], map[10], map[12], map[15]) = (1.0, 1.0, 1.0, 5.0, 1.0);
    let (moved, _) = transform_input(&file, &map).unwrap();
    let mut bytes = Vec::new();
    convert(moved, Format::Ply).unwrap().write(&mut bytes).unwrap();
    Made { name: "composed", out: loaded(&bytes, "c.ply"), coarser: Vec::new(), against: vec![ball, file] }
}

/// One of each kind, made once for all tests.
static ALL: LazyLock<Vec<Made>> = LazyLock::new(all);

fn all() -> Vec<Made> {
    let of = |name: &'static str, source: Input, length: &str| {
        let out = loaded(&meshed(&source, length), "b.ply");
        Made { name, out, coarser: Vec::new(), against: vec![source] }
    };
    let limits = Limits {
        surface: Some(chordal_verbs::PolygonSurface::Limit(Scheme::CatmullClark)),
        ..Limits::default()
    };
    let cage = load(CUBE.as_bytes(), FormatHint { name: Some("a.obj"), ..FormatHint::default() }, &limits);
    vec![
        simplified(),
        of("several parts", loaded(&bumpy(2), "a.obj"), "0.03"),
        of("patches", loaded(PATCH.as_bytes(), "a.bpt"), "0.05"),
        of("cage", cage.unwrap(), "0.05"),
        of("field", loaded(BALL.as_bytes(), "a.vm"), "0.02"),
        of("volume", loaded(&volume(), "a.nrrd"), "0.1"),
        levels(),
        baked(),
        composed(),
    ]
}

pub(super) fn certificate_of(input: &mut Input) -> &mut Option<Value> {
    match &mut input.shape {
        Shape::Scene(scene) => &mut scene.certificate,
        Shape::Volume(sampled) => &mut sampled.volume.certificate,
        _ => panic!("no file of these"),
    }
}

impl Made {
    /// What is tried of it, so many at most: of cages and volumes one, which take long each time.
    fn share_of<T>(&self, all: Vec<T>, most: usize) -> Vec<T> {
        some(all, if ["cage", "volume"].contains(&self.name) { 1 } else { most })
    }

    fn certificate(&self) -> Value {
        certificate_of(&mut self.out.clone()).clone().expect("a certificate")
    }

    /// What is said of another certificate in the file, sealed again.
    fn with(&self, mut certificate: Value) -> VerifyReport {
        certificate["seal"] = seal_of(&certificate).into();
        let mut out = self.out.clone();
        *certificate_of(&mut out) = Some(certificate);
        verify_levels((&out, &self.coarser), None, &self.against, &Job::default()).expect("verified")
    }
}

/// The paths of all values that are neither objects nor lists.
fn leaves(value: &Value, path: &str, found: &mut Vec<String>) {
    match value {
        Value::Object(all) => all.iter().for_each(|(key, own)| leaves(own, &format!("{path}/{key}"), found)),
        Value::Array(all) => {
            all.iter().enumerate().for_each(|(k, own)| leaves(own, &format!("{path}/{k}"), found));
        }
        Value::Null => {}
        _ => found.push(path.to_owned()),
    }
}

/// A lie in place of a value: nothing that is weaker, and so true as well.
fn lie(certificate: &Value, at: &str) -> Option<Value> {
    let value = certificate.pointer(at)?;
    let (above, key) = at.rsplit_once('/')?;
    let number = value.as_f64();
    Some(match key {
        "at_most" | "off_at_most" => json!(0.5 * number?),
        "at_least" => {
            let more = 0.999 * certificate.pointer(above)?.get("at_most")?.as_f64()?;
            json!(Some(more).filter(|more| *more > number.unwrap_or(0.0))?)
        }
        _ => match value {
            Value::Bool(is) => json!(!is),
            Value::String(_) => json!("lie"),
            _ if value.is_u64() || value.is_i64() => json!(value.as_i64()? + 1),
            _ => json!(number? + 1.0),
        },
    })
    .filter(|lie| lie != value)
}

/// The same lie wherever the certificate says that of its bound: in the bound, the last step and the sum.
fn everywhere(certificate: &Value, at: &str, lie: &Value) -> Value {
    let mut edited = certificate.clone();
    *edited.pointer_mut(at).unwrap() = lie.clone();
    if let Some(key) = at.strip_prefix("/bound/") {
        let last = certificate["history"]["steps"].as_array().map_or(0, Vec::len).saturating_sub(1);
        for other in [format!("/history/steps/{last}/bound/{key}"), format!("/history/total/{key}")] {
            if let Some(own) = edited.pointer_mut(&other) {
                *own = lie.clone();
            }
        }
    }
    edited
}

fn is_told(report: &VerifyReport, at: &str) -> bool {
    let at = at.trim_start_matches('/');
    report.unchecked.iter().any(|own| at == own || at.starts_with(&format!("{own}/")))
}

/// Whether a larger lower end was shown, and so is no lie.
fn is_shown(report: &VerifyReport, at: &str) -> bool {
    let is_least = |claim: &str| at.ends_with("/at_least") && claim.ends_with("bound/at_least");
    report.claims.iter().any(|own| own.verdict == ClaimVerdict::Proved && is_least(&own.claim))
}

/// What becomes of a sample, by its number and its value.
type SampleEdit<'a> = &'a dyn Fn(usize, f64) -> f64;

#[test]
fn honest_files_of_all_kinds_are_re_proved() {
    for made in ALL.iter() {
        let found = made.with(made.certificate());
        assert_eq!(found.verdict, ClaimVerdict::Proved, "{}: {:?}", made.name, found.worst());
    }
}

#[test]
fn every_edited_fact_is_refuted_or_said_to_be_unchecked() {
    for (number, made) in ALL.iter().enumerate() {
        let honest = made.certificate();
        let mut paths = Vec::new();
        leaves(&honest, "", &mut paths);
        assert!(paths.len() > 20, "{}: {}", made.name, paths.len());
        paths.retain(|at| at != "/seal");
        // By default each fact in a fourth of the kinds, since most have the same facts.
        let step = if is_long() { 1 } else { 4 };
        let paths: Vec<String> = paths.into_iter().skip(number % step).step_by(step).collect();
        for at in &made.share_of(paths, usize::MAX) {
            let Some(lie) = lie(&honest, at) else { continue };
            let mut edited = honest.clone();
            *edited.pointer_mut(at).unwrap() = lie.clone();
            let mut certificates = vec![edited, everywhere(&honest, at, &lie)];
            certificates.dedup();
            for certificate in certificates {
                let found = made.with(certificate);
                let is_known = is_told(&found, at) || is_shown(&found, at);
                let is_seen = found.verdict != ClaimVerdict::Proved || is_known;
                assert!(is_seen, "{}: {at} from {} to {lie}", made.name, honest.pointer(at).unwrap());
            }
        }
    }
}

#[test]
fn more_at_least_than_a_tenth_above_the_truth_is_refuted_and_what_is_nearer_is_listed() {
    let goal = Goal::default();
    assert_eq!(goal.relative, 0.1, "what is judged here is as close as verify looks");
    let mut n_refuted = 0;
    for made in ALL.iter().filter(|made| made.coarser.is_empty()) {
        let [Input { shape: Shape::Scene(read), .. }] = &made.against[..] else { continue };
        let Shape::Scene(written) = &made.out.shape else { continue };
        let ([from], [to]) = (&read.parts[..], &written.parts[..]) else { panic!("one part each") };
        let judged = deviation(&to.mesh, &from.mesh, &goal, &Job::default()).unwrap().bound;
        let honest = made.certificate();
        let end = |key: &str| honest["bound"][key].as_f64().unwrap();
        for wider in [1.0, 2.0] {
            let (at_most, at_least) = (wider * end("at_most"), 0.999 * wider * end("at_most"));
            if at_least <= end("at_least") {
                continue;
            }
            let widened = everywhere(&honest, "/bound/at_most", &json!(at_most));
            let found = made.with(everywhere(&widened, "/bound/at_least", &json!(at_least)));
            let must_be_refuted = judged.at_most().is_some_and(|most| most < at_least);
            if must_be_refuted || found.verdict == ClaimVerdict::Refuted {
                assert_eq!(found.verdict, ClaimVerdict::Refuted, "{}: {judged:?}", made.name);
                n_refuted += 1;
                continue;
            }
            assert_eq!(found.verdict, ClaimVerdict::Proved, "{}: {:?}", made.name, found.worst());
            let listed = ["/bound/at_least", "/history/steps/0/bound/at_least", "/history/total/at_least"];
            let is_listed = listed.iter().all(|at| is_told(&found, at));
            assert!(is_listed || is_shown(&found, "/bound/at_least"), "{}: {found:?}", made.name);
        }
    }
    assert!(n_refuted > 1, "{n_refuted}");
}

#[test]
fn a_bound_against_another_shape_is_refuted() {
    let names = ["curves", "bezier patches", "nurbs surfaces", "limit surface", "input triangles", "field"];
    for made in ALL.iter() {
        let honest = made.certificate();
        let Some(own) = honest.pointer("/bound/reference") else { continue };
        for name in made.share_of(names.iter().filter(|name| own != **name).collect(), 3) {
            let found = made.with(everywhere(&honest, "/bound/reference", &json!(name)));
            assert_eq!(found.verdict, ClaimVerdict::Refuted, "{}: {own} as {name}", made.name);
        }
    }
}

#[test]
fn steps_that_are_left_out_are_missed() {
    let made = composed();
    let mut certificate = made.certificate();
    let origin = certificate.pointer_mut("/history/steps/0/composed/origins/0").unwrap();
    let begins = json!({ "code": "no-certificate", "reason": "the input carries no certificate" });
    *origin = json!({ "begins": begins, "steps": [], "total": null });
    let bound = certificate["history"]["steps"][0]["bound"].clone();
    let rounding = certificate.pointer("/history/steps/0/composed/rounding").unwrap().as_f64().unwrap();
    certificate["history"]["total"] = bound;
    certificate["history"]["total"]["at_most"] = json!(rounding);
    let found = made.with(certificate);
    assert_eq!(found.verdict, ClaimVerdict::Refuted, "{:?}", found.claims);
    assert!(found.claims.iter().any(|claim| claim.claim.ends_with("begins")), "{:?}", found.claims);
}

#[test]
fn edited_levels_are_refuted() {
    let made = ALL.iter().find(|made| made.name == "levels").expect("levels");
    assert!(made.coarser.len() > 1);
    let honest = made.with(made.certificate());
    assert_eq!(honest.verdict, ClaimVerdict::Proved, "{:?}", honest.worst());
    // Without them nothing is known of them.
    let alone = verify(&made.out, None, &made.against, &Job::default()).unwrap();
    assert_eq!(alone.verdict, ClaimVerdict::Open);
    for k in 0..made.coarser.len() {
        // 1. A vertex is moved, and who does so says the digest of that.
        let mut coarser = made.coarser.clone();
        let Shape::Scene(scene) = &mut coarser[k].shape else { panic!() };
        let mut positions = scene.parts[0].mesh.positions().to_vec();
        let moved = positions[7];
        positions.iter_mut().filter(|p| **p == moved).for_each(|p| *p = [0.0; 3]);
        scene.parts[0].mesh = scene.parts[0].mesh.with_positions(positions).unwrap();
        let geometry = geometry_digest(&coarser[k].shape).unwrap().unwrap();
        for sealed in [false, true] {
            let mut lying = coarser.clone();
            if let Some(certificate) = certificate_of(&mut lying[k]).as_mut().filter(|_| sealed) {
                certificate["history"]["steps"][0]["output"]["geometry"] = json!(geometry);
                certificate["seal"] = seal_of(certificate).into();
            }
            let levels = (&made.out, &lying[..]);
            let found = verify_levels(levels, None, &made.against, &Job::default()).unwrap();
            assert_eq!(found.verdict, ClaimVerdict::Refuted, "level {}, {sealed}", k + 1);
        }
        // 2. Each figure of its certificate.
        let Some(honest) = certificate_of(&mut made.coarser.clone()[k]).clone() else { continue };
        let mut paths = Vec::new();
        leaves(&honest, "", &mut paths);
        // By default each fact at a third of the levels.
        let step = if is_long() { 1 } else { 3 };
        for at in paths.iter().filter(|at| *at != "/seal").skip(k % step).step_by(step) {
            let Some(lie) = lie(&honest, at) else { continue };
            let mut certificate = everywhere(&honest, at, &lie);
            certificate["seal"] = seal_of(&certificate).into();
            let mut lying = made.coarser.clone();
            *certificate_of(&mut lying[k]) = Some(certificate);
            let found = verify_levels((&made.out, &lying), None, &made.against, &Job::default()).unwrap();
            let is_own = found.unchecked.contains(&format!("levels/{}{at}", k + 1));
            let is_known = is_own || is_told(&found, at) || is_shown(&found, at);
            let is_seen = found.verdict != ClaimVerdict::Proved || is_known;
            assert!(is_seen, "level {}: {at} to {lie}", k + 1);
        }
    }
}

#[test]
fn signs_of_baked_samples_are_looked_at() {
    let made = baked();
    let Shape::Volume(sampled) = &made.out.shape else { panic!() };
    let grid = sampled.volume.grid.clone();
    let [nx, ny, nz] = grid.size();
    let values: Vec<f64> = (0..nz)
        .flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
        .map(|at| grid.sample(at))
        .collect();
    let most = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let edits: [(&str, SampleEdit); 5] = [
        ("all", &|_, x| -x),
        ("every second", &|k, x| if k % 2 == 0 { -x } else { x }),
        ("the farthest", &|_, x| if x.abs() >= most { -x } else { x }),
        ("no inside at all", &|_, x| x.abs()),
        ("those near the surface", &|_, x| if x.abs() < 0.3 * most { -x } else { x }),
    ];
    for (name, edit) in edits {
        let edited: Vec<f64> = values.iter().enumerate().map(|(k, x)| edit(k, *x)).collect();
        let mut out = made.out.clone();
        let Shape::Volume(sampled) = &mut out.shape else { panic!() };
        sampled.volume.grid = Grid::new(grid.size(), Samples::F64(edited), *grid.affine()).unwrap();
        let geometry = geometry_digest(&out.shape).unwrap().unwrap();
        let mut certificate = made.certificate();
        let last = certificate["history"]["steps"].as_array().unwrap().len() - 1;
        certificate["history"]["steps"][last]["output"]["geometry"] = json!(geometry);
        let lying = Made { out, ..baked() };
        let found = lying.with(certificate);
        assert_eq!(found.verdict, ClaimVerdict::Refuted, "{name}: {:?}", found.claims);
        assert!(
            found
                .claims
                .iter()
                .any(|claim| claim.claim == "baked/sides" && claim.verdict == ClaimVerdict::Refuted),
            "{name}"
        );
    }
}
