//! `packed_accessor`: the rows of an accessor, to be passed through.
use super::accessor_rows::AccessorRows;
use super::format::ComponentType;
use super::json::{JsonValue, members_without};
use crate::PackedAccessor;
use chordal::math::{greater, lesser};
use serde_json::json;

/// The rows of an accessor of the file, copied without gaps, and its properties; with bounds if it declares
/// some, or must have them.
pub(super) fn packed_accessor(
    object: Option<&JsonValue>,
    rows: &AccessorRows<'_>,
    must_have_bounds: bool,
) -> PackedAccessor {
    let left_out = ["bufferView", "byteOffset", "sparse", "extensions", "extras"];
    let mut properties = object.map(|object| members_without(object, &left_out)).unwrap_or_default();
    let n = rows.format.kind.n_components();
    let (mut least, mut most) = (vec![f64::INFINITY; n], vec![f64::NEG_INFINITY; n]);
    let mut bytes = Vec::new();
    rows.each(|_, row| {
        for (k, x) in row.iter().enumerate() {
            (least[k], most[k]) = (lesser(*x, least[k]), greater(*x, most[k]));
            put(rows.format.component, *x, &mut bytes);
        }
    });
    // Bounds in a file may be wrong, or only one of them given.
    if must_have_bounds || ["min", "max"].iter().any(|key| properties.contains_key(*key)) {
        properties.insert("min".to_owned(), json!(least));
        properties.insert("max".to_owned(), json!(most));
    }
    PackedAccessor { properties, bytes: bytes.into() }
}

/// Appends a number that was read from a component of this type.
fn put(component: ComponentType, x: f64, bytes: &mut Vec<u8>) {
    match component {
        ComponentType::I8 => bytes.extend((x as i8).to_le_bytes()),
        ComponentType::U8 => bytes.push(x as u8),
        ComponentType::I16 => bytes.extend((x as i16).to_le_bytes()),
        ComponentType::U16 => bytes.extend((x as u16).to_le_bytes()),
        ComponentType::U32 => bytes.extend((x as u32).to_le_bytes()),
        ComponentType::F32 => bytes.extend((x as f32).to_le_bytes()),
    }
}
