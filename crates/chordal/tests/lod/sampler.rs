//! The farthest point of one surface from another, from samples.
use chordal::Mesh;
use chordal_testkit::Random;
use chordal_testkit::sampler::{Point, Triangles, on};

/// The triangles of a mesh.
pub fn triangles(mesh: &Mesh) -> Triangles {
    Triangles::new(mesh.positions(), mesh.faces())
}

/// Points of a face that are always looked at, by their weights: corners, the middles of edges, and the
/// middle.
pub const FIXED: [Point; 7] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.5],
    [0.5, 0.0, 0.5],
    [1.0 / 3.0; 3],
];

/// The farthest of many points of one surface from another: corners, middles, and random points by area, `n`
/// of them about.
pub fn farthest(from: &Mesh, to: &Mesh, (n, random): (usize, &mut Random)) -> f64 {
    let [own, other] = [from, to].map(triangles);
    let whole: f64 = (0..own.corners.len()).map(|i| own.area(i)).sum();
    let mut most = 0.0_f64;
    for (i, t) in own.corners.iter().enumerate() {
        FIXED.iter().for_each(|w| most = most.max(other.distance(on(*t, *w))));
        for _ in 0..(n as f64 * own.area(i) / whole).ceil() as usize {
            most = most.max(other.distance(on(*t, random.weights())));
        }
    }
    most
}

/// Both ways.
pub fn apart(a: &Mesh, b: &Mesh, random: &mut Random) -> f64 {
    farthest(a, b, (20_000, random)).max(farthest(b, a, (20_000, random)))
}
