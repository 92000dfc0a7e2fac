//! The reference: refined control meshes of OpenSubdiv. Its vertices are in another order, so points and
//! faces are compared as sets.
use super::corpus::{cage, cages, polygons};
use chordal::explicit::Cage;
use std::collections::BTreeMap;

/// For each point of `from` the first of `to` that is within `near` of it: points on top of each other are
/// one.
fn matched(from: &[[f64; 3]], to: &[[f64; 3]], near: f64) -> Vec<u32> {
    let mut order: Vec<u32> = (0..to.len() as u32).collect();
    order.sort_by(|a, b| to[*a as usize][0].total_cmp(&to[*b as usize][0]));
    from.iter()
        .map(|p| {
            let start = order.partition_point(|i| to[*i as usize][0] < p[0] - near);
            let close = |i: &u32| (0..3).all(|k| (to[*i as usize][k] - p[k]).abs() <= near);
            let about = order[start..].iter().take_while(|i| to[**i as usize][0] <= p[0] + near);
            let first = about.copied().filter(close).min();
            first.unwrap_or_else(|| panic!("nothing within {near:e} of {p:?}"))
        })
        .collect()
}

/// A face as where it begins does not matter.
fn turned(face: &[u32]) -> Vec<u32> {
    let first = (0..face.len()).min_by_key(|k| face[*k]).unwrap();
    face.iter().cycle().skip(first).take(face.len()).copied().collect()
}

fn counted(faces: impl Iterator<Item = Vec<u32>>) -> BTreeMap<Vec<u32>, usize> {
    let mut counts = BTreeMap::new();
    faces.for_each(|face| *counts.entry(face).or_insert(0) += 1);
    counts
}

/// Whether they have the same points and faces, up to a share of the extent.
fn compare(what: &str, ours: &Cage, (points, faces): (Vec<[f64; 3]>, Vec<Vec<u32>>), share: f64) {
    assert_eq!((ours.positions().len(), ours.n_faces()), (points.len(), faces.len()), "{what}");
    let bounds = chordal::math::Box3::from_points(&points);
    let near = share * bounds.diagonal();
    let (of_ours, of_theirs) = (matched(ours.positions(), &points, near), matched(&points, &points, near));
    let renamed =
        |of: &[u32], face: &[u32]| turned(&face.iter().map(|v| of[*v as usize]).collect::<Vec<_>>());
    let ours = counted(ours.faces().map(|face| renamed(&of_ours, face)));
    let theirs = counted(faces.iter().map(|face| renamed(&of_theirs, face)));
    assert!(ours == theirs, "{what}: faces differ");
}

#[test]
fn every_round_is_that_of_the_reference() {
    let Some(folder) = chordal_testkit::corpus::find("subdiv") else { return };
    let baseline = folder.join("opensubdiv/regression/hbr_regression/baseline");
    let mut names: Vec<String> = std::fs::read_dir(&baseline)
        .unwrap()
        .map(|file| file.unwrap().file_name().to_string_lossy().into_owned())
        .filter_map(|name| name.strip_suffix("_level0.obj").map(str::to_owned))
        .collect();
    names.sort();
    assert_eq!(names.len(), 8);
    for name in names {
        let text = std::fs::read_to_string(folder.join(format!("cages/{name}.obj"))).unwrap();
        let mut ours = cage(&name, &text).unwrap();
        for level in 0..4 {
            ours = ours.refined().unwrap();
            let path = baseline.join(format!("{name}_level{level}.obj"));
            let theirs = polygons(&std::fs::read_to_string(path).unwrap());
            // A millionth of the extent: the reference has nine digits of single precision.
            compare(&format!("{name} {level}"), &ours, theirs, 1e-6);
        }
    }
}

#[test]
fn rounds_by_grids_are_those_one_by_one() {
    for (name, cage) in cages() {
        let rounds = match name.as_str() {
            // Round by round, edges between the same vertices become one after the first: see the test of its
            // own.
            "loop_val2_interior" => 1,
            _ if cage.n_faces() > 500 => 2,
            _ => 4,
        };
        let mut plain = cage.clone();
        for round in 1..=rounds {
            plain = plain.refined().unwrap();
            let grids = cage.refined_times(round).unwrap();
            let theirs = (plain.positions().to_vec(), plain.faces().map(<[u32]>::to_vec).collect());
            // Rounding, some hundred steps around a pole.
            compare(&format!("{name} {round}"), &grids, theirs, 1e-13);
            let sharp = |cage: &Cage| {
                let mut all: Vec<f64> = cage.creases().iter().map(|(_, sharp)| *sharp).collect();
                all.sort_by(f64::total_cmp);
                (all, cage.sharp_vertices().to_vec(), cage.holes().len())
            };
            assert_eq!(sharp(&grids), sharp(&plain), "{name} {round}");
        }
    }
}

/// Around an interior vertex with two triangles the edges across from it, one in each, end alike.
#[test]
fn edges_that_end_alike_stay_two_over_rounds() {
    for (name, cage) in cages() {
        if name != "loop_val2_interior" {
            continue;
        }
        // As counted by OpenSubdiv 3.5.
        for (rounds, n_points) in [(1, 34), (2, 102), (3, 358)] {
            let refined = cage.refined_times(rounds).unwrap();
            assert_eq!((refined.positions().len(), refined.n_faces()), (n_points, 10 << (2 * rounds)));
        }
    }
}
