//! `write`: writes a scene in any format that holds triangles, or polylines in any that holds polylines.
use chordal_io::{Format, Polylines, Scene, WriteError, glb, obj, ply, shape_json, stl, svg};
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
        Format::Bpt
        | Format::Teaset
        | Format::Json
        | Format::Svg
        | Format::Vm
        | Format::Npy
        | Format::Nrrd
        | Format::Nii
        | Format::Star => Err(WriteError::Unsupported(format!("{format} holds no triangles"))),
    }
}

/// Writes polylines with the certificate.
///
/// # Errors
/// When the sink fails, or the format cannot hold the polylines.
pub fn write_polylines(
    polylines: &Polylines,
    certificate: Option<&Value>,
    format: Format,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    match format {
        Format::Json => shape_json::write(polylines, certificate, out),
        Format::Svg => svg::write(polylines, certificate, out),
        Format::Bpt
        | Format::Teaset
        | Format::Obj
        | Format::Ply
        | Format::Stl
        | Format::Glb
        | Format::Vm
        | Format::Npy
        | Format::Nrrd
        | Format::Nii
        | Format::Star => Err(WriteError::Unsupported(format!("{format} holds no polylines"))),
    }
}
