//! Attribute deviation in the report.
use chordal::check::findings::AttributeDeviation;
use chordal::explicit::Semantic;
use chordal::math::greater;
use serde::Serialize;

/// The deviation of the values of one attribute from those of the input at the nearest points, both ways, for the worst
/// part. Measured, so that it may be larger between samples.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AttributeFacts {
    /// "normal", "tangent", "texcoord", "color" or "custom".
    pub semantic: &'static str,
    /// Its name, as in "texcoord 0"; for "custom" the file's own name.
    pub name: String,
    /// The largest difference between samples; `None` if a value is not a number.
    pub largest: Option<f64>,
    /// The root mean square over the area; `None` if a value is not a number.
    pub rms: Option<f64>,
    /// "degrees" for directions, "value" for lengths in the attribute's own numbers.
    pub unit: &'static str,
    /// The evidence: "measured".
    pub evidence: &'static str,
    /// The number of samples, over all parts.
    pub samples: u64,
}

impl AttributeFacts {
    /// The values of [`Self::semantic`] and [`Self::name`] for an attribute.
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

    fn from_deviation(deviation: &AttributeDeviation) -> Self {
        let (semantic, name) = Self::names_of(&deviation.semantic);
        let finite = |x: f64| Some(x).filter(|x| x.is_finite());
        Self {
            semantic,
            name,
            largest: finite(deviation.largest),
            rms: finite(deviation.rms),
            unit: if deviation.is_angle() { "degrees" } else { "value" },
            evidence: "measured",
            samples: deviation.samples,
        }
    }

    /// Adds the result of one more part.
    pub(crate) fn add(rows: &mut Vec<Self>, deviation: &AttributeDeviation) {
        let new = Self::from_deviation(deviation);
        let Some(row) = rows.iter_mut().find(|row| row.semantic == new.semantic && row.name == new.name)
        else {
            return rows.push(new);
        };
        // NaN is worse than any number.
        let worse = |a: Option<f64>, b: Option<f64>| {
            let (a, b) = (a?, b?);
            Some(greater(a, b))
        };
        row.largest = worse(row.largest, new.largest);
        row.rms = worse(row.rms, new.rms);
        row.samples += new.samples;
    }
}
