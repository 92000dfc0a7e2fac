//! `EarClipper`: cuts ears off one flat polygon until a triangle remains.
use super::blockers::Blockers;
use super::turn;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

/// The budget of steps per corner in the search for blocked ears. Chosen: real-world outlines take 20 to 60;
/// at 1,024 a hostile polygon still costs only some microseconds per corner. Beyond it, ears are cut untested
/// and the folds counted.
const WORK_PER_CORNER: u64 = 1024;

/// The test that an ear has to pass.
#[derive(Clone, Copy, PartialEq, Eq)]
enum EarRule {
    /// No corner in the closed ear, except those that coincide with its own corners.
    Strict,
    /// No corner in the open ear: for polygons that touch themselves.
    Touching,
}

/// A corner with its version when it was queued. The version counts changes of its neighbours; a newer one
/// makes the entry stale.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct QueuedEar {
    corner: u32,
    version: u32,
}

/// The remaining ring of corners, and the queues of candidates.
#[derive(Clone, Debug, Default)]
pub(super) struct EarClipper {
    prev: Vec<u32>,
    next: Vec<u32>,
    version: Vec<u32>,
    /// Corners where the outline reverses. These are cut first: until then, the corners at the base of a
    /// spike look like ears but are none.
    spikes: Vec<QueuedEar>,
    strict: VecDeque<QueuedEar>,
    touching: VecDeque<QueuedEar>,
    /// By area, smallest first: cut when no ear remains.
    forced: BinaryHeap<Reverse<(u64, QueuedEar)>>,
    stuck: bool,
    /// A corner of the ring.
    anchor: u32,
    blockers: Blockers,
    work: u64,
}

impl EarClipper {
    /// Appends the n − 2 triangles of the counter-clockwise polygon and returns the number that face
    /// backwards.
    pub(super) fn cut(&mut self, points: &[[f64; 2]], out: &mut Vec<[u32; 3]>) -> usize {
        self.start(points);
        let (mut n_left, mut folded) = (points.len(), 0);
        while n_left > 3 {
            let ear = self.pop(points);
            let (a, c) = (self.prev[ear as usize], self.next[ear as usize]);
            folded += usize::from(self.turn_at(points, ear) < 0.0);
            out.push([a, ear, c]);
            self.remove(points, ear);
            n_left -= 1;
            if n_left == 3 {
                folded += usize::from(self.turn_at(points, c) < 0.0);
                out.push([a, c, self.next[c as usize]]);
            }
        }
        folded
    }

    fn start(&mut self, points: &[[f64; 2]]) {
        let n = points.len() as u32;
        self.prev.clear();
        self.prev.extend((0..n).map(|i| if i == 0 { n - 1 } else { i - 1 }));
        self.next.clear();
        self.next.extend((0..n).map(|i| if i + 1 == n { 0 } else { i + 1 }));
        self.version.clear();
        self.version.resize(points.len(), 0);
        self.work = WORK_PER_CORNER * u64::from(n);
        self.stuck = false;
        self.anchor = 0;
        self.touching.clear();
        self.forced.clear();
        self.strict.clear();
        self.spikes.clear();
        self.strict.extend((0..n).map(|corner| QueuedEar { corner, version: 0 }));
        let mut blockers = std::mem::take(&mut self.blockers);
        let mut spikes = std::mem::take(&mut self.spikes);
        blockers.build(
            points,
            (0..n).filter(|corner| {
                let turn = self.turn_at(points, *corner);
                if turn == 0.0 && self.is_spike(points, *corner) {
                    spikes.push(QueuedEar { corner: *corner, version: 0 });
                }
                // If any corner of the polygon lies in a triangle of three consecutive ones, one
                // that is not convex does too, so convex corners need not be in the tree.
                turn <= 0.0
            }),
        );
        (self.blockers, self.spikes) = (blockers, spikes);
    }

    fn turn_at(&self, points: &[[f64; 2]], corner: u32) -> f64 {
        let [a, b, c] = [self.prev[corner as usize], corner, self.next[corner as usize]];
        turn(points[a as usize], points[b as usize], points[c as usize])
    }

    /// Whether the outline reverses, or has a side of length zero, at a corner that turns neither left nor
    /// right.
    fn is_spike(&self, points: &[[f64; 2]], corner: u32) -> bool {
        let [a, b, c] =
            [self.prev[corner as usize], corner, self.next[corner as usize]].map(|i| points[i as usize]);
        // The outline goes straight on if each coordinate continues in the same direction.
        (0..2).any(|k| (b[k] >= a[k] && c[k] < b[k]) || (b[k] <= a[k] && c[k] > b[k])) || a == b || b == c
    }

