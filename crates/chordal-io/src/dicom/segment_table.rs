//! `SegmentTable`: the names and colours of a segmentation's segments.
//!
//! Source: NEMA, *DICOM PS3.3*, 2024, C.8.20.
use super::attributes::{
    DicomAttributes, LARGEST_FRACTION, SEGMENT_COLOR, SEGMENT_LABEL, SEGMENT_NUMBER, SEGMENTATION_KIND,
    SEGMENTS,
};
use crate::ReadError;
use crate::volume::label_table::{LabelLook, MOST_ROWS};
use std::collections::BTreeMap;

/// The names and colours of segments, by their number.
#[derive(Clone, Debug, Default)]
pub(super) struct SegmentTable {
    looks: BTreeMap<i64, LabelLook>,
    /// Whether samples are numbers of segments, and not fractions of one.
    are_labels: bool,
    /// Whether a frame holds the numbers of all segments.
    pub is_map: bool,
    /// The sample that means 1, if samples are fractions.
    pub largest: Option<f64>,
}

impl SegmentTable {
    pub(super) fn read(file: &DicomAttributes<'_>) -> Result<Self, ReadError> {
        let mut looks = BTreeMap::new();
        for item in file.items(SEGMENTS)?.into_iter().take(MOST_ROWS) {
            let segment = DicomAttributes::read(item)?;
            if let Some(number) = segment.short(SEGMENT_NUMBER) {
                let name = crate::volume::name_of(segment.text(SEGMENT_LABEL).as_bytes());
                let color = segment.shorts(SEGMENT_COLOR).map(srgb);
                looks.insert(number as i64, LabelLook { name, color });
            }
        }
        let kind = file.text(SEGMENTATION_KIND);
        let largest = file.short(LARGEST_FRACTION).filter(|largest| kind == "FRACTIONAL" && *largest > 0);
        let are_labels = matches!(kind.as_str(), "BINARY" | "LABELMAP");
        let is_map = kind == "LABELMAP";
        Ok(Self { looks, are_labels, is_map, largest: largest.map(|largest| largest as f64) })
    }

    pub(super) fn is_empty(&self) -> bool {
        self.looks.is_empty()
    }

    /// The looks of the labels in the samples.
    pub(super) fn labels(&self) -> BTreeMap<i64, LabelLook> {
        if self.are_labels { self.looks.clone() } else { BTreeMap::new() }
    }
}

/// A colour in sRGB. The file has L*a*b* in 16 bits: L* from 0 to 100, the others from -128 to 127.
///
/// Source: NEMA, *DICOM PS3.3*, 2024, C.10.7.1.1; IEC 61966-2-1, 1999. The white is D65, as in other programs
/// that write such files.
fn srgb([l, a, b]: [u16; 3]) -> [f64; 3] {
    let part = |x: u16| f64::from(x) / 65535.0;
    let y = (100.0 * part(l) + 16.0) / 116.0;
    let (x, z) = (y + (255.0 * part(a) - 128.0) / 500.0, y - (255.0 * part(b) - 128.0) / 200.0);
    let linear = |t: f64| if t > 6.0 / 29.0 { t * t * t } else { 108.0 / 841.0 * (t - 4.0 / 29.0) };
    let (x, y, z) = (0.950_456 * linear(x), linear(y), 1.088_754 * linear(z));
    let channel = |x: f64| {
        let x = x.clamp(0.0, 1.0);
        if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * libm::pow(x, 1.0 / 2.4) - 0.055 }
    };
    [
        channel(3.240_479 * x - 1.537_15 * y - 0.498_535 * z),
        channel(-0.969_256 * x + 1.875_992 * y + 0.041_556 * z),
        channel(0.055_648 * x - 0.204_043 * y + 1.057_311 * z),
    ]
}
