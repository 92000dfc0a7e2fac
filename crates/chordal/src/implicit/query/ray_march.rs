//! `BeamMarcher`: one beam on its way through the cells, advanced by one value at a time.
//!
//! In a cell the slope of the field along the beam lies in a known interval `[a, b]`, so from a value `f`
//! outside the surface is at least `f / −a` ahead, and at least `f / b` behind. These reaches are free. Steps
//! are longer than the first by a factor, and taken back if the reaches from both of their ends do not cover
//! them. Where the slope is surely negative there is at most one root, and it is bracketed at once. If the
//! field's value never exceeds the distance, the value is a reach too.
//!
//! Sources: E. Galin et al., *Segment tracing using local Lipschitz bounds*, 2020, for slopes of a part of
//! space; B. Keinert et al., *Enhanced sphere tracing*, 2014, for longer steps that are taken back, and for
//! the cone.
use super::beam::{Beam, BeamHit, BeamRecord};
use super::bracket::RootBracket;
use super::octree::{FieldOctree, FieldOctreeCell};
use super::point_queries::along;
use super::voxels::Voxel;
use crate::math::{dot, greater, lesser};

/// The factor by which steps are longer than the free reach. Measured from 1.2 to 1.6: hardly any difference.
const LONGER: f64 = 1.4;
/// The shortest step, as a fraction of the beam's radius: thinner details may be missed; such beams are
/// counted.
const SHORTEST: f64 = 0.25;
/// The most values for one beam.
const MOST_STEPS: u32 = 1500;
/// Steps along an entire beam if no slope is bounded: half of [`MOST_STEPS`].
const COARSE_STEPS: f64 = 750.0;
/// The width of a bracket around a hit as a fraction of the size: 2⁻⁴², far above the rounding of positions
/// (2⁻⁵²).
const WIDTH: f64 = 1.0 / 4_398_046_511_104.0;
/// The distance by which a beam is moved across the border of a cell, as a fraction of the size: 2⁻³⁶. The
/// points between are covered from the other side.
const NUDGE: f64 = 1.0 / 68_719_476_736.0;

/// The query that a beam answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum HitQuery {
    /// The first hit with the surface.
    First,
    /// Whether there is any hit, or the beam starts inside.
    Any,
}

/// The result of crossing a cell before any value is evaluated.
enum CellCrossing {
    /// There is no hit in it.
    Free,
    /// Values must be evaluated.
    Open,
    /// There is a hit, or the next value is awaited.
    Settled,
}

#[derive(Clone, Copy, Debug)]
enum MarchState {
    /// Waits for the value where it enters a cell.
    Enter,
    /// Waits for the value `stride` ahead; the beam is free for `reach`.
    Step {
        stride: f64,
        reach: f64,
        sure: bool,
    },
    /// Waits for the value in a bracket.
    Narrow(RootBracket),
    Done,
}

/// A beam on its way. Lengths count from the point where it enters the cube of the cells.
#[derive(Clone, Debug)]
pub(super) struct BeamMarcher {
    pub beam: u32,
    pub tape: u32,
    origin: [f64; 3],
    direction: [f64; 3],
    inverse: [f64; 3],
    /// Origin and direction in voxels from the corner of the cube, and the length from one voxel to the next
    /// along each axis; +∞ if the beam is perpendicular to the axis.
    in_voxels: [[f64; 3]; 2],
    per_voxel: [f64; 3],
    /// The length of the given direction, and the length before the cube.
    scale: f64,
    before: f64,
    cone: [f64; 2],
    hit_query: HitQuery,
    t: f64,
    end: f64,
    value: f64,
    /// A lower bound of the value where the beam enters the cell.
    least: f64,
    /// The last position known to be on the side on which the beam started.
    clear: f64,
    started: bool,
    /// −1 for a beam that starts inside and looks for the exit.
    side: f64,
    cell_end: f64,
    slope: [f64; 2],
    state: MarchState,
    query: f64,
    steps: u32,
    /// The first position where something may have been missed; +∞ if there is none.
    gap: f64,
    record: BeamRecord,
}

