//! Materials, textures and nodes go through the verbs as they are.
use chordal::explicit::{Attribute, Domain, Semantic};
use chordal::{Job, Mesh};
use chordal_io::{Conformance, Content, Format, Frame, ImageContent, Limits, MATERIAL, Scene, read};
use chordal_verbs::{
    BudgetSpec, FormatHint, Input, LodParts, LodSpec, MendSpec, Shape, Tessellation, TileErrors, load,
    load_with, lod, mend, mesh, sha256,
};
use serde_json::Value;

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
        // Each material has its own vertices, so that their number may grow.
        assert!(after.parts[0].mesh.faces().len() <= before.parts[0].mesh.faces().len());
    }
}

/// Levels for a screen, in one file.
fn spec() -> LodSpec {
    let chordal::View::MinDistance(lens) = "1920x1080 fov=45 dist=4".parse().unwrap() else { unreachable!() };
    LodSpec {
        pixels: "1px".parse().expect("pixels"),
        lens,
        nearest: None,
        length: None,
        distances: Vec::new(),
        normals: chordal_verbs::Normals::Auto,
        attributes: chordal::budget::attributes::AttributeLimits::default(),
        errors: TileErrors::Scaled,
        tile_triangles: None,
        parts: LodParts::Separate,
        place: None,
        packing: chordal_io::glb::GltfPacking::default(),
    }
}

#[test]
fn levels_have_the_materials_of_all_parts() {
    let made = lod(painted(), &spec(), &Job::default()).expect("levels");
    let mut bytes = Vec::new();
    made.write(Format::Glb, &mut bytes).expect("written");
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
    assert!(!notes.iter().any(|note| note.contains("left out")), "{notes:?}");
    assert_eq!((&first.assets, first.parts.len()), (&before.assets, before.parts.len()));
    // An animated node gets a child that shows its part and names the levels.
    let (kept, added) = first.nodes.split_at(before.nodes.len());
    assert!(kept.iter().zip(&before.nodes).all(|(a, b)| (&a.name, &a.matrix) == (&b.name, &b.matrix)));
    assert_eq!((added.len(), added[0].part), (1, Some(0)));
    let coarse = made.level(1).expect("a second level").0;
    is_painted(&coarse);
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
    let input = Input {
        shape,
        format: Format::Glb,
        letters: None,
        n_bytes: 0,
        digest: "0".repeat(64).into(),
        files: Vec::new(),
        warnings: Vec::new(),
        composed: None,
        source: None,
    };
    let spec = BudgetSpec { length: Some("0.01".parse().expect("a length")), ..BudgetSpec::default() };
    let made = mesh(input, &spec, Format::Glb, &Job::default()).expect("simplified");
    let Tessellation::Triangles(scene) = &made.made else { panic!("no triangles") };
    let mesh = &scene.parts[0].mesh;
    assert!(mesh.faces().len() < 100, "{} triangles", mesh.faces().len());
    let found = mesh.attribute(&semantic).expect("weights");
    for (position, row) in mesh.positions().iter().zip(found.values.chunks_exact(2)) {
        assert!(
            (row[1] - position[0]).abs() < 1e-6 && (row[0] + row[1] - 1.0).abs() < 1e-7,
            "{position:?} {row:?}"
        );
    }
    let notes: Vec<String> = made.certificate.notes.iter().map(ToString::to_string).collect();
    assert!(notes.iter().any(|note| note.starts_with("the bound is for the rest pose")), "{notes:?}");
}

