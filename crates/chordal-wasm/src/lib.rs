//! Chordal as a plain WASM module.
