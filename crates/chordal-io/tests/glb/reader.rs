//! What the reader makes of legal files.
use super::build::{every_object, loaded, put, triangle, triangle_with};
use chordal::explicit::{Domain, Semantic};
use chordal_io::{Axis, Frame, TextureOrigin};
use serde_json::json;
use std::f64::consts::FRAC_1_SQRT_2;

/// The corner positions of all triangles.
fn corners(mesh: &chordal::Mesh) -> Vec<[[f64; 3]; 3]> {
    (0..mesh.faces().len()).map(|f| mesh.corners(f)).collect()
}

#[test]
fn one_triangle() {
    let (json, bin) = triangle();
    let (scene, warnings) = loaded(&json, &bin);
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(
        scene.frame,
        Frame {
            up: Some(Axis::Y),
            metres_per_unit: Some(1.0),
            texture_origin: Some(TextureOrigin::UpperLeft)
        }
    );
    assert_eq!(corners(&scene.parts[0].mesh), [[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]]]);
    assert!(!scene.parts[0].indexed);
}

#[test]
fn every_kind_of_object_is_accepted_and_what_is_dropped_is_counted() {
    let (json, bin) = every_object();
    let (scene, warnings) = loaded(&json, &bin);
    assert_eq!(scene.parts.len(), 3);
    for code in ["extension-ignored", "points-and-lines", "animations-dropped"] {
        assert!(warnings.contains(&code), "{code} is missing in {warnings:?}");
    }
    let skinned = &scene.parts[0].mesh;
    assert_eq!((skinned.positions().len(), skinned.faces().len()), (4, 2));
    // Normalized integers become fractions.
    let second = skinned.attribute(&Semantic::TexCoord(1)).expect("TEXCOORD_1");
    assert_eq!(second.row(3), [1.0 / 65535.0, 1.0 / 65535.0]);
    assert_eq!(
        skinned.attribute(&Semantic::Color(1)).expect("COLOR_1").row(0),
        [0.0, 1.0, 1.0 / 255.0, 2.0 / 255.0]
    );
    assert_eq!(skinned.attribute(&Semantic::Custom("_X".to_owned())).expect("_X").row(0), [1.5]);
    // The second mesh is a quantized strip and a fan of three vertices of which two are sparse.
    let mixed = &scene.parts[1].mesh;
    assert_eq!(mixed.positions()[3], [100.0, 100.0, -5.0]);
    assert_eq!(mixed.positions()[5], [5.0, 5.0, 5.0]);
    // The fan has no normals, so its face has corners of its own, after a vertex that no face has.
    assert_eq!(mixed.faces(), [[0, 1, 2], [1, 3, 2], [5, 6, 7]]);
    assert_eq!(mixed.positions().len(), 8);
    let material = mixed.attribute(&Semantic::Group("material".to_owned())).expect("groups");
    assert_eq!((material.domain, &material.values[..]), (Domain::Face, &[0.0, 0.0, 3.0][..]));
}

#[test]
fn transforms_apply_from_the_root_down() {
    let (json, bin) = triangle_with(&[(
        "/nodes",
        json!([
            { "children": [1], "translation": [10, 0, 0], "rotation": [0, 0, FRAC_1_SQRT_2, FRAC_1_SQRT_2] },
            { "mesh": 0, "matrix": [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 5, 1] }
        ]),
    )]);
    let scene = loaded(&json, &bin).0;
    let placed = scene.world_meshes().expect("placed");
    let expected = [[10.0, 0.0, 5.0], [10.0, 2.0, 5.0], [6.0, 0.0, 5.0]];
    for (found, expected) in placed[0].1.positions().iter().zip(expected) {
        for k in 0..3 {
            // A quarter turn by a rounded quaternion.
            assert!((found[k] - expected[k]).abs() < 16.0 * f64::EPSILON, "{found:?}");
        }
    }
}

#[test]
fn primitives_of_a_mesh_become_one_part_and_share_their_vertices() {
    let (mut json, bin) = triangle();
    let primitive = json["meshes"][0]["primitives"][0].clone();
    json["meshes"][0]["primitives"] = json!([primitive, primitive, { "attributes": { "POSITION": 0 } }]);
    let scene = loaded(&json, &bin).0;
    let mesh = &scene.parts[0].mesh;
    assert_eq!((mesh.positions().len(), mesh.faces().len()), (3, 3));
}

