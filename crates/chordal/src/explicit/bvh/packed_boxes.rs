//! `PackedBoxes`: the boxes of all triangles in groups along a space-filling curve, to find pairs that meet.
//!
//! For all pairs, a tree that is cheap to build and wide is better than one that is cheap to descend: each
//! group of triangles queries it only once. So the triangles are sorted along a Z-order curve, every eight
//! consecutive ones form a group, and every eight groups form a group again.
//!
//! Source: I. Kamel and C. Faloutsos, *On packing R-trees*, 1993; G. Morton, *A computer oriented geodetic
//! data base*, 1966.
use super::build::used_bounds;
use super::frame::{BvhFrame, LocalBox};
use crate::budget::{Job, JobError, Refusal, RefusalCode, par_map, par_map_owned};
use crate::explicit::Mesh;
use crate::math::{greater, lesser};

/// Boxes in a group: eight f32 fill one AVX register, or two of SSE, NEON or WASM.
const WIDTH: usize = 8;
/// Groups of triangles in a task: some hundred microseconds, after which a job may be cancelled.
const TASK: usize = 256;
/// Triangles in a task of sorting.
const CHUNK: usize = 1 << 14;
/// Bits of the curve along each axis. Chosen: triangles in one cell, a 65,536th of the mesh, stay in the
/// order of the mesh.
const AXIS_BITS: u32 = 16;
/// The leading bits of the curve that split it into parts, which are sorted separately.
const PART_BITS: u32 = 12;

/// The boxes of a group in local f32 coordinates, rounded outward; inverted for missing boxes, so that they
/// meet no box.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
struct BoxGroup {
    /// By axis and end (low, high): one number for each box.
    bounds: [[[f32; WIDTH]; 2]; 3],
}

/// The boxes of all triangles of a mesh.
///
/// Time O(n log n); memory 28 bytes per triangle, and 32 more while it is built.
pub(crate) struct PackedBoxes {
    /// The faces along the curve.
    faces: Vec<u32>,
    /// The groups of triangles, then the groups of those groups, up to a single one; none without faces.
    levels: Vec<Vec<BoxGroup>>,
}

impl PackedBoxes {
    /// The boxes of all faces.
    ///
    /// # Errors
    /// [`JobError::Refused`] if about 64 bytes per face exceed the memory of the job;
    /// [`JobError::Cancelled`].
    pub fn new(mesh: &Mesh, job: &Job) -> Result<Self, JobError> {
        let n = mesh.faces().len();
        let bytes = 64 * n as u64;
        if bytes > job.memory_limit {
            let message =
                format!("the boxes of {n} faces need about {bytes} bytes; the limit is {}", job.memory_limit);
            return Err(JobError::Refused(Refusal::new(RefusalCode::TooMuchMemory, message)));
        }
        let bounds = used_bounds(mesh);
        if bounds.is_empty() {
            return Ok(Self { faces: Vec::new(), levels: Vec::new() });
        }
        let frame = BvhFrame::from_bounds(&bounds);
        let faces = job.run(|| along_curve(mesh, &frame, job));
        if job.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        // Each task has whole groups, so that all together make the groups that one would make.
        let runs: Vec<&[u32]> = faces.chunks(WIDTH * TASK).collect();
        let groups = par_map(job, &runs, |_, run| -> Vec<BoxGroup> {
            let local = |face: &u32| wide_box(&frame, mesh.corners(*face as usize));
            run.chunks(WIDTH).map(|faces| BoxGroup::new(faces.iter().map(local))).collect()
        });
        let mut levels = vec![groups.concat()];
        while let Some(last) = levels.last().filter(|last| last.len() > 1) {
            let above =
                last.chunks(WIDTH).map(|groups| BoxGroup::new(groups.iter().map(BoxGroup::hull))).collect();
            levels.push(above);
        }
        Ok(Self { faces, levels })
    }

    /// The faces in the order of the slots.
    pub fn faces(&self) -> &[u32] {
        &self.faces
    }

