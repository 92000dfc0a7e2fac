//! `BakeOptions`: the options of `bake`, its lattice and its budget.
use super::values::{count_up_to, length};
use super::{COUNT, LENGTH, OptionRow, OptionSection, OptionTable, OptionValues, store_some};
use crate::{BakeResolution, BakeSpec};
use chordal_io::Format;

/// A request for distances on a lattice.
#[derive(Clone, Copy, Debug, Default)]
pub struct BakeOptions {
    /// The format of the result, if it is named.
    pub to: Option<Format>,
    /// Whether the best result is kept if the budget is not met.
    pub keep_best: bool,
    resolution: Option<BakeResolution>,
    band: Option<f64>,
    is_sparse: bool,
    is_bounded: bool,
}

impl BakeOptions {
    /// The request, if it has a resolution.
    #[must_use]
    pub fn spec(&self) -> Option<BakeSpec> {
        let Self { resolution, band, is_sparse, is_bounded, .. } = *self;
        resolution.map(|resolution| BakeSpec { resolution, band, is_sparse, is_bounded })
    }
}

/// The group of the options that choose the number of cells.
const RESOLUTION: &[&str] = &["resolution"];
/// The most cells along the longest side. Chosen: beyond any machine's memory, and so a slip.
const MOST_CELLS: u64 = 1_000_000;
/// The widest band, in cells: none is wider than the lattice.
const WIDEST_BAND: f64 = MOST_CELLS as f64;

impl OptionTable for BakeOptions {
    const REQUIRED_GROUP: Option<&'static str> = Some("resolution");

    const ROWS: &'static [OptionRow<Self>] = &[
        OptionRow::<Self>::new(
            "to",
            (OptionValues::Text, "FORMAT"),
            "Output format, npy or nrrd, if not the one that the file name implies",
            |options, text| store_some(&mut options.to, text.parse()),
        )
        .under(OptionSection::Verb)
        .without_keyword(),
        OptionRow::<Self>::new(
            "cells",
            COUNT,
            "Number of cells along the longest side of the bounding box, without the margin",
            |options, text| {
                let cells = usize::try_from(count_up_to(text, MOST_CELLS)?);
                store_some(&mut options.resolution, cells.map(BakeResolution::Cells))
            },
        )
        .in_groups(RESOLUTION)
        .conflicts(&["tol"])
        .under(OptionSection::Verb),
        OptionRow::<Self>::new(
            "tol",
            LENGTH,
            "As many cells as it takes to prove that the zero surface of the samples' interpolant is within this length of \
             the shape: 0.01, 0.1mm, or 0.1% of the diagonal of its bounding box",
            |options, text| store_some(&mut options.resolution, length(text).map(BakeResolution::Within)),
        )
        .in_groups(RESOLUTION)
        .under(OptionSection::Verb),
        OptionRow::<Self>::flag(
            "keep-best",
            "If {tol} is not met, write the best result; the exit code is still 5",
            |options, _| {
                options.keep_best = true;
                Ok(())
            },
        )
        .needs("tol")
        .under(OptionSection::Verb)
        .without_keyword(),
        OptionRow::<Self>::new(
            "band",
            (OptionValues::Number, "W"),
            "Exact distances only within W cells of the surface; elsewhere the width of this band, with a sign",
            |options, text| store_some(&mut options.band, band(text)),
        )
        .under(OptionSection::Verb),
        OptionRow::<Self>::flag(
            "sparse",
            "Store only the band, in memory and in the file: for grids that would not fit into memory",
            |options, _| {
                options.is_sparse = true;
                Ok(())
            },
        )
        .needs("band")
        .under(OptionSection::Verb)
        .without_keyword(),
        OptionRow::<Self>::flag(
            "bound",
            "Prove how far the zero surface of the samples' interpolant is from the shape, so that bounds of later results \
             include it; {tol} always does",
            |options, _| {
                options.is_bounded = true;
                Ok(())
            },
        )
        .under(OptionSection::Verb),
    ];
}

fn band(text: &str) -> Result<f64, &'static str> {
    let width = text.parse::<f64>().ok().filter(|width| *width > 0.0 && *width <= WIDEST_BAND);
    width.ok_or("a band is a number of cells, above 0 and at most a million")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_has_a_resolution() {
        let mut options = BakeOptions::default();
        options.set("band", "3").expect("a width");
        assert!(options.spec().is_none());
        options.set("cells", "8").expect("a number of cells");
        let spec = options.spec().expect("cells are given");
        assert_eq!((spec.resolution, spec.band), (BakeResolution::Cells(8), Some(3.0)));
    }

    #[test]
    fn values_without_sense_are_refused_by_their_option() {
        for (name, text) in
            [("cells", "0"), ("cells", "1000001"), ("tol", "-1"), ("band", "0"), ("band", "nan")]
        {
            assert!(BakeOptions::default().set(name, text).is_err(), "{name} {text}");
        }
    }
}
