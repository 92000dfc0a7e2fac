//! What a hostile tileset may try, row by row of the list that the project keeps, and what must happen.
use super::build::{Folder, read, read_in, refused, tile_json, tileset_json};
use chordal_io::{Conformance, Limits, tiles};
use serde_json::{Value, json};

/// A tile with a value put beside what it must have.
fn tile_with(error: f64, key: &str, value: Value) -> Value {
    let mut tile = tile_json(error);
    tile[key] = value;
    tile
}

fn with_content(uri: &str) -> Value {
    tile_with(1.0, "content", json!({ "uri": uri }))
}

fn with_child(error: f64, child: Value) -> Value {
    tile_with(error, "children", json!([child]))
}

#[test]
fn h74_an_error_above_that_of_the_parent_is_refused() {
    let rising = tileset_json(with_child(1.0, with_child(0.5, tile_json(0.75))));
    let at = "/root/children/0/children/0/geometricError".to_owned();
    assert_eq!(refused(read(&rising)), ("error-increases", at));
    assert_eq!(
        refused(read(&tileset_json(tile_json(17.0)))),
        ("error-increases", "/root/geometricError".to_owned())
    );
    // Equal errors waste a tile and are no lie.
    assert!(read(&tileset_json(with_child(1.0, tile_json(1.0)))).is_ok());
    // Leniently it is a warning, counted.
    let lenient = Limits { conformance: Conformance::Lenient, ..Limits::default() };
    let (_, warnings) =
        tiles::read(rising.to_string().as_bytes(), &mut |_| Err(String::new()), &lenient).expect("read");
    assert_eq!(warnings.iter().map(|w| (w.code, w.count)).collect::<Vec<_>>(), [("error-increases", 1)]);
}

