//! Certificates in comments: split into lines that every program can read, and joined again.
use crate::text::{grouped, integer};
use crate::warnings::Warnings;
use crate::{FileLocation, Limits, WriteError};
use serde_json::Value;
use std::io::Write;

/// The most bytes of a certificate in comments. Chosen: ten thousand lines, which all programs that were
/// tried accept.
pub(crate) const MOST: usize = 1 << 20;

/// The most bytes of JSON in one line. Chosen: with the prefix, lines have at most 200 bytes. MeshLab refuses
/// a PLY with a line of 700, and RPly, which Open3D is built on, ends the program at 1,024.
const PIECE: usize = 160;

/// The bytes of the longest escape that [`pieces`] writes, `\u0020`.
const LONGEST_ESCAPE: usize = 6;

/// Serialises the certificate as one ASCII text without a line break: the header of a PLY must be ASCII.
///
/// # Errors
/// [`WriteError::Unsupported`] if it is longer than readers accept.
pub(crate) fn text(certificate: &Value) -> Result<String, WriteError> {
    let text = in_ascii(&certificate.to_string());
    if text.len() > MOST {
        let message = format!(
            "a certificate of {} bytes is over the limit of {}",
            grouped(text.len() as u64),
            grouped(MOST as u64)
        );
        return Err(WriteError::Unsupported(message));
    }
    Ok(text)
}

/// Writes a certificate as comments, each as `prefix 3/12 piece of its JSON`, counted from 1; nothing for
/// `None`.
///
/// # Errors
/// As for [`text`], and if the sink fails.
pub(crate) fn write_comments(
    prefix: &str,
    certificate: Option<&Value>,
    out: &mut impl Write,
) -> Result<(), WriteError> {
    let Some(certificate) = certificate else { return Ok(()) };
    let pieces = pieces(&text(certificate)?);
    let n = pieces.len();
    for (i, piece) in pieces.iter().enumerate() {
        writeln!(out, "{prefix}{}/{n} {piece}", i + 1)?;
    }
    Ok(())
}

/// The same JSON in ASCII: other characters occur only in strings, where they are escaped.
fn in_ascii(json: &str) -> String {
    let mut text = String::with_capacity(json.len());
    for letter in json.chars() {
        if letter.is_ascii() {
            text.push(letter);
            continue;
        }
        // A character beyond 16 bits is two escapes in JSON, its surrogates.
        for unit in letter.encode_utf16(&mut [0; 2]) {
            text.push_str(&format!("\\u{unit:04x}"));
        }
    }
    text
}

/// Cuts JSON into pieces that fit a line. No piece begins or ends with a space, which programs trim, or ends
/// with a backslash, which joins it to the next line of an OBJ. At such a place the character is escaped.
fn pieces(json: &str) -> Vec<String> {
    let (mut pieces, mut piece) = (Vec::new(), String::new());
    let mut rest = json;
    while let Some(letter) = rest.chars().next() {
        let n = match rest.as_bytes() {
            [b'\\', b'u', ..] => LONGEST_ESCAPE,
            [b'\\', ..] => 2,
            _ => letter.len_utf8(),
        };
        let (unit, after) = rest.split_at(n.min(rest.len()));
        rest = after;
        // The character after this space may not fit into the piece.
        let is_at_end = piece.is_empty() || piece.len() + LONGEST_ESCAPE >= PIECE;
        let unit = match unit {
            " " if is_at_end => "\\u0020",
            "\\\\" => "\\u005c",
            other => other,
        };
        if piece.len() + unit.len() > PIECE {
            pieces.push(std::mem::take(&mut piece));
        }
        piece.push_str(unit);
    }
    pieces.push(piece);
    pieces
}

/// The comments of a file that hold its certificate, in file order.
///
/// Each is a numbered piece, as [`write_comments`] writes it, or the whole certificate, as files of earlier
/// versions have it. A certificate with missing or misplaced pieces is rejected.
#[derive(Debug, Default)]
pub(crate) struct CertificateComments {
    text: Vec<u8>,
    n_lines: u64,
    n_read: u64,
    /// The location of the first comment.
    place: Option<FileLocation>,
    /// Where and why the comments cannot be a certificate.
    damage: Option<(FileLocation, String)>,
}

impl CertificateComments {
    /// Adds the text of the next comment.
    pub(crate) fn take(&mut self, comment: &[u8], place: FileLocation) {
        if self.damage.is_some() {
            return;
        }
        let (number, n_lines, piece) = numbered(comment).unwrap_or((1, 1, comment));
        let is_first = self.place.is_none();
        if is_first {
            self.place = Some(place.clone());
            self.n_lines = n_lines;
        }
        if self.n_read == self.n_lines && !is_first {
            self.damage = Some((place, "another one follows it, and both cannot be of this file".to_owned()));
        } else if n_lines != self.n_lines || number != self.n_read + 1 {
            let message = format!(
                "its line {number} of {n_lines} stands where line {} of {} belongs",
                self.n_read + 1,
                self.n_lines
            );
            self.damage = Some((place, message));
        } else if self.text.len() + piece.len() > MOST {
            self.damage = Some((place, format!("it is over the limit of {} bytes", grouped(MOST as u64))));
        }
        self.n_read += 1;
        self.text.extend_from_slice(if self.damage.is_none() { piece } else { &[] });
    }

    /// The certificate, if it is complete. An incomplete one is counted as a warning.
    pub(crate) fn finish(self, warnings: &mut Warnings) -> Option<Value> {
        let first = self.place?;
        let mut damage = self.damage;
        if damage.is_none() && self.n_read < self.n_lines {
            let message = format!("only {} of its {} lines are there", self.n_read, self.n_lines);
            damage = Some((first.clone(), message));
        }
        match damage {
            None => read(&self.text, first, warnings),
            Some((place, why)) => unreadable(why, place, warnings),
        }
    }
}

