//! MetaImage: headers by hand, samples in the same file, in another, and in one for each slice.
use super::build::pack;
use super::{load, load_with, values};
use crate::common::{count, refuse};
use chordal_io::{
    Axis, Conformance, Content, FileLocation, Format, Limits, ReadError, Volume, read, read_with,
};
use std::collections::BTreeMap;
use std::io::Write;

const SIZE: &str = "ObjectType = Image\nNDims = 3\nDimSize = 2 3 2\n";

fn mha(fields: &str, data: &[u8]) -> Vec<u8> {
    [SIZE.as_bytes(), fields.as_bytes(), b"ElementDataFile = LOCAL\n", data].concat()
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).expect("packed");
    encoder.finish().expect("packed")
}

fn open_beside(header: &str, beside: &[(&str, Vec<u8>)]) -> Result<Volume, ReadError> {
    let files: BTreeMap<&str, &Vec<u8>> = beside.iter().map(|(name, bytes)| (*name, bytes)).collect();
    let mut open =
        |path: &str| files.get(path).map(|bytes| (*bytes).clone()).ok_or("no such file".to_owned());
    let outcome = read_with(header.as_bytes(), Format::MetaImage, &mut open, &Limits::default())?;
    let Content::Volume(volume) = outcome.content else { panic!("no volume") };
    Ok(volume)
}

fn bytes() -> Vec<u8> {
    (0..12).collect()
}

fn counted() -> Vec<f64> {
    (0..12).map(f64::from).collect()
}

#[test]
fn spacing_directions_and_offset_place_the_samples() {
    let fields = "ElementSpacing = 2 3 5\nTransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 10 20 30\n\
                  CenterOfRotation = 0 0 0\nAnatomicalOrientation = ALI\nElementType = MET_UCHAR\n";
    let file = mha(fields, &bytes());
    assert_eq!(Format::sniff(&file), Some(Format::MetaImage));
    let (volume, warnings) = load(&file, Format::MetaImage);
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(values(&volume), counted());
    // The first axis runs along y, the second against x.
    let rows = [[0.0, -3.0, 0.0, 10.0], [2.0, 0.0, 0.0, 20.0], [0.0, 0.0, 5.0, 30.0]];
    assert_eq!(volume.grid.affine().rows(), rows);
    assert_eq!((volume.space.as_deref(), volume.frame.up), (Some("LPS"), Some(Axis::Z)));
    let other = fields.replace("ALI", "RAI");
    let (_, warnings) = load(&mha(&other, &bytes()), Format::MetaImage);
    assert_eq!(count(&warnings, "orientation-differs"), 1);
    for (name, same) in [("Rotation", "Position"), ("Orientation", "Origin")] {
        let other = fields.replace("TransformMatrix", name).replace("Offset", same);
        assert_eq!(load(&mha(&other, &bytes()), Format::MetaImage).0.grid, volume.grid);
    }
    let size = fields.replace("ElementSpacing", "ElementSize").replace("ALI", "???");
    let (sized, _) = load(&mha(&size, &bytes()), Format::MetaImage);
    assert_eq!((&sized.grid, sized.space), (&volume.grid, None));
    for short in ["", "R", "RA"] {
        let (unsaid, _) = load(&mha(&fields.replace("ALI", short), &bytes()), Format::MetaImage);
        assert_eq!((unsaid.grid, unsaid.space), (volume.grid.clone(), None), "{short:?}");
    }
}

