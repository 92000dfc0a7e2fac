//! From the distance to a mesh to the triangles of an offset surface.
//!
//! 1. `distance.rs`: the distance minus the offset, at points.
//! 2. `octree.rs`: cells so small that the surface in each is nearly one to three planes.
//! 3. `contour.rs`: a vertex for each part of the surface in a cell (`vertex.rs`), on creases where planes meet, and
//!    triangles around each crossed edge.
//! 4. `mesher.rs`: cells whose triangles are too far are cut, until none is.
//!
//! What it makes is near the surface, and not proved: `lod/mesh_to_offset.rs` leaves triangles out and proves the rest.
mod contour;
mod distance;
mod edge_view;
mod mesher;
mod octree;
mod vertex;

pub(crate) use mesher::OffsetMesher;
