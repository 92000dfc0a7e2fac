//! `GltfPacking`: how a glTF stores its numbers.

/// How the writers of glTF store the numbers of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GltfPacking {
    /// Whether vertices and triangles are compressed by `EXT_meshopt_compression`, where that makes them smaller.
    /// No bit of a vertex changes. Triangles and vertices are put in the order that compresses best, which is one
    /// that draws fast, too.
    pub is_compressed: bool,
    /// Whether the numbers of vertices are rounded to 8 and 16 bits (`KHR_mesh_quantization`), as
    /// [`Part::storage`](crate::Part::storage) says; where it says nothing, as
    /// [`VertexStorage::of`](super::VertexStorage::of) finds.
    pub is_quantized: bool,
}
