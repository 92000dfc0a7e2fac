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
    let archive = folder.join("page.br");
    let value = match archive.is_file() {
        true => format!("Some(include_bytes!({:?}))", archive.display().to_string()),
        false => "None".into(),
    };
    let text = format!(
        "/// All files of the page as one, compressed.\npub const ARCHIVE: Option<&[u8]> = {value};\n"
    );
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("cargo sets it")).join("page.rs");
    fs::write(out, text).expect("the folder of the build can be written");
}
