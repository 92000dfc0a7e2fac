//! `TileSeams`: the lines between tiles, split at every tile corner into pieces with one rate for both sides.
//!
//! Both neighbours take their boundary points from the same piece, so no T-junction and no crack can arise,
//! whatever the rates.
use super::adjacency::{PatchAdjacency, SideBoundary};
use super::patch_tile::PatchTile;
use super::subpatch::{Subpatch, SubpatchShape};
use crate::explicit::PatchSide;
use std::ops::Range;

/// The line on which a piece lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum SeamLine {
    /// A curve of the adjacency, by its own parameter.
    Edge(u32),
    /// Inside a patch at the `v` with these bits, by `u`.
    AlongU(u32, u64),
    /// Inside a patch at the `u` with these bits, by `v`.
    AlongV(u32, u64),
    /// A side of a patch that is one point: patch, side, vertex.
    Point(u32, PatchSide, u32),
}

/// A span of a line with equally spaced points.
#[derive(Clone, Debug)]
pub(crate) struct SeamSpan {
    pub(crate) line: SeamLine,
    /// Its start and end on the line.
    pub(crate) span: [f64; 2],
    /// The vertices at its start and end.
    pub(crate) nodes: [u32; 2],
    /// The number of segments.
    pub(crate) n: u32,
    /// The first of the `n − 1` vertices between.
    pub(crate) first: u32,
}

/// One side of a tile, in its counter-clockwise direction: a range of `links`.
type SeamChain = Range<usize>;

/// All pieces, and the sides of each tile as chains of pieces.
pub(crate) struct TileSeams {
    pub(crate) pieces: Vec<SeamSpan>,
    /// By tile and side.
    chains: Vec<[SeamChain; 4]>,
    /// A piece, and whether it is run backwards.
    links: Vec<(u32, bool)>,
    /// Positions of nodes (first) and of the points between (after them).
    pub(crate) positions: Vec<[f64; 3]>,
    n_nodes: usize,
    /// A piece, twice a tile beside it (plus one along v), and the fraction of the tile's side that the piece covers.
    demands: Vec<(u32, u32, f64)>,
    /// By edge: its pieces, and the fewest segments.
    min_segments: Vec<(Range<usize>, u32)>,
}

/// One tile side on its line.
struct TileSide {
    line: SeamLine,
    span: [f64; 2],
    tile: u32,
    side: PatchSide,
    backwards: bool,
}

impl TileSeams {
    /// Builds the pieces for `tiles`, which are listed patch by patch; [`TileSeams::set_rates`] sets rates
    /// and positions.
    pub(crate) fn new(adjacency: &PatchAdjacency, tiles: &[PatchTile]) -> Self {
        let mut entries: Vec<TileSide> = Vec::with_capacity(4 * tiles.len());
        for (index, tile) in tiles.iter().enumerate() {
            entries.extend(PatchSide::ALL.map(|side| TileSide::new(adjacency, tile, index as u32, side)));
        }
        entries.sort_by(|a, b| a.line.cmp(&b.line).then(a.span[0].total_cmp(&b.span[0])));
        let mut seams = Self {
            pieces: Vec::with_capacity(entries.len()),
            chains: vec![[0..0, 0..0, 0..0, 0..0]; tiles.len()],
            links: Vec::with_capacity(2 * entries.len()),
            positions: Vec::new(),
            n_nodes: 0,
            demands: Vec::with_capacity(2 * entries.len()),
            min_segments: Vec::new(),
        };
        let mut nodes = SeamNodes::new(adjacency, &entries, tiles);
        for run in entries.chunk_by(|a, b| a.line == b.line) {
            seams.split_line(run, &mut nodes);
        }
        seams.n_nodes = nodes.count as usize;
        seams
    }

