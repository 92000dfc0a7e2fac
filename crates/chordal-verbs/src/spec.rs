//! `BudgetSpec`: a budget as a user requests it, before the shape is known; and the time limit, which is the same in every
//! front end. Front ends measure the time: there is no clock here.
use crate::formats::extensions_where;
use crate::mesh::offset::SolidOffset;
use crate::{Input, MeshFailure, Normals, Shape};
use chordal::budget::advice::{Message, Setting};
use chordal::budget::attributes::AttributeLimits;
use chordal::budget::proof::ProofEffort;
use chordal::budget::{Budget, Length, PixelBudget, Refusal, RefusalCode, RequiredEvidence, digits};
use chordal::convert::Spacing;
use chordal::lod::count::Effort;
use chordal_io::Format;
use std::time::Duration;

/// A budget whose length can be a percentage or have a unit.
///
/// ```
/// use chordal_verbs::BudgetSpec;
/// let spec = BudgetSpec { length: Some("0.05%".parse()?), ..BudgetSpec::default() };
/// assert!(spec.has_limit());
/// # Ok::<(), chordal::budget::InvalidLength>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BudgetSpec {
    /// The largest distance to the true shape.
    pub length: Option<Length>,
    /// The largest distance on the screen of a view.
    pub pixels: Option<PixelBudget>,
    /// The largest angle between the normals of the triangles and those of the shape, in degrees.
    pub angle_deg: Option<f64>,
    /// The largest deviations of the attributes of triangles from those of the input.
    pub attributes: AttributeLimits,
    /// The most triangles.
    pub triangles: Option<u64>,
    /// The most segments of polylines, all together.
    pub segments: Option<u64>,
    /// How segment ends are spaced on curves.
    pub spacing: Spacing,
    /// The work that a triangle count is worth when triangles are simplified.
    pub effort: Effort,
    /// The height to which a drawing is raised to a solid; without it the drawing is meshed in its plane.
    pub extrude: Option<Length>,
    /// The width of the bevels at 45° along the edges of that solid; without it they stay sharp.
    pub bevel: Option<Length>,
    /// Another surface of the solid that triangles bound.
    pub offset: Option<SolidOffset>,
    /// The normals of the triangles.
    pub normals: Normals,
    /// The required evidence. The default is a proof; for a field with a part whose ranges are unknown, a
    /// user function without a Lipschitz constant, it is a measurement.
    pub require: Option<RequiredEvidence>,
}

/// The solid over a drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DrawnSolid {
    pub height: f64,
    /// The width of the bevels along its edges.
    pub bevel: Option<f64>,
}

impl BudgetSpec {
    /// Whether it has a limit within which a mesh or polylines can be built.
    #[must_use]
    pub fn has_limit(&self) -> bool {
        let counted = self.triangles.is_some() || self.segments.is_some();
        counted || self.length.is_some() || self.pixels.is_some()
    }

    /// The solid over a drawing, if a height is set.
    ///
    /// # Errors
    /// If a height is set and the output has no triangles or the shape is not a drawing; as for [`Self::resolve`].
    pub(crate) fn solid(&self, shape: &Shape, lines: bool) -> Result<Option<DrawnSolid>, MeshFailure> {
        let Some(height) = self.extrude else {
            let message = "a bevel needs a solid, and the drawing is not raised to one";
            return if self.bevel.is_some() { Err(MeshFailure::Usage(message.into())) } else { Ok(None) };
        };
        if lines {
            let message = "polylines have no height: for a solid write a format of triangles";
            return Err(MeshFailure::Usage(message.into()));
        }
        if !matches!(shape, Shape::Drawing(_)) {
            let message =
                format!("only drawings and letters are raised to a height, and this is {}", shape.kind());
            return Err(MeshFailure::Usage(message.into()));
        }
        let bevel = self.bevel.map(|bevel| resolved(bevel, shape)).transpose()?;
        Ok(Some(DrawnSolid { height: resolved(height, shape)?, bevel }))
    }

