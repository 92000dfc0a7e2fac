//! `UsdType` and `UsdValue`: the types of attributes, and their values.

/// The layout of values, by type name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct UsdType {
    /// The count of numbers in one element; 0 if they are not numbers.
    pub width: u8,
    /// Tokens, strings or paths of files.
    pub is_words: bool,
    pub is_array: bool,
    /// Whether the type name means texture coordinates.
    pub is_texcoord: bool,
    /// Whether it is a quaternion, which has its real part first here.
    pub is_quaternion: bool,
}

/// Names of types with one number.
const SCALARS: [&str; 11] =
    ["bool", "uchar", "int", "uint", "int64", "uint64", "half", "float", "double", "timecode", "float1"];
/// Names of types that are followed by the number of components, and in some cases by a letter for the
/// precision.
const TUPLES: [&str; 12] = [
    "int", "half", "float", "double", "point", "normal", "vector", "color", "texCoord", "quat", "matrix",
    "frame",
];

impl UsdType {
    /// The type for a name in a file; `[]` marks an array. All fields are 0 for an unknown name.
    pub(super) fn from_name(name: &str) -> Self {
        let base = name.strip_suffix("[]").unwrap_or(name);
        let mut kind = Self { is_array: base.len() < name.len(), ..Self::default() };
        if SCALARS.contains(&base) {
            kind.width = 1;
            return kind;
        }
        if matches!(base, "token" | "string" | "asset") {
            kind.is_words = true;
            return kind;
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
            kind.width = n;
            kind.is_texcoord = tuple == "texCoord";
            kind.is_quaternion = tuple == "quat";
        }
        kind
    }
}

/// Rows of numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct UsdNumbers {
    /// The count of numbers in one row.
    pub width: usize,
    pub values: Vec<f64>,
}

impl UsdNumbers {
    pub(super) fn n_rows(&self) -> usize {
        self.values.len() / self.width.max(1)
    }

    /// The first row, if it has `N` numbers.
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
    /// One row, or the rows of an array.
    Numbers(UsdNumbers),
    /// One token, string or file path, or those of an array.
    Words(Vec<Box<str>>),
    /// Still packed in a binary file: its entry in the file's table.
    Packed(u64),
    /// Explicitly no value, which hides weaker opinions.
    Blocked,
    /// A value that no reader here needs.
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
