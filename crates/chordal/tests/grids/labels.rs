//! Labels: each mesh is within its bound of the interpolant's surface of the label's mask, and the bound is tight.
use super::shapes::{interpolant, one_sided, surface_points};
use chordal::budget::Evidence;
use chordal::convert::Border;
use chordal::convert::lattices::{GridBlock, LabelOptions, join_blocks, labels_to_blocks, labels_to_meshes};
use chordal::implicit::{Affine3, Grid, Samples};
use chordal::{Job, Mesh};
use chordal_testkit::{Random, cases, is_long};
use std::collections::BTreeMap;

fn longest_step(affine: &Affine3) -> f64 {
    affine.steps().map(|s| s.map(|x| x * x).iter().sum::<f64>().sqrt()).into_iter().fold(0.0, f64::max)
}

/// Points of capped borders that are inside.
fn cap_points(grid: &Grid, border: [[Border; 2]; 3], random: &mut Random, n: usize) -> Vec<[f64; 3]> {
    let mut points = Vec::new();
    for _ in 0..n {
        let (axis, end) = (random.below(3), random.below(2));
        let mut at: [f64; 3] = std::array::from_fn(|k| random.unit() * (grid.size()[k] - 1) as f64);
        at[axis] = if end == 0 { 0.0 } else { (grid.size()[axis] - 1) as f64 };
        if border[axis][end] == Border::Capped && interpolant(grid, at) < 0.0 {
            points.push(grid.affine().at(at));
        }
    }
    points
}

/// Points of a mesh: random ones of each face.
fn mesh_points(mesh: &Mesh, random: &mut Random) -> Vec<[f64; 3]> {
    let mut points = Vec::new();
    for face in 0..mesh.faces().len() {
        let [a, b, c] = mesh.corners(face);
        for _ in 0..6 {
            let w = random.weights();
            points.push(std::array::from_fn(|k| w[0] * a[k] + w[1] * b[k] + w[2] * c[k]));
        }
    }
    points
}

