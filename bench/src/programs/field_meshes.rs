//! The bench of fields to triangles: each call prints one line of JSON.
//!
//! `ours MODEL THREADS LENGTH OUT` meshes within the length, proved; `fidget MODEL THREADS DEPTH OUT` runs
//! its mesher with machine code; `text MODEL` gives its op list; `judge MODEL MESH` measures a mesh that
//! anybody wrote, by samples that share nothing with the proof. A model is a name or a file.
use chordal::budget::{Failure, Tolerance};
use chordal::explicit::Topology;
use chordal::explicit::query::Bvh;
use chordal::implicit::evaluation::{Dual, Tape};
use chordal::{Budget, Job, Mesh, check, convert};
use chordal_bench::scripts::Model;
use chordal_bench::{read, write};
use fidget::context::Context;
use fidget::jit::JitShape;
use fidget::mesh::{Octree, Settings};
use fidget::render::ThreadPool;
use nalgebra::Matrix4;
use serde_json::{Value, json};
use std::path::Path;
use std::time::Instant;

type Point = [f64; 3];

/// Points of the surface that a mesh is measured from: crossings of a lattice of so many steps along a side;
/// fewer for long expressions, so that measuring does not take minutes.
const LATTICES: [usize; 2] = [160, 64];
/// Steps of a tape from which on it is long.
const LONG_TAPE: usize = 1000;
/// Halvings of a step that holds a crossing: to the last place of the step.
const HALVINGS: usize = 50;
/// Points about which crossings are looked for all around at most, farthest first, along so many ways, and so
/// often closer about the best one.
const MOST_LOOKED_AROUND: usize = 20_000;
const WAYS: usize = 256;
const CLOSER: usize = 5;
/// Runs whose median is told, of those that are short.
const RUNS: usize = 3;
/// Seconds of a run that is not repeated.
const LONG: f64 = 5.0;

