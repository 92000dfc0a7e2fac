//! `SceneProperties`: materials and colours of a scene, as 3MF can hold them.
use super::properties::{CHANNEL, ColorBytes, MATERIAL, WHITE};
use crate::instances::first_rows;
use crate::{Node, Part, Scene};
use chordal::budget::advice::{Message, Setting};
use chordal::explicit::{Attribute, Domain, Semantic};
use chordal::math::{greater, lesser};
use serde_json::Value;
use std::collections::BTreeMap;

/// The largest coordinate that lib3mf reads.
const LIB3MF_LIMIT: f64 = 1e9; // its `NMR_MESH_MAXCOORDINATE`

/// The properties of the triangles of a part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum PartProperties {
    Nothing,
    /// Materials, of all triangles or of some.
    Materials {
        of_all: bool,
    },
    /// Colours of corners, in the order of first use.
    Colors(BTreeMap<ColorBytes, u32>),
}

/// The properties of a scene.
pub(super) struct SceneProperties {
    /// For each part.
    pub parts: Vec<PartProperties>,
    /// The used materials, by their group value: index in the file, name and colour.
    pub materials: BTreeMap<u32, BaseMaterial>,
    /// Whether some part's materials are left out because its colours differ from theirs.
    pub lacks_materials: bool,
}

/// A material of the file.
#[derive(Clone, Debug)]
pub(super) struct BaseMaterial {
    pub index: u32,
    pub name: String,
    pub color: ColorBytes,
}

impl SceneProperties {
    pub(super) fn new(scene: &Scene) -> Self {
        let names = scene.groups.get(MATERIAL).map(Vec::as_slice);
        let mut base_colors: BTreeMap<u32, Option<ColorBytes>> = BTreeMap::new();
        let mut lacks_materials = false;
        let mut parts = Vec::with_capacity(scene.parts.len());
        for part in &scene.parts {
            let (materials, colors) = (materials_of(part), colors_of(part));
            let n_faces = part.mesh.faces().len();
            // A material has one colour in 3MF, so a part keeps its materials only if they have the
            // colours that earlier parts gave them.
            if let Some(materials) = materials
                && let Some(own) = material_colors(part, materials, colors, names.is_some())
                && own.iter().all(|(value, color)| agree(base_colors.get(value).copied().flatten(), *color))
            {
                own.into_iter().for_each(|(value, color)| {
                    let slot = base_colors.entry(value).or_default();
                    *slot = slot.or(color);
                });
                let of_all = (0..n_faces).all(|face| value_of(materials, face, names.is_some()).is_some());
                parts.push(PartProperties::Materials { of_all });
                continue;
            }
            lacks_materials |= materials.is_some() && n_faces > 0;
            parts.push(match colors {
                Some(colors) if n_faces > 0 => PartProperties::Colors(palette(part, colors)),
                _ => PartProperties::Nothing,
            });
        }
        let base = |(index, (value, color)): (usize, (u32, Option<ColorBytes>))| {
            let group_name = names.and_then(|names| names.get(value as usize));
            let name = group_name.cloned().unwrap_or_else(|| format!("{MATERIAL}_{value}"));
            let color = color.or_else(|| base_color(scene, value)).unwrap_or(WHITE);
            (value, BaseMaterial { index: index as u32, name, color })
        };
        let materials = base_colors.into_iter().enumerate().map(base).collect();
        Self { parts, materials, lacks_materials }
    }

    /// The index in the file of a triangle's material, if it has one.
    pub(super) fn material(&self, scene: &Scene, part: &Part, face: usize) -> Option<u32> {
        let value = value_of(materials_of(part)?, face, scene.groups.contains_key(MATERIAL))?;
        self.materials.get(&value).map(|material| material.index)
    }
}

