//! How long it takes to weld a soup of 1,000,000 triangles, to give it normals and to judge it, in CPU time
//! of one thread: `RAYON_NUM_THREADS=1 cargo run --release --example weld_times`.
use chordal::explicit::{NormalWeight, Shading, Topology, position_id_by_bits, vertex_normals, with_normals};
use chordal::mend::{Weld, weld};
use chordal::{Job, Mesh, Tolerance, check};
use std::hint::black_box;
use std::time::Instant;

/// A torus of 707 × 708 quads, each triangle with three rows of its own.
fn soup() -> Mesh {
    let (nu, nv) = (707_u32, 708_u32);
    let turn = |i: u32, n: u32| f64::from(i % n) / f64::from(n) * std::f64::consts::TAU;
    let at = |i: u32, j: u32| {
        let (u, v) = (turn(i, nu), turn(j, nv));
        let r = 3.0 + libm::cos(v);
        [r * libm::cos(u), r * libm::sin(u), libm::sin(v)]
    };
    let mut rows = Vec::new();
    for (i, j) in (0..nu).flat_map(|i| (0..nv).map(move |j| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        rows.extend([a, b, c, a, c, d]);
    }
    let faces = (0..rows.len() as u32 / 3).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
    Mesh::new(rows, faces).expect("a torus")
}

/// Seconds that the threads of this program were at work, where the system tells them: others do not count.
fn seconds(start: Instant) -> f64 {
    let of_thread = |entry: std::io::Result<std::fs::DirEntry>| -> Option<f64> {
        let text = std::fs::read_to_string(entry.ok()?.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse().ok()
    };
    let threads = std::fs::read_dir("/proc/self/task").ok();
    let nanoseconds = threads.and_then(|threads| threads.map(of_thread).sum::<Option<f64>>());
    nanoseconds.map_or_else(|| start.elapsed().as_secs_f64(), |ns| 1e-9 * ns)
}

fn time<R>(what: &str, mut work: impl FnMut() -> R) {
    let begin = Instant::now();
    let mut times: Vec<f64> = (0..7)
        .map(|_| {
            let start = seconds(begin);
            black_box(work());
            seconds(begin) - start
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!("{what:<32} {:6.1} ms (best {:.1})", 1e3 * times[3], 1e3 * times[0]);
}

fn main() {
    let job = Job::default().with_threads(1);
    let soup = soup();
    println!("{} triangles", soup.faces().len());
    time("position_id_by_bits", || position_id_by_bits(soup.positions()));
    time("weld, exact", || weld(&soup, Weld::Exact, &job));
    let tolerance = Tolerance::new(1e-6).expect("positive"); // of the spacing, 0.01
    time("weld, within 1e-6", || weld(&soup, Weld::Within(tolerance), &job));
    let mesh = weld(&soup, Weld::Exact, &job).expect("no limit").mesh;
    time("smooth normals", || vertex_normals(&mesh));
    let crease = Shading::Crease { angle_rad: 0.5, weight: NormalWeight::Angle };
    time("creased normals", || with_normals(&mesh, Topology::Indices, crease));
    time("validity", || job.run(|| check::validity(&mesh, Topology::Indices)));
}
