//! `Report`: warnings, each kind once with its first place and its count.
use crate::{Place, Warning};

/// What was odd.
#[derive(Default)]
pub(super) struct Report {
    pub warnings: Vec<Warning>,
}

impl Report {
    /// Counts one.
    pub fn add(&mut self, code: &'static str, place: Place, message: impl Into<String>) {
        self.add_many(code, 1, (place, message));
    }

    /// Counts many; nothing when there are none.
    pub fn add_many(&mut self, code: &'static str, count: u64, (place, message): (Place, impl Into<String>)) {
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
            self.add_many(warning.code, warning.count, (warning.place, warning.message));
        }
    }
}
