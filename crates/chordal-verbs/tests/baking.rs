//! Baking the corpus: no wrong sign on closed meshes by a vote of rays, and distances as a plain loop finds
//! them.
use crate::common;

use chordal::convert::{mesh_to_field, mesh_to_grid};
use chordal::{Job, Mesh};
use chordal_testkit::is_long;
use chordal_verbs::{FormatHint, Shape, load};

/// Whether the ray from `p` along `d` leaves more often than it enters; `None` where it comes too close to an
/// edge to tell.
fn is_surrounded(p: [f64; 3], d: [f64; 3], mesh: &Mesh) -> Option<bool> {
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let sub = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let mut count = 0;
    for face in 0..mesh.faces().len() {
        let [a, b, c] = mesh.corners(face).map(|q| sub(q, p));
        let volumes = [dot(d, cross(a, b)), dot(d, cross(b, c)), dot(d, cross(c, a))];
        let size = volumes.iter().map(|v| v.abs()).sum::<f64>();
        // Rounding of a product of three is below 1e-14 of its largest terms, which are about this size.
        let far = [a, b, c].iter().map(|q| dot(*q, *q)).fold(0.0, f64::max);
        if volumes.iter().any(|v| v.abs() <= 1e-11 * far) {
            // Not near at all, if the other two disagree for sure.
            let sure: Vec<f64> = volumes.into_iter().filter(|v| v.abs() > 1e-11 * far).collect();
            if sure.iter().any(|v| *v > 0.0) && sure.iter().any(|v| *v < 0.0) {
                continue;
            }
            return None;
        }
        let same = volumes.iter().all(|v| *v > 0.0) || volumes.iter().all(|v| *v < 0.0);
        if !same || size == 0.0 {
            continue;
        }
        let n = cross(sub(b, a), sub(c, a));
        let ahead = dot(a, n) / dot(d, n);
        if ahead > 0.0 {
            count += if dot(d, n) > 0.0 { 1 } else { -1 };
        }
    }
    Some(count > 0)
}

#[test]
fn no_sign_of_a_closed_mesh_is_wrong() {
    let directions = [[0.31, 0.57, 0.76], [-0.83, 0.21, 0.52], [0.11, -0.94, -0.33]];
    let job = Job::default();
    let (mut meshes, mut votes) = (0, 0);
    // Points are judged against all triangles.
    let files = common::files(if is_long() { 400_000 } else { 100_000 });
    for path in &files {
        let bytes = std::fs::read(path).unwrap();
        let name = path.to_string_lossy();
        let Ok(input) =
            load(&bytes, FormatHint { name: Some(&name), ..FormatHint::default() }, &Default::default())
        else {
            continue;
        };
        let Shape::Scene(scene) = &input.shape else { continue };
        for part in scene.parts.iter().filter(|part| !part.mesh.faces().is_empty()) {
            let Ok(baked) = mesh_to_grid(&part.mesh, 14, None, &job) else { continue };
            if !baked.solid.closed || part.mesh.faces().len() > 30_000 {
                assert!(baked.solid.is_solid() || baked.solid.to_string().contains("not a solid"), "{name}");
                continue;
            }
            meshes += 1;
            let size = baked.grid.size();
            let step = if part.mesh.faces().len() > 3000 { 23 } else { 5 };
            for row in (0..baked.grid.samples().len()).step_by(step) {
                let index = [row % size[0], row / size[0] % size[1], row / size[0] / size[1]];
                let p = baked.grid.affine().at(index.map(|i| i as f64));
                let value = baked.grid.samples().get(row);
                // A sample on the surface has no side.
                if value.abs() < 1e-9 * part.mesh.bounds().diagonal() {
                    continue;
                }
                let ballot: Vec<bool> =
                    directions.iter().filter_map(|d| is_surrounded(p, *d, &part.mesh)).collect();
                let ayes = ballot.iter().filter(|inside| **inside).count();
                if ballot.is_empty() || 2 * ayes == ballot.len() {
                    continue;
                }
                votes += 1;
                assert_eq!(value < 0.0, 2 * ayes > ballot.len(), "{name}: {value} at {p:?}, {ballot:?}");
            }
        }
    }
    eprintln!("{meshes} closed meshes, {votes} votes");
    assert!(meshes > 10 || files.is_empty());
}

/// The whole of a scan with holes: said, and not refused.
#[test]
fn a_scan_with_holes_is_no_solid() {
    let Some(path) = common::files(400_000).into_iter().find(|path| path.ends_with("cube_no_bottom.obj"))
    else {
        return;
    };
    let bytes = std::fs::read(&path).unwrap();
    let name = path.to_string_lossy();
    let input =
        load(&bytes, FormatHint { name: Some(&name), ..FormatHint::default() }, &Default::default()).unwrap();
    let Shape::Scene(scene) = &input.shape else { panic!("a mesh") };
    let made = mesh_to_field(&scene.parts[0].mesh, &Job::default()).unwrap();
    assert!(!made.solid.closed && made.solid.boundary_edges > 0);
}
