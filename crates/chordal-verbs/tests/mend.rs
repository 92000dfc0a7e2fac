//! `mend` on every file of the corpus, and on scenes whose nodes move and stretch their parts.
use crate::common;

use chordal::budget::Length;
use chordal::{Job, Mesh};
use chordal_io::{Format, Frame, Scene, write};
use chordal_testkit::is_long;
use chordal_verbs::report::{ValidityCounts, VerbFacts};
use chordal_verbs::{
    FormatHint, HoleSelection, Input, MendSpec, MeshOutcome, Shape, WeldTolerance, load, mend,
};
use std::path::Path;

/// The triangles of a file, unless it is broken on purpose.
fn read(path: &Path) -> Option<Input> {
    let bytes = std::fs::read(path).unwrap();
    let name = path.to_string_lossy();
    let input =
        load(&bytes, FormatHint { name: Some(&name), ..FormatHint::default() }, &Default::default()).ok()?;
    matches!(input.shape, Shape::Scene(_)).then_some(input)
}

fn done(input: Input, spec: &MendSpec, to: Format) -> MeshOutcome {
    mend(input, spec, to, &Job::default()).unwrap()
}

/// The counts of the triangles before they were mended.
fn counts_before(outcome: &MeshOutcome) -> &ValidityCounts {
    let VerbFacts::Mended { valid_before, .. } = &outcome.certificate.verb else { panic!("not mended") };
    &valid_before.counts
}

/// How often the cures say that something was met and not mended.
fn left(outcome: &MeshOutcome, what: &str) -> u64 {
    let changes = outcome.certificate.verb.repairs().iter().flat_map(|facts| &facts.changes);
    changes.filter(|change| change.what == what).map(|change| change.count).sum()
}

#[test]
fn all_cures_together_leave_nothing_to_mend_that_they_do_not_name() {
    let (mut n_files, mut n_sick, mut n_closed) = (0, 0, 0);
    for path in common::files(8 << 20) {
        let Some(input) = read(&path) else { continue };
        // OBJ keeps what was split apart: it has indices of positions, and ties what is tied.
        let outcome = done(input, &MendSpec::ALL, Format::Obj);
        let name = path.display();
        let was = counts_before(&outcome);
        let is = &outcome.certificate.valid.as_ref().unwrap().counts;
        assert!(is.manifold, "{name}: {is:?}");
        assert_eq!((is.duplicate_faces, is.collapsed_faces, is.unused_vertices), (0, 0, 0), "{name}");
        assert!(is.zero_area_faces == 0 || left(&outcome, "left_faces") > 0, "{name}: {is:?}");
        assert!(is.inconsistent_edges == 0 || left(&outcome, "left_unorientable") > 0, "{name}: {is:?}");
        let has_holes = is.boundary_edges > 0;
        assert!(!has_holes || left(&outcome, "left_holes") > 0, "{name}: {is:?}");
        assert!(outcome.bound.at_most().is_none_or(f64::is_finite), "{name}");
        n_files += 1;
        n_sick += u64::from(is_sick(was));
        n_closed += u64::from(is.closed);
    }
    eprintln!("{n_files} files, {n_sick} of them with faults, {n_closed} closed afterwards");
    assert!(n_files == 0 || (n_sick > 20 && n_closed > n_files * 3 / 4));
}

fn is_sick(counts: &ValidityCounts) -> bool {
    !(counts.closed && counts.manifold && counts.oriented)
        || counts.duplicate_faces + counts.zero_area_faces > 0
}

