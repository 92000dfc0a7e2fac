//! `GlbWarnings`: warnings, each kind once with its first location and its count.
use crate::{FileLocation, Warning};
use chordal::budget::advice::Message;

/// The warnings so far.
#[derive(Default)]
pub(super) struct GlbWarnings {
    pub warnings: Vec<Warning>,
}

impl GlbWarnings {
    /// Counts one occurrence.
    pub fn add(&mut self, code: &'static str, place: FileLocation, message: impl Into<Message>) {
        self.add_many(code, 1, place, message);
    }

    /// Counts many occurrences; does nothing for 0.
    pub fn add_many(
        &mut self,
        code: &'static str,
        count: u64,
        place: FileLocation,
        message: impl Into<Message>,
    ) {
        if count == 0 {
            return;
        }
        match self.warnings.iter_mut().find(|warning| warning.code == code) {
            Some(known) => known.count += count,
            None => self.warnings.push(Warning { code, count, place, message: message.into() }),
        }
    }

    /// Adds another report.
    pub fn append(&mut self, other: Self) {
        for warning in other.warnings {
            self.add_many(warning.code, warning.count, warning.place, warning.message);
        }
    }
}
