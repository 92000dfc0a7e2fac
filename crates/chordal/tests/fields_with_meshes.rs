//! Fields with meshes among their leaves: their triangles, the bound of these, and true distances, judged by
//! samples of surfaces that are known in closed form, and by rays.
use chordal::budget::{Evidence, Failure, RefusalCode};
use chordal::check::validity;
use chordal::convert::solids::{SolidNode, SolidTree};
use chordal::convert::{field_to_mesh, has_meshes, mesh_to_field, redistance};
use chordal::explicit::Topology;
use chordal::implicit::shapes::{cuboid, sphere};
use chordal::implicit::{Affine3, Field};
use chordal::math::Box3;
use chordal::{Bounded, Budget, Job, Mesh, Tolerance};
use chordal_testkit::{Random, is_long, some};

type Point = [f64; 3];

fn within(length: f64) -> Budget {
    Budget::length(Tolerance::new(length).unwrap())
}

/// A box as twelve triangles.
fn box_mesh(low: Point, high: Point) -> Mesh {
    let at = |i: usize| std::array::from_fn(|k| if i >> k & 1 == 1 { high[k] } else { low[k] });
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
    let faces = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Mesh::new((0..8).map(at).collect(), faces).unwrap()
}

/// A ball with bumps as triangles, rings times segments, without its cap where it is open.
fn bumpy(rings: u32, segments: u32, open: bool) -> Mesh {
    let at = |ring: u32, segment: u32| {
        let (v, u) = (f64::from(ring) / f64::from(rings), f64::from(segment) / f64::from(segments));
        let (v, u) = (v * std::f64::consts::PI, u * std::f64::consts::TAU);
        let far = 1.0 + 0.1 * libm::sin(5.0 * v) * libm::cos(3.0 * u);
        [far * libm::sin(v) * libm::cos(u), far * libm::sin(v) * libm::sin(u), far * libm::cos(v)]
    };
    let mut corners = vec![at(0, 0), at(rings, 0)];
    corners.extend((1..rings).flat_map(|ring| (0..segments).map(move |segment| at(ring, segment))));
    let row = |ring: u32, segment: u32| match ring {
        0 => 0,
        last if last == rings => 1,
        ring => 2 + (ring - 1) * segments + segment % segments,
    };
    let mut faces = Vec::new();
    for ring in u32::from(open)..rings {
        for segment in 0..segments {
            let quad = [
                row(ring, segment),
                row(ring + 1, segment),
                row(ring + 1, segment + 1),
                row(ring, segment + 1),
            ];
            if quad[0] != quad[3] {
                faces.push([quad[0], quad[2], quad[3]]);
            }
            if quad[1] != quad[2] {
                faces.push([quad[0], quad[1], quad[2]]);
            }
        }
    }
    Mesh::new(corners, faces).unwrap()
}

fn minus(a: Point, b: Point) -> Point {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The distance to a triangle: to its plane where the foot is in it, else to its sides.
fn to_triangle(p: Point, [a, b, c]: [Point; 3]) -> f64 {
    let normal = cross(minus(b, a), minus(c, a));
    let inside =
        [[a, b], [b, c], [c, a]].iter().all(|[s, e]| dot(cross(minus(*e, *s), minus(p, *s)), normal) >= 0.0);
    if inside {
        return dot(minus(p, a), normal).abs() / dot(normal, normal).sqrt();
    }
    let to_side = |[s, e]: [Point; 2]| {
        let along = minus(e, s);
        let t = (dot(minus(p, s), along) / dot(along, along)).clamp(0.0, 1.0);
        let foot = std::array::from_fn(|k| s[k] + t * along[k]);
        dot(minus(p, foot), minus(p, foot)).sqrt()
    };
    [[a, b], [b, c], [c, a]].map(to_side).into_iter().fold(f64::INFINITY, f64::min)
}

/// The distance to a mesh, triangle by triangle.
fn to_mesh(p: Point, mesh: &Mesh) -> f64 {
    let corners = |face: &[u32; 3]| face.map(|row| mesh.positions()[row as usize]);
    mesh.faces().iter().map(|face| to_triangle(p, corners(face))).fold(f64::INFINITY, f64::min)
}

/// Points of the triangles: corners and middles.
fn points_of(mesh: &Mesh) -> Vec<Point> {
    let middle = |face: &[u32; 3]| {
        let [a, b, c] = face.map(|row| mesh.positions()[row as usize]);
        std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0)
    };
    mesh.positions().iter().copied().chain(mesh.faces().iter().map(middle)).collect()
}

