//! Indexed and unindexed: the bytes of one mesh stored both ways.
use super::answer::ExhibitAnswer;
use super::request::ExhibitRequest;
use super::shapes;
use chordal::check::validity;
use chordal::convert::gpu::mesh_to_gpu_buffers;
use chordal::convert::patches_to_mesh;
use chordal::explicit::{NormalWeight, Semantic, Shading, Topology, with_normals};
use chordal::{Budget, Job, Tolerance};
use serde_json::json;

/// The range of the tolerance; the teapot is 3 units high.
const LENGTHS: [f64; 2] = [1e-3, 1.0]; // defined: from 40,000 triangles to 300

/// Answers `{"shape": "teapot", "length": 0.05, "near": [x, y, z]}`: the teapot as triangles within that
/// length, the bytes of their buffers, and the triangles around the vertex nearest to a point.
pub(super) fn indexed(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["shape", "length", "near"])?;
    request.word("shape", &["teapot"])?;
    let length = Tolerance::new(request.number("length", LENGTHS)?).map_err(|error| error.to_string())?;
    let near = request.point::<3>("near")?;
    let job = Job::default();
    let teapot = patches_to_mesh(&shapes::teapot(), &Budget::length(length), &job)
        .map_err(|failure| failure.to_string())?;
    let smooth = with_normals(&teapot.shape, Topology::Indices, Shading::Smooth(NormalWeight::Angle))
        .map_err(|error| error.to_string())?;
    let buffers = mesh_to_gpu_buffers(&teapot.shape, &job).map_err(|failure| failure.to_string())?.shape;
    let valid = validity(&teapot.shape, Topology::Indices);
    let vertex = nearest_vertex(teapot.shape.positions(), near);
    let ring = (0_u32..).zip(teapot.shape.faces()).filter(|(_, face)| face.contains(&vertex));
    let ring: Vec<u32> = ring.map(|(face, _)| face).collect();
    let mut answer = ExhibitAnswer::default();
    let mesh = answer.mesh(&teapot.shape);
    let normals = smooth.attribute(&Semantic::Normal).map(|normals| answer.floats(&normals.values));
    answer.facts = json!({
        "mesh": mesh,
        "normals": normals,
        "triangles": buffers.indices.n_triangles(),
        "vertices": buffers.positions.len(),
        "bytes": buffers.bytes(),
        "unindexed_bytes": buffers.unindexed_bytes(),
        "times": buffers.unindexed_bytes() as f64 / buffers.bytes() as f64,
        "position_bytes": 12 * buffers.positions.len(),
        "triangles_per_vertex": valid.triangles_per_vertex,
        "vertex": { "row": vertex, "at": teapot.shape.positions()[vertex as usize], "faces": ring },
        "bound": teapot.bound.at_most(),
    });
    Ok(answer)
}

/// The index of the vertex nearest to a point; the first of several.
fn nearest_vertex(positions: &[[f64; 3]], point: [f64; 3]) -> u32 {
    let apart = |p: &[f64; 3]| (0..3).fold(0.0, |sum, k| sum + (p[k] - point[k]) * (p[k] - point[k]));
    let mut nearest = (f64::INFINITY, 0);
    for (row, p) in (0..).zip(positions) {
        if apart(p) < nearest.0 {
            nearest = (apart(p), row);
        }
    }
    nearest.1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn about_six_triangles_share_a_vertex_so_that_an_index_halves_the_bytes() {
        let question = br#"{"exhibit": "indexed", "shape": "teapot", "length": 0.004, "near": [0, 0, 3]}"#;
        let facts = indexed(&ExhibitRequest::parse(question).unwrap().1).unwrap().facts;
        let number = |name: &str| facts[name].as_f64().unwrap();
        assert!(number("bound") <= 0.004 && number("triangles") > 2000.0);
        assert_eq!(number("unindexed_bytes"), 36.0 * number("triangles"));
        assert_eq!(number("bytes"), 12.0 * number("vertices") + 6.0 * number("triangles"));
        assert!((5.5..6.0).contains(&number("triangles_per_vertex")));
        let ratio = number("unindexed_bytes") / number("bytes");
        assert!(ratio > 2.5 && ratio < 3.0, "{ratio}");
        assert!(facts["vertex"]["faces"].as_array().unwrap().len() > 2);
    }
}
