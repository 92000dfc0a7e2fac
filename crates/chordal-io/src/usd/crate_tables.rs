//! `CrateTables`: the tables of USD's binary form: tokens, strings, fields, sets of fields, paths and specs.
//!
//! Source: Pixar's OpenUSD, `pxr/usd/sdf/crateFile`, 2016 to 2024, for the layout.
use super::unpack::{UnpackBudget, integers, packed_size, unpack_chunks};
use crate::grow::{push, with_room};
use crate::text::grouped;
use crate::{FileLocation, Limits, ReadError};

/// The first bytes of the binary form.
pub(super) const USDC_MAGIC: &[u8] = b"PXR-USDC";
/// The newest version of the layout that is supported, and the oldest, which compresses its tables.
const NEWEST: [u8; 2] = [0, 13];
const OLDEST: [u8; 2] = [0, 4];
/// The bytes of an entry in the table of contents: a name, a start and a size.
const SECTION_BYTES: usize = 32;
const SECTION_NAME_BYTES: usize = 16;
/// The most steps of a path. Chosen: twice the depth to which prims are read.
const MOST_STEPS: usize = 256;
/// The most sections. Chosen: six are known.
const MOST_SECTIONS: u64 = 64;

/// The tables. Their indices are checked when they are used.
#[derive(Debug)]
pub(super) struct CrateTables {
    /// The minor number of the version.
    pub version: u8,
    pub tokens: Vec<Box<str>>,
    /// Indices of tokens.
    pub strings: Vec<u32>,
    pub fields: Vec<CrateField>,
    /// Indices of fields; each set ends with an index out of range.
    pub field_sets: Vec<u32>,
    pub paths: Vec<CratePath>,
    pub specs: Vec<CrateSpec>,
    pub budget: UnpackBudget,
}

/// A field: a name with a value.
#[derive(Clone, Copy, Debug)]
pub(super) struct CrateField {
    pub token: u32,
    pub value: u64,
}

/// A path, given by its last step.
#[derive(Clone, Copy, Debug)]
pub(super) struct CratePath {
    pub parent: u32,
    pub token: u32,
    pub is_property: bool,
    pub is_known: bool,
}

/// A spec: an object at a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct CrateSpec {
    pub path: u32,
    pub field_set: u32,
    pub kind: u32,
}

/// The bytes of a file, and the current position.
pub(super) struct CrateCursor<'a> {
    pub bytes: &'a [u8],
    pub at: usize,
}

impl<'a> CrateCursor<'a> {
    /// A cursor at an offset given in the file.
    pub(super) fn at(bytes: &'a [u8], at: u64) -> Self {
        Self { bytes, at: usize::try_from(at).unwrap_or(usize::MAX).min(bytes.len()) }
    }

    pub(super) fn error(&self, code: &'static str, message: impl Into<String>) -> ReadError {
        ReadError::new(code, FileLocation::Byte(self.at as u64), message.into())
    }

