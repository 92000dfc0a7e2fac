//! `SceneAssets`: the data of a scene other than meshes and nodes: materials with their textures, cameras,
//! lights, animations, skins.
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The data of a scene other than meshes and nodes, as glTF describes it: each list holds glTF's objects,
/// which refer to each other by index. It is passed from a reader to a writer, and nothing in between
/// interprets it.
///
/// A face attribute [`Semantic::Group`](chordal::explicit::Semantic::Group) of the kind [`MATERIAL`] names
/// materials: number n is `materials[n - 1]`, and 0 is none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneAssets {
    /// The materials, which refer to textures.
    pub materials: Vec<Value>,
    /// The textures, each an image with a sampler.
    pub textures: Vec<Value>,
    /// How textures are filtered and repeated.
    pub samplers: Vec<Value>,
    /// The images.
    pub images: Vec<SceneImage>,
    /// The cameras, which nodes refer to.
    pub cameras: Vec<Value>,
    /// The animations of nodes, which refer to `accessors`.
    pub animations: Vec<Value>,
    /// The skins, which nodes refer to: joints, and `accessors` with their matrices.
    pub skins: Vec<Value>,
    /// The numeric data of animations and skins.
    pub accessors: Vec<PackedAccessor>,
    /// Extensions of the file as a whole, such as lights, which nodes refer to.
    pub extensions: Map<String, Value>,
    /// Names of the extensions that a reader must support to interpret the file correctly.
    pub required_extensions: Vec<String>,
    /// Metadata of the file: its copyright, and extras.
    pub about: Map<String, Value>,
    /// Metadata of the scene that is shown: its name, and extras.
    pub scene: Map<String, Value>,
    /// The extras of the file as a whole.
    pub extras: Option<Value>,
    /// Properties of primitives other than their triangles, by the index of the material of their faces.
    /// Duplicates of materials come after all others.
    pub face_kinds: BTreeMap<usize, FaceKind>,
    /// Whether faces without a material stay without one in glTF, as in the source file. If not, such faces
    /// get a plain material: glTF's default is a metal, which viewers without an environment show black.
    pub keeps_bare_faces: bool,
}

/// Properties of a mesh's primitives other than their triangles and material: extras, and the materials that
/// they have in variants of the scene (`KHR_materials_variants`).
///
/// Faces of one material whose primitives have different properties are in different groups. The groups after
/// the first use duplicates of the material.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceKind {
    /// The index of the material: that of the kind itself, or of the original if this one is a duplicate.
    pub material: usize,
    /// Extras and extensions.
    pub properties: Map<String, Value>,
}

impl FaceKind {
    /// The indices of the materials that it refers to: its own, and those of variants.
    pub(crate) fn materials(&self) -> Vec<usize> {
        let mut materials = vec![self.material];
        each_variant_material(&mut self.properties.clone(), &mut |at| {
            materials.extend(at.as_u64().and_then(|at| usize::try_from(at).ok()));
        });
        materials
    }
}

/// The extension by which a scene has several variants, each with its own materials.
pub(crate) const VARIANTS: &str = "KHR_materials_variants";

/// Visits every material index in the properties of a primitive.
pub(crate) fn each_variant_material(properties: &mut Map<String, Value>, visit: &mut impl FnMut(&mut Value)) {
    let extension = properties.get_mut("extensions").and_then(|extensions| extensions.get_mut(VARIANTS));
    let mappings = extension.and_then(|variants| variants.get_mut("mappings")).and_then(Value::as_array_mut);
    mappings.into_iter().flatten().filter_map(|mapping| mapping.get_mut("material")).for_each(visit);
}

/// The kind of the face groups that name materials.
pub const MATERIAL: &str = "material";

/// An image of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneImage {
    /// Its name, media type and extras.
    pub properties: Map<String, Value>,
    /// Where its pixels are stored.
    pub content: ImageContent,
}

/// Where the pixels of an image are stored.
#[derive(Clone, Debug, PartialEq)]
pub enum ImageContent {
    /// A complete picture file.
    Bytes(Arc<[u8]>),
    /// The URI of another file, which was not opened.
    Uri(String),
}

/// Rows of numbers without gaps.
#[derive(Clone, Debug, PartialEq)]
pub struct PackedAccessor {
    /// Type, component type, count, bounds.
    pub properties: Map<String, Value>,
    /// The rows without gaps, little-endian.
    pub bytes: Arc<[u8]>,
}

