//! Tiles of 3D Tiles 1.0: a GLB after a header and tables, an instanced GLB, or several tiles in one file.
use super::merge::{SceneMerge, for_content, moved_by};
use crate::grow::push_large;
use crate::text::grouped;
use crate::{Content, FileLocation, Limits, Node, ReadError, ReadOutcome, Scene, glb};
use serde_json::Value;

/// The bytes of the headers. Defined: magic, version and length, then the lengths of four tables; for
/// instanced tiles also the kind of their glTF; for composites, the number of tiles.
const BATCHED_HEADER: usize = 28;
const INSTANCED_HEADER: usize = 32;
const COMPOSITE_HEADER: usize = 16;

/// The deepest nesting of composites. Chosen: larger values take more of the call stack.
const MOST_NESTED: usize = 8;

/// Whether the content is one of these tiles.
pub(crate) fn looks_like(bytes: &[u8]) -> bool {
    [b"b3dm", b"i3dm", b"cmpt"].iter().any(|magic| bytes.starts_with(*magic))
}

/// Reads a `.b3dm`, an `.i3dm` or a `.cmpt`: its GLB, moved to its centre, once for each instance, and all
/// tiles of a composite. y is up, as in the GLB. Data of features is skipped.
///
/// # Errors
/// [`ReadError`] at the byte of the tile, or as for [`glb::read`]; `unsupported` for references to an
/// external glTF, instances oriented by the globe, and other tiles in a composite.
///
/// Source: Cesium and OGC, *3D Tiles Specification 1.0*, 18-053r2, 2019.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    if bytes.starts_with(b"cmpt") {
        let mut merge = SceneMerge::default();
        composite(bytes, 0, (limits, MOST_NESTED), &mut merge)?;
        return merge.finish();
    }
    single(bytes, 0, limits)
}

fn error(code: &'static str, at: u64, message: impl Into<String>) -> ReadError {
    ReadError::new(code, FileLocation::Byte(at), message.into())
}

fn word(bytes: &[u8], at: usize) -> Option<usize> {
    let four: [u8; 4] = bytes.get(at..at.checked_add(4)?)?.try_into().ok()?;
    usize::try_from(u32::from_le_bytes(four)).ok()
}

/// The bytes of a tile, as many as its header declares; `start` is its offset in the file.
fn tile_bytes(bytes: &[u8], start: u64, header: usize) -> Result<&[u8], ReadError> {
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return Err(error("truncated", start + bytes.len() as u64, "the header of the tile is cut off"));
    };
    if version != 1 {
        return Err(error(
            "unsupported",
            start + 4,
            format!("version {version} of the tile is not read, only 1"),
        ));
    }
    if length < header {
        return Err(error(
            "bad-header",
            start + 8,
            format!("the tile says {length} bytes, its header takes {header}"),
        ));
    }
    bytes.get(..length).ok_or_else(|| {
        let message = format!(
            "the tile says {} bytes, and {} are there",
            grouped(length as u64),
            grouped(bytes.len() as u64)
        );
        error("truncated", start + 8, message)
    })
}

fn composite(
    bytes: &[u8],
    start: u64,
    (limits, nested): (&Limits, usize),
    merge: &mut SceneMerge,
) -> Result<(), ReadError> {
    let bytes = tile_bytes(bytes, start, COMPOSITE_HEADER)?;
    let n_tiles = word(bytes, 12).unwrap_or(0);
    if nested == 0 {
        return Err(error(
            "too-deep",
            start,
            format!("composites in composites, more than {MOST_NESTED} deep"),
        ));
    }
    let mut at = COMPOSITE_HEADER;
    for _ in 0..n_tiles {
        let inner = &bytes[at..];
        let place = start + at as u64;
        let inner = tile_bytes(inner, place, COMPOSITE_HEADER)?;
        // At least the length of a header, so the loop goes on, and never beyond `bytes`.
        at += inner.len();
        if inner.starts_with(b"cmpt") {
            composite(inner, place, (limits, nested - 1), merge)?;
        } else if looks_like(inner) {
            merge.add(single(inner, place, limits)?, &crate::matrix::IDENTITY)?;
        } else {
            let name = crate::text::show(&inner[..4]);
            return Err(error("unsupported", place, format!("a tile {name} in a composite is not read")));
        }
    }
    Ok(())
}

