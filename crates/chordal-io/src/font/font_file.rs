//! `FontFile`: a font of a file, at one position of its variation axes.
use super::glyph_pen::GlyphPen;
use super::placed_glyph::{PlacedGlyph, character};
use crate::text::show;
use crate::{FileLocation, Limits, ReadError};
use chordal::budget::advice::{Message, Setting};
use harfrust::font::Variation;
use harfrust::font::glyph::outline::{DrawMemory, DrawOptions};
use harfrust::{Font, GlyphId, Tag};

/// The signature of a font collection.
pub(super) const COLLECTION: &[u8] = b"ttcf";

/// A font that has outlines and maps characters to them.
pub(super) struct FontFile {
    font: Font,
}

fn refuse<T>(code: &'static str, message: impl Into<Message>) -> Result<T, ReadError> {
    Err(ReadError::new(code, FileLocation::File, message))
}

impl FontFile {
    /// The font of a file, or the one of a collection that the limits choose.
    pub fn read(bytes: &[u8], limits: &Limits) -> Result<Self, ReadError> {
        let index = chosen_font(bytes, limits.index)?;
        let Some(font) = Font::new(bytes.to_vec(), index) else {
            return refuse("no-font", "the list of tables of a font is cut off or wrong");
        };
        let metrics = font.metrics();
        if metrics.raw_units_per_em == 0 {
            return refuse(
                "no-font",
                "the font's table of basic numbers (head) is missing, cut off or empty",
            );
        }
        // The library replaces an invalid number by its own, and all coordinates would be scaled by
        // it.
        if metrics.raw_units_per_em != metrics.units_per_em {
            let units = metrics.raw_units_per_em;
            return refuse(
                "units-per-em",
                format!("the em of the font has {units} units; 16 to 16384 are allowed"),
            );
        }
        if !font.charmap().has_unicode() {
            return refuse("no-characters", "the font does not say which characters its glyphs are (cmap)");
        }
        if font.outline_glyphs().is_empty() {
            return refuse("no-outlines", "the font has no outlines that can be read (glyf, CFF or CFF2)");
        }
        Ok(Self { font })
    }

    /// The same font at a position of its axes.
    pub fn at(self, axes: &[(String, f64)]) -> Result<Self, ReadError> {
        if axes.is_empty() {
            return Ok(self);
        }
        let font_axes: Vec<_> = self.font.axes().iter().collect();
        let mut place = Vec::with_capacity(axes.len());
        for (name, value) in axes {
            let tag = <[u8; 4]>::try_from(name.as_bytes()).map(|tag| Tag::new(&tag));
            let Some(axis) = font_axes.iter().find(|axis| tag.is_ok_and(|tag| axis.tag() == tag)) else {
                let names: Vec<_> = font_axes.iter().map(|axis| axis.tag().to_string()).collect();
                let has = if names.is_empty() { "it has none".to_owned() } else { names.join(", ") };
                let name = show(name.as_bytes());
                return refuse("no-axis", format!("the font has no axis {name}: {has}"));
            };
            let (low, high) = (f64::from(axis.min_value()), f64::from(axis.max_value()));
            if !(low..=high).contains(value) {
                let message =
                    format!("the axis {name} of the font goes from {low} to {high}, not to {value}");
                return refuse("axis-range", message);
            }
            // Single precision holds what a font does: 16 bits before the point.
            place.push(Variation::new(axis.tag(), *value as f32));
        }
        Ok(Self { font: self.font.instance_builder().variations(place).build() })
    }

    pub fn font(&self) -> &Font {
        &self.font
    }

    pub fn units_per_em(&self) -> u16 {
        self.font.units_per_em()
    }

    /// The distance between lines, in font units; an em if the font gives none.
    pub fn line_distance(&self) -> f64 {
        let line = self.font.metrics().h_line();
        let distance = line.map(|line| {
            let [up, down, gap] =
                [line.ascender, line.descender, line.line_gap].map(|x| f64::from(x.to_f32()));
            up - down + gap
        });
        distance.filter(|distance| *distance > 0.0).unwrap_or_else(|| f64::from(self.units_per_em()))
    }

    /// Draws the outline of a glyph, in font units.
    pub fn draw(&self, glyph: &PlacedGlyph, pen: &mut GlyphPen) -> Result<(), ReadError> {
        let failed = |why: &str| {
            let message = format!("the glyph of {} ({}) {why}", character(glyph.first_char), glyph.id);
            ReadError::new("broken-glyph", FileLocation::File, message)
        };
        let outline = self.font.outline_glyphs().get(GlyphId::new(glyph.id));
        let outline = outline.ok_or_else(|| failed("has no outline that can be read"))?;
        let drawn = outline.draw(&DrawOptions::new(), DrawMemory::Scratch, pen);
        drawn.map(|_| ()).map_err(|error| failed(&format!("cannot be drawn: {error}")))
    }
}

/// The index of the font in its file.
fn chosen_font(bytes: &[u8], index: Option<u64>) -> Result<u32, ReadError> {
    // The tag, a version of four bytes, the number of fonts.
    let count = bytes.get(8..12).filter(|_| bytes.starts_with(COLLECTION));
    let count = count.and_then(|count| count.try_into().ok()).map_or(1, u32::from_be_bytes);
    match index {
        None if count == 1 => Ok(0),
        None => {
            let message = Message::from(format!("the file is a collection of {count} fonts; "));
            refuse("several-fonts", message.setting(Setting::Index).words(" says which, counted from 0"))
        }
        Some(index) => match u32::try_from(index).ok().filter(|index| *index < count) {
            Some(index) => Ok(index),
            None => {
                refuse("no-such-font", format!("there is no font {index} in the file, which has {count}"))
            }
        },
    }
}
