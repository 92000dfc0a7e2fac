//! A tileset of GLB files that `chordal mesh` wrote of one shape, coarsest first, and one GLB with all of
//! them: `tileset_of_levels OUT a.glb b.glb …`.
//!
//! Each file is a level; its error is the bound in its certificate. With `--split` every level is cut in two
//! at the middle of its box, triangle by triangle: borders match within a level and not between levels, as
//! the judges of viewers need to see.
use chordal::Mesh;
use chordal::math::Box3;
use chordal_io::tiles::{Tile, Tileset, aligned_box, content_bounds, write};
use chordal_io::{Axis, Content, Format, Frame, Limits, Part, Scene, glb, snap};
use std::error::Error;
use std::path::Path;

/// A level: its triangles in the space of the file, and the error in metres.
struct Level {
    mesh: Mesh,
    error: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut args: Vec<String> = std::env::args().skip(1).collect();
    let n = args.len();
    args.retain(|arg| arg != "--split");
    let n_parts = if args.len() < n { 2 } else { 1 };
    let [folder, files @ ..] = &args[..] else {
        return Err("tileset_of_levels [--split] OUT a.glb b.glb …".into());
    };
    let levels = files.iter().map(|file| level(file)).collect::<Result<Vec<_>, _>>()?;
    let whole = levels.iter().fold(Box3::EMPTY, |all, level| all.union(level.mesh.bounds()));
    std::fs::create_dir_all(folder)?;
    let mut tops = Vec::new();
    for part in 0..n_parts {
        // From the finest level up, each tile around the ones before it.
        let mut below: Option<(Tile, Box3)> = None;
        for (depth, level) in levels.iter().enumerate().rev() {
            let uri = format!("{part}-{depth}.glb");
            let cut = whole.centre()[0];
            let mesh = part_of(&level.mesh, |x| n_parts == 1 || (x < cut) == (part == 0))?;
            let frame = Frame { up: Some(Axis::Y), metres_per_unit: Some(1.0), ..Frame::default() };
            let scene = Scene::from_mesh(&uri, snap(&mesh, Format::Glb)?.mesh, frame);
            glb::write(&scene, None, &mut std::fs::File::create(Path::new(folder).join(&uri))?)?;
            let inner = below.as_ref().map_or(Box3::EMPTY, |(_, bounds)| *bounds);
            let bounds = content_bounds(&scene)?.union(inner);
            let leaf = Tile::leaf(aligned_box(&bounds), &uri);
            let tile = match below {
                None => leaf,
                Some((child, _)) => Tile { geometric_error: level.error, children: vec![child], ..leaf },
            };
            below = Some((tile, bounds));
        }
        tops.extend(below);
    }
    let bounds = tops.iter().fold(Box3::EMPTY, |all, (_, bounds)| all.union(*bounds));
    let most = 2.0 * bounds.diagonal();
    let root = Tile {
        geometric_error: most,
        contents: Vec::new(),
        children: tops.into_iter().map(|(tile, _)| tile).collect(),
        ..Tile::leaf(aligned_box(&bounds), "")
    };
    let tileset = Tileset { geometric_error: most, root, extras: None };
    std::fs::write(Path::new(folder).join("tileset.json"), write(&tileset)?)?;
    write_beside(&levels, &Path::new(folder).join("levels.glb"))
}

/// All levels in one GLB, each at half the share of the screen of the one before.
fn write_beside(levels: &[Level], path: &Path) -> Result<(), Box<dyn Error>> {
    let frame = Frame { up: Some(Axis::Y), metres_per_unit: Some(1.0), ..Frame::default() };
    let mut meshes = levels.iter().rev().map(|level| level.mesh.clone());
    let finest = meshes.next().ok_or("no level")?;
    let scene = Scene::from_mesh("level", finest, frame);
    let coarser: Vec<Part> = meshes.map(|mesh| Part { mesh, ..Part::default() }).collect();
    let coverages = (0..=coarser.len()).map(|k| 0.5_f64.powi(k as i32 + 1)).collect();
    let levels =
        glb::GlbLevels { coarser: &[coarser], coverages: &[coverages], ..glb::GlbLevels::one(&scene) };
    glb::write_levels(&levels, &mut std::fs::File::create(path)?)?;
    Ok(())
}

fn level(file: &str) -> Result<Level, Box<dyn Error>> {
    let loaded = glb::read(&std::fs::read(file)?, &Limits::default())?;
    let Content::Scene(scene) = loaded.content else { return Err("no scene".into()) };
    let certificate = scene.certificate.as_ref();
    let bound = certificate.and_then(|certificate| certificate["bound"]["at_most"].as_f64());
    let error = bound.ok_or_else(|| format!("{file} has no certificate with a bound"))?;
    let placed = scene.world_meshes()?;
    let (_, mesh) = placed.first().ok_or_else(|| format!("{file} is empty"))?;
    Ok(Level { mesh: mesh.clone().into_owned(), error })
}

/// The triangles whose middle is where it is asked for.
fn part_of(mesh: &Mesh, is_here: impl Fn(f64) -> bool) -> Result<Mesh, Box<dyn Error>> {
    let middle = |face: &[u32; 3]| face.iter().map(|v| mesh.positions()[*v as usize][0]).sum::<f64>() / 3.0;
    let faces: Vec<[u32; 3]> = mesh.faces().iter().copied().filter(|face| is_here(middle(face))).collect();
    let mut number = vec![None; mesh.positions().len()];
    let mut positions = Vec::new();
    let faces = faces
        .iter()
        .map(|face| {
            face.map(|v| {
                *number[v as usize].get_or_insert_with(|| {
                    positions.push(mesh.positions()[v as usize]);
                    positions.len() as u32 - 1
                })
            })
        })
        .collect();
    Ok(Mesh::new(positions, faces)?)
}
