//! Filters compute what the specification's formulas say.
use super::{PackedRows, encode, known_streams};
use chordal_testkit::Random;

/// The rows behind a filter.
fn filtered(filter: &str, stride: usize, rows: &[u8]) -> Vec<u8> {
    let packed = encode::vertices(rows, stride, 1, &mut Random::new(3));
    PackedRows { filter: filter.to_owned(), ..packed }.unpacked().expect("decoded")
}

/// Rows of four numbers with sign, of one or two bytes.
fn pack(rows: &[[i32; 4]], size: usize) -> Vec<u8> {
    rows.iter().flatten().flat_map(|x| x.to_le_bytes()[..size].to_vec()).collect()
}

fn unpack(bytes: &[u8], size: usize, signed: bool) -> Vec<i32> {
    bytes
        .chunks(size)
        .map(|x| match (x, signed) {
            ([a], true) => i32::from(*a as i8),
            ([a], false) => i32::from(*a),
            (_, true) => i32::from(i16::from_le_bytes([x[0], x[1]])),
            (_, false) => i32::from(u16::from_le_bytes([x[0], x[1]])),
        })
        .collect()
}

/// How far a number may be from the formula: half a unit, and the rounding of double precision.
const HALF: f64 = 0.5 + 1e-9;

#[test]
fn octahedral_rows_are_unit_vectors() {
    for (size, most) in [(1, 8), (2, 16)] {
        let mut random = Random::new(size as u64);
        let mut rows = Vec::new();
        for bits in 2..=most {
            let one = (1 << (bits - 1)) - 1;
            for _ in 0..200 {
                let (x, y) = (random.signed(), random.signed());
                let part = |x: f64| (x * f64::from(one)).round() as i32;
                rows.push([part(x), part(y), one, random.below(100) as i32 - 50]);
            }
            rows.extend([[0, 0, one, 1], [one, 0, one, 1], [-one, one, one, -1], [0, -one, one, 0]]);
        }
        let found = unpack(&filtered("OCTAHEDRAL", 4 * size, &pack(&rows, size)), size, true);
        let max = [127.0, 32767.0][size - 1];
        for ([x, y, one, w], row) in rows.iter().zip(found.chunks(4)) {
            let (x, y) = (f64::from(*x) / f64::from(*one), f64::from(*y) / f64::from(*one));
            // The point of the octahedron |x| + |y| + |z| = 1 over the square, unfolded below.
            let z = 1.0 - x.abs() - y.abs();
            let sign = |x: f64| if x < 0.0 { -1.0 } else { 1.0 };
            let (x, y) =
                if z < 0.0 { ((1.0 - y.abs()) * sign(x), (1.0 - x.abs()) * sign(y)) } else { (x, y) };
            let length = (x * x + y * y + z * z).sqrt();
            for (value, found) in [x, y, z].iter().zip(row) {
                assert!((value / length * max - f64::from(*found)).abs() <= HALF, "{value} {row:?}");
            }
            assert_eq!(row[3], *w, "the fourth number stays");
        }
    }
}

#[test]
fn quaternion_rows_get_their_largest_number_back() {
    let mut random = Random::new(11);
    let mut rows = Vec::new();
    for bits in 4..=16 {
        let one = (1 << (bits - 1)) - 1;
        for largest in [0, 1, 2, 3].repeat(40) {
            let part = |x: f64| (x * f64::from(one)).round() as i32;
            rows.push([
                part(random.signed()),
                part(random.signed()),
                part(random.signed()),
                one & !3 | largest,
            ]);
        }
    }
    let found = unpack(&filtered("QUATERNION", 8, &pack(&rows, 2)), 2, true);
    for (row, found) in rows.iter().zip(found.chunks(4)) {
        let one = f64::from(row[3] | 3);
        let xyz = [0, 1, 2].map(|k| f64::from(row[k]) / one / 2.0_f64.sqrt());
        let rest = 1.0 - xyz.iter().map(|x| x * x).sum::<f64>();
        let w = if rest > 0.0 { rest.sqrt() } else { 0.0 };
        let largest = (row[3] & 3) as usize;
        for (k, value) in [w, xyz[0], xyz[1], xyz[2]].into_iter().enumerate() {
            let got = f64::from(found[(largest + k) % 4]);
            assert!((value * 32767.0 - got).abs() <= HALF, "{row:?} {found:?}");
        }
    }
}

