//! Reads Bézier patches of Geomview.
use super::keyword::BezKeyword;
use super::net::BezNet;
use super::numbers::{BezNumbers, BezWords};
use crate::assemble::{check_patches, check_surfaces, too_many_rows};
use crate::grow::push;
use crate::text::{grouped, integer, show, text_of};
use crate::warnings::Warnings;
use crate::{Content, FileLocation, Frame, Limits, ReadError, ReadOutcome};
use chordal::Patch;
use chordal::explicit::nurbs::{InvalidNurbs, KnotVector, TrimmedSurface};

/// Reads a Geomview file of Bézier patches, as text or in its big-endian binary form.
///
/// The keyword is `[ST][C]BEZ<u><v><n>[_ST]`, with the degrees along u and v and the number of coordinates of
/// a control point, 3 or, with a weight, 4; or `[ST][C]BBP`, which is `BEZ333`. The three may also follow
/// `BEZ` as numbers. Then come the control points of each patch, u along a row; another keyword may follow
/// between patches.
///
/// A file with only polynomial bicubic patches is [`Content::Patches`], any other [`Content::Surfaces`].
/// Homogeneous control points `x y z w` are divided by `w`. If some weights are 0, as in half a circle of
/// degree 2, the patch is halved once along u and v; it is refused if some still are not above 0. Quotients
/// and halves are rounded, and the rounded surface counts as the true one. Texture coordinates and colours of
/// corners are skipped with a warning.
///
/// # Errors
/// [`ReadError`] at the line, or in a binary file at the byte.
///
/// ```
/// use chordal_io::{Content, Limits, bez};
/// let file = b"BEZ114\n0 0 0 1  2 0 0 2\n0 1 0 1  2 2 0 2\n";
/// let Content::Surfaces(surfaces, _) = bez::read(file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(surfaces[0].surface().at(0.5, 0.5), [2.0 / 3.0, 0.5, 0.0]);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let bytes = bytes.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(bytes);
    let mut words = BezWords::new(bytes);
    let mut warnings = Warnings::default();
    let (keyword, has_appearance) = match words.first_keyword() {
        Ok(found) => found,
        // It may not even be text.
        Err(error) => return Err(text_of(bytes).err().unwrap_or(error)),
    };
    warnings.count_all(
        "appearance-skipped",
        has_appearance.into(),
        "the appearance before the patches was left out",
    );
    let layout = BezLayout::read(keyword, &mut words)?;
    let mut numbers = if words.peek() == Some(b"BINARY") {
        BezNumbers::Binary { bytes, at: words.next_line() }
    } else {
        text_of(bytes)?;
        BezNumbers::Text(words)
    };
    let mut patches = BezPatches::default();
    patches.read(&mut numbers, layout, limits, &mut warnings)?;
    let content = patches.content(&mut warnings)?;
    Ok(ReadOutcome { content, warnings: warnings.into_list() })
}

/// The layout of a patch's numbers.
#[derive(Clone, Copy, Debug)]
struct BezLayout {
    degrees: [usize; 2],
    is_rational: bool,
    has_texcoords: bool,
    has_colors: bool,
}

impl BezLayout {
    /// The layout given by a keyword, or by the three numbers after it.
    fn read(keyword: BezKeyword, words: &mut BezWords) -> Result<Self, ReadError> {
        let form = match keyword.form {
            Some(form) => form.map(u64::from),
            None => [
                count(words, "the degree along u")?,
                count(words, "the degree along v")?,
                count(words, "the number of coordinates")?,
            ],
        };
        let [u, v, n] = form;
        for (degree, name) in [(u, "u"), (v, "v")] {
            // A degree that does not fit is refused later as too high.
            let degree = usize::try_from(degree).unwrap_or(usize::MAX);
            if let Err(error @ InvalidNurbs::Degree(_)) = KnotVector::new(degree, Vec::new()) {
                return Err(ReadError::new(
                    "degree-unsupported",
                    words.place(),
                    format!("along {name}: {error}"),
                ));
            }
        }
        if !matches!(n, 3 | 4) {
            let message =
                format!("{n} coordinates of a control point, where 3 or, with a weight, 4 are read");
            return Err(ReadError::new("dimension-unsupported", words.place(), message));
        }
        Ok(Self {
            degrees: [u as usize, v as usize],
            is_rational: n == 4,
            has_texcoords: keyword.has_texcoords,
            has_colors: keyword.has_colors,
        })
    }

    fn is_bicubic(&self) -> bool {
        self.degrees == [3, 3] && !self.is_rational
    }
}

/// Reads a number that is written as text.
fn count(words: &mut BezWords, what: &str) -> Result<u64, ReadError> {
    let word = words.expect(|| what.to_owned())?;
    integer(word).ok().and_then(|number| u64::try_from(number).ok()).ok_or_else(|| {
        let message = format!("{what}: {} is not a whole number from 0 on", show(word));
        ReadError::new("not-a-count", words.place(), message)
    })
}

