//! What is read of 3MF files made by hand.
use super::build::{
    TO_MODEL, TYPES, Zipped, body, model, model_with, package, package_with, relationships, tetrahedron,
    zip_of,
};
use crate::common::{count, load_scene, refuse};
use chordal::explicit::{Domain, Semantic};
use chordal_io::{Axis, FileLocation, Format, Frame, Limits, read};

#[test]
fn a_body_is_a_part_in_the_unit_of_the_file() {
    for (unit, metres) in [
        ("unit=\"micron\"", 1e-6),
        ("unit=\"millimeter\"", 0.001),
        ("unit=\"centimeter\"", 0.01),
        ("unit=\"inch\"", 0.0254),
        ("unit=\"foot\"", 0.3048),
        ("unit=\"meter\"", 1.0),
        ("", 0.001),
    ] {
        let bytes = package(&model_with(unit, &body(7, "name=\"a &amp; b\""), "<item objectid=\"7\"/>"));
        assert_eq!(Format::sniff(&bytes), Some(Format::ThreeMf));
        let (scene, warnings) = load_scene(&bytes, Format::ThreeMf);
        assert_eq!(warnings, []);
        assert_eq!(
            scene.frame,
            Frame { up: Some(Axis::Z), metres_per_unit: Some(metres), ..Frame::default() }
        );
        let part = &scene.parts[0];
        assert_eq!((&*part.name, part.indexed), ("a & b", true));
        assert_eq!(part.mesh.positions(), [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.5, 0.0], [0.0, 0.0, -0.002]]);
        assert_eq!(part.mesh.faces(), [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]);
        assert!(part.mesh.attributes().is_empty() && part.mesh.position_id().is_none());
        assert_eq!((scene.roots, scene.nodes.len(), scene.nodes[0].part), (vec![0], 1, Some(0)));
    }
}

#[test]
fn components_are_nodes_and_instances_share_their_part() {
    let resources = format!(
        "{}<object id=\"2\" name=\"pair\"><components><component objectid=\"1\"/>\
         <component objectid=\"1\" transform=\"0 1 0 -1 0 0 0 0 1 10 20 30\"/></components></object>",
        body(1, "name=\"one\"")
    );
    let items =
        "<item objectid=\"2\"/><item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 0 0 5\" partnumber=\"x\"/>";
    let (scene, warnings) = load_scene(&package(&model(&resources, items)), Format::ThreeMf);
    assert_eq!(warnings, []);
    assert_eq!((scene.parts.len(), scene.nodes.len(), &*scene.roots), (1, 6, &[0, 3][..]));
    assert_eq!((&*scene.nodes[0].name, &*scene.nodes[0].children), ("pair", &[1, 2][..]));
    // A point x is taken to x·M, so the first row is where the first axis goes.
    let turned = &scene.nodes[2].matrix;
    assert_eq!(turned[..4], [0.0, 1.0, 0.0, 0.0]);
    assert_eq!(turned[12..], [10.0, 20.0, 30.0, 1.0]);
    let meshes = scene.world_meshes().unwrap();
    let at: Vec<_> = meshes.iter().map(|(name, mesh)| (*name, mesh.positions()[1])).collect();
    let expected = [[1.0, 0.0, 0.0], [10.0, 21.0, 30.0], [1.0, 0.0, 5.0], [10.0, 21.0, 35.0]];
    assert_eq!(at, expected.map(|p| ("one", p)));
}

#[test]
fn an_object_that_only_names_a_mesh_is_that_mesh() {
    let resources = format!(
        "{}<object id=\"2\" name=\"left\"><components><component objectid=\"1\"/></components></object>",
        body(1, "name=\"wing\"")
    );
    let (scene, _) = load_scene(&package(&model(&resources, "<item objectid=\"2\"/>")), Format::ThreeMf);
    assert_eq!((scene.nodes.len(), &*scene.nodes[0].name, scene.nodes[0].part), (1, "left", Some(0)));
}

