//! The basic shapes, drawn as SVG 2 (chapter 10) says which path each one is.
use super::cursor::numbers;
use super::length::{Length, NoLength};
use super::names::{Key, Tag};
use super::pen::Pen;
use super::xml::Tree;
use crate::text::show;
use crate::warnings::Warnings;
use crate::{Limits, Place, ReadError};
use chordal::explicit::Arc;
use std::f64::consts::{FRAC_PI_2, PI};

/// Why an element draws nothing.
#[derive(Debug)]
pub(super) enum Halt {
    /// It was counted as a warning, or has no size.
    Skip,
    /// The file is refused.
    Refuse(ReadError),
}

impl From<ReadError> for Halt {
    fn from(error: ReadError) -> Self {
        Self::Refuse(error)
    }
}

/// Against what a percentage is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Along {
    X,
    Y,
    Both,
}

/// Reads the numbers of one element.
pub(super) struct Numbers<'w, 'a> {
    pub tree: &'w Tree<'a>,
    pub node: usize,
    /// Width and height of the viewport, where they are known.
    pub viewport: Option<[f64; 2]>,
    pub limits: &'w Limits,
    pub warnings: &'w mut Warnings,
    /// What the conversion of units has rounded, all together.
    pub lost: f64,
}

impl Numbers<'_, '_> {
    /// A number that is not finite refuses the file, or drops the element where the limits say so.
    pub fn not_finite(&mut self, place: Place, what: String) -> Halt {
        if !self.limits.drop_nonfinite {
            return Halt::Refuse(ReadError::new("not-finite", place, what));
        }
        let message = "elements with numbers that are not finite were dropped".to_owned();
        self.warnings.count("not-finite", || (place, message));
        Halt::Skip
    }

    /// A length; none where it is not given, is `auto`, or is not spelled like one, which is counted.
    pub fn length(&mut self, key: Key, along: Along) -> Result<Option<f64>, Halt> {
        let tree = self.tree;
        let Some((text, start)) = tree.get(self.node, key) else { return Ok(None) };
        if text.trim() == "auto" {
            return Ok(None);
        }
        let whole = self.viewport.map(|[w, h]| match along {
            Along::X => w,
            Along::Y => h,
            Along::Both => ((w * w + h * h) / 2.0).sqrt(),
        });
        match Length::read(&text) {
            Ok(length) => match length.resolve(whole) {
                Some(value) if value.is_finite() => {
                    // At most six roundings on the way from a percentage.
                    self.lost += if length.is_exact() { 0.0 } else { 8.0 * f64::EPSILON * value.abs() };
                    Ok(Some(value))
                }
                Some(_) => {
                    let what = format!("{} is over the limit of 1.8e308", show(text.as_bytes()));
                    Err(self.not_finite(tree.place_of(start), what))
                }
                None => Err(self.unit(start, "%")),
            },
            Err(NoLength::Unit(unit)) => Err(self.unit(start, &unit)),
            Err(NoLength::Wrong(trouble)) if trouble.not_finite => {
                Err(self.not_finite(tree.place_in((&text, start), trouble.at), trouble.what))
            }
            Err(NoLength::Wrong(trouble)) => {
                self.bad(start, &trouble.what);
                Ok(None)
            }
        }
    }

    fn unit(&mut self, start: usize, unit: &str) -> Halt {
        let tree = self.tree;
        self.warnings.count("unsupported-unit", || {
            let message =
                format!("elements with lengths in {unit}, whose size is not known here, were left out");
            (tree.place_of(start), message)
        });
        Halt::Skip
    }

    /// Counts an attribute that is ignored.
    pub fn bad(&mut self, start: usize, why: &str) {
        let tree = self.tree;
        self.warnings.count("bad-attribute", || {
            (tree.place_of(start), format!("attributes that cannot be read were taken as not given: {why}"))
        });
    }

    /// A size: 0 or none draws nothing, and a negative one is an error that draws nothing.
    fn size(&mut self, key: Key, along: Along) -> Result<f64, Halt> {
        match self.length(key, along)? {
            Some(value) if value > 0.0 => Ok(value),
            Some(value) if value < 0.0 => {
                let start = self.tree.get(self.node, key).map_or(0, |found| found.1);
                self.bad(start, "a size is negative");
                Err(Halt::Skip)
            }
            _ => Err(Halt::Skip),
        }
    }

    /// A radius; none where it follows the other one.
    fn radius(&mut self, key: Key, along: Along) -> Result<Option<f64>, Halt> {
        let radius = self.length(key, along)?;
        if radius.is_some_and(|r| r < 0.0) {
            let start = self.tree.get(self.node, key).map_or(0, |found| found.1);
            self.bad(start, "a radius is negative");
            return Ok(None);
        }
        Ok(radius)
    }

