//! An upper bound of the distance from the surface of a field to the triangles of its lattice.
//!
//! Let S be the boundary of the region where the field is negative. Every point of S lies in a block that ranges
//! did not rule out. If a cell of the block has corners on both sides, triangles pass through the cell, so S in it
//! is within the cell's diagonal of them. Otherwise the distance of S in a box is at most the distance of the box's
//! middle from the triangles plus half its diagonal; boxes for which that is too much are halved as long as their
//! ranges do not rule them out.
//!
//! A mesh that crosses itself has triangles inside the solid that it bounds, and near them its range has both signs.
//! The boxes that remain there are counted, and the bound holds on the condition that they contain no surface.
use super::leaf_failure;
use super::sign_lattice::{
    N_BLOCKS, RangeSide, SignLattice, block_at, check_memory, half_diagonal, range_sides,
};
use crate::budget::{Failure, Job, par_map};
use crate::convert::lattice::BRICK;
use crate::explicit::{Bvh, Mesh};
use crate::implicit::{Field, LeafError, Tape};
use crate::math::{Box3, add_up};

/// The most halvings of a cell. Chosen: a box is then smaller than the length.
const MOST_HALVINGS: usize = 4;
/// The same if meshes have inner walls. Chosen: these are as large as a surface, and would take as many boxes.
const WALL_HALVINGS: usize = 1;
/// Boxes of a task.
const TASK: usize = 256;

/// The farthest part of the surface.
pub(super) struct FarthestPart {
    /// No point of the surface is farther from the triangles.
    pub most: f64,
    /// A point near which it may be so far.
    pub at: Option<[f64; 3]>,
    /// The number of boxes with triangles of a mesh that is not a solid, and with samples on one side only, that are assumed
    /// to contain no surface.
    pub n_walls: u64,
}

/// The limits of the search.
pub(super) struct CoverGoal {
    /// Boxes within this distance of the triangles are not halved.
    pub enough: f64,
    /// Whether some meshes are not solids: near their inner walls, ranges have both signs although the side does not
    /// change.
    pub has_walls: bool,
}

/// An upper bound of the distance from points of the surface to the triangles.
pub(super) fn farthest(
    field: &Field,
    lattice: &SignLattice,
    mesh: &Mesh,
    goal: &CoverGoal,
    job: &Job,
) -> Result<FarthestPart, Failure<Mesh>> {
    let bvh = Bvh::build(mesh, job)?;
    let CoverGoal { enough, has_walls } = *goal;
    let most_halvings = if has_walls { WALL_HALVINGS } else { MOST_HALVINGS };
    let tape = Tape::new(field.sign());
    let mut farthest_part = FarthestPart { most: 0.0, at: None, n_walls: 0 };
    // 1. The cells of the blocks through which no triangle passes and that are not near enough.
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
        if most > farthest_part.most {
            (farthest_part.most, farthest_part.at) = (most, at);
        }
    }
    // 2. Cells that are too far: ruled out, near enough, or halved.
    for halvings in 0..=most_halvings {
        if job.is_cancelled() {
            return Err(Failure::Cancelled);
        }
        // Memory of the boxes, their halves, and the results for both.
        check_memory(16 * 48 * waiting.len() as u64, job)?;
        let sides = range_sides(&tape, &waiting, job)?;
        let undecided: Vec<Box3> = waiting
            .into_iter()
            .zip(sides)
            .filter_map(|(cell, side)| (side == RangeSide::Unknown).then_some(cell))
            .collect();
        let tasks: Vec<&[Box3]> = undecided.chunks(TASK).collect();
        let reaches: Vec<f64> =
            par_map(job, &tasks, |_, cells| cells.iter().map(|cell| reach(&bvh, cell)).collect::<Vec<f64>>())
                .concat();
        waiting = Vec::new();
        let is_last = halvings == most_halvings || job.is_finishing();
        let far =
            undecided.iter().zip(&reaches).filter(|(_, reach)| is_last && has_walls && **reach > enough);
        let far: Vec<Box3> = far.map(|(cell, _)| *cell).collect();
        let mut are_walls = one_sided(&tape, &far, job)?.into_iter();
        for (cell, reach) in undecided.iter().zip(reaches) {
            // Under the condition of `far`, so that both lists are in step.
            if is_last && has_walls && reach > enough && are_walls.next().unwrap_or(false) {
                farthest_part.n_walls += 1;
            } else if reach > enough && !is_last {
                waiting.extend(octants(cell));
            } else if reach > farthest_part.most {
                (farthest_part.most, farthest_part.at) = (reach, Some(cell.centre()));
            }
        }
        if waiting.is_empty() {
            break;
        }
    }
    Ok(farthest_part)
}

/// Whether the corners and the middle of each box are on one side.
fn one_sided(tape: &Tape, boxes: &[Box3], job: &Job) -> Result<Vec<bool>, Failure<Mesh>> {
    let tasks: Vec<&[Box3]> = boxes.chunks(TASK).collect();
    let done = par_map(job, &tasks, |_, part| {
        let corner = |cell: &Box3, number: usize| {
            std::array::from_fn(|k| if number >> k & 1 == 0 { cell.min[k] } else { cell.max[k] })
        };
        let points: Vec<[f64; 3]> = part
            .iter()
            .flat_map(|cell| (0..8_usize).map(|number| corner(cell, number)).chain([cell.centre()]))
            .collect();
        let mut values = vec![0.0; points.len()];
        tape.at(&points, &mut values)?;
        let is_one = |nine: &[f64]| nine.iter().all(|value| (*value < 0.0) == (nine[0] < 0.0));
        Ok(values.chunks(SAMPLES).map(is_one).collect::<Vec<bool>>())
    });
    let mut are_one_sided = Vec::with_capacity(boxes.len());
    for part in done {
        are_one_sided.extend(part.map_err(|error: LeafError| leaf_failure(&error))?);
    }
    Ok(are_one_sided)
}

/// The samples of a box: its corners and its middle.
const SAMPLES: usize = 9;

/// An upper bound of the distance from points of a box to the triangles.
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
