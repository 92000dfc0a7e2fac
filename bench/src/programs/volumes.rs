//! The bench of volumes: `volumes make PATH N` writes a gyroid of N³ samples of f32; `volumes WHAT THREADS
//! PATH N` prints one line of JSON: the median seconds of runs, triangles, open edges, and the peak of memory
//! in bytes.
//!
//! WHAT is `f64`, `f32` (triangles alone), `bound` (triangles and their bound), `ties` (the samples rounded
//! to tenths, which puts many on the level) or `nets` (the crate fast-surface-nets, on one thread).
use chordal::Job;
use chordal::convert::{Polygonize, grid_to_mesh};
use chordal::convert::lattices::grid_to_triangles;
use chordal::implicit::{Affine3, Grid, Samples};
use fast_surface_nets::ndshape::{RuntimeShape, Shape};
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use std::time::Instant;

/// Four periods a side, so that 256³ samples have about 2.5 million triangles.
fn gyroid(n: usize) -> Vec<f32> {
    let step = 4.0 * std::f64::consts::TAU / n as f64;
    let waves: Vec<(f64, f64)> = (0..n).map(|i| (i as f64 * step).sin_cos()).collect();
    let mut values = Vec::with_capacity(n * n * n);
    for z in &waves {
        for y in &waves {
            values.extend(waves.iter().map(|x| (x.0 * y.1 + y.0 * z.1 + z.0 * x.1) as f32));
        }
    }
    values
}

fn read(path: &str) -> Vec<f32> {
    let bytes = std::fs::read(path).expect("the volume");
    bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect()
}

fn open_edges(faces: &[[u32; 3]]) -> usize {
    let mut half: Vec<(u32, u32)> =
        faces.iter().flat_map(|f| [(f[0], f[1]), (f[1], f[2]), (f[2], f[0])]).collect();
    half.sort_unstable();
    half.iter().filter(|(a, b)| half.binary_search(&(*b, *a)).is_err()).count()
}

fn peak() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM"));
    let number =
        line.and_then(|line| line.split_whitespace().nth(1)).and_then(|text| text.parse::<u64>().ok());
    1024 * number.unwrap_or(0)
}

/// Seconds of each run, and what the last made.
fn timed<T>(runs: usize, mut work: impl FnMut() -> T) -> (f64, T) {
    let mut seconds = Vec::new();
    let mut last = None;
    for _ in 0..runs {
        drop(last.take());
        let start = Instant::now();
        last = Some(work());
        seconds.push(start.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    (seconds[runs / 2], last.expect("a run"))
}

pub fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let n: usize = words.last().and_then(|text| text.parse().ok()).expect("a number of samples");
    if words[0] == "make" {
        let bytes: Vec<u8> = gyroid(n).iter().flat_map(|v| v.to_le_bytes()).collect();
        return std::fs::write(&words[1], bytes).expect("a file to write");
    }
    let threads: usize = words[1].parse().expect("a number of threads");
    let job = Job::default().with_threads(threads);
    let mut values = read(&words[2]);
    let rule = Polygonize::below(0.0).open();
    let runs = if n > 300 { 3 } else { 9 };
    if words[0] == "nets" {
        let shape = RuntimeShape::<u32, 3>::new([n as u32; 3]);
        let (seconds, count) = timed(runs, || {
            let mut buffer = SurfaceNetsBuffer::default();
            surface_nets(&values, &shape, [0; 3], [n as u32 - 1; 3], &mut buffer);
            buffer.indices.len() / 3
        });
        let _ = shape.size();
        return println!(
            "{{\"seconds\": {seconds}, \"triangles\": {count}, \"open\": null, \"peak\": {}}}",
            peak()
        );
    }
    if words[0] == "ties" {
        values.iter_mut().for_each(|v| *v = (*v * 10.0).round() / 10.0);
    }
    let grid = Grid::new([n; 3], Samples::F32(values), Affine3::IDENTITY).expect("a grid");
    let (seconds, triangles, open, bound) = match words[0].as_str() {
        "f32" => {
            let (s, made) = timed(runs, || grid_to_triangles::<f32>(&grid, &rule, &job).expect("a surface"));
            (s, made.faces.len(), None, None)
        }
        "f64" => {
            let (s, made) = timed(runs, || grid_to_triangles::<f64>(&grid, &rule, &job).expect("a surface"));
            (s, made.faces.len(), None, None)
        }
        "ties" => {
            let capped = Polygonize::below(0.0);
            let (s, made) = timed(1, || grid_to_triangles::<f64>(&grid, &capped, &job).expect("a surface"));
            (s, made.faces.len(), Some(open_edges(&made.faces)), None)
        }
        _ => {
            let (s, made) = timed(runs, || grid_to_mesh(&grid, &rule, None, &job).expect("a surface"));
            (s, made.shape.faces().len(), None, made.bound.at_most())
        }
    };
    let show = |x: Option<String>| x.unwrap_or_else(|| "null".into());
    println!(
        "{{\"seconds\": {seconds}, \"triangles\": {triangles}, \"open\": {}, \"bound\": {}, \"peak\": {}}}",
        show(open.map(|x| x.to_string())),
        show(bound.map(|x| x.to_string())),
        peak()
    );
}
