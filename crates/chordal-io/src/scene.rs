//! `Scene`: what a file says: parts, where they stand, and the frame they are in.
use crate::{Curves, Drawing, Polygons, Volume, Warning};
use chordal::implicit::Field;
use chordal::math::Box3;
use chordal::{Mesh, Patch};
use serde_json::Value;
use std::collections::BTreeMap;

/// An axis of space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// The second axis, as in glTF.
    Y,
    /// The third axis, as in most CAD.
    Z,
}

/// What is known of the space that coordinates live in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frame {
    /// Which axis is up, if the format or the user says.
    pub up: Option<Axis>,
    /// The length of one unit, if the format or the user says.
    pub metres_per_unit: Option<f64>,
}

/// One mesh with its name. Its coordinates are its own; nodes place it.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The name in the file, or empty.
    pub name: String,
    /// The triangles.
    pub mesh: Mesh,
    /// Whether vertices are tied by the file's own position indices (OBJ, PLY); false where the format has none
    /// (STL, glTF) and bit-identical positions tie them.
    pub indexed: bool,
}

/// A place in the scene: a transform, children, and maybe a part that is shown there.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// The name in the file, or empty.
    pub name: String,
    /// Column-major 4 × 4 matrix from this node's space to its parent's.
    pub matrix: [f64; 16],
    /// Indices of child nodes.
    pub children: Vec<usize>,
    /// Index of the part shown here.
    pub part: Option<usize>,
}

/// Everything a mesh file says. A format without nodes gives one identity node a part.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// The meshes.
    pub parts: Vec<Part>,
    /// The places.
    pub nodes: Vec<Node>,
    /// Nodes without a parent.
    pub roots: Vec<usize>,
    /// The space.
    pub frame: Frame,
    /// The certificate that travels in the file, if it carries one.
    pub certificate: Option<Value>,
    /// What the values of a face attribute `Semantic::Group(kind)` stand for: `groups[kind][value]` is a name, for the
    /// kinds that have names ("usemtl", "g", "o" of OBJ, "solid" of STL). Value 0 is a face without such a group.
    pub groups: BTreeMap<String, Vec<String>>,
}

/// What a reader found.
#[derive(Clone, Debug)]
pub enum Content {
    /// Bicubic Bézier patches.
    Patches(Vec<Patch>, Frame),
    /// Meshes.
    Scene(Scene),
    /// A polygon cage.
    Polygons(Polygons),
    /// Curves in the plane.
    Drawing(Drawing),
    /// Curves in space.
    Curves(Curves),
    /// A shape as a rule.
    Field {
        /// The rule.
        field: Field,
        /// The box that the format looks at it in, where it has one.
        region: Option<Box3>,
        /// The space that it is in.
        frame: Frame,
    },
    /// Samples on a lattice.
    Volume(Volume),
}

/// A shape with what was odd about its file.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The shape.
    pub content: Content,
    /// Counted oddities.
    pub warnings: Vec<Warning>,
}

/// The matrix that changes nothing.
pub(crate) const IDENTITY: [f64; 16] =
    [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

impl Scene {
    /// The scene of one mesh that stands where its coordinates say.
    #[must_use]
    pub fn of(name: &str, mesh: Mesh, indexed: bool, frame: Frame) -> Self {
        let part = Part { name: name.to_owned(), mesh, indexed };
        let node = Node { name: name.to_owned(), matrix: IDENTITY, children: Vec::new(), part: Some(0) };
        Self { parts: vec![part], nodes: vec![node], roots: vec![0], frame, ..Self::default() }
    }
}
