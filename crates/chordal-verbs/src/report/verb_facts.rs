//! `VerbFacts`: the facts that one verb adds to those in the certificates of all.
use super::{
    AttributeFacts, BooleanFacts, DistanceGridFacts, LevelsFacts, OffsetFacts, OvershadeFacts,
    RefinementFacts, RepairFacts, SmoothingFacts, ValidityFacts,
};
use serde::Serialize;

/// The facts of one verb, each under a key of its own in the certificate.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum VerbFacts {
    /// None: from `mesh` of most shapes, and from verbs that build nothing.
    Mesh {},
    /// From `mesh` of a mask that was smoothed.
    Smoothed {
        /// The effect of the smoothing.
        smoothed: SmoothingFacts,
    },
    /// From `mesh` of triangles.
    Simplified {
        /// The attribute deviation.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        attributes: Vec<AttributeFacts>,
    },
    /// From `mesh` of another surface of triangles.
    Offset {
        /// The offset.
        offset: OffsetFacts,
    },
    /// From `mesh` of several solids.
    Boolean {
        /// The operands.
        boolean: BooleanFacts,
    },
    /// From `mesh` of a cage whose polygons are the result.
    Refined {
        /// The refinement.
        refined: RefinementFacts,
    },
    /// From `mend`.
    Mended {
        /// The validity of the input's triangles.
        valid_before: Box<ValidityFacts>,
        /// The repairs, in the order of application.
        mended: Vec<RepairFacts>,
    },
    /// None: from `convert`.
    Converted {},
    /// From `bake`.
    Baked {
        /// The distance grid.
        baked: Box<DistanceGridFacts>,
    },
    /// From `lod`.
    Levels {
        /// The levels of detail.
        levels: LevelsFacts,
    },
    /// From a rendering of the shading cost on a graphics processor.
    Overshade {
        /// That cost.
        overshade: OvershadeFacts,
    },
}

impl VerbFacts {
    /// The name of the verb in histories.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Refined { .. } => "refine",
            Self::Mended { .. } => "mend",
            Self::Converted {} => "convert",
            Self::Baked { .. } => "bake",
            Self::Levels { .. } => "lod",
            Self::Mesh {}
            | Self::Smoothed { .. }
            | Self::Simplified { .. }
            | Self::Offset { .. }
            | Self::Boolean { .. }
            | Self::Overshade { .. } => "mesh",
        }
    }

    /// The attribute deviation of simplified triangles; empty for other results.
    #[must_use]
    pub fn attributes(&self) -> &[AttributeFacts] {
        if let Self::Simplified { attributes } = self { attributes } else { &[] }
    }

    /// The repairs; empty for other verbs than `mend`.
    #[must_use]
    pub fn repairs(&self) -> &[RepairFacts] {
        if let Self::Mended { mended, .. } = self { mended } else { &[] }
    }

    /// The operands; `None` for other results than those of several solids.
    #[must_use]
    pub fn boolean(&self) -> Option<&BooleanFacts> {
        if let Self::Boolean { boolean } = self { Some(boolean) } else { None }
    }

    /// The offset; only from `mesh` of one.
    #[must_use]
    pub fn offset(&self) -> Option<&OffsetFacts> {
        if let Self::Offset { offset } = self { Some(offset) } else { None }
    }

    /// The distance grid; only from `bake`.
    #[must_use]
    pub fn grid(&self) -> Option<&DistanceGridFacts> {
        if let Self::Baked { baked } = self { Some(baked) } else { None }
    }

    /// The levels of detail; only from `lod`.
    #[must_use]
    pub fn levels(&self) -> Option<&LevelsFacts> {
        if let Self::Levels { levels } = self { Some(levels) } else { None }
    }
}
