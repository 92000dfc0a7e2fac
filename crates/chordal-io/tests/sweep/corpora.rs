//! The corpora of the fuzz targets: the sweep's seeds, and what fuzzing found; each is read again here.
use super::{check, seeds};
use chordal_io::{Format, Limits, tiles};
use chordal_testkit::Random;
use std::fs;
use std::path::{Path, PathBuf};

/// The target of `fuzz/fuzz_targets/` that reads a format.
fn target_of(format: Format) -> &'static str {
    match format {
        Format::Bpt => "bpt",
        Format::Bez => "bez",
        Format::Teaset => "teaset",
        Format::Json => "patch_json",
        Format::Obj => "obj",
        Format::Ply => "ply",
        Format::Stl => "stl",
        Format::Glb | Format::Gltf => "glb",
        Format::Off => "off",
        Format::ThreeMf => "threemf",
        Format::Amf => "amf",
        Format::Dae => "dae",
        Format::Vtp | Format::Vtu => "vtp",
        Format::Vtk => "vtk",
        Format::Gii => "gii",
        Format::Drc => "drc",
        Format::B3dm | Format::I3dm | Format::Cmpt => "b3dm",
        Format::Tileset => "tileset",
        Format::Usda | Format::Usdc | Format::Usdz => "usd",
        Format::Svg => "svg",
        Format::Ttf => "ttf",
        Format::Vm => "vm",
        Format::Npy => "npy",
        Format::Nrrd => "nrrd",
        Format::Nii => "nii",
        Format::Npz => "npz",
        Format::MetaImage => "mha",
        Format::Slc => "slc",
        Format::Vti => "vti",
        Format::Dicom => "dicom",
        Format::Star => "script",
    }
}

fn corpus() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus")
}

/// The files of a target, in order.
fn files_of(target: &str) -> Vec<(String, Vec<u8>)> {
    let Ok(folder) = fs::read_dir(corpus().join(target)) else { return Vec::new() };
    let mut files: Vec<_> = folder
        .map(|entry| {
            let entry = entry.expect("an entry");
            let name = format!("{target}/{}", entry.file_name().to_string_lossy());
            (name, fs::read(entry.path()).expect("readable"))
        })
        .collect();
    files.sort();
    files
}

/// The seeds lie beside the targets, so that fuzzing starts from whole files. With `CHORDAL_SEEDS=write` they are
/// written anew.
#[test]
fn the_targets_start_from_the_seeds() {
    let mut n_of = std::collections::BTreeMap::new();
    for (format, bytes) in seeds::all() {
        let n = n_of.entry(target_of(format)).or_insert(0);
        let path = corpus().join(target_of(format)).join(format!("seed_{n:02}"));
        *n += 1;
        if std::env::var("CHORDAL_SEEDS").is_ok_and(|value| value == "write") {
            fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            fs::write(&path, &bytes).expect("written");
        }
        let found = fs::read(&path).unwrap_or_default();
        assert!(found == bytes, "{} is not the seed; CHORDAL_SEEDS=write writes it", path.display());
    }
    assert!(n_of.len() >= 20, "{n_of:?}");
}

/// Every file by the readers of its target, whole, cut off anywhere and with other bits.
#[test]
fn corpora_end_well() {
    let seed = 33;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    let mut n_files = 0;
    for format in Format::all().filter(|format| *format != Format::Star) {
        for (name, bytes) in files_of(target_of(format)) {
            n_files += 1;
            check(&name, &bytes, format);
            for _ in 0..64 {
                let mut changed = bytes.clone();
                changed.truncate(random.below(bytes.len().max(1)));
                check(&name, &changed, format);
                changed.clone_from(&bytes);
                for _ in 0..1 + random.below(4) {
                    if let Some(at) = bytes.len().checked_sub(1).map(|last| random.below(last + 1)) {
                        changed[at] ^= 1 << random.below(8);
                    }
                }
                check(&name, &changed, format);
            }
        }
    }
    for target in ["sniff", "packed"] {
        for (name, bytes) in files_of(target) {
            for all in [bytes.clone(), [b"\x1f\x8b", &*bytes].concat()] {
                Format::sniff(&all).into_iter().for_each(|format| check(&name, &all, format));
            }
        }
    }
    for (name, bytes) in files_of("tileset") {
        let at = bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len());
        let read = tiles::read(&bytes[..at], &mut |_| Ok(bytes[at..].to_vec()), &Limits::default());
        assert!(read.err().is_none_or(|error| !error.message.is_empty()), "{name}");
    }
    assert!(n_files >= 40, "only {n_files} files in {}", corpus().display());
}
