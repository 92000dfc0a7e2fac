//! `bake`: a signed distance grid from triangles.
use crate::geometry_digest::volume_digest;
use crate::merged_parts;
use crate::report::{BoundFacts, Certificate, DistanceGridFacts};
use crate::zero_set::zero_set_deviation;
use crate::{Input, MeshFailure, Shape, flatten, formats};
use chordal::Mesh;
use chordal::budget::{Bound, Job, Reference, RefusalCode, par_map};
use chordal::convert::mesh_to_grid;
use chordal::explicit::query::Bvh;
use chordal::implicit::Grid;
use chordal::math::{add_up, greater, sub_up};
use chordal_io::{Format, Volume, WriteError, write_volume};
use std::io::Write;

/// The lattice around a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BakeSpec {
    /// Cells along the longest side of the mesh's box.
    pub cells: usize,
    /// The narrow band in cells on either side of the surface; outside it samples are no distances. `None`:
    /// distances everywhere.
    pub band: Option<f64>,
    /// Whether the distance between the triangles and where the interpolant of the samples vanishes is proved: some
    /// tenths of a millisecond a triangle.
    pub is_bounded: bool,
}

const UNBOUNDED: &str = "nothing was proved of how far the surface of the samples is from the triangles: take smaller \
                         cells, and mend holes";

/// A distance grid with its certificate.
#[derive(Clone, Debug)]
pub struct BakeOutcome {
    /// The samples and their lattice.
    pub volume: Volume,
    /// The output format.
    pub format: Format,
    /// What is known of the grid.
    pub certificate: Certificate,
}

impl BakeOutcome {
    /// Writes the grid, and the certificate where the format carries one.
    ///
    /// # Errors
    /// When the sink fails.
    pub fn write(&self, out: &mut dyn Write) -> Result<(), WriteError> {
        write_volume(&self.volume, Some(&self.certificate.to_value()), self.format, out)
    }
}

/// Samples the signed distance to triangles on a cubic lattice, negative inside. Every distance is then
/// bounded from both sides, so that the error in the certificate is proved.
///
/// # Errors
/// When the shape has no triangles or the format holds no lattice; as for [`mesh_to_grid`].
///
/// ```
/// use chordal_io::Format;
/// use chordal_verbs::{BakeSpec, FormatHint, bake, load};
/// let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
/// let input = load(obj, FormatHint { name: Some("corner.obj"), ..FormatHint::default() }, &Default::default())?;
/// let outcome = bake(input, &BakeSpec { cells: 8, band: None, is_bounded: false }, Format::Nrrd, &Default::default())?;
/// let facts = outcome.certificate.baked.unwrap();
/// assert!(facts.solid.is_solid && facts.size == [15; 3] && facts.off_at_most < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn bake(input: Input, spec: &BakeSpec, to: Format, job: &Job) -> Result<BakeOutcome, MeshFailure> {
    if !to.holds_volumes() {
        return Err(MeshFailure::Usage(format!("{to} holds no lattice; npy and nrrd do").into()));
    }
    let mut certificate = Certificate::from_input(&input).by("bake");
    let (kind, frame) = (input.shape.kind(), *input.shape.frame());
    let Shape::Scene(scene) = input.shape else {
        return Err(MeshFailure::Usage(formats::only_triangles("baked", kind)));
    };
    let placed = flatten::flatten(scene)?;
    certificate.notes.extend(placed.note());
    let mesh = merged_parts::one_mesh(&placed.scene)?;
    if mesh.faces().is_empty() {
        return Err(MeshFailure::refused(RefusalCode::Empty, "there are no triangles to be away from"));
    }
    let baked = mesh_to_grid(&mesh, spec.cells, spec.band, job).map_err(MeshFailure::from)?;
    let off = add_up(off_at_most(&mesh, (&baked.grid, baked.band), job)?, placed.moved_at_most);
    if !baked.solid.is_solid() {
        certificate.notes.push(baked.solid.to_string().into());
    }
    if to == Format::Npy {
        certificate.notes.push("npy holds no place and no step: this report has both".into());
    }
    certificate.baked = Some(DistanceGridFacts::new(&baked, off));
    let volume = Volume { frame, ..Volume::from_grid(baked.grid) };
    let found = if spec.is_bounded { zero_set_deviation(&volume.grid, &mesh, job)? } else { None };
    if spec.is_bounded && found.is_none() {
        certificate.notes.push(UNBOUNDED.into());
    }
    // What transforms moved counts too.
    let bound = found.map(|found| match placed.moved_at_most {
        0.0 => found,
        moved => Bound::proved(0.0, moved, Reference::InputTriangles).then(&found),
    });
    certificate.bound = bound.as_ref().map(BoundFacts::new);
    // An array has no place and no step of its own.
    certificate.conclude(("volume", to), (to != Format::Npy).then(|| volume_digest(&volume)));
    Ok(BakeOutcome { volume, format: to, certificate })
}

/// The largest error of the samples that are distances: each is compared with a lower and an upper bound that
/// rounding cannot break.
pub(crate) fn off_at_most(mesh: &Mesh, (grid, band): (&Grid, f64), job: &Job) -> Result<f64, MeshFailure> {
    let bvh = Bvh::build(mesh, job).map_err(MeshFailure::from)?;
    let [nx, ny, nz] = grid.size();
    let layers: Vec<usize> = (0..nz).collect();
    let of_layer = |k: usize| {
        let mut most: f64 = 0.0;
        for row in 0..nx * ny {
            let at = [row % nx, row / nx, k];
            let value = grid.sample(at).abs();
            if job.is_cancelled() || value >= band {
                continue;
            }
            let p = grid.affine().at(at.map(|i| i as f64));
            // Nothing known on one side is no bound at all.
            let down = bvh.closest_distance_down(p).unwrap_or(f64::NEG_INFINITY);
            let up = bvh.closest_distance_up(p).unwrap_or(f64::INFINITY);
            most = greater(most, greater(sub_up(value, down), sub_up(up, value)));
        }
        most
    };
    let most = par_map(job, &layers, |_, k| of_layer(*k)).into_iter().fold(0.0, greater);
    if job.is_cancelled() { Err(MeshFailure::Cancelled) } else { Ok(most) }
}
