//! Components: each by itself is what it is alone, and shells within shells face the right way.
use chordal::budget::JobError;
use chordal::check::findings::{MeshConnectivity, MeshLocation};
use chordal::check::{Component, Facing, components, inside_out, outward, validity};
use chordal::explicit::Topology;
use chordal::{Job, Mesh};
use chordal_testkit::Random;

type Parts = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// Appends a mesh, with the other winding if `turned`.
fn add(all: &mut Parts, (positions, faces): Parts, turned: bool) {
    let first = all.0.len() as u32;
    all.0.extend(positions);
    all.1.extend(faces.into_iter().map(|[a, b, c]| {
        let face = if turned { [a, c, b] } else { [a, b, c] };
        face.map(|i| i + first)
    }));
}

fn cube(middle: [f64; 3], half: f64) -> Parts {
    let corner = |i: usize| std::array::from_fn(|k| middle[k] + if i >> k & 1 == 1 { half } else { -half });
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    ((0..8).map(corner).collect(), sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

fn mesh(parts: Parts) -> Mesh {
    Mesh::new(parts.0, parts.1).unwrap()
}

fn facings(mesh: &Mesh) -> Vec<Facing> {
    components(mesh, Topology::Indices).iter().map(|c| c.facing).collect()
}

/// The faces of one component as a mesh of its own.
fn alone(whole: &Mesh, labels: &[usize], which: usize) -> Mesh {
    let faces = (0..labels.len()).filter(|f| labels[*f] == which).map(|f| whole.faces()[f]).collect();
    Mesh::new(whole.positions().to_vec(), faces).unwrap()
}

/// The component of every face, by spreading labels over shared edges until nothing changes; none for faces
/// with two corners at one position.
fn labels(mesh: &Mesh) -> Vec<usize> {
    let n = mesh.faces().len();
    let mut label: Vec<usize> = (0..n).collect();
    let proper = |f: usize| {
        let [a, b, c] = mesh.faces()[f];
        a != b && b != c && c != a
    };
    let shared = |f: usize, g: usize| mesh.faces()[f].iter().filter(|i| mesh.faces()[g].contains(i)).count();
    loop {
        let mut changed = false;
        for f in 0..n {
            for g in 0..f {
                if proper(f) && proper(g) && shared(f, g) >= 2 && label[f] != label[g] {
                    let low = label[f].min(label[g]);
                    (label[f], label[g]) = (low, low);
                    changed = true;
                }
            }
        }
        if !changed {
            return (0..n).map(|f| if proper(f) { label[f] } else { usize::MAX }).collect();
        }
    }
}

#[test]
fn each_component_is_what_its_faces_are_alone() {
    let mut met = [0; 6];
    for seed in 0..6000 {
        let mut random = Random::new(seed);
        let n_rows = 6 + random.below([4, 8, 25][seed as usize % 3]);
        let n_faces = 2 + random.below(24);
        let points: Vec<[f64; 3]> = (0..n_rows).map(|_| [0, 1, 2].map(|_| random.below(64) as f64)).collect();
        let mut faces: Vec<[u32; 3]> =
            (0..n_faces).map(|_| [0, 1, 2].map(|_| random.below(n_rows) as u32)).collect();
        if seed % 5 == 0 {
            // A Möbius strip of five faces beneath the random ones.
            faces.extend([[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 0], [4, 0, 1]]);
        }
        let mesh = Mesh::new(points, faces).unwrap();
        let found = components(&mesh, Topology::Indices);
        let labels = labels(&mesh);
        let mut firsts: Vec<usize> = labels.iter().copied().filter(|l| *l != usize::MAX).collect();
        firsts.sort_unstable();
        firsts.dedup();
        assert_eq!(found.iter().map(|c| c.first_face as usize).collect::<Vec<_>>(), firsts, "seed {seed}");
        for c in &found {
            let alone = alone(&mesh, &labels, c.first_face as usize);
            let v = validity(&alone, Topology::Indices);
            let counts = [c.faces, c.edges, c.boundary_edges, c.boundary_loops];
            assert_eq!(
                counts,
                [v.triangles, v.edges, v.boundary_edges.count, v.boundary_loops],
                "seed {seed}"
            );
            let is = [c.closed, c.edge_manifold, c.vertex_manifold, c.oriented, c.orientable];
            let alone_is = [v.closed, v.edge_manifold, v.vertex_manifold, v.oriented, v.orientable];
            assert_eq!(is, alone_is, "seed {seed}");
            assert_eq!((c.euler, c.genus), (v.euler, v.genus), "seed {seed}");
            assert!((c.measure.area - v.measure.area).abs() <= 1e-12 * v.measure.area, "seed {seed}");
            let met_now =
                [c.closed, !c.edge_manifold, !c.vertex_manifold, !c.orientable, found.len() > 3, c.faces > 6];
            met.iter_mut().zip(met_now).for_each(|(n, is)| *n += i32::from(is));
        }
    }
    assert!(met.iter().all(|n| *n > 20), "the random meshes are too tame: {met:?}");
}

#[test]
fn shells_within_shells_alternate_between_solid_and_cavity() {
    for turned in 0..16 {
        let mut all = Parts::default();
        // Not concentric, so that no ray meets all of them alike.
        let shells =
            [([0.0, 0.0, 0.0], 8.0), ([1.0, 1.0, 0.5], 5.0), ([1.5, 0.5, 0.5], 3.0), ([20.0, 0.0, 0.0], 2.0)];
        let is_turned = |i: usize| turned >> i & 1 == 1;
        for (i, (middle, half)) in shells.into_iter().enumerate() {
            add(&mut all, cube(middle, half), is_turned(i));
        }
        let mesh = mesh(all);
        let found = components(&mesh, Topology::Indices);
        let depths: Vec<_> = found.iter().map(|c| c.depth).collect();
        assert_eq!(depths, [Some(0), Some(1), Some(2), Some(0)], "{turned:04b}");
        for (i, c) in found.iter().enumerate() {
            let right = is_turned(i) == (i == 1);
            assert_eq!(
                c.facing,
                if right { Facing::Outward } else { Facing::InsideOut },
                "{turned:04b}, shell {i}"
            );
        }
        assert_eq!(outward(&found), Some(turned == 0b0010));
        let wrong = inside_out(&mesh, &found);
        assert_eq!(wrong.count, (turned ^ 0b0010_i32).count_ones() as u64);
        for witness in &wrong.witnesses {
            let MeshLocation::Face(face) = witness.place else { panic!("{witness:?}") };
            assert_eq!(face % 12, 0, "the first face of a shell");
        }
    }
}

#[test]
fn many_shells_side_by_side_and_one_around_them() {
    let mut all = Parts::default();
    add(&mut all, cube([5.0; 3], 100.0), false);
    for i in 0..400_usize {
        let at = [(i % 20) as f64, (i / 20) as f64, 0.25 * (i % 3) as f64];
        add(&mut all, cube(at, 0.375), i % 7 != 3);
    }
    let found = components(&mesh(all), Topology::Indices);
    assert_eq!(found.len(), 401);
    for (i, c) in found.iter().enumerate() {
        let (depth, facing) = match i {
            0 => (0, Facing::Outward),
            i if (i - 1) % 7 == 3 => (1, Facing::InsideOut),
            _ => (1, Facing::Outward),
        };
        assert_eq!((c.depth, c.facing), (Some(depth), facing), "shell {i}");
    }
}

#[test]
fn a_hollow_beside_a_solid_is_not_within_it_though_its_box_is() {
    // An L-shaped prism whose box holds a cube that it does not enclose.
    let outline = [[0.0, 0.0], [9.0, 0.0], [9.0, 2.0], [2.0, 2.0], [2.0, 9.0], [0.0, 9.0]];
    let positions = outline.iter().flat_map(|[x, y]| [[*x, *y, 0.0], [*x, *y, 9.0]]).collect();
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for i in 0..6 {
        let (a, b) = (2 * i, 2 * ((i + 1) % 6));
        faces.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
    }
    for [a, b, c] in [[0, 1, 2], [0, 2, 3], [0, 3, 5], [3, 4, 5]] {
        faces.extend([[2 * a, 2 * c, 2 * b], [2 * a + 1, 2 * b + 1, 2 * c + 1]]);
    }
    let mut all = (positions, faces);
    add(&mut all, cube([6.0, 6.0, 5.0], 1.0), false);
    let found = components(&mesh(all), Topology::Indices);
    assert_eq!(
        found.iter().map(|c| (c.depth, c.facing)).collect::<Vec<_>>(),
        [(Some(0), Facing::Outward); 2]
    );
}

#[test]
fn what_has_no_inside_has_no_outside_and_what_has_no_volume_is_left_open() {
    let (positions, mut faces) = cube([0.0; 3], 1.0);
    faces.pop();
    let open = mesh((positions.clone(), faces.clone()));
    assert_eq!(facings(&open), [Facing::NoInside]);
    assert_eq!(outward(&components(&open, Topology::Indices)), None);
    // One face turned: closed, but the winding contradicts itself.
    let (_, mut faces) = cube([0.0; 3], 1.0);
    faces[3].swap(0, 1);
    assert_eq!(facings(&mesh((positions, faces))), [Facing::NoInside]);
    // A face and its back enclose nothing.
    let flat = Mesh::new(vec![[0.0, 0.1, 0.2], [1.3, 0.0, 0.7], [0.1, 1.1, 0.9]], vec![[0, 1, 2], [0, 2, 1]]);
    assert_eq!(facings(&flat.unwrap()), [Facing::Undecided]);
    let none = Mesh::new(vec![[0.0; 3]], vec![[0, 0, 0]]).unwrap();
    assert_eq!((facings(&none).len(), outward(&components(&none, Topology::Indices))), (0, None));
}

#[test]
fn two_cubes_that_share_an_edge_have_an_inside_where_the_edge_is_run_through_evenly() {
    let mut all = cube([0.0; 3], 1.0);
    add(&mut all, cube([2.0, 2.0, 0.0], 1.0), false);
    let found = components(&mesh(all.clone()), Topology::Positions);
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].edge_manifold, found[0].closed, found[0].facing), (false, true, Facing::Outward));
    assert_eq!(found[0].measure.signed_volume, 16.0);
    // The second one alone turned: the shared edge is still run through evenly, and the volumes cancel.
    let mut all = cube([0.0; 3], 1.0);
    add(&mut all, cube([2.0, 2.0, 0.0], 1.0), true);
    assert_eq!(components(&mesh(all), Topology::Positions)[0].facing, Facing::Undecided);
}

