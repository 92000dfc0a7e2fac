//! Assembles finished tiles into one mesh: numbers the vertices and shares normals where the surface is
//! smooth.
use super::adjacency::{PatchAdjacency, SideBoundary};
use super::patch_tile::{PatchTile, PatchTileMesh};
use super::seams::TileSeams;
use super::subpatch::Subpatch;
use super::tile_border::{self, BorderVertex};
use crate::explicit::{Attribute, Mesh, PatchSide, face_normal};
use glam::DVec3;

/// Normals of two patches at one vertex that differ by less than this are merged: 1°, far above the rounding
/// of a smooth joint (1e-8°) and below what shading shows as an edge. cos 1° = 0.99984769….
pub(crate) const COS_SAME_NORMAL: f64 = 0.999_847_695_156_391;

/// The normal of a border vertex, as one side of a sheet sees it.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
struct BorderNormal {
    vertex: u32,
    sheet: u32,
    side: PatchSide,
    normal: [f64; 3],
}

/// Builds the mesh of all tiles. A vertex on shared curves is one vertex, except where the patches' normals
/// differ: there each smooth group gets its own vertex, tied by `position_id`.
pub(crate) fn assemble(seams: &TileSeams, tiles: &[(PatchTile, PatchTileMesh)]) -> Mesh {
    let mut positions = seams.positions.clone();
    let mut normals = vec![[0.0; 3]; positions.len()];
    let borders: Vec<Vec<BorderVertex>> =
        (0..tiles.len()).map(|index| tile_border::border(index, &tiles[index].0, seams)).collect();
    let seen = border_normals(&borders, tiles, &mut normals);
    let mut splits = NormalSplits::default();
    let mut ids: Vec<u32> = Vec::new();
    splits.group_normals(seen, &mut positions, &mut normals, &mut ids);
    let n_border = positions.len();
    let n_inner: usize = tiles.iter().map(|t| t.1.inner.len()).sum();
    positions.reserve(n_inner);
    normals.reserve(n_inner);
    let mut faces = Vec::with_capacity(tiles.iter().map(|t| t.1.triangles.len()).sum());
    for ((place, tile), border) in tiles.iter().zip(borders) {
        let border: Vec<u32> = border.iter().map(|b| splits.vertex(b.id, place.sheet, b.side)).collect();
        let first = positions.len() as u32;
        let n = border.len() as u32;
        let global = |local: u32| if local < n { border[local as usize] } else { first + (local - n) };
        faces.extend(tile.triangles.iter().map(|t| t.map(global)));
        positions.extend_from_slice(&tile.inner);
        normals.extend_from_slice(&tile.inner_normals);
    }
    fill_missing_normals(&positions, &faces, &mut normals);
    let split_ids = (!ids.is_empty()).then(|| {
        // Vertices on borders, those that splits have added to them, and inner ones.
        let base = (n_border - ids.len()) as u32;
        (0..base).chain(ids).chain(n_border as u32..positions.len() as u32).collect::<Vec<u32>>()
    });
    drop_unreferenced(positions, faces, normals, split_ids)
}

/// The normals at the vertices on the border of a tile, in the order of the border; zero if the surface has none.
pub(crate) fn normals_on_border(
    subpatch: &Subpatch<'_>,
    adjacency: &PatchAdjacency,
    seams: &TileSeams,
    (index, tile): (usize, &PatchTile),
) -> Vec<[f64; 3]> {
    let within = |x: f64, [from, to]: [f64; 2]| from + (to - from) * x;
    let is_point =
        |side: PatchSide| matches!(adjacency.sides[tile.sheet as usize][side as usize], SideBoundary::Point);
    let mut normals = Vec::new();
    for at in PatchSide::ALL {
        tile_border::walk_side(index, tile, at, seams, |u, v, vertex| {
            let (u, v) = (within(u, tile.u), within(v, tile.v));
            let Some(side) = vertex.side else {
                normals.push(subpatch.normal(u, v).unwrap_or_default());
                return;
            };
            let is_corner = (u == 0.0 || u == 1.0) && (v == 0.0 || v == 1.0);
            let before = PatchSide::ALL[(side as usize + 3) % 4];
            // At a pole all directions meet; the normal at the middle of the collapsed side is used for all of
            // its vertices.
            let (u, v) = match (is_corner && is_point(side), is_corner && is_point(before)) {
                (true, _) => side_parameters(side, 0.5),
                (_, true) => side_parameters(before, 0.5),
                _ if vertex.pole => {
                    normals.push([0.0; 3]);
                    return;
                }
                _ => (u, v),
            };
            normals.push(subpatch.normal(u, v).unwrap_or_default());
        });
    }
    normals
}

