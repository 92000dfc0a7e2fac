//! `SolidOperand`: a shape as one closed mesh in world coordinates, with the attributes of its faces.
use crate::mesh::tessellate::{tessellate, tessellate_scene};
use crate::output::file_rows::unsupported;
use crate::scene::drop_attributes::without_attributes;
use crate::scene::merge::merge;
use crate::scene::placements::part_placements;
use crate::{ImplicitShape, Input, MeshFailure, Shape};
use chordal::budget::advice::Message;
use chordal::budget::{Bound, Reference, RefusalCode, Tolerance};
use chordal::check::{Facing, components};
use chordal::convert::mesh_to_field;
use chordal::explicit::{Semantic, Topology};
use chordal::math::greater;
use chordal::mend::nesting::NestedShells;
use chordal::mend::orient;
use chordal::{Job, Mesh};
use chordal_io::{Frame, Scene, SceneAssets};
use std::collections::BTreeMap;

/// A shape as one mesh.
pub(super) struct SolidOperand {
    /// Its triangles, with their attributes.
    pub mesh: Mesh,
    /// The bound for their distance from the true shape; `None` if they are the shape itself.
    pub bound: Option<Bound>,
    /// Names of groups, as in [`Scene`].
    pub groups: BTreeMap<String, Vec<String>>,
    pub assets: SceneAssets,
}

impl SolidOperand {
    /// Places the triangles of a scene, or meshes another shape within a length.
    ///
    /// # Errors
    /// If the shape needs a length and there is none; as for its conversion.
    pub fn new(
        input: Input,
        within: Option<Tolerance>,
        (name, notes): (&str, &mut Vec<Message>),
        job: &Job,
    ) -> Result<Self, MeshFailure> {
        let bounds = input.shape.bounds()?;
        match input.shape {
            Shape::Scene(scene) => Self::from_scene(scene, (name, notes), job),
            Shape::Drawing(_) | Shape::Curves(_) => {
                let kinds = input.shape.kinds();
                Err(MeshFailure::Usage(format!("{name}: {kinds} bound no solid").into()))
            }
            shape => {
                let Some(within) = within else {
                    let message = format!(
                        "{name}: {} become triangles within a length, and the budget has none",
                        shape.kinds()
                    );
                    return Err(MeshFailure::refused(RefusalCode::Budget, message));
                };
                if matches!(&shape, Shape::Field(implicit) if !implicit.field.materials().is_empty()) {
                    let (scene, bound) = tessellate_scene(&shape, within, bounds, notes, job)?;
                    let painted = Self::from_scene(scene, (name, notes), job)?;
                    return Ok(Self { bound: Some(bound), ..painted });
                }
                let tessellated = tessellate(&shape, within, bounds, notes, job)?;
                let (groups, assets) = Default::default();
                Ok(Self { mesh: tessellated.shape, bound: Some(tessellated.bound), groups, assets })
            }
        }
    }

    fn from_scene(
        scene: Scene,
        (name, notes): (&str, &mut Vec<Message>),
        job: &Job,
    ) -> Result<Self, MeshFailure> {
        // Joints and morph targets would no longer fit the vertices after a cut.
        let has_bones = scene.parts.iter().any(chordal_io::Part::is_deformed);
        if has_bones {
            notes.push(format!("{name}: combined at rest: skins and morph targets were left out").into());
        }
        let world_meshes = scene.world_meshes()?;
        let meshes: Vec<&Mesh> = world_meshes.iter().map(|(_, mesh)| mesh.as_ref()).collect();
        let merged = merge(&meshes)?;
        if merged.is_partial {
            notes.push(
                format!("{name}: vertex attributes that only some of its parts have were left out").into(),
            );
        }
        let is_lost = |semantic: &Semantic| matches!(semantic, Semantic::Blended(_) | Semantic::Tangent);
        let mesh = without_attributes(&merged.mesh, is_lost).map_err(unsupported)?;
        let mesh = turned_outward(mesh, (name, notes), job)?;
        let moved = part_placements(&scene)
            .iter()
            .filter(|place| !place.is_identity)
            .fold(0.0, |most, place| greater(place.rounding(&scene.parts[place.part]), most));
        let bound = (moved > 0.0).then(|| Bound::proved(0.0, moved, Reference::InputTriangles));
        Ok(Self { mesh, bound, groups: scene.groups, assets: *scene.assets })
    }
}

impl SolidOperand {
    /// Closes open triangles: the surface where their winding number is a half, as triangles within a length. These have no
    /// attributes, since the surface does not consist of the original faces any more.
    ///
    /// # Errors
    /// As for a field.
    pub fn closed(
        self,
        within: Tolerance,
        (name, notes): (&str, &mut Vec<Message>),
        job: &Job,
    ) -> Result<Self, MeshFailure> {
        let converted = mesh_to_field(&self.mesh, job)?;
        let implicit = ImplicitShape::new(converted.field, None, Frame::default());
        let bounds = implicit.bounds();
        let mut unused_notes = Vec::new();
        let closed = tessellate(&Shape::Field(implicit), within, bounds, &mut unused_notes, job)?;
        notes.push(
            format!(
                "{name}: it bounds no solid, so the points where its winding number is above a half are its solid; \
                 its attributes were left out"
            )
            .into(),
        );
        let bound = self.bound.map_or(closed.bound.clone(), |placed| placed.then(&closed.bound));
        Ok(Self {
            mesh: closed.shape,
            bound: Some(bound),
            groups: BTreeMap::new(),
            assets: SceneAssets::default(),
        })
    }
}

/// Turns a mesh if all its components are wound inside out, since it would have no inside.
fn turned_outward(
    mesh: Mesh,
    (name, notes): (&str, &mut Vec<Message>),
    job: &Job,
) -> Result<Mesh, MeshFailure> {
    let pieces = components(&mesh, Topology::Positions);
    // If only some are inside out, they may be the walls of cavities in the others.
    if pieces.is_empty() || pieces.iter().any(|component| component.facing != Facing::InsideOut) {
        return Ok(mesh);
    }
    notes.push(format!("{name}: its triangles are wound inside out and were turned").into());
    Ok(orient(&mesh, Topology::Positions, NestedShells::Keep, job)?.mesh)
}
