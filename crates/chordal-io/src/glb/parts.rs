//! `PartReader`: reads meshes of the file into parts: vertices, triangles, attributes.
mod unshaded;

use super::accessor_rows::{AccessorError, AccessorRows};
use super::attribute_plan::{AttributePlan, PlannedAttribute, StreamSource, is_skinning};
use super::draco;
use super::format::FIRST_MODE_OF_TRIANGLES;
use super::model::{GltfAttributes, GltfMesh, GltfModel, GltfPrimitive, item};
use super::report::GlbWarnings;
use super::skin_plan::SkinPlan;
use super::triangles::{PrimitiveIndices, triangles};
use crate::draco_stream::BROKEN_STREAM;
use crate::{FileLocation, Limits, MATERIAL, Part, ReadError};
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic, position_id_by_bits};
use std::collections::BTreeMap;

/// Reads meshes into parts, within limits.
pub(super) struct PartReader<'m> {
    model: &'m GltfModel<'m>,
    /// By mesh and primitive, the group of its faces.
    material_groups: &'m [Vec<usize>],
    limits: &'m Limits,
    /// The number of bytes that may still be decoded.
    left: u64,
    pub report: GlbWarnings,
}

/// A part while it is read.
#[derive(Default)]
struct PartDraft<'m> {
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    plan: AttributePlan<'m>,
    /// The values of the planned attributes.
    streams: Vec<Vec<f64>>,
    /// The first vertex and the count of each block of vertices; primitives with the same attributes share
    /// one.
    blocks: BTreeMap<VertexKey<'m>, (usize, usize)>,
    /// The group of each face, 0 for none; empty until a face has a group.
    materials: Vec<f64>,
}

