//! Everyday parts as code (`tests/parts`): each becomes a closed mesh of the right volume.
use crate::common;

use common::{Folder, run};
use std::path::{Path, PathBuf};

/// The largest distance.
const LENGTH: f64 = 0.05;

fn folder_of_parts() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/parts")
}

/// What a comment of the script says of its volume, by a formula.
fn said_volume(script: &str) -> Option<f64> {
    script.lines().find_map(|line| line.strip_prefix("# volume ")?.trim().parse().ok())
}

/// The volume and the area of the triangles of an OBJ, by the divergence theorem.
fn volume_and_area(obj: &str) -> (f64, f64) {
    let mut points: Vec<[f64; 3]> = Vec::new();
    let (mut volume, mut area) = (0.0, 0.0);
    for line in obj.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let mut next = || words.next().unwrap().parse().unwrap();
                points.push([next(), next(), next()]);
            }
            Some("f") => {
                let corner =
                    |word: &str| points[word.split('/').next().unwrap().parse::<usize>().unwrap() - 1];
                let [a, b, c]: [[f64; 3]; 3] = words.map(corner).collect::<Vec<_>>().try_into().unwrap();
                let cross = |p: [f64; 3], q: [f64; 3]| {
                    [0, 1, 2].map(|k| p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3])
                };
                let side = |p: [f64; 3]| [0, 1, 2].map(|k| p[k] - a[k]);
                volume += (0..3).map(|k| a[k] * cross(b, c)[k]).sum::<f64>() / 6.0;
                area += 0.5 * cross(side(b), side(c)).iter().map(|x| x * x).sum::<f64>().sqrt();
            }
            _ => {}
        }
    }
    (volume, area)
}

#[test]
fn everyday_parts_become_closed_meshes_of_the_right_volume() {
    let folder = Folder::new("parts");
    let output = folder.text("part.obj");
    let mut names: Vec<PathBuf> =
        std::fs::read_dir(folder_of_parts()).unwrap().map(|entry| entry.unwrap().path()).collect();
    names.sort();
    assert!(names.len() >= 20, "{names:?}");
    let mut n_proved = 0;
    for part in &names {
        let name = part.file_stem().unwrap().to_str().unwrap();
        let asked = ["--tol", &LENGTH.to_string(), "-o", &output, "--json", "--force"];
        let made = run(&[&["mesh", part.to_str().unwrap()], &asked[..]].concat());
        assert_eq!(made.code, 0, "{name}: {made:?}");
        let certificate = &made.report()["certificate"];
        let valid = &certificate["valid"];
        assert!(valid["closed"] == true && valid["manifold"] == true, "{name}: {valid:#}");
        let evidence = certificate["bound"]["evidence"].as_str().unwrap();
        n_proved += usize::from(evidence == "proved");
        let script = std::fs::read_to_string(part).unwrap();
        let (volume, area) = volume_and_area(&std::fs::read_to_string(&output).unwrap());
        assert!(volume > 0.0, "{name}: {volume}");
        if let Some(said) = said_volume(&script) {
            assert!((volume - said).abs() <= LENGTH * area, "{name}: {volume} for {said}, of {area}");
        }
    }
    // Nineteen of twenty.
    assert!(20 * n_proved >= 19 * names.len(), "{n_proved} of {} are proved", names.len());
}
