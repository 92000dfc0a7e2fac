//! What the writer writes, and what it refuses.
use super::build::{Folder, chain, cube, read_in, tileset};
use chordal_io::tiles::{BoundingVolume, GeoPlace, Refine, Tile, TileFault, Tileset, write};
use serde_json::{Value, json};

#[test]
fn what_is_written_reads_back() {
    let mut tileset = tileset(&[0.7, 0.1, 0.0]);
    tileset.extras = Some(json!({ "chordal": { "bound": 0.1 } }));
    tileset.root.extras = Some(json!({ "chordal": { "bound": [0.25, 0.7], "name": "a \"quoted\" ü" } }));
    tileset.root.children[0].refine = Refine::Add;
    tileset.root.children[0].contents.push("more.glb".to_owned());
    tileset.root.children.push(Tile { contents: vec![], ..Tile::leaf(cube(0.5), "") });
    let bytes = write(&tileset).expect("written");
    assert_eq!(bytes, write(&tileset).expect("written"));
    let (read, warnings) = read_in(&Folder::new(), &bytes).expect("read");
    assert_eq!(warnings, []);
    let json: Value = serde_json::from_slice(&bytes).expect("JSON");
    assert_eq!(json["root"]["children"][0]["children"][0]["refine"], json!("REPLACE"));
    assert_eq!(read, tileset);
}

#[test]
fn the_text_says_what_the_specification_asks_for() {
    let bytes = write(&tileset(&[0.5, 0.0])).expect("written");
    let json: Value = serde_json::from_slice(&bytes).expect("JSON");
    assert_eq!(json["asset"]["version"], "1.1");
    assert_eq!(json["geometricError"], 4.0);
    assert_eq!(json["root"]["refine"], "REPLACE");
    assert_eq!(json["root"]["content"], json!({ "uri": "0.glb" }));
    assert_eq!(json["root"]["boundingVolume"]["box"].as_array().map(Vec::len), Some(12));
    assert_eq!(json["root"]["children"][0]["geometricError"], 0.0);
    assert_eq!(json["root"]["children"][0].get("refine"), None);
    assert_eq!(json["root"]["children"][0].get("children"), None);
}

#[track_caller]
fn fault(tileset: &Tileset) -> (String, TileFault) {
    let error = write(tileset).expect_err("refused");
    assert!(error.to_string().starts_with(&error.tile));
    (error.tile, error.fault)
}

#[test]
fn h74_errors_that_do_not_fall_are_refused() {
    let at = |n: usize| format!("/root{}", "/children/0".repeat(n));
    let not = |error, parent| TileFault::NotDecreasing { error, parent };
    assert_eq!(fault(&tileset(&[0.5, 0.5, 0.0])), (at(1), not(0.5, 0.5)));
    assert_eq!(fault(&tileset(&[0.5, 0.25, 0.3, 0.0])), (at(2), not(0.3, 0.25)));
    assert_eq!(fault(&tileset(&[0.0, 0.0])), (at(1), not(0.0, 0.0)));
    assert_eq!(fault(&tileset(&[0.5, 0.1])), (at(1), TileFault::LeafError(0.1)));
    assert_eq!(fault(&tileset(&[0.5, -0.5, 0.0])), (at(1), TileFault::BadError(-0.5)));
    let (tile, error) = fault(&tileset(&[0.5, f64::NAN, 0.0]));
    assert!(tile == at(1) && matches!(error, TileFault::BadError(x) if x.is_nan()));
    assert_eq!(fault(&tileset(&[f64::INFINITY, 0.0])), (at(0), TileFault::BadError(f64::INFINITY)));
}

#[test]
fn h74_the_error_of_the_tileset_is_above_zero_and_not_below_the_roots() {
    for error in [0.0, 0.4] {
        let low = Tileset { geometric_error: error, ..tileset(&[0.5, 0.0]) };
        assert_eq!(fault(&low), (String::new(), TileFault::BadTilesetError { error, root: 0.5 }));
    }
    let endless = Tileset { geometric_error: f64::INFINITY, ..tileset(&[0.5, 0.0]) };
    assert_eq!(fault(&endless), (String::new(), TileFault::BadError(f64::INFINITY)));
}

#[test]
fn h74_a_single_tile_is_written() {
    let single = tileset(&[0.0]);
    let (read, _) = read_in(&Folder::new(), &write(&single).expect("written")).expect("read");
    assert_eq!(read, single);
}

