//! Distances that the referee finds itself: points of triangles by the shape's own function, points of the
//! shape by bisection.
use super::shapes::{Point, Shape};
use crate::deviation_referee::triangles_of;
use chordal::Mesh;
use chordal_testkit::Random;
use chordal_testkit::sampler::Triangles;

/// The farthest that a point of the triangles surely is from the surface: |f| over the slope is never more
/// than the distance.
pub fn forward(mesh: &Triangles, shape: &Shape, random: &mut Random) -> f64 {
    let mut most = 0.0_f64;
    for t in &mesh.corners {
        let mut see = |w: [f64; 3]| {
            let sum = w[0] + w[1] + w[2];
            let p: Point = std::array::from_fn(|k| (w[0] * t[0][k] + w[1] * t[1][k] + w[2] * t[2][k]) / sum);
            most = most.max((shape.own)(p).abs() / shape.slope);
        };
        for i in 0..=3 {
            for j in 0..=3 - i {
                see([f64::from(i), f64::from(j), f64::from(3 - i - j)]);
            }
        }
        for _ in 0..4 {
            see([0, 1, 2].map(|_| random.between(0.001, 1.0)));
        }
    }
    most
}

/// Points of the shape's surface: where the own function changes its sign on random segments.
pub fn surface(shape: &Shape, count: usize, random: &mut Random) -> Vec<Point> {
    let mut found = Vec::new();
    for _ in 0..60 * count {
        if found.len() == count {
            break;
        }
        let a: Point = random.point::<3>().map(|x| shape.half * x);
        let b: Point = std::array::from_fn(|k| a[k] + 0.3 * random.between(-1.0, 1.0));
        if ((shape.own)(a) < 0.0) == ((shape.own)(b) < 0.0) {
            continue;
        }
        let (mut a, mut b) = (a, b);
        let inside = (shape.own)(a) < 0.0;
        for _ in 0..50 {
            let c: Point = std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
            if ((shape.own)(c) < 0.0) == inside { a = c } else { b = c }
        }
        found.push(a);
    }
    found
}

/// The farthest of some points from the triangles.
pub fn backward(points: &[Point], mesh: &Triangles) -> f64 {
    points.iter().map(|p| mesh.distance(*p)).fold(0.0, f64::max)
}

/// Closed, each edge used once each way, and the volume inside positive.
pub fn is_good(mesh: &Mesh) -> Result<(), String> {
    let mut edges: Vec<[u32; 2]> =
        mesh.faces().iter().flat_map(|f| [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]]).collect();
    edges.sort_unstable();
    if edges.windows(2).any(|pair| pair[0] == pair[1]) {
        return Err("an edge is used twice the same way".into());
    }
    if let Some([a, b]) = edges.iter().find(|[a, b]| edges.binary_search(&[*b, *a]).is_err()) {
        return Err(format!("the edge {a}-{b} has one side"));
    }
    let volume: f64 = triangles_of(mesh)
        .corners
        .iter()
        .map(|[a, b, c]| {
            a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        })
        .sum();
    if volume > 0.0 { Ok(()) } else { Err(format!("the volume is {volume}")) }
}
