//! Chordal's side of the subdivision bench.
//!
//! - `subdivision make FILE` writes a bumpy torus of 20,000 quads.
//! - `subdivision run CAGE LEVEL RUNS THREADS THEIRS` prints a line of JSON with medians in seconds, and how
//!   far the points are from those of the file THEIRS (f64, three by three, in any order), as a share of the
//!   diagonal.
use chordal::budget::Job;
use chordal_bench::cages::read;
use std::fmt::Write;
use std::time::Instant;

fn torus() -> String {
    let (n, m) = (200, 100);
    let mut text = String::new();
    for i in 0..n {
        for j in 0..m {
            let (u, v) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(m));
            let (u, v) = (u * std::f64::consts::TAU, v * std::f64::consts::TAU);
            let small = 1.0 + 0.1 * (9.0 * u).sin() * (7.0 * v).cos();
            let large = 3.0 + small * v.cos();
            writeln!(text, "v {:e} {:e} {:e}", large * u.cos(), large * u.sin(), small * v.sin())
                .expect("a String");
        }
    }
    let at = |i: i32, j: i32| i % n * m + j % m + 1;
    for i in 0..n {
        for j in 0..m {
            writeln!(text, "f {} {} {} {}", at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1))
                .expect("a String");
        }
    }
    text
}

fn median(runs: usize, mut run: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..runs)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[runs / 2]
}

/// The largest distance, along an axis, of a point from the nearest of the others; infinite where that is
/// beyond 1e-6 of the diagonal or counts differ.
fn off(ours: &[[f64; 3]], theirs: &[[f64; 3]]) -> f64 {
    if ours.len() != theirs.len() {
        return f64::INFINITY;
    }
    let diagonal = chordal::math::Box3::from_points(theirs).diagonal();
    // The target: a millionth of the extent.
    let near = 1e-6 * diagonal;
    let one_way = |from: &[[f64; 3]], to: &[[f64; 3]]| {
        let mut order: Vec<u32> = (0..to.len() as u32).collect();
        // FieldOctree of a thousandth of the diagonal in x and y bring close points together.
        let cell = |p: &[f64; 3], k: usize| (p[k] / diagonal * 1e3).floor() as i64;
        let key = |p: &[f64; 3]| (cell(p, 0), cell(p, 1));
        order.sort_unstable_by(|a, b| {
            let (a, b) = (&to[*a as usize], &to[*b as usize]);
            key(a).cmp(&key(b)).then(a[2].total_cmp(&b[2]))
        });
        let worst = |p: &[f64; 3]| {
            let mut best = f64::INFINITY;
            for (dx, dy) in [(0, 0), (-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)] {
                let (x, y) = (cell(p, 0) + dx, cell(p, 1) + dy);
                // Only cells that come within reach.
                let reach = |k: usize, c: i64| {
                    let (low, high) = (c as f64 * 1e-3 * diagonal, (c + 1) as f64 * 1e-3 * diagonal);
                    p[k] >= low - near && p[k] <= high + near
                };
                if !reach(0, x) || !reach(1, y) {
                    continue;
                }
                let start = order.partition_point(|i| {
                    let q = &to[*i as usize];
                    (key(q), q[2]) < ((x, y), p[2] - near)
                });
                for i in &order[start..] {
                    let q = &to[*i as usize];
                    if key(q) != (x, y) || q[2] > p[2] + near {
                        break;
                    }
                    let far = (0..3).map(|k| (p[k] - q[k]).abs()).fold(0.0, f64::max);
                    best = best.min(far);
                }
            }
            best
        };
        from.iter().map(worst).fold(0.0, f64::max)
    };
    let both = one_way(ours, theirs).max(one_way(theirs, ours)) / diagonal;
    if both <= near / diagonal { both } else { f64::INFINITY }
}

fn points(path: &str) -> Vec<[f64; 3]> {
    let bytes = std::fs::read(path).expect("their points");
    let number = |bytes: &[u8]| f64::from_le_bytes(bytes.try_into().expect("eight bytes"));
    bytes.chunks_exact(24).map(|p| [number(&p[..8]), number(&p[8..16]), number(&p[16..])]).collect()
}

fn run(args: &[String]) {
    let [path, level, runs, threads, theirs] = args else {
        panic!("run CAGE LEVEL RUNS THREADS THEIRS");
    };
    let number = |text: &String| text.parse::<usize>().expect("a number");
    let (level, runs) = (number(level) as u32, number(runs));
    let job = Job::default().with_threads(number(threads));
    let cage = read(path).expect("a cage");
    let refine =
        || cage.refinement(level).and_then(|made| made.refined(cage.positions(), &job)).expect("refined");
    let refined = refine();
    let off = off(refined.positions(), &points(theirs));
    let (faces, n_points) = (refined.n_faces(), refined.positions().len());
    drop(refined);
    let seconds = median(runs, || {
        refine();
    });
    let build = median(runs, || {
        let made = cage.refinement(level).expect("refined");
        std::hint::black_box(made.corners(&job));
    });
    let made = cage.refinement(level).expect("refined");
    let mut out = vec![[0.0; 3]; n_points];
    let apply = median(2 * runs, || made.evaluate_into(cage.positions(), &mut out, &job).expect("points"));
    let single: Vec<[f32; 3]> = cage.positions().iter().map(|p| p.map(|x| x as f32)).collect();
    let mut out = vec![[0.0_f32; 3]; n_points];
    let apply_f32 = median(2 * runs, || made.evaluate_into(&single, &mut out, &job).expect("points"));
    println!(
        "{{\"faces\": {faces}, \"points\": {n_points}, \"off\": {off:e}, \"refine\": {seconds}, \"build\": {build}, \
         \"apply\": {apply}, \"apply_f32\": {apply_f32}}}"
    );
}

pub fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match args.first().map(String::as_str) {
        Some("make") => std::fs::write(&args[1], torus()).expect("a file"),
        Some("run") => run(&args[1..]),
        _ => panic!("make FILE, or run CAGE LEVEL RUNS THREADS THEIRS"),
    }
}
