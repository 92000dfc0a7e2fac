//! Closed-form solids as triangles, against distances and points of their surfaces that are computed here.
use chordal::budget::{Failure, RequiredEvidence};
use chordal::check::findings::measure;
use chordal::check::{self_intersections, validity};
use chordal::convert::solids::{SolidMesher, judged_against_field};
use chordal::explicit::Topology;
use chordal::implicit::construction::{Construction, ConstructionNode};
use chordal::implicit::{Affine3, Field, shapes};
use chordal::{Bounded, Job, Mesh, Tolerance};
use chordal_testkit::Random;

type Point = [f64; 3];

fn sub(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn norm(a: Point) -> f64 {
    dot(a, a).sqrt()
}

fn mesh_of(construction: &Construction, field: &Field, length: f64) -> Option<Bounded<Mesh>> {
    let length = Tolerance::new(length).unwrap();
    match construction.node() {
        ConstructionNode::Solid(form) => SolidMesher { length, room: field.bounds() }.mesh(form),
        ConstructionNode::Placed(map, below) => {
            SolidMesher::placed(&mesh_of(below, field, length.get())?, map)
        }
        _ => None,
    }
}

fn mesh(field: &Field, length: f64) -> Bounded<Mesh> {
    mesh_of(field.construction().unwrap(), field, length).unwrap()
}

/// The distance of a point from a triangle: the nearest of its inside, sides and corners.
fn distance_to_triangle(p: Point, [a, b, c]: [Point; 3]) -> f64 {
    let to_side = |a: Point, b: Point| {
        let (along, to) = (sub(b, a), sub(p, a));
        let t = (dot(to, along) / dot(along, along)).clamp(0.0, 1.0);
        norm(sub(to, along.map(|x| t * x)))
    };
    let (u, v, w) = (sub(b, a), sub(c, a), sub(p, a));
    let (uu, uv, vv, wu, wv) = (dot(u, u), dot(u, v), dot(v, v), dot(w, u), dot(w, v));
    let det = uu * vv - uv * uv;
    let (s, t) = ((vv * wu - uv * wv) / det, (uu * wv - uv * wu) / det);
    let sides = [to_side(a, b), to_side(b, c), to_side(c, a)].into_iter().fold(f64::INFINITY, f64::min);
    if det > 0.0 && s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
        let inside = norm([0, 1, 2].map(|k| w[k] - s * u[k] - t * v[k]));
        return if inside < sides { inside } else { sides };
    }
    sides
}

/// The distance of a point of the plane from the segment between two others.
fn from_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (u, w) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let t = ((w[0] * u[0] + w[1] * u[1]) / (u[0] * u[0] + u[1] * u[1])).clamp(0.0, 1.0);
    (w[0] - t * u[0]).hypot(w[1] - t * u[1])
}

/// A shape with the distance of points from its surface, and points of it from three numbers between 0 and 1.
struct Referee {
    name: &'static str,
    field: Field,
    volume: f64,
    distance: PointDistance,
    at: SurfacePoint,
}

const PI: f64 = std::f64::consts::PI;

/// How far a point is from a surface.
type PointDistance = Box<dyn Fn(Point) -> f64>;
/// A point of a surface, by three numbers from 0 to 1.
type SurfacePoint = Box<dyn Fn(Point) -> Point>;

/// Points of the outline of a profile in the half-plane (radius, height), turned.
fn turned(outline: Vec<[f64; 2]>) -> (PointDistance, SurfacePoint) {
    let lines: Vec<[[f64; 2]; 2]> = outline.windows(2).map(|ends| [ends[0], ends[1]]).collect();
    let other = lines.clone();
    let distance = move |[x, y, z]: Point| {
        let p = [x.hypot(y), z];
        lines.iter().map(|[a, b]| from_segment(p, *a, *b)).fold(f64::INFINITY, f64::min)
    };
    let at = move |[s, t, u]: Point| {
        let [a, b] = other[(s * other.len() as f64) as usize % other.len()];
        let (r, z) = (a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]));
        [r * (2.0 * PI * u).cos(), r * (2.0 * PI * u).sin(), z]
    };
    (Box::new(distance), Box::new(at))
}

