//! `Cells`: an octree of where the surface may be, with what slopes the field has there.
use super::super::{Field, Graph, LeafError, Quality, Slope, Tape, Term};
use crate::budget::{Job, par_map};
use crate::math::{Box3, Interval};

/// Levels at which cells first may stay, and at which they all do: cells of a 32nd to a 128th of the size. Chosen by
/// timing pictures; finer ones take longer to make than they save.
const FIRST: u32 = 5;
const LAST: u32 = 7;
/// Cells at the most before dividing ends: about 100 MB.
const MOST_CELLS: usize = 500_000;
/// Shorter tapes gain nothing by being shortened, and one tape for all makes large batches.
const SHORT: usize = 48;
/// Cells worked on at once: enough for batches, and enough of them for all threads.
const CHUNK: usize = 256;
/// The share of the size that is added around it, different below and above, so that flat faces and planes of symmetry
/// do not lie between two cells.
const MARGIN: [f64; 2] = [0.0137, 0.0171];
/// The widest range of slopes, as a share of their middle, that steps are long enough with.
const NARROW: f64 = 0.35;

/// Why there are no cells.
#[derive(Clone, Debug)]
pub enum Unbounded {
    /// The box is empty, a single point, or reaches to infinity.
    Region(Box3),
    /// A leaf failed.
    Leaf(LeafError),
}

impl std::fmt::Display for Unbounded {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Region(b) => write!(f, "there is no finite box to look in: {:?} to {:?}", b.min, b.max),
            Self::Leaf(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for Unbounded {}

impl From<LeafError> for Unbounded {
    fn from(error: LeafError) -> Self {
        Self::Leaf(error)
    }
}

/// A part of space: 8 parts in a row of the list, or a cell, or nothing of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Outside,
    Inside,
    Parts(u32),
    Cell(u32),
}

/// A part in which the surface may be.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    pub bounds: Box3,
    /// Ranges of the slopes along x, y and z; infinite where nothing is known.
    pub slopes: [[f64; 2]; 3],
    pub tape: u32,
}

/// Where the surface of a field may be: everything outside of these cells is proved to be on one side, by ranges, or by
/// the field's word for its distance. Each cell has a tape that is right inside of it, and a range of slopes.
#[derive(Clone, Debug)]
pub struct Cells {
    pub(super) corner: [f64; 3],
    pub(super) size: f64,
    pub(super) parts: Vec<Part>,
    pub(super) cells: Vec<Cell>,
    pub(super) tapes: Vec<Tape>,
    /// The word for the value along beams outside and inside, where the tapes are those of the value.
    pub(super) word: [bool; 2],
    /// How many points a call of the tape should have.
    pub(super) batch: usize,
    rooms: Vec<Room>,
    occupied: Box3,
}

/// One of `ACROSS³` equal parts of the cube.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    part: u32,
    /// So many rooms around it, in every direction, are on the same side as all of it.
    pub clear: u8,
    /// 1 outside, −1 inside, 0 where the surface may be.
    pub side: i8,
}

/// Rooms along a side of the cube.
const ACROSS: u32 = 1 << FIRST;

fn room_index([x, y, z]: [u32; 3]) -> usize {
    ((z * ACROSS + y) * ACROSS + x) as usize
}

