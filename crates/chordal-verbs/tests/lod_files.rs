//! Levels as they stand in the files of a tileset, read back and held against the true shape by a sampler
//! that shares no code with the library: no point of either is farther from the other than the file says.

use chordal::{Job, Mesh};
use chordal_io::{Format, Limits};
use chordal_testkit::sampler::{Point, Triangles, norm, on};
use chordal_testkit::{Random, is_long};
use chordal_verbs::{FormatHint, LodParts, LodSpec, Normals, Shape, TileErrors, load, lod};
use serde_json::Value;

fn spec(tol: &str, tile_triangles: u64) -> LodSpec {
    let chordal::View::MinDistance(lens) = "1920x1080 fov=60 dist=1".parse().unwrap() else { unreachable!() };
    LodSpec {
        pixels: "1px".parse().unwrap(),
        lens,
        nearest: None,
        length: Some(tol.parse().unwrap()),
        distances: Vec::new(),
        normals: Normals::Auto,
        attributes: chordal::budget::attributes::AttributeLimits::default(),
        errors: TileErrors::Plain,
        tile_triangles: Some(tile_triangles),
        parts: LodParts::Separate,
        place: None,
        packing: chordal_io::glb::GltfPacking::default(),
    }
}

fn loaded(bytes: &[u8], format: Format) -> chordal_verbs::Input {
    let hint = FormatHint { format: Some(format), ..FormatHint::default() };
    load(bytes, hint, &Limits::default()).expect("readable")
}

/// Every tile of the file with what its extras say it is off, in metres, which is a unit here.
fn tiles(bytes: &[u8], format: Format, spec: &LodSpec) -> Vec<(Vec<Mesh>, f64)> {
    let made = lod(loaded(bytes, format), spec, &Job::default()).expect("levels");
    let files = made.tileset().expect("files");
    let content = |name: &str| files.beside.iter().find(|file| file.name == name).map(|file| &*file.bytes);
    let list: Value = serde_json::from_slice(&files.document).unwrap();
    assert!(list["root"]["transform"].is_null(), "coordinates are about zero");
    let mut open = vec![&list["root"]];
    let mut found = Vec::new();
    while let Some(tile) = open.pop() {
        let Shape::Scene(scene) =
            loaded(content(tile["content"]["uri"].as_str().unwrap()).unwrap(), Format::Glb).shape
        else {
            panic!("triangles")
        };
        let meshes = scene.parts.into_iter().map(|part| part.mesh).collect();
        found.push((meshes, tile["extras"]["chordal"]["at_most"].as_f64().unwrap()));
        open.extend(tile["children"].as_array().into_iter().flatten());
    }
    found
}

/// The triangles of a mesh.
fn triangles(mesh: &Mesh) -> Triangles {
    Triangles::new(mesh.positions(), mesh.faces())
}

/// Random points of a mesh, all over each face.
fn points(mesh: &Mesh, random: &mut Random) -> Vec<Point> {
    let many = if is_long() { 100_000 } else { 40_000 } / mesh.faces().len() + 4;
    (0..mesh.faces().len())
        .flat_map(|face| {
            let corners = mesh.corners(face);
            (0..many).map(|_| on(corners, random.weights())).chain(corners).collect::<Vec<_>>()
        })
        .collect()
}

/// The largest distance is nearly what is said, and never more.
fn holds(off: f64, said: f64, what: &str) {
    assert!(off <= said, "{what}: a point is {off} off, and the file says {said}");
    assert!(off > 0.5 * said, "{what}: no point is farther than {off}, and the file says {said}");
}

#[test]
fn levels_of_a_field_are_as_near_as_they_say() {
    let mut random = Random::new(1);
    let found = tiles(b"sphere(1)", Format::Star, &spec("0.002", 1 << 16));
    assert!(found.len() > 3);
    for (meshes, said) in found {
        let [mesh] = &meshes[..] else { panic!("one mesh a level") };
        let tree = triangles(mesh);
        let from_level = points(mesh, &mut random).into_iter().map(|p| (norm(p) - 1.0).abs());
        let from_ball = (0..50_000).map(|_| tree.distance(random.direction()));
        let off = from_level.collect::<Vec<_>>().into_iter().chain(from_ball).fold(0.0, f64::max);
        holds(off, said, "ball");
    }
}

/// The point of a bicubic patch by Bernstein's polynomials.
fn evaluated(control: &[[Point; 4]; 4], u: f64, v: f64) -> Point {
    let weights = |t: f64| {
        let s = 1.0 - t;
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
    };
    let (a, b) = (weights(u), weights(v));
    std::array::from_fn(|k| (0..16).map(|n| a[n % 4] * b[n / 4] * control[n / 4][n % 4][k]).sum())
}

const PATCH: &str = "1\n3 3\n0 0 0\n1 0 0.5\n2 0 -0.5\n3 0 0\n0 1 0.5\n1 1 2\n2 1 1\n3 1 0\n0 2 -0.5\n1 2 1\n2 2 2\n3 2 1\n\
                     0 3 0\n1 3 0\n2 3 1\n3 3 0\n";