impl BeamMarcher {
    /// `None` for a beam that misses the cube.
    pub fn new(cells: &FieldOctree, beam: &Beam, hit_query: HitQuery) -> Option<Self> {
        let scale = dot(beam.direction, beam.direction).sqrt();
        let direction = beam.direction.map(|d| d / scale);
        if !(scale > 0.0 && scale.is_finite() && beam.origin.iter().all(|x| x.is_finite())) {
            return None;
        }
        let inverse = direction.map(|d| 1.0 / d);
        let bounds = cells.occupied();
        let (mut from, mut to) = (beam.from * scale, beam.to * scale);
        for k in 0..3 {
            let (low, high) = (bounds.min[k], bounds.max[k]);
            if direction[k] == 0.0 {
                if beam.origin[k] < low || beam.origin[k] > high {
                    return None;
                }
                continue;
            }
            let ends = [low, high].map(|x| (x - beam.origin[k]) * inverse[k]);
            let [near, far] = if inverse[k] < 0.0 { [ends[1], ends[0]] } else { ends };
            from = greater(near, from);
            to = lesser(far, to);
        }
        if from > to || from.is_nan() || to.is_nan() {
            return None;
        }
        let start = along(beam.origin, direction, from);
        let side = cells.voxel_size();
        let inward = [0, 1, 2].map(|k| (start[k] - cells.corner[k]) / side);
        let steps = direction.map(|d| d / side);
        Some(Self {
            beam: 0,
            in_voxels: [inward, steps],
            per_voxel: steps.map(|d| if d == 0.0 { f64::INFINITY } else { 1.0 / d }),
            tape: 0,
            origin: start,
            direction,
            inverse,
            scale,
            before: from,
            cone: [beam.cone[0] + beam.cone[1] * from, beam.cone[1]],
            hit_query,
            t: 0.0,
            end: to - from,
            value: f64::NAN,
            least: 0.0,
            clear: 0.0,
            // Rays to the lights start outside, above the surface.
            started: hit_query == HitQuery::Any,
            side: 1.0,
            cell_end: 0.0,
            slope: [0.0; 2],
            state: MarchState::Enter,
            query: 0.0,
            steps: 0,
            gap: f64::INFINITY,
            record: BeamRecord::default(),
        })
    }

    /// Goes to the first cell.
    pub fn start(&mut self, cells: &FieldOctree) {
        if self.next_cell(cells, 0.0) {
            self.ask(MarchState::Enter, self.t);
        }
    }

    pub fn is_done(&self) -> bool {
        matches!(self.state, MarchState::Done)
    }

    pub fn record(&self) -> BeamRecord {
        BeamRecord { uncertain: self.record.uncertain || self.gap < f64::INFINITY, ..self.record }
    }

    /// The point where the next value is needed.
    pub fn point(&self) -> [f64; 3] {
        along(self.origin, self.direction, self.query)
    }

    /// Takes the value at [`BeamMarcher::point`].
    pub fn advance(&mut self, cells: &FieldOctree, value: f64) {
        self.steps += 1;
        let value = value * self.side;
        match self.state {
            MarchState::Enter => self.on_enter(cells, value),
            MarchState::Step { stride, reach, sure } => self.on_step(cells, value, [stride, reach], sure),
            MarchState::Narrow(mut root) => {
                root.update(self.query, value);
                self.refine_bracket(cells, root);
            }
            MarchState::Done => {}
        }
        if self.steps >= MOST_STEPS && !self.is_done() {
            self.record.capped = true;
            self.state = MarchState::Done;
        }
    }

    /// Whether a value is on the other side. NaN counts as outside, on either side of the surface.
    fn crosses(&self, value: f64) -> bool {
        if self.side > 0.0 { value < 0.0 } else { value <= 0.0 || value.is_nan() }
    }

    fn ask(&mut self, state: MarchState, at: f64) {
        (self.state, self.query) = (state, at);
    }

    fn on_enter(&mut self, cells: &FieldOctree, value: f64) {
        if !self.started {
            self.started = true;
            if value < 0.0 {
                if self.begin_inside() {
                    return;
                }
                // From inside, all values are mirrored.
                self.slope = [-self.slope[1], -self.slope[0]];
                return self.plan_step(cells, -value);
            }
        }
        if self.crosses(value) {
            // The value at the outer end is not known.
            let clear = self.clear;
            return self.refine_bracket(cells, RootBracket::new([clear, f64::NAN], [self.t, -value.abs()]));
        }
        self.plan_step(cells, value);
    }