/// A tile with one GLB.
fn single(bytes: &[u8], start: u64, limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let is_instanced = bytes.starts_with(b"i3dm");
    let header = if is_instanced { INSTANCED_HEADER } else { BATCHED_HEADER };
    let bytes = tile_bytes(bytes, start, header)?;
    let tables = FeatureTable::read(bytes, start, header, limits)?;
    if is_instanced && word(bytes, 28) != Some(1) {
        return Err(error("unsupported", start + 28, "the tile names a glTF elsewhere, which is not read"));
    }
    let model = bytes.get(tables.end..).unwrap_or(&[]);
    let mut read = glb::read(model, limits).map_err(|error| match error.place {
        FileLocation::Byte(at) => {
            ReadError { place: FileLocation::Byte(start + tables.end as u64 + at), ..error }
        }
        _ => error,
    })?;
    let Content::Scene(scene) = &mut read.content else { return Ok(read) };
    let center = tables.center()?;
    let mut places = if is_instanced { tables.instances(limits)? } else { vec![crate::matrix::IDENTITY] };
    for place in &mut places {
        (0..3).for_each(|k| place[12 + k] += center[k]);
    }
    if is_instanced || center != [0.0; 3] {
        place_at(scene, &places, limits, start)?;
    }
    Ok(read)
}

/// Shows all nodes once at each place. A node has only one parent, so each place but the first gets its own
/// copies.
fn place_at(scene: &mut Scene, places: &[[f64; 16]], limits: &Limits, start: u64) -> Result<(), ReadError> {
    let (n, roots) = (scene.nodes.len(), std::mem::take(&mut scene.roots));
    let n_all = (n as u64 + 1).saturating_mul(places.len() as u64);
    if n_all > limits.rows {
        return Err(crate::assemble::too_many_rows(FileLocation::Byte(start), "nodes", n_all, limits.rows));
    }
    for (i, place) in places.iter().enumerate() {
        let shift = if i == 0 { 0 } else { scene.nodes.len() };
        for k in 0..if i == 0 { 0 } else { n } {
            let mut copy = scene.nodes[k].clone();
            copy.children.iter_mut().for_each(|child| *child += shift);
            push_large(&mut scene.nodes, copy)?;
        }
        let children = roots.iter().map(|root| root + shift).collect();
        crate::grow::push(&mut scene.roots, scene.nodes.len())?;
        let matrix = for_content(place).into();
        push_large(&mut scene.nodes, Node { matrix, children, ..Node::default() })?;
    }
    Ok(())
}

/// The feature table of a tile.
struct FeatureTable<'a> {
    json: Value,
    binary: &'a [u8],
    /// The offset of the table in the file.
    at: u64,
    /// The offset in the tile at which the tables end.
    end: usize,
}

impl<'a> FeatureTable<'a> {
    fn read(bytes: &'a [u8], start: u64, header: usize, limits: &Limits) -> Result<Self, ReadError> {
        let lengths = [12, 16, 20, 24].map(|at| word(bytes, at).unwrap_or(0));
        let mut ends = [header; 5];
        for (i, length) in lengths.into_iter().enumerate() {
            let end = ends[i].checked_add(length).filter(|end| *end <= bytes.len());
            ends[i + 1] = end.ok_or_else(|| {
                let message =
                    format!("a table of {} bytes does not fit into the tile", grouped(length as u64));
                error("truncated", start + 12 + 4 * i as u64, message)
            })?;
        }
        let at = start + header as u64;
        let text = &bytes[ends[0]..ends[1]];
        let json = if text.iter().all(|b| crate::text::is_space(*b) || *b == 0) {
            Value::Null
        } else {
            // Nesting is limited by serde_json to 128, even if the limits allow more.
            let _ = limits;
            serde_json::from_slice(text)
                .map_err(|why| error("bad-json", at, format!("the feature table: {why}")))?
        };
        Ok(Self { json, binary: &bytes[ends[1]..ends[2]], at, end: ends[4] })
    }

    fn wrong(&self, key: &str, what: &str) -> ReadError {
        error("bad-header", self.at, format!("{key} of the feature table {what}"))
    }

