//! `UsdBuilder`: nodes and meshes of a scene from the prims of a stage.
use super::cage::{UsdCageBuilder, UsdCageMesh, UsdCageRules, rules};
use super::material::{UsdMaterialKey, UsdMaterials};
use super::mesh::{UsdFaceGroup, UsdFaceSubset, UsdMeshRequest, triangles};
use super::primvar::row_numbers;
use super::shape_kind::UsdShapeKind;
use super::shapes::{UsdShape, UsdShapes};
use super::stage::{StagePrim, StageSource, UsdStage};
use super::transform::{LocalTransform, compose, quaternion_matrix};
use crate::assemble::check_surfaces;
use crate::drawing::Curves;
use crate::grow::{push, push_large};
use crate::matrix::{IDENTITY, product};
use crate::text::grouped;
use crate::warnings::Warnings;
use crate::{
    Axis, Content, FileLocation, Frame, MATERIAL, Node, Part, PolygonSurface, ReadError, Scene, TextureOrigin,
};
use chordal::explicit::Semantic;
use std::collections::BTreeMap;

/// The most nodes that instances may create. Chosen: as for 3MF.
const MOST_INSTANCES: usize = 200_000;
/// The deepest nesting of instancers in prototypes. Chosen: real files have two levels.
const MOST_NESTED: usize = 4;
/// The default length of a unit. Defined by the schema: a hundredth of a metre.
const USUAL_UNIT: f64 = 0.01;
/// Types of prims without a shape of their own.
const SILENT: [&str; 8] = ["", "Xform", "Scope", "Material", "Shader", "NodeGraph", "GeomSubset", "SkelRoot"];

/// The state that a prim inherits from those above it.
#[derive(Clone, Debug)]
struct WalkContext {
    purpose: String,
    material: Option<String>,
    world: [f64; 16],
    /// The nesting depth of instances.
    nesting: usize,
}

/// Meshes with the same sources and materials are one part.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct MeshKey {
    sources: Vec<StageSource>,
    materials: Vec<u32>,
}

/// A group of faces by its name.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct UsdGroupName {
    kind: String,
    name: String,
}

/// Prims that were skipped because of their type.
#[derive(Default)]
struct UnreadPrims {
    count: u64,
    first: String,
}

pub(super) struct UsdBuilder<'s, 'a, 'b> {
    stage: &'s mut UsdStage<'a, 'b>,
    materials: UsdMaterials,
    scene: Scene,
    requests: Vec<UsdMeshRequest>,
    rules: Vec<UsdCageRules>,
    /// The matrix of each node to the world.
    worlds: Vec<[f64; 16]>,
    mesh_numbers: BTreeMap<MeshKey, usize>,
    left_out: BTreeMap<String, UnreadPrims>,
    shapes: UsdShapes,
    n_instances: usize,
    groups: BTreeMap<String, Vec<String>>,
    group_numbers: BTreeMap<UsdGroupName, u32>,
    /// Nodes whose transforms ignore their parents.
    resets: Vec<usize>,
}

impl<'s, 'a, 'b> UsdBuilder<'s, 'a, 'b> {
    pub(super) fn new(stage: &'s mut UsdStage<'a, 'b>) -> Self {
        Self {
            stage,
            materials: UsdMaterials::default(),
            scene: Scene::default(),
            requests: Vec::new(),
            rules: Vec::new(),
            worlds: Vec::new(),
            mesh_numbers: BTreeMap::new(),
            left_out: BTreeMap::new(),
            shapes: UsdShapes::default(),
            n_instances: 0,
            groups: BTreeMap::new(),
            group_numbers: BTreeMap::new(),
            resets: Vec::new(),
        }
    }