#[test]
fn h74_errors_that_are_none_are_refused() {
    let at = "/root/geometricError".to_owned();
    assert_eq!(refused(read(&tileset_json(tile_json(-1.0)))), ("out-of-range", at.clone()));
    let text = tileset_json(tile_json(0.0)).to_string();
    for (wrong, code) in [("1e999", "not-finite"), ("\"1\"", "wrong-type"), ("null", "wrong-type")] {
        let broken = text.replace(r#""geometricError":0.0"#, &format!(r#""geometricError":{wrong}"#));
        assert_eq!(refused(read_in(&Folder::new(), broken.as_bytes())), (code, at.clone()));
    }
    let nan = text.replace(r#""geometricError":0.0"#, r#""geometricError":NaN"#);
    assert_eq!(refused(read_in(&Folder::new(), nan.as_bytes())).0, "not-json");
}

#[test]
fn h75_paths_that_leave_the_folder_are_refused() {
    let at = "/root/content/uri".to_owned();
    for uri in [
        "../up.glb",
        "/etc/passwd",
        "a/../../up.glb",
        "%2e%2e/up.glb",
        "..%2fup.glb",
        "//host/a.glb",
        "\\\\host\\a",
    ] {
        assert_eq!(refused(read(&tileset_json(with_content(uri)))), ("outside-folder", at.clone()), "{uri}");
    }
    for uri in
        ["http://host/a.glb", "https://host/tileset.json", "file:///etc/passwd", "data:,x", "C:\\a.glb"]
    {
        assert_eq!(refused(read(&tileset_json(with_content(uri)))), ("no-network", at.clone()), "{uri}");
    }
    let several = tile_with(1.0, "contents", json!([{ "uri": "a.glb" }, { "uri": "../b.glb" }]));
    assert_eq!(refused(read(&tileset_json(several))), ("outside-folder", "/root/contents/1/uri".to_owned()));
    // Within the folder up is allowed, and nothing but tilesets is opened.
    let (tileset, _) = read(&tileset_json(with_content("a/../b%20c.glb"))).expect("read");
    assert_eq!(tileset.root.contents, ["b c.glb"]);
}

#[test]
fn h75_gzip_is_refused() {
    let gzip = b"\x1f\x8b\x08\0\0\0\0\0\0\x03";
    assert_eq!(refused(read_in(&Folder::new(), gzip)).0, "compressed");
    assert_eq!(tiles::content(gzip, &Limits::default()).expect_err("refused").code, "compressed");
    let folder = Folder::from([("a.json".to_owned(), gzip.to_vec())]);
    let error =
        read_in(&folder, tileset_json(with_content("a.json")).to_string().as_bytes()).expect_err("refused");
    assert!(error.code == "compressed" && error.message.contains("'a.json'"), "{error}");
}

fn folder(files: &[(&str, Value)]) -> Folder {
    files.iter().map(|(path, json)| ((*path).to_owned(), json.to_string().into_bytes())).collect()
}

#[test]
fn external_tilesets_are_read_below_their_own_folders() {
    let folder = folder(&[
        ("a/one.json", tileset_json_of(with_content("../b/two.json"), 0.75)),
        ("b/two.json", tileset_json_of(tile_with(0.25, "content", json!({ "uri": "x.glb" })), 0.5)),
    ]);
    let outer = tileset_json(with_child(8.0, with_content("a/one.json")));
    let error =
        read_in(&folder, outer.to_string().as_bytes()).expect_err("its root's error is above its own");
    assert_eq!(error.code, "error-increases");
    let folder = self::folder(&[
        ("a/one.json", tileset_json_of(tile_with(0.5, "content", json!({ "uri": "../b/two.json" })), 0.75)),
        ("b/two.json", tileset_json_of(tile_with(0.25, "content", json!({ "uri": "x.glb" })), 0.5)),
    ]);
    let (tileset, warnings) = read_in(&folder, outer.to_string().as_bytes()).expect("read");
    assert_eq!(warnings, []);
    let found: Vec<_> = tileset.tiles().iter().map(|(depth, t)| (*depth, t.contents.join(","))).collect();
    let expected = [(0, ""), (1, "a/one.json"), (2, "b/two.json"), (3, "b/x.glb")];
    assert_eq!(found, expected.map(|(depth, path)| (depth, path.to_owned())));
}

fn tileset_json_of(root: Value, error: f64) -> Value {
    let mut json = tileset_json(root);
    json["geometricError"] = json!(error);
    json
}

#[test]
fn h75_tilesets_that_contain_themselves_are_refused() {
    let naming =
        |uri: &str, error: f64| tileset_json_of(tile_with(error, "content", json!({ "uri": uri })), error);
    let cycle = folder(&[("a.json", naming("b.json", 1.0)), ("b.json", naming("a.json", 1.0))]);
    let error =
        read_in(&cycle, tileset_json(with_content("a.json")).to_string().as_bytes()).expect_err("refused");
    assert_eq!(error.code, "tileset-cycle");
    assert!(
        error.message.contains("'a.json' contains itself") && error.message.contains("(in 'b.json')"),
        "{error}"
    );
    // The first file, which has no name here, under its own.
    let own = naming("tileset.json", 1.0);
    let own_folder = folder(&[("tileset.json", own.clone())]);
    assert_eq!(refused(read_in(&own_folder, own.to_string().as_bytes())).0, "tileset-cycle");
    // A chain that does not end.
    let endless: Folder = (0..100)
        .map(|i| (format!("{i}.json"), naming(&format!("{}.json", i + 1), 1.0).to_string().into_bytes()))
        .collect();
    assert_eq!(refused(read_in(&endless, naming("0.json", 1.0).to_string().as_bytes())).0, "too-deep");
}

#[test]
fn h75_tilesets_that_are_named_twice_are_opened_once() {
    // Twelve files, each of which names the next one twice: 4096 ways to the last.
    let twice = |i: usize| {
        let child = tile_with(1.0, "content", json!({ "uri": format!("{}.json", i + 1) }));
        tileset_json_of(tile_with(1.0, "children", json!([child, child])), 1.0)
    };
    let mut files: Folder =
        (1..12).map(|i| (format!("{i}.json"), twice(i).to_string().into_bytes())).collect();
    files.insert("12.json".to_owned(), tileset_json_of(tile_json(0.0), 0.0).to_string().into_bytes());
    let mut n_opened = 0;
    let mut open = |path: &str| {
        n_opened += 1;
        files.get(path).cloned().ok_or_else(|| "no such file".to_owned())
    };
    let (_, warnings) =
        tiles::read(twice(0).to_string().as_bytes(), &mut open, &Limits::default()).expect("read");
    assert_eq!(n_opened, 12);
    assert_eq!(warnings.iter().map(|w| (w.code, w.count)).collect::<Vec<_>>(), [("tileset-named-again", 12)]);
}

#[test]
fn h75_files_that_are_missing_are_named() {
    let error = read(&tileset_json(with_content("a.json"))).expect_err("refused");
    assert_eq!(error.code, "file-missing");
    assert_eq!(error.to_string(), "/root/content/uri: 'a.json' cannot be read: no such file");
}

#[test]
fn what_is_no_tileset_is_refused_with_its_place() {
    let wrong = |at: &str, value: Value| {
        let mut json = tileset_json(with_child(1.0, tile_json(0.0)));
        let (parent, key) = at.rsplit_once('/').expect("a pointer");
        let map = json.pointer_mut(parent).and_then(Value::as_object_mut).expect("an object");
        if value.is_null() {
            map.shift_remove(key);
        } else {
            map.insert(key.to_owned(), value);
        }
        refused(read(&json))
    };
    let place = |code, at: &str| (code, at.to_owned());
    assert_eq!(wrong("/asset", Value::Null), place("missing", "file"));
    assert_eq!(wrong("/asset/version", json!("2.0")), place("unsupported", "/asset/version"));
    assert_eq!(wrong("/root", Value::Null), place("missing", "file"));
    assert_eq!(wrong("/geometricError", Value::Null), place("missing", "file"));
    assert_eq!(wrong("/root/geometricError", Value::Null), place("missing", "/root"));
    let bare = json!([{ "geometricError": 0.0 }]);
    assert_eq!(wrong("/root/children", bare), place("missing", "/root/children/0"));
    assert_eq!(wrong("/root/boundingVolume", json!({})), place("unsupported", "/root/boundingVolume"));
    assert_eq!(
        wrong("/root/boundingVolume/box", json!([0, 1])),
        place("wrong-length", "/root/boundingVolume/box")
    );
    assert_eq!(wrong("/root/refine", json!("SOME")), place("bad-value", "/root/refine"));
    assert_eq!(wrong("/root/transform", json!(vec![0.0; 16])), place("bad-value", "/root/transform"));
    assert_eq!(wrong("/root/content", json!({})), place("missing", "/root/content"));
    assert_eq!(wrong("/extensionsRequired", json!(["X"])), place("unsupported", "/extensionsRequired/0"));
    assert_eq!(wrong("/root/children", json!([1])), place("wrong-type", "/root/children/0"));
}

#[test]
fn what_is_not_kept_is_counted() {
    let mut json = tileset_json(tile_with(0.0, "metadata", json!({ "class": "x" })));
    json["schema"] = json!({ "id": "x" });
    json["root"].as_object_mut().expect("an object").shift_remove("refine");
    let (_, warnings) = read(&json).expect("read");
    let codes: Vec<_> = warnings.iter().map(|w| (w.code, w.count)).collect();
    assert_eq!(codes, [("tiles-metadata-ignored", 2), ("refine-missing", 1)]);
    // Extras that would take much more memory than the file.
    json["root"]["extras"] = json!(vec![0; 200_000]);
    let (tileset, warnings) = read(&json).expect("read");
    assert_eq!(tileset.root.extras, None);
    assert_eq!(warnings[1].code, "extras-dropped");
}

#[test]
fn nesting_is_limited() {
    let deep = |n: usize| (0..n).fold(tile_json(1.0), |child, _| with_child(1.0, child));
    assert!(read(&tileset_json(deep(60))).is_ok());
    assert_eq!(refused(read(&tileset_json(deep(70)))).0, "too-deep");
    let endless = format!("{}{}", r#"{"root":"#, r#"{"children":["#.repeat(100_000));
    assert_eq!(refused(read_in(&Folder::new(), endless.as_bytes())).0, "too-deep");
}

#[test]
fn bytes_that_were_cut_or_changed_never_panic() {
    let text =
        tileset_json(with_child(1.0, tile_with(0.5, "content", json!({ "uri": "a.glb" })))).to_string();
    let bytes = text.as_bytes();
    for n in 0..bytes.len() {
        assert!(read_in(&Folder::new(), &bytes[..n]).is_err(), "{n} bytes");
        for byte in [b'{', b'}', b'[', b'"', b',', b'0', b'-', 0xff] {
            let mut changed = bytes.to_vec();
            changed[n] = byte;
            // Whatever comes of it, it comes.
            let _ = read_in(&Folder::new(), &changed);
        }
    }
}
