//! The entry points: parses the lists of a document in the validator's order, then checks links and data.
use super::GltfLint;
use super::extensions::ExtensionHost;
use crate::glb::container::GltfContainer;
use crate::glb::json::JsonValue;
use crate::glb::model::GltfModel;

/// Parses a document. `None` if it is not a glTF 2.x whose content can be checked.
pub(in crate::glb) fn parse<'a>(
    lint: &mut GltfLint<'a>,
    root: &'a JsonValue,
    container: GltfContainer<'a>,
) -> Option<GltfModel<'a>> {
    let required = lint.texts(root, "extensionsRequired");
    if root.get("extensionsRequired").is_some() && root.get("extensionsUsed").is_none() {
        lint.issue_below("UNSATISFIED_DEPENDENCY", "extensionsRequired", "extensionsUsed is missing");
    }
    let used = lint.texts(root, "extensionsUsed");
    lint.declare(&used, &required);
    let asset = lint.object(root, "asset", true)?;
    lint.within("asset", |lint| asset_version(lint, asset))?;
    let mut model =
        GltfModel { extensions_used: used, extensions_required: required, ..GltfModel::default() };
    model.accessors = lint.each_object(root, "accessors", GltfLint::accessor);
    model.animations = lint.each_object(root, "animations", GltfLint::animation);
    model.buffers = lint.each_object(root, "buffers", GltfLint::buffer);
    if let Some(Some(first)) = model.buffers.first_mut() {
        lint.within("buffers", |lint| lint.within(0, |lint| lint.glb_buffer(first, container)));
    }
    model.views = lint.each_object(root, "bufferViews", GltfLint::view);
    lint.each_object(root, "cameras", GltfLint::camera);
    model.images = lint.each_object(root, "images", GltfLint::image);
    model.materials = lint.each_object(root, "materials", GltfLint::material);
    model.meshes = lint.each_object(root, "meshes", GltfLint::mesh);
    model.nodes = lint.each_object(root, "nodes", GltfLint::node);
    lint.each_object(root, "samplers", GltfLint::sampler);
    model.scenes = lint.each_object(root, "scenes", GltfLint::scene);
    model.scene = lint.reference(root, "scene", "scenes");
    model.skins = lint.each_object(root, "skins", GltfLint::skin);
    model.textures = lint.each_object(root, "textures", GltfLint::texture);
    lint.root_extensions(root);
    Some(model)
}

/// Checks the references between objects, and their data.
pub(in crate::glb) fn link<'a>(lint: &mut GltfLint<'a>, model: &mut GltfModel<'a>) {
    let mut uses = super::buffers::UseTable::from_model(model);
    lint.link_views(model);
    lint.link_accessors(model, &mut uses);
    lint.link_images(model, &mut uses);
    lint.link_meshes(model, &mut uses);
    lint.link_nodes(model);
    lint.link_skins(model, &mut uses);
    lint.link_animations(model, &mut uses);
    lint.check_buffers(model);
    lint.check_images(model);
    lint.check_elements(model, &uses);
    lint.check_influences(model);
    lint.link_textures(model);
}

impl<'a> GltfLint<'a> {
    /// Visits each object of a root list.
    fn each_object<T>(
        &mut self,
        root: &'a JsonValue,
        list: &'static str,
        look: impl Fn(&mut Self, &'a JsonValue) -> T,
    ) -> Vec<Option<T>> {
        let Some(items) = self.list(root, list) else { return Vec::new() };
        self.within(list, |lint| {
            let mut out = Vec::with_capacity(items.len());
            for (i, item) in items.iter().enumerate() {
                if matches!(item, JsonValue::Object(_)) {
                    out.push(Some(lint.within(i, |lint| look(lint, item))));
                } else {
                    lint.issue_below("TYPE_MISMATCH", i, "the item is no object");
                    out.push(None);
                }
            }
            out
        })
    }
}

/// Checks the version, which must be 2.x and at least the file's own minimum version.
fn asset_version<'a>(lint: &mut GltfLint<'a>, asset: &'a JsonValue) -> Option<()> {
    lint.text(asset, "copyright", false);
    lint.text(asset, "generator", false);
    let version = version_of(lint, asset, "version", true);
    let least = version_of(lint, asset, "minVersion", false);
    lint.extensions(asset, ExtensionHost::Other);
    if let (Some(version), Some(least)) = (version, least)
        && least > version
    {
        lint.issue_below(
            "ASSET_MIN_VERSION_GREATER_THAN_VERSION",
            "minVersion",
            "minVersion is above version",
        );
    }
    let (major, _) = version?;
    if major != 2 {
        lint.issue("UNKNOWN_ASSET_MAJOR_VERSION", Some("version".into()), || {
            format!("glTF {major} is unknown")
        });
        return None;
    }
    Some(())
}

fn version_of<'a>(
    lint: &mut GltfLint<'a>,
    asset: &'a JsonValue,
    key: &'a str,
    required: bool,
) -> Option<(u64, u64)> {
    let text = lint.text(asset, key, required)?;
    let digits = |part: &str| {
        if part.is_empty() || !part.bytes().all(|b| b.is_ascii_digit()) { None } else { part.parse().ok() }
    };
    let parsed = text.split_once('.').and_then(|(major, minor)| Some((digits(major)?, digits(minor)?)));
    if parsed.is_none() {
        lint.issue("PATTERN_MISMATCH", Some(key.into()), || format!("{text:?} is no version"));
    }
    parsed
}