/// The rooms of an octree: from a place to its part without going down from the top, and far over empty ones.
fn rooms_of(parts: &[Part]) -> Vec<Room> {
    let mut rooms = vec![Room { part: 0, clear: 0, side: 0 }; (ACROSS * ACROSS * ACROSS) as usize];
    let mut open = vec![(0, [0, 0, 0], ACROSS)];
    while let Some((part, at, width)) = open.pop() {
        match parts[part as usize] {
            Part::Parts(first) if width > 1 => {
                let half = width / 2;
                for i in 0..8 {
                    open.push((first + i, [0, 1, 2].map(|k| at[k] + half * (i >> k & 1)), half));
                }
            }
            _ => {
                let side = match parts[part as usize] {
                    Part::Outside => 1,
                    Part::Inside => -1,
                    Part::Cell(_) | Part::Parts(_) => 0,
                };
                for z in at[2]..at[2] + width {
                    for y in at[1]..at[1] + width {
                        let row = room_index([at[0], y, z]);
                        rooms[row..row + width as usize].fill(Room { part, clear: 0, side });
                    }
                }
            }
        }
    }
    // The distance to the next room that is not on the same side, in rooms, found a ring at a time: along x, y and z in
    // turn, since the largest of three differences is what counts.
    let sides: Vec<i8> = rooms.iter().map(|room| room.side).collect();
    let mut clear: Vec<u8> = sides.iter().map(|side| u8::from(*side != 0)).collect();
    for ring in 1..ACROSS as u8 {
        // A room stays clear where it and all its neighbours are, on one side.
        let mut next = clear.clone();
        for stride in [1, ACROSS as usize, (ACROSS * ACROSS) as usize] {
            let before = next.clone();
            for (k, keeps) in next.iter_mut().enumerate() {
                let at = k / stride % ACROSS as usize;
                let same = |other: usize| before[other] == 1 && sides[other] == sides[k];
                let low = at == 0 || same(k - stride);
                let high = at + 1 == ACROSS as usize || same(k + stride);
                *keeps &= u8::from(low && high);
            }
        }
        clear = next;
        if clear.iter().all(|c| *c == 0) {
            break;
        }
        for (room, clear) in rooms.iter_mut().zip(&clear) {
            if *clear == 1 {
                room.clear = ring;
            }
        }
    }
    rooms
}

struct Open {
    part: u32,
    bounds: Box3,
    tape: u32,
}

/// What was found of one part.
struct Found {
    part: Part,
    slopes: [[f64; 2]; 3],
    settled: bool,
    tape: Option<Tape>,
}

const UNKNOWN_SLOPES: [[f64; 2]; 3] = [[f64::NEG_INFINITY, f64::INFINITY]; 3];

impl Cells {
    /// Divides the field's own box, cut to `region` where there is one.
    ///
    /// Cost: ranges for about 8 times the cells that the surface passes through at a 32nd of the size, more where its
    /// slopes turn quickly.
    ///
    /// # Errors
    /// [`Unbounded`] when there is no finite box, or when a leaf fails.
    pub fn of(field: &Field, job: &Job) -> Result<Self, Unbounded> {
        let place = field.bounds();
        let finite = |x: &f64| x.is_finite();
        let longest = (0..3).map(|k| place.max[k] - place.min[k]).fold(0.0, |a, b| if b > a { b } else { a });
        let flat = [0, 1, 2].iter().any(|k| place.min[*k] > place.max[*k]);
        if flat || !place.min.iter().chain(&place.max).all(finite) || !(longest > 0.0 && longest.is_finite())
        {
            return Err(Unbounded::Region(place));
        }
        let size = longest * (1.0 + MARGIN[0] + MARGIN[1]);
        let middle = place.centre();
        let corner = middle.map(|m| m - (0.5 + MARGIN[0]) * longest);
        let own_sign = field.has_own_sign();
        let tape = Tape::of(field.sign());
        let worth = field.distance();
        let word = [worth.outside, worth.inside].map(|quality| !own_sign && quality >= Quality::Bound);
        let batch = batch_of(&Graph::of(field.sign()));
        let mut cells = Self {
            corner,
            size,
            parts: vec![Part::Outside],
            cells: Vec::new(),
            tapes: vec![tape],
            word,
            batch,
            rooms: Vec::new(),
            occupied: Box3::EMPTY,
        };
        cells.divide(&place, job)?;
        cells.rooms = rooms_of(&cells.parts);
        Ok(cells)
    }

    /// A box around the surface and all that is inside.
    #[must_use]
    pub fn occupied(&self) -> Box3 {
        self.occupied
    }

    /// The corners of all cells: points around the surface.
    pub fn corners(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.cells.iter().flat_map(|cell| {
            let b = cell.bounds;
            (0..8).map(move |i| [0, 1, 2].map(|k| if i >> k & 1 == 0 { b.min[k] } else { b.max[k] }))
        })
    }

    /// How many cells the surface may pass through.
    #[must_use]
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// Whether there is no surface at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// The side of the cube that was divided.
    #[must_use]
    pub fn size(&self) -> f64 {
        self.size
    }

    /// The tape of the whole surface.
    #[must_use]
    pub fn tape(&self) -> &Tape {
        &self.tapes[0]
    }

    /// The room of a place in rooms; beyond the cube it is the nearest one.
    pub(super) fn room_at(&self, at: [f64; 3]) -> ([u32; 3], &Room) {
        // A negative number becomes 0.
        let at = at.map(|x| (x as u32).min(ACROSS - 1));
        (at, &self.rooms[room_index(at)])
    }

