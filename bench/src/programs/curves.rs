//! The flattening bench: `curves CORPUS TOLERANCE...` prints CSV, one row for each side.
//!
//! Columns: corpus, tolerance, side, curves, segments, segments over the curves where kurbo keeps the
//! tolerance, curves over the tolerance, worst and median of distance/tolerance, the asymptotic minimum, and
//! nanoseconds of CPU time a curve, into a list of points for each curve and into one list for all.
use chordal_bench::curves::drawings::cubics;
use chordal_bench::curves::sampler::{bending, farthest};
use chordal_bench::curves::sides::{Prepared, SIDES, Side};
use cpu_time::ProcessTime;
use std::hint::black_box;

/// Runs of each side, in turn with the others; the median counts.
const REPEATS: usize = 5;

/// More than this share over the tolerance is over it: the sampler's own rounding stays below.
const ROUNDING: f64 = 1e-9;

struct Row {
    side: Side,
    segments: Vec<usize>,
    distances: Vec<f64>,
    times: [Vec<f64>; 2],
}

impl Row {
    fn new(side: Side, all: &Prepared, tolerance: f64) -> Self {
        let (mut segments, mut polylines) = (Vec::new(), Vec::new());
        all.one_by_one(side, tolerance, |points| {
            segments.push(points.len() - 1);
            polylines.push(points);
        });
        let measure = |from: usize| {
            let half = all.cubics.iter().zip(&polylines).skip(from).step_by(2);
            half.map(|(cubic, points)| farthest(cubic, points)).collect::<Vec<f64>>()
        };
        let (even, odd) = std::thread::scope(|scope| {
            let odd = scope.spawn(|| measure(1));
            (measure(0), odd.join().expect("no panic"))
        });
        let distances =
            (0..polylines.len()).map(|i| if i % 2 == 0 { even[i / 2] } else { odd[i / 2] }).collect();
        Self { side, segments, distances, times: [Vec::new(), Vec::new()] }
    }

    fn time(&mut self, all: &Prepared, tolerance: f64) {
        let start = ProcessTime::now();
        all.one_by_one(self.side, tolerance, |points| {
            black_box(&points);
        });
        self.times[0].push(start.elapsed().as_secs_f64());
        let start = ProcessTime::now();
        black_box(all.at_once(self.side, tolerance));
        self.times[1].push(start.elapsed().as_secs_f64());
    }
}

fn median(list: &[f64]) -> f64 {
    let mut sorted = list.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

fn run(corpus: &str, all: &Prepared, text: &str) {
    let tolerance: f64 = text.parse().expect("a tolerance");
    let mut rows: Vec<Row> = SIDES.iter().map(|side| Row::new(*side, all, tolerance)).collect();
    for _ in 0..REPEATS {
        rows.iter_mut().for_each(|row| row.time(all, tolerance));
    }
    let is_over = |distance: f64| distance > tolerance * (1.0 + ROUNDING);
    let kurbo = rows.iter().find(|row| row.side == Side::Kurbo).expect("a side");
    let kept: Vec<bool> = kurbo.distances.iter().map(|d| !is_over(*d)).collect();
    let least = all.cubics.iter().map(|cubic| (bending(cubic) / tolerance.sqrt()).max(1.0)).sum::<f64>();
    for row in &rows {
        let n = row.segments.len();
        let segments: usize = row.segments.iter().sum();
        let beside: usize = row.segments.iter().zip(&kept).filter(|(_, kept)| **kept).map(|(n, _)| n).sum();
        let over = row.distances.iter().filter(|d| is_over(**d)).count();
        let worst = row.distances.iter().copied().fold(0.0, f64::max) / tolerance;
        let middle = median(&row.distances) / tolerance;
        let [one, all] = [0, 1].map(|i| 1e9 * median(&row.times[i]) / n as f64);
        println!(
            "{corpus},{text},{},{n},{segments},{beside},{over},{worst:.4},{middle:.4},{least:.0},{one:.1},{all:.1}",
            row.side.name()
        );
    }
}

pub fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [corpus, tolerances @ ..] = args.as_slice() else { panic!("curves CORPUS TOLERANCE...") };
    let all = Prepared::new(cubics(corpus));
    tolerances.iter().for_each(|tolerance| run(corpus, &all, tolerance));
}
