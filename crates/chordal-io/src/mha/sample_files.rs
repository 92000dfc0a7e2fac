//! `SampleFiles`: the location of a MetaImage's samples: after the header, in a file, or in one file per
//! slice.
use super::fields::{LAST_KEY, MetaField, MetaFields};
use crate::text::{TextLines, grouped, integer, trim};
use crate::{FileLocation, Limits, ReadError};

/// A file of samples, and the line with its name.
pub(super) struct SampleFile {
    pub name: String,
    pub line: u64,
}

impl SampleFile {
    pub(super) fn place(&self) -> FileLocation {
        FileLocation::Line(self.line)
    }
}

/// The files of samples.
pub(super) enum SampleFiles {
    /// After the header.
    Local,
    /// All in one file.
    One(SampleFile),
    /// The same number of samples in each.
    Each(Vec<SampleFile>),
}

/// The header, and the limits on file names.
pub(super) struct SampleFileNames<'h, 'a> {
    pub bytes: &'a [u8],
    pub fields: &'h MetaFields<'a>,
    pub sizes: &'h [i64],
    pub limits: &'h Limits,
}

impl SampleFileNames<'_, '_> {
    /// Reads the last field, and the names after it.
    ///
    /// # Errors
    /// If there are fewer or more names than files.
    pub(super) fn read(&self) -> Result<SampleFiles, ReadError> {
        let field = self.fields.need(LAST_KEY)?;
        let value = field.text()?;
        let words: Vec<&str> = value.split_whitespace().collect();
        match words.as_slice() {
            [] => Err(field.wrong("ElementDataFile names no file")),
            [word] if word.eq_ignore_ascii_case("LOCAL") => Ok(SampleFiles::Local),
            ["LIST", axes @ ..] => self.list(&field, axes).map(SampleFiles::Each),
            [pattern, numbers @ ..] if pattern.contains('%') => {
                let numbers: Result<Vec<i64>, _> =
                    numbers.iter().map(|word| integer(word.as_bytes())).collect();
                let numbers = numbers.map_err(|_| field.wrong("a pattern of names has numbers after it"))?;
                self.pattern(&field, pattern, &numbers).map(SampleFiles::Each)
            }
            _ => Ok(SampleFiles::One(SampleFile { name: value.to_owned(), line: field.line })),
        }
    }

    /// The number of files that each hold the first `axes` axes.
    fn n_files(&self, field: &MetaField<'_>, axes: usize) -> Result<u64, ReadError> {
        let mut sizes = self.sizes[axes..].iter().map(|n| u64::try_from(*n).ok());
        let n = sizes.try_fold(1_u64, |all, n| all.checked_mul(n?));
        n.filter(|n| *n <= self.limits.rows).ok_or_else(|| field.wrong("more files than can be counted"))
    }

    /// The names in the lines after `LIST`, or `LIST 2D` with the number of axes in each file.
    fn list(&self, field: &MetaField<'_>, axes: &[&str]) -> Result<Vec<SampleFile>, ReadError> {
        let n_axes = self.sizes.len();
        let each = match axes {
            [] => n_axes - 1,
            [word] => {
                let digits = word.strip_suffix(['D', 'd']).unwrap_or(word);
                let n = integer(digits.as_bytes()).ok().and_then(|n| usize::try_from(n).ok());
                n.filter(|n| (1..=n_axes).contains(n))
                    .ok_or_else(|| field.wrong(format!("LIST {word} is no number of axes")))?
            }
            _ => return Err(field.wrong(format!("{} is no list of files", field.shown()))),
        };
        let declared = self.n_files(field, each)?;
        let mut files = Vec::new();
        let lines = TextLines::new(&self.bytes[self.fields.end..]).map(|(line, text)| (line, trim(text)));
        for (line, text) in lines.filter(|(_, text)| !text.is_empty()) {
            // The list begins in the line after the field.
            let line = line + field.line;
            let wrong = |what: String| ReadError::new("bad-header", FileLocation::Line(line), what);
            if files.len() as u64 == declared {
                return Err(wrong(format!("a name follows the {} of the list", grouped(declared))));
            }
            let name = std::str::from_utf8(text).ok().filter(|_| text.len() <= self.limits.header_line);
            let name = name.ok_or_else(|| wrong("this is no name of a file".to_owned()))?.to_owned();
            crate::grow::push(&mut files, SampleFile { name, line })?;
        }
        if (files.len() as u64) < declared {
            let message = format!(
                "the list has {} files; {} are expected, with {each} axes each",
                grouped(files.len() as u64),
                grouped(declared)
            );
            return Err(ReadError::new("truncated", field.place(), message));
        }
        Ok(files)
    }

