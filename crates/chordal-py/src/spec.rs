//! Requests from Python's keyword arguments.
use crate::failure;
use crate::spelling::Keywords;
use chordal::budget::advice::{Message, Spell};
use chordal::budget::proof::ProofEffort;
use chordal_verbs::BudgetSpec;
use chordal_verbs::options::{MeshOptions, OptionTable, OptionValues};
use pyo3::prelude::*;
use std::str::FromStr;
use std::time::Duration;

/// The given options: the name of each, the keyword that it came from, and its value as text, as
/// `python/chordal/_options.py` builds them.
pub(crate) type GivenOptions = Vec<(String, String, String)>;

/// The limits of the work on a field.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Patience {
    /// The time after which the best result so far is taken, if given.
    pub within: Option<Duration>,
    /// The effort of the proof.
    pub proof: ProofEffort,
}

/// The request for some options.
///
/// # Errors
/// `ValueError` for an unknown word, and `BudgetError` for any other invalid value.
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

/// A budget, and the limits of the work on a field.
pub(crate) fn budget(py: Python<'_>, given: &GivenOptions) -> PyResult<(BudgetSpec, Patience)> {
    let options: MeshOptions = request(py, given)?;
    let spec = options.spec().map_err(|why| mismatch(py, why))?;
    Ok((spec, Patience { within: options.within, proof: options.proof() }))
}

/// The error for options that do not fit together.
pub(crate) fn mismatch(py: Python<'_>, why: Message) -> PyErr {
    failure::budget(py, &why.spelled(&Keywords).to_string())
}

/// Parses the text of an argument.
pub(crate) fn parse_argument<T: FromStr<Err: std::fmt::Display>>(
    name: &str,
    text: Option<&str>,
) -> PyResult<Option<T>> {
    text.map(|text| text.parse().map_err(|error| failure::argument(name, error))).transpose()
}
