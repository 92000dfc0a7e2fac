//! Libraries that are made to harm.
use super::{Files, PNG, load, load_limited, said, squares};
use crate::common::count;
use chordal_io::{Content, Format, Limits, read_with};

#[test]
fn nothing_outside_the_folder_is_asked_for() {
    let paths = [
        "../../../etc/passwd",
        "/etc/passwd",
        "\\\\host\\share\\passwd",
        "C:\\Windows\\passwd",
        "c:passwd",
        "a/../../passwd",
        "..\\passwd",
        "file:///etc/passwd",
        "https://example.org/passwd",
    ];
    for path in paths {
        let is_url = path.contains("://");
        let check = |asked: &[String]| {
            assert!(asked.iter().all(|asked| asked == "passwd" || asked == "a.mtl"), "{path}: {asked:?}");
            assert!(!is_url || !asked.iter().any(|asked| asked == "passwd"), "{path}: {asked:?}");
        };
        let (_, warnings, asked) = load(&squares(path, &["m"]), &Files::default());
        check(&asked);
        assert!(said(&warnings, "mtllib-outside").contains("outside the folder"), "{path}: {warnings:?}");
        let library = Files::default().with("a.mtl", format!("newmtl m\nmap_Kd {path}\n"));
        let (_, warnings, asked) = load(&squares("a.mtl", &["m"]), &library);
        check(&asked);
        assert_eq!(count(&warnings, "picture-outside"), 1, "{path}: {warnings:?}");
        // What a program on another machine wrote with its folder is taken where it stands beside.
        let (scene, warnings, _) = load(&squares("a.mtl", &["m"]), &library.with("passwd", PNG));
        let n_found = u64::from(!is_url);
        assert_eq!((count(&warnings, "found-by-name"), scene.assets.images.len() as u64), (n_found, n_found));
    }
}

#[test]
fn a_library_that_is_no_library_is_a_warning() {
    for bytes in [&b"newmtl m\0Kd 1 0 0"[..], b"\xff\xfen\0e\0", PNG.as_slice()] {
        let files = Files::default().with("a.mtl", bytes);
        let (scene, warnings, _) = load(&squares("a.mtl", &["m"]), &files);
        assert_eq!(count(&warnings, "mtllib-unreadable"), 1, "{bytes:?}: {warnings:?}");
        assert!(scene.assets.materials.is_empty());
    }
    for text in ["", "\n\n", "newmtl", "newmtl \nKd 1 1 1", "Kd 1 1 1\n", "\\\n\\\n", "\u{feff}newmtl m"] {
        let (scene, warnings, _) = load(&squares("a.mtl", &["m"]), &Files::default().with("a.mtl", text));
        assert_eq!(scene.assets.materials.len(), 1, "{text:?}");
        assert_eq!(count(&warnings, "material-missing"), u64::from(!text.ends_with('m')), "{text:?}");
    }
}

