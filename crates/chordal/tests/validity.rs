//! Validity of shapes whose topology is known: laws first, then each fault by itself, then files.
use chordal::Mesh;
use chordal::check::findings::{MAX_WITNESSES, MeshLocation, measure};
use chordal::check::{Validity, is_collinear, validity};
use chordal::explicit::adjacency::{Twin, Twins};
use chordal::explicit::{Topology, position_id_by_bits};
use chordal_testkit::corpus;

/// A vertex `i` columns along and `j` across.
type At<'a> = &'a dyn Fn(usize, usize) -> u32;

/// Two triangles for each of `nu` × `nv` squares.
fn grid_faces(nu: usize, nv: usize, at: At) -> Vec<[u32; 3]> {
    let square =
        |i, j| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
    (0..nu * nv).flat_map(|q| square(q / nv, q % nv)).collect()
}

fn torus(nu: usize, nv: usize) -> Mesh {
    let angle = |i: usize, n: usize| i as f64 * std::f64::consts::TAU / n as f64;
    let point = |v: usize| {
        let (a, b) = (angle(v / nv, nu), angle(v % nv, nv));
        [(2.0 + b.cos()) * a.cos(), (2.0 + b.cos()) * a.sin(), b.sin()]
    };
    let faces = grid_faces(nu, nv, &|i, j| ((i % nu) * nv + j % nv) as u32);
    Mesh::new((0..nu * nv).map(point).collect(), faces).unwrap()
}

/// A band of `n` squares around a cylinder, the last joined to the first with or without half a turn.
fn band(n: usize, half_turn: bool) -> Mesh {
    let point = |v: usize| {
        let a = (v / 2) as f64 * std::f64::consts::TAU / n as f64;
        [a.cos(), a.sin(), (v % 2) as f64]
    };
    let at = |i: usize, j: usize| if i == n && half_turn { 1 - j } else { 2 * (i % n) + j } as u32;
    Mesh::new((0..2 * n).map(point).collect(), grid_faces(n, 1, &at)).unwrap()
}