#[test]
fn exponential_numbers_are_exact() {
    let mut random = Random::new(5);
    let mut source = Vec::new();
    let mut expected = Vec::new();
    for exponent in -100..=100_i32 {
        for mantissa in [0, 1, -1, (1 << 23) - 1, -(1 << 23), random.below(1 << 24) as i32 - (1 << 23)] {
            source.extend((exponent << 24 | (mantissa & 0xFF_FFFF)).to_le_bytes());
            expected.extend((mantissa as f32 * 2.0_f32.powi(exponent)).to_le_bytes());
        }
    }
    assert_eq!(filtered("EXPONENTIAL", 4, &source), expected);
    let wide = source.len() / 12 * 12;
    assert_eq!(filtered("EXPONENTIAL", 12, &source[..wide]), expected[..wide]);
}

#[test]
fn color_rows_are_red_green_blue_and_alpha() {
    for (size, most) in [(1_usize, 8), (2, 16)] {
        let max = f64::from((1_u32 << (8 * size)) - 1);
        let mut random = Random::new(50 + size as u64);
        let (mut rows, mut colors) = (Vec::new(), Vec::new());
        for bits in 2..=most {
            for _ in 0..100 {
                let one = (1_i32 << bits) - 1;
                let [r, g, b] = [0; 3].map(|_| random.below(1 << bits) as i32);
                // The lifting steps of YCoCg with one bit less for the differences: colours that they bring
                // back are kept.
                let (co, cg) = ((r - b) / 2, (g - (r + b) / 2) / 2);
                let y = g - cg;
                let back = [y + co - cg, y + cg, y - co - cg];
                if !back.iter().all(|x| (0..=one).contains(x)) {
                    continue;
                }
                let alpha = random.below(1 << (bits - 1)) as i32;
                rows.push([y, co, cg, alpha | 1 << (bits - 1)]);
                let alpha = 2 * alpha + alpha % 2;
                colors.push([back[0], back[1], back[2], alpha].map(|x| f64::from(x) * max / f64::from(one)));
            }
        }
        assert!(rows.len() > 300);
        let found = unpack(&filtered("COLOR", 4 * size, &pack(&rows, size)), size, false);
        for (color, found) in colors.iter().zip(found.chunks(4)) {
            let is_near = |(x, found): (&f64, &i32)| (x - f64::from(*found)).abs() <= HALF;
            assert!(color.iter().zip(found).all(is_near), "{color:?} {found:?}");
        }
    }
}

#[test]
fn filters_of_the_original_library() {
    let mut seen = Vec::new();
    for known in known_streams() {
        let PackedRows { filter, stride, .. } = &known.packed;
        if filter == "NONE" {
            continue;
        }
        seen.push(filter.clone());
        let found = known.packed.unpacked().expect("decoded");
        if filter == "EXPONENTIAL" {
            assert_eq!(found, known.decoded);
            continue;
        }
        // It rounds in single precision, which the specification allows: one unit in the last place.
        let size = if filter == "QUATERNION" { 2 } else { stride / 4 };
        let signed = filter != "COLOR";
        let pairs = unpack(&found, size, signed).into_iter().zip(unpack(&known.decoded, size, signed));
        assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() <= 1), "{}", known.name);
    }
    for filter in ["OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"] {
        assert!(seen.iter().filter(|name| *name == filter).count() >= 2, "{filter}");
    }
}

#[test]
fn rows_that_no_filter_means_are_refused() {
    for (filter, stride, row) in [
        ("OCTAHEDRAL", 4, [1, 2, 0, 0]),
        ("OCTAHEDRAL", 8, [1, 2, -1, 0]),
        ("OCTAHEDRAL", 8, [1, 2, 100, 0]),
        ("QUATERNION", 8, [1, 2, 3, -4]),
        ("QUATERNION", 8, [1, 2, 3, 100]),
        ("COLOR", 4, [1, 2, 3, 0]),
        ("COLOR", 8, [1, 2, 3, 0]),
    ] {
        let packed = encode::vertices(&pack(&[row], stride / 4), stride, 0, &mut Random::new(1));
        let packed = PackedRows { filter: filter.to_owned(), ..packed };
        let error = packed.unpacked().expect_err("accepted");
        assert_eq!(error.code, "meshopt-stream", "{error}");
        assert!(error.to_string().contains("row 0"), "{error}");
    }
}
