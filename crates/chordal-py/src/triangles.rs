//! Triangles from arrays that Python passes.
use chordal::Mesh;
use chordal_io::{Format, Frame, Scene};
use chordal_verbs::{Input, Shape, sha256};

/// The mesh of `numbers`, three coordinates a vertex in double precision, and `indices`, three vertices a
/// face in 32 bits, both in the byte order of the machine.
///
/// It is what the same rows in a PLY file would give. There is no file, so the digest is that of the numbers.
///
/// # Errors
/// A sentence where they are no mesh.
pub(crate) fn triangles(numbers: &[u8], indices: &[u8], frame: Frame) -> Result<Input, String> {
    let (numbers_of, odd) = numbers.as_chunks::<{ size_of::<f64>() }>();
    let (indices_of, odd_index) = indices.as_chunks::<{ size_of::<u32>() }>();
    let numbers_of: Vec<f64> = numbers_of.iter().map(|bytes| f64::from_ne_bytes(*bytes)).collect();
    let indices_of: Vec<u32> = indices_of.iter().map(|bytes| u32::from_ne_bytes(*bytes)).collect();
    let (points, half_point) = numbers_of.as_chunks::<3>();
    let (faces, half_face) = indices_of.as_chunks::<3>();
    if !(odd.is_empty() && odd_index.is_empty() && half_point.is_empty() && half_face.is_empty()) {
        return Err("three numbers a vertex and three a face".to_owned());
    }
    let mesh = Mesh::new(points.to_vec(), faces.to_vec()).map_err(|error| error.to_string())?;
    let bytes = [numbers, indices].concat();
    let shape = Shape::Scene(Scene::from_mesh("triangles", mesh, frame));
    Ok(Input {
        shape,
        format: Format::Ply,
        n_bytes: bytes.len() as u64,
        sha256: sha256(&bytes),
        files: Vec::new(),
        warnings: Vec::new(),
        letters: None,
    })
}