/// The eight corners of the unit cube and its twelve faces, the front outside.
fn cube() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let corners = (0..8).map(|i| [(i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2 & 1) as f64]).collect();
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    (corners, sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

/// The cube with four vertices of its own for each side, as hard edges want it.
fn cube_24() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let (corners, faces) = cube();
    let (mut positions, mut split) = (Vec::new(), Vec::new());
    for pair in faces.chunks(2) {
        let first = positions.len() as u32;
        let side = [pair[0][0], pair[0][1], pair[0][2], pair[1][2]];
        positions.extend(side.map(|i| corners[i as usize]));
        split.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    (positions, split)
}

fn check(positions: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> Validity {
    validity(&Mesh::new(positions, faces).unwrap(), Topology::Indices)
}

fn is_sound(v: &Validity) -> bool {
    v.closed && v.manifold() && v.oriented && v.orientable
}

/// Points in general position.
fn points(n: usize) -> Vec<[f64; 3]> {
    (0..n).map(|i| i as f64).map(|t| [t, t * t, t * t * t]).collect()
}

#[test]
fn a_sound_closed_mesh_has_euler_number_two_minus_two_genus() {
    let (positions, faces) = cube();
    let v = check(positions, faces);
    assert!(is_sound(&v));
    assert_eq!((v.edges, v.euler, v.genus, v.components), (18, 2, Some(0), 1));
    for (nu, nv) in [(3, 3), (5, 4), (40, 30)] {
        let v = validity(&torus(nu, nv), Topology::Indices);
        assert!(is_sound(&v));
        assert_eq!((v.euler, v.genus, v.components, v.boundary_loops), (0, Some(1), 1, 0));
        assert_eq!(v.edges, 3 * v.triangles / 2);
        assert_eq!(v.triangles_per_vertex, Some(6.0));
    }
}

#[test]
fn split_vertices_close_by_position_id_and_by_bits_but_not_by_index() {
    let (positions, faces) = cube_24();
    let ids = position_id_by_bits(&positions);
    let bare = Mesh::new(positions, faces).unwrap();
    let tied = bare.clone().with_position_id(ids).unwrap();
    for (mesh, topology) in
        [(&tied, Topology::Indices), (&tied, Topology::Positions), (&bare, Topology::Positions)]
    {
        let v = validity(mesh, topology);
        assert!(is_sound(&v), "{topology:?}");
        assert_eq!((v.vertices, v.positions, v.edges, v.genus), (24, 8, 18, Some(0)));
    }
    let v = validity(&bare, Topology::Indices);
    assert_eq!((v.components, v.boundary_edges.count, v.boundary_loops), (6, 24, 6));
    assert!(!v.closed && v.manifold());
}

#[test]
fn minus_zero_is_the_same_place_as_zero() {
    let negate = |p: [f64; 3]| p.map(|x| if x == 0.0 { -0.0 } else { x });
    let (mut positions, faces) = cube_24();
    positions[..4].iter_mut().for_each(|p| *p = negate(*p));
    assert!(is_sound(&validity(&Mesh::new(positions, faces).unwrap(), Topology::Positions)));
}

#[test]
fn an_open_cylinder_has_two_loops_and_a_moebius_strip_one_and_one_side() {
    let v = validity(&band(7, false), Topology::Indices);
    assert!(v.manifold() && v.oriented && v.orientable && !v.closed);
    assert_eq!((v.boundary_loops, v.boundary_edges.count, v.euler, v.genus), (2, 14, 0, Some(0)));
    let v = validity(&band(7, true), Topology::Indices);
    assert!(v.manifold() && !v.oriented && !v.orientable && !v.closed);
    assert_eq!((v.boundary_loops, v.boundary_edges.count, v.euler, v.genus), (1, 14, 0, None));
    assert_eq!(v.inconsistent_edges.count, 1);
}

#[test]
fn a_torus_with_a_hole_keeps_its_handle() {
    let whole = torus(8, 6);
    let faces = whole.faces()[3..].to_vec();
    let v = check(whole.positions().to_vec(), faces);
    assert_eq!((v.genus, v.boundary_loops, v.components), (Some(1), 1, 1));
}

#[test]
fn one_turned_face_is_inconsistent_along_its_edges_but_can_be_turned_back() {
    let (positions, mut faces) = cube();
    faces[4].swap(1, 2);
    let v = check(positions, faces);
    assert!(v.closed && v.manifold() && !v.oriented && v.orientable);
    assert_eq!(v.inconsistent_edges.count, 3);
    for witness in &v.inconsistent_edges.witnesses {
        assert!(matches!(&witness.place, MeshLocation::Edge { faces, .. } if faces.contains(&4)));
    }
}

#[test]
fn two_fans_at_a_vertex_are_a_bow_tie_and_their_loops_stay_two() {
    let v = check(points(5), vec![[0, 1, 2], [0, 3, 4]]);
    assert!(v.edge_manifold && !v.vertex_manifold && !v.manifold());
    assert_eq!((v.components, v.boundary_loops, v.boundary_chains), (2, 2, 0));
    assert_eq!(v.non_manifold_vertices.count, 1);
    assert_eq!(v.non_manifold_vertices.witnesses[0].place, MeshLocation::Vertex(0));
    assert_eq!(v.genus, None);
}

#[test]
fn two_solids_that_touch_at_a_corner_are_closed_but_not_manifold() {
    let (mut positions, mut faces) = cube();
    positions
        .extend((1..8).map(|i| [1.0 + (i & 1) as f64, 1.0 + (i >> 1 & 1) as f64, 1.0 + (i >> 2 & 1) as f64]));
    let other = |i: u32| if i == 0 { 7 } else { i + 7 };
    faces.extend(faces.clone().into_iter().map(|face| face.map(other)));
    let v = check(positions, faces);
    assert!(v.closed && v.edge_manifold && v.oriented && !v.vertex_manifold);
    assert_eq!((v.components, v.non_manifold_vertices.count), (2, 1));
    assert_eq!(v.non_manifold_vertices.witnesses[0].at, [1.0; 3]);
}

#[test]
fn an_edge_with_three_faces_is_no_manifold_and_ends_the_boundary() {
    let mesh = Mesh::new(points(5), vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]]).unwrap();
    let v = validity(&mesh, Topology::Indices);
    assert!(!v.edge_manifold && !v.vertex_manifold && v.oriented && !v.closed);
    assert_eq!((v.edges, v.components, v.boundary_edges.count), (7, 1, 6));
    assert_eq!((v.boundary_loops, v.boundary_chains), (0, 3));
    assert_eq!(v.non_manifold_edges.count, 1);
    let place = MeshLocation::Edge { vertices: [0, 1], faces: vec![0, 1, 2] };
    assert_eq!(v.non_manifold_edges.witnesses[0].place, place);
    let twins = Twins::new(&mesh, Topology::Indices);
    assert_eq!(twins.non_manifold_edges().collect::<Vec<_>>(), [[0, 3, 6]]);
    assert_eq!([0, 3, 6].map(|h| twins.get(h)), [Twin::NonManifold; 3]);
}

