//! `ColladaDocument`: the geometries, looks and nodes of a Collada file.
use super::geometry::ColladaGeometry;
use super::looks::ColladaLooks;
use std::collections::BTreeMap;

/// What a node shows.
#[derive(Clone, Debug)]
pub(super) struct ColladaInstance {
    /// "instance_geometry", "instance_controller" or "instance_node".
    pub kind: InstanceKind,
    /// The id, or nothing where it is in another file.
    pub target: String,
    /// Symbols of the geometry with the ids of their materials.
    pub bindings: Vec<[String; 2]>,
    pub line: u32,
}

/// The kind of what a node shows.
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

/// A file.
#[derive(Debug, Default)]
pub(super) struct ColladaDocument {
    pub up: UpAxis,
    pub metres_per_unit: f64,
    pub looks: ColladaLooks,
    pub geometries: Vec<ColladaGeometry>,
    pub geometry_ids: BTreeMap<String, usize>,
    /// What each controller deforms.
    pub controllers: BTreeMap<String, String>,
    pub nodes: Vec<ColladaNode>,
    pub node_ids: BTreeMap<String, usize>,
    /// The roots of each visual scene, with its id.
    pub scenes: Vec<(String, Vec<usize>)>,
    /// The scene that is shown.
    pub shown: Option<String>,
}
