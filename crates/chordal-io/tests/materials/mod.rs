//! Materials of OBJ: libraries and pictures, into a scene and out of it.
mod corpus;
mod hostile;
mod library;
mod round_trip;

use chordal::explicit::Semantic;
use chordal_io::{Content, Format, Limits, MATERIAL, ReadOutcome, Scene, Warning, read_with};
use std::collections::BTreeMap;

/// A PNG of two by two pixels: red, green, blue, white.
pub const PNG: [u8; 75] = [
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00,
    0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x02, 0x00, 0x00, 0x00, 0xfd, 0xd4, 0x9a, 0x73, 0x00,
    0x00, 0x00, 0x12, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0xf8, 0xcf, 0xc0, 0xc0, 0x00, 0xc2, 0x0c,
    0xff, 0x81, 0x00, 0x00, 0x1f, 0xee, 0x05, 0xfb, 0xf1, 0xab, 0xba, 0x77, 0x00, 0x00, 0x00, 0x00, 0x49,
    0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82,
];

/// A JPEG as far as its frame header, of so many components.
pub fn jpeg(n_components: u8) -> Vec<u8> {
    let mut bytes = vec![0xff, 0xd8, 0xff, 0xe0, 0, 4, 1, 2, 0xff, 0xc0, 0, 11, 8, 0, 1, 0, 1, n_components];
    bytes.extend([1, 0x11, 0]);
    bytes
}

/// The start of a WebP.
pub const WEBP: &[u8] = b"RIFF\x04\0\0\0WEBP";

/// A folder of a test: names and bytes.
#[derive(Clone, Default)]
pub struct Files(pub BTreeMap<String, Vec<u8>>);

impl Files {
    pub fn with(mut self, name: &str, bytes: impl AsRef<[u8]>) -> Self {
        self.0.insert(name.to_owned(), bytes.as_ref().to_vec());
        self
    }
}

/// The scene of an OBJ in a folder, its warnings, and what was asked for, in order.
#[track_caller]
pub fn load(obj: &str, files: &Files) -> (Scene, Vec<Warning>, Vec<String>) {
    load_limited(obj, files, &Limits::default())
}

#[track_caller]
pub fn load_limited(obj: &str, files: &Files, limits: &Limits) -> (Scene, Vec<Warning>, Vec<String>) {
    let mut asked = Vec::new();
    let mut open = |path: &str| {
        asked.push(path.to_owned());
        files.0.get(path).cloned().ok_or_else(|| "no such file".to_owned())
    };
    match read_with(obj.as_bytes(), Format::Obj, &mut open, limits) {
        Ok(ReadOutcome { content: Content::Scene(scene), warnings }) => (scene, warnings, asked),
        Ok(other) => panic!("no scene: {other:?}"),
        Err(error) => panic!("{error}"),
    }
}

/// A square in a material of each name, its texture coordinates those of a whole picture.
pub fn squares(library: &str, names: &[&str]) -> String {
    let mut text = format!(
        "mtllib {library}\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n"
    );
    for name in names {
        text += &format!("usemtl {name}\nf 1/1/1 2/2/1 3/3/1 4/4/1\n");
    }
    text
}

/// The message of a warning, or nothing.
pub fn said<'a>(warnings: &'a [Warning], code: &str) -> &'a str {
    warnings.iter().find(|warning| warning.code == code).map_or("", |warning| &warning.message)
}

/// The numbers of the faces' materials.
pub fn values(scene: &Scene) -> Vec<f64> {
    let semantic = Semantic::Group(MATERIAL.to_owned());
    scene.parts[0].mesh.attribute(&semantic).map_or_else(Vec::new, |attribute| attribute.values.clone())
}
