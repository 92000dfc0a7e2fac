//! The bench of booleans: `booleans make FOLDER` writes pairs of meshes; `booleans run THREADS PAIR OP` combines
//! one and prints a line of JSON with the median of the seconds, its check included; `booleans random N SEED FOLDER`
//! combines random pairs in three ways and writes those and their volumes for the peer to compare with.
use chordal::boolean::{BooleanMesh, BooleanOp, BooleanStep, boolean};
use chordal::check::findings::measure;
use chordal::check::validity;
use chordal::explicit::Topology;
use chordal::{Job, Mesh};
use chordal_bench::{read, torus, write};
use chordal_testkit::Random;
use serde_json::json;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::Instant;

const OPS: [(&str, BooleanOp); 3] = [
    ("union", BooleanOp::Union),
    ("difference", BooleanOp::Difference),
    ("intersection", BooleanOp::Intersection),
];

pub fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match words[0].as_str() {
        "make" => make(Path::new(&words[1])),
        "run" => run(&words[1], &words[2], &words[3]),
        _ => random(words[1].parse().expect("a number"), words[2].parse().expect("a seed"), Path::new(&words[3])),
    }
}

fn moved(mesh: &Mesh, by: [f64; 3]) -> Mesh {
    let positions = mesh.positions().iter().map(|p| std::array::from_fn(|k| p[k] + by[k])).collect();
    mesh.with_positions(positions).expect("moved by little")
}

/// A sphere of 8 · 4ⁿ triangles.
fn sphere(rounds: u32) -> Mesh {
    let n = 1_u32 << rounds;
    // An octahedron whose faces are cut into n² triangles.
    let mut points = Vec::new();
    let mut index = std::collections::BTreeMap::new();
    let mut faces = Vec::new();
    let sign = |bit: u32| if bit == 0 { 1_i64 } else { -1 };
    for octant in 0..8_u32 {
        let signs = [sign(octant & 1), sign(octant >> 1 & 1), sign(octant >> 2)];
        let mut row = |a: u32, b: u32| {
            let key = [i64::from(a) * signs[0], i64::from(b) * signs[1], i64::from(n - a - b) * signs[2]];
            *index.entry(key).or_insert_with(|| {
                let length = key.iter().map(|x| (x * x) as f64).sum::<f64>().sqrt();
                points.push(key.map(|x| x as f64 / length));
                points.len() as u32 - 1
            })
        };
        let flips = signs.iter().product::<i64>() < 0;
        let mut add = |[a, b, c]: [u32; 3]| faces.push(if flips { [a, c, b] } else { [a, b, c] });
        for a in 0..n {
            for b in 0..n - a {
                add([row(a, b), row(a + 1, b), row(a, b + 1)]);
                if a + b + 1 < n {
                    add([row(a + 1, b), row(a + 1, b + 1), row(a, b + 1)]);
                }
            }
        }
    }
    Mesh::new(points, faces).expect("a sphere")
}

fn cuboid(low: [f64; 3], high: [f64; 3]) -> Mesh {
    let corner = |i: usize| [0, 1, 2].map(|k| if i >> k & 1 == 1 { high[k] } else { low[k] });
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::new((0..8).map(corner).collect(), faces).expect("a box")
}

fn joined(meshes: &[Mesh]) -> Mesh {
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for mesh in meshes {
        let first = points.len() as u32;
        points.extend_from_slice(mesh.positions());
        faces.extend(mesh.faces().iter().map(|face| face.map(|row| row + first)));
    }
    Mesh::new(points, faces).expect("parts")
}

fn make(folder: &Path) {
    std::fs::create_dir_all(folder).expect("a folder");
    let put = |name: &str, a: &Mesh, b: &Mesh| {
        for (which, mesh) in [("a", a), ("b", b)] {
            let mut file = BufWriter::new(File::create(folder.join(format!("{name}.{which}"))).expect("a file"));
            write(&mut file, mesh.positions(), mesh.faces()).expect("room on the disk");
        }
    };
    // Manifold's own pair: two spheres, moved by half a radius, in growing numbers of triangles.
    for rounds in [5, 7, 8] {
        let ball = sphere(rounds);
        put(&format!("spheres-{}", ball.faces().len()), &ball, &moved(&ball, [0.5, 0.0, 0.0]));
    }
    let bumpy = torus([400, 160], 0.0, 0.1);
    put("tori", &bumpy, &moved(&bumpy, [0.3, 0.2, 0.1]));
    put("same", &bumpy, &bumpy);
    // Coplanar everywhere: a plate and a lattice of bars that are flush with it.
    let plate = cuboid([0.0; 3], [40.0, 40.0, 1.0]);
    let bars: Vec<Mesh> = (0..400)
        .map(|i| [f64::from(i % 20) * 2.0, f64::from(i / 20) * 2.0])
        .map(|[x, y]| cuboid([x, y, 0.0], [x + 1.0, y + 1.0, 1.0]))
        .collect();
    put("flush", &plate, &joined(&bars));
    // Crossing itself: chains of overlapping boxes.
    let chain: Vec<Mesh> = (0..200)
        .map(|i| f64::from(i) * 0.75)
        .map(|x| cuboid([x, x.sin(), 0.0], [x + 1.0, x.sin() + 1.0, 1.0]))
        .collect();
    put("crossing", &joined(&chain), &cuboid([-1.0, -1.0, 0.25], [160.0, 0.5, 0.75]));
}

