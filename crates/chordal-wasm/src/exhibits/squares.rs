//! Marching squares: a lattice of samples, its isolines, and the corners that they cut off.
use super::answer::ExhibitAnswer;
use super::one_cube::one_cube;
use super::plane::{Latest, SIZE, latest, loops, or_text, raised, thin_mesh};
use super::request::ExhibitRequest;
use chordal::check::{Goal, deviation};
use chordal::convert::{Polygonize, field_to_mesh, grid_to_polyline};
use chordal::explicit::Polyline;
use chordal::implicit::shapes::{circle, rectangle, regular_polygon};
use chordal::implicit::{Affine3, Field, Grid, Samples};
use chordal::{Budget, Job, Mesh, Tolerance};
use serde_json::json;
use std::collections::BTreeSet;
use std::sync::Mutex;

/// Cells along the figure.
const CELLS: [f64; 2] = [6.0, 48.0]; // defined: what the slider offers
/// The tolerance of the outline that errors are measured against.
const CLOSE: f64 = 0.002; // chosen: below a pixel of the figure
/// The relative gap of the measured error.
const GOAL: Goal = Goal { relative: 0.02, absolute: None, max: None }; // chosen: two digits are shown

/// Answers `{"look": "lattice", "cells": 16, "method": "squares", "parts": [[x, y], …]}`: samples, lines and their largest error. A
/// request with "cube" is answered by [`one_cube`].
pub(super) fn squares(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    if request.word("look", &["lattice", "cube"])? == "cube" {
        return one_cube(request);
    }
    request.only(&["look", "cells", "method", "parts"])?;
    let cells = request.number("cells", CELLS)?.round();
    let method = request.word("method", &["squares", "corners"])?;
    let step = SIZE[0] / cells;
    let parts = request.points::<2>("parts", [3, 3])?;
    let shape = shapes(&parts)?;
    let grid = sampled(&shape, step)?;
    let lines = match method {
        "squares" => or_text(grid_to_polyline(&grid, &Polygonize::below(0.0), &Job::default()))?.shape,
        _ => with_corners(&shape, 0.25 * step)?,
    };
    static TRUTH: Latest<Vec<[f64; 2]>, Vec<Polyline<2>>> = Mutex::new(None);
    let truth = latest(&TRUTH, parts, || with_corners(&shape, CLOSE))?;
    let measured = or_text(deviation(&thin_mesh(&truth)?, &thin_mesh(&lines)?, &GOAL, &Job::default()))?;
    let worst = *measured.worst();
    let mut answer = ExhibitAnswer::default();
    let values: Vec<f64> = (0..grid.samples().len()).map(|row| grid.samples().get(row)).collect();
    answer.facts = json!({
        "look": "lattice",
        "step": step,
        "size": [grid.size()[0], grid.size()[1]],
        "values": answer.floats(&values),
        "truth": loops(&mut answer, &truth),
        "lines": loops(&mut answer, &lines),
        "segments": lines.iter().map(Polyline::n_segments).sum::<usize>(),
        "ambiguous": ambiguous(&grid),
        "error": measured.bound.at_most(),
        "error_at_least": measured.bound.at_least(),
        "worst": [[worst.from[0], worst.from[1]], [worst.to[0], worst.to[1]]],
    });
    Ok(answer)
}

/// A square on its corner, a triangle that almost touches it, and a disc, by their middles.
fn shapes(parts: &[[f64; 2]]) -> Result<Field, String> {
    let at = |k: usize| [parts[k][0], parts[k][1], 0.0];
    let square = or_text(or_text(rectangle([3.2, 3.2]))?.rotated_deg([0.0, 0.0, 1.0], 33.0))?;
    let square = or_text(square.moved(at(0)))?;
    let wedge = or_text(or_text(regular_polygon(3, 2.0))?.rotated_deg([0.0, 0.0, 1.0], 172.0))?;
    let wedge = or_text(wedge.moved(at(1)))?;
    let disc = or_text(or_text(circle(1.3))?.moved(at(2)))?;
    Ok(square.union(&wedge).union(&disc))
}