impl SceneAssets {
    /// The materials and everything that they refer to: the part of the assets that also applies to meshes
    /// that other nodes show.
    #[must_use]
    pub fn materials_only(&self) -> Self {
        Self {
            materials: self.materials.clone(),
            textures: self.textures.clone(),
            samplers: self.samplers.clone(),
            images: self.images.clone(),
            required_extensions: self.required_extensions.clone(),
            about: self.about.iter().filter(|(key, _)| *key != "extensions").map(pair).collect(),
            face_kinds: self.face_kinds.clone(),
            keeps_bare_faces: self.keeps_bare_faces,
            extensions: self.extensions.iter().filter(|(key, _)| *key == VARIANTS).map(pair).collect(),
            ..Self::default()
        }
    }

    /// The names of the assets that [`Self::materials_only`] leaves out.
    #[must_use]
    pub fn beside_materials(&self) -> Vec<&str> {
        let lists = [(&self.cameras, "cameras"), (&self.animations, "animations"), (&self.skins, "skins")];
        let names = lists.into_iter().filter(|(list, _)| !list.is_empty()).map(|(_, name)| name);
        let of_scene = !self.scene.is_empty() && (self.scene.len() > 1 || !self.scene.contains_key("name"));
        let extras = [(of_scene, "extras of the scene"), (self.extras.is_some(), "extras of the file")];
        let extensions = self.extensions.keys().map(String::as_str).filter(|name| *name != VARIANTS);
        let extras = extras.into_iter().filter(|(is_there, _)| *is_there).map(|(_, name)| name);
        names.chain(extensions).chain(extras).collect()
    }

    /// The materials of the file, without duplicates.
    pub(crate) fn own_materials(&self) -> Vec<Value> {
        let is_own = |i: usize| self.face_kinds.get(&i).is_none_or(|kind| kind.material == i);
        let originals = self.materials.iter().enumerate().filter(|(i, _)| is_own(*i));
        originals.map(|(_, material)| material.clone()).collect()
    }

    /// The names of the extensions that the assets use, in order.
    pub(crate) fn used_extensions(&self) -> Vec<String> {
        let mut names = Vec::new();
        let Self { materials, textures, samplers, cameras, animations, skins, .. } = self;
        let lists = [materials, textures, samplers, cameras, animations, skins];
        lists.into_iter().flatten().for_each(|object| collect_extensions(object, &mut names));
        self.images.iter().for_each(|image| collect_of_members(&image.properties, &mut names));
        let kinds = self.face_kinds.values().map(|kind| &kind.properties);
        let others = [&self.about, &self.scene].into_iter().chain(kinds);
        others.for_each(|members| collect_of_members(members, &mut names));
        names.extend(self.extensions.keys().cloned());
        let is_webp =
            |image: &SceneImage| image.properties.get("mimeType").is_some_and(|mime| mime == "image/webp");
        if self.images.iter().any(is_webp) {
            names.push("EXT_texture_webp".to_owned());
        }
        names
    }
}

fn pair((key, value): (&String, &Value)) -> (String, Value) {
    (key.clone(), value.clone())
}

/// Adds the names of the extensions of an object and of its members. Extras are application data and are
/// skipped.
pub(crate) fn collect_extensions(value: &Value, names: &mut Vec<String>) {
    match value {
        Value::Object(members) => collect_of_members(members, names),
        Value::Array(items) => items.iter().for_each(|item| collect_extensions(item, names)),
        _ => {}
    }
}

pub(crate) fn collect_of_members(members: &Map<String, Value>, names: &mut Vec<String>) {
    for (key, value) in members.iter().filter(|(key, _)| *key != "extras") {
        if let (true, Value::Object(extensions)) = (key == "extensions", value) {
            names.extend(extensions.keys().cloned());
        }
        collect_extensions(value, names);
    }
}

/// The material that the writer gives to meshes without one: glTF's default is a metal, which viewers without
/// an environment show black. `open`: the back sides of triangles are visible.
#[must_use]
pub fn plain_material(open: bool) -> Value {
    let mut plain = json!({ "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 0.5 } });
    if open {
        plain["doubleSided"] = json!(true);
    }
    plain
}
