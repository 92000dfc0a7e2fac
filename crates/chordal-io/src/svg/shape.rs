//! The basic shapes, drawn as the paths that SVG 2 (chapter 10) defines for them.
use super::cursor::numbers;
use super::length::{LengthError, SvgLength};
use super::names::{ElementTag, Key};
use super::path_builder::PathBuilder;
use super::xml::XmlTree;
use crate::text::show;
use crate::warnings::Warnings;
use crate::{FileLocation, Limits, ReadError};
use chordal::explicit::Arc;
use chordal::math::lesser;
use std::f64::consts::{FRAC_PI_2, PI};

/// Why an element draws nothing.
#[derive(Debug)]
pub(super) enum ElementError {
    /// It was counted as a warning, or has no size.
    Skip,
    /// The file is refused.
    Refuse(ReadError),
}

impl From<ReadError> for ElementError {
    fn from(error: ReadError) -> Self {
        Self::Refuse(error)
    }
}

/// The length that a percentage refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PercentBasis {
    X,
    Y,
    Both,
}

/// Reads the numbers of one element.
pub(super) struct LengthReader<'w, 'a> {
    pub tree: &'w XmlTree<'a>,
    pub node: usize,
    /// Width and height of the viewport, if known.
    pub viewport: Option<[f64; 2]>,
    pub limits: &'w Limits,
    pub warnings: &'w mut Warnings,
    /// The total rounding of unit conversions.
    pub lost: f64,
}

impl LengthReader<'_, '_> {
    /// Handles a number that is not finite: refuses the file, or drops the element if the limits say so.
    pub fn not_finite(&mut self, place: FileLocation, what: String) -> ElementError {
        if !self.limits.drop_nonfinite {
            return ElementError::Refuse(ReadError::new("not-finite", place, what));
        }
        let message = "elements with numbers that are not finite were dropped".to_owned();
        self.warnings.count("not-finite", || (place, message));
        ElementError::Skip
    }

    /// Reads a length. `None` if it is absent, `auto`, or malformed, which is counted.
    pub fn length(&mut self, key: Key, along: PercentBasis) -> Result<Option<f64>, ElementError> {
        let tree = self.tree;
        let Some((text, start)) = tree.get(self.node, key) else { return Ok(None) };
        if text.trim() == "auto" {
            return Ok(None);
        }
        let reference = self.viewport.map(|[w, h]| match along {
            PercentBasis::X => w,
            PercentBasis::Y => h,
            PercentBasis::Both => ((w * w + h * h) / 2.0).sqrt(),
        });
        match SvgLength::read(&text) {
            Ok(length) => match length.resolve(reference) {
                Some(value) if value.is_finite() => {
                    // At most six roundings for a percentage.
                    self.lost += if length.is_exact() { 0.0 } else { 8.0 * f64::EPSILON * value.abs() };
                    Ok(Some(value))
                }
                Some(_) => {
                    let what = format!("{} is over the limit of 1.8e308", show(text.as_bytes()));
                    Err(self.not_finite(tree.place_of(start), what))
                }
                None => Err(self.unit(start, "%")),
            },
            Err(LengthError::Unit(unit)) => Err(self.unit(start, &unit)),
            Err(LengthError::Wrong(trouble)) if trouble.not_finite => {
                Err(self.not_finite(tree.place_in(&text, start, trouble.at), trouble.what))
            }
            Err(LengthError::Wrong(trouble)) => {
                self.bad(start, &trouble.what);
                Ok(None)
            }
        }
    }

    fn unit(&mut self, start: usize, unit: &str) -> ElementError {
        let tree = self.tree;
        self.warnings.count("unsupported-unit", || {
            let message =
                format!("elements with lengths in {unit}, whose size is not known here, were left out");
            (tree.place_of(start), message)
        });
        ElementError::Skip
    }

    /// Counts an ignored attribute.
    pub fn bad(&mut self, start: usize, why: &str) {
        let tree = self.tree;
        self.warnings.count("bad-attribute", || {
            (tree.place_of(start), format!("attributes that cannot be read were taken as not given: {why}"))
        });
    }

