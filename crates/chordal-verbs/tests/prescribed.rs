//! What `inspect` prescribes helps, makes nothing sick that was sound, and ends.
use crate::common;

use chordal::Job;
use chordal::budget::advice::Cure;
use chordal::check::Defect;
use chordal_io::Format;
use chordal_verbs::report::{FindingFacts, Report, cures_of_all};
use chordal_verbs::{
    Duplicates, FormatHint, HoleSelection, Input, MendSpec, MeshFailure, Shape, WeldTolerance, inspect, load,
    mend,
};

fn read(bytes: &[u8], name: &str) -> Option<Input> {
    let input =
        load(bytes, FormatHint { name: Some(name), ..FormatHint::default() }, &Default::default()).ok()?;
    matches!(input.shape, Shape::Scene(_)).then_some(input)
}

fn findings(report: &Report) -> &[FindingFacts] {
    report.inspection().unwrap().findings.as_deref().unwrap_or_default()
}

fn options(cures: &[Cure]) -> Vec<String> {
    cures.iter().map(|cure| format!("--{}", cure.name())).collect()
}

fn spec(cures: &[&str]) -> MendSpec {
    let asked = |cure: &str| cures.contains(&cure);
    MendSpec {
        weld: asked("--weld").then_some(WeldTolerance::Exact),
        drop_duplicates: asked("--drop-duplicates").then_some(Duplicates::EitherWay),
        drop_degenerate: asked("--drop-degenerate"),
        resolve_t_junctions: asked("--resolve-t-junctions").then_some(WeldTolerance::Exact),
        split_non_manifold: asked("--split-nonmanifold"),
        orient: asked("--orient"),
        // An outward piece within another is a finding, which this cures.
        nested: chordal_verbs::NestedShells::Cavity,
        fill_holes: asked("--fill-holes").then_some(HoleSelection::All),
        drop_unused: asked("--drop-unused"),
    }
}

/// The file after these cures, as it reads back.
fn mended(input: Input, cures: &[&str], to: Format) -> Input {
    let outcome = mend(input, &spec(cures), to, &Job::default()).unwrap();
    let mut bytes = Vec::new();
    outcome.write(&mut bytes).unwrap();
    read(&bytes, &format!("a.{to}")).unwrap()
}

/// What may show only once something else is mended; each is a state that the next round can speak of.
fn may_show(of: &str, cures: &[&str]) -> bool {
    match of {
        // Sheets that come apart have rims, and dropping a face leaves its edges.
        "boundary_edges" => cures
            .iter()
            .any(|cure| ["--split-nonmanifold", "--drop-duplicates", "--drop-degenerate"].contains(cure)),
        // Copies of positions are what splitting is; slivers are remarks on new faces' shapes, and have no
        // cure.
        "duplicate_vertices" => cures.contains(&"--split-nonmanifold"),
        "slivers" => true,
        _ => false,
    }
}

/// Every complaint about what happens when one follows the advice for a file; empty where all is well.
fn complaints(name: &str, bytes: &[u8], to: Format) -> Option<Vec<String>> {
    let mut input = read(bytes, name)?;
    let mut report = inspect(&input);
    let (mut wrong, mut told) = (Vec::new(), Vec::new());
    for round in 1.. {
        let cures = options(&cures_of_all(findings(&report)));
        let cures: Vec<&str> = cures.iter().map(String::as_str).collect();
        told.push(cures.join(" "));
        if cures.is_empty() {
            break;
        }
        if round > 3 {
            wrong.push(format!("{name} into {to}: no end of {}", told.join(" | ")));
            break;
        }
        let same_meaning = input.format == to;
        input = mended(input, &cures, to);
        let after = inspect(&input);
        for defect in Defect::ALL {
            let of = |report: &Report| report.certificate.valid.as_ref().unwrap().count(defect).unwrap_or(0);
            let (was, is) = (of(&report), of(&after));
            let asked =
                findings(&report).iter().find(|f| f.of == defect.name()).is_some_and(|f| !f.cures.is_empty());
            if asked && is >= was && !may_show(defect.name(), &cures) {
                wrong.push(format!("{name} into {to}: {} {was} -> {is} by {cures:?}", defect.name()));
            }
            // By indices more may be apart than by positions, and the other way round.
            if was == 0 && is > 0 && same_meaning && !may_show(defect.name(), &cures) {
                wrong.push(format!("{name} into {to}: new {} {is} by {cures:?}", defect.name()));
            }
        }
        report = after;
    }
    Some(wrong)
}

