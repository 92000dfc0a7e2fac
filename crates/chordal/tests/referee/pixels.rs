//! Bounds in pixels against true projections, from random and from hostile eyes.
use super::eyes::{Eye, Lens, box_of, step_out};
use super::shapes::{Shape, shape};
use super::{for_all, is_long, library_patches, quantile};
use chordal::budget::camera::{Camera, MinDistanceView, Projection};
use chordal::budget::{Failure, Pixels, RefusalCode};
use chordal::{Bounded, Budget, Job, Mesh, View, convert};
use chordal_testkit::Random;
use chordal_testkit::sampler::{
    Foot, Point, Surface, Triangles, add, cross, distance, evaluate, measure, norm, scale, sub,
};

/// A point of one shape and the nearest one of the other, the furthest apart first.
pub fn pairs(shape: &Shape, made: &Bounded<Mesh>) -> Vec<[Point; 2]> {
    const GRID: usize = 40;
    let surface = Surface::new(vec![shape.control]);
    let mesh = Triangles::new(made.shape.positions(), made.shape.faces());
    let at_most = made.bound.at_most().expect("proved");
    let worst = measure(&surface, &mesh);
    let uv = |n: usize| [n % (GRID + 1), n / (GRID + 1)].map(|x| x as f64 / GRID as f64);
    let samples = (0..(GRID + 1) * (GRID + 1)).map(|n| evaluate(&shape.control, uv(n)));
    let mut guess = 0;
    let on_mesh = samples.chain([worst.surface_at]).map(|s| {
        guess = mesh.nearest(s, guess).1;
        [s, mesh.closest_point(s, guess)]
    });
    // Every triangle's middle, or a part of them where there are very many.
    let step = mesh.corners.len() / 2000 + 1;
    let middles = mesh.corners.iter().step_by(step).map(|[a, b, c]| scale(add(*a, add(*b, *c)), 1.0 / 3.0));
    let mut foot = None;
    // A foot further than the bound is either the accusation that is looked for, or not the nearest one.
    let nearest = |m: Point, guess: Option<Foot>| {
        let foot = surface.nearest(m, guess);
        if foot.distance > at_most { surface.proved_nearest(m, None, 1e-3) } else { Some(foot) }
    };
    let on_surface = middles.chain([worst.mesh_at]).filter_map(|m| {
        foot = nearest(m, foot);
        foot.map(|foot| [evaluate(&shape.control, foot.uv), m])
    });
    let mut all: Vec<_> = on_mesh.chain(on_surface).collect();
    all.sort_by(|[a, b], [c, d]| distance(*c, *d).total_cmp(&distance(*a, *b)));
    all
}

/// The furthest that any pair is apart on the picture of an eye.
pub fn furthest(eye: &Eye, pairs: &[[Point; 2]]) -> f64 {
    pairs.iter().map(|[s, m]| eye.apart(*s, *m)).fold(0.0, f64::max)
}

fn mesh_to_pixels(shape: &Shape, pixels: f64, view: View) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    let budget = Budget::pixels(Pixels::new(pixels).expect("positive"), view);
    convert::patches_to_mesh(&library_patches(&[shape.control]), &budget, &Job::default().with_threads(1))
}

/// The sampler's own rounding on the picture, in pixels: that of the coordinates, of the frame and of the
/// projection.
pub fn rounding(shape: &Shape, eye: &Eye, pixels: f64) -> f64 {
    let coordinates = super::length::rounding(&shape.control) / shape.size;
    let big = f64::from(eye.lens.screen.width_px.max(eye.lens.screen.height_px));
    // As a part of the picture: a shape that fills it, seen at up to 1/cos² of the corner, 20 at 120 degrees.
    1e-9 * pixels + 20.0 * coordinates * big
}

/// A direction in which a pair is seen across, or any direction where the two coincide.
fn across(pair: [Point; 2], r: &mut Random) -> Point {
    let any = r.direction();
    let side = cross(sub(pair[1], pair[0]), any);
    if norm(side) > 0.0 { scale(side, 1.0 / norm(side)) } else { any }
}

/// The worst of many eyes that keep `away` from the box, as a part of the bound.
fn worst_of_eyes(shape: &Shape, made: &Bounded<Mesh>, lens: Lens, away: f64) -> f64 {
    let r = &mut Random::new(shape.seed ^ 0xe7e5);
    let bounds = box_of(&[shape.control]);
    let pairs = pairs(shape, made);
    let promised = made.bound.pixels.expect("a view was given");
    let mut worst = 0.0_f64;
    for n in 0..90 {
        // A third look at random points, the others across the largest distances that there are.
        let pair =
            if n % 3 == 0 { pairs[r.below(pairs.len())] } else { pairs[r.below(8).min(pairs.len() - 1)] };
        let direction = if n % 3 == 0 { r.direction() } else { across(pair, r) };
        let at = step_out(&bounds, pair[0], direction, away);
        let eye = Eye::aimed(at, pair[0], lens, r);
        let seen = furthest(&eye, &pairs);
        assert!(
            seen <= promised + rounding(shape, &eye, promised),
            "{} (seed {}): {seen} px where {promised} were promised, {lens:?} from {at:?}",
            shape.kind,
            shape.seed
        );
        worst = worst.max(seen / promised);
    }
    worst
}