#[test]
fn h54_h58_inside_out_is_told_at_every_scale_and_far_away() {
    let shells = |scale: f64, offset: f64| {
        let mut all = Parts::default();
        add(&mut all, cube([0.0; 3], 8.0), true);
        add(&mut all, cube([1.0; 3], 3.0), true);
        all.0.iter_mut().for_each(|p| *p = p.map(|x| (x + offset) * scale));
        components(&mesh(all), Topology::Indices)
    };
    let facing = |found: Vec<Component>| found.iter().map(|c| (c.depth, c.facing)).collect::<Vec<_>>();
    let wanted = [(Some(0), Facing::InsideOut), (Some(1), Facing::Outward)];
    for exponent in [-300, -100, -20, 0, 20, 100, 300] {
        for offset in [0.0, 1e6, 1_048_576.0 * 1024.0] {
            let scale = 2.0_f64.powi(exponent);
            assert_eq!(facing(shells(scale, offset)), wanted, "2^{exponent}, offset {offset}");
        }
    }
}

#[test]
fn both_ways_are_one_where_no_two_positions_are_at_one_place() {
    let whole = mesh(cube([0.0; 3], 1.0));
    let seen = MeshConnectivity::by_indices_and_positions(&whole);
    assert!(seen.by_positions.is_none() && seen.duplicate_vertices.is_none());
    assert_eq!(seen.by_indices.validity(), validity(&whole, Topology::Indices));
    let soup = whole.faces().iter().flatten().map(|i| whole.positions()[*i as usize]).collect();
    let soup = Mesh::new(soup, (0..12).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect()).unwrap();
    let seen = MeshConnectivity::by_indices_and_positions(&soup);
    assert_eq!(seen.duplicate_vertices.count, 36 - 8);
    assert_eq!(seen.by_positions.unwrap().validity(), validity(&soup, Topology::Positions));
    let witness = &seen.duplicate_vertices.witnesses[0];
    let MeshLocation::RepeatedVertex { vertex, of } = witness.place else { panic!("{witness:?}") };
    assert!(of < vertex && soup.positions()[of as usize] == soup.positions()[vertex as usize]);
    // Tied by a position id, they are no duplicates.
    let ids = chordal::explicit::position_id_by_bits(soup.positions());
    let tied = soup.with_position_id(ids).unwrap();
    assert!(MeshConnectivity::by_indices_and_positions(&tied).by_positions.is_none());
}

#[test]
fn a_job_is_heard_where_components_enclose_each_other() {
    let mut parts = Parts::default();
    add(&mut parts, cube([0.0; 3], 2.0), false);
    add(&mut parts, cube([0.0; 3], 1.0), true);
    let mesh = mesh(parts);
    let surface = MeshConnectivity::new(&mesh, Topology::Indices);
    assert_eq!(surface.components_under(&Job::default().with_threads(1)).unwrap(), surface.components());
    let mut poor = Job::default();
    poor.memory_limit = 1000;
    assert!(matches!(surface.components_under(&poor), Err(JobError::Refused(_))));
    let cancelled = Job::default();
    cancelled.cancel();
    assert!(matches!(surface.components_under(&cancelled), Err(JobError::Cancelled)));
    // One alone takes no tree, and no memory to speak of.
    let one = cube([0.0; 3], 1.0);
    let one = Mesh::new(one.0, one.1).unwrap();
    assert_eq!(MeshConnectivity::new(&one, Topology::Indices).components_under(&poor).unwrap().len(), 1);
}
