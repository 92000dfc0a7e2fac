//! Subtrees: files of bitstreams with the availability of tiles of an implicit tiling.
use super::content::refuse_gzip;
use super::parse::ImplicitTilingJson;
use super::{ImplicitTiling, Subdivision};
use crate::json::JsonReader;
use crate::{FileLocation, Limits, ReadError};
use std::collections::BTreeSet;

/// The magic number of a subtree file.
const MAGIC: &[u8; 4] = b"subt";

/// The bytes of magic, version, and the lengths of JSON and buffer.
const HEADER: usize = 24;

/// A tile or subtree by its level and its coordinates there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TileCoordinates {
    pub level: u32,
    pub place: [u64; 3],
}

impl TileCoordinates {
    /// Fills the coordinates into a template.
    pub fn uri(self, template: &str) -> String {
        let [x, y, z] = self.place;
        let numbers = [("{level}", u64::from(self.level)), ("{x}", x), ("{y}", y), ("{z}", z)];
        numbers.iter().fold(template.to_owned(), |uri, (name, n)| uri.replace(name, &n.to_string()))
    }

    /// The descendant with Morton index `morton`, `levels` levels down.
    fn descendant(self, levels: u32, morton: u64, subdivision: Subdivision) -> Self {
        let axes = if subdivision == Subdivision::Quadtree { 2 } else { 3 };
        let mut place = self.place.map(|x| x << levels);
        for bit in 0..levels {
            for (k, x) in place.iter_mut().take(axes as usize).enumerate() {
                *x |= (morton >> (axes * bit + k as u32) & 1) << bit;
            }
        }
        Self { level: self.level + levels, place }
    }
}

/// The availability of a list of items.
enum AvailabilityBits<'b> {
    All,
    Nothing,
    Stream(&'b [u8], u64),
}

impl AvailabilityBits<'_> {
    fn get(&self, i: u64) -> bool {
        match self {
            Self::All => true,
            Self::Nothing => false,
            Self::Stream(bytes, n) => {
                let byte = usize::try_from(i / 8).ok().and_then(|at| bytes.get(at));
                i < *n && byte.is_some_and(|byte| byte >> (i % 8) & 1 == 1)
            }
        }
    }

    /// The number of available items among the `many` from `first` on. Takes linear time only for bitstreams.
    fn count(&self, first: u64, many: u64) -> u64 {
        match self {
            Self::All => many,
            Self::Nothing => 0,
            Self::Stream(..) => (first..first + many).filter(|i| self.get(*i)).count() as u64,
        }
    }
}

/// An availability as written, before its bitstream is resolved.
#[derive(Default)]
struct Availability {
    bitstream: Option<u64>,
    constant: Option<u64>,
    count: Option<u64>,
}

#[derive(Clone, Default)]
struct SubtreeBufferView {
    buffer: u64,
    offset: u64,
    length: u64,
}

/// The parsed JSON of a subtree.
#[derive(Default)]
struct Subtree {
    buffers: Vec<(u64, Option<String>)>,
    views: Vec<SubtreeBufferView>,
    tiles: Option<Availability>,
    contents: Vec<Availability>,
    children: Option<Availability>,
}

type SubtreeResult<T> = Result<T, ReadError>;

/// Returns the bytes of a file by the URI in a subtree.
pub(super) type SubtreeFileOpener<'f> = dyn FnMut(&str) -> SubtreeResult<Vec<u8>> + 'f;

