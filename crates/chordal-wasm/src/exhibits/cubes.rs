//! Marching cubes of a whole surface: its cells, the corners that it cuts off, and the mesher that keeps them.
use super::answer::ExhibitAnswer;
use super::plane::{once, or_text};
use super::request::ExhibitRequest;
use chordal::check::{Goal, deviation};
use chordal::convert::{Polygonize, field_to_mesh, grid_to_mesh};
use chordal::implicit::shapes::{cuboid, cylinder, sphere};
use chordal::implicit::{Affine3, Field, Grid, Samples};
use chordal::{Budget, Job, Mesh, Tolerance};
use serde_json::json;
use std::sync::OnceLock;

/// Cells along a side.
const CELLS: [f64; 2] = [4.0, 40.0]; // defined: what the slider offers
/// Half the side of the lattice.
const HALF: f64 = 1.0;
/// The error of the surface that others are compared with.
const CLOSE: f64 = 0.002; // chosen: a fifth of the smallest error here
/// The relative gap of the measured error.
const GOAL: Goal = Goal { relative: 0.05, absolute: None, max: None }; // chosen: two digits are shown

/// Answers `{"cells": 12, "method": "cubes", "slice": 6}`: the mesh, the cells that it crosses, a slice of samples, and
/// the largest error.
pub(super) fn cubes(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["cells", "method", "slice"])?;
    let cells = request.number("cells", CELLS)?.round() as usize;
    let method = request.word("method", &["cubes", "corners"])?;
    let slice = (request.number("slice", [0.0, 1.0])? * cells as f64).round() as usize;
    let shape = shape()?;
    let step = 2.0 * HALF / cells as f64;
    let n = cells + 1;
    let at = |k: usize| step * k as f64 - HALF;
    let points: Vec<[f64; 3]> =
        (0..n * n * n).map(|row| [at(row % n), at(row / n % n), at(row / n / n)]).collect();
    let mut values = vec![0.0; points.len()];
    or_text(shape.tape().at(&points, &mut values))?;
    let crossed = crossed(&values, cells);
    let layer: Vec<f64> = values[slice * n * n..][..n * n].to_vec();
    let mesh = if method == "cubes" {
        let place = or_text(Affine3::cubes([-HALF; 3], step))?;
        let grid = or_text(Grid::new([n; 3], Samples::F64(values), place))?;
        or_text(grid_to_mesh(&grid, &Polygonize::below(0.0), None, &Job::default()))?.shape
    } else {
        // A sixteenth of a cell: still far fewer triangles.
        meshed(&shape, step / 16.0)?
    };
    static TRUTH: OnceLock<Mesh> = OnceLock::new();
    let truth = once(&TRUTH, || meshed(&shape, CLOSE))?;
    let measured = or_text(deviation(truth, &mesh, &GOAL, &Job::default()))?;
    let worst = *measured.worst();
    let mut answer = ExhibitAnswer::default();
    let lines: Vec<f64> = crossed.iter().flat_map(|cell| cube_edges(cell.map(at), step)).flatten().collect();
    let shown = answer.mesh(&mesh);
    answer.facts = json!({
        "mesh": shown,
        "edges": answer.edges(mesh.positions(), mesh.faces()),
        "step": step,
        "slice": at(slice),
        "layer": answer.floats(&layer),
        "cells": answer.floats(&lines),
        "crossed": crossed.len(),
        "all": cells * cells * cells,
        "triangles": mesh.faces().len(),
        "error": measured.bound.at_most(),
        "worst": [worst.from, worst.to],
    });
    Ok(answer)
}

/// A cube with round edges on one side, rounded off by a ball, and bored through; turned, so that no face is parallel to
/// the lattice.
fn shape() -> Result<Field, String> {
    let block = or_text(cuboid([1.16, 1.16, 1.16]))?;
    let ball = or_text(sphere(0.79))?;
    let bore = or_text(cylinder(0.3, 3.0))?;
    let shape = block.intersection(&ball).difference(&bore);
    let turned = or_text(shape.rotated_deg([0.0, 0.0, 1.0], 28.0))?;
    or_text(turned.rotated_deg([1.0, 0.0, 0.0], 21.0))
}

fn meshed(shape: &Field, length: f64) -> Result<Mesh, String> {
    let budget = Budget::length(or_text(Tolerance::new(length))?);
    Ok(or_text(field_to_mesh(shape, &budget, &Job::default()))?.shape)
}

/// The cells whose corners are not all on one side.
fn crossed(values: &[f64], cells: usize) -> Vec<[usize; 3]> {
    let n = cells + 1;
    let inside = |i: usize, j: usize, k: usize| values[(k * n + j) * n + i] < 0.0;
    let mut list = Vec::new();
    for (k, j, i) in (0..cells).flat_map(|k| (0..cells).flat_map(move |j| (0..cells).map(move |i| (k, j, i))))
    {
        let count = (0..8).filter(|c| inside(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))).count();
        if count % 8 != 0 {
            list.push([i, j, k]);
        }
    }
    list
}

/// The twelve edges of a cube, two points each.
fn cube_edges(low: [f64; 3], side: f64) -> Vec<[f64; 3]> {
    let corner = |c: usize| std::array::from_fn(|k| low[k] + if c >> k & 1 == 1 { side } else { 0.0 });
    (0..8_usize)
        .flat_map(|c| (0..3).filter(move |k| c >> k & 1 == 0).map(move |k| (c, c | 1 << k)))
        .flat_map(|(a, b)| [corner(a), corner(b)])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halving_the_cells_halves_the_error_at_edges_and_the_mesher_keeps_them() {
        let at = |cells: u32, method: &str| {
            let question =
                json!({ "exhibit": "cubes", "cells": cells, "method": method, "slice": 0.5 }).to_string();
            cubes(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts
        };
        let error = |facts: &serde_json::Value| facts["error"].as_f64().unwrap();
        let [coarse, fine, corners] = [at(10, "cubes"), at(20, "cubes"), at(10, "corners")];
        assert!(error(&fine) < 0.8 * error(&coarse) && error(&fine) > 0.25 * error(&coarse));
        assert!(error(&corners) < 0.25 * error(&coarse));
        let crossed = |facts: &serde_json::Value| facts["crossed"].as_u64().unwrap();
        // Four times as many cells on a surface, of eight times as many.
        assert!(crossed(&fine) > 3 * crossed(&coarse) && crossed(&fine) < 6 * crossed(&coarse));
    }
}
