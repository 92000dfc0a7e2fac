//! Broken files by the thousand: each ends in a scene or an error, never in a panic.
use super::build::{every_object, glb_of, strict, triangle};
use super::round_trip::cube;
use chordal_io::{Axis, Conformance, Content, Frame, Limits, Scene, glb};
use chordal_testkit::{Random, is_long};
use serde_json::{Value, json};

fn seeds() -> Vec<Vec<u8>> {
    let (triangle, triangle_bin) = triangle();
    let (every, every_bin) = every_object();
    let frame = Frame { up: Some(Axis::Z), metres_per_unit: Some(0.001), ..Frame::default() };
    let mut own = Vec::new();
    glb::write(&Scene::from_mesh("cube", cube(), frame), Some(&json!({ "a": 1 })), &mut own)
        .expect("written");
    let packed = include_bytes!("../data/torus_khr_meshopt.glb").to_vec();
    vec![glb_of(&triangle.to_string(), &triangle_bin), glb_of(&every.to_string(), &every_bin), own, packed]
}

/// Reads strictly, as viewers do, leniently, and dropping; what comes out has to be usable.
fn survive(bytes: &[u8]) -> usize {
    let limits = Limits { bytes: 64 << 20, rows: 100_000, ..Limits::default() };
    let lenient = Limits { conformance: Conformance::Lenient, drop_nonfinite: true, ..limits };
    let mut n_accepted = 0;
    for limits in [Limits { conformance: Conformance::Strict, ..limits }, limits, lenient] {
        match glb::read(bytes, &limits) {
            Ok(loaded) => {
                n_accepted += 1;
                let Content::Scene(scene) = loaded.content else { panic!("no scene") };
                let _ = scene.world_meshes();
                let mut out = Vec::new();
                if glb::write(&scene, None, &mut out).is_ok()
                    && let Err(error) = glb::read(&out, &strict())
                {
                    let warnings = &loaded.warnings;
                    panic!("what was read and written is refused: {}: {error}; {warnings:?}", error.code);
                }
                assert!(
                    loaded.warnings.iter().all(|warning| warning.count > 0 && !warning.message.is_empty())
                );
            }
            Err(error) => {
                let text = error.to_string();
                assert!(!text.is_empty() && !error.code.is_empty());
                for word in ["unwrap", "index out of bounds", "panicked", "overflow"] {
                    assert!(!text.contains(word), "{text}");
                }
            }
        }
    }
    n_accepted
}

#[test]
fn files_cut_off_anywhere() {
    for seed in seeds() {
        let step = (seed.len() / 512).max(1);
        for end in (0..seed.len()).step_by(step) {
            assert_eq!(survive(&seed[..end]), 0, "cut at {end}");
        }
        assert_eq!(survive(&seed), 3);
    }
}

#[test]
fn files_with_flipped_bits() {
    let mut random = Random::new(20_240_601);
    for seed in seeds() {
        // A large file takes longer.
        for _ in 0..4_000_000 / seed.len().max(1000) {
            let mut bytes = seed.clone();
            for _ in 0..=random.below(3) {
                let at = random.below(bytes.len());
                bytes[at] ^= 1 << random.below(8);
            }
            survive(&bytes);
        }
    }
}

#[test]
fn files_with_length_fields_replaced() {
    for seed in seeds() {
        for at in (0..seed.len().min(64)).step_by(4) {
            for word in [0, 1, 4, 12, u32::MAX, u32::MAX - 3, 0x8000_0000, 0x004E_4942, 0x4E4F_534A] {
                let mut bytes = seed.clone();
                bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
                survive(&bytes);
            }
        }
    }
}

/// All JSON pointers of a document.
fn pointers(value: &Value, at: &str, out: &mut Vec<String>) {
    let children: Vec<(String, &Value)> = match value {
        Value::Object(map) => map.iter().map(|(key, value)| (key.replace('/', "~1"), value)).collect(),
        Value::Array(list) => list.iter().enumerate().map(|(i, value)| (i.to_string(), value)).collect(),
        _ => Vec::new(),
    };
    for (key, child) in children {
        let pointer = format!("{at}/{key}");
        pointers(child, &pointer, out);
        out.push(pointer);
    }
}

#[test]
fn files_with_json_values_replaced() {
    let mut n_accepted = 0;
    for (json, bin) in [triangle(), every_object()] {
        let mut all = Vec::new();
        pointers(&json, "", &mut all);
        for (i, pointer) in all.into_iter().enumerate() {
            let mut marked = json.clone();
            *marked.pointer_mut(&pointer).expect("there") = json!("@@");
            let marked = marked.to_string();
            let texts = [
                "0",
                "-1",
                "1e400",
                "1e300",
                "4294967295",
                "9223372036854775807",
                "0.5",
                "null",
                "true",
                "\"x\"",
                "[]",
                "{}",
                "[0,0]",
                "[1,2,3]",
                "{\"a\":0}",
            ];
            // A fifteenth of the values at each place, another one at the next.
            let step = if is_long() { 1 } else { 15 };
            for text in texts.into_iter().skip(i % step).step_by(step) {
                n_accepted += survive(&glb_of(&marked.replacen("\"@@\"", text, 1), &bin));
            }
        }
    }
    let least = if is_long() { 1000 } else { 66 };
    assert!(n_accepted > least, "only {n_accepted} files were read");
}
