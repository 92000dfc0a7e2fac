//! Scenes as a text and blocks of bytes, and back without loss: for Python's pickle, and for meshes from
//! arrays.
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic};
use chordal_io::glb::GltfPacking;
use chordal_io::{
    Axis, FaceKind, Frame, ImageContent, Marks, Node, PackedAccessor, Part, Scene, SceneAssets, SceneImage,
    TextureOrigin,
};
use serde_json::{Map, Value, json};
use std::ops::Deref;
use std::sync::Arc;

/// A scene as JSON with its numbers in blocks, which the JSON references by index.
pub(crate) struct SceneState {
    pub facts: Value,
    pub blocks: Vec<Vec<u8>>,
}

/// Blocks that are being written.
#[derive(Default)]
struct BlockList(Vec<Vec<u8>>);

impl BlockList {
    fn put(&mut self, bytes: Vec<u8>) -> usize {
        self.0.push(bytes);
        self.0.len() - 1
    }

    fn numbers(&mut self, numbers: &[f64]) -> usize {
        self.put(numbers.iter().flat_map(|x| x.to_ne_bytes()).collect())
    }

    fn indices(&mut self, indices: &[u32]) -> usize {
        self.put(indices.iter().flat_map(|i| i.to_ne_bytes()).collect())
    }

    fn accessors(&mut self, accessors: &[PackedAccessor]) -> Value {
        let facts = |packed: &PackedAccessor| json!({ "properties": packed.properties, "block": self.put(packed.bytes.to_vec()) });
        accessors.iter().map(facts).collect()
    }
}

impl SceneState {
    pub(crate) fn from_scene(scene: &Scene) -> Self {
        let mut blocks = BlockList::default();
        let parts: Value = scene.parts.iter().map(|part| part_facts(part, &mut blocks)).collect();
        let nodes: Value = scene.nodes.iter().map(node_facts).collect();
        let facts = json!({
            "parts": parts,
            "nodes": nodes,
            "roots": scene.roots,
            "frame": frame_facts(&scene.frame),
            "certificate": scene.certificate,
            "groups": scene.groups,
            "assets": assets_facts(&scene.assets, &mut blocks),
            "packing": [scene.packing.is_compressed, scene.packing.is_quantized],
            "stored": [scene.stored.is_compressed, scene.stored.is_quantized],
        });
        Self { facts, blocks: blocks.0 }
    }
}

/// The scene of a state of [`SceneState::from_scene`], or of Python code in the same form. Missing fields
/// have the defaults of files.
///
/// # Errors
/// A sentence, if the state is invalid or its arrays are no mesh.
pub(crate) fn scene_of(facts: &Value, blocks: &[impl Deref<Target = [u8]>]) -> Result<Scene, String> {
    let blocks: Vec<&[u8]> = blocks.iter().map(|block| &**block).collect();
    let blocks = Blocks(&blocks);
    let parts = list(&facts["parts"]).iter().map(|part| part_of(part, blocks));
    let parts = parts.collect::<Result<Vec<_>, _>>()?;
    let mut nodes = list(&facts["nodes"]).iter().map(node_of).collect::<Result<Vec<_>, _>>()?;
    let mut roots = indices_in(&facts["roots"])?;
    if facts["nodes"].is_null() {
        // Arrays come without nodes: each part is shown once, in its own coordinates.
        let shown =
            |(k, part): (usize, &Part)| Node { name: part.name.clone(), part: Some(k), ..Node::default() };
        nodes = parts.iter().enumerate().map(shown).collect();
        roots = (0..nodes.len()).collect();
    }
    if nodes.iter().any(|node| node.part.is_some_and(|part| part >= parts.len())) {
        return Err("a node references a part that does not exist".to_owned());
    }
    if nodes.iter().flat_map(|node| &node.children).chain(&roots).any(|node| *node >= nodes.len()) {
        return Err("a node is referenced that does not exist".to_owned());
    }
    let groups = facts["groups"].as_object().into_iter().flatten();
    Ok(Scene {
        parts,
        nodes,
        roots,
        frame: frame_of(&facts["frame"]),
        certificate: Some(facts["certificate"].clone()).filter(|certificate| !certificate.is_null()),
        groups: groups.map(|(kind, names)| (kind.clone(), texts(names))).collect(),
        assets: Box::new(assets_of(&facts["assets"], blocks)?),
        packing: packing_of(&facts["packing"]),
        stored: packing_of(&facts["stored"]),
        ..Scene::default()
    })
}

