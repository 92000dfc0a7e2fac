//! What a hostile OBJ may try, row by row of the list that the project keeps, and what must happen.
use crate::common;

use chordal::explicit::Semantic;
use chordal_io::{Conformance, Content, FileLocation, Format, Limits, read};
use common::{count, load, load_scene, refuse};

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[track_caller]
fn refuse_at(text: &str, line: u64, words: &str) {
    let error = refuse(text.as_bytes(), Format::Obj);
    assert!(error.message.contains(words), "{error}");
    assert_eq!(error.place, FileLocation::Line(line), "{error}");
}

#[test]
fn h17_index_zero_is_refused_with_the_rule() {
    refuse_at(&format!("{SQUARE}f 1 2 3\nf 0 1 2\n"), 6, "indices start at 1");
    refuse_at(
        &format!("{SQUARE}vt 0 0\nf 1/0 2/1 3/1\n"),
        6,
        "index 0 of a texture coordinate: indices start at 1",
    );
    refuse_at(&format!("{SQUARE}vn 0 0 1\nf 1//0 2//1 3//1\n"), 6, "index 0 of a normal");
}

#[test]
fn h18_indices_out_of_range_are_refused_at_their_line() {
    refuse_at(&format!("{SQUARE}f 1 2 5\n"), 5, "index '5' is out of range: the file has 4 vertices");
    refuse_at(
        &format!("v 0 0 0\nv 1 0 0\nf -1 -2 -3\n{SQUARE}"),
        3,
        "index '-3' is out of range: 2 vertices stand before",
    );
    refuse_at(&format!("{SQUARE}vn 0 0 1\nf 1//1 2//2 3//1\n"), 6, "the file has 1 normals");
    // A later line may still hold the vertex that an index from the start names.
    let (mesh, _) = load(format!("f 1 2 3\n{SQUARE}").as_bytes(), Format::Obj);
    assert_eq!(mesh.faces(), [[0, 1, 2]]);
    let (mesh, _) = load(format!("{SQUARE}f -4 -3 -2\nv 5 5 5\nf -1 -2 -3\n").as_bytes(), Format::Obj);
    assert_eq!(mesh.faces(), [[0, 1, 2], [4, 3, 2]]);
}

#[test]
fn corners_that_name_lists_the_file_does_not_have_are_without() {
    let strict = Limits { conformance: Conformance::Strict, ..Limits::default() };
    let plain = load(format!("{SQUARE}f 1 2 3\nf 1 3 4\n").as_bytes(), Format::Obj).0;
    for (corner, normals, texcoords) in
        [("{}//{}", 6, 0), ("{}/{}", 0, 6), ("{}/{}/{}", 6, 6), ("{}//-{}", 6, 0), ("{}//9{}", 6, 0)]
    {
        let face = |corners: [u32; 3]| {
            let corners = corners.map(|i| corner.replace("{}", &i.to_string()));
            format!("f {}\n", corners.join(" "))
        };
        let text = format!("{SQUARE}{}{}", face([1, 2, 3]), face([1, 3, 4]));
        let (mesh, warnings) = load(text.as_bytes(), Format::Obj);
        assert_eq!((mesh.faces(), mesh.positions()), (plain.faces(), plain.positions()), "{corner}");
        assert!(mesh.attributes().is_empty(), "{corner}");
        assert_eq!(count(&warnings, "normals-absent"), normals, "{corner}");
        assert_eq!(count(&warnings, "texcoords-absent"), texcoords, "{corner}");
        assert!(warnings.iter().all(|warning| warning.place == FileLocation::Line(5)), "{warnings:?}");
        let error = read(text.as_bytes(), Format::Obj, &strict).expect_err("strict");
        assert_eq!((error.code, &error.place), ("index-out-of-range", &FileLocation::Line(5)), "{error}");
    }
    // The other list is there and keeps its rules.
    let (mesh, _) = load(format!("{SQUARE}vn 0 0 1\nf 1/7/1 2/7/1 3/7/1\n").as_bytes(), Format::Obj);
    assert!(mesh.attributes().iter().map(|a| &a.semantic).eq([&Semantic::Normal]));
    refuse_at(&format!("{SQUARE}vn 0 0 1\nf 1/7/2 2/7/1 3/7/1\n"), 6, "the file has 1 normals");
    // A list that stands after the face is there.
    refuse_at(&format!("{SQUARE}f 1//2 2//1 3//1\nvn 0 0 1\n"), 5, "the file has 1 normals");
    // What is no index is none in an empty list either.
    refuse_at(&format!("{SQUARE}f 1//0 2//1 3//1\n"), 5, "index 0 of a normal");
    refuse_at(&format!("{SQUARE}f 1//x 2//1 3//1\n"), 5, "not an index of a normal");
    refuse_at(&format!("{SQUARE}f 1//99999999999999999999 2//1 3//1\n"), 5, "the file has 0 normals");
}

