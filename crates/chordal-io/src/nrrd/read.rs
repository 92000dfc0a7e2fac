//! Reads `.nrrd`.
use super::fields::{NrrdEncoding, NrrdField, NrrdHeader};
use super::orientation::{affine, space};
use crate::nii::chosen_volume;
use crate::text::{grouped, number, number_error};
use crate::volume::count::{along, size_of};
use crate::volume::element::Endian;
use crate::volume::inflate::{InflateReader, check_ratio};
use crate::volume::samples::{self, SampleLayout, TextSamples};
use crate::volume::stream::SampleStream;
use crate::warnings::Warnings;
use crate::{Content, FileLocation, Limits, ReadError, ReadOutcome, Volume};
use chordal::budget::advice::{Message, Setting};
use chordal::implicit::{Grid, Samples};

/// Reads the volume of a NRRD file, in the space of the file. Its directions and origin place the samples,
/// whether in RAS, LPS or another space. Nothing is rotated; [`Volume::space`] names the space.
///
/// An axis outside space (colours, times) makes several volumes; [`Limits::index`] chooses one.
///
/// # Errors
/// [`ReadError`] at the line of the header, or at the byte; also for samples in another file, which the
/// reader never opens.
///
/// ```
/// use chordal_io::{Content, Limits, nrrd};
/// let file = b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: text\nspace: RAS\n\
///              space directions: (0,2,0) (0,0,3) (4,0,0)\nspace origin: (10,0,0)\n\n0 1 2 3 4 5 6 7\n";
/// let Content::Volume(volume) = nrrd::read(file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(volume.grid.affine().at([1.0, 0.0, 1.0]), [14.0, 2.0, 0.0]);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let mut warnings = Warnings::default();
    let fields = NrrdHeader::read(bytes, limits)?;
    let missing = |what: &str| {
        ReadError::new(
            "bad-header",
            FileLocation::Line(fields.last_line),
            format!("the header has no '{what}'"),
        )
    };
    let element = fields.element.ok_or_else(|| missing("type"))?;
    let encoding = fields.encoding.ok_or_else(|| missing("encoding"))?;
    let sizes = sizes(&fields)?;
    let place = FileLocation::Line(sizes.line);
    let (axes, list) = axes(&fields, &sizes.value, &place)?;
    refuse_colors(&fields, sizes.value.len(), limits)?;
    for (axis, n) in sizes.value.iter().enumerate() {
        along(axis, *n, &place)?;
    }
    let size = size_of(axes.map(|axis| sizes.value[axis]), element, &place, limits)?;
    let affine = affine(&fields, axes, &mut warnings)?;
    let (frame, space) = space(&fields, &mut warnings)?;
    if element.width() > 1 && encoding != NrrdEncoding::Text && fields.endian.is_none() {
        return Err(missing("endian"));
    }
    let mut layout = SampleLayout::volumes(element, fields.endian.unwrap_or(Endian::Little), size);
    // The first axis varies fastest:
    //
    //      | inner | inner | … | inner |    `of` runs, one of each volume,
    //      | inner | inner | … | inner |    `outer` times
    if let Some(list) = list {
        let product = |sizes: &[i64]| sizes.iter().map(|n| *n as u64).product();
        layout.inner = product(&sizes.value[..list]);
        layout.outer = product(&sizes.value[list + 1..]);
        layout.of = sizes.value[list] as u64;
    }
    layout.index = chosen_volume(layout.of, limits, &place)?;
    let samples = samples_of(bytes, &fields, &layout, &DecodeContext { encoding, limits }, &mut warnings)?;
    samples::count_not_finite(&samples, &mut warnings);
    let grid = Grid::new(size, samples, affine)
        .map_err(|error| ReadError::new("bad-size", place, error.to_string()))?;
    let labels = fields.segments.labels(layout.index);
    let volume = Volume {
        frame,
        name: fields.content,
        space,
        labels,
        certificate: fields.certificate.finish(&mut warnings),
        ..Volume::from_grid(grid)
    };
    Ok(ReadOutcome { content: Content::Volume(volume), warnings: warnings.into_list() })
}

/// The sizes of all axes, checked against the declared number of axes.
fn sizes(fields: &NrrdHeader) -> Result<NrrdField<Vec<i64>>, ReadError> {
    let missing = |what: &str| {
        ReadError::new(
            "bad-header",
            FileLocation::Line(fields.last_line),
            format!("the header has no '{what}'"),
        )
    };
    let dimension = fields.dimension.as_ref().ok_or_else(|| missing("dimension"))?;
    let sizes = fields.sizes.clone().ok_or_else(|| missing("sizes"))?;
    if sizes.value.len() as i64 != dimension.value {
        let message = format!("{} sizes for dimension {}", sizes.value.len(), dimension.value);
        return Err(ReadError::new("bad-header", FileLocation::Line(sizes.line), message));
    }
    Ok(sizes)
}

/// Refuses an image with colours, unless one channel of it was chosen.
fn refuse_colors(fields: &NrrdHeader, n_axes: usize, limits: &Limits) -> Result<(), ReadError> {
    let is_color = |kind: &&String| kind.ends_with("-color");
    let Some(kinds) = &fields.kinds else { return Ok(()) };
    let Some(kind) = kinds.value.iter().find(is_color) else { return Ok(()) };
    if n_axes == 4 && limits.index.is_some() {
        return Ok(());
    }
    let message = format!(
        "an axis is of the kind {kind}: an image with colours is no volume, which has one number a sample"
    );
    let message = Message::from(message);
    let message = if n_axes == 4 {
        message.words("; ").setting(Setting::Index).words(" takes one channel, counted from 0")
    } else {
        message
    };
    Err(ReadError::new("colours", FileLocation::Line(kinds.line), message))
}

