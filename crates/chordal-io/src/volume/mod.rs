//! `Volume`: samples on a lattice in the space of their file, and the shared parts of volume readers.
pub(crate) mod count;
pub(crate) mod data_files;
pub(crate) mod element;
pub(crate) mod inflate;
pub(crate) mod label_table;
pub(crate) mod samples;
pub(crate) mod stream;
pub(crate) mod text_bytes;

use crate::Frame;
use chordal::implicit::Grid;
use label_table::LabelLook;
use serde_json::Value;
use std::collections::BTreeMap;

/// A volume with the other data of its file.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    /// The samples and their positions. The numbers are those of the file; NaN is kept.
    pub grid: Grid,
    /// The coordinate frame.
    pub frame: Frame,
    /// The name in the file, or empty.
    pub name: String,
    /// The names of the axes of space, if the file has them: "RAS" for axes to the patient's right, front and
    /// head, "LPS" for left, back and head. Coordinates are the file's own: nothing is rotated.
    pub space: Option<String>,
    /// The names and colours that the file gives to labels, by their number.
    pub labels: BTreeMap<i64, LabelLook>,
    /// The certificate in the file, if it carries one.
    pub certificate: Option<Value>,
}

impl Volume {
    /// A grid in an unknown space.
    #[must_use]
    pub fn from_grid(grid: Grid) -> Self {
        Self {
            grid,
            frame: Frame::default(),
            name: String::new(),
            space: None,
            labels: BTreeMap::new(),
            certificate: None,
        }
    }
}

/// A name in a header: up to its first NUL, trimmed and without control characters.
pub(crate) fn name_of(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len());
    let text = String::from_utf8_lossy(&bytes[..end]);
    text.trim().chars().filter(|c| !c.is_control()).collect()
}