#[test]
fn materials_are_groups_with_names_and_colours() {
    let resources = format!(
        "<basematerials id=\"1\"><base name=\"red\" displaycolor=\"#FF0000\"/>\
         <base name=\"glass\" displaycolor=\"#00ff0080\"/></basematerials>\
         <object id=\"2\" pid=\"1\" pindex=\"0\">{}</object>{}",
        tetrahedron(["", "p1=\"1\"", "pid=\"1\" p1=\"1\"", ""]),
        body(3, "")
    );
    let (scene, warnings) = load_scene(
        &package(&model(&resources, "<item objectid=\"2\"/><item objectid=\"3\"/>")),
        Format::ThreeMf,
    );
    assert_eq!(warnings, []);
    assert_eq!(scene.groups["material"], ["", "red", "glass"]);
    let mesh = &scene.parts[0].mesh;
    let materials = mesh.attribute(&Semantic::Group("material".into())).unwrap();
    assert_eq!((materials.domain, &*materials.values), (Domain::Face, &[1.0, 2.0, 2.0, 1.0][..]));
    let colors = mesh.attribute(&Semantic::Color(0)).unwrap();
    assert_eq!((colors.domain, colors.width), (Domain::Corner, 4));
    assert_eq!(colors.row(0), [1.0, 0.0, 0.0, 1.0]);
    assert_eq!(colors.row(5), [0.0, 1.0, 0.0, 128.0 / 255.0]);
    assert!(scene.parts[1].mesh.attributes().is_empty());
}

#[test]
fn colours_of_corners_are_bytes_of_255() {
    let resources = format!(
        "<m:colorgroup id=\"5\"><m:color color=\"#336699\"/><m:color color=\"#01020304\"/></m:colorgroup>\
         <object id=\"2\">{}</object>",
        tetrahedron(["pid=\"5\" p1=\"0\" p2=\"1\" p3=\"0\"", "pid=\"5\" p1=\"1\"", "", "p1=\"0\""])
    );
    let (scene, warnings) =
        load_scene(&package(&model(&resources, "<item objectid=\"2\"/>")), Format::ThreeMf);
    assert_eq!(count(&warnings, "triangles-without-colour"), 2);
    assert_eq!(count(&warnings, "property-without-group"), 1);
    let colors = scene.parts[0].mesh.attribute(&Semantic::Color(0)).unwrap();
    let bytes = |row: usize| colors.row(row).iter().map(|x| x * 255.0).collect::<Vec<_>>();
    assert_eq!(bytes(0), [51.0, 102.0, 153.0, 255.0]);
    for row in [1, 3, 4, 5] {
        assert_eq!(bytes(row), [1.0, 2.0, 3.0, 4.0]);
    }
    assert_eq!(bytes(6), [255.0; 4]);
    for wrong in ["#12345", "336699", "#3366zz", "#33669900ff"] {
        let bytes = package(&model(&resources.replace("#336699", wrong), "<item objectid=\"2\"/>"));
        let (scene, warnings) = load_scene(&bytes, Format::ThreeMf);
        assert_eq!(count(&warnings, "not-a-color"), 1, "{wrong}");
        let colors = scene.parts[0].mesh.attribute(&Semantic::Color(0)).unwrap();
        assert_eq!(colors.row(0), [1.0; 4], "white where no colour is known");
    }
}

