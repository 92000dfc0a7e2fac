//! Laws of `View`, `Lens` and `Sight`, judged by a projection that is written here and shares nothing with
//! them: no visible point moves on the screen by more than the bound says.
use chordal::View;
use chordal::budget::Pixels;
use chordal::budget::camera::{Camera, MinDistanceView, Projection, Screen};
use chordal::math::Box3;
use chordal_testkit::Random;
use glam::DVec3;

/// Evenly by magnitude.
fn magnitude(random: &mut Random, low: f64, high: f64) -> f64 {
    random.between(low.ln(), high.ln()).exp()
}

fn one_of<const N: usize>(random: &mut Random, choices: [f64; N]) -> f64 {
    choices[random.below(N)]
}

fn direction(random: &mut Random) -> DVec3 {
    random.direction().into()
}

fn screen(random: &mut Random) -> Screen {
    let [width_px, height_px] = [[1920, 1080], [512, 512], [300, 2000], [3840, 800]][random.below(4)];
    Screen { width_px, height_px }
}

/// The test's own eye: axes, and what they make of two nearby points.
struct Referee {
    eye: DVec3,
    axes: [DVec3; 3],
    near: f64,
    projection: Projection,
    half: [f64; 2],
}

impl Referee {
    fn new(
        eye: DVec3,
        [forward, up]: [DVec3; 2],
        near: f64,
        (projection, screen): (Projection, Screen),
    ) -> Self {
        // Twice, because the first product is all rounding where up is close to forward.
        let right = forward.cross(up).normalize();
        let right = (right - forward * right.dot(forward)).normalize();
        let half = [f64::from(screen.width_px) / 2.0, f64::from(screen.height_px) / 2.0];
        Self { eye, axes: [right, right.cross(forward).normalize(), forward], near, projection, half }
    }

    /// Pixels per unit of `X/z` or of length.
    fn focal(&self) -> f64 {
        match self.projection {
            Projection::Perspective { fov_y_deg } => self.half[1] / (fov_y_deg.to_radians() / 2.0).tan(),
            Projection::Orthographic { height } => 2.0 * self.half[1] / height,
        }
    }

    /// In camera coordinates.
    fn seen_from(&self, offset: DVec3) -> DVec3 {
        let [right, up, forward] = self.axes;
        DVec3::new(offset.dot(right), offset.dot(up), offset.dot(forward))
    }

    /// The point at these fractions of the half screen and this depth.
    fn place(&self, across: [f64; 2], depth: f64) -> DVec3 {
        let reach = match self.projection {
            Projection::Perspective { .. } => depth / self.focal(),
            Projection::Orthographic { .. } => 1.0 / self.focal(),
        };
        let [right, up, forward] = self.axes;
        self.eye
            + right * (across[0] * self.half[0] * reach)
            + up * (across[1] * self.half[1] * reach)
            + forward * depth
    }

    fn sees(&self, p: DVec3) -> bool {
        let reach = match self.projection {
            Projection::Perspective { .. } => p.z / self.focal(),
            Projection::Orthographic { .. } => 1.0 / self.focal(),
        };
        p.z > 0.0
            && p.z >= self.near
            && p.x.abs() <= self.half[0] * reach
            && p.y.abs() <= self.half[1] * reach
    }

    /// How far `moved` takes the point on the screen, less what this function's own rounding may add; `None`
    /// when neither the point nor the moved one is seen.
    fn pixels(&self, point: DVec3, moved: DVec3) -> Option<f64> {
        let (p, d) = (self.seen_from(point - self.eye), self.seen_from(moved));
        let q = p + d;
        if !(self.sees(p) || self.sees(q)) {
            return None;
        }
        if let Projection::Orthographic { .. } = self.projection {
            return Some(d.truncate().length() * self.focal() * (1.0 - 1e-14));
        }
        if p.z <= 0.0 || q.z <= 0.0 {
            return Some(f64::INFINITY);
        }
        // Without the cancellation of X/z − X'/z'.
        let apart = (d.truncate() * p.z - p.truncate() * d.z).length() / (p.z * q.z);
        // The depths are uncertain by a few roundings of the distance.
        let rounding = 32.0 * f64::EPSILON * (p.length() / p.z + q.length() / q.z);
        Some(apart * self.focal() * (1.0 - rounding))
    }

