//! A mesh baked to a grid and back: two bounds that add up, and the measured error.
use super::answer::ExhibitAnswer;
use super::plane::or_text;
use super::request::ExhibitRequest;
use super::shapes;
use chordal::check::{Goal, deviation, vertex_deviation, zero_set_deviation};
use chordal::convert::{Polygonize, grid_to_mesh, mesh_to_grid};
use chordal::{Bound, Job, Mesh, Tolerance};
use serde_json::{Value, json};

/// Cells along the longest side.
const CELLS: [f64; 2] = [6.0, 36.0]; // defined: what the slider offers
/// Fractions of a cell that a proof is tried with, as `chordal bake --bound` does.
const TRIED: [f64; 8] = [0.25, 0.5, 0.875, 1.25, 2.0, 4.0, 8.0, 16.0]; // chosen: more would hardly help
const GOAL: Goal = Goal { relative: 0.02, absolute: None, max: None }; // chosen: two digits are shown

/// Answers `{"shape": "cylinder", "cells": 16}`: the mesh, the mesh of its grid, and how far they are apart.
pub(super) fn baking(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["shape", "cells"])?;
    let name = request.word("shape", &["teapot", "cylinder", "cube"])?;
    let cells = request.number("cells", CELLS)?.round() as usize;
    let mesh = shapes::by_name(name)?;
    // The teapot has no faces parallel to the lattice, and stands upright.
    let mesh = if name == "teapot" { mesh } else { tilted(&mesh)? };
    let job = Job::default();
    let baked = or_text(mesh_to_grid(&mesh, cells, None, &job))?;
    let cell = baked.grid.affine().rows()[0][0];
    let mut grid_bound = None;
    for part in TRIED {
        grid_bound =
            or_text(zero_set_deviation(&mesh, &baked.grid, or_text(Tolerance::new(part * cell))?, &job))?;
        if grid_bound.is_some() {
            break;
        }
    }
    let back = or_text(grid_to_mesh(&baked.grid, &Polygonize::below(0.0), None, &job))?;
    let sum = grid_bound.as_ref().map(|bound| bound.then(&back.bound));
    let measured = or_text(deviation(&mesh, &back.shape, &GOAL, &job))?;
    let distances = or_text(vertex_deviation(&back.shape, &mesh, &job))?;
    let worst = *measured.worst();
    let mut answer = ExhibitAnswer::default();
    let [before, after] = [&mesh, &back.shape].map(|mesh| answer.mesh(mesh));
    answer.facts = json!({
        "mesh": before,
        "back": after,
        "off": answer.floats(&distances),
        "cell": cell,
        "samples": baked.grid.samples().len(),
        "triangles": [mesh.faces().len(), back.shape.faces().len()],
        "there": at_most(grid_bound.as_ref()),
        "home": at_most(Some(&back.bound)),
        "bound": at_most(sum.as_ref()),
        "measured": measured.bound.at_most(),
        "measured_at_least": measured.bound.at_least(),
        "worst": [worst.from, worst.to],
    });
    Ok(answer)
}

fn at_most(bound: Option<&Bound>) -> Option<Value> {
    bound.and_then(Bound::at_most).map(Value::from)
}

/// Rotates a mesh, so that no face is parallel to the lattice.
fn tilted(mesh: &Mesh) -> Result<Mesh, String> {
    let [(s, c), (t, d)] = [0.4, 0.5].map(chordal::math::elementary::sin_cos); // chosen: by eye
    let turn = |[x, y, z]: &[f64; 3]| {
        let [x, y] = [c * x - s * y, s * x + c * y];
        [x, d * y - t * z, t * y + d * z]
    };
    shapes::mesh_from(mesh.positions().iter().map(turn).collect(), mesh.faces().to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_measured_is_within_the_sum_of_the_two_bounds() {
        for shape in ["cylinder", "cube"] {
            for cells in [8, 20] {
                let question = json!({ "exhibit": "baking", "shape": shape, "cells": cells }).to_string();
                let facts = baking(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts;
                let number =
                    |name: &str| facts[name].as_f64().unwrap_or_else(|| panic!("{shape} {cells} {name}"));
                assert!(number("bound") >= number("there") + number("home"));
                assert!(number("measured_at_least") <= number("bound"), "{shape} {cells}");
                assert!(number("bound") < 8.0 * number("cell"), "{shape} {cells} {}", number("bound"));
            }
        }
    }
}