#[test]
fn every_type_in_both_byte_orders_is_exact() {
    fn check<const N: usize>(name: &str, number: impl Fn(u8) -> [u8; N]) {
        for is_big in [false, true] {
            let mut data = Vec::new();
            for i in 0..12 {
                let mut one = number(i);
                if is_big {
                    one.reverse();
                }
                data.extend(one);
            }
            let order = if is_big { "True" } else { "False" };
            for key in ["BinaryDataByteOrderMSB", "ElementByteOrderMSB"] {
                let fields = format!("ElementSpacing = 1 1 1\n{key} = {order}\nElementType = {name}\n");
                let (volume, warnings) = load(&mha(&fields, &data), Format::MetaImage);
                assert_eq!(values(&volume), counted(), "{name}");
                assert!(warnings.is_empty(), "{warnings:?}");
            }
        }
    }
    check("MET_CHAR", |i| [i]);
    check("MET_UCHAR", |i| [i]);
    check("MET_SHORT", |i| i16::from(i).to_le_bytes());
    check("MET_USHORT", |i| u16::from(i).to_le_bytes());
    check("MET_INT", |i| i32::from(i).to_le_bytes());
    check("MET_UINT", |i| u32::from(i).to_le_bytes());
    check("MET_LONG", |i| i32::from(i).to_le_bytes());
    check("MET_ULONG", |i| u32::from(i).to_le_bytes());
    check("MET_LONG_LONG", |i| i64::from(i).to_le_bytes());
    check("MET_ULONG_LONG", |i| u64::from(i).to_le_bytes());
    check("MET_FLOAT", |i| f32::from(i).to_le_bytes());
    check("MET_DOUBLE", |i| f64::from(i).to_le_bytes());
}

#[test]
fn packed_samples_and_text_are_read() {
    let fields = "ElementSpacing = 1 1 1\nElementType = MET_UCHAR\n";
    let all = counted();
    let packed = format!("CompressedData = True\n{fields}");
    for data in [zlib(&bytes()), pack(&bytes())] {
        assert_eq!(values(&load(&mha(&packed, &data), Format::MetaImage).0), all);
        let sized = format!("CompressedDataSize = {}\n{packed}", data.len());
        assert_eq!(values(&load(&mha(&sized, &data), Format::MetaImage).0), all);
        let longer = [&data[..], b"more"].concat();
        assert_eq!(refuse(&mha(&sized, &longer), Format::MetaImage).code, "trailing-bytes");
        let lenient = Limits { conformance: Conformance::Lenient, ..Limits::default() };
        let (volume, warnings) = load_with(&mha(&sized, &longer), Format::MetaImage, &lenient);
        assert_eq!((values(&volume), count(&warnings, "trailing-bytes")), (all.clone(), 1));
        let error = refuse(&mha(&sized, &data[..data.len() - 1]), Format::MetaImage);
        assert_eq!(error.code, "truncated", "{error}");
        assert!(matches!(
            refuse(&mha(&packed, &data[..9]), Format::MetaImage).code,
            "truncated" | "bad-zlib"
        ));
    }
    let mut damaged = zlib(&bytes());
    let last = damaged.len() - 1;
    damaged[last] ^= 1;
    assert_eq!(refuse(&mha(&packed, &damaged), Format::MetaImage).code, "bad-zlib");
    assert_eq!(refuse(&mha(&packed, &zlib(&[0; 13])), Format::MetaImage).code, "trailing-bytes");
    let text = "BinaryData = False\nElementSpacing = 1 1 1\nElementType = MET_SHORT\n";
    let numbers = b"0 1 2\n3 4 5 6 7\r\n8 9 10 11\n";
    assert_eq!(values(&load(&mha(text, numbers), Format::MetaImage).0), all);
    assert_eq!(refuse(&mha(text, b"0 1 2"), Format::MetaImage).code, "truncated");
    assert_eq!(refuse(&mha(text, &[&numbers[..], b"12"].concat()), Format::MetaImage).code, "trailing-bytes");
    for wrong in ["0 x", "0 1.5", "0 40000", "0 1,5"] {
        assert_eq!(refuse(&mha(text, wrong.as_bytes()), Format::MetaImage).code, "bad-number", "{wrong}");
    }
}

