//! `manifest.jsonl`: one line for each processed file of a batch, in the order of completion.
use crate::fault::{Fault, plainly};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// The name of the file in the output folder.
pub const MANIFEST: &str = "manifest.jsonl";

/// The record of one file of a batch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ManifestEntry {
    /// The relative path of the input.
    pub input: String,
    /// The SHA-256 of the input; `None` if it could not be read.
    pub input_sha256: Option<String>,
    /// The version of the program.
    pub version: String,
    /// The verb and its options.
    pub words: Vec<String>,
    /// The path of the output below the output folder.
    pub output: String,
    /// The SHA-256 of the output; `None` without an output.
    pub output_sha256: Option<String>,
    /// The exit code; `None` if the process was killed.
    pub exit: Option<i32>,
    /// The duration.
    pub seconds: f64,
    /// The upper bound of the error, if it is known.
    pub bound: Option<f64>,
    /// The triangles of the input, if it has any.
    pub triangles_in: Option<u64>,
    /// The triangles of the output, if it has any.
    pub triangles_out: Option<u64>,
    /// The stable code of the error, if there is one.
    pub code: Option<String>,
    /// The error, as a sentence.
    pub error: Option<String>,
}

impl ManifestEntry {
    /// The line, without its end.
    fn to_line(&self) -> String {
        json!({
            "input": self.input,
            "input_sha256": self.input_sha256,
            "version": self.version,
            "words": self.words,
            "output": self.output,
            "output_sha256": self.output_sha256,
            "exit": self.exit,
            "seconds": self.seconds,
            "bound": self.bound,
            "triangles_in": self.triangles_in,
            "triangles_out": self.triangles_out,
            "code": self.code,
            "error": self.error,
        })
        .to_string()
    }

    fn from_line(line: &str) -> Option<Self> {
        let value: Value = serde_json::from_str(line).ok()?;
        let text = |key: &str| value.get(key).and_then(Value::as_str).map(str::to_owned);
        let count = |key: &str| value.get(key).and_then(Value::as_u64);
        let words = value.get("words")?.as_array()?.iter();
        Some(Self {
            input: text("input")?,
            input_sha256: text("input_sha256"),
            version: text("version")?,
            words: words.map(|word| word.as_str().map(str::to_owned)).collect::<Option<_>>()?,
            output: text("output")?,
            output_sha256: text("output_sha256"),
            exit: value.get("exit").and_then(Value::as_i64).and_then(|exit| i32::try_from(exit).ok()),
            seconds: value.get("seconds").and_then(Value::as_f64).unwrap_or_default(),
            bound: value.get("bound").and_then(Value::as_f64),
            triangles_in: count("triangles_in"),
            triangles_out: count("triangles_out"),
            code: text("code"),
            error: text("error"),
        })
    }
}

/// The content of a manifest: the last entry of each input.
#[derive(Debug, Default)]
pub struct ManifestEntries {
    /// The entries by input.
    pub by_input: BTreeMap<String, ManifestEntry>,
    /// All outputs that were ever written.
    pub outputs: BTreeSet<String>,
    /// The number of invalid lines, without an incomplete last one, as a kill leaves it.
    pub n_wrong: u64,
    /// The number of bytes up to the end of the last complete line.
    whole_bytes: u64,
}

impl ManifestEntries {
    /// Reads a manifest; a missing one is empty.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn read(folder: &Path) -> Result<Self, Fault> {
        let path = folder.join(MANIFEST);
        let mut bytes = Vec::new();
        match File::open(&path).and_then(|mut file| file.read_to_end(&mut bytes)) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Self::default()),
            Err(error) => {
                return Err(Fault::input("unreadable", format!("{}: {}", path.display(), plainly(&error))));
            }
            Ok(_) => {}
        }
        Ok(Self::from_bytes(&bytes))
    }

    fn from_bytes(bytes: &[u8]) -> Self {
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
        let mut entries = Self { whole_bytes: whole as u64, ..Self::default() };
        for line in bytes[..whole].split(|byte| *byte == b'\n').filter(|line| !line.is_empty()) {
            match std::str::from_utf8(line).ok().and_then(ManifestEntry::from_line) {
                Some(entry) => {
                    if entry.output_sha256.is_some() {
                        entries.outputs.insert(entry.output.clone());
                    }
                    // A later line replaces an earlier one of the same input.
                    entries.by_input.insert(entry.input.clone(), entry);
                }
                None => entries.n_wrong += 1,
            }
        }
        entries
    }
}

/// A manifest that lines are appended to.
#[derive(Debug)]
pub struct Manifest {
    path: PathBuf,
    file: File,
}

impl Manifest {
    /// Opens the manifest of a folder for appending; an incomplete last line is cut off.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn open(folder: &Path, entries: &ManifestEntries) -> Result<Self, Fault> {
        let path = folder.join(MANIFEST);
        let open = || -> io::Result<File> {
            let mut file = OpenOptions::new().write(true).create(true).truncate(false).open(&path)?;
            // A line after half of one would be lost with it.
            file.set_len(entries.whole_bytes)?;
            file.seek(SeekFrom::End(0))?;
            Ok(file)
        };
        let file = open().map_err(|error| unwritable(&path, &error))?;
        Ok(Self { path, file })
    }

    /// Appends a line and syncs it to disk.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn append(&mut self, entry: &ManifestEntry) -> Result<(), Fault> {
        let line = entry.to_line() + "\n";
        // Synced before the output is put in place: an output without its line would be taken for a
        // foreign file.
        let written = self.file.write_all(line.as_bytes()).and_then(|()| self.file.sync_data());
        written.map_err(|error| unwritable(&self.path, &error))
    }
}

fn unwritable(path: &Path, error: &io::Error) -> Fault {
    Fault::output("unwritable", format!("{}: {}", path.display(), plainly(error)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Folder;

    fn entry(input: &str, exit: i32) -> ManifestEntry {
        ManifestEntry {
            input: input.to_owned(),
            version: "1".to_owned(),
            words: vec!["mesh".to_owned(), "--tol".to_owned(), "1\n".to_owned()],
            exit: Some(exit),
            bound: Some(0.1),
            ..ManifestEntry::default()
        }
    }

    #[test]
    fn what_is_written_reads_back_and_a_torn_line_is_cut_off() {
        let folder = Folder::new("batch-manifest");
        let empty = ManifestEntries::read(folder.as_ref()).unwrap();
        let mut manifest = Manifest::open(folder.as_ref(), &empty).unwrap();
        for (name, exit) in [("ä b", 5), ("c", 0), ("ä b", 0)] {
            manifest.append(&entry(name, exit)).unwrap();
        }
        let path = folder.path(MANIFEST);
        let whole = std::fs::read(&path).unwrap();
        assert_eq!(whole.iter().filter(|byte| **byte == b'\n').count(), 3);
        // Whatever part of a line a kill leaves, the lines before it are unchanged.
        for torn in [&whole[..7], b"{", b"\xff"] {
            std::fs::write(&path, [&whole, torn].concat()).unwrap();
            let read = ManifestEntries::read(folder.as_ref()).unwrap();
            assert_eq!((read.by_input.len(), read.n_wrong), (2, 0));
            assert_eq!(read.by_input["ä b"], entry("ä b", 0));
            drop(Manifest::open(folder.as_ref(), &read).unwrap());
            assert_eq!(std::fs::read(&path).unwrap(), whole);
        }
        assert_eq!(ManifestEntries::from_bytes(b"{}\nx\n").n_wrong, 2);
    }
}
