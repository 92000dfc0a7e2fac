//! Fields as verbs meet them: cut off at a region, meshed within a budget, measured against triangles.
use crate::MeshFailure;
use crate::request::MeshRequest;
use chordal::budget::{Bound, RefusalCode};
use chordal::check::{self, FieldDeviation, Goal};
use chordal::implicit::Field;
use chordal::math::Box3;
use chordal::{Bounded, Job, Mesh, convert};
use chordal_io::{Format, Frame, Scene};
use serde::Serialize;

/// A field with the part of space that it is looked at in.
#[derive(Clone, Debug)]
pub struct ImplicitShape {
    /// The rule.
    pub field: Field,
    /// The box that the shape is cut off at, where somebody asked for one.
    pub region: Option<Box3>,
    /// The space that it is in.
    pub frame: Frame,
    /// What its script can be given, if it has one.
    pub parameters: Vec<Parameter>,
}

/// A number that a script can be given.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// What it is when nobody sets it.
    pub default: f64,
    /// What it is.
    pub value: f64,
}

impl ImplicitShape {
    /// The box that holds all that there is of the shape: what is known of the field, cut off at the region. Infinite
    /// where neither says.
    #[must_use]
    pub fn place(&self) -> Box3 {
        let known = self.field.bounds();
        let Some(region) = self.region else { return known };
        let pick = |a: [f64; 3], b: [f64; 3], first: fn(f64, f64) -> bool| {
            std::array::from_fn(|k| if first(a[k], b[k]) { a[k] } else { b[k] })
        };
        Box3 {
            min: pick(known.min, region.min, |a, b| a > b),
            max: pick(known.max, region.max, |a, b| a < b),
        }
    }

    /// The field with what the region leaves of it, closed by its sides; a shape of the plane stays one.
    #[must_use]
    pub fn clip_to_region(&self) -> Field {
        let Some(region) = self.region else { return self.field.clone() };
        let flat = !self.field.tape().axes()[2];
        if flat { self.field.cropped(region) } else { self.field.clipped(region) }
    }

    /// The same as a solid: a shape of the plane goes from the bottom of the region to its top.
    #[must_use]
    pub fn solid(&self) -> Field {
        self.region.map_or_else(|| self.field.clone(), |region| self.field.clipped(region))
    }
}

/// The surface of a field as the format will hold it, with its bound.
///
/// # Errors
/// When the field is endless; as for [`convert::field_to_mesh`].
pub(crate) fn mesh_field(
    implicit: &ImplicitShape,
    request: &MeshRequest,
    notes: &mut Vec<String>,
    job: &Job,
) -> Result<(Scene, Bound), MeshFailure> {
    let field = finite(implicit)?;
    let Bounded { shape: mesh, bound } =
        request.run(job, |budget| convert::field_to_mesh(&field, budget, job))?;
    if let Some(region) = implicit.region {
        let [low, high] = [region.min, region.max];
        notes.push(format!("the shape is cut off at the box from {low:?} to {high:?}, and closed there"));
    }
    // Where normals are for: other formats keep one row a vertex.
    let shaded = matches!(request.to, Format::Glb | Format::Obj);
    let mesh = if shaded { convert::with_gradient_normals(&mesh, &field, job)? } else { mesh };
    Ok((Scene::from_mesh("field", mesh, true, implicit.frame), bound))
}

/// Coordinates up to this have squares, and sums of them, that are finite: derived, 2^1024 is the end of the numbers.
const LARGEST: f64 = 1e150;

/// What is said of a field that cannot be meshed for want of an end.
pub(crate) const ENDLESS: &str = "the shape has no end in some direction: cut it off at a box \
                                  (--region \"-1,-1,-1 1,1,1\", in Python within())";

/// The field cut off at its region.
///
/// # Errors
/// When it has no end in some direction, or reaches so far that numbers overflow.
pub(crate) fn finite(implicit: &ImplicitShape) -> Result<Field, MeshFailure> {
    let field = implicit.solid();
    let bounds = field.bounds();
    if let Some(far) = bounds.min.iter().chain(&bounds.max).find(|x| x.is_finite() && x.abs() > LARGEST) {
        let message = format!(
            "the shape reaches to {far:e}, and squares of coordinates beyond {LARGEST:e} are no numbers any more: scale it down"
        );
        return Err(MeshFailure::refused(RefusalCode::NotFinite, message));
    }
    if bounds.is_empty() {
        return Err(MeshFailure::refused(
            RefusalCode::Empty,
            "there is no surface: nothing of the shape is within its box",
        ));
    }
    if !bounds.diagonal().is_finite() {
        return Err(MeshFailure::refused(RefusalCode::Unsupported, ENDLESS));
    }
    Ok(field)
}

/// How far triangles are from the surface of a field.
pub(crate) fn deviation_of(
    mesh: &Mesh,
    implicit: &ImplicitShape,
    goal: &Goal,
    job: &Job,
) -> Result<FieldDeviation, MeshFailure> {
    Ok(check::field_deviation(mesh, &finite(implicit)?, goal, job)?)
}
