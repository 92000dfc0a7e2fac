//! What is written from the table of functions: the functions of the Python package, and lists on two pages of
//! the docs. `CHORDAL_WRITE_LANGUAGE=1` writes them anew.
use chordal_script::language::{
    Function, FunctionParameter, ParameterDefault, ParameterKind, functions, groups,
};
use chordal_testkit::{assert_written, path_in_tree};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::ops::Range;

/// The variable that has the files written anew.
const SWITCH: &str = "CHORDAL_WRITE_LANGUAGE";

// Python.

/// The beginning of the module.
const HEAD: &str = r#""""The functions of shape scripts, by the same names: the text of a script also runs in Python.

The page on shape scripts describes each of them, and the quality of its value as a distance. Written from
the table in `crates/chordal-script/src/language` by
`CHORDAL_WRITE_LANGUAGE=1 cargo test -p chordal-script --test written`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, SupportsFloat, overload

from chordal._curve import Curve
from chordal._field import Field, Formula, called
from chordal._hints import keywords_hinted

if TYPE_CHECKING:
    from typing import TypeAlias

    from numpy.typing import NDArray

    #: Three numbers, or two in the plane.
    _Vector: TypeAlias = Sequence[SupportsFloat] | NDArray[Any]
    #: Points, each of two or three numbers.
    _Points: TypeAlias = Sequence[Sequence[SupportsFloat]] | NDArray[Any]


def _parts(name: str, vector: Any, y: object, least: int) -> Sequence[Any]:
    """The components of a vector that is given in place of separate numbers."""
    parts = vector.tolist() if hasattr(vector, "tolist") else vector
    if y is not None or not isinstance(parts, (list, tuple)) or not least <= len(parts) <= 3:
        raise TypeError(f"{name}: x, y and z are three numbers, or one vector as in (1, 2, 3)")
    return parts
"#;

/// The end of the module.
const TAIL: &str = r#"

for _name in __all__:
    # Guessed keywords, as in sphere(r=1), get an error that names the right one.
    globals()[_name] = keywords_hinted(globals()[_name])
"#;

/// The most columns of a signature, and of a text. Defined: the package has at most 140.
const SIGNATURE_COLUMNS: usize = 130;
const TEXT_COLUMNS: usize = 120;

/// The functions that also take x, y and z as one vector in Python.
const BY_VECTOR: [&str; 5] = ["box", "ellipsoid", "move", "stretch", "mirror"];

/// The functions that have a body of their own in Python: `field` also takes functions of points, and those
/// that make paths take arrays.
fn has_own_body(group: &str, function: &Function) -> bool {
    group == "Paths" || function.name == "field"
}

/// The type of a parameter.
fn annotation(parameter: &FunctionParameter) -> String {
    let one = match parameter.kind {
        ParameterKind::Number => "SupportsFloat",
        ParameterKind::Numbers | ParameterKind::Vector => "Sequence[SupportsFloat]",
        ParameterKind::Text => "str",
        ParameterKind::Truth => "bool",
        ParameterKind::Points => "_Points",
        ParameterKind::Path => "Curve | _Points",
        ParameterKind::Shape => "Field",
        ParameterKind::Shapes => "Sequence[Field]",
        ParameterKind::PointsOrShapes => "_Points | Field | Sequence[Field]",
        ParameterKind::ShapeOrNumber => "Field | SupportsFloat",
        ParameterKind::Formula => "Formula | float",
        ParameterKind::Color => "str | Sequence[SupportsFloat]",
        ParameterKind::Any => "Any",
    };
    match (parameter.rest, parameter.default) {
        (true, _) => format!("{one} | Sequence[{one}]"),
        (false, Some(ParameterDefault::Nothing)) => format!("{one} | None"),
        (false, _) => one.to_owned(),
    }
}

/// A parameter as it is declared.
fn declared(parameter: &FunctionParameter) -> String {
    let star = if parameter.rest { "*" } else { "" };
    let default = parameter.default.map(|default| format!(" = {default}")).unwrap_or_default();
    format!("{star}{}: {}{default}", parameter.name, annotation(parameter))
}