#[test]
fn samples_may_be_in_files_beside() {
    let header = |file: &str, more: &str| {
        format!("{SIZE}ElementSpacing = 1 1 1\n{more}ElementType = MET_UCHAR\nElementDataFile = {file}")
    };
    let all = counted();
    let raw = |bytes: &[u8]| [("a b.raw", bytes.to_vec())];
    assert_eq!(values(&open_beside(&header("a b.raw\n", ""), &raw(&bytes())).unwrap()), all);
    let skipped = [&[9_u8, 9, 9][..], &bytes()].concat();
    for more in ["HeaderSize = 3\n", "HeaderSize = -1\n"] {
        assert_eq!(values(&open_beside(&header("a b.raw", more), &raw(&skipped)).unwrap()), all);
    }
    let packed = raw(&zlib(&bytes()));
    assert_eq!(values(&open_beside(&header("a b.raw", "CompressedData = True\n"), &packed).unwrap()), all);
    let slices = |n: usize| -> Vec<(&str, Vec<u8>)> {
        let names = ["s/1.raw", "s/2.raw", "s/3.raw", "s/4.raw", "s/5.raw", "s/6.raw"];
        let each = bytes();
        names.into_iter().zip(each.chunks(12 / n)).map(|(name, part)| (name, part.to_vec())).collect()
    };
    let two = slices(2);
    for list in ["LIST\ns/1.raw\n\ns/2.raw\n", "LIST 2D\r\ns/1.raw\r\ns\\2.raw", "LIST 2\ns/1.raw\ns/2.raw"] {
        assert_eq!(values(&open_beside(&header(list, ""), &two).unwrap()), all, "{list}");
    }
    let rows: String = (1..=6).map(|i| format!("s/{i}.raw\n")).collect();
    assert_eq!(values(&open_beside(&header(&format!("LIST 1D\n{rows}"), ""), &slices(6)).unwrap()), all);
    for pattern in ["s/%d.raw", "s/%d.raw 1 2 1", "s/%01d.raw 1 9"] {
        assert_eq!(values(&open_beside(&header(pattern, ""), &two).unwrap()), all, "{pattern}");
    }
    for (file, code) in [
        ("../a.raw", "outside-folder"),
        ("/etc/passwd", "outside-folder"),
        ("https://a/b.raw", "no-network"),
        ("C:\\a.raw", "no-network"),
        ("missing.raw", "missing-file"),
        ("s/1.raw", "truncated"),
        ("", "bad-header"),
        ("LIST\ns/1.raw", "truncated"),
        ("LIST\ns/1.raw\ns/2.raw\ns/1.raw", "bad-header"),
        ("LIST 4D\ns/1.raw", "bad-header"),
        ("LIST\ns/1.raw\n../2.raw", "outside-folder"),
        ("s/%d.raw 1 1", "bad-header"),
        ("s/%d.raw 5 6", "missing-file"),
        ("s/%d.raw 1 2 0", "bad-header"),
        ("s/%d%d.raw", "bad-header"),
        ("s/%s.raw x", "bad-header"),
        ("s/%d.raw 9223372036854775807 9223372036854775807", "bad-header"),
    ] {
        let error = open_beside(&header(file, ""), &two).unwrap_err();
        assert_eq!(error.code, code, "{file}: {error}");
    }
    let error = open_beside(&header("a b.raw", ""), &raw(&[0; 13])).unwrap_err();
    assert_eq!((error.code, error.message.starts_with("a b.raw: ")), ("trailing-bytes", true), "{error}");
    assert_eq!(refuse(header("a b.raw", "").as_bytes(), Format::MetaImage).code, "detached");
    let error = open_beside(&header("a b.raw", "HeaderSize = 99\n"), &raw(&bytes())).unwrap_err();
    assert_eq!(error.code, "truncated");
}

#[test]
fn a_fourth_axis_is_chosen_from() {
    let text = "NDims = 4\nDimSize = 2 2 2 3\nElementSpacing = 1 2 3 4\nElementType = MET_UCHAR\n\
                Offset = 1 2 3 0\nElementDataFile = LOCAL\n";
    let file = [text.as_bytes(), &(0..24).collect::<Vec<u8>>()].concat();
    assert_eq!(refuse(&file, Format::MetaImage).code, "several-volumes");
    let limits = Limits { index: Some(1), ..Limits::default() };
    let (volume, _) = load_with(&file, Format::MetaImage, &limits);
    assert_eq!(values(&volume), (8..16).map(f64::from).collect::<Vec<_>>());
    assert_eq!(volume.grid.affine().rows()[2], [0.0, 0.0, 3.0, 3.0]);
    let limits = Limits { index: Some(3), ..Limits::default() };
    assert_eq!(read(&file, Format::MetaImage, &limits).unwrap_err().code, "no-such-volume");
    let turned = text.replace("Offset", "TransformMatrix = 1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1\nOffset");
    assert_eq!(refuse(&[turned.as_bytes(), &[0; 24]].concat(), Format::MetaImage).code, "singular");
}

