//! Bounds in pixels, through cameras of the referee's own.
use super::chains::chain;
use super::families::shape;
use super::measure::distance;
use super::truth::Path;
use super::{cases, flatten, for_all, quantile};
use chordal::budget::camera::{Camera, MinDistanceView, Projection, Screen};
use chordal::budget::{Pixels, RefusalCode};
use chordal::convert::Spacing;
use chordal::{Bounded, Budget, Failure, View};
use chordal_testkit::Random;
use chordal_testkit::sampler::{cross, dot};

type Point = [f64; 3];

fn plus(a: Point, by: f64, b: Point) -> Point {
    std::array::from_fn(|k| a[k] + by * b[k])
}

fn unit(a: Point) -> Point {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

/// An eye with its picture.
struct Eye {
    at: Point,
    /// Right, up, forward.
    axes: [Point; 3],
    half: [f64; 2],
    /// Pixels for one unit of `X/z`, or of length with parallel rays.
    focal: f64,
    parallel: bool,
    near: f64,
}

impl Eye {
    fn new([at, target, up]: [Point; 3], projection: Projection, screen: Screen, near: f64) -> Self {
        let forward = unit(plus(target, -1.0, at));
        let right = unit(cross(forward, up));
        let half = [f64::from(screen.width_px) / 2.0, f64::from(screen.height_px) / 2.0];
        let (focal, parallel) = match projection {
            Projection::Perspective { fov_y_deg } => (half[1] / (fov_y_deg.to_radians() / 2.0).tan(), false),
            Projection::Orthographic { height } => (2.0 * half[1] / height, true),
        };
        Self { at, axes: [right, cross(right, forward), forward], half, focal, parallel, near }
    }

    fn project(&self, p: Point) -> Option<[f64; 2]> {
        let [x, y, z] = self.axes.map(|axis| dot(plus(p, -1.0, self.at), axis));
        match self.parallel {
            true => Some([self.focal * x, self.focal * y]),
            false => (z > 0.0).then(|| [self.focal * x / z, self.focal * y / z]),
        }
    }

    fn sees(&self, p: Point) -> bool {
        let inside = |[x, y]: [f64; 2]| x.abs() <= self.half[0] && y.abs() <= self.half[1];
        dot(plus(p, -1.0, self.at), self.axes[2]) >= self.near && self.project(p).is_some_and(inside)
    }

    /// How far two points are apart on the picture, if one of them is on it.
    fn apart(&self, a: Point, b: Point) -> f64 {
        if !self.sees(a) && !self.sees(b) {
            return 0.0;
        }
        match (self.project(a), self.project(b)) {
            (Some([ax, ay]), Some([bx, by])) => ((ax - bx).powi(2) + (ay - by).powi(2)).sqrt(),
            _ => f64::INFINITY,
        }
    }
}

/// Points of the path with the nearest of the polyline, those that are farthest apart first.
fn pairs(path: &Path<3>, made: &chordal::explicit::Polyline<3>) -> Vec<[Point; 2]> {
    let nearest = |p: Point| {
        let on = made.segments().map(|[a, b]| {
            let along = plus(b, -1.0, a);
            let t = (dot(plus(p, -1.0, a), along) / dot(along, along)).clamp(0.0, 1.0);
            plus(a, t, along)
        });
        on.min_by(|a, b| distance(p, *a).total_cmp(&distance(p, *b))).unwrap_or(made.points[0])
    };
    let end = path.parts.len() as f64;
    let mut found = Vec::new();
    for (i, from) in made.places.iter().enumerate() {
        let to = made.places.get(i + 1).copied().unwrap_or(end);
        for f in [0.2, 0.35, 0.5, 0.65, 0.8] {
            let place: f64 = from + f * (to - from);
            let part = (place.floor() as usize).min(path.parts.len() - 1);
            let p = path.parts[part].at(place - part as f64);
            found.push([p, nearest(p)]);
        }
    }
    found
}

fn path(seed: usize) -> Path<3> {
    if seed.is_multiple_of(3) { chain(seed) } else { Path::cubic(shape::<3>(seed).control) }
}

fn lens(r: &mut Random, size: f64) -> (Projection, Screen) {
    let (width_px, height_px) = [(1920, 1080), (640, 480), (300, 900), (1000, 1000)][r.below(4)];
    let projection = match r.below(5) {
        0 => Projection::Orthographic { height: size * r.between(0.1, 3.0) },
        _ => Projection::Perspective { fov_y_deg: r.between(5.0, 120.0) },
    };
    (projection, Screen { width_px, height_px })
}

/// The polyline, if the eye is not too close.
fn to_pixels(path: &Path<3>, pixels: f64, view: View) -> Option<Bounded<chordal::explicit::Polyline<3>>> {
    let budget = Budget::pixels(Pixels::new(pixels).expect("positive"), view);
    match flatten(path, &budget, Spacing::Fewest) {
        Ok(made) => Some(made),
        Err(Failure::Refused(why))
            if [RefusalCode::TooClose, RefusalCode::TooManyTriangles, RefusalCode::BelowPrecision]
                .contains(&why.code) =>
        {
            None
        }
        Err(failure) => panic!("{failure}"),
    }
}

/// Checks what an eye sees of a polyline; the share of the bound that it sees.
fn check(name: &str, eye: &Eye, pairs: &[[Point; 2]], promised: f64) -> f64 {
    let seen = pairs.iter().map(|[a, b]| eye.apart(*a, *b)).fold(0.0, f64::max);
    // Coordinates are rounded relative to their size, which the projection magnifies.
    assert!(seen <= promised * (1.0 + 1e-6) + 1e-6, "{name}: {seen} px where {promised} were promised");
    if promised > 0.0 { seen / promised } else { 0.0 }
}

fn report(what: &str, mut shares: Vec<f64>) -> f64 {
    let [median, high, most] = [0.5, 0.9, 1.0].map(|q| quantile(&mut shares, q));
    eprintln!(
        "{what}: seen/promised of {}: median {median:.3}, 90 % {high:.3}, most {most:.4}",
        shares.len()
    );
    most
}

#[test]
fn no_camera_sees_more_pixels_than_promised() {
    let shares = for_all(cases(900), |seed| {
        let path = path(seed);
        let size = path.size();
        if size == 0.0 {
            return None;
        }
        let r = &mut Random::new(seed as u64 + 5);
        let (projection, screen) = lens(r, size);
        let on = path.parts[0].at(r.between(0.0, 1.0));
        let eye = plus(on, size * r.power(-0.7, 1.5), r.direction());
        let target = plus(on, size * r.between(0.0, 0.2), r.direction());
        let (up, near) = (r.direction(), [0.0, 0.03, 0.2][r.below(3)] * size);
        let camera = Camera { eye, target, up, near, projection, screen };
        let pixels = [0.25, 0.5, 1.0, 4.0][r.below(4)];
        let made = to_pixels(&path, pixels, View::Camera(camera))?;
        let promised = made.bound.pixels.expect("a view was given");
        assert!(promised <= pixels, "{promised} for {pixels} px");
        let seen_by = Eye::new([eye, target, up], projection, screen, near);
        Some(check(&format!("seed {seed}, {camera:?}"), &seen_by, &pairs(&path, &made.shape), promised))
    });
    let shares: Vec<f64> = shares.into_iter().flatten().collect();
    assert!(shares.len() > 300, "only {} cameras got a polyline", shares.len());
    let most = report("one camera", shares);
    assert!(most > 0.9, "no camera came near the bound: they are too kind");
}

#[test]
fn no_eye_that_keeps_its_distance_sees_more_pixels_than_promised() {
    let shares = for_all(cases(300), |seed| {
        let path = path(seed);
        let size = path.size();
        if size == 0.0 {
            return Vec::new();
        }
        let r = &mut Random::new(seed as u64 + 6);
        let ((projection, screen), away) = (lens(r, size), size * r.power(-0.5, 1.5));
        let pixels = [0.25, 1.0, 4.0][r.below(3)];
        let closest = MinDistanceView { distance: away, projection, screen };
        let Some(made) = to_pixels(&path, pixels, View::MinDistance(closest)) else { return Vec::new() };
        let promised = made.bound.pixels.expect("a view was given");
        assert!(promised <= pixels, "{promised} for {pixels} px");
        let pairs = pairs(&path, &made.shape);
        let [low, high] = path.bounds();
        let outside = |p: Point| {
            let off =
                (0..3).map(|k| (low[k] - p[k]).max(p[k] - high[k]).max(0.0).powi(2)).sum::<f64>().sqrt();
            off >= away
        };
        let mut found = Vec::new();
        for _ in 0..60 {
            let on = pairs[r.below(pairs.len())][0];
            let mut step = r.power(-1.0, 1.0) * away;
            let direction = r.direction();
            while !outside(plus(on, step, direction)) {
                step *= 1.02;
            }
            let eye = plus(on, step, direction);
            // Looking past the place, so that it is anywhere on the picture.
            let target = plus(on, step * r.between(0.0, 1.0), r.direction());
            let seen_by = Eye::new([eye, target, r.direction()], projection, screen, 0.0);
            found.push(check(&format!("seed {seed}, {closest:?} from {eye:?}"), &seen_by, &pairs, promised));
        }
        found
    });
    let most = report("any eye", shares.into_iter().flatten().collect());
    assert!(most > 0.5, "no eye came near the bound: they are too kind");
}