#[test]
fn values_that_are_none_are_skipped_and_named() {
    let bad = [
        "Kd nan 0 0",
        "Kd 1e999 0 0",
        "Kd 1 2",
        "Kd",
        "Kd red",
        "Ns",
        "Ns nan",
        "Ns -1.#IND",
        "d inf",
        "illum x",
        "map_Kd",
        "Kd 1 0,5 0",
        "Pr \u{663}",
    ];
    for statement in bad {
        let files = Files::default().with("a.mtl", format!("newmtl m\nKa 1 1 1\n{statement}\n"));
        let (scene, warnings, _) = load(&squares("a.mtl", &["m"]), &files);
        let told = said(&warnings, "mtl-value");
        assert!(told.contains(" in line 3 of a.mtl"), "{statement}: {warnings:?}");
        let text = scene.assets.materials[0].to_string();
        assert!(!text.contains("null") && text.contains(r#""extras":{"mtl":{"Ka":[1,1,1]}}"#), "{text}");
    }
    let files = Files::default()
        .with("a.mtl", "newmtl m\nKd -1 2 0.5\nKe -1 0 0\nNs 1e300\nnonsense 1\nmap_Kd -s 1 1 1 -o\n");
    let (scene, warnings, _) = load(&squares("a.mtl", &["m"]), &files);
    assert_eq!(
        scene.assets.materials[0]["pbrMetallicRoughness"]["baseColorFactor"],
        serde_json::json!([0.0, 1.0, 0.5, 1.0])
    );
    assert!(said(&warnings, "mtl-unknown").ends_with(": nonsense in line 5 of a.mtl"), "{warnings:?}");
    assert_eq!(count(&warnings, "map-skipped"), 1, "a map without a picture");
}

#[test]
fn all_files_together_keep_to_the_limit() {
    let obj = squares("a.mtl", &["m"]);
    let files = Files::default()
        .with("a.mtl", "newmtl m\nmap_Kd p.png\nmap_Ke q.png\n")
        .with("p.png", PNG)
        .with("q.png", PNG);
    let limits = Limits {
        bytes: (obj.len() + files.0["a.mtl"].len() + 2 * PNG.len() - 1) as u64,
        ..Limits::default()
    };
    let (scene, warnings, _) = load_limited(&obj, &files, &limits);
    assert_eq!(scene.assets.images.len(), 1);
    assert!(said(&warnings, "picture-missing").contains("q.png (all files together are over the limit)"));
    let limits = Limits { bytes: obj.len() as u64, ..Limits::default() };
    let (scene, warnings, _) = load_limited(&obj, &files, &limits);
    assert_eq!((scene.assets.materials.len(), count(&warnings, "mtllib-missing")), (0, 1));
}

#[test]
fn one_library_named_ten_thousand_times_is_opened_once() {
    let mut obj = squares("a.mtl", &["m"]);
    (0..10_000).for_each(|i| obj += if i % 2 == 0 { "mtllib ./a.mtl\n" } else { "mtllib a.mtl a.mtl\n" });
    let (scene, _, asked) = load(&obj, &Files::default().with("a.mtl", "newmtl m\nKd 1 0 0\n"));
    assert_eq!(scene.assets.materials.len(), 1);
    assert_eq!(asked.iter().filter(|path| *path == "a.mtl").count(), 1);
}

#[test]
fn a_hundred_thousand_materials_of_one_face_are_read_and_those_of_none_are_not() {
    let mut library = String::new();
    (0..100_000).for_each(|i| library += &format!("newmtl m{i}\nKd 0.5 0.5 0.5\nKs 1 1 1\n"));
    let files = Files::default().with("a.mtl", library);
    let (scene, warnings, _) = load(&squares("a.mtl", &["m7", "m99999"]), &files);
    assert_eq!((scene.assets.materials.len(), count(&warnings, "materials-unused")), (2, 99_998));
    let told = said(&warnings, "materials-unused");
    assert!(told.contains("m0, m1,") && told.ends_with(" and 99990 more"), "{told}");
    // So many that their descriptions pass what a reader may hold: names are kept.
    let names: Vec<String> = (0..100_000).map(|i| format!("m{i}")).collect();
    let all = names.iter().map(|name| format!("usemtl {name}\n")).collect::<String>();
    let obj = format!("{}{all}f 1 2 3\n", squares("a.mtl", &["m0"]));
    let (scene, warnings, _) = load(&obj, &files);
    assert_eq!((scene.assets.materials.len(), scene.groups[chordal_io::MATERIAL].len()), (0, 100_001));
    assert!(said(&warnings, "materials-skipped").ends_with(": 100000 materials"), "{warnings:?}");
}

#[test]
fn mutations_of_a_library_end_well() {
    let text = "newmtl m\nKa 1 0 0\nKd 0.5 0.5 0.5\nKs 1 1 1\nNs 10\nd -halo 0.5\nTr 0.5\nmap_Kd -s 1 2 3 -o 1 -clamp on p.png\n\
        map_Bump -bm 2 p.png\nnorm p.png\nmap_d p.png\nPr 0.5\nPm 1\nmap_Pr p.png\nKe 2 2 2\nnewmtl \\\nn\nillum 7\n";
    let obj = squares("a.mtl", &["m", "n"]);
    let mut random = chordal_testkit::Random::new(20_260_101);
    for round in 0..3000 {
        let mut bytes = text.as_bytes().to_vec();
        for _ in 0..=random.below(4) {
            if bytes.is_empty() {
                break;
            }
            let at = random.below(bytes.len());
            match random.below(4) {
                0 => bytes[at] = random.below(256) as u8,
                1 => drop(bytes.remove(at)),
                2 => bytes.insert(at, b" \n-.\\/0e#"[random.below(9)]),
                _ => bytes.truncate(at.max(1)),
            }
        }
        let mut open = |path: &str| match path {
            "a.mtl" => Ok(bytes.clone()),
            _ if path.split('/').any(|part| part == "..") || path.starts_with('/') => {
                panic!("{path} was asked for")
            }
            _ => Ok(PNG.to_vec()),
        };
        let found = read_with(obj.as_bytes(), Format::Obj, &mut open, &Limits::default());
        let Ok(Content::Scene(scene)) = found.map(|found| found.content) else { panic!("round {round}") };
        let mut glb = Vec::new();
        chordal_io::glb::write(&scene, None, &mut glb)
            .unwrap_or_else(|error| panic!("round {round}: {error}"));
        chordal_io::glb::read(&glb, &Limits::default())
            .unwrap_or_else(|error| panic!("round {round}: {error}"));
    }
}
