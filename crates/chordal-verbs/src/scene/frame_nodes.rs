//! The nodes by which a glTF maps the frame of its content to its own: y up, in metres.
use chordal_io::{Axis, Format, Frame, Scene};
use std::borrow::Cow;

/// From z up to y up, column by column, as the writer of glTF writes it.
const Z_UP_TO_Y_UP: [f64; 16] =
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// A scene as it was before it was written to glTF from that frame: without the nodes that rotate and scale all of it.
/// Nothing is computed, so that nothing is rounded. A file without such nodes stays as it is.
pub(crate) fn without_frame_nodes<'a>(scene: &'a Scene, format: Format, frame: &Frame) -> Cow<'a, Scene> {
    if format.up() == Some(Axis::Z) && frame.up == Some(Axis::Y) && scene.frame.up == Some(Axis::Z) {
        return Cow::Owned(turned_back(scene, frame));
    }
    if !format.is_gltf() {
        return Cow::Borrowed(scene);
    }
    let unit = frame.metres_per_unit.filter(|unit| *unit != 1.0);
    let scale = unit.map(|unit| {
        let mut matrix = crate::scene::placements::IDENTITY;
        // The diagonal of a 4 × 4 matrix, without its last entry.
        (matrix[0], matrix[5], matrix[10]) = (unit, unit, unit);
        matrix
    });
    let turn = (frame.up == Some(Axis::Z)).then_some(Z_UP_TO_Y_UP);
    let mut roots = &scene.roots;
    // From the outermost node inwards, as the writer nests them, and equal to the bit: a node that only resembles one
    // of them belongs to the scene.
    for matrix in turn.into_iter().chain(scale) {
        let [root] = roots[..] else { return Cow::Borrowed(scene) };
        let Some(node) = scene.nodes.get(root).filter(|node| *node.matrix == matrix && node.part.is_none())
        else {
            return Cow::Borrowed(scene);
        };
        roots = &node.children;
    }
    if std::ptr::eq(roots, &scene.roots) {
        return Cow::Borrowed(scene);
    }
    let roots = roots.clone();
    Cow::Owned(Scene { roots, frame: *frame, ..scene.clone() })
}

/// Whether a file of that format may be in a frame: by the unit and the up axis that it states, or by the nodes that
/// [`without_frame_nodes`] removes, if the format has such nodes.
pub(crate) fn may_be_in(scene: &Scene, format: Format, frame: &Frame) -> bool {
    let (scene_frame, is_gltf) = (&scene.frame, format.is_gltf());
    if is_gltf {
        let is_other = frame.up == Some(Axis::Z) || frame.metres_per_unit.is_some_and(|unit| unit != 1.0);
        return !is_other || matches!(without_frame_nodes(scene, format, frame), Cow::Owned(_));
    }
    let differs = |a: Option<f64>, b: Option<f64>| a.zip(b).is_some_and(|(a, b)| a != b);
    let is_turned = format.up() == Some(Axis::Z) && frame.up == Some(Axis::Y);
    !differs(scene_frame.metres_per_unit, frame.metres_per_unit)
        && (is_turned || scene_frame.up.zip(frame.up).is_none_or(|(a, b)| a == b))
}

/// A scene from a file whose z is always up, such as a 3MF, as it was before its writer rotated it: (x, y, z)
/// was written as (x, −z, y).
fn turned_back(scene: &Scene, frame: &Frame) -> Scene {
    let mut turned = Scene { frame: *frame, ..scene.clone() };
    for root in &scene.roots {
        let matrix = &mut turned.nodes[*root].matrix;
        for column in matrix.chunks_exact_mut(4) {
            // Adding zero removes the sign of −0.
            (column[1], column[2]) = (column[2] + 0.0, 0.0 - column[1]);
        }
    }
    turned
}