    /// Exchanges inside and outside. Returns whether that answers the query.
    fn begin_inside(&mut self) -> bool {
        self.started = true;
        self.side = -1.0;
        if self.hit_query == HitQuery::Any {
            self.record_hit(0.0);
        }
        self.is_done()
    }

    fn on_step(&mut self, cells: &FieldOctree, value: f64, [stride, reach]: [f64; 2], sure: bool) {
        let floor = self.shortest();
        let retreat = greater(reach, floor);
        let long = stride > retreat * 1.000_001; // rounding: a stride equal to the retreat is not long
        if self.crosses(value) {
            // There may be an earlier root in the part that is not known to be free, so the step is taken
            // back.
            if long && !sure {
                return self.step(cells, [retreat, reach], false);
            }
            // Tolerance for rounding: a step of the reach itself is free.
            if !sure && stride > reach * 1.000_001 {
                self.mark_gap(self.t + reach);
            }
            let inside = if value < 0.0 { value } else { -f64::MIN_POSITIVE };
            return self
                .refine_bracket(cells, RootBracket::new([self.t, self.value], [self.t + stride, inside]));
        }
        if !sure && stride > reach {
            // The length behind the end of the step that is certainly free as well.
            let [_, b] = self.slope;
            let mut back = if b > 0.0 { value / b } else { f64::INFINITY };
            if self.has_distance_bound(cells) && value > back {
                back = value;
            }
            if reach + back < stride || (reach + back).is_nan() {
                if long {
                    return self.step(cells, [retreat, reach], false);
                }
                self.mark_gap(self.t + reach);
            }
        }
        self.clear = self.t + stride;
        self.t = self.clear;
        if self.t < self.cell_end {
            return self.plan_step(cells, value);
        }
        // Neighbouring cells share the value at their border.
        let border = self.cell_end;
        self.least = value;
        if self.next_cell(cells, border) {
            if self.t <= border + 4.0 * NUDGE * cells.size {
                self.plan_step(cells, value);
            } else {
                self.ask(MarchState::Enter, self.t);
            }
        }
    }

    /// Records that something may have been missed from here on: no slope clears the step, and it is not
    /// taken back.
    fn mark_gap(&mut self, from: f64) {
        self.gap = lesser(from, self.gap);
    }

    /// Plans the next step, from a value on the starting side, at `self.t` in its cell.
    fn plan_step(&mut self, cells: &FieldOctree, value: f64) {
        self.value = value;
        self.clear = self.t;
        let [a, b] = self.slope;
        let distance = if self.has_distance_bound(cells) && value.is_finite() { value } else { 0.0 };
        let by_slope = if a >= 0.0 { f64::INFINITY } else { value / -a };
        let reach = if value.is_finite() && by_slope > distance { by_slope } else { distance };
        let to_end = self.cell_end - self.t;
        if reach >= to_end {
            // Slopes end with the cell; a distance bound does not.
            let at_end = value + a * to_end;
            self.least = if distance <= to_end && at_end > 0.0 { at_end } else { 0.0 };
            let next_t = if distance > to_end { self.t + distance } else { self.cell_end };
            self.clear = next_t;
            if self.next_cell(cells, next_t) {
                self.ask(MarchState::Enter, self.t);
            }
            return;
        }
        if b < 0.0 && value.is_finite() {
            // Falling at least that fast, the value is below 0 at the end of this step.
            let stride = value / -b * (1.0 + WIDTH) + WIDTH * cells.size;
            return self.step(cells, [stride, reach], true);
        }
        let floor = self.shortest();
        let stride = greater(LONGER * reach, floor);
        self.step(cells, [stride, reach], false);
    }

    fn step(&mut self, cells: &FieldOctree, [stride, reach]: [f64; 2], sure: bool) {
        let _ = cells;
        let to_end = self.cell_end - self.t;
        let stride = lesser(stride, to_end);
        self.ask(MarchState::Step { stride, reach, sure }, self.t + stride);
    }

    fn radius(&self) -> f64 {
        self.cone[0] + self.cone[1] * self.t
    }

