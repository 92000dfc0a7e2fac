//! `ZipUnpacker`: the unpacked bytes of an entry; limits are checked during decompression.
use super::directory::{LOCAL, ZipEntry, number};
use crate::grow::push_many;
use crate::text::{grouped, show};
use crate::unpack_cap::UnpackCap;
use crate::{FileLocation, Limits, ReadError};
use flate2::Crc;
use flate2::read::DeflateDecoder;
use std::io::{ErrorKind, Read};

/// The bytes of a local header before the name.
const LOCAL_BYTES: usize = 30;
/// The bytes that are unpacked between two checks of the limits.
const STEP: usize = 1 << 16;

/// Unpacks entries of one file, and counts their bytes.
pub(crate) struct ZipUnpacker<'a> {
    bytes: &'a [u8],
    /// The number of bytes that may still be unpacked.
    left: u64,
    most: u64,
    cap: UnpackCap,
}

impl<'a> ZipUnpacker<'a> {
    pub(crate) fn new(bytes: &'a [u8], cap: UnpackCap, limits: &Limits) -> Self {
        Self { bytes, left: cap.total.min(limits.bytes), most: cap.entry.min(limits.bytes), cap }
    }

    /// Up to `most` bytes from the start of an entry, as far as they can be unpacked.
    pub(crate) fn head(&self, entry: &ZipEntry, most: usize) -> Vec<u8> {
        let Ok((packed, _)) = self.packed(entry) else { return Vec::new() };
        let source: Box<dyn Read> = match entry.method {
            0 if !entry.is_encrypted => Box::new(packed),
            8 if !entry.is_encrypted => Box::new(DeflateDecoder::new(packed)),
            _ => return Vec::new(),
        };
        let mut head = Vec::new();
        // The bytes before an error are also used.
        let _ = source.take(most as u64).read_to_end(&mut head);
        head
    }

    /// The content of an entry.
    ///
    /// # Errors
    /// If it is truncated, damaged, encrypted or compressed by another method than deflate; if its size or
    /// checksum differs from the directory; if it exceeds a limit.
    pub(crate) fn unpack(&mut self, entry: &ZipEntry) -> Result<Vec<u8>, ReadError> {
        let (packed, at) = self.packed(entry)?;
        let refuse = |code, what: String| {
            let message = format!("the package's entry {} {what}", show(entry.name.as_bytes()));
            ReadError::new(code, FileLocation::Byte(at), message)
        };
        if entry.is_encrypted {
            return Err(refuse("encrypted", "is encrypted".to_owned()));
        }
        let mut inflater: Box<dyn Read> = match entry.method {
            0 => Box::new(packed),
            8 => Box::new(DeflateDecoder::new(packed)),
            other => {
                let what = format!("is packed by method {other}; 0 (stored) and 8 (deflated) are read");
                return Err(refuse("unsupported-packing", what));
            }
        };
        let (cap, n_packed) = (self.cap, packed.len() as u64);
        let check = |size: u64| {
            let over = |limit: u64, what: &str| {
                let message = format!("unpacks to more than {} bytes, {what}", grouped(limit));
                Err(refuse("too-large", message))
            };
            if size > self.most {
                return over(self.most, "the limit of one entry");
            }
            if size > self.left {
                return over(self.left, "which is what the limit of the whole package leaves");
            }
            if cap.is_too_dense(size, n_packed) {
                return Err(refuse("too-dense", cap.too_dense(n_packed)));
            }
            Ok(())
        };
        // The declared size may be wrong, so it is checked here, and the real one at every step.
        check(entry.n_unpacked)?;
        let (mut content, mut crc) = (Vec::new(), Crc::new());
        let mut step = vec![0; STEP];
        loop {
            let n = match inflater.read(&mut step) {
                Ok(0) => break,
                Ok(n) => n,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => return Err(refuse("bad-deflate", format!("is damaged: {error}"))),
            };
            let start = content.len();
            check((start + n) as u64)?;
            push_many(&mut content, 0, n)?;
            content[start..].copy_from_slice(&step[..n]);
            crc.update(&step[..n]);
        }
        if content.len() as u64 != entry.n_unpacked {
            let what = format!(
                "unpacks to {} bytes, where the directory says {}",
                grouped(content.len() as u64),
                grouped(entry.n_unpacked)
            );
            return Err(refuse("size-mismatch", what));
        }
        if crc.sum() != entry.crc {
            let what =
                format!("has the checksum {:08x}, where the directory says {:08x}", crc.sum(), entry.crc);
            return Err(refuse("bad-checksum", what));
        }
        self.left -= content.len() as u64;
        Ok(content)
    }

    /// The packed bytes, and the offset where they start.
    fn packed(&self, entry: &ZipEntry) -> Result<(&'a [u8], u64), ReadError> {
        let locate = || {
            let local = usize::try_from(entry.at).ok()?;
            let header = self.bytes.get(local..local.checked_add(LOCAL_BYTES)?)?;
            let (n_name, n_extra) = (number::<2>(header, 26)? as usize, number::<2>(header, 28)? as usize);
            let name = self.bytes.get(local + LOCAL_BYTES..local + LOCAL_BYTES + n_name)?;
            let is_same = header.starts_with(LOCAL) && String::from_utf8_lossy(name) == entry.name;
            let start = local + LOCAL_BYTES + n_name + n_extra;
            let end = start.checked_add(usize::try_from(entry.n_packed).ok()?)?;
            is_same.then_some((self.bytes.get(start..end)?, start as u64))
        };
        locate().ok_or_else(|| {
            let message = format!(
                "the package's entry {} is cut off, or is not where the directory says",
                show(entry.name.as_bytes())
            );
            ReadError::new("truncated", FileLocation::Byte(entry.at), message)
        })
    }
}
