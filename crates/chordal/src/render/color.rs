//! Linear light to bytes and back: sRGB.
use glam::DVec3;
use std::sync::LazyLock;

/// The linear light of an sRGB colour with channels 0 to 255.
///
/// Source: IEC 61966-2-1.
pub(super) fn srgb_to_linear(srgb: [u8; 3]) -> DVec3 {
    DVec3::from(srgb.map(|byte| decoded(f64::from(byte))))
}

/// The linear light of a channel from 0 to 255.
fn decoded(channel: f64) -> f64 {
    let x = channel / 255.0;
    if x <= 0.040_45 { x / 12.92 } else { libm::pow((x + 0.055) / 1.055, 2.4) }
}

/// The sRGB byte of a channel of linear light.
pub(super) fn linear_to_srgb(light: f64) -> u8 {
    // The thresholds between bytes: a search among them is several times as fast as a power.
    static STARTS: LazyLock<[f64; 255]> =
        LazyLock::new(|| std::array::from_fn(|byte| decoded(byte as f64 + 0.5)));
    STARTS.partition_point(|start| *start <= light) as u8
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
