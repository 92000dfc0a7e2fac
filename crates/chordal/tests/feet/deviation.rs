//! Meshes against patches and limit surfaces: enclosures beside samples of both, for meshes that are ours and
//! that are not.
use super::corpus::cages;
use super::patches::samples as patch_samples;
use chordal::check::{self, Deviation, Goal};
use chordal::explicit::Cage;
use chordal::explicit::subdivision::Scheme;
use chordal::{Budget, Job, Mesh, Patch, Tolerance, convert};
use chordal_testkit::Random;
use chordal_testkit::is_long;
use chordal_testkit::sampler::{Point, distance};

fn to_triangle(p: Point, [a, b, c]: [Point; 3]) -> f64 {
    let sub = |p: Point, q: Point| [0, 1, 2].map(|k| p[k] - q[k]);
    let dot = |p: Point, q: Point| (0..3).map(|k| p[k] * q[k]).sum::<f64>();
    let to_segment = |a: Point, b: Point| {
        let along = sub(b, a);
        let t = dot(sub(p, a), along) / dot(along, along).max(f64::MIN_POSITIVE);
        let t = t.clamp(0.0, 1.0);
        distance(p, [0, 1, 2].map(|k| a[k] + t * along[k]))
    };
    let (u, v, w) = (sub(b, a), sub(c, a), sub(p, a));
    let (uu, uv, vv, wu, wv) = (dot(u, u), dot(u, v), dot(v, v), dot(w, u), dot(w, v));
    let area = uu * vv - uv * uv;
    let (s, t) = ((wu * vv - wv * uv) / area, (wv * uu - wu * uv) / area);
    if area > 0.0 && s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
        return distance(p, [0, 1, 2].map(|k| a[k] + s * u[k] + t * v[k]));
    }
    to_segment(a, b).min(to_segment(b, c)).min(to_segment(c, a))
}

fn to_mesh(p: Point, mesh: &Mesh) -> f64 {
    (0..mesh.faces().len()).map(|face| to_triangle(p, mesh.corners(face))).fold(f64::INFINITY, f64::min)
}

/// Points of the surface and how far other points of it may be from all of them.
struct Surface {
    points: Vec<Point>,
    apart: f64,
}

/// The ends hold for what samples find: no point of the surface is farther than the end from above, no point
/// of the mesh either, but for what lies between the samples.
fn judge(found: &Deviation, mesh: &Mesh, surface: &Surface, what: &str) {
    let most = found.bound.at_most().unwrap();
    let back = surface.points.iter().map(|p| to_mesh(*p, mesh)).fold(0.0, f64::max);
    assert!(back <= found.backward.at_most * (1.0 + 1e-12) + 1e-13, "{what}: {back} beyond {found:?}");
    assert!(found.backward.at_least <= back + surface.apart, "{what}: {back} within {found:?}");
    let near = |p: Point| surface.points.iter().map(|q| distance(*q, p)).fold(f64::INFINITY, f64::min);
    let middles = (0..mesh.faces().len()).map(|face| {
        let [a, b, c] = mesh.corners(face);
        [0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0)
    });
    let ahead = middles.step_by(mesh.faces().len() / 50 + 1).map(near).fold(0.0, f64::max);
    assert!(ahead <= found.forward.at_most + surface.apart, "{what}: {ahead} beyond {found:?}");
    // The pair that is told is one.
    let [forward, backward] = [found.forward, found.backward];
    assert!(near(forward.from) >= forward.at_least * (1.0 - 1e-12), "{what}: {found:?}");
    assert!(to_mesh(forward.from, mesh) < 1e-12, "{what}: not on the mesh: {found:?}");
    assert!(to_mesh(backward.from, mesh) >= backward.at_least * (1.0 - 1e-12), "{what}: {found:?}");
    assert!(found.bound.at_least() <= most && found.worst().at_least == found.bound.at_least(), "{what}");
}

fn teapot() -> Vec<Patch> {
    let text = include_str!("../../../../examples/teapot.bpt");
    let numbers: Vec<f64> = text.split_whitespace().map(|word| word.parse().unwrap()).collect();
    let patch = |of: &[f64]| Patch {
        control: std::array::from_fn(|i| {
            std::array::from_fn(|j| std::array::from_fn(|k| of[2 + 3 * (4 * i + j) + k]))
        }),
    };
    numbers[1..].chunks_exact(50).map(patch).collect()
}

fn budget(length: f64) -> Budget {
    Budget::length(Tolerance::new(length).unwrap())
}

