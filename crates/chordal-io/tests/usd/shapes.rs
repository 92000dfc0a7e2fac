//! Curves and NURBS surfaces: where they are placed, what goes before what, and what is refused.
use super::{codes, error, file, read, scene, triangle};
use chordal::explicit::nurbs::NurbsSurface;
use chordal_io::{Axis, Content, Curves, Limits, usd};

fn curves(text: &str) -> Curves {
    match read(text).content {
        Content::Curves(curves) => curves,
        other => panic!("no curves: {other:?}"),
    }
}

fn surfaces(text: &str) -> Vec<NurbsSurface> {
    match read(text).content {
        Content::Surfaces(surfaces, frame) => {
            assert_eq!((frame.up, frame.metres_per_unit), (Some(Axis::Z), Some(1.0)));
            surfaces.iter().map(|face| face.surface().clone()).collect()
        }
        other => panic!("no surfaces: {other:?}"),
    }
}

fn basis_curves(name: &str, more: &str) -> String {
    format!(
        "def BasisCurves \"{name}\" {{ point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 1)] int[] curveVertexCounts = [4] {more} }}\n"
    )
}

/// A quarter of a cylinder of radius 2 around z, u along the arc, from z = 0 to z = 3.
const QUARTER: &str = "int uVertexCount = 3 int vVertexCount = 2 int uOrder = 3 int vOrder = 2
    double[] uKnots = [0, 0, 0, 1, 1, 1] double[] vKnots = [0, 0, 1, 1]
    point3f[] points = [(2, 0, 0), (2, 2, 0), (0, 2, 0), (2, 0, 3), (2, 2, 3), (0, 2, 3)]
    double[] pointWeights = [1, 0.7071067811865476, 1, 1, 0.7071067811865476, 1]\n";

fn patch(name: &str, more: &str) -> String {
    format!("def NurbsPatch \"{name}\" {{ {QUARTER} {more} }}\n")
}

#[test]
fn basis_curves_are_paths_where_nodes_place_them() {
    let text = file(&format!(
        "def Xform \"A\" {{ double3 xformOp:translate = (0, 0, 5) uniform token[] xformOpOrder = [\"xformOp:translate\"]
            {} {} }} {}",
        basis_curves("cubic", ""),
        basis_curves("lines", "uniform token type = \"linear\" uniform token wrap = \"periodic\""),
        basis_curves("two", "uniform token type = \"linear\"").replace("[4]", "[2, 2]"),
    ));
    let found = curves(&text);
    assert_eq!(codes(&text), [""; 0]);
    assert_eq!((found.frame.up, found.frame.metres_per_unit), (Some(Axis::Z), Some(1.0)));
    let names: Vec<_> = found.elements.iter().map(|element| (element.kind, &*element.name)).collect();
    assert_eq!(names, [("BasisCurves", "cubic"), ("BasisCurves", "lines"), ("BasisCurves", "two")]);
    assert_eq!(found.owners, [0, 1, 2, 2]);
    let path = &found.lines[0];
    assert_eq!((path.segments().len(), path.start(), path.end()), (1, [0.0, 0.0, 5.0], [0.0, 1.0, 6.0]));
    assert_eq!(path.at(0.5), [0.75, 0.5, 5.125]);
    assert_eq!((found.lines[1].segments().len(), found.lines[1].is_closed()), (4, true));
    assert_eq!((found.lines[2].end(), found.lines[3].start()), ([1.0, 0.0, 0.0], [1.0, 1.0, 0.0]));
}

#[test]
fn nurbs_curves_take_their_knots_in_turn() {
    let text = file(
        "def NurbsCurves \"n\" { point3f[] points = [(2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 1), (1, 0, 1)]
        int[] curveVertexCounts = [3, 2] int[] order = [3, 2] double[] knots = [0, 0, 0, 1, 1, 1, 5, 5, 7, 7]
        double2[] ranges = [(0, 1), (5, 6)] double[] pointWeights = [1, 0.7071067811865476, 1, 1, 1] }",
    );
    let found = curves(&text);
    assert_eq!(codes(&text), ["ranges-skipped"]);
    for i in 0..=8 {
        let [x, y, z] = found.lines[0].at(f64::from(i) / 8.0);
        assert!((x.hypot(y) - 2.0).abs() < 1e-14 && z == 0.0, "{x} {y} {z}");
    }
    assert_eq!((found.lines[1].start(), found.lines[1].at(0.5)), ([0.0, 0.0, 1.0], [0.5, 0.0, 1.0]));
}

