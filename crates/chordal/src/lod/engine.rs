//! `Engine`: edges shrink to points, the cheapest first, as long as the surface stays one and nothing turns over.
use super::quadric::Quadric;
use super::queue::Queue;
use super::room::Room;
use super::surface::{NONE, Surface};
use super::watch::{Change, Watch};
use super::wedges::{Handed, Wedges};
use crate::budget::Job;
use crate::explicit::{nearest_on_triangle, nearest_with_distance, next_in_face, previous_in_face};
use crate::math::{Box3, cross, difference, dot};

/// What a vertex may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Lies in the surface: goes anywhere.
    Smooth,
    /// Lies on a line that is kept: goes along it.
    Line,
    /// Stays, since lines end or meet there.
    Fixed,
    /// Stays, since the mesh is not a manifold there.
    Tied,
}

/// How far to go.
#[derive(Clone, Copy, Debug)]
pub(super) struct Until<'a> {
    /// Stop at so many faces.
    pub faces: usize,
    /// How far from the original what is where may be.
    pub room: &'a Room,
}

#[derive(Clone)]
pub(super) struct Engine {
    pub surface: Surface,
    pub at: Vec<[f64; 3]>,
    pub quadric: Vec<Quadric>,
    pub kind: Vec<Kind>,
    /// By vertex: its number at the start; of one that stays where it is, that of the place.
    pub name: Vec<u32>,
    /// By name: that of the first fan at the same position of the mesh.
    pub place: Vec<u32>,
    /// By half-edge: whether its edge is of a line that is kept. A border is one anyway.
    pub is_line: Vec<bool>,
    pub watch: Option<Watch>,
    pub wedges: Option<Wedges>,
    /// By vertex: whether it is where the mesh had it.
    pub is_original: Vec<bool>,
    /// By vertex: how far the lines that it stands for were from it and its edges, at most.
    line_off: Vec<f64>,
    /// By face: what the change cost that made it what it is.
    pub made_at: Vec<f32>,
    /// By half-edge, for one of the two of an edge: what it costs, as it stands in the queue; NaN for the other.
    cost: Vec<f32>,
    queue: Queue,
    /// Vertices that were seen in this round.
    seen: Vec<u32>,
    round: u32,
    /// The faces around the edge in question, after: without the two that go.
    after: Vec<(u32, [[f64; 3]; 3])>,
    /// The same and the two, before.
    before: Vec<u32>,
}

/// An edge that shrinks, and to where.
#[derive(Clone, Copy, Debug)]
struct Shrink {
    h: u32,
    to: [f64; 3],
    anchor: Anchor,
    cost: f32,
}

/// Which end of an edge stays where it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Anchor {
    None,
    Start,
    End,
}

/// The least cosine between the normal of a face before and after. Chosen: without one thin parts fold.
const LEAST_TURN: f64 = 0.25;
/// What the square of an edge's length adds to its cost, as a share of its weight: decides where planes do not. Chosen.
const SHORT: f64 = 1e-9;

/// What a sum of squares with so much weight is divided by: its power of 3/8, between the sum, for which a large flat piece may be far off
/// nowhere, and the mean, for which one far point among many near ones is cheap. Measured on eight shapes, with seven counts of triangles each: the
/// largest distance is 5 % less than with the sum and no more than with any other power; for lengths it makes no difference.
#[inline]
fn per_weight(weight: f32) -> f32 {
    let root = weight.sqrt().sqrt();
    let power = root * root.sqrt();
    if power > 0.0 { power } else { 1.0 }
}

impl Engine {
    pub fn new(surface: Surface, at: Vec<[f64; 3]>, kind: Vec<Kind>, is_line: Vec<bool>) -> Self {
        let (n, n_vertices) = (surface.start.len(), at.len());
        let mut engine = Self {
            surface,
            quadric: vec![Quadric::default(); n_vertices],
            at,
            kind,
            name: (0..n_vertices as u32).collect(),
            place: (0..n_vertices as u32).collect(),
            is_line,
            watch: None,
            wedges: None,
            is_original: vec![true; n_vertices],
            line_off: vec![0.0; n_vertices],
            made_at: vec![0.0; n / 3],
            cost: vec![f32::NAN; n],
            queue: Queue::new(),
            seen: vec![0; n_vertices],
            round: 0,
            after: Vec::new(),
            before: Vec::new(),
        };
        engine.add_planes();
        engine
    }