/// Points of the surface of the cube from −1 to 1 without the ball of a radius around its corner (1, 1, 1).
fn cut_cube_points(random: &mut Random, radius: f64, n: usize) -> Vec<Point> {
    let mut points = Vec::new();
    while points.len() < n {
        let mut p: Point = std::array::from_fn(|_| 2.0 * random.unit() - 1.0);
        let to_corner = minus(p, [1.0; 3]);
        let far = dot(to_corner, to_corner).sqrt();
        if points.len() % 2 == 0 {
            let axis = (random.unit() * 3.0) as usize % 3;
            p[axis] = if random.unit() < 0.5 { -1.0 } else { 1.0 };
            let offset = minus(p, [1.0; 3]);
            if dot(offset, offset).sqrt() >= radius {
                points.push(p);
            }
        } else {
            let q: Point = std::array::from_fn(|k| 1.0 + to_corner[k] * radius / far);
            if q.iter().all(|x| x.abs() <= 1.0) {
                points.push(q);
            }
        }
    }
    points
}

/// An upper bound for the distance from a point to that surface: to the feet that lie on it.
fn to_cut_cube(p: Point, radius: f64) -> f64 {
    let apart = |a: Point, b: Point| dot(minus(a, b), minus(a, b)).sqrt();
    let on_surface =
        |q: &Point| q.iter().all(|x| x.abs() <= 1.0 + 1e-12) && apart(*q, [1.0; 3]) >= radius - 1e-12;
    let mut feet: Vec<Point> = Vec::new();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let mut q = p.map(|x| x.clamp(-1.0, 1.0));
            q[axis] = side;
            feet.push(q);
            // On the arc in which the ball cuts the side.
            if side > 0.0 {
                let mut offset = minus(q, [1.0; 3]);
                offset[axis] = 0.0;
                let far = dot(offset, offset).sqrt();
                feet.push(std::array::from_fn(|k| 1.0 + offset[k] * radius / far));
            }
        }
    }
    let offset = minus(p, [1.0; 3]);
    feet.push(std::array::from_fn(|k| 1.0 + offset[k] * radius / dot(offset, offset).sqrt()));
    feet.into_iter().filter(on_surface).map(|q| apart(p, q)).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_mesh_minus_a_ball_is_within_its_bound_both_ways() {
    let (radius, job) = (0.7, Job::default());
    let cube = mesh_to_field(&box_mesh([-1.0; 3], [1.0; 3]), &job).unwrap().field;
    let cut = cube.difference(&sphere(radius).unwrap().moved([1.0; 3]).unwrap());
    assert!(has_meshes(&cut) && !has_meshes(&sphere(1.0).unwrap()));
    let mut random = Random::new(7);
    for length in some([0.3, 0.05, 0.1], 2) {
        let made = field_to_mesh(&cut, &within(length), &job).expect("within the length");
        let most = made.bound.at_most().unwrap();
        assert!(most <= length && *made.bound.evidence() == Evidence::Proved, "{:?}", made.bound);
        let validity = validity(&made.shape, Topology::Indices);
        assert!(
            validity.closed && validity.edge_manifold && validity.vertex_manifold && validity.oriented,
            "{validity:?}"
        );
        let there = points_of(&made.shape).into_iter().map(|p| to_cut_cube(p, radius)).fold(0.0, f64::max);
        let surface = cut_cube_points(&mut random, radius, 500);
        let back = surface.into_iter().map(|p| to_mesh(p, &made.shape)).fold(0.0, f64::max);
        assert!(there <= most && back <= most, "{there} {back} {most}");
        // A bound far above all samples would be too careful to be of use.
        assert!(f64::max(there, back) > 0.05 * most, "{there} {back} {most}");
    }
}

