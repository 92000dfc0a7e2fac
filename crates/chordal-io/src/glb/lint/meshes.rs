//! Rules for meshes and their primitives.
use super::buffers::{AccessorConstraint, AccessorUse, BufferViewUse, UseTable};
use super::extensions::ExtensionHost;
use super::{ANY, GltfLint, IntegerRule, PointerToken};
use crate::glb::draco::DRACO;
use crate::glb::format::{AccessorFormat, AccessorType, ComponentType};
use crate::glb::json::JsonValue;
use crate::glb::model::{
    GltfAccessor, GltfAttributes, GltfDracoStream, GltfMesh, GltfModel, GltfPrimitive, item,
};
use AccessorType::{Scalar, Vec2, Vec3, Vec4};
use ComponentType::{F32, I8, I16, U8, U16, U32};
use std::collections::{BTreeMap, BTreeSet};

const FLOAT3: AccessorFormat = AccessorFormat::plain(Vec3, F32);

/// The allowed formats of indices.
const INDICES: [AccessorFormat; 3] = [
    AccessorFormat::plain(Scalar, U8),
    AccessorFormat::plain(Scalar, U16),
    AccessorFormat::plain(Scalar, U32),
];

/// The numbered attributes of a primitive: their count, and the highest number.
#[derive(Default)]
struct SetIndices {
    count: u64,
    highest: Option<u64>,
}

