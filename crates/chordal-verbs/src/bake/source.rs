//! `DistanceSource`: the geometry to which distances are measured: the triangles of a shape, or its field.
use super::samples::{BakedSamples, error_from_field, off_at_most};
use super::spec::BakeSpec;
use crate::mesh::field;
use crate::mesh::tessellate::tessellate;
use crate::scene::{flatten, merged_parts};
use crate::{ImplicitShape, MeshFailure, Shape};
use chordal::budget::advice::Message;
use chordal::budget::{Bound, Evidence, Reference, RefusalCode, Tolerance};
use chordal::convert::batch::DistanceBaker;
use chordal::convert::lattices::Lattice;
use chordal::convert::{SolidReport, field_to_grid, field_to_sparse_grid};
use chordal::implicit::evaluation::SampleGrid;
use chordal::implicit::{Distance, Field};
use chordal::{Job, Mesh};
use std::sync::Arc;

/// The geometry to which distances are measured.
pub(super) struct DistanceSource {
    /// A field whose value is the distance, which is sampled itself.
    field: Option<Field>,
    /// The triangles, if they are needed.
    pub triangles: Option<SourceTriangles>,
}

/// A shape as triangles.
pub(super) struct SourceTriangles {
    pub mesh: Mesh,
    /// The bound for their distance from the shape.
    pub bound: Bound,
    /// `None` if a field is sampled instead.
    baker: Option<DistanceBaker>,
}

/// Samples before their errors are bounded.
pub(super) struct SampledDistances {
    pub samples: BakedSamples,
    pub n_within: u64,
    pub band: f64,
    /// The evidence for the signs; `None` for a field.
    pub solid: Option<SolidReport>,
}

impl DistanceSource {
    /// The triangles of a scene; other shapes are meshed within the length `within`, unless the shape is a field that is
    /// sampled itself and `needs_triangles` is false.
    ///
    /// # Errors
    /// If the shape bounds nothing; as for its conversion.
    pub fn new(
        shape: Shape,
        (within, needs_triangles): (Tolerance, bool),
        notes: &mut Vec<Message>,
        job: &Job,
    ) -> Result<Self, MeshFailure> {
        if let Shape::Scene(scene) = shape {
            let flattened = flatten::flatten(scene)?;
            notes.extend(flattened.note());
            let mesh = merged_parts::one_mesh(&flattened.scene)?.into_owned();
            let bound = Bound::proved(0.0, flattened.moved_at_most, Reference::InputTriangles);
            return Ok(Self { field: None, triangles: Some(SourceTriangles::new(mesh, bound, true, job)?) });
        }
        let (shape, field) = match shape {
            Shape::Drawing(_) | Shape::Curves(_) => {
                let message = format!("{} bound no solid to measure distances to", shape.kinds());
                return Err(MeshFailure::Usage(message.into()));
            }
            Shape::Field(implicit) => {
                if !implicit.bodies.is_empty() {
                    notes.push("the shapes of the script are baked as one, their union".into());
                }
                let united = ImplicitShape { bodies: Vec::new(), ..implicit };
                let solid = field::finite(&united)?;
                let exact = is_exact(&solid).then_some(solid);
                (Shape::Field(united), exact)
            }
            other => (other, None),
        };
        let triangles = if field.is_none() || needs_triangles {
            let tessellated = tessellate(&shape, within, shape.bounds()?, notes, job)?;
            Some(SourceTriangles::new(tessellated.shape, tessellated.bound, field.is_none(), job)?)
        } else {
            None
        };
        Ok(Self { field, triangles })
    }

