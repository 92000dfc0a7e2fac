//! The corpus of solids: each is meshed within a budget, closed and manifold, and judged by the referee; and
//! the error falls with the square of the cells where shapes are smooth.
use super::measure::{backward, forward, is_good, surface};
use super::shapes::{self, Shape};
use super::{SLACK, budget};
use crate::deviation_referee::triangles_of;
use chordal::check::validity;
use chordal::convert::field_to_mesh;
use chordal::explicit::Topology;
use chordal::implicit::{Expr, Field};
use chordal::math::Box3;
use chordal::{Budget, Job, Mesh};
use chordal_testkit::Random;
use chordal_testkit::{is_long, some};

fn corpus() -> Vec<(Shape, f64)> {
    let (n_bells, within) = if is_long() { (100, 0.04) } else { (12, 0.08) };
    vec![
        (shapes::cube_without_ball(), 0.03),
        (shapes::drilled(), 0.03),
        (shapes::gyroid(), 0.04),
        (shapes::blobs(n_bells, 60.0, &mut Random::new(9)), within),
        (shapes::solid("menger sponge", shapes::menger(), 1.05), 0.06),
        (shapes::solid("touching spheres", shapes::two_balls(), 1.1), 0.08),
    ]
}

#[test]
fn the_corpus_is_met_closed_and_never_farther_than_proved() {
    let mut random = Random::new(11);
    for (shape, length) in corpus() {
        let made = field_to_mesh(&shape.field, &budget(length), &Job::default())
            .unwrap_or_else(|failure| panic!("{}: {failure:?}", shape.name));
        let most = made.bound.at_most().expect("proved");
        // The boxes of some of these shapes are this test's word.
        assert!(made.bound.evidence().bounds_above(), "{}", shape.name);
        assert!(most <= length, "{}: {most}", shape.name);
        is_good(&made.shape).unwrap_or_else(|what| panic!("{}: {what}", shape.name));
        let valid = validity(&made.shape, Topology::Indices);
        assert!(valid.closed && valid.manifold(), "{}", shape.name);
        let soup = triangles_of(&made.shape);
        let ahead = forward(&soup, &shape, &mut random);
        let back = backward(&surface(&shape, 300, &mut random), &soup);
        println!(
            "{}: {} faces, [{:.4}, {most:.4}] of {length}, seen {ahead:.4} {back:.4}",
            shape.name,
            soup.corners.len(),
            made.bound.at_least()
        );
        assert!(ahead.max(back) <= most + SLACK, "{}: {ahead:e} {back:e} of {most:e}", shape.name);
    }
}

/// Half a ring upon a leg that has its width: where they abut the arc ends along the leg's side.
fn arch() -> Expr {
    let [x, y, z] = Expr::axes();
    let leg = (&x - 0.55).max(&(-&x + 0.45)).max(&-&y).max(&(&y - 0.275));
    let far = ((&x - 0.275).square() + (&y - 0.275).square()).sqrt();
    let ring = (&far - 0.275).max(&(-&far + 0.175)).max(&(-&y + 0.275));
    leg.min(&ring).max(&(z.abs() - 1.0))
}

#[test]
fn parts_that_abut_leave_no_edges_without_length() {
    let field = Field::new(arch()).with_bounds(Box3 { min: [-0.05, -0.05, -1.05], max: [0.6, 0.6, 1.05] });
    let made = field_to_mesh(&field, &budget(2e-3), &Job::default()).expect("proved");
    let mesh = &made.shape;
    let valid = validity(mesh, Topology::Indices);
    assert!(valid.closed && valid.manifold() && mesh.faces().len() < 400, "{}", mesh.faces().len());
    let sides = (0..mesh.faces().len()).flat_map(|face| {
        let corners = mesh.corners(face);
        [0, 1, 2].map(|k| (0..3).map(|i| (corners[(k + 1) % 3][i] - corners[k][i]).powi(2)).sum::<f64>())
    });
    let shortest = sides.fold(f64::INFINITY, f64::min).sqrt();
    assert!(shortest > 1e-6, "{shortest:e}");
}

/// The foot of a slanted stroke, of two parts that abut along a slanted line through its lower left corner.
fn foot() -> Expr {
    let [x, y, z] = Expr::axes();
    let along = |slope: f64, offset: f64| &(&(&y * slope) + offset) - &(&x * 4.5);
    let (seam, left) = (along(2.6, 3.2), along(1.8, 2.5));
    let right = -&along(1.8, 2.56);
    let below = -&(&(&y * 0.8) + 0.7);
    let parts = below.max(&seam).min(&(-&seam).max(&left)).max(&right);
    parts.max(&(&y + 0.6)).max(&(&z.abs() - 0.1))
}

#[test]
fn parts_that_abut_at_a_sharp_angle_are_proved() {
    let field = Field::new(foot()).with_bounds(Box3 { min: [0.1, -0.9, -0.11], max: [0.4, -0.55, 0.11] });
    let made = field_to_mesh(&field, &budget(2.8e-3), &Job::default()).expect("proved");
    let valid = validity(&made.shape, Topology::Indices);
    assert!(valid.closed && valid.manifold() && made.shape.faces().len() < 100);
}

/// How far the middles of triangles in a ball about the origin are, as a root mean square.
fn stray(mesh: &Mesh, within: f64, far: impl Fn([f64; 3]) -> f64) -> f64 {
    let all: Vec<f64> = triangles_of(mesh)
        .corners
        .iter()
        .map(|t| std::array::from_fn(|k| (t[0][k] + t[1][k] + t[2][k]) / 3.0))
        .filter(|c: &[f64; 3]| c[0].hypot(c[1]).hypot(c[2]) < within)
        .map(far)
        .collect();
    (all.iter().map(|far| far * far).sum::<f64>() / all.len() as f64).sqrt()
}

/// The gyroid's distance to first order, by its own derivatives.
fn gyroid_far(p: [f64; 3]) -> f64 {
    let [(sx, cx), (sy, cy), (sz, cz)] = p.map(|x| (4.0 * x).sin_cos());
    let value = sx * cy + sy * cz + sz * cx;
    let slope = [cx * cy - sz * sx, cy * cz - sx * sy, cz * cx - sy * sz].map(|d| 4.0 * d);
    value.abs() / slope[0].hypot(slope[1]).hypot(slope[2])
}

#[test]
fn errors_fall_with_the_square_of_the_cells_where_shapes_are_smooth() {
    let own = |shape: &Shape, p: [f64; 3]| (shape.own)(p).abs() / shape.slope;
    for shape in some([shapes::torus(), shapes::sphere(), shapes::gyroid()], 2) {
        let of = |triangles: u64| {
            let budget = Budget { triangles: Some(triangles), ..Budget::default() };
            let mesh = field_to_mesh(&shape.field, &budget, &Job::default()).expect("a mesh").shape;
            let far = match shape.name.starts_with("gyroid") {
                true => stray(&mesh, 0.85, gyroid_far),
                false => stray(&mesh, 9.0, |p| own(&shape, p)),
            };
            (far, mesh.faces().len() as f64)
        };
        let n = if is_long() { 3_000 } else { 1_000 };
        let ((coarse, few), (fine, many)) = (of(n), of(4 * n));
        // Faces grow with the inverse square of the cells' size, so the error falls like one over their
        // number.
        let power = (coarse / fine).ln() / (many / few).ln();
        println!(
            "{}: {coarse:.3e} with {few} faces, {fine:.3e} with {many}: h^{:.2}",
            shape.name,
            2.0 * power
        );
        assert!((0.8..1.25).contains(&power), "{}: {power}", shape.name);
    }
}
