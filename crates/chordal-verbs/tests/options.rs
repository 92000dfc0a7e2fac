//! The files that are written from the tables of options: `docs/options.md`, and what the Python package knows of them.
//! `CHORDAL_WRITE_OPTIONS=1` writes them anew.
use chordal_testkit::assert_written;
use chordal_verbs::options::{
    BakeOptions, ConvertOptions, InspectOptions, LodOptions, MendOptions, MeshOptions, OptionRow,
    OptionTable, OptionValues, OutputOptions, PictureOptions, ReadOptions, VerifyOptions, spelled_help,
};
use chordal_verbs::{DeviationSpec, SurfaceSpec};
use std::fmt::Write;

/// The variable that has the files written anew.
const SWITCH: &str = "CHORDAL_WRITE_OPTIONS";

fn form(values: OptionValues) -> &'static str {
    match values {
        OptionValues::Flag => "flag",
        OptionValues::Count => "count",
        OptionValues::Number => "number",
        OptionValues::Length => "length",
        OptionValues::Time => "time",
        OptionValues::Words(_) => "word",
        OptionValues::Text => "text",
    }
}

fn python_table<S: OptionTable>(name: &str) -> String {
    let rows = S::ROWS.iter().filter_map(|row| {
        Some(format!("    \"{}\": (\"{}\", \"{}\"),\n", row.keyword()?, row.name, form(row.values)))
    });
    format!("{name}: Final[dict[str, tuple[str, str]]] = {{\n{}}}\n", rows.collect::<String>())
}

#[test]
fn the_python_package_has_the_same_tables() {
    let text = format!(
        "\"\"\"The options of the command by keyword, each with the form of its values. Written from the tables in \n\
         `crates/chordal-verbs/src/options` by `CHORDAL_WRITE_OPTIONS=1 cargo test -p chordal-verbs --test all options`.\"\"\"\n\n\
         from __future__ import annotations\n\n\
         from typing import Final\n\n{}",
        [
            python_table::<ReadOptions>("READING"),
            python_table::<OutputOptions>("OUTPUT"),
            python_table::<MendOptions>("REPAIRS"),
            python_table::<MeshOptions>("MESH"),
            python_table::<LodOptions>("LOD"),
            python_table::<SurfaceSpec>("SURFACE"),
            python_table::<BakeOptions>("BAKE"),
            python_table::<DeviationSpec>("DEVIATION"),
            python_table::<PictureOptions>("PICTURE"),
        ]
        .join("\n"),
    );
    assert_written(SWITCH, "python/chordal/_option_tables.py", &text.replace("tables in \n", "tables in\n"));
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

fn markdown_row<S>(row: &OptionRow<S>) -> String {
    let value = match (row.value_name, row.bare) {
        ("", _) => String::new(),
        (name, None) => format!(" {name}"),
        (name, Some(_)) => format!("[={name}]"),
    };
    let spelled = |name: &str, value: Option<&str>| match value {
        Some(value) => format!("`--{name} {value}`"),
        None => format!("`--{name}`"),
    };
    let mut help = format!("{}.", cell(&spelled_help(row.help, spelled)));
    if let OptionValues::Words(words) = row.values {
        let words: Vec<String> =
            words.iter().map(|(word, help)| format!("`{word}` ({})", spelled_help(help, spelled))).collect();
        write!(help, " One of: {}.", words.join("; ")).unwrap();
    }
    if let Some(default) = row.default {
        write!(help, " Default: `{default}`.").unwrap();
    }
    if let Some(needed) = row.needs {
        match needed {
            "budget" => {}
            "orienting" => help.push_str(" Needs `--orient` or `--all`."),
            option => write!(help, " Needs `--{option}`.").unwrap(),
        }
    }
    let keyword = row.keyword().map_or_else(|| "–".to_owned(), |keyword| format!("`{keyword}`"));
    format!("| `--{}{value}` | {keyword} | {help} |\n", row.name)
}

fn markdown_table<S: OptionTable>(title: &str) -> String {
    let rows: String = S::ROWS.iter().map(markdown_row).collect();
    format!("## {title}\n| option | keyword | what it does |\n|---|---|---|\n{rows}\n")
}

#[test]
fn the_page_of_options_is_written_from_the_tables() {
    let text = format!(
        "# Options\n\n\
         The options of all verbs: as the command spells them, and as keywords of Python if a method takes them. In the web \n\
         module those of inputs, outputs, meshes and volumes are keys of JSON, with `_` for `-`, except `within`, `level` and \n\
         `separate`. Files, conditions of success, reports, threads and memory are set by options of the command alone, which \n\
         its help lists. This page is written from the tables in `crates/chordal-verbs/src/options`.\n\n{}",
        [
            markdown_table::<ReadOptions>("Inputs"),
            markdown_table::<OutputOptions>("Outputs of `mesh`, `lod`, `mend` and `convert`"),
            markdown_table::<MeshOptions>("Meshes"),
            markdown_table::<LodOptions>("Levels of detail"),
            markdown_table::<SurfaceSpec>("Volumes"),
            markdown_table::<MendOptions>("Repairs"),
            markdown_table::<BakeOptions>("Distances on a grid"),
            markdown_table::<ConvertOptions>("Conversions"),
            markdown_table::<PictureOptions>("Pictures"),
            markdown_table::<DeviationSpec>("Deviations"),
            markdown_table::<InspectOptions>("Inspections"),
            markdown_table::<VerifyOptions>("Verifications"),
        ]
        .concat(),
    );
    assert_written(SWITCH, "docs/options.md", &format!("{}\n", text.replace(" \n", "\n").trim_end()));
}
