//! Materials go from OBJ to OBJ, to GLB and back as they are.
use super::{Files, PNG, WEBP, jpeg, load, squares, values};
use crate::common::count;
use chordal::explicit::Semantic;
use chordal_io::{
    Content, Format, Frame, ImageContent, Limits, MATERIAL, ReadOutcome, Scene, SceneImage, TextureOrigin,
    glb, losses, obj, read_with, write_files,
};
use serde_json::{Map, Value, json};

/// The OBJ of a scene and the files beside it.
fn written(scene: &Scene, stem: &str) -> (String, Files) {
    let beside = obj::side_files(scene, stem).expect("materials");
    let mut text = Vec::new();
    obj::write_with_library(scene, None, Some(&beside.library), &mut text).expect("written");
    let files = Files(beside.files.iter().map(|file| (file.name.clone(), file.bytes.to_vec())).collect());
    (String::from_utf8(text).expect("text"), files)
}

fn through_glb(scene: &Scene) -> Scene {
    let mut bytes = Vec::new();
    glb::write(scene, None, &mut bytes).expect("written");
    match glb::read(&bytes, &Limits::default()).expect("read") {
        ReadOutcome { content: Content::Scene(scene), warnings } => {
            assert!(warnings.is_empty(), "{warnings:?}");
            scene
        }
        other => panic!("no scene: {other:?}"),
    }
}

/// The JSON and the bytes of a GLB.
fn parsed(scene: &Scene) -> (Value, Vec<u8>) {
    let mut bytes = Vec::new();
    glb::write(scene, None, &mut bytes).expect("written");
    let end = 20 + u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    (serde_json::from_slice(&bytes[20..end]).expect("JSON"), bytes[end + 8..].to_vec())
}

const LIBRARY: &str = "newmtl all that glTF says\nKd 0.1 0.2 0.3\nd 0.5\nKe 0 0.25 1\nPr 0.3\nPm 1\nPs 0.5\nPc 0.75\nPcr 0.1\n\
map_Kd -s 2 2 1 -o 0.5 0.5 0 -clamp on tex/p.png\nmap_Ke q.jpg\nmap_Bump -bm 0.5 q.jpg\n\
\n\
newmtl old\nKa 0.1 0.1 0.1\nKd 1 0 0\nKs 0.5 0.5 0.5\nNs 96.078431\nNi 1.45\nTf 1 0.5 0.25\nillum 2\nTr 0.25\nmap_Ka tex/p.png\nmap_Kd tex/p.png\n\
map_d tex/p.png\nmap_Ks gone.png\n\
\n\
newmtl odd\nKd 2 0 0\nKe 4 2 1\nKs 0\nNs 10\nd -halo 0.5\nPr 1.5\nmap_Kd -mm 0 2 w.webp\nmap_Pr q.jpg\nmap_Pm q.jpg\n\
\n\
newmtl black\nKd 0 0 0\nmap_Kd gone.png\nrefl -type sphere a b.png\n";

fn furnished() -> (String, Files) {
    let names = ["all that glTF says", "old", "odd", "black"];
    let files = Files::default()
        .with("a.mtl", LIBRARY)
        .with("tex/p.png", PNG)
        .with("q.jpg", jpeg(3))
        .with("w.webp", WEBP);
    (squares("a.mtl", &names), files)
}

/// What a scene says of its materials, without the names of pictures' files.
fn without_names(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.assets.images.iter_mut().for_each(|image| drop(image.properties.shift_remove("name")));
    let rename = |value: &mut Value| {
        if let Value::String(text) = value {
            for name in ["tex/p.png", "my_shape_p.png"] {
                *text = text.replace(name, "p");
            }
        }
    };
    for material in &mut scene.assets.materials {
        material["extras"]["mtl"].as_object_mut().into_iter().flat_map(Map::values_mut).for_each(rename);
    }
    scene
}

