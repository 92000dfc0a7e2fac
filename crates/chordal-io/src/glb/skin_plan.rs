//! `SkinPlan`: the joints and weights of a primitive, and its morph targets, as attributes that can be
//! blended.
use super::accessor_rows::AccessorRows;
use super::deformation::IN_A_SET;
use super::model::{GltfMesh, GltfModel, GltfPrimitive};
use chordal::explicit::Semantic;
use std::collections::{BTreeMap, BTreeSet};

/// The number of joints whose weights are in one attribute: the largest width of an attribute.
const JOINTS: usize = 16;

/// The most sets that are read: 32 joints per vertex. Chosen: exporters write one or two sets.
const MOST_SETS: usize = 8;

/// The weights of a skin as they are read: one number for each joint, so that they can be blended.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SkinPlan {
    /// The number of sets, of four joints per vertex.
    pub n_sets: usize,
    /// One more than the highest joint with a weight.
    pub n_joints: usize,
}

impl SkinPlan {
    /// The sets that all primitives with triangles have, and the joints in them. `charge` gets the number of
    /// bytes that are read, since a file may refer to the same ones many times.
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

    /// Appends the weights of a primitive's vertices to the attributes' values.
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
                    // Added, since a vertex may name the same joint in several places.
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

/// Joints with their weights, four per vertex.
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

    /// Visits each vertex with each of its joints and the weight.
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

/// Whether glTF has morph targets with this name and `width` numbers per vertex.
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
    /// The accessor of the first primitive.
    pub accessor: Option<usize>,
}

/// The attributes of morph targets that all primitives with triangles have, and that the first one has
/// itself; empty if some target would have no attribute, since such a target cannot be written.
pub(super) fn common_targets<'m>(mesh: &'m GltfMesh<'_>) -> Vec<CommonTarget<'m>> {
    let drawn = || mesh.primitives.iter().filter(|primitive| primitive.is_drawn());
    let Some(first) = drawn().next() else { return Vec::new() };
    let bases: BTreeSet<&str> = first.attributes.iter().map(|(name, _)| *name).collect();
    // The number of primitives that have it, and the accessor of the first.
    let mut usage: BTreeMap<(usize, &str), (usize, Option<usize>)> = BTreeMap::new();
    for primitive in drawn() {
        for (target, attributes) in primitive.targets.iter().flatten().enumerate() {
            for (name, accessor) in attributes {
                usage.entry((target, *name)).or_insert((0, *accessor)).0 += 1;
            }
        }
    }
    let n_drawn = drawn().count();
    usage.retain(|(_, name), (n, _)| *n == n_drawn && bases.contains(name));
    let targets: BTreeSet<usize> = usage.keys().map(|(target, _)| *target).collect();
    if targets.len() < first.targets.as_ref().map_or(0, Vec::len) {
        return Vec::new();
    }
    let common = usage.into_iter();
    common.map(|((target, name), (_, accessor))| CommonTarget { target, name, accessor }).collect()
}

/// The attribute with the displacements of `name` by a morph target.
pub(super) fn morph_semantic(target: usize, name: &str) -> Semantic {
    Semantic::Blended(format!("morph target {target} {name}"))
}