    /// The planes of all faces, and those along lines that are kept, upright on the faces beside them.
    fn add_planes(&mut self) {
        for face in 0..(self.surface.start.len() / 3) as u32 {
            if self.surface.corners(face)[0] != NONE {
                self.add_planes_of(face);
            }
        }
    }

    /// The plane of a face, and of its edges that are lines.
    fn add_planes_of(&mut self, face: u32) {
        let corners = self.surface.corners(face);
        let p = corners.map(|v| self.at[v as usize]);
        let (normal, doubled) = normal_of(p);
        if doubled.is_nan() || doubled <= 0.0 {
            return;
        }
        let plane = Quadric::of_plane(normal, p[0], doubled);
        for v in corners {
            self.quadric[v as usize].add(&plane);
        }
        for k in 0..3 {
            if !self.is_kept_line(3 * face + k as u32) {
                continue;
            }
            let along = difference(p[(k + 1) % 3], p[k]);
            let (upright, size) = unit(cross(along, normal));
            if size > 0.0 {
                let plane = Quadric::of_plane(upright, p[k], LINE_WEIGHT * dot(along, along));
                self.quadric[corners[k] as usize].add(&plane);
                self.quadric[corners[(k + 1) % 3] as usize].add(&plane);
            }
        }
    }

    /// Whether the edge of `h` is of a border or another line that is kept.
    #[inline]
    fn is_kept_line(&self, h: u32) -> bool {
        self.surface.twin[h as usize] == NONE || self.is_line[h as usize]
    }

    /// To where an edge would shrink, and what that costs; `None` where it may not.
    #[inline]
    fn target(&self, h: u32) -> Option<Shrink> {
        let (a, b) = (self.surface.start[h as usize], self.surface.end(h));
        let line = self.is_kept_line(h);
        let anchor = match (self.kind[a as usize], self.kind[b as usize]) {
            (Kind::Fixed | Kind::Tied, Kind::Fixed | Kind::Tied) => return None,
            (Kind::Smooth, Kind::Smooth) => Anchor::None,
            (Kind::Smooth, _) => Anchor::End,
            (_, Kind::Smooth) => Anchor::Start,
            _ if !line => return None,
            (Kind::Line, Kind::Line) => Anchor::None,
            (Kind::Line, _) => Anchor::End,
            (_, Kind::Line) => Anchor::Start,
        };
        let q = self.quadric[a as usize].plus(&self.quadric[b as usize]);
        let (p, r) = (self.at[a as usize], self.at[b as usize]);
        let along = difference(r, p);
        let square = dot(along, along);
        let (to, cost) = match anchor {
            Anchor::Start => (p, q.at(p)),
            Anchor::End => (r, q.at(r)),
            Anchor::None => {
                let middle = std::array::from_fn(|k| 0.5 * (p[k] + r[k]));
                let (to, cost) = q.least(middle);
                let off = difference(to, middle);
                // Planes that are almost parallel meet far away.
                if dot(off, off) <= FAR * square { (to, cost) } else { (middle, q.at(middle)) }
            }
        };
        let weight = q.weight();
        let cost = (cost + SHORT * square * weight) as f32 / per_weight(weight as f32);
        Some(Shrink { h, to, anchor, cost })
    }

    /// Puts an edge into the queue.
    #[inline]
    fn ask(&mut self, h: u32) {
        let twin = self.surface.twin[h as usize];
        let h = if twin < h { twin } else { h };
        if let Some(Shrink { cost, .. }) = self.target(h) {
            self.cost[h as usize] = cost;
            self.queue.put(cost, h);
        } else {
            self.cost[h as usize] = f32::NAN;
        }
    }

    /// Asks about every edge.
    fn ask_all(&mut self) {
        self.queue = Queue::new();
        for h in 0..self.surface.start.len() as u32 {
            if self.surface.start[h as usize] != NONE && h < self.surface.twin[h as usize] {
                self.ask(h);
            }
        }
    }