#[test]
fn meshes_of_the_teapot() {
    let patches = teapot();
    let samples = |n: usize| patches.iter().flat_map(|patch| patch_samples(patch, n)).collect::<Vec<_>>();
    let (n, apart, length) = if is_long() { (20, 0.15, 0.1) } else { (12, 0.25, 0.2) };
    let surface = Surface { points: samples(n), apart };
    let made = convert::patches_to_mesh(&patches, &budget(length), &Job::default()).unwrap();
    let goal = Goal::default();
    let found = check::patch_deviation(&made.shape, &patches, &goal, &Job::default()).unwrap();
    judge(&found, &made.shape, &surface, "teapot");
    assert!(found.reached && found.bound.at_least() <= made.bound.at_most().unwrap());
    assert!(made.bound.at_least() <= found.bound.at_most().unwrap());
    // Moved, and without its last quarter: not ours any more.
    let moved = made.shape.positions().iter().map(|p| [p[0] + 0.02, p[1], p[2]]).collect();
    let kept = made.shape.faces()[..made.shape.faces().len() * 3 / 4].to_vec();
    let other = Mesh::new(moved, kept).unwrap();
    let found = check::patch_deviation(&other, &patches, &goal, &Job::default()).unwrap();
    judge(&found, &other, &surface, "a part of the teapot");
    assert!(found.reached && found.backward.at_least > found.forward.at_most, "{found:?}");
    let max = |length: f64| Goal { max: Tolerance::new(length).ok(), ..goal };
    let least = found.bound.at_least();
    for (limit, within) in [(0.5 * least, false), (1.5 * least, true)] {
        let found = check::patch_deviation(&other, &patches, &max(limit), &Job::default()).unwrap();
        let most = found.bound.at_most().unwrap();
        assert!(found.reached && if within { most <= limit } else { found.bound.at_least() > limit });
    }
}

/// What the mesher says is proved again, though it is only some percent above the truth.
#[test]
fn what_is_claimed_of_the_teapot_is_proved_again() {
    let patches = teapot();
    let finer: &[f64] = if is_long() { &[0.003, 0.001, 0.0005] } else { &[] };
    for length in [0.03, 0.01].iter().chain(finer) {
        let made = convert::patches_to_mesh(&patches, &budget(*length), &Job::default()).unwrap();
        let claimed = made.bound.at_most().unwrap();
        let goal = Goal { max: Tolerance::new(claimed).ok(), ..Goal::default() };
        let found = check::patch_deviation(&made.shape, &patches, &goal, &Job::default()).unwrap();
        assert!(found.reached && found.bound.at_most().unwrap() <= claimed, "{length}: {found:?}");
        let less = Goal { max: Tolerance::new(0.9 * found.bound.at_least()).ok(), ..goal };
        let found = check::patch_deviation(&made.shape, &patches, &less, &Job::default()).unwrap();
        assert!(found.reached && found.bound.at_least() > less.max.unwrap().get(), "{length}: {found:?}");
    }
}

/// Where the bends of a patch are beyond the largest double no level is near enough, and the search ends all the same.
#[test]
fn a_patch_whose_bends_overflow_ends() {
    let scale = f64::powi(2.0, 1020);
    let mut bump = Patch::flat([0.0; 3], [scale, 0.0, 0.0], [0.0, scale, 0.0]);
    bump.control[1][1][2] = scale;
    let corners = vec![[0.0; 3], [scale, 0.0, 0.0], [scale, scale, 0.0], [0.0, scale, 0.0]];
    let mesh = Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let most = 0.3 * scale;
    for max in [None, Tolerance::new(most).ok()] {
        let goal = Goal { max, ..Goal::default() };
        match check::patch_deviation(&mesh, &[bump], &goal, &Job::default()) {
            Ok(found) => assert!(found.bound.at_most().is_none_or(|most| most > 0.1 * scale), "{found:?}"),
            Err(refused) => assert!(matches!(refused, chordal::budget::JobError::Refused(_)), "{refused:?}"),
        }
    }
}

