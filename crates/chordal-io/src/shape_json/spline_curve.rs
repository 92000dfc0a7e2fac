//! A curve from which a surface is constructed, in JSON: a spline, a line, a circle, an arc, or a spline
//! through points.
use super::spline_numbers::{numbers, whole_degree};
use super::{check_rows, width};
use crate::grow::push;
use crate::json::{JsonKind, JsonReader};
use crate::warnings::Warnings;
use crate::{FileLocation, Limits, ReadError};
use chordal::explicit::nurbs::{InvalidNurbs, KnotVector, NurbsCurve};
use chordal::explicit::spline::Knots;

/// The default degree of a spline, or one less than the number of its points if that is lower. Chosen: what
/// most programs draw.
const CUBIC: usize = 3;

/// A curve, and the dimension of its points: in the plane, the third coordinate is 0.
pub(super) struct GivenCurve {
    pub curve: NurbsCurve<3>,
    pub dimension: usize,
    pub place: FileLocation,
}

impl GivenCurve {
    /// The curve in the plane.
    pub fn plane(&self) -> Result<NurbsCurve<2>, ReadError> {
        if self.dimension != 2 {
            let message = "3 numbers a point where 2 are needed, a radius and a height";
            return Err(ReadError::new("wrong-width", self.place.clone(), message));
        }
        let control = self.curve.control().iter().map(|[x, y, _]| [*x, *y]).collect();
        let (knots, weights) = (self.curve.knots().clone(), self.curve.weights().to_vec());
        NurbsCurve::new(knots, control, weights).map_err(|error| invalid(&self.place, &error))
    }
}

pub(super) fn invalid(place: &FileLocation, error: &InvalidNurbs) -> ReadError {
    ReadError::new("invalid-surface", place.clone(), error.to_string())
}

/// Points of two or of three numbers, the same for all.
#[derive(Default)]
struct GivenPoints {
    points: Vec<[f64; 3]>,
    dimension: usize,
}

impl GivenPoints {
    fn read(&mut self, json: &mut JsonReader, limits: &Limits) -> Result<(), ReadError> {
        json.array(|json, i| {
            check_rows(json, "points", i, limits)?;
            let next = self.point(json)?;
            push(&mut self.points, next)
        })?;
        Ok(())
    }

    fn point(&mut self, json: &mut JsonReader) -> Result<[f64; 3], ReadError> {
        let mut point = [0.0; 3];
        let n = json.array(|json, i| {
            let value = json.number()?;
            super::set(&mut point, i, value);
            Ok(())
        })?;
        if self.dimension == 0 {
            if !matches!(n, 2 | 3) {
                return Err(json.error("wrong-width", format!("{n} numbers where 2 or 3 are needed")));
            }
            self.dimension = n as usize;
        }
        if n == self.dimension as u64 {
            Ok(point)
        } else {
            Err(width(json, n, "numbers", self.dimension as u64))
        }
    }
}

/// The members of a curve object.
#[derive(Default)]
struct CurveMembers {
    given: GivenPoints,
    /// The member that names the form; `round` holds its centre and axes, if it has some.
    form: Option<&'static str>,
    round: Option<([f64; 3], [[f64; 3]; 2])>,
    angles_deg: [f64; 2],
    degree: Option<f64>,
    knots: Option<Vec<f64>>,
    weights: Option<Vec<f64>>,
}

