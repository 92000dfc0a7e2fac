//! `RegionTree`: the triangles of a mesh divided into regions by position, and each region as a mesh.
use crate::explicit::{Attribute, Domain, Mesh, Topology};
use crate::math::Box3;
use std::borrow::Cow;
use std::ops::Range;

/// The regions of a mesh: the whole, its halves, their halves, until each has few triangles.
///
/// A region is split at the median of its triangles, along the longest side of the box of their centres. No
/// triangle is cut. The regions depend on the mesh alone.
pub(super) struct RegionTree<'a> {
    mesh: &'a Mesh,
    ids: Option<Cow<'a, [u32]>>,
    /// The triangles, ordered so that each region is contiguous.
    order: Vec<u32>,
    /// The whole mesh, then for each divided region its two halves.
    pub regions: Vec<MeshRegion>,
    /// By position: the first and the last index in `order` of a triangle there.
    face_span: Vec<[u32; 2]>,
}

/// A range of the triangles in this order.
pub(super) struct MeshRegion {
    range: Range<usize>,
    /// The region of which it is a half.
    pub parent: usize,
    /// The index of its first half; the second follows.
    pub halves: Option<usize>,
}

impl<'a> RegionTree<'a> {
    pub fn new(mesh: &'a Mesh, topology: Topology, most: usize) -> Self {
        // Divided by three before the sum, which might overflow.
        let centre = |face: usize| {
            let [a, b, c] = mesh.corners(face);
            std::array::from_fn(|k| a[k] / 3.0 + b[k] / 3.0 + c[k] / 3.0)
        };
        let centres: Vec<[f64; 3]> = (0..mesh.faces().len()).map(centre).collect();
        let mut order: Vec<u32> = (0..mesh.faces().len() as u32).collect();
        let mut regions = vec![MeshRegion { range: 0..order.len(), parent: 0, halves: None }];
        let mut next = 0;
        while let Some(MeshRegion { range, .. }) = regions.get(next) {
            let range = range.clone();
            // One triangle has no halves.
            if range.len() > most.max(1) {
                let middle = range.start + halve(&mut order[range.clone()], &centres);
                regions[next].halves = Some(regions.len());
                for range in [range.start..middle, middle..range.end] {
                    regions.push(MeshRegion { range, parent: next, halves: None });
                }
            }
            next += 1;
        }
        let ids = topology.ids(mesh);
        let mut parts =
            Self { mesh, ids, order, regions, face_span: vec![[u32::MAX, 0]; mesh.positions().len()] };
        // Regions are contiguous in this order, so the first and the last triangle at a position show whether
        // another region has one there.
        for (index, face) in parts.order.iter().enumerate() {
            for row in mesh.faces()[*face as usize] {
                let id = parts.ids.as_ref().map_or(row, |ids| ids[row as usize]);
                let [first, last] = &mut parts.face_span[id as usize];
                *first = (*first).min(index as u32);
                *last = (*last).max(index as u32);
            }
        }
        parts
    }

    fn id(&self, row: u32) -> u32 {
        self.ids.as_ref().map_or(row, |ids| ids[row as usize])
    }

    /// The diagonal of the box around the mesh.
    pub fn extent(&self) -> f64 {
        self.mesh.bounds().diagonal()
    }

    /// A region as a mesh, its triangles in the order of the whole mesh, with all attributes; and by row
    /// whether another region has a triangle at its position. The list is empty if none has.
    pub fn mesh(&self, region: usize) -> (Mesh, Vec<bool>) {
        let range = &self.regions[region].range;
        let mut faces = self.order[range.clone()].to_vec();
        faces.sort_unstable();
        let rows = self.mesh.rows_of(&faces);
        let elsewhere = |row: &u32| {
            let [first, last] = self.face_span[self.id(*row) as usize];
            (first as usize) < range.start || last as usize >= range.end
        };
        let mut stays: Vec<bool> = rows.iter().map(elsewhere).collect();
        if !stays.contains(&true) {
            stays.clear();
        }
        (submesh(self.mesh, &faces, &rows), stays)
    }

    /// Whether a region has a triangle with three different corners.
    pub fn has_surface(&self, region: usize) -> bool {
        self.order[self.regions[region].range.clone()].iter().any(|face| {
            let [a, b, c] = self.mesh.faces()[*face as usize].map(|row| self.id(row));
            a != b && b != c && c != a
        })
    }
}

/// Reorders faces into halves along the longest side of the box of their centres; returns the size of the first.
pub(super) fn halve(faces: &mut [u32], centres: &[[f64; 3]]) -> usize {
    let middle = faces.len() / 2;
    let axis = longest(&Box3::from_points(faces.iter().map(|face| &centres[*face as usize])));
    let along = |face: &u32| centres[*face as usize][axis];
    // No two keys are equal, so the halves do not depend on the selection algorithm.
    faces.select_nth_unstable_by(middle, |a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
    middle
}

fn longest(bounds: &Box3) -> usize {
    // Halved before the difference, which might overflow.
    let side = |k: usize| 0.5 * bounds.max[k] - 0.5 * bounds.min[k];
    (1..3).fold(0, |best, k| if side(k) > side(best) { k } else { best })
}

/// A mesh of some faces and the rows that they use, both ascending, with ids and attributes.
fn submesh(mesh: &Mesh, faces: &[u32], rows: &[u32]) -> Mesh {
    let mut part = mesh.some_faces(faces, rows);
    if let Some(ids) = mesh.position_id() {
        // A position is identified by the first of its rows.
        let mut named: Vec<[u32; 2]> = (0..).zip(rows).map(|(at, row)| [ids[*row as usize], at]).collect();
        named.sort_unstable();
        let mut position_ids = vec![0; rows.len()];
        for together in named.chunk_by(|a, b| a[0] == b[0]) {
            together.iter().for_each(|[_, at]| position_ids[*at as usize] = together[0][1]);
        }
        part = part.with_position_id(position_ids).unwrap_or_default();
    }
    for attribute in mesh.attributes() {
        let values: Vec<f64> = match attribute.domain {
            Domain::Vertex => rows.iter().flat_map(|row| attribute.row(*row as usize)).copied().collect(),
            Domain::Face => faces.iter().flat_map(|face| attribute.row(*face as usize)).copied().collect(),
            Domain::Corner => {
                let corners = faces.iter().flat_map(|face| (0..3).map(move |k| 3 * *face as usize + k));
                corners.flat_map(|corner| attribute.row(corner)).copied().collect()
            }
        };
        let same = Attribute { semantic: attribute.semantic.clone(), values, ..*attribute };
        part = part.with_attribute(same).unwrap_or_default();
    }
    part
}
