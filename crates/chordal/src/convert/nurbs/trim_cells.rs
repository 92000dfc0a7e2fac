//! Triangulates the inside of polygons, cell by cell.
//!
//! Cells without an edge of a polygon are halved along a diagonal. Every other cell has its own triangulation: it keeps
//! the edges in the cell, and its vertices include the cell's corners and all vertices on the cell's sides, so that
//! neighbours fit. The inside is to the left of an edge; the rest of a cell, and cells without edges, follow from their
//! neighbours.
use super::face_cells::FaceCell;
use super::face_lattice::FaceLattice;
use super::trim_loops::TrimPolygons;
use crate::math::{Orientation, orient2d};
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};
use std::collections::{BTreeMap, VecDeque};

/// Smaller coordinates become 0, since they are too small for the triangulation's exact predicates. Defined: the limit of
/// the crate is about 1e-43.
const SMALLEST: f64 = 1e-40;

/// Triangles of a face.
pub(super) struct FaceTriangles {
    /// Vertices in coordinates of the lattice; those of the polygons come first.
    pub vertices: Vec<[f64; 2]>,
    /// Each with its patch.
    pub triangles: Vec<([u32; 3], usize)>,
    /// By vertex of the polygons: the first at its place.
    pub same: Vec<u32>,
    /// Edges that run both ways with no triangle beside them, with a patch each.
    pub stray: Vec<([u32; 2], usize)>,
}

/// The reason for which polygons enclose no area.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TrimConflict {
    /// Two edges cross, or the same area is inside by one and outside by another.
    Crossing,
    /// The inside reaches the end of the surface.
    Open,
}

/// The vertices and edges in a cell.
#[derive(Default)]
struct CellContent {
    vertices: Vec<u32>,
    edges: Vec<[u32; 2]>,
}

#[derive(Clone, Copy, PartialEq)]
enum TrimCellState {
    Unknown,
    Inside,
    Outside,
    Mixed,
}

struct CellVertex {
    at: Point2<f64>,
    id: u32,
}

impl HasPosition for CellVertex {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.at
    }
}

/// The edges of a cell, cut at the vertices that lie on them: the edges that bound the inside, with the inside to the
/// left, and the edges that run both ways.
struct CellEdges {
    bounding: Vec<[u32; 2]>,
    both_ways: Vec<[u32; 2]>,
}

/// A mixed cell: its inner triangles, and whether an edge has the inside beside it: for edges on the cell's sides, and
/// for edges that run both ways.
struct MixedCell {
    triangles: Vec<[u32; 3]>,
    borders: Vec<([u32; 2], bool)>,
    both_ways: Vec<([u32; 2], bool)>,
}

type CellTriangulation = ConstrainedDelaunayTriangulation<CellVertex>;
type CellHandles = BTreeMap<u32, FixedVertexHandle>;

struct CellTriangulator<'a> {
    lattice: &'a FaceLattice,
    vertices: Vec<[f64; 2]>,
    by_place: BTreeMap<[u64; 2], u32>,
}

/// The triangles inside of polygons.
pub(super) fn triangulate(
    lattice: &FaceLattice,
    polygons: &TrimPolygons,
) -> Result<FaceTriangles, TrimConflict> {
    let mut work = CellTriangulator {
        lattice,
        vertices: polygons.vertices.iter().map(|at| at.map(not_tiny)).collect(),
        by_place: BTreeMap::new(),
    };
    // Vertices at the same place become one.
    let ids: Vec<u32> = (0..work.vertices.len() as u32)
        .map(|id| *work.by_place.entry(key(work.vertices[id as usize])).or_insert(id))
        .collect();
    let mut contents: BTreeMap<FaceCell, CellContent> = BTreeMap::new();
    for id in &ids {
        for cell in lattice.cells.cells_at(work.vertices[*id as usize]) {
            contents.entry(cell).or_default().vertices.push(*id);
        }
    }
    for edge in polygons.loops.iter().flatten() {
        let ends = edge.ends.map(|id| ids[id as usize]);
        if ends[0] == ends[1] {
            continue;
        }
        let cells = lattice.cells.cells_of(ends.map(|id| work.vertices[id as usize]));
        if cells.is_empty() {
            return Err(TrimConflict::Crossing);
        }
        for cell in cells {
            contents.entry(cell).or_default().edges.push(ends);
        }
    }
    for cell in lattice.cells.all() {
        for at in lattice.cells.corners_on_sides(cell) {
            let id = work.id_at(at);
            contents.entry(cell).or_default().vertices.push(id);
        }
    }
    work.run(&contents, ids)
}