/// Reads one curve.
pub(super) fn spline_curve(
    json: &mut JsonReader,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<GivenCurve, ReadError> {
    let mut read = CurveMembers { angles_deg: [0.0, 360.0], ..CurveMembers::default() };
    let place = json.place();
    if json.peek()? != JsonKind::Object {
        return Err(json.error("wrong-type", "a curve should stand here, an object"));
    }
    json.object(|json, key| read.member(json, key, limits, warnings))?;
    let (curve, dimension) = read.curve().map_err(|error| match error {
        Ok(error) => invalid(&place, &error),
        Err(message) => ReadError::new("invalid-surface", place.clone(), message),
    })?;
    Ok(GivenCurve { curve, dimension, place })
}

impl CurveMembers {
    fn member(
        &mut self,
        json: &mut JsonReader,
        key: &str,
        limits: &Limits,
        warnings: &mut Warnings,
    ) -> Result<(), ReadError> {
        let forms = ["control", "line", "through", "circle", "arc"];
        if let Some(form) = forms.into_iter().find(|form| *form == key) {
            if let Some(other) = self.form {
                let message = format!("a curve has \"{other}\" or \"{form}\", not both");
                return Err(json.error("mixed-forms", message));
            }
            self.form = Some(form);
            return match form {
                "circle" | "arc" => self.round(json, warnings),
                _ => self.given.read(json, limits),
            };
        }
        match key {
            "degree" => self.degree = Some(json.number()?),
            "knots" => self.knots = Some(numbers(json, limits)?),
            "weights" => self.weights = Some(numbers(json, limits)?),
            _ => {
                super::unknown(json, key, warnings);
                json.skip()?;
            }
        }
        Ok(())
    }

    fn round(&mut self, json: &mut JsonReader, warnings: &mut Warnings) -> Result<(), ReadError> {
        let (mut centre, mut axes) = (None, Vec::new());
        json.object(|json, key| {
            match key {
                "centre" => centre = Some(self.given.point(json)?),
                "axes" => {
                    let n = json.array(|json, i| {
                        let axis = self.given.point(json)?;
                        if i < 2 { push(&mut axes, axis) } else { Ok(()) }
                    })?;
                    if n != 2 {
                        return Err(width(json, n, "half-axes", 2));
                    }
                }
                "start_deg" => self.angles_deg[0] = json.number()?,
                "sweep_deg" => self.angles_deg[1] = json.number()?,
                _ => {
                    super::unknown(json, key, warnings);
                    json.skip()?;
                }
            }
            Ok(())
        })?;
        let missing = |name: &str| json.error("invalid-surface", format!("there is no member \"{name}\""));
        let centre = centre.ok_or_else(|| missing("centre"))?;
        let axes = <[[f64; 3]; 2]>::try_from(axes).map_err(|_| missing("axes"))?;
        self.round = Some((centre, axes));
        Ok(())
    }

    /// The curve, and the dimension of its points.
    fn curve(self) -> Result<(NurbsCurve<3>, usize), Result<InvalidNurbs, String>> {
        let n = self.given.points.len();
        let degree = match self.degree {
            Some(degree) => whole_degree(degree).map_err(Err)?,
            // The constructor refuses too few points.
            None => CUBIC.min(n.saturating_sub(1)).max(1),
        };
        let curve = match (self.form, self.round) {
            (Some("circle"), Some((centre, axes))) => NurbsCurve::circle(centre, axes),
            (Some("arc"), Some((centre, axes))) => {
                let [start_rad, sweep_rad] = self.angles_deg.map(f64::to_radians);
                NurbsCurve::arc(centre, axes, start_rad, sweep_rad)
            }
            (Some("line"), _) => match self.given.points[..] {
                [from, to] => NurbsCurve::line(from, to),
                _ => return Err(Err(format!("{n} points where a line has 2"))),
            },
            (Some("through"), _) => NurbsCurve::through(&self.given.points, degree, Knots::Chordal),
            (Some(_), _) => {
                let knots = match self.knots {
                    Some(knots) => KnotVector::new(degree, knots),
                    None => KnotVector::clamped(degree, n),
                };
                let weights = self.weights.unwrap_or_else(|| vec![1.0; n]);
                knots.and_then(|knots| NurbsCurve::new(knots, self.given.points, weights))
            }
            (None, _) => {
                let message =
                    "there is no member \"control\", \"line\", \"through\", \"circle\" or \"arc\" of a curve";
                return Err(Err(message.to_owned()));
            }
        };
        Ok((curve.map_err(Ok)?, self.given.dimension))
    }
}
