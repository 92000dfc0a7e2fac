//! The nodes by which a glTF maps the frame of what it holds to its own: y up, in metres.
use chordal_io::{Axis, Format, Frame, Scene};
use std::borrow::Cow;

/// From z up to y up, column by column, as the writer of glTF has it.
const Z_UP_TO_Y_UP: [f64; 16] =
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// A scene as it was before it was written to glTF from that frame: without the nodes that turn and scale all of it.
/// Nothing is computed, so that nothing is rounded. A file without such nodes stays as it is.
pub(crate) fn without_frame_nodes<'a>(scene: &'a Scene, format: Format, frame: &Frame) -> Cow<'a, Scene> {
    if !matches!(format, Format::Glb | Format::Gltf) {
        return Cow::Borrowed(scene);
    }
    let unit = frame.metres_per_unit.filter(|unit| *unit != 1.0);
    let scale = unit.map(|unit| {
        let mut matrix = crate::placements::IDENTITY;
        // The diagonal of a 4 × 4 matrix, without its last entry.
        (matrix[0], matrix[5], matrix[10]) = (unit, unit, unit);
        matrix
    });
    let turn = (frame.up == Some(Axis::Z)).then_some(Z_UP_TO_Y_UP);
    let mut roots = &scene.roots;
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
