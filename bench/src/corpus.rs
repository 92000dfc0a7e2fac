//! The corpora in `bench/out`, as `patches/corpus.py` wrote them.
use crate::sampler::Control;
use std::path::PathBuf;

/// The folder of everything that a bench writes.
pub fn out() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("out")
}

fn json(name: &str) -> serde_json::Value {
    let path = out().join(name);
    let text = std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}; run `make bench`", path.display()));
    serde_json::from_slice(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// The patches of a corpus.
pub fn patches(corpus: &str) -> Vec<Control> {
    serde_json::from_value(json(&format!("{corpus}.json"))["patches"].take()).expect("n × 4 × 4 × 3 numbers")
}

/// The family of each patch of a corpus.
pub fn labels(corpus: &str) -> Vec<String> {
    serde_json::from_value(json(&format!("{corpus}.labels.json"))).expect("a list of names")
}
