//! A plain encoder, which chooses by chance among all that the format allows: so every code comes up.
use super::PackedRows;
use chordal_testkit::Random;
use std::collections::VecDeque;

/// Packs rows of `stride` bytes.
pub fn vertices(rows: &[u8], stride: usize, version: u8, random: &mut Random) -> PackedRows {
    let n_channels = stride / 4;
    let modes: Vec<u8> = (0..n_channels)
        .map(|_| match (version, random.below(3)) {
            (0, _) | (_, 0) => 0,
            (_, 1) => 1,
            _ => 2 | (random.below(16) as u8) << 4,
        })
        .collect();
    let first: Vec<u8> = (0..stride).map(|_| random.below(256) as u8).collect();
    let mut last = first.clone();
    let mut out = vec![0xA0 | version];
    let block_rows = (8192 / stride / 16 * 16).min(256);
    for block in rows.chunks(block_rows * stride) {
        let columns = differences(block, stride, &modes, &mut last);
        let mut body = Vec::new();
        let mut controls = vec![0_u8; n_channels];
        for (k, column) in columns.iter().enumerate() {
            let control = if version == 0 { None } else { Some(choose_control(column, random)) };
            controls[k / 4] |= control.unwrap_or(0) << (2 * (k % 4));
            put_column(column, control, block.len() / stride, random, &mut body);
        }
        if version == 1 {
            out.extend(controls);
        }
        out.extend(body);
    }
    let tail = if version == 0 { first } else { [first, modes].concat() };
    let least = if version == 0 { 32_usize } else { 24 };
    out.resize(out.len() + least.saturating_sub(tail.len()), 0);
    out.extend(tail);
    PackedRows::new("ATTRIBUTES", stride, rows.len() / stride, out)
}

/// The differences of a block, a list for each byte of a row, filled up with zeros to whole groups.
fn differences(block: &[u8], stride: usize, modes: &[u8], last: &mut Vec<u8>) -> Vec<Vec<u8>> {
    let n = block.len() / stride;
    let mut columns = vec![vec![0; n.next_multiple_of(16)]; stride];
    for (i, row) in block.chunks(stride).enumerate() {
        for (channel, mode) in modes.iter().enumerate() {
            let at = 4 * channel;
            let bytes = |row: &[u8]| [row[at], row[at + 1], row[at + 2], row[at + 3]];
            let (now, before) = (bytes(row), bytes(last));
            let delta = match mode & 15 {
                0 => [0, 1, 2, 3].map(|k| {
                    let d = now[k].wrapping_sub(before[k]) as i8;
                    ((d << 1) ^ (d >> 7)) as u8
                }),
                1 => {
                    let word = |of: [u8; 4], k: usize| u16::from(of[k]) + 256 * u16::from(of[k + 1]);
                    let zigzag = |k: usize| {
                        let d = word(now, k).wrapping_sub(word(before, k)) as i16;
                        (((d << 1) ^ (d >> 15)) as u16).to_le_bytes()
                    };
                    let ([a, b], [c, d]) = (zigzag(0), zigzag(2));
                    [a, b, c, d]
                }
                _ => {
                    let changed = u32::from_le_bytes(now) ^ u32::from_le_bytes(before);
                    changed.rotate_left(u32::from(mode >> 4)).to_le_bytes()
                }
            };
            delta.iter().enumerate().for_each(|(k, d)| columns[at + k][i] = *d);
        }
        last.clear();
        last.extend(row);
    }
    columns
}

fn choose_control(column: &[u8], random: &mut Random) -> u8 {
    let is_zero = column.iter().all(|d| *d == 0);
    [0, 1, 3, 2][random.below(if is_zero { 4 } else { 3 })]
}

fn put_column(column: &[u8], control: Option<u8>, n: usize, random: &mut Random, out: &mut Vec<u8>) {
    let widths = match control {
        None => [0, 2, 4, 8],
        Some(0) => [0, 1, 2, 4],
        Some(1) => [1, 2, 4, 8],
        Some(2) => return,
        _ => return out.extend(&column[..n]),
    };
    let groups: Vec<&[u8]> = column.chunks(16).collect();
    let choices: Vec<usize> = groups
        .iter()
        .map(|group| {
            let is_zero = group.iter().all(|d| *d == 0);
            let least = usize::from(widths[0] == 0 && !is_zero);
            least + random.below(4 - least)
        })
        .collect();
    out.extend(choices.chunks(4).map(|four| four.iter().rev().fold(0, |byte, c| byte << 2 | *c as u8)));
    for (group, choice) in groups.iter().zip(choices) {
        let width = widths[choice];
        if width == 0 || width == 8 {
            out.extend(group.iter().filter(|_| width == 8));
            continue;
        }
        let sentinel = (1_u32 << width) as u8 - 1;
        for byte in group.chunks(8 / width) {
            let short = |d: &u8| (*d).min(sentinel);
            out.push(match width {
                1 => byte.iter().rev().fold(0, |bits, d| bits << 1 | short(d)),
                _ => byte.iter().fold(0, |bits, d| bits << width | short(d)),
            });
        }
        out.extend(group.iter().filter(|d| **d >= sentinel));
    }
}

/// A number in seven bits a byte.
fn put_leb128(mut x: u32, out: &mut Vec<u8>) {
    while x >= 128 {
        out.push(x as u8 | 128);
        x >>= 7;
    }
    out.push(x as u8);
}

fn zigzag(d: u32) -> u32 {
    (d << 1) ^ ((d as i32) >> 31) as u32
}

