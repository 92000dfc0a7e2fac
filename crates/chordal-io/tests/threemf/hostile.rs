//! What a hostile 3MF may try: rows 48 to 53 of the list that the project keeps.
use super::build::{
    TO_MODEL, TYPES, Zipped, body, model, model_with, package, package_with, relationships, tetrahedron,
    zip_of,
};
use crate::common::{count, load_scene, refuse};
use chordal::explicit::Semantic;
use chordal_io::{Format, Limits, ReadError, read};
use chordal_testkit::Random;

#[track_caller]
fn fail(bytes: &[u8]) -> ReadError {
    refuse(bytes, Format::ThreeMf)
}

/// A package whose model is this entry.
fn with_model(entry: Zipped) -> Vec<u8> {
    let types = Zipped::stored("[Content_Types].xml", TYPES.as_bytes());
    zip_of(&[types, Zipped::stored("_rels/.rels", relationships(&[TO_MODEL]).as_bytes()), entry])
}

const NAME: &str = "3D/3dmodel.model";

#[test]
fn h48_bombs_end_at_the_limit_while_they_unpack() {
    // 64 MiB of spaces in 64 kB, a thousand to one.
    let bomb = Zipped::deflated(NAME, &vec![b' '; 64 << 20]);
    assert!(bomb.packed.len() < 100_000);
    let error = fail(&with_model(bomb.clone()));
    assert_eq!(error.code, "too-dense");
    assert!(error.message.contains("200 times"), "{error}");
    // The directory says less than there is: the limit counts what comes out.
    let error = fail(&with_model(Zipped { n_unpacked: 1000, ..bomb.clone() }));
    assert_eq!(error.code, "too-dense");
    // The directory says more than any limit: refused before anything is unpacked.
    let error = fail(&with_model(Zipped { n_unpacked: u64::MAX, is_64: true, ..bomb.clone() }));
    assert_eq!(error.code, "too-large");
    assert!(error.message.contains("536,870,912"), "{error}");
    // A small part may be as dense as it likes.
    let mut small = model(&body(1, ""), "<item objectid=\"1\"/>").into_bytes();
    small.resize(8 << 20, b' ');
    let (scene, _) = load_scene(&with_model(Zipped::deflated(NAME, &small)), Format::ThreeMf);
    assert_eq!(scene.parts[0].mesh.faces().len(), 4);
    // A limit of the caller counts for what is unpacked, too.
    let limits = Limits { bytes: 1 << 20, ..Limits::default() };
    let error = read(&with_model(Zipped::deflated(NAME, &small)), Format::ThreeMf, &limits).unwrap_err();
    assert_eq!(error.code, "too-large");
}

#[test]
fn h48_several_parts_share_one_limit() {
    let pad = " ".repeat(12 << 20);
    let part = |i: usize| (format!("3D/{i}.model"), model(&body(1, ""), "") + &pad);
    let parts: Vec<(String, String)> = (0..4).map(part).collect();
    let others: Vec<(&str, &str)> = parts.iter().map(|(name, text)| (&**name, &**text)).collect();
    let items: String = (0..4).map(|i| format!("<item objectid=\"1\" p:path=\"/3D/{i}.model\"/>")).collect();
    let bytes = package_with(&model("", &items), &others);
    assert_eq!(load_scene(&bytes, Format::ThreeMf).0.parts.len(), 4);
    let limits = Limits { bytes: 40 << 20, ..Limits::default() };
    let error = read(&bytes, Format::ThreeMf, &limits).unwrap_err();
    assert_eq!(error.code, "too-large");
    assert!(error.message.contains("whole package"), "{error}");
}