/// Reads one subtree, counts its tiles into `tiling`, and returns the subtrees below it. `open` returns other
/// files that it refers to.
///
/// # Errors
/// With the byte or the pointer in this file.
pub(super) fn read(
    bytes: &[u8],
    rule: &ImplicitTilingJson,
    at: TileCoordinates,
    tiling: &mut ImplicitTiling,
    limits: &Limits,
    open: &mut SubtreeFileOpener<'_>,
) -> SubtreeResult<Vec<TileCoordinates>> {
    refuse_gzip(bytes)?;
    let (text, binary) = chunks(bytes)?;
    let subtree = parse(text, limits)?;
    if subtree.contents.len() > MOST_CONTENTS {
        let what = format!("{} contents a tile exceed the limit of {MOST_CONTENTS}", subtree.contents.len());
        return Err(ReadError::new(
            "unsupported",
            FileLocation::Pointer("/contentAvailability".to_owned()),
            what,
        ));
    }
    let buffers = buffers(&subtree, binary, open)?;
    let n = rule.subdivision.n_children();
    let n_last = n.checked_pow(rule.subtree_levels).filter(|_| at.level + rule.subtree_levels <= 64);
    let Some(n_last) = n_last else {
        let what = format!("{} levels in one subtree are more than can be counted", rule.subtree_levels);
        return Err(ReadError::new("unsupported", FileLocation::File, what));
    };
    // Levels follow each other: a quadtree has tile 0, then tiles 1 to 4, then 5 to 20. Their number is the
    // geometric sum 1 + n + n² + …; the level after the last one belongs to the child subtrees.
    let n_tiles = (n_last - 1) / (n - 1);
    let look = |name: &str, availability: &Availability, n: u64| {
        bits(&subtree, &buffers, availability, n)
            .map_err(|(code, what)| ReadError::new(code, FileLocation::Pointer(format!("/{name}")), what))
    };
    let absent =
        |name| ReadError::new("missing", FileLocation::Pointer(format!("/{name}")), "this is not there");
    let tiles = subtree.tiles.as_ref().ok_or_else(|| absent("tileAvailability"))?;
    let tiles = look("tileAvailability", tiles, n_tiles)?;
    if !tiles.get(0) {
        let place = FileLocation::Pointer("/tileAvailability".to_owned());
        return Err(ReadError::new("empty-subtree", place, "the first tile of a subtree has to be there"));
    }
    let contents = subtree.contents.iter().enumerate();
    let contents = contents
        .map(|(i, availability)| look(&format!("contentAvailability/{i}"), availability, n_tiles))
        .collect::<SubtreeResult<Vec<_>>>()?;
    let children = subtree.children.as_ref().ok_or_else(|| absent("childSubtreeAvailability"))?;
    let children = look("childSubtreeAvailability", children, n_last)?;
    check_parents(&tiles, &contents, n)?;
    let mut first = 0;
    for level in 0..rule.subtree_levels {
        // No overflow: `n_last` is greater still.
        let many = n.pow(level);
        let here = tiles.count(first, many);
        let depth = (at.level + level) as usize;
        match tiling.n_tiles.get_mut(depth) {
            Some(n_tiles) => *n_tiles = n_tiles.saturating_add(here),
            None if here == 0 => {}
            None => return Err(too_deep("tileAvailability", rule)),
        }
        if let Some(n_contents) = tiling.n_contents.get_mut(depth) {
            let counts = contents.iter().map(|bits| bits.count(first, many));
            *n_contents = counts.fold(*n_contents, u64::saturating_add);
        }
        first += many;
    }
    tiling.n_subtrees += 1;
    child_subtrees(&children, n_last, rule, at)
}

/// The available subtrees below a subtree: at most as many as its file has bits, or as a constant may
/// declare.
fn child_subtrees(
    children: &AvailabilityBits<'_>,
    n_last: u64,
    rule: &ImplicitTilingJson,
    at: TileCoordinates,
) -> SubtreeResult<Vec<TileCoordinates>> {
    let n_listed = match children {
        AvailabilityBits::Nothing => 0,
        AvailabilityBits::All if n_last > MOST_CONSTANT => {
            let place = FileLocation::Pointer("/childSubtreeAvailability/constant".to_owned());
            let what = format!("{n_last} subtrees below one are more than the limit of {MOST_CONSTANT}");
            return Err(ReadError::new("too-many-rows", place, what));
        }
        AvailabilityBits::All | AvailabilityBits::Stream(..) => n_last,
    };
    let available = (0..n_listed).filter(|i| children.get(*i));
    if at.level + rule.subtree_levels >= rule.available_levels {
        return if available.count() == 0 {
            Ok(Vec::new())
        } else {
            Err(too_deep("childSubtreeAvailability", rule))
        };
    }
    Ok(available.map(|i| at.descendant(rule.subtree_levels, i, rule.subdivision)).collect())
}

/// The most contents of one tile whose bits are read. Chosen: several are rare, and all may share one
/// bitstream.
const MOST_CONTENTS: usize = 16;

/// The most subtrees below one that a constant may declare available. Chosen: eight levels of a quadtree, 2
/// MB of list.
const MOST_CONSTANT: u64 = 1 << 16;

fn too_deep(name: &str, rule: &ImplicitTilingJson) -> ReadError {
    let what = format!("tiles are there below the {} levels that the tileset names", rule.available_levels);
    ReadError::new("beyond-levels", FileLocation::Pointer(format!("/{name}")), what)
}

