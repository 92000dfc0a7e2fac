//! Budget against triangles, for every representation.
use super::answer::ExhibitAnswer;
use super::plane::{once, told};
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
const FIRST: f64 = 0.125; // chosen: an eighth
const HALVINGS: usize = 5; // chosen: all of them take about a second in a browser
/// The names of what is meshed, in this order.
const NAMES: [&str; 7] = ["curve", "patch", "cage", "field", "nurbs", "volume", "mesh"];
/// The torus that is written down in four ways, 3 units wide: the radius of its ring and that of its tube.
const TORUS: [f64; 2] = [1.1, 0.4]; // chosen: one twice as large takes a page's processor twice as long
/// Cells of the volume along its longest side.
const CELLS: usize = 24; // chosen: it is off the torus by a length in the middle of the axis
/// What the mesh was made to, once, from the torus.
const MADE_TO: f64 = 0.0125; // chosen: a length in the middle of the axis, and none of those on it
/// What stands for the torus where a mesh is measured against it.
const CLOSE: f64 = 0.125 / 64.0; // chosen: a tenth of what is measured
/// How much finer measured errors are enclosed.
const GOAL: Goal = Goal { relative: 0.1, absolute: None, max: None }; // chosen: one digit is shown

/// A length, and the segments or triangles that it took with the bound that they have; none where the source is farther off
/// than that.
type Step = (f64, Option<usize>, Option<f64>);

/// What one way of writing a shape down takes at every length.
struct Series {
    steps: Vec<Step>,
    /// How far the source itself is from the shape that it was made from, at most; 0 where it is the shape.
    source_off: f64,
}

/// Answers `{"shape": "patch", "step": 3}`: what each takes at every length, and how steeply that grows over all of them.
pub(super) fn budget(asked: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    asked.only(&["shape", "step"])?;
    let shape = asked.word("shape", &NAMES)?;
    let step = asked.number("step", [0.0, (HALVINGS - 1) as f64])? as usize;
    let all = all()?;
    let chosen = &all[NAMES.iter().position(|name| *name == shape).unwrap_or(0)];
    let [(length, few, bound), (_, many, _)] = [chosen.steps[step], chosen.steps[step + 1]];
    let had: Vec<f64> = chosen.steps.iter().filter_map(|(_, count, _)| count.map(|n| n as f64)).collect();
    let halvings = (had.len() - 1) as f64;
    let series: Vec<Value> = NAMES
        .iter()
        .zip(all)
        .map(|(name, of)| json!({ "name": name, "steps": of.steps, "source_off": of.source_off }))
        .collect();
    Ok(ExhibitAnswer::new(json!({
        "series": series,
        "count": few,
        "length": length,
        "bound": bound,
        "source_off": chosen.source_off,
        "times": few.zip(many).map(|(few, many)| many as f64 / few as f64),
        // A negative zero is none.
        "slope": 0.0 - ln(had[had.len() - 1] / had[0]) / (halvings * ln(2.0)),
    })))
}

fn all() -> Result<&'static [Series; 7], String> {
    static MADE: OnceLock<[Series; 7]> = OnceLock::new();
    once(&MADE, || {
        let whole = |make: fn(&Budget) -> Counted| {
            Ok::<_, String>(Series { steps: steps(0.0, make)?, source_off: 0.0 })
        };
        Ok([whole(curve)?, whole(patch)?, whole(cage)?, whole(field)?, whole(nurbs)?, volume()?, mesh()?])
    })
}

/// A number of segments or triangles, and their bound.
type Counted = Result<(usize, Option<f64>), String>;

/// All lengths for a source that has lost something already: what is left may be lost by the mesh.
fn steps(source_off: f64, make: impl Fn(&Budget) -> Counted) -> Result<Vec<Step>, String> {
    let mut length = FIRST;
    let mut all = Vec::new();
    for _ in 0..=HALVINGS {
        let left = length - source_off;
        if left > 0.0 {
            let (count, bound) = make(&within(left)?)?;
            all.push((length, Some(count), bound.map(|bound| bound + source_off)));
        } else {
            all.push((length, None, None));
        }
        length *= 0.5;
    }
    Ok(all)
}

