//! What to write instead, where a script says what other languages would take.
use crate::ScriptError;

/// What stands for a power.
pub(crate) const POWERS: &str = "write x * x for a square, and exp(b * log(a)) for a to the power of b";

/// An error of the parser with what to write instead.
pub(crate) fn with_advice(error: ScriptError) -> ScriptError {
    if !error.message.contains("unexpected symbol '**'") {
        return error;
    }
    ScriptError { message: format!("there is no '**': {POWERS}"), ..error }
}

/// The rest of a sentence "the script's value must be a shape, and is nothing: …" for a text.
pub(crate) fn why_nothing(text: &str) -> String {
    let last = text.lines().rfind(|line| starts_statement(line)).unwrap_or("");
    let word: String = last.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    let rest = last[word.len()..].trim_start();
    match word.as_str() {
        "if" | "elif" | "else" => {
            "an 'if' has no value: give the shape a name in each branch, and let the last line be that name"
                .to_owned()
        }
        "for" => "a loop has no value: collect its shapes in a list, and let the last line be union(…) of it"
            .to_owned(),
        "def" => {
            let name = rest.split('(').next().unwrap_or("").trim();
            format!("it ends with what {name}() is: let the last line be a call of it")
        }
        name if rest.starts_with('(') && returns_nothing(text, name) => without_return(name),
        name if rest.starts_with('=') && !name.is_empty() => {
            format!("its last line must be an expression, not an assignment: add a line '{name}'")
        }
        "" | "load" => "it has no last line that is a shape".to_owned(),
        _ => "its last line must be an expression whose value is a shape".to_owned(),
    }
}

fn without_return(name: &str) -> String {
    format!("{name}() returns nothing: let it end with 'return' and a shape")
}

/// A message about nothing where a shape is needed, with the functions of a text that return nothing.
pub(crate) fn with_missing_return(message: String, text: &str) -> String {
    if !message.contains("what a function without 'return' gives") {
        return message;
    }
    let heads = text.lines().filter_map(|line| line.strip_prefix("def ")?.split('(').next());
    let names = heads.map(str::trim).filter(|name| returns_nothing(text, name));
    names.fold(message, |said, name| format!("{said}; {}", without_return(name)))
}

/// Whether a line starts a statement of the script itself: it is not indented, and closes nothing.
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
    // What stands behind the head on its own line is not looked at: such a function has one statement.
    !lines.take_while(|line| !starts_statement(line)).any(|line| line.trim_start().starts_with("return"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_statement_is_named() {
        for (text, wanted) in [
            ("a = sphere(1)\n", "add a line 'a'"),
            ("r = 2\nif r > 1:\n    sphere(r)\nelse:\n    box(1, 1, 1)\n", "an 'if' has no value"),
            ("for k in range(3):\n    sphere(k + 1)\n", "a loop has no value"),
            ("def ball(r):\n    return sphere(r)\n", "ball() is: let the last line be a call of it"),
            ("def ball(r):\n    sphere(r)\n\nball(2)\n", "ball() returns nothing"),
            ("def ball(r):\n    return None\nball(2)\n", "must be an expression whose value is a shape"),
            ("# nothing\n", "no last line that is a shape"),
            ("print(\n    3,\n)\n", "must be an expression whose value is a shape"),
        ] {
            let told = why_nothing(text);
            assert!(told.contains(wanted), "{text}: {told}");
        }
    }
}
