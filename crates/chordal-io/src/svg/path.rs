//! Path data: parses the text of `d` with all commands, and draws it up to the first error.
use super::cursor::{SvgSyntaxError, TextCursor};
use super::path_builder::{ArcParameters, PathBuilder, PathError};

/// The control point of the last command, for a smooth command after it.
#[derive(Clone, Copy)]
enum SmoothControl {
    Cubic([f64; 2]),
    Quadratic([f64; 2]),
    Other,
}

/// A parser of path data.
struct PathParser<'a, 'p> {
    text: TextCursor<'a>,
    pen: &'p mut PathBuilder,
    last: SmoothControl,
}

/// Draws path data.
///
/// # Errors
/// At the first error in the text. Everything before it is drawn, as SVG 2 demands (9.5.4, *Error handling in
/// path data*).
pub(super) fn draw(text: &str, pen: &mut PathBuilder) -> Result<(), PathError> {
    let mut path = PathParser { text: TextCursor::new(text), pen, last: SmoothControl::Other };
    let drawn = path.commands();
    path.pen.end()?;
    drawn
}

impl PathParser<'_, '_> {
    fn commands(&mut self) -> Result<(), PathError> {
        self.text.skip_space();
        let mut is_first = true;
        while let Some(command) = self.text.peek() {
            let is_command = matches!(
                command.to_ascii_lowercase(),
                b'm' | b'l' | b'h' | b'v' | b'c' | b's' | b'q' | b't' | b'a' | b'z'
            );
            if !is_command || is_first && !matches!(command, b'm' | b'M') {
                let expected = if is_first { "a move (M or m)" } else { "a command" };
                return Err(self.text.trouble(expected).into());
            }
            is_first = false;
            self.text.step();
            self.text.skip_space();
            self.command(command)?;
            self.text.skip_space();
        }
        Ok(())
    }

    /// Reads a command with all its repetitions.
    fn command(&mut self, command: u8) -> Result<(), PathError> {
        if matches!(command, b'z' | b'Z') {
            self.last = SmoothControl::Other;
            return Ok(self.pen.close()?);
        }
        let mut command = command;
        loop {
            self.draw_command(command)?;
            // After the first point of a move, further points are lines.
            command = match command {
                b'm' => b'l',
                b'M' => b'L',
                same => same,
            };
            let comma = self.text.skip_comma();
            if !self.text.at_number() {
                return if comma { Err(self.text.trouble("a number").into()) } else { Ok(()) };
            }
        }
    }

    fn draw_command(&mut self, command: u8) -> Result<(), PathError> {
        let relative = command.is_ascii_lowercase();
        let last = std::mem::replace(&mut self.last, SmoothControl::Other);
        match command.to_ascii_lowercase() {
            b'm' => {
                let to = self.point(relative)?;
                self.pen.move_to(to)?;
                if !relative {
                    self.pen.reset_drift();
                }
            }
            b'l' => {
                let to = self.point(relative)?;
                self.pen.line_to(to)?;
            }
            b'h' => self.along(0, relative)?,
            b'v' => self.along(1, relative)?,
            b'c' => {
                let points = [self.point(relative)?, self.point(relative)?, self.point(relative)?];
                self.cubic(points)?;
            }
            b's' => {
                let [c, d] = [self.point(relative)?, self.point(relative)?];
                let b = match last {
                    SmoothControl::Cubic(before) => self.pen.mirrored(before),
                    _ => self.pen.at(),
                };
                self.cubic([b, c, d])?;
            }
            b'q' => {
                let points = [self.point(relative)?, self.point(relative)?];
                self.quadratic(points)?;
            }
            b't' => {
                let to = self.point(relative)?;
                let b = match last {
                    SmoothControl::Quadratic(before) => self.pen.mirrored(before),
                    _ => self.pen.at(),
                };
                self.quadratic([b, to])?;
            }
            _ => self.arc(relative)?,
        }
        Ok(())
    }

    /// Reads a point, after optional separators.
    fn point(&mut self, relative: bool) -> Result<[f64; 2], PathError> {
        self.text.skip_comma();
        let at = self.text.at();
        let coordinates = [self.text.number()?, self.text.next_number()?];
        let point = if relative { self.pen.relative(coordinates) } else { coordinates };
        finite(point, at)
    }

    fn along(&mut self, axis: usize, relative: bool) -> Result<(), PathError> {
        let at = self.text.at();
        let coordinate = self.text.number()?;
        let mut to = self.pen.at();
        if relative {
            let mut by = [0.0; 2];
            by[axis] = coordinate;
            to[axis] = self.pen.relative(by)[axis];
        } else {
            to[axis] = coordinate;
        }
        Ok(self.pen.line_to(finite(to, at)?)?)
    }

    fn cubic(&mut self, points: [[f64; 2]; 3]) -> Result<(), PathError> {
        self.last = SmoothControl::Cubic(points[1]);
        finite(points[0], self.text.at())?;
        Ok(self.pen.cubic_to(points)?)
    }

    fn quadratic(&mut self, points: [[f64; 2]; 2]) -> Result<(), PathError> {
        self.last = SmoothControl::Quadratic(points[0]);
        finite(points[0], self.text.at())?;
        Ok(self.pen.quadratic_to(points)?)
    }

    fn arc(&mut self, relative: bool) -> Result<(), PathError> {
        let at = self.text.at();
        let radii = [self.text.number()?, self.text.next_number()?];
        let deg = self.text.next_number()?;
        let flags = [self.text.flag()?, self.text.flag()?];
        self.text.skip_comma();
        let end_at = self.text.at();
        let coordinates = [self.text.number()?, self.text.next_number()?];
        let shape = ArcParameters { radii, deg, flags };
        let drawn = if relative {
            finite([0, 1].map(|k| self.pen.at()[k] + coordinates[k]), end_at)?;
            self.pen.arc_by(&shape, coordinates)?
        } else {
            self.pen.arc_to(&shape, finite(coordinates, end_at)?)?
        };
        if drawn {
            return Ok(());
        }
        let what = "an arc whose numbers are beyond 1e-140 … 1e140".to_owned();
        Err(PathError::Text(SvgSyntaxError { at, what, not_finite: true }))
    }
}

/// Refuses a point that is not finite: sums of finite numbers can be infinite.
fn finite(point: [f64; 2], at: usize) -> Result<[f64; 2], PathError> {
    if point.iter().all(|x| x.is_finite()) {
        return Ok(point);
    }
    let what = "a coordinate grows over the limit of 1.8e308".to_owned();
    Err(PathError::Text(SvgSyntaxError { at, what, not_finite: true }))
}
