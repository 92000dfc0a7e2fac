//! Paths and use trees, read from flat tokens.
use super::{Kind, Token};

/// A path with the name that it gets, if it is renamed. A glob ends in `*`.
pub struct Leaf {
    /// The words between the `::`, without generics.
    pub segments: Vec<String>,
    /// The name after `as`.
    pub alias: Option<String>,
}

/// The leaves of the use tree (or plain path) at `tokens[at]`, and the index behind it.
pub fn tree(tokens: &[Token], mut at: usize, prefix: &[String]) -> (Vec<Leaf>, usize) {
    let is = |at: usize, text: &str| tokens.get(at).is_some_and(|token| token.is(text));
    let mut segments = prefix.to_vec();
    if is(at, ":") && is(at + 1, ":") {
        at += 2;
    }
    loop {
        if is(at, "$") && is(at + 1, "crate") {
            at += 1;
        }
        let Some(token) = tokens.get(at) else { break };
        match token.kind {
            Kind::Word => segments.push(token.text.clone()),
            Kind::Punct if token.is("*") => segments.push("*".into()),
            Kind::Punct if token.is("$") => segments.push("$".into()),
            Kind::Open if token.is("{") => return group(tokens, at, &segments),
            _ => break,
        }
        at += 1;
        if !(is(at, ":") && is(at + 1, ":")) {
            break;
        }
        at += 2;
    }
    let alias = is(at, "as").then(|| tokens.get(at + 1).map(|name| name.text.clone())).flatten();
    let end = if alias.is_some() { at + 2 } else { at };
    (vec![Leaf { segments, alias }], end)
}

/// The leaves of `{a, b::c, …}`, whose bracket is `tokens[open]`.
fn group(tokens: &[Token], open: usize, prefix: &[String]) -> (Vec<Leaf>, usize) {
    let (mut leaves, mut at) = (Vec::new(), open + 1);
    while tokens.get(at).is_some_and(|token| !token.is("}")) {
        if tokens[at].is(",") {
            at += 1;
            continue;
        }
        let (more, end) = tree(tokens, at, prefix);
        leaves.extend(more);
        at = if end > at { end } else { at + 1 };
    }
    (leaves, at + 1)
}
