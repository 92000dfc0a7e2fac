//! The bridge: one file per arrow `a_to_b`, each lossy one under a budget and with a bound.
mod cubes;
mod curve_to_polyline;
mod curves;
mod grid_to_mesh;
mod grid_to_polyline;
mod labels_to_meshes;
mod mesh_to_gpu_buffers;
mod outlines_to_mesh;
mod patches;
mod patches_to_mesh;

pub use cubes::march::Coordinate;
pub use cubes::rule::{Border, Inside, Normals, Polygonize};
pub use curve_to_polyline::{curve_to_polyline, curve_to_polyline_evenly, curves_to_polylines};
pub use curves::batch::{BezierCutter, Polylines, beziers_to_polylines};
pub use curves::flatten::Spacing;
pub use grid_to_mesh::{Surface, VertexKey, grid_to_mesh, grid_to_triangles, vertex_keys};
pub use grid_to_polyline::grid_to_polyline;
pub use labels_to_meshes::{Labels, labels_to_meshes};
pub use mesh_to_gpu_buffers::{GpuBuffers, Indices, mesh_to_gpu_buffers};
pub use outlines_to_mesh::outlines_to_mesh;
pub use patches_to_mesh::patches_to_mesh;
