//! Tests of the prover against meshes with known deviations, and against planted faults.
use super::face_side_cache::FaceSide;
use super::face_sides::{SideQuery, classify_sides};
use super::prover::{SandwichProver, SandwichVerdict};
use super::regions::SignRegions;
use super::sandwich::SandwichGoal;
use crate::budget::Job;
use crate::explicit::{Bvh, Mesh};
use crate::implicit::evaluation::Unary;
use crate::implicit::{Csg, Expr, Field, Membership, PrimitiveEvaluator, Tape, shapes};
use crate::math::{Box3, greater};
use chordal_testkit::Random;
use std::collections::BTreeMap;

/// A geodesic sphere: an octahedron, subdivided so often.
fn ball(centre: [f64; 3], radius: f64, cuts: u32) -> Mesh {
    let mut at: Vec<[f64; 3]> =
        vec![[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
    let mut faces: Vec<[u32; 3]> =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..cuts {
        let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
        let mut parts = Vec::new();
        for [a, b, c] in faces {
            let mut middle = |a: u32, b: u32| {
                *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                    let p: [f64; 3] = std::array::from_fn(|k| at[a as usize][k] + at[b as usize][k]);
                    let norm = p.iter().map(|x| x * x).sum::<f64>().sqrt();
                    at.push(p.map(|x| x / norm));
                    at.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            parts.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        faces = parts;
    }
    let at = at.iter().map(|p| std::array::from_fn(|k| centre[k] + radius * p[k])).collect();
    Mesh::new(at, faces).unwrap()
}

/// The box from one corner to the other.
fn cuboid(min: [f64; 3], max: [f64; 3]) -> Mesh {
    let at = (0..8_usize).map(|i| std::array::from_fn(|k| if i >> k & 1 == 1 { max[k] } else { min[k] }));
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Mesh::new(at.collect(), faces).unwrap()
}

fn both(a: &Mesh, b: &Mesh) -> Mesh {
    let n = a.positions().len() as u32;
    let faces = b.faces().iter().map(|face| face.map(|v| v + n));
    let faces: Vec<[u32; 3]> = a.faces().iter().copied().chain(faces).collect();
    Mesh::new([a.positions(), b.positions()].concat(), faces).unwrap()
}

fn turned(mesh: &Mesh) -> Mesh {
    let faces = mesh.faces().iter().map(|[a, b, c]| [*b, *a, *c]).collect();
    Mesh::new(mesh.positions().to_vec(), faces).unwrap()
}

fn sphere(radius: f64) -> Field {
    shapes::sphere(radius).unwrap()
}

fn moved(field: &Field, by: [f64; 3]) -> Field {
    field.moved(by).unwrap()
}

fn look(field: &Field, mesh: &Mesh, limit: Option<f64>) -> SandwichVerdict {
    on_threads(field, mesh, limit, 1)
}

fn on_threads(field: &Field, mesh: &Mesh, limit: Option<f64>, threads: usize) -> SandwichVerdict {
    let job = Job::default().with_threads(threads);
    let csg = Csg::from_expr(field.sign());
    let mut judge = SandwichProver::new(&csg, &field.bounds(), &job).unwrap();
    judge.prove(mesh, &SandwichGoal::new(limit, 0.25)).unwrap()
}

/// How far the flattest point of any face is below a sphere, exactly except for rounding.
fn sagitta(mesh: &Mesh, radius: f64) -> f64 {
    let depth = |corners: [[f64; 3]; 3]| {
        let [a, b, c] = corners;
        let (u, v) = (crate::math::difference(b, a), crate::math::difference(c, a));
        let n = crate::math::cross(u, v);
        radius - crate::math::dot(a, n).abs() / crate::math::length(n)
    };
    (0..mesh.faces().len()).map(|face| depth(mesh.corners(face))).fold(0.0, |most, far| greater(far, most))
}

#[test]
fn the_bound_of_a_ball_is_tight_at_every_scale() {
    for scale in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
        let mesh = ball([0.0; 3], scale, 4);
        let found = look(&sphere(scale), &mesh, None);
        let truth = sagitta(&mesh, scale);
        assert!(found.is_proved(), "{scale:e}: {:?} {:?}", found.open, found.wrong);
        assert!(
            truth <= found.bound && found.bound <= 1.35 * truth,
            "{scale:e}: {truth:e} {:e}",
            found.bound
        );
        // A limit below the true deviation is not proved.
        let cut = look(&sphere(scale), &mesh, Some(0.95 * truth));
        assert!(!cut.is_proved(), "{scale:e}");
        assert!(look(&sphere(scale), &mesh, Some(1.2 * truth)).is_proved(), "{scale:e}");
    }
}

#[test]
fn work_follows_the_faces() {
    let job = Job::default().with_threads(1);
    let mesh = ball([0.0; 3], 1.0, 4);
    let field = sphere(1.0);
    let csg = Csg::from_expr(field.sign());
    let mut judge = SandwichProver::new(&csg, &field.bounds(), &job).unwrap();
    let limit = Some(1.25 * sagitta(&mesh, 1.0));
    judge.prove(&mesh, &SandwichGoal::new(limit, 0.5)).unwrap();
    let first = judge.n_boxes();
    assert!(first <= 90 * mesh.faces().len() as u64, "{first}");
}

#[test]
fn a_cube_is_proved_to_the_last_digits() {
    let field = shapes::cuboid([2.0, 2.0, 2.0]).unwrap();
    let found = look(&field, &cuboid([-1.0; 3], [1.0; 3]), None);
    assert!(found.is_proved() && found.bound < 1e-9, "{found:?}");
    let larger = look(&field, &cuboid([-1.125; 3], [1.125; 3]), None);
    let truth = 0.125 * 3.0_f64.sqrt();
    assert!(larger.is_proved() && larger.bound >= truth && larger.bound < 1.5 * truth, "{larger:?}");
}

#[test]
fn a_missing_ball_is_seen() {
    let (large, small) = ([0.0; 3], [0.9, 0.3, 0.1]);
    let field = sphere(0.6).union(&moved(&sphere(0.004), small));
    let whole = both(&ball(large, 0.6, 4), &ball(small, 0.004, 2));
    assert!(look(&field, &whole, Some(5e-3)).is_proved());
    let found = look(&field, &ball(large, 0.6, 4), Some(5e-3));
    assert!(found.open.iter().all(Vec::is_empty), "its faces are near the surface");
    assert!(!found.is_proved() && found.wrong.len() == 1, "{:?}", found.wrong);
}

#[test]
fn a_missing_inner_sheet_is_seen() {
    let field = sphere(1.0).difference(&sphere(0.5));
    let outer = ball([0.0; 3], 1.0, 4);
    let inner = turned(&ball([0.0; 3], 0.5, 4));
    assert!(look(&field, &both(&outer, &inner), Some(5e-3)).is_proved());
    let found = look(&field, &outer, Some(5e-3));
    assert!(!found.is_proved() && !found.wrong.is_empty());
    // An inner sheet with reversed winding does not count.
    assert!(!look(&field, &both(&outer, &turned(&inner)), Some(5e-3)).is_proved());
}

#[test]
fn turned_faces_prove_nothing() {
    let mesh = turned(&ball([0.0; 3], 1.0, 3));
    assert!(!look(&sphere(1.0), &mesh, Some(0.05)).is_proved());
    assert!(!look(&sphere(1.0), &mesh, None).is_proved());
    let twice = both(&ball([0.0; 3], 1.0, 3), &ball([0.0; 3], 1.0, 3));
    assert!(!look(&sphere(1.0), &twice, Some(0.05)).is_proved(), "it winds twice");
}

#[test]
fn a_blunt_edge_is_open_though_its_faces_are_near_the_surface() {
    // A wedge of 5 degrees, as long as 1, cut off 0.05 before its edge, where it is 0.0044 thick.
    let slope = 2.5_f64.to_radians().tan();
    let [x, y, z] = Expr::axes();
    let flanks = (z.clone() - &x * slope).max(&(-z - &x * slope));
    let rest = (&x - 1.0).max(&(y.abs() - 0.5));
    let bounds = Box3 { min: [0.0, -0.5, -0.1], max: [1.0, 0.5, 0.1] };
    let field = Field::new(flanks.max(&rest)).with_bounds(bounds);
    let prism = |from: f64| {
        let ends =
            |y: f64| [[from, y, -from * slope], [1.0, y, -slope], [1.0, y, slope], [from, y, from * slope]];
        let at: Vec<[f64; 3]> = [ends(-0.5), ends(0.5)].concat();
        let quads = [[0, 1, 2, 3], [7, 6, 5, 4], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]];
        let faces = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        Mesh::new(at, faces).unwrap()
    };
    assert!(look(&field, &prism(1e-4), Some(5e-3)).is_proved());
    assert!(!look(&field, &prism(0.05), Some(5e-3)).is_proved());
    let loose = look(&field, &prism(0.05), Some(0.08));
    assert!(loose.is_proved() && loose.bound >= 0.05, "{loose:?}");
}

#[test]
fn stacked_boxes_have_no_wall_between_them() {
    let lower = shapes::cuboid([2.0, 2.0, 2.0]).unwrap();
    let whole = lower.union(&moved(&lower, [0.0, 0.0, 2.0]));
    let found = look(&whole, &cuboid([-1.0; 3], [1.0, 1.0, 3.0]), Some(0.01));
    assert!(found.is_proved(), "{:?} {:?} {}", found.open, found.wrong, found.unresolved.len());
    // With the wall the mesh winds around both boxes too, but the two copies of its common face have no room
    // to move.
    let apart = both(&cuboid([-1.0; 3], [1.0; 3]), &cuboid([-1.0, -1.0, 1.0], [1.0, 1.0, 3.0]));
    assert!(!look(&whole, &apart, Some(0.01)).is_proved());
}

/// An octahedron of two halves that abut.
fn halves(centre: [f64; 3], radius: f64) -> Expr {
    let axes = Expr::axes();
    let [x, y, z]: [Expr; 3] = std::array::from_fn(|k| &axes[k] - centre[k]);
    let half = |x: &Expr| {
        let planes = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)]
            .map(|(a, b)| &(&(x + &(&y * a)) + &(&z * b)) - radius);
        planes.iter().fold(-x, |all, plane| all.max(plane))
    };
    half(&x).min(&half(&-&x))
}

