//! What the reader of VTK's XML files makes of them.
use super::build::{Builder, Compressor, Encoding, Form, Numbers, grid, points, poly_data};
use crate::common::{count, load_scene};
use chordal::explicit::{Domain, Semantic};
use chordal_io::Format;

fn row(values: &[f64]) -> Vec<f64> {
    values.to_vec()
}

#[test]
fn every_encoding_of_poly_data_is_the_same_mesh() {
    for encoding in Encoding::all() {
        let bytes = poly_data(encoding);
        assert_eq!(Format::sniff(&bytes), Some(Format::Vtp), "{encoding:?}");
        let (scene, warnings) = load_scene(&bytes, Format::Vtp);
        let mesh = &scene.parts[0].mesh;
        let expected: Vec<[f64; 3]> = points().iter().map(|p| p.map(f64::from)).collect();
        assert_eq!(mesh.positions(), expected, "{encoding:?}");
        // The diagonal of the quad is the cutter's choice.
        let quad = &mesh.faces()[..2];
        assert!(quad.iter().flatten().all(|i| *i < 4) && quad.iter().flatten().any(|i| *i == 3));
        assert_eq!(mesh.faces()[2..], [[0, 1, 4], [1, 4, 2], [2, 4, 5]], "{encoding:?}");
        let of = |semantic: &Semantic| mesh.attribute(semantic).expect("kept");
        // Points and lines are the cells 10 and 11.
        let id = of(&Semantic::Custom("id".into()));
        assert_eq!((id.domain, &id.values), (Domain::Face, &row(&[12.0, 12.0, 13.0, 14.0, 14.0])));
        assert_eq!(of(&Semantic::Normal).row(5), [0.0, 0.0, 1.0]);
        assert_eq!(of(&Semantic::Color(0)).row(5), [225.0 / 255.0, 240.0 / 255.0, 1.0]);
        assert_eq!(of(&Semantic::Custom("t < 1".into())).row(3), [3.0 / 7.0]);
        assert_eq!(mesh.attributes().len(), 4);
        assert_eq!([count(&warnings, "cells-left-out"), count(&warnings, "strips-cut")], [2, 2]);
        let left = warnings.iter().find(|w| w.code == "cells-left-out").unwrap();
        assert!(left.message.contains("1 poly-vertex (type 2), 1 polyline (type 4)"), "{}", &*left.message);
    }
}

#[test]
fn the_surface_cells_of_a_grid_are_read_and_others_named() {
    for encoding in Encoding::all() {
        let bytes = grid(encoding);
        assert_eq!(Format::sniff(&bytes), Some(Format::Vtu), "{encoding:?}");
        let (scene, warnings) = load_scene(&bytes, Format::Vtu);
        let mesh = &scene.parts[0].mesh;
        assert_eq!(mesh.faces().len(), 4);
        assert_eq!((mesh.faces()[0], mesh.faces()[3]), ([0, 1, 2], [1, 4, 5]));
        // A pixel's third and fourth points change places: its area is that of the square.
        let q = mesh.attribute(&Semantic::Custom("q".into())).unwrap();
        assert_eq!(q.values, [1.0, 2.0, 5.0, 6.0, 5.0, 6.0, 7.0, 8.0]);
        let said = |code: &str| warnings.iter().find(|w| w.code == code).unwrap().message.to_string();
        assert!(said("cells-left-out").ends_with("1 tetrahedron (type 10)"));
        assert!(said("curved-cells").ends_with("1 quadratic triangle (type 22)"));
        assert_eq!(count(&warnings, "polygon-overlaps"), 0);
    }
}

