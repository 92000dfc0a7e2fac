//! What the table of formats says of them, against what their writers do.
use chordal::Mesh;
use chordal_io::{Content, Format, Frame, Limits, Scene, read, snap, write};

fn only_points() -> Scene {
    let mesh = Mesh::new(vec![[0.1, 0.2, 0.3], [1.0, 0.0, 0.7]], Vec::new()).unwrap();
    Scene::from_mesh("points", mesh, Frame::default())
}

#[test]
fn formats_hold_points_where_the_table_says_so() {
    for format in Format::all().filter(|format| format.holds_triangles()) {
        let mut bytes = Vec::new();
        let is_written = write(&only_points(), None, format, &mut bytes).is_ok();
        let read_back = read(&bytes, format, &Limits::default()).ok();
        let n_points = read_back.map_or(0, |outcome| match outcome.content {
            Content::Scene(scene) => scene.parts.iter().map(|part| part.mesh.positions().len()).sum(),
            _ => 0,
        });
        assert_eq!(is_written && n_points == 2, format.holds_points(), "{format}");
    }
}

#[test]
fn formats_keep_every_digit_where_the_table_says_so() {
    // No third is a number of single precision, about any origin that is one.
    let thirds = [[1.0 / 3.0, -2.0 / 3.0, 1e3 / 3.0], [7.0 / 3.0, 1e-7 / 3.0, 0.1], [0.0, 5.0 / 3.0, -0.3]];
    for format in Format::all().filter(|format| format.holds_triangles()) {
        let mesh = Mesh::new(thirds.to_vec(), vec![[0, 1, 2]]).unwrap();
        // As the format's type of positions rounds them: text has room for digits that the type has not.
        let mesh = snap(&mesh, format).unwrap().mesh;
        let mut bytes = Vec::new();
        write(&Scene::from_mesh("thirds", mesh, Frame::default()), None, format, &mut bytes).unwrap();
        let Content::Scene(scene) = read(&bytes, format, &Limits::default()).unwrap().content else {
            panic!("{format}")
        };
        let same = scene.parts[0].mesh.positions() == thirds;
        assert_eq!(same, format.keeps_every_digit(), "{format}");
    }
}

/// The names of formats in the words before a phrase, back to the start of their clause.
fn listed_before(page: &str, phrase: &str) -> Vec<Format> {
    let text = page.split_whitespace().collect::<Vec<_>>().join(" ");
    let at = text.find(phrase).unwrap_or_else(|| panic!("no '{phrase}'"));
    let clause = text[..at].rsplit([';', '.', ':']).next().unwrap_or_default();
    clause.split([' ', ',']).filter_map(|word| word.trim_matches('`').parse().ok()).collect()
}

#[test]
fn pages_list_the_formats_of_the_table() {
    let page = |name: &str| {
        let path = format!("{}/../../docs/{name}", env!("CARGO_MANIFEST_DIR"));
        std::fs::read_to_string(path).unwrap()
    };
    let where_so =
        |is_so: fn(Format) -> bool| Format::all().filter(|format| is_so(*format)).collect::<Vec<_>>();
    let sorted = |mut list: Vec<Format>| {
        list.sort_by_key(|format| *format as usize);
        list
    };
    let (formats, by_view, normals) = (page("formats.md"), page("by_view.md"), page("normals.md"));
    assert_eq!(sorted(listed_before(&formats, "hold points.")), where_so(Format::holds_points));
    assert_eq!(sorted(listed_before(&by_view, "keep every digit.")), where_so(Format::keeps_every_digit));
    let creased = normals.split("`crease=30deg` in ").nth(1).unwrap();
    let creased = listed_before(&format!("; {creased}"), "none in the others");
    assert_eq!(sorted(creased), where_so(Format::wants_normals));
    // Every format has a row of the table.
    for format in Format::all().filter(|format| !matches!(format, Format::Teaset)) {
        let is_row = |line: &str| line.starts_with('|') && line.contains(&format!("`.{format}`"));
        assert!(format == Format::Tileset || formats.lines().any(is_row), "{format}");
    }
}