    /// Splits one line at all ends of its entries and links the pieces to the entries:
    ///
    /// ```text
    ///   tiles on one side    |----------a----------|-----b-----|
    ///   tiles on the other   |---c---|-----------d-------------|
    ///   pieces               |---0---|------1------|-----2-----|
    /// ```
    fn split_line(&mut self, run: &[TileSide], nodes: &mut SeamNodes<'_>) {
        let line = run[0].line;
        let breaks = breakpoints(run);
        // Spans result from halving and are exact, so ends of different tiles compare equal.
        let index = |at: f64| breaks.partition_point(|b| *b < at);
        // A line within a patch has gaps where a larger tile extends across it.
        let mut covered = vec![false; breaks.len()];
        for entry in run {
            covered[index(entry.span[0])..index(entry.span[1])].fill(true);
        }
        let start = self.pieces.len();
        let mut number = vec![u32::MAX; breaks.len()];
        for (k, _) in covered.iter().enumerate().filter(|c| *c.1) {
            number[k] = self.pieces.len() as u32;
            let span = [breaks[k], breaks[k + 1]];
            let ends = span.map(|at| nodes.on(line, at));
            self.pieces.push(SeamSpan { line, span, nodes: ends, n: 0, first: 0 });
        }
        if let SeamLine::Edge(edge) = line {
            self.min_segments
                .push((start..self.pieces.len(), nodes.adjacency.edges[edge as usize].min_segments));
        }
        for entry in run {
            let length = entry.span[1] - entry.span[0];
            let first = self.links.len();
            let own_pieces = &number[index(entry.span[0])..index(entry.span[1])];
            self.links.extend(own_pieces.iter().map(|piece| (*piece, entry.backwards)));
            if entry.backwards {
                self.links[first..].reverse();
            }
            self.chains[entry.tile as usize][entry.side as usize] = first..self.links.len();
            for &piece in own_pieces {
                let [a, b] = self.pieces[piece as usize].span;
                self.demands.push((
                    piece,
                    2 * entry.tile + u32::from(is_along_v(entry.side)),
                    (b - a) / length,
                ));
            }
        }
    }