#[test]
fn a_part_or_a_hole_of_two_halves_is_not_missed() {
    let block = shapes::cuboid([2.0; 3]).unwrap();
    let bounds = Box3 { min: [-1.1; 3], max: [1.7, 1.1, 1.1] };
    let hull = cuboid([-1.0; 3], [1.0; 3]);
    for radius in [0.3, 0.03, 0.011] {
        let at = [1.35, 0.1, 0.2];
        let field = Field::new(block.sign().min(&halves(at, radius))).with_bounds(bounds);
        assert!(!look(&field, &hull, Some(0.01)).is_proved(), "a part of {radius}");
        assert!(look(&field, &both(&hull, &ball(at, radius, 0)), Some(0.01)).is_proved(), "{radius}");
        let at = [0.3, 0.1, 0.2];
        let field = Field::new(block.sign().max(&-&halves(at, radius))).with_bounds(bounds);
        assert!(!look(&field, &hull, Some(0.01)).is_proved(), "a hole of {radius}");
        let hollow = both(&hull, &turned(&ball(at, radius, 0)));
        assert!(look(&field, &hollow, Some(0.01)).is_proved(), "{radius}");
    }
}

#[test]
fn where_a_function_is_zero_its_complement_is_outside_too() {
    let [x, y, z] = Expr::axes();
    let round = &(&(&x.square() + &y.square()) + &z.square()) - 1.0;
    let bounds = Box3 { min: [-1.1; 3], max: [1.1; 3] };
    let whole = ball([0.0; 3], 1.0, 3);
    // 0 from -0.5 to 0.5, so that the slice is not there.
    let steps = Expr::unary(Unary::Floor, &(&x + 0.5));
    let sliced = Field::new(round.max(&steps.min(&-&steps))).with_bounds(bounds);
    assert!(!look(&sliced, &whole, Some(0.1)).is_proved());
    // 0 up to x = 5.
    let far = (&x - 5.0).max(&Expr::constant(0.0));
    let flat = &far * &far;
    let nothing = Field::new(round.max(&flat.min(&(-&flat).max(&(&x - 2.0))))).with_bounds(bounds);
    assert!(!look(&nothing, &whole, Some(0.1)).is_proved());
    assert!(look(&Field::new(round).with_bounds(bounds), &whole, Some(0.1)).is_proved());
}