#[test]
fn repeated_faces_are_named_with_the_face_they_repeat() {
    let mut faces = vec![[0, 1, 2], [2, 1, 3], [1, 2, 0], [0, 2, 1]];
    let v = check(points(4), faces.clone());
    assert_eq!((v.duplicate_faces.count, v.opposite_faces.count), (2, 1));
    assert_eq!(v.duplicate_faces.witnesses[0].place, MeshLocation::Repeated { face: 2, of: 0 });
    assert_eq!(v.opposite_faces.witnesses[0].place, MeshLocation::Repeated { face: 3, of: 0 });
    // A face and its back make a closed surface: a flat ball.
    faces = vec![[0, 1, 2], [0, 2, 1]];
    let v = check(points(3), faces);
    assert!(is_sound(&v));
    assert_eq!((v.euler, v.opposite_faces.count), (2, 1));
}

#[test]
fn faces_without_area_are_told_from_thin_ones() {
    // On one line, twice one vertex, two vertices at one place, and off the line by the last bit.
    let positions = vec![[0.0; 3], [1.0; 3], [2.0; 3], [1.0; 3], [1.0, 1.0, 1.0_f64.next_up()]];
    let v = check(positions, vec![[0, 1, 2], [0, 0, 1], [0, 1, 3], [0, 4, 2]]);
    assert_eq!((v.zero_area_faces.count, v.collapsed_faces.count), (3, 1));
    let flat: Vec<_> = v.zero_area_faces.witnesses.iter().map(|w| w.place.clone()).collect();
    assert_eq!(flat, [0, 1, 2].map(MeshLocation::Face));
    // The one that has an area is a sliver.
    assert_eq!((v.slivers.count, &v.slivers.witnesses[0].place), (1, &MeshLocation::Face(3)));
}

#[test]
fn a_collapsed_face_takes_no_part_and_its_neighbours_meet() {
    // A square whose diagonal has opened into a triangle with two corners at one place.
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]];
    let faces = vec![[0, 1, 2], [0, 2, 4], [4, 2, 3]];
    let mesh = Mesh::new(positions, faces).unwrap();
    let v = validity(&mesh, Topology::Positions);
    assert_eq!((v.collapsed_faces.count, v.edges, v.euler, v.boundary_loops), (1, 5, 1, 1));
    let twins = Twins::new(&mesh, Topology::Positions);
    assert_eq!(twins.get(2), Twin::Pair(6));
    assert_eq!(twins.get(3), Twin::Collapsed);
}

#[test]
fn unused_rows_are_counted_and_witnesses_stop_at_ten() {
    let v = check(points(30), vec![[3, 4, 5]]);
    assert_eq!((v.unused_vertices.count, v.euler), (27, 1));
    assert_eq!(v.unused_vertices.witnesses.len(), MAX_WITNESSES);
    assert_eq!(v.unused_vertices.witnesses[3].place, MeshLocation::Vertex(6));
    let empty = check(Vec::new(), Vec::new());
    assert!(!empty.closed && empty.manifold() && empty.oriented);
    assert_eq!((empty.euler, empty.genus, empty.measure.area), (0, Some(0), 0.0));
    assert_eq!(check(points(2), Vec::new()).unused_vertices.count, 2);
}

#[test]
fn a_hub_of_a_hundred_thousand_faces_is_one_fan() {
    let n = 100_000;
    let rim = |i: u32| 1 + i % n;
    let positions = (0..=n).map(|i| [f64::from(i), f64::from(i % 7), 0.0]).collect();
    let v = check(positions, (0..n).map(|i| [0, rim(i), rim(i + 1)]).collect());
    assert!(v.manifold() && v.oriented);
    assert_eq!((v.boundary_loops, v.boundary_edges.count, v.euler), (1, u64::from(n), 1));
}

#[test]
fn collinear_is_exact_across_the_whole_range_of_numbers() {
    for scale in [1.0, 5e-324, 1e-300, 1e-160, 1e150, 1e300] {
        let at = |k: f64| [k * scale, 2.0 * k * scale, -k * scale];
        // Small integers times any number may round: take multiples that are exact.
        assert!(is_collinear(at(1.0), at(2.0), at(4.0)), "{scale}");
        let [x, y, z] = at(4.0);
        assert!(!is_collinear(at(1.0), at(2.0), [x, y.next_up(), z]), "{scale}");
    }
    // Products that underflow, and magnitudes that no sum in f64 can hold together.
    assert!(!is_collinear([0.0; 3], [1e-200, 0.0, 0.0], [0.0, 1e-200, 0.0]));
    assert!(!is_collinear([1e300, 0.0, 0.0], [-1e300, 0.0, 0.0], [0.0, 5e-324, 0.0]));
    assert!(is_collinear([f64::MAX; 3], [-f64::MAX; 3], [5e-324; 3]));
    assert!(is_collinear([f64::MAX, 1.0, 0.0], [-f64::MAX, 1.0, 0.0], [5e-324, 1.0, 0.0]));
}

