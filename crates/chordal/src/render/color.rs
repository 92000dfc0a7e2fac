//! Colours: linear light and sRGB bytes, samples with alpha, the backdrop, and the ramp of a distance.
use super::options::RenderStyle;
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

/// Colours of the backdrop at the top and the bottom of the picture, in sRGB.
const BACKDROP: [[u8; 3]; 2] = [[247, 249, 251], [219, 225, 232]];

/// The light of the backdrop, at the top and at the bottom.
pub(super) struct Backdrop {
    ends: [DVec3; 2],
    height: u32,
}

impl Backdrop {
    pub fn new(height: u32) -> Self {
        Self { ends: BACKDROP.map(srgb_to_linear), height }
    }

    /// The backdrop in row `y`, counted from the top of the picture.
    pub fn at(&self, y: u32) -> DVec3 {
        self.ends[0].lerp(self.ends[1], (f64::from(y) + 0.5) / f64::from(self.height))
    }
}

/// A premultiplied colour: colour times alpha, and alpha.
#[derive(Clone, Copy)]
pub(super) struct PremultipliedColor {
    pub color: DVec3,
    pub alpha: f64,
}

impl PremultipliedColor {
    pub const NOTHING: Self = Self { color: DVec3::ZERO, alpha: 0.0 };

    /// Adds a sample, clamped, since a glint brighter than white would spoil the smoothness of its outline.
    pub fn add(&mut self, sample: Self) {
        self.color += sample.color.clamp(DVec3::ZERO, DVec3::ONE);
        self.alpha += sample.alpha;
    }

    /// The bytes of the mean of `n` samples.
    pub fn bytes(&self, n: usize, show: RenderStyle) -> [u8; 4] {
        if self.alpha <= 0.0 {
            return [0; 4];
        }
        let [r, g, b] = (self.color / self.alpha).to_array();
        let encode = if show == RenderStyle::Normals { to_byte } else { linear_to_srgb };
        [encode(r), encode(g), encode(b), to_byte(self.alpha / n as f64)]
    }
}

/// Colours from distance 0 to the largest, in sRGB. Each is darker than the one before, so they differ in
/// greyscale too.
pub(super) const RAMP: [[u8; 3]; 5] =
    [[240, 242, 243], [250, 213, 92], [237, 122, 46], [176, 42, 74], [62, 14, 92]];

/// The colours in linear light.
pub(super) struct ColorRamp([DVec3; RAMP.len()]);

impl ColorRamp {
    pub fn new() -> Self {
        Self(RAMP.map(srgb_to_linear))
    }

    /// The colour at a fraction of the way from the first to the last, 0 to 1.
    pub fn at(&self, share: f64) -> DVec3 {
        let step = share * (RAMP.len() - 1) as f64;
        let below = (step as usize).min(RAMP.len() - 2);
        self.0[below].lerp(self.0[below + 1], step - below as f64)
    }
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
