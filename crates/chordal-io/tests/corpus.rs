//! Real files: each ends in a shape, a shape with warnings, or one error that names its place.
mod common;

use chordal_io::{Content, Format, Limits, read};
use common::{data, files};

#[test]
fn every_real_file_ends_well() {
    let Some(data) = data() else { return };
    let mut counts = [0_usize; 3];
    for folder in ["mesh", "corner", "topology", "batch", "patches"] {
        for path in files(&data.join(folder)) {
            let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
            let bytes = std::fs::read(&path).expect("readable");
            let known = Format::from_extension(extension).or_else(|| Format::sniff(&bytes));
            let Some(format) = known.filter(|f| *f != Format::Glb) else { continue };
            let name = path.strip_prefix(&data).expect("below").display();
            match read(&bytes, format, &Limits::default()) {
                Ok(loaded) => {
                    // A binary STL with bytes after its end is known by its extension alone.
                    let is_odd = count(&loaded.warnings, "trailing-bytes") > 0;
                    assert!(is_odd || Format::sniff(&bytes) == Some(format), "{name} by its content");
                    let shape = match &loaded.content {
                        Content::Scene(scene) => {
                            let mesh = &scene.parts[0].mesh;
                            format!(
                                "{:>7} v {:>7} p {:>7} f",
                                mesh.positions().len(),
                                mesh.n_positions(),
                                mesh.faces().len()
                            )
                        }
                        Content::Patches(patches, _) => format!("{:>7} patches", patches.len()),
                    };
                    let warned: Vec<String> =
                        loaded.warnings.iter().map(|w| format!("{} {}", w.code, w.count)).collect();
                    counts[usize::from(!warned.is_empty())] += 1;
                    println!("{name}: {shape}  {}", warned.join(", "));
                }
                Err(error) => {
                    counts[2] += 1;
                    println!("{name}: E {}: {error}", error.code);
                    assert!(!error.message.is_empty() && !error.code.is_empty());
                }
            }
        }
    }
    println!("{} clean, {} with warnings, {} refused", counts[0], counts[1], counts[2]);
    assert!(counts.iter().sum::<usize>() > 200, "{counts:?}: too few files to judge");
}