    /// Gives every piece the larger rate of its two sides, numbers the points and computes their positions.
    /// Returns by tile whether a piece of its border changed.
    pub(crate) fn set_rates(
        &mut self,
        tiles: &[PatchTile],
        subpatches: &[Subpatch<'_>],
        adjacency: &PatchAdjacency,
    ) -> Vec<bool> {
        let before: Vec<u32> =
            self.pieces.iter_mut().map(|piece| std::mem::replace(&mut piece.n, 1)).collect();
        for &(piece, demand, share) in &self.demands {
            let tile = &tiles[(demand / 2) as usize];
            let rate = (f64::from(if demand % 2 == 1 { tile.m } else { tile.n }) * share).ceil() as u32;
            let n = &mut self.pieces[piece as usize].n;
            *n = (*n).max(rate);
        }
        for (range, least) in &self.min_segments {
            let pieces = &mut self.pieces[range.clone()];
            let each = least.div_ceil(pieces.len() as u32);
            pieces.iter_mut().for_each(|piece| piece.n = piece.n.max(each));
        }
        let mut next = self.n_nodes as u32;
        for piece in &mut self.pieces {
            piece.first = next;
            // A side that is one point has no vertices inside.
            if !matches!(piece.line, SeamLine::Point(..)) {
                next += piece.n - 1;
            }
        }
        self.positions.clear();
        self.positions.resize(next as usize, [0.0; 3]);
        self.set_positions(tiles, subpatches, adjacency);
        let mut changed = vec![false; tiles.len()];
        for &(piece, demand, _) in &self.demands {
            changed[(demand / 2) as usize] |= self.pieces[piece as usize].n != before[piece as usize];
        }
        changed
    }

    fn set_positions(
        &mut self,
        tiles: &[PatchTile],
        subpatches: &[Subpatch<'_>],
        adjacency: &PatchAdjacency,
    ) {
        self.positions[..adjacency.corner_positions.len()].copy_from_slice(&adjacency.corner_positions);
        let n_corners = adjacency.corner_positions.len() as u32;
        // Any tile on a piece can compute its points.
        let mut beside = vec![None; self.pieces.len()];
        // In reverse, so that the first tile on each piece remains.
        for &(piece, demand, _) in self.demands.iter().rev() {
            beside[piece as usize] = Some(&tiles[(demand / 2) as usize]);
        }
        for (piece, tile) in self.pieces.iter().zip(beside) {
            let Some(tile) = tile else { continue };
            let subpatch = &subpatches[tile.subpatch as usize];
            let places: Box<dyn Fn(f64) -> [f64; 3]> = match piece.line {
                SeamLine::Edge(edge) => along_edge(adjacency, tile, subpatch, edge),
                SeamLine::AlongU(_, v) => Box::new(move |at| subpatch.at(at, f64::from_bits(v))),
                SeamLine::AlongV(_, u) => Box::new(move |at| subpatch.at(f64::from_bits(u), at)),
                SeamLine::Point(..) => continue,
            };
            for (node, k) in [(piece.nodes[0], 0), (piece.nodes[1], piece.n)] {
                if node >= n_corners {
                    self.positions[node as usize] = places(piece.parameter(k));
                }
            }
            for k in 1..piece.n {
                self.positions[(piece.first + k - 1) as usize] = places(piece.parameter(k));
            }
        }
    }

    /// The pieces of one side of a tile, in its counter-clockwise direction.
    pub(crate) fn chain(&self, tile: usize, side: PatchSide) -> impl Iterator<Item = (&SeamSpan, bool)> {
        self.links[self.chains[tile][side as usize].clone()]
            .iter()
            .map(|(p, back)| (&self.pieces[*p as usize], *back))
    }

    /// Whether the borders of a tile and of a tile of other seams have the same lines and spans, and the same vertex
    /// positions bit for bit. Then vertices of one border coincide if those of the other do.
    pub(crate) fn has_same_border(&self, tile: usize, other: &Self, other_tile: usize) -> bool {
        let bits = |seams: &Self, piece: &SeamSpan, k: u32| {
            seams.positions[piece.vertex(k) as usize].map(f64::to_bits)
        };
        let same = |side: PatchSide| {
            let (mut chain, mut other_chain) = (self.chain(tile, side), other.chain(other_tile, side));
            loop {
                match (chain.next(), other_chain.next()) {
                    (None, None) => return true,
                    (Some((a, back)), Some((b, other_back))) => {
                        let is_same = (a.line, a.span, a.n, back) == (b.line, b.span, b.n, other_back)
                            && (0..=a.n).all(|k| bits(self, a, k) == bits(other, b, k));
                        if !is_same {
                            return false;
                        }
                    }
                    _ => return false,
                }
            }
        };
        PatchSide::ALL.into_iter().all(same)
    }

    /// The number of segments on a side of a tile.
    pub(crate) fn count(&self, tile: usize, side: PatchSide) -> u32 {
        self.chain(tile, side).map(|(piece, _)| piece.n).sum()
    }
}

impl SeamSpan {
    /// The line's parameter at the `k`-th point.
    pub(crate) fn parameter(&self, k: u32) -> f64 {
        let [a, b] = self.span;
        // The sum may miss the end by a rounding.
        if k == self.n { b } else { a + (b - a) * (f64::from(k) / f64::from(self.n)) }
    }

    /// The vertex at the `k`-th point.
    pub(crate) fn vertex(&self, k: u32) -> u32 {
        if k == 0 || matches!(self.line, SeamLine::Point(..)) {
            self.nodes[0]
        } else if k == self.n {
            self.nodes[1]
        } else {
            self.first + k - 1
        }
    }
}

/// The points of an edge by its parameter, evaluated on a tile next to it.
fn along_edge<'a>(
    adjacency: &PatchAdjacency,
    tile: &PatchTile,
    subpatch: &'a Subpatch<'_>,
    edge: u32,
) -> Box<dyn Fn(f64) -> [f64; 3] + 'a> {
    let on_border = PatchSide::ALL.into_iter().find_map(|side| {
        let (is_border, against) =
            (tile.is_on_border(side), matches!(side, PatchSide::Top | PatchSide::Left));
        match adjacency.sides[tile.sheet as usize][side as usize] {
            SideBoundary::Edge { edge: side_edge, reversed } if side_edge == edge && is_border => {
                Some((side, against != reversed, [0.0, 1.0], reversed))
            }
            SideBoundary::Halves(halves) if is_border => {
                let half = tile.half(side);
                let (side_edge, reversed) = halves[half];
                let begin = 0.5 * half as f64;
                (side_edge == edge).then_some((side, against != reversed, [begin, begin + 0.5], reversed))
            }
            _ => None,
        }
    });
    let Some((side, is_flipped, [from, to], reversed)) = on_border else {
        return Box::new(|_| [0.0; 3]);
    };
    if let SubpatchShape::Bezier(patch) = &subpatch.shape
        && (subpatch.u, subpatch.v) == ([0.0, 1.0], [0.0, 1.0])
        && from == 0.0
        && to == 1.0
    {
        // On the curve and not on the patch: then the rounding error is relative to the curve's size, as
        // `derivative_bound.rs` derives it for all patches that share the curve.
        let curve = patch.side(side);
        let curve = if reversed { curve.reversed() } else { curve };
        return Box::new(move |at| curve.at(at));
    }
    Box::new(move |at| {
        let along = from + (to - from) * if is_flipped { 1.0 - at } else { at };
        let (u, v) = match side {
            PatchSide::Bottom => (along, 0.0),
            PatchSide::Right => (1.0, along),
            PatchSide::Top => (along, 1.0),
            PatchSide::Left => (0.0, along),
        };
        subpatch.at(u, v)
    })
}

