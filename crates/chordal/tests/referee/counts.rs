//! Budgets of triangles: the best mesh of at most that many, with the bound that it reached.
use super::cracks::quilt;
use super::length::rounding;
use super::shapes::{diagonal, shape};
use super::teapot::teapot;
use super::{library_patches, mesh_within};
use chordal::{Bounded, Budget, Job, Mesh, convert};
use chordal_testkit::sampler::{Control, Surface, Triangles, measure};
use chordal_testkit::some;

fn mesh_of(controls: &[Control], most: u64) -> Bounded<Mesh> {
    convert::patches_to_mesh(
        &library_patches(controls),
        &Budget::triangles(most),
        &Job::default().with_threads(1),
    )
    .unwrap_or_else(|failure| panic!("{failure} with {most} triangles"))
}

fn at_most(made: &Bounded<Mesh>) -> f64 {
    made.bound.at_most().expect("proved")
}

/// The teapot, some single patches, and quilts.
fn models() -> Vec<(String, Vec<Control>)> {
    let mut models = vec![("teapot".to_owned(), teapot())];
    models.extend(some((0..84).step_by(3), 7).into_iter().map(|seed| {
        let shape = shape(seed);
        (format!("{} (seed {seed})", shape.kind), vec![shape.control])
    }));
    models.extend(some(0..3, 1).into_iter().map(|seed| (format!("quilt {seed}"), quilt(3, seed))));
    models
}

#[test]
fn more_triangles_never_give_a_larger_bound() {
    for (name, patches) in models() {
        let mut last = f64::INFINITY;
        let size = patches.iter().map(diagonal).fold(0.0, f64::max);
        let least = mesh_within(&patches, 4.0 * size).shape.faces().len() as u64;
        for step in some(0..12, 6) {
            let most = least + (least + 7) * (1 << step) / 8;
            let made = mesh_of(&patches, most);
            assert!(
                made.shape.faces().len() as u64 <= most,
                "{name}: {} of {most}",
                made.shape.faces().len()
            );
            assert!(at_most(&made) <= last, "{name}: {} with {most}, {last} with fewer", at_most(&made));
            last = at_most(&made);
        }
    }
}

#[test]
fn a_count_reaches_what_a_length_does() {
    let mut ratios = Vec::new();
    for (name, patches) in models() {
        let size = 3.0 * patches.iter().map(diagonal).fold(0.0, f64::max);
        for tolerance in [3e-2, 1e-2, 3e-3, 1e-3, 3e-4] {
            let by_length = mesh_within(&patches, tolerance * size);
            let by_count = mesh_of(&patches, by_length.shape.faces().len() as u64);
            let ratio = at_most(&by_count) / at_most(&by_length);
            // Lengths are tried in steps of 4.4 %, and the count of a small mesh jumps by more than such a
            // step.
            assert!(ratio <= 1.15 && (name != "teapot" || ratio <= 1.1), "{name} at {tolerance:e}: {ratio}");
            ratios.push(ratio);
        }
    }
    let high = ratios.iter().filter(|ratio| **ratio > 1.1).count();
    eprintln!("bound by count / bound by length: {high} of {} are above 1.1", ratios.len());
    assert!(50 * high <= ratios.len(), "{high} of {} are above 1.1", ratios.len());
}

#[test]
fn a_count_keeps_its_bound() {
    for (name, patches) in models() {
        for most in [200, 2000] {
            let Ok(made) = convert::patches_to_mesh(
                &library_patches(&patches),
                &Budget::triangles(most),
                &Job::default().with_threads(1),
            ) else {
                assert!(most < 500, "{name} with {most} triangles");
                continue;
            };
            let mesh = Triangles::new(made.shape.positions(), made.shape.faces());
            let slack = patches.iter().map(rounding).fold(0.0, f64::max);
            let measured = measure(&Surface::new(patches.clone()), &mesh).both();
            assert!(measured <= at_most(&made) + slack, "{name} with {most}: {measured:e}, {:?}", made.bound);
        }
    }
}
