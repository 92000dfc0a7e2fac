//! `ColladaElement`: the meaning of COLLADA elements, which depends on their parents.
use super::transform::TransformKind;

/// The meaning of an open element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ColladaElement {
    File,
    Asset,
    UpAxis,
    Image,
    ImagePath,
    Effect,
    Parameter,
    ParameterValue,
    Diffuse,
    DiffuseColor,
    Material,
    Geometry,
    Mesh,
    Source,
    Floats,
    Accessor,
    Vertices,
    Primitive,
    Counts,
    Indices,
    Controller,
    VisualScene,
    LibraryNodes,
    Node,
    Transform(TransformKind),
    Instance,
    Shown,
    Skipped,
}

/// Elements that only group others, with their parents.
const GROUPING: [(ColladaElement, &str); 22] = [
    (ColladaElement::File, "library_images"),
    (ColladaElement::File, "library_effects"),
    (ColladaElement::File, "library_materials"),
    (ColladaElement::File, "library_geometries"),
    (ColladaElement::File, "library_controllers"),
    (ColladaElement::File, "library_visual_scenes"),
    (ColladaElement::File, "scene"),
    (ColladaElement::ImagePath, "ref"),
    (ColladaElement::Effect, "profile_COMMON"),
    (ColladaElement::Effect, "technique"),
    (ColladaElement::Effect, "phong"),
    (ColladaElement::Effect, "blinn"),
    (ColladaElement::Effect, "lambert"),
    (ColladaElement::Effect, "constant"),
    (ColladaElement::Parameter, "surface"),
    (ColladaElement::Parameter, "sampler2D"),
    (ColladaElement::Source, "technique_common"),
    (ColladaElement::Primitive, "ph"),
    (ColladaElement::Instance, "bind_material"),
    (ColladaElement::Instance, "technique_common"),
    (ColladaElement::Controller, "skin"),
    (ColladaElement::Controller, "morph"),
];

/// Whether an element takes its meaning from its parent.
pub(super) fn is_grouping(parent: ColladaElement, name: &str) -> bool {
    GROUPING.contains(&(parent, name))
}

/// Skipped data: the code of its warning, and its name in the message.
pub(super) struct LeftOut {
    pub code: &'static str,
    pub what: &'static str,
}

/// The warning for a skipped element; `None` if it does not affect the shape.
pub(super) fn left_out(parent: ColladaElement, name: &str) -> Option<LeftOut> {
    use ColladaElement as Open;
    let (code, what) = match (parent, name) {
        (Open::Asset | Open::Accessor | Open::Shown | Open::Source | Open::Instance, _) | (_, "asset") => {
            return None;
        }
        (_, "library_animations" | "library_animation_clips") => ("animations-skipped", "animations"),
        (_, "library_cameras" | "library_lights" | "instance_camera" | "instance_light") => {
            ("cameras-and-lights-skipped", "cameras and lights")
        }
        (_, "extra") => ("elements-skipped", "elements"),
        (Open::Mesh, _) => ("lines-skipped", "lines and other primitives without faces"),
        (Open::Primitive, "h") => ("holes-filled", "holes of polygons, which were filled"),
        (Open::Geometry, _) => ("geometries-skipped", "geometries that are no mesh"),
        (Open::Effect | Open::Diffuse | Open::Parameter, _) => {
            ("looks-skipped", "looks of materials other than their diffuse colour")
        }
        _ => ("elements-skipped", "elements"),
    };
    Some(LeftOut { code, what })
}
