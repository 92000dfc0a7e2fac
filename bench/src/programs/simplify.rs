//! Simplifying meshes, timed: `simplify make DIR` writes the inputs. `simplify run SIDE THREADS MESH OUT AIM
//! TIMES` makes one mesh coarser, so many times, and prints the median of the times; SIDE is `ours`,
//! `meshopt` or `meshopt-update`, AIM `count=N`, `best=N` or `error=LENGTH`. Of a count `ours` does the least
//! work, or its best; the others have one. `simplify chain SIDE THREADS MESH FROM`
//! makes levels of half the triangles each, FROM the `source` or the `last` one; for `ours` also `errors`:
//! levels by their errors. `simplify judge MESH OTHER [MAX]` proves how far two meshes are apart, and looks
//! at the second.
use chordal::budget::{Failure, Tolerance};
use chordal::check::{Goal, deviation, validity};
use chordal::explicit::Topology;
use chordal::lod::count::{Effort, simplify_to_count};
use chordal::lod::{self, LodSource, LodSteps};
use chordal::{Budget, Job, Mesh};
use chordal_bench::{read, shapes, write};
use meshopt::{SimplifyOptions, VertexDataAdapter, simplify, simplify_with_update, typed_to_bytes};
use serde_json::{Value, json};
use std::path::Path;
use std::time::Instant;

/// What is asked for.
#[derive(Clone, Copy)]
enum Aim {
    Count(usize, Effort),
    Length(f64),
}

/// A coarser mesh, how long it took, and the error that its maker says, as a length.
struct Made {
    mesh: Mesh,
    seconds: f64,
    declared: Option<f64>,
}

/// Chordal: the clock runs around the one call, its proof included.
fn ours(mesh: &Mesh, aim: Aim, job: &Job) -> Made {
    let start = Instant::now();
    let tried = match aim {
        Aim::Count(count, effort) => simplify_to_count(mesh, count as u64, effort, Topology::Indices, job),
        Aim::Length(length) => {
            let budget = Budget::length(Tolerance::new(length).expect("a length"));
            chordal::lod::simplify(mesh, &budget, Topology::Indices, job)
        }
    };
    let made = match tried {
        Ok(made) => made,
        Err(Failure::Unmet(best)) => *best,
        Err(other) => panic!("{other:?}"),
    };
    let seconds = start.elapsed().as_secs_f64();
    Made { mesh: made.shape.mesh, seconds, declared: made.bound.at_most() }
}

/// Chordal's own levels: from the error of half the triangles on, which is found before the clock starts,
/// each twice as far off, until [`LEAST`].
fn our_levels(mesh: &Mesh, job: &Job) -> (f64, Vec<Mesh>) {
    let half = ours(mesh, Aim::Count(mesh.faces().len() / 2, Effort::Fast), job).declared.expect("proved");
    let steps = LodSteps { stop_at_triangles: LEAST, ..LodSteps::from_finest(Tolerance::new(half).expect("a length")) };
    let start = Instant::now();
    let levels = lod::chain(LodSource::Triangles(mesh, Topology::Indices), &steps, job).expect("proved");
    (start.elapsed().as_secs_f64(), levels.into_iter().map(|level| level.mesh).collect())
}

/// A chain ends at the first level with so many triangles or fewer; chosen, so that a million makes ten
/// levels.
const LEAST: usize = 1000;

fn open(path: &str) -> Mesh {
    let (positions, faces) = read(Path::new(path)).expect("a mesh that was written here").remove(0);
    Mesh::new(positions, faces).expect("valid")
}

fn save(path: &Path, mesh: &Mesh) {
    let mut file = std::io::BufWriter::new(std::fs::File::create(path).expect("writable"));
    write(&mut file, mesh.positions(), mesh.faces()).expect("writable");
}

