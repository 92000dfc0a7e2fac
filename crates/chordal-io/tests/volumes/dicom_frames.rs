//! DICOM: files with many frames, as enhanced CT and MR and segmentations write them.
use super::dicom::{Files, load_with};
use super::dicom_build::{
    Frames, element, in_pieces, masks, packed_frames, place, scale, sequence, stack, stream_of, text,
};
use super::{load, values};
use crate::common::refuse;
use chordal_io::{Format, Limits, Volume, Warning};

impl Frames {
    #[track_caller]
    fn load(&self) -> (Volume, Vec<Warning>) {
        load(&self.bytes(), Format::Dicom)
    }

    #[track_caller]
    fn refused(&self) -> (&'static str, String) {
        let error = refuse(&self.bytes(), Format::Dicom);
        (error.code, error.message.to_string())
    }
}

#[test]
fn frames_are_placed_by_their_groups_in_a_file_or_in_a_folder() {
    for is_defined in [true, false] {
        let frames = Frames { is_defined, ..Frames::at(&[8.0, 3.0, 13.0]) };
        let (volume, warnings) = frames.load();
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!(volume.grid.size(), [3, 2, 3]);
        let expected: Vec<f64> = (6..12).chain(0..6).chain(12..18).map(f64::from).collect();
        assert_eq!(values(&volume), expected);
        let rows = [[0.5, 0.0, 0.0, 1.0], [0.0, 2.0, 0.0, 2.0], [0.0, 0.0, 5.0, 3.0]];
        assert_eq!(volume.grid.affine().rows(), rows);
        assert_eq!((volume.name.as_str(), volume.space.as_deref()), ("knee", Some("LPS")));
        let files: Files = [("a.dcm".to_owned(), frames.bytes())].into();
        assert_eq!(load_with(&files, &Limits::default()).unwrap().0, volume);
    }
}

#[test]
fn the_scale_is_that_of_the_frame_or_else_of_all() {
    let mut frames = Frames::at(&[0.0, 1.0]);
    frames.shared.push(scale("2", "-1"));
    assert_eq!(values(&frames.load().0)[..3], [-1.0, 1.0, 3.0]);
    frames.groups[1].push(scale("0.5", "7"));
    let (volume, _) = frames.load();
    assert_eq!((values(&volume)[1], values(&volume)[7]), (1.0, 10.5));
}

#[test]
fn groups_of_unknown_type_have_elements_without_types() {
    let mut frames = Frames::at(&[0.0, 1.0]);
    let scale = b"\x28\0\x52\x10\x02\0\0\0-1\x28\0\x53\x10\x02\0\0\x002 ".to_vec();
    for is_defined in [true, false] {
        let mut group = sequence([0x28, 0x9145], std::slice::from_ref(&scale), is_defined);
        group[4..6].copy_from_slice(b"UN");
        frames.groups[0].truncate(1);
        frames.groups[0].push(group);
        assert_eq!(values(&frames.load().0)[..3], [-1.0, 1.0, 3.0]);
    }
}

#[test]
fn fractions_of_a_segment_are_from_0_to_1() {
    let mut frames = Frames { bits: [8, 8, 7, 0], ..Frames::at(&[0.0, 1.0]) };
    let mut largest = Vec::new();
    element(&mut largest, [0x62, 0xE], b"US", &4_u16.to_le_bytes(), [true, false]);
    frames.segments = [text([0x62, 1], b"CS", "FRACTIONAL"), largest].concat();
    frames.pixels.clear();
    element(&mut frames.pixels, [0x7FE0, 0x10], b"OW", &[0, 1, 2, 3, 4, 0, 4, 0, 0, 0, 0, 0], [true, false]);
    assert_eq!(values(&frames.load().0)[..7], [0.0, 0.25, 0.5, 0.75, 1.0, 0.0, 1.0]);
}

#[test]
fn stacks_and_times_are_volumes_of_their_own() {
    let mut frames = Frames::at(&[0.0, 1.0, 0.0, 1.0]);
    for (k, group) in frames.groups.iter_mut().enumerate() {
        group.push(stack("A", 1 + k as u32 / 2));
    }
    let error = refuse(&frames.bytes(), Format::Dicom);
    assert_eq!(error.code, "several-volumes");
    assert!(error.message.contains("1: 'knee', stack 'A', time 2 with 2 slices"), "{error}");
    let limits = Limits { index: Some(1), ..Limits::default() };
    let (volume, _) = super::load_with(&frames.bytes(), Format::Dicom, &limits);
    assert_eq!(values(&volume)[0], 12.0);
}