/// Checks that the parent of each available tile is available, and the tile of each content.
fn check_parents(
    tiles: &AvailabilityBits<'_>,
    contents: &[AvailabilityBits<'_>],
    n: u64,
) -> SubtreeResult<()> {
    let error = |name: String, what| Err(ReadError::new("no-such-tile", FileLocation::Pointer(name), what));
    if let AvailabilityBits::Stream(_, n_tiles) = tiles {
        // Levels are consecutive without gaps, so the children of tile i are n·i + 1 to n·i + n.
        if let Some(i) = (1..*n_tiles).find(|i| tiles.get(*i) && !tiles.get((i - 1) / n)) {
            return error("/tileAvailability".to_owned(), format!("tile {i} is there and its parent is not"));
        }
        for (k, content) in contents.iter().enumerate() {
            if let Some(i) = (0..*n_tiles).find(|i| content.get(*i) && !tiles.get(*i)) {
                return error(
                    format!("/contentAvailability/{k}"),
                    format!("content {i} is there and its tile is not"),
                );
            }
        }
    }
    Ok(())
}

/// Splits a subtree file into its JSON and its buffer.
fn chunks(bytes: &[u8]) -> SubtreeResult<(&[u8], &[u8])> {
    let error =
        |code, at: usize, what: String| Err(ReadError::new(code, FileLocation::Byte(at as u64), what));
    let word = |at: usize| bytes.get(at..at + 8).and_then(|b| b.try_into().ok()).map(u64::from_le_bytes);
    let (Some(json), Some(binary)) = (word(8), word(16)) else {
        return error("truncated", bytes.len(), format!("{} bytes are too few for a subtree", bytes.len()));
    };
    if !bytes.starts_with(MAGIC) {
        return error("bad-magic", 0, "the file does not begin with \"subt\"".to_owned());
    }
    if bytes[4..8] != [1, 0, 0, 0] {
        return error("unsupported", 4, "the version of the subtree is not 1".to_owned());
    }
    let rest = &bytes[HEADER..];
    if json.checked_add(binary) != Some(rest.len() as u64) {
        let what = format!("the header says {json} and {binary} bytes, {} follow", rest.len());
        return error("wrong-length", 8, what);
    }
    // At most the bytes that follow, as was just checked.
    Ok(rest.split_at(json as usize))
}

fn parse(text: &[u8], limits: &Limits) -> SubtreeResult<Subtree> {
    let mut json = JsonReader::new(text, limits)?;
    let mut subtree = Subtree::default();
    json.object(|json, key| {
        match key {
            "buffers" => {
                json.array(|json, _| {
                    let (mut length, mut uri) = (None, None);
                    json.object(|json, key| {
                        match key {
                            "byteLength" => length = Some(integer(json)?),
                            "uri" => uri = Some(json.string()?),
                            _ => json.skip()?,
                        }
                        Ok(())
                    })?;
                    let length =
                        length.ok_or_else(|| json.error("missing", "the buffer has no byteLength"))?;
                    subtree.buffers.push((length, uri));
                    Ok(())
                })?;
            }
            "bufferViews" => {
                json.array(|json, _| {
                    let mut view = SubtreeBufferView::default();
                    json.object(|json, key| {
                        match key {
                            "buffer" => view.buffer = integer(json)?,
                            "byteOffset" => view.offset = integer(json)?,
                            "byteLength" => view.length = integer(json)?,
                            _ => json.skip()?,
                        }
                        Ok(())
                    })?;
                    subtree.views.push(view);
                    Ok(())
                })?;
            }
            "tileAvailability" => subtree.tiles = Some(availability(json)?),
            "contentAvailability" => {
                json.array(|json, _| {
                    subtree.contents.push(availability(json)?);
                    Ok(())
                })?;
            }
            "childSubtreeAvailability" => subtree.children = Some(availability(json)?),
            _ => json.skip()?,
        }
        Ok(())
    })?;
    json.end()?;
    Ok(subtree)
}

/// Reads an integer that counts something.
fn integer(json: &mut JsonReader<'_>) -> SubtreeResult<u64> {
    let number = json.number()?;
    // Below 2⁵³ all integers are exact.
    if number.fract() != 0.0 || !(0.0..9_007_199_254_740_992.0).contains(&number) {
        return Err(json.error("out-of-range", format!("{number} is no count")));
    }
    Ok(number as u64)
}

fn availability(json: &mut JsonReader<'_>) -> SubtreeResult<Availability> {
    let mut availability = Availability::default();
    json.object(|json, key| {
        match key {
            "bitstream" => availability.bitstream = Some(integer(json)?),
            "constant" => availability.constant = Some(integer(json)?),
            "availableCount" => availability.count = Some(integer(json)?),
            _ => json.skip()?,
        }
        Ok(())
    })?;
    if availability.bitstream.is_some() == availability.constant.is_some() {
        return Err(json.error("missing", "either a bitstream or a constant has to stand here"));
    }
    if availability.constant.is_some_and(|constant| constant > 1) {
        return Err(json.error("out-of-range", "the constant is neither 0 nor 1"));
    }
    Ok(availability)
}

/// The bytes of a buffer.
enum SubtreeBuffer<'b> {
    Here(&'b [u8]),
    Elsewhere(Vec<u8>),
    /// It holds no needed data.
    Unused,
}

fn buffers<'b>(
    subtree: &Subtree,
    binary: &'b [u8],
    open: &mut SubtreeFileOpener<'_>,
) -> SubtreeResult<Vec<SubtreeBuffer<'b>>> {
    let streams = subtree.tiles.iter().chain(&subtree.contents).chain(&subtree.children);
    let views = streams.filter_map(|availability| usize::try_from(availability.bitstream?).ok());
    let used: BTreeSet<u64> = views.filter_map(|view| Some(subtree.views.get(view)?.buffer)).collect();
    let mut buffers = Vec::with_capacity(subtree.buffers.len());
    for (i, (length, uri)) in subtree.buffers.iter().enumerate() {
        let pointer = |key: &str| FileLocation::Pointer(format!("/buffers/{i}/{key}"));
        if !used.contains(&(i as u64)) {
            buffers.push(SubtreeBuffer::Unused);
            continue;
        }
        let buffer = match uri {
            Some(uri) => SubtreeBuffer::Elsewhere(
                open(uri).map_err(|error| ReadError { place: pointer("uri"), ..error })?,
            ),
            None if i == 0 => SubtreeBuffer::Here(binary),
            None => {
                return Err(ReadError::new(
                    "missing",
                    pointer("uri"),
                    "only the first buffer is in this file",
                ));
            }
        };
        // The file's own buffer may be padded to a multiple of eight.
        if buffer.bytes().len() as u64 >= *length {
            buffers.push(buffer);
            continue;
        }
        let what = format!("the buffer has {} bytes, not {length}", buffer.bytes().len());
        return Err(ReadError::new("buffer-too-short", pointer("byteLength"), what));
    }
    Ok(buffers)
}

