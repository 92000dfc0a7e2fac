//! The scene of a combined solid, with the materials, colours and groups of its operands.
use super::operand::SolidOperand;
use crate::MeshFailure;
use crate::output::file_rows::unsupported;
use crate::scene::merge::merge;
use chordal::Mesh;
use chordal::boolean::BooleanMesh;
use chordal::budget::advice::Message;
use chordal::explicit::{InvalidMesh, Semantic};
use chordal_io::{Frame, MATERIAL, Scene, SceneAssets, plain_material};
use std::collections::{BTreeMap, BTreeSet};

/// One part with all attributes that the faces of the operands carry.
pub(super) fn scene_of(
    solid: &BooleanMesh,
    mut operands: Vec<SolidOperand>,
    frame: Frame,
    notes: &mut Vec<Message>,
) -> Result<Scene, MeshFailure> {
    let (groups, assets) = join_groups(&mut operands)?;
    let meshes: Vec<&Mesh> = operands.iter().map(|operand| &operand.mesh).collect();
    // After the groups of all operands are numbered anew: merging keeps the numbers.
    let merged = merge(&meshes)?;
    if merged.is_partial {
        notes.push("vertex attributes that only some of the shapes have were left out".into());
    }
    let mut first_face = vec![0];
    for mesh in &meshes {
        first_face.push(first_face[first_face.len() - 1] + mesh.faces().len() as u32);
    }
    let mesh = solid.with_attributes(&merged.mesh, &first_face).map_err(unsupported)?;
    // A descriptive name; a file name would make the bytes depend on a path.
    let scene = Scene::from_mesh("boolean", mesh, frame);
    let scene = Scene { groups, assets: Box::new(assets), ..scene };
    Ok(scene.with_used_materials().map_err(unsupported)?.into_owned())
}

/// Numbers the groups of all operands as groups of one scene, and joins their materials.
fn join_groups(
    operands: &mut [SolidOperand],
) -> Result<(BTreeMap<String, Vec<String>>, SceneAssets), MeshFailure> {
    let kinds: BTreeSet<String> =
        operands.iter().flat_map(|operand| operand.groups.keys().cloned()).collect();
    let mut groups: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut assets = SceneAssets::default();
    let have_looks = operands.iter().any(|operand| !operand.assets.materials.is_empty());
    for operand in operands {
        let mut shifts: BTreeMap<String, usize> = BTreeMap::new();
        if have_looks {
            // A material that is only a name gets a plain look, so that numbers and materials agree.
            let names = operand.groups.get(MATERIAL).map_or(&[][..], |names| names);
            if operand.assets.materials.is_empty() && names.len() > 1 {
                let plain = |name: &String| {
                    let mut look = plain_material(false);
                    look["name"] = name.as_str().into();
                    look
                };
                operand.assets.materials = names[1..].iter().map(plain).collect();
            }
        }
        let n_looks = assets.append_materials(&operand.assets);
        for kind in &kinds {
            let names = operand.groups.get(kind).map_or(&[][..], |names| names);
            let joined = groups.entry(kind.clone()).or_insert_with(|| vec![String::new()]);
            let aligned = kind == MATERIAL && have_looks;
            if aligned {
                // As many names as materials, so that both have the same numbers.
                joined.resize(n_looks + 1, String::new());
            }
            shifts.insert(kind.clone(), joined.len() - 1);
            joined.extend(names.iter().skip(1).cloned());
        }
        if have_looks {
            shifts.insert(MATERIAL.to_owned(), n_looks);
        }
        operand.mesh = shifted(&operand.mesh, &shifts).map_err(unsupported)?;
    }
    if let Some(names) = groups.get_mut(MATERIAL).filter(|_| have_looks) {
        names.resize(assets.materials.len() + 1, String::new());
    }
    Ok((groups, assets))
}

/// The mesh with its groups renumbered by `shifts`; 0 stays "no group".
fn shifted(mesh: &Mesh, shifts: &BTreeMap<String, usize>) -> Result<Mesh, InvalidMesh> {
    mesh.with_only(mesh.attributes().iter().cloned().map(|mut attribute| {
        if let Semantic::Group(kind) = &attribute.semantic
            && let Some(shift) = shifts.get(kind)
        {
            attribute.values.iter_mut().filter(|x| **x > 0.0).for_each(|x| *x += *shift as f64);
        }
        attribute
    }))
}
