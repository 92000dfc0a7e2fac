//! Whether the referee can be trusted: closed forms, a mesher with a known bound, and meshes that are broken
//! on purpose.
use super::naive::{naive_bound, naive_mesh};
use super::shapes::shape;
use chordal_testkit::sampler::{Control, Point, Surface, Triangles, distance, measure};
use chordal_testkit::{Random, some};

/// The flat unit square, with `z` a function of the row and column.
fn lifted(z: impl Fn(usize, usize) -> f64) -> Control {
    std::array::from_fn(|i| std::array::from_fn(|j| [j as f64 / 3.0, i as f64 / 3.0, z(i, j)]))
}

const SQUARE: [Point; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

fn square(lift: f64) -> Triangles {
    Triangles::new(&SQUARE.map(|[x, y, _]| [x, y, lift]), &[[0, 1, 2], [0, 2, 3]])
}

#[test]
fn measures_closed_forms() {
    let flat = measure(&Surface::new(vec![lifted(|_, _| 0.0)]), &square(0.25));
    assert!((flat.to_mesh - 0.25).abs() < 1e-12 && (flat.to_surface - 0.25).abs() < 3e-4, "{flat:?}");
    // z = 3·u·(1−u)·h with h = 0.1: a parabolic arch, 0.075 over its foot, from above and, by its own shape,
    // from below no more than that.
    let arch = measure(&Surface::new(vec![lifted(|_, j| if j % 3 == 0 { 0.0 } else { 0.1 })]), &square(0.0));
    assert!((arch.to_mesh - 0.075).abs() < 1e-9, "{arch:?}");
    assert!((0.074..=0.075).contains(&arch.to_surface), "{arch:?}");
    // z = u·v against its diagonal: a quarter of the twist, reduced by the slope of the triangles, 1/√2.
    let twist = Surface::new(vec![lifted(|i, j| (i * j) as f64 / 9.0)]);
    let bent = Triangles::new(&[SQUARE[0], SQUARE[1], [1.0, 1.0, 1.0], SQUARE[3]], &[[0, 1, 2], [0, 2, 3]]);
    let found = measure(&twist, &bent);
    assert!((found.to_mesh - 0.25 / 2_f64.sqrt()).abs() < 1e-6, "{found:?}");
}

#[test]
fn measures_one_side_where_the_other_is_near() {
    let surface = Surface::new(vec![lifted(|_, _| 0.0)]);
    let half = Triangles::new(&SQUARE, &[[0, 1, 2]]);
    let missing = measure(&surface, &half);
    assert!((missing.to_mesh - 0.5_f64.sqrt()).abs() < 1e-9 && missing.to_surface < 1e-12, "{missing:?}");
    let spike = Triangles::new(
        &[SQUARE[0], SQUARE[1], SQUARE[2], SQUARE[3], [0.5, 0.5, 2.0]],
        &[[0, 1, 2], [0, 2, 3], [0, 1, 4]],
    );
    let extra = measure(&surface, &spike);
    // The climb's last step is a thousandth of a side.
    assert!(extra.to_mesh < 1e-12 && (extra.to_surface - 2.0).abs() < 1e-2, "{extra:?}");
}

#[test]
fn finds_the_nearest_of_several_valleys() {
    // A patch folded like a letter: from between the sheets, the way that Newton's method finds first may be
    // wrong.
    for seed in 0..200 {
        let shape = shape(14 * seed + 4);
        let surface = Surface::new(vec![shape.control]);
        let mut random = Random::new(seed);
        let corner = shape.control[random.below(4)][random.below(4)];
        let p: Point = std::array::from_fn(|k| corner[k] + shape.size * random.between(-0.2, 0.2));
        let found = surface.proved_nearest(p, None, 1e-3).expect("decided").distance * 0.999;
        let n = 200;
        let dense =
            (0..=n * n + 2 * n).map(|i| [(i % (n + 1)) as f64 / n as f64, (i / (n + 1)) as f64 / n as f64]);
        let least = dense
            .map(|uv| distance(p, chordal_testkit::sampler::evaluate(&shape.control, uv)))
            .fold(f64::INFINITY, f64::min);
        // Samples lie within 4 sizes / n of each other, so the least is that close to the truth or closer.
        assert!(found <= least && found >= least - 0.02 * shape.size, "seed {seed}: {found} and {least}");
    }
}

#[test]
fn passes_a_known_bound() {
    for seed in some(0..140, 28) {
        let shape = shape(seed);
        let measured = naive(&shape.control, 3);
        let bound = naive_bound(&shape.control, 3) + super::length::rounding(&shape.control);
        assert!(measured <= bound, "{} (seed {seed}): {measured:e} > {bound:e}", shape.kind);
    }
}

#[test]
fn fails_a_tight_bound_that_is_cut_by_30_percent() {
    // Low hills over an even grid: points of equal (u, v) are above each other, so the bound is nearly the
    // distance.
    for seed in 0..50 {
        let mut random = Random::new(seed);
        let heights: [f64; 16] = std::array::from_fn(|_| random.between(-0.1, 0.1));
        let control = lifted(|i, j| heights[4 * i + j]);
        let (measured, bound) = (naive(&control, 3), naive_bound(&control, 3));
        assert!(measured <= bound && measured > 0.7 * bound, "seed {seed}: {measured:e} of {bound:e}");
    }
}

/// What is measured of the naive mesh.
fn naive(control: &Control, levels: u32) -> f64 {
    let (positions, faces) = naive_mesh(control, levels);
    measure(&Surface::new(vec![*control]), &Triangles::new(&positions, &faces)).both()
}

#[test]
fn sees_one_vertex_out_of_place() {
    for seed in 0..56 {
        let shape = shape(seed);
        let made = super::mesh_within(&[shape.control], 1e-2 * shape.size);
        let at_most = made.bound.at_most().expect("proved");
        let mut positions = made.shape.positions().to_vec();
        let mut random = Random::new(seed);
        let victim = made.shape.faces()[random.below(made.shape.faces().len())][0] as usize;
        // Three bounds away, in a direction in which the surface is not: out of the box.
        let out = 2.0 * shape.size + 3.0 * at_most;
        positions[victim][random.below(3)] += out;
        let moved =
            measure(&Surface::new(vec![shape.control]), &Triangles::new(&positions, made.shape.faces()));
        assert!(moved.to_surface > at_most, "{} (seed {seed}): {moved:?}", shape.kind);
    }
}
