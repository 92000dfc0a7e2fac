//! Collada: what is read of files made by hand, and what is refused.
use crate::common::{count, load_scene, refuse};
use chordal::explicit::{Domain, Semantic};
use chordal_io::{Axis, FileLocation, Format, ImageContent, Limits, Scene, TextureOrigin, read};

/// A source of rows.
fn source(id: &str, width: usize, values: &str) -> String {
    let n = values.split_whitespace().count();
    let params = "<param type=\"float\"/>".repeat(width);
    format!(
        "<source id=\"{id}\"><float_array count=\"{n}\">{values}</float_array><technique_common>\
         <accessor source=\"#{id}-array\" count=\"{}\" stride=\"{width}\">{params}</accessor></technique_common></source>\n",
        n / width
    )
}

/// A geometry of five points with normals and texture coordinates.
fn geometry(id: &str, primitives: &str) -> String {
    let positions = source("p", 3, "0 0 0 1 0 0 1 1 0 0 1 0 2 0.5 0.25");
    let normals = source("n", 3, "0 0 1 0 0 -1");
    let texcoords = source("t", 2, "0 0 1 0 1 1 0 1");
    format!(
        "<geometry id=\"{id}\" name=\"{id} name\"><mesh>\n{positions}{normals}{texcoords}\
         <vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>\n{primitives}</mesh></geometry>\n"
    )
}

const INPUTS: &str = "<input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>\
    <input semantic=\"NORMAL\" source=\"#n\" offset=\"1\"/>\
    <input semantic=\"TEXCOORD\" source=\"#t\" offset=\"2\" set=\"0\"/>";
const VERTEX: &str = "<input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>";
const SCENE: &str = "<scene><instance_visual_scene url=\"#s\"/></scene>";

fn file(content: &str) -> Vec<u8> {
    format!(
        "<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">\n\
         <asset><contributor><author>x</author></contributor><unit name=\"inch\" meter=\"0.0254\"/><up_axis>Z_UP</up_axis></asset>\n\
         {content}</COLLADA>\n"
    )
    .into_bytes()
}

/// A file of one geometry in one node.
fn plain(primitives: &str) -> Vec<u8> {
    let geometry = geometry("g", primitives);
    file(&format!(
        "<library_geometries>{geometry}</library_geometries><library_visual_scenes><visual_scene id=\"s\">\
         <node id=\"a\"><instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes>{SCENE}"
    ))
}

fn loaded(primitives: &str) -> Scene {
    load_scene(&plain(primitives), Format::Dae).0
}

#[test]
fn triangles_have_their_corners_values() {
    let bytes = plain(&format!(
        "<triangles count=\"2\">{INPUTS}<p>0 0 0 1 0 1 2 0 2\n0 1 0 2 1 2 3 1 3</p></triangles>"
    ));
    assert_eq!(Format::sniff(&bytes), Some(Format::Dae));
    let (scene, warnings) = load_scene(&bytes, Format::Dae);
    let part = &scene.parts[0];
    assert_eq!((&*part.name, part.mesh.positions().len()), ("g name", 5));
    assert_eq!(part.mesh.faces(), [[0, 1, 2], [0, 2, 3]]);
    let of = |semantic: &Semantic| part.mesh.attribute(semantic).expect("kept");
    let normals = of(&Semantic::Normal);
    assert_eq!(
        (normals.domain, normals.row(2), normals.row(3)),
        (Domain::Corner, &[0.0, 0.0, 1.0][..], &[0.0, 0.0, -1.0][..])
    );
    assert_eq!(of(&Semantic::TexCoord(0)).row(5), [0.0, 1.0]);
    let frame = scene.frame;
    assert_eq!((frame.up, frame.metres_per_unit), (Some(Axis::Z), Some(0.0254)));
    assert_eq!(frame.texture_origin, Some(TextureOrigin::LowerLeft));
    assert_eq!(warnings.iter().map(|w| w.code).collect::<Vec<_>>(), ["isolated-vertices"]);
}

