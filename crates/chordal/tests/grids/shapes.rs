//! Spheres, tori and gyroids: the bound holds against an independent sampler, and falls with the square of
//! the step.
use super::solid::{flaw, volume6};
use chordal::convert::{Border, Normals, Polygonize, grid_to_mesh};
use chordal::explicit::Semantic;
use chordal::implicit::{Affine3, Grid, Samples};
use chordal::{Job, Mesh};
use chordal_testkit::{Random, is_long, some};

type Function = fn([f64; 3]) -> f64;

fn sphere([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt() - 0.7
}

fn torus([x, y, z]: [f64; 3]) -> f64 {
    let around = (x * x + y * y).sqrt() - 0.6;
    (around * around + z * z).sqrt() - 0.25
}

fn gyroid(p: [f64; 3]) -> f64 {
    let [x, y, z] = p.map(|x| 4.0 * x);
    libm::sin(x) * libm::cos(y) + libm::sin(y) * libm::cos(z) + libm::sin(z) * libm::cos(x)
}

/// Samples in the cube from −1 to 1, in a lattice that is sheared or mirrored as asked.
pub fn sampled(f: Function, n: usize, affine: &Affine3) -> Grid {
    let mut values = Vec::with_capacity(n * n * n);
    for k in 0..n {
        for j in 0..n {
            for i in 0..n {
                values.push(f(affine.at([i as f64, j as f64, k as f64])));
            }
        }
    }
    Grid::new([n; 3], Samples::F64(values), *affine).unwrap()
}

fn cube(n: usize) -> Affine3 {
    Affine3::cubes([-1.0; 3], 2.0 / (n - 1) as f64).unwrap()
}

/// The trilinear interpolant by its definition, at a place between indices.
pub fn interpolant(grid: &Grid, at: [f64; 3]) -> f64 {
    let low: [usize; 3] = std::array::from_fn(|k| (at[k] as usize).min(grid.size()[k] - 2));
    let part: [f64; 3] = std::array::from_fn(|k| at[k] - low[k] as f64);
    (0..8)
        .map(|c: usize| {
            let bit = [c & 1, c >> 1 & 1, c >> 2];
            let weight: f64 = (0..3).map(|k| if bit[k] == 1 { part[k] } else { 1.0 - part[k] }).product();
            weight * grid.sample([low[0] + bit[0], low[1] + bit[1], low[2] + bit[2]])
        })
        .sum()
}

/// Points of the interpolant's surface: zeros on random lines along the axes of the lattice, by bisection of
/// each cell into 8 parts.
pub fn surface_points(grid: &Grid, random: &mut Random, lines: usize) -> Vec<[f64; 3]> {
    let mut points = Vec::new();
    let n = grid.size();
    for line in 0..lines {
        let axis = line % 3;
        let start: [f64; 3] = std::array::from_fn(|k| random.unit() * (n[k] - 1) as f64);
        let value = |x: f64| {
            let mut at = start;
            at[axis] = x;
            interpolant(grid, at)
        };
        for step in 0..8 * (n[axis] - 1) {
            let (mut low, mut high) = (step as f64 / 8.0, (step + 1) as f64 / 8.0);
            if (value(low) < 0.0) == (value(high) < 0.0) {
                continue;
            }
            let side = value(low) < 0.0;
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if (value(middle) < 0.0) == side { low = middle } else { high = middle }
            }
            let mut at = start;
            at[axis] = low;
            points.push(grid.affine().at(at));
        }
    }
    points
}

pub fn to_triangle(p: [f64; 3], [a, b, c]: [[f64; 3]; 3]) -> f64 {
    let sub = |u: [f64; 3], v: [f64; 3]| [u[0] - v[0], u[1] - v[1], u[2] - v[2]];
    let dot = |u: [f64; 3], v: [f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    let segment = |a: [f64; 3], b: [f64; 3]| {
        let (d, q) = (sub(b, a), sub(p, a));
        let t = (dot(q, d) / dot(d, d)).clamp(0.0, 1.0);
        let r = [q[0] - t * d[0], q[1] - t * d[1], q[2] - t * d[2]];
        dot(r, r).sqrt()
    };
    let (u, v, w) = (sub(b, a), sub(c, a), sub(p, a));
    let (uu, uv, vv, wu, wv) = (dot(u, u), dot(u, v), dot(v, v), dot(w, u), dot(w, v));
    let det = uu * vv - uv * uv;
    let (s, t) = ((vv * wu - uv * wv) / det, (uu * wv - uv * wu) / det);
    if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
        let r: [f64; 3] = std::array::from_fn(|k| w[k] - s * u[k] - t * v[k]);
        return dot(r, r).sqrt();
    }
    segment(a, b).min(segment(b, c)).min(segment(c, a))
}

/// The farthest of some points from the mesh.
pub fn one_sided(points: &[[f64; 3]], mesh: &Mesh) -> f64 {
    points
        .iter()
        .map(|p| {
            (0..mesh.faces().len()).map(|f| to_triangle(*p, mesh.corners(f))).fold(f64::INFINITY, f64::min)
        })
        .fold(0.0, f64::max)
}

