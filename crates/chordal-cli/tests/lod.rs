//! `chordal lod`: levels of detail in one file or as tiles.
use crate::common;
use common::{Folder, PATCH, TEAPOT, run};
use serde_json::Value;

/// The report, which keeps to its schema.
fn checked(report: Value) -> Value {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/schema/report.schema.json");
    let schema: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let schema = jsonschema::validator_for(&schema).unwrap();
    let errors: Vec<String> = schema.iter_errors(&report).map(|error| error.to_string()).collect();
    assert!(errors.is_empty(), "{errors:?}");
    report
}

/// A ball of 5,120 triangles as an .obj.
fn ball() -> String {
    let t = (1.0 + 5_f64.sqrt()) / 2.0;
    let mut points: Vec<[f64; 3]> = Vec::new();
    for (a, b) in [(-1.0, t), (1.0, t), (-1.0, -t), (1.0, -t)] {
        points.push([a, b, 0.0]);
    }
    for (a, b) in [(-1.0, t), (1.0, t), (-1.0, -t), (1.0, -t)] {
        points.push([0.0, a, b]);
    }
    for (a, b) in [(-1.0, t), (1.0, t), (-1.0, -t), (1.0, -t)] {
        points.push([b, 0.0, a]);
    }
    let mut faces = [
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ]
    .to_vec();
    for _ in 0..4 {
        let mut middles = std::collections::BTreeMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in faces {
            let [x, y, z] = [(a, b), (b, c), (c, a)].map(|(p, q): (usize, usize)| {
                *middles.entry((p.min(q), p.max(q))).or_insert_with(|| {
                    let (p, q) = (points[p], points[q]);
                    points.push([0, 1, 2].map(|k| (p[k] + q[k]) / 2.0));
                    points.len() - 1
                })
            });
            finer.extend([[a, x, z], [b, y, x], [c, z, y], [x, y, z]]);
        }
        faces = finer;
    }
    let mut text = String::new();
    for p in &points {
        let size = p.iter().map(|x| x * x).sum::<f64>().sqrt();
        text += &format!("v {} {} {}\n", p[0] / size, p[1] / size, p[2] / size);
    }
    for [a, b, c] in faces {
        text += &format!("f {} {} {}\n", a + 1, b + 1, c + 1);
    }
    text
}

fn numbers<'a>(list: &'a Value, key: &'a str) -> impl Iterator<Item = f64> + 'a {
    list.as_array().unwrap().iter().map(move |item| item[key].as_f64().unwrap())
}

#[test]
fn levels_of_a_mesh_grow_in_error_and_fall_in_triangles() {
    let folder = Folder::new("lod-mesh");
    let (input, output) = (folder.file("ball.obj", ball()), folder.text("ball.glb"));
    let made = run(&["lod", &input, "-o", &output, "--px", "1", "--nearest", "3", "--json"]);
    made.succeeds();
    let report = checked(made.report());
    let levels = &report["certificate"]["levels"]["levels"];
    let errors: Vec<f64> = numbers(levels, "at_most").collect();
    let triangles: Vec<f64> = numbers(levels, "triangles").collect();
    assert!(errors.len() >= 4, "{levels}");
    assert!(errors.windows(2).all(|w| w[0] < w[1]), "{errors:?}");
    assert!(triangles.windows(2).all(|w| w[0] > w[1]), "{triangles:?}");
    assert!(triangles[0] < 5120.0 && *triangles.last().unwrap() <= 64.0);
    // At the nearest distance the finest level is fine enough, everywhere on the screen.
    let distances: Vec<f64> = numbers(levels, "distance").collect();
    assert!(distances[0] <= 3.0 && distances[0] > 2.0, "{distances:?}");
    // Rows for the shape at 1000, 200, 20 and 2 pixels, and no row that is off by more than a pixel beyond
    // the first distance.
    let shown = report["certificate"]["levels"]["shown"].as_array().unwrap();
    for covered in [1000.0, 200.0, 20.0, 2.0] {
        assert!(
            shown.iter().any(|row| (row["covers_px"].as_f64().unwrap() - covered).abs() < 1e-6 * covered)
        );
    }
    for row in shown.iter().filter(|row| row["distance"].as_f64().unwrap() >= 3.0) {
        assert!(row["pixels"].as_f64().unwrap() <= 1.0, "{row}");
    }
    // The file reads back as its finest level.
    let inspected = run(&["inspect", &output, "--json"]);
    assert_eq!(inspected.code, 0, "{inspected:?}");
    assert_eq!(inspected.report()["certificate"]["output"]["triangles"].as_f64(), Some(triangles[0]));
}