    /// The worst of many displacements of length `error`, in pixels: around the plane of the point and the
    /// axis, where the worst lies, across it, and anywhere.
    fn worst(&self, point: DVec3, error: f64, random: &mut Random) -> f64 {
        let p = self.seen_from(point - self.eye);
        let [right, up, forward] = self.axes;
        let out = p.truncate().normalize_or(glam::DVec2::X);
        let out = right * out.x + up * out.y;
        let steepest = (p.truncate().length() / p.z).atan();
        let turned = |angle: f64| out * angle.cos() - forward * angle.sin();
        let mut directions =
            vec![turned(steepest), -turned(steepest), -forward, out, -out, out.cross(forward)];
        // The exact worst is where the ray touches the ball of the error.
        let touch = (error / p.length()).clamp(0.0, 1.0).asin();
        directions.extend([turned(steepest + touch), -turned(steepest - touch)]);
        directions.extend((0..6).map(|_| turned(random.between(0.0, std::f64::consts::TAU))));
        directions.extend((0..6).map(|_| direction(random)));
        let lengths = [1.0, random.between(0.0, 1.0)];
        let moves = directions.iter().flat_map(|d| lengths.map(|l| *d * (error * l * (1.0 - f64::EPSILON))));
        moves.filter_map(|moved| self.pixels(point, moved)).fold(0.0, f64::max)
    }
}

fn projection(random: &mut Random) -> Projection {
    if random.below(4) == 0 {
        Projection::Orthographic { height: magnitude(random, 0.1, 100.0) }
    } else {
        let free = random.between(5.0, 170.0);
        Projection::Perspective { fov_y_deg: one_of(random, [free, 1.0, 45.0, 60.0, 90.0, 178.0]) }
    }
}

/// A camera at any scale and place, its up sometimes nearly along the line of sight.
fn camera(random: &mut Random) -> (View, Referee, f64) {
    let scale = one_of(random, [1e-6, 1e-3, 1.0, 1.0, 1e3, 1e6]);
    let far_off = one_of(random, [0.0, 0.0, 1.0, 1e4]);
    let eye = direction(random) * (scale * far_off);
    let forward = direction(random);
    let lean = one_of(random, [1.0, 1.0, 1e-4, 1e-9]);
    let up = forward + direction(random) * lean;
    let target = eye + forward * (scale * magnitude(random, 0.1, 10.0));
    let forward = (target - eye).normalize();
    let near = one_of(random, [0.0, 0.1, 1.0]) * scale;
    let projection = match projection(random) {
        Projection::Orthographic { height } => Projection::Orthographic { height: height * scale },
        perspective => perspective,
    };
    let screen = screen(random);
    let camera = Camera { eye: eye.into(), target: target.into(), up: up.into(), near, projection, screen };
    let view = View::Camera(camera).checked().expect("a camera");
    (view, Referee::new(eye, [forward, up], near, (projection, screen)), scale)
}

/// A box that is seen, cut by the border or the near plane, around the eye, behind it, tiny, or large.
fn place(random: &mut Random, referee: &Referee, scale: f64) -> (Box3, Vec<[f64; 3]>) {
    let mut across = || {
        let free = random.between(-1.2, 1.2);
        one_of(random, [free, free, 1.0, -1.0, 0.0])
    };
    let across = [across(), across()];
    let free = scale * magnitude(random, 0.05, 50.0);
    let depth = one_of(random, [free, free, free, referee.near * 1.01, referee.near, -free]);
    let centre = referee.place(across, depth);
    let size = scale * one_of(random, [0.0, 1e-6, 1e-3, 0.1, 1.0]);
    let mut near_by = || (centre + direction(random) * (size * random.between(0.0, 1.0))).to_array();
    let mut points = vec![centre.to_array(), near_by(), near_by(), near_by()];
    let place = Box3::from_points(&points);
    let corner =
        |c: usize| std::array::from_fn(|k| if c >> k & 1 == 0 { place.min[k] } else { place.max[k] });
    points.extend((0..8).map(corner));
    (place, points)
}

