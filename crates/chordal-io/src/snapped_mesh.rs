//! `SnappedMesh`: a mesh with positions as a format stores them.
use chordal::Mesh;
use chordal::math::Box3;

/// A mesh rounded to the positions that a format stores.
#[derive(Clone, Debug, PartialEq)]
pub struct SnappedMesh {
    /// The mesh as it reads back, in the coordinates of the input mesh.
    pub mesh: Mesh,
    /// The point about which the format stores positions. It is `[0, 0, 0]` for all formats but GLB, and for
    /// GLB unless the part is far from zero compared with its size. Each of its coordinates is a
    /// single-precision number.
    pub origin: [f64; 3],
    /// No vertex moved by more than this, in the mesh's units; 0 if every bit of all positions is kept.
    pub moved_at_most: f64,
}

/// An upper bound of the distance of two points; 0 for equal points.
pub(crate) fn distance_up(a: [f64; 3], b: [f64; 3]) -> f64 {
    let apart: [f64; 3] = std::array::from_fn(|k| (a[k] - b[k]).abs());
    if apart == [0.0; 3] {
        return 0.0;
    }
    let side = apart.map(|d| if d == 0.0 { 0.0 } else { d.next_up() });
    Box3 { min: [0.0; 3], max: side }.diagonal()
}
