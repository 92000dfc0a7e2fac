//! The options that say which surface of a volume is meant.
use super::values::word;
use super::{OptionRow, OptionSection, OptionTable, OptionValues, store_some};
use crate::{Border, Inside, LabelSelection, Shape, SurfaceSpec};

const SIDES: OptionValues =
    OptionValues::Words(&[("high", "Those above the isovalue"), ("low", "Those below the isovalue")]);

impl OptionTable for SurfaceSpec {
    const ROWS: &'static [OptionRow<Self>] = &[
        OptionRow::<Self>::new(
            "iso",
            (OptionValues::Number, "LEVEL"),
            "Isovalue of the surface. Default: 0.5 for masks and occupancies, 0 for signed distances",
            |surface, text| store_some(&mut surface.level, level(text)),
        )
        .conflicts(&["labels"])
        .under(OptionSection::Volumes),
        OptionRow::<Self>::new(
            "inside",
            (SIDES, "SIDE"),
            "Which samples are inside: those above the isovalue, or those below it as in distances",
            |surface, text| {
                store_some(&mut surface.inside, word(text, &[("high", Inside::High), ("low", Inside::Low)]))
            },
        )
        .conflicts(&["labels"])
        .under(OptionSection::Volumes),
        OptionRow::<Self>::new(
            "labels",
            (OptionValues::Text, "LABELS"),
            "Treat samples as labels: one part for each label but 0 (\"all\"), or of a list, e.g. 1,2,10",
            |surface, text| store_some(&mut surface.labels, labels(text)),
        )
        .under(OptionSection::Volumes),
        OptionRow::<Self>::new(
            "smooth",
            (OptionValues::Text, "SIGMA"),
            "Smooth a mask with a Gaussian of this standard deviation, a length or e.g. 0.8vox; the bound is the distance to \
             the unsmoothed mask",
            |surface, text| store_some(&mut surface.smooth, text.parse()),
        )
        .conflicts(&["labels", "iso"])
        .under(OptionSection::Volumes),
        OptionRow::<Self>::flag(
            "cap",
            "Close the surface where it reaches the border of the volume (default)",
            |surface, _| {
                surface.border = Border::Capped;
                Ok(())
            },
        )
        .conflicts(&["open"])
        .under(OptionSection::Volumes)
        .without_keyword(),
        OptionRow::<Self>::flag("open", "Leave the surface open where it reaches the border of the volume", |surface, _| {
            surface.border = Border::Open;
            Ok(())
        })
        .under(OptionSection::Volumes)
        .renamed("border"),
    ];
}

/// The refusal of an option for volumes, as a front end spells it, for another shape.
#[must_use]
pub fn not_a_volume(option: &str, shape: &Shape) -> String {
    format!("{option} is for volumes, and the input holds {}", shape.kind())
}

fn level(text: &str) -> Result<f64, &'static str> {
    text.parse::<f64>().ok().filter(|level| level.is_finite()).ok_or("a level is a finite number")
}

fn labels(text: &str) -> Result<LabelSelection, &'static str> {
    if text == "all" {
        return Ok(LabelSelection::All);
    }
    let label = |part: &str| part.trim().parse::<i64>().map_err(|_| "labels read like 1,2,10, or all");
    text.split(',').map(label).collect::<Result<_, _>>().map(LabelSelection::Listed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_levels_and_labels() {
        assert_eq!(level("-0.5"), Ok(-0.5));
        assert!(level("nan").is_err() && level("inf").is_err() && level("x").is_err());
        assert_eq!(labels("all"), Ok(LabelSelection::All));
        assert_eq!(labels("3, 1,-2"), Ok(LabelSelection::Listed(vec![3, 1, -2])));
        for text in ["", "1,", "1.5", "none"] {
            assert!(labels(text).is_err(), "{text}");
        }
    }
}
