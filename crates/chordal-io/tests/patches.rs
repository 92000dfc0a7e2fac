//! The three readers of patches: what they read, and what a hostile file may try.
use crate::common;
use chordal_testkit::corpus;

use chordal::Patch;
use chordal_io::{Axis, Content, FileLocation, Format, Frame, Limits, Warning, read};
use common::{count, refuse};

fn load(text: &str, format: Format) -> (Vec<Patch>, Frame, Vec<Warning>) {
    let loaded = read(text.as_bytes(), format, &Limits::default()).unwrap_or_else(|e| panic!("{e}: {text}"));
    let Content::Patches(patches, frame) = loaded.content else { panic!("no patches") };
    assert_eq!(Format::sniff(text.as_bytes()), Some(format), "{text}");
    (patches, frame, loaded.warnings)
}

/// Sixteen different points, the same in every format below.
fn point(i: usize) -> [f64; 3] {
    [0.5 * i as f64, 0.1 + i as f64, (i * i) as f64 / 3.0]
}

fn expected() -> Patch {
    Patch { control: std::array::from_fn(|row| std::array::from_fn(|column| point(4 * row + column))) }
}

fn points(separator: &str) -> String {
    let line = |i| {
        let [x, y, z] = point(i);
        format!("{x}{separator}{y}{separator}{z}\n")
    };
    (0..16).map(line).collect()
}

fn bpt() -> String {
    format!("1\n3 3\n{}", points(" "))
}

fn teaset() -> String {
    let indices: Vec<String> = (1..=16).map(|i| i.to_string()).collect();
    format!("1\n{}\n16\n{}", indices.join(","), points(","))
}

fn json_points() -> String {
    let row = |row: usize| {
        let points: Vec<String> = (0..4).map(|i| format!("{:?}", point(4 * row + i))).collect();
        format!("[{}]", points.join(", "))
    };
    format!("[{}]", (0..4).map(row).collect::<Vec<_>>().join(",\n"))
}

#[test]
fn the_three_formats_hold_the_same_patch() {
    let json = format!("{{\"patches\": [{}]}}", json_points());
    for (text, format, up) in [
        (bpt(), Format::Bpt, Some(Axis::Z)),
        (bpt().replace('\n', "\r\n"), Format::Bpt, Some(Axis::Z)),
        (teaset(), Format::Teaset, Some(Axis::Z)),
        (teaset().replace(',', " , "), Format::Teaset, Some(Axis::Z)),
        (json, Format::Json, None),
    ] {
        let (patches, frame, warnings) = load(&text, format);
        assert_eq!(patches, [expected()]);
        assert_eq!(frame, Frame { up, metres_per_unit: None, ..Frame::default() });
        assert_eq!(warnings, []);
    }
}

#[test]
fn json_by_index_and_frame_are_read() {
    let points: Vec<String> = (0..16).map(|i| format!("{:?}", point(i))).collect();
    let indices: Vec<String> = (0..16).map(|i| i.to_string()).collect();
    let text = format!(
        "{{\"up\": \"y\", \"patches\": [[{}]], \"metres_per_unit\": 1e-3, \"points\": [{}], \"by\": {{\"a\": [1, true]}}}}",
        indices.join(","),
        points.join(",")
    );
    let (patches, frame, warnings) = load(&text, Format::Json);
    assert_eq!(patches, [expected()]);
    assert_eq!(frame, Frame { up: Some(Axis::Y), metres_per_unit: Some(1e-3), ..Frame::default() });
    assert_eq!(warnings.iter().map(|w| (w.code, w.count)).collect::<Vec<_>>(), [("unknown-member", 1)]);
    assert_eq!(warnings[0].place, FileLocation::Pointer("/by".into()));
}

#[test]
fn the_teaset_of_1991_is_read_by_its_content() {
    let Some(data) = corpus::find("") else { return };
    let bytes = std::fs::read(data.join("patches/teapot")).expect("readable");
    assert_eq!(Format::sniff(&bytes), Some(Format::Teaset));
    let loaded = read(&bytes, Format::Teaset, &Limits::default()).expect("loads");
    let Content::Patches(patches, frame) = loaded.content else { panic!("no patches") };
    assert_eq!((patches.len(), frame.up), (32, Some(Axis::Z)));
    assert_eq!(loaded.warnings, []);
    assert_eq!(patches[0].control[0][0], [1.4, 0.0, 2.4]);
    assert!(Format::sniff(&std::fs::read(data.join("patches/README")).expect("readable")).is_none());
}