    /// The centre that positions are relative to, in the space of tiles.
    fn center(&self) -> Result<[f64; 3], ReadError> {
        match self.json.get("RTC_CENTER") {
            None => Ok([0.0; 3]),
            Some(Value::Array(list)) if list.len() == 3 => {
                let numbers: Vec<f64> =
                    list.iter().filter_map(Value::as_f64).filter(|x| x.is_finite()).collect();
                numbers.try_into().map_err(|_| self.wrong("RTC_CENTER", "is not three numbers"))
            }
            Some(_) => Err(self.wrong("RTC_CENTER", "is not three numbers")),
        }
    }

    /// The rows of a list in the binary part, of `width` single-precision numbers each.
    fn rows(&self, key: &str, n: usize, width: usize) -> Result<Option<Vec<f64>>, ReadError> {
        let Some(property) = self.json.get(key) else { return Ok(None) };
        let offset =
            property.get("byteOffset").and_then(Value::as_u64).and_then(|at| usize::try_from(at).ok());
        let offset = offset.ok_or_else(|| self.wrong(key, "has no byteOffset"))?;
        let length = n.checked_mul(4 * width);
        let end = length.and_then(|length| offset.checked_add(length));
        let bytes = end.and_then(|end| self.binary.get(offset..end));
        let bytes = bytes.ok_or_else(|| self.wrong(key, "is cut off"))?;
        let mut values = crate::grow::with_room(n * width)?;
        values.extend(bytes.as_chunks::<4>().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))));
        if values.iter().all(|x: &f64| x.is_finite()) {
            Ok(Some(values))
        } else {
            Err(self.wrong(key, "is not finite"))
        }
    }

    /// The transforms of the instances, in the space of tiles.
    fn instances(&self, limits: &Limits) -> Result<Vec<[f64; 16]>, ReadError> {
        let n = self.json.get("INSTANCES_LENGTH").and_then(Value::as_u64);
        let n = n.ok_or_else(|| self.wrong("INSTANCES_LENGTH", "is missing"))?;
        if n > limits.rows {
            return Err(crate::assemble::too_many_rows(
                FileLocation::Byte(self.at),
                "instances",
                n,
                limits.rows,
            ));
        }
        let n = usize::try_from(n).unwrap_or(usize::MAX);
        for key in ["POSITION_QUANTIZED", "NORMAL_UP_OCT32P", "NORMAL_RIGHT_OCT32P"] {
            if self.json.get(key).is_some() {
                return Err(error("unsupported", self.at, format!("instances by {key} are not read")));
            }
        }
        if self.json.get("EAST_NORTH_UP").and_then(Value::as_bool) == Some(true) {
            return Err(error(
                "unsupported",
                self.at,
                "instances that the globe turns (EAST_NORTH_UP) are not read",
            ));
        }
        let positions = self.rows("POSITION", n, 3)?.ok_or_else(|| self.wrong("POSITION", "is missing"))?;
        let ups = self.rows("NORMAL_UP", n, 3)?;
        let rights = self.rows("NORMAL_RIGHT", n, 3)?;
        let scales = self.rows("SCALE", n, 1)?;
        let stretches = self.rows("SCALE_NON_UNIFORM", n, 3)?;
        let mut matrices = crate::grow::with_room(n)?;
        for i in 0..n {
            let row = |list: &[f64]| [list[3 * i], list[3 * i + 1], list[3 * i + 2]];
            let mut matrix = moved_by(row(&positions));
            if let (Some(ups), Some(rights)) = (&ups, &rights) {
                let (right, up) = (row(rights), row(ups));
                // The axes are right, up, and forward, which is right × up.
                let axes = [right, up, crate::matrix::cross(right, up)];
                (0..9).for_each(|k| matrix[4 * (k / 3) + k % 3] = axes[k / 3][k % 3]);
            }
            let uniform = scales.as_ref().map_or(1.0, |list| list[i]);
            let stretch = stretches.as_ref().map_or([1.0; 3], |list| row(list));
            for (column, stretch) in stretch.into_iter().enumerate() {
                (0..3).for_each(|k| matrix[4 * column + k] *= uniform * stretch);
            }
            matrices.push(matrix);
        }
        Ok(matrices)
    }
}
