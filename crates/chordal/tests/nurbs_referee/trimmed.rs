//! Trimmed surfaces against samplers that share no code with the library, and solids of several faces.
use super::{OWN, Sheet, largest};
use chordal::budget::{Failure, RefusalCode};
use chordal::explicit::nurbs::{KnotVector, NurbsCurve, NurbsSurface, TrimmedSurface};
use chordal::explicit::{Arc, Bezier, Curve, CurveEnds, CurveSegment, Topology};
use chordal::{Budget, Job, Mesh, Tolerance, check, convert};
use chordal_testkit::sampler::{Triangles, distance, on};
use chordal_testkit::{Random, cases, is_long};
use std::f64::consts::TAU;

/// A loop in the unit square, which places of a sheet fill.
enum Loop {
    /// Corners, joined by straight lines.
    Polygon(Vec<[f64; 2]>),
    /// Control points of cubics that end where the next one starts.
    Cubics(Vec<[[f64; 2]; 4]>),
    /// Centre, half-axes, and the sense of turning; as an arc or as a spline.
    Ellipse([f64; 2], [f64; 2], f64, bool),
}

impl Loop {
    /// Around a centre, no farther from it than a radius, once.
    fn random(random: &mut Random, centre: [f64; 2], reach: f64, turn: f64) -> Self {
        let corner = |random: &mut Random, k: usize, n: usize| -> [f64; 2] {
            let (sin, cos) = (turn * TAU * k as f64 / n as f64).sin_cos();
            let r = reach * random.between(0.4, 1.0);
            [centre[0] + r * cos, centre[1] + r * sin]
        };
        match random.below(5) {
            4 => Self::with_needle(random, centre, reach, turn),
            0 => {
                let n = 3 + random.below(6);
                Self::Polygon((0..n).map(|k| corner(random, k, n)).collect())
            }
            1 => {
                let n = 3 + random.below(3);
                let corners: Vec<[f64; 2]> = (0..n).map(|k| corner(random, k, n)).collect();
                let cubic = |k: usize| {
                    let [a, b] = [corners[k], corners[(k + 1) % n]];
                    // A little towards the centre, so that it stays within the corners' triangle with it.
                    let inner = |p: [f64; 2], q: [f64; 2]| -> [f64; 2] {
                        std::array::from_fn(|i| 0.6 * p[i] + 0.3 * q[i] + 0.1 * centre[i])
                    };
                    [a, inner(a, b), inner(b, a), b]
                };
                Self::Cubics((0..n).map(cubic).collect())
            }
            kind => {
                let axes = [0; 2].map(|_| reach * random.between(0.3, 1.0));
                Self::Ellipse(centre, axes, turn, kind == 2)
            }
        }
    }

    /// With a spike from a corner, out and back along two curves that are next to each other.
    fn with_needle(random: &mut Random, centre: [f64; 2], reach: f64, turn: f64) -> Self {
        let n = 3 + random.below(3);
        let along = |k: usize| (turn * TAU * k as f64 / n as f64).sin_cos();
        let on_ray = |k: usize, r: f64, side: f64| -> [f64; 2] {
            let (sin, cos) = along(k);
            [centre[0] + r * cos - turn * side * sin, centre[1] + r * sin + turn * side * cos]
        };
        let corners: Vec<f64> = (0..n).map(|_| reach * random.between(0.4, 0.6)).collect();
        let straight = |a: [f64; 2], b: [f64; 2]| -> [[f64; 2]; 4] {
            let between = |t: f64| std::array::from_fn(|i| a[i] + t * (b[i] - a[i]));
            [a, between(1.0 / 3.0), between(2.0 / 3.0), b]
        };
        let side =
            |k: usize| straight(on_ray(k, corners[k], 0.0), on_ray((k + 1) % n, corners[(k + 1) % n], 0.0));
        let (foot, tip) = (corners[0], reach * random.between(0.7, 1.0));
        // Both bend to the same side, or each to its own.
        let (thin, bent) = (random.power(-6.0, -2.0) * reach, random.between(-0.05, 0.05) * reach);
        let inner = |t: f64, side: f64| on_ray(0, foot + t * (tip - foot), side);
        let out = [inner(0.0, 0.0), inner(0.3, bent - thin), inner(0.7, bent - thin), inner(1.0, 0.0)];
        let back = [inner(1.0, 0.0), inner(0.7, bent + thin), inner(0.3, bent + thin), inner(0.0, 0.0)];
        Self::Cubics([out, back].into_iter().chain((0..n).map(side)).collect())
    }

