//! The six questions at the end: the facts of their exhibits in the initial state.
use super::answer::ExhibitAnswer;
use super::request::ExhibitRequest;
use super::{Answer, culling, field, joins, normals, overshade, quad};
use serde_json::{Map, Value};

/// The most exhibits in a request.
const MOST: usize = 6; // defined: a question each

/// Answers `{"asked": [{"exhibit": "quad", …}, …]}`: the facts of each exhibit by its name, without arrays.
pub(super) fn questions(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["asked"])?;
    let mut facts_by_name = Map::new();
    for question in request.questions("asked", MOST)? {
        let (name, request) = ExhibitRequest::parse(question.to_string().as_bytes())?;
        let mut facts = answer_of(&name)?(&request)?.facts;
        without_arrays(&mut facts);
        facts_by_name.insert(name, facts);
    }
    Ok(ExhibitAnswer::new(Value::Object(facts_by_name)))
}

/// The exhibits that have a question. Named, so that a module with the questions has nothing of the others.
fn answer_of(name: &str) -> Result<Answer, String> {
    Ok(match name {
        "quad" => quad::quad,
        "normals" => normals::normals,
        "culling" => culling::culling,
        "joins" => joins::without_stripes,
        "field" => field::field,
        "overshade" => overshade::overshade,
        _ => return Err(format!("asked: there is no question about the exhibit '{name}'")),
    })
}

/// Replaces references to arrays by null, since the bytes of the answer are dropped.
fn without_arrays(value: &mut Value) {
    match value {
        Value::Object(map) if map.contains_key("f32") || map.contains_key("u32") => *value = Value::Null,
        Value::Object(map) => map.values_mut().for_each(without_arrays),
        Value::Array(list) => list.iter_mut().for_each(without_arrays),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn each_exhibit_says_what_it_says_by_itself() {
        let quad = json!({
            "exhibit": "quad", "corners": [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0.9]],
        });
        let ball = json!({ "exhibit": "culling", "shape": "ball", "flipped": [3], "eye": [3, -4, 2] });
        let question = json!({ "exhibit": "questions", "asked": [quad, ball] }).to_string();
        let facts = facts_of(questions, question);
        for (alone, answer) in [(quad, quad::quad as Answer), (ball, culling::culling)] {
            let name = alone["exhibit"].as_str().unwrap().to_owned();
            let mut wanted = facts_of(answer, alone.to_string());
            without_arrays(&mut wanted);
            assert_eq!(facts[name], wanted);
        }
        assert_eq!(facts["culling"]["mesh"], json!({ "positions": null, "indices": null }));
    }

    fn facts_of(answer: Answer, question: String) -> Value {
        answer(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts
    }
}