    /// The shape of the file.
    ///
    /// # Errors
    /// If the shape is damaged.
    pub(super) fn build(mut self, warnings: &mut Warnings) -> Result<Content, ReadError> {
        self.frame(warnings);
        let root = self.stage.root();
        let context =
            WalkContext { purpose: "default".to_owned(), material: None, world: IDENTITY, nesting: 0 };
        for name in self.stage.child_names(&root)? {
            if let Some(prim) = self.stage.child(&root, &name)?
                && let Some(node) = self.walk(&prim, &context)?
            {
                self.scene.roots.push(node);
            }
        }
        let resets = std::mem::take(&mut self.resets);
        self.scene.roots.extend(resets);
        let content = match (self.requests.is_empty(), self.cage_rules()?) {
            (true, _) => self.shape(warnings)?,
            (_, Some(rules)) => self.cage(rules, warnings)?,
            (_, None) => self.parts(warnings)?,
        };
        // A file is read as one kind of shape: meshes take precedence over surfaces, and these over curves.
        let kept = match &content {
            Content::Surfaces(..) => "NURBS surfaces",
            Content::Curves(_) => "curves",
            _ => "meshes",
        };
        for shape in std::mem::take(&mut self.shapes.list) {
            let is_surface = shape.kind == UsdShapeKind::NurbsPatch;
            let is_kept = match &content {
                Content::Surfaces(..) => is_surface,
                Content::Curves(_) => !is_surface,
                _ => false,
            };
            if !is_kept {
                self.leave_out(shape.kind.name(), &shape.prim);
            }
        }
        self.report(kept, warnings);
        Ok(content)
    }

    /// The surfaces or curves of a file without meshes.
    fn shape(&mut self, warnings: &mut Warnings) -> Result<Content, ReadError> {
        let frame = self.scene.frame;
        if self.shapes.has_surfaces() {
            let surfaces = self.shapes.surfaces(self.stage)?;
            check_surfaces(&surfaces, warnings)?;
            return Ok(Content::Surfaces(surfaces, frame));
        }
        if self.shapes.list.is_empty() {
            warnings.count_all("no-faces", 1, "the file shows no meshes");
            return self.parts(warnings);
        }
        let curves = self.shapes.curves(self.stage)?;
        Ok(Content::Curves(Curves { frame, certificate: self.scene.certificate.take(), ..curves }))
    }

    /// Counts a prim that is skipped because of its type.
    fn leave_out(&mut self, kind: &str, prim: &StagePrim) {
        let left_out = self.left_out.entry(kind.to_owned()).or_default();
        left_out.count += 1;
        if left_out.first.is_empty() {
            left_out.first.clone_from(&prim.path);
        }
    }

    fn frame(&mut self, warnings: &mut Warnings) {
        let about = &self.stage.layers[0].about;
        let up = if about.up_axis.as_deref() == Some("Z") { Axis::Z } else { Axis::Y };
        if about.metres_per_unit.is_none() {
            let what = "the file says no unit: it is a centimetre by USD's schema";
            warnings.count_all("no-unit", 1, what);
        }
        let unit = about.metres_per_unit.filter(|unit| *unit > 0.0).unwrap_or(USUAL_UNIT);
        self.scene.frame = Frame {
            up: Some(up),
            metres_per_unit: Some(unit),
            texture_origin: Some(TextureOrigin::LowerLeft),
        };
        self.scene.certificate.clone_from(&about.certificate);
        if let Some(why) = &about.bad_certificate {
            warnings.count("certificate-unreadable", || {
                (FileLocation::File, format!("the certificate is unreadable and was skipped: {why}"))
            });
        }
    }

