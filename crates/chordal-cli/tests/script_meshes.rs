//! Shape scripts that name meshes: which files are read, which are not, and that none of them is replaced.
use crate::common;

use chordal::render::Picture;
use common::{CLOSED_OBJ, Folder, run};

/// A tetrahedron whose corner is cut off, and the same as a script needs it.
const CUT: &str = "mesh('part.obj') - sphere(0.4)\n";

#[test]
fn a_mesh_minus_a_ball_is_a_closed_solid_in_one_command() {
    let folder = Folder::new("script-mesh");
    folder.file("part.obj", CLOSED_OBJ);
    let script = folder.file("cut.star", CUT);
    let out = folder.path("cut.stl");
    let made = run(&["mesh", &script, "--tol", "2%", "-o", out.to_str().unwrap(), "--json"]);
    made.succeeds();
    let certificate = &made.report()["certificate"];
    assert_eq!(certificate["input"]["files"][0]["path"], "part.obj");
    // The triangles of the file are cut along those of the ball: a promise of sides.
    assert_eq!(certificate["bound"]["evidence"], "proved-if");
    assert_eq!(certificate["bound"]["metric"], "solid");
    assert!(made.stdout.contains("were cut as they are"), "{}", made.stdout);
    let looked = run(&["inspect", out.to_str().unwrap(), "--json"]);
    looked.succeeds();
    assert_eq!(looked.report()["certificate"]["valid"]["closed"], true, "{}", looked.stdout);
}

#[test]
fn a_mesh_that_is_cut_by_solids_takes_the_triangles_of_both() {
    let folder = Folder::new("script-mesh-cut");
    folder.file("part.obj", CLOSED_OBJ);
    // Two meshes, a solid that ends nowhere, and a union below a difference.
    let text = "part = mesh('part.obj')\n\
                (part | move(part, 0.3, 0.1, 0)) - (cylinder(0.2, 100) | move(box(0.1, 0.1, 9), 0.4, 0.4, 0))\n";
    let script = folder.file("cut.star", text);
    let out = folder.path("cut.ply");
    let made = run(&["mesh", &script, "--tol", "0.001", "-o", out.to_str().unwrap(), "--json"]);
    made.succeeds();
    let report = made.report();
    // As a field on a lattice it has tens of thousands.
    assert!(report["certificate"]["output"]["triangles"].as_u64().unwrap() < 2_000, "{}", made.stdout);
    assert!(report["certificate"]["bound"]["at_most"].as_f64().unwrap() <= 0.001);
    assert_eq!(report["certificate"]["valid"]["closed"], true);
}

#[test]
fn only_files_below_the_folder_of_the_script_or_an_allowed_one_are_read() {
    let folder = Folder::new("script-mesh-folders");
    std::fs::create_dir_all(folder.path("scripts")).unwrap();
    std::fs::create_dir_all(folder.path("parts")).unwrap();
    folder.file("parts/part.obj", CLOSED_OBJ);
    let script = folder.file("scripts/cut.star", "a = 1\nmesh('part.obj')\n");
    run(&["inspect", &script])
        .fails_showing(3, &["line 2, column 1: mesh(): 'part.obj' cannot be used: no such file"]);
    let parts = folder.path("parts");
    run(&["inspect", &script, "--allow", parts.to_str().unwrap()]).succeeds();
    for (name, why) in [
        ("../parts/part.obj", "without '..'"),
        ("/etc/passwd", "a path must be relative"),
        ("http://example.org/a.stl", "a path must be relative"),
        ("", "a path must be relative"),
    ] {
        let text = format!("mesh({name:?})\n");
        let script = folder.file("scripts/out.star", &text);
        run(&["inspect", &script]).fails_showing(3, &[why, "line 1, column 1"]);
    }
    let script = folder.file("scripts/number.star", "mesh(3)\n");
    run(&["inspect", &script]).fails_showing(3, &["needs the name of a file, not a number"]);
    let script = folder.file("scripts/self.star", "mesh('self.star')\n");
    run(&["inspect", &script]).fails_showing(3, &["not a file of triangles"]);
}

#[test]
fn a_mesh_that_a_script_read_is_never_replaced() {
    let folder = Folder::new("script-mesh-force");
    let part = folder.file("part.obj", CLOSED_OBJ);
    let script = folder.file("cut.star", CUT);
    run(&["mesh", &script, "--tol", "2%", "-o", &part, "--force"])
        .fails_with(4, &["a file that the input references"]);
    assert_eq!(std::fs::read_to_string(&part).unwrap(), CLOSED_OBJ);
    std::fs::create_dir_all(folder.path("allowed")).unwrap();
    let far = folder.file("allowed/far.obj", CLOSED_OBJ);
    let script = folder.file("far.star", "mesh('far.obj')\n");
    let allowed = folder.path("allowed");
    let allow = allowed.to_str().unwrap();
    run(&["mesh", &script, "--allow", allow, "--tol", "2%", "-o", &far, "--force"])
        .fails_with(4, &["a file that the input references"]);
    assert_eq!(std::fs::read_to_string(&far).unwrap(), CLOSED_OBJ);
    let tiles = format!("{allow}/");
    run(&["lod", &script, "--allow", allow, "--tol", "2%", "-o", &tiles, "--force"])
        .fails_with(4, &["allowed"]);
    assert_eq!(std::fs::read_to_string(&far).unwrap(), CLOSED_OBJ);
}

