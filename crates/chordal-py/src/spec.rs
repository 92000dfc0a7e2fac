//! Requests, from the options that Python's keyword arguments stand for.
use crate::failure;
use crate::spelling::Keywords;
use chordal::budget::advice::{Message, Spell};
use chordal::budget::proof::ProofEffort;
use chordal_verbs::BudgetSpec;
use chordal_verbs::options::{MeshOptions, OptionTable, OptionValues};
use pyo3::prelude::*;
use std::str::FromStr;
use std::time::Duration;

/// Options that were given: the name of each, the keyword that it came from, and the text of its value, as
/// `python/chordal/_options.py` makes them.
pub(crate) type GivenOptions = Vec<(String, String, String)>;

/// How long a field is worked on.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Patience {
    /// After how long the best is taken, if that is said.
    pub within: Option<Duration>,
    /// How far its proof is taken.
    pub proof: ProofEffort,
}

/// The request that options make.
///
/// # Errors
/// `ValueError` for a word that an option does not know, and `BudgetError` for any other value without sense.
pub(crate) fn request<S: OptionTable>(py: Python<'_>, given: &GivenOptions) -> PyResult<S> {
    let mut request = S::default();
    for (option, keyword, text) in given {
        let is_word = S::row(option).is_some_and(|row| matches!(row.values, OptionValues::Words(_)));
        request.set(option, text).map_err(|why| {
            if is_word {
                failure::argument(keyword, why)
            } else {
                failure::budget(py, &format!("{keyword}: {why}"))
            }
        })?;
    }
    Ok(request)
}

/// A budget, and how long a field is worked on.
pub(crate) fn budget(py: Python<'_>, given: &GivenOptions) -> PyResult<(BudgetSpec, Patience)> {
    let options: MeshOptions = request(py, given)?;
    let spec = options.spec().map_err(|why| mismatch(py, why))?;
    Ok((spec, Patience { within: options.within, proof: options.proof() }))
}

/// Options that do not belong together.
pub(crate) fn mismatch(py: Python<'_>, why: Message) -> PyErr {
    failure::budget(py, &why.spelled(&Keywords).to_string())
}

/// What a text stands for that was given as the argument of that name.
pub(crate) fn parse_argument<T: FromStr<Err: std::fmt::Display>>(
    name: &str,
    text: Option<&str>,
) -> PyResult<Option<T>> {
    text.map(|text| text.parse().map_err(|error| failure::argument(name, error))).transpose()
}
