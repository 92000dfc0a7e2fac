//! Levels of detail in one GLB: the first is read, the others are counted, and circles of them are refused.
use super::build::{glb_of, put, triangle};
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic};
use chordal_io::glb::{self, GlbLevels, write_levels};
use chordal_io::{
    Axis, Content, FileLocation, Frame, Limits, Node, PackedAccessor, Part, ReadError, Scene, SceneAssets,
    Warning,
};
use serde_json::{Value, json};

/// A strip of `n` triangles.
fn strip(n: u32) -> Mesh {
    let positions = (0..n + 2).map(|i| [f64::from(i / 2), f64::from(i % 2), 0.5]).collect();
    let faces = (0..n).map(|i| if i % 2 == 0 { [i, i + 2, i + 1] } else { [i, i + 1, i + 2] }).collect();
    Mesh::new(positions, faces).expect("valid")
}

const FRAME: Frame = Frame { up: Some(Axis::Z), metres_per_unit: Some(0.5), texture_origin: None };

fn scene(n: u32) -> Scene {
    Scene::from_mesh(&format!("strip {n}"), strip(n), FRAME)
}

fn part(n: u32) -> Part {
    Part { name: format!("strip {n}"), mesh: strip(n), indexed: true, ..Part::default() }
}

fn written(levels: &GlbLevels<'_>) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_levels(levels, &mut bytes).expect("written");
    bytes
}

fn json_of(glb: &[u8]) -> Value {
    let length = u32::from_le_bytes(glb[12..16].try_into().expect("four bytes")) as usize;
    serde_json::from_slice(&glb[20..20 + length]).expect("JSON")
}

fn read(bytes: &[u8]) -> Result<(Scene, Vec<Warning>), ReadError> {
    let loaded = glb::read(bytes, &Limits::default())?;
    let Content::Scene(scene) = loaded.content else { panic!("no scene") };
    Ok((scene, loaded.warnings))
}

/// The nodes that node `i` names as its levels, and its screen coverages.
fn levels_of(json: &Value, i: usize) -> (Vec<Value>, Value) {
    let node = &json["nodes"][i];
    let ids = node["extensions"]["MSFT_lod"]["ids"].as_array().expect("ids");
    let levels = ids.iter().map(|id| json["nodes"][id.as_u64().expect("id") as usize].clone());
    (levels.collect(), node["extras"]["MSFT_screencoverage"].clone())
}

#[test]
fn the_first_level_is_shown_and_the_others_stand_beside_it() {
    let scene = scene(40);
    let certificate = json!({ "levels": [{ "bound": 0.1 }, { "bound": 0.2 }, null] });
    let coverages = [vec![0.5, 0.125, 0.0]];
    let coarser = [vec![part(10), part(2)]];
    let levels = GlbLevels {
        scene: &scene,
        coarser: &coarser,
        coverages: &coverages,
        certificate: Some(&certificate),
    };
    let bytes = written(&levels);
    assert_eq!(bytes, written(&levels));

    let json = json_of(&bytes);
    assert_eq!(json["extensionsUsed"], json!(["MSFT_lod"]));
    assert_eq!(json.get("extensionsRequired"), None);
    // Two nodes for the frame, then the one of the scene.
    assert_eq!(json["scenes"], json!([{ "nodes": [0] }]));
    let (named, shares) = levels_of(&json, 2);
    assert_eq!(shares, json!(coverages[0]));
    assert_eq!(json["asset"]["extras"]["chordal"], certificate);
    let names: Vec<&Value> = named.iter().map(|node| &node["name"]).collect();
    assert_eq!(names, ["strip 40 level 1", "strip 40 level 2"]);

    // What is read is what the first level alone reads back as.
    let (found, warnings) = read(&bytes).expect("read");
    let mut alone = Vec::new();
    glb::write(&scene, None, &mut alone).expect("written");
    let (expected, _) = read(&alone).expect("read");
    assert_eq!((&found.parts, found.nodes.len()), (&expected.parts, expected.nodes.len()));
    let placed = |scene: &Scene| scene.world_meshes().expect("placed")[0].1.clone().into_owned();
    assert_eq!(placed(&found), placed(&expected));
    assert!(found.nodes.iter().all(|node| !node.properties.contains_key("extras")), "{:?}", found.nodes);
    assert_eq!(found.certificate, Some(certificate["levels"][0].clone()));
    let codes: Vec<_> = warnings.iter().map(|w| (w.code, w.count)).collect();
    assert_eq!(codes, [("lower-levels-skipped", 2)]);

    // The other levels hold what they alone would: the file is as long as its parts say.
    let n_indices = |i: usize| {
        let accessor = json["meshes"][i]["primitives"][0]["indices"].as_u64().expect("indices") as usize;
        json["accessors"][accessor]["count"].as_u64()
    };
    assert_eq!([0, 1, 2].map(n_indices), [Some(120), Some(30), Some(6)]);
}