    /// Shrinks edges until there are few enough faces or nothing more may be done. `false` where the job was cancelled.
    pub fn run(&mut self, until: &Until<'_>, job: &Job) -> bool {
        self.ask_all();
        let mut steps = 0_u32;
        while self.surface.n_faces > until.faces {
            let Some((cost, h)) = self.queue.take() else { break };
            // What is no longer so was put in again.
            if self.cost[h as usize].to_bits() != cost.to_bits() {
                continue;
            }
            self.cost[h as usize] = f32::NAN;
            steps = steps.wrapping_add(1);
            // Once a millisecond, about.
            if steps.is_multiple_of(1024) && job.is_cancelled() {
                return false;
            }
            if let Some(shrink) = self.target(h)
                && self.stays_surface(h)
                && self.turns_nothing_over(&shrink)
                && self.stays_near(&shrink, until)
            {
                self.carry_out(&shrink);
            }
        }
        true
    }

    /// The position of the mesh that a vertex stands for: one for all fans that are tied there.
    #[inline]
    fn place_of(&self, v: u32) -> u32 {
        self.place[self.name[v as usize] as usize]
    }

    /// Whether the surface is still one without the edge: its ends have no neighbour in common but the apexes of its
    /// faces, and none of those loses its last face.
    fn stays_surface(&mut self, h: u32) -> bool {
        let s = &self.surface;
        let (a, b) = (s.start[h as usize], s.end(h));
        let across = s.twin[h as usize];
        if across != NONE && s.is_border(a) && s.is_border(b) {
            return false;
        }
        self.round += 1;
        let round = self.round;
        let mut n_common = 0;
        // A vertex on a border has one neighbour more than faces: the start of the last half-edge that arrives.
        let mut last = NONE;
        for g in self.surface.around(a) {
            let end = self.place_of(self.surface.end(g));
            self.seen[end as usize] = round;
            last = g;
        }
        let open = |last: u32| {
            let arrives = previous_in_face(last);
            (self.surface.twin[arrives as usize] == NONE).then(|| self.surface.start[arrives as usize])
        };
        if let Some(v) = open(last) {
            let v = self.place_of(v);
            self.seen[v as usize] = round;
        }
        last = NONE;
        for g in self.surface.around(b) {
            n_common += usize::from(self.seen[self.place_of(self.surface.end(g)) as usize] == round);
            last = g;
        }
        if let Some(v) = open(last) {
            n_common += usize::from(self.seen[self.place_of(v) as usize] == round);
        }
        let sides = if across == NONE { 1 } else { 2 };
        n_common == sides
            && [h, across].into_iter().take(sides).all(|side| self.keeps_apex(side))
            && self.ties_nothing(a, b)
    }

    /// Whether no new edge runs where the mesh may have one already: between two vertices that are tied, or from one to a
    /// neighbour of another fan of its position.
    fn ties_nothing(&self, a: u32, b: u32) -> bool {
        let tied = |v: u32| self.kind[v as usize] == Kind::Tied;
        if !tied(a) && !tied(b) {
            return true;
        }
        let (stays, goes) = if tied(a) { (a, b) } else { (b, a) };
        let around = |v: u32| {
            let s = &self.surface;
            s.around(v).flat_map(move |g| [s.end(g), s.start[previous_in_face(g) as usize]])
        };
        let place = self.place_of(stays);
        let is_other_fan = |v: u32| v != stays && self.place_of(v) == place;
        around(goes).filter(|v| *v != stays).all(|v| !tied(v) && !around(v).any(is_other_fan))
    }

    /// Whether the apex of a face has enough others: three inside of the surface, two at a border.
    fn keeps_apex(&self, side: u32) -> bool {
        let (next, previous) = (next_in_face(side), previous_in_face(side));
        // Two lines would become one.
        if self.is_kept_line(next) && self.is_kept_line(previous) {
            return false;
        }
        let apex = self.surface.start[previous as usize];
        let needed = if self.surface.is_border(apex) { 2 } else { 4 };
        self.surface.around(apex).take(needed).count() == needed
    }

