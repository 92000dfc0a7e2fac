//! The slack of a field in the bound of its mesh: the distance of polygons from the curves that they replace.
use crate::MeshFailure;
use crate::mesh::request::MeshRequest;
use chordal::Bound;
use chordal::budget::advice::Message;
use chordal::implicit::Field;
use chordal::math::{add_up, greater, sub_down};

/// The largest share of a length that is reserved for the slack. Chosen: more would leave too little for the mesh, which
/// then takes more triangles; a drawing has a tolerance of its own.
const MOST_SHARE: f64 = 0.5;

/// The start of the note if the bound does not include the slack.
pub(crate) const NOT_COUNTED: &str =
    "the bound does not include the distance of straight lines from the curves that they replace";

/// A request for the mesh of a field, and the slack that its bound has to include.
pub(crate) struct SlackRequest {
    /// The request with the slack reserved.
    pub inner: MeshRequest,
    slack: f64,
    /// The reason why the slack is not included.
    why_not: Option<&'static str>,
}

impl SlackRequest {
    /// Reserves the slack, if it is known and leaves room for the mesh.
    ///
    /// # Errors
    /// If the remaining length is less than the rounding of the format.
    pub fn new(field: &Field, request: &MeshRequest) -> Result<Self, MeshFailure> {
        let slack = field.slack();
        let plain = |why_not| Ok(Self { inner: *request, slack, why_not });
        if slack == 0.0 {
            return plain(None);
        }
        if slack == f64::INFINITY {
            return plain(Some(
                "the shape was changed in a way that nothing is known of, as by a blend or a twist",
            ));
        }
        let allowed = request.budget.length_in(&request.bounds).unwrap_or(0.0);
        if slack > MOST_SHARE * allowed {
            return plain(Some("a shorter tolerance of theirs, or a larger length, leaves room for it"));
        }
        Ok(Self { inner: request.with_budget(request.reserve_rounding(slack)?), slack, why_not: None })
    }

    /// The bound including the slack, with a note.
    pub fn count(&self, bound: Bound) -> (Bound, Option<Message>) {
        let Self { inner, slack, why_not } = self;
        if *slack == 0.0 {
            return (bound, None);
        }
        let within = if slack.is_finite() { format!(", within {slack:.3e}") } else { String::new() };
        let Some(most) = bound.at_most().filter(|_| why_not.is_none()) else {
            let why = why_not.unwrap_or("points of the mesh are measured, and nothing bounds it");
            return (bound, Some(format!("{NOT_COUNTED}{within}: {why}").into()));
        };
        // The true curves may be nearer to the mesh than their lines are, by up to the slack.
        let at_least = greater(sub_down(bound.at_least(), *slack), 0.0);
        let (evidence, reference) = (bound.evidence().clone(), bound.reference.clone());
        let mut total = Bound::with_evidence(at_least, Some(add_up(most, *slack)), evidence, reference);
        total.pixels = inner.budget.pixels.and_then(|px| {
            px.view.pixels_of_two_steps(bound.pixels?, px.view.pixels_of(*slack, &inner.bounds)?)
        });
        (total.metric, total.at, total.angle_deg, total.open) =
            (bound.metric, bound.at, bound.angle_deg, bound.open);
        let note = format!(
            "the bound includes the distance of straight lines from the curves that they replace{within}; where \
             shapes are combined, a point that is on another side than with the curves is no farther than that from \
             the surface of one of them"
        );
        (total, Some(note.into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal::budget::{Evidence, Reference};
    use chordal::implicit::shapes::rectangle;
    use chordal::{Budget, Tolerance};
    use chordal_io::Format;

    fn counted(slack: f64, length: f64) -> (f64, Bound, String) {
        let field = rectangle([2.0, 1.0]).unwrap().with_slack(slack).extruded(1.0).unwrap();
        let budget = Budget::length(Tolerance::new(length).unwrap());
        let request = MeshRequest::new(budget, Format::Ply, field.bounds());
        let slack = SlackRequest::new(&field, &request).unwrap();
        let left = slack.inner.budget.length.unwrap().get();
        let mesh_bound = Bound::with_evidence(0.002, Some(left), Evidence::Proved, Reference::Field);
        let (bound, note) = slack.count(mesh_bound);
        (left, bound, note.map_or_else(String::new, |note| note.to_string()))
    }

    #[test]
    fn it_is_set_aside_first_and_added_to_both_ends() {
        let (left, bound, note) = counted(0.01, 0.1);
        assert!((0.0899..0.09 + 1e-15).contains(&left), "{left}");
        assert!(bound.at_most().unwrap() < 0.1 + 1e-15 && bound.at_most().unwrap() > 0.0999, "{bound:?}");
        assert_eq!((bound.at_least(), bound.evidence()), (0.0, &Evidence::Proved));
        assert!(note.starts_with("the bound includes") && note.contains("within 1.000e-2"), "{note}");
        let (left, bound, note) = counted(0.0, 0.1);
        assert_eq!((left, bound.at_most(), note.as_str()), (0.1, Some(0.1), ""));
    }

    #[test]
    fn what_leaves_no_room_or_is_unknown_is_told_and_not_counted() {
        for (slack, why) in [(0.06, "shorter tolerance"), (f64::INFINITY, "as by a blend")] {
            let (left, bound, note) = counted(slack, 0.1);
            assert_eq!((left, bound.at_most()), (0.1, Some(0.1)));
            assert!(note.starts_with(NOT_COUNTED) && note.contains(why), "{note}");
        }
    }
}
