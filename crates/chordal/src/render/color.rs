//! Linear light to bytes and back: sRGB.
use glam::DVec3;

/// The linear light of an sRGB colour with channels 0 to 255.
///
/// Source: IEC 61966-2-1.
pub(super) fn srgb_to_linear(srgb: [u8; 3]) -> DVec3 {
    DVec3::from(srgb.map(|byte| {
        let x = f64::from(byte) / 255.0;
        if x <= 0.040_45 { x / 12.92 } else { libm::pow((x + 0.055) / 1.055, 2.4) }
    }))
}

/// The sRGB byte of a channel of linear light.
pub(super) fn linear_to_srgb(light: f64) -> u8 {
    // 0.003_130_8 is where the two pieces of IEC 61966-2-1 meet.
    to_byte(if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * libm::pow(light, 1.0 / 2.4) - 0.055 })
}

/// Maps 0 … 1 to 0 … 255, rounded and clamped.
pub(super) fn to_byte(x: f64) -> u8 {
    (x * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_survive_light() {
        for value in 0..=255 {
            let light = srgb_to_linear([value; 3]);
            assert_eq!([light.x, light.y, light.z].map(linear_to_srgb), [value; 3]);
        }
        assert_eq!([-1.0, 2.0, f64::NAN].map(linear_to_srgb), [0, 255, 0]);
    }
}
