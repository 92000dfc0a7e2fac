//! Samples read from a stream: in their own type, one of several volumes, scaled if a header says so.
use super::element::{Endian, SampleType, half};
use super::stream::SampleStream;
use crate::grow::{out_of_memory, push, with_room};
use crate::text::grouped;
use crate::warnings::Warnings;
use crate::{Conformance, FileLocation, Limits, ReadError};
use chordal::budget::advice::{Message, Setting};
use chordal::implicit::Samples;

/// The layout of samples in a stream: `outer` times `of` runs of `inner` samples; run `index` of each `of`
/// runs is read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SampleLayout {
    pub element: SampleType,
    pub endian: Endian,
    pub inner: u64,
    pub of: u64,
    pub outer: u64,
    pub index: u64,
}

impl SampleLayout {
    /// Consecutive volumes, one of which is read.
    pub(crate) fn volumes(element: SampleType, endian: Endian, size: [usize; 3]) -> Self {
        let inner = size.iter().map(|n| *n as u64).product();
        Self { element, endian, inner, of: 1, outer: 1, index: 0 }
    }

    /// The bytes of all runs.
    pub(crate) fn bytes(&self) -> Option<u64> {
        [self.of, self.outer, self.element.width() as u64]
            .into_iter()
            .try_fold(self.inner, |all, n| all.checked_mul(n))
    }
}

/// The bytes that are read at once: a whole number of samples of any type.
const CHUNK: usize = 1 << 15;

