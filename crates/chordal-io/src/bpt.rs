//! `.bpt`: a count, then a line `3 3` and sixteen points for each patch.
use crate::grow::push;
use crate::text::{
    IntegerError, LineTokens, TextLines, finite, grouped, integer, number, show, text_of, trim,
};
use crate::warnings::Warnings;
use crate::word_reader::WordReader;
use crate::{Axis, Content, Frame, Limits, ReadError, ReadOutcome};
use chordal::Patch;
use chordal::budget::advice::Message;

/// Reads the patches of a `.bpt` file. The first line is the number of patches. Each patch is a line with its
/// two degrees, which must be `3 3`, then its points row by row, `x y z`. Z is up, as is customary for this
/// format.
///
/// Lower degrees are refused too: raising them to 3 divides by 3, which is not exact.
///
/// # Errors
/// [`ReadError`] at the line, for another degree, too few numbers, or a coordinate that is not finite.
///
/// ```
/// use chordal_io::{Content, Limits, bpt};
/// let file = format!("1\n3 3\n{}", "0 0 0\n".repeat(16));
/// let Content::Patches(patches, _) = bpt::read(file.as_bytes(), &Limits::default())?.content else { unreachable!() };
/// assert_eq!(patches.len(), 1);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let mut words = WordReader::new(text_of(bytes)?);
    let mut warnings = Warnings::default();
    let declared = count(&mut words, || "the number of patches".to_owned())?;
    if declared > limits.rows {
        return Err(crate::assemble::too_many_rows(words.place(), "patches", declared, limits.rows));
    }
    // Grows as points are read: the count is the file's word.
    let mut patches = Vec::new();
    for patch in 0..declared {
        let what = || format!("the degrees of patch {patch} of {}", grouped(declared));
        let degrees = [count(&mut words, what)?, count(&mut words, what)?];
        if degrees != [3, 3] {
            let message = format!(
                "patch {patch} has the degrees {} {}; only bicubic patches, 3 3, are supported",
                degrees[0], degrees[1]
            );
            return Err(ReadError::new("degree-unsupported", words.place(), message));
        }
        let mut control = [[[0.0; 3]; 4]; 4];
        for (i, value) in control.as_flattened_mut().as_flattened_mut().iter_mut().enumerate() {
            let what =
                || format!("coordinate {} of point {} of patch {patch}", ["x", "y", "z"][i % 3], i / 3);
            *value = coordinate(&mut words, what)?;
        }
        push(&mut patches, Patch { control })?;
    }
    while let Some(token) = words.next() {
        let message = || format!("words after the last patch, {} first", show(token));
        warnings.count("trailing-text", || (words.place(), message()));
    }
    crate::assemble::check_patches(&patches, &mut warnings)?;
    let frame = Frame { up: Some(Axis::Z), metres_per_unit: None, ..Frame::default() };
    Ok(ReadOutcome { content: Content::Patches(patches, frame), warnings: warnings.into_list() })
}

/// Whether the text begins with a line that holds only a number, then a line with two degrees.
pub(crate) fn looks_like(text: &[u8]) -> bool {
    let mut lines = TextLines::new(text).map(|(_, line)| trim(line)).filter(|line| !line.is_empty());
    let (Some(first), Some(second)) = (lines.next(), lines.next()) else { return false };
    let degrees: Vec<_> = LineTokens::new(second).take(3).collect();
    integer(first).is_ok()
        && !second.contains(&b',')
        && degrees.len() == 2
        && degrees.iter().all(|token| number(token).is_some())
}

fn count(words: &mut WordReader, what: impl Fn() -> String) -> Result<u64, ReadError> {
    let token = words.expect(&what)?;
    let wrong =
        |why| ReadError::new("not-a-count", words.place(), format!("{}: {} {why}", what(), show(token)));
    match integer(token) {
        Ok(count) => u64::try_from(count).map_err(|_| wrong("is below 0")),
        Err(IntegerError::TooLarge) => Err(wrong("is over any limit")),
        Err(IntegerError::Spelling) => Err(wrong("is not a whole number")),
    }
}

fn coordinate(words: &mut WordReader, what: impl Fn() -> String) -> Result<f64, ReadError> {
    let token = words.expect(&what)?;
    finite(token, || words.place()).map_err(|mut error| {
        error.message = Message::from(what() + ": ").message(&error.message);
        error
    })
}