#[test]
fn every_list_of_faces_is_read() {
    let of = |primitive: &str| loaded(primitive).parts[0].mesh.clone();
    let poly = of(&format!(
        "<polylist count=\"2\">{INPUTS}<vcount>4 3</vcount><p>0 0 0 1 0 1 2 0 2 3 0 3 1 1 1 4 1 2 2 1 3</p></polylist>"
    ));
    assert_eq!((poly.faces().len(), poly.faces()[2]), (3, [1, 4, 2]));
    // Each corner of a polygon keeps its own values, however it is cut.
    let texcoords = poly.attribute(&Semantic::TexCoord(0)).unwrap();
    for (corner, vertex) in poly.faces()[..2].as_flattened().iter().enumerate() {
        let p = poly.positions()[*vertex as usize];
        assert_eq!(texcoords.row(corner), &p[..2]);
    }
    let polygons = of(&format!("<polygons count=\"2\">{VERTEX}<p>0 1 2 3</p><p>1 4 2</p></polygons>"));
    assert_eq!(polygons.faces(), poly.faces());
    let strips = of(&format!("<tristrips count=\"2\">{VERTEX}<p>0 1 3 2</p><p>1 4 2</p></tristrips>"));
    assert_eq!(strips.faces(), [[0, 1, 3], [3, 1, 2], [1, 4, 2]]);
    let fans = of(&format!("<trifans count=\"1\">{VERTEX}<p>0 1 4 2 3</p></trifans>"));
    assert_eq!(fans.faces(), [[0, 1, 4], [0, 4, 2], [0, 2, 3]]);
    // Lists without values beside lists with values.
    let both = of(&format!(
        "<triangles>{VERTEX}<p>0 1 2</p></triangles><triangles>{INPUTS}<p>0 1 3 2 1 2 3 1 1</p></triangles>\
         <triangles>{VERTEX}<p>1 4 2</p></triangles>"
    ));
    let normals = both.attribute(&Semantic::Normal).unwrap();
    assert_eq!([0, 3, 6].map(|corner| normals.row(corner)[2]), [0.0, -1.0, 0.0]);
    assert_eq!(both.attribute(&Semantic::TexCoord(0)).unwrap().row(3), [0.0, 1.0]);
}

#[test]
fn nodes_place_and_share_geometries() {
    let geometry = geometry("g", &format!("<triangles>{VERTEX}<p>0 1 2</p></triangles>"));
    let content = format!(
        "<library_visual_scenes><visual_scene id=\"s\"><node id=\"a\" name=\"top\">\
         <translate>10 0 0</translate><rotate>0 0 1 90</rotate><scale>2 2 2</scale><instance_geometry url=\"#g\"/>\
         <node><matrix>1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1</matrix><instance_node url=\"#shared\"/></node></node>\
         </visual_scene></library_visual_scenes>\
         <library_nodes><node id=\"shared\"><instance_geometry url=\"#g\"/><instance_geometry url=\"#g\"/></node></library_nodes>\
         <library_geometries>{geometry}</library_geometries>{SCENE}"
    );
    let (scene, _) = load_scene(&file(&content), Format::Dae);
    assert_eq!((scene.parts.len(), scene.roots.len()), (1, 1));
    let world = scene.world_meshes().unwrap();
    let seconds: Vec<[f64; 3]> = world.iter().map(|(_, mesh)| mesh.positions()[1]).collect();
    assert_eq!(seconds, [[10.0, 2.0, 0.0], [-2.0, 12.0, 14.0], [-2.0, 12.0, 14.0]]);
    // x up: turned so that y is up.
    let text = String::from_utf8(file(&content)).unwrap().replace("Z_UP", "X_UP");
    let (scene, _) = load_scene(text.as_bytes(), Format::Dae);
    assert_eq!(scene.frame.up, Some(Axis::Y));
    assert_eq!(scene.world_meshes().unwrap()[0].1.positions()[1], [-2.0, 10.0, 0.0]);
}