    /// The point at a part of the way around.
    fn at(&self, s: f64) -> [f64; 2] {
        let part = |n: usize| {
            let piece = ((s * n as f64) as usize).min(n - 1);
            (piece, s * n as f64 - piece as f64)
        };
        match self {
            Self::Polygon(corners) => {
                let (k, t) = part(corners.len());
                let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
                std::array::from_fn(|i| a[i] + t * (b[i] - a[i]))
            }
            Self::Cubics(cubics) => {
                let (k, t) = part(cubics.len());
                let (s, c) = (1.0 - t, &cubics[k]);
                std::array::from_fn(|i| {
                    s * s * s * c[0][i]
                        + 3.0 * s * s * t * c[1][i]
                        + 3.0 * s * t * t * c[2][i]
                        + t * t * t * c[3][i]
                })
            }
            Self::Ellipse(centre, axes, turn, _) => {
                let (sin, cos) = (turn * TAU * s).sin_cos();
                [centre[0] + axes[0] * cos, centre[1] + axes[1] * sin]
            }
        }
    }

    /// The same in the plane of parameters.
    fn curve(&self, map: impl Fn([f64; 2]) -> [f64; 2]) -> Curve<2> {
        match self {
            Self::Polygon(corners) => {
                let n = corners.len();
                let line = |k: usize| CurveSegment::Line([map(corners[k]), map(corners[(k + 1) % n])]);
                Curve::new((0..n).map(line).collect(), CurveEnds::Closed).unwrap()
            }
            Self::Cubics(cubics) => {
                let cubic = |c: &[[f64; 2]; 4]| CurveSegment::Cubic(Bezier { control: c.map(&map) });
                Curve::new(cubics.iter().map(cubic).collect(), CurveEnds::Closed).unwrap()
            }
            Self::Ellipse(centre, axes, turn, is_arc) => {
                let middle = map(*centre);
                let right = map([centre[0] + axes[0], centre[1]]);
                let top = map([centre[0], centre[1] + turn * axes[1]]);
                let axes = [right, top].map(|p| [p[0] - middle[0], p[1] - middle[1]]);
                if *is_arc {
                    let arc = Arc::new(middle, axes, 0.0, TAU).unwrap();
                    let start = arc.ends()[0];
                    let arc = CurveSegment::Arc(arc.with_ends([start; 2]));
                    Curve::new(vec![arc], CurveEnds::Closed).unwrap()
                } else {
                    NurbsCurve::circle(middle, axes).unwrap().to_curve().unwrap()
                }
            }
        }
    }
}

/// A sheet with loops around what is left of it.
struct Trimmed {
    sheet: Sheet,
    loops: Vec<Loop>,
    /// By loop: close points on it.
    around: Vec<Vec<[f64; 2]>>,
}

/// Points on each loop of the referee. Their chords are some 1e-6 off.
const AROUND: usize = 1200;

impl Trimmed {
    fn random(random: &mut Random) -> Self {
        let sheet = Sheet::random(random);
        let mut loops = vec![Loop::random(random, [0.5, 0.5], 0.49, 1.0)];
        if random.below(2) == 0 {
            // All loops are at least 0.3 of their reach away from their centres.
            loops.push(Loop::random(random, [0.5, 0.5], 0.07, -1.0));
        }
        let points = |l: &Loop| (0..AROUND).map(|k| l.at(k as f64 / AROUND as f64)).collect();
        Self { around: loops.iter().map(points).collect(), sheet, loops }
    }

    /// The parameters at a place of the unit square.
    fn parameters(&self, place: [f64; 2]) -> [f64; 2] {
        std::array::from_fn(|k| {
            let (knots, p) = (&self.sheet.knots[k], self.sheet.degrees[k]);
            let [from, to] = [knots[p], knots[knots.len() - 1 - p]];
            from + (to - from) * place[k]
        })
    }

