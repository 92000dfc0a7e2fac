//! Welding within a tolerance.
use super::sampler::one_sided;
use super::*;
use chordal::Tolerance;
use chordal_testkit::Random;
use chordal_testkit::sampler::distance;

fn within(mesh: &Mesh, tolerance: f64) -> MendedMesh {
    weld(mesh, Weld::Within(Tolerance::new(tolerance).unwrap()), &Job::default()).unwrap()
}

fn cloud(random: &mut Random, n: usize) -> Mesh {
    let positions: Vec<[f64; 3]> = (0..n).map(|_| std::array::from_fn(|_| random.unit())).collect();
    let faces: Vec<[u32; 3]> = (0..n).map(|_| std::array::from_fn(|_| random.below(n) as u32)).collect();
    mesh_of(&positions, &faces)
}

#[test]
fn nothing_moves_further_than_the_tolerance_and_nothing_stays_within_it() {
    for seed in 0..100 {
        let mut random = Random::new(seed);
        let mesh = cloud(&mut random, 60);
        let tolerance = [0.01, 0.1, 0.3, 2.0][seed as usize % 4];
        let mended = within(&mesh, tolerance);
        let most = mended.bound.at_most().unwrap();
        assert!(most <= tolerance, "seed {seed}");
        let rows = mended.mesh.positions();
        for (i, p) in rows.iter().enumerate() {
            assert!(mesh.positions().contains(p), "seed {seed}: a centre is a position of the input");
            assert!(rows[..i].iter().all(|q| distance(*p, *q) > tolerance - 1e-15), "seed {seed}");
        }
        assert_eq!(mended.mesh.faces().len(), mesh.faces().len());
        for (face, was) in mended.mesh.faces().iter().zip(mesh.faces()) {
            for k in 0..3 {
                let moved = distance(rows[face[k] as usize], mesh.positions()[was[k] as usize]);
                assert!(moved <= most, "seed {seed}: {moved} > {most}");
            }
        }
        assert!(one_sided(&mesh, &mended.mesh) <= most + 1e-12, "seed {seed}");
        assert!(one_sided(&mended.mesh, &mesh) <= most + 1e-12, "seed {seed}");
        let twice = within(&mended.mesh, tolerance);
        assert!(twice.is_unchanged() && twice.mesh == mended.mesh, "seed {seed}");
    }
}

#[test]
fn the_order_of_the_rows_does_not_matter() {
    for seed in 0..50 {
        let mut random = Random::new(seed);
        let mesh = cloud(&mut random, 40);
        let mut order: Vec<usize> = (0..40).collect();
        (1..40).rev().for_each(|i| order.swap(i, random.below(i + 1)));
        let shuffled: Vec<[f64; 3]> = order.iter().map(|&i| mesh.positions()[i]).collect();
        let place: Vec<u32> = (0..40).map(|i| order.iter().position(|&o| o == i).unwrap() as u32).collect();
        let faces: Vec<[u32; 3]> = mesh.faces().iter().map(|f| f.map(|i| place[i as usize])).collect();
        let (one, other) = (within(&mesh, 0.2), within(&mesh_of(&shuffled, &faces), 0.2));
        for face in 0..40 {
            assert_eq!(one.mesh.corners(face), other.mesh.corners(face), "seed {seed}");
        }
        assert_eq!(one.bound, other.bound, "seed {seed}");
    }
}

#[test]
fn collapsed_faces_are_told_and_kept() {
    let mesh = mesh_of(&[[0.0; 3], [0.01, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
    let mended = within(&mesh, 0.1);
    assert_eq!((mended.mesh.faces(), mended.count("collapsed_faces")), (&[[0, 0, 1]][..], 1));
    assert_eq!(mended.count("welded_vertices"), 1);
}

#[test]
fn distances_of_any_size_are_told_apart() {
    for scale in [1e-300, 1e-30, 1.0, 1e30, 1e300] {
        let rows = [[0.0; 3], [scale, 0.0, 0.0], [1.5 * scale, 0.0, 0.0], [4.0 * scale, 0.0, 0.0]];
        let mesh = mesh_of(&rows, &[[0, 1, 2], [1, 2, 3]]);
        let mended = within(&mesh, 0.75 * scale);
        assert_eq!(mended.mesh.faces(), [[0, 1, 1], [1, 1, 2]], "scale {scale}");
        let most = mended.bound.at_most().unwrap() / scale;
        assert!((0.5..0.500_001).contains(&most), "scale {scale}: {most}");
    }
}

#[test]
fn tied_rows_and_zeros_of_either_sign_are_one_position() {
    let rows = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.0, 0.0, 1.0]];
    let mended = weld(&mesh_of(&rows, &[[0, 1, 2], [3, 2, 1]]), Weld::Exact, &Job::default()).unwrap();
    assert_eq!(mended.mesh.faces(), [[0, 1, 2], [0, 2, 1]]);
    assert_eq!(mended.bound.at_most(), Some(0.0));
}
