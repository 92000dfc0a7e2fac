//! Errors of gltf-validator that viewers accept, and how they are repaired.
use super::report::GlbWarnings;
use crate::{Conformance, FileLocation, Limits, ReadError, Warning};

/// Errors in data that is recomputed or left out when a file is written, so that they affect neither
/// triangles nor materials.
const RESTATED: [&str; 17] = [
    // The bounds of an accessor.
    "ACCESSOR_MIN_MISMATCH",
    "ACCESSOR_MAX_MISMATCH",
    "MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS",
    "ANIMATION_SAMPLER_INPUT_ACCESSOR_WITHOUT_BOUNDS",
    // The lengths of directions.
    "ACCESSOR_VECTOR3_NON_UNIT",
    "ACCESSOR_INVALID_SIGN",
    // Joint weights, and the layout of matrices, keys and pictures in their buffers.
    "ACCESSOR_WEIGHTS_NON_NORMALIZED",
    "ACCESSOR_WEIGHTS_NEGATIVE",
    "ACCESSOR_JOINTS_INDEX_DUPLICATE",
    "SKIN_IBM_ACCESSOR_WITH_BYTESTRIDE",
    "ANIMATION_SAMPLER_ACCESSOR_WITH_BYTESTRIDE",
    "IMAGE_BUFFER_VIEW_WITH_BYTESTRIDE",
    // Targets of buffer views, and declared extensions.
    "BUFFER_VIEW_TARGET_OVERRIDE",
    "UNDECLARED_EXTENSION",
    "UNUSED_EXTENSION_REQUIRED",
    // Repaired when nodes are read, and by reading a chunk with its declared length.
    "SCENE_NON_ROOT_NODE",
    "GLB_CHUNK_LENGTH_UNALIGNED",
];

/// Issues that stay errors even for the lenient reader, since the nodes would not be a forest.
const FOREST: [&str; 2] = ["NODE_LOOP", "NODE_PARENT_OVERRIDE"];

/// Factors of materials between 0 and 1, below `/materials/N`; each is a number or a list of numbers.
const FACTORS: [&str; 5] = [
    "/pbrMetallicRoughness/baseColorFactor",
    "/pbrMetallicRoughness/metallicFactor",
    "/pbrMetallicRoughness/roughnessFactor",
    "/emissiveFactor",
    "/occlusionTexture/strength",
];

/// Whether viewers accept this issue, and neither reading nor writing depends on it.
fn is_tolerated(issue: &Warning) -> bool {
    let FileLocation::Pointer(pointer) = &issue.place else { return RESTATED.contains(&issue.code) };
    match issue.code {
        "VALUE_NOT_IN_RANGE" => factor(pointer).is_some(),
        // The scene to show; without it, the first one is shown.
        "UNRESOLVED_REFERENCE" => pointer == "/scene",
        code => RESTATED.contains(&code),
    }
}

/// Whether an issue of this code is an error only for strict readers.
pub(super) fn is_tolerated_code(code: &str, limits: &Limits) -> bool {
    limits.conformance != Conformance::Strict && RESTATED.contains(&code)
}

/// The material and the factor's pointer inside it, for a `pointer` to the number or to a component.
fn factor(pointer: &str) -> Option<(usize, &'static str)> {
    let rest = pointer.strip_prefix("/materials/")?;
    let at = rest.find('/')?;
    let (material, inner) = (rest[..at].parse().ok()?, &rest[at..]);
    let factor_pointer = match inner.rsplit_once('/') {
        Some((list, index)) if index.parse::<usize>().is_ok() => list,
        _ => inner,
    };
    FACTORS.into_iter().find(|known| *known == factor_pointer).map(|known| (material, known))
}

/// The issues that were forgiven.
#[derive(Default)]
pub(super) struct ForgivenIssues {
    /// The codes of issues that may concern data that is kept.
    pub unsound: Vec<&'static str>,
    /// Factors that are out of range: the index of the material, and the pointer inside it.
    pub factors: Vec<(usize, &'static str)>,
}

impl ForgivenIssues {
    /// Judges the issues: the first that cannot be forgiven is returned as the error, the others become
    /// warnings.
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