    pub(super) fn take(&mut self, n: usize) -> Result<&'a [u8], ReadError> {
        let end = self.at.checked_add(n).filter(|end| *end <= self.bytes.len());
        let Some(end) = end else {
            let left = self.bytes.len().saturating_sub(self.at);
            let message =
                format!("{} bytes are needed, and {} are left", grouped(n as u64), grouped(left as u64));
            return Err(self.error("truncated", message));
        };
        let bytes = &self.bytes[self.at..end];
        self.at = end;
        Ok(bytes)
    }

    pub(super) fn u64(&mut self) -> Result<u64, ReadError> {
        let raw = self.take(8)?;
        Ok(raw.iter().rev().fold(0, |value, byte| value << 8 | u64::from(*byte)))
    }

    pub(super) fn u32(&mut self) -> Result<u32, ReadError> {
        let raw = self.take(4)?;
        Ok(raw.iter().rev().fold(0, |value, byte| value << 8 | u32::from(*byte)))
    }

    pub(super) fn u8(&mut self) -> Result<u8, ReadError> {
        Ok(self.take(1)?[0])
    }

    /// A number of items that take at least `least` of the remaining bytes each.
    pub(super) fn count(&mut self, least: usize) -> Result<usize, ReadError> {
        let n = self.u64()?;
        let left = self.bytes.len().saturating_sub(self.at);
        match usize::try_from(n).ok().filter(|n| n.checked_mul(least).is_some_and(|size| size <= left)) {
            Some(n) => Ok(n),
            None => {
                let message =
                    format!("{} entries are said to be in {} bytes", grouped(n), grouped(left as u64));
                Err(self.error("truncated", message))
            }
        }
    }

    /// LZ4 data after its packed size.
    pub(super) fn packed(&mut self, n: usize, budget: &UnpackBudget) -> Result<Vec<u8>, ReadError> {
        let at = self.at;
        let size = self.count(1)?;
        let packed = self.take(size)?;
        // A byte of LZ4 unpacks to at most 255, so more than that is impossible.
        let n = n.min(packed.len().saturating_mul(255));
        budget.take(n as u64, at)?;
        let broken = || ReadError::new("bad-lz4", FileLocation::Byte(at as u64), "packed bytes are damaged");
        unpack_chunks(packed, n)?.ok_or_else(broken)
    }

    /// Compressed integers of W bytes.
    pub(super) fn integers<const W: usize>(
        &mut self,
        n: usize,
        budget: &UnpackBudget,
    ) -> Result<Vec<i64>, ReadError> {
        let at = self.at;
        let broken = |what: &str| {
            let message = format!("{} packed integers {what}", grouped(n as u64));
            ReadError::new("bad-integers", FileLocation::Byte(at as u64), message)
        };
        let size = packed_size::<W>(n).ok_or_else(|| broken("are too many"))?;
        let bytes = self.packed(size, budget)?;
        // Each integer has a code of two bits, even if nothing else.
        if bytes.len() < n.div_ceil(4) {
            return Err(broken("are said to be where there are fewer"));
        }
        // Eight bytes each.
        budget.take(8 * n as u64, at)?;
        integers::<W>(&bytes, n)?.ok_or_else(|| broken("are damaged"))
    }
}

impl CrateTables {
    /// Reads the tables of a file.
    ///
    /// # Errors
    /// At the byte where the file has another version, is truncated or damaged.
    pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Self, ReadError> {
        let mut cursor = CrateCursor { bytes, at: 0 };
        if cursor.take(USDC_MAGIC.len()).ok() != Some(USDC_MAGIC) {
            return Err(cursor.error("not-usd", "the file does not begin with PXR-USDC"));
        }
        let version = cursor.take(8)?;
        let version = [version[0], version[1]];
        if version < OLDEST || version > NEWEST {
            let message =
                format!("the layout has version {}.{}; 0.4 to 0.13 are read", version[0], version[1]);
            return Err(cursor.error("unknown-version", message));
        }
        let contents = cursor.u64()?;
        cursor = CrateCursor::at(bytes, contents);
        let n = cursor.count(SECTION_BYTES)?;
        if n as u64 > MOST_SECTIONS {
            return Err(
                cursor.error("too-many-rows", format!("{n} sections are over the limit of {MOST_SECTIONS}"))
            );
        }
        let mut sections = Vec::new();
        for _ in 0..n {
            let name = cursor.take(SECTION_NAME_BYTES)?;
            let end = name.iter().position(|b| *b == 0).unwrap_or(name.len());
            // Tables say their own lengths, and every read is checked against the file, so the size
            // is not needed.
            let (start, _size) = (cursor.u64()?, cursor.u64()?);
            sections.push((&name[..end], start));
        }
        let section =
            |name: &str| match sections.iter().find(|(known, _)| *known == name.as_bytes()) {
                Some((_, start)) => Ok(CrateCursor::at(bytes, *start)),
                None => Err(CrateCursor::at(bytes, contents)
                    .error("no-section", format!("there is no section {name}"))),
            };
        let budget = UnpackBudget::new(bytes.len(), limits.bytes);
        let tokens = tokens(section("TOKENS")?, &budget)?;
        let mut tables = Self {
            version: version[1],
            tokens,
            strings: strings(section("STRINGS")?)?,
            fields: fields(section("FIELDS")?, &budget)?,
            field_sets: Vec::new(),
            paths: Vec::new(),
            specs: Vec::new(),
            budget,
        };
        let mut cursor = section("FIELDSETS")?;
        let n = cursor.u64()?;
        let n = checked(n, &cursor)?;
        tables.field_sets = narrow(cursor.integers::<4>(n, &tables.budget)?)?;
        tables.read_paths(section("PATHS")?)?;
        tables.read_specs(section("SPECS")?)?;
        Ok(tables)
    }

