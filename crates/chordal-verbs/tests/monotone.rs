//! A longer length is never worse: what is met at a length is met at twice that, with no more triangles.
use chordal::Job;
use chordal::implicit::{Affine3, Grid, Samples};
use chordal_io::{Format, Volume};
use chordal_testkit::{Random, is_long, some};
use chordal_verbs::{
    BudgetSpec, FormatHint, Input, MeshFailure, Shape, SurfaceSpec, Tessellation, VolumeShape, load, mesh,
};
use std::f64::consts::TAU;

/// How many lengths of a ladder make a factor of two.
const PER_OCTAVE: u32 = 5;

/// The lengths of a ladder: four octaves, or the first three of them.
fn n_rungs() -> u32 {
    if is_long() { 20 } else { 15 }
}

/// The triangles at each length from `longest` downwards; none where it is not met.
fn ladder(input: &Input, longest: f64) -> Vec<Option<usize>> {
    let job = Job::default().with_threads(2);
    let rung = |k: u32| {
        let length = longest * libm::exp2(-f64::from(k) / f64::from(PER_OCTAVE));
        let spec = BudgetSpec { length: Some(format!("{length}").parse().unwrap()), ..BudgetSpec::default() };
        match mesh(input.clone(), &spec, Format::Ply, &job) {
            Ok(made) => {
                assert!(made.bound.at_most().is_some_and(|most| most <= length), "{:?}", made.bound);
                let Tessellation::Triangles(scene) = &made.made else { panic!("polylines") };
                Some(scene.parts.iter().map(|part| part.mesh.faces().len()).sum())
            }
            Err(MeshFailure::Unmet(_) | MeshFailure::Refused(_)) => None,
            Err(other) => panic!("{other}"),
        }
    };
    (0..n_rungs()).map(rung).collect()
}

/// Holds a ladder against the contract, and that it is met at all of its lengths.
#[track_caller]
fn is_monotone(name: &str, input: &Input, longest: f64) {
    let rungs = ladder(input, longest);
    assert!(rungs.iter().all(Option::is_some), "{name}: {rungs:?}");
    for (k, pair) in rungs.windows(PER_OCTAVE as usize + 1).enumerate() {
        if let Some(finer) = pair[PER_OCTAVE as usize] {
            let coarser = pair[0].unwrap_or_else(|| panic!("{name}: rung {k} is not met: {rungs:?}"));
            assert!(
                coarser <= finer,
                "{name}: {coarser} triangles at rung {k}, {finer} at half the length: {rungs:?}"
            );
        }
    }
}

fn volume(n: usize, samples: Samples) -> Input {
    let grid = Grid::new([n; 3], samples, Affine3::IDENTITY).unwrap();
    let shape = VolumeShape { volume: Volume::from_grid(grid), surface: SurfaceSpec::default() };
    Input::made(Shape::Volume(shape), Format::Nrrd)
}

#[test]
fn of_masks_without_any_smooth_place() {
    // The finest lengths of the larger one take minutes.
    let n = if is_long() { 6 } else { 4 };
    for seed in some([3, 4], 1) {
        let mut random = Random::new(seed);
        let samples = (0..n * n * n).map(|_| random.below(2) as u8).collect();
        is_monotone(&format!("mask {seed}"), &volume(n, Samples::U8(samples)), 2.4);
    }
}

#[test]
fn of_distances() {
    let n = 16;
    let at = |i: usize| [i % n, i / n % n, i / (n * n)].map(|k| k as f64 - 7.3);
    let wave = |[x, y, z]: [f64; 3]| {
        let r = (x * x + y * y + z * z).sqrt();
        r - 5.0 - 0.5 * libm::sin(0.4 * TAU * x / 5.0) * libm::cos(0.3 * TAU * y / 5.0)
    };
    let samples = (0..n * n * n).map(|i| wave(at(i))).collect();
    is_monotone("distances", &volume(n, Samples::F64(samples)), 2.0);
}

#[test]
fn of_scripts() {
    let all = [
        // Its ribs wind around it, so that long collapses make triangles cross.
        (
            "twist(extrude(polygon([[3, 0], [1, 1], [0, 3], [-1, 1], [-3, 0], [-1, -1], [0, -3], [1, -1]]), 6), 60)",
            1.0,
        ),
        // Solids that are cut, and a field alone.
        ("box(6, 4, 2) - cylinder(1, 3) - move(cylinder(0.5, 3), 2, 1, 0) | move(sphere(1), -2, 0, 1)", 0.3),
        ("union(sphere(2), move(sphere(1.5), 2, 0, 0), fillet=0.5)", 0.5),
    ];
    for (text, longest) in some(all, 1) {
        is_monotone(text, &read(text.as_bytes(), "a.star"), longest);
    }
}

#[test]
fn of_meshes() {
    // A torus with waves.
    let (n, m) = (64, 24);
    let mut obj = String::new();
    for i in 0..n {
        for j in 0..m {
            let [u, v] = [TAU * f64::from(i) / f64::from(n), TAU * f64::from(j) / f64::from(m)];
            let r = 1.0 + 0.1 * libm::sin(5.0 * u) * libm::cos(3.0 * v);
            let ring = 3.0 + r * libm::cos(v);
            obj += &format!("v {} {} {}\n", ring * libm::cos(u), ring * libm::sin(u), r * libm::sin(v));
        }
    }
    let row = |i: i32, j: i32| 1 + (i % n) * m + j % m;
    for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))) {
        let [a, b, c, d] = [row(i, j), row(i + 1, j), row(i + 1, j + 1), row(i, j + 1)];
        obj += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
    }
    is_monotone("torus", &read(obj.as_bytes(), "torus.obj"), 1.0);
}

#[test]
fn of_patches_and_cages() {
    let teapot = include_bytes!("../../../examples/teapot.bpt");
    is_monotone("teapot", &read(teapot, "teapot.bpt"), 0.5);
}

fn read(bytes: &[u8], name: &str) -> Input {
    load(bytes, FormatHint { name: Some(name), ..FormatHint::default() }, &Default::default()).unwrap()
}