fn part_facts(part: &Part, blocks: &mut BlockList) -> Value {
    let mesh = &part.mesh;
    let attributes: Value =
        mesh.attributes().iter().map(|attribute| attribute_facts(attribute, blocks)).collect();
    let marks: Value = part.marks.iter().map(|marks| marks_facts(marks, blocks)).collect();
    json!({
        "name": part.name,
        "indexed": part.indexed,
        "properties": part.properties,
        "positions": blocks.numbers(mesh.positions().as_flattened()),
        "faces": blocks.indices(mesh.faces().as_flattened()),
        "position_id": mesh.position_id().map(|id| blocks.indices(id)),
        "attributes": attributes,
        "marks": marks,
    })
}

fn attribute_facts(attribute: &Attribute, blocks: &mut BlockList) -> Value {
    let mut facts = attribute_names(attribute);
    facts["block"] = blocks.numbers(&attribute.values).into();
    facts
}

/// The kind, domain and width of an attribute, as Python spells them.
pub(crate) fn attribute_names(attribute: &Attribute) -> Value {
    let domain = match attribute.domain {
        Domain::Vertex => "vertex",
        Domain::Corner => "corner",
        Domain::Face => "face",
    };
    let (kind, of): (&str, Value) = match &attribute.semantic {
        Semantic::Normal => ("normal", Value::Null),
        Semantic::Tangent => ("tangent", Value::Null),
        Semantic::TexCoord(set) => ("uv", (*set).into()),
        Semantic::Color(set) => ("color", (*set).into()),
        Semantic::Group(kind) => ("group", kind.as_str().into()),
        Semantic::Custom(name) => ("custom", name.as_str().into()),
        Semantic::Blended(name) => ("blended", name.as_str().into()),
    };
    json!({ "kind": kind, "of": of, "domain": domain, "width": attribute.width })
}

fn marks_facts(marks: &Marks, blocks: &mut BlockList) -> Value {
    let accessors = blocks.accessors(&marks.accessors);
    json!({ "primitive": marks.primitive, "material": marks.material, "accessors": accessors })
}

fn node_facts(node: &Node) -> Value {
    json!({
        "name": node.name,
        "matrix": *node.matrix,
        "children": node.children,
        "part": node.part,
        "properties": *node.properties,
    })
}

fn frame_facts(frame: &Frame) -> Value {
    let origin = frame.texture_origin.map(|origin| match origin {
        TextureOrigin::LowerLeft => "lower-left",
        TextureOrigin::UpperLeft => "upper-left",
    });
    json!({ "up": frame.up.map(Axis::letter), "metres_per_unit": frame.metres_per_unit, "texture_origin": origin })
}

fn assets_facts(assets: &SceneAssets, blocks: &mut BlockList) -> Value {
    let image = |image: &SceneImage| match &image.content {
        ImageContent::Bytes(bytes) => {
            json!({ "properties": image.properties, "block": blocks.put(bytes.to_vec()) })
        }
        ImageContent::Uri(uri) => json!({ "properties": image.properties, "uri": uri }),
    };
    let images: Value = assets.images.iter().map(image).collect();
    let kind = |(at, kind): (&usize, &FaceKind)| json!([at, kind.material, kind.properties]);
    let face_kinds: Value = assets.face_kinds.iter().map(kind).collect();
    json!({
        "materials": assets.materials,
        "textures": assets.textures,
        "samplers": assets.samplers,
        "images": images,
        "cameras": assets.cameras,
        "animations": assets.animations,
        "skins": assets.skins,
        "accessors": blocks.accessors(&assets.accessors),
        "extensions": assets.extensions,
        "required_extensions": assets.required_extensions,
        "about": assets.about,
        "scene": assets.scene,
        "extras": assets.extras,
        "face_kinds": face_kinds,
        "keeps_bare_faces": assets.keeps_bare_faces,
    })
}

