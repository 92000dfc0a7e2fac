//! `GltfDocument`: the JSON of a GLB that is being written, and the streams behind its accessors.
use super::QUANTIZATION;
use super::deformation::{has_skin, short_weights, skin_sets, targets_of};
use super::gltf_part::{GltfPart, is_open, streams_of};
use super::instanced_nodes::each_instance_accessor;
use super::marks::{MarkAccessor, n_targets};
use super::meshopt;
use super::node_list;
use super::packing::GltfPacking;
use super::streams::{AccessorStream, CompressedStream, stored_bounds};
use crate::assets::{ImageContent, SceneAssets, collect_extensions, plain_material};
use crate::{CoordinateOverflow, MATERIAL, Marks, Part, Scene, WriteError};
use chordal::Mesh;
use chordal::explicit::{Attribute, Semantic};
use chordal::math::{greater, lesser};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// The JSON that is being built, and the streams behind its accessors.
pub(super) struct GltfDocument<'a> {
    assets: &'a SceneAssets,
    packing: GltfPacking,
    accessors: Vec<Value>,
    views: Vec<Value>,
    meshes: Vec<Value>,
    /// The materials of the assets, then plain ones.
    materials: Vec<Value>,
    images: Vec<Value>,
    animations: Vec<Value>,
    skins: Vec<Value>,
    /// The content of the BIN chunk, in order.
    pub streams: Vec<AccessorStream<'a>>,
    n_bytes: u64,
    /// The number of bytes that compressed views unpack to, each aligned to four.
    n_unpacked: u64,
    /// Whether an accessor uses a format of `KHR_mesh_quantization`.
    has_fewer_bits: bool,
    /// For each part its mesh, unless it is empty, and its origin.
    shown: Vec<node_list::PartMesh>,
    /// The plain materials for meshes without and with a boundary, if they are used.
    material: [Option<usize>; 2],
    /// The accessors of points and lines, by properties and bytes.
    mark_accessors: BTreeMap<(String, u32, Vec<u8>), usize>,
    /// If meshes may share rows: the accessors so far, by an outline of their rows.
    known_rows: Option<BTreeMap<RowsOutline, Vec<usize>>>,
}

