//! Rows 54 to 58 of the list of hostile inputs, as far as cures go: nothing panics, hangs, or turns into NaN.
use super::*;
use chordal::Tolerance;
use chordal_testkit::Random;

/// All cures in the order in which the command applies them, none of which may fail.
fn mend_all(mesh: &Mesh) -> Mesh {
    let order = [
        "weld",
        "drop_duplicates either way",
        "drop_degenerate",
        "resolve_t_junctions",
        "split_non_manifold",
        "orient",
        "fill_holes",
        "orient",
        "drop_unused",
    ];
    order.into_iter().fold(mesh.clone(), |mesh, name| {
        let mended = cure(name, &mesh);
        assert!(mended.bound.at_most().is_none_or(f64::is_finite));
        mended.mesh
    })
}

#[test]
fn h54_coordinates_of_any_size_are_mended_alike() {
    let good = cube();
    let mut faces = good.faces()[..11].to_vec();
    faces[3].swap(0, 1);
    let expected = mend_all(&mesh_of(good.positions(), &faces));
    assert!(validity(&expected, Topology::Indices).closed);
    for (scale, shift) in [(1e30, 0.0), (1e-30, 0.0), (1e-310, 0.0), (1e300, 0.0), (1e-3, 5e6), (-0.0, 0.0)] {
        let positions: Vec<[f64; 3]> =
            good.positions().iter().map(|p| p.map(|x| x * scale + shift)).collect();
        let made = mend_all(&mesh_of(&positions, &faces));
        if scale != 0.0 {
            assert_eq!(made.faces(), expected.faces(), "scale {scale}, shift {shift}");
        }
    }
    let mixed = mesh_of(
        &[[1e30, 0.0, 0.0], [1e-30, 0.0, 1e-30], [0.0, 1e-30, -0.0], [0.0; 3]],
        &[[0, 1, 2], [3, 2, 1]],
    );
    mend_all(&mixed);
    weld(&mixed, Weld::Within(Tolerance::new(1e-29).unwrap()), &Job::default()).unwrap();
}

#[test]
fn h55_points_lines_and_needles_end_without_area_or_stay() {
    let point = mesh_of(&[[1.0; 3]; 6], &[[0, 1, 2], [3, 4, 5], [0, 2, 4]]);
    assert_eq!(mend_all(&point).faces().len(), 0);
    let line: Vec<[f64; 3]> = (0..9).map(|i| [f64::from(i), 2.0 * f64::from(i), 0.0]).collect();
    let faces: Vec<[u32; 3]> = (0..7).map(|i| [i, i + 1, i + 2]).collect();
    let made = mend_all(&mesh_of(&line, &faces));
    assert!(made.faces().iter().enumerate().all(|(i, _)| !chordal::check::has_zero_area(made.corners(i))));
    let needle = mesh_of(&[[0.0; 3], [1.0, 0.0, 0.0], [0.5, 1e-12, 0.0]], &[[0, 1, 2]]);
    assert_eq!(mend_all(&needle), needle);
    assert_eq!(mend_all(&Mesh::default()), Mesh::default());
}

#[test]
fn h56_repeated_and_isolated_things_go_only_when_asked() {
    let good = cube();
    let mut faces = good.faces().to_vec();
    faces.extend([good.faces()[4], [0, 3, 2]]);
    let mut positions = good.positions().to_vec();
    positions.extend([[9.0; 3], [0.0; 3]]);
    let mesh = mesh_of(&positions, &faces);
    for name in ["orient", "fill_holes", "resolve_t_junctions", "drop_degenerate"] {
        assert_eq!(cure(name, &mesh).mesh.positions().len(), 10, "{name}");
    }
    assert_eq!(cure("drop_duplicates", &mesh).mesh.faces().len(), 13);
    assert_eq!(cure("drop_duplicates either way", &mesh).mesh.faces().len(), 12);
    assert_eq!(mend_all(&mesh), good);
}

#[test]
fn h57_a_fan_of_a_thousand_faces_along_one_edge_comes_apart() {
    let n = 1000;
    let mut positions = vec![[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let mut random = Random::new(57);
    positions.extend((0..n).map(|_| [random.unit() - 0.5, random.unit() - 0.5, random.unit()]));
    let faces: Vec<[u32; 3]> =
        (0..n).map(|i| if i % 2 == 0 { [0, 1, i + 2] } else { [1, 0, i + 2] }).collect();
    let made = cure("split_non_manifold", &mesh_of(&positions, &faces));
    let found = validity(&made.mesh, Topology::Indices);
    assert!(found.manifold() && found.oriented);
    // As many faces run up as down, so that each has its partner.
    assert_eq!(found.components, 500);
}

#[test]
fn h58_a_klein_bottle_is_told_and_an_inside_out_shell_is_turned() {
    let (nu, nv) = (6_u32, 5_u32);
    let at = |i: u32, j: u32| (i % nu) * nv + if i == nu { (nv - j % nv) % nv } else { j % nv };
    let mut faces = Vec::new();
    for (i, j) in (0..nu).flat_map(|i| (0..nv).map(move |j| (i, j))) {
        let quad = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        faces.extend([[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]);
    }
    let positions: Vec<[f64; 3]> =
        (0..nu * nv).map(|v| [f64::from(v / nv), f64::from(v % nv), f64::from(v * v % 7)]).collect();
    let bottle = mesh_of(&positions, &faces);
    assert!(!validity(&bottle, Topology::Indices).orientable);
    let mended = cure("orient", &bottle);
    assert_eq!((mended.mesh, mended.changes[0].what), (bottle, "left_unorientable"));
    let good = cube();
    let inside_out: Vec<[u32; 3]> = good.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
    assert_eq!(cure("orient", &mesh_of(good.positions(), &inside_out)).count("turned_faces"), 12);
}

#[test]
fn a_cancelled_job_and_a_small_limit_end_before_the_work() {
    let job = Job::default();
    job.cancel();
    let mut small = Job::default();
    small.memory_limit = 10;
    for (job, code) in [(job, None), (small, Some("too-much-memory"))] {
        let stopped = [
            weld(&cube(), Weld::Exact, &job),
            orient(&cube(), Topology::Indices, NestedShells::Keep, &job),
            fill_holes(&cube(), Topology::Indices, HoleSelection::All, &job),
            split_non_manifold(&cube(), Topology::Indices, &job),
            drop_degenerate(&cube(), Topology::Indices, &job),
            drop_duplicates(&cube(), Topology::Indices, Duplicates::EitherWay, &job),
            drop_unused(&cube(), &job),
            resolve_t_junctions(&cube(), Topology::Indices, None, &job),
        ];
        for result in stopped {
            let found = match result {
                Err(chordal::budget::JobError::Refused(refusal)) => Some(refusal.code.as_str()),
                Err(chordal::budget::JobError::Cancelled) => None,
                Ok(_) => panic!("it went on"),
            };
            assert_eq!(found, code);
        }
    }
}
