//! `Format`: the format of a file, by its extension or by its content.
use crate::text::{LineTokens, TextLines, integer, is_space, number, trim};
use crate::{nii, npy, nrrd, obj, shape_json, stl, svg, vm};
use std::fmt;
use std::str::FromStr;

/// A file format.
///
/// ```
/// use chordal_io::Format;
/// assert_eq!(Format::from_extension("STL"), Some(Format::Stl));
/// assert_eq!(Format::sniff(b"1\n1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16\n"), Some(Format::Teaset));
/// assert_eq!("ply".parse(), Ok(Format::Ply));
/// assert_eq!(Format::Json.to_string(), "json");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Bicubic Bézier patches, one block of 4 × 4 points each.
    Bpt,
    /// Newell's teaset text: patches as indices, then points.
    Teaset,
    /// Patches, curves or polylines in JSON.
    Json,
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY.
    Ply,
    /// STL, text or binary.
    Stl,
    /// Binary glTF 2.0.
    Glb,
    /// Scalable Vector Graphics.
    Svg,
    /// An expression graph as an op list, in fidget's text format.
    Vm,
    /// NumPy array with three axes.
    Npy,
    /// NRRD volume.
    Nrrd,
    /// NIfTI volume, gzipped or not.
    Nii,
    /// A shape script, which is run instead of read.
    Star,
}

/// Every format with its name, which `--from` and `--to` take and which is also an extension.
const NAMES: [(Format, &str); 13] = [
    (Format::Bpt, "bpt"),
    (Format::Teaset, "teaset"),
    (Format::Json, "json"),
    (Format::Obj, "obj"),
    (Format::Ply, "ply"),
    (Format::Stl, "stl"),
    (Format::Glb, "glb"),
    (Format::Svg, "svg"),
    (Format::Vm, "vm"),
    (Format::Npy, "npy"),
    (Format::Nrrd, "nrrd"),
    (Format::Nii, "nii"),
    (Format::Star, "star"),
];

impl Format {
    /// All formats.
    pub fn all() -> impl Iterator<Item = Self> {
        NAMES.iter().map(|row| row.0)
    }

    /// The format of an extension, with or without its dot, in any case; `nii.gz` is one too.
    #[must_use]
    pub fn from_extension(extension: &str) -> Option<Self> {
        let name = extension.strip_prefix('.').unwrap_or(extension);
        if name.eq_ignore_ascii_case("nii.gz") {
            return Some(Self::Nii);
        }
        NAMES.iter().find(|row| row.1.eq_ignore_ascii_case(name)).map(|row| row.0)
    }

    /// The format that the content looks like, whatever its extension. Looks only at as much as it must. A
    /// reader may still refuse the file.
    #[must_use]
    pub fn sniff(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"glTF") {
            return Some(Self::Glb);
        }
        if bytes.starts_with(npy::MAGIC) {
            return Some(Self::Npy);
        }
        if bytes.starts_with(nrrd::MAGIC) {
            return Some(Self::Nrrd);
        }
        if nii::looks_like(bytes) {
            return Some(Self::Nii);
        }
        let text = trim_start(bytes.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(bytes));
        if text.starts_with(b"ply") && text.get(3).is_some_and(|b| is_space(*b)) {
            return Some(Self::Ply);
        }
        if stl::looks_like(bytes) {
            return Some(Self::Stl);
        }
        if text.first() == Some(&b'{') {
            return shape_json::looks_like(text).then_some(Self::Json);
        }
        if svg::looks_like(text) {
            return Some(Self::Svg);
        }
        if vm::looks_like(text) {
            return Some(Self::Vm);
        }
        sniff_patches(text).or_else(|| obj::looks_like(bytes).then_some(Self::Obj))
    }
}

fn trim_start(bytes: &[u8]) -> &[u8] {
    let start = bytes.iter().position(|b| !is_space(*b)).unwrap_or(bytes.len());
    &bytes[start..]
}

/// Both patch texts start with a line that holds only the number of patches. Then come two degrees, or
/// sixteen indices with commas.
fn sniff_patches(text: &[u8]) -> Option<Format> {
    let mut lines = TextLines::new(text).map(|(_, line)| trim(line)).filter(|line| !line.is_empty());
    integer(lines.next()?).ok()?;
    let second = lines.next()?;
    if second.contains(&b',') {
        let all = second.split(|b| *b == b',').all(|token| integer(trim(token)).is_ok());
        return all.then_some(Format::Teaset);
    }
    let degrees: Vec<_> = LineTokens::new(second).take(3).collect();
    let all = degrees.len() == 2 && degrees.iter().all(|token| number(token).is_some());
    all.then_some(Format::Bpt)
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(NAMES[*self as usize].1)
    }
}

/// A name that is no format.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownFormat(String);

impl fmt::Display for UnknownFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "'{}' is no format; they are", self.0.escape_default())?;
        let last = NAMES.len() - 1;
        for (i, (_, name)) in NAMES.iter().enumerate() {
            write!(
                f,
                "{} {name}",
                if i == 0 {
                    ""
                } else if i == last {
                    " and"
                } else {
                    ","
                }
            )?;
        }
        Ok(())
    }
}

impl std::error::Error for UnknownFormat {}

impl FromStr for Format {
    type Err = UnknownFormat;
    fn from_str(name: &str) -> Result<Self, UnknownFormat> {
        Self::from_extension(name).ok_or_else(|| UnknownFormat(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_is_found_by_its_own_name() {
        for (i, format) in Format::all().enumerate() {
            assert_eq!(format as usize, i, "NAMES is in the order of the enum");
            assert_eq!(format.to_string().parse(), Ok(format));
            assert_eq!(
                Format::from_extension(&format!(".{}", format.to_string().to_uppercase())),
                Some(format)
            );
        }
    }

    #[test]
    fn an_unknown_name_is_answered_with_those_that_are_known() {
        let message = "dwg".parse::<Format>().unwrap_err().to_string();
        assert_eq!(
            message,
            "'dwg' is no format; they are bpt, teaset, json, obj, ply, stl, glb, svg, vm, npy, nrrd, nii and star"
        );
        assert_eq!(Format::from_extension(""), None);
    }
}
