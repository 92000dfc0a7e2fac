//! `UsdType` and `UsdValue`: the types of attributes, and what they hold.

/// What a type name says of its values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct UsdType {
    /// Numbers in one element; 0 where they are no numbers.
    pub width: u8,
    /// Tokens, strings or paths of files.
    pub is_words: bool,
    pub is_array: bool,
    /// Whether it is a texture coordinate by its name.
    pub is_texcoord: bool,
    /// Whether it is a quaternion, whose real part comes first here.
    pub is_quaternion: bool,
}

/// Names of types with one number.
const SCALARS: [&str; 11] =
    ["bool", "uchar", "int", "uint", "int64", "uint64", "half", "float", "double", "timecode", "float1"];
/// Names of types whose number of components follows, and then maybe a letter for their precision.
const TUPLES: [&str; 12] = [
    "int", "half", "float", "double", "point", "normal", "vector", "color", "texCoord", "quat", "matrix",
    "frame",
];

impl UsdType {
    /// The type of a name in a file, with `[]` where it is an array. All 0 for one that is not known.
    pub(super) fn from_name(name: &str) -> Self {
        let base = name.strip_suffix("[]").unwrap_or(name);
        let mut found = Self { is_array: base.len() < name.len(), ..Self::default() };
        if SCALARS.contains(&base) {
            found.width = 1;
            return found;
        }
        if matches!(base, "token" | "string" | "asset") {
            found.is_words = true;
            return found;
        }
        for tuple in TUPLES {
            let Some(rest) = base.strip_prefix(tuple) else { continue };
            let n = match (tuple, rest.as_bytes()) {
                // A quaternion has four components, a matrix the square of its number.
                ("quat", [_]) => 4,
                ("matrix" | "frame", [n @ b'2'..=b'4', _]) => (n - b'0') * (n - b'0'),
                (_, [n @ b'2'..=b'4'] | [n @ b'2'..=b'4', _]) => n - b'0',
                _ => continue,
            };
            found.width = n;
            found.is_texcoord = tuple == "texCoord";
            found.is_quaternion = tuple == "quat";
        }
        found
    }
}

/// Rows of numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct UsdNumbers {
    /// Numbers in one row.
    pub width: usize,
    pub values: Vec<f64>,
}

impl UsdNumbers {
    pub(super) fn n_rows(&self) -> usize {
        self.values.len() / self.width.max(1)
    }

    /// The first row, if it has that many numbers.
    pub(super) fn first<const N: usize>(&self) -> Option<[f64; N]> {
        if self.width == N { self.row(0) } else { None }
    }

    pub(super) fn row<const N: usize>(&self, row: usize) -> Option<[f64; N]> {
        let start = row.checked_mul(self.width)?;
        let values = self.values.get(start..start.checked_add(self.width)?)?;
        values.get(..N)?.try_into().ok()
    }
}

/// The value of an attribute.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum UsdValue {
    /// One row, or those of an array.
    Numbers(UsdNumbers),
    /// Tokens, strings or paths of files: one, or those of an array.
    Words(Vec<Box<str>>),
    /// Still packed in a binary file: what its table says of it.
    Packed(u64),
    /// Explicitly none, which hides weaker opinions.
    Blocked,
    /// Something that no reader here asks for.
    Other,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_are_known_by_their_names() {
        let width = |name| UsdType::from_name(name).width;
        let names = ["float", "point3f[]", "color4h", "quatf", "matrix4d", "texCoord2f[]", "int2", "bool"];
        assert_eq!(names.map(width), [1, 3, 4, 4, 16, 2, 2, 1]);
        assert_eq!(["token", "opaque", "float5", "matrix9d", "point", ""].map(width), [0; 6]);
        assert!(UsdType::from_name("asset[]").is_array && UsdType::from_name("texCoord2h").is_texcoord);
    }
}
