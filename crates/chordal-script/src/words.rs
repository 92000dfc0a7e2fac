//! The words of a script other than the functions of the language: built-in functions, constants and
//! keywords.
use crate::language::{
    self, FunctionParameter, ParameterDefault, ParameterKind as Kind, defaulting, optional, required,
    variadic,
};

/// A built-in function: one of Starlark's, or one that reads a file, a parameter or a shape's box.
#[derive(Debug)]
pub struct BuiltIn {
    /// Its name.
    pub name: &'static str,
    /// Its parameters, in order.
    pub parameters: &'static [FunctionParameter],
    /// Its result or its effect, in one sentence or two.
    pub about: &'static str,
    /// How far the result's value can be trusted as a distance; empty if the result is not a shape.
    pub distance: &'static str,
}

impl BuiltIn {
    /// Its signature, as in `param(name, default)`.
    #[must_use]
    pub fn usage(&self) -> String {
        language::usage(self.name, self.parameters)
    }
}

const fn plain(name: &'static str, parameters: &'static [FunctionParameter], about: &'static str) -> BuiltIn {
    BuiltIn { name, parameters, about, distance: "" }
}

const VALUE: &[FunctionParameter] = &[required("value").of(Kind::Any)];
const VALUES: &[FunctionParameter] = &[required("values").of(Kind::Any)];
const ANY: &[FunctionParameter] = &[variadic("values").of(Kind::Any)];

/// Every built-in function: Chordal's own first, then Starlark's.
pub const BUILT_INS: &[BuiltIn] = &[
    plain(
        "param",
        &[required("name").of(Kind::Text), required("default")],
        "A number that can be set by its name from outside the script; otherwise the default.",
    ),
    BuiltIn {
        name: "mesh",
        parameters: &[required("name").of(Kind::Text)],
        about: "The triangle mesh in a file beside the script, as a shape.",
        distance: "exact distance; sign only if the mesh is not closed",
    },
    BuiltIn {
        name: "svg",
        parameters: &[required("name").of(Kind::Text), required("tolerance")],
        about: "The filled area of a drawing in a file beside the script, as a 2D shape. Its curves are \
            replaced by polygons within the tolerance.",
        distance: "exact distance to the boundary of the filled area",
    },
    BuiltIn {
        name: "text",
        parameters: &[
            required("text").of(Kind::Text),
            required("font").of(Kind::Text),
            required("tolerance"),
            optional("em", 1.0),
            defaulting("align", ParameterDefault::Text("left")).of(Kind::Text),
        ],
        about: "The letters of a text in a font beside the script, as a 2D shape. Their curves are \
            replaced by polygons within the tolerance. Lines start at x = 0; if aligned \"center\" or \
            \"right\", they are centred there or end there, by their advance widths. Axes of a variable \
            font are set by their tags, as in wght=700.",
        distance: "exact distance to the boundary of the filled area",
    },
    BuiltIn {
        name: "heightmap",
        parameters: &[
            required("name").of(Kind::Text),
            required("size").of(Kind::Vector),
            required("height"),
            required("base"),
        ],
        about: "The solid below a PNG beside the script, whose grey values are taken as heights. The size \
            is two lengths along x and y; the floor is at z = 0, black is above it by the base, and white \
            above black by the height.",
        distance: "exact distance",
    },
    plain(
        "box_of",
        &[required("shape").of(Kind::Shape)],
        "A box that contains the shape, as a dictionary of lists of three numbers, or of two for 2D \
         shapes: \"min\" and \"max\" are its lowest and highest corner, \"size\" and \"center\" its side \
         lengths and centre. It may be larger than necessary.",
    ),
    plain(
        "check",
        &[required("condition").of(Kind::Any), required("message").of(Kind::Text)],
        "Ends the script with a message unless the condition holds.",
    ),
    plain("fail", &[required("message").of(Kind::Text)], "Ends the script with a message."),
    plain("print", ANY, "Adds a line with the values to the script's report."),
    plain("abs", VALUE, "The absolute value of a number or formula."),
    plain("bool", VALUE, "False if the value is 0, empty or None; otherwise True."),
    plain("enumerate", VALUES, "The items of a list, each as a pair with its index from 0."),
    plain("float", VALUE, "The value as a floating-point number."),
    plain("int", VALUE, "The number without its fraction, as an integer."),
    plain("len", VALUE, "The number of items of a list or dictionary, or of characters of a string."),
    plain("list", VALUES, "A new list of the items of a list or tuple, or of the keys of a dictionary."),
    plain("max", ANY, "The largest of several numbers, or of the numbers in a list."),
    plain("min", ANY, "The smallest of several numbers, or of the numbers in a list."),
    plain(
        "range",
        &[required("first"), defaulting("end", ParameterDefault::Nothing), optional("step", 1.0)],
        "The integers from the first up to the end, without the end itself; with a single number, those \
         from 0 up to it.",
    ),
    plain("reversed", VALUES, "The items of a list in reverse order."),
    plain("str", VALUE, "The value as a string."),
    plain("sum", VALUES, "The sum of the numbers or formulas in a list."),
    plain("tuple", VALUES, "A tuple of the items of a list."),
    plain(
        "zip",
        &[variadic("lists").of(Kind::Any)],
        "A tuple of the first items of all lists, then one of the second items, and so on to the end of \
         the shortest list.",
    ),
];