#[test]
fn a_library_comes_back_from_obj_and_from_glb() {
    let (text, files) = furnished();
    let (scene, _, _) = load(&text, &files);
    assert_eq!(scene.assets.materials.len(), 4);
    assert_eq!(scene.assets.images.len(), 3);
    let (again, beside) = written(&scene, "my shape");
    let names: Vec<&String> = beside.0.keys().collect();
    assert_eq!(names, ["my_shape.mtl", "my_shape_p.png", "my_shape_q.jpg", "my_shape_w.webp"]);
    assert_eq!(beside.0["my_shape_p.png"], PNG);
    assert!(again.starts_with("mtllib my_shape.mtl\n"));
    let (back, warnings, _) = load(&again, &beside);
    assert_eq!(count(&warnings, "picture-missing"), 1, "gone.png alone: {warnings:?}");
    assert_eq!(without_names(&back), without_names(&scene));
    // And from then on byte for byte.
    let (third, files) = written(&back, "my shape");
    assert!(third == again && files.0 == beside.0);
    // glTF carries all of it, with what it cannot say.
    let held = through_glb(&scene);
    assert_eq!(held.assets.materials, scene.assets.materials);
    let (from_glb, files) = written(&held, "my shape");
    assert_eq!(files.0, beside.0);
    let (back, _, _) = load(&from_glb, &files);
    assert_eq!(without_names(&back).assets, without_names(&scene).assets);
    assert_eq!(values(&back), values(&scene));
}

#[test]
fn a_library_is_written_as_it_was_said() {
    let (text, files) = furnished();
    let (scene, _, _) = load(&text, &files);
    let library = String::from_utf8(written(&scene, "s").1.0["s.mtl"].clone()).expect("text");
    let lines: Vec<&str> = library.lines().collect();
    for line in [
        "newmtl old",
        "Kd 1 0 0",
        "Tr 0.25",
        "Ka 0.1 0.1 0.1",
        "Ks 0.5 0.5 0.5",
        "Ns 96.078431",
        "illum 2",
        "Ni 1.45",
        "Tf 1 0.5 0.25",
        "map_Kd s_p.png",
        "map_Ka s_p.png",
        "map_d s_p.png",
        "map_Ks gone.png",
        "Kd 2 0 0",
        "Ke 4 2 1",
        "d -halo 0.5",
        "Pr 1.5",
        "Ks 0",
        "map_Kd -mm 0 2 s_w.webp",
        "map_Pr s_q.jpg",
        "map_Pm s_q.jpg",
        "Kd 0 0 0",
        "map_Kd gone.png",
        "refl -type sphere a b.png",
        "map_Bump -bm 0.5 s_q.jpg",
        "map_Kd -s 2 2 1 -o 0.5 0.5 0 -clamp on s_p.png",
        "Kd 0.1 0.2 0.3",
        "d 0.5",
        "Ke 0 0.25 1",
        "Pr 0.3",
        "Pm 1",
        "Ps 0.5",
        "Pc 0.75",
        "Pcr 0.1",
    ] {
        assert!(lines.contains(&line), "{line}: {library}");
    }
    assert_eq!(lines.iter().filter(|line| line.starts_with("Kd ")).count(), 4);
    assert_eq!(lines.len(), 43, "{library}");
}

