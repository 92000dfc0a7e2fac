//! `NearbyPair`: the parts of two surfaces that decide about a few faces.
use super::super::SurfacePair;
use super::super::distance_surface::DistanceSurface;
use super::super::shared::SharedPositionIds;
use super::super::violations::{ViolationReport, find_violations};
use super::MappedPair;
use crate::budget::{Job, JobError};
use crate::math::{Box3, add_up, greater, lesser, sub_down};
use std::borrow::Cow;

/// Some faces of either surface, with all that is near them.
///
/// What is farther away than a length decides nothing about who is within that length; a part of a surface bounds the
/// distance to it from above. So only the source's faces around those of the result that are asked for are taken, and
/// the result as a whole, which has few faces.
pub(super) struct NearbyPair<'a> {
    pair: SurfacePair<'a>,
    /// By face of the first side: that of the source.
    source_faces: Vec<u32>,
    /// The faces that are asked for, by their numbers here.
    asked: [Vec<u32>; 2],
}

impl<'a> NearbyPair<'a> {
    /// The part for some faces of the source and of the result, and a distance of the frame.
    pub fn new(
        whole: &MappedPair<'a>,
        [of_source, of_result]: [&[u32]; 2],
        (enough, job): (f64, &Job),
    ) -> Result<Self, JobError> {
        let region = Region::around(of_result.iter().map(|face| whole.result.corners(*face)), 2.0 * enough);
        let mut source_faces: Vec<u32> = of_source.to_vec();
        let near = |face: &u32| region.touches(&Box3::from_points(&whole.source.corners(*face)));
        source_faces.extend((0..whole.source.n_faces() as u32).filter(near));
        source_faces.sort_unstable();
        source_faces.dedup();
        if source_faces.is_empty() {
            // How far away something is takes something to measure to.
            source_faces.extend(0..whole.source.n_faces() as u32);
        }
        let rows = whole.meshes[0].rows_of(&source_faces);
        let part = whole.meshes[0].some_faces(&source_faces, &rows);
        let common = SharedPositionIds::from_meshes([&part, whole.meshes[1]]);
        let local = whole.local[0].some_faces(&source_faces, &rows);
        let sides = [
            DistanceSurface::new(Cow::Owned(local), job)?,
            DistanceSurface::new(Cow::Owned(whole.local[1].clone().into_owned()), job)?,
        ];
        let pair = SurfacePair { shared: whole.shared, common, sides };
        let here = |face: &u32| source_faces.partition_point(|known| known < face) as u32;
        let asked = [of_source.iter().map(here).collect(), of_result.to_vec()];
        Ok(Self { pair, source_faces, asked })
    }

    /// Which of the faces are farther away than a distance of the frame, or may be, with their own numbers.
    pub fn violations(self, enough: f64, job: &Job) -> ViolationReport {
        let vertices = self.pair.vertices_of(self.asked, job);
        let mut found = find_violations(&self.pair, &vertices, &enough, job);
        found.violations[0].iter_mut().for_each(|far| far.face = self.source_faces[far.face as usize]);
        found
    }
}

/// Cells along each side of a region. Chosen: 32,768 bits.
const CELLS: usize = 32;

/// A set of boxes, in a lattice of cells: what touches a cell of one of them counts as near.
struct Region {
    bounds: Box3,
    is_near: Vec<bool>,
}

impl Region {
    fn around(triangles: impl Iterator<Item = [[f64; 3]; 3]> + Clone, off: f64) -> Self {
        let grown = |triangle: [[f64; 3]; 3]| {
            let Box3 { min, max } = Box3::from_points(&triangle);
            Box3 { min: min.map(|x| sub_down(x, off)), max: max.map(|x| add_up(x, off)) }
        };
        let bounds = triangles.clone().map(grown).fold(Box3::EMPTY, Box3::union);
        let mut region = Self { bounds, is_near: vec![false; CELLS * CELLS * CELLS] };
        for triangle in triangles {
            region.cells(&grown(triangle)).for_each(|cell| region.is_near[cell] = true);
        }
        region
    }

    /// The cells that a box touches, which overlaps the region.
    fn cells(&self, place: &Box3) -> impl Iterator<Item = usize> + use<> {
        let Box3 { min, max } = self.bounds;
        let along = |k: usize, x: f64| {
            let x = greater(min[k], lesser(x, max[k]));
            let cell = (x - min[k]) / (max[k] - min[k]) * CELLS as f64;
            // A region without extent has one cell.
            if cell.is_finite() { (cell as usize).min(CELLS - 1) } else { 0 }
        };
        let [x, y, z] = [0, 1, 2].map(|k| along(k, place.min[k])..=along(k, place.max[k]));
        x.flat_map(move |i| {
            let z = z.clone();
            y.clone().flat_map(move |j| z.clone().map(move |k| (i * CELLS + j) * CELLS + k))
        })
    }

    fn touches(&self, place: &Box3) -> bool {
        let Box3 { min, max } = self.bounds;
        (0..3).all(|k| place.min[k] <= max[k] && place.max[k] >= min[k])
            && self.cells(place).any(|cell| self.is_near[cell])
    }
}