#[test]
fn no_visible_point_of_a_camera_moves_further_than_the_bound() {
    let (mut tight, mut tested, mut refused) = (0.0_f64, 0_u64, 0_u64);
    for seed in 0..12_000 {
        let mut random = Random::new(seed);
        let (view, referee, scale) = camera(&mut random);
        let (place, points) = place(&mut random, &referee, scale);
        let error = scale * magnitude(&mut random, 1e-7, 1.0);
        let Some(bound) = view.pixels_of(error, &place) else {
            refused += 1;
            continue;
        };
        for point in points {
            assert!(place.contains(point));
            let worst = referee.worst(point.into(), error, &mut random);
            assert!(
                worst <= bound,
                "seed {seed}: {worst} px > {bound} px, {view}, {place:?}, error {error:e}"
            );
            tested += 1;
            tight = if bound > 0.0 { tight.max(worst / bound) } else { tight };
        }
    }
    eprintln!("camera: {tested} points, {refused} views refused, worst/bound {tight:.6}");
    assert!(tested > 100_000 && tight > 0.999, "{tested} {tight}");
}

#[test]
fn no_visible_point_of_any_eye_that_keeps_its_distance_moves_further_than_the_bound() {
    let (mut tight, mut tested) = (0.0_f64, 0_u64);
    for seed in 0..12_000 {
        let mut random = Random::new(seed);
        let scale = one_of(&mut random, [1e-6, 1.0, 1e6]);
        let projection = match projection(&mut random) {
            Projection::Orthographic { height } => Projection::Orthographic { height: height * scale },
            perspective => perspective,
        };
        let screen = screen(&mut random);
        let forward = direction(&mut random);
        let up = direction(&mut random);
        let referee = Referee::new(DVec3::ZERO, [forward, up], 0.0, (projection, screen));
        // On the screen, at its corner, or off it by no more than the error takes it back.
        let distance = scale * magnitude(&mut random, 0.1, 10.0);
        let error = distance * magnitude(&mut random, 1e-6, 1.0);
        let free = [random.between(-1.1, 1.1), random.between(-1.1, 1.1)];
        let off = 1.0 + random.between(-2.0, 4.0) * error / distance;
        let across = if random.below(4) == 0 { free } else { [off, one_of(&mut random, [off, -off])] };
        let ray = referee.place(across, 1.0).normalize();
        let closer = one_of(&mut random, [1.0, 1.0, 1.5]);
        let view =
            View::MinDistance(MinDistanceView { distance, projection, screen }).checked().expect("a view");
        let point = ray * (distance * closer * (1.0 + 4.0 * f64::EPSILON));
        let Some(bound) = view.pixels_of(error, &Box3::from_points(&[point.into()])) else { continue };
        let worst = referee.worst(point, error, &mut random);
        assert!(worst <= bound, "seed {seed}: {worst} px > {bound} px, {view}, at {point}, error {error:e}");
        tested += 1;
        tight = tight.max(worst / bound);
    }
    eprintln!("closest: {tested} points, worst/bound {tight:.6}");
    assert!(tested > 5_000 && tight > 0.999, "{tested} {tight}");
}