/// One row of numbers.
fn rows(numbers: &[f32], kind: &str) -> PackedAccessor {
    let properties =
        json!({ "componentType": 5126, "count": 1, "type": kind, "min": numbers, "max": numbers });
    PackedAccessor {
        properties: properties.as_object().cloned().expect("an object"),
        bytes: numbers.iter().flat_map(|x| x.to_le_bytes()).collect(),
    }
}

/// Two instances of one part share its levels. Where a node has children, is animated or shows something
/// else, a child takes the mesh, so that no more than that is exchanged.
#[test]
fn each_instance_names_the_levels_of_its_part_in_its_own_place() {
    let shift = |x: f64| {
        let mut matrix = *Node::default().matrix;
        matrix[12] = x;
        matrix
    };
    let node = |name: &str, x: f64, part| Node {
        name: name.to_owned(),
        matrix: shift(x).into(),
        part,
        ..Node::default()
    };
    let camera = json!({ "camera": 0 }).as_object().cloned().expect("an object");
    let extras = json!({ "extras": { "of": "ours" } }).as_object().cloned().expect("an object");
    let nodes = vec![
        Node { properties: extras.into(), ..node("plain", 1.0, Some(0)) },
        Node { children: vec![2], ..node("parent", 2.0, Some(0)) },
        node("child", 3.0, Some(1)),
        Node { properties: camera.into(), ..node("camera", 4.0, Some(0)) },
        node("moved", 5.0, Some(0)),
    ];
    let mut assets = SceneAssets::default();
    assets.cameras.push(json!({ "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.1 } }));
    let rows = |numbers: &[f32], kind: &str| PackedAccessor {
        properties:
            json!({ "componentType": 5126, "count": 1, "type": kind, "min": numbers, "max": numbers })
                .as_object()
                .cloned()
                .expect("an object"),
        bytes: numbers.iter().flat_map(|x| x.to_le_bytes()).collect(),
    };
    assets.accessors = vec![rows(&[0.0], "SCALAR"), rows(&[7.0, 0.0, 0.0], "VEC3")];
    assets.animations.push(json!({
        "channels": [{ "sampler": 0, "target": { "node": 4, "path": "translation" } }],
        "samplers": [{ "input": 0, "output": 1 }]
    }));
    let frame = Frame { up: Some(Axis::Y), metres_per_unit: Some(1.0), ..Frame::default() };
    let scene = Scene {
        parts: vec![part(40), part(6)],
        nodes,
        roots: vec![0, 1, 3, 4],
        frame,
        assets: Box::new(assets),
        ..Scene::default()
    };
    let coarser = [vec![part(4)], Vec::new()];
    let share = vec![0.5, 0.0];
    let coverages = [share.clone(), share.clone(), Vec::new(), share.clone(), share.clone()];
    let levels = GlbLevels { coarser: &coarser, coverages: &coverages, ..GlbLevels::one(&scene) };
    let bytes = written(&levels);
    let json = json_of(&bytes);
    assert_eq!(json["meshes"].as_array().map(Vec::len), Some(3), "instances share their meshes");
    let (named, shares) = levels_of(&json, 0);
    assert_eq!((named.len(), &shares), (1, &json!(share)));
    assert_eq!((&json["nodes"][0]["extras"]["of"], &json["nodes"][0]["mesh"]), (&json!("ours"), &json!(0)));
    assert_eq!((&named[0]["translation"], &named[0]["mesh"]), (&json!([1.0, 0.0, 0.0]), &json!(2)));
    assert_eq!(named[0].get("extras"), None);
    for (i, children) in [(1, 2), (3, 1), (4, 1)] {
        let outer = &json["nodes"][i];
        assert_eq!((outer.get("mesh"), outer.get("extensions")), (None, None), "{outer}");
        let inner = outer["children"].as_array().expect("children");
        assert_eq!(inner.len(), children);
        let host = inner.last().and_then(Value::as_u64).expect("a node") as usize;
        let (named, shares) = levels_of(&json, host);
        assert_eq!((named.len(), &shares), (1, &json!(share)));
        assert_eq!((named[0].get("translation"), &named[0]["mesh"]), (None, &json!(2)));
    }
    // What is read shows the finest level of each instance at its place.
    let (found, _) = read(&bytes).expect("read");
    assert_eq!(found.nodes[0].properties["extras"], json!({ "of": "ours" }));
    let left = |(_, mesh): &(&str, std::borrow::Cow<'_, Mesh>)| (mesh.bounds().min[0], mesh.faces().len());
    let placed: Vec<_> = found.world_meshes().expect("placed").iter().map(left).collect();
    assert_eq!(placed, [(1.0, 40), (5.0, 6), (2.0, 40), (4.0, 40), (5.0, 40)]);
}

/// What moves a node would take the origin of its mesh for its own translation.
#[test]
fn the_origin_of_a_mesh_is_not_on_a_node_that_is_moved() {
    let far = strip(4);
    let positions = far.positions().iter().map(|p| [p[0] + 100_000.25, p[1] + 0.3, p[2]]).collect();
    let far =
        Part { mesh: far.with_positions(positions).expect("as many"), indexed: true, ..Part::default() };
    let accessors = vec![rows(&[0.0], "SCALAR"), rows(&[7.0, 0.0, 0.0], "VEC3")];
    let mut assets = SceneAssets { accessors, ..SceneAssets::default() };
    assets.animations.push(json!({
        "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }],
        "samplers": [{ "input": 0, "output": 1 }]
    }));
    assets.skins.push(json!({ "joints": [1] }));
    let node = || Node { part: Some(0), ..Node::default() };
    let scene = Scene {
        parts: vec![far],
        nodes: vec![node(), node(), node()],
        roots: vec![0, 1, 2],
        assets: Box::new(assets),
        ..Scene::default()
    };
    let json = json_of(&written(&GlbLevels::one(&scene)));
    for (i, is_moved) in [(0, true), (1, true), (2, false)] {
        let node = &json["nodes"][i];
        assert_eq!(node.get("mesh").is_none(), is_moved, "{node}");
        assert_eq!(node.get("translation").is_none(), is_moved, "{node}");
    }
}

/// A mesh with a skin at a node that has more than the mesh, and one with morph targets, take no levels.
#[test]
fn what_skins_or_morph_targets_move_takes_levels_at_plain_nodes_alone() {
    let with = |name: &str, width: usize| {
        let mesh = strip(4);
        let values = vec![if width == 1 { 1.0 } else { 0.5 }; mesh.positions().len() * width];
        let semantic = Semantic::Blended(name.to_owned());
        let attribute = Attribute { semantic, domain: Domain::Vertex, width, values };
        Part { mesh: mesh.with_attribute(attribute).expect("an attribute"), ..Part::default() }
    };
    let skinned = with("weights of joints 0 to 0, 4 a vertex", 1);
    let parts = vec![skinned.clone(), skinned, with("morph target 0 POSITION", 3), part(4)];
    let node = |part: usize| Node { part: Some(part), ..Node::default() };
    let parent = |part: usize| Node { children: vec![4], ..node(part) };
    let nodes = vec![node(0), parent(1), node(2), node(3), Node::default()];
    let scene = Scene { parts, nodes, roots: (0..4).collect(), ..Scene::default() };
    assert_eq!(glb::takes_levels(&scene), [true, false, false, true]);
    let coarser: Vec<Vec<Part>> = (0..4).map(|i| if i == 1 { vec![part(1)] } else { Vec::new() }).collect();
    let coverages = [Vec::new(), vec![0.5, 0.0]];
    let levels = GlbLevels { coarser: &coarser, coverages: &coverages, ..GlbLevels::one(&scene) };
    let error = write_levels(&levels, &mut Vec::new()).expect_err("refused").to_string();
    assert!(error.contains("part 1 cannot have levels"), "{error}");
}

#[test]
fn a_single_level_is_a_plain_file() {
    let scene = scene(3);
    let certificate = json!({ "bound": 1 });
    let mut plain = Vec::new();
    glb::write(&scene, Some(&certificate), &mut plain).expect("written");
    assert_eq!(written(&GlbLevels { certificate: Some(&certificate), ..GlbLevels::one(&scene) }), plain);
}

#[test]
fn levels_out_of_order_are_refused() {
    let scene = scene(3);
    for (coverages, words) in [
        (vec![], "0 screen coverages for 2 levels"),
        (vec![0.5], "1 screen coverages for 2 levels"),
        (vec![0.5, 0.5], "level 1 of node 0 is not shown on less"),
        (vec![0.25, 0.5], "level 1 of node 0 is not shown on less"),
        (vec![f64::NAN, 0.0], "level 0 of node 0 is shown from NaN"),
        (vec![0.5, -0.1], "level 1 of node 0 is shown from -0.1"),
        (vec![1.5, 0.1], "level 0 of node 0 is shown from 1.5"),
    ] {
        let (coarser, coverages) = ([vec![part(1)]], [coverages]);
        let levels = GlbLevels { coarser: &coarser, coverages: &coverages, ..GlbLevels::one(&scene) };
        let mut out = Vec::new();
        let error = write_levels(&levels, &mut out).expect_err("refused").to_string();
        assert!(error.contains(words) && out.is_empty(), "{error}");
    }
    let (coarser, coverages) = ([vec![Part::default()]], [vec![0.5, 0.0]]);
    let levels = GlbLevels { coarser: &coarser, coverages: &coverages, ..GlbLevels::one(&scene) };
    let error = write_levels(&levels, &mut Vec::new()).expect_err("refused").to_string();
    assert!(error.contains("level 1 of part 0 has no triangle"), "{error}");
}

/// The triangle under several nodes, of which each names the lower levels given.
fn nodes_with(ids: &[&[usize]]) -> Value {
    let nodes = ids.iter().map(|ids| match ids {
        [] => json!({ "mesh": 0 }),
        ids => json!({ "mesh": 0, "extensions": { "MSFT_lod": { "ids": ids } } }),
    });
    let mut json = triangle().0;
    put(&mut json, "/nodes", nodes.collect());
    put(&mut json, "/extensionsUsed", json!(["MSFT_lod"]));
    json
}

#[track_caller]
fn refused(json: &Value) -> (&'static str, String) {
    let error = read(&glb_of(&json.to_string(), &triangle().1)).expect_err("refused");
    let FileLocation::Pointer(pointer) = error.place else { panic!("{error}") };
    (error.code, pointer)
}

#[test]
fn h74_levels_in_a_circle_are_refused() {
    let pointer = "/nodes/0/extensions/MSFT_lod/ids".to_owned();
    assert_eq!(refused(&nodes_with(&[&[0]])), ("lod-cycle", pointer.clone()));
    assert_eq!(refused(&nodes_with(&[&[1], &[0]])), ("lod-cycle", pointer.clone()));
    assert_eq!(refused(&nodes_with(&[&[1], &[2], &[0]])), ("lod-cycle", pointer.clone()));
    // A child whose lower level is its parent.
    let mut json = nodes_with(&[&[], &[0]]);
    put(&mut json, "/nodes/0/children", json!([1]));
    assert_eq!(refused(&json), ("lod-cycle", "/nodes/1/extensions/MSFT_lod/ids".to_owned()));
    // Lists that share a level are none.
    let json = nodes_with(&[&[1, 2], &[2], &[]]);
    let (scene, warnings) = read(&glb_of(&json.to_string(), &triangle().1)).expect("read");
    assert_eq!((scene.nodes.len(), scene.parts.len()), (1, 1));
    assert_eq!(warnings.iter().find(|w| w.code == "lower-levels-skipped").map(|w| w.count), Some(3));
}

#[test]
fn h74_levels_that_are_not_there_are_refused() {
    let at = |k: usize| format!("/nodes/0/extensions/MSFT_lod/ids/{k}");
    assert_eq!(refused(&nodes_with(&[&[1]])), ("UNRESOLVED_REFERENCE", at(0)));
    assert_eq!(refused(&nodes_with(&[&[1, 7], &[]])), ("UNRESOLVED_REFERENCE", at(1)));
    for wrong in [json!([-1]), json!([0.5]), json!(["1"]), json!([null])] {
        let mut json = nodes_with(&[&[1], &[]]);
        put(&mut json, "/nodes/0/extensions/MSFT_lod/ids", wrong);
        assert_eq!(refused(&json), ("UNRESOLVED_REFERENCE", at(0)));
    }
    for wrong in [json!([]), json!(1), json!({})] {
        let mut json = nodes_with(&[&[1], &[]]);
        put(&mut json, "/nodes/0/extensions/MSFT_lod/ids", wrong);
        assert_eq!(refused(&json), ("UNDEFINED_PROPERTY", "/nodes/0/extensions/MSFT_lod/ids".to_owned()));
    }
}

#[test]
fn a_lower_level_that_the_scene_shows_too_is_kept() {
    let mut json = nodes_with(&[&[1, 2], &[], &[]]);
    put(&mut json, "/scenes/0/nodes", json!([0, 1]));
    let (scene, _) = read(&glb_of(&json.to_string(), &triangle().1)).expect("read");
    assert_eq!((scene.nodes.len(), scene.roots), (2, vec![0, 1]));
    // Without scenes the roots are shown, and a lower level is no root.
    let mut json = nodes_with(&[&[1], &[]]);
    put(&mut json, "/scenes", Value::Null);
    put(&mut json, "/scene", Value::Null);
    let (scene, _) = read(&glb_of(&json.to_string(), &triangle().1)).expect("read");
    assert_eq!((scene.nodes.len(), scene.roots), (1, vec![0]));
}
