//! `LodLens`: the screen and the lens that levels of detail are for.
use chordal::budget::View;
use chordal::budget::camera::MinDistanceView;
use std::str::FromStr;

/// A screen and a lens, for all directions of view; and the distance if the text has one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LodLens {
    /// The view; its distance is meaningless unless [`Self::has_distance`].
    pub closest: MinDistanceView,
    /// Whether the text has a distance.
    pub has_distance: bool,
}

impl LodLens {
    /// The distance in the text.
    #[must_use]
    pub fn distance(&self) -> Option<f64> {
        self.has_distance.then_some(self.closest.distance)
    }
}

impl FromStr for LodLens {
    type Err = String;

    /// Parses a view in the usual syntax; `dist=` may be left out.
    fn from_str(text: &str) -> Result<Self, String> {
        let has = |key: &str| text.split_whitespace().any(|word| word.starts_with(key));
        let has_distance = has("dist=");
        let is_complete = has_distance || has("eye=") || has("target=") || has("height=");
        let view_text = if is_complete { text.to_owned() } else { format!("{text} dist=1") };
        match view_text.parse::<View>().map_err(|error| error.to_string())? {
            View::MinDistance(closest) if closest.focal_px().is_none() => Err(
                "levels change with the distance, which has no effect with parallel rays: give fov instead of height"
                    .to_owned(),
            ),
            View::MinDistance(closest) => Ok(Self { closest, has_distance }),
            View::Camera(_) => {
                Err("levels of detail are for every direction: leave out eye and target".to_owned())
            }
        }
    }
}
