//! Distances between surfaces from samples, sharing no code with the library.
use chordal::Mesh;

type P = [f64; 3];

fn sub(a: P, b: P) -> P {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: P, b: P) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn to_segment(p: P, a: P, b: P) -> f64 {
    let (d, q) = (sub(b, a), sub(p, a));
    let square = dot(d, d);
    let t = if square > 0.0 { (dot(q, d) / square).clamp(0.0, 1.0) } else { 0.0 };
    let r = [q[0] - t * d[0], q[1] - t * d[1], q[2] - t * d[2]];
    dot(r, r).sqrt()
}

/// The distance from a point to a triangle: to its plane where the foot is inside, else to its sides.
fn to_triangle(p: P, [a, b, c]: [P; 3]) -> f64 {
    let sides = to_segment(p, a, b).min(to_segment(p, b, c)).min(to_segment(p, c, a));
    let (u, v, w) = (sub(b, a), sub(c, a), sub(p, a));
    let (uu, uv, vv, wu, wv) = (dot(u, u), dot(u, v), dot(v, v), dot(w, u), dot(w, v));
    let det = uu * vv - uv * uv;
    if det <= 1e-14 * uu * vv {
        return sides;
    }
    let (s, t) = ((wu * vv - wv * uv) / det, (wv * uu - wu * uv) / det);
    if s < 0.0 || t < 0.0 || s + t > 1.0 {
        return sides;
    }
    let r: P = std::array::from_fn(|k| w[k] - s * u[k] - t * v[k]);
    dot(r, r).sqrt().min(sides)
}

/// The largest distance that is found from a point of one surface to the other; 0 for a surface without faces.
pub fn one_sided(from: &Mesh, to: &Mesh) -> f64 {
    let mut most = 0.0_f64;
    const N: u32 = 6;
    for face in 0..from.faces().len() {
        let [a, b, c] = from.corners(face);
        for i in 0..=N {
            for j in 0..=N - i {
                let (s, t) = (f64::from(i) / f64::from(N), f64::from(j) / f64::from(N));
                let p = std::array::from_fn(|k| a[k] * (1.0 - s - t) + b[k] * s + c[k] * t);
                let near = (0..to.faces().len()).map(|f| to_triangle(p, to.corners(f)));
                most = most.max(near.fold(f64::INFINITY, f64::min));
            }
        }
    }
    most
}