#[test]
fn tiles_of_patches_say_errors_by_which_viewers_keep_the_pixel() {
    let folder = Folder::new("lod-tiles");
    let output = folder.text("tiles");
    let made = run(&["lod", TEAPOT, "-o", &format!("{output}/"), "--px", "1", "--nearest", "40", "--json"]);
    made.succeeds();
    let report = checked(made.report());
    let levels = report["certificate"]["levels"]["levels"].as_array().unwrap();
    let list: Value =
        serde_json::from_slice(&std::fs::read(folder.path("tiles/tileset.json")).unwrap()).unwrap();
    assert_eq!(list["asset"]["version"], "1.1");
    let mut tile = &list["root"];
    let mut depth = 0;
    loop {
        let level = &levels[levels.len() - 1 - depth];
        let said = tile["geometricError"].as_f64().unwrap();
        let name = tile["content"]["uri"].as_str().unwrap();
        assert!(folder.path("tiles").join(name).is_file(), "{name}");
        let Some(child) = tile["children"].as_array().and_then(|children| children.first()) else {
            assert_eq!(said, 0.0);
            assert_eq!(tile["extras"]["chordal"]["at_most"], level["at_most"]);
            break;
        };
        // The formula of viewers shows it from the proved distance on, and not nearer.
        let focal = 540.0 / (30_f64.to_radians().tan());
        let distance = said * focal;
        let proved = level["distance"].as_f64().unwrap();
        assert!((distance / proved - 1.0).abs() < 1e-9, "{distance} {proved}");
        assert!(
            said > level["at_most"].as_f64().unwrap() && child["geometricError"].as_f64().unwrap() < said
        );
        (tile, depth) = (child, depth + 1);
    }
    assert_eq!(depth + 1, levels.len());
    // Plain errors are the proved ones.
    let plain = folder.text("plain/");
    run(&["lod", TEAPOT, "-o", &plain, "--nearest", "40", "--errors", "plain", "-q"]).succeeds();
    let list: Value =
        serde_json::from_slice(&std::fs::read(folder.path("plain/tileset.json")).unwrap()).unwrap();
    assert_eq!(list["root"]["geometricError"], levels.last().unwrap()["at_most"]);
}

