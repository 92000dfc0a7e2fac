//! Histories through maps, scenes and joins: what a file says of its distance to the first shape holds, and lies are found.
use chordal::Job;
use chordal_io::{Format, Limits, Node, Scene};
use chordal_testkit::Random;
use chordal_testkit::sampler::Triangles;
use chordal_verbs::{
    BudgetSpec, ClaimVerdict, Composed, FormatHint, Input, Shape, compose_input, convert, join_input, load,
    mesh, seal_of, transform_input, verify,
};
use serde_json::{Value, json};

const IDENTITY: [f64; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

fn loaded(bytes: &[u8], name: &str) -> Input {
    let hint = FormatHint { name: Some(name), ..FormatHint::default() };
    load(bytes, hint, &Limits::default()).expect("readable")
}

/// A ball as a formula.
fn ball() -> Input {
    let list =
        b"0 var-x\n1 var-y\n2 var-z\n3 square 0\n4 square 1\n5 square 2\n6 add 3 4\n7 add 6 5\n8 sqrt 7\n\
        9 const 0.75\na sub 8 9\n";
    loaded(list, "ball.vm")
}

/// What a verb writes of an input.
fn meshed(input: Input, length: &str, to: Format) -> Vec<u8> {
    let spec = BudgetSpec { length: Some(length.parse().expect("a length")), ..BudgetSpec::default() };
    let mut bytes = Vec::new();
    let outcome = mesh(input, &spec, to, &Job::default()).expect("reachable");
    outcome.write(&mut bytes).expect("written");
    bytes
}

fn converted(input: Input, to: Format) -> (Vec<u8>, Value) {
    let outcome = convert(input, to).expect("convertible");
    let mut bytes = Vec::new();
    outcome.write(&mut bytes).expect("written");
    (bytes, outcome.certificate.to_value())
}

fn total(certificate: &Value) -> f64 {
    certificate.pointer("/history/total/at_most").and_then(Value::as_f64).expect("bounded")
}

fn affine(random: &mut Random) -> [f64; 16] {
    let mut map = IDENTITY;
    for k in [0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14] {
        map[k] += random.signed() * if k < 12 { 0.7 } else { 20.0 };
    }
    map
}

fn at(map: &[f64; 16], p: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|r| map[r] * p[0] + map[4 + r] * p[1] + map[8 + r] * p[2] + map[12 + r])
}

/// How far points of the moved ball are from the triangles of a file, sampled by code that shares nothing with the library.
fn farthest(file: &Input, maps: &[[f64; 16]], random: &mut Random) -> f64 {
    let Shape::Scene(scene) = &file.shape else { panic!("triangles") };
    let all = scene.world_meshes().expect("a tree");
    let found: Vec<Triangles> =
        all.iter().map(|(_, mesh)| Triangles::new(mesh.positions(), mesh.faces())).collect();
    let mut most: f64 = 0.0;
    for _ in 0..400 {
        let on_ball = random.direction::<3>().map(|x| 0.75 * x);
        let moved = maps.iter().rev().fold(on_ball, |p, map| at(map, p));
        let near = found.iter().map(|triangles| triangles.distance(moved)).fold(f64::INFINITY, f64::min);
        most = most.max(near);
    }
    most
}

#[test]
fn a_moved_mesh_says_in_its_file_how_far_it_is_from_the_moved_field() {
    let mut random = Random::new(41);
    let ply = meshed(ball(), "0.02", Format::Ply);
    let part = loaded(&ply, "ball.ply");
    for round in 0..12 {
        let maps: Vec<[f64; 16]> = (0..1 + round % 3).map(|_| affine(&mut random)).collect();
        let mut moved = part.clone();
        for map in maps.iter().rev() {
            moved = transform_input(&moved, map).expect("affine").0;
        }
        let to = [Format::Ply, Format::Stl, Format::Glb, Format::Obj, Format::ThreeMf][round % 5];
        let (bytes, certificate) = converted(moved, to);
        let file = loaded(&bytes, &format!("moved.{to}"));
        let (off, said) = (farthest(&file, &maps, &mut random), total(&certificate));
        assert!(off <= said && said < 0.02 * 100.0, "{off} {said} {to}");
        let verified = verify(&file, Some(&certificate), &[part.clone(), ball()], &Job::default());
        let verified = verified.expect("verified");
        assert_eq!(verified.verdict, ClaimVerdict::Proved, "{:?}", verified.worst());
        // Without the file between nothing is proved, and nothing refuted.
        let alone = verify(&file, Some(&certificate), &[ball()], &Job::default()).expect("verified");
        assert_eq!(alone.verdict, ClaimVerdict::Open);
    }
}

