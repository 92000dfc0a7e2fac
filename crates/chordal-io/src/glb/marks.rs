//! Points and lines of a glTF: read unchanged, and written again.
use super::accessor_rows::AccessorRows;
use super::deformation::targets_of;
use super::format::ComponentType;
use super::json::JsonValue;
use super::model::{GltfAttributes, GltfModel, GltfPrimitive};
use super::packed_accessor::packed_accessor;
use super::stored_positions::StoredPositions;
use crate::{Marks, PackedAccessor, Part};
use chordal::Mesh;
use chordal::math::{greater, lesser};
use serde_json::{Map, Value, json};

/// The joints of marks; if they are present, a skin moves the marks.
const JOINTS: &str = "JOINTS_0";

/// Reads a primitive of points or lines; `None` if some of its data is missing. `charge` is called with the
/// bytes of each accessor before they are copied.
pub(super) fn read_marks<E>(
    model: &GltfModel<'_>,
    primitive: &GltfPrimitive<'_>,
    (object, accessors): (&JsonValue, &[JsonValue]),
    mut charge: impl FnMut(u64) -> Result<(), E>,
) -> Result<Option<Marks>, E> {
    let mut packed: Vec<PackedAccessor> = Vec::new();
    let mut pack = |accessor: Option<usize>, name: &str| -> Result<Option<usize>, E> {
        let Some(accessor) = accessor else { return Ok(None) };
        let Ok(rows) = AccessorRows::new(model, accessor) else { return Ok(None) };
        if rows.check_sparse().is_err() {
            return Ok(None);
        }
        charge(rows.n_bytes())?;
        let mut copied = packed_accessor(accessors.get(accessor), &rows, name == "POSITION");
        // The copy is a new accessor with packed rows, so the name of the old one does not apply.
        copied.properties.shift_remove("name");
        packed.push(copied);
        Ok(Some(packed.len() - 1))
    };
    let mut list = |attributes: &GltfAttributes<'_>| -> Result<Option<Map<String, Value>>, E> {
        let mut map = Map::new();
        for (name, accessor) in attributes {
            let Some(at) = pack(*accessor, name)? else { return Ok(None) };
            map.insert((*name).to_owned(), json!(at));
        }
        Ok(Some(map))
    };
    let Some(attributes) = list(&primitive.attributes)? else { return Ok(None) };
    let mut targets = Vec::new();
    for target in primitive.targets.iter().flatten() {
        let Some(target) = list(target)? else { return Ok(None) };
        targets.push(Value::Object(target));
    }
    let mut members = Map::new();
    members.insert("attributes".to_owned(), Value::Object(attributes));
    if primitive.indices.is_some() {
        let Some(at) = pack(primitive.indices, "indices")? else { return Ok(None) };
        members.insert("indices".to_owned(), json!(at));
    }
    members.insert("mode".to_owned(), json!(primitive.mode));
    if !targets.is_empty() {
        members.insert("targets".to_owned(), Value::Array(targets));
    }
    members.extend(super::face_kinds::properties_of(object));
    Ok(Some(Marks { primitive: members, material: primitive.material, accessors: packed }))
}

/// An accessor of marks, ready to be written.
pub(super) struct MarkAccessor {
    pub properties: Map<String, Value>,
    /// Rows of vertices are aligned to four bytes.
    pub bytes: Vec<u8>,
    pub stride: Option<usize>,
    pub target: u32,
    /// Whether its format is allowed only by `KHR_mesh_quantization`.
    pub needs_quantization: bool,
}

impl MarkAccessor {
    /// The indices of marks.
    pub fn indices(packed: &PackedAccessor) -> Self {
        // `ELEMENT_ARRAY_BUFFER`
        let target = 34963;
        let (properties, bytes) = (packed.properties.clone(), packed.bytes.to_vec());
        Self { properties, bytes, stride: None, target, needs_quantization: false }
    }

    /// An attribute of marks, or of one of their morph targets. Positions are stored as those of the
    /// triangles of their mesh, since the same node places both; if those are on a lattice, in single
    /// precision about its corner.
    pub fn attribute(packed: &PackedAccessor, name: &str, place: &StoredPositions) -> Self {
        let placed = if name == "POSITION" && !place.is_plain() { moved(packed, place) } else { None };
        let packed = placed.as_ref().unwrap_or(packed);
        let properties = packed.properties.clone();
        let number = |key: &str| properties.get(key).and_then(Value::as_u64).unwrap_or_default();
        let count = usize::try_from(number("count")).unwrap_or_default();
        let size = packed.bytes.len().checked_div(count).unwrap_or_default();
        // In glTF each row of a vertex attribute begins at a multiple of four bytes.
        let padded = size.next_multiple_of(4);
        let (bytes, stride) = if size == padded {
            (packed.bytes.to_vec(), None)
        } else {
            let mut bytes = Vec::with_capacity(padded * count);
            for row in packed.bytes.chunks_exact(size) {
                bytes.extend_from_slice(row);
                bytes.resize(bytes.len() + padded - size, 0);
            }
            (bytes, Some(padded))
        };
        let is_normalized = properties.get("normalized") == Some(&Value::Bool(true));
        let component = ComponentType::from_code(number("componentType"));
        let needs_quantization = match component {
            Some(ComponentType::F32) | None => false,
            Some(component) => {
                let is_unsigned = matches!(component, ComponentType::U8 | ComponentType::U16);
                let is_texcoord = name.starts_with("TEXCOORD_");
                ["POSITION", "NORMAL", "TANGENT"].contains(&name)
                    || is_texcoord && !(is_unsigned && is_normalized)
            }
        };
        // `ARRAY_BUFFER`
        Self { properties, bytes, stride, target: 34962, needs_quantization }
    }
}

