//! The verb `mesh`: the chain from the parsed numbers to the triangles in the file.
use chordal::budget::{PixelBudget, Reference, RefusalCode, RequiredEvidence};
use chordal::explicit::{Attribute, Domain, Semantic};
use chordal::implicit::leaves::{Leaf, LeafError};
use chordal::implicit::{Expr, Field};
use chordal::math::Box3;
use chordal::{Bound, Evidence, Job, Mesh, Patch};
use chordal_io::{Format, Frame, Limits, Node, Scene};
use chordal_verbs::report::BoundFacts;
use chordal_verbs::{
    BudgetSpec, ConvertedShape, FormatHint, ImplicitShape, Input, MeshFailure, MeshOutcome, Normals, Shape,
    convert, inspect, load, mesh,
};
use std::sync::Arc;

const FORMATS: [(Format, &str); 10] = [
    (Format::Obj, "obj"),
    (Format::Ply, "ply"),
    (Format::Stl, "stl"),
    (Format::Glb, "glb"),
    (Format::Gltf, "gltf"),
    (Format::Off, "off"),
    (Format::ThreeMf, "3mf"),
    (Format::Vtp, "vtp"),
    (Format::Usda, "usda"),
    (Format::Usdz, "usdz"),
];

fn input(shape: Shape) -> Input {
    Input {
        shape,
        format: Format::Bpt,
        letters: None,
        n_bytes: 0,
        digest: "0".repeat(64).into(),
        files: Vec::new(),
        warnings: Vec::new(),
        composed: None,
        source: None,
    }
}

