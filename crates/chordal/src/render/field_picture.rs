//! `FieldPicture`: a picture of a field, and the reasons why there is none.
use super::Picture;
use crate::budget::{Camera, JobError, Refusal, RefusalCode};
use crate::implicit::LeafError;
use crate::implicit::query::{BeamCounts, FieldOctreeError};
use std::fmt;

/// A picture of a field, with its camera and the counts of its rays.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldPicture {
    /// The picture.
    pub picture: Picture,
    /// Its camera.
    pub camera: Camera,
    /// The counts of the camera rays, or of the pixels for a planar field.
    pub counts: BeamCounts,
}

/// The reason why there is no picture of a field.
#[derive(Clone, Debug)]
pub enum FieldRenderError {
    /// The rendering was refused or cancelled.
    Stopped(JobError),
    /// A leaf failed.
    Leaf(LeafError),
}

impl fmt::Display for FieldRenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stopped(stopped) => stopped.fmt(f),
            Self::Leaf(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for FieldRenderError {}

impl From<JobError> for FieldRenderError {
    fn from(stopped: JobError) -> Self {
        Self::Stopped(stopped)
    }
}

impl From<LeafError> for FieldRenderError {
    fn from(error: LeafError) -> Self {
        Self::Leaf(error)
    }
}

impl From<FieldOctreeError> for FieldRenderError {
    fn from(unbounded: FieldOctreeError) -> Self {
        match unbounded {
            FieldOctreeError::Region(_) => refusal(
                "the field has no finite box; give a region to look in, as in -1,-1,-1 to 1,1,1".to_owned(),
            ),
            FieldOctreeError::Leaf(error) => Self::Leaf(error),
        }
    }
}

pub(super) fn refusal(message: String) -> FieldRenderError {
    FieldRenderError::Stopped(JobError::Refused(Refusal::new(RefusalCode::Unsupported, message)))
}
