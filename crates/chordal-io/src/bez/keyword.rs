//! `BezKeyword`: the first word of a file of Bézier patches, which defines the layout of a patch.
use crate::text::{LineTokens, TextLines};
use memchr::memchr;

/// The content of the keyword, `[ST][C]BEZ[<u><v><n>][_ST]` or `[ST][C]BBP`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct BezKeyword {
    /// ST: patches have texture coordinates at their corners.
    pub(super) has_texcoords: bool,
    /// C: patches have colours at their corners.
    pub(super) has_colors: bool,
    /// The degrees along u and v and the coordinates of a control point; `None` if they follow as three
    /// numbers.
    pub(super) form: Option<[u8; 3]>,
}

impl BezKeyword {
    /// The keyword in a word.
    pub(super) fn from_word(word: &[u8]) -> Option<Self> {
        let (has_prefix, rest) = after(word, b"ST");
        let (has_colors, rest) = after(rest, b"C");
        if rest == b"BBP" {
            return Some(Self { has_texcoords: has_prefix, has_colors, form: Some([3, 3, 3]) });
        }
        let rest = rest.strip_prefix(b"BEZ")?;
        let (form, rest) = match rest {
            [u, v, n, rest @ ..] if [u, v, n].iter().all(|digit| digit.is_ascii_digit()) => {
                (Some([u, v, n].map(|digit| digit - b'0')), rest)
            }
            _ => (None, rest),
        };
        let (has_suffix, rest) = after(rest, b"_ST");
        let keyword = Self { has_texcoords: has_prefix || has_suffix, has_colors, form };
        rest.is_empty().then_some(keyword)
    }
}

/// Whether a word begins with `beginning`, and the rest of it.
fn after<'a>(word: &'a [u8], beginning: &[u8]) -> (bool, &'a [u8]) {
    word.strip_prefix(beginning).map_or((false, word), |rest| (true, rest))
}

/// Whether the first word after comments is a keyword of Bézier patches.
pub(crate) fn looks_like(text: &[u8]) -> bool {
    // Chosen: enough for the longest leading comments that were seen; files with longer ones need the
    // extension.
    const HEAD: usize = 64 << 10;
    let head = &text[..text.len().min(HEAD)];
    let without_comment = |line: &'_ [u8]| memchr(b'#', line).unwrap_or(line.len());
    let first =
        TextLines::new(head).find_map(|(_, line)| LineTokens::new(&line[..without_comment(line)]).next());
    first.is_some_and(|word| BezKeyword::from_word(word).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keywords_say_what_a_patch_has() {
        let keyword = |word: &str| {
            BezKeyword::from_word(word.as_bytes()).map(|k| (k.has_texcoords, k.has_colors, k.form))
        };
        assert_eq!(keyword("BBP"), Some((false, false, Some([3, 3, 3]))));
        assert_eq!(keyword("STBBP"), Some((true, false, Some([3, 3, 3]))));
        assert_eq!(keyword("BEZ224"), Some((false, false, Some([2, 2, 4]))));
        assert_eq!(keyword("CBEZ163_ST"), Some((true, true, Some([1, 6, 3]))));
        assert_eq!(keyword("STCBEZ"), Some((true, true, None)));
        for word in ["BEZ22", "BEZ2244", "BBP_ST", "BBP3", "CSTBBP", "bbp", "BEZIER", "BEZ333_S", "", "ST"] {
            assert_eq!(keyword(word), None, "{word}");
        }
    }

    #[test]
    fn a_keyword_after_comments_is_found() {
        assert!(looks_like(b"# exact\n\n  CBEZ224_ST # c\n1") && looks_like(b"BEZ 2 2 4\n"));
        assert!(!looks_like(b"# BBP\n") && !looks_like(b"appearance { }\nBBP\n") && !looks_like(b"1\n3 3\n"));
    }
}
