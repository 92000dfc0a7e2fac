//! The schemas of shapes in JSON and their reader accept the same files.
use chordal_io::{Format, Limits, read};
use serde_json::{Value, json};

fn schema(name: &str) -> Value {
    let path = format!("{}/../../docs/schema/{name}.schema.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).expect("the schema is there"))
        .expect("the schema is JSON")
}

/// Whether a schema admits a value: the keywords that ours uses, and a loud word for any other.
fn admits(root: &Value, schema: &Value, value: &Value) -> bool {
    let number = |v: &Value| v.as_f64().expect("a number");
    schema.as_object().expect("an object").iter().all(|(keyword, rule)| match keyword.as_str() {
        "$schema" | "$id" | "$defs" | "title" | "description" => true,
        "type" => match rule.as_str().expect("a type") {
            "object" => value.is_object(),
            "array" => value.is_array(),
            "number" => value.is_number(),
            "string" => value.is_string(),
            "integer" => value.as_f64().is_some_and(|x| x.fract() == 0.0),
            other => panic!("type {other}"),
        },
        "required" => {
            let keys = rule.as_array().expect("keys");
            value
                .as_object()
                .is_none_or(|object| keys.iter().all(|k| object.contains_key(k.as_str().expect("a key"))))
        }
        "properties" => rule
            .as_object()
            .expect("rules")
            .iter()
            .all(|(key, rule)| value.get(key).is_none_or(|member| admits(root, rule, member))),
        "additionalProperties" => rule.is_object(),
        "items" => value.as_array().is_none_or(|items| items.iter().all(|item| admits(root, rule, item))),
        "minItems" => value.as_array().is_none_or(|items| items.len() as f64 >= number(rule)),
        "maxItems" => value.as_array().is_none_or(|items| items.len() as f64 <= number(rule)),
        "minimum" => value.as_f64().is_none_or(|x| x >= number(rule)),
        "maximum" => value.as_f64().is_none_or(|x| x <= number(rule)),
        "exclusiveMinimum" => value.as_f64().is_none_or(|x| x > number(rule)),
        "enum" => rule.as_array().expect("values").contains(value),
        "oneOf" => {
            rule.as_array().expect("schemas").iter().filter(|rule| admits(root, rule, value)).count() == 1
        }
        "$ref" => {
            let pointer = rule.as_str().and_then(|r| r.strip_prefix('#')).expect("a local reference");
            admits(root, root.pointer(pointer).expect("the reference leads somewhere"), value)
        }
        other => panic!("keyword {other}"),
    })
}

#[test]
fn the_schema_of_patches_and_the_reader_agree() {
    let root = schema("patches");
    let row = json!([[0, 0, 0], [1, 0.5, 0], [2, -1e3, 0], [3, 0, 0]]);
    let patch = json!([row, row, row, row]);
    let short = json!([row, row, row]);
    let wide = json!([[0, 0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]);
    let indices = json!([0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1]);
    let points = json!([[0, 0, 0], [1, 0, 0]]);
    let accepted = [
        json!({ "patches": [] }),
        json!({ "patches": [patch] }),
        json!({ "patches": [patch, patch], "up": "y", "metres_per_unit": 0.001, "author": { "name": ["x"] } }),
        json!({ "patches": [indices, indices], "points": points, "up": "z" }),
    ];
    let refused = [
        json!([]),
        json!({}),
        json!({ "patch": [patch] }),
        json!({ "patches": patch }),
        json!({ "patches": {} }),
        json!({ "patches": [short] }),
        json!({ "patches": [[wide, row, row, row]] }),
        json!({ "patches": [patch, indices], "points": points }),
        json!({ "patches": [indices, patch], "points": points }),
        json!({ "patches": [[0, 1]], "points": points }),
        json!({ "patches": [vec![0.5; 16]], "points": points }),
        json!({ "patches": [vec![-1; 16]], "points": points }),
        json!({ "patches": [vec![4_294_967_296_u64; 16]], "points": points }),
        json!({ "patches": [indices], "points": [[0, 0], [1, 0]] }),
        json!({ "patches": [patch], "up": "x" }),
        json!({ "patches": [patch], "up": null }),
        json!({ "patches": [patch], "metres_per_unit": 0 }),
        json!({ "patches": [patch], "metres_per_unit": "mm" }),
    ];
    agree(&root, &accepted, &refused);
}

#[track_caller]
fn agree(root: &Value, accepted: &[Value], refused: &[Value]) {
    for (documents, accept) in [(accepted, true), (refused, false)] {
        for document in documents {
            assert_eq!(admits(root, root, document), accept, "schema: {document}");
            let outcome = read(document.to_string().as_bytes(), Format::Json, &Limits::default());
            assert_eq!(outcome.is_ok(), accept, "reader: {document}: {outcome:?}");
        }
    }
}

#[test]
fn the_schemas_of_curves_and_polylines_and_the_reader_agree() {
    for (list, points) in [("curves", "control"), ("polylines", "points")] {
        let four = json!([[0, 0], [1, 0.5], [2, -1e3], [3, 0]]);
        let space = json!([[0, 0, 0], [1, 0, 1], [2, 0, 1], [0, 0, 0]]);
        let accepted = [
            json!({ list: [] }),
            json!({ list: [{ points: four }], "up": "y", "metres_per_unit": 0.001, "author": ["x"] }),
            json!({ list: [{ points: four, "closed": false, "source": 7, "name": "a", "rule": "evenodd", "x": 1 }] }),
            json!({ list: [{ points: space, "closed": true }, { points: space }] }),
            json!({ list: [{ points: [[5, 6]] }] }),
        ];
        let refused = [
            json!({ list: {} }),
            json!({ list: [four] }),
            json!({ list: [{}] }),
            json!({ list: [{ points: [] }] }),
            json!({ list: [{ points: [[0], [1], [2], [3]] }] }),
            json!({ list: [{ points: [[0, 0, 0, 0]] }] }),
            json!({ list: [{ points: four, "closed": 0 }] }),
            json!({ list: [{ points: four, "source": -1 }] }),
            json!({ list: [{ points: four, "source": 0.5 }] }),
            json!({ list: [{ points: four, "source": "a" }] }),
            json!({ list: [{ points: four, "name": 1 }] }),
            json!({ list: [{ points: four, "rule": "odd" }] }),
            json!({ list: [{ points: four }], "patches": [] }),
            json!({ list: [{ points: four }], "up": "x" }),
            json!({ list: [{ points: [["0", 0]] }] }),
        ];
        agree(&schema(list), &accepted, &refused);
    }
}

/// What a schema cannot say.
#[test]
fn the_reader_also_counts_and_compares_points() {
    for (text, place, part) in [
        (json!({ "curves": [{ "control": [[0, 0], [1, 0]] }] }), "/curves/0", "3n + 1"),
        (
            json!({ "curves": [{ "control": [[0, 0], [1, 0], [2, 0], [3, 0]], "closed": true }] }),
            "/curves/0",
            "ends with",
        ),
        (
            json!({ "polylines": [{ "points": [[0, 0], [1, 0, 0]] }] }),
            "/polylines/0/points/1",
            "3 numbers where 2",
        ),
        (json!({ "curves": [], "polylines": [] }), "/polylines", "not both"),
    ] {
        let error = read(text.to_string().as_bytes(), Format::Json, &Limits::default()).unwrap_err();
        assert_eq!(error.place.to_string(), place, "{error}");
        assert!(error.to_string().contains(part), "{error}");
    }
}
