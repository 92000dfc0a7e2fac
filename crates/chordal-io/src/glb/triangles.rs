//! Converts triangle lists, strips and fans to triangles.

/// The corners of a primitive.
pub(super) enum PrimitiveIndices {
    /// The first vertex, and the number of consecutive vertices.
    Range(u32, u32),
    /// Vertices by their index.
    List(Vec<u32>),
}

impl PrimitiveIndices {
    fn len(&self) -> usize {
        match self {
            Self::Range(_, n) => *n as usize,
            Self::List(list) => list.len(),
        }
    }

    fn get(&self, i: usize) -> u32 {
        match self {
            Self::Range(first, _) => first + i as u32,
            Self::List(list) => list[i],
        }
    }

    /// The most triangles that the corners can form.
    pub fn n_triangles(&self) -> u64 {
        self.len() as u64
    }
}

/// The corners and triangles that were skipped.
#[derive(Default)]
pub(super) struct SkippedTriangles {
    /// Leftover corners at the end, too few for another triangle.
    pub unused: u64,
    /// Degenerate triangles of strips and fans, which only join two runs.
    pub degenerate: u64,
}

/// Appends the triangles of a list (mode 4), a strip (5) or a fan (6). Lists keep degenerate triangles.
pub(super) fn triangles(corners: &PrimitiveIndices, mode: u64, out: &mut Vec<[u32; 3]>) -> SkippedTriangles {
    let n = corners.len();
    let mut left = SkippedTriangles::default();
    if mode == 4 {
        match corners {
            PrimitiveIndices::List(list) => out.extend_from_slice(list.as_chunks().0),
            PrimitiveIndices::Range(first, _) => {
                out.extend((0..n as u32 / 3).map(|t| [0, 1, 2].map(|k| first + 3 * t + k)));
            }
        }
        left.unused = (n % 3) as u64;
        return left;
    }
    if n < 3 {
        left.unused = n as u64;
        return left;
    }
    // Corners in the order of the formulas of glTF's specification:
    //
    //       1 --- 3 --- 5         strip: 0 1 2, 1 3 2, 2 3 4, 3 5 4
    //      / \   / \   /
    //     0 --- 2 --- 4           fan:   1 2 0, 2 3 0, 3 4 0
    for i in 0..n - 2 {
        let [a, b, c] = match mode {
            // Every second triangle of a strip is flipped, so that all have the same orientation.
            5 => [i, i + 1 + i % 2, i + 2 - i % 2],
            _ => [i + 1, i + 2, 0],
        }
        .map(|k| corners.get(k));
        if a == b || b == c || c == a {
            left.degenerate += 1;
        } else {
            out.push([a, b, c]);
        }
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;

    fn build(mode: u64, list: &[u32]) -> (Vec<[u32; 3]>, u64, u64) {
        let mut out = Vec::new();
        let left = triangles(&PrimitiveIndices::List(list.to_vec()), mode, &mut out);
        (out, left.unused, left.degenerate)
    }

    #[test]
    fn strips_and_fans_face_one_way() {
        assert_eq!(build(5, &[0, 1, 2, 3, 4]), (vec![[0, 1, 2], [1, 3, 2], [2, 3, 4]], 0, 0));
        assert_eq!(build(6, &[0, 1, 2, 3]), (vec![[1, 2, 0], [2, 3, 0]], 0, 0));
        assert_eq!(build(4, &[0, 1, 2, 3, 4]), (vec![[0, 1, 2]], 2, 0));
        assert_eq!(build(5, &[0, 1]), (vec![], 2, 0));
        assert_eq!(build(5, &[0, 1, 2, 2, 3, 3, 4, 5]).0, vec![[0, 1, 2], [3, 5, 4]]);
        let mut out = Vec::new();
        triangles(&PrimitiveIndices::Range(10, 3), 4, &mut out);
        assert_eq!(out, vec![[10, 11, 12]]);
    }
}
