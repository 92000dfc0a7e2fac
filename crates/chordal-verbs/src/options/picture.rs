//! `PictureOptions`: the options of `render`.
use super::values::{length, word};
use super::{LENGTH, OptionRow, OptionSection, OptionTable, OptionValues, store, store_some};
use crate::{PictureTolerance, USUAL_SCREEN};
use chordal::budget::advice::{Message, Setting};
use chordal::budget::camera::Screen;
use chordal::budget::{Length, View};
use chordal::render::{CullMode, RenderOptions, RenderStyle, Viewpoint};

/// A request for a picture.
#[derive(Clone, Copy, Debug, Default)]
pub struct PictureOptions {
    /// What the picture shows.
    pub content: PictureContent,
    /// The distance of the darkest colour, in a picture of distances; the largest one if it is not given.
    pub darkest: Option<Length>,
    /// How finely a smooth shape is meshed for the picture, if that is said.
    pub tolerance: Option<PictureTolerance>,
    cull: CullMode,
    screen: Option<Screen>,
    view: Option<View>,
}

/// What a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureContent {
    /// The shape, in a style.
    Shape(RenderStyle),
    /// The curvature along the paths of a drawing.
    Comb,
    /// The distance from another shape.
    Deviation,
}

impl Default for PictureContent {
    fn default() -> Self {
        Self::Shape(RenderStyle::Shaded)
    }
}

impl PictureOptions {
    /// How the picture is drawn.
    ///
    /// # Errors
    /// If the view has no place of the eye.
    pub fn render_options(&self) -> Result<RenderOptions, Message> {
        let viewpoint = match self.view {
            Some(View::Camera(camera)) => Viewpoint::Camera(camera),
            Some(View::MinDistance(_)) => {
                let message = Message::from("a picture needs a camera with a position: ");
                return Err(message.value(Setting::View, "1280x960 fov=30 eye=4,-6,3 target=0,0,1"));
            }
            None => Viewpoint::Automatic(self.screen.unwrap_or(USUAL_SCREEN)),
        };
        let show = match self.content {
            PictureContent::Shape(style) => style,
            // Distances are colours that are shaded as well; combs are drawn in a style of their own.
            PictureContent::Comb | PictureContent::Deviation => RenderStyle::Shaded,
        };
        Ok(RenderOptions { show, cull: self.cull, viewpoint, ..RenderOptions::default() })
    }
}

const CONTENTS: OptionValues = OptionValues::Words(&[
    ("shaded", "Shaded, with the file's normals if it has some"),
    ("flat", "Flat shaded"),
    ("wire", "The triangles' edges"),
    ("normals", "The direction of the normal as a colour"),
    (
        "zebra",
        "Zebra stripes, as reflected by a mirror: a jump of the curvature shows as a kink of the stripes",
    ),
    ("comb", "The curvature along the paths of a drawing, as combs on the outer side of each bend"),
    (
        "overshade",
        "How many lanes a GPU launches for each pixel, from light for one to dark for 16 and more; the report counts quads, \
         helper lanes, triangles too small to be seen, and flicker",
    ),
    (
        "deviation",
        "The distance from the shape of {against} as a colour, from light through yellow and red to dark",
    ),
]);
const SIDES: OptionValues = OptionValues::Words(&[
    ("none", "Both are drawn"),
    ("back", "The backs: a triangle wound the wrong way is a hole"),
    ("front", "The fronts"),
]);

impl OptionTable for PictureOptions {
    const BESIDE: &'static [&'static str] = &["against"];

    const ROWS: &'static [OptionRow<Self>] = &[
        OptionRow::<Self>::new("show", (CONTENTS, "WHAT"), "The contents of the picture", |options, text| {
            store(&mut options.content, content(text))
        })
        .default("shaded")
        .under(OptionSection::Verb),
        OptionRow::<Self>::new(
            "darkest",
            LENGTH,
            "For {show=deviation}: the distance of the darkest colour. Default: the largest one",
            |options, text| store_some(&mut options.darkest, length(text)),
        )
        .needs("against")
        .under(OptionSection::Verb),
        OptionRow::<Self>::new(
            "cull",
            (SIDES, "SIDES"),
            "Which sides of triangles are not drawn, as on a GPU",
            |options, text| {
                let words = [("none", CullMode::None), ("back", CullMode::Back), ("front", CullMode::Front)];
                store(&mut options.cull, word(text, &words))
            },
        )
        .default("none")
        .under(OptionSection::Verb),
        OptionRow::<Self>::new(
            "size",
            (OptionValues::Text, "WxH"),
            "Size of the picture",
            |options, text| store_some(&mut options.screen, screen(text)),
        )
        .conflicts(&["view"])
        .under(OptionSection::Verb),
        OptionRow::<Self>::new(
            "view",
            (OptionValues::Text, "VIEW"),
            "The camera, with the size of the picture: \"1280x960 fov=30 eye=4,-6,3 target=0,0,1\"",
            |options, text| store_some(&mut options.view, text.parse()),
        )
        .under(OptionSection::Verb),
        OptionRow::<Self>::new(
            "tol",
            LENGTH,
            "For smooth shapes: maximum distance to the true shape",
            |options, text| store_some(&mut options.tolerance, length(text).map(PictureTolerance::Length)),
        )
        .under(OptionSection::Verb),
        OptionRow::<Self>::new(
            "px",
            (OptionValues::Number, "PIXELS"),
            "For smooth shapes: maximum distance in the picture, in pixels. Default: 0.5",
            |options, text| store_some(&mut options.tolerance, text.parse().map(PictureTolerance::Pixels)),
        )
        .conflicts(&["tol"])
        .renamed("pixels")
        .under(OptionSection::Verb),
    ];
}

fn content(text: &str) -> Result<PictureContent, String> {
    let contents = [
        ("shaded", PictureContent::Shape(RenderStyle::Shaded)),
        ("flat", PictureContent::Shape(RenderStyle::Flat)),
        ("wire", PictureContent::Shape(RenderStyle::Wire)),
        ("normals", PictureContent::Shape(RenderStyle::Normals)),
        ("zebra", PictureContent::Shape(RenderStyle::Zebra)),
        ("comb", PictureContent::Comb),
        ("overshade", PictureContent::Shape(RenderStyle::Overshade)),
        ("deviation", PictureContent::Deviation),
    ];
    word(text, &contents)
}

/// `1280x960`
fn screen(text: &str) -> Result<Screen, &'static str> {
    let wrong = "expected a size like 1280x960";
    let (width, height) = text.split_once('x').ok_or(wrong)?;
    let side = |text: &str| text.parse::<u32>().map_err(|_| wrong);
    let (width_px, height_px) = (side(width)?, side(height)?);
    if width_px == 0 || height_px == 0 {
        return Err("a picture is at least 1x1 pixels");
    }
    Ok(Screen { width_px, height_px })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_the_size_of_a_picture() {
        assert_eq!(screen("640x480"), Ok(Screen { width_px: 640, height_px: 480 }));
        for text in ["", "640", "640x", "0x1", "1x1x1", "-1x5"] {
            assert!(screen(text).is_err(), "{text}");
        }
    }

    #[test]
    fn every_content_is_a_word() {
        let OptionValues::Words(words) = CONTENTS else { panic!("they are words") };
        assert!(words.iter().all(|(word, _)| content(word).is_ok()));
    }

    #[test]
    fn an_eye_without_a_place_makes_no_picture() {
        let mut options = PictureOptions::default();
        assert!(options.render_options().is_ok());
        options.set("view", "10x10 fov=45 dist=4").expect("a view");
        assert!(options.render_options().is_err());
    }
}