#[test]
fn a_picture_stands_upright_in_obj_and_in_glb() {
    let files = Files::default().with("a.mtl", "newmtl m\nmap_Kd p.png\n").with("p.png", PNG);
    let (scene, _, _) = load(&squares("a.mtl", &["m"]), &files);
    assert_eq!(scene.frame.texture_origin, Some(TextureOrigin::LowerLeft));
    let (json, bin) = parsed(&scene);
    let at = |name: &str| {
        let accessor = json["meshes"][0]["primitives"][0]["attributes"][name].as_u64().expect(name) as usize;
        let view = json["accessors"][accessor]["bufferView"].as_u64().unwrap() as usize;
        json["bufferViews"][view]["byteOffset"].as_u64().unwrap() as usize
    };
    let float = |at: usize| f32::from_le_bytes(bin[at..at + 4].try_into().unwrap());
    let origin = &json["nodes"][0]["translation"];
    for vertex in 0..4 {
        let corner = [0, 1].map(|k| {
            let moved = origin.get(k).and_then(Value::as_f64).unwrap_or(0.0);
            float(at("POSITION") + 12 * vertex + 4 * k) + moved as f32
        });
        let texcoord = [0, 1].map(|k| float(at("TEXCOORD_0") + 8 * vertex + 4 * k));
        // The upper left corner of the square has that of the picture, which is 0, 0 in glTF.
        assert_eq!(texcoord, [corner[0], 1.0 - corner[1]]);
    }
    let material = json["meshes"][0]["primitives"][0]["material"].as_u64().unwrap() as usize;
    let texture = &json["materials"][material]["pbrMetallicRoughness"]["baseColorTexture"]["index"];
    let image = json["textures"][texture.as_u64().unwrap() as usize]["source"].as_u64().unwrap() as usize;
    let view = json["images"][image]["bufferView"].as_u64().unwrap() as usize;
    let start = json["bufferViews"][view]["byteOffset"].as_u64().unwrap() as usize;
    assert_eq!(bin[start..start + PNG.len()], PNG);
    // From GLB the same lines are written as from OBJ.
    let (text, _) = written(&scene, "s");
    let texcoords = |text: &str| {
        text.lines().filter(|line| line.starts_with("vt ")).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(texcoords(&text), ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1"]);
    let held = through_glb(&scene);
    assert_eq!(held.parts[0].mesh.attribute(&Semantic::TexCoord(0)).unwrap().row(0), [0.0, 1.0]);
    assert_eq!(texcoords(&written(&held, "s").0), texcoords(&text));
    // Where nothing says where textures begin, nothing is turned.
    let unknown = Scene { frame: Frame::default(), ..scene.clone() };
    let held = through_glb(&unknown);
    assert_eq!(held.parts[0].mesh.attribute(&Semantic::TexCoord(0)).unwrap().row(0), [0.0, 0.0]);
}

#[test]
fn materials_of_gltf_get_a_name_each_and_what_mtl_lacks_is_told() {
    let (text, files) = furnished();
    let (mut scene, _, _) = load(&text, &files);
    scene.assets.materials = vec![
        json!({ "name": "a", "pbrMetallicRoughness": { "baseColorFactor": [1.0, 0.5, 0.0, 1.0], "roughnessFactor": 0.5 } }),
        json!({ "name": "a", "alphaMode": "MASK", "occlusionTexture": { "index": 0 } }),
        json!({ "pbrMetallicRoughness": { "metallicFactor": 0.0, "baseColorTexture": { "index": 1, "texCoord": 1 } } }),
        json!({ "name": "A\nnewmtl evil\\", "extensions": { "KHR_materials_ior": { "ior": 2.0 } }, "extras": { "x": 1 } }),
    ];
    let names = ["", "a", "a", "", "A\nnewmtl evil\\"];
    scene.groups.insert(MATERIAL.to_owned(), names.map(str::to_owned).to_vec());
    let properties = json!({ "name": "../../CON\\é*?.PNG", "mimeType": "image/png" });
    let Value::Object(properties) = properties else { unreachable!() };
    let far = SceneImage { properties, content: ImageContent::Bytes(PNG[..].into()) };
    scene.assets.images.push(far);
    scene.assets.textures.push(json!({ "source": 3 }));
    let last = scene.assets.textures.len() - 1;
    scene.assets.materials[3]["emissiveTexture"] = json!({ "index": last });
    let beside = obj::side_files(&scene, "../x y").expect("materials");
    assert_eq!(beside.library, "_x_y.mtl");
    let library = std::str::from_utf8(&beside.files[0].bytes).expect("text");
    let named: Vec<&str> = library.lines().filter(|line| line.starts_with("newmtl")).collect();
    assert_eq!(named, ["newmtl a", "newmtl a_2", "newmtl material_3", "newmtl A newmtl evil"]);
    let first: Vec<&str> = library.lines().take(9).collect();
    // Reflectance at normal incidence is the colour of a metal.
    assert_eq!(
        first,
        ["newmtl a", "Kd 1 0.5 0", "d 1", "Ks 1 0.5 0", "Ns 30", "illum 2", "Pr 0.5", "Pm 1", ""],
        "{library}"
    );
    let files: Vec<&str> = beside.files.iter().map(|file| &*file.name).collect();
    assert!(files.contains(&"_x_y____.png"), "{files:?}");
    let lost: Vec<String> = beside.lost.iter().map(ToString::to_string).collect();
    for what in [
        "MTL holds no opacity that ends at a threshold (1x)",
        "MTL holds no occlusion textures (1x)",
        "MTL holds no textures by another set of texture coordinates than the first (1x)",
        "MTL holds no all that KHR_materials_ior says (1x)",
        "MTL holds no extras of materials (1x)",
    ] {
        assert!(lost.iter().any(|lost| lost == what), "{what}: {lost:?}");
    }
    let mut text = Vec::new();
    obj::write(&scene, None, &mut text).expect("written");
    let text = String::from_utf8(text).expect("text");
    let used: Vec<&str> = text.lines().filter(|line| line.starts_with("usemtl")).collect();
    assert_eq!(used, ["usemtl a", "usemtl a_2", "usemtl material_3", "usemtl A newmtl evil"]);
    assert!(!text.contains("mtllib"));
}

#[test]
fn a_material_of_gltf_looks_the_same_after_a_library() {
    let (text, files) = furnished();
    let (mut scene, _, _) = load(&text, &files);
    scene.groups.insert(MATERIAL.to_owned(), ["", "a"].map(str::to_owned).to_vec());
    scene.assets.materials = vec![json!({
        "name": "a",
        "pbrMetallicRoughness": {
            "baseColorFactor": [1.0, 0.5, 0.25, 0.5],
            "baseColorTexture": { "index": 1 },
            "metallicFactor": 0.5,
            "roughnessFactor": 0.125,
            "metallicRoughnessTexture": { "index": 0 },
        },
        "normalTexture": { "index": 1, "scale": 0.5 },
        "emissiveFactor": [1.0, 0.5, 0.0],
        "alphaMode": "BLEND",
        "doubleSided": true,
    })];
    let (text, files) = written(&scene, "s");
    let (back, _, _) = load(&text, &files);
    let (was, mut is) = (scene.assets.materials[0].clone(), back.assets.materials[0].clone());
    is.as_object_mut().unwrap().shift_remove("extras");
    // Textures are numbered anew.
    for (pointer, index) in [
        ("/pbrMetallicRoughness/baseColorTexture", 0),
        ("/pbrMetallicRoughness/metallicRoughnessTexture", 1),
        ("/normalTexture", 0),
    ] {
        let texture = is.pointer_mut(pointer).expect(pointer);
        assert_eq!(texture["index"], index);
        texture["index"] = was.pointer(pointer).unwrap()["index"].clone();
    }
    assert_eq!(is, was);
}

#[test]
fn a_scene_without_materials_has_no_files_beside_it_and_others_name_them() {
    let (scene, _, _) = load(&squares("gone.mtl", &["m"]), &Files::default());
    assert_eq!(obj::side_files(&scene, "s"), None);
    assert_eq!(losses(&scene, Format::Obj).unwrap(), []);
    let (text, files) = furnished();
    let (scene, _, _) = load(&text, &files);
    // What a library cannot say is told; other formats without looks say that.
    let beside = obj::side_files(&scene, "s").expect("materials");
    let lost = losses(&scene, Format::Obj).unwrap();
    assert!(beside.lost.iter().all(|one| lost.iter().any(|l| l.message == one.message)), "{lost:?}");
    assert!(lost.iter().all(|one| !one.message.to_string().contains("looks of materials")), "{lost:?}");
    let of_stl = losses(&scene, Format::Stl).unwrap();
    assert!(of_stl.iter().any(|one| one.message.to_string().contains("looks of materials")), "{of_stl:?}");
    let set = write_files(&scene, None, Format::Obj, "s").expect("written");
    let names: Vec<&str> = set.beside.iter().map(|file| &*file.name).collect();
    assert_eq!(names, beside.files.iter().map(|file| &*file.name).collect::<Vec<_>>());
    assert!(set.document.starts_with(b"mtllib s.mtl\n"));
}

#[test]
fn a_cage_is_written_with_its_library() {
    let (text, files) = furnished();
    let text = format!("{text}t interpolateboundary 1/0/0 1\n");
    let read = |text: &str, files: &Files| {
        let mut open = |path: &str| files.0.get(path).cloned().ok_or_else(String::new);
        let found = read_with(text.as_bytes(), Format::Obj, &mut open, &Limits::default()).expect("read");
        let Content::Polygons(polygons) = found.content else { panic!("a cage") };
        polygons
    };
    let cage = read(&text, &files);
    let beside = obj::side_files_of_polygons(&cage, "s").expect("materials");
    let mut out = Vec::new();
    obj::write_polygons_with_library(&cage, None, Some(&beside.library), &mut out).expect("written");
    let files = Files(beside.files.iter().map(|file| (file.name.clone(), file.bytes.to_vec())).collect());
    let back = read(std::str::from_utf8(&out).expect("text"), &files);
    assert_eq!((&back.cage, &back.groups, &back.attributes), (&cage.cage, &cage.groups, &cage.attributes));
    assert_eq!(back.assets.materials.len(), 4);
    assert_eq!(back.assets.materials[0], cage.assets.materials[0]);
}
