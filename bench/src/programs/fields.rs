//! The bench of fields: `fields FOLDER` prints CSV, a row for each model and kind of evaluation: millions of
//! points or boxes a second of Chordal, fidget's interpreter and fidget's machine code, one thread each,
//! medians of runs in turn.
//!
//! FOLDER holds op lists (`prospero.vm`). Models made here are op lists as well, so that all sides read the
//! same text.
use chordal::implicit::evaluation::{Dual, Tape};
use chordal::math::{Box3, Interval};
use chordal_bench::models::{csg, expression, gyroids};
use fidget::context::Context;
use fidget::jit::JitShape;
use fidget::shape::EzShape;
use fidget::vm::VmShape;
use std::hint::black_box;
use std::time::Instant;

/// Each side of each row is run for about this long, in seconds.
const EACH: f64 = 0.5;
/// Points in one call: enough to pay for the call, few enough for the second cache.
const POINTS: usize = 16_384;
/// Boxes in one call.
const BOXES: usize = 4096;

/// Seconds of one run of each, the medians of runs in turn.
fn medians(sides: &mut [&mut dyn FnMut()]) -> Vec<f64> {
    let mut times = vec![Vec::new(); sides.len()];
    let start = Instant::now();
    sides.iter_mut().for_each(|side| side());
    while start.elapsed().as_secs_f64() < EACH * sides.len() as f64 || times[0].len() < 5 {
        for (side, times) in sides.iter_mut().zip(&mut times) {
            let start = Instant::now();
            side();
            times.push(start.elapsed().as_secs_f64());
        }
    }
    for times in &mut times {
        times.sort_by(f64::total_cmp);
    }
    times.into_iter().map(|times| times[times.len() / 2]).collect()
}

/// Points in a cube of half side 1, in rows as a raster has them.
fn points() -> [Vec<f32>; 3] {
    let at = |k: usize| k as f32 / 16.0 - 1.0;
    let column = |f: &dyn Fn(usize) -> f32| (0..POINTS).map(f).collect::<Vec<f32>>();
    [column(&|n| at(n % 32)), column(&|n| at(n / 32 % 32)), column(&|n| at(n / 1024 * 2))]
}

fn row(model: &str, what: &str, count: usize, times: &[f64]) {
    // Millions a second: 1e-6 is exact as a unit.
    let rates: Vec<String> = times.iter().map(|time| format!("{:.3}", count as f64 / time * 1e-6)).collect();
    println!("{model},{what},{}", rates.join(","));
}

