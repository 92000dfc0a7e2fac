//! Formats of accessors: how a row of numbers is laid out in bytes.
use chordal::math::greater;
use std::fmt;

/// Primitive modes below this are points and lines (glTF 2.0, section 5.24.4).
pub(super) const FIRST_MODE_OF_TRIANGLES: u64 = 4;

/// The type of one component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ComponentType {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl ComponentType {
    /// Converts from OpenGL's code.
    pub fn from_code(code: u64) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    /// Bytes per component.
    pub fn size(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The number that a component's little-endian bytes hold; 0 if their count is wrong.
    pub fn number(self, bytes: &[u8]) -> f64 {
        match (self, bytes) {
            (Self::I8, [a]) => f64::from(i8::from_le_bytes([*a])),
            (Self::U8, [a]) => f64::from(*a),
            (Self::I16, [a, b]) => f64::from(i16::from_le_bytes([*a, *b])),
            (Self::U16, [a, b]) => f64::from(u16::from_le_bytes([*a, *b])),
            (Self::U32, [a, b, c, d]) => f64::from(u32::from_le_bytes([*a, *b, *c, *d])),
            (Self::F32, [a, b, c, d]) => f64::from(f32::from_le_bytes([*a, *b, *c, *d])),
            _ => 0.0,
        }
    }

    /// The lowest and highest value; infinite for floats.
    pub fn range(self) -> (f64, f64) {
        match self {
            Self::I8 => (-128.0, 127.0),
            Self::U8 => (0.0, 255.0),
            Self::I16 => (-32768.0, 32767.0),
            Self::U16 => (0.0, 65535.0),
            Self::U32 => (0.0, 4_294_967_295.0),
            Self::F32 => (f64::NEG_INFINITY, f64::INFINITY),
        }
    }

    /// Reads the number at the start of the bytes; 0 if bytes are missing.
    pub fn read(self, bytes: &[u8]) -> f64 {
        match (self, bytes) {
            (Self::I8, [a, ..]) => f64::from(i8::from_le_bytes([*a])),
            (Self::U8, [a, ..]) => f64::from(*a),
            (Self::I16, [a, b, ..]) => f64::from(i16::from_le_bytes([*a, *b])),
            (Self::U16, [a, b, ..]) => f64::from(u16::from_le_bytes([*a, *b])),
            (Self::U32, [a, b, c, d, ..]) => f64::from(u32::from_le_bytes([*a, *b, *c, *d])),
            (Self::F32, [a, b, c, d, ..]) => f64::from(f32::from_le_bytes([*a, *b, *c, *d])),
            _ => 0.0,
        }
    }

    /// Reads consecutive numbers, as many as `numbers` has room for.
    pub fn read_all(self, bytes: &[u8], numbers: &mut [f64]) {
        fn each<const N: usize>(bytes: &[u8], numbers: &mut [f64], number: impl Fn([u8; N]) -> f64) {
            let (chunks, _) = bytes.as_chunks::<N>();
            numbers.iter_mut().zip(chunks).for_each(|(x, chunk)| *x = number(*chunk));
        }
        match self {
            Self::I8 => each(bytes, numbers, |b| f64::from(i8::from_le_bytes(b))),
            Self::U8 => each(bytes, numbers, |b| f64::from(u8::from_le_bytes(b))),
            Self::I16 => each(bytes, numbers, |b| f64::from(i16::from_le_bytes(b))),
            Self::U16 => each(bytes, numbers, |b| f64::from(u16::from_le_bytes(b))),
            Self::U32 => each(bytes, numbers, |b| f64::from(u32::from_le_bytes(b))),
            Self::F32 => each(bytes, numbers, |b| f64::from(f32::from_le_bytes(b))),
        }
    }

    /// The value of a normalized integer: 0 to 1, or −1 to 1.
    pub fn normalize(self, x: f64) -> f64 {
        match self {
            Self::F32 => x,
            // The lowest two integers both map to −1.
            _ => {
                let share = x / self.range().1;
                greater(-1.0, share)
            }
        }
    }
}

/// The shape of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AccessorType {
    Scalar,
    Vec2,
    Vec3,
    Vec4,
    Mat2,
    Mat3,
    Mat4,
}

