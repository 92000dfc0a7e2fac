//! Attributes that deform a mesh: how much its vertices follow the joints of a skin, and how far morph
//! targets move them.
use super::accessor_rows::AccessorRows;
use super::model::{GltfMesh, GltfModel, GltfPrimitive};
use super::report::GlbWarnings;
use crate::{FileLocation, Part, Scene};
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic};
use serde_json::{Map, Value};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

/// Joints whose weights are in one attribute: as many as an attribute has numbers.
const JOINTS: usize = 16;

/// Joints of one set, as glTF defines it.
const IN_A_SET: usize = 4;

/// The most sets that are read: 32 joints a vertex. Chosen: exporters write one or two.
const MOST_SETS: usize = 8;

/// The weights of a skin as they are read: one number for each joint, so that they can be blended.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SkinPlan {
    /// Sets of four joints a vertex.
    pub n_sets: usize,
    /// One more than the highest joint with a weight.
    pub n_joints: usize,
}

impl SkinPlan {
    /// The sets that all primitives with triangles have, and the joints in them. `charge` is told how many bytes
    /// are read for that, since a file may name the same ones again and again.
    pub fn from_mesh<E>(
        model: &GltfModel<'_>,
        mesh: &GltfMesh<'_>,
        mut charge: impl FnMut(u64) -> Result<(), E>,
    ) -> Result<Self, E> {
        let drawn = || mesh.primitives.iter().filter(|primitive| primitive.is_drawn());
        let has = |set: usize| drawn().all(|primitive| accessors_of(primitive, set).is_some());
        let n_sets =
            if drawn().next().is_none() { 0 } else { (0..MOST_SETS).take_while(|set| has(*set)).count() };
        let mut n_joints = 0;
        for (primitive, set) in drawn().flat_map(|primitive| (0..n_sets).map(move |set| (primitive, set))) {
            let Some(rows) = accessors_of(primitive, set).and_then(|pair| SkinRows::new(model, pair)) else {
                return Ok(Self::default());
            };
            charge(rows.joints.count.saturating_mul(IN_A_SET as u64 * 2))?;
            rows.each(|_, joint, _| n_joints = n_joints.max(joint + 1));
        }
        Ok(if n_joints == 0 { Self::default() } else { Self { n_sets, n_joints } })
    }

    /// The attributes that hold the weights: for each its semantic and its width.
    pub fn attributes(&self) -> impl Iterator<Item = (Semantic, usize)> {
        let n_influences = IN_A_SET * self.n_sets;
        (0..self.n_joints).step_by(JOINTS).map({
            let n_joints = self.n_joints;
            move |first| {
                let width = JOINTS.min(n_joints - first);
                let last = first + width - 1;
                let name = format!("weights of joints {first} to {last}, {n_influences} a vertex");
                (Semantic::Blended(name), width)
            }
        })
    }

    /// Adds the weights of a primitive's vertices to the ends of the attributes' values.
    pub fn read(
        &self,
        model: &GltfModel<'_>,
        primitive: &GltfPrimitive<'_>,
        count: usize,
        streams: &mut [Vec<f64>],
    ) {
        let widths: Vec<usize> = self.attributes().map(|(_, width)| width).collect();
        let mut starts = Vec::with_capacity(streams.len());
        for (values, width) in streams.iter_mut().zip(&widths) {
            starts.push(values.len());
            values.resize(values.len() + count * width, 0.0);
        }
        for set in 0..self.n_sets {
            let Some(rows) = accessors_of(primitive, set).and_then(|pair| SkinRows::new(model, pair)) else {
                continue;
            };
            rows.each(|vertex, joint, weight| {
                let (k, column) = (joint / JOINTS, joint % JOINTS);
                if vertex < count
                    && let Some(values) = streams.get_mut(k)
                {
                    values[starts[k] + vertex * widths[k] + column] += weight;
                }
            });
        }
    }
}

/// The accessors of joints and weights of a set.
fn accessors_of(primitive: &GltfPrimitive<'_>, set: usize) -> Option<[usize; 2]> {
    let [joints, weights] = ["JOINTS", "WEIGHTS"].map(|family| {
        let name = format!("{family}_{set}");
        primitive.attributes.iter().find(|(known, _)| *known == name).and_then(|(_, accessor)| *accessor)
    });
    Some([joints?, weights?])
}

/// Joints with their weights, four a vertex.
struct SkinRows<'m> {
    joints: AccessorRows<'m>,
    weights: AccessorRows<'m>,
}

impl<'m> SkinRows<'m> {
    fn new(model: &'m GltfModel<'_>, [joints, weights]: [usize; 2]) -> Option<Self> {
        let rows = |accessor| AccessorRows::new(model, accessor).ok();
        let (joints, weights) = (rows(joints)?, rows(weights)?);
        let has_four = |rows: &AccessorRows<'_>| rows.format.kind.n_components() == IN_A_SET;
        let is_sound = has_four(&joints) && has_four(&weights) && joints.count == weights.count;
        is_sound.then_some(Self { joints, weights })
    }