    /// Creates the nodes of a prim and of those below; `None` if they show nothing.
    fn walk(&mut self, prim: &StagePrim, above: &WalkContext) -> Result<Option<usize>, ReadError> {
        if !self.stage.is_defined(prim) {
            return Ok(None);
        }
        if self.stage.is_inactive(prim) {
            self.stage.note("inactive-prims", "prims that are not active were left out", &prim.path);
            return Ok(None);
        }
        let kind = self.stage.type_name(prim).to_owned();
        if matches!(&*kind, "Material" | "Shader" | "NodeGraph" | "GeomSubset") {
            return Ok(None);
        }
        if self.stage.word(prim, "visibility")?.as_deref() == Some("invisible") {
            self.stage.note("invisible-prims", "prims that are invisible were left out", &prim.path);
            return Ok(None);
        }
        let mut context = above.clone();
        if let Some(purpose) = self.stage.word(prim, "purpose")?.filter(|purpose| purpose != "default") {
            context.purpose = purpose;
        }
        if let Some(material) = self.binding(prim) {
            context.material = Some(material);
        }
        let LocalTransform { matrix, is_reset } = self.stage.transform(prim)?;
        context.world = if is_reset { matrix } else { product(&above.world, &matrix) };
        // The node is taken before those of the children, and given back by `finish_node` if it
        // shows nothing.
        let number = self.scene.nodes.len();
        let node = Node { name: self.stage.name(prim), matrix: matrix.into(), ..Node::default() };
        push_large(&mut self.scene.nodes, node)?;
        push(&mut self.worlds, context.world)?;
        let shape = UsdShapeKind::from_type(&kind);
        let has_values = kind != "Mesh" && !self.stage.property_names(prim, "primvars:").is_empty();
        if has_values && shape.is_some() {
            let what = "values of curves and surfaces, such as colours, were left out";
            self.stage.note("shape-primvars-skipped", what, &prim.path);
        } else if has_values {
            let what = "values of prims that are no meshes, which meshes below inherit, were left out";
            self.stage.note("inherited-primvars", what, &prim.path);
        }
        match &*kind {
            "Mesh" => self.scene.nodes[number].part = self.mesh(prim, &context)?,
            "PointInstancer" => {
                self.instances(prim, &context, number)?;
                return Ok(self.finish_node(number, is_reset));
            }
            _ if SILENT.contains(&&*kind) => {}
            _ => match shape {
                Some(kind) => self.place(prim, kind, &context)?,
                None => self.leave_out(&kind, prim),
            },
        }
        for name in self.stage.child_names(prim)? {
            if let Some(child) = self.stage.child(prim, &name)?
                && let Some(child) = self.walk(&child, &context)?
            {
                push(&mut self.scene.nodes[number].children, child)?;
            }
        }
        let node = self.finish_node(number, is_reset);
        if node.is_none() && kind == "Xform" && self.stage.child_names(prim)?.is_empty() {
            self.stage.note("empty-nodes", "prims with nothing to show have no node", &prim.path);
        }
        Ok(node)
    }

    /// Stores curves or a surface with their transform.
    fn place(
        &mut self,
        prim: &StagePrim,
        kind: UsdShapeKind,
        context: &WalkContext,
    ) -> Result<(), ReadError> {
        if matches!(&*context.purpose, "proxy" | "guide") {
            let what = "shapes that stand in for others or guide the eye were left out";
            self.stage.note("purpose-skipped", what, &format!("{} ({})", prim.path, context.purpose));
            return Ok(());
        }
        let is_copy = context.nesting > 0;
        push(&mut self.shapes.list, UsdShape { prim: prim.clone(), kind, world: context.world, is_copy })
    }

    /// Removes a node that shows nothing, and detaches one whose transform ignores its parents.
    fn finish_node(&mut self, number: usize, is_reset: bool) -> Option<usize> {
        let node = &self.scene.nodes[number];
        if node.part.is_none() && node.children.is_empty() {
            // Its descendants were removed before, unless their transforms ignore their parents.
            if number + 1 == self.scene.nodes.len() {
                self.scene.nodes.pop();
                self.worlds.pop();
            }
            return None;
        }
        if is_reset {
            self.resets.push(number);
            return None;
        }
        Some(number)
    }

    /// The path of the material bound to a prim.
    fn binding(&mut self, prim: &StagePrim) -> Option<String> {
        let names = ["material:binding:preview", "material:binding:full", "material:binding"];
        let path = names.into_iter().find_map(|name| self.stage.targets(prim, name).into_iter().next());
        for name in self.stage.property_names(prim, "material:binding:collection") {
            let what = "materials of collections were left out";
            self.stage.note("collections-skipped", what, &format!("{name} of {}", prim.path));
        }
        path
    }

    /// The number of a material for a mesh; 0 for none.
    fn material(&mut self, path: Option<&String>, is_double_sided: bool) -> Result<u32, ReadError> {
        match path {
            None => Ok(0),
            Some(path) => {
                let key = UsdMaterialKey { path: path.clone(), is_double_sided };
                self.materials.number(self.stage, &key)
            }
        }
    }

