//! Implicit tilings: which tiles their bits say are there, and bits that are too few, too many or wrong.
use super::build::{Folder, read_in, refused, tile_json, tileset_json};
use chordal_io::ReadError;
use chordal_io::tiles::{ImplicitTiling, Subdivision};
use serde_json::{Value, json};

/// A subtree file.
fn subtree(json: &Value, binary: &[u8]) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(8), b' ');
    let mut bytes = b"subt\x01\0\0\0".to_vec();
    bytes.extend((text.len() as u64).to_le_bytes());
    bytes.extend((binary.len() as u64).to_le_bytes());
    bytes.extend(text);
    bytes.extend(binary);
    bytes
}

/// Two levels of a quadtree: the first tile, its second and fourth child, and the second one's last subtree.
fn two_levels() -> (Value, Vec<u8>) {
    let json = json!({
        "buffers": [{ "byteLength": 16 }],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 1 },
            { "buffer": 0, "byteOffset": 8, "byteLength": 2 },
        ],
        "tileAvailability": { "bitstream": 0, "availableCount": 3 },
        "contentAvailability": [{ "bitstream": 0, "availableCount": 3 }],
        "childSubtreeAvailability": { "bitstream": 1, "availableCount": 1 },
    });
    let mut binary = vec![0; 16];
    binary[0] = 0b10101;
    binary[8] = 0b1000_0000;
    (json, binary)
}

/// All of two levels, and nothing below.
fn full() -> Vec<u8> {
    let json = json!({
        "tileAvailability": { "constant": 1 },
        "contentAvailability": [{ "constant": 0 }],
        "childSubtreeAvailability": { "constant": 0 },
    });
    subtree(&json, &[])
}

fn tileset(subdivision: &str, levels: u32) -> Value {
    let mut root = tile_json(8.0);
    root["content"] = json!({ "uri": "c/{level}_{x}_{y}_{z}.glb" });
    root["implicitTiling"] = json!({
        "subdivisionScheme": subdivision, "subtreeLevels": 2, "availableLevels": levels,
        "subtrees": { "uri": "s/{level}.{x}.{y}.{z}.subtree" },
    });
    tileset_json(root)
}

fn implicit(tileset: &Value, files: &[(&str, Vec<u8>)]) -> Result<ImplicitTiling, ReadError> {
    let folder: Folder = files.iter().map(|(path, bytes)| ((*path).to_owned(), bytes.clone())).collect();
    let (tileset, _) = read_in(&folder, tileset.to_string().as_bytes())?;
    Ok(tileset.root.implicit.expect("implicit"))
}

const FIRST: &str = "s/0.0.0.0.subtree";

/// The first subtree with something changed, and the one below it.
fn with(change: impl FnOnce(&mut Value, &mut Vec<u8>)) -> Result<ImplicitTiling, ReadError> {
    let (mut json, mut binary) = two_levels();
    change(&mut json, &mut binary);
    // Bit 7 of the third level: x = 0b11 & 0b01 | …, which is (3, 1).
    implicit(&tileset("QUADTREE", 4), &[(FIRST, subtree(&json, &binary)), ("s/2.3.1.0.subtree", full())])
}

#[test]
fn bits_say_which_tiles_are_there() {
    let found = with(|_, _| {}).expect("read");
    assert_eq!(found.subdivision, Subdivision::Quadtree);
    assert_eq!((found.n_subtrees, found.n_tiles, found.n_contents), (2, vec![1, 2, 1, 4], vec![1, 2, 0, 0]));
    let octree = implicit(&tileset("OCTREE", 2), &[(FIRST, full())]).expect("read");
    assert_eq!(octree.n_tiles, [1, 8]);
}

#[test]
fn bits_may_stand_in_a_file_of_their_own() {
    let (mut json, binary) = two_levels();
    json["buffers"][0]["uri"] = json!("../bits/all%20bits.bin");
    let files = [(FIRST, subtree(&json, &[])), ("bits/all bits.bin", binary), ("s/2.3.1.0.subtree", full())];
    assert_eq!(implicit(&tileset("QUADTREE", 4), &files).expect("read").n_tiles, [1, 2, 1, 4]);
    json["buffers"][0]["uri"] = json!("../../bits.bin");
    let outside = implicit(&tileset("QUADTREE", 4), &[(FIRST, subtree(&json, &[]))]);
    assert_eq!(refused(outside), ("outside-folder", "/buffers/0/uri".to_owned()));
    json["buffers"][0]["uri"] = json!("none.bin");
    let missing = implicit(&tileset("QUADTREE", 4), &[(FIRST, subtree(&json, &[]))]);
    assert_eq!(refused(missing), ("file-missing", "/buffers/0/uri".to_owned()));
}

