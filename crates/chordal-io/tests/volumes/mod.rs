//! Volumes: what the readers make of files that are written here byte by byte, and what the writers make of
//! volumes.
mod build;
mod corpus;
mod dicom;
mod dicom_build;
mod dicom_frames;
mod hostile;
mod mha;
mod nii;
mod npy;
mod npz;
mod nrrd;
mod slc;
mod vti;

use chordal_io::{Content, Format, Limits, Volume, Warning, read};

/// The volume of a file that must load, with its warnings.
#[track_caller]
pub fn load(bytes: &[u8], format: Format) -> (Volume, Vec<Warning>) {
    load_with(bytes, format, &Limits::default())
}

/// The same under other limits.
#[track_caller]
pub fn load_with(bytes: &[u8], format: Format, limits: &Limits) -> (Volume, Vec<Warning>) {
    let loaded = read(bytes, format, limits).unwrap_or_else(|error| panic!("{}: {error}", error.code));
    let Content::Volume(volume) = loaded.content else { panic!("no volume") };
    (volume, loaded.warnings)
}

/// All samples as numbers, the first index running fastest.
pub fn values(volume: &Volume) -> Vec<f64> {
    let samples = volume.grid.samples();
    (0..samples.len()).map(|i| samples.get(i)).collect()
}
