//! One job on meshes, timed: `meshes JOB THREADS MESH [MESH]` prints a line of JSON with the median of the
//! times and what was found. `meshes make DIR` writes the inputs, in the plain format that `read` reads and
//! numpy too.
use chordal::budget::Tolerance;
use chordal::check::{Goal, deviation, self_intersections, validity};
use chordal::explicit::{Topology, position_id_by_bits, vertex_normals};
use chordal::explicit::query::{Bvh, Ray};
use chordal::{Job, Mesh};
use chordal_bench::torus;
use serde_json::{Value, json};
use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

type Point = [f64; 3];

/// Three vertices of its own for each triangle.
fn soup(mesh: &Mesh) -> Mesh {
    let positions = mesh.faces().as_flattened().iter().map(|i| mesh.positions()[*i as usize]).collect();
    let faces = (0..mesh.faces().len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh::new(positions, faces).expect("valid")
}

/// Random numbers that are the same everywhere: an LCG, of which the upper bits are taken.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn moved(mesh: &Mesh, by: f64) -> Mesh {
    let mut random = Random(1);
    let off = |p: &Point| -> Point { std::array::from_fn(|k| p[k] + by * (2.0 * random.unit() - 1.0)) };
    let positions = mesh.positions().iter().map(off).collect();
    Mesh::new(positions, mesh.faces().to_vec()).expect("valid")
}

/// Two meshes as one.
fn both(a: &Mesh, b: &Mesh) -> Mesh {
    let first = a.positions().len() as u32;
    let shifted = b.faces().iter().map(|face| face.map(|i| i + first));
    let faces = a.faces().iter().copied().chain(shifted).collect();
    Mesh::new([a.positions(), b.positions()].concat(), faces).expect("valid")
}

fn write(path: &Path, mesh: &Mesh) {
    let mut bytes = Vec::new();
    bytes.extend((mesh.positions().len() as u64).to_le_bytes());
    bytes.extend((mesh.faces().len() as u64).to_le_bytes());
    mesh.positions().as_flattened().iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    mesh.faces().as_flattened().iter().for_each(|i| bytes.extend(i.to_le_bytes()));
    fs::write(path, bytes).expect("writable");
}

fn read(path: &str) -> Mesh {
    let bytes = fs::read(path).expect("a mesh that 'make' wrote");
    let count = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().expect("8 bytes")) as usize;
    let (n, m) = (count(0), count(8));
    let (points, faces) = bytes[16..].split_at(24 * n);
    let number = |bytes: &[u8]| f64::from_le_bytes(bytes.try_into().expect("8 bytes"));
    let index = |bytes: &[u8]| u32::from_le_bytes(bytes.try_into().expect("4 bytes"));
    let points = points.chunks(24).map(|p| [&p[..8], &p[8..16], &p[16..]].map(number)).collect();
    let faces: Vec<_> = faces.chunks(12).map(|f| [&f[..4], &f[4..8], &f[8..]].map(index)).collect();
    assert_eq!(faces.len(), m);
    Mesh::new(points, faces).expect("valid")
}

fn make(folder: &Path) {
    fs::create_dir_all(folder).expect("writable");
    let put = |name: &str, mesh: &Mesh| write(&folder.join(format!("{name}.mesh")), mesh);
    let million = torus([1000, 500], 0.0, 0.1);
    put("million", &million);
    put("million-soup", &soup(&million));
    // Two that cross each other all along a curve.
    let half = torus([700, 350], 0.0, 0.1);
    let other: Vec<Point> = half.positions().iter().map(|[x, y, z]| [x + 0.51, z + 0.003, *y]).collect();
    put("crossing", &both(&half, &Mesh::new(other, half.faces().to_vec()).expect("valid")));
    let fine = torus([400, 200], 0.0, 0.1);
    put("fine", &fine);
    put("coarse", &torus([126, 63], 0.001, 0.1));
    put("turned", &torus([400, 200], 0.0003, 0.1));
    // Noise of a twentieth of a cell: made up, so that both surfaces wave around each other.
    put("rough", &moved(&fine, 1e-4)); // measured against cells of 0.005
    let shifted: Vec<Point> = fine.positions().iter().map(|[x, y, z]| [x + 0.02, *y, *z]).collect();
    put("shifted", &Mesh::new(shifted, fine.faces().to_vec()).expect("valid"));
}

