//! `mesh` of an offset or a hollow solid: the surface at a distance from a solid, and a solid with a wall.
use super::request::MeshRequest;
use crate::MeshFailure;
use crate::options::values::length;
use crate::output::file_rows::unsupported;
use crate::report::OffsetFacts;
use crate::scene::drop_attributes::without_attributes;
use crate::scene::merge::merge;
use chordal::budget::advice::Message;
use chordal::budget::{Bound, Bounded, Failure, Length, RefusalCode};
use chordal::check::{Facing, components};
use chordal::explicit::Topology;
use chordal::lod::mesh_to_offset;
use chordal::math::{greater, lesser, sub_down};
use chordal::mend::nesting::NestedShells;
use chordal::mend::orient;
use chordal::{Job, Mesh};
use chordal_io::Scene;

/// Another surface of a solid than its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SolidOffset {
    /// The surface farther out by a length.
    Outward(Length),
    /// The surface farther in.
    Inward(Length),
    /// The solid's own surface, and that of a cavity which leaves a wall of this thickness.
    Hollow(Length),
}

/// The default tolerance as a share of the distance. Chosen: a wall of 2 mm within 0.1, as printers do.
const SHARE: f64 = 0.05;

impl SolidOffset {
    /// Parses an offset: outward, or inward if it is negative.
    ///
    /// # Errors
    /// Why the text is no length.
    pub fn parse(text: &str) -> Result<Self, String> {
        match text.trim().strip_prefix('-') {
            Some(inward) => length(inward).map(Self::Inward),
            None => length(text.trim().trim_start_matches('+')).map(Self::Outward),
        }
    }

    /// Its distance.
    #[must_use]
    pub fn distance(self) -> Length {
        match self {
            Self::Outward(length) | Self::Inward(length) | Self::Hollow(length) => length,
        }
    }

    /// What a report says of it.
    pub(super) fn facts(self, distance: f64) -> OffsetFacts {
        let kind = match self {
            Self::Outward(_) => "outward",
            Self::Inward(_) => "inward",
            Self::Hollow(_) => "hollow",
        };
        OffsetFacts { kind: kind.to_owned(), distance }
    }

    /// The tolerance if the budget has no limit.
    #[must_use]
    pub fn default_length(self) -> Length {
        match self.distance() {
            Length::Plain(length) => Length::Plain(SHARE * length),
            Length::In(length, unit) => Length::In(SHARE * length, unit),
            Length::Percent(share) => Length::Percent(SHARE * share),
        }
    }
}

/// The solid that a scene bounds, with another surface.
///
/// # Errors
/// If the scene bounds no solid, or nothing is left of it; as for [`mesh_to_offset`].
pub(super) fn offset_scene(
    scene: &Scene,
    (what, by): (SolidOffset, f64),
    request: &MeshRequest,
    notes: &mut Vec<Message>,
    job: &Job,
) -> Result<(Scene, Bound), MeshFailure> {
    let solid = one_mesh(scene, notes, job)?;
    let signed = if matches!(what, SolidOffset::Outward(_)) { by } else { -by };
    let mut parts_after = 0;
    let converted = request.run(job, |budget| {
        let moved = mesh_to_offset(&solid, signed, budget, job).map_err(|failure| in_words(failure, what));
        let mut joined = |bounded: Bounded<Mesh>| {
            parts_after = components(&bounded.shape, Topology::Indices).len();
            let Bounded { shape, bound } = bounded;
            match what {
                SolidOffset::Hollow(_) => {
                    Bounded { shape: hollow(&solid, &shape), bound: beside_the_solid(bound, by) }
                }
                _ => Bounded { shape, bound },
            }
        };
        match moved {
            Ok(bounded) => Ok(joined(bounded)),
            Err(Failure::Unmet(best)) => Err(Failure::Unmet(Box::new(joined(*best)))),
            Err(failure) => Err(failure),
        }
    })?;
    let parts_before = components(&solid, Topology::Positions).len();
    notes.extend(topology_note(what, parts_before, parts_after));
    Ok((Scene::from_mesh("solid", converted.shape, scene.frame), converted.bound))
}