    /// Collects the faces around the edge, and says whether none of them turns over.
    fn turns_nothing_over(&mut self, shrink: &Shrink) -> bool {
        let h = shrink.h;
        let (a, b) = (self.surface.start[h as usize], self.surface.end(h));
        let gone = [h / 3, self.surface.twin[h as usize] / 3];
        self.after.clear();
        self.before.clear();
        self.before.push(gone[0]);
        if self.surface.twin[h as usize] != NONE {
            self.before.push(gone[1]);
        }
        for v in [a, b] {
            for g in self.surface.around(v) {
                let face = g / 3;
                if face == gone[0] || face == gone[1] {
                    continue;
                }
                let x = self.at[self.surface.end(g) as usize];
                let y = self.at[self.surface.start[previous_in_face(g) as usize] as usize];
                let old = self.at[v as usize];
                let side = difference(y, x);
                let before = cross(difference(x, old), side);
                let now = cross(difference(x, shrink.to), side);
                let together = dot(before, now);
                let (bb, nn) = (dot(before, before), dot(now, now));
                // A face that has no area has no front to lose.
                if bb > 0.0 && (together <= 0.0 || together * together < LEAST_TURN * LEAST_TURN * bb * nn) {
                    return false;
                }
                if nn <= 0.0 {
                    return false;
                }
                self.after.push((face, [shrink.to, x, y]));
                self.before.push(face);
            }
        }
        true
    }

    /// How far the lines that an edge's ends stand for would be from the new point and its edges, at most: what they
    /// were, and how far the ends are from the edges. Where the surface ends its own distance says that.
    fn line_off(&self, shrink: &Shrink) -> f64 {
        let h = shrink.h;
        let across = self.surface.twin[h as usize];
        if across == NONE || !self.is_line[h as usize] {
            return 0.0;
        }
        let ends = [self.surface.start[h as usize], self.surface.end(h)];
        let mut most = 0.0;
        let mut next = Vec::new();
        for v in ends {
            most = if self.line_off[v as usize] > most { self.line_off[v as usize] } else { most };
            for g in self.surface.around(v) {
                let arrives = previous_in_face(g);
                let leaves = (self.is_kept_line(g)).then(|| self.surface.end(g));
                let open = self.surface.twin[arrives as usize] == NONE;
                let last = open.then(|| self.surface.start[arrives as usize]);
                next.extend(leaves.into_iter().chain(last).filter(|w| !ends.contains(w)));
            }
        }
        let off = |v: u32| {
            let p = self.at[v as usize];
            let to = |w: &u32| nearest_with_distance(p, [shrink.to, self.at[*w as usize], shrink.to]);
            let start = difference(p, shrink.to);
            next.iter().map(to).fold(dot(start, start), |least, x| if x < least { x } else { least })
        };
        let step = ends.map(off);
        most + (if step[0] > step[1] { step[0] } else { step[1] }).sqrt()
    }

    /// The box around the faces that change, and what they become.
    fn place_of_change(&self, shrink: &Shrink) -> Box3 {
        let corners = self.before.iter().flat_map(|face| self.surface.corners(*face));
        Box3::around(corners.map(|v| &self.at[v as usize]).chain([&shrink.to]))
    }

    /// Whether the surface stays near to the original, as far as somebody watches.
    fn stays_near(&mut self, shrink: &Shrink, until: &Until<'_>) -> bool {
        if self.watch.is_some()
            && !until.room.holds_around(|| self.place_of_change(shrink), self.line_off(shrink))
        {
            return false;
        }
        let Some(watch) = &mut self.watch else { return true };
        let (before, after) = (&self.before, &self.after);
        watch.allows(
            Change { before, after, to: shrink.to, surface: &self.surface, at: &self.at, cost: shrink.cost },
            until.room,
        )
    }

    /// The rows of the corners around the edge, as they will be.
    fn move_wedges(&mut self, shrink: &Shrink) {
        let Some(wedges) = &mut self.wedges else { return };
        let (h, across) = (shrink.h, self.surface.twin[shrink.h as usize]);
        // Left and right of the edge, at its start and at its end.
        let mut at_start = [wedges.of[h as usize], NONE];
        let mut at_end = [wedges.of[next_in_face(h) as usize], NONE];
        if across != NONE {
            at_start[1] = wedges.of[next_in_face(across) as usize];
            at_end[1] = wedges.of[across as usize];
        }
        let goes_from_start = shrink.anchor != Anchor::Start;
        if shrink.anchor == Anchor::None {
            if self.kind[self.surface.start[h as usize] as usize] == Kind::Smooth {
                let values = blend_around(wedges, &self.surface, &self.at, (shrink, &self.before));
                wedges.put(at_end[0], &values);
            } else {
                let [p, r] =
                    [self.surface.start[h as usize], self.surface.end(h)].map(|v| self.at[v as usize]);
                let along = difference(r, p);
                let t = dot(difference(shrink.to, p), along) / dot(along, along);
                let t = if t > 0.0 { if t < 1.0 { t } else { 1.0 } } else { 0.0 };
                let values: Vec<_> = (0..2)
                    .filter(|side| at_end[*side] != NONE)
                    .map(|side| (at_end[side], wedges.blend(&[(at_start[side], 1.0 - t), (at_end[side], t)])))
                    .collect();
                values.iter().for_each(|(wedge, values)| wedges.put(*wedge, values));
            }
        }
        let [left, right] = if goes_from_start { at_end } else { at_start };
        let end = Handed { h, at_start: goes_from_start, left, right };
        wedges.hand_over(&self.surface, &self.is_line, &end);
    }

