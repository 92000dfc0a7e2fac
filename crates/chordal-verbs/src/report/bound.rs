//! The bound in the report.
use chordal::budget::proof::{OpenPlace, OpenPlaces, SurfaceContact};
use chordal::{Bound, Evidence};
use serde::Serialize;
use std::fmt;

/// A [`Bound`] in the report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BoundFacts {
    /// The distance is at least this.
    pub at_least: f64,
    /// The distance is at most this; `None` without an upper bound.
    pub at_most: Option<f64>,
    /// The distance on the screen is at most this many pixels; `None` without a view.
    pub pixels: Option<f64>,
    /// The largest measured angle between a triangle's normal and the shape's, in degrees; present if an angle was
    /// requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle_deg: Option<f64>,
    /// "proved", "proved-if", "measured" or "estimated".
    pub evidence: &'static str,
    /// The assumptions of a proof, for "proved-if".
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub assumptions: Vec<String>,
    /// The number of samples, for "measured".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples: Option<u64>,
    /// The metric of the distance.
    pub metric: &'static str,
    /// The reference: the true shape.
    pub reference: &'static str,
    /// The point of the largest known loss.
    pub at: Option<[f64; 3]>,
    /// The places that a proof within a length left open; present if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub open: Option<OpenPlacesFacts>,
}

/// The places that a proof left open, in the report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OpenPlacesFacts {
    /// How many there are.
    pub count: u64,
    /// The area of their triangles.
    pub area: f64,
    /// The area of all triangles.
    pub whole_area: f64,
    /// The largest places, in this order.
    pub largest: Vec<OpenPlaceFacts>,
}

/// One place that a proof left open.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OpenPlaceFacts {
    /// The middle of its box.
    pub at: [f64; 3],
    /// The diagonal of its box.
    pub size: f64,
    /// The area of its triangles; 0 if a part of the true shape may have no triangles near it.
    pub area: f64,
    /// A point where two surfaces touch; present if one was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact: Option<ContactFacts>,
}

/// A point where two surfaces touch, in the report.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ContactFacts {
    /// `tangent`: from opposite sides; `flush`: from one side, as faces that coincide.
    pub kind: &'static str,
    /// The point.
    pub at: [f64; 3],
    /// The lines of the script that made the two surfaces; present if they are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lines: Option<[u64; 2]>,
}

/// The kind of contacts from opposite sides.
const TANGENT: &str = "tangent";

impl ContactFacts {
    fn new(contact: SurfaceContact) -> Self {
        let kind = if contact.is_flush { "flush" } else { TANGENT };
        Self { kind, at: contact.at, lines: contact.lines }
    }

    fn is_tangent(&self) -> bool {
        self.kind == TANGENT
    }

    fn contact(self) -> SurfaceContact {
        SurfaceContact { at: self.at, is_flush: !self.is_tangent(), lines: self.lines }
    }
}

impl OpenPlacesFacts {
    pub(crate) fn new(places: &OpenPlaces) -> Self {
        let facts = |place: &OpenPlace| OpenPlaceFacts {
            at: place.at,
            size: place.size,
            area: place.area,
            contact: place.contact.map(ContactFacts::new),
        };
        Self {
            count: places.count,
            area: places.area,
            whole_area: places.whole_area,
            largest: places.largest.iter().map(facts).collect(),
        }
    }

    /// `not proved at 2 places …`, or, if no place is open, why nothing is proved.
    pub(crate) fn why_unproved(&self) -> String {
        let at = if self.count == 0 { ":" } else { " at" };
        format!("not proved{at} {self}")
    }
}

impl fmt::Display for OpenPlacesFacts {
    /// `2 places (0.05% of the area), the largest 1.200 across, about (3.0000, 4.0000, 0.5000)`, with a contact of surfaces
    /// if there is one; if no place is open, the reason why nothing is proved nevertheless.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.count == 0 {
            return f.write_str(
                "no place is open, and yet a point is farther away than the length to prove: a promise about the \
                 shape does not hold",
            );
        }
        let places = if self.count == 1 { "place" } else { "places" };
        write!(f, "{} {places} ({} of the area)", self.count, share(self.area, self.whole_area))?;
        let Some(place) = self.largest.first() else { return Ok(()) };
        let [x, y, z] = place.at;
        write!(f, ", the largest {:.3} across, about ({x:.4}, {y:.4}, {z:.4})", place.size)?;
        let contact = self.largest.iter().filter_map(|place| place.contact).find(ContactFacts::is_tangent);
        match contact.map(ContactFacts::contact) {
            Some(contact) => write!(f, "; {contact}"),
            // Coinciding faces are mostly intended.
            None => Ok(()),
        }
    }
}

/// A part of a whole in percent, rounded to two digits, but never to 0% or 100%.
fn share(part: f64, whole: f64) -> String {
    let percent = 100.0 * part / whole;
    match percent {
        _ if part == whole => "all".to_owned(),
        percent if percent < 0.01 => "less than 0.01%".to_owned(),
        percent if percent >= 99.95 => "nearly all".to_owned(),
        percent if percent < 1.0 => format!("{percent:.2}%"),
        percent => format!("{percent:.1}%"),
    }
}

impl BoundFacts {
    /// The facts of a bound.
    #[must_use]
    pub fn new(bound: &Bound) -> Self {
        let (assumptions, samples) = match bound.evidence() {
            Evidence::ProvedIf(assumptions) => (assumptions.clone(), None),
            Evidence::Measured { samples } => (Vec::new(), Some(*samples)),
            Evidence::Proved | Evidence::Estimated => (Vec::new(), None),
        };
        Self {
            at_least: bound.at_least(),
            at_most: bound.at_most(),
            pixels: bound.pixels,
            angle_deg: bound.angle_deg,
            evidence: bound.evidence().as_str(),
            assumptions,
            samples,
            metric: bound.metric.as_str(),
            reference: bound.reference.as_str(),
            at: bound.at,
            open: bound.open.as_deref().map(OpenPlacesFacts::new),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_told_in_one_sentence_and_a_broken_promise_as_what_it_is() {
        let place = OpenPlace { at: [3.0, 4.0, 0.5], size: 1.2, area: 3.0, contact: None };
        let one = OpenPlacesFacts::new(&OpenPlaces::new(vec![place], 5900.0));
        assert_eq!(
            one.to_string(),
            "1 place (0.05% of the area), the largest 1.200 across, about (3.0000, 4.0000, 0.5000)"
        );
        let none = OpenPlacesFacts::new(&OpenPlaces::new(Vec::new(), 5900.0)).to_string();
        assert!(none.contains("a promise about the shape does not hold") && !none.contains('0'), "{none}");
    }
}