#[test]
fn h48_sizes_and_checksums_that_lie_are_refused() {
    let text = model(&body(1, ""), "<item objectid=\"1\"/>");
    let honest = Zipped::deflated(NAME, text.as_bytes());
    load_scene(&with_model(honest.clone()), Format::ThreeMf);
    load_scene(&with_model(Zipped { is_64: true, ..honest.clone() }), Format::ThreeMf);
    let n = honest.n_unpacked;
    for (entry, code) in [
        (Zipped { n_unpacked: n + 1, ..honest.clone() }, "size-mismatch"),
        (Zipped { n_unpacked: n - 1, is_64: true, ..honest.clone() }, "size-mismatch"),
        (Zipped { crc: 1, ..honest.clone() }, "bad-checksum"),
        (Zipped { flags: 1, ..honest.clone() }, "encrypted"),
        (Zipped { method: 12, ..honest.clone() }, "unsupported-packing"),
        (Zipped { packed: vec![0xFF; 40], ..honest.clone() }, "bad-deflate"),
    ] {
        assert_eq!(fail(&with_model(entry)).code, code);
    }
}

#[test]
fn h48_a_hundred_thousand_entries_and_nested_archives_are_not_followed() {
    let many: Vec<Zipped> = (0..10_001).map(|i| Zipped::stored(&format!("{i}"), b"")).collect();
    assert_eq!(fail(&zip_of(&many)).code, "too-many-entries");
    // 42.zip: an archive of archives is an entry like any other, and nothing opens it.
    let inner = zip_of(&[Zipped::deflated("a", &vec![0; 1 << 20])]);
    let bytes = zip_of(&[
        Zipped::stored("[Content_Types].xml", TYPES.as_bytes()),
        Zipped::stored("_rels/.rels", relationships(&[TO_MODEL]).as_bytes()),
        Zipped::deflated(NAME, model(&body(1, ""), "<item objectid=\"1\"/>").as_bytes()),
        Zipped::stored("lib 0.zip", &inner),
    ]);
    assert_eq!(count(&load_scene(&bytes, Format::ThreeMf).1, "parts-ignored"), 1);
    // A directory that declares 2^64 rows.
    let mut bytes = package(&model("", ""));
    let end = bytes.len() - 22;
    bytes[end + 8..end + 12].fill(0xFF);
    assert_eq!(fail(&bytes).code, "truncated");
}

#[test]
fn h49_names_that_lead_out_or_come_twice_are_refused() {
    let text = model(&body(1, ""), "<item objectid=\"1\"/>");
    let with = |other: Zipped| {
        zip_of(&[
            Zipped::stored("[Content_Types].xml", TYPES.as_bytes()),
            Zipped::stored("_rels/.rels", relationships(&[TO_MODEL]).as_bytes()),
            Zipped::deflated(NAME, text.as_bytes()),
            other,
        ])
    };
    load_scene(&with(Zipped::stored("Metadata/A..B.txt", b"")), Format::ThreeMf);
    for name in [
        "../../x",
        "/etc/passwd",
        "a\\b",
        "C:\\x",
        "C:x",
        "3D/../x",
        "3D/./x",
        "3D//x",
        "",
        "a\0b",
        "..",
        "3D/..",
    ] {
        let error = fail(&with(Zipped::stored(name, b"")));
        assert_eq!(error.code, "unsafe-name", "{name}: {error}");
    }
    let link = Zipped { mode: 0o120_777, ..Zipped::stored("3D/link", b"/etc/passwd") };
    let error = fail(&with(link));
    assert!(error.code == "unsafe-name" && error.message.contains("symbolic link"), "{error}");
    for name in [NAME, "3d/3DMODEL.model"] {
        assert_eq!(fail(&with(Zipped::stored(name, b""))).code, "duplicate-name");
    }
    // The header beside the data has another name than the directory.
    let mut bytes = with(Zipped::stored("x", b""));
    let places = bytes.windows(NAME.len()).enumerate().filter(|(_, w)| *w == NAME.as_bytes());
    // The first one stands in the relationships.
    let at = places.map(|(at, _)| at).nth(1).unwrap();
    bytes[at] = b'4';
    assert_eq!(fail(&bytes).code, "truncated");
}