#[test]
fn a_placed_solid_is_its_own_triangles() {
    let (mesh, job) = (bumpy(12, 20, false), Job::default());
    let solid = mesh_to_field(&mesh, &job).unwrap();
    assert!(solid.solid.is_solid(), "{}", solid.solid);
    let same = field_to_mesh(&solid.field, &within(1e-3), &job).expect("a mesh");
    assert_eq!((same.shape.positions(), same.bound.at_most()), (mesh.positions(), Some(0.0)));
    let map = Affine3::new([[2.0, 0.5, 0.0, 3.0], [0.0, 1.5, 0.25, -1.0], [0.0, 0.0, -3.0, 0.1]]).unwrap();
    let placed = solid.field.transformed(&map).unwrap();
    let made = field_to_mesh(&placed, &within(1e-3), &job).expect("a mesh");
    let off = made.bound.at_most().unwrap();
    assert!(off > 0.0 && off < 1e-13, "{off}");
    for (p, q) in mesh.positions().iter().zip(made.shape.positions()) {
        let apart = minus(map.at(*p), *q);
        assert!(dot(apart, apart).sqrt() <= off + 1e-14);
    }
    // The map mirrors, and the front is outside all the same.
    assert!(chordal::check::findings::measure(&made.shape).signed_volume > 0.0);
    // Half of the triangles is beyond what is asked for.
    let few = Budget { triangles: Some(10), ..within(1e-3) };
    assert!(matches!(field_to_mesh(&placed, &few, &job), Err(Failure::Unmet(_))));
}

#[test]
fn a_mesh_that_crosses_itself_becomes_its_outer_surface() {
    let job = Job::default();
    let (a, b) = (box_mesh([-1.0; 3], [0.5; 3]), box_mesh([-0.5; 3], [1.0; 3]));
    let corners = a.positions().iter().chain(b.positions()).copied().collect();
    let faces =
        a.faces().iter().copied().chain(b.faces().iter().map(|face| face.map(|row| row + 8))).collect();
    let crossed = mesh_to_field(&Mesh::new(corners, faces).unwrap(), &job).unwrap();
    assert!(!crossed.solid.is_solid());
    let made = field_to_mesh(&crossed.field, &within(0.1), &job).expect("a mesh");
    // No inner wall is left: 27/8 twice, less the cube that they share.
    let volume = chordal::check::findings::measure(&made.shape).signed_volume;
    assert!((volume - 5.75).abs() < 0.1 * 12.0 * 1.5 * 1.5, "{volume}");
    let inner = points_of(&made.shape).into_iter().filter(|p| p.iter().all(|x| x.abs() < 0.35));
    assert_eq!(inner.count(), 0);
}

#[test]
fn an_open_scan_minus_a_ball_is_closed() {
    let (rings, segments) = if is_long() { (24, 40) } else { (14, 24) };
    let (mesh, job) = (bumpy(rings, segments, true), Job::default());
    let scan = mesh_to_field(&mesh, &job).unwrap();
    assert!(!scan.solid.closed);
    let cut = scan.field.difference(&sphere(0.5).unwrap().moved([1.0, 0.0, 0.0]).unwrap());
    let made = field_to_mesh(&cut, &within(0.08), &job).expect("within the length");
    let found = validity(&made.shape, Topology::Indices);
    assert!(found.closed && found.edge_manifold && found.vertex_manifold, "{found:?}");
    let Evidence::ProvedIf(sentences) = made.bound.evidence() else { panic!("{:?}", made.bound) };
    assert!(
        sentences.iter().any(|sentence| sentence.contains("winding number is above a half")),
        "{sentences:?}"
    );
    // Away from the hole the triangles of the scan are the surface.
    let most = made.bound.at_most().unwrap();
    for p in mesh.positions().iter().filter(|p| p[2] < 0.7 && p[0] < 0.4) {
        assert!(to_mesh(*p, &made.shape) <= most, "{p:?}");
    }
}

