//! Meshes, outlines and curves as fields and grids, against plain loops over all triangles and closed forms.
use chordal::check::zero_set_deviation;
use chordal::convert::lattices::Lattice;
use chordal::convert::{
    DistanceGrid, curve_to_field, field_to_grid, mesh_to_field, mesh_to_grid, mesh_to_sparse_grid,
    outline_to_field,
};
use chordal::explicit::{Arc, Curve, CurveEnds, CurveSegment, FillRule, Outline};
use chordal::implicit::leaves::{Leaf, LeafAnswer, LeafError};
use chordal::implicit::shapes::{gyroid, sphere, torus};
use chordal::implicit::{Distance, DistanceQuality, Expr, Field};
use chordal::math::{Box3, Interval};
use chordal::{Bezier, Budget, Evidence, Job, Mesh, Tolerance};
use chordal_testkit::Random;
use chordal_testkit::sampler::{cross, dot, sub};

/// A torus of quadrilaterals cut in two, wobbly, so that it is neither convex nor regular.
fn ring(n: u32, m: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let turn = std::f64::consts::TAU;
    let point = |i: u32, j: u32| {
        let (a, b) = (turn * f64::from(i) / f64::from(n), turn * f64::from(j) / f64::from(m));
        let r = 0.4 + 0.1 * (3.0 * a).sin() * b.cos();
        let out = 1.0 + r * b.cos();
        [out * a.cos(), out * a.sin(), r * b.sin()]
    };
    let row = |i: u32, j: u32| (i % n) * m + j % m;
    let points = (0..n).flat_map(|i| (0..m).map(move |j| point(i, j))).collect();
    let faces = (0..n)
        .flat_map(|i| (0..m).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [row(i, j), row(i + 1, j), row(i + 1, j + 1), row(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    (points, faces)
}

/// The distance to one triangle: to its plane where the foot is inside, else to its sides.
fn to_triangle(p: [f64; 3], t: [[f64; 3]; 3]) -> f64 {
    let n = cross(sub(t[1], t[0]), sub(t[2], t[0]));
    let within = (0..3).all(|k| dot(cross(sub(t[(k + 1) % 3], t[k]), sub(p, t[k])), n) >= 0.0);
    if within && dot(n, n) > 0.0 {
        return dot(sub(p, t[0]), n).abs() / dot(n, n).sqrt();
    }
    (0..3)
        .map(|k| {
            let (e, d) = (sub(t[(k + 1) % 3], t[k]), sub(p, t[k]));
            let s = (dot(d, e) / dot(e, e)).clamp(0.0, 1.0);
            let off = [d[0] - s * e[0], d[1] - s * e[1], d[2] - s * e[2]];
            dot(off, off).sqrt()
        })
        .fold(f64::INFINITY, f64::min)
}

/// The sum of the solid angles over a full turn.
fn winding(p: [f64; 3], mesh: &Mesh) -> f64 {
    let angle = |t: [[f64; 3]; 3]| {
        let [a, b, c] = t.map(|q| sub(q, p));
        let [la, lb, lc] = [a, b, c].map(|v| dot(v, v).sqrt());
        let base = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
        2.0 * dot(a, cross(b, c)).atan2(base)
    };
    let sum: f64 = (0..mesh.faces().len()).map(|f| angle(mesh.corners(f))).sum();
    sum / (4.0 * std::f64::consts::PI)
}

fn plain(p: [f64; 3], mesh: &Mesh) -> f64 {
    let distance =
        (0..mesh.faces().len()).map(|f| to_triangle(p, mesh.corners(f))).fold(f64::INFINITY, f64::min);
    if winding(p, mesh) > 0.5 { -distance } else { distance }
}

fn values(field: &Field, points: &[[f64; 3]]) -> Vec<f64> {
    let mut out = vec![0.0; points.len()];
    field.tape().at(points, &mut out).expect("no leaf fails");
    out
}

#[test]
fn a_mesh_is_the_field_that_a_loop_over_its_triangles_says() {
    let (points, faces) = ring(40, 24);
    let mesh = Mesh::new(points, faces).expect("valid");
    let made = mesh_to_field(&mesh, &Job::default()).expect("small");
    assert!(made.solid.is_solid(), "{}", made.solid);
    assert_eq!(made.field.distance(), Distance::EXACT);
    let mut random = Random::new(11);
    let points: Vec<[f64; 3]> = (0..3000).map(|_| random.point_within::<3>(1.8)).collect();
    for (p, v) in points.iter().zip(values(&made.field, &points)) {
        let truth = plain(*p, &mesh);
        assert!((v - truth).abs() <= 1e-6 * truth.abs() + 3e-12, "{v} and {truth} at {p:?}");
        assert!(v > 0.0 || made.field.bounds().contains(*p));
    }
    // The same on any number of threads, and in any order.
    let one = values(&mesh_to_field(&mesh, &Job::default().with_threads(1)).expect("small").field, &points);
    let backwards: Vec<[f64; 3]> = points.iter().rev().copied().collect();
    let mut turned = values(&made.field, &backwards);
    turned.reverse();
    assert_eq!(one, turned);
}

#[test]
fn ranges_of_a_mesh_hold_its_values() {
    let (points, faces) = ring(24, 12);
    let mesh = Mesh::new(points, faces).expect("valid");
    let tape = mesh_to_field(&mesh, &Job::default()).expect("small").field.tape();
    assert_eq!(tape.evidence(), Evidence::Proved);
    let mut random = Random::new(12);
    for round in 0..400 {
        let (p, size) = (random.point_within::<3>(1.6), if round % 2 == 0 { 0.3 } else { 0.02 });
        let bounds = Box3 { min: p, max: p.map(|x| x + size) };
        let unknown = chordal::implicit::evaluation::Dual {
            value: Interval::UNKNOWN,
            gradient: [Interval::UNKNOWN; 3],
        };
        let mut range = [unknown];
        tape.gradient_over(&[bounds], &mut range).expect("no leaf fails");
        assert!(range[0].value.is_defined());
        let inside: Vec<[f64; 3]> = (0..20).map(|_| p.map(|x| x + size * random.unit())).collect();
        let mut slopes =
            vec![chordal::implicit::evaluation::Dual { value: 0.0, gradient: [0.0; 3] }; inside.len()];
        tape.gradient_at(&inside, &mut slopes).expect("no leaf fails");
        for slope in slopes {
            assert!(range[0].value.contains(slope.value), "{} in {}", slope.value, range[0].value);
            for k in 0..3 {
                // A gradient at a point is rounded.
                let (low, high) = (range[0].gradient[k].lo() - 1e-12, range[0].gradient[k].hi() + 1e-12);
                assert!(low <= slope.gradient[k] && slope.gradient[k] <= high);
            }
        }
    }
}

fn bake(mesh: &Mesh, cells: usize, band: Option<f64>) -> DistanceGrid {
    mesh_to_grid(mesh, cells, band, &Job::default()).expect("small")
}

#[test]
fn a_baked_grid_holds_distances_in_its_band_and_sides_beyond() {
    let (points, faces) = ring(40, 24);
    let mesh = Mesh::new(points, faces).expect("valid");
    let (all, near) = (bake(&mesh, 40, None), bake(&mesh, 40, Some(2.0)));
    assert_eq!((all.band, all.grid.size()), (f64::INFINITY, [47, 47, near.grid.size()[2] + 2]));
    let mut within = 0;
    for (grid, band) in [(&all.grid, f64::INFINITY), (&near.grid, near.band)] {
        let size = grid.size();
        for k in 0..size[2] {
            for j in 0..size[1] {
                for i in 0..size[0] {
                    if (i + 3 * j + 5 * k) % 17 != 0 {
                        continue;
                    }
                    let p = grid.affine().at([i as f64, j as f64, k as f64]);
                    let (v, truth) = (grid.sample([i, j, k]), plain(p, &mesh));
                    let clamped = truth.clamp(-band, band);
                    assert!((v - clamped).abs() <= 1e-6 * truth.abs() + 3e-12, "{v} and {truth} at {p:?}");
                    within += u64::from(band.is_finite() && truth.abs() <= band);
                }
            }
        }
    }
    assert!(within > 100 && near.n_within > 10 * within);
}

#[test]
fn a_field_in_bricks_is_the_field() {
    let shape = torus(1.0, 0.4).expect("a shape").intersection(&gyroid(0.7, 0.0).expect("a shape"));
    let lattice = Lattice::around(&shape.bounds(), 37, 2).expect("a box");
    let job = Job::default();
    let all = field_to_grid(&shape, &lattice, None, &job).expect("small");
    let near = field_to_grid(&shape, &lattice, Some(0.05), &job).expect("small");
    let mut points = Vec::new();
    for k in 0..lattice.size[2] {
        for j in 0..lattice.size[1] {
            points.extend((0..lattice.size[0]).map(|i| lattice.at([i, j, k])));
        }
    }
    for (row, truth) in values(&shape, &points).into_iter().enumerate() {
        assert_eq!(all.samples().get(row), truth);
        assert_eq!(near.samples().get(row), truth.clamp(-0.05, 0.05));
    }
    let one = field_to_grid(&shape, &lattice, None, &Job::default().with_threads(1)).expect("small");
    assert_eq!(one, all);
}

/// A leaf that has no answer.
#[derive(Debug)]
struct Broken;

impl Leaf for Broken {
    fn at(&self, _: &[[f64; 3]], _: &mut [f64]) -> Result<(), LeafError> {
        Err(LeafError::new("the disk is full"))
    }
    fn over(&self, _: &[Box3], _: &mut [Interval]) -> Result<LeafAnswer, LeafError> {
        Ok(LeafAnswer::None)
    }
    fn evidence(&self) -> Evidence {
        Evidence::Estimated
    }
}

#[test]
fn what_a_leaf_says_comes_through() {
    let field = Field::new(Expr::leaf(std::sync::Arc::new(Broken), Expr::axes()));
    let lattice = Lattice::around(&Box3 { min: [0.0; 3], max: [1.0; 3] }, 4, 0).expect("a box");
    for band in [None, Some(0.1)] {
        let error = field_to_grid(&field, &lattice, band, &Job::default()).expect_err("broken");
        assert!(error.to_string().contains("the disk is full"), "{error}");
    }
    assert!(field_to_grid(&sphere(1.0).expect("a shape"), &lattice, Some(-1.0), &Job::default()).is_err());
}

fn cube(at: f64, half: f64) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let corner = |k: u32| [0, 1, 2].map(|axis| at + if k >> axis & 1 == 1 { half } else { -half });
    let faces = vec![
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    ((0..8).map(corner).collect(), faces)
}

/// Positions and faces.
type Part = (Vec<[f64; 3]>, Vec<[u32; 3]>);

fn joined(parts: &[Part]) -> Mesh {
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for (p, f) in parts {
        let first = points.len() as u32;
        points.extend_from_slice(p);
        faces.extend(f.iter().map(|face| face.map(|row| row + first)));
    }
    Mesh::new(points, faces).expect("valid")
}

fn turned((points, faces): (Vec<[f64; 3]>, Vec<[u32; 3]>)) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    (points, faces.into_iter().map(|[a, b, c]| [a, c, b]).collect())
}

/// HOSTILE 58 and 60: what is no solid says so, and sides are those of the winding number.
#[test]
fn what_is_no_solid_says_so() {
    let job = Job::default();
    let at = |mesh: &Mesh, p: [f64; 3]| {
        let made = mesh_to_field(mesh, &job).expect("small");
        (made.field.expr().at(p).expect("no leaf fails"), made.solid)
    };
    // Inside out: nothing is inside.
    let (v, solid) = at(&joined(&[turned(cube(0.0, 1.0))]), [0.0; 3]);
    assert!(v == 1.0 && solid.inside_out && solid.to_string().contains("inside out"), "{v}, {solid}");
    // A hole that is a shell of its own, inward: a solid.
    let (v, solid) = at(&joined(&[cube(0.0, 1.0), turned(cube(0.0, 0.5))]), [0.0; 3]);
    assert!(v == 0.5 && solid.is_solid(), "{v}, {solid}");
    // Two shells, both outward: inside of both is inside, at the distance to the nearest wall.
    let (v, _) = at(&joined(&[cube(0.0, 1.0), cube(0.0, 0.5)]), [0.0; 3]);
    assert_eq!(v, -0.5);
    // Two cubes through each other.
    let mesh = joined(&[cube(0.0, 1.0), cube(0.7, 1.0)]);
    let (v, solid) = at(&mesh, [0.35; 3]);
    assert!(v < 0.0 && solid.closed && !solid.is_solid() && solid.self_intersections > 0, "{v}, {solid}");
    assert_eq!(mesh_to_field(&mesh, &job).expect("small").field.distance(), Distance::BOUND);
    // A strip with one side.
    let strip: Vec<[f64; 3]> = (0..24)
        .flat_map(|k| {
            let a = std::f64::consts::TAU * f64::from(k) / 24.0;
            [-0.3, 0.3].map(|w: f64| {
                let out = 1.0 + w * (0.5 * a).cos();
                [out * a.cos(), out * a.sin(), w * (0.5 * a).sin()]
            })
        })
        .collect();
    let faces = (0..24_u32)
        .flat_map(|k| {
            let (a, b) = (2 * k, 2 * k + 1);
            let (c, d) = if k == 23 { (1, 0) } else { (2 * k + 2, 2 * k + 3) };
            [[a, c, b], [b, c, d]]
        })
        .collect();
    let (v, solid) = at(&Mesh::new(strip, faces).expect("valid"), [0.0, 0.0, 1.0]);
    assert!(v > 0.0 && !solid.orientable && solid.to_string().contains("one side only"), "{solid}");
    // Nothing at all.
    let empty = Mesh::new(Vec::new(), Vec::new()).expect("valid");
    let (v, solid) = at(&empty, [0.0; 3]);
    assert!(v > 0.0 && solid.to_string().contains("no triangles"));
    assert!(mesh_to_grid(&empty, 16, None, &job).is_err());
}

/// HOSTILE 59: an open mesh keeps its distances, and says that its sides are a matter of winding.
#[test]
fn an_open_mesh_keeps_its_distances() {
    let (points, mut faces) = cube(0.0, 1.0);
    faces.truncate(10);
    let mesh = Mesh::new(points, faces).expect("valid");
    let made = mesh_to_field(&mesh, &Job::default()).expect("small");
    assert_eq!((made.solid.boundary_edges, made.field.distance()), (4, Distance::SIGN));
    assert!(matches!(made.field.tape().evidence(), Evidence::ProvedIf(_)));
    let mut random = Random::new(5);
    for _ in 0..300 {
        let p = random.point_within::<3>(1.5);
        let v = made.field.expr().at(p).expect("no leaf fails");
        assert!((v.abs() - plain(p, &mesh).abs()).abs() < 1e-12);
        let w = winding(p, &mesh);
        assert!((w - 0.5).abs() < 0.1 || (v < 0.0) == (w > 0.5), "{v} where the winding number is {w}");
    }
}

#[test]
fn numbers_out_of_range_are_refused() {
    let mesh = joined(&[cube(0.0, 1.0)]);
    let job = Job::default();
    for (cells, band) in [(0, None), (8, Some(0.0)), (8, Some(f64::NAN)), (8, Some(-1.0)), (usize::MAX, None)]
    {
        assert!(mesh_to_grid(&mesh, cells, band, &job).is_err(), "{cells} {band:?}");
    }
    let mut small = Job::default();
    small.memory_limit = 1 << 16;
    assert!(mesh_to_grid(&mesh, 512, None, &small).is_err());
    let cancelled = Job::default();
    cancelled.cancel();
    assert!(mesh_to_grid(&mesh, 64, None, &cancelled).is_err());
}

fn circle(r: f64) -> Curve<2> {
    let turn = Arc::new([0.0, 0.0], [[r, 0.0], [0.0, r]], 0.0, std::f64::consts::TAU).expect("an arc");
    Curve::new(vec![CurveSegment::Arc(turn.with_ends([[r, 0.0]; 2]))], CurveEnds::Closed).expect("a curve")
}

#[test]
fn an_outline_is_its_distance_within_the_bound() {
    let ring = Outline { contours: vec![circle(2.0), circle(1.0)], rule: FillRule::EvenOdd };
    let budget = Budget::length(Tolerance::new(1e-3).expect("above 0"));
    let made = outline_to_field(&ring, &budget, &Job::default()).expect("reachable");
    let bound = made.bound.at_most().expect("proved");
    assert!(bound <= 1e-3);
    assert_eq!(made.shape.distance(), Distance::EXACT);
    let washer = made.shape.extruded(1.0).expect("a shape");
    let mut random = Random::new(3);
    for _ in 0..2000 {
        let p = random.point_within::<3>(3.0);
        let r = p[0].hypot(p[1]);
        let flat = (r - 2.0).max(1.0 - r);
        let v = made.shape.expr().at(p).expect("no leaf fails");
        assert!((v - flat).abs() <= bound + 1e-12, "{v} and {flat} at {p:?}");
        let (a, b) = (flat, p[2].abs() - 0.5);
        let truth = a.max(0.0).hypot(b.max(0.0)) + a.max(b).min(0.0);
        let v = washer.expr().at(p).expect("no leaf fails");
        assert!((v - truth).abs() <= 2.0 * bound, "{v} and {truth} at {p:?}");
    }
    // By direction alone the inner circle is filled: it bounds nothing.
    let full = Outline { rule: FillRule::NonZero, ..ring };
    let made = outline_to_field(&full, &budget, &Job::default()).expect("reachable");
    let v = made.shape.expr().at([1.0, 0.0, 0.0]).expect("no leaf fails");
    assert!((v + 1.0).abs() <= 2e-3 && made.shape.distance() == Distance::EXACT, "{v}");
    let nothing = Outline { contours: Vec::new(), rule: FillRule::NonZero };
    assert!(outline_to_field(&nothing, &budget, &Job::default()).is_err());
}

#[test]
fn a_tube_is_all_that_is_near_its_curve() {
    let control = [[0.0, 0.0, 0.0], [0.0, 2.0, 0.5], [2.0, -1.0, 1.0], [1.0, 1.0, 0.0]];
    let curve = Bezier { control };
    let budget = Budget::length(Tolerance::new(1e-4).expect("above 0"));
    let made = curve_to_field(&curve.into(), 0.2, &budget, &Job::default()).expect("reachable");
    assert_eq!(
        made.shape.distance(),
        Distance { outside: DistanceQuality::Exact, inside: DistanceQuality::Bound }
    );
    let on = |t: f64| {
        let s = 1.0 - t;
        let w = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
        std::array::from_fn::<f64, 3, _>(|k| (0..4).map(|i| w[i] * control[i][k]).sum())
    };
    let many: Vec<[f64; 3]> = (0..=2000).map(|k| on(f64::from(k) / 2000.0)).collect();
    let mut random = Random::new(8);
    for _ in 0..500 {
        let p = random.point_within::<3>(2.0);
        let near = many.iter().map(|q| dot(sub(p, *q), sub(p, *q)).sqrt()).fold(f64::INFINITY, f64::min);
        let v = made.shape.expr().at(p).expect("no leaf fails");
        // The samples are 1e-3 apart at most: the nearest one is farther than the curve by less than 1e-3.
        assert!((v - (near - 0.2)).abs() < 1.2e-3, "{v} and {} at {p:?}", near - 0.2);
        assert!(v >= 0.0 || made.shape.bounds().contains(p));
    }
    let flat = curve_to_field(&circle(1.0), 0.1, &budget, &Job::default()).expect("reachable").shape;
    let v = flat.expr().at([2.0, 0.0, 77.0]).expect("no leaf fails");
    assert!((v - 0.9).abs() < 2e-4, "{v}");
    assert!(curve_to_field(&circle(1.0), -0.1, &budget, &Job::default()).is_err());
}

#[test]
fn a_sparse_mesh_is_the_dense_one() {
    let (points, faces) = ring(40, 24);
    let mesh = Mesh::new(points, faces).expect("valid");
    for (cells, band) in [(37, 2.0), (100, 1.5)] {
        let (dense, job) = (bake(&mesh, cells, Some(band)), Job::default().with_threads(1));
        let sparse = mesh_to_sparse_grid(&mesh, cells, band, &job).expect("small");
        assert_eq!((sparse.grid.to_dense(), sparse.n_within), (dense.grid, dense.n_within));
        assert_eq!((sparse.band, sparse.solid), (dense.band, dense.solid));
        let [stored, all] = sparse.grid.n_bricks();
        assert!(stored < all, "{stored} of {all}");
    }
    let mut small = Job::default();
    small.memory_limit = 1 << 20;
    let refused = mesh_to_sparse_grid(&mesh, 100, 2.0, &small).expect_err("bricks of more than a MiB");
    assert!(refused.to_string().contains("the bricks of the band need more than 1048576 bytes"), "{refused}");
}

/// Whether the zeros of the trilinear interpolant along a line of steps, and their distance to the mesh, agree with
/// what was proved; by plain loops.
fn farthest_zero(grid: &chordal::implicit::Grid, mesh: &Mesh) -> f64 {
    let [nx, ny, nz] = grid.size();
    let mut most: f64 = 0.0;
    for (k, j, i) in
        (0..nz - 1).flat_map(|k| (0..ny - 1).flat_map(move |j| (0..nx - 1).map(move |i| (k, j, i))))
    {
        // Along edges of the lattice the interpolant is linear.
        for axis in 0..3 {
            let mut next = [i, j, k];
            next[axis] += 1;
            let (a, b) = (grid.sample([i, j, k]), grid.sample(next));
            if (a < 0.0) != (b < 0.0) {
                let t = a / (a - b);
                let (p, q) = (
                    grid.affine().at([i as f64, j as f64, k as f64]),
                    grid.affine().at(next.map(|x| x as f64)),
                );
                let zero = [0, 1, 2].map(|k| p[k] + t * (q[k] - p[k]));
                most = most.max(plain(zero, mesh).abs());
            }
        }
    }
    most
}

#[test]
fn the_bound_of_a_zero_set_is_kept_and_a_smaller_one_refused() {
    let (points, faces) = ring(40, 24);
    let cubes = joined(&[cube(0.0, 1.0), turned(cube(0.1, 0.4))]);
    let job = Job::default();
    for mesh in [Mesh::new(points, faces).expect("valid"), cubes] {
        for cells in [16, 31] {
            let grid = bake(&mesh, cells, None).grid;
            let spacing = grid.affine().rows()[0][0];
            let truth = farthest_zero(&grid, &mesh);
            let within = |max: f64| {
                let found = zero_set_deviation(&mesh, &grid, Tolerance::new(max).expect("above 0"), &job);
                found.expect("no trouble")
            };
            let found = within(0.875 * spacing).expect("a whole cell is enough");
            let most = found.at_most().expect("proved");
            assert!(truth <= most && most <= 0.875 * spacing, "{truth} {most}");
            assert_eq!(within(0.99 * truth), None, "{cells} cells: zeros are {truth} away");
            // Triangles that are somewhere else.
            let moved: Vec<[f64; 3]> =
                mesh.positions().iter().map(|p| [p[0] + spacing, p[1], p[2]]).collect();
            let other = Mesh::new(moved, mesh.faces().to_vec()).expect("valid");
            let off = Tolerance::new(0.8 * spacing).expect("above 0");
            assert_eq!(zero_set_deviation(&other, &grid, off, &job).expect("no trouble"), None);
            // Half of the triangles: zeros are left over, more than a cell away.
            let half = mesh.faces().len() / 2;
            let fewer = Mesh::new(mesh.positions().to_vec(), mesh.faces()[half..].to_vec()).expect("valid");
            assert_eq!(zero_set_deviation(&fewer, &grid, off, &job).expect("no trouble"), None);
        }
    }
}
