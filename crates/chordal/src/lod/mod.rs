//! Level of detail: meshes with fewer triangles and a bounded error.
mod attribute_guard;
mod bucket_queue;
mod chain;
mod conforming;
mod edge_collapse;
mod edge_guard;
mod error_monitor;
mod flat_normals;
mod lattice_fragment;
mod local_tolerance;
mod mesh_to_offset;
mod quadric;
mod reduction;
mod region_tree;
mod samples;
mod select;
mod simplified_mesh;
mod simplify;
mod simplify_to_count;
mod surface;
mod surface_part;
mod tree;
mod wedges;
mod zero_area;

pub use chain::{LodLevel, LodSource, LodSteps, chain};
pub use conforming::simplify_conforming;
pub use mesh_to_offset::mesh_to_offset;
pub use reduction::ReductionStats;
pub use simplified_mesh::SimplifiedMesh;
pub use simplify::simplify;

/// At most a given number of triangles, with more or less effort.
pub mod count {
    pub use super::simplify_to_count::{Effort, simplify_to_count};
}

/// The choice of a level by distance.
pub mod selection {
    pub use super::select::{HYSTERESIS, LevelChoice, SwitchDistances};
}

/// Levels that are divided in space, and parts of a surface that is never in memory as a whole.
pub mod tiling {
    pub use super::lattice_fragment::{FragmentBox, LatticeFragment};
    pub use super::surface_part::{LatticeBox, SurfacePart};
    pub use super::tree::{LodTile, LodTileTree, TilingOptions, tree};
}
