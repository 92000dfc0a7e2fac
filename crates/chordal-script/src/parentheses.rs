//! `Parentheses`: the pairs of round brackets of a text. The parser's spans omit the brackets around an
//! operand, even at the ends of a longer expression:
//!
//! ```text
//! (a) - (b)
//!  ^^^^^^^    the parser's span
//! ^^^^^^^^^   the expression, as `balanced` restores it
//! ```
use crate::nesting;
use std::ops::Range;

/// The pairs of round brackets outside of strings and comments.
#[derive(Debug)]
pub(crate) struct Parentheses {
    /// The offsets of all brackets, in order, each with the offset of its partner.
    partners: Vec<(usize, usize)>,
}

impl Parentheses {
    /// The pairs of a text that has been parsed, so that every bracket has a partner.
    pub fn new(text: &str) -> Self {
        let bytes = text.as_bytes();
        let (mut partners, mut open, mut at) = (Vec::new(), Vec::new(), 0);
        while at < bytes.len() {
            match bytes[at] {
                b'(' => open.push(at),
                b')' => {
                    if let Some(first) = open.pop() {
                        partners.extend([(first, at), (at, first)]);
                    }
                }
                _ => {}
            }
            // Token by token: brackets in strings and comments are none.
            at = nesting::token_end(bytes, at);
        }
        partners.sort_unstable();
        Self { partners }
    }

    /// The brackets in a range, with their partners.
    fn within(&self, range: &Range<usize>) -> &[(usize, usize)] {
        let first = self.partners.partition_point(|(at, _)| *at < range.start);
        let end = self.partners.partition_point(|(at, _)| *at < range.end);
        &self.partners[first..end.max(first)]
    }

    /// The smallest range that contains a span and the partners of all its brackets.
    pub fn balanced(&self, span: Range<usize>) -> Range<usize> {
        self.within(&span)
            .iter()
            .fold(span.clone(), |range, (_, partner)| range.start.min(*partner)..range.end.max(*partner + 1))
    }

    /// Whether a bracket opens in the range.
    pub fn opens_in(&self, range: &Range<usize>) -> bool {
        self.within(range).iter().any(|(at, partner)| at < partner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_span_is_extended_to_the_partners_of_its_brackets() {
        for (text, span, expected) in [
            ("(a) - (b)", "a) - (b", "(a) - (b)"),
            ("(a - b)", "a - b", "a - b"),
            ("((a) - b) | c", "a) - b", "(a) - b"),
            ("((a)) - b", "a)) - b", "((a)) - b"),
            ("f((a), ')') - (b)", "f((a), ')') - (b", "f((a), ')') - (b)"),
            ("(a # )\n) - b", "a # )\n) - b", "(a # )\n) - b"),
        ] {
            let at = text.find(span).unwrap();
            assert_eq!(&text[Parentheses::new(text).balanced(at..at + span.len())], expected, "{text}");
        }
        assert!(Parentheses::new("a | (b)").opens_in(&(1..5)));
        assert!(!Parentheses::new("(a) | b").opens_in(&(2..6)));
        assert!(!Parentheses::new("a | '(' b # (").opens_in(&(0..13)));
    }
}
