//! Whether meshes of several patches hold together.
use super::mesh_within;
use super::naive::naive_mesh;
use super::topology::Topology;
use chordal_testkit::Random;
use chordal_testkit::sampler::{Control, Point};

/// `n × n` patches over one random net of control points, so that neighbours share their sides exactly; each
/// patch turned and mirrored at random.
pub fn quilt(n: usize, seed: u64) -> Vec<Control> {
    let mut r = Random::new(seed);
    let side = 3 * n + 1;
    let spread = [0.1, 0.3, 0.6][seed as usize % 3];
    let net: Vec<Point> = (0..side * side)
        .map(|p| [p % side, p / side, 0].map(|x| x as f64 + spread * r.between(-1.0, 1.0)))
        .collect();
    let patch = |p: usize, r: &mut Random| {
        let (row, column) = (3 * (p / n), 3 * (p % n));
        let (turn, mirror) = (r.below(4), r.below(2));
        let at = |i: usize, j: usize| {
            let (i, j) = if mirror == 1 { (j, i) } else { (i, j) };
            let (i, j) = [(i, j), (j, 3 - i), (3 - i, 3 - j), (3 - j, i)][turn];
            net[(row + i) * side + column + j]
        };
        std::array::from_fn(|i| std::array::from_fn(|j| at(i, j)))
    };
    (0..n * n).map(|p| patch(p, &mut r)).collect()
}

#[test]
fn patches_with_common_sides_share_vertices_by_index() {
    for seed in 0..45 {
        let patches = quilt(3, seed);
        // From two triangles a patch to thousands, where neighbours need very different numbers.
        for length in [3.0, 0.3, 0.03, 0.005] {
            let made = mesh_within(&patches, length);
            let topology = Topology::of(&made.shape);
            let said = format!("quilt of seed {seed} at {length}");
            assert_eq!(topology.boundary_loops(), Ok(1), "{said}");
            assert_eq!(topology.crowded_edges(), 0, "{said}");
            assert_eq!(topology.degenerate_faces(), 0, "{said}");
            // A net of 9 units: rounding is below 1e-14 of that.
            assert_eq!(topology.t_junctions(1e-9), 0, "{said}");
        }
    }
}

#[test]
fn a_ring_of_patches_closes_on_itself() {
    // A tube, and one whose ends are poles: the side of each patch is that of the next, the last meets the
    // first.
    for poles in [false, true] {
        let arc = [[1.0, 0.0], [1.0, 0.552], [0.552, 1.0], [0.0, 1.0]];
        let ring = |turn: usize| -> Control {
            std::array::from_fn(|i| {
                let wide = if poles && (i == 0 || i == 3) { 0.0 } else { 1.0 };
                arc.map(|[x, y]| {
                    let [x, y] = [[x, y], [-y, x], [-x, -y], [y, -x]][turn];
                    // Without the sum, −0 and 0 would make equal points of different bits.
                    [wide * x + 0.0, wide * y + 0.0, i as f64]
                })
            })
        };
        let patches: Vec<Control> = (0..4).map(ring).collect();
        for length in [2.0, 0.1, 0.01, 0.001] {
            let made = mesh_within(&patches, length);
            let topology = Topology::of(&made.shape);
            let said = format!("ring with poles: {poles}, at {length}");
            assert_eq!(topology.boundary_loops(), Ok(if poles { 0 } else { 2 }), "{said}");
            assert_eq!(topology.degenerate_faces() + topology.crowded_edges(), 0, "{said}");
        }
    }
}

#[test]
fn cracks_and_t_junctions_are_seen() {
    // Two neighbours, meshed each for itself: the common side is two boundaries, one with twice the vertices.
    let flat = |x: f64| -> Control {
        std::array::from_fn(|i| std::array::from_fn(|j| [x + j as f64 / 3.0, i as f64 / 3.0, 0.0]))
    };
    let (mut positions, mut faces) = naive_mesh(&flat(0.0), 1);
    let (right, right_faces) = naive_mesh(&flat(1.0), 2);
    let base = positions.len() as u32;
    positions.extend(right);
    faces.extend(right_faces.iter().map(|f| f.map(|i| i + base)));
    let mut topology = Topology::new(positions, faces);
    assert_eq!(topology.boundary_loops(), Ok(2));
    // Both fine vertices between, and on the coarse middle the two that coincide are ends, not interior.
    assert_eq!(topology.t_junctions(1e-9), 2);
    assert_eq!(topology.degenerate_faces(), 0);
    topology.faces.push([0, 1, 1]);
    assert_eq!(topology.degenerate_faces(), 1);
}
