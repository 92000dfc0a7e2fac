//! The rounding of positions to a file: how far it may move a scene's parts, before anything is built, and the rounding
//! itself.
use crate::scene::placements::scaled_up;
use crate::{MeshFailure, OutputForm};
use chordal::budget::advice::Message;
use chordal::budget::attributes::AttributeLimits;
use chordal::budget::{Bound, Bounded, PixelBudget, Reference};
use chordal::explicit::Topology;
use chordal::math::{Box3, greater, lesser};
use chordal::{Job, Mesh, mend};
use chordal_io::glb::{DirectionBits, PositionLattice, VertexStorage};
use chordal_io::{CoordinateOverflow, Format, Part, Scene, SnappedMesh, snap, snap_apart, worst_snap};

/// The precision to which the positions of a part are rounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RoundingTarget {
    pub format: Format,
    /// The lattice, if there is one.
    pub lattice: Option<PositionLattice>,
    /// Whether skins or morph targets move the part: glTF stores such a part without an origin of its own.
    pub is_deformed: bool,
}

impl RoundingTarget {
    /// The precision of a format by itself.
    pub fn format(format: Format) -> Self {
        Self { format, lattice: None, is_deformed: false }
    }

    /// The precision of a format, or of a lattice.
    pub fn new(format: Format, lattice: Option<PositionLattice>) -> Self {
        Self { lattice, ..Self::format(format) }
    }

    /// The largest distance by which a position within a box moves.
    pub fn worst(&self, bounds: &Box3) -> f64 {
        match self.lattice {
            Some(lattice) => lattice.worst(),
            None if self.is_deformed && self.format.has_nodes() => worst_snap(bounds, Format::Stl),
            None => worst_snap(bounds, self.format),
        }
    }

    /// As [`Self::snap`], but sheets that only rounding would tie together stay apart, unless on a lattice.
    pub fn snap_apart(&self, mesh: &Mesh) -> Result<SnappedMesh, CoordinateOverflow> {
        self.lattice.map_or_else(|| snap_apart(mesh, self.format), |lattice| Ok(lattice.snap(mesh)))
    }

    /// The mesh with its positions rounded.
    pub fn snap(&self, mesh: &Mesh) -> Result<SnappedMesh, CoordinateOverflow> {
        self.lattice.map_or_else(|| snap(mesh, self.format), |lattice| Ok(lattice.snap(mesh)))
    }
}

/// The share of a budget that a lattice may take; if it takes more, positions stay in single precision. Derived: that costs
/// at most a third more triangles, since their number is proportional to the inverse of the length, and a vertex with its
/// triangles takes about a third less memory.
const MOST_SHARE: f64 = 0.25;

/// The share of its diagonal by which a result may leave the box of its part. Chosen: lattices reach farther than most
/// coarse levels, and rarely need a step twice as large for it.
const ROOM: f64 = 1.0 / 64.0;

/// The lattice for positions in a box, or little outside, that may move by a length.
pub(crate) fn lattice_within(bounds: &Box3, allowed: f64) -> Option<PositionLattice> {
    let room = lesser(ROOM * bounds.diagonal(), allowed);
    PositionLattice::for_box(bounds, room).filter(|lattice| lattice.worst() <= MOST_SHARE * allowed)
}

/// The length of which a lattice may take its share; 0 if texture coordinates have to keep 32 bits: the steps of a lattice
/// shift a texture that spans a part by as much as texture coordinates of 16 bits do.
pub(crate) fn length_for_lattice(allowed: f64, limits: &AttributeLimits) -> f64 {
    if storage_within(None, limits).has_short_texcoords { allowed } else { 0.0 }
}

/// The rounding of each part of a scene, if a point of it may move by the allowed length in the scene.
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

/// The largest distance by which rounding moves a point of a scene, given the stretch of each part.
pub(crate) fn worst_rounding(scene: &Scene, stretch: &[f64], targets: &[RoundingTarget]) -> f64 {
    scene.parts.iter().zip(stretch).zip(targets).fold(0.0, |most, ((part, stretch), target)| {
        let lost = scaled_up(target.worst(&part.mesh.bounds()), *stretch);
        greater(lost, most)
    })
}

/// The storage of a part with positions on a lattice and limits on attributes. Each attribute takes at most [`MOST_SHARE`]
/// of its limit, or keeps more bits.
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

/// The limits on attributes that such a storage leaves.
pub(crate) fn limits_left(limits: AttributeLimits, storage: &VertexStorage) -> AttributeLimits {
    let texcoord = if storage.has_short_texcoords { VertexStorage::WORST_TEXCOORD } else { 0.0 };
    let remaining = |limit: Option<f64>, lost: f64| limit.map(|limit| limit - lost);
    let remaining = AttributeLimits::new(
        remaining(limits.texcoord(), texcoord),
        remaining(limits.normal_deg(), storage.directions.worst_deg()),
    );
    // At most a quarter of each limit was taken.
    remaining.unwrap_or(limits)
}

/// Notes on parts whose positions stay in single precision although fewer bits were requested.
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

/// Rounds a mesh to the precision of a format, or to a lattice, and adds the displacement to the bound.
///
/// Pixels add as lengths do: a point of the true shape moves on the screen to its point of the mesh, and from there to the
/// rounded point. Faces that rounding left without area are dropped, and their neighbours keep the surface closed; if a
/// face covers points that no other face is near, all of them stay. Sheets that are nearer to each other than the format's
/// digits can represent are kept apart by the last digit, so that a manifold stays a manifold.
pub(crate) fn snap_with_bound(
    mesh: &Mesh,
    bound: Bound,
    to: RoundingTarget,
    pixels: Option<PixelBudget>,
    job: &Job,
) -> Result<Bounded<Mesh>, MeshFailure> {
    let snapped = to.snap_apart(mesh)?;
    if snapped.moved_at_most == 0.0 {
        return Ok(Bounded { shape: snapped.mesh, bound });
    }
    let mut cleaned = mend::drop_degenerate(&snapped.mesh, Topology::Positions, job)?;
    // A face flattened by rounding is no farther from its neighbours than it moved. One that is farther had no area
    // before the rounding.
    if cleaned.bound.at_most().is_none_or(|most| most > snapped.moved_at_most) {
        cleaned.bound = Bound::exact(Reference::InputTriangles);
        cleaned.mesh = snapped.mesh;
    }
    let step = Bound::proved(0.0, snapped.moved_at_most, Reference::InputTriangles).then(&cleaned.bound);
    let moved_at_most = step.at_most().unwrap_or(f64::INFINITY);
    let moved_px = pixels.and_then(|px| px.view.pixels_of(moved_at_most, &mesh.bounds()));
    let mut chain = bound.then(&step);
    // The rounding of normals is negligible at realistic angles.
    chain.angle_deg = bound.angle_deg;
    let two_steps = |px: PixelBudget| px.view.pixels_of_two_steps(bound.pixels?, moved_px?);
    chain.pixels = pixels.and_then(two_steps);
    Ok(Bounded { shape: cleaned.mesh, bound: chain })
}