#[test]
fn materials_have_their_diffuse_colour_and_the_name_of_its_picture() {
    let looks = "<library_images><image id=\"im\"><init_from>file:///C:/x/wood.png</init_from></image></library_images>\
        <library_effects><effect id=\"e\"><profile_COMMON><technique sid=\"c\"><lambert><diffuse><color>1 0.5 0 0.25</color></diffuse>\
        <ambient><color>1 1 1 1</color></ambient></lambert></technique></profile_COMMON></effect>\
        <effect id=\"f\"><profile_COMMON><newparam sid=\"su\"><surface type=\"2D\"><init_from>im</init_from></surface></newparam>\
        <newparam sid=\"sa\"><sampler2D><source>su</source></sampler2D></newparam><technique sid=\"c\"><phong><diffuse>\
        <texture texture=\"sa\" texcoord=\"T\"/></diffuse></phong></technique></profile_COMMON></effect></library_effects>\
        <library_materials><material id=\"m1\" name=\"paint\"><instance_effect url=\"#e\"/></material>\
        <material id=\"m2\"><instance_effect url=\"#f\"/></material></library_materials>";
    let geometry = geometry(
        "g",
        &format!(
            "<triangles material=\"A\">{VERTEX}<p>0 1 2</p></triangles><triangles material=\"B\">{VERTEX}<p>0 2 3</p></triangles>\
             <triangles>{VERTEX}<p>1 4 2</p></triangles>"
        ),
    );
    let bound = "<bind_material><technique_common><instance_material symbol=\"A\" target=\"#m2\"/>\
        <instance_material symbol=\"B\" target=\"#m1\"/></technique_common></bind_material>";
    let scene = format!(
        "<library_visual_scenes><visual_scene id=\"s\"><node><instance_geometry url=\"#g\">{bound}</instance_geometry></node>\
         <node><instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes>{SCENE}"
    );
    let bytes = file(&format!("{looks}<library_geometries>{geometry}</library_geometries>{scene}"));
    let (scene, warnings) = load_scene(&bytes, Format::Dae);
    let groups = scene.parts[0].mesh.attribute(&Semantic::Group("material".into())).unwrap();
    assert_eq!(groups.values, [2.0, 1.0, 0.0]);
    assert_eq!(scene.groups["material"], ["", "paint", "m2"]);
    let materials = &scene.assets.materials;
    assert_eq!(
        materials[0]["pbrMetallicRoughness"]["baseColorFactor"],
        serde_json::json!([1.0, 0.5, 0.0, 0.25])
    );
    assert_eq!(materials[1]["pbrMetallicRoughness"]["baseColorTexture"]["index"], 0);
    assert_eq!(scene.assets.images[0].content, ImageContent::Uri("wood.png".to_owned()));
    assert_eq!(["looks-skipped", "bindings-differ"].map(|code| count(&warnings, code)), [1, 1]);
}

#[test]
fn what_is_not_kept_is_named() {
    let geometry = geometry(
        "g",
        &format!("<triangles>{VERTEX}<p>0 1 2</p></triangles><lines>{VERTEX}<p>0 1</p></lines>"),
    );
    let content = format!(
        "<library_animations/><library_cameras/><library_geometries>{geometry}<geometry id=\"b\"><spline/></geometry></library_geometries>\
         <library_controllers><controller id=\"c\"><skin source=\"#g\"><joints/></skin></controller></library_controllers>\
         <library_visual_scenes><visual_scene id=\"s\"><node><instance_controller url=\"#c\"><skeleton>#j</skeleton></instance_controller>\
         <instance_geometry url=\"far.dae#g\"/></node></visual_scene></library_visual_scenes>{SCENE}"
    );
    let (scene, warnings) = load_scene(&file(&content), Format::Dae);
    assert_eq!(scene.nodes[0].part, Some(0));
    let codes = [
        "animations-skipped",
        "cameras-and-lights-skipped",
        "lines-skipped",
        "geometries-skipped",
        "controllers-skipped",
        "external-skipped",
        "objects-not-shown",
    ];
    assert_eq!(codes.map(|code| count(&warnings, code)), [1; 7]);
    let skins = warnings.iter().find(|w| w.code == "controllers-skipped").unwrap();
    assert!(skins.message.contains("'c'"), "{}", &*skins.message);
}