/// The ranges of an open mesh hold its values, and know sides where there is one.
#[test]
fn ranges_of_open_meshes_hold_all_values() {
    let job = Job::default();
    let field = mesh_to_field(&bumpy(16, 24, true), &job).unwrap().field;
    let tape = field.tape();
    let mut random = Random::new(11);
    let (mut boxes, mut points) = (Vec::new(), Vec::new());
    for _ in 0..400 {
        let size = 0.3 * random.unit() * random.unit();
        let low: Point = std::array::from_fn(|_| 2.6 * random.unit() - 1.3);
        boxes.push(Box3 { min: low, max: low.map(|x| x + size) });
        points.extend((0..20).map(|_| -> Point { std::array::from_fn(|k| low[k] + size * random.unit()) }));
    }
    let mut ranges = vec![chordal::math::Interval::UNKNOWN; boxes.len()];
    let mut values = vec![0.0; points.len()];
    tape.over(&boxes, &mut ranges).unwrap();
    tape.at(&points, &mut values).unwrap();
    let mut known = [0; 2];
    for (range, values) in ranges.iter().zip(values.chunks(20)) {
        assert!(values.iter().all(|value| range.contains(*value)), "{range:?} {values:?}");
        known[0] += usize::from(range.hi() < 0.0);
        known[1] += usize::from(range.lo() > 0.0);
    }
    assert!(known[0] > 30 && known[1] > 150, "{known:?}");
}

/// Rays in several directions count by which side they leave through; no code of the library decides.
#[test]
fn signs_are_those_of_rays() {
    let job = Job::default();
    let crossed = {
        let (a, b) = (bumpy(12, 20, false), box_mesh([-0.2; 3], [1.2; 3]));
        let n = a.positions().len() as u32;
        let corners = a.positions().iter().chain(b.positions()).copied().collect();
        let faces = a.faces().iter().copied().chain(b.faces().iter().map(|face| face.map(|row| row + n)));
        Mesh::new(corners, faces.collect()).unwrap()
    };
    let mut random = Random::new(3);
    for mesh in [bumpy(12, 20, false), crossed] {
        let tape = mesh_to_field(&mesh, &job).unwrap().field.tape();
        let points: Vec<Point> =
            (0..1500).map(|_| std::array::from_fn(|_| 3.0 * random.unit() - 1.5)).collect();
        let mut values = vec![0.0; points.len()];
        tape.at(&points, &mut values).unwrap();
        let mut n_inside = 0;
        for (p, value) in points.iter().zip(values).filter(|(_, value)| value.abs() > 1e-9) {
            let votes = (0..7).filter(|_| {
                let direction: Point = std::array::from_fn(|_| random.unit() - 0.5);
                let crossings: i32 = mesh
                    .faces()
                    .iter()
                    .map(|face| {
                        let [a, b, c] = face.map(|row| minus(mesh.positions()[row as usize], *p));
                        let volume = |u: Point, v: Point| dot(direction, cross(u, v));
                        let sides = [volume(a, b), volume(b, c), volume(c, a)];
                        let normal = cross(minus(b, a), minus(c, a));
                        let is_ahead = dot(a, normal) * dot(direction, normal) > 0.0;
                        if is_ahead && sides.iter().all(|s| *s > 0.0) {
                            1
                        } else if is_ahead && sides.iter().all(|s| *s < 0.0) {
                            -1
                        } else {
                            0
                        }
                    })
                    .sum();
                crossings > 0
            });
            let is_inside = votes.count() >= 4;
            assert_eq!(value < 0.0, is_inside, "{p:?}: {value}");
            n_inside += usize::from(is_inside);
        }
        assert!(n_inside > 100);
    }
}