#[test]
fn h75_subtrees_that_are_missing_are_refused() {
    let at = "/root/implicitTiling/subtrees/uri".to_owned();
    assert_eq!(refused(implicit(&tileset("QUADTREE", 2), &[])), ("file-missing", at.clone()));
    let (json, binary) = two_levels();
    let error = implicit(&tileset("QUADTREE", 4), &[(FIRST, subtree(&json, &binary))]).expect_err("refused");
    assert!(error.code == "file-missing" && error.message.contains("'s/2.3.1.0.subtree'"), "{error}");
    assert_eq!(refused(Err::<(), _>(error)).1, at);
}

#[test]
fn h75_bits_of_the_wrong_length_are_refused() {
    for length in [0, 2, 3, 1000] {
        let found = with(|json, _| json["bufferViews"][0]["byteLength"] = json!(length));
        assert_eq!(refused(found), ("wrong-bit-length", "/tileAvailability".to_owned()));
    }
    let found = with(|json, _| json["bufferViews"][1]["byteLength"] = json!(1));
    assert_eq!(refused(found), ("wrong-bit-length", "/childSubtreeAvailability".to_owned()));
    let found = with(|json, _| json["bufferViews"][1]["byteOffset"] = json!(15));
    assert_eq!(refused(found), ("view-too-long", "/childSubtreeAvailability".to_owned()));
    let found = with(|json, _| json["bufferViews"][1]["byteOffset"] = json!(9_000_000_000_000_000_u64));
    assert_eq!(refused(found), ("view-too-long", "/childSubtreeAvailability".to_owned()));
    let found = with(|_, binary| binary.truncate(12));
    assert_eq!(refused(found), ("buffer-too-short", "/buffers/0/byteLength".to_owned()));
    let found = with(|json, _| json["tileAvailability"]["availableCount"] = json!(4));
    assert_eq!(refused(found), ("wrong-count", "/tileAvailability".to_owned()));
    let found = with(|json, _| json["tileAvailability"]["bitstream"] = json!(2));
    assert_eq!(refused(found), ("no-such-view", "/tileAvailability".to_owned()));
    let found = with(|json, _| json["bufferViews"][0]["buffer"] = json!(1));
    assert_eq!(refused(found), ("no-such-buffer", "/tileAvailability".to_owned()));
}

#[test]
fn h75_bits_that_contradict_each_other_are_refused() {
    let tiles = |byte: u8, count: u64| {
        with(move |json, binary| {
            binary[0] = byte;
            json["tileAvailability"]["availableCount"] = json!(count);
            json["contentAvailability"] = json!([{ "constant": 0 }]);
        })
    };
    assert_eq!(refused(tiles(0b10100, 2)), ("empty-subtree", "/tileAvailability".to_owned()));
    let found = with(|json, binary| {
        binary[1] = 0b1;
        json["bufferViews"]
            .as_array_mut()
            .expect("views")
            .push(json!({ "buffer": 0, "byteOffset": 2, "byteLength": 1 }));
        binary[2] = 0b11;
        json["contentAvailability"] = json!([{ "bitstream": 2 }]);
    });
    assert_eq!(refused(found), ("no-such-tile", "/contentAvailability/0".to_owned()));
    // Three levels, of which the last tile's parent is missing.
    let json = json!({
        "buffers": [{ "byteLength": 3 }],
        "bufferViews": [{ "buffer": 0, "byteOffset": 0, "byteLength": 3 }],
        "tileAvailability": { "bitstream": 0 },
        "childSubtreeAvailability": { "constant": 0 },
    });
    let mut tileset = tileset("QUADTREE", 3);
    tileset["root"]["implicitTiling"]["subtreeLevels"] = json!(3);
    let orphan = subtree(&json, &[0b1, 0, 0b1_0000]);
    assert_eq!(
        refused(implicit(&tileset, &[(FIRST, orphan)])),
        ("no-such-tile", "/tileAvailability".to_owned())
    );
    let child = subtree(&json, &[0b1_0001, 0, 0b1_0000]);
    assert_eq!(implicit(&tileset, &[(FIRST, child)]).expect("read").n_tiles, [1, 1, 1]);
}

