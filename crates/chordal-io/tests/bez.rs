//! Geomview's Bézier patches: what is read, and what a hostile file may try.
use crate::common::{count, refuse};
use chordal::Patch;
use chordal::explicit::nurbs::NurbsSurface;
use chordal_io::{Content, FileLocation, Format, Frame, Limits, Warning, read};

/// Sixteen different points, row by row.
const POINTS: &str = "0 0 0  1 0 0.5  2 0 0.25  3 0 0
    0 1 1  1 1 2  2 1 2  3 1 1 # the second row
    0 2 1  1 2 2  2 2 2  3 2 1
    0 3 0  1 3 0.5  2 3 0.25  3 3 -0.125\n";

fn patches(text: &[u8]) -> (Vec<Patch>, Vec<Warning>) {
    assert_eq!(Format::sniff(text), Some(Format::Bez));
    let loaded = read(text, Format::Bez, &Limits::default()).unwrap();
    let Content::Patches(patches, frame) = loaded.content else { panic!("no patches") };
    assert_eq!(frame, Frame::default());
    (patches, loaded.warnings)
}

fn surfaces(text: &[u8]) -> (Vec<NurbsSurface>, Vec<Warning>) {
    let loaded = read(text, Format::Bez, &Limits::default()).unwrap_or_else(|e| panic!("{e}"));
    let Content::Surfaces(surfaces, _) = loaded.content else { panic!("no surfaces") };
    (surfaces.iter().map(|face| face.surface().clone()).collect(), loaded.warnings)
}

#[test]
fn every_spelling_of_bicubic_patches_is_one_shape() {
    let (expected, warnings) = patches(format!("BBP\n{POINTS}").as_bytes());
    assert_eq!((expected.len(), warnings.len()), (1, 0));
    assert_eq!(expected[0].control[1], [[0.0, 1.0, 1.0], [1.0, 1.0, 2.0], [2.0, 1.0, 2.0], [3.0, 1.0, 1.0]]);
    assert_eq!(expected[0].control[3][3], [3.0, 3.0, -0.125]);
    for keyword in ["BEZ333", "BEZ 3 3 3", "# a comment\n\nBBP#\n", "\u{feff}BBP\r\n"] {
        assert_eq!(
            patches(format!("{keyword} {POINTS}").as_bytes()),
            (expected.clone(), vec![]),
            "{keyword}"
        );
    }
    // A brace around it, a keyword between patches.
    let text = format!("{{ = BBP {POINTS} {POINTS} BEZ333 {POINTS} }}");
    let loaded = read(text.as_bytes(), Format::Bez, &Limits::default()).unwrap();
    let Content::Patches(three, _) = loaded.content else { panic!("no patches") };
    assert_eq!(three, vec![expected[0]; 3]);
    // Big-endian, and every number here fits single precision.
    let mut binary = b"BBP BINARY\n".to_vec();
    for x in expected[0].control.as_flattened().as_flattened() {
        binary.extend((*x as f32).to_be_bytes());
    }
    assert_eq!(patches(&binary).0, expected);
}

#[test]
fn values_of_corners_are_left_out_and_said() {
    let (with, warnings) =
        patches(format!("STBBP {POINTS} 0 0 0 1 1 0 1 1 {POINTS} 0 0 0 1 1 0 1 1").as_bytes());
    assert_eq!((with.len(), count(&warnings, "corner-values-skipped")), (2, 2));
    let colours = "1 0 0 1 ".repeat(4);
    let text = format!(
        "appearance {{ +texturing texture {{ file a.pgm }} }}\nCBEZ333_ST {POINTS} 0 0 0 1 1 0 1 1 {colours}"
    );
    let loaded = read(text.as_bytes(), Format::Bez, &Limits::default()).unwrap();
    assert_eq!(count(&loaded.warnings, "appearance-skipped"), 1);
    assert_eq!(count(&loaded.warnings, "corner-values-skipped"), 1);
}

/// A torus around the y axis of four biquadratic patches, each with middle control points at infinity: a quarter of a
/// ring by half a tube each. Its truth is known in closed form.
#[test]
fn a_torus_of_half_circles_is_one() {
    let (ring, tube) = (2.0, 0.5);
    let mut text = String::from("BEZ224\n");
    for side in [1.0, -1.0] {
        for half in [1.0, -1.0] {
            // Half of the ring, u = (1, 0, -1) and (0, side, 0) at infinity; of the tube the outer or the inner half.
            for (radius, height, w) in [(ring, tube, 1.0), (half * tube, 0.0, 0.0), (ring, -tube, 1.0)] {
                text += &format!(
                    "{radius} {height} 0 {w}  0 0 {} 0  {} {height} 0 {w}\n",
                    side * radius,
                    -radius
                );
            }
        }
    }
    let (found, warnings) = surfaces(text.as_bytes());
    assert_eq!((found.len(), warnings.len()), (4, 0));
    for surface in &found {
        for [x, y, z] in surface.lattice(8) {
            let off = (x.hypot(z) - ring).hypot(y) - tube;
            assert!(off.abs() < 1e-14, "{x} {y} {z}: {off}");
        }
    }
    // Both sides and both halves.
    let z_of = |k: usize| found[k].at(0.5, 0.5)[2];
    assert_eq!([z_of(0), z_of(1), z_of(2), z_of(3)], [2.5, 1.5, -2.5, -1.5]);
}

