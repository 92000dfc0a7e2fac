//! The binary form: tables, values in themselves and elsewhere, packed and plain.
use super::build::{ARRAY, CrateFile, INLINED, PACKED, grid, packed, packed_integers, value};
use chordal_io::{Axis, Content, Format, Limits, ReadError, Scene, usd};

fn scene(bytes: &[u8]) -> Scene {
    match usd::read(bytes, &Limits::default()).unwrap().content {
        Content::Scene(scene) => scene,
        other => panic!("no scene: {other:?}"),
    }
}

#[test]
fn tables_and_values_are_unpacked() {
    let bytes = grid(6);
    assert_eq!(Format::sniff(&bytes), Some(Format::Usdc));
    let scene = scene(&bytes);
    assert_eq!((scene.frame.up, scene.frame.metres_per_unit), (Some(Axis::Z), Some(0.5)));
    assert_eq!((&*scene.nodes[0].name, &scene.nodes[0].matrix[12..15]), ("World", &[1.0, 2.0, -2.0][..]));
    let mesh = &scene.parts[0].mesh;
    assert_eq!((mesh.positions().len(), mesh.faces().len()), (49, 72));
    assert_eq!(mesh.positions()[48], [6.0, 6.0, 0.25]);
}

/// A file whose one mesh has points as some value, with three points at whole numbers.
fn with_points(make: impl FnOnce(&mut CrateFile) -> u64) -> Result<Scene, ReadError> {
    let mut file = CrateFile::new();
    let children = file.tokens(&["m"]);
    file.spec(0, "", 7, &[("primChildren", children)]);
    let mesh = value(INLINED, 11, file.token("Mesh"));
    let none = value(INLINED, 11, file.token("none"));
    let m = file.spec(0, "m", 6, &[("specifier", value(INLINED, 42, 0)), ("typeName", mesh)]);
    let points = make(&mut file);
    let (counts, corners) = (file.integers(&[3]), file.integers(&[0, 1, 2]));
    for (name, value) in [
        ("points", points),
        ("faceVertexCounts", counts),
        ("faceVertexIndices", corners),
        ("subdivisionScheme", none),
    ] {
        file.spec(m, name, 1, &[("default", value)]);
    }
    match usd::read(&file.finish(), &Limits::default())?.content {
        Content::Scene(scene) => Ok(scene),
        other => panic!("no scene: {other:?}"),
    }
}

#[test]
fn numbers_have_every_precision() {
    let rows = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -0.5, 0.0];
    let count = 3_u64.to_le_bytes().to_vec();
    let double: Vec<u8> = rows.iter().flat_map(|x| f64::from(*x).to_le_bytes()).collect();
    // 1 and -0.5 in 16 bits.
    let half: Vec<u8> = rows
        .iter()
        .flat_map(|x| {
            (if *x > 0.0 {
                0x3C00_u16
            } else if *x < 0.0 {
                0xB800
            } else {
                0
            })
            .to_le_bytes()
        })
        .collect();
    let expected = scene(&grid(1)).parts.len();
    assert_eq!(expected, 1);
    for (kind, bytes) in [(23, double), (25, half)] {
        let scene = with_points(|file| {
            let at = file.put(&[count.clone(), bytes].concat());
            value(ARRAY, kind, at)
        });
        assert_eq!(scene.unwrap().parts[0].mesh.positions(), [[0.0; 3], [1.0, 0.0, 0.0], [0.0, -0.5, 0.0]]);
    }
}

#[test]
fn what_a_value_says_of_itself_is_checked() {
    let code = |make: &dyn Fn(&mut CrateFile) -> u64| with_points(make).unwrap_err().code;
    // Beyond the file; a length that is not there; one that overflows.
    assert_eq!(code(&|_| value(ARRAY, 24, 1 << 40)), "truncated");
    assert_eq!(
        code(&|file| {
            let at = file.put(&(1_u64 << 31).to_le_bytes());
            value(ARRAY, 24, at)
        }),
        "truncated"
    );
    assert_eq!(
        code(&|file| {
            let at = file.put(&u64::MAX.to_le_bytes());
            value(ARRAY, 24, at)
        }),
        "too-many-rows"
    );
    // Points that are no points are no mesh.
    let scene = with_points(|file| value(INLINED, 11, file.token("x"))).unwrap();
    assert!(scene.parts.is_empty());
}

