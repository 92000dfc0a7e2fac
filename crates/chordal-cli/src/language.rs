//! `chordal language`: the functions of shape scripts, for people and for editors.
use crate::console::print;
use crate::fault::Fault;
use chordal_script::language::{FunctionParameter, groups};
use chordal_script::words::{BUILT_INS, CONSTANTS, KEYWORDS};
use clap::Args;
use serde::Serialize;
use std::fmt::Write;

/// The version of the document, described by `docs/schema/language.schema.json`.
const SCHEMA: &str = "chordal.language/1";

/// The group of Starlark's own functions, after the groups of the language's table.
const REST: &str = "The rest";

/// `chordal language`
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  chordal language
  chordal language --json")]
pub struct LanguageArgs {
    /// Print one JSON object, for completion in editors
    #[arg(long)]
    pub json: bool,
}

/// All words that a script can use.
#[derive(Serialize)]
struct LanguageDocument {
    schema: &'static str,
    functions: Vec<FunctionRow>,
    constants: &'static [&'static str],
    keywords: &'static [&'static str],
}

/// One function.
#[derive(Serialize)]
struct FunctionRow {
    name: &'static str,
    group: &'static str,
    usage: String,
    /// How far the value can be trusted as a distance; `None` if the result is no shape.
    worth: Option<&'static str>,
    doc: &'static str,
    parameters: Vec<ParameterRow>,
}

/// One parameter, with its default as a script would write it.
#[derive(Serialize)]
struct ParameterRow {
    name: &'static str,
    default: Option<String>,
    rest: bool,
}

impl LanguageDocument {
    fn new() -> Self {
        let table_rows = groups().into_iter().flat_map(|(group, functions)| {
            functions.iter().map(move |function| FunctionRow {
                name: function.name,
                group,
                usage: function.usage(),
                worth: worth(function.distance),
                doc: function.about,
                parameters: rows(function.parameters),
            })
        });
        let starlark_rows = BUILT_INS.iter().map(|built_in| FunctionRow {
            name: built_in.name,
            group: REST,
            usage: built_in.usage(),
            worth: worth(built_in.distance),
            doc: built_in.about,
            parameters: rows(built_in.parameters),
        });
        let functions = table_rows.chain(starlark_rows).collect();
        Self { schema: SCHEMA, functions, constants: CONSTANTS, keywords: KEYWORDS }
    }

    /// The list for people.
    fn text(&self) -> String {
        let mut text = String::new();
        let mut group = "";
        for function in &self.functions {
            if group != function.group {
                let gap = if group.is_empty() { "" } else { "\n" };
                group = function.group;
                // Writing to a string does not fail.
                let _ = writeln!(text, "{gap}{group}");
            }
            let _ = writeln!(text, "  {}\n      {}", function.usage, function.doc);
            if let Some(worth) = function.worth {
                let _ = writeln!(text, "      The value is: {worth}.");
            }
        }
        let _ = writeln!(text, "\nConstants\n  {}", self.constants.join(" "));
        let _ = writeln!(text, "\nKeywords\n  {}", self.keywords.join(" "));
        text
    }
}

fn worth(distance: &'static str) -> Option<&'static str> {
    (!distance.is_empty()).then_some(distance)
}

fn rows(parameters: &[FunctionParameter]) -> Vec<ParameterRow> {
    let row = |p: &FunctionParameter| ParameterRow {
        name: p.name,
        default: p.default.map(|default| default.to_string()),
        rest: p.rest,
    };
    parameters.iter().map(row).collect()
}

/// Prints the functions.
pub fn run(args: &LanguageArgs) -> Result<(), Fault> {
    let document = LanguageDocument::new();
    if args.json {
        return print(&format!("{}\n", serde_json::to_string_pretty(&document).unwrap_or_default()));
    }
    print(&document.text())
}