    fn at(&self, place: [f64; 2]) -> [f64; 3] {
        self.sheet.at_parameters(self.parameters(place))
    }

    fn face(&self) -> TrimmedSurface {
        let loops = self.loops.iter().map(|l| l.curve(|place| self.parameters(place))).collect();
        TrimmedSurface::new(self.sheet.surface(), loops).unwrap()
    }

    /// Whether a place is enclosed: by the first and not by the others.
    fn holds(&self, p: [f64; 2]) -> bool {
        let within = |points: &Vec<[f64; 2]>| {
            let mut is_inside = false;
            for k in 0..points.len() {
                let (a, b) = (points[k], points[(k + 1) % points.len()]);
                let crosses = (a[1] > p[1]) != (b[1] > p[1]);
                if crosses && p[0] < a[0] + (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]) {
                    is_inside = !is_inside;
                }
            }
            is_inside
        };
        within(&self.around[0]) && !self.around[1..].iter().any(within)
    }

    /// The largest distances found: of the surface from the triangles, and of the triangles from the surface. What seems to
    /// be farther than a limit is looked at more closely.
    fn measured(&self, mesh: &Mesh, limit: f64, random: &mut Random) -> [f64; 2] {
        let triangles = Triangles::new(mesh.positions(), mesh.faces());
        let n = 40;
        let lattice = (0..=n).flat_map(|j| (0..=n).map(move |i| [i, j].map(|k| f64::from(k) / f64::from(n))));
        let mut places: Vec<[f64; 2]> = lattice.filter(|p| self.holds(*p)).collect();
        places.extend(self.around.iter().flatten().step_by(4));
        let samples: Vec<[f64; 3]> = places.iter().map(|p| self.at(*p)).collect();
        let there = samples.iter().map(|p| triangles.distance(*p)).fold(0.0, f64::max);
        let mut back = 0.0;
        for _ in 0..12 {
            let p = on(triangles.corners[random.below(triangles.corners.len())], random.weights());
            let mut order: Vec<usize> = (0..samples.len()).collect();
            order.sort_by(|a, b| distance(samples[*a], p).total_cmp(&distance(samples[*b], p)));
            let foot = |k: &usize| self.descend(places[*k], p);
            let off = order.iter().step_by(7).take(6).map(foot).fold(f64::INFINITY, f64::min);
            let to_loops = self.loops.iter().map(|l| self.to_loop(l, p)).fold(off, f64::min);
            back = f64::max(back, if to_loops > limit { self.by_windows(p).min(to_loops) } else { to_loops });
        }
        [there, back]
    }

    /// The least distance of a close lattice within the loops, and of closer ones around it: creases and holes do not stop it
    /// as they stop a descent.
    fn by_windows(&self, p: [f64; 3]) -> f64 {
        let (mut best, mut window) = ((f64::INFINITY, [0.5; 2]), 1.0);
        for n in [600, 100, 100, 100, 100] {
            let step = window / f64::from(n);
            let [x, y] = best.1.map(|x| x - 0.5 * window);
            for (i, j) in (0..=n).flat_map(|j| (0..=n).map(move |i| (i, j))) {
                let place = [x + f64::from(i) * step, y + f64::from(j) * step];
                if place.iter().all(|x| (0.0..=1.0).contains(x)) && self.holds(place) {
                    let off = distance(self.at(place), p);
                    best = if off < best.0 { (off, place) } else { best };
                }
            }
            window = 6.0 * step;
        }
        best.0
    }

    /// A distance from a loop: between the neighbours of the nearest of many points, by thirds.
    fn to_loop(&self, around: &Loop, p: [f64; 3]) -> f64 {
        let off = |s: f64| distance(self.at(around.at(s)), p);
        let at = |k: i32| f64::from(k) / 240.0;
        let nearest = (0..=240).min_by(|a, b| off(at(*a)).total_cmp(&off(at(*b)))).unwrap();
        let (mut low, mut high) = (at(nearest - 1).max(0.0), at(nearest + 1).min(1.0));
        for _ in 0..60 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            *(if off(a) < off(b) { &mut high } else { &mut low }) = if off(a) < off(b) { b } else { a };
        }
        off(0.5 * (low + high))
    }

    /// The least distance downhill from a place, within the loops.
    fn descend(&self, mut at: [f64; 2], p: [f64; 3]) -> f64 {
        let mut best = distance(self.at(at), p);
        let mut step = 0.05;
        while step > 1e-6 {
            let mut next = (best, at);
            for k in 0..16 {
                let (sin, cos) = (f64::from(k) * TAU / 16.0).sin_cos();
                let place = [at[0] + step * cos, at[1] + step * sin];
                let is_within = place.iter().all(|x| (0.0..=1.0).contains(x)) && self.holds(place);
                let off = if is_within { distance(self.at(place), p) } else { f64::INFINITY };
                if off < next.0 {
                    next = (off, place);
                }
            }
            if next.0 < best {
                (best, at) = next;
            } else {
                step *= 0.5;
            }
        }
        best
    }
}