/// As slicers write it: prefixes, a byte order mark, line ends of Windows, identifiers, metadata, pictures,
/// settings, entries that are stored and entries whose sizes come after them.
#[test]
fn a_file_of_another_writer_is_read_and_what_is_left_out_is_counted() {
    let text = "\u{feff}<?xml version=\"1.0\" encoding=\"utf-8\"?>\r\n<!-- a comment -->\r\n\
        <c:model xmlns:c=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" unit=\"inch\"\r\n\
        xml:lang=\"en-US\" xmlns:q=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\"\r\n\
        xmlns:slic3rpe=\"http://schemas.slic3r.org/3mf/2017/06\" requiredextensions=\"q\">\r\n\
        <c:metadata name=\"Title\" preserve=\"1\">A &lt;cube&gt;</c:metadata>\r\n\
        <c:metadata name=\"slic3rpe:Version3mf\">1</c:metadata>\r\n<c:resources>\r\n\
        <c:object id=\"1\" type=\"model\" q:UUID=\"00010000-81cb-4c03-9d28-80fed5dfa1dc\">\r\n\
        <c:metadatagroup><c:metadata name=\"note\">x</c:metadata></c:metadatagroup>\r\n\
        <c:mesh>\r\n<c:vertices>\r\n<c:vertex x=' 0 ' y='0' z='0'/><c:vertex x='1' y='0' z='0'></c:vertex>\
        <c:vertex x='0' y='1' z='0'/></c:vertices>\r\n\
        <c:triangles><c:triangle v1='0' v2='1' v3='2' slic3rpe:custom_supports=\"4\"/></c:triangles>\
        </c:mesh></c:object></c:resources>\r\n\
        <c:build q:UUID=\"2\"><c:item objectid=\"1\" printable=\"1\" q:UUID=\"3\"/></c:build>\r\n</c:model>";
    let streamed =
        |name: &str, content: &str| Zipped { flags: 8, ..Zipped::deflated(name, content.as_bytes()) };
    let settings = "; layer_height = 0.2";
    let to_model = TO_MODEL.replace("/3D", "3D");
    let thumbnail = "Type=\"http://schemas.openxmlformats.org/package/2006/relationships/metadata/thumbnail\" \
                     Target=\"/Metadata/thumbnail.png\"";
    let bytes = zip_of(&[
        Zipped::stored("[Content_Types].xml", TYPES.as_bytes()),
        Zipped::stored("Metadata/", b""),
        Zipped::stored("Metadata/thumbnail.png", b"\x89PNG"),
        streamed("_rels/.rels", &relationships(&[thumbnail, &to_model])),
        Zipped { is_64: true, ..streamed("3D/3DModel.model", text) },
        Zipped::stored("Metadata/Slic3r_PE.config", settings.as_bytes()),
        Zipped::stored("Metadata/run.js", b"throw 1"),
    ]);
    let (scene, warnings) = load_scene(&bytes, Format::ThreeMf);
    assert_eq!(scene.frame.metres_per_unit, Some(0.0254));
    assert_eq!(scene.parts[0].mesh.faces(), [[0, 1, 2]]);
    assert_eq!(scene.nodes.len(), 1);
    let found: Vec<_> = warnings.iter().map(|w| (w.code, w.count)).collect();
    assert_eq!(found, [("pictures-ignored", 1), ("parts-ignored", 2)]);
    assert!(warnings[1].message.contains("'Metadata/Slic3r_PE.config' first"), "{}", warnings[1]);
}

#[test]
fn what_is_not_read_is_counted_by_its_name() {
    let lattice = "xmlns:b=\"http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02\" \
                   requiredextensions=\"b p m\"";
    let resources = format!(
        "<m:texture2d id=\"8\" path=\"/3D/t.png\" contenttype=\"image/png\"/>\
         <m:texture2dgroup id=\"1\" texid=\"8\"><m:tex2coord u=\"0\" v=\"1\"/></m:texture2dgroup>\
         <object id=\"2\" type=\"support\" pid=\"1\" pindex=\"0\">{}</object><what/>",
        tetrahedron(["", "pid=\"1\" p1=\"0\"", "", ""])
            .replace("</mesh>", "<b:beamlattice radius=\"1\"><b:beams/></b:beamlattice></mesh>")
    );
    let (scene, warnings) =
        load_scene(&package(&model_with(lattice, &resources, "<item objectid=\"2\"/>")), Format::ThreeMf);
    for code in
        ["beam-lattice-skipped", "properties-skipped", "textures-skipped", "object-types", "elements-skipped"]
    {
        assert_eq!(count(&warnings, code), 1, "{code}");
    }
    let of = |code: &str| warnings.iter().find(|w| w.code == code).unwrap().message.to_string();
    assert!(of("beam-lattice-skipped").contains("beam lattices"));
    assert!(of("object-types").contains("'support'"));
    assert!(of("elements-skipped").contains("'what' first"));
    assert!(scene.parts[0].mesh.attributes().is_empty(), "textures are no colours");
}