/// The patches so far: bicubic patches as long as all are bicubic, else surfaces.
#[derive(Debug, Default)]
struct BezPatches {
    bicubic: Vec<Patch>,
    surfaces: Vec<TrimmedSurface>,
}

impl BezPatches {
    fn n(&self) -> u64 {
        (self.bicubic.len() + self.surfaces.len()) as u64
    }

    fn read(
        &mut self,
        numbers: &mut BezNumbers,
        mut layout: BezLayout,
        limits: &Limits,
        warnings: &mut Warnings,
    ) -> Result<(), ReadError> {
        loop {
            match numbers {
                BezNumbers::Binary { bytes, at } if *at >= bytes.len() => return Ok(()),
                BezNumbers::Binary { .. } => {}
                BezNumbers::Text(words) => match words.peek() {
                    None => return Ok(()),
                    // The end of an embedded object in Geomview's own files.
                    Some([b'}' | b';', ..]) => {
                        words.next();
                        if let Some(word) = words.next() {
                            let message = format!("words after the last patch, {} first", show(word));
                            warnings.count("trailing-text", || (words.place(), message));
                        }
                        return Ok(());
                    }
                    Some(word) => {
                        if let Some(keyword) = BezKeyword::from_word(word) {
                            words.next();
                            layout = BezLayout::read(keyword, words)?;
                            continue;
                        }
                    }
                },
            }
            if self.n() >= limits.rows {
                return Err(too_many_rows(numbers.place(), "patches", self.n() + 1, limits.rows));
            }
            self.patch(numbers, layout)?;
            if layout.has_texcoords || layout.has_colors {
                self.skip_corners(numbers, layout, warnings)?;
            }
        }
    }

    /// Reads the control points of a patch.
    fn patch(&mut self, numbers: &mut BezNumbers, layout: BezLayout) -> Result<(), ReadError> {
        let patch = self.n();
        let [p, q] = layout.degrees;
        let mut points = Vec::new();
        let mut place = numbers.place();
        for point in 0..(p + 1) * (q + 1) {
            let mut coordinates = [0.0, 0.0, 0.0, 1.0];
            for k in 0..3 + usize::from(layout.is_rational) {
                coordinates[k] = numbers.next(|| {
                    let name = ["x", "y", "z", "w"][k];
                    format!("coordinate {name} of point {point} of patch {}", grouped(patch))
                })?;
                // After the first number is read, since blank space and comments may precede it.
                if point == 0 && k == 0 {
                    place = numbers.place();
                }
            }
            push(&mut points, coordinates)?;
        }
        // Bicubic patches without weights stay what they are as long as the file has nothing else;
        // the first other patch turns all of them into NURBS surfaces.
        if layout.is_bicubic() && self.surfaces.is_empty() {
            let control = std::array::from_fn(|row| {
                std::array::from_fn(|column| {
                    let [x, y, z, _] = points[4 * row + column];
                    [x, y, z]
                })
            });
            return push(&mut self.bicubic, Patch { control });
        }
        for bicubic in std::mem::take(&mut self.bicubic) {
            let points = bicubic.control.as_flattened().iter().map(|[x, y, z]| [*x, *y, *z, 1.0]).collect();
            self.surface(BezNet::new([3, 3], points), &place)?;
        }
        self.surface(BezNet::new(layout.degrees, points), &place)
    }

    fn surface(&mut self, net: BezNet, place: &FileLocation) -> Result<(), ReadError> {
        let patch = self.surfaces.len();
        let surface = net.surface().map_err(|error| {
            let message = match error {
                InvalidNurbs::Weight(_) => {
                    "its weights are not above 0, also after it was halved: it reaches infinity \
                                            or comes close to it"
                        .to_owned()
                }
                error => error.to_string(),
            };
            let message = format!("patch {}: {message}", grouped(patch as u64));
            ReadError::new("invalid-patch", place.clone(), message)
        })?;
        push(&mut self.surfaces, TrimmedSurface::from(surface))
    }

    /// Skips the texture coordinates and colours of the corners of a patch.
    fn skip_corners(
        &self,
        numbers: &mut BezNumbers,
        layout: BezLayout,
        warnings: &mut Warnings,
    ) -> Result<(), ReadError> {
        let patch = self.n() - 1;
        let place = numbers.place();
        // Four corners with two coordinates, then with four channels.
        for (has, n, what) in
            [(layout.has_texcoords, 8, "texture coordinate"), (layout.has_colors, 16, "channel of a colour")]
        {
            for k in 0..if has { n } else { 0 } {
                numbers.next(|| format!("{what} {k} of patch {}", grouped(patch)))?;
            }
        }
        let message = "texture coordinates and colours of the corners of patches were left out";
        warnings.count("corner-values-skipped", || (place, message));
        Ok(())
    }

    fn content(self, warnings: &mut Warnings) -> Result<Content, ReadError> {
        if self.surfaces.is_empty() {
            check_patches(&self.bicubic, warnings)?;
            return Ok(Content::Patches(self.bicubic, Frame::default()));
        }
        check_surfaces(&self.surfaces, warnings)?;
        Ok(Content::Surfaces(self.surfaces, Frame::default()))
    }
}
