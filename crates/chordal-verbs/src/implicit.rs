//! `ImplicitShape`: a field with the region that it is cut off at.
use chordal::implicit::Field;
use chordal::math::Box3;
use chordal_io::Frame;
use serde::Serialize;

/// A field with the part of space that it is looked at in.
#[derive(Clone, Debug)]
pub struct ImplicitShape {
    /// The rule.
    pub field: Field,
    /// The box that the shape is cut off at, where somebody asked for one.
    pub region: Option<Box3>,
    /// The space that it is in.
    pub frame: Frame,
    /// What its script can be given, if it has one.
    pub parameters: Vec<Parameter>,
}

/// A number that a script can be given.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// What it is when nobody sets it.
    pub default: f64,
    /// What it is.
    pub value: f64,
}

impl ImplicitShape {
    /// The box that holds all that there is of the shape: what is known of the field, cut off at the region. Infinite
    /// where neither says.
    #[must_use]
    pub fn place(&self) -> Box3 {
        let known = self.field.bounds();
        let Some(region) = self.region else { return known };
        let pick = |a: [f64; 3], b: [f64; 3], first: fn(f64, f64) -> bool| {
            std::array::from_fn(|k| if first(a[k], b[k]) { a[k] } else { b[k] })
        };
        Box3 {
            min: pick(known.min, region.min, |a, b| a > b),
            max: pick(known.max, region.max, |a, b| a < b),
        }
    }

    /// The field with what the region leaves of it, closed by its sides; a shape of the plane stays one.
    #[must_use]
    pub fn clip_to_region(&self) -> Field {
        let Some(region) = self.region else { return self.field.clone() };
        let flat = !self.field.tape().axes()[2];
        if flat { self.field.cropped(region) } else { self.field.clipped(region) }
    }

    /// The same as a solid: a shape of the plane goes from the bottom of the region to its top.
    #[must_use]
    pub fn solid(&self) -> Field {
        self.region.map_or_else(|| self.field.clone(), |region| self.field.clipped(region))
    }
}
