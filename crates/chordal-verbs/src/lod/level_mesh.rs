//! `LevelMesh`: a level or a tile in the form in which it will be written.
use chordal::budget::Bound;
use chordal_io::Scene;

/// One level in the form in which it will be written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LevelMesh {
    pub scene: Scene,
    pub bound: Bound,
    pub triangles: u64,
    pub vertices: u64,
}

impl LevelMesh {
    pub fn error(&self) -> f64 {
        self.bound.at_most().unwrap_or(f64::INFINITY)
    }
}

/// The numbers of triangles and of rows of positions.
pub(super) fn counts(scene: &Scene) -> (u64, u64) {
    scene.parts.iter().fold((0, 0), |(t, v), part| {
        (t + part.mesh.faces().len() as u64, v + part.mesh.positions().len() as u64)
    })
}
