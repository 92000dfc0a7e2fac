//! Materials, textures and nodes go through the verbs as they are.
use chordal::explicit::{Attribute, Domain, Semantic};
use chordal::{Job, Mesh};
use chordal_io::{Conformance, Content, Format, Frame, ImageContent, Limits, MATERIAL, Scene, read};
use chordal_verbs::{
    BudgetSpec, FormatHint, Input, LodSpec, MendSpec, Shape, Tessellation, TileErrors, load, load_with, lod,
    mend, mesh,
};

/// A ball in two materials, one with a texture, shown twice, with a camera, an animation and extras.
const PAINTED: &[u8] = include_bytes!("../../../tests/web/painted.gltf");

fn painted() -> Input {
    load(PAINTED, FormatHint::default(), &Limits::default()).expect("read")
}

fn scene(bytes: &[u8], format: Format) -> Scene {
    let found = read(bytes, format, &Limits::default()).expect("read");
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    let Content::Scene(scene) = found.content else { panic!("no scene") };
    scene
}

/// The materials that faces of a scene have, and whether those of the textured one know where on it they are.
fn is_painted(scene: &Scene) {
    let mesh = &scene.parts[0].mesh;
    let groups = mesh.attribute(&Semantic::Group(MATERIAL.to_owned())).expect("materials");
    for group in [1.0, 2.0] {
        assert!(groups.values.contains(&group), "material {group}");
    }
    let texcoords = mesh.attribute(&Semantic::TexCoord(0)).expect("texture coordinates");
    assert!(texcoords.values.iter().any(|x| *x > 0.5) && texcoords.values.iter().any(|x| *x < 0.5));
    // The upper half of the ball is in the first material, up to a triangle's size.
    for (face, group) in groups.values.iter().enumerate() {
        let height = mesh.corners(face).iter().map(|corner| corner[1]).sum::<f64>() / 3.0;
        assert!(if *group == 1.0 { height > -0.3 } else { height < 0.3 }, "{group} at {height}");
    }
}

#[test]
fn meshing_and_mending_change_nothing_but_triangles() {
    let before = scene(PAINTED, Format::Gltf);
    let spec = BudgetSpec { length: Some("2%".parse().expect("a length")), ..BudgetSpec::default() };
    let simplified = mesh(painted(), &spec, Format::Glb, &Job::default()).expect("simplified");
    let cures = MendSpec { drop_unused: true, ..MendSpec::default() };
    let mended = mend(painted(), &cures, Format::Glb, &Job::default()).expect("mended");
    for outcome in [simplified, mended] {
        let mut bytes = Vec::new();
        outcome.write(&mut bytes).expect("written");
        let after = scene(&bytes, Format::Glb);
        assert_eq!(
            (&after.assets, &after.nodes, &after.roots),
            (&before.assets, &before.nodes, &before.roots)
        );
        assert_eq!(after.parts[0].name, "sphere");
        is_painted(&after);
        assert!(after.parts[0].mesh.positions().len() < before.parts[0].mesh.positions().len());
    }
}

#[test]
fn levels_have_the_materials_of_all_parts() {
    let chordal::View::MinDistance(lens) = "1920x1080 fov=45 dist=4".parse().unwrap() else { unreachable!() };
    let spec = LodSpec {
        pixels: "1px".parse().expect("pixels"),
        lens,
        nearest: None,
        length: None,
        distances: Vec::new(),
        normals: chordal_verbs::Normals::Auto,
        errors: TileErrors::Scaled,
        tile_triangles: None,
    };
    let made = lod(painted(), &spec, &Job::default()).expect("levels");
    let mut bytes = Vec::new();
    made.write(&mut bytes).expect("written");
    let found = read(&bytes, Format::Glb, &Limits::default()).expect("read");
    let Content::Scene(first) = found.content else { panic!("no scene") };
    is_painted(&first);
    let before = scene(PAINTED, Format::Gltf);
    assert_eq!(
        (&first.assets.materials, &first.assets.images),
        (&before.assets.materials, &before.assets.images)
    );
    assert!(
        matches!(&first.assets.images[0].content, ImageContent::Bytes(bytes) if bytes.starts_with(b"\x89PNG"))
    );
    let notes: Vec<String> = made.certificate.notes.iter().map(ToString::to_string).collect();
    assert!(notes.iter().any(|note| note.ends_with("left out are cameras, animations")), "{notes:?}");
    let coarse = made.level(1).expect("a second level").0;
    is_painted(coarse);
}

