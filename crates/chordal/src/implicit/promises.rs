//! `Promises`: unchecked statements of a field's author.
use crate::budget::Evidence;
use std::sync::Arc;

/// The most sentences kept for one field. Chosen: more than anybody reads, and few enough to be copied with
/// every operation on the field.
const MOST: usize = 32;
/// Replaces the sentences that are left out.
const FURTHER: &str = "further promises about parts of the field hold, which are too many to be listed";

/// The sentences that proofs about a field depend on, without duplicates, in alphabetical order.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Promises(Vec<Arc<str>>);

impl Promises {
    /// Adds a sentence.
    pub fn add(&mut self, sentence: Arc<str>) {
        if let Err(at) = self.0.binary_search(&sentence) {
            self.0.insert(at, sentence);
            self.limit();
        }
    }

    /// Adds the sentences of another field.
    pub fn extend(&mut self, other: &Self) {
        other.0.iter().for_each(|sentence| self.add(Arc::clone(sentence)));
    }

    /// Drops the last sentences if there are too many, and adds [`FURTHER`].
    fn limit(&mut self) {
        if self.0.len() > MOST {
            self.0.retain(|sentence| **sentence != *FURTHER);
            self.0.truncate(MOST - 1);
            let at = self.0.binary_search_by(|sentence| (**sentence).cmp(FURTHER)).unwrap_or_else(|gap| gap);
            self.0.insert(at, FURTHER.into());
        }
    }

    /// The evidence of a proof that depends on them.
    pub fn evidence(&self) -> Evidence {
        if self.0.is_empty() {
            return Evidence::Proved;
        }
        Evidence::ProvedIf(self.0.iter().map(ToString::to_string).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_each_promise_once_and_says_when_there_are_more() {
        let mut promises = Promises::default();
        assert_eq!(promises.evidence(), Evidence::Proved);
        for sentence in ["b holds", "a holds", "b holds"] {
            promises.add(sentence.into());
        }
        assert_eq!(promises.evidence(), Evidence::ProvedIf(vec!["a holds".into(), "b holds".into()]));
        let mut many = Promises::default();
        (0..100).for_each(|k| many.add(format!("number {k:03} holds").into()));
        promises.extend(&many);
        let Evidence::ProvedIf(sentences) = promises.evidence() else { panic!("there are promises") };
        assert_eq!(sentences.len(), MOST);
        assert!(sentences.iter().any(|sentence| sentence == FURTHER));
    }
}
