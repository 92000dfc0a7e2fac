//! Surfaces constructed from curves, in JSON: lofts, Coons patches, sweeps, extrusions, revolutions and ruled surfaces.
use super::spline_curve::{GivenCurve, invalid, spline_curve};
use super::spline_numbers::whole_degree;
use super::{check_rows, point, width};
use crate::grow::push;
use crate::json::JsonReader;
use crate::warnings::Warnings;
use crate::{FileLocation, Limits, ReadError};
use chordal::budget::Failure;
use chordal::convert::curve_to_swept_surface;
use chordal::convert::sweeps::{ProfilePlace, SweepPath};
use chordal::explicit::CurveEnds;
use chordal::explicit::nurbs::{InvalidNurbs, NurbsCurve, NurbsSurface};
use chordal::math::{Box3, greater};
use chordal::{Job, Tolerance};

/// The members of a surface that construct it.
pub(super) const CONSTRUCTIONS: [&str; 6] = ["loft", "coons", "sweep", "extrude", "revolve", "ruled"];

/// The default degree of a loft, or one less than the number of its sections if that is lower. Chosen:
/// continuous curvature.
const CUBIC: usize = 3;
/// The default tolerance of a sweep, relative to the diagonal of path and profile. Chosen: a thousandth of
/// the usual tolerance of triangles, and some 20 pieces for a turn of a helix.
const NEAR: f64 = 1e-6;

struct ConstructionReader<'a, 'b> {
    json: &'a mut JsonReader<'b>,
    limits: &'a Limits,
    warnings: &'a mut Warnings,
}

