//! `Typesetter`: the glyphs of a text, and their positions.
use super::font_file::FontFile;
use super::placed_glyph::{PlacedGlyph, character};
use crate::{FileLocation, ReadError};
use harfrust::{Buffer, Direction, Script, ShapeOptions, ShaperFont, shape};

/// Chooses and places glyphs by the tables of a font.
pub(super) struct Typesetter<'a> {
    font: ShaperFont<'a, 'static>,
    line_distance: f64,
    buffer: Buffer,
}

/// A part of a line in one script.
struct ScriptRun<'t> {
    text: &'t str,
    script: Option<Script>,
}

fn refuse<T>(code: &'static str, message: String) -> Result<T, ReadError> {
    Err(ReadError::new(code, FileLocation::File, message))
}

impl<'a> Typesetter<'a> {
    pub fn new(font: &'a FontFile) -> Self {
        let line_distance = font.line_distance();
        Self { font: ShaperFont::new(font.font()), line_distance, buffer: Buffer::new() }
    }

    /// The glyphs of a text, line below line; the share `align` of each line's advance lies left of 0.
    pub fn set(mut self, text: &str, align: f64) -> Result<Vec<PlacedGlyph>, ReadError> {
        let mut placed = Vec::new();
        // A line ends with a line feed, or a carriage return and a line feed.
        for (index, line) in text.lines().enumerate() {
            let y = -(index as f64) * self.line_distance;
            let first = placed.len();
            let advance = self.set_line(line, y, &mut placed)?;
            // Exact for halves of whole numbers, so that it adds nothing to the slack of the outlines.
            placed[first..].iter_mut().for_each(|glyph| glyph.at[0] -= align * advance);
        }
        Ok(placed)
    }

    /// Adds the glyphs of a line, which starts at 0. Returns its advance width.
    fn set_line(&mut self, line: &str, y: f64, placed: &mut Vec<PlacedGlyph>) -> Result<f64, ReadError> {
        let mut runs = self.runs(line);
        let directions: Vec<Direction> = runs.iter().map(|run| self.direction(run)).collect();
        let is_backward = directions.first() == Some(&Direction::RightToLeft);
        let is_mixed = directions.windows(2).any(|pair| pair[0] != pair[1]);
        // Digits run from left to right even in lines of the opposite direction.
        if is_mixed || is_backward && line.chars().any(char::is_numeric) {
            let message = "a line of the text has parts that run from left to right and parts that run from right to \
                           left: each is to be a text of its own";
            return refuse("two-directions", message.to_owned());
        }
        // The shaper sets each run by its own direction; the runs follow each other from left to
        // right, so the last one comes first.
        if is_backward {
            runs.reverse();
        }
        // Whole numbers below 2^53, therefore exact.
        let mut pen = [0_i64, 0];
        for run in runs {
            self.shape(&run)?;
            let glyphs = self.buffer.glyph_infos().iter().zip(self.buffer.glyph_positions());
            for (info, position) in glyphs {
                let first_char = run.text.get(info.cluster as usize..).and_then(|rest| rest.chars().next());
                let first_char = first_char.unwrap_or(char::REPLACEMENT_CHARACTER);
                if info.glyph_id == 0 {
                    let message = format!("the font has no glyph for {}", character(first_char));
                    return refuse("no-glyph", message);
                }
                let [x, up] = [
                    pen[0].saturating_add(i64::from(position.x_offset)),
                    pen[1].saturating_add(i64::from(position.y_offset)),
                ];
                placed.push(PlacedGlyph { id: info.glyph_id, at: [x as f64, up as f64 + y], first_char });
                pen[0] = pen[0].saturating_add(i64::from(position.x_advance));
                pen[1] = pen[1].saturating_add(i64::from(position.y_advance));
            }
        }
        Ok(pen[0] as f64)
    }

    /// The parts of a line, each in one script. Characters without a script (spaces, signs, digits) belong to
    /// the part before them, or at the start of a line to the part after them.
    fn runs<'t>(&mut self, line: &'t str) -> Vec<ScriptRun<'t>> {
        let mut runs: Vec<ScriptRun<'t>> = Vec::new();
        let mut start = 0;
        for (at, c) in line.char_indices() {
            let Some(script) = self.script(c) else { continue };
            match runs.last_mut() {
                Some(run) if run.script == Some(script) => {}
                Some(run) => {
                    run.text = &line[start..at];
                    start = at;
                    runs.push(ScriptRun { text: "", script: Some(script) });
                }
                None => runs.push(ScriptRun { text: "", script: Some(script) }),
            }
        }
        match runs.last_mut() {
            Some(run) => run.text = &line[start..],
            None => runs.push(ScriptRun { text: line, script: None }),
        }
        runs
    }

    fn script(&mut self, c: char) -> Option<Script> {
        self.buffer.reset();
        self.buffer.push(u32::from(c), 0);
        self.buffer.guess_segment_properties();
        self.buffer.script()
    }

    fn direction(&mut self, run: &ScriptRun<'_>) -> Direction {
        self.buffer.reset();
        self.buffer.set_script(run.script);
        self.buffer.guess_segment_properties();
        self.buffer.direction()
    }

    /// Shapes a part of a line; the result is in the buffer.
    fn shape(&mut self, run: &ScriptRun<'_>) -> Result<(), ReadError> {
        self.buffer.reset();
        self.buffer.push_str(run.text);
        self.buffer.set_script(run.script);
        self.buffer.guess_segment_properties();
        match shape(&self.font, &mut self.buffer, ShapeOptions::new()) {
            Err(error) => refuse("shaping", format!("the text cannot be set: {error}")),
            Ok(()) if !self.buffer.allocation_successful() => {
                refuse("shaping", "the font's rules take too much work to set the text".to_owned())
            }
            Ok(()) => Ok(()),
        }
    }
}
