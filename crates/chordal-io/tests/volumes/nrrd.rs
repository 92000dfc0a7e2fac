//! NRRD: encodings, where samples stand, spaces and units, one volume of several, and what is written.
use super::build::{nrrd, pack};
use super::{load, load_with, values};
use crate::common::{count, refuse};
use chordal::implicit::{Affine3, Grid, Samples};
use chordal_io::{Axis, Format, Frame, LabelLook, Limits, Volume, nrrd};
use chordal_testkit::Random;
use std::collections::BTreeMap;

const PLACED: &str = "space: left-posterior-superior\nspace directions: (-2,0,0) (0.5,3,0) (0,0.25,1.5)\n\
    space origin: (90,-126,-72)\nspace units: \"mm\" \"mm\" \"mm\"\ncontent: head\n";

#[test]
fn every_encoding_and_byte_order_says_the_same() {
    let numbers: Vec<f64> = (0..12).map(|i| f64::from(i) * 100.0 - 300.0).collect();
    let little: Vec<u8> = numbers.iter().flat_map(|x| (*x as i16).to_le_bytes()).collect();
    let big: Vec<u8> = numbers.iter().flat_map(|x| (*x as i16).to_be_bytes()).collect();
    let text = numbers.iter().map(|x| format!("{x}\n")).collect::<String>();
    let head = |rest: &str| format!("type: signed short\n{PLACED}{rest}");
    for file in [
        nrrd(&head("endian: little\nencoding: raw\n"), &little),
        nrrd(&head("endian: BIG\nencoding: raw\n"), &big),
        nrrd(&head("endian: big\nencoding: gzip\n"), &pack(&big)),
        nrrd(&head("endian: little\nencoding: gz\n"), &pack(&little)),
        nrrd(&head("encoding: ascii\n"), text.as_bytes()),
        nrrd(&head("endian: little\nencoding: raw\nbyte skip: 3\n"), &[&b"abc"[..], &little].concat()),
        nrrd(&head("endian: little\nencoding: raw\nbyte skip: -1\n"), &[&b"abcde"[..], &little].concat()),
        nrrd(&head("endian: little\nencoding: raw\nline skip: 2\n"), &[&b"a\nb\n"[..], &little].concat()),
        nrrd(&head("endian: little\nencoding: gzip\nbyteskip: 2\n"), &pack(&[&b"ab"[..], &little].concat())),
    ] {
        let (volume, warnings) = load(&file, Format::Nrrd);
        assert_eq!(Format::sniff(&file), Some(Format::Nrrd));
        assert_eq!(warnings, []);
        assert_eq!(values(&volume), numbers);
        assert_eq!(volume.grid.affine().steps(), [[-2.0, 0.0, 0.0], [0.5, 3.0, 0.0], [0.0, 0.25, 1.5]]);
        assert_eq!(volume.grid.affine().at([0.0; 3]), [90.0, -126.0, -72.0]);
        assert_eq!(volume.space.as_deref(), Some("LPS"));
        assert_eq!(
            volume.frame,
            Frame { up: Some(Axis::Z), metres_per_unit: Some(0.001), ..Frame::default() }
        );
        assert_eq!(volume.name, "head");
    }
}

#[test]
fn lines_may_end_as_in_windows() {
    let file =
        "NRRD0001\r\ntype: uchar\r\ndimension: 3\r\nsizes: 2 2 2\r\nspacings: 1 2 3\r\nencoding: raw\r\n\r\n";
    let (volume, _) = load(&[file.as_bytes(), &[0, 1, 2, 3, 4, 5, 6, 7]].concat(), Format::Nrrd);
    assert_eq!(volume.grid.affine().steps(), [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]]);
}

#[test]
fn spaces_are_kept_and_named() {
    let space = |name: &str| {
        let fields =
            format!("type: uint8\nencoding: raw\nspace: {name}\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n");
        load(&nrrd(&fields, &[0; 12]), Format::Nrrd)
    };
    for (long, short, is_left_handed) in [
        ("right-anterior-superior", "RAS", 0),
        ("LPS", "LPS", 0),
        ("left-anterior-superior", "LAS", 1),
        ("scanner-xyz", "scanner-xyz", 0),
        ("3D-left-handed", "3D-left-handed", 1),
    ] {
        let (volume, warnings) = space(long);
        assert_eq!(volume.space.as_deref(), Some(short));
        assert_eq!(volume.frame.up.is_some(), short.len() == 3);
        assert_eq!(count(&warnings, "left-handed"), is_left_handed);
    }
    let (volume, warnings) = load(&nrrd("type: uint8\nencoding: raw\n", &[0; 12]), Format::Nrrd);
    assert_eq!((volume.space, count(&warnings, "no-orientation")), (None, 1));
}