#[test]
fn h19_indices_beyond_32_and_64_bits_do_not_wrap() {
    for index in [
        "4294967297",
        "4294967296",
        "9223372036854775808",
        "18446744073709551617",
        "-9223372036854775808",
        "-4294967297",
    ] {
        for corner in [index.to_owned(), format!("1/{index}"), format!("1//{index}")] {
            let text = format!("{SQUARE}vt 0 0\nvn 0 0 1\nf {corner} 2 3\n");
            let error = refuse(text.as_bytes(), Format::Obj);
            assert_eq!((error.code, &error.place), ("index-out-of-range", &FileLocation::Line(7)), "{error}");
            assert!(error.message.contains(index), "{error}");
        }
    }
    for corner in ["1.0", "x", "1/2/3/4", "1e0", "/1", "//1", "--1", "0x1"] {
        let text = format!("{SQUARE}vt 0 0\nf {corner} 2 3\n");
        assert_eq!(refuse(text.as_bytes(), Format::Obj).code, "not-an-index", "{corner}");
    }
}

#[test]
fn h20_coordinates_that_are_no_finite_numbers_are_refused_with_a_hint() {
    for bad in ["nan", "-nan", "inf", "+Inf", "-infinity", "1e400", "-1e309", "1#IND", "-1.#QNAN", "1.#INF"] {
        let text = format!("v 0 0 0\nv 1 {bad} 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
        refuse_at(&text, 2, bad);
        let limits = Limits { drop_nonfinite: true, ..Limits::default() };
        let loaded = read(text.as_bytes(), Format::Obj, &limits).expect(bad);
        let Content::Scene(scene) = loaded.content else { panic!("a scene") };
        assert_eq!(scene.parts[0].mesh.faces(), [[0, 1, 2]]);
        assert_eq!(scene.parts[0].mesh.positions()[1], [1.0, 1.0, 0.0]);
        assert_eq!(count(&loaded.warnings, "vertices-dropped"), 1);
        assert_eq!(count(&loaded.warnings, "faces-dropped"), 1);
    }
    refuse_at("v 0,5 1,0 2\n", 1, "'0,5' is not a number; a decimal comma must be a point");
    refuse_at("v 0 0 zero\n", 1, "'zero' is not a number");
    refuse_at("v 0 0\n", 1, "v has 2 numbers; 3 are needed");
    refuse_at("v 0 0 0 0 0\n", 1, "v has 5 numbers");
    refuse_at("v 0 0 0 0 0 0 0 0\n", 1, "v has more than 7 numbers");
    refuse_at(&format!("v {} 0 0\n", "9".repeat(1000)), 1, "is not finite, or over the limit");
}

#[test]
fn h21_a_polygon_of_twenty_thousand_corners_on_one_line_is_cut_whole() {
    let n = 20_000;
    let mut text = String::new();
    for i in 0..n {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(n));
        let radius = 1.0 + 0.5 * f64::from(i % 2);
        text += &format!("v {} {} 0\n", radius * cos, radius * sin);
    }
    text += "f";
    (1..=n).for_each(|i| text += &format!(" {i}"));
    let (mesh, warnings) = load(text.as_bytes(), Format::Obj);
    assert_eq!(mesh.faces().len(), 19_998);
    assert_eq!(warnings.iter().map(|w| w.code).collect::<Vec<_>>(), ["polygons-cut"]);

    let line = format!("{SQUARE}f{}\n", " 1 2 3 4".repeat(150_000));
    assert!(line.len() > 1_200_000);
    let (mesh, warnings) = load(line.as_bytes(), Format::Obj);
    assert_eq!(mesh.faces().len(), 600_000 - 2);
    assert_eq!(count(&warnings, "polygon-overlaps"), 1, "too long to look at, and said so");
    let line = format!("{SQUARE}f{}\n", " 1 2 3 4".repeat(15_000));
    let (mesh, warnings) = load(line.as_bytes(), Format::Obj);
    assert_eq!(mesh.faces().len(), 60_000 - 2);
    assert_eq!(count(&warnings, "polygon-overlaps"), 0, "going round many times adds up");
}

