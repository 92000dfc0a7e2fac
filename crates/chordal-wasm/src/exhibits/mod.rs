//! The answers to the exhibits of the studio, computed by the library; each file answers one exhibit.
mod adaptive;
mod answer;
mod baking;
mod bernstein;
mod blend;
mod booleans;
mod bsp;
mod budget;
mod cage;
mod cracks;
mod cross;
mod csg;
mod cubes;
mod culling;
mod doctor;
mod fan;
mod field;
mod indexed;
mod inside;
mod joins;
mod landscape;
mod levels;
mod mountain;
mod network;
mod normals;
mod one_cube;
mod overshade;
mod patch;
mod picture_pair;
mod pixels;
mod plane;
mod pull;
mod quad;
mod questions;
mod request;
mod ride;
mod rivals;
mod runge;
mod segments;
mod shapes;
mod shimmer;
mod sight;
mod spline;
mod squares;
mod tangent;
mod tracing;
mod weights;

use crate::outcome::Outcome;
use answer::ExhibitAnswer;
use request::ExhibitRequest;

/// What an exhibit answers.
type Answer = fn(&ExhibitRequest) -> Result<ExhibitAnswer, String>;

/// Exports each exhibit by its name, so that a module is linked with no more of the library than its exhibits ask.
macro_rules! exhibits {
    ($($name:literal => $exhibit:ident::$answer:ident(&request),)*) => {
        /// What the exhibit of that name answers.
        #[cfg(test)]
        fn by_name(name: &str) -> Option<Answer> {
            match name {
                $($name => Some($exhibit::$answer),)*
                _ => None,
            }
        }

        $(const _: () = {
            /// Answers this exhibit; large arrays are in the outcome's bytes.
            ///
            /// # Safety
            /// `question` and `len` are from one call of `chordal_alloc` and were not freed.
            #[unsafe(export_name = concat!("chordal_exhibit_", $name))]
            unsafe extern "C" fn exported(question: *const u8, len: usize) -> *mut Outcome {
                // SAFETY: by the contract it is initialized, live and of that length, and nothing writes to it during
                // the call, since a WASM module like this one has one thread.
                let question = unsafe { std::slice::from_raw_parts(question, len) };
                Box::into_raw(Box::new(outcome($exhibit::$answer, question)))
            }
        };)*
    };
}

exhibits! {
    "quad" => quad::quad(&request),
    "inside" => inside::inside(&request),
    "weights" => weights::weights(&request),
    "pixels" => pixels::pixels(&request),
    "fan" => fan::fan(&request),
    "indexed" => indexed::indexed(&request),
    "cross" => cross::cross(&request),
    "normals" => normals::normals(&request),
    "tangent" => tangent::tangent(&request),
    "culling" => culling::culling(&request),
    "doctor" => doctor::doctor(&request),
    "bernstein" => bernstein::bernstein(&request),
    "joins" => joins::joins(&request),
    "ride" => ride::ride(&request),
    "spline" => spline::spline(&request),
    "runge" => runge::runge(&request),
    "patch" => patch::patch(&request),
    "cracks" => cracks::cracks(&request),
    "cage" => cage::cage(&request),
    "pull" => pull::pull(&request),
    "field" => field::field(&request),
    "csg" => csg::csg(&request),
    "tracing" => tracing::tracing(&request),
    "rivals" => rivals::rivals(&request),
    "segments" => segments::segments(&request),
    "squares" => squares::squares(&request),
    "network" => network::network(&request),
    "cubes" => cubes::cubes(&request),
    "booleans" => booleans::booleans(&request),
    "blend" => blend::blend(&request),
    "baking" => baking::baking(&request),
    "levels" => levels::levels(&request),
    "overshade" => overshade::overshade(&request),
    "adaptive" => adaptive::adaptive(&request),
    "mountain" => mountain::mountain(&request),
    "shimmer" => shimmer::shimmer(&request),
    "budget" => budget::budget(&request),
    "questions" => questions::questions(&request),
}

