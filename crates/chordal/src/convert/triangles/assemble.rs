//! Assembles proved leaves into one mesh, with shared normals on smooth parts of the surface.
use super::mesher::CertifiedLeaves;
use crate::budget::{Job, par_map};
use crate::convert::patches::assemble::{COS_SAME_NORMAL, fill_missing_normals, mesh_with_normals};
use crate::convert::patches::texcoords;
use crate::explicit::Mesh;
use glam::DVec3;

/// A vertex, a sheet, and the corner of a leaf of the sheet at that vertex.
type SheetVertex = (u32, u32, u32);

/// The mesh of all leaves. If the normals of sheets differ at a vertex, each smooth group gets a separate vertex with the
/// same `position_id`.
pub(crate) fn assemble(proved: &CertifiedLeaves<'_>, job: &Job) -> Mesh {
    let CertifiedLeaves { cells, vertices, leaves, texcoords } = proved;
    let sheet_of = |leaf: usize| cells[leaves[leaf].0.cell as usize].sheet;
    let mut seen: Vec<SheetVertex> = Vec::with_capacity(3 * leaves.len());
    for (index, (leaf, _)) in leaves.iter().enumerate() {
        let corners = leaf.vertices.iter().enumerate();
        seen.extend(corners.map(|(k, vertex)| (*vertex, sheet_of(index), (3 * index + k) as u32)));
    }
    seen.sort_unstable();
    seen.dedup_by_key(|seen| (seen.0, seen.1));
    let normals = par_map(job, &seen, |_, (_, _, corner)| {
        let (leaf, _) = &leaves[*corner as usize / 3];
        let normal = cells[leaf.cell as usize].shape.normal(leaf.places[*corner as usize % 3]);
        DVec3::from(normal.unwrap_or_default())
    });
    let mut positions: Vec<[f64; 3]> = vertices.iter().map(|vertex| vertex.at).collect();
    let mut ids: Vec<u32> = (0..positions.len() as u32).collect();
    let mut sums = vec![DVec3::ZERO; positions.len()];
    // The final vertex of each entry of `seen`.
    let mut becomes: Vec<u32> = seen.iter().map(|seen| seen.0).collect();
    let mut begin = 0;
    for run in seen.chunk_by(|a, b| a.0 == b.0) {
        let vertex = run[0].0;
        let mut groups: Vec<(DVec3, u32)> = Vec::new();
        for k in begin..begin + run.len() {
            let normal = normals[k];
            if normal == DVec3::ZERO {
                continue;
            }
            let group = groups.iter().find(|group| group.0.dot(normal) >= COS_SAME_NORMAL);
            let target = group.map(|group| group.1).unwrap_or_else(|| {
                // The first group keeps the vertex.
                let target = if groups.is_empty() { vertex } else { positions.len() as u32 };
                if target != vertex {
                    positions.push(positions[vertex as usize]);
                    ids.push(vertex);
                    sums.push(DVec3::ZERO);
                }
                groups.push((normal, target));
                target
            });
            sums[target as usize] += normal;
            becomes[k] = target;
        }
        begin += run.len();
    }
    let faces: Vec<[u32; 3]> = (0..leaves.len())
        .map(|index| {
            let sheet = sheet_of(index);
            leaves[index].0.vertices.map(|vertex| {
                let at = seen.partition_point(|seen| (seen.0, seen.1) < (vertex, sheet));
                becomes[at]
            })
        })
        .collect();
    let mut normals: Vec<[f64; 3]> = sums.into_iter().map(|sum| sum.normalize_or_zero().into()).collect();
    fill_missing_normals(&positions, &faces, &mut normals);
    let is_split = positions.len() > vertices.len();
    let mesh = mesh_with_normals(positions, faces, normals, is_split.then_some(ids));
    let Some(texcoords) = texcoords else { return mesh };
    // By sheet, so that the texture coordinates of each are prepared once.
    let mut order: Vec<u32> = (0..leaves.len() as u32).collect();
    order.sort_by_key(|leaf| sheet_of(*leaf as usize));
    let runs: Vec<&[u32]> = order.chunk_by(|a, b| sheet_of(*a as usize) == sheet_of(*b as usize)).collect();
    let normals_of_runs = par_map(job, &runs, |_, run| {
        let sheet = run.first().and_then(|leaf| texcoords.sheet(sheet_of(*leaf as usize) as usize));
        let of_leaf = |leaf: &u32| {
            let leaf = &leaves[*leaf as usize].0;
            leaf.places.map(|place| texcoords::at(sheet.as_ref(), cells[leaf.cell as usize].on_sheet(place)))
        };
        run.iter().map(of_leaf).collect::<Vec<_>>()
    });
    let mut corners = vec![[[0.0; 2]; 3]; leaves.len()];
    order
        .into_iter()
        .zip(normals_of_runs.into_iter().flatten())
        .for_each(|(leaf, own)| corners[leaf as usize] = own);
    texcoords::split_by_texcoords(mesh, corners.as_flattened())
}