impl AccessorType {
    /// Converts from its name.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "SCALAR" => Self::Scalar,
            "VEC2" => Self::Vec2,
            "VEC3" => Self::Vec3,
            "VEC4" => Self::Vec4,
            "MAT2" => Self::Mat2,
            "MAT3" => Self::Mat3,
            "MAT4" => Self::Mat4,
            _ => return None,
        })
    }

    /// Components per row.
    pub fn n_components(self) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Vec2 => 2,
            Self::Vec3 => 3,
            Self::Vec4 | Self::Mat2 => 4,
            Self::Mat3 => 9,
            Self::Mat4 => 16,
        }
    }

    fn n_rows(self) -> u64 {
        match self {
            Self::Mat2 => 2,
            Self::Mat3 => 3,
            Self::Mat4 => 4,
            _ => self.n_components() as u64,
        }
    }

    /// Whether it is a matrix.
    pub fn is_matrix(self) -> bool {
        matches!(self, Self::Mat2 | Self::Mat3 | Self::Mat4)
    }
}

/// The format of a row: its shape, its component type, and whether integers are normalized.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct AccessorFormat {
    pub kind: AccessorType,
    pub component: ComponentType,
    pub normalized: bool,
}

impl AccessorFormat {
    /// A format that is not normalized.
    pub const fn plain(kind: AccessorType, component: ComponentType) -> Self {
        Self { kind, component, normalized: false }
    }

    /// A format that is normalized.
    pub const fn normalized(kind: AccessorType, component: ComponentType) -> Self {
        Self { kind, component, normalized: true }
    }

    /// The offset of a component in its row; columns of matrices begin at multiples of four bytes.
    pub fn place_of(self, component_idx: usize) -> u64 {
        let (size, i) = (self.component.size(), component_idx as u64);
        if !self.kind.is_matrix() {
            return i * size;
        }
        let rows = self.kind.n_rows();
        i / rows * self.column() + i % rows * size
    }

    fn column(self) -> u64 {
        (self.kind.n_rows() * self.component.size()).div_ceil(4) * 4
    }

    /// Bytes per row, without padding after its last component.
    pub fn row_length(self) -> u64 {
        self.place_of(self.kind.n_components() - 1) + self.component.size()
    }

    /// The stride if the file gives none.
    pub fn natural_stride(self) -> u64 {
        if self.kind.is_matrix() {
            let rows = self.kind.n_rows();
            self.kind.n_components() as u64 / rows * self.column()
        } else {
            self.row_length()
        }
    }
}

impl fmt::Display for AccessorFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let normalized = if self.normalized { " normalized" } else { "" };
        write!(f, "{:?} of {:?}{normalized}", self.kind, self.component)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matrices_are_padded_to_columns_of_four_bytes() {
        let layout = |kind, component| {
            let format = AccessorFormat::plain(kind, component);
            let places: Vec<_> = (0..kind.n_components()).map(|i| format.place_of(i)).collect();
            (places, format.row_length(), format.natural_stride())
        };
        assert_eq!(layout(AccessorType::Mat2, ComponentType::U8), (vec![0, 1, 4, 5], 6, 8));
        assert_eq!(layout(AccessorType::Mat3, ComponentType::I8), (vec![0, 1, 2, 4, 5, 6, 8, 9, 10], 11, 12));
        assert_eq!(
            layout(AccessorType::Mat3, ComponentType::U16),
            (vec![0, 2, 4, 8, 10, 12, 16, 18, 20], 22, 24)
        );
        assert_eq!(layout(AccessorType::Mat2, ComponentType::I16), (vec![0, 2, 4, 6], 8, 8));
        assert_eq!(layout(AccessorType::Vec3, ComponentType::U8), (vec![0, 1, 2], 3, 3));
        assert_eq!(layout(AccessorType::Mat4, ComponentType::F32).1, 64);
    }

    #[test]
    fn normalized_integers_span_the_unit_range() {
        assert_eq!(ComponentType::U8.normalize(255.0), 1.0);
        assert_eq!(ComponentType::I8.normalize(-128.0), -1.0);
        assert_eq!(ComponentType::I8.normalize(-127.0), -1.0);
        assert_eq!(ComponentType::I16.normalize(32767.0), 1.0);
    }
}
