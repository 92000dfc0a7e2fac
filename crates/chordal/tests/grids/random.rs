//! Many small volumes of every type, with ties and without numbers.
use super::solid::{flat, flaw, volume6};
use chordal::Job;
use chordal::convert::lattices::grid_to_triangles;
use chordal::convert::{Inside, Polygonize};
use chordal::implicit::{Affine3, Grid, Samples};
use chordal_testkit::Random;
use chordal_testkit::cases;

fn samples(random: &mut Random, n: usize) -> Samples {
    let kind = random.below(7);
    let mut few = |n: usize| random.below(n);
    match kind {
        0 => Samples::U8((0..n).map(|_| few(3) as u8).collect()),
        1 => Samples::I16((0..n).map(|_| few(5) as i16 - 2).collect()),
        2 => Samples::F32((0..n).map(|_| few(1 << 20) as f32 / 524_288.0 - 1.0).collect()),
        3 => {
            Samples::F64((0..n).map(|_| [0.0, -0.0, 1.0, -1.0, f64::NAN, 5e-324, -5e-324][few(7)]).collect())
        }
        4 => Samples::F64(
            (0..n).map(|_| [f64::MAX, f64::MIN, f64::INFINITY, f64::NEG_INFINITY, 1e-300][few(5)]).collect(),
        ),
        5 => {
            Samples::F32((0..n).map(|_| [f32::MIN_POSITIVE, -1e-38, f32::NAN, 1.0, -1e30][few(5)]).collect())
        }
        _ => Samples::I32((0..n).map(|_| few(2) as i32 * 2 - 1).collect()),
    }
}

#[test]
fn random_volumes_are_closed_and_manifold() {
    let seed = 0x5EED_0001;
    let mut random = Random::new(seed);
    let job = Job::default().with_threads(1);
    let mut with_surface = 0;
    let n_cases = cases(30_000) as u64;
    for case in 0..n_cases {
        let size = [0; 3].map(|_: i32| 2 + random.below(3));
        let samples = samples(&mut random, size.iter().product());
        let grid = Grid::new(size, samples, Affine3::IDENTITY).unwrap();
        let inside = if random.below(2) == 0 { Inside::Low } else { Inside::High };
        let level = [0.0, 0.5, 1.0, -1e-310][random.below(4)];
        let rule = Polygonize { inside, ..Polygonize::above(level) };
        let made = grid_to_triangles::<f64>(&grid, &rule, &job).unwrap();
        let n = made.positions.len();
        with_surface += u64::from(n > 0);
        assert_eq!(flaw(n, &made.faces, |_, _| false), None, "case {case} of seed {seed:x}: {grid:?}");
        assert_eq!(flat(&made.positions, &made.faces), None, "case {case} of seed {seed:x}: {grid:?}");
        assert!(n == 0 || volume6(&made.positions, &made.faces) > 0.0, "case {case} of seed {seed:x}");
        assert!(made.positions.as_flattened().iter().all(|x| x.is_finite()));
    }
    assert!(2 * with_surface > n_cases);
}
