//! Budgets that make no sense, that cannot be had, and that are not reached.
use crate::common;

use common::{CLOSED_OBJ, Folder, PATCH, run};

#[test]
fn h73_a_budget_that_makes_no_sense_is_usage() {
    let folder = Folder::new("h73-usage");
    let (input, output) = (folder.file("a.bpt", PATCH), folder.text("a.glb"));
    for tol in ["0", "-1", "nan", "NaN", "inf", "-inf", "1e400", "", "0%", "-0.5mm", "1parsec", "one"] {
        run(&["mesh", &input, "-o", &output, "--tol", tol]).fails_with(2, &["--tol"]);
    }
    for px in ["0", "-1", "nan", "0px"] {
        let view = "1920x1080 fov=45 dist=4";
        run(&["mesh", &input, "-o", &output, "--px", px, "--view", view]).fails_with(2, &["--px"]);
    }
    for view in [
        "1920x1080 fov=180 dist=4",
        "1920x1080 fov=0 dist=4",
        "1920x1080 fov=nan dist=4",
        "1920x1080 fov=45 dist=0",
        "0x1080 fov=45 dist=4",
        "1920x1080 fov=45",
        "1920x1080 fov=45 dist=4 zoom=2",
        "fov=45",
        "",
    ] {
        run(&["mesh", &input, "-o", &output, "--px", "1", "--view", view]).fails_with(2, &["--view"]);
    }
    for triangles in ["0", "-5", "1.5", "many"] {
        run(&["mesh", &input, "-o", &output, "--triangles", triangles]).fails_with(2, &["--triangles"]);
    }
    run(&["mesh", &input, "-o", &output, "--px", "1"]).fails_with(2, &["--px", "--view"]);
    run(&["mesh", &input, "-o", &output]).fails_with(2, &["--tol"]);
    run(&["mesh", &input, "-o", &output, "--tol", "1mm"]).fails_with(2, &["a.bpt", "--unit"]);
    assert_eq!(folder.names(), ["a.bpt"]);
}

#[test]
fn h73_a_tolerance_that_needs_too_many_triangles_is_refused_before_the_work() {
    let folder = Folder::new("h73-many");
    let (input, output) = (folder.file("a.bpt", PATCH), folder.text("a.obj"));
    for tol in ["1e-11", "1e-12", "1e-30", "1e-300"] {
        let refused = run(&["mesh", &input, "-o", &output, "--tol", tol]);
        refused.fails_with(5, &["a.bpt: "]);
    }
    run(&["mesh", &input, "-o", &output, "--tol", "1e-11"]).fails_with(5, &["triangles", "the limit is"]);
    assert_eq!(folder.names(), ["a.bpt"]);
}

#[test]
fn h73_a_budget_below_the_precision_of_the_format_names_a_format_that_will_do() {
    let folder = Folder::new("h73-precision");
    let (input, output) = (folder.file("a.bpt", PATCH), folder.text("a.glb"));
    run(&["mesh", &input, "-o", &output, "--tol", "1e-8"])
        .fails_with(5, &["glb", "obj, ply, off, 3mf and vtp keep every digit"]);
    assert_eq!(folder.names(), ["a.bpt"]);
}

#[test]
fn a_budget_that_is_not_reached_writes_nothing_unless_told_to_keep_the_best() {
    let folder = Folder::new("unmet");
    let (input, output) = (folder.file("a.bpt", PATCH), folder.text("a.obj"));
    let args = ["mesh", &input, "-o", &output, "--tol", "1e-3", "--triangles", "10"];
    run(&args).fails_with(5, &["a.bpt: ", "--keep-best"]);
    assert_eq!(folder.names(), ["a.bpt"]);

    let kept = run(&[&args[..], &["--keep-best", "--json"]].concat());
    kept.fails_with(5, &["a.bpt: "]);
    assert_eq!(folder.names(), ["a.bpt", "a.obj"]);
    let certificate = &kept.report()["certificate"];
    assert!(certificate["output"]["triangles"].as_u64().unwrap() <= 10);
    assert!(certificate["bound"]["at_most"].as_f64().unwrap() > 1e-3);
    assert!(certificate["notes"].to_string().contains("not met"), "{certificate}");
}

