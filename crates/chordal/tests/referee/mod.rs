//! The referee: measures what the library made against the truth, and shares no code with it.
//!
//! It evaluates patches from their control points itself, finds nearest triangles and nearest surface points
//! itself, and projects through cameras of its own. Its accusations are proved: a distance is that of a
//! sample, and where the nearest point of the surface is asked, branch and bound has excluded a nearer one.
//! `naive` and `honesty` show that it sees the mistakes it is there for. `CHORDAL_LONG=1` makes it measure
//! every patch at every tolerance.
mod counts;
mod cracks;
mod eyes;
mod frame;
mod honesty;
mod length;
mod moving_eye;
mod naive;
mod pixels;
mod shapes;
mod teapot;
mod topology;

use chordal::{Bounded, Budget, Job, Mesh, Patch, Tolerance, convert};
use chordal_testkit::is_long;
use chordal_testkit::sampler::Control;

/// The library's patches of bare control points.
fn library_patches(controls: &[Control]) -> Vec<Patch> {
    controls.iter().map(|&control| Patch { control }).collect()
}

/// The library's mesh within a length.
fn mesh_within(controls: &[Control], length: f64) -> Bounded<Mesh> {
    let budget = Budget::length(Tolerance::new(length).expect("a positive length"));
    convert::patches_to_mesh(&library_patches(controls), &budget, &Job::default().with_threads(1))
        .unwrap_or_else(|failure| panic!("{failure} at a length of {length:e}"))
}

/// Runs `work` for `0..n` on two threads and returns the results in order.
fn for_all<T: Send>(n: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let half = |parity: usize| (parity..n).step_by(2).map(&work).collect::<Vec<T>>();
    let [even, odd] = std::thread::scope(|scope| {
        let odd = scope.spawn(|| half(1));
        [half(0), odd.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))]
    });
    let (mut even, mut odd) = (even.into_iter(), odd.into_iter());
    (0..n).filter_map(|i| if i % 2 == 0 { even.next() } else { odd.next() }).collect()
}

/// The value at the fraction `q` of a sorted list.
fn quantile(sorted: &[f64], q: f64) -> f64 {
    sorted[((sorted.len() - 1) as f64 * q).round() as usize]
}
