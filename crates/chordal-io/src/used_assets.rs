//! Removes unused assets: keeps the materials of faces, and the textures and pictures that they use.
use crate::assets::{VARIANTS, collect_extensions, each_variant_material};
use crate::{FaceKind, MATERIAL, Scene, SceneAssets};
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, InvalidMesh, Semantic};
use serde_json::{Value, json};
use std::borrow::Cow;
use std::collections::BTreeSet;

/// The new index for each old one; `None` for a removed item.
type Renumbering = Vec<Option<usize>>;

impl SceneAssets {
    /// The same assets, reduced to these materials and everything that they refer to: other materials
    /// (`MSFT_lod`, variants), textures, samplers and pictures. The order is kept, and items are renumbered.
    /// Also returns the new index of each old material.
    ///
    /// Texture references are recognised as glTF's texture infos: members called `…Texture` with an `index`.
    /// If a material has an extension that may refer to textures in another way, all textures and pictures
    /// are kept.
    ///
    /// ```
    /// use chordal_io::SceneAssets;
    /// use serde_json::json;
    /// let textured = |index| json!({ "normalTexture": { "index": index } });
    /// let assets = SceneAssets {
    ///     materials: vec![json!({}), textured(1)],
    ///     textures: vec![json!({ "name": "bark" }), json!({ "name": "leaf" })],
    ///     ..SceneAssets::default()
    /// };
    /// let (used, numbers) = assets.with_materials(&[1].into());
    /// assert_eq!(numbers, [None, Some(0)]);
    /// assert_eq!(used.materials, [textured(0)]);
    /// assert_eq!(used.textures, [json!({ "name": "leaf" })]);
    /// ```
    #[must_use]
    pub fn with_materials(&self, used: &BTreeSet<usize>) -> (Self, Vec<Option<usize>>) {
        let mut assets = self.clone();
        let materials = renumbering(self.materials.len(), &self.closure(used));
        assets.materials = kept_items(&self.materials, &materials);
        assets.materials.iter_mut().for_each(|material| {
            levels_of(material).into_iter().flatten().for_each(|at| renumber(at, &materials));
        });
        assets.face_kinds = std::mem::take(&mut assets.face_kinds)
            .into_iter()
            .filter_map(|(old, mut kind)| {
                kind.material = (*materials.get(kind.material)?)?;
                each_variant_material(&mut kind.properties, &mut |at| renumber(at, &materials));
                Some(((*materials.get(old)?)?, kind))
            })
            .collect();
        // A material with an unknown extension may name textures where we do not look.
        if !assets.materials.iter().all(names_textures_as_known) {
            return (assets, materials);
        }
        let mut textures = BTreeSet::new();
        each_texture(&mut assets.materials, &mut |at| textures.extend(number(at)));
        let textures = renumbering(self.textures.len(), &textures);
        each_texture(&mut assets.materials, &mut |at| renumber(at, &textures));
        // From materials to textures, then to pictures and samplers: each list is reduced to what
        // the previous one still names.
        assets.textures = kept_items(&self.textures, &textures);
        let (mut images, mut samplers) = (BTreeSet::new(), BTreeSet::new());
        assets.textures.iter_mut().for_each(|texture| {
            sources_of(texture).into_iter().for_each(|at| images.extend(number(at)));
            samplers.extend(texture.get("sampler").and_then(number));
        });
        let images = renumbering(self.images.len(), &images);
        let samplers = renumbering(self.samplers.len(), &samplers);
        assets.textures.iter_mut().for_each(|texture| {
            sources_of(texture).into_iter().for_each(|at| renumber(at, &images));
            texture.get_mut("sampler").into_iter().for_each(|at| renumber(at, &samplers));
        });
        assets.images = kept_items(&self.images, &images);
        assets.samplers = kept_items(&self.samplers, &samplers);
        (assets, materials)
    }

