//! What a step read that put its inputs together: put together again.
use crate::drop_attributes::without_attributes;
use crate::file_rows::unsupported;
use crate::flatten::{self, TransformedScene};
use crate::merge::merge;
use crate::placements::{largest_reach, map_rounding, scaled_up};
use crate::report::ComposedFacts;
use crate::{Input, MeshFailure, Shape};
use chordal::explicit::Semantic;
use chordal::math::greater;
use chordal::{Job, Mesh};
use chordal_io::{Format, Frame, Node, Part, Scene, TextureOrigin};

/// Triangles that were put together again.
pub(super) struct ComposedReference {
    pub input: Input,
    /// How far the nodes of the inputs may have rounded them, where the maps take that.
    pub off: f64,
    /// How far all of it may be from where exact numbers would take it, the maps included.
    pub rounding: f64,
}

impl ComposedReference {
    /// The inputs where the maps take them, in the order of their triangles, in the frame of the result; or why not, in a
    /// sentence.
    pub fn new(
        facts: &ComposedFacts,
        inputs: &[&Input],
        frame: Frame,
        job: &Job,
    ) -> Result<Result<Self, String>, MeshFailure> {
        /// Bytes of memory for each triangle of the whole: it is there once by its corners, once placed and once in one mesh.
        const PER_FACE: u64 = 200;
        let frame = Frame { texture_origin: common_origin(inputs), ..frame };
        let mut scene = Scene { frame, ..Scene::default() };
        let mut offs = Vec::with_capacity(inputs.len());
        for input in inputs {
            let Shape::Scene(own) = &input.shape else {
                return Ok(Err(format!(
                    "there is no judge of {} that were put together",
                    input.shape.kind()
                )));
            };
            let TransformedScene { scene: placed, moved_at_most, .. } = flatten::flatten(own.clone())?;
            let mesh = with_attributes(&placed)?;
            scene.parts.push(Part { mesh, ..Part::default() });
            offs.push(moved_at_most);
        }
        let (mut n_faces, mut off, mut rounding) = (0_u64, 0.0, 0.0);
        for place in &facts.places {
            n_faces = n_faces.saturating_add(scene.parts[place.input].mesh.faces().len() as u64);
            let own = scaled_up(offs[place.input], place.longest());
            off = greater(own, off);
            let reach = largest_reach(&scene.parts[place.input].mesh.bounds());
            rounding = greater(own + map_rounding(&place.matrix(), reach), rounding);
            scene.roots.push(scene.nodes.len());
            let (matrix, part) = (place.matrix().into(), Some(place.input));
            scene.nodes.push(Node { matrix, part, ..Node::default() });
        }
        if n_faces.saturating_mul(PER_FACE) > job.memory_limit {
            return Ok(Err(format!(
                "the {n_faces} triangles of what was put together need more memory than is allowed"
            )));
        }
        Ok(Ok(Self { input: Input::made(Shape::Scene(scene), Format::Ply), off, rounding }))
    }
}

/// All that a scene shows as one mesh, with what its corners carry.
fn with_attributes(scene: &Scene) -> Result<Mesh, MeshFailure> {
    let all = scene.world_meshes()?;
    let meshes: Vec<&Mesh> = all.iter().map(|(_, mesh)| mesh.as_ref()).collect();
    let whole = match meshes[..] {
        [one] => one.clone(),
        _ => merge(&meshes)?.mesh,
    };
    // Groups are numbered by each input on its own, and what was posed stands in its pose.
    let is_kept = |semantic: &Semantic| !matches!(semantic, Semantic::Group(_) | Semantic::Blended(_));
    without_attributes(&whole, |semantic| !is_kept(semantic)).map_err(|error| unsupported(error).into())
}

/// Where texture coordinates of all inputs begin; `None` where they differ, or nothing says it.
fn common_origin(inputs: &[&Input]) -> Option<TextureOrigin> {
    let mut origins = inputs.iter().map(|input| input.shape.frame().texture_origin);
    let first = origins.next()?;
    first.filter(|_| origins.all(|origin| origin == first))
}