#[test]
fn bpt_errors_name_line_and_what_is_supported() {
    let cases = [
        (bpt().replace("3 3", "2 3"), 2, "degrees 2 3; only bicubic patches, 3 3, are supported"),
        (bpt().replace("3 3", "3 -3"), 2, "'-3' is below 0"),
        (bpt().replace("3 3", "3 3.5"), 2, "'3.5' is not a whole number"),
        (
            bpt().replacen('1', "400000000", 1),
            18,
            "the file ends before the degrees of patch 1 of 400,000,000",
        ),
        (bpt().replacen('1', "600000000", 1), 1, "600,000,000 patches are over the limit of 500,000,000"),
        (bpt().replacen('1', "99999999999999999999", 1), 1, "is over any limit"),
        (
            bpt().replace("0.5 1.1", "nan 1.1"),
            4,
            "coordinate x of point 1 of patch 0: coordinate 'nan' is not finite",
        ),
        (bpt().replace("0.5 1.1", "0.5 1e999"), 4, "coordinate y of point 1"),
        (bpt().replace("0.5 1.1", "0.5 1,1"), 4, "decimal comma"),
        (
            bpt().trim_end().rsplit_once(' ').unwrap().0.to_owned(),
            18,
            "the file ends before coordinate z of point 15",
        ),
    ];
    for (text, line, words) in cases {
        let error = refuse(text.as_bytes(), Format::Bpt);
        assert!(error.message.contains(words), "{error}");
        assert_eq!(error.place, FileLocation::Line(line), "{error}");
    }
    let (_, _, warnings) = load(&format!("{}more words\n", bpt()), Format::Bpt);
    assert_eq!(count(&warnings, "trailing-text"), 2);
}

#[test]
fn teaset_errors_name_line_value_and_limit() {
    let cases = [
        (teaset().replace(",16\n16", ",17\n16"), 2, "index 17 is out of range: there are 16 points"),
        (teaset().replace("1,2,3,", "0,2,3,"), 2, "indices start at 1"),
        (teaset().replace("1,2,3,", "-1,2,3,"), 2, "index '-1' is out of range"),
        (
            teaset().replace("1,2,3,", "99999999999999999999,2,3,"),
            2,
            "is out of range: from 1 to 4,294,967,295",
        ),
        (teaset().replace("1,2,3,", "1,2,x,"), 2, "'x' is not an index"),
        (
            teaset().replace("1,2,3,", "2,3,"),
            2,
            "patch 0 has 15 values with commas between them where 16 are needed",
        ),
        (teaset().replacen("\n16\n", "\n17\n", 1), 19, "the file ends before point 17"),
        (teaset().replacen("\n16\n", "\n-1\n", 1), 3, "'-1' is not a number of points"),
        (teaset().replace("0.5,1.1", "inf,1.1"), 5, "'inf' is not finite"),
        (teaset().replacen("1\n", "999999999999\n", 1), 1, "over the limit of 500,000,000"),
    ];
    for (text, line, words) in cases {
        let error = refuse(text.as_bytes(), Format::Teaset);
        assert!(error.message.contains(words), "{error}");
        assert_eq!(error.place, FileLocation::Line(line), "{error}");
    }
    let (_, _, warnings) = load(&format!("{}more\n\nwords\n", teaset()), Format::Teaset);
    assert_eq!(count(&warnings, "trailing-text"), 2);
}

#[test]
fn json_errors_name_their_pointer() {
    let patch = json_points();
    let cases = [
        ("[]".to_owned(), "", "an object should stand here"),
        ("{}".to_owned(), "", "no member \"patches\", \"surfaces\", \"curves\" or \"polylines\""),
        ("{\"patches\": 3}".to_owned(), "/patches", "an array should stand here"),
        (format!("{{\"patches\": [{patch}, [[]]]}}"), "/patches/1/0", "0 points where 4 are needed"),
        (format!("{{\"patches\": [{patch}, []]}}"), "/patches/1", "0 rows where 4 are needed"),
        (format!("{{\"patches\": [{patch}, [1, 2]]}}"), "/patches/1", "2 indices where 16 are needed"),
        (
            format!("{{\"patches\": [{}]}}", patch.replacen("0.1", "\"0.1\"", 1)),
            "/patches/0/0/0/1",
            "a number",
        ),
        (
            format!("{{\"patches\": [{}]}}", patch.replacen("0.1", "1e400", 1)),
            "/patches/0/0/0/1",
            "over the limit",
        ),
        (
            format!("{{\"patches\": [{}]}}", patch.replacen("0.1", "0.1, 7", 1)),
            "/patches/0/0/0",
            "4 numbers where 3",
        ),
        ("{\"patches\": [], \"patches\": []}".to_owned(), "/patches", "twice"),
        ("{\"patches\": [], \"x\": {\"a~/\": 1, \"a~\\/\": 2}}".to_owned(), "/x/a~0~1", "twice"),
        ("{\"patches\": [], \"up\": \"x\"}".to_owned(), "/up", "\"y\" or \"z\""),
        ("{\"patches\": [], \"up\": 1}".to_owned(), "/up", "\"y\" or \"z\""),
        ("{\"patches\": [], \"metres_per_unit\": 0}".to_owned(), "/metres_per_unit", "greater than 0"),
        (format!("{{\"patches\": [[{}]]}}", vec!["0"; 16].join(",")), "", "no member \"points\""),
        (
            format!("{{\"points\": [[0,0,0]], \"patches\": [[{}, 1]]}}", vec!["0"; 15].join(",")),
            "/patches/0/15",
            "index 1 is out of range: there are 1 points, from 0",
        ),
        ("{\"patches\": [[0.5]]}".to_owned(), "/patches/0/0", "0.5 is not an index"),
        ("{\"patches\": [[-1]]}".to_owned(), "/patches/0/0", "-1 is not an index"),
        (
            format!("{{\"patches\": [{patch}, [{}]]}}", vec!["0"; 16].join(",")),
            "/patches/1",
            "all by indices",
        ),
    ];
    for (text, pointer, words) in cases {
        let error = refuse(text.as_bytes(), Format::Json);
        assert!(error.message.contains(words), "{error}: {text}");
        let place =
            if pointer.is_empty() { FileLocation::File } else { FileLocation::Pointer(pointer.into()) };
        assert_eq!(error.place, place, "{error}: {text}");
    }
}