/// The ends of two steps are apart by at most what the pixels of both say, wherever the point between them
/// is; and by more than their sum where that point is off the screen.
#[test]
fn two_steps_are_no_more_than_both_together() {
    let (mut tested, mut beyond_the_sum) = (0_u64, 0_u64);
    for seed in 0..12_000 {
        let mut random = Random::new(seed);
        let (view, referee, scale) = camera(&mut random);
        let off = 1.0 + random.between(-1.0, 1.0) * magnitude(&mut random, 1e-6, 0.3);
        let across = [off, one_of(&mut random, [off, -off, 0.0])];
        let depth = one_of(&mut random, [1.0, 1.0, 1.01, 3.0])
            * if referee.near > 0.0 { referee.near } else { scale };
        let middle = referee.place(across, depth);
        let errors = [0, 1].map(|_| depth * magnitude(&mut random, 1e-6, 0.3));
        let p = referee.seen_from(middle - referee.eye);
        let [right, up, forward] = referee.axes;
        let out = p.truncate().normalize_or(glam::DVec2::X);
        let out = right * out.x + up * out.y;
        let mut directions = vec![out, -out, forward, -forward];
        directions.extend((0..6).map(|_| {
            let angle = random.between(0.0, std::f64::consts::TAU);
            out * angle.cos() - forward * angle.sin()
        }));
        for d in &directions {
            let first = middle + *d * errors[0];
            for e in &directions {
                let last = middle + *e * errors[1];
                // As far as they are apart after rounding.
                let apart = |p: DVec3| (p - middle).length() * (1.0 + 1e-14);
                let at = |points: &[DVec3]| {
                    Box3::from_points(&points.iter().map(|p| p.to_array()).collect::<Vec<_>>())
                };
                let steps = [
                    view.pixels_of(apart(first), &at(&[first, middle])),
                    view.pixels_of(apart(last), &at(&[middle, last])),
                ];
                let [Some(a), Some(b)] = steps else { continue };
                let Some(both) = view.pixels_of_two_steps(a, b) else { continue };
                let Some(apart) = referee.pixels(first, last - first) else { continue };
                assert!(apart <= both, "seed {seed}: {apart} px > {both} px of {a} and {b}, {view}");
                beyond_the_sum += u64::from(apart > a + b);
                tested += 1;
            }
        }
    }
    eprintln!("two steps: {tested} pairs, {beyond_the_sum} beyond the sum");
    assert!(tested > 100_000 && beyond_the_sum > 0, "{tested} {beyond_the_sum}");
}

#[test]
fn a_length_from_pixels_keeps_them_and_wastes_nothing() {
    let (mut found, mut none) = (0, 0);
    for seed in 0..20_000 {
        let mut random = Random::new(seed);
        let (camera, referee, scale) = camera(&mut random);
        let (place, _) = place(&mut random, &referee, scale);
        let (projection, screen) = (referee.projection, screen(&mut random));
        let closest = View::MinDistance(MinDistanceView { distance: scale, projection, screen });
        let pixels = Pixels::new(magnitude(&mut random, 1e-3, 1e3)).unwrap();
        for view in [camera, closest] {
            let sight = view.lens().scale_at(&place);
            let Some(length) = view.length_of(pixels, &place) else {
                none += 1;
                assert!(
                    sight.pixels_of(scale * 1e-30).is_none_or(|p| p > pixels.get()),
                    "seed {seed}: {view}"
                );
                continue;
            };
            found += 1;
            assert_eq!(sight.length_of(pixels), Some(length));
            let reached = view.pixels_of(length, &place).expect("a bound at the length that was given");
            assert!(reached <= pixels.get(), "seed {seed}: {reached} > {pixels}, {view}");
            let longer = view.pixels_of(length * (1.0 + 1e-12), &place);
            assert!(longer.is_none_or(|p| p > pixels.get()), "seed {seed}: {length} could be longer, {view}");
        }
    }
    assert!(found > 30_000 && none > 100, "{found} {none}");
}

