//! `UnpackCap`: the size that packed bytes may unpack to before they count as a bomb.
use crate::text::grouped;

/// The most bytes that are unpacked, if [`crate::Limits`] allow as many.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UnpackCap {
    /// The most bytes of one entry, and of all entries together.
    pub entry: u64,
    pub total: u64,
    /// The most unpacked bytes per packed byte. Up to the size `small` the ratio is not checked.
    pub ratio: u64,
    pub small: u64,
}

impl UnpackCap {
    /// For meshes, drawings and texts.
    pub(crate) const MODEL: Self = Self {
        // Chosen: seven times the largest part for which a failure of another tool was reported (76 MB), and
        // about six million triangles.
        entry: 512 << 20,
        total: 1 << 30,
        // Measured: models have 4 to 12; only bombs come near.
        ratio: 200,
        // Chosen: a small part with few distinct bytes is harmless.
        small: 16 << 20,
    };

    /// For samples, which may be nearly constant.
    pub(crate) const VOLUME: Self = Self {
        entry: u64::MAX,
        total: u64::MAX,
        // The format's own maximum is 1,032 (RFC 1951: 258 bytes by two bits); only nearly constant samples come
        // close to it.
        ratio: 1_000,
        // Chosen: 1024³ labels of one byte, so that the mask of one organ is read whatever its ratio.
        small: 1 << 30,
    };

    /// Whether `size` unpacked bytes are too many for `packed` bytes.
    pub(crate) fn is_too_dense(&self, size: u64, packed: u64) -> bool {
        size > self.small && size > self.ratio.saturating_mul(packed)
    }

    /// The message for data that is too dense.
    pub(crate) fn too_dense(&self, packed: u64) -> String {
        format!("unpacks to more than {} times its {} bytes", self.ratio, grouped(packed))
    }
}