fn timed<T>(mut work: impl FnMut() -> T) -> (f64, T) {
    let mut seconds = Vec::new();
    let mut last = None;
    while seconds.len() < RUNS && seconds.first().is_none_or(|first| *first < LONG) {
        drop(last.take());
        let start = Instant::now();
        last = Some(work());
        seconds.push(start.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    (seconds[seconds.len() / 2], last.expect("a run"))
}

fn keep(path: &str, positions: &[Point], faces: &[[u32; 3]]) {
    let mut file = std::io::BufWriter::new(std::fs::File::create(path).expect("a file to write"));
    write(&mut file, positions, faces).expect("room on the disk");
}

fn ours(model: &Model, threads: usize, length: f64, out: &str) -> Value {
    let budget = Budget::length(Tolerance::new(length).expect("a length"));
    let job = Job::default().with_threads(threads);
    let (seconds, made) = timed(|| convert::field_to_mesh(&model.field, &budget, &job));
    match made {
        Ok(made) => {
            keep(out, made.shape.positions(), made.shape.faces());
            json!({ "seconds": seconds, "triangles": made.shape.faces().len(), "most": made.bound.at_most() })
        }
        Err(Failure::Unmet(made)) => {
            keep(out, made.shape.positions(), made.shape.faces());
            let n = made.shape.faces().len();
            json!({ "seconds": seconds, "triangles": null, "most": null, "failure": "unmet", "had": n })
        }
        Err(failure) => {
            json!({ "seconds": seconds, "triangles": null, "most": null, "failure": failure.to_string() })
        }
    }
}

fn fidget(model: &Model, threads: usize, depth: u8, out: &str) -> Value {
    let Some(text) = &model.text else {
        return json!({ "seconds": null, "triangles": null, "failure": "no op list" });
    };
    let (context, root) = Context::from_text(text.as_bytes()).expect("an op list");
    let (middle, half) = model.cube;
    let (seconds, mesh) = timed(|| {
        // Compiling is part of the job: it is done once for a shape.
        let shape =
            JitShape::new(&context, root).expect("a shape").try_into().expect("no variables but the axes");
        let pool = ThreadPool::Global;
        let world_to_model =
            Matrix4::new_translation(&middle.map(|x| x as f32).into()) * Matrix4::new_scaling(half as f32);
        let settings = Settings {
            depth,
            world_to_model,
            threads: (threads > 1).then_some(&pool),
            ..Settings::default()
        };
        Octree::build(&shape, &settings).expect("not cancelled").walk_dual()
    });
    let positions: Vec<Point> = mesh.vertices.iter().map(|p| [p.x, p.y, p.z].map(f64::from)).collect();
    let faces: Vec<[u32; 3]> = mesh.triangles.iter().map(|t| [t.x, t.y, t.z].map(|i| i as u32)).collect();
    keep(out, &positions, &faces);
    json!({ "seconds": seconds, "triangles": faces.len() })
}

/// The values of a field at many points.
fn values(tape: &Tape, points: &[Point]) -> Vec<f64> {
    let mut out = vec![0.0; points.len()];
    tape.at(points, &mut out).expect("no leaf");
    out
}

/// Points of the surface between each two points of different sides, by halving.
fn crossings(tape: &Tape, mut ends: Vec<[Point; 2]>) -> Vec<Point> {
    let firsts: Vec<Point> = ends.iter().map(|e| e[0]).collect();
    let inside: Vec<bool> = values(tape, &firsts).iter().map(|v| *v < 0.0).collect();
    for _ in 0..HALVINGS {
        let middles: Vec<Point> =
            ends.iter().map(|[a, b]| std::array::from_fn(|k| 0.5 * (a[k] + b[k]))).collect();
        for (k, value) in values(tape, &middles).iter().enumerate() {
            let same = (*value < 0.0) == inside[k];
            ends[k][usize::from(!same)] = middles[k];
        }
    }
    ends.into_iter().map(|e| e[0]).collect()
}

/// Points of the surface on the edges of a lattice.
fn surface_points(tape: &Tape, (middle, half): (Point, f64)) -> Vec<Point> {
    let steps = LATTICES[usize::from(tape.len() >= LONG_TAPE)];
    let at = |k: usize, i: usize| middle[k] + half * (2.0 * i as f64 / steps as f64 - 1.0);
    let layer = |z: usize| -> Vec<Point> {
        (0..=steps).flat_map(|y| (0..=steps).map(move |x| [at(0, x), at(1, y), at(2, z)])).collect()
    };
    let row = steps + 1;
    let mut ends = Vec::new();
    let mut below: Option<(Vec<Point>, Vec<f64>)> = None;
    for z in 0..=steps {
        let points = layer(z);
        let here = values(tape, &points);
        for k in 0..points.len() {
            let mut cut = |other: Point, value: f64| {
                if (value < 0.0) != (here[k] < 0.0) {
                    ends.push([points[k], other]);
                }
            };
            if (k + 1) % row != 0 {
                cut(points[k + 1], here[k + 1]);
            }
            if k + row < points.len() {
                cut(points[k + row], here[k + row]);
            }
            if let Some((points, values)) = &below {
                cut(points[k], values[k]);
            }
        }
        below = Some((points, here));
    }
    crossings(tape, ends)
}

/// How far the farthest of some points is from the surface: along the gradient to the next crossing, or to
/// the next of some points of the surface, whichever is less; where that would be the farthest, along many
/// other ways.
fn distances(tape: &Tape, points: &[Point], surface: &[Point]) -> f64 {
    // A cloud of points is a mesh of triangles without extent.
    let faces = (0..surface.len() as u32).map(|i| [i; 3]).collect();
    let cloud = Mesh::new(surface.to_vec(), faces).expect("valid");
    let bvh = Bvh::build(&cloud, &Job::default()).expect("small");
    let near = bvh.closest_points(points, &Job::default());
    let mut slopes = vec![Dual { value: 0.0, gradient: [0.0; 3] }; points.len()];
    tape.gradient_at(points, &mut slopes).expect("no leaf");
    // From each point down the slope, as far as the next known point is: then the side has changed or this
    // way is no better.
    let mut most: Vec<f64> = points
        .iter()
        .zip(&near)
        .map(|(p, c)| c.as_ref().map_or(f64::INFINITY, |c| apart(c.point, *p)))
        .collect();
    let mut left = Vec::new();
    for (k, slope) in slopes.iter().enumerate() {
        let [x, y, z] = slope.gradient;
        let length = (x * x + y * y + z * z).sqrt();
        if slope.value == 0.0 {
            most[k] = 0.0;
        } else if length > 0.0 {
            left.push((k, slope.gradient.map(|g| -slope.value.signum() * g / length), slope.value < 0.0));
        }
    }
    let (mut which, mut ends) = (Vec::new(), Vec::new());
    // A share of the way that doubles, so that the first crossing is not passed from afar.
    let mut share = 1.0 / 64.0;
    while share <= 1.0 && !left.is_empty() {
        let there: Vec<Point> = left
            .iter()
            .map(|(k, d, _)| std::array::from_fn(|i| points[*k][i] + share * most[*k] * d[i]))
            .collect();
        let after = values(tape, &there);
        let mut next = Vec::new();
        for (one, (end, value)) in left.into_iter().zip(there.iter().zip(after)) {
            if (value < 0.0) == one.2 {
                next.push(one);
            } else {
                which.push(one.0);
                ends.push([points[one.0], *end]);
            }
        }
        left = next;
        share *= 2.0;
    }
    for (k, found) in which.into_iter().zip(crossings(tape, ends)) {
        let far = apart(points[k], found);
        most[k] = if far < most[k] { far } else { most[k] };
    }
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_unstable_by(|a, b| most[*b].total_cmp(&most[*a]));
    let mut farthest = 0.0;
    for (n, k) in order.into_iter().enumerate() {
        if most[k] <= farthest || n == MOST_LOOKED_AROUND {
            farthest = if most[k] > farthest { most[k] } else { farthest };
            break;
        }
        let far = looked_around(tape, points[k], most[k]);
        farthest = if far > farthest { far } else { farthest };
    }
    farthest
}

/// How far a point is from the next crossing along many ways, if that is less than it seems: first all
/// around, then about the best one.
fn looked_around(tape: &Tape, p: Point, seems: f64) -> f64 {
    let (mut best, mut towards): (f64, Option<Point>) = (seems, None);
    let is_inside = values(tape, &[p])[0] < 0.0;
    let mut spread = 1.0;
    for _ in 0..CLOSER {
        let ways: Vec<Point> = sphere_points(WAYS)
            .into_iter()
            .map(|d| match towards {
                None => d,
                Some(t) => unit(std::array::from_fn(|k| t[k] + spread * d[k])),
            })
            .collect();
        for share in [0.25, 0.5, 0.75, 1.0] {
            let far = share * best;
            let there: Vec<Point> = ways.iter().map(|d| std::array::from_fn(|k| p[k] + far * d[k])).collect();
            let after = values(tape, &there);
            let crossed: Vec<usize> = (0..ways.len()).filter(|k| (after[*k] < 0.0) != is_inside).collect();
            let ends = crossed.iter().map(|k| [p, there[*k]]).collect();
            let found = crossings(tape, ends);
            if found.is_empty() {
                continue;
            }
            for (k, at) in crossed.into_iter().zip(found) {
                if apart(p, at) < best {
                    (best, towards) = (apart(p, at), Some(ways[k]));
                }
            }
            break;
        }
        spread *= if towards.is_some() { 0.25 } else { 1.0 };
    }
    best
}

/// Points about evenly on the unit sphere: Fibonacci's lattice.
fn sphere_points(n: usize) -> Vec<Point> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let of = |i: usize| {
        let z = 1.0 - (2 * i + 1) as f64 / n as f64;
        let (sin, cos) = (golden * i as f64).sin_cos();
        let r = (1.0 - z * z).sqrt();
        [r * cos, r * sin, z]
    };
    (0..n).map(of).collect()
}

fn unit(d: Point) -> Point {
    let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
    d.map(|x| x / length)
}

fn apart(a: Point, b: Point) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

fn judge(model: &Model, path: &str) -> Value {
    let (positions, faces) = read(Path::new(path)).expect("a mesh").swap_remove(0);
    let mesh = Mesh::new(positions, faces).expect("valid");
    let tape = Tape::new(model.field.sign());
    let job = Job::default();
    let bvh = Bvh::build(&mesh, &job).expect("small");
    let surface = surface_points(&tape, model.cube);
    let found = bvh.closest_points(&surface, &job);
    let to_mesh = found.iter().zip(&surface).fold(0.0, |most, (c, p)| {
        let far = c.as_ref().map_or(f64::INFINITY, |c| apart(c.point, *p));
        if far > most { far } else { most }
    });
    let stride = (mesh.faces().len() / 200_000).max(1);
    let samples: Vec<Point> = (0..mesh.faces().len())
        .step_by(stride)
        .flat_map(|face| {
            let [a, b, c] = mesh.corners(face);
            let mixed = |u: f64, v: f64| -> Point {
                std::array::from_fn(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]))
            };
            [
                (0.0, 0.0),
                (1.0 / 3.0, 1.0 / 3.0),
                (0.5, 0.0),
                (0.5, 0.5),
                (0.0, 0.5),
                (0.15, 0.15),
                (0.7, 0.15),
                (0.15, 0.7),
            ]
            .map(|(u, v)| mixed(u, v))
        })
        .collect();
    let from_mesh = distances(&tape, &samples, &surface);
    let valid = check::validity(&mesh, Topology::Indices);
    json!({
        "error": if to_mesh > from_mesh { to_mesh } else { from_mesh },
        "to_mesh": to_mesh, "from_mesh": from_mesh, "closed": valid.closed, "manifold": valid.manifold(),
        "triangles": mesh.faces().len(),
    })
}

pub fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let number = |text: &str| text.parse::<f64>().expect("a number");
    let said = match words[..] {
        ["ours", name, threads, length, out] => {
            ours(&Model::named(name), number(threads) as usize, number(length), out)
        }
        ["fidget", name, threads, depth, out] => {
            fidget(&Model::named(name), number(threads) as usize, number(depth) as u8, out)
        }
        ["prove", name, path] => {
            let (positions, faces) = read(Path::new(path)).expect("a mesh").swap_remove(0);
            let mesh = Mesh::new(positions, faces).expect("valid");
            let field = Model::named(name).field;
            let max = Some(Tolerance::new(0.01).expect("a length"));
            let goal = check::Goal { max, ..check::Goal::default() };
            let found = check::field_deviation(&mesh, &field, &goal, &Job::default()).expect("answers");
            json!(format!("{found:?}"))
        }
        ["text", name] => json!({ "text": Model::named(name).text }),
        ["judge", name, path] => judge(&Model::named(name), path),
        _ => panic!("field_meshes ours|fidget|text|judge MODEL ..."),
    };
    println!("{said}");
}
