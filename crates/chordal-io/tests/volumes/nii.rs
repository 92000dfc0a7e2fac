//! NIfTI: both versions and byte orders, where samples stand, how they are scaled, and one volume of several.
use super::build::{Nii, pack};
use super::{load, load_with, values};
use crate::common::count;
use chordal::implicit::Samples;
use chordal_io::{Axis, Content, Format, LabelLook, Limits, read_with};
use std::collections::BTreeMap;

/// Sheared, and mirrored: the first axis runs to the left.
const SHEARED: [[f64; 4]; 3] = [[-2.0, 0.5, 0.0, 90.0], [0.0, 3.0, 0.25, -126.0], [0.0, 0.0, 1.5, -72.0]];

#[test]
fn both_versions_and_byte_orders_say_the_same_packed_or_not() {
    for version in [1, 2] {
        for is_big in [false, true] {
            let offset = if version == 1 { 352.0 } else { 544.0 };
            let nii = Nii { version, is_big, offset, rows: SHEARED, ..Nii::default() };
            for bytes in [nii.bytes(), nii.packed()] {
                assert_eq!(Format::sniff(&bytes), Some(Format::Nii));
                let (volume, warnings) = load(&bytes, Format::Nii);
                assert_eq!(warnings, []);
                assert_eq!(volume.grid.size(), [2, 3, 2]);
                assert_eq!(volume.grid.affine().rows(), SHEARED);
                assert_eq!(volume.grid.affine().orientation(), -1);
                assert_eq!(values(&volume), (0..12).map(f64::from).collect::<Vec<_>>());
                assert_eq!(volume.name, "brain");
                assert_eq!(volume.space.as_deref(), Some("RAS"));
                assert_eq!((volume.frame.up, volume.frame.metres_per_unit), (Some(Axis::Z), Some(0.001)));
            }
        }
    }
}

#[test]
fn an_extension_names_and_colours_labels() {
    let table = "<?xml version=\"1.0\" encoding=\"UTF-8\"?><CaretExtension><VolumeInformation Index=\"0\">\
        <LabelTable>\n<Label Key=\"1\" Red=\"0.5\" Green=\"0.25\" Blue=\"1\" Alpha=\"1\">\
        <![CDATA[left <lung> & co]]></Label>\n<Label Key=\"-3\" Red=\"9\" Green=\"0\" Blue=\"0\">heart</Label>\
        </LabelTable></VolumeInformation></CaretExtension>";
    let named = |name: &str, color| LabelLook { name: name.to_owned(), color };
    let expected =
        BTreeMap::from([(1, named("left <lung> & co", Some([0.5, 0.25, 1.0]))), (-3, named("heart", None))]);
    let broken = table.replace("</LabelTable>", "");
    for version in [1, 2] {
        for is_big in [false, true] {
            for (text, labels, warned) in [(table, &expected, 0), (&*broken, &BTreeMap::new(), 1)] {
                // Before it one of another kind; both fill up to a multiple of 16 bytes.
                let other = extension(6, b"a comment", is_big);
                let extensions =
                    [&[1, 0, 0, 0][..], &other, &extension(30, text.as_bytes(), is_big)].concat();
                let header = if version == 1 { 348 } else { 540 };
                let offset = (header + extensions.len()) as f64;
                let plain = Nii { version, is_big, offset, rows: SHEARED, ..Nii::default() };
                let mut file = plain.bytes();
                file.splice(header..header + 4, extensions.iter().copied());
                for bytes in [pack(&file), file] {
                    let (volume, warnings) = load(&bytes, Format::Nii);
                    assert_eq!(volume.labels, *labels);
                    assert_eq!(count(&warnings, "labels-skipped"), warned, "{warnings:?}");
                    assert_eq!(values(&volume), (0..12).map(f64::from).collect::<Vec<_>>());
                }
            }
        }
    }
}

/// An extension of a header.
fn extension(kind: i32, text: &[u8], is_big: bool) -> Vec<u8> {
    let size = (8 + text.len()).next_multiple_of(16);
    let number = |n: i32| if is_big { n.to_be_bytes() } else { n.to_le_bytes() };
    let mut bytes = [&number(size as i32)[..], &number(kind), text].concat();
    bytes.resize(size, 0);
    bytes
}

