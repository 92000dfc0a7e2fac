//! What viewers accept although gltf-validator calls it an error, and how it is mended.
use super::report::GlbWarnings;
use crate::{Conformance, FileLocation, Limits, ReadError, Warning};

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
    // Mended where nodes are read, and by reading the chunk of the length that it says.
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
fn factor(pointer: &str) -> Option<(usize, &'static str)> {
    let rest = pointer.strip_prefix("/materials/")?;
    let at = rest.find('/')?;
    let (material, inner) = (rest[..at].parse().ok()?, &rest[at..]);
    let whole = match inner.rsplit_once('/') {
        Some((list, index)) if index.parse::<usize>().is_ok() => list,
        _ => inner,
    };
    FACTORS.into_iter().find(|known| *known == whole).map(|known| (material, known))
}

/// What was forgiven.
#[derive(Default)]
pub(super) struct ForgivenIssues {
    /// What may be about something that is kept, by code.
    pub unsound: Vec<&'static str>,
    /// Factors that are out of their range: the material of the file, and the pointer in it.
    pub factors: Vec<(usize, &'static str)>,
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
                    forgiven.factors.extend(factor(pointer));
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
}