#[test]
fn boxes_that_stick_out_or_are_none_are_refused() {
    let with = |volume| {
        let mut tileset = tileset(&[0.5, 0.0]);
        tileset.root.children[0].volume = volume;
        tileset
    };
    let at = "/root/children/0".to_owned();
    for (k, x) in [(0, 1e-9), (3, 1.000_000_1), (11, 2.0)] {
        let mut volume = cube(1.0);
        volume[k] = x;
        assert_eq!(fault(&with(BoundingVolume::Box(volume))), (at.clone(), TileFault::BoxOutside), "{k}");
    }
    for (k, x) in [(0, f64::NAN), (3, -1.0), (4, 0.5), (7, f64::INFINITY)] {
        let mut volume = cube(1.0);
        volume[k] = x;
        assert_eq!(fault(&with(BoundingVolume::Box(volume))), (at.clone(), TileFault::NoBox), "{k}");
    }
    assert_eq!(fault(&with(BoundingVolume::Sphere([0.0, 0.0, 0.0, 1.0]))), (at.clone(), TileFault::NoBox));
    // A unit in the last place is rounding.
    let mut volume = cube(1.0);
    volume[3] = 1.0_f64.next_up();
    assert!(write(&with(BoundingVolume::Box(volume))).is_ok());
    // A flat tile in a flat tile.
    let mut flat = cube(1.0);
    flat[11] = 0.0;
    let mut tileset = with(BoundingVolume::Box(flat));
    tileset.root.volume = BoundingVolume::Box(flat);
    assert!(write(&tileset).is_ok());
}

#[test]
fn h75_names_that_lead_elsewhere_are_refused() {
    for uri in [
        "../a.glb",
        "/a.glb",
        "http://x/a.glb",
        "a b.glb",
        "a%20b.glb",
        "",
        "a/",
        "C:/a.glb",
        "a\\b",
        "ü.glb",
        "a?b",
    ] {
        let mut tileset = tileset(&[0.0]);
        tileset.root.contents = vec![uri.to_owned()];
        assert_eq!(fault(&tileset), ("/root".to_owned(), TileFault::BadUri(uri.to_owned())));
    }
}

#[test]
fn trees_that_are_too_deep_for_readers_are_refused() {
    let errors: Vec<f64> = (0..51).map(|i| f64::from(50 - i)).collect();
    let mut deep = Tileset { geometric_error: 100.0, root: chain(&errors), extras: None };
    let (read, _) = read_in(&Folder::new(), &write(&deep).expect("written")).expect("read");
    assert_eq!(read, deep);
    deep.root = Tile { geometric_error: 60.0, children: vec![deep.root], ..Tile::leaf(cube(1.0), "a.glb") };
    assert_eq!(fault(&deep), (format!("/root{}", "/children/0".repeat(51)), TileFault::TooDeep));
}

#[test]
fn what_is_only_read_is_not_written() {
    let mut tileset = tileset(&[0.5, 0.0]);
    tileset.root.transform = Some(Box::new([0.0; 16]));
    let only_read = TileFault::OnlyRead("a transform other than a rigid one of the root");
    assert_eq!(fault(&tileset), ("/root".to_owned(), only_read.clone()));
    let mut shift = Box::new([0.0; 16]);
    [0, 5, 10, 15].iter().for_each(|i| shift[*i] = 1.0);
    (shift[12], shift[13]) = (1e6, -2.5);
    tileset.root.transform = Some(shift.clone());
    let (read, _) = read_in(&Folder::new(), &write(&tileset).expect("written")).expect("read");
    assert_eq!(read, tileset);
    // On the Earth the root is turned, too; twice the size, or mirrored, it has other errors or sides.
    let berlin = GeoPlace::new(52.52, 13.405, 34.0).expect("a place").matrix();
    tileset.root.transform = Some(Box::new(berlin));
    let (read, _) = read_in(&Folder::new(), &write(&tileset).expect("written")).expect("read");
    assert_eq!(read.root.transform.as_deref(), Some(&berlin));
    let changed = |change: fn(usize, f64) -> f64| {
        let mut other = tileset.clone();
        other.root.transform = Some(Box::new(std::array::from_fn(|i| change(i, berlin[i]))));
        fault(&other)
    };
    let refused = ("/root".to_owned(), only_read.clone());
    assert_eq!(changed(|i, x| if i < 12 { 2.0 * x } else { x }), refused);
    assert_eq!(changed(|i, x| if i < 4 { -x } else { x }), refused);
    assert_eq!(changed(|i, x| if i == 13 { f64::NAN } else { x }), refused);
    tileset.root.transform = Some(shift);
    // A child's box is in the space of its own transform, which nothing here takes back.
    tileset.root.children[0].transform = tileset.root.transform.take();
    assert_eq!(fault(&tileset), ("/root/children/0".to_owned(), only_read));
}
