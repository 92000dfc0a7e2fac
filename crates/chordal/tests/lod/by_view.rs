//! Pixels at a camera: what is far away may lose more, and on the screen nothing moves farther than promised.
use super::sampler::{FIXED, triangles};
use super::{length, made, n_faces, shapes};
use chordal::budget::camera::{Camera, Projection};
use chordal::budget::{RefusalCode, View};
use chordal::explicit::Topology;
use chordal::lod::{SimplifiedMesh, simplify};
use chordal::{Bounded, Budget, Failure, Job, Mesh};
use chordal_testkit::sampler::{Point, closest_weights, cross, dot, norm, on, sub};
use chordal_testkit::{Random, is_long, some};

fn pixels(pixels: &str, view: &str) -> Budget {
    Budget::pixels(pixels.parse().expect("pixels"), view.parse().expect("a view"))
}

fn camera(budget: &Budget) -> Camera {
    match budget.pixels.expect("pixels").view {
        View::Camera(camera) => camera,
        View::MinDistance(_) => panic!("a camera"),
    }
}

/// Hills along the x axis, from 2 to 3000 before the origin and below it, in cells that grow with the
/// distance, but not as much as a pixel does.
fn valley([n, m]: [u32; 2]) -> Mesh {
    let at = |i: u32, j: u32| {
        let share = f64::from(i) / f64::from(n);
        let (x, y) = (2.0 + 2998.0 * share * share, 100.0 * (f64::from(j) / f64::from(m) - 0.5));
        let hill = (0.11 * y + 0.02 * x).sin() + (0.07 * y - 0.05 * x).cos() * (0.01 * x).sin();
        [x, y, 0.5 * hill - 2.0]
    };
    let positions = (0..=n).flat_map(|i| (0..=m).map(move |j| at(i, j))).collect();
    let faces = (0..n).flat_map(|i| {
        (0..m).flat_map(move |j| {
            let a = i * (m + 1) + j;
            let b = a + m + 1;
            [[a, b, b + 1], [a, b + 1, a + 1]]
        })
    });
    Mesh::new(positions, faces.collect()).expect("a mesh")
}

/// Where a camera draws points, by plain arithmetic.
struct Screen {
    camera: Camera,
    axes: [Point; 3],
    focal: f64,
}

impl Screen {
    fn new(camera: Camera) -> Self {
        let unit = |v: Point| v.map(|x| x / norm(v));
        let forward = unit(sub(camera.target, camera.eye));
        let right = unit(cross(forward, camera.up));
        let h = f64::from(camera.screen.height_px);
        let focal = match camera.projection {
            Projection::Perspective { fov_y_deg } => 0.5 * h / (0.5 * fov_y_deg.to_radians()).tan(),
            Projection::Orthographic { height } => h / height,
        };
        Self { camera, axes: [right, cross(right, forward), forward], focal }
    }

    /// Right, up and depth: the first two in pixels from the middle. Nothing where the point is not before
    /// the eye.
    fn at(&self, p: Point) -> Option<Point> {
        let [x, y, z] = self.axes.map(|axis| dot(axis, sub(p, self.camera.eye)));
        let scale = match self.camera.projection {
            Projection::Perspective { .. } => self.focal / z,
            Projection::Orthographic { .. } => self.focal,
        };
        (z > 0.0).then_some([x * scale, y * scale, z])
    }

    fn shows(&self, p: Option<Point>) -> bool {
        let size = [self.camera.screen.width_px, self.camera.screen.height_px].map(|n| 0.5 * f64::from(n));
        p.is_some_and(|[x, y, z]| z >= self.camera.near && x.abs() <= size[0] && y.abs() <= size[1])
    }

    /// How far a point moves on the screen; 0 where neither end is there.
    fn moved(&self, p: Point, q: Point) -> f64 {
        let (a, b) = (self.at(p), self.at(q));
        if !self.shows(a) && !self.shows(b) {
            return 0.0;
        }
        a.zip(b).map_or(f64::INFINITY, |(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]))
    }
}

