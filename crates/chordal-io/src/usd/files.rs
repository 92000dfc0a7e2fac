//! `UsdFiles`: the other files of a shape in USD: those of its package, or those beside it.
use crate::files::{FileOpener, UriError, resolve_path};
use crate::unpack_cap::UnpackCap;
use crate::zip::directory::{LOCAL, ZipDirectory, ZipNames};
use crate::zip::unpack::ZipUnpacker;
use crate::{FileLocation, Limits, ReadError};

/// The source of other files.
pub(super) struct UsdFiles<'a, 'b> {
    package: Option<UsdPackage<'a>>,
    open: Option<&'a mut FileOpener<'b>>,
    /// The number of bytes that may still be read.
    left: u64,
}

/// A package.
struct UsdPackage<'a> {
    directory: ZipDirectory,
    unpacker: ZipUnpacker<'a>,
}

/// A file of a package or folder.
pub(super) struct UsdFile {
    pub path: String,
    pub bytes: Vec<u8>,
}

/// Whether the content is a package whose first file is USD.
pub(crate) fn is_package(bytes: &[u8]) -> bool {
    /// The name of the first file starts at byte 30, its length is at 26 (PKWARE, *APPNOTE* 6.3, 4.3.7).
    const NAME: usize = 30;
    const LENGTH: usize = 26;
    let name = || {
        let length = u16::from_le_bytes([*bytes.get(LENGTH)?, *bytes.get(LENGTH + 1)?]);
        bytes.get(NAME..NAME + usize::from(length))
    };
    bytes.starts_with(LOCAL) && name().is_some_and(is_layer_name)
}

fn is_layer_name(name: &[u8]) -> bool {
    let name = name.to_ascii_lowercase();
    [&b".usd"[..], b".usda", b".usdc"].iter().any(|ending| name.ends_with(ending))
}

impl<'a, 'b> UsdFiles<'a, 'b> {
    /// The files beside one of `n_bytes`.
    pub(super) fn beside(open: Option<&'a mut FileOpener<'b>>, n_bytes: usize, limits: &Limits) -> Self {
        Self { package: None, open, left: limits.bytes.saturating_sub(n_bytes as u64) }
    }

    /// Opens a package and takes its first file, which holds the shape.
    ///
    /// # Errors
    /// If the package is damaged, or holds no USD.
    pub(super) fn package(bytes: &'a [u8], limits: &Limits) -> Result<(Self, UsdFile), ReadError> {
        let directory = ZipDirectory::read(bytes, ZipNames::AnyCase)?;
        let mut unpacker = ZipUnpacker::new(bytes, UnpackCap::MODEL, limits);
        // The first file is the one with the lowest offset, whatever the order of the directory.
        let first = directory.entries.iter().filter(|entry| is_layer_name(entry.name.as_bytes()));
        let Some(first) = first.min_by_key(|entry| entry.at) else {
            let message = "the package holds no file of USD: this is a zip file of another kind";
            return Err(ReadError::new("not-usdz", FileLocation::File, message));
        };
        let file = UsdFile { path: first.name.clone(), bytes: unpacker.unpack(first)? };
        let left = limits.bytes.saturating_sub(bytes.len() as u64);
        Ok((Self { package: Some(UsdPackage { directory, unpacker }), open: None, left }, file))
    }

    /// The path of a file that another one refers to.
    ///
    /// # Errors
    /// Why it is outside.
    pub(super) fn resolve(&self, from: &str, asset: &str) -> Result<String, String> {
        if asset.ends_with(']') {
            return Err("it is in a package in a package".to_owned());
        }
        resolve_path(crate::files::folder(from), asset).map_err(|error: UriError| error.reason().to_owned())
    }

    /// The bytes at such a path.
    ///
    /// # Errors
    /// Why they are not available.
    pub(super) fn read(&mut self, path: &str) -> Result<Vec<u8>, String> {
        let bytes = match (&mut self.package, &mut self.open) {
            (Some(package), _) => {
                let found = package.directory.entries.iter().find(|entry| entry.name == path);
                let entry = found.ok_or("it is not in the package")?;
                package.unpacker.unpack(entry).map_err(|error| error.to_string())?
            }
            (None, Some(open)) => open(path)?,
            (None, None) => return Err("no other files are opened here".to_owned()),
        };
        let left = self.left.checked_sub(bytes.len() as u64);
        self.left = left.ok_or("all files together are over the limit")?;
        Ok(bytes)
    }
}