fn make(folder: &Path) {
    std::fs::create_dir_all(folder).expect("writable");
    let put = |name: &str, mesh: &Mesh| save(&folder.join(format!("{name}.mesh")), mesh);
    put("torus", &shapes::torus([400, 200], 0.0));
    put("bumpy", &shapes::torus([400, 200], 0.1));
    put("sphere", &shapes::sphere(7));
    put("lobes", &shapes::lobes(7));
    put("gear", &shapes::gear(10, 100));
    put("shaft", &shapes::shaft(5000));
    put("plate", &shapes::plate(1000));
    put("tray", &shapes::tray(100, 0.002));
    put("heights", &shapes::heights([1000, 500], 2e-4)); // measured against cells of 0.001 by 0.002
    put("million", &shapes::torus([1000, 500], 0.1));
}

/// The vertices that faces name, in the order in which they name them.
fn compact(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> Mesh {
    let (mut row, mut kept) = (vec![u32::MAX; positions.len()], Vec::new());
    let mut renamed = |i: u32| {
        let to = &mut row[i as usize];
        if *to == u32::MAX {
            *to = kept.len() as u32;
            kept.push(positions[i as usize]);
        }
        *to
    };
    let faces = faces.iter().map(|face| face.map(&mut renamed)).collect();
    Mesh::new(kept, faces).expect("valid")
}

/// meshoptimizer: positions in f32, errors as lengths. The conversion of its input and output is not timed.
fn meshopt(mesh: &Mesh, aim: Aim, update: bool) -> Made {
    let mut positions: Vec<[f32; 3]> = mesh.positions().iter().map(|p| p.map(|x| x as f32)).collect();
    let (count, length) = match aim {
        Aim::Count(count, _) => (3 * count, f32::MAX),
        Aim::Length(length) => (0, length as f32),
    };
    let (options, mut error) = (SimplifyOptions::ErrorAbsolute, 0.0);
    let mut indices = mesh.faces().as_flattened().to_vec();
    let start;
    if update {
        start = Instant::now();
        let n = simplify_with_update(
            &mut indices,
            &mut positions,
            &mut [],
            &[],
            0,
            None,
            count,
            length,
            options,
            Some(&mut error),
        );
        indices.truncate(n);
    } else {
        let vertices = VertexDataAdapter::new(typed_to_bytes(&positions), 12, 0).expect("twelve bytes each");
        start = Instant::now();
        indices = simplify(&indices, &vertices, count, length, options, Some(&mut error));
    }
    let seconds = start.elapsed().as_secs_f64();
    let positions: Vec<[f64; 3]> = positions.iter().map(|p| p.map(f64::from)).collect();
    Made { mesh: compact(&positions, indices.as_chunks().0), seconds, declared: Some(f64::from(error)) }
}

fn made(side: &str, mesh: &Mesh, aim: Aim, job: &Job) -> Made {
    match side {
        "ours" => ours(mesh, aim, job),
        "meshopt" => meshopt(mesh, aim, false),
        "meshopt-update" => meshopt(mesh, aim, true),
        _ => panic!("nobody is called {side}"),
    }
}

fn run([side, threads, from, to, aim, times]: [&str; 6]) -> Value {
    let job = Job::default().with_threads(threads.parse().expect("a number"));
    let aim = match aim.split_once('=') {
        Some(("count", count)) => Aim::Count(count.parse().expect("a number"), Effort::Fast),
        Some(("best", count)) => Aim::Count(count.parse().expect("a number"), Effort::Best),
        Some(("error", length)) => Aim::Length(length.parse().expect("a length")),
        _ => panic!("AIM is count=N, best=N or error=LENGTH"),
    };
    let mesh = open(from);
    let mut all = Vec::new();
    for _ in 0..times.parse().expect("a number") {
        all.push(made(side, &mesh, aim, &job));
    }
    all.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let middle = &all[all.len() / 2];
    save(Path::new(to), &middle.mesh);
    json!({ "seconds": middle.seconds, "declared": middle.declared, "triangles": middle.mesh.faces().len() })
}

/// A line of `/proc/self/status`, in bytes.
fn status(name: &str) -> u64 {
    let text = std::fs::read_to_string("/proc/self/status").expect("Linux");
    let line = text.lines().find(|line| line.starts_with(name)).expect("the line");
    line.split_whitespace().nth(1).and_then(|n| n.parse::<u64>().ok()).expect("a number") * 1024
}

fn bytes(mesh: &Mesh) -> u64 {
    (24 * mesh.positions().len() + 12 * mesh.faces().len()) as u64
}

/// Levels of half the triangles each until there are [`LEAST`].
fn levels(side: &str, mesh: &Mesh, last: bool, job: &Job) -> (f64, Vec<Mesh>) {
    let (mut seconds, mut all, mut count) = (0.0, Vec::<Mesh>::new(), mesh.faces().len());
    while count > LEAST {
        count /= 2;
        let from = all.last().filter(|_| last).unwrap_or(mesh);
        let level = made(side, from, Aim::Count(count, Effort::Fast), job);
        seconds += level.seconds;
        all.push(level.mesh);
    }
    (seconds, all)
}

/// Time and memory of a chain. The peak is what the process grew by from where it had read the mesh, and that
/// mesh.
fn chain([side, threads, path, from]: [&str; 4]) -> Value {
    let job = Job::default().with_threads(threads.parse().expect("a number"));
    let mesh = open(path);
    // Linux: 5 sets the peak to what is held now.
    std::fs::write("/proc/self/clear_refs", "5").expect("Linux");
    let before = status("VmRSS");
    let (seconds, levels) = match (side, from) {
        ("ours", "errors") => our_levels(&mesh, &job),
        _ => levels(side, &mesh, from == "last", &job),
    };
    let peak = status("VmHWM").saturating_sub(before) + bytes(&mesh);
    let whole = bytes(&mesh) + levels.iter().map(bytes).sum::<u64>();
    let triangles: Vec<_> = levels.iter().map(|level| level.faces().len()).collect();
    json!({ "seconds": seconds, "triangles": triangles, "peak": peak, "bytes": whole })
}

fn judge(a: &str, b: &str, max: Option<&str>) -> Value {
    let (a, b) = (open(a), open(b));
    let max = max.map(|max| Tolerance::new(max.parse().expect("a length")).expect("a length"));
    // To a hundredth, so that it decides between programs that differ by a few hundredths.
    let goal = Goal { relative: 0.01, max, ..Goal::default() };
    let Ok(found) = deviation(&a, &b, &goal, &Job::default()) else {
        return json!({ "at_least": null, "at_most": null, "triangles": b.faces().len() });
    };
    let [before, after] = [&a, &b].map(|mesh| validity(mesh, Topology::Indices));
    json!({
        "at_least": found.bound.at_least(), "at_most": found.bound.at_most(),
        "forward": found.forward.at_most, "backward": found.backward.at_most, "triangles": after.triangles,
        "was_manifold": before.manifold(), "manifold": after.manifold(), "was_closed": before.closed,
        "closed": after.closed, "was_oriented": before.oriented, "oriented": after.oriented,
        "was_euler": before.euler, "euler": after.euler, "components": after.components,
        "bad_edges": after.non_manifold_edges.count, "bad_vertices": after.non_manifold_vertices.count,
        "boundary_edges": after.boundary_edges.count, "zero_area": after.zero_area_faces.count,
    })
}

pub fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let answer = match args[..] {
        ["make", folder] => return make(Path::new(folder)),
        ["run", side, threads, from, to, aim, times] => run([side, threads, from, to, aim, times]),
        ["chain", side, threads, mesh, from] => chain([side, threads, mesh, from]),
        ["judge", a, b] => judge(a, b, None),
        ["judge", a, b, max] => judge(a, b, Some(max)),
        _ => panic!("simplify make | run | chain | judge, as its first lines say"),
    };
    println!("{answer}");
}
