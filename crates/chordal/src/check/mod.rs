//! The judge: measures and proves, builds nothing.
mod duplicates;
mod fans;
mod finding;
mod flat;
mod measure;
mod parallel;
mod pieces;
mod surface;
mod validity;

pub use finding::{Finding, MAX_WITNESSES, Place, Witness};
pub use flat::{has_zero_area, is_collinear};
pub use measure::{Measure, measure};
pub use validity::{Validity, validity};