    /// The names from a `printf` pattern with a first number, a last number and a step, one for each slice.
    fn pattern(
        &self,
        field: &MetaField<'_>,
        pattern: &str,
        numbers: &[i64],
    ) -> Result<Vec<SampleFile>, ReadError> {
        let declared = self.n_files(field, self.sizes.len() - 1)?;
        // Without numbers they count from 1.
        let first = numbers.first().copied().unwrap_or(1);
        let step = numbers.get(2).copied().unwrap_or(1);
        let wrong = |what: String| field.wrong(format!("the names {} {what}", field.shown()));
        let Some(numbering) = Numbering::new(pattern).filter(|_| numbers.len() <= 3) else {
            return Err(wrong("are no pattern as in slice%03d.raw 1 20 1".to_owned()));
        };
        let last = i64::try_from(declared - 1).ok().and_then(|n| n.checked_mul(step)?.checked_add(first));
        let last = last.ok_or_else(|| wrong("have numbers that are too large".to_owned()))?;
        // The last number only bounds the names; with a step it need not be reached exactly.
        let reaches = |said: i64| if step < 0 { said <= last } else { said >= last };
        if step == 0 || numbers.get(1).is_some_and(|said| !reaches(*said)) {
            return Err(wrong(format!("are fewer than the {} slices", grouped(declared))));
        }
        let mut files = Vec::new();
        let mut number = first;
        for _ in 0..declared {
            crate::grow::push(&mut files, SampleFile { name: numbering.name(number), line: field.line })?;
            // The number after the last name may overflow; it is not used.
            number = number.wrapping_add(step);
        }
        Ok(files)
    }
}

/// A pattern that contains one number, `%d` or `%03d`.
struct Numbering<'a> {
    before: &'a str,
    after: &'a str,
    width: usize,
    is_zeroed: bool,
}

impl<'a> Numbering<'a> {
    fn new(pattern: &'a str) -> Option<Self> {
        let (before, rest) = pattern.split_once('%')?;
        let end = rest.find(|c: char| !c.is_ascii_digit())?;
        let (digits, after) = (&rest[..end], rest[end..].strip_prefix(['d', 'i', 'u'])?);
        // No file name has a longer number.
        let width: usize = if digits.is_empty() { 0 } else { digits.parse().ok().filter(|n| *n < 100)? };
        let is_zeroed = digits.starts_with('0');
        (!after.contains('%')).then_some(Self { before, after, width, is_zeroed })
    }

    fn name(&self, number: i64) -> String {
        let Self { before, after, width, is_zeroed } = self;
        if *is_zeroed {
            format!("{before}{number:0width$}{after}")
        } else {
            format!("{before}{number:width$}{after}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_numbered_as_by_printf() {
        let name = |pattern, number| Numbering::new(pattern).map(|n| n.name(number));
        assert_eq!(name("a%03d.raw", 7).as_deref(), Some("a007.raw"));
        assert_eq!(name("%d", 1234).as_deref(), Some("1234"));
        assert_eq!(name("a.%2d", 7).as_deref(), Some("a. 7"));
        for pattern in ["a", "a%s", "a%d%d", "a%", "a%999d", "a%99999999999999999999d", "%%d"] {
            assert_eq!(name(pattern, 1), None, "{pattern}");
        }
    }
}