#[test]
fn h50_document_types_and_floods_of_attributes_are_refused() {
    let plain = model(&body(1, ""), "<item objectid=\"1\"/>");
    for declared in [
        "<!DOCTYPE model [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;&a;\">]>",
        "<!DOCTYPE model SYSTEM \"file:///etc/passwd\">",
        "<!DOCTYPE model>",
    ] {
        let error = fail(&package(&plain.replacen("<model", &format!("{declared}<model"), 1)));
        assert_eq!(error.code, "dtd-not-allowed");
        assert!(error.message.contains("DTD not allowed"), "{error}");
        let rels = format!("{declared}{}", relationships(&[TO_MODEL]));
        let bytes =
            zip_of(&[Zipped::stored("_rels/.rels", rels.as_bytes()), Zipped::stored(NAME, plain.as_bytes())]);
        assert_eq!(fail(&bytes).code, "dtd-not-allowed");
    }
    assert_eq!(fail(&package(&model(&body(1, "name=\"&b;\""), ""))).code, "unknown-entity");
    let many: String = (0..100_000).map(|i| format!(" a{i}=\"\"")).collect();
    assert_eq!(fail(&package(&model(&body(1, &many), ""))).code, "too-many-attributes");
    let many: String = (0..100_000).map(|i| format!(" xmlns:a{i}=\"urn:{i}\"")).collect();
    assert_eq!(fail(&package(&model_with(&many, "", ""))).code, "too-many-attributes");
    let deep = format!("{}{}", "<a>".repeat(200_000), "</a>".repeat(200_000));
    assert_eq!(fail(&package(&model(&deep, ""))).code, "too-deep");
}

/// An object of two components of the object before it.
fn doubled(id: u32) -> String {
    let component = format!("<component objectid=\"{}\"/>", id - 1);
    format!("<object id=\"{id}\"><components>{component}{component}</components></object>\n")
}

#[test]
fn h51_objects_that_hold_themselves_are_refused() {
    let holds = |id: u32, other: u32| {
        format!("<object id=\"{id}\"><components><component objectid=\"{other}\"/></components></object>")
    };
    for resources in
        [holds(1, 1), holds(1, 2) + &holds(2, 1), body(9, "") + &holds(1, 2) + &holds(2, 3) + &holds(3, 2)]
    {
        // Whether the build shows it or not.
        for items in ["", "<item objectid=\"1\"/>"] {
            assert_eq!(fail(&package(&model(&resources, items))).code, "component-cycle");
        }
    }
    let through = "<object id=\"1\"><components><component objectid=\"1\" p:path=\"/3D/b.model\"/></components></object>";
    let back = through.replace("b.model", "3dmodel.model");
    let bytes = package_with(&model(through, "<item objectid=\"1\"/>"), &[("3D/b.model", &model(&back, ""))]);
    assert_eq!(fail(&bytes).code, "component-cycle");
}

#[test]
fn h51_objects_of_objects_are_counted_before_they_are_written_out() {
    let upto = |n: u32| body(1, "") + &(2..=n).map(doubled).collect::<String>();
    // 2^40 nodes in 5 kB.
    let error = fail(&package(&model(&upto(41), "<item objectid=\"41\"/>")));
    assert_eq!(error.code, "too-many-copies");
    assert!(error.message.contains("limit of 200,0"), "{error}");
    // Nobody shows it: it costs nothing.
    load_scene(&package(&model(&upto(100), "<item objectid=\"1\"/>")), Format::ThreeMf);
    let (scene, _) = load_scene(&package(&model(&upto(11), "<item objectid=\"11\"/>")), Format::ThreeMf);
    assert_eq!(scene.nodes.len(), 2047);
    // A long name of an object that is shown often is memory, too.
    let name = "x".repeat(1 << 20);
    let holder = |id: u32, n: usize, of: u32, attribute: &str| {
        let components = format!("<component objectid=\"{of}\"/>").repeat(n);
        format!("<object id=\"{id}\" {attribute}><components>{components}</components></object>")
    };
    let resources = body(1, "") + &holder(2, 2, 1, &format!("name=\"{name}\"")) + &holder(3, 10_000, 2, "");
    assert_eq!(fail(&package(&model(&resources, "<item objectid=\"3\"/>"))).code, "too-many-copies");
    // A long chain is deep, and fine.
    let chain: String = (2..=20_000).map(|id| holder(id, 1, id - 1, "")).collect();
    let bytes = package(&model(&(body(1, "") + &chain), "<item objectid=\"20000\"/>"));
    assert_eq!(load_scene(&bytes, Format::ThreeMf).0.nodes.len(), 19_999);
}