impl SubtreeBuffer<'_> {
    fn bytes(&self) -> &[u8] {
        match self {
            Self::Here(bytes) => bytes,
            Self::Elsewhere(bytes) => bytes,
            Self::Unused => &[],
        }
    }
}

type SubtreeError = (&'static str, String);

/// The bits of an availability of `n` items, checked for their length and for the declared number of ones.
fn bits<'b>(
    subtree: &Subtree,
    buffers: &'b [SubtreeBuffer<'_>],
    availability: &Availability,
    n: u64,
) -> Result<AvailabilityBits<'b>, SubtreeError> {
    let bits = match (availability.constant, availability.bitstream) {
        (Some(1), _) => AvailabilityBits::All,
        (_, None) => AvailabilityBits::Nothing,
        (_, Some(view)) => stream(subtree, buffers, view, n)?,
    };
    let n_there = bits.count(0, n);
    match availability.count {
        Some(declared) if declared != n_there => {
            Err(("wrong-count", format!("availableCount is {declared}, and {n_there} of {n} bits are set")))
        }
        _ => Ok(bits),
    }
}

fn stream<'b>(
    subtree: &Subtree,
    buffers: &'b [SubtreeBuffer<'_>],
    view_idx: u64,
    n: u64,
) -> Result<AvailabilityBits<'b>, SubtreeError> {
    let view = usize::try_from(view_idx).ok().and_then(|i| subtree.views.get(i));
    let Some(view) = view else {
        return Err(("no-such-view", format!("there is no buffer view {view_idx}")));
    };
    if view.length != n.div_ceil(8) {
        let what = format!("{n} bits take {} bytes, the buffer view has {}", n.div_ceil(8), view.length);
        return Err(("wrong-bit-length", what));
    }
    let buffer = usize::try_from(view.buffer).ok();
    let buffer = buffer.and_then(|i| Some((buffers.get(i)?.bytes(), subtree.buffers.get(i)?.0)));
    let Some((bytes, length)) = buffer else {
        return Err(("no-such-buffer", format!("there is no buffer {}", view.buffer)));
    };
    let end = view.offset.checked_add(view.length).filter(|end| *end <= length);
    // Both ends are inside a buffer that is in memory.
    match end.and_then(|end| bytes.get(view.offset as usize..end as usize)) {
        Some(bytes) => Ok(AvailabilityBits::Stream(bytes, n)),
        None => Err(("view-too-long", format!("buffer view {view_idx} exceeds the buffer's {length} bytes"))),
    }
}
