//! Cages in formats whose positions are rounded.
use chordal_io::Format;
use chordal_verbs::{FormatHint, Input, MeshFailure, Normals, convert, load, refine};

fn cage(x: &str) -> Input {
    let text = format!(
        "v {x} 0 0\nv 1 0 0\nv 1 1 0.1\nv 0 1 0\nf 1 2 3 4\n#@ s sharpness\nt crease 2/1/0 0 1 2.0\n"
    );
    let hint = FormatHint { name: Some("cage.obj"), ..FormatHint::default() };
    load(text.as_bytes(), hint, &Default::default()).expect("a cage")
}

/// Programs round the points of USD to f32, whatever digits its text has, and the bound covers that.
#[test]
fn the_bound_of_a_cage_covers_the_rounding_of_its_format() {
    let exact = convert(cage("0.3"), Format::Obj).unwrap();
    assert_eq!(exact.bound.at_most(), Some(0.0));
    let moved = [0.3_f64, 0.1].map(|x| (x - f64::from(x as f32)).abs()).into_iter().fold(0.0, f64::max);
    let rounded = convert(cage("0.3"), Format::Usda).unwrap();
    let at_most = rounded.bound.at_most().unwrap();
    assert!(at_most >= moved && at_most < 1.01 * moved, "{at_most} {moved}");
    // What single precision holds stays exact, and what it does not is refused.
    assert!(matches!(convert(cage("1e39"), Format::Usda), Err(MeshFailure::TooWide(_))));
}

#[test]
fn the_bound_of_refined_polygons_covers_it_too() {
    let job = chordal::Job::default();
    let bound = |to| {
        let made = refine(cage("0.3"), (2, Normals::Auto), to, &job).unwrap();
        made.certificate.bound.unwrap().at_most.unwrap()
    };
    let (exact, rounded) = (bound(Format::Obj), bound(Format::Usda));
    assert!(rounded > exact && rounded < exact + 1e-7, "{exact} {rounded}");
}
