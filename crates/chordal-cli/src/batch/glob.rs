//! Wildcards in names: `*` is any number of characters, `?` is one.

/// Whether a text contains a wildcard.
pub fn has_wildcard(text: &str) -> bool {
    text.contains(['*', '?'])
}

/// Whether a whole name matches a pattern. A name with a leading dot matches only a pattern with one, as in
/// shells.
///
/// The time is at most the product of both lengths: after a mismatch only the last `*` has to take one more
/// character, since it can take anything that an earlier one could.
pub fn matches(pattern: &str, name: &str) -> bool {
    if name.starts_with('.') && !pattern.starts_with('.') {
        return false;
    }
    let (pattern, name): (Vec<char>, Vec<char>) = (pattern.chars().collect(), name.chars().collect());
    let (mut p, mut n) = (0, 0);
    // The index of the last star, and the index in the name up to which it matches.
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
                let Some((star_idx, name_idx)) = star else { return false };
                star = Some((star_idx, name_idx + 1));
                p = star_idx + 1;
                n = name_idx + 1;
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
        // With backtracking over all stars this would not end.
        assert!(!matches(&"a*".repeat(60), &"a".repeat(59)));
        assert!(!matches(&format!("{}b", "*a".repeat(60)), &"a".repeat(400)));
    }
}