#[test]
fn bounds_hold_for_every_kind_of_cell() {
    let seed = 0x5EED_CE11;
    let mut random = Random::new(seed);
    let sheared =
        Affine3::new([[1.0, 0.25, 0.0, -3e3], [0.0, 0.75, 0.125, 5e3], [0.125, 0.0, -1.5, 7.0]]).unwrap();
    let flat = Affine3::new([[0.1, 0.0, 0.0, 0.0], [0.0, 4.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]).unwrap();
    let mut tightest = 0.0_f64;
    for case in 0..cases(12) {
        let size = [0; 3].map(|_: i32| 2 + random.below(2));
        let labels: Vec<u8> = (0..size.iter().product()).map(|_| 1 + random.below(3) as u8).collect();
        let affine = [Affine3::IDENTITY, sheared, flat][random.below(3)];
        let border = [0; 3].map(|_| [0; 2].map(|_: i32| [Border::Open, Border::Capped][random.below(2)]));
        let rule = LabelOptions { border, ..LabelOptions::default() };
        let grid = Grid::new(size, Samples::U8(labels.clone()), affine).unwrap();
        let made = labels_to_meshes(&grid, &rule, &Job::default().with_threads(1)).unwrap();
        let again = labels_to_meshes(&grid, &rule, &Job::default().with_threads(2)).unwrap();
        assert!(made == again);
        for (label, made) in made {
            let name = format!("label {label} of case {case} of seed {seed:x}, {size:?}, {labels:?}");
            assert_eq!(*made.bound.evidence(), Evidence::Proved);
            let most = made.bound.at_most().expect("proved");
            let mask = labels.iter().map(|l| if *l == label as u8 { -0.5 } else { 0.5 }).collect();
            let mask = Grid::new(size, Samples::F64(mask), affine).unwrap();
            let mut points = surface_points(&mask, &mut random, 1500);
            points.extend(cap_points(&mask, border, &mut random, 1500));
            let step = longest_step(&affine);
            let seen = one_sided(&points, &made.shape);
            assert!(made.shape.faces().is_empty() || seen <= most + 1e-9, "{seen} from {most}: {name}");
            tightest = tightest.max(if made.shape.faces().is_empty() { 0.0 } else { seen / most });
            for p in mesh_points(&made.shape, &mut random) {
                let far = |q: &[f64; 3]| (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt();
                let near = points.iter().map(far).fold(f64::INFINITY, f64::min);
                // As far as the samples of the surface are apart.
                assert!(near <= most + 0.2 * step, "{near} from {most}: {name}");
            }
        }
    }
    assert!(tightest > 0.8, "the bounds are wide: {tightest}");
}

#[test]
fn bounds_are_those_of_the_cells_that_a_label_has() {
    let bound = |size: [usize; 3], inside: &dyn Fn([usize; 3]) -> bool| {
        let label = |at: usize| inside([at % size[0], at / size[0] % size[1], at / (size[0] * size[1])]);
        let labels = (0..size.iter().product()).map(|at| u8::from(label(at))).collect();
        let grid = Grid::new(size, Samples::U8(labels), Affine3::IDENTITY).unwrap();
        let made = labels_to_meshes(&grid, &LabelOptions::default(), &Job::default()).unwrap();
        made[0].1.bound.at_most().expect("proved")
    };
    // Everything, and a half: nothing but flat faces, on the surface.
    assert!(bound([4; 3], &|_| true) < 2e-6);
    assert!(bound([4; 3], &|at| at[0] < 2) < 0.1);
    // One sample: an octahedron. In a cell x y z = 1/2 is √3 (½^⅓ − 5/6) = 0.0687 off at the diagonal.
    let one = bound([5; 3], &|at| at == [2; 3]);
    assert!((0.0687..0.12).contains(&one), "{one}");
}

/// The faces of a mesh by the bits of their corners, each begun at its least corner, sorted.
fn faces_of(mesh: &Mesh) -> Vec<[[u64; 3]; 3]> {
    let turned = |face: usize| {
        let mut corners = mesh.corners(face).map(|at| at.map(f64::to_bits));
        let first = (0..3).min_by_key(|i| corners[*i]).unwrap();
        corners.rotate_left(first);
        corners
    };
    let mut faces: Vec<_> = (0..mesh.faces().len()).map(turned).collect();
    faces.sort_unstable();
    faces
}

#[test]
fn labels_of_blocks_join_to_those_of_the_whole() {
    let mut rng = Random::new(21);
    for round in 0..if is_long() { 200 } else { 6 } {
        let size = [0, 1, 2].map(|_| 2 + rng.below(7));
        let labels: Vec<u8> = (0..size.iter().product::<usize>()).map(|_| rng.below(4) as u8).collect();
        let affine =
            Affine3::new([[0.5, 0.0, 0.1, 3.0], [0.0, -0.7, 0.0, 1.0], [0.0, 0.2, 0.9, -2.0]]).unwrap();
        let grid = Grid::new(size, Samples::U8(labels.clone()), affine).unwrap();
        let border =
            [0, 1, 2].map(|_| [0, 1].map(|_| if rng.below(4) == 0 { Border::Open } else { Border::Capped }));
        let rule = LabelOptions { border, offset: [7, -3, 1 << 20], ..LabelOptions::default() };
        let Ok(whole) = labels_to_meshes(&grid, &rule, &Job::default()) else { continue };
        let step = [0, 1, 2].map(|_| 1 + rng.below(4));
        let ranges = [0, 1, 2].map(|k| {
            let starts = (0..size[k] - 1).step_by(step[k]);
            starts.map(|low| [low, (low + step[k]).min(size[k] - 1)]).collect::<Vec<_>>()
        });
        let mut blocks: BTreeMap<u32, Vec<GridBlock>> = BTreeMap::new();
        for (x, y, z) in ranges[0].iter().flat_map(|x| {
            ranges[1].iter().flat_map(|y| ranges[2].iter().map(|z| (*x, *y, *z))).collect::<Vec<_>>()
        }) {
            let [low, high] = [0, 1].map(|end| [x[end], y[end], z[end]]);
            let mut values = Vec::new();
            for k in low[2]..=high[2] {
                for j in low[1]..=high[1] {
                    values.extend((low[0]..=high[0]).map(|i| labels[i + size[0] * (j + size[1] * k)]));
                }
            }
            let own =
                Grid::new([0, 1, 2].map(|k| high[k] - low[k] + 1), Samples::U8(values), affine).unwrap();
            let mut part = rule;
            for k in 0..3 {
                part.offset[k] += low[k] as i64;
                let ends = [low[k] == 0, high[k] + 1 == size[k]];
                part.border[k] = [0, 1].map(|end| if ends[end] { border[k][end] } else { Border::Open });
            }
            for (label, block) in labels_to_blocks(&own, &part, &Job::default()).unwrap() {
                blocks.entry(label).or_default().push(block);
            }
        }
        // A label in the whole may have vertices at an open border and no triangle.
        let shown = whole.iter().filter(|(_, made)| !made.shape.faces().is_empty());
        assert!(blocks.keys().eq(shown.clone().map(|(label, _)| label)), "round {round}");
        for ((label, made), blocks) in shown.zip(blocks.into_values()) {
            let joined = join_blocks(blocks, &Job::default()).unwrap();
            assert_eq!(faces_of(&joined.shape), faces_of(&made.shape), "round {round}, label {label}");
            assert_eq!(joined.shape.positions().len(), made.shape.positions().len());
            let [far, alone] = [&joined.bound, &made.bound].map(|bound| bound.at_most().unwrap());
            assert!((far - alone).abs() <= 1e-9 * alone, "{far} against {alone}");
        }
    }
}
