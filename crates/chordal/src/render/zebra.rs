//! Zebra stripes: the reflection of striped walls in the surface.
use super::color::srgb_to_linear;
use glam::DVec3;

/// Stripes from straight down to straight up. Chosen so that a ball shows some thirty.
const STRIPES: f64 = 16.0;
/// Light and dark stripes, in sRGB.
const COLORS: [[u8; 3]; 2] = [[250, 250, 246], [26, 32, 44]];

/// The colour of the stripe seen at a point with this unit normal, looking along a unit direction.
///
/// Stripes are as smooth as normals: across an edge they jump, where only tangent planes agree they bend, and
/// where curvatures agree they continue smoothly.
pub(super) fn zebra_color(normal: DVec3, direction: DVec3, up: DVec3) -> DVec3 {
    let facing = direction.dot(normal);
    let mirrored = direction - 2.0 * facing * normal;
    let height = STRIPES * 0.5 * (1.0 + mirrored.dot(up));
    let color = srgb_to_linear(COLORS[usize::from(height.floor() as i64 % 2 != 0)]);
    // Darker towards the silhouette, so that the shape is visible as well.
    color * (0.6 + 0.4 * facing.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_shows_both_halves_of_the_room_twice() {
        // Seen along y, a ball's mirror turns twice as fast as its normal: from the horizon down and back,
        // and up and back.
        let at = |k: i32| {
            let angle = std::f64::consts::PI * (f64::from(k) / 2000.0 - 0.5);
            zebra_color(DVec3::new(0.0, -angle.cos(), angle.sin()), DVec3::Y, DVec3::Z)
        };
        let is_dark = |k: i32| at(k).x < 0.3;
        let changes = (1..=2000).filter(|k| is_dark(*k) != is_dark(k - 1)).count();
        assert!((29..=33).contains(&changes), "{changes}");
        assert!(at(1000).x > 1.5 * at(1000 + 990).x || is_dark(1000) != is_dark(1990));
    }
}
