//! What a certificate says that is not looked at.
use super::claims::ClaimList;
use serde_json::Value;

/// The facts of a certificate of which something is proved or counted again, or which is a claim that stays open.
const CHECKED: [&str; 9] =
    ["input", "frame", "bound", "output", "valid", "attributes", "baked", "history", "seal"];

/// Facts that say how a result came about, and not what it is: nothing is proved of them.
const TOLD: [&str; 10] = [
    "version",
    "budget",
    "notes",
    "mended",
    "valid_before",
    "boolean",
    "smoothed",
    "refined",
    "overshade",
    "levels",
];

/// Parts of the others that are not looked at.
const PARTS: [&str; 8] = [
    "/input/letters",
    "/input/warnings",
    "/bound/pixels",
    "/bound/angle_deg",
    "/bound/samples",
    "/bound/at",
    "/bound/open",
    "/baked/bricks",
];

/// What is in a history without being looked at, wherever it stands: words, and how many samples were taken, of which a judge
/// needs none.
const WORDS: [&str; 4] = ["verb", "version", "reason", "samples"];

/// The facts of the groups that are looked at one by one; those of others are compared with all that was counted, and a
/// history with more cannot be read.
const GROUPS: [(&str, &[&str]); 5] = [
    ("/input", &["kind", "format", "letters", "sha256", "files", "warnings"]),
    ("/frame", &["up", "metres_per_unit"]),
    (
        "/bound",
        &[
            "at_least",
            "at_most",
            "pixels",
            "angle_deg",
            "evidence",
            "assumptions",
            "samples",
            "metric",
            "reference",
            "at",
            "open",
        ],
    ),
    (
        "/baked",
        &[
            "route",
            "size",
            "origin",
            "spacing",
            "band",
            "distances",
            "off_at_most",
            "evidence",
            "interpolant",
            "bricks",
            "solid",
        ],
    ),
    ("/baked/interpolant", &["at_most", "evidence", "of"]),
];

/// A fact that nobody knows may claim anything.
pub(super) fn check_known(certificate: &Value, claims: &mut ClaimList) {
    let all = [&CHECKED[..], &TOLD].concat();
    let of_all = [("", &all[..])];
    for (group, known) in of_all.into_iter().chain(GROUPS) {
        let members = certificate.pointer(group).and_then(Value::as_object).into_iter().flatten();
        for (key, _) in members.filter(|(key, _)| !known.contains(&&key[..])) {
            let claim = format!("{group}/{key}");
            claims.open(claim.trim_start_matches('/'), "a certificate of this version has no such fact");
        }
    }
}

/// What a certificate says and nobody looked at, as paths in it.
pub(super) fn unchecked(certificate: &Value) -> Vec<String> {
    let says = |value: &Value| match value {
        Value::Null => false,
        Value::Array(items) => !items.is_empty(),
        Value::Object(members) => !members.is_empty(),
        _ => true,
    };
    let of_all = TOLD.iter().map(|key| format!("/{key}")).chain(PARTS.iter().map(|at| (*at).to_owned()));
    // What was put together of files names them by their digests, and nothing else says what the last step was read from.
    let steps = certificate.pointer("/history/steps").and_then(Value::as_array);
    let is_put_together = |step: &Value| step.get("composed").is_some_and(says);
    let is_composed = steps.and_then(|steps| steps.last()).is_some_and(is_put_together);
    let mut words = Vec::new();
    for (k, step) in steps.into_iter().flatten().enumerate().filter(|(_, step)| is_put_together(step)) {
        let n_inputs = step.get("inputs").and_then(Value::as_array).map_or(0, Vec::len);
        let named = |i: usize| ["format", "kind"].map(|key| format!("/history/steps/{k}/inputs/{i}/{key}"));
        words.extend((0..n_inputs).flat_map(named));
    }
    let files = certificate.pointer("/input/files").and_then(Value::as_array).map_or(0, Vec::len);
    words.extend((0..files).map(|k| format!("/input/files/{k}/path")));
    if let Some(history) = certificate.get("history") {
        collect_words(history, "/history", &mut words);
    }
    let composed = is_composed.then(|| "/input".to_owned());
    let present = of_all.chain(composed).filter(|at| certificate.pointer(at).is_some_and(says)).chain(words);
    present.map(|at| at.trim_start_matches('/').to_owned()).collect()
}

/// The paths of words in a history and of the formats of what was written.
fn collect_words(value: &Value, path: &str, found: &mut Vec<String>) {
    match value {
        Value::Object(members) => {
            for (key, own) in members {
                let is_named = path.ends_with("/output") || path.contains("/origins/");
                let is_format = key == "format" && is_named;
                let is_kind = key == "kind" && path.contains("/origins/") && path.contains("/inputs/");
                if is_format || is_kind || WORDS.contains(&&key[..]) {
                    found.push(format!("{path}/{key}"));
                } else {
                    collect_words(own, &format!("{path}/{key}"), found);
                }
            }
        }
        Value::Array(items) => {
            let items = items.iter().enumerate();
            items.for_each(|(k, own)| collect_words(own, &format!("{path}/{k}"), found));
        }
        _ => {}
    }
}
