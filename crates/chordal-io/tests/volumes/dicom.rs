//! DICOM: slices by hand, in four ways to write them, as a series in a folder.
use super::dicom_build::{element, in_pieces, packed_frames, sequence, short, stream_of, text};
use super::values;
use crate::common::refuse;
use chordal_io::{Axis, Content, Format, Limits, ReadError, Volume, Warning, dicom, read_with};
use std::collections::BTreeMap;

#[derive(Clone)]
struct Slice {
    syntax: &'static str,
    series: &'static str,
    position: String,
    orientation: &'static str,
    spacing: &'static str,
    size: [u16; 2],
    bits: [u16; 4],
    scale: [&'static str; 2],
    channels: u16,
    frames: &'static str,
    pixels: Vec<u8>,
    /// The pixels as a packed picture, if they are one.
    packed: Option<Vec<u8>>,
}

impl Default for Slice {
    fn default() -> Self {
        Self {
            syntax: "1.2.840.10008.1.2.1",
            series: "1.2.3",
            position: "1\\2\\3".to_owned(),
            orientation: "1\\0\\0\\0\\1\\0",
            spacing: "2\\0.5",
            size: [2, 3],
            bits: [16, 16, 15, 1],
            scale: ["1", "0"],
            channels: 1,
            frames: "",
            pixels: Vec::new(),
            packed: None,
        }
    }
}

impl Slice {
    fn at(z: f64, first: i16) -> Self {
        let pixels = (first..first + 6).flat_map(i16::to_le_bytes).collect();
        Self { position: format!("1\\2\\{z}"), pixels, ..Self::default() }
    }