/// The farthest that a point of one surface is on the screen from the nearest point of the other, with how
/// many were seen.
fn one_way(from: &Mesh, to: &Mesh, screen: &Screen, random: &mut Random) -> (f64, usize) {
    let tree = triangles(to);
    let (mut most, mut n_seen) = (0.0_f64, 0);
    for face in 0..from.faces().len() {
        let t = from.corners(face);
        let more: Vec<_> = (0..if is_long() { 200_000 } else { 50_000 } / from.faces().len() + 4)
            .map(|_| random.weights())
            .collect();
        for w in FIXED.into_iter().chain(more) {
            let p = on(t, w);
            let other = to.corners(tree.nearest(p, 0).1);
            let q = on(other, closest_weights(p, other));
            n_seen += usize::from(screen.shows(screen.at(p)));
            most = most.max(screen.moved(p, q));
        }
    }
    (most, n_seen)
}

/// What the arithmetic of the referee may be off by, as a share: a thousand roundings.
const SLACK: f64 = 1e-12;

/// Holds what came out against the mesh; how much of the promise is used.
fn holds(name: &str, mesh: &Mesh, budget: &Budget, made: &Bounded<SimplifiedMesh>) -> f64 {
    let screen = Screen::new(camera(budget));
    let most = budget.pixels.expect("pixels").pixels.get();
    let proved = made.bound.pixels.expect("proved");
    assert!(proved <= most, "{name}: {proved} pixels were proved, {most} are allowed");
    let mut random = Random::new(7);
    let (there, n_there) = one_way(mesh, &made.shape.mesh, &screen, &mut random);
    let (back, n_back) = one_way(&made.shape.mesh, mesh, &screen, &mut random);
    let seen = there.max(back);
    eprintln!(
        "{name}: {seen:.3} px seen at {n_there} and {n_back} points, {proved:.3} proved, {most} allowed"
    );
    assert!(n_there > 100 && n_back > 100, "{name}: nothing is on the screen");
    assert!(seen <= proved * (1.0 + SLACK) + SLACK, "{name}: {seen} pixels were seen, {proved} proved");
    assert!(seen > 0.0, "{name}: nothing was lost");
    seen / most
}

#[test]
fn spends_more_of_a_length_where_a_pixel_is_more() {
    let mesh = valley([240, 40]);
    let views = [
        ("1px", "1920x1080 fov=45 eye=0,0,0 target=100,0,-1"),
        ("0.5px", "800x600 fov=70 eye=-80,3,2 target=100,30,-1"),
        ("4px", "1000x1000 fov=30 eye=0,0,3 target=3000,0,0"),
    ];
    for (most, view) in some(views, 1) {
        let budget = pixels(most, view);
        let by_view = made(&mesh, &budget);
        let everywhere = budget.length_in(&mesh.bounds()).expect("nothing is too close");
        let worst = made(&mesh, &length(everywhere));
        eprintln!(
            "{} triangles, {} by view, {} alike",
            mesh.faces().len(),
            n_faces(&by_view),
            n_faces(&worst)
        );
        assert!(3 * n_faces(&by_view) < n_faces(&worst), "{} are not few", n_faces(&by_view));
        let used = holds(view, &mesh, &budget, &by_view);
        assert!(used > 0.3, "only {used} of the pixels were used");
        // A length that is the least everywhere would not lose so much.
        assert!(by_view.bound.at_least() > 10.0 * everywhere);
    }
}

#[test]
fn the_referee_sees_what_is_too_far() {
    let mesh = valley([60, 10]);
    let budget = pixels("1px", "1920x1080 fov=45 eye=0,0,0 target=100,0,-1");
    let screen = Screen::new(camera(&budget));
    let coarse = made(&mesh, &length(0.5)).shape.mesh;
    let mut random = Random::new(8);
    assert!(one_way(&mesh, &coarse, &screen, &mut random).0 > 5.0);
    assert!(one_way(&coarse, &mesh, &screen, &mut random).0 > 5.0);
}

#[test]
fn stays_as_it_is_only_where_the_eye_is_too_close() {
    // Around the eye, and far to its sides: inside of a sphere, and above a field.
    let ground = shapes::heights([60, 60], 0.002);
    let bounds = ground.bounds();
    let [x, y, _] = bounds.centre();
    let above = bounds.max[2] + 0.01 * (bounds.max[0] - bounds.min[0]);
    let over = format!("640x480 fov=60 eye={x},{y},{above} target={},{y},{above}", bounds.max[0]);
    let corner = ground.positions()[ground.faces()[3000][0] as usize];
    let on = format!("640x480 fov=60 eye={},{},{} target={x},{y},{above}", corner[0], corner[1], corner[2]);
    let inside = "640x480 fov=60 eye=0.1,0,0 target=1,0.2,0.1".to_owned();
    for (name, mesh, view) in
        [("inside", shapes::sphere(5), inside), ("over", ground.clone(), over), ("on", ground, on)]
    {
        let budget = pixels("1px", &view);
        assert_eq!(budget.length_in(&mesh.bounds()), None, "{name}: the box reaches the eye");
        let made = made(&mesh, &budget);
        eprintln!("{name}: {} triangles of {}", n_faces(&made), mesh.faces().len());
        assert!(5 * n_faces(&made) < 4 * mesh.faces().len(), "{name}: {} are left", n_faces(&made));
        holds(name, &mesh, &budget, &made);
    }
}

