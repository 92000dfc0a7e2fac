//! `chordal mesh --normals`: which rows a file has, and that it stays closed.
use crate::common;

use common::{CLOSED_OBJ, Folder, run};

/// The vertices and positions that are written.
fn rows(input: &str, out: &str, normals: &[&str]) -> [u64; 2] {
    let made = run(&[&["mesh", input, "-o", out, "--tol", "1", "--force", "--json"], normals].concat());
    assert_eq!(made.code, 0, "{made:?}");
    let certificate = &made.report()["certificate"];
    assert_eq!(certificate["valid"]["closed"], true, "{normals:?}");
    ["vertices", "positions"].map(|name| certificate["output"][name].as_u64().unwrap())
}

#[test]
fn hard_edges_double_vertices_and_leave_the_surface_closed() {
    let folder = Folder::new("normals");
    let (input, glb, obj) = (folder.file("a.obj", CLOSED_OBJ), folder.text("a.glb"), folder.text("out.obj"));
    for (normals, expected) in [
        (&[][..], [12, 4]),
        (&["--normals", "crease"], [12, 4]),
        (&["--normals", "crease=180deg"], [4, 4]),
        (&["--normals", "smooth"], [4, 4]),
        (&["--normals", "flat"], [12, 4]),
        (&["--normals", "keep"], [4, 4]),
    ] {
        assert_eq!(rows(&input, &glb, normals), expected, "{normals:?}");
        // OBJ has one row for each position, and numbers its normals apart.
        assert_eq!(rows(&input, &obj, normals), [4, 4], "{normals:?}");
        let text = std::fs::read_to_string(&obj).unwrap();
        assert_eq!(text.contains("\nvn "), normals != ["--normals", "keep"], "{normals:?}");
    }
    // PLY ties no vertices, so that it stays as it is unless it is told otherwise.
    assert_eq!(rows(&input, &folder.text("a.ply"), &[]), [4, 4]);
    // What a file has is kept.
    rows(&input, &glb, &["--normals", "smooth"]);
    assert_eq!(rows(&glb, &folder.text("b.glb"), &[]), [4, 4]);
}

#[test]
fn what_is_no_normal_is_refused_in_a_sentence() {
    let folder = Folder::new("normals-refuse");
    let input = folder.file("a.obj", CLOSED_OBJ);
    for wrong in ["round", "crease=200deg", "crease=NaN", "crease=-1"] {
        run(&["mesh", &input, "-o", &folder.text("a.glb"), "--tol", "1", "--normals", wrong])
            .fails_with(2, &["--normals", wrong]);
    }
}

#[test]
fn smoothing_groups_of_a_file_decide_where_they_are_asked_for() {
    let folder = Folder::new("normals-groups");
    let (head, faces) = CLOSED_OBJ.split_at(CLOSED_OBJ.find("f ").unwrap());
    let glb = folder.text("a.glb");
    let one = folder.file("one.obj", format!("{head}s 1\n{faces}"));
    assert_eq!(rows(&one, &glb, &["--normals", "groups"]), [4, 4]);
    let apart = faces.lines().zip(1..).map(|(face, n)| format!("s {n}\n{face}\n")).collect::<String>();
    let four = folder.file("four.obj", format!("{head}{apart}"));
    assert_eq!(rows(&four, &glb, &["--normals", "groups"]), [12, 4]);
    let off = folder.file("off.obj", format!("{head}s off\n{faces}"));
    assert_eq!(rows(&off, &glb, &["--normals", "groups"]), [12, 4]);
}
