//! `OutputForm`: a format, and how its numbers are stored if it is glTF.
use chordal_io::Format;
use chordal_io::glb::GltfPacking;

/// The form of a file that a verb writes: its format, and how its numbers are packed if that is glTF.
///
/// The rounding has to be known before a verb begins: the budget reserves it, and the bound covers it.
///
/// ```
/// use chordal_io::{Format, glb::GltfPacking};
/// use chordal_verbs::OutputForm;
/// let small = OutputForm { packing: GltfPacking { is_quantized: true, ..Default::default() }, ..Format::Glb.into() };
/// assert_eq!(OutputForm::from(Format::Glb).packing, GltfPacking::default());
/// assert!(small.packing.is_quantized);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutputForm {
    /// The format.
    pub format: Format,
    /// How glTF stores numbers; other formats have only one way.
    pub packing: GltfPacking,
}

impl From<Format> for OutputForm {
    fn from(format: Format) -> Self {
        Self { format, packing: GltfPacking::default() }
    }
}

impl OutputForm {
    /// Whether numbers are rounded to fewer bits than the format has by itself.
    pub(crate) fn is_quantized(self) -> bool {
        self.packing.is_quantized && self.format.is_gltf()
    }
}