    /// The same spec with a length, if nothing else limits the error of an offset: a twentieth of the distance.
    #[must_use]
    pub fn with_usual_length(&self) -> Self {
        let length =
            self.length.or(self.offset.filter(|_| !self.has_limit()).map(SolidOffset::default_length));
        Self { length, ..*self }
    }

    /// Takes the numbers of an STL, which has no unit, as millimetres if a length of an offset has a unit, as programs for
    /// printers do.
    /// Returns a sentence on it.
    pub(crate) fn usual_unit(&self, input: &mut Input) -> Option<Message> {
        let lengths = [self.length, self.offset.map(SolidOffset::distance)];
        let has_unit = lengths.iter().any(|length| matches!(length, Some(Length::In(..))));
        match &mut input.shape {
            Shape::Scene(scene)
                if self.offset.is_some()
                    && has_unit
                    && input.format == Format::Stl
                    && scene.frame.metres_per_unit.is_none() =>
            {
                scene.frame.metres_per_unit = Some(MILLIMETRE);
                let message = Message::from("an STL has no unit: its numbers were taken as millimetres; ");
                Some(message.value(Setting::Unit, "cm").words(" and the like say otherwise"))
            }
            _ => None,
        }
    }

    /// The offset and its distance.
    ///
    /// # Errors
    /// If the shape has no triangles; as for [`Self::resolve`].
    pub(crate) fn resolve_offset(&self, shape: &Shape) -> Result<Option<(SolidOffset, f64)>, MeshFailure> {
        let Some(offset) = self.offset else { return Ok(None) };
        if !matches!(shape, Shape::Scene(_)) {
            let message = format!(
                "only solids of triangles are offset or made hollow, and this is {}: in a script, offset(shape, distance) and \
                 shell(shape, wall) are the same",
                shape.kind()
            );
            let message = Message::from(message);
            return Err(MeshFailure::Usage(match shape {
                Shape::Cage(_) => message
                    .words("; ")
                    .value(Setting::Surface, "faceted")
                    .words(" reads a cage's polygons as triangles"),
                _ => message,
            }));
        }
        if self.angle_deg.is_some() || self.attributes.is_set() {
            let message = "an offset has no normals and texture coordinates of its own to be near: it takes a length or pixels";
            return Err(MeshFailure::refused(RefusalCode::Budget, message));
        }
        Ok(Some((offset, resolved(offset.distance(), shape)?)))
    }

    /// Checks that counts apply: polylines have segments and meshes have triangles.
    pub(crate) fn check_counts(&self, lines: bool) -> Result<(), Message> {
        let wrong = match (lines, self.triangles, self.segments) {
            (true, Some(n), _) => {
                let what = Message::from("polylines have no triangles: ");
                what.value(Setting::Segments, n).words(" limits their segments")
            }
            (false, _, Some(n)) => {
                let what = Message::from("triangles have no segments: ");
                let names = extensions_where(Format::holds_polylines, "or");
                what.value(Setting::Triangles, n)
                    .words(format_args!(" limits them; for polylines write {names}"))
            }
            _ => return Ok(()),
        };
        Err(wrong)
    }

    /// Checks that limits on attributes apply: the shape has triangles, and a length or pixels are limited, too.
    pub(crate) fn check_attributes(&self, shape: &Shape) -> Result<(), MeshFailure> {
        if !self.attributes.is_set() {
            return Ok(());
        }
        let message = if !matches!(shape, Shape::Scene(_)) {
            "limits on texture coordinates and normals apply only to triangles that have these attributes: this shape gets new ones"
        } else if self.length.is_none() && self.pixels.is_none() {
            "limits on texture coordinates and normals need a length or pixels beside them"
        } else {
            return Ok(());
        };
        Err(MeshFailure::refused(RefusalCode::Budget, message))
    }

    /// The evidence that a mesh or polylines of this shape need.
    fn required_of(&self, shape: &Shape) -> RequiredEvidence {
        self.require.unwrap_or(match shape {
            Shape::Field(implicit) if implicit.field.evidence().bounds_above() => {
                RequiredEvidence::ProvedOrMeasured
            }
            Shape::Field(_) => RequiredEvidence::Measured,
            _ if self.offset.is_some() => RequiredEvidence::ProvedOrMeasured,
            _ => RequiredEvidence::Proved,
        })
    }

