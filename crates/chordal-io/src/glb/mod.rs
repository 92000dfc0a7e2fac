//! Binary glTF 2.0: one file with a JSON chunk that describes the scene and a BIN chunk with its data.
mod accessor_rows;
mod assets;
mod attribute_plan;
mod container;
mod dangling_references;
pub(crate) mod deformation;
mod document;
mod draco;
mod external;
mod face_kinds;
mod format;
mod gltf_part;
mod instanced_nodes;
mod instances;
mod json;
mod leniency;
mod level_hosts;
mod level_set;
mod levels;
mod lint;
mod lod_nodes;
mod marks;
mod material_runs;
mod meshopt;
mod model;
mod node_list;
mod node_tree;
mod pack;
mod packed_accessor;
mod packed_views;
mod packing;
mod parts;
mod position_lattice;
mod primitive_mesh;
mod read;
mod report;
mod rounded_deformation;
mod skin_plan;
mod split;
mod stored_positions;
mod streams;
mod transform;
mod triangles;
mod trs;
mod vertex_storage;
mod write;

pub use level_hosts::takes_levels;
pub use level_set::GlbLevels;
pub use levels::{write_levels, write_levels_embedded, write_levels_files};
pub use packing::GltfPacking;
pub use position_lattice::PositionLattice;
pub use read::read;
pub(crate) use read::{looks_like_json, read_with};
pub use rounded_deformation::round_deformation;
pub use split::split;
pub(crate) use stored_positions::{StoredPositions, storage_of};
pub use vertex_storage::{DirectionBits, VertexStorage};
pub use write::{write, write_embedded, write_files};

/// The first four bytes of a GLB file, `glTF`.
pub(crate) const MAGIC: u32 = 0x4654_6C67;
/// The type of the JSON chunk, `JSON`.
pub(crate) const JSON_CHUNK: u32 = 0x4E4F_534A;
/// The type of the chunk with the buffer, `BIN\0`.
pub(crate) const BIN_CHUNK: u32 = 0x004E_4942;
/// The most bytes that may be decoded and checked for each byte of a file. Chosen: one byte becomes at most
/// eight, and few are read twice.
const DECODED_PER_BYTE: u64 = 64;
/// The extension that allows quantized vertices.
const QUANTIZATION: &str = "KHR_mesh_quantization";
/// The extension for instanced nodes.
const INSTANCING: &str = "EXT_mesh_gpu_instancing";
/// The extension by which a node refers to its coarser levels of detail.
const LOD: &str = "MSFT_lod";