#[test]
fn h51_what_is_named_and_not_there_is_refused() {
    let component = "<object id=\"2\"><components><component objectid=\"77\"/></components></object>";
    for (resources, items) in [("", "<item objectid=\"77\"/>"), (component, "")] {
        let error = fail(&package(&model(resources, items)));
        assert_eq!(error.code, "missing-object");
        assert!(error.message.contains("object 77 is not in 3D/3dmodel.model"), "{error}");
    }
    let colors = "<m:colorgroup id=\"5\"><m:color color=\"#336699\"/></m:colorgroup>";
    // What a triangle looks like is no reason not to read its shape: it has the default of its object, where there is one.
    let blue = [51.0, 102.0, 153.0, 255.0];
    for (attributes, triangle, missing, second) in [
        ("", "pid=\"6\" p1=\"0\"", 1, None),
        ("pid=\"6\" pindex=\"0\"", "", 4, None),
        ("", "pid=\"5\" p1=\"1\"", 1, None),
        ("", "pid=\"5\" p1=\"0\" p2=\"0\" p3=\"1\"", 1, None),
        ("pid=\"5\" pindex=\"1\"", "", 4, None),
        ("pid=\"5\" pindex=\"0\"", "pid=\"6\" p1=\"0\"", 1, Some(blue)),
        ("pid=\"5\" pindex=\"0\"", "p1=\"7\"", 1, Some(blue)),
    ] {
        let object =
            format!("{colors}<object id=\"2\" {attributes}>{}</object>", tetrahedron(["", triangle, "", ""]));
        let (scene, warnings) =
            load_scene(&package(&model(&object, "<item objectid=\"2\"/>")), Format::ThreeMf);
        assert_eq!(count(&warnings, "property-missing"), missing, "{attributes} {triangle}: {warnings:?}");
        let mesh = &scene.parts[0].mesh;
        let colors = mesh.attribute(&Semantic::Color(0));
        let found = colors.map(|colors| colors.row(3).iter().map(|x| x * 255.0).collect::<Vec<_>>());
        assert_eq!((mesh.faces().len(), found.as_deref()), (4, second.as_ref().map(|row| &row[..])));
    }
}

#[test]
fn h52_links_out_of_the_package_are_refused() {
    for path in
        ["http://x/a.model", "file:///etc/passwd", "/../a.model", "../a.model", "\\\\x\\a", "/3D/../../a"]
    {
        let bytes = package(&model("", &format!("<item objectid=\"1\" p:path=\"{path}\"/>")));
        assert_eq!(fail(&bytes).code, "external-link", "{path}");
    }
    let plain = model(&body(1, ""), "<item objectid=\"1\"/>");
    let with = |relationship: &str| {
        let rels = relationships(&[relationship]);
        zip_of(&[Zipped::stored("_rels/.rels", rels.as_bytes()), Zipped::stored(NAME, plain.as_bytes())])
    };
    let (_, warnings) = load_scene(&with(TO_MODEL), Format::ThreeMf);
    assert_eq!(count(&warnings, "no-content-types"), 1);
    for to in ["http://x/a.model", "../x", "//x/y"] {
        let bytes = with(&TO_MODEL.replace("/3D/3dmodel.model", to));
        assert_eq!(fail(&bytes).code, "external-link", "{to}");
    }
    let error = fail(&with(&format!("{TO_MODEL} TargetMode=\"External\"")));
    assert_eq!(error.code, "external-link");
    let external = relationships(&["Type=\"x\" Target=\"http://x/\" TargetMode=\"External\""]);
    let bytes = package_with(&plain, &[("3D/_rels/3dmodel.model.rels", &external)]);
    assert_eq!(fail(&bytes).code, "external-link");
}

