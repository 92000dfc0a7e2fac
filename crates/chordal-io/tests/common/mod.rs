//! What the tests of the readers and writers share.
#![allow(dead_code)]
use chordal::Mesh;
use chordal_io::{Content, Format, Limits, ReadError, ReadOutcome, Scene, Warning, read};
use std::path::{Path, PathBuf};

/// The folder of real files, or `None` with a loud word.
pub fn data() -> Option<PathBuf> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data");
    let root = std::env::var_os("CHORDAL_DATA").map_or_else(|| beside.into(), PathBuf::from);
    if !root.is_dir() {
        eprintln!("SKIPPED: no test data beside the checkout (or set CHORDAL_DATA)");
        return None;
    }
    Some(root)
}

/// Every file below a folder, sorted.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let (mut open, mut found) = (vec![folder.to_owned()], Vec::new());
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() { open.push(path) } else { found.push(path) }
        }
    }
    found.sort();
    found
}

/// xorshift64*, so that a printed seed gives the same numbers everywhere.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

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
