//! What holds for every mesh, on random ones full of faults.
use super::sampler::one_sided;
use super::*;
use chordal_testkit::{Random, cases};

/// Few positions on a small lattice, rows tied at random, any faces: every kind of fault, also several at
/// once.
fn random_soup(random: &mut Random) -> Mesh {
    let n_rows = 3 + random.below(8);
    let n_ids = 1 + random.below(n_rows);
    let ids: Vec<u32> = (0..n_rows).map(|_| random.below(n_ids) as u32).collect();
    let lattice: Vec<[f64; 3]> =
        (0..n_ids).map(|_| std::array::from_fn(|_| random.below(3) as f64)).collect();
    let positions = ids.iter().map(|&id| lattice[id as usize]).collect();
    let n_faces = random.below(14);
    let faces = (0..n_faces).map(|_| std::array::from_fn(|_| random.below(n_rows) as u32)).collect();
    Mesh::new(positions, faces).unwrap().with_position_id(ids).unwrap()
}

/// A band or closed surface of quads with a few faces removed, turned, repeated or glued to a wrong vertex.
fn broken_band(random: &mut Random) -> Mesh {
    let (nu, nv) = (3 + random.below(4), 3 + random.below(4));
    let (twisted, open) = (random.below(2) == 0, random.below(2) == 0);
    let at = |i: usize, j: usize| {
        let width = if open { 2 } else { nv };
        let mirrored = if i == nu && twisted { (2 * width - 1 - j) % width } else { j % width };
        ((i % nu) * nv + mirrored) as u32
    };
    let mut faces: Vec<[u32; 3]> = (0..nu * nv)
        .map(|quad| (quad / nv, quad % nv))
        .filter(|&(_, j)| !(open && j > 0))
        .flat_map(|(i, j)| {
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        })
        .collect();
    for _ in 0..random.below(6) {
        let face = random.below(faces.len());
        match random.below(4) {
            0 => drop(faces.swap_remove(face)),
            1 => faces[face].swap(1, 2),
            2 => faces.push(faces[face]),
            _ => faces[face][random.below(3)] = random.below(nu * nv) as u32,
        }
    }
    let positions: Vec<[f64; 3]> =
        (0..nu * nv).map(|v| [(v / nv) as f64, (v % nv) as f64, random.below(9) as f64]).collect();
    mesh_of(&positions, &faces)
}

fn random_mesh(seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    if seed.is_multiple_of(3) { broken_band(&mut random) } else { random_soup(&mut random) }
}

const SEEDS: u64 = 3000;

#[test]
fn every_cure_is_done_at_once_and_says_nothing_the_second_time() {
    for seed in 0..SEEDS {
        let mesh = random_mesh(seed);
        for (name, cure) in CURES {
            let once = cure(&mesh);
            assert!(!once.is_unchanged() || once.mesh == mesh, "seed {seed}, {name}: changed without a word");
            let twice = cure(&once.mesh);
            assert!(twice.is_unchanged(), "seed {seed}, {name}: {:?}", twice.changes);
            assert_eq!(twice.mesh, once.mesh, "seed {seed}, {name}");
        }
    }
}

#[test]
fn after_orient_nothing_is_inside_out() {
    let mut turned = 0;
    for seed in 0..SEEDS {
        let mesh = random_mesh(seed);
        let mended = cure("orient", &mesh);
        for component in chordal::check::components(&mended.mesh, Topology::Indices) {
            assert_ne!(component.facing, chordal::check::Facing::InsideOut, "seed {seed}");
        }
        turned += mended.count("turned_faces");
    }
    assert!(turned > 1000);
}

/// The findings that each cure takes away, and what it must say where it does not.
const CURED: [(&str, &[&str], &str); 8] = [
    ("drop_duplicates either way", &["duplicate_faces"], ""),
    ("drop_degenerate", &["collapsed_faces"], ""),
    ("drop_degenerate", &["zero_area_faces"], "left_faces"),
    ("resolve_t_junctions", &["t_junctions"], "left_t_junctions"),
    ("split_non_manifold", &["non_manifold_edges", "non_manifold_vertices"], ""),
    ("orient", &["inconsistent_edges"], "left_unorientable"),
    ("fill_holes", &["boundary_edges"], "left_holes"),
    ("drop_unused", &["unused_vertices"], ""),
];

