//! `ZipDirectory`: the directory of a zip container, with every name checked.
use crate::grow::push_large;
use crate::text::{grouped, show};
use crate::{FileLocation, ReadError};
use std::collections::BTreeSet;

/// The signature of a file in a container, and so of a container that is not empty.
pub(crate) const LOCAL: &[u8; 4] = b"PK\x03\x04";
/// The signature of a row of the directory, and the bytes of a row before the name.
pub(crate) const ROW: &[u8; 4] = b"PK\x01\x02";
const ROW_BYTES: usize = 46;
/// The signature of the end record, and its bytes before the comment.
pub(crate) const END: &[u8; 4] = b"PK\x05\x06";
const END_BYTES: usize = 22;
/// The signatures of the 64-bit end record, and of its locator.
const END_64: &[u8; 4] = b"PK\x06\x06";
const END_64_BYTES: usize = 56;
const LOCATOR_64: &[u8; 4] = b"PK\x06\x07";
const LOCATOR_64_BYTES: usize = 20;
/// The extra field with 64-bit numbers.
const EXTRA_64: u16 = 1;

/// The most entries. Chosen: real packages have tens, those with a part for each of many bodies hundreds.
const MOST_ENTRIES: u64 = 10_000;
/// The mode bits of Unix for the kind of an entry, and their value for a symbolic link.
const MODE_KIND: u32 = 0o170_000;
const MODE_LINK: u32 = 0o120_000;

/// A file in a container, as its directory describes it.
#[derive(Clone, Debug)]
pub(crate) struct ZipEntry {
    pub name: String,
    /// 0 for stored, 8 for deflated.
    pub method: u16,
    pub is_encrypted: bool,
    pub crc: u32,
    pub n_packed: u64,
    pub n_unpacked: u64,
    /// The offset of its local header.
    pub at: u64,
}

/// The files of a container; folders are left out.
#[derive(Clone, Debug)]
pub(crate) struct ZipDirectory {
    pub entries: Vec<ZipEntry>,
}

/// The little-endian number at an offset.
pub(crate) fn number<const N: usize>(bytes: &[u8], at: usize) -> Option<u64> {
    let raw = bytes.get(at..at.checked_add(N)?)?;
    Some(raw.iter().rev().fold(0, |value, byte| value << 8 | u64::from(*byte)))
}

/// How names are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ZipNames {
    /// Ignoring case, as in packages.
    AnyCase,
    /// Exactly.
    Exact,
}

/// The range of the rows.
struct DirectoryRange {
    n_rows: u64,
    start: u64,
    n_bytes: u64,
}

impl ZipDirectory {
    /// Reads the directory at the end of a file.
    ///
    /// # Errors
    /// If there is none, it is truncated, it has too many rows, two names are equal, or one leads out of the
    /// container.
    pub(crate) fn read(bytes: &[u8], same: ZipNames) -> Result<Self, ReadError> {
        let range = directory_range(bytes)?;
        if range.n_rows > MOST_ENTRIES {
            let message = format!(
                "{} entries of the package are over the limit of {}",
                grouped(range.n_rows),
                grouped(MOST_ENTRIES)
            );
            return Err(ReadError::new("too-many-entries", FileLocation::Byte(range.start), message));
        }
        let mut entries = Vec::new();
        let mut names = BTreeSet::new();
        let mut at = range.start as usize;
        let end = (range.start + range.n_bytes) as usize;
        for _ in 0..range.n_rows {
            let row_at = FileLocation::Byte(at as u64);
            let (entry, next) = row(bytes, at, end).ok_or_else(|| {
                ReadError::new(
                    "truncated",
                    row_at.clone(),
                    "the directory of the package is cut off or damaged",
                )
            })?;
            at = next;
            let mode = entry.1;
            let entry = entry.0;
            let refuse = |code, what: &str| {
                Err(ReadError::new(
                    code,
                    row_at.clone(),
                    format!("the package's entry {} {what}", show(entry.name.as_bytes())),
                ))
            };
            if let Some(what) = unsafe_name(&entry.name) {
                return refuse("unsafe-name", what);
            }
            if mode & MODE_KIND == MODE_LINK {
                return refuse("unsafe-name", "is a symbolic link");
            }
            let name = match same {
                ZipNames::AnyCase => entry.name.to_ascii_lowercase(),
                ZipNames::Exact => entry.name.clone(),
            };
            if !names.insert(name) {
                return refuse("duplicate-name", "is there twice");
            }
            if !entry.name.ends_with('/') {
                push_large(&mut entries, entry)?;
            }
        }
        Ok(Self { entries })
    }

    /// The entry with a name, ignoring case.
    pub(crate) fn find(&self, name: &str) -> Option<usize> {
        self.entries.iter().position(|entry| entry.name.eq_ignore_ascii_case(name))
    }
}

