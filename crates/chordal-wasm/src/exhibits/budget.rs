//! Budget against triangles, for every representation.
use super::answer::ExhibitAnswer;
use super::plane::{once, told};
use super::request::ExhibitRequest;
use super::shapes;
use chordal::convert::{cage_to_mesh, curve_to_polyline, field_to_mesh, patches_to_mesh};
use chordal::explicit::Cage;
use chordal::implicit::shapes::torus;
use chordal::math::elementary::ln;
use chordal::{Bezier, Budget, Curve, Job, Tolerance};
use serde_json::{Value, json};
use std::sync::OnceLock;

/// The lengths, each half of the one before.
const FIRST: f64 = 0.125; // chosen: an eighth
const HALVINGS: usize = 5; // chosen: all of them take about a second
/// The names of what is meshed, in this order.
const NAMES: [&str; 4] = ["curve", "patch", "cage", "field"];

/// A length, the segments or triangles that it took, and the bound that they have.
type Step = (f64, usize, Option<f64>);

/// Answers `{"shape": "patch", "step": 3}`: what each takes at every length, and how steeply that grows around
/// one of them.
pub(super) fn budget(asked: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    asked.only(&["shape", "step"])?;
    let shape = asked.word("shape", &NAMES)?;
    let step = asked.number("step", [0.0, (HALVINGS - 1) as f64])? as usize;
    let all = series()?;
    let chosen = &all[NAMES.iter().position(|name| *name == shape).unwrap_or(0)];
    let [(_, few, _), (_, many, _)] = [chosen[step], chosen[step + 1]];
    let whole = chosen[HALVINGS].1 as f64 / chosen[0].1 as f64;
    let series: Vec<Value> =
        NAMES.iter().zip(all).map(|(name, steps)| json!({ "name": name, "steps": steps })).collect();
    Ok(ExhibitAnswer::new(json!({
        "series": series,
        "count": few,
        "length": chosen[step].0,
        "bound": chosen[step].2,
        "times": many as f64 / few as f64,
        "slope": -ln(whole) / (HALVINGS as f64 * ln(2.0)),
    })))
}

fn series() -> Result<&'static [Vec<Step>; 4], String> {
    static MADE: OnceLock<[Vec<Step>; 4]> = OnceLock::new();
    once(&MADE, || Ok([steps(curve)?, steps(patch)?, steps(cage)?, steps(field)?]))
}

fn steps(make: impl Fn(&Budget) -> Result<(usize, Option<f64>), String>) -> Result<Vec<Step>, String> {
    let mut length = FIRST;
    let mut all = Vec::new();
    for _ in 0..=HALVINGS {
        let (count, bound) = make(&Budget::length(told(Tolerance::new(length))?))?;
        all.push((length, count, bound));
        length *= 0.5;
    }
    Ok(all)
}

/// The curve that the widget begins with, 8 units wide.
fn curve(budget: &Budget) -> Result<(usize, Option<f64>), String> {
    let curve = Bezier { control: [[0.0, 0.0], [2.0, 6.0], [6.0, 6.0], [8.0, 0.0]] };
    let made = told(curve_to_polyline(&Curve::from(curve), budget, &Job::default()))?;
    Ok((made.shape.n_segments(), made.bound.at_most()))
}

/// The teapot, 6.4 units wide.
fn patch(budget: &Budget) -> Result<(usize, Option<f64>), String> {
    let made = told(patches_to_mesh(&shapes::teapot(), budget, &Job::default()))?;
    Ok((made.shape.faces().len(), made.bound.at_most()))
}

/// The cube of edge 4 as a Catmull–Clark cage.
fn cage(budget: &Budget) -> Result<(usize, Option<f64>), String> {
    let cube = shapes::cube()?;
    let corners = cube.positions().iter().map(|p| p.map(|x| 2.0 * x)).collect();
    let cage = told(Cage::new(corners, shapes::CUBE))?;
    let made = told(cage_to_mesh(&cage, budget, &Job::default()))?;
    Ok((made.shape.faces().len(), made.bound.at_most()))
}

/// A torus, 6 units wide.
fn field(budget: &Budget) -> Result<(usize, Option<f64>), String> {
    let made = told(field_to_mesh(&told(torus(2.2, 0.8))?, budget, &Job::default()))?;
    Ok((made.shape.faces().len(), made.bound.at_most()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surfaces_take_twice_as_many_for_half_the_error_and_curves_the_square_root_of_that() {
        for (shape, low, high) in
            [("curve", -0.6, -0.4), ("patch", -1.1, -0.8), ("cage", -1.1, -0.85), ("field", -1.1, -0.9)]
        {
            let question = json!({ "exhibit": "budget", "shape": shape, "step": 3 }).to_string();
            let facts = budget(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts;
            let slope = facts["slope"].as_f64().unwrap();
            assert!((low..high).contains(&slope), "{shape} {slope}");
            for series in facts["series"].as_array().unwrap() {
                for step in series["steps"].as_array().unwrap() {
                    assert!(step[2].as_f64().unwrap() <= step[0].as_f64().unwrap());
                }
            }
        }
    }
}
