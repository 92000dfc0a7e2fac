//! `FrameFacts`: where one frame is and what its numbers mean, as far as a file, all of its frames, or the
//! frame itself says.
//!
//! A file of one slice has these attributes at its top. Enhanced CT and MR have them in groups that hold for
//! all frames or for one.
//!
//! Source: NEMA, *DICOM PS3.3*, 2024, C.7.6.16.
use super::attributes::{
    DicomAttributes, DicomTag, FRAME_CONTENT, INTERCEPT, ORIENTATION, PIXEL_MEASURES, PLANE_ORIENTATION,
    PLANE_POSITION, POSITION, SEGMENT_OF_FRAME, SEGMENT_REFERENCE, SLOPE, SPACING, SPACING_BETWEEN, STACK,
    TIME_INDEX, VALUE_TRANSFORMATION,
};
use crate::ReadError;

/// Attributes of a frame.
#[derive(Clone, Debug, Default)]
pub(super) struct FrameFacts {
    pub position: Option<[f64; 3]>,
    /// The directions of rows and of columns.
    pub orientation: Option<[f64; 6]>,
    /// The distance of rows, and of columns.
    pub spacing: Option<[f64; 2]>,
    /// The distance of slices.
    pub between: Option<f64>,
    pub slope: Option<f64>,
    pub inter: Option<f64>,
    /// The stack that the frame belongs to, and its place in time.
    pub stack: Option<String>,
    pub time: Option<u32>,
    /// The segment that the frame is a mask of.
    pub segment: Option<u16>,
}

impl FrameFacts {
    /// The facts at the top of a file.
    pub(super) fn of_file(file: &DicomAttributes<'_>) -> Result<Self, ReadError> {
        let mut facts = Self::default();
        facts.take_plane(file)?;
        facts.take_measures(file)?;
        facts.take_values(file)?;
        Ok(facts)
    }

    /// The facts in the groups of one item, for all frames or for one.
    pub(super) fn of_groups(item: &DicomAttributes<'_>) -> Result<Self, ReadError> {
        let mut facts = Self::default();
        let group = |tag: DicomTag| item.first_item(tag);
        for tag in [PLANE_POSITION, PLANE_ORIENTATION] {
            if let Some(plane) = group(tag)? {
                facts.take_plane(&plane)?;
            }
        }
        if let Some(measures) = group(PIXEL_MEASURES)? {
            facts.take_measures(&measures)?;
        }
        if let Some(values) = group(VALUE_TRANSFORMATION)? {
            facts.take_values(&values)?;
        }
        if let Some(content) = group(FRAME_CONTENT)? {
            facts.stack = Some(content.text(STACK)).filter(|stack| !stack.is_empty());
            facts.time = content.long(TIME_INDEX);
        }
        if let Some(segment) = group(SEGMENT_OF_FRAME)? {
            facts.segment = segment.shorts(SEGMENT_REFERENCE).map(|[number]| number);
        }
        Ok(facts)
    }

    /// These facts, and those of a wider scope where there are none.
    pub(super) fn or(self, wider: &Self) -> Self {
        Self {
            position: self.position.or(wider.position),
            orientation: self.orientation.or(wider.orientation),
            spacing: self.spacing.or(wider.spacing),
            between: self.between.or(wider.between),
            slope: self.slope.or(wider.slope),
            inter: self.inter.or(wider.inter),
            // One copy for each frame of a text that the file has once would let a small file take much
            // memory.
            stack: self.stack,
            time: self.time.or(wider.time),
            segment: self.segment.or(wider.segment),
        }
    }

    fn take_plane(&mut self, from: &DicomAttributes<'_>) -> Result<(), ReadError> {
        self.position = from.numbers(POSITION, "ImagePositionPatient")?.or(self.position);
        self.orientation = from.numbers(ORIENTATION, "ImageOrientationPatient")?.or(self.orientation);
        Ok(())
    }

    fn take_measures(&mut self, from: &DicomAttributes<'_>) -> Result<(), ReadError> {
        self.spacing = from.numbers(SPACING, "PixelSpacing")?;
        self.between = from.decimal(SPACING_BETWEEN, "SpacingBetweenSlices")?;
        Ok(())
    }

    fn take_values(&mut self, from: &DicomAttributes<'_>) -> Result<(), ReadError> {
        self.slope = from.decimal(SLOPE, "RescaleSlope")?;
        self.inter = from.decimal(INTERCEPT, "RescaleIntercept")?;
        Ok(())
    }
}