/// The arguments of a call with the parameters themselves. After one that takes the rest, they are given by
/// name.
fn passed(parameters: &[FunctionParameter]) -> Vec<String> {
    let n_before = parameters.iter().take_while(|parameter| !parameter.rest).count();
    let pass = |(k, parameter): (usize, &FunctionParameter)| match parameter.name {
        name if parameter.rest => format!("*{name}"),
        name if k > n_before => format!("{name}={name}"),
        name => name.to_owned(),
    };
    parameters.iter().enumerate().map(pass).collect()
}

/// The call of a function of the language.
fn call(name: &str, args: &[String]) -> String {
    format!("return called(\"{name}\", {})  # type: ignore[no-any-return]\n", args.join(", "))
}

/// The line or lines that declare a function.
fn header(name: &str, parameters: &[String]) -> String {
    let joined = parameters.join(", ");
    let line = format!("def {name}({joined}) -> Field:");
    if line.len() <= SIGNATURE_COLUMNS {
        return format!("{line}\n");
    }
    let inner = if joined.len() + 4 <= TEXT_COLUMNS {
        format!("    {joined}\n")
    } else {
        parameters.iter().map(|parameter| format!("    {parameter},\n")).collect()
    };
    format!("def {name}(\n{inner}) -> Field:\n")
}

/// A text in indented lines.
fn wrapped(text: &str) -> String {
    let (mut lines, mut line) = (String::new(), "   ".to_owned());
    for word in text.split(' ') {
        if line.chars().count() + 1 + word.chars().count() > TEXT_COLUMNS {
            lines.push_str(&line);
            lines.push('\n');
            "   ".clone_into(&mut line);
        }
        line.push(' ');
        line.push_str(word);
    }
    lines + &line
}

/// The docstring of a function that makes a shape.
fn docstring(function: &Function) -> String {
    let has_notes = function.parameters.iter().any(|parameter| parameter.name == "tolerance");
    let notes = if has_notes { " `Field.notes` has the distance that was reached." } else { "" };
    let about = wrapped(&format!("\"\"\"{}{notes}", function.about));
    format!("{about}\n\n    The value is: {}.\n    \"\"\"\n", function.distance)
}

/// A function that makes a shape.
fn shape_function(function: &Function) -> String {
    let parameters: Vec<String> = function.parameters.iter().map(declared).collect();
    let call = call(function.name, &passed(function.parameters));
    format!("{}{}    {call}", header(function.name, &parameters), docstring(function))
}

/// The same for a function that also takes x, y and z as one vector.
fn vector_function(function: &Function) -> String {
    let name = function.name;
    let is_component = |parameter: &&FunctionParameter| ["x", "y", "z"].contains(&parameter.name);
    let components: Vec<_> = function.parameters.iter().filter(is_component).collect();
    let leading = &function.parameters[..function.parameters.len() - components.len()];
    let least = components.iter().filter(|component| component.default.is_none()).count();
    let with = |parts: Vec<String>| leading.iter().map(declared).chain(parts).collect::<Vec<String>>();
    let with_vector = |first: &str, of: &dyn Fn(&FunctionParameter) -> String| {
        let others = components[1..].iter().map(|component| format!("{}: {}", component.name, of(component)));
        with([format!("x: {first}")].into_iter().chain(others).collect())
    };
    let numbers = components.iter().map(|component| {
        let default = if component.default.is_some() { " = ..." } else { "" };
        format!("{}: SupportsFloat{default}", component.name)
    });
    let vector = with_vector("_Vector", &|component| match component.default {
        Some(_) => "SupportsFloat = ...".to_owned(),
        None => "None = None".to_owned(),
    });
    let both = with_vector("SupportsFloat | _Vector", &|component| match component.default {
        Some(default) => format!("SupportsFloat = {default}"),
        None => "SupportsFloat | None = None".to_owned(),
    });
    let mut text = String::new();
    for parameters in [with(numbers.collect()), vector] {
        writeln!(text, "@overload\ndef {name}({}) -> Field: ...", parameters.join(", ")).unwrap();
    }
    let missing = components[1..].iter().filter(|component| component.default.is_none());
    let missing: Vec<String> = missing.map(|component| format!("{} is None", component.name)).collect();
    let mut args = passed(leading);
    args.push(format!("*_parts(\"{name}\", x, y, {least})"));
    text + &header(name, &both)
        + &docstring(function)
        + &format!("    if {}:\n        {}", missing.join(" or "), call(name, &args))
        + &format!("    {}", call(name, &passed(function.parameters)))
}