/// All parts as one closed mesh, wound outward.
fn one_mesh(scene: &Scene, notes: &mut Vec<Message>, job: &Job) -> Result<Mesh, MeshFailure> {
    let world_meshes = scene.world_meshes()?;
    let meshes: Vec<&Mesh> = world_meshes.iter().map(|(_, mesh)| mesh.as_ref()).collect();
    let merged = merge(&meshes)?.mesh;
    if !merged.attributes().is_empty() {
        notes
            .push("colours, texture coordinates and the like were left out: the new surface has none".into());
    }
    let mesh = without_attributes(&merged, |_| true).map_err(unsupported)?;
    let pieces = components(&mesh, Topology::Positions);
    if pieces.is_empty() || pieces.iter().any(|piece| piece.facing != Facing::InsideOut) {
        return Ok(mesh);
    }
    notes.push("the triangles are wound inside out and were turned".into());
    Ok(orient(&mesh, Topology::Positions, NestedShells::Keep, job)?.mesh)
}

/// A solid and its cavity, whose surface faces inward.
fn hollow(solid: &Mesh, cavity: &Mesh) -> Mesh {
    let n = solid.positions().len() as u32;
    let positions = [solid.positions(), cavity.positions()].concat();
    let inward = cavity.faces().iter().map(|[a, b, c]| [a + n, c + n, b + n]);
    let faces = solid.faces().iter().copied().chain(inward).collect();
    let ids = (0..n).map(|v| solid.position_of(v)).chain(n..positions.len() as u32).collect();
    Mesh::new(positions, faces)
        .and_then(|mesh| mesh.with_position_id(ids))
        .expect("both meshes have rows in range")
}

/// The bound of a cavity, beside the solid's own surface: its lower end must not be farther than that surface.
fn beside_the_solid(bound: Bound, wall: f64) -> Bound {
    let least = lesser(bound.at_least(), greater(sub_down(wall, bound.at_least()), 0.0));
    let (most, open) = (bound.at_most(), bound.open.clone());
    let mut beside = Bound::with_evidence(least, most, bound.evidence().clone(), bound.reference);
    beside.open = open;
    beside
}

/// The reasons of the arrow, with the option that a user gave.
fn in_words(failure: Failure<Mesh>, what: SolidOffset) -> Failure<Mesh> {
    match failure {
        Failure::Refused(refusal) if refusal.code == RefusalCode::Empty => {
            let message = match what {
                SolidOffset::Hollow(wall) => {
                    format!(
                        "no point is deeper in the solid than {wall}, so that a wall of it leaves no cavity"
                    )
                }
                _ => {
                    format!("no point is deeper in the solid than {}: nothing is left of it", what.distance())
                }
            };
            Failure::refused(RefusalCode::Empty, message)
        }
        Failure::Refused(refusal) if refusal.code == RefusalCode::Unsupported => {
            let message = "the triangles are not closed, so that they have no inside: mend them first (inspect lists what \
                           is open)";
            Failure::refused(RefusalCode::Unsupported, message)
        }
        failure => failure,
    }
}

/// What became of the parts.
fn topology_note(what: SolidOffset, before: usize, after: usize) -> Option<Message> {
    let parts =
        |n: usize| if n == 1 { "1 closed surface".to_owned() } else { format!("{n} closed surfaces") };
    let text = match what {
        SolidOffset::Hollow(_) if after == 1 && before == 1 => return None,
        SolidOffset::Hollow(_) => format!(
            "the cavity has {}, in a solid of {}: where the solid is thinner than two walls there is none",
            parts(after),
            parts(before)
        ),
        _ if before == after => return None,
        SolidOffset::Outward(_) => {
            format!("{} became {}: gaps narrower than twice the distance closed", parts(before), parts(after))
        }
        SolidOffset::Inward(_) => {
            format!(
                "{} became {}: what is thinner than twice the distance vanished",
                parts(before),
                parts(after)
            )
        }
    };
    Some(text.into())
}