/// Distinguishes most streams cheaply: component type, row type, number of rows, target, bytes, fingerprint.
type RowsOutline = (u32, &'static str, usize, Option<u32>, u64, u64);

impl<'a> GltfDocument<'a> {
    /// A document with the materials and images of a scene.
    pub fn new(assets: &'a SceneAssets, packing: GltfPacking) -> Self {
        let mut document = Self {
            assets,
            packing,
            accessors: Vec::new(),
            views: Vec::new(),
            meshes: Vec::new(),
            materials: assets.own_materials(),
            images: Vec::new(),
            animations: Vec::new(),
            skins: Vec::new(),
            streams: Vec::new(),
            n_bytes: 0,
            n_unpacked: 0,
            has_fewer_bits: false,
            shown: Vec::new(),
            material: [None; 2],
            mark_accessors: BTreeMap::new(),
            known_rows: None,
        };
        for image in &assets.images {
            let mut object = image.properties.clone();
            match &image.content {
                ImageContent::Bytes(bytes) => {
                    let view = document.add_view(AccessorStream::bytes(bytes));
                    object.insert("bufferView".to_owned(), json!(view));
                }
                ImageContent::Uri(uri) => {
                    object.insert("uri".to_owned(), json!(uri));
                }
            }
            document.images.push(Value::Object(object));
        }
        document
    }

    /// Adds the animations and skins of nodes, and the transforms of instanced nodes.
    pub fn add_animations(&mut self, scene: &Scene, nodes: &mut node_list::NodeList) {
        let assets = self.assets;
        // `at[i]` is the index in the document of accessor `i` of the assets.
        let mut at = Vec::with_capacity(assets.accessors.len());
        for accessor in &assets.accessors {
            let mut object = accessor.properties.clone();
            let view = self.add_view(AccessorStream::bytes(&accessor.bytes));
            object.insert("bufferView".to_owned(), json!(view));
            self.accessors.push(Value::Object(object));
            at.push(self.accessors.len() - 1);
        }
        each_instance_accessor(&mut nodes.list, &mut |accessor| {
            *accessor = json!(accessor.as_u64().and_then(|i| at.get(usize::try_from(i).ok()?)));
        });
        let number = |node: &Value| {
            let node = node.as_u64().and_then(|node| usize::try_from(node).ok());
            json!(node.and_then(|node| nodes.number.get(node)).copied().unwrap_or_default())
        };
        // Weights of morph targets have no effect on a mesh without any.
        let moves = |channel: &Value| {
            let target = &channel["target"];
            let node = target["node"].as_u64().and_then(|node| scene.nodes.get(usize::try_from(node).ok()?));
            let part = node.and_then(|node| self.shown.get(node.part?));
            target["path"] != "weights" || part.is_some_and(|part| part.mesh.is_some() && part.n_targets > 0)
        };
        let mut animations = assets.animations.clone();
        animations.retain_mut(|animation| {
            let Some(channels) = animation["channels"].as_array_mut() else { return false };
            channels.retain(moves);
            !channels.is_empty()
        });
        for mut animation in animations {
            for channel in animation["channels"].as_array_mut().into_iter().flatten() {
                channel["target"]["node"] = number(&channel["target"]["node"]);
            }
            for sampler in animation["samplers"].as_array_mut().into_iter().flatten() {
                for key in ["input", "output"] {
                    let accessor = sampler[key].as_u64().and_then(|i| at.get(usize::try_from(i).ok()?));
                    sampler[key] = json!(accessor);
                }
            }
            self.animations.push(animation);
        }
        for skin in &assets.skins {
            let mut skin = skin.clone();
            let moved = |node: &mut Value| *node = number(node);
            skin["joints"].as_array_mut().into_iter().flatten().for_each(moved);
            skin.get_mut("skeleton").into_iter().for_each(moved);
            if let Some(matrices) = skin.get_mut("inverseBindMatrices") {
                let accessor = matrices.as_u64().and_then(|i| at.get(usize::try_from(i).ok()?));
                *matrices = json!(accessor);
            }
            self.skins.push(skin);
        }
    }

    /// Adds the mesh of a part of the scene, in the scene's order.
    pub fn add_part(&mut self, part: &Part, shape: &'a GltfPart<'_>) -> Result<(), WriteError> {
        let added = self.part_mesh(part, shape)?;
        self.shown.push(added);
        Ok(())
    }

    /// Adds the mesh of a part.
    pub fn part_mesh(
        &mut self,
        part: &Part,
        shape: &'a GltfPart<'_>,
    ) -> Result<node_list::PartMesh, WriteError> {
        let (has_faces, marks) = (!shape.mesh.faces().is_empty(), &part.marks);
        let empty = !has_faces && marks.is_empty();
        let mesh = if empty { None } else { Some(self.add_mesh(part, shape)?) };
        let has_skin = has_faces && has_skin(&shape.mesh) || marks.iter().any(Marks::has_skin);
        let n_targets = n_targets(part, &shape.mesh);
        Ok(node_list::PartMesh { mesh, positions: shape.positions, has_skin, n_targets })
    }

    fn add_mesh(&mut self, part: &Part, shape: &'a GltfPart<'_>) -> Result<usize, WriteError> {
        let mut primitives = Vec::new();
        if !shape.mesh.faces().is_empty() {
            self.add_triangles(shape, &mut primitives)?;
        }
        let n_targets = n_targets(part, &shape.mesh);
        for marks in part.marks.iter() {
            let place = (&shape.positions, n_targets);
            let mut primitive = marks.object(place, |accessor| self.add_mark_accessor(accessor));
            if let Some(material) = marks.material.filter(|material| *material < self.assets.materials.len())
            {
                primitive.insert("material".to_owned(), json!(material));
            }
            primitives.push(Value::Object(primitive));
        }
        let mut object = part.properties.as_deref().cloned().unwrap_or_default();
        if n_targets == 0 {
            object.shift_remove("weights");
        }
        object.insert("primitives".to_owned(), json!(primitives));
        self.meshes.push(node_list::with_name(&part.name, Value::Object(object)));
        Ok(self.meshes.len() - 1)
    }

    /// Adds an accessor of points and lines, shared by all that have the same bytes and properties: coarser
    /// levels repeat those of their part.
    fn add_mark_accessor(&mut self, accessor: MarkAccessor) -> usize {
        let MarkAccessor { mut properties, bytes, stride, target, needs_quantization } = accessor;
        let key = (Value::Object(properties.clone()).to_string(), target, bytes);
        if let Some(known) = self.mark_accessors.get(&key) {
            return *known;
        }
        self.has_fewer_bits |= needs_quantization;
        let view = self.add_view(AccessorStream::compressed_bytes(key.2.clone()));
        self.views[view]["target"] = json!(target);
        if let Some(stride) = stride {
            self.views[view]["byteStride"] = json!(stride);
        }
        properties.insert("bufferView".to_owned(), json!(view));
        self.accessors.push(Value::Object(properties));
        let at = self.accessors.len() - 1;
        self.mark_accessors.insert(key, at);
        at
    }

    /// Adds the primitives of the triangles of a part.
    fn add_triangles(
        &mut self,
        shape: &'a GltfPart<'_>,
        primitives: &mut Vec<Value>,
    ) -> Result<(), WriteError> {
        for own in &shape.primitives {
            let group = own.group.checked_sub(1).filter(|material| *material < self.assets.materials.len());
            let kind = group.and_then(|group| self.assets.face_kinds.get(&group));
            let material = group.map(|group| kind.map_or(group, |kind| kind.material));
            // Variants may have textures even if the plain material has none.
            let is_alone =
                shape.primitives.len() == 1 || kind.is_some_and(|kind| !kind.properties.is_empty());
            let material_object = material.and_then(|at| self.assets.materials.get(at));
            let says = |attribute: &Attribute| is_alone || own.says(attribute, material_object);
            let mut primitive = self.vertices(shape, own.mesh(&shape.mesh), says)?;
            match material {
                Some(material) => primitive["material"] = json!(material),
                None if self.assets.keeps_bare_faces => {}
                None => primitive["material"] = json!(self.material(is_open(&shape.mesh))),
            }
            for (key, value) in kind.into_iter().flat_map(|kind| &kind.properties) {
                primitive[key] = value.clone();
            }
            primitives.push(primitive);
        }
        Ok(())
    }

    /// Adds the vertices and the triangles of a primitive, without its material: only attributes with
    /// information.
    fn vertices(
        &mut self,
        shape: &GltfPart<'_>,
        mesh: &'a Mesh,
        says: impl Fn(&Attribute) -> bool,
    ) -> Result<Value, WriteError> {
        // The format asks for the bounds of the stored numbers, which rounding may put beyond the
        // mesh's own.
        let bounds = stored_bounds(mesh, &shape.positions);
        if let Some(value) = bounds.as_flattened().iter().find(|x| !x.is_finite()) {
            return Err(CoordinateOverflow { value: *value }.into());
        }
        let mut attributes = Map::new();
        let at = self.add(AccessorStream::positions(mesh, shape.positions))?;
        self.accessors[at]["min"] = json!(bounds[0]);
        self.accessors[at]["max"] = json!(bounds[1]);
        attributes.insert("POSITION".to_owned(), json!(at));
        for stream in streams_of(mesh, says)? {
            let stream = if shape.turns_v { stream.with_turned_v() } else { stream };
            let stream = shape.storage.iter().fold(stream, |stream, storage| stream.with_fewer_bits(storage));
            let name = stream.name.clone().unwrap_or_default();
            if attributes.contains_key(&name) {
                return Err(WriteError::Unsupported(format!("two attributes are called {name}")));
            }
            attributes.insert(name, json!(self.add(stream)?));
        }
        let mut sets = skin_sets(mesh);
        let short = if shape.storage.is_some() { short_weights(&mut sets) } else { Vec::new() };
        let mut short = short.into_iter();
        for (set, found) in sets.into_iter().enumerate() {
            for stream in AccessorStream::skin_set(set, found, short.next()) {
                attributes.insert(stream.name.clone().unwrap_or_default(), json!(self.add(stream)?));
            }
        }
        let targets = self.add_targets(mesh)?;
        let indices = self.add(AccessorStream::indices(mesh.faces(), mesh.positions().len()))?;
        let mut primitive = json!({ "attributes": attributes, "indices": indices });
        if !targets.is_empty() {
            primitive["targets"] = json!(targets);
        }
        Ok(primitive)
    }

    /// The morph targets of a mesh: for each its accessors by name.
    fn add_targets(&mut self, mesh: &'a Mesh) -> Result<Vec<Map<String, Value>>, WriteError> {
        let mut targets = Vec::new();
        for found in targets_of(mesh) {
            let mut target = Map::new();
            for (name, attribute) in found {
                let at = self.add(AccessorStream::morph(name, attribute)?)?;
                if name == "POSITION" {
                    // Bounds of what is stored, so in single precision; adding 0 removes the sign
                    // of −0.
                    let mut bounds = [vec![f64::INFINITY; 3], vec![f64::NEG_INFINITY; 3]];
                    for (i, x) in attribute.values.iter().enumerate() {
                        let x = f64::from(*x as f32) + 0.0;
                        let [least, most] = bounds.each_mut().map(|bound| &mut bound[i % 3]);
                        (*least, *most) = (lesser(x, *least), greater(x, *most));
                    }
                    let [least, most] = bounds;
                    (self.accessors[at]["min"], self.accessors[at]["max"]) = (json!(least), json!(most));
                }
                target.insert(name.to_owned(), json!(at));
            }
            targets.push(target);
        }
        Ok(targets)
    }

    /// From here on, accessors with the same rows are shared: many files show one shape in several materials.
    pub fn share_rows(&mut self) {
        self.known_rows = Some(BTreeMap::new());
    }

    fn add(&mut self, stream: AccessorStream<'a>) -> Result<usize, WriteError> {
        // Taken out of `self` meanwhile: both comparing rows and adding a stream need the document.
        let Some(mut known) = self.known_rows.take() else { return self.add_new(stream) };
        let outline = (
            stream.component_type(),
            stream.kind(),
            stream.count(),
            stream.target(),
            stream.n_bytes(),
            stream.fingerprint()?,
        );
        let same = known.entry(outline).or_default();
        // Equal outlines only select what to compare: rows are shared if their bytes are the same.
        let mut existing = None;
        for accessor in same.iter().copied() {
            if self.has_rows(accessor, &stream)? {
                existing = Some(accessor);
                break;
            }
        }
        let accessor = match existing {
            Some(accessor) => accessor,
            None => {
                let accessor = self.add_new(stream)?;
                same.push(accessor);
                accessor
            }
        };
        self.known_rows = Some(known);
        Ok(accessor)
    }

    /// Whether an accessor has the rows of a stream, bit for bit.
    fn has_rows(&self, accessor: usize, stream: &AccessorStream<'_>) -> Result<bool, WriteError> {
        // Each view covers one stream.
        let view =
            self.accessors[accessor]["bufferView"].as_u64().and_then(|view| usize::try_from(view).ok());
        let Some(stored) = view.and_then(|view| self.streams.get(view)) else { return Ok(false) };
        let (mut theirs, mut ours) = (Vec::new(), Vec::new());
        stored.write(&mut theirs)?;
        match if self.packing.is_compressed { stream.compressed()? } else { None } {
            Some(compressed) => AccessorStream::compressed_bytes(compressed.stream).write(&mut ours)?,
            None => stream.write(&mut ours)?,
        }
        Ok(theirs == ours)
    }

    fn add_new(&mut self, stream: AccessorStream<'a>) -> Result<usize, WriteError> {
        let [component_type, count] = [json!(stream.component_type()), json!(stream.count())];
        let (kind, is_normalized) = (stream.kind(), stream.is_normalized());
        self.has_fewer_bits |= stream.needs_quantization();
        let compressed = if self.packing.is_compressed { stream.compressed()? } else { None };
        let view = match compressed {
            Some(compressed) => self.add_compressed(compressed),
            None => self.add_view(stream),
        };
        self.accessors.push(json!({
            "bufferView": view, "componentType": component_type, "count": count, "type": kind
        }));
        if is_normalized {
            let last = self.accessors.len() - 1;
            self.accessors[last]["normalized"] = json!(true);
        }
        Ok(self.accessors.len() - 1)
    }

    /// Adds a compressed view: the stream, and the view over its unpacked bytes.
    fn add_compressed(&mut self, compressed: CompressedStream) -> usize {
        let CompressedStream { stream, stride, count, is_index, target } = compressed;
        let at = self.n_bytes;
        let mut packed = json!({
            "buffer": 0, "byteOffset": at, "byteLength": stream.len(), "byteStride": stride, "count": count,
        });
        packed["mode"] = json!(if is_index { "TRIANGLES" } else { "ATTRIBUTES" });
        let n_unpacked = count * stride;
        // Buffer 1 has no bytes in the file. A view of it tells readers that know the extension
        // where the unpacked bytes belong, and its own extension where the packed ones are.
        let mut view = json!({ "buffer": 1, "byteOffset": self.n_unpacked, "byteLength": n_unpacked });
        if !is_index {
            view["byteStride"] = json!(stride);
        }
        view["target"] = json!(target);
        view["extensions"] = json!({ meshopt::NAMES[0]: packed });
        self.n_unpacked += (n_unpacked as u64).next_multiple_of(4);
        let stream = AccessorStream::compressed_bytes(stream);
        self.n_bytes += stream.n_padded();
        self.streams.push(stream);
        self.views.push(view);
        self.views.len() - 1
    }

    fn add_view(&mut self, stream: AccessorStream<'a>) -> usize {
        let mut view = json!({ "buffer": 0, "byteOffset": self.n_bytes, "byteLength": stream.n_bytes() });
        if let Some(target) = stream.target() {
            view["target"] = json!(target);
        }
        if let Some(stride) = stream.padded_stride() {
            view["byteStride"] = json!(stride);
        }
        self.views.push(view);
        self.n_bytes += stream.n_padded();
        self.streams.push(stream);
        self.views.len() - 1
    }

    /// A plain material.
    fn material(&mut self, open: bool) -> usize {
        let Self { materials, material, .. } = self;
        *material[usize::from(open)].get_or_insert_with(|| {
            materials.push(plain_material(open));
            materials.len() - 1
        })
    }

    /// The nodes of the scene whose parts were added.
    pub fn nodes(
        &self,
        scene: &Scene,
        levels: &node_list::NodeLevels<'_>,
    ) -> Result<node_list::NodeList, WriteError> {
        node_list::nodes(scene, &self.shown, levels)
    }

    /// The content of the JSON chunk. `certificate` becomes an extra, and so do the names of face groups,
    /// whose numbers are vertex attributes.
    pub fn json(
        &self,
        scene: &Scene,
        nodes: &node_list::NodeList,
        certificate: Option<&Value>,
    ) -> Map<String, Value> {
        let mut root = Map::new();
        let mut asset =
            json!({ "version": "2.0", "generator": concat!("Chordal ", env!("CARGO_PKG_VERSION")) });
        for (key, value) in &self.assets.about {
            asset[key] = value.clone();
        }
        let groups = Some(group_names(scene)).filter(|groups| !groups.is_empty()).map(Value::Object);
        for (key, value) in [("groups", groups), ("chordal", certificate.cloned())] {
            let Some(value) = value else { continue };
            // Extras that are not an object are replaced; they are rare.
            if !asset["extras"].is_object() {
                asset["extras"] = json!({});
            }
            asset["extras"][key] = value;
        }
        root.insert("asset".to_owned(), asset);
        root.insert("scene".to_owned(), json!(0));
        // An empty list of nodes is invalid in glTF; so are the empty lists below.
        let mut shown = self.assets.scene.clone();
        if !nodes.roots.is_empty() {
            shown.insert("nodes".to_owned(), json!(nodes.roots));
        }
        root.insert("scenes".to_owned(), json!([shown]));
        let mut buffers =
            if self.n_bytes == 0 { vec![] } else { vec![json!({ "byteLength": self.n_bytes })] };
        if self.n_unpacked > 0 {
            // It has no bytes: readers fill it by unpacking.
            let fallback = json!({ meshopt::NAMES[0]: { "fallback": true } });
            buffers.push(json!({ "byteLength": self.n_unpacked, "extensions": fallback }));
        }
        for (name, list) in [
            ("nodes", &nodes.list),
            ("meshes", &self.meshes),
            ("materials", &self.materials),
            ("textures", &self.assets.textures),
            ("samplers", &self.assets.samplers),
            ("images", &self.images),
            ("cameras", &self.assets.cameras),
            ("skins", &self.skins),
            ("animations", &self.animations),
            ("accessors", &self.accessors),
            ("bufferViews", &self.views),
            ("buffers", &buffers),
        ] {
            if !list.is_empty() {
                root.insert(name.to_owned(), json!(list));
            }
        }
        self.insert_extensions(&mut root, nodes);
        root.extend(self.assets.extras.clone().map(|extras| ("extras".to_owned(), extras)));
        root
    }

    /// The extensions of the file, and the names of all extensions that it uses, each once.
    fn insert_extensions(&self, root: &mut Map<String, Value>, nodes: &node_list::NodeList) {
        if !self.assets.extensions.is_empty() {
            root.insert("extensions".to_owned(), json!(self.assets.extensions));
        }
        let mut used = self.assets.used_extensions();
        nodes.list.iter().for_each(|node| collect_extensions(node, &mut used));
        self.meshes.iter().for_each(|mesh| collect_extensions(mesh, &mut used));
        let meshopt = (self.n_unpacked > 0).then(|| meshopt::NAMES[0].to_owned());
        let quantized = self.has_fewer_bits.then(|| QUANTIZATION.to_owned());
        let packing_extensions: Vec<String> = meshopt.into_iter().chain(quantized).collect();
        used.extend(packing_extensions.iter().cloned());
        used.sort_unstable();
        used.dedup();
        if used.is_empty() {
            return;
        }
        let mut required: Vec<&String> =
            self.assets.required_extensions.iter().filter(|name| used.contains(name)).collect();
        required
            .extend(packing_extensions.iter().filter(|name| !self.assets.required_extensions.contains(name)));
        if !required.is_empty() {
            root.insert("extensionsRequired".to_owned(), json!(required));
        }
        root.insert("extensionsUsed".to_owned(), json!(used));
    }
}

/// The names of the face groups that parts of the scene have, by kind. Material groups are named by their
/// materials.
fn group_names(scene: &Scene) -> Map<String, Value> {
    let is_used = |kind: &str| {
        let semantic = Semantic::Group(kind.to_owned());
        kind != MATERIAL && scene.parts.iter().any(|part| part.mesh.attribute(&semantic).is_some())
    };
    let used = scene.groups.iter().filter(|(kind, _)| is_used(kind));
    used.map(|(kind, names)| (kind.clone(), json!(names))).collect()
}
