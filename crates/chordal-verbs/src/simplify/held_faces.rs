//! Notes on why triangles are left that the budget seems to allow to remove.
use crate::scene::placements;
use chordal::budget::Budget;
use chordal::budget::advice::{Cure, Message, Setting};
use chordal::budget::attributes::AttributeLimits;
use chordal::check::{components, validity};
use chordal::explicit::Topology;
use chordal::lod::ReductionStats;
use chordal_io::{Part, Scene};

/// If at least one triangle of so many is left, the part is simplified once more without limits on attributes, to count the
/// effect of these. Chosen: with fewer left, the limits hardly matter.
const MANY_LEFT: usize = 8;
/// The note is given if at least one of so many of the triangles left stays only for its attributes. Chosen: a tenth is
/// noticed.
const WORTH_SAYING: u64 = 10;
/// The most pieces that are named. Chosen: one line.
const MOST_NAMED: usize = 5;

/// The number of triangles that stay only because of limits on attributes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct HeldFaces {
    before: u64,
    after: u64,
    /// The triangles that would be left without limits on attributes.
    free: u64,
}

impl HeldFaces {
    /// Whether it is worth the time to count the triangles that would be left without limits on attributes.
    pub fn is_worth_asking(budget: &Budget, [before, after]: [usize; 2]) -> bool {
        budget.attributes.is_set() && after.saturating_mul(MANY_LEFT) >= before
    }

    /// Adds the triangles of a part: before, after, and after without those limits.
    pub fn add(&mut self, [before, after, free]: [usize; 3]) {
        self.before += before as u64;
        self.after += after as u64;
        // Fewer limits may by chance leave more triangles; then none is held.
        self.free += free.min(after) as u64;
    }

    /// The note, if enough triangles are held.
    pub fn note(&self, limits: &AttributeLimits) -> Option<Message> {
        let held = self.after - self.free;
        if held == 0 || held.saturating_mul(WORTH_SAYING) < self.after {
            return None;
        }
        let mut changes = Vec::new();
        changes.extend(limits.texcoord().map(|most| format!("texture coordinates by more than {most}")));
        changes.extend(limits.normal_deg().map(|most| format!("normals by more than {most}°")));
        let share = 100 * held / self.before;
        let message = Message::from(format!(
            "{held} of {} triangles ({share} %) stay only because fewer would change {}, and {} would be left \
             otherwise; a larger ",
            self.before,
            changes.join(" or "),
            self.free
        ));
        let message = match (limits.texcoord(), limits.normal_deg()) {
            (Some(_), Some(_)) => {
                message.setting(Setting::UvError).words(" or ").setting(Setting::NormalError)
            }
            (None, _) => message.setting(Setting::NormalError),
            (_, None) => message.setting(Setting::UvError),
        };
        Some(message.words(" lets more go"))
    }
}

/// Triangles that no budget removes, because the surface branches, touches or repeats itself there.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FrozenFaces {
    before: u64,
    after: u64,
    /// Edges with three triangles or more.
    branches: u64,
    /// Vertices with several fans.
    fans: u64,
    /// Edges of two triangles with opposite winding.
    opposed: u64,
    /// Triangles with the same corners as another one.
    repeated: u64,
}

impl FrozenFaces {
    /// Counts such triangles in a simplified scene if many are left: `None` if they are few. Time O(n log n) then.
    pub fn find(scene: &Scene, stats: &ReductionStats, [before, after]: [usize; 2]) -> Option<Self> {
        let [before, after] = [before, after].map(|n| n as u64);
        let is_worth_saying = |n: u64| after > 0 && n.saturating_mul(WORTH_SAYING) >= after;
        // Each fan has at least one triangle, and each triangle is in three fans.
        let is_locked = is_worth_saying(stats.locked_vertices / 3);
        if after.saturating_mul(MANY_LEFT as u64) < before || !(is_locked || after == before) {
            return None;
        }
        let mut frozen = Self { before, after, ..Self::default() };
        for part in &scene.parts {
            let valid = validity(&part.mesh, topology_of(part));
            frozen.branches += valid.non_manifold_edges.count;
            frozen.fans += valid.non_manifold_vertices.count;
            frozen.opposed += valid.inconsistent_edges.count;
            frozen.repeated += valid.duplicate_faces.count;
        }
        (is_locked || is_worth_saying(frozen.repeated)).then_some(frozen)
    }

