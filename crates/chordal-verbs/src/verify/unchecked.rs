//! The facts of a certificate that are not checked.
use super::claims::ClaimList;
use serde_json::Value;

/// The facts of a certificate that are proved or counted again, at least in part, or are claims that stay open.
const CHECKED: [&str; 10] =
    ["input", "frame", "bound", "output", "valid", "attributes", "baked", "offset", "history", "seal"];

/// Facts about how a result was built, and not about the result itself: they are not checked.
const ORIGIN_FACTS: [&str; 11] = [
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
    "sources",
];

/// Parts of the other facts that are not checked.
const UNCHECKED_PARTS: [&str; 8] = [
    "/input/letters",
    "/input/warnings",
    "/bound/pixels",
    "/bound/angle_deg",
    "/bound/samples",
    "/bound/at",
    "/bound/open",
    "/baked/bricks",
];

/// Keys in a history that are not checked, at any place: words, and the number of samples, which a judge does not need.
const UNCHECKED_KEYS: [&str; 4] = ["verb", "version", "reason", "samples"];

/// The facts of the groups whose facts are checked one by one. In the other groups all facts are compared with counts, and a
/// history with more facts cannot be read.
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

/// Opens a claim for every unknown fact, which could claim anything.
pub(super) fn check_known(certificate: &Value, claims: &mut ClaimList) {
    let top_level = [&CHECKED[..], &ORIGIN_FACTS].concat();
    let top_group = [("", &top_level[..])];
    for (group, known_keys) in top_group.into_iter().chain(GROUPS) {
        let members = certificate.pointer(group).and_then(Value::as_object).into_iter().flatten();
        for (key, _) in members.filter(|(key, _)| !known_keys.contains(&&key[..])) {
            let claim = format!("{group}/{key}");
            claims.open(claim.trim_start_matches('/'), "a certificate of this version has no such fact");
        }
    }
}

/// The facts of a certificate that were not checked, as paths in it.
pub(super) fn unchecked(certificate: &Value) -> Vec<String> {
    let is_present = |value: &Value| match value {
        Value::Null => false,
        Value::Array(items) => !items.is_empty(),
        Value::Object(members) => !members.is_empty(),
        _ => true,
    };
    let listed = ORIGIN_FACTS
        .iter()
        .map(|key| format!("/{key}"))
        .chain(UNCHECKED_PARTS.iter().map(|at| (*at).to_owned()));
    // Inputs that were put together are known by their digests, so that the input of the last step has no check of its own.
    let steps = certificate.pointer("/history/steps").and_then(Value::as_array);
    let is_put_together = |step: &Value| step.get("composed").is_some_and(is_present);
    let is_composed = steps.and_then(|steps| steps.last()).is_some_and(is_put_together);
    let mut paths = Vec::new();
    for (k, step) in steps.into_iter().flatten().enumerate().filter(|(_, step)| is_put_together(step)) {
        let n_inputs = step.get("inputs").and_then(Value::as_array).map_or(0, Vec::len);
        let named = |i: usize| ["format", "kind"].map(|key| format!("/history/steps/{k}/inputs/{i}/{key}"));
        paths.extend((0..n_inputs).flat_map(named));
    }
    let files = certificate.pointer("/input/files").and_then(Value::as_array).map_or(0, Vec::len);
    paths.extend((0..files).map(|k| format!("/input/files/{k}/path")));
    if let Some(history) = certificate.get("history") {
        collect_words(history, "/history", &mut paths);
    }
    let composed = is_composed.then(|| "/input".to_owned());
    let present =
        listed.chain(composed).filter(|at| certificate.pointer(at).is_some_and(is_present)).chain(paths);
    present.map(|at| at.trim_start_matches('/').to_owned()).collect()
}

/// Adds the paths of unchecked keys in a history, and of the formats of files.
fn collect_words(value: &Value, path: &str, paths: &mut Vec<String>) {
    match value {
        Value::Object(members) => {
            for (key, member) in members {
                let is_named = path.ends_with("/output") || path.contains("/origins/");
                let is_format = key == "format" && is_named;
                let is_kind = key == "kind" && path.contains("/origins/") && path.contains("/inputs/");
                if is_format || is_kind || UNCHECKED_KEYS.contains(&&key[..]) {
                    paths.push(format!("{path}/{key}"));
                } else {
                    collect_words(member, &format!("{path}/{key}"), paths);
                }
            }
        }
        Value::Array(items) => {
            let items = items.iter().enumerate();
            items.for_each(|(k, member)| collect_words(member, &format!("{path}/{k}"), paths));
        }
        _ => {}
    }
}
