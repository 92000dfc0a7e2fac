//! The materials of fields as those of a scene.
use crate::mesh::isosurface::label_looks::to_linear;
use chordal::Mesh;
use chordal::explicit::{InvalidMesh, Semantic};
use chordal::implicit::Field;
use chordal::implicit::materials::SurfaceMaterial;
use chordal_io::{MATERIAL, Scene};
use serde_json::{Value, json};

/// The mesh of a part, with material numbers of the faces that refer to the list `all` for the whole scene. Materials that
/// are missing in the list are added.
pub(crate) fn renumber(
    mesh: Mesh,
    part: &Field,
    materials: &mut Vec<SurfaceMaterial>,
) -> Result<Mesh, InvalidMesh> {
    let part_materials = part.materials();
    let number = |material: &SurfaceMaterial| {
        let existing = materials.iter().position(|known| known == material);
        let at = existing.unwrap_or_else(|| {
            materials.push(material.clone());
            materials.len() - 1
        });
        (at + 1) as f64
    };
    let numbers: Vec<f64> = std::iter::once(0.0).chain(part_materials.iter().map(number)).collect();
    if part_materials.is_empty() {
        return Ok(mesh);
    }
    mesh.with_only(mesh.attributes().iter().cloned().map(|mut attribute| {
        if attribute.semantic == Semantic::Group(MATERIAL.to_owned()) {
            // Material numbers are whole and at most the number of the last material.
            attribute.values.iter_mut().for_each(|x| *x = numbers[*x as usize]);
        }
        attribute
    }))
}

/// The scene with the materials that its faces number from 1, without unused ones.
pub(crate) fn with_materials(mut scene: Scene, materials: &[SurfaceMaterial]) -> Result<Scene, InvalidMesh> {
    if materials.is_empty() {
        return Ok(scene);
    }
    let names = std::iter::once(String::new()).chain(materials.iter().map(|material| material.name.clone()));
    scene.groups.insert(MATERIAL.to_owned(), names.collect());
    scene.assets.materials = materials.iter().map(gltf_material).collect();
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
