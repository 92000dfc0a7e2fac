//! Chordal's side of the patch bench: `patches CORPUS TOLERANCE...` meshes a corpus as the peer's script
//! does.
//!
//! One thread; a hard corpus patch by patch, the teapot in one call. Prints CSV: corpus, tolerance, engine,
//! triangles, CPU seconds (medians of repeated runs, added up), shapes that failed, and the largest `at_most
//! / tolerance`.
use chordal::{Bounded, Budget, Job, Mesh, Patch, Tolerance, convert};
use chordal_bench::{out, patches, write};
use cpu_time::ProcessTime;
use std::fs::File;
use std::io::BufWriter;

/// Runs of each call; the median counts.
const REPEATS: usize = 5;

fn timed(shape: &[Patch], budget: &Budget) -> (Option<Bounded<Mesh>>, f64) {
    let job = Job::default().with_threads(1);
    let mut times = Vec::new();
    let mut made = None;
    for _ in 0..REPEATS {
        drop(made.take());
        let start = ProcessTime::now();
        let next = convert::patches_to_mesh(shape, budget, &job);
        times.push(start.elapsed().as_secs_f64());
        made = next.map_err(|e| eprintln!("{e}")).ok();
    }
    times.sort_by(f64::total_cmp);
    (made, times[REPEATS / 2])
}

fn run(corpus: &str, tolerance: &str) -> std::io::Result<()> {
    let all: Vec<Patch> = patches(corpus).into_iter().map(|control| Patch { control }).collect();
    let shapes: Vec<&[Patch]> = if corpus == "teapot" { vec![&all] } else { all.chunks(1).collect() };
    let limit = Tolerance::new(tolerance.parse().expect("a tolerance")).expect("a tolerance");
    let mut dump = BufWriter::new(File::create(out().join(format!("{corpus}.{tolerance}.chordal.mesh")))?);
    let (mut triangles, mut seconds, mut failed, mut bound) = (0, 0.0, 0, 0.0_f64);
    for shape in shapes {
        let (made, time) = timed(shape, &Budget::length(limit));
        seconds += time;
        let Some(Bounded { shape, bound: reached }) = made else {
            failed += 1;
            write(&mut dump, &[], &[])?;
            continue;
        };
        triangles += shape.faces().len();
        bound = bound.max(reached.at_most().unwrap_or(f64::INFINITY) / limit.get());
        write(&mut dump, shape.positions(), shape.faces())?;
    }
    println!("{corpus},{tolerance},chordal,{triangles},{seconds:.6},{failed},{bound:.4}");
    Ok(())
}

pub fn main() -> std::io::Result<()> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [corpus, tolerances @ ..] = args.as_slice() else { panic!("patches CORPUS TOLERANCE...") };
    tolerances.iter().try_for_each(|tolerance| run(corpus, tolerance))
}