/// The vertices on borders of sheets with the sheet's normals, sorted by vertex. The normals of other vertices on
/// borders of tiles are written to `normals`.
fn border_normals(
    borders: &[Vec<BorderVertex>],
    tiles: &[(PatchTile, PatchTileMesh)],
    normals: &mut [[f64; 3]],
) -> Vec<BorderNormal> {
    let mut on_borders = Vec::new();
    for ((tile, done), border) in tiles.iter().zip(borders) {
        for (vertex, &normal) in border.iter().zip(&done.border_normals) {
            match vertex.side {
                // A pole has a normal only at corners.
                Some(_) if vertex.pole && normal == [0.0; 3] => {}
                Some(side) => {
                    on_borders.push(BorderNormal { vertex: vertex.id, sheet: tile.sheet, side, normal })
                }
                None if normals[vertex.id as usize] == [0.0; 3] => normals[vertex.id as usize] = normal,
                None => {}
            }
        }
    }
    let mut on_borders = sort_by_vertex(&on_borders, normals.len(), |on_borders| on_borders.vertex);
    // The sorts are stable, so the order of tiles is kept within a vertex.
    on_borders
        .chunk_by_mut(|a, b| a.vertex == b.vertex)
        .for_each(|run| run.sort_by_key(|s| (s.sheet, s.side)));
    // Two tiles that meet on a border both have the vertex.
    on_borders.dedup_by_key(|s| (s.vertex, s.sheet, s.side));
    on_borders
}

/// The items sorted by vertex, stably: a counting sort, since there are about as many vertices as items.
pub(crate) fn sort_by_vertex<T: Copy>(items: &[T], n_vertices: usize, vertex: impl Fn(&T) -> u32) -> Vec<T> {
    let Some(first) = items.first() else { return Vec::new() };
    let mut begin = vec![0_u32; n_vertices + 1];
    items.iter().for_each(|item| begin[vertex(item) as usize + 1] += 1);
    for k in 0..n_vertices {
        begin[k + 1] += begin[k];
    }
    let mut sorted = vec![*first; items.len()];
    for item in items {
        let next = &mut begin[vertex(item) as usize];
        sorted[*next as usize] = *item;
        *next += 1;
    }
    sorted
}

/// The parameters at `along` of a side, in its counter-clockwise direction.
fn side_parameters(side: PatchSide, along: f64) -> (f64, f64) {
    match side {
        PatchSide::Bottom => (along, 0.0),
        PatchSide::Right => (1.0, along),
        PatchSide::Top => (1.0 - along, 1.0),
        PatchSide::Left => (0.0, 1.0 - along),
    }
}

/// Vertices that are split because the normals around them differ.
#[derive(Default)]
struct NormalSplits {
    /// Sorted by (vertex, sheet, side).
    moved: Vec<((u32, u32, PatchSide), u32)>,
    is_split: Vec<bool>,
}

