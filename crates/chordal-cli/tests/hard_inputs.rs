//! Volumes, drawings and meshes that took minutes or gigabytes, or missed their length by a rounding: each
//! ends.
use crate::common;

use chordal_testkit::is_long;
use common::{Folder, repro, run};

/// The most that a process may hold, in bytes.
const MOST_MEMORY: u64 = 256 << 20;

/// A drawing of one polygon around the origin: its corners lie by turns at the radius 1000 and at another.
fn star(n_corners: u32, inner: f64) -> String {
    let corners = (0..n_corners).map(|k| {
        let angle = f64::from(k) * std::f64::consts::TAU / f64::from(n_corners);
        let radius = if k % 2 == 0 { 1000.0 } else { inner };
        format!("{:.9},{:.9} ", radius * angle.cos(), radius * angle.sin())
    });
    let corners: String = corners.collect();
    let head = r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="-1000 -1000 2000 2000">"#;
    format!(r#"{head}<polygon points="{corners}"/></svg>"#)
}

#[test]
fn a_star_of_a_hundred_thousand_corners_becomes_triangles() {
    let folder = Folder::new("hard-star");
    let (input, output) = (folder.file("star.svg", star(100_000, 990.0)), folder.text("a.glb"));
    let made = run(&["mesh", &input, "-o", &output, "--tol", "1%", "--json"]);
    assert_eq!(made.code, 0, "{made:?}");
    let report = made.report();
    let certificate = &report["certificate"];
    // Every corner is kept, and each triangulation of a polygon has two triangles fewer.
    assert_eq!(certificate["output"]["triangles"], 99_998);
    assert_eq!(certificate["bound"]["evidence"], "proved");
    let wanted = certificate["budget"]["length"].as_f64().expect("a length");
    assert!(
        certificate["bound"]["at_most"].as_f64().is_some_and(|at_most| at_most <= wanted),
        "{certificate:#}"
    );
    // Known on Linux only.
    let peak = report["run"]["peak_bytes"].as_u64().unwrap_or(0);
    assert!(peak <= MOST_MEMORY, "{peak}");
}

#[test]
fn spikes_and_lines_that_lie_on_each_other_end_with_triangles_or_a_sentence() {
    let folder = Folder::new("hard-lines");
    let output = folder.text("a.glb");
    // The fewer become triangles, the more are refused; lines that lie on each other are refused as well.
    let spikes = folder.file("spikes.svg", star(if is_long() { 100_000 } else { 20_000 }, 500.0));
    let crossed = repro("sx.svg").map(|input| (input, "0.1%"));
    for (input, length) in [(spikes, "1%")].into_iter().chain(crossed) {
        let made = run(&["mesh", &input, "-o", &output, "--force", "--tol", length, "-q"]);
        if made.code == 0 {
            made.succeeds();
        } else {
            made.fails_with(5, &[".svg: "]);
        }
    }
}

#[test]
fn a_volume_is_not_missed_by_a_rounding() {
    // It takes most of a minute, with simplification; the cells alone are looked at by the library's own test.
    let Some(input) = repro("unmet_by_5e-10_r0.npy").filter(|_| is_long()) else { return };
    let folder = Folder::new("hard-volume");
    let output = folder.text("a.ply");
    let asked = ["--iso", "0.1", "--inside", "low", "--tol", "0.02", "--keep-best", "--json"];
    let made = run(&[&["mesh", &input, "-o", &output][..], &asked].concat());
    let report = made.report();
    let certificate = &report["certificate"];
    let valid = &certificate["valid"];
    assert!(valid["closed"] == true && valid["manifold"] == true, "{valid:#}");
    assert_eq!(certificate["bound"]["evidence"], "proved");
    let at_most = certificate["bound"]["at_most"].as_f64().expect("an upper end");
    // It was beyond by the rounding to f32 of what cells are off.
    assert_eq!(made.code, 0, "{made:?}");
    assert!(at_most <= 0.02, "{at_most}");
    let triangles = certificate["output"]["triangles"].as_u64().expect("a count");
    assert!(triangles <= 142_724, "{triangles}");
}

#[test]
fn a_mesh_as_long_as_numbers_allow_is_met() {
    // It takes minutes.
    let Some(input) = repro("hang_aniso_1e150.obj").filter(|_| is_long()) else { return };
    let folder = Folder::new("hard-long");
    let made = run(&["mesh", &input, "-o", &folder.text("a.ply"), "--tol", "1%", "--json"]);
    assert_eq!(made.code, 0, "{made:?}");
    let certificate = &made.report()["certificate"];
    let wanted = certificate["budget"]["length"].as_f64().expect("a length");
    assert!(
        certificate["bound"]["at_most"].as_f64().is_some_and(|at_most| at_most <= wanted),
        "{certificate:#}"
    );
}

#[test]
fn a_packed_volume_that_declares_more_than_the_limit_is_refused_unread() {
    let folder = Folder::new("hard-packed");
    // What follows would be refused too, but for another reason.
    let head = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 1430 1430 1430\nencoding: gzip\n\n";
    let input = folder.file("a.nrrd", [head.as_bytes(), b"\x1f\x8b\x08\0\0\0\0\0\0\x03"].concat());
    run(&["inspect", &input, "--max-memory", "256M"])
        .fails_with(3, &["a.nrrd: line 4: ", "2,924,207,000 bytes", "268,435,456"]);
    run(&["inspect", &input]).fails_with(3, &["a.nrrd: byte ", "more than 1000 times the 10 packed bytes"]);
}

#[test]
fn triangles_that_cannot_fit_the_memory_are_refused_before_the_work() {
    let folder = Folder::new("hard-memory");
    // A point of 4 bytes a line and a triangle of 8 take 24 and 12 bytes in memory.
    let text = ["v 0 0 0\n".repeat(30_000), "f 1 2 3\n".repeat(30_000)].concat();
    let input = folder.file("a.obj", &text);
    let (size, held) = (text.len(), 30_000 * (24 + 12));
    let least = size + held;
    run(&["inspect", &input, "--max-memory", &(least - 1).to_string()])
        .fails_with(5, &["30000 triangles", &least.to_string(), "--max-memory"]);
    run(&["inspect", &input, "-q", "--max-memory", &least.to_string()]).succeeds();
}

#[test]
fn a_scene_of_ten_thousand_parts_is_told_of_in_little_memory() {
    let folder = Folder::new("hard-parts");
    let corner =
        |x: u32, y: u32| format!("<vertex><coordinates><x>{x}</x><y>{y}</y><z>0</z></coordinates></vertex>");
    let part = |i: u32| {
        let corners = [corner(2 * i, 0), corner(2 * i + 1, 0), corner(2 * i, 1)].concat();
        let face = "<volume><triangle><v1>0</v1><v2>1</v2><v3>2</v3></triangle></volume>";
        format!(r#"<object id="{i}"><mesh><vertices>{corners}</vertices>{face}</mesh></object>"#)
    };
    let parts: String = (0..10_000).map(part).collect();
    let input = folder.file("a.amf", format!(r#"<amf unit="millimeter">{parts}</amf>"#));
    let made = run(&["inspect", &input, "--json"]);
    assert_eq!(made.code, 0);
    let report = made.report();
    assert_eq!(report["inspection"]["parts"].as_array().map(Vec::len), Some(10_000));
    // Known on Linux only. As values with a copy of each key it took 160 MiB.
    let peak = report["run"]["peak_bytes"].as_u64().unwrap_or(0);
    assert!(peak <= 96 << 20, "{peak}");
}
