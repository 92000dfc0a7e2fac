//! The referee of rational splines: bounds against samplers that share no code with the library.
mod constructed;
mod edges;
mod trimmed;
pub(crate) mod truth;

use chordal::budget::Bounded;
use chordal::budget::Pixels;
use chordal::budget::camera::{Camera, Projection, Screen};
use chordal::explicit::nurbs::{KnotVector, NurbsCurve, NurbsSurface};
use chordal::explicit::{Polyline, Topology};
use chordal::{Budget, Job, Mesh, Tolerance, View, check, convert};
use chordal_testkit::sampler::{Triangles, climb, distance, on};
use chordal_testkit::{Random, cases};
use truth::{basis, parameter, random_knots, random_points, random_weights};

/// What rounding of the referee itself may cost, in parts of the largest coordinate.
const OWN: f64 = 1e-12;

fn largest<const D: usize>(points: &[[f64; D]]) -> f64 {
    points.as_flattened().iter().fold(0.0, |most, x| f64::max(most, x.abs()))
}

fn mean<const D: usize>(factors: impl Iterator<Item = f64>, points: &[[f64; D]]) -> [f64; D] {
    let (mut sum, mut total) = ([0.0; D], 0.0);
    for (factor, point) in factors.zip(points) {
        (0..D).for_each(|k| sum[k] += factor * point[k]);
        total += factor;
    }
    sum.map(|x| x / total)
}

struct Spline {
    degree: usize,
    knots: Vec<f64>,
    control: Vec<[f64; 3]>,
    weights: Vec<f64>,
}

impl Spline {
    fn random(random: &mut Random) -> Self {
        let degree = 1 + random.below(6);
        let n = degree + 1 + random.below(8);
        Self {
            degree,
            knots: random_knots(random, degree, n),
            control: random_points(random, n),
            weights: random_weights(random, n),
        }
    }

    fn at(&self, t: f64) -> [f64; 3] {
        let basis = basis(&self.knots, self.degree, t);
        mean(basis.iter().zip(&self.weights).map(|(b, w)| b * w), &self.control)
    }

    /// The point at a place from 0 to 1.
    fn at_place(&self, place: f64) -> [f64; 3] {
        self.at(parameter(&self.knots, self.degree, place))
    }

    fn curve(&self) -> NurbsCurve<3> {
        let knots = KnotVector::new(self.degree, self.knots.clone()).unwrap();
        NurbsCurve::new(knots, self.control.clone(), self.weights.clone()).unwrap()
    }
}

fn distance_to_segment(p: [f64; 3], [a, b]: [[f64; 3]; 2]) -> f64 {
    let dot = |x: [f64; 3], y: [f64; 3]| x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
    let sub = |x: [f64; 3], y: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| x[k] - y[k]) };
    let (along, from) = (sub(b, a), sub(p, a));
    let t =
        if dot(along, along) > 0.0 { (dot(from, along) / dot(along, along)).clamp(0.0, 1.0) } else { 0.0 };
    distance(p, std::array::from_fn(|k| a[k] + t * along[k]))
}

/// Places between which no step is too far, with at most so many.
fn refined(mut places: Vec<f64>, is_far: impl Fn([f64; 2]) -> bool, most: usize) -> Vec<f64> {
    loop {
        let mut next = vec![places[0]];
        for pair in places.windows(2) {
            if is_far([pair[0], pair[1]]) {
                next.push(0.5 * (pair[0] + pair[1]));
            }
            next.push(pair[1]);
        }
        if next.len() == places.len() || next.len() > most {
            return places;
        }
        places = next;
    }
}