    fn shortest(&self) -> f64 {
        let fine = SHORTEST * self.radius();
        // If nothing bounds the slope, nothing is proved anyway: take few enough steps to get through.
        let coarse = self.end / COARSE_STEPS;
        if self.slope[0].is_finite() || coarse < fine { fine } else { coarse }
    }

    fn has_distance_bound(&self, cells: &FieldOctree) -> bool {
        cells.is_distance_bound[usize::from(self.side < 0.0)]
    }

    fn refine_bracket(&mut self, cells: &FieldOctree, mut root: RootBracket) {
        let width = WIDTH * cells.size;
        match if self.hit_query == HitQuery::Any { Some(self.t) } else { root.root_within(width) } {
            Some(t) => self.record_hit(t),
            None => {
                let at = root.next_guess(width);
                self.ask(MarchState::Narrow(root), at);
            }
        }
    }

    fn record_hit(&mut self, t: f64) {
        // A hit within the beam's radius of the true one is right; for the question whether there is any hit,
        // every hit is.
        if self.hit_query == HitQuery::Any || t <= self.gap + self.radius() {
            self.gap = f64::INFINITY;
        }
        let point = along(self.origin, self.direction, t);
        let t = (self.before + t) / self.scale;
        self.record.hit = Some(BeamHit { t, point, entering: self.side > 0.0 });
        self.state = MarchState::Done;
    }

    /// Continues from `t` to the next cell; `false` if there is none, or if there is a hit before it.
    fn next_cell(&mut self, cells: &FieldOctree, mut t: f64) -> bool {
        let nudge = NUDGE * cells.size;
        loop {
            if t > self.end {
                self.state = MarchState::Done;
                return false;
            }
            // Into the next voxel: at a side, rounding decides.
            t += nudge;
            let (at, voxel) = cells.voxels.at(along(self.in_voxels[0], self.in_voxels[1], t));
            match voxel {
                Voxel::Side(side, clear) => {
                    let exit = self.exit_voxels(at, f64::from(clear));
                    if !self.pass_empty(f64::from(side), t) {
                        return false;
                    }
                    t = greater(exit, t);
                    self.clear = t;
                    self.least = 0.0;
                }
                Voxel::Cell(cell) => {
                    let cell = &cells.cells[cell as usize];
                    let exit = self.exit(cell.bounds.min, cell.bounds.max, t);
                    self.tape = cell.tape;
                    self.t = t;
                    self.cell_end = lesser(exit, self.end);
                    // The nudge may have gone past a corner of the cell.
                    if self.cell_end < self.t {
                        self.cell_end = self.t;
                    }
                    match self.predict_crossing(cells, cell) {
                        CellCrossing::Free => t = exit,
                        CellCrossing::Open => return true,
                        CellCrossing::Settled => return false,
                    }
                }
            }
        }
    }