#[test]
fn triangles_become_fewer_or_are_too_many() {
    let folder = Folder::new("through");
    let (input, output) = (folder.file("a.obj", CLOSED_OBJ), folder.text("b.ply"));
    let through = run(&["mesh", &input, "-o", &output, "--tol", "1%", "--json"]);
    through.succeeds();
    let certificate = &through.report()["certificate"];
    assert_eq!(certificate["bound"]["at_most"], 0.0);
    assert_eq!(certificate["bound"]["evidence"], "proved");
    assert_eq!(certificate["output"]["triangles"], 4);
    assert_eq!(certificate["valid"]["closed"], true);
    assert!(certificate["notes"].to_string().contains("simplified"), "{certificate}");

    let few = folder.text("c.ply");
    run(&["mesh", &input, "-o", &few, "--triangles", "3"]).fails_with(5, &["a.obj: ", "4 triangles"]);
    assert_eq!(folder.names(), ["a.obj", "b.ply"]);
}

#[test]
fn a_count_that_is_not_reached_names_the_pieces_that_stand_in_the_way() {
    let folder = Folder::new("pieces");
    let moved: String = (0..3)
        .map(|k| {
            let v = |x: u32, y: u32, z: u32| format!("v {} {y} {z}\n", 4 * k + x);
            let f = |a: u32, b: u32, c: u32| format!("f {} {} {}\n", 4 * k + a, 4 * k + b, 4 * k + c);
            let corners = [v(0, 0, 0), v(1, 0, 0), v(0, 1, 0), v(0, 0, 1)].concat();
            corners + &[f(1, 3, 2), f(1, 2, 4), f(2, 3, 4), f(3, 1, 4)].concat()
        })
        .collect();
    let (input, output) = (folder.file("three.obj", moved), folder.text("few.ply"));
    let args = ["mesh", &input, "-o", &output, "--triangles", "9"];
    let why = "12 triangles are left and 9 are allowed: a count alone removes no separate piece";
    let pieces = "3 pieces: piece 0 (4), piece 1 (4), piece 2 (4); a length in addition to the count";
    run(&args).fails_with(5, &["three.obj: ", why, pieces]);
    let kept = run(&[&args[..], &["--keep-best"]].concat());
    kept.fails_with(5, &[why]);
    assert!(kept.stdout.contains("stayed") && kept.stdout.contains(pieces), "{kept:?}");
    let within = run(&[&args[..], &["--tol", "1e-6", "--force"]].concat());
    within.fails_with(5, &["no more can go within the length", "a larger length lets more go"]);
    let report = run(&[&args[..], &["--keep-best", "--force", "--json"]].concat()).report();
    assert!(report["certificate"]["notes"].to_string().contains(pieces), "{report}");
}

#[test]
fn a_sheet_with_a_back_says_why_it_stays_and_what_helps() {
    const N: usize = 10;
    let folder = Folder::new("backs");
    let id = |i: usize, j: usize| i * (N + 1) + j + 1;
    let mut text: String =
        (0..(N + 1) * (N + 1)).map(|k| format!("v {} {} 0\n", k / (N + 1), k % (N + 1))).collect();
    for (i, j) in (0..N * N).map(|k| (k / N, k % N)) {
        let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
        text += &format!("f {a} {b} {c}\nf {a} {c} {d}\nf {c} {b} {a}\nf {d} {c} {a}\n");
    }
    let (input, output) = (folder.file("cloth.obj", text), folder.text("fewer.ply"));
    let why = "400 of 400 triangles are left: where edges have three triangles or more (280x)";
    let help =
        "200 of them lie on another one, like the back side of a sheet: --drop-duplicates of mend leaves one";
    // On the terminal, and not only in the report.
    let told = run(&["mesh", &input, "--tol", "1%", "-o", &output]);
    assert_eq!(told.code, 0, "{told:?}");
    assert!(["stayed", why, help].iter().all(|part| told.stdout.contains(part)), "{told:?}");
    let counted = run(&["mesh", &input, "--triangles", "20", "-o", &output, "--force", "--quiet"]);
    counted.fails_with(5, &[why, help]);
    assert!(!counted.stderr.contains("no separate piece"), "{counted:?}");
    // What is advised does help.
    let one = folder.text("one.ply");
    assert_eq!(run(&["mend", &input, "--drop-duplicates", "-o", &one]).code, 0);
    let fewer = run(&["mesh", &one, "--tol", "1%", "-o", &output, "--force", "--json"]);
    assert_eq!(fewer.report()["certificate"]["output"]["triangles"], 2, "{fewer:?}");
    assert!(!run(&["mesh", &one, "--tol", "1%", "-o", &output, "--force"]).stdout.contains("stayed"));
}