/// The names that stand for a value: the coordinates, pi, and Starlark's constants.
pub const CONSTANTS: &[&str] = &["x", "y", "z", "pi", "True", "False", "None"];

/// The keywords that a script can use, in the order of the alphabet.
pub const KEYWORDS: &[&str] = &[
    "and", "break", "continue", "def", "elif", "else", "for", "if", "in", "lambda", "load", "not", "or",
    "pass", "return",
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operators::OPERATORS;
    use crate::script::globals;
    use crate::{RunOptions, run};
    use std::collections::BTreeSet;

    #[test]
    fn a_script_has_these_words_and_no_others() {
        let globals = globals();
        // Calls, indices and keys are rewritten to calls of functions whose names end in underscores.
        let is_documented = |name: &str| !name.ends_with("__") && !OPERATORS.contains(&name);
        let defined: BTreeSet<String> =
            globals.names().map(|name| name.as_str().to_owned()).filter(|name| is_documented(name)).collect();
        let documented: Vec<&str> = language::functions()
            .map(|function| function.name)
            .chain(BUILT_INS.iter().map(|built_in| built_in.name))
            .chain(CONSTANTS.iter().copied())
            .collect();
        assert_eq!(documented.iter().map(|name| (*name).to_owned()).collect::<BTreeSet<_>>(), defined);
        assert_eq!(documented.len(), defined.len(), "none twice");
    }

    #[test]
    fn keywords_are_no_names() {
        for word in KEYWORDS {
            let result =
                run(&format!("{word} = 1\nsphere({word})\n"), &RunOptions::default(), &Default::default());
            assert_eq!(result.unwrap_err().code, "script-syntax", "{word}");
        }
        assert!(KEYWORDS.is_sorted());
    }

    #[test]
    fn every_built_in_says_what_it_does_and_takes_what_it_says() {
        for built_in in BUILT_INS {
            assert!(built_in.about.ends_with('.'), "{}", built_in.name);
            let is_shape = ["mesh", "svg", "text", "heightmap"].contains(&built_in.name);
            assert_eq!(built_in.distance.is_empty(), !is_shape, "{}", built_in.name);
        }
        for call in [
            "param('r', 2)",
            "box_of(sphere(2))['max'][0]",
            "abs(-2)",
            "2 if bool(3) else 1",
            "len(enumerate([3, 4]))",
            "float(2)",
            "int(2.5)",
            "len([3, 4])",
            "list((2, 3))[0]",
            "max(1, 2)",
            "min([2, 3])",
            "len(range(2))",
            "range(2, 9)[0]",
            "range(2, 9, 3)[0]",
            "reversed([3, 2])[0]",
            "len(str(12))",
            "sum([1, 1])",
            "tuple([2])[0]",
            "zip([2], [3])[0][0]",
        ] {
            let script = run(&format!("sphere({call})"), &RunOptions::default(), &Default::default());
            let mut values = [0.0];
            script.unwrap().field.tape().at(&[[0.0; 3]], &mut values).unwrap();
            assert_eq!(values, [-2.0], "{call}");
        }
    }

    /// The words before an opening parenthesis.
    fn called(text: &str) -> Vec<&str> {
        let starts = text.match_indices('(').map(|(at, _)| &text[..at]);
        let word =
            |before: &'_ str| before.rfind(|c: char| !c.is_alphanumeric() && c != '_').map_or(0, |at| at + 1);
        starts.map(|before| &before[word(before)..]).filter(|word| !word.is_empty()).collect()
    }

    #[test]
    fn every_answer_to_another_tools_name_is_a_function_and_no_such_name_is_one() {
        let known: BTreeSet<&str> = language::functions()
            .map(|function| function.name)
            .chain(BUILT_INS.iter().map(|function| function.name))
            .collect();
        let mut seen = BTreeSet::new();
        for (names, equivalent) in crate::other_tools::NAMES {
            let words = called(equivalent);
            assert!(!words.is_empty() || equivalent.contains("fillet="), "{equivalent}");
            words.iter().for_each(|word| assert!(known.contains(word), "{word} in '{equivalent}'"));
            for name in *names {
                assert!(seen.insert(*name), "{name} twice");
                assert!(!known.contains(name), "{name} is a function of the language");
            }
        }
    }
}