#[test]
fn what_changes_the_shape_and_is_not_read_is_refused_by_its_name() {
    let required =
        "xmlns:d=\"http://schemas.3mf.io/3dmanufacturing/displacement/2023/10\" requiredextensions=\"d\"";
    let error = refuse(&package(&model_with(required, &body(1, ""), "")), Format::ThreeMf);
    assert_eq!(error.code, "unsupported-extension");
    assert!(error.message.contains("'d' (displacement)"), "{error}");
    let unknown = "xmlns:z=\"urn:z\" requiredextensions=\"z\"";
    assert_eq!(refuse(&package(&model_with(unknown, "", "")), Format::ThreeMf).code, "unsupported-extension");
    let space = "xmlns:bo=\"http://schemas.3mf.io/3dmanufacturing/booleanoperations/2023/07\"";
    let object = "<object id=\"1\"><bo:booleanshape objectid=\"2\"/></object>";
    let error = refuse(&package(&model_with(space, object, "")), Format::ThreeMf);
    assert!(error.message.contains("boolean operations"), "{error}");
}

#[test]
fn errors_name_the_part_and_its_line() {
    let fail = |model: &str| refuse(&package(model), Format::ThreeMf);
    let with = |from: &str, to: &str| model(&body(1, "").replacen(from, to, 1), "<item objectid=\"1\"/>");
    for (from, to, code, line, words) in [
        ("y=\"1.5\"", "y=\"1,5\"", "not-a-number", 7, "decimal comma"),
        ("y=\"1.5\"", "y=\"1e999\"", "not-finite", 7, "1e999"),
        ("y=\"1.5\"", "", "missing-attribute", 7, "'y'"),
        ("v3=\"2\"", "v3=\"4\"", "index-out-of-range", 10, "there are 4"),
        ("v3=\"2\"", "v3=\"-1\"", "index-out-of-range", 10, "'-1'"),
        ("v3=\"2\"", "v3=\"2.0\"", "not-a-number", 10, "'2.0'"),
        ("</vertices>", "</vertice>", "not-xml", 9, "well-formed"),
        ("id=\"1\"", "id=\"4294967295\"", "index-out-of-range", 4, "outside"),
    ] {
        let error = fail(&with(from, to));
        assert_eq!(error.code, code, "{to}: {error}");
        assert!(error.message.starts_with("3D/3dmodel.model: ") && error.message.contains(words), "{error}");
        assert!(
            matches!(error.place, FileLocation::LineColumn { line: found, .. } if found == line),
            "{to}: {error}"
        );
    }
    for (text, code) in [
        (model_with("unit=\"parsec\"", "", ""), "unknown-unit"),
        (model("<object id=\"1\"/>", ""), "empty-object"),
        (model(&(body(1, "") + &body(1, "")), ""), "duplicate-id"),
        (model(&body(1, ""), "<item objectid=\"1\" transform=\"1 0 0\"/>"), "not-a-number"),
        (
            model(&body(1, ""), "<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 0 0 0 1\"/>"),
            "wrong-width",
        ),
        (model(&body(1, ""), "<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 0 0 nan\"/>"), "not-finite"),
        ("<svg xmlns=\"http://www.w3.org/2000/svg\"/>".to_owned(), "not-3mf"),
        ("".to_owned(), "not-xml"),
        (model("", "") + "<more/>", "not-xml"),
        ("<a:model/>".to_owned(), "not-xml"),
    ] {
        assert_eq!(fail(&text).code, code, "{text}");
    }
}