    /// Resolves the budget for one shape. Returns a sentence on the length if it was converted.
    ///
    /// # Errors
    /// If the length has a unit and the shape has none, or it is a percentage and the shape has no size.
    pub fn resolve(&self, shape: &Shape) -> Result<(Budget, Option<Message>), MeshFailure> {
        let mut budget = Budget {
            pixels: self.pixels,
            angle_deg: self.angle_deg,
            attributes: self.attributes,
            triangles: self.triangles,
            segments: self.segments,
            require: self.required_of(shape),
            ..Budget::default()
        };
        let Some(length) = self.length else { return Ok((budget, None)) };
        let diagonal = if matches!(length, Length::Percent(_)) { shape.diagonal()? } else { 0.0 };
        if matches!(length, Length::Percent(_)) && diagonal <= 0.0 {
            let message = format!("the shape has no size, so {length} of it is no length: give one in units");
            return Err(MeshFailure::Refused(Refusal::new(RefusalCode::Empty, message)));
        }
        let tolerance =
            length.resolve(diagonal, shape.frame().metres_per_unit).map_err(MeshFailure::Length)?;
        budget.length = Some(tolerance);
        let note = match length {
            Length::Plain(_) => None,
            Length::In(..) => Some(format!("{length} is {tolerance} in the units of the input")),
            Length::Percent(_) => Some(format!(
                "{length} of the diagonal, which is {} or a little more, is {tolerance}",
                digits(diagonal)
            )),
        };
        Ok((budget, note.map(Message::from)))
    }
}

/// A length in the units of a shape.
fn resolved(length: Length, shape: &Shape) -> Result<f64, MeshFailure> {
    let diagonal = if matches!(length, Length::Percent(_)) { shape.diagonal()? } else { 0.0 };
    let resolved = length.resolve(diagonal, shape.frame().metres_per_unit);
    Ok(resolved.map_err(MeshFailure::Length)?.get())
}

/// In metres.
const MILLIMETRE: f64 = 1e-3;

/// The default time after which the best result is taken. Chosen: nobody waits longer for a part without a sign of progress.
const USUAL: Duration = Duration::from_secs(60);

/// The time after which a front end has to tell a job for a shape to finish ([`Job::finish`](chordal::Job::finish)): the
/// given time, or the default. An explicitly requested proof has no limit unless one is given, and other shapes than fields
/// have none.
#[must_use]
pub fn time_limit(
    shape: &Shape,
    given: Option<Duration>,
    require: Option<RequiredEvidence>,
    effort: ProofEffort,
) -> Option<Duration> {
    let is_unlimited = require == Some(RequiredEvidence::Proved) || effort == ProofEffort::Full;
    let default_time = (!is_unlimited).then_some(USUAL);
    given.or(default_time).filter(|_| matches!(shape, Shape::Field(_)))
}

/// Parses a time.
///
/// # Errors
/// A sentence, if the text is not a time above 0.
///
/// ```
/// use std::time::Duration;
/// assert_eq!(chordal_verbs::parse_time("2m"), Ok(Duration::from_secs(120)));
/// assert!(chordal_verbs::parse_time("5").is_err());
/// ```
pub fn parse_time(text: &str) -> Result<Duration, String> {
    // `ms` first, since it ends in `s` as well.
    let units = [("ms", 1e-3), ("s", 1.0), ("m", 60.0)];
    let split = units.iter().find_map(|(unit, seconds)| Some((text.strip_suffix(unit)?, seconds)));
    let seconds = split.and_then(|(number, seconds)| Some(number.trim().parse::<f64>().ok()? * seconds));
    let time = seconds.filter(|seconds| *seconds > 0.0).and_then(|s| Duration::try_from_secs_f64(s).ok());
    time.ok_or_else(|| "a time is a number above 0 and a unit, as in 20s, 2m or 500ms".into())
}