    /// The kind of geometry to which the samples are distances.
    pub fn route(&self) -> &'static str {
        match (&self.field, &self.triangles) {
            (Some(_), _) => "field",
            (None, Some(triangles)) if triangles.bound.reference == Reference::InputTriangles => "triangles",
            _ => "tessellation",
        }
    }

    /// Samples the distances with the given number of cells along the longest side.
    ///
    /// # Errors
    /// As for [`DistanceBaker::grid`] and [`field_to_grid`].
    pub fn sample(&self, cells: usize, spec: &BakeSpec, job: &Job) -> Result<SampledDistances, MeshFailure> {
        let sparse = spec.band.filter(|_| spec.is_sparse);
        if let Some(field) = &self.field {
            let lattice = Lattice::for_distances(&field.bounds(), cells, spec.band)?;
            let band = spec.band.map(|width| width * lattice.spacing());
            let samples = match band.filter(|_| spec.is_sparse) {
                Some(band) => BakedSamples::Sparse(field_to_sparse_grid(field, &lattice, band, job)?.into()),
                None => BakedSamples::Dense(field_to_grid(field, &lattice, band, job)?.into()),
            };
            let band = band.unwrap_or(f64::INFINITY);
            let n_within = n_within(&samples, band);
            return Ok(SampledDistances { samples, n_within, band, solid: None });
        }
        let baker = self.triangles.as_ref().and_then(|triangles| triangles.baker.as_ref());
        let Some(baker) = baker else {
            return Err(MeshFailure::refused(RefusalCode::Empty, "there is nothing to measure distances to"));
        };
        let (samples, n_within, band, solid) = if let Some(band) = sparse {
            let baked = baker.sparse_grid(cells, band, job)?;
            (BakedSamples::Sparse(Arc::new(baked.grid)), baked.n_within, baked.band, baked.solid)
        } else {
            let baked = baker.grid(cells, spec.band, job)?;
            (BakedSamples::Dense(Arc::new(baked.grid)), baked.n_within, baked.band, baked.solid)
        };
        Ok(SampledDistances { samples, n_within, band, solid: Some(solid) })
    }

    /// A bound for the error of the samples.
    ///
    /// # Errors
    /// If a leaf fails, or the job is cancelled.
    pub fn off_at_most(&self, sampled: &SampledDistances, job: &Job) -> Result<f64, MeshFailure> {
        let samples = (&sampled.samples, sampled.band);
        match (&self.field, &self.triangles) {
            (Some(field), _) => error_from_field(field, samples, job),
            (None, Some(triangles)) => off_at_most(&triangles.mesh, samples, job),
            (None, None) => Ok(0.0),
        }
    }
}

impl SourceTriangles {
    fn new(mesh: Mesh, bound: Bound, is_sampled: bool, job: &Job) -> Result<Self, MeshFailure> {
        if mesh.faces().is_empty() {
            return Err(MeshFailure::refused(
                RefusalCode::Empty,
                "there are no triangles to measure distances to",
            ));
        }
        let baker = if is_sampled { Some(DistanceBaker::new(&mesh, job)?) } else { None };
        Ok(Self { mesh, bound, baker })
    }
}

impl SourceTriangles {
    /// Turns a bound against the triangles into one against the shape.
    pub fn then(&self, to_triangles: &Bound) -> Bound {
        // The triangles are the shape: both ends stay as they are, and only the name of the reference changes.
        if self.bound.at_most() == Some(0.0) {
            let mut bound = to_triangles.clone();
            bound.reference = self.bound.reference.clone();
            return bound;
        }
        self.bound.then(to_triangles)
    }
}

/// Whether the value of a field is the distance on both sides, proved and not only declared.
fn is_exact(field: &Field) -> bool {
    field.distance() == Distance::EXACT && field.distance_evidence() == Evidence::Proved
}

fn n_within<G: SampleGrid>(grid: &G, band: f64) -> u64 {
    let [nx, ny, nz] = grid.size();
    let rows = (0..nz).flat_map(|k| (0..ny).map(move |j| [j, k]));
    rows.map(|[j, k]| (0..nx).filter(|i| grid.sample([*i, j, k]).abs() < band).count() as u64).sum()
}
