//! AMF: what is read of files made by hand, and what is refused.
use crate::common::{count, load_scene, refuse};
use crate::threemf::build::{Zipped, zip_of};
use chordal::explicit::{Domain, Semantic};
use chordal_io::{Axis, FileLocation, Format, Limits, Scene, Warning, read};

fn vertex(p: [f64; 3], more: &str) -> String {
    let [x, y, z] = p;
    format!("<vertex><coordinates><x>{x}</x><y> {y} </y><z>{z}</z></coordinates>{more}</vertex>\n")
}

fn triangle(corners: [u32; 3], more: &str) -> String {
    let [a, b, c] = corners;
    format!("<triangle>{more}<v1>{a}</v1><v2>{b}</v2><v3>{c}</v3></triangle>\n")
}

fn color(channels: &[f64]) -> String {
    let each =
        ["r", "g", "b", "a"].iter().zip(channels).map(|(name, value)| format!("<{name}>{value}</{name}>"));
    format!("<color>{}</color>", each.collect::<String>())
}

/// The vertices of a square.
fn square(more: &str) -> String {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.1], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    corners.map(|p| vertex(p, more)).concat()
}

fn object(id: u32, vertices: &str, volumes: &str) -> String {
    format!("<object id=\"{id}\"><mesh><vertices>\n{vertices}</vertices>{volumes}</mesh></object>\n")
}

fn file(content: &str) -> Vec<u8> {
    format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- x -->\n<amf unit=\"inch\" version=\"1.1\">\n{content}</amf>\n")
        .into_bytes()
}

fn plain(id: u32) -> String {
    object(id, &square(""), &format!("<volume>{}</volume>", triangle([0, 1, 2], "")))
}

fn loaded(content: &str) -> (Scene, Vec<Warning>) {
    load_scene(&file(content), Format::Amf)
}

#[test]
fn objects_are_parts_in_their_unit() {
    let bytes = file(&(plain(7) + &plain(2)));
    assert_eq!(Format::sniff(&bytes), Some(Format::Amf));
    let (scene, warnings) = load_scene(&bytes, Format::Amf);
    assert_eq!((scene.parts.len(), scene.roots.len()), (2, 2));
    assert_eq!(scene.parts[1].mesh.positions()[1], [1.0, 0.0, 0.1]);
    assert_eq!(scene.parts[0].mesh.faces(), [[0, 1, 2]]);
    assert_eq!((scene.frame.up, scene.frame.metres_per_unit), (Some(Axis::Z), Some(0.0254)));
    assert_eq!(count(&warnings, "isolated-vertices"), 2);
    for (unit, metres) in [("millimeter", 0.001), ("feet", 0.3048), ("meter", 1.0), ("micrometer", 1e-6)] {
        let text = String::from_utf8(file(&plain(1))).unwrap().replace("inch", unit);
        assert_eq!(load_scene(text.as_bytes(), Format::Amf).0.frame.metres_per_unit, Some(metres));
    }
    let text = String::from_utf8(file(&plain(1))).unwrap().replace("unit=\"inch\"", "");
    assert_eq!(load_scene(text.as_bytes(), Format::Amf).0.frame.metres_per_unit, Some(0.001));
}

#[test]
fn a_zip_file_of_a_document_is_read_like_the_document() {
    let text = file(&plain(1));
    let entries = [Zipped::deflated("part.AMF", &text), Zipped::stored("notes.txt", b"x")];
    let bytes = zip_of(&entries);
    assert_eq!(Format::sniff(&bytes), Some(Format::Amf));
    let (scene, warnings) = load_scene(&bytes, Format::Amf);
    assert_eq!(scene.parts[0].mesh, loaded(&plain(1)).0.parts[0].mesh);
    assert_eq!(count(&warnings, "parts-ignored"), 1);
    let other = zip_of(&[Zipped::stored("notes.txt", b"x")]);
    assert_eq!((refuse(&other, Format::Amf).code, Format::sniff(&other)), ("not-amf", None));
    let broken = b"<amf><object id=\"1\"></amf>";
    let error = refuse(&zip_of(&[Zipped::stored("a.amf", broken)]), Format::Amf);
    assert!(error.message.starts_with("a.amf: "), "{error}");
}

