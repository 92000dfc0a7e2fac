//! `Limits`: how much work and memory a file may cause.
use crate::PolygonSurface;

/// Caps on the size of a file and of the data decoded from it. A file over a cap is refused before memory is
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
    /// Which of the errors that leave the geometry intact are warnings.
    pub conformance: Conformance,
    /// Drops and counts vertices that are NaN or infinite, with their faces, instead of refusing the file.
    pub drop_nonfinite: bool,
    /// Which volume is read from a file that holds several, counted from 0; `None` if there is only one.
    pub index: Option<u64>,
    /// Which level of detail of a glTF is read, counted from 0, the finest. Nodes with fewer levels use their
    /// coarsest.
    pub level: usize,
    /// How the polygons of an OBJ are interpreted. `None`: as a Catmull–Clark cage if the file has
    /// subdivision tags, else as triangles.
    pub surface: Option<PolygonSurface>,
    /// The number of threads that parse long texts, 0 for all of the machine. The result, and the error that
    /// is reported, never depend on it.
    pub threads: usize,
}

/// How strictly errors that leave the geometry intact are judged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Conformance {
    /// All of them are refused. For glTF these are the errors of gltf-validator.
    Strict,
    /// Errors in a glTF that viewers accept are warnings, and are repaired when the file is written again:
    /// bounds of accessors, directions that are not of length 1, a scene that names a node below another one,
    /// a factor of a material beyond 1, an extension that is not declared. The same holds for faces of an OBJ
    /// that name normals or texture coordinates missing from the file. All other errors are refused.
    #[default]
    Tolerant,
    /// In a glTF, every error that leaves readable triangles is a warning; materials and other data that may
    /// be wrong are left out. In a volume, bytes after its samples are a warning; in a tileset, geometric
    /// errors that grow towards the leaves.
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