#[test]
fn area_and_volume_of_a_cube_at_every_scale_and_far_from_the_origin() {
    let (corners, faces) = cube();
    // Powers of two: every product is exact.
    for exponent in [-300, -20, 0, 20, 300] {
        let scale = 2.0_f64.powi(exponent);
        for offset in [0.0, 1024.0] {
            let positions = corners.iter().map(|p| p.map(|x| (x + offset) * scale)).collect();
            let found = measure(&Mesh::new(positions, faces.clone()).unwrap());
            let wanted = [6.0 * scale * scale, scale * scale * scale];
            let close = |found: f64, wanted: f64| (found - wanted).abs() <= 1e-15 * wanted;
            assert!(
                close(found.area, wanted[0]) && close(found.signed_volume, wanted[1]),
                "{exponent} {found:?}"
            );
        }
    }
    let turned = faces.iter().map(|&[a, b, c]| [a, c, b]).collect();
    assert_eq!(measure(&Mesh::new(corners, turned).unwrap()).signed_volume, -1.0);
}

#[cfg(feature = "threads")]
#[test]
fn one_thread_and_many_report_the_same() {
    let mesh = torus(120, 90);
    let on = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| validity(&mesh, Topology::Indices))
    };
    assert_eq!(on(1), on(3));
}

/// The triangles of an OFF or OBJ file, faces cut into fans: enough for the files below.
fn read(path: &std::path::Path) -> Mesh {
    let text = std::fs::read_to_string(path).unwrap();
    let number = |word: &str| word.parse::<f64>().unwrap();
    let point = |words: &[&str]| [number(words[0]), number(words[1]), number(words[2])];
    let fan = |row: Vec<u32>| (2..row.len()).map(|k| [row[0], row[k - 1], row[k]]).collect::<Vec<_>>();
    let mut lines = text.lines().map(|l| l.split_whitespace().collect::<Vec<_>>()).filter(|w| !w.is_empty());
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    if path.extension().is_some_and(|e| e == "off") {
        let n: usize = lines.nth(1).unwrap()[0].parse().unwrap();
        positions = lines.by_ref().take(n).map(|words| point(&words)).collect();
        faces =
            lines.flat_map(|words| fan(words[1..].iter().map(|w| w.parse().unwrap()).collect())).collect();
    } else {
        let index = |word: &&str| word.split('/').next().unwrap().parse::<u32>().unwrap() - 1;
        for words in lines {
            match words[0] {
                "v" => positions.push(point(&words[1..])),
                "f" => faces.extend(fan(words[1..].iter().map(index).collect())),
                _ => {}
            }
        }
    }
    Mesh::new(positions, faces).unwrap()
}

fn data(path: &str) -> Option<Mesh> {
    corpus::find(path).map(|file| read(&file))
}

#[test]
fn files_have_the_topology_that_they_are_known_for() {
    let known: [(&str, [u64; 3], Option<u64>); 6] = [
        // Components, boundary loops, non-manifold vertices; genus.
        ("mesh/libigl/3holes.off", [1, 0, 0], Some(3)),
        ("mesh/libigl/fertility.off", [1, 0, 0], Some(4)),
        ("mesh/libigl/cow.off", [1, 0, 0], Some(0)),
        ("topology/geometry-central/test/assets/moebius.obj", [1, 1, 0], None),
        ("topology/geometry-central/test/assets/fan3.obj", [1, 0, 2], None),
        ("topology/geometry-central/test/assets/hourglass_ico.obj", [2, 0, 1], None),
    ];
    for (path, [components, loops, bow_ties], genus) in known {
        let Some(mesh) = data(path) else { continue };
        let v = validity(&mesh, Topology::Indices);
        assert_eq!(v.components, components, "{path}");
        assert_eq!(v.boundary_loops, loops, "{path}");
        assert_eq!(v.non_manifold_vertices.count, bow_ties, "{path}");
        assert_eq!(v.genus, genus, "{path}");
    }
}
