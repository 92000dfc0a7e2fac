//! `Setting`: the settings that messages advise; each front end spells them in its own way.
use super::Cure;

/// A setting of a caller that messages of the library advise. Each front end spells it as its users do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Setting {
    /// The unit of the input's lengths.
    Unit,
    /// The format of the input.
    From,
    /// How the polygons of an `.obj` are interpreted: the name of a kind of surface.
    Surface,
    /// One volume of a file that holds several.
    Index,
    /// Whether bytes beyond the declared samples are skipped.
    Lenient,
    /// The box at which a field is cut off: its lower corner, a space, its upper corner.
    Region,
    /// The text that is set in a font.
    Text,
    /// The level of an isosurface.
    Iso,
    /// The labels that get a surface each.
    Labels,
    /// The standard deviation of a Gaussian over a mask.
    Smooth,
    /// Whether a surface stays open at the border of its volume.
    Open,
    /// The largest distance from the true shape.
    Tol,
    /// The largest distance on a screen, in pixels.
    Px,
    /// The camera that pixels are for.
    View,
    /// How near an eye comes to levels of detail.
    Nearest,
    /// The most triangles.
    Triangles,
    /// The most segments of polylines.
    Segments,
    /// The rounds of refinement of a cage.
    Level,
    /// The most triangles of a tile.
    TileTriangles,
    /// The most bytes of memory.
    MaxMemory,
    /// The codec that compresses a glTF.
    Compress,
    /// Whether the numbers of a glTF are rounded to fewer bits.
    Quantize,
    /// How far to go for the best result: with a proof, or with a count of triangles.
    Effort,
    /// Whether an inspection looks for triangles that cross.
    SelfIntersections,
    /// Which way closed pieces inside others face.
    Nested,
    /// The allowed error of texture coordinates.
    UvError,
    /// The allowed error of normals.
    NormalError,
    /// A repair of a mesh.
    Cure(Cure),
}

impl Setting {
    /// All except the repairs, which [`Cure::ALL`] lists.
    pub const PLAIN: [Self; 27] = [
        Self::Unit,
        Self::From,
        Self::Surface,
        Self::Index,
        Self::Lenient,
        Self::Region,
        Self::Text,
        Self::Iso,
        Self::Labels,
        Self::Smooth,
        Self::Open,
        Self::Tol,
        Self::Px,
        Self::View,
        Self::Nearest,
        Self::Triangles,
        Self::Segments,
        Self::Level,
        Self::TileTriangles,
        Self::MaxMemory,
        Self::Compress,
        Self::Quantize,
        Self::Effort,
        Self::SelfIntersections,
        Self::Nested,
        Self::UvError,
        Self::NormalError,
    ];

    /// Its words, joined by hyphens.
    ///
    /// ```
    /// use chordal::budget::advice::{Cure, Setting};
    /// assert_eq!(Setting::MaxMemory.name(), "max-memory");
    /// assert_eq!(Setting::Cure(Cure::FillHoles).name(), "fill-holes");
    /// ```
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Unit => "unit",
            Self::From => "from",
            Self::Surface => "surface",
            Self::Index => "index",
            Self::Lenient => "lenient",
            Self::Region => "region",
            Self::Text => "text",
            Self::Iso => "iso",
            Self::Labels => "labels",
            Self::Smooth => "smooth",
            Self::Open => "open",
            Self::Tol => "tol",
            Self::Px => "px",
            Self::View => "view",
            Self::Nearest => "nearest",
            Self::Triangles => "triangles",
            Self::Segments => "segments",
            Self::Level => "level",
            Self::TileTriangles => "tile-triangles",
            Self::MaxMemory => "max-memory",
            Self::Compress => "compress",
            Self::Quantize => "quantize",
            Self::Effort => "effort",
            Self::Nested => "nested",
            Self::SelfIntersections => "self-intersections",
            Self::UvError => "uv-error",
            Self::NormalError => "normal-error",
            Self::Cure(cure) => cure.name(),
        }
    }
}
