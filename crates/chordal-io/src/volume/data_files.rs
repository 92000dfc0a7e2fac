//! `DataFiles`: the files beside a header that hold its samples.
use crate::files::{self, FileOpener};
use crate::text::{grouped, show};
use crate::{FileLocation, ReadError};

/// Opens files beside a header, and counts their bytes.
pub(crate) struct DataFiles<'a, 'b> {
    open: Option<&'a mut FileOpener<'b>>,
    limit: u64,
    left: u64,
}

impl<'a, 'b> DataFiles<'a, 'b> {
    /// The files of a header of `used` bytes, which together may have `limit` bytes.
    pub(crate) fn new(open: Option<&'a mut FileOpener<'b>>, used: u64, limit: u64) -> Self {
        Self { open, limit, left: limit.saturating_sub(used) }
    }

    /// The bytes of the file that the header refers to by `name` at `place`.
    ///
    /// # Errors
    /// If it is outside the folder of the header, cannot be read, or all files together are too large.
    pub(crate) fn fetch(&mut self, name: &str, place: &FileLocation) -> Result<Vec<u8>, ReadError> {
        let shown = show(name.as_bytes());
        let refused =
            |code, what: &str| ReadError::new(code, place.clone(), format!("the data file {shown} {what}"));
        let path = files::resolve_path("", name).map_err(|error| refused(error.code(), error.reason()))?;
        let Some(open) = &mut self.open else {
            return Err(refused("detached", "is not at hand: only the header was given"));
        };
        let bytes = open(&path).map_err(|why| refused("missing-file", &format!("cannot be read: {why}")))?;
        self.left = self.left.checked_sub(bytes.len() as u64).ok_or_else(|| {
            let what = format!("makes the files larger than the limit of {} bytes", grouped(self.limit));
            refused("too-large", &what)
        })?;
        Ok(bytes)
    }
}
