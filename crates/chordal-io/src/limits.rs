//! `Limits`: how much work and memory a file may cause.
use crate::PolygonSurface;

/// Caps on the size of a file and of what is read from it. A file over a cap is refused before memory is
/// allocated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of the file, and of anything decoded from it.
    pub bytes: u64,
    /// Rows of any one list: vertices, faces, nodes.
    pub rows: u64,
    /// Bytes in one line of a text format's header.
    pub header_line: usize,
    /// Nesting of JSON.
    pub depth: usize,
    /// Which errors of a file that do not touch its geometry are warnings.
    pub conformance: Conformance,
    /// Drops and counts vertices that are NaN or infinite, with their faces, instead of refusing the file.
    pub drop_nonfinite: bool,
    /// Which volume of a file that holds several, counted from 0; `None` where there is only one.
    pub index: Option<u64>,
    /// Which level of detail of a glTF, counted from 0, the finest. Of nodes with fewer levels it is the coarsest.
    pub level: usize,
    /// How the polygons of an OBJ are interpreted. `None`: as a Catmull–Clark cage if the file has
    /// subdivision tags, else as triangles.
    pub surface: Option<PolygonSurface>,
    /// The number of threads that long texts are read on, 0 for all of the machine. What is read, and which
    /// error is found, never depends on it.
    pub threads: usize,
}

/// How errors of a file are judged that do not touch its geometry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Conformance {
    /// All are refused, of glTF whatever gltf-validator calls an error.
    Strict,
    /// What viewers of glTF accept is a warning, and is mended where the file is written again: bounds of
    /// accessors, directions that are not of length 1, a scene that names a node below another one, a factor
    /// of a material beyond 1, an extension that is not declared. So it is where faces of an OBJ name normals or
    /// texture coordinates and the file has none. Everything else is refused.
    #[default]
    Tolerant,
    /// Of glTF everything is a warning that leaves triangles to read, and materials and the like are left out
    /// where they may be wrong; of a volume, bytes that follow its samples; of a tileset, geometric errors
    /// that grow towards the leaves.
    Lenient,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            bytes: 4 << 30,
            rows: 500_000_000,
            header_line: 64 << 10,
            depth: 128,
            conformance: Conformance::default(),
            drop_nonfinite: false,
            index: None,
            level: 0,
            surface: None,
            threads: 0,
        }
    }
}
