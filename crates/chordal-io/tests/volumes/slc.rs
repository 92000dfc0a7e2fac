//! SLC: plain and as runs, packed here by an encoder of its own, and what is refused.
use super::{load, values};
use crate::common::{count, refuse};
use chordal_io::{FileLocation, Format};
use chordal_testkit::Random;

/// A file of a header, a picture of 2 x 1 pixels and samples that are packed by `pack`.
fn slc(size: [usize; 3], packing: u8, data: &[u8]) -> Vec<u8> {
    let [x, y, z] = size;
    let header = format!("11111\n{x} {y} {z} 8\n0.5 1.000000 2.25\n1 2 0 {packing}\n2 1 X");
    [header.as_bytes(), b"RRGGBB", data].concat()
}

/// Slices as runs: of equal samples where there are three or more, else of different ones.
fn runs(samples: &[u8], slice: usize) -> Vec<u8> {
    let mut file = Vec::new();
    for slice in samples.chunks(slice) {
        let mut packed: Vec<u8> = Vec::new();
        let mut rest = slice;
        while let Some(first) = rest.first() {
            let same = rest.iter().take_while(|x| *x == first).count().min(127);
            if same >= 3 {
                packed.extend([same as u8, *first]);
                rest = &rest[same..];
                continue;
            }
            let other = rest.windows(3).position(|w| w[0] == w[1] && w[1] == w[2]).unwrap_or(rest.len());
            let n = other.clamp(1, 127);
            packed.push(128 + n as u8);
            packed.extend(&rest[..n]);
            rest = &rest[n..];
        }
        packed.push(0);
        file.extend(format!("{} X", packed.len()).into_bytes());
        file.extend(packed);
    }
    file
}

#[test]
fn samples_are_the_same_plain_and_as_runs() {
    let seed = 20;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    for round in 0..40 {
        let size: [usize; 3] = std::array::from_fn(|_| 2 + random.below(30));
        let n: usize = size.iter().product();
        // From long runs to none.
        let few = 1 + round % 8;
        let mut samples = Vec::with_capacity(n);
        while samples.len() < n {
            let value = random.below(256) as u8;
            let times = if random.below(8) < few { 1 } else { 1 + random.below(300) };
            samples.resize((samples.len() + times).min(n), value);
        }
        let plain = slc(size, 0, &samples);
        let packed = slc(size, 1, &runs(&samples, size[0] * size[1]));
        for file in [&plain, &packed] {
            assert_eq!(Format::sniff(file), Some(Format::Slc));
            let (volume, warnings) = load(file, Format::Slc);
            assert_eq!(warnings, []);
            assert_eq!(volume.grid.size(), size);
            assert_eq!(values(&volume), samples.iter().map(|x| f64::from(*x)).collect::<Vec<_>>());
            let rows = [[0.5, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 2.25, 0.0]];
            assert_eq!(volume.grid.affine().rows(), rows);
        }
        // Cut anywhere it is one error.
        for _ in 0..20 {
            let end = random.below(packed.len());
            refuse(&packed[..end], Format::Slc);
        }
    }
}

#[test]
fn what_is_no_volume_is_refused_at_its_byte() {
    let good = slc([2, 2, 2], 0, &[7; 8]);
    let changed = |from: &str, to: &str| {
        let text = String::from_utf8(good.clone()).unwrap();
        assert!(text.contains(from));
        refuse(text.replacen(from, to, 1).as_bytes(), Format::Slc)
    };
    assert_eq!(changed("11111", "11112").code, "bad-magic");
    assert_eq!(changed("2 2 2 8", "2 2 2 16").code, "unsupported-type");
    assert_eq!(changed("2 2 2 8", "2 1 2 8").code, "flat-volume");
    assert_eq!(changed("2 2 2 8", "2 -2 2 8").code, "bad-size");
    assert_eq!(changed("2 2 2 8", "2 2 99999999999 8").code, "bad-size");
    assert_eq!(changed("2 2 2 8", "99999 99999 99999 8").code, "too-large");
    assert_eq!(changed("2 2 2 8", "2 2 3 8").code, "truncated");
    assert_eq!(changed("0.5", "0").code, "bad-spacing");
    assert_eq!(changed("0.5", "nan").code, "not-finite");
    assert_eq!(changed("2 0 0\n", "2 0 7\n").code, "unsupported");
    assert_eq!(changed("2 1 X", "2 1 Y").code, "bad-header");
    assert_eq!(changed("2 1 X", "2 -1 X").code, "bad-number");
    assert_eq!(changed("2 1 X", "2 9999 X").code, "truncated");
    let packed = |data: &[u8]| refuse(&slc([2, 2, 2], 1, data), Format::Slc);
    assert_eq!(packed(b"3 X\x05\x01\x00").code, "bad-run");
    assert_eq!(packed(b"3 X\x03\x01\x00").code, "truncated");
    assert_eq!(packed(b"3 X\x84\x01\x02").code, "truncated");
    assert_eq!(packed(b"2 X\x04\x01").code, "bad-header");
    let longer = [&good[..], b"12"].concat();
    let (_, warnings) = load(&longer, Format::Slc);
    assert_eq!(count(&warnings, "trailing-bytes"), 1);
    assert_eq!(warnings[0].place, FileLocation::Byte(good.len() as u64));
}