#[test]
fn frames_may_be_packed_each_in_a_piece_or_in_pieces_by_a_table() {
    for frame in packed_frames().iter().filter(|frame| frame["signed"] == false && frame["bits"] == 12) {
        let stream = stream_of(frame);
        let (a, b) = stream.split_at(stream.len() / 4 * 2);
        let whole = [stream.clone(), stream.clone()];
        let halves = [a, b, a, b].map(<[u8]>::to_vec);
        // Two heads of 8 bytes, and padding.
        let second = (16 + stream.len() + stream.len() % 2) as u32;
        let packed = |pixels: Vec<u8>| Frames {
            syntax: frame["syntax"].as_str().unwrap().to_owned(),
            size: [5, 8],
            bits: [16, 12, 11, 0],
            pixels,
            ..Frames::at(&[0.0, 1.0])
        };
        let (volume, _) = packed(in_pieces(&[], &whole)).load();
        assert_eq!(packed(in_pieces(&[0, second], &halves)).load().0, volume, "{}", frame["name"]);
        let mut long = Vec::new();
        let offsets = [0_u64, u64::from(second)].map(u64::to_le_bytes).concat();
        long.extend(
            [&0x7FE0_u16.to_le_bytes()[..], &1_u16.to_le_bytes(), b"OV\0\0", &16_u32.to_le_bytes()].concat(),
        );
        long.extend(offsets);
        long.extend(in_pieces(&[], &halves));
        assert_eq!(packed(long).load().0, volume, "{}", frame["name"]);
        for table in [&[][..], &[0], &[0, 2], &[0, 0], &[second, 0], &[0, second, second], &[0, u32::MAX]] {
            let (code, message) = packed(in_pieces(table, &halves)).refused();
            assert_eq!(code, "bad-header", "{message}");
        }
        assert_eq!(packed(in_pieces(&[], &whole[..1])).refused().0, "bad-header");
    }
}

#[test]
fn frames_without_places_or_pixels_are_refused() {
    let with = |change: &dyn Fn(&mut Frames)| {
        let mut frames = Frames::at(&[0.0, 1.0, 2.0]);
        change(&mut frames);
        frames.refused()
    };
    let (code, message) = with(&|f| f.groups.clear());
    assert_eq!(code, "unsupported");
    assert!(message.contains("'3' frames") && message.contains("save one slice a file"), "{message}");
    assert_eq!(with(&|f| f.frames = "4".to_owned()).0, "unsupported");
    assert_eq!(with(&|f| f.frames = "99999999999999999999".to_owned()).0, "unsupported");
    assert_eq!(with(&|f| f.frames = "-1".to_owned()).0, "unsupported");
    assert_eq!(with(&|f| f.groups = vec![Vec::new(); (1 << 20) + 1]).0, "too-large");
    assert_eq!(with(&|f| f.shared.clear()).0, "missing-attribute");
    assert_eq!(with(&|f| f.groups[1].clear()).0, "missing-attribute");
    let (code, message) = with(&|f| f.groups[1] = vec![place(0.0)]);
    assert_eq!((code, message.starts_with("frame 2: ")), ("same-place", true), "{message}");
    assert_eq!(with(&|f| f.groups[1] = vec![place(1.4)]).0, "uneven-slices");
    assert_eq!(with(&|f| f.size = [3, 3]).0, "size-mismatch");
    assert_eq!(with(&|f| f.bits = [1, 1, 0, 0]).0, "unsupported");
    assert_eq!(
        with(&|f| f.groups[1] = vec![sequence([0x20, 0x9113], &[vec![]], true)]).0,
        "missing-attribute"
    );
}

#[test]
fn masks_of_a_segmentation_become_labels_on_one_lattice() {
    let frames =
        masks(&[(4.0, 1, [0b101, 0]), (0.0, 7, [0, 0x80]), (2.0, 7, [0b110, 0]), (2.0, 1, [0b11, 0])], "1");
    let (volume, warnings) = frames.load();
    assert_eq!(volume.grid.size(), [8, 2, 5]);
    assert_eq!(volume.grid.affine().rows()[2], [0.0, 0.0, 1.0, 0.0]);
    let mut expected = vec![0.0; 80];
    for (k, label) in [(15, 7.0), (32, 1.0), (33, 1.0), (34, 7.0), (64, 1.0), (66, 1.0)] {
        expected[k] = label;
    }
    assert_eq!(values(&volume), expected);
    assert_eq!((warnings.len(), warnings[0].code, warnings[0].count), (1, "segments-overlap", 1));
    let look = |label: i64| (volume.labels[&label].name.as_str(), volume.labels[&label].color.unwrap());
    let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.01);
    assert!(look(1).0 == "bone" && near(look(1).1, [1.0, 0.0, 0.0]), "{:?}", look(1));
    assert!(look(7).0 == "skin" && near(look(7).1, [1.0, 1.0, 1.0]), "{:?}", look(7));
    // Without the distance of slices, it is the smallest that occurs.
    assert_eq!(
        masks(&[(0.0, 1, [1, 1]), (4.0, 1, [1, 1]), (6.0, 300, [1, 1])], "").load().0.grid.size(),
        [8, 2, 4]
    );
}

