//! Patches as triangles that are near them by equal parameters, with each patch cut as often as its bending
//! requires.
//!
//! A patch is split into parts, and each part along `u` and along `v` into cells. If the part beyond a side
//! is cut more often, the cells along the side are fans around their middles that include its points, so that
//! there are no cracks: points on a side depend on its curve alone, and not on its direction.
use super::cut_mesh;
use crate::budget::{Job, JobError, par_map};
use crate::explicit::parametric::PatchSide;
use crate::explicit::{Bezier, Mesh, Patch};
use crate::math::{add_up, difference, greater, length_up, mul_up};
use std::collections::BTreeMap;

/// How often patches are halved before each part is divided into cells. Chosen: a patch rarely bends alike
/// all over, and a flat part has one cell.
const PARTS: u32 = 3;
/// The most parts. Chosen: so many triangles take a tenth of a second.
const MOST_PARTS: usize = 1 << 16;
/// The factor of the distance to the patches from one level to the next. Each level has about twice as many
/// triangles as the previous one.
pub(super) const LEFT_BY_LEVEL: f64 = 0.5;
/// Rounding of a tessellation relative to the largest coordinate: a halving rounds each coordinate three
/// times by half an ε, 15 halvings in both directions, one of them to the middles of fans, make 45 ε of a length;
/// differences of the second order as much again.
const CUTS_ROUNDING: f64 = 256.0 * f64::EPSILON;

/// Parts of patches, each with the halvings that bring its triangles as near as a level requires.
pub(super) struct PatchTessellation {
    parts: Vec<TessellatedPart>,
}

struct TessellatedPart {
    patch: Patch,
    /// Halvings along `u` and along `v`.
    halvings: [u32; 2],
}

/// The control points of a curve by their bits, in the direction whose bits come first.
type CurveKey = [[u64; 3]; 4];

fn key_of(curve: &Bezier<3>) -> CurveKey {
    let [a, b, c, d] = curve.control.map(|p| p.map(f64::to_bits));
    let (along, back) = ([a, b, c, d], [d, c, b, a]);
    if back < along { back } else { along }
}

const SIDES: [PatchSide; 4] = [PatchSide::Bottom, PatchSide::Right, PatchSide::Top, PatchSide::Left];

impl PatchTessellation {
    /// As near as the worst patch is to its two triangles, halved once for each level.
    pub fn new(patches: &[Patch], level: u32, job: &Job) -> Self {
        let farthest =
            patches.iter().fold(0.0, |most, patch| greater(most, ParametricBend::of(patch).distance([0; 2])));
        // Multiplied by `LEFT_BY_LEVEL` once for each level.
        let wanted = libm::ldexp(farthest, -(level as i32));
        // Halvings in both directions leave a quarter.
        let most = level.div_ceil(2);
        let is_few = |depth: &u32| patches.len() << (2 * depth) <= MOST_PARTS;
        let depth = (0..=PARTS.min(most)).rev().find(is_few).unwrap_or(0);
        let parts = par_map(job, patches, |_, patch| {
            let mut parts = vec![*patch];
            for _ in 0..depth {
                parts = parts.iter().flat_map(Patch::halves_v).flat_map(|half| half.halves_u()).collect();
            }
            let with_halvings = |patch: Patch| {
                let halvings = ParametricBend::of(&patch).halvings(wanted, most - depth);
                TessellatedPart { patch, halvings }
            };
            parts.into_iter().map(with_halvings).collect::<Vec<_>>()
        });
        Self { parts: parts.into_iter().flatten().collect() }
    }

    /// By curve: the largest number of halvings of a side along it.
    fn sides(&self) -> BTreeMap<CurveKey, u32> {
        let mut sides = BTreeMap::new();
        for part in &self.parts {
            for (k, side) in SIDES.into_iter().enumerate() {
                let most = sides.entry(key_of(&part.patch.side(side))).or_insert(0);
                *most = greater(*most, part.halvings[k % 2]);
            }
        }
        sides
    }

    /// About the number of its triangles: exact except for the fans along finer sides.
    pub fn count(&self) -> u64 {
        self.parts.iter().map(|part| 2_u64 << part.halvings.iter().sum::<u32>()).sum()
    }

    /// Its triangles, and an upper bound on their two-sided distance to the patches.
    ///
    /// Each cell's triangles have their corners on its piece of the patch, at parameters that tile the cell's.
    pub fn triangles(&self, job: &Job) -> Result<(Mesh, f64), JobError> {
        let sides = self.sides();
        let parts_cut = par_map(job, &self.parts, |_, part| {
            let finer = SIDES.map(|side| sides[&key_of(&part.patch.side(side))]);
            let mut cells = PartTriangles::default();
            if !job.is_cancelled() {
                cells.fill(part, finer);
            }
            cells.distance = add_up(cells.distance, mul_up(CUTS_ROUNDING, part.patch.size()));
            cells
        });
        let distance = parts_cut.iter().fold(0.0, |most, cells| greater(most, cells.distance));
        let (mut points, mut faces): (Vec<[f64; 3]>, Vec<[u32; 3]>) = Default::default();
        for cells in parts_cut {
            let first = points.len() as u32;
            points.extend(cells.points);
            faces.extend(cells.faces.into_iter().map(|face| face.map(|row| row + first)));
        }
        Ok((cut_mesh(points, faces)?, distance))
    }
}

