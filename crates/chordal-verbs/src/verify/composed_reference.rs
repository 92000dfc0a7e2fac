//! The triangles that a step read as a composition of its inputs: put together again.
use crate::output::file_rows::unsupported;
use crate::report::ComposedFacts;
use crate::scene::drop_attributes::without_attributes;
use crate::scene::flatten::{self, TransformedScene};
use crate::scene::merge::merge;
use crate::scene::placements::{largest_reach, map_rounding, scaled_up};
use crate::{Input, MeshFailure, Shape};
use chordal::explicit::Semantic;
use chordal::math::greater;
use chordal::{Job, Mesh};
use chordal_io::{Format, Frame, Node, Part, Scene, TextureOrigin};

/// Triangles that were put together again from their inputs.
pub(super) struct ComposedReference {
    pub input: Input,
    /// The largest rounding by the nodes of the inputs, stretched by the maps.
    pub nodes_rounding: f64,
    /// The largest distance of the triangles from their exact places, including the rounding by the maps.
    pub rounding: f64,
}

impl ComposedReference {
    /// Moves the inputs by their maps, in the order of their triangles, in the frame of the result; or returns the reason
    /// why that is not possible.
    pub fn new(
        facts: &ComposedFacts,
        inputs: &[&Input],
        frame: Frame,
        job: &Job,
    ) -> Result<Result<Self, String>, MeshFailure> {
        /// Bytes of memory for each triangle: it is stored once by its corners, once placed and once in one mesh.
        const PER_FACE: u64 = 200;
        let frame = Frame { texture_origin: common_origin(inputs), ..frame };
        let mut scene = Scene { frame, ..Scene::default() };
        let mut roundings = Vec::with_capacity(inputs.len());
        for input in inputs {
            let Shape::Scene(input_scene) = &input.shape else {
                return Ok(Err(format!(
                    "there is no judge of {} that were put together",
                    input.shape.kind()
                )));
            };
            let TransformedScene { scene: flattened, moved_at_most, .. } =
                flatten::flatten(input_scene.clone())?;
            let mesh = with_attributes(&flattened)?;
            scene.parts.push(Part { mesh, ..Part::default() });
            roundings.push(moved_at_most);
        }
        let (mut n_faces, mut nodes_rounding, mut rounding) = (0_u64, 0.0, 0.0);
        for place in &facts.places {
            n_faces = n_faces.saturating_add(scene.parts[place.input].mesh.faces().len() as u64);
            let stretched = scaled_up(roundings[place.input], place.longest());
            nodes_rounding = greater(stretched, nodes_rounding);
            let reach = largest_reach(&scene.parts[place.input].mesh.bounds());
            rounding = greater(stretched + map_rounding(&place.matrix(), reach), rounding);
            scene.roots.push(scene.nodes.len());
            let (matrix, part) = (place.matrix().into(), Some(place.input));
            scene.nodes.push(Node { matrix, part, ..Node::default() });
        }
        if n_faces.saturating_mul(PER_FACE) > job.memory_limit {
            return Ok(Err(format!(
                "the {n_faces} triangles of the composition need more memory than is allowed"
            )));
        }
        Ok(Ok(Self { input: Input::made(Shape::Scene(scene), Format::Ply), nodes_rounding, rounding }))
    }
}

/// All placements of a scene as one mesh, with their attributes.
fn with_attributes(scene: &Scene) -> Result<Mesh, MeshFailure> {
    let placed = scene.world_meshes()?;
    let meshes: Vec<&Mesh> = placed.iter().map(|(_, mesh)| mesh.as_ref()).collect();
    let merged = match meshes[..] {
        [single] => single.clone(),
        _ => merge(&meshes)?.mesh,
    };
    // Group numbers are local to each input, and posed meshes are in their pose already.
    let is_kept = |semantic: &Semantic| !matches!(semantic, Semantic::Group(_) | Semantic::Blended(_));
    without_attributes(&merged, |semantic| !is_kept(semantic)).map_err(|error| unsupported(error).into())
}

/// The origin of texture coordinates of all inputs; `None` if they differ, or it is unknown.
fn common_origin(inputs: &[&Input]) -> Option<TextureOrigin> {
    let mut origins = inputs.iter().map(|input| input.shape.frame().texture_origin);
    let first = origins.next()?;
    first.filter(|_| origins.all(|origin| origin == first))
}