#[test]
fn h75_tiles_below_the_levels_that_are_named_are_refused() {
    let deep = |levels| {
        let (json, binary) = two_levels();
        implicit(
            &tileset("QUADTREE", levels),
            &[(FIRST, subtree(&json, &binary)), ("s/2.3.1.0.subtree", full())],
        )
    };
    assert_eq!(refused(deep(1)), ("beyond-levels", "/tileAvailability".to_owned()));
    assert_eq!(refused(deep(2)), ("beyond-levels", "/childSubtreeAvailability".to_owned()));
    assert_eq!(refused(deep(3)), ("beyond-levels", "/tileAvailability".to_owned()));
}

#[test]
fn h75_a_few_bytes_cannot_ask_for_endless_work() {
    let template = |uri: &str| {
        let mut tileset = tileset("QUADTREE", 40);
        tileset["root"]["implicitTiling"]["subtrees"]["uri"] = json!(uri);
        tileset
    };
    let at = "/root/implicitTiling/subtrees/uri".to_owned();
    for uri in ["all.subtree", "{x}.{y}.subtree", "{level}.{x}.subtree"] {
        assert_eq!(refused(implicit(&template(uri), &[])), ("bad-template", at.clone()));
    }
    assert_eq!(refused(implicit(&template("../{level}{x}{y}"), &[])).0, "outside-folder");
    let everything = json!({
        "tileAvailability": { "constant": 1 }, "contentAvailability": [{ "constant": 1 }],
        "childSubtreeAvailability": { "constant": 1 },
    });
    let all = subtree(&everything, &[]);
    let mut tall = tileset("OCTREE", 62);
    assert_eq!(refused(implicit(&tall, &[(FIRST, all.clone())])).0, "file-missing");
    tall["root"]["implicitTiling"]["subtreeLevels"] = json!(20);
    assert_eq!(refused(implicit(&tall, &[(FIRST, all.clone())])).0, "too-many-rows");
    tall["root"]["implicitTiling"]["subtreeLevels"] = json!(62);
    assert_eq!(refused(implicit(&tall, &[(FIRST, all.clone())])).0, "unsupported");
    for (key, value) in
        [("subtreeLevels", json!(0)), ("availableLevels", json!(63)), ("subtreeLevels", json!(1.5))]
    {
        let mut wrong = tileset("QUADTREE", 2);
        wrong["root"]["implicitTiling"][key] = value;
        assert_eq!(refused(implicit(&wrong, &[])), ("out-of-range", format!("/root/implicitTiling/{key}")));
    }
}

#[test]
fn h75_containers_that_are_broken_are_refused() {
    let (json, binary) = two_levels();
    let good = subtree(&json, &binary);
    let first = |bytes: Vec<u8>| refused(implicit(&tileset("QUADTREE", 4), &[(FIRST, bytes)]));
    assert_eq!(first(good[..20].to_vec()), ("truncated", "byte 20".to_owned()));
    assert_eq!(first(good[..good.len() - 1].to_vec()).0, "wrong-length");
    assert_eq!(first([&good[..], b"x"].concat()).0, "wrong-length");
    assert_eq!(first([b"b3dm", &good[4..]].concat()).0, "bad-magic");
    assert_eq!(first([b"subt\x02", &good[5..]].concat()).0, "unsupported");
    assert_eq!(first([b"\x1f\x8b", &good[2..]].concat()).0, "compressed");
    let mut long = good.clone();
    long[16..24].copy_from_slice(&u64::MAX.to_le_bytes());
    assert_eq!(first(long).0, "wrong-length");
    for n in 24..good.len() {
        let mut changed = good.clone();
        changed[n] ^= 0x15;
        // Whatever comes of it, it comes.
        let _ = implicit(&tileset("QUADTREE", 4), &[(FIRST, changed)]);
    }
}
