//! Questions to a field: which side, which way, where a ray meets it, and how far away it is.
mod beam;
mod cells;
mod closest;
mod rooms;
mod root;
mod sides;
mod step;
mod tracer;

pub use beam::{Beam, Counts, Met, Record};
pub use cells::{Cells, Unbounded};
pub use closest::{Nearest, closest};
pub use sides::{contains, normals};
pub use tracer::Tracer;