    /// Calls `meet` with the slots of every two triangles whose boxes share a point, and of few others whose
    /// boxes nearly do, each pair once, the lower slot first. The order of the tasks' results does not depend
    /// on threads; `None` if the job is cancelled.
    pub fn pairs<R: Default + Send>(
        &self,
        job: &Job,
        meet: impl Fn(&mut R, [u32; 2]) + Sync,
    ) -> Option<Vec<R>> {
        let n = self.levels.first().map_or(0, Vec::len);
        let starts: Vec<usize> = (0..n).step_by(TASK).collect();
        let results = par_map(job, &starts, |_, start| {
            let mut result = R::default();
            let mut others = Vec::new();
            for group in *start..lesser(start + TASK, n) {
                if job.is_cancelled() {
                    break;
                }
                self.groups_from(group, &mut others);
                for &other in &others {
                    self.between(group, other as usize, |slots| meet(&mut result, slots));
                }
            }
            result
        });
        (!job.is_cancelled()).then_some(results)
    }

    /// The groups from `group` on whose boxes meet the box of `group`, including itself.
    fn groups_from(&self, group: usize, groups_found: &mut Vec<u32>) {
        groups_found.clear();
        let bounds = self.levels[0][group].hull();
        // At each level the groups to open, as indices within the level.
        groups_found.push(0);
        let mut open = Vec::new();
        for (level, groups) in self.levels.iter().enumerate().skip(1).rev() {
            std::mem::swap(groups_found, &mut open);
            groups_found.clear();
            // The ancestor of `group` one level below this one; earlier groups contain no group from `group`
            // on.
            let first = group >> (WIDTH.trailing_zeros() as usize * (level - 1));
            for &node in &open {
                // One bit for each of the eight; clearing the lowest one goes on to the next.
                let mut hits = groups[node as usize].meeting(&bounds);
                while hits != 0 {
                    let child = WIDTH * node as usize + hits.trailing_zeros() as usize;
                    hits &= hits - 1;
                    if child >= first {
                        groups_found.push(child as u32);
                    }
                }
            }
        }
    }

    /// The pairs of triangles of two groups, or within one group.
    #[inline]
    fn between(&self, group: usize, other: usize, mut meet: impl FnMut([u32; 2])) {
        let (boxes, others) = (&self.levels[0][group], &self.levels[0][other]);
        let mut near = boxes.meeting(&others.hull());
        while near != 0 {
            let lane = near.trailing_zeros() as usize;
            near &= near - 1;
            let mut hits = others.meeting(&boxes.lane(lane));
            // Only later lanes, so that each pair is reported once and no triangle with itself.
            if group == other {
                hits &= !(u32::MAX >> (31 - lane as u32));
            }
            while hits != 0 {
                let hit = hits.trailing_zeros() as usize;
                hits &= hits - 1;
                meet([(WIDTH * group + lane) as u32, (WIDTH * other + hit) as u32]);
            }
        }
    }
}

impl BoxGroup {
    fn new(boxes: impl Iterator<Item = LocalBox>) -> Self {
        let mut bounds = [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3];
        for (lane, [low, high]) in boxes.enumerate() {
            for (k, [lows, highs]) in bounds.iter_mut().enumerate() {
                (lows[lane], highs[lane]) = (low[k], high[k]);
            }
        }
        Self { bounds }
    }

    #[inline]
    fn lane(&self, lane: usize) -> LocalBox {
        [0, 1].map(|end| [0, 1, 2].map(|k| self.bounds[k][end][lane]))
    }

    /// The box of all boxes.
    #[inline]
    fn hull(&self) -> LocalBox {
        let lowest = |k: usize| self.bounds[k][0].iter().fold(f32::INFINITY, |lowest, x| lesser(*x, lowest));
        let highest =
            |k: usize| self.bounds[k][1].iter().fold(f32::NEG_INFINITY, |highest, x| greater(*x, highest));
        [[lowest(0), lowest(1), lowest(2)], [highest(0), highest(1), highest(2)]]
    }

    /// The boxes that meet another one, as bits.
    #[inline(always)]
    fn meeting(&self, [low, high]: &LocalBox) -> u32 {
        let mut meets = [true; WIDTH];
        for (k, [lows, highs]) in self.bounds.iter().enumerate() {
            for (lane, meets) in meets.iter_mut().enumerate() {
                *meets &= (low[k] <= highs[lane]) & (lows[lane] <= high[k]);
            }
        }
        let mut bits = 0;
        for (lane, meets) in meets.into_iter().enumerate() {
            bits |= u32::from(meets) << lane;
        }
        bits
    }
}