    /// Draws the shape.
    pub fn draw(&mut self, tag: Tag, pen: &mut Pen) -> Result<(), Halt> {
        match tag {
            Tag::Rect => self.rect(pen)?,
            Tag::Circle => {
                let centre = self.centre()?;
                let r = self.size(Key::R, Along::Both)?;
                ellipse(pen, centre, [r, r])?;
            }
            Tag::Ellipse => {
                let centre = self.centre()?;
                let [rx, ry] = [self.radius(Key::Rx, Along::X)?, self.radius(Key::Ry, Along::Y)?];
                let (Some(rx), Some(ry)) = (rx.or(ry), ry.or(rx)) else { return Err(Halt::Skip) };
                if rx == 0.0 || ry == 0.0 {
                    return Err(Halt::Skip);
                }
                ellipse(pen, centre, [rx, ry])?;
            }
            Tag::Line => {
                let mut get = |key, along| self.length(key, along).map(|x| x.unwrap_or(0.0));
                let from = [get(Key::X1, Along::X)?, get(Key::Y1, Along::Y)?];
                let to = [get(Key::X2, Along::X)?, get(Key::Y2, Along::Y)?];
                pen.move_to(from)?;
                pen.line_to(to)?;
            }
            _ => self.points(tag, pen)?,
        }
        pen.end()?;
        pen.lose_everywhere(self.lost);
        Ok(())
    }

    fn centre(&mut self) -> Result<[f64; 2], Halt> {
        Ok([self.length(Key::Cx, Along::X)?.unwrap_or(0.0), self.length(Key::Cy, Along::Y)?.unwrap_or(0.0)])
    }

    fn points(&mut self, tag: Tag, pen: &mut Pen) -> Result<(), Halt> {
        let tree = self.tree;
        let Some((text, start)) = tree.get(self.node, Key::Points) else { return Err(Halt::Skip) };
        let (all, trouble) = numbers(&text);
        if let Some(trouble) = trouble {
            let place = tree.place_in((&text, start), trouble.at);
            if trouble.not_finite {
                return Err(self.not_finite(place, trouble.what));
            }
            self.warnings.count("path-error", || (place, super::walk::cut_short(&trouble.what)));
        }
        if all.len() % 2 == 1 {
            self.bad(start, "an odd number of coordinates, of which the last was dropped");
        }
        for (i, pair) in all.chunks_exact(2).enumerate() {
            let to = [pair[0], pair[1]];
            if i == 0 { pen.move_to(to)? } else { pen.line_to(to)? }
        }
        if tag == Tag::Polygon && all.len() >= 2 {
            pen.close()?;
        }
        Ok(())
    }

    fn rect(&mut self, pen: &mut Pen) -> Result<(), Halt> {
        let [x, y] =
            [self.length(Key::X, Along::X)?.unwrap_or(0.0), self.length(Key::Y, Along::Y)?.unwrap_or(0.0)];
        let [w, h] = [self.size(Key::Width, Along::X)?, self.size(Key::Height, Along::Y)?];
        let [rx, ry] = [self.radius(Key::Rx, Along::X)?, self.radius(Key::Ry, Along::Y)?];
        let less = |a: f64, b: f64| if a < b { a } else { b };
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

/// Clockwise on the screen from the end of the first corner, as the specification says.
fn round_rect(
    pen: &mut Pen,
    [[x, y], [right, bottom]]: [[f64; 2]; 2],
    [rx, ry]: [f64; 2],
) -> Result<(), Halt> {
    let [left_in, right_in] = [pen.sum(x, rx), pen.sum(right, -rx)];
    let [top_in, bottom_in] = [pen.sum(y, ry), pen.sum(bottom, -ry)];
    // Each side runs to where the arc of the corner after it begins.
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

fn quarter(pen: &mut Pen, arc: Result<Arc<2>, chordal::explicit::InvalidArc>) -> Result<(), Halt> {
    match arc {
        Ok(arc) => Ok(pen.arc(arc)?),
        // Finite numbers whose sums are not: such a corner is beyond every budget, and its square is drawn.
        Err(_) => Ok(()),
    }
}

/// One turn from the end of the first axis.
fn ellipse(pen: &mut Pen, centre: [f64; 2], [rx, ry]: [f64; 2]) -> Result<(), Halt> {
    let start = [pen.sum(centre[0], rx), centre[1]];
    let whole = Arc::new(centre, [[rx, 0.0], [0.0, ry]], 0.0, 2.0 * PI).map_err(|_| Halt::Skip)?;
    pen.move_to(start)?;
    pen.arc(whole.with_ends([start, start]))?;
    Ok(pen.close()?)
}