    /// The group for a subset without a material.
    fn group(&mut self, subset: &StagePrim) -> Result<UsdFaceGroup, ReadError> {
        let family = self.stage.word(subset, "familyName")?.filter(|family| !family.is_empty());
        // A subset without a family corresponds to a group in other formats.
        let kind = family.filter(|family| family != "materialBind").unwrap_or_else(|| "g".to_owned());
        let name = self.stage.name(subset);
        let names = self.groups.entry(kind.clone()).or_insert_with(|| vec![String::new()]);
        let key = UsdGroupName { kind: kind.clone(), name };
        let number = *self.group_numbers.entry(key).or_insert_with_key(|key| {
            names.push(key.name.clone());
            names.len() as u32 - 1
        });
        Ok(UsdFaceGroup { kind, number })
    }

    /// The index of a mesh among the requested ones.
    fn mesh(&mut self, prim: &StagePrim, context: &WalkContext) -> Result<Option<usize>, ReadError> {
        if matches!(&*context.purpose, "proxy" | "guide") {
            let what = "shapes that stand in for others or guide the eye were left out";
            self.stage.note("purpose-skipped", what, &format!("{} ({})", prim.path, context.purpose));
            return Ok(None);
        }
        let sides = self.stage.numbers(prim, "doubleSided")?;
        let is_double_sided = sides.is_some_and(|sides| sides.first() == Some([1.0]));
        let material = self.material(context.material.as_ref(), is_double_sided)?;
        let mut subsets = Vec::new();
        for name in self.stage.child_names(prim)? {
            let Some(child) = self.stage.child(prim, &name)? else { continue };
            if self.stage.type_name(&child) != "GeomSubset" {
                continue;
            }
            let kind = self.stage.word(&child, "elementType")?.unwrap_or_else(|| "face".to_owned());
            if kind != "face" {
                let what = "subsets of points and edges were left out";
                self.stage.note("subsets-skipped", what, &child.path);
                continue;
            }
            let path = self.binding(&child);
            let material = self.material(path.as_ref(), is_double_sided)?;
            let group = if path.is_none() { Some(self.group(&child)?) } else { None };
            push(&mut subsets, UsdFaceSubset { prim: child, material, group })?;
        }
        let materials: Vec<u32> =
            std::iter::once(material).chain(subsets.iter().map(|s| s.material)).collect();
        // Sources without geometry only place it.
        let has_geometry = |source: &&StageSource| {
            let properties = &self.stage.spec(**source).properties();
            let places = ["xformOp", "material:binding", "visibility"];
            properties.iter().any(|property| !places.iter().any(|place| property.name.starts_with(place)))
        };
        // The map is left out: it only says whose paths are meant, and differs for each reference
        // to one mesh.
        let sources = prim.sources.iter().filter(has_geometry).copied();
        let key =
            MeshKey { sources: sources.map(|source| StageSource { map: 0, ..source }).collect(), materials };
        if let Some(known) = self.mesh_numbers.get(&key) {
            return Ok(Some(*known));
        }
        let texcoords =
            key.materials.iter().find_map(|material| self.materials.texcoords(*material)).cloned();
        let number = self.requests.len();
        let rules = rules(self.stage, prim)?;
        push(&mut self.rules, rules)?;
        push(&mut self.requests, UsdMeshRequest { prim: prim.clone(), material, subsets, texcoords })?;
        self.mesh_numbers.insert(key, number);
        Ok(Some(number))
    }