#[test]
fn where_solids_touch_faces_are_open_and_nowhere_else() {
    // No copy passes between the two: their insides meet in a point.
    let pair = moved(&sphere(0.5), [-0.5, 0.0, 0.0]).union(&moved(&sphere(0.5), [0.5, 0.0, 0.0]));
    let mesh = both(&ball([-0.5, 0.0, 0.0], 0.5, 4), &ball([0.5, 0.0, 0.0], 0.5, 4));
    let found = look(&pair, &mesh, Some(0.01));
    assert!(!found.is_proved() && found.wrong.is_empty());
    for face in found.open.iter().flatten() {
        let far = mesh.corners(*face as usize).map(crate::math::length);
        assert!(far.iter().any(|far| *far < 0.05), "{far:?}");
    }
    assert!(found.unresolved.iter().all(|place| place.contains([0.0; 3])), "{:?}", found.unresolved);
    let apart = moved(&sphere(0.5), [-0.53, 0.0, 0.0]).union(&moved(&sphere(0.5), [0.53, 0.0, 0.0]));
    let mesh = both(&ball([-0.53, 0.0, 0.0], 0.5, 4), &ball([0.53, 0.0, 0.0], 0.5, 4));
    assert!(look(&apart, &mesh, Some(0.01)).is_proved());
}

