//! `NearbyPair`: the parts of two surfaces that suffice to decide about a few faces.
use super::super::SurfacePair;
use super::super::distance_surface::DistanceSurface;
use super::super::shared::SharedPositionIds;
use super::super::violations::{ViolationReport, find_violations};
use super::MappedPair;
use crate::budget::{Job, JobError};
use crate::math::{Box3, add_up, greater, lesser, sub_down};
use std::borrow::Cow;

/// Some faces of either surface, with all faces near them.
///
/// Faces farther away than a length do not matter to the question which points are within that length, and a
/// part of a surface bounds the distance to it from above. So the first side has only the source's faces
/// around the wanted faces of the result, and the second side has the whole result, which has few faces.
pub(super) struct NearbyPair<'a> {
    pair: SurfacePair<'a>,
    /// By face of the first side: its number in the source.
    source_faces: Vec<u32>,
    /// The wanted faces, by their numbers in the parts.
    wanted: [Vec<u32>; 2],
}

impl<'a> NearbyPair<'a> {
    /// The parts for some faces of the source and of the result, and a distance in the frame.
    pub fn new(
        mapped: &MappedPair<'a>,
        [source_wanted, result_wanted]: [&[u32]; 2],
        (enough, job): (f64, &Job),
    ) -> Result<Self, JobError> {
        let region =
            Region::around(result_wanted.iter().map(|face| mapped.result.corners(*face)), 2.0 * enough);
        // Of the source the wanted faces, and all that may be near the wanted faces of the result.
        // The result stays whole: its distances are asked for at any point of the source.
        let mut source_faces: Vec<u32> = source_wanted.to_vec();
        let near = |face: &u32| region.touches(&Box3::from_points(&mapped.source.corners(*face)));
        source_faces.extend((0..mapped.source.n_faces() as u32).filter(near));
        source_faces.sort_unstable();
        source_faces.dedup();
        if source_faces.is_empty() {
            // The first side must not be empty, or there is nothing to measure to.
            source_faces.extend(0..mapped.source.n_faces() as u32);
        }
        let rows = mapped.meshes[0].rows_of(&source_faces);
        let part = mapped.meshes[0].some_faces(&source_faces, &rows);
        let position_ids = SharedPositionIds::from_meshes([&part, mapped.meshes[1]]);
        let local = mapped.local[0].some_faces(&source_faces, &rows);
        let sides = [
            DistanceSurface::new(Cow::Owned(local), job)?,
            DistanceSurface::new(Cow::Owned(mapped.local[1].clone().into_owned()), job)?,
        ];
        let pair = SurfacePair { common_frame: mapped.common_frame, position_ids, sides };
        // The list is sorted, so the position of a face in it is its number in the part.
        let index_in_part = |face: &u32| source_faces.partition_point(|known| known < face) as u32;
        let wanted = [source_wanted.iter().map(index_in_part).collect(), result_wanted.to_vec()];
        Ok(Self { pair, source_faces, wanted })
    }

    /// The wanted faces that are farther away than a distance of the frame, or possibly so, by their numbers
    /// in the whole meshes.
    pub fn violations(self, enough: f64, job: &Job) -> ViolationReport {
        let vertices = self.pair.vertices_of(self.wanted, job);
        let mut report = find_violations(&self.pair, &vertices, &enough, job);
        report.violations[0].iter_mut().for_each(|far| far.face = self.source_faces[far.face as usize]);
        report
    }
}

/// Cells along each side of a region. Chosen: 32,768 cells of one flag each; more would separate boxes
/// better.
const CELLS: usize = 32;

/// A set of boxes on a lattice of cells: a box that touches a marked cell counts as near.
struct Region {
    bounds: Box3,
    is_near: Vec<bool>,
}

impl Region {
    fn around(triangles: impl Iterator<Item = [[f64; 3]; 3]> + Clone, radius: f64) -> Self {
        let grown = |triangle: [[f64; 3]; 3]| {
            let Box3 { min, max } = Box3::from_points(&triangle);
            Box3 { min: min.map(|x| sub_down(x, radius)), max: max.map(|x| add_up(x, radius)) }
        };
        let bounds = triangles.clone().map(grown).fold(Box3::EMPTY, Box3::union);
        let mut region = Self { bounds, is_near: vec![false; CELLS * CELLS * CELLS] };
        for triangle in triangles {
            region.cells(&grown(triangle)).for_each(|cell| region.is_near[cell] = true);
        }
        region
    }

    /// The cells touched by a box that overlaps the region.
    fn cells(&self, item: &Box3) -> impl Iterator<Item = usize> + use<> {
        let Box3 { min, max } = self.bounds;
        let along = |k: usize, x: f64| {
            let x = greater(min[k], lesser(x, max[k]));
            let cell = (x - min[k]) / (max[k] - min[k]) * CELLS as f64;
            // A region without extent has one cell.
            if cell.is_finite() { (cell as usize).min(CELLS - 1) } else { 0 }
        };
        let [x, y, z] = [0, 1, 2].map(|k| along(k, item.min[k])..=along(k, item.max[k]));
        x.flat_map(move |i| {
            let z = z.clone();
            y.clone().flat_map(move |j| z.clone().map(move |k| (i * CELLS + j) * CELLS + k))
        })
    }

    fn touches(&self, item: &Box3) -> bool {
        let Box3 { min, max } = self.bounds;
        (0..3).all(|k| item.min[k] <= max[k] && item.max[k] >= min[k])
            && self.cells(item).any(|cell| self.is_near[cell])
    }
}