    /// Reads a size. If it is 0 or absent, nothing is drawn; if it is negative, an error is counted and
    /// nothing is drawn.
    fn size(&mut self, key: Key, along: PercentBasis) -> Result<f64, ElementError> {
        match self.length(key, along)? {
            Some(value) if value > 0.0 => Ok(value),
            Some(value) if value < 0.0 => {
                let start = self.tree.get(self.node, key).map_or(0, |found| found.1);
                self.bad(start, "a size is negative");
                Err(ElementError::Skip)
            }
            _ => Err(ElementError::Skip),
        }
    }

    /// Reads a radius; `None` if it equals the other one.
    fn radius(&mut self, key: Key, along: PercentBasis) -> Result<Option<f64>, ElementError> {
        let radius = self.length(key, along)?;
        if radius.is_some_and(|r| r < 0.0) {
            let start = self.tree.get(self.node, key).map_or(0, |found| found.1);
            self.bad(start, "a radius is negative");
            return Ok(None);
        }
        Ok(radius)
    }

    /// Draws the shape of an element.
    pub fn draw(&mut self, tag: ElementTag, pen: &mut PathBuilder) -> Result<(), ElementError> {
        match tag {
            ElementTag::Rect => self.rect(pen)?,
            ElementTag::Circle => {
                let centre = self.centre()?;
                let r = self.size(Key::R, PercentBasis::Both)?;
                ellipse(pen, centre, [r, r])?;
            }
            ElementTag::Ellipse => {
                let centre = self.centre()?;
                let [rx, ry] =
                    [self.radius(Key::Rx, PercentBasis::X)?, self.radius(Key::Ry, PercentBasis::Y)?];
                let (Some(rx), Some(ry)) = (rx.or(ry), ry.or(rx)) else { return Err(ElementError::Skip) };
                if rx == 0.0 || ry == 0.0 {
                    return Err(ElementError::Skip);
                }
                ellipse(pen, centre, [rx, ry])?;
            }
            ElementTag::Line => {
                let mut get = |key, along| self.length(key, along).map(|x| x.unwrap_or(0.0));
                let from = [get(Key::X1, PercentBasis::X)?, get(Key::Y1, PercentBasis::Y)?];
                let to = [get(Key::X2, PercentBasis::X)?, get(Key::Y2, PercentBasis::Y)?];
                pen.move_to(from)?;
                pen.line_to(to)?;
            }
            _ => self.points(tag, pen)?,
        }
        pen.end()?;
        pen.add_error_everywhere(self.lost);
        Ok(())
    }

    fn centre(&mut self) -> Result<[f64; 2], ElementError> {
        Ok([
            self.length(Key::Cx, PercentBasis::X)?.unwrap_or(0.0),
            self.length(Key::Cy, PercentBasis::Y)?.unwrap_or(0.0),
        ])
    }

    fn points(&mut self, tag: ElementTag, pen: &mut PathBuilder) -> Result<(), ElementError> {
        let tree = self.tree;
        let Some((text, start)) = tree.get(self.node, Key::Points) else { return Err(ElementError::Skip) };
        let (all, trouble) = numbers(&text);
        if let Some(trouble) = trouble {
            let place = tree.place_in(&text, start, trouble.at);
            if trouble.not_finite {
                return Err(self.not_finite(place, trouble.what));
            }
            self.warnings.count("path-error", || (place, truncated_path_message(&trouble.what)));
        }
        if all.len() % 2 == 1 {
            self.bad(start, "an odd number of coordinates, of which the last was dropped");
        }
        for (i, pair) in all.chunks_exact(2).enumerate() {
            let to = [pair[0], pair[1]];
            if i == 0 { pen.move_to(to)? } else { pen.line_to(to)? }
        }
        if tag == ElementTag::Polygon && all.len() >= 2 {
            pen.close()?;
        }
        Ok(())
    }

