//! `Warnings`: the warnings of a reader, one entry for each code.
use crate::{FileLocation, Warning};
use chordal::budget::advice::Message;

/// Counted oddities in the order in which their codes first occurred.
#[derive(Debug, Default)]
pub(crate) struct Warnings {
    list: Vec<Warning>,
}

impl Warnings {
    /// Counts one occurrence of `code`. `first` returns the location and sentence, and is called only the
    /// first time.
    pub(crate) fn count<M: Into<Message>>(
        &mut self,
        code: &'static str,
        first: impl FnOnce() -> (FileLocation, M),
    ) {
        self.count_many(code, 1, first);
    }

    /// Counts `many` occurrences of `code`; does nothing for 0.
    pub(crate) fn count_many<M: Into<Message>>(
        &mut self,
        code: &'static str,
        many: u64,
        first: impl FnOnce() -> (FileLocation, M),
    ) {
        if many == 0 {
            return;
        }
        if let Some(known) = self.list.iter_mut().find(|w| w.code == code) {
            known.count = known.count.saturating_add(many);
            return;
        }
        let (place, message) = first();
        self.list.push(Warning { code, count: many, place, message: message.into() });
    }

    /// Counts `many` occurrences of `code` that have no location of their own.
    pub(crate) fn count_all(&mut self, code: &'static str, many: u64, message: &str) {
        self.count_many(code, many, || (FileLocation::File, message.to_owned()));
    }

    /// Whether a warning of this code was counted.
    pub(crate) fn has(&self, code: &str) -> bool {
        self.list.iter().any(|warning| warning.code == code)
    }

    pub(crate) fn append(&mut self, others: Self) {
        for Warning { code, count, place, message } in others.list {
            self.count_many(code, count, || (place, message));
        }
    }

    /// Returns the collected warnings.
    pub(crate) fn into_list(self) -> Vec<Warning> {
        self.list
    }
}