/// Two boxes that overlap a little: inside, the value of the union is the distance to walls that are covered.
fn overlapping() -> Field {
    let a = cuboid([1.6, 1.0, 1.0]).unwrap().moved([-0.7, 0.0, 0.0]).unwrap();
    a.union(&cuboid([1.6, 1.0, 1.0]).unwrap().moved([0.7, 0.0, 0.0]).unwrap())
}

/// The true distance to the bar that these are.
fn to_bar(p: Point) -> f64 {
    let over: Point = [p[0].abs() - 1.5, p[1].abs() - 0.5, p[2].abs() - 0.5];
    let outside = over.map(|x| x.max(0.0));
    dot(outside, outside).sqrt() + over.into_iter().fold(f64::NEG_INFINITY, f64::max).min(0.0)
}

#[test]
fn a_distance_after_a_union_is_true_again_within_its_bound() {
    let job = Job::default();
    let union = overlapping();
    let mesh_union = mesh_to_field(&box_mesh([-1.5, -0.5, -0.5], [0.1, 0.5, 0.5]), &job).unwrap().field;
    let mesh_union = mesh_union.union(&cuboid([1.6, 1.0, 1.0]).unwrap().moved([0.7, 0.0, 0.0]).unwrap());
    let mut random = Random::new(5);
    for field in [union, mesh_union] {
        let Bounded { shape: made, bound } =
            redistance(&field, Tolerance::new(0.04).unwrap(), &job).expect("a mesh");
        let most = bound.at_most().unwrap();
        assert!(most <= 0.04);
        let points: Vec<Point> = (0..2000)
            .map(|_| [4.0 * random.unit() - 2.0, 1.6 * random.unit() - 0.8, 1.6 * random.unit() - 0.8])
            .collect();
        let (mut before, mut after) = (vec![0.0; points.len()], vec![0.0; points.len()]);
        field.tape().at(&points, &mut before).unwrap();
        made.tape().at(&points, &mut after).unwrap();
        let off = |values: &[f64]| {
            points.iter().zip(values).map(|(p, value)| (value - to_bar(*p)).abs()).fold(0.0, f64::max)
        };
        assert!(off(&before) > 0.2, "the value of a union is no distance: {}", off(&before));
        assert!(off(&after) <= most + 1e-12, "{} > {most}", off(&after));
    }
}

#[test]
fn what_a_true_distance_lost_is_never_dropped() {
    let job = Job::default();
    let made = redistance(&overlapping(), Tolerance::new(0.02).unwrap(), &job).expect("a mesh");
    // Exact planes lose nothing, so a rounder shape is taken as well.
    let ball = sphere(1.0).unwrap().union(&sphere(1.0).unwrap().moved([0.7, 0.0, 0.0]).unwrap());
    let round = redistance(&ball, Tolerance::new(0.02).unwrap(), &job).expect("a mesh");
    let lost = round.bound.at_most().unwrap();
    assert!(lost > 0.0);
    // By itself, and scaled: lengths.
    let alone = field_to_mesh(&round.shape, &within(0.1), &job).expect("a mesh");
    assert!(alone.bound.at_most().unwrap() >= lost);
    assert_eq!(*alone.bound.evidence(), *round.bound.evidence());
    let twice = field_to_mesh(&round.shape.scaled([2.0; 3]).unwrap(), &within(0.1), &job).expect("a mesh");
    assert!(twice.bound.at_most().unwrap() >= 2.0 * lost);
    // In anything else: a promise with the length.
    let grown = round.shape.offset(0.1).unwrap();
    let joined = made.shape.union(&sphere(0.6).unwrap());
    for (field, lost) in [(grown, lost), (joined, made.bound.at_most().unwrap())] {
        let meshed = field_to_mesh(&field, &within(0.1), &job).expect("a mesh");
        let Evidence::ProvedIf(sentences) = meshed.bound.evidence() else { panic!("{:?}", meshed.bound) };
        assert!(
            sentences.iter().any(|sentence| sentence.contains(&format!("up to {lost:e} away"))),
            "{sentences:?}"
        );
    }
    // And not within a length that is less than what was lost.
    let stricter = field_to_mesh(&round.shape, &within(0.5 * lost), &job);
    assert!(matches!(stricter, Err(Failure::Unmet(_))));
}