/// Reads the samples of a stream, which must end after them.
///
/// # Errors
/// If it ends before or after them; if 64-bit numbers are too large to be kept exactly.
pub(crate) fn read(
    stream: &mut SampleStream,
    layout: &SampleLayout,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<Samples, ReadError> {
    let declared = layout.bytes().ok_or_else(|| {
        let message = "the header declares more samples than can be counted";
        ReadError::new("too-large", stream.place(), message)
    })?;
    if let Some(left) = stream.left().filter(|left| *left < declared) {
        stream.skip(left)?;
        return Err(stream.truncated(left, declared));
    }
    let e = layout.endian;
    let samples = match layout.element {
        SampleType::Bool => Samples::U8(collect(stream, layout, |b| u8::from(b[0] != 0))?),
        SampleType::U8 => Samples::U8(collect(stream, layout, |b| b[0])?),
        SampleType::I8 => Samples::I8(collect(stream, layout, |b| b[0] as i8)?),
        SampleType::U16 => Samples::U16(collect(stream, layout, |b| u16::from_le_bytes(e.array(b)))?),
        SampleType::I16 => Samples::I16(collect(stream, layout, |b| i16::from_le_bytes(e.array(b)))?),
        SampleType::U32 => Samples::U32(collect(stream, layout, |b| u32::from_le_bytes(e.array(b)))?),
        SampleType::I32 => Samples::I32(collect(stream, layout, |b| i32::from_le_bytes(e.array(b)))?),
        SampleType::F16 => Samples::F32(collect(stream, layout, |b| half(u16::from_le_bytes(e.array(b))))?),
        SampleType::F32 => Samples::F32(collect(stream, layout, |b| f32::from_le_bytes(e.array(b)))?),
        SampleType::F64 => Samples::F64(collect(stream, layout, |b| f64::from_le_bytes(e.array(b)))?),
        SampleType::I64 => narrow(&collect(stream, layout, |b| i64::from_le_bytes(e.array(b)))?)?,
        SampleType::U64 => narrow(&collect(stream, layout, |b| u64::from_le_bytes(e.array(b)))?)?,
    };
    end(stream, limits, warnings)?;
    Ok(samples)
}

/// The bytes of the samples of a stream, which must end after them.
///
/// # Errors
/// If it ends before or after them.
pub(crate) fn bytes(
    stream: &mut SampleStream,
    layout: &SampleLayout,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<Vec<u8>, ReadError> {
    let declared = layout.bytes().unwrap_or(u64::MAX);
    let mut bytes = Vec::new();
    let mut buffer = [0; CHUNK];
    while (bytes.len() as u64) < declared {
        let left = usize::try_from(declared - bytes.len() as u64).unwrap_or(usize::MAX);
        let want = left.min(CHUNK);
        let got = stream.fill(&mut buffer[..want])?;
        append(&mut bytes, buffer[..got].iter().copied())?;
        if got < want {
            return Err(stream.truncated(bytes.len() as u64, declared));
        }
    }
    end(stream, limits, warnings)?;
    Ok(bytes)
}

/// Checks that nothing follows: extra bytes mean that the header is wrong.
fn end(stream: &mut SampleStream, limits: &Limits, warnings: &mut Warnings) -> Result<(), ReadError> {
    let place = stream.place();
    let more = match stream.left() {
        Some(left) => left,
        // One extra packed byte is enough, unless all are to be counted.
        None => stream.skip(if limits.conformance == Conformance::Lenient { u64::MAX } else { 1 })?,
    };
    // A stream of unknown length may have more bytes than those that were read.
    let is_exact = stream.left().is_some() || limits.conformance == Conformance::Lenient;
    let more = TrailingBytes { more, place, is_exact };
    more.check(limits, warnings)?;
    let after = stream.after();
    TrailingBytes { more: after, place: stream.place(), is_exact: true }.check(limits, warnings)
}

/// Bytes after the samples that a header declares.
pub(crate) struct TrailingBytes {
    pub more: u64,
    pub place: FileLocation,
    /// Whether their number is exact, or a lower bound.
    pub is_exact: bool,
}

impl TrailingBytes {
    /// Refuses them, or counts them if the reader is lenient.
    pub(crate) fn check(self, limits: &Limits, warnings: &mut Warnings) -> Result<(), ReadError> {
        let Self { more, place, is_exact } = self;
        if more == 0 {
            return Ok(());
        }
        if limits.conformance != Conformance::Lenient {
            let how_many = if is_exact { format!("{} more", grouped(more)) } else { "more".to_owned() };
            let message = format!("the samples that the header declares end here, {how_many} bytes follow; ");
            let message = Message::from(message).setting(Setting::Lenient).words(" skips them");
            return Err(ReadError::new("trailing-bytes", place, message));
        }
        warnings.count("trailing-bytes", || {
            let message =
                format!("{} bytes after the samples that the header declares were skipped", grouped(more));
            (place, message)
        });
        Ok(())
    }
}

fn collect<T: Copy>(
    stream: &mut SampleStream,
    layout: &SampleLayout,
    number: impl Fn(&[u8]) -> T,
) -> Result<Vec<T>, ReadError> {
    let width = layout.element.width();
    let run = layout.inner * width as u64;
    // Each of the `outer` rounds has one run of every volume, of which one is kept.
    let (before, after) = (layout.index * run, (layout.of - 1 - layout.index) * run);
    let declared = layout.outer * layout.of * run;
    // Plain bytes can be counted in advance, packed ones only as they are unpacked.
    let mut samples = match stream.left() {
        Some(_) => with_room((layout.inner * layout.outer) as usize)?,
        None => Vec::new(),
    };
    let mut buffer = [0; CHUNK];
    let mut n_read = 0;
    for _ in 0..layout.outer {
        let passed = stream.skip(before)?;
        n_read += passed;
        let mut left = if passed == before { run } else { 0 };
        while left > 0 {
            let want = usize::try_from(left).unwrap_or(usize::MAX).min(CHUNK);
            let got = stream.fill(&mut buffer[..want])?;
            n_read += got as u64;
            append(&mut samples, buffer[..got].chunks_exact(width).map(&number))?;
            left -= got as u64;
            if got < want {
                break;
            }
        }
        if left > 0 || passed < before {
            return Err(stream.truncated(n_read, declared));
        }
        let passed = stream.skip(after)?;
        n_read += passed;
        if passed < after {
            return Err(stream.truncated(n_read, declared));
        }
    }
    Ok(samples)
}

/// Appends a chunk. The list grows by half.
fn append<T>(list: &mut Vec<T>, chunk: impl ExactSizeIterator<Item = T>) -> Result<(), ReadError> {
    if list.capacity() - list.len() < chunk.len() {
        let step = chunk.len().max(list.len() / 2);
        list.try_reserve_exact(step).map_err(|_| out_of_memory(list.len()))?;
    }
    list.extend(chunk);
    Ok(())
}

/// 64-bit integers; most files have none that need so many bits.
trait WideInteger: Copy + TryInto<i32> + TryInto<u32> + std::fmt::Display {
    /// The number as f64, if exact.
    fn exact(self) -> Option<f64>;
}

impl WideInteger for i64 {
    fn exact(self) -> Option<f64> {
        let value = self as f64;
        // 2⁶³ would saturate to the largest i64, which is another number.
        (value < 9_223_372_036_854_775_808.0 && value as i64 == self).then_some(value)
    }
}

impl WideInteger for u64 {
    fn exact(self) -> Option<f64> {
        let value = self as f64;
        (value < 18_446_744_073_709_551_616.0 && value as u64 == self).then_some(value)
    }
}

/// Converts to the smallest type that holds all: 32 bits with or without sign, else f64.
fn narrow<T: WideInteger>(values: &[T]) -> Result<Samples, ReadError> {
    if let Some(values) = convert_all(values, |x| TryInto::<i32>::try_into(x).ok())? {
        return Ok(Samples::I32(values));
    }
    if let Some(values) = convert_all(values, |x| TryInto::<u32>::try_into(x).ok())? {
        return Ok(Samples::U32(values));
    }
    if let Some(values) = convert_all(values, WideInteger::exact)? {
        return Ok(Samples::F64(values));
    }
    let row = values.iter().position(|x| x.exact().is_none()).unwrap_or(0);
    let message = format!("{} is a whole number that f64 does not hold", values[row]);
    Err(ReadError::new("inexact-integer", FileLocation::Row { list: "sample", row: row as u64 }, message))
}

fn convert_all<T: Copy, U>(values: &[T], to: impl Fn(T) -> Option<U>) -> Result<Option<Vec<U>>, ReadError> {
    if !values.iter().all(|x| to(*x).is_some()) {
        return Ok(None);
    }
    let mut list = with_room(values.len())?;
    list.extend(values.iter().filter_map(|x| to(*x)));
    Ok(Some(list))
}

/// Computes `slope · sample + inter`, in f32 if that is exact for all of them, else in f64.
///
/// # Errors
/// If memory runs out.
pub(crate) fn scaled(samples: &Samples, slope: f64, inter: f64) -> Result<Samples, ReadError> {
    let value = |i: usize| slope * samples.get(i) + inter;
    let n = samples.len();
    let is_single = |x: f64| f64::from(x as f32).to_bits() == x.to_bits() || x.is_nan();
    if (0..n).all(|i| is_single(value(i))) {
        let mut list = with_room(n)?;
        list.extend((0..n).map(|i| value(i) as f32));
        return Ok(Samples::F32(list));
    }
    let mut list = with_room(n)?;
    list.extend((0..n).map(value));
    Ok(Samples::F64(list))
}

/// Numbers in text, in the type that a header states.
pub(crate) struct TextSamples {
    element: SampleType,
    values: Vec<f64>,
}

impl TextSamples {
    pub(crate) fn new(element: SampleType) -> Self {
        Self { element, values: Vec::new() }
    }

    /// Appends a number, if its type can hold it; floating-point types round.
    pub(crate) fn push(&mut self, value: f64) -> Result<bool, ReadError> {
        let range = match self.element {
            SampleType::Bool | SampleType::U8 => Some((0.0, f64::from(u8::MAX))),
            SampleType::I8 => Some((f64::from(i8::MIN), f64::from(i8::MAX))),
            SampleType::U16 => Some((0.0, f64::from(u16::MAX))),
            SampleType::I16 => Some((f64::from(i16::MIN), f64::from(i16::MAX))),
            SampleType::U32 => Some((0.0, f64::from(u32::MAX))),
            SampleType::I32 => Some((f64::from(i32::MIN), f64::from(i32::MAX))),
            // Whole numbers below 2⁵³ are parsed exactly.
            SampleType::U64 => Some((0.0, 9_007_199_254_740_992.0)),
            SampleType::I64 => Some((-9_007_199_254_740_992.0, 9_007_199_254_740_992.0)),
            SampleType::F16 | SampleType::F32 | SampleType::F64 => None,
        };
        if range.is_some_and(|(low, high)| !(value >= low && value <= high && value.fract() == 0.0)) {
            return Ok(false);
        }
        push(&mut self.values, value)?;
        Ok(true)
    }

    /// Returns all samples.
    pub(crate) fn finish(self) -> Result<Samples, ReadError> {
        fn list<T>(values: &[f64], to: impl Fn(f64) -> T) -> Result<Vec<T>, ReadError> {
            let mut list = with_room(values.len())?;
            list.extend(values.iter().map(|x| to(*x)));
            Ok(list)
        }
        let values = &self.values;
        Ok(match self.element {
            SampleType::Bool | SampleType::U8 => Samples::U8(list(values, |x| x as u8)?),
            SampleType::I8 => Samples::I8(list(values, |x| x as i8)?),
            SampleType::U16 => Samples::U16(list(values, |x| x as u16)?),
            SampleType::I16 => Samples::I16(list(values, |x| x as i16)?),
            SampleType::U32 => Samples::U32(list(values, |x| x as u32)?),
            SampleType::I32 => Samples::I32(list(values, |x| x as i32)?),
            SampleType::F16 | SampleType::F32 => Samples::F32(list(values, |x| x as f32)?),
            SampleType::I64 => narrow(&list(values, |x| x as i64)?)?,
            SampleType::U64 => narrow(&list(values, |x| x as u64)?)?,
            SampleType::F64 => Samples::F64(self.values),
        })
    }
}

/// Counts samples that are not finite.
pub(crate) fn count_not_finite(samples: &Samples, warnings: &mut Warnings) {
    let place = |row: usize| FileLocation::Row { list: "sample", row: row as u64 };
    let mut count = |code, message: &str, is: &dyn Fn(f64) -> bool| {
        let (mut n, mut first) = (0, None);
        for i in 0..samples.len() {
            if is(samples.get(i)) {
                n += 1;
                first = first.or(Some(i));
            }
        }
        warnings.count_many(code, n, || (place(first.unwrap_or(0)), message.to_owned()));
    };
    if matches!(samples, Samples::F32(_) | Samples::F64(_)) {
        count("nan-samples", "samples are NaN; they count as outside", &f64::is_nan);
        count("infinite-samples", "samples are infinite", &f64::is_infinite);
    }
}
