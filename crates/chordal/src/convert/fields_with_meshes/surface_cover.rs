//! How far the surface of a field is from the triangles of its lattice, at most.
//!
//! Let S be the boundary of where the field is negative. Every point of S lies in a block that ranges did not
//! rule out. If a cell of it has corners on both sides, triangles pass through the cell, so S in it is within
//! the cell's diagonal of them. Otherwise S in a box is within the distance of its middle from the triangles
//! and half its diagonal; boxes where that is too much are halved as long as their ranges leave them.
use super::sign_lattice::{
    N_BLOCKS, RangeSide, SignLattice, block_at, half_diagonal, range_sides, too_large,
};
use crate::budget::{Failure, Job, JobError, par_map};
use crate::convert::lattice::BRICK;
use crate::explicit::{Bvh, Mesh};
use crate::implicit::{Field, Tape};
use crate::math::{Box3, add_up};

/// The most halvings of a cell. Chosen: a box is then smaller than the length that is asked for.
const MOST_HALVINGS: usize = 4;
/// Boxes of a task.
const TASK: usize = 256;

/// The farthest part of the surface.
pub(super) struct FarthestPart {
    /// No point of the surface is farther from the triangles.
    pub most: f64,
    /// Where it may be so far.
    pub at: Option<[f64; 3]>,
}

/// An upper bound for the distance from points of the surface to the triangles.
pub(super) fn farthest(
    field: &Field,
    lattice: &SignLattice,
    mesh: &Mesh,
    enough: f64,
    job: &Job,
) -> Result<FarthestPart, Failure<Mesh>> {
    let bvh = Bvh::build(mesh, job).map_err(|error| match error {
        JobError::Refused(why) => Failure::Refused(why),
        JobError::Cancelled => Failure::Cancelled,
    })?;
    let tape = Tape::new(field.sign());
    let mut found = FarthestPart { most: 0.0, at: None };
    // 1. Cells of the blocks, as far as no triangle passes through them and not all of the block is near.
    let of_bricks = par_map(job, &lattice.bricks, |_, brick| {
        let (mut cells, mut most, mut at) = (Vec::new(), 0.0, None);
        let blocks = (0..N_BLOCKS).filter(|number| brick.blocks >> number & 1 == 1);
        for number in blocks.filter(|_| !job.is_cancelled()) {
            let inner = block_at(number);
            let first: [usize; 3] = std::array::from_fn(|k| brick.at[k] as usize * BRICK + inner[k]);
            for part in 0..8_usize {
                let low: [usize; 3] = std::array::from_fn(|k| first[k] + (part >> k & 1));
                // Cells have corners up to the last sample.
                if (0..3).any(|k| low[k] + 1 >= lattice.lattice.size[k]) || lattice.is_mixed(low) {
                    continue;
                }
                let cell = lattice.lattice.hull([low, low.map(|i| i + 2)]);
                match reach(&bvh, &cell) {
                    reach if reach <= enough => {
                        if reach > most {
                            (most, at) = (reach, Some(cell.centre()));
                        }
                    }
                    _ => cells.push(cell),
                }
            }
        }
        (cells, most, at)
    });
    let mut waiting = Vec::new();
    for (cells, most, at) in of_bricks {
        waiting.extend(cells);
        if most > found.most {
            (found.most, found.at) = (most, at);
        }
    }
    // 2. Those that are too far: ruled out, near enough, or halved.
    for halvings in 0..=MOST_HALVINGS {
        if job.is_cancelled() {
            return Err(Failure::Cancelled);
        }
        // Boxes, their halves, and what is found of both.
        too_large(16 * 48 * waiting.len() as u64, job)?;
        let sides = range_sides(&tape, &waiting, job)?;
        let left: Vec<Box3> = waiting
            .into_iter()
            .zip(sides)
            .filter_map(|(cell, side)| (side == RangeSide::Unknown).then_some(cell))
            .collect();
        let tasks: Vec<&[Box3]> = left.chunks(TASK).collect();
        let reaches: Vec<f64> =
            par_map(job, &tasks, |_, cells| cells.iter().map(|cell| reach(&bvh, cell)).collect::<Vec<f64>>())
                .concat();
        waiting = Vec::new();
        for (cell, reach) in left.iter().zip(reaches) {
            if reach > enough && halvings < MOST_HALVINGS {
                waiting.extend(octants(cell));
            } else if reach > found.most {
                (found.most, found.at) = (reach, Some(cell.centre()));
            }
        }
        if waiting.is_empty() {
            break;
        }
    }
    Ok(found)
}

/// No point of a box is farther from the triangles.
fn reach(bvh: &Bvh, cell: &Box3) -> f64 {
    let near = bvh.closest_distance_up(cell.centre()).unwrap_or(f64::INFINITY);
    add_up(near, half_diagonal(cell))
}

fn octants(cell: &Box3) -> impl Iterator<Item = Box3> {
    let (Box3 { min, max }, middle) = (*cell, cell.centre());
    (0..8_usize).map(move |part| Box3 {
        min: std::array::from_fn(|k| if part >> k & 1 == 0 { min[k] } else { middle[k] }),
        max: std::array::from_fn(|k| if part >> k & 1 == 0 { middle[k] } else { max[k] }),
    })
}
