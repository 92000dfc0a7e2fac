//! Rules for nodes and scenes.
use super::extensions::ExtensionHost;
use super::{ANY, GltfLint};
use crate::glb::INSTANCING;
use crate::glb::json::JsonValue;
use crate::glb::model::{GltfAttributes, GltfModel, GltfNode, GltfNodeMore, GltfScene, item};
use crate::glb::transform::{is_identity, is_trs};

/// How far the length of a quaternion may be from 1. Defined by the validator, for quaternions of bytes.
const UNIT_QUATERNION: f64 = 0.00769;

impl<'a> GltfLint<'a> {
    pub(super) fn node(&mut self, map: &'a JsonValue) -> GltfNode<'a> {
        let matrix = self.any_numbers::<16>(map, "matrix").map(Box::new);
        let translation = self.any_numbers::<3>(map, "translation");
        let rotation: Option<[f64; 4]> =
            self.numbers(map, "rotation", 4, (-1.0, 1.0)).and_then(|rotation| rotation.try_into().ok());
        if let Some(q) = rotation
            && !is_unit(&q.map(to_single), UNIT_QUATERNION)
        {
            self.issue_below("ROTATION_NON_UNIT", "rotation", "the quaternion is not normalized");
        }
        let scale = self.any_numbers::<3>(map, "scale");
        self.reference(map, "camera", "cameras");
        let children = self.indices(map, "children", false).unwrap_or_default();
        let mesh = self.reference(map, "mesh", "meshes");
        let skin = self.reference(map, "skin", "skins");
        let weights = self.numbers(map, "weights", 0, ANY);
        if mesh.is_none() && skin.is_some() {
            self.issue_below("UNSATISFIED_DEPENDENCY", "skin", "mesh is missing");
        }
        if mesh.is_none() && weights.is_some() {
            self.issue_below("UNSATISFIED_DEPENDENCY", "weights", "mesh is missing");
        }
        if let Some(matrix) = &matrix {
            if translation.is_some() || rotation.is_some() || scale.is_some() {
                self.issue_below(
                    "NODE_MATRIX_TRS",
                    "matrix",
                    "a node has either a matrix or translation, rotation, scale",
                );
            }
            if !is_identity(matrix) && !is_trs(matrix) {
                self.issue_below(
                    "NODE_MATRIX_NON_TRS",
                    "matrix",
                    "the matrix is no translation, rotation and scale",
                );
            }
        }
        let name = self.name(map);
        let extensions = self.extensions(map, ExtensionHost::Node);
        self.each_extension(extensions, |lint, _, value| {
            let light = lint.index(value, "light", true);
            lint.extension_reference(["KHR_lights_punctual", "lights"], light, "light".into());
        });
        let instances = self.instances(map);
        let more = GltfNodeMore {
            skin,
            matrix,
            translation: translation.map(Box::new),
            rotation: rotation.map(Box::new),
            scale: scale.map(Box::new),
            weights: weights.map(Vec::into_boxed_slice),
            instances,
        };
        let more = Some(more).filter(|more| *more != GltfNodeMore::default()).map(Box::new);
        GltfNode { name, children: children.into(), mesh, more }
    }

    /// The accessors of `EXT_mesh_gpu_instancing`, which the validator does not know.
    fn instances(&mut self, map: &'a JsonValue) -> Option<GltfAttributes<'a>> {
        let instancing =
            map.get("extensions")?.get(INSTANCING).filter(|x| matches!(x, JsonValue::Object(_)))?;
        self.within("extensions", |lint| {
            lint.within(INSTANCING, |lint| {
                let attributes = lint.object(instancing, "attributes", true)?;
                lint.within("attributes", |lint| {
                    let names = attributes.entries().iter().map(|(name, _)| &**name);
                    Some(names.map(|name| (name, lint.reference(attributes, name, "accessors"))).collect())
                })
            })
        })
    }

    pub(super) fn scene(&mut self, map: &'a JsonValue) -> GltfScene {
        let nodes = self.indices(map, "nodes", false);
        self.name(map);
        self.extensions(map, ExtensionHost::Other);
        GltfScene { nodes }
    }

    pub(super) fn link_nodes(&mut self, model: &GltfModel<'a>) {
        let mut parent = vec![None; model.nodes.len()];
        for (i, node) in model.nodes.iter().enumerate() {
            let Some(node) = node else { continue };
            self.within_path(&["nodes".into(), i.into()], |lint| {
                lint.link_node(model, node);
                lint.within("children", |lint| {
                    for (c, child) in node.children.iter().enumerate() {
                        let Some(child) = *child else { continue };
                        if !lint.resolved("nodes", child, c.into()) {
                            continue;
                        }
                        if parent[child].replace(i).is_some() {
                            let what = format!("node {child} has another parent");
                            lint.issue("NODE_PARENT_OVERRIDE", Some(c.into()), || what);
                        }
                    }
                });
            });
        }
        for i in nodes_on_cycles(&parent) {
            self.within("nodes", |lint| lint.issue_below("NODE_LOOP", i, "the node is its own ancestor"));
        }
        // After all nodes, since any of them may be the parent.
        for (s, scene) in model.scenes.iter().enumerate() {
            let nodes = scene.iter().flat_map(|scene| scene.nodes.iter().flatten());
            for (k, node) in nodes.enumerate() {
                let Some(node) = *node else { continue };
                self.within_path(&["scenes".into(), s.into(), "nodes".into()], |lint| {
                    if lint.resolved("nodes", node, k.into()) && parent[node].is_some() {
                        let what = format!("node {node} is no root");
                        lint.issue("SCENE_NON_ROOT_NODE", Some(k.into()), || what);
                    }
                });
            }
        }
    }

    fn link_node(&mut self, model: &GltfModel<'a>, node: &GltfNode<'a>) {
        let Some(mesh) = item(&model.meshes, node.mesh) else { return };
        let Some(first) = mesh.primitives.first() else { return };
        let n_targets = first.targets.as_ref().map(Vec::len);
        if let Some(weights) = node.weights().filter(|weights| Some(weights.len()) != n_targets) {
            let what = format!("{} weights for {} morph targets", weights.len(), n_targets.unwrap_or(0));
            self.issue("NODE_WEIGHTS_INVALID", Some("weights".into()), || what);
        }
        if item(&model.skins, node.skin()).is_some() && mesh.primitives.iter().all(|p| p.n_joints == 0) {
            self.issue_here("NODE_SKIN_WITH_NON_SKINNED_MESH", "the node has a skin, its mesh no joints");
        }
    }
}

/// Rounds to single precision.
#[allow(clippy::cast_possible_truncation)]
pub(super) fn to_single(x: f64) -> f64 {
    f64::from(x as f32)
}

/// Whether a vector is of unit length to a tolerance.
pub(super) fn is_unit(vector: &[f64], tolerance: f64) -> bool {
    let square = vector.iter().map(|x| x * x).sum::<f64>();
    // The length is nearer to 1 than its square.
    if (square - 1.0).abs() <= tolerance {
        return true;
    }
    let error = (square.sqrt() - 1.0).abs();
    // The validator reports NaN as another issue.
    error.is_nan() || error <= tolerance
}

/// Whether four numbers are a unit quaternion, to the validator's tolerance.
pub(in crate::glb) fn is_unit_quaternion(numbers: &[f64; 4]) -> bool {
    is_unit(numbers, UNIT_QUATERNION)
}

/// The nodes that are their own ancestors. Each node has at most one parent, so walking up finds each cycle
/// once.
fn nodes_on_cycles(parent: &[Option<usize>]) -> Vec<usize> {
    // The number of the walk that visited the node first; 0 for none.
    let mut walk = vec![0; parent.len()];
    let mut out = Vec::new();
    for start in 0..parent.len() {
        let mut at = start;
        while walk[at] == 0 {
            walk[at] = start + 1;
            match parent[at] {
                Some(up) => at = up,
                None => break,
            }
        }
        // The walk met itself: `at` is on a new cycle.
        if walk[at] == start + 1 && parent[at].is_some() {
            let mut member = at;
            loop {
                out.push(member);
                match parent[member] {
                    Some(up) if up != at => member = up,
                    _ => break,
                }
            }
        }
    }
    out.sort_unstable();
    out
}

#[cfg(test)]
mod tests {
    use super::nodes_on_cycles;

    #[test]
    fn finds_the_members_of_loops_and_not_what_hangs_on_them() {
        assert_eq!(nodes_on_cycles(&[None, Some(0), Some(1)]), Vec::<usize>::new());
        assert_eq!(nodes_on_cycles(&[Some(0)]), vec![0]);
        assert_eq!(nodes_on_cycles(&[Some(1), Some(2), Some(1), Some(0), None]), vec![1, 2]);
        let chain: Vec<_> = (0..100_000).map(|i: usize| i.checked_sub(1)).collect();
        assert_eq!(nodes_on_cycles(&chain), Vec::<usize>::new());
    }
}
