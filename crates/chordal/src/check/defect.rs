//! `Defect`: the possible defects of a mesh, in words, with the repairs of each.
use crate::budget::Cure;

/// A possible defect of a mesh: the one table of names, meanings and cures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Defect {
    /// Edges with one face.
    BoundaryEdges,
    /// Edges with three or more faces.
    NonManifoldEdges,
    /// Positions with two or more fans.
    NonManifoldVertices,
    /// Vertices in the interior of an edge of which they are no end.
    TJunctions,
    /// Edges with two faces that are wound inconsistently.
    InconsistentEdges,
    /// Components whose front faces inward.
    InsideOut,
    /// Pairs of faces that intersect where they should not.
    SelfIntersections,
    /// Faces with the same positions as an earlier one.
    DuplicateFaces,
    /// Positions with the same coordinates as an earlier one.
    DuplicateVertices,
    /// Faces with two corners at one position.
    CollapsedFaces,
    /// Faces without area.
    ZeroAreaFaces,
    /// Faces much longer than high.
    Slivers,
    /// Rows that no face uses.
    UnusedVertices,
}

/// The consequences of a defect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The surface violates the promises of its kind: printing, simulation and Boolean operations may fail.
    Fault,
    /// The surface is valid; its triangles could be better.
    Remark,
}

impl Defect {
    /// All defects, the most severe first.
    pub const ALL: [Self; 13] = [
        Self::NonManifoldEdges,
        Self::NonManifoldVertices,
        Self::SelfIntersections,
        Self::InconsistentEdges,
        Self::InsideOut,
        Self::TJunctions,
        Self::BoundaryEdges,
        Self::DuplicateFaces,
        Self::CollapsedFaces,
        Self::ZeroAreaFaces,
        Self::DuplicateVertices,
        Self::Slivers,
        Self::UnusedVertices,
    ];

    /// The name of its count in a report.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::BoundaryEdges => "boundary_edges",
            Self::NonManifoldEdges => "non_manifold_edges",
            Self::NonManifoldVertices => "non_manifold_vertices",
            Self::TJunctions => "t_junctions",
            Self::InconsistentEdges => "inconsistent_edges",
            Self::InsideOut => "inside_out",
            Self::SelfIntersections => "self_intersections",
            Self::DuplicateFaces => "duplicate_faces",
            Self::DuplicateVertices => "duplicate_vertices",
            Self::CollapsedFaces => "collapsed_faces",
            Self::ZeroAreaFaces => "zero_area_faces",
            Self::Slivers => "slivers",
            Self::UnusedVertices => "unused_vertices",
        }
    }

    /// Its name in words, singular and plural.
    #[must_use]
    pub fn words(self) -> [&'static str; 2] {
        match self {
            Self::BoundaryEdges => ["boundary edge", "boundary edges"],
            Self::NonManifoldEdges => ["edge of three triangles or more", "edges of three triangles or more"],
            Self::NonManifoldVertices => ["vertex of several fans", "vertices of several fans"],
            Self::TJunctions => ["T-junction", "T-junctions"],
            Self::InconsistentEdges => ["edge of opposite winding", "edges of opposite winding"],
            Self::InsideOut => ["component inside out", "components inside out"],
            Self::SelfIntersections => ["self-intersection", "self-intersections"],
            Self::DuplicateFaces => ["repeated triangle", "repeated triangles"],
            Self::DuplicateVertices => ["duplicate vertex", "duplicate vertices"],
            Self::CollapsedFaces => ["collapsed triangle", "collapsed triangles"],
            Self::ZeroAreaFaces => ["triangle of no area", "triangles of no area"],
            Self::Slivers => ["sliver", "slivers"],
            Self::UnusedVertices => ["unused vertex", "unused vertices"],
        }
    }

    /// Its consequence for the user, as a clause that fits singular and plural.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        match self {
            Self::BoundaryEdges => "the surface ends there, so that it has no inside",
            Self::NonManifoldEdges => "sheets branch there, so that the next face is ambiguous",
            Self::NonManifoldVertices => "sheets touch in a point, so that its faces form no single fan",
            Self::TJunctions => "a vertex lies in a neighbour's edge: a crack may show",
            Self::InconsistentEdges => "one of the two triangles there shows its back",
            Self::InsideOut => "the front faces the inside",
            Self::SelfIntersections => "triangles meet where they should not, and inside is ambiguous",
            Self::DuplicateFaces => "two triangles lie in the same place, and their pixels flicker",
            Self::DuplicateVertices => "the surface is cut apart between equal points",
            Self::CollapsedFaces => "two corners are the same vertex, so that the area is zero",
            Self::ZeroAreaFaces => "all corners lie on one line, so that there is no normal",
            Self::Slivers => "longer than 100 heights, with a weak normal",
            Self::UnusedVertices => "no triangle has a corner there",
        }
    }

    /// How much it matters.
    #[must_use]
    pub fn severity(self) -> Severity {
        match self {
            Self::Slivers | Self::UnusedVertices | Self::DuplicateVertices => Severity::Remark,
            _ => Severity::Fault,
        }
    }

    /// Its repairs, in the order in which to try them; empty if there is none.
    #[must_use]
    pub fn cures(self) -> &'static [Cure] {
        match self {
            // A boundary between equal points is a seam, one along T-junctions is a crack, and only the
            // remaining ones are holes.
            Self::BoundaryEdges => &[Cure::Weld, Cure::ResolveTJunctions, Cure::FillHoles],
            // Coincident sheets are duplicates; only an edge that remains after they are dropped is a branch.
            Self::NonManifoldEdges => &[Cure::DropDuplicates, Cure::SplitNonManifold],
            Self::NonManifoldVertices => &[Cure::SplitNonManifold],
            Self::TJunctions => &[Cure::ResolveTJunctions],
            Self::InconsistentEdges | Self::InsideOut => &[Cure::Orient],
            Self::DuplicateFaces => &[Cure::DropDuplicates],
            Self::DuplicateVertices => &[Cure::Weld],
            Self::CollapsedFaces | Self::ZeroAreaFaces => &[Cure::DropDegenerate],
            Self::UnusedVertices => &[Cure::DropUnused],
            Self::SelfIntersections | Self::Slivers => &[],
        }
    }

    /// The advice if no repair helps.
    #[must_use]
    pub fn advice(self) -> &'static str {
        match self {
            Self::SelfIntersections => {
                "move them apart or unite the solids in the program that made them; winding numbers still tell what is inside"
            }
            Self::Slivers => {
                "mesh the true shape again, if there is one; smooth normals are safer than flat ones"
            }
            Self::InconsistentEdges => {
                "the surface has one side only, as a Möbius strip: cut it open, or draw both sides"
            }
            Self::BoundaryEdges => {
                "a surface with one side only stays open: cut it so that it has two, then fill"
            }
            Self::DuplicateVertices => "leave them: if they were welded, sheets would branch or touch there",
            _ => "look at it in the program that made it",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_complete_and_every_name_stands_once() {
        let mut names: Vec<_> = Defect::ALL.iter().map(|defect| defect.name()).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), Defect::ALL.len());
        for defect in Defect::ALL {
            assert!(defect.cures().is_sorted(), "{defect:?}: in the order in which they are applied");
            assert_ne!(defect.words()[0], defect.words()[1]);
        }
    }
}