#[test]
fn an_open_mesh_and_one_with_a_flipped_face_prove_nothing() {
    let whole = ball([0.0; 3], 1.0, 3);
    let with = |faces: Vec<[u32; 3]>| Mesh::new(whole.positions().to_vec(), faces).unwrap();
    let open = with(whole.faces()[1..].to_vec());
    let mut faces = whole.faces().to_vec();
    faces[7].swap(0, 1);
    for mesh in [open, with(faces)] {
        assert!(!look(&sphere(1.0), &mesh, Some(0.05)).is_proved());
    }
    // Rows of one position are tied: a triangle soup is as closed as the mesh that it came from.
    let at: Vec<[f64; 3]> = (0..whole.faces().len()).flat_map(|face| whole.corners(face)).collect();
    let soup =
        Mesh::new(at, (0..whole.faces().len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect());
    assert!(look(&sphere(1.0), &soup.unwrap(), Some(0.05)).is_proved());
}

#[test]
fn a_thin_wall_takes_few_cells() {
    let [x, y, z] = Expr::axes();
    let norm = (x.square() + y.square() + z.square()).sqrt();
    let bounds = Box3 { min: [-1.0; 3], max: [1.0; 3] };
    let field = Field::new((&norm - 1.0).max(&(-&norm + 0.999_023_437_5))).with_bounds(bounds);
    let job = Job::default().with_threads(1);
    let csg = Csg::from_expr(field.sign());
    let mut judge = SandwichProver::new(&csg, &bounds, &job).unwrap();
    // Cells as small as the wall would be a million and more.
    assert!(judge.n_boxes() < 30_000, "{}", judge.n_boxes());
    // Both sheets are needed: a cover that ignored the wall would accept a mesh with none.
    let outer = ball([0.0; 3], 1.0, 3);
    let found = judge.prove(&outer, &SandwichGoal::new(None, 0.25)).unwrap();
    assert!(found.unresolved.is_empty() && !found.wrong.is_empty());
}

/// A point of the boundary of a union or difference of balls, on the segment from one point to another.
fn crossing(is_inside: impl Fn([f64; 3]) -> bool, mut ends: [[f64; 3]; 2]) -> Option<[f64; 3]> {
    let first = is_inside(ends[0]);
    if first == is_inside(ends[1]) {
        return None;
    }
    for _ in 0..60 {
        let middle: [f64; 3] = std::array::from_fn(|k| 0.5 * ends[0][k] + 0.5 * ends[1][k]);
        ends[usize::from(is_inside(middle) != first)] = middle;
    }
    Some(ends[0])
}

#[test]
fn no_sample_is_beyond_a_bound_whatever_was_done_to_the_mesh() {
    let mut n_proved = 0;
    for seed in 0..60_u64 {
        let mut random = Random::new(seed);
        // A ball with a bite or a bump; the mesh is that of the ball, its vertices perturbed, so that it
        // misses small features.
        let at: [f64; 3] = random.point();
        let far = at.iter().map(|x| x * x).sum::<f64>().sqrt();
        let at = at.map(|x| x / far);
        let radius = 0.4 * random.unit() * random.unit();
        let is_bump = seed % 2 == 0;
        let other = moved(&sphere(radius), at);
        let field = if is_bump { sphere(1.0).union(&other) } else { sphere(1.0).difference(&other) };
        let within =
            |p: [f64; 3], c: [f64; 3], r: f64| crate::math::length(crate::math::difference(p, c)) < r;
        let is_inside = |p: [f64; 3]| {
            if is_bump {
                within(p, [0.0; 3], 1.0) || within(p, at, radius)
            } else {
                within(p, [0.0; 3], 1.0) && !within(p, at, radius)
            }
        };
        let whole = ball([0.0; 3], 1.0, 3);
        let noise = 0.05 * random.unit();
        let positions = whole.positions().iter().map(|p| p.map(|x| x + noise * random.signed()));
        let mesh = Mesh::new(positions.collect(), whole.faces().to_vec()).unwrap();
        let limit = if seed % 3 == 0 { Some(0.02 + 0.2 * random.unit()) } else { None };
        let found = look(&field, &mesh, limit);
        if !found.is_proved() {
            continue;
        }
        n_proved += 1;
        let bvh = Bvh::build(&mesh, &Job::default()).unwrap();
        for sample in 0..4000 {
            // Half of the segments are about the other ball.
            let (centre, size) = if sample % 2 == 0 { ([0.0; 3], 1.5) } else { (at, 2.0 * radius) };
            let ends = [0; 2].map(|_| centre.map(|x| x + size * random.signed()));
            if let Some(p) = crossing(is_inside, ends) {
                let far = bvh.closest_distance_down(p).unwrap();
                assert!(far <= found.bound + 1e-12, "seed {seed}: {p:?} is {far} of {}", found.bound);
            }
        }
    }
    assert!(n_proved > 20, "{n_proved}");
}

#[test]
fn threads_change_nothing() {
    let field = sphere(1.0).difference(&moved(&sphere(0.7), [0.6, 0.0, 0.0]));
    let mesh = ball([0.0; 3], 1.0, 3);
    let [a, b] = [1, 2].map(|threads| on_threads(&field, &mesh, None, threads));
    assert_eq!(format!("{a:?}"), format!("{b:?}"));
}

#[test]
fn sides_of_triangles_hold_at_all_of_their_points() {
    let cone = shapes::capped_cone(1.0, 0.3, 1.5).unwrap();
    let fields = [
        sphere(1.0),
        moved(&shapes::cylinder(1.0, 1.5).unwrap(), [0.1, 0.0, 0.2]),
        sphere(1.2).difference(&cone),
        shapes::rounded_cuboid([1.5, 1.0, 2.0], 0.3).unwrap(),
        shapes::torus(1.0, 0.4).unwrap(),
    ];
    let mut random = Random::new(23);
    for field in &fields {
        let (csg, tape, job) = (Csg::from_expr(field.sign()), Tape::new(field.sign()), Job::default());
        let domain = Box3 { min: [-4.0; 3], max: [4.0; 3] };
        let mut evaluator = PrimitiveEvaluator::new(&csg, &domain, &job);
        let mut regions = SignRegions::new(&evaluator, &domain, job.memory_limit);
        let (mut positions, mut faces) = (Vec::new(), Vec::new());
        for _ in 0..600 {
            let (middle, size) = (random.point_within::<3>(1.3), random.power(1e-3, 0.5));
            let first = positions.len() as u32;
            positions.extend((0..3).map(|_| {
                let by = random.point::<3>();
                std::array::from_fn::<f64, 3, _>(|k| middle[k] + size * by[k])
            }));
            faces.push([first, first + 1, first + 2]);
        }
        let mut n_proved = 0;
        for side in [Membership::Outside, Membership::Inside] {
            let query = SideQuery { positions: &positions, faces: &faces, side, cuts: 6 };
            let found = classify_sides(&mut regions, &mut evaluator, &query).unwrap();
            for (face, found) in faces.iter().zip(found) {
                let corners = face.map(|v| positions[v as usize]);
                let at: Vec<[f64; 3]> = (0..64)
                    .map(|_| random.weights())
                    .map(|w| {
                        std::array::from_fn(|k| {
                            w[0] * corners[0][k] + w[1] * corners[1][k] + w[2] * corners[2][k]
                        })
                    })
                    .collect();
                let mut values = vec![0.0; at.len()];
                tape.at(&at, &mut values).unwrap();
                let n_right =
                    values.iter().filter(|value| (**value < 0.0) == (side == Membership::Inside)).count();
                assert!(found != FaceSide::Proved || n_right == at.len(), "{side:?} {corners:?}");
                n_proved += usize::from(found == FaceSide::Proved);
            }
        }
        assert!(n_proved > 200, "{n_proved}");
    }
}
