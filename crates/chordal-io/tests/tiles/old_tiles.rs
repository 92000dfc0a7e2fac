//! Tiles of 3D Tiles 1.0, and tilesets as one scene.
use super::build::{Folder, tile_json, tileset_json};
use chordal::Mesh;
use chordal_io::{Content, Format, Frame, Limits, ReadError, Scene, glb, read, read_with};
use serde_json::{Value, json};

/// A GLB of one triangle with a corner at `x` and y 2.
fn glb_at(x: f64) -> Vec<u8> {
    let mesh = Mesh::new(vec![[x, 2.0, 3.0], [x + 1.0, 2.0, 3.0], [x, 4.0, 3.0]], vec![[0, 1, 2]]).unwrap();
    let mut bytes = Vec::new();
    glb::write(&Scene::from_mesh("t", mesh, Frame::default()), None, &mut bytes).unwrap();
    bytes
}

fn word(n: usize) -> [u8; 4] {
    (n as u32).to_le_bytes()
}

/// A tile with a table of features; `binary` is its binary part.
fn tile(magic: &[u8; 4], table: &str, binary: &[u8], model: &[u8]) -> Vec<u8> {
    let kind: &[u8] = if magic == b"i3dm" { &[1, 0, 0, 0] } else { &[] };
    let body = [kind, table.as_bytes(), binary, model].concat();
    let n = 28 + body.len();
    let head = [&magic[..], &word(1), &word(n), &word(table.len()), &word(binary.len()), &word(0), &word(0)];
    [&head.concat()[..], &body].concat()
}

fn composite(tiles: &[Vec<u8>]) -> Vec<u8> {
    let body = tiles.concat();
    [b"cmpt", &word(1)[..], &word(16 + body.len()), &word(tiles.len()), &body].concat()
}

/// The first corner of every mesh that is shown, where it is shown.
fn corners(scene: &Scene) -> Vec<[f64; 3]> {
    let mut all: Vec<[f64; 3]> =
        scene.world_meshes().unwrap().iter().map(|(_, mesh)| mesh.positions()[0]).collect();
    all.sort_by(|a, b| a[0].total_cmp(&b[0]));
    all
}

fn scene_of(bytes: &[u8], format: Format) -> Result<Scene, ReadError> {
    match read(bytes, format, &Limits::default())?.content {
        Content::Scene(scene) => Ok(scene),
        _ => panic!("no scene"),
    }
}

#[test]
fn a_batched_model_is_its_glb_about_its_centre() {
    let plain = tile(b"b3dm", "{\"BATCH_LENGTH\":0}  ", &[], &glb_at(0.0));
    assert_eq!(Format::sniff(&plain), Some(Format::B3dm));
    assert_eq!(corners(&scene_of(&plain, Format::B3dm).unwrap()), [[0.0, 2.0, 3.0]]);
    // The centre is z-up, where the GLB's y is the z: (x, y, z) of tiles is (x, z, −y) of the GLB.
    let moved = tile(b"b3dm", "{\"RTC_CENTER\":[10,20,30]}", &[], &glb_at(0.0));
    assert_eq!(corners(&scene_of(&moved, Format::B3dm).unwrap()), [[10.0, 32.0, -17.0]]);
}

#[test]
fn instances_and_composites_show_all_of_theirs() {
    let floats = |list: &[f32]| list.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let places = floats(&[0.0, 0.0, 0.0, 100.0, 0.0, 7.0, 1.0, 2.0]);
    let table = "{\"INSTANCES_LENGTH\":2,\"POSITION\":{\"byteOffset\":0},\"SCALE\":{\"byteOffset\":24}}";
    let instances = tile(b"i3dm", table, &places, &glb_at(0.0));
    assert_eq!(Format::sniff(&instances), Some(Format::I3dm));
    let shown = corners(&scene_of(&instances, Format::B3dm).unwrap());
    assert_eq!(shown, [[0.0, 2.0, 3.0], [100.0, 11.0, 6.0]]);
    let turned = "{\"INSTANCES_LENGTH\":1,\"POSITION\":{\"byteOffset\":0},\"NORMAL_UP\":{\"byteOffset\":12},\
                  \"NORMAL_RIGHT\":{\"byteOffset\":24}}";
    // Right is y and up is z: x of the instance goes to y of the tileset, which is −z of the GLB. Its y axis stays up.
    let axes = floats(&[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0]);
    let shown = corners(&scene_of(&tile(b"i3dm", turned, &axes, &glb_at(5.0)), Format::B3dm).unwrap());
    // Of the GLB (5, 2, 3) is (5, −3, 2) in the space of tiles; along right (0, 1, 0), up (0, 0, 1) and their product
    // (1, 0, 0) that is 5 · right − 3 · up + 2 · forward.
    assert_eq!(shown, [[2.0, -3.0, -5.0]]);
    let both = composite(&[tile(b"b3dm", "", &[], &glb_at(-9.0)), composite(&[instances])]);
    assert_eq!(corners(&scene_of(&both, Format::Cmpt).unwrap()).len(), 3);
    // Each is called by its own kind, by its name as by its content.
    assert_eq!(
        (Format::sniff(&both), Format::from_extension("cmpt")),
        (Some(Format::Cmpt), Some(Format::Cmpt))
    );
    assert_eq!(Format::Cmpt.to_string(), "cmpt");
}

