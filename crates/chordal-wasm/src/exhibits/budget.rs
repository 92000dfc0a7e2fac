//! The number of triangles by budget, for every representation.
use super::answer::ExhibitAnswer;
use super::plane::{once, or_text};
use super::request::ExhibitRequest;
use super::shapes;
use chordal::check::{Goal, deviation};
use chordal::convert::lattices::Lattice;
use chordal::convert::{
    Polygonize, cage_to_mesh, curve_to_polyline, field_to_grid, field_to_mesh, grid_to_mesh, nurbs_to_mesh,
    patches_to_mesh,
};
use chordal::explicit::nurbs::NurbsSurface;
use chordal::explicit::{Cage, Topology};
use chordal::implicit::Field;
use chordal::implicit::shapes::torus;
use chordal::lod::simplify;
use chordal::math::elementary::ln;
use chordal::{Bezier, Bounded, Budget, Curve, Job, Mesh, Tolerance};
use serde_json::{Value, json};
use std::sync::OnceLock;

/// The lengths, each half of the one before.
const FIRST: f64 = 0.125; // chosen: coarse enough for few triangles
const HALVINGS: usize = 5; // chosen: all of them take about a second in a browser
/// The names of the representations, in this order.
const NAMES: [&str; 7] = ["curve", "patch", "cage", "field", "nurbs", "volume", "mesh"];
/// The torus in four representations, 3 units wide: the radii of its ring and of its tube.
const TORUS: [f64; 2] = [1.1, 0.4]; // chosen: one twice as large takes a page twice as long
/// Cells of the volume along its longest side.
const CELLS: usize = 24; // chosen: its error is a length in the middle of the axis
/// The tolerance of the mesh that is simplified.
const MADE_TO: f64 = 0.0125; // chosen: a length in the middle of the axis, and none of those on it
/// The tolerance of the mesh that represents the torus in measurements.
const CLOSE: f64 = 0.125 / 64.0; // chosen: a tenth of the measured errors
/// The relative gap of measured errors.
const GOAL: Goal = Goal { relative: 0.1, absolute: None, max: None }; // chosen: one digit is shown

/// A length, the number of segments or triangles for it, and their bound; `None` if the error of the source
/// exceeds the length.
type Step = (f64, Option<usize>, Option<f64>);

/// The steps of one representation.
struct Series {
    steps: Vec<Step>,
    /// The largest distance of the source from the shape that it represents; 0 if it is the shape.
    source_off: f64,
}

/// Answers `{"shape": "patch", "step": 3}`: the numbers of triangles of each representation at every length,
/// and the slope of their growth.
pub(super) fn budget(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["shape", "step"])?;
    let shape = request.word("shape", &NAMES)?;
    let step = request.number("step", [0.0, (HALVINGS - 1) as f64])? as usize;
    let all_series = all_series()?;
    let chosen = &all_series[NAMES.iter().position(|name| *name == shape).unwrap_or(0)];
    let [(length, count, bound), (_, next_count, _)] = [chosen.steps[step], chosen.steps[step + 1]];
    let counts: Vec<f64> = chosen.steps.iter().filter_map(|(_, count, _)| count.map(|n| n as f64)).collect();
    let halvings = (counts.len() - 1) as f64;
    let series: Vec<Value> = NAMES
        .iter()
        .zip(all_series)
        .map(|(name, series)| json!({ "name": name, "steps": series.steps, "source_off": series.source_off }))
        .collect();
    Ok(ExhibitAnswer::new(json!({
        "series": series,
        "count": count,
        "length": length,
        "bound": bound,
        "source_off": chosen.source_off,
        "times": count.zip(next_count).map(|(count, next_count)| next_count as f64 / count as f64),
        // Turns −0 into 0.
        "slope": 0.0 - ln(counts[counts.len() - 1] / counts[0]) / (halvings * ln(2.0)),
    })))
}

fn all_series() -> Result<&'static [Series; 7], String> {
    static MADE: OnceLock<[Series; 7]> = OnceLock::new();
    once(&MADE, || {
        let exact = |make: fn(&Budget) -> Counted| {
            Ok::<_, String>(Series { steps: steps(0.0, make)?, source_off: 0.0 })
        };
        Ok([exact(curve)?, exact(patch)?, exact(cage)?, exact(field)?, exact(nurbs)?, volume()?, mesh()?])
    })
}

/// A number of segments or triangles, and their bound.
type Counted = Result<(usize, Option<f64>), String>;

/// The steps of a source with an error of its own: the mesh may use the remaining length.
fn steps(source_off: f64, make: impl Fn(&Budget) -> Counted) -> Result<Vec<Step>, String> {
    let mut length = FIRST;
    let mut steps = Vec::new();
    for _ in 0..=HALVINGS {
        let left = length - source_off;
        if left > 0.0 {
            let (count, bound) = make(&within(left)?)?;
            steps.push((length, Some(count), bound.map(|bound| bound + source_off)));
        } else {
            steps.push((length, None, None));
        }
        length *= 0.5;
    }
    Ok(steps)
}

fn within(length: f64) -> Result<Budget, String> {
    Ok(Budget::length(or_text(Tolerance::new(length))?))
}

/// The curve that the page shows first, 8 units wide.
fn curve(budget: &Budget) -> Counted {
    let curve = Bezier { control: [[0.0, 0.0], [2.0, 6.0], [6.0, 6.0], [8.0, 0.0]] };
    let polyline = or_text(curve_to_polyline(&Curve::from(curve), budget, &Job::default()))?;
    Ok((polyline.shape.n_segments(), polyline.bound.at_most()))
}