fn not_tiny(x: f64) -> f64 {
    if x.abs() < SMALLEST { 0.0 } else { x }
}

fn key([x, y]: [f64; 2]) -> [u64; 2] {
    [x.to_bits(), y.to_bits()]
}

impl CellTriangulator<'_> {
    /// The vertex at a place.
    fn id_at(&mut self, at: [f64; 2]) -> u32 {
        let next = self.vertices.len() as u32;
        let id = *self.by_place.entry(key(at)).or_insert(next);
        if id == next {
            self.vertices.push(at);
        }
        id
    }

    fn corners(&mut self, cell: FaceCell) -> [u32; 4] {
        self.lattice.cells.corners(cell).map(|at| self.id_at(at))
    }

    fn run(
        mut self,
        contents: &BTreeMap<FaceCell, CellContent>,
        same: Vec<u32>,
    ) -> Result<FaceTriangles, TrimConflict> {
        let cells = &self.lattice.cells;
        let mut states = vec![TrimCellState::Unknown; cells.count()];
        let mut triangles = Vec::new();
        let mut borders = BTreeMap::new();
        // Edges that run both ways: whether a triangle is beside them.
        let mut both_ways: BTreeMap<[u32; 2], (bool, usize)> = BTreeMap::new();
        let mut unbounded = Vec::new();
        for (cell, content) in contents {
            let edges = self.edges_of(content)?;
            if edges.bounding.is_empty() {
                unbounded.extend(edges.both_ways.into_iter().map(|edge| (edge, *cell)));
                continue;
            }
            let mixed = self.mixed_cell(*cell, content, &edges)?;
            states[cells.index(*cell)] = TrimCellState::Mixed;
            for (edge, is_inside) in mixed.both_ways {
                both_ways.entry(edge).or_insert((false, cell.patch)).0 |= is_inside;
            }
            triangles.extend(mixed.triangles.into_iter().map(|t| (t, cell.patch)));
            // The cells on both sides of an edge have to agree.
            for (edge, is_inside) in mixed.borders {
                if *borders.entry(edge).or_insert(is_inside) != is_inside {
                    return Err(TrimConflict::Crossing);
                }
            }
        }
        self.spread(&borders, &mut states)?;
        for cell in cells.all() {
            if states[cells.index(cell)] != TrimCellState::Inside {
                continue;
            }
            match contents.get(&cell) {
                // A cell with vertices of neighbours on its sides, without an edge.
                Some(content) => {
                    let cell_triangles = self.cell_triangles(cell, content)?;
                    triangles.extend(cell_triangles.into_iter().map(|t| (t, cell.patch)));
                }
                None => triangles.extend(self.halves(cell).map(|t| (t, cell.patch))),
            }
        }
        for (edge, cell) in unbounded {
            let is_inside = states[cells.index(cell)] == TrimCellState::Inside;
            both_ways.entry(edge).or_insert((false, cell.patch)).0 |= is_inside;
        }
        let of =
            |(edge, (is_inside, patch)): ([u32; 2], (bool, usize))| (!is_inside).then_some((edge, patch));
        let stray = both_ways.into_iter().filter_map(of).collect();
        Ok(FaceTriangles { vertices: self.vertices, triangles, same, stray })
    }

    /// Gives cells without edges the known states beside edges, from neighbour to neighbour.
    fn spread(
        &self,
        borders: &BTreeMap<[u32; 2], bool>,
        states: &mut [TrimCellState],
    ) -> Result<(), TrimConflict> {
        let cells = &self.lattice.cells;
        let mut queue: VecDeque<(FaceCell, bool)> = VecDeque::new();
        for (edge, is_inside) in borders {
            let beside = cells.cells_of(edge.map(|id| self.vertices[id as usize]));
            queue.extend(beside.into_iter().map(|cell| (cell, *is_inside)));
        }
        while let Some((cell, is_inside)) = queue.pop_front() {
            let state = &mut states[cells.index(cell)];
            let new_state = if is_inside { TrimCellState::Inside } else { TrimCellState::Outside };
            match *state {
                TrimCellState::Unknown => *state = new_state,
                // Edges pass through such a cell, so it hands no state on.
                TrimCellState::Mixed => continue,
                known if known == new_state => continue,
                _ => return Err(TrimConflict::Crossing),
            }
            let mut is_open = false;
            cells.for_neighbours(cell, |beside| match beside {
                Some(next) => queue.push_back((next, is_inside)),
                // No edge encloses this part of the inside.
                None => is_open |= is_inside,
            });
            if is_open {
                return Err(TrimConflict::Open);
            }
        }
        Ok(())
    }

    /// The two triangles of a cell, along the diagonal that is nearer to the surface.
    fn halves(&mut self, cell: FaceCell) -> [[u32; 3]; 2] {
        let ids = self.corners(cell);
        let places = ids.map(|id| self.vertices[id as usize]);
        let points = places.map(|at| self.lattice.position(at));
        let [first, second] = self.lattice.diagonal_bounds(cell.patch, places, points);
        let [a, b, c, d] = ids;
        if first <= second { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
    }

    /// The Delaunay triangulation of a cell's corners and vertices.
    fn points(
        &mut self,
        cell: FaceCell,
        content: &CellContent,
    ) -> Result<(CellTriangulation, CellHandles), TrimConflict> {
        let mut triangulation = ConstrainedDelaunayTriangulation::new();
        let mut handles = BTreeMap::new();
        for id in self.corners(cell).into_iter().chain(content.vertices.iter().copied()) {
            let [x, y] = self.vertices[id as usize];
            let vertex = CellVertex { at: Point2::new(x, y), id };
            let handle = triangulation.insert(vertex).map_err(|_| TrimConflict::Crossing)?;
            handles.insert(id, handle);
        }
        Ok((triangulation, handles))
    }

    /// All triangles of a cell that is inside.
    fn cell_triangles(
        &mut self,
        cell: FaceCell,
        content: &CellContent,
    ) -> Result<Vec<[u32; 3]>, TrimConflict> {
        let (triangulation, _) = self.points(cell, content)?;
        Ok(triangulation.inner_faces().map(|face| face.vertices().map(|vertex| vertex.data().id)).collect())
    }

    fn edges_of(&self, content: &CellContent) -> Result<CellEdges, TrimConflict> {
        let mut net: BTreeMap<[u32; 2], i32> = BTreeMap::new();
        // Parts of edges that run both ways cancel, as along the two sides of a slit.
        for edge in &content.edges {
            let stops = self.stops(*edge, &content.vertices);
            for (a, b) in stops.iter().zip(stops.iter().skip(1)) {
                let (pair, sign) = if a < b { ([*a, *b], 1) } else { ([*b, *a], -1) };
                *net.entry(pair).or_default() += sign;
            }
        }
        let mut cell_edges = CellEdges { bounding: Vec::new(), both_ways: Vec::new() };
        for (pair, n) in net {
            match n {
                0 => cell_edges.both_ways.push(pair),
                1 => cell_edges.bounding.push(pair),
                -1 => cell_edges.bounding.push([pair[1], pair[0]]),
                _ => return Err(TrimConflict::Crossing),
            }
        }
        Ok(cell_edges)
    }

    /// A cell with edges that bound the inside.
    fn mixed_cell(
        &mut self,
        cell: FaceCell,
        content: &CellContent,
        edges: &CellEdges,
    ) -> Result<MixedCell, TrimConflict> {
        let (mut triangulation, handles) = self.points(cell, content)?;
        for [a, b] in edges.bounding.iter().chain(&edges.both_ways) {
            let [a, b] = [a, b].map(|id| handles[id]);
            if !triangulation.can_add_constraint(a, b) {
                return Err(TrimConflict::Crossing);
            }
            triangulation.add_constraint(a, b);
        }
        let inside = inside_of(&triangulation, &handles, &edges.bounding)?;
        let mut mixed = MixedCell {
            triangles: Vec::new(),
            borders: Vec::new(),
            both_ways: edges.both_ways.iter().map(|edge| (*edge, false)).collect(),
        };
        for face in triangulation.inner_faces() {
            let is_inside = inside[face.fix().index()] == Some(true);
            if is_inside {
                mixed.triangles.push(face.vertices().map(|vertex| vertex.data().id));
            }
            for edge in face.adjacent_edges() {
                let [a, b] = edge.vertices().map(|vertex| vertex.data().id);
                let pair = if a < b { [a, b] } else { [b, a] };
                if is_inside && let Ok(k) = edges.both_ways.binary_search(&pair) {
                    mixed.both_ways[k].1 = true;
                }
                if !edge.rev().face().is_outer() {
                    continue;
                }
                if edges.bounding.contains(&[a, b]) || edges.bounding.contains(&[b, a]) {
                    continue;
                }
                // The cells beyond the rest of the border have the same state there.
                mixed.borders.push((pair, is_inside));
                if is_inside && self.lattice.cells.is_end(pair.map(|id| self.vertices[id as usize])) {
                    return Err(TrimConflict::Open);
                }
            }
        }
        Ok(mixed)
    }

    /// The ends of an edge, and vertices that lie on it, in its order.
    fn stops(&self, [a, b]: [u32; 2], vertices: &[u32]) -> Vec<u32> {
        let [p, q] = [a, b].map(|id| self.vertices[id as usize]);
        // Along the axis of the longer extent, where no two points of the edge have equal coordinates.
        let axis = usize::from((q[1] - p[1]).abs() > (q[0] - p[0]).abs());
        let is_on = |id: &u32| {
            let at = self.vertices[*id as usize];
            let (low, high) = if p[axis] < q[axis] { (p[axis], q[axis]) } else { (q[axis], p[axis]) };
            at[axis] > low && at[axis] < high && orient2d(p, q, at) == Orientation::Flat
        };
        let mut between: Vec<u32> = vertices.iter().copied().filter(is_on).collect();
        between.sort_by(|x, y| {
            let along = |id: u32| self.vertices[id as usize][axis];
            if p[axis] < q[axis] { along(*x).total_cmp(&along(*y)) } else { along(*y).total_cmp(&along(*x)) }
        });
        between.dedup();
        let mut stops = vec![a];
        stops.extend(between);
        stops.push(b);
        stops
    }
}

