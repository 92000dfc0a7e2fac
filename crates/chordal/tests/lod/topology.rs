//! Topology: a manifold stays one, and what is none stays as it is.
use super::sampler::triangles;
use super::{bounds, length, made, n_faces, shapes};
use chordal::check::{Validity, validity};
use chordal::explicit::Topology;
use chordal::{Budget, Mesh};
use chordal_testkit::Random;
use chordal_testkit::sampler::{cross, dot, sub};

fn of(mesh: &Mesh) -> Validity {
    validity(mesh, Topology::Positions)
}

fn stays(name: &str, mesh: &Mesh, budget: &Budget) {
    let out = made(mesh, budget).shape.mesh;
    let (before, after) = (of(mesh), of(&out));
    assert!(out.faces().len() < mesh.faces().len(), "{name}: nothing went");
    assert_eq!(
        (before.closed, before.manifold(), before.oriented),
        (after.closed, after.manifold(), after.oriented),
        "{name}"
    );
    assert_eq!((before.components, before.genus), (after.components, after.genus), "{name}");
    assert_eq!((before.euler, before.boundary_loops), (after.euler, after.boundary_loops), "{name}");
    assert_eq!(after.zero_area_faces.count, before.zero_area_faces.count, "{name}");
    // The same normal on the same side: volumes have one sign and about one size.
    if before.closed {
        let [v, w] = [before, after].map(|x| x.measure.signed_volume);
        assert!(v * w > 0.0, "{name}: volume {v} became {w}");
    }
}

#[test]
fn a_manifold_stays_one_of_the_same_kind() {
    let many = [
        ("torus", shapes::torus([60, 30], 0.1)),
        ("lobes", shapes::lobes(4)),
        ("gear", shapes::gear(2, 7)),
        ("shaft", shapes::shaft(60)),
        ("plate", shapes::plate(16)),
        ("heights", shapes::heights([40, 40], 0.002)),
        ("mobius", shapes::mobius([60, 8])),
        ("two", shapes::twice(&shapes::torus([30, 16], 0.0), [3.0, 0.0, 0.0])),
    ];
    for (name, mesh) in many {
        let n = mesh.faces().len() as u64;
        for budget in [
            Budget::triangles(n / 2),
            Budget::triangles(n / 20),
            Budget::triangles(1),
            length(0.02),
            length(0.2),
        ] {
            stays(name, &mesh, &budget);
        }
    }
}

#[test]
fn nothing_turns_over() {
    for mesh in [shapes::torus([60, 30], 0.1), shapes::lobes(4), shapes::heights([40, 40], 0.002)] {
        let asked = 0.004 * mesh.bounds().diagonal();
        let out = made(&mesh, &length(asked)).shape.mesh;
        let tree = triangles(&mesh);
        let normal = |t: [[f64; 3]; 3]| cross(sub(t[1], t[0]), sub(t[2], t[0]));
        for face in 0..out.faces().len() {
            let t = out.corners(face);
            let middle = std::array::from_fn(|k| (t[0][k] + t[1][k] + t[2][k]) / 3.0);
            // Some face of the original close to the middle looks to the same side.
            let near = tree.within(middle, 1.5 * asked);
            let alike = near.iter().any(|f| dot(normal(mesh.corners(*f)), normal(t)) > 0.0);
            assert!(alike, "face {face} looks the other way");
        }
    }
}

#[test]
fn a_mobius_strip_survives() {
    let mesh = shapes::mobius([120, 12]);
    for budget in [Budget::triangles(200), length(0.01), length(0.1)] {
        let made = made(&mesh, &budget);
        assert!(n_faces(&made) <= 400, "{} triangles", n_faces(&made));
        let found = of(&made.shape.mesh);
        assert!(!found.closed);
        assert_eq!((found.components, found.euler, found.boundary_loops), (1, 0, 1));
        assert!(!found.orientable && found.edge_manifold && found.vertex_manifold);
    }
}

