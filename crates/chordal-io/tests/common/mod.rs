//! What the tests of the readers and writers share.
#![allow(dead_code)]
use chordal::Mesh;
use chordal_io::{Content, Format, Limits, ReadError, ReadOutcome, Scene, Warning, read};

/// The one mesh of a file that must load, with its warnings.
#[track_caller]
pub fn load(bytes: &[u8], format: Format) -> (Mesh, Vec<Warning>) {
    let (scene, warnings) = load_scene(bytes, format);
    (scene.parts[0].mesh.clone(), warnings)
}

/// The scene of a file that must load, with its warnings.
#[track_caller]
pub fn load_scene(bytes: &[u8], format: Format) -> (Scene, Vec<Warning>) {
    match read(bytes, format, &Limits::default()) {
        Ok(ReadOutcome { content: Content::Scene(scene), warnings }) => (scene, warnings),
        Ok(other) => panic!("no scene: {other:?}"),
        Err(error) => panic!("{error}"),
    }
}

/// The error of a file that must not load.
#[track_caller]
pub fn refuse(bytes: &[u8], format: Format) -> ReadError {
    match read(bytes, format, &Limits::default()) {
        Err(error) => {
            let text = error.to_string();
            for word in ["unwrap", "index out of bounds", "KeyError", "panicked"] {
                assert!(!text.contains(word), "{text}");
            }
            error
        }
        Ok(loaded) => panic!("loaded: {loaded:?}"),
    }
}

/// How often a warning was counted.
pub fn count(warnings: &[Warning], code: &str) -> u64 {
    warnings.iter().filter(|w| w.code == code).map(|w| w.count).sum()
}
