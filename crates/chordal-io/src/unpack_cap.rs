//! `UnpackCap`: how much packed bytes may unpack to, before they count as a bomb.
use crate::text::grouped;

/// The most that is unpacked, where [`crate::Limits`] allow it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UnpackCap {
    /// The most bytes of one entry, and of all together.
    pub entry: u64,
    pub total: u64,
    /// The most unpacked bytes for one packed byte, beyond a size up to which the ratio does not matter.
    pub ratio: u64,
    pub small: u64,
}

impl UnpackCap {
    /// For meshes, drawings and texts.
    pub(crate) const MODEL: Self = Self {
        // Chosen: seven times the largest single part that a tool was reported to fail on, which has 76 MB, and
        // about six million triangles.
        entry: 512 << 20,
        total: 1 << 30,
        // Measured on models: 4 to 12; nothing but a bomb comes near.
        ratio: 200,
        // A small part of few different bytes is harmless.
        small: 16 << 20,
    };

    /// For samples, which may be nearly constant.
    pub(crate) const VOLUME: Self = Self {
        entry: u64::MAX,
        total: u64::MAX,
        // The format's own maximum is 1,032 (RFC 1951: 258 bytes by two bits); only nearly constant samples come
        // close to it.
        ratio: 1_000,
        // Chosen: 1024³ labels of a byte, so that a mask of one organ is read whatever its ratio.
        small: 1 << 30,
    };

    /// Whether `size` bytes are too many for so many packed ones.
    pub(crate) fn is_too_dense(&self, size: u64, packed: u64) -> bool {
        size > self.small && size > self.ratio.saturating_mul(packed)
    }

    /// What is said of bytes that are too dense.
    pub(crate) fn too_dense(&self, packed: u64) -> String {
        format!("unpacks to more than {} times its {} bytes", self.ratio, grouped(packed))
    }
}
