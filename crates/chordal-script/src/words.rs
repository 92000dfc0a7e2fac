//! The words of a script other than the functions of the language: built-in functions, constants and
//! keywords.
use crate::language::{self, FunctionParameter, ParameterDefault, defaulting, optional, required, variadic};

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

const VALUE: &[FunctionParameter] = &[required("value")];
const VALUES: &[FunctionParameter] = &[required("values")];
const ANY: &[FunctionParameter] = &[variadic("values")];

/// Every built-in function: Chordal's own first, then Starlark's.
pub const BUILT_INS: &[BuiltIn] = &[
    plain(
        "param",
        &[required("name"), required("default")],
        "A number that is set from outside, by its name; its default otherwise.",
    ),
    BuiltIn {
        name: "mesh",
        parameters: &[required("name")],
        about: "The triangles of a file beside the script, as a shape.",
        distance: "exact; a sign where they are not closed",
    },
    BuiltIn {
        name: "svg",
        parameters: &[required("name"), required("tolerance")],
        about: "What a drawing in a file beside the script fills, as a shape of the plane; its curves are polygons within \
                the tolerance.",
        distance: "exact; where outlines cross, of what they fill",
    },
    BuiltIn {
        name: "text",
        parameters: &[
            required("text"),
            required("font"),
            required("tolerance"),
            optional("em", 1.0),
            defaulting("align", ParameterDefault::Text("left")),
        ],
        about: "The letters of a text in a font beside the script, as a shape of the plane; their curves are polygons \
                within the tolerance. Lines start at x = 0; aligned as \"center\" or \"right\" their advance widths are centred \
                or end there. Axes of the font go by their tags, as wght=700.",
        distance: "exact; where outlines cross, of what they fill",
    },
    BuiltIn {
        name: "heightmap",
        parameters: &[required("name"), required("size"), required("height"), required("base")],
        about: "The solid below the heights that the greys of a PNG beside the script are: two lengths wide, from z = 0 by \
                a base to black, and by the height to white.",
        distance: "exact",
    },
    plain(
        "box_of",
        &[required("shape")],
        "A box that holds the shape, as a dictionary: its lowest and highest corner as \"min\" and \"max\", \"size\" and \
         \"center\", each of three numbers, or of two without an end along z. It may be larger than need be.",
    ),
    plain(
        "check",
        &[required("condition"), required("message")],
        "Ends the script with a message unless the condition holds.",
    ),
    plain("fail", &[required("message")], "Ends the script with a message."),
    plain("print", ANY, "Adds a line to what is said of the script."),
    plain("abs", VALUE, "The size of a number or of a formula, without its sign."),
    plain("bool", VALUE, "Whether a value is neither 0 nor empty nor None."),
    plain("enumerate", VALUES, "The items of a list, each as a pair with its index from 0."),
    plain("float", VALUE, "The value as a number that need not be whole."),
    plain("int", VALUE, "The number without its fraction."),
    plain("len", VALUE, "How many items a list, dictionary or text has."),
    plain("list", VALUES, "The items of a list or tuple, or the keys of a dictionary, as a new list."),
    plain("max", ANY, "The largest of some numbers, or of those in a list."),
    plain("min", ANY, "The smallest of some numbers, or of those in a list."),
    plain(
        "range",
        &[required("first"), defaulting("end", ParameterDefault::Nothing), optional("step", 1.0)],
        "The whole numbers from the first up to but without the end; of one number alone, those from 0 up to it.",
    ),
    plain("reversed", VALUES, "The items of a list, the last first."),
    plain("str", VALUE, "The value as a text."),
    plain("sum", VALUES, "The sum of the numbers or formulas in a list."),
    plain("tuple", VALUES, "The items of a list as a tuple."),
    plain(
        "zip",
        &[variadic("lists")],
        "The first items of all lists together, then the second, up to the end of the shortest.",
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
