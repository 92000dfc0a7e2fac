//! Surfaces whose distance has a closed form.
use chordal::explicit::Cage;
use chordal::explicit::query::SurfaceTree;
use chordal::{Job, Patch};
use chordal_testkit::Random;
use chordal_testkit::sampler::{Point, distance};

fn tree(patch: Patch) -> SurfaceTree {
    SurfaceTree::from_patches(&[patch], &Job::default()).unwrap()
}

fn holds(tree: &SurfaceTree, p: Point, truth: f64) {
    let found = tree.closest_point(p, None).unwrap();
    // The truth is rounded as well.
    let slack = 1e-15 * (4.0 + truth);
    assert!(found.at_least <= truth + slack && truth <= found.at_most + slack, "{found:?} of {p:?}: {truth}");
    assert!(found.at_most - found.at_least < 1e-12 * (1.0 + truth), "{found:?} of {p:?}");
}

#[test]
fn a_rectangle() {
    let tree = tree(Patch::flat([0.0; 3], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]));
    let mut numbers = Random::new(11);
    for _ in 0..500 {
        let p = numbers.point_within::<3>(4.0);
        let beyond = |x: f64, most: f64| (-x).max(x - most).max(0.0);
        holds(&tree, p, distance([beyond(p[0], 2.0), beyond(p[1], 1.0), p[2]], [0.0; 3]));
    }
}

/// `z = x·y`: bilinear.
fn saddle() -> Patch {
    let third = |k: usize| 2.0 * k as f64 / 3.0 - 1.0;
    let point = |i: usize, j: usize| [third(j), third(i), third(i) * third(j)];
    Patch { control: std::array::from_fn(|i| std::array::from_fn(|j| point(i, j))) }
}

#[test]
fn along_the_normals_of_a_saddle() {
    let tree = tree(saddle());
    let mut numbers = Random::new(12);
    for _ in 0..500 {
        let (x, y) = (0.9 * numbers.signed(), 0.9 * numbers.signed());
        // Its radii of curvature are 1 at least.
        let (off, length) = (0.3 * numbers.signed(), (1.0 + x * x + y * y).sqrt());
        let normal = [-y / length, -x / length, 1.0 / length];
        let foot = [x, y, x * y];
        holds(&tree, [0, 1, 2].map(|k| foot[k] + off * normal[k]), off.abs());
    }
}

#[test]
fn a_wall_over_a_cubic() {
    // A parabola y = x² over x from −1 to 1, drawn out along z: from (0, h) with h > 1/2 the distance is √(h
    // − 1/4).
    let line = [[-1.0, 1.0], [-1.0 / 3.0, -1.0 / 3.0], [1.0 / 3.0, -1.0 / 3.0], [1.0, 1.0]];
    let control = std::array::from_fn(|i| line.map(|[x, y]| [x, y, i as f64 - 1.5]));
    let tree = tree(Patch { control });
    for k in 1..40 {
        let h = 0.5 + f64::from(k) * 0.02;
        holds(&tree, [0.0, h, 0.3], (h - 0.25).sqrt());
        holds(&tree, [0.0, -h, 0.3], h);
    }
    // At the focal point, where nothing is convex and the distance grows with the fourth power.
    let found = tree.closest_point([0.0, 0.5, 0.0], None).unwrap();
    assert!(
        found.at_least <= 0.5 && 0.5 <= found.at_most && found.at_most - found.at_least < 1e-7,
        "{found:?}"
    );
}

#[test]
fn a_cage_whose_limit_is_a_plane_and_one_that_is_itself() {
    // Six by six squares: without a rule for the border the inner sixteen are flat.
    let (n, at) = (7_u32, |i: u32, j: u32| i * 7 + j);
    let points = (0..n * n).map(|k| [f64::from(k % n), f64::from(k / n), 0.0]).collect();
    let faces = (0..36)
        .map(|k| (k / 6, k % 6))
        .map(|(i, j)| [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
    let flat =
        Cage::new(points, faces).unwrap().with_boundary(chordal::explicit::subdivision::Boundary::None);
    let tree = SurfaceTree::from_limit(&flat.limit().unwrap(), &Job::default()).unwrap();
    let mut numbers = Random::new(13);
    for _ in 0..200 {
        let p = numbers.point_within::<3>(8.0);
        let beyond = |x: f64| (1.0 - x).max(x - 5.0).max(0.0);
        let found = tree.closest_point(p, None).unwrap();
        let truth = distance([beyond(p[0]), beyond(p[1]), p[2]], [0.0; 3]);
        assert!(
            found.at_least <= truth + 1e-14 && truth <= found.at_most + 1e-14,
            "{found:?} of {p:?}: {truth}"
        );
        assert!(found.at_most - found.at_least < 1e-11, "{found:?} of {p:?}");
    }
}