#[test]
fn packed_integers_are_checked() {
    let with_corners = |bytes: Vec<u8>| {
        let mut file = CrateFile::new();
        let children = file.tokens(&["m"]);
        file.spec(0, "", 7, &[("primChildren", children)]);
        let mesh = value(INLINED, 11, file.token("Mesh"));
        let m = file.spec(0, "m", 6, &[("specifier", value(INLINED, 42, 0)), ("typeName", mesh)]);
        let points = file.floats(24, 3, &[0.0; 9]);
        let at = file.put(&bytes);
        let counts = file.integers(&[3]);
        for (name, value) in [
            ("points", points),
            ("faceVertexCounts", counts),
            ("faceVertexIndices", value(ARRAY | PACKED, 3, at)),
        ] {
            file.spec(m, name, 1, &[("default", value)]);
        }
        usd::read(&file.finish(), &Limits::default()).unwrap_err().code
    };
    let n = |n: u64| n.to_le_bytes().to_vec();
    assert_eq!(with_corners([n(20), packed_integers(&[0; 20])].concat()), "count-mismatch");
    assert_eq!(with_corners([n(20), packed_integers(&[7; 20])].concat()), "index-out-of-range");
    assert_eq!(with_corners([n(400), packed_integers(&[0; 20])].concat()), "bad-integers");
    assert_eq!(with_corners([n(1 << 31), packed_integers(&[0; 20])].concat()), "bad-integers");
    assert_eq!(with_corners([n(20), n(1 << 40), vec![0; 4]].concat()), "truncated");
    // A match that reaches before the start.
    assert_eq!(with_corners([n(20), n(5), vec![0, 0x04, 9, 0, 0]].concat()), "bad-lz4");
    assert_eq!(with_corners([n(20), packed(&[1, 2, 3])].concat()), "bad-integers");
}

#[test]
fn few_bytes_do_not_unpack_to_many() {
    // Literals and then one match of 4 MB: a run of 255s.
    let mut block = vec![0, 0x1F, 0, 1, 0];
    block.extend(std::iter::repeat_n(255, 16_500));
    block.push(0);
    let bytes =
        [16_000_000_u64.to_le_bytes().to_vec(), (block.len() as u64).to_le_bytes().to_vec(), block].concat();
    let error = with_points(|file| {
        let at = file.put(&bytes);
        value(ARRAY | PACKED, 3, at)
    });
    // The points are unpacked to see that they are no rows of three.
    assert_eq!(error.unwrap_err().code, "too-dense");
}

#[test]
fn a_file_that_is_cut_off_or_changed_is_one_error_or_a_shape() {
    let whole = grid(5);
    for end in 0..whole.len() {
        if let Err(error) = usd::read(&whole[..end], &Limits::default()) {
            assert!(!error.code.is_empty() && !error.message.is_empty());
        }
    }
    for at in 0..whole.len() {
        for change in [0x01, 0x80, 0xFF] {
            let mut bytes = whole.clone();
            bytes[at] ^= change;
            if let Err(error) = usd::read(&bytes, &Limits::default()) {
                assert!(!error.code.is_empty());
            }
        }
    }
}

#[test]
fn versions_that_are_not_known_are_refused() {
    let mut bytes = grid(1);
    for version in [[1, 0], [0, 3], [0, 99]] {
        bytes[8..10].copy_from_slice(&version);
        assert_eq!(usd::read(&bytes, &Limits::default()).unwrap_err().code, "unknown-version");
    }
}
