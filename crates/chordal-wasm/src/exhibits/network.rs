//! A learned occupancy: a small network, its samples on a lattice, and the mesh of a threshold.
use super::answer::ExhibitAnswer;
use super::plane::{once, or_text};
use super::request::ExhibitRequest;
use chordal::Job;
use chordal::check::validity;
use chordal::convert::{Polygonize, grid_to_mesh};
use chordal::explicit::Topology;
use chordal::implicit::evaluation::Tape;
use chordal::implicit::shapes::{sphere, torus};
use chordal::implicit::{Affine3, Expr, Field, Grid, Samples};
use chordal::math::{Box3, Interval};
use serde_json::json;
use std::sync::OnceLock;

/// A row for each unit: its weights, then its bias. Written by `studio/scripts/train_network.mjs`.
const WEIGHTS: &str = include_str!("network_weights.txt");
/// The inputs, and the units of each layer.
const SIZES: [usize; 4] = [3, 16, 16, 1];
/// The range of the samples along a side.
const CELLS: [f64; 2] = [4.0, 64.0]; // defined: what the slider offers
const THRESHOLDS: [f64; 2] = [0.02, 0.98]; // defined: what the slider offers
/// Half the side of the lattice.
const HALF: f64 = 1.0; // defined: the network was trained in there
/// Cells along a side for which intervals decide whether the surface may pass.
const BOXES: usize = 16; // chosen: more would be slow

/// Answers `{"cells": 24, "threshold": 0.5, "probe": [x, z]}`: the samples, the mesh, and the occupancy along a line.
pub(super) fn network(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["cells", "threshold", "probe"])?;
    let cells = request.number("cells", CELLS)?.round() as usize;
    let threshold = request.number("threshold", THRESHOLDS)?;
    let probe = request.point::<3>("probe")?;
    static MADE: OnceLock<Network> = OnceLock::new();
    let network = once(&MADE, Network::read)?;
    let step = 2.0 * HALF / cells as f64;
    let points = lattice(cells);
    let mut values = vec![0.0; points.len()];
    or_text(network.occupancy.at(&points, &mut values))?;
    let inside: Vec<[f64; 3]> =
        points.iter().zip(&values).filter(|(_, value)| **value > threshold).map(|(p, _)| *p).collect();
    let place = or_text(Affine3::cubes([-HALF; 3], step))?;
    let grid = or_text(Grid::new([cells + 1; 3], Samples::F64(values), place))?;
    // An error means that no sample is above the threshold.
    let mesh =
        grid_to_mesh(&grid, &Polygonize::above(threshold), None, &Job::default()).ok().map(|mesh| mesh.shape);
    let undecided = network.undecided(threshold)?;
    let mut here = [[0.0]; 2];
    or_text(network.occupancy.at(&[probe], &mut here[0]))?;
    or_text(network.truth.at(&[probe], &mut here[1]))?;
    let mut answer = ExhibitAnswer::default();
    let shown = mesh.as_ref().map(|mesh| answer.mesh(mesh));
    answer.facts = json!({
        "mesh": shown,
        "edges": mesh.as_ref().map(|mesh| answer.edges(mesh.positions(), mesh.faces())),
        "inside": answer.floats(inside.as_flattened()),
        "samples": points.len(),
        "n_inside": inside.len(),
        "triangles": mesh.as_ref().map_or(0, |mesh| mesh.faces().len()),
        "pieces": mesh.as_ref().map_or(0, |mesh| validity(mesh, Topology::Indices).components),
        "weights": network.n_weights,
        "sizes": SIZES,
        "step": step,
        "occupancy": here[0][0],
        "distance": here[1][0],
        "line": network.along(probe)?,
        "boxes": BOXES * BOXES * BOXES,
        "undecided": undecided,
    });
    Ok(answer)
}

fn lattice(cells: usize) -> Vec<[f64; 3]> {
    let n = cells + 1;
    let at = |k: usize| 2.0 * HALF * k as f64 / cells as f64 - HALF;
    (0..n * n * n).map(|row| [at(row % n), at(row / n % n), at(row / n / n)]).collect()
}

struct Network {
    occupancy: Tape,
    /// The shape that it was trained on.
    truth: Tape,
    n_weights: usize,
}