#[test]
fn the_bound_grows_with_the_error() {
    for seed in 0..4_000 {
        let mut random = Random::new(seed);
        let (view, referee, scale) = camera(&mut random);
        let (place, _) = place(&mut random, &referee, scale);
        let sight = view.lens().scale_at(&place);
        let mut last = Some(0.0);
        for k in -20..20 {
            let bound = sight.pixels_of(scale * 2_f64.powi(k));
            let grows = match (last, bound) {
                (None, Some(_)) => false,
                (Some(last), Some(bound)) => last <= bound,
                _ => true,
            };
            assert!(grows, "seed {seed}: {last:?} then {bound:?}");
            last = bound;
        }
    }
}

#[test]
fn a_box_behind_the_near_plane_costs_nothing_until_the_error_reaches_it() {
    let view: View = "100x100 fov=90 eye=0,0,0 target=1,0,0 near=2".parse().unwrap();
    let place = Box3 { min: [0.5, -0.1, -0.1], max: [1.5, 0.1, 0.1] };
    assert_eq!(view.pixels_of(0.49, &place), Some(0.0));
    assert!(view.pixels_of(0.51, &place).unwrap() > 1.0);
    let length = view.length_of("1e-6px".parse().unwrap(), &place).unwrap();
    assert!(length > 0.4999 && length < 0.5, "{length}");
}

#[test]
fn there_is_no_bound_where_the_eye_can_touch() {
    let view: View = "100x100 fov=90 eye=0,0,0 target=1,0,0".parse().unwrap();
    let around_the_eye = Box3 { min: [-1.0; 3], max: [1.0; 3] };
    assert_eq!(view.pixels_of(1e-9, &around_the_eye), None);
    assert_eq!(view.length_of("1px".parse().unwrap(), &around_the_eye), None);
    assert_eq!(view.pixels_of(0.0, &around_the_eye), Some(0.0));
    // Too far off for f64, not a number, not a view: never taken for hidden or harmless.
    for far in [1e308, f64::INFINITY, f64::NAN] {
        let place = Box3 { min: [-far; 3], max: [far; 3] };
        assert_eq!(view.pixels_of(1.0, &place), None, "{far}");
    }
    let wide: View = "100x100 fov=179.99999999999997 dist=4".parse().unwrap();
    assert_eq!(wide.pixels_of(1e-9, &around_the_eye), None);
    let Ok(View::MinDistance(good)) = "100x100 fov=90 dist=4".parse::<View>() else { unreachable!() };
    for distance in [0.0, -1.0, f64::NAN] {
        assert_eq!(
            View::MinDistance(MinDistanceView { distance, ..good }).pixels_of(0.1, &around_the_eye),
            None
        );
    }
    let projection = Projection::Orthographic { height: -1.0 };
    assert_eq!(
        View::MinDistance(MinDistanceView { projection, ..good }).pixels_of(0.1, &around_the_eye),
        None
    );
    assert_eq!(View::MinDistance(good).pixels_of(f64::NAN, &around_the_eye), None);
}

#[test]
fn an_empty_place_shows_nothing() {
    let view: View = "100x100 fov=90 eye=0,0,0 target=1,0,0".parse().unwrap();
    assert_eq!(view.pixels_of(1e300, &Box3::EMPTY), Some(0.0));
    assert!(view.length_of("1px".parse().unwrap(), &Box3::EMPTY).unwrap() > 1e300);
}

#[test]
fn a_pose_at_any_scale_is_a_pose() {
    for scale in [1e-300, 1e-160, 1e-5, 1e150, 1e300] {
        let view = format!("100x100 fov=90 eye=0,0,0 target={scale},0,0").parse::<View>();
        assert!(view.is_ok(), "{scale}");
        let place = Box3 { min: [10.0; 3], max: [10.0; 3] };
        // At 45° twice: depth 10, tan² 2 (cut to the corner's 2), focal 50.
        let pixels = view.unwrap().pixels_of(0.001, &place).unwrap();
        assert!((pixels - 50.0 * 0.001 * 3_f64.sqrt() / 9.999).abs() < 1e-12, "{pixels}");
    }
}