#[test]
fn the_nearest_colour_counts() {
    let material = format!(
        "<material id=\"m\"><metadata type=\"Name\">red</metadata>{}</material>",
        color(&[1.0, 0.0, 0.0])
    );
    let vertices = square("") + &vertex([2.0, 2.0, 2.0], &color(&[0.0, 0.5, 0.0, 0.5]));
    let volumes = format!(
        "<volume materialid=\"m\">{}{}{}</volume><volume materialid=\"0\"><metadata type=\"name\">b</metadata>{}{}</volume><volume>{}</volume>",
        triangle([0, 1, 2], ""),
        triangle([0, 1, 4], ""),
        triangle([0, 1, 4], &color(&[0.0, 0.0, 1.0])),
        color(&[0.25, 0.25, 0.25]),
        triangle([1, 2, 3], ""),
        triangle([1, 3, 2], ""),
    );
    let (scene, warnings) = loaded(&(object(1, &vertices, &volumes) + &material));
    let mesh = &scene.parts[0].mesh;
    let colors = mesh.attribute(&Semantic::Color(0)).expect("kept");
    assert_eq!((colors.domain, colors.width), (Domain::Corner, 4));
    let rows: Vec<&[f64]> = (0..15).map(|corner| colors.row(corner)).collect();
    let red = [1.0, 0.0, 0.0, 1.0];
    assert_eq!(rows[..6], [red, red, red, red, red, [0.0, 0.5, 0.0, 0.5]]);
    assert_eq!(rows[6..9], [[0.0, 0.0, 1.0, 1.0]; 3]);
    assert_eq!(rows[9..12], [[0.25, 0.25, 0.25, 1.0]; 3]);
    assert_eq!(rows[12..], [[1.0; 4]; 3]);
    assert_eq!(count(&warnings, "triangles-without-colour"), 1);
    let group = |kind: &str| &mesh.attribute(&Semantic::Group(kind.into())).unwrap().values;
    assert_eq!(group("material"), &[1.0, 1.0, 1.0, 0.0, 0.0]);
    assert_eq!(scene.groups["material"], ["", "red"]);
    assert_eq!(group("volume"), &[1.0, 1.0, 1.0, 2.0, 3.0]);
    assert_eq!(scene.groups["volume"], ["", "", "b", ""]);
}

#[test]
fn constellations_are_nodes() {
    let content = plain(1)
        + &plain(2)
        + "<constellation id=\"3\"><metadata type=\"name\">pair</metadata>\
           <instance objectid=\"1\"><deltax>5</deltax></instance>\
           <instance objectid=\"1\"><rz>90</rz><deltaz>-1</deltaz></instance></constellation>\
           <constellation id=\"4\"><instance objectid=\"3\"><deltay>1</deltay></instance></constellation>";
    let (scene, _) = loaded(&content);
    // The second object and the second constellation stand in no other.
    assert_eq!(scene.roots.len(), 2);
    let world = scene.world_meshes().unwrap();
    let firsts: Vec<[f64; 3]> = world.iter().map(|(_, mesh)| mesh.positions()[1]).collect();
    assert_eq!(firsts, [[1.0, 0.0, 0.1], [6.0, 1.0, 0.1], [0.0, 2.0, 0.1 - 1.0]]);
    assert!(scene.nodes.iter().any(|node| node.name == "pair"));
}

#[test]
fn what_is_not_kept_is_named() {
    let normal = "<normal><nx>0</nx><ny>0</ny><nz>1</nz></normal>";
    let vertices = square(normal) + "<edge><v1>0</v1><dx1>1</dx1></edge>";
    let more = "<texmap rtexid=\"1\"><utex1>0</utex1></texmap><color><r>sin(x)</r></color>";
    let volume = format!(
        "<volume type=\"support\">{}<color><r>7</r><g>0</g><b>0</b></color></volume>",
        triangle([0, 1, 2], more)
    );
    let content = object(1, &vertices, &volume)
        + "<texture id=\"1\">AAAA</texture><material id=\"2\"><composite materialid=\"3\">x</composite></material><thing/>\
           <metadata type=\"author\">x</metadata>";
    let (scene, warnings) = loaded(&content);
    let codes = [
        "curved-triangles",
        "textures-skipped",
        "color-formula",
        "color-out-of-range",
        "object-types",
        "composites-skipped",
        "elements-skipped",
    ];
    assert_eq!(codes.map(|code| count(&warnings, code)), [5, 2, 1, 1, 1, 1, 1]);
    assert_eq!(scene.parts[0].mesh.attributes()[0].row(0), [1.0, 0.0, 0.0, 1.0]);
}