    /// The cell in a room of several parts that a place is in, or the side of the part, with the part's box.
    pub(super) fn part_in(&self, room: &Room, at: [u32; 3], p: [f64; 3]) -> (Part, Box3) {
        let side = self.room_side();
        let mut min: [f64; 3] = std::array::from_fn(|k| self.corner[k] + f64::from(at[k]) * side);
        let mut max: [f64; 3] = std::array::from_fn(|k| self.corner[k] + f64::from(at[k] + 1) * side);
        let mut part = self.parts[room.part as usize];
        while let Part::Parts(first) = part {
            let mut octant = 0;
            for k in 0..3 {
                let middle = 0.5 * min[k] + 0.5 * max[k];
                if p[k] >= middle {
                    octant |= 1 << k;
                    min[k] = middle;
                } else {
                    max[k] = middle;
                }
            }
            part = self.parts[first as usize + octant];
        }
        (part, Box3 { min, max })
    }

    /// The side of a room.
    pub(super) fn room_side(&self) -> f64 {
        self.size / f64::from(ACROSS)
    }

    /// The tape that is right at a place: of its cell, else the whole one.
    pub(super) fn tape_at(&self, p: [f64; 3]) -> u32 {
        let (at, room) = self.room_at([0, 1, 2].map(|k| (p[k] - self.corner[k]) / self.room_side()));
        if let (Part::Cell(cell), _) = self.part_in(room, at, p) { self.cells[cell as usize].tape } else { 0 }
    }

    fn divide(&mut self, place: &Box3, job: &Job) -> Result<(), Unbounded> {
        let all = Box3 { min: self.corner, max: self.corner.map(|x| x + self.size) };
        let mut open = vec![Open { part: 0, bounds: all, tape: 0 }];
        let mut level = 0;
        while !open.is_empty() {
            let many = open.len() + self.cells.len() > MOST_CELLS || job.is_cancelled();
            let chunks: Vec<&[Open]> = open.chunks(CHUNK).collect();
            let this = &*self;
            let found = par_map(job, &chunks, |_, chunk| this.look(chunk, place, level));
            let mut next = Vec::new();
            for (chunk, found) in chunks.iter().zip(found) {
                for (one, found) in chunk.iter().zip(found?) {
                    self.place_part(one, found, (level == LAST || many, &mut next));
                }
            }
            open = next;
            level += 1;
        }
        Ok(())
    }

    fn place_part(&mut self, one: &Open, found: Found, (last, next): (bool, &mut Vec<Open>)) {
        let tape = match found.tape {
            Some(tape) => {
                self.tapes.push(tape);
                self.tapes.len() as u32 - 1
            }
            None => one.tape,
        };
        self.parts[one.part as usize] = match found.part {
            Part::Outside => Part::Outside,
            Part::Inside => {
                self.occupied = self.occupied.union(one.bounds);
                Part::Inside
            }
            _ if last || found.settled => {
                self.occupied = self.occupied.union(one.bounds);
                self.cells.push(Cell { bounds: one.bounds, slopes: found.slopes, tape });
                Part::Cell(self.cells.len() as u32 - 1)
            }
            _ => {
                let first = self.parts.len() as u32;
                for i in 0..8 {
                    self.parts.push(Part::Outside);
                    next.push(Open { part: first + i, bounds: octant(&one.bounds, i), tape });
                }
                Part::Parts(first)
            }
        };
    }

    fn look(&self, open: &[Open], place: &Box3, level: u32) -> Result<Vec<Found>, LeafError> {
        let boxes: Vec<Box3> = open.iter().map(|one| one.bounds).collect();
        let mut ranges = vec![Interval::UNKNOWN; open.len()];
        // Neighbours in the list mostly share a tape.
        let mut start = 0;
        for run in open.chunk_by(|a, b| a.tape == b.tape) {
            let rows = start..start + run.len();
            self.tapes[run[0].tape as usize].over(&boxes[rows.clone()], &mut ranges[rows])?;
            start += run.len();
        }
        let mut found = Vec::with_capacity(open.len());
        for (one, range) in open.iter().zip(&ranges) {
            found.push(self.look_at(one, *range, (place, level))?);
        }
        Ok(found)
    }