/// Blocks that are being read.
#[derive(Clone, Copy)]
struct Blocks<'a>(&'a [&'a [u8]]);

impl Blocks<'_> {
    fn get(&self, at: &Value) -> Result<&[u8], String> {
        let block = at.as_u64().and_then(|at| self.0.get(usize::try_from(at).ok()?));
        block.copied().ok_or_else(|| format!("there is no block {at}"))
    }

    /// Rows of `N` numbers of `B` bytes each, decoded by `number`.
    fn rows<T: Copy, const N: usize, const B: usize>(
        &self,
        at: &Value,
        number: impl Fn([u8; B]) -> T,
    ) -> Result<Vec<[T; N]>, String> {
        let (numbers, rest_of_number) = self.get(at)?.as_chunks::<B>();
        let (rows, rest_of_row) = numbers.as_chunks::<N>();
        if !rest_of_number.is_empty() || !rest_of_row.is_empty() {
            return Err(format!("a block ends within a row of {N} numbers of {B} bytes"));
        }
        Ok(rows.iter().map(|row| row.map(&number)).collect())
    }

    fn numbers(&self, at: &Value) -> Result<Vec<f64>, String> {
        Ok(self.rows::<_, 1, _>(at, f64::from_ne_bytes)?.into_flattened())
    }

    fn indices(&self, at: &Value) -> Result<Vec<u32>, String> {
        Ok(self.rows::<_, 1, _>(at, u32::from_ne_bytes)?.into_flattened())
    }

    fn accessors(&self, accessors: &Value) -> Result<Vec<PackedAccessor>, String> {
        let accessor = |facts: &Value| {
            Ok(PackedAccessor {
                properties: map(&facts["properties"]),
                bytes: Arc::from(self.get(&facts["block"])?),
            })
        };
        list(accessors).iter().map(accessor).collect()
    }
}

fn part_of(facts: &Value, blocks: Blocks<'_>) -> Result<Part, String> {
    let points = blocks.rows(&facts["positions"], f64::from_ne_bytes)?;
    let faces = blocks.rows(&facts["faces"], u32::from_ne_bytes)?;
    let sentence = |error: chordal::explicit::InvalidMesh| error.to_string();
    let mut mesh = Mesh::new(points, faces).map_err(sentence)?;
    if !facts["position_id"].is_null() {
        mesh = mesh.with_position_id(blocks.indices(&facts["position_id"])?).map_err(sentence)?;
    }
    for attribute in list(&facts["attributes"]) {
        mesh = mesh.with_attribute(attribute_of(attribute, blocks)?).map_err(sentence)?;
    }
    let marks = list(&facts["marks"]).iter().map(|marks| marks_of(marks, blocks));
    Ok(Part {
        name: text(&facts["name"]),
        mesh,
        indexed: facts["indexed"].as_bool().unwrap_or(true),
        properties: facts["properties"].as_object().map(|own| Box::new(own.clone())),
        storage: None,
        marks: marks.collect::<Result<Vec<_>, _>>()?.into(),
    })
}

fn attribute_of(facts: &Value, blocks: Blocks<'_>) -> Result<Attribute, String> {
    let of = &facts["of"];
    let set = || of.as_u64().and_then(|set| u32::try_from(set).ok()).unwrap_or(0);
    let (semantic, widths) = match facts["kind"].as_str() {
        Some("normal") => (Semantic::Normal, 3..=3),
        Some("tangent") => (Semantic::Tangent, 4..=4),
        Some("uv") => (Semantic::TexCoord(set()), 2..=2),
        Some("color") => (Semantic::Color(set()), 3..=4),
        Some("group") => (Semantic::Group(text(of)), 1..=1),
        Some("custom") => (Semantic::Custom(text(of)), 1..=16),
        Some("blended") => (Semantic::Blended(text(of)), 1..=16),
        _ => return Err(format!("{} is no kind of attribute", facts["kind"])),
    };
    let domain = match facts["domain"].as_str() {
        Some("vertex") => Domain::Vertex,
        Some("corner") => Domain::Corner,
        Some("face") => Domain::Face,
        _ => return Err(format!("{} is neither vertex, corner nor face", facts["domain"])),
    };
    let width = index(&facts["width"])?;
    if !widths.contains(&width) {
        return Err(format!(
            "{}: rows of {} to {} numbers, not {width}",
            facts["kind"],
            widths.start(),
            widths.end()
        ));
    }
    let values = blocks.numbers(&facts["block"])?;
    if values.iter().any(|value| !value.is_finite()) && !matches!(semantic, Semantic::Custom(_)) {
        return Err(format!("{}: a number is not finite", facts["kind"]));
    }
    Ok(Attribute { semantic, domain, width, values })
}

