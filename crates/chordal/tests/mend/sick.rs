//! The six sick meshes: one fault each, and the cure that takes it away.
use super::*;

/// Cures and checks: the finding was there, is gone, and no other has come.
fn is_cured_by(name: &str, finding: &str, mesh: &Mesh) -> MendedMesh {
    let before = findings(mesh);
    assert!(before.iter().any(|&(of, n)| of == finding && n > 0), "{finding} is not there: {before:?}");
    let mended = cure(name, mesh);
    let after = findings(&mended.mesh);
    for ((of, was), (_, is)) in before.into_iter().zip(after) {
        assert!(is <= was, "{name}: {of} went from {was} to {is}");
        assert!(of != finding || is == 0, "{name}: {of} is still {is}");
    }
    assert_eq!(mended.bound.at_most(), Some(0.0));
    assert!(!mended.is_unchanged());
    mended
}

#[test]
fn a_moebius_strip_is_told_and_left_as_it_is() {
    // Five quads around, the last joined to the first upside down.
    let n = 5;
    let positions: Vec<[f64; 3]> = (0..2 * n)
        .map(|i| {
            let (around, half) = (
                f64::from(i / 2) / f64::from(n) * std::f64::consts::TAU,
                f64::from(i / 2) / f64::from(n) * std::f64::consts::PI,
            );
            let r = 2.0 + (f64::from(i % 2) - 0.5) * libm::cos(half);
            [r * libm::cos(around), r * libm::sin(around), (f64::from(i % 2) - 0.5) * libm::sin(half)]
        })
        .collect();
    let at = |i: u32, j: u32| if i == n as u32 { 1 - j } else { 2 * i + j };
    let faces: Vec<[u32; 3]> = (0..n as u32)
        .flat_map(|i| [[at(i, 0), at(i + 1, 0), at(i + 1, 1)], [at(i, 0), at(i + 1, 1), at(i, 1)]])
        .collect();
    let strip = mesh_of(&positions, &faces);
    assert!(!validity(&strip, Topology::Indices).orientable);
    let mended = cure("orient", &strip);
    assert_eq!((&mended.mesh, mended.count("left_unorientable")), (&strip, 1));
    assert!(mended.is_unchanged());
    // Its one boundary loop passes faces that do not agree, so that no cap would fit.
    let filled = cure("fill_holes", &strip);
    assert_eq!((&filled.mesh, filled.count("left_holes")), (&strip, 1));
    assert_eq!(validity(&strip, Topology::Indices).boundary_loops, 1);
}

#[test]
fn the_rim_of_a_flat_sheet_stays_and_a_hole_in_it_is_filled() {
    // A square with a square hole, and a square: in an oblique plane that no coordinate knows.
    let flat = |x: f64, y: f64| [x, y, x + 2.0 * y];
    let ring: Vec<[f64; 3]> = [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (0.0, 3.0)]
        .into_iter()
        .chain([(1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0)])
        .map(|(x, y)| flat(x, y))
        .collect();
    let around = |i: u32| [[i, (i + 1) % 4, 4 + (i + 1) % 4], [i, 4 + (i + 1) % 4, 4 + i]];
    let faces: Vec<[u32; 3]> = (0..4).flat_map(around).collect();
    let filled = cure("fill_holes", &mesh_of(&ring, &faces));
    assert_eq!(["filled_holes", "added_faces", "left_holes"].map(|what| filled.count(what)), [1, 2, 1]);
    let square = mesh_of(&ring[..4], &[[0, 1, 2], [0, 2, 3]]);
    let left = cure("fill_holes", &square);
    assert_eq!((&left.mesh, left.count("left_holes")), (&square, 1));
    // Bent along its diagonal it has a side to close.
    let mut bent = ring[..4].to_vec();
    bent[3][2] += 1.0;
    assert_eq!(cure("fill_holes", &mesh_of(&bent, &[[0, 1, 2], [0, 2, 3]])).count("filled_holes"), 1);
}

#[test]
fn an_edge_with_three_faces_comes_apart() {
    let book = mesh_of(
        &[[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]],
        &[[0, 1, 2], [1, 0, 3], [0, 1, 4]],
    );
    let before = findings(&book);
    let mended = cure("split_non_manifold", &book);
    let after = findings(&mended.mesh);
    assert_eq!((before[1], after[1]), (("non_manifold_edges", 1), ("non_manifold_edges", 0)));
    assert_eq!((after[2].1, after[3].1, after[8].1), (0, 0, 0));
    // Two leaves stay together, the third gets the edge for itself: one boundary edge more, as it must be.
    assert_eq!((before[0].1, after[0].1), (6, 7));
    assert_eq!((mended.count("split_edges"), mended.count("split_vertices")), (1, 2));
    assert_eq!(mended.bound.at_most(), Some(0.0));
}