/// Positions of marks in single precision about another origin than in their file.
fn moved(packed: &PackedAccessor, place: &StoredPositions) -> Option<PackedAccessor> {
    let code = packed.properties.get("componentType")?.as_u64()?;
    let component = ComponentType::from_code(code)?;
    let is_normalized = packed.properties.get("normalized") == Some(&Value::Bool(true));
    let (origin, step) = match *place {
        StoredPositions::Single(origin) => (origin, 1.0),
        StoredPositions::Lattice(lattice, corner) => (corner, lattice.step()),
    };
    let size = usize::try_from(component.size()).ok()?;
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    let mut bytes = Vec::with_capacity(packed.bytes.len() / size * 4);
    for (i, number) in packed.bytes.chunks_exact(size).enumerate() {
        let (raw, k) = (component.number(number), i % 3);
        let x = if is_normalized { greater(raw / component.range().1, -1.0) } else { raw };
        let stored = ((x - origin[k]) / step) as f32;
        // Adding zero turns −0 into 0. The bounds are those of the stored numbers, as the validator
        // compares exactly.
        let [least, most] = bounds.each_mut().map(|bound| &mut bound[k]);
        (*least, *most) = (lesser(f64::from(stored) + 0.0, *least), greater(f64::from(stored) + 0.0, *most));
        bytes.extend(stored.to_le_bytes());
    }
    let mut properties = packed.properties.clone();
    properties.shift_remove("normalized");
    // `FLOAT`
    properties.insert("componentType".to_owned(), json!(5126));
    properties.insert("min".to_owned(), json!(bounds[0]));
    properties.insert("max".to_owned(), json!(bounds[1]));
    Some(PackedAccessor { properties, bytes: bytes.into() })
}

impl Marks {
    /// The glTF primitive without its material, for a mesh with this storage of positions and this number of
    /// morph targets. `add` writes an accessor and returns its index.
    pub(super) fn object(
        &self,
        (place, n_targets): (&StoredPositions, usize),
        mut add: impl FnMut(MarkAccessor) -> usize,
    ) -> Map<String, Value> {
        let mut primitive = self.primitive.clone();
        if self.n_targets() != n_targets {
            primitive.shift_remove("targets");
        }
        let packed = |at: &Value| self.accessors.get(usize::try_from(at.as_u64()?).ok()?);
        if let Some(at) = primitive.get_mut("indices")
            && let Some(packed) = packed(at)
        {
            *at = json!(add(MarkAccessor::indices(packed)));
        }
        let mut add_all = |attributes: &mut Value, place: &StoredPositions| {
            for (name, at) in attributes.as_object_mut().into_iter().flatten() {
                let Some(packed) = packed(at) else { continue };
                *at = json!(add(MarkAccessor::attribute(packed, name, place)));
            }
        };
        if let Some(attributes) = primitive.get_mut("attributes") {
            add_all(attributes, place);
        }
        // Morph targets are displacements, so they are stored without an origin.
        let plain = StoredPositions::Single([0.0; 3]);
        let targets = primitive.get_mut("targets").and_then(Value::as_array_mut);
        targets.into_iter().flatten().for_each(|target| add_all(target, &plain));
        primitive
    }

    /// Whether a skin moves the marks.
    pub(super) fn has_skin(&self) -> bool {
        self.primitive.get("attributes").is_some_and(|attributes| attributes.get(JOINTS).is_some())
    }

    /// The number of their morph targets.
    fn n_targets(&self) -> usize {
        self.primitive.get("targets").and_then(Value::as_array).map_or(0, Vec::len)
    }

    /// Whether a skin or morph targets move the marks.
    pub(super) fn is_moved(&self) -> bool {
        self.has_skin() || self.n_targets() > 0
    }
}

/// The number of morph targets of all primitives of a part: that of its triangles, if it has triangles.
pub(super) fn n_targets(part: &Part, mesh: &Mesh) -> usize {
    if mesh.faces().is_empty() {
        return part.marks.iter().map(Marks::n_targets).max().unwrap_or(0);
    }
    targets_of(mesh).len()
}