#[test]
fn a_buffer_in_an_allowed_folder_is_never_replaced() {
    let folder = Folder::new("allowed-buffer");
    for name in ["allowed", "scenes"] {
        std::fs::create_dir_all(folder.path(name)).unwrap();
    }
    let [scene, far] = ["scenes/x.gltf", "allowed/x.gltf"].map(|name| folder.text(name));
    run(&["convert", &folder.file("part.obj", CLOSED_OBJ), &far, "--separate"]).succeeds();
    std::fs::rename(&far, &scene).unwrap();
    let buffer = std::fs::read(folder.path("allowed/x.bin")).unwrap();
    let allow = folder.text("allowed");
    run(&["convert", &scene, &far, "--separate", "--force", "--allow", &allow])
        .fails_with(4, &["the output is a file of the input"]);
    assert_eq!(std::fs::read(folder.path("allowed/x.bin")).unwrap(), buffer);
}

#[test]
fn what_is_no_solid_is_warned_of_and_a_bound_taken_as_a_distance_too() {
    let folder = Folder::new("script-mesh-open");
    let open: String =
        CLOSED_OBJ.lines().filter(|line| !line.starts_with("f 1 2")).map(|l| format!("{l}\n")).collect();
    folder.file("part.obj", &open);
    let script = folder.file("open.star", "mesh('part.obj')\n");
    let made = run(&["inspect", &script]);
    made.succeeds_saying("the mesh is not a solid");
    let script = folder.file("grown.star", "mesh('part.obj')\noffset(mesh('part.obj'), 0.1)\n");
    run(&["inspect", &script]).fails_showing(3, &["line 2, column 1", "needs a distance"]);
    let script = folder.file("thin.star", "offset(box(2, 2, 2) | sphere(1.2), -0.2)\n");
    let made = run(&["inspect", &script]);
    made.succeeds_saying("redistance(shape, within)");
    let script = folder.file("true.star", "offset(redistance(box(2, 2, 2) | sphere(1.2), 0.05), -0.2)\n");
    let made = run(&["inspect", &script]);
    made.succeeds();
    assert!(!made.stderr.contains("redistance(shape, within)"), "{}", made.stderr);
    assert!(made.stdout.contains("away from it"), "{}", made.stdout);
}

#[test]
fn limits_hold_for_what_a_script_reads_and_makes() {
    let folder = Folder::new("script-mesh-limits");
    folder.file("part.obj", CLOSED_OBJ);
    let many = folder.file("fine.star", "redistance(box(2, 2, 2) - mesh('part.obj'), 1e-5)\n");
    run(&["inspect", &many, "--max-memory", "20M"]).fails_showing(3, &["redistance()", "the limit is"]);
}

#[test]
fn a_picture_is_the_solid_below_its_greys() {
    let folder = Folder::new("script-heights");
    let picture = |greys: &[u8], width: u32| {
        let rgba: Vec<u8> = greys.iter().flat_map(|grey| [*grey, *grey, *grey, 255]).collect();
        let mut file = Vec::new();
        let picture = Picture { width, height: greys.len() as u32 / width, rgba };
        chordal_io::png::write(&picture, &[], &mut file).unwrap();
        file
    };
    folder.file("hills.png", picture(&[0, 255, 51, 102, 0, 0], 2));
    folder.file("line.png", picture(&[0, 255], 2));
    // White is in the first row.
    let text = "hills = heightmap('hills.png', [4, 2], 5, base=1)\nb = box_of(hills)\n\
                def near(found, wanted):\n    return max([abs(found[k] - wanted[k]) for k in range(3)]) < 1e-9\n\
                check(near(b['min'], [-2, -1, 0]) and near(b['max'], [2, 1, 6]), str(b['min']) + str(b['max']))\n\
                hills - move(box(2, 2, 2), 0, 0, 9)\n";
    let script = folder.file("hills.star", text);
    let looked = run(&["inspect", &script, "--json"]);
    looked.succeeds();
    assert_eq!(looked.report()["certificate"]["input"]["files"][0]["path"], "hills.png");
    for (text, why) in [
        ("heightmap('hills.png', 4, 5, 1)", "size must be a list of two lengths above 0"),
        ("heightmap('hills.png', [4, 0], 5, 1)", "size must be a list of two lengths above 0"),
        ("heightmap('hills.png', [4, 2], 5, 0)", "must be lengths above 0"),
        ("heightmap('line.png', [4, 2], 5, 1)", "at least 2 pixels each way, and it has 2 by 1"),
        ("heightmap('part.obj', [4, 2], 5, 1)", "this is no PNG"),
        ("heightmap('none.png', [4, 2], 5, 1)", "'none.png' cannot be used: no such file"),
        ("heightmap('../hills.png', [4, 2], 5, 1)", "without '..'"),
    ] {
        folder.file("part.obj", CLOSED_OBJ);
        let script = folder.file("wrong.star", format!("{text}\n"));
        run(&["inspect", &script]).fails_showing(3, &[why]);
    }
}
