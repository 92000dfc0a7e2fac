//! The text form: prims, composition, transforms, meshes, cages.
use super::{TRIANGLE, codes, file, polygons, read, scene, triangle};
use chordal::explicit::subdivision::{Boundary, LinearTexcoords, Scheme};
use chordal::explicit::{Domain, Semantic};
use chordal_io::{Axis, Content, Limits, PolygonSurface, usd};

#[test]
fn a_mesh_is_a_part_below_the_nodes_above_it() {
    let text = file(&format!(
        "def Xform \"A\" (displayName = \"The A\") {{ double3 xformOp:translate = (1, 2, 3)
        uniform token[] xformOpOrder = [\"xformOp:translate\"] {} def Scope \"Empty\" {{}} }}",
        triangle("m")
    ));
    let scene = scene(&text);
    assert_eq!((scene.frame.up, scene.frame.metres_per_unit), (Some(Axis::Z), Some(1.0)));
    assert_eq!(scene.nodes.len(), 2, "what shows nothing has no node");
    assert_eq!((&*scene.nodes[0].name, &*scene.nodes[1].name), ("The A", "m"));
    assert_eq!(scene.world_meshes().unwrap()[0].1.positions()[1], [2.0, 2.0, 3.0]);
}

#[test]
fn comments_quotes_and_separators_are_as_usd_has_them() {
    let text = "#usda 1.0\n(\n 'a doc' doc = \"\"\"three\n\"quotes\" \"\"\"; upAxis = 'Y' customLayerData = { dictionary d = { int a = 1 } }\n)\n\
        /* def */ def Mesh 'm' ( # comment\n kind = \"x\"; assetInfo = { asset a = @@@x@y@@@ } )\n{ // more\n \
        custom string note = \"a \\\"b\\\" \\x41\" ( doc = \"d\" )\n".to_owned()
        + TRIANGLE
        + "; uniform token purpose = \"default\"; rel foo = [</a>, </b.c>]; int other.timeSamples = { 1: 2, 3: 4, }\n}";
    assert_eq!(scene(&text).parts[0].mesh.faces(), [[0, 1, 2]]);
    assert_eq!(codes(&text), ["no-unit", "attributes-skipped"]);
}

#[test]
fn operations_of_a_transform_are_applied_from_the_last_to_the_first() {
    let at = |order: &str| {
        let text = file(&format!(
            "def Mesh \"m\" {{ {TRIANGLE} double3 xformOp:translate = (10, 0, 0)
            double3 xformOp:translate:pivot = (1, 0, 0) float3 xformOp:rotateXYZ = (90, 0, 90) float3 xformOp:scale = (2, 4, 8)
            quatf xformOp:orient = (0, 0, 0, 1) float xformOp:rotateZ = 90
            matrix4d xformOp:transform = ((1,0,0,0),(0,1,0,0),(0,0,1,0),(5,6,7,1))
            uniform token[] xformOpOrder = [{order}] }}"
        ));
        scene(&text).world_meshes().unwrap()[0].1.positions()[1]
    };
    assert_eq!(at("\"xformOp:translate\", \"xformOp:scale\""), [12.0, 0.0, 0.0]);
    assert_eq!(at("\"xformOp:scale\", \"xformOp:translate\""), [22.0, 0.0, 0.0]);
    assert_eq!(at("\"xformOp:rotateXYZ\""), [0.0, 1.0, 0.0], "x turns first and leaves the point");
    assert_eq!(at("\"xformOp:orient\""), [-1.0, 0.0, 0.0]);
    assert_eq!(
        at("\"xformOp:translate:pivot\", \"xformOp:rotateZ\", \"!invert!xformOp:translate:pivot\""),
        [1.0, 0.0, 0.0]
    );
    assert_eq!(at("\"!invert!xformOp:scale\", \"!invert!xformOp:transform\""), [-2.0, -1.5, -0.875]);
    assert_eq!(at("\"!invert!xformOp:rotateXYZ\""), [0.0, 0.0, 1.0]);
}

