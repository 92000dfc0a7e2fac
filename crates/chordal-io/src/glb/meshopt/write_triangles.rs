//! The encoder of triangles, in version 1 of the format, which every reader of glTF supports.
use super::indices::TABLE;
use super::recent_items::RecentItems;

/// The code of a corner whose index follows in full.
const STORED: u8 = 15;

/// The output of an encoder, and the state that its decoder will have.
struct TriangleEncoder<'a> {
    codes: Vec<u8>,
    data: Vec<u8>,
    /// The codes for two corners that take no extra byte.
    table: &'a [u8; TABLE],
    /// The frequency of each code for two corners.
    counts: Vec<u32>,
    next: u32,
    last: u32,
    edges: RecentItems<[u32; 2]>,
    vertices: RecentItems<u32>,
}

/// Encodes triangles. Their order is kept, but each may be rotated to another first corner. Linear in their
/// number.
pub(super) fn encode(triangles: &[[u32; 3]]) -> Vec<u8> {
    // A first run counts which codes deserve an entry in the table.
    let counts = run(triangles, &[0; TABLE]).counts;
    let fits = |code: &usize| counts[*code] > 0 && code >> 4 < 15 && code & 15 < 15 && *code > 0;
    let mut common: Vec<usize> = (0..counts.len()).filter(fits).collect();
    common.sort_by_key(|code| (std::cmp::Reverse(counts[*code]), *code));
    // Two entries are reserved; the first one is for two new corners.
    let mut table = [0; TABLE];
    table[1..TABLE - 2].iter_mut().zip(common).for_each(|(place, code)| *place = code as u8);
    let TriangleEncoder { codes, data, .. } = run(triangles, &table);
    [&[0xE1][..], &codes, &data, &table].concat()
}

fn run<'a>(triangles: &[[u32; 3]], table: &'a [u8; TABLE]) -> TriangleEncoder<'a> {
    let mut encoder = TriangleEncoder {
        codes: Vec::with_capacity(triangles.len()),
        data: Vec::new(),
        table,
        counts: vec![0; 256],
        next: 0,
        last: 0,
        edges: RecentItems::new(),
        vertices: RecentItems::new(),
    };
    for triangle in triangles {
        let turns = [0, 1, 2].map(|k| [triangle[k], triangle[(k + 1) % 3], triangle[(k + 2) % 3]]);
        let edge = turns.iter().filter_map(|turn| Some((encoder.edges.age([turn[0], turn[1]], 15)?, *turn)));
        let code = match edge.min() {
            Some((age, corners)) => age << 4 | encoder.on_edge(corners),
            None => {
                let follows = turns.iter().find(|turn| turn[0] == encoder.next);
                encoder.alone(*follows.unwrap_or(triangle))
            }
        };
        encoder.codes.push(code);
    }
    encoder
}

impl TriangleEncoder<'_> {
    /// Writes the third corner of a triangle on a recent edge.
    fn on_edge(&mut self, [a, b, c]: [u32; 3]) -> u8 {
        let code = if c == self.next {
            self.next = self.next.wrapping_add(1);
            0
        } else if let Some(age @ 1..) = self.vertices.age(c, 13) {
            age
        } else if c == self.last.wrapping_sub(1) || c == self.last.wrapping_add(1) {
            let below = c == self.last.wrapping_sub(1);
            self.last = c;
            if below { 13 } else { 14 }
        } else {
            self.put_index(c);
            STORED
        };
        if code == 0 || code > 12 {
            self.vertices.push(c);
        }
        [[c, b], [a, c]].into_iter().for_each(|edge| self.edges.push(edge));
        code
    }

    /// Writes a triangle without a recent edge.
    fn alone(&mut self, corners: [u32; 3]) -> u8 {
        let [a, b, c] = corners;
        let follows = a == self.next;
        self.next = self.next.wrapping_add(u32::from(follows));
        let mut kinds = [0; 2];
        // In the order of the decoder: a new `b` takes `next` before `c` is compared with it.
        for (kind, v) in kinds.iter_mut().zip([b, c]) {
            *kind = match self.vertices.age(v, 14) {
                _ if v == self.next => {
                    self.next = self.next.wrapping_add(1);
                    0
                }
                Some(age) => age + 1,
                None => STORED,
            };
        }
        let mut code = kinds[0] << 4 | kinds[1];
        if code == 0 && !follows {
            // After a stored corner, the code for two new ones would mean the start of a new mesh.
            self.next = self.next.wrapping_sub(1);
            (kinds[1], code) = (STORED, STORED);
        }
        self.counts[usize::from(code)] += u32::from(follows);
        let place = self.table[..TABLE - 2].iter().position(|entry| *entry == code).filter(|_| follows);
        if place.is_none() {
            self.data.push(code);
            if !follows {
                self.put_index(a);
            }
            let stored = [b, c].into_iter().zip(kinds).filter(|(_, kind)| *kind == STORED);
            stored.for_each(|(v, _)| self.put_index(v));
        }
        // The same pushes in the same order as the decoder's, or ages would mean different items
        // there.
        self.vertices.push(a);
        let new = [b, c].into_iter().zip(kinds).filter(|(_, kind)| *kind == 0 || *kind == STORED);
        new.for_each(|(v, _)| self.vertices.push(v));
        // Reversed, since the triangle on the other side runs along its edge the other way.
        [[b, a], [c, b], [a, c]].into_iter().for_each(|edge| self.edges.push(edge));
        match place {
            Some(place) => 0xF0 | place as u8,
            None if follows => 0xFE,
            None => 0xFF,
        }
    }

    /// Writes an index as its difference to the last one: the sign in the lowest bit, seven bits per byte.
    fn put_index(&mut self, index: u32) {
        let delta = index.wrapping_sub(self.last);
        self.last = index;
        let mut rest = (delta << 1) ^ (delta >> 31).wrapping_neg();
        while rest >= 128 {
            self.data.push(rest as u8 | 128);
            rest >>= 7;
        }
        self.data.push(rest as u8);
    }
}
