//! Options for volumes: which surface of the samples to take.
use crate::fault::Fault;
use crate::options::TableArgs;
use chordal_verbs::options::not_a_volume;
use chordal_verbs::{Shape, SurfaceSpec};

/// Arguments for volumes.
pub type VolumeArgs = TableArgs<SurfaceSpec>;

impl VolumeArgs {
    /// Applies the options to a volume.
    ///
    /// # Errors
    /// If the shape is no volume and an option was given.
    pub fn apply(&self, shape: &mut Shape) -> Result<(), Fault> {
        match (self.apply_where_volume(shape), self.named()) {
            (false, Some(name)) => Err(Fault::usage(not_a_volume(&name, shape))),
            _ => Ok(()),
        }
    }

    /// The same for the two shapes of a verb that compares: the options apply to those that are volumes.
    ///
    /// # Errors
    /// If neither is a volume and an option was given.
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
    /// If none is a volume and an option was given.
    pub fn apply_to_all<'a>(&self, shapes: impl Iterator<Item = &'a mut Shape>) -> Result<(), Fault> {
        let n = shapes.filter_map(|shape| self.apply_where_volume(shape).then_some(())).count();
        match self.named().filter(|_| n == 0) {
            Some(name) => {
                Err(Fault::usage(format!("{name} is for volumes, and none of the files holds one")))
            }
            None => Ok(()),
        }
    }

    /// The first option that was given.
    pub fn named(&self) -> Option<String> {
        self.first_given.map(|name| format!("--{name}"))
    }

    /// Applies the options to a volume; returns false for any other shape.
    fn apply_where_volume(&self, shape: &mut Shape) -> bool {
        let Shape::Volume(sampled) = shape else { return false };
        sampled.surface = SurfaceSpec::clone(self);
        true
    }
}
