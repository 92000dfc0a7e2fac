//! The triangulation bench: `polygons FIXTURES [NAME]` prints CSV, a row for each polygon: corners, holes,
//! and microseconds of CPU time of Chordal (its check included), mapbox earcut and `i_triangle`, each the
//! median of runs in turn with the others.
//!
//! FIXTURES is the folder of earcut's test polygons; polygons made here follow: stars, combs, and squares
//! with holes.
use chordal::explicit::triangulate::polygon_with_holes;
use cpu_time::ProcessTime;
use i_triangle::float::triangulator::Triangulator;
use std::hint::black_box;

type Rings = Vec<Vec<[f64; 2]>>;

/// Runs last about this long for each side of each polygon, in seconds.
const EACH: f64 = 0.3;

fn ours(rings: &Rings) -> usize {
    polygon_with_holes(&rings[0], &rings[1..]).map_or(0, |cut| cut.triangles.len())
}

fn earcut(rings: &Rings) -> usize {
    let mut ends: Vec<u32> = Vec::new();
    for ring in rings {
        ends.push(ends.last().copied().unwrap_or(0) + ring.len() as u32);
    }
    ends.pop();
    let mut triangles: Vec<u32> = Vec::new();
    earcut::Earcut::new().earcut(rings.iter().flatten().copied(), &ends, &mut triangles);
    triangles.len() / 3
}

fn i_triangle(rings: &Rings) -> usize {
    Triangulator::<u32>::default().triangulate(rings).indices.len() / 3
}

fn fixtures(folder: &str) -> Vec<(String, Rings)> {
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .expect("the fixtures")
        .map(|entry| entry.expect("readable").path())
        .collect();
    files.sort();
    let read = |file: &std::path::PathBuf| {
        let text = std::fs::read_to_string(file).expect("readable");
        let name = file.file_stem().expect("a name").to_string_lossy().into_owned();
        (name, serde_json::from_str(&text).expect("lists of pairs"))
    };
    files.iter().map(read).collect()
}

fn star(n: usize, centre: [f64; 2], size: f64) -> Vec<[f64; 2]> {
    let mut state = 1_u64;
    let mut unit = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let corner = |i: usize| {
        let (sin, cos) = (std::f64::consts::TAU * i as f64 / n as f64).sin_cos();
        let radius = size * (0.3 + 0.7 * unit());
        [centre[0] + radius * cos, centre[1] + radius * sin]
    };
    (0..n).map(corner).collect()
}

fn comb(teeth: usize) -> Vec<[f64; 2]> {
    let mut points = vec![[0.0, -1.0], [2.0 * teeth as f64, -1.0]];
    for i in (0..teeth).rev() {
        points.extend([[2.0 * i as f64 + 1.0, 1000.0], [2.0 * i as f64, 0.0]]);
    }
    points
}

fn holed(n: usize, per_row: usize) -> Rings {
    let mut rings = vec![vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]];
    let step = 1.0 / per_row as f64;
    for i in 0..per_row * per_row {
        let centre = [step * ((i % per_row) as f64 + 0.5), step * ((i / per_row) as f64 + 0.5)];
        let mut ring = star(n, centre, 0.45 * step);
        ring.reverse();
        rings.push(ring);
    }
    rings
}

/// Seconds of CPU time a run, the median of up to a hundred.
fn seconds(run: fn(&Rings) -> usize, rings: &Rings) -> (f64, usize) {
    let (mut times, mut sum, mut found) = (Vec::new(), 0.0, 0);
    while times.len() < 3 || (sum < EACH && times.len() < 100) {
        let start = ProcessTime::now();
        found = black_box(run(black_box(rings)));
        let time = start.elapsed().as_secs_f64();
        times.push(time);
        sum += time;
    }
    times.sort_by(f64::total_cmp);
    (times[times.len() / 2], found)
}

pub fn main() {
    let folder = std::env::args().nth(1).expect("polygons FIXTURES");
    let mut all = fixtures(&folder);
    all.push(("star of 10k".to_owned(), vec![star(10_000, [0.0; 2], 1.0)]));
    all.push(("comb of 10k".to_owned(), vec![comb(5_000)]));
    all.push(("400 holes: 45.6k".to_owned(), holed(114, 20)));
    all.push(("star of 100k".to_owned(), vec![star(100_000, [0.0; 2], 1.0)]));
    if let Some(only) = std::env::args().nth(2) {
        all.retain(|(name, _)| *name == only);
    }
    println!("polygon,corners,holes,chordal_us,earcut_us,i_triangle_us,chordal,earcut,i_triangle");
    let mut totals = [0.0; 3];
    for (name, rings) in &all {
        let corners: usize = rings.iter().map(Vec::len).sum();
        let sides = [ours, earcut, i_triangle].map(|side| seconds(side, rings));
        (0..3).for_each(|k| totals[k] += sides[k].0);
        let [a, b, c] = sides.map(|(time, _)| 1e6 * time);
        let [x, y, z] = sides.map(|(_, found)| found);
        println!("{name},{corners},{},{a:.1},{b:.1},{c:.1},{x},{y},{z}", rings.len() - 1);
    }
    let [a, b, c] = totals.map(|time| 1e6 * time);
    println!("all,,,{a:.1},{b:.1},{c:.1},,,");
}