/// All points that far from a box.
fn around_box(half: Point, radius: f64) -> (PointDistance, SurfacePoint) {
    let distance = move |p: Point| {
        let q = [0, 1, 2].map(|k| p[k].abs() - half[k]);
        let inside = q[0].max(q[1]).max(q[2]).min(0.0);
        (norm(q.map(|x| x.max(0.0))) + inside - radius).abs()
    };
    let at = move |[s, t, u]: Point| {
        // A direction, and the box's point that is farthest in it or near to that.
        let z = 2.0 * s - 1.0;
        let r = (1.0 - z * z).max(0.0).sqrt();
        let towards = [r * (2.0 * PI * t).cos(), r * (2.0 * PI * t).sin(), z];
        let towards = match (u * 12.0) as usize {
            axis @ 0..=2 => [0, 1, 2].map(|k| if k == axis { 1.0 } else { 0.0 }),
            axis @ 3..=5 => {
                let flat = [0, 1, 2].map(|k| if k == axis - 3 { 0.0 } else { towards[k] });
                flat.map(|x| x / norm(flat))
            }
            _ => towards,
        };
        [0, 1, 2].map(|k| {
            let side = if towards[k] == 0.0 { 2.0 * [s, t, u][k] - 1.0 } else { towards[k].signum() };
            side * half[k] + radius * towards[k]
        })
    };
    (Box::new(distance), Box::new(at))
}

/// All points that far from a segment.
fn around_segment(a: Point, b: Point, radius: f64) -> (PointDistance, SurfacePoint) {
    let along = sub(b, a);
    let on = move |t: f64| [0, 1, 2].map(|k| a[k] + t * along[k]);
    let distance = move |p: Point| {
        let t = (dot(sub(p, a), along) / dot(along, along)).clamp(0.0, 1.0);
        (norm(sub(p, on(t))) - radius).abs()
    };
    let at = move |[s, t, u]: Point| {
        let z = 2.0 * s - 1.0;
        let r = (1.0 - z * z).max(0.0).sqrt();
        let towards = [r * (2.0 * PI * t).cos(), r * (2.0 * PI * t).sin(), z];
        let share = dot(towards, along) / dot(along, along);
        let (from, towards) = if u < 0.5 {
            // The end that is farther in that direction.
            (if share > 0.0 { b } else { a }, towards)
        } else {
            let across = [0, 1, 2].map(|k| towards[k] - share * along[k]);
            (on(2.0 * u - 1.0), across.map(|x| x / norm(across)))
        };
        [0, 1, 2].map(|k| from[k] + radius * towards[k])
    };
    (Box::new(distance), Box::new(at))
}

/// The rectangle of 4 by 2 at each height up to `half`, as many times as large and turned by as much as `section` says: how far
/// a point is from the outline at its height, which is no less than from the surface.
fn of_sections(
    half: f64,
    section: impl Fn(f64) -> (f64, f64) + Copy + 'static,
) -> (PointDistance, SurfacePoint) {
    let distance = move |[x, y, z]: Point| {
        let (scale, angle) = section(z.clamp(-half, half));
        let (c, s) = (angle.cos(), angle.sin());
        let q = [(c * x + s * y).abs() - 2.0 * scale, (c * y - s * x).abs() - scale, z.abs() - half];
        let inside = q[0].max(q[1]).max(q[2]).min(0.0);
        (norm(q.map(|x| x.max(0.0))) + inside).abs()
    };
    let at = move |[s, t, u]: Point| {
        let is_end = u < 0.25;
        let z = if is_end {
            if u < 0.125 { -half } else { half }
        } else {
            half * (2.0 * (u - 0.25) / 0.75 - 1.0)
        };
        let (scale, angle) = section(z);
        let [x, y] = match (is_end, (s * 4.0) as usize) {
            (true, _) => [4.0 * s - 2.0, 2.0 * t - 1.0],
            (false, 0) => [2.0, 2.0 * t - 1.0],
            (false, 1) => [-2.0, 2.0 * t - 1.0],
            (false, 2) => [4.0 * t - 2.0, 1.0],
            (false, _) => [4.0 * t - 2.0, -1.0],
        };
        let (c, s) = (angle.cos(), angle.sin());
        [scale * (c * x - s * y), scale * (s * x + c * y), z]
    };
    (Box::new(distance), Box::new(at))
}