fn report(what: &str, mut worst: Vec<f64>) -> Vec<f64> {
    worst.sort_by(f64::total_cmp);
    let q = |f| quantile(&worst, f);
    eprintln!(
        "{what}: {} meshes, worst pixels/bound: least {:.3}, median {:.3}, 90 % {:.3}, most {:.3}",
        worst.len(),
        q(0.0),
        q(0.5),
        q(0.9),
        q(1.0)
    );
    worst
}

#[test]
fn no_eye_that_keeps_its_distance_sees_more_pixels_than_promised() {
    let n = if is_long() { 2000 } else { 28 };
    let worst = for_all(n, |seed| {
        let shape = shape(seed as u64);
        let r = &mut Random::new(seed as u64 + 7);
        let (lens, pixels) = (Lens::pinhole(r), [0.5, 1.0, 4.0][r.below(3)]);
        let away = shape.size * 10_f64.powf(r.between(-0.5, 1.0));
        let view = View::MinDistance(MinDistanceView {
            distance: away,
            projection: lens.projection,
            screen: lens.screen,
        });
        let made = mesh_to_pixels(&shape, pixels, view).expect("a distance is enough");
        assert!(made.bound.pixels.is_some_and(|p| p <= pixels), "{:?} for {pixels} px", made.bound);
        worst_of_eyes(&shape, &made, lens, away)
    });
    let worst = report("any eye", worst);
    // The test sees what it is for: some eyes come close to the bound.
    assert!(quantile(&worst, 0.9) > 0.3, "no eye came near the bound: the eyes are too kind");
}

/// A camera near the shape: in front of it, inside it, or grazing it; parallel rays now and then.
fn camera(shape: &Shape, r: &mut Random) -> (Camera, Eye) {
    let on = evaluate(&shape.control, [r.between(0.0, 1.0), r.between(0.0, 1.0)]);
    let at = add(on, scale(r.direction(), shape.size * 10_f64.powf(r.between(-0.7, 0.7))));
    let mut lens = Lens::pinhole(r);
    if r.below(5) == 0 {
        lens.projection = Projection::Orthographic { height: shape.size * r.between(0.1, 3.0) };
    }
    let mut eye = Eye::aimed(at, on, lens, r);
    eye.near = [0.0, 0.03, 0.2][r.below(3)] * shape.size;
    (camera_of(&eye, shape.size), eye)
}

/// The library's camera where an eye is.
pub fn camera_of(eye: &Eye, size: f64) -> Camera {
    Camera {
        eye: eye.at,
        target: add(eye.at, scale(eye.axes[2], size)),
        up: eye.axes[1],
        near: eye.near,
        projection: eye.lens.projection,
        screen: eye.lens.screen,
    }
}

#[test]
fn no_camera_sees_more_pixels_than_promised() {
    let n = if is_long() { 4000 } else { 28 };
    let worst = for_all(n, |seed| {
        let shape = shape(seed as u64);
        let r = &mut Random::new(seed as u64 + 99);
        let ((camera, eye), pixels) = (camera(&shape, r), [0.5, 1.0, 4.0][r.below(3)]);
        let made = match mesh_to_pixels(&shape, pixels, View::Camera(camera)) {
            Ok(made) => made,
            Err(Failure::Refused(why)) if why.code == RefusalCode::TooClose => return None,
            Err(other) => panic!("{other}"),
        };
        let promised = made.bound.pixels.expect("a view was given");
        assert!(promised <= pixels, "{promised} for {pixels} px");
        let seen = furthest(&eye, &pairs(&shape, &made));
        assert!(
            seen <= promised + rounding(&shape, &eye, promised),
            "{} (seed {seed}): {seen} px where {promised} were promised, {camera:?}",
            shape.kind
        );
        Some(if promised > 0.0 { seen / promised } else { 0.0 })
    });
    let seen: Vec<f64> = worst.iter().flatten().copied().collect();
    assert!(2 * seen.len() > n, "only {} of {n} cameras got a mesh", seen.len());
    report("one camera", seen);
}

#[test]
fn pixel_bounds_cut_by_30_percent_are_caught() {
    // Far off and across the largest distance the pixels are nearly F·ε/z, so what is left is how tight the
    // length is.
    let n = if is_long() { 140 } else { 28 };
    let worst = for_all(n, |seed| {
        let shape = shape(seed as u64);
        let r = &mut Random::new(seed as u64);
        let made = super::mesh_within(&[shape.control], 1e-3 * shape.size);
        let pairs = pairs(&shape, &made);
        let mut lens = Lens::pinhole(r);
        lens.projection = Projection::Perspective { fov_y_deg: 5.0 };
        let at = add(pairs[0][0], scale(across(pairs[0], r), 30.0 * shape.size));
        let eye = Eye::aimed(at, pairs[0][0], lens, r);
        let view = View::Camera(Camera {
            eye: at,
            target: add(at, scale(eye.axes[2], shape.size)),
            up: eye.axes[1],
            near: 0.0,
            projection: lens.projection,
            screen: lens.screen,
        });
        let [low, high] = box_of(&[shape.control]);
        let place = chordal::math::Box3 { min: low, max: high };
        let promised = view.pixels_of(made.bound.at_most().expect("proved"), &place).expect("far enough");
        let seen = furthest(&eye, &pairs);
        assert!(seen <= promised + rounding(&shape, &eye, promised), "{} (seed {seed})", shape.kind);
        seen / promised
    });
    let worst = report("across and far", worst);
    let caught = worst.iter().filter(|part| **part > 0.7).count();
    assert!(4 * caught > n, "only {caught} of {n} cut bounds were caught");
}
