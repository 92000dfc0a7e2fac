//! `ConvertOptions`: the options of `convert`.
use super::values::length;
use super::{LENGTH, OptionRow, OptionSection, OptionTable, store_some};
use chordal::budget::Length;
use chordal_io::Format;

/// A request to write a shape in another format.
#[derive(Clone, Copy, Debug, Default)]
pub struct ConvertOptions {
    /// The format, if it is named.
    pub to: Option<Format>,
    /// The largest distance to curves that the format does not hold.
    pub length: Option<Length>,
    /// Whether the file gets the certificate of the input, which then has to hold for it.
    pub keeps_certificate: bool,
}

impl OptionTable for ConvertOptions {
    const ROWS: &'static [OptionRow<Self>] = &[
        OptionRow::<Self>::output_format(|options, text| store_some(&mut options.to, text.parse()))
            .under(OptionSection::Output),
        OptionRow::<Self>::new(
            "tol",
            LENGTH,
            "For a drawing with arcs or rational curves to .svg, which has only cubics: maximum distance to them; 0.1, 0.1mm, \
             or 0.05% of the diagonal of its bounding box. Lines and cubics do not change",
            |options, text| store_some(&mut options.length, length(text)),
        )
        .under(OptionSection::Output),
        OptionRow::<Self>::flag(
            "keep-certificate",
            "For triangles whose coordinates stay as they are: give the output the certificate of the input, instead of adding \
             a step to its history",
            |options, _| {
                options.keeps_certificate = true;
                Ok(())
            },
        )
        .under(OptionSection::Output)
        .without_keyword(),
    ];
}
