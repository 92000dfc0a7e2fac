//! T-junctions: a seam cut on one side only, and random lattices against every pair of vertex and edge.
use chordal::check::findings::MeshLocation;
use chordal::check::t_junctions;
use chordal::explicit::Topology;
use chordal::explicit::adjacency::{Twin, Twins, next_in_face};
use chordal::{Mesh, Tolerance};
use chordal_testkit::Random;
use std::collections::BTreeSet;

/// A strip left of the line x = 0 with `left` squares, and one right of it with `right`, welded where they
/// agree. `bulge` moves the vertices of the seam that only the right side has off it.
fn seam(left: usize, right: usize, bulge: f64) -> Mesh {
    let (mut positions, mut faces): (Vec<[f64; 3]>, Vec<[u32; 3]>) = (Vec::new(), Vec::new());
    let mut strip = |n: usize, side: f64, bulge: f64| {
        let point = |i: usize, j: usize| {
            let y = i as f64 / n as f64;
            let is_shared = i.is_multiple_of((n / left).max(1));
            let off = if j == 0 && !is_shared { bulge } else { 0.0 };
            [side * j as f64 + off, y, 3.0 * y]
        };
        for i in 0..n {
            let first = positions.len() as u32;
            positions.extend([point(i, 0), point(i, 1), point(i + 1, 1), point(i + 1, 0)]);
            faces.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
    };
    strip(left, -1.0, 0.0);
    strip(right, 1.0, bulge);
    Mesh::new(positions, faces).unwrap()
}

#[test]
fn a_seam_cut_on_one_side_shows_every_vertex_that_the_other_lacks() {
    assert_eq!(t_junctions(&seam(4, 4, 0.0), Topology::Positions, None).count, 0);
    // Powers of two: the vertices are on the seam exactly, and 16 against 4 leaves 12.
    let found = t_junctions(&seam(4, 16, 0.0), Topology::Positions, None);
    assert_eq!((found.count, found.witnesses.len()), (12, 10));
    for witness in &found.witnesses {
        let MeshLocation::OnEdge { edge, .. } = witness.place else { panic!("{witness:?}") };
        assert_eq!(witness.at[0], 0.0);
        assert!(edge.iter().all(|&row| row < 16), "the edge is the long one, on the left: {witness:?}");
    }
}

#[test]
fn a_vertex_off_the_line_counts_within_a_tolerance_only() {
    let found = |bulge: f64, within: Option<f64>| {
        let within = within.map(|length| Tolerance::new(length).unwrap());
        t_junctions(&seam(4, 16, bulge), Topology::Positions, within).count
    };
    assert_eq!(found(1e-12, None), 0);
    assert_eq!(found(1e-12, Some(1e-9)), 12);
    assert_eq!(found(1e-6, Some(1e-9)), 0);
    assert_eq!(found(0.0, Some(1e-9)), 12);
}

#[test]
fn lattices_agree_with_a_look_at_every_pair() {
    let mut met = 0;
    for seed in 0..400_u64 {
        let mut random = Random::new(seed);
        let mut below = |n: usize| random.below(n) as i64;
        let lattice: Vec<[i64; 3]> = (0..60).map(|_| [below(9), below(9), below(2)]).collect();
        let faces = (0..25).map(|_| std::array::from_fn(|_| below(60) as u32)).collect();
        let positions = lattice.iter().map(|p| p.map(|x| x as f64 * 0.125)).collect();
        let mesh = Mesh::new(positions, faces).unwrap();
        let twins = Twins::new(&mesh, Topology::Indices);
        let ends = |h: u32| [h, next_in_face(h)].map(|h| mesh.faces()[h as usize / 3][h as usize % 3]);
        let edges: Vec<[u32; 2]> =
            (0..twins.len() as u32).filter(|&h| twins.get(h) == Twin::Boundary).map(ends).collect();
        let vertices: BTreeSet<u32> = edges.iter().flatten().copied().collect();
        // In integers: at the foot, and with the squared distance of the foot, both times the squared length.
        let measure = |vertex: u32, edge: [u32; 2]| {
            let [p, a, b] = [vertex, edge[0], edge[1]].map(|row| lattice[row as usize]);
            let minus = |a: [i64; 3], b: [i64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
            let dot = |a: [i64; 3], b: [i64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let (d, q) = (minus(b, a), minus(p, a));
            (dot(d, d), dot(d, q), dot(d, d) * dot(q, q) - dot(d, q) * dot(d, q))
        };
        let count = |is_inside: &dyn Fn((i64, i64, i64)) -> bool| {
            let on = |v: u32| edges.iter().any(|e| !e.contains(&v) && is_inside(measure(v, *e)));
            vertices.iter().filter(|&&v| on(v)).count() as u64
        };
        let exact = count(&|(dd, foot, off)| 0 < foot && foot < dd && off == 0);
        assert_eq!(t_junctions(&mesh, Topology::Indices, None).count, exact, "seed {seed}");
        // A tolerance whose square is no ratio of such integers, so that rounding decides nothing: 0.7
        // lattice steps.
        let tolerance = Tolerance::new(0.125 * 0.7001).unwrap();
        let near = count(&|(dd, foot, off)| {
            let (dd, foot, off) = (dd as f64, foot as f64, off as f64);
            let room = 0.7001 * dd.sqrt();
            room < foot && foot < dd - room && off <= 0.7001 * 0.7001 * dd
        });
        assert_eq!(t_junctions(&mesh, Topology::Indices, Some(tolerance)).count, near, "seed {seed}");
        met += exact;
    }
    assert!(met > 100, "the lattices are too tame: {met}");
}