#[test]
fn a_draft_says_on_the_terminal_that_its_triangles_may_cross() {
    let folder = Folder::new("draft-note");
    let blend = "union(sphere(1), move(sphere(1), 1, 0, 0), fillet=0.3)\n";
    let (input, output) = (folder.file("blend.star", blend), folder.text("blend.ply"));
    let args = ["mesh", &input, "--tol", "0.1", "--require", "estimated", "-o", &output];
    let told = run(&args);
    told.succeeds();
    let note = "a draft: its triangles may cross each other";
    assert!(told.stdout.contains(&format!("note        {note}")), "{told:?}");
    let report = run(&[&args[..], &["--force", "--json"]].concat()).report();
    assert_eq!(report["certificate"]["notes"].to_string().matches(note).count(), 1, "{report}");
    let proved = run(&["mesh", &input, "--tol", "0.1", "-o", &output, "--force"]);
    assert!(!proved.stdout.contains(note), "{proved:?}");
}

#[test]
fn a_draft_of_solids_has_their_edges() {
    let folder = Folder::new("draft-of-solids");
    let script = "box(4, 4, 1) - cylinder(1, 2)\n";
    let (input, output) = (folder.file("plate.star", script), folder.text("plate.ply"));
    let made = run(&["mesh", &input, "--tol", "3%", "--require", "estimated", "-o", &output, "--json"]);
    made.succeeds();
    let report = made.report();
    let certificate = &report["certificate"];
    assert_eq!(certificate["bound"]["evidence"], "estimated", "{report}");
    assert!(!certificate["notes"].to_string().contains("may cross"), "{report}");
    // Its hole has as many sides as a thousandth of the size asks for, and its flat faces no triangles of their own.
    let found = run(&["deviation", &output, &input, "--json"]).report();
    assert!(found["certificate"]["bound"]["at_most"].as_f64().unwrap() < 0.01, "{found}");
    assert!(certificate["output"]["triangles"].as_u64().unwrap() < 500, "{report}");
    let inspected = run(&["inspect", &output, "--self-intersections", "--json"]).report();
    assert_eq!(inspected["certificate"]["valid"]["self_intersections"], 0, "{inspected}");
}

#[test]
fn the_certified_bound_keeps_within_what_was_asked_in_every_format() {
    let folder = Folder::new("within");
    let input = folder.file("a.bpt", PATCH);
    for (budget, limit) in [("0.01", 0.01), ("2e-5", 2e-5), ("0.1%", 0.001 * 4.6)] {
        for output in ["a.obj", "a.ply", "a.stl", "a.glb"] {
            let made =
                run(&["mesh", &input, "-o", &folder.text(output), "--tol", budget, "--json", "--force"]);
            made.succeeds();
            let certificate = &made.report()["certificate"];
            let asked = certificate["budget"]["length"].as_f64().unwrap();
            let [least, most] =
                ["at_least", "at_most"].map(|end| certificate["bound"][end].as_f64().unwrap());
            assert!(asked <= limit, "{certificate}");
            assert!(0.0 <= least && least <= most && most <= asked, "{certificate}");
        }
    }
}

#[test]
fn the_bound_in_pixels_keeps_within_what_was_asked() {
    let folder = Folder::new("pixels");
    let input = folder.file("a.bpt", PATCH);
    for view in ["1920x1080 fov=45 dist=4", "640x480 fov=60 eye=9,8,7 target=1,1,0", "800x800 height=5"] {
        for output in ["a.obj", "a.glb"] {
            let args = ["mesh", &input, "-o", &folder.text(output), "--px", "0.5", "--view", view];
            let made = run(&[&args[..], &["--json", "--force"]].concat());
            made.succeeds();
            let certificate = &made.report()["certificate"];
            let pixels = certificate["bound"]["pixels"].as_f64().unwrap();
            assert!(pixels > 0.0 && pixels <= 0.5, "{certificate}");
            assert_eq!(certificate["budget"]["pixels"], 0.5);
        }
    }
}

#[test]
fn a_percentage_needs_a_shape_with_a_size() {
    let folder = Folder::new("no-size");
    let point = folder.file("point.obj", "v 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\n");
    let args = ["mesh", &point, "-o", &folder.text("a.ply"), "-q", "--tol"];
    run(&[&args[..], &["1%"]].concat()).fails_with(3, &["point.obj: ", "no size"]);
    run(&[&args[..], &["0.1"]].concat()).succeeds();
}
