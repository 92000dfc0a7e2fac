//! OFF: every variant of the keyword, and what comes back of what is written.
use crate::common;

use chordal::Mesh;
use chordal::explicit::{Attribute, Cage, Domain, Semantic};
use chordal_io::{
    Content, FileLocation, Format, Frame, Limits, Polygons, Scene, losses, losses_of_polygons, off, read,
    write,
};
use chordal_testkit::corpus;
use common::{count, load, load_scene, refuse};
use proptest::prelude::*;

/// The text of a triangle with this keyword, counts and rows.
fn triangle(keyword: &str, rows: [&str; 3]) -> Vec<u8> {
    format!("{keyword}\n3 1 0\n{}\n3 0 1 2\n", rows.join("\n")).into_bytes()
}

const CORNERS: [[f64; 3]; 3] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
const ROWS: [&str; 3] = ["0 0 0", "1 0 0", "0 1 0"];

fn values(mesh: &Mesh, semantic: &Semantic) -> Vec<f64> {
    mesh.attribute(semantic).expect("read").values.clone()
}

fn code(bytes: &[u8]) -> &'static str {
    refuse(bytes, Format::Off).code
}

/// A binary file: the keyword line, whole numbers, floats and whole numbers again.
fn binary(keyword: &str, head: &[i32], floats: &[f32], faces: &[i32]) -> Vec<u8> {
    let mut bytes = format!("{keyword} BINARY\n").into_bytes();
    head.iter().for_each(|n| bytes.extend(n.to_be_bytes()));
    floats.iter().for_each(|x| bytes.extend(x.to_be_bytes()));
    faces.iter().for_each(|n| bytes.extend(n.to_be_bytes()));
    bytes
}

const XYZ: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

#[test]
fn a_plain_file_is_read_however_its_header_lies() {
    let body = format!("{}\n3 0 1 2\n", ROWS.join("\n"));
    for header in [
        "OFF\n3 1 0\n",
        "OFF 3 1 0\n",
        "OFF 3 1\n",
        "OFF\n3 1\n",
        "OFF\n3\n1\n0\n",
        "OFF # c\n# d\n\n 3 1 0 # e\n\n# f\n",
        "# g\n \nOFF\r\n3 1 0\r\n",
        "\u{feff}OFF\n3 1 0\n",
    ] {
        let bytes = format!("{header}{body}").into_bytes();
        let (mesh, warnings) = load(&bytes, Format::Off);
        assert_eq!(
            (mesh.positions(), mesh.faces(), &warnings[..]),
            (&CORNERS[..], &[[0, 1, 2]][..], &[][..])
        );
        assert_eq!(Format::sniff(&bytes), Some(Format::Off), "{header}");
        let (same, _) = load(String::from_utf8(bytes).unwrap().replace('\n', "\r").as_bytes(), Format::Off);
        assert_eq!(same, mesh, "{header}");
    }
    for (header, code) in [("OFF3 1 0\n", "keyword-joined"), ("3 1 0\n", "keyword-missing")] {
        let bytes = format!("{header}{body}").into_bytes();
        let (mesh, warnings) = load(&bytes, Format::Off);
        assert_eq!((mesh.faces(), count(&warnings, code)), (&[[0, 1, 2]][..], 1));
    }
    // What starts with a number alone could be many formats.
    assert_ne!(Format::sniff(format!("3 1 0\n{body}").as_bytes()), Some(Format::Off));
}

