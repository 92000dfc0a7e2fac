//! Volumes for Python: samples as arrays, and baked distances.
use crate::array::{Array, ArrayData};
use crate::deviation::NamedInput;
use crate::source::Source;
use crate::spec::{GivenOptions, request};
use crate::spelling::Keywords;
use crate::work::ProgressListener;
use crate::{failure, work};
use chordal::budget::advice::Spell;
use chordal_cli::spelling::CommandLine;
use chordal_io::{Format, Volume};
use chordal_verbs::options::BakeOptions;
use chordal_verbs::report::{Report, RunFacts};
use chordal_verbs::{Input, Shape, SurfaceSpec, VolumeShape, bake, sha256};
use pyo3::prelude::*;

/// Samples as an array with axes z, y, x, x fastest; the three rows of the matrix from an index (x, y, z, 1)
/// to space; and the length of a unit in metres.
#[pyfunction]
pub(crate) fn samples(py: Python<'_>, source: &Source) -> PyResult<(Array, [[f64; 4]; 3], Option<f64>)> {
    let Shape::Volume(sampled) = source.shape() else {
        return Err(failure::internal(py, "this is no volume"));
    };
    let grid = &sampled.volume.grid;
    if ArrayData::from_samples(grid.samples(), grid.size()).is_none() {
        return Err(failure::internal(py, "numpy has no such samples"));
    }
    let affine = grid.affine().rows();
    let array = Array::new(source.input(), |input| match &input.shape {
        Shape::Volume(sampled) => {
            let grid = &sampled.volume.grid;
            ArrayData::from_samples(grid.samples(), grid.size()).unwrap_or_else(ArrayData::empty)
        }
        _ => ArrayData::empty(),
    });
    Ok((array, affine, sampled.volume.frame.metres_per_unit))
}

/// Distances, the report, and why the budget was not met, if so.
pub(crate) type BakedVolume = (Source, String, Option<String>);

/// Distances to a shape on a lattice, and the report of `chordal bake` as JSON.
pub(crate) fn bake_input(
    py: Python<'_>,
    named: NamedInput,
    options: &GivenOptions,
    progress: Option<Py<PyAny>>,
) -> PyResult<BakedVolume> {
    let options: BakeOptions = request(py, options)?;
    let spec = options.spec().ok_or_else(|| failure::budget(py, "cells, tol, rel: give one of them"))?;
    let NamedInput { input, name } = named;
    let listener = ProgressListener::new(progress, "bake");
    let baked = work::run(py, listener, move |job| bake(Input::clone(&input), &spec, Format::Nrrd, job))?;
    let outcome = baked.map_err(|error| failure::mesh(py, error))?;
    let run = RunFacts { verb: "bake", input: name, ..RunFacts::default() };
    let report = Report::new(outcome.certificate.clone().spelled(&Keywords), run).to_value().to_string();
    let unmet = outcome.unmet.clone().map(|why| why.spelled(&Keywords).to_string());
    // Bytes are the command's, as its digest says.
    let outcome = outcome.spelled(&CommandLine);
    let digest = work::run(py, None, {
        let outcome = outcome.clone();
        move |_| {
            let mut bytes = Vec::new();
            outcome.write(&mut bytes).map(|()| (bytes.len() as u64, sha256(&bytes)))
        }
    })?;
    let (n_bytes, sha256) = digest.map_err(|error| failure::write(py, &error))?;
    // As in a file: with the certificate, later results include the error of the samples.
    let certificate = Some(outcome.certificate.to_value());
    let volume = Volume { certificate, ..outcome.volume.into_dense() };
    let shape = Shape::Volume(VolumeShape { volume, surface: SurfaceSpec::default() });
    let input = Input { n_bytes, digest: sha256.into(), ..Input::made(shape, Format::Nrrd) };
    Ok((Source::from_input(input, Vec::new()), report, unmet))
}