#[test]
fn headers_that_lie_are_refused_at_their_line() {
    let base = "ElementSpacing = 1 1 1\nElementType = MET_UCHAR\n";
    for (fields, code, line) in [
        ("ElementNumberOfChannels = 3\n", "several-channels", 4),
        ("ElementNumberOfChannels = 0\n", "bad-header", 4),
        ("TransformMatrix = 1 0 0 0 1 0 0 0\n", "bad-header", 4),
        ("TransformMatrix = 1 0 0 0 1 0 0 1 0\n", "singular", 4),
        ("TransformMatrix = 1 0 0 0 1 0 0 nan 1\n", "not-finite", 4),
        ("Offset = 1 2\n", "bad-header", 4),
        ("Offset = 1 2 3\nOrigin = 1 2 4\n", "bad-header", 5),
        ("NDims = 3\n", "bad-header", 4),
        ("CompressedData = maybe\n", "bad-header", 4),
        ("CompressedData = True\nBinaryData = False\n", "unsupported", 4),
        ("CompressedData = True\nHeaderSize = -1\n", "bad-header", 5),
        ("HeaderSize = -7\n", "bad-header", 4),
        ("no field\n", "bad-header", 4),
    ] {
        let error = refuse(&mha(&format!("{fields}{base}"), &bytes()), Format::MetaImage);
        assert_eq!((error.code, error.place), (code, FileLocation::Line(line)), "{fields}");
    }
    for (from, to, code) in [
        ("DimSize = 2 3 2", "DimSize = 2 3", "bad-header"),
        ("DimSize = 2 3 2", "DimSize = 2 0 2", "bad-size"),
        ("DimSize = 2 3 2", "DimSize = 2 -3 2", "bad-size"),
        ("DimSize = 2 3 2", "DimSize = 2 3 1", "flat-volume"),
        ("DimSize = 2 3 2", "DimSize = 99999 99999 99999", "too-large"),
        ("DimSize = 2 3 2", "DimSize = 2 3 99999999999", "bad-size"),
        ("NDims = 3\nDimSize = 2 3 2", "NDims = 2\nDimSize = 4 3", "not-3d"),
        ("NDims = 3\nDimSize = 2 3 2", "NDims = 5\nDimSize = 2 3 2 1 1", "not-3d"),
        ("= Image", "= Mesh", "unsupported"),
        ("MET_UCHAR", "MET_STRING", "unsupported-type"),
        ("MET_UCHAR", "MET_UCHAR_ARRAY", "unsupported-type"),
        ("ElementSpacing = 1 1 1", "ElementSpacing = 1 0 1", "singular"),
        ("ElementSpacing = 1 1 1", "ElementSpacing = 1 inf 1", "not-finite"),
        ("ElementType = MET_UCHAR\n", "", "bad-header"),
        ("ElementDataFile = LOCAL\n", "", "bad-header"),
    ] {
        let file = String::from_utf8(mha(base, &bytes())).unwrap().replace(from, to);
        assert_eq!(refuse(file.as_bytes(), Format::MetaImage).code, code, "{to}");
    }
    assert_eq!(refuse(&mha(base, &bytes()[..11]), Format::MetaImage).code, "truncated");
    assert_eq!(refuse(&mha(base, &[0; 13]), Format::MetaImage).code, "trailing-bytes");
    let (_, warnings) = load(
        &mha(&format!("0008|0060 = CT\nElementToIntensityFunctionSlope = 2\n{base}"), &bytes()),
        Format::MetaImage,
    );
    assert_eq!((count(&warnings, "fields-ignored"), count(&warnings, "scaling-ignored")), (1, 1));
}