#[test]
fn tiles_that_lie_are_one_error_at_their_byte() {
    let good = tile(b"b3dm", "{\"BATCH_LENGTH\":0}  ", &[], &glb_at(0.0));
    let with = |at: usize, n: usize| {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&word(n));
        bytes
    };
    for (bytes, code) in [
        (good[..20].to_vec(), "truncated"),
        (good[..good.len() - 1].to_vec(), "truncated"),
        (with(4, 2), "unsupported"),
        (with(8, 27), "bad-header"),
        (with(8, usize::MAX & 0xffff_ffff), "truncated"),
        (with(12, 0xffff_ffff), "truncated"),
        (with(24, good.len()), "truncated"),
        (with(12, 5), "bad-json"),
        (tile(b"b3dm", "{\"RTC_CENTER\":[1,2]}", &[], &glb_at(0.0)), "bad-header"),
        (tile(b"i3dm", "{}", &[], &glb_at(0.0)), "bad-header"),
        (tile(b"i3dm", "{\"INSTANCES_LENGTH\":1}", &[], &glb_at(0.0)), "bad-header"),
        (
            tile(b"i3dm", "{\"INSTANCES_LENGTH\":1,\"POSITION\":{\"byteOffset\":4}}", &[0; 12], &glb_at(0.0)),
            "bad-header",
        ),
        (
            tile(
                b"i3dm",
                "{\"INSTANCES_LENGTH\":99999999999,\"POSITION\":{\"byteOffset\":0}}",
                &[0; 12],
                &glb_at(0.0),
            ),
            "too-many-rows",
        ),
        (tile(b"i3dm", "{\"INSTANCES_LENGTH\":1,\"EAST_NORTH_UP\":true}", &[], &glb_at(0.0)), "unsupported"),
        (composite(&[b"pnts\x01\0\0\0\x10\0\0\0\0\0\0\0".to_vec()]), "unsupported"),
        (composite(&[]), "no-triangles"),
        ((0..20).fold(good.clone(), |inner, _| composite(&[inner])), "too-deep"),
    ] {
        assert_eq!(scene_of(&bytes, Format::B3dm).unwrap_err().code, code, "{code}");
    }
}

fn with_content(error: f64, uri: &str, children: &[Value]) -> Value {
    let mut tile = tile_json(error);
    tile["content"] = json!({ "uri": uri });
    if !children.is_empty() {
        tile["children"] = json!(children);
    }
    tile
}

fn read_tileset(list: &Value, folder: &Folder) -> Result<Scene, ReadError> {
    let mut open = |path: &str| folder.get(path).cloned().ok_or_else(|| "no such file".to_owned());
    let text = list.to_string();
    assert_eq!(Format::sniff(text.as_bytes()), Some(Format::Tileset));
    match read_with(text.as_bytes(), Format::Tileset, &mut open, &Limits::default())?.content {
        Content::Scene(scene) => Ok(scene),
        _ => panic!("no scene"),
    }
}

#[test]
fn the_finest_tiles_of_a_tileset_are_one_scene() {
    let folder: Folder = [("coarse.glb", 50.0), ("a.glb", 0.0), ("b.glb", 10.0)]
        .into_iter()
        .map(|(name, x)| (name.to_owned(), glb_at(x)))
        .collect();
    let mut moved = with_content(0.0, "b.glb", &[]);
    moved["transform"] = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 4, 1]);
    let leaves = [with_content(0.0, "a.glb", &[]), moved];
    let mut list = tileset_json(with_content(4.0, "coarse.glb", &leaves));
    let scene = read_tileset(&list, &folder).unwrap();
    assert_eq!(corners(&scene), [[0.0, 2.0, 3.0], [11.0, 6.0, 1.0]]);
    // Where finer tiles are added to it, a coarse one is shown as well.
    list["root"]["refine"] = json!("ADD");
    assert_eq!(corners(&read_tileset(&list, &folder).unwrap()).len(), 3);
    list["root"]["children"][0]["content"]["uri"] = json!("missing.glb");
    let error = read_tileset(&list, &folder).unwrap_err();
    assert!(error.code == "file-missing" && error.message.contains("missing.glb"), "{error}");
    let alone = read(list.to_string().as_bytes(), Format::Tileset, &Limits::default()).unwrap_err();
    assert_eq!(alone.code, "detached");
    let empty = tileset_json(tile_json(1.0));
    assert_eq!(read_tileset(&empty, &folder).unwrap_err().code, "no-triangles");
}