#[test]
fn samples_of_every_type_read() {
    let numbers = [0.0, 1.0, 2.0, 100.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0];
    macro_rules! check {
        ($t:ty, $code:literal, $kind:ident) => {
            for is_big in [false, true] {
                let bytes =
                    |x: &f64| if is_big { (*x as $t).to_be_bytes() } else { (*x as $t).to_le_bytes() };
                let data: Vec<u8> = numbers.iter().flat_map(bytes).collect();
                let bitpix = 8 * std::mem::size_of::<$t>() as i16;
                let nii = Nii { is_big, datatype: $code, bitpix, data, ..Nii::default() };
                let (volume, warnings) = load(&nii.packed(), Format::Nii);
                assert_eq!(values(&volume), numbers);
                assert_eq!(warnings, []);
                assert!(matches!(volume.grid.samples(), Samples::$kind(_)));
            }
        };
    }
    check!(u8, 2, U8);
    check!(i16, 4, I16);
    check!(i32, 8, I32);
    check!(f32, 16, F32);
    check!(f64, 64, F64);
    check!(i8, 256, I8);
    check!(u16, 512, U16);
    check!(u32, 768, U32);
    check!(i64, 1024, I32);
    check!(u64, 1280, I32);
}

#[test]
fn the_sform_goes_before_the_qform_and_that_before_steps() {
    // A quarter turn about z: x becomes y, y becomes −x; and the third axis turned round.
    let half = 0.5_f64.sqrt();
    let qform = Nii {
        sform: 0,
        qform: 1,
        quaternion: [0.0, 0.0, half, 10.0, 20.0, 30.0],
        pixdim: [-1.0, 2.0, 3.0, 4.0, 0.0, 0.0, 0.0, 0.0],
        rows: SHEARED,
        ..Nii::default()
    };
    let rows = load(&qform.bytes(), Format::Nii).0.grid.affine().rows();
    let expected = [[0.0, -3.0, 0.0, 10.0], [2.0, 0.0, 0.0, 20.0], [0.0, 0.0, -4.0, 30.0]];
    for (row, expected) in rows.as_flattened().iter().zip(expected.as_flattened()) {
        assert!((row - expected).abs() < 1e-6, "{rows:?}");
    }
    // Half a turn about x, whose a is 0; stored a little longer than 1.
    let turned = Nii { quaternion: [1.000_000_1, 0.0, 0.0, 0.0, 0.0, 0.0], ..qform.clone() };
    let rows = load(&turned.bytes(), Format::Nii).0.grid.affine().rows();
    let expected = [[2.0, 0.0, 0.0, 0.0], [0.0, -3.0, 0.0, 0.0], [0.0, 0.0, 4.0, 0.0]];
    for (row, expected) in rows.as_flattened().iter().zip(expected.as_flattened()) {
        assert!((row - expected).abs() < 1e-6, "{rows:?}");
    }
    let both = Nii { sform: 1, ..qform.clone() };
    assert_eq!(load(&both.bytes(), Format::Nii).0.grid.affine().rows(), SHEARED);
    let neither = Nii { qform: 0, ..qform };
    let (volume, warnings) = load(&neither.bytes(), Format::Nii);
    assert_eq!(volume.grid.affine().steps(), [[2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 4.0]]);
    assert_eq!(count(&warnings, "no-orientation"), 1);
}

#[test]
fn samples_are_scaled_unless_the_slope_is_0_or_the_scale_does_nothing() {
    for (slope, inter) in [(0.0, 5.0), (1.0, 0.0)] {
        let (volume, warnings) = load(&Nii { slope, inter, ..Nii::default() }.bytes(), Format::Nii);
        assert!(matches!(volume.grid.samples(), Samples::U8(_)));
        assert_eq!(warnings, []);
    }
    let (volume, _) = load(&Nii { slope: 2.0, inter: -1024.0, ..Nii::default() }.bytes(), Format::Nii);
    assert!(matches!(volume.grid.samples(), Samples::F32(_)), "exact in single precision");
    assert_eq!(values(&volume), (0..12).map(|x| 2.0 * f64::from(x) - 1024.0).collect::<Vec<_>>());
    let slope = 0.1_f32;
    let nii = Nii { slope: f64::from(slope), inter: 0.25, ..Nii::default() };
    let (volume, _) = load(&nii.bytes(), Format::Nii);
    assert!(matches!(volume.grid.samples(), Samples::F64(_)));
    assert_eq!(values(&volume), (0..12).map(|x| f64::from(slope) * f64::from(x) + 0.25).collect::<Vec<_>>());
    let (volume, warnings) = load(&Nii { slope: f64::NAN, ..Nii::default() }.bytes(), Format::Nii);
    assert_eq!(values(&volume)[11], 11.0);
    assert_eq!(count(&warnings, "scaling-ignored"), 1);
}

