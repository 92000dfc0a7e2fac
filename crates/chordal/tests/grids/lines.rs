//! Level curves of planes of samples: each crossed edge once, in lines that are closed or end at the border.
use chordal::Job;
use chordal::convert::{Polygonize, grid_to_polyline};
use chordal::implicit::{Affine3, Grid, Samples};
use chordal_testkit::Random;
use std::collections::BTreeSet;

#[test]
fn random_planes_have_lines_that_are_closed_or_end_at_the_border() {
    let mut random = Random::new(0x5EED_0020);
    for case in 0..20_000 {
        let size = [2 + random.below(5), 2 + random.below(5), 1];
        let values: Vec<i8> = (0..size[0] * size[1]).map(|_| random.below(3) as i8 - 1).collect();
        let side = |i: usize, j: usize| values[i + size[0] * j] < 0;
        let mut crossed = 0;
        for j in 0..size[1] {
            for i in 0..size[0] {
                crossed += usize::from(i + 1 < size[0] && side(i, j) != side(i + 1, j));
                crossed += usize::from(j + 1 < size[1] && side(i, j) != side(i, j + 1));
            }
        }
        let grid = Grid::new(size, Samples::I8(values.clone()), Affine3::IDENTITY).unwrap();
        let Ok(made) = grid_to_polyline(&grid, &Polygonize::below(0.0), &Job::default()) else {
            assert_eq!(crossed, 0, "case {case}");
            continue;
        };
        let mut places = BTreeSet::new();
        let mut area = 0.0;
        for line in &made.shape {
            assert!(line.points.len() >= 2, "case {case}");
            assert!(line.points.iter().all(|p| places.insert(p.map(f64::to_bits))), "case {case}");
            let on_border = |p: [f64; 2]| (0..2).any(|k| p[k] == 0.0 || p[k] == (size[k] - 1) as f64);
            let ends = [line.points[0], line.points[line.points.len() - 1]];
            assert!(line.closed || ends.iter().all(|p| on_border(*p)), "case {case}");
            area += line.segments().map(|[a, b]| a[0] * b[1] - a[1] * b[0]).sum::<f64>();
        }
        assert_eq!(places.len(), crossed, "case {case}");
        // Inside is on the left: where all lines are closed and the border is outside, they wind around what
        // is inside.
        if made.shape.iter().all(|line| line.closed) && !side(0, 0) {
            assert!(area > 0.0, "case {case}");
        }
    }
}