#[test]
fn no_trimmed_surface_is_farther_from_its_mesh_than_the_bound() {
    let mut random = Random::new(601);
    let (mut ratios, mut unmet) = (Vec::new(), 0);
    for case in 0..cases(4) {
        let trimmed = Trimmed::random(&mut random);
        let size = largest(&trimmed.sheet.control);
        // Heavy weights at the shortest lengths take a minute.
        let shortest = if is_long() { 0.0 } else { 0.02 };
        let length = random.power(-2.7, -1.3).max(shortest) * size;
        let budget = Budget::length(Tolerance::new(length).unwrap());
        // Weights of 400 times each other may need more cells than there can be; the bound holds all the same.
        let mut job = Job::default();
        job.triangle_limit = 200_000;
        let made = convert::trimmed_surfaces_to_mesh(&[trimmed.face()], &budget, &job);
        unmet += usize::from(made.is_err());
        let made = made.or_else(Failure::best_effort).unwrap();
        let at_most = made.bound.at_most().unwrap();
        // A descent along a border ends between its close points.
        let spare = 1e-3 * at_most + 2e-5 * size;
        let found = trimmed.measured(&made.shape, at_most + spare, &mut random);
        assert!(
            found[0] <= at_most + OWN * size + 2e-6 * size && found[1] <= at_most + spare,
            "case {case}: {found:?} {at_most} {length}"
        );
        ratios.push(at_most / found[0].max(found[1]));
        let valid = check::validity(&made.shape, Topology::Positions);
        let loops = trimmed.loops.len() as u64;
        assert!(valid.edge_manifold && valid.oriented, "{case} {valid:?}");
        // A spike ends where it starts, so that a loop may pass there twice.
        assert!(!valid.vertex_manifold || valid.boundary_loops == loops, "{case} {valid:?}");
    }
    ratios.sort_by(f64::total_cmp);
    assert!(5 * unmet <= ratios.len(), "{unmet} of {}", ratios.len());
    let median = ratios[ratios.len() / 2];
    // Measured: 3.8, since cells are rows and columns across the whole, and weights differ by up to 400 times.
    // By default there are four, at longer lengths: 5.9.
    assert!(median < if is_long() { 5.0 } else { 7.0 }, "{median}");
}

/// A plane through three corners, its parameters from 0 to `n` along `u`, with a degree and knots of its own.
fn plane([origin, u, v]: [[f64; 3]; 3], degree: usize, n: usize) -> NurbsSurface {
    let knots = [KnotVector::clamped(degree, degree + n).unwrap(), KnotVector::clamped(1, 2).unwrap()];
    // Greville's abscissae make it linear.
    let count = degree + n;
    let all = knots[0].knots().to_vec();
    let at = |k: usize| all[k + 1..=k + degree].iter().sum::<f64>() / degree as f64 / n as f64;
    let point = |s: f64, t: f64| -> [f64; 3] {
        std::array::from_fn(|k| origin[k] + s * (u[k] - origin[k]) + t * (v[k] - origin[k]))
    };
    let control =
        [0.0, 1.0].iter().flat_map(|t| (0..count).map(move |k| (at(k), *t))).map(|(s, t)| point(s, t));
    NurbsSurface::new(knots, control.collect(), vec![1.0; 2 * count]).unwrap()
}