    fn rect(&mut self, pen: &mut PathBuilder) -> Result<(), ElementError> {
        let [x, y] = [
            self.length(Key::X, PercentBasis::X)?.unwrap_or(0.0),
            self.length(Key::Y, PercentBasis::Y)?.unwrap_or(0.0),
        ];
        let [w, h] = [self.size(Key::Width, PercentBasis::X)?, self.size(Key::Height, PercentBasis::Y)?];
        let [rx, ry] = [self.radius(Key::Rx, PercentBasis::X)?, self.radius(Key::Ry, PercentBasis::Y)?];
        let less = |a: f64, b: f64| lesser(a, b);
        let rx_used = less(rx.or(ry).unwrap_or(0.0), w / 2.0);
        let ry_used = less(ry.or(rx).unwrap_or(0.0), h / 2.0);
        let (right, bottom) = (pen.sum(x, w), pen.sum(y, h));
        if !(right.is_finite() && bottom.is_finite()) {
            let place = self.tree.place(self.node);
            return Err(
                self.not_finite(place, "the corner of a rect is over the limit of 1.8e308".to_owned())
            );
        }
        if rx_used == 0.0 || ry_used == 0.0 {
            pen.move_to([x, y])?;
            for corner in [[right, y], [right, bottom], [x, bottom]] {
                pen.line_to(corner)?;
            }
            return Ok(pen.close()?);
        }
        round_rect(pen, [[x, y], [right, bottom]], [rx_used, ry_used])
    }
}

/// Draws a rounded rectangle, clockwise on the screen from the end of the first corner, as the specification
/// says.
fn round_rect(
    pen: &mut PathBuilder,
    [[x, y], [right, bottom]]: [[f64; 2]; 2],
    [rx, ry]: [f64; 2],
) -> Result<(), ElementError> {
    let [left_in, right_in] = [pen.sum(x, rx), pen.sum(right, -rx)];
    let [top_in, bottom_in] = [pen.sum(y, ry), pen.sum(bottom, -ry)];
    // Each side ends at the arc of the next corner.
    let sides = [
        ([right_in, y], [right, top_in], [right_in, top_in]),
        ([right, bottom_in], [right_in, bottom], [right_in, bottom_in]),
        ([left_in, bottom], [x, bottom_in], [left_in, bottom_in]),
        ([x, top_in], [left_in, y], [left_in, top_in]),
    ];
    pen.move_to([left_in, y])?;
    for (i, (from, to, centre)) in (0_u8..).zip(sides) {
        if pen.at() != from {
            pen.line_to(from)?;
        }
        let start_rad = FRAC_PI_2 * (f64::from(i) - 1.0);
        quarter(
            pen,
            Arc::new(centre, [[rx, 0.0], [0.0, ry]], start_rad, FRAC_PI_2).map(|a| a.with_ends([from, to])),
        )?;
    }
    Ok(pen.close()?)
}

fn quarter(
    pen: &mut PathBuilder,
    arc: Result<Arc<2>, chordal::explicit::parametric::InvalidArc>,
) -> Result<(), ElementError> {
    match arc {
        Ok(arc) => Ok(pen.arc(arc)?),
        // The numbers are finite but their sums are not. Such a corner is beyond every budget, so it is drawn
        // square.
        Err(_) => Ok(()),
    }
}

/// Draws an ellipse: one turn from the end of the first axis.
fn ellipse(pen: &mut PathBuilder, centre: [f64; 2], [rx, ry]: [f64; 2]) -> Result<(), ElementError> {
    let start = [pen.sum(centre[0], rx), centre[1]];
    let ellipse = Arc::new(centre, [[rx, 0.0], [0.0, ry]], 0.0, 2.0 * PI).map_err(|_| ElementError::Skip)?;
    pen.move_to(start)?;
    pen.arc(ellipse.with_ends([start, start]))?;
    Ok(pen.close()?)
}

/// The message for path data that ends early because of an error.
pub(super) fn truncated_path_message(why: &str) -> String {
    format!("paths were drawn up to an error in their text, as SVG asks: {why}")
}
