//! `VertexStorage`: how a quantized glTF stores the numbers of a part, and the attributes after rounding.
use super::deformation::is_deformed;
use super::position_lattice::PositionLattice;
use chordal::Mesh;
use chordal::explicit::{Attribute, InvalidMesh, Semantic};
use chordal::math::unit;

/// How the numbers of a part are stored if its glTF is quantized (`KHR_mesh_quantization`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexStorage {
    /// The lattice of its positions; `None` if they stay in single precision.
    pub lattice: Option<PositionLattice>,
    /// The number of bits of normals and tangents.
    pub directions: DirectionBits,
    /// Whether texture coordinates between 0 and 1 are stored as multiples of 1 / 65,535; if not, they stay
    /// in single precision.
    pub has_short_texcoords: bool,
}

/// The number of bits per coordinate of a normal or tangent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DirectionBits {
    /// Eight.
    #[default]
    Eight,
    /// Sixteen.
    Sixteen,
    /// 32: single precision.
    Single,
}

/// A normalized integer type: a number is stored as its share of the largest integer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NormalizedNumber {
    I8,
    I16,
    U8,
    U16,
}

impl NormalizedNumber {
    /// The integer that represents 1.
    pub fn most(self) -> f64 {
        match self {
            Self::I8 => f64::from(i8::MAX),
            Self::I16 => f64::from(i16::MAX),
            Self::U8 => f64::from(u8::MAX),
            Self::U16 => f64::from(u16::MAX),
        }
    }

    /// `BYTE`, `UNSIGNED_BYTE`, `SHORT` or `UNSIGNED_SHORT`.
    pub fn component_type(self) -> u32 {
        match self {
            Self::I8 => 5120,
            Self::U8 => 5121,
            Self::I16 => 5122,
            Self::U16 => 5123,
        }
    }

    /// The number of its bytes.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
        }
    }

    /// The nearest integer.
    pub fn stored(self, x: f64) -> f64 {
        let least = if matches!(self, Self::I8 | Self::I16) { -1.0 } else { 0.0 };
        (x.clamp(least, 1.0) * self.most()).round() + 0.0
    }

    /// The bytes of an integer; only the first [`Self::size`] are used.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub fn bytes(self, stored: f64) -> [u8; 2] {
        match self {
            Self::I8 => [(stored as i8).to_le_bytes()[0], 0],
            Self::U8 => [stored as u8, 0],
            Self::I16 => (stored as i16).to_le_bytes(),
            Self::U16 => (stored as u16).to_le_bytes(),
        }
    }
}

impl DirectionBits {
    fn number(self) -> Option<NormalizedNumber> {
        match self {
            Self::Eight => Some(NormalizedNumber::I8),
            Self::Sixteen => Some(NormalizedNumber::I16),
            Self::Single => None,
        }
    }

    /// An upper bound of the rotation of a direction, in degrees. Derived: each coordinate is off by at most
    /// half a step, hence the end of the unit vector by √3 / 2 steps, and the angle by the arc sine of that;
    /// the last digit is rounded up.
    #[must_use]
    pub fn worst_deg(self) -> f64 {
        match self {
            Self::Eight => 0.391,
            Self::Sixteen => 0.001_52,
            Self::Single => 0.0,
        }
    }
}

impl VertexStorage {
    /// The largest error of a texture coordinate. Derived: half a step of each of two numbers, √2 / 2 /
    /// 65,535, rounded up.
    pub const WORST_TEXCOORD: f64 = 1.08e-5;

    /// The storage of a mesh without a given error limit: the finest lattice for its positions, eight bits
    /// for directions, 16 for texture coordinates. A mesh deformed by a skin or morph targets keeps its
    /// positions, since the node of a skin has no effect, and morph targets are displacements in the units of
    /// positions.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        let lattice = if is_deformed(mesh) { None } else { PositionLattice::for_mesh(mesh) };
        Self::with_lattice(lattice)
    }

    /// The default storage with this lattice.
    #[must_use]
    pub fn with_lattice(lattice: Option<PositionLattice>) -> Self {
        Self { lattice, directions: DirectionBits::Eight, has_short_texcoords: true }
    }

    /// The mesh with its attributes as they read back: normals and tangents, texture coordinates and colours.
    /// Rounding is idempotent.
    ///
    /// Joint weights are rounded by the writer, and other attributes stay in single precision.
    ///
    /// # Errors
    /// None for a valid mesh: an error means that the mesh was invalid before.
    pub fn round_attributes(&self, mesh: &Mesh) -> Result<Mesh, InvalidMesh> {
        let mut rounded = Mesh::new(mesh.positions().to_vec(), mesh.faces().to_vec())?;
        if let Some(ids) = mesh.position_id() {
            rounded = rounded.with_position_id(ids.to_vec())?;
        }
        for attribute in mesh.attributes() {
            let values = match self.number_of(attribute) {
                None => attribute.values.clone(),
                Some(number) => {
                    let rows = attribute.values.chunks_exact(attribute.width);
                    rows.flat_map(|row| stored_row(attribute, row, number))
                        .map(|x| x / number.most())
                        .collect()
                }
            };
            rounded = rounded.with_attribute(Attribute { values, ..attribute.clone() })?;
        }
        Ok(rounded)
    }

    /// The integer type in which an attribute is stored, if any.
    pub(super) fn number_of(&self, attribute: &Attribute) -> Option<NormalizedNumber> {
        let is_within = || attribute.values.iter().all(|x| (0.0..=1.0).contains(x));
        match attribute.semantic {
            Semantic::Normal if attribute.width == 3 => self.directions.number(),
            Semantic::Tangent if attribute.width == 4 => self.directions.number(),
            Semantic::TexCoord(_) => {
                (self.has_short_texcoords && is_within()).then_some(NormalizedNumber::U16)
            }
            Semantic::Color(_) => is_within().then(|| {
                let byte = NormalizedNumber::U8;
                // Colours that were bytes must stay the same bytes, however the file stored them.
                let is_byte = |x: &f64| (x * byte.most() - byte.stored(*x)).abs() < COLOUR_SLACK;
                if attribute.values.iter().all(is_byte) { byte } else { NormalizedNumber::U16 }
            }),
            _ => None,
        }
    }
}

