//! What a hostile PLY may try, row by row of the list that the project keeps, and what must happen.
use crate::common;

use chordal::explicit::Semantic;
use chordal_io::{Content, FileLocation, Format, Limits, read};
use common::{count, load, refuse};

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";
const LIST: &str = "property list uchar int vertex_indices\n";

fn text(elements: &str, body: &str) -> Vec<u8> {
    format!("ply\nformat ascii 1.0\n{elements}end_header\n{body}").into_bytes()
}

/// A triangle with whatever header lines and body follow it.
fn triangle(more: &str, body: &str) -> Vec<u8> {
    text(&format!("element vertex 3\n{XYZ}{more}"), &format!("0 0 0\n1 0 0\n0 1 0\n{body}"))
}

fn faces(body: &str) -> Vec<u8> {
    let n = body.lines().count();
    triangle(&format!("element face {n}\n{LIST}"), body)
}

/// A binary file of three vertices and faces as given, in either byte order.
fn binary(order: &str, list: &str, n_faces: u64, faces: &[u8]) -> Vec<u8> {
    let header = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex 3\n{XYZ}element face {n_faces}\n{list}end_header\n"
    );
    let mut bytes = header.into_bytes();
    for x in [0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        bytes.extend(if order == "big" { x.to_be_bytes() } else { x.to_le_bytes() });
    }
    bytes.extend(faces);
    bytes
}

#[test]
fn h08_a_count_of_a_million_millions_without_a_body_is_refused() {
    let limits = Limits { rows: u64::MAX, ..Limits::default() };
    for element in ["vertex 1000000000000\n", "face 1000000000000\n", "other 1000000000000\n"] {
        let properties = if element.starts_with("face") { LIST } else { XYZ };
        for format in ["ascii", "binary_little_endian"] {
            let bytes = format!("ply\nformat {format} 1.0\nelement {element}{properties}end_header\n");
            let error = read(bytes.as_bytes(), Format::Ply, &limits).unwrap_err();
            let known = ["truncated", "too-many-rows"];
            assert!(known.contains(&error.code), "{error}");
            let error = refuse(bytes.as_bytes(), Format::Ply);
            assert_eq!(error.code, "too-many-rows");
            assert!(
                error.message.contains("1,000,000,000,000 rows are over the limit of 500,000,000"),
                "{error}"
            );
        }
    }
    let bytes = text(&format!("element vertex 400000000\n{XYZ}"), "0 0 0\n");
    let error = refuse(&bytes, Format::Ply);
    assert!(
        error.message.contains("has 400,000,000 rows of at least 6 bytes, but only 6 bytes follow"),
        "{error}"
    );
}

#[test]
fn h09_counts_that_are_no_number_are_refused_at_their_line() {
    for count in ["18446744073709551616", "-1", "1e3", "", "0x10", "3.0"] {
        let error = refuse(&text(&format!("element vertex {count}\n{XYZ}"), ""), Format::Ply);
        assert_eq!((error.code, error.place), ("not-a-count", FileLocation::Line(3)), "{count}");
    }
}

#[test]
fn h10_lists_longer_than_the_file_or_shorter_than_nothing_are_refused() {
    let list = "property list uint uchar vertex_indices\n";
    let error = refuse(&binary("little", list, 1, &u32::MAX.to_le_bytes()), Format::Ply);
    assert_eq!(error.code, "list-length");
    assert!(error.message.starts_with("row 0 of 'face': a list of 4,294,967,295 values"), "{error}");
    assert!(matches!(error.place, FileLocation::Byte(_)));

    let list = "property list char int vertex_indices\n";
    let error = refuse(&binary("little", list, 1, &[0xff, 0, 0, 0, 0]), Format::Ply);
    assert!(error.message.contains("a list of length -1"), "{error}");
    let error = refuse(&triangle(&format!("element face 1\n{list}"), "-1 0 1 2\n"), Format::Ply);
    assert_eq!(error.place, FileLocation::Line(13), "{error}");
    let error = refuse(&faces("200 0 1 2\n"), Format::Ply);
    assert_eq!(error.code, "list-length", "{error}");
    assert_eq!(refuse(&faces("256 0 1 2\n"), Format::Ply).code, "value-out-of-range");
}