#[test]
fn equal_positions_are_tied_and_zero_has_one_sign() {
    let mut bin = Vec::new();
    for p in [
        [0.0_f32, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [-0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ] {
        p.iter().for_each(|x| bin.extend(x.to_le_bytes()));
    }
    let (mut json, _) = triangle();
    json["meshes"][0]["primitives"][0] = json!({ "attributes": { "POSITION": 0 } });
    json["accessors"] = json!([
        { "bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1] }
    ]);
    json["bufferViews"] = json!([{ "buffer": 0, "byteLength": 72 }]);
    json["buffers"][0]["byteLength"] = json!(72);
    let mesh = loaded(&json, &bin).0.parts.remove(0).mesh;
    assert_eq!(mesh.position_id(), Some(&[0, 1, 2, 0, 2, 5][..]));
    assert_eq!(mesh.n_positions(), 4);
}

#[test]
fn only_the_scene_that_is_shown_has_roots() {
    let (mut json, bin) = triangle();
    put(&mut json, "/nodes/1", json!({ "mesh": 0 }));
    put(&mut json, "/scenes/1", json!({ "nodes": [1] }));
    put(&mut json, "/scene", json!(1));
    assert_eq!(loaded(&json, &bin).0.roots, [1]);
    put(&mut json, "/scene", json!(null));
    assert_eq!(loaded(&json, &bin).0.roots, [0]);
    put(&mut json, "/scenes", json!(null));
    assert_eq!(loaded(&json, &bin).0.roots, [0, 1]);
    put(&mut json, "/nodes", json!(null));
    let (scene, warnings) = loaded(&json, &bin);
    assert_eq!((scene.parts.len(), scene.roots.len(), warnings), (1, 0, vec!["meshes-not-shown"]));
}

#[test]
fn triangles_without_normals_beside_others_that_have_some_are_shaded_flat() {
    let (mut json, mut bin) = triangle();
    for _ in 0..3 {
        [0.6_f32, 0.0, 0.8].iter().for_each(|x| bin.extend(x.to_le_bytes()));
    }
    put(&mut json, "/buffers/0/byteLength", json!(80));
    put(&mut json, "/bufferViews/2", json!({ "buffer": 0, "byteOffset": 44, "byteLength": 36 }));
    put(
        &mut json,
        "/accessors/2",
        json!({ "bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC3" }),
    );
    // Twice the one without, so that its vertices are shared.
    put(&mut json, "/meshes/0/primitives/1", json!({ "attributes": { "POSITION": 0, "NORMAL": 2 } }));
    put(&mut json, "/meshes/0/primitives/2", json!({ "attributes": { "POSITION": 0 }, "indices": 1 }));
    let (scene, warnings) = loaded(&json, &bin);
    assert_eq!(warnings, ["normals-of-faces"]);
    let mesh = &scene.parts[0].mesh;
    let normals = mesh.attribute(&Semantic::Normal).expect("normals");
    assert_eq!((mesh.faces().len(), mesh.positions().len()), (3, 9));
    for (face, rows) in mesh.faces().iter().enumerate() {
        let flat = chordal::explicit::face_normal(mesh.corners(face)).unwrap();
        for row in rows {
            let normal = normals.row(*row as usize);
            if face == 1 {
                assert!((normal[0] - 0.6).abs() < 1e-6 && (normal[2] - 0.8).abs() < 1e-6, "{normal:?}");
            } else {
                assert_eq!(normal, flat);
            }
        }
    }
    // The topology is that of one triangle, three times.
    assert_eq!(mesh.n_positions(), 3);
}

#[test]
fn an_attribute_that_some_primitives_lack_is_filled_and_counted() {
    let (mut json, mut bin) = triangle();
    for _ in 0..3 {
        [0.25_f32, 0.5, 1.0].iter().for_each(|x| bin.extend(x.to_le_bytes()));
    }
    put(&mut json, "/buffers/0/byteLength", json!(80));
    put(&mut json, "/bufferViews/2", json!({ "buffer": 0, "byteOffset": 44, "byteLength": 36 }));
    put(
        &mut json,
        "/accessors/2",
        json!({ "bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC3" }),
    );
    put(&mut json, "/meshes/0/primitives/1", json!({ "attributes": { "POSITION": 0, "COLOR_0": 2 } }));
    let (scene, warnings) = loaded(&json, &bin);
    assert_eq!(warnings, ["attribute-missing"]);
    let colours = scene.parts[0].mesh.attribute(&Semantic::Color(0)).expect("colours").clone();
    assert_eq!((colours.row(0), colours.row(5)), (&[1.0, 1.0, 1.0][..], &[0.25, 0.5, 1.0][..]));
    // One with a name of its own is kept only where all primitives have it.
    put(&mut json, "/meshes/0/primitives/1/attributes", json!({ "POSITION": 0, "_OWN": 2 }));
    let (scene, warnings) = loaded(&json, &bin);
    assert_eq!((warnings, scene.parts[0].mesh.attributes().len()), (vec!["attribute-skipped"], 0));
    put(&mut json, "/meshes/0/primitives/0/attributes", json!({ "POSITION": 0, "_OWN": 2 }));
    let (scene, warnings) = loaded(&json, &bin);
    assert!(warnings.is_empty());
    assert!(scene.parts[0].mesh.attribute(&Semantic::Custom("_OWN".to_owned())).is_some());
}