/// The triangles of a part.
#[derive(Default)]
struct PartTriangles {
    points: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    /// An upper bound on the distance between its triangles and the patch.
    distance: f64,
}

impl PartTriangles {
    fn fill(&mut self, part: &TessellatedPart, finer: [u32; 4]) {
        let [columns, rows] = part.halvings.map(|halvings| 1_usize << halvings);
        self.points.resize((columns + 1) * (rows + 1), [0.0; 3]);
        let whole_part = PatchCell { patch: part.patch, at: [0, 0], wide: [columns, rows] };
        // For each side the points that the part itself does not have, from its start on, cell by cell.
        let between = [0, 1, 2, 3].map(|k| {
            let halvings = part.halvings[k % 2];
            points_between(&part.patch.side(SIDES[k]), halvings, finer[k])
        });
        let mut todo = vec![whole_part];
        while let Some(cell) = todo.pop() {
            let [u, v] = cell.wide;
            match (u > 1, v > 1) {
                (_, true) => todo.extend(cell.split(1, cell.patch.halves_v())),
                (true, _) => todo.extend(cell.split(0, cell.patch.halves_u())),
                _ => self.cell(&cell, [columns, rows], &between),
            }
        }
    }

    fn cell(&mut self, cell: &PatchCell, [columns, rows]: [usize; 2], between: &[Vec<Vec<[f64; 3]>>; 4]) {
        let c = &cell.patch.control;
        let [column, row] = cell.at;
        let number = |column: usize, row: usize| (row * (columns + 1) + column) as u32;
        let corners = [
            number(column, row),
            number(column + 1, row),
            number(column + 1, row + 1),
            number(column, row + 1),
        ];
        for (k, at) in corners.into_iter().zip([c[0][0], c[0][3], c[3][3], c[3][0]]) {
            self.points[k as usize] = at;
        }
        self.distance = greater(self.distance, ParametricBend::of(&cell.patch).distance([0; 2]));
        // The cell's number along each side, in the direction of the side, if it is on that side.
        let along = [
            (row == 0).then_some(column),
            (column + 1 == columns).then_some(row),
            (row + 1 == rows).then(|| columns - 1 - column),
            (column == 0).then(|| rows - 1 - row),
        ];
        let more =
            |k: usize| along[k].map_or(&[][..], |cell| between[k].get(cell).map_or(&[][..], Vec::as_slice));
        // Where no side has additional points, two triangles do.
        let [a, b, d, e] = corners;
        if (0..4).all(|k| more(k).is_empty()) {
            self.faces.extend([[a, b, d], [a, d, e]]);
            return;
        }
        // The middle of the cell as a point of the surface, and the rim with the points that the
        // neighbours have:
        //     e ─── · ─── d
        //     │  ╲  │  ╱  │        · points of a neighbour that is cut more often
        //     │    mid    ·        Both sides then have the same edges, so there is no crack.
        //     │  ╱     ╲  │
        //     a ───────── b
        let [_, upper] = cell.patch.halves_v();
        let [_, quarter] = upper.halves_u();
        let middle = self.push(quarter.control[0][0]);
        let mut rim = Vec::new();
        for (k, corner) in corners.into_iter().enumerate() {
            rim.push(corner);
            for at in more(k) {
                rim.push(self.push(*at));
            }
        }
        self.faces.extend((0..rim.len()).map(|k| [middle, rim[k], rim[(k + 1) % rim.len()]]));
    }

    fn push(&mut self, at: [f64; 3]) -> u32 {
        self.points.push(at);
        self.points.len() as u32 - 1
    }
}

/// A rectangle of cells.
struct PatchCell {
    patch: Patch,
    /// The column and the row of its first cell.
    at: [usize; 2],
    /// Its columns and rows.
    wide: [usize; 2],
}

impl PatchCell {
    fn split(&self, axis: usize, halves: [Patch; 2]) -> [Self; 2] {
        let mut wide = self.wide;
        wide[axis] /= 2;
        let mut beyond = self.at;
        beyond[axis] += wide[axis];
        let [low, high] = halves;
        [Self { patch: low, at: self.at, wide }, Self { patch: high, at: beyond, wide }]
    }
}

/// The points of a curve at the finer of two halvings that the coarser does not have, in groups between the
/// coarse points.
fn points_between(curve: &Bezier<3>, coarse: u32, fine: u32) -> Vec<Vec<[f64; 3]>> {
    if fine <= coarse {
        return Vec::new();
    }
    let mut pieces = vec![*curve];
    for _ in 0..fine {
        pieces = pieces.iter().flat_map(|piece| piece.split(0.5)).collect();
    }
    let starts: Vec<[f64; 3]> = pieces.iter().map(|piece| piece.control[0]).collect();
    starts.chunks(1 << (fine - coarse)).map(|group| group[1..].to_vec()).collect()
}

