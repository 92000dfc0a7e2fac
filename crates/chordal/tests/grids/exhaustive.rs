//! Two cells that share a face, with every corner below, at and above the level, along each axis.
use super::solid::{flat, flaw, volume6};
use chordal::Job;
use chordal::convert::Polygonize;
use chordal::convert::lattices::grid_to_triangles;
use chordal::implicit::{Affine3, Grid, Samples};
use chordal_testkit::is_long;

#[test]
fn two_cells_are_closed_and_manifold_in_every_pattern() {
    let job = Job::default().with_threads(1);
    for axis in 0..3 {
        let mut size = [2; 3];
        size[axis] = 3;
        // All in the long sweep; 11 is coprime to the number of patterns.
        for pattern in (0..3_u32.pow(12)).step_by(if is_long() { 1 } else { 11 }) {
            let samples: Vec<i8> =
                (0..12).map(|corner| (pattern / 3_u32.pow(corner) % 3) as i8 - 1).collect();
            let inside = samples.iter().filter(|v| **v < 0).count();
            let grid = Grid::new(size, Samples::I8(samples), Affine3::IDENTITY).unwrap();
            let made = grid_to_triangles::<f64>(&grid, &Polygonize::below(0.0), &job).unwrap();
            let (n, faces) = (made.positions.len(), &made.faces);
            assert_eq!(n == 0, inside == 0, "{pattern} along {axis}");
            assert_eq!(flaw(n, faces, |_, _| false), None, "{pattern} along {axis}");
            assert_eq!(flat(&made.positions, faces), None, "{pattern} along {axis}");
            assert!(n == 0 || volume6(&made.positions, faces) > 0.0, "{pattern} along {axis}");
        }
    }
}

/// Signs alone decide the topology, so 2¹² patterns are all of them for open borders.
#[test]
fn two_cells_end_at_the_border_only() {
    let job = Job::default().with_threads(1);
    for axis in 0..3 {
        let mut size = [2; 3];
        size[axis] = 3;
        for pattern in 0..1_u32 << 12 {
            let samples: Vec<u8> = (0..12).map(|corner| (pattern >> corner & 1) as u8).collect();
            let grid = Grid::new(size, Samples::U8(samples), Affine3::IDENTITY).unwrap();
            let made = grid_to_triangles::<f64>(&grid, &Polygonize::above(0.5).open(), &job).unwrap();
            let on = |v: u32, k: usize| {
                let x = made.positions[v as usize][k];
                [x == 0.0, x == (size[k] - 1) as f64]
            };
            let in_border = |a: u32, b: u32| (0..3).any(|k| (0..2).any(|end| on(a, k)[end] && on(b, k)[end]));
            assert_eq!(flaw(made.positions.len(), &made.faces, in_border), None, "{pattern} along {axis}");
        }
    }
}