    /// Uses slopes and the value in the middle of a cell to decide the crossing without another value.
    fn predict_crossing(&mut self, cells: &FieldOctree, cell: &FieldOctreeCell) -> CellCrossing {
        let (origin, direction) = (self.origin, self.direction);
        let estimate =
            if self.hit_query == HitQuery::Any { cells.estimates.get(cell.estimate as usize) } else { None };
        let bounds = match estimate {
            Some(estimate) => (&estimate.slopes, [estimate.middle; 2]),
            None => (&cell.slopes, cell.middle),
        };
        // Sampled slopes may miss bends between two primitives, so only an evaluated value proves a hit.
        let is_sampled = estimate.is_some();
        let at = |t: f64| cell.value_at(bounds, along(origin, direction, t));
        let mut ends = [at(self.t), at(self.cell_end)];
        if !self.started {
            if ends[0][0] > 0.0 {
                self.started = true;
            } else if ends[0][1] < 0.0 && self.begin_inside() {
                return CellCrossing::Settled;
            }
        }
        self.slope = slope_along(bounds.0, self.direction);
        if self.side < 0.0 {
            self.slope = [-self.slope[1], -self.slope[0]];
            ends = ends.map(|[low, high]| [-high, -low]);
        }
        let [[low, high], [low_end, high_end]] = ends;
        let (to_end, nudge) = (self.cell_end - self.t, NUDGE * cells.size);
        // If the beam was outside up to here, the slope alone shows whether the field can fall to 0.
        let continuous = self.started && self.t - self.clear <= 4.0 * nudge;
        let at_end = self.least + self.slope[0] * to_end;
        let by_slope = continuous && self.slope[0].is_finite() && (self.slope[0] >= 0.0 || at_end > 0.0);
        // The lower end is concave: between two positions where it is above 0, it is above 0.
        let by_value = low > 0.0 && low_end > 0.0;
        if self.started && (by_slope || by_value) {
            let at_end = if by_slope && at_end > 0.0 { at_end } else { 0.0 };
            self.least = if by_value && low_end > at_end { low_end } else { at_end };
            self.clear = self.cell_end;
            return CellCrossing::Free;
        }
        if !self.started {
            return CellCrossing::Open;
        }
        if self.hit_query == HitQuery::Any && !is_sampled && (high < 0.0 || high_end < 0.0) {
            self.record_hit(self.t);
            return CellCrossing::Settled;
        }
        //   high *·.
        //    low *·.`·-._             The chord of the lower end is below it, and that of the upper end
        //   --------*----`-*----→ t   above it: a crossing is between the zeros of the chords.
        //         free   reach
        let free = if low > 0.0 { to_end * (low / (low - low_end)) } else { 0.0 };
        if !is_sampled && self.slope[1] < 0.0 && high_end < 0.0 && high > 0.0 && (low > 0.0 || continuous) {
            // The value only falls, and the chord of the upper end is above it: this gives a bracket.
            let reach = to_end * (high / (high - high_end)) + 0.25 * WIDTH * cells.size;
            let reach = lesser(reach, to_end);
            if reach > free {
                let side = self.side;
                let guess = |t: f64| {
                    let [low, high] = at(t);
                    side * (0.5 * low + 0.5 * high)
                };
                let (from, to) = (self.t + free, self.t + reach);
                let (outside, inside) = (guess(from), guess(to));
                let root = RootBracket::new([from, outside], [to, inside]);
                self.refine_bracket(cells, root);
                return CellCrossing::Settled;
            }
        }
        if free > 0.0 && free < to_end {
            self.t += free;
            self.clear = self.t;
            self.least = 0.0;
        }
        CellCrossing::Open
    }

    /// Passes through a part that is all on one side; `false` if that answers the query.
    fn pass_empty(&mut self, side: f64, t: f64) -> bool {
        if !self.started {
            self.started = true;
            return !(side < 0.0 && self.begin_inside());
        }
        if side != self.side {
            // Both sides of the border are proved: the surface is the border.
            self.record_hit(t);
            return false;
        }
        true
    }

    /// The position where the beam leaves a voxel and `more` voxels around it.
    fn exit_voxels(&self, at: [u32; 3], more: f64) -> f64 {
        let mut exit = f64::INFINITY;
        for (k, at) in at.into_iter().enumerate() {
            let up = f64::from(u8::from(self.per_voxel[k] > 0.0));
            let face = f64::from(at) + up + (2.0 * up - 1.0) * more;
            let t = (face - self.in_voxels[0][k]) * self.per_voxel[k];
            exit = lesser(t, exit);
        }
        exit
    }

    /// The position where the beam leaves a box that contains it at `t`.
    fn exit(&self, min: [f64; 3], max: [f64; 3], t: f64) -> f64 {
        let mut exit = f64::INFINITY;
        for k in 0..3 {
            if self.direction[k] != 0.0 {
                let face = if self.direction[k] > 0.0 { max[k] } else { min[k] };
                let at = (face - self.origin[k]) * self.inverse[k];
                exit = lesser(at, exit);
            }
        }
        greater(exit, t)
    }
}

/// The interval of the slope along a unit direction. Unbounded slopes stay unbounded, unless the direction is
/// perpendicular to them.
fn slope_along(slopes: &[[f64; 2]; 3], direction: [f64; 3]) -> [f64; 2] {
    let mut sum = [0.0, 0.0];
    for (slope, d) in slopes.iter().zip(direction) {
        if d > 0.0 {
            sum[0] += d * slope[0];
            sum[1] += d * slope[1];
        } else if d < 0.0 {
            sum[0] += d * slope[1];
            sum[1] += d * slope[0];
        }
    }
    sum
}