/// The base colour of a glTF material, by the group value of its triangles.
fn base_color(scene: &Scene, value: u32) -> Option<ColorBytes> {
    let material = (value as usize).checked_sub(1).and_then(|at| scene.assets.materials.get(at))?;
    let factors = material.pointer("/pbrMetallicRoughness/baseColorFactor")?.as_array()?;
    let factor = |k: usize| factors.get(k).and_then(Value::as_f64).unwrap_or(1.0);
    let is_opaque = material["alphaMode"].as_str().is_none_or(|mode| mode == "OPAQUE");
    let alpha = if is_opaque { 1.0 } else { factor(3) };
    Some(std::array::from_fn(|k| to_byte(if k < 3 { to_srgb(factor(k)) } else { alpha })))
}

fn to_byte(x: f64) -> u8 {
    (lesser(greater(x, 0.0), 1.0) * CHANNEL).round() as u8
}

/// A linear intensity in the encoding of sRGB (IEC 61966-2-1), which 3MF uses for colours.
fn to_srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055 }
}

/// Whether a glTF material has properties other than its name and base colour.
fn has_looks(material: &Value) -> bool {
    let Some(material) = material.as_object() else { return false };
    let is_base = |(key, value): (&String, &Value)| match key.as_str() {
        "name" | "alphaMode" | "doubleSided" => true,
        "pbrMetallicRoughness" => {
            value.as_object().is_some_and(|object| object.keys().all(|key| key == "baseColorFactor"))
        }
        _ => false,
    };
    !material.iter().all(is_base)
}

fn agree(a: Option<ColorBytes>, b: Option<ColorBytes>) -> bool {
    a.is_none() || b.is_none() || a == b
}

fn materials_of(part: &Part) -> Option<&Attribute> {
    part.mesh.attribute(&Semantic::Group(MATERIAL.to_owned())).filter(|attribute| is_kept(attribute))
}

fn colors_of(part: &Part) -> Option<&Attribute> {
    part.mesh.attribute(&Semantic::Color(0)).filter(|attribute| is_kept(attribute))
}

/// The group value of a triangle's material. In groups with names, 0 means none; in groups without names, as
/// in glTF, only negative values do.
fn value_of(materials: &Attribute, face: usize, has_names: bool) -> Option<u32> {
    let value = materials.row(face)[0];
    let first = if has_names { 1.0 } else { 0.0 };
    (value >= first && value < f64::from(u32::MAX)).then_some(value as u32)
}

/// The colour of each material of a part; `None` if one has several colours, or triangles without a material
/// have a colour.
fn material_colors(
    part: &Part,
    materials: &Attribute,
    colors: Option<&Attribute>,
    has_names: bool,
) -> Option<BTreeMap<u32, Option<ColorBytes>>> {
    let mut colors_by_value: BTreeMap<u32, Option<ColorBytes>> = BTreeMap::new();
    for face in 0..part.mesh.faces().len() {
        let color = match colors.map(|colors| corner_colors(part, colors, face)) {
            None => None,
            Some([a, b, c]) if a == b && b == c => Some(a),
            Some(_) => return None,
        };
        match value_of(materials, face, has_names) {
            Some(value) => {
                let first_color = colors_by_value.entry(value).or_insert(color);
                if *first_color != color {
                    return None;
                }
            }
            None if color.is_none_or(|color| color == WHITE) => {}
            None => return None,
        }
    }
    (!colors_by_value.is_empty()).then_some(colors_by_value)
}

fn palette(part: &Part, colors: &Attribute) -> BTreeMap<ColorBytes, u32> {
    let mut palette = BTreeMap::new();
    for face in 0..part.mesh.faces().len() {
        for color in corner_colors(part, colors, face) {
            let next = palette.len() as u32;
            palette.entry(color).or_insert(next);
        }
    }
    palette
}

/// The colours of a triangle's corners, rounded to bytes.
fn corner_colors(part: &Part, colors: &Attribute, face: usize) -> [ColorBytes; 3] {
    std::array::from_fn(|k| {
        let row = match colors.domain {
            Domain::Vertex => part.mesh.faces()[face][k] as usize,
            Domain::Corner => 3 * face + k,
            Domain::Face => face,
        };
        let row = colors.row(row);
        std::array::from_fn(|channel| row.get(channel).map_or(0xFF, |value| (value * CHANNEL).round() as u8))
    })
}

