//! Checks the nesting depth of a text before any recursive code sees it: the parser recurses for every
//! bracket, and its tree is as deep as a chain of operators is long.
use crate::ScriptError;

/// Refuses a text whose tree may exceed the allowed depth. The count is an upper bound of that depth: every
/// bracket, operator, dot and keyword of an expression since the last comma of its bracket, summed over all
/// open brackets; and blocks by their indentation.
pub(crate) fn check(text: &str, most: u32) -> Result<(), ScriptError> {
    let mut scan = NestingScan { open: vec![0], depth: 0, indents: vec![0], branches: 0 };
    let bytes = text.as_bytes();
    let mut at = indentation(bytes, 0, &mut scan);
    while at < bytes.len() {
        let start = at;
        at = token(bytes, at, &mut scan);
        let blocks = u32::try_from(scan.indents.len()).unwrap_or(u32::MAX);
        if scan.depth.saturating_add(blocks).saturating_add(scan.branches) > most {
            let message =
                format!("this is nested deeper than the limit of {most}: assign parts of it to names");
            return Err(ScriptError::new("script-limit", message).at(text, start));
        }
    }
    Ok(())
}

struct NestingScan {
    /// By open bracket: the count since its last comma.
    open: Vec<u32>,
    /// Their sum.
    depth: u32,
    /// The columns of the open blocks.
    indents: Vec<usize>,
    /// The `elif` branches so far. Each nests within the one before, so their number bounds the longest
    /// chain.
    branches: u32,
}

impl NestingScan {
    fn count(&mut self) {
        if let Some(top) = self.open.last_mut() {
            *top += 1;
            self.depth += 1;
        }
    }

    /// Resets the count at a comma or at the end of a statement or bracket: later parts do not nest in
    /// earlier ones.
    fn reset(&mut self) {
        if let Some(top) = self.open.last_mut() {
            self.depth -= *top;
            *top = 0;
        }
    }
}

/// The offset after the token that starts at `at`.
fn token(bytes: &[u8], at: usize, scan: &mut NestingScan) -> usize {
    match bytes[at] {
        b'(' | b'[' | b'{' => {
            scan.count();
            scan.open.push(0);
        }
        // An unpaired bracket is left to the parser, which reports it.
        b')' | b']' | b'}' if scan.open.len() > 1 => {
            scan.reset();
            scan.open.pop();
        }
        b',' | b';' => scan.reset(),
        // Inside brackets a line end means nothing.
        b'\n' | b'\r' if scan.open.len() == 1 => {
            scan.reset();
            return indentation(bytes, at + 1, scan);
        }
        b if b.is_ascii_alphanumeric() || b == b'_' => {
            let end = token_end(bytes, at);
            match &bytes[at..end] {
                // Each adds a level to the parser's tree, as operators do.
                b"and" | b"or" | b"not" | b"in" | b"if" | b"else" | b"for" | b"lambda" => scan.count(),
                // Each branch of a chain is nested in the one before it.
                b"elif" => scan.branches += 1,
                _ => {}
            }
        }
        b'+' | b'-' | b'*' | b'/' | b'%' | b'|' | b'&' | b'^' | b'~' | b'<' | b'>' | b'=' | b'!' | b'.' => {
            scan.count();
        }
        _ => {}
    }
    token_end(bytes, at)
}

/// The offset after the token, string, comment or character that starts at `at`.
pub(crate) fn token_end(bytes: &[u8], at: usize) -> usize {
    match bytes[at] {
        b'\\' => at + 2,
        b'#' => at + bytes[at..].iter().take_while(|b| !matches!(b, b'\n' | b'\r')).count(),
        b'"' | b'\'' => string(bytes, at),
        b if b.is_ascii_alphanumeric() || b == b'_' => {
            at + bytes[at..].iter().take_while(|b| b.is_ascii_alphanumeric() || **b == b'_').count()
        }
        _ => at + 1,
    }
}

/// The end of the string that starts at `at`.
fn string(bytes: &[u8], at: usize) -> usize {
    let quote = bytes[at];
    let long = bytes[at..].starts_with(&[quote; 3]);
    let mut end = at + if long { 3 } else { 1 };
    while end < bytes.len() {
        match bytes[end] {
            b'\\' => end += 1,
            b'\n' if !long => return end,
            b if b == quote && !long => return end + 1,
            b if b == quote && bytes[end..].starts_with(&[quote; 3]) => return end + 3,
            _ => {}
        }
        end += 1;
    }
    bytes.len()
}

/// Measures the indentation of the line that starts at `at`; lines without a statement are skipped.
fn indentation(bytes: &[u8], at: usize, scan: &mut NestingScan) -> usize {
    let width = bytes[at..].iter().take_while(|b| matches!(b, b' ' | b'\t')).count();
    if bytes.get(at + width).is_some_and(|b| !matches!(b, b'#' | b'\n' | b'\r')) {
        while scan.indents.last().is_some_and(|last| *last > width) {
            scan.indents.pop();
        }
        if scan.indents.last() != Some(&width) {
            scan.indents.push(width);
        }
    }
    at + width
}

#[cfg(test)]
mod tests {
    use super::*;

    fn depth(text: &str) -> u32 {
        (0..10_000).find(|most| check(text, *most).is_ok()).unwrap()
    }

    #[test]
    fn counts_nested_parts_and_not_adjacent_ones() {
        assert_eq!(depth("a"), 1);
        assert_eq!(depth(&"a, ".repeat(500)), 1);
        assert_eq!(depth(&"x = -1\n".repeat(500)), 3);
        assert_eq!(depth(&format!("[{}]", "(1, 2), ".repeat(500))), 3);
        assert_eq!(depth(&"(".repeat(500)), 501);
        assert_eq!(depth(&"- ".repeat(500)), 501);
        assert_eq!(depth(&"1 + ".repeat(500)), 501);
        assert_eq!(depth(&format!("f{}", "()".repeat(500))), 501);
        assert_eq!(depth(&"not ".repeat(500)), 501);
        assert_eq!(depth(&format!("'{}'", "(".repeat(500))), 1);
        assert_eq!(depth(&format!("'''{}\n'''", "(\n'".repeat(500))), 1);
        assert_eq!(depth(&format!("# {}", "(".repeat(500))), 1);
        assert_eq!(depth(&(0..500).map(|k| format!("{}if a:\n", " ".repeat(k))).collect::<String>()), 501);
        assert_eq!(depth(&format!("if a:\n pass\n{}", "elif b:\n pass\n".repeat(500))), 502);
        assert!(depth("((\\\n") <= 4);
    }
}