    fn look_at(&self, one: &Open, range: Interval, (place, level): (&Box3, u32)) -> Result<Found, LeafError> {
        let tape = &self.tapes[one.tape as usize];
        let settled = |part| Found { part, slopes: UNKNOWN_SLOPES, settled: true, tape: None };
        let apart = (0..3).any(|k| one.bounds.min[k] > place.max[k] || one.bounds.max[k] < place.min[k]);
        if apart {
            return Ok(settled(Part::Outside));
        }
        let range = if range.is_entire() { self.by_word(one, range)? } else { range };
        if let Some(part) = side_of(range) {
            return Ok(settled(part));
        }
        let mut found = Found { part: Part::Cell(0), slopes: UNKNOWN_SLOPES, settled: false, tape: None };
        let shortens = level.is_multiple_of(2) && level > 0;
        if shortens && tape.len() > SHORT {
            let (_, shorter) = tape.shortened(&one.bounds)?;
            found.tape = shorter.filter(|shorter| 4 * shorter.len() <= 3 * tape.len());
        }
        if level < FIRST {
            return Ok(found);
        }
        let mut slope = [Slope { value: Interval::UNKNOWN, gradient: [Interval::UNKNOWN; 3] }];
        tape.gradient_over(&[one.bounds], &mut slope)?;
        let gradient = slope[0].gradient;
        // Slopes say nothing across a gap where there is no value.
        let defined = slope[0].value.is_defined() && gradient.iter().all(|g| g.is_defined());
        if !defined || gradient.iter().any(|g| g.is_empty()) {
            found.settled = range.is_entire();
            return Ok(found);
        }
        found.slopes = gradient.map(|g| [g.lo(), g.hi()]);
        // The mean value theorem: tighter than the range itself where slopes hardly turn.
        let middle = one.bounds.centre();
        let mut at = [Interval::UNKNOWN];
        tape.over(&[Box3 { min: middle, max: middle }], &mut at)?;
        let sum = (0..3).fold(at[0], |sum, k| {
            let off = Interval::new(one.bounds.min[k], one.bounds.max[k]).unwrap_or(Interval::UNKNOWN)
                - Interval::point(middle[k]);
            sum + gradient[k] * off
        });
        if let Some(part) = side_of(sum) {
            return Ok(settled(part));
        }
        found.settled = range.is_entire() || narrow(&gradient);
        Ok(found)
    }

    /// Where no range is known, the word for the value as a distance may clear a part.
    fn by_word(&self, one: &Open, range: Interval) -> Result<Interval, LeafError> {
        let mut value = [f64::NAN];
        self.tapes[one.tape as usize].at(&[one.bounds.centre()], &mut value)?;
        // Half the diagonal, rounded well up.
        let reach = 0.500_001 * one.bounds.diagonal();
        let clear = if value[0] > reach { self.word[0] } else { value[0] < -reach && self.word[1] };
        Ok(if clear { Interval::point(value[0]) } else { range })
    }
}

/// Points inside are those with a negative value; ranges hold all values that there are.
fn side_of(range: Interval) -> Option<Part> {
    if range.is_empty() || range.lo() >= 0.0 {
        return Some(Part::Outside);
    }
    (range.hi() < 0.0 && range.is_defined()).then_some(Part::Inside)
}

fn narrow(gradient: &[Interval; 3]) -> bool {
    let (mut middle, mut width) = (0.0, 0.0);
    for g in gradient {
        let (m, w) = (0.5 * (g.lo() + g.hi()), 0.5 * (g.hi() - g.lo()));
        middle += m * m;
        width += w * w;
    }
    width <= NARROW * NARROW * middle
}

fn octant(b: &Box3, i: u32) -> Box3 {
    let middle = b.centre();
    let pick = |k: usize, low: f64, high: f64| if i >> k & 1 == 0 { low } else { high };
    Box3 {
        min: [0, 1, 2].map(|k| pick(k, b.min[k], middle[k])),
        max: [0, 1, 2].map(|k| pick(k, middle[k], b.max[k])),
    }
}

/// Expressions run best in blocks that stay in the processor's caches; leaves want what they want.
fn batch_of(graph: &Graph) -> usize {
    graph.terms().iter().fold(1024, |most, term| match term {
        Term::Leaf(leaf, _) if leaf.preferred_batch() > most => leaf.preferred_batch(),
        _ => most,
    })
}
