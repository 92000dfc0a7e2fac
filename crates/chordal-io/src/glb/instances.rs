//! Reads `EXT_mesh_gpu_instancing`: a node that shows its mesh many times gets a child for each instance.
//!
//! Source: J. Cooke, D. McCurdy and A. Kapoulkine, *EXT_mesh_gpu_instancing*, Khronos Group, 2022.
use super::INSTANCING;
use super::accessor_rows::{AccessorError, AccessorRows};
use super::format::{AccessorFormat, AccessorType, ComponentType};
use super::lint::is_unit_quaternion;
use super::model::{GltfAttributes, GltfModel, GltfNode};
use super::report::GlbWarnings;
use super::trs::compose;
use crate::{Conformance, FileLocation, Limits, Node, PackedAccessor, ReadError, Scene};
use serde_json::{Map, Value, json};

/// The most bytes of a node, and of its properties if it has any. Derived: a node is about 300 bytes with its
/// entry in the list of its parent; three lists of JSON numbers are below 2,000.
const NODE_BYTES: u64 = 512;
const PROPERTY_BYTES: u64 = 2048;

/// The transforms of the instances of one node.
#[derive(Default)]
struct InstanceRows<'m> {
    count: Option<u64>,
    translation: Option<AccessorRows<'m>>,
    rotation: Option<AccessorRows<'m>>,
    scale: Option<AccessorRows<'m>>,
}

/// Adds the instances of the file's nodes to a scene, each as a child that shows the node's part; `number_of`
/// is the index in the scene of each kept node. At most `left` bytes may be used; returns how many are left.
///
/// # Errors
/// At an attribute whose format, count or numbers cannot place a mesh, or if a limit is exceeded.
pub(super) fn place(
    scene: &mut Scene,
    model: &GltfModel<'_>,
    number_of: &[Option<usize>],
    limits: (&Limits, u64),
    report: &mut GlbWarnings,
) -> Result<u64, ReadError> {
    let (limits, mut left) = limits;
    for (i, node) in model.nodes.iter().enumerate() {
        let attributes = node.as_ref().and_then(GltfNode::instances);
        let (Some(attributes), Some(at)) = (attributes, number_of.get(i).copied().flatten()) else {
            continue;
        };
        let pointer = format!("/nodes/{i}/extensions/{INSTANCING}");
        let Some(part) = scene.nodes[at].part.filter(|_| !attributes.is_empty()) else {
            let what = "a node without a mesh, or without places for it, has no instances";
            report.add("instances-ignored", FileLocation::Pointer(pointer), what);
            continue;
        };
        let pointer = format!("{pointer}/attributes");
        let rows = InstanceRows::new(model, attributes, &pointer, report)?;
        let count = rows.count.unwrap_or(0);
        let refused =
            |code, what: String| Err(ReadError::new(code, FileLocation::Pointer(pointer.clone()), what));
        // Checked before a node is made: an accessor without a view takes no bytes of the file,
        // however many rows it claims.
        if count.saturating_add(scene.nodes.len() as u64) > limits.rows {
            return refused(
                "too-many-rows",
                format!("{count} instances exceed the limit of {} nodes", limits.rows),
            );
        }
        for row in 0..count {
            let instance = rows.node(row, part, &pointer, (limits, &mut *report))?;
            let bytes = NODE_BYTES + if instance.properties.is_empty() { 0 } else { PROPERTY_BYTES };
            let Some(rest) = left.checked_sub(bytes) else {
                return refused("too-large", format!("{count} instances take more memory than the limit"));
            };
            left = rest;
            let child = scene.nodes.len();
            scene.nodes[at].children.push(child);
            scene.nodes.push(instance);
        }
        // The node itself is no instance: from now on only its children show the part.
        scene.nodes[at].part = None;
    }
    Ok(left)
}

impl<'m> InstanceRows<'m> {
    fn new(
        model: &'m GltfModel<'_>,
        attributes: &GltfAttributes<'_>,
        pointer: &str,
        report: &mut GlbWarnings,
    ) -> Result<Self, ReadError> {
        let mut out = Self::default();
        for (name, accessor) in attributes {
            let place = || FileLocation::Pointer(format!("{pointer}/{name}"));
            let refused = |AccessorError { code, what }| ReadError::new(code, place(), what);
            let Some(accessor) = accessor else {
                let what = "there is no accessor with this number".to_owned();
                return Err(refused(AccessorError { code: "UNRESOLVED_REFERENCE", what }));
            };
            let rows = AccessorRows::new(model, *accessor).map_err(refused)?;
            rows.check_sparse().map_err(refused)?;
            let count = *out.count.get_or_insert(rows.count);
            if count != rows.count {
                let what = format!("{} rows where other attributes have {count}", rows.count);
                return Err(refused(AccessorError { code: "instances-unequal", what }));
            }
            let slot = match *name {
                "TRANSLATION" => &mut out.translation,
                "ROTATION" => &mut out.rotation,
                "SCALE" => &mut out.scale,
                _ => {
                    let what = "attributes of instances beside their places are kept only where instances are written as such";
                    report.add("instance-attribute-skipped", place(), what);
                    continue;
                }
            };
            if !is_allowed(name, rows.format) {
                let what = format!("{name} of instances cannot be {}", rows.format);
                return Err(refused(AccessorError { code: "instances-format", what }));
            }
            *slot = Some(rows);
        }
        Ok(out)
    }

