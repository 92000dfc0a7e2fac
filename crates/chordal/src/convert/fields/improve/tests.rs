//! Tests with small closed surfaces near those of fields: the results are closed, embedded, within the
//! tolerance, and of few triangles.
use super::{FaceLabel, ImproveError, LabelledSurface, SurfaceImprover};
use crate::budget::Job;
use crate::check::self_intersections;
use crate::explicit::{HalfEdges, Mesh};
use crate::implicit::{Csg, Dual, Expr, PrimitiveEvaluator, shapes};
use crate::math::Box3;
use chordal_testkit::Random;
use glam::DVec3;

/// An octahedron divided `levels` times, its vertices moved by `shape`.
fn octahedron(levels: u32, shape: impl Fn(DVec3) -> DVec3) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let mut positions: Vec<DVec3> = vec![DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z];
    let mut faces: Vec<[u32; 3]> =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..levels {
        let mut middles = std::collections::BTreeMap::new();
        let mut next = Vec::new();
        for [a, b, c] in faces {
            let mut middle = |p: u32, q: u32| {
                *middles.entry(if p < q { (p, q) } else { (q, p) }).or_insert_with(|| {
                    positions.push(0.5 * (positions[p as usize] + positions[q as usize]));
                    positions.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            next.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        faces = next;
    }
    (positions.into_iter().map(|p| shape(p).to_array()).collect(), faces)
}

/// Projects onto a sphere.
fn on_sphere(radius: f64) -> impl Fn(DVec3) -> DVec3 {
    move |p| radius * p.normalize()
}

/// A grid of `n × n` quads on each side of a box, as triangles; the same on all sides.
fn cuboid(half: DVec3, n: i32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let mut numbers = std::collections::BTreeMap::new();
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for axis in 0..3 {
        for side in [0, n] {
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let mut corner = |i: i32, j: i32| {
                    let mut at = [0; 3];
                    (at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3]) = (side, i, j);
                    *numbers.entry(at).or_insert_with(|| {
                        let place = at.map(|k| 2.0 * f64::from(k) / f64::from(n) - 1.0);
                        positions.push((half * DVec3::from(place)).to_array());
                        positions.len() as u32 - 1
                    })
                };
                let quad = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
                let [a, b, c, d] = if side == 0 { [quad[3], quad[2], quad[1], quad[0]] } else { quad };
                faces.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    (positions, faces)
}

/// Labels each face: with the primitive that is nearest at its middle in distance and in the direction of its
/// gradient.
fn labelled(csg: &Csg, (positions, faces): (Vec<[f64; 3]>, Vec<[u32; 3]>)) -> LabelledSurface {
    let label = |face: &[u32; 3]| -> FaceLabel {
        let [a, b, c] = face.map(|v| DVec3::from(positions[v as usize]));
        let normal = (b - a).cross(c - a).normalize();
        let mut best = (f64::INFINITY, 0);
        for (number, primitive) in csg.primitives().iter().enumerate() {
            let mut slope = [Dual { value: 0.0, gradient: [0.0; 3] }];
            primitive.tape().gradient_at(&[((a + b + c) / 3.0).to_array()], &mut slope).unwrap();
            let gradient = DVec3::from(slope[0].gradient);
            let along = gradient.normalize().dot(normal);
            let distance = (slope[0].value / gradient.length()).abs() + (1.0 - along.abs());
            if distance < best.0 {
                best = (distance, 2 * number as u32 + u32::from(along < 0.0));
            }
        }
        best.1
    };
    let labels = faces.iter().map(label).collect();
    LabelledSurface { positions, faces, labels }
}

struct ImprovedModel {
    surface: LabelledSurface,
    n_points: u64,
}

fn improved(csg: &Csg, raw: &LabelledSurface, tol: f64, threads: usize) -> ImprovedModel {
    let job = Job::default().with_threads(threads);
    let evaluator = PrimitiveEvaluator::new(csg, &Box3::from_points(&raw.positions), &job);
    let mut improver = SurfaceImprover::new(raw, evaluator, tol, &job).unwrap();
    assert!(improver.blocked().is_empty());
    improver.refine().unwrap();
    improver.improve().unwrap();
    assert_eq!(improver.count_wrong_samples(), 0);
    let (surface, numbers) = improver.mesh();
    assert_eq!(numbers.len(), surface.faces.len());
    ImprovedModel { surface, n_points: improver.into_evaluator().n_points() }
}

/// Checks that a surface is a closed manifold, embedded, and each face along its primitive and within the
/// tolerance of it at many points.
fn check(csg: &Csg, surface: &LabelledSurface, tol: f64) {
    assert!(HalfEdges::from_faces(&surface.faces, surface.positions.len()).is_some(), "a closed manifold");
    let mesh = Mesh::new(surface.positions.clone(), surface.faces.clone()).unwrap();
    assert_eq!(self_intersections(&mesh, &Job::default()).unwrap().count, 0);
    for (face, label) in surface.faces.iter().zip(&surface.labels) {
        let [a, b, c] = face.map(|v| DVec3::from(surface.positions[v as usize]));
        let mut points = Vec::new();
        for i in 0..=6 {
            for j in 0..=6 - i {
                let (u, v) = (f64::from(i) / 6.0, f64::from(j) / 6.0);
                points.push((a + u * (b - a) + v * (c - a)).to_array());
            }
        }
        let mut slopes = vec![Dual { value: 0.0, gradient: [0.0; 3] }; points.len()];
        csg.primitives()[*label as usize / 2].tape().gradient_at(&points, &mut slopes).unwrap();
        for slope in slopes {
            let gradient = DVec3::from(slope.gradient) * if label % 2 == 1 { -1.0 } else { 1.0 };
            assert!(
                slope.value.abs() <= tol * gradient.length(),
                "{} of {tol}",
                slope.value / gradient.length()
            );
            assert!((b - a).cross(c - a).dot(gradient) > 0.0, "turned over");
        }
    }
}

fn ball(radius: f64) -> Csg {
    Csg::from_expr(shapes::sphere(radius).unwrap().sign())
}

#[test]
fn a_ball_is_within_the_tolerance_at_any_scale() {
    for scale in [1e-6, 1.0, 1e6] {
        let csg = ball(0.6 * scale);
        for levels in [0, 2, 5] {
            let raw = labelled(&csg, octahedron(levels, |p| 0.595 * scale * p.normalize()));
            let model = improved(&csg, &raw, 3e-3 * scale, 1);
            check(&csg, &model.surface, 3e-3 * scale);
            let n = model.surface.faces.len();
            // Eight triangles halved repeatedly are 2048 at that size.
            assert!(n <= 2200, "{n} triangles from {levels} levels at {scale}");
            assert!(
                model.n_points <= 40 * n as u64 + 4 * raw.faces.len() as u64,
                "{} points",
                model.n_points
            );
        }
    }
}

#[test]
fn flat_faces_are_free() {
    let csg = Csg::from_expr(shapes::cuboid([2.0, 4.0, 6.0]).unwrap().sign());
    let raw = labelled(&csg, cuboid(DVec3::new(1.01, 1.98, 3.02), 8));
    let model = improved(&csg, &raw, 1e-3, 1);
    check(&csg, &model.surface, 1e-9);
    assert_eq!(model.surface.faces.len(), 12);
}

/// A prism about the z axis.
fn prism((n, radius, half): (u32, f64, f64)) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let mut positions = vec![[0.0, 0.0, -half], [0.0, 0.0, half]];
    let mut faces = Vec::new();
    for k in 0..n {
        let angle = std::f64::consts::TAU * f64::from(k) / f64::from(n);
        let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
        positions.extend([[radius * cosine, radius * sine, -half], [radius * cosine, radius * sine, half]]);
        let (a, b) = (2 + 2 * k, 2 + 2 * ((k + 1) % n));
        faces.extend([[a, b, b + 1], [a, b + 1, a + 1], [0, b, a], [1, a + 1, b + 1]]);
    }
    (positions, faces)
}

#[test]
fn ruled_faces_are_strips() {
    let csg = Csg::from_expr(shapes::cylinder(5.0, 50.0).unwrap().sign());
    for n in [8, 200] {
        let raw = labelled(&csg, prism((n, 5.0, 25.0)));
        let model = improved(&csg, &raw, 0.1, 1);
        check(&csg, &model.surface, 0.1);
        assert!(model.surface.faces.len() <= 150, "{} triangles from {n} sides", model.surface.faces.len());
    }
}

#[test]
fn threads_change_nothing() {
    let raw = labelled(&ball(1.0), octahedron(5, on_sphere(1.0)));
    let csg = ball(1.0);
    let surfaces = [1, 2, 8].map(|threads| improved(&csg, &raw, 2e-3, threads).surface);
    for other in &surfaces[1..] {
        assert_eq!(surfaces[0].faces, other.faces);
        assert_eq!(surfaces[0].labels, other.labels);
        let bits =
            |s: &LabelledSurface| s.positions.iter().flatten().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&surfaces[0]), bits(other));
    }
}

#[test]
fn random_labels_end_in_a_closed_surface() {
    // Random labels: the surface stays a closed manifold, whatever primitives its faces belong to.
    let csg = Csg::from_expr(shapes::cuboid([1.0; 3]).unwrap().sign());
    let mut random = Random::new(3);
    for round in 0..5 {
        let (positions, faces) = octahedron(3, on_sphere(0.7));
        let n_labels = 2 * csg.primitives().len();
        let labels = faces.iter().map(|_| random.below(n_labels) as u32).collect();
        let raw = LabelledSurface { positions, faces, labels };
        let mut job = Job::default().with_threads(1);
        job.triangle_limit = 4000;
        let evaluator = PrimitiveEvaluator::new(&csg, &Box3::from_points(&raw.positions), &job);
        let mut improver = SurfaceImprover::new(&raw, evaluator, 0.05, &job).unwrap();
        // It may need more triangles than are allowed.
        let improved = improver.refine().and_then(|_| improver.improve());
        assert!(matches!(improved, Ok(()) | Err(ImproveError::TooMany(_))));
        let (surface, _) = improver.mesh();
        let closed = HalfEdges::from_faces(&surface.faces, surface.positions.len()).is_some();
        assert!(closed && !surface.faces.is_empty(), "round {round}");
        let mesh = Mesh::new(surface.positions, surface.faces).unwrap();
        assert_eq!(self_intersections(&mesh, &Job::default()).unwrap().count, 0, "round {round}");
    }
}

#[test]
fn a_wall_thinner_than_the_tolerance_keeps_its_sheets_apart() {
    // A hollow ball whose wall is a fifth of the tolerance.
    let (outer, inner) = (shapes::sphere(1.0).unwrap(), shapes::sphere(0.99).unwrap());
    let csg = Csg::from_expr(outer.difference(&inner).sign());
    let (mut positions, mut faces) = octahedron(4, on_sphere(1.001));
    let n = positions.len() as u32;
    let (within, turned) = octahedron(4, on_sphere(0.989));
    positions.extend(within);
    faces.extend(turned.iter().map(|[a, b, c]| [a + n, c + n, b + n]));
    let raw = labelled(&csg, (positions, faces));
    let model = improved(&csg, &raw, 0.05, 1);
    // Copies displaced by half of the wall have to stay apart.
    check(&csg, &model.surface, 0.5 * 0.01);
}

#[test]
fn named_faces_are_split() {
    let csg = ball(1.0);
    let raw = labelled(&csg, octahedron(3, on_sphere(1.0)));
    let job = Job::default().with_threads(1);
    let evaluator = PrimitiveEvaluator::new(&csg, &Box3::from_points(&raw.positions), &job);
    let mut improver = SurfaceImprover::new(&raw, evaluator, 0.02, &job).unwrap();
    improver.refine().unwrap();
    improver.improve().unwrap();
    let (before, numbers) = improver.mesh();
    let n_split = improver.split_faces(&numbers[..10]).unwrap();
    assert!(n_split >= 3, "{n_split}");
    let (after, _) = improver.mesh();
    assert_eq!(after.faces.len(), before.faces.len() + 2 * n_split);
    check(&csg, &after, 0.02);
}

#[test]
fn a_cancelled_job_and_an_open_surface_are_told() {
    let csg = ball(1.0);
    let raw = labelled(&csg, octahedron(2, on_sphere(1.0)));
    let job = Job::default();
    let evaluator = || PrimitiveEvaluator::new(&csg, &Box3::from_points(&raw.positions), &job);
    let open =
        LabelledSurface { faces: raw.faces[1..].to_vec(), labels: raw.labels[1..].to_vec(), ..raw.clone() };
    let improver = SurfaceImprover::new(&open, evaluator(), 0.1, &job);
    assert!(matches!(improver.err(), Some(ImproveError::NotManifold)));
    job.cancel();
    let improver = SurfaceImprover::new(&raw, evaluator(), 0.1, &job);
    assert!(matches!(improver.err(), Some(ImproveError::Cancelled)));
}

#[test]
fn a_field_without_gradients_ends() {
    // Its gradient is 0 everywhere but on a sphere.
    let [x, y, z] = Expr::axes();
    let steps = Expr::unary(
        crate::implicit::evaluation::Unary::Floor,
        &((x.square() + y.square() + z.square()) * 4.0),
    ) - 3.5;
    let csg = Csg::from_expr(&steps);
    let raw = labelled(&csg, octahedron(3, on_sphere(1.0)));
    let job = Job::default().with_threads(1);
    let evaluator = PrimitiveEvaluator::new(&csg, &Box3::from_points(&raw.positions), &job);
    let mut improver = SurfaceImprover::new(&raw, evaluator, 0.02, &job).unwrap();
    improver.refine().unwrap();
    improver.improve().unwrap();
    let (surface, _) = improver.mesh();
    assert!(HalfEdges::from_faces(&surface.faces, surface.positions.len()).is_some());
}