    /// The next corner to cut: a spike, otherwise a strict ear, otherwise a touching one, otherwise the
    /// smallest triangle that does not face backwards.
    fn pop(&mut self, points: &[[f64; 2]]) -> u32 {
        while let Some(entry) = self.spikes.pop() {
            if self.is_current(entry) {
                return entry.corner;
            }
        }
        while let Some(entry) = self.strict.pop_front() {
            if self.is_current(entry) && self.is_ear(points, entry.corner, EarRule::Strict) {
                return entry.corner;
            }
        }
        // From here on strict ears alone do not suffice. All corners are queued for the other rules
        // once, and later ones as they change.
        if !self.stuck {
            self.stuck = true;
            for corner in 0..points.len() as u32 {
                self.queue_late(points, corner);
            }
        }
        while let Some(entry) = self.touching.pop_front() {
            if self.is_current(entry) && self.is_ear(points, entry.corner, EarRule::Touching) {
                return entry.corner;
            }
        }
        while let Some(Reverse((_, entry))) = self.forced.pop() {
            if self.is_current(entry) {
                return entry.corner;
            }
        }
        // Unreachable, since `queue_late` ran for every corner of the ring; in any case this is one of them.
        self.anchor
    }

    fn is_current(&self, entry: QueuedEar) -> bool {
        self.version[entry.corner as usize] == entry.version
    }

    fn queue_late(&mut self, points: &[[f64; 2]], corner: u32) {
        let version = self.version[corner as usize];
        if version == u32::MAX {
            return;
        }
        let entry = QueuedEar { corner, version };
        let area = self.turn_at(points, corner);
        self.touching.push_back(entry);
        // Positive numbers sort like their bits; triangles that face backwards come after all others.
        let rank = if area >= 0.0 { area.abs().to_bits() } else { u64::MAX };
        self.forced.push(Reverse((rank, entry)));
    }

    fn is_ear(&mut self, points: &[[f64; 2]], corner: u32, rule: EarRule) -> bool {
        let at = |i: u32| points[i as usize];
        let (ia, ic) = (self.prev[corner as usize], self.next[corner as usize]);
        let [a, b, c] = [at(ia), at(corner), at(ic)];
        if turn(a, b, c) <= 0.0 {
            return false;
        }
        let (prev, next) = (&self.prev, &self.next);
        let blocks = |i: u32| {
            let p = at(i);
            if i == ia || i == ic || i == corner {
                return false;
            }
            let sides = [turn(a, b, p), turn(b, c, p), turn(c, a, p)];
            if sides.iter().any(|s| *s < 0.0) {
                return false;
            }
            if rule == EarRule::Strict && p != a && p != b && p != c {
                return true;
            }
            // A corner on the boundary of the ear blocks it if one of the corner's edges enters the ear. A
            // corner inside the ear has no side to test, and always blocks.
            let enters =
                |q: [f64; 2]| (0..3).all(|k| sides[k] > 0.0 || turn([a, b, c][k], [b, c, a][k], q) > 0.0);
            enters(at(prev[i as usize])) || enters(at(next[i as usize]))
        };
        !self.blockers.any(points, [a, b, c], &mut self.work, blocks)
    }

    fn remove(&mut self, points: &[[f64; 2]], ear: u32) {
        let (a, c) = (self.prev[ear as usize], self.next[ear as usize]);
        self.next[a as usize] = c;
        self.prev[c as usize] = a;
        self.anchor = c;
        // The last version, which no entry can have: all entries of this corner become stale.
        self.version[ear as usize] = u32::MAX;
        self.blockers.remove(ear);
        for corner in [a, c] {
            self.version[corner as usize] += 1;
            let turn = self.turn_at(points, corner);
            // Now convex, so it blocks no more. Corners never become less convex while ears are cut
            // off.
            if turn > 0.0 {
                self.blockers.remove(corner);
            }
            let entry = QueuedEar { corner, version: self.version[corner as usize] };
            if turn == 0.0 && self.is_spike(points, corner) {
                self.spikes.push(entry);
            }
            self.strict.push_back(entry);
            if self.stuck {
                self.queue_late(points, corner);
            }
        }
    }
}