/// Blends of ones are ones: glTF holds no colour beyond them.
#[test]
fn white_stays_white() {
    let n = 40_u32;
    let mut random = chordal_testkit::Random::new(5);
    let at = |v: u32| [f64::from(v % n), f64::from(v / n), 0.0];
    let positions: Vec<[f64; 3]> =
        (0..n * n).map(|v| std::array::from_fn(|k| at(v)[k] + 0.3 * random.signed())).collect();
    let cells = (0..n - 1).flat_map(|y| (0..n - 1).map(move |x| y * n + x));
    let faces = cells.flat_map(|v| [[v, v + 1, v + n + 1], [v, v + n + 1, v + n]]).collect();
    let white = Attribute {
        semantic: Semantic::Color(0),
        domain: Domain::Vertex,
        width: 4,
        values: vec![1.0; positions.len() * 4],
    };
    let sheet = Mesh::new(positions, faces).and_then(|mesh| mesh.with_attribute(white)).expect("a mesh");
    let input = Input {
        shape: Shape::Scene(Scene::from_mesh("sheet", sheet, Frame::default())),
        format: Format::Glb,
        letters: None,
        n_bytes: 0,
        digest: "0".repeat(64).into(),
        files: Vec::new(),
        warnings: Vec::new(),
        composed: None,
        source: None,
    };
    let made = lod(input, &spec(), &Job::default()).expect("levels");
    made.write(Format::Glb, &mut Vec::new()).expect("written");
    let (scene, _) = made.level(3).expect("a fourth level");
    let colors = scene.parts[0].mesh.attribute(&Semantic::Color(0)).expect("colours");
    assert!(colors.values.iter().all(|x| *x == 1.0));
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

/// The text of a GLB.
fn text_of(glb: &[u8]) -> Value {
    let length = u32::from_le_bytes(glb[12..16].try_into().expect("four bytes")) as usize;
    serde_json::from_slice(&glb[20..20 + length]).expect("JSON")
}

/// A tile of the lower half, in the material without a picture, holds neither the other material nor its
/// texture; the picture stands once beside all tiles.
#[test]
fn tiles_share_pictures_and_hold_what_their_faces_use() {
    let spec =
        LodSpec { length: Some("0.5%".parse().expect("a length")), tile_triangles: Some(60), ..spec() };
    let made = lod(painted(), &spec, &Job::default()).expect("levels");
    let files = made.tileset().expect("files");
    let (tiles, pictures): (Vec<_>, Vec<_>) =
        files.beside.iter().partition(|file| file.name.ends_with(".glb"));
    assert_eq!(pictures.iter().map(|file| &*file.name).collect::<Vec<_>>(), ["image_0.png"]);
    let before = scene(PAINTED, Format::Gltf);
    assert_eq!(before.assets.images[0].content, ImageContent::Bytes((&*pictures[0].bytes).into()));
    let whole = &before.assets.materials;
    let (mut n_plain, mut n_painted) = (0, 0);
    for tile in tiles {
        let text = text_of(&tile.bytes);
        let of_faces: Vec<usize> = text["meshes"]
            .as_array()
            .into_iter()
            .flatten()
            .flat_map(|mesh| mesh["primitives"].as_array().expect("primitives"))
            .map(|primitive| primitive["material"].as_u64().expect("a material") as usize)
            .collect();
        let materials = text["materials"].as_array().expect("materials");
        // Each material is used, and is one of the whole as far as its name says.
        assert!((0..materials.len()).all(|k| of_faces.contains(&k)), "{}: {of_faces:?}", tile.name);
        assert!(materials.iter().all(|m| whole.iter().any(|other| other["name"] == m["name"])), "{text}");
        let names_texture = materials.iter().any(|material| material.to_string().contains("Texture"));
        assert_eq!(text.get("images").is_some(), names_texture, "{}", tile.name);
        if names_texture {
            assert_eq!(text["images"][0]["uri"], "image_0.png");
            assert!(text["images"][0].get("bufferView").is_none());
            n_painted += 1;
        } else {
            assert_eq!((text.get("textures"), text.get("samplers")), (None, None));
            n_plain += 1;
        }
    }
    assert!(n_plain > 0 && n_painted > 1, "{n_plain} {n_painted}");
}

#[test]
fn levels_are_a_gltf_of_one_file_or_of_several() {
    let made = lod(painted(), &spec(), &Job::default()).expect("levels");
    let [mut glb, mut gltf] = [Vec::new(), Vec::new()];
    made.write(Format::Glb, &mut glb).expect("written");
    made.write(Format::Gltf, &mut gltf).expect("written");
    let shown = |bytes: &[u8], format| match read(bytes, format, &Limits::default()).expect("read").content {
        Content::Scene(scene) => scene,
        _ => panic!("no scene"),
    };
    assert_eq!(shown(&gltf, Format::Gltf), shown(&glb, Format::Glb));
    let files = made.write_files("balls").expect("written");
    let names: Vec<&str> = files.beside.iter().map(|file| &*file.name).collect();
    assert_eq!(names, ["balls.bin", "balls_image_0.png"]);
    assert!(made.write(Format::Obj, &mut Vec::new()).is_err());
}

/// The digests of files beside an input, in the order of reading, each once.
#[test]
fn files_beside_an_input_are_in_its_certificate() {
    let inner = scene(PAINTED, Format::Gltf);
    let files = chordal_io::glb::write_files(&inner, None, "ball").expect("written");
    let mut asked = 0;
    let mut open = |path: &str| {
        asked += 1;
        let file = files.beside.iter().find(|file| file.name == path);
        file.map(|file| file.bytes.to_vec()).ok_or_else(|| "no such file".to_owned())
    };
    let mut text: Value = serde_json::from_slice(&files.document).expect("JSON");
    let again = text["images"][0].clone();
    let missing = serde_json::json!({ "uri": "away.png", "mimeType": "image/png" });
    text["images"].as_array_mut().expect("images").extend([again, missing]);
    let document = text.to_string();
    let hint = FormatHint { name: Some("ball.gltf"), ..FormatHint::default() };
    let input = load_with(document.as_bytes(), hint, &mut open, &Limits::default()).expect("read");
    let certificate = chordal_verbs::report::Certificate::from_input(&input).to_value();
    let said = |k: usize| {
        let file = &files.beside[k];
        serde_json::json!({ "path": file.name, "sha256": sha256(&file.bytes) })
    };
    assert_eq!(certificate["input"]["files"], serde_json::json!([said(0), said(1)]));
    assert_eq!(input.files[0].n_bytes, files.beside[0].bytes.len() as u64);
    assert_eq!(asked, 4);
    let alone = chordal_verbs::report::Certificate::from_input(&painted()).to_value();
    assert_eq!(alone["input"].get("files"), None);
}