    /// Appends the materials of another scene and everything that they refer to; returns how many materials
    /// were here before. Variants of the appended materials are kept only if this scene has none.
    ///
    /// ```
    /// use chordal_io::SceneAssets;
    /// use serde_json::json;
    /// let textured = |index| json!({ "normalTexture": { "index": index } });
    /// let with = |name: &str| SceneAssets {
    ///     materials: vec![textured(0)],
    ///     textures: vec![json!({ "name": name })],
    ///     ..SceneAssets::default()
    /// };
    /// let mut both = with("bark");
    /// assert_eq!(both.append_materials(&with("leaf")), 1);
    /// assert_eq!(both.materials, [textured(0), textured(1)]);
    /// assert_eq!(both.textures[1], json!({ "name": "leaf" }));
    /// ```
    pub fn append_materials(&mut self, other: &Self) -> usize {
        let shift = |at: &mut Value, by: usize| {
            if let Some(old) = number(at) {
                *at = json!(old + by);
            }
        };
        let [n_materials, n_textures] = [self.materials.len(), self.textures.len()];
        let [n_images, n_samplers] = [self.images.len(), self.samplers.len()];
        let mut added = other.materials_only();
        for material in &mut added.materials {
            levels_of(material).into_iter().flatten().for_each(|at| shift(at, n_materials));
        }
        each_texture(&mut added.materials, &mut |at| shift(at, n_textures));
        for texture in &mut added.textures {
            sources_of(texture).into_iter().for_each(|at| shift(at, n_images));
            texture.get_mut("sampler").into_iter().for_each(|at| shift(at, n_samplers));
        }
        // Variants are named once for the whole file; two lists of names cannot be joined without
        // changing what a viewer offers.
        let has_looks = self.extensions.contains_key(VARIANTS);
        for (at, mut kind) in added.face_kinds {
            kind.material += n_materials;
            if has_looks
                && let Some(all) = kind.properties.get_mut("extensions").and_then(Value::as_object_mut)
            {
                all.remove(VARIANTS);
            }
            each_variant_material(&mut kind.properties, &mut |at| shift(at, n_materials));
            self.face_kinds.insert(at + n_materials, kind);
        }
        self.materials.append(&mut added.materials);
        self.textures.append(&mut added.textures);
        self.images.append(&mut added.images);
        self.samplers.append(&mut added.samplers);
        for name in added.required_extensions {
            if !self.required_extensions.contains(&name) {
                self.required_extensions.push(name);
            }
        }
        for (name, value) in added.extensions {
            self.extensions.entry(name).or_insert(value);
        }
        n_materials
    }

    /// These materials and those that they refer to as their own levels of detail.
    fn closure(&self, used: &BTreeSet<usize>) -> BTreeSet<usize> {
        let mut closure = BTreeSet::new();
        let mut open: Vec<usize> = used.iter().copied().collect();
        while let Some(idx) = open.pop() {
            let Some(material) = self.materials.get(idx) else { continue };
            if closure.insert(idx) {
                let levels = material.pointer("/extensions/MSFT_lod/ids").and_then(Value::as_array);
                open.extend(levels.into_iter().flatten().filter_map(number));
                open.extend(self.face_kinds.get(&idx).into_iter().flat_map(FaceKind::materials));
            }
        }
        closure
    }
}

impl Scene {
    /// The same scene with only the materials of its faces and everything that these refer to: see
    /// [`SceneAssets::with_materials`]. Groups of faces are renumbered accordingly.
    ///
    /// # Errors
    /// None for a valid scene; the error type is that of building a mesh.
    pub fn with_used_materials(&self) -> Result<Cow<'_, Self>, InvalidMesh> {
        let n_names = self.groups.get(MATERIAL).map_or(0, |names| names.len().saturating_sub(1));
        let n_materials = self.assets.materials.len().max(n_names);
        let mut used = BTreeSet::new();
        for part in &self.parts {
            let groups = part.mesh.attributes().iter().filter(|attribute| is_material(attribute));
            used.extend(groups.flat_map(|groups| groups.values.iter().filter_map(|x| material_of(*x))));
            for marks in part.marks.iter() {
                used.extend(marks.material);
                each_variant_material(&mut marks.primitive.clone(), &mut |at| used.extend(number(at)));
            }
        }
        used.retain(|material| *material < n_materials);
        let (assets, mut numbers) = self.assets.with_materials(&used);
        if assets == *self.assets && used.len() >= n_names {
            return Ok(Cow::Borrowed(self));
        }
        let mut scene = self.clone();
        scene.assets = Box::new(assets);
        // Without materials the names of groups are renumbered all the same.
        if self.assets.materials.is_empty() {
            numbers = renumbering(n_materials, &used);
        }
        if let Some(names) = scene.groups.get_mut(MATERIAL) {
            let all = std::mem::take(names);
            // The first name is that of faces without a material, which always stays.
            let is_kept =
                |i: &usize| i.checked_sub(1).is_none_or(|i| numbers.get(i).is_some_and(Option::is_some));
            *names = all.into_iter().enumerate().filter(|(i, _)| is_kept(i)).map(|(_, name)| name).collect();
        }
        for part in &mut scene.parts {
            part.mesh = with_groups(&part.mesh, &numbers)?;
            if part.marks.is_empty() {
                continue;
            }
            for marks in part.marks.iter_mut() {
                marks.material = marks.material.and_then(|old| *numbers.get(old)?);
                each_variant_material(&mut marks.primitive, &mut |at| renumber(at, &numbers));
            }
        }
        Ok(Cow::Owned(scene))
    }
}

