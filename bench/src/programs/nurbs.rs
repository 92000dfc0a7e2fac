//! Chordal's side of the bench of splines and faces: `nurbs FILE TOLERANCE...` meshes the surfaces of a JSON file, or
//! flattens its curves.
//!
//! One thread. Prints CSV: tolerance, triangles or segments, CPU seconds (the median of repeated runs), `at_most`; the
//! result lies in `out/nurbs.TOLERANCE.mesh`, polylines as positions without faces.
use chordal::{Budget, Curve, Job, Tolerance, convert};
use chordal_bench::{out, write};
use chordal_io::{Content, Limits, shape_json};
use cpu_time::ProcessTime;
use std::fs::File;
use std::io::BufWriter;

/// Runs of each call; the median counts.
const REPEATS: usize = 5;

/// What a call gave: positions and triangles of each shape, how many pieces, and the bound.
type Made = (Vec<(Vec<[f64; 3]>, Vec<[u32; 3]>)>, usize, f64);

fn timed(mut run: impl FnMut() -> Option<Made>) -> (Option<Made>, f64) {
    let (mut times, mut made) = (Vec::new(), None);
    for _ in 0..REPEATS {
        drop(made.take());
        let start = ProcessTime::now();
        made = run();
        times.push(start.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    (made, times[REPEATS / 2])
}

/// All curves, one after the other.
fn flattened<const D: usize>(curves: &[Curve<D>], budget: &Budget, job: &Job) -> Option<Made> {
    let (mut shapes, mut n, mut bound) = (Vec::new(), 0, 0.0_f64);
    for curve in curves {
        let made = convert::curve_to_polyline(curve, budget, job).map_err(|e| eprintln!("{e}")).ok()?;
        n += made.shape.n_segments();
        bound = bound.max(made.bound.at_most()?);
        let wide = |p: &[f64; D]| std::array::from_fn(|k| p.get(k).copied().unwrap_or(0.0));
        shapes.push((made.shape.points.iter().map(wide).collect(), Vec::new()));
    }
    Some((shapes, n, bound))
}

pub fn main() -> std::io::Result<()> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [file, tolerances @ ..] = args.as_slice() else { panic!("nurbs FILE TOLERANCE...") };
    let content = shape_json::read(&std::fs::read(file)?, &Limits::default()).expect("a file of shapes").content;
    let job = Job::default().with_threads(1);
    for tolerance in tolerances {
        let budget = Budget::length(Tolerance::new(tolerance.parse().expect("a length")).expect("a length"));
        let (made, seconds) = timed(|| match &content {
            Content::Surfaces(faces, _) => {
                let made = convert::trimmed_surfaces_to_mesh(faces, &budget, &job);
                let made = made.map_err(|e| eprintln!("{e}")).ok()?;
                let n = made.shape.faces().len();
                let mesh = (made.shape.positions().to_vec(), made.shape.faces().to_vec());
                Some((vec![mesh], n, made.bound.at_most()?))
            }
            Content::Drawing(drawing) => flattened(&drawing.lines, &budget, &job),
            Content::Curves(curves) => flattened(&curves.lines, &budget, &job),
            _ => panic!("surfaces or curves"),
        });
        let Some((shapes, n, bound)) = made else {
            println!("{tolerance},,{seconds},");
            continue;
        };
        let mut dump = BufWriter::new(File::create(out().join(format!("nurbs.{tolerance}.mesh")))?);
        for (positions, faces) in &shapes {
            write(&mut dump, positions, faces)?;
        }
        println!("{tolerance},{n},{seconds:.7},{bound:e}");
    }
    Ok(())
}
