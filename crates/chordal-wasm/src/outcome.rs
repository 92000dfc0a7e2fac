//! `Outcome`: the result of a call.
/// The result of a call: a file with its certificate, or an error; with `keep_best`, both.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    /// 0, or an exit code of the command.
    pub(crate) exit: u8,
    /// The file.
    pub(crate) bytes: Vec<u8>,
    /// The certificate, or the answer to a question, as JSON.
    pub(crate) report: Vec<u8>,
    /// The error, as one sentence.
    pub(crate) error: Vec<u8>,
}

impl Outcome {
    pub(crate) fn failed(exit: u8, error: impl ToString) -> Self {
        Self { exit, error: error.to_string().into_bytes(), ..Self::default() }
    }
}

/// The answer to a page's question, as the report of an outcome.
pub(crate) fn answer(answer: Result<serde_json::Value, String>) -> Outcome {
    match answer {
        Ok(answer) => Outcome { report: answer.to_string().into_bytes(), ..Outcome::default() },
        Err(error) => Outcome::failed(2, error),
    }
}