/// The largest second derivatives over a patch: along `u`, mixed, along `v`.
struct ParametricBend {
    uu: f64,
    uv: f64,
    vv: f64,
}

impl ParametricBend {
    fn of(patch: &Patch) -> Self {
        let c = &patch.control;
        let (mut uu, mut uv, mut vv) = (0.0, 0.0, 0.0);
        for i in 0..4 {
            for j in 0..2 {
                let bend = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
                    length_up(difference(difference(c, b), difference(b, a)))
                };
                uu = greater(uu, bend(c[i][j], c[i][j + 1], c[i][j + 2]));
                vv = greater(vv, bend(c[j][i], c[j + 1][i], c[j + 2][i]));
            }
        }
        // The mixed derivative is 9 times the differences of differences, the pure ones 6 times the
        // second differences (degree 3).
        for i in 0..3 {
            for j in 0..3 {
                let twist =
                    difference(difference(c[i + 1][j + 1], c[i + 1][j]), difference(c[i][j + 1], c[i][j]));
                uv = greater(uv, length_up(twist));
            }
        }
        Self { uu: mul_up(6.0, uu), uv: mul_up(9.0, uv), vv: mul_up(6.0, vv) }
    }

    /// A bound on the distance between each of the cells that so many halvings make and triangles with their corners on it that
    /// tile its parameters, by equal parameters and so in both directions. With the barycentric coordinates of a point as
    /// weights, its corners have that point as their mean, and an error of half of the second derivatives times their variances
    /// and covariance: at most a quarter of the squares of the sides, and of their product. (D. Filip, R. Magedson, R. Markot,
    /// *Surface algorithms using bounds on derivatives*, 1986, for the two triangles of a square.)
    fn distance(&self, halvings: [u32; 2]) -> f64 {
        // Powers of two are exact.
        let [u, v] = halvings.map(|halvings| libm::ldexp(1.0, -(halvings as i32)));
        let pure = add_up(mul_up(u * u, self.uu), mul_up(v * v, self.vv));
        mul_up(0.125, add_up(pure, mul_up(2.0 * u * v, self.uv)))
    }

    /// The halvings that give the fewest cells within a distance, none above a given number.
    fn halvings(&self, wanted: f64, most: u32) -> [u32; 2] {
        let mut best = [most; 2];
        for u in 0..=most {
            if let Some(v) = (0..=most).find(|v| self.distance([u, *v]) <= wanted)
                && u + v < best[0] + best[1]
            {
                best = [u, v];
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explicit::{Topology, Twin, Twins};

    /// Two patches that share a side: the one is flat but for its far end, the other is bent. No edge ends inside of another.
    #[test]
    fn parts_that_are_cut_differently_have_no_cracks() {
        let mut flat = Patch::flat([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        let mut bent = Patch::flat([1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        for row in 0..4 {
            flat.control[row][0][2] = 0.1 * row as f64;
            bent.control[row][1][2] = 1.0;
            bent.control[row][2][2] = -1.0 - row as f64;
        }
        for level in 0..13 {
            let made = PatchTessellation::new(&[flat, bent], level, &Job::default());
            let (mesh, distance) = made.triangles(&Job::default()).unwrap();
            let halvings: Vec<[u32; 2]> = made.parts.iter().map(|part| part.halvings).collect();
            assert!(level < 9 || halvings.iter().any(|one| *one != halvings[0]), "{halvings:?}");
            let twins = Twins::new(&mesh, Topology::Positions);
            let is_border = |p: [f64; 3]| p[0] == 0.0 || p[0] == 2.0 || p[1] == 0.0 || p[1] == 1.0;
            for (k, face) in mesh.faces().iter().enumerate() {
                for side in 0..3 {
                    if matches!(twins.get(3 * k as u32 + side as u32), Twin::Pair(_)) {
                        continue;
                    }
                    let ends = [face[side], face[(side + 1) % 3]].map(|row| mesh.positions()[row as usize]);
                    assert!(ends.into_iter().all(is_border), "level {level}: {ends:?}");
                }
            }
            // Twice the area of all triangles seen from above is that of both squares.
            let area = |face: usize| {
                let [a, b, c] = mesh.corners(face);
                (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
            };
            let area: f64 = (0..mesh.faces().len()).map(area).sum();
            assert!((area - 4.0).abs() < 1e-9, "level {level}: {area}");
            // And points of the patches are as near to the triangles as is said.
            let bvh = crate::explicit::Bvh::build(&mesh, &Job::default()).unwrap();
            for (patch, k) in [flat, bent].iter().flat_map(|patch| (0..400).map(move |k| (patch, k))) {
                let at = patch.at(f64::from(k % 20) / 19.0, f64::from(k / 20) / 19.0);
                let away = bvh.closest_distance_down(at).unwrap();
                assert!(away <= distance, "level {level}: {away} beyond {distance}");
            }
        }
    }
}