/// One bent patch of about unit size at a place.
fn patch_at(origin: [f64; 3]) -> Input {
    let mut patch = Patch::flat(origin, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    for (i, j) in [(1, 1), (1, 2), (2, 1), (2, 2)] {
        patch.control[i][j][2] += 0.7;
    }
    input(Shape::Patches { patches: vec![patch], frame: Frame::default() })
}

fn length(text: &str) -> BudgetSpec {
    BudgetSpec { length: Some(text.parse().unwrap()), ..BudgetSpec::default() }
}

#[test]
fn rounding_to_the_format_is_set_aside_first_and_added_to_the_bound() {
    // Far from zero single precision has steps of 1/64 here, so that rounding is most of the error.
    let far = [200_000.3, -150_000.7, 90_000.1];
    let exact = mesh(patch_at(far), &length("0.1"), Format::Ply, &Job::default()).unwrap();
    let rounded = mesh(patch_at(far), &length("0.1"), Format::Stl, &Job::default()).unwrap();
    let meshes = [&exact, &rounded].map(|outcome| &outcome.scene().unwrap().parts[0].mesh);
    assert!(meshes[1].positions().iter().flatten().all(|x| f64::from(*x as f32) == *x));
    assert!(meshes[0].positions().iter().flatten().any(|x| f64::from(*x as f32) != *x));
    // Less was left for the triangles, so there are more of them, and still the sum is within the budget.
    assert!(meshes[1].faces().len() > meshes[0].faces().len());
    assert!(rounded.bound.at_most().unwrap() <= 0.1);
    assert_eq!(rounded.bound.evidence(), &Evidence::Proved);
    assert_eq!(rounded.bound.reference, Reference::BezierPatches);

    let refused = mesh(patch_at(far), &length("0.01"), Format::Stl, &Job::default()).unwrap_err();
    assert_eq!((refused.code(), refused.exit_code()), ("below-precision", 5));
    // GLB keeps positions about an origin, and has room.
    assert!(mesh(patch_at(far), &length("0.01"), Format::Glb, &Job::default()).is_ok());
}

#[test]
fn a_percentage_is_of_the_surface_and_not_of_its_control_points() {
    let outcome = mesh(patch_at([0.0; 3]), &length("1%"), Format::Obj, &Job::default()).unwrap();
    let asked = outcome.certificate.budget.as_ref().unwrap().length.unwrap();
    let height = 0.5625 * 0.7;
    let true_diagonal = f64::sqrt(2.0 + height * height);
    assert!(asked <= 0.01 * true_diagonal && asked > 0.00999 * true_diagonal, "{asked}");
    assert!(outcome.certificate.notes[0].contains("1%"), "{:?}", outcome.certificate.notes);
}

#[test]
fn a_unit_needs_an_input_that_has_one() {
    let mut known = patch_at([0.0; 3]);
    let unknown = mesh(known.clone(), &length("1mm"), Format::Obj, &Job::default()).unwrap_err();
    assert_eq!((unknown.code(), unknown.exit_code()), ("length", 2));
    known.shape.frame_mut().metres_per_unit = Some(0.01);
    let outcome = mesh(known, &length("1mm"), Format::Obj, &Job::default()).unwrap();
    assert_eq!(outcome.certificate.budget.unwrap().length, Some(0.1));
}

#[test]
fn pixels_are_bounded_along_the_whole_chain() {
    for view in ["1920x1080 fov=45 dist=4", "640x480 fov=60 eye=3,4,5 target=0.5,0.5,0", "800x600 height=2"] {
        let pixels = PixelBudget { pixels: "0.25px".parse().unwrap(), view: view.parse().unwrap() };
        let spec = BudgetSpec { pixels: Some(pixels), ..BudgetSpec::default() };
        for (format, name) in FORMATS {
            let outcome = mesh(patch_at([0.0; 3]), &spec, format, &Job::default()).unwrap();
            let found = outcome.bound.pixels.unwrap();
            assert!(found > 0.0 && found <= 0.25, "{name} {view}: {found}");
        }
    }
}

#[test]
fn the_number_of_triangles_is_kept_and_the_bound_is_what_it_comes_to() {
    let spec = BudgetSpec { triangles: Some(200), ..BudgetSpec::default() };
    let few = mesh(patch_at([0.0; 3]), &spec, Format::Glb, &Job::default()).unwrap();
    let output = few.certificate.output.unwrap();
    assert!(output.triangles().unwrap().triangles <= 200);
    let both = BudgetSpec { triangles: Some(200), ..length("1e-5") };
    let MeshFailure::Unmet(best) = mesh(patch_at([0.0; 3]), &both, Format::Glb, &Job::default()).unwrap_err()
    else {
        panic!("200 triangles cannot be that close")
    };
    assert!(best.certificate.output.unwrap().triangles().unwrap().triangles <= 200);
    assert!(best.bound.at_most().unwrap() > 1e-5);
    assert!(best.certificate.notes.iter().any(|note| note.contains("not met")));
}

#[test]
fn a_cancelled_job_has_no_result() {
    let job = Job::default();
    job.cancel();
    let stopped = mesh(patch_at([0.0; 3]), &length("1e-3"), Format::Obj, &job).unwrap_err();
    assert_eq!((stopped, 130), (MeshFailure::Cancelled, MeshFailure::Cancelled.exit_code()));
}

#[test]
fn a_budget_without_a_limit_and_a_format_without_triangles_are_refused() {
    let none = mesh(patch_at([0.0; 3]), &BudgetSpec::default(), Format::Obj, &Job::default()).unwrap_err();
    assert_eq!(none.code(), "budget");
    let no_mesh = mesh(patch_at([0.0; 3]), &length("1"), Format::Bpt, &Job::default()).unwrap_err();
    assert_eq!((no_mesh.code(), no_mesh.exit_code()), ("usage", 2));
}

/// Triangles in all formats read back as what was certified, number for number.
#[test]
fn what_is_written_is_what_was_certified() {
    for (format, name) in FORMATS {
        for shape in [patch_at([0.1, 0.2, 0.3]), input(Shape::Scene(two_parts()))] {
            let outcome = mesh(shape, &length("0.01"), format, &Job::default()).unwrap();
            let mut bytes = Vec::new();
            outcome.write(&mut bytes).unwrap();
            let read = load(
                &bytes,
                FormatHint { format: Some(format), ..FormatHint::default() },
                &Limits::default(),
            )
            .unwrap();
            let Shape::Scene(read) = read.shape else { panic!("{name} holds triangles") };
            let corners = |scene: &Scene| -> Vec<[[f64; 3]; 3]> {
                let all = scene.world_meshes().unwrap();
                let mut all: Vec<_> = all
                    .iter()
                    .flat_map(|(_, mesh)| (0..mesh.faces().len()).map(|f| mesh.corners(f)))
                    .collect();
                all.sort_by(|a, b| a.partial_cmp(b).unwrap());
                all
            };
            assert_eq!(corners(&read), corners(outcome.scene().unwrap()), "{name}");
            let more = BudgetSpec { triangles: Some(1_000_000), ..BudgetSpec::default() };
            let again =
                mesh(Input { format, ..input(Shape::Scene(read)) }, &more, format, &Job::default()).unwrap();
            assert_eq!(again.bound.at_most(), Some(0.0), "{name}: the second time nothing moves");
            let counts = |outcome: &MeshOutcome| outcome.certificate.valid.clone().unwrap().counts;
            assert_eq!(counts(&again), counts(&outcome), "{name}");
        }
    }
}

#[test]
fn new_triangles_are_in_the_order_of_vertex_caches_in_every_format() {
    let shaded = |outcome: &MeshOutcome, format: Format| {
        let mut bytes = Vec::new();
        outcome.write(&mut bytes).unwrap();
        let hint = FormatHint { format: Some(format), ..FormatHint::default() };
        let read = inspect(&load(&bytes, hint, &Limits::default()).unwrap());
        assert!(read.certificate.output.unwrap().triangles().unwrap().triangles > 200);
        read.inspection().unwrap().sizes.unwrap().acmr
    };
    let fine = mesh(patch_at([0.1, 0.2, 0.3]), &length("0.0001"), Format::Ply, &Job::default()).unwrap();
    let fine = fine.scene().unwrap();
    for (format, name) in FORMATS {
        for shape in [patch_at([0.1, 0.2, 0.3]), input(Shape::Scene(fine.clone()))] {
            let made = mesh(shape, &length("0.001"), format, &Job::default()).unwrap();
            // As they are made it is 1.02, and after a simplification 0.76.
            let found = shaded(&made, format);
            assert!(found < 0.72, "{name}: {found}");
        }
    }
}

#[test]
fn what_passes_through_keeps_the_order_of_its_triangles() {
    // Cells row by row, which suits no cache, and of heights that no triangle can do without.
    const N: u32 = 30;
    let at = |i: u32| [i % (N + 1), i / (N + 1), i * i % 101].map(f64::from);
    let cells =
        (0..N * N).map(|i| i + i / N).flat_map(|a| [[a, a + 1, a + N + 2], [a, a + N + 2, a + N + 1]]);
    let rows = Mesh::new((0..(N + 1) * (N + 1)).map(at).collect(), cells.collect()).unwrap();
    let rough = || input(Shape::Scene(Scene::from_mesh("rough", rows.clone(), Frame::default())));
    let made = mesh(rough(), &length("1e-6"), Format::Ply, &Job::default()).unwrap();
    assert_eq!(made.scene().unwrap().parts[0].mesh.faces(), rows.faces());
    let ConvertedShape::Triangles(scene) = convert(rough(), Format::Ply).unwrap().made else {
        panic!("triangles stay triangles")
    };
    assert_eq!(scene.parts[0].mesh.faces(), rows.faces());
}

/// A tetrahedron, and another that hangs rotated, scaled and moved from a node of a node.
fn two_parts() -> Scene {
    let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let tetrahedron = Mesh::new(corners, faces).unwrap();
    let mut scene = Scene::from_mesh("first", tetrahedron.clone(), Frame::default());
    scene.parts.extend(Scene::from_mesh("second", tetrahedron, Frame::default()).parts);
    let (sin, cos) = (0.6, 0.8);
    let turned = [cos, sin, 0.0, 0.0, -sin, cos, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.1, 0.2, 0.3, 1.0];
    let scaled = [3.0, 0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 10.0, 0.0, 0.0, 1.0];
    let node =
        |matrix: [f64; 16], children, part| Node { matrix: matrix.into(), children, part, ..Node::default() };
    scene.nodes.push(node(turned, vec![2], None));
    scene.nodes.push(node(scaled, Vec::new(), Some(1)));
    scene.roots.push(1);
    scene
}

#[test]
fn rounding_in_transforms_is_in_the_bound() {
    let outcome = mesh(input(Shape::Scene(two_parts())), &length("1"), Format::Ply, &Job::default()).unwrap();
    let most = outcome.bound.at_most().unwrap();
    // Coordinates up to 13 with a few roundings: some units of 1e-15 each, and not a single one of them free.
    assert!(most > 1e-16 && most < 1e-12, "{most:e}");
    assert_eq!(outcome.certificate.output.unwrap().triangles().unwrap().triangles, 8);
    // GLB keeps nodes, so nothing is rounded but what does not fit single precision: here everything fits.
    let kept = mesh(input(Shape::Scene(two_parts())), &length("1"), Format::Glb, &Job::default()).unwrap();
    assert_eq!(kept.bound.at_most(), Some(0.0));
    // A part that is three times as large in the scene is off by three times as much.
    let mut odd = two_parts();
    let third = odd.parts[1].mesh.positions().iter().map(|p| p.map(|x| x / 3.0)).collect();
    odd.parts[1].mesh = odd.parts[1].mesh.with_positions(third).unwrap();
    let moved = mesh(input(Shape::Scene(odd)), &length("1"), Format::Glb, &Job::default()).unwrap();
    let one_third_off = (f64::from((1.0_f64 / 3.0) as f32) - 1.0 / 3.0).abs();
    assert!(moved.bound.at_most().unwrap() >= 3.0 * one_third_off);
    assert!(moved.bound.at_most().unwrap() <= 12.0 * one_third_off);
}

#[test]
fn a_coordinate_beyond_single_precision_is_refused_by_formats_that_have_no_other() {
    let wide = vec![[0.0; 3], [1e39, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let scene = |wide| Scene::from_mesh("", Mesh::new(wide, vec![[0, 1, 2]]).unwrap(), Frame::default());
    for (format, name) in FORMATS {
        let made = mesh(input(Shape::Scene(scene(wide.clone()))), &length("1"), format, &Job::default());
        match (format, made) {
            (Format::Obj | Format::Ply | Format::Off | Format::ThreeMf | Format::Vtp, Ok(outcome)) => {
                assert_eq!(outcome.bound.at_most(), Some(0.0))
            }
            (Format::Stl | Format::Glb | Format::Gltf | Format::Usda | Format::Usdz, Err(failure)) => {
                assert_eq!((failure.code(), failure.exit_code()), ("too-wide", 4), "{name}");
            }
            (_, other) => panic!("{name}: {other:?}"),
        }
    }
}

#[test]
fn a_report_says_of_each_evidence_what_it_rests_on() {
    let promised = Evidence::ProvedIf(vec!["the field has slope 1".to_owned()]);
    let facts = BoundFacts::new(&Bound::with_evidence(0.1, Some(0.2), promised, Reference::InputTriangles));
    assert_eq!((facts.evidence, facts.assumptions.len(), facts.samples), ("proved-if", 1, None));
    let measured = Evidence::Measured { samples: 7 };
    let facts = BoundFacts::new(&Bound::with_evidence(0.1, None, measured, Reference::InputTriangles));
    assert_eq!((facts.evidence, facts.at_most, facts.samples), ("measured", None, Some(7)));
}

#[test]
fn triangles_finer_than_the_screen_shows_are_said() {
    let notes = |pixels: &str, view: &str| {
        let pixels = PixelBudget { pixels: pixels.parse().unwrap(), view: view.parse().unwrap() };
        let spec = BudgetSpec { pixels: Some(pixels), ..BudgetSpec::default() };
        let made = mesh(patch_at([0.0; 3]), &spec, Format::Ply, &Job::default()).unwrap();
        let said =
            made.certificate.notes.iter().filter(|note| note.contains("smaller than a pixel")).cloned();
        (said.collect::<Vec<_>>(), made.certificate.output.unwrap().triangles().unwrap().triangles)
    };
    for view in ["64x48 fov=45 dist=3", "64x48 fov=45 eye=0.5,0.5,3 target=0.5,0.5,0"] {
        assert_eq!(notes("0.5px", view).0, [""; 0]);
        let (said, n_triangles) = notes("0.002px", view);
        // Half of a picture 48 pixels high: more triangles than pixels.
        assert!(n_triangles > 4000, "{n_triangles}");
        assert_eq!(said.len(), 1, "{view}");
        let counts: Vec<u64> = said[0].split(' ').filter_map(|word| word.parse().ok()).collect();
        assert!(counts[0] > counts[1] / 2 && counts[0] <= counts[1] && counts[1] == n_triangles, "{said:?}");
    }
}

/// A field of `n` × `n` unevenly high cells of that size, about a point.
fn field(at: [f64; 3], (n, size): (usize, f64)) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let height = |i: usize, j: usize| 0.1 * size * ((1.3 * i as f64).sin() * (0.9 * j as f64).cos());
    let row = |i: usize| {
        (0..=n).map(move |j| {
            [
                at[0] + size * (i as f64 - 0.5 * n as f64),
                at[1] + size * (j as f64 - 0.5 * n as f64),
                at[2] + height(i, j),
            ]
        })
    };
    let m = n as u32 + 1;
    let cell = |i: u32, j: u32| {
        [[i * m + j, (i + 1) * m + j, (i + 1) * m + j + 1], [i * m + j, (i + 1) * m + j + 1, i * m + j + 1]]
    };
    let faces = (0..n as u32).flat_map(|i| (0..n as u32).flat_map(move |j| cell(i, j))).collect();
    ((0..=n).flat_map(row).collect(), faces)
}

/// Two fields as an OBJ file, one near the origin and one 1000 away.
fn near_and_far() -> String {
    let mut text = String::new();
    let mut first = 1;
    for (name, at) in [("near", [4.0, 0.0, -1.0]), ("far", [1000.0, 0.0, -1.0])] {
        let (positions, faces) = field(at, (24, 0.1));
        text += &format!("o {name}\n");
        positions.iter().for_each(|[x, y, z]| text += &format!("v {x} {y} {z}\n"));
        faces.iter().for_each(|[a, b, c]| text += &format!("f {} {} {}\n", a + first, b + first, c + first));
        first += positions.len() as u32;
    }
    text
}

fn at_an_eye(pixels: &str, view: &str) -> BudgetSpec {
    let pixels = PixelBudget { pixels: pixels.parse().unwrap(), view: view.parse().unwrap() };
    BudgetSpec { pixels: Some(pixels), ..BudgetSpec::default() }
}

#[test]
fn each_part_of_a_scene_has_the_pixels_of_its_own_places() {
    let text = near_and_far();
    let hint = FormatHint { name: Some("fields.obj"), ..FormatHint::default() };
    let input = load(text.as_bytes(), hint, &Limits::default()).unwrap();
    let spec = at_an_eye("1px", "1920x1080 fov=45 eye=0,0,0 target=1000,0,-1");
    for (format, name) in FORMATS {
        let outcome = mesh(input.clone(), &spec, format, &Job::default()).unwrap();
        let found = outcome.bound.pixels.unwrap();
        assert!(found > 0.3 && found <= 1.0, "{name}: {found}");
        let counts: Vec<usize> =
            outcome.scene().unwrap().parts.iter().map(|part| part.mesh.faces().len()).collect();
        let all: usize = counts.iter().sum();
        // 1152 each; the far one is smaller than 4 pixels.
        assert!(all > 300 && all < 1152, "{name}: {counts:?}");
        if counts.len() == 2 {
            assert!(counts[1] <= 8, "{name}: {counts:?}");
        }
    }
}

#[test]
fn a_part_in_two_places_has_what_the_nearer_one_allows() {
    let (positions, faces) = field([0.0; 3], (24, 0.1));
    let count = |places: &[f64]| {
        let one = chordal::Mesh::new(positions.clone(), faces.clone()).unwrap();
        let mut scene = Scene::from_mesh("field", one, Frame::default());
        scene.nodes.clear();
        scene.roots.clear();
        for x in places {
            let mut matrix = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
            (matrix[12], matrix[14]) = (*x, -1.0);
            scene.roots.push(scene.nodes.len());
            scene.nodes.push(Node { matrix: matrix.into(), part: Some(0), ..Node::default() });
        }
        let mut glb = Vec::new();
        chordal_io::write(&scene, None, Format::Glb, &mut glb).unwrap();
        let hint = FormatHint { name: Some("field.glb"), ..FormatHint::default() };
        let input = load(&glb, hint, &Limits::default()).unwrap();
        let spec = at_an_eye("1px", "1920x1080 fov=45 eye=0,0,0 target=1000,0,-1");
        let outcome = mesh(input, &spec, Format::Glb, &Job::default()).unwrap();
        assert!(outcome.bound.pixels.unwrap() <= 1.0);
        outcome.scene().unwrap().parts[0].mesh.faces().len()
    };
    let (near, far, both) = (count(&[4.0]), count(&[1000.0]), count(&[4.0, 1000.0]));
    assert!(near > 20 * far, "{near} {far}");
    assert_eq!(near, both);
}

/// Hills of 30 × 30 cells with the place on them as texture coordinates, whose last row of vertices has them
/// off by `off`.
fn textured(off: f64) -> Mesh {
    let at = |i: u32| f64::from(i) / 30.0;
    let places: Vec<[f64; 2]> = (0..31).flat_map(|i| (0..31).map(move |j| [at(i), at(j)])).collect();
    let hill = |[x, y]: &[f64; 2]| [*x, *y, 0.4 * (x - x * x) * (y - y * y)];
    let cell = |i: u32, j: u32| [31 * i + j, 31 * i + 31 + j, 31 * i + 32 + j, 31 * i + 1 + j];
    let cells = (0..30).flat_map(|i| (0..30).map(move |j| cell(i, j)));
    let faces = cells.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let values = places.iter().flat_map(|[x, y]| [*x, if *x == 1.0 { y + off } else { *y }]).collect();
    let uv = Attribute { semantic: Semantic::TexCoord(0), domain: Domain::Vertex, width: 2, values };
    Mesh::new(places.iter().map(hill).collect(), faces).unwrap().with_attribute(uv).unwrap()
}

#[test]
fn simplified_attributes_are_measured_part_by_part() {
    let scene = |mesh| Scene::from_mesh("hill", mesh, Frame::default());
    let made = |scene, asked: &str| {
        mesh(input(Shape::Scene(scene)), &length(asked), Format::Ply, &Job::default()).unwrap().certificate
    };
    let simple = made(scene(textured(0.0)), "0.5%");
    let [facts] = simple.verb.attributes() else {
        panic!("one attribute, not {:?}", simple.verb.attributes())
    };
    assert_eq!((facts.semantic, facts.name.as_str()), ("texcoord", "texcoord 0"));
    assert_eq!((facts.unit, facts.evidence), ("value", "measured"));
    // Coordinates are the place, so that only hills that were straightened and rounding shift them.
    let (largest, rms) = (facts.largest.unwrap(), facts.rms.unwrap());
    assert!(largest > 1e-6 && largest < 0.02 && rms < 0.5 * largest, "{facts:?}");
    // Four samples a face of both.
    let n_after = simple.output.unwrap().triangles().unwrap().triangles;
    assert_eq!(facts.samples, 4 * (1800 + n_after));
    // Of two parts the worse counts: a last row that is off gets lost within the cells beside it.
    let mut two = scene(textured(0.0));
    two.parts.extend(scene(textured(3.0)).parts);
    two.nodes.push(Node { name: String::new(), part: Some(1), ..two.nodes[0].clone() });
    two.roots.push(1);
    let both = made(two, "0.5%");
    assert_eq!(both.verb.attributes().len(), 1);
    assert!(both.verb.attributes()[0].largest.unwrap() > 0.3, "{:?}", both.verb.attributes());
    assert!(both.verb.attributes()[0].samples > facts.samples);
    // Where nothing went nothing is measured, and nothing where there are no attributes.
    assert!(made(scene(textured(0.0)), "1e-12").verb.attributes().is_empty());
    let bare = textured(0.0);
    let bare = Mesh::new(bare.positions().to_vec(), bare.faces().to_vec()).unwrap();
    assert!(made(scene(bare), "0.5%").verb.attributes().is_empty());
}

fn script(text: &str) -> Input {
    load(text.as_bytes(), FormatHint { name: Some("a.star"), ..FormatHint::default() }, &Limits::default())
        .unwrap()
}

fn meshed(input: Input, spec: &BudgetSpec) -> Result<MeshOutcome, MeshFailure> {
    mesh(input, spec, Format::Ply, &Job::default())
}

#[test]
fn what_a_displacement_promises_stands_in_the_report() {
    // A dent outside of the amplitude, which the formula itself shows: the whole shape is there, and proved.
    let dent = "displace(sphere(0.75), -0.5 * exp(-25 * ((x - 1.1) * (x - 1.1) + y * y + z * z)), 0.02)";
    let found = meshed(script(dent), &length("0.1")).unwrap();
    assert_eq!(*found.bound.evidence(), Evidence::Proved);
    let reach = found.scene().unwrap().parts[0].mesh.bounds().max[0];
    assert!(reach > 1.1, "the blob around 1.1 is missing: the mesh ends at {reach}");
    // A formula without a lowest value: the amplitude is a promise.
    let found = meshed(script("displace(sphere(0.75), (x + y) / 20, 0.2)"), &length("0.1")).unwrap();
    let facts = BoundFacts::new(&found.bound);
    assert_eq!(facts.evidence, "proved-if");
    assert_eq!(facts.assumptions, ["a displacement takes off no more than its amplitude, 0.2"]);
}

#[test]
fn numbers_that_overflow_are_said_to() {
    for text in ["sphere(1e300)", "box(1, 1, 1e200)", "move(sphere(1), 1e160, 0)"] {
        let Err(MeshFailure::Refused(refusal)) = meshed(script(text), &length("5%")) else {
            panic!("{text}")
        };
        assert_eq!(refusal.code, RefusalCode::NotFinite, "{text}");
        assert!(refusal.message.contains("no numbers any more"), "{}", refusal.message);
    }
}

/// The distance to a ball, as somebody's function of points: nothing is known of it.
#[derive(Debug)]
struct Opaque;

impl Leaf for Opaque {
    fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        points.iter().zip(out).for_each(|([x, y, z], v)| *v = (x * x + y * y + z * z).sqrt() - 1.0);
        Ok(())
    }

    fn evidence(&self) -> Evidence {
        Evidence::Measured { samples: 0 }
    }
}

#[test]
fn what_nothing_is_known_of_is_measured_unless_a_proof_is_asked_for() {
    let field = Field::new(Expr::leaf(Arc::new(Opaque), Expr::axes()));
    let region = Some(Box3 { min: [-1.25; 3], max: [1.25; 3] });
    let implicit = ImplicitShape::new(field, region, Frame::default());
    // What cannot be proved is tried with finer cells until this; chosen, as few as show that it is tried.
    let mut job = Job::default();
    if !chordal_testkit::is_long() {
        job.triangle_limit = 20_000;
    }
    let ask = |require| {
        let spec = BudgetSpec { require, ..length("0.2") };
        mesh(input(Shape::Field(implicit.clone())), &spec, Format::Ply, &job)
    };
    for require in [None, Some(RequiredEvidence::Measured)] {
        let found = ask(require).unwrap();
        assert!(matches!(found.bound.evidence(), Evidence::Measured { .. }), "{:?}", found.bound);
        assert!(found.bound.at_least() <= 0.2 && found.bound.at_most().is_none());
        assert!(found.scene().unwrap().parts[0].mesh.faces().len() > 20);
    }
    assert!(matches!(ask(Some(RequiredEvidence::Proved)), Err(MeshFailure::Unmet(_))));
}

#[test]
fn a_shape_of_the_plane_is_closed_at_the_ends_of_its_region() {
    // Without walls across z it had a rim there, and no mesh was ever fine enough.
    for text in
        ["a const -1\n", "x var-x\ny var-y\na square x\nb square y\nc add a b\nd const 0.5\ne sub c d\n"]
    {
        let hint = FormatHint { name: Some("a.vm"), ..FormatHint::default() };
        let input = load(text.as_bytes(), hint, &Limits::default()).unwrap();
        let found = meshed(input, &length("5%")).unwrap();
        assert_eq!(*found.bound.evidence(), Evidence::Proved, "{text}");
        let bounds = found.scene().unwrap().parts[0].mesh.bounds();
        assert!((bounds.max[2] - 1.0).abs() < 0.2 && (bounds.min[2] + 1.0).abs() < 0.2, "{bounds:?}");
    }
}

#[test]
fn tangents_go_with_the_old_normals_and_it_is_said() {
    let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let values = [1.0, 0.0, 0.0, 1.0].repeat(3);
    let tangents = Attribute { semantic: Semantic::Tangent, domain: Domain::Vertex, width: 4, values };
    let triangle = Mesh::new(corners, vec![[0, 1, 2]])
        .and_then(|mesh| mesh.with_attribute(Attribute::vertex_normals(&[[0.0, 0.0, 1.0]; 3])))
        .and_then(|mesh| mesh.with_attribute(tangents))
        .unwrap();
    for (normals, is_kept) in [(Normals::Keep, true), (Normals::Flat, false)] {
        let scene = Scene::from_mesh("a", triangle.clone(), Frame::default());
        let spec = BudgetSpec { normals, ..length("1%") };
        let found = mesh(input(Shape::Scene(scene)), &spec, Format::Glb, &Job::default()).unwrap();
        let part = &found.scene().unwrap().parts[0].mesh;
        assert_eq!(part.attribute(&Semantic::Tangent).is_some(), is_kept);
        let is_said = found.certificate.notes.iter().any(|note| note.contains("tangents"));
        assert_ne!(is_said, is_kept, "{:?}", found.certificate.notes);
    }
}
