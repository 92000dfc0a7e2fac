//! What viewers accept although gltf-validator calls it an error, and how it is mended.
use super::report::GlbWarnings;
use crate::{Conformance, FileLocation, Limits, Node, ReadError, Warning};
use chordal::math::{greater, lesser};
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// Errors about what is computed anew or left out when a file is written, so that no triangle and no look
/// depends on them.
const RESTATED: [&str; 17] = [
    // The least and largest numbers of an accessor.
    "ACCESSOR_MIN_MISMATCH",
    "ACCESSOR_MAX_MISMATCH",
    "MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS",
    "ANIMATION_SAMPLER_INPUT_ACCESSOR_WITHOUT_BOUNDS",
    // The lengths of directions.
    "ACCESSOR_VECTOR3_NON_UNIT",
    "ACCESSOR_INVALID_SIGN",
    // Weights of joints, and how matrices, keys and pictures lie in their buffers.
    "ACCESSOR_WEIGHTS_NON_NORMALIZED",
    "ACCESSOR_WEIGHTS_NEGATIVE",
    "ACCESSOR_JOINTS_INDEX_DUPLICATE",
    "SKIN_IBM_ACCESSOR_WITH_BYTESTRIDE",
    "ANIMATION_SAMPLER_ACCESSOR_WITH_BYTESTRIDE",
    "IMAGE_BUFFER_VIEW_WITH_BYTESTRIDE",
    // What buffers are for, and which extensions are there.
    "BUFFER_VIEW_TARGET_OVERRIDE",
    "UNDECLARED_EXTENSION",
    "UNUSED_EXTENSION_REQUIRED",
    // Mended by `detach_shown_children`, and by reading the chunk of the length that it says.
    "SCENE_NON_ROOT_NODE",
    "GLB_CHUNK_LENGTH_UNALIGNED",
];

/// Issues that stay errors when the reader is lenient, since the nodes would be no forest.
const FOREST: [&str; 2] = ["NODE_LOOP", "NODE_PARENT_OVERRIDE"];

/// Factors of materials between 0 and 1, below `/materials/N`, each a number or a list of some.
const FACTORS: [&str; 5] = [
    "/pbrMetallicRoughness/baseColorFactor",
    "/pbrMetallicRoughness/metallicFactor",
    "/pbrMetallicRoughness/roughnessFactor",
    "/emissiveFactor",
    "/occlusionTexture/strength",
];

/// Whether viewers accept this, and what is read and written does not depend on it.
fn is_tolerated(issue: &Warning) -> bool {
    let FileLocation::Pointer(pointer) = &issue.place else { return RESTATED.contains(&issue.code) };
    match issue.code {
        "VALUE_NOT_IN_RANGE" => factor(pointer).is_some(),
        // The scene to show first; without one it is the first.
        "UNRESOLVED_REFERENCE" => pointer == "/scene",
        code => RESTATED.contains(&code),
    }
}

/// Whether this code's error is one only for readers that are strict.
pub(super) fn is_tolerated_code(code: &str, limits: &Limits) -> bool {
    limits.conformance != Conformance::Strict && RESTATED.contains(&code)
}

/// The material and the pointer in it of a factor, of which `pointer` names the number or a component.
fn factor(pointer: &str) -> Option<(usize, &str)> {
    let rest = pointer.strip_prefix("/materials/")?;
    let at = rest.find('/')?;
    let (material, inner) = (rest[..at].parse().ok()?, &rest[at..]);
    let whole = match inner.rsplit_once('/') {
        Some((list, index)) if index.parse::<usize>().is_ok() => list,
        _ => inner,
    };
    FACTORS.contains(&whole).then_some((material, whole))
}

/// What was forgiven.
#[derive(Default)]
pub(super) struct ForgivenIssues {
    /// What may be about something that is kept, by code.
    pub unsound: Vec<&'static str>,
    /// Pointers to factors that are out of their range.
    factors: Vec<String>,
}

impl ForgivenIssues {
    /// Judges the issues: the first that is not forgiven is the error, others become warnings.
    pub fn judge(issues: Vec<Warning>, limits: &Limits, report: &mut GlbWarnings) -> Result<Self, ReadError> {
        let mut forgiven = Self::default();
        for issue in issues {
            let is_lenient = limits.conformance == Conformance::Lenient && !FOREST.contains(&issue.code);
            let is_dropped = limits.drop_nonfinite && issue.code == "ACCESSOR_INVALID_FLOAT";
            if limits.conformance != Conformance::Strict && is_tolerated(&issue) {
                if let ("VALUE_NOT_IN_RANGE", FileLocation::Pointer(pointer)) = (issue.code, &issue.place) {
                    forgiven.factors.push(pointer.clone());
                }
            } else if is_lenient || is_dropped {
                forgiven.unsound.push(issue.code);
            } else {
                return Err(ReadError::new(issue.code, issue.place, issue.message));
            }
            report.add(issue.code, issue.place, issue.message);
        }
        Ok(forgiven)
    }

    /// Takes factors into their range; `groups` are the groups that the materials of the file became.
    pub fn clamp_factors(&self, materials: &mut [Value], groups: &[usize]) {
        for (material, inner) in self.factors.iter().filter_map(|pointer| factor(pointer)) {
            let at = groups.get(material).and_then(|group| group.checked_sub(1));
            let value =
                at.and_then(|at| materials.get_mut(at)).and_then(|material| material.pointer_mut(inner));
            // One issue stands for all components of a list.
            match value {
                Some(Value::Array(list)) => list.iter_mut().for_each(clamp),
                Some(value) => clamp(value),
                None => {}
            }
        }
    }
}

/// Takes a number into the range of a factor.
fn clamp(value: &mut Value) {
    if let Some(x) = value.as_f64().filter(|x| !(0.0..=1.0).contains(x)) {
        *value = json!(lesser(greater(x, 0.0), 1.0));
    }
}

/// Makes a forest of nodes of which a scene names some that are no roots: such a node stays where its
/// ancestors show it, and where they are not shown it is taken from them. Returns whether one was.
pub(super) fn detach_shown_children(nodes: &mut [Node], roots: &mut Vec<usize>) -> bool {
    let mut parent = vec![None; nodes.len()];
    for (i, node) in nodes.iter().enumerate() {
        node.children.iter().for_each(|child| parent[*child] = Some(i));
    }
    if roots.iter().all(|root| parent[*root].is_none()) {
        return false;
    }
    let mut is_root = vec![false; nodes.len()];
    roots.iter().for_each(|root| is_root[*root] = true);
    // Whether an ancestor is shown, from the top down.
    let mut is_covered = vec![false; nodes.len()];
    let mut open: Vec<usize> = (0..nodes.len()).filter(|node| parent[*node].is_none()).collect();
    while let Some(node) = open.pop() {
        for child in &nodes[node].children {
            is_covered[*child] = is_covered[node] || is_root[node];
            open.push(*child);
        }
    }
    roots.retain(|root| !is_covered[*root]);
    let is_cut = |node: usize| is_root[node] && !is_covered[node];
    let parents = roots.iter().filter_map(|root| parent[*root]).collect::<BTreeSet<_>>();
    parents.iter().for_each(|parent| nodes[*parent].children.retain(|child| !is_cut(*child)));
    !parents.is_empty()
}