/// By face of a triangulation: whether it is inside, that is, to the left of bounding edges, or connected to such a face
/// without an edge between.
fn inside_of(
    triangulation: &CellTriangulation,
    handles: &CellHandles,
    bounding: &[[u32; 2]],
) -> Result<Vec<Option<bool>>, TrimConflict> {
    let mut inside: Vec<Option<bool>> = vec![None; triangulation.num_all_faces()];
    let mut walls = vec![false; triangulation.num_undirected_edges()];
    let mut open = VecDeque::new();
    for ends in bounding {
        let [a, b] = ends.map(|id| handles[&id]);
        let Some(edge) = triangulation.get_edge_from_neighbors(a, b) else {
            // A vertex lies on the edge.
            return Err(TrimConflict::Crossing);
        };
        walls[edge.as_undirected().fix().index()] = true;
        for (edge, value) in [(edge, true), (edge.rev(), false)] {
            open.extend(edge.face().as_inner().map(|face| (face.fix(), value)));
        }
    }
    while let Some((face, value)) = open.pop_front() {
        match inside[face.index()] {
            Some(known) if known == value => continue,
            Some(_) => return Err(TrimConflict::Crossing),
            None => inside[face.index()] = Some(value),
        }
        for edge in triangulation.face(face).adjacent_edges() {
            if !walls[edge.as_undirected().fix().index()] {
                open.extend(edge.rev().face().as_inner().map(|next| (next.fix(), value)));
            }
        }
    }
    Ok(inside)
}