/// The largest distance of samples of the spline from the polyline, and of samples of the polyline from the spline.
fn measured(spline: &Spline, line: &Polyline<3>) -> [f64; 2] {
    // Weights let it run fast: places are halved until samples are close.
    let even = 12 * (line.points.len() + spline.control.len());
    let start = (0..=even).map(|k| k as f64 / even as f64).collect();
    let close = largest(&spline.control) / 256.0;
    let places = refined(start, |[a, b]| distance(spline.at_place(a), spline.at_place(b)) > close, 1 << 14);
    let samples: Vec<[f64; 3]> = places.iter().map(|place| spline.at_place(*place)).collect();
    let n = samples.len() - 1;
    let mut points = line.points.clone();
    if line.closed {
        points.push(points[0]);
    }
    let segments: Vec<[[f64; 3]; 2]> = points.windows(2).map(|ends| [ends[0], ends[1]]).collect();
    let near =
        |p: [f64; 3]| segments.iter().map(|ends| distance_to_segment(p, *ends)).fold(f64::INFINITY, f64::min);
    let there = samples.iter().map(|p| near(*p)).fold(0.0, f64::max);
    let between = |[a, b]: &[[f64; 3]; 2]| {
        let (a, b) = (*a, *b);
        (0..4).map(move |i| std::array::from_fn(|k| a[k] + (b[k] - a[k]) * f64::from(i) / 4.0))
    };
    let back = segments.iter().flat_map(between).map(|p: [f64; 3]| {
        let off = |k: usize| distance(samples[k], p);
        let is_valley = |k: &usize| (*k == 0 || off(*k) <= off(k - 1)) && (*k == n || off(*k) <= off(k + 1));
        let mut starts: Vec<usize> = (0..=n).filter(is_valley).collect();
        starts.sort_by(|i, j| off(*i).total_cmp(&off(*j)));
        let descend = |k: &usize| {
            let (mut t, mut best) = (places[*k], off(*k));
            let mut step = places[(k + 1).min(n)] - places[k.saturating_sub(1)];
            for _ in 0..60 {
                for next in [t - step, t + step] {
                    let next = next.clamp(0.0, 1.0);
                    let off = distance(spline.at_place(next), p);
                    if off < best {
                        (t, best) = (next, off);
                    }
                }
                step *= 0.6;
            }
            best
        };
        starts.iter().take(4).map(descend).fold(f64::INFINITY, f64::min)
    });
    [there, back.fold(0.0, f64::max)]
}

#[test]
fn evaluation_and_pieces_are_those_of_the_recursion() {
    let mut random = Random::new(501);
    for _ in 0..cases(400) {
        let spline = Spline::random(&mut random);
        let (curve, size) = (spline.curve(), largest(&spline.control));
        let path = curve.to_curve().unwrap();
        for _ in 0..20 {
            let t = parameter(&spline.knots, spline.degree, random.unit());
            let truth = spline.at(t);
            assert!(distance(curve.at(t), truth) <= OWN * size, "{t}");
            let (piece, place) = curve.knots().locate(t);
            assert!(distance(path.at(piece as f64 + place), truth) <= OWN * size + path.slack(), "{t}");
        }
    }
}

#[test]
fn weights_that_balance_a_small_share_of_a_knot_cost_no_digits() {
    let spline = Spline {
        degree: 2,
        knots: vec![0.0, 0.0, 0.0, 0.7, 0.700_000_01, 2.0, 2.0, 2.0],
        control: [[2.0, -3.0], [0.0, 0.0], [-2.0, -2.0], [3.0, 1.0], [1.0, -3.0]]
            .map(|[x, y]| [x, y, 0.0])
            .to_vec(),
        weights: vec![1.0, 115_970_773.0, 1.0, 115_970_773.0, 115_970_773.0],
    };
    let path = spline.curve().to_curve().unwrap();
    for k in 0..=60 {
        let place = f64::from(k) / 20.0;
        // Within the narrow piece its places are known to eight digits only.
        if place <= 1.0 || place >= 2.0 {
            let truth = spline.at_place(place / 3.0);
            assert!(distance(path.at(place), truth) <= 1e-14 + path.slack(), "{place}");
        }
    }
}

#[test]
fn pixels_are_met_with_and_without_a_near_plane() {
    let torus = NurbsSurface::torus(2.0, 0.5).unwrap();
    for near in [0.0, 0.5] {
        let view = View::Camera(Camera {
            eye: [8.0, 1.0, 3.0],
            target: [0.0; 3],
            up: [0.0, 0.0, 1.0],
            near,
            projection: Projection::Perspective { fov_y_deg: 45.0 },
            screen: Screen { width_px: 1280, height_px: 720 },
        });
        let budget = Budget::pixels(Pixels::new(1.0).unwrap(), view);
        let made = convert::nurbs_to_mesh(std::slice::from_ref(&torus), &budget, &Job::default()).unwrap();
        let pixels = made.bound.pixels.unwrap();
        assert!(pixels <= 1.0 && pixels > 0.5, "{near}: {pixels}");
    }
}