fn referees() -> Vec<Referee> {
    let mut all = Vec::new();
    let mut add = |name, field: Field, volume, (distance, at)| {
        all.push(Referee { name, field, volume, distance, at });
    };
    add("box", shapes::cuboid([2.0, 3.0, 5.0]).unwrap(), 30.0, around_box([1.0, 1.5, 2.5], 0.0));
    add("ball", shapes::sphere(3.0).unwrap(), 36.0 * PI, around_box([0.0; 3], 3.0));
    let rounded = shapes::rounded_cuboid([4.0, 5.0, 6.0], 1.0).unwrap();
    let of_rounded = 24.0 + 2.0 * (6.0 + 8.0 + 12.0) + PI * (2.0 + 3.0 + 4.0) + 4.0 / 3.0 * PI;
    add("rounded box", rounded, of_rounded, around_box([1.0, 1.5, 2.0], 1.0));
    let capsule = shapes::capsule([0.0, 0.0, -2.0], [0.0, 0.0, 2.0], 1.5).unwrap();
    add("capsule", capsule, PI * 2.25 * (4.0 + 2.0), around_box([0.0, 0.0, 2.0], 1.5));
    let (a, b) = ([1.0, -2.0, 0.5], [3.0, 1.0, -1.0]);
    let slanted = shapes::capsule(a, b, 0.75).unwrap();
    let volume = PI * 0.5625 * (norm(sub(b, a)) + 1.0);
    add("slanted capsule", slanted, volume, around_segment(a, b, 0.75));
    let cylinder = shapes::cylinder(2.0, 6.0).unwrap();
    let outline = vec![[0.0, -3.0], [2.0, -3.0], [2.0, 3.0], [0.0, 3.0]];
    add("cylinder", cylinder, 24.0 * PI, turned(outline));
    let cone = shapes::capped_cone(2.0, 0.5, 4.0).unwrap();
    let outline = vec![[0.0, -2.0], [2.0, -2.0], [0.5, 2.0], [0.0, 2.0]];
    add("cone", cone, PI * 4.0 / 3.0 * (4.0 + 1.0 + 0.25), turned(outline));
    let tip = shapes::capped_cone(0.0, 2.0, 3.0).unwrap();
    add("cone with a tip", tip, PI * 4.0, turned(vec![[0.0, -1.5], [2.0, 1.5], [0.0, 1.5]]));
    let torus = shapes::torus(5.0, 1.0).unwrap();
    let distance = |[x, y, z]: Point| ((x.hypot(y) - 5.0).hypot(z) - 1.0).abs();
    let at = |[s, t, _]: Point| {
        let (a, b) = (2.0 * PI * s, 2.0 * PI * t);
        let r = 5.0 + b.cos();
        [r * a.cos(), r * a.sin(), b.sin()]
    };
    add("torus", torus, 10.0 * PI * PI, (Box::new(distance), Box::new(at)));
    let stadium = shapes::segment([-1.0, 0.0], [2.0, 0.0], 1.0).and_then(|flat| flat.extruded(2.0)).unwrap();
    let distance = |[x, y, z]: Point| {
        let d = from_segment([x, y], [-1.0, 0.0], [2.0, 0.0]) - 1.0;
        let q = [d, z.abs() - 1.0];
        (q[0].max(0.0).hypot(q[1].max(0.0)) + q[0].max(q[1]).min(0.0)).abs()
    };
    let at = |[s, t, u]: Point| {
        let angle = 2.0 * PI * s;
        let end = if angle.cos() > 0.0 { 2.0 } else { -1.0 };
        let r = if u < 0.5 { 1.0 } else { (2.0 * u - 1.0).sqrt() };
        let z = if u < 0.5 { 2.0 * t - 1.0 } else { 1.0 };
        [end + r * angle.cos(), r * angle.sin(), z]
    };
    add("stadium", stadium, 2.0 * (6.0 + PI), (Box::new(distance), Box::new(at)));
    let vase = shapes::polygon(&[[0.0, 0.0], [2.0, 0.0], [1.0, 2.0], [3.0, 4.0], [0.0, 3.0]]).unwrap();
    let outline = vec![[0.0, 0.0], [2.0, 0.0], [1.0, 2.0], [3.0, 4.0], [0.0, 3.0]];
    // By frusta: 2 (4 + 2 + 1) π/3, 2 (1 + 3 + 9) π/3, without the cone of height 1 below the top.
    let volume = PI / 3.0 * (14.0 + 26.0 - 9.0);
    add("revolved", vase.revolved(), volume, turned(outline));
    let plate = shapes::rectangle([4.0, 2.0]).unwrap();
    let section = |z: f64| (1.0 - 0.125 * (z + 2.0), 0.0);
    add(
        "tapered",
        plate.tapered(0.5, 4.0).unwrap(),
        4.0 / 3.0 * (8.0 + 2.0 + 4.0),
        of_sections(2.0, section),
    );
    let round = shapes::circle(2.0).unwrap().tapered(0.25, 4.0).unwrap();
    let outline = vec![[0.0, -2.0], [2.0, -2.0], [0.5, 2.0], [0.0, 2.0]];
    add("tapered disc", round, PI * 4.0 / 3.0 * (4.0 + 1.0 + 0.25), turned(outline));
    let bar = plate.extruded(6.0).and_then(|bar| bar.twisted(0.5)).unwrap();
    add("twisted", bar, 48.0, of_sections(3.0, |z| (1.0, 0.5 * z)));
    // Moved up, it is turned as far as it is high.
    let bar = plate.extruded(6.0).and_then(|bar| bar.moved([0.0, 0.0, 3.0])).unwrap();
    let bar = bar.twisted(-1.5).and_then(|bar| bar.moved([0.0, 0.0, -3.0])).unwrap();
    add("twisted from its end", bar, 48.0, of_sections(3.0, |z| (1.0, -1.5 * (z + 3.0))));
    all
}

