//! `ColladaDocument`: the geometries, materials and nodes of a COLLADA file.
use super::geometry::ColladaGeometry;
use super::looks::ColladaLooks;
use std::collections::BTreeMap;

/// An instance in a node.
#[derive(Clone, Debug)]
pub(super) struct ColladaInstance {
    /// "instance_geometry", "instance_controller" or "instance_node".
    pub kind: InstanceKind,
    /// The id, or empty if it is in another file.
    pub target: String,
    /// Material symbols of the geometry with the ids of their materials.
    pub bindings: Vec<[String; 2]>,
    pub line: u32,
}

/// The kind of an instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InstanceKind {
    Geometry,
    Controller,
    Node,
}

/// A node.
#[derive(Clone, Debug)]
pub(super) struct ColladaNode {
    pub name: String,
    pub matrix: [f64; 16],
    pub children: Vec<usize>,
    pub instances: Vec<ColladaInstance>,
}

/// The axis that is up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum UpAxis {
    X,
    #[default]
    Y,
    Z,
}

/// The content of a file.
#[derive(Debug, Default)]
pub(super) struct ColladaDocument {
    pub up: UpAxis,
    pub metres_per_unit: f64,
    pub looks: ColladaLooks,
    pub geometries: Vec<ColladaGeometry>,
    pub geometry_ids: BTreeMap<String, usize>,
    /// The mesh or controller that each controller deforms.
    pub controllers: BTreeMap<String, String>,
    pub nodes: Vec<ColladaNode>,
    pub node_ids: BTreeMap<String, usize>,
    /// The roots of each visual scene, with its id.
    pub scenes: Vec<(String, Vec<usize>)>,
    /// The scene that is shown.
    pub shown: Option<String>,
}