/// A function of numbers and formulas.
fn formula_function(function: &Function) -> String {
    let name = function.name;
    let all = |kind: &str| {
        let parameters = function.parameters.iter().map(|parameter| format!("{}: {kind}", parameter.name));
        parameters.collect::<Vec<String>>().join(", ")
    };
    let (numbers, formulas) = (all("SupportsFloat"), all("Formula | SupportsFloat"));
    format!(
        "@overload\ndef {name}({numbers}) -> float: ...\n@overload\n\
         def {name}({formulas}) -> Formula | float: ...\n\
         def {name}({formulas}) -> Formula | float:\n{}\"\"\"\n    {}",
        wrapped(&format!("\"\"\"{}", function.about)),
        call(name, &passed(function.parameters)),
    )
}

#[test]
fn the_python_package_has_every_function() {
    let (mut names, mut text) = (String::new(), String::new());
    for (group, functions) in groups() {
        for function in functions.iter().filter(|function| !has_own_body(group, function)) {
            writeln!(names, "    \"{}\",", function.name).unwrap();
            text.push_str("\n\n");
            text.push_str(&match group {
                "Formulas" => formula_function(function),
                _ if BY_VECTOR.contains(&function.name) => vector_function(function),
                _ => shape_function(function),
            });
        }
    }
    let names = format!("\n__all__ = [\n{names}]\n");
    let (imports, helpers) = HEAD.split_once("\nif TYPE_CHECKING").unwrap();
    let text = format!("{imports}{names}\nif TYPE_CHECKING{helpers}{text}{TAIL}");
    assert_written(SWITCH, "python/chordal/_language.py", &text);
}

/// A list in a module, which begins and ends with these lines: where its entries are in the text.
fn entries(text: &str, first: &str, last: &str) -> Range<usize> {
    let start = text.find(first).expect("the first line of a list") + first.len();
    start..start + text[start..].find(last).expect("the last line of a list")
}

#[test]
fn the_module_of_shapes_has_every_function() {
    let path = "python/chordal/shapes.py";
    let mut text = std::fs::read_to_string(path_in_tree(path)).unwrap();
    let names = |lines: &str| -> BTreeSet<String> {
        lines.lines().map(|line| line.trim_matches([' ', '"', ',']).to_owned()).collect()
    };
    let imports = entries(&text, "\nfrom chordal._language import (\n", ")\n");
    let earlier = names(&text[imports.clone()]);
    let written = groups().into_iter().flat_map(|(group, functions)| {
        functions.iter().filter(move |function| !has_own_body(group, function))
    });
    let written: BTreeSet<String> = written.map(|function| function.name.to_owned()).collect();
    text.replace_range(imports, &written.iter().map(|name| format!("    {name},\n")).collect::<String>());
    // The other names are of functions and values that are written by hand.
    let exports = entries(&text, "\n__all__ = [\n", "]\n");
    let others = names(&text[exports.clone()]).difference(&earlier).cloned().collect();
    let all = written.union(&others).map(|name| format!("    \"{name}\",\n"));
    text.replace_range(exports, &all.collect::<String>());
    assert_written(SWITCH, path, &text);
}

// The docs.

