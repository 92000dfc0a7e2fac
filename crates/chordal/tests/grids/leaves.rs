//! The interpolant of a grid as a leaf: against its definition, and its ranges against points.
use chordal::implicit::evaluation::Trilinear;
use chordal::implicit::leaves::Leaf;
use chordal::implicit::{Affine3, Grid, Samples};
use chordal::math::{Box3, Interval};
use chordal_testkit::Random;

fn leaf(random: &mut Random, rows: [[f64; 4]; 3]) -> Trilinear {
    let size = [7, 20, 9];
    let values = (0..size.iter().product()).map(|_| random.below(1000) as f32 / 100.0 - 5.0).collect();
    Trilinear::new(Grid::new(size, Samples::F32(values), Affine3::new(rows).unwrap()).unwrap())
}

#[test]
fn ranges_hold_values_and_gradients_of_points() {
    let mut random = Random::new(0x5EED_0010);
    for rows in [
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]],
        [[0.3, 0.1, 0.0, -2.0], [0.0, -0.2, 0.05, 1.0], [0.02, 0.0, 0.7, 5.0]],
        [[0.0, 0.0, 2.0, 1.0], [0.0, 3.0, 0.0, 0.0], [-1.0, 0.0, 0.0, 0.1]],
    ] {
        let leaf = leaf(&mut random, rows);
        for _ in 0..3000 {
            let wide = [0.1, 1.0, 6.0][random.below(3)];
            let start: [f64; 3] = [0, 1, 2].map(|k| random.unit() * [9.0, 22.0, 11.0][k] - 1.0);
            let corner = leaf.grid().affine().at(start);
            let size: [f64; 3] = [0; 3].map(|_: i32| random.unit() * wide);
            let bounds = Box3 { min: corner, max: std::array::from_fn(|k| corner[k] + size[k]) };
            let (mut range, mut slopes) = ([Interval::UNKNOWN], [[Interval::UNKNOWN; 3]]);
            leaf.over(&[bounds], &mut range).unwrap();
            leaf.gradient_over(&[bounds], &mut slopes).unwrap();
            assert!(range[0].is_defined() && !range[0].is_entire());
            let points: Vec<[f64; 3]> =
                (0..4).map(|_| std::array::from_fn(|k| corner[k] + random.unit() * size[k])).collect();
            let (mut values, mut gradients) = ([0.0; 4], [[0.0; 3]; 4]);
            leaf.at(&points, &mut values).unwrap();
            leaf.gradient_at(&points, &mut gradients).unwrap();
            for (value, gradient) in values.into_iter().zip(gradients) {
                assert!(range[0].contains(value), "{range:?} {value}");
                for k in 0..3 {
                    let [lo, hi] = [slopes[0][k].lo(), slopes[0][k].hi()];
                    assert!(
                        lo - 1e-10 <= gradient[k] && gradient[k] <= hi + 1e-10,
                        "{slopes:?} {gradient:?}"
                    );
                }
            }
        }
    }
}

/// The mean of equal samples is off by its last place at some points, which is in the range all the same.
#[test]
fn ranges_of_equal_samples_hold_their_rounded_means() {
    let samples = Samples::F64(vec![5.3; 27]);
    let leaf = Trilinear::new(Grid::new([3; 3], samples, Affine3::IDENTITY).unwrap());
    let mut random = Random::new(0x5EED_0011);
    let mut off = 0;
    for _ in 0..1000 {
        let p: [f64; 3] = std::array::from_fn(|_| 2.0 * random.unit());
        let (mut value, mut range) = ([0.0], [Interval::UNKNOWN]);
        leaf.at(&[p], &mut value).unwrap();
        leaf.over(&[Box3 { min: p, max: p }], &mut range).unwrap();
        assert!(range[0].contains(value[0]) && range[0].width() < 1e-13, "{p:?}: {range:?} {value:?}");
        off += usize::from(value[0] != 5.3);
    }
    assert!(off > 0, "no mean was off");
}

#[test]
fn a_range_in_one_cell_is_that_of_its_corners() {
    let grid = Grid::new([2; 3], Samples::U8((0..8).collect()), Affine3::IDENTITY).unwrap();
    let leaf = Trilinear::new(grid);
    let mut range = [Interval::UNKNOWN];
    leaf.over(&[Box3 { min: [0.25; 3], max: [0.5; 3] }], &mut range).unwrap();
    // x + 2y + 4z.
    assert!(range[0].lo() <= 1.75 && range[0].lo() > 1.75 - 1e-12);
    assert!(range[0].hi() >= 3.5 && range[0].hi() < 3.5 + 1e-12);
}

#[test]
fn outside_of_the_lattice_the_nearest_index_counts_and_unknown_samples_are_said() {
    let grid = Grid::new(
        [2, 2, 2],
        Samples::F32(vec![0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, f32::NAN]),
        Affine3::IDENTITY,
    );
    let known = Grid::new([2, 2, 2], Samples::U8(vec![0, 1, 0, 1, 0, 1, 0, 1]), Affine3::IDENTITY);
    let mut values = [0.0; 2];
    Trilinear::new(known.unwrap()).at(&[[-4.0, 0.0, 0.0], [7.0, 0.0, 9.0]], &mut values).unwrap();
    assert_eq!(values, [0.0, 1.0]);
    let leaf = Trilinear::new(grid.unwrap());
    leaf.at(&[[0.5, 0.9, 0.9], [0.0; 3]], &mut values).unwrap();
    assert!(values[0].is_nan());
    let mut range = [Interval::UNKNOWN];
    leaf.over(&[Box3 { min: [0.1; 3], max: [0.2; 3] }], &mut range).unwrap();
    assert!(!range[0].is_defined());
}