#[test]
fn h27_letters_of_the_keyword_are_read_as_geomview_orders_their_data() {
    let all = ["0 0 0 4 0 0 1 1 51 102 0.5 7", "2 0 0 2 0 0 1 255 0 0 1 0", "0 3 0 3 0 0 1 0 0 0 0 1e9"];
    let (mesh, warnings) = load(&triangle("STCN4OFF", all), Format::Off);
    assert_eq!(mesh.positions(), CORNERS);
    assert_eq!(values(&mesh, &Semantic::Normal), [0.0, 0.0, 1.0].repeat(3));
    assert_eq!(values(&mesh, &Semantic::TexCoord(0)), [0.5, 7.0, 1.0, 0.0, 0.0, 1e9]);
    // Beside bytes, zeros and ones are bytes.
    let byte = |x: f64| x / 255.0;
    assert_eq!(values(&mesh, &Semantic::Color(0)), [byte(1.0), 0.2, 0.4, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(warnings, []);

    let (mesh, _) = load(
        &triangle("CSTOFF", ["0 0 0 0 0 1 1 2 3", "1 0 0 0 0 0 1 4 5", "0 1 0 1 1 1 1 6 7"]),
        Format::Off,
    );
    assert_eq!(values(&mesh, &Semantic::TexCoord(0)), [2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    let color = mesh.attribute(&Semantic::Color(0)).unwrap();
    assert_eq!(
        (color.width, color.row(0)),
        (4, &[0.0, 0.0, 1.0, 1.0][..]),
        "zeros and ones alone are fractions"
    );
    let (mesh, _) = load(&triangle("COFF", ["0 0 0 1 0 0", "1 0 0 0.5 0 0", "0 1 0 0 0 1"]), Format::Off);
    assert_eq!(values(&mesh, &Semantic::Color(0)), [1.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 1.0]);

    let (mesh, _) = load(&triangle("nOFF 3", ROWS), Format::Off);
    assert_eq!(mesh.positions(), CORNERS);
    let (mesh, warnings) = load(&triangle("4nOFF\n2", ["0 0 9", "1 0 1", "0 4 4"]), Format::Off);
    assert_eq!((mesh.positions(), count(&warnings, "padded-positions")), (&CORNERS[..], 1));
}

#[test]
fn h27_binary_files_are_read_in_geomviews_byte_order() {
    let plain = binary("OFF", &[3, 1, 0], &XYZ, &[3, 0, 1, 2, 0]);
    let (mesh, warnings) = load(&plain, Format::Off);
    assert_eq!((mesh.positions(), mesh.faces(), &warnings[..]), (&CORNERS[..], &[[0, 1, 2]][..], &[][..]));
    assert_eq!(Format::sniff(&plain), Some(Format::Off));
    let split = plain.iter().position(|b| *b == b'\n').unwrap();
    let (same, _) = load(&[&plain[..split], b"\r", &plain[split..]].concat(), Format::Off);
    assert_eq!(same, mesh);

    let one = |x: f32| x.to_bits() as i32;
    let faces = [4, 0, 1, 2, 0, 3, one(0.5), one(1.0), one(0.0), 3, 0, 2, 1, 1, one(7.0)];
    let vertex = |x: f32, y: f32| [x, y, 2.0, 2.0, 0.0, 0.0, 1.0, 0.25, 0.5, 1.0, 1.0, x, y];
    let floats = [vertex(0.0, 0.0), vertex(1.0, 0.0), vertex(0.0, 1.0)].concat();
    let (mesh, warnings) = load(&binary("STCN4OFF", &[3, 2, 0], &floats, &faces), Format::Off);
    assert_eq!(mesh.positions(), [[0.0, 0.0, 1.0], [0.5, 0.0, 1.0], [0.0, 0.5, 1.0]]);
    assert_eq!(values(&mesh, &Semantic::Color(0)), [0.25, 0.5, 1.0, 1.0].repeat(3));
    let of_faces = mesh.attributes().iter().find(|a| a.domain == Domain::Face).unwrap();
    assert_eq!(of_faces.values, [0.5, 1.0, 0.0, 0.5, 1.0, 0.0, 1.0, 1.0, 1.0]);
    assert_eq!((count(&warnings, "color-map-skipped"), count(&warnings, "colors-missing")), (1, 1));

    let mut cut = plain.clone();
    while cut.pop().is_some_and(|_| cut.len() > split) {
        let error = refuse(&cut, Format::Off);
        assert!(matches!(error.code, "truncated" | "list-length"), "{error}");
        assert!(matches!(error.place, FileLocation::Byte(_)), "{error}");
    }
    let (_, warnings) = load(&[&plain[..], b"ab"].concat(), Format::Off);
    assert_eq!(count(&warnings, "trailing-data"), 2);
    for (head, faces, expected) in [
        ([-1, 1, 0], [3, 0, 1, 2, 0], "not-a-count"),
        ([3, -1, 0], [3, 0, 1, 2, 0], "not-a-count"),
        ([i32::MAX, 1, 0], [3, 0, 1, 2, 0], "too-many-rows"),
        ([400_000_000, 1, 0], [3, 0, 1, 2, 0], "truncated"),
        ([3, 400_000_000, 0], [3, 0, 1, 2, 0], "truncated"),
        ([3, 1, 0], [3, 0, 1, 3, 0], "index-out-of-range"),
        ([3, 1, 0], [3, 0, 1, -1, 0], "index-out-of-range"),
        ([3, 1, 0], [-3, 0, 1, 2, 0], "list-length"),
        ([3, 1, 0], [i32::MAX, 0, 1, 2, 0], "list-length"),
        ([3, 1, 0], [3, 0, 1, 2, 2], "wrong-width"),
        ([3, 1, 0], [3, 0, 1, 2, -1], "wrong-width"),
        ([3, 1, 0], [3, 0, 1, 2, 4], "truncated"),
    ] {
        assert_eq!(code(&binary("OFF", &head, &XYZ, &faces)), expected, "{head:?} {faces:?}");
    }
    assert_eq!(code(&binary("nOFF", &[4, 3, 1, 0], &XYZ, &[])), "format-unsupported");
    assert_eq!(code(b"OFF BINARY 3 1 0\n"), "row-too-long");
    let mut bad = XYZ;
    bad[4] = f32::NAN;
    let error = refuse(&binary("OFF", &[3, 1, 0], &bad, &[3, 0, 1, 2, 0]), Format::Off);
    assert_eq!((error.code, error.place), ("not-finite", FileLocation::Byte(11 + 12 + 24)));
}

#[test]
fn colours_of_faces_are_those_of_their_triangles() {
    let square = "OFF\n4 3 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    let read = |faces: &str| load(format!("{square}{faces}").as_bytes(), Format::Off);
    let (mesh, warnings) = read("4 0 1 2 3 255 0 51\n3 0 1 2 # none\n3 0 2 3 0 0 255 # blue\n");
    let color = &mesh.attributes()[0];
    assert_eq!((&color.semantic, color.domain, color.width), (&Semantic::Color(0), Domain::Face, 3));
    let [red, blue, white] = [[1.0, 0.0, 0.2], [0.0, 0.0, 1.0], [1.0; 3]];
    assert_eq!(color.values, [red, red, white, blue].concat());
    assert_eq!((count(&warnings, "colors-missing"), count(&warnings, "polygons-cut")), (1, 1));

    // Faces before the first colour, an alpha here and there, and fractions beside zeros and ones.
    let (mesh, warnings) = read("3 0 1 2\n3 0 1 3 1 0 0\n3 0 2 3 0 0 0.5 0.25\n");
    assert_eq!(mesh.attributes()[0].values, [1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.5, 0.25]);
    assert_eq!(count(&warnings, "colors-missing"), 1);

    let (mesh, warnings) = read("3 0 1 2 5\n3 0 1 3\n3 0 2 3 7\n");
    assert_eq!((mesh.attributes().len(), count(&warnings, "color-map-skipped")), (0, 2));
    let (_, warnings) = read("3 0 1 2 300 0 0\n3 0 1 3 -0.5 0 0\n3 0 2 3 0.5 0 0\n");
    assert_eq!(count(&warnings, "colors-out-of-range"), 2);
    for color in ["1 2", "1 2 3 4 5", "red green blue", "0 0 0,5"] {
        let faces = format!("{square}3 0 1 2 {color}\n3 0 1 2\n3 0 1 2\n");
        let error = refuse(faces.as_bytes(), Format::Off);
        assert!(matches!(error.code, "wrong-width" | "not-a-number"), "{error}");
        assert_eq!(error.place, FileLocation::Line(7));
    }
}

#[test]
fn short_faces_are_counted_and_trailing_lines_too() {
    let bytes = "OFF\n3 4 0\n0 0 0\n1 0 0\n0 1 0\n0\n1 2\n2 0 1\n3 0 1 2\nmore # 1\n# 2\n3\n";
    let (mesh, warnings) = load(bytes.as_bytes(), Format::Off);
    assert_eq!(mesh.faces(), [[0, 1, 2]]);
    assert_eq!((count(&warnings, "short-faces"), count(&warnings, "trailing-data")), (3, 2));
    let (mesh, warnings) = load(b"OFF\n0 0 0\n", Format::Off);
    assert_eq!((mesh.positions().len(), count(&warnings, "no-vertices")), (0, 1));
}

fn vertex(semantic: Semantic, width: usize, values: Vec<f64>) -> Attribute {
    Attribute { semantic, domain: Domain::Vertex, width, values }
}

fn written(mesh: &Mesh) -> String {
    let mut file = Vec::new();
    let scene = Scene::from_mesh("", mesh.clone(), Frame::default());
    write(&scene, None, Format::Off, &mut file).expect("written");
    assert_eq!(Format::sniff(&file), Some(Format::Off));
    String::from_utf8(file).expect("text")
}

#[test]
fn the_keyword_says_what_is_written() {
    let mut mesh = Mesh::new(CORNERS.to_vec(), vec![[0, 1, 2]]).unwrap();
    assert_eq!(written(&mesh), "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    mesh = mesh.with_attribute(Attribute::vertex_normals(&[[0.0, 0.0, 1.0]; 3])).unwrap();
    assert!(written(&mesh).starts_with("NOFF\n3 1 0\n0 0 0 0 0 1\n"));
    let bytes = [1.0, 0.2, 0.0, 0.4].repeat(3);
    let plain = Mesh::new(CORNERS.to_vec(), vec![[0, 1, 2]]).unwrap();
    let colored = plain.clone().with_attribute(vertex(Semantic::Color(0), 4, bytes.clone())).unwrap();
    assert!(written(&colored).starts_with("COFF\n3 1 0\n0 0 0 255 51 0 102\n"));
    // An alpha of 255 tells bytes from fractions, though it is the writer's own.
    let black = plain.clone().with_attribute(vertex(Semantic::Color(0), 3, vec![0.0; 9])).unwrap();
    assert!(written(&black).starts_with("COFF\n3 1 0\n0 0 0 0 0 0 255\n"));
    mesh = mesh.with_attribute(vertex(Semantic::Color(0), 3, [0.0, 1.0, 0.3].repeat(3))).unwrap();
    assert!(written(&mesh).starts_with("CNOFF\n3 1 0\n0 0 0 0 0 1 0.0 1.0 0.3 1.0\n"));
    mesh = mesh.with_attribute(vertex(Semantic::TexCoord(0), 2, vec![0.5; 6])).unwrap();
    assert!(written(&mesh).starts_with("STCNOFF\n3 1 0\n0 0 0 0 0 1 0.0 1.0 0.3 1.0 0.5 0.5\n"));
    let face = |values: &[f64]| Attribute {
        semantic: Semantic::Color(0),
        domain: Domain::Face,
        width: values.len(),
        values: values.to_vec(),
    };
    let last = |color: &[f64]| {
        let mesh = plain.clone().with_attribute(face(color)).unwrap();
        written(&mesh).lines().last().unwrap().to_owned()
    };
    assert_eq!(last(&[1.0, 0.0, 0.2]), "3 0 1 2 255 0 51");
    // As bytes these would be read as fractions, so they are written as such.
    assert_eq!(last(&[0.0, 0.0, 1.0 / 255.0]), "3 0 1 2 0.0 0.0 0.00392156862745098");
    assert_eq!(last(&[0.0, -0.0, 1.0, 1e20]), "3 0 1 2 0.0 -0.0 1.0 1e20");
}

#[test]
fn tied_vertices_become_one_row_and_what_they_disagree_in_is_told() {
    let positions =
        vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
    let up = [0.0, 0.0, 1.0];
    let mesh = |normals: &[[f64; 3]; 6]| {
        Mesh::new(positions.clone(), vec![[0, 1, 2], [3, 4, 5]])
            .and_then(|mesh| mesh.with_position_id(vec![0, 1, 2, 2, 1, 5]))
            .and_then(|mesh| mesh.with_attribute(Attribute::vertex_normals(normals)))
            .unwrap()
    };
    let smooth = mesh(&[up; 6]);
    assert_eq!(
        written(&smooth),
        "NOFF\n4 2 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n1 1 0 0 0 1\n3 0 1 2\n3 2 1 3\n"
    );
    let lost = |mesh: &Mesh| -> Vec<String> {
        let scene = Scene::from_mesh("", mesh.clone(), Frame::default());
        losses(&scene, Format::Off).unwrap().iter().map(|w| w.message.to_string()).collect()
    };
    assert_eq!(lost(&smooth), [""; 0]);
    let mut normals = [up; 6];
    normals[3] = [0.0, 1.0, 0.0];
    let creased = mesh(&normals);
    assert!(written(&creased).starts_with("OFF\n4 2 0\n"));
    assert_eq!(lost(&creased), ["OFF holds no normals of vertices"]);
    let more = smooth
        .with_attribute(vertex(Semantic::Color(1), 3, vec![0.0; 18]))
        .and_then(|mesh| mesh.with_attribute(vertex(Semantic::Custom("heat".into()), 1, vec![0.0; 6])))
        .unwrap();
    assert_eq!(
        lost(&more),
        ["OFF holds no colours of set 1 of vertices", "OFF holds no values 'heat' of vertices"]
    );
}

#[test]
fn parts_become_one_and_missing_values_are_filled() {
    let plain = Mesh::new(CORNERS.to_vec(), vec![[0, 1, 2]]).unwrap();
    let rich = plain
        .clone()
        .with_attribute(vertex(Semantic::Color(0), 4, vec![0.5; 12]))
        .and_then(|mesh| mesh.with_attribute(vertex(Semantic::TexCoord(0), 2, vec![0.25; 6])))
        .unwrap();
    let mut scene = Scene::from_mesh("a", plain, Frame::default());
    let other = Scene::from_mesh("b", rich, Frame::default());
    scene.parts.extend(other.parts);
    scene.nodes.extend(other.nodes);
    scene.nodes[1].part = Some(1);
    scene.roots.push(1);
    let mut file = Vec::new();
    write(&scene, None, Format::Off, &mut file).unwrap();
    let (mesh, _) = load(&file, Format::Off);
    assert_eq!(mesh.faces(), [[0, 1, 2], [3, 4, 5]]);
    assert_eq!(values(&mesh, &Semantic::Color(0)), [[1.0; 12], [0.5; 12]].concat());
    assert_eq!(values(&mesh, &Semantic::TexCoord(0)), [[0.0; 6], [0.25; 6]].concat());
    assert_eq!(losses(&scene, Format::Off).unwrap()[0].message, "OFF holds one part: all were joined");
}

#[test]
fn off_holds_the_polygons() {
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.1, 0.0], [2.0, 0.0, -1e-7]];
    let cage = Cage::new(positions, [vec![0, 1, 2, 3], vec![1, 4, 2]]).unwrap();
    let polygons = Polygons::from_cage(cage.with_creases(&[([0, 1], 2.5)]).unwrap(), Frame::default());
    let mut file = Vec::new();
    let certificate = serde_json::json!({"level": 2});
    off::write_polygons(&polygons, Some(&certificate), &mut file).unwrap();
    let text = "OFF\n# chordal: 1/1 {\"level\":2}\n5 2 0\n0 0 0\n1 0 0\n1 1 0\n0 0.1 0\n2 0 -1e-7\n4 0 1 2 3\n3 1 4 2\n";
    assert_eq!(String::from_utf8(file.clone()).unwrap(), text);
    let (scene, warnings) = load_scene(&file, Format::Off);
    assert_eq!((scene.parts[0].mesh.faces().len(), count(&warnings, "polygons-cut")), (3, 1));
    assert_eq!(scene.certificate, Some(certificate));
    assert_eq!(losses_of_polygons(&polygons, Format::Off)[0].message, "OFF holds no subdivision tags");
    assert!(Format::Off.holds_polygons());
}

#[test]
fn a_broken_certificate_is_counted_and_skipped() {
    let bytes = b"OFF\n# chordal: {\"bound\": \n1 0 0\n0 0 0\n";
    let (scene, warnings) = load_scene(bytes, Format::Off);
    assert_eq!((scene.certificate, count(&warnings, "certificate-unreadable")), (None, 1));
}

/// Any finite number, often one that is hard to print.
fn number() -> impl Strategy<Value = f64> {
    let odd = [0.0, -0.0, 1e300, -1e300, 4e-324, 0.1, 1e16, 1e-7, 123_456_789_012_345_680.0];
    prop_oneof![
        proptest::sample::select(odd.to_vec()),
        // The extent of the positions has to stay finite.
        any::<f64>().prop_map(|x| if x.abs() < 1e307 { x } else { 1.0 }),
        -10.0..10.0_f64,
    ]
}

/// Rows of three or four channels: zeros and ones, bytes, or any fractions.
fn colors(n: usize, domain: Domain) -> impl Strategy<Value = Attribute> {
    let channel = prop_oneof![
        (0_u8..2).prop_map(|b| f64::from(b) / 255.0).boxed(),
        any::<u8>().prop_map(|b| f64::from(b) / 255.0).boxed(),
        (0_u8..2).prop_map(f64::from).boxed(),
    ];
    let all = prop_oneof![
        proptest::sample::select(vec![0.0, 1.0]).boxed(),
        channel.boxed(),
        any::<u8>().prop_map(|b| f64::from(b) / 255.0).boxed(),
        number().boxed(),
    ];
    (3..5_usize).prop_flat_map(move |width| {
        let rows = prop_oneof![
            proptest::collection::vec(proptest::sample::select(vec![0.0, 1.0, 1.0 / 255.0]), n * width)
                .boxed(),
            proptest::collection::vec(all.clone(), n * width).boxed(),
        ];
        rows.prop_map(move |values| Attribute { semantic: Semantic::Color(0), domain, width, values })
    })
}

fn any_mesh() -> impl Strategy<Value = Mesh> {
    (3..12_usize, 1..12_usize).prop_flat_map(|(n, n_faces)| {
        let positions = proptest::collection::vec(proptest::array::uniform3(number()), n);
        let faces = proptest::collection::vec(proptest::array::uniform3(0..n as u32), n_faces);
        let normal = proptest::array::uniform3(0.1..1.0_f64);
        let normals = proptest::option::of(proptest::collection::vec(normal, n));
        let texcoords = proptest::option::of(proptest::collection::vec(number(), 2 * n));
        let of_vertices = proptest::option::of(colors(n, Domain::Vertex));
        let of_faces = proptest::option::of(colors(n_faces, Domain::Face));
        (positions, faces, normals, texcoords, of_vertices, of_faces).prop_map(
            |(positions, faces, normals, texcoords, of_vertices, of_faces)| {
                let unit = |v: [f64; 3]| v.map(|x| x / v.iter().map(|x| x * x).sum::<f64>().sqrt());
                let normals = normals.map(|all| all.into_iter().map(unit).collect::<Vec<_>>());
                let attributes = normals
                    .map(|all| Attribute::vertex_normals(&all))
                    .into_iter()
                    .chain(texcoords.map(|values| vertex(Semantic::TexCoord(0), 2, values)))
                    .chain(of_vertices)
                    .chain(of_faces);
                let mesh = Mesh::new(positions, faces).expect("valid");
                attributes.fold(mesh, |mesh, attribute| mesh.with_attribute(attribute).expect("valid"))
            },
        )
    })
}

/// An attribute as it comes back: colours of vertices always have an alpha.
fn with_alpha(attribute: &Attribute) -> Attribute {
    let Attribute { semantic, domain, width, values } = attribute;
    match (semantic, domain, width) {
        (Semantic::Color(0), Domain::Vertex, 3) => {
            let values = values.chunks(3).flat_map(|color| [color[0], color[1], color[2], 1.0]).collect();
            vertex(Semantic::Color(0), 4, values)
        }
        _ => attribute.clone(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_mesh_comes_back_to_the_last_bit(mesh in any_mesh()) {
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        let scene = Scene::from_mesh("", mesh.clone(), Frame::default());
        prop_assert!(losses(&scene, Format::Off).unwrap().is_empty());
        let text = written(&mesh);
        let (back, _) = load(text.as_bytes(), Format::Off);
        prop_assert_eq!(bits(back.positions().as_flattened()), bits(mesh.positions().as_flattened()));
        prop_assert_eq!(back.faces(), mesh.faces());
        prop_assert_eq!(back.attributes().len(), mesh.attributes().len());
        for (read, written) in back.attributes().iter().zip(mesh.attributes()) {
            let Attribute { semantic, domain, width, values } = with_alpha(written);
            prop_assert_eq!((&read.semantic, read.domain, read.width), (&semantic, domain, width));
            prop_assert_eq!(bits(&read.values), bits(&values));
        }
        prop_assert_eq!(written(&back), text, "the second time nothing changes");
    }

    #[test]
    fn any_bytes_after_a_keyword_end_in_a_mesh_or_one_error(
        keyword in "(ST)?C?N?4?n?OFF( BINARY)?\n",
        rest in proptest::collection::vec(any::<u8>(), 0..200),
        words in "[0-9 .#\n-]{0,200}",
    ) {
        for rest in [&rest[..], words.as_bytes()] {
            let _ = read(&[keyword.as_bytes(), rest].concat(), Format::Off, &Limits::default());
        }
    }
}

#[test]
fn foreign_files_end_as_they_are_known_to() {
    let Some(data) = corpus::find("") else { return };
    let (mut n_read, mut refused) = (0, Vec::new());
    for path in corpus::files(&data) {
        if path.extension().is_none_or(|e| !e.eq_ignore_ascii_case("off")) {
            continue;
        }
        let bytes = std::fs::read(&path).expect("readable");
        let name = path.strip_prefix(&data).expect("below").display().to_string();
        match read(&bytes, Format::Off, &Limits::default()) {
            Ok(loaded) => {
                let codes: Vec<_> = loaded.warnings.iter().map(|w| (w.code, w.count)).collect();
                println!("{name}: {codes:?}");
                assert_eq!(Format::sniff(&bytes), Some(Format::Off), "{name}");
                let Content::Scene(scene) = loaded.content else { panic!("a scene") };
                let mesh = &scene.parts[0].mesh;
                assert_eq!(load(written(mesh).as_bytes(), Format::Off).0, *mesh, "{name}");
                n_read += 1;
            }
            Err(error) => {
                println!("{name}: E {}: {error}", error.code);
                refused.push((name, error.code));
            }
        }
    }
    assert!(n_read > 15, "{n_read}");
    let expected = [
        ("corner/assimp/test/models/OFF/invalid.off".to_owned(), "index-out-of-range"),
        ("corner/assimp/test/models/invalid/OutOfMemory.off".to_owned(), "too-many-rows"),
        ("corner/assimp/test/models/invalid/empty.off".to_owned(), "empty"),
    ];
    assert_eq!(refused, expected);
}

#[test]
fn corners_of_a_face_on_several_lines_are_one_face() {
    let vertices = "0 0 0\n1 0 0\n0 1 0\n";
    let (mesh, warnings) = load(format!("OFF\n3 1 0\n{vertices}3 0\n1 # one\n\n2\n").as_bytes(), Format::Off);
    assert_eq!((mesh.faces(), count(&warnings, "faces-over-lines")), (&[[0, 1, 2]][..], 1));
    // A corner that is missing is not made up of the next face.
    let error = refuse(format!("OFF\n4 2 0\n{vertices}1 1 0\n4 0 1 2\n3 0 1 2\n").as_bytes(), Format::Off);
    assert_eq!(error.code, "list-length", "{error}");
    let error = refuse(format!("OFF\n4 1 0\n{vertices}1 1 0\n4 0 1\n2\n").as_bytes(), Format::Off);
    assert_eq!(error.code, "list-length", "{error}");
}
