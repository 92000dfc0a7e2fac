//! `OpenPlaces`: the places where a proof was tried and not found.
use std::fmt;

/// A connected part of a result for which no proof was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenPlace {
    /// The middle of its box.
    pub at: [f64; 3],
    /// The diagonal of its box.
    pub size: f64,
    /// The area of its triangles; 0 if a part of the true shape might have no triangles there.
    pub area: f64,
    /// A point where two surfaces touch, if one was found: the usual reason why a place cannot be proved.
    pub contact: Option<SurfaceContact>,
}

/// A point where two surfaces share a tangent plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceContact {
    /// The point.
    pub at: [f64; 3],
    /// Whether both solids are on one side of the plane, as for coincident faces; otherwise they touch from
    /// opposite sides, like parts that do not overlap or a wall that thins out to nothing.
    pub is_flush: bool,
    /// The lines of the script that created the two surfaces, if known.
    pub lines: Option<[u64; 2]>,
}

/// Half of the last printed digit: derived.
const HALF_LAST_DIGIT: f64 = 0.5e-4;

impl fmt::Display for SurfaceContact {
    /// `two surfaces touch at (5.0000, 0.0000, 1.0000) (lines 1 and 2 of the script): …`, followed by advice.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Print no "-0.0000".
        let [x, y, z] = self.at.map(|x| if x.abs() < HALF_LAST_DIGIT { 0.0 } else { x });
        write!(f, "two surfaces touch at ({x:.4}, {y:.4}, {z:.4})")?;
        match self.lines {
            Some([a, b]) if a == b => write!(f, " (line {a} of the script)")?,
            Some([a, b]) => write!(f, " (lines {a} and {b} of the script)")?,
            None => {}
        }
        f.write_str(": overlap them by slightly more than the tolerance, or separate them by as much")
    }
}

/// The places where a bound is not proved. Elsewhere each triangle is proved to be near the true shape.
///
/// ```
/// use chordal::budget::proof::{OpenPlace, OpenPlaces};
/// let place = |x: f64, size: f64| OpenPlace { at: [x, 0.0, 0.0], size, area: 0.5, contact: None };
/// let places = OpenPlaces::new(vec![place(0.0, 0.1), place(1.0, 0.3)], 8.0);
/// assert_eq!((places.count, places.largest[0].at[0], places.area), (2, 1.0, 1.0));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct OpenPlaces {
    /// The number of places. 0 if nothing stayed open, but a point was found beyond the proved distance: a
    /// promise about the shape is then false.
    pub count: u64,
    /// The area of their triangles.
    pub area: f64,
    /// The area of all triangles.
    pub whole_area: f64,
    /// The largest places, at most [`OpenPlaces::MOST`], in descending order.
    pub largest: Vec<OpenPlace>,
}

impl OpenPlaces {
    /// The most places that are listed. Chosen: as many as a reader looks through.
    pub const MOST: usize = 16;

    /// The places, and the area of all triangles of the result.
    #[must_use]
    pub fn new(mut places: Vec<OpenPlace>, whole_area: f64) -> Self {
        let count = places.len() as u64;
        let area = places.iter().map(|place| place.area).sum();
        places.sort_by(|a, b| b.size.total_cmp(&a.size));
        places.truncate(Self::MOST);
        Self { count, area, whole_area, largest: places }
    }

    /// The first contact from opposite sides. It is usually the one to mend; coincident faces are usually
    /// intended.
    #[must_use]
    pub fn tangent(&self) -> Option<&SurfaceContact> {
        self.largest.iter().filter_map(|place| place.contact.as_ref()).find(|contact| !contact.is_flush)
    }

    /// The open places of two results next to each other.
    #[must_use]
    pub fn beside(&self, other: &Self) -> Self {
        let mut largest = [&self.largest[..], &other.largest[..]].concat();
        largest.sort_by(|a, b| b.size.total_cmp(&a.size));
        largest.truncate(Self::MOST);
        Self {
            count: self.count + other.count,
            area: self.area + other.area,
            whole_area: self.whole_area + other.whole_area,
            largest,
        }
    }
}