fn outcome(answer: Answer, question: &[u8]) -> Outcome {
    let answered = ExhibitRequest::parse(question).and_then(|(_, request)| answer(&request));
    answered.map_or_else(|error| Outcome::failed(2, error), ExhibitAnswer::into_outcome)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_question_is_an_object_that_names_its_exhibit() {
        for (question, part) in [("", "JSON"), ("[]", "object"), ("{}", "exhibit")] {
            let error = String::from_utf8(outcome(quad::quad, question.as_bytes()).error).unwrap();
            assert!(error.contains(part), "{question}: {error}");
        }
    }

    #[test]
    fn a_question_that_makes_no_sense_is_refused_in_a_sentence() {
        for (question, part) in [
            (r#"{"exhibit": "bernstein", "control": [[0, 0], [1, 0], [1, 1], [0, 1]], "t": 2}"#, "1.1"),
            (r#"{"exhibit": "joins", "first": [[0, 0]], "second": [], "keep": "C1", "scale": 1}"#, "first"),
            (r#"{"exhibit": "runge", "count": 400, "row": 0, "lift": 0}"#, "count"),
            (
                r#"{"exhibit": "cracks", "left": 3, "right": 4, "cut": "none", "eye": [1, 1, 1], "target": [0, 0, 0]}"#,
                "cut",
            ),
            (r#"{"exhibit": "cage", "level": 6, "sharpness": 0}"#, "level"),
            (r#"{"exhibit": "quad", "colour": 1}"#, "colour"),
            (r#"{"exhibit": "quad", "corners": [[0, 0, 0]]}"#, "corners"),
            (r#"{"exhibit": "inside", "corners": [[0, 0], [1, 0], [0, 1e9]], "point": [0, 0]}"#, "corners"),
            (r#"{"exhibit": "indexed", "shape": "cow", "length": 0.1}"#, "teapot"),
            (r#"{"exhibit": "indexed", "shape": "teapot", "length": 0}"#, "length"),
            (r#"{"exhibit": "normals", "shape": "cube", "crease_deg": 181}"#, "crease_deg"),
            (r#"{"exhibit": "culling", "shape": "ball", "flipped": [80], "eye": [0, 0, 9]}"#, "flipped"),
            (r#"{"exhibit": "doctor", "patient": "hole", "cures": ["luck"]}"#, "luck"),
            (r#"{"exhibit": "field", "point": [1, 1], "length": 0}"#, "length"),
            (r#"{"exhibit": "csg", "operation": "xor", "point": [1, 1]}"#, "operation"),
            (r#"{"exhibit": "tracing", "aim": [0.9, 4.2]}"#, "eye"),
            (r#"{"exhibit": "rivals", "shape": "cow"}"#, "shape"),
            (r#"{"exhibit": "segments", "control": [[0, 0]], "count": 3, "length": 0.1}"#, "control"),
            (r#"{"exhibit": "squares", "look": "lattice", "cells": 400, "method": "squares"}"#, "cells"),
            (r#"{"exhibit": "squares", "look": "cube", "signs": 256}"#, "signs"),
            (r#"{"exhibit": "squares", "look": "cone"}"#, "look"),
            (r#"{"exhibit": "questions", "asked": [{"exhibit": "questions", "asked": []}]}"#, "asked"),
            (r#"{"exhibit": "baking", "shape": "cube", "cells": 2}"#, "cells"),
            (r#"{"exhibit": "levels", "distance": 0}"#, "distance"),
            (r#"{"exhibit": "overshade", "side": 0.01}"#, "side"),
            (r#"{"exhibit": "adaptive", "scene": "sea"}"#, "scene"),
            (r#"{"exhibit": "mountain", "distance": 0}"#, "distance"),
            (r#"{"exhibit": "shimmer", "size": 9}"#, "size"),
            (r#"{"exhibit": "network", "cells": 8, "threshold": 1}"#, "threshold"),
            (r#"{"exhibit": "cubes", "cells": 1}"#, "cells"),
            (r#"{"exhibit": "booleans", "way": "luck"}"#, "way"),
            (r#"{"exhibit": "blend", "balls": [[1, 1]]}"#, "balls"),
            (r#"{"exhibit": "budget", "shape": "cow", "step": 1}"#, "shape"),
            (
                r#"{"exhibit": "pixels", "corners": [[0, 0], [1, 0], [0, 1]], "colors": [], "columns": 12}"#,
                "colors",
            ),
            (r#"{"exhibit": "fan", "points": [[0, 0], [1, 0], [0, 1]], "apex": 3, "cuts": []}"#, "apex"),
            (r#"{"exhibit": "cross", "corners": [[0, 0, 0]], "eye": [0, 0, 1]}"#, "corners"),
            (r#"{"exhibit": "tangent", "corners": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "uv": [[0, 0]]}"#, "uv"),
            (r#"{"exhibit": "patch", "control": [], "u": 0, "v": 0, "chosen": 0}"#, "control"),
            (r#"{"exhibit": "pull", "corners": [], "creases": [12], "chosen": 0}"#, "corners"),
            (r#"{"exhibit": "spline", "points": [[0, 0]], "kind": "lines", "chosen": 0}"#, "points"),
            (r#"{"exhibit": "ride", "points": [[0, 0], [1, 0], [1, 1], [0, 1]], "kind": "C3"}"#, "kind"),
        ] {
            let (name, _) = ExhibitRequest::parse(question.as_bytes()).unwrap();
            let outcome = outcome(by_name(&name).unwrap(), question.as_bytes());
            let error = String::from_utf8(outcome.error).unwrap();
            assert_eq!(outcome.exit, 2, "{question}");
            assert!(error.contains(part) && !error.contains('\n'), "{question}: {error}");
        }
    }
}
