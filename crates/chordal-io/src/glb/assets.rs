//! Reads the data other than meshes and nodes into [`SceneAssets`].
use super::INSTANCING;
use super::accessor_rows::AccessorRows;
use super::draco::DRACO;
use super::face_kinds::FileFaceKinds;
use super::json::{JsonValue, members_without};
use super::leniency::ForgivenIssues;
use super::marks::read_marks;
use super::meshopt;
use super::model::{GltfModel, item};
use super::node_tree::NodeTree;
use super::packed_accessor::packed_accessor;
use super::report::GlbWarnings;
use crate::assets::{ImageContent, SceneAssets, SceneImage, VARIANTS};
use crate::side_file::{picture_type, picture_type_of_name};
use crate::{FileLocation, MATERIAL, Marks, ReadError, Scene};
use chordal::math::{greater, lesser};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Extensions of a file or a node that refer only to lists that are kept.
const KEPT_EXTENSIONS: [&str; 4] =
    ["KHR_lights_punctual", "KHR_node_visibility", "KHR_xmp_json_ld", VARIANTS];

/// Extensions of primitives that are kept, or that the reader of parts reports.
const KNOWN_OF_PRIMITIVES: [&str; 2] = [DRACO, VARIANTS];

/// The assets of a file.
pub(super) struct AssetReader<'a> {
    json: &'a JsonValue,
    model: &'a GltfModel<'a>,
    /// The number of bytes that may still be copied.
    left: u64,
    /// The data that is not kept, by name, each with its number of occurrences and the first pointer.
    dropped: BTreeMap<String, (u64, String)>,
    /// The accessors of instances, with the index of the node in the scene.
    instances: Vec<(usize, Map<String, Value>)>,
    report: GlbWarnings,
}

/// The data of a file's assets that parts need.
pub(super) struct PartAssets {
    /// By mesh and primitive of the file: the group of its faces.
    pub groups: Vec<Vec<usize>>,
    /// By part: the properties of its mesh other than name and primitives.
    pub properties: Vec<Map<String, Value>>,
    /// By part: its points and lines.
    pub marks: Vec<Vec<Marks>>,
    pub report: GlbWarnings,
}

impl<'a> AssetReader<'a> {
    /// A reader for a file of which at most `left` bytes may be copied.
    pub fn new(json: &'a JsonValue, model: &'a GltfModel<'a>, left: u64) -> Self {
        Self {
            json,
            model,
            left,
            dropped: BTreeMap::new(),
            instances: Vec::new(),
            report: GlbWarnings::default(),
        }
    }

    /// Reads all assets into the scene of a node tree, except those that a forgiven issue may concern.
    ///
    /// # Errors
    /// If the copied data exceeds the limit.
    pub fn read(mut self, tree: &mut NodeTree, forgiven: &ForgivenIssues) -> Result<PartAssets, ReadError> {
        let number_of = |node: usize| tree.number_of.get(node).copied().flatten();
        for i in 0..self.list("nodes").len() {
            let properties = self.node_properties(i);
            if let Some(at) = number_of(i) {
                tree.scene.nodes[at].properties = properties.into();
            }
        }
        *tree.scene.assets = self.assets(number_of, tree.has_cut_nodes)?;
        // After the nodes' own properties, whose other extensions they join.
        for (at, attributes) in std::mem::take(&mut self.instances) {
            let properties = &mut tree.scene.nodes[at].properties;
            let mut merged = (**properties).clone();
            merged.entry("extensions").or_insert_with(|| json!({}))[INSTANCING] =
                json!({ "attributes": attributes });
            *properties = merged.into();
        }
        let mut materials = self.values("materials");
        clamp_factors(&forgiven.factors, &mut materials);
        let FileFaceKinds { materials, kinds, groups, has_bare_faces } =
            FileFaceKinds::from_meshes(self.list("meshes"), materials);
        if !materials.is_empty() {
            let name = |material: &Value| material["name"].as_str().unwrap_or_default().to_owned();
            let names = std::iter::once(String::new()).chain(materials.iter().map(name)).collect();
            tree.scene.groups.insert(MATERIAL.to_owned(), names);
        }
        tree.scene.assets.materials = materials;
        tree.scene.assets.face_kinds = kinds;
        tree.scene.assets.keeps_bare_faces = has_bare_faces;
        let mut properties: Vec<_> = tree.meshes.iter().map(|mesh| self.mesh_properties(*mesh)).collect();
        let mut marks = Vec::with_capacity(tree.meshes.len());
        for mesh in &tree.meshes {
            marks.push(self.marks(*mesh)?);
        }
        let mut report = self.into_report();
        if !drop_unsound_assets(&mut tree.scene, &forgiven.unsound, &mut report) {
            properties.iter_mut().for_each(Map::clear);
        }
        let n_marks = marks.iter().map(Vec::len).sum::<usize>() as u64;
        if n_marks > 0 && !forgiven.unsound.is_empty() {
            let what = "points and lines that may have errors were left out";
            report.add_many("points-and-lines-skipped", n_marks, FileLocation::File, what);
            marks.iter_mut().for_each(Vec::clear);
        }
        Ok(PartAssets { groups, properties, marks, report })
    }

