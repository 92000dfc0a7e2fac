//! The order of triangles and vertices for graphics processors, which cache the last few vertices.
//!
//! A graphics processor computes a vertex only once while it stays in a small cache. The number of vertices
//! computed per triangle is the average cache miss ratio, ACMR: 3 without any sharing, 0.5 at best on a large
//! closed mesh.

/// The size of the cache that orders are optimized for. Chosen: that of most processors; orders for it suit
/// smaller caches too.
const CACHE: usize = 32;
/// Scores that choose the next triangle, measured by the author of the method: the exponent of their decay
/// along the cache, the score of the last triangle's three vertices, and the bonus of vertices with few
/// triangles left, so that no triangle is left isolated.
const DECAY: f64 = 1.5;
const LAST: f64 = 0.75;
const FEW_LEFT: f64 = 2.0;
/// The largest number of triangles left at a vertex that the score distinguishes.
const MOST_LEFT: usize = 64;
/// The most triangles of one vertex that are considered in a step, so that a step takes the same time at a
/// hub of any number of triangles. Beyond [`MOST_LEFT`] the score of a vertex no longer distinguishes them.
/// Chosen: four times as many, so that the poles of spheres and the caps of cylinders are considered
/// completely.
const MOST_CONSIDERED: usize = 4 * MOST_LEFT;
const NONE: u32 = u32::MAX;

/// The number of vertices that a first-in, first-out cache of `cache` entries computes per triangle, drawn in
/// order; 0 without triangles. Time O(n).
///
/// ```
/// use chordal::explicit::acmr;
/// assert_eq!(acmr(&[[0, 1, 2], [2, 1, 3]], 16), 2.0);
/// assert_eq!(acmr(&[[0, 1, 2], [3, 4, 5]], 16), 3.0);
/// ```
#[must_use]
pub fn acmr(faces: &[[u32; 3]], cache: u32) -> f64 {
    if faces.is_empty() {
        return 0.0;
    }
    cache_misses(faces, cache) as f64 / faces.len() as f64
}

/// The total number of vertices that a first-in, first-out cache of `cache` entries computes.
#[must_use]
pub fn cache_misses(faces: &[[u32; 3]], cache: u32) -> u64 {
    // A vertex is in the cache as long as fewer than `cache` others have entered after it.
    let mut entered_at = vec![0_u64; n_vertices(faces)];
    let mut misses = 0_u64;
    for &vertex in faces.as_flattened() {
        let last = &mut entered_at[vertex as usize];
        // Misses are counted from 1 on, so 0 means that the vertex was never in the cache.
        if *last == 0 || misses - *last >= u64::from(cache) {
            misses += 1;
            *last = misses;
        }
    }
    misses
}

fn n_vertices(faces: &[[u32; 3]]) -> usize {
    faces.as_flattened().iter().max().map_or(0, |largest| *largest as usize + 1)
}

/// The order of triangles that reuses vertices while they are in the cache: a permutation of the rows of
/// `faces`. The corners of a triangle keep their order.
///
/// The same on every machine. Time O(n), about 0.2 µs per triangle, even if many triangles share a vertex;
/// memory about 40 bytes per triangle.
///
/// ```
/// use chordal::explicit::{acmr, cache_order};
/// let strip = |y: u32| (0..50).flat_map(move |x| { let a = 51 * y + x; [[a, a + 1, a + 52], [a, a + 52, a + 51]] });
/// let faces: Vec<[u32; 3]> = (0..50).flat_map(strip).collect();
/// let ordered: Vec<[u32; 3]> = cache_order(&faces).iter().map(|i| faces[*i as usize]).collect();
/// assert!(acmr(&faces, 16) > 1.0 && acmr(&ordered, 16) < 0.75);
/// ```
///
/// Source: T. Forsyth, *Linear-speed vertex cache optimisation*, 2006.
#[must_use]
pub fn cache_order(faces: &[[u32; 3]]) -> Vec<u32> {
    Forsyth::new(faces).run()
}

struct Forsyth<'a> {
    faces: &'a [[u32; 3]],
    scores: VertexScores,
    /// For each vertex the start of its corners in `around`, and the number of its corners not yet drawn,
    /// which come first. Corner k of triangle i is 3 i + k.
    first: Vec<u32>,
    n_left: Vec<u32>,
    around: Vec<u32>,
    /// The index of each corner in `around`.
    slot: Vec<u32>,
    /// The index of each vertex in the cache, or `NONE`.
    cache_index: Vec<u32>,
    vertex_score: Vec<f32>,
    is_drawn: Vec<bool>,
}

impl<'a> Forsyth<'a> {
    fn new(faces: &'a [[u32; 3]]) -> Self {
        let n = n_vertices(faces);
        let mut n_left = vec![0_u32; n];
        faces.as_flattened().iter().for_each(|v| n_left[*v as usize] += 1);
        let mut first = Vec::with_capacity(n);
        let mut sum = 0;
        for count in &n_left {
            first.push(sum);
            sum += count;
        }
        let mut end = first.clone();
        let (mut around, mut slot) = (vec![0; 3 * faces.len()], vec![0; 3 * faces.len()]);
        for (corner, v) in faces.as_flattened().iter().enumerate() {
            let at = &mut end[*v as usize];
            around[*at as usize] = corner as u32;
            slot[corner] = *at;
            *at += 1;
        }
        let scores = VertexScores::new();
        let vertex_score = n_left.iter().map(|n_left| scores.score(NONE, *n_left)).collect();
        let (cache_index, is_drawn) = (vec![NONE; n], vec![false; faces.len()]);
        Self { faces, scores, first, n_left, around, slot, cache_index, vertex_score, is_drawn }
    }

