//! `UsdaWriter`: statements of USD's text form, indented by their depth.
use crate::WriteError;
use crate::matrix::IDENTITY;
use crate::number::ShortestDecimal;
use std::collections::BTreeSet;
use std::io::{BufWriter, Write};

/// Writes a text.
pub(super) struct UsdaWriter<'a> {
    pub out: BufWriter<&'a mut dyn Write>,
    pub depth: usize,
}

/// The numbers in a line. Chosen: about 150 characters, short enough for editors.
const ROWS_OF_LINE: usize = 8;

impl<'a> UsdaWriter<'a> {
    pub(super) fn new(out: &'a mut dyn Write) -> Self {
        Self { out: BufWriter::new(out), depth: 0 }
    }

    /// Writes a line.
    pub(super) fn line(&mut self, text: &str) -> Result<(), WriteError> {
        for _ in 0..self.depth {
            self.out.write_all(b"    ")?;
        }
        self.out.write_all(text.as_bytes())?;
        Ok(self.out.write_all(b"\n")?)
    }

    /// Begins a prim: its kind, its name, and lines of metadata.
    pub(super) fn open(&mut self, kind: &str, name: &str, about: &[String]) -> Result<(), WriteError> {
        let between = if kind.is_empty() { "" } else { " " };
        self.line(&format!("def{between}{kind} \"{name}\"{}", if about.is_empty() { "" } else { " (" }))?;
        if !about.is_empty() {
            self.depth += 1;
            about.iter().try_for_each(|line| self.line(line))?;
            self.depth -= 1;
            self.line(")")?;
        }
        self.line("{")?;
        self.depth += 1;
        Ok(())
    }

    /// Ends a prim.
    pub(super) fn close(&mut self) -> Result<(), WriteError> {
        self.depth -= 1;
        self.line("}")
    }

    /// Writes an array of rows of `width` numbers, and the text after it.
    pub(super) fn rows(
        &mut self,
        start: &str,
        width: usize,
        values: impl Iterator<Item = f64>,
        end: &str,
    ) -> Result<(), WriteError> {
        for _ in 0..self.depth {
            self.out.write_all(b"    ")?;
        }
        write!(self.out, "{start} = [")?;
        for (at, value) in values.enumerate() {
            let (row, column) = (at / width, at % width);
            if column == 0 && row > 0 {
                self.out.write_all(if row % ROWS_OF_LINE == 0 { b",\n" } else { b", " })?;
            }
            if width > 1 {
                self.out.write_all(if column == 0 { b"(" } else { b", " })?;
            }
            write!(self.out, "{}", ShortestDecimal(value))?;
            if width > 1 && column + 1 == width {
                self.out.write_all(b")")?;
            }
        }
        self.out.write_all(b"]")?;
        self.out.write_all(end.as_bytes())?;
        Ok(self.out.write_all(b"\n")?)
    }
}

/// Numbers in brackets.
pub(super) fn tuple(values: &[f64]) -> String {
    let words: Vec<String> = values.iter().map(|x| ShortestDecimal(*x).to_string()).collect();
    format!("({})", words.join(", "))
}

/// A text in quotes.
pub(super) fn quoted(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 2);
    out.push('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => {
                out.push('\\');
                out.push(c);
            }
            '\n' => out.push_str("\\n"),
            '\r' => out.push_str("\\x0d"),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// The names of the children of one prim, each unique: letters, digits and `_`.
#[derive(Default)]
pub(super) struct UsdNames {
    taken: BTreeSet<String>,
}

impl UsdNames {
    /// A valid, unique name similar to `name`; `usual` if `name` is empty.
    pub(super) fn unique(&mut self, name: &str, usual: &str) -> String {
        let letter = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        let mut safe: String = name.chars().map(letter).collect();
        if safe.is_empty() {
            safe = usual.to_owned();
        }
        if safe.starts_with(|c: char| c.is_ascii_digit()) {
            safe.insert(0, '_');
        }
        let mut tried = safe.clone();
        // Not from 1: a thousand equal names would try a thousand numbers each.
        let mut number = self.taken.len();
        while !self.taken.insert(tried.clone()) {
            tried = format!("{safe}_{number}");
            number += 1;
        }
        tried
    }
}

/// The line with the display name, if it differs from the prim's name.
pub(super) fn display_name(name: &str, safe: &str) -> Vec<String> {
    if name == safe || name.is_empty() { Vec::new() } else { vec![format!("displayName = {}", quoted(name))] }
}

/// Writes the transform of a prim.
pub(super) fn transform(matrix: &[f64; 16], writer: &mut UsdaWriter<'_>) -> Result<(), WriteError> {
    if *matrix == IDENTITY {
        return Ok(());
    }
    let rows: Vec<String> = matrix.chunks_exact(4).map(tuple).collect();
    writer.line(&format!("matrix4d xformOp:transform = ({})", rows.join(", ")))?;
    writer.line("uniform token[] xformOpOrder = [\"xformOp:transform\"]")
}
