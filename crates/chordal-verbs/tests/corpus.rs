//! `inspect` on every file of the corpus: the counts by sorting, the report by its schema, every finding with
//! its place.
use crate::common;

use chordal::Mesh;
use chordal::budget::advice::{Setting, Spell, Spelling};
use chordal::check::Defect;
use chordal_io::Format;
use chordal_testkit::is_long;
use chordal_verbs::report::{Report, ValidityCounts};
use chordal_verbs::{FormatHint, Input, Shape, inspect_deeply, load};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

/// The file, unless it is broken on purpose.
fn read(path: &Path) -> Option<Input> {
    let bytes = std::fs::read(path).unwrap();
    let name = path.to_string_lossy();
    load(&bytes, FormatHint { name: Some(&name), ..FormatHint::default() }, &Default::default()).ok()
}

/// The lower and the higher position of a triangle's side, and whether it runs up.
type Side = (u64, u64, bool);

/// Positions, edges, boundary edges, edges with three faces or more, edges wound against each other,
/// collapsed faces: by sorting, and nothing else.
fn sorted_counts(mesh: &Mesh, format: Format) -> [u64; 6] {
    let by_bits = matches!(format, Format::Stl | Format::Glb);
    let mut places: Vec<([u64; 3], u32)> = (0..)
        .zip(mesh.positions())
        .map(|(row, p)| {
            let key = if by_bits {
                p.map(|x| (x + 0.0).to_bits())
            } else {
                [u64::from(mesh.position_of(row)), 0, 0]
            };
            (key, row)
        })
        .collect();
    places.sort_unstable();
    let mut id = vec![0; places.len()];
    let mut n = 0;
    for (i, (key, row)) in places.iter().enumerate() {
        n += u64::from(i == 0 || places[i - 1].0 != *key);
        id[*row as usize] = n;
    }
    let (mut sides, mut collapsed) = (Vec::new(), 0);
    for face in mesh.faces() {
        let [a, b, c] = face.map(|row| id[row as usize]);
        if a == b || b == c || c == a {
            collapsed += 1;
        } else {
            sides.extend([(a, b), (b, c), (c, a)].map(|(from, to)| (from.min(to), from.max(to), from < to)));
        }
    }
    sides.sort_unstable();
    let edges: Vec<_> = sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).collect();
    let count = |is: fn(&[Side]) -> bool| edges.iter().filter(|edge| is(edge)).count() as u64;
    [
        n,
        edges.len() as u64,
        count(|edge| edge.len() == 1),
        count(|edge| edge.len() > 2),
        count(|edge| edge.len() == 2 && edge[0].2 == edge[1].2),
        collapsed,
    ]
}

fn agree(name: &str, report: &Report, counts: &ValidityCounts, sorted: [u64; 6]) {
    let Some(output) = report.certificate.output.as_ref().and_then(|output| output.triangles()) else {
        panic!("{name}: no triangles")
    };
    let found = [
        output.positions,
        counts.edges,
        counts.boundary_edges,
        counts.non_manifold_edges,
        counts.inconsistent_edges,
        counts.collapsed_faces,
    ];
    assert_eq!(found, sorted, "{name}");
}

fn schema() -> jsonschema::Validator {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/schema/report.schema.json");
    let schema: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    jsonschema::validator_for(&schema).unwrap()
}

/// Every finding has its count, its words, a cure or an advice, and a place that is there.
fn is_a_good_letter(name: &str, report: &Report, scene: &chordal_io::Scene) {
    let valid = report.certificate.valid.as_ref().unwrap();
    let findings = report.inspection().unwrap().findings.as_ref().unwrap();
    let witnesses = valid.witnesses.as_ref().unwrap();
    for finding in findings {
        assert!(
            finding.count > 0 && (finding.cures.is_empty() == finding.advice.is_some()),
            "{name}: {finding:?}"
        );
        let places: Vec<_> = witnesses.iter().filter(|witness| witness.of == finding.of).collect();
        assert!(!places.is_empty(), "{name}: {} without a place", finding.of);
        for place in places {
            let mesh = &scene.parts[place.part as usize].mesh;
            assert!(place.faces.iter().all(|face| (*face as usize) < mesh.faces().len()), "{name}");
            assert!(place.vertices.iter().all(|row| (*row as usize) < mesh.positions().len()), "{name}");
            let bounds = mesh.bounds();
            let reach = bounds.diagonal() * 1e-9;
            let near =
                |k: usize| bounds.min[k] - reach <= place.at[k] && place.at[k] <= bounds.max[k] + reach;
            assert!((0..3).all(near), "{name}: {place:?} lies outside of {bounds:?}");
        }
    }
    let sound = valid.counts.closed && valid.counts.manifold && valid.outward() == Some(true);
    let faults = findings.iter().filter(|finding| finding.weight == "fault").count();
    assert!(sound || faults > 0 || valid.counts.components == 0, "{name}: not sound, and no fault is named");
}

#[test]
fn places_of_moved_parts_are_said_to_be_their_own() {
    let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mesh = Mesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap();
    for moved in [0.0, 5.0] {
        let mut scene = chordal_io::Scene::from_mesh("one", mesh.clone(), Default::default());
        scene.nodes[0].matrix[12] = moved;
        let mut glb = Vec::new();
        chordal_io::write(&scene, None, Format::Glb, &mut glb).unwrap();
        let input = load(&glb, FormatHint::default(), &Default::default()).unwrap();
        let report = chordal_verbs::inspect(&input);
        let bounds = report.inspection().unwrap().bounds.unwrap();
        let anatomy = report.certificate.valid.unwrap().anatomy.unwrap();
        assert_eq!((anatomy.in_place, bounds[0][0]), (moved == 0.0, moved));
        assert_eq!(anatomy.component_list[0].bounds, [[0.0; 3], [1.0; 3]]);
    }
}

/// Settings as the schema has them.
struct Options;

impl Spelling for Options {
    fn spell(&self, setting: Setting, _: Option<&str>) -> String {
        format!("--{}", setting.name())
    }
}

#[test]
fn every_file_of_the_corpus_gets_a_letter_whose_counts_are_right() {
    let schema = schema();
    let mut met: BTreeSet<&str> = BTreeSet::new();
    let (mut n, mut closed) = (0, 0);
    let files = common::files(if is_long() { u64::MAX } else { 1 << 20 });
    for path in &files {
        let name = path.display().to_string();
        let Some(input) = read(path) else { continue };
        let Shape::Scene(scene) = &input.shape else { panic!("{name} holds no triangles") };
        let report = inspect_deeply(&input, &Default::default()).unwrap();
        let valid = report.certificate.valid.as_ref().unwrap();
        let sum = scene.parts.iter().map(|part| sorted_counts(&part.mesh, input.format));
        let sum = sum.fold([0; 6], |a, b| std::array::from_fn(|k| a[k] + b[k]));
        agree(&name, &report, &valid.counts, sum);
        is_a_good_letter(&name, &report, scene);
        let report = report.clone().spelled(&Options);
        let wrong: Vec<_> =
            schema.iter_errors(&report.to_value()).map(|e| format!("{}: {e}", e.instance_path())).collect();
        assert!(wrong.is_empty(), "{name}: {wrong:#?}");
        met.extend(Defect::ALL.iter().filter(|d| valid.count(**d).unwrap_or(0) > 0).map(|d| d.name()));
        n += 1;
        closed += usize::from(valid.counts.closed);
    }
    if !files.is_empty() {
        assert!(n >= 70 && closed >= 10, "{n} files, {closed} closed");
        assert!(met.len() >= 10, "the corpus shows only {met:?}");
    }
}