#[test]
fn a_reset_transform_does_not_go_through_the_parents() {
    let inner = format!(
        "def Mesh \"m\" {{ {TRIANGLE} double3 xformOp:translate = (0, 0, 7)
        uniform token[] xformOpOrder = [\"!resetXformStack!\", \"xformOp:translate\"] }}"
    );
    let text = file(&format!(
        "def Xform \"A\" {{ double3 xformOp:translate = (9, 9, 9) uniform token[] xformOpOrder = [\"xformOp:translate\"] {inner} }}"
    ));
    assert_eq!(scene(&text).world_meshes().unwrap()[0].1.positions()[0], [0.0, 0.0, 7.0]);
}

#[test]
fn left_handed_faces_are_turned_over_with_their_corners() {
    let quad = "uniform token subdivisionScheme = \"none\" uniform token orientation = \"leftHanded\"
        point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)] int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] (interpolation = \"faceVarying\")";
    let scene = scene(&file(&format!("def Mesh \"m\" {{ {quad} }}")));
    let mesh = &scene.parts[0].mesh;
    for corners in [mesh.corners(0), mesh.corners(1)] {
        let [a, b, c] = corners;
        assert!((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) < 0.0);
    }
    let st = mesh.attribute(&Semantic::TexCoord(0)).unwrap();
    for vertex in 0..4 {
        assert_eq!(st.row(vertex), &mesh.positions()[vertex][..2]);
    }
}

#[test]
fn values_belong_to_points_faces_corners_or_all() {
    let quads = "uniform token subdivisionScheme = \"none\"
        point3f[] points = [(0,0,0),(1,0,0),(2,0,0),(0,1,0),(1,1,0),(2,1,0)] int[] faceVertexCounts = [4, 3]
        int[] faceVertexIndices = [0, 1, 4, 3, 1, 2, 4]\n";
    let of =
        |values: &str| scene(&file(&format!("def Mesh \"m\" {{ {quads} {values} }}"))).parts.remove(0).mesh;
    let mesh = of("color3f[] primvars:displayColor = [(1,0,0),(0,1,0)] (interpolation = \"uniform\")");
    let color = mesh.attribute(&Semantic::Color(0)).unwrap();
    assert_eq!(
        (color.domain, &color.values[..]),
        (Domain::Face, &[1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0][..])
    );
    let mesh = of("color3f[] primvars:displayColor = [(0,0,1)] float[] primvars:displayOpacity = [0.5]");
    assert_eq!(mesh.attribute(&Semantic::Color(0)).unwrap().row(5), [0.0, 0.0, 1.0, 0.5]);
    let mesh = of("normal3f[] normals = [(0,0,1),(1,0,0),(0,0,1),(0,0,1),(0,1,0),(0,0,1)]");
    assert_eq!(mesh.attribute(&Semantic::Normal).unwrap().row(4), [0.0, 1.0, 0.0]);
    assert_eq!(mesh.position_id(), None);
    // The corners at points 1 and 4 of the two faces differ.
    let mesh = of("texCoord2f[] primvars:st = [(0,0),(1,1),(2,2)] (interpolation = \"faceVarying\")
        int[] primvars:st:indices = [0, 0, 0, 0, 1, 1, 0]");
    assert_eq!((mesh.positions().len(), mesh.n_positions()), (7, 6));
    assert_eq!(mesh.attribute(&Semantic::TexCoord(0)).unwrap().row(6), [1.0, 1.0]);
    // Values without indices are the same where they have the same bits.
    let mesh = of(
        "texCoord2f[] primvars:map = [(0,0),(0,0),(0,0),(0,0),(1,1),(1,1),(0,0)] (interpolation = \"faceVarying\")",
    );
    assert_eq!(mesh.positions().len(), 7);
}

#[test]
fn values_that_do_not_fit_are_left_out_by_name() {
    let with = |values: &str| codes(&file(&format!("def Mesh \"m\" {{ {TRIANGLE} {values} }}")));
    assert_eq!(with("texCoord2f[] primvars:st = [(0,0)] (interpolation = \"vertex\")"), ["primvars-skipped"]);
    assert_eq!(
        with("color3f[] primvars:displayColor = [(0,0,1)] (interpolation = \"odd\")"),
        ["primvars-skipped"]
    );
    assert_eq!(with("float[] primvars:heat = [1, 2, 3]"), ["primvars-unread"]);
    assert_eq!(with("vector3f[] velocities = [(1,2,3)]"), ["attributes-skipped"]);
    assert_eq!(with("float[] primvars:displayOpacity = [0.5]"), ["opacity-skipped"]);
    assert_eq!(with("int[] holeIndices = [0]"), ["holes-skipped"]);
}

#[test]
fn what_is_no_mesh_or_not_shown_is_counted_by_its_type() {
    let text = file(&format!(
        "def Sphere \"s\" {{}} def Camera \"c\" {{}} def Sphere \"t\" {{}} {} {} {} {} over \"o\" {{ {} }} class \"k\" {{ {} }}",
        triangle("shown"),
        triangle("a").replace("{ uniform", "{ token visibility = \"invisible\"\n uniform"),
        triangle("b").replace("{ uniform", "{ uniform token purpose = \"proxy\"\n uniform"),
        triangle("d").replace("\"d\"", "\"d\" (active = false)"),
        triangle("e"),
        triangle("f"),
    ));
    assert_eq!(scene(&text).parts.len(), 1);
    let outcome = read(&text);
    let first = &outcome.warnings[0];
    assert_eq!((first.code, first.count), ("prims-skipped", 3));
    assert!(first.message.contains("1 Camera (first /c), 2 Sphere (first /s)"), "{}", first.message);
    let rest: Vec<_> = outcome.warnings[1..].iter().map(|warning| warning.code).collect();
    assert_eq!(rest, ["invisible-prims", "purpose-skipped", "inactive-prims"]);
}

#[test]
fn references_classes_and_variants_are_composed() {
    let text = file(&format!(
        "def Xform \"A\" (inherits = </Class>) {{}} def Xform \"B\" (prepend references = </A>) {{ over \"m\" {{ token visibility = \"invisible\" }} }}
        class Xform \"Class\" {{ {} }}
        def Xform \"V\" (variants = {{ string size = \"two\" }} prepend variantSets = \"size\") {{
            variantSet \"size\" = {{ \"one\" {{ {} }} \"two\" {{ {} {} }} }} }}",
        triangle("m"),
        triangle("x"),
        triangle("y"),
        triangle("z")
    ));
    let scene = scene(&text);
    let names: Vec<&str> = scene
        .world_meshes()
        .unwrap()
        .iter()
        .map(|(name, _)| *name)
        .map(|name| name.to_owned().leak() as &str)
        .collect();
    assert_eq!(names, ["m", "y", "z"]);
    assert_eq!(codes(&text), ["invisible-prims", "variants-skipped"]);
    let none = text.replace("variants = { string size = \"two\" }", "");
    assert!(codes(&none).contains(&"variants-unset"));
}

#[test]
fn prims_that_refer_to_one_mesh_share_its_part() {
    let text = file(&format!(
        "{} def Mesh \"n\" (inherits = </m>) {{ double3 xformOp:translate = (0, 0, 1) uniform token[] xformOpOrder = [\"xformOp:translate\"] }}
        def Mesh \"o\" (references = </m>) {{ point3f[] points = [(5, 0, 0), (6, 0, 0), (5, 1, 0)] }}",
        triangle("m")
    ));
    let scene = scene(&text);
    assert_eq!(scene.nodes.iter().map(|node| node.part).collect::<Vec<_>>(), [Some(0), Some(0), Some(1)]);
    assert_eq!(scene.parts[1].mesh.positions()[0], [5.0, 0.0, 0.0]);
}

#[test]
fn points_of_an_instancer_are_nodes_with_the_prototype_below() {
    let text = file(&format!(
        "def PointInstancer \"p\" {{ rel prototypes = [</p/a>, </p/b>] int[] protoIndices = [1, 0, 1]
        point3f[] positions = [(1, 0, 0), (2, 0, 0), (3, 0, 0)] quath[] orientations = [(1, 0, 0, 0), (0, 0, 0, 1), (1, 0, 0, 0)]
        float3[] scales = [(1, 1, 1), (1, 1, 1), (2, 2, 2)] {} {} }}",
        triangle("a"),
        triangle("b")
    ));
    let scene = scene(&text);
    let world = scene.world_meshes().unwrap();
    let found: Vec<_> = world.iter().map(|(name, mesh)| ((*name).to_owned(), mesh.positions()[1])).collect();
    let expected = [("b", [2.0, 0.0, 0.0]), ("a", [1.0, 0.0, 0.0]), ("b", [5.0, 0.0, 0.0])];
    assert_eq!(found, expected.map(|(name, at)| (name.to_owned(), at)));
    assert_eq!(scene.parts.len(), 2);
}

