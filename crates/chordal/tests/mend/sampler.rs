//! Distances between surfaces from samples.
use chordal::Mesh;
use chordal_testkit::sampler::{Triangles, on};

/// The largest distance that is found from a point of one surface to the other; 0 for a surface without
/// faces.
pub fn one_sided(from: &Mesh, to: &Mesh) -> f64 {
    let to = Triangles::new(to.positions(), to.faces());
    let mut most = 0.0_f64;
    const N: u32 = 6;
    for face in 0..from.faces().len() {
        for i in 0..=N {
            for j in 0..=N - i {
                let (s, t) = (f64::from(i) / f64::from(N), f64::from(j) / f64::from(N));
                most = most.max(to.distance(on(from.corners(face), [1.0 - s - t, s, t])));
            }
        }
    }
    most
}