/// The largest distance of points of the triangles from the surface, and of points of that from the triangles.
fn both_ways(referee: &Referee, mesh: &Mesh) -> [f64; 2] {
    let mut random = Random::new(7);
    let mut number = || random.below(1 << 20) as f64 / f64::from(1 << 20);
    let triangles: Vec<[Point; 3]> = (0..mesh.faces().len()).map(|face| mesh.corners(face)).collect();
    let mut far = [0.0_f64; 2];
    for [a, b, c] in &triangles {
        for k in 0..16 {
            let (mut s, mut t) = if k == 0 { (1.0 / 3.0, 1.0 / 3.0) } else { (number(), number()) };
            if s + t > 1.0 {
                (s, t) = (1.0 - s, 1.0 - t);
            }
            let p = [0, 1, 2].map(|k| a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]));
            far[0] = far[0].max((referee.distance)(p));
        }
    }
    for _ in 0..600 {
        let p = (referee.at)([number(), number(), number()]);
        assert!((referee.distance)(p) < 1e-12, "{}: {p:?} is not on the surface", referee.name);
        let near = triangles.iter().map(|t| distance_to_triangle(p, *t)).fold(f64::INFINITY, f64::min);
        far[1] = far[1].max(near);
    }
    far
}

#[test]
fn closed_forms_are_within_their_bounds_both_ways() {
    for referee in referees() {
        for length in [0.3, 0.01] {
            let made = mesh(&referee.field, length);
            let most = made.bound.at_most().unwrap();
            assert!(most <= length && made.bound.evidence().bounds_above(), "{}", referee.name);
            let found = validity(&made.shape, Topology::Indices);
            assert!(found.closed && found.manifold() && found.oriented, "{}: {found:?}", referee.name);
            let measured = measure(&made.shape);
            let off = (measured.signed_volume - referee.volume).abs();
            assert!(off <= most * measured.area * 1.1 + 1e-9, "{}: {off}", referee.name);
            for (way, far) in both_ways(&referee, &made.shape).into_iter().enumerate() {
                assert!(far <= most + 1e-14, "{} {length} {way}: {far} > {most}", referee.name);
            }
        }
    }
}

#[test]
fn bounds_are_not_much_larger_than_what_they_bound() {
    for referee in referees() {
        let made = mesh(&referee.field, 0.01);
        let most = made.bound.at_most().unwrap();
        let [there, back] = both_ways(&referee, &made.shape);
        assert!(most < 1e-13 || 2.5 * there.max(back) > most, "{}: {there} {back} {most}", referee.name);
    }
}

#[test]
fn the_referee_sees_a_surface_that_is_moved() {
    for referee in referees() {
        let made = mesh(&referee.field, 0.01);
        let moved = made.shape.positions().iter().map(|p| p.map(|x| 0.98 * x)).collect();
        let moved = Mesh::new(moved, made.shape.faces().to_vec()).unwrap();
        let [there, back] = both_ways(&referee, &moved);
        assert!(there > 0.01 && back > 0.01, "{}: {there} {back}", referee.name);
    }
}