    /// The node of one instance.
    fn node(
        &self,
        row: u64,
        part: usize,
        pointer: &str,
        how: (&Limits, &mut GlbWarnings),
    ) -> Result<Node, ReadError> {
        let (limits, report) = how;
        let numbers = |rows: &Option<AccessorRows<'m>>, usual: [f64; 4]| match rows {
            None => usual,
            Some(rows) => std::array::from_fn(|k| {
                if k < rows.format.kind.n_components() { rows.normalized(row, k) } else { 0.0 }
            }),
        };
        let [x, y, z, _] = numbers(&self.translation, [0.0; 4]);
        let [sx, sy, sz, _] = numbers(&self.scale, [1.0; 4]);
        let turned = numbers(&self.rotation, [0.0, 0.0, 0.0, 1.0]);
        if [x, y, z, sx, sy, sz].iter().chain(&turned).any(|x| !x.is_finite()) {
            let place = FileLocation::Pointer(pointer.to_owned());
            let what = format!("instance {row} is placed by numbers that are not finite");
            return Err(ReadError::new("ACCESSOR_INVALID_FLOAT", place, what));
        }
        if !is_unit_quaternion(&turned) {
            let place = FileLocation::Pointer(format!("{pointer}/ROTATION"));
            let what = format!("the quaternion of instance {row} is not normalized");
            if limits.conformance == Conformance::Strict || turned == [0.0; 4] {
                return Err(ReadError::new("ROTATION_NON_UNIT", place, what));
            }
            report.add("ROTATION_NON_UNIT", place, what);
        }
        let rotation = unit_rotation(turned);
        let (translation, scale) = ([x, y, z], [sx, sy, sz]);
        let matrix = compose(translation, rotation, scale);
        let mut node = Node { matrix: matrix.into(), part: Some(part), ..Node::default() };
        if scale.contains(&0.0) {
            // Writers cannot decompose such a matrix into a rotation and a scale.
            node.properties.insert("translation".to_owned(), json!(translation));
            node.properties.insert("rotation".to_owned(), json!(rotation));
            node.properties.insert("scale".to_owned(), json!(scale));
        }
        Ok(node)
    }
}

/// A rotation of length 1: quantized quaternions are slightly off, which would shear the mesh.
fn unit_rotation(turned: [f64; 4]) -> [f64; 4] {
    let length = turned.iter().map(|x| x * x).sum::<f64>().sqrt();
    turned.map(|x| x / length)
}

/// The matrices of the instances with these attributes, given by indices into `accessors`; bit for bit those
/// of the nodes that [`place`] creates. `None` if data is missing.
pub(super) fn places(
    attributes: &Map<String, Value>,
    accessors: &[PackedAccessor],
) -> Option<Vec<[f64; 16]>> {
    let rows = |name: &str, usual: [f64; 4]| match attributes.get(name) {
        None => Some(Err(usual)),
        Some(at) => packed_rows(accessors.get(usize::try_from(at.as_u64()?).ok()?)?).map(Ok),
    };
    let lists =
        [rows("TRANSLATION", [0.0; 4])?, rows("ROTATION", [0.0, 0.0, 0.0, 1.0])?, rows("SCALE", [1.0; 4])?];
    let n = lists.iter().filter_map(|list| list.as_ref().ok()).map(Vec::len).next()?;
    if lists.iter().flatten().any(|list| list.len() != n) {
        return None;
    }
    let row = |list: &Result<Vec<[f64; 4]>, [f64; 4]>, i: usize| {
        list.as_ref().map_or_else(|usual| *usual, |list| list[i])
    };
    let matrix = |i: usize| {
        let [[x, y, z, _], turned, [sx, sy, sz, _]] = lists.each_ref().map(|list| row(list, i));
        compose([x, y, z], unit_rotation(turned), [sx, sy, sz])
    };
    Some((0..n).map(matrix).collect())
}

/// The rows of a passed-through accessor; if it has three components, the fourth is 0.
fn packed_rows(accessor: &PackedAccessor) -> Option<Vec<[f64; 4]>> {
    let component = ComponentType::from_code(accessor.properties.get("componentType")?.as_u64()?)?;
    let width = AccessorType::from_name(accessor.properties.get("type")?.as_str()?)?.n_components();
    let is_normalized = accessor.properties.get("normalized").and_then(Value::as_bool).unwrap_or(false);
    if !matches!(width, 3 | 4) {
        return None;
    }
    let size = usize::try_from(component.size()).ok()?;
    let number = |bytes: &[u8]| {
        let x = component.number(bytes);
        if is_normalized { component.normalize(x) } else { x }
    };
    let rows = accessor.bytes.chunks_exact(size * width);
    Some(
        rows.map(|row| {
            std::array::from_fn(|k| if k < width { number(&row[k * size..][..size]) } else { 0.0 })
        })
        .collect(),
    )
}

/// Whether an attribute may have this format.
fn is_allowed(name: &str, format: AccessorFormat) -> bool {
    use AccessorType::{Vec3, Vec4};
    use ComponentType::{F32, I8, I16};
    let formats: &[AccessorFormat] = match name {
        "ROTATION" => &[
            AccessorFormat::plain(Vec4, F32),
            AccessorFormat::normalized(Vec4, I8),
            AccessorFormat::normalized(Vec4, I16),
        ],
        _ => &[AccessorFormat::plain(Vec3, F32)],
    };
    formats.contains(&format)
}