    /// Each vertex with a joint that it follows and how much.
    fn each(&self, mut take: impl FnMut(usize, usize, f64)) {
        let mut joints = Vec::new();
        self.joints.each(|_, row| joints.extend(row.iter().map(|joint| *joint as u16)));
        let mut joints = joints.chunks_exact(IN_A_SET);
        self.weights.each(|vertex, row| {
            for (joint, weight) in joints.next().into_iter().flatten().zip(row) {
                let weight = self.weights.decode(*weight);
                if weight > 0.0 && weight.is_finite() {
                    take(vertex as usize, usize::from(*joint), weight);
                }
            }
        });
    }
}

/// The attribute that holds what a morph target adds to `name`.
pub(super) fn morph_semantic(target: usize, name: &str) -> Semantic {
    Semantic::Blended(format!("morph target {target} {name}"))
}

/// Whether glTF has morph targets of this name with that many numbers a vertex.
pub(super) fn has_width(name: &str, width: usize) -> bool {
    let is_set = |family: &str| name.strip_prefix(family).is_some_and(|set| set.parse::<u32>().is_ok());
    match name {
        "POSITION" | "NORMAL" | "TANGENT" => width == 3,
        _ if is_set("TEXCOORD_") => width == 2,
        _ if is_set("COLOR_") => width == 3 || width == 4,
        _ => name.starts_with('_'),
    }
}

/// An attribute of a morph target that all primitives with triangles have.
pub(super) struct CommonTarget<'m> {
    pub target: usize,
    pub name: &'m str,
    /// That of the first primitive.
    pub accessor: Option<usize>,
}

/// The attributes of morph targets that all primitives with triangles have, and that the first one has itself;
/// none where some target would have no attribute, which cannot be written.
pub(super) fn common_targets<'m>(mesh: &'m GltfMesh<'_>) -> Vec<CommonTarget<'m>> {
    let drawn = || mesh.primitives.iter().filter(|primitive| primitive.is_drawn());
    let Some(first) = drawn().next() else { return Vec::new() };
    let bases: BTreeSet<&str> = first.attributes.iter().map(|(name, _)| *name).collect();
    // How many primitives have it, and the accessor of the first.
    let mut found: BTreeMap<(usize, &str), (usize, Option<usize>)> = BTreeMap::new();
    for primitive in drawn() {
        for (target, attributes) in primitive.targets.iter().flatten().enumerate() {
            for (name, accessor) in attributes {
                found.entry((target, *name)).or_insert((0, *accessor)).0 += 1;
            }
        }
    }
    let n_drawn = drawn().count();
    found.retain(|(_, name), (n, _)| *n == n_drawn && bases.contains(name));
    let targets: BTreeSet<usize> = found.keys().map(|(target, _)| *target).collect();
    if targets.len() < first.targets.as_ref().map_or(0, Vec::len) {
        return Vec::new();
    }
    let common = found.into_iter();
    common.map(|((target, name), (_, accessor))| CommonTarget { target, name, accessor }).collect()
}

/// Takes out what names weights of joints or morph targets that no mesh has.
pub(super) fn drop_dangling_references(scene: &mut Scene, report: &mut GlbWarnings) {
    let n_targets: Vec<usize> = scene.parts.iter().map(|part| targets_of(&part.mesh).len()).collect();
    let is_skinned: Vec<bool> = scene.parts.iter().map(|part| has_skin(&part.mesh)).collect();
    let n_weights = |properties: &Map<String, Value>| {
        let numbers = |weights: &Vec<Value>| weights.iter().all(Value::is_number).then_some(weights.len());
        properties.get("weights").map(|weights| weights.as_array().and_then(numbers).unwrap_or(0))
    };
    let mut n_lost = 0;
    for (part, n_targets) in scene.parts.iter_mut().zip(&n_targets) {
        if let Some(properties) = &mut part.properties
            && n_weights(properties).is_some_and(|n| n == 0 || n != *n_targets)
        {
            properties.shift_remove("weights");
            n_lost += 1;
        }
    }
    let mut n_unskinned = 0;
    for node in &mut scene.nodes {
        let own_targets = node.part.map_or(0, |part| n_targets[part]);
        if n_weights(&node.properties).is_some_and(|n| n == 0 || n != own_targets) {
            node.properties.shift_remove("weights");
            n_lost += 1;
        }
        let skin = node.properties.get("skin").map(Value::as_u64);
        let is_there = |skin: Option<u64>| skin.is_some_and(|skin| skin < scene.assets.skins.len() as u64);
        if skin.is_some_and(|skin| !is_there(skin) || !node.part.is_some_and(|part| is_skinned[part])) {
            node.properties.shift_remove("skin");
            n_unskinned += 1;
        }
    }
    let is_kept = |channel: &Value| {
        let target = &channel["target"];
        let node = target["node"].as_u64().and_then(|node| scene.nodes.get(usize::try_from(node).ok()?));
        target["path"] != "weights" || node.and_then(|node| node.part).is_some_and(|part| n_targets[part] > 0)
    };
    scene.assets.animations.retain_mut(|animation| {
        let Some(channels) = animation["channels"].as_array_mut() else { return false };
        channels.retain(is_kept);
        !channels.is_empty()
    });
    report.add_many("morph-targets-ignored", n_lost, FileLocation::File, "some morph targets were not kept");
    report.add_many("skins-ignored", n_unskinned, FileLocation::File, "some skins were not kept");
}

