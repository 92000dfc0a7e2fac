//! NumPy's arrays: every type and order of bytes and indices, and where `a[i, j, k]` stands.
use super::build::{npy, npy_of};
use super::{load, values};
use chordal::implicit::{Affine3, Grid, Samples};
use chordal_io::{Content, Format, Limits, Volume, npy, read};

/// What `a[i, j, k]` is, by the point where it stands.
#[track_caller]
fn check_places(volume: &Volume, shape: [usize; 3], value: impl Fn([usize; 3]) -> f64) {
    let size = volume.grid.size();
    let mut seen = 0;
    for c in 0..size[2] {
        for b in 0..size[1] {
            for a in 0..size[0] {
                let p = volume.grid.affine().at([a as f64, b as f64, c as f64]).map(|x| x as usize);
                assert!((0..3).all(|k| p[k] < shape[k]), "{p:?}");
                assert_eq!(volume.grid.sample([a, b, c]), value(p), "{p:?}");
                seen += 1;
            }
        }
    }
    assert_eq!(seen, shape.iter().product::<usize>());
}

#[test]
fn an_array_stands_where_its_indices_say_in_either_order() {
    // a[i, j, k] = 100 i + 10 j + k
    let shape = [2, 3, 4];
    let value = |[i, j, k]: [usize; 3]| (100 * i + 10 * j + k) as f64;
    let c: Vec<u8> = (0..24_usize).map(|n| value([n / 12, n / 4 % 3, n % 4]) as u8).collect();
    let f: Vec<u8> = (0..24_usize).map(|n| value([n % 2, n / 2 % 3, n / 6]) as u8).collect();
    let (volume, warnings) = load(&npy("'|u1'", "False", "(2, 3, 4)", &c), Format::Npy);
    assert_eq!(warnings, []);
    assert_eq!(volume.grid.size(), [4, 3, 2], "as it stands in memory");
    assert_eq!(values(&volume), c.iter().map(|x| f64::from(*x)).collect::<Vec<_>>(), "nothing is moved");
    check_places(&volume, shape, value);
    let (volume, _) = load(&npy("'|u1'", "True", "(2, 3, 4)", &f), Format::Npy);
    assert_eq!(volume.grid.size(), shape);
    check_places(&volume, shape, value);
}

#[test]
fn every_type_reads_in_both_byte_orders() {
    let numbers = [0.0, 1.0, 2.0, 3.0, 100.0, 5.0, 6.0, 7.0];
    let signed = numbers.map(|x: f64| if x == 3.0 { -x } else { x });
    macro_rules! check {
        ($t:ty, $name:literal, $all:expr, $kind:ident) => {
            for is_big in [false, true] {
                let bytes: Vec<u8> = $all
                    .iter()
                    .flat_map(|x| if is_big { (*x as $t).to_be_bytes() } else { (*x as $t).to_le_bytes() })
                    .collect();
                let mark = if std::mem::size_of::<$t>() == 1 {
                    '|'
                } else if is_big {
                    '>'
                } else {
                    '<'
                };
                let descr = format!("'{mark}{}'", $name);
                let (volume, _) = load(&npy(&descr, "True", "(2, 2, 2)", &bytes), Format::Npy);
                assert_eq!(values(&volume), $all, "{descr}");
                assert!(matches!(volume.grid.samples(), Samples::$kind(_)), "{descr}");
            }
        };
    }
    check!(u8, "u1", numbers, U8);
    check!(i8, "i1", signed, I8);
    check!(u16, "u2", numbers, U16);
    check!(i16, "i2", signed, I16);
    check!(u32, "u4", numbers, U32);
    check!(i32, "i4", signed, I32);
    check!(u64, "u8", numbers, I32);
    check!(i64, "i8", signed, I32);
    check!(f32, "f4", signed, F32);
    check!(f64, "f8", signed, F64);
    // 0, 1, −2, the smallest above 0, the largest, and three that are not finite.
    let halves: [u16; 8] = [0, 0x3c00, 0xc000, 1, 0x7bff, 0x7c00, 0xfc00, 0x7e00];
    let bytes: Vec<u8> = halves.iter().flat_map(|x| x.to_be_bytes()).collect();
    let (volume, warnings) = load(&npy("'>f2'", "True", "(2, 2, 2)", &bytes), Format::Npy);
    assert_eq!(values(&volume)[..5], [0.0, 1.0, -2.0, 2.0_f64.powi(-24), 65504.0]);
    assert!(values(&volume)[7].is_nan());
    assert_eq!(crate::common::count(&warnings, "infinite-samples"), 2);
    let (volume, _) = load(&npy("'|b1'", "True", "(2, 2, 2)", &[0, 1, 1, 0, 0, 1, 2, 0]), Format::Npy);
    assert_eq!(values(&volume), [0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0]);
}

