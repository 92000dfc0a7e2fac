//! The index codecs: triangles by recent edges and vertices, and plain lists of indices.
use super::packed_bytes::{PackedBytes, split};
use super::recent_items::RecentItems;

/// The length of the code table at the end of a list of triangles: defined by the format.
pub(super) const TABLE: usize = 16;
/// The reserved bytes at the end of a list of indices: defined by the format.
const SEQUENCE_TAIL: usize = 4;

/// Writes indices of 2 or 4 bytes.
struct IndexSink<'a> {
    out: std::slice::ChunksExactMut<'a, u8>,
}

impl<'a> IndexSink<'a> {
    fn new(out: &'a mut [u8], stride: usize) -> Self {
        Self { out: out.chunks_exact_mut(stride) }
    }

    fn push(&mut self, index: u32) -> Result<(), String> {
        let Some(place) = self.out.next() else { return Ok(()) };
        let bytes = index.to_le_bytes();
        let (kept, cut) = bytes.split_at(place.len());
        if cut.iter().any(|byte| *byte != 0) {
            return Err(format!("index {index} does not fit into {} bytes", place.len()));
        }
        place.copy_from_slice(kept);
        Ok(())
    }
}

/// The state of a decoder of triangles.
struct TriangleDecoder<'a> {
    data: PackedBytes<'a>,
    /// The lowest index that has not occurred yet.
    next: u32,
    /// The last index that was stored in full.
    last: u32,
    edges: RecentItems<[u32; 2]>,
    vertices: RecentItems<u32>,
}

impl TriangleDecoder<'_> {
    fn next(&mut self) -> u32 {
        let next = self.next;
        self.next = next.wrapping_add(1);
        next
    }

    /// An index stored as its difference to the last stored one.
    fn stored(&mut self) -> Result<u32, String> {
        self.last = self.last.wrapping_add(unzigzag(self.data.leb128()?));
        Ok(self.last)
    }

    /// A triangle on a recent edge: `edge` is its age, `code` encodes the third corner.
    fn on_edge(&mut self, version: u8, edge: u8, code: u8) -> Result<[u32; 3], String> {
        let [a, b] = recent(self.edges.get(edge))?;
        // Version 1 has two more codes, for the neighbours of the last stored index.
        let c = match code {
            0 => self.next(),
            15 => self.stored()?,
            13 | 14 if version > 0 => {
                self.last = if code == 13 { self.last.wrapping_sub(1) } else { self.last.wrapping_add(1) };
                self.last
            }
            age => {
                let c = recent(self.vertices.get(age))?;
                self.push_edges([[c, b], [a, c]]);
                return Ok([a, b, c]);
            }
        };
        self.vertices.push(c);
        // In the direction in which the neighbours across these edges run.
        self.push_edges([[c, b], [a, c]]);
        Ok([a, b, c])
    }

    /// A triangle without a recent edge: `code` has four bits for each of the last two corners.
    fn alone(&mut self, a: u32, code: u8) -> Result<[u32; 3], String> {
        let mut corners = [a; 3];
        // A corner refers only to vertices that occurred before this triangle.
        let mut is_new = [true; 3];
        for (k, kind) in [(1, code >> 4), (2, code & 15)] {
            corners[k] = match kind {
                0 => self.next(),
                15 => self.stored()?,
                age => {
                    is_new[k] = false;
                    recent(self.vertices.get(age - 1))?
                }
            };
        }
        let [a, b, c] = corners;
        corners.iter().zip(is_new).filter(|(_, new)| *new).for_each(|(v, _)| self.vertices.push(*v));
        self.push_edges([[b, a], [c, b], [a, c]]);
        Ok(corners)
    }

    fn push_edges<const N: usize>(&mut self, edges: [[u32; 2]; N]) {
        edges.into_iter().for_each(|edge| self.edges.push(edge));
    }
}

/// The recent item that a triangle refers to; an error if it does not exist.
fn recent<T>(item: Option<T>) -> Result<T, String> {
    item.ok_or_else(|| "a triangle names an edge or a vertex before the first".to_owned())
}

fn unzigzag(x: u32) -> u32 {
    (x >> 1) ^ (x & 1).wrapping_neg()
}

/// Decodes the indices of triangles.
pub(super) fn triangles(stream: &[u8], stride: usize, out: &mut [u8]) -> Result<(), String> {
    let (version, body, table) = split(stream, 0xE0, |_| TABLE)?;
    let is_open = |code: &u8| code >> 4 == 15 || code & 15 == 15;
    if table[TABLE - 2..] != [0, 0] || table.iter().any(is_open) {
        return Err("the table of codes is wrong".to_owned());
    }
    let mut data = PackedBytes(body);
    let codes = data.take(out.len() / stride / 3)?;
    let mut sink = IndexSink::new(out, stride);
    let (edges, vertices) = (RecentItems::new(), RecentItems::new());
    let mut decoder = TriangleDecoder { data, next: 0, last: 0, edges, vertices };
    for code in codes {
        // The codes of a triangle, by their two digits:
        //
        //      0X … EX   a recent edge of this age; X encodes the third corner
        //      F0 … FD   a new vertex; the others as the table says
        //      FE        a new vertex; a code for the others follows
        //      FF        a stored index; a code for the others follows
        let (high, low) = (code >> 4, code & 15);
        let corners = match (high, low) {
            (0..15, _) => decoder.on_edge(version, high, low)?,
            (_, 0..14) => {
                let a = decoder.next();
                decoder.alone(a, table[usize::from(low)])?
            }
            _ => {
                let code = decoder.data.byte()?;
                // Code 0 starts a new mesh.
                if code == 0 {
                    decoder.next = 0;
                }
                let a = if low == 14 { decoder.next() } else { decoder.stored()? };
                decoder.alone(a, code)?
            }
        };
        corners.into_iter().try_for_each(|index| sink.push(index))?;
    }
    decoder.data.end()
}

/// Decodes a list of indices, each stored as its difference to one of two previous ones.
pub(super) fn sequence(stream: &[u8], stride: usize, out: &mut [u8]) -> Result<(), String> {
    let (_, body, _) = split(stream, 0xD0, |_| SEQUENCE_TAIL)?;
    let mut data = PackedBytes(body);
    let count = out.len() / stride;
    let mut sink = IndexSink::new(out, stride);
    let mut last = [0_u32; 2];
    for _ in 0..count {
        let value = data.leb128()?;
        let last = &mut last[(value & 1) as usize];
        *last = last.wrapping_add(unzigzag(value >> 1));
        sink.push(*last)?;
    }
    data.end()
}