    /// Creates a child for each instance of a point instancer, with its prototype below.
    fn instances(&mut self, prim: &StagePrim, context: &WalkContext, node: usize) -> Result<(), ReadError> {
        if context.nesting >= MOST_NESTED {
            let message =
                format!("{}: instances are nested deeper than the limit of {MOST_NESTED}", prim.path);
            return Err(ReadError::new("too-deep", self.stage.place(prim), message));
        }
        let mut prototypes = Vec::new();
        for path in self.stage.targets(prim, "prototypes") {
            prototypes.push(self.stage.prim_at(&path)?);
        }
        let rows = |builder: &Self, name: &'static str| {
            Ok::<_, ReadError>(builder.stage.numbers(prim, name)?.map(|found| found.into_owned()))
        };
        let (at, turns, sizes) =
            (rows(self, "positions")?, rows(self, "orientations")?, rows(self, "scales")?);
        let Some(numbers) = rows(self, "protoIndices")? else { return Ok(()) };
        let hidden = rows(self, "invisibleIds")?.map(|ids| ids.values).unwrap_or_default();
        let numbers = row_numbers(&numbers.values, prototypes.len(), |row| {
            let message =
                format!("{}: prototype {} is not below {}", prim.path, numbers.values[row], prototypes.len());
            ReadError::new("index-out-of-range", super::primvar::row_place("protoIndices", row), message)
        })?;
        let n_hidden = hidden.len();
        if n_hidden > 0 {
            let what = "instances that are said to be invisible are shown";
            self.stage.note("hidden-instances", what, &prim.path);
        }
        for (i, number) in numbers.into_iter().enumerate() {
            self.n_instances += 1;
            // Prototypes with instancers of their own multiply nodes beyond the number of
            // instances.
            if self.n_instances > MOST_INSTANCES || self.scene.nodes.len() > 10 * MOST_INSTANCES {
                let limit = grouped(MOST_INSTANCES as u64);
                let message = format!("{}: instances are over the limit of {limit}", prim.path);
                return Err(ReadError::new("too-many-copies", self.stage.place(prim), message));
            }
            let turn = match turns.as_ref().and_then(|turns| turns.row::<4>(i)) {
                None => Some(IDENTITY),
                Some(turn) => quaternion_matrix(turn),
            };
            let point = at.as_ref().and_then(|at| at.row::<3>(i));
            let size = sizes.as_ref().map_or(Some([1.0; 3]), |sizes| sizes.row::<3>(i));
            let matrix = turn.zip(point).zip(size).map(|((turn, point), size)| compose(point, turn, size));
            let Some(matrix) = matrix.filter(|matrix| matrix.iter().all(|x| x.is_finite())) else {
                let message = format!("{}: instance {i} has no place, or none that is finite", prim.path);
                return Err(ReadError::new("bad-transform", self.stage.place(prim), message));
            };
            let child = self.scene.nodes.len();
            let name = format!("{}_{i}", self.stage.name(prim));
            push_large(&mut self.scene.nodes, Node { name, matrix: matrix.into(), ..Node::default() })?;
            let world = product(&context.world, &matrix);
            push(&mut self.worlds, world)?;
            let below = WalkContext { world, nesting: context.nesting + 1, ..context.clone() };
            // If the prototype is missing or shows nothing, the node stays empty and is removed
            // below.
            if let Some(prototype) = &prototypes[number as usize]
                && let Some(shown) = self.walk(prototype, &below)?
            {
                self.scene.nodes[child].children.push(shown);
            }
            if let Some(child) = self.finish_node(child, false) {
                push(&mut self.scene.nodes[node].children, child)?;
            }
        }
        Ok(())
    }

    /// The subdivision rules that all meshes share, so that they form one cage; `None` if they become
    /// triangles.
    fn cage_rules(&self) -> Result<Option<UsdCageRules>, ReadError> {
        let Some(first) = self.rules.first().copied() else { return Ok(None) };
        let forced = match self.stage.limits.surface {
            Some(PolygonSurface::Faceted) => return Ok(None),
            Some(PolygonSurface::Limit(scheme)) => Some(scheme),
            None => None,
        };
        let same = self.rules.iter().all(|rules| match forced {
            Some(_) => UsdCageRules { scheme: first.scheme, ..*rules } == first,
            None => *rules == first,
        });
        let n_cages = self.rules.iter().filter(|rules| rules.scheme.is_some()).count();
        if same && (forced.is_some() || first.scheme.is_some()) {
            return Ok(Some(UsdCageRules { scheme: forced.or(first.scheme), ..first }));
        }
        if n_cages > 0 || forced.is_some() {
            let what =
                "meshes are subdivided by different rules, or some are not: all are taken as their polygons";
            for (request, _) in
                self.requests.iter().zip(&self.rules).filter(|(_, rules)| rules.scheme.is_some())
            {
                self.stage.note("subdivision-skipped", what, &request.prim.path);
            }
        }
        Ok(None)
    }

    /// One cage of all meshes, placed by their nodes.
    fn cage(&mut self, rules: UsdCageRules, warnings: &mut Warnings) -> Result<Content, ReadError> {
        let mut builder = UsdCageBuilder::new(rules);
        for (node, world) in self.scene.nodes.iter().zip(&self.worlds) {
            let Some(part) = node.part else { continue };
            if *world != IDENTITY {
                let what = "cages have no transforms: points were moved to where nodes place them";
                self.stage.note("transforms-applied", what, &node.name);
            }
            let mesh = UsdCageMesh { request: &self.requests[part], matrix: *world };
            builder.add(self.stage, &mesh, warnings)?;
        }
        let mut polygons = builder.finish(warnings)?;
        polygons.frame = self.scene.frame;
        polygons.certificate = self.scene.certificate.take();
        polygons.groups.append(&mut self.groups);
        let materials = std::mem::take(&mut self.materials);
        if !materials.materials.is_empty() {
            let names = std::iter::once(String::new()).chain(materials.names).collect();
            polygons.groups.insert(MATERIAL.to_owned(), names);
            *polygons.assets = materials.pictures.into_assets(materials.materials);
        }
        Ok(Content::Polygons(polygons))
    }

    /// The meshes as parts.
    fn parts(&mut self, warnings: &mut Warnings) -> Result<Content, ReadError> {
        let mut number_of = Vec::new();
        for request in &self.requests {
            let mesh = triangles(self.stage, request, warnings)?;
            number_of.push(mesh.as_ref().map(|_| self.scene.parts.len()));
            if let Some(mesh) = mesh {
                let name = self.stage.name(&request.prim);
                push_large(&mut self.scene.parts, Part { name, mesh, indexed: true, ..Part::default() })?;
            }
        }
        self.scene.nodes.iter_mut().for_each(|node| node.part = node.part.and_then(|part| number_of[part]));
        let mut scene = std::mem::take(&mut self.scene);
        scene.groups.append(&mut self.groups);
        let materials = std::mem::take(&mut self.materials);
        let semantic = Semantic::Group(MATERIAL.to_owned());
        if scene.parts.iter().any(|part| part.mesh.attribute(&semantic).is_some()) {
            let names = std::iter::once(String::new()).chain(materials.names).collect();
            scene.groups.insert(MATERIAL.to_owned(), names);
            *scene.assets = materials.pictures.into_assets(materials.materials);
        }
        Ok(Content::Scene(scene))
    }

    /// Reports the notes as warnings.
    fn report(self, kept: &str, warnings: &mut Warnings) {
        let n_deletions = self.stage.layers.iter().map(|layer| layer.about.n_deletions).sum();
        if n_deletions > 0 {
            let what =
                "list edits that delete were not applied: the entries that they delete are still there";
            warnings.count_all("deletions-ignored", n_deletions, what);
        }
        let n_all: u64 = self.left_out.values().map(|left_out| left_out.count).sum();
        let listed: Vec<String> = self
            .left_out
            .iter()
            .map(|(kind, left_out)| format!("{} {kind} (first {})", grouped(left_out.count), left_out.first))
            .collect();
        warnings.count_many("prims-skipped", n_all, || {
            let message = format!("prims that are no {kept} were left out: {}", listed.join(", "));
            (FileLocation::File, message)
        });
        for layer in &self.stage.layers {
            warnings.count_many("attributes-skipped", layer.about.n_skipped, || {
                let first = layer.about.first_skipped.as_deref().unwrap_or_default();
                let message = format!("attributes that are not read were left out, {first} first");
                (FileLocation::File, message)
            });
        }
        self.stage.notes.take().report(warnings);
    }
}
