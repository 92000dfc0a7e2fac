//! The options of `deviation`: how precisely a distance is measured.
use super::values::{length, share};
use super::{LENGTH, OptionRow, OptionSection, OptionTable, OptionValues, store, store_some};
use crate::DeviationSpec;

impl OptionTable for DeviationSpec {
    const ROWS: &'static [OptionRow<Self>] = &[
        OptionRow::<Self>::new(
            "max",
            LENGTH,
            "Exit with code 1 unless the distance is proved to be at most this: 0.1, 0.1mm, or 0.05% of the diagonal of \
             AGAINST's bounding box. Stops as soon as that is decided",
            |spec, text| store_some(&mut spec.max, length(text)),
        )
        .under(OptionSection::Verb),
        OptionRow::<Self>::new(
            "relative",
            (OptionValues::Number, "SHARE"),
            "The largest gap between upper and lower bound, as a share of the lower one",
            |spec, text| store(&mut spec.relative, share(text)),
        )
        .default("0.1")
        .under(OptionSection::Verb),
        OptionRow::<Self>::new(
            "absolute",
            LENGTH,
            "The largest gap between upper and lower bound, as a length; meeting either limit is enough",
            |spec, text| store_some(&mut spec.absolute, length(text)),
        )
        .under(OptionSection::Verb),
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_those_that_help_names() {
        let mut defaults = DeviationSpec::default();
        for row in DeviationSpec::ROWS {
            row.default.map_or(Ok(()), |text| defaults.set(row.name, text)).expect("a default is a value");
        }
        assert_eq!(defaults, DeviationSpec::default());
    }

    #[test]
    fn a_share_is_no_less_than_0() {
        let mut spec = DeviationSpec::default();
        assert!(spec.set("relative", "0").is_ok());
        for text in ["-1", "inf", "nan", "x"] {
            assert!(spec.set("relative", text).is_err(), "{text}");
        }
    }
}