#[test]
fn h11_indices_out_of_range_name_row_index_and_limit() {
    for (index, shown) in [("3", "index 3"), ("-1", "index -1"), ("2147483647", "index 2147483647")] {
        let error = refuse(&faces(&format!("3 0 1 2\n3 0 1 {index}\n")), Format::Ply);
        assert_eq!(error.code, "index-out-of-range");
        assert!(error.message.starts_with("row 1 of 'face': "), "{error}");
        assert!(error.message.contains(shown) && error.message.contains("there are 3 vertices"), "{error}");
        assert_eq!(error.place, FileLocation::Line(14));
    }
    // Faces may stand before the vertices that they name.
    let header = format!("element face 1\n{LIST}element vertex 3\n{XYZ}");
    let (mesh, _) = load(&text(&header, "3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n"), Format::Ply);
    assert_eq!(mesh.faces(), [[0, 1, 2]]);
    refuse(&text(&header, "3 0 1 3\n0 0 0\n1 0 0\n0 1 0\n"), Format::Ply);
}

#[test]
fn h12_elements_and_properties_declared_twice_are_refused_at_their_line() {
    let error = refuse(&text(&format!("element vertex 1\n{XYZ}element vertex 1\n"), "0 0 0\n"), Format::Ply);
    assert_eq!((error.code, error.place), ("duplicate-element", FileLocation::Line(7)));
    let error =
        refuse(&text(&format!("element vertex 1\n{XYZ}property float y\n"), "0 0 0 0\n"), Format::Ply);
    assert_eq!((error.code, error.place), ("duplicate-property", FileLocation::Line(7)));
    let error = refuse(&text("property float x\n", ""), Format::Ply);
    assert_eq!((error.code, error.place), ("no-element", FileLocation::Line(3)));
    let error = refuse(b"ply\nformat ascii 1.0\nformat ascii 1.0\nend_header\n", Format::Ply);
    assert_eq!(error.place, FileLocation::Line(3));
}

#[test]
fn h13_headers_that_never_end_are_refused() {
    let error = refuse(b"ply\nformat ascii 1.0\ncomment and so on\n", Format::Ply);
    assert_eq!((error.code, error.place), ("truncated", FileLocation::Byte(39)));

    let mut bytes = b"ply\ncomment ".to_vec();
    bytes.resize(100 << 20, b'x');
    let error = refuse(&bytes, Format::Ply);
    assert_eq!((error.code, &error.place), ("line-too-long", &FileLocation::Line(2)));
    assert!(error.message.contains("over the limit of 65536"), "{error}");

    let many: String = (0..5000).map(|i| format!("property float p{i}\n")).collect();
    let error = refuse(&text(&format!("element vertex 1\n{many}"), ""), Format::Ply);
    assert_eq!((error.code, error.place), ("too-many-properties", FileLocation::Line(4 + 4096)));
    let many: String = (0..300).map(|i| format!("element e{i} 0\n")).collect();
    assert_eq!(refuse(&text(&many, ""), Format::Ply).code, "too-many-elements");
}

