//! Files beside the input file: resolves relative URIs to paths below its folder, and refuses all other URIs.
use std::borrow::Cow;

/// Returns the bytes of a file, or the reason why it cannot be opened. The path is relative to the folder of
/// the input file and has no `..`, no scheme and no leading `/`. The opener must handle symbolic links that
/// leave the folder.
///
/// A path that begins with `*.` means the file with the same name as the input file and that extension, since
/// readers do not know the name. [`crate::with_stem`] inserts it.
pub type FileOpener<'a> = dyn FnMut(&str) -> Result<Vec<u8>, String> + 'a;

/// The start of a path that means the input file's name with another extension.
pub(crate) const SAME_STEM: &str = "*.";

/// The path for an opener: a leading `*` is replaced by the name of the input file without its extension.
///
/// ```
/// use chordal_io::with_stem;
/// assert_eq!(with_stem("*.img", Some("scans/brain.hdr")).as_deref(), Some("brain.img"));
/// assert_eq!(with_stem("a.bin", None).as_deref(), Some("a.bin"));
/// assert_eq!(with_stem("*.img", None), None);
/// ```
#[must_use]
pub fn with_stem<'p>(path: &'p str, name: Option<&str>) -> Option<Cow<'p, str>> {
    let Some(extension) = path.strip_prefix(SAME_STEM) else { return Some(Cow::Borrowed(path)) };
    let file = name?.rsplit(['/', '\\']).next()?;
    let stem = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
    Some(Cow::Owned(format!("{stem}.{extension}")))
}

/// Why a URI is not a file below the folder.
pub(crate) enum UriError {
    /// It has a scheme, as in `https:`.
    Scheme,
    /// It is absolute: it begins at the root of a server or disk.
    Absolute,
    /// It climbs above the folder.
    Above,
    /// It is empty, names a folder, or has an invalid escape.
    NoFile,
}

impl UriError {
    pub fn code(&self) -> &'static str {
        match self {
            Self::Scheme => "no-network",
            Self::Absolute | Self::Above => "outside-folder",
            Self::NoFile => "bad-uri",
        }
    }

    pub fn reason(&self) -> &'static str {
        match self {
            Self::Scheme => {
                "has a scheme: only files below the folder of the first are read, never the network"
            }
            Self::Absolute => "is absolute: only files below the folder of the first are read",
            Self::Above => "leads out of the folder of the first file",
            Self::NoFile => "names no file",
        }
    }
}

/// Resolves a URI in `folder` to a path below the top folder, without query and fragment. `folder` is also a
/// path below the top folder.
///
/// Escapes are decoded first, so that none of them hides a dot or a slash.
pub(crate) fn resolve(folder: &str, uri: &str) -> Result<String, UriError> {
    let end = uri.find(['?', '#']).unwrap_or(uri.len());
    below(folder, &decoded(&uri[..end]).ok_or(UriError::NoFile)?)
}

/// Resolves a path that is not a URI: nothing in it is escaped, and a backslash separates folders too, as in
/// paths written on Windows.
pub(crate) fn resolve_path(folder: &str, path: &str) -> Result<String, UriError> {
    below(folder, &path.replace('\\', "/"))
}

fn below(folder: &str, path: &str) -> Result<String, UriError> {
    if path.starts_with(['/', '\\']) {
        return Err(UriError::Absolute);
    }
    // A colon in the first segment ends a scheme, or names a disk.
    if path.split(['/', '\\']).next().is_some_and(|first| first.contains(':')) {
        return Err(UriError::Scheme);
    }
    // A backslash separates folders on Windows alone, so a name with one would mean different
    // files.
    if path.contains(['\\', '\0']) || path.ends_with('/') {
        return Err(UriError::NoFile);
    }
    let mut segments: Vec<&str> = folder.split('/').filter(|segment| !segment.is_empty()).collect();
    for segment in path.split('/') {
        match segment {
            "" | "." => {}
            ".." => {
                // Resolved as text, before any folder is opened: `..` never leaves the folder of
                // the input.
                segments.pop().ok_or(UriError::Above)?;
            }
            name => segments.push(name),
        }
    }
    // A path that ends with a folder names no file, whatever is left of it.
    let last = path.rsplit('/').next().unwrap_or_default();
    if matches!(last, "" | "." | "..") || segments.is_empty() {
        return Err(UriError::NoFile);
    }
    Ok(segments.join("/"))
}

/// The folder of a path.
pub(crate) fn folder(path: &str) -> &str {
    path.rsplit_once('/').map_or("", |(folder, _)| folder)
}

fn decoded(text: &str) -> Option<String> {
    if !text.contains('%') {
        return Some(text.to_owned());
    }
    let bytes = text.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        if bytes[at] == b'%' {
            let digit = |k: usize| bytes.get(at + k).and_then(|b| char::from(*b).to_digit(16));
            // Two hexadecimal digits make one byte.
            out.push((16 * digit(1)? + digit(2)?) as u8);
            at += 3;
        } else {
            out.push(bytes[at]);
            at += 1;
        }
    }
    String::from_utf8(out).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_no_uris_and_stay_below_the_folder_too() {
        let resolved = |folder, path| resolve_path(folder, path).map_err(|outside| outside.code());
        assert_eq!(resolved("", ".\\a b%20#.png"), Ok("a b%20#.png".to_owned()));
        assert_eq!(resolved("a/b", "..\\c\\d.png"), Ok("a/c/d.png".to_owned()));
        for path in ["..\\a", "a\\..\\..\\b", "\\\\host\\a", "/a", "\\a"] {
            assert_eq!(resolved("", path), Err("outside-folder"), "{path}");
        }
        for path in ["C:\\a.png", "c:a.png", "https://a/b.png"] {
            assert_eq!(resolved("", path), Err("no-network"), "{path}");
        }
        for path in ["", "a\\", ".", "a\0b"] {
            assert_eq!(resolved("", path), Err("bad-uri"), "{path:?}");
        }
    }

    #[test]
    fn stays_below_the_folder() {
        let resolved = |folder, uri| resolve(folder, uri).map_err(|outside| outside.code());
        assert_eq!(resolved("", "a/b.glb"), Ok("a/b.glb".to_owned()));
        assert_eq!(resolved("a", "./b%20c.glb?v=1#x"), Ok("a/b c.glb".to_owned()));
        assert_eq!(resolved("a/b", "../c.glb"), Ok("a/c.glb".to_owned()));
        for uri in
            ["../a.glb", "a/../../b.glb", "/etc/passwd", "//host/a", "%2e%2e/a.glb", "%2Fetc/passwd", "\\a"]
        {
            assert_eq!(resolved("", uri), Err("outside-folder"), "{uri}");
        }
        for uri in ["http://a/b.glb", "data:,x", "file:///etc/passwd", "C:\\a.glb", "http%3A//a/b"] {
            assert_eq!(resolved("", uri), Err("no-network"), "{uri}");
        }
        for uri in ["", ".", "a/", "a/..", "#x", "a%2", "a%zz", "%ff", "a\\..\\..\\b", "a%00b"] {
            assert_eq!(resolved("", uri), Err("bad-uri"), "{uri}");
        }
    }
}