#[test]
fn pieces_are_parts_and_empty_ones_are_counted() {
    let piece = |x: f32| {
        let mut file = Builder::new("PolyData", Encoding::TEXT);
        file.put("<Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\">\n<Points>");
        file.array("", 3, &Numbers::F32(vec![x, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]));
        file.put("</Points><Polys>").array("connectivity", 1, &Numbers::U8(vec![0, 1, 2]));
        file.array("offsets", 1, &Numbers::U8(vec![3])).put("</Polys></Piece>");
        let text = String::from_utf8(file.end("PolyData")).unwrap();
        let start = text.find("<Piece").unwrap();
        text[start..text.find("</PolyData>").unwrap()].to_owned()
    };
    let text = format!(
        "<VTKFile type='PolyData'><!-- <Piece> --><PolyData>{}<Piece NumberOfPoints='0'/>{}</PolyData></VTKFile>",
        piece(0.5),
        piece(-3.0)
    );
    let (scene, warnings) = load_scene(text.as_bytes(), Format::Vtp);
    assert_eq!(scene.parts.len(), 2);
    assert_eq!(scene.parts[1].mesh.positions()[0], [-3.0, 0.0, 0.0]);
    assert_eq!(count(&warnings, "empty-pieces"), 1);
    assert_eq!(Format::sniff(text.as_bytes()), Some(Format::Vtp));
}

#[test]
fn text_goes_on_behind_comments_and_ends_before_other_elements() {
    let text = "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\">\
        <Points><DataArray type=\"Float32\" NumberOfComponents=\"3\">0 0 0 <!-- one --> 1 0 0\n\
        <InformationKey name=\"L2\"><Value index=\"0\"> 7 </Value></InformationKey> 0 1 0</DataArray></Points>\
        <Polys><DataArray type=\"Int32\" Name=\"offsets\">3</DataArray>\
        <DataArray type=\"Int32\" Name=\"connectivity\"><![CDATA[0 1 2]]></DataArray></Polys>\
        </Piece></PolyData></VTKFile>";
    let (scene, warnings) = load_scene(text.as_bytes(), Format::Vtp);
    assert_eq!(scene.parts[0].mesh.positions()[2], [0.0, 1.0, 0.0]);
    assert_eq!(scene.parts[0].mesh.faces(), [[0, 1, 2]]);
    assert!(warnings.is_empty(), "{warnings:?}");
}

#[test]
fn arrays_that_are_not_kept_are_named() {
    let mut file = Builder::new(
        "PolyData",
        Encoding { form: Form::Inline, compressor: Compressor::Zlib, ..Encoding::TEXT },
    );
    file.put("<FieldData>").array("time", 1, &Numbers::F64(vec![1.0])).put("</FieldData>");
    file.put("<Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\"><PointData>");
    file.array("a", 1, &Numbers::F64(vec![1.0; 3])).array("a", 1, &Numbers::F64(vec![2.0; 3]));
    file.array("wide", 17, &Numbers::U8(vec![0; 51])).array("long", 1, &Numbers::U8(vec![0; 5]));
    file.array("big", 1, &Numbers::I64(vec![1 << 53, (1 << 53) + 1, -(1 << 62)]));
    file.array("vtkGhostType", 1, &Numbers::U8(vec![0, 1, 0]));
    file.put("<Array type=\"String\" Name=\"s\" format=\"ascii\">65 0</Array></PointData><Points>");
    file.array("p", 3, &Numbers::F32(vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]));
    file.put("</Points><Polys>").array("connectivity", 1, &Numbers::U8(vec![0, 1, 2]));
    file.array("offsets", 1, &Numbers::U8(vec![3])).put("</Polys></Piece>");
    let (scene, warnings) = load_scene(&file.end("PolyData"), Format::Vtp);
    let counts = ["arrays-skipped", "arrays-repeated", "values-left-over", "values-rounded", "ghosts-kept"]
        .map(|code| count(&warnings, code));
    assert_eq!(counts, [3, 1, 2, 2, 1]);
    assert_eq!(scene.parts[0].mesh.attribute(&Semantic::Custom("a".into())).unwrap().values, [1.0; 3]);
}