/// How far a colour may be from a byte, in bytes. Derived: single precision has 24 bits, and 255 of its last
/// are 2⁻¹⁶.
const COLOUR_SLACK: f64 = 1.0 / 65536.0;

/// How far the length of a stored direction may be from 1. Derived: √3 / 2 / 127 and a little.
const LENGTH_SLACK: f64 = 0.01;

/// How far a stored coordinate that was read may be from its integer: the rounding of a quotient and a
/// product.
const INTEGER_SLACK: f64 = 1e-9; // Chosen: a thousand times the rounding of 16 bits, and below any other number.

/// The integers for a row of an attribute.
pub(super) fn stored_row(attribute: &Attribute, row: &[f64], number: NormalizedNumber) -> Vec<f64> {
    let axis = match attribute.semantic {
        Semantic::Normal => 2,
        Semantic::Tangent => 0,
        _ => return row.iter().map(|x| number.stored(*x)).collect(),
    };
    let v = [row[0], row[1], row[2]];
    let length_sq = v.iter().map(|x| x * x).sum::<f64>();
    let is_stored = |x: &f64| (x * number.most() - number.stored(*x)).abs() < INTEGER_SLACK;
    // A row that was rounded before is kept: scaling it to length 1 could round it to another one.
    let is_rounded = (length_sq - 1.0).abs() < 2.0 * LENGTH_SLACK && v.iter().all(is_stored);
    let along_axis = || std::array::from_fn(|k| if k == axis { 1.0 } else { 0.0 });
    let direction = if is_rounded { v } else { unit(v).unwrap_or_else(along_axis) };
    let side = row.get(3).map(|w| if *w < 0.0 { -1.0 } else { 1.0 });
    direction.into_iter().chain(side).map(|x| number.stored(x)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal::explicit::Domain;
    use proptest::prelude::*;

    fn with(semantic: Semantic, width: usize, values: Vec<f64>) -> Mesh {
        let n = values.len() / width;
        let attribute = Attribute { semantic, domain: Domain::Vertex, width, values };
        Mesh::new(vec![[0.0; 3]; n], Vec::new()).and_then(|mesh| mesh.with_attribute(attribute)).unwrap()
    }

    proptest! {
        #[test]
        fn directions_turn_by_no_more_than_is_said(v in prop::array::uniform3(-1.0..1.0_f64)) {
            let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
            prop_assume!(length > 1e-3);
            let u = v.map(|x| x / length);
            for directions in [DirectionBits::Eight, DirectionBits::Sixteen] {
                let storage = VertexStorage { directions, ..VertexStorage::with_lattice(None) };
                let once = storage.round_attributes(&with(Semantic::Normal, 3, v.to_vec())).unwrap();
                let r = &once.attributes()[0].values;
                let cross = [u[1] * r[2] - u[2] * r[1], u[2] * r[0] - u[0] * r[2], u[0] * r[1] - u[1] * r[0]];
                let sine = cross.iter().map(|x| x * x).sum::<f64>().sqrt();
                let cosine: f64 = u.iter().zip(r).map(|(a, b)| a * b).sum();
                prop_assert!(sine.atan2(cosine).to_degrees() <= directions.worst_deg());
                prop_assert_eq!(&storage.round_attributes(&once).unwrap(), &once);
            }
        }

        #[test]
        fn texture_coordinates_move_by_no_more_than_is_said(uv in prop::array::uniform2(0.0..=1.0_f64)) {
            let storage = VertexStorage::with_lattice(None);
            let once = storage.round_attributes(&with(Semantic::TexCoord(0), 2, uv.to_vec())).unwrap();
            let r = &once.attributes()[0].values;
            prop_assert!((r[0] - uv[0]).hypot(r[1] - uv[1]) <= VertexStorage::WORST_TEXCOORD);
            prop_assert_eq!(&storage.round_attributes(&once).unwrap(), &once);
        }
    }

    #[test]
    fn colours_that_were_bytes_stay_bytes_and_others_get_two() {
        let storage = VertexStorage::with_lattice(None);
        let of = |values: Vec<f64>| storage.number_of(&with(Semantic::Color(0), 3, values).attributes()[0]);
        let bytes = vec![1.0 / 255.0, f64::from(127.0_f32 / 255.0), 1.0];
        assert_eq!(of(bytes), Some(NormalizedNumber::U8));
        assert_eq!(of(vec![0.1234, 0.0, 1.0]), Some(NormalizedNumber::U16));
        assert_eq!(of(vec![1.5, 0.0, 1.0]), None);
    }

    #[test]
    fn texture_coordinates_that_repeat_stay_as_they_are() {
        let tiled = with(Semantic::TexCoord(0), 2, vec![0.3, 2.7]);
        assert_eq!(VertexStorage::with_lattice(None).round_attributes(&tiled).unwrap(), tiled);
    }
}
