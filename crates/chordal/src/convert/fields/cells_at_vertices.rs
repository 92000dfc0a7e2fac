//! `CellsAtVertices`: the cells at each vertex of a grid.

/// The cells at each vertex, as linked lists in one store.
#[derive(Debug, Default)]
pub(super) struct CellsAtVertices {
    /// By vertex: its first node.
    first: Vec<u32>,
    /// A cell, and the next node.
    nodes: Vec<(u32, u32)>,
}

const NONE: u32 = u32::MAX;

impl CellsAtVertices {
    pub fn push(&mut self, vertex: u32, cell: u32) {
        let vertex = vertex as usize;
        if self.first.len() <= vertex {
            self.first.resize(vertex + 1, NONE);
        }
        self.nodes.push((cell, self.first[vertex]));
        self.first[vertex] = self.nodes.len() as u32 - 1;
    }

    pub fn cells_at(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        let mut node = self.first.get(vertex as usize).copied().unwrap_or(NONE);
        std::iter::from_fn(move || {
            let (cell, next) = *self.nodes.get(node as usize)?;
            node = next;
            Some(cell)
        })
    }
}