/// The sentences about each function on a page, which may have links and other marks that the table has not.
fn sentences(page: &str) -> BTreeMap<&str, &str> {
    page.lines()
        .filter_map(|line| {
            let (usage, rest) = line.strip_prefix("| `")?.split_once("` | ")?;
            let (name, _) = usage.split_once('(')?;
            let cells = rest.strip_suffix(" |")?;
            Some((name, cells.split_once(" | ").map_or(cells, |(sentences, _)| sentences)))
        })
        .collect()
}

/// A text of the page without its marks: of a link, the words.
fn plain(text: &str) -> String {
    let (mut words, mut rest) = (String::new(), text);
    while let Some((before, after)) = rest.split_once("](") {
        let (start, link) = before.rsplit_once('[').expect("the start of a link");
        words.extend([start, link]);
        rest = after.split_once(')').expect("the end of a link").1;
    }
    words.push_str(rest);
    words.replace("\\|", "|").replace('`', "")
}

/// The row of a function in a table with a column for the distance, or without one.
fn row(function: &Function, sentences: &BTreeMap<&str, &str>, has_distance: bool) -> String {
    let about = match (has_distance || function.distance.is_empty(), function.about.replace('|', "\\|")) {
        (true, about) => about,
        (false, about) => format!("{about} The value is: {}.", function.distance),
    };
    let about = sentences.get(function.name).map_or(about, |&sentences| sentences.to_owned());
    let distance = if has_distance { format!(" {} |", function.distance) } else { String::new() };
    format!("| `{}` | {about} |{distance}\n", function.usage())
}

#[test]
fn the_page_on_scripts_lists_every_function() {
    let path = "docs/shape-scripts.md";
    let page = std::fs::read_to_string(path_in_tree(path)).unwrap();
    let sentences = sentences(&page);
    for function in functions() {
        let first = function.about.split(". ").next().unwrap().trim_end_matches('.');
        let is_same = |sentences: &&str| plain(sentences).starts_with(&plain(first));
        assert!(sentences.get(function.name).is_none_or(is_same), "{}: {first}", function.name);
    }
    let (mut text, mut group, mut is_written) = (String::new(), None, false);
    for line in page.lines() {
        if let Some(title) = line.strip_prefix("### ") {
            group = groups().into_iter().find(|(name, _)| *name == title);
        }
        // Rows of a table that was just written.
        is_written = is_written && line.starts_with("| ");
        if is_written {
            continue;
        }
        writeln!(text, "{line}").unwrap();
        if let (Some((_, functions)), true) = (group, line.starts_with("|---|---|")) {
            let has_distance = line == "|---|---|---|";
            text.extend(functions.iter().map(|function| row(function, &sentences, has_distance)));
            is_written = true;
        }
    }
    assert_written(SWITCH, path, &text);
}

/// The section of the Python reference in which the functions of a group are listed, unless they are already
/// listed elsewhere.
fn section(group: &str) -> Option<&str> {
    match group {
        "Paths" => None,
        "Placing" => Some("Moving, turning, repeating"),
        "Changing" => Some("Changing the shape"),
        other => Some(other),
    }
}

#[test]
fn the_reference_of_the_python_package_lists_every_function() {
    let path = "docs/reference/shapes.md";
    let mut text = std::fs::read_to_string(path_in_tree(path)).unwrap();
    for (group, functions) in groups() {
        let Some(section) = section(group) else { continue };
        for function in functions {
            let line = format!("::: chordal.shapes.{}\n", function.name);
            if text.contains(&line) {
                continue;
            }
            let start = text.find(&format!("\n## {section}\n")).expect("the section of a group") + 1;
            let end = text[start..].find("\n## ").map_or(text.len(), |length| start + length);
            let last = text[start..end].rfind("\n::: ").expect("a list of functions") + start + 1;
            let after = text[last..].find('\n').map_or(text.len(), |length| last + length + 1);
            text.insert_str(after, &line);
        }
    }
    assert_written(SWITCH, path, &text);
    assert_eq!(text.matches("::: chordal.shapes.sphere\n").count(), 1);
    assert!(functions().count() > 70);
}
