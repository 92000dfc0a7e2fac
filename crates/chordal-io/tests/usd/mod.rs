//! USD in its three forms: what is read, what is refused, and what comes back of what is written.
mod build;
mod crates;
mod hostile;
mod materials;
mod packages;
mod round_trip;
mod shapes;
mod text;

use chordal_io::{Content, Limits, Polygons, ReadOutcome, Scene, usd};

/// Reads a text that is a shape.
fn read(text: &str) -> ReadOutcome {
    usd::read(text.as_bytes(), &Limits::default()).unwrap_or_else(|error| panic!("{error}: {text}"))
}

fn scene(text: &str) -> Scene {
    match read(text).content {
        Content::Scene(scene) => scene,
        other => panic!("no scene: {other:?}"),
    }
}

fn polygons(text: &str) -> Polygons {
    match read(text).content {
        Content::Polygons(polygons) => polygons,
        other => panic!("no cage: {other:?}"),
    }
}

/// The code and place of the error of a text.
fn error(text: &str) -> String {
    let error = usd::read(text.as_bytes(), &Limits::default()).map(|_| ()).unwrap_err();
    assert!(!error.message.is_empty());
    format!("{} at {}", error.code, error.place)
}

/// The codes of the warnings of a text.
fn codes(text: &str) -> Vec<&'static str> {
    read(text).warnings.iter().map(|warning| warning.code).collect()
}

/// A file with these prims.
fn file(prims: &str) -> String {
    format!("#usda 1.0\n(\n    metersPerUnit = 1\n    upAxis = \"Z\"\n)\n{prims}")
}

/// The properties of a triangle.
const TRIANGLE: &str = "uniform token subdivisionScheme = \"none\"
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]\n";

/// A mesh of that triangle.
fn triangle(name: &str) -> String {
    format!("def Mesh \"{name}\" {{ {TRIANGLE} }}\n")
}
