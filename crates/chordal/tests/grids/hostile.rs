//! HOSTILE.md, rows 63 to 66 and 70: what volumes of other people look like.
use super::shapes::sampled;
use super::solid::{flat, flaw, volume6};
use chordal::budget::RefusalCode;
use chordal::convert::lattices::{LabelOptions, grid_to_triangles, labels_to_meshes};
use chordal::convert::{Polygonize, grid_to_mesh};
use chordal::implicit::{Affine3, Grid, Samples};
use chordal::{Budget, Evidence, Failure, Job, Tolerance};
use chordal_testkit::{Random, corpus, is_long};
use std::collections::BTreeSet;

fn grid(size: [usize; 3], samples: Samples) -> Grid {
    Grid::new(size, samples, Affine3::IDENTITY).unwrap()
}

fn ball([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt() - 0.7
}

#[test]
fn h63_samples_that_are_no_numbers_are_outside_and_leave_it_closed() {
    let mut random = Random::new(0x5EED_0063);
    let clean = sampled(ball, 12, &Affine3::cubes([-1.0; 3], 2.0 / 11.0).unwrap());
    let mut values: Vec<f64> = (0..12 * 12 * 12).map(|at| clean.samples().get(at)).collect();
    for _ in 0..300 {
        values[random.below(1728)] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY][random.below(3)];
    }
    let grid = grid([12; 3], Samples::F64(values.clone()));
    let made = grid_to_mesh(&grid, &Polygonize::below(0.0), None, &Job::default()).unwrap();
    let mesh = &made.shape;
    assert_eq!(flaw(mesh.positions().len(), mesh.faces(), |_, _| false), None);
    assert_eq!(flat(mesh.positions(), mesh.faces()), None);
    assert!(made.bound.at_most().unwrap() < 1.74);
    let unknown = values.iter().filter(|v| v.is_nan()).count() as u64;
    assert_eq!(
        grid.samples().count_not_finite(),
        [unknown, values.iter().filter(|v| v.is_infinite()).count() as u64]
    );
}

#[test]
fn h64_ties_and_flat_regions_are_closed_without_flat_faces() {
    let n = 8;
    let at = |f: &dyn Fn(usize, usize, usize) -> i16| -> Samples {
        let all = (0..n * n * n).map(|at| f(at % n, at / n % n, at / (n * n)));
        Samples::I16(all.collect())
    };
    let volumes = [
        at(&|i, j, k| ((i + j + k) % 2) as i16),
        at(&|i, j, k| ((i / 2 + j / 2 + k / 2) % 2) as i16),
        at(&|i, _, _| (i as i16 - 4).abs().min(1)),
        at(&|i, j, k| ((i * j * k) % 3) as i16),
        at(&|_, _, k| k as i16 - 3),
        at(&|_, _, _| 1),
    ];
    for (number, samples) in volumes.into_iter().enumerate() {
        let grid = grid([n; 3], samples);
        for level in [0.0, 0.5, 1.0] {
            for rule in [Polygonize::above(level), Polygonize::below(level)] {
                let made = grid_to_triangles::<f64>(&grid, &rule, &Job::default()).unwrap();
                assert_eq!(flaw(made.positions.len(), &made.faces, |_, _| false), None, "{number} {rule:?}");
                assert_eq!(flat(&made.positions, &made.faces), None, "{number} {rule:?}");
                let places: BTreeSet<_> = made.positions.iter().map(|p| p.map(f64::to_bits)).collect();
                assert_eq!(places.len(), made.positions.len(), "{number} {rule:?}");
            }
        }
    }
}

