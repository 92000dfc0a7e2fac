//! The value inside a union is no distance; `redistance` makes it one again. Lines of equal value through both.
//!
//! `cargo run -p chordal --example true_distance > true_distance.svg` writes the picture; what it measures goes to
//! stderr.
use chordal::budget::{Failure, RequiredEvidence};
use chordal::convert::{field_to_polyline, redistance};
use chordal::implicit::Field;
use chordal::implicit::shapes::{cuboid, cylinder};
use chordal::{Budget, Job, Polyline, Tolerance};

/// The lines' values: every tenth, of which one is drawn bold, as what an offset by so much leaves.
const STEP: f64 = 0.1;
const N_LINES: u32 = 9;
const OFFSET: u32 = 3;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

fn main() -> Outcome<()> {
    // A plate and a rod, both higher than they are wide, so that the section through the middle tells all.
    let plate = cuboid([2.4, 1.4, 6.0])?.moved([-0.5, 0.0, 0.0])?;
    let rod = cylinder(0.9, 6.0)?.moved([0.8, 0.0, 0.0])?;
    let union = plate.union(&rod);
    let job = Job::default();
    let made = redistance(&union, Tolerance::new(2e-3)?, &job).map_err(|failure| format!("{failure:?}"))?;
    eprintln!("the triangles are off by {}", made.bound);

    // How far each value is from the distance to the surface, at points inside.
    let points: Vec<[f64; 3]> = (0..200 * 200)
        .map(|i| [-1.8 + 0.018 * f64::from(i % 200), -1.8 + 0.018 * f64::from(i / 200), 0.0])
        .collect();
    let values = |field: &Field| -> Outcome<Vec<f64>> {
        let mut values = vec![0.0; points.len()];
        field.tape().at(&points, &mut values)?;
        Ok(values)
    };
    let (before, after) = (values(&union)?, values(&made.shape)?);
    let inside = || before.iter().zip(&after).filter(|(_, true_one)| **true_one < 0.0);
    let most = inside().map(|(value, true_one)| value - true_one).fold(0.0, f64::max);
    let deepest = after.iter().copied().fold(0.0, f64::min);
    eprintln!(
        "inside the union the value is up to {most:.2} nearer to 0 than the distance; deepest is {deepest:.2}"
    );

    println!(r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 760 262" font-family="sans-serif">"##);
    println!(r##"<title>Lines of equal value inside a union, and after redistance</title>"##);
    println!(r##"<rect width="760" height="262" fill="#ffffff"/>"##);
    let panels = [
        (&union, 10.0, "#c2410c", format!("min(a, b): off by up to {most:.2} inside")),
        (
            &made.shape,
            390.0,
            "#1d4ed8",
            format!("redistance: off by at most {:.4}", made.bound.at_most().unwrap_or(0.0)),
        ),
    ];
    for (field, left, colour, text) in panels {
        for number in 0..N_LINES {
            let width = if number == 0 || number == OFFSET { 2.6 } else { 0.9 };
            let colour = if number == 0 { "#111111" } else { colour };
            for line in lines(field, STEP * f64::from(number), &job)? {
                draw(&line, left, colour, width);
            }
        }
        println!(r##"<text x="{}" y="232" font-size="15" fill="{colour}">{text}</text>"##, left + 20.0);
        println!(
            r##"<text x="{}" y="252" font-size="13" fill="#666666">bold: offset(shape, -{:.1})</text>"##,
            left + 20.0,
            STEP * f64::from(OFFSET)
        );
    }
    println!("</svg>");
    Ok(())
}

/// The lines in the plane z = 0 where the value is −`depth`; none deeper than the shape.
fn lines(field: &Field, depth: f64, job: &Job) -> Outcome<Vec<Polyline<2>>> {
    let deeper = Field::new(field.expr().clone() + depth).with_bounds(field.bounds());
    let budget = Budget { require: RequiredEvidence::Measured, ..Budget::length(Tolerance::new(4e-3)?) };
    match field_to_polyline(&deeper, &budget, job) {
        Ok(made) => Ok(made.shape),
        // Where lines touch, or end in a ridge, no proof is within the budget; a fiftieth is two pixels.
        Err(Failure::Unmet(best)) if best.bound.at_most().is_some_and(|most| most < 0.02) => Ok(best.shape),
        Err(Failure::Unmet(_)) => Ok(Vec::new()),
        Err(failure) => Err(format!("{failure:?}").into()),
    }
}

fn draw(line: &Polyline<2>, left: f64, colour: &str, width: f64) {
    let place = |p: &[f64; 2]| format!("{:.1} {:.1}", left + 180.0 + 100.0 * p[0], 105.0 - 100.0 * p[1]);
    let path: Vec<String> = line.points.iter().map(place).collect();
    let tag = if line.closed { "polygon" } else { "polyline" };
    println!(
        r##"<{tag} points="{}" fill="none" stroke="{colour}" stroke-width="{width}"/>"##,
        path.join(" ")
    );
}
