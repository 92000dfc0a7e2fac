//! What a hostile STL may try, row by row of the list that the project keeps, and what must happen.
use crate::common;

use chordal_io::{FileLocation, Format, Limits, read};
use common::{count, load, load_scene, refuse};

const FACET: &str =
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";

/// A binary file that declares `declared` facets and holds `held`.
fn binary(header: &[u8], declared: u32, held: u32) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes[..header.len()].copy_from_slice(header);
    bytes.extend(declared.to_le_bytes());
    for facet in 0..held {
        let z = facet as f32;
        for x in [0.0, 0.0, 1.0, 0.0, 0.0, z, 1.0, 0.0, z, 0.0, 1.0, z] {
            bytes.extend(f32::to_le_bytes(x));
        }
        bytes.extend([0, 0]);
    }
    bytes
}

#[test]
fn h01_a_count_of_four_billion_in_84_bytes_is_refused() {
    let error = refuse(&binary(b"", u32::MAX, 0), Format::Stl);
    assert_eq!(error.code, "truncated");
    assert!(error.message.contains("84 bytes, header says 4,294,967,295 facets"), "{error}");
}

#[test]
fn h02_one_facet_short_is_refused_and_extra_bytes_are_counted() {
    let mut bytes = binary(b"x", 3, 3);
    bytes.truncate(bytes.len() - 1);
    let error = refuse(&bytes, Format::Stl);
    assert_eq!((error.code, error.place), ("truncated", FileLocation::Byte(84 + 100)));

    let mut bytes = binary(b"x", 3, 3);
    bytes.extend(b"1234567");
    let (mesh, warnings) = load(&bytes, Format::Stl);
    assert_eq!(mesh.faces().len(), 3);
    let warning = warnings.iter().find(|w| w.code == "trailing-bytes").expect("counted");
    assert!(warning.message.starts_with("7 extra bytes"), "{warning}");
    assert_eq!(warning.place, FileLocation::Byte(84 + 150));
}

#[test]
fn h03_a_binary_file_whose_header_says_solid_is_binary() {
    let (mesh, warnings) = load(&binary(b"solid of revolution\nfacet normal", 2, 2), Format::Stl);
    assert_eq!(mesh.faces().len(), 2);
    assert_eq!(warnings, []);
    assert_eq!(Format::sniff(&binary(b"solid", 2, 2)), Some(Format::Stl));
}

#[test]
fn h04_an_empty_solid_of_19_bytes_loads_without_facets() {
    let bytes = b"solid s\nendsolid s\n";
    assert_eq!(bytes.len(), 19);
    let (mesh, warnings) = load(bytes, Format::Stl);
    assert_eq!(mesh.faces().len(), 0);
    assert_eq!(count(&warnings, "no-faces"), 1);
}

#[test]
fn h05_several_solids_in_any_case_are_all_kept() {
    let text =
        format!("SOLID One\n{}ENDSOLID One\nSolid two\n{FACET}solid One\n{FACET}", FACET.to_uppercase());
    let (scene, warnings) = load_scene(text.as_bytes(), Format::Stl);
    let mesh = &scene.parts[0].mesh;
    assert_eq!(mesh.faces().len(), 3);
    assert_eq!(count(&warnings, "endsolid-missing"), 2);
    assert_eq!(scene.groups["solid"], ["", "One", "two", "One"]);
    assert_eq!(mesh.attributes()[0].values, [1.0, 2.0, 3.0]);
}