    pub(super) fn token(&self, number: u32) -> Option<&str> {
        self.tokens.get(number as usize).map(|token| &**token)
    }

    pub(super) fn string(&self, number: u32) -> Option<&str> {
        self.token(*self.strings.get(number as usize)?)
    }

    /// The fields of a set.
    pub(super) fn fields_of(&self, set: u32) -> impl Iterator<Item = CrateField> {
        let rest = self.field_sets.get(set as usize..).unwrap_or_default();
        rest.iter().map_while(|field| self.fields.get(*field as usize).copied())
    }

    /// The path with an index, as text.
    pub(super) fn path(&self, number: u32) -> Option<String> {
        let mut steps = Vec::new();
        let mut at = number;
        loop {
            let path = self.paths.get(at as usize).filter(|path| path.is_known)?;
            // The root is its own parent.
            if path.parent == at {
                break;
            }
            if steps.len() >= MOST_STEPS {
                return None;
            }
            steps.push(*path);
            at = path.parent;
        }
        let mut text = String::new();
        for step in steps.into_iter().rev() {
            let token = self.token(step.token)?;
            // A variant has its own braces, and is not a step of other paths.
            if !token.starts_with('{') {
                text.push(if step.is_property { '.' } else { '/' });
                text.push_str(token);
            }
        }
        if text.is_empty() {
            text.push('/');
        }
        Some(text)
    }

    /// The paths in the order of the tree: a step each, and the distance to the next sibling.
    fn read_paths(&mut self, mut cursor: CrateCursor<'_>) -> Result<(), ReadError> {
        let start = cursor.at;
        let n_paths = cursor.u64()?;
        let n = cursor.u64()?;
        let (n_paths, n) = (checked(n_paths, &cursor)?, checked(n, &cursor)?);
        let numbers = cursor.integers::<4>(n, &self.budget)?;
        let tokens = cursor.integers::<4>(n, &self.budget)?;
        let jumps = cursor.integers::<4>(n, &self.budget)?;
        let broken = |what: &str| {
            ReadError::new(
                "bad-paths",
                FileLocation::Byte(start as u64),
                format!("the paths are damaged: {what}"),
            )
        };
        // The indices above limit the number of paths, so that a file of few bytes cannot have many.
        if n_paths > n.saturating_mul(2).saturating_add(64) {
            return Err(broken("more are said to be than there are"));
        }
        let unknown = CratePath { parent: 0, token: 0, is_property: false, is_known: false };
        crate::grow::push_many(&mut self.paths, unknown, n_paths)?;
        // The paths /, /A, /A.b and /B:
        //
        //      path   /    A    A.b   B
        //      jump   -1   2    -2    -2
        // Siblings that are still to come, with their parents.
        let mut open: Vec<(usize, u32)> = Vec::new();
        let (mut at, mut parent) = (0, None);
        let mut n_read = 0;
        while at < n {
            if n_read >= n {
                return Err(broken("they turn back"));
            }
            n_read += 1;
            let number = u32::try_from(numbers[at]).ok().filter(|i| (*i as usize) < n_paths);
            let number = number.ok_or_else(|| broken("a number is beyond their table"))?;
            let token = tokens[at];
            let path = CratePath {
                parent: parent.unwrap_or(number),
                token: u32::try_from(token.unsigned_abs()).unwrap_or(u32::MAX),
                is_property: token < 0,
                is_known: true,
            };
            if self.paths[number as usize].is_known || (parent.is_none() && at > 0) {
                return Err(broken("one is there twice"));
            }
            self.paths[number as usize] = path;
            // Above 0: a child follows, and the next sibling is so many entries further. 0: only a sibling
            // follows. -1: only a child follows. -2: neither.
            let jump = jumps[at];
            let (has_child, has_sibling) = (jump > 0 || jump == -1, jump >= 0);
            if has_child {
                if has_sibling {
                    let sibling = at.checked_add(usize::try_from(jump).unwrap_or(usize::MAX));
                    let sibling =
                        sibling.filter(|sibling| *sibling < n).ok_or_else(|| broken("a jump leads out"))?;
                    push(&mut open, (sibling, parent.unwrap_or(number)))?;
                }
                parent = Some(number);
                at += 1;
            } else if has_sibling {
                at += 1;
            } else {
                let Some((sibling, of)) = open.pop() else { break };
                (at, parent) = (sibling, Some(of));
            }
        }
        Ok(())
    }

