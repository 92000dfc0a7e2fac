//! The document: its lists, in the order in which the validator looks at them.
use super::Lint;
use super::extensions::At;
use crate::glb::json::Json;
use crate::glb::model::Model;

/// Parses a document; `bin` is the BIN chunk. `None` when it is no glTF 2.x that could be looked into.
pub(in crate::glb) fn parse<'a>(
    lint: &mut Lint<'a>,
    root: &'a Json,
    bin: Option<&'a [u8]>,
) -> Option<Model<'a>> {
    let required = lint.texts(root, "extensionsRequired");
    if root.get("extensionsRequired").is_some() && root.get("extensionsUsed").is_none() {
        lint.at("UNSATISFIED_DEPENDENCY", "extensionsRequired", "extensionsUsed is missing");
    }
    let used = lint.texts(root, "extensionsUsed");
    lint.declare(&used, &required);
    let asset = lint.object(root, "asset", true)?;
    lint.within("asset", |lint| asset_version(lint, asset))?;
    let mut model = Model { extensions_used: used, extensions_required: required, ..Model::default() };
    model.accessors = lint.each(root, "accessors", Lint::accessor);
    model.animations = lint.each(root, "animations", Lint::animation);
    model.buffers = lint.each(root, "buffers", Lint::buffer);
    if let Some(Some(first)) = model.buffers.first_mut() {
        lint.within("buffers", |lint| lint.within(0, |lint| lint.glb_buffer(first, bin)));
    }
    model.views = lint.each(root, "bufferViews", Lint::view);
    lint.each(root, "cameras", Lint::camera);
    model.images = lint.each(root, "images", Lint::image);
    model.materials = lint.each(root, "materials", Lint::material);
    model.meshes = lint.each(root, "meshes", Lint::mesh);
    model.nodes = lint.each(root, "nodes", Lint::node);
    lint.each(root, "samplers", Lint::sampler);
    model.scenes = lint.each(root, "scenes", Lint::scene);
    model.scene = lint.reference(root, "scene", "scenes");
    model.skins = lint.each(root, "skins", Lint::skin);
    model.textures = lint.each(root, "textures", Lint::texture);
    lint.root_extensions(root);
    Some(model)
}

/// Checks how the objects refer to one another, and what their data say.
pub(in crate::glb) fn link<'a>(lint: &mut Lint<'a>, model: &mut Model<'a>) {
    let mut uses = super::buffers::Uses::of(model);
    lint.link_views(model);
    lint.link_accessors(model, &mut uses);
    lint.link_images(model, &mut uses);
    lint.link_meshes(model, &mut uses);
    lint.link_nodes(model);
    lint.link_skins(model, &mut uses);
    lint.link_animations(model, &mut uses);
    lint.look_at_buffers(model);
    lint.look_at_images(model);
    lint.look_at_elements(model, &uses);
    lint.look_at_influences(model);
    lint.link_textures(model);
}

impl<'a> Lint<'a> {
    /// Looks at each object of a root list.
    fn each<T>(
        &mut self,
        root: &'a Json,
        list: &'static str,
        look: impl Fn(&mut Self, &'a Json) -> T,
    ) -> Vec<Option<T>> {
        let Some(items) = self.list(root, list) else { return Vec::new() };
        self.within(list, |lint| {
            let mut out = Vec::with_capacity(items.len());
            for (i, item) in items.iter().enumerate() {
                if matches!(item, Json::Object(_)) {
                    out.push(Some(lint.within(i, |lint| look(lint, item))));
                } else {
                    lint.at("TYPE_MISMATCH", i, "the item is no object");
                    out.push(None);
                }
            }
            out
        })
    }
}

/// The version, which has to be 2.x and not below the least one that the file asks for.
fn asset_version<'a>(lint: &mut Lint<'a>, asset: &'a Json) -> Option<()> {
    lint.text(asset, "copyright", false);
    lint.text(asset, "generator", false);
    let version = version_of(lint, asset, "version", true);
    let least = version_of(lint, asset, "minVersion", false);
    lint.extensions(asset, At::Other);
    if let (Some(version), Some(least)) = (version, least)
        && least > version
    {
        lint.at("ASSET_MIN_VERSION_GREATER_THAN_VERSION", "minVersion", "minVersion is above version");
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

fn version_of<'a>(lint: &mut Lint<'a>, asset: &'a Json, key: &'a str, required: bool) -> Option<(u64, u64)> {
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