/// The morph targets of a mesh that is written: for each the attributes with their names in glTF.
pub(super) fn targets_of(mesh: &Mesh) -> Vec<Vec<(&str, &Attribute)>> {
    let mut targets: Vec<Vec<(&str, &Attribute)>> = Vec::new();
    for attribute in mesh.attributes().iter().filter(|attribute| attribute.domain == Domain::Vertex) {
        let Semantic::Blended(name) = &attribute.semantic else { continue };
        let parsed = name.strip_prefix("morph target ").and_then(|rest| rest.split_once(' '));
        if let Some((Ok(target), name)) = parsed.map(|(target, name)| (target.parse::<usize>(), name)) {
            targets.resize_with(targets.len().max(target + 1), Vec::new);
            targets[target].push((name, attribute));
        }
    }
    targets
}

/// The weights of joints that a mesh carries: the first joint of each attribute, and the joints a vertex.
fn weights_of(mesh: &Mesh) -> Vec<(usize, usize, &Attribute)> {
    let parse = |attribute: &'_ Attribute| {
        let Semantic::Blended(name) = &attribute.semantic else { return None };
        let (joints, influences) = name.strip_prefix("weights of joints ")?.split_once(", ")?;
        let first = joints.split_once(" to ")?.0.parse().ok()?;
        Some((first, influences.strip_suffix(" a vertex")?.parse().ok()?))
    };
    let vertices = mesh.attributes().iter().filter(|attribute| attribute.domain == Domain::Vertex);
    vertices.filter_map(|attribute| parse(attribute).map(|(first, n)| (first, n, attribute))).collect()
}

/// Whether a mesh follows joints or has morph targets.
pub(crate) fn is_deformed(mesh: &Mesh) -> bool {
    mesh.attributes().iter().any(|attribute| matches!(attribute.semantic, Semantic::Blended(_)))
}

impl Part {
    /// Whether a skin or morph targets move its vertices.
    #[must_use]
    pub fn is_deformed(&self) -> bool {
        is_deformed(&self.mesh)
    }
}

/// Whether a mesh follows joints.
pub(super) fn has_skin(mesh: &Mesh) -> bool {
    !weights_of(mesh).is_empty()
}

/// A set of four joints a vertex with their weights, as glTF stores it.
pub(super) struct SkinSet {
    pub joints: Vec<u16>,
    pub weights: Vec<f32>,
}

/// The joints of a mesh that is written: as many a vertex as where it was read, the heaviest first, with
/// weights that sum to 1.
pub(super) fn skin_sets(mesh: &Mesh) -> Vec<SkinSet> {
    let attributes = weights_of(mesh);
    let Some(n_influences) = attributes.iter().map(|(_, n, _)| *n).max() else { return Vec::new() };
    let n_sets = n_influences.div_ceil(IN_A_SET).max(1);
    let n = mesh.positions().len() * IN_A_SET;
    let mut sets: Vec<SkinSet> = (0..n_sets)
        .map(|_| SkinSet { joints: Vec::with_capacity(n), weights: Vec::with_capacity(n) })
        .collect();
    for vertex in 0..mesh.positions().len() {
        let mut found: Vec<(u16, f64)> = Vec::new();
        for (first, _, attribute) in &attributes {
            let row = attribute.row(vertex).iter().enumerate().filter(|(_, weight)| **weight > 0.0);
            found.extend(row.map(|(k, weight)| ((first + k) as u16, *weight)));
        }
        // The order of weights is total, since they are positive numbers.
        found.sort_by_key(|(joint, weight)| (Reverse(weight.to_bits()), *joint));
        found.truncate(n_sets * IN_A_SET);
        let sum: f64 = found.iter().map(|(_, weight)| weight).sum();
        // A vertex that follows nothing follows the first joint.
        let found = if sum > 0.0 && sum.is_finite() { found } else { vec![(0, 1.0)] };
        let sum = if sum > 0.0 && sum.is_finite() { sum } else { 1.0 };
        let mut stored: Vec<f32> = found.iter().map(|(_, weight)| (weight / sum) as f32).collect();
        let rest: f64 = stored[1..].iter().map(|weight| f64::from(*weight)).sum();
        stored[0] = (1.0 - rest) as f32;
        for (s, set) in sets.iter_mut().enumerate() {
            let mut rows = found.iter().zip(&stored).skip(s * IN_A_SET);
            for _ in 0..IN_A_SET {
                // A joint without weight is the first, as the validator wants it.
                let row = rows.next().filter(|(_, weight)| **weight > 0.0);
                let (joint, weight) = row.map_or((0, 0.0), |((joint, _), weight)| (*joint, *weight));
                set.joints.push(joint);
                set.weights.push(weight);
            }
        }
    }
    sets
}
