//! The edges of a cage, numbered as its faces come to them.
use super::Cage;

/// Edges, with the faces on them.
pub(crate) struct Edges {
    /// The lower vertex first.
    pub ends: Vec<[u32; 2]>,
    /// The edge from each corner to the next of its face.
    pub of_corner: Vec<u32>,
    /// Where the faces of each edge end in `faces`.
    face_ends: Vec<u32>,
    /// Faces, in ascending order within an edge.
    faces: Vec<u32>,
    /// Edges that other than two faces use, or two that are wound against each other there.
    pub crowded: Vec<bool>,
    /// Edges by their ends, for those who look for one.
    sorted: Vec<([u32; 2], u32)>,
}

impl Edges {
    pub fn of(cage: &Cage) -> Self {
        // Every corner with its edge, by the edge; and which way it runs.
        let mut halves: Vec<([u32; 2], u32, bool)> = Vec::with_capacity(cage.corners.len());
        for face in cage.faces() {
            for (k, &a) in face.iter().enumerate() {
                let b = face[(k + 1) % face.len()];
                halves.push((if a < b { [a, b] } else { [b, a] }, halves.len() as u32, a < b));
            }
        }
        halves.sort_unstable();
        // Numbers in the order of the first corner.
        let mut firsts: Vec<(u32, usize)> = Vec::new();
        let mut start = 0;
        for run in halves.chunk_by(|a, b| a.0 == b.0) {
            firsts.push((run[0].1, start));
            start += run.len();
        }
        firsts.sort_unstable();
        let face_of = face_of_corners(cage);
        let mut edges = Self {
            ends: Vec::with_capacity(firsts.len()),
            of_corner: vec![0; halves.len()],
            face_ends: Vec::with_capacity(firsts.len()),
            faces: Vec::with_capacity(halves.len()),
            crowded: Vec::with_capacity(firsts.len()),
            sorted: Vec::with_capacity(firsts.len()),
        };
        for (number, (_, start)) in firsts.into_iter().enumerate() {
            let ends = halves[start].0;
            let run = halves[start..].iter().take_while(|half| half.0 == ends);
            let mut up = 0;
            for (_, corner, runs_up) in run.clone() {
                edges.of_corner[*corner as usize] = number as u32;
                edges.faces.push(face_of[*corner as usize]);
                up += usize::from(*runs_up);
            }
            let n = run.count();
            edges.crowded.push(n > 2 || n == 2 && up != 1);
            edges.ends.push(ends);
            edges.face_ends.push(edges.faces.len() as u32);
            edges.sorted.push((ends, number as u32));
        }
        edges.sorted.sort_unstable();
        edges
    }

    /// The faces of an edge.
    pub fn faces(&self, edge: usize) -> &[u32] {
        let start = if edge == 0 { 0 } else { self.face_ends[edge - 1] };
        &self.faces[start as usize..self.face_ends[edge] as usize]
    }

    /// The edge between two vertices.
    pub fn between(&self, a: u32, b: u32) -> Option<u32> {
        let ends = if a < b { [a, b] } else { [b, a] };
        self.sorted.binary_search_by_key(&ends, |entry| entry.0).ok().map(|k| self.sorted[k].1)
    }

    /// The sharp ones by their ends, from the sharpness of each.
    pub fn sharp(&self, sharpness: &[f64]) -> Vec<([u32; 2], f64)> {
        let all = self.sorted.iter().map(|(ends, edge)| (*ends, sharpness[*edge as usize]));
        all.filter(|(_, sharp)| *sharp > 0.0).collect()
    }
}

/// The face of each corner.
fn face_of_corners(cage: &Cage) -> Vec<u32> {
    let mut faces = Vec::with_capacity(cage.corners.len());
    for (face, of) in cage.faces().enumerate() {
        faces.extend(of.iter().map(|_| face as u32));
    }
    faces
}

/// Edges around each vertex, and faces around it.
pub(super) struct Around {
    edge_ends: Vec<u32>,
    edges: Vec<u32>,
    face_ends: Vec<u32>,
    faces: Vec<u32>,
}

impl Around {
    pub fn of(cage: &Cage, edges: &Edges) -> Self {
        let n = cage.positions.len();
        let of_edges = edges.ends.iter().enumerate().flat_map(|(e, ends)| ends.map(|v| (v, e as u32)));
        let of_faces = cage.faces().enumerate().flat_map(|(f, of)| of.iter().map(move |v| (*v, f as u32)));
        let (edge_ends, edges) = listed(n, of_edges);
        let (face_ends, faces) = listed(n, of_faces);
        Self { edge_ends, edges, face_ends, faces }
    }

    pub fn edges(&self, vertex: usize) -> &[u32] {
        part(&self.edge_ends, &self.edges, vertex)
    }

    pub fn faces(&self, vertex: usize) -> &[u32] {
        part(&self.face_ends, &self.faces, vertex)
    }
}

fn part<'a>(ends: &[u32], all: &'a [u32], which: usize) -> &'a [u32] {
    let start = if which == 0 { 0 } else { ends[which - 1] };
    &all[start as usize..ends[which] as usize]
}

/// Lists of what belongs to each of `n`, in the order in which it comes.
fn listed(n: usize, pairs: impl Iterator<Item = (u32, u32)> + Clone) -> (Vec<u32>, Vec<u32>) {
    let mut counts = vec![0_u32; n];
    pairs.clone().for_each(|(owner, _)| counts[owner as usize] += 1);
    let mut end = 0;
    let mut places: Vec<u32> = Vec::with_capacity(n);
    for count in &counts {
        places.push(end);
        end += count;
    }
    let mut all = vec![0; end as usize];
    for (owner, what) in pairs {
        let place = &mut places[owner as usize];
        all[*place as usize] = what;
        *place += 1;
    }
    (places, all)
}