impl NormalSplits {
    /// Groups the normals at every vertex. The first group keeps the vertex; every other group gets a new
    /// one, whose original vertex is appended to `ids`.
    fn group_normals(
        &mut self,
        seen: Vec<BorderNormal>,
        positions: &mut Vec<[f64; 3]>,
        normals: &mut Vec<[f64; 3]>,
        ids: &mut Vec<u32>,
    ) {
        self.is_split = vec![false; positions.len()];
        for run in seen.chunk_by(|a, b| a.vertex == b.vertex) {
            let vertex = run[0].vertex;
            let mut groups: Vec<(DVec3, DVec3, u32)> = Vec::new();
            for seen in run {
                let normal = DVec3::from(seen.normal);
                if normal == DVec3::ZERO {
                    continue;
                }
                // With the first normal of a group, not with its mean, so that a group does not drift along a
                // series of small steps.
                let same_group = groups.iter_mut().find(|group| group.0.dot(normal) >= COS_SAME_NORMAL);
                let target = if let Some(group) = same_group {
                    group.1 += normal;
                    group.2
                } else {
                    let target = if groups.is_empty() { vertex } else { positions.len() as u32 };
                    if target != vertex {
                        positions.push(positions[vertex as usize]);
                        normals.push([0.0; 3]);
                        ids.push(vertex);
                        self.is_split[vertex as usize] = true;
                    }
                    groups.push((normal, normal, target));
                    target
                };
                if target != vertex {
                    self.moved.push(((vertex, seen.sheet, seen.side), target));
                }
            }
            for (_, sum, target) in groups {
                normals[target as usize] = sum.normalize_or_zero().into();
            }
        }
        self.moved.sort_by_key(|m| m.0);
    }

    fn vertex(&self, id: u32, sheet: u32, side: Option<PatchSide>) -> u32 {
        let Some(side) = side.filter(|_| self.is_split[id as usize]) else { return id };
        let key = (id, sheet, side);
        self.moved.binary_search_by_key(&key, |m| m.0).map_or(id, |index| self.moved[index].1)
    }
}

/// Gives each vertex without a surface normal the sum of its faces' normals, or the z axis if the sum vanishes.
pub(crate) fn fill_missing_normals(positions: &[[f64; 3]], faces: &[[u32; 3]], normals: &mut [[f64; 3]]) {
    if normals.iter().all(|n| *n != [0.0; 3]) {
        return;
    }
    let mut sums = vec![DVec3::ZERO; positions.len()];
    for face in faces {
        if let Some(normal) = face_normal(face.map(|i| positions[i as usize])) {
            face.iter().for_each(|i| sums[*i as usize] += DVec3::from(normal));
        }
    }
    for (normal, sum) in normals.iter_mut().zip(sums).filter(|(normal, _)| **normal == [0.0; 3]) {
        *normal = sum.try_normalize().unwrap_or(DVec3::Z).into();
    }
}

/// Removes vertices that no triangle uses (the collapsed side of a pole leaves some).
fn drop_unreferenced(
    positions: Vec<[f64; 3]>,
    mut faces: Vec<[u32; 3]>,
    normals: Vec<[f64; 3]>,
    ids: Option<Vec<u32>>,
) -> Mesh {
    let mut used = vec![false; positions.len()];
    faces.as_flattened().iter().for_each(|i| used[*i as usize] = true);
    if used.iter().all(|u| *u) {
        return mesh_with_normals(positions, faces, normals, ids);
    }
    let mut number = vec![u32::MAX; positions.len()];
    for (next, (slot, _)) in number.iter_mut().zip(&used).filter(|(_, used)| **used).enumerate() {
        *slot = next as u32;
    }
    faces.as_flattened_mut().iter_mut().for_each(|i| *i = number[*i as usize]);
    let kept = |list: Vec<[f64; 3]>| {
        list.into_iter().zip(&used).filter(|(_, used)| **used).map(|(x, _)| x).collect()
    };
    // A position id has to be the row of a remaining vertex: the first one of its group is used.
    let ids = ids.map(|ids| {
        let mut leader = vec![u32::MAX; ids.len()];
        let pairs = ids.iter().enumerate().filter(|(i, _)| used[*i]);
        pairs
            .map(|(i, id)| {
                let leader = &mut leader[*id as usize];
                *leader = (*leader).min(number[i]);
                *leader
            })
            .collect()
    });
    mesh_with_normals(kept(positions), faces, kept(normals), ids)
}

/// The mesh with its normals and position ids.
pub(crate) fn mesh_with_normals(
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    normals: Vec<[f64; 3]>,
    ids: Option<Vec<u32>>,
) -> Mesh {
    let normals = Attribute::vertex_normals(&normals);
    let mesh = Mesh::new(positions, faces).and_then(|mesh| mesh.with_attribute(normals));
    let mesh = match ids {
        Some(ids) => mesh.and_then(|mesh| mesh.with_position_id(ids)),
        None => mesh,
    };
    mesh.expect("indices and lengths are right by construction, and positions were checked to be finite")
}
