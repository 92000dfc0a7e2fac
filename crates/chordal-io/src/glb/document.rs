//! `GltfDocument`: the JSON of a GLB that is being written, and the streams behind its accessors.
use super::node_list;
use super::split::split;
use super::streams::{AccessorStream, stored_bounds};
use crate::single_precision::origin_of;
use crate::{CoordinateOverflow, Part, Scene, WriteError};
use chordal::Mesh;
use chordal::explicit::Semantic;
use serde_json::{Map, Value, json};
use std::borrow::Cow;

/// A part in the form that glTF can hold.
pub(super) struct GltfPart<'a> {
    mesh: Cow<'a, Mesh>,
    origin: [f64; 3],
}

impl<'a> GltfPart<'a> {
    pub fn from_part(part: &'a Part) -> Result<Self, WriteError> {
        let mesh = split(&part.mesh).map_err(|error| WriteError::Unsupported(error.to_string()))?;
        let n_points = mesh.positions().len();
        if mesh.faces().is_empty() && n_points > 0 {
            let name = &part.name;
            return Err(WriteError::Unsupported(format!(
                "part \"{name}\" has {n_points} points and no triangle"
            )));
        }
        let origin = origin_of(&mesh);
        Ok(Self { mesh, origin })
    }
}

/// The JSON that is being built, and the streams behind its accessors.
#[derive(Default)]
pub(super) struct GltfDocument<'a> {
    accessors: Vec<Value>,
    views: Vec<Value>,
    meshes: Vec<Value>,
    materials: Vec<Value>,
    /// The content of the BIN chunk, in order.
    pub streams: Vec<AccessorStream<'a>>,
    n_bytes: u64,
    /// For each part its mesh, unless it is empty, and its origin.
    shown: Vec<node_list::PartMesh>,
    /// The materials for meshes without and with a boundary, once they are used.
    material: [Option<usize>; 2],
}

impl<'a> GltfDocument<'a> {
    /// Adds the mesh of a part, in the order of the scene.
    pub fn add_part(&mut self, part: &Part, shape: &'a GltfPart<'_>) -> Result<(), WriteError> {
        let empty = shape.mesh.faces().is_empty();
        let mesh = if empty { None } else { Some(self.add_mesh(part, shape)?) };
        self.shown.push((mesh, shape.origin));
        Ok(())
    }

    fn add_mesh(&mut self, part: &Part, shape: &'a GltfPart<'_>) -> Result<usize, WriteError> {
        let mesh: &Mesh = &shape.mesh;
        let bounds = stored_bounds(mesh, shape.origin);
        if let Some(value) = bounds.as_flattened().iter().find(|x| !x.is_finite()) {
            return Err(CoordinateOverflow { value: *value }.into());
        }
        let mut attributes = Map::new();
        let at = self.add(AccessorStream::positions(mesh, shape.origin));
        self.accessors[at]["min"] = json!(bounds[0]);
        self.accessors[at]["max"] = json!(bounds[1]);
        attributes.insert("POSITION".to_owned(), json!(at));
        for stream in streams_of(mesh)? {
            let name = stream.name.clone().unwrap_or_default();
            if attributes.contains_key(&name) {
                return Err(WriteError::Unsupported(format!("two attributes are called {name}")));
            }
            attributes.insert(name, json!(self.add(stream)));
        }
        let indices = self.add(AccessorStream::indices(mesh));
        let material = self.material(is_open(mesh));
        let primitive = json!({ "attributes": attributes, "indices": indices, "material": material });
        self.meshes.push(node_list::with_name(&part.name, json!({ "primitives": [primitive] })));
        Ok(self.meshes.len() - 1)
    }

    fn add(&mut self, stream: AccessorStream<'a>) -> usize {
        self.views.push(json!({
            "buffer": 0, "byteOffset": self.n_bytes, "byteLength": stream.n_bytes(), "target": stream.target()
        }));
        self.accessors.push(json!({
            "bufferView": self.views.len() - 1, "componentType": stream.component_type(),
            "count": stream.count(), "type": stream.kind()
        }));
        self.n_bytes += stream.n_padded();
        self.streams.push(stream);
        self.accessors.len() - 1
    }