/// The parts of `3/12 piece`: the number of the piece, the number of pieces, and the piece.
fn numbered(comment: &[u8]) -> Option<(u64, u64, &[u8])> {
    let space = comment.iter().position(|byte| *byte == b' ')?;
    let (numbers, piece) = (&comment[..space], &comment[space + 1..]);
    let slash = numbers.iter().position(|byte| *byte == b'/')?;
    let count = |digits: &[u8]| {
        let is_plain = digits.first().is_some_and(u8::is_ascii_digit);
        integer(digits).ok().filter(|n| is_plain && *n > 0).and_then(|n| u64::try_from(n).ok())
    };
    Some((count(&numbers[..slash])?, count(&numbers[slash + 1..])?, piece))
}

/// Parses a certificate. An invalid one is counted as a warning.
pub(crate) fn read(text: &[u8], place: FileLocation, warnings: &mut Warnings) -> Option<Value> {
    if text.len() > MOST {
        let n = grouped(text.len() as u64);
        return unreadable(
            format!("{n} bytes are over the limit of {}", grouped(MOST as u64)),
            place,
            warnings,
        );
    }
    match serde_json::from_slice(text) {
        Ok(value) => Some(value),
        Err(error) => unreadable(error.to_string(), place, warnings),
    }
}

/// Counts a warning for an invalid certificate.
pub(crate) fn unreadable(why: String, place: FileLocation, warnings: &mut Warnings) -> Option<Value> {
    warnings.count("certificate-unreadable", || {
        (place, format!("the certificate is unreadable and was skipped: {why}"))
    });
    None
}

/// The most bytes of a certificate in one line of a header.
pub(crate) fn most_in_a_line() -> usize {
    /// The bytes before it.
    const PREFIX: usize = 32;
    Limits::default().header_line - PREFIX
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;
    use serde_json::json;

    fn lines_of(certificate: &Value) -> Vec<String> {
        let mut out = Vec::new();
        write_comments("comment chordal ", Some(certificate), &mut out).unwrap();
        String::from_utf8(out).unwrap().lines().map(str::to_owned).collect()
    }

    /// The certificate read from lines without the prefix, and the warning.
    fn read_of(lines: &[&str]) -> (Option<Value>, Option<String>) {
        let (mut comments, mut warnings) = (CertificateComments::default(), Warnings::default());
        for (i, line) in lines.iter().enumerate() {
            let text = line.strip_prefix("comment chordal ").unwrap_or(line);
            comments.take(text.as_bytes(), FileLocation::Line(i as u64 + 1));
        }
        let value = comments.finish(&mut warnings);
        (value, warnings.into_list().first().map(|warning| warning.message.to_string()))
    }

    #[test]
    fn lines_are_short_and_keep_what_trimming_and_joining_would_take() {
        let mut random = Random::new(3);
        let letters = [" ", " ", "\\", "\"", "\n", "a", "\u{e9}", "\u{1f600}", "7/9 "];
        for n in 0..400 {
            let text: String = (0..n).map(|_| letters[random.below(letters.len())]).collect();
            let certificate = json!({ "name": text, "spaces": " ".repeat(n), "back": "\\".repeat(n) });
            let lines = lines_of(&certificate);
            for line in &lines {
                assert!(line.len() <= 200 && line.is_ascii(), "{line}");
                assert!(line.trim() == line && !line.ends_with('\\'), "{line}");
            }
            let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
            assert_eq!(read_of(&lines), (Some(certificate), None));
        }
    }

    #[test]
    fn one_line_of_earlier_versions_is_read() {
        assert_eq!(read_of(&["{\"a\": 1}"]), (Some(json!({ "a": 1 })), None));
        assert_eq!(read_of(&[]), (None, None));
    }

    #[test]
    fn lines_that_are_missing_twice_there_or_out_of_order_are_no_certificate() {
        let certificate = json!({ "text": "0123456789".repeat(60) });
        let lines = lines_of(&certificate);
        let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
        let n = lines.len();
        assert!(n > 3);
        let says = |lines: &[&str], why: &str| {
            let (value, warning) = read_of(lines);
            assert!(
                value.is_none() && warning.as_ref().is_some_and(|text| text.contains(why)),
                "{warning:?}"
            );
        };
        for i in 0..n - 1 {
            says(&[&lines[..i], &lines[i + 1..]].concat(), "belongs");
            says(&[&lines[..i + 1], &lines[i..]].concat(), "belongs");
            let mut swapped = lines.clone();
            swapped.swap(i, i + 1);
            says(&swapped, "belongs");
        }
        says(&lines[..n - 1], &format!("only {} of its {n} lines are there", n - 1));
        says(&[&lines[..], &lines[..]].concat(), "another one follows it");
        says(&["{}", "{}"], "another one follows it");
        says(&["{", "}"], "another one follows it");
    }

    #[test]
    fn numbers_of_attackers_are_damage_and_no_panic() {
        for comment in [
            "0/0 {}",
            "1/0 {}",
            "2/1 {}",
            "1/18446744073709551616 {}",
            "1/9223372036854775807 {}",
            "-1/1 {}",
            "/ {}",
            "1/ {}",
            "1/1",
            "1/1 ",
            "",
            " ",
            "1/2/3 {}",
            "+1/1 {}",
        ] {
            let (value, warning) = read_of(&[comment]);
            assert!(value.is_none() && warning.is_some(), "{comment}");
        }
        assert_eq!(read_of(&["1/1 7"]), (Some(json!(7)), None));
    }
}