#[test]
fn units_become_metres() {
    for (units, metres) in
        [(1, Some(1.0)), (2, Some(0.001)), (3, Some(1e-6)), (2 | 8, Some(0.001)), (0, None)]
    {
        let (volume, warnings) = load(&Nii { units, ..Nii::default() }.bytes(), Format::Nii);
        assert_eq!(volume.frame.metres_per_unit, metres);
        assert_eq!(count(&warnings, "no-unit"), u64::from(metres.is_none()));
    }
}

#[test]
fn one_of_several_volumes_is_read_where_it_is_named() {
    let nii = Nii { dim: [4, 2, 2, 2, 3, 1, 1, 1], data: (0..24).collect(), ..Nii::default() };
    for bytes in [nii.bytes(), nii.packed()] {
        for index in 0..3 {
            let limits = Limits { index: Some(index), ..Limits::default() };
            let (volume, _) = load_with(&bytes, Format::Nii, &limits);
            let first = 8.0 * index as f64;
            assert_eq!(values(&volume), (0..8).map(|i| first + f64::from(i)).collect::<Vec<_>>());
        }
    }
    // One of one needs no name.
    let one = Nii { dim: [5, 2, 3, 2, 1, 1, 1, 1], ..Nii::default() };
    assert_eq!(load(&one.bytes(), Format::Nii).0.grid.size(), [2, 3, 2]);
    let limits = Limits { index: Some(0), ..Limits::default() };
    assert_eq!(load_with(&one.bytes(), Format::Nii, &limits).0.grid.size(), [2, 3, 2]);
}

#[test]
fn what_stands_between_header_and_samples_is_passed_over() {
    let data = [vec![99; 32], (0..12).collect()].concat();
    let nii = Nii { offset: 384.0, data, ..Nii::default() };
    for bytes in [nii.bytes(), nii.packed()] {
        assert_eq!(values(&load(&bytes, Format::Nii).0)[..3], [0.0, 1.0, 2.0]);
    }
}

#[test]
fn the_header_and_the_samples_of_a_pair_are_one_volume() {
    for version in [1, 2] {
        for (start, is_packed) in [(0.0, false), (0.0, true), (16.0, false)] {
            let size = if version == 1 { 352.0 } else { 544.0 };
            let whole = Nii { version, offset: size, rows: SHEARED, ..Nii::default() };
            let mut header = whole.bytes();
            if version == 1 {
                header[108..112].copy_from_slice(&(start as f32).to_le_bytes());
                header[344..348].copy_from_slice(b"ni1\0");
            } else {
                header[168..176].copy_from_slice(&(start as i64).to_le_bytes());
                header[4..7].copy_from_slice(b"ni2");
            }
            let samples = [&vec![9; start as usize][..], &whole.bytes()[size as usize..]].concat();
            header.truncate(if version == 1 { 348 } else { 540 });
            let (expected, _) = load(&whole.bytes(), Format::Nii);
            let mut asked = Vec::new();
            let mut open = |path: &str| {
                asked.push(path.to_owned());
                match (path, is_packed) {
                    ("*.img", false) => Ok(samples.clone()),
                    ("*.img.gz", true) => Ok(pack(&samples)),
                    _ => Err("no such file".to_owned()),
                }
            };
            let outcome = read_with(&header, Format::Nii, &mut open, &Limits::default()).unwrap();
            let Content::Volume(volume) = outcome.content else { panic!("no volume") };
            assert_eq!(volume, expected, "{version} {start} {is_packed}");
            assert_eq!(asked[0], "*.img");
        }
    }
}
