//! Mesh repair: each function repairs one finding of [`check::validity`](crate::check::validity), reports
//! what it changed, and bounds how far the surface moved. It changes nothing else.
//!
//! All attributes are kept; all repairs are deterministic, and repeating one changes nothing more.
//!
//! ```
//! use chordal::{Job, Mesh, check, explicit::Topology, mend};
//! let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let open = Mesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3]])?;
//! let mended = mend::fill_holes(&open, Topology::Indices, mend::HoleSelection::All, &Job::default())?;
//! assert_eq!((mended.count("filled_holes"), mended.count("added_faces")), (1, 1));
//! assert!(check::validity(&mended.mesh, Topology::Indices).closed);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
mod cap;
mod cut_faces;
mod drop_collapsed;
mod drop_degenerate;
mod drop_duplicates;
mod drop_unused;
mod fill_holes;
mod mend_builder;
mod mended_mesh;
mod orient;
mod radial;
mod resolve_t_junctions;
mod split_non_manifold;
mod weld;

use crate::budget::{Cure, Job, JobError};
use crate::explicit::{Mesh, Topology};
use nesting::NestedShells;

pub use drop_collapsed::drop_collapsed;
pub use drop_degenerate::drop_degenerate;
pub use drop_duplicates::{Duplicates, drop_duplicates};
pub use drop_unused::drop_unused;
pub use fill_holes::{HoleSelection, fill_holes};
pub use mended_mesh::{MendChange, MendedMesh};
pub use orient::orient;
pub use resolve_t_junctions::resolve_t_junctions;
pub use split_non_manifold::split_non_manifold;
pub use weld::{Weld, weld};

/// Applies a repair by its name: without tolerance, to all holes, and with cavities for closed pieces inside others.
///
/// # Errors
/// As for the function of that name.
///
/// ```
/// use chordal::{Job, Mesh, budget::advice::Cure, explicit::Topology, mend};
/// let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [9.0; 3]], vec![[0, 1, 2]])?;
/// let mended = mend::apply(Cure::DropUnused, &mesh, Topology::Indices, &Job::default())?;
/// assert_eq!(mended.mesh.positions().len(), 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn apply(cure: Cure, mesh: &Mesh, topology: Topology, job: &Job) -> Result<MendedMesh, JobError> {
    match cure {
        Cure::Weld => weld(mesh, Weld::Exact, job),
        Cure::DropDuplicates => drop_duplicates(mesh, topology, Duplicates::EitherWay, job),
        Cure::DropDegenerate => drop_degenerate(mesh, topology, job),
        Cure::ResolveTJunctions => resolve_t_junctions(mesh, topology, None, job),
        Cure::SplitNonManifold => split_non_manifold(mesh, topology, job),
        Cure::Orient => orient(mesh, topology, NestedShells::Cavity, job),
        Cure::FillHoles => fill_holes(mesh, topology, HoleSelection::All, job),
        Cure::DropUnused => drop_unused(mesh, job),
    }
}

/// The treatment of closed pieces inside others.
pub mod nesting {
    pub use super::orient::NestedShells;
}