#[test]
fn meshes_of_cages() {
    let some = ["bilinear_nonquads0", "catmark_cube_creases0", "catmark_dart_edgeonly"];
    let more: &[&str] = if is_long() {
        &[
            "catmark_cube",
            "catmark_fan",
            "catmark_gregory_test3",
            "catmark_hole_test1",
            "catmark_inf_crease0",
            "catmark_torus",
            "catmark_fvar_bound3",
        ]
    } else {
        &[]
    };
    for (name, cage) in cages().into_iter().filter(|(name, _)| some.iter().chain(more).any(|one| one == name))
    {
        let limit = cage.limit().unwrap();
        let sheets: Vec<_> = (0..limit.n_sheets()).map(|sheet| limit.sheet(sheet).unwrap()).collect();
        let n = if is_long() { 16 } else { 10 };
        let mut surface = Surface { points: Vec::new(), apart: 0.0 };
        for sheet in &sheets {
            let at = |i: usize, j: usize| sheet.at(j as f64 / n as f64, i as f64 / n as f64).unwrap().point;
            for (i, j) in (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
                surface.points.push(at(i, j));
                // What lies between is not much farther than the next one.
                if i > 0 && j > 0 {
                    surface.apart = surface.apart.max(distance(at(i, j), at(i - 1, j - 1)));
                }
            }
        }
        let size = Mesh::new(surface.points.clone(), vec![]).unwrap().bounds().diagonal();
        let made = convert::cage_to_mesh(&cage, &budget(2e-2 * size), &Job::default()).unwrap();
        let goal = Goal { relative: 0.2, absolute: Tolerance::new(4e-3 * size).ok(), max: None };
        let found = check::cage_deviation(&made.shape, &cage, &goal, &Job::default()).unwrap();
        judge(&found, &made.shape, &surface, &name);
        assert!(found.reached, "{name}: {found:?}");
        assert!(found.bound.at_least() <= made.bound.at_most().unwrap(), "{name}: {found:?}");
        assert!(made.bound.at_least() <= found.bound.at_most().unwrap(), "{name}: {found:?}");
        let mut numbers = Random::new(31);
        let shaken = |p: &Point| [0, 1, 2].map(|k| p[k] + 0.02 * size * numbers.signed());
        let other =
            Mesh::new(made.shape.positions().iter().map(shaken).collect(), made.shape.faces().to_vec())
                .unwrap();
        let found = check::cage_deviation(&other, &cage, &goal, &Job::default()).unwrap();
        judge(&found, &other, &surface, &name);
        assert!(found.reached, "{name}: {found:?}");
    }
}

#[test]
fn what_has_no_surface_is_refused() {
    let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
    let empty = Mesh::new(vec![], vec![]).unwrap();
    let flat = Patch::flat([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let (goal, job) = (Goal::default(), Job::default());
    let code = |result: Result<Deviation, chordal::budget::JobError>| match result {
        Err(chordal::budget::JobError::Refused(refusal)) => refusal.code.as_str(),
        other => panic!("{other:?}"),
    };
    assert_eq!(code(check::patch_deviation(&mesh, &[], &goal, &job)), "empty");
    assert_eq!(code(check::patch_deviation(&empty, &[flat], &goal, &job)), "empty");
    let triangle = Cage::new(mesh.positions().to_vec(), [[0_u32, 1, 2]]).unwrap();
    let hidden = triangle.clone().with_holes(&[0]).unwrap();
    assert_eq!(code(check::cage_deviation(&mesh, &hidden, &goal, &job)), "empty");
    let by_loop = triangle.with_scheme(Scheme::Loop).unwrap();
    assert_eq!(code(check::cage_deviation(&mesh, &by_loop, &goal, &job)), "unsupported");
    let huge = Patch::flat([-1e308; 3], [1e308, 1e308, 0.0], [0.0, 1e308, 1e308]);
    let far = mesh.with_positions(mesh.positions().iter().map(|p| p.map(|x| x + 1.5e308)).collect()).unwrap();
    assert_eq!(code(check::patch_deviation(&far, &[huge], &goal, &job)), "not-finite");
    let cancelled = Job::default();
    cancelled.cancel();
    assert!(check::patch_deviation(&mesh, &[flat], &goal, &cancelled).is_err());
}

/// A square against itself as a patch, far from the origin and at extremes of scale.
#[test]
fn a_flat_patch_is_its_two_triangles() {
    for scale in [1.0, f64::powi(2.0, 300), f64::powi(2.0, -300)] {
        let at = |x: f64, y: f64, z: f64| [scale * x, scale * y, scale * z];
        let flat = Patch::flat(at(5.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(0.0, 1.0, 0.0));
        let mesh = |z: f64| {
            let points = vec![at(5.0, 0.0, z), at(6.0, 0.0, z), at(6.0, 1.0, z), at(5.0, 1.0, z)];
            Mesh::new(points, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
        };
        let of =
            |z: f64| check::patch_deviation(&mesh(z), &[flat], &Goal::default(), &Job::default()).unwrap();
        let (same, above) = (of(0.0), of(0.25));
        assert!(same.reached && same.bound.at_most().unwrap() < 1e-11 * scale, "{same:?}");
        let (least, most) = (above.bound.at_least(), above.bound.at_most().unwrap());
        assert!(
            above.reached && least <= 0.25 * scale && 0.25 * scale <= most && least > 0.249 * scale,
            "{above:?}"
        );
    }
}