#[test]
fn of_values_over_time_the_first_is_taken() {
    let text = file(&format!(
        "def Mesh \"m\" {{ {TRIANGLE} double3 xformOp:translate.timeSamples = {{ 1: (1, 2, 3), 2.5: (4, 5, 6) }}
        uniform token[] xformOpOrder = [\"xformOp:translate\"] }}"
    ));
    assert_eq!(scene(&text).nodes[0].matrix[12..15], [1.0, 2.0, 3.0]);
    assert_eq!(codes(&text), ["time-samples"]);
}

const CUBE: &str =
    "point3f[] points = [(-1,-1,1),(1,-1,1),(-1,1,1),(1,1,1),(-1,1,-1),(1,1,-1),(-1,-1,-1),(1,-1,-1)]
    int[] faceVertexCounts = [4, 4, 4, 4, 4, 4]
    int[] faceVertexIndices = [0,1,3,2, 2,3,5,4, 4,5,7,6, 6,7,1,0, 1,7,5,3, 6,0,2,4]\n";

#[test]
fn a_mesh_that_is_subdivided_is_a_cage_with_its_tags() {
    let tags = "int[] creaseIndices = [0, 1, 3, 4, 5] int[] creaseLengths = [3, 2] float[] creaseSharpnesses = [2.5, 10]
        int[] cornerIndices = [6] float[] cornerSharpnesses = [1.5] int[] holeIndices = [5]
        uniform token interpolateBoundary = \"edgeOnly\" uniform token faceVaryingLinearInterpolation = \"boundaries\"
        texCoord2f[] primvars:st = [(0,0),(1,0),(1,1),(0,1)] (interpolation = \"faceVarying\")
        int[] primvars:st:indices = [0,1,2,3, 0,1,2,3, 0,1,2,3, 0,1,2,3, 0,1,2,3, 0,1,2,3]";
    let found = polygons(&file(&format!("def Mesh \"m\" {{ {CUBE} {tags} }}")));
    let cage = &found.cage;
    assert_eq!((cage.scheme(), cage.boundary()), (Scheme::CatmullClark, Boundary::EdgeOnly));
    assert_eq!(cage.creases(), [([0, 1], 2.5), ([1, 3], 2.5), ([4, 5], 10.0)]);
    assert_eq!((cage.sharp_vertices(), cage.holes()), (&[(6, 1.5)][..], &[5][..]));
    let st = cage.texcoords().unwrap();
    assert_eq!((st.linear, st.values.len(), st.corners.len()), (LinearTexcoords::Boundaries, 4, 24));
    // One sharpness for each edge instead of each crease.
    let by_edge = tags.replace("[2.5, 10]", "[1, 2, 3]");
    let cage = polygons(&file(&format!("def Mesh \"m\" {{ {CUBE} {by_edge} }}"))).cage;
    assert_eq!(cage.creases(), [([0, 1], 1.0), ([1, 3], 2.0), ([4, 5], 3.0)]);
}

#[test]
fn cages_are_one_where_they_have_the_same_rules() {
    let two = file(&format!(
        "def Mesh \"a\" {{ {CUBE} }} def Mesh \"b\" {{ {CUBE} float3 xformOp:scale = (-1, 1, 1) uniform token[] xformOpOrder = [\"xformOp:scale\"]
        int[] creaseIndices = [0, 1] int[] creaseLengths = [2] float[] creaseSharpnesses = [3] }}"
    ));
    let found = polygons(&two);
    assert_eq!((found.cage.positions().len(), found.cage.n_faces()), (16, 12));
    assert_eq!(found.cage.creases(), [([8, 9], 3.0)]);
    assert_eq!(found.cage.face(6), [8, 10, 11, 9], "a mirror turns faces over");
    assert_eq!(found.groups["o"], ["", "a", "b"]);
    let mixed = format!("{two} {}", triangle("t"));
    assert_eq!(scene(&mixed).parts.len(), 3);
    assert!(codes(&mixed).contains(&"subdivision-skipped"));
    let limits = Limits { surface: Some(PolygonSurface::Faceted), ..Limits::default() };
    let Content::Scene(scene) = usd::read(two.as_bytes(), &limits).unwrap().content else {
        panic!("triangles")
    };
    assert_eq!(scene.parts[1].mesh.faces().len(), 12);
    let limits = Limits { surface: Some(PolygonSurface::Limit(Scheme::CatmullClark)), ..Limits::default() };
    let one = file(&triangle("t"));
    assert!(matches!(usd::read(one.as_bytes(), &limits).unwrap().content, Content::Polygons(_)));
}

#[test]
fn what_is_inherited_deleted_or_empty_is_said() {
    let inherited =
        format!("def Xform \"a\" {{ color3f[] primvars:displayColor = [(1, 0, 0)]\n{} }}", triangle("m"));
    assert_eq!(codes(&file(&inherited)), ["inherited-primvars"]);
    let deleted = format!("def Xform \"a\" ( delete references = </b> ) {{ {} }}", triangle("m"));
    assert_eq!(codes(&file(&deleted)), ["deletions-ignored"]);
    let empty = format!("def Xform \"a\" {{ def Xform \"place\" {{}}\n{} }}", triangle("m"));
    assert_eq!(codes(&file(&empty)), ["empty-nodes"]);
    let plain = format!("def Xform \"a\" {{ {} }}", triangle("m"));
    assert_eq!(codes(&file(&plain)), [""; 0]);
}
