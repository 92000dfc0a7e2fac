//! What the programs of the bench share: the corpora, dumped meshes, and the referees' samplers and shapes.
pub mod cages;
mod corpus;
pub mod curves;
mod dump;
#[path = "../../crates/chordal/tests/curve_referee/families.rs"]
#[allow(dead_code)]
mod families;
pub mod models;
pub mod scripts;
#[path = "../../crates/chordal/tests/solids/shapes.rs"]
pub mod shapes;
mod torus;

/// What the families of cubics know of the referee's types.
mod truth {
    pub type Control<const D: usize> = [[f64; D]; 4];
}

pub use chordal_testkit::sampler;
pub use corpus::{labels, out, patches};
pub use dump::{Dumped, read, write};
pub use torus::torus;