#[test]
fn levels_of_a_patch_are_as_near_as_they_say() {
    let numbers: Vec<f64> = PATCH.split_whitespace().skip(3).map(|x| x.parse().unwrap()).collect();
    let control: [[Point; 4]; 4] = std::array::from_fn(|j| {
        std::array::from_fn(|i| std::array::from_fn(|k| numbers[12 * j + 3 * i + k]))
    });
    let n = 200_u32;
    let at = |i: u32| f64::from(i) / f64::from(n);
    let rows = (0..=n).flat_map(|j| (0..=n).map(move |i| (i, j)));
    let fine: Vec<Point> = rows.map(|(i, j)| evaluated(&control, at(i), at(j))).collect();
    let cells = (0..n).flat_map(|j| (0..n).map(move |i| j * (n + 1) + i));
    let faces = cells.flat_map(|k| [[k, k + 1, k + n + 2], [k, k + n + 2, k + n + 1]]).collect();
    let truth = triangles(&Mesh::new(fine.clone(), faces).unwrap());
    // A cell of 1/200 is off its patch by an eighth of its sides squared times the second derivatives, which
    // are below 6 · 4 · 3 in all.
    let sag = 72.0 / (8.0 * f64::from(n).powi(2));
    let mut random = Random::new(2);
    let found = tiles(PATCH.as_bytes(), Format::Bpt, &spec("0.004", 1 << 16));
    assert!(found.len() > 2);
    for (meshes, said) in found {
        let [mesh] = &meshes[..] else { panic!("one mesh a level") };
        let tree = triangles(mesh);
        let from_patch = fine.iter().map(|p| tree.distance(*p)).fold(0.0, f64::max);
        let from_level =
            points(mesh, &mut random).into_iter().map(|p| truth.distance(p) - sag).fold(0.0, f64::max);
        holds(from_patch.max(from_level), said, "patch");
    }
}

/// Any tiles that stand for all regions are as near as the one that is off most.
#[test]
fn tiles_of_a_mesh_that_is_cut_are_as_near_as_they_say() {
    // A wavy plate of 8,192 triangles, all of whose coordinates single precision holds.
    let n = 64_u32;
    let height = |i: u32, j: u32| (0.25 * ((f64::from(i) / 7.0).sin() + (f64::from(j) / 9.0).cos())) as f32;
    let mut text = String::new();
    for j in 0..=n {
        for i in 0..=n {
            text += &format!("v {} {} {}\n", f64::from(i) / 16.0, f64::from(j) / 16.0, height(i, j));
        }
    }
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i + 1;
            text += &format!("f {} {} {}\nf {} {} {}\n", a, a + 1, a + n + 2, a, a + n + 2, a + n + 1);
        }
    }
    let Shape::Scene(scene) = loaded(text.as_bytes(), Format::Obj).shape else { panic!("triangles") };
    let given = &scene.parts[0].mesh;
    let truth = triangles(given);
    let mut random = Random::new(3);
    let made =
        lod(loaded(text.as_bytes(), Format::Obj), &spec("0.0005", 200), &Job::default()).expect("levels");
    let files = made.tileset().expect("files");
    let read = |name: &str| -> Mesh {
        let bytes = &files.beside.iter().find(|file| file.name == name).expect("a file").bytes;
        let Shape::Scene(scene) = loaded(bytes, Format::Glb).shape else { panic!("triangles") };
        assert_eq!(scene.parts.len(), 1);
        scene.parts.into_iter().next().unwrap().mesh
    };
    let list: Value = serde_json::from_slice(&files.document).unwrap();
    let mut n_mixed = 0;
    let n_rounds = if is_long() { 12 } else { 5 };
    for round in 0..n_rounds {
        // Children in the place of a tile by chance, more and more often.
        let go_on = 0.5 + 0.46 * f64::from(round) / f64::from(n_rounds);
        let (mut open, mut shown) = (vec![&list["root"]], Vec::new());
        while let Some(tile) = open.pop() {
            match tile["children"].as_array() {
                Some(children) if random.between(0.0, 1.0) < go_on => open.extend(children),
                _ => shown.push(tile),
            }
        }
        let said = shown.iter().map(|tile| tile["extras"]["chordal"]["at_most"].as_f64().unwrap());
        let said: Vec<f64> = said.collect();
        let most = said.iter().copied().fold(0.0, f64::max);
        n_mixed += i32::from(said.iter().any(|x| *x < 0.9 * most));
        // All tiles of the round as one soup.
        let (mut positions, mut faces) = (Vec::new(), Vec::new());
        for tile in &shown {
            let mesh = read(tile["content"]["uri"].as_str().unwrap());
            let first = positions.len() as u32;
            positions.extend(mesh.positions());
            faces.extend(mesh.faces().iter().map(|face| face.map(|row| row + first)));
        }
        let soup = Mesh::new(positions, faces).unwrap();
        let tree = triangles(&soup);
        let there = points(given, &mut random).into_iter().map(|p| tree.distance(p)).fold(0.0, f64::max);
        let back = points(&soup, &mut random).into_iter().map(|p| truth.distance(p)).fold(0.0, f64::max);
        holds(there.max(back), most, "cut");
    }
    assert!(4 * n_mixed > n_rounds, "{n_mixed} of {n_rounds}");
}
