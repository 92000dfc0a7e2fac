//! `AttributePlan`: the attributes that the part of a mesh gets, decided before any data is read.
use super::format::AccessorType;
use super::model::{GltfMesh, GltfModel, item};
use super::skin_plan::{CommonTarget, SkinPlan, common_targets, has_width, morph_semantic};
use chordal::explicit::Semantic;
use std::collections::BTreeMap;

/// The attributes of a part, in the order in which the file first mentions them.
#[derive(Default)]
pub(super) struct AttributePlan<'m> {
    pub streams: Vec<PlannedAttribute<'m>>,
    /// The joint weights, stored in the last streams.
    pub skin: SkinPlan,
}

/// The source of an attribute's values.
pub(super) enum StreamSource<'m> {
    /// An attribute of the primitive.
    Attribute(&'m str),
    /// An attribute of a morph target, with the target's index.
    Target(usize, &'m str),
    /// Joints and their weights.
    Joints,
}

/// An attribute that a part gets.
pub(super) struct PlannedAttribute<'m> {
    pub source: StreamSource<'m>,
    pub semantic: Semantic,
    pub width: usize,
}

/// Texture and colour sets below this number are kept even if only some primitives have them. Chosen: larger
/// values let sets of few primitives take memory for all vertices.
const COMMON_SETS: u32 = 8;

impl<'m> AttributePlan<'m> {
    /// Plans the attributes for the primitives with triangles. Common attributes are kept if any primitive
    /// has them, others only if every primitive does, so that a part takes no more than a few times the
    /// memory of its primitives.
    pub fn from_mesh(model: &GltfModel<'_>, mesh: &'m GltfMesh<'_>) -> Self {
        let mut usage: BTreeMap<&str, (usize, usize, usize)> = BTreeMap::new();
        // In the order of the file, which the map does not keep.
        let mut order = Vec::new();
        let mut n_drawn = 0;
        for primitive in mesh.primitives.iter().filter(|primitive| primitive.is_drawn()) {
            n_drawn += 1;
            for (name, accessor) in &primitive.attributes {
                let width = item(&model.accessors, *accessor)
                    .and_then(|a| a.kind)
                    .map_or(0, AccessorType::n_components);
                let (count, first, widest) = usage.entry(*name).or_insert_with(|| {
                    order.push(*name);
                    (0, width, 0)
                });
                *count += 1;
                *first = if *first == 0 { width } else { *first };
                *widest = width.max(*widest);
            }
        }
        let mut streams = Vec::new();
        for name in order {
            let Some((semantic, (count, first, widest))) = semantic_of(name).zip(usage.get(name).copied())
            else {
                continue;
            };
            let (is_common, width) = match semantic {
                Semantic::Normal => (true, 3),
                Semantic::Tangent => (true, 4),
                Semantic::TexCoord(set) => (set < COMMON_SETS, 2),
                // Four numbers if any primitive has alpha.
                Semantic::Color(set) => (set < COMMON_SETS, if widest == 4 { 4 } else { 3 }),
                Semantic::Group(_) | Semantic::Custom(_) | Semantic::Blended(_) => (false, first),
            };
            if width > 0 && (is_common || count == n_drawn) {
                streams.push(PlannedAttribute { source: StreamSource::Attribute(name), semantic, width });
            }
        }
        for CommonTarget { target, name, accessor } in common_targets(mesh) {
            let kind = item(&model.accessors, accessor).and_then(|accessor| accessor.kind);
            let width = kind.map_or(0, AccessorType::n_components);
            if width > 0 && has_width(name, width) {
                let (source, semantic) = (StreamSource::Target(target, name), morph_semantic(target, name));
                streams.push(PlannedAttribute { source, semantic, width });
            }
        }
        Self { streams, skin: SkinPlan::default() }
    }

    /// Adds the joint weights.
    pub fn add_skin(&mut self, skin: SkinPlan) {
        let planned = |(semantic, width)| PlannedAttribute { source: StreamSource::Joints, semantic, width };
        self.streams.extend(skin.attributes().map(planned));
        self.skin = skin;
    }
}

impl PlannedAttribute<'_> {
    /// The value for vertices without the attribute: white, or zeros.
    pub fn default_value(&self) -> f64 {
        if matches!(self.semantic, Semantic::Color(_)) { 1.0 } else { 0.0 }
    }

    /// Whether rows of `width` numbers are accepted.
    pub fn accepts_width(&self, width: usize) -> bool {
        width == self.width || (matches!(self.semantic, Semantic::Color(_)) && width == 3)
    }
}

/// The semantic of an attribute; `None` for positions, and for attributes that only skins use.
fn semantic_of(name: &str) -> Option<Semantic> {
    let set = |family: &str| name.strip_prefix(family)?.parse::<u32>().ok();
    match name {
        "POSITION" => None,
        "NORMAL" => Some(Semantic::Normal),
        "TANGENT" => Some(Semantic::Tangent),
        _ if is_skinning(name) => None,
        _ => Some(
            set("TEXCOORD_")
                .map(Semantic::TexCoord)
                .or_else(|| set("COLOR_").map(Semantic::Color))
                .unwrap_or_else(|| Semantic::Custom(name.to_owned())),
        ),
    }
}

/// Whether only skins use an attribute.
pub(super) fn is_skinning(name: &str) -> bool {
    name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_")
}