#[test]
fn refuses_where_the_eye_is_too_close_to_everything() {
    let mesh =
        Mesh::new(vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
    let budget = pixels("1px", "640x480 fov=60 eye=0,0,0 target=1,0,0");
    let refused = simplify(&mesh, &budget, Topology::Positions, &Job::default());
    assert!(matches!(refused, Err(Failure::Refused(refusal)) if refusal.code == RefusalCode::TooClose));
}

#[test]
fn length_and_pixels_hold_together() {
    let mesh = valley([120, 20]);
    let by_pixels = pixels("1px", "1920x1080 fov=45 eye=0,0,0 target=100,0,-1");
    let both = Budget { length: length(0.2).length, ..by_pixels };
    let (free, kept) = (made(&mesh, &by_pixels), made(&mesh, &both));
    assert!(free.bound.at_least() > 0.2, "{}", free.bound);
    assert!(kept.bound.at_most().expect("proved") <= 0.2, "{}", kept.bound);
    assert!(n_faces(&kept) > n_faces(&free));
    holds("both", &mesh, &both, &kept);
    // Neither limit alone would do.
    assert!(n_faces(&kept) > n_faces(&made(&mesh, &length(0.2))));
}

#[test]
fn an_eye_anywhere_and_parallel_rays_are_a_length_for_all() {
    let mesh = shapes::torus([60, 30], 0.1);
    for view in ["640x480 fov=60 dist=3", "640x480 height=4", "640x480 height=4 eye=0,0,9 target=0,0,0"] {
        let budget = pixels("1px", view);
        let everywhere = budget.length_in(&mesh.bounds()).expect("a length");
        let (by_view, by_length) = (made(&mesh, &budget), made(&mesh, &length(everywhere)));
        assert_eq!(by_view.shape.mesh, by_length.shape.mesh, "{view}");
        // One bound may come from a search and the other from a map, and both are proved.
        let [a, b] = [&by_view, &by_length].map(|made| made.bound.at_most().expect("proved"));
        assert!(a <= 1.1 * b && b <= 1.1 * a, "{view}: {a} and {b}");
        let proved = by_view.bound.pixels.expect("proved");
        assert!(proved <= 1.0 && proved > 0.5, "{view}: {proved}");
    }
}

#[test]
fn threads_change_nothing() {
    let mesh = valley([60, 20]);
    let budget = pixels("1px", "1920x1080 fov=45 eye=0,0,0 target=100,0,-1");
    let one = super::made_on(&mesh, &budget, &Job::default().with_threads(1));
    assert_eq!(one, super::made_on(&mesh, &budget, &Job::default().with_threads(3)));
}

#[test]
fn holds_far_from_the_origin_and_at_every_size() {
    let near = valley([60, 12]);
    for (scale, offset) in [(1e-6, [0.0; 3]), (1e9, [0.0; 3]), (1.0, [1e5, -3e5, 7e4])] {
        let to = |p: Point| -> Point { std::array::from_fn(|k| scale * p[k] + offset[k]) };
        let mesh =
            Mesh::new(near.positions().iter().map(|p| to(*p)).collect(), near.faces().to_vec()).unwrap();
        let (eye, target) = (to([0.0; 3]), to([100.0, 0.0, -1.0]));
        let point = |p: Point| format!("{},{},{}", p[0], p[1], p[2]);
        let view = format!("1920x1080 fov=45 eye={} target={}", point(eye), point(target));
        let budget = pixels("1px", &view);
        let made = made(&mesh, &budget);
        assert!(2 * n_faces(&made) < mesh.faces().len(), "{scale}: {} are left", n_faces(&made));
        holds(&view, &mesh, &budget, &made);
    }
}
