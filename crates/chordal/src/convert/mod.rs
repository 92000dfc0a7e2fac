//! The conversions: one file per arrow `a_to_b`. A lossy one takes a budget and reports a bound.
mod bevel;
mod budget_search;
mod cage_to_mesh;
mod contours;
mod contours_to_field;
mod cubes;
mod curve_to_cubics;
mod curve_to_field;
mod curve_to_polyline;
mod curve_to_swept_surface;
mod curves;
mod field_to_grid;
mod field_to_mesh;
mod field_to_polyline;
mod field_to_shader;
mod fields;
mod fields_with_meshes;
mod fitting;
mod gradient_normals;
mod grid_blocks;
mod grid_to_mesh;
mod grid_to_polyline;
mod labels_to_meshes;
mod ladder;
mod lattice;
mod mask_to_smooth_mesh;
mod mesh_leaf;
mod mesh_to_field;
mod mesh_to_gpu_buffers;
mod mesh_to_grid;
mod nurbs;
mod nurbs_to_mesh;
mod offset;
mod open_boundary;
mod outline_to_field;
mod outlines_to_mesh;
mod outlines_to_solid;
mod patches;
mod patches_to_mesh;
mod patches_to_mesh_by_outline;
mod points_to_spline;
mod polyline_to_spline;
mod redistance;
mod shaders;
mod sweep;
mod triangles;
mod trimmed_surfaces_to_mesh;
mod upright_solid;
mod view_dependent_mesher;

pub use bevel::outlines_to_bevelled_solid;
pub use cage_to_mesh::cage_to_mesh;
pub use contours_to_field::contours_to_field;
pub use cubes::rule::{Border, Inside, Normals, Polygonize};
pub use curve_to_cubics::curve_to_cubics;
pub use curve_to_field::curve_to_field;
pub use curve_to_polyline::{curve_to_polyline, curve_to_polyline_evenly, curves_to_polylines};
pub use curve_to_swept_surface::curve_to_swept_surface;
pub use curves::flatten::Spacing;
pub use field_to_grid::{field_to_grid, field_to_sparse_grid};
pub use field_to_mesh::field_to_mesh;
pub use field_to_polyline::field_to_polyline;
pub use fields_with_meshes::{has_meshes, with_face_materials};
pub use gradient_normals::with_gradient_normals;
pub use grid_to_mesh::{grid_to_mesh, sparse_grid_to_mesh};
pub use grid_to_polyline::grid_to_polyline;
pub use mesh_to_field::{MeshField, SolidReport, mesh_to_field};
pub use mesh_to_grid::{DistanceGrid, mesh_to_grid, mesh_to_sparse_grid};
pub use nurbs_to_mesh::{nurbs_to_mesh, nurbs_to_patches};
pub(crate) use offset::OffsetMesher;
pub use outline_to_field::outline_to_field;
pub use outlines_to_mesh::outlines_to_mesh;
pub use outlines_to_solid::outlines_to_solid;
pub use patches_to_mesh::patches_to_mesh;
pub use redistance::redistance;
pub use trimmed_surfaces_to_mesh::trimmed_surfaces_to_mesh;

/// Bevels: chamfers and fillets along the edges of solids over outlines.
pub mod bevels {
    pub use super::bevel::Bevel;
}

/// Meshers, a cutter and a sampler that are reused for many budgets, views or lattices; and many curves at once.
pub mod batch {
    pub use super::cage_to_mesh::CageMesher;
    pub use super::curves::batch::{BezierCutter, Polylines, beziers_to_polylines};
    pub use super::mesh_to_grid::DistanceBaker;
    pub use super::view_dependent_mesher::{TileReuse, ViewDependentMesher};
}

/// Meshes for one eye that are finest along the outline.
pub mod outlines {
    pub use super::patches_to_mesh_by_outline::{OutlineLimit, OutlineMesh, patches_to_mesh_by_outline};
}

/// Fits paths of few cubics to points and polylines.
pub mod splines {
    pub use super::fitting::spans::{Corners, SplineFit};
    pub use super::points_to_spline::points_to_spline;
    pub use super::polyline_to_spline::polyline_to_spline;
}

/// Paths along which profiles are swept.
pub mod sweeps {
    pub use super::curve_to_swept_surface::{ProfilePlace, SweepPath};
}

pub mod solids;

/// Buffers for graphics processors.
pub mod gpu {
    pub use super::mesh_to_gpu_buffers::{GpuBuffers, IndexBuffer, mesh_to_gpu_buffers};
}

/// Fields as the text of programs for graphics processors.
pub mod shader {
    pub use super::field_to_shader::{FieldShader, ShaderRefusal, field_to_shader};
}

/// Isosurfaces on a lattice, vertex by vertex.
pub mod lattices {
    pub use super::cubes::marching_cubes::Coordinate;
    pub use super::grid_blocks::{FaceKey, GridBlock, block_normals, grid_to_block, join_blocks};
    pub use super::grid_to_mesh::{TriangleArrays, VertexKey, grid_to_triangles, vertex_keys};
    pub use super::labels_to_meshes::{LabelOptions, labels_to_blocks, labels_to_meshes};
    pub use super::lattice::Lattice;
    pub use super::mask_to_smooth_mesh::{SmoothedMask, mask_to_smooth_mesh};
}
