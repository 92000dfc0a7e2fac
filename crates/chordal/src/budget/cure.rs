//! `Cure`: the repairs of meshes by name; `chordal::mend` applies them.

/// A repair of a mesh, in the order in which repairs are applied: first those that the others rely on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Cure {
    /// Make vertices at one position one vertex.
    Weld,
    /// Drop faces that repeat an earlier one.
    DropDuplicates,
    /// Drop faces without area, without opening the surface.
    DropDegenerate,
    /// Split edges at the vertices that lie in their interior.
    ResolveTJunctions,
    /// Duplicate vertices until every edge and every vertex is manifold.
    SplitNonManifold,
    /// Turn faces until neighbours agree and closed components face outward.
    Orient,
    /// Close boundary loops with triangles.
    FillHoles,
    /// Drop vertices that no face uses.
    DropUnused,
}

impl Cure {
    /// All, in their order. After filling holes, `mend` orients once more if orienting was requested.
    pub const ALL: [Self; 8] = [
        Self::Weld,
        Self::DropDuplicates,
        Self::DropDegenerate,
        Self::ResolveTJunctions,
        Self::SplitNonManifold,
        Self::Orient,
        Self::FillHoles,
        Self::DropUnused,
    ];

    /// Its stable name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Weld => "weld",
            Self::DropDuplicates => "drop-duplicates",
            Self::DropDegenerate => "drop-degenerate",
            Self::ResolveTJunctions => "resolve-t-junctions",
            Self::SplitNonManifold => "split-nonmanifold",
            Self::Orient => "orient",
            Self::FillHoles => "fill-holes",
            Self::DropUnused => "drop-unused",
        }
    }
}
