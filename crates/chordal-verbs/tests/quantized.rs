//! Files of fewer bits: the rounding is within the budget and part of the bound, which a sampler that shares no
//! code with the library checks, and levels and tiles stand on one lattice.
use chordal::budget::attributes::AttributeLimits;
use chordal::explicit::Semantic;
use chordal::math::Box3;
use chordal::{Job, Mesh};
use chordal_io::glb::{GltfPacking, PositionLattice};
use chordal_io::{Format, Limits, Scene};
use chordal_testkit::Random;
use chordal_testkit::sampler::{Point, Triangles, on};
use chordal_verbs::{
    BudgetSpec, FormatHint, Input, LodParts, LodSpec, MeshOutcome, Normals, OutputForm, Shape, TileErrors,
    convert, load, lod, mesh,
};
use std::collections::BTreeSet;

const PACKING: GltfPacking = GltfPacking { is_compressed: false, is_quantized: true };
const SMALL: OutputForm = OutputForm { format: Format::Glb, packing: PACKING };

/// A wavy sheet as OBJ, with texture coordinates and normals, beginning at a corner.
fn sheet(n: usize, corner: [f64; 3]) -> String {
    let mut text = String::new();
    for i in 0..n * n {
        let [u, v] = [i % n, i / n].map(|k| k as f64 / (n - 1) as f64);
        let z = 0.1 * (9.0 * u).sin() * (7.0 * v).cos();
        let [x, y, z] = [corner[0] + u, corner[1] + v, corner[2] + z];
        text += &format!("v {x} {y} {z}\nvt {u} {v}\nvn 0 {} 1\n", 0.3 * (5.0 * u).sin());
    }
    for i in 0..n - 1 {
        for j in 0..n - 1 {
            let at = |i: usize, j: usize| {
                let k = i * n + j + 1;
                format!("{k}/{k}/{k}")
            };
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            text += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
        }
    }
    text
}

fn loaded(bytes: &[u8], format: Format) -> Input {
    let hint = FormatHint { format: Some(format), ..FormatHint::default() };
    load(bytes, hint, &Limits::default()).expect("readable")
}

fn scene_of(bytes: &[u8], format: Format) -> Scene {
    let Shape::Scene(scene) = loaded(bytes, format).shape else { panic!("triangles") };
    scene
}

/// The mesh of a file with one part, where the nodes put it: products by powers of two and their sums are exact.
fn placed(bytes: &[u8]) -> Mesh {
    let scene = scene_of(bytes, Format::Glb);
    assert_eq!(scene.parts.len(), 1);
    let mut positions = scene.parts[0].mesh.positions().to_vec();
    let mut node = scene.nodes.iter().position(|node| node.part == Some(0)).expect("shown");
    loop {
        let m = *scene.nodes[node].matrix;
        for p in &mut positions {
            *p = [0, 1, 2].map(|k| m[k] * p[0] + m[4 + k] * p[1] + m[8 + k] * p[2] + m[12 + k]);
        }
        match scene.nodes.iter().position(|above| above.children.contains(&node)) {
            Some(above) => node = above,
            None => break,
        }
    }
    Mesh::new(positions, scene.parts[0].mesh.faces().to_vec()).expect("a mesh")
}

fn file_of(outcome: &MeshOutcome) -> Vec<u8> {
    let mut bytes = Vec::new();
    outcome.write(&mut bytes).expect("written");
    bytes
}

fn triangles(mesh: &Mesh) -> Triangles {
    Triangles::new(mesh.positions(), mesh.faces())
}

/// The largest distance of random points of one mesh to another, its corners included.
fn farthest(from: &Mesh, to: &Mesh, random: &mut Random) -> f64 {
    let to = triangles(to);
    (0..from.faces().len())
        .flat_map(|face| {
            let corners = from.corners(face);
            let mut all: Vec<Point> = (0..4).map(|_| on(corners, random.weights())).collect();
            all.extend(corners);
            all
        })
        .fold(0.0, |most, p| to.distance(p).max(most))
}

