//! `Beam`: a ray with a radius, and the results of beams.

/// A ray with a radius: the size of a detail that it may miss.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// The point where it starts.
    pub origin: [f64; 3],
    /// Its direction, of any length but 0.
    pub direction: [f64; 3],
    /// The start of the relevant part, in multiples of `direction`.
    pub from: f64,
    /// The end of that part; may be infinite.
    pub to: f64,
    /// Its radius at its origin, and the growth of the radius per unit of length: usually half a pixel.
    /// Thinner details may be missed where no interval of slopes rules them out; such beams are counted.
    pub cone: [f64; 2],
}

/// Where a beam meets the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamHit {
    /// The position in multiples of the direction: the far end of a bracket between a point outside and one
    /// inside.
    pub t: f64,
    /// The point there.
    pub point: [f64; 3],
    /// Whether the beam came from outside.
    pub entering: bool,
}

/// The result of one beam.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BeamRecord {
    /// Where the beam met the surface, if it did.
    pub hit: Option<BeamHit>,
    /// Whether the beam passed a stretch that neither slopes nor a distance bound prove free: more than its
    /// radius before the hit, or anywhere without a hit. Such stretches are a quarter of its radius long, and
    /// longer where nothing bounds the slope.
    pub uncertain: bool,
    /// Whether it was stopped at the step limit. Then it has no hit, and is uncertain.
    pub capped: bool,
}

/// The counts of many beams.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BeamCounts {
    /// All beams.
    pub beams: u64,
    /// Beams that met the surface; each hit is bracketed by a point outside and one inside.
    pub hits: u64,
    /// Beams with a stretch that is not proved free.
    pub uncertain: u64,
    /// Uncertain beams that were stopped at the step limit.
    pub capped: u64,
}

impl BeamCounts {
    /// Adds one beam.
    #[must_use]
    pub fn add_record(self, record: &BeamRecord) -> Self {
        Self {
            beams: self.beams + 1,
            hits: self.hits + u64::from(record.hit.is_some()),
            uncertain: self.uncertain + u64::from(record.uncertain || record.capped),
            capped: self.capped + u64::from(record.capped),
        }
    }

    /// The sum of the two.
    #[must_use]
    pub fn merge(self, other: Self) -> Self {
        Self {
            beams: self.beams + other.beams,
            hits: self.hits + other.hits,
            uncertain: self.uncertain + other.uncertain,
            capped: self.capped + other.capped,
        }
    }

    /// The fraction of the beams whose stretches are all proved free.
    #[must_use]
    pub fn certified_share(&self) -> f64 {
        if self.beams == 0 { 1.0 } else { (self.beams - self.uncertain) as f64 / self.beams as f64 }
    }
}