    fn read_specs(&mut self, mut cursor: CrateCursor<'_>) -> Result<(), ReadError> {
        let n = cursor.u64()?;
        let n = checked(n, &cursor)?;
        let paths = narrow(cursor.integers::<4>(n, &self.budget)?)?;
        let sets = narrow(cursor.integers::<4>(n, &self.budget)?)?;
        let kinds = narrow(cursor.integers::<4>(n, &self.budget)?)?;
        self.specs = with_room(n)?;
        let rows = paths.into_iter().zip(sets).zip(kinds);
        self.specs.extend(rows.map(|((path, field_set), kind)| CrateSpec { path, field_set, kind }));
        Ok(())
    }
}

/// A number of items in the compressed data that follows; unpacking checks it.
fn checked(n: u64, cursor: &CrateCursor<'_>) -> Result<usize, ReadError> {
    let most = u64::from(u32::MAX);
    usize::try_from(n).ok().filter(|_| n < most).ok_or_else(|| {
        let message = format!("{} rows are over the limit of {}", grouped(n), grouped(most));
        cursor.error("too-many-rows", message)
    })
}

/// Unsigned numbers, as they are stored.
fn narrow(wide: Vec<i64>) -> Result<Vec<u32>, ReadError> {
    let mut out = with_room(wide.len())?;
    out.extend(wide.into_iter().map(|x| x as u32));
    Ok(out)
}

/// Zero-terminated words.
fn tokens(mut cursor: CrateCursor<'_>, budget: &UnpackBudget) -> Result<Vec<Box<str>>, ReadError> {
    let at = cursor.at;
    let n = cursor.u64()?;
    let size = cursor.u64()?;
    let size = checked(size, &cursor)?;
    let bytes = cursor.packed(size, budget)?;
    let broken = |what: String| ReadError::new("bad-tokens", FileLocation::Byte(at as u64), what);
    let mut tokens = Vec::new();
    let mut rest = &bytes[..];
    while let Some(end) = memchr::memchr(0, rest) {
        // Each token also takes a pointer of sixteen bytes.
        budget.take(16, at)?;
        let text = std::str::from_utf8(&rest[..end])
            .map_err(|_| broken(format!("token {} is no UTF-8", tokens.len())))?;
        push(&mut tokens, text.into())?;
        rest = &rest[end + 1..];
    }
    if tokens.len() as u64 == n {
        return Ok(tokens);
    }
    Err(broken(format!(
        "{} tokens are there where {} are said to be",
        grouped(tokens.len() as u64),
        grouped(n)
    )))
}

fn strings(mut cursor: CrateCursor<'_>) -> Result<Vec<u32>, ReadError> {
    // Four bytes each.
    let n = cursor.count(4)?;
    let mut strings = with_room(n)?;
    for _ in 0..n {
        strings.push(cursor.u32()?);
    }
    Ok(strings)
}

fn fields(mut cursor: CrateCursor<'_>, budget: &UnpackBudget) -> Result<Vec<CrateField>, ReadError> {
    let n = cursor.u64()?;
    let n = checked(n, &cursor)?;
    let tokens = narrow(cursor.integers::<4>(n, budget)?)?;
    let at = cursor.at;
    // Eight bytes each.
    let values = cursor.packed(8 * n, budget)?;
    if values.len() != 8 * n {
        let message = format!("the values of {} fields are cut off", grouped(n as u64));
        return Err(ReadError::new("truncated", FileLocation::Byte(at as u64), message));
    }
    let mut fields = with_room(n)?;
    for (token, raw) in tokens.into_iter().zip(values.chunks_exact(8)) {
        let value = raw.iter().rev().fold(0, |value, byte| value << 8 | u64::from(*byte));
        fields.push(CrateField { token, value });
    }
    Ok(fields)
}