    /// Whether the locked triangles alone are more than the count of the budget.
    pub fn are_more_than(&self, budget: &Budget, stats: &ReductionStats) -> bool {
        budget.triangles.is_some_and(|most| stats.locked_vertices / 3 > most)
    }

    /// The sentence.
    pub fn note(&self) -> Message {
        let Self { before, after, branches, fans, opposed, repeated } = self;
        let places = [
            (branches, "edges have three triangles or more"),
            (fans, "vertices have several fans"),
            (opposed, "neighbours are wound against each other"),
        ];
        let places: Vec<String> =
            places.into_iter().filter(|(n, _)| **n > 0).map(|(n, what)| format!("{what} ({n}x)")).collect();
        let mut text = format!("{after} of {before} triangles are left: ");
        if !places.is_empty() {
            text += &format!("where {} they stay as they are; ", places.join(" or "));
        }
        if *repeated > 0 {
            text += &format!("{repeated} of them lie on another one, like the back side of a sheet: ");
            return Message::from(text).setting(Setting::Cure(Cure::DropDuplicates)).words(
                " of mend leaves one of each, whose material then has to show both sides, and lets more go",
            );
        }
        let (cure, does) = if *branches + *fans > 0 {
            (Cure::SplitNonManifold, " of mend, into OBJ or PLY, takes such places apart")
        } else {
            (Cure::Orient, " of mend winds them alike")
        };
        Message::from(text).setting(Setting::Cure(cure)).words(does)
    }
}

/// The way in which the positions of a part are tied.
fn topology_of(part: &Part) -> Topology {
    if part.indexed { Topology::Indices } else { Topology::Positions }
}

/// A note if more triangles are left than the budget allows: the pieces with most of them.
pub(crate) fn pieces_note(scene: &Scene, budget: &Budget) -> Option<Message> {
    let most = budget.triangles?;
    let n_left = placements::n_placed_faces(scene);
    if n_left <= most {
        return None;
    }
    let mut pieces = pieces_of(scene);
    // A stable sort: pieces of equal size stay in their order.
    pieces.sort_by_key(|(_, faces)| std::cmp::Reverse(*faces));
    let named: Vec<String> =
        pieces.iter().take(MOST_NAMED).map(|(name, faces)| format!("{name} ({faces})")).collect();
    let more = match pieces.len().saturating_sub(MOST_NAMED) {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    let count = if pieces.len() == 1 { "1 piece".to_owned() } else { format!("{} pieces", pieces.len()) };
    let (why, way) = if budget.length.is_some() || budget.pixels.is_some() {
        ("no more can go within the length", "a larger length lets more go")
    } else {
        (
            "a count alone removes no separate piece and no handle, so that each keeps some triangles",
            "a length in addition to the count removes pieces that it covers",
        )
    };
    let named = named.join(", ");
    Some(
        format!("{n_left} triangles are left and {most} are allowed: {why}; {count}: {named}{more}; {way}")
            .into(),
    )
}

/// The connected pieces of all parts, by name or number, with their triangles.
fn pieces_of(scene: &Scene) -> Vec<(String, u64)> {
    let is_alone = scene.parts.iter().filter(|part| !part.mesh.faces().is_empty()).count() == 1;
    let mut pieces = Vec::new();
    for (number, part) in scene.parts.iter().enumerate() {
        let Part { name, mesh, .. } = part;
        let owner = if name.is_empty() { format!("part {number}") } else { format!("'{name}'") };
        let connected = components(mesh, topology_of(part));
        let is_whole = connected.len() == 1;
        for (piece, component) in connected.iter().enumerate() {
            let title = match (is_alone, is_whole) {
                (true, _) => format!("piece {piece}"),
                (false, true) => owner.clone(),
                (false, false) => format!("piece {piece} of {owner}"),
            };
            pieces.push((title, component.faces));
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stays_for_its_attributes_is_counted_over_all_parts() {
        let limits = AttributeLimits::new(Some(0.01), None).expect("a limit");
        let mut held = HeldFaces::default();
        assert!(held.note(&limits).is_none());
        held.add([100, 100, 20]);
        held.add([100, 60, 80]);
        let note = held.note(&limits).expect("half of them stay");
        assert!(note.starts_with("80 of 200 triangles (40 %) stay only"), "{note}");
        assert!(note.contains("texture coordinates by more than 0.01, and 80 would be left"), "{note}");
        let mut few = HeldFaces::default();
        few.add([100, 100, 99]);
        assert!(few.note(&limits).is_none());
    }
}