/// The index of each corner's colour in a palette.
pub(super) fn corner_indices(part: &Part, palette: &BTreeMap<ColorBytes, u32>, face: usize) -> [u32; 3] {
    let Some(colors) = colors_of(part) else { return [0; 3] };
    corner_colors(part, colors, face).map(|color| palette.get(&color).copied().unwrap_or(0))
}

fn is_kept(attribute: &Attribute) -> bool {
    let Attribute { semantic, domain, width, .. } = attribute;
    match (semantic, domain) {
        (Semantic::Color(0), _) => matches!(width, 3 | 4),
        (Semantic::Group(kind), Domain::Face) => *width == 1 && kind == MATERIAL,
        _ => false,
    }
}

/// Whether the writer keeps an attribute; [`changes`] reports partial losses.
pub(crate) fn keeps(attribute: &Attribute, _first_rows: &[u32]) -> bool {
    is_kept(attribute)
}

/// The size of a scene with one part, in the unit of its file, for formats without a unit: so the user
/// notices a missing unit.
fn size_of_one(scene: &Scene) -> String {
    let is_plain = scene.nodes.len() == 1 && scene.nodes[0].matrix == Node::default().matrix;
    let [part] = &scene.parts[..] else { return String::new() };
    let bounds = part.mesh.bounds();
    if !is_plain || bounds.is_empty() {
        return String::new();
    }
    // Three digits distinguish 2 mm from 2 inches.
    let short = |x: f64| format!("{x:.2e}").parse::<f64>().unwrap_or(x);
    let [x, y, z] = [0, 1, 2].map(|k| short(bounds.max[k] - bounds.min[k]));
    format!(", {x} x {y} x {z} mm")
}

/// Changes that the writer makes to a scene, and data that it leaves out of kept attributes.
pub(crate) fn changes(scene: &Scene) -> Vec<Message> {
    let mut changes = Vec::new();
    if scene.frame.metres_per_unit.is_none() {
        let taken = "3MF needs a unit, and the shape has none: millimetres were taken";
        let message = Message::from(format!("{taken}{}; ", size_of_one(scene)));
        changes.push(message.setting(Setting::Unit).words(" says another"));
    }
    let is_byte = |value: &f64| {
        let nearest = (value * CHANNEL).round();
        (0.0..=CHANNEL).contains(&nearest) && nearest / CHANNEL == *value
    };
    if scene.parts.iter().filter_map(colors_of).any(|colors| !colors.values.iter().all(is_byte)) {
        changes.push("3MF holds colours of 8 bits a channel: others were rounded to them".into());
    }
    let materials = &scene.assets.materials;
    if materials.iter().any(has_looks) {
        let what = "3MF holds names and base colours of materials: textures and all else were left out";
        changes.extend(materials.iter().filter(|material| has_looks(material)).map(|_| what.into()));
    }
    for part in &scene.parts {
        let first_rows = first_rows(&part.mesh);
        let is_collapsed = |face: &&[u32; 3]| {
            let [a, b, c] = face.map(|row| first_rows[row as usize]);
            a == b || b == c || c == a
        };
        let collapsed = part.mesh.faces().iter().filter(is_collapsed);
        changes.extend(collapsed.map(|_| "3MF holds no triangles with a corner twice".into()));
    }
    let mut coordinates = scene.parts.iter().flat_map(|part| part.mesh.positions().as_flattened());
    if coordinates.any(|x| x.abs() > LIB3MF_LIMIT) {
        changes.push("lib3mf, which programs read 3MF by, refuses coordinates over 1,000,000,000".into());
    }
    if SceneProperties::new(scene).lacks_materials {
        changes.push(
            "3MF holds a colour or a material of a triangle: colours were written, materials not".into(),
        );
    }
    changes
}
