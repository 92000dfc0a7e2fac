//! `Volume`: samples on a lattice in the space of their file, and what the readers of such files share.
pub(crate) mod count;
pub(crate) mod element;
pub(crate) mod gunzip;
pub(crate) mod samples;
pub(crate) mod stream;

use crate::Frame;
use chordal::implicit::Grid;
use serde_json::Value;

/// What a file of samples says.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    /// The samples and where they are. The numbers are those of the file; NaN is kept.
    pub grid: Grid,
    /// The space.
    pub frame: Frame,
    /// What the file calls it, or empty.
    pub name: String,
    /// What the axes of space are called, where the file says: "RAS" for axes to the patient's right, front
    /// and head, "LPS" for left, back and head. Coordinates are the file's own: nothing is turned.
    pub space: Option<String>,
    /// The certificate that travels in the file, if it carries one.
    pub certificate: Option<Value>,
}

impl Volume {
    /// A grid in an unknown space.
    #[must_use]
    pub fn from_grid(grid: Grid) -> Self {
        Self { grid, frame: Frame::default(), name: String::new(), space: None, certificate: None }
    }
}

/// A name as a header holds it: up to its first NUL, without spaces at its ends and control characters.
pub(crate) fn name_of(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len());
    let text = String::from_utf8_lossy(&bytes[..end]);
    text.trim().chars().filter(|c| !c.is_control()).collect()
}