#[test]
fn h14_strips_become_faces_and_are_counted() {
    let header = |rows: u64| {
        format!("element vertex 5\n{XYZ}element tristrips {rows}\nproperty list int int vertex_indices\n")
    };
    let body = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n";
    let (mesh, warnings) = load(&text(&header(1), &format!("{body}9 0 1 2 3 -1 2 3 4 -1\n")), Format::Ply);
    assert_eq!(mesh.faces(), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
    assert_eq!(count(&warnings, "strips-cut"), 3);

    // A strip that goes on through triangles without area keeps its sense.
    let (mesh, warnings) = load(&text(&header(1), &format!("{body}8 0 1 2 2 2 3 2 4\n")), Format::Ply);
    assert_eq!(mesh.faces(), [[0, 1, 2], [2, 3, 4]]);
    assert_eq!(count(&warnings, "strip-stitches"), 4);

    let error = refuse(&text(&header(1), &format!("{body}4 0 1 2 5\n")), Format::Ply);
    assert_eq!(error.code, "index-out-of-range");
    let error = refuse(&text(&header(1), &format!("{body}4 0 1 2 -2\n")), Format::Ply);
    assert!(error.message.contains("index -2"), "{error}");
}

#[test]
fn h15_line_ends_leading_newlines_and_big_endian_load() {
    let little = [3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0];
    let big = [3, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2];
    let plain = binary("little", LIST, 1, &little);
    let split = plain.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let (header, body) = plain.split_at(split);
    let with = |header: String| [header.as_bytes(), body].concat();
    let header = String::from_utf8(header.to_vec()).unwrap();
    for bytes in [
        plain.clone(),
        binary("big", LIST, 1, &big),
        with(header.replace('\n', "\r\n")),
        with(header.replace('\n', "\r")),
        with(format!("\n\r\n {header}")),
        with(header.replace("ply", "ply ").replace(" 1.0", "\t 1.0\t")),
    ] {
        let (mesh, warnings) = load(&bytes, Format::Ply);
        assert_eq!(mesh.faces(), [[0, 1, 2]]);
        assert_eq!(mesh.positions()[2], [0.0, 1.0, 0.0]);
        assert_eq!(warnings, []);
        assert_eq!(Format::sniff(&bytes), Some(Format::Ply));
    }
    // After a header of lone CRs, an LF is the first byte of the body.
    let mut bytes = header.replace('\n', "\r").into_bytes();
    bytes.extend(f32::from_le_bytes([b'\n', 0, 0, 0]).to_le_bytes());
    bytes.extend(&body[4..]);
    let (mesh, _) = load(&bytes, Format::Ply);
    assert_eq!(mesh.positions()[0][0], f64::from(f32::from_bits(10)));
}

#[test]
fn h16_unknown_elements_and_types_are_skipped_where_their_size_is_known() {
    let unknown = "property int64 id\nproperty uint128 key\n";
    let header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\n{XYZ}{unknown}element blob 2\n\
         property list uchar int64 data\nelement face 1\n{LIST}property uchar flag\nend_header\n"
    );
    let mut bytes = header.into_bytes();
    for x in [[0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
        x.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
        bytes.extend([7; 24]);
    }
    bytes.extend([1, 1, 2, 3, 4, 5, 6, 7, 8]);
    bytes.push(0);
    bytes.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 9]);
    let (mesh, warnings) = load(&bytes, Format::Ply);
    assert_eq!(mesh.faces(), [[0, 1, 2]]);
    assert_eq!(mesh.positions()[1], [1.0, 0.0, 0.0]);
    let codes: Vec<_> = warnings.iter().map(|w| (w.code, w.count)).collect();
    assert_eq!(codes, [("vertex-property-skipped", 2), ("element-skipped", 2), ("face-property-skipped", 1)]);

    let error = refuse(&text("element vertex 1\nproperty string name\n", ""), Format::Ply);
    assert_eq!((error.code, error.place), ("type-unknown", FileLocation::Line(4)));
}

#[test]
fn values_of_all_types_and_streams_of_all_names_are_read() {
    let header = "element vertex 1\nproperty char x\nproperty uint16 y\nproperty double z\nproperty short nx\n\
                  property float32 ny\nproperty int nz\nproperty uchar red\nproperty uchar green\nproperty uint8 blue\n\
                  property uchar alpha\nproperty float s\nproperty float t\nproperty float quality\n";
    let (mesh, _) = load(&text(header, "-128 65535 1e-300 0 -1 0 255 51 0 102 0.25 2 7.5\n"), Format::Ply);
    assert_eq!(mesh.positions(), [[-128.0, 65535.0, 1e-300]]);
    let values = |semantic| mesh.attribute(&semantic).expect("read").values.clone();
    assert_eq!(values(Semantic::Normal), [0.0, -1.0, 0.0]);
    assert_eq!(values(Semantic::Color(0)), [1.0, 0.2, 0.0, 0.4]);
    assert_eq!(values(Semantic::TexCoord(0)), [0.25, 2.0]);
    assert_eq!(values(Semantic::Custom("quality".into())), [7.5]);
    for (value, code) in [("128", "value-out-of-range"), ("1.0", "not-a-number"), ("", "row-too-short")] {
        let body = format!("{value} 0 0 0 0 0 0 0 0 0 0 0 0\n");
        assert_eq!(refuse(&text(header, &body), Format::Ply).code, code, "{value}");
    }
    let error = refuse(&text(header, &"0 ".repeat(14)), Format::Ply);
    assert_eq!(error.code, "row-too-long");
}

