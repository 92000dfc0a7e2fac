//! `write`: a scene in any format that holds triangles.
use chordal_io::{Format, Scene, WriteError, glb, obj, ply, stl};
use serde_json::Value;
use std::io::Write;

/// Writes a scene, and the certificate where the format can carry it.
///
/// # Errors
/// When the sink fails, or the format cannot hold the scene.
pub fn write(
    scene: &Scene,
    certificate: Option<&Value>,
    format: Format,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    match format {
        Format::Obj => obj::write(scene, certificate, out),
        Format::Ply => ply::write(scene, certificate, out),
        Format::Stl => stl::write(scene, certificate, out),
        Format::Glb => glb::write(scene, certificate, out),
        Format::Bpt | Format::Teaset | Format::Json => {
            Err(WriteError::Unsupported(format!("{format} holds no triangles")))
        }
    }
}