/// The accessors of a primitive's vertices.
type VertexKey<'m> = (&'m GltfAttributes<'m>, Option<&'m [GltfAttributes<'m>]>);

/// The name of normals in a primitive.
const NORMAL: &str = "NORMAL";

/// The message for attributes that are left out.
const SKIPPED: &str = "attributes that some primitives of the mesh lack or store differently were skipped";

impl<'m> PartReader<'m> {
    /// A reader for a file of which at most `left` bytes may be decoded.
    pub fn new(
        model: &'m GltfModel<'m>,
        material_groups: &'m [Vec<usize>],
        limits: &'m Limits,
        left: u64,
    ) -> Self {
        Self { model, material_groups, limits, left, report: GlbWarnings::default() }
    }

    /// Reads a mesh as a part; the part is empty if the mesh is not an object.
    pub fn part(&mut self, mesh_idx: usize) -> Result<Part, ReadError> {
        let Some(mesh) = item(&self.model.meshes, Some(mesh_idx)) else {
            return Ok(Part::default());
        };
        let mut plan = AttributePlan::from_mesh(self.model, mesh);
        self.plan_skin(&mut plan, mesh, mesh_idx)?;
        let has_targets = mesh.primitives.iter().any(|primitive| primitive.targets.is_some());
        if has_targets && !plan.streams.iter().any(|s| matches!(s.source, StreamSource::Target(..))) {
            let location = FileLocation::Pointer(format!("/meshes/{mesh_idx}"));
            let what = "morph targets that not all primitives of their mesh have were not kept";
            self.report.add("morph-targets-ignored", location, what);
        }
        let streams = plan.streams.iter().map(|_| Vec::new()).collect();
        let mut draft = PartDraft { plan, streams, ..PartDraft::default() };
        let mut unshaded = Vec::new();
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let pointer = format!("/meshes/{mesh_idx}/primitives/{p}");
            let n = draft.faces.len();
            self.primitive(&mut draft, primitive, &pointer)?;
            let group = self.material_groups.get(mesh_idx).and_then(|groups| groups.get(p));
            let n_new = draft.faces.len() - n;
            // Other primitives of the mesh have normals, so these need some too: glTF shades
            // triangles without normals flat, which takes three vertices for each.
            if draft.has_normals()
                && n_new > 0
                && primitive.attributes.iter().all(|(name, _)| *name != NORMAL)
            {
                unshaded.push(n..draft.faces.len());
                self.charge_flat_faces(&draft, n_new, &pointer)?;
            }
            let group = group.map_or(0.0, |group| *group as f64);
            // The list stays empty until a face has a group; then the faces before it get group 0.
            if group > 0.0 || !draft.materials.is_empty() {
                draft.materials.resize(n, 0.0);
                draft.materials.resize(n + n_new, group);
            }
        }
        if !unshaded.is_empty() {
            draft.shade_flat(&unshaded);
        }
        let mesh = self.finish(draft, mesh_idx)?;
        let name = item(&self.model.meshes, Some(mesh_idx)).map_or("", |mesh| mesh.name);
        Ok(Part { name: name.to_owned(), mesh, ..Part::default() })
    }

    /// Charges for the corners of flat-shaded faces, and warns of them: faces without normals, in a mesh where
    /// others have some.
    fn charge_flat_faces(
        &mut self,
        draft: &PartDraft<'m>,
        n_faces: usize,
        pointer: &str,
    ) -> Result<(), ReadError> {
        let n_rows = 3 * n_faces as u64;
        if n_rows > self.limits.rows || draft.positions.len() as u64 + n_rows >= u64::from(u32::MAX) {
            let what = format!("{n_rows} corners that are shaded flat exceed the limit of rows");
            return Err(ReadError::new("too-many-rows", FileLocation::Pointer(pointer.to_owned()), what));
        }
        self.charge(n_rows * 8 * draft.row_width() as u64, pointer)?;
        let what = "triangles without normals, in a mesh where others have some, got their own: they are shaded flat";
        let location = FileLocation::Pointer(pointer.to_owned());
        self.report.add_many("normals-of-faces", n_faces as u64, location, what);
        Ok(())
    }

    /// Plans the joint weights, unless they would take most of the bytes that may be decoded.
    fn plan_skin(
        &mut self,
        plan: &mut AttributePlan<'m>,
        mesh: &GltfMesh<'_>,
        mesh_idx: usize,
    ) -> Result<(), ReadError> {
        if self.model.skins.is_empty() {
            return Ok(());
        }
        let pointer = format!("/meshes/{mesh_idx}");
        let skin = SkinPlan::from_mesh(self.model, mesh, |n| self.charge(n, &pointer))?;
        let counts = mesh.primitives.iter().filter_map(|primitive| {
            item(&self.model.accessors, primitive.position()).and_then(|rows| rows.count)
        });
        let n_vertices = counts.fold(0_u64, u64::saturating_add);
        if n_vertices.saturating_mul(8 * skin.n_joints as u64) > self.left / 2 {
            let what = "weights of so many joints exceed the limits and were not kept";
            self.report.add("skins-ignored", FileLocation::Pointer(pointer), what);
        } else {
            plan.add_skin(skin);
        }
        Ok(())
    }

    fn primitive(
        &mut self,
        draft: &mut PartDraft<'m>,
        primitive: &'m GltfPrimitive<'m>,
        pointer: &str,
    ) -> Result<(), ReadError> {
        let position = primitive.position();
        let location = || FileLocation::Pointer(pointer.to_owned());
        let Some(mode) = primitive.mode else {
            return Err(ReadError::new("VALUE_NOT_IN_RANGE", location(), "mode is none of 0 to 6"));
        };
        if mode < FIRST_MODE_OF_TRIANGLES {
            // The reader of assets handles points and lines.
            return Ok(());
        }
        let Some(position) = position else {
            self.report.add(
                "MESH_PRIMITIVE_NO_POSITION",
                location(),
                "primitives without positions were skipped",
            );
            return Ok(());
        };
        if primitive.draco.is_some() {
            if draco::has_plain_copy(self.model, primitive) {
                self.report.add(
                    "draco-copy-ignored",
                    location(),
                    "Draco copies of plain primitives were ignored",
                );
            } else if item(&self.model.accessors, Some(position)).is_none_or(|rows| rows.unpacked.is_none()) {
                let what = "the stream of Draco that holds the triangles could not be decoded";
                return Err(ReadError::new(BROKEN_STREAM, location(), what));
            }
        }
        // Exporters often list the same accessors in several primitives that differ only in their
        // indices. Their vertices are read once, so that the primitives stay joined.
        let key = (&primitive.attributes, primitive.targets.as_deref());
        let (first, count) = match draft.blocks.get(&key) {
            Some(block) => *block,
            None => self.block(draft, primitive, position, pointer)?,
        };
        let corners = self.corners(primitive, first, count, pointer)?;
        self.charge(corners.n_triangles() * 12, pointer)?;
        let leftover = triangles(&corners, mode, &mut draft.faces);
        self.report.add_many(
            "MESH_PRIMITIVE_INCOMPATIBLE_MODE",
            leftover.unused,
            location(),
            "indices that make no whole triangle were skipped",
        );
        self.report.add_many(
            "strip-connectors",
            leftover.degenerate,
            location(),
            "triangles of strips and fans with a repeated index were skipped",
        );
        Ok(())
    }

    /// Reads the vertices of a primitive.
    fn block(
        &mut self,
        draft: &mut PartDraft<'m>,
        primitive: &'m GltfPrimitive<'m>,
        position: usize,
        pointer: &str,
    ) -> Result<(usize, usize), ReadError> {
        let (primitive_pointer, pointer) = (pointer, format!("{pointer}/attributes"));
        let rows =
            AccessorRows::new(self.model, position).map_err(|error| at(error, &pointer, "POSITION"))?;
        if rows.format.kind.n_components() != 3 {
            let unreadable = AccessorError {
                code: "MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT",
                what: format!("positions cannot be {}", rows.format),
            };
            return Err(at(unreadable, &pointer, "POSITION"));
        }
        rows.check_sparse().map_err(|error| at(error, &pointer, "POSITION"))?;
        let first = draft.positions.len();
        // Indices can address at most 2³² − 1 positions.
        if rows.count > self.limits.rows || first as u64 + rows.count >= u64::from(u32::MAX) {
            let what = format!(
                "{} vertices exceed the limit of {}",
                rows.count,
                self.limits.rows.min(u64::from(u32::MAX) - 1)
            );
            return Err(at(AccessorError { code: "too-many-rows", what }, &pointer, "POSITION"));
        }
        self.charge(rows.count * 24, &pointer)?;
        let count = rows.count as usize;
        reserve(&mut draft.positions, count, &pointer)?;
        // Adding zero removes the sign of −0, so that −0 and 0 count as the same position.
        rows.each_block(|_, numbers| {
            let (points, _) = numbers.as_chunks::<3>();
            let plain = |x: f64| rows.decode(x) + 0.0;
            draft.positions.extend(points.iter().map(|[x, y, z]| [plain(*x), plain(*y), plain(*z)]));
        });
        let mut named: BTreeMap<&str, Option<usize>> = primitive.attributes.iter().copied().collect();
        named.remove("POSITION");
        let by_name = |attributes: &'m GltfAttributes<'m>| attributes.iter().copied().collect();
        let targets: Vec<BTreeMap<&str, Option<usize>>> =
            primitive.targets.iter().flatten().map(by_name).collect();
        let PartDraft { plan, streams, .. } = draft;
        for (planned, values) in plan.streams.iter().zip(streams.iter_mut()) {
            match planned.source {
                StreamSource::Attribute(name) => {
                    let accessor = named.remove(name).flatten();
                    self.stream(planned, values, accessor, count, &format!("{pointer}/{name}"))?;
                }
                StreamSource::Target(target, name) => {
                    let accessor = targets.get(target).and_then(|attributes| *attributes.get(name)?);
                    let pointer = format!("{primitive_pointer}/targets/{target}/{name}");
                    self.stream(planned, values, accessor, count, &pointer)?;
                }
                StreamSource::Joints => {
                    self.charge(count as u64 * planned.width as u64 * 8, &pointer)?;
                    reserve(values, count * planned.width, &pointer)?;
                }
            }
        }
        let n_plain = plan.streams.iter().filter(|planned| !matches!(planned.source, StreamSource::Joints));
        let n_plain = n_plain.count();
        plan.skin.read(self.model, primitive, count, &mut streams[n_plain..]);
        for set in 0..plan.skin.n_sets {
            for family in ["JOINTS", "WEIGHTS"] {
                named.remove(format!("{family}_{set}").as_str());
            }
        }
        for name in named.keys() {
            let location = FileLocation::Pointer(format!("{pointer}/{name}"));
            if is_skinning(name) {
                self.report.add("skins-ignored", location, "skins were not applied");
            } else {
                self.report.add("attribute-skipped", location, SKIPPED);
            }
        }
        draft.blocks.insert((&primitive.attributes, primitive.targets.as_deref()), (first, count));
        Ok((first, count))
    }

    /// Reads one attribute of new vertices, or fills it with defaults if they have none.
    fn stream(
        &mut self,
        planned: &PlannedAttribute<'_>,
        values: &mut Vec<f64>,
        accessor: Option<usize>,
        count: usize,
        pointer: &str,
    ) -> Result<(), ReadError> {
        let location = || FileLocation::Pointer(pointer.to_owned());
        self.charge(count as u64 * planned.width as u64 * 8, pointer)?;
        reserve(values, count * planned.width, pointer)?;
        let Some(accessor) = accessor else {
            let what = "vertices lack an attribute that others of their mesh have";
            if planned.semantic != Semantic::Normal {
                self.report.add_many("attribute-missing", count as u64, location(), what);
            }
            values.resize(values.len() + count * planned.width, planned.default_value());
            return Ok(());
        };
        let rows = match AccessorRows::new(self.model, accessor) {
            Ok(rows)
                if rows.count == count as u64
                    && planned.accepts_width(rows.format.kind.n_components())
                    && rows.check_sparse().is_ok() =>
            {
                rows
            }
            // After strict checks only custom attributes can fail here.
            _ => {
                self.report.add("attribute-skipped", location(), SKIPPED);
                values.resize(values.len() + count * planned.width, planned.default_value());
                return Ok(());
            }
        };
        let first = values.len();
        let n = rows.format.kind.n_components();
        if n == planned.width {
            rows.each_block(|_, numbers| values.extend(numbers.iter().map(|x| rows.decode(*x))));
        } else {
            // A colour without alpha gets alpha 1.
            let value = |row: &[f64], k: usize| row.get(k).map_or(1.0, |x| rows.decode(*x));
            rows.each(|_, row| values.extend((0..planned.width).map(|k| value(row, k))));
        }
        let mut n_broken = 0;
        for x in &mut values[first..] {
            n_broken += u64::from(!x.is_finite());
            *x = if x.is_finite() { *x } else { 0.0 };
        }
        let what = "attribute values that are not finite became zero";
        self.report.add_many("attribute-not-finite", n_broken, location(), what);
        Ok(())
    }

    /// The corner indices of a primitive, as vertices of the part.
    fn corners(
        &mut self,
        primitive: &GltfPrimitive<'_>,
        first: usize,
        count: usize,
        pointer: &str,
    ) -> Result<PrimitiveIndices, ReadError> {
        // The count of positions was checked to be below 2³².
        let first_idx = first as u32;
        let Some(accessor) = primitive.indices else {
            return Ok(PrimitiveIndices::Range(first_idx, count as u32));
        };
        let rows = AccessorRows::new(self.model, accessor).map_err(|error| at(error, pointer, "indices"))?;
        rows.check_sparse().map_err(|error| at(error, pointer, "indices"))?;
        let format = rows.format;
        if format.kind.n_components() != 1 || format.component.range().0 != 0.0 || format.normalized {
            let code = "MESH_PRIMITIVE_INDICES_ACCESSOR_INVALID_FORMAT";
            return Err(at(
                AccessorError { code, what: format!("indices cannot be {format}") },
                pointer,
                "indices",
            ));
        }
        if rows.count > self.limits.rows.saturating_mul(3) {
            let what = format!("{} indices exceed the limit of {} triangles", rows.count, self.limits.rows);
            return Err(at(AccessorError { code: "too-many-rows", what }, pointer, "indices"));
        }
        self.charge(rows.count * 4, pointer)?;
        let mut list = Vec::new();
        reserve(&mut list, rows.count as usize, pointer)?;
        // The greatest number of an index type is "restart primitive", and glTF forbids it
        // everywhere.
        let (restart, limit) = (format.component.range().1, count as f64);
        let mut wrong = None;
        rows.each_block(|row, indices| {
            let is_wrong = |index: &f64| *index >= limit || *index == restart;
            // The fold has no early exit, so that a block of indices is compared several at once;
            // a wrong one is searched for only then.
            if wrong.is_none() && indices.iter().fold(false, |any, index| any | is_wrong(index)) {
                let first = indices.iter().position(is_wrong);
                wrong = first.map(|i| (row + i as u64, indices[i]));
            }
            // In range, or the list is discarded below.
            list.extend(indices.iter().map(|index| first_idx.saturating_add(*index as u32)));
        });
        if let Some((i, index)) = wrong {
            let (code, what) = if index == restart {
                ("ACCESSOR_INDEX_PRIMITIVE_RESTART", format!("index {i} is {index}, which means \"restart\""))
            } else {
                ("ACCESSOR_INDEX_OOB", format!("index {i} is {index}, there are {count} vertices"))
            };
            return Err(at(AccessorError { code, what }, pointer, "indices"));
        }
        Ok(PrimitiveIndices::List(list))
    }

    /// Charges bytes that are about to be decoded.
    fn charge(&mut self, n: u64, pointer: &str) -> Result<(), ReadError> {
        match self.left.checked_sub(n) {
            Some(left) => {
                self.left = left;
                Ok(())
            }
            None => {
                let what =
                    format!("the decoded data exceeds the limits: {n} bytes more, {} are left", self.left);
                Err(ReadError::new("too-large", FileLocation::Pointer(pointer.to_owned()), what))
            }
        }
    }

    fn finish(&mut self, mut draft: PartDraft<'m>, mesh_idx: usize) -> Result<Mesh, ReadError> {
        let location = || FileLocation::Pointer(format!("/meshes/{mesh_idx}"));
        let broken = draft.positions.iter().position(|p| p.iter().any(|x| !x.is_finite()));
        if let Some(vertex) = broken {
            if !self.limits.drop_nonfinite {
                let what = format!("vertex {vertex} is {:?}", draft.positions[vertex]);
                return Err(ReadError::new("ACCESSOR_INVALID_FLOAT", location(), what));
            }
            let dropped = draft.drop_nonfinite();
            let what = "vertices that are not finite were dropped with their faces";
            self.report.add_many("not-finite", dropped, location(), what);
        }
        let mut materials = draft.materials;
        let has_material = materials.iter().any(|material| *material != 0.0);
        let ids = exact_ties(&draft.positions);
        let refused = |error: chordal::explicit::InvalidMesh| {
            ReadError::new(
                "invalid-mesh",
                FileLocation::Pointer(format!("/meshes/{mesh_idx}")),
                error.to_string(),
            )
        };
        let mut mesh = Mesh::new(draft.positions, draft.faces).map_err(refused)?;
        if let Some(ids) = ids {
            mesh = mesh.with_position_id(ids).map_err(refused)?;
        }
        for (planned, values) in draft.plan.streams.into_iter().zip(draft.streams) {
            let (semantic, width) = (planned.semantic, planned.width);
            let attribute = Attribute { semantic, domain: Domain::Vertex, width, values };
            mesh = mesh.with_attribute(attribute).map_err(refused)?;
        }
        if has_material {
            let semantic = Semantic::Group(MATERIAL.to_owned());
            let values = std::mem::take(&mut materials);
            let attribute = Attribute { semantic, domain: Domain::Face, width: 1, values };
            mesh = mesh.with_attribute(attribute).map_err(refused)?;
        }
        Ok(mesh)
    }
}