#[test]
fn vertices_that_are_not_finite_are_dropped_only_when_asked() {
    let bytes = package(&model(&body(1, "").replace("y=\"1.5\"", "y=\"NaN\""), "<item objectid=\"1\"/>"));
    assert_eq!(refuse(&bytes, Format::ThreeMf).code, "not-finite");
    let limits = Limits { drop_nonfinite: true, ..Limits::default() };
    let loaded = read(&bytes, Format::ThreeMf, &limits).expect("loads");
    assert_eq!(count(&loaded.warnings, "faces-dropped"), 3);
}

#[test]
fn what_the_build_leaves_out_is_counted() {
    let (scene, warnings) = load_scene(&package(&model(&body(1, ""), "")), Format::ThreeMf);
    assert_eq!((scene.parts.len(), scene.nodes.len()), (1, 0));
    assert_eq!(count(&warnings, "objects-not-shown"), 1);
}

#[test]
fn other_zip_files_are_not_taken_for_models() {
    let npz = zip_of(&[Zipped::stored("a.npy", b"\x93NUMPY")]);
    let usdz = zip_of(&[Zipped::stored("scene.usdc", b"PXR-USDC")]);
    let docx =
        zip_of(&[Zipped::stored("[Content_Types].xml", TYPES.as_bytes()), Zipped::stored("word/a.xml", b"")]);
    for other in [npz, usdz, docx] {
        assert_ne!(Format::sniff(&other), Some(Format::ThreeMf));
        assert_eq!(refuse(&other, Format::ThreeMf).code, "not-3mf");
    }
    let whole = package(&model(&body(1, ""), ""));
    assert_eq!(
        Format::sniff(&whole[..whole.len() - 9]),
        Some(Format::ThreeMf),
        "cut off, by its first names"
    );
    assert_eq!(refuse(&whole[..whole.len() - 9], Format::ThreeMf).code, "truncated");
}

#[test]
fn objects_of_other_model_parts_are_read() {
    let far = model(&(body(1, "name=\"far\"") + &body(9, "")), "");
    let near = model(
        "<object id=\"4\" name=\"both\"><components><component p:path=\"/3D/Objects/far.model\" objectid=\"1\"/>\
         <component p:path=\"/3D/objects/FAR.model\" objectid=\"9\" transform=\"1 0 0 0 1 0 0 0 1 1 2 3\"/>\
         </components></object>",
        "<item objectid=\"4\"/><item objectid=\"1\" p:path=\"/3D/Objects/far.model\"/>",
    );
    let others = [
        ("3D/Objects/far.model", &*far),
        (
            "3D/_rels/3dmodel.model.rels",
            &relationships(&[&TO_MODEL.replace("/3D/3dmodel.model", "/3D/Objects/far.model")]),
        ),
        ("3D/unused.model", "never read"),
    ];
    let (scene, warnings) = load_scene(&package_with(&near, &others), Format::ThreeMf);
    let found: Vec<_> = warnings.iter().map(|w| (w.code, w.count)).collect();
    assert_eq!(found, [("models-ignored", 1)]);
    assert_eq!((scene.parts.len(), scene.nodes.len(), &*scene.roots), (2, 4, &[0, 3][..]));
    assert_eq!((&*scene.parts[0].name, scene.nodes[3].part), ("far", Some(0)));
    let inch = far.replace("millimeter", "inch");
    let error = refuse(&package_with(&near, &[("3D/Objects/far.model", &inch)]), Format::ThreeMf);
    assert_eq!(error.code, "units-differ");
    assert_eq!(refuse(&package(&near), Format::ThreeMf).code, "missing-part");
}