fn marks_of(facts: &Value, blocks: Blocks<'_>) -> Result<Marks, String> {
    let material = Some(&facts["material"]).filter(|material| !material.is_null()).map(index).transpose()?;
    Ok(Marks {
        primitive: map(&facts["primitive"]),
        material,
        accessors: blocks.accessors(&facts["accessors"])?,
    })
}

fn node_of(facts: &Value) -> Result<Node, String> {
    let numbers: Vec<f64> = list(&facts["matrix"]).iter().filter_map(Value::as_f64).collect();
    let matrix = match (facts["matrix"].is_null(), <[f64; 16]>::try_from(numbers)) {
        (true, _) => Node::default().matrix,
        (_, Ok(matrix)) if matrix.iter().all(|x| x.is_finite()) => matrix.into(),
        _ => return Err("a matrix of a node is not sixteen finite numbers".to_owned()),
    };
    Ok(Node {
        name: text(&facts["name"]),
        matrix,
        children: indices_in(&facts["children"])?,
        part: Some(&facts["part"]).filter(|part| !part.is_null()).map(index).transpose()?,
        properties: map(&facts["properties"]).into(),
    })
}

fn frame_of(facts: &Value) -> Frame {
    Frame {
        up: match facts["up"].as_str() {
            Some("y") => Some(Axis::Y),
            Some("z") => Some(Axis::Z),
            _ => None,
        },
        metres_per_unit: facts["metres_per_unit"].as_f64(),
        texture_origin: match facts["texture_origin"].as_str() {
            Some("lower-left") => Some(TextureOrigin::LowerLeft),
            Some("upper-left") => Some(TextureOrigin::UpperLeft),
            _ => None,
        },
    }
}

fn assets_of(facts: &Value, blocks: Blocks<'_>) -> Result<SceneAssets, String> {
    let image = |facts: &Value| {
        let content = match facts["uri"].as_str() {
            Some(uri) => ImageContent::Uri(uri.to_owned()),
            None => ImageContent::Bytes(Arc::from(blocks.get(&facts["block"])?)),
        };
        Ok(SceneImage { properties: map(&facts["properties"]), content })
    };
    let kind = |facts: &Value| {
        let kind = FaceKind { material: index(&facts[1])?, properties: map(&facts[2]) };
        Ok((index(&facts[0])?, kind))
    };
    Ok(SceneAssets {
        materials: list(&facts["materials"]).to_vec(),
        textures: list(&facts["textures"]).to_vec(),
        samplers: list(&facts["samplers"]).to_vec(),
        images: list(&facts["images"]).iter().map(image).collect::<Result<_, String>>()?,
        cameras: list(&facts["cameras"]).to_vec(),
        animations: list(&facts["animations"]).to_vec(),
        skins: list(&facts["skins"]).to_vec(),
        accessors: blocks.accessors(&facts["accessors"])?,
        extensions: map(&facts["extensions"]),
        required_extensions: texts(&facts["required_extensions"]),
        about: map(&facts["about"]),
        scene: map(&facts["scene"]),
        extras: Some(facts["extras"].clone()).filter(|extras| !extras.is_null()),
        face_kinds: list(&facts["face_kinds"]).iter().map(kind).collect::<Result<_, String>>()?,
        keeps_bare_faces: facts["keeps_bare_faces"].as_bool().unwrap_or(false),
    })
}

fn packing_of(facts: &Value) -> GltfPacking {
    let flag = |k: usize| facts[k].as_bool().unwrap_or(false);
    GltfPacking { is_compressed: flag(0), is_quantized: flag(1) }
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn map(value: &Value) -> Map<String, Value> {
    value.as_object().cloned().unwrap_or_default()
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

fn texts(value: &Value) -> Vec<String> {
    list(value).iter().map(text).collect()
}

fn index(value: &Value) -> Result<usize, String> {
    value.as_u64().and_then(|n| usize::try_from(n).ok()).ok_or_else(|| format!("{value} is no index"))
}

fn indices_in(value: &Value) -> Result<Vec<usize>, String> {
    list(value).iter().map(index).collect()
}
