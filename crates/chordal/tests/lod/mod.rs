//! Simplification held against its promises: bounds by a sampler that shares no code with the library,
//! topology, seams, frames, pieces, and input that nobody would draw.
mod bounds;
mod by_view;
mod chains;
mod conforming;
mod counts;
pub mod data;
mod flat;
mod frames;
mod odd;
mod pieces;
mod sampler;
mod seams;
mod topology;
mod wild;

use crate::solids::shapes;
use chordal::explicit::Topology;
use chordal::lod::{SimplifiedMesh, simplify};
use chordal::{Bounded, Budget, Failure, Job, Mesh, Tolerance};

fn length(length: f64) -> Budget {
    Budget::length(Tolerance::new(length).expect("a length"))
}

/// A mesh within a budget; where a count cannot be reached, the best.
fn made(mesh: &Mesh, budget: &Budget) -> Bounded<SimplifiedMesh> {
    made_on(mesh, budget, &Job::default().with_threads(2))
}

fn made_on(mesh: &Mesh, budget: &Budget, job: &Job) -> Bounded<SimplifiedMesh> {
    match simplify(mesh, budget, Topology::Positions, job) {
        Ok(made) => made,
        Err(Failure::Unmet(best)) => *best,
        Err(other) => panic!("{other}"),
    }
}

fn n_faces(made: &Bounded<SimplifiedMesh>) -> usize {
    made.shape.mesh.faces().len()
}