#[test]
fn two_cubes_that_touch_along_an_edge_become_two_closed_cubes() {
    let one = cube();
    let other = one.positions().iter().map(|p| [p[0] + 1.0, p[1] + 1.0, p[2]]);
    let positions: Vec<[f64; 3]> = one.positions().iter().copied().chain(other).collect();
    let faces: Vec<[u32; 3]> =
        one.faces().iter().copied().chain(one.faces().iter().map(|f| f.map(|i| i + 8))).collect();
    let touching = cure("weld", &mesh_of(&positions, &faces)).mesh;
    assert_eq!((touching.positions().len(), findings(&touching)[1].1), (14, 1));
    let mended = is_cured_by("split_non_manifold", "non_manifold_edges", &touching);
    let found = validity(&mended.mesh, Topology::Indices);
    assert!(found.closed && found.manifold() && found.oriented);
    assert_eq!((found.components, found.genus), (2, Some(0)));
}

#[test]
fn an_hourglass_comes_apart_at_its_waist() {
    let tetrahedron = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    let other = tetrahedron.map(|f: [u32; 3]| f.map(|i| if i == 0 { 0 } else { i + 3 }));
    let mesh = mesh_of(
        &[
            [0.0; 3],
            [1.0, 0.0, 1.0],
            [0.0, 1.0, 1.0],
            [-1.0, -1.0, 1.0],
            [-1.0, 0.0, -1.0],
            [0.0, -1.0, -1.0],
            [-1.0, -1.0, -1.0],
        ],
        &[tetrahedron, other].concat(),
    );
    let mended = is_cured_by("split_non_manifold", "non_manifold_vertices", &mesh);
    assert_eq!((mended.mesh.positions().len(), mended.count("split_vertices")), (8, 1));
    assert!(validity(&mended.mesh, Topology::Indices).closed);
}

#[test]
fn a_t_junction_becomes_a_corner() {
    // A cube whose top was cut at the middle of one edge; its neighbour was not.
    let cube = cube();
    let mut positions = cube.positions().to_vec();
    positions.push([0.5, 0.0, 1.0]);
    let mut faces = cube.faces().to_vec();
    let at = faces.iter().position(|f| f.contains(&4) && f.contains(&5) && f.contains(&7)).unwrap();
    let side = faces.remove(at);
    assert_eq!(side, [4, 5, 7]);
    faces.extend([[4, 8, 7], [8, 5, 7]]);
    let mesh = mesh_of(&positions, &faces);
    assert_eq!(findings(&mesh)[8].1, 1);
    let mended = is_cured_by("resolve_t_junctions", "t_junctions", &mesh);
    assert!(validity(&mended.mesh, Topology::Indices).closed);
    assert_eq!(mended.mesh.faces().len(), 14);
}

#[test]
fn a_flipped_face_is_turned_back() {
    let good = cube();
    for face in 0..12 {
        let mut faces = good.faces().to_vec();
        faces[face].swap(1, 2);
        let mended = is_cured_by("orient", "inconsistent_edges", &mesh_of(good.positions(), &faces));
        assert_eq!(mended.count("turned_faces"), 1);
        assert!(chordal::check::findings::measure(&mended.mesh).signed_volume > 0.99);
        assert_eq!(mended.mesh, good);
    }
}

#[test]
fn a_cube_without_bottom_gets_one() {
    let good = cube();
    let faces: Vec<[u32; 3]> = good.faces().iter().copied().filter(|f| f.iter().any(|i| *i >= 4)).collect();
    assert_eq!(faces.len(), 10);
    let mended = is_cured_by("fill_holes", "boundary_edges", &mesh_of(good.positions(), &faces));
    assert_eq!((mended.count("filled_holes"), mended.count("added_faces")), (1, 2));
    assert_eq!(mended.bound.metric, chordal::budget::Metric::OneSided);
    let found = validity(&mended.mesh, Topology::Indices);
    assert!(found.closed && found.manifold() && found.oriented);
    assert!((found.measure.signed_volume - 1.0).abs() < 1e-15);
}