    fn list(&self, key: &str) -> &'a [JsonValue] {
        self.json.get(key).and_then(JsonValue::items).unwrap_or_default()
    }

    fn values(&self, key: &str) -> Vec<Value> {
        self.list(key).iter().map(JsonValue::to_value).collect()
    }

    /// Everything but materials; `number_of` is the new index of a kept node. If nodes were cut from their
    /// parents, joints may have no common root, so skins are left out.
    fn assets(
        &mut self,
        number_of: impl Fn(usize) -> Option<usize>,
        has_cut_nodes: bool,
    ) -> Result<SceneAssets, ReadError> {
        let mut assets = SceneAssets {
            textures: self.values("textures"),
            samplers: self.values("samplers"),
            cameras: self.values("cameras"),
            required_extensions: self
                .model
                .extensions_required
                .iter()
                .map(|name| (*name).to_owned())
                .collect(),
            ..SceneAssets::default()
        };
        assets.images = (0..self.list("images").len()).map(|i| self.image(i)).collect::<Result<_, _>>()?;
        // By accessor its copy, so that animations and skins that share one go on sharing it.
        let mut packed = vec![None; self.model.accessors.len()];
        self.add_animations(&mut assets, &mut packed, &number_of)?;
        if !has_cut_nodes {
            self.add_skins(&mut assets, &mut packed, &number_of)?;
        }
        self.add_instances(&mut assets, &mut packed, &number_of)?;
        let extensions = self.json.get("extensions").map_or(&[][..], JsonValue::entries);
        assets.extensions = self.kept_extensions(extensions, "/extensions");
        if let Some(asset) = self.json.get("asset") {
            assets.about = self.kept_members(asset, &["version", "minVersion", "generator"], "/asset");
            if let Some(Value::Object(extras)) = assets.about.get_mut("extras") {
                // The certificate applies to the file that was read.
                extras.shift_remove("chordal");
                if extras.is_empty() {
                    assets.about.shift_remove("extras");
                }
            }
        }
        assets.extras = self.json.get("extras").map(JsonValue::to_value);
        if let Some(shown) = self.shown_scene() {
            assets.scene =
                self.kept_members(&self.list("scenes")[shown], &["nodes"], &format!("/scenes/{shown}"));
        }
        Ok(assets)
    }

    /// The scene whose nodes are read.
    fn shown_scene(&self) -> Option<usize> {
        let n = self.list("scenes").len();
        (n > 0).then(|| self.model.scene.unwrap_or(0)).filter(|scene| *scene < n)
    }

    /// The members of an object except those in `left_out`, with the extensions that are kept.
    fn kept_members(&mut self, object: &JsonValue, left_out: &[&str], pointer: &str) -> Map<String, Value> {
        let mut members = members_without(object, left_out);
        members.shift_remove("extensions");
        let extensions = object.get("extensions").map_or(&[][..], JsonValue::entries);
        let extensions = self.kept_extensions(extensions, &format!("{pointer}/extensions"));
        if !extensions.is_empty() {
            members.insert("extensions".to_owned(), Value::Object(extensions));
        }
        members
    }

    /// The properties of a node other than name, children, mesh and matrix.
    fn node_properties(&mut self, i: usize) -> Map<String, Value> {
        let Some(node) = self.list("nodes").get(i) else { return Map::new() };
        let left_out = ["name", "children", "mesh", "matrix", "extensions"];
        let mut properties = members_without(node, &left_out);
        if !properties.contains_key("rotation") {
            // The matrix holds these exactly.
            properties.shift_remove("translation");
            properties.shift_remove("scale");
        }
        let extensions = node.get("extensions").map_or(&[][..], JsonValue::entries);
        if extensions.iter().any(|(name, _)| **name == *super::LOD) {
            drop_coverages(&mut properties);
        }
        let extensions = self.kept_extensions(extensions, &format!("/nodes/{i}/extensions"));
        if !extensions.is_empty() {
            properties.insert("extensions".to_owned(), Value::Object(extensions));
        }
        properties
    }

    /// The points and lines of a mesh.
    fn marks(&mut self, i: usize) -> Result<Vec<Marks>, ReadError> {
        let model = self.model;
        let Some(mesh) = item(&model.meshes, Some(i)) else { return Ok(Vec::new()) };
        let objects = self.list("meshes")[i].get("primitives").and_then(JsonValue::items).unwrap_or_default();
        let mut mesh_marks = Vec::new();
        for (p, (primitive, object)) in mesh.primitives.iter().zip(objects).enumerate() {
            if !primitive.is_marks() {
                continue;
            }
            let pointer = || format!("/meshes/{i}/primitives/{p}");
            let place = FileLocation::Pointer(pointer());
            let from = (object, self.list("accessors"));
            match read_marks(model, primitive, from, |bytes| self.charge(bytes, pointer))? {
                Some(marks) => {
                    let what = "points and lines are carried as they are: nothing measures them, and no bound covers them";
                    self.report.add("points-and-lines", place, what);
                    mesh_marks.push(marks);
                }
                None => {
                    let what = "points and lines without positions that can be read were skipped";
                    self.report.add("points-and-lines-skipped", place, what);
                }
            }
        }
        Ok(mesh_marks)
    }

    /// The properties of a mesh other than its name and primitives.
    fn mesh_properties(&self, i: usize) -> Map<String, Value> {
        let mesh = self.list("meshes").get(i);
        mesh.map(|mesh| members_without(mesh, &["name", "primitives", "extensions"])).unwrap_or_default()
    }

    fn count_dropped(&mut self, name: String, pointer: String) {
        self.dropped.entry(name).or_insert((0, pointer)).0 += 1;
    }

    /// Counts data that a scene cannot hold: other scenes, extensions of meshes, extras of accessors, views
    /// and buffers.
    fn count_what_no_scene_holds(&mut self) {
        let mut dropped = Vec::new();
        let extras = |value: &JsonValue| value.get("extras").is_some();
        let shown = self.shown_scene();
        for i in (0..self.list("scenes").len()).filter(|i| shown.is_some_and(|shown| shown != *i)) {
            dropped.push(("scenes beside the one that is shown".to_owned(), format!("/scenes/{i}")));
        }
        for list in ["accessors", "bufferViews", "buffers"] {
            for (i, _) in self.list(list).iter().enumerate().filter(|(_, object)| extras(object)) {
                dropped.push((format!("extras of {list}"), format!("/{list}/{i}/extras")));
            }
        }
        for (i, mesh) in self.list("meshes").iter().enumerate() {
            let primitives = mesh.get("primitives").and_then(JsonValue::items).unwrap_or_default();
            let mesh_object = std::iter::once((mesh, format!("/meshes/{i}")));
            let primitive_objects =
                primitives.iter().enumerate().map(|(p, one)| (one, format!("/meshes/{i}/primitives/{p}")));
            for (object, pointer) in mesh_object.chain(primitive_objects) {
                let extensions = object.get("extensions").map_or(&[][..], JsonValue::entries);
                for (name, _) in extensions.iter().filter(|(name, _)| !KNOWN_OF_PRIMITIVES.contains(&&**name))
                {
                    dropped.push((format!("extension {name}"), format!("{pointer}/extensions/{name}")));
                }
            }
        }
        dropped.into_iter().for_each(|(name, pointer)| self.count_dropped(name, pointer));
    }

    /// The warnings; one of them lists all data that was not kept.
    fn into_report(mut self) -> GlbWarnings {
        self.count_what_no_scene_holds();
        let Some((_, first)) = self.dropped.values().next() else { return self.report };
        let names: Vec<&str> = self.dropped.keys().map(String::as_str).collect();
        let what = format!("what these say was not kept: {}", names.join(", "));
        let count = self.dropped.values().map(|(count, _)| count).sum();
        self.report.add_many("extension-dropped", count, FileLocation::Pointer(first.clone()), what);
        self.report
    }

    fn kept_extensions(&mut self, extensions: &[(Box<str>, JsonValue)], pointer: &str) -> Map<String, Value> {
        let mut kept = Map::new();
        for (name, value) in extensions {
            if KEPT_EXTENSIONS.contains(&&**name) {
                kept.insert(name.to_string(), value.to_value());
            } else if ![super::LOD, super::INSTANCING].contains(&&**name) {
                self.count_dropped(format!("extension {name}"), format!("{pointer}/{name}"));
            }
        }
        kept
    }

    fn image(&mut self, i: usize) -> Result<SceneImage, ReadError> {
        let properties = members_without(&self.list("images")[i], &["bufferView", "uri", "mimeType"]);
        let mut image = SceneImage { properties, content: ImageContent::Uri(String::new()) };
        let Some(model_image) = item(&self.model.images, Some(i)) else { return Ok(image) };
        let bytes = model_image.data.as_deref().or_else(|| self.model.view_bytes(model_image.view));
        // A separate picture file may omit its type: then its first bytes or its name tell it.
        let beside = || bytes.and_then(picture_type).or_else(|| picture_type_of_name(model_image.uri?));
        let mime = model_image.mime.or(model_image.detected).or_else(beside);
        image.content = match bytes.zip(mime) {
            Some((bytes, mime)) => {
                self.charge(bytes.len() as u64, || format!("/images/{i}"))?;
                image.properties.insert("mimeType".to_owned(), json!(mime));
                ImageContent::Bytes(bytes.into())
            }
            None => {
                let uri = model_image.uri.unwrap_or_default();
                if let Some(mime) = model_image.mime {
                    image.properties.insert("mimeType".to_owned(), json!(mime));
                }
                if model_image.data.is_none() && bytes.is_none() {
                    let place = FileLocation::Pointer(format!("/images/{i}"));
                    let what = "pictures in other files were not opened: their names are kept";
                    self.report.add("picture-missing", place, what);
                } else if bytes.is_some() {
                    let place = FileLocation::Pointer(format!("/images/{i}"));
                    let what = "pictures of an unknown type were left behind: only their names are kept";
                    self.report.add("picture-unknown", place, what);
                }
                ImageContent::Uri(uri.to_owned())
            }
        };
        Ok(image)
    }

    fn charge(&mut self, bytes: u64, pointer: impl Fn() -> String) -> Result<(), ReadError> {
        let Some(left) = self.left.checked_sub(bytes) else {
            let what =
                format!("the data to keep exceeds the limits: {bytes} bytes more, {} are left", self.left);
            return Err(ReadError::new("too-large", FileLocation::Pointer(pointer()), what));
        };
        self.left = left;
        Ok(())
    }

    /// The skins, whose joints are nodes; none if some joints are not kept.
    fn add_skins(
        &mut self,
        assets: &mut SceneAssets,
        packed: &mut [Option<usize>],
        number_of: &impl Fn(usize) -> Option<usize>,
    ) -> Result<(), ReadError> {
        let mut skins = Vec::new();
        for skin in self.list("skins") {
            let node = |value: &JsonValue| number_of(usize::try_from(value.integer()?).ok()?);
            let joints = skin.get("joints").and_then(JsonValue::items).unwrap_or_default();
            let Some(joints) = joints.iter().map(node).collect::<Option<Vec<_>>>() else { return Ok(()) };
            let mut object = members_without(skin, &["joints", "skeleton", "inverseBindMatrices"]);
            object.insert("joints".to_owned(), json!(joints));
            if let Some(skeleton) = skin.get("skeleton").and_then(node) {
                object.insert("skeleton".to_owned(), json!(skeleton));
            }
            if let Some(matrices) = skin.get("inverseBindMatrices") {
                let at = matrices.integer().and_then(|at| usize::try_from(at).ok());
                let Some(at) = self.pack(at, packed, assets)? else { return Ok(()) };
                object.insert("inverseBindMatrices".to_owned(), json!(at));
            }
            skins.push(Value::Object(object));
        }
        assets.skins = skins;
        Ok(())
    }

    /// The attributes of instanced nodes; left out if data is missing.
    fn add_instances(
        &mut self,
        assets: &mut SceneAssets,
        packed: &mut [Option<usize>],
        number_of: &impl Fn(usize) -> Option<usize>,
    ) -> Result<(), ReadError> {
        for (i, node) in self.model.nodes.iter().enumerate() {
            let instances = node.as_ref().and_then(|node| Some((node.mesh?, node.instances()?)));
            let (Some((_, instances)), Some(at)) = (instances, number_of(i)) else { continue };
            let mut attributes = Map::new();
            for (name, accessor) in instances {
                if let Some(index) = self.pack(*accessor, packed, assets)? {
                    attributes.insert((*name).to_owned(), json!(index));
                }
            }
            if !attributes.is_empty() && attributes.len() == instances.len() {
                self.instances.push((at, attributes));
            }
        }
        Ok(())
    }

    /// The animations of nodes' transforms and weights; other animations are counted.
    fn add_animations(
        &mut self,
        assets: &mut SceneAssets,
        packed: &mut [Option<usize>],
        number_of: &impl Fn(usize) -> Option<usize>,
    ) -> Result<(), ReadError> {
        for (i, animation) in self.list("animations").iter().enumerate() {
            let mut object = members_without(animation, &["channels", "samplers"]);
            let mut samplers: Vec<Value> = animation
                .get("samplers")
                .and_then(JsonValue::items)
                .unwrap_or_default()
                .iter()
                .map(JsonValue::to_value)
                .collect();
            let mut channels = Vec::new();
            for channel in animation.get("channels").and_then(JsonValue::items).unwrap_or_default() {
                let target = channel.get("target");
                let path = target.and_then(|target| target.get("path")).and_then(JsonValue::text);
                let node = target.and_then(|target| target.get("node")).and_then(JsonValue::integer);
                let node = node.and_then(|node| number_of(usize::try_from(node).ok()?));
                match (path, node) {
                    (Some("translation" | "rotation" | "scale" | "weights"), Some(node)) => {
                        let mut channel = channel.to_value();
                        channel["target"]["node"] = json!(node);
                        channels.push(channel);
                    }
                    _ => {
                        let place = FileLocation::Pointer(format!("/animations/{i}/channels"));
                        let what = "animations of anything but a node's transform and weights were not kept";
                        self.report.add("animations-dropped", place, what);
                    }
                }
            }
            if channels.is_empty() || !self.pack_samplers(&mut samplers, packed, assets)? {
                continue;
            }
            object.insert("channels".to_owned(), json!(channels));
            object.insert("samplers".to_owned(), json!(samplers));
            assets.animations.push(Value::Object(object));
        }
        Ok(())
    }

    /// Copies the data of samplers, and renumbers it. False if some is missing.
    fn pack_samplers(
        &mut self,
        samplers: &mut [Value],
        packed: &mut [Option<usize>],
        assets: &mut SceneAssets,
    ) -> Result<bool, ReadError> {
        for sampler in samplers {
            for key in ["input", "output"] {
                let accessor =
                    sampler.get(key).and_then(Value::as_u64).and_then(|at| usize::try_from(at).ok());
                let Some(at) = self.pack(accessor, packed, assets)? else { return Ok(false) };
                sampler[key] = json!(at);
            }
        }
        Ok(true)
    }

    /// Copies the data of an accessor, once, and returns its index; `None` if some is missing.
    fn pack(
        &mut self,
        accessor: Option<usize>,
        packed: &mut [Option<usize>],
        assets: &mut SceneAssets,
    ) -> Result<Option<usize>, ReadError> {
        let Some((accessor, slot)) = accessor.and_then(|at| Some((at, packed.get_mut(at)?))) else {
            return Ok(None);
        };
        if slot.is_none() {
            // Rows without bytes are zeros, which move nothing.
            let rows = AccessorRows::new(self.model, accessor).ok().filter(AccessorRows::has_data);
            let Some(rows) = rows else { return Ok(None) };
            self.charge(rows.n_bytes(), || format!("/accessors/{accessor}"))?;
            // Times must have bounds.
            let has_bounds = rows.format.kind.n_components() == 1;
            let object = self.list("accessors").get(accessor);
            assets.accessors.push(packed_accessor(object, &rows, has_bounds));
            *slot = Some(assets.accessors.len() - 1);
        }
        Ok(*slot)
    }
}