fn sampled(shape: &Field, step: f64) -> Result<Grid, String> {
    let n = SIZE.map(|side| (side / step).round() as usize + 1);
    let points: Vec<[f64; 3]> =
        (0..n[0] * n[1]).map(|row| raised([row % n[0], row / n[0]].map(|i| step * i as f64))).collect();
    let mut values = vec![0.0; points.len()];
    or_text(shape.tape().at(&points, &mut values))?;
    let place = or_text(Affine3::cubes([0.0; 3], step))?;
    or_text(Grid::new([n[0], n[1], 1], Samples::F64(values), place))
}

/// The ambiguous cells: their corners alternate between inside and outside, so their four crossings can be
/// joined in two ways.
fn ambiguous(grid: &Grid) -> Vec<[usize; 2]> {
    let [nx, ny, _] = grid.size();
    let inside = |i, j| grid.sample([i, j, 0]) < 0.0;
    let mixed = |[i, j]: &[usize; 2]| {
        let [a, b, c, d] = [inside(*i, *j), inside(i + 1, *j), inside(i + 1, j + 1), inside(*i, j + 1)];
        a == c && b == d && a != b
    };
    (0..ny - 1).flat_map(|j| (0..nx - 1).map(move |i| [i, j])).filter(mixed).collect()
}

/// The outline by the mesher of fields, which puts vertices where two primitives meet: the rim of the upper
/// face of a slab over the shape.
fn with_corners(shape: &Field, length: f64) -> Result<Vec<Polyline<2>>, String> {
    let slab = or_text(shape.extruded(2.0))?;
    let budget = Budget::length(or_text(Tolerance::new(length))?);
    let mesh = or_text(field_to_mesh(&slab, &budget, &Job::default()))?;
    Ok(rim(&mesh.shape))
}

/// The rim of the highest face of a mesh, counter-clockwise.
fn rim(mesh: &Mesh) -> Vec<Polyline<2>> {
    let top = mesh.positions().iter().fold(f64::NEG_INFINITY, |most, p| chordal::math::greater(p[2], most));
    let is_top = |row: u32| mesh.positions()[row as usize][2] == top;
    let mut sides = BTreeSet::new();
    for face in mesh.faces().iter().filter(|face| face.iter().all(|row| is_top(*row))) {
        for k in 0..3 {
            let [from, to] = [face[k], face[(k + 1) % 3]];
            // An edge that two faces share occurs in both directions, and is no part of the rim.
            if !sides.remove(&[to, from]) {
                sides.insert([from, to]);
            }
        }
    }
    let mut lines = Vec::new();
    while let Some([first, mut row]) = sides.pop_first() {
        let mut rows = vec![first];
        while row != first {
            rows.push(row);
            let Some(after) = sides.range([row, 0]..=[row, u32::MAX]).next().copied() else { break };
            sides.remove(&after);
            row = after[1];
        }
        let points = rows.iter().map(|row| mesh.positions()[*row as usize]).map(|[x, y, _]| [x, y]).collect();
        lines.push(Polyline { points, places: Vec::new(), closed: true });
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    const PARTS: [[f64; 2]; 3] = [[3.3, 3.9], [7.45, 4.75], [9.8, 2.5]];

    fn at(cells: u32, method: &str) -> serde_json::Value {
        let question =
            json!({ "exhibit": "squares", "look": "lattice", "cells": cells, "method": method, "parts": PARTS }).to_string();
        squares(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn squares_cut_corners_off_and_the_mesher_keeps_them() {
        let error = |cells, method| at(cells, method)["error"].as_f64().unwrap();
        let [coarse, fine] = [12, 48].map(|cells| error(cells, "squares"));
        // Halving the cells halves what is cut off a corner, and no more.
        assert!(fine < 0.5 * coarse && fine > 0.1 * coarse, "{coarse} {fine}");
        for cells in [12, 24] {
            assert!(error(cells, "corners") < 0.3 * error(cells, "squares"), "{}", error(cells, "corners"));
            assert!(error(cells, "corners") <= 0.25 * 12.0 / f64::from(cells) + CLOSE);
        }
    }

    #[test]
    fn some_sizes_have_cells_that_can_be_read_two_ways() {
        let counts: Vec<usize> =
            (6..=48).map(|cells| at(cells, "squares")["ambiguous"].as_array().unwrap().len()).collect();
        assert!(counts.iter().any(|n| *n > 0) && counts.contains(&0), "{counts:?}");
    }
}
