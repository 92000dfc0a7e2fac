//! The extension of a file's name, which identifies the format if the content does not.
use chordal_io::Format;

/// The extension of a file's name. `obj.gz` counts as one extension, as does any other of a packed format.
#[must_use]
pub fn extension(name: &str) -> Option<&str> {
    let file = name.rsplit(['/', '\\']).next()?;
    let (stem, last) = file.rsplit_once('.')?;
    let under = stem.rsplit_once('.').filter(|(name, _)| last.eq_ignore_ascii_case("gz") && !name.is_empty());
    let packed = under.filter(|(_, under)| Format::from_extension(under).is_some());
    Some(packed.map_or(last, |(name, _)| &file[name.len() + 1..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_extension_of_the_last_name_only() {
        assert_eq!(extension("a.b/teapot"), None);
        assert_eq!(extension("a/teapot.tar.obj"), Some("obj"));
        assert_eq!(extension("a.b/brain.NII.gz"), Some("NII.gz"));
        assert_eq!(extension("brain.tar.gz"), Some("gz"));
        assert_eq!(extension("a.b.mha.GZ"), Some("mha.GZ"));
        assert_eq!(extension(".nii.gz"), Some("gz"));
        assert_eq!(extension("C:\\x\\teapot.GLB"), Some("GLB"));
    }
}