#[test]
fn whole_numbers_of_64_bits_keep_their_values() {
    let file = |all: [i64; 8]| {
        npy("'<i8'", "True", "(2, 2, 2)", &all.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>())
    };
    let (volume, _) = load(&file([0, 1, 2, 3, 4, 5, 6, u32::MAX.into()]), Format::Npy);
    assert!(matches!(volume.grid.samples(), Samples::U32(_)));
    assert_eq!(values(&volume)[7], f64::from(u32::MAX));
    let (volume, _) = load(&file([-1, 0, 0, 0, 0, 0, 0, 1 << 60]), Format::Npy);
    assert!(matches!(volume.grid.samples(), Samples::F64(_)));
    assert_eq!(values(&volume)[7], 2.0_f64.powi(60));
    let error =
        read(&file([0, 0, 0, (1 << 53) + 1, 0, 0, 0, 0]), Format::Npy, &Limits::default()).unwrap_err();
    assert_eq!(error.code, "inexact-integer");
    assert!(error.to_string().starts_with("sample 3: 9007199254740993 "), "{error}");
}

#[test]
fn headers_of_every_version_and_style_read() {
    let data = [7; 8];
    for (version, header) in [
        (1, "{'descr': '|u1', 'fortran_order': False, 'shape': (2, 2, 2), }"),
        (2, "{\"shape\":(2L,2L,2L),\"descr\":\"|u1\",\"fortran_order\":True}"),
        (3, "  { 'fortran_order' : False,'descr':'|u1','shape':( 2 ,2, 2,) }  "),
    ] {
        let (volume, _) = load(&npy_of(version, header, &data), Format::Npy);
        assert_eq!(values(&volume), [7.0; 8]);
    }
}

#[test]
fn what_is_written_reads_back() {
    let all: Vec<Samples> = vec![
        Samples::U8((0..24).collect()),
        Samples::I8((-12..12).collect()),
        Samples::U16((0..24).map(|i| i * 2000).collect()),
        Samples::I16((-12..12).map(|i| i * 2000).collect()),
        Samples::U32((0..24).map(|i| i * 100_000_000).collect()),
        Samples::I32((-12..12).map(|i| i * 100_000_000).collect()),
        Samples::F32((0_u8..24).map(|i| f32::from(i) / 7.0).collect()),
        Samples::F64((0..24).map(|i| f64::from(i) / 7.0).collect()),
    ];
    for samples in all {
        for affine in [
            Affine3::IDENTITY,
            Affine3::new([[0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]]).unwrap(),
        ] {
            let volume = Volume::from_grid(Grid::new([2, 3, 4], samples.clone(), affine).unwrap());
            let mut bytes = Vec::new();
            npy::write(&volume, &mut bytes).unwrap();
            assert_eq!(bytes.len() % 64, 24 * samples.width() % 64, "samples start at a multiple of 64");
            assert_eq!(load(&bytes, Format::Npy).0, volume);
            assert_eq!(Format::sniff(&bytes), Some(Format::Npy));
        }
    }
    let Content::Volume(_) =
        read(&npy("'|u1'", "True", "(2, 2, 2)", &[0; 8]), Format::Npy, &Limits::default()).unwrap().content
    else {
        panic!("a volume")
    };
}
