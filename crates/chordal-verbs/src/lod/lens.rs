//! `LodLens`: the screen and the lens that levels of detail are for.
use chordal::budget::View;
use chordal::budget::camera::MinDistanceView;
use std::str::FromStr;

/// A screen and a lens, seen from any side; and the distance where the text says one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LodLens {
    /// The view; its distance is nobody's unless [`Self::has_distance`].
    pub closest: MinDistanceView,
    /// Whether the text says a distance.
    pub has_distance: bool,
}

impl LodLens {
    /// The distance that the text says.
    #[must_use]
    pub fn distance(&self) -> Option<f64> {
        self.has_distance.then_some(self.closest.distance)
    }
}

impl FromStr for LodLens {
    type Err = String;

    /// A view as everywhere, whose `dist=` may be left out.
    fn from_str(text: &str) -> Result<Self, String> {
        let says = |key: &str| text.split_whitespace().any(|word| word.starts_with(key));
        let has_distance = says("dist=");
        let is_whole = has_distance || says("eye=") || says("target=") || says("height=");
        let whole = if is_whole { text.to_owned() } else { format!("{text} dist=1") };
        match whole.parse::<View>().map_err(|error| error.to_string())? {
            View::MinDistance(closest) if closest.focal_px().is_none() => Err(
                "levels change with the distance, which parallel rays do not see: say fov instead of height"
                    .to_owned(),
            ),
            View::MinDistance(closest) => Ok(Self { closest, has_distance }),
            View::Camera(_) => {
                Err("levels of detail are for every direction: leave out eye and target".to_owned())
            }
        }
    }
}
