//! Parts that somebody might print, at lengths that a printer or a shop asks for: each is a proved mesh.
use crate::common;
use chordal_testkit::some;
use common::{Folder, run};

/// A script, a length, and the most triangles.
type Part = (&'static str, &'static str, u64);

const PARTS: [Part; 10] = [
    // The cells of an extrusion are long: vertices beside the bore have to be found nevertheless.
    ("box(4, 4, 2) - move(cylinder(0.4, 4), 1.5, 0, 0)", "0.02%", 500),
    (
        "disc = cylinder(40, 8) | move(cylinder(18, 24), 0, 0, 8)\n\
         disc - cylinder(10, 100) - polar(move(cylinder(3.3, 30), 30, 0), 6)",
        "0.02%",
        5000,
    ),
    (
        "base = move(box(60, 40, 5), 0, 0, 2.5) | move(box(5, 40, 40), -27.5, 0, 20)\n\
         base - linear(move(cylinder(2.2, 20), 0, -12, 0), 2, 0, 24) - rotate_y(move(cylinder(4, 80), -25, 0), 90)",
        "0.1%",
        600,
    ),
    ("(cylinder(12, 14) - polar(move(cylinder(1.5, 20), 12.5, 0), 16)) - cylinder(3, 40)", "0.1%", 2000),
    (
        "t = lambda r: cylinder(r, 60) | move(rotate_y(cylinder(r, 30), 90), 15, 0, 0)\nt(8) - t(6)",
        "0.02%",
        3000,
    ),
    // Nine capsules share a ball.
    ("union([capsule([0, 0, 0], [cos(40*i)*10, sin(40*i)*10, 6], 1.2) for i in range(9)])", "0.1%", 5000),
    // 0.4 - 0.1 is more than 0.3, as numbers go: the parts are meant to touch.
    ("cylinder(6, 4) - thread('M8', 9)", "0.5%", 1500),
    ("box(1, 1, 0.6) | move(box(0.5, 0.5, 0.2), 0, 0, 0.4)", "0.1%", 60),
    ("box(1, 1, 0.6) | move(cylinder(0.3, 0.2), 0, 0, 0.4)", "0.1%", 500),
    ("(box(30, 20, 0.3) | move(box(3, 20, 0.7), 0, 0, 0.5)) - move(cylinder(2, 9), 9, 0, 0)", "0.02%", 1000),
];

#[test]
fn parts_to_print_are_proved() {
    let folder = Folder::new("everyday");
    let output = folder.text("part.stl");
    for (script, length, most) in some(PARTS, 3) {
        let input = folder.file("part.star", script);
        let made = run(&["mesh", &input, "--tol", length, "-o", &output, "--force", "--json"]);
        assert_eq!(made.code, 0, "{script}: {made:?}");
        let certificate = made.report()["certificate"].take();
        let valid = &certificate["valid"];
        assert!(valid["closed"] == true && valid["manifold"] == true, "{script}: {valid:#}");
        let [wanted, at_most] = [&certificate["budget"]["length"], &certificate["bound"]["at_most"]]
            .map(|x| x.as_f64().expect("a length"));
        assert!(
            certificate["bound"]["evidence"] == "proved" && at_most <= wanted,
            "{script}: {certificate:#}"
        );
        let triangles = certificate["output"]["triangles"].as_u64().expect("a count");
        assert!(triangles <= most, "{script}: {triangles}");
    }
}
