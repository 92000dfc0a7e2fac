//! The materials of fields as those of a scene.
use crate::label_looks::to_linear;
use chordal::Mesh;
use chordal::explicit::{InvalidMesh, Semantic};
use chordal::implicit::Field;
use chordal::implicit::materials::SurfaceMaterial;
use chordal_io::{MATERIAL, Scene};
use serde_json::{Value, json};

/// The mesh of a part of a scene, its faces with the numbers that the part's materials have in a list. A material that
/// is not in it yet is added.
pub(crate) fn renumber(
    mesh: Mesh,
    part: &Field,
    all: &mut Vec<SurfaceMaterial>,
) -> Result<Mesh, InvalidMesh> {
    let own = part.materials();
    let number = |material: &SurfaceMaterial| {
        let known = all.iter().position(|known| known == material);
        let at = known.unwrap_or_else(|| {
            all.push(material.clone());
            all.len() - 1
        });
        (at + 1) as f64
    };
    let numbers: Vec<f64> = std::iter::once(0.0).chain(own.iter().map(number)).collect();
    if own.is_empty() {
        return Ok(mesh);
    }
    mesh.with_only(mesh.attributes().iter().cloned().map(|mut attribute| {
        if attribute.semantic == Semantic::Group(MATERIAL.to_owned()) {
            // Whole numbers up to that of the last material.
            attribute.values.iter_mut().for_each(|x| *x = numbers[*x as usize]);
        }
        attribute
    }))
}

/// The scene with the materials that its faces number from 1, less those that none has.
pub(crate) fn with_materials(mut scene: Scene, all: &[SurfaceMaterial]) -> Result<Scene, InvalidMesh> {
    if all.is_empty() {
        return Ok(scene);
    }
    let names = std::iter::once(String::new()).chain(all.iter().map(|material| material.name.clone()));
    scene.groups.insert(MATERIAL.to_owned(), names.collect());
    scene.assets.materials = all.iter().map(gltf_material).collect();
    Ok(scene.with_used_materials()?.into_owned())
}

fn gltf_material(material: &SurfaceMaterial) -> Value {
    let [r, g, b, opacity] = material.color;
    let [r, g, b] = [r, g, b].map(to_linear);
    let base = json!({
        "baseColorFactor": [r, g, b, opacity],
        "metallicFactor": material.metallic,
        "roughnessFactor": material.roughness,
    });
    let mut object = json!({ "name": material.name, "pbrMetallicRoughness": base });
    if opacity < 1.0 {
        object["alphaMode"] = json!("BLEND");
    }
    object
}