/// The spatial axes, and the one outside space.
fn axes(
    fields: &NrrdHeader,
    sizes: &[i64],
    place: &FileLocation,
) -> Result<([usize; 3], Option<usize>), ReadError> {
    let n = sizes.len();
    if n == 3 {
        return Ok(([0, 1, 2], None));
    }
    if n != 4 {
        let message = Message::from(format!("{n} axes are no volume: three are expected, or four with "))
            .setting(Setting::Index)
            .words(" for one of the fourth");
        return Err(ReadError::new("not-3d", place.clone(), message));
    }
    let is_space = |kind: &str| matches!(kind, "domain" | "space");
    let by_direction =
        fields.directions.as_ref().and_then(|field| field.value.iter().position(Option::is_none));
    let by_kind = || {
        let is_known = |kind: &&String| !matches!(kind.as_str(), "???" | "none");
        let kinds = fields.kinds.as_ref()?;
        kinds.value.iter().position(|kind| is_known(&kind) && !is_space(kind))
    };
    let by_spacing =
        || fields.spacings.as_ref().and_then(|field| field.value.iter().position(|x| x.is_nan()));
    // If no field tells which axis is outside space, it is the slowest.
    // By the surest field first: a direction `none` says outright that the axis is outside space, a
    // kind only what it holds; spacings of such axes are NaN.
    let list = by_direction.or_else(by_kind).or_else(by_spacing).filter(|axis| *axis < 4).unwrap_or(3);
    let mut axes = (0..4).filter(|axis| *axis != list);
    let mut next = || axes.next().unwrap_or(0);
    Ok(([next(), next(), next()], Some(list)))
}

/// The context in which samples are decoded.
struct DecodeContext<'a> {
    encoding: NrrdEncoding,
    limits: &'a Limits,
}

fn samples_of(
    bytes: &[u8],
    fields: &NrrdHeader,
    layout: &SampleLayout,
    context: &DecodeContext,
    warnings: &mut Warnings,
) -> Result<Samples, ReadError> {
    let start = after_lines(bytes, fields)?;
    let skipped = u64::try_from(fields.byte_skip).ok();
    match context.encoding {
        NrrdEncoding::Raw => {
            let mut stream = SampleStream::plain(bytes, start);
            let declared = layout.bytes().unwrap_or(u64::MAX);
            let left = (bytes.len() - start) as u64;
            // A value of -1 in the header means that the samples end with the file.
            let skip = skipped.unwrap_or(left.saturating_sub(declared));
            if stream.skip(skip)? < skip {
                return Err(stream.truncated(0, declared));
            }
            samples::read(&mut stream, layout, context.limits, warnings)
        }
        NrrdEncoding::Gzip => {
            check_ratio(layout.bytes(), (bytes.len() - start) as u64, &FileLocation::Byte(start as u64))?;
            let mut stream = SampleStream::Packed(InflateReader::gzip(&bytes[start..], start as u64));
            let skip = skipped.ok_or_else(|| {
                let message = "packed samples are not counted from the end: 'byte skip' is 0 or more";
                ReadError::new("bad-header", FileLocation::File, message)
            })?;
            if stream.skip(skip)? < skip {
                return Err(stream.truncated(0, skip));
            }
            samples::read(&mut stream, layout, context.limits, warnings)
        }
        NrrdEncoding::Text => {
            let skip = skipped.map_or(0, |n| usize::try_from(n).unwrap_or(usize::MAX));
            let text = bytes[start..].get(skip..).unwrap_or(&[]);
            parse_text_samples(text, start + (bytes.len() - start - text.len()), layout)
        }
    }
}

/// The byte after the lines that the header skips.
fn after_lines(bytes: &[u8], fields: &NrrdHeader) -> Result<usize, ReadError> {
    let mut at = fields.end;
    for _ in 0..fields.line_skip {
        let Some(end) = memchr::memchr(b'\n', &bytes[at..]) else {
            let message = format!("there are not {} lines to skip", grouped(fields.line_skip));
            return Err(ReadError::new("truncated", FileLocation::Byte(bytes.len() as u64), message));
        };
        at += end + 1;
    }
    Ok(at)
}

/// Parses numbers separated by spaces or commas.
fn parse_text_samples(text: &[u8], start: usize, layout: &SampleLayout) -> Result<Samples, ReadError> {
    let declared = layout.inner.saturating_mul(layout.of).saturating_mul(layout.outer);
    let mut kept = TextSamples::new(layout.element);
    let mut row = 0;
    let place =
        |token: &[u8]| FileLocation::Byte((start + token.as_ptr() as usize - text.as_ptr() as usize) as u64);
    for token in text.split(|b| crate::text::is_space(*b) || *b == b',').filter(|token| !token.is_empty()) {
        if row == declared {
            let message = format!(
                "{} follows the {} samples that the header declares",
                crate::text::show(token),
                grouped(row)
            );
            return Err(ReadError::new("trailing-bytes", place(token), message));
        }
        let value =
            number(token).ok_or_else(|| ReadError::new("bad-number", place(token), number_error(token)))?;
        let is_wanted = (row / layout.inner) % layout.of == layout.index;
        if is_wanted && !kept.push(value)? {
            let message = format!("{value} is no number of the type that the header names");
            return Err(ReadError::new("bad-number", place(token), message));
        }
        row += 1;
    }
    if row < declared {
        let message = format!(
            "the samples are cut off: {} are there, the header says {}",
            grouped(row),
            grouped(declared)
        );
        return Err(ReadError::new("truncated", FileLocation::Byte((start + text.len()) as u64), message));
    }
    kept.finish()
}