#[test]
fn placed_solids_keep_their_bounds() {
    let ball = shapes::rounded_cuboid([4.0, 5.0, 6.0], 1.0).unwrap();
    let own = mesh(&ball, 0.02);
    for scale in [1.0, 2.0, -1.0] {
        let map = Affine3::new([
            [0.6 * scale, -0.8 * scale, 0.0, 3.0],
            [0.8 * scale, 0.6 * scale, 0.0, -5.0],
            [0.0, 0.0, scale, 7.0],
        ])
        .unwrap();
        let placed = SolidMesher::placed(&own, &map).unwrap();
        let most = placed.bound.at_most().unwrap();
        assert!(most <= 0.02 * scale.abs() * (1.0 + 1e-9));
        let volume = measure(&placed.shape).signed_volume;
        assert!((volume / measure(&own.shape).signed_volume - scale.abs().powi(3)).abs() < 1e-9);
    }
}

#[test]
fn rods_that_end_in_one_point_share_the_triangles_of_its_ball() {
    let node = [0.3, -1.7, 2.9];
    let rod = |end: Point| mesh(&shapes::capsule(node, end, 0.5).unwrap(), 0.01).shape;
    let rods = [rod([5.0, 1.0, 0.0]), rod([-3.0, 2.0, 4.0]), rod([0.3, -1.7, -6.0])];
    let ball = mesh(&shapes::sphere(0.5).unwrap(), 0.01).shape;
    let mut n_shared = 0;
    for row in 0..ball.positions().len() {
        let p = [0, 1, 2].map(|k| node[k] + ball.positions()[row][k]);
        let n_rods = rods.iter().filter(|rod| rod.positions().contains(&p)).count();
        n_shared += usize::from(n_rods > 1);
    }
    // Each rod has the half of the ball that looks away from its other end.
    assert!(3 * n_shared > ball.positions().len(), "{n_shared} of {}", ball.positions().len());
}

#[test]
fn what_has_no_closed_form_has_no_mesh() {
    let within = |field: &Field| mesh_of(field.construction().unwrap(), field, 0.01);
    // A ring that meets itself, an outline that crosses itself, a circle that crosses the axis it is turned about.
    assert!(within(&shapes::torus(1.0, 2.0).unwrap()).is_none());
    let bow_tie = shapes::polygon(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]]).unwrap();
    assert!(within(&bow_tie.extruded(1.0).unwrap()).is_none());
    assert!(within(&shapes::circle(1.0).unwrap().revolved()).is_none());
    // More segments than are made.
    let ball = shapes::sphere(1.0).unwrap();
    assert!(mesh_of(ball.construction().unwrap(), &ball, 1e-12).is_none());
    // Combinations that are known, and operations that drop it.
    let cube = shapes::cuboid([1.0; 3]).unwrap();
    assert!(cube.difference(&ball).construction().is_some_and(|known| !known.has_other()));
    assert!(cube.smooth_union(&ball, 0.5).unwrap().construction().is_none());
    assert!(cube.scaled([1.0, 2.0, 1.0]).unwrap().construction().is_none());
    let grown = cube.difference(&ball).offset(0.5).unwrap();
    let flat = shapes::rounded_cuboid([4.0, 4.0, 1.0], 0.5).unwrap().offset(-0.5).unwrap();
    assert!(flat.construction().is_none());
    let thin = shapes::rectangle([20.0, 0.06]).and_then(|flat| flat.extruded(20.0)).unwrap();
    let thin = thin.twisted(40.0_f64.to_radians()).unwrap();
    assert!(mesh_of(thin.construction().unwrap(), &thin, 0.6).is_none());
    assert!(grown.construction().is_none() && ball.twisted(1.0).unwrap().construction().is_none());
    assert!(cube.union(&grown).construction().is_some_and(Construction::has_other));
}

#[test]
fn a_solid_that_is_a_little_too_small_is_not_proved() {
    let judged = |field: &Field, mesh: Mesh, length: f64| {
        let goal = (Tolerance::new(length).unwrap(), RequiredEvidence::ProvedOrMeasured);
        judged_against_field(&mut std::iter::once(mesh), field, goal, &Job::default())
    };
    for field in [shapes::cuboid([4.0; 3]).unwrap(), shapes::cylinder(2.0, 4.0).unwrap()] {
        let made = mesh(&field, 0.002);
        let right = judged(&field, made.shape.clone(), 0.005).unwrap();
        assert!(right.bound.at_most().is_some_and(|most| most <= 0.005), "{:?}", right.bound);
        let smaller = made.shape.positions().iter().map(|p| p.map(|x| x * 1.99 / 2.0)).collect();
        let smaller = Mesh::new(smaller, made.shape.faces().to_vec()).unwrap();
        let made = judged(&field, smaller, 0.005).or_else(Failure::best_effort).unwrap();
        assert!(made.bound.at_most().is_none() && made.bound.at_least() > 0.005, "{:?}", made.bound);
    }
}