/// The faces along the curve; those of one cell in the order of the mesh.
fn along_curve(mesh: &Mesh, frame: &BvhFrame, job: &Job) -> Vec<u32> {
    // 1. The key of each face on the curve.
    let starts: Vec<usize> = (0..mesh.faces().len()).step_by(CHUNK).collect();
    let keys = par_map(job, &starts, |_, start| -> Vec<(u64, u32)> {
        let end = lesser(start + CHUNK, mesh.faces().len());
        (*start..end).map(|face| (curve_key(frame, mesh.corners(face)), face as u32)).collect()
    });
    // 2. Distribute the faces to parts of the curve.
    let part_of = |key: u64| (key >> (3 * AXIS_BITS - PART_BITS)) as usize;
    let mut parts: Vec<Vec<(u64, u32)>> = vec![Vec::new(); 1 << PART_BITS];
    let mut counts = vec![0; 1 << PART_BITS];
    keys.iter().flatten().for_each(|(key, _)| counts[part_of(*key)] += 1);
    parts.iter_mut().zip(counts).for_each(|(part, count)| part.reserve_exact(count));
    keys.into_iter().flatten().for_each(|entry| parts[part_of(entry.0)].push(entry));
    // 3. Sort each part.
    let sorted = par_map_owned(job, parts, |mut part| -> Vec<u32> {
        part.sort_unstable();
        part.into_iter().map(|(_, face)| face).collect()
    });
    sorted.concat()
}

/// The key of the middle of a triangle on the curve.
fn curve_key(frame: &BvhFrame, corners: [[f64; 3]; 3]) -> u64 {
    let [a, b, c] = corners.map(|p| frame.scaled(p));
    let cells = f64::from(1_u32 << AXIS_BITS);
    (0..3).fold(0, |key, k| {
        // A third of the sum; local coordinates are between −1 and 1.
        let middle = (a[k] - frame.middle[k]) + (b[k] - frame.middle[k]) + (c[k] - frame.middle[k]);
        let cell = ((middle * (cells / 6.0) + 0.5 * cells) as u64).min((1 << AXIS_BITS) - 1);
        key | spread(cell) << k
    })
}

/// The box of a triangle in local coordinates, rounded outward without a branch, and so by a little more than
/// needed.
#[inline]
fn wide_box(frame: &BvhFrame, corners: [[f64; 3]; 3]) -> LocalBox {
    let [a, b, c] = corners.map(|p| frame.scaled(p));
    // The shift and f32 lose 2⁻⁵³ and 2⁻²⁴ of a number, or half of the smallest subnormal; the margin and the
    // sum lose another 2⁻²⁴: 2⁻²² of the number plus the smallest normal number is more.
    let margin = |x: f32| x.abs() * (2.0 * f32::EPSILON) + f32::MIN_POSITIVE;
    let low = |k: usize| {
        let ab = lesser(a[k], b[k]);
        let lowest = (lesser(ab, c[k]) - frame.middle[k]) as f32;
        lowest - margin(lowest)
    };
    let high = |k: usize| {
        let ab = greater(a[k], b[k]);
        let highest = (greater(ab, c[k]) - frame.middle[k]) as f32;
        highest + margin(highest)
    };
    [[low(0), low(1), low(2)], [high(0), high(1), high(2)]]
}

