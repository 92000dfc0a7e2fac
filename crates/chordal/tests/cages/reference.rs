//! The reference: refined control meshes of OpenSubdiv. Its vertices are in another order, so points and faces are compared as sets.
use crate::corpus::{cage, folder, polygons};
use chordal::explicit::Cage;
use std::collections::BTreeMap;

/// For each point of `from` the one of `to` that is within `near` of it, and no other.
fn matched(from: &[[f64; 3]], to: &[[f64; 3]], near: f64) -> Vec<u32> {
    let mut order: Vec<u32> = (0..to.len() as u32).collect();
    order.sort_by(|a, b| to[*a as usize][0].total_cmp(&to[*b as usize][0]));
    let mut taken = vec![false; to.len()];
    from.iter()
        .map(|p| {
            let start = order.partition_point(|i| to[*i as usize][0] < p[0] - near);
            let close = |i: &u32| (0..3).all(|k| (to[*i as usize][k] - p[k]).abs() <= near);
            let about = order[start..].iter().take_while(|i| to[**i as usize][0] <= p[0] + near);
            // Points on top of each other are any of them.
            let all: Vec<u32> = about.copied().filter(close).collect();
            let free = all.iter().copied().find(|i| !taken[*i as usize]);
            let one = free.unwrap_or_else(|| panic!("nothing within {near:e} of {p:?}"));
            taken[one as usize] = true;
            one
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

fn compare(what: &str, ours: &Cage, theirs: &str) {
    let (points, faces) = polygons(theirs);
    assert_eq!((ours.positions().len(), ours.n_faces()), (points.len(), faces.len()), "{what}");
    let bounds = chordal::math::Box3::around(&points);
    // A millionth of the extent: the reference has nine digits of single precision.
    let of = matched(ours.positions(), &points, 1e-6 * bounds.diagonal());
    let renamed = |face: &[u32]| turned(&face.iter().map(|v| of[*v as usize]).collect::<Vec<_>>());
    let (ours, theirs) = (counted(ours.faces().map(renamed)), counted(faces.iter().map(|f| turned(f))));
    assert!(ours == theirs, "{what}: faces differ");
}

#[test]
fn every_round_is_that_of_the_reference() {
    let Some(folder) = folder() else { return };
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
            compare(&format!("{name} {level}"), &ours, &std::fs::read_to_string(path).unwrap());
        }
    }
}