#[test]
fn offsets_of_true_distances_are_offsets() {
    let job = Job::default();
    let made = redistance(&overlapping(), Tolerance::new(0.01).unwrap(), &job).expect("a mesh");
    // Shrunk by a quarter, the bar is 2.5 × 0.5 × 0.5; of the union as it was, nothing would be left at 0.
    let shrunk = made.shape.offset(-0.25).unwrap();
    let meshed = field_to_mesh(&shrunk, &within(0.05), &job).expect("a mesh");
    let Box3 { min, max } = meshed.shape.bounds();
    for (k, half) in [1.25, 0.25, 0.25].into_iter().enumerate() {
        assert!((max[k] - half).abs() < 0.07 && (min[k] + half).abs() < 0.07, "{min:?} {max:?}");
    }
    assert_eq!(validity(&meshed.shape, Topology::Indices).components, 1);
}

#[test]
fn limits_are_respected() {
    let cube = mesh_to_field(&box_mesh([-1.0; 3], [1.0; 3]), &Job::default()).unwrap().field;
    let cut = cube.difference(&sphere(0.7).unwrap().moved([1.0; 3]).unwrap());
    let mut small = Job::default();
    small.memory_limit = 100_000;
    let refused = field_to_mesh(&cut, &within(0.02), &small);
    assert!(
        matches!(&refused, Err(Failure::Refused(why)) if why.code == RefusalCode::TooMuchMemory),
        "{refused:?}"
    );
    let mut few = Job::default();
    few.triangle_limit = 1000;
    let refused = field_to_mesh(&cut, &within(0.02), &few);
    assert!(
        matches!(&refused, Err(Failure::Refused(why)) if why.code == RefusalCode::TooManyTriangles),
        "{refused:?}"
    );
    let cancelled = Job::default();
    cancelled.cancel();
    assert!(matches!(field_to_mesh(&cut, &within(0.02), &cancelled), Err(Failure::Cancelled)));
    let both = Budget { triangles: Some(1000), ..within(0.05) };
    let Err(Failure::Unmet(best)) = field_to_mesh(&cut, &both, &Job::default()) else { panic!("too many") };
    assert!(best.bound.at_most().unwrap() <= 0.05);
    let counted = field_to_mesh(&cut, &Budget::triangles(5000), &Job::default()).expect("a mesh");
    assert!(counted.shape.faces().len() <= 5000 && counted.shape.faces().len() > 1000);
    assert!(counted.bound.at_most().is_some());
}

#[test]
fn the_same_bytes_on_any_number_of_threads() {
    let cube = mesh_to_field(&bumpy(24, 40, true), &Job::default()).unwrap().field;
    let cut = cube.difference(&sphere(0.5).unwrap().moved([1.0, 0.0, 0.0]).unwrap());
    let on =
        |threads| field_to_mesh(&cut, &within(0.1), &Job::default().with_threads(threads)).expect("a mesh");
    let (one, three) = (on(1), on(3));
    assert_eq!((&one.shape, &one.bound), (&three.shape, &three.bound));
}