    fn bytes(&self) -> Vec<u8> {
        if self.syntax == DEFLATED {
            return deflated(&Self { syntax: "1.2.840.10008.1.2.1", ..self.clone() }.bytes());
        }
        let is_big = self.syntax == "1.2.840.10008.1.2.2";
        let is_explicit = self.syntax != "1.2.840.10008.1.2";
        let mut file = [&[0; 128][..], b"DICM"].concat();
        element(&mut file, [2, 0x10], b"UI", self.syntax.as_bytes(), [true, false]);
        let style = [is_explicit, is_big];
        let short = |n: u16| if is_big { n.to_be_bytes() } else { n.to_le_bytes() };
        element(&mut file, [8, 0x103E], b"LO", b"chest ", style);
        // A sequence of unknown length, with an item of unknown length and one of a known one.
        let tag = |group: u16, number: u16| [short(group), short(number)].concat();
        let long = |n: u32| if is_big { n.to_be_bytes() } else { n.to_le_bytes() };
        file.extend(tag(8, 0x1140));
        if is_explicit {
            file.extend(b"SQ\0\0");
        }
        file.extend(long(u32::MAX));
        file.extend([tag(0xFFFE, 0xE000), long(u32::MAX).to_vec()].concat());
        element(&mut file, [0x28, 0x10], b"US", &[9, 9], style);
        file.extend([tag(0xFFFE, 0xE00D), long(0).to_vec()].concat());
        file.extend([tag(0xFFFE, 0xE000), long(4).to_vec(), vec![7; 4]].concat());
        file.extend([tag(0xFFFE, 0xE0DD), long(0).to_vec()].concat());
        element(&mut file, [0x20, 0xE], b"UI", self.series.as_bytes(), style);
        element(&mut file, [0x20, 0x32], b"DS", self.position.as_bytes(), style);
        element(&mut file, [0x20, 0x37], b"DS", self.orientation.as_bytes(), style);
        element(&mut file, [0x28, 2], b"US", &short(self.channels), style);
        element(&mut file, [0x28, 8], b"IS", self.frames.as_bytes(), style);
        element(&mut file, [0x28, 0x10], b"US", &short(self.size[0]), style);
        element(&mut file, [0x28, 0x11], b"US", &short(self.size[1]), style);
        element(&mut file, [0x28, 0x30], b"DS", self.spacing.as_bytes(), style);
        for (number, value) in [0x100, 0x101, 0x102, 0x103].into_iter().zip(self.bits) {
            element(&mut file, [0x28, number], b"US", &short(value), style);
        }
        element(&mut file, [0x28, 0x1052], b"DS", self.scale[1].as_bytes(), style);
        element(&mut file, [0x28, 0x1053], b"DS", self.scale[0].as_bytes(), style);
        if let Some(packed) = &self.packed {
            file.extend(in_pieces(&[], std::slice::from_ref(packed)));
            return file;
        }
        if self.syntax == RUN_LENGTHS {
            file.extend(run_lengths(&self.pixels, usize::from(self.bits[0] / 8)));
            return file;
        }
        let mut pixels = self.pixels.clone();
        if is_big && self.bits[0] == 16 {
            pixels.chunks_exact_mut(2).for_each(<[u8]>::reverse);
        }
        element(&mut file, [0x7FE0, 0x10], b"OW", &pixels, style);
        file
    }
}

const RUN_LENGTHS: &str = "1.2.840.10008.1.2.5";
const DEFLATED: &str = "1.2.840.10008.1.2.1.99";

/// The same file with its data set deflated.
fn deflated(plain: &[u8]) -> Vec<u8> {
    let mut file = [&[0; 128][..], b"DICM"].concat();
    element(&mut file, [2, 0x10], b"UI", DEFLATED.as_bytes(), [true, false]);
    // The element of the plain file's transfer syntax, which has 20 bytes.
    let mut encoder = flate2::write::DeflateEncoder::new(file, flate2::Compression::fast());
    std::io::Write::write_all(&mut encoder, &plain[132 + 28..]).expect("packed");
    encoder.finish().expect("packed")
}

/// Little-endian samples as an element of run lengths: an empty table of frames, then planes of bytes, the highest
/// first, each with two runs of what is alike and copies of the rest.
fn run_lengths(pixels: &[u8], width: usize) -> Vec<u8> {
    let mut planes: Vec<Vec<u8>> = Vec::new();
    for plane in (0..width).rev() {
        let bytes: Vec<u8> = pixels.iter().skip(plane).step_by(width).copied().collect();
        let mut packed = Vec::new();
        for group in bytes.chunk_by(|a, b| a == b) {
            if group.len() > 1 {
                packed.extend([(257 - group.len()) as u8, group[0]]);
            } else {
                packed.extend([0, group[0]]);
            }
        }
        // Nothing, which fills up to an even length.
        packed.extend([128, 128].iter().take(1 + packed.len() % 2));
        planes.push(packed);
    }
    let mut offset = 64;
    let mut picture = (width as u32).to_le_bytes().to_vec();
    for k in 0..15 {
        let at = if k < width { offset } else { 0 };
        picture.extend((at as u32).to_le_bytes());
        offset += planes.get(k).map_or(0, Vec::len);
    }
    picture.extend(planes.concat());
    in_pieces(&[], &[picture])
}

pub type Files = BTreeMap<String, Vec<u8>>;

fn folder(slices: &[Slice]) -> Files {
    slices.iter().enumerate().map(|(i, slice)| (format!("{i}.dcm"), slice.bytes())).collect()
}

pub fn load_with(files: &Files, limits: &Limits) -> Result<(Volume, Vec<Warning>), ReadError> {
    let list = dicom::slice_list(files.keys().map(String::as_str));
    assert_eq!(Format::sniff(&list), Some(Format::Dicom));
    let mut open = |path: &str| files.get(path).cloned().ok_or("no such file".to_owned());
    let outcome = read_with(&list, Format::Dicom, &mut open, limits)?;
    let Content::Volume(volume) = outcome.content else { panic!("no volume") };
    Ok((volume, outcome.warnings))
}

fn load(slices: &[Slice]) -> Result<(Volume, Vec<Warning>), ReadError> {
    load_with(&folder(slices), &Limits::default())
}

#[test]
fn run_lengths_hold_the_same_samples_and_a_cut_or_wrong_one_is_refused() {
    for width in [1_u16, 2, 4] {
        let slice = |z: f64| {
            let values: Vec<i64> = vec![0, 0, 0, -1, 77, 77];
            let pixels = values.iter().flat_map(|x| x.to_le_bytes()[..usize::from(width)].to_vec()).collect();
            let bits = [8 * width, 8 * width, 8 * width - 1, 1];
            Slice { bits, pixels, position: format!("1\\2\\{z}"), ..Slice::default() }
        };
        let plain = [slice(0.0), slice(1.0)];
        let packed = plain.clone().map(|slice| Slice { syntax: RUN_LENGTHS, ..slice });
        let expected = load(&plain).unwrap().0;
        assert_eq!(values(&expected)[..6], [0.0, 0.0, 0.0, -1.0, 77.0, 77.0]);
        assert_eq!(load(&packed).unwrap().0, expected, "{width} bytes");
        let larger = packed.clone().map(|slice| Slice { size: [3, 3], ..slice });
        assert_eq!(load(&larger).unwrap_err().code, "size-mismatch");
        let mut files = folder(&packed);
        let whole = files["0.dcm"].clone();
        for end in 200..whole.len() {
            files.insert("0.dcm".to_owned(), whole[..end].to_vec());
            assert!(load_with(&files, &Limits::default()).is_err(), "cut at {end}");
        }
    }
}

#[test]
fn slices_are_sorted_and_placed_in_the_patient() {
    for syntax in ["1.2.840.10008.1.2", "1.2.840.10008.1.2.1", "1.2.840.10008.1.2.2", DEFLATED] {
        let slices = [Slice::at(8.0, 6), Slice::at(3.0, -2), Slice::at(13.0, 20)];
        let slices = slices.map(|slice| Slice { syntax, ..slice });
        let (volume, warnings) = load(&slices).unwrap();
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!(volume.grid.size(), [3, 2, 3]);
        let expected: Vec<f64> =
            [-2, 6, 20].into_iter().flat_map(|first| first..first + 6).map(f64::from).collect();
        assert_eq!(values(&volume), expected);
        let rows = [[0.5, 0.0, 0.0, 1.0], [0.0, 2.0, 0.0, 2.0], [0.0, 0.0, 5.0, 3.0]];
        assert_eq!(volume.grid.affine().rows(), rows);
        assert_eq!((volume.name.as_str(), volume.space.as_deref()), ("chest", Some("LPS")));
        assert_eq!((volume.frame.up, volume.frame.metres_per_unit), (Some(Axis::Z), Some(0.001)));
    }
}

#[test]
fn numbers_are_scaled_and_bits_beside_them_left_out() {
    let scaled = |slope, z| Slice { scale: [slope, "-1024"], ..Slice::at(z, 0) };
    let (volume, _) = load(&[scaled("2", 0.0), scaled("2", 1.0)]).unwrap();
    assert_eq!(values(&volume)[..3], [-1024.0, -1022.0, -1020.0]);
    let (volume, _) = load(&[scaled("2", 0.0), scaled("0.5", 1.0)]).unwrap();
    assert_eq!((values(&volume)[1], values(&volume)[7]), (-1022.0, -1023.5));
    // Twelve bits with a sign, below four that are something else.
    let dirty = |z: f64| {
        let pixels = [0xF001_u16, 0x5FFF, 0x0800, 0x1000, 0x27FF, 0].map(u16::to_le_bytes).concat();
        Slice { bits: [16, 12, 11, 1], pixels, ..Slice::at(z, 0) }
    };
    let (volume, _) = load(&[dirty(0.0), dirty(1.0)]).unwrap();
    assert_eq!(values(&volume)[..6], [1.0, -1.0, -2048.0, 0.0, 2047.0, 0.0]);
    let bytes = |z: f64| Slice { bits: [8, 8, 7, 0], pixels: vec![0, 1, 2, 3, 4, 255], ..Slice::at(z, 0) };
    let (volume, _) = load(&[bytes(0.0), bytes(1.0)]).unwrap();
    assert_eq!(values(&volume)[..6], [0.0, 1.0, 2.0, 3.0, 4.0, 255.0]);
}

#[test]
fn bytes_in_big_endian_words_are_put_in_order() {
    let slice = |z: f64| Slice {
        syntax: "1.2.840.10008.1.2.2",
        bits: [8, 8, 7, 0],
        pixels: vec![1, 0, 3, 2, 5, 4],
        ..Slice::at(z, 0)
    };
    let (volume, _) = load(&[slice(0.0), slice(1.0)]).unwrap();
    assert_eq!(values(&volume)[..6], [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
}

/// The files of two slices, each with `more` before its pixels.
fn with_element(more: &[u8]) -> Files {
    let mut files = folder(&[Slice::at(0.0, 0), Slice::at(1.0, 6)]);
    for bytes in files.values_mut() {
        let at = bytes.windows(4).position(|four| four == [0xE0, 0x7F, 0x10, 0]).expect("pixels");
        bytes.splice(at..at, more.iter().copied());
    }
    files
}

#[test]
fn numbers_from_a_table_are_refused_and_those_of_a_palette_told() {
    let table = |items: &[Vec<u8>]| sequence([0x28, 0x3000], items, true);
    let files = with_element(&table(&[short([0x28, 0x3002], 6)]));
    let error = load_with(&files, &Limits::default()).unwrap_err();
    assert_eq!(error.code, "unsupported");
    assert!(error.message.contains("0.dcm: ") && error.message.contains("ModalityLUTSequence"), "{error}");
    assert!(load_with(&with_element(&table(&[])), &Limits::default()).is_ok());
    let palette = with_element(&text([0x28, 4], b"CS", "PALETTE COLOR"));
    let (_, warnings) = load_with(&palette, &Limits::default()).unwrap();
    assert_eq!((warnings.len(), warnings[0].code, warnings[0].count), (1, "palette-numbers", 2));
}

#[test]
fn sequences_of_unknown_type_have_items_without_types() {
    let plain = load_with(&with_element(&[]), &Limits::default()).unwrap().0;
    // A comment of eight letters, whose length has no place for a type.
    let comment = b"\x10\0\0\x40\x08\0\0\0abcdefgh";
    let inner = sequence([0x29, 0x1010], &[comment.to_vec()], false);
    // Without its type: the tag and the length.
    let inner = [&inner[..4], &inner[8..]].concat();
    let mut outer = sequence([0x19, 0x1010], &[[&comment[..], &inner].concat()], false);
    outer[4..6].copy_from_slice(b"UN");
    assert_eq!(load_with(&with_element(&outer), &Limits::default()).unwrap().0, plain);
    let around = sequence([0x19, 0x1011], &[outer], false);
    assert_eq!(load_with(&with_element(&around), &Limits::default()).unwrap().0, plain);
}

#[test]
fn files_of_other_series_that_are_no_part_of_a_volume_are_counted() {
    let picture = Slice { series: "1.2.9", channels: 3, ..Slice::at(0.0, 0) };
    let bare = Slice { series: "1.2.8", position: String::new(), ..Slice::at(0.0, 0) };
    let slices = [Slice::at(0.0, 0), picture.clone(), Slice::at(1.0, 0), bare];
    let (volume, warnings) = load(&slices).unwrap();
    assert_eq!(volume.grid.size(), [3, 2, 2]);
    assert_eq!((warnings.len(), warnings[0].code, warnings[0].count), (1, "files-refused", 2));
    assert!(warnings[0].message.contains("1.dcm: 3 samples a pixel"), "{:?}", warnings[0].message);
    let error = load(&[picture]).unwrap_err();
    assert_eq!((error.code, &error.message[..6]), ("several-channels", "0.dcm:"));
}

#[test]
fn slices_that_are_no_lattice_are_refused_by_name() {
    let even = |n: i16| (0..n).map(|k| Slice::at(f64::from(k), 0)).collect::<Vec<_>>();
    let with = |change: &dyn Fn(&mut Vec<Slice>)| {
        let mut slices = even(5);
        change(&mut slices);
        let error = load(&slices).unwrap_err();
        (error.code, error.message.split(':').next().unwrap().to_owned())
    };
    let is = |code, file: &str| (code, file.to_owned());
    assert_eq!(with(&|s| drop(s.remove(2))), is("missing-slice", "2.dcm"));
    assert_eq!(with(&|s| s[2] = Slice::at(1.0, 0)), is("same-place", "2.dcm"));
    assert_eq!(with(&|s| s[2] = Slice::at(2.2, 0)), is("uneven-slices", "2.dcm"));
    assert_eq!(with(&|s| s[3].orientation = "1\\0\\0\\0\\0\\1"), is("slices-differ", "3.dcm"));
    assert_eq!(with(&|s| s[3].spacing = "2\\2"), is("slices-differ", "3.dcm"));
    assert_eq!(with(&|s| s[3].size = [3, 2]), is("slices-differ", "3.dcm"));
    assert_eq!(with(&|s| s[3].bits[3] = 0), is("slices-differ", "3.dcm"));
    assert_eq!(with(&|s| s[3].pixels.truncate(10)), is("size-mismatch", "3.dcm"));
    assert_eq!(with(&|s| s[3].pixels.extend([0; 4])), is("size-mismatch", "3.dcm"));
    assert_eq!(with(&|s| s[3].position = "1\\2".to_owned()), is("not-a-number", "3.dcm"));
    assert_eq!(with(&|s| s[3].position = "1\\2\\nan".to_owned()), is("not-finite", "3.dcm"));
    assert_eq!(with(&|s| s[3].position = "1\\2\\3\\4".to_owned()), is("bad-header", "3.dcm"));
    assert_eq!(with(&|s| s[3].position.clear()), is("missing-attribute", "3.dcm"));
    assert_eq!(with(&|s| s[3].channels = 3), is("several-channels", "3.dcm"));
    assert_eq!(with(&|s| s[3].frames = "7"), is("unsupported", "3.dcm"));
    assert_eq!(with(&|s| s[3].bits = [12, 12, 11, 0]), is("unsupported", "3.dcm"));
    assert_eq!(with(&|s| s[3].bits = [16, 12, 3, 0]), is("bad-header", "3.dcm"));
    assert_eq!(with(&|s| s[3].bits = [16, 0, 3, 0]), is("bad-header", "3.dcm"));
    assert_eq!(with(&|s| s[3].syntax = "1.2.840.10008.1.2.4.90"), is("unsupported", "3.dcm"));
    assert_eq!(with(&|s| s[3].syntax = "1.2.840.10008.1.2.4.201"), is("packed-pixels", "3.dcm"));
    assert_eq!(with(&|s| s[3].syntax = "1.2.840.10008.1.2.4.999"), is("unsupported", "3.dcm"));
    assert_eq!(with(&|s| s.iter_mut().for_each(|s| s.orientation = "1\\0\\0\\1\\0\\0")).0, "same-place");
    for orientation in ["2\\0\\0\\0\\1\\0", "1\\0\\0\\0.6\\0.8\\0"] {
        let all = |s: &mut Vec<Slice>| s.iter_mut().for_each(|s| s.orientation = orientation);
        assert_eq!(with(&all), is("bad-header", "0.dcm"));
    }
    assert_eq!(with(&|s| s.iter_mut().for_each(|s| s.spacing = "-2\\0.5")), is("bad-header", "0.dcm"));
    assert_eq!(with(&|s| s.truncate(1)), is("flat-volume", "0.dcm"));
    let mut tilted = even(3);
    (0..3).for_each(|k| tilted[k].position = format!("1\\{}\\{k}", 0.25 * k as f64));
    let (volume, _) = load(&tilted).unwrap();
    assert_eq!(volume.grid.affine().steps()[2], [0.0, 0.25, 1.0]);
}

#[test]
fn one_series_of_several_is_chosen_and_other_files_are_counted() {
    let other = |z| Slice { series: "1.2.4", ..Slice::at(z, 50) };
    let mut files = folder(&[Slice::at(0.0, 0), other(0.0), Slice::at(1.0, 0), other(1.0)]);
    files.insert(
        "DICOMDIR".to_owned(),
        [&[0; 128][..], b"DICM", &Slice::default().bytes()[132..160]].concat(),
    );
    files.insert("notes.txt".to_owned(), b"notes".to_vec());
    let error = load_with(&files, &Limits::default()).unwrap_err();
    assert_eq!(error.code, "several-volumes");
    assert!(error.message.contains("0: 'chest' with 2 slices, 1: 'chest' with 2 slices: 'index'"), "{error}");
    let (volume, warnings) = load_with(&files, &Limits { index: Some(1), ..Limits::default() }).unwrap();
    assert_eq!((values(&volume)[0], warnings[0].count), (50.0, 2));
    let error = load_with(&files, &Limits { index: Some(2), ..Limits::default() }).unwrap_err();
    assert_eq!(error.code, "no-such-volume");
    assert_eq!(load(&[]).unwrap_err().code, "no-slices");
}

#[test]
fn files_that_are_cut_or_changed_end_well() {
    let good = Slice::at(0.0, 0).bytes();
    assert_eq!(Format::sniff(&good), Some(Format::Dicom));
    assert_eq!(refuse(&good, Format::Dicom).code, "flat-volume");
    assert_eq!(refuse(b"no mark", Format::Dicom).code, "bad-magic");
    let mut files = folder(&[Slice::at(0.0, 0), Slice::at(1.0, 0)]);
    for end in 0..good.len() {
        files.insert("0.dcm".to_owned(), good[..end].to_vec());
        assert!(load_with(&files, &Limits::default()).is_err(), "{end}");
    }
    for at in 128..good.len() {
        for value in [0, 1, 0x7F, 0xFF] {
            let mut changed = good.clone();
            changed[at] = value;
            files.insert("0.dcm".to_owned(), changed);
            let _ = load_with(&files, &Limits::default());
        }
    }
    let list = dicom::slice_list(["../a.dcm"]);
    let mut open = |_: &str| -> Result<Vec<u8>, String> { panic!("asked") };
    let error = read_with(&list, Format::Dicom, &mut open, &Limits::default()).unwrap_err();
    assert_eq!(error.code, "outside-folder");
    assert_eq!(refuse(&dicom::slice_list(["a.dcm"]), Format::Dicom).code, "detached");
    assert_eq!(dicom::slice_list(["a", "b\nc"]), dicom::slice_list(["a"]));
    // Sequences in sequences, without end.
    let deep = [
        &good[..132],
        &b"\x08\x00\x40\x11SQ\0\0\xFF\xFF\xFF\xFF\xFE\xFF\x00\xE0\xFF\xFF\xFF\xFF".repeat(5000),
    ];
    files.insert("0.dcm".to_owned(), deep.concat());
    assert!(load_with(&files, &Limits::default()).is_err());
}

fn packed_slice(frame: &serde_json::Value, z: f64) -> Slice {
    let bits = frame["bits"].as_u64().expect("bits") as u16;
    let syntax: &'static str = frame["syntax"].as_str().expect("a syntax").to_owned().leak();
    let allocated = if bits > 8 { 16 } else { 8 };
    let is_signed = u16::from(frame["signed"] == true);
    Slice {
        syntax,
        size: [5, 8],
        bits: [allocated, bits, bits - 1, is_signed],
        packed: Some(stream_of(frame)),
        position: format!("1\\2\\{z}"),
        ..Slice::default()
    }
}

#[test]
fn packed_slices_hold_the_samples_that_other_programs_unpack() {
    for frame in packed_frames() {
        let slices = [packed_slice(&frame, 0.0), packed_slice(&frame, 1.0)];
        let (volume, warnings) = load(&slices).unwrap_or_else(|error| panic!("{}: {error}", frame["name"]));
        assert!(warnings.is_empty(), "{}: {warnings:?}", frame["name"]);
        let within = frame["within"].as_f64().unwrap();
        let expected: Vec<f64> =
            frame["samples"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        assert_eq!(volume.grid.size(), [8, 5, 2]);
        for (k, value) in values(&volume).into_iter().enumerate() {
            let off = (value - expected[k % 40]).abs();
            assert!(off <= within, "{}: sample {k} is {value}, not {}", frame["name"], expected[k % 40]);
        }
    }
}

#[test]
fn packed_slices_of_fewer_bits_than_stated_have_no_unclear_sign() {
    let names =
        ["lossless JPEG of 12 bits", "extended JPEG of 12 bits", "JPEG-LS of 8 bits", "JPEG 2000 of 12 bits"];
    for frame in packed_frames().iter().filter(|frame| names.contains(&frame["name"].as_str().unwrap())) {
        let with = |is_signed: u16| {
            load(&[0.0, 1.0].map(|z| Slice { bits: [16, 16, 15, is_signed], ..packed_slice(frame, z) }))
        };
        assert_eq!(
            values(&with(0).unwrap().0),
            values(&load(&[0.0, 1.0].map(|z| packed_slice(frame, z))).unwrap().0)
        );
        let error = with(1).unwrap_err();
        assert_eq!(error.code, "size-mismatch");
        assert!(error.message.contains(" bits, and the file states 16 with a sign"), "{error}");
    }
}

#[test]
fn packed_slices_that_are_cut_or_changed_end_well() {
    for frame in packed_frames() {
        let good = packed_slice(&frame, 1.0);
        let stream = stream_of(&frame);
        let with = |packed: Vec<u8>| {
            load(&[packed_slice(&frame, 0.0), Slice { packed: Some(packed), ..good.clone() }])
        };
        // The marker of the end may be missing, and padding may take the place of the last byte before it.
        for end in 0..stream.len() - 8 {
            let error = with(stream[..end].to_vec()).unwrap_err();
            assert_eq!(
                (error.code, &error.message[..6]),
                ("bad-packing", "1.dcm:"),
                "{} cut at {end}",
                frame["name"]
            );
        }
        for at in 0..stream.len() {
            for value in [0, 1, 0x7F, 0xFF] {
                let mut changed = stream.clone();
                changed[at] = value;
                let _ = with(changed);
            }
        }
        let larger = load(&[0.0, 1.0].map(|z| Slice { size: [6, 8], ..packed_slice(&frame, z) }));
        assert_eq!(larger.unwrap_err().code, "bad-packing");
        let huge = load(&[0.0, 1.0].map(|z| Slice { size: [4097, 4096], ..packed_slice(&frame, z) }));
        assert_eq!(huge.unwrap_err().code, "too-dense");
    }
}

#[test]
fn codestreams_may_lack_the_length_of_a_part_and_the_end() {
    for frame in packed_frames().iter().filter(|frame| frame["name"].as_str().unwrap().contains("JPEG 2000"))
    {
        let stream = stream_of(frame);
        let slices = |packed: &[u8]| {
            [0.0, 1.0].map(|z| Slice { packed: Some(packed.to_vec()), ..packed_slice(frame, z) })
        };
        let whole = load(&slices(&stream)).unwrap().0;
        let end = stream.iter().rposition(|byte| *byte == 0xD9).unwrap() - 1;
        assert_eq!(load(&slices(&stream[..end])).unwrap().0, whole);
        let at = stream.windows(4).position(|four| four == [0xFF, 0x90, 0, 10]).unwrap();
        let mut open = stream.clone();
        open[at + 6..at + 10].fill(0);
        assert_eq!(load(&slices(&open)).unwrap().0, whole);
        assert_eq!(load(&slices(&open[..end])).unwrap_err().code, "bad-packing");
        assert_eq!(load(&slices(&open[..end - 9])).unwrap_err().code, "bad-packing");
    }
}

/// A codestream of JPEG 2000 with empty packets: the sizes of the picture and of a tile, the sampling, the style,
/// the number of step sizes, and the style in the header of the tile.
fn codestream(sizes: [u32; 4], sampling: u8, styles: [&[u8]; 2], n_steps: usize) -> Vec<u8> {
    let segment = |marker: u8, content: &[u8]| {
        [&[0xFF, marker][..], &(content.len() as u16 + 2).to_be_bytes(), content].concat()
    };
    let [width, height, tile_width, tile_height] = sizes;
    let grid = [width, height, 0, 0, tile_width, tile_height, 0, 0].map(u32::to_be_bytes).concat();
    let size = [&[0, 0][..], &grid, &[0, 1, 11, sampling, sampling]].concat();
    let inside = if styles[1].is_empty() { Vec::new() } else { segment(0x52, styles[1]) };
    let part = [&inside[..], &[0xFF, 0x93], &[0; 8]].concat();
    let head = [&[0, 0][..], &(part.len() as u32 + 12).to_be_bytes(), &[0, 1]].concat();
    let steps = [vec![0x40], vec![0x60; n_steps]].concat();
    let start = [&[0xFF, 0x4F][..], &segment(0x51, &size), &segment(0x52, styles[0]), &segment(0x5C, &steps)];
    [&start.concat()[..], &segment(0x90, &head), &part, &[0xFF, 0xD9]].concat()
}

#[test]
fn small_codestreams_that_would_take_much_memory_are_refused() {
    // One layer and 32 of them, blocks of 64 by 64, precincts of one sample, and blocks of 4 by 4.
    let plain: &[u8] = &[0, 0, 0, 1, 0, 0, 4, 4, 0, 1];
    let precincts: &[u8] = &[1, 0, 0, 32, 0, 0, 4, 4, 0, 1, 0];
    let blocks: &[u8] = &[0, 0, 0, 32, 0, 0, 0, 0, 0, 1];
    let whole = [2048; 4];
    for (size, packed, word) in [
        ([256, 256], codestream([65_280, 65_280, 1, 1], 255, [plain, &[]], 1), "tiles"),
        ([2048, 2048], codestream([2048, 2048, 1, 1], 1, [plain, &[]], 1), "tiles"),
        ([2048, 2048], codestream(whole, 1, [precincts, &[]], 1), "packets"),
        ([2048, 2048], codestream(whole, 1, [plain, precincts], 1), "packets"),
        ([2048, 2048], codestream(whole, 1, [blocks, &[]], 1), "blocks"),
        ([255, 255], codestream([255, 255, 1, 1], 1, [plain, &[]], 60_000), "damaged headers"),
    ] {
        let slice = |z: f64| Slice {
            syntax: "1.2.840.10008.1.2.4.90",
            size,
            bits: [16, 12, 11, 0],
            packed: Some(packed.clone()),
            ..Slice::at(z, 0)
        };
        let error = load(&[slice(0.0), slice(1.0)]).unwrap_err();
        assert_eq!(error.code, "bad-packing", "{error}");
        assert!(error.message.contains(word), "{error}");
    }
}

#[test]
fn a_packing_that_is_not_read_is_named_with_what_to_do() {
    for (syntax, name) in
        [("4.201", "high-throughput JPEG 2000"), ("4.110", "JPEG XL"), ("4.102", "MPEG-4 video")]
    {
        let syntax: &'static str = format!("1.2.840.10008.1.2.{syntax}").leak();
        let slice = |z| Slice { syntax, packed: Some(vec![0; 8]), ..Slice::at(z, 0) };
        let error = load(&[slice(0.0), slice(1.0)]).unwrap_err();
        assert_eq!(error.code, "packed-pixels");
        for words in [name, syntax, "save the series uncompressed", "gdcmconv"] {
            assert!(error.message.contains(words), "{error}");
        }
    }
}