/// The corners of a thread's section over two turns about height 0.
fn section(major: f64, minor: f64, pitch: f64, clearance: f64) -> Vec<[f64; 2]> {
    let slope = 3.0_f64.sqrt();
    let crest = pitch / 16.0 - clearance / slope;
    let root = crest + (major - minor) / slope;
    let at = |z: f64| {
        let far = (z / pitch - (z / pitch).round()).abs() * pitch;
        (major - slope * (far - crest)).clamp(minor, major)
    };
    let turns = |z: f64| [-2.0, -1.0, 0.0, 1.0, 2.0].map(|turn| turn * pitch + z);
    let mut heights: Vec<f64> =
        [-root, -crest.max(0.0), crest.max(0.0), root, 0.5 * pitch].into_iter().flat_map(turns).collect();
    heights.sort_unstable_by(f64::total_cmp);
    heights.into_iter().map(|z| [at(z), z]).collect()
}

#[test]
fn threads_are_within_their_bounds_both_ways() {
    let mut random = Random::new(3);
    let mut number = || random.below(1 << 20) as f64 / f64::from(1 << 20);
    let forms = [("M6", 0.0, 3.0), ("M6", 0.15, 2.0), ("M6", -0.3, 2.0), ("M1", 0.0, 0.3), ("M64", 0.4, 2.0)];
    for (name, clearance, height) in forms {
        let form = shapes::ThreadForm { clearance, ..shapes::ThreadForm::from_name(name).unwrap() };
        let field = shapes::thread(form, height).unwrap();
        let Some(ConstructionNode::Intersection(parts)) = field.construction().map(Construction::node) else {
            panic!("a thread is clipped");
        };
        for length in [0.02 * form.pitch, 0.002 * form.pitch] {
            let made = mesh_of(&parts[0], &field, length).unwrap();
            let (mesh, most) = (&made.shape, made.bound.at_most().unwrap());
            let found = validity(mesh, Topology::Indices);
            assert!(found.closed && found.manifold() && found.oriented, "{name}: {found:?}");
            assert_eq!(self_intersections(mesh, &Job::default()).unwrap().count, 0, "{name}");
            assert!(measure(mesh).signed_volume > 0.0);
            let major = 0.5 * form.diameter - clearance;
            let minor = major - 0.625 * 0.5 * 3.0_f64.sqrt() * form.pitch;
            let outline = section(major, minor, form.pitch, clearance);
            // Of points between the ends, in the plane through the axis: no nearer than the surface is.
            let mut farthest: f64 = 0.0;
            let within: Vec<[Point; 3]> = (0..mesh.faces().len())
                .map(|face| mesh.corners(face))
                .filter(|t| t.iter().all(|p| p[2].abs() < 0.5 * height + form.pitch))
                .collect();
            for t in &within {
                let (mut a, mut b) = (number(), number());
                if a + b > 1.0 {
                    (a, b) = (1.0 - a, 1.0 - b);
                }
                let p = [0, 1, 2].map(|k| t[0][k] + a * (t[1][k] - t[0][k]) + b * (t[2][k] - t[0][k]));
                let turns = p[1].atan2(p[0]) / (2.0 * PI);
                let z = p[2] - form.pitch * turns;
                let q = [p[0].hypot(p[1]), z - (z / form.pitch).round() * form.pitch];
                let near = outline.windows(2).map(|ends| from_segment(q, ends[0], ends[1]));
                farthest = farthest.max(near.fold(f64::INFINITY, f64::min));
            }
            assert!(farthest <= most + 1e-14 && farthest > 0.25 * most, "{name} {length}: {farthest} {most}");
            for _ in 0..200 {
                let (turns, z) = (number() - 0.5, (number() - 0.5) * form.pitch);
                let side = outline.windows(2).find(|ends| ends[0][1] <= z && z < ends[1][1]).unwrap();
                let part = (z - side[0][1]) / (side[1][1] - side[0][1]);
                let r = side[0][0] + part * (side[1][0] - side[0][0]);
                let (s, c) = (2.0 * PI * turns).sin_cos();
                let p = [r * c, r * s, z + form.pitch * turns];
                let near = within.iter().map(|t| distance_to_triangle(p, *t)).fold(f64::INFINITY, f64::min);
                assert!(near <= most + 1e-14, "{name} {length}: {near} > {most}");
            }
        }
    }
}