#[test]
fn patches_are_surfaces_and_keep_their_front_under_a_mirror() {
    let found = surfaces(&file(&patch("p", "")));
    let normal = |surface: &NurbsSurface| {
        let [u, v] = surface.knots().each_ref().map(|knots| 0.5 * (knots.domain()[0] + knots.domain()[1]));
        let [o, u, v] = [[0.0, 0.0], [1e-6, 0.0], [0.0, 1e-6]].map(|[du, dv]| surface.at(u + du, v + dv));
        let [a, b] = [u, v].map(|p| [p[0] - o[0], p[1] - o[1], p[2] - o[2]]);
        // Along x and y together, which points away from the axis.
        let [x, y] = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2]];
        (o[0] * x + o[1] * y) > 0.0
    };
    let [x, y, z] = found[0].at(0.5, 0.5);
    assert!(
        (x - 2.0_f64.sqrt()).abs() < 1e-14 && (y - x).abs() < 1e-14 && (z - 1.5).abs() < 1e-14,
        "{x} {y} {z}"
    );
    assert_eq!(found[0].at(1.0, 0.0), [0.0, 2.0, 0.0]);
    assert!(normal(&found[0]));
    let left = surfaces(&file(&patch("p", "uniform token orientation = \"leftHanded\"")));
    assert!(!normal(&left[0]));
    assert_eq!((left[0].at(0.0, 0.0), left[0].at(-1.0, 0.0)), ([2.0, 0.0, 0.0], [0.0, 2.0, 0.0]));
    let mirror = "float3 xformOp:scale = (1, 1, -2) uniform token[] xformOpOrder = [\"xformOp:scale\"]";
    let mirrored = surfaces(&file(&patch("p", mirror)));
    assert!(normal(&mirrored[0]));
    let box_of = mirrored[0].bounds();
    assert!((box_of.min[2] + 6.0).abs() < 1e-12 && box_of.max[2].abs() < 1e-12, "{box_of:?}");
    assert_eq!(codes(&file(&patch("p", mirror))), ["transforms-applied"]);
    let trimmed = "int[] trimCurve:counts = [1] int[] trimCurve:orders = [2] uniform token uForm = \"open\"
        double2 uRange = (0, 1) double2 vRange = (0, 0.5)";
    assert_eq!(codes(&file(&patch("p", trimmed))), ["ranges-skipped", "trims-skipped"]);
}

#[test]
fn meshes_go_before_surfaces_and_these_before_curves() {
    let [mesh, surface, curve] = [triangle("m"), patch("s", ""), basis_curves("c", "")];
    let skipped = |text: &str| {
        let outcome = read(text);
        assert_eq!(outcome.warnings.len(), 1);
        (outcome.warnings[0].code, outcome.warnings[0].message.to_string())
    };
    let all = file(&format!("{curve}{surface}{mesh}"));
    assert_eq!(scene(&all).parts.len(), 1);
    let message = "prims that are no meshes were left out: 1 BasisCurves (first /c), 1 NurbsPatch (first /s)"
        .to_owned();
    assert_eq!(skipped(&all), ("prims-skipped", message));
    let two = file(&format!("{curve}{surface}def Sphere \"x\" {{}}"));
    assert_eq!(surfaces(&two).len(), 1);
    let message =
        "prims that are no NURBS surfaces were left out: 1 BasisCurves (first /c), 1 Sphere (first /x)"
            .to_owned();
    assert_eq!(skipped(&two), ("prims-skipped", message));
    // What guides the eye is left out as of meshes, and values of points with a note.
    let guide = file(
        &(basis_curves("g", "uniform token purpose = \"guide\"")
            + &basis_curves("c", "color3f[] primvars:displayColor = [(1, 0, 0)] float[] widths = [1]")),
    );
    assert_eq!(
        (curves(&guide).lines.len(), codes(&guide)),
        (1, vec!["attributes-skipped", "purpose-skipped", "shape-primvars-skipped"])
    );
}

