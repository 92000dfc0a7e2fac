//! A camera path through the same points as a Catmull–Rom spline (C1) and as a natural spline (C2), and the size
//! of the acceleration along both: the one jerks at every point, the other at none.
//!
//! `cargo run -p chordal --example camera_path > camera_path.svg` writes the picture; what it measures goes to
//! stderr.
use chordal::check::curves::joins;
use chordal::explicit::spline::{self, Knots};
use chordal::explicit::{Curve, CurveEnds};
use chordal::{Budget, Job, Tolerance, convert};

/// Where the camera is at the times 0, 1, 2 …: a walk around a corner, chosen for the picture.
const POINTS: [[f64; 2]; 8] =
    [[0.0, 0.0], [1.6, 0.3], [3.0, 0.2], [3.9, 1.1], [4.3, 2.3], [5.6, 2.6], [7.2, 2.0], [8.6, 2.4]];

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 470.0;
const ORANGE: &str = "#c2410c";
const BLUE: &str = "#1d4ed8";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let c1 = spline::catmull_rom(&POINTS, Knots::Uniform, CurveEnds::Open)?;
    let c2 = spline::natural(&POINTS)?;
    for (name, path) in [("Catmull-Rom", &c1), ("natural", &c2)] {
        let class = joins(path).iter().map(|join| join.parametric.unwrap_or(0)).min().unwrap_or(0);
        let (most, jump) = (accelerations(path).into_iter().flatten(), largest_jump(path));
        let most = most.map(|[_, size]| size).fold(0.0, f64::max);
        eprintln!("{name}: C{class}, acceleration up to {most:.2}, jumps by up to {jump:.2}");
    }

    println!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif">"##
    );
    println!(r##"<title>A camera path as a C1 and as a C2 spline, and the acceleration along both</title>"##);
    println!(r##"<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>"##);
    // The paths: a thousandth of a unit is a fifteenth of a pixel of the picture.
    for (path, colour) in [(&c1, ORANGE), (&c2, BLUE)] {
        let drawn =
            convert::curve_to_polyline(path, &Budget::length(Tolerance::new(1e-3)?), &Job::default())?;
        draw(&drawn.shape.points, colour, &|[x, y]| [30.0 + 67.0 * x, 222.0 - 55.0 * y]);
    }
    for [x, y] in POINTS {
        println!(
            r##"<circle cx="{:.2}" cy="{:.2}" r="4" fill="#111111"/>"##,
            30.0 + 67.0 * x,
            222.0 - 55.0 * y
        );
    }
    label(30.0, 28.0, ORANGE, "Catmull–Rom: C1");
    label(30.0, 48.0, BLUE, "natural spline: C2");
    label(30.0, 68.0, "#666666", "through the same points at the same times");
    // The accelerations over time: one line for each piece, so that a jump is a gap.
    let to_chart = |[t, size]: [f64; 2]| [30.0 + 82.0 * t, 440.0 - 53.0 * size];
    for i in 0..POINTS.len() {
        let x = to_chart([i as f64, 0.0])[0];
        println!(r##"<path d="M{x:.1} 440V270" stroke="#e2e2e2" fill="none"/>"##);
        println!(
            r##"<text x="{x:.1}" y="458" font-size="12" fill="#666666" text-anchor="middle">{i}</text>"##
        );
    }
    println!(r##"<path d="M30 440H604" stroke="#bbbbbb" fill="none"/>"##);
    for (path, colour) in [(&c1, ORANGE), (&c2, BLUE)] {
        for piece in accelerations(path) {
            draw(&piece, colour, &to_chart);
        }
    }
    label(30.0, 258.0, "#666666", "size of the acceleration over time");
    println!("</svg>");
    Ok(())
}

/// For each piece, times and the size of the second derivative then.
fn accelerations(path: &Curve<2>) -> Vec<Vec<[f64; 2]>> {
    let steps = 40;
    let pieces = path.segments().iter().enumerate();
    pieces
        .map(|(i, piece)| {
            let at = |step: u32| f64::from(step) / f64::from(steps);
            (0..=steps).map(|step| [i as f64 + at(step), size(piece.second_derivative(at(step)))]).collect()
        })
        .collect()
}

/// The largest difference of the accelerations before and after a point.
fn largest_jump(path: &Curve<2>) -> f64 {
    let jump = |before: [f64; 2], after: [f64; 2]| size([after[0] - before[0], after[1] - before[1]]);
    path.segments()
        .windows(2)
        .map(|pair| jump(pair[0].second_derivative(1.0), pair[1].second_derivative(0.0)))
        .fold(0.0, f64::max)
}

fn size([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}

fn draw(points: &[[f64; 2]], colour: &str, to_picture: &dyn Fn([f64; 2]) -> [f64; 2]) {
    let path: Vec<String> = points
        .iter()
        .map(|p| {
            let [x, y] = to_picture(*p);
            format!("{x:.2} {y:.2}")
        })
        .collect();
    println!(r##"<polyline points="{}" fill="none" stroke="{colour}" stroke-width="1.8"/>"##, path.join(" "));
}

fn label(x: f64, y: f64, colour: &str, text: &str) {
    println!(r##"<text x="{x}" y="{y}" font-size="15" fill="{colour}">{text}</text>"##);
}