#[test]
fn h22_awkward_polygons_have_their_area_or_a_warning() {
    let area = |text: &str| {
        let (mesh, warnings) = load(text.as_bytes(), Format::Obj);
        let twice = |f: usize| {
            let [a, b, c] = mesh.corners(f);
            ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
        };
        (0.5 * (0..mesh.faces().len()).map(twice).sum::<f64>(), count(&warnings, "polygon-overlaps"))
    };
    let concave = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 1 2 3 4 5\n";
    assert_eq!(area(concave), (10.0, 0));
    let collinear = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 2 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\n";
    assert_eq!(area(collinear), (4.0, 0));
    let repeated = format!("{SQUARE}f 1 2 2 3 3 3 4\n");
    assert_eq!(area(&repeated), (1.0, 0));
    let crossing = "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 2 0\nv -1 1 0\nf 1 2 3 4 5\n";
    assert_eq!(area(crossing).1, 1);
}

#[test]
fn h23_encodings_and_line_ends_are_read_or_named() {
    for text in [
        format!("\u{feff}{SQUARE}f 1 2 3\n"),
        format!("{SQUARE}f 1 2 3\n").replace('\n', "\r\n"),
        format!("{SQUARE}f 1 2 3\n").replace('\n', "\r"),
        format!("{}\r\nf 1 2 3", SQUARE.replacen('\n', "\r", 1)),
        format!("{SQUARE}f 1 \\\n2 \\\r\n3"),
        format!("# C:\\folder\\\n{SQUARE}\tf\t1  2 3   \n\n \n"),
    ] {
        let (mesh, warnings) = load(text.as_bytes(), Format::Obj);
        assert_eq!(mesh.faces(), [[0, 1, 2]], "{text:?}");
        assert_eq!(mesh.positions().len(), 4, "{text:?}");
        assert_eq!(count(&warnings, "unknown-statement"), 0, "{text:?}");
    }
    for big_endian in [false, true] {
        let units = std::iter::once('\u{feff}').chain(SQUARE.chars()).map(|c| c as u16);
        let bytes: Vec<u8> =
            units.flat_map(|u| if big_endian { u.to_be_bytes() } else { u.to_le_bytes() }).collect();
        let error = refuse(&bytes, Format::Obj);
        assert_eq!(error.code, "not-utf8");
        assert!(error.message.contains("not UTF-8") && error.message.contains("save it as UTF-8"), "{error}");
    }
    refuse_at("v 0 0 0\nv 1 0 0\nv 0 \0 1\n", 3, "NUL");
    let (scene, warnings) = load_scene(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl gr\xfcn\nf 1 2 3\n", Format::Obj);
    assert_eq!(count(&warnings, "name-not-utf8"), 1);
    assert_eq!(scene.groups["material"][1], "gr\u{fffd}n");
}

#[test]
fn h24_material_libraries_are_not_opened_without_an_opener() {
    for path in [
        "../../../etc/passwd",
        "/etc/passwd",
        "\\\\host\\share\\x.mtl",
        "C:\\x.mtl",
        "a/../../x",
        "file:///x",
    ] {
        let (_, warnings) = load(format!("mtllib {path}\n{SQUARE}f 1 2 3\n").as_bytes(), Format::Obj);
        assert_eq!(count(&warnings, "mtllib-outside"), 1, "{path}");
    }
    let many = format!("{}{SQUARE}f 1 2 3\n", "mtllib x.mtl\n".repeat(10_000));
    let (mesh, warnings) = load(many.as_bytes(), Format::Obj);
    assert_eq!(count(&warnings, "mtllib-skipped"), 10_000);
    assert_eq!(mesh.faces().len(), 1);
}

#[test]
fn h25_geometry_and_names_of_materials_are_kept_without_their_library() {
    let text = format!(
        "{SQUARE}usemtl red paint\nf 1 2 3\nusemtl blue\ns 7\nf 1 3 4\nusemtl red paint\ns off\ng a b\no x\nf 1 2 4\n"
    );
    let (scene, warnings) = load_scene(text.as_bytes(), Format::Obj);
    assert_eq!(warnings, []);
    assert_eq!(scene.groups["material"], ["", "red paint", "blue"]);
    let values =
        |kind: &str| scene.parts[0].mesh.attribute(&Semantic::Group(kind.into())).expect(kind).values.clone();
    assert_eq!(values("material"), [1.0, 2.0, 1.0]);
    assert_eq!(values("s"), [0.0, 7.0, 0.0]);
    assert_eq!((values("g"), values("o")), (vec![0.0, 0.0, 1.0], vec![0.0, 0.0, 1.0]));
    assert_eq!(scene.groups["g"], ["", "a b"]);
}

#[test]
fn what_is_not_read_is_counted() {
    let text = format!(
        "{SQUARE}l 1 2\nl 2 3\np 1\nt line 2/1/0 0 1 2.5\ncstype bezier\ncurv 0 1 1 2\nlod 3\ncall x.sh\ncsh rm -rf\nfoo 1\n\
         v 9 9 9 0.5\nvt 0 0 1\nf 1 2 3\nf 1 2\ns smooth\n"
    );
    let (mesh, warnings) = load(text.as_bytes(), Format::Obj);
    assert_eq!(mesh.faces(), [[0, 1, 2]]);
    for (code, n) in [
        ("lines-skipped", 2),
        ("points-skipped", 1),
        ("tags-skipped", 1),
        ("free-form-skipped", 2),
        ("display-skipped", 1),
        ("scripts-skipped", 2),
        ("unknown-statement", 1),
        ("weights-skipped", 1),
        ("texcoord-w-skipped", 1),
        ("texcoords-unused", 1),
        ("short-faces", 1),
        ("smoothing-group", 1),
        ("isolated-vertices", 2),
    ] {
        assert_eq!(count(&warnings, code), n, "{code}: {warnings:#?}");
    }
    assert_eq!(warnings.len(), 13);
    let first = warnings.iter().find(|w| w.code == "lines-skipped").unwrap();
    assert_eq!(first.to_string(), "lines (l) were skipped (2x, first at line 5)");
}

#[test]
fn corners_split_vertices_and_position_id_ties_them() {
    let text = format!(
        "{SQUARE}vt 0 0\nvt 1 1\nvn 0 0 1\nvn 0 0 2\nvn 0 nan 0\nf 1/1/1 2/1/1 3/1/1\nf 1/2/1 3/1/2 4//1\nf 1//3 2 4\n"
    );
    let (mesh, warnings) = load(text.as_bytes(), Format::Obj);
    assert_eq!(mesh.faces(), [[0, 1, 2], [4, 5, 3], [6, 7, 8]]);
    assert_eq!(mesh.position_id(), Some(&[0, 1, 2, 3, 0, 2, 0, 1, 3][..]));
    assert_eq!(mesh.positions()[5], mesh.positions()[2]);
    let normals = mesh.attribute(&Semantic::Normal).unwrap();
    assert_eq!(normals.row(5), [0.0, 0.0, 1.0], "scaled to length 1");
    assert_eq!(normals.row(6), [0.0, 0.0, 0.0]);
    assert_eq!(mesh.attribute(&Semantic::TexCoord(0)).unwrap().row(4), [1.0, 1.0]);
    for (code, n) in
        [("normals-scaled", 1), ("normals-missing", 2), ("texcoords-missing", 4), ("attribute-not-finite", 1)]
    {
        assert_eq!(count(&warnings, code), n, "{code}: {warnings:#?}");
    }
}

#[test]
fn colours_after_positions_are_read() {
    let (mesh, warnings) = load(b"v 0 0 0\nv 1 0 0 1 0.5 0\nv 0 1 0 0 0 1 0.25\nf 1 2 3\n", Format::Obj);
    let color = mesh.attribute(&Semantic::Color(0)).unwrap();
    assert_eq!(color.width, 4);
    assert_eq!(color.values, [1.0, 1.0, 1.0, 1.0, 1.0, 0.5, 0.0, 1.0, 0.0, 0.0, 1.0, 0.25]);
    assert_eq!(count(&warnings, "colors-missing"), 1);
}

#[test]
fn h28_empty_and_foreign_files_are_refused() {
    for text in ["", "v", "\n \t\r\n", "x", "# only a comment\n", "hello world\nthis is a letter\n", "f\n"] {
        refuse(text.as_bytes(), Format::Obj);
    }
    let error = refuse(b"ply\nformat ascii 1.0\nend_header\n", Format::Obj);
    assert_eq!(error.code, "not-wavefront");
    assert!(error.message.ends_with("; the content looks like ply"), "{error}");
    let limits = Limits { bytes: 10, ..Limits::default() };
    let error = read(SQUARE.as_bytes(), Format::Obj, &limits).unwrap_err();
    assert_eq!(error.to_string(), "32 bytes are over the limit of 10");
    let limits = Limits { rows: 3, ..Limits::default() };
    let error = read(SQUARE.as_bytes(), Format::Obj, &limits).unwrap_err();
    assert_eq!(error.to_string(), "4 vertices are over the limit of 3");
}

#[test]
fn h29_object_code_and_medical_polygons_are_not_wavefront() {
    let coff = |machine: u16| {
        let mut bytes = machine.to_le_bytes().to_vec();
        bytes.extend([3, 0, 0x12, 0x34, 0x56, 0x5f, 0, 2, 0, 0, 9, 0, 0, 0, 0, 0, 0, 0]);
        bytes.extend(b".text\0\0\0f 1 2 3\n");
        bytes
    };
    let mut files = [0x014c, 0x8664, 0xaa64, 0x01c4].map(coff).to_vec();
    files.push(b"\x7fELF\x02\x01\x01\0\0\0\0\0\0\0\0\0".to_vec());
    files.push(b"\xcf\xfa\xed\xfe\x07\0\0\x01".to_vec());
    files.push(b"\x80\x0a\0\x08test.asm\0\x96".to_vec());
    files.push(
        b"P 0.3 0.3 0.4 10 1 3\n 0 0 0\n 1 0 0\n 0 1 0\n\n 0 0 1\n 0 0 1\n 0 0 1\n\n 1\n 0 1 1 1 1\n"
            .to_vec(),
    );
    files.push(b"p\x9a\x99\x99\x3e\0\0\0\0\x01\0\0\0".to_vec());
    for bytes in files {
        let error = refuse(&bytes, Format::Obj);
        assert_eq!(error.code, "not-wavefront", "{error}");
        assert!(error.message.starts_with("not Wavefront OBJ: this is "), "{error}");
        assert_ne!(Format::sniff(&bytes), Some(Format::Obj));
    }
}

#[test]
fn h54_extreme_coordinates_are_kept_to_the_last_bit() {
    let text = "v 1e30 1e-30 4e-324\nv 5000000.123456789 -0.0 0.1\nv 500000000000000000000 1 1\nf 1 2 3\n";
    let (mesh, _) = load(text.as_bytes(), Format::Obj);
    assert_eq!(mesh.positions()[0], [1e30, 1e-30, 4e-324]);
    assert_eq!(mesh.positions()[1][0], 5000000.123456789);
    assert!(mesh.positions()[1][1].is_sign_negative());
    let error = refuse(b"v 1e308 0 0\nv -1e308 0 0\nv 0 1 0\nf 1 2 3\n", Format::Obj);
    assert_eq!(error.code, "extent-overflow");
    assert!(error.message.contains("from -1e308 to 1e308"), "{error}");
}

#[test]
fn h56_duplicates_are_counted_and_kept() {
    let text = format!("{SQUARE}v 0 0 0\nv 0 0 -0\nf 1 2 3\nf 2 3 1\nf 3 2 1\nf 5 2 3\nf 1 1 2\n");
    let (mesh, warnings) = load(text.as_bytes(), Format::Obj);
    assert_eq!((mesh.positions().len(), mesh.faces().len()), (6, 5));
    for (code, n) in [
        ("duplicate-vertices", 1),
        ("duplicate-faces", 1),
        ("opposite-faces", 1),
        ("isolated-vertices", 2),
        ("zero-area-faces", 1),
    ] {
        assert_eq!(count(&warnings, code), n, "{code}: {warnings:#?}");
    }
}
