//! A draft of a field's surface: cubes of a lattice, and their vertices moved onto it. It is there at once, and nobody has
//! measured how far it is off.
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

/// Cells along the longest side, at least and at most. Chosen: fewer show no shape, and more take longer than one waits for
/// a draft.
const CELLS: [f64; 2] = [8.0, 96.0];
/// Where only a number of triangles is asked for: a surface that fills its box passes twice the square of so many.
const FIRST: f64 = 48.0;
/// Steps of Newton's method. Chosen: a third is not seen.
const STEPS: usize = 2;
/// How far a step may lead, in cells: beyond it lies another part of the surface.
const REACH: f64 = 1.0;
/// Cells about the surface whose values count. A vertex needs the two samples of its edge.
const BAND: f64 = 2.0;

/// Cells as large as the length, so that what they cut off of edges and corners is smaller.
pub(in crate::convert) fn draft(field: &Field, wanted: &FieldMeshGoal, job: &Job) -> FieldMeshResult {
    let solid = Field::new(clip_to_bounds(field)).with_bounds(field.bounds());
    let longest = longest(&field.bounds());
    let mut cells = match wanted.length {
        Some(length) => (longest / length.get()).clamp(CELLS[0], CELLS[1]),
        None => FIRST,
    };
    let most = wanted.triangles.unwrap_or(u64::MAX);
    // Without the planes that cut it off: inside of a shape whose value is steep they have the larger value, and would draw
    // vertices away.
    let tape = Tape::new(field.sign());
    loop {
        let mesh = on_lattice(&solid, &tape, cells.ceil() as usize, job)?;
        let count = mesh.faces().len() as u64;
        let bound = Bound::with_evidence(0.0, None, Evidence::Estimated, Reference::Field);
        let made = Bounded { shape: mesh, bound };
        if count <= most {
            return Ok(made);
        }
        if cells <= CELLS[0] {
            return Err(Failure::Unmet(Box::new(made)));
        }
        // Triangles are as many as the square of cells.
        cells = greater(CELLS[0], 0.95 * cells * lesser(1.0, (most as f64 / count as f64).sqrt()));
    }
}

/// A draft, measured: what there is where a mesh's own cells ended before there was one.
pub(in crate::convert) fn measured_draft(
    field: &Field,
    wanted: &FieldMeshGoal,
    job: &Job,
) -> FieldMeshResult {
    let Bounded { shape, .. } = draft(field, wanted, job).or_else(Failure::best_effort)?;
    let bound = measured_field_deviation(&shape, field, (f64::INFINITY, 0), job)?.whole.bound;
    let is_far = wanted.length.is_some_and(|length| bound.at_least() > length.get());
    let is_many = wanted.triangles.is_some_and(|most| shape.faces().len() as u64 > most);
    let made = Bounded { shape, bound };
    if is_far || is_many { Err(Failure::Unmet(Box::new(made))) } else { Ok(made) }
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
        for (position, at) in positions.iter_mut().zip(slopes) {
            let square = dot(at.gradient, at.gradient);
            let step = at.value / square;
            // NaN where there is no slope.
            if (step * square.sqrt()).abs() <= reach {
                *position = std::array::from_fn(|k| position[k] - step * at.gradient[k]);
            }
        }
        if job.is_cancelled() {
            return Err(Failure::Cancelled);
        }
    }
    Ok(Mesh::by_construction(positions, surface.faces))
}