fn is_along_v(side: PatchSide) -> bool {
    matches!(side, PatchSide::Left | PatchSide::Right)
}

fn breakpoints(run: &[TileSide]) -> Vec<f64> {
    let mut breaks: Vec<f64> = run.iter().flat_map(|entry| entry.span).collect();
    breaks.sort_by(f64::total_cmp);
    breaks.dedup();
    breaks
}

impl TileSide {
    fn new(adjacency: &PatchAdjacency, tile: &PatchTile, index: u32, side: PatchSide) -> Self {
        let (at, span) = match side {
            PatchSide::Bottom => (tile.v[0], tile.u),
            PatchSide::Top => (tile.v[1], tile.u),
            PatchSide::Left => (tile.u[0], tile.v),
            PatchSide::Right => (tile.u[1], tile.v),
        };
        let against = matches!(side, PatchSide::Top | PatchSide::Left);
        // Top and left run against the parameter. Parameters are dyadic, so 1 minus them is exact.
        let turned = |span: [f64; 2], flipped: bool| match flipped {
            true => [1.0 - span[1], 1.0 - span[0]],
            false => span,
        };
        let (line, span, backwards) = match adjacency.sides[tile.sheet as usize][side as usize] {
            _ if !tile.is_on_border(side) && is_along_v(side) => {
                (SeamLine::AlongV(tile.sheet, at.to_bits()), span, against)
            }
            _ if !tile.is_on_border(side) => (SeamLine::AlongU(tile.sheet, at.to_bits()), span, against),
            SideBoundary::Point => (
                SeamLine::Point(tile.sheet, side, adjacency.corners[tile.sheet as usize][side as usize]),
                span,
                against,
            ),
            SideBoundary::Edge { edge, reversed } => {
                (SeamLine::Edge(edge), turned(span, against != reversed), reversed)
            }
            SideBoundary::Halves(halves) => {
                let half = tile.half(side);
                let (edge, reversed) = halves[half];
                let span = span.map(|x| 2.0 * x - half as f64);
                (SeamLine::Edge(edge), turned(span, against != reversed), reversed)
            }
        };
        Self { line, span, tile: index, side, backwards }
    }
}

