//! Everyday parts as code (`tests/parts`): each becomes a closed mesh of the right volume.
use crate::common;

use chordal_testkit::{is_long, some};
use common::{Folder, run};
use std::path::{Path, PathBuf};

/// How many tests share the parts, so that none takes long: some quick ones take seconds.
const SHARES: usize = 4;

fn folder_of_parts() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/parts")
}

/// The names in a list beside the parts.
fn listed(list: &str) -> Vec<String> {
    let text = std::fs::read_to_string(folder_of_parts().join(list)).unwrap();
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.map(str::to_owned).collect()
}

/// The names of all parts, sorted.
fn parts() -> Vec<String> {
    let entries = std::fs::read_dir(folder_of_parts()).unwrap().map(|entry| entry.unwrap().path());
    let scripts = entries.filter(|path| path.extension().is_some_and(|extension| extension == "star"));
    let mut names: Vec<String> =
        scripts.map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned()).collect();
    names.sort();
    names
}

/// What the line `# volume:` of a script says, and the standard error of its sampling.
fn said_volume(script: &str) -> Option<(f64, f64)> {
    let line = script.lines().find_map(|line| line.strip_prefix("# volume: "))?;
    let (volume, how) = line.split_once(" # ").unwrap_or((line, ""));
    let error = how.strip_prefix("monte carlo, standard error ").map_or(Ok(0.0), str::parse);
    Some((volume.parse().ok()?, error.ok()?))
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

/// Meshes a share of the parts: some of those that are listed as quick, or all parts in the long sweep.
fn mesh_a_share(share: usize) {
    let folder = Folder::new(&format!("parts_{share}"));
    let output = folder.text("part.obj");
    let names = if is_long() { parts() } else { some(listed("QUICK"), 24) };
    let unmet = listed("UNMET");
    let mut faults = Vec::new();
    for name in names.iter().skip(share).step_by(SHARES) {
        let script = folder_of_parts().join(format!("{name}.star"));
        let asked = ["--tol", "0.1%", "-o", &output, "--json", "--force"];
        let made = run(&[&["mesh", script.to_str().unwrap()], &asked[..]].concat());
        // A mesh that misses its tolerance is written all the same, and has to be sound.
        if made.code != 0 && !(made.code == 5 && unmet.contains(name)) {
            faults.push(format!("{name}: {made:?}"));
            continue;
        }
        let certificate = &made.report()["certificate"];
        let valid = &certificate["valid"];
        if !["closed", "manifold", "oriented"].iter().all(|&what| valid[what] == true) {
            faults.push(format!("{name}: {valid:#}"));
        }
        // What is proved is often less than what was asked for, of flat parts most of all.
        let proved = certificate["bound"]["at_most"].as_f64();
        let length = proved.or(certificate["budget"]["length"].as_f64()).unwrap();
        let (volume, area) = volume_and_area(&std::fs::read_to_string(&output).unwrap());
        let (said, error) = said_volume(&std::fs::read_to_string(&script).unwrap()).expect(name);
        // Four standard errors: chosen, one in 16,000 is larger.
        if (volume - said).abs() > length * area + 4.0 * error {
            faults.push(format!("{name}: a volume of {volume} for {said}, and an area of {area}"));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn everyday_parts_become_closed_meshes_of_the_right_volume_1_of_4() {
    mesh_a_share(0);
}

#[test]
fn everyday_parts_become_closed_meshes_of_the_right_volume_2_of_4() {
    mesh_a_share(1);
}

#[test]
fn everyday_parts_become_closed_meshes_of_the_right_volume_3_of_4() {
    mesh_a_share(2);
}

#[test]
fn everyday_parts_become_closed_meshes_of_the_right_volume_4_of_4() {
    mesh_a_share(3);
}

#[test]
fn every_part_names_its_volume_and_lists_name_parts() {
    let names = parts();
    assert!(names.len() >= 150, "{names:?}");
    for name in &names {
        let script = std::fs::read_to_string(folder_of_parts().join(format!("{name}.star"))).unwrap();
        assert!(script.starts_with("# "), "{name} says what it is");
        let (volume, error) = said_volume(&script).unwrap_or_else(|| panic!("{name} says no volume"));
        // A thousandth: what the checks allow is mostly more.
        assert!(volume > 0.0 && error < 1e-3 * volume, "{name}: {volume}, {error}");
    }
    let (quick, aside, unmet) = (listed("QUICK"), listed("KEPT_ASIDE"), listed("UNMET"));
    assert!(3 * quick.len() >= names.len() && 5 * aside.len() >= names.len());
    for name in quick.iter().chain(&aside).chain(&unmet) {
        assert!(names.contains(name), "there is no part {name}");
    }
    assert!(quick.iter().all(|name| !aside.contains(name)), "what is kept aside is looked at last");
}