#[test]
fn h53_settings_and_scripts_are_counted_and_never_looked_at() {
    let plain = model(&body(1, ""), "<item objectid=\"1\"/>");
    let bomb = "9".repeat(32 << 20);
    let others = [
        ("Metadata/model_settings.config", "<config><plate/></config>"),
        ("Metadata/plate_1.gcode", "G1 X0"),
        ("Metadata/post_process.py", "import os"),
        ("Metadata/huge.json", &*bomb),
    ];
    let (scene, warnings) = load_scene(&package_with(&plain, &others), Format::ThreeMf);
    assert_eq!(scene.parts.len(), 1);
    let warning = warnings.iter().find(|w| w.code == "parts-ignored").expect("counted");
    assert_eq!(warning.count, 4);
    assert!(warning.message.contains("'Metadata/model_settings.config' first"), "{warning}");
}

/// The checksums of a package keep flipped bits from the model, so the model's text is spoiled before it is packed.
#[test]
fn spoiled_models_end_well() {
    let seed = 47;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    let colored = tetrahedron(["pid=\"5\" p1=\"0\" p2=\"1\"", "", "pid=\"6\" p1=\"1\"", ""]);
    let text = model(
        &format!(
            "<m:colorgroup id=\"5\"><m:color color=\"#336699\"/><m:color color=\"#33669901\"/></m:colorgroup>\
             <basematerials id=\"6\"><base name=\"a\" displaycolor=\"#000000\"/><base name=\"b\" displaycolor=\"#ffffff\"/></basematerials>\
             <object id=\"7\" name=\"n\" pid=\"6\" pindex=\"0\">{colored}</object>\
             <object id=\"8\"><components><component objectid=\"7\" transform=\"1 0 0 0 1 0 0 0 1 4 5 6\"/></components></object>"
        ),
        "<item objectid=\"8\"/><item p:path=\"/3D/3dmodel.model\" objectid=\"7\"/>",
    );
    load_scene(&package(&text), Format::ThreeMf);
    let numbers = ["-1", "1e400", "nan", "4294967295", "99999999999999999999", "", "0", "5", "7", "8"];
    let mut n_read = 0;
    for round in 0..4000 {
        let mut spoiled = text.clone().into_bytes();
        match round % 3 {
            0 => {
                let at = random.below(spoiled.len());
                spoiled[at] ^= 1 << random.below(8);
            }
            1 => {
                let at = random.below(spoiled.len());
                let end = spoiled.len().min(at + random.below(60));
                spoiled.drain(at..end);
            }
            _ => {
                let values: Vec<usize> = text.match_indices("=\"").map(|(at, _)| at + 2).collect();
                let at = values[random.below(values.len())];
                let end = at + text[at..].find('"').unwrap();
                spoiled.splice(at..end, numbers[random.below(numbers.len())].bytes());
            }
        }
        let entry = Zipped::stored(NAME, &spoiled);
        match read(&with_model(entry), Format::ThreeMf, &Limits::default()) {
            Ok(_) => n_read += 1,
            Err(error) => assert!(!error.code.is_empty() && !error.message.is_empty()),
        }
    }
    assert!(n_read > 100, "{n_read}");
}
