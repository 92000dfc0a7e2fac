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
    /// Turns into warnings what gltf-validator calls an error and does not affect geometry, and bytes that
    /// follow the samples of a volume.
    pub lenient: bool,
    /// Drops and counts vertices that are NaN or infinite, with their faces, instead of refusing the file.
    pub drop_nonfinite: bool,
    /// Which volume of a file that holds several, counted from 0; `None` where there is only one.
    pub index: Option<u64>,
    /// How the polygons of an OBJ are interpreted. `None`: as a Catmull–Clark cage if the file has
    /// subdivision tags, else as triangles.
    pub surface: Option<PolygonSurface>,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            bytes: 4 << 30,
            rows: 500_000_000,
            header_line: 64 << 10,
            depth: 128,
            lenient: false,
            drop_nonfinite: false,
            index: None,
            surface: None,
        }
    }
}