/// Two meshes in one, with the rows of the second after those of the first.
fn joined(a: &Mesh, b: &Mesh) -> Mesh {
    let n = a.positions().len() as u32;
    let faces = a.faces().iter().copied().chain(b.faces().iter().map(|f| f.map(|i| i + n))).collect();
    Mesh::new([a.positions(), b.positions()].concat(), faces).expect("valid")
}

fn sorted(positions: impl Iterator<Item = [f64; 3]>) -> Vec<[u64; 3]> {
    // Zeros of either sign are one.
    let mut all: Vec<_> = positions.map(|p| p.map(|x| (x + 0.0).to_bits())).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// A plain grid of n × n cells in the plane of two axes, from `from`, with cells of `step`.
fn grid(n: u32, from: [f64; 3], [u, v]: [[f64; 3]; 2]) -> Mesh {
    let at = |i: u32, j: u32| std::array::from_fn(|k| from[k] + f64::from(i) * u[k] + f64::from(j) * v[k]);
    let positions = (0..=n).flat_map(|i| (0..=n).map(move |j| at(i, j))).collect();
    let id = |i: u32, j: u32| i * (n + 1) + j;
    let cell =
        |(i, j)| [[id(i, j), id(i + 1, j), id(i + 1, j + 1)], [id(i, j), id(i + 1, j + 1), id(i, j + 1)]];
    let faces = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).flat_map(cell).collect();
    Mesh::new(positions, faces).expect("valid")
}

#[test]
fn three_sheets_at_one_line_keep_the_line() {
    // A floor of 16 × 16 cells and a wall that stands on the line x = 8.
    let floor = grid(16, [0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let wall = grid(16, [8.0, 0.0, 0.0], [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]);
    let mesh = joined(&floor, &wall);
    assert_eq!(of(&mesh).non_manifold_edges.count, 16);
    for budget in [Budget::triangles(1), length(0.5)] {
        let made = made(&mesh, &budget);
        bounds::holds("sheets", &mesh, &budget, &made, &mut Random::new(1));
        let out = &made.shape.mesh;
        assert_eq!(of(out).non_manifold_edges.count, 16);
        let line =
            |mesh: &Mesh| sorted(mesh.positions().iter().copied().filter(|p| p[0] == 8.0 && p[2] == 0.0));
        assert_eq!(line(&mesh), line(out));
        // By fan: floor left, floor right and wall have each their own vertex there.
        assert!(made.shape.stats.locked_vertices >= 17, "{:?}", made.shape.stats);
        assert!(n_faces(&made) <= 16 * 3 + 60, "{} triangles", n_faces(&made));
    }
}

#[test]
fn two_fans_at_one_vertex_stay_together() {
    // Two balls that touch in one vertex.
    let ball = shapes::sphere(3);
    let mesh = shapes::twice(&ball, [2.0, 0.0, 0.0]);
    assert!(!of(&mesh).manifold());
    for budget in [Budget::triangles(60), length(0.05)] {
        let made = made(&mesh, &budget);
        assert!(n_faces(&made) <= 512);
        assert_eq!(made.shape.stats.locked_vertices, 2);
        assert!(made.shape.mesh.positions().contains(&[1.0, 0.0, 0.0]));
        assert_eq!(of(&made.shape.mesh).components, of(&mesh).components);
        assert!(!of(&made.shape.mesh).manifold());
        bounds::holds("balls", &mesh, &budget, &made, &mut Random::new(1));
    }
}

#[test]
fn faces_wound_against_each_other_keep_their_line() {
    let left = grid(8, [0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    // Wound the other way, on the other side of x = 8.
    let right = grid(8, [8.0, 0.0, 0.0], [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]);
    let mesh = joined(&left, &right);
    assert_eq!(of(&mesh).inconsistent_edges.count, 8);
    let made = made(&mesh, &length(0.1));
    assert_eq!(of(&made.shape.mesh).inconsistent_edges.count, 8);
    assert!(
        made.shape.stats.locked_vertices >= 9 && n_faces(&made) < 40,
        "{:?} {}",
        made.shape.stats,
        n_faces(&made)
    );
}