#[test]
fn tiles_stand_at_a_place_on_the_earth() {
    let folder = Folder::new("lod-place");
    let lod = |name: &str, more: &[&str]| {
        let output = folder.text(name);
        run(&[&["lod", TEAPOT, "-o", &output, "--nearest", "40", "-q"][..], more].concat())
    };
    let root = |name: &str| -> Value {
        let list = std::fs::read(folder.path(name).join("tileset.json")).unwrap();
        serde_json::from_slice::<Value>(&list).unwrap()["root"].clone()
    };
    lod("plain/", &[]).succeeds();
    lod("pole/", &["--at", "90,0,50"]).succeeds();
    // At the North Pole on longitude 0, east is y, north is -x, and up is z.
    let matrix: Vec<f64> =
        root("pole")["transform"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
    assert_eq!(matrix[..12], [0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    assert!((matrix[14] - 6_356_802.314_245_179).abs() < 1e-8, "{matrix:?}");
    assert_eq!(root("pole")["boundingVolume"], root("plain")["boundingVolume"]);
    assert!(root("plain")["transform"].is_null());
    lod("south/", &["--at", "-33.9,-70"]).succeeds();
    lod("x.glb", &["--at", "1,2"]).fails_with(2, &["--at", "3D Tiles"]);
    lod("y/", &["--at", "91,2"]).fails_with(2, &["latitude"]);
    lod("z/", &["--at", "1"]).fails_with(2, &["LATITUDE,LONGITUDE"]);
}

#[test]
fn a_large_mesh_is_cut_into_tiles_and_the_table_counts_them() {
    let folder = Folder::new("lod-cut");
    // Far from the origin, where coordinates of tiles cannot be about zero.
    let far: String = ball()
        .lines()
        .map(|line| match line.strip_prefix("v ") {
            Some(numbers) => {
                let numbers: Vec<f64> = numbers.split(' ').map(|x| x.parse::<f64>().unwrap() + 1e6).collect();
                format!("v {} {} {}\n", numbers[0], numbers[1], numbers[2])
            }
            None => format!("{line}\n"),
        })
        .collect();
    let input = folder.file("ball.obj", far);
    let output = folder.text("tiles/");
    let made = run(&["lod", &input, "-o", &output, "--tol", "0.0005", "--tile-triangles", "300", "--json"]);
    made.succeeds();
    let report = checked(made.report());
    let levels = report["certificate"]["levels"]["levels"].as_array().unwrap();
    assert!(levels[0]["tiles"].as_u64().unwrap() > 4 && levels[0]["at_most"].as_f64().unwrap() <= 0.0005);
    assert_eq!(levels.last().unwrap()["tiles"], 1);
    let list: Value =
        serde_json::from_slice(&std::fs::read(folder.path("tiles/tileset.json")).unwrap()).unwrap();
    let place = list["root"]["transform"].as_array().unwrap();
    assert!((place[12].as_f64().unwrap() - 1e6).abs() < 2.0, "{place:?}");
    // What is shown for an error, by the tree in the file.
    fn shown(tile: &Value, error: f64, tiles: &mut Vec<f64>) {
        let facts = &tile["extras"]["chordal"];
        match tile["children"].as_array() {
            Some(children) if facts["at_most"].as_f64().unwrap() > error => {
                children.iter().for_each(|child| shown(child, error, tiles));
            }
            _ => tiles.push(facts["triangles"].as_f64().unwrap()),
        }
    }
    for level in levels {
        let mut tiles = Vec::new();
        shown(&list["root"], level["at_most"].as_f64().unwrap(), &mut tiles);
        assert!(tiles.iter().all(|n| *n <= 300.0));
        assert_eq!(Some(tiles.len() as u64), level["tiles"].as_u64());
        assert_eq!(Some(tiles.iter().sum::<f64>()), level["triangles"].as_f64());
    }
    // In one file nothing is cut.
    let one = folder.text("one.glb");
    run(&["lod", &input, "-o", &one, "--tol", "0.0005", "--tile-triangles", "300", "-q"]).succeeds();
}

#[test]
fn one_patch_in_one_file_is_within_a_tolerance() {
    let folder = Folder::new("lod-patch");
    let (input, output) = (folder.file("a.bpt", PATCH), folder.text("a.glb"));
    let made = run(&["lod", &input, "-o", &output, "--tol", "0.001", "--distances", "10,1000", "--json"]);
    made.succeeds();
    let report = checked(made.report());
    let levels = &report["certificate"]["levels"];
    assert!(numbers(&levels["levels"], "at_most").next().unwrap() <= 0.001);
    assert!(numbers(&levels["shown"], "distance").any(|d| d == 1000.0));
}

/// Errors far below what the mesh is made of bring nothing for many steps, and then the levels come all the
/// same.
#[test]
fn a_very_fine_budget_still_ends_in_few_triangles() {
    let folder = Folder::new("lod-fine");
    let (input, output) = (folder.file("ball.obj", ball()), folder.text("ball.glb"));
    let made = run(&["lod", &input, "-o", &output, "--tol", "1e-6", "--json"]);
    made.succeeds();
    let report = checked(made.report());
    let levels = &report["certificate"]["levels"]["levels"];
    let triangles: Vec<f64> = numbers(levels, "triangles").collect();
    assert!(triangles[0] == 5120.0 && triangles.len() > 4, "{triangles:?}");
    assert!(*triangles.last().unwrap() <= 64.0);
    assert!(levels.as_array().unwrap().iter().all(|level| level["evidence"] == "proved"));
}

/// Where several levels are only shown from nearer than the whole fits on the screen, shares of it still fall
/// from one to the next.
#[test]
fn shares_of_the_screen_fall_from_level_to_level() {
    let folder = Folder::new("lod-shares");
    let (input, output) = (folder.file("a.bpt", PATCH), folder.text("a.glb"));
    run(&["lod", &input, "-o", &output, "--tol", "0.0005", "--view", "1920x1080 fov=10", "-q"]).succeeds();
    let bytes = std::fs::read(&output).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let json: Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    let shares = json["nodes"].as_array().unwrap().iter().find_map(|node| {
        let all = node["extras"]["MSFT_screencoverage"].as_array()?;
        Some(all.iter().map(|x| x.as_f64().unwrap()).collect::<Vec<_>>())
    });
    let shares = shares.expect("shares");
    assert!(shares[..2] == [1.0, 0.99] && shares.windows(2).all(|w| w[0] > w[1]), "{shares:?}");
}

#[test]
fn what_stays_and_what_goes_is_said() {
    let folder = Folder::new("lod-kept");
    // A speck just outside of the ball, which is within the length of it.
    let speck = "v 1.0002 0 0\nv 1.0002001 0 0\nv 1.0002 0.0000001 0\nf 2563 2564 2565\n";
    let input = folder.file("ball.obj", ball() + speck);
    let made = run(&["lod", &input, "-o", &folder.text("a.glb"), "--tol", "0.002", "--verbose"]);
    assert!(made.code == 0 && made.stderr.contains("separate pieces"), "{made:?}");
}

#[test]
fn a_folder_of_tiles_is_made_late_and_not_mixed() {
    let folder = Folder::new("lod-folder");
    let (input, tiles) = (folder.file("a.bpt", PATCH), folder.text("tiles/"));
    run(&["lod", &folder.text("none.obj"), "-o", &tiles]).fails_with(3, &["none.obj"]);
    assert_eq!(folder.names(), ["a.bpt"]);
    run(&["lod", &input, "-o", &tiles, "--tol", "0.01", "-q"]).succeeds();
    run(&["lod", &input, "-o", &tiles, "--tol", "0.01"]).fails_with(4, &["--force"]);
    // What a run left that was broken off.
    std::fs::remove_file(folder.path("tiles/tileset.json")).unwrap();
    run(&["lod", &input, "-o", &tiles, "--tol", "0.01"]).fails_with(4, &["level_", "--force"]);
    run(&["lod", &input, "-o", &tiles, "--tol", "0.01", "--force", "-q"]).succeeds();
    let own = folder.text("tiles/level_0.glb");
    run(&["lod", &own, "-o", &tiles, "--force"]).fails_with(4, &["tile", "input"]);
    assert!(folder.path("tiles/tileset.json").is_file());
    let many = ["lod", &input, "-o", &tiles, "--force", "--tol", "0.00015", "--tile-triangles", "1"];
    run(&many).fails_with(2, &["files", "--tile-triangles"]);
    assert!(folder.path("tiles/tileset.json").is_file(), "what is refused replaces nothing");
}

#[test]
fn what_makes_no_sense_is_said_before_work() {
    let folder = Folder::new("lod-usage");
    let input = folder.file("a.bpt", PATCH);
    let out = folder.text("a.glb");
    run(&["lod", &input, "-o", &folder.text("a.obj")]).fails_with(2, &["a.obj", ".glb", "3D Tiles"]);
    for (flag, value) in [
        ("--px", "0"),
        ("--px", "-1"),
        ("--px", "nan"),
        ("--nearest", "0"),
        ("--nearest", "inf"),
        ("--tol", "0"),
        ("--tol", "-1"),
        ("--view", "1920x1080 fov=180"),
        ("--distances", "1,-2"),
    ] {
        let run = run(&["lod", &input, "-o", &out, &format!("{flag}={value}")]);
        assert_eq!(run.code, 2, "{flag} {value}: {run:?}");
    }
    let view = |text: &str| run(&["lod", &input, "-o", &out, "--view", text]);
    view("1920x1080 fov=60 eye=0,0,1 target=0,0,0").fails_with(2, &["every direction", "eye and target"]);
    view("1920x1080 height=2").fails_with(2, &["parallel rays", "fov"]);
    let both = ["lod", &input, "-o", &out, "--view", "1920x1080 fov=60 dist=2", "--nearest", "3"];
    run(&both).fails_with(2, &["--view", "--nearest"]);
    // So little that triangles would be too many is refused before the work.
    let run_tiny = run(&["lod", &input, "-o", &out, "--tol", "1e-30"]);
    assert_eq!(run_tiny.code, 5, "{run_tiny:?}");
    let svg = folder.file("a.svg", "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0L1 1'/></svg>");
    run(&["lod", &svg, "-o", &out]).fails_with(2, &["curves"]);
    assert_eq!(folder.names(), ["a.bpt", "a.svg"]);
    // Nothing is replaced without a word.
    run(&["lod", &input, "-o", &out, "--tol", "0.1", "-q"]).succeeds();
    run(&["lod", &input, "-o", &out, "--tol", "0.1"]).fails_with(4, &["a.glb"]);
}

/// A bent sheet of 2,048 triangles with texture coordinates that run unevenly.
fn textured_sheet() -> String {
    let mut text = String::new();
    let at = |k: u32| f64::from(k) / 32.0;
    for (u, v) in (0..33).flat_map(|i| (0..33).map(move |j| (at(i), at(j)))) {
        text += &format!("v {u} {v} {}\n", 0.2 * (3.0 * u).sin() * (2.0 * v).cos());
        text += &format!("vt {} {v}\n", u + 0.03 * (20.0 * u).sin());
    }
    for (i, j) in (0..32).flat_map(|i| (0..32).map(move |j| (i, j))) {
        let [a, b, c, d] = [33 * i + j + 1, 33 * i + j + 34, 33 * i + j + 35, 33 * i + j + 2];
        text += &format!("f {a}/{a} {b}/{b} {c}/{c}\nf {a}/{a} {c}/{c} {d}/{d}\n");
    }
    text
}

#[test]
fn limits_on_texture_coordinates_hold_for_every_level_and_are_reported() {
    let folder = Folder::new("lod-uv");
    let (input, output) = (folder.file("sheet.obj", textured_sheet()), folder.text("sheet.glb"));
    let lod = |more: &[&str]| {
        let made =
            run(&[&["lod", &input, "--tol", "0.05%", "-o", &output, "--force", "--json"], more].concat());
        assert_eq!(made.code, 0, "{made:?}");
        checked(made.report())["certificate"].clone()
    };
    let free = lod(&[]);
    assert!(free["levels"]["levels"].as_array().unwrap().iter().all(|level| level["attributes"].is_null()));
    let made = lod(&["--uv-error", "1%", "--normal-error", "20deg"]);
    assert_eq!(made["budget"]["texcoord"], 0.01);
    assert_eq!(made["budget"]["normal_deg"], 20.0);
    let levels = made["levels"]["levels"].as_array().unwrap();
    assert!(levels.len() > 1);
    for level in levels {
        let off = level["attributes"][0]["largest"].as_f64().unwrap();
        assert!(level["attributes"][0]["name"] == "texcoord 0" && off <= 0.01, "{level}");
    }
    let coarsest =
        |levels: &Value| levels["levels"]["levels"].as_array().unwrap().last().unwrap()["triangles"].as_u64();
    assert!(coarsest(&made) > coarsest(&free));
    // In the text as well, and in the command for one mesh.
    let text = run(&["lod", &input, "--tol", "0.05%", "-o", &output, "--force", "--uv-error", "0.01"]);
    assert!(text.stdout.contains("texcoord 0"), "{text:?}");
    let mesh = |more: &[&str]| {
        let made =
            run(&[&["mesh", &input, "--tol", "2%", "-o", &output, "--force", "--json"], more].concat());
        assert_eq!(made.code, 0, "{made:?}");
        let certificate = checked(made.report())["certificate"].clone();
        (
            certificate["output"]["triangles"].as_u64(),
            certificate["attributes"][0]["largest"].as_f64().unwrap(),
        )
    };
    let (free, limited) = (mesh(&[]), mesh(&["--uv-error", "1%"]));
    assert!(limited.0 > free.0 && limited.1 <= 0.01 && free.1 > 0.01, "{free:?} {limited:?}");
}

#[test]
fn triangles_that_stay_for_their_texture_coordinates_are_counted_and_said() {
    let folder = Folder::new("uv-stayed");
    let mut text = textured_sheet();
    // Coordinates that turn from vertex to vertex: no edge can go without moving them.
    let mut k = 0_u32;
    text = text
        .lines()
        .map(|line| match line.strip_prefix("vt ") {
            Some(_) => {
                k += 1;
                format!("vt {} {}\n", f64::from(k * 37 % 101) / 101.0, f64::from(k * 53 % 97) / 97.0)
            }
            None => format!("{line}\n"),
        })
        .collect();
    let (input, output) = (folder.file("sheet.obj", text), folder.text("sheet.glb"));
    let asked = ["mesh", &input, "--tol", "2%", "-o", &output, "--force", "--uv-error", "1%"];
    let made = run(&[&asked[..], &["--json"]].concat());
    assert_eq!(made.code, 0, "{made:?}");
    let certificate = checked(made.report())["certificate"].clone();
    let notes = certificate["notes"].to_string();
    assert!(certificate["output"]["triangles"].as_u64().unwrap() > 1024, "{certificate}");
    for part in [
        "of 2048 triangles",
        "only because fewer would change texture coordinates",
        "a larger --uv-error lets",
    ] {
        assert!(notes.contains(part), "no '{part}' in {notes}");
    }
    // Whoever does not ask for notes is told as well.
    let told = run(&asked);
    assert!(told.stdout.contains("stayed") && told.stdout.contains("--uv-error lets more go"), "{told:?}");
    let free = run(&asked[..asked.len() - 2]);
    assert!(free.code == 0 && !free.stdout.contains("\n  stayed "), "{free:?}");
}

#[test]
fn limits_on_attributes_that_make_no_sense_are_refused() {
    let folder = Folder::new("uv-refused");
    let (input, output) = (folder.file("sheet.obj", textured_sheet()), folder.text("sheet.glb"));
    for (words, code) in [
        (&["mesh", &input, "--triangles", "100", "--uv-error", "1%", "-o", &output][..], 5),
        (&["mesh", TEAPOT, "--tol", "0.1", "--uv-error", "1%", "-o", &output], 5),
        (&["lod", TEAPOT, "--tol", "0.1", "--normal-error", "5", "-o", &output], 5),
        (&["mesh", &input, "--tol", "1%", "--uv-error", "0", "-o", &output], 2),
        (&["lod", &input, "--normal-error", "200deg", "-o", &output], 2),
    ] {
        let made = run(words);
        assert_eq!(made.code, code, "{words:?} {made:?}");
        assert!(!folder.names().iter().any(|name| name.ends_with(".glb")));
    }
}

#[test]
fn levels_of_solids_that_touch_say_why_they_are_not_proved() {
    let folder = Folder::new("lod-touching");
    let text = "body = box(10, 10, 10)\npost = move(cylinder(3, 10), 8, 0, 0)\nbody | post\n";
    let (input, output) = (folder.file("a.star", text), folder.text("a.glb"));
    run(&["lod", &input, "--tol", "0.1", "-o", &output]).fails_with(
        5,
        &[
            "levels need a proved bound",
            "two surfaces touch at (5.0",
            "lines 1 and 2",
            "overlap them",
            "--keep-best",
        ],
    );
}