/// Whether a point is inside of a node of a tree.
fn is_inside(nodes: &[SolidNode], number: usize, p: Point) -> bool {
    let of = |k: usize| is_inside(nodes, k, p);
    match &nodes[number] {
        SolidNode::Triangles(made) => {
            mesh_to_field(&made.shape, &Job::default()).unwrap().field.expr().at(p).unwrap() < 0.0
        }
        SolidNode::Field(part) => part.bounds().contains(p) && part.expr().at(p).unwrap() < 0.0,
        SolidNode::Union(a, b) => of(*a) || of(*b),
        SolidNode::Intersection(a, b) => of(*a) && of(*b),
        SolidNode::Difference(a, b) => of(*a) && !of(*b),
    }
}

#[test]
fn a_tree_of_solids_has_the_points_of_its_field() {
    let seed = 11;
    let mut random = Random::new(seed);
    for round in 0..40 {
        let mut number = |most: usize| random.below(most) as f64;
        // Up to five parts, the first a mesh, joined in turn.
        let part = |number: &mut dyn FnMut(usize) -> f64, k: u32| {
            let at = [0.5 * number(5) - 1.0, 0.5 * number(5) - 1.0, 0.25 * number(3)];
            let shape = match number(3) as u32 {
                _ if k == 0 => mesh_to_field(&box_mesh([-1.1; 3], [0.9; 3]), &Job::default()).unwrap().field,
                0 => mesh_to_field(&bumpy(8, 12, false), &Job::default()).unwrap().field,
                1 => sphere(0.8).unwrap(),
                _ => cuboid([1.0, 40.0, 1.3]).unwrap(),
            };
            shape.rotated_deg([0.0, 0.0, 1.0], 25.0 * number(4)).unwrap().moved(at).unwrap()
        };
        let mut field = part(&mut number, 0);
        for k in 1..2 + round % 4 {
            let other = part(&mut number, k);
            field = match number(4) as u32 {
                0 => field.union(&other),
                1 => field.intersection(&other),
                2 => field.difference(&other),
                _ => other.difference(&field.complement()),
            };
        }
        if field.bounds().is_empty() {
            continue;
        }
        let Some(tree) = SolidTree::from_field(&field).expect("meshes are placed") else {
            panic!("{seed} {round}: it is no tree");
        };
        let root = tree.nodes.len() - 1;
        for _ in 0..60 {
            let p: Point = std::array::from_fn(|_| number(6007) / 1000.0 - 3.0);
            let value = field.expr().at(p).unwrap();
            if value.abs() > 1e-9 {
                assert_eq!(is_inside(&tree.nodes, root, p), value < 0.0, "{seed} {round} {p:?}");
            }
        }
    }
}

#[test]
fn what_is_no_boolean_of_closed_meshes_is_no_tree() {
    let job = Job::default();
    let closed = mesh_to_field(&box_mesh([-1.0; 3], [1.0; 3]), &job).unwrap().field;
    let open = mesh_to_field(&bumpy(8, 12, true), &job).unwrap().field;
    let ball = sphere(0.8).unwrap();
    let is_tree = |field: &Field| SolidTree::from_field(field).expect("meshes are placed").is_some();
    assert!(is_tree(&closed.difference(&ball)));
    assert!(!is_tree(&closed) && !is_tree(&ball));
    assert!(!is_tree(&open.difference(&ball)));
    assert!(!is_tree(&closed.offset(0.1).unwrap().difference(&ball)));
    assert!(!is_tree(&closed.smooth_union(&ball, 0.1).unwrap()));
}

#[test]
fn a_soup_of_triangles_that_is_moved_shares_its_vertices() {
    let whole = bumpy(8, 12, false);
    let corners: Vec<Point> = (0..whole.faces().len()).flat_map(|face| whole.corners(face)).collect();
    let n = whole.faces().len() as u32;
    let soup =
        Mesh::new(corners, (0..n).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect()).unwrap();
    let field = mesh_to_field(&soup, &Job::default()).unwrap().field.moved([0.3, 0.1, 7.0]).unwrap();
    let made = field_to_mesh(&field, &within(0.1), &Job::default()).unwrap();
    assert_eq!(made.shape.positions().len(), whole.positions().len());
    assert!(validity(&made.shape, Topology::Indices).closed);
}