/// The teapot, 6.4 units wide.
fn patch(budget: &Budget) -> Counted {
    let mesh = or_text(patches_to_mesh(&shapes::teapot(), budget, &Job::default()))?;
    Ok((mesh.shape.faces().len(), mesh.bound.at_most()))
}

/// The cube of edge 4 as a Catmull–Clark cage.
fn cage(budget: &Budget) -> Counted {
    let cube = shapes::cube()?;
    let corners = cube.positions().iter().map(|p| p.map(|x| 2.0 * x)).collect();
    let cage = or_text(Cage::new(corners, shapes::CUBE))?;
    let mesh = or_text(cage_to_mesh(&cage, budget, &Job::default()))?;
    Ok((mesh.shape.faces().len(), mesh.bound.at_most()))
}

fn ring() -> Result<Field, String> {
    or_text(torus(TORUS[0], TORUS[1]))
}

/// The torus as a field.
fn field(budget: &Budget) -> Counted {
    let mesh = or_text(field_to_mesh(&ring()?, budget, &Job::default()))?;
    Ok((mesh.shape.faces().len(), mesh.bound.at_most()))
}

/// The torus as a rational surface of degree 2, which is exact.
fn nurbs(budget: &Budget) -> Counted {
    let mesh = nurbs_mesh(budget)?;
    Ok((mesh.shape.faces().len(), mesh.bound.at_most()))
}

fn nurbs_mesh(budget: &Budget) -> Result<Bounded<Mesh>, String> {
    let surface = or_text(NurbsSurface::torus(TORUS[0], TORUS[1]))?;
    or_text(nurbs_to_mesh(&[surface], budget, &Job::default()))
}

/// The torus as samples on a lattice. They have only the mesh of their cells: smaller cells would approximate
/// the interpolant instead of the torus.
fn volume() -> Result<Series, String> {
    let ring = ring()?;
    let lattice = Lattice::around(&ring.bounds(), CELLS, 1).ok_or("the torus has no lattice")?;
    let grid = or_text(field_to_grid(&ring, &lattice, None, &Job::default()))?;
    // The distance to the interpolant does not matter here, so any length is allowed.
    let cells =
        or_text(grid_to_mesh(&grid, &Polygonize::below(0.0), Some(&within(TORUS[0])?), &Job::default()))?
            .shape;
    let truth = nurbs_mesh(&within(CLOSE)?)?;
    let bound = or_text(deviation(&cells, &truth.shape, &GOAL, &Job::default()))?.bound.then(&truth.bound);
    let source_off = bound.at_most().ok_or("the samples have no bound")?;
    // The cells add nothing: their whole distance from the torus is that of the source.
    Ok(Series { steps: steps(source_off, |_| Ok((cells.faces().len(), Some(0.0))))?, source_off })
}

/// The torus as triangles, simplified as far as each length allows.
fn mesh() -> Result<Series, String> {
    let torus = nurbs_mesh(&within(MADE_TO)?)?;
    let source_off = torus.bound.at_most().unwrap_or(MADE_TO);
    let steps = steps(source_off, |budget| {
        let simplified = or_text(simplify(&torus.shape, budget, Topology::Indices, &Job::default()))?;
        Ok((simplified.shape.mesh.faces().len(), simplified.bound.at_most()))
    })?;
    Ok(Series { steps, source_off })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(shape: &str, step: usize) -> Value {
        let question = json!({ "exhibit": "budget", "shape": shape, "step": step }).to_string();
        budget(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn surfaces_take_twice_as_many_for_half_the_error_and_curves_the_square_root_of_that() {
        for (shape, low, high) in [
            ("curve", -0.6, -0.4),
            ("patch", -1.1, -0.8),
            ("cage", -1.1, -0.85),
            ("field", -1.1, -0.9),
            ("nurbs", -1.1, -0.75),
        ] {
            let facts = at(shape, 3);
            let slope = facts["slope"].as_f64().unwrap();
            assert!((low..high).contains(&slope), "{shape} {slope}");
            for series in facts["series"].as_array().unwrap() {
                for step in series["steps"].as_array().unwrap() {
                    assert!(step[2].is_null() || step[2].as_f64().unwrap() <= step[0].as_f64().unwrap());
                }
            }
        }
    }

    #[test]
    fn samples_and_triangles_are_not_finer_than_they_are() {
        for shape in ["volume", "mesh"] {
            let facts = at(shape, 4);
            assert_eq!([&facts["count"], &facts["times"]], [&Value::Null; 2]);
            let off = facts["source_off"].as_f64().unwrap();
            let series = facts["series"].as_array().unwrap();
            let series = series.iter().find(|series| series["name"] == shape).unwrap();
            for (i, step) in series["steps"].as_array().unwrap().iter().enumerate() {
                assert_eq!(step[1].is_u64(), i <= 3, "{shape} {i}");
                assert_eq!(step[1].is_u64(), step[0].as_f64().unwrap() > off, "{shape} {i}");
            }
        }
        // Whatever may be lost, samples take the triangles of their cells.
        assert_eq!((&at("volume", 0)["slope"], &at("volume", 0)["times"]), (&json!(0.0), &json!(1.0)));
        assert!(at("mesh", 0)["slope"].as_f64().unwrap() < -1.0);
    }
}
