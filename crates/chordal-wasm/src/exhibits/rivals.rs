//! A block with a hole, written down both ways: what a mesh of it takes, and what a field.
use super::answer::ExhibitAnswer;
use super::plane::or_text;
use super::request::ExhibitRequest;
use chordal::convert::field_to_mesh;
use chordal::convert::gpu::mesh_to_gpu_buffers;
use chordal::explicit::{NormalWeight, Shading, Topology, with_normals};
use chordal::implicit::Field;
use chordal::implicit::query::{Beam, SphereTraceEnd, sphere_trace};
use chordal::implicit::shapes::{cuboid, cylinder};
use chordal::math::elementary::sin_cos;
use chordal::{Budget, Job, Tolerance};
use serde_json::json;

/// The block's sizes, and the hole's radius and length.
const BLOCK: [f64; 3] = [2.0, 2.0, 1.0];
const HOLE: [f64; 2] = [0.4, 2.0];
/// The error of the mesh.
const LENGTH: f64 = 0.01; // chosen: half a percent of the block's width
/// Edges that bend by more keep both normals.
const CREASE_RAD: f64 = 0.7; // chosen: the hole is smooth and the block's edges are not
/// The picture whose rays are counted.
const PICTURE: [u32; 2] = [96, 64];
const MOST: usize = 250; // chosen: more than any ray here takes
/// A ray that is closer to the surface has arrived.
const CLOSE: f64 = 0.001; // chosen: a tenth of the mesh's error
const AWAY: f64 = 20.0;

/// Answers `{}`.
pub(super) fn rivals(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&[])?;
    let (block, hole) = (or_text(cuboid(BLOCK))?, or_text(cylinder(HOLE[0], HOLE[1]))?);
    let part = block.difference(&hole);
    let job = Job::default();
    let budget = Budget::length(or_text(Tolerance::new(LENGTH))?);
    let meshed = |field: &Field| or_text(field_to_mesh(field, &budget, &job));
    let mesh = meshed(&part)?;
    let buffers = or_text(mesh_to_gpu_buffers(&mesh.shape, &job))?.shape;
    let shading = Shading::Crease { angle_rad: CREASE_RAD, weight: NormalWeight::Angle };
    let normals = or_text(with_normals(&mesh.shape, Topology::Indices, shading))?.positions().len();
    let operands = [meshed(&block)?, meshed(&hole)?].map(|mesh| mesh.shape.faces().len());
    let counts = ray_steps(&part)?;
    Ok(ExhibitAnswer::new(json!({
        "triangles": mesh.shape.faces().len(),
        "bytes": buffers.bytes(),
        "bound": mesh.bound.at_most(),
        "normals": normals,
        "operands": operands,
        // Each triangle of one may cut each of the other.
        "pairs": operands[0] * operands[1],
        "operations": part.tape().len(),
        "steps": counts.iter().sum::<usize>() as f64 / counts.len() as f64,
        "most_steps": counts.iter().max(),
    })))
}

/// The steps of each ray of a picture that meets the shape.
fn ray_steps(shape: &Field) -> Result<Vec<usize>, String> {
    let tape = shape.tape();
    let (sin, cos) = sin_cos(0.6); // chosen: the picture shows three sides and the hole
    let back = [0.6 * cos, -0.8 * cos, sin];
    let (right, up) = ([0.8, 0.6, 0.0], [-0.6 * sin, 0.8 * sin, cos]);
    let mut counts = Vec::new();
    for pixel in 0..PICTURE[0] * PICTURE[1] {
        let [i, j] = [pixel % PICTURE[0], pixel / PICTURE[0]].map(f64::from);
        let (x, y) = (
            3.6 * ((i + 0.5) / f64::from(PICTURE[0]) - 0.5),
            2.4 * ((j + 0.5) / f64::from(PICTURE[1]) - 0.5),
        );
        let origin = std::array::from_fn(|k| 8.0 * back[k] + x * right[k] + y * up[k]);
        let beam = Beam { origin, direction: back.map(|c| -c), from: 0.0, to: AWAY, cone: [CLOSE, 0.0] };
        let trace = or_text(sphere_trace(&tape, &beam, MOST))?;
        if matches!(trace.end, SphereTraceEnd::Arrived) {
            counts.push(trace.steps.len());
        }
    }
    if counts.is_empty() { Err("no ray meets the block".to_owned()) } else { Ok(counts) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hole_is_a_few_operations_of_a_field_and_hundreds_of_pairs_of_triangles() {
        let facts = rivals(&ExhibitRequest::parse(br#"{"exhibit": "rivals"}"#).unwrap().1).unwrap().facts;
        let number = |name: &str| facts[name].as_f64().unwrap();
        assert!(number("bound") <= LENGTH && number("triangles") > 50.0, "{facts}");
        assert!(number("pairs") >= 200.0 && number("operations") < 60.0, "{facts}");
        assert!(number("steps") > 1.0 && number("most_steps") < 250.0, "{facts}");
    }
}
