//! `LabelLook`: the name and colour that a file gives a label of its volume.
use crate::text::{LineTokens, number};
use std::collections::BTreeMap;

/// The properties of one label of a volume.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LabelLook {
    /// The name, or empty.
    pub name: String,
    /// The colour in sRGB, each channel from 0 to 1.
    pub color: Option<[f64; 3]>,
}

/// The most labels of a table. Chosen: as many as 16 bits can distinguish, more than any file has.
pub(crate) const MOST_ROWS: usize = 1 << 16;

/// A colour of three numbers from 0 to 1; `None` for any other text.
pub(crate) fn color(text: &[u8]) -> Option<[f64; 3]> {
    let mut channels = LineTokens::new(text).map(number);
    let color = [channels.next()??, channels.next()??, channels.next()??];
    let is_color = channels.next().is_none() && color.iter().all(|x| (0.0..=1.0).contains(x));
    is_color.then_some(color)
}

/// The segments of a header, by their number, as 3D Slicer writes them: `Segment0_Name`, `Segment0_Color`,
/// `Segment0_LabelValue` and `Segment0_Layer`.
///
/// Source: 3D Slicer, *Developer guide*, "Segmentation file format", 2021.
#[derive(Clone, Debug, Default)]
pub(crate) struct SegmentKeys(BTreeMap<u32, Segment>);

/// One segment.
#[derive(Clone, Debug, Default)]
struct Segment {
    look: LabelLook,
    value: Option<i64>,
    layer: u64,
}

impl SegmentKeys {
    /// Stores a header entry if its key belongs to a segment.
    pub(crate) fn take(&mut self, key: &[u8], value: &[u8]) {
        let Some((number, field)) = std::str::from_utf8(key)
            .ok()
            .and_then(|key| key.strip_prefix("Segment"))
            .and_then(|rest| rest.split_once('_'))
        else {
            return;
        };
        let Ok(number) = number.parse::<u32>() else { return };
        if !matches!(field, "Name" | "Color" | "LabelValue" | "Layer") {
            return;
        }
        if self.0.len() >= MOST_ROWS && !self.0.contains_key(&number) {
            return;
        }
        let segment = self.0.entry(number).or_default();
        let text = || std::str::from_utf8(value).unwrap_or("").trim();
        match field {
            "Name" => segment.look.name = super::name_of(value),
            "Color" => segment.look.color = color(value),
            "LabelValue" => segment.value = text().parse().ok(),
            _ => segment.layer = text().parse().unwrap_or(0),
        }
    }

    /// The labels of one layer. A segment without a label value comes from an older file, in which each
    /// segment has its own layer.
    pub(crate) fn labels(&self, layer: u64) -> BTreeMap<i64, LabelLook> {
        let of_layer = self.0.values().filter(|segment| segment.layer == layer);
        of_layer.filter_map(|segment| Some((segment.value?, segment.look.clone()))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_told_by_their_number_and_layer_and_what_is_no_field_of_one_is_left() {
        let mut keys = SegmentKeys::default();
        for (key, value) in [
            ("Segment1_Name", "Left lung"),
            ("Segment1_LabelValue", "7"),
            ("Segment1_Color", "0.5 0.25 1"),
            ("Segment0_LabelValue", "2"),
            ("Segment0_Layer", "1"),
            ("Segment2_Name", "no value"),
            ("Segmentation_Name", "x"),
            ("Segment3_Extent", "0 1 0 1 0 1"),
        ] {
            keys.take(key.as_bytes(), value.as_bytes());
        }
        let look = LabelLook { name: "Left lung".into(), color: Some([0.5, 0.25, 1.0]) };
        assert_eq!(keys.labels(0), BTreeMap::from([(7, look)]));
        assert_eq!(keys.labels(1), BTreeMap::from([(2, LabelLook::default())]));
        for wrong in ["", "1 1", "0 0 2", "0 0 nan", "0 0 0 0", "red green blue"] {
            assert_eq!(color(wrong.as_bytes()), None, "{wrong}");
        }
    }
}
