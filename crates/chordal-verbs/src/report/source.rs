//! The script that a result was made from, as its file carries it: so that the file can be opened as the script again.
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// A script with all that it takes to run it again, apart from files that are no scripts: those are named, with digests.
///
/// Names are base names or paths below the script's folder, so that nothing shows where it was on its author's machine.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SourceFacts {
    /// The base name of its file, or `script.star` if it had none.
    pub name: String,
    /// The SHA-256 of its text, in hexadecimal: that of an input in the history.
    pub sha256: String,
    /// Its text.
    pub text: String,
    /// The parameters that were set, with their values.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub parameters: BTreeMap<String, f64>,
    /// The files that it read, in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<SourceFileFacts>,
}

/// A file that a carried script reads.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SourceFileFacts {
    /// Its path below the folder of the script.
    pub path: String,
    /// The SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
    /// Its text, if it is a script as well.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
}

/// The most bytes of a script and of the scripts that it loads, together. Chosen: as much as one script may have.
const MOST_TEXT: usize = 1 << 18;

impl SourceFacts {
    /// Whether it is short enough to be carried.
    pub(crate) fn fits(&self) -> bool {
        let loaded = self.files.iter().filter_map(|file| file.text.as_ref());
        self.text.len() + loaded.map(String::len).sum::<usize>() <= MOST_TEXT
    }
}

/// The scripts in a certificate.
pub(crate) fn sources_in(certificate: &Value) -> Vec<SourceFacts> {
    let sources = certificate.get("sources").cloned();
    sources.and_then(|sources| serde_json::from_value(sources).ok()).unwrap_or_default()
}
