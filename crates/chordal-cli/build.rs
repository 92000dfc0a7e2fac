//! Puts the page of `chordal studio` into the command, where `make studio` has built it; without it there is
//! none.
use std::fs;
use std::path::{Path, PathBuf};

fn main() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studio/dist");
    println!("cargo:rerun-if-changed=build.rs");
    // A folder that is missing (in a packaged crate) would be looked for, and the command rebuilt, every
    // time.
    if folder.is_dir() {
        println!("cargo:rerun-if-changed={}", folder.display());
    }
    let page = folder.join("page");
    let mut rows = String::new();
    for (name, path) in files(&page) {
        rows += &format!("    (\"{name}\", include_bytes!({:?})),\n", path.display().to_string());
    }
    let text = format!(
        "/// Each file of the page under its name.\npub const FILES: &[(&str, &[u8])] = &[\n{rows}];\n"
    );
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("cargo sets it")).join("page.rs");
    fs::write(out, text).expect("the folder of the build can be written");
}

/// The files of the page and of its one folder of assets, in order.
fn files(page: &Path) -> Vec<(String, PathBuf)> {
    let mut all = Vec::new();
    for (prefix, folder) in [("", page.to_path_buf()), ("assets/", page.join("assets"))] {
        for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
            if entry.path().is_file()
                && let Some(name) = entry.file_name().to_str()
            {
                all.push((format!("{prefix}{name}"), entry.path()));
            }
        }
    }
    all.sort();
    all
}