/// Removes the screen coverages of coarser levels, which are not read.
fn drop_coverages(properties: &mut Map<String, Value>) {
    let Some(extras) = properties.get_mut("extras").and_then(Value::as_object_mut) else { return };
    if extras.shift_remove("MSFT_screencoverage").is_some() && extras.is_empty() {
        properties.shift_remove("extras");
    }
}

/// Clamps factors of materials to their ranges.
fn clamp_factors(factors: &[(usize, &str)], materials: &mut [Value]) {
    for (material, pointer) in factors {
        let value = materials.get_mut(*material).and_then(|value| value.pointer_mut(pointer));
        // One issue covers all components of a list.
        match value {
            Some(Value::Array(list)) => list.iter_mut().for_each(clamp),
            Some(value) => clamp(value),
            None => {}
        }
    }
}

/// Clamps a number to the range of a factor.
fn clamp(value: &mut Value) {
    if let Some(x) = value.as_f64().filter(|x| !(0.0..=1.0).contains(x)) {
        *value = json!(lesser(greater(x, 0.0), 1.0));
    }
}

/// Removes the assets that a forgiven issue may concern, so that the written file is valid. Returns whether
/// the properties of nodes and meshes can stay.
fn drop_unsound_assets(scene: &mut Scene, codes: &[&str], report: &mut GlbWarnings) -> bool {
    if codes.is_empty() {
        return true;
    }
    let is_about_data = |code: &&str| {
        ["ACCESSOR_", "BUFFER_", "GLB_", meshopt::BROKEN_STREAM].iter().any(|kind| code.starts_with(kind))
            && !code.contains("ANIMATION")
    };
    let keeps_bare_faces = scene.assets.keeps_bare_faces;
    let mut kept = Box::new(SceneAssets { keeps_bare_faces, ..SceneAssets::default() });
    let are_sound = codes.iter().all(is_about_data);
    if are_sound {
        kept.clone_from(&scene.assets);
        kept.animations.clear();
        kept.skins.clear();
        kept.accessors.clear();
    } else {
        scene.nodes.iter_mut().for_each(|node| node.properties.clear());
        scene.groups.remove(MATERIAL);
    }
    if kept != scene.assets {
        let what = "materials, cameras, lights and animations that may have errors were left out";
        report.add("assets-dropped", FileLocation::File, what);
        scene.assets = kept;
    }
    are_sound
}
