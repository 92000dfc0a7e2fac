//! `CellShape`: how a cell contributes to a surface, by its type.
//!
//! Source: Kitware, *VTK File Formats*, and the list of types in `vtkCellType.h` of VTK 9.

/// The interpretation of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CellShape {
    /// A polygon with its points in order.
    Polygon,
    /// A strip of triangles.
    Strip,
    /// A quad whose points are in the order of pixels: the last two are exchanged.
    Pixel,
    /// A curved polygon; the first points, this many, are its corners.
    Curved(usize),
    /// A curved polygon; the first half of its points are its corners.
    CurvedHalf,
    /// Not a surface.
    LeftOut,
}

/// The shape for a type.
pub(super) fn shape(kind: u8) -> CellShape {
    match kind {
        // Triangle, polygon, quad.
        5 | 7 | 9 => CellShape::Polygon,
        6 => CellShape::Strip,
        8 => CellShape::Pixel,
        // Triangles of second order, by Lagrange and by Bézier.
        22 | 34 | 69 | 76 => CellShape::Curved(3),
        // The same for quads, and the quad with two straight sides.
        23 | 28 | 30 | 70 | 77 => CellShape::Curved(4),
        36 => CellShape::CurvedHalf,
        _ => CellShape::LeftOut,
    }
}

/// The names of types, for warnings.
const NAMES: [(u8, &str); 40] = [
    (0, "empty cell"),
    (1, "vertex"),
    (2, "poly-vertex"),
    (3, "line"),
    (4, "polyline"),
    (10, "tetrahedron"),
    (11, "voxel"),
    (12, "hexahedron"),
    (13, "wedge"),
    (14, "pyramid"),
    (15, "pentagonal prism"),
    (16, "hexagonal prism"),
    (21, "quadratic edge"),
    (22, "quadratic triangle"),
    (23, "quadratic quad"),
    (24, "quadratic tetrahedron"),
    (25, "quadratic hexahedron"),
    (26, "quadratic wedge"),
    (27, "quadratic pyramid"),
    (28, "biquadratic quad"),
    (29, "triquadratic hexahedron"),
    (30, "quadratic linear quad"),
    (31, "quadratic linear wedge"),
    (32, "biquadratic quadratic wedge"),
    (33, "biquadratic quadratic hexahedron"),
    (34, "biquadratic triangle"),
    (35, "cubic line"),
    (36, "quadratic polygon"),
    (37, "triquadratic pyramid"),
    (41, "convex point set"),
    (42, "polyhedron"),
    (68, "Lagrange curve"),
    (69, "Lagrange triangle"),
    (70, "Lagrange quad"),
    (71, "Lagrange tetrahedron"),
    (72, "Lagrange hexahedron"),
    (73, "Lagrange wedge"),
    (75, "Bézier curve"),
    (76, "Bézier triangle"),
    (77, "Bézier quad"),
];

/// The name of a type in a sentence, as in "tetrahedron (type 10)".
pub(super) fn title(kind: u8) -> String {
    match NAMES.iter().find(|(number, _)| *number == kind) {
        Some((_, name)) => format!("{name} (type {kind})"),
        None => format!("type {kind}"),
    }
}