#[test]
fn the_finding_is_gone_or_named_as_left() {
    let (mut cured, mut left) = (0, 0);
    for seed in 0..SEEDS {
        let mesh = random_mesh(seed);
        for (name, gone, but) in CURED {
            let mended = cure(name, &mesh);
            for (of, n) in findings(&mended.mesh) {
                if gone.contains(&of) && n > 0 {
                    assert!(!but.is_empty() && mended.count(but) > 0, "seed {seed}, {name}: {n} {of}");
                    left += 1;
                }
            }
            cured += u32::from(!mended.is_unchanged());
        }
    }
    assert!(cured > left && left > 0, "{cured} cured, {left} left");
}

#[test]
fn no_edge_gets_a_third_face_and_no_position_a_second_fan() {
    // Closing, cutting and dropping keep a manifold mesh manifold; what was wrong elsewhere is no excuse.
    for seed in 0..SEEDS {
        let mesh = cure("split_non_manifold", &random_mesh(seed)).mesh;
        for name in ["orient", "fill_holes", "resolve_t_junctions"] {
            let mended = cure(name, &mesh);
            let found = validity(&mended.mesh, Topology::Indices);
            assert!(found.edge_manifold, "seed {seed}, {name}: {:?}", found.non_manifold_edges);
            if name != "resolve_t_junctions" {
                assert!(found.vertex_manifold, "seed {seed}, {name}: {:?}", found.non_manifold_vertices);
            }
        }
        let cut = findings(&cure("resolve_t_junctions", &mesh).mesh)[6].1;
        assert!(cut <= findings(&mesh)[6].1, "seed {seed}: a cut makes faces with area");
        // Filling makes faces with area, and neighbours that agree.
        assert_eq!(findings(&cure("fill_holes", &mesh).mesh)[6].1, findings(&mesh)[6].1, "seed {seed}");
        let oriented = cure("orient", &mesh).mesh;
        if findings(&oriented)[3].1 == 0 {
            assert_eq!(findings(&cure("fill_holes", &oriented).mesh)[3].1, 0, "seed {seed}");
        }
    }
}

#[test]
fn what_was_closed_stays_closed() {
    let mut met = 0;
    for seed in 0..4 * SEEDS {
        let mesh = random_mesh(seed);
        if !validity(&mesh, Topology::Indices).closed {
            continue;
        }
        let mended = cure("drop_degenerate", &mesh);
        met += u32::from(!mended.is_unchanged());
        let found = validity(&mended.mesh, Topology::Indices);
        assert!(found.closed || mended.mesh.faces().is_empty(), "seed {seed}: {:?}", mended.changes);
    }
    assert!(met > 20, "{met} closed meshes had faces without area");
}

#[test]
fn a_sampler_never_finds_more_than_the_bound() {
    let mut checked = 0;
    for seed in 0..cases(400) as u64 {
        let mesh = random_mesh(seed);
        for (name, cure) in CURES {
            let mended = cure(&mesh);
            let Some(most) = mended.bound.at_most() else {
                assert!(mended.mesh.faces().is_empty(), "seed {seed}, {name}: no bound");
                continue;
            };
            // The samples are rounded, and so are their distances: coordinates are below 16.
            let room = 1e-12;
            let there = one_sided(&mesh, &mended.mesh);
            assert!(there <= most + room, "seed {seed}, {name}: {there} > {most}");
            if mended.bound.metric == chordal::budget::Metric::Hausdorff {
                let back = one_sided(&mended.mesh, &mesh);
                assert!(back <= most + room, "seed {seed}, {name}: {back} > {most}");
            }
            checked += usize::from(!mended.is_unchanged());
        }
    }
    assert!(checked > 300, "{checked} changes were checked");
}

#[test]
fn powers_of_two_change_no_index() {
    // By default a fourth of them; every third is a band, so of both kinds.
    for seed in (0..SEEDS).step_by(if chordal_testkit::is_long() { 1 } else { 4 }) {
        let mesh = random_mesh(seed);
        for power in [-20, 20] {
            let scale = libm::ldexp(1.0, power);
            let scaled = mesh.positions().iter().map(|p| p.map(|x| x * scale)).collect();
            let scaled = mesh.with_positions(scaled).unwrap();
            for (name, cure) in CURES {
                let (one, other) = (cure(&mesh), cure(&scaled));
                assert_eq!(one.mesh.faces(), other.mesh.faces(), "seed {seed}, {name}");
                assert_eq!(one.mesh.position_id(), other.mesh.position_id(), "seed {seed}, {name}");
            }
        }
    }
}
