//! `LabelLooks`: the names and colours of the labels of a volume, as materials of their parts.
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic};
use chordal::math::greater;
use chordal_io::{MATERIAL, Scene, Volume};
use serde_json::{Value, json};

/// Names and colours for some labels: those of the file, or else `label 3` and a colour by the label's number.
pub(crate) struct LabelLooks {
    labels: Vec<i64>,
    names: Vec<String>,
    /// Linear intensities.
    colors: Vec<[f64; 3]>,
}

impl LabelLooks {
    /// The looks of `labels`, in their order.
    pub fn new(volume: &Volume, labels: &[i64]) -> Self {
        let name = |label: &i64| {
            let file_name = volume.labels.get(label).map(|look| look.name.clone());
            file_name.filter(|name| !name.is_empty()).unwrap_or_else(|| format!("label {label}"))
        };
        let color = |label: &i64| {
            let file_color = volume.labels.get(label).and_then(|look| look.color);
            file_color.unwrap_or_else(|| color_of(*label)).map(to_linear)
        };
        Self {
            labels: labels.to_vec(),
            names: labels.iter().map(name).collect(),
            colors: labels.iter().map(color).collect(),
        }
    }

    /// The name of a label.
    pub fn name(&self, label: i64) -> String {
        self.labels.binary_search(&label).map_or_else(|_| String::new(), |at| self.names[at].clone())
    }

    /// A mesh whose faces are all of material `number`, counted from 1.
    pub fn paint(&self, mesh: Mesh, number: u32) -> Mesh {
        let group = Attribute {
            semantic: Semantic::Group(MATERIAL.to_owned()),
            domain: Domain::Face,
            width: 1,
            values: vec![f64::from(number); mesh.faces().len()],
        };
        mesh.with_attribute(group).expect("as many values as faces")
    }

    /// Gives a scene the materials that its faces name.
    pub fn add_materials(&self, scene: &mut Scene) {
        let names = std::iter::once(String::new()).chain(self.names.iter().cloned()).collect();
        scene.groups.insert(MATERIAL.to_owned(), names);
        let material = |(name, [r, g, b]): (&String, &[f64; 3])| -> Value {
            // No metal and half rough: viewers show this in about the colour itself.
            let base =
                json!({ "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.5 });
            json!({ "name": name, "pbrMetallicRoughness": base })
        };
        scene.assets.materials = self.names.iter().zip(&self.colors).map(material).collect();
    }
}

/// The share of the circle of hues from one label to the next. Defined: the golden ratio less 1, so that the hues of a few
/// successive labels are far apart.
const HUE_STEP: f64 = 0.618_033_988_749_895;
/// Saturation and value of labels in turn. Chosen: so that labels with similar hues differ in one of them.
const SHADES: [[f64; 2]; 3] = [[0.75, 0.95], [0.5, 0.8], [0.9, 0.65]];

/// A colour for a label without one, in sRGB. It depends only on the label's number, so that it is the same in every file.
fn color_of(label: i64) -> [f64; 3] {
    // From the label itself: a remainder of it by a whole number gave some pairs of labels one colour.
    let hue = 6.0 * (label as f64 * HUE_STEP).rem_euclid(1.0);
    let [saturation, value] = SHADES[label.rem_euclid(SHADES.len() as i64) as usize];
    // Each channel is full within a sixth of the circle on either side of its hue, and decreases over the next sixth.
    let channel = |channel_hue: f64| {
        let distance = (hue - channel_hue).abs();
        let distance = if distance > 3.0 { 6.0 - distance } else { distance };
        let share = (2.0 - distance).clamp(0.0, 1.0);
        value * (1.0 - saturation * (1.0 - share))
    };
    [channel(0.0), channel(2.0), channel(4.0)]
}

/// The linear intensity of an encoded one (IEC 61966-2-1).
pub(crate) fn to_linear(encoded: f64) -> f64 {
    let encoded = greater(encoded, 0.0);
    if encoded <= 0.040_45 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_without_a_colour_get_colours_of_which_no_two_are_alike() {
        let colors: Vec<[f64; 3]> = (-2..120).map(color_of).collect();
        for (i, a) in colors.iter().enumerate() {
            assert!(a.iter().all(|x| (0.0..=1.0).contains(x)), "{a:?}");
            for (j, b) in colors.iter().enumerate().skip(i + 1) {
                let apart = (0..3).fold(0.0, |most, k| greater((a[k] - b[k]).abs(), most));
                // Four steps of eight bits, and 0.2 between the labels of a small table.
                let least = if j < 12 { 0.1 } else { 4.0 / 255.0 };
                assert!(apart > least, "labels {i} and {j}: {a:?} and {b:?}");
            }
        }
    }

    #[test]
    fn the_encoding_of_colours_is_that_of_the_standard() {
        assert_eq!((to_linear(0.0), to_linear(1.0)), (0.0, 1.0));
        // A middle gray of the standard's own curve.
        assert!((to_linear(0.5) - 0.214_041).abs() < 1e-6);
    }
}
