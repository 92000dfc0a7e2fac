//! `OffKeyword`: the first word of an OFF file, which defines the data of a vertex.
use crate::text::{LineTokens, TextLines};
use memchr::memchr;

/// The content of the keyword `[ST][C][N][4][n]OFF`, and whether `BINARY` follows it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct OffKeyword {
    /// ST: vertices have texture coordinates.
    pub(super) has_texcoords: bool,
    /// C: vertices have colours.
    pub(super) has_colors: bool,
    /// N: vertices have normals.
    pub(super) has_normals: bool,
    /// 4: positions have a last, homogeneous coordinate.
    pub(super) is_homogeneous: bool,
    /// n: the dimension of space precedes the counts.
    pub(super) has_dimension: bool,
    /// Whether N precedes C. That is not Geomview's order, and programs that write it disagree on which of
    /// the two comes first in a row.
    pub(super) is_out_of_order: bool,
    pub(super) is_binary: bool,
}

impl OffKeyword {
    /// The keyword, and the digits that some writers join to it, as in `OFF8 6 12`. Letters may be in any
    /// order, each once, because not all writers keep Geomview's order.
    pub(super) fn from_word(word: &[u8]) -> Option<(Self, &[u8])> {
        let mut keyword = Self::default();
        let mut rest = word;
        loop {
            let (flag, after) = match rest {
                [b'O', b'F', b'F', digits @ ..] => {
                    let is_end = digits.first().is_none_or(u8::is_ascii_digit);
                    return is_end.then_some((keyword, digits));
                }
                [b'S', b'T', after @ ..] => (&mut keyword.has_texcoords, after),
                [b'C', after @ ..] => {
                    keyword.is_out_of_order = keyword.has_normals;
                    (&mut keyword.has_colors, after)
                }
                [b'N', after @ ..] => (&mut keyword.has_normals, after),
                [b'4', after @ ..] => (&mut keyword.is_homogeneous, after),
                [b'n', after @ ..] => (&mut keyword.has_dimension, after),
                _ => return None,
            };
            if std::mem::replace(flag, true) {
                return None;
            }
            rest = after;
        }
    }
}

/// A line without its comment.
pub(super) fn without_comment(line: &[u8]) -> &[u8] {
    memchr(b'#', line).map_or(line, |at| &line[..at])
}

/// Whether the first word after comments is a keyword of OFF.
pub(crate) fn looks_like(text: &[u8]) -> bool {
    // Chosen: enough for the longest leading comments that were seen; files with longer ones need the
    // extension.
    const HEAD: usize = 64 << 10;
    let head = &text[..text.len().min(HEAD)];
    let first = TextLines::new(head).find_map(|(_, line)| LineTokens::new(without_comment(line)).next());
    first.is_some_and(|word| OffKeyword::from_word(word).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_read_in_any_order_and_once_each() {
        let (keyword, digits) = OffKeyword::from_word(b"STCN4nOFF").unwrap();
        let all = OffKeyword {
            has_texcoords: true,
            has_colors: true,
            has_normals: true,
            is_homogeneous: true,
            has_dimension: true,
            ..OffKeyword::default()
        };
        assert_eq!((keyword, digits), (all, &b""[..]));
        assert!(OffKeyword::from_word(b"NCOFF").unwrap().0.is_out_of_order);
        assert!(!OffKeyword::from_word(b"CSTOFF").unwrap().0.is_out_of_order);
        assert_eq!(OffKeyword::from_word(b"OFF8").unwrap().1, b"8");
        for word in ["CCOFF", "SOFF", "4SOFF", "off", "OFFX", "OF", "", "XOFF", "OFF-1"] {
            assert_eq!(OffKeyword::from_word(word.as_bytes()), None, "{word}");
        }
    }

    #[test]
    fn a_keyword_after_comments_is_found() {
        assert!(
            looks_like(b"# a\n\n  # b\n COFF # c\n") && looks_like(b"OFF BINARY\n\0\0") && looks_like(b"OFF")
        );
        assert!(!looks_like(b"# OFF\n") && !looks_like(b"8 6 12\n") && !looks_like(b"OFFSET 3\n"));
    }
}
