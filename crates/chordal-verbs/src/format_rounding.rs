//! The most that rounding to a file can move the parts of a scene, known before anything is built.
use crate::OutputForm;
use crate::placements::scaled_up;
use chordal::Mesh;
use chordal::budget::advice::Message;
use chordal::budget::attributes::AttributeLimits;
use chordal::math::{Box3, greater, lesser};
use chordal_io::glb::{DirectionBits, PositionLattice, VertexStorage};
use chordal_io::{CoordinateOverflow, Format, Part, Scene, SnappedMesh, snap, snap_apart, worst_snap};

/// What the positions of a part are rounded to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RoundingTarget {
    pub format: Format,
    /// The lattice, where there is one.
    pub lattice: Option<PositionLattice>,
    /// Whether skins or morph targets move the part: glTF stores such about no origin of its own.
    pub is_deformed: bool,
}

impl RoundingTarget {
    /// The precision of a format by itself.
    pub fn format(format: Format) -> Self {
        Self { format, lattice: None, is_deformed: false }
    }

    /// That of a format, or a lattice.
    pub fn new(format: Format, lattice: Option<PositionLattice>) -> Self {
        Self { lattice, ..Self::format(format) }
    }

    /// The most that a position within a box moves.
    pub fn worst(&self, bounds: &Box3) -> f64 {
        match self.lattice {
            Some(lattice) => lattice.worst(),
            None if self.is_deformed && self.format.has_nodes() => worst_snap(bounds, Format::Stl),
            None => worst_snap(bounds, self.format),
        }
    }

    /// The same, but sheets that only rounding would tie together stay apart, unless on a lattice.
    pub fn snap_apart(&self, mesh: &Mesh) -> Result<SnappedMesh, CoordinateOverflow> {
        self.lattice.map_or_else(|| snap_apart(mesh, self.format), |lattice| Ok(lattice.snap(mesh)))
    }

    /// The mesh with its positions rounded.
    pub fn snap(&self, mesh: &Mesh) -> Result<SnappedMesh, CoordinateOverflow> {
        self.lattice.map_or_else(|| snap(mesh, self.format), |lattice| Ok(lattice.snap(mesh)))
    }
}

/// The share of a budget that a lattice may take; where it would take more, positions stay in single precision.
/// Derived: it costs a third more triangles at most, since their number goes with the inverse of the length, and
/// what a vertex and its triangles take is about a third less.
const MOST_SHARE: f64 = 0.25;

/// The share of its diagonal by which a result may leave the box of its part. Chosen: lattices reach farther than
/// most coarse levels, and seldom need a step twice as large for it.
const ROOM: f64 = 1.0 / 64.0;

/// The lattice for what lies in a box, or little outside, and may be off by a length.
pub(crate) fn lattice_within(bounds: &Box3, allowed: f64) -> Option<PositionLattice> {
    let room = lesser(ROOM * bounds.diagonal(), allowed);
    PositionLattice::for_box(bounds, room).filter(|lattice| lattice.worst() <= MOST_SHARE * allowed)
}

/// The length of which a lattice may take its share. None where texture coordinates have to keep 32 bits: the steps of
/// a lattice move the texture that spans a part by as much as 16 bits of its coordinates do.
pub(crate) fn length_for_lattice(allowed: f64, limits: &AttributeLimits) -> f64 {
    if storage_within(None, limits).has_short_texcoords { allowed } else { 0.0 }
}

/// What each part of a scene is rounded to, where a point of it may be off by such a length in the scene.
pub(crate) fn targets(
    scene: &Scene,
    stretch: &[f64],
    form: OutputForm,
    allowed: impl Fn(usize) -> f64,
) -> Vec<RoundingTarget> {
    let target = |(number, (part, stretch)): (usize, (&Part, &f64))| {
        let is_deformed = part.is_deformed();
        let can = form.is_quantized() && !is_deformed && *stretch > 0.0;
        let lattice = can.then(|| lattice_within(&part.mesh.bounds(), allowed(number) / stretch)).flatten();
        RoundingTarget { format: form.format, lattice, is_deformed }
    };
    scene.parts.iter().zip(stretch).enumerate().map(target).collect()
}

/// The most that rounding moves a point of a scene, given the stretch of each part.
pub(crate) fn worst_rounding(scene: &Scene, stretch: &[f64], targets: &[RoundingTarget]) -> f64 {
    scene.parts.iter().zip(stretch).zip(targets).fold(0.0, |most, ((part, stretch), target)| {
        let lost = scaled_up(target.worst(&part.mesh.bounds()), *stretch);
        greater(lost, most)
    })
}

/// How a part is stored whose positions are on a lattice, and whose attributes have limits. Each takes at most
/// [`MOST_SHARE`] of its limit, or stays in more bits.
pub(crate) fn storage_within(lattice: Option<PositionLattice>, limits: &AttributeLimits) -> VertexStorage {
    let fits = |worst: f64, limit: Option<f64>| limit.is_none_or(|limit| worst <= MOST_SHARE * limit);
    let fewest = [DirectionBits::Eight, DirectionBits::Sixteen];
    let directions = fewest.into_iter().find(|bits| fits(bits.worst_deg(), limits.normal_deg()));
    VertexStorage {
        lattice,
        directions: directions.unwrap_or(DirectionBits::Single),
        has_short_texcoords: fits(VertexStorage::WORST_TEXCOORD, limits.texcoord()),
    }
}

/// What such a storage leaves of limits on attributes.
pub(crate) fn limits_left(limits: AttributeLimits, storage: &VertexStorage) -> AttributeLimits {
    let texcoord = if storage.has_short_texcoords { VertexStorage::WORST_TEXCOORD } else { 0.0 };
    let left = |limit: Option<f64>, lost: f64| limit.map(|limit| limit - lost);
    let left = AttributeLimits::new(
        left(limits.texcoord(), texcoord),
        left(limits.normal_deg(), storage.directions.worst_deg()),
    );
    // No more than a quarter of each was taken.
    left.unwrap_or(limits)
}

/// What is said of parts whose positions stay in single precision although fewer bits were asked for.
pub(crate) fn single_precision_note(parts: &[Part]) -> Vec<Message> {
    let shown = || parts.iter().filter(|part| !part.mesh.faces().is_empty());
    let is_single = |part: &&Part| part.storage.as_ref().is_some_and(|storage| storage.lattice.is_none());
    let deformed = shown().filter(is_single).filter(|part| part.is_deformed()).count();
    let others = shown().filter(is_single).count() - deformed;
    let mut notes: Vec<Message> = Vec::new();
    if deformed > 0 {
        let why = "positions that skins or morph targets move stay in single precision";
        notes.push(format!("{why} ({deformed}x)").into());
    }
    if others > 0 {
        let why = "positions stay in single precision where steps of 16 bits are too coarse for the budget, or out of \
                   the range of viewers";
        notes.push(format!("{why} ({others}x)").into());
    }
    notes
}
