//! The most that rounding to a format can move the parts of a scene, known before anything is built.
use crate::placements::scaled_up;
use chordal::math::greater;
use chordal_io::{Format, Part, Scene, worst_snap};

/// The most that rounding to a format moves a point of a scene, given the stretch of each part.
pub(crate) fn worst_rounding(scene: &Scene, stretch: &[f64], to: Format) -> f64 {
    scene.parts.iter().zip(stretch).fold(0.0, |most, (part, stretch)| {
        let lost = scaled_up(part_rounding(part, to), *stretch);
        greater(lost, most)
    })
}

/// The most that rounding to a format moves a point of a part. glTF stores what skins and morph targets deform
/// about no origin of its own.
pub(crate) fn part_rounding(part: &Part, to: Format) -> f64 {
    worst_snap(&part.mesh.bounds(), if part.is_deformed() && to.has_nodes() { Format::Stl } else { to })
}