impl PartDraft<'_> {
    /// Removes vertices that are not finite, with their faces. Returns the number of removed vertices.
    fn drop_nonfinite(&mut self) -> u64 {
        let keep: Vec<bool> = self.positions.iter().map(|p| p.iter().all(|x| x.is_finite())).collect();
        let mut renumbered = Vec::with_capacity(keep.len());
        let mut n_kept = 0_u32;
        for kept in &keep {
            renumbered.push(n_kept);
            n_kept += u32::from(*kept);
        }
        let is_whole: Vec<bool> = self.faces.iter().map(|f| f.iter().all(|i| keep[*i as usize])).collect();
        let mut keeps = is_whole.iter();
        self.faces.retain(|_| keeps.next() == Some(&true));
        let mut keeps = is_whole.iter();
        self.materials.retain(|_| keeps.next() == Some(&true));
        self.faces.iter_mut().for_each(|face| *face = face.map(|i| renumbered[i as usize]));
        for (planned, values) in self.plan.streams.iter().zip(&mut self.streams) {
            let width = planned.width;
            let mut indices = 0..;
            values.retain(|_| indices.next().is_some_and(|i: usize| keep[i / width]));
        }
        let n = self.positions.len();
        let mut kept = keep.iter();
        self.positions.retain(|_| kept.next() == Some(&true));
        (n - self.positions.len()) as u64
    }
}

/// For each vertex the first one at the bit-identical position; `None` if no two share one. There is no −0.
fn exact_ties(positions: &[[f64; 3]]) -> Option<Vec<u32>> {
    let ids = position_id_by_bits(positions);
    let is_tied = (0..).zip(&ids).any(|(row, id)| row != *id);
    is_tied.then_some(ids)
}

fn at(error: AccessorError, pointer: &str, key: &str) -> ReadError {
    ReadError::new(error.code, FileLocation::Pointer(format!("{pointer}/{key}")), error.what)
}

/// Reserves memory for the rows of a block: exactly for the first block, with spare capacity for later ones.
fn reserve<T>(list: &mut Vec<T>, n: usize, pointer: &str) -> Result<(), ReadError> {
    let reserved = if list.is_empty() { list.try_reserve_exact(n) } else { list.try_reserve(n) };
    reserved.map_err(|_| {
        let what = format!("{n} rows take more memory than there is");
        ReadError::new("out-of-memory", FileLocation::Pointer(pointer.to_owned()), what)
    })
}