    fn run(mut self) -> Vec<u32> {
        let mut order = Vec::with_capacity(self.faces.len());
        // The latest first; with space for three more, which are evicted after they are scored.
        let mut cache: Vec<u32> = Vec::with_capacity(CACHE + 3);
        let mut before = Vec::with_capacity(CACHE + 3);
        let (mut next, mut cursor) = (None, 0);
        while order.len() < self.faces.len() {
            // If no triangle at a cached vertex is left, the first one in the input order goes on;
            // the cursor never has to go back.
            let face = next.unwrap_or_else(|| {
                while self.is_drawn[cursor] {
                    cursor += 1;
                }
                cursor as u32
            });
            order.push(face);
            self.is_drawn[face as usize] = true;
            std::mem::swap(&mut cache, &mut before);
            cache.clear();
            for (k, v) in (0..).zip(self.faces[face as usize]) {
                self.drop_corner(v, 3 * face + k);
                // A face may have a vertex twice.
                if !cache.contains(&v) {
                    cache.push(v);
                }
            }
            let corners = cache.len();
            cache.extend(before.iter().filter(|v| !self.faces[face as usize].contains(v)));
            debug_assert!(corners <= 3);
            next = self.score(&mut cache);
        }
        order
    }

    /// Removes a drawn corner from the remaining ones of its vertex, by a swap with the last of them.
    fn drop_corner(&mut self, vertex: u32, corner: u32) {
        let n_left = &mut self.n_left[vertex as usize];
        *n_left -= 1;
        let (at, last) = (self.slot[corner as usize], self.first[vertex as usize] + *n_left);
        let moved = self.around[last as usize];
        self.around.swap(at as usize, last as usize);
        (self.slot[moved as usize], self.slot[corner as usize]) = (at, last);
    }

    /// Remaining corners at a vertex, whose triangles are candidates for the next one.
    fn considered(&self, vertex: u32) -> &[u32] {
        let from = self.first[vertex as usize] as usize;
        &self.around[from..from + (self.n_left[vertex as usize] as usize).min(MOST_CONSIDERED)]
    }

    /// Updates the scores of all vertices in the cache, evicts those that do not fit, and finds the best
    /// triangle.
    fn score(&mut self, cache: &mut Vec<u32>) -> Option<u32> {
        for (index, &v) in cache.iter().enumerate() {
            let index = if index < CACHE { index as u32 } else { NONE };
            self.cache_index[v as usize] = index;
            self.vertex_score[v as usize] = self.scores.score(index, self.n_left[v as usize]);
        }
        let mut best: Option<(f32, u32)> = None;
        for &v in cache.iter() {
            for corner in self.considered(v) {
                let face = corner / 3;
                let [a, b, c] = self.faces[face as usize].map(|v| self.vertex_score[v as usize]);
                let score = a + b + c;
                // Of equal scores, the first in the input order.
                if best.is_none_or(|(best_score, best_face)| {
                    score > best_score || (score == best_score && face < best_face)
                }) {
                    best = Some((score, face));
                }
            }
        }
        cache.truncate(CACHE);
        best.map(|(_, face)| face)
    }
}

/// Scores by the index in the cache and by the number of triangles left.
struct VertexScores {
    by_index: [f32; CACHE],
    by_left: [f32; MOST_LEFT],
}

impl VertexScores {
    fn new() -> Self {
        let by_index = |index: usize| {
            let share = 1.0 - (index as f64 - 3.0) / (CACHE as f64 - 3.0);
            if index < 3 { LAST } else { libm::pow(share, DECAY) }
        };
        let by_left = |n_left: usize| if n_left == 0 { 0.0 } else { FEW_LEFT / (n_left as f64).sqrt() };
        Self {
            by_index: std::array::from_fn(|index| by_index(index) as f32),
            by_left: std::array::from_fn(|n_left| by_left(n_left) as f32),
        }
    }

    fn score(&self, index: u32, n_left: u32) -> f32 {
        if n_left == 0 {
            return 0.0;
        }
        let few = self.by_left[(n_left as usize).min(MOST_LEFT - 1)];
        few + self.by_index.get(index as usize).copied().unwrap_or(0.0)
    }
}

/// The order in which triangles first use vertices, as old indices by new ones: vertices drawn together are
/// close in memory. Vertices that no triangle uses are left out. Time O(n).
///
/// ```
/// use chordal::explicit::fetch_order;
/// assert_eq!(fetch_order(&[[7, 2, 3], [3, 2, 0]]), [7, 2, 3, 0]);
/// ```
#[must_use]
pub fn fetch_order(faces: &[[u32; 3]]) -> Vec<u32> {
    let mut is_used = vec![false; n_vertices(faces)];
    let is_new = |v: &&u32| !std::mem::replace(&mut is_used[**v as usize], true);
    faces.as_flattened().iter().filter(is_new).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_looks_at_few_triangles_of_a_hub() {
        // A hundred thousand coincident triangles, and as many around one vertex: minutes if each step
        // visited all.
        const N: u32 = 100_000;
        let fan: Vec<[u32; 3]> = (1..=N).map(|i| [0, i, i + 1]).collect();
        for faces in [vec![[0, 1, 2]; N as usize], fan] {
            let order = Forsyth::new(&faces);
            assert_eq!(order.n_left[0], N);
            assert!(order.considered(0).len() <= MOST_CONSIDERED);
            let ordered = order.run();
            let mut sorted = ordered.clone();
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..N), "not a permutation");
            let ordered: Vec<[u32; 3]> = ordered.iter().map(|face| faces[*face as usize]).collect();
            // In its own order each step of a fan loads one vertex; where the order jumps it loads two.
            let n_misses = cache_misses(&ordered, CACHE as u32);
            assert!(20 * n_misses <= 21 * u64::from(N), "{n_misses}");
        }
    }
}