/// A scene of two nodes that show the same triangles, below a node of all.
fn pair(part: &Input, maps: [[f64; 16]; 3]) -> Input {
    let Shape::Scene(own) = &part.shape else { panic!("triangles") };
    let node =
        |map: [f64; 16], part, children| Node { matrix: map.into(), part, children, ..Node::default() };
    let nodes = vec![
        node(maps[0], None, vec![1, 2]),
        node(maps[1], Some(0), Vec::new()),
        node(maps[2], Some(0), Vec::new()),
    ];
    let scene = Scene { parts: own.parts.clone(), nodes, roots: vec![0], ..Scene::default() };
    let whole = Input::made(Shape::Scene(scene), Format::Ply);
    compose_input(whole, &[(1, part), (2, part)]).expect("triangles")
}

#[test]
fn a_scene_and_a_join_say_it_of_the_worst_of_their_parts() {
    let mut random = Random::new(42);
    let ply = meshed(ball(), "0.02", Format::Ply);
    let part = loaded(&ply, "ball.ply");
    for round in 0..6 {
        let maps = [affine(&mut random), affine(&mut random), affine(&mut random)];
        let scene = pair(&part, maps);
        let to = [Format::Ply, Format::Glb, Format::Stl][round % 3];
        let (bytes, certificate) = converted(scene.clone(), to);
        let file = loaded(&bytes, &format!("pair.{to}"));
        for own in [[maps[0], maps[1]], [maps[0], maps[2]]] {
            assert!(farthest(&file, &own, &mut random) <= total(&certificate));
        }
        let verified = verify(&file, Some(&certificate), &[part.clone(), ball()], &Job::default());
        assert_eq!(verified.expect("verified").verdict, ClaimVerdict::Proved);
        // What is made of that file, moved and simplified, goes on from there.
        let again = transform_input(&file, &affine(&mut random)).expect("affine").0;
        let small = meshed(again, "1%", Format::Ply);
        let small = loaded(&small, "small.ply");
        // An STL carries no certificate: there the history begins.
        let all = if to == Format::Stl { vec![file] } else { vec![file, part.clone(), ball()] };
        let verified = verify(&small, None, &all, &Job::default()).expect("verified");
        assert_eq!(verified.verdict, ClaimVerdict::Proved, "{:?}", verified.worst());
    }
    let plain = loaded(b"v 5 0 0\nv 6 0 0\nv 5 1 0\nf 1 2 3\n", "a.obj");
    let [Shape::Scene(first), Shape::Scene(second)] = [&part.shape, &plain.shape] else {
        panic!("triangles")
    };
    let mut both = first.clone();
    both.certificate = None;
    both.parts.extend(second.parts.clone());
    both.nodes.push(Node { part: Some(1), ..Node::default() });
    both.roots.push(1);
    let both = join_input(Input::made(Shape::Scene(both), Format::Ply), &[&part, &plain]).expect("triangles");
    let (bytes, certificate) = converted(both, Format::Ply);
    assert_eq!(certificate.pointer("/history/total/reference"), Some(&json!("several shapes")));
    assert!(total(&certificate) <= 0.02);
    let verified = verify(&loaded(&bytes, "b.ply"), None, &[part, ball(), plain], &Job::default());
    assert_eq!(verified.expect("verified").verdict, ClaimVerdict::Proved);
}