#[test]
fn no_cure_alone_makes_a_fault_that_was_not_there() {
    let none = MendSpec::default();
    let alone = [
        ("orient", MendSpec { orient: true, ..none }),
        ("drop unused", MendSpec { drop_unused: true, ..none }),
        ("split", MendSpec { split_non_manifold: true, ..none }),
        ("fill", MendSpec { fill_holes: Some(HoleSelection::All), ..none }),
        ("t-junctions", MendSpec { resolve_t_junctions: Some(WeldTolerance::Exact), ..none }),
        ("degenerate", MendSpec { drop_degenerate: true, ..none }),
    ];
    let files = common::files(if is_long() { 8 << 20 } else { 1 << 20 });
    for (number, path) in files.into_iter().enumerate() {
        // By default each file with a third of the cures, by turns.
        let step = if is_long() { 1 } else { 3 };
        for (cure, spec) in alone.into_iter().skip(number % step).step_by(step) {
            let Some(input) = read(&path) else { continue };
            if input.format != Format::Obj && input.format != Format::Ply {
                continue;
            }
            let outcome = done(input, &spec, Format::Obj);
            let name = format!("{}, {cure}", path.display());
            let was = counts_before(&outcome);
            let is = &outcome.certificate.valid.as_ref().unwrap().counts;
            // A copy of an edge that had three faces may be a boundary, and a hole may be left where there
            // was a face.
            let may_open = ["split", "degenerate"].contains(&cure);
            assert!(may_open || is.boundary_edges <= was.boundary_edges || cure == "t-junctions", "{name}");
            assert!(is.non_manifold_edges <= was.non_manifold_edges, "{name}");
            // Two of three faces along an edge that are left there together may have been wound against each
            // other.
            let hidden = if cure == "split" { was.non_manifold_edges } else { 0 };
            // Faces that become neighbours by a cut may turn out to be, too.
            let met = cure == "t-junctions";
            assert!(met || is.inconsistent_edges <= was.inconsistent_edges + hidden, "{name}");
            assert!(is.duplicate_faces <= was.duplicate_faces, "{name}");
            assert!(is.zero_area_faces <= was.zero_area_faces, "{name}");
            assert!(is.unused_vertices <= was.unused_vertices || cure == "degenerate", "{name}");
            assert!(!was.closed || is.closed, "{name}");
        }
    }
}

/// A triangle whose parts are shown twice, once as it is and once so many times as large; as the bytes of a
/// GLB.
fn shown_large(rows: &[[f64; 3]], faces: &[[u32; 3]], times: f64) -> Input {
    let mesh = Mesh::new(rows.to_vec(), faces.to_vec()).unwrap();
    let mut scene = Scene::from_triangle_soup("part", mesh, Frame::default());
    let mut node = scene.nodes[0].clone();
    for k in [0, 5, 10] {
        node.matrix[k] = times;
    }
    scene.nodes.push(node);
    scene.roots.push(1);
    let mut bytes = Vec::new();
    write(&scene, None, Format::Glb, &mut bytes).unwrap();
    load(&bytes, FormatHint { name: Some("a.glb"), ..FormatHint::default() }, &Default::default()).unwrap()
}

#[test]
fn a_length_holds_where_a_part_is_shown_largest() {
    // Two rows 1/64 apart, shown 4 times as large: 1/16 in the scene.
    let rows =
        [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.015625, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let faces = [[0, 1, 2], [3, 4, 5]];
    let within = |length: f64| MendSpec {
        weld: Some(WeldTolerance::Within(Length::Plain(length.to_string().parse().unwrap()))),
        ..MendSpec::default()
    };
    let welded = |length: f64| {
        let outcome = done(shown_large(&rows, &faces, 4.0), &within(length), Format::Glb);
        (left(&outcome, "welded_vertices"), outcome.bound.at_most().unwrap())
    };
    // The stretch of a matrix is bounded by the root of the sum of its squares: here √3 times what it is. So
    // a length that is too small certainly moves nothing, and one that is twice as large as needed certainly
    // suffices.
    let (few, still) = welded(0.06);
    let (more, moved) = welded(0.12);
    assert_eq!((few, still, more), (0, 0.0, 1));
    assert!((0.0625..0.12).contains(&moved), "{moved}");
}

#[test]
fn each_part_is_mended_by_itself() {
    let open = "o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    let input = load(
        open.as_bytes(),
        FormatHint { name: Some("a.obj"), ..FormatHint::default() },
        &Default::default(),
    )
    .unwrap();
    let Shape::Scene(mut scene) = input.shape.clone() else { panic!("triangles") };
    let second = scene.parts[0].clone();
    scene.parts.push(second);
    let mut node = scene.nodes[0].clone();
    (node.part, node.matrix[12]) = (Some(1), 5.0);
    scene.nodes.push(node);
    scene.roots.push(1);
    let input = Input { shape: Shape::Scene(scene), ..input };
    let outcome = done(input, &MendSpec::ALL, Format::Glb);
    let scene = outcome.scene().unwrap();
    assert_eq!(scene.parts.iter().map(|part| part.mesh.faces().len()).collect::<Vec<_>>(), [4, 4]);
    assert_eq!(left(&outcome, "filled_holes"), 2);
    let filled = outcome.certificate.verb.repairs().iter().find(|facts| facts.cure == "fill-holes").unwrap();
    let parts: Vec<u64> = filled.changes[0].witnesses.iter().map(|witness| witness.part).collect();
    assert_eq!(parts, [0, 1]);
    assert!(outcome.certificate.valid.as_ref().unwrap().counts.closed);
}
