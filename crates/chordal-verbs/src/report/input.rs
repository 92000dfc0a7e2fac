//! The input in the report: its kind and format, the irregularities of its file, its frame.
use super::StepInput;
use super::message_text::message_text;
use crate::{Input, InputFile};
use chordal::budget::advice::Message;
use chordal_io::font::Letters;
use chordal_io::{Axis, Frame, Warning};
use serde::Serialize;
use std::collections::BTreeMap;

/// The input.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InputFacts {
    /// The kind of shape, as in "patches".
    pub kind: &'static str,
    /// The format of the bytes.
    pub format: String,
    /// The text that was set; only if the input is a font.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub letters: Option<LettersFacts>,
    /// The SHA-256 of the bytes, in hexadecimal; for a shape that was never a file, of its geometry or formula, `None` if
    /// it has no digest.
    pub sha256: Option<String>,
    /// The files beside it that were read, in the order of reading; only if there are any.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<InputFileFacts>,
    /// Irregularities in the bytes.
    pub warnings: Vec<WarningFacts>,
}

impl InputFacts {
    pub(crate) fn from_input(input: &Input) -> Self {
        Self {
            kind: input.shape.kind(),
            format: input.format.to_string(),
            letters: input.letters.as_ref().map(LettersFacts::new),
            sha256: input.sha256().map(str::to_owned),
            files: input.files.iter().map(InputFileFacts::new).collect(),
            warnings: input.warnings.iter().map(WarningFacts::new).collect(),
        }
    }

    /// The facts of the input for the history of a result.
    pub(crate) fn of_step(&self) -> StepInput {
        StepInput {
            kind: self.kind.to_owned(),
            format: self.format.clone(),
            sha256: self.sha256.clone(),
            files: self.files.iter().map(|file| file.sha256.clone()).collect(),
        }
    }
}

/// The text that a font has set.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LettersFacts {
    /// The text.
    pub text: String,
    /// The length of the em.
    pub em: f64,
    /// The positions on the font's axes, as far as they were given.
    pub axes: BTreeMap<String, f64>,
}

impl LettersFacts {
    fn new(letters: &Letters) -> Self {
        Self { text: letters.text.clone(), em: letters.em, axes: letters.axes.iter().cloned().collect() }
    }
}

/// A file beside the input that was read with it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct InputFileFacts {
    /// Its path below the folder of the input.
    pub path: String,
    /// The SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
}

impl InputFileFacts {
    fn new(file: &InputFile) -> Self {
        Self { path: file.path.clone(), sha256: file.sha256.clone() }
    }
}

/// An irregularity of a file, counted.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct WarningFacts {
    /// A stable code, for programs.
    pub code: &'static str,
    /// How often it occurs.
    pub count: u64,
    /// Its first position.
    pub place: String,
    /// One sentence.
    #[serde(serialize_with = "message_text")]
    pub message: Message,
}

impl WarningFacts {
    fn new(warning: &Warning) -> Self {
        Self {
            code: warning.code,
            count: warning.count,
            place: warning.place.to_string(),
            message: warning.message.clone(),
        }
    }
}

/// The frame of lengths and points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrameFacts {
    /// The up axis, "y" or "z", if it is known.
    pub up: Option<&'static str>,
    /// The length of one unit in metres, if it is known.
    pub metres_per_unit: Option<f64>,
}

impl FrameFacts {
    pub(crate) fn new(frame: &Frame) -> Self {
        Self { up: frame.up.map(Axis::letter), metres_per_unit: frame.metres_per_unit }
    }
}