#[test]
fn h06_a_facet_that_is_no_triangle_or_has_a_bad_number_is_refused_at_its_line() {
    let with =
        |body: &str| format!("solid s\nfacet normal 0 0 1\nouter loop\n{body}endloop\nendfacet\nendsolid\n");
    let vertex = "vertex 0 0 0\n";
    let cases = [
        (vertex.repeat(4), 7, "more than 3 vertices"),
        (vertex.repeat(2), 6, "only 2 vertices"),
        (format!("{}vertex 0 0 0x\n", vertex.repeat(2)), 6, "'0x' is not a number"),
        (format!("{}vertex 0 0\n", vertex.repeat(2)), 7, "'endloop' is not a number"),
        (format!("{}vertex 0 1,5 0\n", vertex.repeat(2)), 6, "decimal comma"),
        (format!("{}vertex 0 inf 0\n", vertex.repeat(2)), 8, "not finite"),
    ];
    for (body, line, words) in cases {
        let error = refuse(with(&body).as_bytes(), Format::Stl);
        assert!(error.message.contains(words), "{error}");
        assert_eq!(error.place, FileLocation::Line(line), "{error}");
    }
    let error = refuse(b"solid s\nfacet normal 0 0 1\nouter loop\nvertex 1 2 3\n", Format::Stl);
    assert_eq!(error.code, "truncated");
    assert_eq!(error.place, FileLocation::Line(4));
}

#[test]
fn h07_normals_that_are_nan_zero_or_wrong_are_counted() {
    for (normal, code) in [
        ("nan nan nan", "normals-not-finite"),
        ("-nan(ind) 0 0", "normals-not-finite"),
        ("0 0 0", "normals-zero"),
        ("0 0 -1", "normals-wrong"),
    ] {
        let text =
            format!("solid s\n{}endsolid s\n", FACET.replace("0 0 1\nouter", &format!("{normal}\nouter")));
        let (mesh, warnings) = load(text.as_bytes(), Format::Stl);
        assert_eq!(count(&warnings, code), 1, "{normal}: {warnings:?}");
        assert_eq!(mesh.faces(), [[0, 1, 2]]);
        assert!(mesh.attributes().is_empty(), "normals come from the corners");
    }
}

#[test]
fn h28_what_is_too_short_or_no_stl_at_all_is_refused() {
    for bytes in [&b""[..], b" \n\t", b"s", b"solids and more", b"just some words"] {
        refuse(bytes, Format::Stl);
    }
    let error = refuse(&[b'x'; 200], Format::Stl);
    assert!(error.message.contains("header says"), "{error}");
}

#[test]
fn h54_zeros_of_either_sign_and_extreme_coordinates_are_one_surface() {
    let text =
        format!("solid s\n{FACET}{}endsolid s\n", FACET.replace(" 0", " -0.0").replace("1 -0.0", "1 0"));
    let (mesh, warnings) = load(text.as_bytes(), Format::Stl);
    assert_eq!(mesh.n_positions(), 3, "the zeros are tied");
    assert!(count(&warnings, "negative-zeros") > 0);
    assert_eq!(count(&warnings, "duplicate-faces"), 1);

    for scale in ["1e30", "1e-30", "1e-310", "4e-324"] {
        let text = format!("solid s\n{}endsolid s\n", FACET.replace("vertex 1", &format!("vertex {scale}")));
        let (mesh, _) = load(text.as_bytes(), Format::Stl);
        assert_eq!(mesh.positions()[1][0], scale.parse::<f64>().unwrap());
    }
    let text = format!(
        "solid s\n{}endsolid s\n",
        FACET.replace("1 0 0", "1.7e308 0 0").replace("0 1 0", "-1.7e308 1 0")
    );
    assert_eq!(refuse(text.as_bytes(), Format::Stl).code, "extent-overflow");
}

#[test]
fn h20_corners_that_are_not_finite_are_dropped_only_when_asked() {
    let mut bytes = binary(b"x", 3, 3);
    bytes[84 + 50 + 12..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let error = refuse(&bytes, Format::Stl);
    assert_eq!((error.code, error.place), ("not-finite", FileLocation::Row { list: "facet", row: 1 }));

    let limits = Limits { drop_nonfinite: true, ..Limits::default() };
    let loaded = read(&bytes, Format::Stl, &limits).expect("loads");
    let chordal_io::Content::Scene(scene) = loaded.content else { panic!("a scene") };
    let mesh = &scene.parts[0].mesh;
    assert_eq!(mesh.faces().len(), 2);
    assert_eq!(mesh.positions().len(), 8);
    assert_eq!(count(&loaded.warnings, "faces-dropped"), 1);
    assert_eq!(count(&loaded.warnings, "vertices-dropped"), 1);
}
