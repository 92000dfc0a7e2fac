//! Gzip around files of any format.
use crate::common::refuse;
use chordal_io::{Content, FileLocation, Format, Limits, ReadOutcome, read, unpacked};
use std::io::Write;

fn pack(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).expect("packed");
    encoder.finish().expect("packed")
}

const OBJ: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const PLY: &[u8] =
    b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
    element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const SVG: &[u8] = b"<svg xmlns=\"http://www.w3.org/2000/svg\"><path d=\"M0 0L1 0L1 1Z\"/></svg>";
const VM: &[u8] = b"_x var-x\n_0 const 0.5\n_1 sub _x _0\n";
const NRRD: &[u8] =
    b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\nspacings: 1 1 1\n\n01234567";
const MHA: &[u8] = b"NDims = 3\nDimSize = 2 2 2\nElementSpacing = 1 1 1\nElementType = MET_UCHAR\n\
    ElementDataFile = LOCAL\n01234567";

const FILES: [(Format, &[u8]); 6] = [
    (Format::Obj, OBJ),
    (Format::Ply, PLY),
    (Format::Svg, SVG),
    (Format::Vm, VM),
    (Format::Nrrd, NRRD),
    (Format::MetaImage, MHA),
];

#[test]
fn a_packed_file_is_what_is_inside() {
    for (format, bytes) in FILES {
        let packed = pack(bytes);
        assert_eq!(Format::sniff(&packed), Some(format));
        assert_eq!(Format::from_packed_extension(&format!("{format}.gz")), Some(format));
        assert_eq!(Format::from_packed_extension(&format!("{format}.GZ")), Some(format));
        let plain = read(bytes, format, &Limits::default()).expect("plain");
        let inside = read(&packed, format, &Limits::default()).expect("packed");
        match (&plain.content, &inside.content) {
            (Content::Scene(a), Content::Scene(b)) => assert_eq!(a, b),
            (Content::Volume(a), Content::Volume(b)) => assert_eq!(a, b),
            (a, b) => assert_eq!(std::mem::discriminant(a), std::mem::discriminant(b)),
        }
        assert_eq!(plain.warnings, inside.warnings);
        assert_eq!(*unpacked(&packed, None, &Limits::default()).expect("packed"), *bytes);
        assert_eq!(*unpacked(bytes, None, &Limits::default()).expect("plain"), *bytes);
    }
    for other in ["gz", ".gz", "tar.gz", "", "é.gz", "obj.gz.gz"] {
        assert_eq!(Format::from_packed_extension(other), None, "{other}");
    }
}

#[test]
fn damaged_and_hostile_packing_is_refused() {
    let packed = pack(OBJ);
    for end in 3..packed.len() {
        let error = refuse(&packed[..end], Format::Obj);
        assert!(matches!(error.code, "truncated" | "bad-gzip"), "{end}: {error}");
    }
    for at in 10..packed.len() {
        let mut damaged = packed.clone();
        damaged[at] ^= 0x10;
        // The checksum sees what the packing does not.
        assert!(read(&damaged, Format::Obj, &Limits::default()).is_err(), "{at}");
    }
    assert_eq!(refuse(&pack(&packed), Format::Obj).code, "packed-twice");
    assert_eq!(refuse(&pack(b""), Format::Obj).code, "empty");
    let error = refuse(&pack(b"v 0 0 0\nf 1 2 x\n"), Format::Obj);
    assert!(error.to_string().starts_with("line 2: "), "{error}");
    let bomb = pack(&vec![b'\n'; 20 << 20]);
    assert_eq!(refuse(&bomb, Format::Obj).code, "too-dense");
    // It is told from the first 16 MiB, however much follows.
    let bomb_of_64 = pack(&vec![b'\n'; 64 << 20]);
    let FileLocation::Byte(at) = refuse(&bomb_of_64, Format::Obj).place else { panic!("no byte") };
    assert!(at < bomb_of_64.len() as u64 / 3, "{at} of {}", bomb_of_64.len());
    // Samples may be as dense as this, but these are none.
    assert!(unpacked(&bomb, Some(Format::Nrrd), &Limits::default()).is_ok());
    let small = Limits { bytes: 1 << 20, ..Limits::default() };
    assert_eq!(read(&bomb, Format::Nrrd, &small).unwrap_err().code, "too-large");
    let error = refuse(&pack(PLY), Format::Obj);
    assert!(error.message.contains("the content looks like ply"), "{error}");
}

#[test]
fn nifti_stays_packed_until_its_reader_unpacks_it() {
    let packed = pack(&[0; 100]);
    let same = unpacked(&packed, Some(Format::Nii), &Limits::default()).expect("untouched");
    assert_eq!(*same, *packed);
    let outcome: Result<ReadOutcome, _> = read(&packed, Format::Nii, &Limits::default());
    assert_eq!(outcome.unwrap_err().code, "bad-magic");
}