#[test]
fn masks_of_several_files_are_volumes_of_their_own() {
    let file = |bits: u8| masks(&[(0.0, 1, [bits, 0]), (1.0, 1, [bits, 0])], "1").bytes();
    let files: Files = [("a.dcm".to_owned(), file(1)), ("b.dcm".to_owned(), file(2))].into();
    let error = load_with(&files, &Limits::default()).unwrap_err();
    assert_eq!(error.code, "several-volumes");
    assert!(error.message.contains("1: 'knee', file 'b.dcm' with 2 slices"), "{error}");
    let (volume, _) = load_with(&files, &Limits { index: Some(1), ..Limits::default() }).unwrap();
    assert_eq!(values(&volume)[..3], [0.0, 1.0, 0.0]);
}

#[test]
fn maps_of_labels_may_lack_slices() {
    for bytes in [1, 2] {
        let rows = [(0.0, 1, [0, 0]), (4.0, 1, [0, 0]), (2.0, 1, [0, 0]), (8.0, 1, [0, 0])];
        let mut frames =
            Frames { size: [2, 2], bits: [8 * bytes, 8 * bytes, 8 * bytes - 1, 0], ..masks(&rows, "2") };
        // "BINARY" becomes a word that is two letters longer.
        frames.segments[8..14].copy_from_slice(b"LABELM");
        frames.segments.splice(14..14, *b"AP");
        frames.segments[6] = 8;
        frames.groups = [0.0, 4.0, 2.0, 8.0].map(|z| vec![place(z)]).into();
        let samples: Vec<u8> =
            (0..16_u16).flat_map(|k| [k as u8, 1][..usize::from(bytes)].to_vec()).collect();
        frames.pixels.clear();
        element(&mut frames.pixels, [0x7FE0, 0x10], b"OW", &samples, [true, false]);
        let (volume, warnings) = frames.load();
        assert!(warnings.is_empty(), "{warnings:?}");
        let more = if bytes == 2 { 256.0 } else { 0.0 };
        let expected = [0, 1, 2, 3, 8, 9, 10, 11, 4, 5, 6, 7].map(|k| f64::from(k) + more);
        assert_eq!(volume.grid.size(), [2, 2, 5]);
        assert_eq!(values(&volume)[..12], expected);
        assert_eq!(values(&volume)[12..16], [0.0; 4]);
        assert_eq!(values(&volume)[16..], [12, 13, 14, 15].map(|k| f64::from(k) + more));
        assert_eq!(volume.labels[&7].name, "skin");
    }
}

#[test]
fn masks_may_state_a_rounded_distance() {
    let rows: Vec<(f64, u16, [u8; 2])> = (0..90).map(|k| (f64::from(k) / 3.0, 1, [1, 0])).collect();
    let (volume, _) = masks(&rows, "0.333").load();
    assert_eq!(volume.grid.size(), [8, 2, 90]);
    assert!((volume.grid.affine().steps()[2][2] - 1.0 / 3.0).abs() < 1e-12);
    // Here the positions are rounded, and the distance is not.
    let place = |k: u32| (62.5 * f64::from(k) + 0.5).floor() / 100.0;
    let rows: Vec<(f64, u16, [u8; 2])> = (0..100).map(|k| (place(k), 1, [1, 0])).collect();
    assert_eq!(masks(&rows, "0.625").load().0.grid.affine().steps()[2][2], 0.625);
}

#[test]
fn masks_that_are_no_lattice_are_refused() {
    let two = |z: f64, segment: u16| masks(&[(0.0, 1, [1, 1]), (z, segment, [1, 1])], "1");
    assert_eq!(two(0.0, 2).refused().0, "flat-volume");
    assert_eq!(two(1.5, 2).refused().0, "uneven-slices");
    assert_eq!(two(2.0, 0).refused().0, "missing-attribute");
    assert_eq!(two(1e15, 2).refused().0, "bad-size");
    assert_eq!(two(1e8, 2).refused().0, "too-dense");
    let larger = Frames { size: [3, 8], ..two(1.0, 2) };
    assert_eq!(larger.refused().0, "size-mismatch");
}

#[test]
fn frames_that_are_cut_or_changed_end_well() {
    for good in [Frames::at(&[0.0, 1.0]).bytes(), masks(&[(0.0, 1, [1, 1]), (1.0, 2, [1, 1])], "1").bytes()] {
        for end in 0..good.len() {
            refuse(&good[..end], Format::Dicom);
        }
        for at in 128..good.len() {
            for value in [0, 1, 0x7F, 0xFF] {
                let mut changed = good.clone();
                changed[at] = value;
                let _ = chordal_io::read(&changed, Format::Dicom, &Limits::default());
            }
        }
    }
}
