//! The bricks of a lattice that a field's surface can run through, found from large to small.
use super::lattice::Lattice;
use crate::budget::{Job, par_map};
use crate::implicit::{LeafError, Tape};
use crate::math::{Box3, Interval};
use std::sync::Arc;

/// Bricks that are evaluated with one tape.
pub(super) struct Group {
    pub tape: Arc<Tape>,
    /// Their places, in bricks.
    pub bricks: Vec<[u32; 3]>,
}

/// With leaves, which are asked for many points at once, so many bricks of 729 points are a group.
const LEAF_GROUP: usize = 128;

/// Groups of bricks outside of which the field has one sign in each brick, in an order that hangs on the lattice alone.
/// `None` when the job is cancelled.
pub(super) fn crossed(tape: &Tape, lattice: &Lattice, job: &Job) -> Result<Option<Vec<Group>>, LeafError> {
    let longest = lattice.bricks.iter().fold(1, |most, n| if *n > most { *n } else { most });
    let mut size = longest.next_power_of_two();
    let mut groups = vec![Group { tape: Arc::new(tape.clone()), bricks: vec![[0; 3]] }];
    while size > 1 {
        if job.is_cancelled() {
            return Ok(None);
        }
        let parts = if size >= 4 { 4 } else { 2 };
        size /= parts;
        let next = par_map(job, &groups, |_, group| split(group, lattice, size, parts));
        let next: Vec<Vec<Group>> = next.into_iter().collect::<Result<_, _>>()?;
        groups = next.into_iter().flatten().collect();
        if tape.has_leaves() {
            groups = regrouped(groups);
        }
    }
    Ok(Some(groups))
}

/// Cuts the cubes of a group, leaves out what the surface does not meet, and shortens the tape of what is left.
fn split(group: &Group, lattice: &Lattice, size: u32, parts: u32) -> Result<Vec<Group>, LeafError> {
    let mut cubes = Vec::new();
    for brick in &group.bricks {
        for n in 0..parts * parts * parts {
            let offset = [n % parts, n / parts % parts, n / (parts * parts)];
            let cube: [u32; 3] = std::array::from_fn(|k| brick[k] + offset[k] * size);
            if (0..3).all(|k| cube[k] < lattice.bricks[k]) {
                cubes.push(cube);
            }
        }
    }
    let boxes: Vec<Box3> = cubes.iter().map(|cube| lattice.bounds(*cube, size)).collect();
    let mut ranges = vec![Interval::UNKNOWN; boxes.len()];
    group.tape.over(&boxes, &mut ranges)?;
    // Where a part of the expression has no value the range says nothing. Points in the border of the lattice count as
    // outside whatever they are.
    let within = |k: usize| (0..3).all(|a| cubes[k][a] > 0 && cubes[k][a] + size < lattice.bricks[a]);
    let met = |k: &usize| {
        !(ranges[*k].is_defined() && (ranges[*k].lo() >= 0.0 || ranges[*k].hi() < 0.0 && within(*k)))
    };
    let met: Vec<usize> = (0..cubes.len()).filter(met).collect();
    if group.tape.has_leaves() {
        let bricks = met.iter().map(|k| cubes[*k]).collect();
        return Ok(vec![Group { tape: Arc::clone(&group.tape), bricks }]);
    }
    let mut groups: Vec<Group> = Vec::new();
    for k in met {
        let short = if group.tape.len() < 16 { None } else { group.tape.shortened(&boxes[k])?.1 };
        match (short, groups.last_mut()) {
            (Some(short), _) => groups.push(Group { tape: Arc::new(short), bricks: vec![cubes[k]] }),
            (None, Some(last)) if Arc::ptr_eq(&last.tape, &group.tape) && last.bricks.len() < 16 => {
                last.bricks.push(cubes[k]);
            }
            (None, _) => groups.push(Group { tape: Arc::clone(&group.tape), bricks: vec![cubes[k]] }),
        }
    }
    Ok(groups)
}

fn regrouped(groups: Vec<Group>) -> Vec<Group> {
    let Some(first) = groups.first() else { return groups };
    let tape = Arc::clone(&first.tape);
    let bricks: Vec<[u32; 3]> = groups.into_iter().flat_map(|group| group.bricks).collect();
    bricks.chunks(LEAF_GROUP).map(|some| Group { tape: Arc::clone(&tape), bricks: some.to_vec() }).collect()
}