    /// A plain material. glTF's default is a metal, which viewers without an environment show black.
    fn material(&mut self, open: bool) -> usize {
        let Self { materials, material, .. } = self;
        *material[usize::from(open)].get_or_insert_with(|| {
            let mut plain =
                json!({ "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 0.5 } });
            if open {
                plain["doubleSided"] = json!(true);
            }
            materials.push(plain);
            materials.len() - 1
        })
    }

    /// The nodes of a scene whose parts were added last, after `n_before` other nodes.
    pub fn nodes(&self, scene: &Scene, n_before: usize) -> Result<node_list::NodeList, WriteError> {
        node_list::nodes(scene, &self.shown[self.shown.len() - scene.parts.len()..], n_before)
    }

    /// The content of the JSON chunk; `certificate` becomes an extra.
    pub fn json(&self, nodes: &node_list::NodeList, certificate: Option<&Value>) -> Map<String, Value> {
        let mut root = Map::new();
        let mut asset =
            json!({ "version": "2.0", "generator": concat!("Chordal ", env!("CARGO_PKG_VERSION")) });
        if let Some(certificate) = certificate {
            asset["extras"] = json!({ "chordal": certificate });
        }
        root.insert("asset".to_owned(), asset);
        root.insert("scene".to_owned(), json!(0));
        let roots = if nodes.roots.is_empty() { json!({}) } else { json!({ "nodes": nodes.roots }) };
        root.insert("scenes".to_owned(), json!([roots]));
        let buffers = if self.n_bytes == 0 { vec![] } else { vec![json!({ "byteLength": self.n_bytes })] };
        for (name, list) in [
            ("nodes", &nodes.list),
            ("meshes", &self.meshes),
            ("materials", &self.materials),
            ("accessors", &self.accessors),
            ("bufferViews", &self.views),
            ("buffers", &buffers),
        ] {
            if !list.is_empty() {
                root.insert(name.to_owned(), json!(list));
            }
        }
        root
    }
}

/// The attributes of a mesh; texture and colour sets are numbered from zero without gaps, as glTF demands.
fn streams_of(mesh: &Mesh) -> Result<Vec<AccessorStream<'_>>, WriteError> {
    let mut sorted: Vec<_> = mesh.attributes().iter().collect();
    sorted.sort_by_key(|attribute| match attribute.semantic {
        Semantic::Normal => (0, 0),
        Semantic::Tangent => (1, 0),
        Semantic::TexCoord(set) => (2, set),
        Semantic::Color(set) => (3, set),
        Semantic::Group(_) | Semantic::Custom(_) => (4, 0),
    });
    let (mut texture_sets, mut colour_sets) = (0, 0);
    let mut streams = Vec::with_capacity(sorted.len());
    for attribute in sorted {
        let counter = match attribute.semantic {
            Semantic::Color(_) => &mut colour_sets,
            _ => &mut texture_sets,
        };
        streams.push(AccessorStream::attribute(attribute, *counter)?);
        if matches!(attribute.semantic, Semantic::Color(_) | Semantic::TexCoord(_)) {
            *counter += 1;
        }
    }
    Ok(streams)
}

/// Whether an edge has a triangle on one side only. Vertices at one position count as one.
fn is_open(mesh: &Mesh) -> bool {
    let mut edges = Vec::with_capacity(3 * mesh.faces().len());
    for face in mesh.faces() {
        let [a, b, c] = face.map(|v| mesh.position_of(v));
        for (from, to) in [(a, b), (b, c), (c, a)] {
            if from != to {
                edges.push(if from < to { (from, to) } else { (to, from) });
            }
        }
    }
    edges.sort_unstable();
    edges.chunk_by(|a, b| a == b).any(|same| same.len() == 1)
}