/// Finds the end record, and through it the rows.
fn directory_range(bytes: &[u8]) -> Result<DirectoryRange, ReadError> {
    let cut =
        |what: &str| ReadError::new("truncated", FileLocation::Byte(bytes.len() as u64), what.to_owned());
    let end = end_at(bytes)
        .ok_or_else(|| cut("the package has no directory at its end: it is cut off, or no zip file"))?;
    let field = |at: usize, wide: bool| {
        let value = if wide { number::<4>(bytes, end + at) } else { number::<2>(bytes, end + at) };
        value.unwrap_or(0)
    };
    let (disk, start_disk) = (field(4, false), field(6, false));
    let (n_here, n_rows, n_bytes, start) =
        (field(8, false), field(10, false), field(12, true), field(16, true));
    let is_64 = n_rows == 0xFFFF || n_bytes == 0xFFFF_FFFF || start == 0xFFFF_FFFF;
    let range = if is_64 {
        range_64(bytes, end)
            .ok_or_else(|| cut("the package's directory of 64-bit numbers is cut off or damaged"))?
    } else {
        DirectoryRange { n_rows, start, n_bytes }
    };
    let several = !is_64 && (disk != 0 || start_disk != 0 || n_here != n_rows);
    let fits = range.start.checked_add(range.n_bytes).is_some_and(|after| after <= end as u64);
    let holds = range.n_rows.saturating_mul(ROW_BYTES as u64) <= range.n_bytes;
    // More rows than allowed have a separate error.
    if several || !fits || !(holds || range.n_rows > MOST_ENTRIES) {
        return Err(cut("the package's directory is damaged, or on several disks"));
    }
    Ok(range)
}

/// The offset of the end record whose comment extends to the end of the file.
fn end_at(bytes: &[u8]) -> Option<usize> {
    let last = bytes.len().checked_sub(END_BYTES)?;
    // A comment has at most 65,535 bytes.
    let first = last.saturating_sub(0xFFFF);
    (first..=last)
        .rev()
        .find(|at| bytes[*at..].starts_with(END) && number::<2>(bytes, at + 20) == Some((last - at) as u64))
}

fn range_64(bytes: &[u8], end: usize) -> Option<DirectoryRange> {
    let locator = end.checked_sub(LOCATOR_64_BYTES)?;
    if !bytes[locator..].starts_with(LOCATOR_64) {
        return None;
    }
    let at = usize::try_from(number::<8>(bytes, locator + 8)?).ok()?;
    let record = bytes.get(at..at.checked_add(END_64_BYTES)?)?;
    let number = |at: usize| number::<8>(record, at);
    (record.starts_with(END_64)).then_some(())?;
    Some(DirectoryRange { n_rows: number(32)?, n_bytes: number(40)?, start: number(48)? })
}

/// A row with its mode bits, and the offset after it.
fn row(bytes: &[u8], at: usize, end: usize) -> Option<((ZipEntry, u32), usize)> {
    let row = bytes.get(at..end)?;
    if !row.starts_with(ROW) {
        return None;
    }
    let (n_name, n_extra, n_comment) =
        (number::<2>(row, 28)? as usize, number::<2>(row, 30)? as usize, number::<2>(row, 32)? as usize);
    let name = row.get(ROW_BYTES..ROW_BYTES + n_name)?;
    let extra = row.get(ROW_BYTES + n_name..ROW_BYTES + n_name + n_extra)?;
    let n_row = ROW_BYTES + n_name + n_extra + n_comment;
    row.get(..n_row)?;
    let mut sizes = [number::<4>(row, 24)?, number::<4>(row, 20)?, number::<4>(row, 42)?];
    widen(&mut sizes, extra)?;
    let [n_unpacked, n_packed, local] = sizes;
    // The upper byte names the system; on Unix, 3, the upper half of the attributes is a mode.
    let is_unix = number::<2>(row, 4)? >> 8 == 3;
    let mode = if is_unix { (number::<4>(row, 38)? >> 16) as u32 } else { 0 };
    let entry = ZipEntry {
        name: String::from_utf8_lossy(name).into_owned(),
        method: number::<2>(row, 10)? as u16,
        is_encrypted: number::<2>(row, 8)? & 1 == 1,
        crc: number::<4>(row, 16)? as u32,
        n_packed,
        n_unpacked,
        at: local,
    };
    Some(((entry, mode), at + n_row))
}

/// Replaces the numbers that do not fit 32 bits by those of the extra field, which has them in order.
fn widen(sizes: &mut [u64; 3], mut extra: &[u8]) -> Option<()> {
    while extra.len() >= 4 {
        let (id, n) = (number::<2>(extra, 0)?, number::<2>(extra, 2)? as usize);
        let field = extra.get(4..4 + n)?;
        if id == u64::from(EXTRA_64) {
            let mut at = 0;
            for size in sizes.iter_mut().filter(|size| **size == 0xFFFF_FFFF) {
                *size = number::<8>(field, at)?;
                at += 8;
            }
            return Some(());
        }
        extra = &extra[4 + n..];
    }
    Some(())
}

/// Why a name is refused, if it is. Nothing is written to a disk, but a name that would lead out of a folder
/// has no legitimate use.
pub(crate) fn unsafe_name(name: &str) -> Option<&'static str> {
    let path = name.strip_suffix('/').unwrap_or(name);
    if path.is_empty() || path.split('/').any(str::is_empty) {
        return Some("has a name that is absolute or has an empty step");
    }
    if path.split('/').any(|step| step == ".." || step == ".") {
        return Some("has a name that leads to another folder");
    }
    if path.contains('\\') || path.chars().any(char::is_control) || path.as_bytes().get(1) == Some(&b':') {
        return Some("has a name with a backslash, a drive or a control character");
    }
    None
}
