//! `LodOptions`: the options of `lod`, its budget and its levels.
use super::mesh::{AttributeOptions, normal_error, uv_error};
use super::values::{count_up_to, distance, length, word};
use super::{LENGTH, OptionRow, OptionSection, OptionTable, OptionValues, store, store_some};
use crate::{LodLens, LodParts, LodSpec, Normals, TileErrors};
use chordal::budget::advice::{Message, Setting};
use chordal::budget::attributes::AttributeLimits;
use chordal::budget::{Length, Pixels};
use chordal_io::glb::GltfPacking;
use chordal_io::tiles::GeoPlace;

/// A request for levels of detail.
#[derive(Clone, Debug)]
pub struct LodOptions {
    pixels: Pixels,
    view: LodLens,
    nearest: Option<f64>,
    length: Option<Length>,
    /// Whether the best levels are kept if the finest is not within the budget.
    pub keep_best: bool,
    attributes: AttributeLimits,
    distances: Vec<f64>,
    errors: TileErrors,
    tile_triangles: u64,
    parts: LodParts,
    /// Where on the Earth a tileset stands.
    pub place: Option<GeoPlace>,
    normals: Normals,
}

/// The screen that levels are for unless another one is named.
const USUAL_VIEW: &str = "1920x1080 fov=60";
/// The most triangles of a tile by default. Chosen: indices of 16 bits reach as many vertices, and a tile of them is
/// loaded in a frame or two.
const USUAL_TILE: u64 = 1 << 16;
/// The most that may be given instead. Chosen: more are beyond any machine's memory, and so a slip.
const LARGEST_TILE: u64 = 100_000_000;

impl Default for LodOptions {
    fn default() -> Self {
        Self {
            pixels: Pixels::new(1.0).expect("1 is a number of pixels"),
            view: USUAL_VIEW.parse().expect("it is a view"),
            nearest: None,
            length: None,
            keep_best: false,
            attributes: AttributeLimits::default(),
            distances: Vec::new(),
            errors: TileErrors::default(),
            tile_triangles: USUAL_TILE,
            parts: LodParts::default(),
            place: None,
            normals: Normals::default(),
        }
    }
}

/// What levels are written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LodContainer {
    /// One glTF.
    OneFile,
    /// A tileset, in which large levels are split.
    Tiles,
}

impl LodOptions {
    /// The request.
    ///
    /// # Errors
    /// If the distance of the nearest eye is given twice.
    pub fn spec(&self, container: LodContainer, packing: GltfPacking) -> Result<LodSpec, Message> {
        if self.view.has_distance && (self.nearest.is_some() || self.length.is_some()) {
            let message = Message::from("").setting(Setting::View);
            return Err(message
                .words(" says a distance, and so does ")
                .setting(Setting::Nearest)
                .words(", or ")
                .setting(Setting::Tol)
                .words(" in its place: say one of them"));
        }
        Ok(LodSpec {
            pixels: self.pixels,
            lens: self.view.closest,
            nearest: self.nearest.or(self.view.distance()),
            length: self.length,
            distances: self.distances.clone(),
            normals: self.normals,
            attributes: self.attributes,
            errors: self.errors,
            tile_triangles: (container == LodContainer::Tiles).then_some(self.tile_triangles),
            parts: self.parts,
            place: self.place,
            packing,
        })
    }
}

impl AttributeOptions for LodOptions {
    fn attributes(&mut self) -> &mut AttributeLimits {
        &mut self.attributes
    }
}

const ERRORS: OptionValues =
    OptionValues::Words(&[("scaled", "For the whole screen"), ("plain", "As proved")]);