#[test]
fn h20_positions_that_are_not_finite_are_dropped_only_when_asked() {
    let bytes = text(
        &format!("element vertex 4\n{XYZ}element face 2\n{LIST}"),
        "0 0 0\nnan 0 0\n0 1 0\n1 1 0\n3 0 1 2\n3 0 2 3\n",
    );
    let error = refuse(&bytes, Format::Ply);
    assert_eq!((error.code, error.place.clone()), ("not-finite", FileLocation::Line(11)));
    assert!(error.message.contains("row 1 of 'vertex'"), "{error}");
    let limits = Limits { drop_nonfinite: true, ..Limits::default() };
    let loaded = read(&bytes, Format::Ply, &limits).expect("loads");
    let Content::Scene(scene) = loaded.content else { panic!("a scene") };
    assert_eq!(scene.parts[0].mesh.faces(), [[0, 1, 2]]);
    assert_eq!(scene.parts[0].mesh.positions().len(), 3);
    assert_eq!(count(&loaded.warnings, "faces-dropped"), 1);
}

#[test]
fn h28_empty_and_foreign_files_are_refused() {
    for bytes in [&b""[..], b"\n", b"p", b"ply", b"plyx\n", b"solid s\nendsolid\n", b"v 0 0 0\n", b"\0\0\0\0"]
    {
        refuse(bytes, Format::Ply);
    }
    let error = refuse(b"solid s\nendsolid s\n", Format::Ply);
    assert!(error.message.ends_with("; the content looks like stl"), "{error}");
    assert_eq!(refuse(b"ply\nformat ascii 2.0\nend_header\n", Format::Ply).code, "version-unsupported");
    assert_eq!(refuse(b"ply\nformat morse 1.0\nend_header\n", Format::Ply).code, "format-unsupported");
    assert_eq!(refuse(b"ply\nend_header\n", Format::Ply).code, "no-format");
}

#[test]
fn h54_extreme_coordinates_are_kept_and_an_infinite_extent_is_refused() {
    let file = |x: &str, y: &str| {
        let header = format!("element vertex 3\n{}element face 1\n{LIST}", XYZ.replace("float", "double"));
        text(&header, &format!("{x} 0 0\n{y} 1e-30 0\n0 1 -0.0\n3 0 1 2\n"))
    };
    let (mesh, _) = load(&file("1e30", "4e-324"), Format::Ply);
    assert_eq!(mesh.positions()[0][0], 1e30);
    assert_eq!(mesh.positions()[1], [4e-324, 1e-30, 0.0]);
    assert!(mesh.positions()[2][2].is_sign_negative(), "the sign of zero is kept");
    assert_eq!(refuse(&file("1.7e308", "-1.7e308"), Format::Ply).code, "extent-overflow");
}

#[test]
fn h55_surfaces_without_area_are_counted_and_have_no_nan() {
    let header = format!("element vertex 4\n{XYZ}element face 3\n{LIST}");
    for body in ["1 1 1\n1 1 1\n1 1 1\n1 1 1\n", "0 0 0\n1 0 0\n2 0 0\n3 0 0\n"] {
        let (mesh, warnings) =
            load(&text(&header, &format!("{body}3 0 1 2\n4 0 1 2 3\n3 1 1 1\n")), Format::Ply);
        assert_eq!(mesh.faces().len(), 4);
        assert_eq!(count(&warnings, "zero-area-faces"), 4);
        assert!(chordal::explicit::vertex_normals(&mesh).iter().flatten().all(|x| x.is_finite()));
    }
    let (_, warnings) =
        load(&text(&header, "0 0 0\n1e12 0 0\n0 1 0\n5 5 5\n3 0 1 2\n3 0 1 2\n3 2 1 0\n"), Format::Ply);
    let codes: Vec<_> = warnings.iter().map(|w| (w.code, w.count)).collect();
    assert_eq!(
        codes,
        [("isolated-vertices", 1), ("duplicate-faces", 1), ("opposite-faces", 1)],
        "needles are faces"
    );
}
