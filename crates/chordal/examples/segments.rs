//! The tables of `docs/segments.md`: how many segments a curve needs, and what they lose.
//!
//! `cargo run -p chordal --example segments` prints them; with `-- docs/segments.md` it puts them into the
//! page, between the marks.
use chordal::explicit::{Arc, Curve, CurveEnds, CurveSegment};
use chordal::{Bezier, Budget, Job, Tolerance, convert};

/// What goes wrong here goes to whoever runs it.
type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// The circle of a diameter.
fn circle(diameter: f64) -> Outcome<Curve<2>> {
    let radius = diameter / 2.0;
    let turn = 2.0 * std::f64::consts::PI;
    let arc = Arc::new([radius, radius], [[radius, 0.0], [0.0, radius]], 0.0, turn)?;
    // Sine and cosine of a full turn are a little off those of none.
    let start = arc.ends()[0];
    Ok(Curve::new(vec![CurveSegment::Arc(arc.with_ends([start, start]))], CurveEnds::Closed)?)
}

/// A cubic with a gentle and a tight bend, as wide as asked.
fn hook(width: f64) -> Curve<2> {
    let control = [[0.0, 0.0], [0.6, 0.0], [1.2, 0.0], [0.9, 0.5]];
    // Its rightmost point is at 0.97255 of these numbers, where 1.8 − 2.7·t² vanishes.
    let t = (2.0_f64 / 3.0).sqrt();
    let rightmost = 1.8 * t - 0.9 * t * t * t;
    Bezier { control: control.map(|p| p.map(|x| x * width / rightmost)) }.into()
}

/// How a number of segments is found.
type Flatten = fn(&Curve<2>, &Budget) -> Outcome<(usize, f64)>;

fn fewest(curve: &Curve<2>, budget: &Budget) -> Outcome<(usize, f64)> {
    let made = convert::curve_to_polyline(curve, budget, &Job::default())?;
    Ok((made.shape.n_segments(), made.bound.at_most().unwrap_or(f64::INFINITY)))
}

fn even(curve: &Curve<2>, budget: &Budget) -> Outcome<(usize, f64)> {
    let made = convert::curve_to_polyline_evenly(curve, budget, &Job::default())?;
    Ok((made.shape.n_segments(), made.bound.at_most().unwrap_or(f64::INFINITY)))
}

/// Segments by size on the screen, one unit a pixel.
fn by_size() -> Outcome<String> {
    let mut table = String::from(
        "| size in pixels | circle: 1 px | ½ px | ¼ px | cubic: 1 px | ½ px | ¼ px | equal steps: 1 px | ½ px | ¼ px |\n",
    );
    table += &("|---".repeat(10) + "|\n");
    for size in [10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000] {
        table += &format!("| {size} ");
        let size = f64::from(size);
        for (curve, flatten) in [(circle(size)?, fewest as Flatten), (hook(size), fewest), (hook(size), even)]
        {
            for pixels in [1.0, 0.5, 0.25] {
                let (n, _) = flatten(&curve, &Budget::length(Tolerance::new(pixels)?))?;
                table += &format!("| {n} ");
            }
        }
        table += "|\n";
    }
    Ok(table)
}

/// What a number of segments loses, of a diameter or a width of 1000.
fn by_count() -> Outcome<String> {
    let mut table = String::from(
        "| segments | circle, `r(1 − cos(π/N))` | circle, proved | with half as many | cubic in equal steps, proved | with half as many |\n",
    );
    table += &("|---".repeat(6) + "|\n");
    let (circle, hook) = (circle(1000.0)?, hook(1000.0));
    let mut before: Option<[f64; 2]> = None;
    for n in [4, 8, 16, 32, 64, 128, 256, 512_u32] {
        let exact = 500.0 * (1.0 - (std::f64::consts::PI / f64::from(n)).cos());
        let budget = Budget::segments(u64::from(n));
        let lost = [even(&circle, &budget)?.1, even(&hook, &budget)?.1];
        let ratio = |i: usize| before.map_or("—".into(), |before| format!("× {:.3}", before[i] / lost[i]));
        table += &format!(
            "| {n} | {exact:.5} | {:.5} | {} | {:.5} | {} |\n",
            lost[0],
            ratio(0),
            lost[1],
            ratio(1)
        );
        before = Some(lost);
    }
    Ok(table)
}

/// Where the tables stand in the page.
pub const MARKS: [&str; 4] =
    ["<!-- by size -->\n", "<!-- by size, end -->", "<!-- by count -->\n", "<!-- by count, end -->"];

/// The page with the tables as they are made now.
pub fn renewed(page: &str) -> Outcome<String> {
    let mut page = page.to_owned();
    for (marks, table) in MARKS.chunks(2).zip([by_size()?, by_count()?]) {
        let from = page.find(marks[0]).ok_or(format!("the page has no {}", marks[0]))? + marks[0].len();
        let to = page.find(marks[1]).ok_or(format!("the page has no {}", marks[1]))?;
        page.replace_range(from..to, &table);
    }
    Ok(page)
}

fn main() -> Outcome<()> {
    if let Some(path) = std::env::args().nth(1) {
        let page = renewed(&std::fs::read_to_string(&path)?)?;
        std::fs::write(&path, page)?;
    } else {
        println!("{}\n{}", by_size()?, by_count()?);
    }
    Ok(())
}