impl Network {
    /// The network as an expression, so that the core evaluates it at points and over boxes.
    fn read() -> Result<Self, String> {
        let rows: Vec<Vec<f64>> = WEIGHTS
            .lines()
            .map(|line| line.split_ascii_whitespace().filter_map(|word| word.parse().ok()).collect())
            .collect();
        let bent = |x: &Expr| x / (x.square() + 1.0).sqrt();
        let mut layer: Vec<Expr> = Expr::axes().to_vec();
        let mut rows_left = rows.iter();
        for (l, n) in SIZES[1..].iter().enumerate() {
            let mut next = Vec::new();
            for row in rows_left.by_ref().take(*n) {
                let (bias, weights) = row.split_last().ok_or("a unit has no weights")?;
                if weights.len() != layer.len() {
                    return Err(format!("a unit has {} weights for {} inputs", weights.len(), layer.len()));
                }
                let terms = layer.iter().zip(weights).map(|(input, weight)| input * *weight);
                let sum = terms.fold(Expr::constant(*bias), |sum, term| sum + term);
                next.push(if l + 2 < SIZES.len() { bent(&sum) } else { sum });
            }
            layer = next;
        }
        let last = layer.first().ok_or("the network has no output")?;
        let occupancy = Tape::new(&(bent(last) * 0.5 + 0.5));
        let truth = kettlebell()?.tape();
        Ok(Self { occupancy, truth, n_weights: rows.iter().map(Vec::len).sum() })
    }

    /// Occupancy and true distance along the line through a point along x: `[x, occupancy, distance]`.
    fn along(&self, [_, y, z]: [f64; 3]) -> Result<Vec<[f64; 3]>, String> {
        /// Points on the line.
        const POINTS: usize = 121; // chosen: three pixels of the chart apart
        let at = |k: usize| HALF * (2.0 * k as f64 / (POINTS - 1) as f64 - 1.0);
        let points: Vec<[f64; 3]> = (0..POINTS).map(|k| [at(k), y, z]).collect();
        let (mut occupancy, mut distance) = (vec![0.0; POINTS], vec![0.0; POINTS]);
        or_text(self.occupancy.at(&points, &mut occupancy))?;
        or_text(self.truth.at(&points, &mut distance))?;
        Ok((0..POINTS).map(|k| [at(k), occupancy[k], distance[k]]).collect())
    }

    /// The number of boxes for which interval arithmetic does not exclude the threshold.
    fn undecided(&self, threshold: f64) -> Result<usize, String> {
        static RANGES: OnceLock<Vec<Interval>> = OnceLock::new();
        let ranges = once(&RANGES, || {
            let side = 2.0 * HALF / BOXES as f64;
            let corner = |row: usize| [row % BOXES, row / BOXES % BOXES, row / BOXES / BOXES];
            let boxes: Vec<Box3> = (0..BOXES * BOXES * BOXES)
                .map(|row| corner(row).map(|k| side * k as f64 - HALF))
                .map(|min| Box3 { min, max: min.map(|x| x + side) })
                .collect();
            let mut ranges = vec![Interval::UNKNOWN; boxes.len()];
            or_text(self.occupancy.over(&boxes, &mut ranges))?;
            Ok(ranges)
        })?;
        Ok(ranges.iter().filter(|range| range.contains(threshold)).count())
    }
}

/// A ball with a ring as its handle.
fn kettlebell() -> Result<Field, String> {
    let ball = or_text(or_text(sphere(0.55))?.moved([0.0, 0.0, -0.25]))?;
    let ring = or_text(or_text(torus(0.36, 0.13))?.rotated_deg([1.0, 0.0, 0.0], 90.0))?;
    Ok(ball.union(&or_text(ring.moved([0.0, 0.0, 0.38]))?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(cells: usize, threshold: f64) -> serde_json::Value {
        let question =
            json!({ "exhibit": "network", "cells": cells, "threshold": threshold, "probe": [0.0, 0.0, 0.0] });
        network(&ExhibitRequest::parse(question.to_string().as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn the_network_has_learned_the_shape_but_not_the_distance() {
        let network = Network::read().unwrap();
        assert_eq!(network.n_weights, 3 * 16 + 16 + 16 * 16 + 16 + 16 + 1);
        let points = lattice(20);
        let [mut learned, mut truth] = [vec![0.0; points.len()], vec![0.0; points.len()]];
        network.occupancy.at(&points, &mut learned).unwrap();
        network.truth.at(&points, &mut truth).unwrap();
        let wrong = learned.iter().zip(&truth).filter(|(o, d)| (**o > 0.5) != (**d < 0.0)).count();
        assert!(wrong * 100 < points.len(), "{wrong} of {}", points.len());
    }

    #[test]
    fn a_higher_threshold_shrinks_the_mesh_and_the_handle_keeps_its_hole() {
        let [low, middle, high] = [0.1, 0.5, 0.9].map(|threshold| at(32, threshold));
        let inside = |facts: &serde_json::Value| facts["n_inside"].as_u64().unwrap();
        assert!(inside(&low) > inside(&middle) && inside(&middle) > inside(&high));
        assert_eq!(middle["pieces"], 1);
        let undecided = middle["undecided"].as_u64().unwrap();
        assert!(undecided > 0 && undecided <= 4096, "{undecided}");
    }
}
