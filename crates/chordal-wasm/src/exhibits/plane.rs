//! Planar fields and their level curves, for figures of 12 by 8 units.
use super::answer::ExhibitAnswer;
use chordal::convert::{Polygonize, field_to_polyline, grid_to_polyline};
use chordal::explicit::Polyline;
use chordal::implicit::evaluation::Tape;
use chordal::implicit::shapes::{ContourFill, Contours};
use chordal::implicit::{Affine3, Expr, Field, Grid, Samples};
use chordal::{Budget, Job, Mesh, Tolerance};
use serde_json::{Value, json};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// The width and height of a figure.
pub(super) const SIZE: [f64; 2] = [12.0, 8.0];
/// The margin of the samples around the figure. Chosen: the ends of level curves are out of sight.
const BEYOND: f64 = 0.5;
/// A value above all levels, so that level curves close along the border. Chosen: far above those of the
/// figures.
const FAR: f64 = 1e3;

/// A point of the plane in space.
pub(super) fn raised([x, y]: [f64; 2]) -> [f64; 3] {
    [x, y, 0.0]
}

/// The value at a point.
pub(super) fn value_at(tape: &Tape, point: [f64; 2]) -> Result<f64, String> {
    let mut values = [0.0];
    tape.at(&[raised(point)], &mut values).map_err(|error| error.to_string())?;
    Ok(values[0])
}

/// Turns the error of a result into its text.
pub(super) fn or_text<T, E: ToString>(result: Result<T, E>) -> Result<T, String> {
    result.map_err(|error| error.to_string())
}

/// Samples of an expression on a lattice over the figure and its margin; those at the border are [`FAR`].
fn sampled(expr: &Expr, step: f64) -> Result<Grid, String> {
    let n = SIZE.map(|side| ((side + 2.0 * BEYOND) / step) as usize + 1);
    let points: Vec<[f64; 3]> = (0..n[0] * n[1])
        .map(|row| raised([row % n[0], row / n[0]].map(|i| step * i as f64 - BEYOND)))
        .collect();
    let mut values = vec![0.0; points.len()];
    or_text(Tape::new(expr).at(&points, &mut values))?;
    for (row, value) in values.iter_mut().enumerate() {
        let [i, j] = [row % n[0], row / n[0]];
        if i == 0 || j == 0 || i + 1 == n[0] || j + 1 == n[1] {
            *value = FAR;
        }
    }
    let place = or_text(Affine3::cubes([-BEYOND, -BEYOND, 0.0], step))?;
    or_text(Grid::new([n[0], n[1], 1], Samples::F64(values), place))
}

/// The region below a level.
pub(super) struct Region {
    level: f64,
    lines: Vec<Polyline<2>>,
}

/// The regions below each level, as closed lines; good enough for figures, without a bound.
pub(super) fn below(expr: &Expr, levels: &[f64], step: f64) -> Result<Vec<Region>, String> {
    let grid = sampled(expr, step)?;
    let region = |level: &f64| {
        // An error means that nothing is below the level.
        let lines = grid_to_polyline(&grid, &Polygonize::below(*level), &Job::default());
        Region { level: *level, lines: lines.map(|lines| lines.shape).unwrap_or_default() }
    };
    Ok(levels.iter().map(region).collect())
}

/// Regions as arrays of coordinates.
pub(super) fn regions(answer: &mut ExhibitAnswer, regions: &[Region]) -> Value {
    let facts = |region: &Region| json!({ "level": region.level, "loops": loops(answer, &region.lines) });
    regions.iter().map(facts).collect()
}

/// The value of a cell, computed at the first call.
pub(super) fn once<T>(
    cell: &'static OnceLock<T>,
    make: impl FnOnce() -> Result<T, String>,
) -> Result<&'static T, String> {
    match cell.get() {
        Some(value) => Ok(value),
        None => {
            let value = make()?;
            Ok(cell.get_or_init(|| value))
        }
    }
}

/// What was computed last, for a key: a drag of a point asks for the same shapes again and again.
pub(super) type Latest<K, T> = Mutex<Option<(K, Arc<T>)>>;

/// The value for a key, computed unless it is the latest one.
pub(super) fn latest<K: PartialEq, T>(
    cell: &Latest<K, T>,
    key: K,
    make: impl FnOnce() -> Result<T, String>,
) -> Result<Arc<T>, String> {
    let mut kept = cell.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((known, value)) = kept.as_ref()
        && *known == key
    {
        return Ok(Arc::clone(value));
    }
    let value = Arc::new(make()?);
    *kept = Some((key, Arc::clone(&value)));
    Ok(value)
}

/// Closed lines as arrays of coordinates.
pub(super) fn loops(answer: &mut ExhibitAnswer, lines: &[Polyline<2>]) -> Value {
    lines.iter().map(|line| answer.floats(line.points.as_flattened())).collect()
}

/// The outline of a field within a length.
pub(super) fn outline(field: &Field, length: f64) -> Result<Vec<Polyline<2>>, String> {
    let budget = Budget::length(or_text(Tolerance::new(length))?);
    Ok(or_text(field_to_polyline(field, &budget, &Job::default()))?.shape)
}

/// The exact signed distance to lines, as a field.
pub(super) fn distance_to(lines: &[Polyline<2>]) -> Result<Field, String> {
    let points: Vec<Vec<[f64; 2]>> = lines.iter().map(|line| line.points.clone()).collect();
    Ok(or_text(Contours::new(&points, ContourFill::EvenOdd))?.into_field())
}

/// Lines as triangles without area, so that functions for meshes can compare them.
pub(super) fn thin_mesh(lines: &[Polyline<2>]) -> Result<Mesh, String> {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for line in lines {
        let start = positions.len() as u32;
        positions.extend(line.points.iter().map(|p| raised(*p)));
        let n = line.points.len() as u32;
        faces.extend((0..n).map(|k| [start + k, start + (k + 1) % n, start + (k + 1) % n]));
    }
    super::shapes::mesh_from(positions, faces)
}