fn within(length: f64) -> Result<Budget, String> {
    Ok(Budget::length(told(Tolerance::new(length))?))
}

/// The curve that the widget begins with, 8 units wide.
fn curve(budget: &Budget) -> Counted {
    let curve = Bezier { control: [[0.0, 0.0], [2.0, 6.0], [6.0, 6.0], [8.0, 0.0]] };
    let made = told(curve_to_polyline(&Curve::from(curve), budget, &Job::default()))?;
    Ok((made.shape.n_segments(), made.bound.at_most()))
}

/// The teapot, 6.4 units wide.
fn patch(budget: &Budget) -> Counted {
    let made = told(patches_to_mesh(&shapes::teapot(), budget, &Job::default()))?;
    Ok((made.shape.faces().len(), made.bound.at_most()))
}

/// The cube of edge 4 as a Catmull–Clark cage.
fn cage(budget: &Budget) -> Counted {
    let cube = shapes::cube()?;
    let corners = cube.positions().iter().map(|p| p.map(|x| 2.0 * x)).collect();
    let cage = told(Cage::new(corners, shapes::CUBE))?;
    let made = told(cage_to_mesh(&cage, budget, &Job::default()))?;
    Ok((made.shape.faces().len(), made.bound.at_most()))
}

fn ring() -> Result<Field, String> {
    told(torus(TORUS[0], TORUS[1]))
}

/// The torus as a field.
fn field(budget: &Budget) -> Counted {
    let made = told(field_to_mesh(&ring()?, budget, &Job::default()))?;
    Ok((made.shape.faces().len(), made.bound.at_most()))
}

/// The torus as a rational surface of degree 2, which is exact.
fn nurbs(budget: &Budget) -> Counted {
    let made = nurbs_mesh(budget)?;
    Ok((made.shape.faces().len(), made.bound.at_most()))
}

fn nurbs_mesh(budget: &Budget) -> Result<Bounded<Mesh>, String> {
    let surface = told(NurbsSurface::torus(TORUS[0], TORUS[1]))?;
    told(nurbs_to_mesh(&[surface], budget, &Job::default()))
}

/// The torus as samples on a lattice. They have one mesh, that of their cells; smaller cells would follow the surface
/// between the samples, which is not the torus.
fn volume() -> Result<Series, String> {
    let ring = ring()?;
    let lattice = Lattice::around(&ring.bounds(), CELLS, 1).ok_or("the torus has no lattice")?;
    let grid = told(field_to_grid(&ring, &lattice, None, &Job::default()))?;
    // How far it is from the surface between the samples is of no use here, and any length is allowed for it.
    let cells =
        told(grid_to_mesh(&grid, &Polygonize::below(0.0), Some(&within(TORUS[0])?), &Job::default()))?.shape;
    let truth = nurbs_mesh(&within(CLOSE)?)?;
    let found = told(deviation(&cells, &truth.shape, &GOAL, &Job::default()))?.bound.then(&truth.bound);
    let source_off = found.at_most().ok_or("the samples have no bound")?;
    Ok(Series { steps: steps(source_off, |_| Ok((cells.faces().len(), Some(0.0))))?, source_off })
}

/// The torus as triangles, of which as many are taken away as each length allows.
fn mesh() -> Result<Series, String> {
    let made = nurbs_mesh(&within(MADE_TO)?)?;
    let source_off = made.bound.at_most().unwrap_or(MADE_TO);
    let steps = steps(source_off, |budget| {
        let less = told(simplify(&made.shape, budget, Topology::Indices, &Job::default()))?;
        Ok((less.shape.mesh.faces().len(), less.bound.at_most()))
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
