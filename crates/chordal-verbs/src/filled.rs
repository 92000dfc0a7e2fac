//! Drawings filled with triangles.
use crate::MeshFailure;
use crate::mesh::refused;
use crate::polylines::Asked;
use crate::report::Certificate;
use chordal::budget::Code;
use chordal::{Bound, Job};
use chordal_io::{Drawing, Scene};

pub(crate) fn fill(
    _drawing: Drawing,
    _asked: &Asked,
    _certificate: &mut Certificate,
    _job: &Job,
) -> Result<(Scene, Bound), MeshFailure> {
    Err(refused(Code::Unsupported, "drawings are not filled yet"))
}
