//! `Beam`: a ray as thick as what it stands for; and what became of it.

/// A ray that knows how small a thing it may overlook.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Where it starts.
    pub origin: [f64; 3],
    /// Where it goes; any length but 0.
    pub direction: [f64; 3],
    /// The part of it that counts, in multiples of `direction`.
    pub from: f64,
    /// The end of that part; may be infinite.
    pub to: f64,
    /// Its radius at its origin, and by how much that grows for each length travelled: half a pixel, as a
    /// rule. What is thinner may be missed where no range of slopes rules it out, and that is counted.
    pub cone: [f64; 2],
}

/// Where a beam met the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamHit {
    /// How far along, in multiples of the direction: the far end of a bracket between a point outside and one
    /// inside.
    pub t: f64,
    /// The point there.
    pub point: [f64; 3],
    /// Whether it came from outside.
    pub entering: bool,
}

/// What became of one beam.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BeamRecord {
    /// Where it met the surface, if it did.
    pub hit: Option<BeamHit>,
    /// Whether more than its radius before that, or anywhere if it met nothing, a stretch was passed that no
    /// range of slopes and no word for a distance clears. Such stretches are a quarter of its radius long,
    /// and longer where nothing bounds the slope.
    pub uncertain: bool,
    /// Whether it was given up at the most steps. Then it met nothing, and that is uncertain.
    pub capped: bool,
}

/// What became of many beams.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BeamCounts {
    /// All of them.
    pub beams: u64,
    /// Those that met the surface; each hit is bracketed by a point outside and one inside.
    pub hits: u64,
    /// Those with a stretch that nothing clears.
    pub uncertain: u64,
    /// Those of them that were given up at the most steps.
    pub capped: u64,
}

impl BeamCounts {
    /// One more.
    #[must_use]
    pub fn add_record(self, record: &BeamRecord) -> Self {
        Self {
            beams: self.beams + 1,
            hits: self.hits + u64::from(record.hit.is_some()),
            uncertain: self.uncertain + u64::from(record.uncertain || record.capped),
            capped: self.capped + u64::from(record.capped),
        }
    }

    /// Both together.
    #[must_use]
    pub fn merge(self, other: Self) -> Self {
        Self {
            beams: self.beams + other.beams,
            hits: self.hits + other.hits,
            uncertain: self.uncertain + other.uncertain,
            capped: self.capped + other.capped,
        }
    }

    /// The share of the beams without a stretch that nothing clears.
    #[must_use]
    pub fn certified_share(&self) -> f64 {
        if self.beams == 0 { 1.0 } else { (self.beams - self.uncertain) as f64 / self.beams as f64 }
    }
}