#[test]
fn instances_of_curves_are_where_they_are_placed() {
    let text = file(&format!(
        "def PointInstancer \"i\" {{ rel prototypes = [</i/c>] int[] protoIndices = [0, 0] point3f[] positions = [(0, 0, 1), (0, 0, 2)] {} }}",
        basis_curves("c", "")
    ));
    let starts: Vec<_> = curves(&text).lines.iter().map(|path| path.start()[2]).collect();
    assert_eq!(starts, [1.0, 2.0]);
    let n = 3_000;
    let many = file(&format!(
        "def PointInstancer \"i\" {{ rel prototypes = [</i/c>] int[] protoIndices = [{}] point3f[] positions = [{}]
        def BasisCurves \"c\" {{ uniform token type = \"linear\" point3f[] points = [{}] int[] curveVertexCounts = [{n}] }} }}",
        "0,".repeat(n),
        "(0,0,0),".repeat(n),
        "(0,0,0),".repeat(n),
    ));
    assert!(error(&many).starts_with("too-many-copies at"));
}

#[test]
fn numbers_of_curves_and_surfaces_that_do_not_fit_are_named() {
    let message = |text: &str| usd::read(file(text).as_bytes(), &Limits::default()).unwrap_err().to_string();
    let counts = |counts: &str, more: &str| message(&basis_curves("c", more).replace("[4]", counts));
    assert_eq!(counts("[5]", ""), "line 6: /c: curves have 5 points in all, and 4 are there");
    assert_eq!(
        counts("[3, 1]", ""),
        "curveVertexCounts 0: /c: curve 0: it has 3 points, and its basis and wrap take 4 and 3 more for each other piece"
    );
    assert!(counts("[4, -1]", "").contains("/c: a curve has -1 points"));
    let bspline = "uniform token basis = \"bspline\"";
    assert!(counts("[2, 2]", bspline).ends_with("it has 2 points, and its basis and wrap take 4 or more"));
    assert!(
        counts("[4]", "uniform token basis = \"hermite\"").contains("the basis \"hermite\" and the wrap")
    );
    let far = basis_curves("c", bspline).replace("(1, 0, 0)", "(1e999, 0, 0)");
    assert!(message(&far).contains("is not finite"), "{}", message(&far));
    let wrong = |from: &str, to: &str| message(&patch("s", "").replacen(from, to, 1));
    assert_eq!(
        wrong("uOrder = 3", "uOrder = 1"),
        "line 6: /s: along u: its order 1 is no whole number from 2 on"
    );
    assert_eq!(wrong("int uOrder = 3", ""), "line 6: /s: there is no uOrder");
    assert_eq!(
        wrong("uVertexCount = 3", "uVertexCount = 4"),
        "line 6: /s: along u: 4 points, where the knots take 3"
    );
    assert_eq!(
        wrong("[0, 0, 1, 1]", "[0, 1, 0, 1]"),
        "line 6: /s: along v: knot 2 is less than the one before"
    );
    assert_eq!(wrong("pointWeights = [1,", "pointWeights = ["), "line 6: /s: 5 weights for 6 points");
    assert_eq!(wrong("pointWeights = [1,", "pointWeights = [0,"), "line 6: /s: weight 0 is not above 0");
    assert!(wrong("(2, 0, 0), ", "").starts_with("line 6: /s: "));
    let nurbs = "def NurbsCurves \"n\" { point3f[] points = [(0,0,0),(1,0,0)] int[] curveVertexCounts = [2] int[] order = [2] double[] knots = [0,0,1,1] }";
    assert_eq!(
        message(&nurbs.replace("[0,0,1,1]", "[0,0,1]")),
        "curveVertexCounts 0: /n: curve 0: its 2 points take 4 knots, and 3 are left"
    );
    assert_eq!(message(&nurbs.replace("order = [2]", "order = []")), "line 6: /n: 0 orders for 1 curves");
    assert_eq!(codes(&file("def NurbsCurves \"n\" {}")), ["empty-shapes"]);
}