fn bench(model: &str, text: &str) {
    let tape = Tape::new(&expression(text));
    let (context, root) = Context::from_text(text.as_bytes()).expect("an op list");
    let (vm, jit) =
        (VmShape::new(&context, root).expect("a shape"), JitShape::new(&context, root).expect("a shape"));
    let (vm_tape, jit_tape) = (vm.ez_float_slice_tape(), jit.ez_float_slice_tape());
    let (mut vm_eval, mut jit_eval) = (VmShape::new_float_slice_eval(), JitShape::new_float_slice_eval());
    let [x, y, z] = points();
    let mut out = vec![0.0_f32; POINTS];
    tape.at_columns_f32([&x, &y, &z], &mut out).expect("no leaf");
    let theirs = jit_eval.eval(&jit_tape, &x, &y, &z).expect("the same lengths");
    let apart = out.iter().zip(theirs).map(|(a, b)| (a - b).abs()).fold(0.0_f32, f32::max);
    assert!(apart < 1e-2, "{model}: both sides have the same field, not {apart} apart");
    let times = medians(&mut [
        &mut || tape.at_columns_f32([black_box(&x), &y, &z], &mut out).expect("no leaf"),
        &mut || {
            black_box(vm_eval.eval(&vm_tape, black_box(&x), &y, &z).expect("the same lengths"));
        },
        &mut || {
            black_box(jit_eval.eval(&jit_tape, black_box(&x), &y, &z).expect("the same lengths"));
        },
    ]);
    row(model, "f32 points", POINTS, &times);

    let rows: Vec<[f64; 3]> = (0..POINTS).map(|k| [x[k], y[k], z[k]].map(f64::from)).collect();
    let columns = [0, 1, 2].map(|k| rows.iter().map(|p| p[k]).collect::<Vec<f64>>());
    let mut values = vec![0.0; POINTS];
    let mut slopes = vec![Dual { value: 0.0, gradient: [0.0; 3] }; POINTS];
    let [cx, cy, cz] = &columns;
    let times = medians(&mut [
        &mut || tape.at_columns([black_box(cx), cy, cz], &mut values).expect("no leaf"),
        &mut || tape.gradient_at(black_box(&rows), &mut slopes).expect("no leaf"),
    ]);
    row(model, "f64 points", POINTS, &times[..1]);
    let grads = |from: &[f32], axis: usize| -> Vec<fidget::types::Grad> {
        let one = |k: usize| if k == axis { 1.0 } else { 0.0 };
        from.iter().map(|v| fidget::types::Grad::new(*v, one(0), one(1), one(2))).collect()
    };
    let (gx, gy, gz) = (grads(&x, 0), grads(&y, 1), grads(&z, 2));
    let (vm_tape, jit_tape) = (vm.ez_grad_slice_tape(), jit.ez_grad_slice_tape());
    let (mut vm_eval, mut jit_eval) = (VmShape::new_grad_slice_eval(), JitShape::new_grad_slice_eval());
    let theirs = medians(&mut [
        &mut || {
            black_box(vm_eval.eval(&vm_tape, black_box(&gx), &gy, &gz).expect("the same lengths"));
        },
        &mut || {
            black_box(jit_eval.eval(&jit_tape, black_box(&gx), &gy, &gz).expect("the same lengths"));
        },
    ]);
    row(model, "gradients (f64; theirs f32)", POINTS, &[times[1], theirs[0], theirs[1]]);

    let boxes: Vec<Box3> =
        rows.iter().take(BOXES).map(|p| Box3 { min: *p, max: p.map(|c| c + 0.0625) }).collect();
    let sides: Vec<[fidget::types::Interval; 3]> = boxes
        .iter()
        .map(|b| [0, 1, 2].map(|k| fidget::types::Interval::new(b.min[k] as f32, b.max[k] as f32)))
        .collect();
    let mut ranges = vec![Interval::UNKNOWN; BOXES];
    let mut gradients = vec![Dual { value: Interval::UNKNOWN, gradient: [Interval::UNKNOWN; 3] }; BOXES];
    let (vm_tape, jit_tape) = (vm.ez_interval_tape(), jit.ez_interval_tape());
    let (mut vm_eval, mut jit_eval) = (VmShape::new_interval_eval(), JitShape::new_interval_eval());
    let times = medians(&mut [
        &mut || tape.over(black_box(&boxes), &mut ranges).expect("no leaf"),
        &mut || {
            for [x, y, z] in black_box(&sides) {
                black_box(vm_eval.eval(&vm_tape, *x, *y, *z).expect("three variables"));
            }
        },
        &mut || {
            for [x, y, z] in black_box(&sides) {
                black_box(jit_eval.eval(&jit_tape, *x, *y, *z).expect("three variables"));
            }
        },
        &mut || tape.gradient_over(black_box(&boxes), &mut gradients).expect("no leaf"),
    ]);
    row(model, "ranges (f64 proved; theirs f32)", BOXES, &times[..3]);
    row(model, "ranges of gradients", BOXES, &times[3..]);
}

pub fn main() {
    let folder = std::env::args().nth(1).expect("fields FOLDER");
    println!("model,what,chordal,fidget_vm,fidget_jit");
    bench("CSG of 6 solids", &csg(6));
    bench("CSG of 64 solids", &csg(64));
    bench("two gyroids", &gyroids());
    for name in ["tanglecube", "bear", "prospero"] {
        let path = format!("{folder}/{name}.vm");
        if let Ok(text) = std::fs::read_to_string(path) {
            bench(name, &text);
        }
    }
}
