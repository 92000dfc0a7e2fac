//! `StoredPositions`: how a glTF stores the positions of a part, and the node transform that restores them.
use super::packing::GltfPacking;
use super::position_lattice::PositionLattice;
use super::vertex_storage::VertexStorage;
use crate::Part;
use crate::single_precision::{origin_of, store};
use chordal::Mesh;
use chordal::math::Interval;
use serde_json::{Map, Value, json};

/// How positions are stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum StoredPositions {
    /// In single precision about an origin.
    Single([f64; 3]),
    /// As multiples of a step, about a corner.
    Lattice(PositionLattice, [f64; 3]),
}

/// The storage of a part in a file with this packing: `None` if it is not quantized.
pub(crate) fn storage_of(part: &Part, packing: GltfPacking) -> Option<VertexStorage> {
    packing
        .is_quantized
        .then(|| part.storage.as_deref().copied().unwrap_or_else(|| VertexStorage::of(&part.mesh)))
}

impl StoredPositions {
    /// The storage of a mesh. A mesh that exceeds the range of 16 bits stays in single precision, which holds
    /// the points of the lattice as exactly.
    pub fn new(mesh: &Mesh, storage: Option<VertexStorage>) -> Self {
        let lattice = storage.and_then(|storage| storage.lattice);
        let corner = lattice.and_then(|lattice| Some((lattice, lattice.corner(&mesh.bounds())?)));
        match corner {
            Some((lattice, corner)) => Self::Lattice(lattice, corner),
            None => Self::Single(origin_of(mesh)),
        }
    }

    /// Whether the stored numbers are the positions, without a node transform.
    pub fn is_plain(&self) -> bool {
        *self == Self::Single([0.0; 3])
            || matches!(self, Self::Lattice(l, c) if l.step() == 1.0 && *c == [0.0; 3])
    }

    /// Adds the transform of the stored numbers to a node.
    pub fn place(&self, node: &mut Map<String, Value>) {
        let (Self::Single(origin) | Self::Lattice(_, origin)) = *self;
        if origin != [0.0; 3] {
            node.insert("translation".to_owned(), json!(origin));
        }
        if let Self::Lattice(lattice, _) = self
            && lattice.step() != 1.0
        {
            node.insert("scale".to_owned(), Value::from(vec![lattice.step(); 3]));
        }
    }

    /// The stored numbers of a position.
    pub fn stored(&self, position: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Single(origin) => std::array::from_fn(|k| f64::from(store(origin[k], position[k]))),
            Self::Lattice(lattice, corner) => lattice.stored(position, *corner).map(f64::from),
        }
    }

    /// The position after the node's transform, in interval arithmetic.
    pub fn placed(&self, position: [f64; 3]) -> [Interval; 3] {
        let stored = self.stored(position);
        match self {
            Self::Single(origin) => std::array::from_fn(|k| {
                let stored = Interval::point(stored[k]);
                if origin[k] == 0.0 { stored } else { Interval::point(origin[k]) + stored }
            }),
            Self::Lattice(lattice, _) => lattice.nearest(position).map(Interval::point),
        }
    }
}
