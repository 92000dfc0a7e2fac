//! `StoredPositions`: the numbers by which a glTF stores the positions of a part, and where its node puts them.
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

/// The storage of a part in a file that is packed so: `None` where nothing is quantized.
pub(crate) fn storage_of(part: &Part, packing: GltfPacking) -> Option<VertexStorage> {
    packing
        .is_quantized
        .then(|| part.storage.as_deref().copied().unwrap_or_else(|| VertexStorage::of(&part.mesh)))
}

impl StoredPositions {
    /// How a mesh is stored. One that reaches farther than 16 bits stays in single precision, in which points of
    /// a lattice are as exact.
    pub fn new(mesh: &Mesh, storage: Option<VertexStorage>) -> Self {
        let lattice = storage.and_then(|storage| storage.lattice);
        let corner = lattice.and_then(|lattice| Some((lattice, lattice.corner(&mesh.bounds())?)));
        match corner {
            Some((lattice, corner)) => Self::Lattice(lattice, corner),
            None => Self::Single(origin_of(mesh)),
        }
    }

    /// Whether the stored numbers are positions without anything that a node does.
    pub fn is_plain(&self) -> bool {
        *self == Self::Single([0.0; 3])
            || matches!(self, Self::Lattice(l, c) if l.step() == 1.0 && *c == [0.0; 3])
    }

    /// Sets what a node does to the stored numbers.
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

    /// The numbers that stand for a position.
    pub fn stored(&self, position: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Single(origin) => std::array::from_fn(|k| f64::from(store(origin[k], position[k]))),
            Self::Lattice(lattice, corner) => lattice.stored(position, *corner).map(f64::from),
        }
    }

    /// Where a node puts a position, taken exactly.
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
