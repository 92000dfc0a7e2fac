//! Advice for scripts with code that other languages would accept: what to write instead.
use crate::ScriptError;

/// How to write a power, for which the language has no operator.
pub(crate) const POWERS: &str = "write x * x for a square, and exp(b * log(a)) for a to the power of b";

/// Replaces an error of the parser by advice, if there is any.
pub(crate) fn with_advice(error: ScriptError) -> ScriptError {
    if !error.message.contains("unexpected symbol '**'") {
        return error;
    }
    ScriptError { message: format!("there is no '**': {POWERS}"), ..error }
}

/// Why a script has no value: the end of the sentence "the script's value must be a shape, but it is None:
/// …".
pub(crate) fn why_nothing(text: &str) -> String {
    // The last statement that is not indented: the value of a script is that of its last line.
    let last = text.lines().rfind(|line| starts_statement(line)).unwrap_or("");
    let word: String = last.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    let rest = last[word.len()..].trim_start();
    match word.as_str() {
        "if" | "elif" | "else" => {
            "an 'if' statement has no value: assign the shape to a name in each branch, and end the script with that \
             name"
                .to_owned()
        }
        "for" => "a loop has no value: collect its shapes in a list, and end the script with union(…) of the list"
            .to_owned(),
        "def" => {
            let name = rest.split('(').next().unwrap_or("").trim();
            format!("it ends with the definition of {name}(): add a line that calls it")
        }
        name if rest.starts_with('(') && returns_nothing(text, name) => without_return(name),
        name if rest.starts_with('=') && !name.is_empty() => {
            format!("its last line must be an expression, not an assignment: add a line '{name}'")
        }
        "" | "load" => "it has no line with an expression".to_owned(),
        _ => "its last line must be an expression whose value is a shape".to_owned(),
    }
}

fn without_return(name: &str) -> String {
    format!("{name}() returns nothing: end it with 'return' and a shape")
}

/// Adds the functions of a script that return nothing to a message about None in place of a shape.
pub(crate) fn with_missing_return(message: String, text: &str) -> String {
    if !message.contains("the result of a function without 'return'") {
        return message;
    }
    let heads = text.lines().filter_map(|line| line.strip_prefix("def ")?.split('(').next());
    let names = heads.map(str::trim).filter(|name| returns_nothing(text, name));
    names.fold(message, |message, name| format!("{message}; {}", without_return(name)))
}

/// Whether a line starts a top-level statement: it is neither indented nor a comment, and closes no bracket.
fn starts_statement(line: &str) -> bool {
    line.chars().next().is_some_and(|first| !first.is_whitespace() && !"#)]}".contains(first))
}

/// Whether the text has a function of this name without a `return` of its own.
fn returns_nothing(text: &str, name: &str) -> bool {
    let start = format!("def {name}(");
    let mut lines = text.lines().skip_while(|line| !line.starts_with(&start));
    if lines.next().is_none() {
        return false;
    }
    // A body on the same line as the `def` is not looked at: it has a single statement.
    !lines.take_while(|line| !starts_statement(line)).any(|line| line.trim_start().starts_with("return"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_statement_is_named() {
        for (text, wanted) in [
            ("a = sphere(1)\n", "add a line 'a'"),
            ("r = 2\nif r > 1:\n    sphere(r)\nelse:\n    box(1, 1, 1)\n", "an 'if' statement has no value"),
            ("for k in range(3):\n    sphere(k + 1)\n", "a loop has no value"),
            ("def ball(r):\n    return sphere(r)\n", "the definition of ball(): add a line that calls it"),
            ("def ball(r):\n    sphere(r)\n\nball(2)\n", "ball() returns nothing"),
            ("def ball(r):\n    return None\nball(2)\n", "must be an expression whose value is a shape"),
            ("# nothing\n", "no line with an expression"),
            ("print(\n    3,\n)\n", "must be an expression whose value is a shape"),
        ] {
            let advice = why_nothing(text);
            assert!(advice.contains(wanted), "{text}: {advice}");
        }
    }
}
