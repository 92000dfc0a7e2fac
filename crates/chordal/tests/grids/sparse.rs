//! Samples in bricks: the same numbers, leaves and meshes as from one array.
use super::shapes::sampled;
use chordal::convert::lattices::Lattice;
use chordal::convert::{Polygonize, field_to_grid, field_to_sparse_grid, grid_to_mesh, sparse_grid_to_mesh};
use chordal::implicit::evaluation::Trilinear;
use chordal::implicit::leaves::Leaf;
use chordal::implicit::shapes::torus;
use chordal::implicit::{Affine3, Grid, Samples, SparseGrid};
use chordal::math::{Box3, Interval};
use chordal::{Budget, Job, Tolerance};
use chordal_testkit::Random;

#[test]
fn bricks_hold_any_samples_bit_for_bit() {
    let mut random = Random::new(0x5EED_0030);
    for _ in 0..200 {
        let size = [0; 3].map(|_: i32| 1 + random.below(20));
        let some = [1.0, -1.0, 1.0, 1.0, -0.0, f64::NAN, 0.25];
        let kinds = 1 + random.below(7);
        let values: Vec<f64> = (0..size.iter().product()).map(|_| some[random.below(kinds)]).collect();
        let grid = Grid::new(size, Samples::F64(values.clone()), Affine3::IDENTITY).unwrap();
        let sparse = SparseGrid::from_grid(&grid, 1.0);
        let Samples::F64(back) = sparse.to_dense().samples().clone() else { panic!("f64 in, f64 out") };
        assert!(values.iter().zip(&back).all(|(a, b)| a.to_bits() == b.to_bits()));
        let [there, all] = sparse.n_bricks();
        assert_eq!(all, size.iter().map(|n| n.div_ceil(8)).product::<usize>());
        assert_eq!(sparse.bytes(), 4096 * there as u64 + 4 * all as u64);
        assert!(kinds > 1 || there == 0);
    }
}

#[test]
fn a_band_of_a_field_is_sampled_meshed_and_evaluated_as_in_one_array() {
    let shape = torus(1.0, 0.3).unwrap();
    let lattice = Lattice::around(&shape.bounds(), 70, 3).unwrap();
    let band = 0.125;
    let job = Job::default();
    let dense = field_to_grid(&shape, &lattice, Some(band), &job).unwrap();
    let sparse = field_to_sparse_grid(&shape, &lattice, band, &job).unwrap();
    assert_eq!(sparse.to_dense(), dense);
    assert_eq!(sparse, SparseGrid::from_grid(&dense, band));
    assert!(sparse.n_bricks()[0] < sparse.n_bricks()[1], "{:?}", sparse.n_bricks());
    let rule = Polygonize::below(0.0);
    let budget = Budget::length(Tolerance::new(0.001).unwrap());
    for budget in [None, Some(&budget)] {
        let a = grid_to_mesh(&dense, &rule, budget, &job).unwrap();
        let b = sparse_grid_to_mesh(&sparse, &rule, budget, &job).unwrap();
        assert_eq!((a.shape, a.bound), (b.shape, b.bound));
    }
    let (a, b) = (Trilinear::new(dense), Trilinear::new(sparse));
    let mut random = Random::new(0x5EED_0031);
    let mut point = || [0; 3].map(|_: i32| 3.0 * random.unit() - 1.5);
    let points: Vec<[f64; 3]> = (0..2000).map(|_| point()).collect();
    let boxes: Vec<Box3> = points.iter().map(|p| Box3 { min: *p, max: p.map(|x| x + 0.1) }).collect();
    let values = |leaf: &dyn Leaf| {
        let (mut values, mut slopes) = (vec![0.0; 2000], vec![[0.0; 3]; 2000]);
        let mut ranges = vec![Interval::UNKNOWN; 2000];
        leaf.at(&points, &mut values).unwrap();
        leaf.gradient_at(&points, &mut slopes).unwrap();
        leaf.over(&boxes, &mut ranges).unwrap();
        (values, slopes, ranges)
    };
    assert_eq!(values(&a), values(&b));
}

#[test]
fn without_a_band_all_bricks_are_there() {
    let grid = sampled(|[x, y, z]| x + y + z + 0.1, 17, &Affine3::cubes([-1.0; 3], 0.125).unwrap());
    let sparse = SparseGrid::from_grid(&grid, 1.0);
    assert_eq!(sparse.n_bricks(), [27, 27]);
    assert_eq!(sparse.to_dense(), grid);
}
