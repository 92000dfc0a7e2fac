//! Wildcards in names: `*` is any number of characters, `?` is one.

/// Whether a text holds a wildcard.
pub fn has_wildcard(text: &str) -> bool {
    text.contains(['*', '?'])
}

/// Whether a name matches a pattern as a whole. A name that starts with a dot matches only a pattern that
/// does, as in shells.
///
/// Takes at most the product of both lengths: after a mismatch only the last `*` takes one character more,
/// since whatever an earlier one could take, the later one can.
pub fn matches(pattern: &str, name: &str) -> bool {
    if name.starts_with('.') && !pattern.starts_with('.') {
        return false;
    }
    let (pattern, name): (Vec<char>, Vec<char>) = (pattern.chars().collect(), name.chars().collect());
    let (mut p, mut n) = (0, 0);
    // The last star, and where the name stood when it was met.
    let mut star: Option<(usize, usize)> = None;
    while n < name.len() {
        match pattern.get(p) {
            Some('*') => {
                star = Some((p, n));
                p += 1;
            }
            Some(c) if *c == '?' || *c == name[n] => {
                p += 1;
                n += 1;
            }
            _ => {
                let Some((at, from)) = star else { return false };
                star = Some((at, from + 1));
                p = at + 1;
                n = from + 1;
            }
        }
    }
    pattern[p..].iter().all(|c| *c == '*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stars_and_question_marks_stand_for_characters() {
        for (pattern, name) in [
            ("*.obj", "a.obj"),
            ("*", "a"),
            ("a*b*c", "aXbbYc"),
            ("??.stl", "äö.stl"),
            ("*.*", "a.b.c"),
            (".*", ".hidden"),
            ("a**b", "ab"),
        ] {
            assert!(matches(pattern, name), "{pattern} {name}");
        }
        for (pattern, name) in
            [("*.obj", "a.objx"), ("?", ""), ("?", "ab"), ("*", ".hidden"), ("a*b", "ac"), ("*.obj", "A.OBJ")]
        {
            assert!(!matches(pattern, name), "{pattern} {name}");
        }
    }

    #[test]
    fn many_stars_take_no_more_than_the_product_of_both_lengths() {
        // With a search over all stars this would not end.
        assert!(!matches(&"a*".repeat(60), &"a".repeat(59)));
        assert!(!matches(&format!("{}b", "*a".repeat(60)), &"a".repeat(400)));
    }
}