#[test]
fn counts_are_kept_and_weights_of_any_size_end_in_an_answer() {
    let torus = NurbsSurface::torus(2.0, 0.5).unwrap();
    for most in [120, 1000, 20_000] {
        let made =
            convert::nurbs_to_mesh(std::slice::from_ref(&torus), &Budget::triangles(most), &Job::default());
        let count = made.unwrap().shape.faces().len() as u64;
        assert!(count <= most && count * 3 > most, "{most}: {count}");
    }
    let knots = || KnotVector::clamped(1, 2).unwrap();
    let far = [[9e149, 0.0, 0.0], [0.0, 9e149, 0.0], [0.0; 3], [1.0, 0.0, 9e149]].to_vec();
    let surface = NurbsSurface::new([knots(), knots()], far, vec![1e6, 1.0, 1e-20, 1e20]).unwrap();
    let made =
        convert::nurbs_to_mesh(&[surface], &Budget::length(Tolerance::new(1e148).unwrap()), &Job::default());
    assert!(made.is_ok() || made.is_err_and(|failure| !failure.to_string().is_empty()));
    assert!(KnotVector::new(1, vec![-1e308, -1e308, 1e308, 1e308]).is_err());
}

#[test]
fn no_spline_is_farther_from_its_polyline_than_the_bound() {
    let mut random = Random::new(502);
    let mut ratios = Vec::new();
    for _ in 0..cases(200) {
        let spline = Spline::random(&mut random);
        let size = largest(&spline.control);
        let length = random.power(-3.0, -1.0) * size;
        let budget = Budget::length(Tolerance::new(length).unwrap());
        let curve = spline.curve().to_curve().unwrap();
        let Bounded { shape, bound } = convert::curve_to_polyline(&curve, &budget, &Job::default()).unwrap();
        let at_most = bound.at_most().unwrap();
        assert!(at_most <= length);
        let found = measured(&spline, &shape);
        assert!(
            found.iter().all(|off| *off <= at_most + OWN * size),
            "{found:?} {at_most} of degree {} {:?} {:?}",
            spline.degree,
            spline.control,
            spline.weights
        );
        assert!(bound.at_least() <= found[0].max(found[1]) + OWN * size + 0.02 * at_most);
        ratios.push(at_most / found[0].max(found[1]));
    }
    ratios.sort_by(f64::total_cmp);
    // Pieces are spread by a density, as those of cubics are, whose median is the same.
    let median = ratios[ratios.len() / 2];
    assert!(median < 1.25, "{median}");
}

struct Sheet {
    degrees: [usize; 2],
    knots: [Vec<f64>; 2],
    control: Vec<[f64; 3]>,
    weights: Vec<f64>,
}

impl Sheet {
    /// Heights over a lattice that is bent itself, so that most do not cross themselves; any weights.
    fn random(random: &mut Random) -> Self {
        let degrees = [0; 2].map(|_| 1 + random.below(5));
        let counts = degrees.map(|p| p + 1 + random.below(4));
        let knots = [0, 1].map(|k| random_knots(random, degrees[k], counts[k]));
        let scale = random.power(-3.0, 3.0);
        let weights = random_weights(random, counts[0] * counts[1]);
        let mut control = Vec::new();
        for j in 0..counts[1] {
            for i in 0..counts[0] {
                let off: [f64; 3] = random.point_within(0.6 * scale);
                control.push([i as f64 * scale + off[0], j as f64 * scale + off[1], off[2]]);
            }
        }
        Self { degrees, knots, control, weights }
    }

    fn surface(&self) -> NurbsSurface {
        let knots = [0, 1].map(|k| KnotVector::new(self.degrees[k], self.knots[k].clone()).unwrap());
        NurbsSurface::new(knots, self.control.clone(), self.weights.clone()).unwrap()
    }

    /// The point at two parameters from 0 to 1 over the whole domain.
    fn at(&self, place: [f64; 2]) -> [f64; 3] {
        self.at_parameters(std::array::from_fn(|k| parameter(&self.knots[k], self.degrees[k], place[k])))
    }

    fn at_parameters(&self, at: [f64; 2]) -> [f64; 3] {
        let [u, v] = [0, 1].map(|k| basis(&self.knots[k], self.degrees[k], at[k]));
        let factors = v.iter().flat_map(|b| u.iter().map(move |a| a * b));
        mean(factors.zip(&self.weights).map(|(f, w)| f * w), &self.control)
    }
}