/// The 16 bits of a number, with two other bits between each. The masks follow from the shifts: each step
/// halves the runs of bits.
fn spread(x: u64) -> u64 {
    let x = (x | x << 16) & 0x00ff_0000_ff00_00ff;
    let x = (x | x << 8) & 0xf00f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x30c3_0c30_c30c_30c3;
    (x | x << 2) & 0x9249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Box3;
    use chordal_testkit::Random;

    fn bounds(mesh: &Mesh, face: usize) -> Box3 {
        Box3::from_points(&mesh.corners(face))
    }

    /// Whether two boxes are at most `play` apart along each axis.
    fn meet(a: &Box3, b: &Box3, play: f64) -> bool {
        (0..3).all(|k| a.min[k] <= b.max[k] + play && b.min[k] <= a.max[k] + play)
    }

    fn all_pairs(mesh: &Mesh, job: &Job) -> Option<Vec<[u32; 2]>> {
        let boxes = PackedBoxes::new(mesh, &Job::default()).expect("small");
        let pairs_found = boxes.pairs(job, |pairs_found: &mut Vec<[u32; 2]>, slots| pairs_found.push(slots));
        let mut pairs_found = pairs_found?.concat();
        for pair in &mut pairs_found {
            assert!(pair[0] < pair[1]);
            *pair = pair.map(|slot| boxes.faces()[slot as usize]);
            pair.sort_unstable();
        }
        pairs_found.sort_unstable();
        Some(pairs_found)
    }

    #[test]
    fn every_pair_whose_boxes_meet_is_found_once_and_no_far_one() {
        let mut random = Random::new(9);
        for round in 0..60 {
            let n_faces = [0, 1, 2, 8, 9, 64, 65, 700][round % 8];
            let scale = [1.0, 1e-300, 1e300, 0.1][round % 4];
            let side = [3, 60, 1000][round % 3];
            let mut positions = Vec::new();
            for _ in 0..n_faces {
                let at: [f64; 3] = std::array::from_fn(|_| random.below(side) as f64);
                for _ in 0..3 {
                    positions.push(at.map(|x| (x + random.below(9) as f64) * scale));
                }
            }
            let faces = (0..n_faces as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
            let mesh = Mesh::new(positions, faces).expect("finite");
            let expected: Vec<[u32; 2]> = (0..n_faces)
                .flat_map(|f| (f + 1..n_faces).map(move |g| [f, g]))
                .filter(|&[f, g]| meet(&bounds(&mesh, f), &bounds(&mesh, g), 0.0))
                .map(|pair| pair.map(|face| face as u32))
                .collect();
            let pairs_found = all_pairs(&mesh, &Job::default().with_threads(1)).expect("not cancelled");
            assert_eq!(all_pairs(&mesh, &Job::default().with_threads(3)).as_ref(), Some(&pairs_found));
            assert!(
                pairs_found.windows(2).all(|pair| pair[0] != pair[1]),
                "round {round}: one is found twice"
            );
            assert!(
                expected.iter().all(|pair| pairs_found.binary_search(pair).is_ok()),
                "round {round}: one is missed"
            );
            // f32 keeps seven digits.
            let play = 1e-6 * side as f64 * scale;
            let near =
                |&[f, g]: &[u32; 2]| meet(&bounds(&mesh, f as usize), &bounds(&mesh, g as usize), play);
            assert!(pairs_found.iter().all(near), "round {round}: one is far");
        }
    }

    #[test]
    fn boxes_hold_their_triangles() {
        let mut random = Random::new(31);
        for round in 0..3000 {
            let offset = [0.0, 1.0, 1e9, 1e-9][round % 4];
            let scale = libm::ldexp(1.0, random.below(200) as i32 - 100);
            let mut coordinate = || (offset + random.below(1 << 30) as f64 * 1e-9) * scale;
            let positions: Vec<[f64; 3]> =
                (0..3).map(|_| [coordinate(), coordinate(), coordinate()]).collect();
            let frame = BvhFrame::from_bounds(&Box3::from_points(&positions));
            let corners = [positions[0], positions[1], positions[2]];
            let [low, high] = wide_box(&frame, corners);
            for p in corners.map(|p| frame.local(frame.scaled(p))) {
                assert!(
                    (0..3).all(|k| f64::from(low[k]) <= p[0][k] && f64::from(high[k]) >= p[1][k]),
                    "round {round}"
                );
            }
        }
    }

    #[test]
    fn neighbours_along_the_curve_are_neighbours_in_space() {
        // A grid of 64 × 64 squares tests less than 30 pairs per triangle.
        let at = |i: u32, j: u32| i * 65 + j;
        let positions = (0..65 * 65).map(|i| [f64::from(i / 65), f64::from(i % 65), 0.0]).collect();
        let cells = (0..64).flat_map(|i| (0..64).map(move |j| (i, j)));
        let faces: Vec<[u32; 3]> = cells
            .flat_map(|(i, j)| {
                [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
            })
            .collect();
        let n = faces.len();
        let mesh = Mesh::new(positions, faces).expect("finite");
        let boxes = PackedBoxes::new(&mesh, &Job::default()).expect("small");
        let mut groups = Vec::new();
        let opened: usize = (0..n / WIDTH)
            .map(|group| {
                boxes.groups_from(group, &mut groups);
                groups.len()
            })
            .sum();
        assert!(opened < 10 * n / WIDTH, "{opened} groups of {}", n / WIDTH);
    }

    #[test]
    fn stops_when_it_is_cancelled() {
        let job = Job::default();
        job.cancel();
        let mesh = Mesh::new(vec![[0.0; 3]; 3], vec![[0, 1, 2]; 3000]).expect("finite");
        assert_eq!(all_pairs(&mesh, &job), None);
        assert_eq!(PackedBoxes::new(&mesh, &job).err(), Some(JobError::Cancelled));
    }
}