#[test]
fn degrees_may_differ_and_patches_be_mixed() {
    let text = format!("BBP {POINTS} BEZ214 0 0 0 1 1 1 0 1 2 0 0 1 0 0 1 1 2 2 2 2 2 0 1 1");
    let (found, _) = surfaces(text.as_bytes());
    let degrees = |k: usize| found[k].knots().each_ref().map(chordal::explicit::nurbs::KnotVector::degree);
    assert_eq!((found.len(), degrees(0), degrees(1)), (2, [3, 3], [2, 1]));
    assert_eq!(found[0].at(0.0, 1.0), [0.0, 3.0, 0.0]);
    assert_eq!((found[1].at(1.0, 0.0), found[1].at(0.0, 1.0)), ([2.0, 0.0, 0.0], [0.0, 0.0, 1.0]));
    assert_eq!(found[1].control()[4], [1.0, 1.0, 1.0]);
}

#[test]
fn errors_name_the_line_and_what_is_read() {
    let cases = [
        ("BEZ033 1".to_owned(), 1, "along u: the degree is 0, and must be from 1 to 30"),
        ("BEZ 3 31 3 1".to_owned(), 1, "along v: the degree is 31, and must be from 1 to 30"),
        ("BEZ 3 -1 3 1".to_owned(), 1, "the degree along v: '-1' is not a whole number from 0 on"),
        ("BEZ 3".to_owned(), 1, "the file ends before the degree along v"),
        ("BEZ335 1".to_owned(), 1, "5 coordinates of a control point, where 3 or, with a weight, 4 are read"),
        ("LIST { }".to_owned(), 1, "'LIST' is no keyword of Bézier patches, such as BBP or BEZ224"),
        ("# x".to_owned(), 1, "the file ends before the keyword, such as BBP or BEZ224"),
        ("appearance { {".to_owned(), 1, "the file ends before the closing brace of the appearance"),
        (format!("BBP\n{POINTS} 1 2"), 6, "the file ends before coordinate z of point 0 of patch 1"),
        (
            format!("BBP\n{}", POINTS.replacen("2 0 0.25", "2 x 0.25", 1)),
            2,
            "coordinate y of point 2 of patch 0: 'x' is not a number",
        ),
        (
            format!("BBP\n{}", POINTS.replace("-0.125", "1e999")),
            5,
            "coordinate z of point 15 of patch 0: coordinate '1e999' is not finite, or over the limit of 1.8e308",
        ),
        (format!("STBBP\n{POINTS}0 0 1\n"), 6, "the file ends before texture coordinate 3 of patch 0"),
        (
            "BEZ114\n0 0 0 1\n1 0 0 -1 0 1 0 1 1 1 0 1\n".to_owned(),
            2,
            "patch 0: its weights are not above 0, also after it was halved: it reaches infinity or comes close to it",
        ),
        (
            "BEZ114\n0 0 0 1 1e300 0 0 1e-300 0 1 0 1 1 1 0 1".to_owned(),
            2,
            "patch 0: control point 1 is not a finite number",
        ),
    ];
    for (text, line, words) in cases {
        let error = refuse(text.as_bytes(), Format::Bez);
        assert_eq!((error.place.clone(), &*error.message), (FileLocation::Line(line), words), "{text}");
    }
    let error = refuse(b"BBP BINARY\n\0\0\0\0\0\0", Format::Bez);
    assert_eq!(error.to_string(), "byte 15: the file ends before coordinate y of point 0 of patch 0");
    let error = refuse(b"BEZ113 BINARY\n\x7f\x80\0\0\0\0\0\0", Format::Bez);
    assert!(error.to_string().starts_with("byte 14: coordinate x of point 0 of patch 0: inf"), "{error}");
    let few = Limits { rows: 1, ..Limits::default() };
    let two = format!("BBP {POINTS} {POINTS}");
    let error = read(two.as_bytes(), Format::Bez, &few).unwrap_err();
    assert_eq!(error.message, "2 patches are over the limit of 1");
    let (_, warnings) = patches(b"BBP\n");
    assert_eq!(count(&warnings, "no-patches"), 1);
    let (_, warnings) = patches(format!("BBP {POINTS} }} more words").as_bytes());
    assert_eq!(count(&warnings, "trailing-text"), 1);
}
