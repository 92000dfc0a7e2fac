//! `GltfPacking`: how a glTF stores its numbers.

/// How the writers of glTF store the numbers of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GltfPacking {
    /// Whether vertices and triangles are compressed by `EXT_meshopt_compression` if that makes them smaller.
    /// No bit of a vertex changes. Triangles and vertices are put in the order that compresses best, which
    /// also draws fast.
    pub is_compressed: bool,
    /// Whether vertex data is rounded to 8 and 16 bits (`KHR_mesh_quantization`), as given by
    /// [`Part::storage`](crate::Part::storage); if that is `None`, as by
    /// [`VertexStorage::of`](super::VertexStorage::of).
    pub is_quantized: bool,
}