/// Reads the value of a member that constructs a surface.
pub(super) fn construction(
    json: &mut JsonReader,
    kind: &str,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<NurbsSurface, ReadError> {
    let mut reader = ConstructionReader { json, limits, warnings };
    match kind {
        "loft" => reader.loft(),
        "coons" => reader.coons(),
        "sweep" => reader.sweep(),
        "extrude" => reader.extrude(),
        "revolve" => reader.revolve(),
        _ => reader.ruled(),
    }
}

/// Adds the slack of a surface whose coordinates are each a rounded sum or product of two given ones, and
/// whose weights are products with rounded square roots.
fn rounded(surface: NurbsSurface) -> NurbsSurface {
    let reach = surface.control().as_flattened().iter().fold(0.0, |most: f64, x| greater(x.abs(), most));
    // Derived: half a rounding for each of three coordinates; two for a weight, which move a point by up to
    // twice its reach.
    surface.with_slack(8.0 * f64::EPSILON * reach)
}

impl ConstructionReader<'_, '_> {
    fn curve(&mut self) -> Result<GivenCurve, ReadError> {
        spline_curve(self.json, self.limits, self.warnings)
    }

    fn curves(&mut self) -> Result<Vec<GivenCurve>, ReadError> {
        let mut curves = Vec::new();
        let (limits, warnings) = (self.limits, &mut *self.warnings);
        self.json.array(|json, i| {
            check_rows(json, "curves", i, limits)?;
            push(&mut curves, spline_curve(json, limits, warnings)?)
        })?;
        Ok(curves)
    }

    /// Two curves.
    fn pair(&mut self) -> Result<[NurbsCurve<3>; 2], ReadError> {
        let curves: Vec<NurbsCurve<3>> = self.curves()?.into_iter().map(|given| given.curve).collect();
        let n = curves.len() as u64;
        <[NurbsCurve<3>; 2]>::try_from(curves).map_err(|_| width(self.json, n, "curves", 2))
    }

    /// Reads an object. `read` reads the members that it knows, and returns false for others.
    fn members(
        &mut self,
        mut read: impl FnMut(&mut ConstructionReader<'_, '_>, &str) -> Result<bool, ReadError>,
    ) -> Result<FileLocation, ReadError> {
        let place = self.json.place();
        let (limits, warnings) = (self.limits, &mut *self.warnings);
        self.json.object(|json, key| {
            let mut inner = ConstructionReader { json, limits, warnings };
            if !read(&mut inner, key)? {
                super::unknown(inner.json, key, inner.warnings);
                inner.json.skip()?;
            }
            Ok(())
        })?;
        Ok(place)
    }

    fn loft(&mut self) -> Result<NurbsSurface, ReadError> {
        let (mut sections, mut degree, mut closed) = (None, None, false);
        let place = self.members(|this, key| {
            match key {
                "sections" => sections = Some(this.curves()?),
                "degree" => degree = Some(this.json.number()?),
                "closed" => closed = this.json.flag()?,
                _ => return Ok(false),
            }
            Ok(true)
        })?;
        let sections = sections.ok_or_else(|| missing(&place, "sections"))?;
        let degree = match degree {
            Some(degree) => whole_degree(degree)
                .map_err(|error| ReadError::new("invalid-surface", place.clone(), error))?,
            None => {
                let most = CUBIC.min(sections.len().saturating_sub(1)).max(1);
                // A closed curve needs an odd degree.
                if closed && most == 2 { 1 } else { most }
            }
        };
        let curves: Vec<NurbsCurve<3>> = sections.into_iter().map(|given| given.curve).collect();
        let surface = NurbsSurface::lofted(&curves, degree, CurveEnds::from(closed));
        surface.map_err(|error| {
            let few = matches!(error, InvalidNurbs::TooFew { .. });
            if !few {
                return invalid(&place, &error);
            }
            let message = format!(
                "degree {degree} needs {} sections at least, and there are {}",
                degree + 1,
                curves.len()
            );
            ReadError::new("invalid-surface", place.clone(), message)
        })
    }

    fn coons(&mut self) -> Result<NurbsSurface, ReadError> {
        let (mut along_u, mut along_v) = (None, None);
        let place = self.members(|this, key| {
            match key {
                "u" => along_u = Some(this.pair()?),
                "v" => along_v = Some(this.pair()?),
                _ => return Ok(false),
            }
            Ok(true)
        })?;
        let along_u = along_u.ok_or_else(|| missing(&place, "u"))?;
        let along_v = along_v.ok_or_else(|| missing(&place, "v"))?;
        NurbsSurface::coons(along_u.each_ref(), along_v.each_ref()).map_err(|error| invalid(&place, &error))
    }

    fn extrude(&mut self) -> Result<NurbsSurface, ReadError> {
        let (mut profile, mut along) = (None, None);
        let place = self.members(|this, key| {
            match key {
                "profile" => profile = Some(this.curve()?),
                "along" => along = Some(point(this.json)?),
                _ => return Ok(false),
            }
            Ok(true)
        })?;
        let profile = profile.ok_or_else(|| missing(&place, "profile"))?;
        let along = along.ok_or_else(|| missing(&place, "along"))?;
        if along == [0.0; 3] {
            return Err(ReadError::new(
                "invalid-surface",
                place,
                "\"along\" is [0, 0, 0], which extrudes nothing",
            ));
        }
        let surface = NurbsSurface::extruded(&profile.curve, along);
        surface.map(rounded).map_err(|error| invalid(&place, &error))
    }

    fn revolve(&mut self) -> Result<NurbsSurface, ReadError> {
        let mut profile = None;
        let place = self.members(|this, key| {
            if key == "profile" {
                profile = Some(this.curve()?);
            }
            Ok(key == "profile")
        })?;
        let profile = profile.ok_or_else(|| missing(&place, "profile"))?.plane()?;
        NurbsSurface::revolved(&profile).map(rounded).map_err(|error| invalid(&place, &error))
    }

    /// A loft of two sections, whose knots may differ.
    fn ruled(&mut self) -> Result<NurbsSurface, ReadError> {
        let place = self.json.place();
        let pair = self.pair()?;
        let surface = if pair[0].knots() == pair[1].knots() {
            NurbsSurface::ruled(&pair[0], &pair[1])
        } else {
            // A loft of degree 1 is the ruled surface between the compatible curves, and it counts the
            // rounding of `compatible`.
            NurbsSurface::lofted(&pair, 1, CurveEnds::Open)
        };
        surface.map_err(|error| invalid(&place, &error))
    }

    fn sweep(&mut self) -> Result<NurbsSurface, ReadError> {
        let (mut profile, mut path, mut up, mut tolerance) = (None, None, None, None);
        let place = self.members(|this, key| {
            match key {
                "profile" => profile = Some(this.curve()?),
                "path" => path = Some(this.curve()?),
                "up" => up = Some(point(this.json)?),
                "tolerance" => {
                    let length = Tolerance::new(this.json.number()?);
                    let length = length.map_err(|error| this.json.error("wrong-value", error.to_string()))?;
                    tolerance = Some(length);
                }
                _ => return Ok(false),
            }
            Ok(true)
        })?;
        let profile = profile.ok_or_else(|| missing(&place, "profile"))?;
        let path = path.ok_or_else(|| missing(&place, "path"))?.curve;
        let wrong = |message: String| ReadError::new("invalid-surface", place.clone(), message);
        let tolerance = match tolerance {
            Some(tolerance) => tolerance,
            None => {
                let diagonal = |curve: &NurbsCurve<3>| Box3::from_points(curve.control()).diagonal();
                let size = diagonal(&path) + diagonal(&profile.curve);
                Tolerance::new(NEAR * size)
                    .map_err(|_| wrong("the path and the profile have no size".to_owned()))?
            }
        };
        let place_of_profile =
            if profile.dimension == 2 { ProfilePlace::OnPath } else { ProfilePlace::InSpace };
        let sweep = SweepPath { path, up, place: place_of_profile };
        match curve_to_swept_surface(&profile.curve, &sweep, tolerance, &Job::default()) {
            Ok(made) => Ok(made.shape),
            Err(Failure::Unmet(best)) => Err(wrong(format!(
                "the sweep is known to {:.3e} only, and its tolerance is {:e}",
                best.shape.slack(),
                tolerance.get()
            ))),
            Err(Failure::Refused(refusal)) => {
                Err(ReadError::new("invalid-surface", place.clone(), refusal.message))
            }
            Err(Failure::Cancelled) => Err(wrong("the sweep was cancelled".to_owned())),
        }
    }
}

fn missing(place: &FileLocation, name: &str) -> ReadError {
    ReadError::new("invalid-surface", place.clone(), format!("there is no member \"{name}\""))
}