/// The same mesh with its material groups renumbered.
fn with_groups(mesh: &Mesh, numbers: &Renumbering) -> Result<Mesh, InvalidMesh> {
    mesh.with_only(mesh.attributes().iter().cloned().map(|mut attribute| {
        if is_material(&attribute) {
            let new = |x: f64| material_of(x).and_then(|old| *numbers.get(old)?);
            attribute.values.iter_mut().for_each(|x| *x = new(*x).map_or(0.0, |new| (new + 1) as f64));
        }
        attribute
    }))
}

fn is_material(attribute: &Attribute) -> bool {
    let is_kind = matches!(&attribute.semantic, Semantic::Group(kind) if kind == MATERIAL);
    is_kind && attribute.domain == Domain::Face && attribute.width == 1
}

/// The material of a group; group 0 has none.
fn material_of(group: f64) -> Option<usize> {
    (group as usize).checked_sub(1)
}

fn number(at: &Value) -> Option<usize> {
    usize::try_from(at.as_u64()?).ok()
}

fn renumbering(n: usize, used: &BTreeSet<usize>) -> Renumbering {
    let mut next = 0..;
    (0..n).map(|old| if used.contains(&old) { next.next() } else { None }).collect()
}

fn kept_items<T: Clone>(list: &[T], numbers: &Renumbering) -> Vec<T> {
    list.iter().zip(numbers).filter(|(_, new)| new.is_some()).map(|(item, _)| item.clone()).collect()
}

/// References to missing items stay unchanged.
fn renumber(at: &mut Value, numbers: &Renumbering) {
    if let Some(new) = number(at).and_then(|old| *numbers.get(old)?) {
        *at = json!(new);
    }
}

/// The references of a material to its levels of detail.
fn levels_of(material: &mut Value) -> Option<impl Iterator<Item = &mut Value>> {
    Some(material.pointer_mut("/extensions/MSFT_lod/ids")?.as_array_mut()?.iter_mut())
}

/// The image references of a texture: its own `source`, and those in its extensions.
fn sources_of(texture: &mut Value) -> Vec<&mut Value> {
    let Some(members) = texture.as_object_mut() else { return Vec::new() };
    let mut sources = Vec::new();
    for (key, value) in members {
        match (key.as_str(), value) {
            ("source", value) => sources.push(value),
            ("extensions", Value::Object(extensions)) => {
                sources.extend(extensions.values_mut().filter_map(|extension| extension.get_mut("source")));
            }
            _ => {}
        }
    }
    sources
}

/// Visits all references of materials to textures. Extras are application data and are skipped.
fn each_texture(materials: &mut [Value], visit: &mut impl FnMut(&mut Value)) {
    for material in materials {
        let Some(members) = material.as_object_mut() else { continue };
        for (key, value) in members.iter_mut().filter(|(key, _)| *key != "extras") {
            if let Some(index) = value.get_mut("index").filter(|_| key.ends_with("Texture")) {
                visit(index);
            }
            each_texture(std::slice::from_mut(value), visit);
        }
    }
}

/// Whether all extensions of a material use texture infos: Khronos' own extensions, and levels of detail.
fn names_textures_as_known(material: &Value) -> bool {
    let mut names = Vec::new();
    collect_extensions(material, &mut names);
    names.iter().all(|name| {
        name.starts_with("KHR_materials_") || name == "KHR_texture_transform" || name == "MSFT_lod"
    })
}
