//! What verbs take for volumes: which surface of the samples is meant.
use crate::fault::Fault;
use chordal_verbs::{Border, Inside, LabelSelection, Shape, SmoothingWidth, SurfaceSpec};
use clap::{Args, ValueEnum};

/// Arguments for volumes.
#[derive(Args, Debug)]
#[command(next_help_heading = "Volumes")]
pub struct VolumeArgs {
    /// Isovalue of the surface. Default: 0.5 for masks and occupancies, 0 for signed distances
    #[arg(long, value_name = "LEVEL", value_parser = level, allow_hyphen_values = true, conflicts_with = "labels")]
    pub iso: Option<f64>,

    /// Which samples are inside: those above the isovalue, or those below it as in distances
    #[arg(long, value_name = "SIDE", conflicts_with = "labels")]
    pub inside: Option<InsideArg>,

    /// Treat samples as labels: one part for each label but 0 ("all"), or of a list, e.g. 1,2,10
    #[arg(long, value_name = "LABELS", value_parser = labels, allow_hyphen_values = true)]
    pub labels: Option<LabelSelection>,

    /// Smooth a mask with a Gaussian of this standard deviation, a length or e.g. 0.8vox; the bound is the
    /// distance to the unsmoothed mask
    #[arg(long, value_name = "SIGMA", conflicts_with_all = ["labels", "iso"])]
    pub smooth: Option<SmoothingWidth>,

    /// Close the surface where it reaches the border of the volume (default)
    #[arg(long, conflicts_with = "open")]
    pub cap: bool,

    /// Leave the surface open where it reaches the border of the volume
    #[arg(long)]
    pub open: bool,
}

/// Which samples are inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum InsideArg {
    /// Those above the isovalue
    High,
    /// Those below the isovalue
    Low,
}

impl VolumeArgs {
    /// Tells a volume which surface of it is meant.
    ///
    /// # Errors
    /// When the shape is no volume and something is said of one.
    pub fn apply(&self, shape: &mut Shape) -> Result<(), Fault> {
        let kind = shape.kind();
        match (self.apply_where_volume(shape), self.named()) {
            (false, Some(name)) => {
                Err(Fault::usage(format!("{name} is for volumes, and the input holds {kind}")))
            }
            _ => Ok(()),
        }
    }

    /// The same for the two shapes of a verb that compares: what is said holds for those that are volumes.
    ///
    /// # Errors
    /// When neither is one and something is said of one.
    pub fn apply_to_both(&self, [a, b]: [&mut Shape; 2]) -> Result<(), Fault> {
        let are_volumes = [self.apply_where_volume(a), self.apply_where_volume(b)];
        match self.named().filter(|_| !are_volumes.contains(&true)) {
            Some(name) => Err(Fault::usage(format!("{name} is for volumes, and neither of the two is one"))),
            None => Ok(()),
        }
    }

    /// The same for any number of shapes.
    ///
    /// # Errors
    /// When none is one and something is said of one.
    pub fn apply_to_all<'a>(&self, shapes: impl Iterator<Item = &'a mut Shape>) -> Result<(), Fault> {
        let n = shapes.filter_map(|shape| self.apply_where_volume(shape).then_some(())).count();
        match self.named().filter(|_| n == 0) {
            Some(name) => {
                Err(Fault::usage(format!("{name} is for volumes, and none of the files holds one")))
            }
            None => Ok(()),
        }
    }

    /// The first argument that was given.
    pub fn named(&self) -> Option<&'static str> {
        let named = [
            (self.iso.is_some(), "--iso"),
            (self.inside.is_some(), "--inside"),
            (self.labels.is_some(), "--labels"),
            (self.smooth.is_some(), "--smooth"),
            (self.cap, "--cap"),
            (self.open, "--open"),
        ];
        named.iter().find(|(is_given, _)| *is_given).map(|(_, name)| *name)
    }

    /// Tells a volume which surface is meant; false where the shape is something else.
    fn apply_where_volume(&self, shape: &mut Shape) -> bool {
        let Shape::Volume(sampled) = shape else { return false };
        sampled.surface = SurfaceSpec {
            level: self.iso,
            inside: self.inside.map(|side| match side {
                InsideArg::High => Inside::High,
                InsideArg::Low => Inside::Low,
            }),
            border: if self.open { Border::Open } else { Border::Capped },
            labels: self.labels.clone(),
            smooth: self.smooth,
        };
        true
    }
}

fn level(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(level) if level.is_finite() => Ok(level),
        _ => Err("a level is a finite number".to_owned()),
    }
}

fn labels(text: &str) -> Result<LabelSelection, String> {
    if text == "all" {
        return Ok(LabelSelection::All);
    }
    let number = |part: &str| part.trim().parse::<i64>().map_err(|_| LABELS.to_owned());
    text.split(',').map(number).collect::<Result<_, _>>().map(LabelSelection::Listed)
}

const LABELS: &str = "labels read like 1,2,10, or all";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_levels_and_labels() {
        assert_eq!(level("-0.5"), Ok(-0.5));
        assert!(level("nan").is_err() && level("inf").is_err() && level("x").is_err());
        assert_eq!(labels("all"), Ok(LabelSelection::All));
        assert_eq!(labels("3, 1,-2"), Ok(LabelSelection::Listed(vec![3, 1, -2])));
        for text in ["", "1,", "1.5", "none"] {
            assert!(labels(text).is_err(), "{text}");
        }
    }
}