#[test]
fn a_format_without_materials_says_so() {
    let spec = BudgetSpec { length: Some("2%".parse().expect("a length")), ..BudgetSpec::default() };
    let made = mesh(painted(), &spec, Format::Stl, &Job::default()).expect("simplified");
    let notes: Vec<String> = made.certificate.notes.iter().map(ToString::to_string).collect();
    for lost in ["STL holds no looks of materials", "STL holds no cameras", "STL holds no groups 'material'"]
    {
        assert!(notes.iter().any(|note| note.starts_with(lost)), "{lost} in {notes:?}");
    }
}

#[test]
fn weights_of_joints_are_blended_where_vertices_go() {
    // A flat sheet whose points follow the second joint by how far right they are.
    let n = 24_u32;
    let at = |i: u32| f64::from(i) / f64::from(n - 1);
    let positions: Vec<[f64; 3]> = (0..n * n).map(|v| [at(v % n), at(v / n), 0.0]).collect();
    let weights = positions.iter().flat_map(|p| [1.0 - p[0], p[0]]).collect();
    let cells = (0..n - 1).flat_map(|y| (0..n - 1).map(move |x| y * n + x));
    let faces = cells.flat_map(|v| [[v, v + 1, v + n + 1], [v, v + n + 1, v + n]]).collect();
    let semantic = Semantic::Blended("weights of joints 0 to 1, 4 a vertex".to_owned());
    let attribute =
        Attribute { semantic: semantic.clone(), domain: Domain::Vertex, width: 2, values: weights };
    let sheet = Mesh::new(positions, faces).and_then(|mesh| mesh.with_attribute(attribute)).expect("a mesh");
    let scene = Scene::from_mesh("sheet", sheet, Frame::default());
    let shape = Shape::Scene(scene);
    let input =
        Input { shape, format: Format::Glb, n_bytes: 0, sha256: "0".repeat(64), warnings: Vec::new() };
    let spec = BudgetSpec { length: Some("0.01".parse().expect("a length")), ..BudgetSpec::default() };
    let made = mesh(input, &spec, Format::Glb, &Job::default()).expect("simplified");
    let Tessellation::Triangles(scene) = &made.made else { panic!("no triangles") };
    let mesh = &scene.parts[0].mesh;
    assert!(mesh.faces().len() < 100, "{} triangles", mesh.faces().len());
    let found = mesh.attribute(&semantic).expect("weights");
    for (position, row) in mesh.positions().iter().zip(found.values.chunks_exact(2)) {
        assert!(
            (row[1] - position[0]).abs() < 1e-6 && (row[0] + row[1] - 1.0).abs() < 1e-9,
            "{position:?} {row:?}"
        );
    }
    let notes: Vec<String> = made.certificate.notes.iter().map(ToString::to_string).collect();
    assert!(notes.iter().any(|note| note.starts_with("the bound is of meshes at rest")), "{notes:?}");
}

#[test]
fn characters_keep_their_skins_and_animations() {
    let Some(data) = chordal_testkit::corpus::find("gltf/khronos/testdata") else { return };
    for name in ["CesiumMan/glTF_Binary/CesiumMan.glb", "Fox/glTF/Fox.gltf"] {
        let file = data.join(name);
        let (bytes, limits) = (std::fs::read(&file).expect("there"), Limits::default());
        let mut open =
            |path: &str| std::fs::read(file.with_file_name(path)).map_err(|error| error.to_string());
        let before = load_with(&bytes, FormatHint::default(), &mut open, &limits).expect("read");
        let Shape::Scene(scene) = &before.shape else { panic!("no scene") };
        let (assets, nodes) = (scene.assets.clone(), scene.nodes.clone());
        assert!(!assets.skins.is_empty() && !assets.animations.is_empty(), "{name}");
        let spec = BudgetSpec { length: Some("1%".parse().expect("a length")), ..BudgetSpec::default() };
        let made = mesh(before, &spec, Format::Glb, &Job::default()).expect("simplified");
        let mut written = Vec::new();
        made.write(&mut written).expect("written");
        let strict = Limits { conformance: Conformance::Strict, ..limits };
        let Content::Scene(after) = read(&written, Format::Glb, &strict).expect("read").content else {
            panic!("no scene")
        };
        assert_eq!((after.assets, after.nodes), (assets, nodes), "{name}");
        let is_weights = |attribute: &Attribute| matches!(&attribute.semantic, Semantic::Blended(name) if name.starts_with("weights of joints"));
        assert!(after.parts.iter().all(|part| part.mesh.attributes().iter().any(is_weights)), "{name}");
    }
}