/// 1024² rays from one eye, row by row.
fn camera_rays() -> Vec<Ray> {
    let at = |i: u32| f64::from(i) / 512.0 - 1.0;
    let pixels = (0..1024).flat_map(|y| (0..1024).map(move |x| (at(x), at(y))));
    pixels.map(|(x, y)| Ray::new([0.3, -4.2, 2.4], [0.45 * x, 0.87 - 0.2 * y, -0.5 + 0.35 * y])).collect()
}

/// From anywhere around the mesh to anywhere.
fn random_rays() -> Vec<Ray> {
    let mut random = Random(1);
    let mut point = |size: f64| -> Point { std::array::from_fn(|_| size * (2.0 * random.unit() - 1.0)) };
    (0..1 << 19).map(|_| Ray::new(point(1.5), point(1.0))).collect()
}

/// The median of the times, in seconds, and the last result.
fn timed<T>(repeats: usize, mut work: impl FnMut() -> T) -> (f64, T) {
    let mut times = Vec::new();
    let mut last = None;
    for _ in 0..repeats {
        let start = Instant::now();
        let made = black_box(work());
        times.push(start.elapsed().as_secs_f64());
        last = Some(made);
    }
    times.sort_by(f64::total_cmp);
    (times[repeats / 2], last.expect("at least one"))
}

pub fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    if let ["make", folder] = args[..] {
        return make(Path::new(folder));
    }
    let [job, threads, ref meshes @ ..] = args[..] else { panic!("meshes JOB THREADS MESH [MESH]") };
    let threads = Job::default().with_threads(threads.parse().expect("a number"));
    let meshes: Vec<Mesh> = meshes.iter().map(|path| read(path)).collect();
    let mesh = &meshes[0];
    let (seconds, found) = run(job, &threads, mesh, &meshes);
    println!("{}", json!({ "job": job, "seconds": seconds, "found": found }));
}

fn run(name: &str, job: &Job, mesh: &Mesh, meshes: &[Mesh]) -> (f64, Value) {
    match name {
        "weld" => {
            let (seconds, ids) = timed(5, || position_id_by_bits(mesh.positions()));
            let n = ids.iter().enumerate().filter(|(i, id)| *i as u32 == **id).count();
            (seconds, json!(n))
        }
        "normals" => timed_value(5, || vertex_normals(mesh).len()),
        "validity" => timed_value(5, || job.run(|| validity(mesh, Topology::Indices).edges)),
        "whole" => timed_value(5, || {
            job.run(|| {
                let welded = chordal::mend::weld(mesh, chordal::mend::Weld::Exact, job).expect("finite").mesh;
                let normals = vertex_normals(&welded);
                let found = validity(&welded, Topology::Indices);
                assert!(found.closed && normals.len() == welded.positions().len());
                found.edges
            })
        }),
        "self" => timed_value(3, || self_intersections(mesh, job).expect("small").count),
        "deviation" | "deviation-1%" => {
            let relative = if name == "deviation" { 0.1 } else { 0.01 };
            let goal = Goal { relative, ..Goal::default() };
            let (seconds, found) =
                timed(3, || deviation(mesh, &meshes[1], &goal, job).expect("two surfaces"));
            (seconds, json!([found.bound.at_least(), found.bound.at_most()]))
        }
        "within" => {
            let max = Some(Tolerance::new(0.01).expect("a length"));
            let goal = Goal { max, ..Goal::default() };
            let (seconds, found) =
                timed(3, || deviation(mesh, &meshes[1], &goal, job).expect("two surfaces"));
            (seconds, json!([found.bound.at_least(), found.bound.at_most()]))
        }
        "closest" => {
            let mut random = Random(1);
            let points: Vec<Point> =
                (0..200_000).map(|_| [1.4, 1.4, 0.4].map(|x| x * (2.0 * random.unit() - 1.0))).collect();
            let bvh = Bvh::build(mesh, job).expect("small");
            timed_value(3, || bvh.closest_points(&points, job).len())
        }
        "rays-coherent" | "rays-random" => {
            let rays = if name == "rays-coherent" { camera_rays() } else { random_rays() };
            let bvh = Bvh::build(mesh, job).expect("small");
            timed_value(3, || bvh.first_hits(&rays, job).iter().flatten().count())
        }
        "tree" => timed_value(3, || Bvh::build(mesh, job).expect("small").n_triangles()),
        _ => panic!("no job is called {name}"),
    }
}

fn timed_value<T: Into<Value>>(repeats: usize, work: impl FnMut() -> T) -> (f64, Value) {
    let (seconds, found) = timed(repeats, work);
    (seconds, found.into())
}