    fn carry_out(&mut self, shrink: &Shrink) {
        let h = shrink.h;
        let (a, b) = (self.surface.start[h as usize], self.surface.end(h));
        self.move_wedges(shrink);
        if let Some(watch) = &mut self.watch {
            watch.samples.settle(&self.before);
        }
        self.after.iter().for_each(|(face, _)| self.made_at[*face as usize] = shrink.cost);
        if self.watch.is_some() {
            self.line_off[b as usize] = self.line_off(shrink);
        }
        let sum = self.quadric[a as usize];
        self.quadric[b as usize].add(&sum);
        if shrink.anchor != Anchor::End {
            let from_start = shrink.anchor == Anchor::Start;
            self.is_original[b as usize] = from_start && self.is_original[a as usize];
            if from_start {
                self.kind[b as usize] = self.kind[a as usize];
                self.name[b as usize] = self.name[a as usize];
            }
        }
        self.at[b as usize] = shrink.to;
        let across = self.surface.twin[h as usize];
        // Each pair of edges that become one is a line if one of the two was.
        for side in [h, across] {
            if side == NONE {
                continue;
            }
            for g in [next_in_face(side), previous_in_face(side)] {
                self.cost[g as usize] = f32::NAN;
                let t = self.surface.twin[g as usize];
                if t != NONE {
                    self.cost[t as usize] = f32::NAN;
                }
            }
            self.cost[side as usize] = f32::NAN;
            let [x, y] = [next_in_face(side), previous_in_face(side)].map(|g| self.surface.twin[g as usize]);
            let line =
                self.is_line[next_in_face(side) as usize] || self.is_line[previous_in_face(side) as usize];
            for t in [x, y] {
                if t != NONE {
                    self.is_line[t as usize] = line;
                }
            }
        }
        self.surface.collapse(h);
        let first = self.surface.out[b as usize];
        let mut g = first;
        loop {
            self.ask(g);
            let arrives = previous_in_face(g);
            g = self.surface.twin[arrives as usize];
            if g == NONE {
                self.ask(arrives);
                break;
            }
            if g == first {
                break;
            }
        }
    }
}

/// The values where the new point is nearest to the faces before.
fn blend_around(
    wedges: &Wedges,
    surface: &Surface,
    at: &[[f64; 3]],
    (shrink, before): (&Shrink, &[u32]),
) -> Vec<f64> {
    let corners = |face: u32| surface.corners(face).map(|v| at[v as usize]);
    let nearest = before.iter().fold((f64::INFINITY, before[0]), |best, &face| {
        let d = nearest_with_distance(shrink.to, corners(face));
        if d < best.0 { (d, face) } else { best }
    });
    let weights = nearest_on_triangle(shrink.to, corners(nearest.1));
    let parts: [(u32, f64); 3] = std::array::from_fn(|k| (wedges.of[3 * nearest.1 as usize + k], weights[k]));
    wedges.blend(&parts)
}

/// The weight of planes along lines, for the square of an edge's length. Chosen: above the weight of a face that has the edge.
const LINE_WEIGHT: f64 = 2.0;
/// How far from the middle of an edge its point may lie, as a multiple of its length, squared.
const FAR: f64 = 4.0;

/// The unit normal and twice the area.
#[inline]
fn normal_of(p: [[f64; 3]; 3]) -> ([f64; 3], f64) {
    unit(cross(difference(p[1], p[0]), difference(p[2], p[0])))
}

#[inline]
fn unit(v: [f64; 3]) -> ([f64; 3], f64) {
    let size = dot(v, v).sqrt();
    (v.map(|x| x / size), size)
}