#[test]
fn an_axis_that_is_not_of_space_holds_several_volumes_wherever_it_stands() {
    // Two volumes of 2 x 3 x 2, the samples of the second 100 more.
    let value = |v: usize, i: usize| (100 * v + i) as u8;
    let slowest: Vec<u8> = (0..24).map(|n| value(n / 12, n % 12)).collect();
    let fastest: Vec<u8> = (0..24).map(|n| value(n % 2, n / 2)).collect();
    let middle: Vec<u8> = (0..24).map(|n| value(n / 6 % 2, n % 6 + 6 * (n / 12))).collect();
    let head = "NRRD0005\ntype: uchar\ndimension: 4\nencoding: raw\n";
    let (x, y, z) = ("(1,0,0)", "(0,1,0)", "(0,0,1)");
    for (sizes, directions, data) in [
        ("2 3 2 2", format!("{x} {y} {z} none"), slowest.clone()),
        ("2 2 3 2", format!("none {x} {y} {z}"), fastest.clone()),
        ("2 3 2 2", format!("{x} {y} none {z}"), middle),
    ] {
        let header = format!("{head}sizes: {sizes}\nspace: RAS\nspace directions: {directions}\n\n");
        let file = [header.as_bytes(), &data].concat();
        for index in 0..2_usize {
            let limits = Limits { index: Some(index as u64), ..Limits::default() };
            let (volume, _) = load_with(&file, Format::Nrrd, &limits);
            assert_eq!(volume.grid.size(), [2, 3, 2]);
            assert_eq!(values(&volume), (0..12).map(|i| f64::from(value(index, i))).collect::<Vec<_>>());
        }
    }
    let header = format!("{head}sizes: 2 2 3 2\nkinds: vector space space space\nspacings: nan 1 2 3\n\n");
    let limits = Limits { index: Some(1), ..Limits::default() };
    let (volume, _) = load_with(&[header.as_bytes(), &fastest].concat(), Format::Nrrd, &limits);
    assert_eq!(volume.grid.size(), [2, 3, 2]);
    assert_eq!(values(&volume)[0], 100.0);
    let header = format!("{}sizes: 2 3 2 2\n\n", head.replace("raw", "text"));
    let text: String = slowest.iter().map(|x| format!("{x} ")).collect();
    let (volume, _) = load_with(&[header.as_bytes(), text.as_bytes()].concat(), Format::Nrrd, &limits);
    assert_eq!(values(&volume)[11], 111.0);
}

#[test]
fn segments_name_and_colour_their_labels_and_are_written_again() {
    let header = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: text\n\
        Segment0_ID:=Segment_1\nSegment0_Name:=Left \\\\ lung\nSegment0_Color:=0.5 0.25 1\n\
        Segment0_LabelValue:=3\nSegment0_Layer:=0\nSegment1_LabelValue:=1\nSegment1_Layer:=1\n\
        Segment2_LabelValue:=-2\nSegment2_Color:=9 9 9\n\n0 3 3 0 1 1 2 0\n";
    let (volume, _) = load(header.as_bytes(), Format::Nrrd);
    let named = LabelLook { name: "Left \\ lung".into(), color: Some([0.5, 0.25, 1.0]) };
    let labels = BTreeMap::from([(3, named), (-2, LabelLook::default())]);
    assert_eq!(volume.labels, labels);
    let mut file = Vec::new();
    nrrd::write(&volume, None, &mut file).unwrap();
    assert_eq!(load(&file, Format::Nrrd).0.labels, labels);
}

#[test]
fn an_image_with_colours_is_no_volume_but_one_channel_of_it_is() {
    let head = "NRRD0004\ntype: uchar\nencoding: text\n";
    let colours = format!("{head}dimension: 4\nsizes: 3 2 2 2\nkinds: RGB-color domain domain domain\n\n");
    let text: String = (0..24).map(|x| format!("{x} ")).collect();
    let file = [colours.as_bytes(), text.as_bytes()].concat();
    assert_eq!(refuse(&file, Format::Nrrd).code, "colours");
    let limits = Limits { index: Some(1), ..Limits::default() };
    let (volume, _) = load_with(&file, Format::Nrrd, &limits);
    assert_eq!(values(&volume), (0..8).map(|i| f64::from(3 * i + 1)).collect::<Vec<_>>());
    let flat = format!("{head}dimension: 3\nsizes: 3 2 4\nkinds: RGB-color domain domain\n\n{text}");
    assert_eq!(refuse(flat.as_bytes(), Format::Nrrd).code, "colours");
}

#[test]
fn what_is_written_reads_back_to_the_last_bit() {
    let seed = 51;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    for round in 0..50 {
        let mut number = || (random.unit() - 0.5) * 10.0_f64.powi(round % 9 - 4);
        let rows: [[f64; 4]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| number()));
        let Ok(affine) = Affine3::new(rows) else { continue };
        let samples = match round % 4 {
            0 => Samples::F64((0..24).map(|_| number()).collect()),
            1 => Samples::F32((0..24).map(|_| number() as f32).collect()),
            2 => Samples::I8((0..24).map(|_| number() as i8).collect()),
            _ => Samples::U32((0..24).map(|i| i << 27).collect()),
        };
        let unit = [None, Some(0.001), Some(1.0), Some(1e-6)][round as usize / 2 % 4];
        let volume = Volume {
            frame: Frame {
                up: (round % 3 > 0).then_some(Axis::Z),
                metres_per_unit: unit,
                ..Frame::default()
            },
            name: "a b".to_owned(),
            space: (round % 3 > 0).then(|| ["RAS", "LPS"][round as usize % 3 - 1].to_owned()),
            certificate: Some(serde_json::json!({"a \\ b\n\"c\"": [1.5, "\\n"]})),
            ..Volume::from_grid(Grid::new([2, 3, 4], samples, affine).unwrap())
        };
        let mut bytes = Vec::new();
        nrrd::write(&volume, volume.certificate.as_ref(), &mut bytes).unwrap();
        let (back, warnings) = load(&bytes, Format::Nrrd);
        assert_eq!(back, volume);
        assert_eq!(warnings, []);
    }
}
