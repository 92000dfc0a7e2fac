//! Attribute deviation in the report.
use chordal::check::findings::AttributeDeviation;
use chordal::explicit::Semantic;
use chordal::math::greater;
use serde::Serialize;

/// How far the values of one attribute are from those of the input at the nearest points, both ways, over the
/// worst part. Measured, so that between samples there may be more.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AttributeFacts {
    /// "normal", "tangent", "texcoord", "color" or "custom".
    pub semantic: &'static str,
    /// Its name, as in "texcoord 0"; for "custom" the file's own name.
    pub name: String,
    /// The largest difference that was found; `None` where a value is not a number.
    pub largest: Option<f64>,
    /// The root mean square over the area; `None` where a value is not a number.
    pub rms: Option<f64>,
    /// "degrees" for directions, "value" for lengths in the attribute's own numbers.
    pub unit: &'static str,
    /// The evidence: "measured".
    pub evidence: &'static str,
    /// The number of samples, over all parts.
    pub samples: u64,
}

impl AttributeFacts {
    /// What [`Self::semantic`] and [`Self::name`] are for an attribute.
    pub(crate) fn names_of(semantic: &Semantic) -> (&'static str, String) {
        match semantic {
            Semantic::Normal => ("normal", "normal".to_owned()),
            Semantic::Tangent => ("tangent", "tangent".to_owned()),
            Semantic::TexCoord(set) => ("texcoord", format!("texcoord {set}")),
            Semantic::Color(set) => ("color", format!("color {set}")),
            Semantic::Group(name) | Semantic::Custom(name) | Semantic::Blended(name) => {
                ("custom", name.clone())
            }
        }
    }

    fn from_deviation(found: &AttributeDeviation) -> Self {
        let (semantic, name) = Self::names_of(&found.semantic);
        let finite = |x: f64| Some(x).filter(|x| x.is_finite());
        Self {
            semantic,
            name,
            largest: finite(found.largest),
            rms: finite(found.rms),
            unit: if found.is_angle() { "degrees" } else { "value" },
            evidence: "measured",
            samples: found.samples,
        }
    }

    /// Adds the result of one more part.
    pub(crate) fn add(all: &mut Vec<Self>, found: &AttributeDeviation) {
        let new = Self::from_deviation(found);
        let Some(known) =
            all.iter_mut().find(|known| known.semantic == new.semantic && known.name == new.name)
        else {
            return all.push(new);
        };
        // NaN is worse than any number.
        let worse = |a: Option<f64>, b: Option<f64>| {
            let (a, b) = (a?, b?);
            Some(greater(a, b))
        };
        known.largest = worse(known.largest, new.largest);
        known.rms = worse(known.rms, new.rms);
        known.samples += new.samples;
    }
}