#[test]
fn files_that_lie_are_one_error_at_their_place() {
    let text = String::from_utf8(plain(&format!(
        "<polylist>{INPUTS}<vcount>3</vcount><p>0 0 0 1 0 1\n2 0 2</p></polylist>"
    )))
    .unwrap();
    load_scene(text.as_bytes(), Format::Dae);
    for (from, to, code) in [
        ("<p>0 0", "<p>9 0", "index-out-of-range"),
        ("<p>0 0", "<p>0 2", "index-out-of-range"),
        ("<p>0 0", "<p>-1 0", "not-a-number"),
        ("<p>0 0", "<p>4294967295 0", "not-a-number"),
        ("<p>0 0", "<p>x 0", "not-a-number"),
        ("<p>0 0", "<p>0", "truncated"),
        ("<vcount>3", "<vcount>99999999999", "truncated"),
        ("<vcount>3", "<vcount>-3", "not-a-number"),
        ("2 0.5 0.25", "2 0.5", "truncated"),
        ("2 0.5 0.25", "2 0.5 nan", "not-finite"),
        ("2 0.5 0.25", "2 0.5 0,25", "not-a-number"),
        ("count=\"5\"", "count=\"5000000000\"", "truncated"),
        ("count=\"5\"", "count=\"-5\"", "count-out-of-range"),
        ("stride=\"3\"", "stride=\"0\"", "truncated"),
        ("stride=\"3\"", "stride=\"18446744073709551615\"", "count-out-of-range"),
        ("offset=\"2\"", "offset=\"99999999999\"", "too-many-inputs"),
        ("source=\"#p\"", "source=\"#q\"", "missing-source"),
        ("source=\"#n\"", "source=\"#q\"", "missing-source"),
        ("source=\"#v\"", "source=\"#q\"", "missing-source"),
        ("\"VERTEX\"", "\"VERTICES\"", "no-vertices-input"),
        ("url=\"#g\"", "url=\"#h\"", "missing-object"),
        ("url=\"#s\"", "url=\"#t\"", "missing-object"),
        ("meter=\"0.0254\"", "meter=\"0\"", "unknown-unit"),
        ("Z_UP", "W_UP", "unknown-value"),
        ("<node id=\"a\">", "<node id=\"a\"><translate>1 2</translate>", "bad-transform"),
        ("<node id=\"a\">", "<node id=\"a\"><rotate>0 0 0 5</rotate>", "bad-transform"),
        ("<node id=\"a\">", "<node id=\"a\"><skew>1</skew>", "unsupported-transform"),
        ("<node id=\"a\">", "<node id=\"a\"><instance_node url=\"#a\"/>", "node-loop"),
        ("<node id=\"a\">", "<node id=\"a\"><instance_node url=\"#b\"/>", "missing-object"),
        ("</geometry>", "</geometry><geometry id=\"g\"/>", "duplicate-id"),
        ("<COLLADA", "<!DOCTYPE x [<!ENTITY a \"b\">]><COLLADA", "dtd-not-allowed"),
        ("<scene>", "<scene", "not-xml"),
    ] {
        assert!(text.contains(from), "{from}");
        let error = refuse(text.replacen(from, to, 1).as_bytes(), Format::Dae);
        assert_eq!(error.code, code, "{to}: {error}");
    }
    let error = refuse(text.replacen("\n2 0 2", "\n2 z 2", 1).as_bytes(), Format::Dae);
    assert!(matches!(error.place, FileLocation::LineColumn { column: 3, .. }), "{error}");
    assert_eq!(refuse(b"<collada/>", Format::Dae).code, "not-collada");
    let limits = Limits { rows: 4, ..Limits::default() };
    assert_eq!(read(text.as_bytes(), Format::Dae, &limits).unwrap_err().code, "truncated");
}

#[test]
fn nodes_of_nodes_do_not_grow_without_limit() {
    let doubled = |n: u32| {
        let each: String = (1..n)
            .map(|i| {
                format!(
                    "<node id=\"k{i}\"><instance_node url=\"#k{0}\"/><instance_node url=\"#k{0}\"/></node>",
                    i - 1
                )
            })
            .collect();
        let top = n - 1;
        file(&format!(
            "<library_nodes><node id=\"k0\"/>{each}</library_nodes><library_visual_scenes><visual_scene id=\"s\">\
             <node><instance_node url=\"#k{top}\"/></node></visual_scene></library_visual_scenes>{SCENE}"
        ))
    };
    assert_eq!(load_scene(&doubled(10), Format::Dae).0.nodes.len(), 1 << 10);
    assert_eq!(refuse(&doubled(60), Format::Dae).code, "too-many-copies");
}