/// The largest distances found: of samples of the sheet from the triangles, and of the triangles from the sheet.
fn measured_sheet(sheet: &Sheet, mesh: &Mesh, random: &mut Random) -> [f64; 2] {
    let triangles = Triangles::new(mesh.positions(), mesh.faces());
    // By direction: halved until steps are short at some places of the other.
    let close = largest(&sheet.control) / 24.0;
    let [along_u, along_v] = [0, 1].map(|k| {
        let is_far = |[a, b]: [f64; 2]| {
            (0..=6).any(|i| {
                let at =
                    |t: f64| sheet.at(if k == 0 { [t, f64::from(i) / 6.0] } else { [f64::from(i) / 6.0, t] });
                distance(at(a), at(b)) > close
            })
        };
        refined((0..=16).map(|i| f64::from(i) / 16.0).collect(), is_far, 64)
    });
    let [n, m] = [along_u.len(), along_v.len()];
    let places: Vec<[f64; 2]> = along_v.iter().flat_map(|v| along_u.iter().map(|u| [*u, *v])).collect();
    let step_at = |k: usize| {
        let of = |all: &[f64], i: usize| all[(i + 1).min(all.len() - 1)] - all[i.saturating_sub(1)];
        f64::max(of(&along_u, k % n), of(&along_v, k / n))
    };
    let samples: Vec<[f64; 3]> = places.iter().map(|place| sheet.at(*place)).collect();
    let mut offs: Vec<(f64, usize)> =
        samples.iter().enumerate().map(|(k, p)| (triangles.distance(*p), k)).collect();
    offs.sort_by(|a, b| b.0.total_cmp(&a.0));
    let up = |(off, k): &(f64, usize)| {
        climb(places[*k], *off, (0.5 * step_at(*k), 8), |place| triangles.distance(sheet.at(place))).0
    };
    let there = offs.iter().take(6).map(up).fold(0.0, f64::max);
    let mut back = 0.0;
    for _ in 0..8 {
        let corners = triangles.corners[random.below(triangles.corners.len())];
        let p = on(corners, random.weights());
        let offs: Vec<f64> = samples.iter().map(|q| distance(*q, p)).collect();
        let around = |k: usize| {
            let near = |i: usize, n: usize| i.saturating_sub(1)..=(i + 1).min(n - 1);
            near(k / n, m).flat_map(move |j| near(k % n, n).map(move |i| j * n + i))
        };
        let mut starts: Vec<usize> =
            (0..samples.len()).filter(|k| around(*k).all(|other| offs[*k] <= offs[other])).collect();
        starts.sort_by(|i, j| offs[*i].total_cmp(&offs[*j]));
        let foot = |k: &usize| descend(places[*k], step_at(*k), |place| distance(sheet.at(place), p));
        let off = starts.iter().take(4).map(foot).fold(f64::INFINITY, f64::min);
        back = f64::max(back, off);
    }
    [there, back]
}

/// The least value that is found from a place downhill; a step is halved where none goes down.
fn descend(mut at: [f64; 2], mut step: f64, of: impl Fn([f64; 2]) -> f64) -> f64 {
    let mut best = of(at);
    while step > 1e-6 {
        let around = (0..16).map(|k| {
            let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_8).sin_cos();
            [at[0] + step * cos, at[1] + step * sin].map(|x| x.clamp(0.0, 1.0))
        });
        let next = around.map(|place| (of(place), place)).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        if next.0 < best {
            (best, at) = next;
        } else {
            step *= 0.5;
        }
    }
    best
}

#[test]
fn no_surface_is_farther_from_its_mesh_than_the_bound() {
    let mut random = Random::new(503);
    let mut ratios = Vec::new();
    for _ in 0..if chordal_testkit::is_long() { 160 } else { 8 } {
        let sheet = Sheet::random(&mut random);
        let (surface, size) = (sheet.surface(), largest(&sheet.control));
        let length = random.power(-2.7, -1.3) * size;
        let budget = Budget::length(Tolerance::new(length).unwrap());
        let made = convert::nurbs_to_mesh(&[surface], &budget, &Job::default()).unwrap();
        let at_most = made.bound.at_most().unwrap();
        assert!(at_most <= length);
        let found = measured_sheet(&sheet, &made.shape, &mut random);
        // A descent ends a millionth of its parameters beside the foot.
        let spare = 1e-5 * at_most + 1e-7 * size;
        assert!(
            found[0] <= at_most + OWN * size && found[1] <= at_most + spare,
            "{found:?} {at_most} {length} of {:?} {:?} {:?} {:?}",
            sheet.degrees,
            sheet.knots,
            sheet.control,
            sheet.weights
        );
        ratios.push(at_most / found[0].max(found[1]).max(1e-300));
        let valid = check::validity(&made.shape, Topology::Indices);
        assert!(valid.edge_manifold && valid.oriented && valid.boundary_loops == 1, "{valid:?}");
    }
    ratios.sort_by(f64::total_cmp);
    let median = ratios[ratios.len() / 2];
    // Measured: 2.8; meshes of few triangles and weights of up to 400 times each other have up to 7.
    assert!(median < 3.5, "{median}");
}