#[test]
fn what_is_prescribed_helps_and_ends() {
    let (mut n, mut wrong) = (0, Vec::new());
    for path in common::files(400_000) {
        let bytes = std::fs::read(&path).unwrap();
        let name = path.display().to_string();
        let Some(own) = read(&bytes, &name).map(|input| input.format) else { continue };
        for to in [Some(Format::Obj), (own != Format::Obj).then_some(own)].into_iter().flatten() {
            let Some(found) = complaints(&name, &bytes, to) else { continue };
            wrong.extend(found);
            n += 1;
        }
    }
    // A hole that is filled may close a piece within another, and which way that faces nobody has said.
    assert!(wrong.len() <= 1, "{} of {n}:\n{}", wrong.len(), wrong.join("\n"));
    assert!(n == 0 || n > 50, "only {n} files");
}

fn advised(obj: &str) -> Report {
    inspect(&read(obj.as_bytes(), "a.obj").unwrap())
}

#[test]
fn an_open_sheet_gets_words_and_no_cure() {
    for faces in ["f 1 2 3\n", "f 1 2 3\nf 1 3 4\n"] {
        let report = advised(&format!(
            "v 0 0 0\nv 1 0 1\nv 1 1 1\n{}{faces}",
            if faces.len() > 9 { "v 0 1 0\n" } else { "" }
        ));
        let found = &findings(&report)[0];
        assert_eq!((found.of, &found.cures[..]), ("boundary_edges", &[][..]));
        assert!(found.advice.as_ref().unwrap().contains("open sheet"), "{found:?}");
    }
}

#[test]
fn what_welding_would_make_sick_is_not_to_be_welded() {
    // Two tetrahedra, each sound, along one edge: by positions it has four faces.
    let corners = "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv 0 0 1\nv -1 0 0\nv 0 -1 0\n";
    let faces = "f 1 4 3\nf 1 2 4\nf 1 3 2\nf 2 3 4\nf 5 8 7\nf 5 6 8\nf 5 7 6\nf 6 7 8\n";
    let report = advised(&format!("{corners}{faces}"));
    assert!(cures_of_all(findings(&report)).is_empty(), "{:?}", findings(&report));
}

#[test]
fn a_piece_that_is_filled_is_oriented() {
    // An open box, inside out: only once it is closed has it an outside.
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
    let report = advised(&format!("{corners}f 1 2 4\nf 2 3 4\nf 3 1 4\n"));
    assert_eq!(cures_of_all(findings(&report)), [Cure::FillHoles]);
    let report = advised(&format!("{corners}f 2 1 4\nf 3 2 4\nf 1 3 4\n"));
    assert_eq!(cures_of_all(findings(&report)), [Cure::Orient, Cure::FillHoles]);
}

#[test]
fn points_only_are_left_and_an_empty_result_is_refused() {
    let points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let report = advised(points);
    // Nothing is found of triangles that are not there; the letter says that there are none.
    assert!(findings(&report).is_empty(), "{:?}", findings(&report));
    let input = read(points.as_bytes(), "a.obj").unwrap();
    let refused = mend(input, &spec(&["--drop-unused"]), Format::Obj, &Job::default());
    let Err(MeshFailure::Refused(refusal)) = refused else { panic!("{refused:?}") };
    assert_eq!(refusal.code, chordal::budget::RefusalCode::Empty);
}

#[test]
fn where_equal_positions_are_one_splitting_is_advice_for_another_format() {
    // Three triangles along one edge.
    let fan = "v 0 0 0\nv 0 0 1\nv 1 0 0\nv -1 1 0\nv -1 -1 0\nf 1 2 3\nf 2 1 4\nf 1 2 5\n";
    let input = read(fan.as_bytes(), "a.obj").unwrap();
    let stl = mended(input, &["--orient"], Format::Stl);
    let report = inspect(&stl);
    let found = findings(&report).iter().find(|finding| finding.of == "non_manifold_edges").unwrap();
    assert!(
        found.cures.is_empty() && found.advice.as_ref().unwrap().contains("into OBJ or PLY"),
        "{found:?}"
    );
}