#[test]
fn shells_inside_each_other_face_in_turn_out_and_in() {
    let one = cube();
    // Four cubes in each other, all wound as if they were alone, two of them inside out to begin with.
    let sizes = [8.0, 1.0, 4.0, 2.0];
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for (n, size) in sizes.into_iter().enumerate() {
        positions.extend(one.positions().iter().map(|p| p.map(|x| (x - 0.5) * size)));
        faces.extend(one.faces().iter().map(|f| {
            let [a, b, c] = f.map(|i| i + 8 * n as u32);
            if n % 2 == 0 { [a, b, c] } else { [a, c, b] }
        }));
    }
    let mended = cure("orient", &mesh_of(&positions, &faces));
    let volume: f64 = chordal::check::findings::measure(&mended.mesh).signed_volume;
    assert!((volume - (512.0 - 64.0 + 8.0 - 1.0)).abs() < 1e-9, "{volume}");
    // Two that stand side by side are both outside.
    let beside: Vec<[f64; 3]> =
        positions.iter().enumerate().map(|(i, p)| [p[0] + 20.0 * (i / 8) as f64, p[1], p[2]]).collect();
    let mended = cure("orient", &mesh_of(&beside, &faces));
    let volume: f64 = chordal::check::findings::measure(&mended.mesh).signed_volume;
    assert!((volume - (512.0 + 64.0 + 8.0 + 1.0)).abs() < 1e-9, "{volume}");
}

/// Cubes of these sizes around one point; those of a negative size are wound the other way.
fn nested_cubes(sizes: &[f64]) -> Mesh {
    let one = cube();
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for (n, size) in sizes.iter().enumerate() {
        positions.extend(one.positions().iter().map(|p| p.map(|x| (x - 0.5) * size.abs())));
        faces.extend(one.faces().iter().map(|f| {
            let [a, b, c] = f.map(|i| i + 8 * n as u32);
            if *size > 0.0 { [a, b, c] } else { [a, c, b] }
        }));
    }
    mesh_of(&positions, &faces)
}

#[test]
fn what_is_solid_within_another_stays_solid_unless_cavities_are_asked_for() {
    let volume = |mesh: &Mesh, nested: NestedShells| {
        let mended = orient(mesh, Topology::Indices, nested, &Job::default()).unwrap();
        let said = ["left_nested_shells", "turned_nested_shells"].map(|what| mended.count(what));
        (chordal::check::findings::measure(&mended.mesh).signed_volume, said)
    };
    let close = |(found, said): (f64, [u64; 2]), wanted: f64, counts: [u64; 2]| {
        assert!((found - wanted).abs() < 1e-9 && said == counts, "{found} {said:?} for {wanted} {counts:?}");
    };
    let (keep, cavity) = (NestedShells::Keep, NestedShells::Cavity);
    // A body within another, both outward; and the same with both inside out.
    for sizes in [[2.0, 1.0], [1.0, 2.0], [-2.0, -1.0]] {
        let mesh = nested_cubes(&sizes);
        close(volume(&mesh, keep), 8.0 + 1.0, [1, 0]);
        close(volume(&mesh, cavity), 8.0 - 1.0, [0, 1]);
    }
    // A cavity is one either way, also where all of the solid is inside out.
    for sizes in [[2.0, -1.0], [-2.0, 1.0]] {
        close(volume(&nested_cubes(&sizes), keep), 8.0 - 1.0, [0, 0]);
        close(volume(&nested_cubes(&sizes), cavity), 8.0 - 1.0, [0, 0]);
    }
    // A body in a cavity; and two cavities in each other, of which the inner one is at odds with its depth.
    close(volume(&nested_cubes(&[4.0, -2.0, 1.0]), keep), 64.0 - 8.0 + 1.0, [0, 0]);
    close(volume(&nested_cubes(&[4.0, -2.0, -1.0]), keep), 64.0 - 8.0 - 1.0, [1, 0]);
    close(volume(&nested_cubes(&[4.0, -2.0, -1.0]), cavity), 64.0 - 8.0 + 1.0, [0, 1]);
}

#[test]
fn a_segment_counts_with_its_distance_from_the_rest() {
    let plate = [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 10.0, 0.0], [0.0, 10.0, 0.0]];
    for (height, tilt) in [(0.0, 0.0), (3.0, 0.0), (0.5, 2.0)] {
        // A face without area over the plate, away from all edges.
        let line = [[2.0, 1.0, height], [6.0, 1.0, height + tilt], [4.0, 1.0, height + 0.5 * tilt]];
        let mesh = mesh_of(&[plate.as_slice(), &line].concat(), &[[0, 1, 2], [0, 2, 3], [4, 5, 6]]);
        let mended = cure("drop_degenerate", &mesh);
        let most = mended.bound.at_most().expect("something is left");
        let truth = height + tilt;
        assert_eq!(mended.mesh.faces().len(), 2);
        assert!(most >= truth && most <= truth * 1.1 + 1e-11, "{most} for {truth}");
    }
}

#[test]
fn a_solid_that_reaches_into_another_is_no_cavity() {
    let one = cube();
    let (mut positions, mut faces) = (one.positions().to_vec(), one.faces().to_vec());
    positions.extend(one.positions().iter().map(|p| p.map(|x| x + 0.5)));
    faces.extend(one.faces().iter().map(|f| f.map(|i| i + 8)));
    let mesh = mesh_of(&positions, &faces);
    assert!(cure("orient", &mesh).is_unchanged());
}