/// The place of a point between indices.
pub fn indices(grid: &Grid, p: [f64; 3]) -> [f64; 3] {
    // By Newton's steps on the affine map: exact up to rounding after one for a linear map.
    let s = grid.affine().steps();
    let d: [f64; 3] = std::array::from_fn(|k| p[k] - grid.affine().at([0.0; 3])[k]);
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let dot = |u: [f64; 3], v: [f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    let det = dot(s[0], cross(s[1], s[2]));
    [dot(d, cross(s[1], s[2])) / det, dot(d, cross(s[2], s[0])) / det, dot(d, cross(s[0], s[1])) / det]
}

/// The farthest of points of the mesh from dense points of the surface around them: a bound from above only
/// as far as those are dense, so it is compared with what the spacing allows.
fn mesh_to_surface(grid: &Grid, mesh: &Mesh, random: &mut Random) -> f64 {
    let lattice = |p: [f64; 3]| indices(grid, p);
    let n = grid.size();
    let mut worst = 0.0_f64;
    // By default of two thousand faces.
    let step = if is_long() { 1 } else { mesh.faces().len().div_ceil(2000) };
    for face in (0..mesh.faces().len()).step_by(step.max(1)) {
        let [a, b, c] = mesh.corners(face);
        let (mut s, mut t) = (random.unit(), random.unit());
        if s + t > 1.0 {
            (s, t) = (1.0 - s, 1.0 - t);
        }
        let p: [f64; 3] = std::array::from_fn(|k| a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]));
        let q = lattice(p);
        if (0..3).any(|k| q[k] < 1e-6 || q[k] > (n[k] - 1) as f64 - 1e-6) {
            continue;
        }
        // The nearest zero along any of the axes: at least the distance to the surface.
        let side = interpolant(grid, q) < 0.0;
        let mut nearest = f64::INFINITY;
        for axis in 0..3 {
            let step = grid.affine().steps()[axis].map(|x| x * x).iter().sum::<f64>().sqrt();
            for sign in [-1.0, 1.0] {
                let mut far = 1.0 / 64.0;
                while far < 1.5 {
                    let mut r = q;
                    r[axis] = (q[axis] + sign * far).clamp(0.0, (n[axis] - 1) as f64);
                    if (interpolant(grid, r) < 0.0) != side {
                        nearest = nearest.min(far * step);
                        break;
                    }
                    far += 1.0 / 64.0;
                }
            }
        }
        worst = worst.max(nearest);
    }
    worst
}

/// Both directions, for surfaces that are smooth enough to have a zero near along an axis.
fn check(grid: &Grid, rule: &Polygonize) -> (f64, f64) {
    let (seen, most) = check_surface(grid, rule);
    let made = grid_to_mesh(grid, rule, None, &Job::default()).unwrap();
    let back = mesh_to_surface(grid, &made.shape, &mut Random::new(0x5EED_0004));
    let step = grid.affine().steps()[0].map(|x| x * x).iter().sum::<f64>().sqrt();
    assert!(back <= most + step / 32.0, "seen {back} of the mesh, bound {most}");
    (seen, most)
}

fn check_surface(grid: &Grid, rule: &Polygonize) -> (f64, f64) {
    let made = grid_to_mesh(grid, rule, None, &Job::default()).unwrap();
    let most = made.bound.at_most().unwrap();
    let mut random = Random::new(0x5EED_0002);
    let points = surface_points(grid, &mut random, 60);
    let seen = one_sided(&points, &made.shape);
    assert!(seen <= most, "seen {seen}, bound {most}");
    assert!(made.bound.at_least() <= most);
    if made.bound.at_least() > 0.0 {
        // What is seen from below is a point of the surface that is so far from the mesh.
        let at = made.bound.at.unwrap();
        let value = interpolant(grid, indices(grid, at));
        assert!((value - rule.level).abs() < 1e-4, "{value} at {at:?}");
        let far = one_sided(&[at], &made.shape);
        assert!(far >= made.bound.at_least() * (1.0 - 1e-9), "{far} {:?}", made.bound);
    }
    (seen, most)
}

#[test]
fn the_bound_holds_and_falls_with_the_square_of_the_step() {
    for (name, f) in some([("torus", torus as Function), ("gyroid", gyroid), ("sphere", sphere)], 1) {
        for border in some([Border::Capped, Border::Open], 1) {
            let rule = Polygonize { border: [[border; 2]; 3], ..Polygonize::below(0.0) };
            let bounds = [17, 33, 65].map(|n| check(&sampled(f, n, &cube(n)), &rule));
            // The border cuts the gyroid at tangents, where cells are cut up as far as that is worth it.
            if name == "gyroid" {
                assert!(
                    bounds[1].0 / bounds[2].0 > 2.5 && bounds[1].1 / bounds[2].1 > 1.9,
                    "{name}: {bounds:?}"
                );
                continue;
            }
            // Less than 4 where cells without a steady slope are cut no further than is worth it, more where
            // the coarser lattice has such a cell: 2.6 at the least, measured on the torus. What is seen
            // falls by 2.9 to 6.
            assert!(bounds[1].1 / bounds[2].1 > 2.5, "{name}: {bounds:?}");
            assert!(bounds[0].1 / bounds[2].1 > 8.0, "{name}: {bounds:?}");
            assert!(bounds[2].1 < 12.0 * bounds[2].0, "{name}: {bounds:?}");
        }
    }
}

