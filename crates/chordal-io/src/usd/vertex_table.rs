//! `UsdVertexTable`: vertex rows, one for each combination of a point and rows of streams that corners use.
use crate::ReadError;
use crate::grow::{push, push_many, with_room};
use std::collections::HashMap;

/// The streams that may have a row for each corner: normals, colours, and two sets of texture coordinates.
pub(super) const STREAMS: usize = 4;

/// A row that is not used yet.
const UNUSED: u32 = u32::MAX;

/// A corner of a face: a point, and a row of each stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct UsdCorner {
    pub point: u32,
    pub rows: [u32; STREAMS],
}

/// Numbers the combinations. The first one at a point gets the point's number, others follow in order of use.
#[derive(Debug)]
pub(super) struct UsdVertexTable {
    rows: Vec<UsdCorner>,
    n_points: usize,
    // Only for lookups: no result depends on its order.
    index: HashMap<UsdCorner, u32>,
}

impl UsdVertexTable {
    pub(super) fn new(n_points: usize) -> Result<Self, ReadError> {
        let mut rows = with_room(n_points)?;
        rows.extend((0..n_points as u32).map(|point| UsdCorner { point, rows: [UNUSED; STREAMS] }));
        // Only for lookups: no result depends on its order.
        Ok(Self { rows, n_points, index: HashMap::new() })
    }

    pub(super) fn row(&mut self, corner: UsdCorner) -> Result<u32, ReadError> {
        let first_corner = &mut self.rows[corner.point as usize];
        if first_corner.rows == [UNUSED; STREAMS] {
            first_corner.rows = corner.rows;
        }
        if first_corner.rows == corner.rows {
            return Ok(corner.point);
        }
        let next = self.rows.len();
        let row = *self.index.entry(corner).or_insert(next as u32);
        if row as usize == next {
            if next >= UNUSED as usize {
                return Err(crate::grow::out_of_memory(next));
            }
            push(&mut self.rows, corner)?;
        }
        Ok(row)
    }

    pub(super) fn rows(&self) -> &[UsdCorner] {
        &self.rows
    }

    pub(super) fn has_splits(&self) -> bool {
        self.rows.len() > self.n_points
    }
}

/// For each row of values the first row with the same bits.
pub(super) fn first_equal_rows(values: &[f64], width: usize) -> Result<Vec<u32>, ReadError> {
    let n = values.len() / width.max(1);
    let row = |i: u32| values[i as usize * width..][..width].iter().map(|x| x.to_bits());
    let mut order: Vec<u32> = with_room(n)?;
    order.extend(0..n as u32);
    order.sort_unstable_by(|a, b| row(*a).cmp(row(*b)).then(a.cmp(b)));
    let mut first = Vec::new();
    push_many(&mut first, 0, n)?;
    let mut current = 0;
    for (at, i) in order.iter().enumerate() {
        if at == 0 || !row(*i).eq(row(current)) {
            current = *i;
        }
        first[*i as usize] = current;
    }
    Ok(first)
}
