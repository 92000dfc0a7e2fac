//! `ColorRamp`: the colours of a distance, from none to the largest.
use super::color::srgb_to_linear;
use glam::DVec3;

/// Colours from distance 0 to the largest, in sRGB. Each is darker than the one before, so they differ in
/// greyscale too.
pub(super) const COLORS: [[u8; 3]; 5] =
    [[240, 242, 243], [250, 213, 92], [237, 122, 46], [176, 42, 74], [62, 14, 92]];

/// The colours in linear light.
pub(super) struct ColorRamp([DVec3; COLORS.len()]);

impl ColorRamp {
    pub fn new() -> Self {
        Self(COLORS.map(srgb_to_linear))
    }

    /// The colour at a fraction of the way from the first to the last, 0 to 1.
    pub fn at(&self, share: f64) -> DVec3 {
        let step = share * (COLORS.len() - 1) as f64;
        let below = (step as usize).min(COLORS.len() - 2);
        self.0[below].lerp(self.0[below + 1], step - below as f64)
    }
}
