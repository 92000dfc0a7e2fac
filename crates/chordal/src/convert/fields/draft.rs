//! A draft of a field's surface: polygonized cubes of a lattice, with vertices moved onto the surface. It takes little time,
//! and its error is not measured.
use super::field_sampler::FieldSampler;
use super::mesher::{FieldMeshGoal, leaf_failure, longest};
use super::search::{FieldMeshResult, clip_to_bounds};
use crate::budget::{Bound, Bounded, Evidence, Failure, Job, Reference, RefusalCode};
use crate::check::measured_field_deviation;
use crate::convert::cubes::rule::Polygonize;
use crate::convert::field_to_grid;
use crate::convert::grid_to_mesh::grid_to_triangles;
use crate::convert::lattice::Lattice;
use crate::explicit::Mesh;
use crate::implicit::{Field, Tape};
use crate::math::{dot, greater, lesser};

/// Cells along the longest side, at least and at most. Chosen: fewer show no shape, and more take too long for a draft.
const CELLS: [f64; 2] = [8.0, 96.0];
/// The first number of cells if the budget has only a number of triangles. Chosen: later tries correct it.
const FIRST: f64 = 48.0;
/// Steps of Newton's method. Chosen: a third makes no visible difference.
const STEPS: usize = 2;
/// The longest step, in cells. Chosen: longer steps lead to another part of the surface.
const REACH: f64 = 1.0;
/// The band of samples around the surface, in cells. Chosen: a vertex needs the two samples of its edge.
const BAND: f64 = 2.0;

/// A draft with cells as large as the length, so that they cut less than that off edges and corners.
pub(in crate::convert) fn draft(field: &Field, goal: &FieldMeshGoal, job: &Job) -> FieldMeshResult {
    let solid = Field::new(clip_to_bounds(field)).with_bounds(field.bounds());
    let longest = longest(&field.bounds());
    let mut cells = match goal.length {
        Some(length) => (longest / length.get()).clamp(CELLS[0], CELLS[1]),
        None => FIRST,
    };
    let most = goal.triangles.unwrap_or(u64::MAX);
    // The sign without the clipping planes: inside a shape with steep values the planes have the larger value, and would
    // attract vertices.
    let tape = Tape::new(field.sign());
    loop {
        let mesh = on_lattice(&solid, &tape, cells.ceil() as usize, job)?;
        let count = mesh.faces().len() as u64;
        let bound = Bound::with_evidence(0.0, None, Evidence::Estimated, Reference::Field);
        let bounded = Bounded { shape: mesh, bound };
        if count <= most {
            return Ok(bounded);
        }
        if cells <= CELLS[0] {
            return Err(Failure::Unmet(Box::new(bounded)));
        }
        // The number of triangles grows with the square of the number of cells.
        cells = greater(CELLS[0], 0.95 * cells * lesser(1.0, (most as f64 / count as f64).sqrt()));
    }
}

/// A measured draft, for when memory or time runs out before there is a mesh.
pub(in crate::convert) fn measured_draft(field: &Field, goal: &FieldMeshGoal, job: &Job) -> FieldMeshResult {
    let Bounded { shape, .. } = draft(field, goal, job).or_else(Failure::best_effort)?;
    let bound = measured_field_deviation(&shape, field, (f64::INFINITY, 0), job)?.whole.bound;
    let is_far = goal.length.is_some_and(|length| bound.at_least() > length.get());
    let is_many = goal.triangles.is_some_and(|most| shape.faces().len() as u64 > most);
    let bounded = Bounded { shape, bound };
    bounded.met_if(!is_far && !is_many)
}

fn on_lattice(field: &Field, tape: &Tape, cells: usize, job: &Job) -> Result<Mesh, Failure<Mesh>> {
    let lattice = Lattice::around(&field.bounds(), cells, 1)
        .ok_or_else(|| Failure::refused(RefusalCode::Empty, "the box of the shape has no size"))?;
    let spacing = lattice.spacing();
    let grid = field_to_grid(field, &lattice, Some(BAND * spacing), job)?;
    let surface = grid_to_triangles::<f64>(&grid, &Polygonize::below(0.0), job)?;
    if surface.faces.is_empty() {
        let message =
            "a draft found nothing inside: the shape is empty, or thinner than the cells of a draft";
        return Err(Failure::refused(RefusalCode::Empty, message));
    }
    let mut positions = surface.positions;
    let sampler = FieldSampler { tape, job };
    let reach = REACH * spacing;
    for _ in 0..STEPS {
        let slopes = sampler.duals(&positions).map_err(leaf_failure)?;
        for (position, dual) in positions.iter_mut().zip(slopes) {
            let square = dot(dual.gradient, dual.gradient);
            let step = dual.value / square;
            // NaN without a slope.
            if (step * square.sqrt()).abs() <= reach {
                *position = std::array::from_fn(|k| position[k] - step * dual.gradient[k]);
            }
        }
        if job.is_cancelled() {
            return Err(Failure::Cancelled);
        }
    }
    Ok(Mesh::by_construction(positions, surface.faces))
}
