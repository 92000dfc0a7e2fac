//! Filled regions of drawings as triangles, in the plane z = 0 with y up.
use super::request::MeshRequest;
use crate::input::drawing_regions::FilledRegions;
use crate::report::Certificate;
use crate::spec::DrawnSolid;
use crate::{MeshFailure, report::FrameFacts};
use chordal::budget::{Bounded, Failure};
use chordal::convert::{self, bevels::Bevel};
use chordal::{Bound, Job};
use chordal_io::{Drawing, Scene};

const RAISED: &str = "the drawing is raised to solids, one for each element, from z = 0 to";
const VANISHED: &str = "no triangles are left: all filled regions of the drawing are thinner than the bound";

/// The triangles of a drawing, or of the solid over it, at the precision of the format, with their bound and the request for
/// their bounding box.
pub(crate) fn fill(
    (drawing, solid): (&Drawing, Option<DrawnSolid>),
    request: &MeshRequest,
    certificate: &mut Certificate,
    job: &Job,
) -> Result<(Scene, Bound, MeshRequest), MeshFailure> {
    let filling =
        FilledRegions::from_drawing(drawing, &mut certificate.notes).map_err(MeshFailure::Refused)?;
    certificate.frame = FrameFacts::new(&filling.frame);
    let mut bounds = filling.bounds;
    if let Some(DrawnSolid { height, bevel }) = solid {
        bounds.max[2] = height;
        let bevels = bevel.map_or_else(String::new, |width| format!(", with bevels of {width} at both ends"));
        certificate.notes.push(format!("{RAISED} z = {height}{bevels}").into());
    }
    // For the box of the solid: its upper end may be farther out than the drawing, and is rounded by more then.
    let request = MeshRequest::new(request.budget, request.form(), bounds);
    let Bounded { shape: mesh, bound } = request.run(job, |budget| {
        let converted = match solid {
            Some(DrawnSolid { height, bevel: Some(width) }) => {
                convert::outlines_to_bevelled_solid(&filling.outlines, Bevel { height, width }, budget, job)
            }
            Some(DrawnSolid { height, bevel: None }) => {
                convert::outlines_to_solid(&filling.outlines, height, budget, job)
            }
            None => convert::outlines_to_mesh(&filling.outlines, budget, job),
        };
        let best = match &converted {
            Ok(converted) => Some(converted),
            Err(Failure::Unmet(best)) => Some(&**best),
            Err(_) => None,
        };
        if best.is_some_and(|best| best.shape.faces().is_empty()) {
            certificate.notes.push(VANISHED.into());
        }
        converted
    })?;
    Ok((Scene::from_mesh("drawing", mesh, filling.frame), bound, request))
}