#[test]
fn lies_about_what_was_put_together_are_found() {
    let ply = meshed(ball(), "0.02", Format::Ply);
    let part = loaded(&ply, "ball.ply");
    let mut map = IDENTITY;
    (map[0], map[12]) = (2.0, 5.0);
    let moved = transform_input(&part, &map).expect("affine").0;
    let (bytes, certificate) = converted(moved, Format::Stl);
    let file = loaded(&bytes, "moved.stl");
    let judged = |edit: &dyn Fn(&mut Value)| {
        let mut lie = certificate.clone();
        edit(&mut lie);
        lie["seal"] = seal_of(&lie).into();
        verify(&file, Some(&lie), &[part.clone(), ball()], &Job::default()).expect("verified").verdict
    };
    assert_eq!(judged(&|_| {}), ClaimVerdict::Proved);
    let composed = "/history/steps/0/composed";
    let set = |at: &'static str, value: Value| {
        move |lie: &mut Value| *lie.pointer_mut(&format!("{composed}{at}")).expect("there") = value.clone()
    };
    // Another place, and triangles that are mirrored to another place.
    assert_eq!(judged(&set("/places/0/map/3", json!(5.1))), ClaimVerdict::Refuted);
    assert_eq!(judged(&set("/places/0/map/0", json!(-2.0))), ClaimVerdict::Refuted);
    // The sum does not fit any more.
    assert_eq!(judged(&set("/rounding", json!(0.5))), ClaimVerdict::Refuted);
    assert_eq!(judged(&set("/rounding", json!(-1.0))), ClaimVerdict::Refuted);
    assert_eq!(judged(&set("/places/0/input", json!(1))), ClaimVerdict::Refuted);
    assert_eq!(judged(&set("/places", json!([]))), ClaimVerdict::Refuted);
    assert_eq!(judged(&set("/origins", json!([]))), ClaimVerdict::Refuted);
    assert_eq!(judged(&set("/origins/0/steps/0/bound/at_most", json!(1e-9))), ClaimVerdict::Refuted);
    // An input that is said to be the truth itself: its own file says otherwise, and the sum is another one.
    assert_eq!(judged(&set("/origins/0/steps", json!([]))), ClaimVerdict::Refuted);
    let smaller = |lie: &mut Value| {
        for at in ["/history/total/at_most", "/history/total/at_least"] {
            *lie.pointer_mut(at).expect("there") = json!(1e-9);
        }
    };
    assert_eq!(judged(&smaller), ClaimVerdict::Refuted);
    // No length, and no sum of it.
    let negative = |lie: &mut Value| {
        *lie.pointer_mut("/history/steps/0/composed/rounding").expect("there") = json!(-1.0);
        *lie.pointer_mut("/history/total").expect("there") = Value::Null;
    };
    assert_eq!(judged(&negative), ClaimVerdict::Refuted);
}

#[test]
fn rounding_is_no_excuse_for_another_place() {
    let part = loaded(&meshed(ball(), "0.02", Format::Ply), "ball.ply");
    let mut map = IDENTITY;
    (map[0], map[12]) = (2.0, 5.0);
    let moved = transform_input(&part, &map).expect("affine").0;
    // It lies half a unit beside, and that is said to be rounding: with a seal and a sum that fit.
    map[12] += 0.5;
    let mut lie = transform_input(&part, &map).expect("affine").0;
    let mut said = serde_json::to_value(moved.composed.as_deref()).expect("a value");
    said["facts"]["rounding"] = json!(1.0);
    lie.composed = Some(serde_json::from_value::<Composed>(said).expect("the same").into());
    let (bytes, certificate) = converted(lie, Format::Ply);
    let verified = verify(&loaded(&bytes, "lie.ply"), Some(&certificate), &[part, ball()], &Job::default());
    let verified = verified.expect("verified");
    assert_eq!(verified.verdict, ClaimVerdict::Open);
    assert_eq!(verified.worst().map(|claim| &claim.claim[..]), Some("history/steps/0/composed/rounding"));
}

#[test]
fn a_unit_that_the_file_has_not_is_found() {
    let part = loaded(&meshed(ball(), "0.02", Format::Ply), "ball.ply");
    let mut map = IDENTITY;
    map[0] = 3.0;
    let moved = transform_input(&part, &map).expect("affine").0;
    for to in [Format::Glb, Format::ThreeMf] {
        let (bytes, certificate) = converted(moved.clone(), to);
        let file = loaded(&bytes, &format!("a.{to}"));
        for (up, metres) in [("z", json!(0.01)), ("y", json!(0.01))] {
            let mut lie = certificate.clone();
            lie["frame"] = json!({ "up": up, "metres_per_unit": metres });
            lie["seal"] = seal_of(&lie).into();
            let verified = verify(&file, Some(&lie), &[part.clone(), ball()], &Job::default());
            assert_eq!(verified.expect("verified").verdict, ClaimVerdict::Refuted, "{to} {up}");
        }
    }
}

#[test]
fn a_history_that_goes_too_deep_begins_anew() {
    let mut file = loaded(&meshed(ball(), "0.1", Format::Ply), "ball.ply");
    let mut map = IDENTITY;
    map[12] = 1.0;
    let mut has_begun_anew = false;
    for _ in 0..30 {
        let moved = transform_input(&file, &map).expect("affine").0;
        let (bytes, certificate) = converted(moved, Format::Ply);
        file = loaded(&bytes, "moved.ply");
        let origin = certificate.pointer("/history/steps/0/composed/origins/0").expect("composed");
        has_begun_anew |= origin["begins"]["code"] == "long";
        assert!(certificate.pointer("/history/total/at_most").is_some_and(Value::is_f64));
    }
    assert!(has_begun_anew);
}