impl OptionTable for LodOptions {
    const ROWS: &'static [OptionRow<Self>] = &[
        OptionRow::<Self>::new(
            "px",
            (OptionValues::Number, "PIXELS"),
            "Maximum error on the screen, in device pixels; set viewers of the tiles to the same",
            |options, text| store(&mut options.pixels, text.parse()),
        )
        .renamed("pixels")
        .default("1"),
        OptionRow::<Self>::new(
            "view",
            (OptionValues::Text, "VIEW"),
            "Screen and lens that the distances are for, e.g. \"1920x1080 fov=60\"; dist=LENGTH is the same as {nearest}",
            |options, text| store(&mut options.view, text.parse()),
        )
        .default(USUAL_VIEW),
        OptionRow::<Self>::new(
            "nearest",
            (OptionValues::Number, "LENGTH"),
            "The nearest that the camera comes to the bounding box: the finest level is fine enough there. Default: where the \
             box fills the height of the screen",
            |options, text| store_some(&mut options.nearest, distance(text)),
        ),
        OptionRow::<Self>::new(
            "tol",
            LENGTH,
            "Maximum error of the finest level, instead of {nearest}: 0.1, 0.1mm, or 0.05% of the diagonal of the bounding box",
            |options, text| store_some(&mut options.length, length(text)),
        )
        .conflicts(&["nearest"]),
        OptionRow::<Self>::flag(
            "keep-best",
            "Write the best levels even if the finest is not within the budget; the exit code is still 5",
            |options, _| {
                options.keep_best = true;
                Ok(())
            },
        )
        .without_keyword(),
        uv_error(),
        normal_error(),
        OptionRow::<Self>::new(
            "distances",
            (OptionValues::Text, "LENGTHS"),
            "More distances for the table of which level is shown from where, e.g. 1,10,100",
            |options, text| {
                let more = text.split(',').map(distance).collect::<Result<Vec<f64>, _>>()?;
                options.distances.extend(more);
                Ok(())
            },
        )
        .repeatable()
        .under(OptionSection::Levels),
        OptionRow::<Self>::new(
            "errors",
            (ERRORS, "WHICH"),
            "Errors in tiles: scaled, enlarged so that a viewer's pixel error holds at the edges of the screen as well; or \
             plain, as proved",
            |options, text| {
                let words = [("scaled", TileErrors::Scaled), ("plain", TileErrors::Plain)];
                store(&mut options.errors, word(text, &words))
            },
        )
        .default("scaled")
        .under(OptionSection::Levels),
        OptionRow::<Self>::new(
            "tile-triangles",
            (OptionValues::Count, "N"),
            "For tiles: maximum number of triangles of one; a finest level with more is split in space, with matching borders",
            |options, text| {
                store(&mut options.tile_triangles, count_up_to(text, LARGEST_TILE))
            },
        )
        .default("65536")
        .under(OptionSection::Levels),
        OptionRow::<Self>::flag(
            "merge",
            "Merge all parts into one mesh, so that small ones can vanish into others. By default each part has levels of its \
             own, and nodes, instances, skins and animations are kept",
            |options, _| {
                options.parts = LodParts::Merged;
                Ok(())
            },
        )
        .under(OptionSection::Levels),
        OptionRow::<Self>::new(
            "at",
            (OptionValues::Text, "LAT,LON[,H]"),
            "For tiles: the place of the origin on the Earth, with x to the east: degrees north, degrees east, metres above \
             the WGS 84 ellipsoid",
            |options, text| store_some(&mut options.place, text.parse()),
        )
        .under(OptionSection::Levels),
        OptionRow::<Self>::new("normals", (OptionValues::Text, "HOW"), "Normals of triangles, as for mesh", |options, text| {
            store(&mut options.normals, text.parse())
        })
        .default("auto")
        .under(OptionSection::Levels),
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_those_that_help_names() {
        let mut defaults = LodOptions::default();
        for row in LodOptions::ROWS {
            row.default.map_or(Ok(()), |text| defaults.set(row.name, text)).expect("a default is a value");
        }
        let spec = |options: &LodOptions| options.spec(LodContainer::Tiles, GltfPacking::default());
        assert_eq!(spec(&defaults).ok(), spec(&LodOptions::default()).ok());
    }

    #[test]
    fn a_distance_is_said_once() {
        let mut options = LodOptions::default();
        options.set("view", "800x600 fov=60 dist=3").expect("a view");
        assert!(options.spec(LodContainer::OneFile, GltfPacking::default()).is_ok());
        options.set("tol", "0.1").expect("a length");
        assert!(options.spec(LodContainer::OneFile, GltfPacking::default()).is_err());
    }

    #[test]
    fn distances_add_up() {
        let mut options = LodOptions::default();
        options.set("distances", "1,10").expect("distances");
        options.set("distances", "100").expect("a distance");
        assert_eq!(options.distances, [1.0, 10.0, 100.0]);
        assert!(options.set("distances", "1,-1").is_err());
    }
}