#[test]
fn faces_with_other_parameters_and_parts_of_sides_make_a_closed_box() {
    let (o, x, y, z) = ([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let add = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| a[k] + b[k]) };
    let half = [0.5, 0.0, 0.0];
    let faces: Vec<TrimmedSurface> = vec![
        plane([o, y, x], 3, 2).into(),
        plane([z, add(z, x), add(z, y)], 2, 5).into(),
        // The front is two faces, which the others know nothing of.
        plane([o, half, z], 1, 1).into(),
        plane([half, x, add(half, z)], 4, 3).into(),
        plane([y, add(y, z), add(y, x)], 1, 1).into(),
        plane([o, z, y], 2, 2).into(),
        plane([x, add(x, y), add(x, z)], 1, 4).into(),
    ];
    for length in [1e-1, 1e-4] {
        let budget = Budget::length(Tolerance::new(length).unwrap());
        let made = convert::trimmed_surfaces_to_mesh(&faces, &budget, &Job::default()).unwrap();
        let valid = check::validity(&made.shape, Topology::Positions);
        assert!(valid.closed && valid.edge_manifold && valid.oriented, "{valid:?}");
        assert!((valid.measure.signed_volume - 1.0).abs() < 1e-9, "{valid:?}");
        // A vertex on another's edge is found to some 1e-8.
        assert!(made.bound.at_most().unwrap() < 1e-6);
    }
}

/// Patches are as many as the length takes, so there may be no mesh of few triangles.
#[test]
fn a_limit_below_the_coarsest_mesh_is_one_sentence() {
    let mut random = Random::new(601);
    let budget = |share: f64, size: f64| Budget::length(Tolerance::new(share * size).unwrap());
    let mut refused = 0;
    for _ in 0..3 {
        let trimmed = Trimmed::random(&mut random);
        let size = largest(&trimmed.sheet.control);
        let mut job = Job::default();
        job.triangle_limit = 5;
        match convert::trimmed_surfaces_to_mesh(&[trimmed.face()], &budget(1e-2, size), &job) {
            Err(Failure::Refused(refusal)) => {
                assert_eq!(refusal.code, RefusalCode::TooManyTriangles);
                assert!(refusal.message.contains("the limit is 5"), "{refusal:?}");
                refused += 1;
            }
            other => assert!(other.or_else(Failure::best_effort).is_ok()),
        }
    }
    assert!(refused > 0);
}

#[test]
fn loops_that_enclose_nothing_are_one_sentence() {
    let square = || plane([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], 1, 1);
    let path = |corners: &[[f64; 2]]| Loop::Polygon(corners.to_vec()).curve(|p| p);
    let message = |loops: Vec<Curve<2>>| {
        let face = TrimmedSurface::new(square(), loops).unwrap();
        let budget = Budget::length(Tolerance::new(1e-2).unwrap());
        convert::trimmed_surfaces_to_mesh(&[face], &budget, &Job::default()).unwrap_err().to_string()
    };
    let bow = message(vec![path(&[[0.1, 0.1], [0.9, 0.9], [0.9, 0.1], [0.1, 0.8]])]);
    assert!(bow.contains("crosses itself or another one near u"), "{bow}");
    let backward = message(vec![path(&[[0.1, 0.1], [0.1, 0.9], [0.9, 0.9]])]);
    assert!(backward.contains("trim loop 0 of surface 0 runs backwards"), "{backward}");
    let hole = [[0.4, 0.3], [0.5, 0.3], [0.4, 0.4]];
    let both = message(vec![path(&[[0.1, 0.1], [0.9, 0.1], [0.5, 0.9]]), path(&hole)]);
    assert!(both.contains("trim loop 1 of surface 0 runs backwards"), "{both}");
    let far = TrimmedSurface::new(square(), vec![path(&[[5.0, 0.0], [6.0, 0.0], [6.0, 1.0]])]).unwrap_err();
    assert!(far.to_string().contains("trim loop 0 leaves the range"), "{far}");
}

