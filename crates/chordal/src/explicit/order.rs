//! The order of triangles and vertices for graphics processors, which cache the last few vertices.
//!
//! A graphics processor computes a vertex once as long as it stays in a small cache. The number of vertices
//! computed per triangle is the average cache miss ratio, ACMR: 3 without any sharing, 0.5 at best on a large
//! closed mesh.

/// The size of the cache that orders are optimized for: that of most processors. Orders for it suit smaller
/// ones too.
const CACHE: usize = 32;
/// Scores that choose the next triangle, as measured by the author of the method: the exponent of their decay
/// along the cache, the score of the last triangle's three vertices, and the bonus of vertices with few
/// triangles left, so that none of these is left isolated.
const DECAY: f64 = 1.5;
const LAST: f64 = 0.75;
const FEW_LEFT: f64 = 2.0;
/// The largest number of triangles left at a vertex that the score distinguishes.
const MOST_LEFT: usize = 64;
/// The most triangles of one vertex that are considered at a step, so that a step takes the same time at a hub of
/// any number of triangles. Beyond [`MOST_LEFT`] the score of a vertex no longer tells them apart; four times as
/// many, so that the poles of spheres and the caps of cylinders are looked at as a whole.
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
    let mut came_in = vec![0_u64; n_vertices(faces)];
    let mut misses = 0_u64;
    for &vertex in faces.as_flattened() {
        let last = &mut came_in[vertex as usize];
        if *last == 0 || misses - *last >= u64::from(cache) {
            misses += 1;
            *last = misses;
        }
    }
    misses
}

fn n_vertices(faces: &[[u32; 3]]) -> usize {
    faces.as_flattened().iter().max().map_or(0, |most| *most as usize + 1)
}

/// The order of triangles that reuses vertices while they are in the cache: a permutation of the rows of
/// `faces`. The corners of a triangle keep their order.
///
/// The same on every machine. Time O(n), about 0.2 µs per triangle, also where many triangles share a vertex;
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
    /// For each vertex the start of its corners in `around`, and the number of those left, which come first. The
    /// corner k of triangle i is 3 i + k.
    first: Vec<u32>,
    left: Vec<u32>,
    around: Vec<u32>,
    /// The place of each corner in `around`.
    slot: Vec<u32>,
    /// The index of each vertex in the cache, or `NONE`.
    place: Vec<u32>,
    vertex_score: Vec<f32>,
    is_drawn: Vec<bool>,
}

impl<'a> Forsyth<'a> {
    fn new(faces: &'a [[u32; 3]]) -> Self {
        let n = n_vertices(faces);
        let mut left = vec![0_u32; n];
        faces.as_flattened().iter().for_each(|v| left[*v as usize] += 1);
        let mut first = Vec::with_capacity(n);
        let mut sum = 0;
        for count in &left {
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
        let vertex_score = left.iter().map(|left| scores.score(NONE, *left)).collect();
        let (place, is_drawn) = (vec![NONE; n], vec![false; faces.len()]);
        Self { faces, scores, first, left, around, slot, place, vertex_score, is_drawn }
    }

    fn run(mut self) -> Vec<u32> {
        let mut order = Vec::with_capacity(self.faces.len());
        // The latest first; with space for three more, which leave after they are scored.
        let mut cache: Vec<u32> = Vec::with_capacity(CACHE + 3);
        let mut before = Vec::with_capacity(CACHE + 3);
        let (mut next, mut cursor) = (None, 0);
        while order.len() < self.faces.len() {
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

    /// Removes a corner from those left at its vertex.
    fn drop_corner(&mut self, vertex: u32, corner: u32) {
        let left = &mut self.left[vertex as usize];
        *left -= 1;
        let (at, last) = (self.slot[corner as usize], self.first[vertex as usize] + *left);
        let moved = self.around[last as usize];
        self.around.swap(at as usize, last as usize);
        (self.slot[moved as usize], self.slot[corner as usize]) = (at, last);
    }

    /// Corners of triangles left at a vertex, of which one may be next.
    fn considered(&self, vertex: u32) -> &[u32] {
        let from = self.first[vertex as usize] as usize;
        &self.around[from..from + (self.left[vertex as usize] as usize).min(MOST_CONSIDERED)]
    }

    /// Updates the scores of all vertices in the cache, evicts those that do not fit, and finds the best
    /// triangle.
    fn score(&mut self, cache: &mut Vec<u32>) -> Option<u32> {
        for (place, &v) in cache.iter().enumerate() {
            let place = if place < CACHE { place as u32 } else { NONE };
            self.place[v as usize] = place;
            self.vertex_score[v as usize] = self.scores.score(place, self.left[v as usize]);
        }
        let mut best: Option<(f32, u32)> = None;
        for &v in cache.iter() {
            for corner in self.considered(v) {
                let face = corner / 3;
                let [a, b, c] = self.faces[face as usize].map(|v| self.vertex_score[v as usize]);
                let score = a + b + c;
                // Of equal ones the first in the input order.
                if best.is_none_or(|(most, known)| score > most || (score == most && face < known)) {
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
    by_place: [f32; CACHE],
    by_left: [f32; MOST_LEFT],
}

impl VertexScores {
    fn new() -> Self {
        let by_place = |place: usize| {
            let share = 1.0 - (place as f64 - 3.0) / (CACHE as f64 - 3.0);
            if place < 3 { LAST } else { libm::pow(share, DECAY) }
        };
        let by_left = |left: usize| if left == 0 { 0.0 } else { FEW_LEFT / (left as f64).sqrt() };
        Self {
            by_place: std::array::from_fn(|place| by_place(place) as f32),
            by_left: std::array::from_fn(|left| by_left(left) as f32),
        }
    }

    fn score(&self, place: u32, left: u32) -> f32 {
        if left == 0 {
            return 0.0;
        }
        let few = self.by_left[(left as usize).min(MOST_LEFT - 1)];
        few + self.by_place.get(place as usize).copied().unwrap_or(0.0)
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
    let mut seen = vec![false; n_vertices(faces)];
    let is_new = |v: &&u32| !std::mem::replace(&mut seen[**v as usize], true);
    faces.as_flattened().iter().filter(is_new).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_looks_at_few_triangles_of_a_hub() {
        // A hundred thousand coincident triangles, and as many around one vertex: minutes if each step saw all.
        const N: u32 = 100_000;
        let fan: Vec<[u32; 3]> = (1..=N).map(|i| [0, i, i + 1]).collect();
        for faces in [vec![[0, 1, 2]; N as usize], fan] {
            let order = Forsyth::new(&faces);
            assert_eq!(order.left[0], N);
            assert!(order.considered(0).len() <= MOST_CONSIDERED);
            let ordered = order.run();
            let mut sorted = ordered.clone();
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..N), "not a permutation");
            let ordered: Vec<[u32; 3]> = ordered.iter().map(|face| faces[*face as usize]).collect();
            // In its own order each step of a fan brings one vertex; where the order jumps it brings two.
            let n_misses = cache_misses(&ordered, CACHE as u32);
            assert!(20 * n_misses <= 21 * u64::from(N), "{n_misses}");
        }
    }
}