fn op_of(name: &str) -> BooleanOp {
    OPS.iter().find(|(own, _)| *own == name).expect("an operation").1
}

fn loaded(path: &str) -> Mesh {
    let (positions, faces) = read(Path::new(path)).expect("a mesh").swap_remove(0);
    Mesh::new(positions, faces).expect("valid")
}

fn combined(a: &Mesh, op: BooleanOp, b: &Mesh, job: &Job) -> BooleanMesh {
    boolean(a, &[BooleanStep { op, mesh: b }], job).expect("solids")
}

fn is_sound(mesh: &Mesh) -> bool {
    let found = validity(mesh, Topology::Indices);
    mesh.faces().is_empty() || found.closed && found.edge_manifold && found.vertex_manifold && found.oriented
}

fn run(threads: &str, pair: &str, op: &str) {
    let job = Job::default().with_threads(threads.parse().expect("a number of threads"));
    let (a, b) = (loaded(&format!("{pair}.a")), loaded(&format!("{pair}.b")));
    let mut seconds = Vec::new();
    let mut last = None;
    for _ in 0..3 {
        let start = Instant::now();
        last = Some(combined(&a, op_of(op), &b, &job));
        seconds.push(start.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    let made = last.expect("a run");
    println!("{}", json!({
        "seconds": seconds[1], "triangles": made.mesh.faces().len(), "volume": measure(&made.mesh).signed_volume,
        "method": made.method.as_str(), "at_most": made.bound.at_most(), "sound": is_sound(&made.mesh),
        "from": a.faces().len() + b.faces().len(),
    }));
}

/// Random pairs: boxes on a lattice (coplanar and touching), boxes anywhere, and coarse spheres.
fn random(n: usize, seed: u64, folder: &Path) {
    std::fs::create_dir_all(folder).expect("a folder");
    let mut random = Random::new(seed);
    let mut file = BufWriter::new(File::create(folder.join("volumes.jsonl")).expect("a file"));
    let mut failed = 0;
    for i in 0..n {
        let mut solid = || {
            let kind = i % 3;
            let at = |random: &mut Random| [0, 1, 2].map(|_| match kind {
                0 => random.below(4) as f64,
                _ => 2.0 * random.unit(),
            });
            let low = at(&mut random);
            let size = at(&mut random).map(|x| x + if kind == 0 { 1.0 } else { 0.1 });
            match kind {
                2 => {
                    let ball = sphere(2 + random.below(3) as u32);
                    let positions = ball.positions().iter().map(|p| std::array::from_fn(|k| low[k] + size[k] * p[k]));
                    ball.with_positions(positions.collect()).expect("finite")
                }
                _ => cuboid(low, std::array::from_fn(|k| low[k] + size[k])),
            }
        };
        let (a, b) = (solid(), solid());
        for (which, mesh) in [("a", &a), ("b", &b)] {
            let mut out = BufWriter::new(File::create(folder.join(format!("{i}.{which}"))).expect("a file"));
            write(&mut out, mesh.positions(), mesh.faces()).expect("room on the disk");
        }
        let made = OPS.map(|(_, op)| combined(&a, op, &b, &Job::default()));
        let volumes = [0, 1, 2].map(|k| measure(&made[k].mesh).signed_volume);
        let both = measure(&a).signed_volume + measure(&b).signed_volume;
        // A billionth of the volume is far more than rounding, and far less than any region.
        let adds = (volumes[0] + volumes[2] - both).abs() <= 1e-9 * both;
        let sound = made.iter().all(|made| is_sound(&made.mesh) && made.bound.evidence().bounds_above());
        failed += usize::from(!(adds && sound));
        writeln!(file, "{}", json!({ "volumes": volumes, "sound": adds && sound })).expect("room on the disk");
    }
    println!("{}", json!({ "pairs": n, "failed": failed }));
}