impl<'a> GltfLint<'a> {
    pub(super) fn mesh(&mut self, map: &'a JsonValue) -> GltfMesh<'a> {
        let weights = self.numbers(map, "weights", 0, ANY);
        let items = self.objects(map, "primitives").unwrap_or_default();
        let mut primitives = Vec::with_capacity(items.len());
        let mut n_targets = None;
        for (i, item) in items.iter().enumerate() {
            self.within("primitives", |lint| {
                lint.within(i, |lint| {
                    let primitive = lint.primitive(item);
                    let n = primitive.targets.as_ref().map_or(0, Vec::len);
                    if *n_targets.get_or_insert(n) != n {
                        let what = "primitives have different numbers of morph targets";
                        lint.issue_here("MESH_PRIMITIVES_UNEQUAL_TARGETS_COUNT", what);
                    }
                    primitives.push(primitive);
                });
            });
        }
        if let (Some(weights), Some(n)) = (&weights, n_targets)
            && weights.len() != n
        {
            let what = format!("{} weights for {n} morph targets", weights.len());
            self.issue("MESH_INVALID_WEIGHTS_COUNT", Some("weights".into()), || what);
        }
        let name = self.name(map);
        self.extensions(map, ExtensionHost::Other);
        GltfMesh { name, primitives }
    }

    fn primitive(&mut self, map: &'a JsonValue) -> GltfPrimitive<'a> {
        let mode = self.integer(map, "mode", IntegerRule { max: Some(6), ..IntegerRule::default() }).or(4);
        let indices = self.index(map, "indices", false);
        let material = self.index(map, "material", false);
        let attributes = self.attributes(map);
        let counts = self.within("attributes", |lint| lint.attribute_names(&attributes));
        let targets = self.targets(map);
        let extensions = self.extensions(map, ExtensionHost::Primitive);
        let mut variants = Vec::new();
        self.each_extension(extensions, |lint, _, value| lint.variants(value, &mut variants));
        let draco = map.get("extensions").and_then(|extensions| extensions.get(DRACO));
        let draco =
            draco.map(|value| self.within("extensions", |lint| lint.within(DRACO, |lint| lint.draco(value))));
        let [n_joints, n_texcoords] = counts;
        GltfPrimitive { attributes, indices, material, mode, targets, variants, n_joints, n_texcoords, draco }
    }

    /// The stream that compresses a primitive.
    fn draco(&mut self, map: &'a JsonValue) -> GltfDracoStream<'a> {
        let view = self.index(map, "bufferView", true);
        let view = view.filter(|view| self.resolved("bufferViews", *view, "bufferView".into()));
        let named = self.object(map, "attributes", true);
        let named = named.map(|value| self.within("attributes", |lint| lint.named_accessors(value)));
        let id = |id: Option<usize>| id.and_then(|id| u32::try_from(id).ok());
        let attributes = named.unwrap_or_default().into_iter().map(|(name, value)| (name, id(value)));
        GltfDracoStream { view, attributes: attributes.collect() }
    }

    fn attributes(&mut self, map: &'a JsonValue) -> GltfAttributes<'a> {
        let Some(all) = self.object(map, "attributes", true) else { return Vec::new() };
        if all.entries().is_empty() {
            self.issue_below("EMPTY_ENTITY", "attributes", "no attribute");
        }
        self.within("attributes", |lint| lint.named_accessors(all))
    }

    fn named_accessors(&mut self, attributes: &'a JsonValue) -> GltfAttributes<'a> {
        let mut out = Vec::with_capacity(attributes.entries().len());
        for (name, value) in attributes.entries() {
            let index = value.integer().and_then(|i| usize::try_from(i).ok());
            if index.is_none() {
                self.issue_below("INVALID_INDEX", &**name, "the value is no index");
            }
            out.push((&**name, index));
        }
        out
    }

    /// Checks attribute names. Returns the numbers of joint sets and of texture coordinate sets.
    fn attribute_names(&mut self, attributes: &GltfAttributes<'a>) -> [u64; 2] {
        const FAMILIES: [&str; 4] = ["COLOR", "JOINTS", "TEXCOORD", "WEIGHTS"];
        let mut sets: [SetIndices; 4] = Default::default();
        for (name, _) in attributes {
            if name.starts_with('_') || ["POSITION", "NORMAL", "TANGENT"].contains(name) {
                continue;
            }
            let numbered = name.split_once('_').and_then(|(family, number)| {
                Some((FAMILIES.iter().position(|f| *f == family)?, set_number(number)?))
            });
            match numbered {
                Some((family, number)) => {
                    sets[family].count += 1;
                    sets[family].highest = sets[family].highest.max(Some(number));
                }
                None => self.issue_below("MESH_PRIMITIVE_INVALID_ATTRIBUTE", *name, "the name is unknown"),
            }
        }
        let counts = [0, 1, 2, 3].map(|i| {
            // Without gaps, the highest number is one less than the count.
            let expected = sets[i].highest.map_or(0, |n| n.saturating_add(1));
            if expected != sets[i].count {
                self.issue("MESH_PRIMITIVE_INDEXED_SEMANTIC_CONTINUITY", None, || {
                    format!("the numbers after {} have gaps", FAMILIES[i])
                });
                return 0;
            }
            expected
        });
        if counts[1] != counts[3] {
            let what = format!("{} joint sets and {} weight sets", counts[1], counts[3]);
            self.issue("MESH_PRIMITIVE_JOINTS_WEIGHTS_MISMATCH", None, || what);
            return [0, counts[2]];
        }
        [counts[1], counts[2]]
    }

    fn targets(&mut self, map: &'a JsonValue) -> Option<Vec<GltfAttributes<'a>>> {
        let items = self.list(map, "targets")?;
        self.within("targets", |lint| {
            let mut out = Vec::with_capacity(items.len());
            for (i, item) in items.iter().enumerate() {
                match item {
                    JsonValue::Object(entries) if entries.is_empty() => {
                        lint.issue_below("EMPTY_ENTITY", i, "no attribute")
                    }
                    JsonValue::Object(_) => out.push(lint.within(i, |lint| {
                        let target = lint.named_accessors(item);
                        for (name, _) in &target {
                            if !is_target_name(name) {
                                lint.issue_below(
                                    "MESH_PRIMITIVE_INVALID_ATTRIBUTE",
                                    *name,
                                    "the name is unknown",
                                );
                            }
                        }
                        target
                    })),
                    _ => lint.issue_here("ARRAY_TYPE_MISMATCH", "an item is no object"),
                }
            }
            (out.len() == items.len()).then_some(out)
        })
    }

    fn variants(&mut self, map: &'a JsonValue, out: &mut Vec<(usize, String)>) {
        let mut seen = BTreeSet::new();
        for (i, mapping) in self.objects(map, "mappings").unwrap_or_default().iter().enumerate() {
            self.within_path(&["mappings".into(), i.into()], |lint| {
                lint.extensions(mapping, ExtensionHost::Other);
                lint.name(mapping);
                let variants = lint.indices(mapping, "variants", true).unwrap_or_default();
                lint.within("variants", |lint| {
                    for (k, index) in variants.into_iter().enumerate().filter(|(_, index)| index.is_some()) {
                        lint.extension_reference(["KHR_materials_variants", "variants"], index, k.into());
                        if !seen.insert(index) {
                            lint.issue_below(
                                "KHR_MATERIALS_VARIANTS_NON_UNIQUE_VARIANT",
                                k,
                                "the variant is used twice",
                            );
                        }
                    }
                });
                if let Some(index) = lint.index(mapping, "material", true)
                    && lint.resolved("materials", index, "material".into())
                {
                    out.push((index, lint.pointer(Some("material".into()))));
                }
            });
        }
    }

    pub(super) fn link_meshes(&mut self, model: &GltfModel<'a>, uses: &mut UseTable) {
        for (m, mesh) in model.meshes.iter().enumerate() {
            for (p, primitive) in mesh.iter().flat_map(|mesh| mesh.primitives.iter().enumerate()) {
                let path = ["meshes".into(), m.into(), "primitives".into(), p.into()];
                self.within_path(&path, |lint| lint.link_primitive(model, primitive, uses));
            }
        }
    }

    pub(super) fn within_path(&mut self, path: &[PointerToken<'a>], look: impl FnOnce(&mut Self)) {
        let n = self.path.len();
        self.path.extend_from_slice(path);
        look(self);
        self.path.truncate(n);
    }

    fn link_primitive(&mut self, model: &GltfModel<'a>, primitive: &GltfPrimitive<'a>, uses: &mut UseTable) {
        let mut n_vertices = None;
        for (name, index) in &primitive.attributes {
            let Some(index) = *index else { continue };
            self.within("attributes", |lint| {
                let Some(accessor) = lint.link_attribute(model, name, index, uses, AttributeOwner::Base)
                else {
                    return;
                };
                if *n_vertices.get_or_insert(accessor.count) != accessor.count {
                    lint.issue_below(
                        "MESH_PRIMITIVE_UNEQUAL_ACCESSOR_COUNT",
                        *name,
                        "attributes have different counts",
                    );
                }
            });
        }
        self.link_indices(model, primitive, n_vertices.flatten(), &mut *uses);
        if let Some(index) = primitive.material
            && self.resolved("materials", index, "material".into())
        {
            self.link_material(model, primitive, index, "/material");
        }
        for (index, place) in &primitive.variants {
            self.link_material(model, primitive, *index, place);
        }
        let bases: BTreeMap<&str, Option<usize>> = primitive.attributes.iter().copied().collect();
        for (t, target) in primitive.targets.iter().flatten().enumerate() {
            for (name, index) in target {
                let Some(index) = *index else { continue };
                let base = bases.get(name);
                self.within_path(&["targets".into(), t.into()], |lint| {
                    let Some(accessor) =
                        lint.link_attribute(model, name, index, &mut *uses, AttributeOwner::Target)
                    else {
                        return;
                    };
                    match base.and_then(|base| item(&model.accessors, *base)) {
                        None => {
                            let code = "MESH_PRIMITIVE_MORPH_TARGET_NO_BASE_ACCESSOR";
                            lint.issue_below(code, *name, "the primitive has no such attribute");
                        }
                        Some(base) if base.count != accessor.count => {
                            let code = "MESH_PRIMITIVE_MORPH_TARGET_INVALID_ATTRIBUTE_COUNT";
                            lint.issue_below(code, *name, "the primitive's attribute has another count");
                        }
                        Some(_) => {}
                    }
                });
            }
        }
    }

    fn link_attribute<'m>(
        &mut self,
        model: &'m GltfModel<'a>,
        name: &'a str,
        index: usize,
        uses: &mut UseTable,
        allowed: AttributeOwner,
    ) -> Option<&'m GltfAccessor> {
        if !self.resolved("accessors", index, name.into()) {
            return None;
        }
        let accessor = item(&model.accessors, Some(index))?;
        self.use_accessor(uses, index, AccessorUse::Attribute, name);
        self.use_view(uses, accessor.view, BufferViewUse::Vertices, name);
        if name == "POSITION" && (accessor.min.is_none() || accessor.max.is_none()) {
            let code = "MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS";
            self.issue_below(code, "POSITION", "positions need min and max");
        }
        let quantized = self.declares(super::extensions::QUANTIZATION);
        let family = name.split('_').next().unwrap_or_default();
        match (formats(family, allowed, quantized), accessor.format()) {
            (Some(formats), Some(format)) if !formats.contains(&format) => {
                self.issue("MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT", Some(name.into()), || {
                    format!("{name} cannot be {format}")
                });
            }
            // An unknown image type is not in any list.
            (Some(_), None) => {
                self.issue_below(
                    "MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT",
                    name,
                    "the format is unknown",
                );
            }
            (Some(_), Some(format)) if allowed == AttributeOwner::Base => {
                let constraint = match name {
                    "NORMAL" => Some(AccessorConstraint::UnitVectors),
                    "TANGENT" => Some(AccessorConstraint::UnitVectorsWithSign),
                    "COLOR_0" if format.component == F32 => Some(AccessorConstraint::Clamped),
                    _ => None,
                };
                if let Some(constraint) = constraint {
                    uses.constrain(index, constraint, self.pointer(Some(name.into())));
                }
            }
            (None, Some(format)) if format.component == U32 && allowed == AttributeOwner::Base => {
                self.issue_below(
                    "MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_UNSIGNED_INT",
                    name,
                    "attributes are not UNSIGNED_INT",
                );
            }
            _ => {}
        }
        let view = item(&model.views, accessor.view);
        // Without a stride, row follows row, so that rows of, for example, six bytes begin at odd
        // places.
        let loose = view.is_some_and(|view| view.stride.is_none());
        let ragged = accessor.format().is_some_and(|format| format.row_length() % 4 != 0);
        if accessor.offset.is_some_and(|offset| offset % 4 != 0) || (ragged && loose) {
            self.issue_below(
                "MESH_PRIMITIVE_ACCESSOR_UNALIGNED",
                name,
                "vertices begin at multiples of 4 bytes",
            );
        }
        // Two accessors of vertices may share a view only if it says its stride.
        if let (true, Some(view)) = (loose, accessor.view) {
            self.read_vertices(uses, view, index, name);
        }
        Some(accessor)
    }

    fn link_indices(
        &mut self,
        model: &GltfModel<'a>,
        primitive: &GltfPrimitive<'a>,
        n_vertices: Option<u64>,
        uses: &mut UseTable,
    ) {
        let Some(index) = primitive.indices else { return };
        if !self.resolved("accessors", index, "indices".into()) {
            return;
        }
        let Some(accessor) = item(&model.accessors, Some(index)) else { return };
        self.use_accessor(uses, index, AccessorUse::Indices, "indices");
        self.use_view(uses, accessor.view, BufferViewUse::Indices, "indices");
        self.within("indices", |lint| {
            if item(&model.views, accessor.view).is_some_and(|view| view.stride.is_some()) {
                lint.issue_here(
                    "MESH_PRIMITIVE_INDICES_ACCESSOR_WITH_BYTESTRIDE",
                    "indices have no byteStride",
                );
            }
            match accessor.format() {
                Some(format) if INDICES.contains(&format) => {
                    if primitive.mode.is_some() {
                        uses.constrain(
                            index,
                            AccessorConstraint::IndicesBelow(n_vertices.unwrap_or(0)),
                            lint.pointer(None),
                        );
                    }
                }
                format => {
                    lint.issue("MESH_PRIMITIVE_INDICES_ACCESSOR_INVALID_FORMAT", None, || match format {
                        Some(format) => format!("indices cannot be {format}"),
                        None => "the format is unknown".to_owned(),
                    })
                }
            }
        });
    }

    fn link_material(
        &mut self,
        model: &GltfModel<'a>,
        primitive: &GltfPrimitive<'a>,
        index: usize,
        place: &str,
    ) {
        let Some(material) = item(&model.materials, Some(index)) else { return };
        let has = |name: &str| primitive.attributes.iter().any(|(n, _)| *n == name);
        let is_main = place == "/material";
        if is_main
            && material.needs_tangents
            && !material.has_normal_texture
            && !(has("NORMAL") && has("TANGENT"))
        {
            let what = "the material needs tangents, and there are none";
            self.issue_below("MESH_PRIMITIVE_NO_TANGENT_SPACE", "material", what);
        }
        if let Some((set, texture)) = &material.texcoord
            && *set >= primitive.n_texcoords
        {
            self.issue("MESH_PRIMITIVE_TOO_FEW_TEXCOORDS", Some("material".into()), || {
                format!("texture {texture} needs TEXCOORD_{set}")
            });
        }
    }
}

/// The owner of an attribute, which decides the allowed formats.
#[derive(Clone, Copy, PartialEq, Eq)]
enum AttributeOwner {
    Base,
    Target,
}

/// The allowed formats of an attribute; `None` if any is allowed.
fn formats(family: &str, allowed: AttributeOwner, quantized: bool) -> Option<Vec<AccessorFormat>> {
    let plain_and_normalized = |kind, components: &[ComponentType], out: &mut Vec<AccessorFormat>| {
        for component in components {
            out.extend([
                AccessorFormat::plain(kind, *component),
                AccessorFormat::normalized(kind, *component),
            ]);
        }
    };
    let normalized = |kind, components: &[ComponentType], out: &mut Vec<AccessorFormat>| {
        out.extend(components.iter().map(|component| AccessorFormat::normalized(kind, *component)));
    };
    // Targets hold differences, so more signed types are allowed there and fewer unsigned ones. They
    // have no fourth number of a tangent, its handedness, which does not change.
    let base = allowed == AttributeOwner::Base;
    let mut out = Vec::new();
    match family {
        "POSITION" => {
            out.push(FLOAT3);
            if quantized {
                plain_and_normalized(Vec3, if base { &[I8, U8, I16, U16] } else { &[I8, I16] }, &mut out);
            }
        }
        "NORMAL" => {
            out.push(FLOAT3);
            if quantized {
                normalized(Vec3, &[I8, I16], &mut out);
            }
        }
        "TANGENT" => {
            let kind = if base { Vec4 } else { Vec3 };
            out.push(AccessorFormat::plain(kind, F32));
            if quantized {
                normalized(kind, &[I8, I16], &mut out);
            }
        }
        "TEXCOORD" => {
            out.push(AccessorFormat::plain(Vec2, F32));
            normalized(Vec2, if base { &[U8, U16] } else { &[I8, U8, I16, U16] }, &mut out);
            if quantized {
                let plain: &[ComponentType] = if base { &[I8, U8, I16, U16] } else { &[I8, I16] };
                out.extend(plain.iter().map(|component| AccessorFormat::plain(Vec2, *component)));
                if base {
                    normalized(Vec2, &[I8, I16], &mut out);
                }
            }
        }
        "COLOR" => {
            for kind in [Vec3, Vec4] {
                out.push(AccessorFormat::plain(kind, F32));
                normalized(kind, if base { &[U8, U16] } else { &[I8, U8, I16, U16] }, &mut out);
            }
        }
        "JOINTS" if base => out.extend([AccessorFormat::plain(Vec4, U8), AccessorFormat::plain(Vec4, U16)]),
        "WEIGHTS" if base => {
            out.push(AccessorFormat::plain(Vec4, F32));
            normalized(Vec4, &[U8, U16], &mut out);
        }
        _ => return None,
    }
    Some(out)
}

/// Parses the number of a set, without leading zeros.
fn set_number(text: &str) -> Option<u64> {
    let plain = !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    if plain && (text == "0" || !text.starts_with('0')) { text.parse().ok() } else { None }
}

fn is_target_name(name: &str) -> bool {
    let set =
        |family: &str| name.strip_prefix(family).and_then(|rest| rest.strip_prefix('_')).and_then(set_number);
    name.starts_with('_')
        || ["POSITION", "NORMAL", "TANGENT"].contains(&name)
        || ["COLOR", "TEXCOORD"].iter().any(|family| set(family).is_some())
}