#[test]
fn files_that_lie_are_one_error_at_their_place() {
    let whole = plain(1);
    for (from, to, code) in [
        ("<x>0</x>", "<x>0,5</x>", "not-a-number"),
        ("<x>0</x>", "<x>1e400</x>", "not-finite"),
        ("<x>0</x>", "<x></x>", "not-a-number"),
        ("<x>0</x>", "", "missing-value"),
        ("<v3>2</v3>", "<v3>4</v3>", "index-out-of-range"),
        ("<v3>2</v3>", "<v3>-1</v3>", "index-out-of-range"),
        ("<v3>2</v3>", "<v3>99999999999999999999</v3>", "index-out-of-range"),
        ("<v3>2</v3>", "<v3>1.5</v3>", "not-a-number"),
        ("<v3>2</v3>", "", "missing-value"),
        ("<v3>2</v3>", "<v3>2</v1>", "not-xml"),
        ("id=\"1\"", "", "missing-attribute"),
        ("<volume>", "<volume materialid=\"9\">", "missing-material"),
        ("</object>", "</object><object id=\"1\"/>", "duplicate-id"),
        ("</object>", "</object><material id=\"1\"/><material id=\"1\"/>", "duplicate-id"),
        ("</object>", "</object><constellation id=\"1\"/>", "duplicate-id"),
        (
            "</object>",
            "</object><constellation id=\"2\"><instance objectid=\"9\"/></constellation>",
            "missing-object",
        ),
        (
            "</object>",
            "</object><constellation id=\"2\"><instance objectid=\"2\"/></constellation>",
            "constellation-cycle",
        ),
        (
            "</object>",
            "</object><constellation id=\"2\"><instance objectid=\"1\"><rx>a</rx></instance></constellation>",
            "not-a-number",
        ),
        ("<object", "<!DOCTYPE x [<!ENTITY a \"b\">]><object", "dtd-not-allowed"),
    ] {
        assert!(whole.contains(from), "{from}");
        let error = refuse(&file(&whole.replacen(from, to, 1)), Format::Amf);
        assert_eq!(error.code, code, "{to}: {error}");
    }
    let error = refuse(&file(&whole.replacen("<v3>2</v3>", "<v3>4</v3>", 1)), Format::Amf);
    assert_eq!(error.place, FileLocation::LineColumn { line: 9, column: 55 });
    assert_eq!(refuse(b"<amfx/>", Format::Amf).code, "not-amf");
    assert_eq!(refuse(b"<amf unit=\"yard\"/>", Format::Amf).code, "unknown-unit");
    let limits = Limits { rows: 3, ..Limits::default() };
    assert_eq!(read(&file(&whole), Format::Amf, &limits).unwrap_err().code, "too-many-rows");
}

#[test]
fn constellations_of_constellations_do_not_grow_without_limit() {
    let doubled = |n: u32| {
        let each = (2..n).map(|id| {
            let of = id - 1;
            format!("<constellation id=\"{id}\"><instance objectid=\"{of}\"/><instance objectid=\"{of}\"/></constellation>")
        });
        plain(1) + &each.collect::<String>()
    };
    assert_eq!(loaded(&doubled(12)).0.world_meshes().unwrap().len(), 1 << 10);
    assert_eq!(refuse(&file(&doubled(60)), Format::Amf).code, "too-many-copies");
    // A long chain is no recursion.
    let chain: String = (2..20_000)
        .map(|id| format!("<constellation id=\"{id}\"><instance objectid=\"{}\"/></constellation>", id - 1))
        .collect();
    assert_eq!(loaded(&(plain(1) + &chain)).0.nodes.len(), 19_999);
    let ring = "<constellation id=\"2\"><instance objectid=\"3\"/></constellation>\
                <constellation id=\"3\"><instance objectid=\"2\"/></constellation>";
    assert_eq!(refuse(&file(&(plain(1) + ring)), Format::Amf).code, "constellation-cycle");
}
