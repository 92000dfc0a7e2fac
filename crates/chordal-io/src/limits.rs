//! `Limits`: how much a file may make a reader do.
use crate::PolygonSurface;

/// Caps on what one file may ask for; a file past a cap is refused before the memory is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of the file, and of anything decoded from it.
    pub bytes: u64,
    /// Vertices, faces, nodes: rows of any one list.
    pub rows: u64,
    /// Bytes in one line of a text format's header.
    pub header_line: usize,
    /// Nesting of JSON.
    pub depth: usize,
    /// What gltf-validator calls an error and does not touch geometry becomes a warning; so do bytes that follow the
    /// samples of a volume.
    pub lenient: bool,
    /// Vertices that are NaN or infinite are dropped with their faces and counted, instead of refused.
    pub drop_nonfinite: bool,
    /// Which volume of a file that holds several, counted from 0; none where there is one only.
    pub index: Option<u64>,
    /// What the polygons of an OBJ stand for; without it they are a Catmull–Clark cage where the file has subdivision tags, else
    /// triangles.
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