/// Faces below what is sewn, alone and beside others: each stays, as near as the length says.
#[test]
fn faces_that_are_smaller_or_thinner_than_what_is_sewn_are_kept() {
    let rectangle = |[x, y]: [f64; 2], [w, h]: [f64; 2]| {
        TrimmedSurface::new(plane([[x, y, 0.0], [x + w, y, 0.0], [x, y + h, 0.0]], 1, 1), Vec::new()).unwrap()
    };
    let alone =
        [rectangle([0.0; 2], [1.0; 2]), rectangle([3.0, 0.0], [2e-7; 2]), rectangle([5.0; 2], [1e-6; 2])];
    let ribbons = [0.0, 1e-5, 2e-5].map(|y| rectangle([0.0, y], [1.0, 1e-5]));
    for (faces, right, length) in
        [(&alone, 5.0, 0.3), (&alone, 5.0, 1e-3), (&ribbons, 1.0, 1e-3), (&ribbons, 1.0, 1e-6)]
    {
        let budget = Budget::length(Tolerance::new(length).unwrap());
        let made = convert::trimmed_surfaces_to_mesh(faces, &budget, &Job::default()).unwrap();
        assert!(made.bound.at_most().unwrap() <= length);
        assert!(made.shape.faces().len() >= 2 * faces.len(), "{length}");
        let far = made.shape.positions().iter().map(|p| p[0]).fold(0.0, f64::max);
        assert!(far >= right, "{length}: {far}");
    }
}

/// A loop whose spike, and one whose whole inside, is thinner than the length.
#[test]
fn what_is_thinner_than_the_length_is_kept_where_it_is_long() {
    let square = || plane([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], 1, 1);
    let quadratic = |[a, b, c]: [[f64; 2]; 3]| -> CurveSegment<2> {
        let toward = |p: [f64; 2]| std::array::from_fn(|i| (p[i] + 2.0 * b[i]) / 3.0);
        CurveSegment::Cubic(Bezier { control: [a, toward(a), toward(c), c] })
    };
    let closed = |segments| Curve::new(segments, CurveEnds::Closed).unwrap();
    let line = |a, b| CurveSegment::Line([a, b]);
    let (foot, tip) = ([0.5, 0.1], [0.9, 0.1]);
    let spike = |thin: f64| {
        closed(vec![
            line([0.1, 0.1], foot),
            quadratic([foot, [0.7, 0.1005], tip]),
            quadratic([tip, [0.7, 0.1005 + thin], foot]),
            line(foot, [0.4, 0.4]),
            line([0.4, 0.4], [0.1, 0.1]),
        ])
    };
    let triangle =
        || closed(vec![line([0.1, 0.1], foot), line(foot, [0.4, 0.4]), line([0.4, 0.4], [0.1, 0.1])]);
    let island = |thin: f64| {
        let ends = [[0.89, 0.9], [0.91, 0.9]];
        let middle = |y: f64| [0.9, 0.9 + y];
        closed(vec![
            quadratic([ends[0], middle(-thin), ends[1]]),
            quadratic([ends[1], middle(thin), ends[0]]),
        ])
    };
    for length in [1e-1, 1e-2, 1e-4] {
        for thin in [5e-3, 5e-4, 1e-7] {
            for loops in [vec![spike(thin)], vec![triangle(), island(thin)]] {
                let face = TrimmedSurface::new(square(), loops).unwrap();
                let budget = Budget::length(Tolerance::new(length).unwrap());
                let made = convert::trimmed_surfaces_to_mesh(&[face], &budget, &Job::default()).unwrap();
                assert!(made.bound.at_most().unwrap() <= length);
                let right = made.shape.positions().iter().map(|p| p[0]).fold(0.0, f64::max);
                assert!(right >= 0.89, "{length} {thin}: {right}");
            }
        }
    }
    // Out and back along one line: its end is as far from what is left as it is long.
    let there_and_back = closed(vec![
        line([0.1, 0.1], foot),
        line(foot, tip),
        line(tip, foot),
        line(foot, [0.4, 0.4]),
        line([0.4, 0.4], [0.1, 0.1]),
    ]);
    let face = TrimmedSurface::new(square(), vec![there_and_back]).unwrap();
    let budget = Budget::length(Tolerance::new(1e-2).unwrap());
    let made = convert::trimmed_surfaces_to_mesh(&[face], &budget, &Job::default());
    let bound = made.or_else(Failure::best_effort).unwrap().bound.at_most().unwrap();
    assert!((0.4..0.41).contains(&bound), "{bound}");
}
