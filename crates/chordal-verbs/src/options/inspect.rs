//! `InspectOptions`: the options of `inspect`, as far as they say what is looked for.
use super::{OptionRow, OptionSection, OptionTable};

/// A request to inspect a shape.
#[derive(Clone, Copy, Debug, Default)]
pub struct InspectOptions {
    /// Whether triangles that cross, overlap or touch are looked for.
    pub self_intersections: bool,
}

impl OptionTable for InspectOptions {
    const ROWS: &'static [OptionRow<Self>] = &[OptionRow::<Self>::flag(
        "self-intersections",
        "Find triangles that cross, overlap or touch without being neighbours: exactly, in seconds for millions",
        |options, _| {
            options.self_intersections = true;
            Ok(())
        },
    )
    .under(OptionSection::Verb)
    .without_keyword()];
}