/// Packs indices.
pub fn sequence(list: &[u32], stride: usize, version: u8, random: &mut Random) -> PackedRows {
    let mut out = vec![0xD0 | version];
    let mut last = [0_u32; 2];
    for index in list {
        let which = random.below(2);
        put_leb128(zigzag(index.wrapping_sub(last[which])) << 1 | which as u32, &mut out);
        last[which] = *index;
    }
    out.extend([0; 4]);
    PackedRows::new("INDICES", stride, list.len(), out)
}

/// What an encoder of triangles remembers. The newest come first.
struct TriangleMemory {
    next: u32,
    last: u32,
    edges: VecDeque<[u32; 2]>,
    vertices: VecDeque<u32>,
    data: Vec<u8>,
    /// The codes of two corners that take no byte: the first that come up.
    table: Vec<u8>,
}

impl TriangleMemory {
    fn put_index(&mut self, index: u32) {
        put_leb128(zigzag(index.wrapping_sub(self.last)), &mut self.data);
        self.last = index;
    }

    fn push_vertex(&mut self, vertex: u32) {
        self.vertices.push_front(vertex);
        self.vertices.truncate(16);
    }

    fn push_edges(&mut self, edges: &[[u32; 2]]) {
        edges.iter().for_each(|edge| self.edges.push_front(*edge));
        self.edges.truncate(16);
    }

    fn age(&self, vertex: u32) -> Option<usize> {
        self.vertices.iter().position(|known| *known == vertex)
    }

    /// The code of a triangle whose first edge came `age` edges ago.
    fn on_edge(&mut self, [a, b, c]: [u32; 3], age: usize, version: u8, random: &mut Random) -> u8 {
        let mut codes = vec![15];
        codes.extend((c == self.next).then_some(0));
        let oldest = if version == 0 { 14 } else { 12 };
        codes.extend(self.age(c).filter(|age| (1..=oldest).contains(age)).map(|age| age as u8));
        if version > 0 {
            codes.extend((c == self.last.wrapping_sub(1)).then_some(13));
            codes.extend((c == self.last.wrapping_add(1)).then_some(14));
        }
        let code = codes[random.below(codes.len())];
        match code {
            0 => self.next += 1,
            15 => self.put_index(c),
            13 | 14 if version > 0 => self.last = c,
            _ => {}
        }
        if code == 0 || code == 15 || (version > 0 && code >= 13) {
            self.push_vertex(c);
        }
        self.push_edges(&[[c, b], [a, c]]);
        (age as u8) << 4 | code
    }

    /// The code of any triangle.
    fn alone(&mut self, corners: [u32; 3], random: &mut Random) -> u8 {
        let [a, b, c] = corners;
        let restarts = corners == [0, 1, 2] && self.next > 0;
        if restarts {
            self.next = 0;
        }
        let follows = a == self.next;
        self.next += u32::from(follows);
        let mut kinds = [0_u8; 2];
        for (kind, v) in kinds.iter_mut().zip([b, c]) {
            let known = self.age(v).filter(|age| *age < 14 && !restarts).map(|age| age as u8 + 1);
            // Two zeros after an explicit corner would start anew.
            let may_follow = v == self.next && (follows || v != c);
            *kind = match known {
                Some(kind) if random.below(4) > 0 => kind,
                _ if may_follow => 0,
                _ => 15,
            };
            self.next += u32::from(*kind == 0);
        }
        let code = kinds[0] << 4 | kinds[1];
        if !self.table.contains(&code) && kinds.iter().all(|kind| *kind < 15) && self.table.len() < 14 {
            self.table.push(code);
        }
        let place = self.table.iter().position(|entry| *entry == code);
        let place = place.filter(|_| follows && !restarts && (code == 0 || random.below(4) > 0));
        if place.is_none() {
            self.data.push(code);
            if !follows {
                self.put_index(a);
            }
            [b, c].iter().zip(kinds).filter(|(_, kind)| *kind == 15).for_each(|(v, _)| self.put_index(*v));
        }
        self.push_vertex(a);
        [b, c]
            .iter()
            .zip(kinds)
            .filter(|(_, kind)| *kind == 0 || *kind == 15)
            .for_each(|(v, _)| self.push_vertex(*v));
        self.push_edges(&[[b, a], [c, b], [a, c]]);
        match place {
            Some(place) => 0xF0 | place as u8,
            None if follows => 0xFE,
            None => 0xFF,
        }
    }
}

/// Packs triangles; also gives them as they come out, each turned to another first corner perhaps.
pub fn triangles(
    list: &[[u32; 3]],
    stride: usize,
    version: u8,
    random: &mut Random,
) -> (PackedRows, Vec<u32>) {
    let mut memory = TriangleMemory {
        next: 0,
        last: 0,
        edges: VecDeque::new(),
        vertices: VecDeque::new(),
        data: Vec::new(),
        table: vec![0],
    };
    let (mut codes, mut turned) = (Vec::new(), Vec::new());
    for triangle in list {
        let turns = [0, 1, 2].map(|k| [triangle[k], triangle[(k + 1) % 3], triangle[(k + 2) % 3]]);
        let edge = turns.iter().find_map(|corners| {
            let age = memory.edges.iter().position(|edge| *edge == [corners[0], corners[1]])?;
            (age < 15).then_some((*corners, age))
        });
        let (corners, code) = match edge {
            Some((corners, age)) if random.below(5) > 0 => {
                (corners, memory.on_edge(corners, age, version, random))
            }
            _ => {
                let corners = turns.into_iter().find(|corners| corners[0] == memory.next);
                let corners = corners.unwrap_or(turns[random.below(3)]);
                (corners, memory.alone(corners, random))
            }
        };
        codes.push(code);
        turned.extend(corners);
    }
    memory.table.resize(16, 0);
    let stream = [&[0xE0 | version][..], &codes, &memory.data, &memory.table].concat();
    (PackedRows::new("TRIANGLES", stride, 3 * list.len(), stream), turned)
}
