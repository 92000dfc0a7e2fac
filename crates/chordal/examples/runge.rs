//! Runge's function through 11 equally spaced points: the polynomial swings out of bounds, the spline does
//! not.
//!
//! `cargo run -p chordal --example runge > runge.svg` writes the picture; what it measures goes to stderr.
use chordal::explicit::parametric::Polynomial;
use chordal::explicit::spline;
use chordal::{Budget, Job, Tolerance, convert};

/// What is to be drawn: few know that so tame a function does this.
fn runge(x: f64) -> f64 {
    1.0 / (1.0 + 25.0 * x * x)
}

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 420.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let nodes: Vec<f64> = (0..11).map(|i| f64::from(i) / 5.0 - 1.0).collect();
    let points: Vec<[f64; 2]> = nodes.iter().map(|x| [*x, runge(*x)]).collect();
    let polynomial = Polynomial::through(&nodes, &points)?;
    let smooth = spline::natural(&points)?;
    // A thousandth of the height is half a pixel of the picture.
    let drawn = convert::curve_to_polyline(&smooth, &Budget::length(Tolerance::new(1e-3)?), &Job::default())?;

    let steps = 500;
    let xs = || (0..=steps).map(|i| 2.0 * f64::from(i) / f64::from(steps) - 1.0);
    let sampled = |f: &dyn Fn(f64) -> f64| -> Vec<[f64; 2]> { xs().map(|x| [x, f(x)]).collect() };
    let worst = |f: &dyn Fn(f64) -> f64| xs().map(|x| (f(x) - runge(x)).abs()).fold(0.0, f64::max);
    let by_polynomial = worst(&|x| polynomial.at(x)[1]);
    let by_spline = worst(&|x| smooth.at(5.0 * (x + 1.0))[1]);
    eprintln!("the polynomial is off by up to {by_polynomial:.3}, the spline by up to {by_spline:.3}");
    eprintln!("the spline is drawn with {} segments, off by {}", drawn.shape.n_segments(), drawn.bound);

    println!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif">"##
    );
    println!(r##"<title>1/(1+25x²) through 11 points: polynomial and natural spline</title>"##);
    println!(r##"<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>"##);
    println!(r##"<path d="M20 {y:.1}H620" stroke="#bbbbbb" fill="none"/>"##, y = to_picture([0.0, 0.0])[1]);
    draw(&sampled(&runge), "#888888", 5.0);
    draw(&sampled(&|x| polynomial.at(x)[1]), "#c2410c", 1.8);
    draw(&drawn.shape.points, "#1d4ed8", 1.8);
    for point in &points {
        let [x, y] = to_picture(*point);
        println!(r##"<circle cx="{x:.2}" cy="{y:.2}" r="4" fill="#111111"/>"##);
    }
    label(150.0, 362.0, "#c2410c", &format!("one polynomial of degree 10: off by up to {by_polynomial:.2}"));
    label(150.0, 384.0, "#1d4ed8", &format!("natural cubic spline: off by up to {by_spline:.3}"));
    label(150.0, 406.0, "#666666", "1/(1+25x²), and 11 of its points");
    println!("</svg>");
    Ok(())
}

fn to_picture([x, y]: [f64; 2]) -> [f64; 2] {
    [20.0 + 300.0 * (x + 1.0), 300.0 - 130.0 * y]
}

fn draw(points: &[[f64; 2]], colour: &str, width: f64) {
    let path: Vec<String> = points
        .iter()
        .map(|p| {
            let [x, y] = to_picture(*p);
            format!("{x:.2} {y:.2}")
        })
        .collect();
    println!(
        r##"<polyline points="{}" fill="none" stroke="{colour}" stroke-width="{width}"/>"##,
        path.join(" ")
    );
}

fn label(x: f64, y: f64, colour: &str, text: &str) {
    println!(r##"<text x="{x}" y="{y}" font-size="15" fill="{colour}">{text}</text>"##);
}
