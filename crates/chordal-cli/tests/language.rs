//! `chordal language`: what it lists, and the document that editors read.
use crate::common;

use common::{Folder, run};
use serde_json::{Value, json};

fn document() -> Value {
    let said = run(&["language", "--json"]);
    said.succeeds();
    serde_json::from_str(&said.stdout).expect("it is JSON")
}

fn function(document: &Value, name: &str) -> Value {
    let functions = document["functions"].as_array().expect("a list");
    functions.iter().find(|function| function["name"] == name).expect("it is there").clone()
}

#[test]
fn the_document_has_functions_with_their_parameters_and_what_they_are_worth() {
    let document = document();
    assert_eq!(
        function(&document, "gyroid"),
        json!({
            "name": "gyroid",
            "group": "Solids",
            "usage": "gyroid(period, level=0)",
            "worth": "lower bound",
            "doc": "The infinite solid on one side of the gyroid; shell() turns it into a wall.",
            "parameters": [
                { "name": "period", "default": null, "rest": false },
                { "name": "level", "default": "0", "rest": false },
            ],
        })
    );
    assert_eq!(
        function(&document, "union")["parameters"][0],
        json!({ "name": "shapes", "default": null, "rest": true })
    );
    let spline = function(&document, "spline");
    assert_eq!((&spline["worth"], &spline["group"]), (&Value::Null, &"Paths".into()));
    assert_eq!(spline["parameters"][2]["default"], "\"centripetal\"");
    assert_eq!(function(&document, "param")["usage"], "param(name, default)");
    assert_eq!(document["constants"], json!(["x", "y", "z", "pi", "True", "False", "None"]));
    assert!(document["keywords"].as_array().unwrap().contains(&"lambda".into()));
}

#[test]
fn the_document_follows_its_schema() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/schema/language.schema.json");
    let schema: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let schema = jsonschema::validator_for(&schema).unwrap();
    let mut document = document();
    assert!(schema.is_valid(&document), "{document:#}");
    document["functions"][0]["doc"] = "no sentence".into();
    assert!(!schema.is_valid(&document));
}

#[test]
fn the_list_for_people_has_every_function_and_its_sentence() {
    let said = run(&["language"]);
    said.succeeds();
    let ball = "Solids\n  sphere(radius)\n      A ball centred on the origin.\n      The value is: exact distance.\n";
    assert!(said.stdout.starts_with(ball), "{}", said.stdout);
    for function in document()["functions"].as_array().unwrap() {
        let row = format!(
            "  {}\n      {}\n",
            function["usage"].as_str().unwrap(),
            function["doc"].as_str().unwrap()
        );
        assert!(said.stdout.contains(&row), "{row}");
    }
    assert!(said.stdout.ends_with(
        "Keywords\n  and break continue def elif else for if in lambda load not or pass return\n"
    ));
}

#[test]
fn what_it_lists_is_known_to_scripts() {
    let document = document();
    let names =
        document["functions"].as_array().unwrap().iter().map(|function| function["name"].as_str().unwrap());
    let constants = document["constants"].as_array().unwrap().iter().map(|name| name.as_str().unwrap());
    let all: Vec<&str> = names.chain(constants).collect();
    let folder = Folder::new("language-known");
    let file = folder.file("all.star", format!("all = [{}]\nsphere(len(all))\n", all.join(", ")));
    let script = run(&["inspect", &file]);
    script.succeeds();
    let corner = all.len();
    assert!(script.stdout.contains(&format!("to ({corner}, {corner}, {corner})")), "{}", script.stdout);
}