#[test]
fn json_that_is_none_is_refused_at_its_byte() {
    for (text, byte) in [
        ("{\"a\": [01]}", 7),
        ("{\"a\": [NaN]}", 7),
        ("{\"a\": [+1]}", 7),
        ("{\"a\": [1.]}", 7),
        ("{\"a\": [.5]}", 7),
        ("{\"a\": [1e]}", 7),
        ("{\"patches\": [],}", 15),
        ("{\"patches\": []", 14),
        ("{\"patches\": []} x", 16),
        ("{\"a\": tru}", 6),
        ("{\"a\u{1}\": 1}", 3),
        ("{\"a\\x\": 1}", 3),
        ("{\"\\ud800\": 1}", 2),
        ("{\"\\ud800\\u0041\": 1}", 2),
        ("{'a': 1}", 1),
        ("{\"a\" 1}", 5),
        ("{\"a\": [1 2]}", 9),
    ] {
        let error = refuse(text.as_bytes(), Format::Json);
        assert_eq!((error.code, &error.place), ("not-json", &FileLocation::Byte(byte)), "{error}: {text}");
    }
    assert_eq!(refuse(b"{\"\xff\": 1}", Format::Json).place, FileLocation::Byte(2));
    assert_eq!(refuse(b"\xff\xfe{\0}\0", Format::Json).code, "not-utf8");
}

#[test]
fn h32_json_nested_without_end_is_refused() {
    for open in ["[", "{\"a\":"] {
        let text = format!("{{\"patches\": {}", open.repeat(200_000));
        let error = refuse(text.as_bytes(), Format::Json);
        assert!(["too-deep", "wrong-type"].contains(&error.code), "{error}");
        let text = format!("{{\"x\": {}", open.repeat(200_000));
        let error = refuse(text.as_bytes(), Format::Json);
        assert!(error.message.contains("deeper than the limit of 128 levels"), "{error}");
        assert_eq!(Format::sniff(text.as_bytes()), None);
        // However deep the caller allows it, the stack holds.
        let limits = Limits { depth: usize::MAX, ..Limits::default() };
        assert_eq!(read(text.as_bytes(), Format::Json, &limits).unwrap_err().code, "too-deep");
    }
    load("{\"__proto__\": 1, \"patches\": []}", Format::Json);
}

#[test]
fn h71_patches_in_one_place_and_none_at_all_are_counted() {
    let (patches, _, warnings) = load(&format!("1\n3 3\n{}", "2 2 2\n".repeat(16)), Format::Bpt);
    assert_eq!(patches.len(), 1);
    assert_eq!(count(&warnings, "point-patches"), 1);
    let (patches, _, warnings) = load("{\"patches\": []}", Format::Json);
    assert_eq!((patches.len(), count(&warnings, "no-patches")), (0, 1));
    let wide = bpt().replace("0.5 1.1", "1.7e308 1.1").replace("1 2.1", "-1.7e308 2.1");
    assert_eq!(refuse(wide.as_bytes(), Format::Bpt).code, "extent-overflow");
}

#[test]
fn empty_files_are_refused_by_all_three() {
    for format in [Format::Bpt, Format::Teaset, Format::Json] {
        for text in ["", " ", "\n\n", "x", "{", "1", "-1\n", "1\n\n\n"] {
            refuse(text.as_bytes(), format);
        }
        refuse(b"1\n3 \0 3\n", format);
    }
}