fn notes(outcome: &MeshOutcome) -> String {
    outcome.certificate.notes.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

fn budget(length: &str) -> BudgetSpec {
    BudgetSpec { length: Some(length.parse().expect("a length")), ..BudgetSpec::default() }
}

#[test]
fn the_bound_covers_the_rounding_and_is_within_the_budget() {
    let mut random = Random::new(3);
    for corner in [[0.0; 3], [40.0, -7.0, 3.0]] {
        let text = sheet(40, corner);
        let input = scene_of(text.as_bytes(), Format::Obj).parts.remove(0).mesh;
        let made = mesh(loaded(text.as_bytes(), Format::Obj), &budget("0.002"), SMALL, &Job::default())
            .expect("made");
        let file = file_of(&made);
        assert!(String::from_utf8_lossy(&file).contains("KHR_mesh_quantization"));
        let after = placed(&file);
        assert_eq!(after.positions(), made.scene().expect("triangles").parts[0].mesh.positions());
        let most = made.bound.at_most().expect("proved");
        assert!(most <= 0.002);
        let off = farthest(&input, &after, &mut random).max(farthest(&after, &input, &mut random));
        // The sampler rounds, by far less than that.
        assert!(off <= most * (1.0 + 1e-9) && off > 0.3 * most, "{off} of {most}");
        // Positions are multiples of a step that is larger than what was read.
        let step = made.scene().expect("triangles").parts[0]
            .storage
            .as_ref()
            .and_then(|s| s.lattice)
            .expect("one")
            .step();
        assert!(after.positions().iter().flatten().all(|x| (x / step).fract() == 0.0));
        assert!(input.positions().iter().flatten().any(|x| (x / step).fract() != 0.0));
    }
}

#[test]
fn a_conversion_rounds_by_what_its_bound_says() {
    let text = sheet(12, [3.0, 4.0, 5.0]);
    let input = scene_of(text.as_bytes(), Format::Obj).parts.remove(0).mesh;
    let made = convert(loaded(text.as_bytes(), Format::Obj), SMALL).expect("made");
    let mut bytes = Vec::new();
    made.write(&mut bytes).expect("written");
    let after = placed(&bytes);
    let most = made.bound.at_most().expect("proved");
    let lattice = PositionLattice::for_mesh(&input).expect("a lattice");
    assert!(most > 0.25 * lattice.step() && most <= lattice.worst());
    let off = farthest(&input, &after, &mut Random::new(5));
    assert!(off <= most * (1.0 + 1e-9), "{off} of {most}");
    assert_eq!(after.faces().len(), input.faces().len());
}

#[test]
fn a_budget_finer_than_the_lattice_is_met_in_single_precision() {
    let text = sheet(20, [0.0; 3]);
    let spec = budget("1e-5");
    let made = mesh(loaded(text.as_bytes(), Format::Obj), &spec, SMALL, &Job::default()).expect("made");
    assert!(made.bound.at_most().expect("proved") <= 1e-5);
    assert!(notes(&made).contains("single precision"), "{}", notes(&made));
    assert!(
        made.scene().expect("triangles").parts[0].storage.as_deref().expect("asked for").lattice.is_none()
    );
    let coarse =
        mesh(loaded(text.as_bytes(), Format::Obj), &budget("0.01"), SMALL, &Job::default()).expect("made");
    assert!(!notes(&coarse).contains("single precision"), "{}", notes(&coarse));
}

#[test]
fn smooth_shapes_are_within_the_budget_too() {
    let teapot = include_bytes!("../../../examples/teapot.bpt");
    let made = mesh(loaded(teapot, Format::Bpt), &budget("0.01"), SMALL, &Job::default()).expect("made");
    let plain =
        mesh(loaded(teapot, Format::Bpt), &budget("0.01"), Format::Glb, &Job::default()).expect("made");
    assert!(made.bound.at_most().expect("proved") <= 0.01);
    assert!(file_of(&made).len() < file_of(&plain).len() * 3 / 4);
    let (a, b) = (placed(&file_of(&made)), placed(&file_of(&plain)));
    let most = made.bound.at_most().expect("proved") + plain.bound.at_most().expect("proved");
    assert!(farthest(&a, &b, &mut Random::new(9)) <= most);
}

#[test]
fn limits_on_attributes_count_their_rounding() {
    let text = sheet(30, [0.0; 3]);
    let storage = |normal_deg: f64, texcoord: f64| {
        let attributes = AttributeLimits::new(Some(texcoord), Some(normal_deg)).expect("limits");
        let spec = BudgetSpec { attributes, ..budget("0.01") };
        let made = mesh(loaded(text.as_bytes(), Format::Obj), &spec, SMALL, &Job::default()).expect("made");
        for facts in made.certificate.verb.attributes() {
            let limit = if facts.semantic == "normal" { normal_deg } else { texcoord };
            assert!(facts.largest.expect("a number") <= limit, "{facts:?}");
        }
        assert_eq!(made.certificate.verb.attributes().len(), 2);
        *made.scene().expect("triangles").parts[0].storage.as_deref().expect("asked for")
    };
    use chordal_io::glb::DirectionBits::{Eight, Single, Sixteen};
    for (normal_deg, bits) in [(10.0, Eight), (1.0, Sixteen), (0.005, Single)] {
        assert_eq!(storage(normal_deg, 0.01).directions, bits);
    }
    assert!(storage(10.0, 1e-3).has_short_texcoords && !storage(10.0, 2e-5).has_short_texcoords);
}

fn levels(tile_triangles: Option<u64>) -> LodSpec {
    let chordal::View::MinDistance(lens) = "1920x1080 fov=60 dist=1".parse().expect("a view") else {
        unreachable!()
    };
    LodSpec {
        pixels: "1px".parse().expect("pixels"),
        lens,
        nearest: None,
        length: Some("0.001".parse().expect("a length")),
        distances: Vec::new(),
        normals: Normals::Auto,
        attributes: AttributeLimits::default(),
        errors: TileErrors::Plain,
        tile_triangles,
        parts: LodParts::Separate,
        place: None,
        packing: PACKING,
    }
}

#[test]
fn tiles_and_levels_stand_on_one_lattice_and_tiles_meet() {
    let text = sheet(48, [0.0; 3]);
    let made =
        lod(loaded(text.as_bytes(), Format::Obj), &levels(Some(400)), &Job::default()).expect("levels");
    let files = made.tileset().expect("files");
    let tiles: Vec<(String, Mesh)> =
        files.beside.iter().map(|file| (file.name.clone(), placed(&file.bytes))).collect();
    assert!(tiles.len() > 5);
    let bounds = tiles.iter().fold(Box3::EMPTY, |all, (_, mesh)| all.union(mesh.bounds()));
    let step = PositionLattice::for_box(&bounds, 0.0).expect("a lattice").step();
    for (name, mesh) in &tiles {
        assert!(mesh.positions().iter().flatten().all(|x| (x / step).fract() == 0.0), "{name}");
    }
    // The leaves together are one sheet: edges with one triangle are on its border alone.
    let list: serde_json::Value = serde_json::from_slice(&files.document).expect("a tileset");
    let mut open = vec![&list["root"]];
    let mut edges = std::collections::BTreeMap::<[[u64; 3]; 2], u32>::new();
    while let Some(tile) = open.pop() {
        let children = tile["children"].as_array().map_or(&[][..], |children| children);
        open.extend(children);
        if !children.is_empty() {
            continue;
        }
        let uri = tile["content"]["uri"].as_str().expect("a file");
        let mesh = &tiles.iter().find(|(name, _)| name == uri).expect("there").1;
        for face in 0..mesh.faces().len() {
            let [a, b, c] = mesh.corners(face).map(|p| p.map(|x| (x + 0.0).to_bits()));
            for mut edge in [[a, b], [b, c], [c, a]] {
                edge.sort_unstable();
                *edges.entry(edge).or_default() += 1;
            }
        }
    }
    let input = scene_of(text.as_bytes(), Format::Obj).parts.remove(0).mesh.bounds();
    let single: Vec<_> = edges.iter().filter(|(_, n)| **n == 1).map(|(edge, _)| edge).collect();
    for edge in &single {
        let on_border = edge.iter().all(|p| {
            let [x, y, _] = p.map(f64::from_bits);
            let near = |x: f64, side: f64| (x - side).abs() <= 0.0011 + step;
            near(x, input.min[0]) || near(x, input.max[0]) || near(y, input.min[1]) || near(y, input.max[1])
        });
        assert!(on_border, "{:?}", edge.map(|p| p.map(f64::from_bits)));
    }
    assert!(!single.is_empty());
}

#[test]
fn levels_of_a_part_stand_on_one_lattice() {
    let text = sheet(48, [7.0, 8.0, 9.0]);
    let made = lod(loaded(text.as_bytes(), Format::Obj), &levels(None), &Job::default()).expect("levels");
    let mut steps = BTreeSet::new();
    let mut n = 0;
    while let Some((scene, bound)) = made.level(n) {
        let lattice = scene.parts[0].storage.as_ref().and_then(|storage| storage.lattice).expect("a lattice");
        let mesh = &scene.parts[0].mesh;
        assert_eq!(lattice.snap(mesh).moved_at_most, 0.0);
        steps.insert(lattice.step().to_bits());
        let input = scene_of(text.as_bytes(), Format::Obj).parts.remove(0).mesh;
        let off = farthest(&input, mesh, &mut Random::new(n as u64));
        assert!(off <= bound.at_most().expect("proved") * (1.0 + 1e-9));
        n += 1;
    }
    assert!(n > 2 && steps.len() == 1);
    let mut bytes = Vec::new();
    made.write(Format::Glb, &mut bytes).expect("written");
    assert!(String::from_utf8_lossy(&bytes).contains("KHR_mesh_quantization"));
}

/// A flat square beginning at (0.1, 0.2), with texture coordinates that grow a hundred times as fast as places.
fn steep_square() -> String {
    let n = 8;
    let mut text = String::new();
    for i in 0..n * n {
        let [u, v] = [i % n, i / n].map(|k| k as f64 / (n - 1) as f64);
        text += &format!("v {} {} 0\nvt {} {}\n", 0.1 + u, 0.2 + v, 100.0 * u, 100.0 * v);
    }
    for i in (0..n * (n - 1)).filter(|i| i % n != n - 1) {
        let [a, b, c, d] = [i + 1, i + 2, i + n + 2, i + n + 1];
        text += &format!("f {a}/{a} {b}/{b} {c}/{c}\nf {a}/{a} {c}/{c} {d}/{d}\n");
    }
    text
}

#[test]
fn levels_keep_limits_on_attributes_where_a_lattice_slides_them() {
    let text = steep_square();
    // A step of 2⁻¹⁵ moves a corner by up to half of it along each axis, and texture coordinates 100 times as far.
    for (limit, has_lattice) in [(1e-4, false), (1e-2, true)] {
        for parts in [LodParts::Separate, LodParts::Merged] {
            let attributes = AttributeLimits::new(Some(limit), None).expect("limits");
            let spec = LodSpec { attributes, parts, ..levels(None) };
            let made = lod(loaded(text.as_bytes(), Format::Obj), &spec, &Job::default()).expect("levels");
            let (scene, _) = made.level(0).expect("a level");
            let part = &scene.parts[0];
            let lattice = part.storage.as_ref().and_then(|storage| storage.lattice);
            // Of merged parts nothing measures it.
            assert_eq!(lattice.is_some(), has_lattice && parts == LodParts::Separate, "{limit} {parts:?}");
            let texcoords = part.mesh.attribute(&Semantic::TexCoord(0)).expect("texture coordinates");
            for (v, [x, y, _]) in part.mesh.positions().iter().enumerate() {
                let [u, v] =
                    [texcoords.row(v)[0] - 100.0 * (x - 0.1), texcoords.row(v)[1] - 100.0 * (y - 0.2)];
                assert!((u * u + v * v).sqrt() <= limit, "{u} {v} at {x} {y}");
            }
        }
    }
}