/// The vertices at the ends of pieces.
struct SeamNodes<'a> {
    adjacency: &'a PatchAdjacency,
    /// By edge: the parameters of tiles' corners strictly between its ends, with their vertices.
    on_edges: Vec<Vec<(f64, u32)>>,
    /// Corners of tiles inside patches, sorted, with their vertices.
    inside: Vec<((u32, u64, u64), u32)>,
    count: u32,
}

impl<'a> SeamNodes<'a> {
    fn new(adjacency: &'a PatchAdjacency, entries: &[TileSide], tiles: &[PatchTile]) -> Self {
        // Corners of sheets come first, then points on edges, then corners of tiles within sheets.
        let mut count = adjacency.corner_positions.len() as u32;
        let mut on_edges = vec![Vec::new(); adjacency.edges.len()];
        for run in entries.chunk_by(|a, b| a.line == b.line) {
            let SeamLine::Edge(edge) = run[0].line else { continue };
            for at in breakpoints(run).into_iter().filter(|at| *at > 0.0 && *at < 1.0) {
                on_edges[edge as usize].push((at, count));
                count += 1;
            }
        }
        let is_inside = |x: f64| x > 0.0 && x < 1.0;
        let corners = tiles.iter().flat_map(|t| {
            [(t.u[0], t.v[0]), (t.u[1], t.v[0]), (t.u[0], t.v[1]), (t.u[1], t.v[1])]
                .map(|(u, v)| (t.sheet, u, v))
        });
        let mut keys: Vec<(u32, u64, u64)> = corners
            .filter(|(_, u, v)| is_inside(*u) && is_inside(*v))
            .map(|(p, u, v)| (p, u.to_bits(), v.to_bits()))
            .collect();
        keys.sort_unstable();
        keys.dedup();
        let inside: Vec<_> = keys.into_iter().zip(count..).collect();
        count += inside.len() as u32;
        Self { adjacency, on_edges, inside, count }
    }

    /// The vertex at a breakpoint of a line.
    fn on(&self, line: SeamLine, at: f64) -> u32 {
        match line {
            SeamLine::Edge(edge) => self.on_edge(edge, at),
            SeamLine::AlongU(patch, v) => self.in_patch(patch, at, f64::from_bits(v)),
            SeamLine::AlongV(patch, u) => self.in_patch(patch, f64::from_bits(u), at),
            SeamLine::Point(_, _, vertex) => vertex,
        }
    }

    fn on_edge(&self, edge: u32, at: f64) -> u32 {
        let ends = self.adjacency.edges[edge as usize].ends;
        if at == 0.0 {
            return ends[0];
        }
        if at == 1.0 {
            return ends[1];
        }
        let list = &self.on_edges[edge as usize];
        list[list.partition_point(|(t, _)| *t < at)].1
    }

    fn in_patch(&self, patch: u32, u: f64, v: f64) -> u32 {
        // A line inside a patch never runs along its border, so at most one of the two is an end.
        let (side, along) = if v == 0.0 {
            (PatchSide::Bottom, u)
        } else if u == 1.0 {
            (PatchSide::Right, v)
        } else if v == 1.0 {
            (PatchSide::Top, 1.0 - u)
        } else if u == 0.0 {
            (PatchSide::Left, 1.0 - v)
        } else {
            let key = (patch, u.to_bits(), v.to_bits());
            return self.inside[self.inside.partition_point(|(k, _)| *k < key)].1;
        };
        match self.adjacency.sides[patch as usize][side as usize] {
            SideBoundary::Point => self.adjacency.corners[patch as usize][side as usize],
            SideBoundary::Edge { edge, reversed } => {
                self.on_edge(edge, if reversed { 1.0 - along } else { along })
            }
            SideBoundary::Halves(halves) => {
                // `along` is in the side's own direction; halves are in the order of the parameter.
                let against = matches!(side, PatchSide::Top | PatchSide::Left);
                let rising = if against { 1.0 - along } else { along };
                let half = usize::from(rising >= 0.5);
                let (edge, reversed) = halves[half];
                let within = 2.0 * rising - half as f64;
                self.on_edge(edge, if against != reversed { 1.0 - within } else { within })
            }
        }
    }
}