#[test]
fn sheared_and_mirrored_lattices_keep_the_front_outside_and_the_bound() {
    let shapes = [
        [[0.1, 0.03, 0.0, -1.2], [0.0, 0.1, 0.02, -1.0], [0.0, 0.0, 0.1, -1.0]],
        [[-0.1, 0.0, 0.0, 1.0], [0.0, 0.1, 0.0, -1.0], [0.0, 0.0, 0.1, -1.0]],
        [[0.0, 0.0, 0.1, -1.0], [0.0, 0.1, 0.0, -1.0], [0.1, 0.0, 0.0, -1.0]],
        [[0.0, 0.1, 0.0, -1.0], [-0.1, 0.02, 0.0, 1.0], [0.0, 0.0, 0.08, -0.8]],
    ];
    for rows in some(shapes, 2) {
        let affine = Affine3::new(rows).unwrap();
        let grid = sampled(sphere, 22, &affine);
        let rule = Polygonize { normals: Normals::Gradient, ..Polygonize::below(0.0) };
        check(&grid, &rule);
        let mesh = grid_to_mesh(&grid, &rule, None, &Job::default()).unwrap().shape;
        assert_eq!(flaw(mesh.positions().len(), mesh.faces(), |_, _| false), None);
        let volume = volume6(mesh.positions(), mesh.faces()) / 6.0;
        let ball = 4.0 / 3.0 * std::f64::consts::PI * 0.343;
        assert!((volume - ball).abs() < 0.03 * ball, "{rows:?}: {volume} {ball}");
        let normals = mesh.attribute(&Semantic::Normal).unwrap();
        for (row, p) in mesh.positions().iter().enumerate() {
            let n = normals.row(row);
            let radial = (n[0] * p[0] + n[1] * p[1] + n[2] * p[2]) / 0.7;
            assert!(radial > 0.95, "{rows:?}: normal {n:?} at {p:?}");
        }
    }
}

/// Noise has cells of every kind: the bound is that of diagonals there, and holds.
#[test]
fn the_bound_holds_on_noise() {
    let mut random = Random::new(0x5EED_0003);
    for _ in 0..if is_long() { 60 } else { 3 } {
        let n = 3 + random.below(4);
        let values = (0..n * n * n).map(|_| random.below(9) as f32 - 4.0).collect();
        let grid = Grid::new([n; 3], Samples::F32(values), Affine3::IDENTITY).unwrap();
        let rule = Polygonize::below(0.0);
        check_surface(&grid, &rule);
        check_surface(&grid, &rule.open());
    }
}

/// A mask has no slope along any axis over three cells, and its bound is not the diagonal of a cell all the
/// same.
#[test]
fn a_mask_is_within_less_than_a_diagonal() {
    let n = 24;
    let inside =
        |i: usize| (0..3).map(|k| (i / [1, n, n * n][k] % n) as i32 - 11).map(|d| d * d).sum::<i32>() < 80;
    let values = (0..n * n * n).map(|i| u8::from(inside(i))).collect();
    let grid = Grid::new([n; 3], Samples::U8(values), Affine3::IDENTITY).unwrap();
    let (_, most) = check_surface(&grid, &Polygonize::above(0.5));
    assert!(most < 0.7 * 3.0_f64.sqrt(), "{most}");
    let made = grid_to_mesh(&grid, &Polygonize::above(0.5), None, &Job::default()).unwrap();
    assert!(made.bound.at_least() > 0.3 * most, "{:?}", made.bound);
    let threads =
        |n| grid_to_mesh(&grid, &Polygonize::above(0.5), None, &Job::default().with_threads(n)).unwrap();
    assert_eq!(threads(1).bound, threads(3).bound);
}

/// Pixels are lengths where the lattice is seen from.
#[test]
fn pixels_are_a_budget() {
    use chordal::Budget;
    use chordal::budget::{Pixels, View};
    let grid = sampled(sphere, 12, &cube(12));
    let view: View = "640x480 fov=45 dist=4".parse().unwrap();
    let asked = |pixels: f64| {
        let budget = Budget::pixels(Pixels::new(pixels).unwrap(), view);
        grid_to_mesh(&grid, &Polygonize::below(0.0), Some(&budget), &Job::default())
    };
    let [coarse, fine] = [8.0, 0.5].map(|pixels| asked(pixels).unwrap());
    assert!(coarse.bound.pixels.unwrap() <= 8.0 && fine.bound.pixels.unwrap() <= 0.5);
    assert!(coarse.shape.faces().len() < fine.shape.faces().len());
}
