//! `Warnings`: what a reader collects on its way, one entry a kind.
use crate::{Place, Warning};

/// Counted oddities in the order in which their kinds were first seen.
#[derive(Debug, Default)]
pub(crate) struct Warnings {
    list: Vec<Warning>,
}

impl Warnings {
    /// Counts one more of `code`; `first` tells place and sentence and is asked only the first time.
    pub(crate) fn count(&mut self, code: &'static str, first: impl FnOnce() -> (Place, String)) {
        self.count_many(code, 1, first);
    }

    /// Counts `many` more of `code`; nothing for 0.
    pub(crate) fn count_many(
        &mut self,
        code: &'static str,
        many: u64,
        first: impl FnOnce() -> (Place, String),
    ) {
        if many == 0 {
            return;
        }
        if let Some(known) = self.list.iter_mut().find(|w| w.code == code) {
            known.count = known.count.saturating_add(many);
            return;
        }
        let (place, message) = first();
        self.list.push(Warning { code, count: many, place, message });
    }

    /// Counts `many` of `code` that have no place of their own.
    pub(crate) fn count_all(&mut self, code: &'static str, many: u64, message: &str) {
        self.count_many(code, many, || (Place::File, message.to_owned()));
    }

    /// What was collected.
    pub(crate) fn into_list(self) -> Vec<Warning> {
        self.list
    }
}
