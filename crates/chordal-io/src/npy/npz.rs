//! Reads `.npz`, a zip container of `.npy` arrays.
use super::header::NpyHeader;
use crate::text::{grouped, show};
use crate::unpack_cap::UnpackCap;
use crate::warnings::Warnings;
use crate::zip::directory::{LOCAL, ZipDirectory, ZipEntry, ZipNames};
use crate::zip::unpack::ZipUnpacker;
use crate::{Content, FileLocation, Limits, ReadError, ReadOutcome};
use chordal::budget::advice::{Message, Setting};

/// The bytes that are unpacked to read the shape of an array. Chosen: NumPy headers have some hundred bytes.
const HEAD: usize = 4096;
/// The most names that an error lists. Chosen: a longer list makes the message hard to read.
const MOST_NAMED: usize = 12;

/// Reads the volume of a `.npz` file: its only array with three axes, as [`super::read`] does. If there are
/// several, [`Limits::index`] chooses one, in the order of the file. The volume has the array's name.
///
/// # Errors
/// [`ReadError`] if the container is damaged, if no array has three axes, or if several have and none is
/// chosen; the message then lists them.
///
/// Source: NumPy, `numpy.lib.format` and `numpy.savez`, numpy.org; PKWARE, *.ZIP File Format Specification* 6.3.
pub fn read_npz(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let directory = ZipDirectory::read(bytes, ZipNames::Exact)?;
    let mut unpacker = ZipUnpacker::new(bytes, UnpackCap::VOLUME, limits);
    let arrays: Vec<NpzArray<'_>> =
        directory.entries.iter().map(|entry| NpzArray::new(entry, &unpacker, limits)).collect();
    let chosen = choose(&arrays, limits)?;
    let content = unpacker.unpack(chosen.entry)?;
    let array_limits = Limits { index: None, ..*limits };
    let read = super::read::read(&content, &array_limits);
    let mut outcome = read.map_err(|error| error.within(&chosen.entry.name))?;
    if let Content::Volume(volume) = &mut outcome.content {
        volume.name = crate::volume::name_of(chosen.name().as_bytes());
    }
    let mut warnings = Warnings::default();
    let others: Vec<&NpzArray<'_>> =
        arrays.iter().filter(|array| !std::ptr::eq(array.entry, chosen.entry)).collect();
    warnings.count_many("arrays-ignored", others.len() as u64, || {
        let message = format!("other arrays of the file were not read: {}", listed(others.iter().copied()));
        (FileLocation::File, message)
    });
    outcome.warnings.extend(warnings.into_list());
    Ok(outcome)
}

/// Whether the content is a zip file whose first entry is an array.
pub(crate) fn looks_like_npz(bytes: &[u8]) -> bool {
    // The header before the first entry holds the length of the name, and the name.
    let Some(head) = bytes.get(..30).filter(|head| head.starts_with(LOCAL)) else { return false };
    let n_name = usize::from(u16::from_le_bytes([head[26], head[27]]));
    bytes.get(30..30 + n_name).is_some_and(|name| name.ends_with(b".npy"))
}

/// An array in the container.
struct NpzArray<'a> {
    entry: &'a ZipEntry,
    /// Its shape, if it is an array of numbers.
    shape: Option<Vec<i64>>,
}

impl<'a> NpzArray<'a> {
    fn new(entry: &'a ZipEntry, unpacker: &ZipUnpacker<'_>, limits: &Limits) -> Self {
        let header = || NpyHeader::read(&unpacker.head(entry, HEAD), limits).ok();
        let shape = if entry.name.ends_with(".npy") { header().map(|header| header.shape) } else { None };
        Self { entry, shape }
    }

    fn name(&self) -> &'a str {
        self.entry.name.strip_suffix(".npy").unwrap_or(&self.entry.name)
    }

    fn is_volume(&self) -> bool {
        self.shape.as_ref().is_some_and(|shape| shape.len() == 3)
    }

    /// Its name and shape, as in "'a' (2, 3, 4)".
    fn shown(&self) -> String {
        let sizes: Option<Vec<String>> =
            self.shape.as_ref().map(|shape| shape.iter().take(8).map(ToString::to_string).collect());
        let name = show(self.name().as_bytes());
        sizes.map_or_else(|| name.clone(), |sizes| format!("{name} ({})", sizes.join(", ")))
    }
}

fn listed<'a>(arrays: impl ExactSizeIterator<Item = &'a NpzArray<'a>>) -> String {
    let more = arrays.len().saturating_sub(MOST_NAMED);
    let names: Vec<String> = arrays.take(MOST_NAMED).map(NpzArray::shown).collect();
    let end = if more > 0 { format!(" and {} more", grouped(more as u64)) } else { String::new() };
    names.join(", ") + &end
}

fn choose<'a, 'b>(arrays: &'b [NpzArray<'a>], limits: &Limits) -> Result<&'b NpzArray<'a>, ReadError> {
    let volumes: Vec<&NpzArray<'_>> = arrays.iter().filter(|array| array.is_volume()).collect();
    let refused = |code, message: Message| Err(ReadError::new(code, FileLocation::File, message));
    match (limits.index, volumes.as_slice()) {
        (_, []) if arrays.is_empty() => refused("not-3d", "the file holds no arrays".into()),
        (_, []) => {
            let message = format!("no array has three axes, as in a[i, j, k]: {}", listed(arrays.iter()));
            refused("not-3d", message.into())
        }
        (None, [one]) => Ok(one),
        (None, all) => {
            let names = listed(all.iter().copied());
            let message = Message::from(format!("{} arrays have three axes, {names}: ", all.len()))
                .setting(Setting::Index)
                .words(format_args!(" names one, from 0 to {}", all.len() - 1));
            refused("several-volumes", message)
        }
        (Some(index), all) => {
            let one = usize::try_from(index).ok().and_then(|index| all.get(index).copied());
            one.map_or_else(
                || {
                    let names = listed(all.iter().copied());
                    let message = format!("there is no array {index} of three axes, counted from 0: {names}");
                    refused("no-such-volume", message.into())
                },
                Ok,
            )
        }
    }
}
