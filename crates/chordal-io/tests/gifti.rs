//! GIFTI: what its arrays may be, and what happens to those that lie.
use crate::common::{count, load_scene, refuse};
use chordal_io::{Axis, Content, Format, Limits, read_with};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;

const POINTS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [0.0, 2.5, 0.0], [0.0, 0.0, -3.5]];
const TRIANGLES: [[i32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

/// Base64 by its definition (RFC 4648).
fn base64(bytes: &[u8]) -> String {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in bytes.chunks(3) {
        let word =
            chunk.iter().fold(0_u32, |word, byte| word << 8 | u32::from(*byte)) << (8 * (3 - chunk.len()));
        for k in 0..4 {
            let is_there = k <= chunk.len();
            text.push(if is_there {
                char::from(ALPHABET[(word >> (18 - 6 * k) & 63) as usize])
            } else {
                '='
            });
        }
    }
    text
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// How the arrays of a file are written.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Form {
    encoding: &'static str,
    is_big: bool,
    by_columns: bool,
}

const PLAIN: Form = Form { encoding: "ASCII", is_big: false, by_columns: false };

/// Words of four bytes in an order, as the file has them.
fn array(
    form: Form,
    (intent, kind): (&str, &str),
    rows: &[[u32; 3]],
    text: impl Fn(u32) -> String,
) -> String {
    let n = rows.len();
    let words: Vec<u32> = if form.by_columns {
        (0..3).flat_map(|k| rows.iter().map(move |row| row[k])).collect()
    } else {
        rows.as_flattened().to_vec()
    };
    let bytes: Vec<u8> =
        words.iter().flat_map(|w| if form.is_big { w.to_be_bytes() } else { w.to_le_bytes() }).collect();
    let data = match form.encoding {
        "ASCII" => words.iter().map(|word| text(*word) + " ").collect(),
        "Base64Binary" => base64(&bytes),
        _ => base64(&zlib(&bytes)),
    };
    let order = if form.by_columns { "ColumnMajorOrder" } else { "RowMajorOrder" };
    let endian = if form.is_big { "BigEndian" } else { "LittleEndian" };
    format!(
        "<DataArray Intent=\"NIFTI_INTENT_{intent}\" DataType=\"NIFTI_TYPE_{kind}\" ArrayIndexingOrder=\"{order}\" \
         Dimensionality=\"2\" Dim0=\"{n}\" Dim1=\"3\" Encoding=\"{}\" Endian=\"{endian}\" ExternalFileName=\"\" \
         ExternalFileOffset=\"\">\n<MetaData><MD><Name><![CDATA[a]]></Name><Value><![CDATA[b]]></Value></MD></MetaData>\n\
         <Data>{data}</Data>\n</DataArray>\n",
        form.encoding
    )
}

fn file(form: Form) -> String {
    let points = array(form, ("POINTSET", "FLOAT32"), &POINTS.map(|p| p.map(f32::to_bits)), |w| {
        f32::from_bits(w).to_string()
    });
    let triangles = array(form, ("TRIANGLE", "INT32"), &TRIANGLES.map(|t| t.map(|i| i as u32)), |w| {
        (w as i32).to_string()
    });
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!DOCTYPE GIFTI SYSTEM \"http://gifti.example/gifti.dtd\">\n\
         <GIFTI Version=\"1.0\" NumberOfDataArrays=\"2\">\n<MetaData/><LabelTable/>\n{points}{triangles}</GIFTI>\n"
    )
}

#[test]
fn every_form_of_the_arrays_is_the_same_surface() {
    for encoding in ["ASCII", "Base64Binary", "GZipBase64Binary"] {
        for is_big in [false, true] {
            for by_columns in [false, true] {
                let form = Form { encoding, is_big, by_columns };
                let bytes = file(form).into_bytes();
                assert_eq!(Format::sniff(&bytes), Some(Format::Gii));
                let (scene, warnings) = load_scene(&bytes, Format::Gii);
                assert_eq!(warnings, [], "{form:?}");
                let mesh = &scene.parts[0].mesh;
                assert_eq!(mesh.positions(), POINTS.map(|p| p.map(f64::from)), "{form:?}");
                assert_eq!(mesh.faces(), TRIANGLES.map(|t| t.map(|i| i as u32)), "{form:?}");
                assert_eq!((scene.frame.up, scene.frame.metres_per_unit), (Some(Axis::Z), Some(0.001)));
            }
        }
    }
}

#[test]
fn arrays_may_stand_in_a_file_beside() {
    let bytes: Vec<u8> = POINTS.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    let text = file(PLAIN);
    let start = text.find("<Data>").unwrap();
    let end = text.find("</Data>").unwrap();
    let text = format!("{}<Data>{}", &text[..start], &text[end..])
        .replacen("\"ASCII\"", "\"ExternalFileBinary\"", 1)
        .replacen("ExternalFileName=\"\"", "ExternalFileName=\"points.bin\"", 1)
        .replacen("ExternalFileOffset=\"\"", "ExternalFileOffset=\"5\"", 1);
    let mut open = |path: &str| match path {
        "points.bin" => Ok([&[0; 5][..], &bytes, b"more"].concat()),
        other => Err(format!("no {other}")),
    };
    let outcome = read_with(text.as_bytes(), Format::Gii, &mut open, &Limits::default()).unwrap();
    let Content::Scene(scene) = outcome.content else { panic!("no scene") };
    assert_eq!(scene.parts[0].mesh.positions()[3], [0.0, 0.0, -3.5]);
    assert_eq!(refuse(text.as_bytes(), Format::Gii).code, "detached");
    let outside = text.replace("points.bin", "../points.bin");
    let error = read_with(outside.as_bytes(), Format::Gii, &mut open, &Limits::default()).unwrap_err();
    assert_eq!(error.code, "outside-folder");
    let beyond = text.replace("ExternalFileOffset=\"5\"", "ExternalFileOffset=\"50\"");
    let error = read_with(beyond.as_bytes(), Format::Gii, &mut open, &Limits::default()).unwrap_err();
    assert_eq!(error.code, "truncated");
}

#[test]
fn numbers_at_the_points_are_counted_and_left_out() {
    let shape = "<DataArray Intent=\"NIFTI_INTENT_SHAPE\" DataType=\"NIFTI_TYPE_FLOAT32\" Dimensionality=\"1\" Dim0=\"4\" \
                 Encoding=\"ASCII\"><Data>1 2 3 4</Data></DataArray>";
    let text = file(PLAIN).replace("</GIFTI>", &format!("{shape}</GIFTI>"));
    let (_, warnings) = load_scene(text.as_bytes(), Format::Gii);
    assert_eq!(count(&warnings, "arrays-skipped"), 1);
    let alone = format!("<GIFTI Version=\"1.0\">{shape}</GIFTI>");
    let error = refuse(alone.as_bytes(), Format::Gii);
    assert_eq!(error.code, "no-surface");
    assert!(error.message.contains("points"), "{error}");
}

#[test]
fn files_that_lie_are_one_error() {
    let text = file(PLAIN);
    for (from, to, code) in [
        ("<GIFTI ", "<GIFTY ", "not-gifti"),
        ("NIFTI_TYPE_FLOAT32", "NIFTI_TYPE_FLOAT128", "unknown-value"),
        ("Encoding=\"ASCII\"", "Encoding=\"Morse\"", "unknown-value"),
        ("Encoding=\"ASCII\"", "Encoding=\"Base64Binary\"", "bad-base64"),
        ("\"LittleEndian\"", "\"MiddleEndian\"", "unknown-value"),
        ("RowMajorOrder", "Diagonal", "unknown-value"),
        ("Dim0=\"4\"", "Dim0=\"5\"", "truncated"),
        ("Dim0=\"4\"", "Dim0=\"3\"", "trailing-bytes"),
        ("Dim0=\"4\"", "Dim0=\"-4\"", "count-out-of-range"),
        ("Dim0=\"4\"", "Dim0=\"x\"", "not-a-number"),
        ("Dim0=\"4\"", "Dim0=\"1000000000000\"", "too-many-rows"),
        ("Dim0=\"4\" Dim1=\"3\"", "Dim0=\"6\" Dim1=\"2\"", "wrong-width"),
        ("Dimensionality=\"2\"", "Dimensionality=\"3\"", "wrong-width"),
        ("1.5", "nan", "not-finite"),
        ("0 2 1", "0 2 4", "index-out-of-range"),
        ("0 2 1", "0 2 -1", "index-out-of-range"),
        (
            "<!DOCTYPE GIFTI SYSTEM \"http://gifti.example/gifti.dtd\">",
            "<!DOCTYPE GIFTI [<!ENTITY a \"b\">]>",
            "dtd-not-allowed",
        ),
        ("</GIFTI>", "", "not-xml"),
    ] {
        assert!(text.contains(from), "{from}");
        let error = refuse(text.replacen(from, to, 1).as_bytes(), Format::Gii);
        assert_eq!(error.code, code, "{to}: {error}");
    }
    // A stream that unpacks to more than it declares, or to nothing like what it is.
    let packed = file(Form { encoding: "GZipBase64Binary", ..PLAIN });
    for (from, to, code) in [
        ("Dim0=\"4\"", "Dim0=\"3\"", "trailing-bytes"),
        ("Dim0=\"4\"", "Dim0=\"40\"", "truncated"),
        ("Dim0=\"4\"", "Dim0=\"400000000\"", "too-many-rows"),
    ] {
        let error = refuse(packed.replacen(from, to, 1).as_bytes(), Format::Gii);
        assert_eq!(error.code, code, "{to}: {error}");
    }
}

#[test]
fn surfaces_of_the_average_brain_have_the_corners_that_freesurfer_gave_them() {
    let Some(folder) = chordal_testkit::corpus::find("volume/nilearn/nilearn/datasets/data/fsaverage5")
    else {
        return;
    };
    for name in ["pial_left.gii.gz", "sphere_left.gii.gz"] {
        let bytes = std::fs::read(folder.join(name)).expect("readable");
        let (scene, _) = load_scene(&bytes, Format::Gii);
        let mesh = &scene.parts[0].mesh;
        // An icosahedron that was divided by four five times.
        assert_eq!(
            (mesh.positions().len(), mesh.faces().len()),
            (10 * 4_usize.pow(5) + 2, 20 * 4_usize.pow(5))
        );
        if name.starts_with("sphere") {
            let radius = |p: &[f64; 3]| p.iter().map(|x| x * x).sum::<f64>().sqrt();
            // Measured in the file's own floats: radii from 99.99290 to 100.00781.
            assert!(mesh.positions().iter().all(|p| (radius(p) - 100.0).abs() < 0.008));
        }
    }
}
