//! Marching squares: the lines between inside and outside samples of a plane lattice.

/// A crossed edge of the lattice: its axis and its lower sample.
pub(in crate::convert) type CrossedEdge = (usize, [usize; 2]);

/// A line through crossed edges, and whether it is closed.
pub(in crate::convert) type Isoline = (Vec<CrossedEdge>, bool);

/// The isolines of a lattice, with inside on their left. As on the faces of cells, every run of inside
/// corners of a square is cut off by itself: each crossed edge has one segment in each of its squares, so
/// lines never meet, and end at the border only.
pub(in crate::convert) fn isolines(size: [usize; 2], inside: impl Fn([usize; 2]) -> bool) -> Vec<Isoline> {
    let [nx, ny] = size;
    let number = |(axis, [i, j]): CrossedEdge| 2 * (i + nx * j) + axis;
    let edge = |number: usize| -> CrossedEdge { (number % 2, [number / 2 % nx, number / 2 / nx]) };
    let none = usize::MAX;
    let (mut next, mut has_before) = (vec![none; 2 * nx * ny], vec![false; 2 * nx * ny]);
    for j in 0..ny.saturating_sub(1) {
        for i in 0..nx.saturating_sub(1) {
            // Counter-clockwise, with the edge after each corner.
            let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(&inside);
            let edges = [(0, [i, j]), (1, [i + 1, j]), (0, [i, j + 1]), (1, [i, j])];
            square_segments(corners, |from, to| {
                let (from, to) = (number(edges[from]), number(edges[to]));
                next[from] = to;
                has_before[to] = true;
            });
        }
    }
    let mut lines = Vec::new();
    let mut seen = vec![false; next.len()];
    // Lines that begin at the border, then closed lines.
    for closed in [false, true] {
        for start in 0..next.len() {
            if next[start] == none || seen[start] || has_before[start] != closed {
                continue;
            }
            let mut line = Vec::new();
            let mut at = start;
            while at != none && !seen[at] {
                seen[at] = true;
                line.push(edge(at));
                at = next[at];
            }
            lines.push((line, closed));
        }
    }
    lines
}

/// The segments of a square with these corners inside, counter-clockwise, from side to side: side c follows
/// corner c.
pub(in crate::convert) fn square_segments(corners: [bool; 4], mut each: impl FnMut(usize, usize)) {
    for out in (0..4).filter(|&c| corners[c] && !corners[(c + 1) % 4]) {
        let run = (1..4).find(|back| !corners[(out + 4 - back) % 4]).unwrap_or(1);
        each(out, (out + 4 - run) % 4);
    }
}
