//! The filters: unit vectors, quaternions, floats and colours from rows of integers, in place.
//!
//! The formulas follow the specification, in double precision; halves are rounded away from zero.
use chordal::math::greater;

/// A row of four numbers, of one or two bytes each.
#[derive(Clone, Copy)]
struct FilterRow {
    /// The numbers as unsigned integers.
    unsigned: [u16; 4],
    /// The same bits as signed integers.
    signed: [i16; 4],
}

impl FilterRow {
    fn new(bytes: &[u8]) -> Self {
        let signed = std::array::from_fn(|k| match bytes {
            [a, b, c, d] => i16::from([*a, *b, *c, *d][k] as i8),
            _ => i16::from_le_bytes([bytes[2 * k], bytes[2 * k + 1]]),
        });
        let unsigned = signed.map(|x| if bytes.len() == 4 { u16::from(x as u8) } else { x as u16 });
        Self { unsigned, signed }
    }
}

/// Writes the numbers of a row, clamped to the range of the type.
fn put_signed(row: &mut [u8], values: &[f64]) {
    let size = row.len() / 4;
    for (place, x) in row.chunks_exact_mut(size).zip(values) {
        match place {
            [byte] => *byte = x.round() as i8 as u8,
            _ => place.copy_from_slice(&(x.round() as i16).to_le_bytes()),
        }
    }
}

/// The same for unsigned numbers.
fn put_unsigned(row: &mut [u8], values: &[f64]) {
    let size = row.len() / 4;
    for (place, x) in row.chunks_exact_mut(size).zip(values) {
        match place {
            [byte] => *byte = x.round() as u8,
            _ => place.copy_from_slice(&(x.round() as u16).to_le_bytes()),
        }
    }
}

/// Whether a number is one less than a power of two, as the integer that represents 1 must be.
fn is_one(x: i16) -> bool {
    x > 0 && (x & x.wrapping_add(1)) == 0
}

/// Unit vectors by octahedral decoding, in the first three numbers; the fourth is kept.
pub(super) fn octahedral(rows: &mut [u8], stride: usize) -> Result<(), String> {
    let max = if stride == 4 { f64::from(i8::MAX) } else { f64::from(i16::MAX) };
    for (i, row) in rows.chunks_exact_mut(stride).enumerate() {
        let [x, y, one, _] = FilterRow::new(row).signed;
        if !is_one(one) {
            return Err(format!("row {i} has {one} for 1, which is no 2^k - 1"));
        }
        let (x, y) = (f64::from(x) / f64::from(one), f64::from(y) / f64::from(one));
        let z = 1.0 - x.abs() - y.abs();
        // The lower half of the sphere is folded over the square's corners.
        let fold = greater(0.0, -z);
        let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
        let length = (x * x + y * y + z * z).sqrt();
        put_signed(row, &[x, y, z].map(|x| x / length * max));
    }
    Ok(())
}

/// Unit quaternions from three of their numbers; the largest one, which is positive, is not stored.
pub(super) fn quaternion(rows: &mut [u8]) -> Result<(), String> {
    for (i, row) in rows.chunks_exact_mut(8).enumerate() {
        let [x, y, z, last] = FilterRow::new(row).signed;
        // The lowest two bits are the index of the largest number.
        let (one, largest) = (last | 3, (last & 3) as usize);
        if !is_one(one) {
            return Err(format!("row {i} has {one} for 1, which is no 2^k - 1"));
        }
        let share = |x: i16| f64::from(x) / f64::from(one) * std::f64::consts::FRAC_1_SQRT_2;
        let (x, y, z) = (share(x), share(y), share(z));
        let w = greater(0.0, 1.0 - x * x - y * y - z * z).sqrt();
        let mut turned = [0.0; 4];
        for (k, value) in [w, x, y, z].into_iter().enumerate() {
            turned[(largest + k) % 4] = value * f64::from(i16::MAX);
        }
        put_signed(row, &turned);
    }
    Ok(())
}

/// Floats from a signed 8-bit binary exponent above a signed 24-bit integer.
pub(super) fn exponential(rows: &mut [u8]) {
    for number in rows.chunks_exact_mut(4) {
        let bits = i32::from_le_bytes([number[0], number[1], number[2], number[3]]);
        let (exponent, mantissa) = (bits >> 24, bits << 8 >> 8);
        // The power is exact in double precision, and so is the product.
        let power = f64::from_bits(((1023 + i64::from(exponent)) as u64) << 52);
        let value = (f64::from(mantissa) * power) as f32;
        number.copy_from_slice(&value.to_le_bytes());
    }
}

/// Red, green, blue and alpha from luma, two chroma differences, and alpha below the highest set bit, which
/// gives the number of bits per channel.
pub(super) fn color(rows: &mut [u8], stride: usize) -> Result<(), String> {
    let max = if stride == 4 { f64::from(u8::MAX) } else { f64::from(u16::MAX) };
    for (i, row) in rows.chunks_exact_mut(stride).enumerate() {
        let FilterRow { unsigned: [y, _, _, alpha], signed: [_, co, cg, _] } = FilterRow::new(row);
        if alpha == 0 {
            return Err(format!("row {i} has no bit that tells its precision"));
        }
        let (y, co, cg) = (i32::from(y), i32::from(co), i32::from(cg));
        let top = alpha.ilog2();
        let one = (2_i32 << top) - 1;
        // The highest bit tells the precision, so alpha has one bit fewer than the colours: its
        // lowest bit is repeated.
        let alpha = i32::from(alpha) & (one >> 1);
        let alpha = alpha << 1 | (alpha & 1);
        let rgba = [y + co - cg, y + cg, y - co - cg, alpha];
        put_unsigned(row, &rgba.map(|x| f64::from(x) * (max / f64::from(one))));
    }
    Ok(())
}