#[test]
fn h65_singular_transforms_are_refused_and_mirrored_ones_turned() {
    assert!(Affine3::new([[1.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [1.0, 0.0, 1.0, 0.0]]).is_err());
    let mut mask = vec![0_u8; 27];
    mask[13] = 1;
    for rows in [
        [[-1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]],
        [[0.0, 1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.5, 1.0, 0.0]],
    ] {
        let grid = Grid::new([3; 3], Samples::U8(mask.clone()), Affine3::new(rows).unwrap()).unwrap();
        let made = grid_to_triangles::<f64>(&grid, &Polygonize::above(0.5), &Job::default()).unwrap();
        assert!(volume6(&made.positions, &made.faces) > 0.9);
    }
    // Steps that are lost beside the coordinates.
    let far = Affine3::cubes([1e15; 3], 1.0).unwrap();
    let grid = Grid::new([3; 3], Samples::U8(mask), far).unwrap();
    let refused = grid_to_mesh(&grid, &Polygonize::above(0.5), None, &Job::default());
    assert!(matches!(refused, Err(Failure::Refused(r)) if r.code == RefusalCode::BelowPrecision));
}

#[test]
fn h66_thousands_of_labels_are_closed_each_and_share_their_vertices() {
    let mut random = Random::new(0x5EED_0066);
    let n = 28;
    // Boxes of 2 x 2 x 2 samples with a label each, in a shuffled order, and some of the largest label.
    let samples: Vec<u32> = (0..n * n * n)
        .map(|at| {
            let block = at % n / 2 + 14 * (at / n % n / 2) + 196 * (at / (n * n) / 2);
            if block % 97 == 5 { u32::MAX } else { (block as u32 * 7919) % 2525 }
        })
        .collect();
    let distinct: BTreeSet<u32> = samples.iter().copied().filter(|l| *l != 0).collect();
    assert!(distinct.len() > 2_400);
    let meshes =
        labels_to_meshes(&grid([n; 3], Samples::U32(samples)), &LabelOptions::default(), &Job::default())
            .unwrap();
    assert!(meshes.iter().map(|(label, _)| *label).eq(distinct.iter().copied()));
    let mut shared: BTreeSet<[u64; 3]> = BTreeSet::new();
    let mut twice = 0;
    for (label, made) in &meshes {
        let mesh = &made.shape;
        assert_eq!(flaw(mesh.positions().len(), mesh.faces(), |_, _| false), None, "label {label}");
        assert!(volume6(mesh.positions(), mesh.faces()) > 0.0);
        assert_eq!(made.bound.evidence(), &Evidence::Proved);
        twice += mesh.positions().iter().filter(|p| !shared.insert(p.map(f64::to_bits))).count();
    }
    assert!(2 * twice > shared.len());
    // Noise has all neighbours that there are.
    let noise: Vec<u8> = (0..9 * 8 * 7).map(|_| random.below(4) as u8).collect();
    let noise = grid([9, 8, 7], Samples::U8(noise));
    for (label, made) in labels_to_meshes(&noise, &LabelOptions::default(), &Job::default()).unwrap() {
        let mesh = &made.shape;
        assert_eq!(flaw(mesh.positions().len(), mesh.faces(), |_, _| false), None);
        let mask: Vec<u8> =
            (0..9 * 8 * 7).map(|at| u8::from(noise.samples().get(at) == f64::from(label))).collect();
        let alone = grid_to_triangles::<f64>(
            &grid([9, 8, 7], Samples::U8(mask)),
            &Polygonize::above(0.5),
            &Job::default(),
        )
        .unwrap();
        assert_eq!(mesh.faces().len(), alone.faces.len());
        assert_eq!(volume6(mesh.positions(), mesh.faces()), volume6(&alone.positions, &alone.faces));
    }
    let only =
        labels_to_meshes(&grid([2; 3], Samples::U8(vec![0; 8])), &LabelOptions::default(), &Job::default());
    assert!(
        matches!(only, Err(Failure::Refused(r)) if r.code == RefusalCode::Empty && r.message.contains("background"))
    );
    let negative =
        labels_to_meshes(&grid([2; 3], Samples::I8(vec![-1; 8])), &LabelOptions::default(), &Job::default());
    assert!(matches!(negative, Err(Failure::Refused(r)) if r.code == RefusalCode::Unsupported));
}

#[test]
fn h70_a_shape_that_is_not_there_is_refused_with_the_reason() {
    let refused = |samples: Samples, rule: Polygonize| {
        let n = if samples.len() == 8 { [2; 3] } else { [8, 1, 3] };
        match grid_to_mesh(&grid(n, samples), &rule, None, &Job::default()) {
            Err(Failure::Refused(refusal)) => refusal,
            other => panic!("{other:?}"),
        }
    };
    let below = refused(Samples::U8(vec![3; 8]), Polygonize::below(1.0));
    assert_eq!(below.code, RefusalCode::Empty);
    assert!(below.message.contains("between 3 and 3"), "{}", below.message);
    let full = refused(Samples::U8(vec![3; 8]), Polygonize::above(1.0).open());
    assert!(full.message.contains("every sample"), "{}", full.message);
    let unknown = refused(Samples::F32(vec![f32::NAN; 8]), Polygonize::above(1.0));
    assert!(unknown.message.contains("is a number"), "{}", unknown.message);
    let thin = refused(Samples::U8(vec![1; 24]), Polygonize::above(0.5));
    assert!(thin.message.contains("index 1"), "{}", thin.message);
    // One that fills the lattice is the lattice's box.
    let box_ =
        grid_to_mesh(&grid([2; 3], Samples::U8(vec![3; 8])), &Polygonize::above(1.0), None, &Job::default())
            .unwrap();
    assert_eq!(box_.shape.faces().len(), 12);
}

/// It was beyond its length by the rounding to f32 of what cells are off.
#[test]
fn noise_that_missed_its_length_by_a_rounding_is_met() {
    let Some(path) = corpus::find("repro/unmet_by_5e-10_r0.npy") else { return };
    let bytes = std::fs::read(path).unwrap();
    // 6 × 6 × 6 numbers of 8 bytes end the file, the last index first.
    let numbers = bytes[bytes.len() - 8 * 216..].chunks_exact(8);
    let values = numbers.map(|x| f64::from_le_bytes(x.try_into().unwrap())).collect();
    let affine = Affine3::new([[0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]]).unwrap();
    let grid = Grid::new([6; 3], Samples::F64(values), affine).unwrap();
    let budget = Budget::length(Tolerance::new(0.02).unwrap());
    let made = grid_to_mesh(&grid, &Polygonize::below(0.1), Some(&budget), &Job::default()).unwrap();
    assert_eq!(made.bound.evidence(), &Evidence::Proved);
    assert!(made.bound.at_most().unwrap() <= 0.02, "{:?}", made.bound);
    let mesh = &made.shape;
    assert_eq!(flaw(mesh.positions().len(), mesh.faces(), |_, _| false), None);
    assert!(mesh.faces().len() <= 142_724, "{}", mesh.faces().len());
}

#[test]
fn a_length_halves_cells_until_the_bound_holds() {
    let n = if is_long() { 16 } else { 10 };
    let affine = Affine3::cubes([-1.0; 3], 2.0 / (n - 1) as f64).unwrap();
    let smooth = sampled(ball, n, &affine);
    let whole = |p: [f64; 3]| (1000.0 * ball(p)).floor();
    let rough = sampled(whole, n, &affine);
    let values = (0..n * n * n).map(|at| rough.samples().get(at) as i16).collect();
    let rough = Grid::new([n; 3], Samples::I16(values), affine).unwrap();
    for (grid, exact) in [(smooth, false), (rough, true)] {
        let rule = Polygonize::below(0.0);
        let coarse = grid_to_mesh(&grid, &rule, None, &Job::default()).unwrap();
        let length = coarse.bound.at_most().unwrap() / 10.0;
        let budget = Budget::length(Tolerance::new(length).unwrap());
        let fine = grid_to_mesh(&grid, &rule, Some(&budget), &Job::default()).unwrap();
        assert!(fine.bound.at_most().unwrap() <= length);
        assert!(!exact || fine.bound.evidence() == &Evidence::Proved);
        let mesh = &fine.shape;
        assert_eq!(flaw(mesh.positions().len(), mesh.faces(), |_, _| false), None);
        let few = Budget { triangles: Some(coarse.shape.faces().len() as u64 + 1), ..budget };
        let unmet = grid_to_mesh(&grid, &rule, Some(&few), &Job::default());
        assert!(matches!(unmet, Err(Failure::Unmet(best)) if best.shape == coarse.shape));
    }
}

#[test]
fn limits_and_cancelling_are_heard() {
    let grid = sampled(ball, 30, &Affine3::cubes([-1.0; 3], 2.0 / 29.0).unwrap());
    let rule = Polygonize::below(0.0);
    let refused = |limit: fn(&mut Job)| {
        let mut job = Job::default();
        limit(&mut job);
        match grid_to_mesh(&grid, &rule, None, &job) {
            Err(Failure::Refused(refusal)) => refusal.code,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(refused(|job| job.triangle_limit = 100), RefusalCode::TooManyTriangles);
    assert_eq!(refused(|job| job.memory_limit = 10_000), RefusalCode::TooMuchMemory);
    let job = Job::default();
    job.cancel();
    assert!(matches!(grid_to_mesh(&grid, &rule, None, &job), Err(Failure::Cancelled)));
}
